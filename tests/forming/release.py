#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: []
"""The release of drawn parts by `unload`, beside tools withdrawn one after another by `move`, with contact and friction.

    release.py --program build/release/dd3imp --work build/release_orders            print the table
    release.py --program build/release/dd3imp --work build/release_orders --write    put it into docs/reports/release.md
"""
import pathlib
import sys

import numpy as np

from dd3.errors import run
from dd3.fields import Fields
from dd3.pages import put_table
from dd3.run import read_job
from dd3.springback import best_fit

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from bench import Bench  # noqa: E402
from studies import arguments, table  # noqa: E402

INPUTS = ROOT / "input_files"
# Deck, values of its parameters, distance by which a tool is withdrawn, mm, further keys of the release.
PARTS = {"draw bending, holder 2.45 kN": ("draw_bending/draw_bending.dat", {}, 90, ""),
         "draw bending, holder 19.6 kN": ("draw_bending/draw_bending.dat", {"holder": "-280"}, 90, ""),
         "draw bending with a draw-bead": ("draw_bending/draw_bead.dat", {}, 70, ""),
         "hat": ("hat/hat.dat", {}, 70, "  gravity = 0 0 0\n"),
         "rail, DP600": ("rail/rail.dat", {"divisions": "30 18 1", "levels": "0"}, 50, ""),
         "rail, DC06": ("rail/rail.dat", {"divisions": "30 18 1", "levels": "0", "material": "dc06"}, 50, "")}
PUNCH = "*PHASE up\n  control = punch\n  trial = 3\n  move = punch 0 0 {0}\n"
HOLDER = "*PHASE off\n  control = holder\n  trial = 3\n  move = holder 0 0 {0}\n  release = holder\n  hold = punch\n"
LAST = "*PHASE springback\n  unload = on\n"
ORDERS = {"`unload`": "", "punch, then holder, die": PUNCH + HOLDER, "holder, then punch, die": HOLDER + PUNCH}


def deck(name, distance, keys, order):
    """Return the drawing phases of an input file and its release in an order; without release for None."""
    path = INPUTS / name
    text = path.read_text(encoding="utf-8").replace("../materials", str(INPUTS / "materials"))
    text = text.replace('patches = "${tools}/', f'patches = "{path.parent}/')
    text = text.replace('patches = "punch', f'patches = "{path.parent}/punch')
    text = text.replace('patches = "die', f'patches = "{path.parent}/die')
    text = text.replace('patches = "holder', f'patches = "{path.parent}/holder')
    start, end = text.index("*PHASE springback"), text.index("*OUTPUT") if "*OUTPUT" in text else len(text)
    if order is None:
        return text[:start] + text[end:]
    phases = ORDERS[order].format(distance) + LAST
    first = phases.index("\n", phases.index("trial" if ORDERS[order] else "unload")) + 1
    return text[:start] + phases[:first] + keys + phases[first:] + text[end:]


def last(folder):
    """Return the positions of the nodes at the end of a run, mm."""
    fields = Fields(folder)
    return fields.points(fields.count - 1)


def slope(folder):
    """Return the slope of the rim of a strip along x at the end of a run, degrees, over its last two elements."""
    fields = Fields(folder)
    start, points = fields.points(0), fields.points(fields.count - 1)
    columns = np.unique(np.round(start[:, 0], 6))[[-3, -1]]
    first, rim = (points[np.abs(start[:, 0] - x) < 1e-6].mean(axis=0) for x in columns)
    return float(np.degrees(np.arctan2(rim[2] - first[2], rim[0] - first[0])))


def distance_of(points, others):
    """Return the root mean square of the distances of nodes after the best rigid motion, mm."""
    return float(np.sqrt(np.mean(np.sum((best_fit(points, others) - others)**2, axis=1))))


def main():
    """Make the runs and the table."""
    options = arguments(__doc__)
    bench, rows, jobs = Bench(options.program, options.work), [], []
    for part, (name, settings, distance, keys) in PARTS.items():
        label = part.replace(", ", "_").replace(" ", "_")
        drawn = bench.run(label, deck(name, distance, keys, None), settings)
        before, shapes = len(drawn.history), {}
        jobs.append(drawn.job)
        for number, order in enumerate(ORDERS):
            made = bench.run(f"{label}_{number}", deck(name, distance, keys, order), settings,
                             ("--restart", str(drawn.folder / "restart.h5")))
            shapes[order] = last(made.folder)
            codes = {warning["code"] for warning in made.job["warnings"]} & {"W106", "W107", "W116"}
            job = read_job(made.folder)
            rows.append([part if number == 0 else "", order, f"{distance_of(last(drawn.folder), shapes[order]):.3f}",
                         "" if part.startswith("rail") else f"{slope(made.folder):.2f}",
                         *(f"{distance_of(shapes[order], shapes[other]):.4f}" if other in shapes and other != order else ""
                           for other in list(ORDERS)[:2]),
                         str(len(made.history) - before), str(sum(phase["result"]["iterations"] for phase in job["phases"]
                                                                  if phase["result"].get("iterations"))),
                         " ".join(sorted(codes))])
    text = table(["part", "release", "change of shape, mm", "rim, degrees", "from `unload`, mm", "from punch, then holder, mm",
                  "increments", "iterations", "warnings"], rows)
    print(text)
    if options.write:
        put_table(ROOT / "docs" / "reports" / "release.md", "orders", text, jobs)


if __name__ == "__main__":
    run(main)
