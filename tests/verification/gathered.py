# SPDX-License-Identifier: GPL-3.0-or-later
"""The sections of the manual that use cases of tests/cases, which are not repeated here."""
import math

import closed_forms as exact
from frame import HERE, ROOT, Outcome, Section, Value

CASES = ROOT / "tests" / "cases"


def run(bench, name, **settings):
    """Run a case of tests/cases."""
    label = "_".join([name, *settings.values()])
    return bench.run(label, CASES / name / "case.dat", settings)


def run_with(bench, name, label, old, new):
    """Run a case of tests/cases with another text in its deck."""
    folder = CASES / name
    deck = (folder / "case.dat").read_text(encoding="utf-8").replace(old, new)
    return bench.run(f"{name}_{label}", deck.replace("cylinder.bez", str(folder / "cylinder.bez")))


def patch_tests(bench):
    values = []
    for name, law, tolerance in (("patch_elastic", exact.tension_elastic, 1e-9),
                                 ("patch_plastic", exact.tension_plastic, 1e-4)):
        force, lateral = law(1.1, 36.0)
        found = run(bench, name)
        values += [Value(f"`hex8`, {name}: force, N", force, found.last("pulled_rx"), tolerance),
                   Value(f"{name}: y of an inner node, mm", 2.25 * lateral, found.last("inner_y"), tolerance),
                   Value(f"{name}: z of an inner node, mm", 1.6 * lateral, found.last("inner_z"), tolerance)]
    force, lateral = exact.tension_elastic(1.1, 36.0)
    for nodes in ("20", "27"):
        found = run(bench, "patch_quadratic", nodes=nodes)
        values += [Value(f"`hex{nodes}`: force, N", force, found.last("pulled_rx"), 1e-9),
                   Value(f"`hex{nodes}`: x of an inner node, mm", 5.83, found.last("inner_x"), 1e-9),
                   Value(f"`hex{nodes}`: y of an inner node, mm", 4.8 * lateral, found.last("inner_y"), 1e-9)]
    return Outcome(values)


def rigid_motion(bench):
    found = run(bench, "rotate_rigidly")
    force = exact.stretched_block(1.005, 4.0)
    return Outcome([Value("force along x after the turn, N", force, found.last("top_rx"), 1e-6),
                    Value("force along z after the turn, N", 0.0, found.last("top_rz"), 1e-6, absolute=True),
                    Value("x of the top, mm", 1.01, found.last("top_x"), 1e-10)])


def tension(bench):
    values = []
    for angle in (0, 45, 90):
        found = run(bench, f"tension_{angle:02}")
        elongation, force, r = exact.hill_bar(angle, 0.1)
        progress = elongation / 2.3
        values.append(Value(f"force at {angle} degrees, plastic strain 0.1, N", force, found.at("pulled_rx", progress),
                            1e-3))
        stress = exact.hill_tension(angle)[0] * exact.swift(exact.hill_tension(angle)[0] * 0.1)
        elastic = -exact.POISSON * stress / exact.YOUNG
        thin = math.log(found.at("top_z", progress) / 10) - elastic
        values.append(Value(f"r-value at {angle} degrees", r, -(0.1 + thin) / thin, 5e-3))
    return Outcome(values)


def ratios(bench):
    found = bench.run("points", HERE / "points.dat")
    rows = {row["point"]: row for row in found.history}

    def ratio(point, stress):
        return float(rows[point][stress]) / float(rows[point]["flow_stress"])

    biaxial, _, _, shear = exact.hill_ratios()
    plane, second = exact.hill_plane_strain(0.3)
    return Outcome([Value("equal biaxial tension", biaxial, ratio("biaxial", "s11"), 1e-6),
                    Value("plane strain along rolling, s11", plane, ratio("plane_strain", "s11"), 1e-5),
                    Value("plane strain along rolling, s22", second, ratio("plane_strain", "s22"), 1e-4),
                    Value("shear, s12", shear, ratio("shear", "s12"), 1e-6)])


def elastic_shear(bench):
    found = run(bench, "point_shear_elastic")
    rows = {(row["point"], int(row["increment"])): row for row in found.history}
    values = []
    for shear in (1, 2, 3, 4):
        s11, s12 = exact.dienes(shear)
        row = rows["fine", 40 * shear]
        values += [Value(f"s11/G at a shear of {shear}", s11, float(row["s11"]), 5e-4, absolute=True),
                   Value(f"s12/G at a shear of {shear}", s12, float(row["s12"]), 5e-4, absolute=True)]
    return Outcome(values)


