# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes from files: a blank written to a file and read again gives the same results bit for bit, also with its
elements turned or numbered otherwise within round-off; models of other programs are read by `dd3 mesh`."""

import itertools
import random
import re
import subprocess
from pathlib import Path

import gmsh
import numpy as np
import pytest
from helpers import ROOT, call

from dd3 import mesh as meshes
from dd3.errors import Problem
from dd3.tables import number, read_table

CORNERS = meshes.NATURAL[:8]
SETS = {"x_min": "plane = x 0", "y_min": "plane = y 0"}
GEOMETRY = """R = 20; Mesh.RecombineAll = 1; Mesh.Algorithm = 8; Mesh.MeshSizeMax = 5; Mesh.MeshSizeMin = 5;
Point(1) = {0,0,0}; Point(2) = {R,0,0}; Point(3) = {0,R,0};
Line(1) = {1,2}; Circle(2) = {2,1,3}; Line(3) = {3,1};
Curve Loop(1) = {1,2,3}; Plane Surface(1) = {1};
e[] = Extrude {0,0,1} { Surface{1}; Layers{2}; Recombine; };
Physical Volume("disc") = {e[1]}; Physical Surface("at y 0") = {e[2]}; Physical Surface("at x 0") = {e[4]};
"""
MODEL = """*Heading
 Another program's model
*Part, name=Sheet
*Node
 11, 0., 0., 0.
 12, 0.01, 0., 0.
 13, 0.01, 0.01, 0.
 14, 0., 0.01, 0.
 15, 0., 0., 0.001
 16, 0.01, 0., 0.001
 17, 0.01, 0.01, 0.001
 18, 0., 0.01, 0.001
 99, 1., 1., 1.
*Element, type=C3D8R
 5, 15, 16, 17, 18, 11,
 12, 13, 14
*Element, type=S4R
 6, 11, 12, 13, 14
*Nset, nset=Fixed, generate
 11, 17, 3
*Elset, elset="The Sheet"
 5, 6
*Solid Section, elset=Sheet, material=Steel
*End Part
*Assembly, name=Assembly
*Instance, name=Sheet-1, part=Sheet
 0., 0., 5.
*End Instance
*Nset, nset=Tip, instance=Sheet-1
 12, 13
*End Assembly
*Step
*Static
*End Step
"""
DECK = """*MESH sheet
  file = "{file}"
  material = steel
*MATERIAL steel
  young = 2.1e5
  poisson = 0.3
  yield = von_mises
  hardening = perfect Y0=200
*BOUNDARY fixed
  set = {fixed}
  fix = x y z
*PHASE pull
  control = load
  trial = 1
  load = {tip} 1 0 0
