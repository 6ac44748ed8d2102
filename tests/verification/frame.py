# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections of the verification manual: their values, studies of refinement, and the runs that give them."""
import importlib.util
import math
import pathlib
import re
import sys
from collections.abc import Callable
from dataclasses import dataclass, field

from dd3.errors import Problem
from dd3.programs import command, launch
from dd3.tables import number, read_table, read_text

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "tests"))
from run_description import check_description  # noqa: E402

VALUE_HEAD = ["quantity", "expected", "computed", "error", "tolerance"]
STUDY_HEAD = ["element", "mesh", "unknowns", "seconds", "computed", "error", "order"]


@dataclass
class Value:
    """A computed value beside the expected one; the tolerance is relative unless `absolute`."""

    quantity: str
    expected: float
    found: float
    tolerance: float
    absolute: bool = False

    def error(self):
        """Return the error in the form of the tolerance."""
        return self.found - self.expected if self.absolute else self.found / self.expected - 1

    def fails(self):
        """Whether the error is larger than the tolerance, or not a number."""
        return not abs(self.error()) <= self.tolerance

    def row(self):
        """Return the cells of the table."""
        error, tolerance = per_cent(self.error()), f"{self.tolerance:g}"
        if self.absolute:
            error = f"{self.error():+.1e}" if self.error() else "0"
        elif self.tolerance >= 1e-5:
            tolerance = f"{100 * self.tolerance:g} %"
        return [self.quantity, f"{self.expected:.6g}", f"{self.found:.6g}", error, tolerance]


@dataclass
class Mesh:
    """A run of a study: element, mesh in words, its element length, and what the run gave."""

    element: str
    mesh: str
    length: float
    unknowns: int
    seconds: float
    expected: float
    found: float

    def error(self):
        """Return the relative error."""
        return self.found / self.expected - 1


@dataclass
class Outcome:
    """What a section gives: values, study, and pictures as pairs of a file name and a function that draws on axes.

    The errors of a study are drawn from its table on the page.
    """

    values: list = field(default_factory=list)
    study: list = field(default_factory=list)
    pictures: list = field(default_factory=list)


@dataclass
class Section:
    """A section of the page: `text` comes before the tables, `after` behind them; file name of the study's picture."""

    heading: str
    text: str
    produce: Callable
    slow: bool = False
    after: str = ""
    picture: str = ""


def per_cent(error):
    """Return a relative error with two digits, in per cent unless it is tiny."""
    if abs(error) < 1e-5:
        return f"{error:+.0e}" if error else "0"
    return f"{100 * error:+.{max(0, 1 - math.floor(math.log10(100 * abs(error))))}f} %"


def study_rows(study):
    """Return the cells of a study: the order is that between a mesh and the one before it, of the same element."""
    rows, before = [], None
    for mesh in study:
        order = ""
        if before and before.element == mesh.element and before.length > mesh.length:
            ratio = before.error() / mesh.error() if mesh.error() else 0.0
            if ratio > 1:  # neither a change of sign nor a larger error
                order = f"{math.log(ratio) / math.log(before.length / mesh.length):.1f}"
        rows.append([f"`{mesh.element}`", mesh.mesh, str(mesh.unknowns), f"{mesh.seconds:.2g}", f"{mesh.found:.6g}",
                     per_cent(mesh.error()), order])
        before = mesh
    return rows


def geometric(number, first, length):
    """Return the places of lines whose distances grow by a factor from the first one."""
    low, high = 1.0, 10.0
    for _ in range(100):
        factor = 0.5 * (low + high)
        low, high = (low, factor) if first * sum(factor**i for i in range(number)) > length else (factor, high)
    places = [first * sum(factor**i for i in range(k)) for k in range(number)]
    return [*places, length]


def load(path):
    """Return the module of a file."""
    spec = importlib.util.spec_from_file_location(f"{path.parent.name}_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


class Run:
    """A finished run: folder of results, history, seconds."""

    def __init__(self, folder, done):
        self.folder, self.path = folder, folder / "history.csv"
        self.history = read_table(self.path)
        self.seconds, self.output = done.cpu, done.output

    def unknowns(self):
        """Return three times the number of nodes."""
        return 3 * int(re.search(r", (\d+) nodes, \d+ candidates", read_text(self.folder / "job.log"))[1])

    def last(self, column, phase=None):
        """Return the value in the last row of a phase, or of the run."""
        rows = [row for row in self.history if phase in (None, row["phase"])]
        return number(rows[-1], column, self.path)

    def column(self, name, phase=None):
        """Return a column, of one phase or of all."""
        return [number(row, name, self.path) for row in self.history if phase in (None, row["phase"])]

    def at(self, column, progress, phase=None):
        """Return a value at a progress of a phase, linear between two increments."""
        return interpolate(self.column("progress", phase), self.column(column, phase), progress)


def interpolate(places, values, place):
    """Return the value at a place among increasing ones, linear between two neighbours."""
    for i in range(len(places)):
        if abs(places[i] - place) < 1e-9:
            return values[i]
        if places[i] > place and i > 0:
            fraction = (place - places[i - 1]) / (places[i] - places[i - 1])
            return values[i - 1] + fraction * (values[i] - values[i - 1])
    raise Problem(f"no value at {place:g}: the run has {places[0]:g} to {places[-1]:g}")


class Bench:
    """The program, and a folder for decks and results."""

    def __init__(self, program, work):
        self.program, self.work = program, work.resolve()
        self.work.mkdir(parents=True, exist_ok=True)

    def run(self, name, deck, settings=None, options=(), timeout=1800):
        """Run a deck, given as a file or as a text, with values of its parameters; it must reach its end."""
        if not isinstance(deck, pathlib.Path):
            file = self.work / f"{name}.dat"
            file.write_text(deck, encoding="utf-8")
            deck = file
        folder = self.work / f"{name}.out"
        done = launch(command(self.program, deck, folder, ["--quiet", *options], settings), timeout=timeout)
        if done.code != 0:
            raise Problem(f"{name}: exit code {done.code}\n{done.output}{done.errors}")
        check_description(folder, done.code)
        return Run(folder, done)
