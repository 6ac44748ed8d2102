#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The S-shaped rail: springback of its inner flanges and twist, by mesh.

    rail.py --program build/release/dd3imp --work build/rail            make the runs that are missing
    rail.py --program build/release/dd3imp --work build/rail --write    and put them into docs/reports

The finest run takes 20 minutes; `--only` selects some. An interrupted run is continued.
"""
import sys

import numpy as np
import studies

from dd3.errors import run
from dd3.fields import Fields
from dd3.pages import put_table

DECK, REPORT, PICTURE = studies.paths("rail")
DEPTH, BOTTOM, FLANGE = 20.0, 10.0, 21.0  # stroke; half width of the bottom, start of the flange beside the middle, mm
OFFSET = 10.0480947162  # of the straight ends from the middle, mm
STATION, REACH = 60.0, 8.0  # middle and half length of the piece of a straight end that is measured, mm
RUNS = [("20 x 12", "20 12 1"), ("30 x 18", "30 18 1"), ("40 x 24", "40 24 1"), ("60 x 36", "60 36 1"),
        ("90 x 54", "90 54 1")]


class Rail:
    """Positions of the middle surface at the end of the draw and after springback."""

    def __init__(self, folder):
        fields = Fields(folder)
        drawn = int(np.flatnonzero(np.abs(fields.travel - DEPTH) < 1e-7)[0])
        self.drawn, self.free = (middle(fields, step) for step in (drawn, fields.count - 1))
        start = middle(fields, 0)
        self.shape = tuple(len(np.unique(start[:, axis].round(6))) for axis in (0, 1))

    def slopes(self, points, side):
        """Return the slopes dz/dy of an end's bottom and of its flange on the inside of the nearer arc, degrees."""
        along = np.abs(self.drawn[:, 0] - side*STATION) < REACH
        across = self.drawn[:, 1] - side*OFFSET
        return [slope(points[along & part]) for part in (np.abs(across) < BOTTOM, side*across < -FLANGE)]

    def springback(self, side):
        """Return the rotations from the end of the draw, degrees: of the bottom, and of the flange against it,
        positive if it rises."""
        before, after = (np.array(self.slopes(points, side)) for points in (self.drawn, self.free))
        bottom, flange = after - before
        return bottom, -side*(flange - bottom)

    def section(self, points):
        """Return y and z of the node line nearest to the station at larger x."""
        grid = points.reshape(*self.shape, 3)
        line = grid[np.abs(grid[:, self.shape[1]//2, 0] - STATION).argmin()]
        return line[:, 1], line[:, 2]


def middle(fields, step):
    """Return the positions of the middle surface, the mean of the lower and the upper face."""
    return fields.points(step).reshape(-1, 2, 3).mean(axis=1)


def slope(points):
    """Return the slope of the plane of least squares along y, degrees."""
    if len(points) < 3:
        return np.nan
    system = np.column_stack([points[:, :2], np.ones(len(points))])
    return np.degrees(np.arctan(np.linalg.lstsq(system, points[:, 2], rcond=None)[0][1]))


def draw(rails):
    """Draw the section of an end before and after springback."""
    figure, axes = studies.new_figure(7, 3.6)
    for i, (name, rail) in enumerate(rails.items()):
        for points, style, state in ((rail.drawn, "--", "drawn"), (rail.free, "-", "free")):
            axes.plot(*rail.section(points), style, color=f"C{i}", label=f"{name}, {state}", linewidth=1.2)
    axes.set(xlabel="y, mm", ylabel="z, mm", aspect="equal")
    axes.legend(frameon=False, fontsize=8)
    figure.savefig(PICTURE, dpi=110)


def main():
    """Make the runs and the table."""
    options = studies.arguments(__doc__)
    rails, rows = {}, []
    for name, divisions in RUNS:
        folder = studies.make(options, name.replace(" ", "_"), DECK, {"divisions": divisions})
        if not folder:
            continue
        rails[name] = Rail(folder)
        right, left = (rails[name].springback(side) for side in (1, -1))
        values = right[1], left[1], right[0], left[0], right[0] - left[0]
        rows.append([name, *(f"{value:.2f}" for value in values), *studies.effort(folder)])
    text = studies.table(["mesh", "flange, x = 60", "flange, x = -60", "bottom, x = 60", "bottom, x = -60", "twist",
                          "increments", "iterations", "seconds"], rows)
    print(text)
    if options.write:
        put_table(REPORT, "springback", text)
        draw(rails)
    sys.exit(0 if len(rails) == len(RUNS) else 1)


if __name__ == "__main__":
    run(main)
