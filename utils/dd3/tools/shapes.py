# SPDX-License-Identifier: GPL-3.0-or-later
"""Tools without CAD, as exact rational patches: a profile of lines and arcs, extruded, revolved or led around a
rectangle; punch, die and holder of a box with rounded corners.

A shape file has blocks like an input file, and the parameters of *PARAMETER:

    *PROFILE shoulder
      axes = x z            # of the two coordinates
      start = 25 -40
      corner = 25 0 5       # a corner of the polygon, rounded by this radius
      line = 80 0
      extrude = -10 45      # from and to, along the third axis
    *PROFILE ball
      start = 0 -10
      arc = 10 0  0 0       # to a point, about a centre, the shorter way
      revolve = 0 90        # degrees, about the second axis, from the first one
      centre = 0 0          # place of that axis along the first and the third one
    *ROUNDED_BOX cup
      kind = die            # punch, die, holder
      half = 37 37          # half sizes of the punch or of the opening
      corner = 10           # radius in plan
      radius = 5            # of the profile
      depth = 60            # of the wall
      flange = 40           # width of the flat face around the opening
      quarter = 5           # x and y > -5 only
"""
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from dd3.errors import Problem
from dd3.tools.blocks import Block, read_blocks
from dd3.tools.joints import find_joints, orient, turn
from dd3.tools.surface import Surface, homogeneous, joined, turned

AXES = "xyz"
KINDS = ("punch", "die", "holder")
KEYS = {"profile": ("axes", "start", "line", "corner", "arc", "extrude", "revolve", "centre"),
        "rounded_box": ("kind", "half", "corner", "radius", "depth", "flange", "quarter", "centre")}
# Relative difference of lengths that count as equal.
EQUAL = 1e-9


@dataclass
class Segment:
    """A line, or an arc about a centre; anticlockwise if angle > 0 (radian)."""

    start: np.ndarray
    end: np.ndarray
    centre: np.ndarray | None = None
    angle: float = 0.0

    def direction(self, at_end: bool) -> np.ndarray:
        """Return the unit tangent at one of the ends."""
        if self.centre is None:
            along = self.end - self.start
        else:
            along = np.sign(self.angle) * perpendicular((self.end if at_end else self.start) - self.centre)
        return along / np.linalg.norm(along)


def perpendicular(vector: np.ndarray) -> np.ndarray:
    """Return the vector turned by 90 degrees anticlockwise."""
    return np.array([-vector[1], vector[0]])


def cross(a: np.ndarray, b: np.ndarray) -> float:
    """Return the third component of the product of two plane vectors."""
    return a[0] * b[1] - a[1] * b[0]


def arc(start: np.ndarray, end: np.ndarray, centre: np.ndarray, place: str) -> Segment:
    """Return the arc between two points about a centre, the shorter way."""
    a, b = start - centre, end - centre
    radius = float(np.linalg.norm(a))
    if abs(np.linalg.norm(b) - radius) > 1e-6 * max(radius, 1e-300):
        raise Problem(f"{place}: the ends of the arc are {radius:g} and {np.linalg.norm(b):g} mm from its centre")
    angle = np.arctan2(cross(a, b), a @ b)
    if not 1e-9 < abs(angle) < np.pi - 1e-9:
        raise Problem(f"{place}: expected an arc of less than 180 degrees")
    return Segment(start, end, centre, angle)


