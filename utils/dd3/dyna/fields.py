# SPDX-License-Identifier: GPL-3.0-or-later
"""Cards of LS-DYNA as text: rows of eight fields of ten columns under a comment with their names, curves and tables."""

import re
from collections.abc import Mapping, Sequence

import numpy as np

from dd3.errors import Problem

WIDTH, LONG = 10, 20  # columns of a field, and of the points of a curve
ACCURACY, DIGITS = 1e-7, 12  # relative; of a number
TITLE = 80  # columns of a title


def field(value: float | int | str, width: int = WIDTH) -> str:
    """Return a number in the columns of a field, with as many digits as they hold, apart from the field before where
    that takes no digits of use; an empty text is an empty field."""
    if isinstance(value, str | int | np.integer):
        text = str(value)
    elif np.isfinite(value):
        text = min((shortest(float(value), columns) for columns in (width - 1, width)),
                   key=lambda one: round(abs(float(one) - value) / (abs(value) or 1.0) / ACCURACY))
    else:
        raise Problem(f"the number {value} does not go into a field of LS-DYNA")
    if len(text) > width:
        raise Problem(f"'{text}' does not go into the {width} columns of a field of LS-DYNA")
    return f"{text:>{width}}"


def shortest(value: float, columns: int) -> str:
    """Return the most accurate text of a number in columns, with a point or an exponent."""
    texts = set()
    for digits in range(DIGITS, 0, -1):
        for text in (f"{value:.{digits}g}", f"{value:.{digits - 1}e}"):
            plain = re.sub(r"e([+-])0*(\d)", lambda part: f"e{part[1].strip('+')}{part[2]}", text)
            plain = re.sub(r"^(-?)0\.", r"\1.", plain) if len(plain) > columns else plain
            plain += "." * ("." not in plain and "e" not in plain)
            if len(plain) <= columns:
                texts.add(plain)
    return min(sorted(texts, key=len), key=lambda text: abs(float(text) - value))


def row(names: str, values: Mapping[str, float | int]) -> list[str]:
    """Return the comment with the names of the fields of a row, and the row; fields without a value are empty."""
    words = names.split()
    shown = [word.lower() if not word.startswith("unused") else "unused" for word in words]
    head = "$#" + f"{shown[0]:>{WIDTH - 2}}" + "".join(f"{word:>{WIDTH}}" for word in shown[1:])
    return [head, "".join(field(values.get(word, "")) for word in words).rstrip() or " " * WIDTH]


def curve(number: int, title: str, points: np.ndarray, intervals: int = 0) -> list[str]:
    """Return a curve of points (n, 2); intervals: equal ones by which LS-DYNA replaces the points (its default)."""
    head = row("LCID SIDR SFA SFO OFFA OFFO DATTYP LCINT",
               {"LCID": number, "SFA": 1.0, "SFO": 1.0} | ({"LCINT": intervals} if intervals else {}))
    return ["*DEFINE_CURVE_TITLE", title[:TITLE], *head, f"$#{'a1':>{LONG - 2}}{'o1':>{LONG}}",
            *(field(float(x), LONG) + field(float(y), LONG) for x, y in points)]


def table(number: int, title: str, rows: Sequence[tuple[float, int]]) -> list[str]:
    """Return a table of values and numbers of curves."""
    return ["*DEFINE_TABLE_2D_TITLE", title[:TITLE], *row("TBID SFA OFFA", {"TBID": number, "SFA": 1.0}),
            f"$#{'value':>{LONG - 2}}{'curveid':>{LONG}}",
            *(field(float(value), LONG) + field(label, LONG) for value, label in rows)]
