# SPDX-License-Identifier: GPL-3.0-or-later
"""Keyword blocks of an .inp file: keyword, parameters and data lines, each with its place, entered in an account.

Source of the rules: Abaqus Analysis User's Guide, "Input syntax rules". Blanks and the case of keywords, parameters and
names do not count; a keyword line that ends with a comma goes on in the next line.
"""
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NoReturn

from dd3.account import Account, Entry
from dd3.errors import Problem

MOST_INCLUDES = 10  # that lie in one another
LARGEST_LABEL = 999_999_999
NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][+-]?\d+)?$", re.ASCII)
COMMA = re.compile(r""",(?=(?:[^"]*"[^"]*")*[^"]*$)""")  # outside quotes


def refuse(place: str, message: str) -> NoReturn:
    """End the reading with an error at a place."""
    raise Problem(f"{place}: error: {message}")


@dataclass
class Row:
    """A data line; `goes_on`: whether it ends with a comma."""

    place: str
    words: list[str]
    goes_on: bool

    def filled(self) -> bool:
        """Check whether it has a value."""
        return any(self.words)


@dataclass
class Block:
    """A keyword, in upper case without blanks, with its parameters and data lines."""

    place: str
    keyword: str
    shown: str
    entry: Entry
    account: Account
    rows: list[Row] = field(default_factory=list)
    rows_used: bool = False

    def option(self, name: str, default: str = "") -> str:
        """Return the value of a parameter as a name."""
        return name_of(str(self.entry.take(name, default)))

    def has(self, name: str) -> bool:
        """Check whether a parameter is given."""
        return name in self.entry.fields

    def flag(self, name: str) -> bool:
        """Check whether a parameter is given, which counts as read."""
        return self.entry.take(name) is not None

    def need(self, name: str) -> str:
        """Return the value of a parameter that must be given."""
        value = self.option(name)
        return value if value else refuse(self.place, f"{self.shown} without {name}=")

    def data(self, blank: bool = False) -> list[Row]:
        """Return the data lines, which count as read; without empty ones, unless these say something."""
        self.rows_used = True
        return [row for row in self.rows if blank or row.filled()]

    def words(self, row: Row, most: int) -> list[str]:
        """Return the words of a line, filled up by empty ones; further ones are left out."""
        if any(row.words[most:]):
            self.account.enter(row.place, f"{self.shown}, values after the first {most} of a line")
        return (row.words + [""] * most)[:most]

    def numbers(self, row: Row, most: int) -> list[float]:
        """Return the numbers of a line, 0 for empty ones."""
        return [real(word, row.place, self.shown) for word in self.words(row, most)]

    def all_read(self) -> None:
        """End the reading if a parameter of the block is not read that may change the mesh."""
        for item in self.entry.left_out():
            refuse(self.place, f"{item.name}: this parameter is not read, and the mesh may depend on it")

    def close(self) -> None:
        """Enter the data lines that were not read."""
        if self.entry.used and not self.rows_used and any(row.filled() for row in self.rows):
            first = next(row for row in self.rows if row.filled())
            self.account.enter(first.place, f"data lines of {self.shown}")


def name_of(text: str) -> str:
    """Return a name as it is compared: in lower case, without quotes."""
    return text.strip().strip('"').strip().lower()


def real(word: str, place: str, what: str) -> float:
    """Return a number, also with an exponent of D; 0 for an empty word."""
    if not word:
        return 0.0
    value = float(re.sub("[dD]", "e", word)) if NUMBER.match(word) else float("inf")
    return value if abs(value) < 1e30 else refuse(place, f"{what}: expected a number, got '{word}'" + parameter(word))


def whole(word: str, place: str, what: str) -> int:
    """Return an integer."""
    if word.isascii() and word.isdecimal() and len(word) < 10:
        return int(word)
    value = real(word, place, what) if word else 0.5
    if value != int(value) or abs(value) > LARGEST_LABEL:
        refuse(place, f"{what}: expected an integer, got '{word}'" + parameter(word))
    return int(value)


