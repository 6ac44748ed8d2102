# SPDX-License-Identifier: GPL-3.0-or-later
"""Models of Abaqus and CalculiX: places of nodes, generated nodes and elements, sets, instances; what is not read is
named with its line; broken files end with a message."""

import math
from pathlib import Path

import numpy as np
import pytest
from helpers import call
from mutations import mutants

from dd3.errors import Problem
from dd3.mesh import check_joints, read_inp, renumber, write_inp
from dd3.tools import facet_files

# Two elements of 2 x 3 x 1 side by side along x.
TWO = """*NODE
1, 0, 0, 0
2, 2, 0, 0
3, 4, 0, 0
4, 0, 3, 0
5, 2, 3, 0
6, 4, 3, 0
11, 0, 0, 1
12, 2, 0, 1
13, 4, 0, 1
14, 0, 3, 1
15, 2, 3, 1
16, 4, 3, 1
*ELEMENT, TYPE=C3D8R, ELSET=sheet
1, 1, 2, 5, 4, 11, 12, 15, 14
2, 2, 3, 6, 5, 12, 13, 16, 15
"""
CORNERS = "*NODE\n1, 0, 0, 0\n3, 4, 0, 0\n21, 0, 6, 0\n23, 4, 6, 0\n"
# The same elements and two more beside them, all from a few nodes.
GENERATED = """*NODE
1, 0., 0., 0.
3, 0.4D1, 0., 0.
*NSET, NSET=first
1, 3
*NGEN, NSET=line
1, 3
*NCOPY, CHANGE NUMBER=20, OLD SET=line, SHIFT, NEW SET=far
0., 6.

*NFILL, NSET=lower
line, far, 2, 10
*NCOPY, CHANGE NUMBER=100, OLD SET=lower, NEW SET=upper, SHIFT
0, 0, 1
*ELEMENT, TYPE=C3D8
1, 1, 2, 12, 11, 101, 102, 112, 111
*ELGEN, ELSET=sheet
1, 2, 1, 1, 2, 10, 2
"""
UNKNOWN = """stray
*HEADING
title
*NODE, NSET=corners
1, 0, 0, 0, 1, 0, 0
2, 2, 0, 0
3, 2, 2, 0
4, 0, 2, 0
5, 0, 0, 1
6, 2, 0, 1
7, 2, 2, 1
8, 0, 2, 1
9, 9, 9, 9
*ELEMENT, TYPE=C3D8
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=S4R, ELSET=skin
7, 1, 2, 3, 4
*NSET, NSET=some, COLOUR=red
1, 77, nowhere
*ELSET, ELSET=both, GENERATE
1, 7, 6, 5
*NSET, NSET=skin, ELSET=skin
*TRANSFORM, NSET=some
1, 0, 0, 0, 1, 0
*FROBNICATE
*SURFACE, NAME=s
sheet, S1
"""


def mesh_of(text, part=None):
    """Return the mesh of a model."""
    Path("model.inp").write_text(text)
    return read_inp(Path("model.inp"), part)


def places(mesh):
    """Return the coordinates by label, in a form that compares."""
    return {label: tuple(round(value, 9) + 0.0 for value in point) for label, point in mesh.nodes.items()}


@pytest.mark.parametrize("head, place", (
    ("*SYSTEM\n100, 0, 0, 100, 1, 0\n99, 0, 0\n", lambda x, y, z: (100 - y, x, z)),
    ("*SYSTEM\n5, 6, 7\n", lambda x, y, z: (5 + x, 6 + y, 7 + z)),
    # Without the third point the z-axis stays, and the x-axis is projected on the plane x-y.
    ("*System\n5., 6., 7., 5., 8., 9.\n", lambda x, y, z: (5 - y, 6 + x, 7 + z)),
    ("*SYSTEM\n0, 0, 0, 0, 0, 1\n0, 1, 0\n", lambda x, y, z: (-z, y, x)),
    ("*SYSTEM\n5, 6, 7\n*SYSTEM\n", lambda x, y, z: (x, y, z))))
def test_system(head, place):
    """Nodes are given in the axes of *SYSTEM, in `dd3 mesh` and in `dd3 tool`."""
    there = places(mesh_of(TWO))
    assert places(mesh_of(head + TWO)) == {label: place(*point) for label, point in there.items()}
    tool = facet_files.read_facets(Path("model.inp"))
    assert sorted(map(tuple, tool.nodes.round(9) + 0.0)) == sorted(place(*point) for point in there.values())


