# SPDX-License-Identifier: GPL-3.0-or-later
"""Cards of an LS-DYNA keyword file: keywords with their rows of fields, the one reader of such files.

A reader of a card names the fields of its rows (`Card.row`), and takes them from the row. What it does not take is left
out, and named by the account: a card of which nothing is taken as a whole, else each of its fields that says something.
"""
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import accumulate, pairwise
from pathlib import Path

from dd3.account import Account, Entry
from dd3.dyna.parameters import Parameters, Value, as_number, plain
from dd3.errors import Problem

STANDARD, I10, LONG = 0, 10, 20  # least width of a field
SUFFIXES = {"-": STANDARD, "%": I10, "+": LONG}
LINE = 80  # of a line in standard format: what is behind them is a comment
DEEPEST = 10  # of files that include others
TITLED = ("*MAT", "*SECTION", "*DEFINE", "*SET", "*HOURGLASS")


@cache
def columns(widths: tuple[int, ...], least: int) -> tuple[tuple[int, int], ...]:
    """Return begin and end of the fields of a row."""
    return tuple(pairwise(accumulate((0, *(max(width, least) for width in widths)))))


def split(text: str, widths: tuple[int, ...], least: int = STANDARD) -> list[str]:
    """Return the words of a line, of fixed columns, or separated by commas."""
    places = columns(widths, least)
    if "," in text[:max(LINE, places[-1][1])]:
        words = [word.strip() for word in text.split(",")]
        return words + [""] * (len(widths) - len(words))
    text = text[:max(LINE, places[-1][1])]
    words = [text[begin:end].strip() for begin, end in places]
    return words if not (rest := text[places[-1][1]:].split()) else words + rest


def says_something(word: str) -> bool:
    """Check whether a field has a value other than 0."""
    return bool(word) and as_number(word) != 0


class Row:
    """A row of a card: its fields by name. A name with a value, SF=1, gives the default of LS-DYNA: a field that has it
    says nothing."""

    __slots__ = ("entry", "names", "place", "text", "values", "words")

    def __init__(self, card: "Card", i: int, names: Sequence[str], widths: tuple[int, ...]) -> None:
        self.place, self.text, self.values = card.place_of(i), card.lines[i][1], card.values
        self.words = split(self.text, widths, card.least)
        apart = [name.partition("=") for name in names]
        self.names = [*(name for name, _, _ in apart), *(f"field {k + 1}" for k in range(len(names), len(self.words)))]
        defaults = {name: as_number(value) for name, _, value in apart if value}
        self.entry: Entry = card.account.enter(self.place, card.keyword, {
            name: word for name, word in zip(self.names, self.words)
            if says_something(word) and as_number(word) != defaults.get(name, 0.0)})
        self.entry.used = True

    def word(self, name: str) -> str:
        """Return a field as it is written."""
        self.entry.read.add(name)
        return self.words[self.names.index(name)]

    def number(self, name: str, default: float = 0.0) -> float:
        """Return the number in a field; an empty field is the default."""
        word = self.word(name)
        return float(plain(word, self.values, self.place)) if word else default

    def peek(self, name: str) -> float:
        """Return the number of a field, which stays unread."""
        before = set(self.entry.read)
        value = self.number(name)
        self.entry.read.intersection_update(before)
        return value

    def label(self, name: str, default: int = 0) -> int:
        """Return the whole number in a field."""
        value = self.number(name, default)
        if value != int(value):
            raise Problem(f"{self.place}: error: expected a whole number in {name}, got {value:g}")
        return int(value)

    def numbers(self, names: str) -> list[float]:
        """Return the numbers in fields, 0 for empty ones."""
        return [self.number(name) for name in names.split()]

    def leave(self, why: str, names: str = "") -> None:
        """Give the reason why fields, or without names all of the row, are left out."""
        self.entry.leave(why, *(names.split() or self.names))

    def use(self) -> None:
        """Count all fields as read."""
        self.entry.use()

    def drop(self, why: str) -> None:
        """Leave out the row as a whole."""
        self.entry.used = False
        self.entry.leave(why)


TEN = (10,) * 8


