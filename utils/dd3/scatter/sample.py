# SPDX-License-Identifier: GPL-3.0-or-later
"""Samples of scattered inputs: Latin hypercubes with given distributions and rank correlations, rows of a table."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy import stats

from dd3.errors import Problem
from dd3.tables import Row, is_whole, read_table

# Keys of the distributions.
NEEDED = {"normal": ("mean", "deviation"), "lognormal": ("mean", "deviation"),
          "truncated": ("mean", "deviation", "low", "high"), "uniform": ("low", "high")}


def distribution(kind: str, **values: float) -> Any:
    """Return a distribution of scipy.

    kind: normal or lognormal (mean and standard deviation of the value itself), truncated (the normal distribution of
    this mean and deviation between low and high), uniform (between low and high). values: `mean`, `deviation`, `low`
    and `high`, as the kind needs.
    Errors: no such kind; other values than it needs; a deviation, or a range, that is not positive; a lognormal mean
    that is not positive.
    """
    if kind not in NEEDED:
        raise Problem(f"no distribution '{kind}'; there are {', '.join(NEEDED)}")
    if set(values) != set(NEEDED[kind]) or not np.isfinite(list(values.values())).all():
        raise Problem(f"{kind}: expected finite {', '.join(NEEDED[kind])}, not {', '.join(values) or 'nothing'}")
    mean, deviation, low, high = (values.get(name, 0.0) for name in ("mean", "deviation", "low", "high"))
    if "deviation" in values and not deviation > 0:
        raise Problem(f"{kind}: the standard deviation is positive, not {deviation:g}")
    if "low" in values and not low < high:
        raise Problem(f"{kind}: expected low < high, not {low:g} and {high:g}")
    if kind == "normal":
        return stats.norm(mean, deviation)
    if kind == "truncated":
        return stats.truncnorm((low - mean) / deviation, (high - mean) / deviation, mean, deviation)
    if kind == "uniform":
        return stats.uniform(low, high - low)
    if not mean > 0:
        raise Problem(f"lognormal: the mean is positive, not {mean:g}")
    variance = np.log1p((deviation / mean)**2)
    return stats.lognorm(np.sqrt(variance), scale=mean * np.exp(-variance / 2))


def correlate(sample: np.ndarray, ranks: np.ndarray, seed: int = 0) -> np.ndarray:
    """Return a sample, a row each, its columns reordered so that their rank correlations come near to the matrix given.

    Source: R. L. Iman, W. J. Conover, Commun. Stat. Simul. Comput. 11 (1982) 311-334. The normal scores have the
    correlation 2 sin(pi r / 6) that belongs to the rank correlation r.
    Errors: a matrix that is not one of correlations; too few rows.
    """
    ranks = np.asarray(ranks, float)
    count, size = sample.shape
    if ranks.shape != (size, size) or not np.allclose(ranks, ranks.T) or not np.allclose(np.diag(ranks), 1):
        raise Problem(f"the correlations are a symmetric matrix of {size} x {size} with 1 on its diagonal")
    if count <= size:
        raise Problem(f"{count} rows are too few for correlations of {size} inputs; expected more than {size}")
    try:
        wanted = np.linalg.cholesky(2 * np.sin(np.pi * ranks / 6))
    except np.linalg.LinAlgError:
        raise Problem("the matrix of correlations is not positive definite: its values contradict each other") from None
    scores = stats.norm.ppf(np.arange(1, count + 1) / (count + 1))
    generator = np.random.default_rng(seed)
    mixed = np.column_stack([generator.permutation(scores) for _ in range(size)])
    present = np.linalg.cholesky(np.atleast_2d(np.corrcoef(mixed, rowvar=False)))
    order = (mixed @ np.linalg.solve(present.T, wanted.T)).argsort(axis=0).argsort(axis=0)
    return np.asarray(np.take_along_axis(np.sort(sample, axis=0), order, axis=0))


def latin_hypercube(distributions: Sequence[Any], count: int, ranks: np.ndarray | None = None, seed: int = 0
                    ) -> np.ndarray:
    """Return a sample of inputs, (count, inputs): one value in each of `count` parts of equal probability of each.

    ranks: matrix of rank correlations. Without it the inputs are independent: chance correlations of a small sample,
    which change the deviation of results, are removed, unless there are more inputs than values of each.
    """
    size = len(distributions)
    places = stats.qmc.LatinHypercube(size, seed=np.random.default_rng(seed)).random(count)
    if ranks is not None or 1 < size < count:
        places = correlate(places, np.eye(size) if ranks is None else ranks, seed)
    return np.column_stack([one.ppf(places[:, i]) for i, one in enumerate(distributions)])


def read_coils(path: Path) -> list[Row]:
    """Return the rows of a table of coils, commas between its columns; the heading has the names of parameters."""
    rows = read_table(path)
    if len(rows) < 2 or not all(map(is_whole, rows)) or not all(all(row.values()) for row in rows):
        raise Problem(f"{path}: expected two coils or more, a value in each column")
    return rows


def coil_rows(coils: int, runs: int, seed: int, alone: bool) -> list[int]:
    """Return the coil of each run, in random order: each as often as the others, up to one. alone: no other input is
    drawn, so that a coil that is taken twice would be the same run. Error: more runs than coils that are alone."""
    if alone and runs > coils:
        raise Problem(f"{runs} runs of {coils} coils without further inputs; expected {coils} at most")
    order = np.random.default_rng(seed).permutation(runs if not alone else coils)[:runs]
    return [int(i) % coils for i in order] if coils else []
