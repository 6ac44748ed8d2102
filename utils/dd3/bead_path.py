# SPDX-License-Identifier: GPL-3.0-or-later
"""The path of a sheet through a round draw-bead in a steady flow, and the forces of the bead.

The sheet is bent at the entry shoulder, in reverse at the bead, again at the exit shoulder, and flattened at the plate
behind it. Between the tools it is free (`bead_span`): the moment passes there from one sign to the other, and the sheet
is bent in reverse before it reaches the next tool. At a tool it is as curved as the tool and follows it over an angle,
or touches it at one place with a smaller curvature. The unknowns are that angle or curvature at each tool, the slopes
at which the sheet comes to bead and exit shoulder, and the place where it touches the plate; the conditions are that
each free part is tangential at both ends. They are solved for with the moments of a pass of a section along the path,
which is repeated with the curvatures found until the force settles.

The force on a tool is the difference of the forces before and behind it. It spreads at 45 degrees to the middle of the
sheet, over a length of one thickness: as long as the sheet comes to the tool within half of this length, the force over
the thickness presses on it, falling to nothing at the other face. The sheet stretches the more in the bend.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from dd3.bead_span import NODES, Branch, Span, Start, free_span
from dd3.bent_section import Section, parts
from dd3.errors import Problem
from dd3.laws import Material

CLEARANCE, GAP = 1.2, 0.1  # over the thickness, of a bead for which they are not given
LAYERS, STEPS, COARSE = 16, 20, (8, 10)  # through the thickness; to a bend; both before the bead is closed
PULLS = 4  # steps of the friction at a contact
PASSES, SAME, ZERO = 30, 2e-3, 5e-4  # largest number of passes; change of the forces at the last one, of it over uplift
SIDES = 1, -1, 1  # of the tools: 1 below the sheet, -1 above
START = -0.8, -0.7, -0.7, 0.0, -0.1, 6.0  # unknowns of a low bead: see Strip.unknowns; the last over the thickness
LOWEST, WIDEST, FARTHEST = -0.995, 2.5, 80.0  # bounds of the unknowns; the last over the thickness
SCALES = 0.1, 0.1, 0.1, 0.05, 0.05, 1.0
FOUND = 1e-4  # largest residual of the path, radian
EVALUATIONS, SHORTEST = 60, 0.05  # of the path; step of the height over the thickness
NEAR, HALF = 0.5, 0.5  # thicknesses before a tool within which it presses; relaxation of the pressure
LEAST = 1e-9  # moment, N


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
class Path:
    """A path of the sheet: curvatures at the three tools, 1/mm; slopes where it comes to them and leaves them, radian;
    distance before the entry shoulder from which it is lifted, mm; free parts; residual, radian."""

    curvatures: list[float]
    coming: list[float]
    leaving: list[float]
    lifted: float
    spans: list[Span]
    residual: np.ndarray


class Strip:
    """The steady flow of a sheet through a bead; the path follows from the moments of a pass, and the reverse.

    unknowns: of each of the three tools the curvature of the sheet over its own less 1, or the angle over which the
    sheet follows it, radian; slopes where the sheet comes to bead and exit shoulder; place where it touches the plate.
    """

    def __init__(self, material: Material, bead: Bead, direction: float, layers: int, steps: int) -> None:
        self.material, self.bead, self.direction, self.layers, self.steps = material, bead, direction, layers, steps
        edge, middle = bead.shoulder + bead.thickness / 2, bead.radius + bead.thickness / 2
        self.radii, self.height = (edge, middle, edge), 0.0
        self.unknowns = np.array(START)
        self.unknowns[5] = bead.half + START[5] * bead.thickness
        self.offsets = [np.zeros(NODES + 1) for _ in SIDES]
        self.pressed, self.presses, self.beyond = [0.0] * 4, [0.0] * 3, [0.0] * 3

    def centre(self, i: int) -> tuple[float, float]:
        """Return the centre of a tool, mm."""
        return ((-self.bead.half, -self.radii[0]), (0.0, self.radii[1] - self.height),
                (self.bead.half, -self.radii[2]))[i]

    def place(self, i: int, slope: float) -> tuple[float, float]:
        """Return the place of the middle of the sheet on a tool, mm."""
        (x, y), reach = self.centre(i), SIDES[i] * self.radii[i]
        return x + reach * math.sin(slope), y + reach * math.cos(slope)

    def curvature(self, i: int) -> float:
        """Return the curvature of the sheet at a tool, 1/mm."""
        return (1 + min(float(self.unknowns[i]), 0.0)) / self.radii[i]

    def bend(self, layers: int, steps: int) -> None:
        """Bend a section along the path: moments over the curvatures, tensions behind the tools."""
        bead = self.bead
        self.section = section = Section(self.material, bead.thickness, layers, self.direction)
        self.start, last = 2 * bead.friction * bead.clamping, 0.0
        if self.start:
            section.pull(self.start, PULLS)
        records: list[np.ndarray] = []
        self.tensions: list[float] = []
        for i, side in enumerate((*SIDES, 0)):
            record = [np.array([[last], [section.moment]])]
            if last:
                moments = section.bend(0.0, steps)
                record.append(np.array([last * (1 - parts(steps)), moments])[:, 1:])
            if side:
                last = side * self.curvature(i)
                moments = section.bend(last, steps, self.presses[i] / bead.thickness, self.beyond[i])
                record.append(np.array([last * parts(steps), moments])[:, 1:])
                self.rub(i)
                self.tensions.append(section.force - section.moment * last)
            records.append(np.hstack(record))
        self.rise = Branch.of(-records[0][0], -records[0][1], section.stiffness)
        self.branches = [Branch.of(side * curvatures, side * moments, section.stiffness)
                         for side, (curvatures, moments) in zip(SIDES, records[1:])]

    def rub(self, i: int) -> None:
        """Add the friction at a tool, which acts at its face, the force in the middle of the sheet."""
        if self.bead.friction and self.pressed[i]:
            arm = 1 - self.bead.thickness / 2 / self.radii[i]
            self.section.pull(self.section.force + self.bead.friction * self.pressed[i] * arm, PULLS)

    def entry(self, curvature: float) -> tuple[float, float, float, float]:
        """Return slope, radian, and moment, N, at the entry shoulder, the distance before it from which the sheet is
        lifted from the plate, mm, and the curvature near the shoulder: the moment rises in proportion to the
        distance."""
        moment = -self.rise.moment(-curvature)
        part = np.linspace(0.0, 1.0, NODES + 1)
        bent = np.interp(part * moment, -self.rise.moments[::-1], -self.rise.curvatures[::-1])
        turn, fall = (float((values[1:] + values[:-1]).sum()) / 2 * float(part[1]) for values in
                      (bent, bent * (1 - part)))
        length = math.sqrt(self.bead.gap / fall)
        for _ in range(PASSES):
            drop = self.radii[0] * (1 - math.cos(min(length * turn, math.pi / 2)))
            length = math.sqrt((self.bead.gap + drop) / fall)
        near = float(np.interp(1 - min(1.0, NEAR * self.bead.thickness / length), part, bent))
        return length * turn, moment, length, near

    def path(self, unknowns: np.ndarray) -> Path:
        """Return the path of unknowns."""
        self.unknowns = unknowns
        curvatures = [self.curvature(i) for i in range(3)]
        slope, moment, lifted, self.near = self.entry(curvatures[0])
        coming, leaving, spans, residual = [slope, *map(float, unknowns[3:5])], [], [], []
        for i, side in enumerate(SIDES):
            leaving.append(coming[i] + side * max(float(unknowns[i]), 0.0))
            last = i == len(SIDES) - 1
            end = (float(unknowns[5]), self.bead.gap) if last else self.place(i + 1, coming[i + 1])
            start = Start(self.place(i, leaving[i]), leaving[i], moment, curvatures[i], self.tensions[i], side)
            span = free_span(start, end, 0.0 if last else curvatures[i + 1], self.branches[i], self.offsets[i],
                             NEAR * self.bead.thickness)
            residual += [span.slopes[0] - leaving[i], span.slopes[1] - (0.0 if last else coming[i + 1])]
            spans.append(span)
            moment = -span.moment
        self.offsets = [span.offsets for span in spans]
        return Path(curvatures, coming, leaving, lifted, spans, np.array(residual))

    def solve(self) -> Path | None:
        """Return the path at the height reached, None if it is not found."""
        before, bead = (self.unknowns.copy(), [one.copy() for one in self.offsets]), self.bead
        low = [LOWEST, LOWEST, LOWEST, -math.pi / 2, -math.pi / 2, bead.half]
        high = [WIDEST / 2, WIDEST, WIDEST / 2, math.pi / 2, 0.0, bead.half + FARTHEST * bead.thickness]
        found = least_squares(lambda unknowns: self.path(unknowns).residual, np.clip(self.unknowns, low, high),
                              bounds=(low, high), x_scale=SCALES, max_nfev=EVALUATIONS, ftol=1e-14, xtol=1e-12,
                              gtol=1e-14)
        path = self.path(found.x)
        if float(np.abs(path.residual).max()) <= FOUND:
            return path
        self.unknowns, self.offsets = before
        return None

    def close(self) -> None:
        """Find a path at the height of the bead, from a low one on, with the moments of coarse passes."""
        step = self.bead.thickness
        while self.height < self.bead.height:
            self.bend(*COARSE)
            reached = self.height
            while True:
                self.height = min(self.bead.height, reached + step)
                if path := self.solve():
                    break
                step /= 2
                if step < SHORTEST * self.bead.thickness:
                    raise Problem(f"the path of the sheet is not found beyond a height of the bead of {reached:.3g} mm")
            self.forces(path)

    def flow(self) -> Result:
        """Make a pass: bend the section along the path, find the next path and the forces."""
        if not self.height:
            self.close()
        self.bend(self.layers, self.steps)
        path = self.solve()
        if path is None:
            raise Problem(f"the path of the sheet is not found at a height of the bead of {self.height:.3g} mm")
        return self.forces(path)

    def forces(self, path: Path) -> Result:
        """Return what the bead does on a path, and take the forces on the tools for the next pass."""
        bead, section, forces = self.bead, self.section, [span.force for span in path.spans]
        entry = -self.rise.moment(-path.curvatures[0]) / path.lifted
        last = abs(section.moment)
        # Behind the plate the sheet is elastic.
        behind = last / max(bead.thickness, math.sqrt(6 * bead.gap * section.stiffness / max(last, LEAST)))
        before = [np.array([self.start, entry]), *forces[:2]]
        on = [float(np.hypot(*(first - second))) for first, second in zip(before, forces)]
        self.press(path, on, entry)
        self.pressed = [force * around(abs(leave - come)) for force, leave, come in
                        zip(on, path.leaving, path.coming)] + [2 * behind - forces[2][1]]
        self.pressed[0] += entry
        first, second, third = path.curvatures
        return Result(section.force + bead.friction * self.pressed[3], forces[1][1] - forces[0][1], entry,
                      behind - forces[2][1], (first, second, third),
                      (math.degrees(path.spans[0].steepest), -math.degrees(path.spans[1].steepest)),
                      -math.log(section.stretch), section.plastic)

    def press(self, path: Path, on: list[float], entry: float) -> None:
        """Take the forces, N/mm, by which the tools press on the sheet where it comes to them, and the curvatures from
        which on they do: all of the force where the sheet does not follow the tool, the less of what acts where it
        leaves the tool the longer it does."""
        arriving = [entry, *(span.pressing for span in path.spans[:2])]
        near = [self.near, *(max(0.0, -span.near) for span in path.spans[:2])]
        for i in range(3):
            apart = max(float(self.unknowns[i]), 0.0) * self.radii[i] / self.bead.thickness
            force = arriving[i] + max(0.0, 1 - apart) * (on[i] - arriving[i])
            self.presses[i] += (force - self.presses[i]) * (HALF if self.presses[i] else 1.0)
            self.beyond[i] = near[i]


def around(angle: float) -> float:
    """Return the sum of the pressure of a tool over its resultant, x/sin x of an arc of 2 x."""
    half = angle / 2
    return half / math.sin(half) if half > 0 else 1.0


def flow(material: Material, bead: Bead, direction: float = 0.0, layers: int = LAYERS, steps: int = STEPS) -> Result:
    """Return what a bead does to a sheet that is drawn through it at an angle to the rolling direction, degrees."""
    strip, last = Strip(material, bead, direction, layers, steps), np.full(2, math.inf)
    for _ in range(PASSES):
        result = strip.flow()
        forces = np.array([result.restraint, result.uplift])
        if (np.abs(forces - last) <= SAME * np.abs(forces) + ZERO * result.uplift).all():
            return result
        last = forces
    raise Problem(f"the force of the bead does not settle in {PASSES} passes, {result.restraint:.4g} N/mm")
