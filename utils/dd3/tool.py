# SPDX-License-Identifier: GPL-3.0-or-later
"""Make a tool surface, a .bez file, from CAD, from a mesh or STL, or from a profile.

    dd3 tool die.step die.bez --toward 0 0 1             STEP, IGES, BREP
    dd3 tool die.stl die.bez --toward 0 0 1              STL, .msh, .inp, LS-DYNA .k, VTK
    dd3 tool die.shape die.bez                           a profile of lines and arcs, a box with rounded corners
    dd3 tool punch.step die.bez --toward 0 0 -1 --offset 1.1 --turn     a die from a punch

CAD faces become quadrilateral patches whose nodes lie on the CAD, finer until the measured distance is below
--tolerance. Facets become curved patches (Nagata) with normals estimated at their nodes; their distance is an
estimate. Shapes are exact; docs/tools.md describes their file. The report tells what was found; a surface with folds,
edges of more than two patches, free edges that nearly coincide, or a missed tolerance is refused: exit code 2.
"""
import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dd3.command import new_parser
from dd3.errors import Problem, run
from dd3.gmsh_session import session
from dd3.progress import Progress
from dd3.tools import cad, facets, mend, moved, report, sides
from dd3.tools.cad import SUFFIXES as CAD
from dd3.tools.facet_files import SUFFIXES as FACETS
from dd3.tools.facet_files import Facets
from dd3.tools.joints import Joints, find_joints, turn
from dd3.tools.limits import supervised
from dd3.tools.shapes import read_shapes
from dd3.tools.surface import Surface, turned, write

# Largest distance of a surface from CAD, and estimated one of facets, mm.
TOLERANCE = {"cad": 0.002, "facets": 0.02, "shape": 0.002}


def from_shapes(options: argparse.Namespace, _: Progress) -> tuple[Surface, int, list[tuple[str, str]], list[Any]]:
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


def from_cad(options: argparse.Namespace, progress: Progress) -> tuple[Surface, int, list[tuple[str, str]], list[str]]:
    """Return the surface of a CAD file, the number of its parts and the lines of the report."""
    with session() as gmsh:
        model = cad.read_cad(gmsh, options.source, options, progress)
        surface = cad.surface_of(model)
        sign, kept, found = face_sheet(surface, find_joints(surface.net), options)
        surface = sides.apply(surface, sign, kept)
        surface.notes += found
        distance = model.distance
        if options.offset:
            model.nodes, model.uv, model.labels = (part[kept] for part in (model.nodes, model.uv, model.labels))
            model.face = surface.face
            normals = cad.normals(gmsh, model)
            # The normals of the CAD get the sides of the patches.
            side = np.sign((cad.middle_normals(model) * normals[:, 1, 1]).sum(axis=1)) * sign[kept]
            normals *= side[:, None, None, None]
            shift = moved.shift_of(model.labels.ravel(), normals.reshape(-1, 3), options.offset)
            surface.net = cad.surface_of(model, model.nodes + shift.reshape(model.nodes.shape)).net
            surface.net = turn(surface.net, sign[kept])
            distance = cad.by_face(model, cad.distances(gmsh, model, surface.net, options.offset).max(axis=1))
    return surface, len(model.parts), *judge_distance(surface, distance, options, "measured")


def from_facets(options: argparse.Namespace, progress: Progress
               ) -> tuple[Surface, int, list[tuple[str, str]], list[str]]:
    """Return the surface of a file of facets, the number of its parts and the lines of the report."""
    mesh = facets.load(options)
    progress(0.3)
    face_facets(mesh, options)
    surface, distance, angle = facets.patches(mesh, options.offset)
    lines, errors = judge_distance(surface, distance, options, "estimated")
    lines.append(("facets", f"{len(mesh.facets)}, turned by {angle:.3g} degrees at most at smooth edges"))
    return surface, len(np.unique(mesh.part)), lines, errors


def face_facets(mesh: Facets, options: argparse.Namespace) -> None:
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


def direction(options: argparse.Namespace) -> np.ndarray | None:
    """Return the unit vector of --toward in the axes of the file, or None."""
    if options.toward is None:
        return None
    return moved.rotation(options.rotate).T @ np.array(options.toward) / np.linalg.norm(options.toward)


def nothing_faces(options: argparse.Namespace) -> Problem:
    """Return the Problem of a --toward that no face has."""
    return Problem(f"{options.source}: no face looks towards {' '.join(f'{value:g}' for value in options.toward)}")


def judge_distance(surface: Surface, distance: np.ndarray, options: argparse.Namespace, how: str
                  ) -> tuple[list[tuple[str, str]], list[str]]:
    """Return the line of the report on the distance of each face, and an error if one misses the tolerance."""
    used = np.unique(surface.face)
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


