# SPDX-License-Identifier: GPL-3.0-or-later
"""Columns of numbers in measured tables, as test machines, spreadsheets and hand write them.

Cells are separated by semicolons, tabs, commas or blanks and may be quoted; the decimal sign is a point, or a comma
where no comma separates. Text above the first row of numbers is a heading: it may name the columns wanted, in any
order, and their units, in brackets or in a row of their own. Columns and rows that are not used are accounted for.
"""
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from dd3.account import Account
from dd3.errors import Problem
from dd3.tables import read_text

Word = tuple[str, int]  # text and column
NUMBER = re.compile(r"[-+]?(?:\d+[.,]?\d*|[.,]\d+)(?:[eEdD][-+]?\d+)?")
KIND = re.compile(r"true|log|plast|total|wahr", re.IGNORECASE)  # in brackets, but no unit
NOT_TRUE = re.compile(r"\b(?:eng|engineering|nominal|technical|techn|technische)\b", re.IGNORECASE)
STRAIN = {"": 1.0, "-": 1.0, "1": 1.0, "mm/mm": 1.0, "m/m": 1.0, "in/in": 1.0, "%": 0.01, "percent": 0.01,
          "per cent": 0.01}
STRESS = {"": 1.0, "mpa": 1.0, "n/mm2": 1.0, "n/mm^2": 1.0, "n/mm²": 1.0, "gpa": 1e3, "kn/mm2": 1e3, "kn/mm²": 1e3,
          "kpa": 1e-3, "pa": 1e-6, "n/m2": 1e-6, "ksi": 6.894757, "psi": 6.894757e-3}


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

    def words(self, pattern: str) -> list[Word]:
        """Return its words, each with its column; a comment after # is left out."""
        return [(found.group(), found.start()) for found in re.finditer(pattern, self.text.partition("#")[0])]

    def cells(self, separator: str) -> list[Word]:
        """Return its cells without quotes, each with its column; a comment after # is left out. `separator`: one
        character, or a blank for any number of blanks and tabs."""
        text, found, place = self.text.partition("#")[0].rstrip(), list[Word](), 0
        if separator == " ":
            return [(unquoted(word), start) for word, start in self.words(r"\"[^\"]*\"|'[^']*'|[^\s\"']+")]
        pattern = re.compile(rf"""[^\S\t]*("(?:[^"]|"")*"|'[^']*'|[^{separator}]*?)\s*(?:{separator}|$)""")
        while place < len(text):
            cell = pattern.match(text, place)
            if not cell:
                raise self.problem((text[place:], place), "a quote that is not closed, or text beside quotes",
                                   "quotes around whole cells")
            found.append((unquoted(cell[1].strip()), cell.start(1)))
            place = max(cell.end(), place + 1)
        return found

    def problem(self, word: Word, message: str, expected: str) -> Problem:
        """Return a Problem that points at a word (text and column)."""
        text, start = word
        return Problem(f"{self.where}: error: {message}\n  {self.text}\n  {' ' * start}{'^' * max(len(text), 1)}\n"
                       f"  expected: {expected}")

    def end(self) -> Word:
        """Return the position behind the last character."""
        return "", len(self.text.rstrip())

    def number(self, word: Word, name: str, low: float, high: float, expected: str, factor: float = 1.0) -> float:
        """Return a word times a factor as a number between low and high; a decimal comma is read as well."""
        if not NUMBER.fullmatch(word[0]):
            raise self.problem(word, f"'{word[0]}' is not a number", expected)
        value = factor * float(re.sub("[dD]", "e", word[0].replace(",", ".")))
        if not low <= value <= high:
            raise self.problem(word, f"{name} = {word[0]} is out of range", expected)
        return value


def unquoted(text: str) -> str:
    """Return a text without the quotes around it."""
    return text[1:-1].strip() if len(text) > 1 and text[0] in "\"'" and text[-1] == text[0] else text


def lines_of(path: str | Path) -> list[Line]:
    """Return the lines of a file. Headings may have any encoding."""
    try:
        text = read_text(path)
    except Problem as problem:
        raise Problem(str(problem).replace(": ", ": error: ", 1)) from None
    return [Line(f"{path}:{i}", line) for i, line in enumerate(text.splitlines(), 1)]


