#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "bending_moment"}
"""Moment of a strip of hex8 in pure bending over the exact one: the table of the element's length in docs/manual.md.

    run.py --program build/release/dd3imp --work build/bending_moment        compare with the manual
    run.py --program build/release/dd3imp --work build/bending_moment --layers 4 --print        other layers

Half a strip in plane strain, bent by a couple of dead forces at its end, which is consistent with stresses that are
linear through the thickness. The curvature is that between the plane of symmetry and a section in the strip. Exact: E
t^3 / 12 (1 - nu^2) in the elastic range; beyond it, fibres in plane strain without stress through the thickness,
integrated over their strain ln(1 + z/R) and over the thickness.
"""
import math
import pathlib
import re
import sys

from dd3.programs import parser_of_runs
from dd3.tables import interpolate, number

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from bench import Bench  # noqa: E402

THICKNESS, YOUNG, POISSON = 0.78, 2.1e5, 0.3
K, E0, N = 565.0, 0.007117, 0.259
ELASTIC, PLASTIC = "perfect Y0=1e6", f"swift K={K} e0={E0} n={N}"
LENGTHS = (0.5, 1.0, 2.0, 4.0)
# Row of the manual: radius, mm (none in the elastic range), elements, and the force of the couple, N, by length.
ROWS = {
    "bent to a radius of 13 thicknesses": (10.0, {0.5: (8, 95), 1.0: (4, 120), 2.0: (2, 200)}),
    "bent to a radius of 64 thicknesses": (50.0, {0.5: (12, 70), 1.0: (6, 80), 2.0: (4, 110), 4.0: (4, 190)}),
    "elastic, as in springback": (None, {0.5: (12, 0.1), 1.0: (6, 0.1), 2.0: (6, 0.1), 4.0: (6, 0.1)}),
}
# Allowed difference of the quotient of the moments from the manual, which gives whole per cent.
TOLERANCE = 0.008

DECK = """*BLANK strip
  size = {length} 1 {thickness}
  divisions = {elements} 1 {layers}
  element = hex8
  material = steel
*MATERIAL steel
  young = {young}
  poisson = {poisson}
  yield = von_mises
  hardening = {hardening}
*BOUNDARY symmetry
  set = x_min
  fix = x
*BOUNDARY strain
  set = all
  fix = y
*SET foot
  box = -1e-4 1e-4 -1 2 -1e-4 1e-4
*BOUNDARY place
  set = foot
  fix = z
*PHASE bend
  control = load
  trial = 0.02
  load = end_top {force} 0 0
  load = end_bottom -{force} 0 0
"""
LINE = """*SET {name}
  box = {x0} {x1} -1 2 {z0} {z1}
*HISTORY {name}
  set = {name}
  quantities = position
"""


def flow_stress(strain):
    """Return the flow stress, MPa, and its derivative."""
    stress = K * (E0 + strain) ** N
    return stress, N * stress / (E0 + strain)


def stress_point(stress, strain, change):
    """Return stress (x, y, z) and plastic strain after a change of the strain, by radial return."""
    shear = YOUNG / 2 / (1 + POISSON)
    volume = sum(change)
    mean = sum(stress) / 3 + YOUNG / 3 / (1 - 2 * POISSON) * volume
    deviator = [s - sum(stress) / 3 + 2 * shear * (e - volume / 3) for s, e in zip(stress, change)]
    size = math.sqrt(1.5 * sum(s * s for s in deviator))
    increment = 0.0
    if size > flow_stress(strain)[0]:
        for _ in range(20):
            flow, slope = flow_stress(strain + increment)
            increment += (size - 3 * shear * increment - flow) / (3 * shear + slope)
    factor = 1 - 3 * shear * increment / max(size, 1e-30)
    return [mean + factor * s for s in deviator], strain + increment


