# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare the force and the work of the tools of a run with a mechanical press: tonnage and energy over the stroke.

    dd3 press cup.out --ram punch --mirror x y
    dd3 press cup.out --ram die --whole 2 --stroke 400 --rod 1500 --force 2500 --rated 6.5 --energy 40 --verdict
    dd3 press flange.out --ram steel --mirror y --cam-friction 0.1
    dd3 press --stroke 400 --rod 1500 --table 60 --points 12 --rate 20

--ram names the tools on the ram, by default the one that controls the last phase with a controlling tool; their forces
against its motion are added. Other tools that the input file moves while the ram moves are driven by it: cams, whose
forces count with their path over that of the ram (virtual work). --cam-friction is the friction of a cam on its slide
and on the inclined face that drives it; --cams names those that the ram drives, if it does not drive all.

The stroke ends at the largest displacement of the ram, the bottom dead centre. With --stroke (twice the radius of the
crank, mm) and --rod (length of the connecting rod, mm) the table has the angle of the crank before the bottom dead
centre; with --force (kN) and --rated (height above the bottom dead centre at which the press has this force, mm) the
force that its torque allows at each height, and with --energy (kJ) the energy of a stroke is compared. --verdict ends
with exit code 1 if one is exceeded. press.csv and press.png are written into RUN/press.

