#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: []
"""The cylindrical cup of AA2090-T3 by Yld2004-18p and by Hill 1948: height of the wall by angle, ears, thickness.

    round_cup.py --program build/release/dd3imp --work build/round_cup            make the runs that are missing
    round_cup.py --program build/release/dd3imp --work build/round_cup --write    and put them into docs/reports

The fine runs take hours; `--only` selects some. An interrupted run is continued.
"""
import sys

import numpy as np
import studies

from dd3.errors import run
from dd3.fields import Fields
from dd3.pages import put_table, table
from dd3.plot.point import r_value
from dd3.programs import run_points
from dd3.run import read_job

DECK, REPORT, PICTURE = studies.paths("round_cup")
BLANK, WALL = 79.375, 49.735  # radii of the blank and of the middle of the wall, mm
ANGLES = np.arange(0, 91, 15)  # of the table, degrees from rolling
CHORD = 0.2  # distance of new nodes of the rim, in the middle of chords, from its circle, at most, mm
LEAST = 0.05  # rise above both neighbouring valleys that makes an ear, mm
MATERIALS = {"Yld2004-18p": "aa2090_t3_yld2004", "Hill 1948": "aa2090_t3_hill48"}
RUNS = [(f"{name} {core} x {ring}", material, f"{core} {ring} 1") for core, ring in ((6, 12), (8, 16), (12, 24))
        for name, material in MATERIALS.items()]


class Cup:
    """Rim of a cup: angles (degrees, initial), heights above the lower face of the bottom, thicknesses (mm)."""

    def __init__(self, folder, blank=BLANK):
        fields = Fields(folder)
        start, now = fields.initial(fields.last), fields.points(fields.last)
        radius, last = np.hypot(start[:, 0], start[:, 1]), fields.last
        rim = np.flatnonzero(radius > blank - CHORD)
        angle = np.degrees(np.arctan2(start[rim, 1], start[rim, 0])).round(6)
        self.angles, column = np.unique(angle, return_inverse=True)
        count = np.bincount(column)
        bottom = now[radius < 1e-6, 2].min()
        self.heights = np.bincount(column, now[rim, 2]) / count - bottom
        thickness, _ = fields.values(last, "thickness")
        self.rim = np.bincount(column, thickness[rim]) / count
        self.thickness = thickness.min(), thickness.max()


def ears(angles, heights):
    """Return the angles of the ears between 0 and 90 degrees; the quarter is continued by its mirror images."""
    whole = np.concatenate([heights[:0:-1], heights, heights[-2::-1]])
    first = len(heights) - 1
    found = []
    for i, angle in enumerate(angles):
        here, left, right = first + i, first + i, first + i
        while left > 0 and whole[left - 1] <= whole[left]:
            left -= 1
        while right < len(whole) - 1 and whole[right + 1] <= whole[right]:
            right += 1
        if min(whole[here] - whole[left], whole[here] - whole[right]) > LEAST:
            found.append(angle)
    return found


def number(found):
    """Return the number of ears of the whole cup."""
    return sum(2 if angle in (0, 90) else 4 for angle in found)


def estimate(program, material):
    """Return heights of the wall by angle, mm, up to a constant: rings under hoop compression only.

    A point at R in the blank comes to the wall and stretches radially by r/(1 + r) ln(R/WALL), with the r-value of
    tension along the circumference.
    """
    text = DECK.read_text(encoding="utf-8").split("*BLANK")[0].split("*INCLUDE")[1]
    text = f"*INCLUDE {DECK.parents[1] / text.split()[0].removeprefix('../')}\n" + text.split("\n", 1)[1]
    angles = np.linspace(0, 90, 31)
    text += "".join(f"*POINT at_{i}\n  material = {material}\n  angle = {90 - angle:g}\n"
                    "  control = e11 s22 s33 s12 s23 s13\n  target = 0.1 0 0 0 0 0 steps=10\n"
                    for i, angle in enumerate(angles))
    _, points = run_points(program, text)
    r = np.array([r_value(rows) for rows in points.values()])
    power = 1 + r / (1 + r)
    return angles, WALL / power * ((BLANK / WALL) ** power - 1)


def draw(cups, estimates):
    """Draw height over angle."""
    figure, axes = studies.new_figure(7, 4)
    for name, cup in cups.items():
        law = next(law for law in MATERIALS if name.startswith(law))
        style = "--" if name.endswith("12") else "-." if name.endswith("16") else "-"
        axes.plot(cup.angles, cup.heights - cup.heights.mean(), label=name, linewidth=1.4,
                  color=f"C{list(MATERIALS).index(law)}", linestyle=style)
    for i, (law, (angles, heights)) in enumerate(estimates.items()):
        axes.plot(angles, heights - heights.mean(), label=f"{law}, estimate by r-values", color=f"C{i}", linewidth=0.9,
                  linestyle=":")
    axes.set(xlabel="angle from rolling, degrees", ylabel="height less its mean, mm", xticks=ANGLES)
    axes.legend(frameon=False, fontsize=8)
    figure.savefig(PICTURE, dpi=110)


def row(name, angles, heights, rest):
    """Return a row of the table of heights: those at ANGLES and their mean round the cup, to which the ends of the
    quarter belong by half; range and ears of all angles of the row."""
    found, at = ears(angles, heights), np.interp(ANGLES, angles, heights)
    return [name, *(f"{value:.2f}" for value in at), f"{(at[1:] + at[:-1]).mean() / 2:.2f}", f"{np.ptp(heights):.2f}",
            str(number(found)), ", ".join(f"{angle:g}" for angle in found), *rest]


def main():
    """Make the runs and the tables."""
    options = studies.arguments(__doc__)
    cups, efforts, jobs = {}, {}, []
    for name, material, divisions in RUNS:
        folder = studies.make(options, name.replace(" ", "_"), DECK,
                              {"material": material, "divisions": divisions, "levels": 0})
        if folder:
            cups[name], efforts[name] = Cup(folder), [studies.increments(folder)]
            jobs.append(read_job(folder))
    estimates = {law: estimate(options.program, material) for law, material in MATERIALS.items()}
    rows = [row(name, cup.angles, cup.heights, efforts[name]) for name, cup in cups.items()]
    rows += [row(f"{law}, estimate", *values, [""]) for law, values in estimates.items()]
    heights = table(["run", *(f"{angle}°" for angle in ANGLES), "mean", "range", "ears", "at, degrees",
                             "increments"], rows)
    thickness = table(["run", "smallest", "largest", "rim, smallest", "rim, largest"],
                              [[name, *(f"{value:.3f}" for value in (*cup.thickness, cup.rim.min(), cup.rim.max()))]
                               for name, cup in cups.items()])
    print(heights, thickness, sep="\n\n")
    if options.write:
        put_table(REPORT, "heights", heights, jobs)
        put_table(REPORT, "thickness", thickness, jobs)
        draw(cups, estimates)
    sys.exit(0 if len(cups) == len(RUNS) else 1)


if __name__ == "__main__":
    run(main)
