# SPDX-License-Identifier: GPL-3.0-or-later
"""Vary parameters of an input file: all combinations of their values, a table and pictures of chosen results.

    dd3 study rail.dat --vary friction=0.05:0.15:3 holder=-15000,-20000 --result punch_fz:max thinning:max
    dd3 study cup.dat --vary material=dp600,dc06 friction=0.1,0.14 --result die_fz --cores 4 --indices

A parameter is one of *PARAMETER: values apart by commas, or FIRST:LAST:NUMBER. A result is a column of history.csv at
the end, or :max or :min over the run; or a field of fields.vtkhdf at the end, its :max, :min or :mean of the elements.
results.csv and a picture of each result over the first parameter with several numbers are written into --work. After an
interruption the same command continues: finished runs are kept, others continue from their restart files; runs that are
older than the input file are made anew.

--indices prints for each result which part of its variance over the combinations belongs to each parameter: alone
(first order) and with all its interactions (total), after Sobol (1993), exact for combinations of equal weight.
--surface fits a quadratic polynomial to each result, prints how well it predicts, and draws it over two parameters.

On a cluster, snakemake makes the runs, with its options after --:

    dd3 study rail.dat --vary friction=0.05:0.15:11 holder=-15000:-25000:5 -- --profile utils/dd3/study/slurm
"""

import argparse
import csv
import importlib.util
import itertools
import json
import os
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

import numpy as np

from dd3 import errors
from dd3.command import new_parser
from dd3.errors import Problem
from dd3.fields import Fields
from dd3.plot.figures import new_figure, save
from dd3.programs import add_program, command, find_program, launch, made_folder
from dd3.progress import counter
from dd3.run import files_of, read_frame, read_job, state_of
from dd3.study import response
from dd3.tables import read_table, totals

FOLDS: dict[str, Callable[[np.ndarray], float]] = {
    "max": np.max, "min": np.min, "mean": np.mean, "last": lambda values: values[-1]}
MOST = 10000  # combinations
RESOLUTION = 1.0  # of the time at which a run began, s
REFUSED = "refused"  # state of a run that the program refuses
STUDY = "combinations.json"  # program, input file and combinations for the workflow of snakemake


@dataclass
class Case:
    """A combination: its values by parameter, its folder, and its results once it has run. settings: parameters that
    all combinations share. message: why it was refused."""

    values: dict[str, str]
    folder: Path
    state: str = ""
    results: list[float] | None = None
    settings: dict[str, str] = field(default_factory=dict)
    message: str = ""


def parameter(text: str) -> tuple[str, list[str]]:
    """Return name and values of an argument of --vary."""
    name, equals, values = text.partition("=")
    parts = values.split(":")
    if len(parts) == 3:
        try:
            first, last, number = float(parts[0]), float(parts[1]), int(parts[2])
        except ValueError:
            raise argparse.ArgumentTypeError(f"takes FIRST:LAST:NUMBER, not {values}") from None
        if number < 2:
            raise argparse.ArgumentTypeError(f"takes a NUMBER of 2 or more, not {number}")
        found = [f"{value:.8g}" for value in np.linspace(first, last, number)]
    else:
        found = [value.strip() for value in values.split(",")]
    if not name or not equals or not all(found) or len(set(found)) < len(found):
        raise argparse.ArgumentTypeError(f"takes NAME=VALUE,VALUE,... or NAME=FIRST:LAST:NUMBER, not {text}")
    return name, found


def result(text: str) -> tuple[str, str]:
    """Return name and fold of an argument of --result; the fold is empty where it is not given."""
    name, _, fold = text.rpartition(":")
    if fold not in FOLDS:
        name, fold = text, ""
    return name, fold


def folder_name(values: Mapping[str, str]) -> str:
    """Return the name of the folder of a run that tells its parameters."""
    word = "_".join(f"{name}={value}" for name, value in values.items())
    return "".join(c if c.isalnum() or c in "._=+-" else "-" for c in word)


