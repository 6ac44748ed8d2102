# SPDX-License-Identifier: GPL-3.0-or-later
"""Curved patches from facets: normals at the nodes, quadratic interpolation of the edges.

An edge is the quadratic that is perpendicular to the normals at its ends (Nagata, Computer Aided Geometric Design 22
(2005) 327-347); triangles and quadrilaterals through such edges are exactly patches of degree 2 x 2. The normal of a
node is the mean of those of its facets with the weights of Max (Weights for computing vertex normals from facet
normals, Journal of Graphics Tools 4 (1999)), which are exact on a sphere. A facet next to a flat region several times
as large as its own does not count: on the line between a plane and a fillet, or between a straight and a curved part
of a fillet, the normal is that of the larger one.
"""
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from dd3.tools.facet_files import Facets
from dd3.tools.joints import OPPOSITE, find_joints, folded, kinks
from dd3.tools.mend import edge_table, pairs_of
from dd3.tools.surface import from_triangles, homogeneous, quarters

# Ratio of the areas and widths of two flat regions below which the smaller one does not count at their common nodes.
SMALL_REGION = 1 / 3.5
# Angles between facets, degrees: above the first there is an edge of the tool; below the second they are one plane.
CREASE, FLAT = 40.0, 0.05
# Relative singular value of the end conditions below which they count as one.
ONE_CONDITION = 0.06
# Largest deviation of an edge from its chord's linear course, relative to the chord.
MOST_CURVED = 0.7
# Rounds of straightening the edges of facets with folded patches, which may fold their neighbours.
MOST_PLAIN = 5


@dataclass
class Net:
    """Facets with the normals at their corners (facet, 4, 3), and the regions between sharp edges."""

    facets: np.ndarray
    normals: np.ndarray
    region: np.ndarray
    angle: np.ndarray  # of the smooth edges, degrees
    straight: int = 0  # edges without a quadratic
    plain: np.ndarray | None = None  # facets whose edges are kept straight, None for none
    # Distance of the facets' edges from a smooth surface, mm.
    estimate: np.ndarray = field(default_factory=lambda: np.empty(0))


