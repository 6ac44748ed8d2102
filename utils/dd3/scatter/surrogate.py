# SPDX-License-Identifier: GPL-3.0-or-later
"""Polynomial chaos of a result over independent inputs, and the indices of Sobol from its coefficients.

Source: B. Sudret, Reliab. Eng. Syst. Saf. 93 (2008) 964-979.
"""

from collections.abc import Sequence
from itertools import product
from math import factorial
from typing import Any, NamedTuple

import numpy as np
from scipy import special, stats

from dd3.errors import Problem
from dd3.study.response import least_squares

ENOUGH = 0.8  # Q2 below which indices are refused


class Surrogate(NamedTuple):
    """A polynomial: powers (terms, inputs), coefficients of orthonormal terms, and Q2, the part of the variance that it
    predicts at results that are left out in turn (Allen 1974)."""

    powers: np.ndarray
    coefficients: np.ndarray
    q2: float

    def indices(self) -> tuple[np.ndarray, np.ndarray]:
        """Return first-order and total index of each input. Error: Q2 below ENOUGH."""
        if not self.q2 >= ENOUGH:
            raise Problem(f"no indices: the surrogate predicts {self.q2:.2f} of the variance of results left out, "
                          f"expected {ENOUGH:g} or more; make more runs")
        parts = self.coefficients[1:]**2 / np.sum(self.coefficients[1:]**2)
        acts = self.powers[1:] > 0
        alone = acts.sum(axis=1) == 1
        return parts @ (acts & alone[:, None]), parts @ acts


def terms(sample: np.ndarray, distributions: Sequence[Any], powers: np.ndarray) -> np.ndarray:
    """Return the orthonormal terms at a sample, (rows, terms): Legendre polynomials of uniform inputs, Hermite
    polynomials of the normal scores of others."""
    matrix = np.ones((len(sample), len(powers)))
    for i, one in enumerate(distributions):
        place = one.cdf(sample[:, i])
        for k in range(1, int(powers[:, i].max()) + 1):
            if one.dist.name == "uniform":
                values = np.sqrt(2 * k + 1) * special.eval_legendre(k, 2 * place - 1)
            else:
                values = special.eval_hermitenorm(k, stats.norm.ppf(place)) / np.sqrt(factorial(k))
            matrix[:, powers[:, i] == k] *= values[:, None]
    return matrix


def fit(sample: np.ndarray, distributions: Sequence[Any], results: np.ndarray, largest: int = 2) -> Surrogate:
    """Return the polynomial of the degree up to `largest` that predicts results best where they are left out.

    sample: (runs, inputs), independent inputs. Errors: too few runs for degree 1; results that don't vary.
    """
    total = float(np.sum((results - results.mean())**2))
    if not total > 0:
        raise Problem("no surrogate: the result does not vary")
    found = []
    for degree in range(1, largest + 1):
        every = product(range(degree + 1), repeat=sample.shape[1])
        powers = np.array(sorted((row for row in every if sum(row) <= degree), key=sum))
        if len(results) <= len(powers):
            break
        matrix = terms(sample, distributions, powers)
        coefficients, alone = least_squares(matrix, results)
        found.append(Surrogate(powers, coefficients, 1 - float(alone @ alone) / total))
    if not found:
        raise Problem(f"no surrogate: {len(results)} runs for {sample.shape[1] + 1} terms; make more runs")
    return max(found, key=lambda one: one.q2)
