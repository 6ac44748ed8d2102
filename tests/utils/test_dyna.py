# SPDX-License-Identifier: GPL-3.0-or-later
"""What is read of LS-DYNA decks, each with its value known independently, and that nothing is left out without a word."""

import math
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from dyna_decks import curve, flat_deck, flat_mesh, row
from helpers import call

from dd3.dyna.command import Import
from dd3.dyna.planar import barlat89_at
from dd3.errors import Problem
from dd3.hanging import hanging_nodes


def imported(text, **options):
    """Return the import of a deck, the lines of its input file, and what was left out."""
    Path("deck.k").write_text(text)
    found = Import(Path("deck.k"), units=options.get("units"))
    body = "\n".join(found.body())
    return found, body, [str(item) for item in found.left_out]


def refused(text):
    """Return the message on a deck that is refused."""
    with pytest.raises(Problem) as error:
        imported(text)
    return str(error.value)


def phases(body):
    """Return the phases, each as its lines but control and trial."""
    return [[line.strip() for line in block.splitlines()[1:] if line.startswith("  ") and "control" not in line
             and "trial" not in line] for block in body.split("*OUTPUT")[0].split("*PHASE ")[1:]]


BASE = flat_deck()


# ---- cards ------------------------------------------------------------------------------------------------------------

def lines_in(width, labels):
    """Return the writer of nodes and shells in columns of a width."""
    def write(label, point, held):
        if not point:
            return "".join(f"{value:{width}d}" for value in label)
        return (f"{label:{width}d}" + "".join(f"{value:{max(16, width)}.6f}" for value in point)
                + "".join(f"{value:{width}d}" for value in held))
    return flat_mesh(format_of=write) if labels else None


def sheet(mark, width):
    """Return the mesh with a mark behind its keywords, in columns of a width."""
    return [f"{line}{mark}" if line.startswith("*") else line for line in lines_in(width, True)]


