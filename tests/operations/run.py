#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "operations", "arguments": ["--only", "released", "placed", "bent_on", "carried", "refined", "cut_bend", "dynain", "restruck",
#:  "refused"], "timeout": 900}
#: {"name": "operations_more", "arguments": ["--only", "turned", "cut_wall", "cut_on_sheet", "cut_by_elements"],
#:  "labels": ["case", "slow"], "timeout": 900, "cost": 50}
"""Operations after one another: the sheet of another run (*START), cuts (*TRIM), and what is refused.

    run.py --program build/release/dd3imp --work build/operations [--only NAME ...]

- released: a strip drawn in one run and released in another has the shape of the strip that one run draws and releases
  but for the friction of the tools that are withdrawn there, within 1 % of the springback; the same where it is moved and
  turned between the two.
- placed: the draw-in of a sheet that is pressed in two operations does not depend on where it is placed between them, nor
  is a plastic strain that a prescribed displacement makes taken for one of fading forces.
- bent_on: a strip that is bent, taken over, turned and moved, and bent on has the arc of its whole angle in its place.
- turned: a bent strip that is turned about an oblique axis is released as the one that is not: equal shape and strains.
- carried: a bent strip of a material with two surfaces, back-stress, rate, temperature, damage and forming limit keeps
  all internal variables where it is taken over; released, they are those of the strip that is turned.
- refined: the same, within 2.5 %, of a strip whose elements were divided while it was drawn; its mesh goes on.
- cut_wall: the wall of a drawn strip, cut free, curls as it does on the whole strip; its stresses carry no moment.
- cut_bend: a strip bent to an arc, cut obliquely and released, springs back by M/(E' I).
- cut_on_sheet: a circle on the middle of the bent strip is cut out normal to it: it is a circle in the blank.
- cut_by_elements: the bent strip is cut by a curve and by the sides of elements; area and energy of both.
- dynain: the bent strip, written to a dynain file of LS-DYNA and taken over from it, is released as the strip itself.
- restruck: the released strip is formed again by the same tools; the run continues from its end, on the same mesh.
- refused: a run that has not ended, one without a sheet, another material, curves that are open or miss the sheet.
"""
import pathlib
import shutil
import sys

import h5py
import numpy as np

import dd3
import dd3.dynain
import dd3.export
from dd3.errors import check
from dd3.programs import parser_of_runs

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from bench import Bench, Value, check_values  # noqa: E402
from many_laws import MANY_LAWS  # noqa: E402

DRAW = ROOT / "input_files" / "draw_bending" / "draw_bending.dat"
UNLOAD = "*PHASE springback\n  unload = on\n"
SETTINGS = {"divisions": "90 1 1", "points": 7, "depth": 30}
MATERIAL = """*MATERIAL mild_steel
  young = 2.06e5
  poisson = 0.30
  yield = hill48 r0=1.79 r45=1.51 r90=2.27
  hardening = swift K=565.32 e0=0.007117 n=0.2589
"""
LAWS = f"""*MATERIAL many_laws
  young = 2.06e5
  poisson = 0.30
  yield = hill48 r0=1.79 r45=1.51 r90=2.27
{MANY_LAWS}"""
VARIABLES = ("equivalent_plastic_strain", "relative_back_stress", "bounding_back_stress", "stagnation_centre",
             "stagnation_radius", "bounding_hardening", "plastic_strain_rate", "temperature", "fracture_damage",
             "forming_limit_ratio")
SUPPORTS = """*BOUNDARY symmetry
  set = x_min
  fix = x
*BOUNDARY plane_strain
  set = all
  fix = y
"""
# A strip of 60 x 8 x 1 mm bent to a radius of 50 mm.
BEND = """*BLANK strip
  size = 60 8 1
  divisions = 60 6 1
  element = solid_shell
  thickness_points = 9
  material = mild_steel
*SET foot
  plane = x 0
  of = z_min
*BOUNDARY left
  set = x_min
  fix = x
*BOUNDARY plane
  set = all
  fix = y
*BOUNDARY foot
  set = foot
  fix = z
*HISTORY root
  set = x_min
  quantities = reaction moment
*NEWTON
  tolerance = 1e-6
*PHASE bend
  control = load
  trial = 0.05
  bend = x_max 0 4 0.5  0 1 0  68.754935
"""