def fibre_stress(strain, steps=40):
    """Return the stress of a fibre in plane strain, without stress through the thickness, stretched by a strain."""
    stress, plastic, dx = [0.0, 0.0, 0.0], 0.0, strain / steps
    for _ in range(steps):
        dz, small = -dx, 1e-4 * dx
        for _ in range(30):
            error = stress_point(stress, plastic, (dx, 0, dz))[0][2]
            if abs(error) < 1e-7:
                break
            slope = (stress_point(stress, plastic, (dx, 0, dz + small))[0][2] - error) / small
            dz -= error / slope
        stress, plastic = stress_point(stress, plastic, (dx, 0, dz))
    return stress[0]


def exact_moment(radius, points=60):
    """Return the moment of a unit width at a radius of the middle fibre, N."""
    depth = 0.5 * THICKNESS / points
    places = [(i + 0.5) * depth for i in range(points)]
    return 2 * depth * sum(z * fibre_stress(math.log(1 + z / radius)) for z in places)


def moments(bench, length, layers, elements, force, hardening):
    """Return the curvatures, 1/mm, and moments, N, of a run with elements of a length in thicknesses."""
    step, small = length * THICKNESS, 1e-4
    section, end = elements // 2 * step, elements * step
    text = DECK.format(length=end, thickness=THICKNESS, elements=elements, layers=layers, young=YOUNG, poisson=POISSON,
                       hardening=hardening, force=force)
    for name, x, z in (("end_top", end, THICKNESS), ("end_bottom", end, 0), ("top", section, THICKNESS),
                       ("bottom", section, 0)):
        text += LINE.format(name=name, x0=x - small, x1=x + small, z0=z - small, z1=z + small)
    found = bench.run("strip", text, codes=(0, 3))  # it may stop beyond the radius
    curvatures, values = [], []
    for row in found.history:
        at = {name: number(row, name, found.path) for name in row if name.endswith(("_x", "_z", "progress"))}
        angle = math.atan2(at["top_x"] - at["bottom_x"], at["top_z"] - at["bottom_z"])
        curvatures.append(angle / section)
        values.append(at["progress"] * force * (at["end_top_z"] - at["end_bottom_z"]))
    return curvatures, values


def quotients(bench, layers):
    """Yield row, length and moment over the exact one."""
    for name, (radius, runs) in ROWS.items():
        exact = exact_moment(radius) if radius else None
        for length, (elements, force) in runs.items():
            curvatures, values = moments(bench, length, layers, elements, force, PLASTIC if radius else ELASTIC)
            if radius:
                moment = interpolate(curvatures, values, 1 / radius)
                if moment is None:
                    sys.exit(f"{name}, length {length}: the strip was not bent enough")
                yield name, length, moment / exact
            else:
                stiffness = YOUNG * THICKNESS**3 / 12 / (1 - POISSON**2)
                yield name, length, values[-1] / (stiffness * curvatures[-1])


def expected(name):
    """Return the excess by length that the manual gives in a row."""
    text = (ROOT / "docs" / "manual.md").read_text(encoding="utf-8")
    row = re.search(rf"^\| {re.escape(name)} \|(.*)\|$", text, re.MULTILINE)
    if not row:
        sys.exit(f"docs/manual.md has no row {name!r}")
    cells = [cell.strip().removesuffix(" %") for cell in row[1].split("|")]
    return {length: float(cell) / 100 for length, cell in zip(LENGTHS, cells) if cell}


def main():
    """Run all rows; exit code 1 if one differs from the manual."""
    parser = parser_of_runs(__doc__)
    parser.add_argument("--layers", type=int, default=2, help="elements through the thickness (2)")
    parser.add_argument("--print", action="store_true", help="print the quotients, without a comparison")
    options = parser.parse_args()
    wrong = 0
    for name, length, quotient in quotients(Bench(options.program, options.work), options.layers):
        line = f"{name}, elements of {length} thicknesses: {100 * (quotient - 1):.1f} % too high"
        if not options.print:
            manual = expected(name)[length]
            differs = abs(quotient - 1 - manual) > TOLERANCE
            wrong += differs
            line += f", manual {100 * manual:.0f} %" + (": DIFFERENT" if differs else "")
        print(line)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
