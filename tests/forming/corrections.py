#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "forming_corrections", "labels": ["slow"], "timeout": 3600, "cost": 400}
"""Loops around the draw: the outline of a square cup's flange, and tools that are corrected for springback.

    corrections.py --program build/release/dd3imp --work build/corrections

- outline: from the blank that `dd3 unfold` estimates, the flange of the square cup ends within 3 mm of the wanted rim
  after the first draw and within 0.5 mm after at most five.
- hat: after at most four corrections the largest deviation of the sprung hat is a tenth of that without.
- rail: after at most four corrections the sprung, trimmed rail of mild steel deviates by at most 0.1 mm.
"""
import shutil
import subprocess
import sys
from pathlib import Path

from dd3 import compensate, outline, unfold
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
    """Run them."""
    options = parser_of_runs(__doc__).parse_args()
    cup = copied(options.work / "outline", "square_cup")
    subprocess.run([sys.executable, cup / "step_files.py", cup / "cad"], check=True)
    unfold.main([str(cup / "cad" / "part.step"), str(cup / "outline.txt"), "--side", "upper", "--exponent", "0.26",
                 "--r", "1.8"])
    found = outline.find_outline(options.program, read_process(cup / "flanged.toml"), "outline", None,
                                 cup / "flange.txt", 5, 0.3)
    check(found[-1][0] <= 0.5 < found[0][0] <= 3, f"outline: {found}")

    hat = copied(options.work / "hat", "hat")
    process = read_process(hat / "hat.toml")
    process.operations[0].settings["divisions"] = "100 1 1"
    found = compensate.compensate(options.program, process, "tools", 4, 0.1, 1.0, ["x"], None)
    check(min(found)[0] < found[0][0] / 10, f"hat: {found}")

    rail = copied(options.work / "rail", "rail")
    process = read_process(rail / "rail.toml")
    for operation in process.operations:
        operation.settings["material"] = "dc06"
    found = compensate.compensate(options.program, process, "tools", 4, 0.1, 1.0, [], None)
    check(min(found)[0] <= 0.1, f"rail: {found}")
    steps = sorted(path.name for path in (rail / "rail.compensate").glob("*.step"))
    check(steps == ["die.step", "holder.step", "punch.step"], f"STEP files: {steps}")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