def forming():
    """Return the draw of a strip without its release."""
    text = DRAW.read_text(encoding="utf-8").replace('patches = "', f'patches = "{DRAW.parent}/')
    check(UNLOAD in text, f"{DRAW}: no phase springback")
    return text.replace(UNLOAD, "")


def drawn(bench):
    """Return the run that draws the strip, made once."""
    folder = bench.work / "draw.out"
    if not folder.exists():
        bench.run("draw", forming(), SETTINGS)
    return folder


def middle(folder):
    """Return the initial x and the position of the lower nodes of a strip along one edge, at the last step."""
    grid = dd3.open(folder).fields[-1]
    position = np.asarray(grid.points)
    initial = position - np.asarray(grid["displacement"])
    chosen = np.flatnonzero((np.abs(initial[:, 1]) < 1e-6) & (np.abs(initial[:, 2]) < 1e-6))
    chosen = chosen[np.argsort(initial[chosen, 0])]
    return initial[chosen, 0], position[chosen]


def curvature(folder, low, high, axes=(0, 2)):
    """Return the mean curvature of the lower face where the initial x lies between two values, 1/mm."""
    x, position = middle(folder)
    step = np.diff(position[:, axes], axis=0)
    angle = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    length = np.hypot(step[:, 0], step[:, 1])
    chosen = (x[1:-1] > low) & (x[1:-1] < high)
    return float(np.mean((np.diff(angle) / (0.5 * (length[1:] + length[:-1])))[chosen]))


def distance(one, other):
    """Return the largest distance of two sheets of equal mesh after the best rigid motion, mm."""
    one, other = one - one.mean(0), other - other.mean(0)
    u, _, v = np.linalg.svd(one.T @ other)
    turn = u @ np.diag([1, 1, np.sign(np.linalg.det(u @ v))]) @ v
    return float(np.abs(one @ turn - other).max())


def released(bench):
    """Compare the release by another run with that of one run."""
    drawn(bench)
    check("*PHASE draw\n" in forming(), f"{DRAW}: no phase draw")
    whole = bench.run("whole", forming().replace("*PHASE draw\n", "*PHASE draw\n  keep = on\n") + UNLOAD, SETTINGS)
    expected, first = np.asarray(dd3.open(whole.folder).fields[-1].points), None
    springback = distance(np.asarray(dd3.open(bench.work / "draw.out").fields[-1].points), expected)
    for name, start, place in (("released", "draw.out", ""), ("kept", "whole.out/draw", ""),
                               ("moved", "draw.out", "  turn = 3 0 5  0 1 0  180\n  move = 1 0 3\n")):
        run = bench.run(name, f"*START\n  from = {start}\n{place}{MATERIAL}{SUPPORTS}{UNLOAD}")
        check("N106" in {message["code"] for message in run.job["notes"]}, f"{name}: no N106")
        found = np.asarray(dd3.open(run.folder).fields[-1].points)
        first = found if first is None else first
        check_values(Value(f"{name}: distance from the release by one run, mm", 0, distance(found, expected),
                           0.01 * springback, absolute=True),
                     Value(f"{name}: distance from the sheet where it was, mm", 0, distance(found, first), 1e-4,
                           absolute=True))