--table prints the last --table mm of the stroke as move_table of a phase with control = load, with its duration at
--rate strokes per minute.
"""

import argparse
import sys
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from dd3.command import new_parser
from dd3.errors import Problem
from dd3.plot.figures import new_figure, save
from dd3.plot.force import controlling_tool, main_phase, vector
from dd3.programs import made_folder
from dd3.run import read_frame, read_job
from dd3.sheet import Sheet
from dd3.springback import tell_symmetry
from dd3.tables import tools_in

HALVINGS = 60  # of the angle, which leave less than the round-off
STILL = 1e-9  # path of an increment, over that of the ram, below which a tool does not move
ALONG = 1e-6  # sine of the angle between the paths of ram and tool below which this is not a wedge


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


def ram_course(history: pd.DataFrame, tools: Sequence[str], whole: int, cams: Sequence[str] = (),
               friction: float = 0.0, opening: Collection[str] = ()) -> pd.DataFrame:
    """Return the course of the ram down to the bottom dead centre: height above it, mm, force, kN, energy, kJ, and the
    force of each tool on the ram, kN. whole: number of images of the model. cams: tools that the ram drives, with a
    friction of their slides. opening: phases in which the ram is withdrawn."""
    path = vector(history, tools[0], "u")
    path -= path[0]  # the displacement begins at the position of the input file
    last = int(np.where(history["phase"].isin(opening), 0.0, np.linalg.norm(path, axis=1)).argmax())
    if not last:
        raise Problem(f"the tool '{tools[0]}' does not move; expected one on the ram")
    direction = path[last] / np.linalg.norm(path[last])
    travel = path[:last + 1] @ direction
    steps = np.diff(travel)
    # At the end and at the beginning of each increment; the force of the sheet on a tool is against the motion.
    ends = np.s_[1:last + 1], np.s_[:last]
    both = {tool: np.stack([-vector(history, tool, "f")[rows] @ direction for rows in ends]) for tool in tools}
    for cam in cams:
        paths, forces = np.diff(vector(history, cam, "u")[:last + 1], axis=0), vector(history, cam, "f")
        both[cam] = np.stack([driven(cam, paths, forces[rows], steps, direction, friction) for rows in ends])
    shares = {tool: whole * np.insert(end, 0, begin[0]) / 1000 for tool, (end, begin) in both.items()}
    work = whole * sum(end + begin for end, begin in both.values()) / 2 * steps
    course = pd.DataFrame({"height": travel[-1] - travel, "force": sum(shares.values()),
                           "energy": np.concatenate(([0.0], np.cumsum(work))) / 1e6})
    if len(shares) > 1:
        course = course.assign(**{f"force_{tool}": share for tool, share in shares.items()})
    return course


def driven(name: str, paths: np.ndarray, forces: np.ndarray, steps: np.ndarray, ram: np.ndarray, friction: float
           ) -> np.ndarray:
    """Return the forces (n) with which a cam loads the ram in increments, N: by the paths of the cam (n, 3) and the ram
    (n), the forces of the sheet on the cam (n, 3) and the direction of the ram.

    The ram pushes the cam by a plane face. This slides on the cam, so that it is along the relative motion; with the
    friction and the normal force of the slide, which is across the path of the cam, two equations in the plane of both
    paths have the forces of the face and of the slide. A force across this plane is taken by the sides of the slide.
    """
    found = np.zeros(len(steps))
    moves = np.linalg.norm(paths, axis=1) > STILL * np.abs(steps).max()
    for i in np.flatnonzero(moves & (steps > STILL * np.abs(steps).max())):
        along = paths[i] / np.linalg.norm(paths[i])
        ratio = np.linalg.norm(paths[i]) / steps[i]
        across = ram - (ram @ along) * along
        sine = np.linalg.norm(across)
        resisting = -forces[i] @ along
        if not friction or sine < ALONG:
            if friction and abs(ratio * (ram @ along) - 1) > ALONG:
                raise Problem(f"--cam-friction: the tool '{name}' moves along the ram, by {ratio:.4g} mm for 1 mm of "
                              "it; expected a cam at an angle to it")
            found[i] = resisting * ratio
            continue
        across /= sine
        tangent = ram - ratio * along
        tangent /= np.linalg.norm(tangent)
        normal = np.array([tangent @ across, -(tangent @ along)])  # in the plane: along and across
        normal *= np.sign(normal[0])
        push = normal + friction * np.array([tangent @ along, tangent @ across])
        aside = forces[i] @ np.cross(along, across)
        found[i] = slide(name, push, resisting, -forces[i] @ across, friction, abs(aside)) * (
            push @ np.array([ram @ along, ram @ across]))
    return found


def slide(name: str, push: np.ndarray, resisting: float, across: float, friction: float, aside: float) -> float:
    """Return the normal force of the face that pushes a cam, N: push is the force of the face over it, along and across
    the path; resisting, across: forces that the cam exerts on the sheet; aside: on the sides of the slide."""
    for sign in (1.0, -1.0):  # of the normal force of the slide on the cam
        # push n = (resisting + friction (sign g + aside), across - g)
        matrix = np.array([[push[0], -sign * friction], [push[1], 1.0]])
        if np.linalg.det(matrix) <= 0:
            continue
        normal, guide = np.linalg.solve(matrix, [resisting + friction * aside, across])
        if sign * guide >= 0:
            return float(normal)
    raise Problem(f"--cam-friction: the slide of '{name}' locks with a friction of {friction:g}")


def opening_phases(run: Path, tool: str) -> set[str]:
    """Return the phases of a run in which a tool is withdrawn."""
    if not (run / "run.json").is_file():
        return set()
    return {phase["name"] for phase in read_job(run)["phases"]
            if any(one["name"] == tool and one["motion"] == "withdrawn" for one in phase["tools"])}


def cams_of(run: Path, history: pd.DataFrame, tools: Sequence[str]) -> list[str]:
    """Return the tools beside those on the ram that are moved in phases in which the ram moves."""
    moving = np.flatnonzero(np.abs(np.diff(vector(history, tools[0], "u"), axis=0)).max(axis=1) > 0) + 1
    names = set(history["phase"].to_numpy(str)[moving])
    if not (run / "run.json").is_file():
        return []
    moved = {tool["name"] for phase in read_job(run)["phases"] if phase["name"] in names
             for tool in phase["tools"] if tool["motion"] == "moved" and any(tool["displacement"] or ())}
    return [tool for tool in tools_in(history) if tool in moved and tool not in tools]


def compared(course: pd.DataFrame, crank: Crank | None, options: argparse.Namespace) -> list[str]:
    """Add angle and allowed force to the course; return what is exceeded."""
    height, over = course["height"].to_numpy(), []
    if crank:
        if height[0] > 2 * crank.radius:
            raise Problem(f"the ram moves by {height[0]:.4g} mm, the stroke is {2 * crank.radius:.4g} mm")
        course["angle"] = np.degrees(crank.angle(height))
    if crank and options.force:
        course["allowed"] = crank.allowed(height, options.force, options.rated)
        row = course.iloc[int((course["force"] / course["allowed"]).to_numpy().argmax())]
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
    parser.add_argument("--cams", nargs="*", metavar="TOOL",
                        help="tools that the ram drives (default: all that are moved while it moves)")
    parser.add_argument("--cam-friction", type=float, default=0.0, metavar="MU",
                        help="friction of the cams on their slides and on the faces that drive them (0)")
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
    if options.cam_friction < 0 or set(options.cams or ()) & set(options.ram):
        parser.error("--cam-friction is 0 or more, --cams are other tools than --ram")
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
    for tool in [*tools, *(options.cams or ())]:
        if tool not in tools_in(history):
            raise Problem(f"no tool '{tool}'; there are: {', '.join(tools_in(history))}")
    cams = cams_of(options.run, history, tools) if options.cams is None else options.cams
    if options.whole == 1 and (options.run / "fields.vtkhdf").is_file():
        sheet = Sheet(options.run)
        tell_symmetry(sheet, sheet.last, options.mirror, "forces and energy are those of a part",
                      "--mirror (or --whole)")
    course = ram_course(history, tools, options.whole * 2**len(set(options.mirror)), cams, options.cam_friction,
                        opening_phases(options.run, tools[0]))
    over = compared(course, crank, options)
    folder = made_folder(options.run / "press")
    course.to_csv(folder / "press.csv", index=False, float_format="%.7g")
    draw(course, folder / "press.png")
    for cam in cams:
        print(f"cam {cam}: largest force on the ram {course[f'force_{cam}'].max():.4g} kN")
    print(f"ram with {', '.join([*tools, *cams])}: largest force {course['force'].max():.4g} kN, energy "
          f"{course['energy'].iloc[-1]:.4g} kJ over {course['height'].iloc[0]:.4g} mm", folder, sep="\n")
    if options.verdict and over:
        sys.exit(1)
