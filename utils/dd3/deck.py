# SPDX-License-Identifier: GPL-3.0-or-later
"""Input files of dd3imp: read, change, write. Comments and the form of lines that are not changed are kept.

    from dd3 import deck

    job = deck.read("rail.dat")
    job["MATERIAL"]["young"] = 2.1e5
    job["PHASE", "draw"]["move"] = "punch 0 0 -30"
    job.write("stiffer.dat")
"""

import re
from collections.abc import Iterator, MutableMapping
from pathlib import Path
from typing import Any

import numpy as np

from dd3.errors import Problem

INDENT = "  "
# Words as the program takes them: a quote is one at the beginning of a word.
WORDS = re.compile(r"""(?:[\s=]|"[^"]*"|'[^']*'|[^\s=#!"'][^\s=#!]*)*""")
LINE = re.compile(r"[^\r\n]*(?:\r\n|\r|\n)|[^\r\n]+")
HEAD_WORD = re.compile(r"""("[^"]*"|'[^']*')|([^\s=]+|=)""")
WORD = re.compile(r"""["']([^"']*)["']|([^\s"'=]+)""")


def text_of(value: Any) -> str:
    """Return a value as the input writes it: numbers, on and off, several values apart by blanks."""
    if isinstance(value, bool | np.bool_):
        return "on" if value else "off"
    if isinstance(value, float | np.floating):
        return f"{float(value):.12g}"
    if isinstance(value, Path):
        return f'"{value}"'
    if isinstance(value, list | tuple | np.ndarray):
        return " ".join(map(text_of, value))
    return str(value)


def before_comment(text: str) -> str:
    """Return a line up to its comment; a mark of one inside quotes is none."""
    words = WORDS.match(text)
    end = words.end() if words else 0
    return text[:end] if text[end:end + 1] in ("", "#", "!") else re.split("[#!]", text, maxsplit=1)[0]


class Statement:
    """A statement of a file: its lines, more than one where it is continued, and the number of the first, from 1.
    of_title: whether it is a line of *TITLE, in which quotes and signs of continuation are characters as others."""

    def __init__(self, lines: list[str], number: int, of_title: bool = False) -> None:
        self.lines, self.number, self.of_title = lines, number, of_title

    def text(self) -> str:
        """Return the statement without comments and signs of continuation."""
        if self.of_title:
            return re.split("[#!]", self.lines[0], maxsplit=1)[0].replace("\t", " ").strip()
        return " ".join(before_comment(line).strip().removesuffix("&").strip() for line in self.lines).strip()

    def change(self, value: str) -> None:
        """Put another value behind the equals sign; key, indentation and comment of the first line stay."""
        head, _, rest = self.lines[0].partition("=")
        place = len(before_comment(rest))
        old, comment = rest[:place].rstrip(), rest[place:].strip()
        new = " " * (len(old) - len(old.lstrip())) + value
        if comment:  # in its column, if there is room
            comment = " " * max(1, place - len(new)) + comment
        self.lines = [f"{head}={new}{comment}" + self.lines[0][len(self.lines[0].rstrip("\r\n")):]]


