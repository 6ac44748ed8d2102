#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "forming_cushion", "labels": ["slow"], "timeout": 600, "cost": 35}
"""The tray on a cushion: equal pins, unequal pins, and distance blocks against the tilt.

    cushion.py --program build/release/dd3imp --work build/cushion

At the end of the draw the holder is in equilibrium: the nodal contact forces of the sheet, the pins with the force of
their table at their own strokes, and the blocks by their gaps, all from the motion of the holder, have no resultant and
no moment about the pins. The centre of the pressure is that of the pins (closed form), the sheet slides in more from the
end with the weak pins, and the blocks reduce the tilt.
"""
import shutil
import sys
from pathlib import Path

import numpy as np

from dd3.errors import check
from dd3.programs import command, launch, parser_of_runs
from dd3.run import read_frame, read_job
from dd3.sheet import Sheet

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from bench import Value, check_values  # noqa: E402

RUNS = {"equal": {}, "tilted": {"left": 0.2, "right": 1.8}, "blocks": {"left": 0.2, "right": 1.8, "gap": 1.01}}
FORCE, PINS, BLOCKS, STIFFNESS, STROKE, RISE, START, HEIGHT = 14000.0, 55.0, 70.0, 2e5, 8.0, 0.3, 0.02, 1.0


def balance(run, shares, gap):
    """Check the equilibrium of the holder; return its tilt, degrees, where its pressure acts, mm, the draw-in at both
    ends, mm, and the force of the blocks, N."""
    sheet, row = Sheet(run), read_frame(run, "history.csv").iloc[-1]
    holder = [tool["name"] for tool in read_job(run)["tools"]].index("holder") + 1
    step = sheet.last
    points, on = sheet.points(step), sheet.values(step, "contact_tool")[0] == holder
    tilt, pivot = np.radians(row["holder_tilt_y"]), PINS * (shares[1] - shares[0]) / sum(shares)

    def place(x):
        return row["holder_uz"] - np.tan(tilt) * (x - pivot)
    loads = [(points[on], -sheet.values(step, "contact_force")[0][on])]
    for share, x in zip(shares, (-PINS, PINS)):
        force = FORCE * share / 4 * np.interp(place(x) - START, (0, STROKE), (1, 1 + RISE))
        loads += [(np.array([[x, y, place(x)]]), np.array([[0, 0, -force]])) for y in (-30, 30)]
    pressed = {}
    for x in (-BLOCKS, BLOCKS):
        pressed[x] = STIFFNESS * max(0.0, gap - (HEIGHT + place(x) - row["die_uz"]))
        loads.append((np.array([[x, 0, place(x)]]), np.array([[0, 0, pressed[x]]])))
    force = sum(part.sum(axis=0) for _, part in loads)
    moment = sum(np.cross(place_ - (pivot, 0, place(pivot)), part).sum(axis=0) for place_, part in loads)
    pins = -sum(part[0, 2] for _, part in loads[1:5])
    # Within the tolerance of the iterations, 1e-4 of the force.
    check_values(Value("force of the pins, N", pins, row["holder_cushion"], 1e-5),
                 Value("force of the blocks, N", sum(pressed.values()), row["holder_spacer"], 0.1, absolute=True),
                 Value("resultant along z, N", 0.0, force[2], 2.0, absolute=True),
                 Value("moment about x, N mm", 0.0, moment[0], 100.0, absolute=True),
                 Value("moment about y, N mm", 0.0, moment[1], 100.0, absolute=True))
    centre = (loads[0][0][:, 0] * loads[0][1][:, 2]).sum() / loads[0][1][:, 2].sum()
    x, start = points[:, 0], sheet.initial(step)
    ends = [abs(x[np.abs(start[:, 0] - end) < 1e-6].mean() - end) for end in (-65, 65)]
    return row["holder_tilt_y"], centre, ends, sum(pressed.values())


def main():
    """Make the runs and compare them."""
    options = parser_of_runs(__doc__).parse_args()
    shutil.rmtree(options.work, ignore_errors=True)
    for folder in ("bracket_line", "materials"):
        shutil.copytree(ROOT / "input_files" / folder, options.work / folder, ignore=shutil.ignore_patterns("*.out"))
    found = {}
    for name, settings in RUNS.items():
        run = options.work / name
        done = launch(command(options.program, options.work / "bracket_line" / "cushion.dat", run,
                              ["--quiet", "--threads", 1], {"points": 3, **settings}))
        check(done.code == 0, f"{name}: {done.errors}")
        print(name)
        found[name] = balance(run, (settings.get("left", 1), settings.get("right", 1)), settings.get("gap", 0.9))
        tilt, centre, ends, blocks = found[name]
        print(f"tilt {tilt:.4f} degrees, pressure at x = {centre:.2f} mm, draw-in {ends[0]:.2f} and {ends[1]:.2f} mm, "
              f"blocks {blocks:.0f} N")
    # Without blocks the pressure acts where the pins do, but for their strokes and the friction at the height of 1 mm.
    check_values(Value("centre of the pressure, equal, mm", 0.0, found["equal"][1], 0.01, absolute=True),
                 Value("centre of the pressure, unequal, mm", PINS * 0.8, found["tilted"][1], 0.2, absolute=True))
    (left, right), (even, _) = found["tilted"][2], found["equal"][2]
    check(left > 1.2 * even and right < 0.5 * even, f"draw-in {left} and {right} mm, of equal pins {even} mm")
    check(abs(found["equal"][0]) < 1e-6 < 0.03 < found["blocks"][0] < 0.95 * found["tilted"][0], f"tilts: {found}")
    check(found["tilted"][3] == 0 < 2000 < found["blocks"][3], f"blocks: {found}")


if __name__ == "__main__":
    main()
