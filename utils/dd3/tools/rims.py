# SPDX-License-Identifier: GPL-3.0-or-later
"""Rims of a tool's surface, the edges at which its walls end upwards, and surfaces that go on from them."""
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from dd3.errors import Problem
from dd3.tools.joints import EDGES, Joints, normals_along
from dd3.tools.surface import Surface, from_nodes, points_at

# Angle from the horizontal above which a surface climbs at its edge, degrees.
CLIMB = 10.0
# Angle of a patch across a shoulder, degrees, at most.
TURN = 22.5
# Parameters of the nodes of an edge.
NODES = np.array([0.0, 0.5, 1.0])


@dataclass
class Rim:
    """Nodes of connected edges at which walls end: ends and middles of the edges, (2 n + 1, 3); there the direction of
    steepest ascent and the horizontal one away from the wall. A closed rim ends where it begins."""

    points: np.ndarray
    climb: np.ndarray
    out: np.ndarray
    closed: bool


def find_rims(surface: Surface, joints: Joints) -> tuple[list[Rim], int]:
    """Return the rims of a surface whose normals point to the side that its walls enclose, and the number of its other
    free edges. The walls climb along z."""
    edge = joints.free
    points = np.zeros((len(edge), 3, 3))
    for k, place in enumerate(EDGES):
        chosen = edge % 4 == k
        points[chosen] = points_at(surface.net[edge[chosen] // 4], *place(NODES))
    normals = normals_along(surface.net, edge, NODES)
    # At the middle, the direction in which the surface would go on.
    along = points[:, 2] - points[:, 0]
    onward = np.cross(along, normals[:, 1])
    climbing = onward[:, 2] > np.sin(np.radians(CLIMB)) * np.linalg.norm(onward, axis=1)
    chains = chained(points[climbing], 1e-6 * joints.size)
    return ([rim_of(points[climbing], normals[climbing], *chain) for chain in chains], int((~climbing).sum()))


def chained(points: np.ndarray, tolerance: float) -> list[tuple[list[int], bool]]:
    """Return the edges (n, 3 nodes, 3) in the order of lines, and which lines are closed."""
    if not len(points):
        return []
    distance, following = cKDTree(points[:, 0]).query(points[:, 2])
    following = np.where(distance < tolerance, following, -1)
    starts = set(range(len(points))) - set(following.tolist())
    left, chains = set(range(len(points))), []
    for first in [*sorted(starts), *range(len(points))]:
        if first not in left:
            continue
        chain = []
        here = first
        while here in left:
            left.remove(here)
            chain.append(here)
            here = int(following[here])
        closed = here == first
        if closed:
            # From the sharpest corner on, so that pairs of edges have none between them.
            along = points[chain, 2] - points[chain, 0]
            along /= np.linalg.norm(along, axis=1, keepdims=True)
            sharpest = int((along * np.roll(along, 1, axis=0)).sum(axis=1).argmin())
            chain = chain[sharpest:] + chain[:sharpest]
        chains.append((chain, closed))
    return chains


def rim_of(points: np.ndarray, normals: np.ndarray, chain: list[int], closed: bool) -> Rim:
    """Return the rim of a chain of edges; at a node of two edges the normal is their mean."""
    count = 2 * len(chain) + 1
    place, normal = np.zeros((count, 3)), np.zeros((count, 3))
    for k, edge in enumerate(chain):
        place[2 * k:2 * k + 3] = points[edge]
        normal[2 * k:2 * k + 3] += normals[edge]
    if closed:
        place[-1] = place[0]
        normal[0] = normal[-1] = normal[0] + normal[-1]
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    out = -normal * (1, 1, 0)
    length = np.linalg.norm(out, axis=1, keepdims=True)
    if length.min() < np.sin(np.radians(CLIMB)) / 2:
        flat = place[int(length.argmin())]
        raise Problem("the part lies flat at its edge near x y z = " + " ".join(f"{value:.4g}" for value in flat)
                      + ", beside an edge at which it climbs: trim it there, or leave the face out by --faces")
    out /= length
    climb = (0, 0, 1) - normal * normal[:, 2:]
    return Rim(place, climb / np.linalg.norm(climb, axis=1, keepdims=True), out, closed)


def patches(rows: Sequence[np.ndarray]) -> np.ndarray:
    """Return the patches through rows of nodes (2 n + 1, 3), an odd number of rows, with the normals of `find_rims`."""
    grid = np.array(rows)
    bands = (len(grid) - 1) // 2
    count = (grid.shape[1] - 1) // 2
    nodes = np.array([grid[2 * i:2 * i + 3, 2 * k:2 * k + 3][:, ::-1] for i in range(bands) for k in range(count)])
    return from_nodes(nodes)


def wall(rim: Rim, length: np.ndarray) -> list[np.ndarray]:
    """Return the rows of a ruled wall of lengths along the steepest ascent, without the first."""
    return [rim.points + part * length[:, None] * rim.climb for part in (0.5, 1.0)]


def rise(rim: Rim, radius: float) -> np.ndarray:
    """Return the height that a shoulder gains at the nodes of a rim (2 n + 1)."""
    return radius * (1.0 - (rim.climb * rim.out).sum(axis=1))


def shoulder(rim: Rim, foot: np.ndarray, radius: float, tolerance: float) -> list[np.ndarray]:
    """Return the rows of an arc that turns from the steepest ascent to the horizontal, without the first; `foot` are
    the nodes where it begins."""
    cosine = np.clip((rim.climb * rim.out).sum(axis=1), -1.0, 1.0)
    angle = np.arccos(cosine)[:, None]
    # The centre is across the wall, on the side to which the shoulder turns.
    across = rim.out - cosine[:, None] * rim.climb
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    bands = bands_of(float(angle.max()), radius, tolerance)
    rows = []
    for part in np.linspace(0.0, 1.0, 2 * bands + 1)[1:]:
        turned = part * angle
        rows.append(foot + radius * (np.sin(turned) * rim.climb + (1.0 - np.cos(turned)) * across))
    return rows


def bands_of(angle: float, radius: float, tolerance: float) -> int:
    """Return how many quadratic pieces divide an arc (radian) so that each is within the tolerance of it, mm."""
    bands = int(np.ceil(np.degrees(angle) / TURN - 1e-9))
    while off_arc(angle / bands, radius) > tolerance:
        bands += 1
    return bands


def off_arc(angle: float, radius: float) -> float:
    """Return the largest distance of an arc from the quadratic through its ends and its middle."""
    t = np.linspace(0.0, 1.0, 33)
    ends, middle = np.array([np.cos(angle / 2), np.sin(angle / 2)]), 1.0
    x = ends[0] * ((1 - t) * (1 - 2 * t) + t * (2 * t - 1)) + 4 * t * (1 - t) * middle
    y = ends[1] * (2 * t - 1)
    return float(radius * np.abs(np.hypot(x, y) - 1.0).max())
