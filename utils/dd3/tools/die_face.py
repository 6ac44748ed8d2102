# SPDX-License-Identifier: GPL-3.0-or-later
"""Die face: what goes on from the faces of a part to the border of the die. The part's own flange lies on the binder;
where the part ends on a wall, the wall goes on to a shoulder that ends on the binder."""
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from dd3.errors import Problem
from dd3.progress import doing
from dd3.tools import report
from dd3.tools.binder import Binder, NoBinder, kinds, of_points, patches_on
from dd3.tools.joints import find_joints, kinks, orient, turn
from dd3.tools.own_flange import Trimmed
from dd3.tools.plane import Side, box, straight
from dd3.tools.rims import Rim, border_rims, find_rims, lengths, missing_height, patches, refuse_level, shoulder, wall
from dd3.tools.set_blank import Blank, blank_of
from dd3.tools.settings import ToolSettings
from dd3.tools.surface import Surface, from_nodes, grid, points_at

# Height over the thickness that the shortest ruled wall has, where one is needed.
SHORTEST = 0.5
# Part of the depth of the draw by which the longest wall may go on to a simpler binder.
OF_DEPTH = 0.25
# Width of the die beside the part's own flange, over the thickness, at least.
BESIDE = 4.0
# Width of the blank beyond the shoulder that is not estimated, and distance of the blank from the border of the die,
# over the thickness.
WIDE = 40.0
INSET = 2.0
# Kink at joints of the die face above which the rims are divided further, degrees; least part of the length at once,
# and a margin of it.
KINK, FEWER, SAFE = 0.5, 0.2, 0.9
# Cosine between the directions at the ends of an open rim below which it goes around the part.
AROUND = 0.3
# Points of a quadratic piece from which its length is taken.
FINE = 33
# Rounds in which the height of a binder settles.
SETTLE = 4


class TooLong(Exception):
    """The patches along the rim of the part are too long for the die face; the length that is needed, mm."""

    def __init__(self, length: float) -> None:
        super().__init__()
        self.length = length


@dataclass
class Reach:
    """A rim, the binder that it leads to, the curve where it meets this, how wide the binder is from there on, and
    whether the part's own flange lies there."""

    rim: Rim
    binder: Binder
    curve: np.ndarray
    width: float
    own: bool = False


@dataclass
class Face:
    """The die with its face: surface; rims with their binders; the blank; the box of the die around closed rims (2, 2),
    None where their width tells it; lines of the report."""

    surface: Surface
    reaches: list[Reach]
    binders: list[Binder]
    blank: Blank | None = None
    outline: np.ndarray | None = None
    lines: list[tuple[str, str]] = field(default_factory=list)


def with_face(gmsh: Any, die: Trimmed, options: ToolSettings) -> Face:
    """Return the die of a part's faces, whose normals point upwards, with shoulders and binder."""
    surface, joints = die.surface, find_joints(die.surface.net)
    walls, others = find_rims(surface, joints, die.border)
    refuse_level(walls)
    found = Face(surface, [], [])
    if others:
        found.lines.append(("edges", f"{others} free edges of patches stay open, as the part does not climb there"))
    borders = border_rims(surface, joints, die.border, across=True)
    if not walls and not borders:
        raise NoBinder("no free edge of the part climbs by more than 10 degrees, as the punch moves along -z into it",
                       options.advice)
    refuse_mixed(walls, borders)
    nets = [surface.net]
    if borders:
        at_borders(found, die, borders, options)
    if walls:
        nets += at_walls(found, walls, options)
    set_blank(found, np.concatenate([*nets, *(part.net for part in die.flanges)]), options)
    face = from_nodes(flange(gmsh, found, [reach.curve for reach in found.reaches], options.tolerance / 2))
    shoulders = sum(map(len, nets[1:]))
    count = len(surface.names)
    label = np.concatenate([surface.face, np.repeat([count, count + 1], [shoulders, len(face)])])
    found.surface = consistent(Surface(np.concatenate([*nets, face]), label, [*surface.names, "shoulder", "flange"]))
    if walls:
        check_kinks(found.surface, count)
    return found


