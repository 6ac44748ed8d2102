#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: []
"""The square cup on a mesh that is refined in the run beside uniform meshes: elements, time, force, draw-in, thickness.

    adaptive.py --program build/release/dd3imp --work build/adaptive            make the runs that are missing
    adaptive.py --program build/release/dd3imp --work build/adaptive --write    and put the tables into docs/reports
"""
import json
import math
import sys
from pathlib import Path

import numpy as np
import studies

from dd3.errors import run
from dd3.fields import Fields
from dd3.pages import put_table, table
from dd3.programs import command, launch
from dd3.run import read_job
from dd3.tables import interpolate, read_table, totals

DECK = studies.ROOT / "input_files" / "square_cup" / "square_cup.dat"
REPORT = studies.ROOT / "docs" / "reports" / "adaptive.md"
SIZE, DEPTH = 75.0, 40.0  # of the quarter, travel of the punch, mm
POINTS = 3  # through the thickness
# Name of the run, elements along a side, levels.
ADAPTIVE, FINE = "15 x 15, two levels", "60 x 60"
RUNS = [(ADAPTIVE, 15, 2), (FINE, 60, 0), ("30 x 30", 30, 0), ("15 x 15", 15, 0)]
PARTS = (0.0, 0.25, 0.5, 1.0)  # of the travel, for the numbers of elements
STEPS = (1, 3, 5, 10, 20, 30, 40)  # travels of the forces, mm
BEYOND = 3.0  # travel from which forces are compared, mm
SHAPES = (20.0, 40.0)  # travels of draw-in and thickness, mm
NEAR = 1e-6  # mm


class Cup:
    """Results of a run.

    cpu: its processor time, s.
    """

    def __init__(self, folder, cpu):
        self.folder, self.cpu, self.fields = folder, cpu, Fields(folder)
        history = read_table(folder / "history.csv")
        self.travel, self.force = ([float(row[name]) for row in history] for name in ("travel", "punch_fz"))

    def elements(self, part):
        """Return the number of elements at a part of the travel."""
        return self.fields.size_of("Cells", self.fields.nearest_step(part*DEPTH))

    def force_at(self, travel):
        """Return the force of the punch on the quarter, kN."""
        return abs(interpolate(self.travel, self.force, travel))/1000

    def column(self, step, x, y):
        """Return the place of the middle of a column of nodes, given that in the blank, mm."""
        initial = self.fields.initial(step)
        found = np.hypot(initial[:, 0] - x, initial[:, 1] - y) < NEAR
        return self.fields.points(step)[found].mean(axis=0)

    def draw_in(self, travel):
        """Return DX, DY and DD, mm."""
        step = self.fields.nearest_step(travel)
        return [SIZE - self.column(step, SIZE, 0)[0], SIZE - self.column(step, 0, SIZE)[1],
                math.sqrt(2)*SIZE - math.hypot(*self.column(step, SIZE, SIZE)[:2])]

    def thickness(self, travel):
        """Return the smallest thickness, mm."""
        return self.fields.values(self.fields.nearest_step(travel), "thickness")[0].min()

    def largest_difference(self, other):
        """Return the largest difference from the force of another run, relative to that, and its travel, mm."""
        differences = [(abs(self.force_at(travel)/other.force_at(travel) - 1), travel)
                       for travel in np.arange(BEYOND, DEPTH + NEAR, 0.25)]
        return max(differences)


def make(options, name, across, levels):
    """Make a run unless it is there; return it, None if it is not wanted or has stopped.

    A run that was interrupted begins anew: its processor time is wanted.
    """
    folder = options.work / name.replace(", ", "_").replace(" ", "_")
    note = Path(f"{folder}.json")
    if not (note.is_file() and studies.is_finished(folder)):
        if options.only and name not in options.only:
            return None
        print(name, flush=True)
        settings = {"divisions": f"{across} {across} 1", "levels": levels, "points": POINTS, "depth": DEPTH}
        done = launch(command(options.program, DECK, folder, ["--quiet"], settings))
        if done.code != 0:
            print(f"{name}: exit code {done.code}: {done.errors}", flush=True)
            return None
        note.write_text(json.dumps({"cpu": done.cpu}), encoding="utf-8")
    return Cup(folder, json.loads(note.read_text(encoding="utf-8"))["cpu"])


def effort(cup, fine):
    """Return the elements at PARTS, attempts that were repeated on a finer mesh, increments, iterations and time."""
    status = read_table(cup.folder / "status.csv")
    total = totals(status)
    return [*(str(cup.elements(part)) for part in PARTS),
            str(sum(row["outcome"] == "refined" for row in status)), str(total.increments), str(total.iterations),
            f"{cup.cpu:.0f}", f"{cup.cpu/fine.cpu:.2f}"]


def beside(value, exact, digits):
    """Return a value and its difference from another one."""
    return f"{value:.{digits}f} ({100*(value/exact - 1):+.1f} %)"


def tables(cups):
    """Return the tables of the page by name."""
    fine = cups[FINE]
    shape = [f"{quantity} at {travel:g} mm" for travel in SHAPES for quantity in ("DX", "DY", "DD", "thickness")]
    shapes = {name: [value for travel in SHAPES for value in (*cup.draw_in(travel), cup.thickness(travel))]
              for name, cup in cups.items()}
    differences = {name: cup.largest_difference(fine) for name, cup in cups.items()}
    return {
        "effort": table(
            ["mesh", *(f"elements at {part:.0%}".replace("%", " %") for part in PARTS), "repeated", "increments",
             "iterations", "CPU seconds", "of 60 x 60"],
            [[name, *effort(cup, fine)] for name, cup in cups.items()]),
        "force": table(
            ["mesh", *(f"{step} mm" for step in STEPS), f"largest difference beyond {BEYOND:g} mm"],
            [[name, *(f"{cup.force_at(step):.3f}" for step in STEPS),
              "" if cup is fine else f"{100*differences[name][0]:.1f} % at {differences[name][1]:.1f} mm"]
             for name, cup in cups.items()]),
        "shape": table(
            ["mesh", *shape],
            [[name, *(f"{value:.3f}" if cup is fine else beside(value, exact, 3)
                      for value, exact in zip(shapes[name], shapes[FINE]))] for name, cup in cups.items()])}


def main():
    """Make the runs and the tables."""
    options = studies.arguments(__doc__)
    cups = {name: cup for name, across, levels in RUNS if (cup := make(options, name, across, levels))}
    if FINE in cups:
        found = tables(cups)
        print(*found.values(), sep="\n\n")
        if options.write:
            for name, text in found.items():
                put_table(REPORT, name, text, [read_job(cup.folder) for cup in cups.values()])
    sys.exit(0 if len(cups) == len(RUNS) else 1)


if __name__ == "__main__":
    run(main)
