# SPDX-License-Identifier: GPL-3.0-or-later
"""Punch, die and holder of a part, and an input file that draws it.

The part is the surface of the drawn sheet that the punch touches, or the die; it has neither shoulder nor flange. The
punch comes from above. The other tool is at the distance of the thickness and the clearance. From the rims of the die
its walls go on, ruled along the steepest ascent, to a shoulder and a flat flange, which is at z = 0.
"""
import argparse
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dd3.errors import Problem
from dd3.tools import cad, report, sides
from dd3.tools.joints import box_of, find_joints, orient, turn
from dd3.tools.moved import placed, rotation
from dd3.tools.offset import at_distance
from dd3.tools.plane import Side, box, flat, straight
from dd3.tools.rims import Rim, find_rims, patches, rise, shoulder, wall
from dd3.tools.surface import Surface, area_vectors, from_nodes, turned

# Defaults over the thickness: clearance, radius of the shoulder, width of the flange.
CLEARANCE, SHOULDER, FLANGE = 0.1, 6.0, 40.0
# Height over the thickness that the shortest ruled wall has, where one is needed.
SHORTEST = 0.5
DOWN = np.array([0.0, 0.0, -1.0])


@dataclass
class ToolSet:
    """Surfaces by the names of the tools, with the die's flange at z = 0 and the punch at the start of its travel; the
    travel, mm; the box of the flange in plan (2, 2) and the area of the holder, mm2; the largest distances of
    the faces of punch and die from the CAD, mm; lines of the report."""

    surfaces: dict[str, Surface] = field(default_factory=dict)
    travel: float = 0.0
    plan: np.ndarray = field(default_factory=lambda: np.zeros((2, 2)))
    area: float = 0.0
    distance: dict[str, np.ndarray] = field(default_factory=dict)
    lines: list[tuple[str, str]] = field(default_factory=list)


def both_sides(gmsh: Any, options: argparse.Namespace, progress: Any) -> tuple[Surface, Surface, dict[str, np.ndarray]]:
    """Return the surfaces of the punch and the die in the closed press, both with normals upwards, into the cavity, and
    the largest distances of their faces from the CAD by the names of the tools, mm."""
    model = cad.read_cad(gmsh, options.source, options, progress)
    surface = cad.surface_of(model)
    matrix = rotation(options.rotate)
    up = matrix.T @ -DOWN
    sign, kept, _, notes, _, twisted = sides.faced(surface, find_joints(surface.net), up, cad.outward(gmsh, model))
    if len(twisted) or not kept.any():
        raise Problem(f"{options.source}: the faces have no common upper side; choose them by --faces")
    notes = model.notes + notes
    if not kept.all():
        notes.append("left out: faces that look downwards: " + report.named(surface, np.unique(model.face[~kept])))
    gap = options.thickness + options.clearance
    found, distance = [], {}
    for name, ahead in (("punch", 1), ("die", -1)):
        shift = 0.0 if options.side == name else ahead * gap
        tool, distance[name] = at_distance(gmsh, model, sign, kept, shift, options.radius, ahead, options.tolerance)
        tool.net = placed(tool.net, matrix, options.move)
        tool.notes = notes + tool.notes
        notes = []
        found.append(tool)
    return found[0], found[1], distance


def made(gmsh: Any, options: argparse.Namespace, progress: Any) -> ToolSet:
    """Return the tools of a part."""
    punch, die, distance = both_sides(gmsh, options, progress)
    result = ToolSet(distance=distance, lines=[("", note) for note in punch.notes + die.notes])
    rims, others = find_rims(die, find_joints(die.net))
    if not rims:
        raise Problem(f"{options.source}: no free edge of the part at which it climbs by more than 10 degrees, as the "
                      f"punch moves along -z into the part{options.advice}")
    if others:
        result.lines.append(("edges", f"{others} free edges of patches stay open, as the part does not climb there"))
    face = max(float((rim.points[:, 2] + rise(rim, options.shoulder)).max()) for rim in rims)
    missing = max(float((face - rim.points[:, 2] - rise(rim, options.shoulder)).max()) for rim in rims)
    level = missing <= options.tolerance
    if not level:
        face += SHORTEST * options.thickness
        result.lines.append(("walls", f"continued up to {missing + SHORTEST * options.thickness:.3g} mm to the "
                             "shoulder"))
    die, inner = with_flange(gmsh, die, rims, face, level, options)
    top = face + options.thickness
    over = flange(gmsh, rims, inner, top, options.flange)
    holder = Surface(turned(from_nodes(over)), np.zeros(len(over), int), ["holder"])
    punch = with_walls(punch, top)
    low, high = box_of(die.net)
    result.plan = np.array([low[:2], high[:2]])
    result.area = float(np.linalg.norm(area_vectors(holder.net).sum(axis=0)))
    result.travel = float(top - report.extent(punch.net)[0][2])
    for name, surface, height in (("punch", punch, result.travel - face), ("die", die, -face),
                                  ("holder", holder, -face)):
        surface.net = placed(surface.net, np.eye(3), (0.0, 0.0, height))
        result.surfaces[name] = surface
    return result


