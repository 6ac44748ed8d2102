# SPDX-License-Identifier: GPL-3.0-or-later
"""Closest points of a CAD face, from the parameters of the patches' nodes by Newton's method."""
from typing import Any

import numpy as np

from dd3.tools.surface import grid

STEPS = 6
# Tangential distance, relative to the patch's size, above which the solution is not taken.
SETTLED = 1e-5


def closest(gmsh: Any, tag: int, points: np.ndarray, uv: np.ndarray, at_nodes: bool = False
           ) -> tuple[np.ndarray, np.ndarray]:
    """Return the closest points (patch, k, 3) and their parameters (patch, k, 2).

    points (patch, k, 3) on a regular grid of a patch each; uv (patch, 3, 3, 2): the parameters of its nodes, NaN where
    unknown: there, and where the iteration fails, the search is OpenCASCADE's, which is slow. With `at_nodes` the
    points are the nodes.
    """
    count = points.shape[1]
    start = uv.reshape(-1, 9, 2) if at_nodes else interpolated(uv, round(count**0.5))
    found, foot = start.copy(), points.copy()
    good = ~np.isnan(start).any(axis=(1, 2))
    if good.any():
        found[good], foot[good], settled = iterate(gmsh, tag, points[good], start[good])
        good[np.flatnonzero(good)[~settled]] = False
    if not good.all():
        there, parameters = gmsh.model.getClosestPoint(2, tag, points[~good].ravel())
        foot[~good] = np.reshape(there, (-1, count, 3))
        found[~good] = np.reshape(parameters, (-1, count, 2))
    return foot, found


def interpolated(uv: np.ndarray, side: int) -> np.ndarray:
    """Return the parameters at the points of a grid, by the quadratics through the nodes."""
    u, v = grid(side)
    along = [np.stack([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)], axis=-1) for t in (u, v)]
    return np.einsum("kj,ki,nijc->nkc", *along, uv)


def iterate(gmsh: Any, tag: int, points: np.ndarray, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return parameters, points and which patches have settled, after steps of Gauss and Newton."""
    size = np.ptp(points, axis=1).max(axis=1)
    uv = uv.copy()
    low, high = (np.array(bound) for bound in gmsh.model.getParametrizationBounds(2, tag))
    for step in range(STEPS + 1):
        foot = np.reshape(gmsh.model.getValue(2, tag, uv.ravel()), points.shape)
        slope = np.reshape(gmsh.model.getDerivative(2, tag, uv.ravel()), (*points.shape[:2], 2, 3))
        gap = points - foot
        right = np.einsum("nkac,nkc->nka", slope, gap)
        a, b, d = (np.einsum("nkc,nkc->nk", slope[:, :, i], slope[:, :, j]) for i, j in ((0, 0), (0, 1), (1, 1)))
        regular = a * d - b * b
        with np.errstate(divide="ignore", invalid="ignore"):
            move = np.stack([(d * right[..., 0] - b * right[..., 1]) / regular,
                             (a * right[..., 1] - b * right[..., 0]) / regular], axis=-1)
        move[~(regular > 1e-14 * a * d)] = 0.0
        # Within the face's bounds, as OpenCASCADE's search.
        move = np.clip(uv + move, np.minimum(low, uv), np.maximum(high, uv)) - uv
        left = np.linalg.norm(np.einsum("nka,nkac->nkc", move, slope), axis=2).max(axis=1)
        if step == STEPS or (left <= 1e-9 * size).all():
            break
        uv += move
    return uv, foot, left <= SETTLED * size