@dataclass
class Column:
    """What a column of a table holds: its name in messages, the pattern of its heading, the factors of the units that
    its heading may have, its bounds, and what is expected."""

    name: str
    heading: re.Pattern[str]
    units: dict[str, float]
    low: float
    high: float
    expected: str
    nominal: bool = False  # engineering values are meant


class Row(NamedTuple):
    """A row of a table: its line, the words and the values of the columns wanted."""

    line: Line
    words: list[Word]
    values: list[float]


def read_columns(path: str | Path, columns: Sequence[Column], account: Account) -> list[Row]:
    """Return the rows of a table with the columns wanted, found by their headings or, where these do not name them,
    the only ones."""
    lines = lines_of(path)
    separator = separator_of(lines)
    both = [(line, row) for line in lines for row in [line.cells(separator if separator in line.text else " ")]
            if any(text for text, _ in row)]
    lines, cells = [line for line, _ in both], [row for _, row in both]
    if separator == " ":
        cells = with_headings(lines, cells)
    names, places = named(lines, cells, columns)
    first = next((i for i in range(names + 1, len(lines)) if is_data(cells[i], places)), len(lines))
    if first == len(lines):
        below = next((row for row in cells[names + 1:] if is_data(row, ())), None)
        if names >= 0 and below:
            raise lines[names].problem(
                cells[names][places[0]], f"no row has numbers in the columns named: {len(cells[names])} names, "
                f"{len(below)} cells in a row", "a name for each column; one with blanks in quotes")
        return []
    if not places:
        places = filled(lines[first:], cells[first:], columns, separator)
    account_for(lines, cells, first, names, places, account)
    factors = [factor_of(lines[:first], cells[:first], place, column, account)
               for place, column in zip(places, columns)]
    rows = every([lambda i=i: row_of(lines[i], cells[i], places, columns, factors)  # type: ignore[misc]
                  for i in range(first, len(lines))])
    check_signs(rows)
    return rows


def separator_of(lines: Sequence[Line]) -> str:
    """Return the separator of the rows of numbers."""
    texts = [line.text.partition("#")[0] for line in lines]
    rows = [text for text in texts if re.match(r"[\s;,]*[\"']?[-+.,]?\d", text)] or [
        text for text in texts if re.search(r"[\s;,\"'][-+.,]?\d", text)]
    bare = [re.sub(r"\"[^\"]*\"|'[^']*'", "q", text.strip()) for text in rows]
    if 2 * sum(";" in text for text in bare) > len(bare):
        return ";"
    if bare and all("\t" in text for text in bare) and not any(re.search(r",\s*\t|\t\s*,", text) for text in bare):
        return "\t"
    if not any("," in text for text in bare):
        return " "
    # A decimal comma: blanks separate words, and a comma stands in numbers without a point only.
    words = [word for text in bare for word in text.split()]
    decimal = all(len(text.split()) > 1 for text in bare) and all(
        NUMBER.fullmatch(word) and "." not in word for word in words)
    return " " if decimal else ","


def with_headings(lines: Sequence[Line], cells: Sequence[list[Word]]) -> list[list[Word]]:
    """Return the cells of columns apart by blanks; those of a heading may hold single blanks where two or more, or
    tabs, separate as many cells as a row of numbers has."""
    count = next((len(row) for row in cells if is_data(row, ())), 0)
    wide = [line.words(r"[^\s\"']+(?: [^\s\"']+)*") for line in lines]
    return [others if len(row) != count == len(others) and not is_data(row, ()) else row
            for row, others in zip(cells, wide)]


def is_data(cells: Sequence[Word], places: Sequence[int]) -> bool:
    """Tell whether a row is one of numbers: those at the places, or the first cell with a text."""
    if places:
        return all(place < len(cells) and NUMBER.fullmatch(cells[place][0]) for place in places)
    first = next((text for text, _ in cells if text), "")
    return NUMBER.fullmatch(first) is not None


