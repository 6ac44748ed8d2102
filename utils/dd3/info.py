# SPDX-License-Identifier: GPL-3.0-or-later
"""Print what is installed: versions, program, examples, library of the laws, and the Python packages that are used.

    dd3 info                 for a report of an error: program, examples, optional packages
"""

import platform
import subprocess
from collections.abc import Sequence
from importlib import metadata
from importlib.util import find_spec

from dd3 import __version__, places
from dd3.command import new_parser
from dd3.errors import EXTRAS

NEEDED = ("numpy", "pandas", "matplotlib", "scipy", "h5py", "tqdm")


def version_of(program: str) -> str:
    """Return the first line that a program prints of its version."""
    try:
        done = subprocess.run([program, "--version"], capture_output=True, text=True, timeout=60, check=True)
    except (OSError, subprocess.SubprocessError):
        return "it does not run"
    return done.stdout.partition("\n")[0]


def package(name: str) -> str:
    """Return the version of a Python package; that of a package of Debian may be unknown."""
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "installed" if find_spec(name) else ""


def main(words: Sequence[str] | None = None) -> None:
    """Print the table."""
    new_parser("info", __doc__).parse_args(words)
    program = places.program()
    rows = {"dd3": __version__, "Python": platform.python_version(), "program": f"{program}, {version_of(program)}",
            "examples": places.nearest(places.EXAMPLES), "laws": places.nearest(places.LIBRARY),
            "header": places.nearest(places.HEADER)}
    rows |= {name: package(name) for name in (*NEEDED, *EXTRAS)}
    for name, value in rows.items():
        print(f"{name:<10} {value or 'not installed'}")
