# SPDX-License-Identifier: GPL-3.0-or-later
"""What `dd3 tool` takes from the reading of a part: thickness, press direction, the faces of one side; or why it makes
no tools."""
import argparse

import numpy as np

from dd3.gmsh_session import session
from dd3.part.reading import Fault, Reading, Request, read_part, read_upper
from dd3.part.shape import angle_between, unit
from dd3.part.table import kind_of, named
from dd3.progress import Progress
from dd3.tools.faces import spans
from dd3.tools.moved import rotation

UP = np.array([0.0, 0.0, 1.0])
# Angle up to which a direction is z, degrees.
LEVEL = 0.01
# Angle from which the direction that is proposed is another one, degrees.
OTHER = 60.0
# That from which it is the other side, degrees.
REVERSED = 135.0


def read_for_tools(options: argparse.Namespace) -> Reading:
    """Read the part of the options, and set `thickness`, `rotate` and `taken`, the faces that one tool touches, where
    they are not given, and `advice` for where no die can be made around it. The punch comes along z after the
    rotation."""
    given = options.toward is not None or bool(options.rotate)
    up = rotation(options.rotate).T @ UP if options.toward is None else unit(np.array(options.toward, float))
    progress = Progress(options.source.name)
    with session() as gmsh:
        reading = read_part(gmsh, Request(options.source, options.part, None, up, options.thickness, options.scale,
                                          options.sew, options.tolerance), progress)
    progress.end()
    if reading.direction is None or options.faces:  # with faces of the user's choice the part is not judged
        reading.faults = reading.faults if reading.direction is None else []
    elif not given and reading.best is not None and turns(reading):
        take(reading)
        up = reading.best.vector
    if options.toward is not None or not given:
        options.rotate = turn_to_z(up)
    options.thickness = options.thickness or rounded(reading.sheet.thickness)
    if not options.thickness and not reading.faults:
        reading.faults.append(Fault(f"{kind_of(reading)}: give the thickness of the sheet by --thickness"))
    options.advice = advice(reading, up)
    sides = reading.sheet.sides
    if not options.faces and reading.sheet.kind == "sheet" and reading.direction:
        upper = reading.direction.upper
        options.taken = upper if options.side == "punch" else sides[1] if upper == sorted(sides[0]) else sides[0]
    return reading


def rounded(thickness: float | None) -> float | None:
    """Return a thickness to 0.1 %, without the rounding errors of the CAD."""
    return float(f"{thickness:.4g}") if thickness else None


def turns(reading: Reading) -> bool:
    """Tell whether another direction is to be taken than z, which has an undercut or is that of the closed side."""
    direction, best = reading.direction, reading.best
    assert direction and best
    closed = bool(angle_between(direction.vector, best.vector) > REVERSED)
    return reading.sheet.kind != "block" and best.free and (closed or not direction.free)


def take(reading: Reading) -> None:
    """Take the best direction."""
    assert reading.best
    reading.faults = []
    reading.directions = [one for one in reading.directions if one is not reading.direction]
    read_upper(reading, reading.best)
    reading.notes.append(f"turned: {reading.best.words} becomes +z, from which the punch comes")


def advice(reading: Reading, up: np.ndarray) -> str:
    """Return what to do if the part has no free edge at which it climbs towards `up`."""
    flange = [tag for tag, role in reading.roles.items() if role.name == "flange"]
    inner = [tag for tag, role in reading.roles.items() if role.name not in ("flange", "shoulder")]
    if reading.best and reading.best.free and angle_between(reading.best.vector, up) > OTHER:
        return f"; the part is open towards {reading.best.words}: --toward {reading.best.components}"
    if flange and inner:
        return f"; it has a flange of its own, {named(flange)}: --faces {spans(inner)} leaves it out"
    return ""


def likely_cause(reading: Reading) -> str | None:
    """Return what of the part most likely makes faulty tools: holes in walls and notches, from which walls go on
    upwards."""
    level = {"floor", "step", "island", "flange"}
    beside = sorted({tag for hole in reading.holes for tag in hole.loop.faces
                     if tag in reading.roles and reading.roles[tag].name not in level})
    what = ([f"holes beside {named(beside)}"] if beside else []) + (["notches of the rim"] if reading.notches else [])
    return f"{' and '.join(what)} are not filled: close them in the CAD program" if what else None


def turn_to_z(vector: np.ndarray) -> list[list[float]]:
    """Return the rotation, axis and degrees, that turns a vector to z, none if it is z."""
    angle = float(angle_between(vector, UP))
    if angle < LEVEL:
        return []
    axis = np.cross(vector, UP) if angle < 180.0 - LEVEL else np.array([1.0, 0.0, 0.0])
    return [[*unit(axis).tolist(), angle]]
