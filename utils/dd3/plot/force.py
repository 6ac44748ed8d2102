# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw tool force against tool displacement, for one or several runs.

    dd3 plot force bending.out
    dd3 plot force p1000.out p10000.out --label "p = 1000" --label "p = 10000" --output force.svg

A run is a folder of results or its history.csv. By default the phase is the last one that a tool controls, the tool
the one that controls it. Its displacement and force are taken in the direction of its first motion that the sheet
resists, from the start of the phases drawn; the force is positive where the sheet resists. For another tool, such as a
pressed one, the magnitude of its force is drawn over the displacement of the controlling tool. Where no tool is moved
by a prescribed distance, the force is drawn over the angle of the tool, if it turns, or the progress of the phases. A
cross marks a run that stopped before the end of its last phase.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dd3.errors import Problem
from dd3.plot.figures import labels_of, new_figure, parser_of_pictures, save_pictures, tidy
from dd3.run import read_frame, state_of
from dd3.sheet import AXES, length
from dd3.tables import tools_in

ROUND_OFF = 1e-6  # motion in an increment, over the largest distance from the start
RESISTED = 0.1  # force against a motion that the sheet resists, over the largest one


@dataclass
class Curve:
    """Force of a tool (N) over a quantity; whether the run stopped."""

    tool: str
    quantity: str  # with its unit
    along: np.ndarray
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


def main_phase(history: pd.DataFrame) -> str:
    """Return the name of the last phase that a tool controls; if there is none, of the last one."""
    phases = history["phase"].to_numpy(str)
    moving = np.flatnonzero(np.diff(history["travel"].to_numpy(float)) > 0) + 1
    return str(phases[moving[-1] if moving.size else -1])


def controlling_tool(history: pd.DataFrame, phases: Sequence[str]) -> str:
    """Return the tool whose path in some phases is the travel; if none controls them, the one that is moved furthest,
    or that with the largest force."""
    rows = rows_of(history, phases)
    travel = np.ptp(history["travel"].to_numpy(float)[rows])
    paths = {tool: length(vector(history, tool, "u")[rows])[-1] for tool in tools_in(history)}
    if not paths:
        raise Problem(f"{history.attrs['path']}: there is no tool")
    if travel > 0:
        return min(paths, key=lambda tool: abs(paths[tool] - travel))
    progress = progress_of(history, rows)
    led = [tool for tool in paths if is_led(progress, vector(history, tool, "u")[rows])]
    if led:
        return max(led, key=lambda tool: paths[tool])
    return max(paths, key=lambda tool: np.linalg.norm(vector(history, tool, "f")[rows], axis=1).max())


def progress_of(history: pd.DataFrame, rows: np.ndarray) -> np.ndarray:
    """Return the progress from the first row on, which may be the last one before the phases: each counts from 0, to
    1 or where it ends early."""
    progress, phases = history["progress"].to_numpy(float)[rows], history["phase"].to_numpy(str)[rows]
    new = np.concatenate(([False], phases[1:] != phases[:-1]))
    ended = np.cumsum(np.where(new, np.concatenate(([0.0], progress[:-1])), 0.0))
    found: np.ndarray = progress + ended
    return found - found[0]


def is_led(progress: np.ndarray, place: np.ndarray) -> bool:
    """Whether a path is proportional to the progress: that of a tool which is moved, not pressed."""
    path = place[-1] - place[0]
    return bool(np.any(path) and np.abs(place - place[0] - np.outer(progress / progress[-1], path)).max()
                <= 1e-6 * np.linalg.norm(path))


def abscissa(history: pd.DataFrame, tool: str, rows: np.ndarray) -> tuple[np.ndarray, str]:
    """Return what a tool's force is drawn over, and its name: displacement, angle, or the progress of the phases."""
    place, progress = vector(history, tool, "u")[rows], progress_of(history, rows)
    name = tool.replace("_", " ")
    if np.ptp(history["travel"].to_numpy(float)[rows]) > 0 or is_led(progress, place):
        return length(place), f"{name} displacement (mm)"
    if f"{tool}_angle" in history:
        angle = history[f"{tool}_angle"].to_numpy(float)[rows]
        if np.ptp(angle) > 0:
            return np.abs(angle - angle[0]), f"{name} angle (degrees)"
    return 100 * progress, "progress of the phase (%)"


