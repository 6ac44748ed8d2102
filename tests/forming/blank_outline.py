#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "forming_blank_outline", "labels": ["slow"], "timeout": 1800, "cost": 150}
"""The outline of the blank of a square cup with a flange of constant width.

    blank_outline.py --program build/release/dd3imp --work build/blank_outline

From the blank that `dd3 unfold` estimates of the part's STEP file, the flange ends within 3 mm of the wanted rim after the
first draw, and within 0.5 mm after at most five.
"""
import shutil
import subprocess
import sys
from pathlib import Path

from dd3 import outline, unfold
from dd3.errors import check
from dd3.process import read_process
from dd3.programs import parser_of_runs

INPUT = Path(__file__).resolve().parents[2] / "input_files"


def main():
    """Estimate the blank and correct it."""
    options = parser_of_runs(__doc__).parse_args()
    shutil.rmtree(options.work, ignore_errors=True)
    for folder in ("square_cup", "materials"):
        shutil.copytree(INPUT / folder, options.work / folder, ignore=shutil.ignore_patterns("*.out"))
    cup = options.work / "square_cup"
    subprocess.run([sys.executable, cup / "step_files.py", cup / "cad"], check=True)
    unfold.main([str(cup / "cad" / "part.step"), str(cup / "outline.txt"), "--side", "upper", "--exponent", "0.26",
                 "--r", "1.8"])
    process = read_process(cup / "flanged.toml")
    process.operations[0].settings.update(divisions="25 25 1", levels=0)
    found = outline.find_outline(options.program, process, "outline", None,
                                 cup / "flange.txt", 5, 0.3)
    check(found[-1][0] <= 0.5 < found[0][0] <= 3, f"outline: {found}")
    sys.stdout.flush()


if __name__ == "__main__":
    main()
