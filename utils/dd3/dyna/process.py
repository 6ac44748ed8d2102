# SPDX-License-Identifier: GPL-3.0-or-later
"""Phases from the motions, forces and gravity of an LS-DYNA deck, which are functions of time.

The displacements and turns of all tools together are a path. It is divided where it turns: where a tool starts, stops,
reverses, or where tools go on in other proportions. Within a stage the path is straight, so that only its length, not
its velocity, tells; a force that changes meanwhile becomes a table over the fraction of that length.
"""
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from dd3.dyna.deck import Deck, Drive
from dd3.errors import Problem

STILL = 1e-6  # displacement in a stage over that of the whole process that counts as none
REST = 1e-9  # the same between two samples, where nothing moves
STRAIGHT = 2e-3  # distance of the path from a straight line, over the extent of the path
EVEN = 2e-3  # the same of a force over its largest value
SAME = 1e-4  # distance of times, over the time of the whole process, that count as one
SAMPLES = 400  # of a curve between its points
MOST_STAGES = 200
NEAR = 2e-3  # progress between points of a table that counts as little
LEAST_PROGRESS = 2e-4  # between the points of a table


@dataclass
class Stage:
    """A part of the process: displacement and turn (rad) of each tool over it; forces on tools and on each node of
    sets, and gravity, at points of its progress (0 to 1), in units of the deck."""

    begins: float
    ends: float
    moves: dict[int, np.ndarray] = field(default_factory=dict)
    turns: dict[int, np.ndarray] = field(default_factory=dict)
    forces: dict[int, "History"] = field(default_factory=dict)
    loads: dict[int, "History"] = field(default_factory=dict)
    gravity: "History | None" = None
    clock: "History | None" = None  # the time

    @property
    def moving(self) -> set[int]:
        """The tools that move or turn."""
        return self.moves.keys() | self.turns.keys()


@dataclass
class History:
    """Values (n, 3) at points of the progress, from 0 to 1."""

    progress: np.ndarray
    values: np.ndarray

    @property
    def first(self) -> np.ndarray:
        """The value at the start."""
        return np.asarray(self.values[0])

    @property
    def last(self) -> np.ndarray:
        """The value at the end."""
        return np.asarray(self.values[-1])


def displacement(deck: Deck, drive: Drive, times: np.ndarray) -> np.ndarray:
    """Return the displacement by a motion at times; its curve begins at its birth."""
    curve = deck.curves.get(drive.curve, drive.place)
    inside = np.clip(times, drive.begins, min(drive.ends, 1e30)) - drive.begins
    if drive.kind == "displacement":
        value = np.interp(inside, curve.x, curve.y)
        return np.asarray(drive.scale * (value - np.interp(0.0, curve.x, curve.y)))
    path = np.concatenate([[0.0], np.cumsum(np.diff(curve.x) * (curve.y[1:] + curve.y[:-1]) / 2)])
    return np.asarray(drive.scale * (integral(curve.x, curve.y, path, inside)
                                     - integral(curve.x, curve.y, path, np.zeros(1))[0]))