def groups(count: int, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return the components of items joined in pairs."""
    graph = coo_array((np.ones(len(first), np.int8), (first, second)), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def corner_areas(nodes: np.ndarray, facets: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the cross products of the edges at the corners (facet, 4, 3), the lengths of both edges, and the angle
    between them."""
    count = np.where(facets[:, 3] < 0, 3, 4)[:, None]
    k = np.arange(4)[None]
    ring = np.where(facets < 0, facets[:, :1], facets)
    row = np.arange(len(facets))[:, None]
    after, before = nodes[ring[row, (k + 1) % count]], nodes[ring[row, (k - 1) % count]]
    here = nodes[ring]
    a, b = after - here, before - here
    area = np.cross(a, b)
    area[facets < 0] = 0.0
    angle = np.arctan2(np.linalg.norm(area, axis=2), (a * b).sum(axis=2))
    return area, np.linalg.norm(a, axis=2), np.linalg.norm(b, axis=2), angle


def unit(vectors: np.ndarray) -> np.ndarray:
    """Return vectors of length 1; zero stays zero."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)


def facet_areas(nodes: np.ndarray, facets: np.ndarray) -> np.ndarray:
    """Return the area vectors of the facets."""
    area = corner_areas(nodes, facets)[0].sum(axis=1)
    return area / np.where(facets[:, 3] < 0, 6, 4)[:, None]


def estimate_normals(mesh: Facets) -> Net:
    """Return the net of a mesh with consistent facets."""
    nodes, facets = mesh.nodes, mesh.facets
    vectors = facet_areas(nodes, facets)
    size, normal = np.linalg.norm(vectors, axis=1), unit(vectors)
    here, to, facet, corner = edge_table(facets)
    pairs, _ = pairs_of(facets)
    first, second = facet[pairs].T
    a, b = normal[first], normal[second]
    angle = np.degrees(2 * np.arctan2(np.linalg.norm(a - b, axis=1), np.linalg.norm(a + b, axis=1)))
    flat = groups(len(facets), first[angle <= FLAT], second[angle <= FLAT])
    region_area = np.bincount(flat, weights=size)[flat]
    smooth = angle <= CREASE
    # Corners joined around a node by smooth edges share a normal: the first node of one is the second of the other.
    one, two = pairs[smooth].T
    count = np.where(facets[:, 3] < 0, 3, 4)
    start = 4 * facet + corner
    end = 4 * facet + (corner + 1) % count[facet]
    fan = groups(4 * len(facets), np.concatenate([start[one], end[one]]), np.concatenate([end[two], start[two]]))
    corners = np.unique(fan * len(facets) + np.repeat(flat, 4), return_inverse=True)[1].ravel()
    dropped = np.zeros(corners.max() + 1, bool)
    near = neighbours(len(facets), first[angle <= FLAT], second[angle <= FLAT])
    for these, own, other in ((one, first[smooth], second[smooth]), (two, second[smooth], first[smooth])):
        small = region_area[own] < SMALL_REGION * region_area[other]
        for k in np.flatnonzero(small):
            ends = nodes[here[these[k]]], nodes[to[these[k]]]
            width = region_area[own[k]] / max(np.linalg.norm(ends[1] - ends[0]), 1e-300)
            small[k] = reaches(nodes, facets, near, other[k], ends, width / SMALL_REGION)
        dropped[corners[start[these[small]]]] = dropped[corners[end[these[small]]]] = True
    inner = pairs[angle <= FLAT]
    vector = corner_vectors(nodes, facets, corners, np.concatenate([start[inner[:, 0]], end[inner[:, 0]]]),
                            np.tile(np.linalg.norm(nodes[to[inner[:, 0]]] - nodes[here[inner[:, 0]]], axis=1), 2))
    vector[dropped[corners]] = 0.0
    total = np.zeros((fan.max() + 1, 3))
    np.add.at(total, fan, vector)
    region = groups(len(facets), first[smooth], second[smooth])
    return Net(facets, unit(total)[fan].reshape(-1, 4, 3), region, angle[smooth])


def neighbours(count: int, first: np.ndarray, second: np.ndarray) -> list[list[int]]:
    """Return the facets joined with each one."""
    result: list[list[Any]] = [[] for _ in range(count)]
    for a, b in zip(first.tolist(), second.tolist()):
        result[a].append(b)
        result[b].append(a)
    return result


def reaches(nodes: np.ndarray, facets: np.ndarray, near: list[list[int]], facet: int,
            ends: tuple[np.ndarray, np.ndarray], distance: float) -> bool:
    """Tell whether a flat region extends this far from an edge of one of its facets, in a band of twice its length.

    A ring around an axis does not, however large its area is.
    """
    middle, along = (ends[0] + ends[1]) / 2, ends[1] - ends[0]
    length = max(float(np.linalg.norm(along)), 1e-300)
    seen, waiting = {facet}, [facet]
    while waiting:
        item = waiting.pop()
        offset = nodes[facets[item][facets[item] >= 0]] - middle
        place = offset @ along / length
        across = np.linalg.norm(offset - place[:, None] * along / length, axis=1)
        if place.min() > length or place.max() < -length:
            continue
        if across.max() >= distance:
            return True
        waiting += [other for other in near[item] if other not in seen]
        seen.update(near[item])
    return False


def corner_vectors(nodes: np.ndarray, facets: np.ndarray, group: np.ndarray, inner: np.ndarray, length: np.ndarray
                  ) -> np.ndarray:
    """Return the weighted normals of the corners (4 * facet, 3): Max's weights sin(angle)/(a b), with the edges a and b
    of the corner.

    Two triangles of a flat quadrilateral that meet in a corner weigh as its corner does. `group` numbers the corners of
    one flat region at a node, `inner` are corners at an edge within such a group, and `length` is that edge's.
    """
    area, length_a, length_b, angle = corner_areas(nodes, facets)
    angle = angle.ravel()
    product = np.maximum(length_a * length_b, 1e-300)
    vector = (area / product[..., None]**2).reshape(-1, 3)
    real = facets.ravel() >= 0
    count = np.bincount(group[real], minlength=group.max() + 1)
    total = np.bincount(group[real], weights=angle[real], minlength=len(count))
    logarithm = np.bincount(group[real], weights=np.log(product.ravel()[real]), minlength=len(count))
    logarithm -= 2 * np.bincount(group[inner], weights=np.log(np.maximum(length, 1e-300)), minlength=len(count))
    shared = np.bincount(group[inner], minlength=len(count))
    whole = (count == 2) & (shared == 1) & (total < np.radians(150))
    chosen = whole[group] & real
    weight = np.sin(total) / np.exp(logarithm) / 2
    vector[chosen] = unit(vector[chosen]) * weight[group[chosen], None]
    vector[~real] = 0.0
    return vector


def edge_controls(nodes: np.ndarray, net: Net) -> np.ndarray:
    """Return the middle control points of the edges of each facet (facet, 4, 3), from a corner to the next; set the
    net's estimates."""
    a, b, facet, corner = edge_table(net.facets)
    count = np.where(net.facets[:, 3] < 0, 3, 4)[facet]
    normal_a, normal_b = net.normals[facet, corner], net.normals[facet, (corner + 1) % count]
    swap = a > b
    low, high = np.where(swap, b, a), np.where(swap, a, b)
    normal_low, normal_high = (np.where(swap[:, None], *pair) for pair in ((normal_b, normal_a), (normal_a, normal_b)))
    _, first, inverse = np.unique(np.stack([low, high], axis=1), axis=0, return_index=True, return_inverse=True)
    inverse = inverse.ravel()
    last = np.zeros(len(first), int)
    last[inverse] = np.arange(len(inverse))
    chord = nodes[high[first]] - nodes[low[first]]
    rows = np.stack([normal_low[first], normal_low[last], normal_high[first], normal_high[last]], axis=1)
    along = np.einsum("ekc,ec->ek", rows, chord) * np.array([1, 1, -1, -1])
    curve = np.einsum("eck,ek->ec", np.linalg.pinv(rows, rcond=ONE_CONDITION), along)
    wild = np.linalg.norm(curve, axis=1) > MOST_CURVED * np.linalg.norm(chord, axis=1)
    if net.plain is not None:
        wild[inverse[net.plain[facet]]] = True
    curve[wild] = 0.0
    net.straight = int(wild.sum())
    net.estimate = np.zeros(len(net.facets))
    middle = nodes[low[first]] + (chord - curve) / 2
    result = np.zeros((len(net.facets), 4, 3))
    result[facet, corner] = middle[inverse]
    # Between the ends of an arc of angle w the quadratic is off by w^2/16 of the sagitta; the normals of the nodes are
    # estimates, so the double is taken.
    cosine = (normal_low[first] * normal_high[first]).sum(axis=1)
    angle = np.arccos(np.clip(cosine, -1, 1))
    np.maximum.at(net.estimate, facet, (np.linalg.norm(curve, axis=1) / 4 * angle**2 / 8)[inverse])
    return result


def unfolded_patches(nodes: np.ndarray, net: Net) -> tuple[np.ndarray, np.ndarray]:
    """Return the patches of a net and the facet of each, the edges of facets kept straight whose patches are folded or
    turn back upon others."""
    control, facet = patches_of(nodes, net)
    net.plain = np.zeros(len(net.facets), bool)
    for _ in range(MOST_PLAIN):
        joints = find_joints(control)
        back = kinks(control, joints) > OPPOSITE
        bent = facet[np.concatenate([folded(control), joints.first[back] // 4, joints.second[back] // 4])]
        if net.plain[bent].all():
            break
        net.plain[bent] = True
        control, facet = patches_of(nodes, net)
    return control, facet


def patches_of(nodes: np.ndarray, net: Net) -> tuple[np.ndarray, np.ndarray]:
    """Return the patches of a net and the facet of each: three of a triangle and four of a quadrilateral, or one if
    there are no triangles."""
    middle = edge_controls(nodes, net)
    triangle = np.flatnonzero(net.facets[:, 3] < 0)
    quad = np.flatnonzero(net.facets[:, 3] >= 0)
    corner = nodes[net.facets[quad]]
    control = np.zeros((len(quad), 3, 3, 3))
    for k, (i, j) in enumerate(((0, 0), (0, 2), (2, 2), (2, 0))):
        control[:, i, j] = corner[:, k]
    for k, (i, j) in enumerate(((0, 1), (1, 2), (2, 1), (1, 0))):
        control[:, i, j] = middle[quad, k]
    control[:, 1, 1] = middle[quad].sum(axis=1) / 2 - corner.sum(axis=1) / 4
    quads = homogeneous(control)
    if not len(triangle):
        return quads, quad
    thirds = from_triangles(nodes[net.facets[triangle, :3]], middle[triangle, :3])
    return np.concatenate([thirds, quarters(quads)]), np.concatenate([np.repeat(triangle, 3), np.repeat(quad, 4)])
