#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "springback_free_shape"}
"""Springback by `unload = on` of a strip bent over two cylinders: with two planes of symmetry, one, and none.

    run.py --program build/release/dd3imp --work build/springback

The chosen supports are as many as the free rigid motions and carry no force. The free shape, given by the distances
between some nodes, is the same in all three models.
"""
import itertools
import math
import pathlib
import re
import sys

from dd3.errors import check
from dd3.programs import parser_of_runs
from dd3.tables import number

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from bench import Bench  # noqa: E402

MODEL = """
*MATERIAL steel
  young = 2e5
  poisson = 0.3
  yield = hill48 r0=1.8 r45=1.5 r90=2.3
  hardening = swift K=565 e0=0.007117 n=0.259
*TOOL punch
  patches = "{here}/punch.bez"
  friction = 0.1
  contact = z_max
*TOOL die
  patches = "{here}/die.bez"
  friction = 0.1
  contact = z_min
*CONTACT
  penalty = 1000
*LIMITS
  strain = 0.02
  rotation = 1
*NEWTON
  cutback = on
  tolerance = 1e-5
*PHASE bend
  control = punch
  trial = 0.5
  move = punch 0 0 -4
"""
BLANK = "*BLANK strip\n  origin = {}\n  size = {}\n  divisions = {}\n  material = steel\n"
X_PLANE = "*SET x_plane\n  plane = x 0\n"
Y_PLANE = "*SET y_plane\n  plane = y 0\n"
UNLOAD = "*PHASE springback\n  unload = on\n"
POINTS = {"centre": (0, 0, 0), "edge": (0, 5, 0), "top": (0, 0, 1), "middle": (14, 5, 1), "tip": (28, 0, 0),
          "corner": (28, 5, 1)}
# Blank, sets and supports, what holds the sheet while it is bent, how it is freed, free motions.
MODELS = {
    "quarter": (("0 0 0", "28 5 1", "14 2 2"), X_PLANE + Y_PLANE + "*BOUNDARY x\n  set = x_plane\n  fix = x\n"
                "*BOUNDARY y\n  set = y_plane\n  fix = y\n", "", "", 1),
    "half": (("0 -5 0", "28 10 1", "14 4 2"), X_PLANE + Y_PLANE + "*BOUNDARY x\n  set = x_plane\n  fix = x\n",
             "  displace = y_plane y 0\n", "  free = y_plane y\n", 3),
    "full": (("-28 -5 0", "56 10 1", "28 4 2"), X_PLANE + Y_PLANE,
             "  displace = x_plane x 0\n  displace = y_plane y 0\n", "  free = x_plane x\n  free = y_plane y\n", 6)}


def deck(name):
    """Return the input file of a model."""
    blank, supports, hold, free, _ = MODELS[name]
    points = "".join(f"*SET {point}\n  near = {' '.join(map(str, at))}\n"
                     f"*HISTORY at_{point}\n  set = {point}\n  quantities = position\n" for point, at in POINTS.items())
    return BLANK.format(*blank) + supports + points + MODEL.format(here=HERE) + hold + UNLOAD + free


def distances(found):
    """Return the distances between the points at the start of the springback, and at its end."""
    values = []
    for row in (found.row("bend"), found.row()):
        place = {point: [number(row, f"at_{point}_{axis}", found.path) for axis in "xyz"] for point in POINTS}
        values.append([math.dist(place[a], place[b]) for a, b in itertools.combinations(POINTS, 2)])
    return values


def run(bench, name):
    """Run a model; return its distances before and after springback."""
    found = bench.run(name, deck(name))
    log = (found.folder / "job.log").read_text(encoding="utf-8")
    warnings = [warning for warning in found.job["warnings"] if warning["code"] != "W009"]
    check(not warnings, f"{name}: a warning\n{warnings}")
    held = re.search(r"held there by (.*)", log)
    check(held and held[1].count("of node") == MODELS[name][-1], f"{name}: supports are not as expected\n{log}")
    reaction = re.search(r"largest reaction of the chosen supports is (\S+) N", log)
    check(reaction and float(reaction[1]) < 1e-6, f"{name}: reactions are not small\n{log}")
    return distances(found)


def main():
    """Compare the free shapes."""
    arguments = parser_of_runs(__doc__).parse_args()
    bench, reference = Bench(arguments.program, arguments.work), None
    for name in MODELS:
        bent, free = run(bench, name)
        reference = reference or free
        springback = max(abs(a - b) for a, b in zip(bent, free))
        difference = max(abs(a - b) for a, b in zip(reference, free))
        print(f"{name}: springback {springback:.4f} mm, difference {difference:.1e} mm")
        check(springback > 0.02, f"{name}: the strip does not spring back")
        check(difference < 1e-4*springback, f"{name}: the free shape differs by {difference} mm")


if __name__ == "__main__":
    main()
