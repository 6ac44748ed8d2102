"""Keyword blocks of shape files, which have the syntax of dd3imp's input."""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from dd3.tables import read_text


@dataclass
class Block:
    """A keyword block: keyword and keys in small letters, its name as written, the folder its paths are relative to."""

    keyword: str
    name: str
    folder: Path
    values: list[tuple[str, str]] = field(default_factory=list)  # pairs of key and value, in their order

    def value(self, key: str) -> str | None:
        """Return the last value of a key, None if it is not given."""
        return next((value for name, value in reversed(self.values) if name == key), None)


def without_comment(line: str) -> str:
    """Return a line without its comment."""
    return re.sub(r"[#!].*", "", line).strip()


def lines_of(path: str | Path, parents: tuple[Path, ...] = ()) -> Iterator[tuple[str, Path]]:
    """Yield the lines of a file and of those it includes, each with its folder; no comments, no empty lines."""
    path = Path(path)
    for line in re.sub(r"&[ \t]*\n", " ", read_text(path)).splitlines():
        line = without_comment(line)
        include = re.match(r"\*include\s+(.*)", line, re.IGNORECASE)
        if include:
            file = path.parent / include[1].strip("\"'")
            if file not in (*parents, path):  # a ring
                yield from lines_of(file, (*parents, path))
        elif line:
            yield line, path.parent


def blocks_of(lines: Iterable[tuple[str, Path]], settings: Mapping[str, str] | None = None) -> list[Block]:
    """Return the blocks of lines with their folders, the parameters put in."""
    parameters = {name.lower(): value for name, value in (settings or {}).items()}
    blocks: list[Block] = []
    for line, folder in lines:
        if line.startswith("*"):
            keyword, *name = line[1:].split(None, 1)
            blocks.append(Block(keyword.lower(), "".join(name), folder))
        elif blocks:
            key, _, value = (part.strip() for part in line.partition("="))
            value = re.sub(r"\$\{(\w+)\}", lambda found: parameters.get(found[1].lower(), found[0]), value)
            blocks[-1].values.append((key.lower(), value))
            if blocks[-1].keyword == "parameter":
                parameters.setdefault(key.lower(), value)
    return blocks


def read_blocks(path: str | Path, settings: Mapping[str, str] | None = None) -> list[Block]:
    """Return the blocks of a file, with its includes; `settings` take precedence over its parameters."""
    return blocks_of(lines_of(path), settings)
