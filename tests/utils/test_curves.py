# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of DXF files: blocks, splines, units, layers, what is left out, and damaged files."""

import io
import math

import ezdxf
import numpy as np
import pytest
from helpers import call
from mutations import mutants

from dd3.account import Account
from dd3.curve import joined, read_curves, sampled
from dd3.dxf import pieces_of_dxf
from dd3.errors import Problem

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
            joined(path, pieces_of_dxf(path, 0.1, None, sampled, Account()))
        except Problem as problem:
            assert "mutant.dxf" in str(problem)