def combinations(parameters: Sequence[tuple[str, list[str]]], work: Path, settings: dict[str, str] | None = None
                 ) -> list[Case]:
    """Return all combinations, each with a folder that names it. settings: parameters that all share."""
    names = [name for name, _ in parameters]
    if len(set(names)) < len(names):
        raise Problem("a parameter of --vary is given twice")
    count = int(np.prod([len(values) for _, values in parameters]))
    if count > MOST:
        raise Problem(f"{count} combinations; expected at most {MOST}")
    found = []
    for row in itertools.product(*(values for _, values in parameters)):
        values = dict(zip(names, row))
        settings = settings or {}
        found.append(Case(values, work / folder_name({**values, **settings}), settings=settings))
    if len({case.folder for case in found}) < len(found):
        raise Problem("values of --vary that differ in blanks or signs only: their folders would be the same")
    return found


def is_old(case: Case, deck: Path) -> bool:
    """Whether the run in the folder of a case is that of another input file or other parameters, or a file that it
    reads has changed since its start, whose time is known to a second, or at least since its end."""
    job, folder = read_job(case.folder), case.folder
    used = Path(job["command"]["working_directory"]) / job["command"]["file"]
    settings = {f"{name}={value}" for name, value in {**case.settings, **case.values}.items()}
    if set(job["command"]["settings"]) != settings or not (used.exists() and deck.samefile(used)):
        return True
    since = min(datetime.fromisoformat(job["started"]).timestamp() + RESOLUTION,
                (folder / "run.json").stat().st_mtime)
    return any(path.stat().st_mtime > since for path in (deck, *files_of(job)))


def make(case: Case, program: Path, deck: Path) -> None:
    """Run a case unless it has ended; an interrupted run is continued."""
    case.state = state_of(case.folder)
    old = bool(case.state) and is_old(case, deck)
    if old:
        case.state = ""
    if case.state in ("reached", "stopped"):
        return
    restart = case.folder / "restart.h5"
    options: list[object] = ["--quiet", "--threads", "1"]
    if restart.is_file() and not old:
        options += ["--restart", restart]
    done = launch(command(program, deck, case.folder, options, {**case.settings, **case.values}))
    if done.code == 2:
        raise Problem(done.errors.strip())
    case.state = state_of(case.folder)


def attempt(case: Case, program: Path, deck: Path) -> None:
    """Run a case unless it has ended; one that the program refuses has the state REFUSED and its message."""
    try:
        make(case, program, deck)
    except Problem as problem:
        case.state, case.message = REFUSED, str(problem)


def value_of(folder: Path, name: str, fold: str) -> tuple[float, str]:
    """Return a result of a run, of a column of the history or of a field at the elements, and its label."""
    history = read_frame(folder, "history.csv")
    how = f", {fold}" if fold else ""
    if name in history:
        unit = history.attrs.get("units", {}).get(name, "-")
        label = name.replace("_", " ") + ("" if unit == "-" else f" ({unit})")
        return float(FOLDS[fold or "last"](history[name].to_numpy(float))), label + how
    fields = Fields(folder)
    stem = name.partition(":")[0]
    at_cells = stem in fields.grid["CellData"]
    if not at_cells and stem not in fields.grid["PointData"]:
        raise Problem(f"no result '{name}'; there are the columns {', '.join(map(str, history.columns))} and the "
                      f"fields {', '.join(fields.grid['CellData'])}")
    if fold == "last":
        raise Problem(f"{name}:last: a field is taken at the end; expected :max, :min or :mean")
    values, label = fields.component(fields.last, name, at_cells)
    return float(FOLDS[fold or "max"](values)), label + how


def run_all(cases: list[Case], program: Path, deck: Path, cores: int,
            run: Callable[[Case, Path, Path], None] = make) -> None:
    """Run the cases by a function, as many at a time as there are cores for them, with a bar."""
    bar = counter("runs", "run")
    bar.total = len(cases)
    with ThreadPoolExecutor(cores) as pool:
        waiting = [pool.submit(run, case, program, deck) for case in cases]
        try:
            for one in waiting:
                one.result()
                bar.update(1)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
        finally:
            bar.close()


