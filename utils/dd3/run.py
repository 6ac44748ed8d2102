# SPDX-License-Identifier: GPL-3.0-or-later
"""A run of dd3imp by its folder: tables, fields, and the description of the job."""

import json
import math
import re
from collections.abc import Sequence
from functools import cached_property
from importlib import import_module
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
    from matplotlib.figure import Figure

    from dd3.fields import Fields
    from dd3.springback import Springback
    from dd3.verdict import Item

FORMAT, VERSIONS = "dd3imp run", (1, 2)
# Module of a picture, and whether it takes several runs.
FIGURES = {"force": ("dd3.plot.force", True), "increments": ("dd3.plot.increments", True),
           "sheet": ("dd3.plot.sheet", False), "section": ("dd3.section", False)}
FILE = re.compile(r'\bfile\s*=\s*(?:"([^"]+)"|([^"\s]+))')  # of a law, quoted or not
TEXTS = {"phase", "point", "limiter", "outcome", "reason", "solver"}  # columns that are never numbers


class Run:
    """The results of a run, read when they are asked for.

    history, status: the tables history.csv and status.csv; their units are in `attrs["units"]`.
    fields: the sheet at its steps, `fields[i]` a grid of pyvista, `fields.travel` the travel of each, mm.
    job: the description of the run, run.json; docs/run.schema.json says what it contains.

    Messages on options name them as the commands do: --low-carbon-steel is the argument low_carbon_steel.
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

    def plot(self, kind: str = "force", **options: Any) -> "Figure":
        """Return a figure of matplotlib of what `dd3 plot` draws; options are those of the command, as arguments.

        force: tool force over tool displacement; tool, phase, component (motion, x, y, z, magnitude), factor, title.
        increments: size of the increments and what limits it; phase, title.
        sheet: the sheet between its tools; at (travel in mm, a phase, or several), field, cells, limits, view, mirror,
        hide, and the other members of dd3.plot.sheet.Style.
        levels: how often the elements were divided; the same.
        section: fields along a section; plane, fields, at, lower.
        limit: the forming limit diagram; at, surface (middle, upper, lower), and those of `judge`.
        """
        if kind == "limit":
            from dd3.forming_limit import Criteria
            from dd3.forming_limit_diagram import figure
            own = {name: options.pop(name) for name in ("at", "surface") if name in options}
            return figure(self.folder, criteria=Criteria(**options), **own)[0]
        if kind == "levels":
            kind, options = "sheet", {"field": "level", "hide": ["all"], **options}
        if kind not in FIGURES:
            raise Problem(f"no picture '{kind}'; there are: {' '.join([*FIGURES, 'levels', 'limit'])}")
        module, several = FIGURES[kind]
        found: Figure = import_module(module).figure([self.folder] if several else self.folder, **options)
        return found

    def report(self, output: str | Path | None = None, *, mirror: Sequence[str] = (), section: Sequence[str] = (),
               measured: Sequence[str | Path] = (), waves: float | None = None, tolerance: float | None = None,
               **criteria: Any) -> Path:
        """Write the page of `dd3 report`; return its path.

        output: folder of page and pictures (report in that of the run). mirror: planes of symmetry to complete the
        model at, such as "xy". section: planes such as "y=0" or an angle in degrees. measured: tables of measured
        curves. waves, tolerance, criteria: those of `verdict`.
        """
        from dd3.forming_limit import Criteria
        from dd3.report import make
        return make(self.folder, output=output, mirror=mirror, section=section, measured=measured, waves=waves,
                    tolerance=tolerance, criteria=Criteria(**criteria)).path

    def view(self, window: bool = False, **options: Any) -> Path | None:
        """Open the page of the run in the browser, made if it is missing or old; return its path. options: those of
        `report`. window: show the sheet in a window of its own instead; options are field, at and mirror."""
        from dd3.view import page_of, show_page, show_window
        if window:
            show_window(self.folder, **options)
            return None
        path = self.report(**options) if options else page_of(self.folder)
        show_page(path)
        return path

    def sections(self, plane: str = "y=0", fields: Sequence[str] = ("thickness",), *, at: str | float | None = None,
                 lower: bool = False) -> "pd.DataFrame":
        """Return a section of the sheet as a table: lengths and places before and now, mm, fields, numbers of several
        pieces.

        plane: x=0, y=12.5, or an angle in degrees from x; it cuts the initial sheet. at: travel in mm, or a phase (the
        last step). lower: on the lower face in place of the upper one.
        """
        from dd3.section import sections_of, table_of
        places = () if at is None else (str(at),)
        return table_of(sections_of(self.folder, plane, lower=lower, at=places)[0][0], fields)

    def springback(self, mirror: Sequence[str] = ()) -> "Springback | None":
        """Return the drawn and the free shape after the best fit, with the distance of each node; None where the last
        phase does not release all tools. mirror: planes of symmetry of the model, such as "xy", beside those on which
        it keeps the border of the sheet."""
        from dd3.sheet import Sheet
        from dd3.springback import find
        return find(Sheet(self.folder), self.job["phases"], planes_of(mirror))

    def verdict(self, *, mirror: Sequence[str] = (), waves: float | None = None, tolerance: float | None = None,
                **criteria: Any) -> "list[Item]":
        """Return the verdict of `dd3 report`: items with name, answer (good, not good, doubtful, not judged), text.

        waves: largest height of waves under a holder and in walls, mm. tolerance: largest distance of the free shape
        from the drawn one, mm. criteria of the forming limit: curve (a file), engineering, low_carbon_steel, n, margin,
        thinning, as the options of `dd3 fld`.
        """
        from dd3 import forming_limit, verdict
        from dd3.sheet import Sheet
        from dd3.springback import unfinished
        check_limits(waves, tolerance)
        sheet, limit = Sheet(self.folder), forming_limit.Criteria(**criteria)
        limits = forming_limit.find_limits(sheet, self.job, limit)
        strains = forming_limit.strains_of(sheet, sheet.last, "middle")
        found, sprung = forming_limit.judge(strains, limits, limit.margin), self.springback(mirror)
        distance = float(sprung.distance().max()) if sprung else None
        splits = verdict.splits(found.critical, found.said, strains.largest_thinning() > limits.thinning)
        return verdict.judge(self.job, waves, splits,
                             verdict.sprung(distance, tolerance, unfinished(self.job["phases"])))


def planes_of(mirror: Sequence[str]) -> list[str]:
    """Return the planes of symmetry that the letters of `mirror` name, x, y or z, in this order."""
    found = sorted(set("".join(mirror)))
    if set(found) - set("xyz"):
        raise Problem(f"mirror takes planes of symmetry, such as 'x' or 'xy', not '{''.join(mirror)}'")
    return found


def check_limits(waves: object, tolerance: object) -> None:
    """Check the limits of a verdict, mm; each may be None."""
    if any(limit is not None and not (isinstance(limit, (int, float)) and limit > 0) for limit in (waves, tolerance)):
        raise Problem("--waves and --tolerance take a positive number")


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


def parts_of(job: dict[str, Any]) -> list[tuple[dict[str, Any], float]]:
    """Return the descriptions of a run and of those that it continues, the first one first, each with the increment
    from which the later ones go on; infinite for the last one."""
    found = [(job, math.inf)]
    while earlier := (found[0][0].get("continued") or {}).get("earlier"):
        found.insert(0, (earlier, min(found[0][1], found[0][0]["continued"].get("increment", math.inf))))
    return found


def effort_of(job: dict[str, Any]) -> tuple[int, float]:
    """Return the increments of a run with those that it continues, and the time of all, s."""
    return (max(phase["result"]["last_increment"] or 0 for phase in job["phases"]),
            sum(part["seconds"] or 0.0 for part, _ in parts_of(job)))


def warnings_of(job: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the warnings of a run and of those that it continues, without those of increments that a restart gives up,
    and once those that it repeats."""
    found = {(warning["code"], warning["phase"], warning.get("text")): warning for part, end in parts_of(job)
             for warning in part["warnings"] if (warning.get("increment") or 0) <= end}
    return list(found.values())


def files_of(job: dict[str, Any]) -> list[Path]:
    """Return the files that a run reads: input files, those that their values name, the restart file of a sheet."""
    base = Path(job["command"]["working_directory"])
    found = [base / name for name in job["input"]["files"]]
    for block in job["input"]["blocks"]:
        for entry in block["entries"]:
            if not entry["at"]:
                continue
            names = [entry["value"]] if isinstance(entry["value"], str) else []
            names += [quoted or word for quoted, word in FILE.findall(entry["text"])]  # of a law
            for path in (base / Path(entry["at"]["file"]).parent / name for name in names):
                found += [file for file in (path, path / "restart.h5") if file.is_file()]
    return sorted(set(found))


def state_of(folder: Path) -> str:
    """Return the state of a run, empty where there is none."""
    return str(read_job(folder)["outcome"]["state"]) if (folder / "run.json").is_file() else ""


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
