# SPDX-License-Identifier: GPL-3.0-or-later
"""Read a sheet part as a die engineer does, before tools are made.

    dd3 part part.step                                   table, and part_reading/ with a picture
    dd3 part part.step folder --toward 0 0 1             judge a press direction

Tells thickness, sides, press direction with draft angles and undercuts, floor, walls, shoulder, flange, holes, notches,
radii, symmetry and units. The folder gets part.txt, with a line for each face, and part.png, with the numbers of the
faces, also where the part cannot be drawn: exit code 2.
"""
import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from dd3.command import new_parser
from dd3.errors import Problem, run
from dd3.gmsh_session import session
from dd3.part import picture, table
from dd3.part.reading import Reading, Request, read_part
from dd3.progress import Progress, doing
from dd3.tools.cad import SUFFIXES
from dd3.tools.limits import supervised


def command_line() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = new_parser("part", __doc__)
    parser.add_argument("source", type=Path, help=f"CAD file: {' '.join(SUFFIXES)}")
    parser.add_argument("target", type=Path, nargs="?", help="folder of part.txt and part.png (<name>_reading)")
    parser.add_argument("--toward", type=float, nargs=3, metavar=("X", "Y", "Z"),
                        help="direction from the part to the punch that is to be judged (default: the best one)")
    parser.add_argument("--thickness", type=float, metavar="mm", help="thickness that the sheet should have")
    parser.add_argument("--part", action="append", metavar="NAME", help="name or number of a part to take")
    parser.add_argument("--faces", nargs="+", metavar="N", help="numbers of the faces to take, such as 3 5-8")
    parser.add_argument("--scale", type=float, default=1.0, help="factor on the coordinates, 25.4 for inches")
    parser.add_argument("--sew", type=float, metavar="mm", help="join free edges up to this far apart")
    return parser


def write_reading(reading: Reading, folder: Path) -> None:
    """Write the tables and the picture of a reading."""
    folder.mkdir(parents=True, exist_ok=True)
    lines = [str(reading.path), *table.summary(reading), *(f"error: {fault.text}" for fault in reading.faults),
             *(f"warning: {text}" for text in reading.warnings), "", *table.face_rows(reading)]
    edges = table.edge_rows(reading)
    (folder / "part.txt").write_text("\n".join([*lines, *(["", *edges] if edges else [])]) + "\n", encoding="utf-8")
    picture.draw(reading, folder / "part.png")


def say(reading: Reading, folder: Path) -> None:
    """Print the summary, warnings and errors."""
    written = f"  {'written':<10} {folder / 'part.txt'} {folder / 'part.png'}"
    print(reading.path, *table.summary(reading), written, sep="\n", flush=True)
    for text in reading.warnings:
        print(f"warning: {reading.path}: {text}", file=sys.stderr)
    for fault in reading.faults:
        print(f"error: {reading.path}: {fault.text}", file=sys.stderr)


@doing("reading the part")
def convert(words: Sequence[str]) -> None:
    """Read, write, report."""
    parser = command_line()
    options = parser.parse_args(words)
    if not options.source.is_file():
        raise Problem(f"{options.source}: no such file")
    if options.source.suffix.lower() not in SUFFIXES:
        raise Problem(f"{options.source}: unknown kind of file; expected one of {' '.join(SUFFIXES)}")
    if options.toward and not np.any(options.toward):
        parser.error("--toward takes a direction")
    for name in ("scale", "sew", "thickness"):
        if getattr(options, name) is not None and not 0 < getattr(options, name) < np.inf:
            parser.error(f"--{name} takes a positive number")
    folder = options.target or Path(f"{options.source.stem}_reading")
    progress = Progress(options.source.name)
    with session() as gmsh:
        reading = read_part(gmsh, Request(options.source, options.part, options.faces, options.toward,
                                          options.thickness, options.scale, options.sew), progress)
    progress.end()
    say(reading, folder)
    write_reading(reading, folder)
    if reading.faults:
        sys.exit(2)


def main(words: Sequence[str] | None = None) -> None:
    """Read the file of the command line, in a process of its own."""
    words = sys.argv[1:] if words is None else words
    supervised(lambda: run(lambda: convert(words)), "the file is damaged: a fault in the library that reads it")