def estimated(covered: np.ndarray, curves: list[np.ndarray], lines: list[tuple[str, str]], options: ToolSettings
              ) -> Blank:
    """Return the blank that covers patches; where it is not estimated a box around curves. Enter what is to be said."""
    try:
        return blank_of(options.source, Surface(covered, np.zeros(len(covered), int), [""]), options.thickness,
                        options.margin)
    except Problem as problem:
        lines.append(("blank", f"not estimated, as {problem.args[0].split(': ', 1)[-1]}: {WIDE:g} thicknesses wide"))
    around = np.concatenate(curves)[:, :2]
    low, high = around.min(axis=0) - WIDE * options.thickness, around.max(axis=0) + WIDE * options.thickness
    return Blank(np.array([low, [high[0], low[1]], high, [low[0], high[1]]]), False)


def set_blank(found: Face, covered: np.ndarray, options: ToolSettings) -> None:
    """Set the blank that covers patches, and how far the die reaches, where `--flange` does not tell."""
    found.blank = estimated(covered, [reach.curve for reach in found.reaches], found.lines, options)
    if options.flange is None:
        inset = INSET * options.thickness
        found.outline = found.blank.box + np.array([[-inset], [inset]])
        for reach in found.reaches:
            if not reach.rim.closed:
                reach.width = width_of(reach, found.blank.border, inset)


def refuse_mixed(walls: list[Rim], borders: list[Rim]) -> None:
    """Refuse walls that end where the part's own flange begins."""
    ends = [end for rim in borders if not rim.closed for end in (rim.points[0], rim.points[-1])]
    for rim in walls:
        for end in (rim.points[0], rim.points[-1]):
            if not rim.closed and ends and np.linalg.norm(np.array(ends) - end, axis=1).min() < 1e-6 * np.ptp(
                    rim.points, axis=0).max():
                raise NoBinder("the part has a flange along a part of its rim only, up to near x y z = "
                               + report.where(end), ": leave it out by --faces, or continue it in the CAD program")


def at_borders(found: Face, die: Trimmed, rims: list[Rim], options: ToolSettings) -> None:
    """Enter the rims at which the part's own flange begins, with the binder on which it lies."""
    points = [points_at(part.net, *grid(5)).reshape(-1, 3) for part in die.flanges]
    whole, off = of_points(np.concatenate(points), options.tolerance)
    one = whole if off <= options.tolerance else None
    for part, own in zip(die.flanges, points):
        binder, off = (whole, off) if one or len(points) == 1 else of_points(own, options.tolerance)
        if off > options.tolerance:
            raise NoBinder(f"the part's own flange, {report.named(part, np.unique(part.face))}, is up to "
                           f"{off:.3g} mm off a developable surface, which a binder has to be",
                           ": leave it out by --faces")
        if binder not in found.binders:
            found.binders.append(binder)
    for rim in rims:
        near = min(range(len(points)), key=lambda k: cKDTree(points[k]).query(rim.points)[0].max())
        binder = one or found.binders[near]
        away = cKDTree(rim.points).query(points[near])[0].max()
        width = max(options.flange or 0.0, float(away) + BESIDE * options.thickness)
        found.reaches.append(Reach(rim, binder, rim.points, width, own=True))
    for binder in found.binders:
        off = max(binder.distance(own) for own in points) if one else 0.0
        found.lines.append(("binder", f"{binder.kind}, on which the part's own flange lies"
                            + (f" within {1e3 * off:.2g} µm" if off > 0 else "")))


@doing("making walls, shoulders and binder")
def at_walls(found: Face, rims: list[Rim], options: ToolSettings) -> list[np.ndarray]:
    """Enter the rims at which the part ends on walls; return the patches of walls and shoulders up to their binder."""
    radius = options.shoulder
    binder = found.binders[0] if found.binders else None
    if binder is None or max(missing_height(rim, binder, radius) for rim in rims) > 0.0:
        binder = chosen(rims, float(found.surface.net[..., 2].min()), options)
        found.binders.append(binder)
        found.lines.append(("binder", f"{binder.kind}, near to the rims of the part"))
    walls = [lengths(rim, binder, radius) for rim in rims]
    longest = max(float(length.max()) for length in walls)
    level = longest <= options.tolerance
    if not level:
        found.lines.append(("walls", f"continued up to {longest:.3g} mm to the shoulder"))
    nets = []
    for rim, length in zip(rims, walls):
        rows = [] if level else wall(rim, length)
        rows += shoulder(rim, rows[-1] if rows else rim.points, radius, binder, options.tolerance / 2)
        check_pieces(rim.points, rows[-1], binder, options.tolerance / 2)
        nets.append(patches([rim.points, *rows]))
        found.reaches.append(Reach(rim, binder, rows[-1], options.flange or 0.0))
    return nets


