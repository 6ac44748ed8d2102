# SPDX-License-Identifier: GPL-3.0-or-later
"""Sessions of Gmsh."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from dd3.errors import Problem

NASTRAN = ".bdf", ".nas"


def check_nastran(path: Path) -> None:
    """Raise a Problem at nodes of a Nastran file in a coordinate system of their own, which Gmsh does not read."""
    for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), 1):
        name, comma, _ = line.upper().partition(",")
        name = (name if comma else line[:8].upper()).strip()
        if name not in ("GRID", "GRID*", "GRDSET", "GRDSET*"):
            continue
        width = 16 if name.endswith("*") else 8
        word = line.split(",")[2:3] if comma else [line[8 + width:8 + 2 * width]]
        if word and word[0].strip() not in ("", "0"):
            raise Problem(f"{path}:{number}: error: {name.rstrip('*')} in the coordinate system {word[0].strip()}; "
                          "expected CP = 0: write the nodes in the basic system")


@contextmanager
def session(path: Path | None = None) -> Iterator[Any]:
    """Give Gmsh, without its messages, with a file opened in it."""
    import gmsh
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        if path:
            if path.suffix.lower() in NASTRAN:
                check_nastran(path)
            gmsh.open(str(path))
        yield gmsh
    except UnicodeDecodeError:  # of Gmsh's own message, which quotes the file
        raise Problem(f"{path}: Gmsh: the file is damaged") from None
    except Exception as error:
        if type(error) is Exception:  # Gmsh raises nothing more specific
            raise Problem(f"{path}: Gmsh: {error}" if path else f"Gmsh: {error}") from None
        raise
    finally:
        gmsh.finalize()
