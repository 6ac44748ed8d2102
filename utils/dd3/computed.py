# SPDX-License-Identifier: GPL-3.0-or-later
"""Computed curves of a formed part that measured ones are compared with."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from dd3.errors import Problem
from dd3.measured import Measured
from dd3.plot.force import vector
from dd3.section import Section
from dd3.sheet import AXES, Sheet, in_plane, plane


def curve(measured: Measured, sheet: Sheet, history: pd.DataFrame, mirror: Sequence[str]
          ) -> tuple[np.ndarray, np.ndarray]:
    """Return what is computed of a measured curve: what it is over, and the values, in mm, N, degrees, fractions; at
    the end of the run, forces of the whole part."""
    if measured.over == "travel":
        return force(history, measured.name.removesuffix("_force"), mirror)
    if measured.over == "angle":
        at, values = max(draw_in(sheet, mirror), key=lambda line: len(line[0]))
        order = np.argsort(at)
        return at[order], values[order]
    normal, distance = plane(measured.section)
    section = Section(sheet, sheet.cut(normal, distance)[0], sheet.last)
    if measured.over == "length0":
        return section.length0, section.field(measured.name)[0]
    at, height = in_plane(section.now, normal).T
    return at, height


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


def draw_in(sheet: Sheet, mirror: Sequence[str]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the angle from x about the middle before the run, in degrees, and the draw-in, of each line of the rim."""
    start, value = sheet.start(sheet.last), sheet.values(sheet.last, "draw_in")[0]
    middle = (start.min(axis=0) + start.max(axis=0)) / 2
    middle = [0.0 if axis in mirror else middle[i] for i, axis in enumerate(AXES)]
    found = []
    for line in sheet.outline(True, mirror):
        angle = np.degrees(np.unwrap(np.arctan2(start[line, 1] - middle[1], start[line, 0] - middle[0])))
        found.append((angle - 360 * np.floor(angle.min() / 360 + 1e-9), value[line]))
    return found
