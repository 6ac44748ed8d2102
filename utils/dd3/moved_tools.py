# SPDX-License-Identifier: GPL-3.0-or-later
"""Tool surfaces whose points are moved with the sheet beside them, by a smooth function of the place.

Source: Lingbeek, Huetink, Ohnimus, Petzoldt and Weiher, J. Mater. Process. Technol. 169 (2005) 115-125.
"""
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import RBFInterpolator
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from dd3.gmsh_session import session
from dd3.springback import images
from dd3.tools.cad_file import silence
from dd3.tools.surface import Patches, Surface, from_nodes, points_on, read_patches

MOST_POINTS = 2000  # of the smooth function
ROUND = 4.0  # radius at the tips of the multiquadrics, over the distance of the places
FARTHEST = 3.0  # points in a mean, over its standard deviation
NEAR = 1e-6  # of a group: round-off at its border, over its size


def nodes_of(patch: tuple[np.ndarray, np.ndarray], in_v: int, in_u: int) -> np.ndarray:
    """Return the points (v, u, 3) of a patch on a regular grid of its parameters, 2 n + 1 points along each."""
    return points_on(*patch, np.linspace(0, 1, 2 * in_v + 1), np.linspace(0, 1, 2 * in_u + 1))


def divisions(patches: Patches, size: float) -> np.ndarray:
    """Return the numbers of parts (n, 2) of the patches along v and u that make them no longer than `size`: the same
    for opposite sides and for patches that share a side."""
    grids = [nodes_of(patch, 4, 4) for patch in patches]
    sides = np.array([[grid[0], grid[-1], grid[:, 0], grid[:, -1]] for grid in grids]).reshape(-1, 9, 3)
    length = np.linalg.norm(np.diff(sides, axis=1), axis=2).sum(axis=1)
    ends, middle = sides[:, [0, -1]].sum(axis=1), sides[:, 4]
    near = 1e-6 * max(float(np.ptp(sides.reshape(-1, 3), axis=0).max()), 1e-300)
    shared = cKDTree(np.hstack([ends, 2 * middle])).query_pairs(4 * near, output_type="ndarray")
    opposite = np.arange(len(sides)).reshape(-1, 2)
    pairs = np.vstack([shared, opposite])
    links = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(sides), len(sides)))
    _, group = connected_components(links, directed=False)
    longest = np.zeros(group.max() + 1)
    np.maximum.at(longest, group, length)
    count = np.maximum(1, np.ceil(longest / size)).astype(int)[group].reshape(-1, 4)
    return np.asarray(count[:, [2, 0]])


def moved_surface(path: Path, displacement: Any, size: float, place: np.ndarray) -> Surface:
    """Return a tool's surface, divided, with its points moved. `place` is its displacement where the displacement of
    its points is given."""
    patches = read_patches(path)
    blocks, face = [], []
    for number, (patch, (in_v, in_u)) in enumerate(zip(patches, divisions(patches, size))):
        nodes = nodes_of(patch, in_v, in_u)
        blocks += [nodes[2 * i:2 * i + 3, 2 * j:2 * j + 3] for i in range(in_v) for j in range(in_u)]
        face += [number] * (in_v * in_u)
    nodes = np.stack(blocks)
    nodes = nodes + displacement(nodes.reshape(-1, 3) + place).reshape(nodes.shape)
    return Surface(from_nodes(nodes), np.array(face), [f"patch {number}" for number in range(1, len(patches) + 1)])


def turned(vectors: np.ndarray) -> np.ndarray:
    """Return vectors and their images after half a turn about z."""
    return np.concatenate((vectors, vectors * (-1.0, -1.0, 1.0)))


def smooth_field(points: np.ndarray, displacement: np.ndarray, mirror: Sequence[str], reach: float,
                 half_turn: bool = False, level: tuple[np.ndarray, Sequence[str]] | None = None) -> Any:
    """Return a smooth function of the place for a displacement at some points, with the symmetries given:
    multiquadrics through means of place and displacement, with the weights of a normal distribution of the standard
    deviation `reach`, at places as far apart. Its slopes go on beyond the points and fade over some `reach`.

    level: the points before the part is turned, and the planes of symmetry there, by which they are grouped, so that a
    turned part has the same groups; by default those given.

    Source: Hardy, J. Geophys. Res. 76 (1971) 1905-1915.
    """
    before, planes = level or (points, mirror)
    whole, given, flat = (np.concatenate(images(*pair)) for pair in
                          ((points, mirror), (displacement, mirror), (before, planes)))
    if half_turn:
        whole, given, flat = turned(whole), turned(given), turned(flat)
    size = reach
    while True:
        group = np.floor(flat / size + NEAR).astype(int)
        _, cell, count = np.unique(group, axis=0, return_inverse=True, return_counts=True)
        if len(count) <= MOST_POINTS:
            break
        size *= 1.25
    places = np.stack([np.bincount(cell.ravel(), whole[:, axis]) / count for axis in range(3)], axis=1)
    near = cKDTree(places).sparse_distance_matrix(cKDTree(whole), FARTHEST * size, output_type="coo_matrix").tocsr()
    near.data = np.exp(-0.5 * (near.data / size)**2)
    weight = (near @ np.ones(len(given)))[:, None]
    places, values = near @ whole / weight, near @ given / weight  # a linear function is kept
    return RBFInterpolator(places, values, kernel="multiquadric", epsilon=1 / (ROUND * size), degree=0)


def along_sheet(field: Any, sheet: Any, thickness: float) -> Any:
    """Return the displacement of the points of tools: that of the sheet's lower face beside them, with their distance
    along its normal kept up to two thicknesses, so that the gaps between the tools stay."""
    def displacement(points: np.ndarray) -> np.ndarray:
        _, closest = sheet.find_closest_cell(points, return_closest_point=True)
        offset = points - closest
        distance = np.linalg.norm(offset, axis=1)
        normal = offset / np.maximum(distance, 1e-12)[:, None]
        kept = np.minimum(distance, 2 * thickness)
        place = points - kept[:, None] * normal
        first = np.cross(normal, np.eye(3)[abs(normal).argmin(axis=1)])
        first /= np.maximum(np.linalg.norm(first, axis=1), 1e-12)[:, None]
        second, step = np.cross(normal, first), 0.1 * thickness
        in_first, in_second = ((field(place + step * axis) - field(place - step * axis)) / (2 * step)
                               for axis in (first, second))
        turned = np.cross(first + in_first, second + in_second)
        turned /= np.maximum(np.linalg.norm(turned, axis=1), 1e-12)[:, None]
        return np.asarray(field(place) + np.where(distance > 1e-9, kept, 0.0)[:, None] * (turned - normal))
    return displacement


def write_step(path: Path, surface: Surface) -> None:
    """Write a surface as a STEP file of Bézier faces."""
    with session() as gmsh, silence():
        for net in surface.net:
            tags = [gmsh.model.occ.addPoint(*point[:3] / point[3]) for point in net.reshape(-1, 4)]
            gmsh.model.occ.addBezierSurface(tags, 3)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
