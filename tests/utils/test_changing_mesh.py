# SPDX-License-Identifier: GPL-3.0-or-later
"""Results whose mesh changes: each step with its own mesh, for VTK and for dd3; bound nodes leave no gap."""

import json

import matplotlib.colors
import matplotlib.image
import numpy as np
import pytest
import vtk
from changing import LEVELS, MESH_OF, SQUARES, TRAVEL, meshes, moved, write_changing
from helpers import call
from vtk.util.numpy_support import vtk_to_numpy

from dd3.bound import bound_nodes, closed_skin
from dd3.fields import Fields
from dd3.fixture_target import lower_face
from dd3.forming_limit import strains_of
from dd3.mesh import read_run
from dd3.nominal import InitialFace, conforming, continued, initial_face
from dd3.outline import rim_on
from dd3.plot import levels
from dd3.section import Section
from dd3.sheet import Sheet, length, plane
from dd3.springback import Springback, best_fit, twist

FINE = MESH_OF.index(2)  # a step of the last mesh


@pytest.fixture
def run(tmp_path):
    """Return the folder of a run."""
    return write_changing(tmp_path / "job.out")


def test_vtk(run):
    """Check points, cells and data of each step as VTK reads them, and as dd3 does."""
    places, elements = meshes()
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(run / "fields.vtkhdf"))
    reader.UpdateInformation()
    fields = Fields(run)
    assert fields.count == reader.GetNumberOfSteps() == len(MESH_OF)
    for step in (*range(len(MESH_OF)), 0, 2, 1):
        mesh = MESH_OF[step]
        reader.SetStep(step)
        reader.Update()
        grid = reader.GetOutputDataObject(0)
        points = vtk_to_numpy(grid.GetPoints().GetData())
        assert points.shape == places[mesh].shape and np.allclose(points, moved(places[mesh], step))
        assert np.allclose(vtk_to_numpy(grid.GetCells().GetConnectivityArray()), elements[mesh].ravel())
        assert grid.GetNumberOfCells() == len(elements[mesh]) and grid.GetCellType(0) == 12
        at_nodes, at_cells = grid.GetPointData(), grid.GetCellData()
        assert np.allclose(vtk_to_numpy(at_nodes.GetArray("thickness")), 1 + 0.01 * places[mesh][:, 0] + step)
        assert np.array_equal(vtk_to_numpy(at_cells.GetArray("level")), LEVELS[mesh])
        stress = vtk_to_numpy(at_cells.GetArray("stress"))
        own = fields[step]
        assert own.n_points == len(points) and np.allclose(own.points, points)
        assert np.array_equal(own.cells.reshape(-1, 9)[:, 1:], elements[mesh])
        assert np.array_equal(own.cell_data["level"], LEVELS[mesh]) and np.array_equal(own.cell_data["stress"], stress)
        assert stress[0, 0] == 1000 * step and len(stress) == len(elements[mesh])
        assert np.allclose(fields.initial(step), places[mesh]) and np.allclose(fields.start(step), places[mesh])


def test_steps_from_the_end(run):
    """Check negative steps."""
    fields = Fields(run)
    assert np.array_equal(fields.points(-1), fields.points(fields.last)) and fields.mesh_number(-4) == 0


def test_nodes(run):
    """Check the nodes of a mesh in a later one, and that a coarse mesh lacks those of a finer one."""
    fields, (places, _) = Fields(run), meshes()
    assert np.allclose(fields.initial(FINE)[fields.nodes_in(0, FINE)], places[0])
    assert np.array_equal(fields.nodes_in(1, 2), np.arange(len(places[1])))
    with pytest.raises(Exception, match="lacks nodes"):
        fields.nodes_in(FINE, 0)


def test_start_from_another_run(tmp_path):
    """Check the positions at the start of nodes that came later, where the sheet was not flat then."""
    def bent(x0):
        return x0 + np.column_stack([0 * x0[:, 0], 0.1 * x0[:, 0], 0.2 * x0[:, 1]])

    fields = Fields(write_changing(tmp_path / "job.out", bent))
    places, _ = meshes()
    assert np.allclose(fields.initial(FINE), places[2], atol=1e-9)
    assert np.allclose(fields.start(FINE), bent(places[2]), atol=1e-6)


@pytest.mark.parametrize("flat", [True, False])
def test_bound_nodes(flat):
    """Check the bound nodes of each mesh, each in the middle of its edge, in a flat and in a curved sheet."""
    places, elements = meshes()
    for mesh, count in enumerate((0, 2, 4)):
        points = places[mesh] if flat else moved(places[mesh], 2)
        bound = bound_nodes(elements[mesh], points)
        assert len(bound) == 2 * count  # on both faces of the sheet
        for (a, b), node in bound.items():
            assert np.allclose(places[mesh][node], (places[mesh][a] + places[mesh][b]) / 2)


