# SPDX-License-Identifier: GPL-3.0-or-later
"""Cuts of CAD faces that close in themselves, as a fillet or a bead around a whole tool: their parts have four edges,
and so a regular mesh."""
from typing import Any

import numpy as np

from dd3.tools.parameters import length_of, pole_parameters

# Parts of the size of the box within which two planes count as one.
SAME_PLANE = 0.02
# Points of a circle that give its plane.
CIRCLE_POINTS = 16
# Distance of a plane edge from its plane over its size.
PLANE_EDGE = 1e-6


def is_closed(gmsh: Any, tag: int) -> bool:
    """Tell whether a curved face has an edge that ends where it begins, and others than seams: Gmsh fails on the parts
    of a whole torus."""
    if gmsh.model.getType(2, tag) == "Plane":
        return False
    edges = [abs(edge) for _, edge in gmsh.model.getBoundary([(2, tag)], combined=False, oriented=True)]
    edges = [edge for edge in edges if length_of(gmsh, edge)]
    return any(edges.count(edge) == 1 for edge in edges) and any(
        len({point for _, point in gmsh.model.getBoundary([(1, edge)], combined=False)}) < 2 for edge in edges)


def planes_through_pole(gmsh: Any, tag: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return two planes, perpendicular, through the axis of a face that goes all around a pole, (point, normal), one
    of them through its seam; none for other faces, and for spheres and cones, on which Gmsh does not fail."""
    if gmsh.model.getType(2, tag) in ("Plane", "Sphere", "Cone"):
        return []
    edges = {abs(edge) for _, edge in gmsh.model.getBoundary([(2, tag)], combined=False, oriented=False)}
    pole = next((edge for edge in edges if not length_of(gmsh, edge)), None)
    if pole is None:
        return []
    along = int(np.isnan(pole_parameters(gmsh, pole, tag))[1])
    low, high = (np.array(bound) for bound in gmsh.model.getParametrizationBounds(2, tag))
    uv = np.tile((low + high) / 2, (CIRCLE_POINTS + 1, 1))
    uv[:, along] = np.linspace(low[along], high[along], CIRCLE_POINTS + 1)
    circle = np.reshape(gmsh.model.getValue(2, tag, uv.ravel()), (-1, 3))
    if np.linalg.norm(circle[-1] - circle[0]) > 1e-6 * np.ptp(circle, axis=0).max():
        return []
    axis = np.cross(circle[:-1] - circle[0], circle[1:] - circle[0]).sum(axis=0)
    point = np.reshape(gmsh.model.getValue(1, pole, [0.0]), 3)
    first = np.cross(axis, circle[0] - point)
    return [(point, normal / np.linalg.norm(normal)) for normal in (first, np.cross(axis, first))]


def planes_through(gmsh: Any, tag: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return two planes as (point, normal) through the axis of a face around which it closes, one of them through the
    vertex of a closed edge, where the seam is; where no closed edge is plane, through the middle of the box of the face
    along its shortest side."""
    for _, edge in gmsh.model.getBoundary([(2, tag)], combined=False, oriented=False):
        ends = {point for _, point in gmsh.model.getBoundary([(1, edge)], combined=False)}
        if len(ends) != 1 or not length_of(gmsh, edge):
            continue
        low, high = (bound[0] for bound in gmsh.model.getParametrizationBounds(1, edge))
        points = np.reshape(gmsh.model.getValue(1, edge, np.linspace(low, high, CIRCLE_POINTS + 1)), (-1, 3))
        centre, start = points[:-1].mean(axis=0), points[0]
        axis = np.cross(points[:-1] - centre, points[1:] - centre).sum(axis=0)
        axis /= max(float(np.linalg.norm(axis)), 1e-300)
        size = float(np.ptp(points, axis=0).max())
        if axis.any() and np.abs((points - centre) @ axis).max() < PLANE_EDGE * size:
            first = np.cross(axis, start - centre)
            first /= np.linalg.norm(first)
            return [(centre, first), (centre, np.cross(axis, first))]
    low, high = np.reshape(gmsh.model.getBoundingBox(2, tag), (2, 3))
    return [((low + high) / 2, np.eye(3)[axis]) for axis in range(3) if axis != int(np.argmin(high - low))]


def of_axes(planes: list[list[tuple[np.ndarray, np.ndarray]]], size: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the planes of faces, each two through an axis, (point, normal), those of the first one only of faces with
    the same axis."""
    kept: list[list[tuple[np.ndarray, np.ndarray]]] = []
    for pair in planes:
        (point, first), (_, second) = pair
        axis = np.cross(first, second)
        if not any(abs(axis @ np.cross(one[1], two[1])) > 1 - SAME_PLANE**2
                   and np.linalg.norm(np.cross(axis, point - one[0])) < SAME_PLANE * size for one, two in kept):
            kept.append(pair)
    return [plane for pair in kept for plane in pair]


def different(planes: list[tuple[np.ndarray, np.ndarray]], size: float) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return planes without those that nearly coincide with an earlier one."""
    kept: list[Any] = []
    for point, normal in planes:
        if not any(abs(normal @ other) > 1 - SAME_PLANE**2 and abs((point - place) @ normal) < SAME_PLANE * size
                   for place, other in kept):
            kept.append((point, normal))
    return kept


def add_square(occ: Any, centre: np.ndarray, normal: np.ndarray, half: float) -> int:
    """Add a square face, its half side given; return its tag."""
    along = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    along /= np.linalg.norm(along)
    across = np.cross(normal, along)
    corners = [occ.addPoint(*(centre + half * (a * along + b * across)))
               for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    lines = [occ.addLine(*pair) for pair in zip(corners, corners[1:] + corners[:1])]
    return occ.addPlaneSurface([occ.addCurveLoop(lines)])


def cut(gmsh: Any, tags: list[int], planes: list[tuple[np.ndarray, np.ndarray]]) -> list[list[int]]:
    """Cut all faces by planes, (point, normal); return the parts of each face. Solids go."""
    occ = gmsh.model.occ
    low, high = np.reshape(gmsh.model.getBoundingBox(-1, -1), (2, 3))
    centre, size = (low + high) / 2, float(np.linalg.norm(high - low))
    tools = [(2, add_square(occ, centre - ((centre - point) @ normal) * normal, normal, size))
             for point, normal in different(planes, size)]
    occ.remove(occ.getEntities(3))
    _, parts = occ.fragment([(2, tag) for tag in tags], tools)
    parts = [[tag for _, tag in part] for part in parts[:len(tags)]]
    kept = {tag for part in parts for tag in part}
    occ.remove([(2, tag) for _, tag in occ.getEntities(2) if tag not in kept], recursive=True)
    occ.synchronize()
    return parts
