# SPDX-License-Identifier: GPL-3.0-or-later
"""Mutants of an input: bytes flipped, lines dropped, doubled or cut, numbers replaced, the end cut off."""

import random
import re
from collections.abc import Iterator

WORDS = (b"word", b"1e30", b"-7", b"nan", b"inf", b"999999999999999999999", b"1e-300", b"0", b"")


def mutants(data: bytes, count: int, seed: int) -> Iterator[bytes]:
    """Yield a number of mutants, the same ones for the same seed."""
    chance = random.Random(seed)
    for _ in range(count):
        mutant = data
        for _ in range(chance.randint(1, 3)):
            mutant = mutated(mutant, chance)
        yield mutant


def mutated(data: bytes, chance: random.Random) -> bytes:
    """Return data with one change."""
    kind = chance.randrange(6)
    if kind == 0 and data:
        place = chance.randrange(len(data))
        return data[:place] + bytes([data[place] ^ 1 << chance.randrange(8)]) + data[place + 1:]
    if kind == 1:
        return data[:chance.randrange(len(data) + 1)]
    if kind == 2:
        numbers = list(re.finditer(rb"[-+]?\d[\d.eE+-]*", data))
        if numbers:
            number = chance.choice(numbers)
            return data[:number.start()] + chance.choice(WORDS) + data[number.end():]
    lines = data.splitlines(keepends=True)
    if not lines:
        return data
    place = chance.randrange(len(lines))
    if kind == 3:
        del lines[place]
    elif kind == 4:
        lines.insert(chance.randrange(len(lines)), lines[place])
    else:
        end = chance.randrange(len(lines[place]) + 1)
        lines[place] = lines[place][:end] + b"\n"
    return b"".join(lines)
