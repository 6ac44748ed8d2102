# SPDX-License-Identifier: GPL-3.0-or-later
"""Thickness of a strip in pure bending, for elements that turn by different angles."""
import math
import pathlib

import numpy as np
from frame import Outcome, Section, Value

from dd3.sheet import Sheet

HERE = pathlib.Path(__file__).resolve().parent
# Radius over thickness, length of the strip, mm, and numbers of elements along it.
STRIPS = ((5, 20, (8, 14, 22, 40, 114)), (20, 20, (4, 10, 29)), (100, 40, (4, 11)))


def changes(bench, radius, length, elements):
    """Return the largest changes in thickness at the cells, and of the distance of opposite nodes, away from the end
    that is led, and the turn of an element, degrees."""
    angle = math.degrees(length / radius)
    found = bench.run(f"bent_{radius}_{elements}", HERE / "case.dat",
                      {"elements": elements, "angle": angle, "length": length})
    sheet = Sheet(found.folder)
    inner = sheet.points(0)[sheet.corners].mean(axis=1)[:, 0] < length * (1 - max(1.5 / elements, 0.2))
    cells = sheet.values(sheet.last, "thickness", True)[0][inner] - 1
    points = sheet.points(sheet.last)[sheet.corners[inner]]
    nodes = np.linalg.norm(points[:, 4:] - points[:, :4], axis=2)
    return float(cells[np.abs(cells).argmax()]), float(nodes.max() - 1), angle / elements


def values(bench):
    """Compare the change in thickness with none."""
    result = []
    for radius, length, numbers in STRIPS:
        for elements in numbers:
            change, nodes, turn = changes(bench, radius, length, elements)
            result.append(Value(f"R = {radius} t, elements that turn by {turn:.1f} degrees (nodes {100 * nodes:+.2f} %)",
                                0.0, change, 1e-3, absolute=True))
    return Outcome(result)


SECTIONS = [
    Section("V25 Thickness of a bent strip", """
A strip of 1 mm without hardening is bent in plane strain to the radius R. Plastic bending without hardening does not
change the thickness (Hill, 1950); the radial stress leaves an elastic change of the order of Y/E = 0.001 at most. The
field `thickness` at the cells, its largest change away from the end that is led; in brackets the change of the distance
between opposite nodes, which is too large by θ²/8 where elements turn by θ. One layer of `solid_shell`; the geometry of
the other elements is in the unit test `test_model_sheet_thickness`. Deck `tests/verification/bent_thickness/case.dat`.
""", values),
]
