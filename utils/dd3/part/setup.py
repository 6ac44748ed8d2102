# SPDX-License-Identifier: GPL-3.0-or-later
"""What `dd3 tool` takes from the reading of a part: thickness, press direction, the faces of one side; or why it makes
no tools."""
from dataclasses import replace
from typing import Any

import numpy as np

from dd3.gmsh_session import session
from dd3.part.closed import closed_part
from dd3.part.directions import Direction
from dd3.part.features import read_roles
from dd3.part.loops import find_loops
from dd3.part.openings import curves_of
from dd3.part.reading import Fault, Reading, Request, read_part, read_upper
from dd3.part.shape import angle_between, unit
from dd3.part.table import kind_of
from dd3.progress import Progress
from dd3.tools.faces import numbers_of, side_of_sheet
from dd3.tools.moved import rotation
from dd3.tools.settings import OPEN, ToolSettings
from dd3.tools.symmetry import mirrors_of

UP = np.array([0.0, 0.0, 1.0])
# Angle up to which a direction is z, degrees.
LEVEL = 0.01
# Angle from which the direction that is proposed is another one, degrees.
OTHER = 60.0
# Cosine between directions that are the same.
PARALLEL = 0.999
# That from which it is the other side, degrees.
REVERSED = 135.0


def read_for_tools(options: ToolSettings) -> Reading:
    """Read the part of the options, and set `thickness`, `rotate` and `taken`, the faces that one tool touches, where
    they are not given, `closed`, the part without its openings if it has any, `curves` of its rims, `roles` of the
    faces, `angles` of sharp edges, `holes`, and `advice` for where no die can be made around it. The punch comes along
    z after the rotation."""
    given = options.toward is not None or bool(options.rotate)
    up = rotation(options.rotate).T @ UP if options.toward is None else unit(np.array(options.toward, float))
    progress = Progress(options.source.name)
    with session() as gmsh:
        reading = read_part(gmsh, Request(options.source, options.part, None, up, options.thickness, options.scale,
                                          options.sew, options.tolerance), progress)
        progress.end()
        options.holes = reading.holes
        settle(reading, options, up, given)
        if not reading.faults:
            options.mirrors = mirrors_of(reading.symmetry, reading.shape.size, options)
        if reading.sheet.kind == "block" and not reading.faults:
            options.angles = angles_of_block(gmsh, reading, options)
        faces = options.taken or (reading.sheet.kind == "surface" and not options.faces and reading.shape.tags)
        if faces and not reading.faults:
            options.closed = closed_part(gmsh, reading, faces)
            options.curves = (options.closed.curves if options.closed
                              else curves_of(gmsh, reading.path, reading.shape, faces))
        if options.closed:
            options.taken, edges = options.closed.taken, options.closed.edges
            options.angles = {edges[edge]: angle for edge, angle in options.angles.items() if edge in edges}
    return reading


def settle(reading: Reading, options: ToolSettings, up: np.ndarray, given: bool) -> None:
    """Set what is taken from the reading; `given`: the direction `up` is the user's."""
    if reading.direction and not given:
        reading.direction.name = "axis z"
    if reading.direction is None or options.faces:  # with faces of the user's choice the part is not judged
        reading.faults = reading.faults if reading.direction is None else []
    elif not given and reading.best is not None and turns(reading):
        up = take(reading).vector
    if options.toward is not None or not given:
        options.rotate = turn_to_z(up)
    options.thickness = options.thickness or rounded(reading.sheet.thickness) or OPEN
    if not options.thickness and not reading.faults:
        reading.faults.append(Fault(f"{kind_of(reading)}: give the thickness of the sheet by --thickness"))
    options.advice = advice(reading, up)
    if reading.direction:
        take_side(reading, options)