def with_flange(gmsh: Any, die: Surface, rims: list[Rim], face: float, level: bool, options: argparse.Namespace
                ) -> tuple[Surface, list[np.ndarray]]:
    """Return the die with shoulder and flange, which is at the height `face`, and the nodes of the rims at which the
    shoulder begins; with ruled walls up to there unless the rims are level."""
    radius = options.shoulder
    nets, inner, outer = [die.net], [], []
    for rim in rims:
        rows = [] if level else wall(rim, (face - rim.points[:, 2] - rise(rim, radius)) / rim.climb[:, 2])
        inner.append(rows[-1] if rows else rim.points)
        rows += shoulder(rim, inner[-1], radius, options.tolerance / 2)
        rows[-1][:, 2] = face
        nets.append(patches([rim.points, *rows]))
        outer.append(rows[-1])
    nets.append(from_nodes(flange(gmsh, rims, outer, face, options.flange)))
    added = len(die.names)
    labels = np.concatenate([die.face, np.repeat([added, added + 1], [sum(map(len, nets[1:-1])), len(nets[-1])])])
    return consistent(Surface(np.concatenate(nets), labels, [*die.names, "shoulder", "flange"])), inner


def with_walls(punch: Surface, top: float) -> Surface:
    """Return the punch, whose normals are upwards, with its walls continued to a height, and its normals downwards."""
    rims, _ = find_rims(punch, find_joints(punch.net))
    nets = [punch.net]
    for rim in rims:
        length = (top - rim.points[:, 2]) / rim.climb[:, 2]
        if length.min() > 0.0:
            nets.append(patches([rim.points, *wall(rim, length)]))
    face = np.concatenate([punch.face, np.full(sum(map(len, nets[1:])), len(punch.names))])
    whole = consistent(Surface(np.concatenate(nets), face, [*punch.names, "wall"]))
    return Surface(turned(whole.net), whole.face, whole.names)


def consistent(surface: Surface) -> Surface:
    """Return the surface with all patches turned as the first one."""
    sign, _, _ = orient(surface.net, find_joints(surface.net))
    surface.net = turn(surface.net, sign)
    return surface


def flange(gmsh: Any, rims: list[Rim], curves: list[np.ndarray], height: float, width: float) -> np.ndarray:
    """Return the nodes (patch, 3, 3, 3) of a flat flange around closed rims and beside open ones, from curves that
    belong to these; normals upwards."""
    for curve in curves:
        if len(curve) % 4 != 1:  # an odd number of patches, beside which the mesh of the flange cannot be
            raise Problem("an edge climbs by more than 10 degrees along a part of it only, up to near x y z = "
                          + report.where(curve[-1]) + ": divide it there in the CAD program")
    nodes = []
    closed = [curve for rim, curve in zip(rims, curves) if rim.closed]
    if closed:
        outline = box(np.concatenate(closed)[:, :2], width)
        nodes.append(flat(gmsh, [outline, *([Side(curve[:, :2], True)] for curve in closed)], height))
    for rim, curve in zip(rims, curves):
        if not rim.closed:
            start, end = curve[0, :2], curve[-1, :2]
            far_start, far_end = start + width * rim.out[0, :2], end + width * rim.out[-1, :2]
            nodes.append(flat(gmsh, [[Side(curve[:, :2], True), straight(end, far_end), straight(far_end, far_start),
                                      straight(far_start, start)]], height))
    return np.concatenate(nodes)
