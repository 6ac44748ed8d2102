# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the size of the increments and what limits it, for one or several runs.

    dd3 plot increments bending.out
    dd3 plot increments on.out off.out --label "with the force limit" --label without --output increments.svg

A run is a folder of results or its status.csv, and has a plot of its own; all have the same axes. Each point is an
accepted increment of the last phase, or of those of --phase: the factor r on the trial increment at the travel where
the increment ends, coloured by the limiter of r. The legend gives the number of increments of each limiter. A cross
marks the last increment of a run that stopped in these phases.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dd3.errors import Problem
from dd3.plot.figures import labels_of, new_figure, parser_of_pictures, save_pictures, tidy
from dd3.run import read_frame

# Colour of each limiter; those that only end an increment at a place have one.
COLOURS = {"rotation": "#1f5f99", "force": "#d1491b", "r_min": "#e8a33d", "strain": "#3a8f4d", "stress": "#7b4fa3",
           "r_max": "0.15", "gap": "#17a2a8", "first contact": "#b8508f", "cutback": "#8c564b", "iterations": "#9a9a2e"}
ENDS = ("output", "phase", "table", "until")
END_LABEL, END_COLOUR = "output or end", "0.55"


class Increments:
    """Accepted increments of some phases of a run, by default the last: travel, r and limiter."""

    def __init__(self, run: str | Path, phases: Sequence[str] = ()) -> None:
        status = read_frame(run, "status.csv", "phase", "travel", "r", "limiter", "outcome")
        path, accepted = status.attrs["path"], status[status["outcome"] == "accepted"]
        if accepted.empty:
            raise Problem(f"{path}: no accepted increments")
        names = list(accepted["phase"].unique())
        for phase in phases:
            if phase not in names:
                raise Problem(f"{path}: no phase '{phase}'; there are: {', '.join(names)}")
        wanted = phases or names[-1:]
        chosen = accepted[accepted["phase"].isin(wanted)]
        try:
            self.travel, self.r = chosen["travel"].to_numpy(float), chosen["r"].to_numpy(float)
        except ValueError as error:
            raise Problem(f"{path}: {error}") from None
        self.limiter = np.array([END_LABEL if name in ENDS else name for name in chosen["limiter"]])
        self.stopped = status["outcome"].iloc[-1] == "failed" and status["phase"].iloc[-1] in wanted

    def limiters(self) -> list[tuple[str, int]]:
        """Return the limiters, that of most increments first."""
        names, counts = np.unique(self.limiter, return_counts=True)
        return [(str(names[i]), int(counts[i])) for i in np.argsort(-counts, kind="stable")]


def draw(axes: Axes, run: Increments, label: str) -> None:
    """Draw the increments of a run; limiters of few increments are above those of many."""
    axes.plot(run.travel, run.r, color="0.85", linewidth=0.6, zorder=1)
    for name, count in run.limiters():
        chosen = run.limiter == name
        axes.plot(run.travel[chosen], run.r[chosen], ".", markersize=3.2, zorder=2 + 1.0 / count,
                  color=COLOURS.get(name, END_COLOUR), label=f"{name}: {count}")
    if run.stopped:
        axes.plot(run.travel[-1], run.r[-1], "x", color="k", markersize=8, markeredgewidth=2, zorder=5, clip_on=False)
    end = f", stopped at {run.travel[-1]:.1f} mm" if run.stopped else ""
    axes.set_title(f"{label}: {len(run.r)} increments{end}", loc="left", fontsize=10)
    axes.set_ylabel("factor r (-)")
    tidy(axes, "0.92")
    axes.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0), markerscale=2.5,
                title="limiter: increments", title_fontsize=8, alignment="left")


def figure(runs: Sequence[str | Path], labels: Sequence[str] = (), *, phase: Sequence[str] = (), title: str = "",
           size: tuple[float, float] | None = None) -> Figure:
    """Return a figure of the increments of some runs, a plot each, in some phases (the last one)."""
    found = [Increments(run, phase) for run in runs]
    drawn, axes = new_figure(size or (7.5, 0.3 + 2.6 * len(found)), len(found), sharex=True, sharey=True, squeeze=False)
    for run, label, plot in zip(found, labels_of(runs, labels), axes[:, 0], strict=True):
        draw(plot, run, label)
    axes[0, 0].set_yscale("log")
    axes[0, 0].set_ylim(min(run.r.min() for run in found) / 1.5, 1.5 * max(run.r.max() for run in found))
    axes[0, 0].set_xlim(left=min(0.0, *(run.travel.min() for run in found)), right=max(run.travel[-1] for run in found))
    axes[-1, 0].set_xlabel("travel (mm)")
    drawn.suptitle(title)
    return drawn


def main(words: Sequence[str] | None = None) -> None:
    """Draw the picture of the command line."""
    save_pictures(figure, parser_of_pictures("plot increments", __doc__, "status.csv", "increments.png",
                                             "7.5 by 2.6 for each run"), words)
