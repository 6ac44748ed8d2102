# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistics of the results of scattered runs: bands, and probabilities of failure."""

from typing import NamedTuple

import numpy as np
from scipy import stats

from dd3.errors import Problem


class Bands(NamedTuple):
    """Mean, standard deviation and quantiles of results by place; quantiles: (levels, places)."""

    mean: np.ndarray
    deviation: np.ndarray
    quantiles: np.ndarray


class Failure(NamedTuple):
    """Failed runs of all, their part, and the confidence interval of the probability of failure."""

    failed: int
    runs: int
    part: float
    low: float
    high: float


def bands(results: np.ndarray, levels: tuple[float, ...] = (0.05, 0.5, 0.95)) -> Bands:
    """Return the bands of results (runs, places); two runs at least."""
    if len(results) < 2:
        raise Problem(f"bands take two runs or more, not {len(results)}")
    return Bands(results.mean(axis=0), results.std(axis=0, ddof=1), np.quantile(results, levels, axis=0))


def failure(failed: np.ndarray, confidence: float = 0.95) -> Failure:
    """Return the probability of failure of runs, True where one failed, with the interval of C. J. Clopper and
    E. S. Pearson, Biometrika 26 (1934) 404-413. It is that of independent runs; those of a Latin hypercube are not."""
    count, runs = int(np.sum(failed)), len(failed)
    if not runs:
        raise Problem("a probability of failure takes one run or more")
    interval = stats.binomtest(count, runs).proportion_ci(confidence, method="exact")
    return Failure(count, runs, count / runs, float(interval.low), float(interval.high))
