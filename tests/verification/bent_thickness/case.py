# SPDX-License-Identifier: GPL-3.0-or-later
"""Thickness and strains of a strip in pure bending, and bent and stretched over a cylinder."""
import math
import pathlib

import numpy as np
from frame import Outcome, Section, Value

from dd3.sheet import Sheet

HERE = pathlib.Path(__file__).resolve().parent
# Radius over thickness, length of the strip, mm, and numbers of elements along it.
STRIPS = ((5, 20, (8, 14, 22, 40, 114)), (20, 20, (4, 10, 29)), (100, 40, (4, 11)))
# Radius of the cylinder, mm, and numbers of elements by which the strip would be divided evenly. The last tenth of its
# length is one element.
CYLINDERS = ((5, (10, 20, 40)), (20, (20, 60)))
HALF = math.sqrt(0.5)


def largest_change(bench, radius, length, elements):
    """Return the largest change in thickness at the cells away from the end that is led, and the turn of an element,
    degrees."""
    angle = math.degrees(length / radius)
    found = bench.run(f"bent_{radius}_{elements}", HERE / "case.dat",
                      {"elements": elements, "angle": angle, "length": length})
    sheet = Sheet(found.folder)
    inner = sheet.points(0)[sheet.corners(0)].mean(axis=1)[:, 0] < length * (1 - max(1.5 / elements, 0.2))
    cells = sheet.values(sheet.last, "thickness", True)[0][inner] - 1
    return float(cells[np.abs(cells).argmax()]), angle / elements


def bent(bench):
    """Compare the change in thickness with none."""
    result = []
    for radius, length, numbers in STRIPS:
        for elements in numbers:
            change, turn = largest_change(bench, radius, length, elements)
            result.append(Value(f"R = {radius} t, elements that turn by {turn:.1f} degrees", 0.0, change, 1e-3,
                                absolute=True))
    return Outcome(result)


def write_cylinder(path, radius):
    """Write a cylinder about the y axis through (0, 0, -radius), from -90 to 90 degrees."""
    rows = []
    for arc in (((-radius, -radius), (-radius, 0), (0, 0)), ((0, 0), (radius, 0), (radius, -radius)),
                ((radius, -radius), (radius, -2 * radius), (0, -2 * radius))):
        rows.append("patch 2 1 rational")
        rows += [f"{x} {y} {z} {w}" for y in (-5, 10) for (x, z), w in zip(arc, (1, HALF, 1), strict=True)]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")


class Wrapped:
    """The part of the strip on the cylinder, by its lower nodes in the order of their initial places."""

    def __init__(self, sheet, radius):
        self.sheet = sheet
        start, end = (sheet.points(step).reshape(-1, 2, 3)[:, 0] for step in (0, sheet.last))
        angle = np.arctan2(end[:, 0], end[:, 2] + radius)
        on = np.flatnonzero((angle > 0.15) & (angle < 1.15) & (start[:, 1] < 0.5))
        self.nodes = on[np.argsort(start[on, 0])]
        self.x, self.angle = start[self.nodes, 0], angle[self.nodes]
        self.stretch = radius * np.ptp(self.angle) / np.ptp(self.x)

    def mean(self, field):
        """Return the mean of a nodal field over the length."""
        values = self.sheet.values(self.sheet.last, field)[0].reshape(-1, 2)[self.nodes, 0]
        return float(np.trapezoid(values, self.x) / np.ptp(self.x))


def stretched(bench):
    """Compare thickness and strains with those of the angle that the strip covers."""
    patches = bench.work / "cylinder.bez"
    result = []
    for radius, numbers in CYLINDERS:
        write_cylinder(patches, radius)
        quarter = 0.5 * math.pi * radius
        length = 1.6 * quarter
        for elements in numbers:
            lines = [*np.linspace(0, 0.9, 9 * elements // 10 + 1), 1]
            found = bench.run(f"wrapped_{radius}_{elements}", HERE / "stretch.dat", {
                "elements": len(lines) - 1, "lines": " ".join(f"{line:.9g}" for line in lines), "length": length,
                "depth": 1.1 * length + radius - quarter, "cylinder": patches.resolve()})
            strip = Wrapped(Sheet(found.folder), radius)
            outer = math.sqrt(radius**2 + 2 * radius / strip.stretch)
            what = f"R = {radius} t, {math.degrees(np.ptp(strip.angle)) / (len(strip.x) - 1):.1f} degrees: "
            result.append(Value(what + "thickness, mm", outer - radius, strip.mean("thickness"), 3e-3))
            for face, r in (("lower", radius), ("middle", 0.5 * (radius + outer)), ("upper", outer)):
                result.append(Value(what + f"strain, {face}", math.log(r / radius * strip.stretch),
                                    strip.mean(f"major_strain_{face}"), 1e-3, absolute=True))
    return Outcome(result)


SECTIONS = [
    Section("V25 Thickness of a bent strip", """
A strip of 1 mm without hardening is bent in plane strain to the radius R. Plastic bending without hardening does not
change the thickness (Hill, 1950); the radial stress leaves an elastic change of the order of Y/E = 0.001 at most. The
field `thickness` at the cells, its largest change away from the end that is led. One layer of `solid_shell`; the
geometry of the other elements is in the unit test `test_model_sheet_thickness`. Deck
`tests/verification/bent_thickness/case.dat`.
""", bent, slow=True),
    Section("V25 Thickness and strains over a radius", """
A strip of t = 1 mm in plane strain is bent over a quarter of a cylinder of radius R without friction and stretched by
10 to 13 % at its middle. Where it lies on the cylinder the angle that a part covers gives the stretch λ of the lower
face, and the area is constant: the outer radius is √(R² + 2 R t/λ), whatever the law of hardening. Means of the fields
over the part from 9 to 66 degrees, for elements of `solid_shell` that turn by the angle in the first column. The end
section is moved down and does not turn with the strip; the last tenth of the length is one element, as shorter ones
fold there. Deck `tests/verification/bent_thickness/stretch.dat`.
""", stretched, slow=True),
]
