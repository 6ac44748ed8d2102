#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: []
"""Example input files on meshes that are refined in the run, beside uniform meshes: elements, time, errors.

    examples.py --program build/release/dd3imp --work build/examples            make the runs that are missing
    examples.py --program build/release/dd3imp --work build/examples --write    and put the table into docs/reports

Of each example the input file as it is, the uniform mesh that it had before, and a uniform mesh whose elements have the
length of its smallest ones, the reference; of the hood, whose reference would take hours, one that is refined from
elements half as long. Strips have uniform meshes as they are, and elements half as long in the reference. `--only`
selects examples.
"""
import json
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import studies
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator

from dd3.errors import run
from dd3.pages import put_table, table
from dd3.programs import command, launch
from dd3.run import read_job
from dd3.sheet import Sheet
from dd3.springback import best_fit, find, twist
from dd3.tables import read_table, totals

INPUT = studies.ROOT / "input_files"
REPORT = studies.ROOT / "docs" / "reports" / "examples.md"
NOW, BEFORE, FINE, UNIFORM = "refined", "uniform, before", "uniform, fine", "uniform"
FINE_REFINED = "refined, fine"
BEYOND = 0.075  # part of the travel from which forces are compared
LEAST = 0.05  # least force that is compared at a travel, of the largest one
HEAD = ["example", "mesh", "elements", "increments", "cut-backs", "iterations", "CPU seconds", "of the fine mesh",
        "force, %", "thickness, %", "springback, mm", "springback, %", "shape, mm", "twist, degrees", "warnings"]
SHOWN = ["example", "mesh", "elements", "CPU seconds", "of the fine mesh", "force, %", "thickness, %", "springback, mm",
         "springback, %", "shape, mm"]  # on the page, without the rows of the references


@dataclass
class Example:
    """Input file, divisions of the uniform mesh of before and of the reference, planes of symmetry, parameters of all
    runs, and levels of the reference."""

    deck: str
    before: str
    fine: str
    mirror: tuple[str, ...] = ("x", "y")
    settings: tuple[tuple[str, str], ...] = ()
    levels: str = "0"

    def runs(self):
        """Return the parameters of the runs by their meshes; the last one is the reference."""
        if not self.before:
            return {UNIFORM: {}, FINE: {"divisions": self.fine}}
        return {NOW: {}, BEFORE: {"divisions": self.before, "levels": "0"},
                FINE if self.levels == "0" else FINE_REFINED: {"divisions": self.fine, "levels": self.levels}}


EXAMPLES = {
    "square cup": Example("square_cup/square_cup", "30 30 1", "68 68 1"),
    "square cup, flanged": Example("square_cup/flanged", "25 25 1", "76 76 1"),
    "square cup, aluminium": Example("square_cup/aluminium", "30 30 1", "68 68 1"),
    "round cup": Example("round_cup/round_cup", "6 12 1", "12 24 1"),
    "round cup, AA6016": Example("round_cup_aa6016/round_cup_aa6016", "8 16 1", "32 64 1"),
    "rail, DP600": Example("rail/rail", "30 18 1", "88 56 1", (), (("material", "dp600"),)),
    "rail, DC06": Example("rail/rail", "30 18 1", "88 56 1", (), (("material", "dc06"),)),
    "rail, laid": Example("rail/laid", "30 18 1", "88 56 1", ()),
    "hood": Example("hood/hood", "51 41 1", "76 60 1", levels="1"),
    "hat": Example("hat/hat", "", "400 1 1", ("x",)),
    "draw bending": Example("draw_bending/draw_bending", "", "350 1 1", ("x",)),
}


