# SPDX-License-Identifier: GPL-3.0-or-later
"""Identification of a law of Young's modulus from slopes of unloading over the plastic strain."""

import re
from collections.abc import Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes

from dd3.columns import STRAIN, STRESS, Column, Row, every
from dd3.errors import Problem
from dd3.identify.least_squares import Fit, LoadPath, Points, Search, law_text, report, rounded
from dd3.identify.measured_table import (
    compared,
    knots_of,
    misfit,
    one_place,
    pairs_text,
    read_measured,
    straight_lines,
    values_of,
)
from dd3.identify.measurements import TENSION

PARAMETERS = {"chord": ("Ea", "xi"), "table": ()}
FLOW = 100.0  # flow stress of the points, MPa, constant
ABOVE = 1.2  # largest measured modulus over a given initial one
AT_ZERO = 0.005  # largest plastic strain of a modulus that is taken as the initial one
COLUMNS = (Column("plastic strain", re.compile(r"strain|dehnung|umformgrad|eps|ε|φ", re.IGNORECASE), STRAIN, 0, 1,
                  "the plastic strain before unloading, 0 to 1, not per cent, or with the unit % in the heading"),
           Column("modulus", re.compile(r"modul|young|stiff|slope|steif|\bE\b", re.IGNORECASE), STRESS, 1e3, 1e6,
                  "the slope of unloading in MPa, 1e3 to 1e6, or with the unit GPa in the heading"))


class Moduli(NamedTuple):
    """Plastic strains, and moduli (MPa) of unloading from them (n,)."""

    strain: np.ndarray
    young: np.ndarray

    def initial(self) -> float:
        """Return the mean of the moduli at the smallest plastic strain, MPa."""
        return float(self.young[self.strain <= self.strain.min() + AT_ZERO].mean())


class Found(NamedTuple):
    """What was identified: Young's modulus as delivered (MPa), the text of the law, computed moduli (MPa), the table of
    values and notes."""

    young: float
    law: str
    values: np.ndarray
    table: list[str]
    notes: list[str]


def names_sought(law: str, young: float | None, fixed: Mapping[str, float]) -> list[str]:
    """Return the names of the parameters that are identified."""
    return ["young"] * (young is None) + [name for name in PARAMETERS[law] if name not in fixed]


def read_moduli(path: str, law: str, young: float | None, fixed: Mapping[str, float]) -> Moduli:
    """Return the moduli of a table. `young`: the initial modulus, MPa, if it is given; `fixed`: parameters that
    are."""
    names = names_sought(law, young, fixed)
    rows = read_measured(path, COLUMNS, max(len(names), 2), names)
    found = Moduli(*values_of(rows))
    if law == "table" and young is None and found.strain.min() > AT_ZERO:
        raise Problem(f"{path}: error: no modulus at the plastic strain 0, which the table begins with\n"
                      f"  expected: a row at 0 (to {AT_ZERO:g}), or --young")
    every([partial(check_initial, row, young) for row in rows])
    return found


def check_initial(row: Row, young: float | None) -> None:
    """Check that a modulus is not far above the initial one."""
    if young is not None and row.values[1] > ABOVE * young:
        raise row.line.problem(row.words[1], f"modulus = {row.words[1][0]} is above --young {young:g}",
                               "moduli that fall with the plastic strain from --young, in MPa")


def moduli_at(points: Points, cases: list[tuple[float, str]], strain: np.ndarray) -> list[Any]:
    """Return the moduli, MPa, at plastic strains that the program has for each Young's modulus and text of a law: the
    slopes of unloading; None for what it refuses."""
    def path(young: float, plastic: float) -> LoadPath:
        elastic = FLOW / young
        ends = (plastic + elastic, plastic + elastic / 2) if plastic > 0 else (elastic / 2, elastic / 4)
        return LoadPath(TENSION, 0, [([end, 0, 0, 0, 0, 0], 1) for end in ends])

    found = points.rows_of([([f"young = {young:.10g}", "yield = von_mises", f"hardening = perfect Y0={FLOW:g}",
                              f"modulus = {law}"], [path(young, one) for one in strain]) for young, law in cases])

    def slopes(young: float, rows: Any) -> np.ndarray:
        way = FLOW / young / np.where(strain > 0, 2, 4)
        return np.array([part[1]["s11"] - part[2]["s11"] for part in rows]) / way

    return [None if rows is None else slopes(young, rows) for (young, _), rows in zip(cases, found)]


