# SPDX-License-Identifier: GPL-3.0-or-later
"""The outer faces of a sheet as triangles, without gaps where elements were divided."""

from typing import NamedTuple

import numpy as np

from dd3.bound import EDGES, Bound, inner_faces, rings
from dd3.hanging import outer_faces
from dd3.sheet import LOWER, UPPER, Sheet

LOWER_SIDE, UPPER_SIDE, RIM = range(3)


class Skin(NamedTuple):
    """The outer faces of a mesh.

    nodes: those of the mesh that the skin has; places: for each vertex its node as a place in `nodes`: nodes between
    upper face, lower face and rim have a vertex for each of them, for the normals; triangles: their vertices (m, 3);
    owners: their elements; sides: LOWER_SIDE, UPPER_SIDE or RIM; edges: the vertices of the edges of elements (n, 2).
    """

    nodes: np.ndarray
    places: np.ndarray
    triangles: np.ndarray
    owners: np.ndarray
    sides: np.ndarray
    edges: np.ndarray


def skin_of(sheet: Sheet, step: int) -> Skin:
    """Return the skin of the mesh of a step."""
    corners = sheet.corners(step)
    between = {**middles(sheet.elements(step)), **sheet.bound(step)}
    faces, owners = outer_faces(corners)
    if sheet.bound(step):
        inner = inner_faces(faces, sheet.bound(step))
        kept = np.array([tuple(sorted(face)) not in inner for face in faces.tolist()])
        faces, owners = faces[kept], owners[kept]
    sides = np.full(len(faces), RIM)
    for side, places in ((LOWER_SIDE, LOWER), (UPPER_SIDE, UPPER)):
        sides[(np.sort(faces, axis=1) == np.sort(corners[owners][:, places], axis=1)).all(axis=1)] = side
    around = rings(faces, between)
    triangles = [turned(ring, face) for ring, face in zip(around, faces.tolist())]
    counts = np.array([len(part) for part in triangles])
    corner = np.concatenate(triangles).reshape(-1, 3)
    edges = np.concatenate([np.column_stack([ring, np.roll(ring, -1)]) for ring in around])
    edge_sides = np.repeat(sides, [len(ring) for ring in around])
    sides, count = np.repeat(sides, counts), len(sheet.points(step))
    vertices, number = np.unique(np.concatenate([(corner + sides[:, None] * count).ravel(),
                                                 (edges + edge_sides[:, None] * count).ravel()]), return_inverse=True)
    nodes, places = np.unique(vertices % count, return_inverse=True)
    lines = np.unique(np.sort(number[corner.size:].reshape(-1, 2), axis=1), axis=0)
    return Skin(nodes, places, number[: corner.size].reshape(-1, 3), np.repeat(owners, counts), sides, lines)


def middles(elements: np.ndarray) -> Bound:
    """Return the nodes in the middle of the edges of elements, by the nodes at the ends; none of linear ones."""
    if elements.shape[1] < 20:
        return {}
    ends = np.sort(elements[:, EDGES], axis=2).reshape(-1, 2)
    return {(int(a), int(b)): int(node) for (a, b), node in zip(ends, elements[:, 8:20].ravel())}


def turned(ring: list[int], corners: list[int]) -> list[list[int]]:
    """Return the triangles of a face given by the nodes around it. A face with nodes on its edges is divided from the
    first of them, so that none of its triangles has its corners on a line."""
    first = next((i for i, node in enumerate(ring) if node not in corners), 0)
    ring = ring[first:] + ring[:first]
    return [[ring[0], ring[i], ring[i + 1]] for i in range(1, len(ring) - 1)]
