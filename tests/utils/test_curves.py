# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of DXF files: blocks, splines, units, layers, what is left out, and damaged files."""

import io
import math

import ezdxf
import numpy as np
import pytest
from helpers import call
from mutations import mutants
from scipy.interpolate import BSpline

from dd3.account import Account
from dd3.curve import joined, read_curves
from dd3.dxf import pieces_of_dxf
from dd3.errors import Problem
from dd3.gmsh_session import session

SQUARE = [(0, 0), (20, 0), (20, 10), (0, 10)]


def areas(build, tmp_path, *options, units=4):
    """Return the areas of the curves of a drawing, the largest first, and what the command says."""
    document = ezdxf.new(units=units)
    build(document, document.modelspace())
    document.saveas(tmp_path / "drawing.dxf")
    said = call("curve", tmp_path / "drawing.dxf", tmp_path / "curves.txt", *options)
    found = []
    for curve in read_curves(tmp_path / "curves.txt"):
        x, y = curve[:, 0], curve[:, 1]
        found.append(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)
    return sorted(found, reverse=True), said


def refused(build, tmp_path, *options):
    """Return what is said of a drawing that is refused."""
    document = ezdxf.new(units=4)
    build(document, document.modelspace())
    document.saveas(tmp_path / "drawing.dxf")
    return call("curve", tmp_path / "drawing.dxf", tmp_path / "curves.txt", *options, expect=2)


def test_plate(tmp_path):
    """Check holes that are references of a block: 60 x 40 mm without three circles of radius 3 mm."""
    def plate(document, space):
        document.blocks.new("HOLE").add_circle((0, 0), 3)
        space.add_lwpolyline([(0, 0), (60, 0), (60, 40), (0, 40)], close=True)
        for place in ((10, 10), (50, 10), (30, 30)):
            space.add_blockref("HOLE", place)
    found, said = areas(plate, tmp_path, "--chord", 1e-3)
    assert len(found) == 4 and abs(found[0] - sum(found[1:]) - 2315.18) < 0.05 and "left out" not in said


def test_blocks(tmp_path):
    """Check references that are scaled, turned, mirrored, nested, in columns and rows, and of a base point."""
    def half(document):
        block = document.blocks.new("HALF", base_point=(2, 0))
        block.add_lwpolyline([(2, 0, 0, 0, 1), (6, 0)], format="xyseb", close=True)  # half a disc of radius 2 below
        return block

    def nested(document, space):
        half(document)
        pair = document.blocks.new("PAIR")
        pair.add_blockref("HALF", (0, 0), dxfattribs={"rotation": 45, "xscale": -1})
        pair.add_blockref("HALF", (20, 0))
        space.add_blockref("PAIR", (7, 8), dxfattribs={"xscale": 2, "yscale": 3, "rotation": 20})
    found, _ = areas(nested, tmp_path, "--chord", 1e-4)
    assert np.allclose(found, 6 * 2 * math.pi, rtol=1e-4)

    def rows(document, space):
        half(document)
        space.add_blockref("HALF", (5, 5), dxfattribs={"column_count": 3, "row_count": 2, "column_spacing": 10,
                                                       "row_spacing": 5, "rotation": 90})
    found, said = areas(rows, tmp_path)
    low = [min(float(word) for word in line.split(" x ")[1].split(",")[0].split(" to ")) for line in said.splitlines()]
    assert len(found) == 6 and sorted(np.round(low, 3)) == [0, 0, 0, 5, 5, 5]
    said = refused(lambda document, space: (document.blocks.new("A").add_blockref("A", (1, 1)),
                                            space.add_blockref("A", (0, 0))), tmp_path)
    assert "block A contains itself" in said

    def missing(document, space):
        space.add_blockref("NONE", (0, 0))
        space.add_circle((0, 0), 1)
    assert "INSERT on layer 0: there is no block NONE" in areas(missing, tmp_path)[1]