def test_cylinder():
    """Nodes in cylindrical coordinates, also within a *SYSTEM; spherical ones are refused by name."""
    text = TWO.replace("*NODE", "*NODE, SYSTEM=C").replace("4, 0, 3, 0", "4, 2D0, 90., 0")
    text = text.replace("14, 0, 3", "14, 2, 90")
    for label, x, y in ((1, 1, 0), (2, 2, 0), (3, 4, 0), (5, 3, 90), (6, 3, 30)):
        for at, z in ((label, 0), (label + 10, 1)):
            old = next(line for line in text.splitlines() if line.startswith(f"{at}, ") and line.count(",") == 3)
            text = text.replace(f"\n{old}\n", f"\n{at}, {x}, {y}, {z}\n")
    mesh = mesh_of(text.replace("\n5, 3, 90", "\n5, 3, 60").replace("\n15, 3, 90", "\n15, 3, 60"))
    assert mesh.nodes[4] == pytest.approx((0, 2, 0)) and mesh.nodes[2] == (2, 0, 0)
    assert mesh.nodes[16] == pytest.approx((3 * math.cos(math.pi / 6), 1.5, 1))
    assert mesh.nodes[5] == pytest.approx((1.5, 3 * math.sin(math.pi / 3), 0))
    with pytest.raises(Problem, match=r"model.inp:1: error: \*NODE, SYSTEM=S"):
        mesh_of(TWO.replace("*NODE", "*NODE, SYSTEM=S"))


def test_generated():
    """*NGEN, *NFILL, *NCOPY and *ELGEN make the mesh that is meant."""
    mesh = mesh_of(GENERATED)
    assert len(mesh.elements) == 4 and mesh.elements[4] == [12, 13, 23, 22, 112, 113, 123, 122]
    assert places(mesh) == {1 + i + 10 * j + 100 * k: (2 * i, 3 * j, k)
                            for i in range(3) for j in range(3) for k in range(2)}
    assert mesh.node_sets["far"] == {21, 22, 23}
    assert mesh.node_sets["upper"] == {label for label in mesh.nodes if label > 100}
    assert mesh.element_sets["sheet"] == {1, 2, 3, 4} and not mesh.model.left_out()


@pytest.mark.parametrize("line, middle", (
    ("*NGEN, LINE=P\n1, 5, 2, , 1., 1., 0.\n", (1, 1, 0)),
    ("*NGEN, LINE=P\n1, 5, 2, 90\n", (1, 1, 0)),
    ("*NGEN, LINE=C\n1, 5, 2, , 1., 0., 0., 0., 0., -1.\n", (1, 1, 0)),
    ("*NGEN, LINE=C\n1, 5, 2, , 1., 0., 0., 0., 0., 1.\n", (1, -1, 0)),
    ("*NGEN, LINE=C\n1, 5, 2, , 1., -1., 0.\n", (1, -1 + math.sqrt(2), 0)),
    ("*NGEN, LINE=C, SYSTEM=C\n1, 5, 2, , 1.4142135623731, -45., 0.\n", (1, -1 + math.sqrt(2), 0))))
def test_lines(line, middle):
    """Nodes on parabolas and arcs."""
    text = "*NODE\n1, 0, 0, 0\n5, 2, 0, 0\n90, 1, 1, 0\n" + line + """*NSET, NSET=three
1, 3, 5
*NCOPY, CHANGE NUMBER=10, OLD SET=three, SHIFT, NEW SET=back
0, -9, 0
*NSET, NSET=six
three, back
*NCOPY, CHANGE NUMBER=20, OLD SET=six, SHIFT
0, 0, 1
*ELEMENT, TYPE=C3D8
1, 1, 3, 13, 11, 21, 23, 33, 31
2, 3, 5, 15, 13, 23, 25, 35, 33
"""
    assert mesh_of(text).nodes[3] == pytest.approx(middle, abs=1e-12)


@pytest.mark.parametrize("options, data, image", (
    ("SHIFT", "1, 2, 3\n", lambda x, y, z: (x + 1, y + 2, z + 3)),
    # The displacement comes before the rotation.
    ("SHIFT", "10, 0, 0\n0, 0, 0, 0, 0, 1, 90\n", lambda x, y, z: (-y, x + 10, z)),
    ("SHIFT", "\n9, 0, 0, 9, 0, 1, 90\n", lambda x, y, z: (9 - y, x - 9, z)),
    ("REFLECT=POINT", "1, 2, 30\n", lambda x, y, z: (2 - x, 4 - y, 60 - z)),
    ("REFLECT=LINE", "0, 0, 9, 1, 0, 9\n", lambda x, y, z: (x, -y, 18 - z)),
    ("REFLECT=MIRROR", "5, 0, 0, 5, 1, 0\n5, 0, 1\n", lambda x, y, z: (10 - x, y, z))))
