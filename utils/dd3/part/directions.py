# SPDX-License-Identifier: GPL-3.0-or-later
"""Press directions of a part: draft angles, undercuts, and the direction that is proposed.

A sheet can be drawn in one stroke from a direction if each line along it meets the upper side once: no normal of that
side looks away, and nothing is above it.
"""
from dataclasses import dataclass, field

import numpy as np

from dd3.part.loops import find_loops
from dd3.part.rays import Rays
from dd3.part.shape import Shape, angle_between, unit
from dd3.part.sheet import Sheet, mostly, samples

# Draft below which a face is undercut, degrees.
UNDERCUT = -0.2
# Rays upwards from a side; part of the thickness, or of the diagonal, from the side at which they begin.
RAYS, START, START_SIZE = 1500, 0.4, 2e-3
# Angle up to which a ray that meets a face along it is not blocked, degrees: the triangles of a wall are chords.
GRAZING = 15.0
# Fraction of a face that is undercut before the face counts, and of both sides before a direction is none.
OF_FACE, OF_SIDES = 0.02, 1e-3
# Least projected area over that of the sides.
LEAST_AREA = 0.03
# Least gain in draft, degrees, for which a direction is preferred to an axis of the file.
GAIN = 5.0
# Fraction of the largest projected area that an axis of the file needs to be preferred.
OF_AREA = 0.97
# Draft beyond which more is no advantage, degrees.
ENOUGH = 10.0
# Draft of a face of a block up to which it is a wall, degrees.
BLOCK_WALL = 2.0
# Height of the rim over the size of the part up to which a part is open to no side.
LEVEL = 1e-3


@dataclass
class Direction:
    """A press direction, from the part to the punch: unit vector and name; draft angles of the triangles, degrees: 90
    where the side is level, 0 at a wall along the direction, negative where it is undercut, NaN on rims; the sign of
    the upper side's normals, -1 for a surface that looks down; faces that are undercut with their least draft, degrees,
    or 0 where something is above them; the fraction of the sides that is undercut; the projected area over that of the
    sides; least draft, of 99.5 % of the area; extent of the part along the direction, mm; the faces of the upper
    side."""

    name: str
    vector: np.ndarray
    draft: np.ndarray
    facing: float = 1.0
    undercut: dict[int, float] = field(default_factory=dict)
    fraction: float = 0.0
    projected: float = 0.0
    least: float = 0.0
    depth: float = 0.0
    upper: list[int] = field(default_factory=list)

    @property
    def free(self) -> bool:
        """Tell whether the part has no undercut from here, and is not seen along its faces."""
        return self.fraction <= OF_SIDES and self.projected >= LEAST_AREA

    @property
    def words(self) -> str:
        """Return the direction in words: `+z`, or its components."""
        for name, axis in zip("xyz", np.eye(3)):
            for sign, value in (("+", 1.0), ("-", -1.0)):
                if angle_between(self.vector, value * axis) < 0.05:
                    return sign + name
        return self.components

    @property
    def components(self) -> str:
        """Return the components of the direction, as an option takes them."""
        return " ".join(f"{value:.4g}" for value in np.round(self.vector, 4) + 0.0)


def judged(shape: Shape, rays: Rays, sheet: Sheet, name: str, vector: np.ndarray, rim: np.ndarray | None) -> Direction:
    """Return what is to be said of a direction; with a rim, nodes, it is reversed where the part is open to the other
    side, and where it is open to none and looks down."""
    vector = unit(np.asarray(vector, float))
    first, second = sheet.sides
    if rim is not None and sheet.kind != "block":
        up = opening(shape, vector, first, rim)
        if up < -LEVEL * shape.size or (abs(up) <= LEVEL * shape.size and vector[np.abs(vector).argmax()] < 0):
            vector = -vector
    if sheet.kind != "block" and (shape.area @ (shape.normal @ vector * np.isin(shape.face, first))) < 0 and second:
        first, second = second, first
    upper = shape.of(first)
    lower = shape.of(second)
    draft = np.full(len(shape.face), np.nan)
    draft[upper] = np.degrees(np.arcsin(np.clip(shape.normal[upper] @ vector, -1, 1)))
    draft[lower] = np.degrees(np.arcsin(np.clip(-shape.normal[lower] @ vector, -1, 1)))
    facing = -1.0 if sheet.kind == "surface" and np.nansum(shape.area * np.sin(np.radians(draft))) < 0 else 1.0
    along = shape.nodes[shape.triangles[upper]] @ vector
    found = Direction(name, vector, facing * draft, facing, depth=float(np.ptp(along)), upper=sorted(first))
    if sheet.kind == "block":
        found.upper = visible(shape, rays, vector)
    else:
        find_undercut(shape, rays, sheet, found)
    return found