class Block(MutableMapping[str, str]):
    """A keyword block: its values as texts by their keys, which are not case sensitive. An assignment takes a text, a
    number, a bool, or several of them; a key that a block has several times takes a list of texts by `set_all`."""

    def __init__(self, deck: "Deck", head: Statement) -> None:
        self.deck, self.head, self.statements = deck, head, list[Statement]()
        keyword, *name = words_of_head(head.text())
        self.keyword, self.name = keyword[1:], " ".join(name)

    def __eq__(self, other: object) -> bool:  # blocks of the same values are not the same block
        return self is other

    __hash__ = object.__hash__

    def __repr__(self) -> str:
        return f"<block *{self.keyword} {self.name} of {self.deck.where(self.head)}>".replace(" >", ">")

    def at(self, key: str) -> list[Statement]:
        """Return the statements of a key."""
        return [one for one in self.statements
                if "=" in one.text() and one.text().partition("=")[0].strip().lower() == key.lower()]

    def all(self, key: str) -> list[str]:
        """Return all values of a key that may be given several times, such as `move`."""
        return [one.text().partition("=")[2].strip() for one in self.at(key)]

    def __getitem__(self, key: str) -> str:
        found = self.all(key)
        if len(found) != 1:
            there = ", ".join(dict.fromkeys(self)) or "none"
            raise Missing(f"{self.deck.where(self.head)}: error: " + (
                f"{len(found)} values of '{key}' in *{self.keyword}; take all('{key}')" if found else
                f"no key '{key}' in *{self.keyword} {self.name}".rstrip() + f"; there are: {there}"))
        return found[0]

    def __setitem__(self, key: str, value: Any) -> None:
        found = self.at(key)
        if len(found) > 1:
            raise Problem(f"{self.deck.where(found[1])}: error: '{key}' is given {len(found)} times in "
                          f"*{self.keyword}; take set_all")
        self.set_all(key, [value])

    def set_all(self, key: str, values: list[Any]) -> None:
        """Give a key these values, one line each, in place of those that it has."""
        found = self.at(key)
        for statement, value in zip(found, values):
            statement.change(text_of(value))
        for statement in found[len(values):]:
            self.statements.remove(statement)
        for value in values[len(found):]:
            self.statements.insert(self.end(), Statement([f"{INDENT}{key} = {text_of(value)}\n"], 0))
        self.deck.changed = True

    def end(self) -> int:
        """Return the place behind the last statement: empty lines and comments below it belong to the next block."""
        return max((i + 1 for i, one in enumerate(self.statements) if one.text()), default=0)

    def __delitem__(self, key: str) -> None:
        if not self.at(key):
            raise Missing(f"{self.deck.where(self.head)}: error: no key '{key}' in *{self.keyword}")
        self.set_all(key, [])

    def __iter__(self) -> Iterator[str]:
        return iter(dict.fromkeys(one.text().partition("=")[0].strip().lower()
                                  for one in self.statements if "=" in one.text()))

    def __len__(self) -> int:
        return len(list(iter(self)))

    def numbers(self, key: str) -> list[float]:
        """Return the values of a key as numbers."""
        try:
            return [float(re.sub("[dD]", "e", word)) for word in self[key].split()]
        except ValueError:
            place = self.deck.where(self.at(key)[0])
            raise Problem(f"{place}: error: '{self[key]}' of '{key}' are no numbers") from None

    @property
    def text(self) -> str:
        """The statements without comments, line by line: those of *TITLE."""
        return "\n".join(filter(None, (one.text() for one in self.statements)))

    @text.setter
    def text(self, value: str) -> None:
        rest = self.statements[self.end():]
        self.statements = [Statement([f"{INDENT}{line}\n"], 0, of_title=True) for line in value.splitlines()] + rest
        self.deck.changed = True


class Missing(Problem, KeyError):
    """A block or a key that an input file does not have."""

    __str__ = Problem.__str__


