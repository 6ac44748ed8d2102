# SPDX-License-Identifier: GPL-3.0-or-later
"""A run of dd3imp by its folder: tables, fields, and the description of the job."""

import json
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dd3.errors import Problem
from dd3.tables import is_whole, read_table, read_text, table_file

try:
    import fcntl
except ModuleNotFoundError:  # Windows
    fcntl = None  # type: ignore[assignment]

if TYPE_CHECKING:
    import pandas as pd

    from dd3.fields import Fields

FORMAT, VERSIONS = "dd3imp run", (1, 2)
TEXTS = {"phase", "point", "limiter", "outcome", "reason", "solver"}  # columns that are never numbers


class Run:
    """The results of a run, read when they are asked for.

    history, status: the tables history.csv and status.csv; their units are in `attrs["units"]`.
    fields: the sheet at its steps, `fields[i]` a grid of pyvista, `fields.travel` the travel of each, mm.
    job: the description of the run, run.json; docs/run.schema.json says what it contains.
    """

    def __init__(self, folder: str | Path) -> None:
        self.folder = Path(folder)
        if not self.folder.is_dir():
            raise Problem(f"{folder}: No such folder")

    @cached_property
    def history(self) -> "pd.DataFrame":
        """Travel, tools' displacements and forces, energies: a row for each increment."""
        return read_frame(self.folder / "history.csv")

    @cached_property
    def status(self) -> "pd.DataFrame":
        """Size, limiter, convergence and outcome of each attempt of an increment."""
        return read_frame(self.folder / "status.csv")

    @cached_property
    def fields(self) -> "Fields":
        """The sheet and its fields."""
        from dd3.fields import Fields
        return Fields(self.folder)

    @cached_property
    def job(self) -> dict[str, Any]:
        """The description of the run."""
        return read_job(self.folder)

    def __repr__(self) -> str:
        return f"dd3.open({str(self.folder)!r})"


def read_frame(run: str | Path, name: str = "history.csv", *needed: str) -> "pd.DataFrame":
    """Return a table of a run, given it or its folder, with columns of numbers where all values are; rows that were
    cut are left out. The columns `needed` must be there."""
    import pandas as pd
    path = table_file(run, name)
    rows = read_table(path, *needed)
    if not rows:
        raise Problem(f"{path}: no rows")
    frame = pd.DataFrame([row for row in rows if is_whole(row)], columns=list(rows[0]))
    for column in frame.columns.difference(list(TEXTS)):
        try:
            frame[column] = pd.to_numeric(frame[column].where(frame[column] != "", None))
        except ValueError:  # a column of texts
            continue
    units = read_text(path).partition("\n")[0]
    if units.startswith("# units:"):
        frame.attrs["units"] = dict(zip(frame.columns, units.removeprefix("# units:").strip().split(",")))
    frame.attrs["path"] = path
    return frame


def read_job(folder: Path) -> dict[str, Any]:
    """Return the description of a run. A run that says that it goes on, although no program holds its log, was killed:
    its state is `killed`."""
    path = folder / "run.json"
    try:
        job: dict[str, Any] = json.loads(read_text(path))
    except ValueError:
        raise Problem(f"{path}: not a description of a run") from None
    if job.get("format") != FORMAT or job.get("format_version") not in VERSIONS:
        raise Problem(f"{path}: expected {FORMAT!r} of version {VERSIONS[0]} to {VERSIONS[-1]}")
    if job.get("outcome", {}).get("state") == "running" and not is_held(folder / "job.log"):
        job["outcome"]["state"] = "killed"
    return job


def is_held(path: Path) -> bool:
    """Tell whether a program may write a file: it holds a lock on it, or that cannot be found out."""
    if fcntl is None:
        return path.is_file()
    try:
        with path.open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except FileNotFoundError:
        return False
    except OSError:
        return True
    return False


def file_of(job: dict[str, Any], folder: Path, name: str) -> Path:
    """Return the path of a file that a job names: relative to the folder of the run's start, else beside the results,
    where both were moved."""
    path = Path(job["command"]["working_directory"] or "", name)
    beside = folder.resolve().parent / path.name
    return path if path.is_file() or not beside.is_file() else beside
