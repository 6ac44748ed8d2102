# SPDX-License-Identifier: GPL-3.0-or-later
"""Punch, die and holder of a part, and an input file that draws it.

The part is the surface of the drawn sheet that the punch touches, or the die. The punch comes from above. The other
tool is at the distance of the thickness and the clearance. The part's own flange lies on the binder, which is on the
die and under the holder; where the part ends on a wall, the wall of the die goes on to a shoulder and the binder. The
highest point of the binder is at z = 0.
"""
from copy import copy
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from dd3.errors import Problem
from dd3.progress import doing
from dd3.tools import cad, cad_mesh, drawability, no_holder, own_flange, report, sides, trim_deck
from dd3.tools.binder import NoBinder
from dd3.tools.die_face import INSET, Face, Reach, TooLong, consistent, estimated, even, flange, goes_around, with_face
from dd3.tools.faces import spans
from dd3.tools.joints import box_of, find_joints
from dd3.tools.limits import started
from dd3.tools.moved import placed, rotation
from dd3.tools.nagata import groups
from dd3.tools.offset import at_distance
from dd3.tools.pad_force import Pin, Pull, pins
from dd3.tools.rims import Rim, border_rims, find_rims, lengths, patches, wall
from dd3.tools.set_blank import Blank
from dd3.tools.settings import ToolSettings
from dd3.tools.surface import Surface, from_nodes, turned

# Defaults over the thickness: clearance, radius of the shoulder, margin of the blank; smaller ones for a drawing ratio
# that is too large with these.
SIZES = {"clearance": 0.1, "shoulder": 6.0, "margin": 5.0}
SMALLER = {"shoulder": 4.0, "margin": 2.0}
# Part of the projected area that is seen from the punch which may be left out.
LEFT_OUT = 0.05
# Part of it below which a face is a wall, which is seen along itself.
WALL = 1e-3
# Part of the length of the rims by which their directions outwards do not cancel, above which there is a pad.
ONE_SIDED = 0.3
# Times a part is meshed at most.
MESHED = 4
# Least slope, sine, at which a wall of the punch that ends at a flange goes on upwards.
STEEP = 0.5
# Part of the least radius below which a radius is smaller: fillets of just that radius are not.
JUST = 0.999
# Distance of offsets over the tolerance up to which the patches are made smaller, and the part of it they are made for.
NEARLY, FINER = 1.5, 0.9
DOWN = np.array([0.0, 0.0, -1.0])


@dataclass
class ToolSet:
    """Surfaces by the names of the tools, with the highest point of the binder at z = 0, punch and holder at the start
    of their travels; these travels, the height by which the part was moved into the die, the least radius of the die's
    shoulder, that of all faces of punch and die and that of the punch, mm; force of the pad, N, 0 if it is not
    estimated, and whether the pins need so much; what pulls at a floor, and the holes in which pins locate it; the
    blank, and the areas in plan of the tools over it, mm2; the drawing ratio, the root of the area of the blank over
    that of the punch in plan, 0 with open ends or no holder; what is below a step of the punch; how much of the blank
    the border of the die cuts off, 0 but for a flange that the user has set, and the flange that leaves it whole, mm;
    the largest distances of the faces of punch and die from the CAD, mm; the curves along which the part is cut; lines
    of the report."""

    surfaces: dict[str, Surface] = field(default_factory=dict)
    travel: float = 0.0
    closing: float = 0.0
    height: float = 0.0
    shoulder: float = 0.0
    radius: float = 0.0
    bend: float = 0.0
    pad_force: float = 0.0
    pad_for_pins: bool = False
    pulls: list[Pull] = field(default_factory=list)
    pins: list[Pin] = field(default_factory=list)
    blank: Blank = field(default_factory=lambda: Blank(np.zeros((0, 2)), False))
    area: dict[str, float] = field(default_factory=dict)
    ratio: float = 0.0
    inner_pan: drawability.InnerPan | None = None
    lost: float = 0.0
    flange: float = 0.0
    distance: dict[str, np.ndarray] = field(default_factory=dict)
    curves: trim_deck.Curves = field(default_factory=trim_deck.Curves)
    lines: list[tuple[str, str]] = field(default_factory=list)


