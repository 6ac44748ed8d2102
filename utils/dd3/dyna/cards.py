# SPDX-License-Identifier: GPL-3.0-or-later
"""Cards of an LS-DYNA keyword file: keywords with their rows of fields."""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from dd3.errors import Problem
from dd3.tools.facet_files import dyna_lines, fields

WIDTH, LONG = 10, 20  # columns of a field
PARAMETER = re.compile(r"(-?)&(\w+)")
# Keywords with many rows, in other columns.
MESHES = re.compile(r"\*NODE$|\*ELEMENT_(SHELL|SOLID|TSHELL)(_\w+)?$")
TITLED = ("*MAT", "*SECTION", "*DEFINE", "*SET", "*HOURGLASS")


@dataclass
class Row:
    """A line of a card."""

    place: str
    text: str
    width: int
    parameters: dict[str, float] = field(repr=False)

    def words(self, count: int = 8, width: int = 0) -> list[str]:
        """Return the fields of the line, empty ones too."""
        words = fields(self.text, [width or self.width] * count, count)
        return words + [""] * (count - len(words))

    def number(self, i: int, default: float = 0.0, width: int = 0) -> float:
        """Return the number in field i; an empty field is the default."""
        word = self.words(max(8, i + 1), width)[i]
        if not word:
            return default
        if found := PARAMETER.fullmatch(word):
            if found[2].upper() not in self.parameters:
                raise Problem(f"{self.place}: error: no *PARAMETER '{found[2]}'")
            return self.parameters[found[2].upper()] * (-1 if found[1] else 1)
        value = as_number(word)
        if value is None:
            raise Problem(f"{self.place}: error: expected a number, got '{word}'")
        return value

    def label(self, i: int) -> int:
        """Return the whole number in field i, 0 where it is empty."""
        value = self.number(i)
        if value != int(value):
            raise Problem(f"{self.place}: error: expected a whole number, got {value:g}")
        return int(value)


@dataclass
class Card:
    """A keyword and its rows; `title` where the keyword has one."""

    keyword: str
    place: str
    rows: list[Row]
    title: str = ""

    def row(self, i: int) -> Row:
        """Return a row; a Problem where the card ends before."""
        if i >= len(self.rows):
            raise Problem(f"{self.place}: error: {self.keyword} has {len(self.rows)} rows, expected {i + 1}")
        return self.rows[i]


def as_number(word: str) -> float | None:
    """Return the finite number of a word, None for none; 1.5+3 is 1500, as Fortran reads it."""
    try:
        value = float(re.sub(r"(?<=[\d.])([+-]\d+)$", r"e\1", word.replace("d", "e").replace("D", "e")))
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def read_cards(path: Path) -> Iterator[Card]:
    """Yield the cards of a deck and of the files that it includes; those of nodes and elements without their rows."""
    card, wide, parameters = None, False, dict[str, float]()
    for place, line in dyna_lines(path):
        if not line.startswith("*"):
            if card and not MESHES.match(card.keyword):
                card.rows.append(Row(place, line, WIDTH if not wide else LONG, parameters))
            continue
        if card:
            yield finished(card, parameters)
        keyword, _, tail = line.strip().upper().partition(" ")
        wide = wide or (keyword == "*KEYWORD" and "LONG=Y" in tail.replace(" ", ""))
        card = Card(keyword.rstrip("+-"), place, [])
    if card:
        yield finished(card, parameters)


def finished(card: Card, parameters: dict[str, float]) -> Card:
    """Return a card with its title taken from its rows, and without empty rows at its end; parameters are added."""
    while card.rows and not card.rows[-1].text.strip():
        card.rows.pop()
    if card.keyword.startswith("*PARAMETER") and "EXPRESSION" not in card.keyword:
        for row in card.rows:
            words = row.words()
            for name, value in zip(words[::2], words[1::2]):
                number = as_number(value)
                if name and number is not None:
                    parameters[name[1:].strip().upper()] = number
    if card.keyword.endswith("_TITLE") and card.keyword.startswith(TITLED):
        card.keyword = card.keyword.removesuffix("_TITLE")
        card.title = card.rows.pop(0).text.strip() if card.rows else ""
    options = card.keyword.split("_")
    if "ID" in options and card.rows:
        card.title = card.rows.pop(0).text[WIDTH:].strip()
    if "MPP" in options:  # settings for several processes, on one row or two
        card.rows = card.rows[2 if len(card.rows) > 1 and card.rows[1].text.startswith("&") else 1:]
    card.keyword = "_".join(word for word in options if word not in ("ID", "MPP"))
    return card