def placed(bench):
    """Press a sheet along x in three operations, with turns and displacements between them."""
    def deck(start, axis, by):
        across = "y" if axis == "x" else "x"
        return (f"{start}{MATERIAL}" + "".join(f"*BOUNDARY {name}\n  set = {name}\n  fix = {fix}\n" for name, fix in
                                               (("x_min", axis), ("y_min", across), ("z_min", "z")))
                + f"*PHASE press\n  control = load\n  trial = 0.1\n  displace = x_max {axis} {by}\n"
                "*HISTORY edge\n  set = x_max\n  quantities = draw_in\n")

    bench.run("flat", deck("*BLANK sheet\n  size = 10 10 1\n  divisions = 2 2 1\n  material = mild_steel\n", "x", -0.5))
    values = []
    for number, (first, axis, by, second, to, way) in enumerate((
            ("", "x", -0.5, "", "x", -0.25), ("  move = 20 3 0\n", "x", -0.5, "  move = -8 1 2\n", "x", -0.25),
            ("  turn = 1 2 3  0 0 1  90\n", "y", -0.5, "  turn = -4 0 0  0 0 1  90\n  move = 0 5 0\n", "x", 0.25))):
        once = bench.run(f"placed_{number}", deck(f"*START\n  from = flat.out\n{first}", axis, by))
        again = bench.run(f"again_{number}", deck(f"*START\n  from = placed_{number}.out\n{second}", to, way))
        for run in (once, again):
            check("W106" not in {message["code"] for message in run.job["warnings"]}, "placed: W106")
        fields = dd3.open(again.folder).fields[-1].point_data["draw_in"]
        values.append((once.last("edge_draw_in"), again.last("edge_draw_in"),
                       float(np.max(fields))))
    names = "draw-in, mm", "draw-in of the next operation, mm", "largest draw-in, mm"
    check_values(*(Value(f"placed {number}: {name}", expected, found, 1e-6) for number, line in enumerate(values[1:], 1)
                   for name, expected, found in zip(names, values[0], line)),
                 Value("placed: largest draw-in, mm", 1.25, values[0][2], 1e-6))


def bent_on(bench):
    """Bend the end of a sheet by 18 degrees in one run, and from there to 36 degrees in another, in another place."""
    def deck(start, bend):
        return (f"{start}{MATERIAL}*BOUNDARY left\n  set = x_min\n  fix = x y z\n*HISTORY right\n  set = x_max\n"
                f"  quantities = position\n*PHASE bend\n  control = load\n  trial = 0.1\n  keep = ${{keep}}\n  bend = x_max {bend}\n")

    sheet = ("*PARAMETER\n  keep = on\n*BLANK sheet\n  size = 40 10 1\n  divisions = 10 1 1\n  material = mild_steel\n")
    once = bench.run("bent_once", deck(sheet, "0 5 0.5  0 -1 0  18"))
    start = "*PARAMETER\n  keep = off\n*START\n  from = bent_once.out\n  turn = 0 0 0  0 0 1  90\n  move = 0 0 25\n"
    again = bench.run("bent_on", deck(start, "-5 0 25.5  1 0 0  36"))
    values = []
    for run, along, bottom, angle in ((once, "x", 0.5, np.radians(18)), (again, "y", 25.5, np.radians(36))):
        values += [Value(f"{run.folder.stem}: along the strip, mm", 40 * np.sin(angle) / angle, run.last(f"right_{along}"), 1e-9),
                   Value(f"{run.folder.stem}: height, mm", bottom + 40 * (1 - np.cos(angle)) / angle, run.last("right_z"), 1e-9)]
    check_values(*values)
    # Nodes that no support of this run holds have no reaction, from the first row on.
    freed = bench.run("bent_freed", "*START\n  from = bent_once.out\n" + MATERIAL + "*BOUNDARY left\n  set = x_min\n"
                      "  fix = x y z\n*HISTORY right\n  set = x_max\n  quantities = reaction\n" + UNLOAD)
    check_values(Value("bent_freed: reactions of the free end, N", 0, max(map(abs, freed.column("right_rx"))), 1e-6, True))
    # A state at the end of a phase that an earlier run has left is none of this run.
    bench.run("bent_once", bench.work / "bent_once.dat", {"keep": "off"})
    found = bench.refuse("bent_from_old", deck(start.replace("bent_once.out", "bent_once.out/bend"), "-5 0 25.5  1 0 0  36"))
    check("E152" in found and "does not exist" in found, found)


