# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading of a part: all that is found of it before tools are made."""
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from dd3.account import Account
from dd3.part.assembly import outlined
from dd3.part.bends import Bend, find_bends
from dd3.part.candidates import candidates
from dd3.part.directions import Direction, best, judged
from dd3.part.features import Role, inner_and_outer_radius, read_roles
from dd3.part.loops import Hole, Loop, Notch, find_loops, find_notches, hole_of
from dd3.part.rays import Rays
from dd3.part.sampling import sampled
from dd3.part.shape import Shape
from dd3.part.sheet import Sheet, apart, is_flat, read_sheet
from dd3.part.symmetry import symmetry_planes
from dd3.part.units import unit_of
from dd3.progress import doing
from dd3.tools import cad_file, faces
from dd3.tools.cad_account import enter_cad

MOST_PARTS = 8  # that a message names
# Distance within which free edges are sewn without being asked, mm.
SEWN = 0.002
# Difference of a given thickness, relative, that is told; fraction of the area at one thickness below which it varies.
DIFFERENT, UNIFORM = 0.02, 0.9
# Largest size and thickness that tell of another unit, mm, and how large the sheet would be in it.
SMALL, THIN, THICK = 10.0, 0.1, 6.0
UNITS = {"inches": 25.4, "metres": 1000.0}


@dataclass
class Request:
    """What is to be read: file; names of parts and numbers of faces, none for all; direction from the part to the
    punch, none for the best; thickness to be checked, mm; factor on the coordinates; distance of edges to be sewn,
    mm."""

    path: Path
    parts: list[str] | None = None
    faces: Sequence[str] | None = None
    toward: Sequence[float] | np.ndarray | None = None
    thickness: float | None = None
    scale: float = 1.0
    sew: float | None = None
    tolerance: float = SEWN


@dataclass
class Fault:
    """A reason why a part cannot be drawn as it is, with the faces and the edges concerned."""

    text: str
    faces: list[int] = field(default_factory=list)
    edges: list[int] = field(default_factory=list)


