# SPDX-License-Identifier: GPL-3.0-or-later
"""Rims of a tool's surface, the edges at which its walls end upwards, and surfaces that go on from them."""
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from dd3.errors import Problem
from dd3.tools.binder import Binder, NoBinder
from dd3.tools.joints import EDGES, Joints, normals_along
from dd3.tools.surface import Surface, from_nodes, points_at

# Angle from the horizontal above which a surface climbs at its edge, degrees.
CLIMB = 10.0
# The same of a surface beside a flange, whose rails may climb at their ends.
CLIMB_BESIDE_FLANGE = 30.0
# Angle of a patch across a shoulder, degrees, at most.
TURN = 22.5
# Turn of a rim at a node above which it has a corner there, degrees.
CORNER = 30.0
# Steps to the binder, and the last one over the radius of the shoulder; least height that a wall gains over its length.
STEPS, SETTLED, LEAST_RATE = 40, 1e-12, 0.05
# Parameters of the nodes of an edge.
NODES = np.array([0.0, 0.5, 1.0])


@dataclass
class Rim:
    """Nodes of connected edges at which walls end: ends and middles of the edges, (2 n + 1, 3); there the direction of
    steepest ascent and the horizontal one away from the wall, and where the surface is level. A closed rim ends where
    it begins."""

    points: np.ndarray
    climb: np.ndarray
    out: np.ndarray
    closed: bool
    level: np.ndarray


def find_rims(surface: Surface, joints: Joints, border: np.ndarray | None = None) -> tuple[list[Rim], int]:
    """Return the rims of a surface whose normals point to the side that its walls enclose, and the number of its other
    free edges. The walls climb along z. Free edges of a border, where a flange joins the surface, are no rims, nor are
    others that climb by less than CLIMB_BESIDE_FLANGE if there is a border."""
    edge = joints.free if border is None else np.setdiff1d(joints.free, border)
    points, normals = along_edges(surface, edge)
    # At the middle, the direction in which the surface would go on.
    along = points[:, 2] - points[:, 0]
    onward = np.cross(along, normals[:, 1])
    least = CLIMB if border is None or not len(border) else CLIMB_BESIDE_FLANGE
    climbing = onward[:, 2] > np.sin(np.radians(least)) * np.linalg.norm(onward, axis=1)
    return (lined(points[climbing], normals[climbing], 1e-6 * joints.size), int((~climbing).sum()))


def border_rims(surface: Surface, joints: Joints, border: np.ndarray, across: bool) -> list[Rim]:
    """Return the rims along free edges at which a flange joins a surface; `across` as for `rim_of`."""
    points, normals = along_edges(surface, border)
    return lined(points, normals, 1e-6 * joints.size, across)


