# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of scripts that test: deck and command in, values of the history out, compared within tolerances."""
import math
import pathlib
import re
from dataclasses import dataclass

from run_description import check_description

from dd3.errors import Problem
from dd3.programs import command, launch
from dd3.tables import number, read_table, read_text


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


def check_values(*values):
    """Print values; a Problem names those beyond their tolerance."""
    wrong = [value for value in values if value.fails()]
    for value in values:
        quantity, expected, found, error, tolerance = value.row()
        print(f"{quantity}: {found}, expected {expected}, error {error}, tolerance {tolerance}", flush=True)
    if wrong:
        raise Problem("\n".join(f"{value.quantity}: {value.found:.9g}, expected {value.expected:.9g}, tolerance "
                                f"{value.row()[4]}" for value in wrong))


def per_cent(error):
    """Return a relative error with two digits, in per cent unless it is tiny."""
    if abs(error) < 1e-5:
        return f"{error:+.0e}" if error else "0"
    return f"{100 * error:+.{max(0, 1 - math.floor(math.log10(100 * abs(error))))}f} %"


class Run:
    """A finished run: folder of results, history, run.json, which is checked, seconds, and what it printed."""

    def __init__(self, folder, done):
        self.folder, self.path = folder, folder / "history.csv"
        self.history, self.job = read_table(self.path), check_description(folder, done.code)
        self.seconds, self.output, self.errors, self.code = done.cpu, done.output, done.errors, done.code

    def unknowns(self):
        """Return three times the number of nodes."""
        return 3 * int(re.search(r", (\d+) nodes, \d+ candidates", read_text(self.folder / "job.log"))[1])

    def row(self, phase=None):
        """Return the last row of a phase, or of the run."""
        return [row for row in self.history if phase in (None, row["phase"])][-1]

    def last(self, column, phase=None):
        """Return the value in the last row of a phase, or of the run."""
        return number(self.row(phase), column, self.path)

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

    def run(self, name, deck, settings=None, options=(), timeout=1800, codes=(0,)):
        """Run a deck, a file or a text, with values of its parameters; its exit code must be one of `codes`."""
        if not isinstance(deck, pathlib.Path):
            file = self.work / f"{name}.dat"
            file.write_text(deck, encoding="utf-8")
            deck = file
        folder = self.work / f"{name}.out"
        done = launch(command(self.program, deck, folder, ["--quiet", *options], settings), timeout=timeout)
        if done.code not in codes:
            raise Problem(f"{name}: exit code {done.code}\n{done.output}{done.errors}")
        return Run(folder, done)

    def refuse(self, name, deck, output=None):
        """Return what the program says of a deck that it must refuse with exit code 2, without results.

        `output` is their folder, empty for that of the deck.
        """
        file = self.work / f"{name}.dat"
        file.write_text(deck, encoding="utf-8")
        folder = self.work / f"{name}.out"
        done = launch(command(self.program, file, folder if output is None else output, ["--quiet"]), timeout=300)
        if done.code != 2 or folder.exists():
            raise Problem(f"{name}: exit code {done.code}, expected 2 and no results\n{done.output}{done.errors}")
        return done.output + done.errors
