# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts with holes, notches and lanced forms: their closed sides and their tools against those of the same part made
without any."""

from itertools import pairwise

import gmsh
import numpy as np
import part_set
import pytest
from closed_set import PAIRS, largest_distance, occ, surface_of, upper, whole_bend, write
from helpers import call
from test_tool_surfaces import points_of, read

from dd3.curve import read_curves
from dd3.gmsh_session import session
from dd3.part import corners
from dd3.part.bends import find_bends
from dd3.part.closed import closed_part, why
from dd3.part.openings import Opening
from dd3.part.reading import Request, read_part
from dd3.part.table import summary
from dd3.tools.cad_file import silence
from dd3.tools.cad_mesh import Model, overlapping
from dd3.tools.cut import is_closed, of_axes, planes_through
from dd3.tools.division import Division
from dd3.tools.patch_distance import Distance

SLOW = ("slotted", "folded_cover", "notched_flange", "collar", "whole_bend")  # of the pairs


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Write the parts."""
    folder = tmp_path_factory.mktemp("closed")
    write(folder)
    return folder


@pytest.mark.parametrize("name", [pytest.param(name, marks=pytest.mark.slow if name in SLOW else ()) for name in PAIRS])
def test_side(folder, name):
    """Check that the upper side is that of the part without openings."""
    reading, closed, area, rims = upper(folder, name)
    _, none, plain, plain_rims = upper(folder, f"{name}_plain")
    assert (none is None or not none.openings) and not reading.faults
    assert len(closed.openings) == PAIRS[name][1]
    assert abs(area / plain - 1) < 1e-6 and rims == plain_rims, (area, plain, rims, plain_rims)


@pytest.mark.parametrize("name", ["tray", *(pytest.param(name, marks=pytest.mark.slow)
                                           for name in ("u_section", "cup", "slotted", "notched_lid"))])
def test_tools(folder, tmp_path, name):
    """Check the tools against those of the part without openings."""
    said = call("tool", folder / f"{name}.step", tmp_path / "own", "--flange", 20)
    assert "filled: " in said, said
    call("tool", folder / f"{name}_plain.step", tmp_path / "plain", "--flange", 20)
    for tool in ("punch", "die"):
        assert largest_distance(tmp_path / "own", tmp_path / "plain", tool) < 0.01
        assert largest_distance(tmp_path / "plain", tmp_path / "own", tool) < 0.01
    assert len(read_curves(tmp_path / "plain" / "trim.txt")) == 1


def test_curves(folder, tmp_path):
    """Check the true rims of a tray with a hole in its wall, where the punch ends, also of a part that is turned."""
    said = call("tool", folder / "tray.step", tmp_path, "--rotate", 0, 0, 1, 30, "--move", 5, 0, 3, "--flange", 20)
    curves = read_curves(tmp_path / "trim.txt")
    deck = (tmp_path / "trim.dat").read_text()
    assert len(curves) == 2 and 'file = "trim.txt"' in deck and "from = draw.out/draw " in deck
    assert "  keep = on\n\n*PHASE springback" in (tmp_path / "draw.dat").read_text()
    punch = read(tmp_path / "punch.bez")
    punch[..., 2] -= punch[..., 3] * float(said.split("travel")[1].split()[0])
    for curve in curves:
        assert np.linalg.norm(Distance(punch, 1.0).nearest(curve)[0] - curve, axis=1).max() < 0.01
    centre = (curves[1].min(axis=0) + curves[1].max(axis=0)) / 2
    assert np.abs(np.linalg.norm(curves[1] - centre, axis=1) - 3).max() < 1e-3
    assert np.abs(centre[:2] - (39 * np.array([np.cos(np.pi / 6), 0.5]) + [5, 0])).max() < 1e-3


