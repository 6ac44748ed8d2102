#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write punch.step, die.step and holder.step, the tools of the square cup as CAD solids.

    step_files.py build/cup

Gmsh makes them of boxes with fillets, for the whole cup; dd3 tool converts them, see docs/tools.md.
"""

from dd3.tools.solids import edges, gmsh, write

THICKNESS = 0.78  # of the blank, whose lower face is at z = 0, mm
FACE = 220.0  # side of the die and the holder


def block(size, bottom, height):
    """Return a box around the z axis."""
    return gmsh.model.occ.addBox(-size / 2, -size / 2, bottom, size, size, height)


def plate(bottom, height):
    """Return a plate with the opening of the die."""
    whole, opening = block(FACE, bottom, height), block(74, bottom - 1, height + 2)
    gmsh.model.occ.fillet([opening], edges(lambda ends: ends[5] - ends[2] > height + 1), [12])
    gmsh.model.occ.cut([(3, whole)], [(3, opening)])
    return whole


def punch():
    """Make the punch."""
    body = block(70, THICKNESS, 90)
    gmsh.model.occ.fillet([body], edges(lambda ends: ends[5] - ends[2] > 80), [10])
    gmsh.model.occ.fillet([body], edges(lambda ends: ends[5] < THICKNESS + 0.01), [8])


def die():
    """Make the die."""
    body = plate(-60, 60)
    gmsh.model.occ.fillet([body], edges(lambda ends: ends[2] > -0.01 and max(ends[3], ends[4]) < 38), [5])


if __name__ == "__main__":
    write({"punch": punch, "die": die, "holder": lambda: plate(THICKNESS, 20)}, __doc__)