def kinematic_shear(bench):
    found = run(bench, "point_shear_prager")
    rows = {int(row["increment"]): row for row in found.history}
    values = []
    for shear in (2, 4, 6):
        for name, factor in zip(("s11", "s12"), exact.dienes(shear)):
            values.append(Value(f"{name}/c at a shear of {shear}", factor / 3, float(rows[100 * shear][name]) / 300,
                                0.01 / 3, absolute=True))
    return Outcome(values)


def reversal(bench):
    point = run(bench, "point_reversed")
    rows = {int(row["increment"]): float(row["s11"]) for row in point.history}
    first, second = exact.armstrong_frederick(0.05, 0.01)
    element = run(bench, "reversed_tension")
    area = 100.0 * math.exp(-0.05 - 0.6 * first / exact.YOUNG)
    area_back = 100.0 * math.exp(-0.04 - 0.6 * second / exact.YOUNG)
    return Outcome([Value("point: stress at a plastic strain of 0.05, MPa", first, rows[5], 1e-7),
                    Value("point: stress after 0.01 in reverse, MPa", second, rows[7], 1e-7),
                    Value("element: stress at 0.05, MPa", first, element.last("pulled_rx", "pull") / area, 1e-3),
                    Value("element: stress after 0.01 in reverse, MPa", second,
                          element.last("pulled_rx", "push") / area_back, 1e-3)])


def block_on_table(bench):
    values = []
    for penalty in ("1e1", "1e3", "1e6"):
        found = run(bench, "friction_slide", p=penalty)
        values.append(Value(f"slides, penalty {penalty} N/mm: tangential force, N", 17.28, found.last("table_fx"),
                            1e-8))
    for penalty in ("1e1", "1e6"):
        found = run(bench, "friction_stick", p=penalty)
        values += [Value(f"16 N, penalty {penalty} N/mm: tangential force, N", 16.0, found.last("table_fx"), 1e-8),
                   Value(f"16 N, penalty {penalty} N/mm: displacement of the foot, mm", 0.0, found.last("bottom_ux"),
                         1e-8, absolute=True)]
    return Outcome(values)


def dragged_edge(bench):
    found = run(bench, "cylinder_drag", p="1e3")
    values = []
    for progress in (0.2, 0.4, 0.6, 0.8, 1.0):
        place = 0.01 + 4.99 * progress
        values.append(Value(f"force at x = {place:.3f} mm, N", exact.drag(place),
                            found.at("cylinder_fx", progress, "drag"), 1e-4, absolute=True))
    return Outcome(values)


def dragged_edge_with_layer(bench):
    found = run_with(bench, "cylinder_drag", "layer", "penalty = ${p}", "layer = 0.02")
    height, reference = 0.02, 1e-5 * 1e3 * 2.0  # of the layer: h, mm, and p_0 A, N
    values, ends = [], []
    for progress in (0.2, 0.6, 1.0):
        place = 0.01 + 4.99 * progress
        gap = height * exact.layer_gap(exact.drag_normal(place) / reference)
        values.append(Value(f"force at x = {place:.3f} mm, N", exact.drag(place, radius=10 + gap),
                            found.at("cylinder_fx", progress, "drag"), 1e-4, absolute=True))
        ends.append((place, gap, found.at("friction_work", progress, "drag")))
    left = exact.layer_gap(exact.drag_normal(5.0) / reference)
    (first, gap, before), (last, _, after) = ends[0], ends[-1]
    x, z = found.last("edge_x"), found.last("edge_z")
    return Outcome([*values,
                    Value("gap at the end, mm", height * left, math.hypot(x, z + 10) - 10, 1e-4),
                    Value("friction work from x = 1.008 to 5 mm, mJ", exact.drag_work(first, last, radius=10 + gap),
                          after - before, 2e-4),
                    Value("energy in the layer at the end, mJ", height * reference * exact.layer_energy(left),
                          found.last("contact_energy"), 1e-3)])


def strip_on_cylinder(bench):
    values = []
    for name, contact in (("layer of 0.02, the default", "layer = 0.02"), ("layer of 0.2", "layer = 0.2"),
                          ("mixed", "formulation = mixed")):
        found = run_with(bench, "capstan", contact.replace(" ", ""), "*CONTACT\n", f"*CONTACT\n  {contact}\n")
        values.append(Value(f"{name}: T1/T2", exact.belt(), -1 / found.last("left_rx"), 2e-3))
    return Outcome(values)