def check_pieces(rim: np.ndarray, curve: np.ndarray, binder: Binder, tolerance: float) -> None:
    """Refuse quadratic pieces of a curve from a rim that leave a binder by more than the tolerance."""
    start, middle, end = (curve[k:len(curve) - 2 + k:2] for k in range(3))
    off = np.zeros(len(start))
    for t in (0.25, 0.75):
        point = (1 - t) * (1 - 2 * t) * start + 4 * t * (1 - t) * middle + t * (2 * t - 1) * end
        off = np.maximum(off, np.abs(point[:, 2] - binder.z(point[:, :2])))
    if off.max() > tolerance:
        length = np.linalg.norm(rim[2::2] - rim[:-2:2], axis=1)[off > tolerance]
        part = SAFE * (tolerance / off[off > tolerance])**(1 / 3)
        raise TooLong(float((length * np.maximum(part, FEWER)).min()))


def check_kinks(surface: Surface, added: int) -> None:
    """Refuse kinks where faces that were added to those of a part, from the number `added` on, join others."""
    joints = find_joints(surface.net)
    first, second = surface.face[np.stack([joints.first, joints.second]) // 4]
    new = (np.maximum(first, second) >= added) & (first != second)
    angle = np.where(new, kinks(surface.net, joints), 0.0)
    worst = int(angle.argmax())
    if KINK < angle[worst] < report.SHARP:
        edges = joints.first[new & (angle > KINK)]
        longest = float(np.linalg.norm(joints.points[edges, 4] - joints.points[edges, 0], axis=1).max())
        raise TooLong(longest * max(FEWER, SAFE * float(np.sqrt(KINK / angle[worst]))))


def chosen(rims: list[Rim], lowest: float, options: ToolSettings) -> Binder:
    """Return the binder for rims: the simplest one to which no wall goes on by more than a part of the depth, else that
    to which it is the shortest; as low as the walls allow."""
    points = np.concatenate([rim.points for rim in rims])
    tried: list[tuple[float, int, Binder]] = []
    for binder in kinds(points):
        try:
            binder = settled(rims, binder, options)
            longest = max(float((lengths(rim, binder, options.shoulder) * rim.climb[:, 2]).max()) for rim in rims)
        except Problem:
            continue
        tried.append((longest, len(tried), binder))
        if longest <= OF_DEPTH * (points[:, 2].max() - lowest):
            return binder
    if not tried:
        raise NoBinder("no binder is reached by the walls at the rim of the part", "")
    return min(tried)[2]


def settled(rims: list[Rim], binder: Binder, options: ToolSettings) -> Binder:
    """Return a binder at the least height to which all walls go on; a little more if these are needed."""
    for _ in range(SETTLE):
        binder = binder.raised(max(missing_height(rim, binder, options.shoulder) for rim in rims))
    if max(float(lengths(rim, binder, options.shoulder).max()) for rim in rims) > options.tolerance:
        binder = binder.raised(SHORTEST * options.thickness)
    return binder


def consistent(surface: Surface) -> Surface:
    """Return the surface with all patches turned as the first one."""
    sign, _, _ = orient(surface.net, find_joints(surface.net))
    surface.net = turn(surface.net, sign)
    return surface


def width_of(reach: Reach, border: np.ndarray, inset: float) -> float:
    """Return the width beside an open rim that reaches beyond the border of the blank (n, 2) by some length, mm."""
    curve, ends = reach.curve[:, :2], reach.rim.out[[0, -1], :2]
    if goes_around(reach):
        along, across = axes_of(curve)
        beside = [(border @ axis).max() - (curve @ axis).max() for axis in (along, -along, across)]
        return float(max(beside)) + inset
    start, end = curve[0], curve[-1]
    across = np.array([end[1] - start[1], start[0] - end[0]])
    across *= np.sign(across @ ends.sum(axis=0)) / np.linalg.norm(across)
    away = max(float(((border - start) @ across).max()), float(((curve - start) @ across).max()))
    return (away + inset) / max(float((ends @ across).min()), 0.5)


def goes_around(reach: Reach) -> bool:
    """Tell whether a rim turns around the part: its ends lead in different directions."""
    return not reach.rim.closed and float(reach.rim.out[0, :2] @ reach.rim.out[-1, :2]) < AROUND


def axes_of(curve: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the direction from the start to the end of a curve in plan (n, 2), and the one across it to the side on
    which the curve is."""
    along = (curve[-1] - curve[0]) / np.linalg.norm(curve[-1] - curve[0])
    across = np.array([-along[1], along[0]])
    return along, across * np.sign(float(((curve - curve[0]) @ across).sum()) or 1.0)


def flange(gmsh: Any, face: Face, curves: list[np.ndarray], tolerance: float) -> np.ndarray:
    """Return the nodes (patch, 3, 3, 3) on the binders around closed curves and beside open ones, one of each rim, up
    to where the die ends; normals upwards."""
    reaches = face.reaches
    for curve in curves:
        if len(curve) % 4 != 1:  # an odd number of patches, beside which the mesh of the flange cannot be
            raise NoBinder("an edge climbs by more than 10 degrees along a part of it only, up to near x y z = "
                           + report.where(curve[-1]), ": divide it there in the CAD program")
    nodes = []
    closed = [k for k, reach in enumerate(reaches) if reach.rim.closed]
    if closed:
        binder = reaches[closed[0]].binder
        if any(reaches[k].binder is not binder for k in closed):
            raise Problem("the rims of the part are on different binders: choose the faces of one by --faces")
        outline = box(face.outline, 0.0) if face.outline is not None else box(
            np.concatenate([reaches[k].curve for k in closed])[:, :2], max(reaches[k].width for k in closed))
        loops = [outline, *([Side(curves[k][:, :2], True)] for k in closed)]
        nodes.append(patches_on(gmsh, binder, loops, [curves[k] for k in closed], tolerance))
    for reach, curve in zip(reaches, curves):
        if not reach.rim.closed:
            nodes.append(patches_on(gmsh, reach.binder, [strip(reach, curve)], [curve], tolerance))
    return np.concatenate(nodes)


def even(curve: np.ndarray) -> np.ndarray:
    """Return a curve of quadratic pieces (2 n + 1, 3), n even, with each pair of them divided into equal lengths."""
    start, middle, end = (curve[k:len(curve) - 2 + k:2, None] for k in range(3))
    t = np.linspace(0.0, 1.0, FINE)[:-1, None]
    dense = (1 - t) * (1 - 2 * t) * start + 4 * t * (1 - t) * middle + t * (2 * t - 1) * end
    result = curve.copy()
    for k in range(len(dense) // 2):
        line = np.concatenate([dense[2 * k], dense[2 * k + 1], curve[None, 4 * k + 4]])
        length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
        for i in (1, 2, 3):
            result[4 * k + i] = [np.interp(i / 4 * length[-1], length, line[:, axis]) for axis in range(3)]
    return result


def strip(reach: Reach, curve: np.ndarray) -> list[Side]:
    """Return the strip in plan from a curve to the border of the die beside an open rim: a straight line, or where the
    rim goes around the part three sides of a rectangle."""
    start, end = curve[0, :2], curve[-1, :2]
    far_start, far_end = (own + ((place + reach.width * out - own) @ out) * out for own, place, out in (
        (start, reach.curve[0, :2], reach.rim.out[0, :2]), (end, reach.curve[-1, :2], reach.rim.out[-1, :2])))
    corners = [far_end, far_start]
    if goes_around(reach):
        along, across = axes_of(reach.curve[:, :2])
        places = [reach.curve[:, :2] @ axis for axis in (along, across)]
        far = places[1].max() + reach.width
        corners[1:1] = [max(far_end @ along, places[0].max() + reach.width) * along + far * across,
                        min(far_start @ along, places[0].min() - reach.width) * along + far * across]
    sides = [straight(a, b) for a, b in zip([end, *corners], [*corners, start])]
    return [Side(curve[:, :2], True), *sides]
