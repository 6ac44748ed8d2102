#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: []
"""The release of drawn parts by `unload`, beside tools withdrawn in other orders by `move`, with contact and friction.

    release.py --program build/release/dd3imp --work build/release_orders            print the table
    release.py --program build/release/dd3imp --work build/release_orders --write    put it into docs/reports/release.md
"""
import pathlib
import subprocess
import sys
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from dd3.errors import Problem, run
from dd3.fields import Fields
from dd3.pages import put_table, table
from dd3.run import read_job
from dd3.sheet import Sheet
from dd3.springback import best_fit

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from bench import Bench  # noqa: E402
from studies import arguments  # noqa: E402

INPUTS = ROOT / "input_files"
NEAR = 1e-6  # distance of nodes that are one, mm
NO_GRAVITY = "  gravity = 0 0 0\n"
SIDES = {"die": "1", "holder": "-1", "punch": "-1"}  # of the sheet, from the tools


class Part(NamedTuple):
    """A part: its input file, values of its parameters, distance by which a tool is withdrawn, mm, further keys of the
    release, planes of symmetry, whether it is a strip, and whether its tools are made from CAD."""

    name: str
    settings: dict
    distance: float
    keys: str = ""
    mirror: str = ""
    strip: bool = False
    cad: bool = False


PARTS = {"draw bending, holder 2.45 kN": Part("draw_bending/draw_bending.dat", {}, 90, strip=True),
         "draw bending, holder 19.6 kN": Part("draw_bending/draw_bending.dat", {"holder": "-280"}, 90, strip=True),
         "draw bending with a draw-bead": Part("draw_bending/draw_bead.dat", {}, 70, strip=True),
         "hat": Part("hat/hat.dat", {}, 70, NO_GRAVITY, strip=True),
         "rail, DP600": Part("rail/rail.dat", {}, 50),
         "rail, DC06": Part("rail/rail.dat", {"material": "dc06"}, 50),
         "rail, DP600, 30 x 18 elements": Part("rail/rail.dat", {"levels": 0, "divisions": "30 18 1"}, 50),
         "rail, DC06, 30 x 18 elements": Part("rail/rail.dat", {"material": "dc06", "levels": 0,
                                                                 "divisions": "30 18 1"}, 50),
         "tray": Part("tutorial/tray.dat", {"length": 80, "width": 60, "divisions": "18 14 1", "holder": -7500}, 70,
                      mirror="xy", cad=True),
         "hood": Part("hood/hood.dat", {"levels": 0, "divisions": "25 20 1"}, 110, NO_GRAVITY, mirror="xy", cad=True)}
# A tool with a path is withdrawn along it, in the steps of `unload` while it touches.
PUNCH = "*PHASE up\n  control = punch\n  trial = 3\n  move = punch 0 0 {0}\n  release = punch\n"
HOLDER = "*PHASE off\n  control = holder\n  trial = 3\n  move = holder 0 0 {0}\n  release = holder\n  hold = punch\n"
# Punch and holder together, at the same rate, from the die that stays: the tools open as by `unload`.
BOTH = """*PHASE open
  control = punch
  trial = 0.05
  move = punch 0 0 1
  move = holder 0 0 1
*PHASE open_further
  control = punch
  trial = 1.5
  move = punch 0 0 {0}
  move = holder 0 0 {0}
"""
LAST = "*PHASE springback\n  unload = on\n"
ORDERS = {"`unload`": "", "punch, then holder, die": PUNCH + HOLDER, "holder, then punch, die": HOLDER + PUNCH,
          "punch and holder, then die": BOTH}


def make_tools(part, folder, program):
    """Make the tools of a part from CAD, and the material of the tray as the tutorial does."""
    folder.mkdir(parents=True, exist_ok=True)
    source = (INPUTS / part.name).parent
    subprocess.run([sys.executable, source / "step_files.py", folder], check=True, capture_output=True)
    commands = [["tool", folder / f"{tool}.step", folder / f"{tool}.bez", "--toward", "0", "0", side, "--tolerance",
                 "0.01"] for tool, side in SIDES.items()]
    if (source / "tension.csv").is_file():
        commands.append(["identify", "steel", "--criterion", "hill48", "--r", "0:1.85", "45:1.35", "90:2.20",
                         "--hardening", "swift", "--curve", source / "tension.csv", "--program", program, "--output",
                         folder / "steel.dat"])
    for words in commands:
        subprocess.run([pathlib.Path(sys.executable).parent / "dd3", *words], check=True, capture_output=True)


