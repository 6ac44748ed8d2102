# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of tools that users break: each is converted right or refused by a sentence, and never ends in a traceback."""

import os
import subprocess
import sys
from itertools import pairwise
from unittest import mock

import gmsh
import numpy as np
import pytest
from scipy.spatial import Delaunay, cKDTree
from test_tool_surfaces import MESHES, box_distance, convert, die_triangles, make_cad, points_of, read, write_stl

from dd3.tools import cad_file, nagata

SIDE = (35, 25)


def largest_distance(bez):
    """Return the largest distance of a surface from the die of the tests, mm."""
    return np.abs(box_distance(points_of(read(bez))[0], SIDE, 10, 5, "die")).max()


def run_tool(*words):
    """Run the tool in a process of its own; return what it says."""
    done = subprocess.run([sys.executable, "-m", "dd3", "tool", *words], capture_output=True, text=True,
                          errors="replace", check=False)
    assert done.returncode in (0, 2) and "Traceback" not in done.stderr, (words, done)
    return done.stdout + done.stderr


def with_nodes(triangles, count):
    """Return triangles whose second edge is divided by nodes: of every other one in the plane of the die."""
    result = []
    for number, corners in enumerate(triangles):
        if np.ptp(corners[:, 2]) > 1e-9 or number % 2:
            result.append(corners)
            continue
        one, two, three = corners
        place = [two + (three - two) * k / (count + 1) for k in range(count + 2)]
        result += [np.array([a, b, one]) for a, b in pairwise(place)]
    return np.array(result)


def test_nodes_in_edges(tmp_path):
    """Check that facets with nodes of others inside their edges are divided: the same surface as without."""
    good = die_triangles(10)
    for count in (1, 2, 5):
        write_stl(tmp_path / "die.stl", with_nodes(good, count))
        said = convert(tmp_path / "die.stl", tmp_path / "die.bez", "--toward", 0, 0, 1)
        assert "nodes inserted into edges of other facets" in said and "1 body" in said, said
        assert largest_distance(tmp_path / "die.bez") < 0.002, said


def test_numbers(tmp_path):
    """Check STL files with wrong numbers, and with few facets."""
    good = die_triangles(15)
    stl, bez = tmp_path / "numbers.stl", tmp_path / "numbers.bez"
    spoiled = [good.copy() for _ in range(3)]
    for triangles, value in zip(spoiled, (np.nan, np.inf, 1e30)):
        triangles[3, 1, 1] = value
    for triangles, code, words in (
            (spoiled[0], 2, "not a number"), (spoiled[1], 2, "not a number"),
            (spoiled[2], 2, "expected at most 1e+09 mm"), (1e30 * good, 2, "expected at most 1e+09 mm"),
            (1e-30 * good, 0, "warning: "), (good[:1], 0, "6 free"),
            (0 * good, 2, "at one point"), (good * [1, 0, 0], 2, "on one line")):
        write_stl(stl, triangles)
        said = convert(stl, bez, expect=code)
        assert words in said, said


def test_stl_files(tmp_path):
    """Check STL files that are cut off, of other kinds, or have unusual names and text."""
    stl, bez = tmp_path / "file.stl", tmp_path / "file.bez"
    write_stl(stl, die_triangles(15))
    raw = stl.read_bytes()
    text = MESHES["die.stl"]
    for data, code, words in (
            (raw[:5000], 2, "cut off: 98 of 448 facets"), (raw[:-1], 2, "cut off: 447 of 448 facets"),
            (raw[:83], 2, "nor a binary STL file: 83 bytes"), (b"\0" * 500, 2, "without facets"),
            (b"solid of facets".ljust(80) + raw[80:-9], 2, "cut off: 447 of 448 facets"),
            (raw + b"tail", 0, "4 bytes: behind the 448 facets"),
            (text[:text.index("endsolid")].encode(), 2, "cut off: it ends inside solid"),
            (text.replace("endsolid", "end solid").encode(), 0, "2, turned"),
            (text.replace("endsolid", "colour 3\nENDSOLID").encode(), 0, "colour: not a keyword of STL"),
            ((text + text.replace(" 0\n", " 9\n")).encode(), 0, "2 parts"), (text.replace("endloop", "", 1).encode(), 2, "endfacet inside outer"),
            (b"solid of facets".ljust(80) + raw[80:], 0, "448"), (text[:150].encode(), 2, "expected vertex"),
            (text[:text.index("endloop")].encode(), 2, "cut off"),
            (text.replace("20 0 0", "20 zero 0", 1).encode(), 2, "expected vertex x y z"),
            (text.replace("20 0 0", "nan 0 0", 1).encode(), 2, "not a number"),
            (("\ufeff" + text).encode(), 0, "2, turned"), (text.replace("\n", "\r\n").encode(), 0, "2, turned")):
        stl.write_bytes(data)
        said = convert(stl, bez, expect=code)
        assert words in said, said
    odd = tmp_path / "dié ö 1.STL"
    odd.write_bytes(raw)
    convert(odd, tmp_path / "dié ö 1.bez")
    assert largest_distance(tmp_path / "dié ö 1.bez") < 0.006


