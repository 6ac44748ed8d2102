# SPDX-License-Identifier: GPL-3.0-or-later
"""Cook's membrane: shear-dominated bending of a tapered panel with oblique elements."""
import pathlib

import meshes
from frame import Mesh, Outcome, Section, Value

HERE = pathlib.Path(__file__).resolve().parent

EXPECTED = 23.96  # published, with E = 1, F = 1, thickness 1
LIMIT = 23.97  # extrapolated by reference.py
YOUNG, FORCE = 1e5, 1.0  # the displacement is FORCE/YOUNG times the expected one: 2.4e-4 mm


# Elastoplastic, in plane strain; N, mm, MPa. 8, 16 and 32 elements of hex27 give 1.3328, 1.3764 and 1.3806 mm.
PLASTIC_LIMIT = 1.381
PLASTIC = {"young = 1e5": "young = 70000", "hardening = perfect Y0=1e4": "hardening = linear Y0=243 H=135",
           "  fix = x y\n": "  fix = x y\n*BOUNDARY plane_strain\n  set = all\n  fix = z\n",
           "trial = 1\n": "trial = 0.1\n"}
PLASTIC_FORCE = 1800.0


def panel(u, v, w):
    """Return the place of a point of the panel."""
    return 48 * u, 44 * u + (44 - 28 * u) * v, w


def run(bench, element, n, force=FORCE, changes=None):
    """Run the panel with n x n elements and a deck with changes; return the run."""
    mesh, name = meshes.Mesh(element, (n, n, 1), panel), f"cook_{element}_{n}{'_plastic' if changes else ''}"
    file = bench.work / f"{name}.inp"
    groups = {}
    for key, fraction in mesh.fractions(0, 1).items():
        groups.setdefault(round(fraction, 12), []).append(key)
    sets = {f"edge{i}": keys for i, keys in enumerate(groups.values())}
    mesh.write(file, {"clamp": mesh.plane(0, 0), **sets})
    text = (HERE / "case.dat").read_text(encoding="utf-8")
    for old, new in (changes or {}).items():
        text = text.replace(old, new)
    for i, (fraction, keys) in enumerate(groups.items()):
        text += f"  load = edge{i} 0 {force * fraction * len(keys):.12g} 0\n"
    return bench.run(name, text, {"mesh": f'"{file}"', "element": element})


def elastic(bench, element, n):
    """Return the elastic run and its displacement for E = F = 1."""
    found = run(bench, element, n)
    return found, found.last("middle_uy") * YOUNG / FORCE


def values(bench):
    """Compare the elements on their finest quick mesh."""
    return Outcome([Value(f"`{element}`, {n} x {n} elements: displacement", EXPECTED, elastic(bench, element, n)[1],
                          0.01)
                    for element, n in (("hex8", 32), ("solid_shell", 32), ("hex20", 8), ("hex27", 8))])


def study(bench):
    """Refine."""
    rows = []
    for element, numbers in (("hex8", (2, 4, 8, 16, 32)), ("solid_shell", (2, 4, 8, 16, 32)), ("hex20", (2, 4, 8, 16)),
                             ("hex27", (2, 4, 8, 16))):
        for n in numbers:
            found, tip = elastic(bench, element, n)
            rows.append(Mesh(element, f"{n} x {n}", 1 / n, found.unknowns(), found.seconds, LIMIT, tip))
    return Outcome(study=rows)


def plastic_study(bench):
    """Refine the elastoplastic panel."""
    numbers = {"hex8": (4, 8, 16, 32, 64), "solid_shell": (4, 8, 16, 32), "hex20": (2, 4, 8, 16),
               "hex27": (2, 4, 8, 16)}
    rows = []
    for element, n in [(element, n) for element in numbers for n in numbers[element]]:
        found = run(bench, element, n, PLASTIC_FORCE, PLASTIC)
        rows.append(Mesh(element, f"{n} x {n}", 1 / n, found.unknowns(), found.seconds, PLASTIC_LIMIT,
                         found.last("middle_uy")))
    return Outcome(study=rows)


SECTIONS = [
    Section("V14 Cook's membrane", """
Elastic panel with the corners (0, 0), (48, 44), (48, 60), (0, 44), thickness 1, clamped on the left, uniform shear load
F on the right edge, ν = 1/3; one layer, free in its thickness. Displacement in the middle of the right edge for E = 1,
F = 1: 23.96 (Cook 1974, as commonly quoted); 9-node plane stress elements give 23.97 (`reference.py`). Run with small
displacements. Deck `tests/verification/cook/case.dat`.
""", values),
    Section("V14 Cook's membrane: refinement and elements", """
Displacement in the middle of the right edge against the extrapolated one. The stress is singular at the upper left
corner, which limits the order. `hex8` is too stiff in in-plane bending; `solid_shell` has [less parasitic
shear](solid_shell.md#bending-in-the-plane).
""", study, slow=True, picture="cook_elements.png"),
    Section("V14 Cook's membrane, elastoplastic: refinement and elements", """
The same panel in plane strain with E = 70 GPa, a yield stress of 243 MPa and linear hardening of 135 MPa (von Mises), F
= 1800 N in 10 increments, large displacements. Displacement in the middle of the right edge against 1.381 mm,
extrapolated from `hex27` with up to 32 x 32 elements (1.3806 mm). Both faces are held.
""", plastic_study, slow=True, picture="cook_plastic.png"),
]
