# SPDX-License-Identifier: GPL-3.0-or-later
"""Sessions of Gmsh."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from dd3.errors import Problem


@contextmanager
def session(path: Path | None = None) -> Iterator[Any]:
    """Give Gmsh, without its messages, with a file opened in it."""
    import gmsh
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        if path:
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
