# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces with which a sheet is compared: a face of a sheet, a tool surface, CAD, facets; distances from them."""

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from dd3.bound import Bound, rings
from dd3.errors import Problem
from dd3.fields import SAME
from dd3.plot.skins import Placement, tool_surface
from dd3.sheet import Sheet
from dd3.tools.facet_files import Facets
from dd3.tools.nagata import estimate_normals, unfolded_patches
from dd3.tools.one_tool import made
from dd3.tools.picture import quads as flat_quads
from dd3.tools.settings import ToolSettings
from dd3.tools.surface import read_patches

PARALLEL = 1e-9  # sine of the angle between a line and a triangle below which they do not meet
CELLS = 10_000  # at most, whose normals are compared with those of another surface
# Cosine of the angle between normals of sides that look alike; part of the area of a body that looks to the other side.
ALONG, LEAST_SIDE = 0.5, 0.2
INSIDE = 1e-9  # by which a line may pass beside a triangle, in its own coordinates


def surface_of(net: np.ndarray) -> Any:
    """Return patches as a surface of pyvista, of triangles between points on them."""
    import pyvista as pv
    return pv.PolyData(*flat_quads(net)).triangulate()


def read_surface(path: Path) -> Any:
    """Return the surface of a file: tool surface (.bez), CAD, or facets, as `dd3 tool` reads it."""
    if not path.is_file():
        raise Problem(f"{path}: No such file")
    if path.suffix == ".bez":
        return tool_surface(read_patches(path), Placement(np.eye(3), np.zeros(3))).triangulate()
    return surface_of(made(ToolSettings(path))[0].net)


def sheet_surface(sheet: Sheet, step: int, beyond: float = 0.0, upper: bool = False, places: np.ndarray | None = None
                  ) -> Any:
    """Return a face of a sheet at a step as a surface of pyvista, curved between the nodes, its normals away from the
    sheet, and continued beyond its border by a length. places: of all nodes, where they are others, mm."""
    nodes, quads, bound = face_mesh(sheet, step, upper)
    points = (sheet.points(step) if places is None else places)[nodes]
    if beyond:
        points, quads = continued(points, quads, beyond, bound)
    facets = conforming(quads, bound)
    mesh = Facets(points, facets, np.zeros(len(facets), int), ["sheet"])
    return surface_of(unfolded_patches(mesh.nodes, estimate_normals(mesh))[0])


def face_mesh(sheet: Sheet, step: int, upper: bool) -> tuple[np.ndarray, np.ndarray, Bound]:
    """Return the nodes of a face of a sheet at a step, its quadrilaterals (m, 4) and its bound nodes; these two by the
    place among the nodes."""
    nodes, corner = np.unique(sheet.faces(upper, step), return_inverse=True)
    place = {int(node): i for i, node in enumerate(nodes)}
    bound = {(place[a], place[b]): place[node] for (a, b), node in sheet.bound(step).items() if node in place}
    return nodes, corner.reshape(-1, 4), bound


def conforming(quads: np.ndarray, bound: Bound) -> np.ndarray:
    """Return the facets (m, 4) of quadrilaterals; one with bound nodes becomes triangles around one of these, with -1
    as the fourth node."""
    facets: list[list[int]] = []
    for ring, quad in zip(rings(quads, bound), quads.tolist()):
        if len(ring) == 4:
            facets.append(quad)
            continue
        k = next(i for i, node in enumerate(ring) if node not in quad)
        middle, *others = ring[k:] + ring[:k]
        facets += [[middle, a, b, -1] for a, b in pairwise(others)]
    return np.array(facets)


def continued(points: np.ndarray, quads: np.ndarray, length: float, bound: Bound) -> tuple[np.ndarray, np.ndarray]:
    """Return a mesh of quadrilaterals with a row more around its border, in the direction of the last row."""
    edges = np.stack((quads, np.roll(quads, -1, axis=1)), axis=2).reshape(-1, 2)
    opposite = np.stack((np.roll(quads, 1, axis=1), np.roll(quads, -2, axis=1)), axis=2).reshape(-1, 2)
    known = {edge for ring in rings(quads, bound) for edge in zip(ring, ring[1:] + ring[:1])}
    known |= {edge for a, b in bound for edge in ((a, b), (b, a))}
    free = np.array([(int(b), int(a)) not in known for a, b in edges])
    outward = np.zeros_like(points)
    for k in range(2):
        np.add.at(outward, edges[free][:, k], points[edges[free][:, k]] - points[opposite[free][:, k]])
    border = np.unique(edges[free])
    number = np.full(len(points), -1)
    number[border] = len(points) + np.arange(len(border))
    outward = outward[border] / np.linalg.norm(outward[border], axis=1)[:, None]
    a, b = edges[free].T
    return (np.vstack((points, points[border] + length * outward)),
            np.vstack((quads, np.stack((b, a, number[a], number[b]), axis=1))))


class InitialFace(NamedTuple):
    """A face of a sheet in its initial shape, flat or formed: places of its nodes, mm, and triangles (m, 3) of them."""

    places: np.ndarray
    triangles: np.ndarray

    def at(self, values: np.ndarray, wanted: np.ndarray) -> np.ndarray:
        """Return values of the nodes at other initial places: those of the same nodes, or interpolated linearly at the
        nearest points of the face."""
        distance, node = cKDTree(self.places).query(wanted)
        if distance.max(initial=0.0) <= SAME * np.ptp(self.places, axis=0).max():
            return np.asarray(values[node])
        import pyvista as pv
        cells, nearest = pv.PolyData.from_regular_faces(self.places, self.triangles).find_closest_cell(
            wanted, return_closest_point=True)
        corners = self.triangles[cells]
        a, b, c = np.moveaxis(self.places[corners], 1, 0)
        normal = np.cross(b - a, c - a)
        square = (normal**2).sum(axis=1)
        second = (np.cross(nearest - a, c - a) * normal).sum(axis=1) / square
        third = (np.cross(b - a, nearest - a) * normal).sum(axis=1) / square
        weights = np.stack((1.0 - second - third, second, third), axis=1)
        return np.asarray(np.einsum("nc,nc...->n...", weights, values[corners]))


