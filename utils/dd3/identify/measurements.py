# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured values of tests on sheets, and curves. Errors name the file, the line and the word."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from dd3.errors import Problem
from dd3.tables import read_text

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
RANGES = {"r": (0, 20, "an r-value, 0 to 20: the strain in width over the strain in thickness"),
          "stress": (0.1, 10, "a ratio, 0.1 to 10: yield stresses (MPa) are divided by the one along rolling")}
FALL = 0.95  # a curve that ends below this fraction of its largest stress is not one of true stresses


def every(parts: Sequence[Callable[[], Any]]) -> list[Any]:
    """Call all parts and return their results; if some fail, raise a Problem with the first 20 messages."""
    results: list[Any] = []
    said = []
    for part in parts:
        try:
            results.append(part())
        except Problem as problem:
            said.append(str(problem))
    if said:
        more = [f"and {len(said) - 20} more"] if len(said) > 20 else []
        raise Problem("\n".join(said[:20] + more))
    return results


@dataclass
class Line:
    """A line of a file or an argument of the command line: its place and its text."""
    where: str
    text: str

    def words(self, pattern: str) -> list[tuple[str, int]]:
        """Return its words, each with its column; a comment after # is left out."""
        return [(found.group(), found.start()) for found in re.finditer(pattern, self.text.partition("#")[0])]

    def problem(self, word: tuple[str, int], message: str, expected: str) -> Problem:
        """Return a Problem that points at a word (text and column)."""
        text, start = word
        return Problem(f"{self.where}: error: {message}\n  {self.text}\n  {' ' * start}{'^' * max(len(text), 1)}\n"
                       f"  expected: {expected}")

    def end(self) -> tuple[str, int]:
        """Return the position behind the last character."""
        return "", len(self.text.rstrip())

    def number(self, word: tuple[str, int], name: str, low: float, high: float, expected: str) -> float:
        """Return a word as a number between low and high."""
        try:
            value = float(word[0])
        except ValueError:
            raise self.problem(word, f"'{word[0]}' is not a number", expected) from None
        if not low <= value <= high:
            raise self.problem(word, f"{name} = {word[0]} is out of range", expected)
        return value


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


def datum(key: str, line: Line, words: list[tuple[str, int]]) -> Datum:
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


def lines_of(path: str) -> list[Line]:
    """Return the lines of a file. Headings may have any encoding."""
    try:
        text = read_text(path)
    except Problem as problem:
        raise Problem(str(problem).replace(": ", ": error: ", 1)) from None
    return [Line(f"{path}:{i}", line) for i, line in enumerate(text.splitlines(), 1)]


def read_data(path: str) -> list[Datum]:
    """Return the data of a file with a key and its numbers in each line."""
    lines = [(line, data_words(line)) for line in lines_of(path)]
    data = every([partial(data_line, line, words) for line, words in lines if words])
    if not data:
        raise Problem(f"{path}: error: no measured values\n  expected: lines such as: r 45 1.51")
    return data


def data_words(line: Line) -> list[tuple[str, int]]:
    """Return the words of a line; a comma inside a word is kept if blanks separate words, as a wrong decimal point."""
    others = re.search(r"\S[\s;]+\S", line.text.partition("#")[0])
    return line.words(r"[^\s;:=]*[^\s,;:=]" if others else r"[^\s,;:=]+")


def data_line(line: Line, words: list[tuple[str, int]]) -> Datum:
    """Return the datum of a line."""
    if words[0][0] not in KEYS:
        raise line.problem(words[0], f"unknown key '{words[0][0]}'", "one of: " + " ".join(KEYS))
    return datum(words[0][0], line, words[1:])


def read_curve(path: str, reversed_too: bool) -> np.ndarray:
    """Return strains and stresses of a table with two columns; lines before the first number are a header."""
    lines = [(line, words) for line in lines_of(path) if (words := line.words(r"[^\s,;]+"))]
    first = next((i for i, (_, words) in enumerate(lines) if re.match(r"[-+.\d]", words[0][0])), len(lines))
    rows = every([partial(curve_row, line, words) for line, words in lines[first:]])
    if len(rows) < 4:
        raise Problem(f"{path}: error: {len(rows)} rows\n  expected: strain and stress in four rows or more")
    check_curve(rows, reversed_too)
    return np.array([row[2:] for row in rows]).T


def curve_row(line: Line, words: list[tuple[str, int]]) -> tuple[Line, list[tuple[str, int]], float, float]:
    """Return a row of a curve: its line, its words, strain and stress."""
    if len(words) < 2:
        raise line.problem(line.end(), "a number is missing", "strain and stress")
    if len(words) > 2:
        raise line.problem(words[2], "more than two numbers",
                           "two columns, strain and stress, with a decimal point, not a comma")
    return line, words, *every([
        partial(line.number, words[0], "strain", -2, 2, "a logarithmic strain, not per cent"),
        partial(line.number, words[1], "stress", -1e4, 1e4, "a true stress in MPa")])


def check_curve(rows: list[tuple[Line, list[Any], float, float]], reversed_too: bool) -> None:
    """Check that a curve can be one of a tension test."""
    for (_, _, last, _), (line, words, strain, _) in pairwise(rows):
        if strain == last or (strain < last and not reversed_too):
            raise line.problem(words[0], f"strain = {words[0][0]} does not increase",
                               "increasing strains; reversals with --backstress only")
    for line, words, strain, stress in rows:
        if (stress < 0 or (stress == 0 and strain > 0)) and not reversed_too:
            raise line.problem(words[1], f"stress = {words[1][0]} is not positive",
                               "tension; reversals with --backstress only")
    line, words, _, most = max(rows, key=lambda row: row[3])
    if most < 5:
        raise line.problem(words[1], f"the largest stress is {words[1][0]}", "stresses in MPa")
    if rows[-1][3] < FALL * most and not reversed_too:
        raise line.problem(words[1], f"from here the stress falls to {rows[-1][1][1][0]}",
                           "true stresses up to the largest force; nominal stresses fall, and those after necking are "
                           "not usable")