def test_refusal(tmp_path):
    """Check that a hole of a surface that cuts a radius into two is named, with its edges in the picture."""
    with session(), silence():
        surface_of(whole_bend)()
        occ.synchronize()
        gmsh.write(str(tmp_path / "part.step"))
    said = call("tool", tmp_path / "part.step", tmp_path / "tools", "--thickness", 1, expect=2)
    assert "is not filled, as faces end there" in said and "at x y z = 36.32 0 4.634 in faces 4 12-13 18" in said, said
    assert (tmp_path / "tools" / "part.png").exists() and not (tmp_path / "tools" / "punch.bez").exists()


def test_folded(tmp_path):
    """Check that what is cut before it is bent is said so: a web behind a relief, and an open corner."""
    paths = part_set.write(tmp_path, ["relieved_angle", "folded_cover"])
    said = call("tool", paths["relieved_angle"], tmp_path / "tools", expect=2)
    assert "in faces 8-10 is not filled, as the sheet goes on beside a bend there" in said, said
    with session() as model:
        reading = read_part(model, Request(paths["folded_cover"], toward=(0, 0, 1)))
        upper, (first, *others) = reading.direction.upper, find_bends(reading.shape, reading.direction.upper)
        across = next(one for one in others if abs(one.axis @ first.axis) < 0.5)
        corner = Opening("notch", [], [*first.faces, *across.faces], np.zeros(3), 1.0, notch=True)
        assert "bent along lines in different directions" in why(reading.shape, upper, corner)


@pytest.mark.parametrize("radius", [3, *(pytest.param(radius, marks=pytest.mark.slow) for radius in (5, 0))])  # with 5 mm the floor ends at the corner in a point
def test_open_corners(tmp_path, radius):
    """Check that walls and bends of a folded cover go on round its open corners in the tools, by the largest radius
    that leaves the walls as they are, at one distance from each other; and that the rim of the part lies on them."""
    path = tmp_path / "cover.step"
    made(path, lambda: part_set.folded_cover(radius=radius))
    said = call("tool", path, tmp_path / "tools", "--clearance", 0.1)
    assert "closed: 4 open corners between walls, rounded by 4 and 5 mm between these" in said, said
    punch, die = (read(tmp_path / "tools" / f"{name}.bez") for name in ("punch", "die"))
    punch[..., 2] -= punch[..., 3] * float(said.split("travel")[1].split()[0])
    curve, = read_curves(tmp_path / "tools" / "trim.txt")
    if radius:  # sharp edges are rounded
        assert np.linalg.norm(Distance(punch, 1.0).nearest(curve)[0] - curve, axis=1).max() < 0.01
    points = points_of(punch, 5)[0].reshape(-1, 3)
    corner = points[(points[:, :2] > (35, 25)).all(axis=1)]
    away = np.linalg.norm(corner[:, :2] - (35, 25), axis=1)
    assert away.max() < 4.01 and away[corner[:, 2] > corner[:, 2].max() - 1].min() > 3.99
    below = corner[corner[:, 2] < -7]
    gap = np.linalg.norm(Distance(die, 4.0).nearest(below)[0] - below, axis=1)
    assert np.abs(gap - 1.1).max() < 0.01, (gap.min(), gap.max())


def relieved_cover(kind):
    """Make a folded cover with reliefs in floor, bends and walls at its open corners: round ones, with a small gap
    between the walls, square ones, or a slot at the end of two walls each."""
    cut, size = ((38.5, 28.5), 2) if kind == "round" else ((35, 25), 6)
    body = part_set.pocket((40, 30), 15, 1, 0, 3)
    cuts = [(3, occ.addBox(x, y, -1, size, size, 20)) for x in (cut[0], -cut[0] - size)
            for y in (cut[1], -cut[1] - size)]
    relief = {"round": lambda x, y: occ.addCylinder(37 * x, 27 * y, -1, 0, 0, 5, 3.2),
              "square": lambda x, y: occ.addBox(37 * x - 4, 27 * y - 4, -1, 8, 8, 5),
              "slot": lambda x, y: occ.addBox(34.25 * x - 0.75, 26.5 * y - 4.5, -1, 1.5, 9, 6)}[kind]
    cuts += [(3, relief(x, y)) for x in (-1, 1) for y in (-1, 1)]
    occ.cut(body, cuts)


