# SPDX-License-Identifier: GPL-3.0-or-later
"""Response surfaces of studies: a quadratic polynomial of the parameters by least squares (Box and Wilson 1951)."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np

from dd3.errors import Problem
from dd3.plot.figures import new_figure, save

LEVELS, POINTS = 12, 41  # of the picture's contours; on a side of it


@dataclass
class Parameter:
    """A parameter with several values: numbers, or words, of which the first is the reference."""

    name: str
    values: list[str]
    numbers: np.ndarray | None

    def columns(self, value: str | float) -> dict[str, float]:
        """Return the terms of a value: a number from -1 to 1 over the range, or 1 for a word other than the first."""
        if self.numbers is None:
            return {f"{self.name}={word}": float(word == value) for word in self.values[1:]}
        low, high = float(self.numbers.min()), float(self.numbers.max())
        return {self.name: (2 * float(value) - low - high) / (high - low)}


@dataclass
class Surface:
    """Terms and coefficients of a polynomial; which part of the variance it explains, and which part of it where each
    result is left out in turn (Allen 1974)."""

    parameters: list[Parameter]
    terms: list[tuple[str, ...]]
    coefficients: np.ndarray
    explained: float
    predicted: float

    def at(self, values: dict[str, str | float]) -> float:
        """Return the value of the polynomial."""
        return float(row(self.parameters, self.terms, values) @ self.coefficients)


def row(parameters: list[Parameter], terms: list[tuple[str, ...]], values: dict[str, str | float]) -> np.ndarray:
    """Return the values of the terms at values of the parameters."""
    columns: dict[str, float] = {}
    for one in parameters:
        columns |= one.columns(values[one.name])
    return np.array([np.prod([columns[name] for name in term]) for term in terms])


def terms_of(parameters: list[Parameter]) -> list[tuple[str, ...]]:
    """Return the terms: constant, linear, products of two parameters, squares of numbers with three values or more."""
    linear = {one.name: list(one.columns(one.values[0])) for one in parameters}
    found: list[tuple[str, ...]] = [()]
    found += [(name,) for names in linear.values() for name in names]
    found += [(a, b) for one, other in combinations(parameters, 2)
              for a in linear[one.name] for b in linear[other.name]]
    return found + [(one.name, one.name) for one in parameters if one.numbers is not None and len(one.values) > 2]


def least_squares(matrix: np.ndarray, results: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the coefficients of terms, and the errors at results that are left out in turn (Allen 1974)."""
    coefficients = np.linalg.lstsq(matrix, results, rcond=None)[0]
    leverage = np.einsum("ij,ji->i", matrix, np.linalg.pinv(matrix))
    return coefficients, (results - matrix @ coefficients) / np.maximum(1 - leverage, 1e-12)


def fit(parameters: Sequence[Parameter], cases: list[dict[str, str]], results: Sequence[float]) -> Surface:
    """Return the polynomial through results at cases."""
    varied = [one for one in parameters if len(one.values) > 1]
    terms = terms_of(varied)
    matrix = np.array([row(varied, terms, dict(case)) for case in cases])
    values = np.array(results)
    if len(values) <= len(terms):
        raise Problem(f"--surface has {len(terms)} terms and takes more results than that; there are {len(values)}")
    coefficients, alone = least_squares(matrix, values)
    left = values - matrix @ coefficients
    total = float(((values - values.mean())**2).sum())
    if total == 0.0:
        return Surface(varied, terms, coefficients, 1.0, 1.0)
    return Surface(varied, terms, coefficients, 1 - float(left @ left) / total, 1 - float(alone @ alone) / total)


def describe(surface: Surface) -> list[str]:
    """Return the lines that say how good a polynomial is, and its terms."""
    lines = [f"quadratic surface, explains {surface.explained:.4f} of the variance, {surface.predicted:.4f} of results "
             "left out"]
    for one in surface.parameters:
        if one.numbers is not None:
            lines.append(f"  {one.name} from -1 at {one.numbers.min():g} to 1 at {one.numbers.max():g}")
    return lines + [f"  {value:+14.6g}  {' * '.join(term) or '1'}"
                    for term, value in zip(surface.terms, surface.coefficients)]


def draw(path: Path, surface: Surface, cases: list[dict[str, str]], label: str) -> bool:
    """Draw a polynomial over its first two parameters with numbers, the others at their first values, and the places of
    the cases; return False if there are no two."""
    plane = [one for one in surface.parameters if one.numbers is not None][:2]
    if len(plane) < 2:
        return False
    others = {one.name: one.values[0] for one in surface.parameters if one not in plane}
    x, y = (np.linspace(one.numbers.min(), one.numbers.max(), POINTS) for one in plane if one.numbers is not None)
    values = np.array([[surface.at({**others, plane[0].name: a, plane[1].name: b}) for a in x] for b in y])
    figure, axes = new_figure((6.5, 4.8))
    figure.colorbar(axes.contourf(x, y, values, LEVELS), label=label)
    axes.plot(*([float(case[one.name]) for case in cases] for one in plane), "k.", markersize=5)
    axes.set(xlabel=plane[0].name, ylabel=plane[1].name,
             title=", ".join(f"{name} = {value}" for name, value in others.items()))
    save(figure, path, 130)
    return True