def test_splines(tmp_path):
    """Check closed splines: periodic ones with and without their repeated points, of fit points, and a rational circle."""
    corners = [(10 * math.cos(t), 10 * math.sin(t), 0) for t in np.linspace(0, 2 * math.pi, 9)[:-1]]

    def spline(closed=1, degree=3, **fields):
        def build(_, space):
            found = space.add_spline()
            found.dxf.flags, found.dxf.degree = closed, degree
            for name, values in fields.items():
                setattr(found, name, values)
        return build
    whole = areas(lambda _, space: space.add_spline().set_closed(corners), tmp_path)[0]
    # The cubic of equal steps through the sums of three neighbours, weights 1/6, 4/6, 1/6, in polar form.
    assert 0.5 * 8 * 10**2 * math.sin(math.pi / 4) * (4 / 6 + 2 / 6 * math.cos(math.pi / 4))**2 < whole[0] < math.pi * 100
    for knots in ([], list(range(12)), list(range(15))):
        assert np.allclose(areas(spline(control_points=corners, knots=knots), tmp_path)[0], whole)
    assert np.allclose(areas(spline(control_points=corners + corners[:3], knots=list(range(15))), tmp_path)[0], whole)
    assert np.allclose(areas(spline(fit_points=corners), tmp_path, "--chord", 1e-4)[0], 100 * math.pi, rtol=2e-3)
    circle = {"control_points": [(2, 0), (2, 2), (0, 2), (-2, 2), (-2, 0), (-2, -2), (0, -2), (2, -2), (2, 0)],
              "weights": [1, 0.5**0.5] * 4 + [1], "knots": [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]}
    for closed in (0, 1):
        assert np.allclose(areas(spline(closed, 2, **circle), tmp_path, "--chord", 1e-5)[0], 4 * math.pi, rtol=1e-4)
    assert "not closed" in refused(spline(0, control_points=corners, knots=[0] * 4 + [1, 2, 3, 4] + [5] * 4), tmp_path)
    assert "whose weights are not positive" in refused(spline(0, 2, **{**circle, "weights": [0.0] * 9}), tmp_path)
    assert "knots" in refused(spline(0, 2, **{**circle, "knots": [0, 0, 0, 1]}), tmp_path)


def test_units_and_layers(tmp_path):
    """Check inches, a file without a unit, and layers: what is on layer 0 of a block is on that of its reference."""
    square = lambda _, space: space.add_lwpolyline(SQUARE, close=True)  # noqa: E731
    assert np.allclose(areas(square, tmp_path, units=1)[0], 200 * 25.4**2)
    found, said = areas(square, tmp_path, units=0)
    assert np.allclose(found, 200) and "unit: $INSUNITS names none: lengths are taken as mm" in said

    def layers(document, space):
        block = document.blocks.new("HOLE")
        block.add_circle((0, 0), 3)
        block.add_circle((0, 0), 1, dxfattribs={"layer": "CORE"})
        space.add_blockref("HOLE", (5, 5), dxfattribs={"layer": "TRIM"})
        space.add_lwpolyline(SQUARE, close=True, dxfattribs={"layer": "OTHER"})
    found, said = areas(layers, tmp_path, "--layer", "TRIM", "--chord", 1e-4)
    assert np.allclose(found, 9 * math.pi, rtol=1e-4)
    assert "CIRCLE on layer CORE of block HOLE: not on layer TRIM" in said and "LWPOLYLINE on layer OTHER" in said
    assert np.allclose(areas(layers, tmp_path, "--layer", "CORE", "--chord", 1e-5)[0], math.pi, rtol=1e-4)

    def invisible(document, space):
        document.layers.add("OFF").off()
        document.layers.add("COLD").freeze()
        space.add_lwpolyline(SQUARE, close=True)
        for layer in ("OFF", "COLD"):
            space.add_circle((5, 5), 2, dxfattribs={"layer": layer})
    found, said = areas(invisible, tmp_path)
    assert np.allclose(found, 200)
    for layer in ("OFF", "COLD"):
        assert f"CIRCLE on layer {layer}: layer {layer} is not visible in the drawing; --layer takes it" in said
        assert np.allclose(areas(invisible, tmp_path, "--layer", layer, "--chord", 1e-4)[0], 4 * math.pi, rtol=1e-4)
    large = areas(lambda _, space: space.add_circle((0, 0), 500), tmp_path, "--chord", 1e-4)[0]
    assert np.allclose(large, math.pi * 500**2, rtol=1e-6)


