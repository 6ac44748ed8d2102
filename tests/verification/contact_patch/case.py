# SPDX-License-Identifier: GPL-3.0-or-later
"""A graded sheet between two flat tools: uniform deformation, and the gap of the contact layer (patch test)."""
import math
import pathlib

from closed_forms import POISSON, YOUNG, bisect
from frame import Outcome, Section, Value

HERE = pathlib.Path(__file__).resolve().parent

FRICTION, PRESSED, STICK, BACK = 0.144, 20.0, 0.0015, 0.001  # pressure, MPa, and elastic slips of the drag, mm
# Parts of the lower face, 12 x 9 mm, that belong to the corner and to an inner node, mm2: of four nodes, of nine.
PARTS = {"hex8": {"corner": 1.8 * 1.35, "inner": 3.0 * 3.15},
         "hex27": {"corner": 3.6 * 2.7 / 36, "inner": 6.0 * 6.3 / 36}}
LOAD, AREA, LENGTH = 21600.0, 108.0, 12.0  # N, mm2, mm; the thickness is 1 mm
HEIGHT, PRESSURE = 0.02, 1e-5 * YOUNG  # of the contact layer: h, mm, and p_0, MPa


def stretches():
    """Return the stretches along z and x in uniaxial compression, with Hencky's elasticity."""
    def force(stretch):
        return YOUNG * math.log(stretch) * AREA * stretch ** (-2 * POISSON)

    along = bisect(lambda stretch: force(stretch) + LOAD, 0.9, 1.0)
    return along, along**-POISSON


def layer_gap():
    """Return the gap of the layer under the nominal pressure, mm."""
    ratio = LOAD / AREA / PRESSURE
    return HEIGHT * 2 / (2 + ratio + math.sqrt(ratio * (ratio + 4)))


def places(found, name, gap, layers, tolerance=1e-9):
    """Compare the height of inner nodes and of corners, and the width."""
    along, across = stretches()
    inner = [Value(f"{name}: z of an inner node, mm", gap + 0.4 * along, found.last("inner_z"), tolerance)]
    return [Value(f"{name}: gap under the {place}, mm", gap, found.last(f"low_{word}_z"), tolerance, absolute=True)
            for place, word in (("middle", "inner"), ("corner", "corner"))] + inner * (layers > 1) + [
        Value(f"{name}: z of the upper corner, mm", gap + along, found.last("high_corner_z"), tolerance),
        Value(f"{name}: x of the upper corner, mm", LENGTH * across, found.last("high_corner_x"), tolerance)]


def values(bench):
    """Run both formulations, with points at the nodes and between them too."""
    result = []
    for formulation, skew, element, points in (
            ("mixed", 0.8, "hex8", 1), ("compliant", 0.8, "hex8", 1), ("compliant", 0, "hex27", 1),
            ("compliant", 0.8, "solid_shell", 1), ("compliant", 0.8, "solid_shell", 2), ("compliant", 0, "hex8", 3)):
        found = bench.run(f"contact_patch_{formulation}_{skew}_{element}_{points}", HERE / "case.dat",
                          {"formulation": formulation, "skew": skew, "element": element, "points": points,
                           **({"layers": 1, "heights": "0 1"} if points > 1 else {})})
        gap = layer_gap() if formulation == "compliant" else 0.0
        name = f"{formulation}, `{element}`{', oblique' if skew else ''}{f', points = {points}' if points > 1 else ''}"
        result += places(found, name, gap, 2 if points == 1 else 1)
    found = bench.run("contact_patch_energy", HERE / "case.dat", {"skew": 0, "step": 0.00025})
    left = layer_gap() / HEIGHT
    stored = 2 * AREA * PRESSURE * HEIGHT * ((1 - left) * (left - 3) / 2 - math.log(left))
    return Outcome([*result, Value("compliant, 4000 increments: energy in the layers, mJ", stored,
                                   found.last("tool_work") - found.last("internal_work"), 1e-3)])


def drag(bench):
    """Compare the tractions at nodes with parts of the face of different size with the uniform ones."""
    stiffness, limit = (PRESSURE + PRESSED) / HEIGHT, FRICTION * PRESSED
    result = []
    for element, points in (("hex8", 1), ("hex27", 1), ("solid_shell", 1), ("solid_shell", 2)):
        one_layer = {"layers": 1, "heights": "0 1"} if points > 1 else {}
        found = bench.run(f"contact_drag_{element}_{points}", HERE / "drag.dat",
                          {"element": element, "points": points, **one_layer})
        name = f"`{element}`{f', points = {points}' if points > 1 else ''}"
        parts = PARTS.get(element, PARTS["hex8"])
        for phase, expected in (("stick", stiffness * STICK), ("slip", limit), ("back", limit - stiffness * BACK)):
            result.append(Value(f"{name}, {phase}: mean traction, MPa", expected,
                                found.last("table_fx", phase) / AREA, 1e-8))
            result += [Value(f"{name}, {phase}: {place} node, MPa", expected,
                             (found.last(f"{place}_rx", phase) - found.last(f"{place}_rx", "press")) / part, 1e-8)
                       for place, part in parts.items()]
    return Outcome(result)


SECTIONS = [Section("V31 Patch test of the contact", """
A sheet of 12 x 9 x 1 mm in graded elements, oblique ones too, is pressed between two flat tools by 200 MPa, without
friction: stress and deformation are uniform. Hencky's elasticity, ν = 0.3. The mixed formulation leaves no gap, the
compliant one everywhere that of its law: x = g/h with p = p_0 (1/x - 2 + x), h = 0.02 mm and p_0 = 1e-5 E, on the
initial area; with points between the nodes, of one layer of elements, too. The tools start at the sheet: their layers
advance over the first tenth of the phase, which is work of the tools. Both layers store A p_0 h [(1 - x)(x - 3)/2 -
ln x]. Deck `tests/verification/contact_patch/case.dat`.
""", values),
            Section("V31 Patch test of the contact: stick and slip", f"""
The same sheet on one table, µ = {FRICTION:g}, under a pressure of {PRESSED:g} MPa; all its nodes are moved along x and
held along y. With the law of elastic stick the traction is uniform: k d, k = (p_0 + p)/h, after a slip of d = {STICK:g}
mm; µ p while it slips; µ p less k d after d = {BACK:g} mm back. Tractions at the nodes: the reaction, less that before
the drag, over the part of the face. Deck `tests/verification/contact_patch/drag.dat`.
""", drag)]