def turned(bench):
    """Release a bent strip of an orthotropic material as it is, and turned about an oblique axis and moved."""
    bench.run("arc", MATERIAL + BEND.replace("60 6 1", "30 4 1"))
    tight = "*NEWTON\n  tolerance = 1e-9\n" + UNLOAD.replace("= on", "= at_once")
    one, other = (dd3.open(bench.run(name, f"*START\n  from = arc.out\n{place}{MATERIAL}{tight}").folder).fields[-1]
                  for name, place in (("arc_free", ""), ("arc_turned", "  turn = 3 -2 5  1 2 3  37\n  move = 4 5 6\n")))
    apart = distance(np.asarray(one.points), np.asarray(other.points))
    stress = np.abs(one.cell_data["equivalent_stress"] - other.cell_data["equivalent_stress"]).max()
    check_values(Value("turned: distance from the release of the strip as it is, mm", 0, apart, 1e-8, absolute=True),
                 Value("turned: largest difference of the stress, MPa", 0, float(stress), 1e-6, absolute=True))


def carried(bench):
    """Take over a bent strip of a material of many laws as it is, and turned, and release both."""
    bend = BEND.replace("60 6 1", "12 2 1").replace("mild_steel", "many_laws") + "  duration = 1\n"
    bent = dd3.open(bench.run("laws", LAWS + bend).folder).fields[-1]
    tight = "*NEWTON\n  tolerance = 1e-9\n" + UNLOAD.replace("= on", "= at_once") + "  duration = 1\n"
    places = (("laws_free", ""), ("laws_turned", "  turn = 3 -2 5  1 2 3  37\n  move = 4 5 6\n"))
    one, other = (dd3.open(bench.run(name, f"*START\n  from = laws.out\n{place}{LAWS}{tight}").folder).fields
                  for name, place in places)
    for name in VARIABLES:
        was, taken, free, turned_free = (sizes(grid, name) for grid in (bent, one[0], one[-1], other[-1]))
        largest = np.abs(was).max()
        check(largest > 0, f"carried: {name} is zero")
        # The flow stress of an increment lags behind its temperature by the work of the back-stress: at the take-over,
        # an increment without strain, the strip flows by 2e-8.
        check_values(Value(f"carried: {name}, largest difference at the take-over", 0,
                           float(np.abs(taken - was).max() / largest), 1e-5, absolute=True),
                     Value(f"carried: {name}, largest difference of the turned strip", 0,
                           float(np.abs(turned_free - free).max() / largest), 1e-9, absolute=True))


def sizes(grid, name):
    """Return a field at the elements: a scalar, the norm of a tensor, the rise of the temperature."""
    values = np.asarray(grid.cell_data[name], float)
    if name == "temperature":
        return values - 20
    return np.linalg.norm(values * np.sqrt([1, 1, 1, 2, 2, 2]), axis=1) if values.ndim > 1 else values


def refined(bench):
    """Release a strip whose elements were divided, by another run and by one run. The friction of the tools that are
    withdrawn makes 1.7 % of the springback in a strip of 96 equal elements."""
    deck = forming().replace("*BLANK strip\n", "*BLANK strip\n  adaptive = 2\n")
    settings = {"divisions": "24 1 1", "points": 5, "depth": 15}
    draw = bench.run("divided", deck, settings)
    whole = bench.run("divided_whole", deck + UNLOAD, settings)
    found = bench.run("divided_released", f"*START\n  from = divided.out\n{MATERIAL}{SUPPORTS}{UNLOAD}")
    sheets = [dd3.open(run.folder).fields[-1] for run in (draw, whole, found)]
    check(sheets[0].n_cells > 60 and "level" in sheets[2].cell_data, "no elements were divided")
    before, expected, after = (np.asarray(sheet.points) for sheet in sheets)
    check(before.shape == expected.shape == after.shape, "the meshes differ")
    check_values(Value("refined: distance from the release by one run, mm", 0, distance(after, expected),
                       0.025 * distance(before, expected), absolute=True))


def cut_wall(bench):
    """Cut the wall of the drawn strip free, by a plane across its height."""
    drawn(bench)
    whole = bench.run("whole_wall", f"*START\n  from = draw.out\n{MATERIAL}{SUPPORTS}{UNLOAD}")
    deck = ("*START\n  from = draw.out\n" + MATERIAL + SUPPORTS + "*TRIM cut\n"
            "  points = 0 -5 -20.3   0 5 -20.3   0 5 50   0 -5 50\n  along = 1 0 0\n" + UNLOAD)
    cut = bench.run("wall", deck)
    check_values(Value("curvature of the wall, 1/mm", curvature(whole.folder, 44, 48),
                       curvature(cut.folder, 44, 48), 1e-4))
    check(len(middle(cut.folder)[0]) < len(middle(whole.folder)[0]) - 10, "the bottom of the strip was not cut off")


