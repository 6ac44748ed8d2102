# SPDX-License-Identifier: GPL-3.0-or-later
"""What readers of meshes and CAD leave out, with its place, and damaged files of each kind."""

import contextlib
import faulthandler
import os

import gmsh
import pytest
from helpers import call
from mutations import mutants

from dd3.account import Account
from dd3.errors import Problem
from dd3.tools import cad_file
from dd3.tools.cad_account import enter_cad
from dd3.tools.facet_files import read_facets

STL = """solid one
facet normal 0 0 1
 outer loop
  vertex 0 0 0
  vertex 20 0 0
  vertex 20 10 0
 endloop
endfacet
facet normal 0 0 1
 outer loop
  vertex 0 0 0
  vertex 20 10 0
  vertex 0 10 0
 endloop
endfacet
endsolid one
"""
OBJ = """# two triangles
o thing
v 0 0 0
v 20 0 0
v 20 10 0
v 0 10 0
f 1 2 3
f 1 3 4
"""
PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
end_header
0 0 0
20 0 0
20 10 0
0 10 0
3 0 1 2
3 0 2 3
"""
VTK = """# vtk DataFile Version 3.0
two triangles
ASCII
DATASET POLYDATA
POINTS 4 float
0 0 0 20 0 0 20 10 0 0 10 0
POLYGONS 2 8
3 0 1 2
3 0 2 3
"""
MSH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
1 0 0 0
2 20 0 0
3 20 10 0
4 0 10 0
$EndNodes
$Elements
3
1 1 2 7 1 1 2
2 2 2 1 1 1 2 3
3 2 2 1 1 1 3 4
$EndElements
"""
MUTANTS = 1000  # of each kind that a library reads, in child processes
# Kind of file, what is added to it, and how that is named.
UNKNOWN = [
    ("a.stl", STL.replace("facet normal", "colour 3\nfacet normal", 1), "a.stl:2: colour: not a keyword of STL"),
    ("a.obj", OBJ + "vt 0 0\nl 1 2\n", "a.obj:9: vt"), ("a.obj", OBJ + "l 1 2\n", "a.obj:9: l"),
    ("a.obj", OBJ + "foo 3\n", "a.obj:9: foo"), ("a.obj", OBJ, "a.obj:2: o"),
    ("a.ply", PLY.replace("end_header", "element foo 1\nproperty int a\nend_header") + "7\n", "a.ply:9: element foo, 1"),
    ("a.ply", PLY.replace("float z\n", "float z\nproperty uchar red\n").replace("0 0\n", "0 0 5\n").replace(
        "10 0\n", "10 0 5\n"), "a.ply:7: property red"),
    ("a.vtk", VTK + "POINT_DATA 4\nSCALARS heat float 1\nLOOKUP_TABLE default\n1 2 3 4\n", "a.vtk: field heat of nodes"),
    ("a.vtk", VTK.replace("POLYGONS", "LINES 1 3\n2 0 1\nPOLYGONS"), "a.vtk: 1 lines"),
    ("a.msh", MSH, "a.msh: 1 elements of dimension 1"),
    ("a.msh", MSH + "$Foo\n1\n$EndFoo\n", "a.msh:17: $Foo"),
    ("a.msh", MSH + '$NodeData\n1\n"heat"\n1\n0\n3\n0\n1\n1\n1 5\n$EndNodeData\n', "a.msh:17: $NodeData")]
CUT = [("a.stl", STL[:STL.index("endsolid")], "cut off"), ("a.stl", STL[:170], "inside outer of facet of solid"),
       ("a.ply", PLY[:-8], "cut off"),
       ("a.ply", PLY.replace("element face 2", "element face ²"), "a.ply:7: error: 'element face"),
       ("a.ply", PLY.replace("element face 2", "element face " + 5000 * "9"), "expected element, its name and its number"),
       ("a.ply", PLY.replace("element face", "element foo 1\nproperty int a\nelement face").replace("\n3 0 1 2", "\n7\n3 0 1 2"),
        "a.ply:7: element foo, 1: not read"), ("a.msh", MSH[:-16], "without its end: the file is cut off")]


@pytest.mark.parametrize(("name", "text", "said"), UNKNOWN)
def test_left_out(tmp_path, name, text, said):
    """Check that what no facet is made of is named, with its line where the format has lines."""
    (tmp_path / name).write_text(text)
    printed = call("tool", name)
    assert f"left out: {said}" in printed, printed