def turning_tools(bench):
    load, radius = 0.2, 10.01
    values = []
    for angle, tension in ((5, load * exact.belt()), (-5, load / exact.belt())):
        found = run(bench, "driven_cylinder", angle=str(angle), elements="118")
        values += [Value(f"strip on a cylinder turned by {angle} degrees: tension, N", tension, -found.last("left_rx"),
                         2e-3),
                   Value(f"its torque, turned by {angle} degrees, N.mm", (load - tension) * radius,
                         found.last("cylinder_torque"), 4e-3)]
    radius, path = 20.0, 10.0
    for angle, name in ((-20, "turned back by 20 degrees"), (0, "dragged")):
        found = run(bench, "rolling_cylinder", angle=str(angle), r_max="0.25")
        friction = 0.2 * found.last("cylinder_fz")
        slip = path - radius * math.radians(angle)
        values.append(Value(f"cylinder {name}: friction work, mJ", friction * slip, found.last("friction_work"), 1e-2))
        if angle:
            values.append(Value(f"cylinder {name}: torque, N.mm", friction * radius, found.last("cylinder_torque"),
                                1e-3))
    found = run(bench, "rolling_cylinder", angle=str(math.degrees(path / radius)))
    values.append(Value("it rolls: friction work over that of the dragged one", 0.0,
                        found.last("friction_work") / (friction * path), 1e-3, absolute=True))
    for back in (2.0, 0.2):
        found = run(bench, "driven_rolls", back=str(back))
        torques = zip(found.column("lower_torque", "drive"), found.column("upper_torque", "drive"))
        mean = [upper - lower for lower, upper in torques][13:]
        values += [Value(f"strip drawn in against {back} N: torque of the rolls, mean, N.mm", back * radius,
                         sum(mean) / len(mean), 5e-3),
                   Value(f"path of the strip against {back} N, mm", radius * math.radians(30),
                         found.last("front_ux") - found.last("front_ux", "tension"), 1.2e-2)]
    return Outcome(values)


def blank_holder(bench):
    found = run(bench, "bending_5mm")
    drawn = [-die - punch for die, punch in zip(found.column("die_fz", "draw"), found.column("punch_fz", "draw"))]
    return Outcome([Value("force on the die, the sheet clamped, N", 22600.0, -found.last("die_fz", "clamp"), 1e-6),
                    Value("smallest force of die and punch in the draw, N", 22600.0, min(drawn), 1e-2),
                    Value("largest force, N", 22600.0, max(drawn), 1e-2),
                    Value("error of the energy balance over the work of the tools", 0.0,
                          found.last("energy_error") / found.last("tool_work"), 1e-3, absolute=True)])


