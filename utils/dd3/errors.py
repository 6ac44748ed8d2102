# SPDX-License-Identifier: GPL-3.0-or-later
"""End of a command: errors as one line on stderr."""

import os
import sys
from collections.abc import Callable
from importlib import metadata
from typing import NoReturn

# Optional packages, and the extra of the package dd3imp that installs each.
EXTRAS = {"gmsh": "cad", "ezdxf": "cad", "pyvista": "plot", "vtk": "plot", "snakemake": "study"}
IMPORTED = {"vtkmodules": "vtk"}  # modules with another name than their package
# Debian's packages with the shared libraries that Gmsh and VTK load.
DEBIAN = "libegl1 libgl1 libgl1-mesa-dri libglu1-mesa libxcursor1 libxft2 libxinerama1 libxrender1"


class Problem(Exception):
    """Input or results that cannot be used; its text is the message."""


def end(message: str) -> NoReturn:
    """Print one line and exit with code 2; messages in the program's format, file:line: error: ..., are not changed."""
    print(message if "error: " in message else f"error: {message}", file=sys.stderr)
    sys.exit(2)


def check(condition: object, message: str) -> None:
    """End the script with exit code 1 and a message unless a condition holds."""
    if not condition:
        sys.exit(message)


def missing(module: str) -> str:
    """Return the message for a module that is not installed, with the command that installs it; a module within a
    package is one of a later version."""
    package = module.partition(".")[0]
    name, state = IMPORTED.get(package, package), "too old" if sys.modules.get(package) else "missing"
    try:
        metadata.version("dd3imp")
    except metadata.PackageNotFoundError:  # not installed by pip
        if sys.prefix != sys.base_prefix:
            return f"{name} is {state}: pip install --upgrade {name}"
        return (f"{name} is {state}: python3 -m venv --system-site-packages dd3_env && "
                f"dd3_env/bin/pip install --upgrade {name}, and source dd3_env/bin/activate before dd3")
    return f"{name} is {state}: pip install --upgrade " + (f'"dd3imp[{EXTRAS[name]}]"' if name in EXTRAS else name)


def run(main: Callable[[], object]) -> None:
    """Call main; a Problem, a text given to sys.exit, a file error and a module that is not installed end the script by
    one line."""
    try:
        main()
        sys.stdout.flush()
    except BrokenPipeError:  # the reader, such as head, has closed the pipe
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except Problem as problem:
        end(str(problem))
    except ModuleNotFoundError as error:
        if not error.name or error.name.partition(".")[0] == "dd3":
            raise
        end(missing(error.name))
    except OSError as error:
        more = f"; on Debian or Ubuntu: apt-get install {DEBIAN}" if "cannot open shared object" in str(error) else ""
        end(f"{error.filename}: {error.strerror}" if error.filename else f"{error}{more}")
    except KeyboardInterrupt:
        sys.exit(130)
    except SystemExit as stop:
        if not isinstance(stop.code, str):
            raise
        end(stop.code)
