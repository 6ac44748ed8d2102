#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write rail.step, cup.step and panel.step, parts without flange and shoulder.

    step_files.py build/parts

The rail is the surface that the punch touches, the cup a sheet, the panel a block under which the sheet is drawn; dd3
tool makes punch, die and holder of them, see docs/tools.md.
"""
import math

import numpy as np

from dd3.tools.solids import along_s, edges, gmsh, write

CURVE, ANGLE, END = 75.0, math.radians(30), 52.5  # radius and angle of the rail's arcs; its straight ends, mm
RADIUS, HEIGHT, THICKNESS = 30.0, 25.0, 1.0  # of the cup, inside, mm


def rail():
    """Make a hat section along an S."""
    along_s([(-15, 20), (-15, 0), (15, 0), (15, 20)], 5, CURVE, ANGLE, END)


def pot(radius, bottom, fillet):
    """Return a cylinder with a rounded bottom."""
    body = gmsh.model.occ.addCylinder(0, 0, bottom, 0, 0, HEIGHT, radius)
    gmsh.model.occ.fillet([body], edges(lambda ends: ends[5] < bottom + 1e-3), [fillet])
    return body


def cup():
    """Make a round cup."""
    outer, inner = pot(RADIUS + THICKNESS, 0, 7), pot(RADIUS, THICKNESS, 6)
    gmsh.model.occ.cut([(3, outer)], [(3, inner)])


def panel():
    """Make a panel like a hood: a crowned face with two beads, within rounded walls of 16 to 24 mm."""
    occ, model = gmsh.model.occ, gmsh.model
    x, y = np.linspace(-170, 170, 7), np.linspace(-120, 120, 7)
    points = [occ.addPoint(a, b, 6 * (a / 150)**2 + 4 * (b / 100)**2 - 20 - 2 * a / 150) for b in y for a in x]
    crown = occ.addBSplineSurface(points, 7)
    block = occ.addBox(-130, -85, -60, 260, 170, 60)
    occ.fillet([block], edges(lambda ends: ends[5] - ends[2] > 50 and np.ptp([ends[0], ends[3]]) < 1e-3
                              and np.ptp([ends[1], ends[4]]) < 1e-3), [30])
    occ.fragment([(3, block)], [(2, crown)])
    occ.synchronize()
    body = max(model.getEntities(3), key=lambda part: occ.getCenterOfMass(*part)[2])
    occ.remove([part for part in model.getEntities(3) if part != body], recursive=True)
    own = [face for _, face in model.getBoundary([body], oriented=False)]
    occ.remove([(2, tag) for _, tag in occ.getEntities(2) if tag not in own], recursive=True)
    for middle in (-35, 35):
        bead = occ.addCylinder(-70, middle, -26, 140, 0, 0, 12)
        ends = [(3, occ.addSphere(end, middle, -26, 12)) for end in (-70, 70)]
        body = occ.cut([body], occ.fuse([(3, bead)], ends)[0])[0][0]
    occ.fillet([body[1]], edges(lambda ends: ends[5] < -1), [6])


if __name__ == "__main__":
    write({"rail": rail, "cup": cup, "panel": panel}, __doc__)