def cut_bend(bench):
    """Cut a bent strip obliquely, and release it."""
    bent = bench.run("bent", MATERIAL + BEND)
    moment = bent.last("root_my") / 8
    radius = 50.0
    deck = ("*START\n  from = bent.out\n" + MATERIAL + "*BOUNDARY plane\n  set = all\n  fix = y\n"
            "*TRIM cut\n  points = -5 -5 0.5   36 -5 0.5   43 15 0.5   -5 15 0.5\n" + UNLOAD)
    cut = bench.run("cut_bend", deck)
    stiffness = 2.06e5 / (1 - 0.3 ** 2) / 12
    check("least angle" in cut.output + (cut.folder / "job.log").read_text(), "no report of the cut")
    found = curvature(cut.folder, 8, 28)
    # The sheet bends downwards: its lower face is half a thickness nearer to the centre.
    curved = 1 / (1 / abs(found) + 0.5)
    check_values(Value("curvature after the cut, 1/mm", 1 / radius - abs(moment) / stiffness, curved, 5e-3))


def cut_on_sheet(bench):
    """Cut a circular hole out of the bent strip, normal to it, by a curve that lies on its middle."""
    bench.run("bent", MATERIAL + BEND)
    radius, hole, centre = 50.0, 1.7, (27.3, 4.1)
    angle = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    x, y = centre[0] + hole * np.cos(angle), centre[1] + hole * np.sin(angle)
    # The middle of the strip is bent downwards about (0, 0.5 - radius).
    points = np.column_stack((radius * np.sin(x / radius), y, 0.5 - radius + radius * np.cos(x / radius)))
    (bench.work / "hole.txt").write_text("".join(f"{a:.9f} {b:.9f} {c:.9f}\n" for a, b, c in points))
    deck = ("*START\n  from = bent.out\n" + MATERIAL + "*BOUNDARY plane\n  set = all\n  fix = y\n"
            "*TRIM hole\n  file = hole.txt\n  along = 0 0 0\n  keep = outside\n" + UNLOAD)
    run = bench.run("cut_on_sheet", deck)
    with h5py.File(run.folder / "restart.h5") as file:
        names = "".join(map(chr, file["mesh/sets"][...])).split()
        sizes = file["mesh/set_size"][...]
        first = sizes[:names.index("hole")].sum()
        nodes = file["mesh/set_node"][...][first:first + sizes[names.index("hole")]] - 1
        initial = file["mesh/x0"][...].reshape(-1, 3)[nodes, :2]
    away = np.linalg.norm(initial - centre, axis=1)
    check(len(nodes) >= 16, f"{len(nodes)} nodes on the hole")
    check_values(Value("radius of the hole in the blank, least, mm", hole, float(away.min()), 0.02, absolute=True),
                 Value("radius of the hole in the blank, largest, mm", hole, float(away.max()), 0.02, absolute=True))


def staircase(across, along, line):
    """Return a polygon along the sides of the elements of a strip of 60 x 8 mm whose middle has x - y < line."""
    points = [(-1.0, -1.0)]
    for row in range(across):
        y = (row + 0.5) * 8 / across
        x = 60 / along * sum((k + 0.5) * 60 / along - y < line for k in range(along))
        points += [(x, -1.0 if row == 0 else row * 8 / across), (x, 9.0 if row == across - 1 else (row + 1) * 8 / across)]
    return [*points, (-1.0, 9.0)]


def on_arc(points):
    """Return a polygon of the flat strip, in steps of 0.25 mm, on the middle of the one bent to a radius of 50 mm."""
    text = ""
    for (x0, y0), (x1, y1) in zip(points, points[1:] + points[:1]):
        count = max(1, round(np.hypot(x1 - x0, y1 - y0) / 0.25))
        for part in np.arange(count) / count:
            x, y = x0 + part * (x1 - x0), y0 + part * (y1 - y0)
            text += f"{50 * np.sin(x / 50):.9f} {y:.9f} {0.5 - 50 + 50 * np.cos(x / 50):.9f}\n"
    return text


