# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat patches between curves of a horizontal plane, by Gmsh."""
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from dd3.errors import Problem
from dd3.tools.division import OPTIONS
from dd3.tools.joints import folded
from dd3.tools.surface import from_nodes

# Elements along an outer straight side at least.
ALONG = 4
# What is tried, one after the other, until a mesh keeps to its borders and has no folds: parts of the size; of each,
# Gmsh's numbers of the pairing of triangles, by Blossom or a simple one, and of the exchange and shift of elements.
SMALLER, RECOMBINED = (1.0, 0.7, 0.5), ((1, 5), (1, 0), (0, 0))
# Distance of points that are one, over the size; relative difference of equal areas.
SAME_POINT = 1e-9
SAME_AREA = 1e-9


@dataclass
class Side:
    """A part of a closed line: its points (n, 2), n > 1. A curve consists of quadratic pieces, given by their ends and
    middles, an even number of them; a straight side of its ends."""

    points: np.ndarray
    curved: bool


def straight(start: np.ndarray, end: np.ndarray) -> Side:
    """Return a straight side."""
    return Side(np.array([start, end]), False)


def box(points: np.ndarray, margin: float) -> list[Side]:
    """Return the rectangle around points (n, 2) at a distance, anticlockwise."""
    (x0, y0), (x1, y1) = points.min(axis=0) - margin, points.max(axis=0) + margin
    corner = np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])
    return [straight(a, b) for a, b in zip(corner, np.roll(corner, -1, axis=0))]


def chords(loop: list[Side]) -> np.ndarray:
    """Return the corners of a closed line (n, 2); a curve has one at the ends of each pair of pieces."""
    return np.concatenate([side.points[:-1:4 if side.curved else 1] for side in loop])


def flat(gmsh: Any, loops: list[list[Side]], size: float) -> np.ndarray:
    """Return the nodes (patch, 3, 3, 3) of flat patches at z = 0 between closed lines, the first one around the others;
    their edges on the curves are the pieces of these, others about as long as `size` at most, mm. Normals point
    upwards."""
    for i, loop in enumerate(loops):
        corner = chords(loop)
        if crosses(corner) or is_folded(corner) or (i and not inside(corner, chords(loops[0])).all()):
            raise Problem("the flange crosses itself: take a smaller --flange, or a smaller --shoulder")
    gmsh.model.add("plane")
    first = None
    try:
        for corners in meshes(gmsh, loops, size):
            nodes = patches_of(corners, loops)
            first = nodes if first is None else first
            # An element with two edges on a curve that is hollow for it has an angle above 180 degrees there.
            if not len(folded(from_nodes(nodes))):
                return nodes
    finally:
        gmsh.model.remove()
    if first is None:
        raise Problem("Gmsh's mesh of the flange does not keep to its borders: take another --flange or --shoulder")
    return first


def patches_of(corners: np.ndarray, loops: list[list[Side]]) -> np.ndarray:
    """Return the nodes (patch, 3, 3, 3) of patches with corners (patch, 4, 2), on the curves at these."""
    nodes = np.zeros((len(corners), 3, 3, 3))
    square = np.stack([[corners[:, 0], corners[:, 1]], [corners[:, 3], corners[:, 2]]])
    nodes[:, ::2, ::2, :2] = square.transpose(2, 0, 1, 3)
    fit_corners(nodes, loops)
    fit_middles(nodes, loops)
    a, b = nodes[:, 0, 2, :2] - nodes[:, 0, 0, :2], nodes[:, 2, 0, :2] - nodes[:, 0, 0, :2]
    area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    nodes[area < 0] = nodes[area < 0][:, :, ::-1]
    return nodes


def meshes(gmsh: Any, loops: list[list[Side]], size: float) -> Iterator[np.ndarray]:
    """Give the corners (element, 4, 2) of quadrilaterals between closed lines of chords, of one mesh after the other;
    each chord has two.

    Gmsh's exchange and shift of elements takes nodes out of the border where two chords are near a line, and its
    elements may reach over a short chord between long ones.
    """
    geo = gmsh.model.geo
    tags = []
    for loop in loops:
        corner = chords(loop)
        points = [geo.addPoint(x, y, 0.0) for x, y in corner]
        lines = [geo.addLine(a, b) for a, b in zip(points, points[1:] + points[:1])]
        count = iter(lines)
        for side in loop:
            of_side = [next(count) for _ in side.points[:-1:4 if side.curved else 1]]
            length = float(np.linalg.norm(side.points[-1] - side.points[0]))
            pieces = 1 if side.curved else max(ALONG, int(np.ceil(length / size)))
            for line in of_side:
                geo.mesh.setTransfiniteCurve(line, pieces + 1)
        tags.append(geo.addCurveLoop(lines))
    surface = geo.addPlaneSurface(tags)
    geo.synchronize()
    for name, value in OPTIONS.items():
        gmsh.option.setNumber(name, value)
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMin", 0.0)
    gmsh.model.mesh.setSizeCallback(lambda dim, tag, x, y, z, size: size)
    within = area_of(chords(loops[0])) - sum(area_of(chords(loop)) for loop in loops[1:])
    for part, (pairing, exchange) in product(SMALLER, RECOMBINED):
        gmsh.option.setNumber("Mesh.MeshSizeMax", part * size)
        gmsh.option.setNumber("Mesh.RecombinationAlgorithm", pairing)
        gmsh.option.setNumber("Mesh.RecombineOptimizeTopology", exchange)
        gmsh.option.setNumber("Mesh.RecombineNodeRepositioning", bool(exchange))
        gmsh.model.mesh.clear()
        gmsh.model.mesh.generate(2)
        corners = quadrilaterals(gmsh, surface)
        if abs(sum(map(area_of, corners)) - within) <= SAME_AREA * within:
            yield corners


