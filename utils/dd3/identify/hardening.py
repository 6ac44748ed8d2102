# SPDX-License-Identifier: GPL-3.0-or-later
"""Identification of a hardening law, with back-stresses, from a tension curve."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from dd3.errors import Problem
from dd3.identify.least_squares import Fit, LoadPath, Points, law_text, report, rounded
from dd3.identify.measurements import TENSION, read_curve

MISSED_CURVE = 0.01  # root mean square of the difference, over the largest stress, that is noted
LAWS = ("linear", "swift", "voce", "swift_voce", "ludwik", "hockett_sherby", "table", "yoshida_uemori")
REVERSING = ("yoshida_uemori",)  # laws with a back-stress of their own
BACKSTRESSES = {"prager": ("k",), "lemaitre_chaboche": ("CX", "Xsat")}


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
                           "Rsat": 0.7 * rise, "h": 0.5}}
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
        lines = ["hardening = " + law_text(name, own, digits)]
    for law in dict.fromkeys(key[:2] for key in values if isinstance(key, tuple)):
        part = {key[2]: value for key, value in values.items() if isinstance(key, tuple) and key[:2] == law}
        lines.append("backstress = " + law_text(law[0], part, digits))
    return lines


def reverses(law: str, backstresses: Sequence[str]) -> bool:
    """Whether a law, with back-stresses, needs a curve that turns."""
    return bool(backstresses) or law in REVERSING


def measured_curve(path: str, young: float, turns_too: bool, plastic_strain: bool) -> Curve:
    """Return at most 60 rows of a table beyond the first elastic range; `plastic_strain`: its strains are plastic."""
    strain, stress = read_curve(path, turns_too)
    if plastic_strain:
        strain = strain + stress / young
    plastic = strain - stress / young
    first = 0 if plastic_strain else int(np.argmax(plastic > 2e-4))
    if not plastic_strain and not np.any(plastic > 2e-4):
        first = len(strain)
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


def hardening_start(law: str, backstresses: Sequence[str], curve: Curve, young: float
                   ) -> dict[Any, tuple[float, float, float]]:
    """Return the logarithms of the parameters to identify, with start and bounds."""
    forward = slice(0, curve.turns[0] + 1 if len(curve.turns) else None)
    stress = curve.stress[forward]
    start = law_start(law, curve.strain[forward] - stress / young, stress)
    most = stress.max()
    for number, backstress in enumerate(backstresses):
        first = {"k": most, "CX": 15 * 8**number, "Xsat": 0.15 * most}
        start.update({(backstress, number, name): first[name] for name in BACKSTRESSES[backstress]})
    highest = {"n": 1, "q": 1, "alpha": 1, "h": 1}
    return {name: (np.log(value), np.log(value / 300), np.log(highest.get(name, value * 300)))
            for name, value in start.items()}


def curve_table(strain: np.ndarray, stress: np.ndarray, values: np.ndarray, missed_by: float) -> list[str]:
    """Return the lines that compare eight rows of the curve, and the root mean square of the difference (MPa)."""
    some = np.unique(np.linspace(0, len(strain) - 1, 8).astype(int))
    return [*(f"{f'strain {strain[i]:.4f}, MPa':<32}{stress[i]:>10.2f}{values[i]:>12.2f}{values[i] - stress[i]:>12.2f}"
              for i in some), f"root mean square over {len(strain)} rows: {missed_by:.2f} MPa"]


def hardening(law: str, backstresses: Sequence[str], curve: Curve, points: Points, yields: str, starts: int, seed: int
             ) -> tuple[list[str], list[str], list[str], np.ndarray]:
    """Identify a hardening law from several starts; return its lines, the table of values, notes, and its stresses."""
    strain, stress, _ = curve
    sought = hardening_start(law, backstresses, curve, points.young)
    counts = np.ones(len(strain), int)
    if reverses(law, backstresses):  # the law of the back-stress is integrated step by step
        counts = np.maximum(1, np.ceil(np.abs(np.diff(strain, prepend=0)) / 0.002)).astype(int)
    path: LoadPath = (TENSION, 0, [([value, 0, 0, 0, 0, 0], count) for value, count in zip(strain, counts)])
    ends = np.cumsum(counts)

    def compute(laws: list[list[str]]) -> list[Any]:
        found = points.rows([(f"yield = {yields}", *lines) for lines in laws], [path])
        return [None if rows is None else np.array([rows[0][i]["s11"] for i in ends]) for rows in found]

    def evaluate(sets: list[dict[Any, float]]) -> list[Any]:
        return compute([hardening_lines(law, {key: np.exp(value) for key, value in one.items()})
                        for one in sets])

    weight = 1 / (np.abs(stress).max() * np.sqrt(len(stress)))
    fit = Fit(evaluate, sought, stress, np.full(len(stress), weight), 1e-6)
    point, costs = fit.best(starts, 0.15, seed)
    found = dict(zip(sought, np.exp(point)))
    lines, values = rounded(lambda digits: hardening_lines(law, found, digits), compute)
    report(law, costs)
    far = np.linalg.norm(weight * (values - stress))
    table = curve_table(strain, stress, values, far * np.abs(stress).max())
    notes = fit.left_open(point, "left as at the start", "other values of the rest may do as well") + fit.at_ends(point)
    if far > MISSED_CURVE:
        notes.append(f"the curve is missed by {100 * far:.1f} % of its largest stress: "
                     "another law may fit it better")
    return lines, table, notes, values
