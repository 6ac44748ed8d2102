#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: []
"""The square cup of NUMISHEET'93, steel and aluminium, by several meshes and elements: draw-in, force and thickness.

    square_cup.py --program build/release/dd3imp --work build/square_cup            make the runs that are missing
    square_cup.py --program build/release/dd3imp --work build/square_cup --write    and put them into docs/reports
"""
import math
import re
import sys
from pathlib import Path

import numpy as np
import studies

from dd3.errors import run
from dd3.fields import Fields
from dd3.pages import places, put_table, table
from dd3.run import read_job
from dd3.tables import interpolate, read_table

DECK, REPORT, PICTURE = studies.paths("square_cup")
ALUMINIUM = DECK.with_name("aluminium.dat")
SIZE = 75.0  # of the quarter, mm
TRAVELS = (15.0, 40.0)
FINE_ALUMINIUM = "aluminium 30 x 30"
ISOTROPIC = "aluminium 30 x 30, von Mises"
# Name of the run, elements along a side, through the thickness, element, points.
RUNS = [("solid_shell 15 x 15", 15, 1, "solid_shell", 5), ("solid_shell 20 x 20", 20, 1, "solid_shell", 5),
        ("solid_shell 30 x 30", 30, 1, "solid_shell", 5), ("solid_shell 45 x 45", 45, 1, "solid_shell", 5),
        ("solid_shell 60 x 60", 60, 1, "solid_shell", 5),
        ("hex8 30 x 30 x 2", 30, 2, "hex8", 0), ("hex8 30 x 30 x 3", 30, 3, "hex8", 0),
        ("aluminium 15 x 15", 15, 1, "solid_shell", 5), (FINE_ALUMINIUM, 30, 1, "solid_shell", 5),
        ("aluminium 45 x 45", 45, 1, "solid_shell", 5), (ISOTROPIC, 30, 1, "solid_shell", 5)]
STEPS = range(5, 41, 5)  # travels of the tables of the forces and of the aluminium sheet, mm
PLACES = (20.0, 40.0, 50.0, 60.0, 70.0, 80.0, 100.0)  # along the diagonal of the blank, mm from the centre
# Draw-in of the aluminium sheet at TRAVELS, mm: DX, DY as one value, DD; repository of DEFORM-3D's documentation,
# Sheet Forming in DEFORM 3D, Table 1. Its simulation has an isotropic criterion.
PUBLISHED = {"measured, averages": (5.3, 3.3, 28.5, 15.0), "DEFORM-3D": (5.5, 3.3, 26.9, 15.5)}


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

    def thicknesses(self, travel):
        """Return the thickness at the columns of nodes, mm."""
        values, _ = self.fields.values(self.fields.nearest_step(travel), "thickness")
        return values.reshape(self.shape).mean(axis=2)

    def thickness(self, travel):
        """Return the thickness at the nodes of the diagonal, mm."""
        return self.thicknesses(travel)[self.diagonal]

    def extremes(self, travel):
        """Return the smallest and the largest thickness of the whole sheet, mm, and their initial places, as texts."""
        values = self.thicknesses(travel)
        found = []
        for index in (values.argmin(), values.argmax()):
            i, j = np.unravel_index(index, values.shape)
            found += [f"{values[i, j]:.3f}", f"{SIZE*i/(len(values) - 1):.0f}, {SIZE*j/(len(values) - 1):.0f}"]
        return found

    def forces(self):
        """Return the force of the punch on the quarter at STEPS, kN."""
        history = read_table(self.folder / "history.csv")
        travel, force = ([float(row[name]) for row in history] for name in ("travel", "punch_fz"))
        return [abs(interpolate(travel, force, step))/1000 for step in STEPS]


def course(cup):
    """Return the rows of a cup's draw: travel, DX, DD, smallest thickness, mm, and punch force, kN."""
    for step, force in zip(STEPS, cup.forces()):
        dx, _, dd = cup.draw_in(step)
        yield [f"{step}", f"{dx:.2f}", f"{dd:.2f}", f"{cup.thicknesses(step).min():.3f}", f"{force:.1f}"]