def test_dyna_solids(tmp_path):
    """Check solids of LS-DYNA on one line each and on two, a wedge of both orders, and thick shells: one block."""
    nodes = [(x, y, z) for z in (0, 10) for x, y in ((0, 0), (20, 0), (20, 10), (0, 10), (40, 0), (40, 10))]
    first, second = (1, 2, 3, 4, 7, 8, 9, 10), (2, 5, 6, 3, 8, 11, 12, 9)
    wedges = (2, 3, 9, 8, 5, 5, 11, 11), (3, 6, 6, 3, 9, 12, 12, 9), (5, 6, 3, 3, 11, 12, 9, 9)
    for keyword, solids in (("*ELEMENT_SOLID", (first, second)), ("*ELEMENT_TSHELL", (first, second)),
                            ("*ELEMENT_SOLID", (first, wedges[0], wedges[2]))):
        for between in ("", "\n"):
            text = "*KEYWORD\n*NODE\n" + "".join(f"{number:8d}{x:16.1f}{y:16.1f}{z:16.1f}\n"
                                                for number, (x, y, z) in enumerate(nodes, 1)) + keyword + "\n"
            for number, corners in enumerate(solids, 1):
                text += f"{number:8d}{7:8d}{between}" + "".join(f"{corner:8d}" for corner in corners) + "\n"
            (tmp_path / "block.k").write_text(text + "*END\n")
            said = convert(tmp_path / "block.k", tmp_path / "block.bez", "--rotate", 0, 0, 1, 90, "--move", 0, 0, 5)
            assert "x -10 to 0, y 0 to 40, z 5 to 15" in said and "0 free, 0 of more" in said, said


def test_straightened(tmp_path):
    """Check that the edges of facets whose patches would fold are kept straight: waves in few random triangles."""
    place = np.random.default_rng(0).random((60, 2)) * 20
    place = np.concatenate([place, [[0, 0], [20, 0], [0, 20], [20, 20]]])
    height = 2 * np.sin(place[:, 0] / 2) * np.cos(place[:, 1] / 3)
    path = tmp_path / "rough.stl"
    write_stl(path, np.column_stack([place, height])[Delaunay(place).simplices])
    assert "folds      0" in convert(path, "--tolerance", 9)
    with mock.patch.object(nagata, "MOST_PLAIN", 0):
        assert "17 folded patches" in convert(path, "--tolerance", 9, expect=2)