def chord(tests: Moduli, young: float | None, fixed: Mapping[str, float], points: Points, search: Search
          ) -> tuple[float, str, list[str]]:
    """Identify the chord modulus; return Young's modulus, MPa, the text of the law, and notes."""
    scale = young or tests.initial()
    fraction = min(0.98, float(tests.young.min()) / scale)
    bounds = {"young": (1.0, 0.7, 1.3), "Ea": (fraction, 0.05, 1.0),
              "xi": (np.log(1 / max(float(np.median(tests.strain)), 1e-3)), np.log(0.1), np.log(3e3))}
    names = names_sought("chord", young, fixed)

    def case_of(values: dict[Any, float], digits: int = 10) -> tuple[float, str]:
        initial = scale * values.get("young", 1.0)
        found = {"Ea": initial * values.get("Ea", 0.0), "xi": np.exp(values.get("xi", 0.0)), **fixed}
        return float(f"{initial:.6g}"), law_text("chord", found, digits)

    def evaluate(sets: list[dict[Any, float]]) -> list[Any]:
        return [None if one is None else one / scale
                for one in moduli_at(points, [case_of(values) for values in sets], tests.strain)]

    if not names:
        return *case_of({}), []
    weights = np.full(len(tests.young), len(tests.young) ** -0.5)
    fit = Fit(evaluate, {name: bounds[name] for name in names}, tests.young / scale, weights, 1e-6)
    point, costs = fit.best(search.starts, 0.1, search.seed)
    report("chord", costs)
    values = dict(zip(fit.names, point))
    case, _ = rounded(lambda digits: case_of(values, digits),
                      lambda cases: moduli_at(points, cases, tests.strain))
    notes = one_place("plastic strain", tests.strain, names)
    notes += fit.left_open(point, "left as at the start", "other values of the rest may do as well")
    return *case, notes + fit.at_ends(point)


def table(tests: Moduli, young: float | None) -> tuple[float, str, list[str]]:
    """Return Young's modulus, MPa, the text of a table through the moduli, which do not rise, and notes."""
    knots = np.unique(np.append(0.0, knots_of(tests.strain)[(1 if tests.strain.min() <= AT_ZERO else 0):]))
    places = np.where(tests.strain <= AT_ZERO, 0.0, tests.strain)
    values = straight_lines(knots, places, tests.young, -1, young)
    initial = float(f"{values[0]:.6g}")
    return initial, pairs_text("table", knots, np.minimum(values, initial), 6), []


def modulus(law: str, tests: Moduli, young: float | None, fixed: Mapping[str, float], points: Points,
            search: Search) -> Found:
    """Identify a law of the modulus, and Young's modulus as delivered unless it is given (`young`, MPa). `fixed`:
    parameters of the law that are given."""
    initial, text, notes = chord(tests, young, fixed, points, search) if law == "chord" else table(tests, young)
    values = moduli_at(points, [(initial, text)], tests.strain)[0]
    if values is None:
        raise Problem(f"modulus: error: the program refuses {text}: {points.refusal}")
    lines = [compared(f"modulus at {place:.4f}, MPa", one, two, 0)
             for place, one, two in zip(tests.strain, tests.young, values)]
    return Found(initial, text, values, [*lines, misfit(tests.young, values, "moduli", " MPa", 1)], notes)


def draw(axes: Axes, found: Found, tests: Moduli, points: Points) -> None:
    """Draw measured moduli and the law, GPa."""
    places = np.linspace(0, tests.strain.max(), 60)
    axes.plot(places, moduli_at(points, [(found.young, found.law)], places)[0] / 1e3, label="identified")
    axes.plot(tests.strain, tests.young / 1e3, "s", color="k", markerfacecolor="none", label="measured")
    axes.set(xlabel="plastic strain", ylabel="modulus of unloading (GPa)")
