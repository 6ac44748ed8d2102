#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make the CAD of the tools of a fender-like panel, STEP files, and the curves of its trimming.

    make_cad.py cad

Lengths in mm. The inner side of the panel is z = face(x, y) in the coordinates of the part, z upwards in the car. The
draw is upside down; in the presses for flanging the part is tipped by TIP degrees about x, so that its wheel arch is
level there. Gmsh makes the half x > 0, and trim.txt has the outline of the panel and its opening.
"""
import argparse
import itertools
import math
from pathlib import Path

import numpy as np

from dd3.errors import run
from dd3.programs import made_folder
from dd3.tools.solids import gmsh, write_into
from dd3.tools.surface import FROM_NODES

THICKNESS, CLEARANCE = 0.8, 0.1  # of the sheet and beyond it
CROWN = 1200.0, 500.0  # radii of the face along x and y
LEAN = 0.1  # slope of the face along y in the middle
LINE, KINK, BLEND = 25.0, math.radians(12), 25.0  # y of the feature line, its angle and its radius
OPENING, CORNER, GAP = (165.0, 95.0), 40.0, 0.2  # half sizes and corner of the opening; of the walls beyond THICKNESS
BINDER = 33.0, 4.0  # depth of the binder below the crown at x = 0, and what it falls further up to the opening
NOSE, SHOULDER, FLANGE = 10.0, 10.0, 55.0  # radii of punch and die; width of the binder
TIP, CAM = -12.0, 25.0  # of the part about x, and of the way of the cam from that of the ram, degrees
ARCH, MIDDLE = 90.0, -125.0  # radius of the wheel arch and y of its middle, tipped
HOOD, EDGE = 600.0, 62.0  # radius of the edge at the hood about the axis of the cam, and its place y, tipped
LEG = 11.0  # length of the blank of the flanges beyond the corners of the post
BEND, STRUCK = 6.0, 4.0  # radii of the post for flanging and of that for the restrike
LIP, DEPTH = 5.0, 21.0  # radius of the flanging steels and how far they end below the corners of the post
END, SILL = 145.0, -80.0  # x and y of the plain borders
FLAP = 100.0, -15.0, 8.0, 14.0  # opening of the fuel flap: x and y of its middle, half of its straight sides, radius
BAND = 16.0  # width of the restrike steel on the face


def face(x, y):
    """Return the height of the inner side of the panel."""
    half = BLEND * math.tan(KINK / 2)
    inside = np.clip(y - LINE, -half, half)
    kink = math.tan(KINK) * (np.maximum(y - LINE - half, 0) + (inside + half)**2 / (4 * half))
    return -x**2 / (2 * CROWN[0]) - y**2 / (2 * CROWN[1]) + LEAN * y - kink


def binder(x, y):
    """Return the height of the binder on the side of the die, a cylinder."""
    return -BINDER[0] - BINDER[1] * (x / OPENING[0])**2 + 0 * y


def sheets_of(height, shift=0.0, lines=()):
    """Return the surfaces z = height(x, y) + shift between lines y, each of degree 2 and exact."""
    occ = gmsh.model.occ
    found = []
    for low, high in itertools.pairwise([-200, *lines, 200]):
        x, y = (-30, 105, 240), (low, (low + high) / 2, high)
        nodes = np.array([[(a, b, height(a, b) + shift) for a in x] for b in y])
        net = np.einsum("ai,bj,ijc->abc", FROM_NODES, FROM_NODES, nodes).reshape(-1, 3)
        found.append((2, occ.addBSplineSurface([occ.addPoint(*point) for point in net], 3, degreeU=2, degreeV=2)))
    return found


def faces_of_panel(shift, tip=0.0):
    """Return the surfaces of the face, moved up by a shift and turned about x by `tip`, degrees."""
    half = BLEND * math.tan(KINK / 2)
    found = sheets_of(face, shift, (LINE - half, LINE + half))
    gmsh.model.occ.rotate(found, 0, 0, 0, 1, 0, 0, math.radians(tip))
    return found


def part_of(body, surfaces, above):
    """Cut a body by surfaces and return what is above or below them."""
    occ = gmsh.model.occ
    _, (parts, *_) = occ.fragment([(3, body)], surfaces)
    occ.synchronize()
    order = sorted((part for part in parts if part[0] == 3), key=lambda part: occ.getCenterOfMass(*part)[2])
    kept = order[-1 if above else 0]
    occ.remove([part for part in order if part != kept], recursive=True)
    occ.synchronize()
    free = [entity for entity in occ.getEntities(2) if not len(gmsh.model.getAdjacencies(*entity)[0])]
    occ.remove(free, recursive=True)
    occ.synchronize()
    return kept[1]


def edges(body, chosen):
    """Return the edges of a body whose box (x, y, z of its two corners) is chosen."""
    gmsh.model.occ.synchronize()
    own = gmsh.model.getBoundary(gmsh.model.getBoundary([(3, body)], oriented=False), combined=False, oriented=False)
    return [tag for tag in sorted({tag for _, tag in own}) if chosen(gmsh.model.getBoundingBox(1, tag))]


def rounded(body, chosen, radius):
    """Round edges of a body and return it."""
    found = gmsh.model.occ.fillet([body], chosen, [radius])
    gmsh.model.occ.synchronize()
    return found[0][1]


def column(half, corner, low, high):
    """Return an upright prism over a half of a rectangle with rounded corners, beyond the plane of symmetry."""
    occ = gmsh.model.occ
    body = occ.addBox(-20, -half[1], low, half[0] + 20, 2 * half[1], high - low)
    return rounded(body, edges(body, lambda ends: ends[5] - ends[2] > high - low - 1 and ends[0] > half[0] - 1), corner)


def rim_of(body, half, low, high):
    """Return the edges around the end of a column, between two heights and beside its walls."""
    return edges(body, lambda ends: low < ends[2] and ends[5] < high and ends[3] > 0
                 and (ends[0] > half[0] - CORNER - 1 or ends[1] > half[1] - CORNER - 1
                      or ends[4] < CORNER + 1 - half[1]))


def plug(grown):
    """Return the punch in the coordinates of the part, or with `grown` the hollow of the die."""
    out, up = (THICKNESS + GAP, THICKNESS + CLEARANCE) if grown else (0.0, 0.0)
    half = tuple(size + out - THICKNESS - GAP for size in OPENING)
    body = part_of(column(half, CORNER + out - THICKNESS - GAP, -80, 60), faces_of_panel(up), above=False)
    return rounded(body, rim_of(body, half, -60, 30), NOSE + up)


def turned(degrees):
    """Turn all that was made about x."""
    gmsh.model.occ.synchronize()
    gmsh.model.occ.rotate(gmsh.model.getEntities(3), 0, 0, 0, 1, 0, 0, math.radians(degrees))


def punch():
    """Make the punch."""
    plug(grown=False)
    turned(180)


def size_of_binder():
    """Return the half sizes of the binder."""
    return [size + FLANGE for size in OPENING]


def die():
    """Make the die: a block on the binder with its hollow."""
    occ = gmsh.model.occ
    far = size_of_binder()
    body = part_of(occ.addBox(-20, -far[1], -70, far[0] + 20, 2 * far[1], 110), sheets_of(binder), above=True)
    body = occ.cut([(3, body)], [(3, plug(grown=True))])[0][0][1]
    rounded(body, rim_of(body, OPENING, -BINDER[0] - BINDER[1] - 1, -BINDER[0] + 1), SHOULDER)
    turned(180)


def holder():
    """Make the holder."""
    occ = gmsh.model.occ
    far = [size - 2 for size in size_of_binder()]
    block = occ.addBox(-18, -far[1], -70, far[0] + 18, 2 * far[1], 110)
    body = part_of(block, sheets_of(binder, -THICKNESS), above=False)
    occ.cut([(3, body)], [(3, column(tuple(size + 2 for size in OPENING), CORNER + 2, -100, 60))])
    turned(180)


def arch(radius, low=-40.0, high=60.0):
    """Return an upright cylinder about the middle of the wheel arch."""
    return 3, gmsh.model.occ.addCylinder(0, MIDDLE, low, 0, 0, high - low, radius)


def hood(radius, low=-90.0, high=90.0):
    """Return a cylinder about the axis of the edge at the hood, from low to high along the way of the cam."""
    tag = gmsh.model.occ.addCylinder(0, 0, low, 0, 0, high - low, radius)
    return 3, placed(tag)


def placed(tag):
    """Bring a body from the coordinates of the cam, its axis z through the middle of the hood, to its place."""
    occ = gmsh.model.occ
    occ.translate([(3, tag)], 0, -HOOD, 0)
    occ.rotate([(3, tag)], 0, 0, 0, 1, 0, 0, -math.radians(CAM))
    occ.translate([(3, tag)], 0, *hood_edge())
    return tag


def tipped(points, degrees=TIP):
    """Return points of the part as the presses for flanging have them."""
    angle = math.radians(degrees)
    turn = np.array([[1, 0, 0], [0, math.cos(angle), -math.sin(angle)], [0, math.sin(angle), math.cos(angle)]])
    return np.asarray(points) @ turn.T


def on_face(starts, way):
    """Return where lines through points along a way meet the face, all in the coordinates of the part."""
    starts, way = np.asarray(starts, float), np.asarray(way, float)
    along = np.zeros(len(starts))
    for _ in range(50):
        x, y, z = (starts + along[:, None] * way).T
        along -= (z - face(x, y)) / way[2]
    return starts + along[:, None] * way


def untipped(points):
    """Return points in the presses for flanging in the coordinates of the part."""
    return tipped(points, -TIP)


def hood_edge():
    """Return y and z of the edge at the hood in the plane of symmetry, tipped."""
    return tipped(on_face(untipped([[0, EDGE, 0]]), untipped([0, 0, 1])))[0, 1:]


def block(shift=0.0):
    """Return a block below the face, tipped, as wide as the panel."""
    return part_of(gmsh.model.occ.addBox(-20, -90, -60, END + 25, 200, 120), faces_of_panel(shift, TIP), above=False)


def arch_edges(body, radius, low=-20):
    """Return the edges of the face at the wheel arch."""
    return edges(body, lambda ends: ends[2] > low and ends[3] > 20 and ends[3] < radius
                 and ends[4] < MIDDLE + radius + 1 and ends[4] > MIDDLE + radius - 1)


def post():
    """Make the post for flanging, whose end at the hood is a slide that can be drawn back."""
    occ = gmsh.model.occ
    body = block()
    body = occ.intersect([(3, body)], [hood(HOOD)])[0]
    body = occ.cut(body, [arch(ARCH)])[0][0][1]
    rounded(body, arch_edges(body, ARCH) + edges(body, lambda ends: ends[1] > 20 and ends[2] > -40
                                                 and ends[3] - ends[0] > 100 and ends[4] - ends[1] > 5), BEND)


def restrike_post():
    """Make the post of the restrike, which ends before the flange at the hood."""
    occ = gmsh.model.occ
    body = block()
    body = occ.intersect([(3, body)], [hood(HOOD - BEND - 4)])[0]
    body = occ.cut(body, [arch(ARCH)])[0][0][1]
    rounded(body, arch_edges(body, ARCH), STRUCK)


def pad_above(ring, hood_margin):
    """Make a pad above the panel, at distances from the corners of the post."""
    occ = gmsh.model.occ
    body = part_of(occ.addBox(-18, -74, -60, END + 15, 200, 120), faces_of_panel(THICKNESS, TIP), above=True)
    body = occ.intersect([(3, body)], [hood(HOOD - hood_margin)])[0]
    occ.cut(body, [arch(ARCH + ring, -80, 80)])


def pad():
    """Make the pad of the flanging."""
    pad_above(BEND, BEND)


def restrike_pad():
    """Make the pad of the restrike."""
    pad_above(BAND + 2, BEND + 4)


def arch_steel():
    """Make the flanging steel of the wheel arch at the end of its way."""
    _, tag = arch(ARCH - THICKNESS - CLEARANCE, low=-DEPTH, high=12)
    tag = rounded(tag, edges(tag, lambda ends: ends[5] < 1 - DEPTH and ends[3] > 50), LIP)
    gmsh.model.occ.intersect([(3, tag)], [(3, gmsh.model.occ.addBox(-16, -100, -60, 200, 200, 120))])


def cam():
    """Make the flanging steel of the edge at the hood at the end of its way, with the cam."""
    occ = gmsh.model.occ
    inner = HOOD + THICKNESS + CLEARANCE
    ring = occ.addBox(-16, HOOD - 60, -DEPTH, END + 40, 100, DEPTH + 12)
    ring = occ.cut([(3, ring)], [(3, occ.addCylinder(0, 0, -100, 0, 0, 200, inner))])[0][0][1]
    placed(rounded(ring, edges(ring, lambda ends: ends[5] < 1 - DEPTH and ends[3] - ends[0] > 100
                               and ends[4] - ends[1] > 5 and ends[4] < inner + 1), LIP))


def restrike_steel():
    """Make the restrike steel at the end of its way, one thickness outside its post."""
    occ = gmsh.model.occ
    inner = occ.cut([(3, block(THICKNESS))], [arch(ARCH - THICKNESS)])[0][0][1]
    inner = rounded(inner, arch_edges(inner, ARCH - THICKNESS), STRUCK + THICKNESS)
    outer = occ.intersect([arch(ARCH + BAND, -DEPTH, 30)], [(3, occ.addBox(-20, -90, -60, 200, 200, 120))])[0]
    body = occ.cut(outer, [(3, inner)])[0][0][1]
    rounded(body, edges(body, lambda ends: ends[5] < 1 - DEPTH and ends[3] > 50 and ends[4] > MIDDLE + ARCH - 2), LIP)


def rim():
    """Return the trim curve in the coordinates of the part, its half at x > 0, from the hood to the wheel arch."""
    angle = math.radians(CAM)
    y0, z0 = hood_edge()
    way = np.array([0, math.sin(angle), math.cos(angle)])
    across = np.array([0, math.cos(angle), -math.sin(angle)])
    turn = np.linspace(0, math.asin(END / (HOOD + LEG)), 31)
    top = np.array([0, y0, z0]) + (HOOD + LEG) * np.sin(turn)[:, None] * np.array([1, 0, 0]) \
        + ((HOOD + LEG) * np.cos(turn) - HOOD)[:, None] * across
    turn = np.radians(np.linspace(80, 0, 81))
    low = np.stack([(ARCH - LEG) * np.sin(turn), MIDDLE + (ARCH - LEG) * np.cos(turn), 0 * turn], axis=-1)
    top = on_face(untipped(top), untipped(way))
    low = on_face(untipped(low), untipped([0, 0, 1]))
    return np.concatenate([top, [[END, SILL, 0]], low[low[:, 1] > SILL]])


def opening():
    """Return the opening of the fuel flap, which is pierced, in the coordinates of the part."""
    turn = np.radians(np.arange(0, 180, 7.5) + 3.75)
    end = FLAP[3] * np.stack([np.sin(turn), np.cos(turn)], axis=-1)
    middle, shift = np.array(FLAP[:2]), np.array([FLAP[2], 0])
    return np.concatenate([middle + shift + end, middle - shift - end])


def write_curves(path):
    """Write the curves of the trimming, in plan of the part: the outline of the panel and its opening."""
    half = rim()[:, :2]
    with path.open("w", encoding="utf-8") as file:
        file.write("# outline of the fender and opening of its fuel flap, mm\n")
        for curve in (np.concatenate([half, half[::-1] * [-1, 1]]), opening()):
            np.savetxt(file, np.pad(curve, ((0, 0), (0, 1))), "%.6f")
            file.write("\n")


TOOLS = (punch, die, holder, post, pad, arch_steel, cam, restrike_post, restrike_pad, restrike_steel)


def main():
    """Write the files into the folder of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=made_folder, help="folder of the files")
    folder = Path(parser.parse_args().folder)
    write_into(folder, {make.__name__: make for make in TOOLS})
    write_curves(folder / "trim.txt")


if __name__ == "__main__":
    run(main)