@pytest.mark.parametrize(("kind", "radius"), [
    ("round", "2 and 3"), *(pytest.param(kind, "4 and 5", marks=pytest.mark.slow) for kind in ("square", "slot"))])
def test_reliefs(tmp_path, kind, radius):
    """Check that open corners with reliefs are listed, and closed in the tools."""
    path = tmp_path / "cover.step"
    made(path, lambda: relieved_cover(kind))
    with session() as model:
        reading = read_part(model, Request(path, toward=(0, 0, 1)))
        row, = [line for line in summary(reading) if line.split()[0] == "open"]
        assert "4 corners between walls, at x y z = " in row and row.count(";") == 3, row
        closed = closed_part(model, reading, reading.direction.upper)
        assert not reading.faults and not reading.warnings
        assert f"closed: 4 open corners between walls, rounded by {radius} mm between these" in closed.notes
        closed.load(model)
        # Floor, walls, their bends, and two faces at each corner.
        assert len(closed.taken) == 17


def test_rounded_notch(tmp_path):
    """Check that a notch is as wide as its rounded mouth, and filled, beside open corners."""
    def cover():
        part_set.folded_cover()
        occ.synchronize()
        rounded = part_set.edges(lambda b: b[1] > 28 and b[4] - b[1] < 1.1 and b[3] - b[0] < 1e-3 and b[5] - b[2] < 1e-3
                                 and 4.9 < abs(b[0]) < 5.1)
        assert len(rounded) == 4, rounded
        occ.fillet([occ.getEntities(3)[0][1]], rounded, [1.5])

    made(tmp_path / "cover.step", cover)
    with session() as model:
        reading = read_part(model, Request(tmp_path / "cover.step", toward=(0, 0, 1)))
        notch, = reading.notches
        assert (notch.width, notch.depth) == (pytest.approx(13), pytest.approx(6))
        closed = closed_part(model, reading, reading.direction.upper)
        assert not reading.faults and not reading.warnings
        assert closed.notes[0] == "filled: notch 13 x 6" and "closed: 4 open corners" in closed.notes[1], closed.notes


def test_corners_left_open(folder, tmp_path, monkeypatch):
    """Check that corners that stay open are told, of a solid that OpenCASCADE does not close and of a surface."""
    def fails(*_):
        raise RuntimeError

    monkeypatch.setattr(corners, "closed_solid", fails)
    reading, _, area, _ = upper(folder, "folded_cover_plain")
    assert "open corners of the part, at x y z = " in reading.warnings[-1] and "OpenCASCADE" in reading.warnings[-1]
    assert area == pytest.approx(sum(reading.shape.areas[tag] for tag in reading.direction.upper))
    made(tmp_path / "cover.step", surface_of(part_set.folded_cover))
    with session() as model:
        reading = read_part(model, Request(tmp_path / "cover.step", toward=(0, 0, 1)))
        closed_part(model, reading, reading.direction.upper)
    assert "as the part is a surface" in reading.warnings[-1], reading.warnings


def test_turned_cuts():
    """Check that planes that cut faces which close in themselves go through their axis and their seam, however the part
    lies, and that faces with one axis have the same planes."""
    axis, place = np.array([2, -3, 6]) / 7, np.array([120.0, -40.0, 33.0])
    with session() as gmsh:
        gmsh.model.occ.addCone(*place, *(20 * axis), 30, 40)
        gmsh.model.occ.addCylinder(*(place + 20 * axis), *(9 * axis), 40)
        gmsh.model.occ.synchronize()
        closed = [tag for _, tag in gmsh.model.getEntities(2) if is_closed(gmsh, tag)]
        planes = [planes_through(gmsh, tag) for tag in closed]
        seam = np.array(gmsh.model.getValue(0, gmsh.model.getBoundary([(2, closed[0])], recursive=True)[0][1], []))
    assert len(closed) == 2 and len(of_axes(planes, 100.0)) == 2
    for pair in planes:
        assert max(max(abs(normal @ axis), abs((place - point) @ normal)) for point, normal in pair) < 1e-9
    assert min(abs((seam - point) @ normal) for point, normal in planes[0]) < 1e-9