def beside_published(cups):
    """Return the rows of draw-in of the aluminium sheet: values and their differences from the measured ones, %."""
    measured, *_ = PUBLISHED.values()
    found = dict(PUBLISHED)
    for name, cup in cups.items():
        if name.startswith("aluminium"):
            early, late = (cup.draw_in(travel) for travel in TRAVELS)
            found[name.removeprefix("aluminium ")] = ((early[0] + early[1])/2, early[2], (late[0] + late[1])/2, late[2])
    return [[name, *(f"{value:.1f}" + (f" ({100*(value/exact - 1):+.0f} %)" if values is not measured else "")
                     for value, exact in zip(values, measured))] for name, values in found.items()]


def draw(cups):
    """Draw the thickness along the diagonal at the end."""
    figure, axes = studies.new_figure(7, 4)
    for name, cup in cups.items():
        axes.plot(cup.place, cup.thickness(TRAVELS[-1]), label=name, linewidth=1.2,
                  linestyle="--" if name.startswith("hex8") else "-")
    axes.set(xlabel="initial distance from the centre along the diagonal, mm", ylabel="thickness, mm")
    axes.legend(frameon=False)
    figure.savefig(PICTURE, dpi=110)


def deck_of(options, name, settings):
    """Return the input file of a run; `hex8` has no points through the thickness, ISOTROPIC another criterion."""
    deck = ALUMINIUM if name.startswith("aluminium") else DECK
    if name != ISOTROPIC and not name.startswith("hex8"):
        return deck
    settings["tools"] = DECK.parent
    text = deck.read_text(encoding="utf-8").replace("../", f"{DECK.parents[1]}/")
    if name == ISOTROPIC:
        line = text[text.index("*INCLUDE"):].split("\n", 1)[0]
        material = Path(line.split()[1]).read_text(encoding="utf-8")
        text = text.replace(line, re.sub(r"yield = .*", "yield = von_mises", material))
    else:
        text = text.replace("  thickness_points = ${points}\n", "")
    changed = options.work / f"{name.split(',')[0].replace(' ', '_')}_deck.dat"
    changed.write_text(text, encoding="utf-8")
    return changed


def runs(options):
    """Make the runs; return the cups by name."""
    cups = {}
    for name, across, layers, element, points in RUNS:
        settings = {"divisions": f"{across} {across} {layers}", "levels": 0, "element": element}
        if points:
            settings["points"] = points
        folder = studies.make(options, name.replace(", ", "_").replace(" ", "_"), deck_of(options, name, settings),
                              settings)
        if folder:
            cups[name] = Cup(folder, across, layers)
    return cups


def tables(cups):
    """Return the tables of the page by name."""
    end = TRAVELS[-1]
    found = {
        "draw-in": table(
            ["mesh"] + [f"{quantity} at {travel:g} mm" for travel in TRAVELS for quantity in ("DX", "DY", "DD")]
            + ["increments"],
            [[name] + [f"{value:.2f}" for travel in TRAVELS for value in cup.draw_in(travel)]
             + [studies.increments(cup.folder)] for name, cup in cups.items()]),
        "force": table(
            ["mesh", *(f"{step} mm" for step in STEPS)],
            [[name, *(f"{force:.2f}" for force in cup.forces())] for name, cup in cups.items()]),
        "thickness": table(
            ["mesh", *(f"{place:g}" for place in PLACES), "smallest", "at", "largest", "at"],
            [[name, *(f"{value:.3f}" for value in np.interp(PLACES, cup.place, cup.thickness(end))), *cup.extremes(end)]
             for name, cup in cups.items()]),
        "measured": table(
            ["", *(f"{quantity} at {travel:g} mm" for travel in TRAVELS for quantity in ("DX, DY", "DD"))],
            beside_published(cups))}
    if FINE_ALUMINIUM in cups:
        found["aluminium"] = table(["travel, mm", "DX, mm", "DD, mm", "smallest thickness, mm",
                                            "punch force on the quarter, kN"], course(cups[FINE_ALUMINIUM]))
    return found


def main():
    """Make the runs and the tables."""
    options = studies.arguments(__doc__)
    cups = runs(options)
    found = tables(cups)
    print(*found.values(), sep="\n\n")
    if options.write:
        for name in found.keys() & places(REPORT):
            put_table(REPORT, name, found[name], [read_job(cup.folder) for cup in cups.values()])
        draw(cups)
    sys.exit(0 if len(cups) == len(RUNS) else 1)


if __name__ == "__main__":
    run(main)