def test_copies(options, data, image):
    """*NCOPY and *ELCOPY: displaced, turned and mirrored copies."""
    text = TWO + f"*NSET, NSET=all, GENERATE\n1, 16\n*NCOPY, CHANGE NUMBER=100, OLD SET=all, {options}\n" + data + \
        "*ELCOPY, ELEMENT SHIFT=10, OLD SET=sheet, SHIFT NODES=100, NEW SET=copy\n"
    mesh = mesh_of(text)
    there = places(mesh)
    assert mesh.elements[12] == [102, 103, 106, 105, 112, 113, 116, 115] and mesh.element_sets["copy"] == {11, 12}
    for label in range(1, 7):
        assert there[label + 100] == pytest.approx(image(*there[label]))


@pytest.mark.parametrize("text, message", (
    ("*NCOPY, CHANGE NUMBER=100, OLD SET=a, POLE\n1\n", "POLE"), ("*NGEN, LINE=Q\n1, 3\n", "LINE=P or C"),
    ("*NFILL, BIAS=1.2\na, a, 2\n", "BIAS"), ("*NMAP, NSET=a, TYPE=SCALE\n1\n", r"\*NMAP is not read"),
    ("*NGEN\n1, 3, 3\n", "no number of steps"), ("*NGEN\n1, 99\n", "no node 99"), ("*NGEN\n1\n", "got ''"),
    ("*ELGEN\n1, 999999, 1, 1, 999999, 1, 1\n", "more than"), ("*ELGEN\n9, 2\n", "no element 9"),
    ("*ELCOPY, OLD SET=sheet, SHIFT NODES=10\n", "ELEMENTSHIFT"), ("*SYSTEM\n1, 1, 1, 1, 1, 1\n", "coincide"),
    ("*ELEMENT, TYPE=C3D8, OFFSET=5\n", "OFFSET"), ("*NODE\n1, 0, 0, <a>\n", r"\*PARAMETER is not read"),
    ("*NODE\n1, 0, 0, 7\n", "node 1 is given twice"), ("*NODE\n1, nan\n", "expected a number, got 'nan'"),
    ("*NODE\n1, 1_0\n", "expected a number"), ("*NODE\n1.5, 0\n", "expected an integer"),
    ("*ELEMENT, TYPE=C3D8\n1, 2, 3, 6, 5, 12, 13, 16, 15\n", "element 1 is given twice"),
    ("*ELEMENT, TYPE=C3D8\n9, 2, 3, 6, 5, 12, 13, 16\n", "an element with 7 nodes"),
    ("*ELEMENT, TYPE=C3D8\n9, 2, 3, 6, 5, 12, 13, 16, 99\n", "node 99 of an element has no coordinates"),
    ("*INCLUDE, INPUT=nowhere.inp\n", "no file 'nowhere.inp'"), ("*INCLUDE, INPUT=model.inp\n", "too deeply")))
def test_refused(text, message):
    """What would make another mesh is refused by name, with its line."""
    with pytest.raises(Problem, match=message) as problem:
        mesh_of(TWO + text)
    assert str(problem.value).startswith("model.inp:")


def test_sets():
    """Sets of elements' nodes, of sets, generated; names in quotes; keyword lines that go on."""
    mesh = mesh_of(TWO + '*ELSET, ELSET=one\n1\n*NSET, NSET=of, ELSET=one\n*nset, nset="Of Two",\nGenerate\n1, 5, 2\n'
                   "*NSET, NSET=all\nof, of two, 16\n*NSET, NSET=twice\n 1,\n*NSET, NSET=twice\n 2,\n")
    assert mesh.node_sets == {"of": {1, 2, 5, 4, 11, 12, 15, 14}, "of two": {1, 3, 5}, "twice": {1, 2},
                              "all": {1, 2, 5, 4, 11, 12, 15, 14, 3, 16}}
    assert not mesh.model.left_out()


