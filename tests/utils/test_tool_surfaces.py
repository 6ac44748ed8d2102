# SPDX-License-Identifier: GPL-3.0-or-later
"""Tool surfaces: exact shapes and CAD against closed forms, options, reports, refusals; a run of the program with
--check on what was written."""

import math
import subprocess
import sys
from pathlib import Path
from unittest import mock

import gmsh
import numpy as np
from helpers import ROOT, call

from dd3.gmsh_session import session
from dd3.tools import cad_file, cad_mesh
from dd3.tools import surface as surfaces
from dd3.tools.joints import find_joints, folded, kinks

BOXES = """*PARAMETER
  radius = 5
*ROUNDED_BOX {kind}
  kind = {kind}
  half = 35 25
  corner = 10
  radius = ${{radius}}
  depth = 40
  flange = 30
  {more}
"""
PROFILE = """*PROFILE shoulder
  axes = {axes}
  start = 25 -40
  corner = 25 0 5
  line = 80 0
  {led}
"""
DECK = """*BLANK strip
  size = 10 10 1
  divisions = 8 8 1
  material = steel
*MATERIAL steel
  young = 2.1e5
  poisson = 0.3
  yield = von_mises
  hardening = perfect Y0=200
*BOUNDARY held
  set = x_min
  fix = x y z
*TOOL tool
  patches = "{file}"
  friction = 0.1
  contact = {side}
  position = 0 0 {height}
*CONTACT
  search_distance = 1
*PHASE move
  control = tool
  trial = 1
  move = tool 0 0 0.1
"""


def convert(*words, expect=0):
    """Convert a file; return what is said."""
    return call("tool", *words, expect=expect)


def read(path):
    """Return the patches of a .bez file, raised to degree 2."""
    raise_by = {2: np.array([[1, 0], [.5, .5], [0, 1]]), 3: np.eye(3)}
    nets = []
    for points, weights in surfaces.read_patches(path):
        net = surfaces.homogeneous(points, weights)
        nets.append(np.einsum("ai,bj,ijc->abc", raise_by[net.shape[0]], raise_by[net.shape[1]], net))
    return np.array(nets)


def points_of(net, count=9):
    """Return points and unit normals between the borders of the patches."""
    u, v = np.meshgrid(*[np.linspace(0.01, 0.99, count)] * 2)
    area = surfaces.areas_at(net, u.ravel(), v.ravel())
    return surfaces.points_at(net, u.ravel(), v.ravel()), area / np.linalg.norm(area, axis=2, keepdims=True)


def box_distance(point, half, corner, radius, kind):
    """Return the distance of points from the punch or the die of a box, its face at z = 0, positive on the sheet's
    side."""
    plan = np.abs(point[..., :2]) - (np.array(half) - corner)
    outwards = np.linalg.norm(np.maximum(plan, 0), axis=-1) + np.minimum(plan.max(axis=-1), 0) - corner
    # In the plane of the profile: a quarter of a circle between the face and the wall.
    if kind == "die":
        across, height = radius - outwards, point[..., 2] + radius
    else:
        across, height = outwards + radius, radius - point[..., 2]
    return np.where((across > 0) & (height > 0), np.hypot(across, height), np.maximum(across, height)) - radius