@pytest.mark.parametrize("cards", [
    {"material": ["*MAT_024", row(1, "7.85E-9", "2.1E5", 0.3, 200.0, 500.0).ljust(80) + "coil 17, checked, ok", "", "", ""]},
    {"material": ["*MAT_024", "1, 7.85E-9, 2.1D5, 0.3, 200.0, 5+2", "", "", ""]},
    {"contact": ["*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE_TITLE", row(7) + "punch on blank", row(1, 2, 3, 3), row(0.11),
                 "", "*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE_MPP_TITLE", row(8) + "die", row(0), row(1, 3, 3, 3),
                 row(0.12), ""]},
    {"tools": ["*PART_INERTIA", "punch", row(2, 2, 2), row(0, 0, 0, 1.0, 0, 0), row(1, 0, 0, 1, 0, 1), row(0, 0, 0),
               "*PART", "die", row(3, 2, 2)]},
    {"tools": ["*PART_INERTIA", "punch", row(2, 2, 2), row(0, 0, 0, 1.0, 1, 0), row(1, 0, 0, 1, 0, 1), row(0, 0, 0),
               row(1, 0, 0, 0, 1, 0), "*PART", "die", row(3, 2, 2)]},
    {"mesh": sheet(" %", 10)}, {"mesh": sheet("%", 10)}, {"mesh": sheet("+", 20)}, {"mesh": sheet(" +", 20)},
    {"head": ["*KEYWORD I10=Y"], "mesh": lines_in(10, True)},
    {"contact": ["*SET_PART_LIST", row(5), row(2, 3), "*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE", row(1, 2, 3, 3),
                 row(0.11), "", "*SET_PART_ADD", row(6), row(7), "*SET_PART_LIST_GENERATE", row(7), row(3, 3),
                 "*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE", row(1, 6, 3, 2), row(0.12), ""]},
    {"contact": ["*SET_NODE_LIST_GENERATE", row(5), row(1, 45), "*CONTACT_FORMING_NODES_TO_SURFACE", row(5, 2, 4, 3),
                 row(0.11), "", "*CONTACT_FORMING_NODES_TO_SURFACE", row(5, 3, 4, 3), row(0.12), ""]},
    {"parameter": ["*PARAMETER", row("R stroke", -5.0, "I tool", 2), "*PARAMETER_EXPRESSION", "R half    &stroke/2",
                   "R both    max(&half", "          *2, -10.0)"], "curve": curve(1, (0.0, 0.0)) + [f"{0.01:>20}{'&both':>20}"],
     "motion": ["*BOUNDARY_PRESCRIBED_MOTION_RIGID", row("&tool", 3, 2, 1, 1.0)]},
    {"curve": ["*DEFINE_CURVE_SMOOTH", row(1, 0, -5.0, 0.0, 0.01, 0.002)],
     "motion": ["*BOUNDARY_PRESCRIBED_MOTION_RIGID_ID", row(1) + "down", row(2, 3, 0, 1, 1.0)]},
    {"curve": ["*DEFINE_CURVE_SMOOTH", row(1, 0, 5.0, 0.0, 0, 0.002, 625.0)],
     "motion": ["*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(2, 3, 0, 1, -1.0)]},
    {"motion": ["*DEFINE_VECTOR", row(4, 0, 0, 1, 0, 0, 0), "*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(2, 4, 2, 1, -1.0, 4)]},
])
def test_as_the_base(cards):
    """Check that decks in other words say the same as the plain one."""
    found, body, _ = imported(flat_deck(**cards))
    base, expected, _ = imported(BASE)
    assert body == expected
    assert found.blank.mesh.nodes == base.blank.mesh.nodes and found.blank.mesh.elements == base.blank.mesh.elements


def test_includes():
    """Check files that are included: a name that goes on, folders of *INCLUDE_PATH, several in one keyword."""
    Path("a b/c d").mkdir(parents=True)
    mesh = flat_mesh()
    at = mesh.index("*ELEMENT_SHELL")
    Path("a b/c d/nodes of.k").write_text("\n".join(mesh[:at]) + "\n")
    Path("a b/cells.k").write_text("\n".join(mesh[at:]) + "\n*END\nbehind\n")
    _, expected, _ = imported(BASE)
    for lines in (["*INCLUDE", "a b/ +", "$ a comment", "c d/nodes of.k", "a b/cells.k"],
                  ["*INCLUDE_PATH", "a b", "*INCLUDE_PATH", "a b/ +", "c d", "*INCLUDE", "nodes of.k", "*INCLUDE",
                   "cells.k"]):
        _, body, left = imported(flat_deck(mesh=lines))
        assert body == expected and any("cells.k" in item and "lines behind *END" in item for item in left)
    said = refused(flat_deck(mesh=["*INCLUDE", "none.k"]))
    assert "no such included file: 'none.k'" in said and said.startswith("deck.k:")
    Path("self.k").write_text("*INCLUDE\nself.k\n")
    assert "nest too deeply" in refused(flat_deck(mesh=["*INCLUDE", "self.k"]))


def test_parameters():
    """Check which of two definitions holds, and expressions."""
    point = [f"{0.01:>20}{'&stroke':>20}"]
    for lines, stroke in (
            (["*PARAMETER", row("R stroke", -6.0), "*PARAMETER", row("R stroke", -8.0)], "-6"),
            (["*PARAMETER", row("R stroke", -6.0, "R stroke", -8.0)], "-6"),
            (["*PARAMETER_DUPLICATION", row(2), "*PARAMETER", row("R stroke", -6.0), "*PARAMETER", row("R stroke", -8.0)],
             "-8"),
            (["*PARAMETER_MUTABLE", row("R stroke", -6.0), "*PARAMETER", row("R stroke", -8.0)], "-8"),
            (["*PARAMETER", "R stroke, -6.0"], "-6"),
            (["*PARAMETER", row("I whole", 7), "*PARAMETER_EXPRESSION", "Rstroke   -2*&whole/4 - 1.0"], "-4"),
            (["*PARAMETER_EXPRESSION", "R stroke  -sqrt(9.0)*2**2/3"], "-4")):
        found, body, _ = imported(flat_deck(parameter=lines, curve=curve(1, (0.0, 0.0)) + point))
        assert f"move = punch 0 0 {stroke}\n" in body, (lines, body)
        assert ("a second *PARAMETER STROKE; the first holds" in "".join(found.notes)) == (stroke == "-6" and len(
            "".join(lines).split("stroke")) > 2)
    for lines, said in ((["*PARAMETER_EXPRESSION", "R stroke  __import__('os')"], "the expression"),
                        (["*PARAMETER_EXPRESSION", "R stroke  9**9**9**9"], "the expression"),
                        (["*PARAMETER_EXPRESSION", "R stroke  1/0"], "the expression"),
                        (["*PARAMETER_EXPRESSION", "R stroke  &other*2"], "no *PARAMETER 'other' is given before"),
                        (["*PARAMETER", row("R stroke", "five")], "expected a number, got 'five'"),
                        ([], "no *PARAMETER 'stroke' is given before")):
        assert said in refused(flat_deck(parameter=lines, curve=curve(1, (0.0, 0.0)) + point))


def test_twice():
    """Check that a number that is given twice is an error with both places."""
    material = ["*MAT_024", row(1, "7.85E-9", "2.1E5", 0.3, 400.0, 500.0), "", "", ""]
    for more, said in ((material, "a second *MAT 1; the first is at deck.k:6"),
                       (["*SECTION_SHELL", row(1, 16), row(2.0)], "a second *SECTION 1"),
                       (curve(1, (0.0, 0.0), (1.0, 1.0)), "a second *DEFINE_CURVE 1"),
                       (["*SET_NODE_LIST", row(4), row(1), "*SET_NODE_LIST", row(4), row(2)], "a second *SET_NODE 4"),
                       (["*PART", "again", row(2, 2, 2)], "a second *PART 2"),
                       (["*NODE", f"{1:8d}{1.0:16.6f}{0.0:16.6f}{0.0:16.6f}"], "a second node 1, at another place"),
                       (["*ELEMENT_SHELL", "".join(f"{v:8d}" for v in (1, 1, 1, 2, 11, 10))], "a second shell 1")):
        assert said in refused(flat_deck(more=more)), (said, refused(flat_deck(more=more)))
    imported(flat_deck(more=["*NODE", f"{1:8d}{0.0:16.6f}{0.0:16.6f}{0.0:16.6f}"]))  # at the same place


def test_sets():
    """Check node sets by lists, ranges, sets of sets, columns and options: a support of the edge x = 0."""
    edge = [1, 10, 19, 28, 37]
    spc = ["*BOUNDARY_SPC_SET", row(5, 0, 1, 1, 0, 0, 1, 0)]
    for lines in (["*SET_NODE_LIST", row(5), row(*edge)], ["*SET_NODE", row(5), ",".join(map(str, edge))],
                  ["*SET_NODE_LIST_GENERATE_INCREMENT", row(5), row(1, 37, 9)],
                  ["*SET_NODE_LIST_GENERATE_TITLE", "edge", row(5), row(1, 1, 10, 10, 19, 19, 28, 28), row(37, 37)],
                  ["*SET_NODE_COLUMN", row(5), *(row(label, 0.0) for label in edge)],
                  ["*SET_NODE_ADD", row(5), row(8, 9), "*SET_NODE_LIST", row(8), row(1, 10), "*SET_NODE_LIST", row(9),
                   row(19, 28, 37)],
                  ["*SET_NODE_GENERAL", row(5), row("NODE", *edge, 2), row("DNODE", 2)]):
        found, body, left = imported(flat_deck(more=lines + spc))
        assert found.fixed == {"xy": set(edge)} and "fix = x y" in body, lines
        assert not any("*SET" in item for item in left)
    said = refused(flat_deck(more=["*SET_NODE_TREE", row(5), row(1), *spc]))
    assert "there is no *SET_NODE 5; *SET_NODE_TREE at deck.k:" in said


# ---- process ----------------------------------------------------------------------------------------------------------

FORCE = ["*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(2, 3, 2, 1, 1.0), "*LOAD_RIGID_BODY", row(3, 3, 2, -1.0)]


@pytest.mark.parametrize("points, expected", [
    ([(0, 0), (0.006, -5), (0.01, -2)], [["move = punch 0 0 -5"], ["move = punch 0 0 3"]]),
    ([(0, 0), (0.002, -2), (0.003, -1), (0.004, -4), (0.006, -3), (0.01, -5)],
     [["move = punch 0 0 -2"], ["move = punch 0 0 1"], ["move = punch 0 0 -3"], ["move = punch 0 0 1"],
      ["move = punch 0 0 -2"]]),
    ([(0, 0), (0.004, -5), (0.006, -5), (0.01, 0)], [["move = punch 0 0 -5"], ["move = punch 0 0 5"]]),
    ([(0, 0), (0.002, -0.5), (0.01, -5)], [["move = punch 0 0 -5"]])])
def test_turning_points(points, expected):
    """Check that the turning points of a motion are the ends of phases, and its velocity says nothing."""
    assert phases(imported(flat_deck(curve=curve(1, *points)))[1]) == expected


@pytest.mark.parametrize("points, expected", [
    ([(0, 0), (0.01, -3000)], [["move = punch 0 0 -5", "press = die 0 0 3000"]]),
    ([(0, -3000), (0.01, -3000)], [["press = die 0 0 3000"], ["move = punch 0 0 -5"]]),
    ([(0, -1000), (0.005, -1000), (0.01, -3000)],
     [["press = die 0 0 1000"], ["move = punch 0 0 -5", "press = die 0 0 3000", "press_table = 0.5 0.333333  1 1"]]),
    ([(0, -1000), (0.005, -3000), (0.01, 0)],
     [["press = die 0 0 1000"], ["move = punch 0 0 -5", "press = die 0 0 3000", "press_table = 0.5 1  1 0"]])])
def test_forces(points, expected):
    """Check a force over the stroke of the punch, 5 mm from 0 to 0.01 s."""
    assert phases(imported(flat_deck(curve=curve(1, (0, 0), (0.01, -5)) + curve(2, *points), motion=FORCE))[1]) == expected


def test_force_over_travel():
    """Check that a force in time becomes one over the travel of a punch that slows down: s = 1 - (1 - t/T)^2."""
    lines = curve(1, (0, -1000.0), (0.01, 0.0)) + curve(2, (0, -1000), (0.005, -1000), (0.01, -3000))
    motion = ["*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(2, 3, 0, 1, 1.0), *FORCE[2:]]
    found, body, _ = imported(flat_deck(curve=lines, motion=motion))
    assert "move = punch 0 0 -5\n" in body
    table = np.array(re.search("press_table = (.*)", body)[1].split(), float).reshape(-1, 2)
    time = 1 - np.sqrt(1 - table[:, 0])
    assert np.allclose(3000 * table[:, 1], np.where(time < 0.5, 1000, 1000 + 4000 * (time - 0.5)), atol=15)


def test_random_motions():
    """Check that positions and force stay on the path of the deck, within 1 % of their ranges, and end where it ends."""
    chance = np.random.default_rng(5)
    for _ in range(10):
        times = np.array([0, *np.sort(chance.uniform(0.001, 0.009, 3)), 0.01])
        down, along = np.append(0, chance.uniform(-6, 2, 4)), np.append(0, chance.uniform(-1, 4, 4))
        force = chance.uniform(0, 3000, 5)
        lines = [line for k, values in enumerate((down, along, -force), 1) for line in curve(k, *zip(times, values))]
        motion = ["*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(2, 3, 2, 1, 1.0), row(2, 1, 2, 2, 1.0), "*LOAD_RIGID_BODY",
                  row(3, 3, 3, -1.0)]
        fine = np.concatenate([np.linspace(a, b, 400) for a, b in zip(times, times[1:])])
        path = np.column_stack([np.interp(fine, times, values) for values in (along / 5, down / 8, force / 3000)])
        place, acting = np.zeros(2), 0.0
        for phase in phases(imported(flat_deck(curve=lines, motion=motion))[1]):
            found = {line.split()[0]: np.array(line.split("= ")[1].split()[line.startswith(("move =", "press =")):], float)
                     for line in phase}
            way = found.get("move", np.zeros(3))[[0, 2]]
            table = found.get("press_table", np.ones(2)).reshape(-1, 2)
            end = found["press"][2] * table[:, 1] if "press" in found else np.array([acting])
            for part in np.linspace(0, 1, 11) if way.any() else ():
                now = np.append((place + part * way) / (5, 8), np.interp(part, [0, *table[:, 0]], [acting, *end]) / 3000)
                assert np.linalg.norm(path - now, axis=1).min() < 0.01
            place, acting = place + way, end[-1]
        assert np.allclose(place, (along[-1], down[-1]), atol=1e-3) and abs(acting - force[-1]) < 15


def test_two_tools():
    """Check two tools that move in other proportions, and gravity at the start."""
    lines = curve(1, (0, 0), (0.01, -4)) + curve(2, (0, 0), (0.005, 0), (0.01, 2)) + curve(3, (0, 9810.0), (1, 9810.0))
    motion = ["*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(2, 3, 2, 1, 1.0), row(3, 3, 2, 2, 1.0), "*LOAD_BODY_Z",
              row(3, 1.0)]
    _, body, _ = imported(flat_deck(curve=lines, motion=motion))
    assert phases(body) == [["gravity = 0 0 -9810"], ["move = punch 0 0 -2"],
                            ["move = punch 0 0 -2", "move = die 0 0 2"]]
    assert "density = 7.85e-09\n" in body


def test_gravity(program):
    """Check the direction and the units of gravity, and that it takes a density; the file is read."""
    lines = curve(1, (0, 0), (0.01, -5)) + curve(3, (0, 9.81e-3), (1, 9.81e-3))
    motion = ["*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(2, 3, 2, 1, 1.0), "*LOAD_BODY_VECTOR", row(3, 1.0), row(0, 0, 1)]
    material = ["*MAT_024", row(1, "7.85E-6", 210.0, 0.3, 0.2, 0.5), "", "", ""]
    found, body, _ = imported(flat_deck(curve=lines, motion=motion, material=material))
    assert "gravity = 0 0 -9810\n" in body and "density = 7.85e-09\n" in body and not any(
        "density" in note or "gravity" in note for note in found.notes)
    found, _, _ = imported(flat_deck(curve=lines, motion=motion))
    assert any("gravity of 0.00981 mm/s2" in note for note in found.notes)
    heavy = ["*MAT_024", row(1, "7.85E-6", "2.1E5", 0.3, 200.0, 500.0), "", "", ""]
    assert any("RO is 7.85e-06 t/mm3" in note for note in imported(flat_deck(material=heavy))[0].notes)
    without = ["*MAT_024", row(1, "", "2.1E5", 0.3, 200.0, 500.0), "", "", ""]
    assert "no density RO" in refused(flat_deck(curve=lines, motion=motion, material=without))
    parts = ["*SET_PART_LIST", row(9), row(2), "*LOAD_BODY_PARTS", row(9)]
    found, body, _ = imported(flat_deck(curve=lines, motion=motion + parts, material=material))
    assert "gravity" not in body and any("gravity of other parts" in note for note in found.notes)
    Path("deck.k").write_text(flat_deck(curve=lines, motion=motion, material=material))
    call("import", "deck.k")
    done = subprocess.run([program, "--check", "deck/deck.dat"], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_force_acts(program):
    """Check by a run that the force on the die is 600 N for each mm of the punch."""
    Path("deck.k").write_text(flat_deck(curve=curve(1, (0, 0), (0.01, -5)) + curve(2, (0, 0), (0.01, -3000)), motion=FORCE))
    call("import", "deck.k")
    done = subprocess.run([program, "--quiet", "--threads", "1", "deck/deck.dat"], capture_output=True, text=True,
                          timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    lines = [line.split(",") for line in Path("deck/deck.out/history.csv").read_text().splitlines() if line[0] != "#"]
    travel, force = (np.array([float(line[lines[0].index(name)]) for line in lines[1:]]) for name in ("punch_uz", "die_fz"))
    assert np.allclose(force, 600 * travel, atol=3), (travel, force)


def test_supports():
    """Check the supports by TC of *NODE on planes of symmetry, and rotations that are held alone."""
    def held(x, y):
        code = {(True, True): 4, (True, False): 1, (False, True): 2}.get((x == 0, y == 0), 0)
        return code, {4: 7, 1: 6, 2: 5}.get(code, 0) if code else 0  # x: y and z; y: z and x in RC

    found, body, _ = imported(flat_deck(mesh=flat_mesh(held)))
    assert found.fixed == {"xy": {1}, "x": {10, 19, 28, 37}, "y": set(range(2, 10))}
    assert "middle" not in body
    found, body, _ = imported(flat_deck(mesh=flat_mesh(lambda x, y: (3, 7) if x == 0 else (0, 0))))
    assert found.fixed == {"z": {1, 10, 19, 28, 37}}
    assert any("rotation about y of 5 nodes is held" in note for note in found.notes)
    for code, axes in enumerate(("x", "y", "z", "xy", "yz", "xz", "xyz"), 1):
        found, _, _ = imported(flat_deck(mesh=flat_mesh(lambda x, y, code=code: (code, 0) if x == 0 else (0, 0))))
        assert list(found.fixed) == [axes]
    assert "TC = 9 of node 1; expected 0 to 7" in refused(flat_deck(mesh=flat_mesh(lambda x, y: (9, 0))))


def test_positions():
    """Check parts that are moved before the start: by *PART_MOVE, and to a distance from another."""
    move = ["*PART_MOVE", f"{2:8d}{0:16d}{1.5:16.6f}{2.0:16.6f}"]
    found, _, _ = imported(flat_deck(more=move))
    points = np.array([found.deck.nodes[label] for label in range(1001, 1026)])
    assert np.allclose(points.min(axis=0), (10, -8.5, 2.5))
    auto = ["*CONTROL_FORMING_AUTOPOSITION_PARAMETER", row(2, "", 3, 1, 1, "", 1.25, "up"), row(3, "", 3, 1, -1, "", 0.75)]
    for lines, punch in ((auto[:1] + [row(2, "", 3, 1, 1, "", 1.25)] + auto[2:], 1.25),
                         ([*auto, "*PART_MOVE", f"{2:8d}{0:16d}{0:16d}{'&up':>16}"], 1.25)):
        found, _, _ = imported(flat_deck(parameter=["*PARAMETER", row("R up", 0.0)], more=lines))
        assert abs(found.deck.nodes[1001][2] - punch) < 1e-12 and abs(found.deck.nodes[2001][2] + 0.75) < 1e-12
        assert sum("AUTOPOSITION" in note for note in found.notes) == 2
    call("import", "deck.k")
    assert " 1.25\n" in Path("deck/punch.bez").read_text()  # the tool is written in its place


def test_beads():
    """Check the normal force of a bead, on the tool that carries it: that of its nodes, below the sheet."""
    lines = ["*CONTACT_DRAWBEAD", row(9, 1, 4, 3), row(""), row(""), row(11, 12, 5.0, 2.0), "*SET_NODE_LIST", row(9),
             row(2018, 2019, 2020), *curve(11, (0, 0), (1, 20.0)), *curve(12, (0, 0), (1, 8.0))]
    _, body, left = imported(flat_deck(more=lines))
    assert "force = 40\n  points = 20 0  30 0  40 0\n  normal = 8\n  tool = die\n" in body
    assert any("DBDTH = 5.0" in item for item in left)


# ---- materials ----------------------------------------------------------------------------------------------------------

SWIFT = (1, "7.85E-9", "2.1E5", 0.3, 2.0, 550.0, 0.22)


def barlat(second, *axes):
    """Return a *MAT_036 by Swift's law."""
    return ["*MAT_3-PARAMETER_BARLAT", row(*SWIFT), row(*second), *axes]


def test_rolling_direction():
    """Check AOPT = 0, 2 and 3 with BETA, about the normals of shells that are numbered either way round."""
    r = (6.0, 1.79, 1.51, 2.27)
    over = [line[:16] + "".join(line[k:k + 8] for k in (16, 40, 32, 24)) if len(line) == 48 else line for line in flat_mesh()]
    for axes, mesh, angle in (
            ([row(0.0), row(""), row("", "", "", "", "", "", 30.0)], None, 30),
            ([row(0.0), row(""), row("", "", "", "", "", "", -20.0)], None, -20),
            ([row(0.0), row(""), row("", "", "", "", "", "", 30.0)], over, 60),  # from the edge along y, clockwise
            ([row(2.0), row("", "", "", 1.0, 1.0, 0.0), row("")], None, 45),
            ([row(3.0), row(""), row(0.0, 1.0, 0.0, "", "", "", 25.0)], None, 25),
            ([row(0.0)], None, 0), ([], None, 0)):
        found, _, _ = imported(flat_deck(material=barlat(r, *axes), mesh=mesh))
        x, y, z = found.law.rolling
        assert abs(z) < 1e-9 and abs(math.remainder(math.degrees(math.atan2(y, x)) - angle, 180)) < 1e-3, (axes, x, y)


def test_barlat_coefficients():
    """Check PB > 0, which makes the r-values a, c and h: those of a criterion with known r-values come back."""
    r0, r45, r90 = 1.79, 1.51, 2.27
    a = 2 - 2 * math.sqrt(r0 / (1 + r0) * r90 / (1 + r90))
    h = math.sqrt(r0 / (1 + r0) * (1 + r90) / r90)
    low, high = 0.1, 3.0
    for _ in range(60):
        p = (low + high) / 2
        low, high = (p, high) if barlat89_at((a, 2 - a, h, p), 6.0, math.pi / 4)[1] < r45 else (low, p)
    # Closed forms of Barlat and Lian (1989) for r0 and r90.
    assert np.allclose([barlat89_at((a, 2 - a, h, p), 6.0, angle)[1] for angle in (0, math.pi / 2)], (r0, r90), rtol=1e-5)
    found, body, _ = imported(flat_deck(material=barlat((6.0, f"{a:.7f}", f"{2 - a:.7f}", f"{h:.7f}"), row(
        0.0, "", "", "", "", f"{p:.7f}"), row(""), row(""))))
    r = [float(value) for value in re.search(r"hill48 r0=(\S+) r45=(\S+) r90=(\S+)", body).groups()]
    assert np.allclose(r, (r0, r45, r90), rtol=1e-4)


def test_back_stresses(program):
    """Check M < 0: the sum of the isotropic part and the back-stresses is Swift's law in tension, by a run of a point."""
    chaboche = row(20.0, 60.0, 5.0, 30.0)
    found, body, _ = imported(flat_deck(material=barlat((-6.0, 1.0, 1.0, 1.0, 0, 0.005), chaboche, row(0.0), row(""),
                                                        row("", "", "", "", "", "", 30.0))))
    assert "backstress = lemaitre_chaboche CX=20 Xsat=60\n" in body and abs(math.degrees(math.atan2(
        found.law.rolling[1], found.law.rolling[0])) - 30) < 1e-6
    block = body[body.index("*MATERIAL"):body.index("# Part 1")]
    Path("point.dat").write_text(block + """*POINT pulled
  material = blank
  control = e11 s22 s33 s12 s23 s13
  target = 0.1 0 0 0 0 0 steps=50
""")
    done = subprocess.run([program, "--quiet", "point.dat"], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    lines = [line.split(",") for line in Path("point.out/history.csv").read_text().splitlines() if line[0] != "#"]
    stress = float(lines[-1][lines[0].index("s11")] if "s11" in lines[0] else lines[-1][lines[0].index("stress_11")])
    plastic = 0.1 - stress / 2.1e5
    assert abs(stress / (550 * (0.005 + plastic)**0.22) - 1) < 0.005, (lines[0], stress)


def test_kinematic():
    """Check *MAT_003: its part BETA of the slope is isotropic, the rest that of Prager."""
    slope = 2.1e5 * 1000 / (2.1e5 - 1000)
    for beta, isotropic, back in ((1.0, slope, None), (0.0, 0.0, slope), (0.25, slope / 4, 0.75 * slope)):
        material = ["*MAT_PLASTIC_KINEMATIC", row(1, "7.85E-9", "2.1E5", 0.3, 200.0, 1000.0, beta), ""]
        body = imported(flat_deck(material=material))[1]
        assert f"hardening = linear Y0=200 H={isotropic:.8g}\n" in body
        assert ("backstress" in body) == bool(back) and (not back or f"backstress = prager k={back:.8g}\n" in body)


def test_per_cent():
    """Check that r-values in per cent, and curves of r-values, are refused."""
    assert "R00 = 179; expected an r-value up to 10, not in per cent" in refused(
        flat_deck(material=barlat((6.0, 179.0, 151.0, 227.0))))
    assert "is a curve of r-values" in refused(flat_deck(material=barlat((6.0, -12, 1.5, 2.0))))


def test_tables():
    """Check *DEFINE_TABLE_2D and *DEFINE_TABLE: the curve of the lowest rate, the others named."""
    slow, fast = curve(51, (0.0, 210.0), (1.0, 300.0)), curve(52, (0.0, 250.0), (1.0, 400.0))
    material = ["*MAT_024", row(1, "7.85E-9", "2.1E5", 0.3), row("", "", 50), "", ""]
    for table in (["*DEFINE_TABLE_2D", row(50), f"{100.0:>20}{52:>20}", f"{0.1:>20}{51:>20}", *fast, *slow],
                  ["*DEFINE_TABLE_2D", row(50), f"{0.1:>20}{51:>20}", f"{100.0:>20}{52:>20}", *slow, *fast],
                  ["*DEFINE_TABLE", row(50), f"{0.1:>20}", f"{100.0:>20}", *slow, *fast]):
        _, body, left = imported(flat_deck(material=material, more=table))
        assert "hardening = table 0:210 1:300\n" in body
        assert any("*DEFINE_TABLE" in item and "lowest strain rate" in item for item in left)
        assert any("*DEFINE_CURVE" in item for item in left)


# ---- account ------------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("cards, expected", [
    ({"contact": ["*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE", row(1, 2, 3, 3), row(0.2, 0.08, 0.001, "", 20.0, 1, 0.003,
                                                                                   0.004),
                  row(1.5, 1.0, 0.9), row(2), row("", 1), "*CONTACT_FORMING_ONE_WAY_SURFACE_TO_SURFACE", row(1, 3, 3, 3)]},
     ["FD = 0.08", "DC = 0.001", "VDC = 20.0", "PENCHK = 1", "BT = 0.003", "DT = 0.004", "SFSA = 1.5", "SAST = 0.9",
      "SOFT = 2", "THKOPT = 1"]),
    ({"material": ["*MAT_024", row(1, "7.85E-9", "2.1E5", 0.3, 200.0, 500.0, 0.4), row(40.0, 5.0, "", "", 1.0), "", ""]},
     ["FAIL = 0.4", "C = 40.0", "P = 5.0", "VP = 1.0"]),
    ({"material": barlat((6.0, 1.79, 1.51, 2.27, 7), row(0.0, 40.0, 5.0, 3, "", "", 8, 9), row("", "", "", "", "", "", 4),
                         row("", "", "", "", "", 2.0), row(1, 2))},
     ["LCID = 7", "C = 40.0", "P = 5.0", "VLCID = 3", "NLP = 8", "HTB = 9", "HTC = 4", "D3 = 2.0", "row 6 field 1 = 1",
      "row 6 field 2 = 2"]),
    ({"more": ["*LOAD_SEGMENT", row(1), "*MADE_UP", row(1), "*CONTACT_TIED_EDGES", row(1), "*INITIAL_STRESS_SHELL", row(1),
               "*CONTROL_FORMING_TRIM", row(1), "*DEFINE_BOX", row(1), "*SET_SHELL_LIST", row(4), row(1, 2),
               *curve(77, (0, 0), (1, 1)), "*ELEMENT_BEAM", "1"]},
     ["*LOAD_SEGMENT", "*MADE_UP: not read", "*CONTACT_TIED_EDGES", "*INITIAL_STRESS_SHELL", "*CONTROL_FORMING_TRIM",
      "*DEFINE_BOX", "*SET_SHELL_LIST", "*DEFINE_CURVE", "*ELEMENT_BEAM"]),
    ({"control": ["*CONTROL_TERMINATION", row(0.01, 500)]}, ["ENDCYC = 500"]),
    ({"blank": ["*PART", "blank", row(1, 1, 1, 0, 3, 0, 1)]}, ["HGID = 3", "ADPOPT = 1"]),
    ({"head": ["$ a comment", "stray", "*KEYWORD"]}, ["text before the first keyword"]),
    ({"end": ["*END", "$ more", "*NODE"]}, ["lines behind *END"]),
    ({"motion": ["*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(2, 3, 2, 1, 1.0), row(3, 9, 2, 1)]}, ["motion of kind DOF = 9"]),
    ({"motion": ["*BOUNDARY_PRESCRIBED_MOTION_RIGID_ID", row(1) + "down", row(2, 3, 2, 1, 1.0), row(7) + "fold",
                 row(3, 10, 2, 1), row(1.0, 2.0), row(8) + "also down", row(2, 3, 2, 1, 1.0)]},
     ["motion of kind DOF = 10"]),
    ({"mesh": [line + (row(3).rjust(24) if k == 3 else "") for k, line in enumerate(flat_mesh())]}, ["*NODE, field"]),
])
def test_named(cards, expected):
    """Check that each thing that is not used is named with its place."""
    _, _, left = imported(flat_deck(**cards))
    for name in expected:
        assert any(name in item and re.match(r"deck\.k:\d+: ", item) for item in left), (name, left)
    base = imported(BASE)[2]
    assert len(left) == len(base) + len(expected), "\n".join(left)


def test_nothing_else_left_out():
    """Check the list of the plain deck: only the element of its shells."""
    assert [item.split(": ")[1] for item in imported(BASE)[2]] == ["*SECTION_SHELL, ELFORM = 16", "*SECTION_SHELL, SHRF = 0.833"]


# ---- mesh ---------------------------------------------------------------------------------------------------------------

def test_hanging_nodes():
    """Check that a node of one shell on the edge of another is refused with the node, and bound by *CONSTRAINED_ADAPTIVITY."""
    mesh = flat_mesh()
    at = mesh.index("*ELEMENT_SHELL")
    # The first shell, 1 2 11 10, is divided in two across its edges 2 11 and 1 10.
    new = ["".join(f"{v:8d}" for v in labels) for labels in ((1, 1, 1, 2, 902, 901), (700, 1, 901, 902, 11, 10))]
    nodes = [f"{901:8d}{0.0:16.6f}{2.5:16.6f}{0.0:16.6f}", f"{902:8d}{5.0:16.6f}{2.5:16.6f}{0.0:16.6f}"]
    mesh = mesh[:at] + nodes + [mesh[at], *new] + mesh[at + 2:]
    said = refused(flat_deck(mesh=mesh))
    assert "node 902 lies on an edge or a face of element 2" in said and "deck.k:" in said
    said = refused(flat_deck(mesh=mesh, more=["*CONSTRAINED_ADAPTIVITY", row(902, 2, 12)]))
    assert "node 902 hangs between the nodes 2 and 12, which are not the ends of an edge of a shell" in said
    blank = imported(flat_deck(mesh=mesh, more=["*CONSTRAINED_ADAPTIVITY", row(902, 2, 11)]))[0].blank
    assert blank.mesh.bound == [(902, 2, 11), tuple(blank.upper[label] for label in (902, 2, 11))]


def test_hanging_nodes_of_hexahedra():
    """Check nodes of smaller hexahedra on the edges and the face of a larger one, and a conforming mesh."""
    def brick(x, y, z, size, label):
        corners = [(x + size[0] * a, y + size[1] * b, z + size[2] * c)
                   for a, b, c in ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))]
        return [label.setdefault(corner, len(label)) for corner in corners]

    label = {}
    cells = [brick(0.0, 0.0, 0.0, (2.0, 2.0, 2.0), label)]
    cells += [brick(2.0, y, z, (1.0, 1.0, 1.0), label) for y in (0.0, 1.0) for z in (0.0, 1.0)]
    found = hanging_nodes(np.array(list(label), float), cells)
    assert {tuple(list(label)[node]) for node, _ in found} == {(2, 1, 0), (2, 0, 1), (2, 1, 1), (2, 2, 1), (2, 1, 2)}
    assert {cell for _, cell in found} == {0}
    label = {}
    cells = [brick(float(x), float(y), 0.0, (1.0, 1.0, 1.0), label) for x in range(3) for y in range(3)]
    assert hanging_nodes(np.array(list(label), float), cells) == []


def test_messages():
    """Check that a message on what is missing names the keywords that are not read."""
    for cards, said in (
            ({"curve": ["*DEFINE_CURVE_FUNCTION", row(1), "time*2"]},
             "there is no *DEFINE_CURVE 1; *DEFINE_CURVE_FUNCTION at deck.k:"),
            ({"tools": ["*PART_STACKED_ELEMENTS", "x", row(2, 2, 2)]},
             "but no *PART of this number; *PART_STACKED_ELEMENTS at deck.k:"),
            ({"section": ["*SECTION_SHELL_EFG", row(1, 16), row(1.0)]}, "has no *SECTION_SHELL 1; *SECTION_SHELL_EFG at"),
            ({"contact": ["*SET_PART_TREE", row(9), "*CONTACT_SURFACE_TO_SURFACE", row(1, 9, 3, 2), row(0.1)]},
             "there is no *SET_PART 9; *SET_PART_TREE at deck.k:"),
            ({"motion": ["*BOUNDARY_PRESCRIBED_MOTION_RIGID_LOCAL", row(2, 3, 2, 1)]},
             "; *BOUNDARY_PRESCRIBED_MOTION_RIGID_LOCAL at deck.k:")):
        message = refused(flat_deck(**cards))
        assert said in message, message
