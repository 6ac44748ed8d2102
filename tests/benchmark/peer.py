#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run one bending job with dd3imp and with CalculiX and compare force, increments and processor time.

    tests/benchmark/peer.py --program build/release/dd3imp --work /tmp/peer
    tests/benchmark/peer.py --program build/release/dd3imp --work /tmp/peer --columns 80 --friction 0.1

One half of a strip in plane strain, 40 x 1 x 1 mm, is bent to a U without a blank-holder. Both codes get the same
nodes, the same pairs of flow stress and plastic strain, and the same profiles of the tools: exact arcs in dd3imp,
facets with their nodes on the arcs in CalculiX. Each chooses its increments; one thread. CalculiX is the package
calculix-ccx of Debian. --write puts the table without friction into docs/reports/speed.md.
"""

import argparse
import math
from pathlib import Path

from speed import PAGE

from dd3.errors import Problem, run
from dd3.pages import put_table, table
from dd3.programs import command, find_program, launch, made_folder
from dd3.run import read_job
from dd3.tables import read_table, read_text

ROOT = Path(__file__).resolve().parents[2]

LENGTH, THICKNESS, LAYERS, TRAVEL = 40.0, 1.0, 2, 9.0
YOUNG, POISSON = 2.1e5, 0.3
# Strains of the table, and Swift's law of mild steel.
STRAINS = [0.0, *(10 ** (-4 + i / 12) for i in range(49))]
CURVE = [(strain, 565 * (0.007117 + strain) ** 0.259) for strain in STRAINS]
# Points x z of the profiles, with the corner of an arc of 90 degrees between two; the sheet lies on the left of the
# die's path and on the right of the punch's.
FRICTION = 0.1  # of the second table
PUNCH = [((-5, 1), (10, 1)), ((10, 1), (15, 1), (15, 6)), ((15, 6), (15, 40))]
DIE = [((17, -40), (17, -5)), ((17, -5), (17, 0), (22, 0)), ((22, 0), (60, 0))]

DECK = """*PARAMETER
  strain = 0.05
  rotation = 2

*BLANK strip
  size = {length} 1 {thickness}
  divisions = {columns} 1 {layers}
  element = hex8
  material = steel

*MATERIAL steel
  young = {young}
  poisson = {poisson}
  yield = von_mises
  hardening = table {pairs}

*TOOL punch
  patches = "punch.bez"
  friction = {friction}
  contact = z_max

*TOOL die
  patches = "die.bez"
  friction = {friction}
  contact = z_min

*CONTACT

*BOUNDARY symmetry
  set = x_min
  fix = x

*BOUNDARY plane_strain
  set = all
  fix = y

*LIMITS
  strain = ${{strain}}
  rotation = ${{rotation}}

*PHASE draw
  control = punch
  trial = 1.0
  hold = die
  move = punch 0 0 -{travel}

*OUTPUT
  fields = at {travel}
