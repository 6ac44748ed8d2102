# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors, and the messages of the package; a command shows them as lines on stdout and stderr."""

import logging
import os
import re
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import metadata
from typing import TYPE_CHECKING, NamedTuple, NoReturn

if TYPE_CHECKING:
    from dd3.run import Run

# Optional packages, and the extra of the package dd3imp that installs each.
EXTRAS = {"gmsh": "cad", "ezdxf": "cad", "pyvista": "plot", "vtk": "plot", "snakemake": "study"}
IMPORTED = {"vtkmodules": "vtk"}  # modules with another name than their package
# Debian's packages with the shared libraries that Gmsh and VTK load.
DEBIAN = "libegl1 libgl1 libgl1-mesa-dri libglu1-mesa libgomp1 libxcursor1 libxft2 libxinerama1 libxrender1"


LOG = logging.getLogger("dd3")


class Console(logging.Handler):
    """Messages of a command: information on stdout, warnings and errors on stderr."""

    def emit(self, record: logging.LogRecord) -> None:
        """Print a message."""
        beyond = record.levelno >= logging.WARNING
        said = record.getMessage()
        if beyond and not re.search(": (?:error|warning) [EW]", said):  # of the program
            said = f"{record.levelname.lower()}: {said}"
        print(said, file=sys.stderr if beyond else sys.stdout, flush=True)


@contextmanager
def console() -> Iterator[None]:
    """Show the messages of the package as those of a command."""
    if LOG.handlers:
        yield
        return
    handler, level, propagate = Console(), LOG.level, LOG.propagate
    LOG.addHandler(handler)
    LOG.setLevel(logging.INFO)
    LOG.propagate = False
    try:
        yield
    finally:
        LOG.removeHandler(handler)
        LOG.setLevel(level)
        LOG.propagate = propagate


class Problem(Exception):
    """Input or results that cannot be used; its text is the message."""


class Message(NamedTuple):
    """A message of the program: file, line (0 without one), code such as E112, and the first line of its text."""

    file: str
    line: int
    code: str
    text: str


class InputError(Problem):
    """Errors in an input file, for which the program computes nothing. The text is that of the program, with all
    errors; `messages` has them one by one."""

    @property
    def messages(self) -> list[Message]:
        """All errors."""
        found = re.finditer(r"^(.*?):(?:(\d+):)? error (E\d+): (.*)$", str(self), re.MULTILINE)
        return [Message(one[1], int(one[2] or 0), one[3], one[4]) for one in found]


class Stopped(Problem):
    """A run that cannot go on before its end; its input has no errors. `run`: its results up to there."""

    def __init__(self, text: str, run: "Run | None" = None) -> None:
        super().__init__(text)
        self.run = run


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
                f"dd3_env/bin/pip install --upgrade {name}, and source dd3_env/bin/activate before dd3; on Debian "
                "venv is in the package python3-venv")
    return f"{name} is {state}: pip install --upgrade " + (f'"dd3imp[{EXTRAS[name]}]"' if name in EXTRAS else name)


def run(main: Callable[[], object]) -> None:
    """Call main; a Problem, a text given to sys.exit, a file error and a module that is not installed end the script by
    one line."""
    try:
        with console():
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