def cut_by_elements(bench):
    """Cut the bent strip at 45 degrees, by the curve and by the sides of the elements, on two meshes, and release it:
    the area is that of the curve, and the elastic energy of its area that of the other."""
    free = BEND[BEND.index("*SET foot"):BEND.index("*HISTORY")].replace("set = all", "set = one") + (
        "*SET one\n  near = 0 0 0\n")
    line, found = 32.3, {}
    for along, across in ((30, 4), (60, 8)):
        blank = BEND.replace("60 6 1", f"{along} {across} 1").replace("set = all", "set = one")
        bench.run(f"flat_{along}", MATERIAL + blank + "*SET one\n  near = 0 0 0\n")
        for name, polygon in (("curve", [(-1, -1), (line - 1, -1), (line + 9, 9), (-1, 9)]),
                              ("elements", staircase(across, along, line))):
            (bench.work / f"{name}.txt").write_text(on_arc(polygon))
            run = bench.run(f"{name}_{along}", f"*START\n  from = flat_{along}.out\n{MATERIAL}{free}*TRIM cut\n"
                            f"  file = {name}.txt\n  along = 0 0 0\n{UNLOAD}")
            grid = dd3.open(run.folder).fields[-1]
            place = np.asarray(grid.points) - np.asarray(grid["displacement"])
            a, b, c, d = (place[grid.cells.reshape(-1, 9)[:, k], :2] for k in range(1, 5))
            one, other = c - a, d - b
            area = 0.5 * abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]).sum()
            found[name, along] = area / (8 * (line + 4)), run.last("elastic_energy") / area
            print(f"{name}, {along} x {across}: area {100 * found[name, along][0] - 100:+.2f} %, energy "
                  f"{found[name, along][1]:.6f} mJ/mm2")
    for along, error in ((30, 3e-3), (60, 1e-3)):
        check_values(Value(f"area by the curve, {along} elements, over the polygon's", 1, found["curve", along][0], 4e-4),
                     Value(f"energy by elements, {along} elements", found["curve", along][1],
                           found["elements", along][1], error))


def dynain(bench):
    """Release the bent strip from a dynain file that was written of it, with its plastic strains and thicknesses."""
    bench.run("bent", MATERIAL + BEND)
    supports = ("*BOUNDARY plane\n  set = all\n  fix = y\n*SET left\n  box = -0.1 0.1 -1 9 -1 2\n"
                "*BOUNDARY left\n  set = left\n  fix = x\n")
    own = bench.run("bent_released", "*START\n  from = bent.out\n" + MATERIAL + supports + UNLOAD)
    dd3.export.main([str(bench.work / "bent.out"), str(bench.work / "dynain.k"), "--shells"])
    dd3.dynain.main([str(bench.work / "dynain.k"), str(bench.work / "formed.out"), "--material", "mild_steel"])
    run = bench.run("taken", "*START\n  from = formed.out\n" + MATERIAL + supports + UNLOAD)
    found, expected = (np.asarray(dd3.open(folder).fields[-1].points) for folder in (run.folder, own.folder))
    found, expected = (np.unique(np.round(points[:, [0, 2]], 9), axis=0) for points in (found, expected))
    check_values(Value("largest x of the released strip, mm", float(expected[:, 0].max()), float(found[:, 0].max()), 1e-4))
    ends = [float(np.ptp(points[:, 1])) for points in (expected, found)]
    check_values(Value("height of the released strip, mm", *ends, 2e-3))