"""

# The displacements of the tools are prescribed at each node. *CONTROLS allows 20 cut-backs, 5 by default; the tension
# of open contact is 1e-3 MPa, 3 by default, and acts up to a gap of 0.01 of the root of the node's area.
STEP = """*MATERIAL, NAME=STEEL
*ELASTIC
{young}, {poisson}
*PLASTIC
{pairs}
*MATERIAL, NAME=TOOL
*ELASTIC
{young}, {poisson}
*SOLID SECTION, ELSET=SHEET, MATERIAL=STEEL
*SOLID SECTION, ELSET=PUNCH, MATERIAL=TOOL
*SOLID SECTION, ELSET=DIE, MATERIAL=TOOL
*SURFACE INTERACTION, NAME=RUB
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
{slope}, 1e-3, 0.01
{friction}*CONTACT PAIR, INTERACTION=RUB, TYPE={contact}
TOP, PUNCHFACE
*CONTACT PAIR, INTERACTION=RUB, TYPE={contact}
BOTTOM, DIEFACE
*BOUNDARY
NSHEET, 2
NLEFT, 1
NDIE, 1, 3
NPUNCH, 1, 2
*STEP, NLGEOM, INC=100000
*CONTROLS, PARAMETERS=TIME INCREMENTATION
4, 8, 9, 16, 10, 4, , 20
*STATIC
{first}, 1., 1e-6, {largest}
*BOUNDARY
NPUNCH, 3, 3, -{travel}
*NODE PRINT, NSET=NPUNCH, TOTALS=ONLY
RF
*END STEP
"""


# ---- dd3imp ----------------------------------------------------------------------------------------------------------

def patch(segment, widths):
    """Return the text of the patch of a line or an arc, between two y."""
    weights = (1.0, math.sqrt(0.5), 1.0) if len(segment) == 3 else (1.0, 1.0)
    lines = [f"patch {len(segment) - 1} 1 rational"]
    lines += [f"  {x} {y} {z} {weight!r}" for y in widths for (x, z), weight in zip(segment, weights)]
    return "\n".join(lines) + "\n"


def write_deck(arguments):
    """Write the input of dd3imp; return its path."""
    folder, columns = arguments.work, arguments.columns
    for name, profile, widths in (("punch", PUNCH, (6, -5)), ("die", DIE, (-5, 6))):
        patches = "".join(patch(segment, widths) for segment in profile)
        (folder / f"{name}.bez").write_text(patches, encoding="utf-8")
    pairs = " &\n    ".join(f"{strain:.6g}:{stress:.7g}" for strain, stress in CURVE)
    deck = folder / "u_bend.dat"
    text = DECK.format(length=LENGTH, thickness=THICKNESS, columns=columns, layers=LAYERS, young=YOUNG,
                       poisson=POISSON, pairs=pairs, friction=arguments.friction, travel=TRAVEL)
    deck.write_text(text, encoding="utf-8")
    return deck


def run_dd3imp(arguments):
    """Return increments, attempts, iterations, processor time and (travel, force) of dd3imp."""
    folder = arguments.work / f"dd3imp_{arguments.columns}"
    deck = write_deck(arguments)
    options = ["--quiet", "--threads", 1]
    settings = dict(word.split("=") for word in arguments.set)
    done = launch(command(arguments.program, deck, folder, options, settings))
    if done.code:
        raise Problem(f"{deck}: {done.errors}")
    rows = [row for row in read_table(folder / "status.csv") if row.get("outcome")]
    curve = [(float(row["travel"]), float(row["punch_fz"])) for row in read_table(folder / "history.csv")]
    good = sum(row["outcome"] == "accepted" for row in rows)
    return good, len(rows), sum(int(row["iterations"]) for row in rows), done.cpu, curve


# ---- CalculiX --------------------------------------------------------------------------------------------------------

def points_of(segment, pieces):
    """Return the points of a line or an arc, each with its normal on the left of the path."""
    if len(segment) == 2:
        begin, end = segment
        length = math.dist(begin, end)
        return [(point, ((begin[1] - end[1]) / length, (end[0] - begin[0]) / length)) for point in segment]
    begin, corner, end = segment
    centre, radius = [begin[k] + end[k] - corner[k] for k in (0, 1)], math.dist(begin, corner)
    found = []
    for i in range(pieces + 1):
        c, s = math.cos(math.pi / 2 * i / pieces), math.sin(math.pi / 2 * i / pieces)
        x, z = (c * (begin[k] - centre[k]) + s * (end[k] - centre[k]) for k in (0, 1))
        along = [c * (end[k] - centre[k]) - s * (begin[k] - centre[k]) for k in (0, 1)]
        found.append(((centre[0] + x, centre[1] + z), (-along[1] / radius, along[0] / radius)))
    return found


class Mesh:
    """Nodes, elements, sets and surfaces of an input file of CalculiX."""

    def __init__(self):
        self.nodes, self.lines, self.count = [], [], 0

    def add_block(self, name, grid, element):
        """Add the hexahedra of a grid [along][up] of points (x, z) between y = widths; return the elements' numbers."""
        widths = (0.0, 1.0) if name == "SHEET" else (-0.5, 1.5)
        first, up = len(self.nodes) + 1, len(grid[0])
        self.nodes += [(x, y, z) for row in grid for x, z in row for y in widths]
        self.lines.append(f"*ELEMENT, TYPE={element}, ELSET={name}")
        numbers = {}
        for i in range(len(grid) - 1):
            for k in range(up - 1):
                a, b = first + 2 * (i * up + k), first + 2 * ((i + 1) * up + k)
                self.count += 1
                numbers[i, k] = self.count
                corners = (a, b, b + 1, a + 1, a + 2, b + 2, b + 3, a + 3)
                self.lines.append(f"{self.count}, " + ", ".join(map(str, corners)))
        self.lines.append(f"*NSET, NSET=N{name}, GENERATE\n{first}, {len(self.nodes)}")
        return numbers

    def add_surface(self, name, elements, face):
        """Add a surface of one face of each element."""
        self.lines.append(f"*SURFACE, NAME={name}, TYPE=ELEMENT")
        self.lines += [f"{element}, S{face}" for element in elements]

    def text(self):
        """Return the mesh as a text."""
        nodes = [f"{i}, {x:.12g}, {y:.12g}, {z:.12g}" for i, (x, y, z) in enumerate(self.nodes, 1)]
        return "\n".join(["*NODE", *nodes, *self.lines]) + "\n"


