# SPDX-License-Identifier: GPL-3.0-or-later
"""Make a tool surface, a .bez file, from CAD, from a mesh or STL, or from a profile.

    dd3 tool die.step die.bez --toward 0 0 1             STEP, IGES, BREP
    dd3 tool die.stl die.bez --toward 0 0 1              STL, .msh, .inp, LS-DYNA .k, VTK
    dd3 tool die.shape die.bez                           a profile of lines and arcs, a box with rounded corners
    dd3 tool punch.step die.bez --toward 0 0 -1 --offset 1.1 --turn     a die from a punch
    dd3 tool part.step folder                            punch, die, holder and an input file of a part

CAD faces become quadrilateral patches whose nodes lie on the CAD, finer until the measured distance is below
--tolerance. Facets become curved patches (Nagata) with normals estimated at their nodes; their distance is an
estimate. Shapes are exact; docs/tools.md describes their file. The report tells what was found; a surface with folds,
edges of more than two patches, free edges that nearly coincide, or a missed tolerance is refused: exit code 2.
"""
import argparse
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from dd3 import places
from dd3.command import new_parser
from dd3.errors import Problem, run
from dd3.gmsh_session import session
from dd3.part import setup, table
from dd3.part.command import write_reading
from dd3.progress import Progress
from dd3.sheet import Sheet
from dd3.tools import (
    beads,
    cad,
    facets,
    mend,
    moved,
    pad_force,
    picture,
    report,
    set_deck,
    set_material,
    sides,
    tool_set,
    trim_deck,
)
from dd3.tools.cad import SUFFIXES as CAD
from dd3.tools.facet_files import SUFFIXES as FACETS
from dd3.tools.facet_files import Facets
from dd3.tools.joints import Joints, find_joints
from dd3.tools.limits import supervised
from dd3.tools.offset import at_distance
from dd3.tools.shapes import read_shapes
from dd3.tools.surface import Surface, turned, write

RATIO = 2.0  # drawing ratio up to which mild steel is drawn in one stroke, about
RADIUS = 0.2  # least radius of an offset, over its distance
DRAW = "draw.dat"  # input file of a set of tools
ESTIMATE = Path()  # what --beads is without a run
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