def run_by_snakemake(cases: list[Case], program: Path, deck: Path, cores: int, work: Path, words: Sequence[str]
                     ) -> None:
    """Run the cases by snakemake in a folder, with further options of it."""
    if importlib.util.find_spec("snakemake") is None:
        raise Problem(errors.missing("snakemake"))
    study = {"program": str(program), "deck": str(deck.resolve()),
             "cases": {case.folder.name: case.values for case in cases}}
    (work / STUDY).write_text(json.dumps(study, indent=1), encoding="utf-8")
    limit = [] if "--profile" in words else ["--cores", str(cores)]
    done = subprocess.run([sys.executable, "-m", "snakemake", "--snakefile",
                           str(Path(__file__).with_name("combinations.smk")), "--directory", str(work), "--keep-going",
                           "--rerun-incomplete", "--rerun-triggers", "mtime", "--quiet", "all", *limit, *words],
                          check=False)
    for case in cases:
        case.state = state_of(case.folder)
    missing = [case.folder.name for case in cases if not case.state]
    if done.returncode or missing:
        raise Problem(f"snakemake ended with exit code {done.returncode}; {len(missing)} of {len(cases)} runs are "
                      "missing" + (f", the first: {missing[0]}" if missing else ""))


def run_combination(words: Sequence[str]) -> None:
    """Run a combination in the folder of a study: a step of combinations.smk."""
    parser = new_parser("study combination", "Run one combination of a study in the folder that snakemake works in.\n\n"
                        "    dd3 study combination friction=0.1\n")
    parser.add_argument("case", help="name of its folder")
    options = parser.parse_args(words)
    path = Path(STUDY)
    if not path.is_file():
        raise Problem(f"{STUDY}: no such file; call the command in the folder of a study")
    study = json.loads(path.read_text(encoding="utf-8"))
    if options.case not in study["cases"]:
        raise Problem(f"{STUDY}: no combination '{options.case}'")
    make(Case(study["cases"][options.case], path.resolve().parent / options.case), Path(study["program"]),
         Path(study["deck"]))


def write_table(path: Path, cases: list[Case], names: list[str]) -> list[list[str]]:
    """Write results.csv and return its rows, the heading first."""
    rows = [[*cases[0].values, *names, "state", "increments", "iterations", "seconds"]]
    for case in cases:
        path_of_status = case.folder / "status.csv"  # an interrupted run has it too, a refused one not
        status = read_table(path_of_status) if path_of_status.is_file() else []
        sums, seconds = totals(status), sum(float(row["seconds"]) for row in status)
        found = [f"{value:.7g}" for value in case.results] if case.results else [""] * len(names)
        rows.append([*case.values.values(), *found, case.state, str(sums.increments), str(sums.iterations),
                     f"{seconds:.3g}"])
    with path.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)
    return rows


def numbers_of(values: list[str]) -> np.ndarray | None:
    """Return values as numbers, None where one is a word."""
    try:
        return np.array([float(value) for value in values])
    except ValueError:
        return None


def draw(path: Path, cases: list[Case], parameters: list[tuple[str, list[str]]], i: int, label: str) -> None:
    """Draw a result over the first parameter with several numbers, a line for each combination of the others."""
    along = next((key for key, values in parameters if len(values) > 1 and numbers_of(values) is not None),
                 parameters[0][0])
    lines: dict[str, list[tuple[str, float]]] = {}
    for case in cases:
        if case.results:
            rest = ", ".join(f"{key} = {value}" for key, value in case.values.items() if key != along)
            lines.setdefault(rest, []).append((case.values[along], case.results[i]))
    figure, axes = new_figure((8, 4.5))
    for rest, points in lines.items():
        x = numbers_of([value for value, _ in points])
        axes.plot(x if x is not None else [value for value, _ in points], [value for _, value in points], "o-",
                  markersize=4, label=rest)
    axes.set(xlabel=along, ylabel=label)
    axes.grid(True, color="0.9")
    if any(lines):
        axes.legend(frameon=False, fontsize="small")
    save(figure, path, 130)


def indices(values: np.ndarray) -> list[tuple[float, float]]:
    """Return first-order and total index of each axis of a table of results, one axis a parameter.

    Source: I. M. Sobol, Math. Modelling Comput. Exp. 1 (1993) 407-414: the parts of the variance, here over the
    combinations.
    """
    total = float(values.var())
    found = []
    for axis in range(values.ndim):
        others = tuple(k for k in range(values.ndim) if k != axis)
        alone = float(values.mean(axis=others).var())
        without = float(values.mean(axis=axis).var())
        found.append((alone / total, 1 - without / total) if total > 0 else (0.0, 0.0))
    return found


