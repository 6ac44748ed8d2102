# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the program, its examples and the library of its laws are: in a clone, or in what was installed.

An installed tree has them below its prefix; in a wheel the prefix is the package itself.
"""

import os
import sys
from pathlib import Path

from dd3.errors import Problem, run

PACKAGE = Path(__file__).resolve().parent
# Relative to the prefix, and to a clone.
PROGRAM = ("bin/dd3imp", "build/release/dd3imp")
EXAMPLES = ("share/dd3imp/input_files", "input_files")
LIBRARY = ("lib/libdd3laws.so", "lib/x86_64-linux-gnu/libdd3laws.so", "build/release/libdd3laws.so")
HEADER = ("include/dd3laws.h", "src/library/dd3laws.h")


def nearest(names: tuple[str, ...]) -> Path | None:
    """Return the first of these paths that exists, in the package or a folder above it, the nearest one."""
    places = (folder / name for folder in (PACKAGE, *PACKAGE.parents) for name in names)
    return next((place for place in places if place.exists()), None)


def program() -> str:
    """Return the program that belongs to this package, else its name, which is looked up on the path."""
    return str(nearest(PROGRAM) or "dd3imp")


def examples() -> Path:
    """Return the folder of the example input files."""
    found = nearest(EXAMPLES)
    if not found:
        raise Problem("the input files are not installed with this package")
    return found


def execute() -> None:
    """Become the program, with the arguments of the command line: the command `dd3imp` of a Python environment."""
    run(become_program)


def become_program() -> None:
    """Replace this process by the program."""
    found = nearest(PROGRAM)
    if not found or found.resolve() == Path(sys.argv[0]).resolve():  # this command itself
        raise Problem("the program dd3imp is not part of this package; build it (docs/manual.md, Installation)")
    os.execv(found, [str(found), *sys.argv[1:]])
