#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "forming_hood", "labels": ["slow"], "timeout": 900, "cost": 60}
"""The panel like a hood, from its CAD files and the blank under gravity to the springback.

    hood.py --program build/release/dd3imp --work build/hood_test

The force on the die under gravity is the weight; the middle of the panel is where the face of the punch ends; the run
reaches its end.
"""
import subprocess
import sys
from pathlib import Path

import numpy as np

from dd3.programs import parser_of_runs

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from bench import Bench, Value, check_values  # noqa: E402

import dd3  # noqa: E402

WEIGHT = 255 * 205 * 0.8 * 7.85e-9 * 9810  # of the quarter, N
UP = {"die": "1", "holder": "-1", "punch": "-1"}


def main():
    """Make the tools and run the panel on a coarse mesh."""
    options = parser_of_runs(__doc__).parse_args()
    bench = Bench(options.program, options.work)
    subprocess.run([sys.executable, ROOT / "input_files" / "hood" / "step_files.py", bench.work], check=True)
    for name, side in UP.items():
        subprocess.run([Path(sys.executable).parent / "dd3", "tool", bench.work / f"{name}.step",
                        bench.work / f"{name}.bez", "--toward", "0", "0", side, "--tolerance", "0.01"],
                       check=True, capture_output=True)
    run = bench.run("hood", ROOT / "input_files" / "hood" / "hood.dat",
                    {"tools": bench.work, "levels": 0, "divisions": "25 20 1"})
    grid = dd3.open(run.folder).fields
    points = np.asarray(grid[int(grid.step_at("draw"))].points)
    middle = points[np.linalg.norm(points[:, :2], axis=1) < 1e-3]
    # The face of the punch is at -30 - 10 - 8 mm there, on the upper side of the sheet.
    check_values(Value("force on the die under gravity, N", -WEIGHT, run.last("die_fz", "gravity"), 1e-5),
                 Value("lower face in the middle of the panel, mm", -48, float(middle[:, 2].min()), 0.2, absolute=True))


if __name__ == "__main__":
    main()
