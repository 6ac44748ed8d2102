#!/usr/bin/env python3
"""Draw tool force against tool displacement, for one or several runs.

    plot_force.py bending.out
    plot_force.py p1000.out p10000.out --label "p = 1000" --label "p = 10000" --output force.svg

A run is a folder of results or its history.csv. By default the tool is the one that controls the last phase. Its
displacement and force are taken in the direction of its motion, from the start of the phases drawn; the force is
positive where the sheet resists. For another tool, such as a pressed one, the magnitude of its force is drawn over
the displacement of the controlling tool. A cross marks a run that stopped before the end of its last phase.
"""

import argparse
import sys

import scripts

scripts.need("matplotlib", "numpy")
import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
import results  # noqa: E402
from scripts import Problem  # noqa: E402

AXES = {"x": 0, "y": 1, "z": 2}


class History:
    """Columns of a history.csv; rows that are not whole are left out."""

    def __init__(self, run):
        self.path = results.history_file(run)
        rows = results.read_table(self.path, "phase", "travel", "progress")
        if not rows:
            raise Problem(f"{self.path}: no rows")
        self.names = list(rows[0])
        self.rows = [row for row in rows if results.is_whole(row)]
        self.phase = np.array([row["phase"] for row in self.rows])

    def column(self, name):
        return np.array([row[name] for row in self.rows], dtype=float)

    def tools(self):
        return results.tools_in(self.names)

    def vector(self, tool, quantity):
        return np.column_stack([self.column(f"{tool}_{quantity}{axis}") for axis in AXES])

    def rows_of(self, phases):
        """Return the rows of the phases, with the state they start from."""
        for phase in phases:
            if phase not in self.phase:
                raise Problem(f"{self.path}: no phase '{phase}'; there are: {', '.join(dict.fromkeys(self.phase))}")
        rows = np.flatnonzero(np.isin(self.phase, phases))
        if rows[0] > 0:
            rows = np.concatenate(([rows[0] - 1], rows))
        return rows


def controlling_tool(history):
    """Return the tool whose path in the last phase is the travel; if none moves, the one with the largest force."""
    rows = history.rows_of([history.phase[-1]])
    travel = np.ptp(history.column("travel")[rows])
    paths = {tool: np.linalg.norm(np.ptp(history.vector(tool, "u")[rows], axis=0)) for tool in history.tools()}
    if not paths:
        raise Problem(f"{history.path}: there is no tool")
    if travel > 0:
        return min(paths, key=lambda tool: abs(paths[tool] - travel))
    return max(paths, key=lambda tool: np.linalg.norm(history.vector(tool, "f")[rows], axis=1).max())


def curve(history, tool, phases, component):
    """Return displacement (mm) and force (N) of the tool."""
    rows = history.rows_of(phases)
    leader = controlling_tool(history) if component == "motion" else tool
    displacement = history.vector(leader, "u")[rows]
    force = history.vector(tool, "f")[rows]
    displacement = displacement - displacement[0]
    step = np.diff(displacement, axis=0)
    path = np.concatenate(([0.0], np.cumsum(np.linalg.norm(step, axis=1))))
    if component == "magnitude":
        return path, np.linalg.norm(force, axis=1)
    if component in AXES:
        return path, force[:, AXES[component]]
    direction = displacement[-1]
    if not direction.any():
        return path, np.linalg.norm(force, axis=1)
    direction = direction / np.linalg.norm(direction)
    return displacement @ direction, np.linalg.norm(force, axis=1) if leader != tool else -force @ direction


def common(tools):
    """Return the name that all tools have, else `Tool`."""
    return tools[0].replace("_", " ").capitalize() if len(set(tools)) == 1 else "Tool"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", nargs="+", metavar="RUN", help="folder of results, or its history.csv")
    parser.add_argument("--tool", help="tool (default: the one that controls the last phase)")
    parser.add_argument("--component", choices=["motion", "x", "y", "z", "magnitude"], default="motion",
                        help="part of the force: against the motion (default), along an axis, or all of it")
    parser.add_argument("--phase", action="append", default=[],
                        help="phase to draw; may be repeated (default: the last)")
    parser.add_argument("--label", action="append", default=[], help="name of a run in the legend, in their order")
    parser.add_argument("--factor", type=float, default=1.0, help="factor on the force; 2 for a half model")
    parser.add_argument("--title", default="", help="title above the plot")
    parser.add_argument("--output", default="force.png", help="picture to write: .png, .svg or .pdf (force.png)")
    parser.add_argument("--size", type=float, nargs=2, default=[7.0, 4.5], metavar=("W", "H"), help="size in inches")
    options = parser.parse_args()
    if len(options.label) > len(options.runs):
        parser.error("more labels than runs")
    return options


def draw(options, curves, axes):
    """Draw the curves: tool, controlling tool, label, displacement, force, whether the run stopped."""
    largest = max(np.abs(force).max() for *_, force, _ in curves)
    unit, scale = ("kN", 1000.0) if largest >= 1000.0 else ("N", 1.0)
    for _, _, label, displacement, force, stopped in curves:
        line, = axes.plot(displacement, force / scale, linewidth=1.4, label=label)
        if stopped:
            axes.plot(displacement[-1], force[-1] / scale, "x", color=line.get_color(), markersize=8,
                      markeredgewidth=2, clip_on=False, zorder=5)
    name, leader = (common(names) for names in list(zip(*curves))[:2])
    part = {"motion": "", "magnitude": ", magnitude"}.get(options.component, f", along {options.component}")
    axes.set_xlabel(f"{leader} displacement (mm)")
    axes.set_ylabel(f"{name} force{part} ({unit})")
    axes.set_title(options.title)
    axes.ticklabel_format(useOffset=False)
    axes.grid(True, color="0.88", linewidth=0.7)
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_xlim(left=0.0)
    if min(force.min() for *_, force, _ in curves) >= -0.02 * largest:
        axes.set_ylim(bottom=0.0)
    if len(curves) > 1 or options.label:
        axes.legend(frameon=False)


def read_curve(options, number):
    """Return the curve of a run as `draw` takes it."""
    history = History(options.runs[number])
    tool = options.tool or controlling_tool(history)
    if tool not in history.tools():
        raise Problem(f"{history.path}: no tool '{tool}'; there are: {', '.join(history.tools())}")
    displacement, force = curve(history, tool, options.phase or [history.phase[-1]], options.component)
    name = history.path.parent.resolve().name.removesuffix(".out")
    label = options.label[number] if number < len(options.label) else name
    leader = controlling_tool(history) if options.component == "motion" else tool
    return tool, leader, label, displacement, options.factor * force, history.column("progress")[-1] < 1.0


def main():
    options = arguments()
    curves = [read_curve(options, number) for number in range(len(options.runs))]
    figure, axes = plt.subplots(figsize=options.size, layout="constrained")
    draw(options, curves, axes)
    try:
        figure.savefig(options.output, dpi=200)
    except (OSError, ValueError) as error:
        sys.exit(f"{options.output}: {error}")
    print(options.output)


if __name__ == "__main__":
    scripts.run(main)
