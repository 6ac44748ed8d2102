# SPDX-License-Identifier: GPL-3.0-or-later
"""The phases of an input file by the stages of a process."""
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from dd3.dyna.laws import Units
from dd3.dyna.process import History, Stage, divided

TRIAL = 0.5, 0.05  # trial increment of a tool, mm, at most this part of its displacement
AT_ONCE = 1.0  # time of what the deck does at once, s: slow
LITTLE = 1e-3  # of a force that ends at 0, where the phase has no table
EARTH = 9.81e3  # mm/s2


def numbers(values: Iterable[float]) -> str:
    """Return numbers as words."""
    return " ".join(f"{round(value, 9) + 0.0:.6g}" for value in values)


@dataclass
class Names:
    """What the phases need of tools and blank: names of the tools, their nodes and centres (mm) by number, the number
    of the blank's nodes in a set, the size of its elements (mm), notes for the user."""

    tools: list[str]
    points: Callable[[int], tuple[np.ndarray, np.ndarray]]
    members: Callable[[int], int]
    size: float
    units: Units
    notes: list[str]
    timed: bool = False  # whether a law of the strain rate needs the time of the phases


class Phases:
    """The lines of the phases, with the forces and the gravity that act at the end of the last one."""

    def __init__(self, names: Names) -> None:
        self.names, self.count = names, 0
        self.lines: list[str] = []
        self.pressed: dict[int, np.ndarray] = {}
        self.loaded: dict[int, np.ndarray] = {}
        self.gravity = np.zeros(3)

    def add(self, stages: Iterable[Stage]) -> None:
        """Add the phases of stages."""
        for stage in stages:
            for tool in stage.moving & stage.forces.keys():
                if tool in stage.moves:
                    self.names.notes.append(f"tool {self.names.tools[tool]} is moved and pressed from "
                                            f"{stage.begins:g} to {stage.ends:g}; its motion goes before")
                    del stage.forces[tool]
            for part in divided(stage, self.divisions(stage)):
                self.start(part)
                self.phase(part)

    def divisions(self, stage: Stage) -> list[float]:
        """Return the points of the progress at which a stage is divided: a tool that is pressed anew later than the
        start, and where the histories are not those of one table."""
        points: list[float] = []
        others = [history for history in (*stage.loads.values(), stage.gravity)
                  if history and len(history.progress) > 2]
        for tool, history in stage.forces.items():
            zero = np.abs(history.values).max(axis=1) == 0
            if tool not in self.pressed and len(zero) > 2 and zero[0] and zero[1]:
                points.append(float(history.progress[int(np.flatnonzero(~zero)[0]) - 1]))
        changing = [history for history in stage.forces.values() if np.ptp(history.values, axis=0).any()]
        kinks = [history for history in changing if len(history.progress) > 2]
        if others or (kinks and (len(changing) > 1 or table_of(changing[0]) is None)):
            points += [float(point) for history in (*others, *kinks) for point in history.progress[1:-1]]
        return points

    def start(self, stage: Stage) -> None:
        """Add a phase for what acts at once at the start of a stage."""
        lines, steps = [], {}
        for tool, history in stage.forces.items():
            before = self.pressed.get(tool, np.zeros(3))
            if history.first.any() and not np.allclose(history.first, before, rtol=1e-3):
                steps[tool] = history.first
        for tool, force in steps.items():
            lines.append(self.press(tool, force))
            self.pressed[tool] = force
        if stage.gravity is not None and not np.allclose(stage.gravity.first, self.gravity):
            lines.append(self.gravity_line(stage.gravity.first))
        for number, history in stage.loads.items():
            if history.first.any() and not np.allclose(history.first, self.loaded.get(number, np.zeros(3)), rtol=1e-3):
                lines.append(self.load(number, history.first))
        if lines:
            self.head("press" if steps else "gravity" if any("gravity" in line for line in lines) else "load",
                      f"At {stage.begins:g}, before tools move.")
            self.lines += ["  control = load", "  trial = 0.1", *self.duration(AT_ONCE), *lines, ""]

    def duration(self, time: float) -> list[str]:
        """Return the line of a time, s, if it is needed."""
        return [f"  duration = {time:.6g}"] if self.names.timed else []

    def head(self, kind: str, comment: str) -> None:
        """Begin a phase."""
        self.count += 1
        self.lines += [f"# {comment}", f"*PHASE {kind}_{self.count}"]

    def phase(self, stage: Stage) -> None:
        """Add the phase of a stage; none if nothing changes in it."""
        lines = self.force_lines(stage)
        for number in self.loaded.keys() | stage.loads.keys():
            end = stage.loads[number].last if number in stage.loads else np.zeros(3)
            if not np.allclose(end, self.loaded.get(number, np.zeros(3))):
                lines.append(self.load(number, end))
        if stage.gravity is not None and not np.allclose(stage.gravity.last, self.gravity):
            lines.append(self.gravity_line(stage.gravity.last))
        if not stage.moving and not lines:
            return
        kind = "move" if stage.moving else "press" if any("press" in line for line in lines) else (
            "load" if any("load =" in line for line in lines) else "gravity")
        self.head(kind, f"From {stage.begins:g} to {stage.ends:g}.")
        self.lines += self.motion_lines(stage) if stage.moving else ["  control = load", "  trial = 0.1"]
        self.lines += [*self.duration((stage.ends - stage.begins) * self.names.units.time), *lines, ""]

    def force_lines(self, stage: Stage) -> list[str]:
        """Return the lines with the forces on tools that change, and their table."""
        lines = []
        changing = {}
        for tool, history in stage.forces.items():
            if not np.allclose(history.values, self.pressed.get(tool, np.zeros(3)), rtol=1e-3):
                changing[tool] = history
        for tool in self.pressed.keys() - stage.forces.keys() - stage.moves.keys():
            if self.pressed[tool].any() and np.linalg.norm(self.pressed[tool]) > 0:
                changing[tool] = History(np.array([0.0, 1.0]), np.array([self.pressed[tool], np.zeros(3)]))
        table = None
        if len(changing) == 1:
            table = table_of(next(iter(changing.values())))
        for tool, history in changing.items():
            if table and not (len(table[1]) == 2 and table[1][1] == 1.0):
                lines += [self.press(tool, table[0]), "  press_table = " + "  ".join(
                    f"{s:.6g} {f:.6g}" for s, f in zip(table[1][::2], table[1][1::2]))]
            else:
                largest = history.values[int(np.linalg.norm(history.values, axis=1).argmax())]
                lines.append(self.press(tool, history.last if history.last.any() else LITTLE * largest))
            self.pressed[tool] = history.last
        for tool in stage.moves.keys() & self.pressed.keys():
            del self.pressed[tool]
        for tool in [tool for tool, force in self.pressed.items() if not force.any()]:
            del self.pressed[tool]
        return lines

    def motion_lines(self, stage: Stage) -> list[str]:
        """Return the lines of a phase that move and turn tools."""
        moves = {tool: move * self.names.units.length for tool, move in stage.moves.items()}
        lines = [f"  move = {self.names.tools[tool]} {numbers(move)}" for tool, move in moves.items()]
        part = 0.1  # of the phase, in the trial increment
        for tool, turn in stage.turns.items():
            points, centre = self.names.points(tool)
            angle, axis = float(np.linalg.norm(turn)), turn / np.linalg.norm(turn)
            if np.count_nonzero(turn) > 1:
                self.names.notes.append(f"tool {self.names.tools[tool]}: turns about several axes are taken as one")
            path = angle * float(np.linalg.norm(np.cross(points - centre, axis), axis=1).max())
            part = float(np.clip(self.names.size / 4 / path, 1e-4, part)) if path > 0 else part
            lines.append(f"  turn = {self.names.tools[tool]} {numbers(centre)}  {numbers(axis)}  "
                         f"{np.degrees(angle):.6g}")
        if not moves:
            return ["  control = load", f"  trial = {part:.3g}", *lines]
        leader = max(moves, key=lambda tool: float(np.linalg.norm(moves[tool])))
        length = float(np.linalg.norm(moves[leader]))
        trial = min(TRIAL[0], min(TRIAL[1], part) * length)
        return [f"  control = {self.names.tools[leader]}", f"  trial = {trial:.3g}", *lines]

    def press(self, tool: int, force: np.ndarray) -> str:
        """Return the line that presses a tool."""
        return f"  press = {self.names.tools[tool]} {numbers(force * self.names.units.force)}"

    def load(self, number: int, force: np.ndarray) -> str:
        """Return the line with the force on a set of nodes."""
        self.loaded[number] = force
        return f"  load = load_{number} {numbers(force * self.names.units.force * self.names.members(number))}"

    def gravity_line(self, value: np.ndarray) -> str:
        """Return the line with the gravity."""
        self.gravity = value
        return f"  gravity = {numbers(value * self.names.units.acceleration)}"


def table_of(history: History) -> tuple[np.ndarray, list[float]] | None:
    """Return the largest force of a history and pairs of progress and factor behind the start; None if it is not
    that of one table: its direction changes."""
    largest = history.values[int(np.linalg.norm(history.values, axis=1).argmax())]
    factors = history.values @ largest / max(float(largest @ largest), 1e-300)
    if factors.min() < -1e-9 or not np.allclose(np.outer(factors, largest), history.values,
                                                atol=1e-3 * float(np.abs(largest).max())):
        return None
    if len(history.progress) == 2 and factors[-1] > 0:
        return history.last, [1.0, 1.0]
    return largest, [value for pair in zip(history.progress[1:], np.maximum(factors[1:], 0.0)) for value in pair]
