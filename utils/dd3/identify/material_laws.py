# SPDX-License-Identifier: GPL-3.0-or-later
"""What `dd3 identify` and `dd3 fit` do beside the criterion: read all tables, then identify the laws of the modulus,
the rate, the temperature, the hardening and the fracture, each with what was found before."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import zip_longest
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dd3.columns import every
from dd3.errors import Problem
from dd3.identify import factors, fracture, fracture_table, modulus
from dd3.identify.factors import RATE, TEMPERATURE, Factor, Ratios
from dd3.identify.hardening import (
    LAWS,
    NOT_IN_CURVES,
    Curve,
    Model,
    Test,
    curve_table,
    hardening,
    hardening_start,
    measured_curve,
    reverses,
)
from dd3.identify.least_squares import UNIT, Points, Search
from dd3.identify.rate_curves import curves_law
from dd3.identify.task import YOUNG, Task
from dd3.plot.figures import new_figure

AT_REST = 1e-9  # rate of a curve at rest, 1/s
ROOM = 20.0  # initial temperature of a material without the line


@dataclass
class Measured:
    """The tables of a task."""

    moduli: modulus.Moduli | None = None
    ratios: dict[str, Ratios] = field(default_factory=dict)  # of rate and temperature
    tests: list[Test] = field(default_factory=list)  # curves, the slowest and coldest first
    strains: fracture.Tests | None = None
    lode: bool = True  # whether the tests of fracture have Lode angles


@dataclass
class Laws:
    """What was identified: lines of *MATERIAL, the table of values, notes; stresses of each curve."""

    lines: list[str] = field(default_factory=list)
    table: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    stresses: list[np.ndarray] = field(default_factory=list)
    elastic: modulus.Found | None = None

    def add(self, table: Sequence[str], notes: Sequence[str]) -> None:
        """Add values and notes."""
        self.table += table
        self.notes += notes

    def text_of(self, key: str) -> str | None:
        """Return the text of a law that was found."""
        return next((line.partition(" = ")[2] for line in self.lines if line.startswith(f"{key} = ")), None)


def reference_of(task: Task, of: str, ratios: Ratios | None) -> float | None:
    """Return the reference rate or temperature of ratios, by default the lowest; None for ratios over the flow stress
    of the hardening law."""
    given = task.rate_reference if of == RATE else task.temperature_reference
    if given is None:
        return float(ratios.place.min()) if ratios else None
    return None if of == RATE and given == 0 else given


def read_measured(task: Task) -> Measured:
    """Read all tables of a task; a Problem has the errors of all."""
    found = Measured()

    def moduli() -> None:
        if task.moduli and task.modulus:
            found.moduli = modulus.read_moduli(task.moduli, task.modulus, task.young, task.fixed("modulus"))

    def ratios(of: str) -> None:
        path, law = getattr(task, f"{of}_ratios"), getattr(task, of)
        if path:
            found.ratios[of] = factors.read_ratios(path, of, law, task.fixed(of))

    def tests() -> None:
        young = task.young or (found.moduli.initial() if found.moduli else YOUNG)
        found.tests = read_tests(task, young)

    def strains() -> None:
        if task.fracture and task.fracture_law == "table":
            found.strains, found.lode = fracture_table.read_points(task.fracture)
        elif task.fracture:
            found.strains = fracture.read_tests(task.fracture)

    every([moduli, partial(ratios, RATE), partial(ratios, TEMPERATURE), tests, strains])
    set_conditions(task, found)
    return found


def read_tests(task: Task, young: float) -> list[Test]:
    """Return the curves of a task, the slowest and coldest first. `young`: MPa."""
    turns_too = bool(task.hardening) and reverses(str(task.hardening), task.backstresses)

    def read(path: str) -> Curve:
        return measured_curve(path, young, turns_too, task.plastic_strain)

    if task.curve:
        return [Test(read(task.curve))]
    parts = [partial(factors.read_curves, texts, of, read)
             for of, texts in ((RATE, task.rate_curves), (TEMPERATURE, task.temperature_curves))]
    fast, warm = every(parts)
    low = min((rate for rate, _ in fast), default=None)
    cold = min((degrees for degrees, _ in warm), default=None)
    tests = [Test(curve, rate, cold, f"rate {rate:g}/s") for rate, curve in fast]
    tests += [Test(curve, low, degrees, f"temperature {degrees:g}") for degrees, curve in warm]
    return sorted(tests, key=lambda test: (test.rate or 0, test.temperature or 0))


def set_conditions(task: Task, found: Measured) -> None:
    """Set rate and temperature of the curves for which these are those of the reference of ratios."""
    slow = reference_of(task, RATE, found.ratios.get(RATE))
    cold = reference_of(task, TEMPERATURE, found.ratios.get(TEMPERATURE))
    if RATE in found.ratios:
        found.tests = [test._replace(rate=slow or AT_REST) for test in found.tests]
    if TEMPERATURE in found.ratios:
        found.tests = [test._replace(temperature=cold) for test in found.tests]


def ratios_of(tests: Sequence[Test], of: str, young: float) -> Ratios:
    """Return, for the start of an identification, the mean ratio of the stresses of curves to those of the first one,
    at the same plastic strains. `young`: MPa."""
    base = tests[0].curve
    strain = base.strain - base.stress / young
    chosen = [test for test in tests if (test.temperature == tests[0].temperature if of == RATE else
                                         test.rate == tests[0].rate)]
    ratios = []
    for test in chosen:
        own = test.curve.strain - test.curve.stress / young
        inside = (own >= strain[0]) & (own <= strain[-1])
        inside = inside if inside.any() else np.ones(len(own), bool)
        ratios.append(float(np.mean(test.curve.stress[inside] / np.interp(own[inside], strain, base.stress))))
    return Ratios(np.array([float((test.rate if of == RATE else test.temperature) or 0) for test in chosen]),
                  np.array(ratios))


def find_factors(task: Task, found: Measured, points: Points, search: Search, laws: Laws) -> list[Factor]:
    """Identify the laws of rate and temperature from ratios, and return those to identify from curves."""
    open_ones = []
    for of in (RATE, TEMPERATURE):
        law = getattr(task, of)
        if of in found.ratios:
            ratios = found.ratios[of]
            text, *rest = factors.from_ratios(of, law, ratios, reference_of(task, of, ratios), task.fixed(of), points,
                                              search)
            laws.lines.append(f"{of} = {text}")
            laws.add(*rest)
        elif law and law != "curves":
            ratios = ratios_of(found.tests, of, points.young)
            factor = factors.new_factor(of, law, ratios, task.fixed(of))
            laws.notes += factors.one_place(of, ratios.place[ratios.place != ratios.place.min()], [
                name for _, name in factor.sought if (of, name) != (RATE, "reference")])
            open_ones.append(factor)
    return open_ones


def find_hardening(task: Task, found: Measured, yields: str, points: Points, search: Search, laws: Laws) -> None:
    """Identify hardening, rate and temperature from curves, or take the hardening as given."""
    factors_open = find_factors(task, found, points, search, laws)
    if not found.tests:
        laws.lines.insert(0, f"hardening = {task.hardening or UNIT}")
        return
    model = Model(str(task.hardening), yields, task.backstresses, factors_open, tuple(laws.lines),
                  task.fixed("hardening"))
    unknown = set(model.fixed) - set(hardening_names(model, found.tests[0], points.young))
    if unknown:
        raise Problem(f"--fix hardening.{sorted(unknown)[0]}: error: no parameter of {model.law}\n  expected: "
                      f"{', '.join(hardening_names(model, found.tests[0], points.young))}")
    if task.rate == "curves":
        lines, laws_values = slowest_first(model, found.tests, points, search, laws)
    else:
        lines, table, notes, laws_values = hardening(model, found.tests, points, search)
        laws.add(table, notes)
    laws.stresses = laws_values
    laws.lines = lines + laws.lines


def hardening_names(model: Model, test: Test, young: float) -> list[str]:
    """Return the names of the parameters of the hardening law."""
    names = hardening_start(model.law, (), test.curve, young) if model.law in LAWS else {}
    return [name for name in names if isinstance(name, str)] + list(NOT_IN_CURVES.get(model.law, ()))


def slowest_first(model: Model, tests: Sequence[Test], points: Points, search: Search, laws: Laws
                  ) -> tuple[list[str], list[np.ndarray]]:
    """Identify the hardening from the slowest curve and the law of flow curves from all; return their lines and the
    stresses of each curve."""
    slow = [test._replace(rate=None) for test in tests if test.rate == tests[0].rate]
    lines, _, notes, _ = hardening(model, slow, points, search)
    lines = [*lines, f"rate = {curves_law(tests, points.young)}"]
    values = model.stresses(tests, points, [lines])[0]
    if values is None:
        raise Problem(f"--rate curves: error: the program refuses the curves: {points.refusal}")
    each = np.split(values, np.cumsum([len(test.curve.strain) for test in tests])[:-1])
    laws.add([line for test, one in zip(tests, each) for line in curve_table(test, one)], notes)
    return lines, each


def find_laws(task: Task, found: Measured, yields: str, points: Points) -> Laws:
    """Identify all laws beside the criterion; `points` gets Young's modulus and the law of the modulus."""
    laws, search = Laws(), Search(task.starts, task.seed)
    find_hardening(task, found, yields, points, search, laws)
    if (cold := temperature_of_tests(found, laws)) is not None:
        laws.lines.append(f"initial_temperature = {cold:g}")
    if task.fracture and found.strains:
        exponent = float(task.fracture_exponent or 1)
        if task.fracture_law == "table":
            text, table, notes = fracture_table.table(found.strains, found.lode, exponent, points)
        else:
            text, table, notes = fracture.fracture(found.strains, exponent, points, *search)
        laws.lines.append(f"fracture = {text}")
        laws.add(table, notes)
    return laws


