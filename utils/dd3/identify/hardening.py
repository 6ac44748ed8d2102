# SPDX-License-Identifier: GPL-3.0-or-later
"""Identification of a hardening law, with back-stresses, from a tension curve."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from dd3.errors import Problem
from dd3.identify.factors import Factor
from dd3.identify.least_squares import Case, Fit, LoadPath, Points, Search, law_text, report, rounded
from dd3.identify.measured_table import compared, misfit
from dd3.identify.measurements import TENSION, read_curve

NECKED = 0.8  # slope of a tension curve over its stress below which it is noted, 1 at the largest force
NECKED_PART = 0.1  # of the strain, over which the slope is taken at least
MISSED_CURVE = 0.01  # root mean square of the difference, over the largest stress, that is noted
LAWS = ("linear", "swift", "voce", "swift_voce", "ludwik", "hockett_sherby", "table", "yoshida_uemori",
        "teodosiu_hu")
REVERSING = ("yoshida_uemori", "teodosiu_hu")  # laws with a back-stress of their own
BACKSTRESSES = {"prager": ("k",), "lemaitre_chaboche": ("CX", "Xsat")}
# Parameters without influence on tension and compression: those of the latent structures.
NOT_IN_CURVES = {"teodosiu_hu": {"CSL": 1.0, "nL": 1.0, "r": 0.0}}


class Curve(NamedTuple):
    """Measured strains and stresses (MPa), and the rows at which the strain turns."""

    strain: np.ndarray
    stress: np.ndarray
    turns: np.ndarray


def law_start(name: str, plastic: np.ndarray, stress: np.ndarray) -> dict[Any, float]:
    """Return the starting values of a hardening law's parameters; B of yoshida_uemori less Y."""
    first, last, end = stress[0], stress.max(), max(plastic.max(), 1e-3)
    rise = max(last - first, 0.05 * last)
    swift = {"K": last / (0.01 + end) ** 0.2, "e0": 0.01, "n": 0.2}
    voce = {"Y0": first, "Rsat": rise, "CR": 2 / end}
    laws: dict[str, dict[Any, float]] = {
        "linear": {"Y0": first, "H": rise / end}, "swift": swift, "voce": voce,
        "ludwik": {"Y0": 0.9 * first, "K": rise / end**0.5, "n": 0.5},
        "hockett_sherby": {"Y0": first, "Ysat": first + 1.2 * rise, "N": 2 / end, "q": 0.8},
        "swift_voce": {"alpha": 0.5, **swift, **voce}, "table": table_start(plastic, stress),
        "yoshida_uemori": {"Y": 0.8 * first, "B": 0.4 * first, "C": 200.0, "m": 1 / end, "b_sat": 0.1 * last,
                           "Rsat": 0.7 * rise, "h": 0.5},
        "teodosiu_hu": {"Y0": 0.8 * first, "CR": 8 / end, "Rsat": 0.3 * rise, "CX": 100.0, "X0": 0.1 * first,
                        "Ssat": 0.8 * rise, "CSD": 1 / end, "CP": 2.0, "nP": 20.0, "f": 0.7}}
    return laws[name]


def table_start(plastic: np.ndarray, stress: np.ndarray) -> dict[float, float]:
    """Return the start of a table: the initial flow stress and its rise from each knot to the next."""
    count = min(8, len(plastic) - 1)
    knots = [float(f"{value:.4g}") for value in plastic.max() * np.linspace(0, 1, count) ** 2]
    order = np.argsort(plastic)
    values = np.maximum.accumulate(np.interp(knots, plastic[order], stress[order]))
    rises = np.maximum(np.diff(values), 1e-3 * stress.max())
    return {knots[0]: values[0], **dict(zip(knots[1:], rises))}


def hardening_lines(name: str, values: dict[Any, float], digits: int = 10) -> list[str]:
    """Return the input lines of the hardening and of the back-stresses, whose keys are (law, number, parameter)."""
    own = {key: value for key, value in values.items() if not isinstance(key, tuple)}
    if name == "table":
        knots = " ".join(f"{knot:g}:{value:.{digits}g}" for knot, value in zip(own, np.cumsum(list(own.values()))))
        lines = [f"hardening = table {knots}"]
    elif name == "yoshida_uemori":
        lines = ["hardening = " + law_text(name, own | {"B": own["Y"] + own["B"]}, digits)]
    else:
        lines = ["hardening = " + law_text(name, {**NOT_IN_CURVES.get(name, {}), **own}, digits)]
    for law in dict.fromkeys(key[:2] for key in values if isinstance(key, tuple)):
        part = {key[2]: value for key, value in values.items() if isinstance(key, tuple) and key[:2] == law}
        lines.append("backstress = " + law_text(law[0], part, digits))
    return lines


def reverses(law: str, backstresses: Sequence[str]) -> bool:
    """Whether a law, with back-stresses, needs a curve that turns."""
    return bool(backstresses) or law.split()[0] in REVERSING