@dataclass
class Reading:
    """What is found of a part: unit of the file; names of its parts with their faces; triangles; sheet, surface or
    block; whether its faces belong to solids; directions with the one that is taken, and the best one; rims of its
    upper side, the outer one first; roles of its faces; bends, if it is formed by these alone; least radii inside and
    outside of bends with the face or the edge; planes of symmetry; what is to be told; entities of the file that are
    left out; why it cannot be drawn; seconds."""

    path: Path
    unit: str
    parts: list[tuple[str, set[int]]]
    shape: Shape
    sheet: Sheet
    solid: bool = True
    flat: bool = False
    directions: list[Direction] = field(default_factory=list)
    direction: Direction | None = None
    best: Direction | None = None
    outer: Loop | None = None
    holes: list[Hole] = field(default_factory=list)
    notches: list[Notch] = field(default_factory=list)
    roles: dict[int, Role] = field(default_factory=dict)
    bends: list[Bend] = field(default_factory=list)
    inner_radius: tuple[float, int] = (np.inf, 0)
    outer_radius: tuple[float, int] = (np.inf, 0)
    symmetry: list[tuple[np.ndarray, float]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    left_out: list[str] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    seconds: float = 0.0


def read_part(gmsh: Any, request: Request, progress: Callable[[float], None] = lambda fraction: None) -> Reading:
    """Return the reading of a part."""
    start = time.perf_counter()
    path = request.path
    cad_file.load(gmsh, path)
    progress(0.3)
    account = Account()
    enter_cad(path, account, len(gmsh.model.getEntities(2)))
    notes = cad_file.single(gmsh) + cad_file.sew(gmsh, path, request.sew or request.tolerance, request.sew is not None)
    if request.scale != 1.0:
        gmsh.model.occ.dilate(gmsh.model.getEntities(), 0, 0, 0, *[request.scale] * 3)
        gmsh.model.occ.synchronize()
    parts = cad_file.part_names(gmsh)
    progress(0.5)
    tags = faces.chosen(gmsh, path, cad_file.choose(path, parts, request.parts), request.faces, False)
    solid = set(tags) <= {abs(tag) for _, tag in gmsh.model.getBoundary(gmsh.model.getEntities(3), combined=False)}
    gaps = cad_file.find_gaps(gmsh)  # shells with a gap between them are one part
    if len(parts) > 1 and not gaps and not request.parts and not request.faces:
        reading = Reading(path, unit_of(path), parts, outlined(gmsh, parts), Sheet("parts"), solid, notes=notes)
        reading.faults.append(Fault(f"{len(parts)} parts: {names_of(parts)}; --part takes the one that is to be "
                                    "formed"))
    else:
        gmsh.model.removeEntities(gmsh.model.getEntities(3))
        gmsh.model.removeEntities([(2, tag) for _, tag in gmsh.model.getEntities(2) if tag not in tags], recursive=True)
        shape = sampled(gmsh, path, tags)
        progress(0.8)
        rays = Rays(shape)
        reading = Reading(path, unit_of(path), parts, shape, read_sheet(shape, rays), solid, notes=notes)
        tell_faces(gmsh, reading, request, gaps)
        tell_thickness(reading, request)
        tell_open(reading, rays)
        read_form(reading, rays, request)
    reading.left_out = [f"left out: {item}" for item in account.left_out()]
    reading.seconds = time.perf_counter() - start
    return reading


def names_of(parts: list[tuple[str, set[int]]]) -> str:
    """Return the numbers and names of the first parts."""
    names = [f"{number} '{name}'" for number, (name, _) in enumerate(parts[:MOST_PARTS], 1)]
    return ", ".join(names) + (f" and {len(parts) - MOST_PARTS} more" if len(parts) > MOST_PARTS else "")


def tell_faces(gmsh: Any, reading: Reading, request: Request, gaps: list[tuple[float, int, int]]) -> None:
    """Enter faces without triangles and gaps between free edges."""
    failed = reading.shape.failed
    if failed:
        edges = [edge for edge, known in reading.shape.edges.items() if set(known.faces) & set(failed)]
        reading.faults.append(Fault(f"faces {faces.spans(failed)} are damaged: Gmsh makes no triangles of them; mend "
                                    "them in the CAD program", edges=edges))
    gaps = [gap for gap in gaps if set(gap[1:]) <= set(reading.shape.edges)]
    if gaps:
        reading.faults.append(Fault(cad_file.said_of_gaps(gmsh, gaps, request.sew or request.tolerance),
                                    edges=sorted({edge for gap in gaps for edge in gap[1:]})))


def tell_open(reading: Reading, rays: Rays) -> None:
    """Enter that an open shell has both sides of a sheet."""
    distance = apart(reading.shape, rays) if reading.sheet.kind == "surface" else None
    if distance:
        free = [edge for edge, known in reading.shape.edges.items() if len(known.faces) == 1]
        beside = sorted({face for edge in free for face in reading.shape.edges[edge].faces})
        reading.warnings.append(f"the faces are {distance:.4g} mm apart, as both sides of a sheet, but the shell is "
                                f"open beside faces {faces.spans(beside)}: a face is missing there, or not joined; "
                                "close it in the CAD program, or take the faces of one side by --faces")


def tell_thickness(reading: Reading, request: Request) -> None:
    """Enter what is to be said of the thickness and of the unit."""
    thickness, sheet = reading.sheet.thickness, reading.sheet
    if thickness and request.thickness and abs(request.thickness - thickness) > DIFFERENT * thickness:
        reading.warnings.append(f"the sheet of the file is {thickness:.4g} mm thick, --thickness {request.thickness:g} "
                                "was given")
    if thickness and sheet.fraction < UNIFORM:
        reading.warnings.append(f"only {100 * sheet.fraction:.0f} % of the area have the thickness {thickness:.4g} mm")
    if reading.unit in ("none", "m") and (reading.shape.size < SMALL or (thickness and thickness < THIN)):
        other = [f"in {name} the part would be {reading.shape.size * factor:.4g} mm long"
                 + (f" and {thickness * factor:.3g} mm thick" if thickness else "") + f": --scale {factor:g}"
                 for name, factor in UNITS.items() if not thickness or thickness * factor <= THICK]
        if other:
            thick = f" and {thickness:.3g} mm thick" if thickness else ""
            reading.warnings.append(f"{reading.shape.size:.3g} mm long{thick}, in a file without a unit; "
                                    + "; ".join(other))


@doing("judging press directions and faces")
def read_form(reading: Reading, rays: Rays, request: Request) -> None:
    """Find direction, rims, roles of the faces, bends, radii and symmetry."""
    shape, sheet = reading.shape, reading.sheet
    reading.flat = is_flat(shape, sheet)
    reading.inner_radius, reading.outer_radius = inner_and_outer_radius(shape, sheet.sides)
    loops = find_loops(shape, sheet.sides[0]) if sheet.kind != "block" else []
    rim = loops[0].nodes if loops else np.zeros(0, int)
    tried = candidates(shape, sheet)
    reading.directions = [judged(shape, rays, sheet, name, vector, rim) for name, vector in tried]
    reading.direction = reading.best = best(shape, reading.directions, sheet)
    if request.toward is not None:
        reading.direction = judged(shape, rays, sheet, "--toward", np.array(request.toward), None)
        reading.directions.insert(0, reading.direction)
    if sheet.kind != "block":
        reading.bends = find_bends(shape, sheet.sides[0])
    read_upper(reading, reading.direction)
    reading.symmetry = symmetry_planes(shape, rays, reading.direction.vector)


def read_upper(reading: Reading, direction: Direction) -> None:
    """Take a direction: read rims and roles of the faces of its upper side, and why the part cannot be drawn from
    it."""
    reading.direction = direction
    if reading.sheet.kind == "block":
        return
    loops = find_loops(reading.shape, direction.upper)
    reading.outer = loops[0] if loops else None
    reading.holes = [hole_of(reading.shape, loop) for loop in loops[1:]]
    reading.notches = find_notches(reading.shape, direction.upper, loops[0]) if loops else []
    reading.roles = read_roles(reading.shape, direction, reading.outer)
    tell_undercut(reading)


def tell_undercut(reading: Reading) -> None:
    """Enter why the part cannot be drawn from its direction; of a part whose faces are damaged or not joined it is not
    known."""
    if any(fault.edges for fault in reading.faults):
        return
    direction, other = reading.direction, reading.best
    assert direction and other
    if reading.flat:
        reading.faults.append(Fault("the part is flat: nothing is to be formed"))
        return
    if direction.free:
        return
    hidden = direction.undercut
    lean = -min(hidden.values(), default=0.0)
    how = f"they lean back by up to {lean:.3g} degrees" if lean > 0.0 else "something is above them"
    text = f"{100 * direction.fraction:.2g} % of the sides, {how}"
    named = faces.spans(list(hidden)) if hidden else ""
    if not hidden:
        said = (f"from {direction.words} the part is seen along its faces" + (f": --toward {other.components}"
                                                                              if other.free else ""))
    elif other.free:
        said = (f"undercut at faces {named} from {direction.words} ({text}); from {other.words} there is none: "
                f"--toward {other.components}")
    else:
        said = (f"undercut at faces {named}: not in one stroke from any direction; from {direction.words} they are "
                f"{text}")
        if reading.bends:
            said += f"; the part is bent along {len(reading.bends)} straight lines, which takes more than one stroke"
    reading.faults.append(Fault(said, faces=list(hidden)))
