#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: []
"""The S-shaped rail: springback, twist and thinning by mesh and material.

    rail.py --program build/release/dd3imp --work build/rail            make the runs that are missing
    rail.py --program build/release/dd3imp --work build/rail --write    and put them into docs/reports

The finest runs take half an hour each; `--only` selects some. An interrupted run is continued.
"""
import sys

import numpy as np
import studies

from dd3.errors import run
from dd3.pages import put_table, table
from dd3.run import read_job
from dd3.sheet import Sheet
from dd3.springback import best_fit, find, twist

DECK, REPORT, PICTURE = studies.paths("rail")
BOTTOM, FLANGE = 10.0, 21.0  # half width of the bottom, start of the flange beside the middle, mm
OFFSET = 10.0480947162  # of the straight ends from the middle, mm
STATION, REACH = 60.0, 8.0  # middle and half length of the piece of a straight end that is measured, mm
THICKNESS = 0.8
MESHES = ["28 16", "54 32", "80 32", "54 64", "54 128"]  # along and across the rail; the finest last
HEAD = ["material", "mesh", "elements", "flange", "bottom", "twist at 60 mm", "twist, 10 to 90 %", "largest distance, mm",
        "free shape from the finest's, mm: rms, largest", "thinning, %",
        "from the finest's, %: rms, largest", "opposite nodes, %", "increments"]


class Rail:
    """Positions of the middle surface at the end of the draw and after springback."""

    def __init__(self, folder):
        self.sheet = Sheet(folder)
        self.phases = read_job(folder)["phases"]
        self.found = find(self.sheet, self.phases)
        self.drawn, self.free = (middle(points) for points in (self.found.drawn, self.sheet.points(self.sheet.last)))
        start = middle(self.sheet.points(0))
        self.shape = tuple(len(np.unique(start[:, axis].round(6))) for axis in (0, 1))

    def thinning(self):
        """Return the thinning at the cells along x and y, per cent."""
        values = 100 * self.sheet.values(self.sheet.last, "thinning", True)[0]
        centres = self.sheet.points(0)[self.sheet.corners(0)].mean(axis=1)
        return values[np.lexsort((centres[:, 1].round(6), centres[:, 0].round(6)))].reshape(np.array(self.shape) - 1)

    def thinning_by_nodes(self):
        """Return the thinning by the distance of opposite nodes, per cent."""
        points = self.sheet.points(self.sheet.last).reshape(-1, 2, 3)
        return 100 * (1 - np.linalg.norm(points[:, 1] - points[:, 0], axis=1) / THICKNESS)

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

    def free_grid(self):
        """Return the positions of the free middle surface, along x and y of the blank, mm."""
        start = middle(self.sheet.points(0))
        return self.free[np.lexsort((start[:, 1].round(6), start[:, 0].round(6)))].reshape(*self.shape, 3)


def middle(points):
    """Return the positions of the middle surface, the mean of the lower and the upper face."""
    return points.reshape(-1, 2, 3).mean(axis=1)


def resampled(grid, shape):
    """Return values at the nodes of one mesh at those of another, linear in between."""
    for axis, n in enumerate(shape):
        old, new = (np.linspace(0, 1, m) for m in (grid.shape[axis], n))
        grid = np.apply_along_axis(lambda line, old=old, new=new: np.interp(new, old, line), axis, grid)
    return grid


def at_cells(values, shape):
    """Return values at the cells of one mesh at those of another, linear in between."""
    for axis, n in enumerate(shape):
        old, new = ((np.arange(m) + 0.5) / m for m in (values.shape[axis], n))
        values = np.apply_along_axis(lambda line, old=old, new=new: np.interp(new, old, line), axis, values)
    return values


def extremes(values):
    """Return the smallest and the largest value as text."""
    return f"{values.min():.2f} to {values.max():.2f}"


def of_differences(values):
    """Return the root mean square and the largest magnitude as text."""
    return f"{np.sqrt((values**2).mean()):.2f}, {np.abs(values).max():.2f}"


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


def row_of(material, mesh, rail, finest, folder):
    """Return the row of a run."""
    bottom, flange = rail.springback(1)
    difference = rail.thinning() - at_cells(finest.thinning(), np.array(rail.shape) - 1)
    shape = resampled(finest.free_grid(), rail.shape).reshape(-1, 3)
    apart = np.linalg.norm(best_fit(rail.free_grid().reshape(-1, 3), shape) - shape, axis=1)
    values = flange, bottom, bottom - rail.springback(-1)[0], twist(rail.sheet, rail.found)[1]
    return [material.upper(), " x ".join(mesh.split()), str(len(rail.sheet.corners())), *(f"{v:.2f}" for v in values),
            f"{rail.found.distance().max():.2f}", of_differences(apart) if rail is not finest else "",
            extremes(rail.thinning()), of_differences(difference) if rail is not finest else "",
            extremes(rail.thinning_by_nodes()), studies.increments(folder)]


def main():
    """Make the runs and the table."""
    options = studies.arguments(__doc__)
    rows, jobs, pictures = [], [], {}
    for material in ("dp600", "dc06"):
        found = {}
        for mesh in MESHES:
            folder = studies.make(options, f"{material}_{mesh.replace(' ', 'x')}", DECK,
                                  {"divisions": f"{mesh} 1", "levels": 0, "material": material})
            if folder:
                found[mesh] = Rail(folder), folder
                jobs.append(read_job(folder))
        for mesh, (rail, folder) in found.items():
            rows.append(row_of(material, mesh, rail, list(found.values())[-1][0], folder))
            if material == "dp600":
                pictures[" x ".join(mesh.split())] = rail
    text = table(HEAD, rows)
    print(text)
    if options.write:
        put_table(REPORT, "springback", text, jobs)
        draw(pictures)
    sys.exit(0 if len(rows) == 2 * len(MESHES) else 1)


if __name__ == "__main__":
    run(main)
