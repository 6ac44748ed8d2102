# SPDX-License-Identifier: GPL-3.0-or-later
"""Hanging nodes: nodes of one element on an edge or a face of another that does not have them."""
from collections import Counter
from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))  # of a hexahedron
NEAR = 0.01  # distance from an edge or a face over the length of the edge, and of its ends


def hanging_nodes(points: np.ndarray, cells: Sequence[Sequence[int]]) -> list[tuple[int, int]]:
    """Return the nodes that hang, each with the element on whose edge or face it is, both as indices.

    points: (n, 3); cells: corners of quadrilaterals (triangles too) or of hexahedra, indices of points. Where a mesh is
    conforming an edge of quadrilaterals, or a face of hexahedra, that has a node inside belongs to one element only.
    """
    solids = len(cells) > 0 and len(cells[0]) == 8
    sides: dict[frozenset[int], tuple[int, tuple[int, ...]]] = {}
    times: Counter[frozenset[int]] = Counter()
    for i, cell in enumerate(cells):
        rings = [tuple(cell[k] for k in face) for face in FACES] if solids else [
            (cell[k - 1], cell[k]) for k in range(len(cell))]
        for ring in rings:
            key = frozenset(ring)
            times[key] += 1
            sides[key] = i, ring
    free = [sides[key] for key, count in times.items() if count == 1]
    border = np.unique([node for _, ring in free for node in ring]) if free else np.zeros(0, int)
    if not len(border):
        return []
    tree, found = cKDTree(points[border]), dict[int, int]()
    for i, ring in free:
        corners = points[list(ring)]
        middle = corners.mean(axis=0)
        radius = np.linalg.norm(corners - middle, axis=1).max()
        for k in tree.query_ball_point(middle, radius):
            node = int(border[k])
            if node not in ring and node not in cells[i] and on_side(points[node], corners):
                found.setdefault(node, i)
    return sorted(found.items())


def on_side(point: np.ndarray, corners: np.ndarray) -> bool:
    """Check whether a point is on an edge (2 corners) or a face (4 corners), not at its corners."""
    if len(corners) == 2:
        return on_edge(point, corners[0], corners[1])
    if any(on_edge(point, corners[k - 1], corners[k]) for k in range(4)):
        return True
    a, b = corners[1] - corners[0], corners[3] - corners[0]
    c = corners[2] - corners[3] - a
    size = max(np.linalg.norm(a), np.linalg.norm(b))
    u = np.array([0.5, 0.5])
    for _ in range(8):  # Newton's method for the nearest point of the bilinear face
        base = np.column_stack((a + u[1] * c, b + u[0] * c))
        rest = point - corners[0] - u[0] * a - u[1] * b - u[0] * u[1] * c
        u = u + np.linalg.lstsq(base, rest, rcond=None)[0]
        if not np.all(np.abs(u) < 10):
            return False
    rest = point - corners[0] - u[0] * a - u[1] * b - u[0] * u[1] * c
    return bool(np.linalg.norm(rest) < NEAR * size and np.all((u > NEAR) & (u < 1 - NEAR)))


def on_edge(point: np.ndarray, first: np.ndarray, last: np.ndarray) -> bool:
    """Check whether a point is on an edge, not at its ends."""
    along = last - first
    length = float(along @ along)
    if not length > 0:
        return False
    part = float((point - first) @ along) / length
    return bool(NEAR < part < 1 - NEAR and np.linalg.norm(point - first - part * along) < NEAR * np.sqrt(length))
