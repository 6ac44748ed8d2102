# SPDX-License-Identifier: GPL-3.0-or-later
"""Mending of facets: nodes merged, facets without area and doubled ones removed, sides made consistent."""
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from dd3.tools.facet_files import Facets
from dd3.tools.joints import signs

# Distance of nodes that are one, relative to the diagonal of the box.
SAME_NODE = 1e-7
# Height of a triangle over its longest edge below which it has no area, relative to that edge.
NO_AREA = 1e-5
MOST_PASSES = 8
# Rounds of division of facets at the nodes inside their edges: each halves the number of nodes at an edge.
MOST_DIVISIONS = 40


def merged(mesh: Facets, distance: float) -> int:
    """Replace nodes within a distance by one; return their number."""
    pairs = cKDTree(mesh.nodes).query_pairs(distance, output_type="ndarray")
    if not len(pairs):
        return 0
    graph = coo_array((np.ones(len(pairs), np.int8), pairs.T), shape=(len(mesh.nodes),) * 2)
    count, group = connected_components(graph, directed=False)
    first = np.full(count, len(mesh.nodes))
    np.minimum.at(first, group, np.arange(len(mesh.nodes)))
    mesh.facets = np.where(mesh.facets < 0, -1, first[group][mesh.facets])
    return len(mesh.nodes) - count


def without_repeats(mesh: Facets) -> int:
    """Remove repeated nodes of facets: a quadrilateral with one becomes a triangle, others go; return their number."""
    rows, kept = [], []
    for index in np.flatnonzero(has_repeat(mesh.facets)):
        ring = [node for node in mesh.facets[index].tolist() if node >= 0]
        ring = [node for k, node in enumerate(ring) if node != ring[k - 1]]
        if len(ring) == 3 and len(set(ring)) == 3:
            rows.append([*ring, -1])
            kept.append(index)
    bad = has_repeat(mesh.facets)
    mesh.facets[kept] = np.array(rows).reshape(-1, 4)
    bad[kept] = False
    keep(mesh, ~bad)
    return int(bad.sum())


def has_repeat(facets: np.ndarray) -> np.ndarray:
    """Tell which facets have a node twice."""
    ordered = np.sort(facets, axis=1)
    return (ordered[:, 1:] == ordered[:, :-1]).any(axis=1)


def keep(mesh: Facets, chosen: np.ndarray) -> None:
    """Keep some facets."""
    mesh.facets, mesh.part = mesh.facets[chosen], mesh.part[chosen]


def without_doubles(mesh: Facets) -> int:
    """Remove facets on the nodes of an earlier one; return their number."""
    first = np.unique(np.sort(mesh.facets, axis=1), axis=0, return_index=True)[1]
    chosen = np.zeros(len(mesh.facets), bool)
    chosen[first] = True
    keep(mesh, chosen)
    return int((~chosen).sum())


def without_slivers(mesh: Facets) -> int:
    """Remove triangles without area: the neighbour at the longest edge is divided at the third node; return their
    number."""
    removed = 0
    for _ in range(MOST_PASSES):
        slivers = find_slivers(mesh)
        if not len(slivers):
            break
        facets: list[Any] = [list(row) for row in mesh.facets]
        part = list(mesh.part)
        owner: dict[frozenset, list[int]] = {}
        for index, row in enumerate(facets):
            for a, b in ring_edges(row):
                owner.setdefault(frozenset((a, b)), []).append(index)
        touched = set()
        for index, (a, b, middle) in slivers:
            if index in touched:
                continue
            facets[index] = None
            removed += 1
            others = [other for other in owner[frozenset((a, b))] if other != index and facets[other] is not None]
            if len(others) != 1 or others[0] in touched:
                continue
            other = others[0]
            touched.add(other)
            pieces = divided(facets[other], a, b, middle)
            facets[other] = pieces[0]
            facets += pieces[1:]
            part += [part[other]] * (len(pieces) - 1)
        chosen = [index for index, row in enumerate(facets) if row is not None]
        mesh.facets, mesh.part = np.array([facets[i] for i in chosen]).reshape(-1, 4), np.array(part)[chosen]
        keep(mesh, ~has_repeat(mesh.facets))
    return removed


def find_slivers(mesh: Facets) -> list[Any]:
    """Return index and nodes of the triangles without area: ends of the longest edge, third node."""
    triangle = np.flatnonzero(mesh.facets[:, 3] < 0)
    ring = mesh.facets[triangle, :3]
    point = mesh.nodes[ring]
    length = np.linalg.norm(np.roll(point, -1, axis=1) - point, axis=2)
    area = np.linalg.norm(np.cross(point[:, 1] - point[:, 0], point[:, 2] - point[:, 0]), axis=1)
    flat = np.flatnonzero(area <= NO_AREA * length.max(axis=1)**2)
    result = []
    for i in flat:
        k = int(length[i].argmax())
        result.append((int(triangle[i]), (int(ring[i, k]), int(ring[i, (k + 1) % 3]), int(ring[i, (k + 2) % 3]))))
    return result


def ring_edges(row: Sequence[int]) -> list[tuple[int, int]]:
    """Return the edges of a facet, pairs of nodes."""
    ring = [node for node in row if node >= 0]
    return [(ring[k - 1], ring[k]) for k in range(len(ring))]


def divided(row: list[int], a: int, b: int, middle: int) -> list[list[int]]:
    """Return the triangles of a facet whose edge between a and b gets a node in the middle."""
    ring = [node for node in row if node >= 0]
    start = next(k for k in range(len(ring)) if {ring[k - 1], ring[k]} == {a, b})
    ring = ring[start:] + ring[:start]
    return [[middle, ring[k], ring[k + 1], -1] for k in range(len(ring) - 1)]


