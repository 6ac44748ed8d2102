# SPDX-License-Identifier: GPL-3.0-or-later
"""Identification of a yield criterion from measured r-values and yield stresses."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from dd3.errors import Problem
from dd3.identify.least_squares import PULL, UNIT, Fit, LoadPath, Points, law_text, report, rounded
from dd3.identify.measurements import Datum

MISSED = 0.1  # difference from a measured value, over the value or 1, that is noted

# Criterion: its parameters with start, lowest and highest value; the values of those that are not sought; the least
# number of measured values.
NORMAL, SHEAR = ("12", "13", "21", "23", "31", "32"), ("66",)
BANABIC = ("l1", "l2", "m1", "m2", "m3", "n1", "n2", "n3")
CRITERIA: dict[str, tuple[dict[str, tuple[float, float, float]], dict[str, float], int]] = {
    "hill48": ({"F": (0.5, -1, 5), "G": (0.5, -1, 5), "H": (0.5, -1, 5), "N": (1.5, 0.05, 10)}, {}, 3),
    "hosford": ({"m": (6, 2, 100)}, {}, 1),
    "yld91": (dict.fromkeys("abch", (1, -3, 4)), {"m": 8}, 3),
    "karafillis_boyce": ({"c": (0.3, 0, 1), "scale": (2 / 3, 0.1, 2), "alpha1": (1, 0, 3), "alpha2": (1, 0, 3),
                          "gamma3": (1.5, 0.1, 5)}, {"k": 4}, 3),
    "drucker": ({"c": (0.5, -3.37, 2.24), **dict.fromkeys(("C1", "C2", "C3"), (1, -3, 4)), "C6": (1, 0.05, 4)},
                {}, 3),
    "cazacu_barlat2001": ({**{f"a{i}": (1, 0.05, 5) for i in (1, 2, 3, 4)},
                           **{f"b{i}": (1, -5, 5) for i in (1, 2, 3, 4, 5, 10)}, "c": (0.5, -3.37, 2.24)}, {}, 3),
    "yld2004": ({letter + place: (1, -3, 4) for letter in "cd" for place in NORMAL + SHEAR}, {"m": 8}, 3),
    "cpb06": ({"C12": (0, -3, 3), "C13": (0, -3, 3), "C22": (1, -4, 4), "C23": (0, -3, 3), "C33": (1, -4, 4),
               "C66": (1, 0.05, 5), "k": (0, -0.99, 0.99)}, {"C11": 1, "m": 2}, 3),
    "yld2000": ({f"alpha{i}": (1, -3, 4) for i in range(1, 9)}, {"m": 8}, 3),
    "bbc2008": ({f"{name}_{r}": (0.5, -2, 2) for r in (1, 2) for name in BANABIC}, {"k": 4}, 3),
}
# Criteria whose isotropic start is a saddle, as two of their parts are the same there: the parameters of the first one.
SADDLES = {"yld2004": lambda name: name.startswith("c"), "bbc2008": lambda name: name.endswith("_1")}


def sought_parameters(law: str, given: Mapping[str, float], data: list[Datum]
                     ) -> tuple[dict[str, tuple[float, float, float]], dict[str, float]]:
    """Return the parameters of a criterion to identify, with start and bounds, and those that are given."""
    sought, fixed, least = CRITERIA[law]
    sought, fixed = dict(sought), dict(fixed)
    unknown = [name for name in given if name not in sought and name not in fixed]
    if unknown:
        raise Problem(f"--fix: error: {law} has no {' '.join(unknown)}\n  expected: one of "
                      + " ".join([*sought, *fixed]))
    for name, value in given.items():
        sought.pop(name, None)
        fixed[name] = value
    if "k" in sought and law == "cpb06" and not any("compression" in datum.kind for datum in data):
        fixed["k"] = sought.pop("k")[0]
    if law == "cpb06" and "C66" in sought and not any(0 < datum.angle < 90 for datum in data):
        sought.pop("C66")  # the program's own value follows the other parameters
    if not sought:
        raise Problem(f"--fix: error: all parameters of {law} are given\n  expected: one to seek")
    if len(data) < least:
        raise Problem(f"{law}: error: {len(data)} measured value{'s' * (len(data) != 1)}\n  expected: "
                      f"{least} or more, such as r-values at 0, 45 and 90 degrees")
    if law == "hosford" and not any(datum.kind == "plane strain" for datum in data):
        raise Problem("hosford: error: tension and equibiaxial tension do not determine m\n"
                      "  expected: --plane-strain, or no identification: m is 6 for bcc, 8 for fcc metals")
    return sought, fixed


def test_paths(data: list[Datum]) -> dict[tuple[str, float], LoadPath]:
    """Return the paths of the tests of the data, each once, by test."""
    paths = {d.same_test(): d.path() for d in data}
    return {test: LoadPath(control, angle, [(values, 1) for values in targets])
            for test, (control, angle, targets) in paths.items()}


def criterion_table(data: list[Datum], values: np.ndarray) -> list[str]:
    """Return the lines that compare measured and identified values."""
    return [f"{d.label():<32}{'-' if d.value is None else f'{d.value:.4f}':>10}{value:>12.4f}"
            + (f"{value - d.value:>12.4f}{d.weight:>8g}" if d.value is not None else "")
            for d, value in zip(data, values)]


def criterion(law: str, given: Mapping[str, float], points: Points, data: list[Datum], starts: int, seed: int
              ) -> tuple[str, list[str], list[str]]:
    """Identify a criterion, with some of its parameters given, from several starts; return its text, the table of
    values and notes. A missing yield stress along rolling is added to the data."""
    sought, fixed = sought_parameters(law, given, data)
    if not any(d.same_test() == ("tension", 0) and d.quantity == "stress" for d in data):
        data.insert(0, Datum("stress", 0.0, 1.0))
    extra = [Datum(key) for key in ("biaxial_stress", "biaxial_r")
            if not any(d.label() == Datum(key).label() for d in data)]
    paths = test_paths(data + extra)
    place = {test: i for i, test in enumerate(paths)}

    def compute(texts: list[str]) -> list[Any]:
        found = points.rows([(f"yield = {text}", f"hardening = {UNIT}") for text in texts], list(paths.values()))
        return [None if rows is None else np.array([d.computed(rows[place[d.same_test()]]) for d in data + extra])
                for rows in found]

    def evaluate(sets: list[dict[str, float]]) -> list[Any]:
        return [None if values is None or values[ratio] <= 0 else values[:len(data)]
                for values in compute([law_text(law, {**one, **fixed}) for one in sets])]

    ratio = next(i for i, d in enumerate(data + extra) if d.kind == "equibiaxial" and d.quantity == "r")
    fit = Fit(evaluate, sought, [d.value for d in data], [d.weight for d in data], PULL)
    if law in SADDLES:
        first = SADDLES[law]
        fit.start = fit.start + np.array([0.02 if first(name) else -0.02 for name in fit.names])
    point, costs = fit.best(starts, 0.3, seed)
    text, values = rounded(lambda digits: law_text(law, {**dict(zip(sought, point)), **fixed}, digits), compute)
    report(law, costs)
    notes = fit.left_open(point, "left as in the isotropic case", "the rest stays as near to isotropy as they allow")
    if law == "cpb06" and "C66" not in {**sought, **fixed}:
        notes.insert(0, "the data do not determine C66: left out, so that it follows the other parameters")
    return text, criterion_table(data + extra, values), notes + fit.at_ends(point) + missed(data, values)


def missed(data: list[Datum], values: np.ndarray) -> list[str]:
    """Return notes on the measured values that the criterion does not fit."""
    far = [f"{d.label()} is {value:.4g} in place of {d.value:.4g}" for d, value in zip(data, values)
           if d.weight and abs(value - d.value) > MISSED * max(d.value, 1)]
    return [f"{text}: another criterion may fit the data better, or the value is wrong" for text in far]
