# SPDX-License-Identifier: GPL-3.0-or-later
"""The free part of a sheet between two tools of a draw-bead in a steady flow.

The force F in a free part is constant, so that the moment is linear in the place: M = M_A + F x (r - r_A). It falls
from that at the tool where the part begins, is reversed, and has its other extreme at the next tool. The curvature
follows the moment as the section did when it was bent: elastic at first, then in reverse. In a frame along the chord,
with the offset e from it, that is

    e'' = k(M) (1 + e'^2)^(3/2),   M = M_A + m x + H e,   e = 0 at both ends,

with the component H of F along the chord and m from the moments at the ends. It is solved by central differences and
Newton's method.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_banded

NODES = 60  # parts of a free part
ITERATIONS, SOLVED = 40, 1e-10  # of Newton's method; last change of the offset, mm
LARGEST = 0.5  # change of the offset in an iteration, mm
SMALLEST = 2.0**-6  # part of a change, halved until less is left of the equation
FLATTEST = 1e-3  # least slope of the moment over the curvature, over the elastic stiffness


@dataclass(frozen=True)
class Branch:
    """Curvature over the moment as it falls from its value at a tool, both rising; that of the first tool is positive.

    stiffness: elastic, N mm.
    """

    curvatures: np.ndarray
    moments: np.ndarray
    stiffness: float

    @classmethod
    def of(cls, curvatures: np.ndarray, moments: np.ndarray, stiffness: float) -> "Branch":
        """Return the branch of curvatures that fall, 1/mm, and their moments, N, which are made to fall as well where
        the section softens under tension."""
        falling = [float(moments[0])]
        for step, moment in zip(np.diff(curvatures), moments[1:]):
            falling.append(min(float(moment), falling[-1] + FLATTEST * stiffness * float(step)))
        return cls(np.array(curvatures, float)[::-1], np.array(falling)[::-1], stiffness)

    def moved(self, curvature: float, moment: float) -> "Branch":
        """Return the branch from another first curvature on, with the same end."""
        part = (self.curvatures - self.curvatures[0]) / (self.curvatures[-1] - self.curvatures[0])
        return Branch(self.curvatures + part * (curvature - self.curvatures[-1]),
                      self.moments + part * (moment - self.moments[-1]), self.stiffness)

    def moment(self, curvature: float) -> float:
        """Return the moment at a curvature, beyond the end by the slope there."""
        if curvature < self.curvatures[0]:
            slope = (self.moments[1] - self.moments[0]) / (self.curvatures[1] - self.curvatures[0])
            return float(self.moments[0] + slope * (curvature - self.curvatures[0]))
        return float(np.interp(curvature, self.curvatures, self.moments))

    def at(self, moments: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return curvatures and their derivatives by the moment, of moments along the path: elastic where the moment
        has risen again, and above that at the first tool."""
        lowest = np.minimum.accumulate(np.minimum(moments, self.moments[-1]))
        i = np.clip(np.searchsorted(self.moments, lowest), 1, len(self.moments) - 1)
        slopes = (self.curvatures[i] - self.curvatures[i - 1]) / (self.moments[i] - self.moments[i - 1])
        rise = moments - lowest
        found = self.curvatures[i - 1] + slopes * (lowest - self.moments[i - 1]) + rise / self.stiffness
        return found, np.where(rise > 0, 1 / self.stiffness, slopes)


@dataclass(frozen=True)
class Span:
    """A free part. slopes: at its ends, radian, downwards positive; steepest: largest in it; force: x and y, N/mm;
    moment: at its end, N; near: curvature before its end, 1/mm; pressing: force across the sheet at its end, N/mm;
    offsets: from the chord, mm."""

    slopes: tuple[float, float]
    steepest: float
    force: np.ndarray
    moment: float
    near: float
    pressing: float
    offsets: np.ndarray


@dataclass(frozen=True)
class Start:
    """Where a free part leaves a tool: place, mm; slope, radian, downwards positive; moment, N, and curvature, 1/mm,
    positive towards the tool; tension, N/mm; side: 1 of a tool below the sheet, -1 of one above."""

    place: tuple[float, float]
    slope: float
    moment: float
    curvature: float
    tension: float
    side: int


def free_span(start: Start, end: tuple[float, float], last: float, branch: Branch, offsets: np.ndarray,
              before: float) -> Span:
    """Return the free part to a place, where its curvature is `last`, 1/mm, in reverse; offsets: to start from;
    before: distance from its end at which `near` is taken, mm."""
    along, down = end[0] - start.place[0], start.place[1] - end[1]
    length, chord, side = math.hypot(along, down), math.atan2(down, along), start.side
    bent = branch.moved(start.curvature, start.moment)
    moment = bent.moment(-last)
    rise = (moment - start.moment) / length
    force = np.linalg.solve([[math.sin(chord), math.cos(chord)], [math.cos(start.slope), -math.sin(start.slope)]],
                            [side * rise, start.tension])
    pull = side * (force[0] * math.cos(chord) - force[1] * math.sin(chord))
    places, size = np.linspace(0.0, length, len(offsets)), length / (len(offsets) - 1)
    straight = start.moment + rise * places

    def state(at: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        curvatures, slopes = bent.at(straight + pull * at)
        return *newton(at, side * curvatures, side * pull * slopes, size), curvatures

    excess, change, curvatures = state(offsets)
    for _ in range(ITERATIONS):
        part = min(1.0, LARGEST / max(float(np.abs(change).max()), SOLVED))
        while True:
            trial = offsets.copy()
            trial[1:-1] += part * change
            found = state(trial)
            if np.linalg.norm(found[0]) < np.linalg.norm(excess) or part < SMALLEST:
                break
            part /= 2
        offsets, done = trial, float(np.abs(change).max()) <= SOLVED
        excess, change, curvatures = found
        if done:
            break
    inner = np.diff(offsets) / size
    bends = side * curvatures * (1 + np.gradient(offsets, size)**2)**1.5
    ends = (inner[0] - size / 6 * (2 * bends[0] + bends[1]), inner[-1] + size / 6 * (2 * bends[-1] + bends[-2]))
    first, second = (chord + math.atan(slope) for slope in ends)
    steep = np.array([first, *(chord + np.arctan(inner)), second])
    return Span((first, second), float(steep[np.abs(steep).argmax()]), force, moment,
                float(np.interp(length - before, places, curvatures)),
                abs(float(force[0] * math.sin(second) + force[1] * math.cos(second))), offsets)


def newton(offsets: np.ndarray, curvatures: np.ndarray, derivatives: np.ndarray,
           size: float) -> tuple[np.ndarray, np.ndarray]:
    """Return what is left of the equation and Newton's change of the inner offsets; derivatives: of curvatures by
    offsets; size: of a part, mm."""
    slope = (offsets[2:] - offsets[:-2]) / (2 * size)
    factor = (1 + slope**2)**1.5
    excess = (offsets[2:] - 2 * offsets[1:-1] + offsets[:-2]) / size**2 - curvatures[1:-1] * factor
    turn = 3 * curvatures[1:-1] * slope * np.sqrt(1 + slope**2) / (2 * size)
    bands = np.zeros((3, len(excess)))
    bands[0, 1:] = (1 / size**2 - turn)[:-1]
    bands[1] = -2 / size**2 - derivatives[1:-1] * factor
    bands[2, :-1] = (1 / size**2 + turn)[1:]
    return excess, np.asarray(solve_banded((1, 1), bands, -excess))
