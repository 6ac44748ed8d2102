# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces of Bézier patches of degree 2 in u and v, rational or not: evaluation, degree reduction, .bez files.

Planes, cylinders and all else of a lower degree are raised to degree 2 exactly, so that one array holds a surface;
`write` lowers the degree again where that is exact.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from math import comb
from pathlib import Path
from typing import Any

import numpy as np

from dd3.errors import Problem
from dd3.tools.blocks import lines_of

Patches = list[tuple[np.ndarray, np.ndarray]]  # points (v, u, 3) and weights (v, u)

# Bernstein coefficients of the quadratic through the values at 0, 1/2, 1.
FROM_NODES = np.array([[1, 0, 0], [-0.5, 2, -0.5], [0, 0, 1]])
# Barycentric coordinates of the points of the three quadrilaterals of a triangle: corner, edge, centre, edge.
THIRDS = np.array([[[1, 0, 0], [.5, .5, 0], [1 / 3, 1 / 3, 1 / 3], [.5, 0, .5]],
                   [[0, 1, 0], [0, .5, .5], [1 / 3, 1 / 3, 1 / 3], [.5, .5, 0]],
                   [[0, 0, 1], [.5, 0, .5], [1 / 3, 1 / 3, 1 / 3], [0, .5, .5]]])
# Relative error up to which a lower degree counts as exact.
EXACT = 1e-13


@dataclass
class Surface:
    """Patches in homogeneous control points (patch, v, u, 4): w x, w y, w z, w; the face of each, and their names; unit
    normals at the nodes (patch, v, u, 3), where those of the CAD are known."""

    net: np.ndarray
    face: np.ndarray
    names: list
    notes: list = field(default_factory=list)  # lines of the report
    normals: np.ndarray | None = None

    def select(self, chosen: np.ndarray) -> Surface:
        """Return the surface of some patches."""
        return Surface(self.net[chosen], self.face[chosen], self.names, self.notes,
                       None if self.normals is None else self.normals[chosen])


def joined(surfaces: list[Surface]) -> Surface:
    """Return several surfaces as one."""
    start = np.cumsum([0] + [len(surface.names) for surface in surfaces])
    return Surface(np.concatenate([surface.net for surface in surfaces]),
                   np.concatenate([surface.face + first for surface, first in zip(surfaces, start)]),
                   [name for surface in surfaces for name in surface.names],
                   [note for surface in surfaces for note in surface.notes])


def homogeneous(points: np.ndarray, weights: np.ndarray | None = None) -> np.ndarray:
    """Return points (..., 3) and weights (...) as homogeneous coordinates (..., 4)."""
    weights = np.ones(np.shape(points)[:-1]) if weights is None else np.asarray(weights, float)
    return np.concatenate([points * weights[..., None], weights[..., None]], axis=-1)


def bernstein(t: np.ndarray, degree: int = 2) -> np.ndarray:
    """Return the Bernstein polynomials (..., degree + 1) at t."""
    t = np.asarray(t, float)
    return np.stack([comb(degree, k) * t**k * (1 - t)**(degree - k) for k in range(degree + 1)], axis=-1)


