# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of the strain rate and of the temperature: their parameters, and their identification from ratios of flow
stresses. Those from curves are identified with the hardening law, see hardening.py."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes

from dd3.columns import Column, every
from dd3.errors import Problem
from dd3.identify.least_squares import Fit, LoadPath, Points, Search, law_text, report, rounded
from dd3.identify.measured_table import (
    RATIO_UNITS,
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

RATE, TEMPERATURE = "rate", "temperature"
PARAMETERS = {RATE: {"cowper_symonds": ("C", "p"), "johnson_cook": ("C", "reference"), "power": ("m", "reference"),
                     "table": (), "curves": ()},
              TEMPERATURE: {"johnson_cook": ("Tr", "Tm", "m"), "table": ()}}
FLOW = 100.0  # flow stress of the points without the factor, MPa, constant
SMALL = 1e-4  # smallest start of a factor less 1
RATES = {"": 1.0, "-": 1.0, "1/s": 1.0, "/s": 1.0, "s-1": 1.0, "s^-1": 1.0, "s⁻¹": 1.0, "1/min": 1 / 60, "%/s": 0.01}
DEGREES = {"": 1.0, "c": 1.0, "°c": 1.0, "degc": 1.0, "k": 1.0}
LIMITS = {RATE: (1e-9, 1e8, "a strain rate, 1/s, above 0"), TEMPERATURE: (-273.15, 3e3, "a temperature")}
RATIO = Column("ratio", re.compile(r"ratio|factor|faktor|verh|stress|spannung", re.IGNORECASE), RATIO_UNITS, 0.01, 10,
               "the flow stress over that of the reference test, 0.01 to 10, not per cent and not MPa")
COLUMNS = {RATE: (Column("rate", re.compile(r"rate|geschw|1/s", re.IGNORECASE), RATES, *LIMITS[RATE]), RATIO),
           TEMPERATURE: (Column("temperature", re.compile(r"temp|°C|\bT\b", re.IGNORECASE), DEGREES,
                                *LIMITS[TEMPERATURE]), RATIO)}
Key = tuple[str, str]  # law of what, parameter


class Ratios(NamedTuple):
    """Rates (1/s) or temperatures, and flow stresses there over those of the reference test (n,)."""

    place: np.ndarray
    ratio: np.ndarray


@dataclass
class Factor:
    """A law of the rate or of the temperature in an identification: what of, its name, the parameters to identify with
    start and bounds, and the text with values of them."""

    of: str
    law: str
    sought: dict[Key, tuple[float, float, float]]
    text_of: Callable[[Mapping[Any, float], int], str]

    def line(self, values: Mapping[Any, float], digits: int = 10) -> str:
        """Return the line of *MATERIAL."""
        return f"{self.of} = {self.text_of(values, digits)}"


def names_sought(of: str, law: str, fixed: Mapping[str, float]) -> list[str]:
    """Return the names of the parameters that are identified; the reference is that of the tests unless given."""
    own = ("reference",) if law == "johnson_cook" and of == RATE else ("Tr",)
    return [name for name in PARAMETERS[of][law] if name not in fixed and name not in own]


def read_ratios(path: str, of: str, law: str, fixed: Mapping[str, float]) -> Ratios:
    """Return the ratios of a table; `fixed`: parameters of the law that are given."""
    names = names_sought(of, law, fixed)
    rows = read_measured(path, COLUMNS[of], max(len(names), 2), names)
    found = Ratios(*values_of(rows))
    if law == "table" and len(np.unique(found.place)) < 2:
        raise Problem(f"{path}: error: one {of} only\n  expected: two {of}s or more for a table")
    if of == RATE and law != "table" and found.ratio[np.argmax(found.place)] < found.ratio[np.argmin(found.place)]:
        row = rows[int(np.argmax(found.place))]
        raise row.line.problem(row.words[1], "the stress falls with the rate", "ratios that rise with the rate")
    return found


def rate_start(law: str, tests: Ratios, low: float) -> dict[str, tuple[float, float, float]]:
    """Return start and bounds of the logarithms of the parameters of a law of the rate. `low`: lowest rate, 1/s."""
    high = float(tests.place.max())
    ways = np.log(tests.place / low)
    rise = max(float(tests.ratio[np.argmax(tests.place)]) - 1, SMALL)
    slope = rise / max(float(ways.max()), 1.0)
    starts = {"cowper_symonds": {"C": (high / min(rise, 3) ** 5, 1e-12, 1e18), "p": (5.0, 1.0, 100.0)},
              "johnson_cook": {"C": (slope, 1e-7, 10.0)},
              "power": {"m": (min(slope, 0.5), 1e-7, 1.0), "reference": (3 * low, 1e-6 * low, 10 * high)}}
    return {name: (float(np.log(min(max(first, 2 * least), most / 2))), np.log(least), np.log(most))
            for name, (first, least, most) in starts[law].items()}


def rate_factor(law: str, tests: Ratios, fixed: Mapping[str, float]) -> Factor:
    """Return a law of the rate to identify from ratios to the lowest rate, or nearly such ones."""
    knots, low = np.unique(tests.place), float(tests.place.min())
    if law == "table":
        means = np.array([tests.ratio[tests.place == knot].mean() for knot in knots])
        rises = np.maximum(np.diff(np.maximum.accumulate(means / means[0])), SMALL)
        keys = [(RATE, f"factor at {knot:g}") for knot in knots[1:]]
        return Factor(RATE, law, {key: (np.log(rise), np.log(1e-7), np.log(10)) for key, rise in zip(keys, rises)},
                      lambda values, digits: pairs_text("table", knots, np.cumsum([1.0, *(
                          np.exp(values[key]) for key in keys)]), digits))
    own = {"reference": low, **fixed} if law == "johnson_cook" else dict(fixed)
    sought = {(RATE, name): bounds for name, bounds in rate_start(law, tests, low).items() if name not in own}

    def text_of(values: Mapping[Any, float], digits: int) -> str:
        found = {name: float(np.exp(values[RATE, name])) for _, name in sought}
        return law_text(law, {name: {**own, **found}[name] for name in PARAMETERS[RATE][law]}, digits)

    return Factor(RATE, law, sought, text_of)


def temperature_factor(law: str, tests: Ratios, fixed: Mapping[str, float]) -> Factor:
    """Return a law of the temperature to identify from ratios to the lowest temperature. Tm is sought as its distance
    from the reference temperature."""
    knots = np.unique(tests.place)
    if law == "table":
        keys = [(TEMPERATURE, f"factor at {knot:g}") for knot in knots[1:]]
        means = np.array([tests.ratio[tests.place == knot].mean() for knot in knots])
        return Factor(TEMPERATURE, law, {key: (np.log(one), np.log(1e-3), np.log(10))
                                         for key, one in zip(keys, means[1:] / means[0])},
                      lambda values, digits: pairs_text("table", knots, np.array([1.0, *(
                          np.exp(values[key]) for key in keys)]), digits))
    base = fixed.get("Tr", float(knots[0]))
    way = max(float(knots[-1]) - base, 1.0)
    loss = min(max(1 - float(tests.ratio[np.argmax(tests.place)]), 0.01), 0.95)
    first = {"Tm": (max(way / loss, 1.05 * way), 1.0001 * way, 100 * way), "m": (1.0, 0.05, 10.0)}
    sought = {(TEMPERATURE, name): (float(np.log(one)), float(np.log(low)), float(np.log(high)))
              for name, (one, low, high) in first.items() if name not in fixed}

    def text_of(values: Mapping[Any, float], digits: int) -> str:
        found = {name: float(np.exp(values[TEMPERATURE, name])) for _, name in sought}
        if "Tm" in found:
            found["Tm"] += base
        return law_text(law, {name: {"Tr": base, **fixed, **found}[name] for name in PARAMETERS[TEMPERATURE][law]},
                        digits)

    return Factor(TEMPERATURE, law, sought, text_of)


def new_factor(of: str, law: str, tests: Ratios, fixed: Mapping[str, float]) -> Factor:
    """Return a law of the rate or of the temperature to identify. `fixed`: parameters that are given."""
    return (rate_factor if of == RATE else temperature_factor)(law, tests, fixed)


def factors_at(points: Points, of: str, laws: Sequence[str], places: np.ndarray) -> list[Any]:
    """Return the factors that the program has at rates or temperatures for each text of a law; None for a law that it
    refuses."""
    own = ["yield = von_mises", f"hardening = perfect Y0={FLOW:g}"]
    target = [([0.1, 0, 0, 0, 0, 0], 4)]
    if of == RATE:
        found = points.rows([(*own, f"rate = {law}") for law in laws],
                            [LoadPath(TENSION, 0, target, place) for place in places])
        return [None if rows is None else np.array([part[-1]["s11"] for part in rows]) / FLOW for rows in found]
    cases = [((*own, f"temperature = {law}", f"initial_temperature = {place:.10g}"), [LoadPath(TENSION, 0, target)])
             for law in laws for place in places]
    each = points.rows_of(cases)
    groups = [each[i:i + len(places)] for i in range(0, len(each), len(places))]
    return [None if any(rows is None for rows in group) else
            np.array([rows[0][-1]["s11"] for rows in group]) / FLOW for group in groups]


def from_ratios(of: str, law: str, tests: Ratios, reference: float | None, fixed: Mapping[str, float],
                points: Points, search: Search) -> tuple[str, list[str], list[str]]:
    """Identify a law from ratios to the flow stress at a reference rate or temperature, None for ratios to that of the
    hardening law; return its text, the table of values and notes."""
    places = tests.place if reference is None else np.append(tests.place, reference)

    def compute(texts: list[str]) -> list[Any]:
        return [values if values is None or reference is None else values[:-1] / values[-1]
                for values in factors_at(points, of, texts, places)]

    notes = []
    if law == "table":
        knots = knots_of(tests.place)
        turn = np.log if of == RATE else np.asarray
        values = straight_lines(turn(knots), turn(tests.place), tests.ratio, 1 if of == RATE else 0)
        text, found = rounded(partial(pairs_text, "table", knots, values), compute)
    else:
        factor = new_factor(of, law, tests, fixed)
        fit = Fit(lambda sets: compute([factor.text_of(one, 10) for one in sets]), factor.sought, tests.ratio,
                  np.full(len(tests.ratio), len(tests.ratio) ** -0.5), 1e-6)
        point, costs = fit.best(search.starts, 0.15, search.seed) if factor.sought else (np.zeros(0), [])
        text, found = rounded(lambda digits: factor.text_of(dict(zip(factor.sought, point)), digits), compute)
        if factor.sought:
            report(f"{of}, {law}", costs)
            names = names_sought(of, law, fixed)
            others = tests.place if reference is None else tests.place[tests.place != reference]
            notes = one_place(of, others, names)
            notes += fit.left_open(point, "left as at the start", "other values of the rest may do as well")
            notes += fit.at_ends(point)
    if reference is not None:
        here = float(factors_at(points, of, [text], np.array([reference]))[0][0])
        if abs(here - 1) > 1e-3:
            notes.append(f"the factor at the reference {of} {reference:g} is {here:.4g}: the flow stress of that test "
                         "has to be divided by it for the hardening law, which --curve does")
    unit = "/s" if of == RATE else ""
    lines = [compared(f"{of} {place:g}{unit}, ratio", one, two) for place, one, two in zip(*tests, found)]
    return text, [*lines, misfit(tests.ratio, found, "ratios")], notes


def read_curves(texts: Sequence[str], of: str, read: Callable[[str], Any]) -> list[tuple[float, Any]]:
    """Return rate or temperature and curve of the arguments of an option, such as 0.001:slow.csv."""
    low, high, meant = LIMITS[of]

    def one(text: str) -> tuple[float, Any]:
        place, _, path = text.partition(":")
        try:
            value = float(place)
        except ValueError:
            value = np.nan
        if not low <= value <= high or not path:
            raise Problem(f"--{of}-curves {text}: error: no {of} and file\n  expected: {meant}, a colon and a file, "
                          f"such as {'0.001:slow.csv' if of == RATE else '20:cold.csv'}")
        return value, read(path)

    return every([partial(one, text) for text in texts])


def draw(axes: Axes, of: str, law: str, tests: Ratios, reference: float | None, points: Points) -> None:
    """Draw measured ratios, and the factors of a law over that at the reference rate or temperature, None for ratios
    over the flow stress of the hardening law."""
    places = (np.geomspace if of == RATE else np.linspace)(tests.place.min(), tests.place.max(), 60)
    values = factors_at(points, of, [law], places)[0]
    if reference is not None:
        values = values / factors_at(points, of, [law], np.array([reference]))[0]
    axes.plot(places, values, label="identified")
    axes.plot(*tests, "s", color="k", markerfacecolor="none", label="measured")
    axes.set(xlabel="strain rate (1/s)" if of == RATE else "temperature",
             ylabel="flow stress over that of the " + ("hardening law" if reference is None else "reference test"))
    if of == RATE:
        axes.set_xscale("log")
