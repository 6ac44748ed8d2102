# SPDX-License-Identifier: GPL-3.0-or-later
"""Binder of a die: the surface on which the flange of the blank lies, a height over the plan.

It is level, an inclined plane, or a developable surface: a profile that is moved along straight, parallel rulings.
"""
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.interpolate import BSpline
from scipy.optimize import minimize_scalar

from dd3.errors import Problem
from dd3.progress import doing
from dd3.tools.plane import ALONG, Side, chords, flat
from dd3.tools.surface import from_nodes, grid, points_at

# Pieces of a profile, cubic each: near to rims, of a flange at first, and at most.
CUBIC, PIECES, MOST_PIECES = 1, 4, 64
# Directions of rulings that are tried; weight of the smoothness of the profile, where points leave it open.
DIRECTIONS, SMOOTH = 24, 1e-5
# Points, about, by which the direction of the rulings is found.
SEARCHED = 1000
# Length over that of the profile in which its curvature fades beyond its ends.
FADE = 0.25
# Times the patches are halved for the tolerance, at most.
HALVED = 5


class NoBinder(Problem):
    """The part gets no binder: the reason, and what the user may do."""

    def __init__(self, reason: str, remedy: str) -> None:
        super().__init__(reason + remedy)
        self.reason = reason


@dataclass
class Binder:
    """Direction in plan across the rulings (2,); profile of the heights over it, which goes on beyond its
    ends with a curvature that fades; slope of the
    rulings; kind in words."""

    kind: str
    across: np.ndarray
    profile: BSpline
    slope: float = 0.0
    height: float = 0.0

    def place(self, plan: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return the place of points (..., 2) on the profile within its ends, beyond them, and along the rulings."""
        s = plan @ self.across
        inner = np.clip(s, self.profile.t[0], self.profile.t[-1])
        return inner, s - inner, plan @ np.array([-self.across[1], self.across[0]])

    def curving(self, s: np.ndarray, beyond: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what the curvature, which fades beyond the ends of the profile, adds to heights and slopes there."""
        if self.profile.k < 2:
            return np.zeros_like(s), np.zeros_like(s)
        reach = FADE * (self.profile.t[-1] - self.profile.t[0])
        near = np.minimum(np.abs(beyond), reach)
        slope = near - near**2 / (2 * reach)
        height = near**2 / 2 - near**3 / (6 * reach) + (np.abs(beyond) - near) * reach / 2
        bend = self.profile(s, 2)
        return bend * height, bend * slope * np.sign(beyond)

    def z(self, plan: np.ndarray) -> np.ndarray:
        """Return the heights over points in plan (..., 2)."""
        s, beyond, along = self.place(plan)
        return np.asarray(self.profile(s) + self.profile(s, 1) * beyond + self.curving(s, beyond)[0]
                          + self.slope * along + self.height)

    def gradient(self, plan: np.ndarray) -> np.ndarray:
        """Return the slopes (..., 2)."""
        s, beyond, _ = self.place(plan)
        rise = self.profile(s, 1) + self.curving(s, beyond)[1]
        return np.asarray(rise[..., None] * self.across + self.slope * np.array([-self.across[1], self.across[0]]))

    def normal(self, plan: np.ndarray) -> np.ndarray:
        """Return the unit normals, upwards (..., 3)."""
        gradient = self.gradient(plan)
        vector = np.concatenate([-gradient, np.ones((*gradient.shape[:-1], 1))], axis=-1)
        return np.asarray(vector / np.linalg.norm(vector, axis=-1, keepdims=True))

    @property
    def plane(self) -> bool:
        """Tell whether it is a plane."""
        return self.profile.k == 1

    def raised(self, height: float) -> "Binder":
        """Return the binder at another height."""
        return replace(self, height=self.height + height)

    def distance(self, points: np.ndarray) -> float:
        """Return the largest distance of points (n, 3), mm."""
        away = np.abs(points[:, 2] - self.z(points[:, :2])) * self.normal(points[:, :2])[:, 2]
        return float(away.max())


def level(height: float) -> Binder:
    """Return a level binder."""
    return Binder("level", np.array([1.0, 0.0]), BSpline([0, 0, 1, 1], [height, height], 1))


def inclined(points: np.ndarray) -> Binder:
    """Return the plane nearest to points (n, 3), by heights."""
    middle = points.mean(axis=0)
    slope = np.linalg.lstsq(points[:, :2] - middle[:2], points[:, 2] - middle[2], rcond=1e-9)[0]
    steep = float(np.linalg.norm(slope))
    across = slope / steep if steep > 0.0 else np.array([1.0, 0.0])
    start = middle @ np.array([*across, 0.0])
    return Binder("an inclined plane", across, BSpline([start, start, start + 1, start + 1],
                                                       [middle[2], middle[2] + steep], 1))


def developable(points: np.ndarray, tolerance: float = np.inf) -> Binder:
    """Return the developable surface with the direction of rulings that fits best; with a tolerance, mm, the pieces of
    its profile are halved until all points (n, 3) are within it."""
    pieces = PIECES if np.isfinite(tolerance) else CUBIC
    some = points[::max(1, len(points) // SEARCHED)]

    def worst(angle: float) -> float:
        return fitted(some, angle, pieces)[1]

    step = np.pi / DIRECTIONS
    first = min(np.arange(DIRECTIONS) * step, key=worst)
    best = minimize_scalar(worst, bounds=(first - step, first + step), method="bounded", options={"xatol": 1e-9}).x
    best = best if worst(best) < worst(first) else first
    found, _ = fitted(points, best, pieces)
    while pieces < MOST_PIECES and found.distance(points) > tolerance:
        pieces *= 2
        found, _ = fitted(points, best, pieces)
    return found


def fitted(points: np.ndarray, angle: float, pieces: int) -> tuple[Binder, float]:
    """Return the surface with rulings across a direction in plan, by least squares of the heights, and the rms of these
    that is left."""
    across = np.array([np.cos(angle), np.sin(angle)])
    s, along = points[:, :2] @ across, points[:, :2] @ np.array([-across[1], across[0]])
    low, high = s.min(), s.max()
    inner = np.linspace(low, high, pieces + 1)
    knots = np.concatenate([[low] * 3, inner, [high] * 3])
    basis = BSpline.design_matrix(np.clip(s, low, high), knots, 3).toarray()
    bend = np.diff(np.eye(basis.shape[1]), 3, axis=0) * SMOOTH
    matrix = np.block([[basis, along[:, None] - along.mean()], [bend, np.zeros((len(bend), 1))]])
    middle = points[:, 2].mean()
    values = np.linalg.lstsq(matrix, np.concatenate([points[:, 2] - middle, np.zeros(len(bend))]), rcond=1e-12)[0]
    rms = float(np.sqrt(np.mean((matrix[:len(points)] @ values - points[:, 2] + middle)**2)))
    return Binder("developable", across, BSpline(knots, values[:-1], 3), float(values[-1]),
                  middle - float(values[-1]) * float(along.mean())), rms


@doing("fitting a binder to the flange of the part")
def of_points(points: np.ndarray, tolerance: float) -> tuple[Binder, float]:
    """Return the simplest binder on which points (n, 3) lie within the tolerance, or else the nearest one, and their
    largest distance from it, mm."""
    tried = []
    for found in kinds(points, tolerance):
        tried.append((found, found.distance(points)))
        if tried[-1][1] <= tolerance:
            return tried[-1]
    return min(tried, key=lambda one: one[1])


def kinds(points: np.ndarray, tolerance: float = np.inf) -> Iterable[Binder]:
    """Return the binders that are nearest to points (n, 3), the simplest one first."""
    yield level(float(points[:, 2].max() + points[:, 2].min()) / 2)
    yield inclined(points)
    yield developable(points, tolerance)


@doing("meshing the binder")
def patches_on(gmsh: Any, binder: Binder, loops: list[list[Side]], curves: list[np.ndarray], tolerance: float
               ) -> np.ndarray:
    """Return the nodes (patch, 3, 3, 3) of patches on a binder between closed lines in plan, within the tolerance of
    it; those at the nodes of curves (n, 3) are these."""
    size = float(np.ptp(chords(loops[0]), axis=0).max()) / ALONG
    for _ in range(HALVED + 1):
        nodes = flat(gmsh, loops, size)
        nodes[..., 2] = binder.z(nodes[..., :2])
        point = points_at(from_nodes(nodes), *grid(5)).reshape(-1, 3)
        if binder.distance(point) <= tolerance:
            break
        size /= 2
    else:
        raise Problem("the binder is curved too strongly for patches within the tolerance")
    own = np.concatenate(curves)
    where = {tuple(row): z for row, z in zip(np.round(own[:, :2], 9).tolist(), own[:, 2].tolist())}
    for index in np.ndindex(nodes.shape[:3]):
        z = where.get(tuple(np.round(nodes[index][:2], 9).tolist()))
        if z is not None:
            nodes[index][2] = z
    return nodes