def points_on(points: np.ndarray, weights: np.ndarray, v: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return the points (..., len(v), len(u), 3) of patches of any degree at a grid of their parameters, given their
    points (..., v, u, 3) and weights (..., v, u)."""
    in_v, in_u = (bernstein(t, size - 1) for t, size in zip((v, u), weights.shape[-2:]))
    above = np.einsum("ai,bj,...ijc->...abc", in_v, in_u, points * weights[..., None])
    return np.asarray(above / np.einsum("ai,bj,...ij->...ab", in_v, in_u, weights)[..., None])


def bernstein_slope(t: np.ndarray) -> np.ndarray:
    """Return the derivatives of the quadratic ones."""
    t = np.asarray(t, float)
    return np.stack([2 * t - 2, 2 - 4 * t, 2 * t], axis=-1)


def combined(in_v: np.ndarray, in_u: np.ndarray, net: np.ndarray) -> np.ndarray:
    """Return the sums (patch, k, 4) of the control points with the products of two sets of factors (k, 3)."""
    factors = (in_v[:, :, None] * in_u[:, None, :]).reshape(len(in_v), 9)
    return factors @ np.ascontiguousarray(net).reshape(len(net), 9, 4)


def points_at(net: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return the points (patch, len(u), 3) of the patches at the parameters u and v, arrays of equal length."""
    values = combined(bernstein(v), bernstein(u), net)
    return values[..., :3] / values[..., 3:]


def areas_at(net: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return S_u x S_v (patch, len(u), 3), the normal not divided by its length."""
    value = combined(bernstein(v), bernstein(u), net)
    along_u = combined(bernstein(v), bernstein_slope(u), net)
    along_v = combined(bernstein_slope(v), bernstein(u), net)
    point, weight = value[..., :3] / value[..., 3:], value[..., 3:]
    slope_u = (along_u[..., :3] - along_u[..., 3:] * point) / weight
    slope_v = (along_v[..., :3] - along_v[..., 3:] * point) / weight
    return np.cross(slope_u, slope_v)


def normals_at_nodes(net: np.ndarray) -> np.ndarray:
    """Return the unit normals of patches at their 3 x 3 nodes (patch, 3, 3, 3), zero where there is none."""
    area = areas_at(net, *grid(3))
    return np.asarray(area / np.maximum(np.linalg.norm(area, axis=2, keepdims=True), 1e-300)).reshape(-1, 3, 3, 3)


def grid(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return u and v of the points of a regular grid with `count` points on a side."""
    u, v = np.meshgrid(np.linspace(0, 1, count), np.linspace(0, 1, count))
    return u.ravel(), v.ravel()


def area_vectors(net: np.ndarray) -> np.ndarray:
    """Return the integral of the normal over each patch, mm2, by 3 x 3 Gauss points."""
    place = np.array([0.5 - np.sqrt(0.15), 0.5, 0.5 + np.sqrt(0.15)])
    weight = np.array([5, 8, 5]) / 18
    u, v = np.meshgrid(place, place)
    return np.einsum("nkc,k->nc", areas_at(net, u.ravel(), v.ravel()), np.outer(weight, weight).ravel())


def turned(net: np.ndarray) -> np.ndarray:
    """Return the patches with their normals turned: u reversed."""
    return net[:, :, ::-1]


def from_nodes(nodes: np.ndarray) -> np.ndarray:
    """Return the patches through 3 x 3 nodes each (patch, v, u, 3) at the parameters 0, 1/2 and 1."""
    return homogeneous(np.einsum("ai,bj,nijc->nabc", FROM_NODES, FROM_NODES, nodes))


def from_triangles(corners: np.ndarray, middles: np.ndarray) -> np.ndarray:
    """Return the three patches of each quadratic Bézier triangle, exactly.

    corners (n, 3, 3); middles (n, 3, 3): the control points of the edges 01, 12, 20. On a quadrilateral of the
    triangle the barycentric coordinates are bilinear in u and v, so the surface is of degree 2 in each.
    """
    u, v = grid(3)
    bilinear = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=-1)
    patches = []
    for part in THIRDS:
        a, b, c = (bilinear @ part).T
        weights = np.stack([a * a, b * b, c * c, 2 * a * b, 2 * b * c, 2 * c * a], axis=-1)
        nodes = np.einsum("ks,nsc->nkc", weights, np.concatenate([corners, middles], axis=1))
        patches.append(from_nodes(nodes.reshape(-1, 3, 3, 3)))
    return np.stack(patches, axis=1).reshape(-1, 3, 3, 4)


def quarters(net: np.ndarray) -> np.ndarray:
    """Return the four patches of each patch, divided at the middles of u and v, exactly."""
    low = np.array([[1, 0, 0], [.5, .5, 0], [.25, .5, .25]])
    high = low[::-1, ::-1]
    parts = [np.einsum("ai,bj,nijc->nabc", a, b, net) for a in (low, high) for b in (low, high)]
    return np.stack(parts, axis=1).reshape(-1, 3, 3, 4)


def lowered(patch: np.ndarray) -> np.ndarray:
    """Return a patch (v, u, 4) without the degrees it does not need."""
    scale = np.abs(patch).max()
    if np.abs(patch[:, 1] - (patch[:, 0] + patch[:, 2]) / 2).max() <= EXACT * scale:
        patch = patch[:, ::2]
    if np.abs(patch[1] - (patch[0] + patch[2]) / 2).max() <= EXACT * scale:
        patch = patch[::2]
    return patch


def write(path: Path, surface: Surface, header: list[str]) -> None:
    """Write a .bez file; the header's lines and the faces are comments."""
    with path.open("w", encoding="utf-8") as file:
        file.writelines(f"# {line}\n" for line in header)
        last = None
        for patch, face in zip(surface.net, surface.face):
            if face != last:
                file.write(f"# {surface.names[face]}\n")
                last = face
            write_patch(file, lowered(patch))


def write_patch(file: Any, patch: np.ndarray) -> None:
    """Write one patch; equal weights are left out."""
    weights = patch[..., 3]
    rational = np.ptp(weights) > EXACT * weights.max()
    file.write(f"patch {patch.shape[1] - 1} {patch.shape[0] - 1}{' rational' if rational else ''}\n")
    points = np.concatenate([patch[..., :3] / weights[..., None] + 0.0, weights[..., None] / weights.flat[0]], axis=2)
    rows = points.reshape(-1, 4)[:, :4 if rational else 3]
    line = " ".join(["%.12g"] * rows.shape[1]) + "\n"
    file.write(line * len(rows) % tuple(rows.ravel().tolist()))


def read_patches(path: str | Path) -> Patches:
    """Return the patches of a .bez file."""
    try:
        return patches_of([line.split() for line in lines_of(path)])
    except (ValueError, IndexError):
        raise Problem(f"{path}: not a file of Bézier patches") from None


def patches_of(lines: list[list[str]]) -> Patches:
    """Return the patches of the words of the lines of a .bez file; ValueError or IndexError if they are not."""
    patches, i = [], 0
    while i < len(lines):
        if lines[i][0].lower() != "patch":
            raise ValueError
        m, n = int(lines[i][1]), int(lines[i][2])
        width, count = 4 if len(lines[i]) > 3 else 3, (m + 1) * (n + 1)
        rows = np.array([[float(t.lower().replace("d", "e")) for t in row] for row in lines[i + 1:i + 1 + count]])
        rows = rows.reshape(n + 1, m + 1, width)
        patches.append((rows[..., :3], rows[..., 3] if width == 4 else np.ones((n + 1, m + 1))))
        i += 1 + count
    return patches