def named(lines: Sequence[Line], cells: Sequence[list[Word]], columns: Sequence[Column]) -> tuple[int, list[int]]:
    """Return the row that names the columns, and their places; -1 and none if no row does."""
    for i, row in enumerate(cells):
        if is_data(row, ()):
            break
        found = [[k for k, (text, _) in enumerate(row) if column.heading.search(text)] for column in columns]
        if not all(found):
            continue
        true = [[k for k in places if column.nominal or not NOT_TRUE.search(row[k][0])]
                for places, column in zip(found, columns)]
        for places, column, good in zip(found, columns, true):
            if not good:
                raise lines[i].problem(row[places[0]], f"the {column.name} is an engineering one", column.expected)
            if len(good) > 1:
                raise lines[i].problem(row[good[1]], f"a second column for the {column.name}", "one, the others "
                                       "under other headings")
        if len({places[0] for places in true}) == len(columns):
            return i, [places[0] for places in true]
    return -1, []


def filled(lines: Sequence[Line], cells: Sequence[list[Word]], columns: Sequence[Column], separator: str) -> list[int]:
    """Return the places of the columns that are not blank, which must be as many as wanted."""
    places = sorted({k for row in cells for k, (text, _) in enumerate(row) if text})
    if len(places) > len(columns):
        count = {2: "two"}.get(len(columns), str(len(columns)))
        names = " and ".join(column.name for column in columns)
        line, row = next((line, row) for line, row in zip(lines, cells) if len(row) > places[len(columns)])
        comma = ", with a decimal point, or decimal commas in quotes or between semicolons" if separator == "," else ""
        raise line.problem(row[places[len(columns)]], f"more than {count} numbers",
                           f"{count} columns, {names}, or a heading that names them{comma}")
    return [*places, *range(places[-1] + 1, places[-1] + 1 + len(columns) - len(places))]


def account_for(lines: Sequence[Line], cells: Sequence[list[Word]], first: int, names: int, places: Sequence[int],
                account: Account) -> None:
    """Enter the rows above the numbers and the columns, of which the others than those wanted are left out."""
    for i in range(first):
        heading = names < i or (names < 0 and i >= first - 2)
        if i != names and not (heading and not any(NUMBER.fullmatch(text) for text, _ in cells[i])):
            text = " ".join(text for text, _ in cells[i] if text)
            account.enter(lines[i].where, f"row '{text[:60]}'").leave("above the first row of numbers")
    for k in sorted({k for row in cells[first:] for k, (text, _) in enumerate(row) if text} - set(places)):
        text = cells[names][k][0] if names >= 0 and k < len(cells[names]) else ""
        account.enter(lines[max(names, 0)].where, f"column {k + 1}" + (f" '{text}'" if text else "")
                      ).leave("other columns are taken")


def factor_of(lines: Sequence[Line], cells: Sequence[list[Word]], place: int, column: Column, account: Account
              ) -> float:
    """Return the factor of the unit that the heading of a column gives."""
    for line, row in zip(reversed(lines), reversed(cells)):
        text = row[place][0] if place < len(row) else ""
        bracket = re.search(r"[\[(<]\s*([^\])>]*?)\s*[\])>]\s*$", text)
        parts = [bracket[1]] if bracket else [text, text.split()[-1] if text.split() else "", text.partition("/")[2]]
        for unit in parts:
            if unit and unit.lower() in column.units:
                return column.units[unit.lower()]
        if bracket and not KIND.search(bracket[1]):
            account.enter(line.where, f"unit '{bracket[1]}' of the {column.name}").leave(
                "not one that is read: the numbers are taken as they are")
    return 1.0


def row_of(line: Line, cells: Sequence[Word], places: Sequence[int], columns: Sequence[Column],
           factors: Sequence[float]) -> Row:
    """Return a row of numbers."""
    words = [cells[place] if place < len(cells) and cells[place][0] else None for place in places]
    if not all(words):
        raise line.problem(line.end(), "a number is missing", " and ".join(column.name for column in columns))
    given = [word for word in words if word]
    return Row(line, given, every([
        lambda word=word, column=column, factor=factor: line.number(  # type: ignore[misc]
            word, column.name, column.low, column.high, column.expected, factor)
        for word, column, factor in zip(given, columns, factors)]))


def check_signs(rows: Sequence[Row]) -> None:
    """Check that the numbers have one decimal sign: beside a point, a comma separates thousands."""
    words = [(row.line, word) for row in rows for word in row.words]
    if any("." in word[0] for _, word in words):
        for line, word in words:
            if "," in word[0]:
                raise line.problem(word, f"'{word[0]}' has a comma, and other numbers a decimal point",
                                   "one decimal sign, and no separators of thousands")
