# SPDX-License-Identifier: GPL-3.0-or-later
"""Identification of the law of fracture of Hosford and Coulomb from strains to fracture."""

import re
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes

from dd3.account import Account
from dd3.columns import STRAIN, Column, read_columns
from dd3.errors import LOG, Problem
from dd3.identify.least_squares import Fit, LoadPath, Points, law_text, report, rounded

LAW = "hosford_coulomb"
STRESSES = "s11 s22 s33 s12 s23 s13"
# Criterion and hardening of the points, which have a plastic strain of 0.1 at the equivalent stress EQUIVALENT, MPa.
POINT, EQUIVALENT = ("yield = von_mises", "hardening = linear Y0=100 H=1000"), 200.0
LEAST = 3  # tests, for a, b and c
PULL = 1e-6  # weight of the distance from the start
MISSED = 0.1  # difference over the measured value that is noted
COLUMNS = (Column("triaxiality", re.compile(r"triax|dreiachs|mehrachs|\beta\b|η", re.IGNORECASE), {}, -2, 3,
                  "the mean stress over von Mises's: 1/3 in tension, 0.577 in plane strain"),
           Column("Lode angle", re.compile(r"lode|theta|θ", re.IGNORECASE), {}, -1, 1,
                  "the normalised Lode angle, -1 to 1: 1 in tension, 0 in plane strain and shear, -1 equibiaxial"),
           Column("strain to fracture", re.compile(r"strain|dehnung|eps|ε", re.IGNORECASE), STRAIN, 1e-3, 10,
                  "a plastic strain, not per cent, or with the unit % in the heading"))


class Tests(NamedTuple):
    """Triaxiality, normalised Lode angle and plastic strain to fracture of tests (n,)."""

    triaxiality: np.ndarray
    lode: np.ndarray
    strain: np.ndarray


def read_tests(path: str) -> Tests:
    """Return the tests of a table; say what of it is not used."""
    account = Account()
    rows = read_columns(path, COLUMNS, account)
    if len(rows) < LEAST:
        raise Problem(f"{path}: error: {len(rows)} test{'s' * (len(rows) != 1)}\n  expected: triaxiality, Lode angle "
                      f"and strain to fracture of {LEAST} tests or more")
    for item in account.left_out():
        LOG.info(f"left out: {item}")
    return Tests(*np.array([row.values for row in rows]).T)


def stress_of(triaxiality: float, lode: float) -> np.ndarray:
    """Return the principal stresses over von Mises's of a stress state, the largest first."""
    turns = np.pi / 6 * np.array([1 - lode, 3 + lode, 5 - lode])
    return np.asarray(triaxiality + 2 / 3 * np.cos(turns))


def strains_to_fracture(points: Points, laws: Sequence[str], triaxiality: np.ndarray, lode: np.ndarray) -> list[Any]:
    """Return the strains to fracture at stress states for each law, its text in the input, as the program computes
    them: plastic strain over damage; None for a law that it refuses."""
    paths = [LoadPath(STRESSES, 0.0, [([*(EQUIVALENT * stress_of(*state)), 0, 0, 0], 1)])
             for state in zip(triaxiality, lode)]
    found = points.rows([(*POINT, f"fracture = {law}") for law in laws], paths)
    with np.errstate(divide="ignore"):  # no damage: no fracture
        return [None if rows is None else np.divide(*np.array([[part[-1]["eqps"], part[-1]["fracture_damage"]]
                                                               for part in rows]).T) for rows in found]


def fracture(tests: Tests, exponent: float, points: Points, starts: int, seed: int) -> tuple[str, list[str], list[str]]:
    """Identify a, b and c with an exponent n from several starts; return the text of the law, the table of values and
    notes. The squares of the differences over the measured strains are minimised."""
    middle = float(np.median(tests.strain))
    sought = {"a": (1.5, 1.0, 5.0), "b": (middle, 0.02 * middle, 20 * middle), "c": (0.05, 0.0, 1.0)}

    def compute(texts: list[str]) -> list[Any]:
        return strains_to_fracture(points, texts, tests.triaxiality, tests.lode)

    def text_of(values: dict[str, float], digits: int = 10) -> str:
        return law_text(LAW, {**values, "n": exponent}, digits)

    def evaluate(sets: list[dict[Any, float]]) -> list[Any]:
        return compute([text_of(one) for one in sets])

    fit = Fit(evaluate, sought, tests.strain, 1 / tests.strain, PULL)
    point, costs = fit.best(starts, 0.3, seed)
    text, values = rounded(lambda digits: text_of(dict(zip(sought, point)), digits), compute)
    report(LAW, costs)
    table = [f"{f'triaxiality {place:.3f}, Lode {lode:.3f}':<32}{strain:>10.4f}{value:>12.4f}{value - strain:>12.4f}"
             for place, lode, strain, value in zip(*tests, values)]
    notes = fit.left_open(point, "left as at the start", "other values of the rest may do as well") + fit.at_ends(point)
    notes += [f"the strain to fracture at the triaxiality {place:.3f} is {value:.3g} in place of {strain:.3g}"
              for place, strain, value in zip(tests.triaxiality, tests.strain, values)
              if abs(value - strain) > MISSED * strain]
    return text, table, notes


def draw(axes: Axes, text: str, tests: Tests, points: Points) -> None:
    """Draw the strains to fracture over the triaxiality: of a law in plane stress, and of tests with those that the
    law gives at their stress states."""
    angles = np.radians(np.arange(-45, 46, 1))
    first, second = np.cos(angles), np.sin(angles)
    equivalent = np.sqrt(first**2 - first * second + second**2)
    triaxiality = (first + second) / 3 / equivalent
    inside = np.clip(-13.5 * triaxiality * (triaxiality**2 - 1 / 3), -1, 1)
    text = text.partition(" exponent=")[0]  # linear damage, for its strain to fracture
    line, values = (strains_to_fracture(points, [text], *states)[0]
                    for states in ((triaxiality, 1 - 2 / np.pi * np.arccos(inside)), tests[:2]))
    axes.plot(triaxiality, line, label="identified, plane stress")
    axes.plot(tests.triaxiality, values, "x", color="C0", label="identified, of the tests")
    axes.plot(tests.triaxiality, tests.strain, "s", color="k", markerfacecolor="none", label="measured")
    top = 1.6 * max(tests.strain.max(), values.max())
    axes.set(xlabel="triaxiality", ylabel="plastic strain to fracture", ylim=(0, min(top, 1.1 * line.max())))