def measured_curve(path: str, young: float, turns_too: bool, plastic_strain: bool) -> Curve:
    """Return at most 60 rows of a table beyond the first elastic range; `plastic_strain`: its strains are plastic."""
    strain, stress = read_curve(path, turns_too)
    if plastic_strain:
        strain = strain + stress / young
    plastic = strain - stress / young
    beyond = np.abs(plastic) > 2e-4
    first = 0 if plastic_strain else int(np.argmax(beyond)) if beyond.any() else len(strain)
    strain, stress = strain[first:], stress[first:]
    if len(strain) < 4:
        raise Problem(f"{path}: error: {len(strain)} rows beyond the elastic range of --young "
                      f"{young:g}\n  expected: four or more")
    turns = np.flatnonzero(np.diff(np.sign(np.diff(strain)))) + 1
    if turns_too and not len(turns):
        raise Problem(f"{path}: error: the strain increases throughout: no back-stress can be identified\n"
                      "  expected: a curve with a reversal, such as tension and then compression")
    if len(strain) > 60:
        chosen = np.linspace(0, len(strain) - 1, 60).astype(int)
        chosen = np.unique(np.concatenate([chosen, turns]))
        strain, stress = strain[chosen], stress[chosen]
        turns = np.flatnonzero(np.diff(np.sign(np.diff(strain)))) + 1
    return Curve(strain, stress, turns)


def hardening_start(law: str, backstresses: Sequence[str], curve: Curve, young: float,
                    fixed: Mapping[str, float] | None = None) -> dict[Any, tuple[float, float, float]]:
    """Return the logarithms of the parameters to identify, with start and bounds."""
    forward = slice(0, curve.turns[0] + 1 if len(curve.turns) else None)
    sign = np.sign(curve.stress[forward][-1])  # it may begin with compression
    stress = sign * curve.stress[forward]
    start = law_start(law, sign * curve.strain[forward] - stress / young, stress)
    most = stress.max()
    for number, backstress in enumerate(backstresses):
        first = {"k": most, "CX": 15 * 8**number, "Xsat": 0.15 * most}
        start.update({(backstress, number, name): first[name] for name in BACKSTRESSES[backstress]})
    highest = {"n": 1, "q": 1, "alpha": 1, "h": 1, "f": 1, "nP": 1000}
    return {name: (np.log(value), np.log(value / 300), np.log(highest.get(name, value * 300)))
            for name, value in start.items() if name not in (fixed or {})}


class Test(NamedTuple):
    """A measured curve with its rate (1/s) and temperature, if the laws depend on them, and its name in the table."""

    curve: Curve
    rate: float | None = None
    temperature: float | None = None
    name: str = ""

    def path(self, turns_too: bool) -> LoadPath:
        """Return the path of the strains. Laws of a back-stress and of the rate are integrated step by step, those of
        the rate finely up to the first row, which begins at rest."""
        strain = self.curve.strain
        ways = np.abs(np.diff(strain, prepend=0))
        counts = np.ones(len(strain), int)
        if turns_too or self.rate:
            counts = np.maximum(1, np.ceil(ways / (0.002 if not self.rate else 0.001))).astype(int)
        if self.rate:
            counts[0] = max(counts[0], min(100, int(np.ceil(ways[0] / 1e-4))))
        return LoadPath(TENSION, 0, [([value, 0, 0, 0, 0, 0], count) for value, count in zip(strain, counts)],
                        self.rate)

    def stresses(self, rows: Sequence[dict[str, float]], path: LoadPath) -> np.ndarray:
        """Return the stresses at the strains from the rows of the path."""
        return np.array([rows[i]["s11"] for i in np.cumsum([count for _, count in path.targets])])


