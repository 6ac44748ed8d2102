# SPDX-License-Identifier: GPL-3.0-or-later
"""Identification of laws of friction from measured coefficients by pressure, speed and plastic strain."""

import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure
from scipy.optimize import least_squares

from dd3.columns import STRAIN, STRESS, Column, Row
from dd3.errors import Problem
from dd3.identify.least_squares import END, law_text
from dd3.identify.measured_table import RATIO_UNITS, knots_of, misfit, one_place, pairs_text, read_measured, values_of
from dd3.plot.figures import new_figure

SPEED = {"": 1.0, "mm/s": 1.0, "m/s": 1e3, "cm/s": 10.0, "mm/min": 1 / 60, "m/min": 1e3 / 60}
PRESSURE, VELOCITY, STRAINED = (
    Column("pressure", re.compile(r"press|druck|\bp\b", re.IGNORECASE), STRESS, 1e-3, 1e4,
           "a contact pressure in MPa, above 0"),
    Column("speed", re.compile(r"speed|veloc|geschw|\bv\b", re.IGNORECASE), SPEED, 0, 1e5,
           "a speed of sliding in mm/s"),
    Column("plastic strain", re.compile(r"strain|dehnung|eps|ε|φ", re.IGNORECASE), STRAIN, 0, 5,
           "a plastic strain of the sheet, not per cent, or with the unit % in the heading"))
COEFFICIENT = Column("coefficient of friction", re.compile(r"coeff|frict|reib|\bmu\b|µ|μ", re.IGNORECASE), RATIO_UNITS,
                     1e-4, 2, "a coefficient, 0.0001 to 2, not per cent")
# Law: what it depends on, unit, parameters.
LAWS = {"power": (PRESSURE, "MPa", ("p0", "n", "p_min", "p_max")), "stribeck": (VELOCITY, "mm/s", ("v0", "r", "n")),
        "table": (PRESSURE, "MPa", ()), "speed_table": (VELOCITY, "mm/s", ()), "strain_table": (STRAINED, "", ())}
FROM_TESTS = ("p0", "p_min", "p_max")  # parameters of power that are not identified
NOT_SEEN = 1e-3  # change of the coefficient, over it, by a change of a parameter by its size, that is not seen


class Tests(NamedTuple):
    """Measured coefficients of friction (n,), and by law what it depends on (n,)."""

    place: dict[str, np.ndarray]
    coefficient: np.ndarray


class Sought(NamedTuple):
    """A parameter to identify: law and name, start and bounds. Pressures and speeds, exponents and factors are sought
    by their logarithms."""

    law: str
    name: str
    start: float
    low: float
    high: float


def read_tests(path: str, laws: Sequence[str], fixed: Mapping[str, Mapping[str, float]]) -> Tests:
    """Return the coefficients of a table with the columns that the laws need. `fixed`: given parameters by law."""
    columns = list({LAWS[law][0].name: LAWS[law][0] for law in laws}.values())
    names = ["friction"] + [f"{law}.{name}" for law in laws for name in names_sought(law, fixed)]
    rows = read_measured(path, [*columns, COEFFICIENT], max(len(names), 2), names)
    *places, coefficient = values_of(rows)
    by_name = {column.name: place for column, place in zip(columns, places)}
    tests = Tests({law: by_name[LAWS[law][0].name] for law in laws}, coefficient)
    for law in laws:
        check_places(path, law, tests.place[law], rows, columns)
    if len(knots_total(tests)) > len(rows):
        raise Problem(f"{path}: error: {len(rows)} rows for {len(knots_total(tests))} points of tables\n"
                      "  expected: as many rows as points or more")
    return tests


def check_places(path: str, law: str, places: np.ndarray, rows: Sequence[Row], columns: Sequence[Column]) -> None:
    """Check that a table has two places or more."""
    if law.endswith("table") and len(np.unique(places)) < 2:
        what = LAWS[law][0].name
        line, words, _ = rows[0]
        place = [column.name for column in columns].index(what)
        raise line.problem(words[place], f"{path}: the {what} is the same in all rows",
                           f"two or more {what}s for {law}")


def knots_total(tests: Tests) -> list[tuple[str, float]]:
    """Return the points of all tables; their first one has the factor 1."""
    first = [("friction", 0.0)]
    return first + [(law, float(knot)) for law, places in tests.place.items() if law.endswith("table")
                    for knot in knots_of(places)[1:]]


