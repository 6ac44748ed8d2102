# SPDX-License-Identifier: GPL-3.0-or-later
"""Tools as CAD by Gmsh: profiles with fillets, and STEP files of parts."""
import argparse
import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import gmsh

from dd3.errors import run
from dd3.gmsh_session import session
from dd3.programs import made_folder
from dd3.tools.cad_file import silence


def edges(chosen: Callable[..., Any]) -> list[int]:
    """Return the edges whose box (x, y, z of its two corners) is chosen."""
    gmsh.model.occ.synchronize()
    return [tag for _, tag in gmsh.model.getEntities(1) if chosen(gmsh.model.getBoundingBox(1, tag))]


def wire(corners: list[tuple[float, float]], radius: float) -> list[tuple[int, int]]:
    """Return the curves of a profile: points (y, z) in the plane x = 0, the inner ones rounded."""
    occ = gmsh.model.occ
    lines = []
    for (y0, z0), (y1, z1) in pairwise(corners):
        lines.append(occ.addLine(occ.addPoint(0, y0, z0), occ.addPoint(0, y1, z1)))
    curves = lines[:1]
    for line in lines[1:]:
        arc = occ.fillet2D(curves[-1], line, radius)
        curves += [arc, line]
    return [(1, curve) for curve in curves]


def along_s(corners: list[tuple[float, float]], radius: float, curve: float, angle: float, end: float) -> None:
    """Make a profile, as of `wire`, led along an S: two arcs of a radius and an angle (radian) between straight ends of
    a length, from the middle outwards."""
    occ = gmsh.model.occ
    for side in (1, -1):
        profile = wire(corners, radius)
        occ.rotate(profile, 0, 0, 0, 0, 0, 1, angle)
        centre = side * curve * math.sin(angle), -side * curve * math.cos(angle)
        occ.revolve(profile, *centre, 0, 0, 0, 1, -angle)
        straight = occ.copy(profile)
        occ.rotate(straight, *centre, 0, 0, 0, 1, -angle)
        occ.extrude(straight, side * end, 0, 0)
        occ.remove(profile + straight, recursive=True)
    occ.removeAllDuplicates()


def write(parts: dict[str, Callable[[], None]], description: str | None) -> None:
    """Call the function of each part and write what it has made as <name>.step into the folder of the command line."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="folder of the files")
    run(lambda: write_into(made_folder(parser.parse_args().folder), parts))


def write_into(folder: Path, parts: dict[str, Callable[[], None]]) -> None:
    """Write the parts into a folder."""
    with session(), silence():
        for name, make in parts.items():
            make()
            gmsh.model.occ.synchronize()
            gmsh.write(str(folder / f"{name}.step"))
            gmsh.clear()