def restruck(bench):
    """Form the released strip again by the same tools, and continue that run."""
    drawn(bench)
    bench.run("released", f"*START\n  from = draw.out\n{MATERIAL}{SUPPORTS}{UNLOAD}")
    tools = forming()
    tools = tools[tools.index("*TOOL punch"):tools.index("*BOUNDARY")]
    deck = ("*START\n  from = released.out\n  move = 0 0 42\n" + MATERIAL + tools.replace("friction = 0.144\n  contact = z_max",
            "friction = 0.144\n  contact = z_max\n  position = 0 0 48") + SUPPORTS
            + "*PHASE close\n  control = punch\n  trial = 1\n  move = punch 0 0 -70\n  release = holder\n" + UNLOAD)
    run = bench.run("restruck", deck)
    check(run.last("die_fz", "close") < -0.1, "the strip does not press on the die")
    file = run.folder / "restart.h5"
    shutil.copy(file, bench.work / "end.h5")
    again = bench.run("restruck", deck, options=["--restart", str(bench.work / "end.h5")])
    check(again.row() == run.row(), "the run continued from its end differs")


def refused(bench):
    """Refuse what cannot be done."""
    drawn(bench)
    start = "*START\n  from = {}\n" + MATERIAL + SUPPORTS
    bench.run("unended", forming().replace("trial = 1.0", "trial = 1.0\n  until = displacement punch 3")
              + "*PHASE none\n  control = load\n  trial = 1\n  load = x_max 1e9 0 0\n", SETTINGS, codes=(3,))
    cases = {
        "missing": (start.format("nowhere.out") + UNLOAD, "E152", "does not exist"),
        "unended_start": (start.format("unended.out") + UNLOAD, "E152", "has not reached its end"),
        "material": (start.format("draw.out").replace("K=565.32", "K=566") + UNLOAD, "E152", "differs from"),
        "other_name": (start.format("draw.out").replace("*MATERIAL mild_steel", "*MATERIAL steel") + UNLOAD, "E152",
                       "is of material 'mild_steel'"),
        "axis": (start.format("draw.out").replace("draw.out\n", "draw.out\n  turn = 0 0 0 0 0 0 5\n") + UNLOAD, "E135",
                 "axis of the turn"),
        "no_curve": (start.format("draw.out") + "*TRIM t\n" + UNLOAD, "E132", "no curve"),
        "no_file": (start.format("draw.out") + "*TRIM t\n  file = nothing.txt\n" + UNLOAD, "E101", "cannot read"),
        "misses": (start.format("draw.out") + "*TRIM t\n  points = 900 0 0  905 0 0  905 5 0\n  keep = outside\n" + UNLOAD,
                   "E153", "misses the sheet"),
        "open": (start.format("draw.out") + "*TRIM t\n  points = 0 0 0  5 0 0  9 1 0  14 5 0\n" + UNLOAD, "E153",
                 "is open"),
        "rolling": (start.format("draw.out").replace("  young", "  rolling_direction = 0 1 0\n  young") + UNLOAD, "E152",
                    "rolling_direction of material 'mild_steel'"),
        "set": (start.format("draw.out") + "*HISTORY h\n  set = nothing\n  quantities = position\n" + UNLOAD, "E113",
                "there is no set"),
    }
    for name, (deck, code, text) in cases.items():
        found = bench.refuse(name, deck)
        check(code in found and text in found, f"{name}: {code} and '{text}' are not in\n{found}")
        print(f"refused: {name}", flush=True)
    before = (bench.work / "draw.out" / "restart.h5").read_bytes()
    found = bench.refuse("itself", start.format("draw.out") + UNLOAD + "*OUTPUT\n  directory = draw.out\n", "")
    check("E151" in found and (bench.work / "draw.out" / "restart.h5").read_bytes() == before, found)
    bench.run("unended_last", start.format("unended.out\n  at = last") + UNLOAD, codes=(0,))


TESTS = (released, placed, bent_on, turned, carried, refined, cut_wall, cut_bend, cut_on_sheet, cut_by_elements, dynain, restruck,
         refused)


def main():
    """Call the tests."""
    parser = parser_of_runs(__doc__)
    names = [test.__name__ for test in TESTS]
    parser.add_argument("--only", nargs="+", choices=names, default=names)
    options = parser.parse_args()
    shutil.rmtree(options.work, ignore_errors=True)
    bench = Bench(options.program, options.work)
    for test in TESTS:
        if test.__name__ in options.only:
            print(f"== {test.__name__}", flush=True)
            test(bench)


if __name__ == "__main__":
    main()