def names_sought(law: str, fixed: Mapping[str, Mapping[str, float]]) -> list[str]:
    """Return the names of the parameters of a law that are identified."""
    return [name for name in LAWS[law][2] if name not in fixed.get(law, {}) and name not in FROM_TESTS]


def factor_at(law: str, values: Mapping[str, float], places: np.ndarray, knots: np.ndarray | None) -> np.ndarray:
    """Return the factor of a law (docs/manual.md, `*TOOL`) at pressures, speeds or strains; `knots`: places of a table,
    whose factors are the values. The program does not offer these laws at points; tests/utils compares both."""
    if knots is not None:
        return np.interp(places, knots, [values[f"{knot:.6g}"] for knot in knots])
    if law == "power":
        inside = np.clip(places, values["p_min"], values.get("p_max", np.inf))
        return np.asarray((inside / values["p0"]) ** (values["n"] - 1))
    return np.asarray(values["r"] + (1 - values["r"]) * np.exp(-(places / values["v0"]) ** values["n"]))


def given_of(law: str, tests: Tests, fixed: Mapping[str, Mapping[str, float]]) -> dict[str, float]:
    """Return the parameters of a law that are not identified: given ones, and of the power law the range of the
    pressures."""
    own = dict(fixed.get(law, {}))
    if law == "power":
        low, high = tests.place[law].min(), tests.place[law].max()
        own = {"p0": float(f"{np.sqrt(low * high):.2g}"), "p_min": float(f"{low:.6g}"), **own}
    return own


def starts_of(law: str, tests: Tests, fixed: Mapping[str, Mapping[str, float]]) -> list[Sought]:
    """Return the parameters of a law to identify."""
    places = tests.place[law]
    if law.endswith("table"):
        return [Sought(law, f"{knot:.6g}", 0.0, -5.0, 5.0) for knot in knots_of(places)[1:]]
    speed = max(float(places.mean()), 1e-6)
    rest = min(float(tests.coefficient.min() / tests.coefficient.max()), 0.95)
    first = {"n": (0.9, 0.05, 2.0) if law == "power" else (1.2, 1.0, 8.0), "v0": (speed / 2, speed / 1e3, speed * 1e3),
             "r": (rest, 0.01, 1.0)}
    return [Sought(law, name, *(float(np.log(one)) for one in first[name])) for name in names_sought(law, fixed)]


class Model:
    """Coefficient of friction with factors of laws in an identification."""

    def __init__(self, laws: Sequence[str], tests: Tests, fixed: Mapping[str, Mapping[str, float]]) -> None:
        self.laws, self.tests = laws, tests
        self.given = {law: given_of(law, tests, fixed) for law in laws}
        self.knots = {law: knots_of(tests.place[law]) if law.endswith("table") else None for law in laws}
        mean = float(np.log(tests.coefficient.mean()))
        self.sought = [Sought("", "friction", mean, mean - 5, mean + 5)]
        self.sought += [one for law in laws for one in starts_of(law, tests, fixed)]

    def values(self, point: np.ndarray) -> dict[str, dict[str, float]]:
        """Return the parameters by law; of the law '' the coefficient."""
        found: dict[str, dict[str, float]] = {"": {}, **{law: dict(self.given[law]) for law in self.laws}}
        for law, knots in self.knots.items():
            if knots is not None:
                found[law][f"{knots[0]:.6g}"] = 1.0
        for one, value in zip(self.sought, point):
            found[one.law][one.name] = float(np.exp(value))
        return found

    def coefficients(self, point: np.ndarray) -> np.ndarray:
        """Return the coefficients of the tests."""
        values = self.values(point)
        factors = [factor_at(law, values[law], self.tests.place[law], self.knots[law]) for law in self.laws]
        return np.asarray(values[""]["friction"] * np.prod(factors, axis=0))

    def lines(self, point: np.ndarray) -> list[str]:
        """Return the lines of *TOOL."""
        values = self.values(point)
        lines = [f"friction = {values['']['friction']:.6g}"]
        for law, knots in self.knots.items():
            own = values[law]
            text = law_text(law, {name: own[name] for name in LAWS[law][2] if name in own}, 6) if knots is None else \
                pairs_text(law, knots, np.array([own[f"{knot:.6g}"] for knot in knots]), 6)
            lines.append(f"friction_law = {text}")
        return lines


