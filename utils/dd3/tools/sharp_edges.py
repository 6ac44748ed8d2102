# SPDX-License-Identifier: GPL-3.0-or-later
"""Concave sharp edges of a surface, valleys, that a ball rolls along: patches on both sides of them, arcs between, and
parts of spheres where three or more meet."""
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from dd3.tools.nagata import groups
from dd3.tools.patch_distance import Distance
from dd3.tools.rims import bands_of

# Cosine of the angle between the normals at a sharp edge.
SHARP = np.cos(np.radians(5.0))
# Cosine of the angle between a valley and the way to a corner at its end; reach of the displacement from there over its
# largest value.
ALIGNED, DECAY = 0.95, 3.0


@dataclass
class Patches:
    """Patches of a surface: nodes (patch, 3, 3, 3), unit normals there, on the side of the patches' own ones, plain
    displacements of the nodes, and node numbers (patch, 3, 3)."""

    nodes: np.ndarray
    normals: np.ndarray
    shift: np.ndarray
    labels: np.ndarray

    def sides(self, values: np.ndarray) -> np.ndarray:
        """Return the values (patch, 3, 3, ...) along the four edges, anticlockwise: (patch, 4, 3, ...)."""
        return np.stack([values[:, 0], values[:, :, 2], values[:, 2, ::-1], values[:, ::-1, 0]], axis=1)

    def pairs(self) -> np.ndarray:
        """Return the pairs of edges, patch * 4 + edge, that two patches share (n, 2)."""
        ends = np.sort(self.sides(self.labels)[:, :, ::2], axis=2).reshape(-1, 2)
        order = np.lexsort(ends.T)
        same = (ends[order[1:]] == ends[order[:-1]]).all(axis=1) & (ends[order[1:], 0] != ends[order[1:], 1])
        return np.stack([order[:-1][same], order[1:][same]], axis=1)

    def valleys(self) -> np.ndarray:
        """Return the pairs of edges at which the surface has a concave sharp edge (n, 2)."""
        pairs = self.pairs()
        first, second = pairs.T
        normal = self.sides(self.normals)[:, :, 1].reshape(-1, 3)
        middle = self.sides(self.nodes)[:, :, 1].reshape(-1, 3)
        cosine = (normal[first] * normal[second]).sum(axis=1)
        into = self.nodes[second // 4, 1, 1] - middle[first]
        return pairs[(cosine < SHARP) & ((into * normal[first]).sum(axis=1) > 0)]

    def split(self, valleys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return node numbers that are shared only across edges that are no valleys (patch, 3, 3), and those of the
        valleys on both sides, in the direction of the first patch (n, 2, 3)."""
        entry = np.arange(self.labels.size).reshape(self.labels.shape)
        along = self.sides(entry).reshape(-1, 3)
        pairs = self.pairs()
        smooth = pairs[~np.isin(pairs[:, 0] * 4 * len(self.nodes) + pairs[:, 1],
                                valleys[:, 0] * 4 * len(self.nodes) + valleys[:, 1])]
        # The edges of neighbours run against each other.
        number = groups(entry.size, along[smooth[:, 0]].ravel(), along[smooth[:, 1], ::-1].ravel())
        number = number.reshape(self.labels.shape)
        sides = number.ravel()[along]
        return number, np.stack([sides[valleys[:, 0]], sides[valleys[:, 1], ::-1]], axis=1)


def rounding(valley: np.ndarray, result: np.ndarray, normal: np.ndarray, point: np.ndarray, radius: float,
             tolerance: float) -> np.ndarray:
    """Return the nodes (n, 3, 3, 3) of patches between both sides of valleys (n, 2, 3), numbers of nodes: arcs of the
    ball, and parts of spheres where three or more valleys meet."""
    if not len(valley):
        return np.zeros((0, 3, 3, 3))
    angle = np.arccos(np.clip((normal[valley[:, 0]] * normal[valley[:, 1]]).sum(axis=2), -1, 1)).max()
    halves = (bands_of(float(angle), radius, tolerance) + 1) // 2
    centre = result + radius * normal
    parts = np.linspace(0, 1, 4 * halves + 1)
    strips = np.stack([mixed(centre, normal, valley[:, 0], valley[:, 1], part, radius) for part in parts], axis=1)
    found = [strips[:, 2 * i:2 * i + 3] for i in range(2 * halves)]
    facing = [np.broadcast_to(normal[valley[:, 0, 1]] + normal[valley[:, 1, 1]], (len(valley), 3))] * len(found)
    for ring in corners(valley, point):
        whole = [normal[ring], np.roll(normal[ring], -1, axis=0), np.roll(normal[ring], 1, axis=0)]
        top = normal[ring].sum(axis=0) / np.linalg.norm(normal[ring].sum(axis=0))
        middle = centre[ring].mean(axis=0)
        for own, following, before in zip(*whole):
            ways = sphere(own, following, before, top, 2 * halves)
            places = middle - radius * ways
            blocks = [places[2 * i:2 * i + 3, 2 * k:2 * k + 3] for i in range(halves) for k in range(halves)]
            found.append(np.array(blocks))
            facing.append(np.broadcast_to(top, (len(blocks), 3)))
    nodes = np.concatenate(found)
    across = np.cross(nodes[:, 1, 2] - nodes[:, 1, 0], nodes[:, 2, 1] - nodes[:, 0, 1])
    flip = (across * np.concatenate(facing)).sum(axis=1) < 0
    nodes[flip] = nodes[flip][:, :, ::-1]
    return nodes


def along_valleys(surface: Distance, valley: np.ndarray, point: np.ndarray, normal: np.ndarray, reach: float
                  ) -> np.ndarray:
    """Return displacements of the nodes of valleys (n, 2, 3) along them, away from corners, where the ball comes to
    rest at a distance from the corner; they fall linearly from there. No others are displaced."""
    result = np.zeros_like(point)
    rings = corners(valley, point)
    if not rings:
        return result
    place = np.array([point[ring[0]] for ring in rings])
    rest = np.array([surface.extreme(point[ring], normal[ring], reach).mean(axis=0) for ring in rings])
    apart = cKDTree(place).query(place, k=2)[0][:, 1]
    for nodes in (valley[:, side, k] for side in (0, 1) for k in range(3)):
        along = point[valley[:, 0, 2]] - point[valley[:, 0, 0]]
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        for corner, centre, free in zip(place, rest, apart):
            way = point[nodes] - corner
            length = np.linalg.norm(way, axis=1)
            chosen = (length > 0) & (np.abs((way * along).sum(axis=1)) > ALIGNED * length)
            way = way[chosen] / length[chosen, None]
            shift = (centre - corner) @ way.T
            part = 1 - length[chosen] / np.minimum(DECAY * np.maximum(shift, 1e-300), free / 2)
            # A node is in the reach of one corner at most.
            near = (part > 0) & (shift > 0)
            result[nodes[chosen][near]] = (shift * part)[near, None] * way[near]
    return result


def mixed(centre: np.ndarray, normal: np.ndarray, first: np.ndarray, second: np.ndarray, part: float, radius: float
          ) -> np.ndarray:
    """Return the points of arcs from the nodes `first` to the nodes `second` at a part of their angle."""
    return (1 - part) * centre[first] + part * centre[second] - radius * between(normal[first], normal[second], part)


def between(first: np.ndarray, second: np.ndarray, part: float | np.ndarray) -> np.ndarray:
    """Return the unit vectors at a part of the angle between unit vectors."""
    angle = np.arccos(np.clip((first * second).sum(axis=-1, keepdims=True), -1, 1))
    small = angle < 1e-9
    sine = np.where(small, 1.0, np.sin(angle))
    return np.where(small, (1 - part) * first + part * second,
                    (np.sin((1 - part) * angle) * first + np.sin(part * angle) * second) / sine)


def corners(valley: np.ndarray, point: np.ndarray) -> list[list[int]]:
    """Return the rings of nodes, at one point each, around which three or more valleys (n, 2, 3) meet."""
    following: dict[int, int] = {}
    for (a, _, b), (c, _, d) in valley.tolist():
        # Anticlockwise about its end, a valley leads from the right side of it to the left.
        following[c] = a
        following[b] = d
    rings, left = [], set(following)
    while left:
        ring = [left.pop()]
        while (after := following.get(ring[-1])) in left:
            left.remove(after)
            ring.append(after)
        if len(ring) > 2 and following.get(ring[-1]) == ring[0] and np.ptp(point[ring], axis=0).max() < 1e-9 + 1e-9 * \
                np.abs(point[ring]).max():
            rings.append(ring)
    return rings


def sphere(own: np.ndarray, following: np.ndarray, before: np.ndarray, top: np.ndarray, count: int) -> np.ndarray:
    """Return unit vectors (count + 1, count + 1, 3) between one at a corner, the middles of the arcs to its neighbours,
    and the top of the ring: arcs at the sides, blended between (Coons 1967)."""
    t = np.linspace(0, 1, count + 1)[:, None]
    right, up = between(own, following, t / 2), between(own, before, t / 2)
    far_right, far_up = between(right[-1], top, t), between(up[-1], top, t)
    u, v = t[None], t[:, None]
    ways = ((1 - v) * right[None] + v * far_up[None] + (1 - u) * up[:, None] + u * far_right[:, None]
            - (1 - u) * (1 - v) * own - u * (1 - v) * right[-1] - (1 - u) * v * up[-1] - u * v * top)
    result: np.ndarray = ways / np.linalg.norm(ways, axis=2, keepdims=True)
    return result
