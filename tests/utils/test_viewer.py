# SPDX-License-Identifier: GPL-3.0-or-later
"""Data of the 3D view of a page: arrays, skins, fields, zones, deviations; without a browser."""

import base64
import gzip
import json
import re

import numpy as np
import pytest
from helpers import call, write_run
from viewer_run import HISTORY, PHASES, SHAPE, STATUS, viewed_run

from dd3 import forming_limit
from dd3.plot.sheet import Run
from dd3.sheet import Sheet
from dd3.viewer import scene as scenes
from dd3.viewer.arrays import Arrays
from dd3.viewer.scene import Scene, kept_steps, places_of, upward_normals
from dd3.viewer.skin import LOWER_SIDE, RIM, UPPER_SIDE, skin_of, turned


def decoded(elements, array):
    """Return an array of a page as data.js reads it."""
    data = gzip.decompress(base64.b64decode(re.search(">(.*)<", elements[array["number"]])[1]))
    kind = np.dtype(array["kind"])
    together = np.frombuffer(data, np.uint8).reshape(kind.itemsize, -1).T.tobytes()
    values = np.frombuffer(together, kind.newbyteorder("<"))
    return array["low"] + array["scale"] * values if array["kind"] == "uint16" else values


@pytest.fixture
def scene(tmp_path):
    """Return the scene of the made-up run, with its description and arrays."""
    folder = viewed_run(tmp_path / "strip.out")
    sheet, run = Sheet(folder), Run(folder)
    options = forming_limit.Criteria(thinning=0.12)
    made = Scene(sheet, run, ["x", "y"], forming_limit.find_limits(sheet, run.job, options), 0.1)
    return made, made.description(), made.arrays.elements


def test_arrays():
    """Check that arrays come back: whole numbers and such that are not finite exactly, others to their 16 bits."""
    arrays, values = Arrays(), np.linspace(-3.0, 7.0, 1001) ** 3
    written = arrays.add(values), arrays.add_whole(np.array([0, 3, 300, 70000])), arrays.add(np.array([1.0, np.nan])), \
        arrays.add(np.full(5, 2.5)), arrays.add_whole(np.array([0, 255]))
    real, whole, holes, same, small = (decoded(arrays.elements, array) for array in written)
    assert np.abs(real - values).max() <= 0.51 * np.ptp(values) / 65535
    assert whole.tolist() == [0, 3, 300, 70000] and holes[0] == 1 and np.isnan(holes[1])
    assert (same == 2.5).all() and small.tolist() == [0, 255] and written[4]["kind"] == "uint8"