def tool_grid(profile, pieces, body):
    """Return the points of a layer of elements, 1 mm thick, on the left (body = 1) or right (-1) of a profile."""
    found = []
    for segment in profile:
        found += points_of(segment, pieces)[1 if found else 0:]
    return [(point, tuple(p + body * n for p, n in zip(point, normal)))[::body] for point, normal in found]


def make_mesh(arguments):
    """Return the mesh of CalculiX with its sets and surfaces."""
    mesh, columns = Mesh(), arguments.columns
    heights = [THICKNESS * k / LAYERS for k in range(LAYERS + 1)]
    grid = [[(LENGTH * i / columns, height) for height in heights] for i in range(columns + 1)]
    sheet = mesh.add_block("SHEET", grid, arguments.element)
    mesh.lines.append(f"*NSET, NSET=NLEFT, GENERATE\n1, {2 * (LAYERS + 1)}")
    mesh.add_surface("TOP", [sheet[i, LAYERS - 1] for i in range(columns)], 2)
    mesh.add_surface("BOTTOM", [sheet[i, 0] for i in range(columns)], 1)
    for name, profile, body, face in (("PUNCH", PUNCH, 1, 1), ("DIE", DIE, -1, 2)):
        tool = mesh.add_block(name, tool_grid(profile, arguments.facets, body), "C3D8")
        mesh.add_surface(name + "FACE", tool.values(), face)
    return mesh


def write_input(arguments):
    """Write the input of CalculiX; return its path without the ending."""
    pairs = "\n".join(f"{stress:.7g}, {strain:.6g}" for strain, stress in CURVE)
    friction = f"*FRICTION\n{arguments.friction}, {arguments.stick}\n" if arguments.friction else ""
    path = arguments.work / f"u_bend_{arguments.columns}"
    step = STEP.format(young=YOUNG, poisson=POISSON, pairs=pairs, slope=arguments.slope, friction=friction,
                       contact=arguments.contact, first=0.01, largest=arguments.largest / TRAVEL, travel=TRAVEL)
    path.with_suffix(".inp").write_text(make_mesh(arguments).text() + step, encoding="utf-8")
    return path


def read_forces(path):
    """Return (travel, force on the punch) from the .dat of CalculiX; the force along z."""
    found, time = [(0.0, 0.0)], None
    for line in path.read_text(encoding="utf-8").splitlines():
        words = line.split()
        if "time" in words:
            time = float(words[-1])
        elif time is not None and len(words) == 3:
            found.append((TRAVEL * time, -float(words[2])))
            time = None
    return found


def run_calculix(arguments):
    """Return increments, attempts, iterations, processor time and (travel, force) of CalculiX."""
    path = write_input(arguments)
    done = launch([arguments.ccx, "-i", path.name], arguments.timeout, folder=arguments.work)
    path.with_suffix(".log").write_text(done.output + done.errors, encoding="utf-8")
    rows = [line.split() for line in read_text(path.with_suffix(".sta")).splitlines()[2:]]
    curve = read_forces(path.with_suffix(".dat"))
    if curve[-1][0] < TRAVEL * (1 - 1e-6):
        raise Problem(f"CalculiX ended at {curve[-1][0]:.4g} mm after {done.cpu:.1f} s of processor time; "
                      f"see {path}.log")
    return len(curve) - 1, len(rows), sum(int(row[3]) for row in rows), done.cpu, curve


# ---- comparison ------------------------------------------------------------------------------------------------------