def both_sides(gmsh: Any, options: ToolSettings, progress: Any, finer: float = 1.0
              ) -> tuple[Surface, Surface, dict[str, np.ndarray], list[str]]:
    """Return the surfaces of the punch and the die in the closed press, both with normals upwards, into the cavity, the
    largest distances of their faces from the CAD by the names of the tools, mm, and the roles of the faces. An offset
    enlarges the distance: where it is a little beyond the tolerance both are made again of patches within a part of it,
    `finer`."""
    gap = options.thickness + options.clearance
    fine, least = copy(options), options.radius
    fine.tolerance *= finer
    if options.sharp:  # an offset enlarges what the patches of the fillets are off the CAD
        fine.tolerance *= options.radius / (options.radius + gap)
        least *= JUST
    model = cad.read_cad(gmsh, options.source, fine, progress)
    refuse_left_out(model, options)
    if upon := cad_mesh.overlapping(gmsh, model):
        raise Problem(f"{options.source}: Gmsh makes no mesh of {report.named(model, np.array(sorted(upon)))} whose "
                      "patches do not lie upon each other: divide or mend them in the CAD program, or choose faces by "
                      "--faces")
    surface = cad.surface_of(model)
    refuse_apart(surface, options)
    matrix = rotation(options.rotate)
    up = matrix.T @ -DOWN
    sign, kept, _, notes, _, twisted = sides.faced(surface, find_joints(surface.net), up, cad.outward(gmsh, model))
    if len(twisted) or not kept.any():
        raise Problem(f"{options.source}: the faces have no common upper side; choose them by --faces")
    notes = model.notes + notes
    if not kept.all():
        notes.append("left out: faces that look downwards: " + report.named(surface, np.unique(model.face[~kept])))
    def moved(name: str, ahead: int) -> tuple[Surface, np.ndarray]:
        shift = 0.0 if options.side == name else ahead * gap
        return at_distance(gmsh, model, sign, kept, shift, least, ahead, options.tolerance)

    found, distance = [], {}
    punch, die = started(lambda: moved("punch", 1)), moved("die", -1)
    for name, (tool, off) in (("punch", punch()), ("die", die)):
        distance[name] = off
        tool.net = placed(tool.net, matrix, options.move)
        tool.normals = None if tool.normals is None else tool.normals @ matrix.T
        tool.notes = notes + tool.notes
        notes = []
        found.append(tool)
    beyond = max(off.max() for off in distance.values()) / max(options.tolerance, options.sew or 0.0)
    if 1.0 < beyond < NEARLY and finer == 1.0:
        return both_sides(gmsh, options, progress, FINER / beyond)
    return found[0], found[1], distance, [options.roles.get(tag, "") for tag in model.origin]


def refuse_left_out(model: cad_mesh.Model, options: ToolSettings) -> None:
    """Refuse a choice of faces, not made by the user, that leaves out a part of what is seen from the punch."""
    if options.faces or options.taken:
        return
    total = max(sum(options.visible.values()), 1e-300)
    left = {tag: area for tag, area in options.visible.items() if tag not in model.origin and area > WALL * total}
    part = sum(left.values()) / total
    if part > LEFT_OUT:
        both = spans(sorted({*model.origin, *left} - {0}))
        raise Problem(f"{100 * part:.3g} % of what is seen of the block are left out, faces {spans(list(left))}, as "
                      "they do not join the others smoothly. If the block is a tool: "
                      f"dd3 tool {options.source} tool.bez --toward {options.seen} makes it of all faces. If it has "
                      f"the shape of a part: --faces {both} takes them too, or choose those that one tool touches")