ASSEMBLY = "*PART, NAME=Sheet\n" + TWO + """*NSET, NSET=tip
1
*END PART
*ASSEMBLY, NAME=a
*INSTANCE, NAME=Sheet-1, PART=Sheet
10., 0., 0.
0., 0., 0., 0., 0., 1., 90.
*END INSTANCE
*NSET, NSET=ends, INSTANCE=Sheet-1
1, 3
*NSET, NSET=others
Sheet-1.2, Sheet-1.tip
*NSET, NSET=tip, INSTANCE=Sheet-1
6
*END ASSEMBLY
"""


def test_instances():
    """An instance is displaced, then turned; sets of the assembly; several instances have to be chosen from."""
    mesh = mesh_of(ASSEMBLY)
    assert places(mesh) == {label: (-y, x + 10, z) for label, (x, y, z) in places(mesh_of(TWO)).items()}
    assert mesh.node_sets == {"ends": {1, 3}, "others": {1, 2}, "tip": {6}, "sheet-1.tip": {1}}
    Path("model.inp").write_text(ASSEMBLY)
    tool = facet_files.read_facets(Path("model.inp"))
    assert tool.nodes[:, 1].min() == 10 and tool.names == ["sheet"]
    two = ASSEMBLY.replace("*END ASSEMBLY", "*INSTANCE, NAME=Sheet-2, PART=sheet\n*END INSTANCE\n*END ASSEMBLY")
    with pytest.raises(Problem, match="there are: sheet-1, sheet-2"):
        mesh_of(two, "Sheet")
    mesh = mesh_of(two, "Sheet-2")
    assert places(mesh) == places(mesh_of(TWO)) and mesh.node_sets == {"tip": {1}}
    mesh_of(two, "Sheet-2")
    facets = facet_files.read_facets(Path("model.inp"))
    assert facets.names == ["sheet-1", "sheet-2"] and len(facets.nodes) == 24
    with pytest.raises(Problem, match="no part 'other'"):
        mesh_of(ASSEMBLY.replace("PART=Sheet", "PART=Other"))
    mesh = mesh_of(ASSEMBLY.replace("*ASSEMBLY", "*PART, NAME=idle\n" + TWO + "*END PART\n*ASSEMBLY"))
    assert [item.name for item in mesh.model.left_out()] == ["*PART idle"]


def test_own_mesh():
    """An instance may have its mesh itself; files are included."""
    Path("nodes.inp").write_text(TWO.partition("*ELEMENT")[0].partition("\n")[2])
    text = "*ASSEMBLY, NAME=a\n*INSTANCE, NAME=i\n0, 0, 5\n*NODE, INPUT=nodes.inp\n*INCLUDE, INPUT=rest.inp\n" \
        "*END INSTANCE\n*END ASSEMBLY\n"
    Path("rest.inp").write_text("*ELEMENT" + TWO.partition("*ELEMENT")[2])
    assert places(mesh_of(text)) == {label: (x, y, z + 5) for label, (x, y, z) in places(mesh_of(TWO)).items()}


def test_left_out():
    """One unknown thing of every kind is named with its line, in `dd3 mesh` and `dd3 tool`."""
    Path("model.inp").write_text(UNKNOWN)
    said = call("mesh", "model.inp", "part.inp")
    numbers = [int(line.split(":")[2]) for line in said.splitlines() if line.startswith("left out: model.inp")]
    assert numbers == sorted(numbers)
    for line, text in ((1, "data line: no keyword"), (5, "*NODE, values after the first 4"),
                       (13, "nodes without hexahedra: 1"), (17, "*ELEMENT, TYPE=S4R: 1"),
                       (18, "*NSET, COLOUR = red: not used"),
                       (18, "*NSET some: there is no node 77"), (18, "*NSET some: there is no set 'nowhere'"),
                       (20, "*ELSET both: 1 elements that are no"), (21, "*ELSET, values after the first 3"),
                       (23, "*TRANSFORM: not read"), (25, "*FROBNICATE: not read"), (26, "*SURFACE: not read")):
        assert f"left out: model.inp:{line}: {text}" in said, said
    solid = UNKNOWN.replace("TYPE=S4R", "TYPE=B33").replace("7, 1, 2, 3, 4", "7, 1, 2")
    Path("model.inp").write_text(solid)
    notes = "\n".join(facet_files.read_facets(Path("model.inp")).notes)
    for line, text in ((1, "data line"), (5, "*NODE, values"), (17, "*ELEMENT, TYPE=B33: 1"), (18, "*NSET, COLOUR"),
                       (23, "*TRANSFORM: not read"), (25, "*FROBNICATE: not read"), (26, "*SURFACE: not read")):
        assert f"left out: model.inp:{line}: {text}" in notes, notes


