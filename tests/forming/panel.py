#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "forming_panel", "labels": ["slow"], "timeout": 900, "cost": 120}
"""The door panel on its undivided mesh, from the blank under gravity to the springback, drawn to 3 mm.

    panel.py --program build/release/dd3imp --work build/panel_test

The force on the die under gravity is the weight, the draw-beads hold the sheet in the draw alone, and the run reaches its
end.
"""
import subprocess
import sys
from pathlib import Path

from dd3.programs import parser_of_runs

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from bench import Bench, Value, check_values  # noqa: E402

FOLDER = ROOT / "input_files" / "panel"
WEIGHT = 600 * 800 * 0.8 * 7.85e-9 * 9810  # of the half, N
DEPTH = 3.0  # of the draw, mm


def main():
    """Make the tools and draw the panel on a coarse mesh."""
    options = parser_of_runs(__doc__).parse_args()
    bench = Bench(options.program, options.work)
    subprocess.run([sys.executable, FOLDER / "tool_surfaces.py", bench.work], check=True)
    run = bench.run("panel", FOLDER / "panel.dat", {"tools": bench.work, "levels": 0, "points": 3, "depth": DEPTH})
    before = run.column("upper_restraint", "gravity") + run.column("upper_restraint", "clamp")
    check_values(Value("force on the die under gravity, N", -WEIGHT, run.last("die_fz", "gravity"), 1e-5),
                 Value("restraint of the upper bead before the draw, N", 0, max(map(abs, before)), 1e-9,
                       absolute=True),
                 Value("length of the upper bead in the draw, mm", 420, run.last("upper_length", "draw"), 1e-6))


if __name__ == "__main__":
    main()
