# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured tables of two columns or more, tables of few points through them, and their comparison."""

from collections.abc import Sequence

import numpy as np
from scipy.optimize import lsq_linear

from dd3.account import Account
from dd3.columns import Column, Row, read_columns
from dd3.errors import LOG, Problem

MOST = 8  # points of a table
RATIO_UNITS = {"": 1.0, "-": 1.0, "1": 1.0}


def read_measured(path: str, columns: Sequence[Column], least: int = 1, names: Sequence[str] = ()) -> list[Row]:
    """Return the rows of a table, `least` or more; say what of it is not used. `names`: the parameters that need
    them."""
    account = Account()
    rows = read_columns(path, columns, account)
    if len(rows) < least:
        needed = f": {', '.join(names)}" if names else ""
        one = [column.name for column in columns]
        none = "" if rows else ": none begins with a number"
        raise Problem(f"{path}: error: {len(rows)} row{'s' * (len(rows) != 1)}{none}\n"
                      f"  expected: {', '.join(one[:-1])} and {one[-1]} in {least} rows or more{needed}")
    for item in account.left_out():
        LOG.info(f"left out: {item}")
    return rows


def values_of(rows: Sequence[Row]) -> np.ndarray:
    """Return the values of rows, a column in each row (columns, n)."""
    return np.array([row.values for row in rows]).T


def knots_of(places: np.ndarray) -> np.ndarray:
    """Return the distinct places, to four digits, at most eight of them with both ends."""
    distinct = np.unique([float(f"{place:.4g}") for place in places])
    chosen = np.unique(np.linspace(0, len(distinct) - 1, min(MOST, len(distinct))).round().astype(int))
    return np.asarray(distinct[chosen])


def hats(knots: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Return the weights of the values at the knots in straight interpolation (places, knots), constant beyond."""
    return np.array([np.interp(places, knots, unit) for unit in np.eye(len(knots))]).T


def straight_lines(knots: np.ndarray, places: np.ndarray, values: np.ndarray, direction: int = 0,
                   first: float | None = None) -> np.ndarray:
    """Return the values at the knots of the straight lines that fit values best, with least squares of the
    differences: from each knot to the next they do not fall (1), do not rise (-1), or do both (0). `first`: the value
    at the first knot, if it is given."""
    matrix = hats(knots, places)
    size = float(np.abs(values).max())
    sums = np.tril(np.ones((len(knots), len(knots))))  # of the first value and the rises
    low = np.full(len(knots), 0.0 if direction > 0 else -np.inf)
    high = np.full(len(knots), 0.0 if direction < 0 else np.inf)
    low[0], high[0] = -np.inf, np.inf
    system, right = matrix @ sums, values / size
    if first is not None:
        right = right - system[:, 0] * first / size
        system, low, high = system[:, 1:], low[1:], high[1:]
    found = lsq_linear(system, right, (low, high), tol=1e-14).x * size
    return np.asarray(sums @ (found if first is None else np.append(first, found)))


def pairs_text(name: str, knots: np.ndarray, values: np.ndarray, digits: int) -> str:
    """Return a law of points in the form of the input."""
    return " ".join([name, *(f"{knot:.6g}:{value:.{digits}g}" for knot, value in zip(knots, values))])


def compared(label: str, measured: float, found: float, digits: int = 4) -> str:
    """Return the line of a measured value beside the identified one."""
    return f"{label:<32}{measured:>10.{digits}f}{found:>12.{digits}f}{found - measured:>12.{digits}f}"


def misfit(measured: np.ndarray, found: np.ndarray, what: str = "rows", unit: str = "", digits: int = 4) -> str:
    """Return the line with the root mean square of the differences and the largest one."""
    off = np.abs(found - measured)
    size = f"{np.sqrt(np.mean(off**2)):.{digits}f}{unit}"
    return f"root mean square over {len(off)} {what}: {size}, largest {off.max():.{digits}f}{unit}"


def one_place(what: str, places: np.ndarray, names: Sequence[str]) -> list[str]:
    """Return a note if values at fewer different places than parameters were measured."""
    count = len(np.unique(places))
    if count >= len(names):
        return []
    return [f"measured at {count} {what}{'s' * (count != 1)}, which do{'es' * (count == 1)} not determine "
            f"{', '.join(names)}"]
