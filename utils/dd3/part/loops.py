# SPDX-License-Identifier: GPL-3.0-or-later
"""Rims of a side of a part: its outer one with notches, and holes."""
from dataclasses import dataclass

import numpy as np

from dd3.part.shape import Shape, angle_between, unit

# Variation of the radius, relative, up to which a hole is round.
ROUND = 0.01
# Angle between the plane of an inner loop and the normals of the faces beside it below which the sheet stands across
# the loop, degrees: it is lanced there, cut along a line and formed on one side of it, or has a collar.
LANCED = 20.0
# Mean sign of the normals beside such a loop, away from its middle, above which it ends a wall around it.
COLLAR = 0.8
# Turn of a rim at a node that is a corner, that of a corner at the mouth of a notch, of its inside, and the change of
# the rim's direction from before to behind it, degrees.
CORNER, MOUTH, INSIDE, CHANGE = 2.0, 20.0, 80.0, 30.0


@dataclass
class Loop:
    """A closed rim: nodes in order, with the side on their left; edges; faces of the side beside it; length, mm; vector
    area, mm2, of the surface that it bounds."""

    nodes: np.ndarray
    edges: list[int]
    faces: list[int]
    length: float
    area: np.ndarray
    hole: "Hole | None" = None  # what it is as an inner loop, once that was asked


@dataclass
class Hole:
    """An inner loop: what it is, its diameter or its two sizes, mm, and its centre."""

    loop: Loop
    name: str
    size: tuple[float, ...]
    centre: np.ndarray

    @property
    def words(self) -> str:
        """Return the hole in words."""
        return f"{self.name} {' x '.join(f'{value:.4g}' for value in self.size)}"


@dataclass
class Notch:
    """A notch of the outer rim: width of its mouth and depth, mm, its place, and its edges."""

    width: float
    depth: float
    centre: np.ndarray
    edges: list[int]


def find_loops(shape: Shape, faces: list[int]) -> list[Loop]:
    """Return the rims of a side, that of the largest area, the outer one, first."""
    key = tuple(sorted(faces))
    if key not in shape.rims:
        shape.rims[key] = loops_of(shape, faces)
    return shape.rims[key]


def loops_of(shape: Shape, faces: list[int]) -> list[Loop]:
    """Find the rims of a side."""
    own = shape.of(faces)
    start, end = shape.triangles[own].ravel(), np.roll(shape.triangles[own], -1, axis=1).ravel()
    owner, piece = np.repeat(own, 3), shape.piece_of[own].ravel()
    count = len(shape.nodes)
    rim = np.flatnonzero(~np.isin(start * count + end, end * count + start))
    following: dict[int, list[int]] = {}
    for k in rim.tolist():
        following.setdefault(int(start[k]), []).append(k)
    found = []
    while following:
        here = next(iter(following))
        chain = []
        while here in following:
            k = following[here].pop()
            if not following[here]:
                del following[here]
            chain.append(k)
            here = int(end[k])
        nodes = start[chain]
        points = shape.nodes[nodes]
        edges = shape.piece_edge[piece[chain][piece[chain] >= 0]]
        found.append(Loop(nodes, sorted(set(edges.tolist())), sorted(set(shape.face[owner[chain]].tolist())),
                          float(np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1).sum()),
                          np.cross(points - points[0], np.roll(points, -1, axis=0) - points[0]).sum(axis=0) / 2))
    return sorted(found, key=lambda loop: -np.linalg.norm(loop.area))


def hole_of(shape: Shape, loop: Loop) -> Hole:
    """Return what an inner loop is."""
    if loop.hole is None:
        loop.hole = named_hole(shape, loop)
    return loop.hole


def named_hole(shape: Shape, loop: Loop) -> Hole:
    """Find what an inner loop is."""
    points = shape.nodes[loop.nodes]
    normal = unit(loop.area)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    inplane = points - points.mean(axis=0)
    inplane -= (inplane @ normal)[:, None] * normal
    radius = np.linalg.norm(inplane - (inplane.max(axis=0) + inplane.min(axis=0)) / 2, axis=1)
    axes = np.linalg.eigh(inplane.T @ inplane)[1].T[1:]
    size = sorted((float(np.ptp(inplane @ axis)) for axis in axes), reverse=True)
    beside = shape.of(loop.faces)
    near = beside[shape.marked(loop.nodes)[shape.triangles[beside]].any(axis=1)]
    level = np.abs(shape.normal[near] @ normal)
    if np.average(level, weights=shape.area[near]) < np.sin(np.radians(LANCED)):
        outwards = np.sign(((shape.place[near] - middle) * shape.normal[near]).sum(axis=1))
        collar = abs(np.average(outwards, weights=shape.area[near])) > COLLAR
        return Hole(loop, "collar" if collar else "lanced", tuple(size), middle)
    if len(points) > 4 and np.ptp(radius) <= ROUND * radius.mean():
        return Hole(loop, "round", (2 * float(radius.mean()),), middle)
    return Hole(loop, "opening", tuple(size), middle)


