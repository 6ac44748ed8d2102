# SPDX-License-Identifier: GPL-3.0-or-later
"""Flow stress of a material as curves of LS-DYNA: of tension along the rolling direction, from the laws' library.

Where the equivalent stress of unit tension along rolling is s, the flow stress there is Y/s at the plastic strain s p.
LS-DYNA replaces the points of a curve by LCINT equal intervals, beyond the last one it goes on straight.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from dd3.laws import Material

TOLERANCE = 1e-4  # of the straight lines between points, over the flow stress
DEEPEST = 17  # halvings of the range of the plastic strain
INTERVALS = (100, 200, 500, 1000, 2000, 5000)  # LCINT
EVEN = 1e-3  # error of equal intervals that is sought
FIRST = 2e-3  # plastic strain from which this error counts
MOST_RATES = 8  # curves of a table
RATES = (1e-3, 1e3)  # of a law that gives none, 1/s
STEPS = 1000  # of tension to the largest strain
Flow = Callable[[float, float], float]  # flow stress at a plastic strain and a rate


@dataclass(frozen=True)
class Sampled:
    """Points of plastic strain and flow stress (n, 2), LCINT, and the largest errors over the flow stress: of the
    straight lines between the points, and of the equal intervals from a plastic strain of 0.002 on."""

    points: np.ndarray
    intervals: int
    error: float
    even_error: float


def sampled(flow: Callable[[float], float], largest: float) -> Sampled:
    """Return a curve as points that lie dense where it is curved."""
    values = {0.0: flow(0.0), largest: flow(largest)}
    error = 0.0
    parts = [(0.0, largest, 0)]
    while parts:
        a, b, depth = parts.pop()
        middle = (a + b) / 2
        value = values.setdefault(middle, flow(middle))
        off = max(abs((values[a] + values[b]) / 2 - value),
                  abs(0.75 * values[a] + 0.25 * values[b] - flow(0.75 * a + 0.25 * b))) / value
        if depth < 3 or (off > TOLERANCE and depth < DEEPEST):
            parts += [(a, middle, depth + 1), (middle, b, depth + 1)]
        else:
            del values[middle]
            error = max(error, off)
    points = np.array(sorted(values.items()))
    even = even_errors(flow, points)
    count = next((n for n in INTERVALS if even[n] < EVEN), INTERVALS[-1])
    return Sampled(points, count, error, even[count])


def even_errors(flow: Callable[[float], float], points: np.ndarray) -> dict[int, float]:
    """Return the errors of equal intervals by their number."""
    largest = points[-1, 0]
    at = np.geomspace(min(FIRST, largest / 2), largest, 200)
    there = np.array([flow(p) for p in at])
    found = {}
    for count in INTERVALS:
        even = np.linspace(0, largest, count + 1)
        found[count] = float(np.abs(np.interp(at, even, np.interp(even, *points.T)) / there - 1).max())
    return found


def flow_of(material: Material, scale: float, backstresses: Sequence[tuple[float, float]] = ()) -> Flow:
    """Return the flow stress along rolling of a material by its hardening law, with back-stresses CX, Xsat in tension.

    scale: equivalent stress of unit tension along rolling.
    """
    state = np.zeros(material.state_size)
    at_rate = material.state_names.index("plastic_strain_rate") if material.has_rate else None

    def flow(p: float, rate: float = 0.0) -> float:
        state[0] = p / scale
        if at_rate is not None:
            state[at_rate] = rate / scale
        own = sum(limit * (1 - np.exp(-c * state[0])) for c, limit in backstresses)
        return float(material.flow_stress(state) + own) / scale
    return flow


def in_tension(material: Material, scale: float, largest: float) -> Flow:
    """Return the stress in tension along rolling over the plastic strain, by integration; its rate is left out."""
    curve = material.curve(1.02 * largest / scale + 0.02, steps=STEPS)
    plastic = curve[curve["plastic_strain"] > 0]
    first = material.flow_stress() / scale
    p = np.append(0.0, scale * plastic["plastic_strain"].to_numpy())
    stress = np.append(first, plastic["stress"].to_numpy())

    def flow(strain: float, rate: float = 0.0) -> float:
        return float(np.interp(strain, p, stress))
    return flow


def rate_error(flow: Flow, rates: Sequence[float], logarithmic: bool, largest: float) -> float:
    """Return the largest error of interpolation between rates, over the flow stress."""
    found = 0.0
    for low, high in pairwise(rates):
        for part in (0.25, 0.5, 0.75):
            rate = low * (high / low)**part
            weight = part if logarithmic else (rate - low) / (high - low)
            for p in (0.0, 0.05 * largest, 0.2 * largest):
                off = (1 - weight) * flow(p, low) + weight * flow(p, high)
                found = max(found, abs(off / flow(p, rate) - 1))
    return found