HANGING = TWO.replace("2, 2, 3, 6, 5, 12, 13, 16, 15", """2, 2, 3, 21, 20, 12, 13, 23, 22
3, 20, 21, 6, 5, 22, 23, 16, 15""").replace("11, 0, 0, 1", """20, 2, 1.5, 0
21, 4, 1.5, 0
22, 2, 1.5, 1
23, 4, 1.5, 1
11, 0, 0, 1""")


def test_hanging():
    """A node on an edge or a face of an element without it is refused with its place, but for one in the middle of an
    edge, which is bound; unjoined nodes are told."""
    Path("model.inp").write_text(HANGING.replace(", 1.5,", ", 1.2,"))
    said = call("mesh", "model.inp", "part.inp", expect=2)
    assert "node 20 at 2 1.2 0 lies on an edge or a face of element 1" in said and "1 more" in said
    Path("model.inp").write_text(HANGING)
    call("mesh", "model.inp", "part.inp")
    bound = Path("part.inp").read_text().split("*MPC\n")[1].splitlines()[:2]
    assert all(line.startswith("LINEAR, ") for line in bound)
    # The same by *MPC, also off the chord of the edge; other constraints are left out.
    bent = HANGING.replace("20, 2, 1.5, 0", "20, 2, 1.5, 0.1").replace("22, 2, 1.5, 1", "22, 2, 1.5, 1.1")
    Path("model.inp").write_text(bent + "\n*MPC\nLINEAR, 20, 2, 5\nBEAM, 1, 2\nLINEAR, 22, 12, 15\n")
    said = call("mesh", "model.inp", "bent.inp")
    assert "*MPC, BEAM: LINEAR with the labels of three nodes is read" in said
    assert Path("bent.inp").read_text().split("*MPC\n")[1].splitlines()[:2] == bound
    # In the middle of a face: an element halved through the thickness and along y beside a whole one.
    Path("model.inp").write_text(HANGING.replace("20, 2, 1.5, 0", "20, 2, 1.5, 0.5"))
    assert "node 20 at 2 1.5 0.5" in call("mesh", "model.inp", "part.inp", expect=2)
    apart = TWO.replace("2, 2, 3, 6, 5, 12,", "2, 32, 3, 6, 5, 12,").replace("\n3, 4", "\n32, 2, 0, 0\n3, 4")
    Path("model.inp").write_text(apart)
    assert "warning: 1 nodes at the place of another one" in call("mesh", "model.inp", "part.inp")
    assert "warning" not in call("mesh", "model.inp", "part.inp", "--merge", "1e-3")


def test_many_nodes():
    """A large mesh has no hanging nodes, curved as it may be, and takes seconds."""
    n = 60
    lines = ["*NODE"]
    for k in range(2):
        for j in range(n):
            for i in range(n):
                lines.append(f"{1 + i + n * j + n * n * k}, {i}, {j}, {k + 0.02 * (i - 30) ** 2 + 3 * math.sin(j)!r}")
    lines.append("*ELEMENT, TYPE=C3D8")
    for j in range(n - 1):
        for i in range(n - 1):
            a = 1 + i + n * j
            corners = [a, a + 1, a + n + 1, a + n]
            lines.append(", ".join(map(str, [a, *corners, *(node + n * n for node in corners)])))
    mesh = mesh_of("\n".join(lines) + "\n")
    assert len(mesh.nodes) == 2 * n * n and check_joints(mesh, Path("model.inp")) == 0


def read_both(path):
    """Read a file as mesh and as tool; return how many ended with a message."""
    problems = 0
    for read in (lambda: read_inp(path, None), lambda: facet_files.read_facets(path)):
        try:
            found = read()
            if hasattr(found, "elements"):
                check_joints(found, path)
                renumber(found)
                if found.elements:
                    write_inp(Path("out.inp"), found, path)
            else:
                assert np.isfinite(found.nodes).all()
        except Problem as problem:
            problems += 1
            assert str(problem)
    return problems


@pytest.mark.parametrize("text, seed", ((UNKNOWN, 1), (GENERATED, 2), (ASSEMBLY, 3), (HANGING, 4)))
def test_mutants(text, seed):
    """Broken files end with a message."""
    problems = 0
    for mutant in mutants(text.encode(), 250, seed):
        Path("mutant.inp").write_bytes(mutant)
        problems += read_both(Path("mutant.inp"))
    assert problems > 50
