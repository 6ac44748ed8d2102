# SPDX-License-Identifier: GPL-3.0-or-later
"""The law of the strain rate of flow curves: their points from measured curves."""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import lsq_linear

from dd3.errors import Problem
from dd3.identify.hardening import Test
from dd3.identify.measured_table import MOST, hats

LARGEST = 8  # curves of the law
SMOOTH = 1e-3  # weight of the second differences, which determines points without rows beside them


def curves_law(tests: Sequence[Test], young: float) -> str:
    """Return the text of the law with at most eight points of each curve, at the same plastic strains: by least squares
    straight lines that do not fall with the rate. They end at the smallest of the largest strains of the tests.
    `young`: MPa."""
    rates = sorted({float(test.rate or 0) for test in tests})
    if not 2 <= len(rates) <= LARGEST:
        raise Problem(f"--rate curves: error: curves at {len(rates)} rate{'s' * (len(rates) != 1)}\n"
                      f"  expected: 2 to {LARGEST} rates")
    plastic = [np.maximum(test.curve.strain - test.curve.stress / young, 0) for test in tests]
    end = min(float(one.max()) for one in plastic)
    rows = min(len(one) for one in plastic)
    knots = np.array([float(f"{value:.4g}") for value in end * np.linspace(0, 1, min(MOST, rows)) ** 2])
    size = max(float(test.curve.stress.max()) for test in tests)
    sums = np.kron(np.tril(np.ones((len(rates), len(rates)))), np.eye(len(knots)))  # over the rates
    parts, right = [], []
    for test, strain in zip(tests, plastic):
        inside = strain <= end * (1 + 1e-9)
        part = np.zeros((int(inside.sum()), len(rates) * len(knots)))
        first = rates.index(float(test.rate or 0)) * len(knots)
        part[:, first:first + len(knots)] = hats(knots, strain[inside])
        parts.append(part @ sums)
        right.append(test.curve.stress[inside] / size)
    bend = SMOOTH * np.diff(np.eye(len(knots)), 2, axis=0)
    parts.append(np.kron(np.eye(len(rates)), bend) @ sums)
    right.append(np.zeros(len(parts[-1])))
    low = np.r_[np.full(len(knots), 1e-3), np.zeros((len(rates) - 1) * len(knots))]
    found = sums @ lsq_linear(np.vstack(parts), np.concatenate(right), (low, np.inf), tol=1e-14).x * size
    words = [f"r{k}={rate:.6g}" for k, rate in enumerate(rates, 1)]
    words += [f"{knot:.6g}:{value:.7g}" for stress in found.reshape(len(rates), -1)
              for knot, value in zip(knots, stress)]
    return " ".join(["curves", *words])
