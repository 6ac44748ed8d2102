# SPDX-License-Identifier: GPL-3.0-or-later
"""Hanging nodes: nodes on an edge or a face of an element to which they do not belong, where the sheet would tear."""
from collections.abc import Iterable, Mapping, Sequence

import numpy as np
from scipy.spatial import cKDTree

from dd3.errors import Problem

TOLERANCE = 1e-3  # distance from a face, and of nodes at the same place, over the shortest edge of the face
FACES = np.array([(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)])
CHUNK = 100_000  # faces at a time
NEAR = 0.01  # distance from the edge of a shell, and from its ends, over its length: sheets are curved

MIDDLE = 0.1  # distance of a bound node from the middle of its edge, over the length of the edge, at most


def edges_of_hung(hung: Iterable[tuple[str, list[int]]], number: Mapping[int, int], points: np.ndarray,
                  quads: Iterable[Sequence[int]]) -> dict[tuple[int, int], int]:
    """Return the bound nodes of edges of shells by the ends of the edges, the smaller one first.

    hung: place in a file, labels of a node and of the ends of its edge; number: of the points, by label.
    """
    edges = {(min(a, b), max(a, b)) for quad in quads for a, b in zip(quad, [*quad[1:], quad[0]])}
    bound, places = {}, {}
    for place, labels in hung:
        node, *ends = (number.get(label, -1) for label in labels)
        edge = (min(ends, default=-1), max(ends, default=-1))
        if len(ends) != 2 or edge not in edges:
            raise Problem(f"{place}: error: node {labels[0]} hangs between the nodes {labels[1]} and {labels[-1]}, "
                          "which are not the ends of an edge of a shell")
        length = float(np.linalg.norm(points[edge[1]] - points[edge[0]]))
        away = float(np.linalg.norm(points[node] - points[list(edge)].mean(axis=0)))
        if away > MIDDLE * length:
            raise Problem(f"{place}: error: node {labels[0]} is {away:.3g} from the middle of the edge between the "
                          f"nodes {labels[1]} and {labels[2]}, which is {length:.3g} long; expected at most "
                          f"{MIDDLE:g} of its length")
        bound[edge], places[edge] = node, (place, labels)
    for edge in bound:
        if set(edge) & set(bound.values()):
            place, labels = places[edge]
            raise Problem(f"{place}: error: node {labels[0]} hangs on an edge one end of which hangs itself; expected "
                          "levels of neighbours that differ by one")
    return bound


def hanging_nodes(points: np.ndarray, cells: Sequence[Sequence[int]]) -> list[tuple[int, int]]:
    """Return the nodes that hang, each with one element on whose edge or face it lies.

    points: (n, 3); cells: corners of quadrilaterals and triangles, or of hexahedra, indices of points.
    """
    if len(cells) == 0:
        return []
    if len(cells[0]) == 8:
        return first_of_each(hanging(points, *outer_faces(np.array(cells)), cells))
    edges = np.array([(cell[k - 1], cell[k]) for cell in cells for k in range(len(cell))])
    owners = np.repeat(np.arange(len(cells)), [len(cell) for cell in cells])
    _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    edges, owners = edges[first[count == 1]], owners[first[count == 1]]
    return first_of_each(hanging_on_edges(points, edges, owners, cells)) if len(edges) else []