def notes_on(model: Model, point: np.ndarray, slope: np.ndarray) -> list[str]:
    """Return notes on parameters that the tests do not determine, or at an end of their range, and on friction stresses
    that fall. `slope`: derivatives of the relative coefficients in the logarithms of the parameters."""
    notes = []
    for law in model.laws:
        what, _, _ = LAWS[law]
        names = [one.name for one in model.sought if one.law == law]
        if names and model.knots[law] is None:
            # The coefficient takes one place more.
            notes += one_place(what.name, model.tests.place[law], [*names, "friction"])
    idle = [one.name for one, part in zip(model.sought, slope.T) if np.abs(part).max() < NOT_SEEN * 1e-2]
    if idle:
        notes.append(f"the data do not determine {', '.join(idle)}: left as at the start")
    count = int(np.sum(np.linalg.svd(slope, compute_uv=False) > NOT_SEEN))
    if count < len(point) - len(idle):
        notes.append(f"the data determine {count} of {len(point) - len(idle)} parameters, or combinations of them; "
                     "other values of the rest may do as well")
    notes += [f"{one.law}.{one.name} is at the end of its range: another law may fit the data better"
              for one, value in zip(model.sought, point)
              if min(value - one.low, one.high - value) < END * (one.high - one.low)]
    return notes


def check_stress(model: Model, values: Mapping[str, Mapping[str, float]], path: str) -> None:
    """Check that the friction stress of a table over the pressure rises, which the program requires."""
    knots = model.knots.get("table")
    if knots is None:
        return
    factors = np.array([values["table"][f"{knot:.6g}"] for knot in knots])
    falls = np.flatnonzero(factors[1:] * np.diff(knots) + knots[1:] * np.diff(factors) < 0)
    if len(falls):
        raise Problem(f"{path}: error: the friction stress falls from {knots[falls[0]]:g} to {knots[falls[0] + 1]:g} "
                      "MPa\n  expected: coefficients that fall more slowly than 1/p; fewer pressures, or power")


def friction(laws: Sequence[str], tests: Tests, fixed: Mapping[str, Mapping[str, float]], path: str, starts: int,
             seed: int) -> tuple[list[str], list[str], list[str], np.ndarray]:
    """Identify laws of friction, whose factors are multiplied, by least squares of the differences over the measured
    coefficients; return the lines of *TOOL, the table of values, notes, and the coefficients of the laws."""
    model = Model(laws, tests, fixed)
    first, low, high = (np.array([one[i] for one in model.sought]) for i in (2, 3, 4))
    random, best = np.random.default_rng(seed), None

    def off(point: np.ndarray) -> np.ndarray:
        return model.coefficients(point) / tests.coefficient - 1

    for number in range(starts):
        start = first if number == 0 else first + 0.5 * random.standard_normal(len(first))
        found = least_squares(off, np.clip(start, low + 1e-6, high - 1e-6), bounds=(low, high), xtol=1e-14,
                              ftol=1e-14, gtol=1e-14, max_nfev=500)
        best = found if best is None or found.cost < best.cost else best
    assert best is not None
    check_stress(model, model.values(best.x), path)
    values = model.coefficients(best.x)
    table = []
    for i, (one, two) in enumerate(zip(tests.coefficient, values)):
        where = ", ".join(dict.fromkeys(f"{LAWS[law][0].name} {tests.place[law][i]:g}" for law in laws))
        table.append(f"{where[:31]:<32}{one:>10.4f}{two:>12.4f}{two - one:>12.4f}")
    table.append(misfit(tests.coefficient, values, "coefficients"))
    return model.lines(best.x), table, notes_on(model, best.x, best.jac), values


def picture(laws: Sequence[str], tests: Tests, values: np.ndarray) -> Figure:
    """Return measured and identified coefficients, over each of what the laws depend on."""
    by_what: dict[str, Any] = {LAWS[law][0].name: (tests.place[law], LAWS[law][1]) for law in laws}
    figure, panels = new_figure((5 * len(by_what), 4), 1, len(by_what), squeeze=False)
    for axes, (what, (places, unit)) in zip(panels[0], by_what.items()):
        order = np.argsort(places)
        axes.plot(places[order], values[order], "x-" if len(by_what) == 1 else "x", color="C0", label="identified")
        axes.plot(places, tests.coefficient, "s", color="k", markerfacecolor="none", label="measured")
        axes.set(xlabel=what + (f" ({unit})" if unit else ""), ylabel="coefficient of friction")
        axes.grid(True, color="0.9")
        axes.legend(frameon=False)
    return figure