def test_left_out(tmp_path):
    """Check that each entity that is no curve is named with its line, also in blocks and in the paper space."""
    def drawing(document, space):
        block = document.blocks.new("HOLE")
        block.add_circle((0, 0), 3)
        block.add_attdef("NAME", (0, 0))
        space.add_blockref("HOLE", (5, 5)).add_attrib("NAME", "3", (5, 5))
        document.blocks.new("UNUSED").add_circle((0, 0), 1)
        for add in (lambda: space.add_text("x"), lambda: space.add_mtext("x"), lambda: space.add_point((0, 0)),
                    lambda: space.add_hatch(), lambda: space.add_3dface([(0, 0), (1, 0), (1, 1), (0, 1)]),
                    lambda: space.add_linear_dim(base=(0, 9), p1=(0, 0), p2=(5, 0)).render(),
                    lambda: space.add_polyface(), lambda: space.new_entity("ACAD_PROXY_ENTITY", {})):
            add()
        document.layout("Layout1").add_circle((0, 0), 1)
    found, said = areas(drawing, tmp_path)
    lines = (tmp_path / "drawing.dxf").read_text().splitlines()
    assert len(found) == 1
    for name in ("ATTDEF", "ATTRIB", "TEXT", "MTEXT", "POINT", "HATCH", "3DFACE", "DIMENSION", "POLYLINE", "CIRCLE"):
        (item,) = (line for line in said.splitlines() if f": {name} on layer" in line)
        place = int(item.removeprefix("left out: ").split(": ")[0].rpartition(":")[2])
        assert lines[place - 1].strip() == name, item
    assert "BLOCK UNUSED: no entity that is read inserts it" in said and "CIRCLE on layer 0 of layout Layout1" in said
    assert "no curve" in refused(lambda _, space: space.add_text("x"), tmp_path)


@pytest.mark.parametrize("solid", [False, True])
def test_control_frame(tmp_path, solid):
    """Check that the control frame of a fitted polyline, flag 16 of its vertices, is no part of the curve."""
    frame = np.array([(0, 0), (20, 60), (80, 60), (100, 0)], float)
    t = np.linspace(0, 1, 41)[:, None]
    cubic = (1 - t)**3 * frame[0] + 3 * t * (1 - t)**2 * frame[1] + 3 * t**2 * (1 - t) * frame[2] + t**3 * frame[3]

    def build(_, space):
        line = space.add_polyline3d([]) if solid else space.add_polyline2d([])
        line.dxf.flags |= 4
        for points, flag in ((frame, 16), (cubic, 8)):
            line.append_vertices([(x, y, 0) for x, y in points], dxfattribs={"flags": flag | 32 * solid})
        space.add_line((100, 0), (0, 0))
    x, y = cubic.T  # 3240 below the curve, less by the 40 chords of the file
    assert np.allclose(areas(build, tmp_path)[0], abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2, rtol=1e-6)


def spline_over_box(control, degree):
    """Return what draws a spline with clamped knots of equal steps over three lines to y = -50."""
    def build(_, space):
        knots = np.concatenate([np.zeros(degree), np.arange(len(control) - degree + 1.0),
                                np.full(degree, len(control) - degree)])
        spline = space.add_spline(degree=degree)
        spline.control_points, spline.knots = [(x, y, 0) for x, y in control], list(knots)
        corners = [control[-1], (100, -50), (0, -50), control[0]]
        for start, end in zip(corners, corners[1:]):
            space.add_line(start, end)
    return build


def area_below(control, degree):
    """Return the area between a spline with clamped knots of equal steps and y = -50, by its derivative."""
    inner = np.arange(len(control) - degree + 1.0)
    curve = BSpline(np.concatenate([np.zeros(degree), inner, np.full(degree, inner[-1])]), np.array(control), degree)
    x, w = np.polynomial.legendre.leggauss(8)
    t = (inner[:-1, None] + 0.5 * (x + 1)).ravel()
    return float(np.tile(0.5 * w, len(inner) - 1) @ ((curve(t)[:, 1] + 50) * curve.derivative()(t)[:, 0]))


def test_features_between_places(tmp_path):
    """Check a notch and a bump of a spline that lie between points in a few equal steps, and the number of points."""
    x = np.linspace(0, 100, 41)
    notch = np.column_stack([x, np.where((x > 13) & (x < 24), -5.0, 0.0)])
    found, said = areas(spline_over_box(notch, 1), tmp_path)
    assert np.allclose(found, 5000 - 5 * (7.5 + 12.5) / 2) and "curve 1: 8 points" in said
    bump = np.column_stack([x, np.where(np.arange(41) == 8, 8.0, 0.0)])
    found, said = areas(spline_over_box(bump, 3), tmp_path)
    assert abs(found[0] - area_below(bump, 3)) < 0.05 and area_below(bump, 3) > 5015
    assert int(said.split("curve 1: ")[1].split()[0]) < 80
    smooth = np.column_stack([x, 20 * np.sin(x * math.pi / 100)])
    found, said = areas(spline_over_box(smooth, 3), tmp_path)
    assert abs(found[0] - area_below(smooth, 3)) < 0.5 and "curve 1: 63 points" in said