def refuse_apart(surface: Surface, options: ToolSettings) -> None:
    """Refuse a side, not chosen by the user, in parts that are not joined."""
    joints = find_joints(surface.net)
    part = groups(len(surface.net), joints.first // 4, joints.second // 4)
    if options.faces or part.max() == 0:
        return
    named = [report.named(surface, np.unique(surface.face[part == one])) for one in np.unique(part)]
    raise Problem(f"{options.source}: the faces of the side that the tools touch are in {len(named)} parts, which are "
                  f"not joined: {named[0]}; {named[1]}. Join them in the CAD program, or choose those of one part by "
                  "--faces")


def made(gmsh: Any, options: ToolSettings, progress: Any) -> ToolSet:
    """Return the tools of a part; where the patches along its rim are too long for the die face, it is meshed again."""
    options = copy(options)
    for _ in range(MESHED):
        punch, die, distance, roles = both_sides(gmsh, options, progress)
        own = own_flange.labels_of(die, roles, shoulder=False)
        try:
            face = with_face(gmsh, own_flange.trimmed(die, own), options)
            break
        except TooLong as error:
            options.longest = error.length
        except NoBinder as missing:
            if options.advice or not no_holder.is_shallow(die):
                raise
            return without_holder(punch, die, distance, missing.reason, options)
    else:
        raise Problem(f"{options.source}: the binder at the rim of the part is curved too strongly")
    whole = punch, die
    notes = punch.notes + die.notes
    result = ToolSet(distance=distance, lines=[("", note) for note in notes] + face.lines)
    result.curves = trim_deck.on_tool(punch if options.side == "punch" else die, options)
    punch, curves = with_walls(own_flange.trimmed(punch, own_flange.labels_of(punch, roles, shoulder=True)), face,
                               options)
    beside = own_flange.labels_of(die, roles, shoulder=True) - own
    made_here = options.shoulder if any(not reach.own for reach in face.reaches) else np.inf
    radius = own_flange.least_radius(die, beside)
    result.shoulder = min(made_here, radius)
    if beside:
        result.lines.append(("shoulder", f"of the part, radius {radius:.3g} mm on the die"))
    result.bend, least = (own_flange.least_radius(tool, range(len(tool.names))) for tool in (punch, face.surface))
    result.radius = min(result.shoulder, result.bend, least)
    assert face.blank
    set_blank(result, face.blank, face.surface, options)
    result.flange = max(reach.width for reach in face.reaches) + result.lost
    top = float(report.extent(face.surface.net[face.surface.face == len(face.surface.names) - 1])[1][2])
    over = top + options.thickness
    result.height = -top
    result.inner_pan = drawability.inner_pan(punch, roles)
    result.travel = float(over - report.extent(punch.net)[0][2])
    others = {"punch": (punch, result.travel - top), "die": (face.surface, -top)}
    floor = np.isin(face.surface.face, [label for label, role in enumerate(roles) if role == "floor"])
    result.pulls = pulls(face)
    pad = floor.any() and one_sided(face, result.pulls)
    held = not pad or any(reach.own or goes_around(reach) for reach in face.reaches)
    binder = face.binders[0]
    if held and len(face.binders) == 1 and binder.plane and (slope := binder.gradient(np.zeros(2))).any():
        result.blank.slope, result.blank.height = slope, float(binder.z(np.zeros(2))) - top
    if pad:
        part = face.surface.select(floor)
        result.pins = pins(options.holes, part, options)
        others["die"] = face.surface.select(~floor), -top
        others["pad"] = part, result.blank.height - highest(part, result.blank.slope)
        result.lines.append(("pad", "under the floor, as the part is formed on one side of it only"))
    elif (free := free_stroke(face)) > options.thickness:
        result.lines.append(("floor", f"not held: the rims of its walls are at two heights, so that one wall is formed "
                             f"alone over {free:.3g} mm of the stroke, and may draw the sheet along the punch by up to "
                             "that; compare the middle of the sheet after the draw, and give the blank that margin"))
    if held:
        holder = holder_of(gmsh, face, curves, options)
        if len(report.folded(holder.net)) and not options.advice and no_holder.is_shallow(die):
            return without_holder(*whole, distance, "the binder around the part would fold", options)
        if not result.blank.inclined:
            closing = float(over - report.extent(holder.net)[0][2])
            result.closing = closing if closing > options.tolerance else 0.0
        others["holder"] = holder, result.closing - top
    for name, (surface, height) in others.items():
        result.area[name] = result.blank.pressed(surface)
        surface.net = placed(surface.net, np.eye(3), (0.0, 0.0, height))
        result.surfaces[name] = surface
    if all(reach.rim.closed for reach in face.reaches):
        result.ratio = (result.blank.area / result.area["punch"])**0.5
    return result


def set_blank(result: ToolSet, blank: Blank, die: Surface, options: ToolSettings) -> None:
    """Set the blank, cut off at the border of the die, and how much of it is lost where the user's flange is too narrow
    for it."""
    inset = INSET * options.thickness
    low, high = box_of(die.net)
    box = np.array([low[:2] + inset, high[:2] - inset])
    beyond = float(max((box[0] - blank.outline).max(), (blank.outline - box[1]).max()))
    result.lost = beyond if options.flange is not None and beyond > inset else 0.0
    result.blank = blank.within(box)


def highest(part: Surface, slope: np.ndarray) -> float:
    """Return the largest height of a surface over a plane of a slope through the origin, mm."""
    net = part.net.copy()
    net[..., 2] -= net[..., :2] @ slope
    return float(report.extent(net)[1][2])


def without_holder(punch: Surface, die: Surface, distance: dict[str, np.ndarray], reason: str,
                   options: ToolSettings) -> ToolSet:
    """Return the tools of a part that gets no binder, both sides of it with strips as wide as the blank needs."""
    result = ToolSet(distance=distance, lines=[("", note) for note in punch.notes + die.notes])
    result.curves = trim_deck.on_tool(punch if options.side == "punch" else die, options)
    result.blank = estimated(die.net, [no_holder.outer_rim(die)[0]], result.lines, options)
    result.flange = no_holder.width_for(die, result.blank.border, INSET * options.thickness)
    width = options.flange or result.flange
    punch, die = (no_holder.continued(tool, width) for tool in (punch, die))
    result.lines.append(("holder", f"none, as {reason}: formed between punch and die, which go on by "
                         f"{width:.3g} mm along the tangents at the rim"))
    set_blank(result, result.blank, die, options)
    result.radius = min(own_flange.least_radius(tool, range(len(tool.names))) for tool in (punch, die))
    result.shoulder = np.inf
    result.height = -float(report.extent(die.net)[1][2])
    result.travel = options.thickness - result.height - float(report.extent(punch.net)[0][2])
    punch.net = turned(punch.net)
    for name, surface, height in (("punch", punch, result.travel), ("die", die, 0.0)):
        result.area[name] = result.blank.pressed(surface)
        surface.net = placed(surface.net, np.eye(3), (0.0, 0.0, result.height + height))
        result.surfaces[name] = surface
    return result


def pulls(face: Face) -> list[Pull]:
    """Return what pulls at the floor along the rims of the die."""
    found = []
    for reach in face.reaches:
        length = np.linalg.norm(np.diff(reach.rim.points, axis=0), axis=1)
        found.append(Pull(length @ (reach.rim.out[1:] + reach.rim.out[:-1]) / 2, reach.own))
    return found


def one_sided(face: Face, pulled: list[Pull]) -> bool:
    """Tell whether walls or flanges pull the sheet to one side."""
    total = sum(np.linalg.norm(np.diff(reach.rim.points, axis=0), axis=1).sum() for reach in face.reaches)
    return bool(np.linalg.norm(sum(pull.along for pull in pulled)) > ONE_SIDED * total)


def free_stroke(face: Face) -> float:
    """Return the difference of the mean heights of the open rims of the die, mm: the stroke over which the wall of the
    highest one is formed alone; 0 with closed rims, around which the sheet is held."""
    heights = [float(reach.rim.points[:, 2].mean()) for reach in face.reaches if not reach.rim.closed]
    return max(heights) - min(heights) if len(heights) == len(face.reaches) else 0.0


def with_walls(part: own_flange.Trimmed, face: Face, options: ToolSettings
               ) -> tuple[Surface, list[tuple[Rim, np.ndarray]]]:
    """Return the punch, whose normals are upwards, with its walls continued to the height of the holder, and its
    normals downwards; and its rims, with the curves where it ends."""
    punch, joints = part.surface, find_joints(part.surface.net)
    walls = [(rim, True) for rim in find_rims(punch, joints, part.border)[0]]
    walls += [(rim, bool(rim.climb[:, 2].min() > STEEP)) for rim in border_rims(punch, joints, part.border, False)]
    nets, curves = [punch.net], []
    for rim, goes_on in walls:
        curve = rim.points
        reach = nearest(face, rim)
        length = lengths(rim, reach.binder.raised(options.thickness), 0.0) if goes_on else np.zeros(len(curve))
        if length.min() > 0.0:
            rows = wall(rim, length)
            nets.append(patches([rim.points, *rows]))
            curve = rows[-1]
        curves.append((rim, curve))
    label = np.concatenate([punch.face, np.full(sum(map(len, nets[1:])), len(punch.names))])
    whole = consistent(Surface(np.concatenate(nets), label, [*punch.names, "wall"]))
    return Surface(turned(whole.net), whole.face, whole.names), curves


def nearest(face: Face, rim: Rim) -> Reach:
    """Return the rim of the die that is nearest to a rim of the punch."""
    return min(face.reaches, key=lambda reach: cKDTree(reach.rim.points).query(rim.points)[0].mean())


@doing("making the holder")
def holder_of(gmsh: Any, face: Face, curves: list[tuple[Rim, np.ndarray]], options: ToolSettings) -> Surface:
    """Return the holder on the sheet on the binder, as wide as the die, and inwards up to the clearance between die
    and punch, normals downwards."""
    gap = options.thickness + options.clearance
    reaches, inner = [], []
    for rim, curve in curves:
        reach = nearest(face, rim)
        moved = even(curve + gap * rim.out)
        moved[:, 2] = reach.binder.z(moved[:, :2])
        reaches.append(reach)
        inner.append(moved)
    nodes = flange(gmsh, replace(face, reaches=reaches), inner, options.tolerance / 2)
    normal = np.zeros_like(nodes)
    for reach in reaches:
        chosen = np.abs(reach.binder.z(nodes[..., :2]) - nodes[..., 2]) < options.tolerance
        normal[chosen] = reach.binder.normal(nodes[..., :2])[chosen]
    nodes = nodes + options.thickness * normal
    return Surface(turned(from_nodes(nodes)), np.zeros(len(nodes), int), ["holder"])