def take_side(reading: Reading, options: ToolSettings) -> None:
    """Set what is known of the faces of a part: `taken`, those of one side of a sheet, `angles` of the sharp edges
    between these, and `roles` by face; the projected areas of the faces that are seen from the punch, or of a block
    from the side of the sheet, `visible`, and that direction in words, `seen`."""
    sides, direction, shape = reading.sheet.sides, reading.direction, reading.shape
    assert direction
    one = reading.best if reading.sheet.kind == "block" else direction
    if one and abs(one.vector @ direction.vector) > PARALLEL:
        level = np.abs(shape.normal @ one.vector) * shape.area
        options.visible = {tag: float(level[shape.cells[tag]].sum()) for tag in one.upper}
        own = shape.of(one.upper)
        side = np.sign(shape.area[own] @ shape.normal[own] @ one.vector)
        options.seen = replace(one, vector=side * one.vector).components
    lower = sides[1] if direction.upper == sorted(sides[0]) else sides[0]
    if not options.advice:  # a part that is open to another side has no flange on this one
        options.roles = {tag: role.name for tag, role in reading.roles.items()}
    if reading.sheet.kind == "block" and options.faces:
        options.roles = roles_of_block(reading, options)
    if reading.sheet.kind != "sheet":
        return
    loops = find_loops(shape, lower)
    below = replace(direction, upper=sorted(lower), facing=-direction.facing)
    if not options.advice:
        options.roles |= {tag: role.name for tag, role in read_roles(shape, below, loops[0]).items()}
    if not options.faces:
        options.taken = direction.upper if options.side == "punch" else lower
        options.angles = {number: edge.angle for number, edge in shape.edges_inside(options.taken).items()
                          if edge.angle}


def roles_of_block(reading: Reading, options: ToolSettings) -> dict[int, str]:
    """Return what those faces of a block that the user has chosen are for."""
    shape, own = reading.shape, [tag for tag in numbers_of(options.faces) if tag in reading.shape.tags]
    assert reading.direction
    direction, outer = replace(reading.direction, upper=own), find_loops(shape, own)[0]
    return {tag: role.name for tag, role in read_roles(shape, direction, outer).items()}


def angles_of_block(gmsh: Any, reading: Reading, options: ToolSettings) -> dict[int, float]:
    """Return the angles of the sharp edges between the faces of a block that one tool touches, positive where the other
    tool is convex."""
    shape, up = reading.shape, rotation(options.rotate).T @ UP
    below = up if options.side == "punch" else -up
    chosen = numbers_of(options.faces) if options.faces else side_of_sheet(gmsh, reading.path, shape.tags, below)
    own = shape.of(tag for tag in chosen if tag in shape.tags)
    sign = np.sign(shape.area[own] @ shape.normal[own] @ below)
    return {number: sign * edge.angle for number, edge in shape.edges_inside(chosen).items() if edge.angle}


def rounded(thickness: float | None) -> float | None:
    """Return a thickness to 0.1 %, without the rounding errors of the CAD."""
    return float(f"{thickness:.4g}") if thickness else None


def turns(reading: Reading) -> bool:
    """Tell whether another direction is to be taken than z, which has an undercut or is that of the closed side."""
    direction, best = reading.direction, reading.best
    assert direction and best
    closed = bool(angle_between(direction.vector, best.vector) > REVERSED)
    return reading.sheet.kind != "block" and (not direction.free or (best.free and closed))


def take(reading: Reading) -> Direction:
    """Take and return another direction: the opposite one, if the part has no undercut from there, else the best one,
    also where the part is refused."""
    old, chosen = reading.direction, reading.best
    assert old and chosen
    reading.faults = [fault for fault in reading.faults if fault.edges]  # of the CAD, not of a direction
    reading.directions = [one for one in reading.directions if one is not old]
    chosen = next((one for one in reading.directions if one.free and one.vector @ old.vector < -PARALLEL), chosen)
    read_upper(reading, chosen)
    if chosen.free:
        reading.notes.append(f"turned: {chosen.words} becomes +z, from which the punch comes")
    return chosen


def advice(reading: Reading, up: np.ndarray) -> str:
    """Return what to do if the part has no free edge at which it climbs towards `up`: where it is open."""
    if reading.best and reading.best.free and angle_between(reading.best.vector, up) > OTHER:
        return f"; the part is open towards {reading.best.words}: --toward {reading.best.components}"
    return ""


def turn_to_z(vector: np.ndarray) -> list[list[float]]:
    """Return the rotation, axis and degrees, that turns a vector to z, none if it is z."""
    angle = float(angle_between(vector, UP))
    if angle < LEVEL:
        return []
    axis = np.cross(vector, UP) if angle < 180.0 - LEVEL else np.array([1.0, 0.0, 0.0])
    return [[*unit(axis).tolist(), angle]]