def first_of_each(pairs: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return the pairs of nodes and elements with the first element of each node."""
    return sorted(dict(sorted(pairs, reverse=True)).items())


def hanging_on_edges(points: np.ndarray, edges: np.ndarray, owners: np.ndarray,
                     members: Sequence[Iterable[int]]) -> list[tuple[int, int]]:
    """Return pairs of a node and a shell on whose edge it lies, of edges (m, 2) that belong to one shell only."""
    candidates = np.unique(edges)
    ends = points[edges]
    along = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(along, axis=1)
    near = cKDTree(points[candidates]).query_ball_point(ends.mean(axis=1), 0.51 * length)
    edge = np.repeat(np.arange(len(near)), [len(nodes) for nodes in near])
    node = candidates[np.concatenate([np.asarray(nodes, int) for nodes in near])]
    offset = points[node] - ends[edge, 0]
    square = np.maximum(length[edge] ** 2, 1e-300)
    part = (offset * along[edge]).sum(axis=1) / square
    distance = np.linalg.norm(offset - part[:, None] * along[edge], axis=1)
    on = (part > NEAR) & (part < 1 - NEAR) & (distance < NEAR * length[edge])
    return [(int(n), int(owners[e])) for n, e in zip(node[on], edge[on]) if int(n) not in members[owners[e]]]


def outer_faces(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the faces (m, 4) that belong to one hexahedron only, and their elements, of corners (n, 8)."""
    faces = corners[:, FACES].reshape(-1, 4)
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    alone = np.sort(first[count == 1])
    return faces[alone], alone // len(FACES)


def hanging(points: np.ndarray, faces: np.ndarray, owners: np.ndarray,
            members: Sequence[Iterable[int]]) -> list[tuple[int, int]]:
    """Return pairs of a node and an element on whose face or edge it lies.

    `points` (n, 3); `faces` (m, 4) node numbers around faces, of the elements `owners` (m); `members`: all nodes of
    each element. Nodes at the corners of a face are none.
    """
    candidates = np.unique(faces)
    if not len(candidates):
        return []
    tree = cKDTree(points[candidates])
    found = []
    for start in range(0, len(faces), CHUNK):
        part = slice(start, start + CHUNK)
        corners = points[faces[part]]
        centre = corners.mean(axis=1)
        radius = 1.01 * np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)
        near = tree.query_ball_point(centre, radius)
        face = np.repeat(np.arange(len(near)), [len(nodes) for nodes in near])
        node = candidates[np.concatenate([np.asarray(nodes, int) for nodes in near])]
        # Most are corners of the face.
        other = (faces[part][face] != node[:, None]).all(axis=1)
        face, node = face[other], node[other]
        on = on_face(points[node], corners[face])
        found += [(int(n), int(owners[start + f])) for n, f in zip(node[on], face[on])
                  if int(n) not in members[owners[start + f]]]
    return sorted(set(found))


def on_face(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Check which points (n, 3) lie on bilinear faces with corners (n, 4, 3), away from these."""
    edges = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    tolerance = TOLERANCE * edges.min(axis=1)
    sign = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)
    at = np.zeros((len(points), 2))
    for _ in range(8):  # Newton's method for the nearest point, in the natural coordinates
        shape = 0.25 * (1 + at[:, None, 0] * sign[:, 0]) * (1 + at[:, None, 1] * sign[:, 1])
        slope = 0.25 * np.stack([sign[:, 0] * (1 + at[:, None, 1] * sign[:, 1]),
                                 sign[:, 1] * (1 + at[:, None, 0] * sign[:, 0])], axis=1)
        gap = points - np.einsum("ni,nij->nj", shape, corners)
        tangent = np.einsum("nki,nij->nkj", slope, corners)
        metric = np.einsum("nki,nli->nkl", tangent, tangent)
        metric[:, [0, 1], [0, 1]] += 1e-300
        right = np.einsum("nki,ni->nk", tangent, gap)
        determinant = metric[:, 0, 0] * metric[:, 1, 1] - metric[:, 0, 1] ** 2
        step = np.stack([metric[:, 1, 1] * right[:, 0] - metric[:, 0, 1] * right[:, 1],
                         metric[:, 0, 0] * right[:, 1] - metric[:, 0, 1] * right[:, 0]], axis=1)
        at = np.clip(at + step / np.maximum(determinant, 1e-300)[:, None], -1, 1)
    shape = 0.25 * (1 + at[:, None, 0] * sign[:, 0]) * (1 + at[:, None, 1] * sign[:, 1])
    distance = np.linalg.norm(points - np.einsum("ni,nij->nj", shape, corners), axis=1)
    to_corner = np.linalg.norm(points[:, None] - corners, axis=2).min(axis=1)
    return (distance <= tolerance) & (to_corner > tolerance)
