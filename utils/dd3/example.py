# SPDX-License-Identifier: GPL-3.0-or-later
"""Copy an example, with the materials beside it, or list the examples.

    dd3 example                       list them, and the folder where they are
    dd3 example square_cup            to ./square_cup, with ./materials, which its input files include
    dd3 example bending --into work   to work/bending

Files that exist are not overwritten: the command ends with an error before it copies anything.
"""

import shutil
from collections.abc import Sequence
from pathlib import Path

from dd3 import places
from dd3.command import new_parser
from dd3.errors import Problem

MATERIALS = "materials"
INCLUDES = "../materials"  # in the input files that need them


def names(folder: Path) -> list[str]:
    """Return the names of the examples of a folder."""
    return sorted(item.name for item in folder.iterdir() if item.is_dir() and item.name != MATERIALS)


def copy(source: Path, target: Path) -> None:
    """Copy a folder without the results in it."""
    shutil.copytree(source, target, ignore=shutil.ignore_patterns("*.out", "__pycache__"))


def needs_materials(folder: Path) -> bool:
    """Tell whether an input file of an example includes a file of the materials."""
    return any(INCLUDES in path.read_text(encoding="utf-8") for path in folder.glob("*.dat"))


def main(words: Sequence[str] | None = None) -> None:
    """Copy the example of the command line."""
    parser = new_parser("example", __doc__)
    parser.add_argument("name", nargs="?", help="name of an example, or materials (default: list them)")
    parser.add_argument("--into", type=Path, default=Path(), metavar="FOLDER", help="where to (the working directory)")
    options = parser.parse_args(words)
    folder = places.examples()
    if not options.name:
        print(f"{folder}:", *names(folder), MATERIALS, sep="\n  ")
        return
    if options.name not in (*names(folder), MATERIALS):
        raise Problem(f"{options.name}: no such example; there are {', '.join(names(folder))}, and {MATERIALS}")
    target, materials = options.into / options.name, options.into / MATERIALS
    if target.exists():
        raise Problem(f"{target}: it exists already")
    copy(folder / options.name, target)
    print(target)
    if needs_materials(target) and not materials.exists():
        copy(folder / MATERIALS, materials)
        print(materials)
