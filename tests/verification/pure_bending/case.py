# SPDX-License-Identifier: GPL-3.0-or-later
"""Pure bending of a perfectly plastic strip in plane strain, and its springback."""
import pathlib

import closed_forms as exact
from frame import ROOT, Mesh, Outcome, Section, Value

HERE = pathlib.Path(__file__).resolve().parent

CASE = ROOT / "tests" / "cases" / "bending_perfectly_plastic" / "case.dat"
YOUNG, POISSON, YIELD, LENGTH = 2e5, 0.4999, 4.0, 3.0  # of the deck; thickness and width 1
FIRST = 2 * YIELD / 3**0.5 / (YOUNG / (1 - POISSON**2)) * 2  # curvature of first yield, 1/mm
MOMENT = 2 * YIELD / 3**0.5 / 6  # moment of first yield, N.mm
PHASES = (("to_two", 2), ("to_four", 4), ("to_ten", 10))


def deck(element, nx, nz, points=15):
    """Return the deck with another mesh: the end section stays plane, led at each level of nodes."""
    text = CASE.read_text(encoding="utf-8").replace("divisions = 1 1 1", f"divisions = {nx} 1 {nz}")
    text = text.replace("element = solid_shell", f"element = {element}")
    text = text.replace("thickness_points = 15", f"thickness_points = {points}" if element == "solid_shell" else "")
    levels = (2 if element.startswith("hex2") else 1) * nz
    heights = {f"level{k}": k / levels - 0.5 for k in range(levels + 1)}
    lines = []
    for line in text.splitlines():
        words = line.split()
        if words[:3] in (["displace", "=", "top"], ["free", "=", "top"]):
            for name, height in heights.items():
                if words[0] == "free":
                    lines.append(f"  free = {name} x")
                else:
                    path = FIRST * LENGTH * height * {"${twice}": 2, "${six}": 6}[words[4]]
                    lines.append(f"  displace = {name} x {path:.12g}")
        elif words[:3] not in (["displace", "=", "bottom"], ["free", "=", "bottom"]):
            lines.append(line)
    sets = [f"*SET {name}\n  plane = z {height:.12g}\n  of = x_max\n*HISTORY {name}\n  set = {name}\n"
            f"  quantities = displacement reaction" for name, height in heights.items()]
    at = lines.index("*NEWTON")
    return "\n".join(lines[:at] + sets + lines[at:]) + "\n", heights


def run(bench, element, nx, nz, points=15):
    """Run a mesh; return the run, M/M_e after each phase, and the residual curvature over that of first yield."""
    text, heights = deck(element, nx, nz, points)
    found = bench.run(f"bending_{element}_{nx}_{nz}_{points}", text)
    moments = [sum(found.last(f"{name}_rx", phase) * height for name, height in heights.items()) / MOMENT
               for phase, _ in PHASES]
    top = f"level{len(heights) - 1}_ux"
    return found, moments, found.last(top) / (0.5 * LENGTH * FIRST)


def values(bench):
    """Compare one solid-shell."""
    _, moments, left = run(bench, "solid_shell", 1, 1)
    result = [Value(f"M/M_e at {ratio} times the curvature of first yield", exact.bending(ratio)[0], moment, 0.02)
              for moment, (_, ratio) in zip(moments, PHASES)]
    return Outcome([*result, Value("residual curvature after 10 times, over that of first yield", exact.bending(10)[1],
                                   left, 0.02)])


def study(bench):
    """Refine: moment at four times the curvature of first yield."""
    expected, rows = exact.bending(4)[0], []
    meshes = [("hex8", nx, nz, 0) for nx, nz in ((1, 2), (3, 2), (6, 3), (12, 4), (24, 8))]
    meshes += [("solid_shell", 1, 1, points) for points in (5, 7, 9, 15)]
    meshes += [(element, nx, nz, 0) for element in ("hex20", "hex27") for nx, nz in ((1, 1), (3, 1), (6, 2), (12, 4))]
    for element, nx, nz, points in meshes:
        found, moments, _ = run(bench, element, nx, nz, points)
        name = f"{nx} x {nz}" + (f", {points} points" if points else "")
        rows.append(Mesh(element, name, 1.0, found.unknowns(), found.seconds, expected, moments[1]))
    return Outcome(study=rows)


SECTIONS = [
    Section("V9 Pure bending of a perfectly plastic strip, and springback", """
Strip of 3 x 1 x 1 mm in plane strain; the end section stays plane, as in the ring of a long strip, and the faces are
free. Closed form: M/M_e = 3/2 - (κ_e/κ)²/2, with the first yield M_e, κ_e from 2σ/√3 and E/(1 - ν²), and elastic
springback by M/(E I): residual curvature κ - M/M_e κ_e. ν = 0.4999, for which the axial stress is the mean of the
others from the start. One `solid_shell`, 15 points. Case `tests/cases/bending_perfectly_plastic`; with hardening and
to radii down to 13 thicknesses, `tests/strip_bending`.
""", values),
    Section("V9 Pure bending: refinement and elements", """
M/M_e at four times the curvature of first yield, elements along the strip x layers. Square elements of `hex8` converge
to it from above; long ones are [too stiff](manual.md#blank-the-sheet). The error of the others is that of the
quadrature of a stress with kinks.
""", study, slow=True, picture="pure_bending_elements.png"),
]