def face_sheet(surface: Surface, joints: Joints, options: argparse.Namespace
              ) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Return the signs of the patches, which are kept, and lines for the report."""
    sign, kept, turned_faces, notes, _, twisted = sides.faced(surface, joints, direction(options))
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


def reader_of(path: Path) -> tuple[str, Callable[..., Any]]:
    """Return the kind of a source by its ending."""
    ending = path.suffix.lower()
    if ending in CAD:
        return "cad", from_cad
    if ending == ".shape":
        return "shape", from_shapes
    if ending in FACETS:
        return "facets", from_facets
    raise Problem(f"{path}: unknown kind of file; expected one of {' '.join((*CAD, *FACETS))} .shape")


def command_line() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = new_parser("tool", __doc__)
    parser.add_argument("source", type=Path, help="CAD, mesh or shape file")
    parser.add_argument("target", type=Path, nargs="?", help=".bez file to write; without it there is a report only")
    parser.add_argument("--toward", type=float, nargs=3, metavar=("X", "Y", "Z"),
                        help="direction from the tool to the sheet: chooses the side of its normals; faces that look "
                             "the other way are left out")
    parser.add_argument("--scale", type=float, default=1.0, help="factor on the coordinates, 1000 for metres")
    parser.add_argument("--rotate", type=float, nargs=4, action="append", default=[],
                        metavar=("X", "Y", "Z", "DEGREES"),
                        help="rotate about an axis through the origin of the file; may be repeated")
    parser.add_argument("--move", type=float, nargs=3, default=(0, 0, 0), metavar=("X", "Y", "Z"),
                        help="move after the rotation, mm")
    parser.add_argument("--sew", type=float, metavar="mm", help="join free edges and nodes up to this far apart")
    parser.add_argument("--tolerance", type=float, metavar="mm",
                        help="largest distance from the CAD (0.002); of facets, an estimate (0.02)")
    parser.add_argument("--offset", type=float, default=0.0, metavar="mm",
                        help="move the surface along its normals, towards the sheet if positive")
    parser.add_argument("--turn", action="store_true", help="turn the normals at the end: a die from a punch")
    parser.add_argument("--part", action="append", metavar="NAME",
                        help="name or number of a part to take; may be repeated (default: all)")
    parser.add_argument("--picture", type=Path, metavar="PNG", help="draw the patches with their normals")
    return parser


def arguments(words: Sequence[str] | None = None) -> argparse.Namespace:
    """Return the options after their checks."""
    parser = command_line()
    options = parser.parse_args(words)
    if not options.source.exists():
        raise Problem(f"{options.source}: no such file")
    if not options.source.is_file():
        raise Problem(f"{options.source}: not a file")
    if not options.source.stat().st_size:
        raise Problem(f"{options.source}: the file is empty")
    if options.target and options.target.suffix != ".bez":
        raise Problem(f"{options.target}: the name of a tool surface ends in .bez")
    if options.toward and not np.any(options.toward):
        parser.error("--toward takes a direction")
    for name in ("scale", "sew", "tolerance"):
        if getattr(options, name) is not None and not 0 < getattr(options, name) < np.inf:
            parser.error(f"--{name} takes a positive number")
    if any(not np.any(axis) for *axis, _ in options.rotate):
        parser.error("--rotate takes an axis and an angle")
    options.kind, options.reader = reader_of(options.source)
    options.tolerance = options.tolerance or TOLERANCE[options.kind]
    return options


def made(options: argparse.Namespace) -> tuple[Surface, Joints, report.Report]:
    """Return the surface of the options, its joints and the report on it."""
    progress = Progress(options.source.name)
    surface, parts, lines, errors = options.reader(options, progress)
    progress.end()
    surface.net = moved.placed(surface.net, moved.rotation(options.rotate), options.move)
    if options.turn:
        surface.net = turned(surface.net)
    result, joints = report.judge(surface, options, parts)
    for title, text in [*lines, *(("", note) for note in surface.notes)]:
        result.add(title, text)
    result.errors += errors
    return surface, joints, result


def convert(words: Sequence[str]) -> None:
    """Read, judge, write, report."""
    options = arguments(words)
    surface, joints, result = made(options)
    if options.picture:
        from dd3.tools.picture import draw
        draw(surface, joints, options.picture)
    if options.target and not result.errors:
        write(options.target, surface, [f"{options.source.name}: dd3 tool {' '.join(words)}"])
    try:
        print(options.target or options.source, *result.lines, sep="\n", flush=True)
    finally:  # also where the reader of the report, such as head, has closed the pipe
        for kind, texts in (("warning", result.warnings), ("error", result.errors)):
            for text in texts:
                print(f"{kind}: {options.source}: {text}", file=sys.stderr)
    if result.errors:
        sys.exit(2)


def main(words: Sequence[str] | None = None) -> None:
    """Convert the file of the command line, in a process of its own."""
    words = sys.argv[1:] if words is None else words
    supervised(lambda: run(lambda: convert(words)), "the file is damaged: a fault in the library that reads it")