"""


def launch(program, deck, out, *options):
    """Run a deck; return the rows of its history."""
    done = subprocess.run([program, "--quiet", "--output", out, *options, deck], capture_output=True, text=True,
                          check=False)
    assert done.returncode == 0, done.stderr
    return read_table(out / "history.csv")


def with_mesh(deck, file, sets):
    """Return the text of a deck with its blank replaced by a mesh file, and paths made absolute."""
    text = re.sub(r'patches = "(.*?)"', lambda found: f'patches = "{(deck.parent / found[1]).resolve()}"',
                  deck.read_text())
    start = text.index("*BLANK")
    end = text.index("*", start + 1)
    material = re.search(r"material = (\w+)", text[start:end])[1]
    element = re.search(r"element = (\w+)", text[start:end])
    block = f'*MESH sheet\n  file = "{file}"\n  material = {material}\n' + (f"  {element[0]}\n" if element else "")
    block += "".join(f"*SET {name}\n  {where}\n" for name, where in sets.items())
    return text[:start] + block + text[end:]


def rotations():
    """Return the 24 orders of the nodes of a turned hexahedron."""
    for axes in itertools.permutations(range(3)):
        for signs in itertools.product((1, -1), repeat=3):
            order = [CORNERS.index(tuple(s * node[a] for a, s in zip(axes, signs))) for node in CORNERS]
            if meshes.volume_sign([CORNERS[i] for i in order]) > 0:
                yield order


@pytest.mark.parametrize("case, sets, options", (
    ("round_cup", SETS, ("--set", "depth=2")), ("bending_start", {**SETS, "x_min": "plane = x 0"}, ())))
def test_round_trip(program, tmp_path, case, sets, options):
    """Write the mesh of a run to a file, and run the file instead; then with turned and renumbered elements."""
    deck = ROOT / "tests" / "cases" / case / "case.dat"
    blank = launch(program, deck, tmp_path / "blank.out", *options)
    source = meshes.read_run(tmp_path / "blank.out" / "fields.vtkhdf")
    meshes.renumber(source)
    meshes.write_inp(tmp_path / "sheet.inp", source, Path("fields.vtkhdf"))
    copy = tmp_path / "mesh.dat"
    copy.write_text(with_mesh(deck, "sheet.inp", sets))
    assert launch(program, copy, tmp_path / "mesh.out", *options) == blank, f"{deck}: other results with the mesh file"
    random.seed(1)
    orders = list(rotations())
    assert len(orders) == 24
    for label, nodes in source.elements.items():
        source.elements[label] = [nodes[i] for i in random.choice(orders)]
    nodes, elements = list(source.nodes), list(source.elements)
    random.shuffle(nodes)
    random.shuffle(elements)
    source.nodes = {label: source.nodes[label] for label in nodes}
    source.elements = {label: source.elements[label] for label in elements}
    meshes.write_inp(tmp_path / "sheet.inp", source, Path("fields.vtkhdf"))
    other = launch(program, copy, tmp_path / "turned.out", *options)
    for column in blank[-1]:
        if column.endswith("_fz"):
            one, two = number(blank[-1], column, "blank"), number(other[-1], column, "turned")
            assert abs(one - two) <= 1e-3 * abs(one), f"{deck}: {column} {one} and {two} with turned elements"


def test_model(program, tmp_path):
    """Read the model of another program: units, sets of the assembly, turned element."""
    (tmp_path / "model.inp").write_text(MODEL)
    said = call("mesh", "--scale", "1000", "model.inp", "part.inp")
    for text in ("8 nodes, 1 elements", "fixed tip", "the_sheet", "turned: 1", "S4R: 1", "without hexahedra: 1"):
        assert text in said
    (tmp_path / "part.dat").write_text(DECK.format(file="part.inp", fixed="fixed", tip="tip"))
    launch(program, tmp_path / "part.dat", tmp_path / "part.out")
    for wrong, text in (("*Element, type=C3D8\n1, 1, 2, 3\n", "an element with 3 nodes"),
                        ("*Node\n1, a, b\n", "wrong.inp:2: error: *NODE: expected a number, got 'a'"),
                        ("*Node\n1, 0, 0, 0\n", "expected one part with hexahedra")):
        (tmp_path / "wrong.inp").write_text(wrong)
        assert text in call("mesh", "wrong.inp", "part.inp", expect=2)


def test_gmsh(program, tmp_path):
    """Mesh a geometry by Gmsh and read its mesh in several formats."""
    (tmp_path / "disc.geo").write_text(GEOMETRY)
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.open(str(tmp_path / "disc.geo"))
    gmsh.model.mesh.generate(3)
    for name in ("disc.msh", "disc.vtk", "disc.unv"):
        gmsh.write(str(tmp_path / name))
    gmsh.finalize()
    found = []
    for name in ("disc.geo", "disc.msh", "disc.vtk", "disc.unv"):
        mesh = meshes.read_gmsh(tmp_path / name)
        meshes.renumber(mesh)
        found.append((len(mesh.nodes), len(mesh.elements)))
        meshes.turn_mirrored(mesh)
        meshes.write_inp(tmp_path / "disc.inp", mesh, Path(name))
        sets = name != "disc.vtk"
        names = set(map(meshes.set_name, mesh.node_sets))
        assert names == ({"at_y_0", "at_x_0"} if sets else set()), names
        fixed = "at_x_0" if sets else "z_min"
        (tmp_path / "disc.dat").write_text(DECK.format(file="disc.inp", fixed=fixed, tip="z_max"))
        launch(program, tmp_path / "disc.dat", tmp_path / "disc.out")
    assert len(set(found)) == 1 and found[0][1] > 20, found


@pytest.mark.parametrize("grid", ["GRID    {:>8}{cp:>8}{:8.3f}{:8.3f}{:8.3f}", "GRID,{},{cp},{},{},{}",
                                  "GRID*   {:>16}{cp:>16}{:16.6f}{:16.6f}*\n*       {:16.6f}"])
def test_nastran(tmp_path, grid):
    """Check a Nastran file, and that nodes in a coordinate system of their own are refused with their line."""
    corners = [(x, y, z) for z in (0.0, 1.0) for x, y in ((0.0, 0.0), (10.0, 0.0), (10.0, 5.0), (0.0, 5.0))]
    cell = "CHEXA          1       1       1       2       3       4       5       6+       \n+              7       8"
    for cp in ("", 0, 2):
        text = "\n".join(["BEGIN BULK", *(grid.format(i, *corner, cp=cp) for i, corner in enumerate(corners, 1)), cell,
                          "ENDDATA", ""])
        (tmp_path / "cell.bdf").write_text(text)
        if cp == 2:
            with pytest.raises(Problem, match=r"cell.bdf:2: error: GRID in the coordinate system 2; expected CP = 0"):
                meshes.read_gmsh(tmp_path / "cell.bdf")
        else:
            assert sorted(meshes.read_gmsh(tmp_path / "cell.bdf").nodes.values()) == sorted(corners)


def test_merge():
    """Check that nodes within the tolerance of an earlier one are replaced by it, and volumes by their sign."""
    nodes = {10 + i: tuple(place) for i, place in enumerate([*CORNERS, *np.add(CORNERS, (2 + 1e-5, 0, 0))])}
    mesh = meshes.Mesh(nodes, {1: list(range(10, 18)), 2: list(range(18, 26))}, {"face": {18, 21}})
    assert meshes.merge_nodes(mesh, 1e-4) == 4 and meshes.merge_nodes(mesh, 1e-6) == 0
    assert mesh.elements[2][:4] == [11, 19, 20, 12] and mesh.node_sets["face"] == {11, 12}
    meshes.renumber(mesh)
    assert len(mesh.nodes) == 12 and meshes.turn_mirrored(mesh) == 0
    mesh.elements[1] = mesh.elements[1][4:] + mesh.elements[1][:4]
    assert meshes.turn_mirrored(mesh) == 1


# The order of VTK, of its manual: 12 edges as in Abaqus, faces -x +x -y +y -z +z, centre.
VTK_PLACES = [*meshes.NATURAL[:20], (-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1), (0, 0, 0)]
GRID = """# vtk DataFile Version 2.0
one cell
ASCII
DATASET UNSTRUCTURED_GRID
POINTS {0} double
{2}
CELLS 1 {3}
{0} {4}
CELL_TYPES 1
{1}
"""


def second_order(kind, points):
    """Return the text of a VTK file with one cell, whose nodes have these places in its order."""
    return GRID.format(len(points), kind, "\n".join(" ".join(map(str, point)) for point in points), len(points) + 1,
                       " ".join(map(str, range(len(points)))))


def in_order(path):
    """Tell whether the nodes of the hexahedra of an .inp file are where those of Abaqus are, without curved edges."""
    mesh = meshes.read_inp(Path(path), None)
    for nodes in mesh.elements.values():
        points, natural = np.array([mesh.nodes[node] for node in nodes]), np.array(meshes.NATURAL)[:len(nodes)]
        shape = np.prod(1 + natural[:, None, :] * np.array(CORNERS), axis=2) / 8
        if len(nodes) == 8 or not np.allclose(points, shape @ points[:8], atol=1e-6):
            return False
    return True


@pytest.mark.parametrize("kind, count", ((25, 20), (29, 27)))
def test_second_order(tmp_path, kind, count):
    """Read a cell of VTK of second order; refuse one with nodes between corners in a wrong order."""
    points = (np.array(VTK_PLACES[:count]) + 1) * (10, 5, 1)
    (tmp_path / "q.vtk").write_text(second_order(kind, points.tolist()))
    call("mesh", "q.vtk", "q.inp")
    assert in_order("q.inp")
    points[[12, 16]] = points[[16, 12]]
    (tmp_path / "q.vtk").write_text(second_order(kind, points.tolist()))
    said = call("mesh", "q.vtk", "q.inp", expect=2)
    assert re.search(r"q.vtk: error: node 13 of element \d+ is 10.0\d* mm from the middle between its nodes 5 and 6, "
                     "which are 20 mm apart", said), said
    bent = np.array(VTK_PLACES[:count], float)  # an arc of 100 degrees, whose nodes are right
    angle, radius = np.radians(50) * bent[:, 0], 20 + bent[:, 2]
    points = np.column_stack([radius * np.sin(angle), 5 * bent[:, 1], radius * np.cos(angle)])
    (tmp_path / "q.vtk").write_text(second_order(kind, points.tolist()))
    call("mesh", "q.vtk", "q.inp")


@pytest.mark.parametrize("incomplete, suffixes", ((1, ("msh", "vtk", "unv", "med", "bdf")), (0, ("msh", "vtk", "med"))))
def test_second_order_of_gmsh(tmp_path, incomplete, suffixes):
    """Read what Gmsh writes of second order."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", incomplete)
    gmsh.option.setNumber("Mesh.RecombineAll", 1)
    gmsh.model.occ.addBox(0, 0, 0, 20, 10, 2)
    gmsh.model.occ.synchronize()
    for _, curve in gmsh.model.getEntities(1):
        gmsh.model.mesh.setTransfiniteCurve(curve, 3)
    gmsh.model.mesh.setTransfiniteAutomatic()
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    for suffix in suffixes:
        gmsh.write(str(tmp_path / f"box.{suffix}"))
    gmsh.finalize()
    for suffix in suffixes:
        call("mesh", f"box.{suffix}", "box.inp")
        assert in_order("box.inp"), suffix


