# SPDX-License-Identifier: GPL-3.0-or-later
"""LS-DYNA decks of a strip that is drawn to a U, made for tests: of shells under a holder, and of solids."""

import math

import numpy as np

from dd3.tools.surface import points_on, read_patches

WIDTH = 10.0  # of the strip, mm
RADIUS, SEGMENTS = 5.0, 12  # of the tools' edges, mm, and the facets around a quarter


def arc(centre, start, end, radius=RADIUS):
    """Return points x z on an arc from an angle to another, degrees."""
    angles = [math.radians(start + (end - start) * i / SEGMENTS) for i in range(SEGMENTS + 1)]
    return [(centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in angles]


def profiles(thickness):
    """Return the lines x z of punch, die and holder: a punch 20 mm wide over a sheet about z = 0."""
    low, high = -thickness / 2, thickness / 2
    half = [(10.0, 30.0), *arc((10 - RADIUS, high + RADIUS), 0, -90), (0.0, high)]
    punch = half + [(-x, z) for x, z in half[-2::-1]]
    opening = 10 + 1.2 * thickness
    shoulder = [(45.0, low), *arc((opening + RADIUS, low - RADIUS), 90, 180), (opening, -30.0)]
    die = [shoulder, [(-x, z) for x, z in shoulder]]
    holder = [[(45.0, high), (opening + RADIUS, high)], [(-45.0, high), (-opening - RADIUS, high)]]
    return {"punch": [punch], "die": die, "holder": holder}


class Writer:
    """Nodes and elements of a deck."""

    def __init__(self, scale=1.0):
        self.scale, self.nodes, self.shells, self.solids, self.node_sets = scale, [], [], [], {}

    def node(self, *point):
        """Add a node and return its label."""
        self.nodes.append([self.scale * value for value in point])
        return len(self.nodes)

    def sweep(self, part, line):
        """Add shells of a line x z, 4 mm wider than the strip."""
        rows = [[self.node(x, y, z) for x, z in line] for y in (-2.0, WIDTH + 2)]
        for i in range(len(line) - 1):
            self.shells.append((part, rows[0][i], rows[0][i + 1], rows[1][i + 1], rows[1][i]))

    def text(self):
        """Return the cards."""
        lines = ["*NODE"] + [f"{i:8d}{x:16.8g}{y:16.8g}{z:16.8g}" for i, (x, y, z) in enumerate(self.nodes, 1)]
        for keyword, cells in (("*ELEMENT_SHELL", self.shells), ("*ELEMENT_SOLID", self.solids)):
            if cells:
                lines += [keyword] + ["".join(f"{value:8d}" for value in (i, *cell)) for i, cell in enumerate(cells, 1)]
        for number, labels in self.node_sets.items():
            lines += ["*SET_NODE_LIST", f"{number:10d}"]
            lines += ["".join(f"{label:10d}" for label in labels[i:i + 8]) for i in range(0, len(labels), 8)]
        return "\n".join(lines) + "\n"


def row(*values):
    """Return fields of ten columns."""
    return "".join(f"{value:>10}" for value in values)


def parts(names, first_section):
    """Return the parts: the blank of material 1, the others rigid."""
    lines = []
    for number, name in enumerate(names, 1):
        lines += ["*PART", name, row(number, first_section if number == 1 else 2, 1 if number == 1 else 2)]
    return lines


def rigid(young):
    """Return material and section of the tools."""
    return ["*MAT_RIGID", row(2, "7.8E-9", young, 0.3), "*SECTION_SHELL", row(2, 2, "", 2), row(1.0, 1.0, 1.0, 1.0)]


def contacts(names, friction):
    """Return a contact of the blank with each tool."""
    lines = []
    for number in range(2, len(names) + 1):
        lines += ["*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE_ID", row(number) + f"blank to {names[number - 1]}",
                  row(1, number, 3, 3), row(friction, friction), row("")]
    return lines


def curve(number, *points):
    """Return a curve."""
    return ["*DEFINE_CURVE", row(number)] + [f"{x:>20g}{y:>20g}" for x, y in points]


def shell_deck(elements=44, depth=8.0):
    """Return a deck of shells, mm, t, s: Barlat and Lian with m = 2, a curve, a holder under a force, velocities."""
    writer, names = Writer(), ["blank", "punch", "die", "holder"]
    step = 80.0 / elements
    rows = [[writer.node(-40 + step * i, y, 0.0) for i in range(elements + 1)] for y in (0.0, WIDTH)]
    for i in range(elements):
        writer.shells.append((1, rows[0][i], rows[0][i + 1], rows[1][i + 1], rows[1][i]))
    middle = [label for line in rows for label in line if abs(writer.nodes[label - 1][0]) < 1e-9]
    writer.node_sets = {1: middle, 2: rows[0] + rows[1]}
    for number, name in enumerate(names[1:], 2):
        for line in profiles(0.8)[name]:
            writer.sweep(number, line)
    stress = [(p, 400 * (0.01 + p)**0.2) for p in (0.0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8)]
    lines = ["*KEYWORD", "*TITLE", "U profile of shells", "*CONTROL_TERMINATION", row("0.02"), "*CONTROL_TIMESTEP",
             row("", "", "", "", "-1.0E-7"), "*CONTROL_ADAPTIVE", row("1.0E-4", 4.0), *parts(names, 1),
             "*SECTION_SHELL_TITLE", "sheet", row(1, 16, "", 7), row(0.8, 0.8, 0.8, 0.8), "*MAT_3-PARAMETER_BARLAT",
             row(1, "7.85E-9", "2.1E5", 0.3, 3.0), row(2.0, 1.8, 1.4, 2.1, 10), row(2.0), row("", "", "", 1.0, 0.0, 0.0),
             row(""), *rigid("2.1E5"), *curve(10, *stress), *curve(11, (0.0, 0.0), (0.001, 1.0), (1.0, 1.0)),
             # A trapezoid from 0.005 to 0.015 s, whose area is the depth.
             *curve(12, (0.0, 0.0), (0.005, 0.0), (0.006, depth / 0.009), (0.014, depth / 0.009), (0.015, 0.0),
                    (1.0, 0.0)),
             "*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(2, 3, 0, 12, -1.0), "*LOAD_RIGID_BODY", row(4, 3, 11, -1500.0),
             "*BOUNDARY_SPC_SET", row(1, 0, 1, 0, 0), row(2, 0, 0, 1, 0), *contacts(names, 0.1),
             "*INTERFACE_SPRINGBACK_LSDYNA", row(1)]
    return "\n".join(lines) + "\n" + writer.text() + "*END\n"


def solid_deck(elements=40, depth=6.0):
    """Return a deck of hexahedra, m, Pa: a bilinear material, a punch displaced between supports."""
    writer, names = Writer(1e-3), ["blank", "punch", "die"]
    step = 60.0 / elements
    grid = {(i, y, z): writer.node(-30 + step * i, y, z) for z in (-0.5, 0.5) for y in (0.0, WIDTH)
            for i in range(elements + 1)}
    for i in range(elements):
        writer.solids.append((1, *(grid[i + a, y, z] for z in (-0.5, 0.5)
                                   for a, y in ((0, 0.0), (1, 0.0), (1, WIDTH), (0, WIDTH)))))
    middle = [label for (i, _, _), label in grid.items() if 2 * i == elements]
    writer.node_sets = {1: middle, 2: list(grid.values())}
    for number, name in enumerate(names[1:], 2):
        for line in profiles(1.0)[name]:
            writer.sweep(number, line)
    lines = ["*KEYWORD", *parts(names, 1), "*SECTION_SOLID", row(1, 1), "*MAT_024", row(1, 7850.0, "2.1E11", 0.3, "2.0E8",
             "1.0E9"), *rigid("2.1E11"), *curve(11, (0.0, 0.0), (0.01, 1.0)), "*PARAMETER",
             row("R depth", f"{-1e-3 * depth:g}"), "*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(2, 3, 2, 11, "&depth"),
             "*BOUNDARY_SPC_SET", row(1, 0, 1, 0, 0), row(2, 0, 0, 1, 0), *contacts(names, 0.05)]
    return "\n".join(lines) + "\n" + writer.text() + "*END\n"


def roll_deck(angle=0.5):
    """Return a deck of shells between two rolls of radius 20 mm: they turn by an angle, rad; 4 nodes are pulled first."""
    writer, names = Writer(), ["strip", "upper", "lower"]
    rows = [[writer.node(-20 + 2 * i, y, 0.0) for i in range(13)] for y in (0.0, WIDTH)]
    for i in range(12):
        writer.shells.append((1, rows[0][i], rows[0][i + 1], rows[1][i + 1], rows[1][i]))
    writer.node_sets = {1: rows[0] + rows[1], 2: [rows[0][-1], rows[1][-1]]}
    for number, z in ((2, 20.5), (3, -20.5)):
        writer.sweep(number, [point for start in (0, 90, 180, 270)
                              for point in arc((0.0, z), start, start + 90, 20.0)[bool(start):]])
    lines = ["*KEYWORD", "*CONTROL_TERMINATION", row("0.02"), *parts(names, 1), "*SECTION_SHELL", row(1, 16, "", 5),
             row(1.0, 1.0, 1.0, 1.0), "*MAT_TRANSVERSELY_ANISOTROPIC_ELASTIC_PLASTIC",
             row(1, "7.85E-9", "2.1E5", 0.3, 300.0, 500.0, -1.6), *rigid("2.1E5"),
             *curve(2, (0.0, angle / 0.01), (0.01, angle / 0.01), (0.0101, 0.0), (1.0, 0.0)),
             *curve(4, (0.0, 10.0), (0.005, 10.0), (0.0055, 0.0), (1.0, 0.0)),
             "*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(2, 6, 0, 2, -1.0), row(3, 6, 0, 2, 1.0),
             "*LOAD_NODE_SET", row(2, 1, 4, 1.0), "*BOUNDARY_SPC_SET", row(1, 0, 0, 1, 0), *contacts(names, 0.125)]
    return "\n".join(lines) + "\n" + writer.text() + "*END\n"


def sampled(path, count):
    """Yield the points (v, u) of a regular grid on each patch of a tool."""
    t = np.linspace(0, 1, count + 1)
    for points, weights in read_patches(path):
        yield points_on(points, weights, t, t)


def cup_deck(folder, elements, depth):
    """Return the square cup of a folder of tools as shells: Hill (1948), Swift's law, a holder under 4900 N."""
    writer, names = Writer(), ["blank", "punch", "die", "holder"]
    grid = [[writer.node(75 * i / elements, 75 * j / elements, 0.39) for i in range(elements + 1)]
            for j in range(elements + 1)]
    meshes = [(1, grid)]
    for number, name in enumerate(names[1:], 2):
        meshes += [(number, [[writer.node(*point) for point in line] for line in net])
                   for net in sampled(folder / f"{name}.bez", 8)]
    for number, net in meshes:
        writer.shells += [(number, a[i], a[i + 1], b[i + 1], b[i]) for a, b in zip(net, net[1:])
                          for i in range(len(a) - 1)]
    writer.node_sets = {1: [line[0] for line in grid], 2: grid[0]}
    lines = ["*KEYWORD", "*CONTROL_TERMINATION", row(0.014), *parts(names, 1), "*SECTION_SHELL", row(1, 16, "", 5),
             row(0.78, 0.78, 0.78, 0.78), "*MAT_HILL_3R", row(1, "7.85E-9", "2.06E5", 0.3, 2.0, 565.32, 0.2589),
             row(1.79, 1.51, 2.27, "", 0.007117), *rigid("2.1E5"), *curve(11, (0.0, 0.0), (0.001, 1.0), (1.0, 1.0)),
             *curve(12, (0.0, 0.0), (0.002, 0.0), (0.012, depth), (1.0, depth)),
             "*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(2, 3, 2, 12, -1.0), "*LOAD_RIGID_BODY", row(4, 3, 11, -4900.0),
             "*BOUNDARY_SPC_SET", row(1, 0, 1, 0, 0, 0, 1, 1), row(2, 0, 0, 1, 0, 1, 0, 1), *contacts(names, 0.144)]
    return "\n".join(lines) + "\n" + writer.text() + "*END\n"


FLAT = {  # cards of flat_deck by name, in their order
    "head": ["*KEYWORD"],
    "control": ["*TITLE", "flat tools", "*CONTROL_TERMINATION", row(0.01)],
    "parameter": [],
    "material": ["*MAT_024", row(1, "7.85E-9", "2.1E5", 0.3, 200.0, 500.0), "", "", ""],
    "rigid": ["*MAT_RIGID", row(2, "7.85E-9", "2.1E5", 0.3), row(1, 4, 7), ""],
    "section": ["*SECTION_SHELL", row(1, 16, 0.833, 5), row(1.0, 1.0, 1.0, 1.0),
                "*SECTION_SHELL", row(2, 2), row(1.0, 1.0, 1.0, 1.0)],
    "blank": ["*PART", "blank", row(1, 1, 1)],
    "tools": ["*PART", "punch", row(2, 2, 2), "*PART", "die", row(3, 2, 2)],
    "curve": curve(1, (0.0, 0.0), (0.01, -5.0)),
    "motion": ["*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(2, 3, 2, 1, 1.0)],
    "contact": ["*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE", row(1, 2, 3, 3), row(0.11), "",
                "*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE", row(1, 3, 3, 3), row(0.12), ""],
    "more": [],
    "mesh": None,
    "end": ["*END"]}


def flat_mesh(constraint=lambda x, y: (), format_of=None):
    """Return the nodes and shells of a flat sheet of 8 x 4 elements between flat tools; `constraint` gives TC and RC,
    `format_of` nodes and labels as lines."""
    node = format_of or (lambda label, point, held: f"{label:8d}" + "".join(f"{value:16.6f}" for value in point)
                         + "".join(f"{value:8d}" for value in held))
    shell = (lambda labels: node(labels, (), ())) if format_of else (lambda labels: "".join(f"{v:8d}" for v in labels))
    nodes, shells, first = ["*NODE"], ["*ELEMENT_SHELL"], 1
    for part, (nx, ny, x0, y0, step, z) in enumerate(((8, 4, 0, 0, 5.0, 0.0), (4, 4, 10, -10, 5.0, 0.5),
                                                      (6, 6, -10, -20, 10.0, -0.5)), 1):
        grid = [[first + (nx + 1) * j + i for i in range(nx + 1)] for j in range(ny + 1)]
        for j, line in enumerate(grid):
            for i, label in enumerate(line):
                x, y = x0 + step * i, y0 + step * j
                nodes.append(node(label, (x, y, z), constraint(x, y) if part == 1 else ()))
        for j in range(ny):
            for i in range(nx):
                shells.append(shell((len(shells), part, grid[j][i], grid[j][i + 1], grid[j + 1][i + 1], grid[j + 1][i])))
        first += 1000
    return [*nodes, *shells]


def flat_deck(**cards):
    """Return a deck of a sheet of 40 x 20 x 1 mm between a flat punch and a flat die; `cards` replace those of FLAT."""
    lines = []
    for name, there in FLAT.items():
        found = cards.pop(name, there)
        lines += flat_mesh() if found is None else found
    assert not cards, cards
    return "\n".join(lines) + "\n"