def initial_face(sheet: Sheet, step: int, upper: bool) -> InitialFace:
    """Return a face of the mesh of a sheet at a step, in the initial shape."""
    nodes, quads, bound = face_mesh(sheet, step, upper)
    facets = conforming(quads, bound)
    return InitialFace(sheet.initial(step)[nodes], np.vstack((facets[:, :3], facets[facets[:, 3] >= 0][:, [0, 2, 3]])))


def normal_distances(points: np.ndarray, surface: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the distances of points from a surface along its normals, positive on their side, these normals, and the
    distances by which the points are beside the surface, beyond its border."""
    cells, closest = surface.find_closest_cell(points, return_closest_point=True)
    normals = np.asarray(surface.face_normals, float)[cells]
    distance = ((points - closest) * normals).sum(axis=1)
    return distance, normals, np.linalg.norm(points - closest - distance[:, None] * normals, axis=1)


def normal_feet(points: np.ndarray, surface: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return points moved along the normals of a surface by their distances along these, and the distances by which
    they are beside it: where the sheet reaches beyond the border of the surface, the feet are in its continuation."""
    distance, normals, beside = normal_distances(points, surface)
    return points - distance[:, None] * normals, beside


def cells_along(surface: Any, points: np.ndarray, directions: np.ndarray) -> Iterator[np.ndarray]:
    """Yield for each line the cells of a surface whose boxes it meets."""
    from vtkmodules.vtkCommonCore import vtkIdList
    from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator
    locator, found = vtkStaticCellLocator(), vtkIdList()
    locator.SetDataSet(surface)
    locator.BuildLocator()
    middle, near = np.array(surface.center), SAME * surface.length
    for point, direction in zip(points, directions):
        along = (middle - point) @ direction
        inwards = middle - point - along * direction
        # The locator leaves out lines that pass beside its box by round-off: they are moved half the tolerance inwards.
        start = point + (along - surface.length) * direction + 0.5 * near * inwards / max(np.linalg.norm(inwards), near)
        locator.FindCellsAlongLine(start, start + 2 * surface.length * direction, near, found)
        yield np.array([found.GetId(k) for k in range(found.GetNumberOfIds())], int)


def line_distances(points: np.ndarray, directions: np.ndarray, surface: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return the distances along lines from points to the nearest place where each meets a surface, and its normals
    there; nan where it does not. directions: unit vectors.

    Source: Moeller and Trumbore, J. Graph. Tools 2 (1997) 21-28.
    """
    corners = np.asarray(surface.points, float)[surface.faces.reshape(-1, 4)[:, 1:]]
    face_normals = np.asarray(surface.face_normals, float)
    found, normals = np.full(len(points), np.nan), np.full((len(points), 3), np.nan)
    for i, near in enumerate(cells_along(surface, points, directions)):
        point, direction, corner = points[i], directions[i], corners[near]
        first, second = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
        size = np.linalg.norm(first, axis=1) * np.linalg.norm(second, axis=1)
        across = np.cross(direction, second)
        volume = (first * across).sum(axis=1)
        factor = np.divide(1.0, volume, where=np.abs(volume) > PARALLEL * size, out=np.full_like(volume, np.nan))
        offset = point - corner[:, 0]
        u = factor * (offset * across).sum(axis=1)
        other = np.cross(offset, first)
        v = factor * (other @ direction)
        hits = np.flatnonzero((u >= -INSIDE) & (v >= -INSIDE) & (u + v <= 1 + INSIDE))
        if hits.size:
            along = factor[hits] * (other[hits] * second[hits]).sum(axis=1)
            nearest = np.abs(along).argmin()
            found[i] = along[nearest]
            normals[i] = face_normals[near[hits[nearest]]]
    return found, normals


def side_of_body(surface: Any, other: Any) -> Any:
    """Return of the surface of a body, such as the solid of a sheet part, the side to which another surface beside it
    looks; other surfaces as they are. A body has no open edges, and cells in both directions along the normals of the
    other one."""
    if surface.clean(tolerance=SAME).n_open_edges:
        return surface
    centres = np.asarray(surface.cell_centers().points, float)
    normals, areas = np.asarray(surface.face_normals, float), surface.compute_cell_sizes()["Area"]
    cosine = (normals * normal_distances(centres, other)[1]).sum(axis=1)
    parts = [float(areas[chosen].sum() / areas.sum()) for chosen in (cosine > ALONG, cosine < -ALONG)]
    if min(parts) < LEAST_SIDE:
        return surface
    # The normals of a body look outwards if its volume by them is positive.
    outwards = float(((centres - centres.mean(axis=0)) * normals).sum(axis=1) @ areas)
    import pyvista as pv
    return pv.PolyData(surface.points, surface.faces.reshape(-1, 4)[np.sign(outwards) * cosine > ALONG].ravel())


def turned_to(surface: Any, other: Any) -> Any:
    """Return a surface with its normals on the side of those of another one beside it, by some of its cells."""
    some = slice(None, None, 1 + other.n_cells // CELLS)
    _, normals, _ = normal_distances(np.asarray(other.cell_centers().points, float)[some], surface)
    same = (normals * np.asarray(other.face_normals)[some]).sum(axis=1)
    return surface.flip_faces() if (same < 0).sum() > (same > 0).sum() else surface
