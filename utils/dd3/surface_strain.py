# SPDX-License-Identifier: GPL-3.0-or-later
"""Logarithmic strains in the surface of the sheet at the centres of its elements, from the positions of their nodes.

They are those of the program at nodes (src/model/surface_strain.f90) before they are averaged there: principal values
of the right stretch of the surface between the bottom and the top nodes of the columns; straight edges stand for
circular arcs, which turn by the angle between the directors at their ends.
"""
import numpy as np

from dd3.sheet import Sheet

HEIGHTS = {"lower": 0.0, "middle": 0.5, "upper": 1.0}
LOWER, UPPER = (0, 1, 2, 3, 8, 9, 10, 11), (4, 5, 6, 7, 12, 13, 14, 15)  # nodes of both faces in VTK's order
TINY = 1e-30


def cell_strains(sheet: Sheet, step: int, surface: str) -> tuple[np.ndarray, np.ndarray]:
    """Return major and minor strain of the elements at a step; those of a column are equal."""
    start, now = sheet.initial(step), sheet.points(step)
    faces = columns(sheet.elements(step), len(now))
    height = HEIGHTS[surface]
    before, after = (tangents(points[faces[0]], points[faces[1]], height) for points in (start, now))
    images = in_base(before, after)
    stretch = np.linalg.eigvalsh(np.swapaxes(images, 1, 2) @ images)
    minor, major = 0.5 * np.log(np.maximum(stretch, TINY)).T
    return major, minor


def columns(cells: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the nodes of the elements' columns at the bottom and at the top of the sheet, corners and then mid-edge
    nodes (element, 4 or 8)."""
    places = 4 if cells.shape[1] < 20 else 8
    low, high = cells[:, LOWER[:places]], cells[:, UPPER[:places]]
    up, down = np.arange(count), np.arange(count)
    up[low], down[high] = high, low
    for _ in range(len(cells)):
        if (up[up] == up).all() and (down[down] == down).all():
            break
        up, down = up[up], down[down]
    return down[low], up[high]


def tangents(bottom: np.ndarray, top: np.ndarray, height: float) -> np.ndarray:
    """Return the derivatives of the positions at the centres of the faces (element, 3, 2)."""
    points, director = (1 - height) * bottom + height * top, top - bottom
    if points.shape[1] == 8:
        return np.stack([points[:, 5] - points[:, 7], points[:, 6] - points[:, 4]], axis=2) / 2
    director = director / np.maximum(np.linalg.norm(director, axis=2, keepdims=True), TINY)
    tangent, turn = (np.stack([values[:, 1] + values[:, 2] - values[:, 0] - values[:, 3],
                               values[:, 2] + values[:, 3] - values[:, 0] - values[:, 1]], axis=2) / 4
                     for values in (points, director))
    # With the chord c and the directors d at its ends, the sine of half the angle is c.(d2 - d1)/(2 |c|), and arc over
    # chord asin(s)/s.
    sine = np.abs((tangent * turn).sum(axis=1)) / np.maximum(np.linalg.norm(tangent, axis=1), TINY)
    sine = np.clip(sine, 1e-8, 1.0)
    return tangent * (np.arcsin(sine) / sine)[:, None, :]


def in_base(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Return the images (element, 3, 2) of orthonormal vectors in the initial faces."""
    length = np.linalg.norm(before[:, :, 0], axis=1)
    first = before[:, :, 0] / np.maximum(length, TINY)[:, None]
    along = (first * before[:, :, 1]).sum(axis=1)
    across = np.linalg.norm(before[:, :, 1] - along[:, None] * first, axis=1)
    image = after[:, :, 0] / np.maximum(length, TINY)[:, None]
    return np.stack([image, (after[:, :, 1] - along[:, None] * image) / np.maximum(across, TINY)[:, None]], axis=2)
