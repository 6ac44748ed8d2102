#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: []
"""The square cup of NUMISHEET'93, steel and aluminium, by several meshes and elements: draw-in and thickness.

    square_cup.py --program build/release/dd3imp --work build/square_cup            make the runs that are missing
    square_cup.py --program build/release/dd3imp --work build/square_cup --write    and put them into docs/reports
"""
import math
import sys

import numpy as np
import studies

from dd3.errors import run
from dd3.fields import Fields
from dd3.pages import put_table
from dd3.run import read_job
from dd3.tables import interpolate, read_table

DECK, REPORT, PICTURE = studies.paths("square_cup")
ALUMINIUM = DECK.with_name("aluminium.dat")
SIZE = 75.0  # of the quarter, mm
TRAVELS = (15.0, 40.0)
FINE_ALUMINIUM = "aluminium 30 x 30"
# Name of the run, elements along a side, through the thickness, element, points.
RUNS = [("solid_shell 15 x 15", 15, 1, "solid_shell", 5), ("solid_shell 20 x 20", 20, 1, "solid_shell", 5),
        ("solid_shell 30 x 30", 30, 1, "solid_shell", 5), ("solid_shell 45 x 45", 45, 1, "solid_shell", 5),
        ("hex8 30 x 30 x 2", 30, 2, "hex8", 0), ("hex8 30 x 30 x 3", 30, 3, "hex8", 0),
        ("aluminium 15 x 15", 15, 1, "solid_shell", 5), (FINE_ALUMINIUM, 30, 1, "solid_shell", 5)]
STEPS = range(5, 41, 5)  # travels of the table of the aluminium sheet, mm
PLACES = (20.0, 40.0, 50.0, 60.0, 70.0, 80.0, 100.0)  # along the diagonal of the blank, mm from the centre


class Cup:
    """Results of a run."""

    def __init__(self, folder, across, layers):
        self.folder, self.fields = folder, Fields(folder)
        self.shape = (across + 1, across + 1, layers + 1)
        diagonal = np.arange(across + 1)
        self.diagonal = (diagonal, diagonal)
        self.place = np.linspace(0, math.sqrt(2)*SIZE, across + 1)

    def draw_in(self, travel):
        """Return DX, DY and DD, mm."""
        middle = self.fields.points(self.fields.nearest_step(travel)).reshape(*self.shape, 3).mean(axis=2)
        return [SIZE - middle[-1, 0, 0], SIZE - middle[0, -1, 1], math.sqrt(2)*SIZE - math.hypot(*middle[-1, -1, :2])]

    def thickness(self, travel):
        """Return the thickness at the nodes of the diagonal, mm."""
        values, _ = self.fields.values(self.fields.nearest_step(travel), "thickness")
        return values.reshape(self.shape).mean(axis=2)[self.diagonal]


def course(cup):
    """Return the rows of a cup's draw: travel, DX, DD, smallest thickness, mm, and punch force, kN."""
    history = read_table(cup.folder / "history.csv")
    travel, force = ([float(row[name]) for row in history] for name in ("travel", "punch_fz"))
    for step in STEPS:
        dx, _, dd = cup.draw_in(step)
        thickness, _ = cup.fields.values(cup.fields.nearest_step(step), "thickness")
        yield [f"{step}", f"{dx:.2f}", f"{dd:.2f}", f"{thickness.min():.3f}",
               f"{abs(interpolate(travel, force, step))/1000:.1f}"]


def draw(cups):
    """Draw the thickness along the diagonal at the end."""
    figure, axes = studies.new_figure(7, 4)
    for name, cup in cups.items():
        axes.plot(cup.place, cup.thickness(TRAVELS[-1]), label=name, linewidth=1.2,
                  linestyle="--" if name.startswith("hex8") else "-")
    axes.set(xlabel="initial distance from the centre along the diagonal, mm", ylabel="thickness, mm")
    axes.legend(frameon=False)
    figure.savefig(PICTURE, dpi=110)


def main():
    """Make the runs and the tables."""
    options = studies.arguments(__doc__)
    cups, efforts = {}, {}
    for name, across, layers, element, points in RUNS:
        settings = {"divisions": f"{across} {across} {layers}", "element": element}
        deck = ALUMINIUM if name.startswith("aluminium") else DECK
        if points:
            settings["points"] = points
        else:
            deck = options.work / "square_cup_hex8.dat"
            settings["tools"] = DECK.parent
            text = DECK.read_text(encoding="utf-8").replace("  thickness_points = ${points}\n", "")
            deck.write_text(text.replace("../", f"{DECK.parents[1]}/"), encoding="utf-8")
        folder = studies.make(options, name.replace(" ", "_"), deck, settings)
        if folder:
            cups[name], efforts[name] = Cup(folder, across, layers), studies.effort(folder)
    draw_in = studies.table(
        ["mesh"] + [f"{quantity} at {travel:g} mm" for travel in TRAVELS for quantity in ("DX", "DY", "DD")]
        + ["increments", "iterations", "seconds"],
        [[name] + [f"{value:.2f}" for travel in TRAVELS for value in cup.draw_in(travel)] + efforts[name]
         for name, cup in cups.items()])
    thickness = studies.table(
        ["mesh"] + [f"{place:g}" for place in PLACES] + ["smallest", "largest"],
        [[name] + [f"{value:.3f}" for value in
                   [*np.interp(PLACES, cup.place, cup.thickness(TRAVELS[-1])), cup.thickness(TRAVELS[-1]).min(),
                    cup.thickness(TRAVELS[-1]).max()]] for name, cup in cups.items()])
    tables = {"draw-in": draw_in, "thickness": thickness}
    if FINE_ALUMINIUM in cups:
        tables["aluminium"] = studies.table(["travel, mm", "DX, mm", "DD, mm", "smallest thickness, mm",
                                             "punch force on the quarter, kN"], course(cups[FINE_ALUMINIUM]))
    print(*tables.values(), sep="\n\n")
    if options.write:
        for name, text in tables.items():
            put_table(REPORT, name, text, [read_job(cup.folder) for cup in cups.values()])
        draw(cups)
    sys.exit(0 if len(cups) == len(RUNS) else 1)


if __name__ == "__main__":
    run(main)