@dataclass
class Card:
    """A keyword and its lines, tuples of number and text; `title` where the keyword has one, `options` that were taken
    off the keyword, `least` the least width of a field, `values` the parameters."""

    keyword: str
    path: Path
    number: int
    least: int
    account: Account
    values: dict[str, Value | str] = field(default_factory=dict, repr=False)
    lines: list[tuple[int, str]] = field(default_factory=list, repr=False)
    title: str = ""
    options: frozenset[str] = frozenset()
    rows: dict[int, Row | None] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        self.entry = self.account.enter(self.place, self.keyword)

    @property
    def place(self) -> str:
        """The place of the keyword."""
        return f"{self.path}:{self.number}"

    def place_of(self, i: int) -> str:
        """Return the place of a line."""
        return f"{self.path}:{self.lines[i][0]}"

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.lines)

    def filled(self) -> list[int]:
        """Return the rows that are not empty."""
        return [i for i, (_, text) in enumerate(self.lines) if text.strip()]

    def use(self) -> None:
        """Count the card as read, but for the fields of its rows."""
        self.entry.used = True

    def ignore(self) -> None:
        """Count all of the card as read: it says nothing about mesh and process."""
        self.entry.used, self.lines = True, []

    def leave(self, why: str) -> None:
        """Give the reason why the card is left out, if it is."""
        self.entry.leave(why)

    def row(self, i: int, names: str, widths: tuple[int, ...] = TEN) -> Row:
        """Return a row with the names of its fields; a Problem where the card ends before."""
        if i >= len(self.lines):
            raise Problem(f"{self.place}: error: {self.keyword} has {len(self.lines)} rows, expected {i + 1}")
        self.use()
        row = self.rows.get(i)
        if row is None:
            row = self.rows[i] = Row(self, i, names.split(), widths)
        return row

    def optional(self, i: int, names: str) -> Row:
        """Return a row, one of defaults where the card ends before."""
        return self.row(i, names) if i < len(self.lines) else Row(Card(
            self.keyword, self.path, self.number, self.least, Account(), lines=[(self.number, "")]), 0, names.split(),
            TEN)

    def words(self, first: int, widths: tuple[int, ...] = TEN) -> Iterator[tuple[int, list[str]]]:
        """Yield the rows that are not empty from one on, as their number and words, which all count as read."""
        self.use()
        for i in self.filled():
            if i >= first:
                self.rows.setdefault(i)
                yield i, split(self.lines[i][1], widths, self.least)

    def labels(self, first: int) -> list[int]:
        """Return the labels in the rows from one on."""
        return [label for i, words in self.words(first) for word in words if (label := self.whole(i, word))]

    def first(self, i: int) -> int:
        """Return the whole number in the first field of a row, 0 where there is none."""
        return self.whole(i, self.field(i, 0)) if i < len(self.lines) else 0

    def field(self, i: int, k: int) -> str:
        """Return the word in a field of a row."""
        return split(self.lines[i][1], TEN, self.least)[k]

    def whole(self, i: int, word: str) -> int:
        """Return the whole number of a word in a row, 0 for none."""
        if word.isascii() and word.isdecimal():
            return int(word)
        value = plain(word, self.values, self.place_of(i)) if word else 0
        if value != int(value):
            raise Problem(f"{self.place_of(i)}: error: expected a whole number, got '{word}'")
        return int(value)

    def close(self) -> None:
        """Enter the rows of a card that is used which no reader has taken."""
        if self.entry.used:
            for i in self.filled():
                if i not in self.rows:
                    self.rows[i] = Row(self, i, [f"row {i + 1} field {k + 1}" for k in range(8)], TEN)


class Reader:
    """The cards of a file and of those that it includes; `close` at the end, when all that is used has been taken."""

    def __init__(self, path: Path) -> None:
        self.path, self.account, self.folders = path, Account(), [path.parent]
        self.cards: list[Card] = []
        self.parameters = Parameters()
        self.read(path, STANDARD, self.parameters, 0)

    def read(self, path: Path, least: int, parameters: Parameters, depth: int) -> None:
        """Read a file."""
        if depth > DEEPEST:
            raise Problem(f"{path}: includes nest too deeply")
        card = None
        lines = re.split(r"\r\n|\r|\n", path.read_text(encoding="utf-8", errors="replace"))
        for number, line in enumerate(lines, 1):
            if line.startswith("$"):
                continue
            if not line.startswith("*"):
                if card is not None:
                    card.lines.append((number, line))
                elif line.strip():
                    self.account.enter(f"{path}:{number}", "text before the first keyword")
                continue
            if card is not None:
                self.finish(card, parameters, depth)
            word, own, tail = keyword_of(line, least)
            if word == "*END":
                for after, rest in enumerate(lines[number:], number + 1):
                    if rest.strip() and not rest.startswith("$"):
                        self.account.enter(f"{path}:{after}", "lines behind *END").leave("nothing reads them")
                        break
                return
            if word == "*KEYWORD":
                least = own = format_of(tail, least)
            card = Card(word, path, number, own, self.account)
        if card is not None:
            self.finish(card, parameters, depth)

    def finish(self, card: Card, parameters: Parameters, depth: int) -> None:
        """Take a card whose lines are complete: its options, its parameters, the files that it includes."""
        word = card.keyword
        if word.startswith("*INCLUDE_PATH"):
            self.folders += [self.path.parent / name for _, name in file_names(card)]
            card.ignore()
        elif word == "*INCLUDE":
            for place, name in file_names(card):
                inner = Parameters(parameters)
                self.read(self.found(name, card.path, place), card.least, inner, depth + 1)
                parameters.take_back(inner)
            card.ignore()
        elif word == "*PARAMETER_DUPLICATION":
            parameters.duplication(card.optional(0, "DFLAG").label("DFLAG", 1))
        elif word.startswith("*PARAMETER"):
            define(card, parameters)
            card.ignore()
        else:
            card.values = dict(parameters.values) if any("&" in text or "<" in text for _, text in card.lines) else {}
            strip_options(card)
            self.cards.append(card)

    def found(self, name: str, beside: Path, place: str) -> Path:
        """Return the path of an included file: in the folder of the file that includes it, or those of the deck."""
        names = (name, name.replace("\\", "/"))
        for path in (folder / one for folder in (beside.parent, *self.folders) for one in names):
            try:
                if path.is_file():
                    return path
            except (OSError, ValueError):
                break
        raise Problem(f"{place}: error: no such included file: {name[:200]!r}")

    def left_out(self) -> list:
        """Return what was not used, in the order of the files."""
        for card in self.cards:
            card.close()
        order = {str(path): i for i, path in enumerate(dict.fromkeys(card.path for card in self.cards))}

        def key(entry: Entry) -> tuple[int, int]:
            path, _, number = entry.place.rpartition(":")
            return order.get(path, -1), int(number)

        self.account.entries.sort(key=key)
        return self.account.left_out()


