# SPDX-License-Identifier: GPL-3.0-or-later
"""Press directions that are tried: axes, normals of flat faces, and the best ones of those that the normals allow.

The directions from which no normal of a side looks away are a cone.
"""
import numpy as np
from scipy.optimize import nnls

from dd3.part.directions import ENOUGH
from dd3.part.shape import Shape, angle_between, unit
from dd3.part.sheet import Sheet

# Angle up to which two candidates are one, degrees.
SAME = 1.0
# Number of normals of flat faces that are tried.
PLANES = 3
# Angle by which the cone is wider, or a draft larger, degrees: less than the draft that counts as undercut.
WIDER = 0.1
# Steps to the direction with a draft.
STEPS = 8


def candidates(shape: Shape, sheet: Sheet) -> list[tuple[str, np.ndarray]]:
    """Return names and unit vectors of directions to be tried, those of the file's axes first."""
    own = shape.of(sheet.sides[0])
    area, normal = shape.area[own], shape.normal[own]
    found = [(f"axis {name}", axis) for name, axis in zip("xyz", np.eye(3))]
    flat = [(f"normal of face {tag}", vector) for tag, vector in plane_normals(shape, sheet.sides[0])[:PLANES]]
    if sheet.kind == "block":  # an oblique direction would see more of it
        return [(name, sign * vector) for sign in (1, -1) for name, vector in flat or found]
    found += flat
    mean = area @ normal
    if np.linalg.norm(mean) > 1e-3 * area.sum():
        found.append(("mean normal", unit(mean)))
        found += optimal(normal, mean)
    away = shape.place[own] - np.average(shape.place[own], axis=0, weights=area)
    axes = np.linalg.eigh((area[:, None] * away).T @ away)[1].T
    found += [(f"principal axis {i}", axis) for i, axis in enumerate(axes, 1)]
    return distinct(found)


def plane_normals(shape: Shape, faces: list[int]) -> list[tuple[int, np.ndarray]]:
    """Return the largest flat faces of different directions, with their normals, the largest area of a direction
    first."""
    total: list[tuple[float, int, np.ndarray]] = []
    for tag in sorted((tag for tag in faces if shape.kinds[tag] == "Plane"), key=lambda tag: -shape.areas[tag]):
        normal = shape.normal[shape.cells[tag][0]]
        same = next((k for k, one in enumerate(total) if abs(normal @ one[2]) > np.cos(np.radians(SAME))), None)
        if same is None:
            total.append((shape.areas[tag], tag, normal))
        else:
            total[same] = (total[same][0] + shape.areas[tag], *total[same][1:])
    return [(tag, normal) for _, tag, normal in sorted(total, key=lambda one: -one[0])]


def distinct(found: list[tuple[str, np.ndarray]]) -> list[tuple[str, np.ndarray]]:
    """Return the first of the directions that differ, by more than the sign."""
    kept: list[tuple[str, np.ndarray]] = []
    for name, vector in found:
        if all(angle_between(vector, sign * other) > SAME for _, other in kept for sign in (1, -1)):
            kept.append((name, vector))
    return kept


def optimal(normal: np.ndarray, mean: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """Return the direction of the largest projected area, that of the largest one at a draft of 10 degrees if there is
    one, and that of the largest least draft, of those from which no normal looks away; none if each direction has one
    that does.

    The first is the projection of the mean normal on the cone of these directions, the last the point of the
    normals' convex hull that is nearest to the origin: problems of least squares with multipliers that are not
    negative. The cone is a little wider, for walls without draft on all sides.
    """
    unique = np.unique(np.round(normal, 4), axis=0)
    wider = unique + np.sin(np.radians(WIDER)) * unit(mean)
    found = []
    largest = mean + wider.T @ nnls(wider.T, -mean)[0]
    if np.linalg.norm(largest) > 1e-3 * np.linalg.norm(mean):
        found.append(("largest projected area", unit(largest)))
    if np.linalg.norm(largest) and (unique @ unit(largest)).min() < np.sin(np.radians(ENOUGH)):
        drafted = with_draft(unique, mean, unit(largest))
        if (unique @ drafted).min() > np.sin(np.radians(ENOUGH - SAME)):
            found.append((f"largest projected area at {ENOUGH:g} degrees", drafted))
    multiplier = nnls(np.vstack([wider.T, np.ones(len(unique))]), np.array([0.0, 0.0, 0.0, 1.0]))[0]
    nearest = wider.T @ multiplier
    if np.linalg.norm(nearest) > 1e-5 * multiplier.sum():
        found.append(("largest draft", unit(nearest)))
    return found


def with_draft(normals: np.ndarray, mean: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Return the direction of the largest projected area from which all normals have a draft of 10 degrees, by
    projection on a cone that is narrower by this along the direction of the step before; another one if there is
    none."""
    for _ in range(STEPS):
        narrower = normals - np.sin(np.radians(ENOUGH + WIDER)) * start
        start = unit(mean + narrower.T @ nnls(narrower.T, -mean)[0])
    return start
