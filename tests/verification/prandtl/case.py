# SPDX-License-Identifier: GPL-3.0-or-later
"""Prandtl's punch: the limit pressure under a rigid strip."""
import math
import pathlib

from frame import Mesh, Outcome, Section, Value, geometric

HERE = pathlib.Path(__file__).resolve().parent

YIELD = 1.0
EXPECTED = (2 + math.pi) / math.sqrt(3)  # over the yield stress


def lines(n):
    """Return the node lines along x and z, as fractions: n elements under the strip, finest at its edge."""
    edge = 0.4 / n
    inside = [1 - place for place in reversed(geometric(n, edge, 1.0))]
    outside = [1 + place for place in geometric(2 * n, edge, 5.0)]
    depth = geometric(2 * n, edge, 5.0)
    return [x / 6 for x in inside + outside[1:]], [1 - z / 5 for z in reversed(depth)]


def run(bench, element, n, text=None):
    """Run the punch; return the run and the mean pressure over the yield stress in all increments."""
    x, z = lines(n)
    words = [" ".join(f"{v:.9g}" for v in values) for values in (x, z)]
    found = bench.run(f"prandtl_{element}_{n}", text or HERE / "case.dat",
                      {"element": element, "nx": len(x) - 1, "nz": len(z) - 1, "x_lines": words[0],
                       "z_lines": words[1]})
    return found, [-force / YIELD for force in found.column("strip_rz")]


def contact_deck():
    """Return the deck with a tool instead of displacements."""
    text = (HERE / "case.dat").read_text(encoding="utf-8")
    tool = f'*TOOL punch\n  patches = "{HERE / "punch.bez"}"\n  contact = strip\n\n*CONTACT\n  formulation = mixed\n\n*NEWTON'
    text = text.replace("*NEWTON", tool).replace("control = load", "control = punch").replace("0.04", "2e-5")
    return text.replace("displace = strip z -0.0005", "move = punch 0 0 -0.0005")


def values(bench):
    """Compare the pressure at the end, and its plateau, which elements that lock do not have."""
    result = []
    for element, n, tolerance in (("hex8", 6, 0.04), ("hex27", 3, 0.03)):
        _, pressures = run(bench, element, n)
        result += [Value(f"`{element}`, {n} elements under half the strip: mean pressure", EXPECTED, pressures[-1],
                         tolerance),
                   Value(f"`{element}`: mean pressure over that at half the displacement", 1.0,
                         pressures[-1] / pressures[len(pressures) // 2], 0.005)]
    found = run(bench, "hex8", 6, contact_deck())[0]
    result.append(Value("`hex8`, with contact: mean pressure", EXPECTED, found.last("punch_fz") / YIELD, 0.04))
    return Outcome(result)


def study(bench):
    """Refine."""
    rows, curves = [], []
    for element, numbers in (("hex8", (3, 6, 12)), ("hex20", (2, 3, 5)), ("hex27", (2, 3, 5)),
                             ("solid_shell", (3, 6, 12))):
        for n in numbers:
            found, pressures = run(bench, element, n)
            rows.append(Mesh(element, f"{n} under half the strip", 1 / n, found.unknowns(), found.seconds, EXPECTED,
                             pressures[-1]))
        curves.append((f"{element}, {n}", found.column("strip_uz"), pressures))
    return Outcome(study=rows, pictures=[("prandtl.png", lambda axes: draw(axes, curves))])


def draw(axes, curves):
    """Draw the pressure over the displacement."""
    for label, places, pressures in curves:
        axes.plot([-1000 * u for u in places], pressures, linewidth=1.4, label=label)
    axes.axhline(EXPECTED, color="0.3", linewidth=0.8, linestyle="--", label="(2 + π)/√3")
    axes.set_xlabel("displacement over half the width (1e-3)")
    axes.set_ylabel("mean pressure over yield stress")
    axes.legend(frameon=False)


SECTIONS = [
    Section("V13 Prandtl's punch", """
A smooth rigid strip is pressed into a half-space, plane strain, von Mises, perfectly plastic with σ/E = 5e-6. Slip
lines of Prandtl and of Hill: mean pressure (2 + π) σ/√3. The pressure must reach a plateau: with volumetric locking it
increases without limit. The displacement falls to zero over one element beyond the edge, so that the strip is too wide
by about half of this element: an error of first order. The elements are shortest there, 0.4/n for n under half the
strip. The nodes are displaced, or pressed by a tool. Deck `tests/verification/prandtl/case.dat`.
""", values),
    Section("V13 Prandtl's punch: refinement and elements", """
Mean pressure over the yield stress at the end. The thickness of `solid_shell` is along z, its plane that of the
half-space's surface: each element is a layer of the body.
""", study, slow=True, picture="prandtl_elements.png"),
]