def unread(cards: Sequence[Card]) -> str:
    """Return a text on keywords that are not read, for a message on what is missing."""
    return "".join(f"; {card.keyword} at {card.place} is not read" for card in cards[:3])


def keyword_of(line: str, least: int) -> tuple[str, int, str]:
    """Return a keyword, the least width of its fields by a suffix, and what stands behind it."""
    word, _, tail = line.rstrip().upper().partition(" ")
    tail = tail.strip()
    for suffix, width in SUFFIXES.items():
        if word.endswith(suffix) and len(word) > 1:
            return word[:-1], width, tail
        if tail == suffix:
            return word, width, ""
    return word, least, tail


def format_of(options: str, least: int) -> int:
    """Return the least width of fields by the options of *KEYWORD: LONG = Y or K, I10 = Y, LONG = S for standard."""
    options = options.replace(" ", "")
    if "LONG=Y" in options or "LONG=K" in options:
        return LONG
    if "I10=Y" in options:
        return I10
    return STANDARD if "LONG=S" in options or "I10=N" in options else least


def file_names(card: Card) -> list[tuple[str, str]]:
    """Return the file names in a card, with their places; one that ends with ' +' goes on in the next line."""
    found, begun = [], ""
    for i in card.filled():
        text = card.lines[i][1].strip()
        if text.endswith(" +"):
            begun += text[:-2].rstrip()
            continue
        found.append((card.place_of(i), begun + text))
        begun = ""
    return found + ([(card.place, begun)] if begun else [])


def define(card: Card, parameters: Parameters) -> None:
    """Take the parameters of a card; an expression goes on where the name is missing."""
    if "EXPRESSION" not in card.keyword:
        for i in card.filled():
            words = split(card.lines[i][1], TEN, card.least)
            for name, value in zip(words[::2], words[1::2]):
                if name:
                    parameters.define(card.place_of(i), card.keyword, name, value)
        return
    width = max(10, card.least)
    begun: list[tuple[str, str, str]] = []
    for i in card.filled():
        text = card.lines[i][1]
        name, rest = text[:width], text[width:]
        if apart := re.match(r"\s*([RIC]\s*\w+)\s*,(.*)", text, re.IGNORECASE):
            name, rest = apart.groups()
        if name.strip() or not begun:
            begun.append((card.place_of(i), name.strip(), rest))
        else:
            begun[-1] = (*begun[-1][:2], begun[-1][2] + rest.strip())
    for place, name, text in begun:
        parameters.define(place, card.keyword, name, text.strip())


def strip_options(card: Card) -> None:
    """Take title and identifier of a card from its rows, and the options that tell of them from its keyword; empty rows
    at its end."""
    while card.lines and not card.lines[-1][1].strip():
        card.lines.pop()
    words = card.keyword.split("_")
    taken = {"ID", "TITLE", "MPP"} & set(words[1:])
    if card.keyword.startswith(TITLED) and words[-1] == "TITLE":
        card.title = card.lines.pop(0)[1].strip() if card.lines else ""
        taken -= {"ID"}
    elif card.keyword.startswith(TITLED) or card.keyword.startswith("*DATABASE"):
        return
    elif taken & {"ID", "TITLE"} and card.lines:
        card.title = card.lines.pop(0)[1][10:].strip()
    if "MPP" in taken:  # settings for several processes, on one row or two
        card.lines = card.lines[2 if len(card.lines) > 1 and card.lines[1][1].startswith("&") else 1:]
    card.options = frozenset(taken)
    card.keyword = "_".join([words[0], *(word for word in words[1:] if word not in taken)])
    card.entry.name = card.keyword
