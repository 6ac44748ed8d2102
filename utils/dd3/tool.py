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
import sys
from collections.abc import Sequence
from pathlib import Path

from dd3.command import new_parser
from dd3.errors import run
from dd3.progress import doing
from dd3.tools import beads, picture, tool_set
from dd3.tools.limits import supervised
from dd3.tools.one_tool import made
from dd3.tools.report import Report
from dd3.tools.set_files import ESTIMATE, make_set, say
from dd3.tools.settings import DRAW, ToolSettings
from dd3.tools.surface import write


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
    whole.add_argument("--symmetric", action="store_true",
                       help="compute the half or the quarter x, y > 0 of a part with planes of symmetry there")
    whole.add_argument("--material", type=Path, metavar="FILE",
                       help="file with a *MATERIAL for the input file, or the name of one of the library, such as dc06 "
                            "(a mild steel)")
    return parser


@doing("making tools")
def make(settings: ToolSettings, note: str = "") -> dict[str, Report]:
    """Make one tool, or the tools of a part, and write them unless they have errors; return the reports on them by the
    names of the files. The note is written into the files."""
    if settings.whole:
        return make_set(settings, note)
    surface, joints, result = made(settings)
    if settings.picture:
        picture.draw(surface, joints, settings.picture)
    if settings.target and not result.errors:
        write(settings.target, surface, [f"{settings.source.name}: {note}"])
    return {str(settings.target or settings.source): result}


def convert(words: Sequence[str]) -> None:
    """Read, judge, write, report."""
    settings = ToolSettings(**vars(command_line().parse_args(words)))
    reports = make(settings, f"dd3 tool {shlex.join(words)}")
    for title, result in reports.items():
        say(title, settings.source, result)
    if any(result.errors for result in reports.values()):
        sys.exit(2)


def main(words: Sequence[str] | None = None) -> None:
    """Convert the file of the command line, in a process of its own."""
    words = sys.argv[1:] if words is None else words
    supervised(lambda: run(lambda: convert(words)), "the file is damaged: a fault in the library that reads it")
