# SPDX-License-Identifier: GPL-3.0-or-later
"""Scales of fields, in pictures and on the page of a run: unit, round limits, ticks and colours.

Strains and thinning are in per cent. Limits and ticks are multiples of a step of 1, 2 or 5 times a power of ten. Where
zero lies within the limits the map diverges from white at zero, blue below and red above; elsewhere it is perceptually
uniform. Both maps can be told apart with the usual kinds of colour blindness. The scale of a field that has a limit
goes from 0 to the limit, 1, at least; from there on one colour marks what is beyond.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import matplotlib
import numpy as np
from matplotlib.colors import ListedColormap, to_rgba

from dd3.fields import LIMITED

SEQUENTIAL, DIVERGING = "viridis", "RdBu_r"
INTERVALS = 8  # of a scale, at most
STEPS = (1, 2, 5, 10)  # of ticks, times a power of ten
FLAT = 1e-9  # range of a field that has one value, over its magnitude
NARROW = 1e-3  # range that is drawn of such a field, over its magnitude; of zero, in its unit
MOST_DIGITS = 9  # behind the point
COLOURS = 256  # of a map
BEYOND = "#d55e00"  # colour of values beyond a limit


class Scale(NamedTuple):
    """Ends of a scale, the distance of its ticks, and the limit of the field if it has one, in the unit shown."""

    low: float
    high: float
    step: float
    limit: float | None = None

    @property
    def ticks(self) -> list[float]:
        """The multiples of the step within the limits."""
        first, last = math.ceil(self.low / self.step - 1e-6), math.floor(self.high / self.step + 1e-6)
        return [number * self.step for number in range(first, last + 1)]

    @property
    def digits(self) -> int:
        """The digits behind the point that the step needs."""
        return max(0, min(MOST_DIGITS, -math.floor(math.log10(self.step) + 1e-9)))

    @property
    def is_signed(self) -> bool:
        """Whether zero lies within the limits."""
        return self.low < 0 < self.high


def in_per_cent(field: str) -> bool:
    """Tell whether a field is shown in per cent."""
    name = field.partition(":")[0]
    return name == "thinning" or "strain" in name


def shown(field: str, values: np.ndarray, label: str) -> tuple[np.ndarray, str]:
    """Return values and label of a field as they are shown."""
    return (100 * values, f"{label} (%)") if in_per_cent(field) else (values, label)


def step_of(low: float, high: float) -> float:
    """Return the distance of ticks between limits: the smallest of 1, 2 or 5 times a power of ten that gives at most
    INTERVALS."""
    least = (high - low) / INTERVALS
    power = 10.0 ** math.floor(math.log10(least))
    return next(factor * power for factor in STEPS if factor * power >= 0.999 * least)


def round_scale(low: float, high: float) -> Scale:
    """Return the scale of values between two ends: the limits are the next multiples of the step outside."""
    if high - low <= FLAT * max(abs(low), abs(high)):
        high = low + (NARROW * abs(low) or NARROW)
    step = step_of(low, high)
    # The last + 0.0 makes 0 of -0.
    return Scale(math.floor(low / step + 1e-6) * step + 0.0, math.ceil(high / step - 1e-6) * step + 0.0, step)


def scale_of(field: str, low: float, high: float) -> Scale:
    """Return the round scale of a field with values between two ends."""
    if field not in LIMITED:
        return round_scale(low, high)
    return round_scale(min(low, 0.0), max(high, 1.0))._replace(limit=1.0)


def own_scale(field: str, limits: Sequence[float]) -> Scale:
    """Return the scale of a field between limits that are given."""
    return Scale(limits[0], limits[1], step_of(*limits), 1.0 if field in LIMITED else None)


def colours_of(scale: Scale, chosen: str | Sequence[str] | None = None) -> ListedColormap:
    """Return the colours of a scale from its lower to its upper limit: those of a list, of a map by its name, or by the
    rule above."""
    if not (chosen is None or isinstance(chosen, str)):
        return ListedColormap(chosen)
    at = np.linspace(0, 1, COLOURS)
    values = scale.low + at * (scale.high - scale.low)
    if chosen is None and scale.is_signed:
        at = 0.5 + 0.5 * values / max(-scale.low, scale.high)
    if scale.limit is not None and scale.low < scale.limit < scale.high:
        at = (values - scale.low) / (scale.limit - scale.low)
    colours = matplotlib.colormaps[chosen or (DIVERGING if scale.is_signed else SEQUENTIAL)](at)
    if scale.limit is not None:
        colours[values >= scale.limit] = to_rgba(BEYOND)
    return ListedColormap(colours)
