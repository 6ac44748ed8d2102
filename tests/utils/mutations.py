# SPDX-License-Identifier: GPL-3.0-or-later
"""Damaged inputs: bytes flipped, lines dropped, doubled and exchanged, fields cut, numbers replaced, ends cut off."""

import random
import re
from collections.abc import Iterator

VALUES = [b"0", b"-1", b"1e300", b"-1e-300", b"nan", b"inf", b"x", b"", b"99999999999999999999", b"0.5", b"1D3", b"2.5+3",
          b"&none", b"1,2", b"*", b"\xff"]
MOST_FAULTS = 4


def mutants(data: bytes, count: int, seed: int) -> Iterator[bytes]:
    """Yield a number of inputs with one to four faults; the same for the same seed."""
    chance = random.Random(seed)
    for _ in range(count):
        found = data
        for _ in range(chance.randint(1, MOST_FAULTS)):
            found = chance.choice(FAULTS)(found, chance)
        yield found


def flipped(data: bytes, chance: random.Random) -> bytes:
    """Return the input with a byte changed."""
    if not data:
        return data
    i = chance.randrange(len(data))
    return data[:i] + bytes([data[i] ^ (1 << chance.randrange(8))]) + data[i + 1:]


def cut_off(data: bytes, chance: random.Random) -> bytes:
    """Return the input up to a byte, seldom a short one."""
    return data[:chance.randrange(len(data) // 2, len(data))] if len(data) > 1 else data


def lines_changed(data: bytes, chance: random.Random) -> bytes:
    """Return the input with a line dropped, doubled elsewhere, or exchanged with another."""
    lines = data.split(b"\n")
    i, j = chance.randrange(len(lines)), chance.randrange(len(lines))
    kind = chance.randrange(3)
    if kind == 0:
        del lines[i]
    elif kind == 1:
        lines.insert(i, lines[j])
    else:
        lines[i], lines[j] = lines[j], lines[i]
    return b"\n".join(lines)


def field_changed(data: bytes, chance: random.Random) -> bytes:
    """Return the input with a word replaced, in its columns or not, or cut out."""
    words = list(re.finditer(rb"[^\s,]+", data))
    if not words:
        return data
    word = chance.choice(words)
    value = chance.choice(VALUES)
    if chance.random() < 0.5:
        value = value[:len(word[0])].rjust(len(word[0]))
    return data[:word.start()] + value + data[word.end():]


def line_cut(data: bytes, chance: random.Random) -> bytes:
    """Return the input with a line cut off within."""
    lines = data.split(b"\n")
    i = chance.randrange(len(lines))
    lines[i] = lines[i][:chance.randint(0, len(lines[i]))]
    return b"\n".join(lines)


FAULTS = (flipped, lines_changed, lines_changed, field_changed, field_changed, field_changed, line_cut, cut_off)
