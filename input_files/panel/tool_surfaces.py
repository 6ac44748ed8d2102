#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the tools of a door panel with feature lines and a pocket for its handle, punch.bez, die.bez and holder.bez, and
rim.txt, its trim curve.

    tool_surfaces.py build/panel

Lengths in mm. The upper face of the drawn sheet is given by heights over the plan, z = face(x, y) inside the opening of
the die and z = binder(x, y) outside, and between them by a wall with a draft and exact arcs. The punch is this
surface, the die lies under it by the thickness and a clearance. The opening is a rounded rectangle. Patches of degree 2
x 2 lie on a grid inside it, whose lines follow the feature lines, and in sectors around it.
"""
import argparse
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

from dd3.errors import run
from dd3.programs import made_folder
from dd3.tools.surface import Surface, from_nodes, turned, write

THICKNESS, CLEARANCE = 0.8, 0.1  # of the sheet and beyond it
OPENING = 500.0, 300.0  # half sizes of the opening along x and y
CORNER, MARGIN = 100.0, 60.0  # radius of the opening in plan; distance of the grid from its straight sides
FLANGE = 180.0  # width of the faces of die and holder around the opening
RIM = 15.0  # distance of the trim curve from the opening
ARCH = 40.0 / 600.0**2  # of the binder, z = ARCH x^2
DEPTH, CROWN = 50.0, (6.0, 16.0)  # of the face below the binder at its rim, and its crown along x and y
NOSE, SHOULDER = 8.0, 8.0  # radii of punch and die
EDGE, ROUND = 14.0, 6.0  # distance of the flat part of the holder from the opening, and radius at which it ends there
DRAFT = 20.0  # of the walls, degrees
CREASE = 5.0  # radius of the feature lines on the punch
# Feature lines along x: y, height of the ridge, angle of its sides at the line, degrees.
LINES = (130.0, 9.0, 13.0), (-150.0, 7.0, 11.0)
# Pocket: y of its middle, half sizes, depth, width of its wall over the half size.
POCKET_Y, POCKET, POCKET_DEPTH, POCKET_WALL = 45.0, (95.0, 48.0), 19.0, 0.6

Map = Callable[[np.ndarray, np.ndarray], np.ndarray]


def binder(x, y):
    """Return the height of the binder, a cylinder."""
    return ARCH * x**2 + 0 * y


def ridge(y, height, angle):
    """Return the depth of a ridge at distances y from its line, rounded there."""
    slope = math.tan(math.radians(angle))
    half = CREASE * math.sin(math.radians(angle))
    inside = np.minimum(np.abs(y), half)
    rounded = slope * half + math.sqrt(CREASE**2 - half**2) - np.sqrt(CREASE**2 - inside**2)
    return height * np.exp(-np.where(np.abs(y) < half, rounded, slope * np.abs(y)) / height)


def pocket(x, y):
    """Return the height of the pocket: a smooth step along a super-ellipse."""
    radius = ((x / POCKET[0])**4 + ((y - POCKET_Y) / POCKET[1])**4)**0.25
    step = np.clip((1 - radius) / POCKET_WALL, 0, 1)
    return POCKET_DEPTH * step**3 * (10 - 15 * step + 6 * step**2)


def face(x, y):
    """Return the height of the panel's face."""
    crown = sum(height * (1 - (place / half)**2) for height, place, half in zip(CROWN, (x, y), OPENING))
    ridges = sum(ridge(y - line, height, angle) for line, height, angle in LINES)
    return binder(x, y) - DEPTH - crown - ridges + pocket(x, y)


def surface_over(height):
    """Return the map of a surface over the plan."""
    return lambda x, y: np.stack([x, y, height(x, y)], axis=-1)


