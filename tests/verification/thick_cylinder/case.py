# SPDX-License-Identifier: GPL-3.0-or-later
"""Thick cylinder under internal pressure, perfectly plastic, in plane strain."""
import math
import pathlib

import meshes
from frame import Mesh, Outcome, Section, Value, load

HERE = pathlib.Path(__file__).resolve().parent

radial = load(HERE / "radial.py")
INNER, OUTER, YOUNG, YIELD = 100.0, 200.0, 2.1e5, 240.0
RADII = (120.0, 150.0, 180.0)
SMALL = 0.01  # factor on yield stress and pressures, for small strains


def closed_form(c, poisson):
    """Return pressure and displacement of the rim when the plastic zone reaches the radius c."""
    shear = YIELD * 2 / math.sqrt(3)
    pressure = shear * (math.log(c / INNER) + 0.5 * (1 - c**2 / OUTER**2))
    return pressure, shear * c**2 * (1 - poisson**2) / (YOUNG * OUTER)


def ring(element, radial, around):
    """Return the mesh of a quarter; the elements are as long as they are wide."""
    ratio = OUTER / INNER

    def place(u, v, w):
        r, angle = INNER * ratio**u, 0.5 * math.pi * v
        return r * math.cos(angle), r * math.sin(angle), 10.0 * w

    return meshes.Mesh(element, (radial, around, 1), place)


def run(bench, element, radial, around, factor, poisson):
    """Run the cylinder."""
    mesh, name = ring(element, radial, around), f"ring_{element}_{radial}_{factor:g}_{poisson:g}"
    file = bench.work / f"{name}.inp"
    mesh.write(file, {"bore": mesh.plane(0, 0), "at_y": mesh.plane(1, 0), "at_x": mesh.plane(1, 1)})
    settings = {"mesh": f'"{file}"', "element": element, "Y0": YIELD * factor, "poisson": poisson}
    pressures = {f"p{c:.0f}": factor * closed_form(c, poisson)[0] for c in RADII}
    return bench.run(name, HERE / "case.dat", {**settings, **pressures})


def values(bench):
    """Compare hex8 with the closed form and with the radial integration."""
    result = []
    for factor, name in ((SMALL, "2.4 MPa"), (1.0, "240 MPa")):
        found = run(bench, "hex8", 16, 36, factor, 0.3)
        pressures = [factor * closed_form(c, 0.3)[0] for c in RADII]
        rim = radial.displacements(INNER, OUTER, factor * YIELD, pressures)
        for c, expected in zip(RADII, rim):
            got = found.last("rim_ux", f"c{c:.0f}")
            if factor < 1 and c < 180:
                result.append(Value(f"{name}, c = {c:.0f} mm: rim, closed form, mm", factor * closed_form(c, 0.3)[1],
                                    got, 0.01))
            result.append(Value(f"{name}, c = {c:.0f} mm: rim, integration, mm", expected, got, 0.01))
    return Outcome(result)


def study(bench):
    """Refine the elements at c = 180 mm."""
    expected = radial.displacements(INNER, OUTER, SMALL * YIELD, [SMALL * closed_form(c, 0.3)[0] for c in RADII])[-1]
    rows = []
    for element, numbers in (("hex8", (4, 8, 16, 32)), ("solid_shell", (4, 8, 16)), ("hex20", (2, 4, 8)),
                             ("hex27", (2, 4, 8))):
        for n in numbers:
            around = round(2.27 * n)
            found = run(bench, element, n, around, SMALL, 0.3)
            rows.append(Mesh(element, f"{n} x {around}", 1 / n, found.unknowns(), found.seconds, expected,
                             found.last("rim_ux")))
    return Outcome(study=rows)


SECTIONS = [
    Section("V11 Thick cylinder under internal pressure", """
Radii 100 and 200 mm, plane strain, perfectly plastic, quarter of a ring with 16 x 36 elements. Closed form (Hill 1950,
with 2/√3 of the yield stress as for Tresca): P = (2 σ/√3) (ln(c/a) + (1 - c²/b²)/2) when the plastic zone reaches the
radius c, displacement of the rim (2 σ/√3) c² (1 - ν²)/(E b). It assumes small strains, and an axial stress that is the
mean of the others. `radial.py` integrates over the radius with von Mises and the deformed geometry. A yield stress of
2.4 MPa, with pressures in proportion, gives small strains. Deck `tests/verification/thick_cylinder/case.dat`.
""", values, after="""
At c = 180 mm the closed form gives 0.19454 mm with 240 MPa. The axial stress of ν = 0.3 adds 1.8 %, the strains of the
bore another 3.4 %.
"""),
    Section("V11 Thick cylinder: refinement and elements", """
Small strains (2.4 MPa), displacement of the rim at c = 180 mm against the radial integration. The edges of `hex20` and
`hex27` on the circles are curved. `solid_shell` has its thickness along the axis.
""", study, slow=True, picture="thick_cylinder_elements.png"),
]