def print_indices(cases: list[Case], parameters: list[tuple[str, list[str]]], names: list[str]) -> None:
    """Print the indices of each result."""
    if not all(case.results for case in cases):
        raise Problem("--indices takes results of all combinations; some runs stopped")
    shape = [len(values) for _, values in parameters]
    for i, name in enumerate(names):
        print(f"{name}: part of the variance, alone and with interactions")
        found = indices(np.array([case.results[i] for case in cases if case.results]).reshape(shape))
        for (key, _), (alone, total) in zip(parameters, found):
            print(f"  {key:<20} {alone:6.3f} {total:6.3f}")


def fit_surfaces(work: Path, cases: list[Case], parameters: list[tuple[str, list[str]]], names: list[str],
                 labels: list[str]) -> None:
    """Print and draw the response surface of each result."""
    described = [response.Parameter(name, values, numbers_of(values)) for name, values in parameters]
    ended = [case for case in cases if case.results]
    for i, (name, label) in enumerate(zip(names, labels)):
        places = [case.values for case in ended]
        surface = response.fit(described, places, [case.results[i] for case in ended if case.results])
        print(f"{name}: ", "\n".join(response.describe(surface)), sep="")
        response.draw(work / f"{name.replace(':', '_')}_surface.png", surface, places, label)


def main(words: Sequence[str] | None = None) -> None:
    """Make the study of the command line."""
    words = sys.argv[1:] if words is None else list(words)
    words, further = (words[:words.index("--")], words[words.index("--") + 1:]) if "--" in words else (words, [])
    parser = new_parser("study", __doc__)
    parser.add_argument("deck", type=Path, help="input file")
    parser.add_argument("--vary", nargs="+", type=parameter, required=True, metavar="NAME=VALUES",
                        help="parameter and values: 0.1,0.14 or FIRST:LAST:NUMBER")
    parser.add_argument("--result", nargs="+", type=result, default=[("tool_work", "")], metavar="NAME[:FOLD]",
                        help="column of history.csv or field, with :max, :min or :mean (tool_work)")
    parser.add_argument("--work", type=Path, help="folder of the study (default: the input file's name with .study)")
    add_program(parser)
    parser.add_argument("--cores", type=int, default=os.cpu_count() or 1, metavar="N",
                        help="runs at a time, each with one thread (default: the number of cores)")
    parser.add_argument("--indices", action="store_true", help="print the indices of Sobol")
    parser.add_argument("--surface", action="store_true", help="fit and draw a quadratic response surface")
    options = parser.parse_args(words)
    if options.cores < 1:
        parser.error("--cores takes a positive number")
    options.program = find_program(options.program)
    if not options.deck.is_file():
        raise Problem(f"{options.deck}: no such file")
    work = made_folder(options.work or options.deck.with_suffix(".study"))
    cases = combinations(options.vary, work)
    if further:
        run_by_snakemake(cases, options.program, options.deck, options.cores, work, further)
    else:
        run_all(cases, options.program, options.deck, options.cores)
    labels: list[str] = [""] * len(options.result)
    for case in cases:
        if case.state == "reached":
            case.results, labels = map(list, zip(*(value_of(case.folder, *wanted) for wanted in options.result)))
    names = [f"{name}:{fold}" if fold else name for name, fold in options.result]
    rows = write_table(work / "results.csv", cases, names)
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    for row in rows:
        print("  ".join(word.ljust(width) for word, width in zip(row, widths)).rstrip())
    for i, (name, label) in enumerate(zip(names, labels)):
        draw(work / f"{name.replace(':', '_')}.png", cases, options.vary, i, label)
    if options.indices:
        print_indices(cases, options.vary, names)
    if options.surface:
        fit_surfaces(work, cases, options.vary, names, labels)
    stopped = [case for case in cases if case.state != "reached"]
    if stopped:
        raise Problem(f"{len(stopped)} of {len(cases)} runs did not reach their end; the first: {stopped[0].folder}")