def test_cut_texts(tmp_path):
    """Check meshes that end anywhere, and bytes that are no text."""
    for name in ("die.inp", "die.k", "solid.inp"):
        path = tmp_path / f"cut_{name}"
        for parts in range(1, 7):
            path.write_text(MESHES[name][:len(MESHES[name]) * parts // 7])
            try:  # the part that is left may be a mesh
                convert(path, expect=2)
            except AssertionError:
                convert(path)
        path.write_text(MESHES[name].replace("10", "nan", 1))
        assert "error: " in convert(path, expect=2)
        path.write_text(MESHES[name].replace("10", "1e300", 1))
        assert "error: " in convert(path, expect=2)
    endings = ["stl", "inp", "k", "shape", "vtk", "vtu", "vtp", "ply", "obj", "msh", "step", "igs", "brep"]
    noise = np.random.default_rng(1).bytes(2000)
    for ending in endings:
        for data in (noise, b"\0" * 2000):
            path = tmp_path / f"noise.{ending}"
            path.write_bytes(data)
            # Gmsh keeps the text of its last error: another process.
            assert "error: " in (run_tool(path) if ending == "msh" else convert(path, expect=2)), path


def test_places(tmp_path):
    """Check tmp_paths and files that cannot be read or written."""
    stl = tmp_path / "place.stl"
    write_stl(stl, die_triangles(15))
    assert "No such file or directory" in convert(stl, tmp_path / "none" / "die.bez", expect=2)
    (tmp_path / "folder.bez").mkdir()
    assert "Is a directory" in convert(stl, tmp_path / "folder.bez", expect=2)
    if os.geteuid():  # root may read and write all files
        stl.chmod(0)
        assert "Permission denied" in convert(stl, expect=2)


def test_closed_pipe(tmp_path):
    """Check that the surface is written where the reader of the report has closed the pipe."""
    stl, bez = tmp_path / "pipe.stl", tmp_path / "pipe.bez"
    write_stl(stl, die_triangles(15))
    reader, writer = os.pipe()
    os.close(reader)
    with os.fdopen(writer, "w") as pipe:
        words = [sys.executable, "-m", "dd3", "tool", stl, bez]
        done = subprocess.run(words, stdout=pipe, stderr=subprocess.PIPE, text=True, check=False)
    assert bez.exists() and not done.stderr, done.stderr


def test_limits():
    """Check that a library that does not end, or ends by a fault, is reported by a sentence and exit code 2."""
    for body, code, words in (
            ("with limits.limited(0.3, 'too long'):\n while True: pass", 2, "error: too long"),
            ("with limits.limited(60, 'too long'): pass", 0, ""),
            ("limits.supervised(lambda: os.kill(os.getpid(), 11), 'a fault')", 2, "error: a fault"),
            ("limits.supervised(lambda: sys.exit(3), 'a fault')", 3, ""),
            ("sys.exit(1 if limits.started(os.getpid)() == os.getpid() else 5)", 5, ""),
            ("me = os.getpid()\nlimits.started(lambda: sys.exit(4) if os.getpid() == me else 1 / 0)()", 4, "")):
        text = f"import os, sys\nfrom dd3.tools import limits\n{body}\n"
        done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, timeout=100, check=False)
        assert (done.returncode, done.stderr.strip()) == (code, words), (body, done)


@pytest.mark.slow
def test_cut_cad(tmp_path):
    """Check CAD files that are cut off or damaged: OpenCASCADE does not end reading half a BREP text."""
    make_cad(tmp_path)
    for name in ("punch.step", "punch.igs", "loose.brep"):
        data = (tmp_path / name).read_bytes()
        path = tmp_path / f"cut_{name}"
        for parts in (2, 5):
            path.write_bytes(data[:len(data) * parts // 6])
            assert "error: " in run_tool(path), (name, parts)
    assert "1 face," in convert(tmp_path / "torus.brep", tmp_path / "torus.bez"), "a whole torus is not cut"
    cut = convert(tmp_path / "cup_punch.step", tmp_path / "cup.bez")
    assert "were cut: face 1 (Cylinder), face 2 (Torus)" in cut, cut
    odd = tmp_path / "dié ö.step"
    odd.write_bytes((tmp_path / "punch.step").read_bytes())
    assert "18 faces" in run_tool(odd)
    assert "--sew 0.015 joins them" in run_tool(tmp_path / "shifted_a_little.brep")
    assert "80 of 80 free edges" in run_tool(tmp_path / "shifted_a_little.brep", "--sew", "0.015")


def test_crown(tmp_path):
    """Check a crown that meets its axis: a curve of Bézier, revolved, with its axis oblique to the coordinates and cut
    beside it, so that the face goes around its pole and is trimmed."""
    profile = np.array([[0, 0, 0], [10, 0, 0], [20, 0, 2], [24, 0, 6]])
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    occ = gmsh.model.occ
    with cad_file.silence():
        curve = occ.addBezier([occ.addPoint(*point) for point in profile])
        occ.revolve([(1, curve)], 0, 0, 0, 0, 0, 1, 2 * np.pi)
        occ.remove([(1, curve)])
        crown = occ.getEntities(2)
        occ.cut(crown, [(3, occ.addBox(8, -50, -50, 60, 100, 100))])
        occ.rotate(occ.getEntities(2), 0, 0, 0, 1, 1, 0, 0.4)
        occ.synchronize()
        gmsh.write(str(tmp_path / "crown.step"))
    gmsh.finalize()
    said = convert(tmp_path / "crown.step", tmp_path / "crown.bez")
    assert "were cut: face 1" in said, said
    point = points_of(read(tmp_path / "crown.bez"), 5)[0].reshape(-1, 3)
    axis = np.array([np.sin(0.4), -np.sin(0.4), np.sqrt(2) * np.cos(0.4)]) / np.sqrt(2)
    height = point @ axis
    r = np.linalg.norm(point - height[:, None] * axis, axis=1)
    t = np.linspace(0, 1, 100001)
    weights = (1 - t)**3, 3 * t * (1 - t)**2, 3 * t**2 * (1 - t), t**3
    along = sum(weight * place for weight, place in zip(weights, profile[:, [0, 2], None]))
    assert cKDTree(along.T).query(np.stack([r, height], axis=1))[0].max() < 0.0021, said
