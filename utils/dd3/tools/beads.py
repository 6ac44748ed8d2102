# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw-beads that are proposed on the binder of a part: along those parts of its rim where much is drawn in against the
rest, and which are straight. A corner restrains the sheet by the compression of its flange.

The draw-in is that of the estimate of the blank in one step, or of a finished run. The beads are round ones; restraint
and uplift are those of the path of the sheet through them (bead_path.py).
"""
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from dd3.bead_path import CLEARANCE, GAP, Bead, Result, flow
from dd3.laws import Material
from dd3.tools.set_blank import Blank, needed
from dd3.tools.set_material import STEEL, STEPS, STRAIN

# Radius and height of a bead, radius of the edges of its groove, distance of its middle from the rim of what is covered
# at the end of the draw, and margin of the blank beyond that rim, with which the sheet does not leave the bead, over
# the thickness.
RADIUS, SHOULDER, DISTANCE, MARGIN = 5.0, 3.0, 10.0, 15.0
# Part of the largest draw-in by which the least one is below it, from which on beads are proposed.
UNEVEN = 0.25
# Radius of a convex rim over its draw-in below which it is a corner: the flange, compressed by ln(1 + 1/3), restrains
# it as much as a bead.
CORNER = 3.0
# Least length of a bead over its distance from the rim; step along the rim, and largest distance of the points of a
# bead from its line, over the thickness; distance of points that are one.
SHORTEST, STEP, SIMPLE, SAME = 2.0, 1.0, 0.1, 1e-3
BLOCK = """*DRAWBEAD {name}
  points = {points}
  force = ${{bead}}
  rise = {rise:g}
  normal = -${{lift}}
  tool = holder
  from = draw

"""


@dataclass
class Line:
    """A line in plan (n, 2), mm, and the largest draw-in of the rim along it, mm."""

    points: np.ndarray
    draw_in: float

    @property
    def length(self) -> float:
        """Return the length, mm."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum())


@dataclass
class Beads:
    """Draw-beads of a set of tools: lines, restraint beside that by the uplift, uplift, N/mm, and restraint over the
    largest force of the sheet in plane strain; radius, mm; why there are none."""

    lines: list[Line] = field(default_factory=list)
    force: float = 0.0
    lift: float = 0.0
    part: float = 0.0
    radius: float = 0.0
    reason: str = ""

    def blocks(self, axes: Sequence[int] = ()) -> str:
        """Return the blocks of the input file; of those beads that come to the positive side of planes through 0 normal
        to axes."""
        return "".join(BLOCK.format(name=f"bead_{number}", rise=self.radius,
                                    points="  ".join(f"{x:.5g} {y:.5g}" for x, y in bead.points))
                       for number, bead in enumerate(self.lines, 1)
                       if (bead.points[:, list(axes)] > 0).all(axis=1).any())

    def said(self) -> list[tuple[str, str]]:
        """Return the lines of the report."""
        if not self.lines:
            return [("beads", f"none, as {self.reason}; without --beads the blank has a smaller margin")]
        length = sum(bead.length for bead in self.lines)
        return [("beads", f"restraint {self.force:.3g} N/mm, {100 * self.part:.2g} % of the largest force of the sheet "
                 f"in plane strain, {self.force * length:.3g} N in all: round beads of {self.radius:g} mm radius and "
                 "height"),
                ("", f"they lift the holder by {self.lift:.3g} N/mm, {self.lift * length:.3g} N in all, which the "
                 "press gives beside its force"),
                ("", "they may tear a part that does without: compare with --set bead=0 --set lift=0"),
                *((f"bead_{number}", f"{bead.length:.3g} mm, from x y {pair(bead.points[0])} to "
                   f"{pair(bead.points[-1])}, draw-in up to {bead.draw_in:.3g} mm")
                  for number, bead in enumerate(self.lines, 1))]


def pair(point: np.ndarray) -> str:
    """Return a point in plan in words."""
    return f"{point[0]:.4g} {point[1]:.4g}"


