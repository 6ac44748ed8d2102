#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A set of sheet parts, each with what a die engineer says of it, made here by Gmsh and OpenCASCADE and written as STEP
or BREP."""
import argparse
import math
import re
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import gmsh
import numpy as np

from dd3 import pages
from dd3.gmsh_session import session
from dd3.part.reading import Request, read_part
from dd3.programs import made_folder
from dd3.tools.cad_file import silence
from dd3.tools.solids import along_s, edges

occ = gmsh.model.occ
INCH = 25.4


@dataclass
class Expected:
    """What is to be read of a part: `sheet`, `surface`, `block`, `flat`; thickness, mm; a direction from which it can
    be drawn, in one stroke, or None; whether it is formed by bending alone; inner loops and notches; symmetry planes;
    least radius inside the bends, mm, None where there is none; unit of the file."""

    make: Callable[[], None]
    kind: str = "sheet"
    thickness: float | None = 1.0
    toward: tuple[float, float, float] | None = (0, 0, 1)
    bent: bool = False
    holes: int = 0
    notches: int = 0
    symmetry: int = 0
    radius: float | None = None
    unit: str = "mm"
    ending: str = "step"


def outline(path, thickness, radius):
    """Return the vertices of a strip of sheet and the radii of its corners: its path on one side, then back on the
    other at the thickness to the left; `radius` is that inside the bends."""
    path = np.array(path, float)
    along = np.diff(path, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    left = np.stack([-along[:, 1], along[:, 0]], axis=1)
    other, radii, other_radii = [path[0] + thickness * left[0]], [0.0], [0.0]
    for before, after, corner, here, there in zip(left, left[1:], path[1:-1], along, along[1:]):
        other.append(corner + thickness * (before + after) / (1 + before @ after))
        turns_left = here[0] * there[1] - here[1] * there[0] > 0
        outer = radius + thickness if radius else 0.0
        radii.append(outer if turns_left else radius)
        other_radii.append(radius if turns_left else outer)
    other.append(path[-1] + thickness * left[-1])
    return np.concatenate([path, other[::-1]]), [*radii, 0.0, 0.0, *other_radii[:0:-1], 0.0][:2 * len(path)]


def polygon(corners, radii, place):
    """Return the plane face of a polygon with rounded corners; `place` gives a point in space."""
    count = len(corners)
    starts, ends, centres = [], [], []
    for i, (corner, radius) in enumerate(zip(corners, radii)):
        a, b = corners[i - 1] - corner, corners[(i + 1) % count] - corner
        a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
        half = math.acos(np.clip(a @ b, -1, 1)) / 2
        length = radius / math.tan(half) if radius else 0.0
        starts.append(corner + length * a)
        ends.append(corner + length * b)
        centres.append(corner + radius / math.sin(half) * (a + b) / np.linalg.norm(a + b) if radius else None)
    first = [occ.addPoint(*place(*p)) for p in starts]
    last = [p if centre is None else occ.addPoint(*place(*q)) for p, q, centre in zip(first, ends, centres)]
    curves = []
    for i in range(count):
        if centres[i] is not None:
            curves.append(occ.addCircleArc(first[i], occ.addPoint(*place(*centres[i])), last[i]))
        following = (i + 1) % count
        if np.linalg.norm(ends[i] - starts[following]) > 1e-9:
            curves.append(occ.addLine(last[i], first[following]))
    return occ.addPlaneSurface([occ.addCurveLoop(curves)])


def strip(path, thickness, radius, length):
    """Return the solid of a profile (y, z) of sheet, extruded along x."""
    face = polygon(*outline(path, thickness, radius), lambda y, z: (-length / 2, y, z))
    return [entity for entity in occ.extrude([(2, face)], length, 0, 0) if entity[0] == 3]


def turned_solid(path, thickness, radius):
    """Return the solid of a profile (r, z) of sheet, revolved about z."""
    face = polygon(*outline(path, thickness, radius), lambda r, z: (r, 0, z))
    body = [entity for entity in occ.revolve([(2, face)], 0, 0, 0, 0, 0, 1, 2 * math.pi) if entity[0] == 3]
    occ.remove([(2, face)], recursive=True)
    return body


def holes(body, places, axis=(0, 0, 1), radius=3.0, length=100.0):
    """Return a body with round holes through points along an axis."""
    half = length / 2 * np.array(axis)
    tools = [(3, occ.addCylinder(*(np.array(p) - half), *(2 * half), radius)) for p in places]
    return occ.cut(body, tools)[0]


def block(corner, size, plan, low):
    """Return a block whose vertical edges are rounded by `plan` and its lower ones by `low`."""
    body = occ.addBox(*corner, *size)
    if plan:
        body = occ.fillet([body], edges(lambda b: b[5] - b[2] > size[2] / 2 and max(b[3] - b[0], b[4] - b[1]) < 1e-3),
                          [plan])[0][1]
    if low:
        body = occ.fillet([body], edges(lambda b: b[5] < corner[2] + 1e-3), [low])[0][1]
    return body


def pocket(half, depth, thickness, plan, low):
    """Return an open box of sheet, `half` sizes outside, its floor at z = 0."""
    a, b = half
    outer = block((-a, -b, 0), (2 * a, 2 * b, depth), plan, low)
    inner = block((thickness - a, thickness - b, thickness), (2 * (a - thickness), 2 * (b - thickness), depth),
                  max(plan - thickness, 0), max(low - thickness, 0))
    return occ.cut([(3, outer)], [(3, inner)])[0]


def angle():
    """Make an angle with two holes in each leg."""
    body = strip([(0, 30), (0, 0), (40, 0)], 2, 3, 60)
    body = holes(body, [(-15, 25, 0), (15, 25, 0)])
    holes(body, [(-15, 0, 18), (15, 0, 18)], (0, 1, 0), length=20)


def z_section():
    """Make a Z section."""
    strip([(-25, 20), (0, 20), (0, 0), (25, 0)], 1.5, 2, 80)


def u_section():
    """Make a U with a notch in each flange."""
    body = strip([(-20, 25), (-20, 0), (20, 0), (20, 25)], 1, 2, 100)
    occ.cut(body, [(3, occ.addBox(-6, -30, 14, 12, 60, 20))])


def hat():
    """Make a hat section of 1.2 mm, open upwards, with walls at 10 degrees."""
    strip([(-45, 25), (-25 - 25 * math.tan(math.radians(10)), 25), (-25, 0), (25, 0),
           (25 + 25 * math.tan(math.radians(10)), 25), (45, 25)], 1.2, 3, 120)


def sharp_hat():
    """Make a hat section with sharp edges, open downwards."""
    strip([(-45, -1), (-25, -1), (-20, 19), (20, 19), (25, -1), (45, -1)], 1, 0, 120)


def s_rail():
    """Make the surface of a hat section along an S."""
    along_s([(-15, 20), (-15, 0), (15, 0), (15, 20)], 5, 75.0, math.radians(30), 52.5)


def stepped_hat():
    """Make a hat section whose flanges are at two heights."""
    strip([(-50, 25), (-30, 25), (-25, 0), (25, 0), (28, 15), (50, 15)], 1, 3, 80)


def arched_rail():
    """Make a hat section along an arch of 300 mm, a sheet of 1 mm."""
    corners, radii = outline([(-35, 20), (-22, 20), (-18, 0), (18, 0), (22, 20), (35, 20)], 1, 3)
    face = polygon(corners, radii, lambda y, z: (0, y, 300 + z))
    occ.rotate([(2, face)], 0, 0, 0, 0, 1, 0, -0.25)
    occ.revolve([(2, face)], 0, 0, 0, 0, 1, 0, 0.5)


def s_flange():
    """Make the surface of a web with a flange along an S: one arc stretches, the other shrinks."""
    radius, turn = 60.0, math.radians(50)

    def profile(place):
        a, b, c, d, e = [occ.addPoint(*place(*p)) for p in ((35, 0), (5, 0), (5, 5), (0, 5), (0, 20))]
        return [(1, occ.addLine(a, b)), (1, occ.addCircleArc(b, c, d)), (1, occ.addLine(d, e))]

    sine, cosine = math.sin(turn), math.cos(turn)
    one = (radius * sine, radius - radius * cosine)
    parts = [occ.extrude(profile(lambda s, z: (-30, s, z)), 30, 0, 0),
             occ.revolve(profile(lambda s, z: (0, s, z)), 0, radius, 0, 0, 0, 1, turn),
             occ.revolve(profile(lambda s, z: (one[0] - s * sine, one[1] + s * cosine, z)),
                         one[0] + radius * sine, one[1] - radius * cosine, 0, 0, 0, 1, -turn),
             occ.extrude(profile(lambda s, z: (2 * one[0], 2 * one[1] + s, z)), 30, 0, 0)]
    occ.fragment([entity for part in parts for entity in part if entity[0] == 2], [])
    occ.removeAllDuplicates()


def tray():
    """Make a tray of 80 x 60 x 20 without flange."""
    pocket((40, 30), 20, 1, 8, 5)


def sharp_tray():
    """Make a tray with a sharp lower edge."""
    pocket((40, 30), 20, 1, 8, 0)


def wall_hole_tray():
    """Make a tray with a hole in a wall."""
    holes(pocket((40, 30), 20, 1, 8, 5), [(40, 0, 12)], (1, 0, 0), length=20)


def flanged_tray(island=False):
    """Make a tray with a flange of its own, open upwards, and an island in its floor on request."""
    cavity = block((-40, -30, -20), (80, 60, 20), 8, 5)
    plate = block((-54, -44, -1), (108, 88, 1), 12, 0)
    outer = block((-41, -31, -21), (82, 62, 21), 9, 6)
    body = occ.cut([occ.fuse([(3, plate)], [(3, outer)])[0][0]], [(3, cavity)])[0][0][1]
    for height, half, radius in ((0, 41, 4), (-1, 42, 3)):
        ring = edges(lambda b, height=height, half=half:
                     max(abs(b[2] - height), abs(b[5] - height)) < 1e-3 and max(abs(b[0]), abs(b[3])) < half
                     and max(abs(b[1]), abs(b[4])) < half - 10)
        body = occ.fillet([body], ring, [radius])[0][1]
    if island:
        inside = math.hypot(1, 1 / 3)  # of the wall, horizontally
        shape = [(3, occ.addCone(0, 0, -30, 0, 0, 18, 18, 12))]
        below = [(3, occ.addCone(0, 0, -31, 0, 0, 18, 18 + 1 / 3 - inside, 12 + 1 / 3 - inside))]
        solid = occ.fuse([(3, body)], shape)[0]
        occ.cut(solid, [*below, (3, occ.addBox(-90, -90, -60, 180, 180, 39))])


def own_flange():
    """Make a tray with a flange of its own."""
    flanged_tray()


def island_tray():
    """Make a tray with a flange and an island with sharp edges in its floor."""
    flanged_tray(island=True)


def pan():
    """Make a round pan with a flange."""
    turned_solid([(0, 0), (40, 0), (43, 25), (60, 25)], 1, 4)


def cup_with_holes():
    """Make a round cup with a hole in its floor and four in its wall."""
    body = turned_solid([(0, 0), (30, 0), (30, 30)], 1, 5)
    body = holes(body, [(0, 0, 0)], radius=6, length=10)
    for axis in ((1, 0, 0), (0, 1, 0)):
        body = holes(body, [(0, 0, 18)], axis, radius=2.5, length=100)


def notched(body, *degrees, low=5.0, inside=25.0):
    """Return a turned body with notches of 8 mm at angles, above `low` and outside of a radius; 0 is the seam of its
    faces."""
    tools = [(3, occ.addBox(inside, -4, low, 40, 8, 20)) for _ in degrees]
    for tool, angle in zip(tools, degrees):
        occ.rotate([tool], 0, 0, 0, 0, 0, 1, math.radians(angle))
    return occ.cut(body, tools)[0]


def notched_lid():
    """Make a round lid of 0.6 mm with two notches in its wall, one of them on the seam of its faces."""
    notched(turned_solid([(0, 0), (30, 0), (30, 8)], 0.6, 1.5), 0, 120)


def notched_flange():
    """Make a round lid of 0.6 mm with a notch in its level flange, on the seam of its faces."""
    notched(turned_solid([(0, 0), (30, 0), (32, 8), (45, 8)], 0.6, 1.5), 0, inside=40)


def folded_cover(notch=True, radius=3):
    """Make a cover with walls on four sides, folded, open at its corners, and a notch in the rim of a wall."""
    body = pocket((40, 30), 15, 1, 0, radius)
    corners = [(3, occ.addBox(x, y, -1, 6, 6, 20)) for x in (-41, 35) for y in (-31, 25)]
    occ.cut(body, [*corners, *([(3, occ.addBox(-5, 25, 9, 10, 10, 10))] if notch else [])])


def relieved_angle():
    """Make an angle whose web goes on beside the bend, behind a relief."""
    body = strip([(0, 30), (0, 0), (40, 0)], 2, 3, 60)
    body = occ.cut(body, [(3, occ.addBox(10, -10, -1, 30, 16, 40))])[0]
    occ.fuse(body, [(3, occ.addBox(14, -15, 0, 16, 25, 2))])


def slotted_cover():
    """Make a shallow cover with 165 slots."""
    body = pocket((110, 80), 12, 0.8, 10, 4)
    slots = []
    for i in range(15):
        for k in range(11):
            slots.append((3, occ.addBox(-94 + 13 * i, -63 + 12 * k, -5, 6, 6, 10)))
    occ.cut(body, slots)


def flanged_cover():
    """Make a cover with a flange of its own, a window in its floor and four holes in its flange."""
    outer, inner = block((-45, -30, 0), (90, 60, 14), 12, 4.8), block((-44.2, -29.2, 0.8), (88.4, 58.4, 20), 11.2, 4)
    body = occ.cut(occ.fuse([(3, outer)], [(3, occ.addBox(-57, -42, 13.2, 114, 84, 0.8))])[0], [(3, inner)])[0]
    occ.synchronize()
    for level, radius in ((14.0, 3.8), (13.2, 3.0)):
        inside = edges(lambda b, level=level: abs(b[2] - level) < 1e-3 and abs(b[5] - level) < 1e-3
                       and max(-b[0], b[3]) < 46 and max(-b[1], b[4]) < 31)
        body = occ.fillet([body[0][1]], inside, [radius])
    body = holes(body, [(x, y, 13) for x in (-51, 51) for y in (-36, 36)], radius=2.5)
    occ.cut(body, [(3, occ.addBox(-15, -8, -5, 30, 16, 10))])


def louvred_cover():
    """Make a cover with three louvres: cut along a line and formed upwards on one side of it."""
    body = pocket((60, 45), 15, 1, 8, 4)
    for x in (-30, 0, 30):
        outer = [(3, occ.addCylinder(x, -18, 0, 0, 36, 0, 7)), (3, occ.addSphere(x, -18, 0, 7)),
                 (3, occ.addSphere(x, 18, 0, 7))]
        inner = [(3, occ.addCylinder(x, -18, 0, 0, 36, 0, 6)), (3, occ.addSphere(x, -18, 0, 6)),
                 (3, occ.addSphere(x, 18, 0, 6))]
        outer = occ.intersect(occ.fuse(outer[:1], outer[1:])[0], [(3, occ.addBox(x, -40, 0, 20, 80, 20))])[0]
        inner = occ.intersect(occ.fuse(inner[:1], inner[1:])[0], [(3, occ.addBox(x - 1, -40, -1, 21, 80, 21))])[0]
        inner = occ.intersect(inner, [(3, occ.addBox(x, -40, -1, 20, 80, 21))])[0]
        body = occ.cut(occ.fuse(body, outer)[0], inner)[0]


def saddle_panel(notch=True):
    """Make the surface of a panel on a saddle, with a pocket in its middle and a notch at its rim."""
    x, y = np.linspace(-100, 100, 21), np.linspace(-70, 70, 17)

    def height(a, b):
        inside = 1 / (1 + np.exp((np.hypot(a / 1.4, b) - 38) / 3))
        return 8 * (a / 100)**2 - 6 * (b / 70)**2 - 10 * inside

    points = [occ.addPoint(a, b, height(a, b)) for b in y for a in x]
    face = occ.addBSplineSurface(points, 21)
    if notch:
        occ.cut([(2, face)], [(3, occ.addBox(-10, 55, -60, 20, 40, 120))])


def crowned_block():
    """Make a block with a crowned face, under which a sheet is drawn."""
    x = np.linspace(-90, 90, 7)
    points = [occ.addPoint(a, b, 6 * (a / 60)**2 + 4 * (b / 60)**2 - 20) for b in x for a in x]
    crown = occ.addBSplineSurface(points, 7)
    body = occ.addBox(-60, -45, -60, 120, 90, 60)
    occ.fragment([(3, body)], [(2, crown)])
    occ.synchronize()
    keep = max(gmsh.model.getEntities(3), key=lambda part: occ.getCenterOfMass(*part)[2])
    occ.remove([part for part in gmsh.model.getEntities(3) if part != keep], recursive=True)
    own = [face for _, face in gmsh.model.getBoundary([keep], oriented=False)]
    occ.remove([(2, tag) for _, tag in occ.getEntities(2) if tag not in own], recursive=True)
    occ.fillet([keep[1]], edges(lambda b: b[5] < -5), [6])


def closed_shell():
    """Make the faces of the tray as a closed shell without volume."""
    tray()
    occ.synchronize()
    occ.remove(gmsh.model.getEntities(3))


def thick_angle():
    """Make an angle of 6 mm with a small radius, 0.236 inches."""
    strip([(0, 80), (0, 0), (100, 0)], 6.35, 3.175, 120)


def inch_tray():
    """Make a tray of 3.2 x 2.4 x 0.8 inches, in mm."""
    pocket((1.6 * INCH, 1.2 * INCH), 0.8 * INCH, 0.036 * INCH, 0.32 * INCH, 0.2 * INCH)


def unitless_inch_tray():
    """Make the same tray with coordinates in inches, in a file without units."""
    inch_tray()
    occ.synchronize()
    occ.dilate(gmsh.model.getEntities(3), 0, 0, 0, *[1 / INCH] * 3)


def lipped_channel():
    """Make a C with lips, which are bent inwards."""
    strip([(-12, 24), (-20, 24), (-20, 0), (20, 0), (20, 24), (12, 24)], 1, 2, 100)


def bottle():
    """Make a bottle, narrower at its neck than at its floor."""
    turned_solid([(0, 0), (30, 0), (30, 30), (15, 45), (15, 60)], 1, 4)


def hemmed_pan():
    """Make a round pan whose flange is turned over at its rim."""
    turned_solid([(0, 0), (35, 0), (38, 20), (55, 20), (55, 14), (49, 14)], 1, 2)


def tilted_tray():
    """Make a tray that lies obliquely in its file."""
    body = pocket((40, 30), 20, 1, 8, 5)
    occ.rotate(body, 0, 0, 0, 1, 0.4, 0.2, math.radians(35))


def tilt():
    """Return the axis of the tilted tray."""
    from scipy.spatial.transform import Rotation
    axis = np.array([1, 0.4, 0.2])
    turn = Rotation.from_rotvec(math.radians(35) * axis / np.linalg.norm(axis))
    return tuple(turn.apply([0, 0, 1]))


def leaning_tray():
    """Make a channel one of whose walls leans inwards by 6 degrees, the other outwards by 15."""
    inward, outward = (20 * math.tan(math.radians(a)) for a in (6, 15))
    strip([(-30 + inward, 20), (-30, 0), (30, 0), (30 + outward, 20)], 1, 4, 90)


def tube():
    """Make a tube."""
    occ.cut([(3, occ.addCylinder(0, 0, 0, 100, 0, 0, 20))], [(3, occ.addCylinder(0, 0, 0, 100, 0, 0, 18))])


def two_angles():
    """Make an assembly of two angles."""
    strip([(0, 30), (0, 0), (40, 0)], 2, 3, 60)
    occ.translate(strip([(0, 30), (0, 0), (40, 0)], 1, 3, 60), 0, 80, 0)


def milled():
    """Make a block with a pocket: no sheet."""
    occ.cut([(3, occ.addBox(-40, -30, 0, 80, 60, 30))], [(3, block((-25, -18, 10), (50, 36, 30), 6, 4))])


def plate():
    """Make a flat plate with a hole: nothing to form."""
    holes([(3, occ.addBox(-40, -30, 0, 80, 60, 2))], [(0, 0, 0)], radius=8)


def stepped_pan():
    """Make a round pan of two depths without flange, of 0.5 mm, with a hole in its upper floor."""
    holes(turned_solid([(0, 0), (20, 0), (22, 12), (40, 12), (43, 30)], 0.5, 3), [(31, 0, 12)], radius=2, length=10)


def rim_tray(height):
    """Make a tray whose walls lean by 6 in 40 and whose rim is at a height over x and y."""
    def cone(inset, low):
        rings = [(6 * z / 40 - inset, z) for z in (low, 40)]
        return [(3, occ.addThruSections([rounded_rectangle(50 + d, 35 + d, 12 + d, z) for d, z in rings])[0][1])]

    outer, inner = cone(0, 0), cone(math.hypot(1, 6 / 40), 1)
    for body, radius in ((outer, 6), (inner, 5)):
        low = 0 if body is outer else 1
        body[0] = occ.fillet([body[0][1]], edges(lambda b, low=low: b[5] < low + 1e-3), [radius])[0]
    body = occ.cut(outer, inner)[0]
    x, y = np.linspace(-70, 70, 15), np.linspace(-70, 70, 15)
    points = [occ.addPoint(a, b, height(a, b)) for b in y for a in x]
    lid = occ.addBSplineSurface(points, 15)
    above = [entity for entity in occ.extrude([(2, lid)], 0, 0, 60) if entity[0] == 3]
    occ.cut(body, above)
    occ.remove([(2, lid)], recursive=True)


def rounded_rectangle(a, b, radius, z):
    """Return the wire of a rectangle with rounded corners."""
    face = occ.addRectangle(-a, -b, z, 2 * a, 2 * b, roundedRadius=radius)
    wire = occ.addWire([edge for _, edge in occ.getEntities(1) if edge in occ.getCurveLoops(face)[1][0]])
    occ.remove([(2, face)])
    return wire


def s_rim_tray():
    """Make a tray without flange whose rim is an S in height along x."""
    rim_tray(lambda x, y: 26 + 7 * math.sin(x / 35))


def saddle_tray():
    """Make a tray without flange whose rim is on a saddle."""
    rim_tray(lambda x, y: 26 + 6 * (x / 50)**2 - 6 * (y / 40)**2)


PARTS = {
    "angle": Expected(angle, thickness=2.0, bent=True, holes=4, symmetry=1, radius=3.0, toward=(0, 1, 1)),
    "z_section": Expected(z_section, thickness=1.5, bent=True, symmetry=1, radius=2.0, toward=(0, 1, 1)),
    "u_section": Expected(u_section, bent=True, notches=2, symmetry=2, radius=2.0),
    "hat": Expected(hat, thickness=1.2, bent=True, symmetry=2, radius=3.0),
    "sharp_hat": Expected(sharp_hat, bent=True, symmetry=2, radius=0.0, toward=(0, 0, -1)),
    "stepped_hat": Expected(stepped_hat, bent=True, symmetry=1, radius=3.0),
    "s_rail": Expected(s_rail, kind="surface", thickness=None, radius=5.0),
    "arched_rail": Expected(arched_rail, symmetry=2, radius=3.0),
    "s_flange": Expected(s_flange, kind="surface", thickness=None, radius=5.0),
    "tray": Expected(tray, symmetry=2, radius=4.0),
    "sharp_tray": Expected(sharp_tray, symmetry=2, radius=0.0),
    "wall_hole_tray": Expected(wall_hole_tray, holes=1, symmetry=1, radius=4.0),
    "own_flange": Expected(own_flange, symmetry=2, radius=3.0),
    "island_tray": Expected(island_tray, symmetry=2, radius=0.0),
    "pan": Expected(pan, symmetry=2, radius=4.0),
    "stepped_pan": Expected(stepped_pan, thickness=0.5, holes=1, symmetry=1, radius=3.0),
    "cup_with_holes": Expected(cup_with_holes, holes=5, symmetry=2, radius=5.0),
    "s_rim_tray": Expected(s_rim_tray, symmetry=1, radius=5.0),
    "saddle_tray": Expected(saddle_tray, symmetry=2, radius=5.0),
    "notched_lid": Expected(notched_lid, thickness=0.6, notches=2, symmetry=1, radius=1.5),
    "notched_flange": Expected(notched_flange, thickness=0.6, notches=1, symmetry=1, radius=1.5),
    "folded_cover": Expected(folded_cover, bent=True, notches=1, symmetry=1, radius=2.0),
    "relieved_angle": Expected(relieved_angle, thickness=2.0, bent=True, notches=1, radius=3.0, toward=(0, 1, 1)),
    "slotted_cover": Expected(slotted_cover, thickness=0.8, holes=165, symmetry=2, radius=3.2),
    "flanged_cover": Expected(flanged_cover, thickness=0.8, holes=5, symmetry=2, radius=3.0),
    "louvred_cover": Expected(louvred_cover, holes=3, symmetry=1, radius=0.0),
    "saddle_panel": Expected(saddle_panel, kind="surface", thickness=None, notches=1, symmetry=1),
    "crowned_block": Expected(crowned_block, kind="block", thickness=None, symmetry=2),
    "closed_shell": Expected(closed_shell, symmetry=2, radius=4.0, unit="none", ending="brep"),
    "thick_angle": Expected(thick_angle, thickness=6.35, bent=True, symmetry=1, radius=3.175, toward=(0, 1, 1)),
    "inch_tray": Expected(inch_tray, thickness=0.9144, symmetry=2, radius=0.164 * INCH, unit="inch"),
    "unitless_inch_tray": Expected(unitless_inch_tray, thickness=0.036, symmetry=2, radius=0.164, unit="none",
                                   ending="brep"),
    "tilted_tray": Expected(tilted_tray, symmetry=2, radius=4.0, toward=tilt()),
    "leaning_tray": Expected(leaning_tray, bent=True, symmetry=1, radius=4.0, toward=(0, 0.185, 1)),
    "lipped_channel": Expected(lipped_channel, bent=True, symmetry=2, radius=2.0, toward=None),
    "bottle": Expected(bottle, symmetry=2, radius=4.0, toward=None),
    "hemmed_pan": Expected(hemmed_pan, symmetry=2, radius=2.0, toward=None),
    "tube": Expected(tube, thickness=2.0, toward=None, holes=1, symmetry=2),
    "two_angles": Expected(two_angles, kind="several", thickness=None, toward=None),
    "milled": Expected(milled, kind="block", thickness=None, symmetry=2),
    "plate": Expected(plate, kind="flat", thickness=2.0, holes=1, symmetry=2),
}


def in_inches(path):
    """Rewrite a STEP file in mm as one in inches."""
    text = path.read_text()
    scaled = re.sub(r"(CARTESIAN_POINT\s*\(\s*'[^']*'\s*,\s*\()([^)]*)(\)\s*\))",
                    lambda m: m[1] + ",".join(repr(float(v) / INCH) for v in m[2].split(",")) + m[3], text)
    for kind, last in (("CIRCLE", 1), ("CYLINDRICAL_SURFACE", 1), ("SPHERICAL_SURFACE", 1), ("TOROIDAL_SURFACE", 2),
                       ("VECTOR", 1)):
        scaled = re.sub(rf"({kind}\s*\(\s*'[^']*'\s*,\s*#\d+\s*,)([^)]*)(\)\s*;)",
                        lambda m, last=last: m[1] + ",".join(repr(float(v) / INCH) for v in m[2].split(",")[:last])
                        + m[3], scaled)
    unit = re.search(r"#(\d+)\s*=\s*\(\s*LENGTH_UNIT\(\)\s*NAMED_UNIT\(\*\)\s*SI_UNIT\(\.MILLI\.,\.METRE\.\)\s*\)\s*;",
                     scaled)
    number = max(int(n) for n in re.findall(r"#(\d+)\s*=", scaled))
    of_mm, measure, exponents = number + 1, number + 2, number + 3
    scaled = scaled.replace(unit[0], f"""#{of_mm}=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#{exponents}=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);
