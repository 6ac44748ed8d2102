# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured curves of a formed part, and their differences from the computed ones.

A table has a heading that names its columns, with units in brackets:

    travel [mm], punch_force [kN]
    angle [degrees], draw_in [mm]                    angle: of the place before the run, from x about the middle
    section, length0 [mm], thickness [mm]            section: y=0; length0: along its upper face before the run
    section, along [mm], z [mm]                      along: in its plane, x of a section y=0

Commas separate the columns, or semicolons or tabs, beside which decimal commas are read. Values over the same column
may stand beside each other, and cells may be blank.
"""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from dd3.columns import Line, lines_of
from dd3.errors import Problem
from dd3.pieces import distances

LENGTH = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "µm": 1e-3, "um": 1e-3, "in": 25.4, "inch": 25.4}
FORCE = {"N": 1.0, "kN": 1e3, "MN": 1e6, "mN": 1e-3, "lbf": 4.448222}
ANGLE = {"degrees": 1.0, "deg": 1.0, "°": 1.0, "rad": 57.295779513}
FRACTION = {"": 1.0, "-": 1.0, "1": 1.0, "%": 0.01}
SECTION = "section"
# What a column is measured over.
OVER = {"draw_in": "angle", "thickness": "length0", "thinning": "length0", "z": "along"}
UNITS = {"travel": LENGTH, "angle": ANGLE, "length0": LENGTH, "along": LENGTH, "draw_in": LENGTH, "thickness": LENGTH,
         "thinning": FRACTION, "z": LENGTH}
HEADING = re.compile(r"\s*([^\[(]*?)\s*(?:[\[(]\s*([^\])]*?)\s*[\])])?\s*")
LARGE = 1e9
SAME = 1e-6  # mm or degrees by which a point may lie beyond the ends of a curve


class Measured(NamedTuple):
    """A measured curve: its file, its name, what it is over, of which section; in mm, N, degrees, fractions."""

    file: str
    name: str
    over: str
    section: str
    at: np.ndarray
    values: np.ndarray

    def title(self) -> str:
        """Return the name in pictures and tables."""
        return self.name.replace("_", " ") + (f", section {self.section}" if self.section else "")


class Difference(NamedTuple):
    """Measured less computed values: number of points, the largest in size and where, root of the mean square; points
    beyond the computed curve, which are left out."""

    points: int
    largest: float
    where: float
    rms: float
    beyond: int


def read(path: str | Path, tools: Sequence[str]) -> list[Measured]:
    """Return the curves of a file; tools: those of the run, whose forces may be measured."""
    units: Mapping[str, Mapping[str, float]] = {**UNITS, **{f"{tool}_force": FORCE for tool in tools}}
    over = {**OVER, **{f"{tool}_force": "travel" for tool in tools}}
    filled = [line for line in lines_of(path) if line.words(r"\S+")]
    if len(filled) < 2:
        raise Problem(f"{path}: expected a heading and rows of numbers")
    separator = next((sign for sign in ";\t" if sign in filled[0].text), ",")
    names, factors = heading(filled[0], separator, units)
    values = [name for name in names if name in over]
    if not values:
        raise filled[0].problem(filled[0].end(), "no column of measured values", ", ".join(over))
    for name in values:
        if over[name] not in names:
            raise filled[0].problem(filled[0].end(), f"{name} without the column {over[name]}", f"{over[name]} [unit]")
        if over[name] in ("length0", "along") and SECTION not in names:
            raise filled[0].problem(filled[0].end(), f"{name} without the column {SECTION}", "its plane, such as y=0")
    rows = [row_of(line, separator, names, factors) for line in filled[1:]]
    return [curve for name in values for curve in curves(str(path), name, over[name], rows)]


def heading(line: Line, separator: str, units: Mapping[str, Mapping[str, float]]) -> tuple[list[str], list[float]]:
    """Return the names of the columns and the factors of their units."""
    names, factors = [], []
    for cell in line.cells(separator):
        found = HEADING.fullmatch(cell[0])
        name, unit = (found[1].lower(), found[2] or "") if found else ("", "")
        if name != SECTION and name not in units:
            raise line.problem(cell, f"no column '{name or cell[0]}'", f"{SECTION}, {', '.join(units)}")
        if name in names:
            raise line.problem(cell, f"a second column '{name}'", "one")
        factor = 1.0 if name == SECTION else factor_of(unit, units[name])
        if factor is None:
            raise line.problem(cell, f"'{name}' has the unit '{unit}'" if unit else f"'{name}' has no unit",
                               f"{name} [{'], ['.join(known or '-' for known in units[name])}]")
        names.append(name)
        factors.append(factor)
    return names, factors


def factor_of(unit: str, known: Mapping[str, float]) -> float | None:
    """Return the factor of a unit, whose letters may be small or large where only one unit is meant; None of others."""
    same = [factor for name, factor in known.items() if name.lower() == unit.lower()]
    return known.get(unit, same[0] if len(same) == 1 else None)


def row_of(line: Line, separator: str, names: Sequence[str], factors: Sequence[float]) -> dict[str, float | str]:
    """Return the cells of a row that are not blank, by column."""
    cells, row = line.cells(separator), dict[str, float | str]()
    if len(cells) > len(names):
        raise line.problem(cells[len(names)], "more cells than the heading has", f"{len(names)}")
    for cell, name, factor in zip(cells, names, factors):
        if cell[0]:
            row[name] = cell[0].replace(" ", "") if name == SECTION else line.number(cell, name, -LARGE, LARGE,
                                                                                     "a number, or nothing", factor)
    return row


def curves(file: str, name: str, over: str, rows: Sequence[Mapping[str, float | str]]) -> list[Measured]:
    """Return the curves of a column, one for each section, in the order of what they are over."""
    whole = [row for row in rows if name in row and over in row]
    sections = dict.fromkeys(str(row.get(SECTION, "")) if over in ("length0", "along") else "" for row in whole)
    found = []
    for section in sections:
        points = np.array(sorted((row[over], row[name]) for row in whole
                                 if not section or row.get(SECTION) == section), float)
        found.append(Measured(Path(file).name, name, over, section, points[:, 0], points[:, 1]))
    if not found:
        raise Problem(f"{file}: no rows with {over} and {name}")
    return found


def along_curve(measured: Measured, at: np.ndarray, values: np.ndarray, *others: tuple[np.ndarray, np.ndarray]
                ) -> Difference:
    """Return the differences from a computed curve, linear between its points, over increasing `at`; others: pieces of
    the curve elsewhere, for the points that lie beyond it."""
    computed, inside = np.zeros(len(measured.at)), np.zeros(len(measured.at), bool)
    for places, heights in ((at, values), *others):
        turn = places[0] + (measured.at - places[0] + SAME) % 360 - SAME  # of angles, in the turn that it begins with
        own = turn if measured.over == "angle" else measured.at
        new = (own >= places[0] - SAME) & (own <= places[-1] + SAME) & ~inside
        computed[new], inside = np.interp(own[new], places, heights), inside | new
    return difference(measured, inside, measured.values - computed)


def from_line(measured: Measured, *lines: np.ndarray) -> Difference:
    """Return the distances of measured points from the nearest of computed lines (n, 2); points beyond the ends
    count."""
    points = np.column_stack([measured.at, measured.values])[:, None]
    away = np.min([distances(points, line[:-1], line[1:]).min(axis=1) for line in lines], axis=0)
    return difference(measured, np.ones(len(away), bool), away)


def difference(measured: Measured, inside: np.ndarray, away: np.ndarray) -> Difference:
    """Return the differences of the points inside."""
    if not inside.any():
        raise Problem(f"{measured.file}: all points of {measured.name} lie beyond the computed curve over "
                      f"{measured.over}")
    away, at = away[inside], measured.at[inside]
    most = int(np.abs(away).argmax())
    return Difference(len(away), float(away[most]), float(at[most]), float(np.sqrt((away**2).mean())),
                      int((~inside).sum()))


def shown_unit(measured: Measured) -> tuple[str, float]:
    """Return the unit in which a curve is shown, and its size in that of the values."""
    if measured.over == "travel":
        return "kN", 1e3
    return ("%", 0.01) if measured.name == "thinning" else ("mm", 1.0)
