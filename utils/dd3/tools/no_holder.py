# SPDX-License-Identifier: GPL-3.0-or-later
"""Tools of a part that no binder fits, which is formed between punch and die without a holder (crash forming).

Both tools go on beyond the rim of the part along its outward tangents, as ruled strips.
"""
from dataclasses import replace

import numpy as np

from dd3.errors import Problem
from dd3.tools import report
from dd3.tools.joints import find_joints, folded
from dd3.tools.plane import inside
from dd3.tools.rims import along_edges, chained, patches, unit
from dd3.tools.surface import Surface

# Slope of the tangents at the rim up to which strips along them carry the blank, degrees.
SHALLOW = 30.0


def outer_rim(surface: Surface) -> tuple[np.ndarray, np.ndarray]:
    """Return the nodes of the longest closed line of free edges of a surface with normals upwards, (2 n + 1, 3), mm,
    none without a closed line, and there the directions in which the surface goes on across its edges: to points at
    the distance 1 from both edges at a node."""
    joints = find_joints(surface.net)
    points, normals = along_edges(surface, joints.free)
    lines = [chain for chain, closed in chained(points, 1e-6 * joints.size) if closed]
    if not lines:
        return np.zeros((0, 3)), np.zeros((0, 3))
    chain = max(lines, key=lambda line: float(np.linalg.norm(np.diff(points[line], axis=1), axis=2).sum()))
    a, b, c = points[chain].transpose(1, 0, 2)
    start = unit(np.cross(4 * b - 3 * a - c, normals[chain, 0]))
    end = np.roll(unit(np.cross(3 * c - 4 * b + a, normals[chain, 2])), 1, axis=0)
    joined = (start + end) / (1.0 + (start * end).sum(axis=1, keepdims=True))
    # At the middles of edges the mean of both ends, in the tangent plane.
    mean, normal = (joined + np.roll(joined, -1, axis=0)) / 2, normals[chain, 1]
    return closed_line(a, b), closed_line(joined, mean - (mean * normal).sum(axis=1, keepdims=True) * normal)


def closed_line(ends: np.ndarray, middles: np.ndarray) -> np.ndarray:
    """Return the values at the nodes of edges (n, 3) in their order, the first ones again at the end."""
    return np.concatenate([np.stack([ends, middles], axis=1).reshape(-1, 3), ends[:1]])


def is_shallow(surface: Surface) -> bool:
    """Tell whether the tangents across the rim of a surface are level enough for strips that carry a blank."""
    slope = unit(outer_rim(surface)[1])[:, 2]
    return bool(len(slope) and np.abs(slope).max() < np.sin(np.radians(SHALLOW)))


def width_for(surface: Surface, border: np.ndarray, inset: float) -> float:
    """Return the width of the strips that go on below the border of a blank in plan (n, 2), and beyond it by a length,
    mm."""
    points, onward = outer_rim(surface)
    rim = points[:, :2]
    out = border[~inside(border, rim[:-1])]
    across = [np.linalg.norm(out - nearest_on(rim, out), axis=1).max()] if len(out) else [0.0]
    return float(max(across) + inset) / float(np.linalg.norm(unit(onward)[:, :2], axis=1).min())


def nearest_on(line: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return the points of a line (m, 2) that are nearest to points (n, 2)."""
    start, way = line[:-1], np.diff(line, axis=0)
    part = ((points[:, None] - start) * way).sum(axis=2) / np.maximum((way**2).sum(axis=1), 1e-300)
    foot = start + np.clip(part, 0.0, 1.0)[..., None] * way
    return np.asarray(foot[np.arange(len(points)), np.linalg.norm(foot - points[:, None], axis=2).argmin(axis=1)])


def continued(surface: Surface, width: float) -> Surface:
    """Return a surface with strips of a width along the tangents at its rim, mm."""
    points, onward = outer_rim(surface)
    strip = patches([points + part * width * onward for part in (0.0, 0.5, 1.0)])
    bent = folded(strip)
    if len(bent):
        raise Problem(f"the tools cannot go on by {width:.3g} mm beyond the rim of the part near x y z = "
                      f"{report.where(points[2 * int(bent[0])])}, which is hollow there: take a smaller --margin")
    face = np.concatenate([surface.face, np.full(len(strip), len(surface.names))])
    return replace(surface, net=np.concatenate([surface.net, strip]), face=face, names=[*surface.names, "strip"],
                   normals=None)