def find_undercut(shape: Shape, rays: Rays, sheet: Sheet, found: Direction) -> None:
    """Find the undercut faces of a direction."""
    sides = np.flatnonzero(~np.isnan(found.draft))
    away = np.zeros(len(shape.face), bool)
    away[sides] = found.draft[sides] < UNDERCUT
    weight = shape.area.copy()
    if weight[away].sum() <= OF_SIDES * weight[sides].sum():
        chosen, stands_for = samples(shape, [tag for tag in shape.tags if tag in sheet.sides[0] + sheet.sides[1]], RAYS)
        towards = np.where(np.isin(shape.face[chosen], found.upper), 1.0, -1.0)[:, None]
        start = START * sheet.thickness if sheet.thickness else START_SIZE * shape.size
        hits = rays.hits(chosen, towards * found.vector, start * found.facing * shape.normal[chosen])
        blocked = np.abs(hits.normal @ found.vector) > np.sin(np.radians(GRAZING))
        weight[sides] = 0.0
        weight[chosen] = stands_for
        away[chosen] |= blocked
    for tag in np.unique(shape.face[away]).tolist():
        own = shape.face == tag
        if weight[own & away].sum() > OF_FACE * weight[own].sum():
            found.undercut[tag] = min(0.0, float(np.nanmin(found.draft[own])))
    found.fraction = float(weight[away & np.isin(shape.face, list(found.undercut))].sum() / weight[sides].sum())
    level = np.maximum(np.sin(np.radians(found.draft[sides])), 0.0)
    found.projected = float(shape.area[sides] @ level / shape.area[sides].sum())
    order = sides[np.argsort(found.draft[sides])]
    total = np.cumsum(shape.area[order])
    found.least = float(found.draft[order[np.searchsorted(total, 0.005 * total[-1])]])


def visible(shape: Shape, rays: Rays, vector: np.ndarray) -> list[int]:
    """Return the faces of a block that are seen from a direction."""
    chosen, weight = samples(shape, shape.tags, RAYS)
    looks = shape.normal[chosen] @ vector > -np.sin(np.radians(-UNDERCUT))
    hits = rays.hits(chosen, np.tile(vector, (len(chosen), 1)), START_SIZE * shape.size * shape.normal[chosen])
    seen = looks & (np.abs(hits.normal @ vector) <= np.sin(np.radians(GRAZING)))
    return mostly(shape, chosen, weight, seen)


def best(shape: Shape, found: list[Direction], sheet: Sheet) -> Direction:
    """Return the direction that is proposed: without undercut, of enough draft, with the largest projected area, an
    axis of the file unless another one gains draft; without any such one that of the least undercut. Of a block it is
    that from which the face is least flat."""
    if sheet.kind == "block":
        return as_tool(shape, max(found, key=lambda one: relief(shape, one)))
    free = [one for one in found if one.free]
    if not free:
        seen = [one for one in found if one.projected >= LEAST_AREA]
        return min(seen or found, key=lambda one: one.fraction)
    first = max(free, key=lambda one: (min(one.least, ENOUGH), one.projected))
    axes = [one for one in free if one.name.startswith("axis")]
    axis = max(axes, key=lambda one: (min(one.least, ENOUGH), one.projected), default=first)
    lost = min(first.least, ENOUGH) - min(axis.least, ENOUGH)
    return axis if lost < GAIN and axis.projected > OF_AREA * first.projected else first


def relief(shape: Shape, one: Direction) -> float:
    """Return the projected area that is seen of a block, without the largest plane, mm2."""
    level = {tag: float(shape.area[own] @ np.maximum(shape.normal[own] @ one.vector, 0.0))
             for tag in one.upper for own in [shape.cells[tag]]}
    flat = [area for tag, area in level.items() if shape.kinds[tag] == "Plane"]
    return sum(level.values()) - max(flat, default=0.0)


def as_tool(shape: Shape, one: Direction) -> Direction:
    """Return the direction of a block towards the punch: the block is the punch if the rim of what is seen of it, walls
    left out, is behind the rest, else the die."""
    seen = [tag for tag in one.upper if np.median(one.draft[shape.cells[tag]]) > BLOCK_WALL]
    loops = find_loops(shape, seen)
    if loops and opening(shape, one.vector, seen, loops[0].nodes) < 0:
        one.name, one.vector = f"{one.name}, the block is the punch", -one.vector
    else:
        one.name += ", the block is the die"
    return one


def opening(shape: Shape, vector: np.ndarray, faces: list[int], rim: np.ndarray) -> float:
    """Return the height of a rim, nodes (n,) in order, above the middle of faces along a vector, mm: positive for a
    part that is open towards the punch."""
    own = shape.of(faces)
    if not len(rim):
        return 0.0
    start, end = shape.nodes[rim], shape.nodes[np.roll(rim, -1)]
    length = np.linalg.norm(end - start, axis=1)
    height = np.average((start + end) / 2 @ vector, weights=length)
    return float(height - np.average(shape.place[own] @ vector, weights=shape.area[own]))