def test_skin(scene):
    """Check the skin of the strip: its area by sides, that it is closed, and its mesh lines."""
    made, _, _ = scene
    skin, points = skin_of(made.sheet, 0), made.sheet.initial(0)
    corners = points[skin.nodes][skin.places[skin.triangles]]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    for side, expected in ((LOWER_SIDE, 400), (UPPER_SIDE, 400), (RIM, 100)):
        assert abs(area[skin.sides == side].sum() - expected) < 1e-9
    edges = np.sort(skin.places[skin.triangles][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    nx, ny, _ = SHAPE
    lines = 2 * (nx * (ny - 1) + ny * (nx - 1)) + 3 * 2 * (nx - 1 + ny - 1)  # of both faces, and of the rim
    assert len(skin.edges) == lines - 0 and len(skin.nodes) == np.prod(SHAPE)
    assert turned([0, 1, 2, 9, 3], [0, 1, 2, 3]) == [[9, 3, 0], [9, 0, 1], [9, 1, 2]]


def test_fields(scene):
    """Check fields at nodes and elements against those of the run, at the node numbers that the page tells."""
    made, description, elements = scene
    fields = {(field["name"], field["elements"]): field for field in description["fields"]}
    mesh = description["meshes"][0]
    nodes = decoded(elements, mesh["nodes"])
    for name in ("thinning", "stress:23", "displacement:z", "displacement:magnitude"):
        field = fields[name, False]
        for step in (0, 1):
            expected = made.sheet.component(step, name)[0]
            found = decoded(elements, field["values"][step])
            assert np.abs(found - expected[nodes - 1]).max() <= 0.51 * max(np.ptp(expected), 1e-12) / 65535, name
    assert fields["thinning", False]["percent"] and not fields["stress:11", False]["percent"]
    assert fields["contact_tool", False]["names"] == ["none", "punch"]
    owners = decoded(elements, mesh["elements"])[decoded(elements, mesh["owners"])]
    assert set(owners.tolist()) == set(range(1, (SHAPE[0] - 1) * (SHAPE[1] - 1) + 1))
    zone = decoded(elements, fields["thinning_zone", False]["values"][1])
    thinning = made.sheet.values(1, "thinning")[0][nodes - 1]
    assert ((zone == 3) == (thinning > 0.12)).all() and ((zone == 2) == ((thinning > 0.096) & (thinning <= 0.12))).all()
    judged = forming_limit.strains_of(made.sheet, 1, "middle")
    expected = made.limits.curve.zones(judged.major, judged.minor, 0.1)[nodes - 1]
    assert (decoded(elements, fields["limit_zone", False]["values"][1]) == expected).all()


def test_springback_of_the_view(scene):
    """Check the step of the free shape after its best fit, and its deviation along the normal."""
    made, description, elements = scene
    assert [step["free"] for step in description["steps"]] == [False, False, True]
    assert [step["active"] for step in description["steps"]] == [["punch"], [], []]
    fields = {field["name"]: field for field in description["fields"]}
    assert fields["distance"]["values"][:2] == [None, None]
    distance = decoded(elements, fields["distance"]["values"][2])
    assert abs(distance.max() - made.sprung.distance().max()) < 1e-4
    along = decoded(elements, fields["distance_normal"]["values"][2])
    assert (np.abs(along) <= distance + 1e-4).all() and along.min() < 0 < along.max()
    normals = upward_normals(made.sheet, 0)
    assert np.abs(np.linalg.norm(normals, axis=1) - 1).max() < 1e-12 and (normals[:, 2] > 0.7).all()


def test_normals_between_corners(tmp_path):
    """Check that nodes inside a sheet of two layers, which are no corners of its faces, have the normals above them."""
    x, y, z = (a.ravel() for a in np.meshgrid([0.0, 2.0, 4.0], [0.0, 2.0], [0.0, 0.5, 1.0], indexing="ij"))
    number, points = np.arange(18).reshape(3, 2, 3), np.column_stack([x, y, z + 0.5 * x])
    cells = [[number[i + a, b, j + k] for k in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
             for i in range(2) for j in range(2)]
    run = write_run(tmp_path / "run", points, points, cells, HISTORY, STATUS, phases=PHASES)
    assert np.allclose(upward_normals(Sheet(run), 0), np.array([-0.5, 0, 1]) / np.sqrt(1.25))


def test_places(scene):
    """Check the places of the verdict: at the last step of their phase, and none where nothing was measured."""
    made, _, _ = scene
    place = {"distance": 0.123, "tool": "punch", "node": 7, "position": [1.0, 2.0, 3.0]}
    closing = {"punches": [{"tool": "punch", "off_tools": place, "off_walls": None, "path_left": place}],
               "holders": [{"tool": "ring", "wave": place, "beyond": None}]}
    job = {"phases": [{"name": "draw", "result": {"closing": closing}}, {"name": "free", "result": {}}], "warnings": []}
    found = list(places_of(job, made.pictures))
    assert [one["text"] for one in found] == ["draw: farthest from the tools at the end of the path of punch, 0.12 mm",
                                              "draw: path left of punch is shortest, 0.12 mm",
                                              "draw: highest wave under ring, 0.12 mm"]
    assert all(one["step"] == 0 and one["position"] == [1.0, 2.0, 3.0] for one in found)


def test_kept_steps(scene, monkeypatch):
    """Check that steps between the ends of phases are left out of a run with too many values, and none of another."""
    made, _, _ = scene
    assert kept_steps(made.sheet) == [0, 1]
    values = sum(int(np.prod(data.shape[1:])) for data in made.sheet.grid["PointData"].values())
    monkeypatch.setattr(scenes, "MOST", 4 * values * np.prod(SHAPE))
    monkeypatch.setattr(made.sheet, "count", 9)
    monkeypatch.setattr(made.sheet, "last", 8)
    monkeypatch.setattr(made.sheet, "mesh_number", lambda step: 0)
    made.sheet.file.close()
    made.sheet.file = {"job": {"phase": np.array([1, 1, 1, 2, 2, 2, 2, 2, 2])}}
    made.sheet.grid = {"PointData": {"all": np.zeros((1, values))}, "NumberOfPoints": [np.prod(SHAPE)]}
    assert kept_steps(made.sheet) == [0, 2, 4, 8]


def test_page(tmp_path):
    """Check that the page needs no other file, names what is in it, and tells of curves that answer to the mouse."""
    folder = viewed_run(tmp_path / "strip.out")
    call("report", folder, "--mirror", "x", "y", "--output", tmp_path / "report")
    text = (tmp_path / "report" / "report.html").read_text()
    assert not re.search(r"<(link|iframe)|(src|href)\s*=\s*.(https?:|//|file:)", text)
    scene = json.loads(re.search(r'<script type="application/json" id="scene">(.*?)</script>', text)[1])
    assert [tool["name"] for tool in scene["tools"]] == ["punch"] and scene["mirror"] == ["x", "y"]
    curves = json.loads(re.search(r'id="curves_force_draw">(.*?)</script>', text)[1])
    assert curves[0]["lines"][0]["y"] == [0.0, 10.0] and curves[0]["lines"][0]["label"] == "punch"
    for name in ("The MIT License", "three.js authors", "Chart.js Contributors"):
        assert name in text
