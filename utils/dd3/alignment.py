# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigid motions that bring a part to a wanted shape: best fit of points, and zero distances at places."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from dd3.errors import Problem
from dd3.sheet import AXES

MOST, SETTLED = 100, 1e-9  # iterations, and the motion that ends them over the size of the part
UNDETERMINED = 1e-6  # singular value of a motion that the equations do not determine, over the largest one
MOTIONS = tuple([f"move along {axis}" for axis in AXES] + [f"turn about {axis}" for axis in AXES])


class Rigid(NamedTuple):
    """The motion x -> rotation x + shift."""

    rotation: np.ndarray
    shift: np.ndarray

    def of(self, points: np.ndarray) -> np.ndarray:
        """Return points (n, 3) after the motion."""
        return np.asarray(points @ self.rotation.T + self.shift)

    def back(self, points: np.ndarray) -> np.ndarray:
        """Return points (n, 3) before the motion."""
        return np.asarray((points - self.shift) @ self.rotation)

    def axis_angle(self) -> tuple[np.ndarray, float]:
        """Return the axis of the rotation, a unit vector, and its angle, degrees."""
        from scipy.spatial.transform import Rotation
        vector = Rotation.from_matrix(self.rotation).as_rotvec()
        angle = float(np.linalg.norm(vector))
        return (vector / angle if angle > 0 else np.eye(3)[2]), float(np.degrees(angle))


STILL = Rigid(np.eye(3), np.zeros(3))


class Equations(NamedTuple):
    """Distances (n) that are to vanish, their gradients (n, 3) with the place (n, 3) of the part, and weights (n)."""

    distance: np.ndarray
    gradient: np.ndarray
    place: np.ndarray
    weight: np.ndarray


def kabsch(points: np.ndarray, target: np.ndarray, weights: np.ndarray) -> Rigid:
    """Return the motion of points to the least squares of the distances from their targets.

    Source: Kabsch, Acta Cryst. A 32 (1976) 922-923.
    """
    part = weights / weights.sum()
    centre, middle = part @ points, part @ target
    left, _, right = np.linalg.svd((part[:, None] * (points - centre)).T @ (target - middle))
    rotation = (left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right).T
    return Rigid(rotation, middle - rotation @ centre)


def free_motions(mirror: Sequence[str]) -> np.ndarray:
    """Return which of MOTIONS keep the planes of symmetry."""
    return np.array([axis not in mirror for axis in AXES] + [set(mirror) <= {axis} for axis in AXES])


def aligned(start: Rigid, equations: Callable[[Rigid], Equations], mirror: Sequence[str] = ()) -> tuple[Rigid, int]:
    """Return the motion at which the weighted squares of the distances are least, by Gauss-Newton from a start, and how
    many of the rigid motions they determine; the others stay those of the start.

    equations: the distances after a motion. mirror: planes of symmetry, on which the part stays.
    """
    from scipy.spatial.transform import Rotation
    motion, chosen = start, free_motions(mirror)
    for _ in range(MOST):
        distance, gradient, place, weight = equations(motion)
        if not len(distance):
            raise Problem("nothing of the part lies beside the nominal shape; is it in the same place?")
        centre = place.mean(axis=0)
        size = max(float(np.linalg.norm(place - centre, axis=1).max()), 1.0)  # mm; a single place has no extent
        rows = np.hstack([gradient, np.cross(place - centre, gradient) / size])
        factor = np.sqrt(weight / weight.sum())[:, None]
        step = np.zeros(6)
        step[chosen], _, rank, _ = np.linalg.lstsq(factor * rows[:, chosen], -factor[:, 0] * distance, UNDETERMINED)
        turn = Rotation.from_rotvec(step[3:] / size).as_matrix()
        motion = Rigid(turn @ motion.rotation, turn @ (motion.shift - centre) + centre + step[:3])
        if np.abs(step).max() <= SETTLED * size:
            return motion, int(rank)
    raise Problem(f"the alignment has not settled after {MOST} iterations; expected places that determine it")
