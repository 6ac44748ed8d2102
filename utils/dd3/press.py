# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare the force and the work of the tools of a run with a mechanical press: tonnage and energy over the stroke.

    dd3 press cup.out --ram punch --mirror x y
    dd3 press cup.out --ram die --whole 2 --stroke 400 --rod 1500 --force 2500 --rated 6.5 --energy 40 --verdict
    dd3 press --stroke 400 --rod 1500 --table 60 --points 12 --rate 20

--ram names the tools on the ram, by default the one that controls the last phase with a controlling tool; their forces
against its motion are added. The stroke ends at its largest displacement, the bottom dead centre. With --stroke (twice
the radius of the crank, mm) and --rod (length of the connecting rod, mm) the table has the angle of the crank before
the bottom dead centre; with --force (kN) and --rated (height above the bottom dead centre at which the press has this
force, mm) the force that its torque allows at each height, and with --energy (kJ) the energy of a stroke is compared.
--verdict ends with exit code 1 if one is exceeded. press.csv and press.png are written into RUN/press.

--table prints the last --table mm of the stroke as move_table of a phase with control = load, with its duration at
--rate strokes per minute.
"""

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from dd3.command import new_parser
from dd3.errors import Problem
from dd3.plot.figures import new_figure, save
from dd3.plot.force import controlling_tool, main_phase, vector
from dd3.programs import made_folder
from dd3.run import read_frame
from dd3.tables import tools_in

HALVINGS = 60  # of the angle, which leave less than the round-off


@dataclass(frozen=True)
class Crank:
    """A slider crank: radius of the crank and length of the rod, mm."""

    radius: float
    rod: float

    def height(self, angle: np.ndarray) -> np.ndarray:
        """Return the heights above the bottom dead centre at angles before it, rad."""
        return self.radius * (1 - np.cos(angle)) + self.rod - np.sqrt(self.rod**2 - (self.radius * np.sin(angle))**2)

    def slope(self, angle: np.ndarray) -> np.ndarray:
        """Return the derivatives of the heights, mm/rad: the torque of the crank over the force of the ram."""
        across = self.radius * np.sin(angle)
        return across + across * self.radius * np.cos(angle) / np.sqrt(self.rod**2 - across**2)

    def angle(self, height: np.ndarray) -> np.ndarray:
        """Return the angles before the bottom dead centre at heights up to the stroke, rad."""
        low, high = np.zeros_like(height), np.full_like(height, np.pi)
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            above = self.height(middle) > height
            low, high = np.where(above, low, middle), np.where(above, middle, high)
        return np.asarray((low + high) / 2)

    def allowed(self, height: np.ndarray, force: float, rated: float) -> np.ndarray:
        """Return the largest forces at heights, of a press with a force at a rated height: below it the frame limits
        the force, above it the torque of the crank."""
        torque = force * self.slope(self.angle(np.array([rated])))[0]
        slope = self.slope(self.angle(height))
        return np.asarray(np.minimum(force, torque / np.maximum(slope, torque / force)))


def ram_course(history: pd.DataFrame, tools: Sequence[str], whole: int) -> pd.DataFrame:
    """Return the course of the ram down to the bottom dead centre: height above it, mm, force, kN, energy, kJ. whole:
    number of images of the model."""
    unknown = [tool for tool in tools if tool not in tools_in(history)]
    if unknown:
        raise Problem(f"no tool '{unknown[0]}'; there are: {', '.join(tools_in(history))}")
    path = vector(history, tools[0], "u")
    last = int(np.linalg.norm(path, axis=1).argmax())
    if not last:
        raise Problem(f"the tool '{tools[0]}' does not move; expected one on the ram")
    direction = path[last] / np.linalg.norm(path[last])
    travel = path[:last + 1] @ direction
    # The force of the sheet on a tool is against the motion.
    force = -whole * sum(vector(history, tool, "f")[:last + 1] @ direction for tool in tools) / 1000
    energy = np.concatenate(([0.0], np.cumsum((force[1:] + force[:-1]) / 2 * np.diff(travel)))) / 1000
    return pd.DataFrame({"height": travel[-1] - travel, "force": force, "energy": energy})


def compared(course: pd.DataFrame, crank: Crank | None, options: argparse.Namespace) -> list[str]:
    """Add angle and allowed force to the course; return what is exceeded."""
    height, over = course["height"].to_numpy(), []
    if crank:
        if height[0] > 2 * crank.radius:
            raise Problem(f"the ram moves by {height[0]:.4g} mm, the stroke is {2 * crank.radius:.4g} mm")
        course["angle"] = np.degrees(crank.angle(height))
    if crank and options.force:
        course["allowed"] = crank.allowed(height, options.force, options.rated)
        worst = (course["force"] / course["allowed"]).idxmax()
        row = course.loc[worst]
        text = f"{row['force']:.4g} of {row['allowed']:.4g} kN at {row['height']:.4g} mm"
        print(f"nearest to the force that the press allows: {text}")
        over += [f"force: {text}"] * bool(row["force"] > row["allowed"])
    if options.energy:
        most = course["energy"].max()
        print(f"energy: {most:.4g} of {options.energy:g} kJ")
        over += [f"energy: {most:.4g} of {options.energy:g} kJ"] * bool(most > options.energy)
    return over


def draw(course: pd.DataFrame, path: Path) -> None:
    """Draw force and energy over the height."""
    figure, (upper, lower) = new_figure((7, 5), 2, sharex=True)
    upper.plot(course["height"], course["force"], color="#0072b2", label="of the tools")
    if "allowed" in course:
        upper.plot(course["height"], course["allowed"], "--", color="#d55e00", label="allowed by the press")
        upper.legend(frameon=False, fontsize="small")
    lower.plot(course["height"], course["energy"], color="#0072b2")
    upper.set(ylabel="force (kN)")
    lower.set(xlabel="height above the bottom dead centre (mm)", ylabel="energy (kJ)")
    lower.invert_xaxis()
    for axes in (upper, lower):
        axes.grid(True, color="0.9")
    save(figure, path, 130)


def table_of(crank: Crank, travel: float, points: int, rate: float) -> list[str]:
    """Return the entries of a phase that moves a tool down by the last part of the stroke at a constant speed of the
    crank: fraction of the time and of the path."""
    start = crank.angle(np.array([travel]))[0]
    time = np.linspace(0, 1, points)
    path = 1 - crank.height(start * (1 - time)) / travel
    pairs = "  ".join(f"{a:.6g} {b:.6g}" for a, b in zip(time, path))
    return ["  control = load", f"  duration = {start / (2 * np.pi) * 60 / rate:.6g}", f"  move_table = {pairs}"]


def options_of(words: Sequence[str] | None) -> argparse.Namespace:
    """Return the options of a command line."""
    parser = new_parser("press", __doc__)
    parser.add_argument("run", type=Path, nargs="?", metavar="RUN", help="folder of results")
    parser.add_argument("--ram", nargs="+", default=[], metavar="TOOL", help="tools on the ram")
    parser.add_argument("--mirror", nargs="+", default=[], choices=["x", "y", "z"], metavar="AXIS",
                        help="planes of symmetry, for the forces of the whole")
    parser.add_argument("--whole", type=int, default=1, metavar="N", help="times that the forces are multiplied by (1)")
    for name, unit, text in (("stroke", "MM", "stroke of the press"), ("rod", "MM", "length of the connecting rod"),
                             ("force", "KN", "force of the press"), ("energy", "KJ", "energy of a stroke"),
                             ("rated", "MM", "height above the bottom dead centre at which it has its force"),
                             ("table", "MM", "print the last part of the stroke as move_table")):
        parser.add_argument(f"--{name}", type=float, metavar=unit, help=text)
    parser.add_argument("--points", type=int, default=12, metavar="N", help="points of the table (12)")
    parser.add_argument("--rate", type=float, default=20.0, metavar="N", help="strokes per minute of the table (20)")
    parser.add_argument("--verdict", action="store_true", help="end with exit code 1 if the press is exceeded")
    options = parser.parse_args(words)
    given = [options.stroke, options.rod, options.force, options.energy, options.rated, options.table, options.rate]
    if any(value is not None and not value > 0 for value in given) or options.points < 2 or options.whole < 1:
        parser.error("numbers of the press are positive, --points 2 or more")
    if (options.stroke is None) != (options.rod is None) or (options.force is None) != (options.rated is None):
        parser.error("--stroke goes with --rod, --force with --rated")
    if options.stroke and options.rod <= options.stroke / 2:
        parser.error("--rod is longer than half the stroke")
    if options.stroke is None and (options.force or options.table):
        parser.error("--force and --table need --stroke and --rod")
    if any(value and value > options.stroke for value in (options.rated, options.table)):
        parser.error("--rated and --table are at most the stroke")
    if (options.run is None) == (options.table is None):
        parser.error("takes a RUN or --table")
    return options


def main(words: Sequence[str] | None = None) -> None:
    """Compare the run of the command line with its press."""
    options = options_of(words)
    crank = Crank(options.stroke / 2, options.rod) if options.stroke else None
    if crank and options.table:
        print(*table_of(crank, options.table, options.points, options.rate), sep="\n")
        return
    history = read_frame(options.run, "history.csv", "phase", "travel")
    tools = options.ram or [controlling_tool(history, [main_phase(history)])]
    course = ram_course(history, tools, options.whole * 2**len(set(options.mirror)))
    over = compared(course, crank, options)
    folder = made_folder(options.run / "press")
    course.to_csv(folder / "press.csv", index=False, float_format="%.7g")
    draw(course, folder / "press.png")
    print(f"ram with {', '.join(tools)}: largest force {course['force'].max():.4g} kN, energy "
          f"{course['energy'].iloc[-1]:.4g} kJ over {course['height'].iloc[0]:.4g} mm", folder, sep="\n")
    if options.verdict and over:
        sys.exit(1)
