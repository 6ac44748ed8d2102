#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write punch.step, die.step and holder.step, the tools of the cylindrical cup as CAD surfaces.

    step_files.py build/round_cup

Gmsh revolves the profiles by 120 degrees, a quarter that extends beyond the planes of symmetry; dd3 tool converts
the files, see docs/tools.md. The shape files of this folder describe the same surfaces.
"""
import math

from dd3.tools.solids import gmsh, wire, write

THICKNESS = 1.6  # of the blank, whose lower face is at z = 0, mm
PUNCH, OPENING, FACE, RADIUS = 48.73, 50.74, 100.0, 12.7  # radii of punch, opening, faces and profiles, mm
WALL = 90.0  # height, mm


def revolve(corners):
    """Revolve a profile from 15 degrees beyond the plane x = 0 to 15 degrees beyond y = 0."""
    profile = wire(corners, RADIUS)
    gmsh.model.occ.rotate(profile, 0, 0, 0, 0, 0, 1, math.radians(15))
    gmsh.model.occ.revolve(profile, 0, 0, 0, 0, 0, 1, -math.radians(120))
    gmsh.model.occ.remove(profile, recursive=True)


if __name__ == "__main__":
    write({"punch": lambda: revolve([(0, THICKNESS), (PUNCH, THICKNESS), (PUNCH, WALL)]),
           "die": lambda: revolve([(FACE, 0), (OPENING, 0), (OPENING, -WALL)]),
           "holder": lambda: revolve([(FACE, THICKNESS), (OPENING, THICKNESS)])}, __doc__)
