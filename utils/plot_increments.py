#!/usr/bin/env python3
"""Draw the size of the increments and what limits it, for one or several runs.

    plot_increments.py bending.out
    plot_increments.py on.out off.out --label "with the force limit" --label without --output increments.svg

A run is a folder of results or its status.csv, and has a plot of its own; all have the same axes. Each point is an
accepted increment of the last phase, or of those of --phase: the factor r on the trial increment at the travel where
the increment ends, coloured by the limiter of r. The legend gives the number of increments of each limiter. A cross
marks the last increment of a run that stopped in these phases.
"""

import argparse
import sys
from pathlib import Path

import scripts

scripts.need("matplotlib", "numpy")
import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
import results  # noqa: E402
from scripts import Problem  # noqa: E402

# Colour of each limiter; those that only end an increment at a place have one.
COLOURS = {"rotation": "#1f5f99", "force": "#d1491b", "r_min": "#e8a33d", "strain": "#3a8f4d", "stress": "#7b4fa3",
           "r_max": "0.15", "gap": "#17a2a8", "first contact": "#b8508f", "cutback": "#8c564b", "iterations": "#9a9a2e"}
ENDS = ("output", "phase", "table", "until")
END_LABEL, END_COLOUR = "output or end", "0.55"


class Increments:
    """Accepted increments of some phases of a run: travel, r and limiter."""

    def __init__(self, run, phases):
        path = Path(run)
        self.path = path / "status.csv" if path.is_dir() else path
        rows = results.read_table(self.path, "phase", "travel", "r", "limiter", "outcome")
        rows = [row for row in rows if results.is_whole(row)]
        accepted = [row for row in rows if row["outcome"] == "accepted"]
        if not accepted:
            raise Problem(f"{self.path}: no accepted increments")
        names = list(dict.fromkeys(row["phase"] for row in accepted))
        for phase in phases:
            if phase not in names:
                raise Problem(f"{self.path}: no phase '{phase}'; there are: {', '.join(names)}")
        chosen = [row for row in accepted if row["phase"] in (phases or names[-1:])]
        self.travel = self.column(chosen, "travel")
        self.r = self.column(chosen, "r")
        self.limiter = np.array([END_LABEL if row["limiter"] in ENDS else row["limiter"] for row in chosen])
        self.stopped = rows[-1]["outcome"] == "failed" and rows[-1]["phase"] in (phases or names[-1:])

    def column(self, rows, name):
        return np.array([results.number(row, name, self.path) for row in rows])

    def limiters(self):
        """Return the limiters, that of most increments first."""
        names, counts = np.unique(self.limiter, return_counts=True)
        return [(names[i], int(counts[i])) for i in np.argsort(-counts, kind="stable")]


def draw(axes, run, label):
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
    axes.grid(True, color="0.92", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0), markerscale=2.5,
                title="limiter: increments", title_fontsize=8, alignment="left")


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", nargs="+", metavar="RUN", help="folder of results, or its status.csv")
    parser.add_argument("--phase", action="append", default=[],
                        help="phase to draw; may be repeated (default: the last)")
    parser.add_argument("--label", action="append", default=[], help="name of a run, in their order")
    parser.add_argument("--title", default="", help="title above the plots")
    parser.add_argument("--output", default="increments.png",
                        help="picture to write: .png, .svg or .pdf (increments.png)")
    parser.add_argument("--size", type=float, nargs=2, metavar=("W", "H"),
                        help="size in inches (7.5 by 2.6 for each run)")
    options = parser.parse_args()
    if len(options.label) > len(options.runs):
        parser.error("more labels than runs")
    return options


def main():
    options = arguments()
    runs = [Increments(run, options.phase) for run in options.runs]
    names = [run.path.parent.resolve().name.removesuffix(".out") for run in runs]
    labels = options.label + names[len(options.label):]
    size = options.size or (7.5, 0.3 + 2.6 * len(runs))
    figure, axes = plt.subplots(len(runs), 1, figsize=size, layout="constrained", sharex=True, sharey=True,
                                squeeze=False)
    for run, label, plot in zip(runs, labels, axes[:, 0]):
        draw(plot, run, label)
    axes[0, 0].set_yscale("log")
    axes[0, 0].set_ylim(min(run.r.min() for run in runs) / 1.5, 1.5 * max(run.r.max() for run in runs))
    axes[0, 0].set_xlim(left=min(0.0, *(run.travel.min() for run in runs)), right=max(run.travel[-1] for run in runs))
    axes[-1, 0].set_xlabel("travel (mm)")
    figure.suptitle(options.title)
    try:
        figure.savefig(options.output, dpi=200)
    except (OSError, ValueError) as error:
        sys.exit(f"{options.output}: {error}")
    print(options.output)


if __name__ == "__main__":
    scripts.run(main)