def label(word: str, place: str, what: str) -> int:
    """Return the label of a node or an element."""
    value = whole(word, place, what)
    return value if value > 0 else refuse(place, f"{what}: expected a label from 1 to {LARGEST_LABEL}, got '{word}'")


def parameter(word: str) -> str:
    """Return the end of a message on a word that stands for a parameter."""
    return "; *PARAMETER is not read" if word.startswith("<") else ""


def lines(path: Path, depth: int = 0) -> Iterator[tuple[str, str]]:
    """Yield the lines of a file as (place, text) without comments, with those of the files that it includes."""
    texts = path.read_text(encoding="utf-8-sig", errors="replace").splitlines()
    number = 0
    while number < len(texts):
        place, text = f"{path}:{number + 1}", texts[number].strip()
        number += 1
        if text.startswith("**"):
            continue
        while text.startswith("*") and text.endswith(",") and number < len(texts) and continues(texts[number]):
            text += texts[number].strip()
            number += 1
        if text.startswith("*") and re.sub(r"\s", "", text.partition(",")[0]).upper() == "*INCLUDE":
            yield from lines(included(path, place, text, depth), depth + 1)
        else:
            yield place, text


def continues(text: str) -> bool:
    """Check whether a line continues the keyword line above, which ends with a comma: it has parameters, not data."""
    return re.match(r"\s*[A-Za-z][\w ]*(=|,|$)", text) is not None


def included(path: Path, place: str, text: str, depth: int) -> Path:
    """Return the file of a line *INCLUDE, beside the file that names it or in the working directory."""
    found = re.search(r"INPUT\s*=\s*(.+)", text, re.IGNORECASE)
    if not found:
        refuse(place, "*INCLUDE without INPUT=")
    return beside(path, place, found[1], depth)


def beside(path: Path, place: str, name: str, depth: int = 0) -> Path:
    """Return a file that another one names."""
    name = name.strip().strip('"').strip()
    if depth >= MOST_INCLUDES:
        refuse(place, "files include one another too deeply")
    try:
        for other in (path.parent / name, Path(name)):
            if other.is_file():
                return other
    except (OSError, ValueError):  # a name that no file can have
        pass
    return refuse(place, f"there is no file '{name}'")


def blocks(path: Path, account: Account) -> Iterator[Block]:
    """Yield the blocks of a file, each entered in the account."""
    block: Block | None = None
    for place, text in lines(path):
        if not text.startswith("*"):
            row = Row(place, [word.strip() for word in split(text.removesuffix(","))], text.endswith(","))
            if block:
                block.rows.append(row)
            elif row.filled():
                account.enter(place, "data line").leave("no keyword stands above it")
            continue
        if block:
            yield block
            block.close()
        block = new_block(path, place, text, account)
    if block:
        yield block
        block.close()


def split(text: str) -> list[str]:
    """Split a line at its commas."""
    return COMMA.split(text) if '"' in text else text.split(",")


def new_block(path: Path, place: str, text: str, account: Account) -> Block:
    """Return the block of a keyword line. A file of its data lines, INPUT=, is read."""
    first, *others = split(text)
    shown = "*" + " ".join(first[1:].upper().split())
    options: dict[object, str] = {}
    for word in others:
        name, equals, value = word.partition("=")
        name = re.sub(r"\s", "", name).upper()
        if name in options:
            refuse(place, f"{shown}: {name} is given twice")
        if name:
            options[name] = value.strip() if equals else ""
    block = Block(place, re.sub(r"\s", "", first[1:]).upper(), shown, account.enter(place, shown, options), account)
    if block.keyword in ("NODE", "ELEMENT") and block.has("INPUT"):
        source = beside(path, place, str(block.entry.take("INPUT")))
        for where, line in lines(source):
            if line.startswith("*"):
                refuse(where, f"a keyword among the data lines of {shown} at {place}")
            block.rows.append(Row(where, [word.strip() for word in split(line.removesuffix(","))], line.endswith(",")))
    return block
