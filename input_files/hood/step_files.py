#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write punch.step, die.step and holder.step, tools of a panel like a hood on a double-curved binder.

    step_files.py build/hood

Gmsh makes a quarter of them; dd3 tool converts them, see hood.dat.
"""
import numpy as np

from dd3.tools.solids import edges, gmsh, write

THICKNESS, GAP = 0.8, 1.0  # of the blank and between the walls of punch and die at the end, mm
SIZE = 280.0, 220.0  # half width of the faces along x and y, mm
OPENING = 200.0, 150.0  # half width of the opening of the die, mm
CORNER, EDGE = 60.0, 8.0  # radius of the opening in plan and of the edges of die and punch, mm
DEPTH, BELOW = 30.0, 80.0  # of the panel below the binder; of the solids, mm


def binder(x, y):
    """Return the height of the binder: a saddle that rises by 18 mm along x and falls by 12 mm along y."""
    return 18 * (x / SIZE[0])**2 - 12 * (y / SIZE[1])**2


def crown(x, y):
    """Return the height of the panel's face, crowned along both axes."""
    return -DEPTH - 10 * (1 - (x / SIZE[0])**2) - 8 * (1 - (y / SIZE[1])**2)


def sheet_of(height, shift=0.0):
    """Return a surface z = height(x, y) + shift over a quarter, which reaches beyond the planes of symmetry."""
    occ = gmsh.model.occ
    x, y = (np.linspace(-40, size + 20, 13) for size in SIZE)
    points = [occ.addPoint(a, b, height(a, b) + shift) for b in y for a in x]
    return occ.addBSplineSurface(points, len(x))


def column(half, corner, low, high):
    """Return an upright prism over a quarter of a rectangle with a rounded corner, beyond the planes of symmetry."""
    occ = gmsh.model.occ
    body = occ.addBox(-30, -30, low, half[0] + 30, half[1] + 30, high - low)
    if corner:
        occ.fillet([body], edges(lambda ends: ends[5] - ends[2] > high - low - 1 and ends[0] > half[0] - 1
                                 and ends[1] > half[1] - 1), [corner])
    return body


def part_of(body, surface, above):
    """Cut a body by a surface and keep what is above or below it."""
    occ, model = gmsh.model.occ, gmsh.model
    occ.fragment([(3, body)], [(2, surface)])
    occ.synchronize()
    order = sorted(model.getEntities(3), key=lambda part: occ.getCenterOfMass(*part)[2])
    kept = order[-1 if above else 0]
    occ.remove([part for part in order if part != kept], recursive=True)
    own = [abs(face) for _, face in model.getBoundary([kept], oriented=False)]
    occ.remove([(2, tag) for _, tag in occ.getEntities(2) if tag not in own], recursive=True)
    occ.synchronize()
    return kept[1]


def die():
    """Make the die: the binder with its opening."""
    body = part_of(column(SIZE, 0, -BELOW, 40), sheet_of(binder), above=False)
    opening = column(OPENING, CORNER, -BELOW - 1, 60)
    gmsh.model.occ.cut([(3, body)], [(3, opening)])
    top = edges(lambda ends: ends[2] > -30 and ends[3] < OPENING[0] + 1 and ends[4] < OPENING[1] + 1
                and max(ends[3], ends[4]) > 100)
    gmsh.model.occ.fillet([body], top, [EDGE])


def holder():
    """Make the holder: the binder on the other side of the sheet."""
    body = part_of(column(SIZE, 0, -20, 60), sheet_of(binder, THICKNESS), above=True)
    gmsh.model.occ.cut([(3, body)], [(3, column(OPENING, CORNER, -40, 80))])


def punch():
    """Make the punch at the end of its way, its face on the upper side of the sheet."""
    half = tuple(size - GAP for size in OPENING)
    body = part_of(column(half, CORNER - GAP, -BELOW, 40), sheet_of(crown, THICKNESS), above=True)
    lower = edges(lambda ends: ends[5] < 0 and ends[5] - ends[2] < 20
                  and (ends[0] > half[0] - CORNER or ends[1] > half[1] - CORNER))
    gmsh.model.occ.fillet([body], lower, [EDGE])


if __name__ == "__main__":
    write({"punch": punch, "die": die, "holder": holder}, __doc__)
