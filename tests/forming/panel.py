#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "forming_panel", "labels": ["slow"], "timeout": 1800, "cost": 300}
"""The door panel on a mesh that is refined once, from the blank under gravity to the springback.

    panel.py --program build/release/dd3imp --work build/panel_test

The force on the die under gravity is the weight, the draw-beads hold with the force of the input where the sheet slides
across them, the lowest point of the panel is where the punch ends, and the run reaches its end.
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

FOLDER = ROOT / "input_files" / "panel"
WEIGHT = 600 * 800 * 0.8 * 7.85e-9 * 9810  # of the half, N
LOWEST = -78.0 - 0.8  # the lower face under the ridge of the punch, mm


def main():
    """Make the tools and draw the panel on a coarse mesh."""
    options = parser_of_runs(__doc__).parse_args()
    bench = Bench(options.program, options.work)
    subprocess.run([sys.executable, FOLDER / "tool_surfaces.py", bench.work], check=True)
    run = bench.run("panel", FOLDER / "panel.dat", {"tools": bench.work, "levels": 1, "points": 3})
    grid = dd3.open(run.folder).fields
    points = np.asarray(grid[int(grid.step_at("draw"))].points)
    check_values(Value("force on the die under gravity, N", -WEIGHT, run.last("die_fz", "gravity"), 1e-5),
                 Value("lowest point of the sheet, mm", LOWEST, float(points[:, 2].min()), 0.3, absolute=True),
                 Value("restraint of the upper bead, N", 420 * 120, run.last("upper_restraint", "draw"), 0.02))


if __name__ == "__main__":
    main()
