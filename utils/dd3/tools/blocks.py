# SPDX-License-Identifier: GPL-3.0-or-later
"""Keyword blocks of shape files, which have the syntax of dd3imp's input."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

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


def lines_of(path: str | Path, parents: tuple[Path, ...] = ()) -> Iterator[str]:
    """Yield the lines of a file and of those it includes; no comments, no empty lines."""
    path = Path(path)
    for line in lines_of_text(read_text(path)):
        include = re.match(r"\*include\s+(.*)", line, re.IGNORECASE)
        if include:
            file = path.parent / include[1].strip("\"'")
            if file not in (*parents, path):  # a ring
                yield from lines_of(file, (*parents, path))
        else:
            yield line


def lines_of_text(text: str) -> Iterator[str]:
    """Yield the lines of a text; no comments, no empty lines."""
    for line in re.sub(r"&[ \t]*\n", " ", text).splitlines():
        if line := re.sub(r"[#!].*", "", line).strip():
            yield line


def read_blocks(path: str | Path) -> list[Block]:
    """Return the blocks of a file, with its includes, the parameters put in."""
    return blocks_of(lines_of(path))


def blocks_of(lines: Iterable[str]) -> list[Block]:
    """Return the blocks of lines, the parameters put in."""
    parameters: dict[str, str] = {}
    blocks: list[Block] = []
    for line in lines:
        if line.startswith("*"):
            keyword, *name = line[1:].split(None, 1)
            blocks.append(Block(keyword.lower(), "".join(name)))
        elif blocks:
            key, _, value = (part.strip() for part in line.partition("="))
            value = re.sub(r"\$\{(\w+)\}", lambda found: parameters.get(found[1].lower(), found[0]), value)
            blocks[-1].values.append((key.lower(), value))
            if blocks[-1].keyword == "parameter":
                parameters.setdefault(key.lower(), value)
    return blocks