def test_references_that_are_not_seen(tmp_path):
    """Check that references that are invisible or on a frozen layer are left out with what they hold, nested ones
    too, but that an off layer hides nothing on other layers."""
    def build(where, nested=False, **fields):
        def drawing(document, space):
            document.layers.add("COLD").freeze()
            document.layers.add("OFF").off()
            document.blocks.new("HOLE").add_circle((0, 0), 3, dxfattribs={"layer": "CUT"})
            document.blocks.new("GROUP").add_blockref("HOLE", (2, 0), dxfattribs={"layer": where if nested else "0"})
            fields["layer"] = "0" if nested else where
            space.add_blockref("GROUP", (10, 5), dxfattribs=fields)
            space.add_lwpolyline([(0, 0), (40, 0), (40, 20), (0, 20)], close=True)
        return drawing
    for nested in (False, True):
        found, said = areas(build("COLD", nested), tmp_path)
        assert np.allclose(found, 800) and "INSERT on layer COLD: layer COLD is frozen" in said
        found, _ = areas(build("COLD", nested), tmp_path, "--layer", "CUT", "--chord", 1e-4)
        assert np.allclose(found, 9 * math.pi, rtol=1e-3)
    assert len(areas(build("OFF"), tmp_path)[0]) == 2
    found, said = areas(build("0", invisible=1), tmp_path)
    assert np.allclose(found, 800) and "INSERT on layer 0: invisible" in said


def test_equal_and_empty(tmp_path):
    """Check that one of several equal curves is used, in either direction and from any point, that curves of length 0
    are left out, and that closed curves without area are refused."""
    corners = [*SQUARE, SQUARE[0]]

    def circles(_, space):
        for _ in range(3):
            space.add_circle((5, 5), 2)
    found, said = areas(circles, tmp_path, "--chord", 1e-4)
    assert np.allclose(found, 4 * math.pi, rtol=1e-3) and len(found) == 1
    assert "CIRCLE on layer 0: equal to another one, which is used (2 of this kind)" in said

    def squares(_, space):
        for points in (corners, corners[::-1]):
            for start, end in zip(points, points[1:]):
                space.add_line(start, end)
        space.add_lwpolyline([(30, 0), (40, 0), (40, 20), (30, 20)], close=True)
        space.add_lwpolyline([(40, 20), (40, 0), (30, 0), (30, 20)], close=True)
    found, said = areas(squares, tmp_path)
    assert np.allclose(found, 200) and len(found) == 2 and "which is used (4 of this kind)" in said

    def point(_, space):
        space.add_lwpolyline(SQUARE, close=True)
        space.add_line((50, 0), (50, 0))
        space.add_circle((0, 0), 0)
    found, said = areas(point, tmp_path)
    assert len(found) == 1 and "LINE on layer 0: of length 0" in said and "CIRCLE on layer 0: of length 0" in said

    def slit(_, space):
        space.add_lwpolyline([(0, 0), (4, 3), (8, 6)], close=True)
    assert "a closed curve without area begins at (0 0 0)" in refused(slit, tmp_path)

    def near(_, space):  # short lines in a row, and lines beside each other, are no copies
        line = [(x, 0) for x in np.arange(0, 0.2, 0.005)] + [(0.2, 0), (0.2, 30), (0.25, 30), (0.25, -1), (0, -1)]
        for start, end in zip(line, line[1:] + line[:1]):
            space.add_line(start, end)
    found, said = areas(near, tmp_path)
    assert np.allclose(found, 0.2 + 0.05 * 31) and "left out" not in said


