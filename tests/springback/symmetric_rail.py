#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "springback_symmetric_rail", "labels": ["case", "slow"], "timeout": 600, "cost": 45}
"""The free shape of a drawn rail has the centre of symmetry of its blank and its tools.

    symmetric_rail.py --program build/release/dd3imp --work build/symmetric_rail

The input file is input_files/rail/rail.dat with a coarse mesh that is not refined. The supports that the program
chooses in the springback do not have the symmetry: forces on them that deform the sheet while the tools leave show in
the shape.
"""
import pathlib
import sys

import numpy as np

from dd3.errors import check
from dd3.fields import Fields
from dd3.programs import parser_of_runs
from dd3.springback import best_fit

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from bench import Bench  # noqa: E402

DECK = ROOT / "input_files" / "rail" / "rail.dat"
SETTINGS = {"divisions": "30 18 1", "levels": 0, "points": 7, "tools": DECK.parent}
LARGEST = 0.01  # distance of a node from its place in the shape turned by half a turn, mm


def turned(start, points):
    """Return the places of the nodes in the shape turned by half a turn about z."""
    def order(places):
        """Return the numbers of the nodes in the order of their places."""
        return np.lexsort(np.round(places, 4).T)
    found = np.empty_like(points)
    found[order(start)] = (points*[-1, -1, 1])[order(start*[-1, -1, 1])]
    return found


def main():
    """Compare drawn and free shape with themselves."""
    arguments = parser_of_runs(__doc__).parse_args()
    bench = Bench(arguments.program, arguments.work)
    fields = Fields(bench.run("rail", DECK, SETTINGS).folder)
    start = fields.points(0)
    for name, step, largest in (("drawn", -2, 1e-6), ("free", -1, LARGEST)):
        points = fields.points(fields.count + step)
        distance = np.linalg.norm(best_fit(turned(start, points), points) - points, axis=1).max()
        print(f"{name} shape: {distance:.2g} mm from itself turned by half a turn at most, expected {largest:g} mm")
        check(distance <= largest, f"the {name} shape has no centre of symmetry")


if __name__ == "__main__":
    main()