def proposed(blank: Blank, thickness: float, drawn: tuple[np.ndarray, np.ndarray] | None = None) -> Beads:
    """Return beads without their restraint for a sheet of a thickness, mm; `drawn`: points (n, 2) of the rim of a drawn
    sheet and their draw-in, in place of that of the estimate."""
    if not len(blank.rim):
        return Beads(reason="the blank is not estimated")
    apart = np.linalg.norm(blank.rim - np.roll(blank.rim, 1, axis=0), axis=1) > SAME * thickness
    rim, flat = blank.rim[apart], blank.flat[apart]  # points of a vertical edge are one in plan
    out, curvature = shape_of(rim)
    draw_in = ((flat - rim) * out).sum(axis=1)
    rim, out, curvature, draw_in = along(rim, STEP * thickness, out, curvature, draw_in)
    out /= np.linalg.norm(out, axis=1)[:, None]
    if drawn:
        draw_in = drawn[1][cKDTree(drawn[0]).query(rim)[1]]
    least, most = float(draw_in.min()), float(draw_in.max())
    if most - least < UNEVEN * most:
        return Beads(reason=f"the draw-in is even, {least:.3g} to {most:.3g} mm")
    chosen = (draw_in > (least + most) / 2) & (curvature * draw_in < 1 / CORNER)
    away = DISTANCE * thickness
    found = [Line(needed(rim[part] + away * out[part], SIMPLE * thickness), float(draw_in[part].max()))
             for part in stretches(chosen)]
    found = [bead for bead in found if bead.length >= SHORTEST * away]
    middle = (least + most) / 2
    return Beads(found, radius=RADIUS * thickness,
                 reason=f"no part of the rim whose draw-in is above {middle:.3g} mm is straight and long")


def shape_of(rim: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the unit vectors outwards and the curvatures, positive where it is convex, 1/mm, at the points of a closed
    line (n, 2) that runs anticlockwise."""
    side = np.roll(rim, -1, axis=0) - rim
    length = np.linalg.norm(side, axis=1)
    after = side / length[:, None]
    before = np.roll(after, 1, axis=0)
    turn = np.arctan2(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0], (before * after).sum(axis=1))
    tangent = before + after
    tangent /= np.linalg.norm(tangent, axis=1)[:, None]
    return np.stack([tangent[:, 1], -tangent[:, 0]], axis=1), 2 * turn / (length + np.roll(length, 1))


def along(line: np.ndarray, step: float, *values: np.ndarray) -> list[np.ndarray]:
    """Return points of a closed line (n, 2) at a step, mm, about, and values of its points there."""
    ring = np.append(np.arange(len(line)), 0)
    place = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line[ring], axis=0), axis=1))])
    fine = np.linspace(0.0, place[-1], int(place[-1] / step) + 1)[:-1]
    return [np.stack([np.interp(fine, place, column[ring]) for column in np.atleast_2d(value.T)], axis=-1).squeeze()
            for value in (line, *values)]


def stretches(chosen: np.ndarray) -> list[np.ndarray]:
    """Return the numbers of the points of a closed line in each of its connected parts that are chosen; not all are."""
    start = int(np.flatnonzero(~chosen)[0])
    order = (start + np.arange(len(chosen))) % len(chosen)
    ends = np.flatnonzero(np.diff(chosen[order].astype(int))) + 1
    return [part for part in np.split(order, ends) if chosen[part[0]]]


def through(path: Path | None, thickness: float, friction: float) -> Result:
    """Return what the beads do to a sheet, mm, of the material of a file, or the one that is assumed."""
    material, radius = Material(file=path) if path else Material(STEEL), RADIUS * thickness
    return flow(material, Bead(thickness, radius, SHOULDER * thickness, CLEARANCE * thickness, radius, GAP * thickness,
                               friction))


def largest(stress: Callable[[float], float], thickness: float) -> float:
    """Return the largest force of a sheet in plane strain, N/mm, at which it necks; `stress` by the strain in plane
    strain, MPa."""
    return max(stress(strain) * np.exp(-strain) for strain in np.linspace(0.0, STRAIN, STEPS + 1)) * thickness