def direction_of(displacement: np.ndarray, force: np.ndarray) -> np.ndarray:
    """Return the direction of a tool's motion: that of the place farthest from the start, or the opposite one, along
    the first motion that the sheet resists, of those there and back; along the first one where it resists none.
    displacement, force: of the tool, (n, 3). Zero without a motion."""
    farthest = displacement[np.linalg.norm(displacement, axis=1).argmax()]
    distance = np.linalg.norm(farthest)
    if distance == 0.0:
        return np.zeros(3)
    axis = farthest / distance
    motion, along = np.diff(displacement @ axis), (force @ axis)[1:]
    sense = np.where(np.abs(motion) > ROUND_OFF * distance, np.sign(motion), 0.0)
    resisted = np.flatnonzero(-along * sense > RESISTED * np.abs(along).max())
    moved = np.flatnonzero(sense)
    return np.asarray(axis * (sense[resisted[0] if resisted.size else moved[0]] if moved.size else 1.0))


def curve(history: pd.DataFrame, tool: str | None = None, phases: Sequence[str] = (), component: str = "motion"
          ) -> Curve:
    """Return the curve of a tool, by default the one that controls the phases, by default the last controlled one."""
    phases = phases or [main_phase(history)]
    leader = controlling_tool(history, phases)
    tool = tool or leader
    if tool not in tools_in(history):
        raise Problem(f"{history.attrs['path']}: no tool '{tool}'; there are: {', '.join(tools_in(history))}")
    rows = rows_of(history, phases)
    leader = leader if component == "motion" else tool
    along, quantity = abscissa(history, leader, rows)
    displacement, force = vector(history, leader, "u")[rows], vector(history, tool, "f")[rows]
    displacement = displacement - displacement[0]
    direction = direction_of(displacement, vector(history, leader, "f")[rows])
    shown = force[:, AXES.index(component)] if component in AXES else np.linalg.norm(force, axis=1)
    if component == "motion" and quantity.endswith("(mm)") and direction.any():
        along = displacement @ direction
        shown = shown if leader != tool else -force @ direction
    state = state_of(Path(history.attrs["path"]).parent)  # the last phase of a run may end early
    return Curve(tool, quantity, along, shown, state != "reached" if state else history["progress"].iloc[-1] < 1.0)


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
        line, = axes.plot(one.along, force / scale, linewidth=1.4, label=label)
        if one.stopped:
            axes.plot(one.along[-1], force[-1] / scale, "x", color=line.get_color(), markersize=8,
                      markeredgewidth=2, clip_on=False, zorder=5)
    part = {"motion": "", "magnitude": ", magnitude"}.get(component, f", along {component}")
    quantities = {one.quantity for one in curves}
    name = quantities.pop() if len(quantities) == 1 else "tool displacement (mm)"
    axes.set_xlabel(name[0].upper() + name[1:])
    axes.set_ylabel(f"{common([one.tool for one in curves])} force{part} ({unit})")
    axes.ticklabel_format(useOffset=False)
    tidy(axes, "0.88")
    if min(one.along.min() for one in curves) >= -0.02 * max(np.ptp(one.along) for one in curves):
        axes.set_xlim(left=0.0)
    if min(force.min() for force in forces) >= -0.02 * largest:
        axes.set_ylim(bottom=0.0)


def figure(runs: Sequence[str | Path], labels: Sequence[str] = (), *, phase: Sequence[str] = (),
           tool: str | None = None, component: str = "motion", factor: float = 1.0, title: str = "",
           size: tuple[float, float] = (7.0, 4.5)) -> Figure:
    """Return a figure of tool force over tool displacement of some runs.

    phase: those drawn (the last that a tool controls). tool: by default the one that controls it. component: part of
    the force: motion, against the motion, x, y, z, or magnitude. factor: on the force, 2 for a half model.
    """
    curves = [curve(read_frame(run, "history.csv", "phase", "travel", "progress"), tool, phase, component)
              for run in runs]
    drawn, axes = new_figure(size)
    draw(axes, curves, labels_of(runs, labels), component, factor)
    axes.set_title(title)
    if len(curves) > 1 or labels:
        axes.legend(frameon=False)
    return drawn


def main(words: Sequence[str] | None = None) -> None:
    """Draw the picture of the command line."""
    parser = parser_of_pictures("plot force", __doc__, "history.csv", "force.png", "7 by 4.5")
    parser.add_argument("--tool", help="tool (default: the one that controls the last phase)")
    parser.add_argument("--component", choices=["motion", "x", "y", "z", "magnitude"], default="motion",
                        help="part of the force: against the motion (default), along an axis, or all of it")
    parser.add_argument("--factor", type=float, default=1.0, help="factor on the force; 2 for a half model")
    save_pictures(figure, parser, words)
