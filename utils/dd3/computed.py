# SPDX-License-Identifier: GPL-3.0-or-later
"""Computed curves of a formed part that measured ones are compared with."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from dd3.errors import Problem
from dd3.measured import Measured
from dd3.plot.force import vector
from dd3.section import Section
from dd3.sheet import AXES, Sheet, in_plane, of_pieces, plane
from dd3.springback import images

Piece = tuple[np.ndarray, np.ndarray]  # what a curve is over, and its values


class Computed(NamedTuple):
    """A computed curve in its pieces, and words on pieces that are left out."""

    pieces: list[Piece]
    said: str = ""


def curve(measured: Measured, sheet: Sheet, history: pd.DataFrame, mirror: Sequence[str]) -> Computed:
    """Return what is computed of a measured curve, in mm, N, degrees, fractions; at the end of the run, forces, rim and
    shape of the whole part."""
    if measured.over == "travel":
        return Computed([force(history, measured.name.removesuffix("_force"), mirror)])
    if measured.over == "angle":
        return Computed(outer_draw_in(sheet, mirror))
    normal, distance = plane(measured.section)
    if measured.over == "along":
        return Computed(shape(sheet, normal, distance, mirror))
    lines = sheet.cut(normal, distance)
    section = Section(sheet, lines[0], sheet.last)
    return Computed([(section.length0, section.field(measured.name)[0])], of_pieces(lines, sheet.start(sheet.last)))


def shape(sheet: Sheet, normal: np.ndarray, distance: float, mirror: Sequence[str]) -> list[Piece]:
    """Return the coordinates in its plane of the pieces of a section of the whole part: those of an image are the image
    of what the plane's image cuts."""
    across = [axis for axis in mirror if distance or abs(normal[AXES.index(axis)]) < 1 - 1e-12]  # not the plane itself
    found, none = [], []
    for sign in np.concatenate(images(np.ones((1, 3)), across)):
        try:
            lines = sheet.cut(sign * normal, distance)
        except Problem as problem:
            none.append(problem)
            continue
        found += [in_plane(line.at(sheet.points(sheet.last)) * sign, normal).T for line in lines]
    if not found:
        raise none[0]
    return [(at, height) for at, height in found]


def force(history: pd.DataFrame, tool: str, mirror: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Return the travel, and the force of a tool on the whole part, N, while the travel grows: not the closing before
    it and the release after it."""
    left = [axis not in mirror for axis in AXES]  # the others are zero on the whole part
    size = 2 ** len(mirror) * np.linalg.norm(vector(history, tool, "f")[:, left], axis=1)
    travel = history["travel"].to_numpy(float)
    grows = np.diff(travel) > 0
    if not grows.any():
        raise Problem(f"{tool}_force: no tool controls a phase of the run, so that there is no travel")
    rows = np.flatnonzero(np.append(grows, False) | np.insert(grows, 0, False))
    at, first = np.unique(travel[rows], return_index=True)
    return at, size[rows][first]


def draw_in(sheet: Sheet, mirror: Sequence[str]) -> list[Piece]:
    """Return the angle from x about the middle before the run, in degrees, and the draw-in, of each line of the rim."""
    value = sheet.values(sheet.last, "draw_in")[0]
    return [(angles(points), value[line]) for line, points in rims(sheet, mirror)]


def outer_draw_in(sheet: Sheet, mirror: Sequence[str]) -> list[Piece]:
    """Return increasing angles, and the draw-in, of the line of the rim around the largest area, and of its images."""
    line, points = max(rims(sheet, mirror), key=lambda rim: area(*rim[1].T[:2]))
    value, found = sheet.values(sheet.last, "draw_in")[0][line], []
    for image in images(points, [axis for axis in mirror if axis != "z"]):
        angle = angles(image)
        order = np.argsort(angle)
        found.append((angle[order], value[order]))
    return found


def rims(sheet: Sheet, mirror: Sequence[str]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the nodes of each line of the rim, and their places before the run from the middle of the whole part."""
    start = sheet.start(sheet.last)
    middle = (start.min(axis=0) + start.max(axis=0)) / 2
    middle[[axis in mirror for axis in AXES]] = 0.0
    return [(line, start[line] - middle) for line in sheet.outline(True, mirror)]


def area(x: np.ndarray, y: np.ndarray) -> float:
    """Return the area between a line and its ends' links with the middle, which lie on planes of symmetry."""
    return abs(float(x[:-1] @ y[1:] - x[1:] @ y[:-1])) / 2


def angles(points: np.ndarray) -> np.ndarray:
    """Return the angles from x of points along a line, in degrees, the least one in the first turn."""
    angle = np.degrees(np.unwrap(np.arctan2(points[:, 1], points[:, 0])))
    return np.asarray(angle - 360 * np.floor(angle.min() / 360 + 1e-9))