@dataclass
class Model:
    """What is identified from curves: a hardening law, by its name, or given as the text of a law with its values;
    back-stresses; laws of rate and temperature; `lines`: further lines of the material that are known."""

    law: str
    yields: str = "von_mises"
    backstresses: Sequence[str] = ()
    factors: Sequence[Factor] = ()
    lines: Sequence[str] = ()
    fixed: Mapping[str, float] = field(default_factory=dict)  # parameters of the hardening law that are given

    def sought(self, reference: Curve, young: float) -> dict[Any, tuple[float, float, float]]:
        """Return the parameters to identify, with start and bounds. `reference`: the slowest and coldest curve."""
        own = hardening_start(self.law, self.backstresses, reference, young, self.fixed) if self.law in LAWS else {}
        return own | {key: bounds for factor in self.factors for key, bounds in factor.sought.items()}

    def text(self, values: Mapping[Any, float], digits: int = 10) -> list[str]:
        """Return the lines of hardening, back-stresses, rate and temperature with logarithms of the parameters."""
        names = {key for factor in self.factors for key in factor.sought}
        own = {key: float(np.exp(value)) for key, value in values.items() if key not in names}
        lines = (hardening_lines(self.law, {**own, **self.fixed}, digits) if self.law in LAWS else
                 [f"hardening = {self.law}"])
        return lines + [factor.line(values, digits) for factor in self.factors]

    def stresses(self, tests: Sequence[Test], points: Points, laws: Sequence[Sequence[str]]) -> list[Any]:
        """Return the stresses of all curves, one after the other, for the lines of each trial; None for one that the
        program refuses."""
        turns_too = reverses(self.law, self.backstresses)
        paths = [test.path(turns_too) for test in tests]
        warm = list(dict.fromkeys(test.temperature for test in tests))
        groups = [[i for i, test in enumerate(tests) if test.temperature == degrees] for degrees in warm]
        own = [f"yield = {self.yields}", *self.lines]
        cases: list[Case] = [
            ([*own, *lines, *([] if degrees is None else [f"initial_temperature = {degrees:.10g}"])],
             [paths[i] for i in group]) for lines in laws for degrees, group in zip(warm, groups)]
        found = points.rows_of(cases)
        result: list[Any] = []
        for first in range(0, len(found), len(warm)):
            part = found[first:first + len(warm)]
            if any(rows is None for rows in part):
                result.append(None)
                continue
            by_test = {i: rows for group, several in zip(groups, part) for i, rows in zip(group, several)}
            result.append(np.concatenate([test.stresses(by_test[i], paths[i]) for i, test in enumerate(tests)]))
        return result


def strain_past_necking(curve: Curve) -> float | None:
    """Return the strain from which the slope of a tension curve up to its end is below its stress: there a test necks
    (Considère). None for a curve without such a part, and for one with a reversal."""
    strain, stress, turns = curve
    if len(turns):
        return None
    from_here = strain < strain[-1] - NECKED_PART * (strain[-1] - strain[0])
    slope = (stress[-1] - stress[from_here]) / (strain[-1] - strain[from_here])
    flat = np.flatnonzero(slope < NECKED * 0.5 * (stress[-1] + stress[from_here]))
    return float(strain[flat[0]]) if len(flat) else None


def curve_table(test: Test, values: np.ndarray) -> list[str]:
    """Return the lines that compare eight rows of a curve, and the differences of all (MPa)."""
    strain, stress, _ = test.curve
    some = np.unique(np.linspace(0, len(strain) - 1, 8).astype(int))
    return [*([test.name] * bool(test.name)),
            *(compared(f"strain {strain[i]:.4f}, MPa", stress[i], values[i], 2) for i in some),
            misfit(stress, values, "rows", " MPa", 2)]


def hardening(model: Model, tests: Sequence[Test], points: Points, search: Search
              ) -> tuple[list[str], list[str], list[str], list[np.ndarray]]:
    """Identify a hardening law, and laws of the rate and the temperature, from curves, the first of them the slowest
    and coldest one, from several starts; return the lines, the table of values, notes, and the stresses of each
    curve."""
    sought = model.sought(tests[0].curve, points.young)
    stress = np.concatenate([test.curve.stress for test in tests])

    def compute(laws: list[list[str]]) -> list[Any]:
        return model.stresses(tests, points, laws)

    weight = 1 / (np.abs(stress).max() * np.sqrt(len(stress)))
    fit = Fit(lambda sets: compute([model.text(one) for one in sets]), sought, stress,
              np.full(len(stress), weight), 1e-6)
    point, costs = fit.best(search.starts, 0.15, search.seed) if sought else (np.zeros(0), [])
    lines, values = rounded(lambda digits: model.text(dict(zip(sought, point)), digits), compute)
    report(", ".join([model.law.split()[0], *(factor.law for factor in model.factors)]), costs)
    far = np.linalg.norm(weight * (values - stress))
    notes = fit.left_open(point, "left as at the start", "other values of the rest may do as well") if sought else []
    notes += fit.at_ends(point)
    if model.law in NOT_IN_CURVES:
        names = [name for name in NOT_IN_CURVES[model.law] if name not in model.fixed]
        notes += [f"no tension and compression determines {', '.join(names)}, which act after a change to another "
                  "direction only: --fix hardening.NAME=VALUE"] * bool(names)
    necked = [strain for test in tests if (strain := strain_past_necking(test.curve)) is not None]
    if necked:
        notes.append(f"from the strain {min(necked):.3g} on a curve rises by less than its stress per strain: a "
                     "tension test necks before. Are these nominal values (true stress = nominal stress (1 + strain)), "
                     "or of another test, such as bulging?")
    if far > MISSED_CURVE:
        notes.append(f"the curve{'s are' if len(tests) > 1 else ' is'} missed by {100 * far:.1f} % of "
                     f"{'their' if len(tests) > 1 else 'its'} largest stress: another law may fit "
                     f"{'them' if len(tests) > 1 else 'it'} better")
    each = np.split(values, np.cumsum([len(test.curve.strain) for test in tests])[:-1])
    return lines, [line for test, one in zip(tests, each) for line in curve_table(test, one)], notes, each
