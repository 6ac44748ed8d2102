# SPDX-License-Identifier: GPL-3.0-or-later
"""Distances from a surface of patches, and points that are at least at a distance from it."""
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from dd3.tools.surface import bernstein, bernstein_slope, points_at

# Patches that are tried around a point; samples that name them, and those along a patch; steps of the closest point.
TRIED, NAMING, MOST_SAMPLES, STEPS = 12, 200, 100, 12
# Rounds of linearised distances, and sweeps over them (Hildreth 1957).
ROUNDS, SWEEPS = 12, 80
# Last step over the distance.
SETTLED = 1e-7
# Steps towards the extreme point; height of the first point above the surface, and their length, over the distance.
PROXIMAL, START, STEP = 4, 0.05, 0.5
# Cosine of the angle between the normal and the way to a closest point above which it is one of the whole surface.
UPRIGHT = 0.98
# Part of the distance below which a point is on the surface.
TOUCHING = 1e-4


@dataclass
class Distance:
    """Distances from the patches of a surface (patch, v, u, 4), on the side of their normals."""

    net: np.ndarray
    spacing: float  # of the samples that name the nearest patches, mm

    def __post_init__(self) -> None:
        corner = self.net[:, ::2, ::2, :3] / self.net[:, ::2, ::2, 3:]
        length = np.stack([np.linalg.norm(np.diff(corner, axis=axis), axis=-1).max(axis=(1, 2)) for axis in (2, 1)])
        sides = np.clip(np.ceil(length / self.spacing), 2, MOST_SAMPLES).astype(int) + 1
        points, owner = [], []
        for in_u, in_v in np.unique(sides, axis=1).T:
            chosen = np.flatnonzero((sides[0] == in_u) & (sides[1] == in_v))
            u, v = (part.ravel() for part in np.meshgrid(np.linspace(0, 1, in_u), np.linspace(0, 1, in_v)))
            points.append(points_at(self.net[chosen], u, v).reshape(-1, 3))
            owner.append(np.repeat(chosen, in_u * in_v))
        self.owner = np.concatenate(owner)
        self.tree = cKDTree(np.concatenate(points))

    def feet(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the closest points of the patches nearest to points (n, 3), and the unit normals there (n, TRIED, 3);
        a patch may be there several times."""
        _, near = self.tree.query(points, k=min(NAMING, len(self.owner)))
        owner = self.owner[near]
        first = np.ones(owner.shape, bool)
        for k in range(1, owner.shape[1]):
            first[:, k] = (owner[:, :k] != owner[:, k:k + 1]).all(axis=1)
        order = np.argsort(~first, axis=1, kind="stable")[:, :TRIED]
        patch = np.take_along_axis(owner, order, axis=1)
        place, normal = closest(self.net[patch.ravel()], np.repeat(points, patch.shape[1], axis=0))
        return place.reshape(*patch.shape, 3), normal.reshape(*patch.shape, 3)

    def nearest(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the closest points of the surface and the unit normals there, (n, 3) each."""
        place, normal = self.feet(points)
        best = np.linalg.norm(place - points[:, None], axis=2).argmin(axis=1)
        row = np.arange(len(points))
        return place[row, best], normal[row, best]

    def upper_bound(self, points: np.ndarray) -> np.ndarray:
        """Return the distances of points (n, 3) from the patch of their nearest sample, mm: the surface may be closer
        elsewhere."""
        owner = self.owner[self.tree.query(points)[1]]
        return np.asarray(np.linalg.norm(closest(self.net[owner], points)[0] - points, axis=1))

    def permitted(self, points: np.ndarray, distance: float) -> np.ndarray:
        """Return the points nearest to points (n, 3) that are at least at a distance from the surface, on its side."""
        result = points.copy()
        left = np.arange(len(points))
        for _ in range(ROUNDS):
            normal, bound = self.half_spaces(result[left], distance)
            found = least_move(points[left], normal, bound)
            moving = np.abs(found - result[left]).max(axis=1) > SETTLED * distance
            result[left] = found
            left = left[moving]
            if not len(left):
                break
        return result

    def half_spaces(self, points: np.ndarray, distance: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the half-spaces normal . x >= bound (n, TRIED, 3), (n, TRIED) of the points that are at a distance
        from the patches, linear about points (n, 3)."""
        place, own = self.feet(points)
        normal = points[:, None] - place
        length = np.linalg.norm(normal, axis=2)
        normal /= np.maximum(length, 1e-300)[..., None]
        cosine = (normal * own).sum(axis=2)
        # Elsewhere a point of a neighbour is closer, but for the closest of all.
        upright = (np.abs(cosine) > UPRIGHT) | (length < TOUCHING * distance)
        turned = upright | (cosine < 0)
        normal[turned] = own[turned]
        upright[np.arange(len(points)), length.argmin(axis=1)] = True
        return normal, np.where(upright, (normal * place).sum(axis=2) + distance, -np.inf)

    def extreme(self, points: np.ndarray, normals: np.ndarray, distance: float) -> np.ndarray:
        """Return the points at a distance that are extreme against the normals, near points (n, 3) of the surface."""
        result = self.permitted(points + START * distance * normals, distance)
        for _ in range(PROXIMAL):
            result = self.permitted(result - STEP * distance * normals, distance)
        return result


def least_move(points: np.ndarray, normal: np.ndarray, bound: np.ndarray) -> np.ndarray:
    """Return the points nearest to points (n, 3) in the half-spaces normal . x >= bound (n, k, 3), (n, k)."""
    result = points.copy()
    weight = np.zeros(bound.shape)
    for _ in range(SWEEPS):
        before = result.copy()
        for k in range(bound.shape[1]):
            lack = bound[:, k] - (normal[:, k] * result).sum(axis=1)
            change = np.maximum(lack, -weight[:, k])
            weight[:, k] += change
            result += change[:, None] * normal[:, k]
        if np.abs(result - before).max(initial=0.0) < 1e-10 * np.abs(bound[np.isfinite(bound)]).max(initial=1.0):
            break
    return result


def closest(net: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the closest point of each patch (n, v, u, 4) to its point (n, 3), and the unit normal there."""
    start = np.linspace(0, 1, 5)
    u, v = (part.ravel() for part in np.meshgrid(start, start))
    best = np.linalg.norm(points_at(net, u, v) - points[:, None], axis=2).argmin(axis=1)
    uv = np.stack([u[best], v[best]], axis=1)
    left = np.arange(len(points))
    for _ in range(STEPS):
        uv[left], moved = stepped(net[left], points[left], uv[left])
        left = left[moved]  # another step of the others would give the same
        if not len(left):
            break
    place, along_u, along_v = tangents(net, uv)
    normal = np.cross(along_u, along_v)
    return place, normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)


def stepped(net: np.ndarray, points: np.ndarray, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the parameters of each patch (n, 2) after a step towards the point closest to its point (n, 3), and
    whether they changed (n,)."""
    place, along_u, along_v = tangents(net, uv)
    gap = points - place
    a, b, d = (along_u**2).sum(axis=1), (along_u * along_v).sum(axis=1), (along_v**2).sum(axis=1)
    right_u, right_v = (along_u * gap).sum(axis=1), (along_v * gap).sum(axis=1)
    # One parameter alone where the other is at its end.
    held_u = ((uv[:, 0] <= 0) & (right_u < 0)) | ((uv[:, 0] >= 1) & (right_u > 0))
    held_v = ((uv[:, 1] <= 0) & (right_v < 0)) | ((uv[:, 1] >= 1) & (right_v > 0))
    b = np.where(held_u | held_v, 0.0, b)
    regular = np.maximum(a * d - b * b, 1e-300)
    move = np.stack([np.where(held_u, 0.0, (d * right_u - b * right_v) / regular),
                     np.where(held_v, 0.0, (a * right_v - b * right_u) / regular)], axis=1)
    result = np.clip(uv + np.clip(move, -0.5, 0.5), 0.0, 1.0)
    return result, (result != uv).any(axis=1)


def tangents(net: np.ndarray, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the point and the tangents along u and v of each patch at its parameters (n, 2)."""
    values = []
    for in_v, in_u in ((bernstein(uv[:, 1]), bernstein(uv[:, 0])), (bernstein(uv[:, 1]), bernstein_slope(uv[:, 0])),
                       (bernstein_slope(uv[:, 1]), bernstein(uv[:, 0]))):
        values.append(np.einsum("na,nb,nabc->nc", in_v, in_u, net))
    weight = values[0][:, 3:]
    place = values[0][:, :3] / weight
    return place, *((slope[:, :3] - slope[:, 3:] * place) / weight for slope in values[1:])
