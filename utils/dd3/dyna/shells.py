# SPDX-License-Identifier: GPL-3.0-or-later
"""Quadrilateral shells as a sheet: one orientation, and the vectors across its thickness."""
from collections.abc import Sequence

import numpy as np

from dd3.bound import Bound, rings
from dd3.dyna.mesh import Cell
from dd3.errors import Problem

STEEPEST = 0.5  # least cosine between the vector across the sheet at a node and the normal of an element


def ordered(quads: np.ndarray, bound: Bound, weight: np.ndarray | None = None) -> np.ndarray:
    """Return whether each quadrilateral (m, 4) is to be turned over, so that all that are joined have one side.

    weight (m): that side has the larger sum of the weights, each with its sign; without it that of more elements.
    """
    edges: dict[tuple[int, int], list[tuple[int, bool]]] = {}
    for i, ring in enumerate(rings(quads, bound)):
        for a, b in zip(ring, ring[1:] + ring[:1]):
            edges.setdefault((min(a, b), max(a, b)), []).append((i, a < b))
    neighbours: list[list[tuple[int, bool]]] = [[] for _ in quads]
    for sides in edges.values():
        if len(sides) == 2:
            (i, one), (j, other) = sides
            neighbours[i].append((j, one == other))
            neighbours[j].append((i, one == other))
    turned, seen = np.zeros(len(quads), bool), np.zeros(len(quads), bool)
    signed = np.ones(len(quads)) if weight is None else weight
    for start in range(len(quads)):
        if seen[start]:
            continue
        group, seen[start] = [start], True
        for i in group:  # grows
            for j, against in neighbours[i]:
                if not seen[j]:
                    seen[j], turned[j] = True, turned[i] != against
                    group.append(j)
        if np.where(turned[group], -signed[group], signed[group]).sum() < 0:
            turned[group] = ~turned[group]
    return turned


def element_normals(middle: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Return the unit normals of quadrilaterals."""
    a, b, c, d = (middle[quads[:, k]] for k in range(4))
    normal = np.cross(c - a, d - b)
    return np.asarray(normal / np.linalg.norm(normal, axis=1)[:, None])


def across(cells: Sequence[Cell], middle: np.ndarray, quads: np.ndarray, thickness: np.ndarray) -> np.ndarray:
    """Return the vector from the lower to the upper face at each node of a sheet (n, 3), whose thicknesses (m, 4) lie
    across its elements: it is longer than these where the elements of a node are inclined against one another."""
    with np.errstate(all="ignore"):
        normal = element_normals(middle, quads)
    if not (flat := np.isfinite(normal).all(axis=1)).all():
        cell = cells[int(np.flatnonzero(~flat)[0])]
        raise Problem(f"{cell.place}: error: shell {cell.label} has no area")
    director, share, weight = np.zeros_like(middle), np.zeros(len(middle)), np.zeros(len(middle))
    for k in range(4):
        np.add.at(director, quads[:, k], normal)
    length = np.linalg.norm(director, axis=1)
    if not (length > 1e-6).all():
        cell = cells[int(np.flatnonzero((quads == int(length.argmin())).any(axis=1))[0])]
        raise Problem(f"{cell.place}: error: the normals of the shells at a node of shell {cell.label} cancel each "
                      "other: the sheet is folded, or three shells have one edge")
    director /= length[:, None]
    for k in range(4):
        inclined = (director[quads[:, k]] * normal).sum(axis=1)
        np.add.at(share, quads[:, k], thickness[:, k] / np.maximum(inclined, STEEPEST))
        np.add.at(weight, quads[:, k], 1.0)
    return np.asarray((share / weight)[:, None] * director)