def rounded(before: np.ndarray, corner: np.ndarray, after: np.ndarray, radius: float, place: str
           ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the ends and the centre of the arc that rounds a corner of a polygon."""
    a, b = before - corner, after - corner
    lengths = np.linalg.norm(a), np.linalg.norm(b)
    if min(lengths) == 0.0:
        raise Problem(f"{place}: the corner coincides with a neighbour")
    a, b = a / lengths[0], b / lengths[1]
    half = np.arccos(np.clip(a @ b, -1, 1)) / 2
    if not 1e-6 < half < np.pi / 2 - 1e-9:
        raise Problem(f"{place}: the lines at the corner make no angle that can be rounded")
    back = radius / np.tan(half)
    if back > min(lengths) * (1 + EQUAL):
        raise Problem(f"{place}: a radius of {radius:g} needs {back:.6g} mm of both lines, which have "
                      f"{lengths[0]:.6g} and {lengths[1]:.6g}")
    middle = (a + b) / np.linalg.norm(a + b)
    return corner + back * a, corner + back * b, corner + radius / np.sin(half) * middle


def segments(steps: Sequence[tuple[str, Sequence[float], str]]) -> list[Segment]:
    """Return the segments of a profile: steps are keyword, numbers and place in the file."""
    if not steps or steps[0][0] != "start":
        raise Problem(f"{steps[0][2] if steps else 'profile'}: a profile begins with start")
    if len(steps) < 2 or steps[-1][0] == "corner":
        raise Problem(f"{steps[-1][2]}: a profile ends with a line or an arc")
    result, here = [], np.array(steps[0][1][:2])
    for i, (key, values, place) in enumerate(steps[1:], 1):
        point = np.array(values[:2])
        if key == "start":
            raise Problem(f"{place}: a profile has one start")
        if key == "arc":
            result.append(arc(here, point, np.array(values[2:]), place))
            here = point
            continue
        if key == "corner":
            if steps[i + 1][0] == "arc":
                raise Problem(f"{place}: a corner is followed by a line or another corner")
            first, last, centre = rounded(here, point, np.array(steps[i + 1][1][:2]), values[2], place)
            if np.linalg.norm(first - here) > EQUAL * np.linalg.norm(point - here):
                result.append(Segment(here, first))
            result.append(arc(first, last, centre, place))
            here = last
        elif np.linalg.norm(point - here) > 0.0:
            if i < 2 or np.linalg.norm(point - here) > EQUAL * np.linalg.norm(point):
                result.append(Segment(here, point))
            here = point
    if not result:
        raise Problem(f"{steps[0][2]}: the profile has no length")
    return result


def offset(profile: list[Segment], distance: float, place: str) -> list[Segment]:
    """Return the profile at a distance to its left; a gap at a convex corner is closed by an arc."""
    result: list[Any] = []
    for piece in profile:
        shift = [distance * perpendicular(piece.direction(at_end)) for at_end in (False, True)]
        moved = Segment(piece.start + shift[0], piece.end + shift[1], piece.centre, piece.angle)
        if piece.centre is not None:
            radius = np.linalg.norm(piece.start - piece.centre)
            left = radius - np.sign(piece.angle) * distance
            if left <= EQUAL * radius:
                raise Problem(f"{place}: an offset of {distance:g} mm leaves nothing of the radius {radius:g}")
        if result:
            close(result, moved, piece.start, distance, place)
        result.append(moved)
    return result


def close(result: list[Segment], moved: Segment, corner: np.ndarray, distance: float, place: str) -> None:
    """Join a segment of an offset profile to the ones before it."""
    before = result[-1]
    gap = np.linalg.norm(moved.start - before.end)
    if gap <= 1e-9 * abs(distance):
        moved.start = before.end
    elif cross(before.direction(True), moved.direction(False)) * distance > 0:
        raise Problem(f"{place}: no offset into the sharp corner {corner[0]:g} {corner[1]:g}; round it")
    else:
        result.append(arc(before.end, moved.start, corner, place))


def curve(profile: list[Segment]) -> np.ndarray:
    """Return the quadratic rational pieces (n, 3, 3) of a profile, homogeneous in the plane; arcs of 90 degrees at
    most."""
    pieces = []
    for piece in profile:
        if piece.centre is None:
            points = [piece.start, (piece.start + piece.end) / 2, piece.end]
            pieces.append(np.column_stack([points, np.ones(3)]))
            continue
        count = int(np.ceil(abs(piece.angle) / (np.pi / 2) - 1e-9))
        part = piece.angle / count
        ray = piece.start - piece.centre
        for i in range(count):
            ends = [ray * np.cos(a) + perpendicular(ray) * np.sin(a) for a in (i * part, (i + 1) * part)]
            first = piece.start if i == 0 else piece.centre + ends[0]
            last = piece.end if i == count - 1 else piece.centre + ends[1]
            middle = piece.centre + (ends[0] + ends[1]) / (2 * np.cos(part / 2)**2)
            weight = np.array([1, np.cos(part / 2), 1])
            pieces.append(np.column_stack([np.array([first, middle, last]) * weight[:, None], weight]))
    return np.array(pieces)


def extruded(pieces: np.ndarray, axes: Sequence[str], start: float, end: float) -> np.ndarray:
    """Return the patches of pieces (n, 3, 3) moved along the third axis; u along the profile."""
    first, second = (AXES.index(axis) for axis in axes)
    net = np.zeros((len(pieces), 3, 3, 4))
    net[..., first] = pieces[:, None, :, 0]
    net[..., second] = pieces[:, None, :, 1]
    net[..., 3 - first - second] = np.array([start, (start + end) / 2, end])[:, None] * pieces[:, None, :, 2]
    net[..., 3] = pieces[:, None, :, 2]
    return net


def revolved(pieces: np.ndarray, axes: Sequence[str], start: float, end: float, centre: Sequence[float] = (0.0, 0.0)
             ) -> np.ndarray:
    """Return the patches of pieces revolved about the second axis from one angle to another (degrees, from the first
    axis to the third); `centre` is the place of the axis."""
    first, second = (AXES.index(axis) for axis in axes)
    third = 3 - first - second
    count = int(np.ceil(abs(end - start) / 90 - 1e-9))
    angles = np.radians(np.linspace(start, end, count + 1))
    nets = []
    for a, b in pairwise(angles):
        weight = np.array([1, np.cos((b - a) / 2), 1])
        ring = np.array([[np.cos(a), np.sin(a)], np.array([np.cos(a) + np.cos(b), np.sin(a) + np.sin(b)])
                         / (2 * weight[1]**2), [np.cos(b), np.sin(b)]])
        ring[np.abs(ring) < 1e-16] = 0.0
        net = np.zeros((len(pieces), 3, 3, 4))
        net[..., 3] = weight[:, None] * pieces[:, None, :, 2]
        for axis, column, shift in ((first, 0, centre[0]), (third, 1, centre[1])):
            net[..., axis] = (weight * ring[:, column])[:, None] * pieces[:, None, :, 0] + shift * net[..., 3]
        net[..., second] = weight[:, None] * pieces[:, None, :, 1]
        nets.append(net)
    return np.concatenate(nets)


def rectangle(low: np.ndarray, high: np.ndarray, height: float) -> np.ndarray:
    """Return the flat patch between two corners in plan."""
    x, y = (np.linspace(a, b, 3) for a, b in zip(low, high))
    points = np.zeros((3, 3, 3))
    points[..., 0], points[..., 1], points[..., 2] = x, y[:, None], height
    return homogeneous(points)[None]


def led_around(pieces: np.ndarray, core: np.ndarray, beyond: float | None) -> np.ndarray:
    """Return the patches of a profile (distance outwards, height) led around a rectangle with half sizes `core`, its
    corners by arcs. With `beyond`, only the part x, y > -beyond."""
    a, b = core
    nets = []
    for k in range(1 if beyond is not None else 4):
        corner = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)][k]) * core
        nets.append(revolved(pieces, "xz", 90 * k, 90 * (k + 1), corner))
    for across, along, axes in ((a, b, "xz"), (b, a, "yz")):
        start = -along if beyond is None else -beyond
        if along - start <= EQUAL * max(a, b, 1.0):
            continue
        for sign in (1,) if beyond is not None else (1, -1):
            side = pieces.copy()
            side[..., 0] = sign * (side[..., 0] + across * side[..., 2])
            nets.append(extruded(side, axes, start, along))
    return np.concatenate(nets)


def box_profile(kind: str, box: dict[str, float], place: str) -> list[tuple[str, tuple[float, ...], str]]:
    """Return the steps of the profile of a box's tool: distance from the centre of the corners, height."""
    corner, radius = box["corner"], box["radius"]
    if kind == "punch":
        return [("start", (0.0, 0.0), place), ("corner", (corner, 0.0, radius), place),
                ("line", (corner, box["depth"]), place)]
    outer = corner + radius + box["flange"]
    if kind == "die":
        return [("start", (corner, -box["depth"]), place), ("corner", (corner, 0.0, radius), place),
                ("line", (outer, 0.0), place)]
    return [("start", (corner, 0.0), place), ("line", (corner + box["flange"], 0.0), place)]


def numbers(block: Block, key: str, count: int, place: str, default: Sequence[float] | None = None) -> list[float]:
    """Return the numbers of a key."""
    text = block.value(key)
    if text is None:
        if default is None:
            raise Problem(f"{place}: {key} is missing")
        return list(default)
    return parsed(text, count, f"{place}, {key}")


def parsed(text: str, count: int, place: str) -> list[float]:
    """Return a text's numbers."""
    try:
        values = [float(word) for word in text.split()]
    except ValueError:
        values = []
    if len(values) != count or not np.isfinite(values).all():
        raise Problem(f"{place}: expected {count} number{'s' if count > 1 else ''}, got '{text}'")
    return values


def make_profile(block: Block, place: str, distance: float) -> np.ndarray:
    """Return the surface of a *PROFILE."""
    axes = (block.value("axes") or "x z").split()
    if len(axes) != 2 or axes[0] == axes[1] or not set(axes) <= set(AXES):
        raise Problem(f"{place}, axes: expected two of x y z, got '{' '.join(axes)}'")
    counts = {"start": 2, "line": 2, "corner": 3, "arc": 4}
    steps = [(key, parsed(text, counts[key], f"{place}, {key}"), f"{place}, {key} = {text}")
             for key, text in block.values if key in counts]
    if any(key == "corner" and values[2] <= 0 for key, values, _ in steps):
        raise Problem(f"{place}, corner: expected a positive radius")
    profile = segments(steps)
    if distance:
        profile = offset(profile, distance, place)
    first, second = (AXES.index(axis) for axis in axes)
    ways = [key for key in ("extrude", "revolve") if block.value(key)]
    if len(ways) != 1:
        raise Problem(f"{place}: expected extrude or revolve")
    start, end = numbers(block, ways[0], 2, place)
    if start == end:
        raise Problem(f"{place}, {ways[0]}: expected two different values")
    # Led along increasing values of the third axis, the patches of right-handed axes have their normals on the left.
    left_handed = (second - first) % 3 == 1
    start, end = sorted((start, end), reverse=left_handed)
    if ways[0] == "extrude":
        return extruded(curve(profile), axes, start, end)
    if abs(end - start) > 360:
        raise Problem(f"{place}, revolve: more than 360 degrees")
    pieces = curve(profile)
    if pieces[..., 0].min() < -EQUAL * np.abs(pieces).max() < EQUAL * np.abs(pieces).max() < pieces[..., 0].max():
        raise Problem(f"{place}: the profile crosses the axis of revolution")
    return revolved(pieces, axes, start, end, numbers(block, "centre", 2, place, [0, 0]))


def make_box(block: Block, place: str, distance: float) -> np.ndarray:
    """Return the surface of a *ROUNDED_BOX."""
    kind = (block.value("kind") or "").lower()
    if kind not in KINDS:
        raise Problem(f"{place}, kind: expected {', '.join(KINDS)}, got '{kind}'")
    half = np.array(numbers(block, "half", 2, place))
    needed = {"punch": ("radius", "depth"), "die": ("radius", "depth", "flange"), "holder": ("flange",)}[kind]
    box = {key: numbers(block, key, 1, place, None if key in needed else [0.0])[0]
           for key in ("radius", "depth", "flange")}
    box["corner"] = numbers(block, "corner", 1, place)[0]
    if min(box[key] for key in (*needed, "corner")) <= 0:
        raise Problem(f"{place}: corner, {', '.join(needed)} are positive")
    if box["corner"] > half.min() * (1 + EQUAL):
        raise Problem(f"{place}: corner = {box['corner']:g} is larger than half = {half.min():g}")
    if kind == "punch" and box["radius"] > box["corner"] * (1 + EQUAL):
        raise Problem(f"{place}: radius = {box['radius']:g} of a punch is larger than corner = {box['corner']:g}")
    if box["depth"] < box["radius"]:
        raise Problem(f"{place}: depth = {box['depth']:g} is smaller than radius = {box['radius']:g}")
    beyond = numbers(block, "quarter", 1, place)[0] if block.value("quarter") else None
    profile = segments(box_profile(kind, box, place))
    # The left of the profile is the side of the sheet for a die only.
    if distance:
        profile = offset(profile, distance if kind == "die" else -distance, place)
    core = np.maximum(half - box["corner"], 0.0)
    nets = [led_around(curve(profile), core, beyond)]
    if kind == "punch" and core.min() > 0.0:
        low = -core if beyond is None else np.array([-beyond, -beyond])
        nets.append(rectangle(low, core, profile[0].start[1]))
    net = np.concatenate(nets)
    net[..., :3] += np.array(numbers(block, "centre", 3, place, [0, 0, 0])) * net[..., 3:]
    return net if kind == "die" else turned(net)


def read_shapes(path: Path, distances: Sequence[float] | None = None) -> Surface:
    """Return the surface of a shape file, a face for each block.

    Normals point to the left of a profile, and to the sheet for a box. With `distances`, a number for each face, the
    profiles are moved along these normals.
    """
    surfaces: list[Any] = []
    makers = {"profile": make_profile, "rounded_box": make_box}
    for block in read_blocks(path):
        if block.keyword == "parameter":
            continue
        place = f"{path}: *{block.keyword.upper()} {block.name}".rstrip()
        if block.keyword not in makers:
            raise Problem(f"{place}: expected *PROFILE, *ROUNDED_BOX or *PARAMETER")
        unknown = [key for key, _ in block.values if key not in KEYS[block.keyword]]
        if unknown:
            raise Problem(f"{place}: unknown key '{unknown[0]}'; there are {', '.join(KEYS[block.keyword])}")
        net = makers[block.keyword](block, place, distances[len(surfaces)] if distances is not None else 0.0)
        name = block.name or f"{block.keyword} {len(surfaces) + 1}"
        net = turn(net, orient(net, find_joints(net))[0])
        surfaces.append(Surface(net, np.zeros(len(net), int), [name]))
    if not surfaces:
        raise Problem(f"{path}: no *PROFILE and no *ROUNDED_BOX")
    return joined(surfaces)