class Deck:
    """An input file: its blocks in their order. `deck["MATERIAL"]` is the only block of a keyword, `deck["PHASE",
    "draw"]` that of a name; neither is case sensitive. Files named by *INCLUDE are not read.

    path: the file, None of a text. blocks: all blocks. changed: whether something was changed since it was read or
    written.
    """

    def __init__(self, text: str, path: str | Path | None = None) -> None:
        self.path = None if path is None else Path(path)
        self.blocks: list[Block] = []
        self.above: list[Statement] = []  # the first block
        self.changed = path is None
        for statement in statements(text):
            if is_head(statement):
                self.blocks.append(Block(self, statement))
            elif self.blocks:
                self.blocks[-1].statements.append(statement)
            elif statement.text():
                raise Problem(f"{self.where(statement)}: error: '{statement.text()}' belongs to no block\n"
                              "  expected: a line *KEYWORD before it")
            else:
                self.above.append(statement)

    def where(self, statement: Statement) -> str:
        """Return file and line of a statement, as messages name it."""
        name = str(self.path or "input")
        return f"{name}:{statement.number}" if statement.number else name

    def all(self, keyword: str) -> list[Block]:
        """Return all blocks of a keyword."""
        return [block for block in self.blocks if block.keyword.lower() == keyword.lstrip("*").lower()]

    def __getitem__(self, key: str | tuple[str, str]) -> Block:
        keyword, name = (key, None) if isinstance(key, str) else key
        found = [block for block in self.all(keyword) if name is None or block.name.lower() == name.lower()]
        if len(found) == 1:
            return found[0]
        said = f"*{keyword.lstrip('*').upper()}" + (f" {name}" if name else "")
        if found:
            raise Missing(f"{self.where(found[1].head)}: error: {len(found)} blocks {said}; give a name: "
                          + ", ".join(block.name for block in found))
        there = ", ".join(f"*{block.keyword} {block.name}".rstrip() for block in self.blocks) or "none"
        raise Missing(f"{self.path or 'input'}: error: no block {said}; there are: {there}")

    def __contains__(self, key: str | tuple[str, str]) -> bool:
        keyword, name = (key, None) if isinstance(key, str) else key
        return any(name is None or block.name.lower() == name.lower() for block in self.all(keyword))

    def __iter__(self) -> Iterator[Block]:
        return iter(self.blocks)

    def __len__(self) -> int:
        return len(self.blocks)

    def add(self, keyword: str, name: str = "", **values: Any) -> Block:
        """Add a block behind the last one of its keyword, else at the end; return it."""
        same = self.all(keyword)
        place = self.blocks.index(same[-1]) + 1 if same else len(self.blocks)
        block = Block(self, Statement([f"*{keyword.lstrip('*').upper()} {name}".rstrip() + "\n"], 0))
        self.blocks.insert(place, block)
        before = self.blocks[place - 1] if place else None
        if before and not (before.statements and not before.statements[-1].text()):
            before.statements.append(Statement(["\n"], 0))
        block.update(values)
        if place < len(self.blocks) - 1:
            block.statements.append(Statement(["\n"], 0))
        self.changed = True
        return block

    def remove(self, block: Block) -> None:
        """Remove a block."""
        self.blocks.remove(block)
        self.changed = True

    @property
    def parameters(self) -> Block:
        """The block *PARAMETER."""
        return self["PARAMETER"]

    def __str__(self) -> str:
        lines = [one.lines for one in self.above]
        for block in self.blocks:
            lines += [block.head.lines, *(one.lines for one in block.statements)]
        return "".join(line for some in lines for line in some)

    def substituted(self, text: str) -> str:
        """Return a text with the parameters of this file put in."""
        values = {key: block.all(key)[-1].strip("\"'") for block in self.all("PARAMETER") for key in block}
        return re.sub(r"\$\{(\w+)\}", lambda found: values.get(found[1].lower(), found[0]), text)

    def named_files(self, folder: Path) -> list[tuple[Statement, str]]:
        """Return the words that name files relative to a folder, with their statements."""
        return [(one, word) for block in self.blocks for one in (block.head, *block.statements)
                for pair in WORD.findall(self.substituted(one.text())) for word in [pair[0] or pair[1]]
                if not Path(word).is_absolute() and is_there(folder / word)]

    def write(self, path: str | Path) -> Path:
        """Write the file, which is that of the object then; return its path. Names of files in it are relative to its
        folder: it is a Problem if one of them would no longer be found there."""
        path = Path(path)
        if self.path is not None and self.path.resolve().parent != path.resolve().parent:
            for statement, word in self.named_files(self.path.parent):
                if not is_there(path.parent / word):
                    raise Problem(f"{self.where(statement)}: error: '{word}' is relative to this file, and not found "
                                  f"from {path.parent}\n  expected: a file beside {self.path}, or absolute names in it")
        path.write_bytes(str(self).encode("utf-8", "surrogateescape"))
        self.path, self.changed = path, False
        return path


def is_there(path: Path) -> bool:
    """Tell whether a path is that of a file, or of the results that *START takes over."""
    return path.is_file() or (path / "restart.h5").is_file()


def is_continued(line: str) -> bool:
    """Tell whether a line is continued on the next one."""
    return "&" in line and before_comment(line).strip().endswith("&")


def is_head(statement: Statement) -> bool:
    """Tell whether a statement begins a block."""
    return any("*" in line for line in statement.lines) and statement.text().startswith("*")


def words_of_head(text: str) -> list[str]:
    """Return the words of a statement that begins a block, those in quotes without them."""
    return [quoted[1:-1] or word for quoted, word in HEAD_WORD.findall(text)]


def statements(text: str) -> Iterator[Statement]:
    """Yield the statements of a text, empty lines and comments among them."""
    lines = LINE.findall(text)
    if lines and not lines[-1].endswith(("\n", "\r")):
        lines[-1] += "\n"
    first, in_title = 0, False
    while first < len(lines):
        last = first + 1
        of_title = in_title and not lines[first].lstrip().startswith("*")
        while not of_title and last < len(lines) and is_continued(lines[last - 1]):
            last += 1
        statement = Statement(lines[first:last], first + 1, of_title)
        yield statement
        if is_head(statement):
            in_title = words_of_head(statement.text())[0].lower() == "*title"
        first = last


def read(path: str | Path) -> Deck:
    """Read an input file. Errors name file and line."""
    try:
        return Deck(Path(path).read_bytes().decode("utf-8-sig", "surrogateescape"), path)  # other bytes are kept
    except OSError as error:
        raise Problem(f"{path}: {error.strerror}") from None
