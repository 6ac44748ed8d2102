#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write punch.step, die.step and holder.step, the tools of the square cup as CAD solids, and part.step.

    step_files.py build/cup

Gmsh makes them of boxes with fillets, for the whole cup; dd3 tool converts them, see docs/tools.md. The part is a block
whose upper side is the middle of the cup of flanged.dat: 30 mm deep, its flange 14 mm wide; dd3 unfold takes it.
"""

from dd3.tools.solids import edges, gmsh, write

THICKNESS = 0.78  # of the blank, whose lower face is at z = 0, mm
FACE = 220.0  # side of the die and the holder
MIDDLE, DEPTH, WALL = THICKNESS / 2, 30.0, 36.2  # height of the flange's middle; depth and half width of the part


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


def part():
    """Make the cup with its flange."""
    body = block(102, MIDDLE - DEPTH - 2, DEPTH + 2)
    gmsh.model.occ.fillet([body], edges(lambda ends: ends[5] - ends[2] > DEPTH), [26])
    cavity = block(2 * WALL, MIDDLE - DEPTH, 2 * DEPTH)
    gmsh.model.occ.fillet([cavity], edges(lambda ends: ends[5] > DEPTH and ends[2] < 0), [WALL - 25])
    gmsh.model.occ.fillet([cavity], edges(lambda ends: abs(ends[5] - MIDDLE + DEPTH) < 0.01), [8 + THICKNESS / 2])
    gmsh.model.occ.cut([(3, body)], [(3, cavity)])
    gmsh.model.occ.fillet([body], edges(lambda ends: abs(ends[2] - MIDDLE) < 0.01 and max(map(abs, ends)) < WALL + 1),
                          [5 + THICKNESS / 2])


if __name__ == "__main__":
    write({"punch": punch, "die": die, "holder": lambda: plate(THICKNESS, 20), "part": part}, __doc__)
