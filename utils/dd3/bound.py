# SPDX-License-Identifier: GPL-3.0-or-later
"""Bound nodes of a mesh whose elements were divided: each in the middle of an edge of a larger element, whose faces get
it as a further corner, so that faces, sections and outlines have no gap there."""
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_array

from dd3.hanging import outer_faces

if TYPE_CHECKING:
    import pyvista as pv

EDGES = np.array([(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)])
MIDDLE = 0.25  # distance of a bound node from the middle of its edge, over the length of the edge, at most
HEXAHEDRON = 12  # type of VTK

Bound = Mapping[tuple[int, int], int]  # the bound node of an edge, by the nodes at its ends, the smaller one first


def bound_nodes(corners: np.ndarray, points: np.ndarray) -> dict[tuple[int, int], int]:
    """Return the bound nodes of hexahedra with corners (m, 8): nodes near the middle of an edge that are joined to both
    of its ends by edges of other elements."""
    ends = np.unique(np.sort(corners[:, EDGES].reshape(-1, 2), axis=1), axis=0)
    count, ones = len(points), np.ones(len(ends), np.int32)
    half = coo_array((ones, (ends[:, 0], ends[:, 1])), shape=(count, count))
    joined = (half + half.T).tocsr()
    found: dict[tuple[int, int], int] = {}
    for a, b in zip(*(joined @ joined).multiply(half).nonzero()):
        between = np.intersect1d(joined[[a]].indices, joined[[b]].indices)
        away = np.linalg.norm(points[between] - (points[a] + points[b]) / 2, axis=1)
        if len(between) and away.min() < MIDDLE * np.linalg.norm(points[b] - points[a]):
            found[int(a), int(b)] = int(between[away.argmin()])
    return found


def rings(faces: np.ndarray, bound: Bound) -> list[list[int]]:
    """Return the nodes around faces (m, 4), with the bound nodes of their edges."""
    around: list[list[int]] = faces.tolist()
    if not bound:
        return around
    return [[node for a, b in zip(ring, ring[1:] + ring[:1]) for node in along(a, b, bound)] for ring in around]


def along(a: int, b: int, bound: Bound) -> list[int]:
    """Return the nodes on an edge from its first end to the last one before the other end."""
    middle = bound.get((min(a, b), max(a, b)))
    return [a] if middle is None else along(a, middle, bound) + along(middle, b, bound)


def inner_faces(faces: Iterable[Iterable[int]], bound: Bound) -> set[tuple[int, ...]]:
    """Return the faces, as sorted nodes, at which larger elements meet smaller ones: of two opposite edges with bound
    nodes, between which the face is two faces of others."""
    there = {tuple(sorted(face)) for face in faces}
    found = set()
    for face in faces:
        for turn in (0, 1):
            a, b, c, d = np.roll(np.asarray(face), turn).tolist()
            one, other = (bound.get((min(pair), max(pair)), -1) for pair in ((a, b), (c, d)))
            halves = {tuple(sorted((a, one, other, d))), tuple(sorted((one, b, c, other)))}
            if min(one, other) >= 0 and halves <= there:
                found |= halves | {tuple(sorted((a, b, c, d)))}
    return found


def closed_skin(grid: "pv.UnstructuredGrid") -> "pv.UnstructuredGrid | pv.PolyData":
    """Return the surface of a grid of hexahedra with bound nodes, with its values; another grid as it is."""
    import pyvista as pv
    if set(grid.celltypes) != {HEXAHEDRON}:
        return grid
    corners = grid.cells.reshape(-1, 9)[:, 1:]
    bound = bound_nodes(corners, grid.points)
    if not bound:
        return grid
    faces, owners = outer_faces(corners)
    inner = inner_faces(faces, bound)
    kept = np.array([tuple(sorted(face)) not in inner for face in faces.tolist()])
    around = rings(faces[kept], bound)
    skin = pv.PolyData(grid.points, np.concatenate([[len(ring), *ring] for ring in around]))
    for name in grid.point_data:
        skin.point_data[name] = grid.point_data[name]
    for name in grid.cell_data:
        skin.cell_data[name] = grid.cell_data[name][owners[kept]]
    return skin