def test_equal_edges_of_cad(tmp_path):
    """Check a wire that is doubled, a face that is doubled, and edges that two faces have at a joint, each its own."""
    def area(name, build):
        with session() as gmsh:
            build(gmsh.model.occ)
            gmsh.model.occ.synchronize()
            gmsh.write(str(tmp_path / name))
        said = call("curve", tmp_path / name, tmp_path / "x.txt")
        curves = read_curves(tmp_path / "x.txt")
        return [abs(c[:, 0] @ np.roll(c[:, 1], -1) - c[:, 1] @ np.roll(c[:, 0], -1)) / 2 for c in curves], said
    found, said = area("wires.step", lambda occ: [occ.addCircle(5, 5, 0, 2) for _ in range(2)])
    assert np.allclose(found, 4 * math.pi, rtol=1e-2) and len(found) == 1 and "equal to another one" in said
    found, said = area("faces.step", lambda occ: [occ.addRectangle(0, 0, 0, 8, 5) for _ in range(2)])
    assert np.allclose(found, 40) and len(found) == 1 and "face 2 (Plane): equal to another one, which is used" in said
    found, said = area("joint.step", lambda occ: [occ.addRectangle(x, 0, 0, 8, 5) for x in (0, 8)])
    assert np.allclose(found, 80) and len(found) == 1 and "left out" not in said


def test_cap(tmp_path):
    """Check that the rim of a spherical cap is its one curve: not the seam and the pole of its face."""
    with session() as gmsh:
        gmsh.model.occ.addSphere(0, 0, 0, 20, angle1=0.6)
        gmsh.model.occ.synchronize()
        gmsh.write(str(tmp_path / "solid.brep"))
        gmsh.model.occ.remove([(3, 1)])
        gmsh.model.occ.remove([(2, tag) for _, tag in gmsh.model.getEntities(2) if gmsh.model.getType(2, tag) == "Plane"])
        gmsh.model.occ.synchronize()
        gmsh.write(str(tmp_path / "cap.brep"))
    assert "a solid has no free edges" in call("curve", tmp_path / "solid.brep", tmp_path / "cap.txt", expect=2)
    said = call("curve", tmp_path / "cap.brep", tmp_path / "cap.txt")
    points = np.loadtxt(tmp_path / "cap.txt")
    assert "curve 2" not in said and "left out" not in said
    assert np.allclose(np.linalg.norm(points, axis=1), 20) and np.allclose(points[:, 2], 20 * math.sin(0.6))


def test_features_of_cad(tmp_path):
    """Check a notch of a spline of degree 1 in a STEP file."""
    x = np.linspace(0, 100, 41)
    notch = np.column_stack([x, np.where((x > 13) & (x < 24), -5.0, 0.0)])
    with session() as gmsh:
        occ = gmsh.model.occ
        points = [occ.addPoint(a, b, 0) for a, b in (*notch, (100, -50), (0, -50))]
        edges = [occ.addBSpline(points[:41], degree=1)]
        edges += [occ.addLine(points[i], points[j]) for i, j in ((40, 41), (41, 42), (42, 0))]
        occ.addPlaneSurface([occ.addCurveLoop(edges)])
        occ.synchronize()
        gmsh.write(str(tmp_path / "notch.step"))
    said = call("curve", tmp_path / "notch.step", tmp_path / "x.txt")
    curve, = read_curves(tmp_path / "x.txt")
    x, y = curve[:, 0], curve[:, 1]
    area = abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
    assert abs(area - 4950) < 0.5 and len(curve) < 40, said


def drawing_bytes():
    """Return a drawing with an array of a block, a spline, an arc and lines."""
    document = ezdxf.new("R2000", units=4)
    space = document.modelspace()
    document.blocks.new("HOLE").add_circle((0, 0), 3)
    space.add_blockref("HOLE", (5, 5), dxfattribs={"xscale": 2, "column_count": 2, "column_spacing": 9})
    space.add_spline().set_closed([(0, 0, 0), (9, 0, 0), (9, 9, 0), (0, 9, 0)])
    space.add_arc((0, 0), 5, 0, 90)
    space.add_lwpolyline([(5, 0), (0, 0), (0, 5)])
    stream = io.StringIO()
    document.write(stream)
    return stream.getvalue().encode()


@pytest.mark.parametrize(("count", "seed"), [(1000, 1)])
def test_mutants(tmp_path, count, seed):
    """Check that no damaged file ends in anything but curves or a Problem."""
    data, path = drawing_bytes(), tmp_path / "mutant.dxf"
    split, end = data.index(b"BLOCKS"), data.index(b"OBJECTS")
    for mutant in mutants(data[split:end], count, seed):
        path.write_bytes(data[:split] + mutant + data[end:])
        try:
            joined(path, pieces_of_dxf(path, 0.1, None, Account()))
        except Problem as problem:
            assert "mutant.dxf" in str(problem)
