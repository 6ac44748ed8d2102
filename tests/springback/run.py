#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Springback by `unload = on` of a strip bent over two cylinders: with two planes of symmetry, one, and none.

    run.py --program build/release/dd3imp --work build/springback

The chosen supports are as many as the free rigid motions and carry no force. The free shape, given by the distances
between some nodes, is that found with `release` and supports chosen by hand, and the same in all three models.
"""
import itertools
import math
import pathlib
import re
import sys

from dd3.errors import check
from dd3.programs import command, launch, parser_of_runs
from dd3.tables import number, read_table

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from run_description import check_description  # noqa: E402

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
RELEASE = "*PHASE springback\n  control = load\n  trial = 0.1\n  release = punch\n  release = die\n"
POINTS = {"centre": (0, 0, 0), "edge": (0, 5, 0), "top": (0, 0, 1), "middle": (14, 5, 1), "tip": (28, 0, 0),
          "corner": (28, 5, 1)}
# Blank, sets and supports, what holds the sheet while it is bent, how it is freed, supports by hand, free motions.
MODELS = {
    "quarter": (("0 0 0", "28 5 1", "14 2 2"), X_PLANE + Y_PLANE + "*BOUNDARY x\n  set = x_plane\n  fix = x\n"
                "*BOUNDARY y\n  set = y_plane\n  fix = y\n", "", "", "  displace = centre z 0\n", 1),
    "half": (("0 -5 0", "28 10 1", "14 4 2"), X_PLANE + Y_PLANE + "*BOUNDARY x\n  set = x_plane\n  fix = x\n",
             "  displace = y_plane y 0\n", "  free = y_plane y\n",
             "  displace = centre z 0\n  displace = edge z 0\n  displace = edge y 0\n", 3),
    "full": (("-28 -5 0", "56 10 1", "28 4 2"), X_PLANE + Y_PLANE,
             "  displace = x_plane x 0\n  displace = y_plane y 0\n", "  free = x_plane x\n  free = y_plane y\n",
             "  displace = centre x 0\n  displace = centre y 0\n  displace = centre z 0\n"
             "  displace = edge z 0\n  displace = edge x 0\n  displace = tip z 0\n", 6)}


def write_deck(path, name, unload):
    """Write the input file of a model, with the springback phase by `unload` or by `release`."""
    blank, supports, hold, free, by_hand, _ = MODELS[name]
    points = "".join(f"*SET {point}\n  near = {' '.join(map(str, at))}\n"
                     f"*HISTORY at_{point}\n  set = {point}\n  quantities = position\n" for point, at in POINTS.items())
    end = UNLOAD + free if unload else RELEASE + free + by_hand
    path.write_text(BLANK.format(*blank) + supports + points + MODEL.format(here=HERE) + hold + end, encoding="utf-8")


def distances(path):
    """Return the distances between the points at the start of the springback, and at its end."""
    rows = read_table(path)
    bent = [row for row in rows if row["phase"] == "bend"][-1]
    found = []
    for row in (bent, rows[-1]):
        place = {point: [number(row, f"at_{point}_{axis}", path) for axis in "xyz"] for point in POINTS}
        found.append([math.dist(place[a], place[b]) for a, b in itertools.combinations(POINTS, 2)])
    return found


def run(program, work, name, unload):
    """Run a model; return its distances before and after springback."""
    run_name = f"{name}_{'unload' if unload else 'release'}"
    deck, folder = work / f"{run_name}.dat", work / run_name
    write_deck(deck, name, unload)
    done = launch(command(program, deck, folder), timeout=120)
    check(done.code == 0, f"{run_name}: exit code {done.code}\n{done.output}{done.errors}")
    log = (folder / "job.log").read_text(encoding="utf-8")
    warnings = [found for found in check_description(folder, done.code)["warnings"] if found["code"] != "W009"]
    check(not warnings, f"{run_name}: a warning\n{warnings}")
    if unload:
        held = re.search(r"held there by (.*)", log)
        check(held and held[1].count("of node") == MODELS[name][-1], f"{run_name}: supports are not as expected\n{log}")
        reaction = re.search(r"largest reaction of the chosen supports is (\S+) N", log)
        check(reaction and float(reaction[1]) < 1e-6, f"{run_name}: reactions are not small\n{log}")
    return distances(folder / "history.csv")


def main():
    """Compare the free shapes."""
    arguments = parser_of_runs(__doc__).parse_args()
    reference = None
    for name in MODELS:
        for unload in (False, True):
            bent, free = run(arguments.program, arguments.work, name, unload)
            reference = reference or free
            springback = max(abs(a - b) for a, b in zip(bent, free))
            difference = max(abs(a - b) for a, b in zip(reference, free))
            print(f"{name} {'unload' if unload else 'release'}: springback {springback:.4f} mm, "
                  f"difference {difference:.1e} mm")
            check(springback > 0.02, f"{name}: the strip does not spring back")
            check(difference < 1e-4*springback, f"{name}: the free shape differs by {difference} mm")


if __name__ == "__main__":
    main()