def temperature_of_tests(found: Measured, laws: Laws) -> float | None:
    """Return the lowest temperature of the tests of a law of the temperature, if it is not that of a material by
    default."""
    if not laws.text_of(TEMPERATURE):
        return None
    ratios = found.ratios.get(TEMPERATURE)
    cold = float(ratios.place.min()) if ratios else found.tests[0].temperature
    return None if cold is None or abs(cold - ROOM) <= 10 else cold


def find_modulus(task: Task, found: Measured, points: Points) -> modulus.Found | None:
    """Identify the law of the modulus, which all points have from here on."""
    if not found.moduli or not task.modulus:
        return None
    result = modulus.modulus(task.modulus, found.moduli, task.young, task.fixed("modulus"), points,
                             Search(task.starts, task.seed))
    points.set_elastic(result.young, result.law)
    return result


def draw_curves(axes: Axes, found: Measured, laws: Laws) -> None:
    """Draw curves at several rates and temperatures, measured and identified."""
    for number, (test, stress) in enumerate(zip(found.tests, laws.stresses)):
        axes.plot(test.curve.strain, test.curve.stress, ".", color="k", label="measured" if number == 0 else None)
        axes.plot(test.curve.strain, stress, color=f"C{number % 10}", label=test.name)
    axes.set(xlabel="strain", ylabel="stress (MPa)")


