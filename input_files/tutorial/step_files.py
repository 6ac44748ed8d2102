#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write punch.step, die.step and holder.step, the tools of the tutorial's tray as CAD solids.

    step_files.py build/tray
    step_files.py build/tray_20 --corner 20

--corner is the radius of the tray's corners in plan, mm. Gmsh makes the solids of boxes with fillets.
"""
import sys

from dd3.tools.solids import edges, gmsh, write

THICKNESS = 0.8  # of the blank, whose lower face is at z = 0, mm
LENGTH, WIDTH = 100.0, 60.0  # of the punch, mm
CLEARANCE = 1.0  # between punch and die, mm
CORNER = float(sys.argv.pop(sys.argv.index("--corner") + 1)) if "--corner" in sys.argv else 8.0


def block(length, width, bottom, height, corner=0.0):
    """Return a box around the z axis with rounded corners."""
    box = gmsh.model.occ.addBox(-length / 2, -width / 2, bottom, length, width, height)
    if corner:
        gmsh.model.occ.fillet([box], edges(lambda ends: ends[5] - ends[2] > height - 1), [corner])
    return box


def plate(bottom, height):
    """Return a plate with the opening of the die."""
    opening = block(LENGTH + 2 * CLEARANCE, WIDTH + 2 * CLEARANCE, bottom - 1, height + 2, CORNER + CLEARANCE)
    whole = block(240, 200, bottom, height)
    gmsh.model.occ.cut([(3, whole)], [(3, opening)])
    return whole


def punch():
    """Make the punch."""
    body = block(LENGTH, WIDTH, THICKNESS, 60, CORNER)
    gmsh.model.occ.fillet([body], edges(lambda ends: ends[5] < THICKNESS + 0.01), [6])


def die():
    """Make the die."""
    body = plate(-50, 50)
    gmsh.model.occ.fillet([body], edges(lambda ends: ends[2] > -0.01 and max(ends[3], ends[4]) < LENGTH / 2 + 2), [5])


if __name__ == "__main__":
    if "--corner" in sys.argv:
        sys.argv.remove("--corner")
    write({"punch": punch, "die": die, "holder": lambda: plate(THICKNESS, 15)}, __doc__)