def test_merge_too_large(tmp_path):
    """Refuse to merge two nodes of an element; what has a node twice before is not due to it."""
    (tmp_path / "model.inp").write_text(MODEL)
    said = call("mesh", "--scale", "1000", "--merge", "2", "model.inp", "part.inp", expect=2)
    assert "--merge 2 makes one node of the nodes 15 and 11 of element 5, whose shortest edge is 1 mm long" in said, said
    assert not (tmp_path / "part.inp").exists()
    call("mesh", "--scale", "1000", "--merge", "0.9", "model.inp", "part.inp")


def test_names_of_sets(tmp_path):
    """Number the later ones of sets whose names become the same."""
    geometry = GEOMETRY.replace("at y 0", "Bottom face").replace("at x 0", "bottom_FACE")
    (tmp_path / "disc.geo").write_text(geometry)
    said = call("mesh", "disc.geo", "disc.inp")
    assert "node sets: bottom_face bottom_face_2\n" in said, said
    assert "node set 'bottom_FACE' is written as bottom_face_2: another one is bottom_face\n" in said, said
    mesh = meshes.read_inp(tmp_path / "disc.inp", None)
    for name, axis in (("bottom_face", 1), ("bottom_face_2", 0)):
        assert all(abs(mesh.nodes[node][axis]) < 1e-9 for node in mesh.node_sets[name]), name
    assert meshes.set_names(["A b", "a_b_2", "a_b", "A B"]) == {"A b": "a_b_3", "a_b_2": "a_b_2", "a_b": "a_b",
                                                                "A B": "a_b_4"}
