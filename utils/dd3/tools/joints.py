# SPDX-License-Identifier: GPL-3.0-or-later
"""Joints of a surface's patches: shared, free and multiple edges, orientation, bodies, kinks, near misses.

Edges are joined as the program joins them: their points at 0, 1/4, 1/2, 3/4 and 1 coincide within 1e-6 of the diagonal
of the surface's box.
"""
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from dd3.tools.surface import areas_at, points_at, turned

# Distance of coincident edges, relative to the diagonal of the box; parameters at which edges are compared.
COINCIDENT = 1e-6
COMPARED = np.linspace(0, 1, 5)
# The program refuses joints at which the normals differ by more, degrees.
OPPOSITE = 171.0
# u and v along the four edges of a patch, anticlockwise.
EDGES = [lambda t: (t, 0 * t), lambda t: (1 + 0 * t, t), lambda t: (1 - t, 1 + 0 * t), lambda t: (0 * t, 1 - t)]


@dataclass
class Joints:
    """Pairs of edges: `first` and `second` are patch * 4 + edge; `opposed` if they run against each other, as edges
    of patches with the same orientation do. Edges by number: `free`, `multiple` (more than two patches), `pole`."""

    first: np.ndarray
    second: np.ndarray
    opposed: np.ndarray
    free: np.ndarray
    multiple: np.ndarray
    pole: np.ndarray
    points: np.ndarray  # (edge, 5, 3)
    size: float  # diagonal of the box, mm