def quadrilaterals(gmsh: Any, surface: int) -> np.ndarray:
    """Return the corners (element, 4, 2) of the mesh of a plane surface."""
    label, place, _ = gmsh.model.mesh.getNodes()
    row = np.zeros(int(label.max()) + 1, int)
    row[label.astype(int)] = np.arange(len(label))
    types, _, members = gmsh.model.mesh.getElements(2, surface)
    if list(types) != [3]:
        raise Problem("Gmsh cannot mesh the flange")
    return np.reshape(place, (-1, 3))[row[np.reshape(members[0], (-1, 4)).astype(int)], :2]


def area_of(corner: np.ndarray) -> float:
    """Return the area within a closed line (n, 2)."""
    x, y = (corner - corner[0]).T
    return float(abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2)


def fit_corners(nodes: np.ndarray, loops: list[list[Side]]) -> None:
    """Move the corners in the middles of chords onto the curves."""
    found, wanted = [], []
    for side in (side for loop in loops for side in loop if side.curved):
        ends = side.points[::4]
        found += [*((ends[:-1] + ends[1:]) / 2), *ends]
        wanted += [*side.points[2::4], *ends]
    if not found:
        return
    corner = nodes[:, ::2, ::2, :2]
    distance, nearest = cKDTree(np.array(found)).query(corner.reshape(-1, 2))
    moved = corner.reshape(-1, 2).copy()
    near = distance < 1e-6 * np.ptp(moved, axis=0).max()
    moved[near] = np.array(wanted)[nearest[near]]
    nodes[:, ::2, ::2, :2] = moved.reshape(corner.shape)


def fit_middles(nodes: np.ndarray, loops: list[list[Side]]) -> None:
    """Set the middles of edges, on the curves where an edge is a piece of one, and those of the patches."""
    nodes[:, ::2, 1] = (nodes[:, ::2, 0] + nodes[:, ::2, 2]) / 2
    nodes[:, 1, ::2] = (nodes[:, 0, ::2] + nodes[:, 2, ::2]) / 2
    pieces = [(side.points[:-2:2], side.points[1::2], side.points[2::2])
              for loop in loops for side in loop if side.curved]
    if pieces:
        start, middle, end = (np.concatenate(part) for part in zip(*pieces))
        tree = cKDTree((start + end) / 2)
        for place in ((0, 1), (2, 1), (1, 0), (1, 2)):
            distance, nearest = tree.query(nodes[:, *place, :2])
            near = distance < 1e-6 * np.ptp(start, axis=0).max()
            nodes[near, *place, :2] = middle[nearest[near]]
    # The middle of a patch between curved edges (Coons 1967).
    nodes[:, 1, 1] = ((nodes[:, 0, 1] + nodes[:, 2, 1] + nodes[:, 1, 0] + nodes[:, 1, 2]) / 2
                      - nodes[:, ::2, ::2].sum(axis=(1, 2)) / 4)


def crosses(corner: np.ndarray, near: int = 0) -> bool:
    """Tell whether a closed line (n, 2) crosses itself; pieces of it up to `near` apart along it may cross."""
    a, b = corner, np.roll(corner, -1, axis=0)
    way = np.abs(np.subtract.outer(*[np.arange(len(corner))] * 2))

    def side(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> np.ndarray:
        return np.sign((q[..., 0] - p[..., 0]) * (r[..., 1] - p[..., 1])
                       - (q[..., 1] - p[..., 1]) * (r[..., 0] - p[..., 0]))

    apart = side(a[:, None], b[:, None], a[None]) * side(a[:, None], b[:, None], b[None]) < 0
    return bool((apart & apart.T & (np.minimum(way, len(corner) - way) > near)).any())


def is_folded(corner: np.ndarray) -> bool:
    """Tell whether points of a closed line (n, 2) are one: Gmsh does not end its mesh."""
    return bool(len(cKDTree(corner).query_pairs(SAME_POINT * float(np.ptp(corner, axis=0).max()))))


def inside(points: np.ndarray, corner: np.ndarray) -> np.ndarray:
    """Tell which points (n, 2) are inside a closed line (m, 2)."""
    a, b = corner, np.roll(corner, -1, axis=0)
    x, y = points[:, :1], points[:, 1:]
    above = (a[:, 1] > y) != (b[:, 1] > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
    return np.asarray((above & (x < crossing)).sum(axis=1) % 2 == 1)