class Sector:
    """Part of the plan on one side of the opening: q along the side, d outwards from its contour."""

    def __init__(self, turn: int):
        """Choose the side: 0 at x > 0, then counter-clockwise."""
        angle = turn * math.pi / 2
        self.outwards = np.round([math.cos(angle), math.sin(angle)])
        self.along = np.array([-self.outwards[1], self.outwards[0]])
        self.far, self.half = OPENING if turn % 2 == 0 else OPENING[::-1]

    def direction(self, q):
        """Return the normal of the contour, which turns by 45 degrees along the end of the grid's side."""
        angle = np.sign(q) * np.maximum(np.abs(q) - self.half + CORNER, 0) / (CORNER - MARGIN) * math.pi / 4
        return np.cos(angle)[..., None] * self.outwards + np.sin(angle)[..., None] * self.along

    def place(self, q, d):
        """Return x and y."""
        end = self.half - CORNER
        centre = (self.far - CORNER) * self.outwards + np.clip(q, -end, end)[..., None] * self.along
        return np.moveaxis(centre + (CORNER + d)[..., None] * self.direction(q), -1, 0)

    def slope(self, height, q, d):
        """Return the slope of a height across the contour."""
        return (height(*self.place(q, d + 1e-4)) - height(*self.place(q, d - 1e-4))) / 2e-4

    def inner(self, start):
        """Return the map from the side of the grid (s = 0) to the distance `start` from the contour (s = 1)."""
        def points(q, s):
            side = (self.far - MARGIN) * self.outwards + q[..., None] * self.along
            x, y = np.moveaxis(side, -1, 0) * (1 - s) + self.place(q, start + 0 * q) * s
            return np.stack([x, y, face(x, y)], axis=-1)
        return points

    def holder(self):
        """Return the map of the holder: s from 0 to 1 in the arc at the opening, to 2 on the binder."""
        def points(q, s):
            angle = math.radians(60) * np.clip(1 - s, 0, 1)
            d = np.where(s < 1, EDGE - ROUND * np.sin(angle), EDGE + (s - 1) * (FLANGE - EDGE))
            x, y = self.place(q, d)
            return np.stack([x, y, binder(x, y) + ROUND * (1 - np.cos(angle))], axis=-1)
        return points

    def profile(self, start):
        """Return the map of the section from the face to the binder: s from 0 to 1 on the face, to 2 in the arc of
        the nose, to 3 on the wall, to 4 in the arc of the shoulder, to 5 on the binder."""
        def points(q, s):
            d, z = self.section(q, s, start)
            x, y = self.place(q, d)
            return np.stack([x, y, z], axis=-1)
        return points

    def section(self, q, s, start):
        """Return d and z at s of `profile`."""
        wall = math.radians(90 - DRAFT)
        top = binder(*self.place(q, 0 * q))
        foot = 0 * q
        for _ in range(30):  # converges by a factor of the slope of the face over that of the wall
            foot = (face(*self.place(q, foot)) - top) / math.tan(wall)
        below = np.arctan(self.slope(face, q, foot))
        above = np.arctan(self.slope(binder, q, 0 * q))
        bottom = top + math.tan(wall) * foot
        nose, shoulder = NOSE, SHOULDER + THICKNESS + CLEARANCE
        to_nose, to_shoulder = nose * np.tan((wall - below) / 2), shoulder * np.tan((wall - above) / 2)
        part = [np.clip(s - k, 0, 1) for k in range(5)]
        d0, d1 = foot - to_nose * np.cos(below), foot + to_nose * math.cos(wall)
        d2, d3 = -to_shoulder * math.cos(wall), to_shoulder * np.cos(above)
        angle, back = below + part[1] * (wall - below), wall + part[3] * (above - wall)
        d = np.select([s <= 1, s <= 2, s <= 3, s <= 4], [
            start + part[0] * (d0 - start),
            d0 + nose * (np.sin(angle) - np.sin(below)),
            d1 + part[2] * (d2 - d1),
            d2 + shoulder * (math.sin(wall) - np.sin(back))], d3 + part[4] * (FLANGE - d3))
        z = np.select([s <= 1, s <= 2, s <= 3, s <= 4], [
            bottom + np.tan(below) * (d - foot),
            bottom - to_nose * np.sin(below) + nose * (np.cos(below) - np.cos(angle)),
            top + math.tan(wall) * d,
            top - to_shoulder * math.sin(wall) + shoulder * (np.cos(back) - math.cos(wall))], top + np.tan(above) * d)
        # The arcs touch the tangents of face and binder; their small curvature is added.
        inside, outside = np.minimum(d, foot), np.maximum(d, 0)
        return d, z + (face(*self.place(q, inside)) - bottom - np.tan(below) * (inside - foot)) \
            + (binder(*self.place(q, outside)) - top - np.tan(above) * outside)