class Result:
    """A finished run."""

    def __init__(self, folder, cpu, mirror):
        self.folder, self.cpu, self.mirror, self.job = folder, cpu, mirror, read_job(folder)
        self.sheet = Sheet(folder)
        self.found = find(self.sheet, self.job["phases"], mirror)
        drawn = self.found.step if self.found else self.sheet.last
        self.elements = len(self.sheet.corners(self.sheet.last))
        self.thickness = self.sheet.values(drawn, "thickness")[0].min()
        rows = [row for row in read_table(folder / "history.csv") if row["phase"] == "draw"]
        self.travel, self.force = (np.abs([float(row[name]) for row in rows]) for name in ("travel", "punch_fz"))

    def force_against(self, other):
        """Return the largest difference of the punch force from another run's, relative to that one."""
        travels = np.linspace(BEYOND*self.travel[-1], self.travel[-1], 400)
        mine, force = (np.interp(travels, result.travel, result.force) for result in (self, other))
        loaded = force > LEAST*force.max()
        return np.abs(mine[loaded]/force[loaded] - 1).max()

    def free(self):
        """Return the middle of the columns of nodes in the blank along x and y, and of the free sheet, mm."""
        start, end = (middle(points) for points in (self.sheet.initial(self.sheet.last),
                                                    self.sheet.points(self.sheet.last)))
        return start[:, :2], end

    def distance_to(self, other):
        """Return the largest distance of the free sheet from another run's, moved to the best fit, mm."""
        start, mine = self.free()
        place, theirs = other.free()
        target = LinearNDInterpolator(place, theirs)(start)
        outside = np.isnan(target[:, 0])
        target[outside] = NearestNDInterpolator(place, theirs)(start[outside])
        return np.linalg.norm(best_fit(mine, target, self.mirror) - target, axis=1).max()


def middle(points):
    """Return the positions of the middle surface, the mean of the lower and the upper face."""
    return points.reshape(-1, 2, 3).mean(axis=1)


def make(options, name, mesh, example, settings):
    """Make a run unless it is there; return it, None if it is not wanted or has stopped."""
    folder = options.work / f"{name}_{mesh}".replace(", ", "_").replace(" ", "_")
    note = Path(f"{folder}.json")
    if not (note.is_file() and studies.is_finished(folder)):
        if options.only and name not in options.only:
            return None
        print(f"{name}: {mesh}", flush=True)
        done = launch(command(options.program, INPUT / f"{example.deck}.dat", folder, ["--quiet"],
                              {**dict(example.settings), **settings}))
        if done.code != 0:
            print(f"{name}, {mesh}: exit code {done.code}: {done.errors}", flush=True)
            return None
        note.write_text(json.dumps({"cpu": done.cpu}), encoding="utf-8")
    return Result(folder, json.loads(note.read_text(encoding="utf-8"))["cpu"], example.mirror)


def row_of(name, mesh, result, fine):
    """Return the row of a run; without differences if the reference is not there."""
    total = totals(read_table(result.folder / "status.csv"))
    words = [name, mesh, str(result.elements), str(total.increments), str(total.cutbacks), str(total.iterations),
             f"{result.cpu:.0f}", f"{result.cpu/fine.cpu:.2f}" if fine else ""]
    other = fine if fine is not result else None
    if other:
        words += [f"{100*value:.2f}" for value in (result.force_against(other), result.thickness/other.thickness - 1)]
    else:
        words += ["", ""]
    if result.found:
        largest, turned = result.found.distance().max(), twist(result.sheet, result.found)
        words += [f"{largest:.3f}", f"{100*(largest/other.found.distance().max() - 1):+.1f}" if other else "",
                  f"{result.distance_to(other):.3f}" if other else "", f"{turned[1]:.2f}" if turned else ""]
    else:
        words += ["", "", "", ""]
    return [*words, ", ".join(sorted({warning["code"] for warning in result.job["warnings"]}))]


def main():
    """Make the runs and the table."""
    options = studies.arguments(__doc__)
    rows, jobs, complete = [], [], True
    for name, example in EXAMPLES.items():
        results = {mesh: make(options, name, mesh, example, settings) for mesh, settings in example.runs().items()}
        complete = complete and all(results.values())
        fine = list(results.values())[-1]
        rows += [row_of(name, mesh, result, fine) for mesh, result in results.items() if result]
        jobs += [result.job for result in results.values() if result]
    print(table(HEAD, rows))
    if options.write and rows:
        places = [HEAD.index(title) for title in SHOWN]
        put_table(REPORT, "examples", table(SHOWN, [[row[place] for place in places] for row in rows
                                                            if row[1] not in (FINE, FINE_REFINED)]), jobs)
    sys.exit(0 if complete else 1)


if __name__ == "__main__":
    run(main)
