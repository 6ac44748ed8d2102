# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of *MATERIAL by their words: name, parameters and pairs."""

import re
from dataclasses import dataclass, field

from dd3.dyna.parameters import as_number
from dd3.errors import Problem
from dd3.tools.blocks import Block

PARAMETER = re.compile(r"""(\w+)\s*=\s*("[^"]*"|'[^']*'|[^\s"']+)|(\S+):(\S+)|(\S+)""")


@dataclass(frozen=True)
class Words:
    """A law: its name, parameters by name in small letters, pairs in their order; `text` as it was written."""

    name: str
    values: dict[str, float] = field(default_factory=dict)
    pairs: tuple[tuple[float, float], ...] = ()
    text: str = ""

    def __getitem__(self, key: str) -> float:
        return self.values[key]


def number(word: str, text: str) -> float:
    """Return the number of a word."""
    value = as_number(word)
    if value is None:
        raise Problem(f"'{word}' in '{text}' is no number")
    return value


def words_of(text: str | None) -> Words:
    """Return the name of a law and its parameters; 'none' of a law that is not given. Names of files are left out."""
    name, _, rest = (text or "none").strip().partition(" ")
    values, pairs = {}, []
    for key, value, first, second, _ in PARAMETER.findall(rest):
        if key and key.lower() != "file":
            values[key.lower()] = number(value, rest)
        elif first:
            pairs.append((number(first, rest), number(second, rest)))
    return Words(name.lower(), values, tuple(pairs), " ".join((text or "none").split()))


def value_of(block: Block, key: str, default: float | None = None) -> float | None:
    """Return a number of a block, a default where it is not given."""
    text = block.value(key)
    return default if text is None else number(text, key)


def vector_of(block: Block, key: str, default: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return three numbers of a block."""
    text = block.value(key)
    if text is None:
        return default
    x, y, z = (number(word, key) for word in text.replace(",", " ").split())
    return x, y, z
