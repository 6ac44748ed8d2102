# SPDX-License-Identifier: GPL-3.0-or-later
"""Phases from the motions and forces of an LS-DYNA deck, which are functions of time."""

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from dd3.dyna.deck import Deck, Drive
from dd3.errors import Problem

STILL = 1e-6  # displacement in a stage over that of the whole process that counts as none
SLOW = 1e-3  # velocity over the largest one of a tool that counts as none
SAME = 1e-3  # distance of times, over the time of the whole process, that count as one
MOST_KINKS = 8  # points of a curve of a force that divide the process
SAMPLES = 400  # of a curve between its points


@dataclass
class Stage:
    """A part of the process: displacement and turn (rad) of each tool over it, force on each at its end, and force on
    each node of sets at its end, in units of the deck."""

    begins: float
    ends: float
    moves: dict[int, np.ndarray] = field(default_factory=dict)
    turns: dict[int, np.ndarray] = field(default_factory=dict)
    forces: dict[int, np.ndarray] = field(default_factory=dict)
    loads: dict[int, np.ndarray] = field(default_factory=dict)

    @property
    def moving(self) -> set[int]:
        """The tools that move or turn."""
        return self.moves.keys() | self.turns.keys()


def displacement(deck: Deck, drive: Drive, times: np.ndarray) -> np.ndarray:
    """Return the displacement by a motion at times."""
    curve = deck.curve(drive.curve, drive.place)
    inside = np.clip(times, drive.begins, min(drive.ends, 1e30)) - drive.begins
    if drive.kind == "displacement":
        value = np.interp(inside, curve.x, curve.y)
        return drive.scale * (value - np.interp(0.0, curve.x, curve.y))
    path = np.concatenate([[0.0], np.cumsum(np.diff(curve.x) * (curve.y[1:] + curve.y[:-1]) / 2)])
    return drive.scale * (integral(curve.x, curve.y, path, inside) - integral(curve.x, curve.y, path, np.zeros(1))[0])


def integral(x: np.ndarray, y: np.ndarray, path: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the integral of a polygon, constant beyond its ends, from its first point to other abscissae."""
    i = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    inner = np.clip(at, x[0], x[-1])
    part = inner - x[i]
    slope = (y[i + 1] - y[i]) / (x[i + 1] - x[i])
    result: np.ndarray = path[i] + part * (y[i] + slope * part / 2)
    return result + np.where(at > x[-1], (at - x[-1]) * y[-1], 0.0) + np.where(at < x[0], (at - x[0]) * y[0], 0.0)


def end_time(deck: Deck) -> float:
    """Return the time at which the process ends."""
    ends = deck.end_time
    if not ends:
        ends = max((float(deck.curve(drive.curve, drive.place).x[-1]) + drive.begins for drive in deck.drives),
                   default=0.0)
    if not ends > 0:
        raise Problem(f"{deck.path}: no tool moves and none is pressed: expected *BOUNDARY_PRESCRIBED_MOTION_RIGID or "
                      "*LOAD_RIGID_BODY")
    return ends


def stages(deck: Deck, drives: Iterable[Drive]) -> list[Stage]:
    """Return the stages of a process: within one the same tools move."""
    drives, end = list(drives), end_time(deck)
    times = np.unique(np.concatenate([np.linspace(0, end, SAMPLES)]
                                     + [points_in_time(deck, drive, end) for drive in drives]))
    moved: dict[tuple[int, int, bool], np.ndarray] = {}
    kinks = []
    for drive in drives:
        if drive.kind != "force":
            path = moved.setdefault((drive.target, drive.axis, drive.turns), np.zeros(len(times)))
            path += displacement(deck, drive, times)
        elif len(points := points_in_time(deck, drive, end)) <= MOST_KINKS:
            kinks += points.tolist()
    found = []
    for first, last in zip(borders := breaks(times, moved, [0.0, end, *kinks]), borders[1:]):
        stage = Stage(first, last)
        for (tool, axis, turns), path in moved.items():
            change = float(np.interp(last, times, path) - np.interp(first, times, path))
            if abs(change) > STILL * max(np.ptp(path), 1e-12):
                (stage.turns if turns else stage.moves).setdefault(tool, np.zeros(3))[axis] += change
        for drive in drives:
            if drive.kind == "force":
                curve = deck.curve(drive.curve, drive.place)
                value = drive.scale * np.interp(last, curve.x, curve.y)
                if value:
                    target = stage.loads if drive.of_set else stage.forces
                    target.setdefault(drive.target, np.zeros(3))[drive.axis] += value
        found.append(stage)
    return merged(found)


def points_in_time(deck: Deck, drive: Drive, end: float) -> np.ndarray:
    """Return the times of the points of a drive's curve within the process."""
    times = deck.curve(drive.curve, drive.place).x + drive.begins
    times = np.append(times, [drive.begins, drive.ends])
    return times[(times >= 0) & (times <= end)]


def breaks(times: np.ndarray, moved: dict, others: list[float]) -> list[float]:
    """Return the times at which tools start or stop, with others, those of start and end among them."""
    found = list(others)
    for path in moved.values():
        rate = np.abs(np.diff(path)) / np.diff(times)
        moving = rate > SLOW * max(rate.max(initial=0.0), 1e-300)
        for i in np.flatnonzero(np.diff(np.concatenate([[False], moving, [False]]).astype(int))):
            found.append(float(times[i]))
    result: list[float] = []
    for time in sorted(found):
        if not result or time - result[-1] > SAME * max(found):
            result.append(time)
    return result


def merged(found: list[Stage]) -> list[Stage]:
    """Return the stages without those in which nothing happens; neighbours in which the same tools move under the same
    forces are one."""
    result: list[Stage] = []
    for stage in found:
        last = result[-1] if result else Stage(0.0, 0.0)
        if not same(stage.forces, last.forces) or not same(stage.loads, last.loads) or (
                stage.moving and stage.moving != last.moving):
            result.append(stage)
        elif stage.moving:
            last.ends = stage.ends
            for one, other in (last.moves, stage.moves), (last.turns, stage.turns):
                for tool, change in other.items():
                    one[tool] = one.get(tool, 0.0) + change
    return result


def same(one: dict[int, np.ndarray], other: dict[int, np.ndarray]) -> bool:
    """Check whether forces are the same."""
    return one.keys() == other.keys() and all(np.allclose(force, other[tool]) for tool, force in one.items())