def picture(task: Task, found: Measured, laws: Laws, points: Points) -> Figure | None:
    """Return the picture of the laws beside the hardening, a panel for each, and of curves at several rates or
    temperatures; None if there are none."""
    panels: list[Any] = []
    if laws.elastic and found.moduli:
        panels.append(lambda axes: modulus.draw(axes, laws.elastic, found.moduli, points))
    for of in (RATE, TEMPERATURE):
        text = laws.text_of(of)
        if text:
            ratios = found.ratios.get(of) or ratios_of(found.tests, of, points.young)
            panels.append(partial(factors.draw, of=of, law=text, tests=ratios, points=points,
                                  reference=reference_of(task, of, ratios)))
    if task.has_curves():
        panels.append(lambda axes: draw_curves(axes, found, laws))
    text = laws.text_of("fracture")
    if text and found.strains:
        panels.append(lambda axes: fracture.draw(axes, text, found.strains, points))
    if not panels:
        return None
    columns = min(len(panels), 2)
    figure, grid = new_figure((6 * columns, 4.5 * -(-len(panels) // 2)), -(-len(panels) // 2), columns, squeeze=False)
    for draw, axes in zip_longest(panels, grid.flat):
        if draw is None:
            axes.remove()
            continue
        draw(axes)
        axes.grid(True, color="0.9")
        axes.legend(frameon=False, fontsize="small")
    return figure