def box_of(net: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the lower and upper corners of the box of the control points."""
    points = net[..., :3] / net[..., 3:]
    return points.min(axis=(0, 1, 2)), points.max(axis=(0, 1, 2))


def find_joints(net: np.ndarray) -> Joints:
    """Return the joints of the patches."""
    low, high = box_of(net)
    size = float(np.linalg.norm(high - low))
    tolerance = COINCIDENT * size
    points = np.stack([points_at(net, *edge(COMPARED)) for edge in EDGES], axis=1).reshape(-1, 5, 3)
    pole = np.linalg.norm(np.diff(points, axis=1), axis=2).sum(axis=1) <= tolerance
    kept = np.flatnonzero(~pole)
    pairs = cKDTree(points[kept, 2]).query_pairs(2 * tolerance, output_type="ndarray")
    first, second = kept[pairs[:, 0]], kept[pairs[:, 1]]
    same = np.abs(points[first] - points[second]).max(axis=(1, 2)) <= tolerance
    opposed = np.abs(points[first] - points[second, ::-1]).max(axis=(1, 2)) <= tolerance
    chosen = same | opposed
    first, second, opposed = first[chosen], second[chosen], opposed[chosen]
    count = np.bincount(np.concatenate([first, second]), minlength=len(points))
    simple = (count[first] == 1) & (count[second] == 1)
    return Joints(first[simple], second[simple], opposed[simple], np.flatnonzero((count == 0) & ~pole),
                  np.flatnonzero(count > 1), np.flatnonzero(pole), points, size)


def signs(count: int, first: np.ndarray, second: np.ndarray, agree: np.ndarray
         ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return signs of items that make the pairs agree, the component of each item, and the pairs that cannot.

    `agree` is True for a pair that needs equal signs. The first item of a component has the sign 1.
    """
    weight = np.ones(len(first), np.int8)
    graph = coo_array((weight, (first, second)), shape=(count, count))
    parts, component = connected_components(graph, directed=False)
    # Twice the items, i and its opposite i + count: consistent if the two are not connected.
    a = np.concatenate([first, first + count])
    b = np.concatenate([np.where(agree, second, second + count), np.where(agree, second + count, second)])
    doubled = coo_array((np.ones(len(a), np.int8), (a, b)), shape=(2 * count, 2 * count))
    side = connected_components(doubled, directed=False)[1]
    leader = np.full(parts, -1)
    order = np.arange(count)[::-1]
    leader[component[order]] = order
    sign = np.where(side[:count] == side[leader[component]], 1, -1)
    twisted = np.flatnonzero(side[first] == side[first + count]) if len(first) else np.array([], int)
    return sign, component, twisted


def orient(net: np.ndarray, joints: Joints) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return signs that give joined patches the same orientation, the body of each, and the joints that cannot."""
    return signs(len(net), joints.first // 4, joints.second // 4, joints.opposed)


def normals_along(net: np.ndarray, edge: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return the unit normals at the parameters t of the edges, (edge, t, 3), zero where there is none."""
    result = np.zeros((len(edge), len(t), 3))
    for k, place in enumerate(EDGES):
        chosen = edge % 4 == k
        area = areas_at(net[edge[chosen] // 4], *place(t))
        length = np.linalg.norm(area, axis=2, keepdims=True)
        result[chosen] = np.divide(area, length, out=np.zeros_like(area), where=length > 0)
    return result


def kinks(net: np.ndarray, joints: Joints) -> np.ndarray:
    """Return the largest angle between the normals on both sides of each joint, degrees."""
    t = np.array([0.1, 0.3, 0.5, 0.7, 0.9])
    a = normals_along(net, joints.first, t)
    b = normals_along(net, joints.second, t)
    flip = joints.opposed[:, None]
    b = np.where(flip[..., None], b[:, ::-1], b)
    angle = 2 * np.arctan2(np.linalg.norm(a - b, axis=2), np.linalg.norm(a + b, axis=2))
    return np.degrees(angle.max(axis=1)) if len(angle) else np.zeros(0)


def folded(net: np.ndarray) -> np.ndarray:
    """Return the patches whose normal turns by more than 90 degrees within them or vanishes in the middle."""
    place = np.linspace(0.02, 0.98, 7)
    u, v = (part.ravel() for part in np.meshgrid(place, place))
    result = []
    for start in range(0, len(net), 20000):
        area = areas_at(net[start:start + 20000], u, v)
        result.append((np.einsum("nkc,nc->nk", area, area.mean(axis=1)) <= 0).any(axis=1))
    return np.flatnonzero(np.concatenate(result)) if result else np.zeros(0, int)


def near_misses(net: np.ndarray, joints: Joints, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Return pairs of free edges that run beside each other, (edge, edge, distance in mm).

    They count if the points at 1/4, 1/2 and 3/4 of one lie within `reach`, and a quarter of its length, of the other.
    """
    free = joints.free
    if not len(free):
        return np.zeros((0, 2), int), np.zeros(0)
    t = np.linspace(0, 1, 17)
    fine = np.zeros((len(free), 17, 3))
    for k, place in enumerate(EDGES):
        chosen = free % 4 == k
        fine[chosen] = points_at(net[free[chosen] // 4], *place(t))
    length = np.linalg.norm(np.diff(fine, axis=1), axis=2).sum(axis=1)
    owner = np.repeat(np.arange(len(free)), 17)
    tree = cKDTree(fine.reshape(-1, 3))
    found: dict[Any, Any] = {}
    for i, edge in enumerate(free):
        limit = min(reach, length[i] / 4)
        step = length[i] / 16
        for j in set(owner[np.concatenate(tree.query_ball_point(fine[i, 4:13:4], limit + step))].astype(int)):
            if j == i or free[j] // 4 == edge // 4:
                continue
            distance = max(to_chords(point, fine[j]) for point in fine[i, 4:13:4])
            if distance <= limit:
                key = (min(i, j), max(i, j))
                found[key] = max(found.get(key, 0.0), distance)
    pairs = np.array([(free[i], free[j]) for i, j in found], int).reshape(-1, 2)
    return pairs, np.array(list(found.values()))


def to_chords(point: np.ndarray, line: np.ndarray) -> float:
    """Return the distance of a point from a line of chords."""
    start, along = line[:-1], np.diff(line, axis=0)
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    t = np.clip(((point - start) * along).sum(axis=1) / square, 0, 1)
    return np.linalg.norm(start + t[:, None] * along - point, axis=1).min()


def turn(net: np.ndarray, sign: np.ndarray) -> np.ndarray:
    """Return the patches, those of negative sign turned."""
    return np.where((sign < 0)[:, None, None, None], turned(net), net)
