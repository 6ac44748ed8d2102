# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw tool force against tool displacement, for one or several runs.

    dd3 plot force bending.out
    dd3 plot force p1000.out p10000.out --label "p = 1000" --label "p = 10000" --output force.svg

A run is a folder of results or its history.csv. By default the tool is the one that controls the last phase. Its
displacement and force are taken in the direction of its motion, from the start of the phases drawn; the force is
positive where the sheet resists. For another tool, such as a pressed one, the magnitude of its force is drawn over
the displacement of the controlling tool. A cross marks a run that stopped before the end of its last phase.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from dd3.errors import Problem
from dd3.plot.figures import new_figure, parsed_pictures, parser_of_pictures, save, tidy
from dd3.run import read_frame
from dd3.sheet import AXES, length
from dd3.tables import tools_in


@dataclass
class Curve:
    """Force of a tool (N) over its displacement or that of the leading tool (mm); whether the run stopped."""

    tool: str
    leader: str
    displacement: np.ndarray
    force: np.ndarray
    stopped: bool


def vector(history: pd.DataFrame, tool: str, quantity: str) -> np.ndarray:
    """Return the components of a tool's displacement (u) or force (f)."""
    return history[[f"{tool}_{quantity}{axis}" for axis in AXES]].to_numpy(float)


def rows_of(history: pd.DataFrame, phases: Sequence[str]) -> np.ndarray:
    """Return the rows of the phases, with the state they start from."""
    for phase in phases:
        if phase not in set(history["phase"]):
            raise Problem(f"{history.attrs['path']}: no phase '{phase}'; there are: "
                          + ", ".join(history["phase"].unique()))
    rows = np.flatnonzero(history["phase"].isin(phases))
    return np.concatenate(([rows[0] - 1], rows)) if rows[0] > 0 else rows


def last_phase(history: pd.DataFrame) -> str:
    """Return the name of the last phase."""
    return str(history["phase"].iloc[-1])


def controlling_tool(history: pd.DataFrame) -> str:
    """Return the tool whose path in the last phase is the travel; if none moves, the one with the largest force."""
    rows = rows_of(history, [last_phase(history)])
    travel = np.ptp(history["travel"].to_numpy(float)[rows])
    paths = {tool: np.linalg.norm(np.ptp(vector(history, tool, "u")[rows], axis=0)) for tool in tools_in(history)}
    if not paths:
        raise Problem(f"{history.attrs['path']}: there is no tool")
    if travel > 0:
        return min(paths, key=lambda tool: abs(paths[tool] - travel))
    return max(paths, key=lambda tool: np.linalg.norm(vector(history, tool, "f")[rows], axis=1).max())


def curve(history: pd.DataFrame, tool: str | None = None, phases: Sequence[str] = (), component: str = "motion"
          ) -> Curve:
    """Return the curve of a tool, by default the one that controls the last phase."""
    tool = tool or controlling_tool(history)
    if tool not in tools_in(history):
        raise Problem(f"{history.attrs['path']}: no tool '{tool}'; there are: {', '.join(tools_in(history))}")
    rows = rows_of(history, phases or [last_phase(history)])
    leader = controlling_tool(history) if component == "motion" else tool
    displacement, force = vector(history, leader, "u")[rows], vector(history, tool, "f")[rows]
    displacement = displacement - displacement[0]
    path = length(displacement)
    shown = force[:, AXES.index(component)] if component in AXES else np.linalg.norm(force, axis=1)
    if component == "motion" and displacement[-1].any():
        direction = displacement[-1] / np.linalg.norm(displacement[-1])
        path = displacement @ direction
        shown = shown if leader != tool else -force @ direction
    return Curve(tool, leader, path, shown, float(history["progress"].iloc[-1]) < 1.0)


def common(tools: Sequence[str]) -> str:
    """Return the name that all tools have, else `Tool`."""
    return tools[0].replace("_", " ").capitalize() if len(set(tools)) == 1 else "Tool"


def draw(axes: Axes, curves: Sequence[Curve], labels: Sequence[str], component: str = "motion", factor: float = 1.0
         ) -> None:
    """Draw curves, with a factor on the force."""
    forces = [factor * one.force for one in curves]
    largest = max(np.abs(force).max() for force in forces)
    unit, scale = ("kN", 1000.0) if largest >= 1000.0 else ("N", 1.0)
    for one, force, label in zip(curves, forces, labels, strict=True):
        line, = axes.plot(one.displacement, force / scale, linewidth=1.4, label=label)
        if one.stopped:
            axes.plot(one.displacement[-1], force[-1] / scale, "x", color=line.get_color(), markersize=8,
                      markeredgewidth=2, clip_on=False, zorder=5)
    part = {"motion": "", "magnitude": ", magnitude"}.get(component, f", along {component}")
    axes.set_xlabel(f"{common([one.leader for one in curves])} displacement (mm)")
    axes.set_ylabel(f"{common([one.tool for one in curves])} force{part} ({unit})")
    axes.ticklabel_format(useOffset=False)
    tidy(axes, "0.88")
    axes.set_xlim(left=0.0)
    if min(force.min() for force in forces) >= -0.02 * largest:
        axes.set_ylim(bottom=0.0)


def main(words: Sequence[str] | None = None) -> None:
    """Draw the picture of the command line."""
    parser = parser_of_pictures("plot force", __doc__, "history.csv", "force.png", "7 by 4.5")
    parser.add_argument("--tool", help="tool (default: the one that controls the last phase)")
    parser.add_argument("--component", choices=["motion", "x", "y", "z", "magnitude"], default="motion",
                        help="part of the force: against the motion (default), along an axis, or all of it")
    parser.add_argument("--factor", type=float, default=1.0, help="factor on the force; 2 for a half model")
    options, labels = parsed_pictures(parser, words)
    curves = [curve(read_frame(run, "history.csv", "phase", "travel", "progress"), options.tool, options.phase,
                    options.component) for run in options.runs]
    figure, axes = new_figure(options.size or (7.0, 4.5))
    draw(axes, curves, labels, options.component, options.factor)
    axes.set_title(options.title)
    if len(curves) > 1 or options.label:
        axes.legend(frameon=False)
    save(figure, options.output)
    print(options.output)
