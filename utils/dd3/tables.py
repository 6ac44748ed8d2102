# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of results; whatever cannot be used raises a Problem."""

import csv
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dd3.errors import Problem

Row = dict[str, str]


def read_text(path: str | Path) -> str:
    """Return the text of a file, of UTF-16 too where it begins so; bytes that are not UTF-8 are replaced."""
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise Problem(f"{path}: {error.strerror}") from None
    wide = data[:2] in (b"\xff\xfe", b"\xfe\xff")
    text = data.decode("utf-16" if wide else "utf-8-sig", errors="replace").replace("\r\n", "\n").replace("\r", "\n")
    if "\0" in text:
        raise Problem(f"{path}: not a text")
    return text


def read_table(path: str | Path, *needed: str) -> list[Row]:
    """Return the rows of a csv file as dictionaries of stripped texts; lines that begin with # are left out.

    A row that was cut has None in the columns it lacks. The columns `needed` must be there.
    """
    lines = [line for line in read_text(path).splitlines() if line.strip() and not line.lstrip().startswith("#")]
    reader = csv.DictReader(lines, skipinitialspace=True)
    try:
        reader.fieldnames = [name.strip() for name in reader.fieldnames or []]
        rows = list(reader)
    except csv.Error as error:
        raise Problem(f"{path}: not a table with commas: {error}") from None
    for name in needed:
        if name not in reader.fieldnames:
            raise Problem(f"{path}: no column '{name}'")
    return [{name: value.strip() if isinstance(value, str) else value for name, value in row.items()} for row in rows]


def is_whole(row: Row) -> bool:
    """Check that a row has a value for each column and no further ones; the last row of a killed run may not."""
    return None not in row and None not in row.values()


def number(row: Row, column: str, path: str | Path) -> float:
    """Return a value of a row as a number; `path` names the table in messages."""
    if column not in row:
        raise Problem(f"{path}: there is no column {column}; there are {', '.join(row)}")
    try:
        return float(row[column])
    except (TypeError, ValueError):
        raise Problem(f"{path}: {column} = {row[column]!r} is not a number") from None


def table_file(run: str | Path, name: str = "history.csv") -> Path:
    """Return the path of a table of a run, given it or its folder."""
    path = Path(run)
    return path / name if path.is_dir() else path


def label_of(run: str | Path) -> str:
    """Return the name of a run in pictures: that of its folder, given it or one of its files."""
    path = Path(run).resolve()
    return (path if path.is_dir() else path.parent).name.removesuffix(".out")


def read_points(run: str | Path) -> dict[str, list[dict[str, float]]]:
    """Return the rows of a run of single points by point, as numbers; `run` is the folder or its history.csv."""
    path = table_file(run)
    rows = read_table(path)
    if not rows or "point" not in rows[0]:
        raise Problem(f"{path}: not the history of single points")
    points: dict[str, list[dict[str, float]]] = {}
    for i, row in enumerate(rows, 1):
        try:
            points.setdefault(row.pop("point"), []).append({key: float(value) for key, value in row.items()})
        except (TypeError, ValueError):
            raise Problem(f"{path}: row {i} does not hold a number in each column") from None
    return points


def tools_in(columns: Iterable[Any]) -> list[str]:
    """Return the tools of a history, given its columns."""
    return [name.removesuffix("_contacts") for name in columns if str(name).endswith("_contacts")]


def interpolate(places: Sequence[float], values: Sequence[float], place: float) -> float | None:
    """Return a value at a place, linear between two neighbours; None beyond the end."""
    for i in range(1, len(places)):
        if places[i] >= place - 1e-9 and places[i] > places[i - 1]:
            fraction = (place - places[i - 1]) / (places[i] - places[i - 1])
            return values[i - 1] + fraction * (values[i] - values[i - 1])
    return None


@dataclass
class Totals:
    """Sums over status.csv. Iterations of attempts that failed count."""

    increments: int
    cutbacks: int
    iterations: int
    solver_iterations: int


def totals(status: Sequence[Row]) -> Totals:
    """Sum the rows of status.csv."""
    return Totals(sum(row["outcome"] == "accepted" for row in status), sum(row["outcome"] == "retry" for row in status),
                  sum(int(row["iterations"]) for row in status), sum(int(row["solver_iterations"]) for row in status))


def limiters(status: Iterable[Row], phase: str) -> list[str]:
    """Return the limiter of each accepted increment of a phase."""
    return [row["limiter"] for row in status if row["outcome"] == "accepted" and row["phase"] == phase]


def force_limits(status: Iterable[Row], phase: str) -> Iterator[tuple[float, int, str, float]]:
    """Yield travel, node, tool and B (N) of the limit on the contact forces in the increments of a phase."""
    for row in status:
        if row["force_node"] and row["phase"] == phase:
            yield float(row["travel"]), int(row["force_node"]), row["force_tool"], float(row["force_size"])
