"""A graded sheet between two flat tools: uniform deformation, and the gap of the contact layer (patch test)."""
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from closed_forms import POISSON, YOUNG, bisect  # noqa: E402
from frame import Outcome, Section, Value  # noqa: E402

LOAD, AREA, LENGTH = 21600.0, 108.0, 12.0  # N, mm2, mm; the thickness is 1 mm
HEIGHT, HALF_PRESSURE = 0.01, 3e-5 * YOUNG  # of the contact layer, mm and MPa


def stretches():
    """Return the stretches along z and x in uniaxial compression, with Hencky's elasticity."""
    def force(stretch):
        return YOUNG * math.log(stretch) * AREA * stretch ** (-2 * POISSON)

    along = bisect(lambda stretch: force(stretch) + LOAD, 0.9, 1.0)
    return along, along**-POISSON


def layer_gap():
    """Return the gap of the layer under the nominal pressure, mm."""
    return HEIGHT * HALF_PRESSURE / (LOAD / AREA + HALF_PRESSURE)


def places(found, name, gap, tolerance):
    """Compare the height of inner nodes and of corners, and the width."""
    along, across = stretches()
    return [Value(f"{name}: gap under the {place}, mm", gap, found.last(f"low_{word}_z"), tolerance, absolute=True)
            for place, word in (("middle", "inner"), ("corner", "corner"))] + [
        Value(f"{name}: z of an inner node, mm", gap + 0.4 * along, found.last("inner_z"), tolerance),
        Value(f"{name}: z of the upper corner, mm", gap + along, found.last("high_corner_z"), tolerance),
        Value(f"{name}: x of the upper corner, mm", LENGTH * across, found.last("high_corner_x"), tolerance)]


def values(bench):
    """Run both formulations; oblique faces have other areas at their nodes than a layer assumes."""
    result = []
    for formulation, skew, element in (("mixed", 0.8, "hex8"), ("compliant", 0, "hex8"), ("compliant", 0, "hex27"),
                                       ("compliant", 0, "solid_shell"), ("compliant", 0.8, "hex8")):
        found = bench.run(f"contact_patch_{formulation}_{skew}_{element}", HERE / "case.dat",
                          {"formulation": formulation, "skew": skew, "element": element})
        gap = layer_gap() if formulation == "compliant" else 0.0
        exact = formulation == "mixed" or not skew
        result += places(found, f"{formulation}, `{element}`{', oblique' if skew else ''}", gap,
                         1e-9 if exact else 1.5e-5)
    found = bench.run("contact_patch_energy", HERE / "case.dat", {"skew": 0, "step": 0.002})
    part = LOAD / AREA / HALF_PRESSURE
    stored = 2 * AREA * HALF_PRESSURE * HEIGHT * (math.log1p(part) - part / (1 + part))
    return Outcome([*result, Value("compliant, 500 increments: energy in the layers, mJ", stored,
                                   found.last("tool_work") - found.last("internal_work"), 1e-3)])


SECTIONS = [Section("V31 Patch test of the contact", """
A sheet of 12 x 9 x 1 mm in graded elements, oblique ones too, is pressed between two flat tools by 200 MPa, without
friction: stress and deformation are uniform. Hencky's elasticity, ν = 0.3. The mixed formulation leaves no gap, the
compliant one everywhere that of its law, h p_h/(p + p_h) with h = 0.01 mm and p_h = 3e-5 E, on the initial area. In
the compliant formulation the area of a node is a quarter of the faces around it, which is exact for parallelograms:
beside oblique edges the gap is off by a few per cent, 1e-5 of the thickness. The tools start at the sheet: their layers
advance over the first tenth of the phase, which is work of the tools. Both layers store
A p_h h (ln(1 + r) - r/(1 + r)), r = p/p_h. Deck `tests/verification/contact_patch/case.dat`.
""", values)]