def face_sheet(surface: Surface, joints: Joints, options: argparse.Namespace, outward: np.ndarray | None = None
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
    parser.add_argument("target", type=Path, nargs="?",
                        help=".bez file to write, or of a part the folder of its tools; without it there is a report "
                             "only")
    parser.add_argument("--toward", type=float, nargs=3, metavar=("X", "Y", "Z"),
                        help="direction from the tool to the sheet: chooses the side of its normals; faces that look "
                             "the other way are left out. Of a part: from the part to the punch")
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
    parser.add_argument("--radius", type=float, metavar="mm",
                        help="least convex radius of the tool, of CAD: of sharp edges, of smaller fillets, of offsets "
                             "(a fifth of the offset; with --thickness, the thickness)")
    parser.add_argument("--turn", action="store_true", help="turn the normals at the end: a die from a punch")
    parser.add_argument("--part", action="append", metavar="NAME",
                        help="name or number of a part to take; may be repeated (default: all)")
    parser.add_argument("--faces", nargs="+", metavar="N", help="numbers of the CAD's faces to take, such as 3 5-8")
    parser.add_argument("--smooth", action="store_true", help="take all faces too that join those smoothly")
    parser.add_argument("--picture", type=Path, metavar="PNG",
                        help="draw the patches with their normals and the numbers of the CAD's faces")
    whole = parser.add_argument_group("punch, die and holder of a part of CAD, and an input file that draws it")
    whole.add_argument("--thickness", type=float, metavar="mm", help="of the sheet (that of the part)")
    whole.add_argument("--clearance", type=float, metavar="mm",
                       help=f"of punch and die beyond the thickness ({tool_set.SIZES['clearance']:g} thicknesses)")
    whole.add_argument("--shoulder", type=float, metavar="mm",
                       help=f"radius of the die's shoulder ({tool_set.SIZES['shoulder']:g} thicknesses)")
    whole.add_argument("--flange", type=float, metavar="mm",
                       help="width of the die beyond the shoulder (as the blank needs)")
    whole.add_argument("--margin", type=float, metavar="mm",
                       help=f"of the blank beyond the part, or the shoulder ({tool_set.SIZES['margin']:g} thicknesses)")
    whole.add_argument("--beads", type=Path, nargs="?", const=ESTIMATE, metavar="RUN",
                       help="propose draw-beads by the draw-in of the estimate of the blank, or of a finished run of "
                            f"{DRAW}; the margin is then {beads.MARGIN:g} thicknesses")
    whole.add_argument("--program", metavar="FILE",
                       help="the program, which checks the input file (default: dd3imp as `dd3 info` shows it)")
    whole.add_argument("--side", choices=("punch", "die"), help="the tool that touches the faces (punch)")
    whole.add_argument("--material", type=Path, metavar="FILE",
                       help="file with a *MATERIAL for the input file, or the name of one of the library, such as dc06 "
                            "(a mild steel)")
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
    options.kind, options.reader = reader_of(options.source)
    of_part = options.kind == "cad" and options.target is not None and not options.target.suffix
    options.whole = bool(options.thickness) or of_part
    if options.target and not options.whole and options.target.suffix != ".bez":
        raise Problem(f"{options.target}: the name of a tool surface ends in .bez")
    if options.toward and not np.any(options.toward):
        parser.error("--toward takes a direction")
    for name in ("scale", "sew", "tolerance", "radius", "thickness", "shoulder", "flange", "margin"):
        if getattr(options, name) is not None and not 0 < getattr(options, name) < np.inf:
            parser.error(f"--{name} takes a positive number")
    if any(not np.any(axis) for *axis, _ in options.rotate):
        parser.error("--rotate takes an axis and an angle")
    for name in ("thickness", "faces", "radius"):
        if getattr(options, name) and options.kind != "cad":
            parser.error(f"--{name} takes CAD: {' '.join(CAD)}")
    if options.smooth and not options.faces:
        parser.error("--smooth goes with --faces")
    for name in ("clearance", "shoulder", "flange", "margin", "side", "material", "beads"):
        if getattr(options, name) is not None and not options.whole:
            parser.error(f"--{name} goes with a folder, or --thickness")
    options.side = options.side or "punch"
    options.closed = options.taken = None
    options.curves, options.roles, options.angles, options.sharp, options.visible = [], {}, {}, {}, {}
    options.seen = ""
    options.holes = []
    if options.whole:
        check_set(parser, options)
    options.tolerance = options.tolerance or TOLERANCE[options.kind]
    return options


def check_set(parser: argparse.ArgumentParser, options: argparse.Namespace) -> None:
    """Check the options of a set of tools."""
    for name in ("offset", "turn"):
        if getattr(options, name):
            parser.error(f"--{name} is for one tool")
    if options.toward and options.rotate:
        parser.error("--toward and --rotate: of a part either of them gives the direction of the punch")
    if options.target and options.target.suffix:
        raise Problem(f"{options.target}: with --thickness a folder of punch, die, holder and {DRAW}")
    if options.clearance is not None and not 0 <= options.clearance < np.inf:
        parser.error("--clearance takes a number that is not negative")


@contextmanager
def about(path: Path) -> Iterator[None]:
    """Let each error name a file."""
    try:
        yield
    except Problem as problem:
        text = str(problem)
        raise Problem(text if text.startswith(str(path)) else f"{path}: {text}") from problem


def tools_of(gmsh: Any, options: argparse.Namespace, progress: Progress) -> tuple[tool_set.ToolSet, argparse.Namespace]:
    """Return the tools of a part and the options with all sizes; where the drawing ratio is too large, those with a
    smaller shoulder and margin, as far as these were not given."""
    settled = settle_set(options, tool_set.SIZES)
    tools = tool_set.made(gmsh, settled, progress)
    smaller = settle_set(options, tool_set.SIZES | tool_set.SMALLER)
    if tools.ratio <= RATIO or vars(smaller) == vars(settled):
        return tools, settled
    again = tool_set.made(gmsh, smaller, progress)
    if again.ratio >= tools.ratio:
        return tools, settled
    again.lines.append(("ratio", f"shoulder of {smaller.shoulder:.3g} mm and margin of {smaller.margin:.3g} mm, as the "
                        f"drawing ratio is {tools.ratio:.3g} with {settled.shoulder:.3g} and {settled.margin:.3g} mm"))
    return again, smaller


def settle_set(options: argparse.Namespace, sizes: Mapping[str, float]) -> argparse.Namespace:
    """Return the options with the sizes of a set of tools that were not given, from those over the thickness."""
    options = argparse.Namespace(**vars(options))
    options.radius = options.radius or options.thickness
    sizes = {**sizes, "margin": beads.MARGIN} if options.beads else sizes
    for name, factor in sizes.items():
        if getattr(options, name) is None:
            setattr(options, name, factor * options.thickness)
    # The convex ones of a side are the larger by the gap, so that the tool on the other side has the radius there.
    gap = options.thickness + options.clearance
    options.sharp = {edge: options.radius + (gap if angle > 0 else 0.0) for edge, angle in options.angles.items()}
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
    command = f"dd3 tool {shlex.join(words)}"
    if options.whole:
        reports = make_set(options, command)
    else:
        surface, joints, result = made(options)
        reports = {str(options.target or options.source): result}
        if options.picture:
            picture.draw(surface, joints, options.picture)
        if options.target and not result.errors:
            write(options.target, surface, [f"{options.source.name}: {command}"])
    for title, result in reports.items():
        say(title, options.source, result)
    if any(result.errors for result in reports.values()):
        sys.exit(2)


def say(title: str, source: Path, result: report.Report) -> None:
    """Print a report."""
    try:
        print(title, *result.lines, sep="\n", flush=True)
    finally:  # also where the reader of the report, such as head, has closed the pipe
        for kind, texts in (("warning", result.warnings), ("error", result.errors)):
            for text in texts:
                print(f"{kind}: {source}: {text}", file=sys.stderr)


def make_set(options: argparse.Namespace, command: str) -> dict[str, report.Report]:
    """Read a part, write punch, die, holder and the input file; return the reports by the names of the files. No tools
    are made of a part that cannot be drawn, and none is written if one has errors."""
    options.material = set_material.found(options.material)
    set_material.name_of(options.material)
    reading = setup.read_for_tools(options)
    say(str(options.source), options.source, report.Report(table.short(reading), reading.warnings,
                                                           [fault.text for fault in reading.faults]))
    if options.target:
        write_reading(reading, options.target)
    if reading.faults:
        sys.exit(2)
    progress = Progress(options.source.name)
    with session() as gmsh, about(options.source):
        tools, options = tools_of(gmsh, options, progress)
    progress.end()
    reports = judge_set(tools, options)
    if options.target and not any(result.errors for result in reports.values()):
        if "pad" in tools.surfaces:
            set_pad_force(tools, options)
        found = beads_of(tools, options) if options.beads else beads.Beads()
        write_set(tools, options, found, command)
        reports[str(options.target / DRAW)] = report.Report(
            [f"  {'travel':<10} {tools.travel:.6g} mm", f"  {'blank':<10} {set_deck.said(options, tools.blank)}"])
        for line in [set_material.said(options.material), *set_deck.notes(options, tools),
                     *(found.said() if options.beads else [])]:
            reports[str(options.target / DRAW)].add(*line)
        reports[str(options.target / DRAW)].warnings += set_material.warnings(options.material)
        if tools.ratio > RATIO:
            reports[str(options.target / DRAW)].warnings.append(
                f"the drawing ratio, the root of the area of the blank over that of the punch, is {tools.ratio:.3g}: "
                f"mild steel is drawn in one stroke up to about {RATIO:g}. Take a smaller --margin or --shoulder, or "
                "draw it in two strokes")
        check_deck(reports[str(options.target / DRAW)], options)
        if options.curves:
            reports[str(options.target / trim_deck.DECK)] = report.Report([f"  {'curves':<10} {len(options.curves)}"])
    return reports


def program_of(options: argparse.Namespace) -> Path | None:
    """Return the program, None if there is none."""
    found = shutil.which(options.program or places.program())
    return Path(found) if found else None


def beads_of(tools: tool_set.ToolSet, options: argparse.Namespace) -> beads.Beads:
    """Return the draw-beads that are proposed, with their restraint by the material."""
    if "holder" not in tools.surfaces or "pad" in tools.surfaces:
        return beads.Beads(reason="there is no holder around the part that carries them")
    drawn = None if options.beads == ESTIMATE else draw_in_of(options.beads)
    found = beads.proposed(tools.blank, options.thickness, drawn)
    if found.lines:
        program = program_of(options)
        if not program:
            raise Problem("--beads needs the program for the restraint; --program names it")
        stress = set_material.stress_of(program, options.material)
        found.force = beads.restraint(stress, options.thickness, set_deck.FRICTION)
        found.part = found.force / beads.largest(stress, options.thickness)
    return found


def set_pad_force(tools: tool_set.ToolSet, options: argparse.Namespace) -> None:
    """Set the force of the pad, which is not less than by its pressure, if there is the program."""
    program = program_of(options)
    if program:
        least = set_deck.PRESSURE * tools.area["pad"]
        tools.pad_force = max(least, pad_force.needed(tools, set_material.stress_of(program, options.material),
                                                      set_deck.PRESSURE * tools.area.get("holder", 0.0), options,
                                                      set_deck.FRICTION))


def draw_in_of(run: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return the points in plan of the rim of the sheet at the end of a run (n, 2), and their draw-in, mm."""
    sheet = Sheet(run)
    rim = np.concatenate(sheet.outline())
    return sheet.points(-1)[rim, :2], sheet.values(-1, "draw_in")[0][rim]


def check_deck(result: report.Report, options: argparse.Namespace) -> None:
    """Add what the program says of the input file of a set to its report: memory, elements, time, warnings, errors."""
    program = program_of(options)
    if not program and options.program:
        result.errors.append(f"{options.program}: no such program")
    elif not program:
        result.add("check", "not made, as there is no program dd3imp; --program names it")
    else:
        done = subprocess.run([program, "--check", options.target / DRAW], capture_output=True, text=True, check=False)
        for line in done.stdout.splitlines():
            kind, _, text = line.partition(": ")
            if kind in ("memory", "refinement", "time"):
                result.add(kind, text)
            elif kind.startswith("warning "):
                result.warnings.append(f"{DRAW}: {kind.split()[-1]}: {text}")
        if done.returncode:
            result.errors.append(f"{DRAW} is refused by the program: {done.stderr.strip()}")


def judge_set(tools: tool_set.ToolSet, options: argparse.Namespace) -> dict[str, report.Report]:
    """Return the reports on the tools of a part by the names of their files, and draw them."""
    reports = {}
    for name, surface in tools.surfaces.items():
        result, joints = report.judge(surface, options, 0)
        reports[str((options.target or Path()) / f"{name}.bez")] = result
        if options.picture:
            picture.draw(surface, joints, options.picture.with_stem(f"{options.picture.stem}_{name}"))
        if name in tools.distance:
            lines, errors = judge_distance(surface, tools.distance[name], options, "measured")
            result.errors += errors
            for line in lines + (tools.lines if name == "die" else []):
                result.add(*line)
    return reports


def write_set(tools: tool_set.ToolSet, options: argparse.Namespace, found: beads.Beads, command: str) -> None:
    """Write the tools of a part and the input file with draw-beads."""
    options.target.mkdir(parents=True, exist_ok=True)
    for name, surface in tools.surfaces.items():
        write(options.target / f"{name}.bez", surface, [f"{name} of {options.source.name}: {command}"])
    set_deck.write_blank(options.target, tools.blank, options.source.name)
    text = set_deck.deck(options, tools, found, command)
    (options.target / DRAW).write_text(text, encoding="utf-8")
    if options.curves:
        trim_deck.write(options, tools.height)


def main(words: Sequence[str] | None = None) -> None:
    """Convert the file of the command line, in a process of its own."""
    words = sys.argv[1:] if words is None else words
    supervised(lambda: run(lambda: convert(words)), "the file is damaged: a fault in the library that reads it")