def along_edges(surface: Surface, edge: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the nodes (n, 3, 3) of edges, and the unit normals there."""
    points = np.zeros((len(edge), 3, 3))
    for k, place in enumerate(EDGES):
        chosen = edge % 4 == k
        points[chosen] = points_at(surface.net[edge[chosen] // 4], *place(NODES))
    if surface.normals is None:
        return points, normals_along(surface.net, edge, NODES)
    normal = surface.normals[edge // 4]
    sides = np.stack([normal[:, 0], normal[:, :, 2], normal[:, 2, ::-1], normal[:, ::-1, 0]], axis=1)
    return points, sides[np.arange(len(edge)), edge % 4]


def lined(points: np.ndarray, normals: np.ndarray, tolerance: float, across: bool = False) -> list[Rim]:
    """Return the rims of edges (n, 3 nodes, 3) with the normals there; see `rim_of`."""
    return [rim_of(points, normals, *chain, across) for chain in chained(points, tolerance)]


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
            first = first_of_pairs(points[chain])
            chain = chain[first:] + chain[:first]
        chains.append((chain, closed))
    return chains


def first_of_pairs(points: np.ndarray) -> int:
    """Return the first of the edges (n, 3 nodes, 3) of a closed line whose pairs have no corner between them: that at
    the sharpest corner, or without one the first or the second, so that those of a pair are about as long."""
    along = points[:, 2] - points[:, 0]
    length = np.linalg.norm(along, axis=1)
    along = along / length[:, None]
    cosine = (along * np.roll(along, 1, axis=0)).sum(axis=1)
    if cosine.min() < np.cos(np.radians(CORNER)):
        return int(cosine.argmin())
    return min((0, 1), key=lambda first: float(np.abs(np.log(length[first::2] / np.roll(length, -1)[first::2])).sum()))


def rim_of(points: np.ndarray, normals: np.ndarray, chain: list[int], closed: bool, across: bool) -> Rim:
    """Return the rim of a chain of edges; at a node of two edges normal and tangent are their means. Away from the wall
    is against its normal, or across the edge on request."""
    count = 2 * len(chain) + 1
    place, normal, along = np.zeros((count, 3)), np.zeros((count, 3)), np.zeros((count, 3))
    for k, edge in enumerate(chain):
        a, b, c = points[edge]
        place[2 * k:2 * k + 3] = points[edge]
        normal[2 * k:2 * k + 3] += normals[edge]
        along[2 * k:2 * k + 3] += unit(np.array([4 * b - 3 * a - c, c - a, 3 * c - 4 * b + a]))
    if closed:
        place[-1] = place[0]
        normal[0] = normal[-1] = normal[0] + normal[-1]
        along[0] = along[-1] = along[0] + along[-1]
    normal = unit(normal)
    level = np.linalg.norm(normal[:, :2], axis=1) < np.sin(np.radians(CLIMB)) / 2
    out = unit((np.cross(along, normal) if across else -normal) * (1, 1, 0))
    climb = unit(np.array([0, 0, 1]) - normal * normal[:, 2:])
    return Rim(place, climb, out, closed, level)


def unit(vectors: np.ndarray) -> np.ndarray:
    """Return vectors of length 1, zero where they vanish."""
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300))


def refuse_level(rims: list[Rim]) -> None:
    """Refuse rims that are level at a node, where a wall cannot go on."""
    for rim in rims:
        if rim.level.any():
            flat = rim.points[int(rim.level.argmax())]
            raise NoBinder("the part lies flat at its edge near x y z = " + " ".join(f"{value:.4g}" for value in flat)
                           + ", beside an edge at which it climbs", ": trim it there, or leave the face out by --faces")


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


def ahead(rim: Rim, binder: Binder, plan: np.ndarray) -> np.ndarray:
    """Return the directions on a binder away from the nodes of a rim, at points in plan."""
    slope = (binder.gradient(plan) * rim.out[:, :2]).sum(axis=1, keepdims=True)
    return unit(rim.out + slope * (0, 0, 1))


def turn_of(rim: Rim, onto: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the angles from the steepest ascent to other directions in the vertical planes across a rim (n, 1), and
    the directions across the ascent on that side."""
    cosine = np.clip((rim.climb * onto).sum(axis=1), -1.0, 1.0)[:, None]
    return np.arccos(cosine), unit(onto - cosine * rim.climb)


def lengths(rim: Rim, binder: Binder, radius: float) -> np.ndarray:
    """Return the lengths of the walls along the steepest ascent, from where shoulders of a radius end on the binder;
    negative where the rim is too high for that."""
    length = np.zeros(len(rim.points))
    onto = ahead(rim, binder, rim.points[:, :2])
    for _ in range(STEPS):
        angle, across = turn_of(rim, onto)
        end = (rim.points + length[:, None] * rim.climb
               + radius * (np.sin(angle) * rim.climb + (1.0 - np.cos(angle)) * across))
        rate = rim.climb[:, 2] - (binder.gradient(end[:, :2]) * rim.climb[:, :2]).sum(axis=1)
        if rate.min() < LEAST_RATE:
            raise Problem("the walls at the edge near x y z = " + " ".join(
                f"{value:.4g}" for value in rim.points[int(rate.argmin())]) + " do not reach the binder")
        change = (binder.z(end[:, :2]) - end[:, 2]) / rate
        length += change
        onto = ahead(rim, binder, end[:, :2])
        if np.abs(change).max() < SETTLED * radius:
            break
    return length


def missing_height(rim: Rim, binder: Binder, radius: float) -> float:
    """Return how much higher a binder has to be for walls of a rim that all go on upwards, mm, negative if lower."""
    length = lengths(rim, binder, radius)
    rate = rim.climb[:, 2] - (binder.gradient(rim.points[:, :2]) * rim.climb[:, :2]).sum(axis=1)
    return float((-length * rate).max())


def shoulder(rim: Rim, foot: np.ndarray, radius: float, binder: Binder, tolerance: float) -> list[np.ndarray]:
    """Return the rows of an arc that turns from the steepest ascent to a binder, on which it ends, without the first;
    `foot` are the nodes where it begins."""
    onto = ahead(rim, binder, foot[:, :2])
    for _ in range(STEPS):
        angle, across = turn_of(rim, onto)
        end = foot + radius * (np.sin(angle) * rim.climb + (1.0 - np.cos(angle)) * across)
        onto = ahead(rim, binder, end[:, :2])
    bands = bands_of(float(angle.max()), radius, tolerance)
    rows = []
    for part in np.linspace(0.0, 1.0, 2 * bands + 1)[1:]:
        turned = part * angle
        rows.append(foot + radius * (np.sin(turned) * rim.climb + (1.0 - np.cos(turned)) * across))
    rows[-1][:, 2] = binder.z(rows[-1][:, :2])
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