def edge_table(facets: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the edges as (first node, second node, facet, corner of the first node), in the facets' order."""
    count = np.where(facets[:, 3] < 0, 3, 4)
    facet = np.repeat(np.arange(len(facets)), count)
    corner = np.arange(len(facet)) - np.repeat(np.cumsum(count) - count, count)
    after = np.where(corner + 1 == count[facet], 0, corner + 1)
    return facets[facet, corner], facets[facet, after], facet, corner


def pairs_of(facets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the pairs of rows of the edge table that are one edge, and the rows without a partner or with several."""
    a, b, _, _ = edge_table(facets)
    key = np.stack([np.minimum(a, b), np.maximum(a, b)], axis=1)
    _, inverse, count = np.unique(key, axis=0, return_inverse=True, return_counts=True)
    inverse = inverse.ravel()
    order = np.argsort(inverse, kind="stable")
    rows = order[count[inverse[order]] == 2]
    return rows.reshape(-1, 2), np.flatnonzero(count[inverse] != 2)


def consistent(mesh: Facets) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return signs of the facets that agree across edges, their bodies, which bodies are open, and the number of
    pairs that cannot agree."""
    a, _, facet, _ = edge_table(mesh.facets)
    pairs, others = pairs_of(mesh.facets)
    first, second = facet[pairs].T
    sign, body, twisted = signs(len(mesh.facets), first, second, a[pairs[:, 0]] != a[pairs[:, 1]])
    is_open = np.zeros(body.max() + 1, bool)
    is_open[body[facet[others]]] = True
    return sign, body, is_open, facet[pairs[twisted]].ravel()


def turn_facets(mesh: Facets, sign: np.ndarray) -> None:
    """Reverse the facets of negative sign."""
    triangle = mesh.facets[:, 3] < 0
    reverse = mesh.facets.copy()
    reverse[triangle, :3] = mesh.facets[triangle, 2::-1]
    reverse[~triangle] = mesh.facets[~triangle, ::-1]
    mesh.facets = np.where((sign < 0)[:, None], reverse, mesh.facets)


def gaps(mesh: Facets, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Return nodes of free edges that lie near another one, (n, 2), and their distances, mm.

    They count within `reach` and a quarter of the free edges at either.
    """
    a, b, _, _ = edge_table(mesh.facets)
    free = pairs_of(mesh.facets)[1]
    a, b = a[free], b[free]
    if not len(a):
        return np.zeros((0, 2), int), np.zeros(0)
    length = np.linalg.norm(mesh.nodes[b] - mesh.nodes[a], axis=1)
    shortest = np.full(len(mesh.nodes), np.inf)
    np.minimum.at(shortest, np.concatenate([a, b]), np.tile(length, 2))
    nodes = np.unique(np.concatenate([a, b]))
    pairs = nodes[cKDTree(mesh.nodes[nodes]).query_pairs(reach, output_type="ndarray")]
    distance = np.linalg.norm(mesh.nodes[pairs[:, 0]] - mesh.nodes[pairs[:, 1]], axis=1)
    near = distance < 0.25 * shortest[pairs].min(axis=1)
    return pairs[near], distance[near]


def with_whole_edges(mesh: Facets, reach: float) -> tuple[int, list[Any]]:
    """Divide facets with nodes of others inside their edges, so that facets meet in whole edges; return the number of
    nodes that were inserted and those that are left."""
    inserted = 0
    for _ in range(MOST_DIVISIONS):
        found = nodes_inside_edges(mesh, reach)
        if not found:
            break
        facets, part = mesh.facets.tolist(), mesh.part.tolist()
        for index, (a, b, middle) in found.items():
            pieces = divided(facets[index], a, b, middle)
            facets[index] = pieces[0]
            facets += pieces[1:]
            part += [part[index]] * (len(pieces) - 1)
        inserted += len(found)
        mesh.facets, mesh.part = np.array(facets), np.array(part)
    return inserted, [middle for _, _, middle in nodes_inside_edges(mesh, reach).values()]


def nodes_inside_edges(mesh: Facets, reach: float) -> dict[int, tuple[int, int, int]]:
    """Return the facets with nodes of free edges inside one of their free edges: the ends of this edge and the node in
    the middle of those inside, by facet.

    A node counts within `reach` mm of the edge, or 1e-4 of its length.
    """
    a, b, facet, _ = edge_table(mesh.facets)
    free = pairs_of(mesh.facets)[1]
    a, b, facet = a[free], b[free], facet[free]
    if not len(a):
        return {}
    nodes = np.unique(np.concatenate([a, b]))
    tree = cKDTree(mesh.nodes[nodes])
    middle, along = (mesh.nodes[a] + mesh.nodes[b]) / 2, mesh.nodes[b] - mesh.nodes[a]
    length = np.linalg.norm(along, axis=1)
    found: dict[Any, Any] = {}
    for i, near in enumerate(tree.query_ball_point(middle, 0.5 * length)):
        limit = max(1e-4 * length[i], reach)
        near = nodes[near]
        offset = mesh.nodes[near] - middle[i]
        place = offset @ along[i] / length[i]
        across = np.linalg.norm(offset - np.outer(place, along[i] / length[i]), axis=1)
        inside = (across < limit) & (np.abs(place) < 0.5 * length[i] - limit) & ~np.isin(near, mesh.facets[facet[i]])
        if inside.any():
            order = near[inside][np.argsort(place[inside])]
            found.setdefault(int(facet[i]), (int(a[i]), int(b[i]), int(order[len(order) // 2])))
    return found
