#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""CAD of a tray with the faults of the page on CAD that is to be mended: docs/mending.md.

    broken_parts.py FOLDER [NAME ...]
"""
import sys
from pathlib import Path

import gmsh
from part_set import PARTS

from dd3.gmsh_session import session
from dd3.programs import made_folder
from dd3.tools.cad_file import silence

occ = gmsh.model.occ


def faces_of_tray():
    """Make the tray of the set of parts without its solid; return the tags of its faces, and of those of the wall at
    the largest x."""
    PARTS["tray"].make()
    occ.synchronize()
    occ.remove(gmsh.model.getEntities(3))
    faces = [tag for _, tag in occ.getEntities(2)]
    ends = {tag: occ.getBoundingBox(2, tag) for tag in faces}
    wall = [tag for tag in faces if ends[tag][3] - ends[tag][0] < 1e-3 and ends[tag][0] > 38]
    return faces, wall


def moved(distance):
    """Make the tray with the outside of a wall moved by a distance, mm."""
    _, wall = faces_of_tray()
    copy = occ.copy([(2, max(wall, key=lambda tag: occ.getBoundingBox(2, tag)[0]))])
    occ.remove([(2, max(wall, key=lambda tag: occ.getBoundingBox(2, tag)[0]))])
    occ.translate(copy, distance, 0, 0)


def missing():
    """Make the tray without the outside of a wall."""
    _, wall = faces_of_tray()
    occ.remove([(2, max(wall, key=lambda tag: occ.getBoundingBox(2, tag)[0]))])


def doubled():
    """Make the tray with one of its faces twice."""
    _, wall = faces_of_tray()
    occ.copy([(2, wall[0])])


def inner():
    """Make the tray with a face across its wall inside the material, as a union that was not refined leaves it."""
    PARTS["tray"].make()
    body = occ.getEntities(3)
    cutter = [(3, occ.addBox(0, -100, -100, 100, 200, 200))]
    occ.fragment(body, cutter)
    occ.synchronize()
    for solid in occ.getEntities(3):
        if occ.getBoundingBox(*solid)[3] > 50:
            occ.remove([solid], recursive=True)


def merged():
    """Make the tray and a lid in one file."""
    PARTS["tray"].make()
    occ.addBox(-40, -30, 25, 80, 60, 1)


def metres():
    """Make the tray with coordinates in metres, in a file without units."""
    PARTS["tray"].make()
    occ.dilate(occ.getEntities(3), 0, 0, 0, 1e-3, 1e-3, 1e-3)


BROKEN = {"gap": lambda: moved(0.05), "wide_gap": lambda: moved(0.4), "missing": missing, "doubled": doubled,
          "inner": inner, "merged": merged, "metres": metres}


def write(folder, names=BROKEN):
    """Write the files into a folder; return their paths."""
    paths = {}
    with session(), silence():
        for name in names:
            BROKEN[name]()
            occ.synchronize()
            paths[name] = folder / f"{name}.{'brep' if name == 'metres' else 'step'}"
            gmsh.write(str(paths[name]))
            gmsh.clear()
    return paths


if __name__ == "__main__":
    write(made_folder(Path(sys.argv[1])), sys.argv[2:] or BROKEN)