def integral(x: np.ndarray, y: np.ndarray, path: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return the integral of a polygon, constant beyond its ends, from its first point to other abscissae."""
    i = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(x) - 2)
    inner = np.clip(at, x[0], x[-1])
    part = inner - x[i]
    slope = (y[i + 1] - y[i]) / (x[i + 1] - x[i])
    result: np.ndarray = path[i] + part * (y[i] + slope * part / 2)
    return result + np.where(at > x[-1], (at - x[-1]) * y[-1], 0.0) + np.where(at < x[0], (at - x[0]) * y[0], 0.0)


def end_time(deck: Deck, drives: Iterable[Drive]) -> float:
    """Return the time at which the process ends."""
    ends = deck.end_time
    if not ends:
        ends = max((float(deck.curves.get(drive.curve, drive.place).x[-1]) + drive.begins for drive in drives),
                   default=0.0)
    if not ends and deck.gravity:
        ends = 1.0
    if not 0 < ends < 1e30:
        raise Problem(f"{deck.path}: no tool moves and none is pressed: expected *BOUNDARY_PRESCRIBED_MOTION_RIGID or "
                      "*LOAD_RIGID_BODY")
    return ends


Key = tuple[str, int]  # kind and target


def stages(deck: Deck, drives: Iterable[Drive]) -> list[Stage]:
    """Return the stages of a process."""
    drives = list(drives)
    end = end_time(deck, drives)
    times = sample_times(deck, drives, end)
    moved: dict[Key, np.ndarray] = {}
    acting: dict[Key, np.ndarray] = {}
    for drive in drives:
        if drive.kind == "force":
            curve = deck.curves.get(drive.curve, drive.place)
            key = "load" if drive.of_set else "force", drive.target
            value = drive.scale * np.interp(times, curve.x, curve.y)
            acting[key] = acting.get(key, 0.0) + np.outer(value, drive.direction)
        else:
            key = "turn" if drive.turns else "move", drive.target
            moved[key] = moved.get(key, 0.0) + np.outer(displacement(deck, drive, times), drive.direction)
    for body in deck.gravity:
        curve = deck.curves.get(body.curve, body.place)
        value = body.scale * np.interp(times, curve.x, curve.y)
        acting["gravity", 0] = acting.get(("gravity", 0), 0.0) + np.outer(value, body.direction)
    if not all(np.all(np.abs(path) < 1e30) for path in (*moved.values(), *acting.values())):
        raise Problem(f"{deck.path}: a motion or a force is beyond 1e30")
    found = [stage_of(times, a, b, moved, acting) for a, b in pairs_of(corners(times, moved, acting))]
    if len(found) > MOST_STAGES:
        raise Problem(f"{deck.path}: the motions have {len(found)} phases; expected {MOST_STAGES} at most")
    return merged(found)


def sample_times(deck: Deck, drives: list[Drive], end: float) -> np.ndarray:
    """Return times of the process: the points of all curves and others between them."""
    points = [np.linspace(0, end, SAMPLES)]
    for curve, shift, ends in [(deck.curves.get(one.curve, one.place), one.begins, one.ends) for one in drives] + [
            (deck.curves.get(one.curve, one.place), 0.0, np.inf) for one in deck.gravity]:
        inner = np.concatenate([np.linspace(a, b, 9) for a, b in pairwise(curve.x)]) if len(curve.x) < 60 else (
            curve.x)
        points.append(np.append(inner + shift, [shift, ends]))
    times = np.unique(np.concatenate(points))
    times = times[(times >= 0) & (times <= end)]
    return times[np.append(True, np.diff(times) > 1e-9 * end)]


def corners(times: np.ndarray, moved: dict[Key, np.ndarray], acting: dict[Key, np.ndarray]) -> list[int]:
    """Return the times, by their numbers, at which the path turns; while nothing moves, those of the forces."""
    columns = [path / max(float(np.abs(path - path[0]).max()), 1e-300) for path in moved.values()
               if np.ptp(path, axis=0).any()]
    last = len(times) - 1
    found = {0, last}
    if columns:
        path = np.hstack(columns)
        length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
        rests = np.diff(length) <= REST * max(length[-1], 1e-300)
        change = np.flatnonzero(np.diff(rests.astype(int))) + 1
        found |= set(change.tolist())
        for a, b in pairs_of(sorted(found)):
            if not rests[a]:
                found |= turning_points(path, a, b)
    else:
        rests = np.ones(last, bool)
    for a, b in pairs_of(sorted(found)):
        if rests[a] and acting:
            found |= turning_points(scaled(acting), a, b)
    result: list[int] = []
    for i in sorted(found):
        if result and times[i] - times[result[-1]] <= SAME * times[-1] and i != last:
            continue
        result.append(i)
    return result


def scaled(acting: dict[Key, np.ndarray]) -> np.ndarray:
    """Return forces and gravity over the largest value of each, in columns."""
    return np.hstack([history / max(float(np.abs(history).max()), 1e-300) for history in acting.values()])


def turning_points(path: np.ndarray, first: int, last: int) -> set[int]:
    """Return the corners of the polygon nearest to a part of a path, by the farthest point from each side (Ramer,
    Computer Graphics and Image Processing 1 (1972) 244-256; Douglas, Peucker 1973)."""
    found, waiting = set[int](), [(first, last)]
    while waiting:
        a, b = waiting.pop()
        if b - a < 2:
            continue
        inner, side = path[a + 1:b] - path[a], path[b] - path[a]
        part = np.clip(inner @ side / max(float(side @ side), 1e-300), 0, 1) if np.any(side) else np.zeros(len(inner))
        away = np.linalg.norm(inner - np.outer(part, side), axis=1)
        k = a + 1 + int(away.argmax())
        if away.max() <= STRAIGHT:
            way = path[a:b + 1] @ side / max(float(np.linalg.norm(side)), 1e-300)
            back = np.maximum.accumulate(way) - way
            if back.max() <= STRAIGHT:
                continue
            k = a + int(way[:int(back.argmax()) + 1].argmax())
        found.add(k)
        waiting += [(a, k), (k, b)]
    return found


def pairs_of(numbers: list[int]) -> list[tuple[int, int]]:
    """Return neighbours."""
    return list(pairwise(numbers))


def stage_of(times: np.ndarray, first: int, last: int, moved: dict[Key, np.ndarray],
             acting: dict[Key, np.ndarray]) -> Stage:
    """Return the stage between two times."""
    stage = Stage(float(times[first]), float(times[last]))
    along = np.zeros(last - first + 1)
    for (kind, target), path in moved.items():
        change, extent = path[last] - path[first], max(float(np.abs(path - path[0]).max()), 1e-300)
        if np.abs(change).max() > STILL * extent:
            (stage.turns if kind == "turn" else stage.moves)[target] = change
            along = along + np.linalg.norm(path[first:last + 1] - path[first], axis=1) / extent
    if not stage.moving and acting:  # the time says nothing, only how far the forces have come
        steps = np.diff(scaled(acting)[first:last + 1], axis=0)
        along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(steps, axis=1))])
    if not along[-1] > 0:
        along = times[first:last + 1] - times[first]
    stage.clock = History(along / along[-1], times[first:last + 1, None])
    progress = np.maximum.accumulate(along / along[-1])
    for (kind, target), history in acting.items():
        found = history_of(progress, history[first:last + 1], float(np.abs(history).max()))
        if kind == "gravity":
            stage.gravity = found
        elif found.values.any():
            (stage.forces if kind == "force" else stage.loads)[target] = found
    return stage


def history_of(progress: np.ndarray, values: np.ndarray, largest: float) -> History:
    """Return values over the progress, at the points at which they turn."""
    scaled = np.column_stack((progress, values / max(largest, 1e-300)))
    keep = sorted({0, len(progress) - 1} | upright_points(scaled))
    at = [float(progress[keep[0]])]  # apart by LEAST_PROGRESS, where a tool hardly moves while a force changes
    for k, i in enumerate(keep[1:-1], 1):
        room = (len(keep) - 1 - k) * LEAST_PROGRESS
        at.append(float(np.clip(progress[i], at[-1] + LEAST_PROGRESS, max(1 - room, at[-1] + LEAST_PROGRESS))))
    at.append(1.0)
    if at[-2] >= 1:
        return History(np.array([0.0, 1.0]), values[[0, -1]])
    return History(np.array(at), values[keep])


def divided(stage: Stage, points: Iterable[float]) -> list[Stage]:
    """Return a stage divided at points of its progress."""
    borders = [0.0, *(point for point in sorted(set(points)) if LEAST_PROGRESS < point < 1 - LEAST_PROGRESS), 1.0]
    return [part_of(stage, a, b) for a, b in pairwise(borders)]


def part_of(stage: Stage, first: float, last: float) -> Stage:
    """Return the part of a stage between two points of its progress."""
    def cut(history: History) -> History:
        at = np.array([first, *(point for point in history.progress if first < point < last), last])
        values = np.column_stack([np.interp(at, history.progress, column) for column in history.values.T])
        return History((at - first) / (last - first), values)

    clock = cut(stage.clock or History(np.array([0.0, 1.0]), np.array([[stage.begins], [stage.ends]])))
    result = Stage(float(clock.values[0, 0]), float(clock.values[-1, 0]),
                   {tool: (last - first) * move for tool, move in stage.moves.items()},
                   {tool: (last - first) * turn for tool, turn in stage.turns.items()})
    for target, source in (result.forces, stage.forces), (result.loads, stage.loads):
        for key, history in source.items():
            if (one := cut(history)).values.any():
                target[key] = one
    result.gravity, result.clock = cut(stage.gravity) if stage.gravity else None, clock
    return result


def upright_points(table: np.ndarray) -> set[int]:
    """Return the corners of the polygon nearest to values over an abscissa in the first column, by the largest
    difference of the values."""
    found, waiting = set[int](), [(0, len(table) - 1)]
    while waiting:
        a, b = waiting.pop()
        width = table[b, 0] - table[a, 0]
        if b - a < 2 or not width > 0:
            continue
        part = ((table[a + 1:b, 0] - table[a, 0]) / width)[:, None]
        away = np.abs(table[a + 1:b, 1:] - table[a, 1:] - part * (table[b, 1:] - table[a, 1:])).max(axis=1)
        inside = table[a + 1:b, 0]  # points near others cost increments: they are taken where much is lost without them
        away = np.where(np.minimum(inside - table[a, 0], table[b, 0] - inside) < NEAR, away / 10, away)
        if away.max() > EVEN:
            k = a + 1 + int(away.argmax())
            found.add(k)
            waiting += [(a, k), (k, b)]
    return found


def merged(found: list[Stage]) -> list[Stage]:
    """Return the stages without those in which nothing happens: none moves, and the forces do not change."""
    result: list[Stage] = []
    for stage in found:
        steady = not stage.moving and result and all(
            now.keys() == before.keys() and all(np.allclose(one.values, before[key].last) for key, one in now.items())
            for now, before in ((stage.forces, result[-1].forces), (stage.loads, result[-1].loads))) and (
                stage.gravity is None or np.allclose(stage.gravity.values, getattr(result[-1].gravity, "last", 0.0)))
        empty = not stage.moving and not stage.forces and not stage.loads and (
            stage.gravity is None or not stage.gravity.values.any())
        if not steady and not (empty and not result):
            result.append(stage)
    return result