def offset(points: Map, distance: float, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return points of a map at a distance along its normals upwards."""
    step = 1e-5
    # Not beyond the ends: there another map goes on.
    along = [points(np.minimum(u + step, u.max()), v) - points(np.maximum(u - step, u.min()), v),
             points(u, np.minimum(v + step, v.max())) - points(u, np.maximum(v - step, v.min()))]
    normal = np.cross(*along)
    normal *= np.sign(normal[..., 2:]) / np.linalg.norm(normal, axis=-1, keepdims=True)
    return points(u, v) + distance * normal


def patches(points: Map, u: np.ndarray, v: np.ndarray, distance: float) -> np.ndarray:
    """Return the patches between lines u and v of a map, moved by a distance."""
    u, v = (np.interp(np.arange(2 * len(line) - 1) / 2, np.arange(len(line)), line) for line in (u, v))
    nodes = offset(points, distance, *np.meshgrid(u, v))
    return from_nodes(np.array([nodes[j:j + 3, i:i + 3] for j in range(0, len(v) - 2, 2)
                                for i in range(0, len(u) - 2, 2)]))


def between(start, end, size):
    """Return lines at most `size` apart."""
    return np.linspace(start, end, max(2, 1 + math.ceil((end - start) / size - 1e-9)))


def lines_through(places):
    """Return lines through places, each with the size of the patches up to the next one."""
    parts = [between(start, end, size) for (start, size), (end, _) in zip(places, places[1:])]
    return np.unique(np.round(np.concatenate(parts), 9))


def grid_lines(with_face: bool):
    """Return the lines of the grid along x and y: close at the ends, where the sectors turn, and with the face in the
    pocket and along the arcs of the feature lines."""
    (end_x, straight_x), (end_y, straight_y) = ((half - MARGIN, half - CORNER) for half in OPENING)
    along_x = [(-end_x, 8), (-straight_x, 40), (straight_x, 8), (end_x, 0)]
    along_y = [(-end_y, 8), (-straight_y, 20), (straight_y, 8), (end_y, 0)]
    if not with_face:
        return lines_through(along_x), lines_through(along_y)
    along_x += [(-POCKET[0], 4), (POCKET[0], 40)]
    along_y += [(POCKET_Y - POCKET[1], 2), (POCKET_Y + POCKET[1], 20)]
    for line, _, angle in LINES:
        half = CREASE * math.sin(math.radians(angle))
        along_y += [(line - 15, 4), (line - half, half), (line + half, 4), (line + 15, 20)]
    return lines_through(sorted(along_x)), lines_through(sorted(along_y))


def sides(x: np.ndarray, y: np.ndarray):
    """Return the sectors with their lines q."""
    # q runs against x or y on two sides.
    return zip(map(Sector, range(4)), (y, -x[::-1], -y[::-1], x))


def tool(rows: np.ndarray, distance: float) -> np.ndarray:
    """Return a surface through rows of the section, with the face inside them."""
    x, y = grid_lines(with_face=True)
    start = -MARGIN * 0.6
    nets = [patches(surface_over(face), x, y, distance)]
    for sector, side in sides(x, y):
        nets += [patches(sector.inner(start), side, np.linspace(0, 1, 3), distance),
                 patches(sector.profile(start), side, rows, distance)]
    return np.concatenate(nets)


def blank_holder() -> np.ndarray:
    """Return the surface of the blank-holder."""
    rows = np.concatenate([np.linspace(0, 1, 4)[:-1], np.linspace(1, 2, 7)])
    return np.concatenate([patches(sector.holder(), side, rows, 0.0)
                           for sector, side in sides(*grid_lines(with_face=False))])


def facing(net: np.ndarray, side: int) -> Surface:
    """Return a surface with its normals upwards (1) or downwards (-1)."""
    across = np.cross(net[:, 1, 2, :3] - net[:, 1, 0, :3], net[:, 2, 1, :3] - net[:, 0, 1, :3])
    wrong = across[:, 2] * side < 0
    net[wrong] = turned(net[wrong])
    return Surface(net, np.zeros(len(net), int), ["surface"])


def tools() -> dict[str, Surface]:
    """Return the tools by their names."""
    section = np.concatenate([np.linspace(0, 1, 2)[:-1], np.linspace(1, 2, 6)[:-1], np.linspace(2, 3, 3)[:-1],
                              np.linspace(3, 4, 6)[:-1], np.linspace(4, 5, 7)])
    return {"punch": facing(tool(section[section <= 3], 0.0), -1),
            "die": facing(tool(section, -THICKNESS - CLEARANCE), 1),
            "holder": facing(blank_holder(), -1)}


def rim() -> np.ndarray:
    """Return the trim curve in plan, counter-clockwise."""
    arc = np.linspace(0, np.pi / 2, 31)
    corners = [np.array([np.cos(arc + turn), np.sin(arc + turn)]) * (CORNER + RIM)
               + (np.array(OPENING) - CORNER)[:, None] * np.sign([[math.cos(turn + 0.5)], [math.sin(turn + 0.5)]])
               for turn in np.arange(4) * np.pi / 2]
    return np.hstack(corners).T


def main() -> None:
    """Write the files into the folder of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=made_folder, help="folder of the files")
    folder = Path(parser.parse_args().folder)
    for name, surface in tools().items():
        write(folder / f"{name}.bez", surface, [f"{name} of the door panel"])
    np.savetxt(folder / "rim.txt", np.pad(rim(), ((0, 0), (0, 1))), "%.6f", header="trim curve, mm")


if __name__ == "__main__":
    run(main)