def test_rim(run):
    """Check that the borders between sizes of elements are no rim."""
    sheet, (places, _) = Sheet(run), meshes()
    for step, mesh in enumerate(MESH_OF):
        for upper in (True, False):
            edges = sheet.rim(upper, step)
            ends = places[mesh][edges]
            assert all(np.isin(pair[:, axis], (0, 16)).all() for pair in ends for axis in (0, 1)
                       if np.ptp(pair[:, axis]) == 0)
            assert np.isclose(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).sum(), 64)
            (line,) = sheet.outline(upper, step=step)
            assert line[0] == line[-1] and len(line) == len(edges) + 1
    assert len(sheet.outline(True, ["x", "y"], FINE)) == 1
    square = np.array([[0, 0], [16, 0], [16, 16], [0, 16]], float)
    assert len(rim_on(run, square).initial) == len(edges) - 4  # corners have no neighbour inside


@pytest.mark.parametrize("text", ["y=1", "y=3", "y=5", "y=8", "x=6", "x=8", "45", "20"])
def test_sections(run, text):
    """Check that sections of each mesh are one line without gaps or double points, of the length of the plane in the
    sheet, also along and across borders between sizes of elements."""
    sheet = Sheet(run)
    normal, distance = plane(text)
    for step in range(len(MESH_OF)):
        lines = sheet.cut(normal, distance, step=step)
        assert len(lines) == 1
        section = Section(sheet, lines[0], step)
        steps = np.diff(section.length0)
        along = {"45": 16 * 2**0.5, "20": 16 / np.cos(np.radians(20))}.get(text, 16.0)
        assert steps.min() > 1e-6 and np.isclose(section.length0[-1], along, rtol=1e-4)
        assert np.allclose(section.start @ normal, distance, atol=1e-4)
        assert np.allclose(section.field("thickness")[0], 1 + 0.01 * section.start[:, 0] + step)
        assert np.isclose(length(section.now)[-1], section.length[-1])


def test_skin(run):
    """Check that the surface for pictures is closed: each edge belongs to two faces."""
    fields = Fields(run)
    assert closed_skin(fields.shape(0)).n_cells == len(SQUARES[0])  # the grid as it is
    for step in range(1, len(MESH_OF)):
        grid = fields[step]
        skin = closed_skin(grid)
        assert skin.is_manifold and skin.n_open_edges == 0
        assert np.isclose(skin.volume, grid.compute_cell_sizes().cell_data["Volume"].sum(), rtol=1e-2)
        assert set(np.unique(skin.cell_data["level"])) == set(LEVELS[MESH_OF[step]])
        assert np.array_equal(skin.point_data["thickness"], grid.point_data["thickness"])


def test_strains_and_springback(run):
    """Check strains of the surface, the initial places of the lower face, and shapes of two meshes."""
    sheet, (places, _) = Sheet(run), meshes()
    assert len(strains_of(sheet, FINE, "middle").at_cells.major) == len(SQUARES[2])
    assert np.allclose(strains_of(sheet, 0, "middle").at_cells.major, 0, atol=1e-12)
    initial, now = lower_face(sheet, FINE)
    assert np.allclose(initial[:, 2], 0) and np.allclose(moved(initial, FINE), now)
    free = sheet.points(FINE)[sheet.nodes_in(1, FINE)]
    assert np.allclose(free, moved(places[1], FINE))
    found = Springback(free, best_fit(free @ np.diag([-1.0, -1.0, 1.0]), free), 1)
    assert found.distance().max() < 1e-9 and twist(sheet, found)[1] == pytest.approx(0, abs=1e-9)


def test_fit_by_area(run):
    """Check that nodes count by their areas, whatever the mesh, and that a fit takes them."""
    sheet, (places, _) = Sheet(run), meshes()
    centre = (places[0].min(axis=0) + places[0].max(axis=0)) / 2
    area = 2 * np.prod(np.ptp(places[0][:, :2], axis=0))
    for step in (0, FINE):
        areas, start = sheet.areas(step), sheet.start(step)
        assert areas.sum() == pytest.approx(area) and np.allclose(areas @ start / area, centre)
    assert not np.allclose(start.mean(axis=0), centre)
    other = start.copy()
    other[0] += 5
    assert np.allclose(best_fit(other, start, ("x",), np.arange(len(start)))[1:], start[1:])


