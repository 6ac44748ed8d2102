# SPDX-License-Identifier: GPL-3.0-or-later
"""Surface of one tool from CAD, from facets or from a shape file."""
from collections.abc import Callable
from typing import Any

import numpy as np

from dd3.errors import Problem
from dd3.gmsh_session import session
from dd3.progress import Progress, doing
from dd3.tools import cad, facets, mend, moved, report, sides
from dd3.tools.facet_files import Facets
from dd3.tools.joints import Joints, find_joints
from dd3.tools.offset import at_distance
from dd3.tools.settings import ToolSettings
from dd3.tools.shapes import read_shapes
from dd3.tools.surface import Surface, turned

RADIUS = 0.2  # least radius of an offset, over its distance


def from_shapes(options: ToolSettings, _: Progress) -> tuple[Surface, int, list[tuple[str, str]], list[Any]]:
    """Return the surface of a shape file, the number of its parts and the lines of the report."""
    if options.part:
        raise Problem(f"{options.source}: a shape file has no parts")
    surface = read_shapes(options.source)
    surface.net[..., :3] *= options.scale
    sign, kept, found = face_sheet(surface, find_joints(surface.net), options)
    if options.offset:
        # A face of a shape file is a block, whose patches are turned together.
        blocks = range(len(surface.names))
        distances = [options.offset / options.scale * sign[np.argmax(surface.face == block)] for block in blocks]
        surface = read_shapes(options.source, distances)
        surface.net[..., :3] *= options.scale
    surface = sides.apply(surface, sign, kept)
    surface.notes += found
    return surface, 0, [("distance", "0: exact")], []


def from_cad(options: ToolSettings, progress: Progress) -> tuple[Surface, int, list[tuple[str, str]], list[str]]:
    """Return the surface of a CAD file, the number of its parts and the lines of the report."""
    with session() as gmsh:
        model = cad.read_cad(gmsh, options.source, options, progress)
        surface = cad.surface_of(model)
        sign, kept, found = face_sheet(surface, find_joints(surface.net), options, cad.outward(gmsh, model))
        surface = sides.apply(surface, sign, kept)
        surface.notes += found
        distance = model.distance
        if options.offset or options.radius:
            notes = surface.notes
            # An edge that is sharp for the sheet is concave on the other side of the surface.
            ahead = int(np.sign(options.offset)) or (1 if options.turn else -1)
            surface, distance = at_distance(gmsh, model, sign, kept, options.offset,
                                            options.radius or RADIUS * abs(options.offset), ahead, options.tolerance)
            surface.notes = notes + surface.notes
    return surface, len(model.parts), *judge_distance(surface, distance, options, "measured")


@doing("making patches of facets")
def from_facets(options: ToolSettings, progress: Progress
               ) -> tuple[Surface, int, list[tuple[str, str]], list[str]]:
    """Return the surface of a file of facets, the number of its parts and the lines of the report."""
    mesh = facets.load(options)
    progress(0.3)
    face_facets(mesh, options)
    surface, distance, angle = facets.patches(mesh, options.offset)
    lines, errors = judge_distance(surface, distance, options, "estimated")
    lines.append(("facets", f"{len(mesh.facets)}, turned by {angle:.3g} degrees at most at smooth edges"))
    return surface, len(np.unique(mesh.part)), lines, errors


def face_facets(mesh: Facets, options: ToolSettings) -> None:
    """Turn the facets of a mesh to the sheet and leave out those that face away."""
    area, centre, region, sign, body, is_open, twisted = facets.sides_of(mesh)
    sign, kept, _, notes = sides.settle(area, centre, region, sign, body, is_open, direction(options))
    if not kept.any():
        raise nothing_faces(options)
    if len(twisted):
        raise Problem(f"{options.source}: the surface has one side only, like a Möbius strip, near x y z = "
                      + report.where(centre[twisted[0]]))
    turned_facets = facets.turned_number(sign, body)
    if turned_facets:
        notes.append(f"turned: {report.plural(turned_facets, 'facet')} against the others of their body")
    if not kept.all():
        notes.append(f"left out: {report.plural(int((~kept).sum()), 'facet')} that face away from --toward")
    mend.turn_facets(mesh, sign)
    mend.keep(mesh, kept)
    mesh.notes += notes


def direction(options: ToolSettings) -> np.ndarray | None:
    """Return the unit vector of --toward in the axes of the file, or None."""
    if options.toward is None:
        return None
    return moved.rotation(options.rotate).T @ np.array(options.toward) / np.linalg.norm(options.toward)


def nothing_faces(options: ToolSettings) -> Problem:
    """Return the Problem of a --toward that no face has."""
    return Problem(f"{options.source}: no face looks towards {' '.join(f'{value:g}' for value in options.toward)}")


def judge_distance(surface: Surface, distance: np.ndarray, options: ToolSettings, how: str
                  ) -> tuple[list[tuple[str, str]], list[str]]:
    """Return the line of the report on the distance of each face, and an error if one misses the tolerance."""
    used = np.unique(surface.face[surface.face < len(distance)])
    largest = distance[used].max()
    lines = [("distance", f"{how}: {1e3 * largest:.2g} µm at most ({surface.names[used[distance[used].argmax()]]})")]
    allowed = max(options.tolerance, options.sew or 0.0)
    late = used[distance[used] > allowed]
    if not len(late):
        return lines, []
    order = late[np.argsort(-distance[late])]
    return lines, [f"{report.plural(len(late), 'face')} farther than {allowed:g} mm from the "
                   f"{'CAD' if how == 'measured' else 'true surface, as the facets are too coarse'}, up to "
                   f"{distance[order[0]]:.3g} mm: {report.named(surface, order)}; "
                   f"--tolerance {report.up(distance[order[0]]):g} accepts it"]


def face_sheet(surface: Surface, joints: Joints, options: ToolSettings, outward: np.ndarray | None = None
              ) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Return the signs of the patches, which are kept, and lines for the report."""
    sign, kept, turned_faces, notes, _, twisted = sides.faced(surface, joints, direction(options), outward)
    if not kept.any():
        raise nothing_faces(options)
    if len(twisted):
        patches = np.concatenate([joints.first[twisted], joints.second[twisted]]) // 4
        raise Problem(f"{options.source}: the surface has one side only, like a Möbius strip: "
                      + report.named(surface, surface.face[patches]))
    if turned_faces:
        notes.append(f"turned: {report.plural(len(turned_faces), 'face')} against the others of the body: "
                     + report.named(surface, turned_faces))
    away = len(np.unique(surface.face)) - len(np.unique(surface.face[kept]))
    if away:
        notes.append(f"left out: {report.plural(away, 'face')} that face away from --toward")
    return sign, kept, notes


READERS: dict[str, Callable[[ToolSettings, Progress], tuple[Surface, int, list[tuple[str, str]], list[str]]]] = {
    "shape": from_shapes, "cad": from_cad, "facets": from_facets}


def made(options: ToolSettings) -> tuple[Surface, Joints, report.Report]:
    """Return the surface of the options, its joints and the report on it."""
    progress = Progress(options.source.name)
    surface, parts, lines, errors = READERS[options.kind](options, progress)
    progress.end()
    surface.net = moved.placed(surface.net, moved.rotation(options.rotate), options.move)
    if options.turn:
        surface.net = turned(surface.net)
    result, joints = report.judge(surface, options, parts)
    for title, text in [*lines, *(("", note) for note in surface.notes)]:
        result.add(title, text)
    result.errors += errors
    return surface, joints, result