def turns(shape: Shape, faces: list[int], loop: Loop) -> np.ndarray:
    """Return the turn of a rim of a side at its nodes within the side, degrees, positive where it is convex."""
    own = shape.of(faces)
    corners = shape.nodes[shape.triangles[own]]
    angle = np.stack([angle_between(corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k])
                      for k in range(3)], axis=1)
    total = np.zeros(len(shape.nodes))
    np.add.at(total, shape.triangles[own], angle)
    return np.asarray(180.0 - total[loop.nodes])


def find_notches(shape: Shape, faces: list[int], loop: Loop) -> list[Notch]:
    """Return the notches of the outer rim: stretches in which it turns inwards between two corners, and goes on in
    about its direction behind them."""
    turn, edge = turns(shape, faces, loop), edges_of_rim(shape, loop)
    corner = np.flatnonzero(np.abs(turn) > CORNER)
    found = []
    for inside in inward_runs(turn[corner]):
        before, turn_before = mouth(turn[corner], inside, -1)
        after, turn_after = mouth(turn[corner], inside, 1)
        whole = turn[corner][inside].sum()
        if whole > -INSIDE or min(turn_before, turn_after) < MOUTH or abs(turn_before + whole + turn_after) > CHANGE:
            continue
        first, last = (outside_of(edge, turn, int(corner[k]), step) for k, step in ((before, -1), (after, 1)))
        ends = shape.nodes[loop.nodes[[first, last]]]
        along = unit(ends[1] - ends[0])
        away = shape.nodes[loop.nodes[corner[inside]]] - ends[0]
        depth = float(np.linalg.norm(away - (away @ along)[:, None] * along, axis=1).max())
        found.append(Notch(float(np.linalg.norm(ends[1] - ends[0])), depth, ends.mean(axis=0),
                           edges_between(edge, first, last)))
    return found


def edges_of_rim(shape: Shape, loop: Loop) -> np.ndarray:
    """Return the edge of each piece of a rim, from one of its nodes to the next, -1 of a piece on none."""
    pairs = np.sort(np.stack([loop.nodes, np.roll(loop.nodes, -1)], axis=1), axis=1)
    weights = np.array([len(shape.nodes), 1])
    own = np.sort(shape.pieces, axis=1) @ weights
    order = np.argsort(own)
    at = order[np.minimum(np.searchsorted(own, pairs @ weights, sorter=order), len(own) - 1)]
    return np.where(own[at] == pairs @ weights, shape.piece_edge[at], -1)


def edges_between(edge: np.ndarray, first: int, last: int) -> list[int]:
    """Return the edges of a rim, of each piece of it, between two of its nodes, by their places in it."""
    places = np.arange(first, last if last > first else last + len(edge)) % len(edge)
    return sorted(set(edge[places].tolist()) - {-1})


def outside_of(edge: np.ndarray, turn: np.ndarray, node: int, step: int) -> int:
    """Return the node of a rim at which the mouth of a notch ends, in one direction from the first corner that turns
    outwards: that corner, or of a rounded mouth the far end of the edge that turns there."""
    # Of the pieces in this direction from the nodes.
    beyond = edge if step > 0 else np.roll(edge, 1)
    rounded, here = beyond[node], node
    if turn[node] > MOUTH or rounded < 0:
        return node
    while beyond[here] == rounded and turn[(here + step) % len(edge)] > 0:
        here = (here + step) % len(edge)
    return here


def inward_runs(turn: np.ndarray) -> list[np.ndarray]:
    """Return the runs of corners at which a loop turns inwards one after the other."""
    inward = turn < 0
    if inward.all() or not inward.any():
        return []
    first = int(np.flatnonzero(~inward)[0])
    order = np.roll(np.arange(len(turn)), -first)
    parts = np.split(order, np.flatnonzero(np.diff(inward[order])) + 1)
    return [part for part in parts if inward[part[0]]]


def mouth(turn: np.ndarray, inside: np.ndarray, step: int) -> tuple[int, float]:
    """Return the corner nearest to a run at which the mouth of a notch begins, in one direction around the loop, and
    the turn there: of all corners that turn outwards up to half of what the run turns inwards."""
    most = -turn[inside].sum() / 2 + CHANGE / 2
    here = int(inside[0] if step < 0 else inside[-1])
    total, nearest = 0.0, (here + step) % len(turn)
    for i in range(1, len(turn)):
        value = turn[(here + step * i) % len(turn)]
        if value < 0 or total + value > most:
            break
        total += value
    return nearest, float(total)