def deck(part, order):
    """Return the drawing phases of an input file and its release in an order; without release for None."""
    path = INPUTS / part.name
    text = path.read_text(encoding="utf-8").replace("../materials", str(INPUTS / "materials"))
    if not part.cad:
        text = text.replace('patches = "${tools}/', f'patches = "{path.parent}/')
        for tool in SIDES:
            text = text.replace(f'patches = "{tool}', f'patches = "{path.parent}/{tool}')
    start, end = text.rindex("*PHASE"), text.index("*OUTPUT") if "*OUTPUT" in text else len(text)
    if order is None:
        return text[:start] + text[end:]
    phases = ORDERS[order].format(part.distance) + LAST
    first = phases.index("\n", phases.index("trial" if ORDERS[order] else "unload")) + 1
    return text[:start] + phases[:first] + part.keys + phases[first:] + text[end:]


def shapes_of(folders):
    """Return the positions at the ends of runs of the nodes of the first one, mm, and their areas, mm2: releases may
    divide elements."""
    drawn = Sheet(folders[0])
    place, found = drawn.initial(drawn.last), []
    for folder in folders:
        sheet = Sheet(folder)
        distance, node = cKDTree(sheet.initial(sheet.last)).query(place)
        if distance.max() > NEAR:
            raise Problem(f"{folder}: a node of {folders[0]} is missing")
        found.append(sheet.points(sheet.last)[node])
    return found, drawn.areas(drawn.last)


def slope(folder):
    """Return the slope of the rim of a strip along x at the end of a run, degrees, over its last two elements."""
    fields = Fields(folder)
    start, points = fields.points(0), fields.points(fields.count - 1)
    columns = np.unique(np.round(start[:, 0], 6))[[-3, -1]]
    first, rim = (points[np.abs(start[:, 0] - x) < 1e-6].mean(axis=0) for x in columns)
    return float(np.degrees(np.arctan2(rim[2] - first[2], rim[0] - first[0])))


def distance_of(points, others, areas, mirror=""):
    """Return the root mean square of the distances of nodes after the best rigid motion, mm."""
    square = np.sum((best_fit(points, others, mirror, areas) - others)**2, axis=1)
    return float(np.sqrt(np.average(square, weights=areas)))


def from_band(distance, orders):
    """Return the distance of the first order from the band of the others, mm: half of what the ways
    to two of them, A and B, are longer than that from A to B, for the nearest pair."""
    one, *others = orders
    return min((distance[one, a] + distance[one, b] - distance[a, b])/2 for a in others for b in others)


def effort(made, before):
    """Return increments, iterations and warnings of a release as texts."""
    job = read_job(made.folder)
    iterations = sum(phase["result"]["iterations"] for phase in job["phases"] if phase["result"].get("iterations"))
    codes = {warning["code"] for warning in job["warnings"]} & {"W106", "W107", "W116"}
    return [str(len(made.history) - before), str(iterations), " ".join(sorted(codes))]


def rows_of(bench, name, part):
    """Draw a part and release it in all orders; return the rows of the table and run.json of the draw."""
    label = name.replace(", ", "_").replace(" ", "_")
    settings = dict(part.settings)
    if part.cad:
        settings["tools"] = bench.work / f"{label}_tools"
        make_tools(part, settings["tools"], bench.program)
    drawn = bench.run(label, deck(part, None), settings, timeout=7200)
    made = {order: bench.run(f"{label}_{number}", deck(part, order), settings,
                             ("--restart", str(drawn.folder / "restart.h5")), timeout=7200)
            for number, order in enumerate(ORDERS)}
    (drawing, *freed), areas = shapes_of([drawn.folder, *(release.folder for release in made.values())])
    shapes = dict(zip(ORDERS, freed))
    distance = {(a, b): distance_of(shapes[a], shapes[b], areas, part.mirror) for a in ORDERS for b in ORDERS}
    rows = []
    for order, release in made.items():
        first = not rows
        change = distance_of(drawing, shapes[order], areas, part.mirror)
        rim = f"{slope(release.folder):.2f}" if part.strip else ""
        rows.append([name if first else "", order, f"{change:.3f}", rim,
                     *("" if order == other else f"{distance[order, other]:.4f}" for other in list(ORDERS)[:3]),
                     f"{100*from_band(distance, ORDERS)/change:.2f}" if first else "",
                     *effort(release, len(drawn.history))])
    return rows, drawn.job


def main():
    """Make the runs and the table."""
    options = arguments(__doc__)
    bench = Bench(options.program, options.work)
    found = [rows_of(bench, name, part) for name, part in PARTS.items() if not options.only or name in options.only]
    head = ["part", "release", "change of shape, mm", "rim, degrees", "from `unload`, mm",
            "from punch, then holder, mm", "from holder, then punch, mm", "from the band, %", "increments", "iterations",
            "warnings"]
    print(table(head, [row for rows, _ in found for row in rows]))
    if options.write:
        shown = (0, 2, 3, *range(5, len(head)))
        text = table([head[i] for i in shown], [[rows[0][i] for i in shown] for rows, _ in found])
        put_table(ROOT / "docs" / "reports" / "release.md", "orders", text, [job for _, job in found])


if __name__ == "__main__":
    run(main)
