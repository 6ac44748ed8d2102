# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the process window of an input file over two of its parameters: where splits and wrinkles begin.

    dd3 window cup.dat --vary holder=-10000:-60000:6 friction=0.04:0.16:4 --waves 0.2
    dd3 window rail.dat --vary holder=-5000:-40000:5 blank=80:100:3 --thinning 0.25 --set levels=0

All combinations of the values run as those of `dd3 study`, which also explains --vary; ended runs are kept. A run
splits where its largest major strain exceeds the forming limit curve of its material, or with --thinning its largest
thinning that fraction. It wrinkles where the waves under a holder at the end of the forming are higher than --waves, or
those in walls higher than --walls, if it is given. Of each border the runs beside it are printed, and the place between
them, at which it is drawn, by linear interpolation, of waves in the logarithm of their height, at least a hundredth
of the limit. Runs that stopped or were refused are marked and left out. window.csv and window.png are written into
--work.
"""

import argparse
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from dd3.command import new_parser
from dd3.errors import Problem
from dd3.plot.figures import new_figure, save
from dd3.programs import add_program, find_program, made_folder, setting
from dd3.run import read_job
from dd3.scatter.results import over_limit
from dd3.study.vary import Case, attempt, combinations, numbers_of, parameter, run_all, value_of
from dd3.verdict import ended_phases

SPLITS, WRINKLES, BOTH, GOOD = "splits", "wrinkles", "splits and wrinkles", "good"
LEAST = 1e-2  # height of waves over the limit, as which a run without waves counts
COLOURS = {GOOD: "#009e73", SPLITS: "#d55e00", WRINKLES: "#56b4e9", BOTH: "#8b1a1a"}


class Window(NamedTuple):
    """Runs over two parameters: their names and values, and at each combination how far the sheet is to its split, 1 at
    the limit, and the height of its waves over the limit; nan of runs without an end."""

    names: tuple[str, str]
    x: np.ndarray
    y: np.ndarray
    split: np.ndarray
    waves: np.ndarray

    def answers(self) -> np.ndarray:
        """Return what each run shows, "" of runs without an end."""
        split, waves = self.split > 1, self.waves > 1
        found = np.select([split & waves, split, waves], [BOTH, SPLITS, WRINKLES], GOOD)
        return np.where(np.isfinite(self.split), found, "")

    def limits(self) -> list[tuple[str, np.ndarray, np.ndarray]]:
        """Return the name of each limit, the values over it, and those to interpolate, 1 at the limit as well: waves
        fall by decades along a parameter."""
        return [(SPLITS, self.split, self.split),
                (WRINKLES, self.waves, 1 + np.log(np.maximum(self.waves, LEAST)))]


class Border(NamedTuple):
    """A border along the first parameter: the value of the second one, those of the first one at the runs beside it,
    and the place between these."""

    at: float
    low: float
    high: float
    place: float


def borders(x: np.ndarray, y: np.ndarray, values: np.ndarray) -> list[Border]:
    """Return where values (x, y) pass 1 between neighbours along x, at each y."""
    found = []
    for at, row in zip(y, values.T):
        for i in np.flatnonzero((row[:-1] > 1) != (row[1:] > 1)):
            if np.isfinite(row[i:i + 2]).all():
                place = x[i] + (1 - row[i]) / (row[i + 1] - row[i]) * (x[i + 1] - x[i])
                found.append(Border(at, x[i], x[i + 1], place))
    return found


def wave_heights(job: dict[str, Any]) -> tuple[float, float]:
    """Return the largest height of waves under holders at the end of the forming, and of those in walls, mm."""
    phases = ended_phases(job)
    last = {holder["tool"]: holder["wave"] for phase in phases for holder in phase.closing["holders"]}
    walls = [2 * punch["off_walls"]["distance"] for phase in phases for punch in phase.closing["punches"]
             if punch["off_walls"]]
    return max((wave["distance"] for wave in last.values() if wave), default=0.0), max(walls, default=0.0)


def window_of(cases: Sequence[Case], varied: Sequence[tuple[str, list[str]]], waves: float,
              walls: float | None = None, thinning: float | None = None) -> Window:
    """Return the window of runs in the order of `combinations`. waves, walls: largest heights under a holder and in
    walls, mm; thinning: largest fraction, in place of the forming limit curve."""
    (first, x), (second, y) = ((name, numbers_of(values)) for name, values in varied)
    if x is None or y is None or min(len(x), len(y)) < 2:
        raise Problem("--vary takes two or more numbers for each of the two parameters")
    table = np.full((2, len(cases)), np.nan)
    for i, case in enumerate(cases):
        if case.state == "reached":
            split = (over_limit(case.folder) if thinning is None
                     else value_of(case.folder, "thinning", "max")[0] / thinning)
            holder, wall = wave_heights(read_job(case.folder))
            table[:, i] = split, max(holder / waves, wall / walls if walls else 0.0)
    ratios, heights = (values.reshape(len(x), len(y))[np.argsort(x)][:, np.argsort(y)] for values in table)
    return Window((first, second), np.sort(x), np.sort(y), ratios, heights)


def draw(axes: Axes, found: Window) -> None:
    """Draw runs in the colours of what they show, and the borders of splits and wrinkles."""
    answers = found.answers()
    for i, j in np.ndindex(answers.shape):
        answer = str(answers[i, j])
        axes.plot(found.x[i], found.y[j], marker="o" if answer else "x", color=COLOURS.get(answer, "0.5"), linestyle="",
                  markersize=7, label=answer or "no end")
    for name, values, smooth in found.limits():
        if (values > 1).any() and (values < 1).any():
            axes.contour(found.x, found.y, smooth.T, levels=[1.0], colors=COLOURS[name], linewidths=1.3)
    axes.use_sticky_edges = False
    axes.margins(0.06)
    handles, labels = axes.get_legend_handles_labels()
    single = dict(zip(labels, handles))
    axes.legend(single.values(), single.keys(), frameon=False, fontsize="small", loc="upper left",
                bbox_to_anchor=(1, 1))
    axes.set(xlabel=found.names[0], ylabel=found.names[1])
    axes.grid(True, color="0.9")


def said(found: Window) -> list[str]:
    """Return the lines on the borders."""
    lines = []
    for name, values, smooth in found.limits():
        rows = [f"  {found.names[1]} = {row.at:g}: {found.names[0]} from {row.low:g} to {row.high:g}, about "
                f"{row.place:.4g}" for row in borders(found.x, found.y, smooth)]
        known = values[np.isfinite(values)]
        none = f"  none; the nearest run has {known.max():.3g} of the limit" if known.size and known.max() <= 1 else (
            "  no border along " + found.names[0])
        lines += [f"{name} begin at", *(rows or [none])]
    return lines


def options_of(words: Sequence[str] | None) -> argparse.Namespace:
    """Return the options of a command line."""
    parser = new_parser("window", __doc__)
    parser.add_argument("deck", type=Path, help="input file")
    parser.add_argument("--vary", nargs=2, type=parameter, required=True, metavar="NAME=VALUES",
                        help="two parameters and their values: 0.1,0.14 or FIRST:LAST:NUMBER")
    parser.add_argument("--waves", type=float, default=0.2, metavar="MM", help="largest height of waves, mm (0.2)")
    parser.add_argument("--walls", type=float, metavar="MM", help="largest height of waves in walls, mm (no limit)")
    parser.add_argument("--thinning", type=float, metavar="PART",
                        help="largest thinning, a fraction, in place of the forming limit curve")
    parser.add_argument("--set", type=setting, action="append", default=[], metavar="NAME=VALUE",
                        help="parameter that is the same in all runs; may be repeated")
    parser.add_argument("--work", type=Path, help="folder of the runs (default: the input file's name with .window)")
    add_program(parser)
    parser.add_argument("--cores", type=int, default=os.cpu_count() or 1, metavar="N",
                        help="runs at a time, each with one thread (default: the number of cores)")
    options = parser.parse_args(words)
    if options.cores < 1 or not options.waves > 0 or (options.walls is not None and not options.walls > 0):
        parser.error("--cores, --waves and --walls take a positive number")
    if options.thinning is not None and not 0 < options.thinning < 1:
        parser.error("--thinning takes a fraction between 0 and 1")
    return options


def main(words: Sequence[str] | None = None) -> None:
    """Make the window of the command line."""
    options = options_of(words)
    if not options.deck.is_file():
        raise Problem(f"{options.deck}: no such file")
    work = made_folder(options.work or options.deck.with_suffix(".window"))
    cases = combinations(options.vary, work, dict(options.set))
    run_all(cases, find_program(options.program), options.deck, options.cores, attempt)
    found = window_of(cases, options.vary, options.waves, options.walls, options.thinning)
    x, y = np.meshgrid(found.x, found.y, indexing="ij")
    pd.DataFrame({found.names[0]: x.ravel(), found.names[1]: y.ravel(), "split": found.split.ravel(),
                  "waves": found.waves.ravel(), "answer": found.answers().ravel()}).to_csv(
        work / "window.csv", index=False, float_format="%.6g")
    figure, axes = new_figure((7.5, 4.5))
    draw(axes, found)
    save(figure, work / "window.png", 130)
    print(*said(found), work / "window.png", sep="\n")
    lost = [case for case in cases if case.state != "reached"]
    if lost:
        raise Problem(f"{len(lost)} of {len(cases)} runs did not reach their end; the first: {lost[0].folder}"
                      + (f": {lost[0].message}" if lost[0].message else ""))
