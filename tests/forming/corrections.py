#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "forming_corrections", "labels": ["slow"], "timeout": 3600, "cost": 300}
"""Loops around the draw: the outline of a square cup's flange, and the tools of an S-shaped rail.

    corrections.py --program build/release/dd3imp --work build/corrections

- outline: the flange of the square cup ends within 0.5 mm of the wanted rim after at most five draws.
- compensate: after three corrections the sprung, trimmed rail deviates from the drawn one by less than half of what it
  did without, in its largest distance and its root mean square.
"""
import shutil
import sys
from pathlib import Path

from dd3 import compensate, outline
from dd3.errors import check
from dd3.process import read_process
from dd3.programs import parser_of_runs

ROOT = Path(__file__).resolve().parents[2]


def copied(work, name):
    """Copy a folder of input files with the materials; return the copy."""
    shutil.rmtree(work, ignore_errors=True)
    for folder in (name, "materials"):
        shutil.copytree(ROOT / "input_files" / folder, work / folder, ignore=shutil.ignore_patterns("*.out"))
    return work / name


def main():
    """Run both."""
    options = parser_of_runs(__doc__).parse_args()
    cup = copied(options.work / "outline", "square_cup")
    found = outline.find_outline(options.program, read_process(cup / "flanged.toml"), "outline", None,
                                 cup / "flange.txt", 5, 0.3)
    check(found[-1][0] <= 0.5 < found[0][0], f"outline: {found}")
    rail = copied(options.work / "compensate", "rail")
    found = compensate.compensate(options.program, read_process(rail / "rail.toml"), "tools", 3, 0.1, 1.0, [], None)
    for kind in (0, 1):
        check(found[-1][kind] < found[0][kind] / 2, f"compensate: {found}")
    steps = sorted(path.name for path in (rail / "rail.compensate").glob("*.step"))
    check(steps == ["die.step", "holder.step", "punch.step"], f"STEP files: {steps}")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
