# SPDX-License-Identifier: GPL-3.0-or-later
"""Keyword blocks of shape files, which have the syntax of dd3imp's input."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from dd3.deck import statements, words_of_head
from dd3.tables import read_text


@dataclass
class Block:
    """A keyword block: keyword and keys in small letters, its name as written."""

    keyword: str
    name: str
    values: list[tuple[str, str]] = field(default_factory=list)  # pairs of key and value, in their order

    def value(self, key: str) -> str | None:
        """Return the last value of a key, None if it is not given."""
        return next((value for name, value in reversed(self.values) if name == key), None)


def lines_of(path: str | Path) -> Iterator[str]:
    """Yield the lines of a file and of those it includes, in whose names parameters are put in; no comments, no empty
    lines."""
    yield from lines_with(Path(path), (), Parameters())


def lines_with(path: Path, parents: tuple[Path, ...], parameters: "Parameters") -> Iterator[str]:
    """Yield the lines of a file and of those it includes; parents: the files that include it."""
    for line in lines_of_text(read_text(path)):
        parameters.follow(line)
        include = re.match(r"\*include\s+(.*)", line, re.IGNORECASE)
        if include:
            file = path.parent / parameters.put(include[1]).strip("\"'")
            if file not in (*parents, path):  # a ring
                yield from lines_with(file, (*parents, path), parameters)
        else:
            yield line


class Parameters:
    """The parameters of an input file, by the lines that were read; the first value of a name holds."""

    def __init__(self) -> None:
        self.values: dict[str, str] = {}
        self.inside = False  # of *PARAMETER

    def follow(self, line: str) -> None:
        """Take a line."""
        if line.startswith("*"):
            self.inside = line[1:].lower().split()[:1] == ["parameter"]
        elif self.inside:
            key, _, value = (part.strip() for part in line.partition("="))
            self.values.setdefault(key.lower(), self.put(value))

    def put(self, text: str) -> str:
        """Return a text with the parameters put in; unknown ones are left."""
        return re.sub(r"\$\{(\w+)\}", lambda found: self.values.get(found[1].lower(), found[0]), text)


def lines_of_text(text: str) -> Iterator[str]:
    """Yield the lines of a text; no comments, no empty lines."""
    for statement in statements(text):
        if line := statement.text():
            yield line


def read_blocks(path: str | Path) -> list[Block]:
    """Return the blocks of a file, with its includes, the parameters put in."""
    return blocks_of(lines_of(path))


def blocks_of(lines: Iterable[str]) -> list[Block]:
    """Return the blocks of lines, the parameters put in."""
    parameters = Parameters()
    blocks: list[Block] = []
    for line in lines:
        parameters.follow(line)
        if line.startswith("*"):
            keyword, *name = words_of_head(line)
            blocks.append(Block(keyword[1:].lower(), " ".join(name)))
        elif blocks:
            key, _, value = (part.strip() for part in line.partition("="))
            blocks[-1].values.append((key.lower(), parameters.put(value)))
    return blocks
