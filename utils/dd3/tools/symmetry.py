# SPDX-License-Identifier: GPL-3.0-or-later
"""The half or the quarter of a part on one side of its planes of symmetry, x, y > 0 in the coordinates of the tools."""
from collections.abc import Iterable, Sequence

import numpy as np

from dd3.errors import Problem
from dd3.tools.moved import rotation
from dd3.tools.settings import ToolSettings

AXES = "xy"
# Distance of a plane from x = 0 or y = 0 over the size of the part, and its angle from them, rad, at most.
AT_ZERO, ALONG = 1e-4, 1e-4
SUPPORT = """*SET symmetry_{axis}
  plane = {axis} 0

*BOUNDARY symmetry_{axis}
  set = symmetry_{axis}
  fix = {axis}

"""


def mirrors_of(planes: Iterable[tuple[np.ndarray, float]], size: float, options: ToolSettings) -> tuple[int, ...]:
    """Return the axes of the tools, 0 and 1, normal to which a plane of symmetry of the part passes through 0; `planes`
    have the unit normal and the distance from the origin of the file, mm. With `symmetric` there is one or an error."""
    found, elsewhere = [], []
    for normal, distance in planes:
        turned = rotation(options.rotate) @ normal
        axis = int(np.abs(turned).argmax())
        place = np.sign(turned[axis]) * (distance + turned @ np.array(options.move))
        if axis > 1 or abs(turned[axis]) < 1 - ALONG**2 / 2:
            continue
        if abs(place) <= AT_ZERO * size:
            found.append(axis)
        else:
            elsewhere.append((axis, place))
    if options.symmetric and options.faces:
        raise Problem("--symmetric goes with the faces of the whole part, not with --faces")
    if options.symmetric and not found:
        move = np.array(options.move, float)
        for axis, place in elsewhere:
            move[axis] -= place
        raise Problem("--symmetric: x = 0 and y = 0 are no planes of symmetry of the part" + (
            "; they are with --move " + " ".join(f"{value + 0.0:.6g}" for value in move.round(6)) if elsewhere else ""))
    return tuple(sorted(found))


def ends_at(options: ToolSettings) -> tuple[int, ...]:
    """Return the axes normal to the planes at which the input file ends."""
    return options.mirrors if options.symmetric else ()


def supports(axes: Sequence[int]) -> str:
    """Return the supports of the nodes on planes of symmetry."""
    return "".join(SUPPORT.format(axis=AXES[axis]) for axis in axes)


def said(options: ToolSettings) -> str:
    """Return the planes, and what of the part is computed, in words; empty without planes."""
    if not options.mirrors:
        return ""
    part = ("half", "quarter")[len(options.mirrors) - 1]
    planes = " and ".join(f"{AXES[axis]} = 0" for axis in options.mirrors)
    side = ", ".join(AXES[axis] for axis in options.mirrors)
    return f"{planes}: " + (f"the {part} {side} > 0 is computed" if options.symmetric
                            else f"--symmetric computes the {part} {side} > 0")


def mirrored(curve: np.ndarray, axes: Sequence[int], tolerance: float) -> np.ndarray | None:
    """Return a closed curve (n, 2 or 3) that crosses planes through 0 as its part on the positive side with the mirror
    image of that; None for one on the other side. Coordinates up to the tolerance are on the plane."""
    for axis in axes:
        height = np.where(np.abs(curve[:, axis]) <= tolerance, 0.0, curve[:, axis])
        kept = height > 0
        if not kept.any():
            return None
        if (height >= 0).all():
            continue
        starts = np.flatnonzero(kept & ~np.roll(kept, 1))
        if len(starts) > 1:
            raise Problem(f"--symmetric: a curve of the part or of its blank meets {AXES[axis]} = 0 at more than two "
                          "places")
        order = np.roll(np.arange(len(curve)), -starts[0])
        chain, last = curve[order[kept[order]]], order[kept.sum()]
        ends = [on_plane(curve[order[-1]], chain[0], axis), on_plane(curve[last], chain[-1], axis)]
        half = np.vstack([ends[0], chain, ends[1]])
        image = half[-2:0:-1].copy()
        image[:, axis] *= -1
        curve = np.vstack([half, image])
    return curve


def on_plane(beyond: np.ndarray, inside: np.ndarray, axis: int) -> np.ndarray:
    """Return the point of a line where a coordinate is 0."""
    part = inside[axis] / (inside[axis] - min(beyond[axis], 0.0))
    point = inside + part * (beyond - inside)
    point[axis] = 0.0
    return np.asarray(point)