#{measure}=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#{of_mm});
#{unit[1]}=(CONVERSION_BASED_UNIT('INCH',#{measure})LENGTH_UNIT()NAMED_UNIT(#{exponents}));""")
    path.write_text(scaled)


def write(folder, names=PARTS, turn=None):
    """Write parts into a folder, turned by axis and angle (radian) on request; return their paths."""
    paths = {}
    with session(), silence():
        for name in names:
            part = PARTS[name]
            part.make()
            occ.synchronize()
            if turn:
                occ.rotate(gmsh.model.getEntities(3) or gmsh.model.getEntities(2), 0, 0, 0, *turn)
                occ.synchronize()
            paths[name] = folder / f"{name}.{part.ending}"
            gmsh.write(str(paths[name]))
            gmsh.clear()
            if part.unit == "inch":
                in_inches(paths[name])
    return paths


def table(folder):
    """Print a row for each part: what it is, how it is read, processor time."""
    heading = ["part", "made as", "faces", "read as", "punch from", "least draft, degrees", "radius inside, mm",
               "holes, notches", "verdict", "s"]
    rows = []
    for name, path in write(folder).items():
        start = time.process_time()
        with session() as gmsh:
            reading = read_part(gmsh, Request(path))
        seconds = time.process_time() - start
        one, sheet = reading.direction, reading.sheet
        what = PARTS[name].make.__doc__.removeprefix("Make ").split("\n")[0]
        free = one is not None and one.free
        verdict = reading.faults[0].text.split(":")[0].replace("the part is ", "") if reading.faults else \
            "bent" if reading.bends else "drawn" if free else "a tool of its own"
        kind = f"sheet of {sheet.thickness:.4g} mm" if sheet.thickness else sheet.kind
        rows.append([f"`{name}`", what.rstrip(".:"), f"{len(reading.shape.tags)}", "parts" if one is None else kind,
                     one.words if one and (free or sheet.kind == "block") else "",
                     f"{round(one.least, 6) + 0.0:.2g}" if free else "",
                     f"{reading.inner_radius[0]:.3g}" if sheet.kind == "sheet" and np.isfinite(reading.inner_radius[0])
                     else "", f"{len(reading.holes)}, {len(reading.notches)}" if one else "", verdict,
                     f"{seconds:.1f}"])
    print(pages.table(heading, rows))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="folder of the STEP files")
    parser.add_argument("parts", nargs="*", help="their names (all)")
    parser.add_argument("--table", action="store_true", help="read the files and print the table of docs/parts.md")
    options = parser.parse_args()
    if options.table:
        table(made_folder(options.folder))
    else:
        write(made_folder(options.folder), options.parts or PARTS)