def force_at(curve, travel):
    """Return the force at a travel, linear between two increments."""
    for (left, low), (right, high) in zip(curve, curve[1:]):
        if left < travel <= right + 1e-9:
            return low + (high - low) * (travel - left) / (right - left)
    raise Problem(f"there is no force at {travel} mm")


def tables(ours, theirs, version):
    """Return the tables of both runs as Markdown."""
    lines = ["| | increments | attempts | iterations | processor time, s | the same per iteration |",
             "|---|---|---|---|---|---|"]
    for name, (good, tried, iterations, cpu, _) in (("dd3imp", ours), (f"CalculiX {version}, SPOOLES", theirs)):
        lines.append(f"| {name} | {good} | {tried} | {iterations} | {cpu:.1f} | {cpu / iterations:.3f} |")
    lines += ["", f"Processor time of CalculiX over that of dd3imp: {theirs[3] / ours[3]:.1f}; per iteration "
              f"{theirs[3] / theirs[2] / ours[3] * ours[2]:.1f}.", ""]
    places = range(1, int(TRAVEL) + 1)
    forces = [[force_at(curve, travel) for travel in places] for curve in (ours[4], theirs[4])]
    lines += ["| travel, mm | " + " | ".join(map(str, places)) + " |", "|---" * (len(places) + 1) + "|"]
    for name, row in zip(("dd3imp", "CalculiX"), forces):
        lines.append(f"| punch force, {name}, N | " + " | ".join(f"{force:.2f}" for force in row) + " |")
    lines.append("| difference, % | " + " | ".join(f"{100 * (b / a - 1):.1f}" for a, b in zip(*forces)) + " |")
    return "\n".join(lines)


def with_friction(arguments):
    """Run both with friction on two meshes; return the table."""
    rows = []
    arguments.friction = FRICTION
    for arguments.columns in (160, 80):
        for name, run_it in (("dd3imp", run_dd3imp), ("CalculiX", run_calculix)):
            good, tried, iterations, cpu, curve = run_it(arguments)
            rows.append([f"{arguments.columns} columns, {name}", str(good), str(tried), str(iterations), f"{cpu:.1f}",
                         ", ".join(f"{force_at(curve, place):.2f}" for place in (1, 3, 6, 9))])
    return table(["", "increments", "attempts", "iterations", "processor time, s",
                  "punch force at 1, 3, 6, 9 mm, N"], rows)


def command_line():
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, type=find_program, help="the program dd3imp")
    parser.add_argument("--work", required=True, type=made_folder, help="folder of the runs")
    parser.add_argument("--ccx", default="ccx", help="the program CalculiX (ccx)")
    parser.add_argument("--columns", type=int, default=160, help="elements along the strip (160)")
    parser.add_argument("--friction", type=float, default=0.0, help="coefficient of friction (0)")
    parser.add_argument("--facets", type=int, default=45, help="facets of an arc of 90 degrees, CalculiX (45)")
    parser.add_argument("--element", default="C3D8I", help="element of CalculiX (C3D8I)")
    parser.add_argument("--contact", default="NODE TO SURFACE", help="contact of CalculiX (NODE TO SURFACE)")
    parser.add_argument("--slope", type=float, default=1e3, help="pressure over depth, CalculiX, MPa/mm (1e3)")
    parser.add_argument("--stick", type=float, default=1e2, help="shear stress over slip, CalculiX, MPa/mm (1e2)")
    parser.add_argument("--largest", type=float, default=0.3, help="largest increment of CalculiX, mm (0.3)")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE",
                        help="limits of dd3imp: strain (0.05), rotation (2 degrees)")
    parser.add_argument("--timeout", type=float, default=3600, help="s for each run (3600)")
    parser.add_argument("--write", action="store_true", help="write docs/reports/speed.md")
    return parser


def main():
    """Run both, print, and write if asked."""
    arguments = command_line().parse_args()
    version = launch([arguments.ccx, "-v"]).output.split()[-1]
    text = tables(run_dd3imp(arguments), run_calculix(arguments), version)
    print(text)
    if arguments.write:
        put_table(PAGE, "CalculiX", text, [read_job(arguments.work / f"dd3imp_{arguments.columns}")])
        print(with_friction(arguments))


if __name__ == "__main__":
    run(main)