SECTIONS = [
    Section("V1 Patch tests", """
A distorted block is pulled along x by 10 %; all nodes must follow the linear displacement field. Elastic: σ = E ln λ,
lateral stretch λ^-ν. Plastic: isotropic Swift law with the elastic strains, uniform flow; its tolerance is that of
increments of 0.002. Cases `tests/cases/patch_elastic`, `patch_plastic`, `patch_quadratic`; of `solid_shell`, membrane
and bending, in the unit test `test_element_solid_shell`.
""", patch_tests),
    Section("V2 Rigid rotation", """
A block stretched by 0.5 % with its sides held is turned by 120 degrees about the diagonal of the axes: its reaction
along z becomes one along x. Force: A (K ε + 2 Y/3) with the plastic strain from 2 G ε - 3 G p = Y(p). Case
`tests/cases/rotate_rigidly`. Six zero eigenvalues of the element stiffness, and the tangent against differences (V3):
unit tests `test_element_*`, `test_system_*`, `test_material_*`.
""", rigid_motion),
    Section("V4 Uniaxial tension by Hill's criterion", """
One element, free lateral faces, Swift's law, at 0, 45 and 90 degrees to rolling. Stress s Y(s ε) at the plastic strain
ε with the stress ratio s of Hill (1948); r = H/G, (2N - F - G)/(2 (F + G)), H/F; elastic strains included. Cases
`tests/cases/tension_00`, `tension_45`, `tension_90`; at a point `point_tension`, within 1e-6.
""", tension),
    Section("V5 Biaxial tension, plane strain and shear by Hill's criterion", """
Stress over the flow stress at a material point, Hill (1948): 1/√(F + G) in equal biaxial tension; in plane strain along
rolling at a strain of 0.3 an integration of the rates with the elastic strains; 1/√(2N) in shear. Deck
`tests/verification/points.dat`; forces of an element on the whole path in the cases `equibiaxial` and `plane_strain`.
""", ratios),
    Section("V6 Hypoelastic simple shear", """
Simple shear to 4 of an elastic material in 160 steps. Dienes (1979) for the Jaumann rate: s12 = G sin γ, s11 = G (1 -
cos γ). The integration by the polar decomposition of each step is of second order. Case
`tests/cases/point_shear_elastic`.
""", elastic_shear),
    Section("V7 Simple shear with Prager's back-stress", """
Almost rigid material without isotropic hardening, back-stress dX = 2/3 c D dt, to a shear of 6. Nagtegaal and de Jong
(1982): the Jaumann rate makes the stress oscillate, s12 = c/3 sin γ, s11 = c/3 (1 - cos γ). Case
`tests/cases/point_shear_prager`.
""", kinematic_shear),
    Section("V8 Tension and compression with a saturating back-stress", """
Y = 200 + 100 (1 - exp(-10 p)), dX = 50 (60 n - X) dp (Armstrong and Frederick 1966), tension to p = 0.05, then 0.01 in
reverse. X is integrated exactly along a constant flow direction: at a point in seven steps
(`tests/cases/point_reversed`), with one element in increments of 0.0002 (`reversed_tension`).
""", reversal),
    Section("V18 Block on a table: stick and slip", """
A block is pressed on a flat table by 120 N and dragged. Coulomb, µ = 0.144: it slips at 17.28 N, and below it does not
move, for any penalty. Cases `tests/cases/friction_slide`, `friction_stick`; `friction_below` (17.2799 N, an
equilibrium) and `friction_above` (17.2801 N, none).
""", block_on_table),
    Section("V19 Edge drawn over a cylinder", """
An edge under a load N = 2 N is drawn over the top of a cylinder of radius 10 mm, µ = 0.2. Equilibrium on the slope α,
sin α = x/R: force -N tan(α - atan µ). At most 7 iterations in an increment, which needs the curvature of the tool in
the tangent. Case `tests/cases/cylinder_drag`.
""", dragged_edge),
    Section("V19 Edge drawn over a cylinder: contact layer", """
The same with a contact layer of h = 0.02 mm in place of the mixed formulation, F_0 = p_0 A = 0.02 N
(the two nodes of the edge, without a face in contact, each have the thickness squared as area): the edge slides on a
circle of radius R + g, with the normal force N cos φ/cos(α - φ), φ = atan µ, which sets the gap g. Friction work: µ
times the normal force, over the arc. Energy of the layer: F_0 h [(1 - x)(x - 3)/2 - ln x], x = g/h.
""", dragged_edge_with_layer),
    Section("V20 Strip over a cylinder", """
A thin elastic strip slides over a quarter of a fixed cylinder, µ = 0.144, in the compliant formulation and the mixed
one. Euler, Eytelwein: T1/T2 = exp(µ π/2), whatever the height of the layer. Case `tests/cases/capstan`; with
thicknesses of 0.02 and 0.05 mm, and penalties of 100 and 1e4 N/mm, the ratio is within 0.02 % (test `capstan`).
""", strip_on_cylinder),
    Section("V22 Tools that turn", """
A strip under a weight of 0.2 N slips on a quarter of a cylinder that turns, as in V20: the tension at the fixed end is
the weight times exp(± µ π/2), the torque their difference times the radius of the middle line. A rigid cylinder of
radius 20 mm is pressed on an elastic strip and moved by 10 mm: dragged, turned back, and rolling (turned by the path
over the radius). Coulomb: torque µ N R, friction work µ N times the slip, none where it rolls. Two such cylinders draw
an elastic strip in by 30 degrees against a tension F: without slip their torques sum up to F R, and the strip moves by
R times the angle, less 0.35 %, by which the pressed strip is longer under the rolls, and less the creep in the contact
layer, which grows with F. Cases `tests/cases/driven_cylinder`, `rolling_cylinder`, `driven_rolls`.
""", turning_tools, slow=True),
    Section("V23 Force of the blank-holder", """
The [bending test](reports/bending_test.md) on its mesh (b), the first 5 mm of the draw. No support holds the sheet
along z: the die carries the 22600 N that press the blank-holder, and the force of the punch, within the criterion of
1e-2. Case `tests/cases/bending_5mm`.
""", blank_holder),
]
