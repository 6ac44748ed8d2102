#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "operations", "timeout": 900}
"""Operations after one another: the sheet of another run (*START), cuts (*TRIM), and what is refused.

    run.py --program build/release/dd3imp --work build/operations [--only NAME]

- released: a strip drawn in one run and released in another has the shape of the strip that one run draws and releases,
  also where it is moved and turned between the two.
- cut_wall: the wall of a drawn strip, cut free, curls as it does on the whole strip; its stresses carry no moment.
- cut_bend: a strip bent to an arc, cut obliquely and released, springs back by M/(E' I).
- cut_on_sheet: a circle on the middle of the bent strip is cut out normal to it: it is a circle in the blank.
- restruck: the released strip is formed again by the same tools; the run continues from its end, on the same mesh.
- refused: a run that has not ended, one without a sheet, another material, curves that are open or miss the sheet.
"""
import pathlib
import shutil
import sys

import h5py
import numpy as np

import dd3
from dd3.errors import check
from dd3.programs import parser_of_runs

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from bench import Bench, Value, check_values  # noqa: E402

DRAW = ROOT / "input_files" / "draw_bending" / "draw_bending.dat"
UNLOAD = "*PHASE springback\n  unload = on\n"
SETTINGS = {"divisions": "90 1 1", "points": 7, "depth": 30}
MATERIAL = """*MATERIAL mild_steel
  young = 2.06e5
  poisson = 0.30
  yield = hill48 r0=1.79 r45=1.51 r90=2.27
  hardening = swift K=565.32 e0=0.007117 n=0.2589
"""
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
    whole = bench.run("whole", forming() + UNLOAD, SETTINGS)
    for name, place in (("released", ""), ("moved", "  turn = 3 0 5  0 1 0  180\n  move = 1 0 3\n")):
        run = bench.run(name, f"*START\n  from = draw.out\n{place}{MATERIAL}{SUPPORTS}{UNLOAD}")
        check("N106" in {message["code"] for message in run.job["notes"]}, f"{name}: no N106")
        found = np.asarray(dd3.open(run.folder).fields[-1].points)
        expected = np.asarray(dd3.open(whole.folder).fields[-1].points)
        check_values(Value(f"{name}: distance from the release by one run, mm", 0, distance(found, expected), 1e-4,
                           absolute=True))


def cut_wall(bench):
    """Cut the wall of the drawn strip free, by a plane across its height."""
    drawn(bench)
    whole = bench.run("whole_wall", forming() + UNLOAD, SETTINGS)
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


TESTS = (released, cut_wall, cut_bend, cut_on_sheet, restruck, refused)


def main():
    """Call the tests."""
    parser = parser_of_runs(__doc__)
    parser.add_argument("--only", choices=[test.__name__ for test in TESTS])
    options = parser.parse_args()
    shutil.rmtree(options.work, ignore_errors=True)
    bench = Bench(options.program, options.work)
    for test in TESTS:
        if options.only in (None, test.__name__):
            print(f"== {test.__name__}", flush=True)
            test(bench)


if __name__ == "__main__":
    main()
