# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured values of tests on sheets, and curves. Errors name the file, the line and the word."""

import re
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from dd3.account import Account
from dd3.columns import NUMBER, STRAIN, STRESS, Column, Line, Row, Word, every, lines_of, read_columns
from dd3.errors import LOG, Problem

TENSION, EQUIBIAXIAL = "e11 s22 s33 s12 s23 s13", "s11 s22 e33 s12 s23 s13"
PLANE = "e11 e22 s33 s12 s23 s13"
# Key: kind of test, quantity, default weight, whether it has an angle.
KEYS = {
    "r": ("tension", "r", 0.5, True), "stress": ("tension", "stress", 1, True),
    "compression": ("compression", "stress", 1, True), "plane_strain": ("plane strain", "stress", 1, True),
    "biaxial_stress": ("equibiaxial", "stress", 1, False), "biaxial_r": ("equibiaxial", "r", 0.5, False),
    "biaxial_compression": ("equibiaxial compression", "stress", 1, False),
}
# Quantity: lowest and highest value, meaning.
RANGES = {"r": (0, 20, "an r-value, 0 to 20, not per cent: the strain in width over the strain in thickness"),
          "stress": (0.1, 10, "a ratio, 0.1 to 10: yield stresses (MPa) are divided by the one along rolling")}
# Columns of a tension curve.
CURVE = (Column("strain", re.compile(r"strain|dehnung|umformgrad|eps|ε|φ", re.IGNORECASE), STRAIN, -2, 2,
                "a logarithmic strain, not per cent"),
         Column("stress", re.compile(r"stress|spannung|sigma|σ", re.IGNORECASE), STRESS, -1e4, 1e4,
                "a true stress in MPa"))
FALL = 0.95  # a curve that ends below this fraction of its largest stress is not one of true stresses


class Datum:
    """A measured value: kind of test, angle, quantity, value, weight. Without a value it is only computed."""

    def __init__(self, key: str, angle: float = 0.0, value: float | None = None, weight: float | None = None) -> None:
        self.kind, self.quantity, usual, self.angled = KEYS[key]
        self.value: Any = value
        self.angle, self.weight = angle, usual if weight is None else weight

    def label(self) -> str:
        """Return its name in the table."""
        return f"{self.kind}{f' {self.angle:g}' if self.angled else ''}, {self.quantity}"

    def same_test(self) -> tuple[str, float]:
        """Return the identity of the test: kind and angle."""
        return self.kind, self.angle

    def path(self) -> tuple[str, float, list[list[float]]]:
        """Return control, angle and targets; equibiaxial tension is compression in thickness plus pressure."""
        sign = -1 if self.kind in ("compression", "equibiaxial") else 1
        place = 2 if self.kind.startswith("equibiaxial") else 0
        control = EQUIBIAXIAL if place else PLANE if self.kind == "plane strain" else TENSION
        strains = (0.01, 0.02, 0.03, 0.04, 0.041) if self.kind == "plane strain" else (0.01, 0.011)
        return control, self.angle, [[sign * strain if i == place else 0.0 for i in range(6)] for strain in strains]

    def computed(self, rows: list[dict[str, float]]) -> float:
        """Return its value from the rows of its path; the strain between the last two is plastic."""
        through = self.kind.startswith("equibiaxial")
        if self.quantity == "stress":
            return abs(rows[-1]["s33" if through else "s11"]) / rows[-1]["flow_stress"]
        width, other = (rows[-1][key] - rows[-2][key] for key in ("e22", "e11" if through else "e33"))
        return width / other


def datum(key: str, line: Line, words: list[Word]) -> Datum:
    """Return the datum of the words of its values."""
    _, quantity, _, angled = KEYS[key]
    expected = f"{'angle, ' if angled else ''}value and, if wanted, weight; {RANGES[quantity][2]}"
    least = 2 if angled else 1
    if not least <= len(words) <= least + 1:
        place = line.end() if len(words) < least else words[-1]
        raise line.problem(place, f"{key} has too {'few' if len(words) < least else 'many'} numbers", expected)
    low, high, meant = RANGES[quantity]
    angle = ("angle", 0, 90, "an angle to the rolling direction, 0 to 90 degrees")
    asked: list[tuple[str, float, float, str]] = [*[angle] * angled, (quantity, low, high, meant),
                                                  ("weight", 0, 1e6, "a weight, 0 or more")]
    values = every([partial(line.number, word, *one) for word, one in zip(words, asked)])
    return Datum(key, *([0.0] * (not angled) + values))


