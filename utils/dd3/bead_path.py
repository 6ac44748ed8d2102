# SPDX-License-Identifier: GPL-3.0-or-later
"""The path of a sheet through a round draw-bead in a steady flow, and the forces of the bead.

The sheet is bent at the entry shoulder, in reverse at the bead, and again at the exit shoulder. Once bent, it keeps its
curvature until the moment is reversed, at the next contact, unless tension straightens it before. Its middle is a chain
of arcs, each from a contact on, which end tangentially at the next tool, at most as curved as the tools. Its curvature
at the contact is higher by M/D, M the moment there, D the elastic stiffness, as the moment is zero in its middle. It is
straight where the moment is constant: an arc of the radius r that turns by more than a, r a^2 = 2 m/F with the sum m of
the moments at its ends and the tension F, ends in a straight part. The force on a tool is the difference of the forces
in the arcs before and behind it: the tension along the chord c, and m/c across.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from dd3.bent_section import Section, parts
from dd3.errors import Problem
from dd3.laws import Material

CLEARANCE, GAP = 1.2, 0.1  # over the thickness, of a bead for which they are not given
LAYERS, STEPS = 16, 20  # through the thickness; to a bend
PULLS = 4  # steps of the friction at a contact
PASSES, SAME, ZERO = 20, 2e-3, 1e-4  # largest number of passes; change of the force at the last one, over the uplift
WIDEST = 1e6  # radius of an arc, mm
CONTACT, LEAST = 1e-9, 1e-9  # difference of radii that are one, mm; least moment, N


@dataclass(frozen=True)
class Bead:
    """A round bead above a groove, and the sheet, mm.

    radius: of the bead; shoulder: of the edges of the groove; clearance: between the side of the bead and the wall of
    the groove; height: by which the bead presses the sheet into the groove; gap: between the plates besides the groove,
    beyond the thickness. friction: coefficient; clamping: force of the plates on the sheet before the bead, N/mm.
    """

    thickness: float
    radius: float
    shoulder: float
    clearance: float
    height: float
    gap: float
    friction: float = 0.0
    clamping: float = 0.0

    def __post_init__(self) -> None:
        if not (min(self.thickness, self.radius, self.shoulder, self.height, self.gap) > 0
                and min(self.friction, self.clamping) >= 0):
            raise Problem("a bead takes thickness, radius, shoulder, height and gap > 0, friction and clamping >= 0")
        if self.clearance < self.thickness:
            raise Problem(f"the clearance {self.clearance:g} mm is below the thickness {self.thickness:g} mm")
        if self.height + self.gap > self.half:
            raise Problem(f"the height {self.height:g} mm is above {self.half - self.gap:g} mm, the distance of the "
                          "middles of bead and shoulder less the gap; the sheet would touch the walls of the groove")

    @property
    def half(self) -> float:
        """Return the distance of the middles of bead and shoulder along the sheet, mm."""
        return self.radius + self.clearance + self.shoulder


@dataclass(frozen=True)
class Result:
    """What a bead does to the sheet: forces, N/mm, of restraint, and of the bead, the plate before and the one behind
    it upwards; curvatures, 1/mm; largest slopes, degrees, in the two flanks; strain of the thickness; equivalent
    plastic strains of the layers, from the lower face."""

    restraint: float
    bead: float
    entry: float
    exit: float
    curvatures: tuple[float, float, float]
    slopes: tuple[float, float]
    thinning: float
    plastic: np.ndarray

    @property
    def uplift(self) -> float:
        """Return the force by which the upper tool is lifted, N/mm."""
        return self.bead + self.entry + self.exit

    def force(self, friction: float) -> float:
        """Return `force` of *DRAWBEAD, N/mm: the restraint less the friction on the die, on which `normal`, the uplift,
        presses the sheet."""
        return max(self.restraint - friction * self.uplift, 0.0)


@dataclass(frozen=True)
class Arc:
    """An arc of the middle from a contact on: radius, mm, whether it ends in a straight part, slope at its end and
    angle, radian."""

    radius: float
    straight: bool
    slope: float
    angle: float


def tangent(across: float, apart: float, radii: float) -> tuple[float, float]:
    """Return the slope of the line that touches two circles from inside, radian, and the square of its length, by the
    distances of their middles and the sum of the radii; where they overlap that of the line between."""
    distance = math.hypot(across, apart)
    return math.atan2(across, apart) - math.acos(min(1.0, radii / distance)), distance**2 - radii**2


def arc_of(line: Callable[[float], tuple[float, float, float]], least: float, moments: float, force: float) -> Arc:
    """Return an arc; line: by its radius slope at its end, angle, radian, and square of the length of the straight
    part, mm2; least: radius of the tool. Without force it touches the next tool."""
    widest = least
    if line(least)[2] > 0:
        above = 2 * least
        while line(above)[2] > 0:
            above *= 2
            if above > WIDEST:
                raise Problem("the sheet does not reach the next tool of the bead")
        widest = float(brentq(lambda radius: line(radius)[2], least, above))

    def excess(radius: float) -> float:
        return radius * line(radius)[1]**2 - 2 * moments / force

    radius, straight = widest, force > 0 and excess(widest) > 0
    if straight:
        radius = least if excess(least) >= 0 else float(brentq(excess, least, widest))
    slope, angle, _ = line(radius)
    return Arc(radius, straight, slope, angle)


class Strip:
    """The steady flow of a sheet through a bead: arcs and forces by those of a pass before."""

    def __init__(self, material: Material, bead: Bead, direction: float, layers: int, steps: int) -> None:
        self.material, self.bead, self.direction, self.layers, self.steps = material, bead, direction, layers, steps
        self.middle = bead.radius + bead.thickness / 2  # radii of the middle of the sheet
        self.edge = bead.shoulder + bead.thickness / 2
        self.moments, self.forces, self.pressed = [0.0] * 3, [0.0] * 3, [0.0] * 4
        self.returned = [0.0] * 3  # elastic curvatures of the moments at the contacts, 1/mm
        self.rise = 1.0, 0.5  # integrals of k and of k (1 - x) over x = 0 to 1, M = x M1, over the curvature at M1

    def turn(self, radius: float) -> float:
        """Return the slope at which an arc of a radius, mm, begins at the entry shoulder, radian: between the plates
        the moment rises from nothing in proportion to the distance, and the curvature with it."""
        return self.rise[0] * math.sqrt(self.bead.gap / (self.rise[1] * radius))

    def arcs(self) -> list[Arc]:
        """Return the arcs at the entry shoulder, the bead and the exit shoulder."""
        half, height, middle, edge = self.bead.half, self.bead.height, self.middle, self.edge

        def down(radius: float) -> tuple[float, float, float]:
            turn, beyond = self.turn(radius), radius - edge
            slope, square = tangent(half + beyond * math.sin(turn), middle + edge - height + beyond * math.cos(turn),
                                    radius + middle)
            return slope, slope - turn, square

        entry = arc_of(down, edge, self.moments[0], self.forces[0])

        def up(radius: float) -> tuple[float, float, float]:
            beyond = radius - middle
            slope, square = tangent(half - beyond * math.sin(entry.slope),
                                    middle + edge - height + beyond * math.cos(entry.slope), radius + edge)
            return slope, slope + entry.slope, square

        bead = arc_of(up, middle, self.moments[1], self.forces[1])
        widest = edge + self.bead.gap / (1 - math.cos(bead.slope))
        flat = 2 * self.moments[2] / (self.forces[2] * bead.slope**2) if self.forces[2] > 0 else widest
        return [entry, bead, Arc(min(max(flat, edge), widest), flat < widest, 0.0, bead.slope)]

    def flow(self) -> Result:
        """Make a pass: bend the sheet along the arcs, and find the forces."""
        arcs, bead = self.arcs(), self.bead
        section = Section(self.material, bead.thickness, self.layers, self.direction)
        start = 2 * bead.friction * bead.clamping
        if start:
            section.pull(start, PULLS)
        reached = [min(1 / arc.radius + elastic, 1 / least) for arc, elastic, least in
                   zip(arcs, self.returned, (self.edge, self.middle, self.edge))]
        bent: list[float] = []
        unbent: list[float] = []
        moments: list[float] = []
        for curvature, radius, sign, pressed in zip(reached, (bead.shoulder, bead.radius, bead.shoulder), (1, -1, 1),
                                                    self.pressed):
            rising = np.abs(section.bend(sign * curvature, self.steps))
            if not moments:
                self.rise = integrals(rising)
            moments.append(float(rising[-1]))
            if bead.friction and pressed:
                # Friction acts at the tool, the force in the middle of the sheet.
                section.pull(section.force + bead.friction * pressed * radius / (radius + bead.thickness / 2), PULLS)
            bent.append(section.force)
            section.bend(0.0, self.steps)
            unbent.append(section.force)
        last = abs(section.moment)
        self.moments = [moments[0] + moments[1], moments[1] + moments[2], moments[2] + last]
        self.returned = [moments[0] / section.stiffness, moments[1] / section.stiffness, 0.0]
        self.forces = bent
        forces = self.flanks(arcs, bent, unbent)
        entry = moments[0] / math.sqrt(bead.gap / (reached[0] * self.rise[1]))
        # Behind the exit shoulder the sheet is elastic.
        behind = last / max(bead.thickness, math.sqrt(6 * bead.gap * section.stiffness / max(last, LEAST)))
        around = [self.around(i, arc) for i, arc in enumerate(arcs)]
        self.pressed = [math.hypot(forces[0][1] + entry, forces[0][0] - start) * around[0] + entry,
                        math.hypot(forces[0][1] + forces[1][1], forces[1][0] - forces[0][0]) * around[1],
                        math.hypot(forces[1][1] - forces[2][1], forces[2][0] - forces[1][0]) * around[2],
                        2 * behind - forces[2][1]]
        return Result(section.force + bead.friction * self.pressed[3], forces[0][1] + forces[1][1], entry,
                      behind - forces[2][1], (reached[0], reached[1], reached[2]),
                      (math.degrees(arcs[0].slope), math.degrees(arcs[1].slope)), -math.log(section.stretch),
                      section.plastic)

    def around(self, i: int, arc: Arc) -> float:
        """Return the sum of the pressure of a tool over its resultant: 1 of a point, x/sin x of an arc of 2 x."""
        if arc.radius > (self.middle if i == 1 else self.edge) + CONTACT or self.forces[i] <= 0:
            return 1.0
        half = (arc.angle - math.sqrt(2 * self.moments[i] / (self.forces[i] * arc.radius))) / 2
        return half / math.sin(half) if half > 0 else 1.0

    def flanks(self, arcs: list[Arc], bent: list[float], unbent: list[float]) -> list[tuple[float, float]]:
        """Return the forces in the three arcs, N/mm, along the sheet and across: downwards in the first one, upwards in
        the others."""
        entry, bead, leaving = arcs
        middle, edge, half = self.middle, self.edge, self.bead.half
        above = middle - self.bead.height  # of the middle of the bead, and of the shoulders, -edge
        turn = entry.slope - entry.angle
        touch = entry.slope
        if bead.straight and bead.radius <= middle + CONTACT:  # the sheet leaves the bead behind the first contact
            touch = -max(-entry.slope, bead.slope - math.sqrt(2 * self.moments[1] / (self.forces[1] * middle)))
        first = np.array([-half + edge * math.sin(turn), edge * math.cos(turn) - edge])
        lower, left = (np.array([-middle * math.sin(at), above - middle * math.cos(at)]) for at in (entry.slope, touch))
        last = np.array([half - edge * math.sin(bead.slope), edge * math.cos(bead.slope) - edge])
        found = []
        for i, (arc, chord) in enumerate(((entry, lower - first), (bead, last - left))):
            if arc.straight:
                found.append((unbent[i] * math.cos(arc.slope), unbent[i] * math.sin(arc.slope)))
            else:
                found.append(turned(bent[i], self.moments[i], float(np.hypot(*chord)),
                                    math.atan2(abs(chord[1]), chord[0])))
        along, across = turned(bent[2], -self.moments[2], 2 * leaving.radius * math.sin(bead.slope / 2), bead.slope / 2)
        return [*found, (along, across) if across < 0 else (unbent[2], 0.0)]


def integrals(moments: np.ndarray) -> tuple[float, float]:
    """Return the integrals of `Strip.rise`; moments: before and after each step of a bend."""
    curvatures = parts(len(moments) - 1)
    at = (curvatures[1:] + curvatures[:-1]) / 2
    part, steps = (moments[1:] + moments[:-1]) / (2 * moments[-1]), np.diff(moments) / moments[-1]
    return float(at @ steps), float((at * (1 - part)) @ steps)


def turned(force: float, moments: float, chord: float, slope: float) -> tuple[float, float]:
    """Return the components of a force along a chord and of the moments over its length across."""
    across = moments / chord
    return (force * math.cos(slope) - across * math.sin(slope), force * math.sin(slope) + across * math.cos(slope))


def flow(material: Material, bead: Bead, direction: float = 0.0, layers: int = LAYERS, steps: int = STEPS) -> Result:
    """Return what a bead does to a sheet that is drawn through it at an angle to the rolling direction, degrees."""
    strip, last = Strip(material, bead, direction, layers, steps), math.inf
    for _ in range(PASSES):
        result = strip.flow()
        if abs(result.restraint - last) <= SAME * result.restraint + ZERO * result.uplift:
            return result
        last = result.restraint
    raise Problem(f"the force of the bead does not converge in {PASSES} passes, {result.restraint:.4g} N/mm")
