"""Cook's membrane: shear-dominated bending of a tapered panel with oblique elements."""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import meshes  # noqa: E402
from frame import Mesh, Outcome, Section, Value  # noqa: E402

EXPECTED = 23.96  # published, with E = 1, F = 1, thickness 1
LIMIT = 23.97  # extrapolated by reference.py
YOUNG, FORCE = 1e5, 1.0  # the displacement is FORCE/YOUNG times the expected one: 2.4e-4 mm


def panel(u, v, w):
    """Return the place of a point of the panel."""
    return 48 * u, 44 * u + (44 - 28 * u) * v, w


def run(bench, element, n):
    """Run the panel with n x n elements; return the run and the tip displacement for E = F = 1."""
    mesh, name = meshes.Mesh(element, (n, n, 1), panel), f"cook_{element}_{n}"
    file = bench.work / f"{name}.inp"
    groups, edge = {}, meshes.Mesh(element, (n, n, 1), lambda u, v, w: panel(1 - u, v, w)).pressure_forces(0)
    for key, force in edge.items():  # of the mirrored panel, whose first plane is the loaded edge
        groups.setdefault(round(force[0] / 16, 9), []).append((2 * n, *key[1:]))
    sets = {f"edge{i}": keys for i, keys in enumerate(groups.values())}
    mesh.write(file, {"clamp": mesh.plane(0, 0), "z_low": mesh.plane(2, 0), **sets})
    total = sum(share * len(keys) for share, keys in groups.items())
    text = (HERE / "case.dat").read_text(encoding="utf-8")
    for i, (share, keys) in enumerate(groups.items()):
        text += f"  load = edge{i} 0 {FORCE * share * len(keys) / total:.12g} 0\n"
    found = bench.run(name, text, {"mesh": f'"{file}"', "element": element})
    return found, found.last("middle_uy") * YOUNG / FORCE


def values(bench):
    """Compare the elements on their finest quick mesh."""
    return Outcome([Value(f"`{element}`, {n} x {n} elements: displacement", EXPECTED, run(bench, element, n)[1], 0.01)
                    for element, n in (("hex8", 32), ("solid_shell", 32), ("hex20", 8), ("hex27", 8))])


def study(bench):
    """Refine."""
    rows = []
    for element, numbers in (("hex8", (2, 4, 8, 16, 32)), ("solid_shell", (2, 4, 8, 16, 32)), ("hex20", (2, 4, 8, 16)),
                             ("hex27", (2, 4, 8, 16))):
        for n in numbers:
            found, tip = run(bench, element, n)
            rows.append(Mesh(element, f"{n} x {n}", 1 / n, found.unknowns(), found.seconds, LIMIT, tip))
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
corner, which limits the order. `hex8` and `solid_shell` are bilinear in their plane and bend too stiffly there.
""", study, slow=True, picture="cook_elements.png"),
]