def from_argument(key: str, text: str) -> list[Datum]:
    """Return the datum of an argument of the command line: angle:value:weight."""
    line = Line(f"--{key.replace('_', '-')}", text)
    return [datum(key, line, line.words(r"[^:]+"))]


def check_law(option: str, text: str) -> None:
    """Check that the r-values of a yield criterion given as r0=1.79 are no per cents."""
    line = Line(option, text)
    low, high, meant = RANGES["r"]
    for found in re.finditer(r"\br(?:0|45|90)\s*=\s*([^\s,]+)", text):
        if NUMBER.fullmatch(found[1]):  # else the program says what is wrong
            line.number((found[1], found.start(1)), "r", low, high, meant)


def read_data(path: str) -> list[Datum]:
    """Return the data of a file with a key and its numbers in each line."""
    data = [one for one in every([partial(data_line, line) for line in lines_of(path)]) if one]
    if not data:
        raise Problem(f"{path}: error: no measured values\n  expected: lines such as: r 45 1.51")
    return data


def data_words(line: Line) -> list[Word]:
    """Return the words of a line; a comma inside a word is kept if blanks separate words, as a wrong decimal point.
    Between semicolons, tabs and quotes, a comma is a decimal one."""
    text = line.text.partition("#")[0]
    for mark, separator in ((";", ";"), ("\t", " "), ('"', ",")):
        if mark in text.strip():
            return [word for word in line.cells(separator) if word[0]]
    others = re.search(r"\S\s+\S", text)
    words = line.words(r"[^\s:=]*[^\s,:=]" if others else r"[^\s,:=]+")
    for word in words:
        if "," in word[0]:
            raise line.problem(word, f"'{word[0]}' is not a number",
                               "a decimal point, or semicolons between numbers with a decimal comma")
    return words


def data_line(line: Line) -> Datum | None:
    """Return the datum of a line, None of a blank one."""
    words = data_words(line)
    if not words:
        return None
    if words[0][0] not in KEYS:
        raise line.problem(words[0], f"unknown key '{words[0][0]}'", "one of: " + " ".join(KEYS))
    return datum(words[0][0], line, words[1:])


def read_curve(path: str, reversed_too: bool) -> np.ndarray:
    """Return strains and stresses of a table; say what of it is not used."""
    account = Account()
    rows = read_columns(path, CURVE, account)
    if len(rows) < 4:
        raise Problem(f"{path}: error: {len(rows)} rows{'' if rows else ': none begins with a number'}\n"
                      "  expected: strain and stress in four rows or more")
    check_curve(rows, reversed_too)
    for item in account.left_out():
        LOG.info(f"left out: {item}")
    return np.array([row.values for row in rows]).T


def check_curve(rows: list[Row], reversed_too: bool) -> None:
    """Check that a curve can be one of a tension test."""
    for (_, _, (last, _)), (line, words, (strain, _)) in pairwise(rows):
        if strain == last or (strain < last and not reversed_too):
            raise line.problem(words[0], f"strain = {words[0][0]} does not increase",
                               "increasing strains; reversals with --backstress only")
    for line, words, (strain, stress) in rows:
        if (stress < 0 or (stress == 0 and strain > 0)) and not reversed_too:
            raise line.problem(words[1], f"stress = {words[1][0]} is not positive",
                               "tension; reversals with --backstress only")
    line, words, (_, most) = max(rows, key=lambda row: row.values[1])
    if most < 5:
        raise line.problem(words[1], f"the largest stress is {words[1][0]}", "stresses in MPa")
    if rows[-1].values[1] < FALL * most and not reversed_too:
        raise line.problem(words[1], f"from here the stress falls to {rows[-1].words[1][0]}",
                           "true stresses up to the largest force; nominal stresses fall, and those after necking are "
                           "not usable")