def test_divided_sides():
    """Check that a curved face whose opposite sides have two edges each, which go on smoothly, has a regular mesh, but
    not if they are divided at other places or one of them alone."""
    with session() as gmsh:
        for second, whole in ((60.0, True), (120.0, False), (None, False)):
            gmsh.clear()
            lines = []
            for x, row in ((0, [30, 60, 150]), (40, [30, *([second] if second else []), 150])):
                points = [gmsh.model.occ.addPoint(x, *(10 * np.array([np.cos(a), np.sin(a)]))) for a in np.radians(row)]
                middle = gmsh.model.occ.addPoint(x, 0, 0)
                lines.append((points, [gmsh.model.occ.addCircleArc(a, middle, b) for a, b in pairwise(points)]))
            (low, near), (high, far) = lines
            ends = [gmsh.model.occ.addLine(low[i], high[i]) for i in (0, -1)]
            gmsh.model.occ.addSurfaceFilling(gmsh.model.occ.addWire([*near, ends[1], *far[::-1], ends[0]]))
            gmsh.model.occ.synchronize()
            assert bool(Division(gmsh, [gmsh.model.getEntities(2)[0][1]]).regular) == whole, second


def test_overlapping():
    """Check that a face is found of whose patches one lies upon another."""
    with session() as model:
        tag = model.model.occ.addRectangle(0, 0, 0, 2, 1)
        model.model.occ.synchronize()
        x, y = np.meshgrid([0.0, 0.5, 1.0], [0.0, 0.5, 1.0])
        patch = np.stack([x, y, 0 * x], axis=2)
        nodes = np.array([patch, patch + [1, 0, 0]])
        part = Model(nodes=nodes, uv=nodes[..., :2].copy(), face=np.zeros(2, int), tags=[tag])
        assert not overlapping(model, part)
        part.nodes[1] = part.nodes[1][:, ::-1]
        assert overlapping(model, part) == {0}


def made(path, maker):
    """Write a part that a procedure makes."""
    with session(), silence():
        maker()
        occ.synchronize()
        gmsh.write(str(path))


def clip(opened):
    """Make a clip: a hat with feet, on request with openings that cut a shoulder, its wall and its foot at once."""
    body = part_set.strip([(-25, 12), (-10, 12), (-10, 0), (10, 0), (10, 12), (25, 12)], 0.8, 1.2, 30)
    if opened:
        part_set.holes(body, [(0, 12, 13), (0, -12, 13)], radius=4, length=14)


def test_profile(tmp_path):
    """Check that a part bent along parallel lines is its profile, wherever its openings are, and that the blank covers
    its ends."""
    made(tmp_path / "clip.step", lambda: clip(True))
    made(tmp_path / "clip_plain.step", lambda: clip(False))
    reading, closed, area, rims = upper(tmp_path, "clip")
    _, _, plain, plain_rims = upper(tmp_path, "clip_plain")
    assert not reading.faults and len(closed.openings) == 2 and len(closed.curves) == 3
    assert abs(area / plain - 1) < 1e-9 and rims == plain_rims
    said = call("tool", tmp_path / "clip.step", tmp_path / "tools")
    assert "profile of the bent part" in said and "filled: 2 x opening" in said, said
    assert float(said.split("  blank ")[1].split(" x ")[0]) > 30.0, said


def test_legs(tmp_path):
    """Check tools of an angle with legs of different lengths as it lies, upside down, and as a V."""
    made(tmp_path / "part.step", lambda: part_set.strip([(0, 17), (0, 0), (54, 0)], 1.2, 0.8, 60))
    assert "  pad " in call("tool", tmp_path / "part.step", tmp_path / "tools")
    said = call("tool", tmp_path / "part.step", tmp_path / "turned", "--rotate", 1, 0, 0, 180, expect=2)
    assert "the part is open towards" in said, said
    said = call("tool", tmp_path / "part.step", tmp_path / "v", "--toward", 0, 0.5, 0.866)
    assert "walls      continued" in said and "own flange" not in said, said
