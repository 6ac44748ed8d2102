# SPDX-License-Identifier: GPL-3.0-or-later
"""Force with which a pad holds the floor by friction, and holes of the floor in which pins locate it.

A flange that is drawn from under the holder pulls at the floor, per length, by its friction on both sides and by the
bending and straightening of a rigid-plastic sheet over the shoulder, sigma t^2/(2 r) about the radius r of its middle
(Siebel and Beisswänger, Tiefziehen, 1955); the friction about shoulder and punch radius cancel each other.

A leg without holder is wiped: bent by the moment M = sigma t^2/4 about the punch radius, it is pressed against the
shoulder by M/l. The arm l between both, along the leg, is l^2 = (R + c)^2 + h^2 - R^2: R the sum of both radii and the
thickness, c the clearance, h the height between their centres. It becomes small as the leg becomes vertical.

Locating pins hold the floor where it would slide a little. What pulls at it is then, by the moments about the centre of
the punch radius, through which the forces of the punch pass, M/r about the radius r of the sheet's middle: the floor is
flat beside the bend and has no moment there. The pins carry what the friction on both sides of the pad does not; by
their bearing pressure, force over diameter and thickness, the hole yields from the yield stress of the sheet on.
"""
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dd3.part.loops import Hole
from dd3.tools.moved import rotation
from dd3.tools.plane import inside
from dd3.tools.settings import ToolSettings
from dd3.tools.surface import Surface, points_at

if TYPE_CHECKING:
    from dd3.tools.tool_set import ToolSet

# Force of the pad over that with which a leg is pressed against the shoulder. Its friction on the shoulder alone would
# need 1/2; with that the floor of an angle of 2 mm slides by 0.7 mm, with 1.5 by 0.1 mm, as the punch radius wedges it.
OF_LEG = 1.5
# Strain in plane strain at which the sheet is taken to yield, and its stress in tension over that there (von Mises).
PROOF, YIELD = 0.002, 3**0.5 / 2
# Least clearance that counts, over the thickness.
CLEARANCE = 0.05
# Height of a hole over the floor, over the thickness, that is in it.
IN_FLOOR = 1.5
# Cosine between the axis of a hole and z that is along z.
UPRIGHT = 0.999


@dataclass
class Pull:
    """What pulls at the floor along a rim: the integral of its directions outwards (3), mm, and whether a holder is on
    the flange there; else the leg is wiped."""

    along: np.ndarray
    held: bool


@dataclass
class Pin:
    """A hole of the floor in which a pin locates the sheet: words, place in plan (2), and the diameter of the pin, the
    least size of the hole, mm."""

    words: str
    place: np.ndarray
    diameter: float


def needed(tools: "ToolSet", stress: Callable[[float], float], holder: float, options: ToolSettings,
           friction: float) -> float:
    """Return the force of the pad, N. stress: by the strain in plane strain, MPa; holder: its force, N."""
    t = options.thickness
    held = held_of(tools, stress, holder, options, friction)
    centres = tools.shoulder + tools.bend + t
    clearance = max(options.clearance, CLEARANCE * t)
    height = max(centres - tools.travel, 0.0)
    arm = ((centres + clearance)**2 + height**2 - centres**2)**0.5
    wiped = OF_LEG * stress(t / (4 * (tools.bend + t / 2))) * t**2 / 4 / arm
    return float(np.linalg.norm(sum(pull.along * (held if pull.held else wiped) for pull in tools.pulls)))


def held_of(tools: "ToolSet", stress: Callable[[float], float], holder: float, options: ToolSettings,
            friction: float) -> float:
    """Return the force of the pad, over the length of the rim, that holds a flange under the holder, N/mm; arguments as
    of `needed`."""
    t = options.thickness
    middle = tools.shoulder + t / 2
    length = sum(float(np.linalg.norm(pull.along)) for pull in tools.pulls if pull.held)
    return holder / max(length, t) + stress(t / (4 * middle)) * t**2 / (2 * middle) / (2 * friction)


def pull_of_floor(tools: "ToolSet", stress: Callable[[float], float], holder: float, options: ToolSettings,
                  friction: float) -> np.ndarray:
    """Return the force with which legs and flanges pull at a floor that pins hold (3), N; arguments as of `needed`."""
    t, middle = options.thickness, tools.bend + options.thickness / 2
    wiped = stress(t / (4 * middle)) * t**2 / (4 * middle)
    held = 2 * friction * held_of(tools, stress, holder, options, friction)
    return np.asarray(sum(pull.along * (held if pull.held else wiped) for pull in tools.pulls))


def bearing(found: Sequence[Pin], pull: np.ndarray, stress: Callable[[float], float], thickness: float) -> float:
    """Return the force along a pull, N, from which on pins widen their holes, each by the same force."""
    axis = int(np.abs(pull[:2]).argmax())
    diameters = sum(pin.diameter for pin, axes in zip(found, axes_of(found)) if axis in axes)
    return diameters * thickness * YIELD * stress(PROOF)


def axes_of(found: Sequence[Pin]) -> list[tuple[int, ...]]:
    """Return the axes along which pins hold the blank: the first one both, the second one that across their distance,
    against a turn about the first."""
    first: list[tuple[int, ...]] = [(0, 1)]
    if len(found) < 2:
        return first[:len(found)]
    return [*first, (int(np.abs(found[1].place - found[0].place).argmin()),)]


def with_pins(tools: "ToolSet", stress: Callable[[float], float], holder: float, options: ToolSettings,
              friction: float) -> float:
    """Return the force of the pad, N, that leaves to the pins no more than their holes bear, 0 without pins; arguments
    as of `needed`."""
    if not tools.pins:
        return 0.0
    pull = pull_of_floor(tools, stress, holder, options, friction)
    left = float(np.linalg.norm(pull)) - bearing(tools.pins, pull, stress, options.thickness)
    return max(left, 0.0) / (2 * friction)


def pins(holes: Sequence[Hole], floor: Surface, options: ToolSettings) -> list[Pin]:
    """Return the holes of a level floor, in the coordinates of the placed part, in which pins locate it: the two
    farthest from each other."""
    around = points_at(floor.net, np.array([0.0, 1.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0, 1.0]))
    level = around[..., 2].mean()
    if np.ptp(around[..., 2]) > options.tolerance:
        return []
    matrix = rotation(options.rotate)
    found = []
    for hole in holes:
        axis = matrix @ hole.loop.area / np.linalg.norm(hole.loop.area)
        place = matrix @ hole.centre + np.array(options.move)
        over = any(inside(place[None, :2], corners)[0] for corners in around[..., :2])
        if abs(axis[2]) > UPRIGHT and over and abs(place[2] - level) < IN_FLOOR * options.thickness:
            found.append(Pin(hole.words, place[:2], min(hole.size)))
    if len(found) < 2:
        return found
    apart = np.linalg.norm([[a.place - b.place for b in found] for a in found], axis=2)
    first, second = divmod(int(apart.argmax()), len(found))
    return [found[first], found[second]]
