# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves as points: their number for a distance from the curve, and pieces that are equal or have no length."""
from collections.abc import Callable, Sequence

import numpy as np
from scipy.spatial import cKDTree

MOST = 4096  # pieces of a curve in equal steps
FEW = 64  # points that are not thinned
JOIN = 1e-4  # largest gap between ends that are joined, over the size of all curves
SAME = 1e-9  # distance of equal points over the size of all curves

Value = Callable[[np.ndarray], np.ndarray]


def sampled(value: Value, places: np.ndarray, chord: float) -> np.ndarray:
    """Return points of a curve in equal steps of its parameter, close enough for the chord, or unequal ones where
    equal steps pass over a part of the curve or take many times the points. `places`: parameters, from the first to
    the last, between which the curve is smooth, such as parts of the spans between its knots."""
    steps, points = even(value, places[0], places[-1], chord)
    at = np.clip(np.searchsorted(steps, places, side="right") - 1, 0, len(steps) - 2)
    close = bool(distances(value(places), points[at], points[at + 1]).max() <= chord)
    if close and len(points) <= FEW:
        return points
    fewer = thinned(refined(value, places, 0.25 * chord), 0.75 * chord)
    return points if close and len(points) <= min(4 * len(fewer), 2 * MOST) else fewer


def even(value: Value, low: float, high: float, chord: float) -> tuple[np.ndarray, np.ndarray]:
    """Return equal steps of a parameter, half of those whose middles are close enough, and their points; the ends alone
    of a straight line."""
    count = 1
    while True:
        steps = np.linspace(low, high, 2 * count + 1)
        points = value(steps)
        sag = np.linalg.norm(points[1::2] - 0.5 * (points[:-1:2] + points[2::2]), axis=1).max()
        if (sag <= chord and count >= 4) or count > MOST:
            straight = sag <= 1e-9 * np.linalg.norm(points[-1] - points[0])
            return (steps[[0, -1]], points[[0, -1]]) if straight else (steps, points)
        count *= 2


def refined(value: Value, places: np.ndarray, chord: float) -> np.ndarray:
    """Return points of a curve at the places and between them, where the quarters of a step are not close enough."""
    steps, most = places, len(places) + 4 * MOST
    while True:
        points, width = value(steps), np.diff(steps)
        off = [distances(value(steps[:-1] + part * width), points[:-1], points[1:]) for part in (0.25, 0.5, 0.75)]
        coarse = np.flatnonzero(np.max(off, axis=0) > chord)
        if not len(coarse) or len(steps) > most:
            return points
        steps = np.insert(steps, coarse + 1, steps[coarse] + 0.5 * width[coarse])


def thinned(points: np.ndarray, chord: float) -> np.ndarray:
    """Return the points of a line that keep the others within a distance (Douglas and Peucker 1973)."""
    keep = np.zeros(len(points), bool)
    keep[[0, -1]] = True
    left = [(0, len(points) - 1)]
    while left:
        first, last = left.pop()
        if last - first < 2:
            continue
        off = distances(points[first + 1:last], points[first], points[last])
        farthest = int(off.argmax())
        if off[farthest] > chord:
            middle = first + 1 + farthest
            keep[middle] = True
            left += [(first, middle), (middle, last)]
    return points[keep]


def distances(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Return the distances of points from straight lines between two points, one for each or the same for all."""
    along, to = end - start, points - start
    square = np.sum(along * along, axis=-1)
    part = np.clip(np.sum(to * along, axis=-1) / np.where(square > 0, square, 1.0), 0.0, 1.0)
    return np.asarray(np.linalg.norm(to - part[..., None] * along, axis=-1))


def length_of(points: np.ndarray) -> float:
    """Return the length of a line."""
    return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())


def size_of(pieces: Sequence[np.ndarray]) -> float:
    """Return the size of all curves."""
    return float(np.ptp(np.vstack(pieces), axis=0).max()) if pieces else 0.0


def points_only(pieces: Sequence[np.ndarray], size: float = 0.0) -> list[int]:
    """Return the indices of the pieces of length 0. size: of what they belong to, if it is larger than they are, mm."""
    least = SAME * max(size, size_of(pieces))
    return [index for index, piece in enumerate(pieces) if length_of(piece) <= least]


def repeated(pieces: Sequence[np.ndarray], chord: float) -> list[int]:
    """Return the indices of the pieces, with a length, that are equal to an earlier one within the chord, in either
    direction and from any point of a closed one."""
    if len(pieces) < 2:
        return []
    lengths = np.array([length_of(piece) for piece in pieces])
    near = np.minimum(min(chord, JOIN * size_of(pieces)), 1e-3 * lengths)
    tree = cKDTree(keys := np.array([(*centre_of(piece), length) for piece, length in zip(pieces, lengths)]))
    found: set[int] = set()
    for index, piece in enumerate(pieces):
        if index not in found:  # the length of the chords of an arc differs by up to 2/3 of its angle times their sag
            found |= {other for other in tree.query_ball_point(keys[index], 6 * near[index])
                      if other > index and other not in found
                      and lies_on(piece, pieces[other], near[index]) and lies_on(pieces[other], piece, near[index])}
    return sorted(found)


def centre_of(points: np.ndarray) -> np.ndarray:
    """Return the centre of the length of a line."""
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return np.asarray(lengths @ (points[:-1] + points[1:]) / (2 * lengths.sum()))


def lies_on(piece: np.ndarray, other: np.ndarray, near: float) -> bool:
    """Tell whether points of a line lie on another one."""
    some = piece[::max(1, len(piece) // 256)]
    return bool((distances(some[:, None], other[None, :-1], other[None, 1:]).min(axis=1) <= near).all())