def check_program(program, file, side, height):
    """Check that the program takes the surface without a near miss."""
    deck = file.with_suffix(".dat")
    deck.write_text(DECK.format(file=file, side=side, height=height))
    done = subprocess.run([program, "--check", deck], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    line = next(line for line in done.stdout.splitlines() if line.startswith("tool 'tool'"))
    assert " 0 near misses, 0 T-junctions" in line, line
    return line


def test_boxes(tmp_path, program):
    """Check punch, die and holder of a box, whole and a quarter, and their offsets."""
    for kind, more in (("punch", ""), ("punch", "quarter = 5"), ("die", ""), ("die", "quarter = 5"), ("holder", "")):
        shape, bez = tmp_path / "box.shape", tmp_path / "box.bez"
        shape.write_text(BOXES.format(kind=kind, more=more))
        for offset in (0.0, 1.5, -1.5):
            said = convert(shape, bez, "--offset", offset)
            net = read(bez)
            joints, (point, normal) = find_joints(net), points_of(net)
            assert not len(folded(net)) and not len(joints.multiple) and kinks(net, joints).max() < 1e-5, said
            assert (len(joints.free) == 8) == (kind == "punch" and not more), said
            if kind == "holder":
                assert np.abs(normal - [0, 0, -1]).max() < 1e-9 and np.abs(point[..., 2] + offset).max() < 1e-9
                continue
            distance = box_distance(point, (35, 25), 10, 5, kind)
            assert np.abs(distance - offset)[point[..., 2] > -35].max() < 1e-8, (kind, offset)
            ahead = box_distance(point + 1e-4 * normal, (35, 25), 10, 5, kind)
            assert np.abs(ahead - distance - 1e-4)[np.abs(point[..., 2]) < 39].max() < 1e-6, (kind, offset)
        convert(shape, bez)
        check_program(program, bez, "z_min" if kind == "die" else "z_max", -1 if kind == "die" else 2)
    shape.write_text(BOXES.format(kind="punch", more=""))
    along, across = math.cos(math.radians(20)), math.sin(math.radians(20))
    x, y = 25 * along + 15 * across + 10, 25 * across + 15 * along + 10
    assert f"x {-x:.6g} to {x:.6g}, y {-y:.6g} to {y:.6g}," in convert(shape, bez, "--rotate", 0, 0, 1, 20)
    shape.write_text(BOXES.format(kind="die", more=""))
    assert "leaves nothing of the radius 5" in convert(shape, bez, "--offset", -6, expect=2)


def test_profiles(tmp_path, program):
    """Check extruded and revolved profiles in all axes, their sides and --turn."""
    shape, bez = tmp_path / "profile.shape", tmp_path / "profile.bez"
    for axes in ("x z", "z x", "y z", "z y", "x y", "y x"):
        first, second = ("xyz".index(axis) for axis in axes.split())
        for led in ("extrude = -10 45", "revolve = 0 360", "revolve = 30 -100"):
            shape.write_text(PROFILE.format(axes=axes, led=led))
            convert(shape, bez, "--offset", 1)
            point, normal = points_of(read(bez))
            across = np.delete(point, second, axis=2)
            across = point[..., first] if "extrude" in led else np.linalg.norm(across, axis=2)
            a, h = 30 - across, point[..., second] + 5
            distance = np.where((a > 0) & (h > 0), np.hypot(a, h), np.maximum(a, h)) - 5
            assert np.abs(distance - 1).max() < 1e-8, (axes, led)
            flat = point[..., second] > 1 - 1e-9
            assert (normal[flat][:, second] > 1 - 1e-9).all(), (axes, led)
    shape.write_text(PROFILE.format(axes="x z", led="revolve = 0 360"))
    convert(shape, bez, "--toward", 0, 0, -1)
    assert (points_of(read(bez))[1][..., 2] < 1e-9).all()
    convert(shape, bez, "--toward", 0, 0, 1, "--scale", 2, "--turn")
    point, normal = points_of(read(bez))
    assert (normal[..., 2] < 1e-9).all() and abs(point[..., 0].max() - 160) < 3
    convert(shape, bez)
    check_program(program, bez, "z_min", -1)
    for wrong, said in (("start = 1 1\n extrude = 0 1", "a profile has one start"),
                        ("extrude = 0", "expected 2 numbers"),
                        ("extrude = 0 0", "two different values"), ("", "expected extrude or revolve"),
                        ("line = 70 0 1\n extrude = 0 1", "expected 2 numbers, got '70 0 1'"),
                        ("arc = 90 0 84 1\n extrude = 0 1", "from its centre"), ("bend = 1", "unknown key 'bend'"),
                        ("corner = 80 50 50\n line = 81 50\n extrude = 0 1", "needs")):
        shape.write_text(PROFILE.format(axes="x z", led=wrong))
        assert said in convert(shape, bez, expect=2), wrong


def write_stl(path, triangles):
    """Write a binary STL file."""
    record = np.zeros(len(triangles), np.dtype([("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("rest", "<u2")]))
    record["points"] = triangles
    path.write_bytes(b" " * 80 + np.uint32(len(triangles)).tobytes() + record.tobytes())


def die_triangles(step, half=(35, 25), corner=10, radius=5):
    """Return the triangles of a die of a rounded box, its radii in facets of `step` degrees."""
    turn = np.radians(np.linspace(0, 90, round(90 / step) + 1))
    profile = [(corner, -40), *zip(corner + radius - radius * np.cos(turn), radius * np.sin(turn) - radius), (45, 0)]
    ring = [(np.array(sign) * (np.array(half) - corner), angle + np.pi / 2 * quarter)
            for quarter, sign in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))) for angle in turn]
    ring.append(ring[0])
    net = np.array([[[*(centre + across * np.array([np.cos(a), np.sin(a)])), height] for centre, a in ring]
                    for across, height in profile])
    a, b, c, d = net[:-1, :-1], net[:-1, 1:], net[1:, 1:], net[1:, :-1]
    return np.concatenate([np.stack(part, axis=2).reshape(-1, 3, 3) for part in ((a, b, c), (a, c, d))])


def test_stl(tmp_path, program):
    """Check dies from STL against the closed form, and broken ones."""
    stl, bez = tmp_path / "die.stl", tmp_path / "die.bez"
    for step, error in ((10, 0.002), (15, 0.006)):
        write_stl(stl, die_triangles(step))
        said = convert(stl, bez, "--toward", 0, 0, 1)
        point, normal = points_of(read(bez))
        assert np.abs(box_distance(point, (35, 25), 10, 5, "die")).max() < error, said
        assert (normal[np.abs(point[..., 2]) < 1e-6][:, 2] > 0.999).all()
    check_program(program, bez, "z_min", -1)
    write_stl(stl, die_triangles(30))
    assert "too coarse" in convert(stl, bez, "--toward", 0, 0, 1, expect=2)
    good = die_triangles(15)
    half = np.where((np.arange(len(good)) % 2 == 0)[:, None, None], good[:, ::-1], good)
    flat = [[good[0, 0], good[0, 0], good[0, 1]]]
    moved = good.copy()
    moved[:100] += [0, 0, 0.1]
    for triangles, options, code, words in (
            (half, (), 0, "turned: "), (np.concatenate([good, good[5:7]]), (), 0, "doubled facets left out: 2"),
            (np.concatenate([good, flat]), (), 0, "facets without area removed: 1"),
            (moved, (), 2, "--sew 0.15 joins them"), (moved, ("--sew", 0.12, "--tolerance", 1), 0, "nodes merged"),
            (good / 1000, (), 0, "warning: "), (good / 1000, ("--scale", 1000), 0, "x -70 to 70"),
            (good, ("--toward", 0, 0, 1, "--offset", 1), 0, "z -40 to 1 mm"),
            (good[:0], (), 2, "without facets"), (good, ("--part", "x"), 2, "no part 'x'; there are 1 'stl'")):
        write_stl(stl, triangles)
        said = convert(stl, bez, *options, expect=code)
        assert words in said, said
        assert code or (" 0 of more than two" in said and "folds      0" in said), said


MESHES = {
    "die.inp": "*Node\n1, 0, 0, 0\n2, 10, 0, 0\n3, 10, 10, 0\n4, 0, 10, 0\n5, 20, 0, 0\n6, 20, 10, 0\n"
               "*Element, type=R3D4, elset=tool\n1, 1, 2, 3, 4\n"
               "*Element, type=S3R, elset=tool\n2, 2, 5, 6\n3, 2, 6, 3\n",
    "die.k": "*KEYWORD\n*PART\nthe tool\n         7         1         1\n*NODE\n"
             + "".join(f"{n:8d}{x:16.6f}{y:16.6f}{0.0:16.6f}\n"
                       for n, x, y in ((1, 0, 0), (2, 10, 0), (3, 10, 10), (4, 0, 10), (5, 20, 0), (6, 20, 10)))
             + "*ELEMENT_SHELL\n" + "".join("".join(f"{v:8d}" for v in row) + "\n" for row in (
                 (1, 7, 1, 2, 3, 4), (2, 7, 2, 5, 6, 6), (3, 7, 2, 6, 3, 3))) + "*END\n",
    "die.stl": "solid tool\n" + "".join("facet normal 0 0 1\nouter loop\n" + "".join(
        f"vertex {x} {y} 0\n" for x, y in ring) + "endloop\nendfacet\n" for ring in (
            ((0, 0), (20, 0), (20, 10)), ((0, 0), (20, 10), (0, 10)))) + "endsolid\n",
    "solid.inp": "*Node\n" + "".join(f"{1 + i + 2 * j + 4 * k}, {20 * i}, {10 * j}, {10 * k - 10}\n"
                                     for k in (0, 1) for j in (0, 1) for i in (0, 1))
                 + "*Element, type=C3D8\n1, 1, 2, 4, 3, 5, 6, 8, 7\n",
}


def test_meshes(tmp_path, program):
    """Check small meshes of all kinds: the same rectangle."""
    for name, text in MESHES.items():
        (tmp_path / name).write_text(text)
        said = convert(tmp_path / name, tmp_path / "out.bez", "--toward", 0, 0, 1)
        point, normal = points_of(read(tmp_path / "out.bez"))
        top = np.abs(normal[..., 2] - 1) < 1e-9
        assert top.any() and np.abs(point[top][:, 2]).max() < 1e-9, (name, said)
        assert np.allclose(point[top].max(axis=0), [20, 10, 0], atol=0.2) and "error" not in said, (name, said)
    assert "no part 'x'; there are 1 '7 the tool'" in convert(tmp_path / "die.k", "--part", "x", expect=2)
    for name in ("text.stl", "text.inp", "text.k", "text.shape"):
        (tmp_path / name).write_text("no tool\n")
        convert(tmp_path / name, tmp_path / "out.bez", expect=2)
    (tmp_path / "die.ply").write_text("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                                    "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                                    "end_header\n0 0 0\n20 0 0\n20 10 0\n0 10 0\n4 0 1 2 3\n")
    assert "1 patch," in convert(tmp_path / "die.ply", tmp_path / "out.bez")
    (tmp_path / "text.vtk").write_text("no tool\n")
    convert(tmp_path / "text.vtk", expect=2)
    check_program(program, tmp_path / "out.bez", "z_min", -1)


def make_cad(folder):
    """Write CAD files: a punch with fillets, in mm and inches, with a doubled face, with loose and shifted faces."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    occ, model = gmsh.model.occ, gmsh.model

    def edges(chosen):
        occ.synchronize()
        return [tag for _, tag in model.getEntities(1) if chosen(model.getBoundingBox(1, tag))]

    def punch():
        gmsh.clear()
        box = occ.addBox(-35, -25, 0, 70, 50, 40)
        occ.fillet([box], edges(lambda ends: ends[5] - ends[2] > 30), [10])
        occ.fillet([box], edges(lambda ends: ends[5] < 1e-3), [5])
        occ.synchronize()
        return box, [tag for _, tag in model.getEntities(2)]

    def save(name):
        occ.synchronize()
        gmsh.write(str(folder / name))

    with cad_file.silence():
        punch()
        save("punch.step")
        text = (folder / "punch.step").read_text()
        metre = "SI_UNIT(.MILLI.,.METRE.)"
        assert metre in text
        (folder / "metres.step").write_text(text.replace(metre, "SI_UNIT($,.METRE.)"))
        save("punch.igs")
        box, faces = punch()
        occ.copy([(2, faces[3])])
        save("doubled.brep")
        for name, shift in (("loose.brep", 0.0), ("shifted.brep", 0.1), ("shifted_a_little.brep", 0.01)):
            box, faces = punch()
            copies = [occ.copy([(2, tag)])[0] for tag in faces]
            occ.remove([(3, box)], recursive=True)
            occ.translate([copies[3]], 0, shift, 0)
            save(name)
        gmsh.clear()
        cup = occ.addCylinder(0, 0, 0, 0, 0, 60, 50)
        occ.fillet([cup], edges(lambda ends: ends[5] < 1e-3), [10])
        save("cup_punch.step")
        gmsh.clear()
        occ.addTorus(0, 0, 0, 30, 8)
        save("torus.brep")
        gmsh.clear()
        occ.addSphere(0, 0, 0, 20)
        save("sphere.brep")
    gmsh.finalize()


def test_cad(tmp_path, program):
    """Check CAD files against closed forms."""
    make_cad(tmp_path)
    bez = tmp_path / "cad.bez"
    for name, words in (("punch.step", "left out: 1 face"), ("punch.igs", "sewn: "), ("doubled.brep", "doubled faces"),
                        ("loose.brep", "sewn: ")):
        said = convert(tmp_path / name, bez, "--toward", 0, 0, -1)
        assert words in said, said
        net = read(bez)
        point, normal = points_of(net, 5)
        distance = box_distance(point, (35, 25), 10, 5, "punch")
        inner = (point[..., 2] < 35)
        assert np.abs(distance[inner]).max() < 0.002 and not len(folded(net)), (name, said)
        ahead = box_distance(point + 1e-3 * normal, (35, 25), 10, 5, "punch")
        assert (ahead - distance)[inner].min() > 0.99e-3, name
    check_program(program, bez, "z_max", 2)
    assert "metres --scale 1000" not in convert(tmp_path / "metres.step")
    convert(tmp_path / "punch.step", bez, "--toward", 0, 0, -1, "--offset", 1, "--turn")
    point, normal = points_of(read(bez), 5)
    inner = (point[..., 2] < 35)
    assert np.abs(box_distance(point, (35, 25), 10, 5, "punch") - 1)[inner].max() < 0.002
    assert normal[np.abs(point[..., 2] + 1) < 1e-6][:, 2].min() > 0.999
    assert "--sew 0.15 joins them" in convert(tmp_path / "shifted.brep", bez, expect=2)
    for name, distance in (("torus", lambda x: np.hypot(np.hypot(x[..., 0], x[..., 1]) - 30, x[..., 2]) - 8),
                           ("sphere", lambda x: np.linalg.norm(x, axis=2) - 20)):
        convert(tmp_path / f"{name}.brep", bez)
        assert np.abs(distance(points_of(read(bez), 5)[0])).max() < 0.002, name
    # The fillet of a round punch closes in itself.
    convert(tmp_path / "cup_punch.step", bez, "--toward", 0, 0, -1)
    point = points_of(read(bez), 5)[0]
    r, z = np.hypot(point[..., 0], point[..., 1]), point[..., 2]
    miss = np.where(z > 10, r - 50, np.where(r < 40, -z, np.hypot(r - 40, z - 10) - 10))
    assert np.abs(miss).max() < 0.002 and r.max() > 49.99 and z.max() > 59.7  # points lie within the patches
    assert "no part '9'; there are 1 " in convert(tmp_path / "punch.step", "--part", "9", expect=2)
    with mock.patch.object(cad_mesh, "MOST_PATCHES", 1):  # of a face, which is then not divided further
        assert "farther than" in convert(tmp_path / "punch.step", "--tolerance", 1e-5, expect=2)
    for name in ("text.step", "text.igs", "text.brep"):
        (tmp_path / name).write_text("no tool\n")
        convert(tmp_path / name, bez, expect=2)


def check_box_tools(folder, program, deck, tools):
    """Check tools made from the STEP files of a part: half size, radii in plan and of the profile, height of the face
    of each; and that the program takes them without a near miss."""
    done = subprocess.run([sys.executable, deck.with_name("step_files.py"), folder], capture_output=True, text=True,
                          check=True)
    assert not done.stdout + done.stderr, done
    for kind, (half, corner, radius, face) in tools.items():
        convert(folder / f"{kind}.step", folder / f"{kind}.bez", "--toward", 0, 0, 1 if kind == "die" else -1)
        point = points_of(read(folder / f"{kind}.bez"), 5)[0] - (0, 0, face)
        if kind == "holder":  # a die upside down
            point[..., 2] *= -1
        near = (np.abs(point[..., 2]) < 15) & (np.abs(point[..., :2]).max(axis=2) < 105)
        shape = "punch" if kind == "punch" else "die"
        distance = np.abs(box_distance(point, (half, half), corner, radius, shape))[near].max()
        assert distance < 0.002, (kind, distance)
    check_taken(folder, program, deck)


def check_taken(folder, program, deck):
    """Check that the program takes the three tools of a folder without a near miss."""
    done = subprocess.run([program, "--check", "--set", f"tools={folder}", deck], capture_output=True, text=True,
                          check=False)
    assert done.returncode == 0 and done.stdout.count(" 0 near misses, 0 T-junctions") == 3, done.stdout + done.stderr


def test_examples(tmp_path, program):
    """Check the tools of the parts made from their STEP files, which have the places of the input files."""
    parts = ROOT / "input_files"
    check_box_tools(tmp_path, program, parts / "square_cup" / "square_cup.dat",
                    {"punch": (35, 10, 8, 0.78), "holder": (37, 12, 0, 0.78), "die": (37, 12, 5, 0)})
    check_box_tools(tmp_path, program, parts / "round_cup" / "round_cup.dat",
                    {"punch": (48.73, 48.73, 12.7, 1.6), "holder": (50.74, 50.74, 0, 1.6),
                     "die": (50.74, 50.74, 12.7, 0)})
    rail = parts / "rail"
    subprocess.run([sys.executable, rail / "step_files.py", tmp_path], capture_output=True, text=True, check=True)
    for kind in ("punch", "holder", "die"):
        convert(tmp_path / f"{kind}.step", tmp_path / f"{kind}.bez", "--toward", 0, 0, 1 if kind == "die" else -1)
    check_taken(tmp_path, program, rail / "rail.dat")
    for path, tolerance in ((tmp_path, 0.002), (rail, 1e-9)):
        x, y, z = points_of(read(path / "die.bez"), 5)[0].reshape(-1, 3).T
        across = np.hypot(x - np.sign(x) * 37.5, y + np.sign(x) * 75 * np.cos(np.pi / 6)) - 75
        wall = (z < -5.01) & (np.abs(x) > 10) & (np.abs(x) < 37)
        assert wall.any() and np.abs(np.abs(across) - 16)[wall].max() < tolerance, path


def test_messages(tmp_path):
    """Check what is said of files that are no sources."""
    (tmp_path / "empty.step").write_text("")
    (tmp_path / "part.xyz").write_text("x")
    for words, said in (((tmp_path / "none.step",), "no such file"), ((tmp_path,), "not a file"),
                        ((tmp_path / "empty.step",), "the file is empty"),
                        ((tmp_path / "part.xyz",), "unknown kind of file")):
        assert said in convert(*words, expect=2)


def test_slow_division(monkeypatch):
    """Check that few meshes are made of a spline surface whose distance falls slowly with its division."""
    made, once = [], cad_mesh.mesh_once
    monkeypatch.setattr(cad_mesh, "mesh_once", lambda *given: made.append(1) or once(*given))
    with session() as model, cad_file.silence():
        x = np.linspace(-90, 90, 7)
        points = [gmsh.model.occ.addPoint(a, b, 6 * (a / 60)**2 + 4 * (b / 60)**2) for b in x for a in x]
        one = cad_mesh.Model(tags=[gmsh.model.occ.addBSplineSurface(points, 7)], names=["face"])
        gmsh.model.occ.synchronize()
        cad_mesh.mesh_within(model, Path("part"), one, 0.001, np.inf, lambda fraction: None)
    assert one.distance.max() < 0.001 and len(made) < 5, (len(made), len(one.nodes))


def test_known_distances():
    """Check that only faces are measured again whose patches have changed."""
    with session() as model:
        tag = model.model.occ.addDisk(0, 0, 0, 2, 1)
        model.model.occ.synchronize()
        x, y = np.meshgrid([0.0, 0.5, 1.0], [0.0, 0.5, 1.0])
        nodes = np.stack([x, y, 0 * x + 0.01], axis=2)[None]
        part = cad_mesh.Model(nodes=nodes, uv=nodes[..., :2].copy(), face=np.zeros(1, int), tags=[tag])
        known = {}
        assert np.allclose(cad_mesh.distances(model, part, surfaces.from_nodes(nodes), known=known), 0.01)
        with mock.patch.object(cad_mesh, "closest", side_effect=AssertionError):
            assert np.allclose(cad_mesh.distances(model, part, surfaces.from_nodes(nodes), known=known), 0.01)
        assert np.allclose(cad_mesh.distances(model, part, surfaces.from_nodes(nodes + [0, 0, 0.01]), known=known), 0.02)