def step_and_iges(folder):
    """Write a box as STEP and IGES."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    with cad_file.silence():
        gmsh.model.occ.addBox(0, 0, 0, 10, 20, 5)
        gmsh.model.occ.synchronize()
        for ending in ("step", "igs"):
            gmsh.write(str(folder / f"box.{ending}"))
    gmsh.finalize()


def test_cad(tmp_path):
    """Check that entities of STEP and IGES without geometry are named with their lines, and faces that are lost."""
    step_and_iges(tmp_path)
    text = (tmp_path / "box.step").read_text()
    for name in ("box.step", "box.igs"):
        assert "left out" not in call("tool", name)
    more = "#9001=FOO_THING('a;b',#9002);\n#9002=COLOUR_RGB('',1.,0.,0.);\n/* #9003=NOTHING(); */\n"
    (tmp_path / "more.step").write_text(text.replace("ENDSEC;\nEND-ISO", more + "ENDSEC;\nEND-ISO"))
    lines = (tmp_path / "more.step").read_text().splitlines()
    said = call("tool", "more.step")
    for kind in ("FOO_THING", "COLOUR_RGB"):
        number = next(i for i, line in enumerate(lines, 1) if kind in line)
        assert f"left out: more.step:{number}: {kind}: no geometry of a part" in said, said
    assert "NOTHING" not in said
    assert f"more.step:{number}: COLOUR_RGB" in call("curve", "more.step", "x.txt", expect=2)
    assert f"left out: more.step:{number}: COLOUR_RGB" in call("unfold", "more.step", "x.txt", expect=2)
    # A surface of a kind that is not known: OpenCASCADE leaves out its face and says nothing.
    (tmp_path / "lost.step").write_text(text.replace("= PLANE(", "= FOO_SURFACE(", 1).replace("=PLANE(", "=FOO_SURFACE(", 1))
    assert "of the 6 faces of the file are not read" in call("tool", "lost.step", expect=2)
    lines = (tmp_path / "box.igs").read_text().splitlines(keepends=True)
    first = next(i for i, line in enumerate(lines) if line[72:73] == "D")
    lines[first] = "     314" + lines[first][8:]
    (tmp_path / "more.igs").write_text("".join(lines))
    account = Account()
    enter_cad(tmp_path / "more.igs", account, 6)
    assert [str(item) for item in account.left_out()] == [
        f"{tmp_path}/more.igs:{first + 1}: entity of type 314: no geometry of a part"]


@pytest.mark.parametrize(("name", "text", "said"), CUT)
def test_cut(tmp_path, name, text, said):
    """Check that files that end too early are refused."""
    (tmp_path / name).write_text(text)
    assert said in call("tool", name, expect=2)


def first_bad(path, data):
    """Return the first of the mutants whose reading ends in anything but facets or a Problem, None without one. They are
    read in a child process, and in a new one after a fault in a library, of which `dd3 tool` makes a message. The
    libraries are first loaded there: their threads do not outlive a fork."""
    known, done = list(data), path.with_name("done")
    start = 0
    while start < len(known):
        child = os.fork()
        if not child:
            read_all(path, known, done, start)
        status = os.waitpid(child, 0)[1]
        if not os.WIFSIGNALED(status):
            return known[int(done.read_text())] if os.WEXITSTATUS(status) else None
        start = int(done.read_text()) + 1
    return None


def read_all(path, known, done, start):
    """Read mutants from one on and end this process."""
    faulthandler.disable()
    code = 1
    try:
        for number in range(start, len(known)):
            done.write_text(str(number))
            path.write_bytes(known[number])
            with contextlib.suppress(Problem):
                read_facets(path)
        code = 0
    finally:
        os._exit(code)


@pytest.mark.parametrize(("name", "text"), [("a.stl", STL), ("a.obj", OBJ), ("a.ply", PLY), ("a.vtk", VTK), ("a.msh", MSH)])
def test_mutants(tmp_path, capfd, name, text):
    """Check that no damaged mesh ends in anything but facets or a Problem."""
    path = tmp_path / name
    if name != "a.stl":
        assert first_bad(path, mutants(text.encode(), MUTANTS, 3)) is None
        return
    for mutant in mutants(text.encode(), 1000, 3):
        path.write_bytes(mutant)
        try:
            read_facets(path)
        except Problem as problem:
            assert name in str(problem)


@pytest.mark.slow
def test_mutants_of_cad(tmp_path):
    """Check that the account of a damaged STEP or IGES file ends in nothing but a Problem."""
    step_and_iges(tmp_path)
    for name in ("box.step", "box.igs"):
        path = tmp_path / f"mutant_{name}"
        for mutant in mutants((tmp_path / name).read_bytes(), MUTANTS, 4):
            path.write_bytes(mutant)
            account = Account()
            try:
                enter_cad(path, account, 6)
                account.left_out()
            except Problem as problem:
                assert name in str(problem)
