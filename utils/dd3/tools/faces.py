# SPDX-License-Identifier: GPL-3.0-or-later
"""Choice of faces of a CAD model: by number, with those that join them smoothly, or the side of a sheet."""
from collections import defaultdict
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from dd3.errors import Problem
from dd3.tools.nagata import groups
from dd3.tools.parameters import length_of

# Angle between the normals of two faces along their edge below which they join smoothly, degrees.
SMOOTH = 5.0
# Part of the largest height above which a side has walls; part of its area, projected, above which it has a floor.
WALLS, FLOOR = 0.5, 0.02
# Parts of an edge at which its faces are compared.
PLACES = np.array([0.2, 0.5, 0.8])


def numbers_of(words: Sequence[str]) -> list[int]:
    """Return the numbers of words such as 3 or 5-8; ValueError if they are none."""
    found: list[int] = []
    for word in " ".join(words).replace(",", " ").split():
        first, dash, last = word.partition("-")
        found += range(int(first), int(last if dash else first) + 1)
    return found


def chosen(gmsh: Any, path: Path, tags: list[int], words: Sequence[str] | None, smooth: bool) -> list[int]:
    """Return the faces of `tags` that the words name, with all that join them smoothly if wanted."""
    if not words:
        return tags
    try:
        wanted = numbers_of(words)
    except ValueError:
        raise Problem(f"{path}: --faces takes numbers and ranges such as 3 5-8, got '{' '.join(words)}'") from None
    missing = sorted(set(wanted) - set(tags))
    if missing:
        raise Problem(f"{path}: no face {', '.join(map(str, missing[:6]))}; there are {spans(tags)}, which --picture "
                      "shows")
    if not smooth:
        return sorted(set(wanted))
    return sorted({tag for group in smooth_groups(gmsh, tags) if group & set(wanted) for tag in group})


def spans(tags: Sequence[int]) -> str:
    """Return numbers as ranges."""
    ordered = sorted(tags)
    breaks = [0, *(i for i in range(1, len(ordered)) if ordered[i] != ordered[i - 1] + 1), len(ordered)]
    pairs = [(ordered[a], ordered[b - 1]) for a, b in pairwise(breaks)]
    return " ".join(f"{a}-{b}" if b > a else f"{a}" for a, b in pairs)


def smooth_groups(gmsh: Any, tags: list[int]) -> list[set[int]]:
    """Return the sets of faces that are connected by smooth edges."""
    faces = defaultdict(list)
    for tag in tags:
        for edge in {abs(edge) for _, edge in gmsh.model.getBoundary([(2, tag)], combined=False, oriented=False)}:
            faces[edge].append(tag)
    pairs = [pair for edge, pair in faces.items() if len(pair) == 2 and joins_smoothly(gmsh, edge, *pair)]
    place = {tag: i for i, tag in enumerate(tags)}
    index = np.array([[place[a], place[b]] for a, b in pairs], int).reshape(-1, 2)
    group = groups(len(tags), *index.T)
    return [{tags[i] for i in np.flatnonzero(group == number)} for number in range(int(group.max()) + 1)]


def joins_smoothly(gmsh: Any, edge: int, first: int, second: int) -> bool:
    """Tell whether the normals of two faces agree along their edge, up to their signs."""
    if not length_of(gmsh, edge):
        return False
    low, high = (bound[0] for bound in gmsh.model.getParametrizationBounds(1, edge))
    t = low + PLACES * (high - low)
    try:
        a, b = (np.reshape(gmsh.model.getNormal(tag, gmsh.model.reparametrizeOnSurface(1, edge, t, tag)), (-1, 3))
                for tag in (first, second))
    except Exception:  # an edge whose curve on the surface is missing
        return False
    return bool((np.abs((a * b).sum(axis=1)) > np.cos(np.radians(SMOOTH))).all())


def side_of_sheet(gmsh: Any, path: Path, tags: list[int], up: np.ndarray) -> list[int]:
    """Return, of the faces of a solid, the smoothly connected ones that look most in a direction, of those with walls
    and a floor: of a sheet one of its sides, of a block the side that is not flat."""
    found = smooth_groups(gmsh, tags)
    height = [extent(gmsh, group, up) for group in found]
    looks = [sum(projected(gmsh, tag, up) for tag in group) for group in found]
    area = [sum(gmsh.model.occ.getMass(2, tag) for tag in group) for group in found]
    sides = [i for i in range(len(found)) if height[i] > WALLS * max(height) and abs(looks[i]) > FLOOR * area[i]]
    if not sides:
        raise Problem(f"{path}: no faces that join smoothly have walls and a floor: choose those that one tool touches "
                      "by --faces; --picture shows their numbers")
    return sorted(found[max(sides, key=lambda i: looks[i])])


def extent(gmsh: Any, group: set[int], axis: np.ndarray) -> float:
    """Return the size of the boxes of faces along an axis, mm."""
    ends = np.array([gmsh.model.getBoundingBox(2, tag) for tag in group]).reshape(-1, 2, 3)
    corners = np.stack([ends[:, k, i] for i in range(3) for k in (0, 1)]).reshape(3, 2, -1)
    low, high = np.minimum(*(corners[:, k] * axis[:, None] for k in (0, 1))), np.maximum(
        *(corners[:, k] * axis[:, None] for k in (0, 1)))
    return float(high.sum(axis=0).max() - low.sum(axis=0).min())


def projected(gmsh: Any, tag: int, up: np.ndarray) -> float:
    """Return the area of a face projected along a direction, mm2, positive where its normal looks that way; estimated
    from its middle."""
    low, high = (np.array(bound) for bound in gmsh.model.getParametrizationBounds(2, tag))
    normal = np.array(gmsh.model.getNormal(tag, (low + high) / 2))
    return float(gmsh.model.occ.getMass(2, tag) * (normal @ up))