def test_facets(run):
    """Check the facets of the lower face for surfaces: closed, and continued only beyond the rim."""
    sheet = Sheet(run)
    quads, bound = sheet.faces(False, FINE), sheet.bound(FINE)
    points, more = continued(sheet.points(FINE), quads, 5.0, bound)
    assert len(more) == len(quads) + len(sheet.rim(False, FINE))
    facets = conforming(more, bound)
    edges = {}
    for facet in facets.tolist():
        ring = [node for node in facet if node >= 0]
        for pair in zip(ring, ring[1:] + ring[:1]):
            edges[tuple(sorted(pair))] = edges.get(tuple(sorted(pair)), 0) + 1
    border = {tuple(sorted(edge)) for edge, count in edges.items() if count == 1}
    assert max(edges.values()) == 2
    assert all(max(pair) >= len(sheet.points(FINE)) for pair in border) and len(points) > len(sheet.points(FINE))


def test_values_at_places(run):
    """Values that are linear in the initial places are exact at others: on a mesh with bound nodes, and on a channel
    whose walls and lips lie over one another in plan."""
    slope = np.array([[1.0, 2, -3], [0.5, -1, 4]])
    fine = initial_face(Sheet(run), FINE, upper=False)
    wanted = np.clip(fine.places + [0.31, 0.17, 0], fine.places.min(axis=0), fine.places.max(axis=0))
    assert np.allclose(fine.at(fine.places @ slope.T, wanted), wanted @ slope.T)
    channel = np.array([[8.0, 20], [0, 20], [0, 0], [30, 0], [30, 20], [22, 20]])
    points = np.array([[x, y, z] for x, z in channel for y in (0.0, 5, 10)])
    quads = np.array([[3 * i + j, 3 * i + j + 1, 3 * i + j + 4, 3 * i + j + 3] for i in range(5) for j in range(2)])
    face = InitialFace(points, np.vstack((quads[:, :3], quads[:, [0, 2, 3]])))
    wanted = np.array([[4.0, 3, 20], [4, 3, 0], [0, 7, 11], [30, 1, 0.5], [25, 9, 20], [25, 9, 0]])
    assert np.allclose(face.at(points @ slope.T, wanted), wanted @ slope.T)


def test_commands(run, tmp_path):
    """Check the commands on steps with different meshes."""
    call("section", run, "--plane", "y=5", "--at", 0, "--at", 1, "--at", 3, "--table", "section.csv")
    assert len((tmp_path / "section.csv").read_text().splitlines()) > 5
    call("export", run, "last.inp")
    assert len(read_run(run / "fields.vtkhdf", FINE).bound) == 8
    assert (tmp_path / "last.inp").read_text().count("LINEAR, ") == 8
    assert f"{len(SQUARES[1])} elements" in call("export", run, "middle.vtu", "--at", TRAVEL[1])
    call("export", run, "last.k")
    assert (tmp_path / "last.k").read_text().count("*CONSTRAINED_LINEAR_GLOBAL") == 24
    call("export", run, "last.k", "--shells")
    lines = (tmp_path / "last.k").read_text().split("*CONSTRAINED_ADAPTIVITY\n")[1].splitlines()
    assert len(lines) == 5  # and the end


def test_picture_of_levels(run, tmp_path):
    """Check that the elements have the colour of their level, and the names in the legend."""
    (run / "run.json").write_text(json.dumps({"format": "dd3imp run", "format_version": 2, "tools": [],
                                              "drawbeads": [], "phases": [], "outcome": {"state": "reached"}}))
    picture = tmp_path / "levels.png"
    call("plot", "sheet", run, "--field", "level", "--view", "top", "--size", 400, 400, "--output", picture)
    colours = matplotlib.image.imread(picture)[..., :3][:300]
    for level in range(3):
        wanted = np.array(matplotlib.colors.to_rgb(levels.COLOURS[level]))
        hue = colours / np.maximum(colours.max(axis=-1, keepdims=True), 1e-6)  # whatever the light
        near = np.abs(hue - wanted / wanted.max()).max(axis=-1) < 0.03
        assert near.sum() > 300, level
    assert levels.names_of([LEVELS[2]]) == [f"level {i}: {(LEVELS[2] == i).sum()} elements" for i in range(3)]
    assert levels.names_of([LEVELS[0], LEVELS[1]]) == ["level 0", "level 1"]
    assert levels.limits_of(2) == [-0.5, 2.5] and len(levels.colours_of(4)) == 5
