# SPDX-License-Identifier: GPL-3.0-or-later
"""Springback: the free sheet against the drawn one."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dd3.alignment import kabsch
from dd3.errors import LOG
from dd3.sheet import AXES, Line, Sheet, in_plane, length, of_pieces

ROUND_OFF = 1e-9  # distance from a plane, over the size of the sheet, of nodes that supports hold there
ENDS = 0.1, 0.9  # places along the sheet at which the rotations are compared, over its length


class Springback(NamedTuple):
    """The drawn and the free shape, the latter moved to the best fit.

    drawn, free: positions of the nodes of the drawn mesh, mm. step: number of the step of the drawn shape. mirror:
    planes of symmetry on which the fit keeps the sheet.
    """

    drawn: np.ndarray
    free: np.ndarray
    step: int
    mirror: Sequence[str] = ()

    def distance(self) -> np.ndarray:
        """Return the distance of each node from its place in the drawn shape, mm."""
        return np.asarray(np.linalg.norm(self.free - self.drawn, axis=1))


def images(points: np.ndarray, mirror: Sequence[str]) -> list[np.ndarray]:
    """Return points and their mirror images."""
    parts = [points]
    for axis in mirror:
        factor = np.where(np.arange(3) == AXES.index(axis), -1.0, 1.0)
        parts += [part * factor for part in parts]
    return parts


def best_fit(points: np.ndarray, target: np.ndarray, mirror: Sequence[str] = (), weights: np.ndarray | None = None
             ) -> np.ndarray:
    """Return points moved as a rigid body, with their mirror images, to the least squares of the distances.

    weights: those of the squares, such as the areas of nodes, without which the fit depends on the mesh; equal by
    default.
    """
    whole, goal = np.concatenate(images(points, mirror)), np.concatenate(images(target, mirror))
    part = np.ones(len(points)) if weights is None else weights
    return kabsch(whole, goal, np.tile(part, len(whole) // len(points))).of(points)


def symmetry(start: np.ndarray, *shapes: np.ndarray) -> list[str]:
    """Return the axes of the planes x, y, z = 0 that bound the sheet at the start and hold its nodes there in other
    shapes too: planes of symmetry of the model. One along whose normal no node moves, as in plane strain, is left out.
    Positions of nodes, mm."""
    near = ROUND_OFF * np.ptp(start, axis=0).max()
    found = []
    for axis, own, *others in zip(AXES, start.T, *(shape.T for shape in shapes)):
        on = np.abs(own) <= near
        bounds = on.any() and (own.min() >= -near or own.max() <= near)
        if bounds and all(np.abs(other[on]).max() <= near for other in others) \
                and any(np.abs(other - own).max() > near for other in others):
            found.append(axis)
    return found


def unnamed(sheet: Sheet, step: int, mirror: Sequence[str]) -> list[str]:
    """Return the planes of symmetry that are named and those on which the model keeps the sheet, where one of the
    latter is not named; else none."""
    planes = sorted({*mirror, *symmetry(sheet.start(step), sheet.points(step))})
    return [] if planes == sorted(set(mirror)) else planes


def tell_symmetry(sheet: Sheet, step: int, mirror: Sequence[str], effect: str, option: str) -> None:
    """Warn of planes of symmetry of the model that an option does not name, and of the effect."""
    planes = unnamed(sheet, step, mirror)
    if planes:
        LOG.warning(f"{effect}, as the model keeps the border of the sheet on planes of symmetry; expected for {option}"
                    f": {' '.join(planes)}")


def kept(mirror: Sequence[str]) -> str:
    """Return words on the planes of symmetry on which a best fit keeps the sheet; none without."""
    planes = ", ".join(f"{axis} = 0" for axis in mirror)
    return planes and f", on the plane{'s' if len(mirror) > 1 else ''} of symmetry {planes}"


def steps_with_tools(sheet: Sheet, phases: Sequence[dict]) -> np.ndarray:
    """Return the steps of the phases at whose end tools act on the sheet, not of those that open them; phases: those of
    run.json."""
    of_step = sheet.file["job"].get("phase")
    if of_step is None:
        return np.array([], int)
    numbers = np.array(of_step[: sheet.count])
    held = []
    for phase in phases:
        own = np.flatnonzero(numbers == phase["number"])
        if own.size and any(tool["active"] for tool in phase["tools"]) and touched(sheet, int(own[-1])):
            held.append(phase["number"])
    return np.flatnonzero(np.isin(numbers, held))


def touched(sheet: Sheet, step: int) -> bool:
    """Whether a tool touches the sheet at a step; true for results without contact."""
    return "contact_status" not in sheet.grid["PointData"] or bool(sheet.values(step, "contact_status")[0].any())


def state_of(phase: dict) -> str:
    """Return the state of a phase, ended where run.json does not tell."""
    return str(phase.get("result", {}).get("state", "ended"))


def unfinished(phases: Sequence[dict]) -> str:
    """Return words on a release, the last phase of a run, that has not ended; none without one, or where it has ended.

    phases: those of run.json.
    """
    held = [any(tool["active"] for tool in phase["tools"]) for phase in phases]
    if held[-1] or not (any(held) or phases[0].get("unload")):
        return ""
    progress = f"{100 * (phases[-1].get('result', {}).get('progress') or 0.0):.3g} %"
    return {"ended": "", "pending": "the release has not begun", "running": f"the release is at {progress}"}.get(
        state_of(phases[-1]), f"the release ended at {progress}")


def find(sheet: Sheet, phases: Sequence[dict], mirror: Sequence[str] = ()) -> Springback | None:
    """Return the springback of a run whose last phase releases all tools and has ended; None for another one. A run
    that only releases a sheet of another one takes that over in its drawn shape.

    phases: those of run.json. mirror: planes of symmetry of the model beside those on which its supports keep it.
    """
    if not phases or state_of(phases[-1]) != "ended":
        return None
    drawn = steps_with_tools(sheet, phases)
    if not drawn.size and phases[0]["unload"]:
        drawn = np.array([0])
    if not drawn.size or drawn[-1] == sheet.count - 1:
        return None
    step = int(drawn[-1])
    points, free = sheet.points(step), sheet.points(sheet.last)[sheet.nodes_in(step, sheet.last)]
    planes = sorted({*mirror, *symmetry(sheet.start(step), points, free)})
    return Springback(points, best_fit(free, points, planes, sheet.areas(step)), step, planes)


def rotation(line: Line, found: Springback, normal: np.ndarray) -> float:
    """Return the mean rotation of a section in its plane along its length, counter-clockwise, degrees."""
    drawn, free = (in_plane(line.at(points), normal) for points in (found.drawn, found.free))
    parts = np.diff(length(drawn))
    weights = np.append(parts, 0.0) + np.insert(parts, 0, 0.0)
    a, b = (points - np.average(points, axis=0, weights=weights) for points in (drawn, free))
    return float(np.degrees(np.arctan2(weights @ (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]),
                                       weights @ (a * b).sum(axis=1))))


def opening(line: Line, found: Springback, normal: np.ndarray) -> tuple[float, float]:
    """Return the change of the direction of a section at its two ends against that of the whole section, degrees."""
    mean = rotation(line, found, normal)
    drawn, free = (in_plane(line.at(points), normal) for points in (found.drawn, found.free))
    changes = []
    for i, j in ((0, 1), (-2, -1)):
        before, after = drawn[j] - drawn[i], free[j] - free[i]
        angle = np.degrees(np.arctan2(before[0] * after[1] - before[1] * after[0], before @ after))
        changes.append(float(angle) - mean)
    return changes[0], changes[1]


def twist(sheet: Sheet, found: Springback, said: list[str] | None = None) -> tuple[str, float] | None:
    """Return the axis along the sheet and the rotation of its upper end about it against the lower one, right-handed,
    degrees; None where symmetry prevents it. said: list to which words on sections in several pieces are added."""
    start = sheet.start(found.step)
    sizes = np.ptp(start, axis=0)
    axis = int(sizes.argmax())
    if found.mirror:
        return None
    turned = []
    for part in ENDS:
        normal, place = np.eye(3)[axis], start[:, axis].min() + part * sizes[axis]
        lines = sheet.cut(normal, place, step=found.step)
        turned.append(rotation(lines[0], found, normal))
        if said is not None and (words := of_pieces(lines, start)):
            said.append(f"section {AXES[axis]}={place:.6g}: {words}")
    # Sections are seen with x to the right and z upwards, so those normal to y against y.
    return AXES[axis], (turned[1] - turned[0]) * (-1.0 if AXES[axis] == "y" else 1.0)
