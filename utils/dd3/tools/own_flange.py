# SPDX-License-Identifier: GPL-3.0-or-later
"""The flange that a part has itself, on the patches of a tool: which these are, and where it joins the rest."""
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from dd3.tools.joints import find_joints
from dd3.tools.nagata import groups
from dd3.tools.surface import Surface, areas_at, points_at


@dataclass
class Trimmed:
    """A surface without its flange: what is left, the edges of it, patch * 4 + edge, at which the flange joined it, and
    the connected parts of the flange."""

    surface: Surface
    border: np.ndarray
    flanges: list[Surface]


def labels_of(surface: Surface, roles: list[str], shoulder: bool) -> set[int]:
    """Return the faces of a flange by the roles of the faces, on request with those of the shoulders beside it."""
    found = {face for face, role in enumerate(roles) if role == "flange"}
    if not shoulder:
        return found
    joints = find_joints(surface.net)
    pairs = np.unique(surface.face[np.stack([joints.first, joints.second]) // 4], axis=1).T.tolist()
    # A fillet of a sharp edge has no role: along the flange it is a shoulder, between walls none.
    along = {b for pair in pairs for a, b in (pair, pair[::-1]) if a in found and not roles[b]}
    beside = along | {face for face, role in enumerate(roles) if role == "shoulder"}
    new = found
    while new:
        new = {b for pair in pairs for a, b in (pair, pair[::-1]) if a in new and b in beside} - found
        found = found | new
    return found


def trimmed(surface: Surface, faces: Iterable[int]) -> Trimmed:
    """Return a surface without faces."""
    joints = find_joints(surface.net)
    gone = np.isin(surface.face, list(faces))
    first, second = joints.first // 4, joints.second // 4
    border = np.concatenate([joints.first[gone[second] & ~gone[first]], joints.second[gone[first] & ~gone[second]]])
    number = np.cumsum(~gone) - 1
    inside = gone[first] & gone[second]
    place = np.cumsum(gone) - 1
    part = groups(int(gone.sum()), place[first[inside]], place[second[inside]])
    whole = surface.select(gone)
    return Trimmed(surface.select(~gone), np.sort(4 * number[border // 4] + border % 4),
                   [whole.select(part == one) for one in np.unique(part)])


def least_radius(surface: Surface, faces: Iterable[int]) -> float:
    """Return the least radius of faces, mm, by the turn of the normal across the middles of their patches; inf of
    flat ones."""
    net = surface.net[np.isin(surface.face, list(faces))]
    found = [np.inf]
    for u, v in (((0.0, 1.0), (0.5, 0.5)), ((0.5, 0.5), (0.0, 1.0))):
        point, area = points_at(net, np.array(u), np.array(v)), areas_at(net, np.array(u), np.array(v))
        normal = area / np.maximum(np.linalg.norm(area, axis=2, keepdims=True), 1e-300)
        turn = np.linalg.norm(normal[:, 1] - normal[:, 0], axis=1)
        length = np.linalg.norm(point[:, 1] - point[:, 0], axis=1)
        found += (length / np.maximum(turn, 1e-9 * length)).tolist()
    return float(min(found))
