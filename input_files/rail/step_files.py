#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write punch.step, die.step and holder.step, the tools of the S-shaped rail as CAD surfaces.

    step_files.py build/rail

Gmsh leads the profile along the centre line, two arcs between straight ends; dd3 tool converts the files, see
docs/tools.md. The shape files of this folder describe the same surfaces.
"""
import math

from dd3.tools.solids import along_s, write

THICKNESS = 0.8  # of the blank, whose lower face is at z = 0, mm
PUNCH, OPENING, FACE = 15.0, 16.0, 60.0  # half widths, mm
RADIUS, HEIGHT, END = 5.0, 60.0, 52.5  # of the profile; of the walls; length of the straight ends, mm
CURVE, ANGLE = 75.0, math.radians(30)  # radius and angle of the arcs of the centre line


def lead(corners):
    """Lead a profile from the middle to both ends of the centre line."""
    along_s(corners, RADIUS, CURVE, ANGLE, END)


def punch():
    """Make the punch."""
    lead([(-PUNCH, HEIGHT), (-PUNCH, THICKNESS), (PUNCH, THICKNESS), (PUNCH, HEIGHT)])


def die():
    """Make both sides of the die."""
    for side in (-1, 1):
        lead([(side * FACE, 0), (side * OPENING, 0), (side * OPENING, -HEIGHT)])


def holder():
    """Make both sides of the holder."""
    for side in (-1, 1):
        lead([(side * FACE, THICKNESS), (side * OPENING, THICKNESS)])


if __name__ == "__main__":
    write({"punch": punch, "die": die, "holder": holder}, __doc__)
