# SPDX-License-Identifier: GPL-3.0-or-later
"""What a part is: a sheet with its thickness, its two sides and its rims, a surface, or a block."""
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from dd3.part.rays import Rays
from dd3.part.shape import Shape
from dd3.progress import doing
from dd3.tools.joints import signs

# Rays of the thickness, and the fewest of a face.
RAYS, FEWEST = 2000, 6
# Cosine between the normals of two points that face each other on both sides of a sheet; difference of thicknesses
# that count as equal, of a face of a sheet, and of all.
OPPOSITE, EQUAL, MEMBER = -0.9, 0.02, 0.25
# Fraction of a face that has to face another one to be across from it; least fraction of the area on one side.
SHARED, ONE_SIDED = 0.15, 0.2
# Thickness over that of the sheet up to which a face at another thickness may be of a side.
THICKER = 2.0
# Distance over the size of the part behind which a ray begins.
LEAST = 1e-4
# Of a sheet: least fraction of the area of its sides, of that at one thickness of the sides, and largest thickness over
# the square root of a side's area.
SHEET, UNIFORM, THICKEST = 0.6, 0.4, 0.3
# Curvature times thickness of a round bar, whose thickness is its diameter: -2; that of a sheet is above -1.
ROUND = -1.5
# Angle between all normals of a side up to which the part is flat, degrees.
FLAT = 0.5
# Diagonal and thickness below which, mm, the unit may be another.
TINY, THIN = 5.0, 0.1


@dataclass
class Sheet:
    """`kind` is sheet, surface or block; thickness, mm, and the fraction of the area, rims left out, that has it; the
    faces of both sides, of a surface or a block in the first, and of the rims; of a block whose walls have one
    thickness but branch, that thickness, mm."""

    kind: str
    thickness: float | None = None
    fraction: float = 0.0
    sides: tuple[list[int], list[int]] = ([], [])
    rims: list[int] = field(default_factory=list)
    walls: float | None = None


def apart(shape: Shape, rays: Rays) -> float | None:
    """Return the distance, mm, at which most of the faces of an open shell face each other as both sides of a sheet,
    None if they do not."""
    chosen, weight = samples(shape, shape.tags)
    for sign in (-1.0, 1.0):  # it has no outside
        hits = rays.hits(chosen, sign * shape.normal[chosen], LEAST * shape.size)
        faces = (shape.normal[chosen] * hits.normal).sum(axis=1) < OPPOSITE
        distance = most_common(hits.distance[faces], weight[faces])
        if not np.isfinite(distance):
            continue
        at = faces & (np.abs(hits.distance - distance) <= EQUAL * distance)
        if weight[at].sum() > SHEET * weight.sum() and distance < THICKEST * np.sqrt(weight.sum() / 2):
            return distance
    return None


def samples(shape: Shape, faces: Iterable[int], count: int = RAYS) -> tuple[np.ndarray, np.ndarray]:
    """Return triangles of faces, about `count` spread by area and a few of each, and the areas they stand for."""
    total = sum(shape.areas[tag] for tag in faces)
    chosen, weights = [], []
    for tag in faces:
        own = shape.cells[tag]
        wanted = min(len(own), max(FEWEST, int(np.ceil(count * shape.areas[tag] / total))))
        part = own[np.unique(np.linspace(0, len(own) - 1, wanted).astype(int))]
        chosen.append(part)
        weights.append(shape.area[part] * shape.areas[tag] / max(shape.area[part].sum(), 1e-300))
    return np.concatenate(chosen), np.concatenate(weights)


@doing("looking for the sides of the sheet")
def read_sheet(shape: Shape, rays: Rays) -> Sheet:
    """Return what a part is."""
    if not shape.closed:
        return Sheet("surface", sides=(shape.tags, []))
    chosen, weight = samples(shape, shape.tags)
    hits = rays.hits(chosen, -shape.normal[chosen], LEAST * shape.size)
    distance = hits.distance
    faces = (shape.normal[chosen] * hits.normal).sum(axis=1) < OPPOSITE
    thickness = most_common(distance[faces], weight[faces])
    at = faces & (np.abs(distance - thickness) <= MEMBER * thickness)
    here, there = shape.face[chosen[at]], shape.face[hits.triangle[at]]
    curvature = shape.curvature[chosen[at]].min(axis=1)
    if weight[at][curvature * thickness < ROUND].sum() > weight[at].sum() / 2:  # a bar
        return Sheet("block", sides=(shape.tags, []))
    sides = mostly(shape, chosen, weight, at)
    across = through_thickness(shape, here, there)
    sides = [tag for tag in sides if tag not in across]
    area = sum(shape.areas[tag] for tag in sides)
    if area < SHEET * sum(shape.areas.values()) or thickness > THICKEST * np.sqrt(area / 2):
        return Sheet("block", sides=(shape.tags, []))
    equal = faces & (np.abs(distance - thickness) <= EQUAL * thickness)
    of_sides = np.isin(shape.face[chosen], sides)
    fraction = float(weight[equal & of_sides].sum() / weight[of_sides].sum())
    if fraction < UNIFORM:
        return Sheet("block", sides=(shape.tags, []))
    near = mostly(shape, chosen, weight, distance <= THICKER * thickness)
    joined = joined_to(shape, sides, set(near) - set(sides) - across, here, there)
    joined += walls_of_steps(shape, sides + joined, here, there, thickness)
    first, second = two_sides(shape, sides + joined, here, there, weight[at])
    if min(sum(shape.areas[tag] for tag in side) for side in (first, second)) < ONE_SIDED * area:
        return Sheet("block", sides=(shape.tags, []), walls=thickness)
    return Sheet("sheet", thickness, fraction, (first, second),
                 [tag for tag in shape.tags if tag not in sides and tag not in joined])


def joined_to(shape: Shape, sides: list[int], others: set[int], here: np.ndarray, there: np.ndarray) -> list[int]:
    """Return those of other faces, at another thickness, that are of one side of the sheet, such as fillets whose radii
    do not differ by the thickness, and walls that are thinned: groups of them that join parts of the side, or go on
    smoothly from several of its faces and to nothing else. Groups that join two faces which face each other, `here` and
    `there` by samples, are rims."""
    facing, found = set(zip(here.tolist(), there.tolist())), list[int]()
    part = {tag: number for number, group in enumerate(shape.components(sides)) for tag in group}
    smooth: defaultdict[int, set[int]] = defaultdict(set)
    for edge in shape.edges.values():
        if len(edge.faces) == 2 and not edge.angle:
            for tag in edge.faces:
                smooth[tag] |= set(edge.faces)
    for group in shape.components(others):
        beside = set().union(*(shape.neighbours[tag] for tag in group)) & set(sides)
        onward = set().union(*(smooth[tag] for tag in group)) - group
        joins = len({part[tag] for tag in beside}) > 1 or (len(onward) > 1 and onward <= set(sides))
        if joins and not any((a, b) in facing for a in beside for b in beside):
            found += sorted(group)
    return found


def walls_of_steps(shape: Shape, sides: list[int], here: np.ndarray, there: np.ndarray, thickness: float) -> list[int]:
    """Return the walls of steps that are lower than two thicknesses, which face each other over less than half of their
    height: groups of faces at parts of one side only, where the parts across from these, `here` and `there` by samples,
    are one, or have another group of such faces nearby. A rim lies between parts that are across from each other."""
    part = {tag: number for number, group in enumerate(shape.components(sides)) for tag in group}
    facing = np.zeros((len(set(part.values())),) * 2)
    for a, b in zip(here.tolist(), there.tolist()):
        if a in part and b in part:
            facing[part[a], part[b]] += 1
    groups = [sorted(group) for group in shape.components(set(shape.tags) - set(sides))]
    between = [{part[tag] for tag in set().union(*(shape.neighbours[tag] for tag in group)) & part.keys()}
               for group in groups]
    across = [{int(facing[number].argmax()) for number in parts} for parts in between]
    corners = [shape.nodes[shape.triangles[shape.of(group)]].reshape(-1, 3) for group in groups]
    boxes = [(points.min(axis=0) - thickness, points.max(axis=0) + thickness) for points in corners]

    def near(i: int, j: int) -> bool:
        return bool((boxes[i][0] < boxes[j][1]).all() and (boxes[j][0] < boxes[i][1]).all())

    return [tag for i, (group, parts, others) in enumerate(zip(groups, between, across)) if not others & parts
            and ((len(parts) > 1 and len(others) == 1)
                 or any(between[k] == others and near(i, k) for k in range(len(groups)))) for tag in group]


def through_thickness(shape: Shape, here: np.ndarray, there: np.ndarray) -> set[int]:
    """Return the faces beside two larger ones that face each other, `here` and `there` by samples, which are rims, even
    if they face others at the distance of the sides, as across a slot or a narrow arm."""
    found: set[int] = set()
    for a, b in {(a, b) for a, b in zip(here.tolist(), there.tolist()) if a < b}:
        larger = min(shape.areas[a], shape.areas[b])
        found |= {tag for tag in shape.neighbours[a] & shape.neighbours[b] if shape.areas[tag] < larger}
    return found


def mostly(shape: Shape, chosen: np.ndarray, weight: np.ndarray, true: np.ndarray) -> list[int]:
    """Return the faces of which more than half of the area, by its samples, has a property."""
    face, place = np.unique(shape.face[chosen], return_inverse=True)
    having = np.bincount(place, weight * true) > 0.5 * np.bincount(place, weight)
    return [int(tag) for tag in face[having]]


def most_common(values: np.ndarray, weights: np.ndarray) -> float:
    """Return the median of the values within EQUAL of each other that have the largest weight, inf without values."""
    order = np.argsort(values)
    values, total = values[order], np.concatenate([[0.0], np.cumsum(weights[order])])
    if not len(values):
        return np.inf
    last = np.searchsorted(values, values * (1 + EQUAL), side="right")
    first = int((total[last] - total[:-1]).argmax())
    half = (total[first] + total[last[first]]) / 2
    return float(values[max(int(np.searchsorted(total, half)) - 1, 0)])


def two_sides(shape: Shape, faces: list[int], here: np.ndarray, there: np.ndarray, weight: np.ndarray
             ) -> tuple[list[int], list[int]]:
    """Return the faces of both sides of a sheet: neighbours are on the same side, faces that face each other, `here`
    and `there` by samples with weights, on different ones. Where these contradict, all are in the first."""
    place = {tag: i for i, tag in enumerate(faces)}
    same = [(place[a], place[b]) for a in faces for b in shape.neighbours[a] if b in place and a < b]
    shared: defaultdict[tuple[int, int], float] = defaultdict(float)
    for a, b, area in zip(here.tolist(), there.tolist(), weight.tolist()):
        if a in place and b in place and a != b:
            shared[a, b] += area
    across = [(place[a], place[b]) for (a, b), area in shared.items() if area > SHARED * shape.areas[a]]
    joined = np.array([*same, *across], int).reshape(-1, 2)
    sign, _, _ = signs(len(faces), joined[:, 0], joined[:, 1], np.arange(len(joined)) < len(same))
    return ([tag for tag, s in zip(faces, sign) if s > 0], [tag for tag, s in zip(faces, sign) if s < 0])


def is_flat(shape: Shape, sheet: Sheet) -> bool:
    """Tell whether nothing is formed: a sheet or surface with one side in a plane; the other may have countersinks."""
    return sheet.kind != "block" and any(is_plane(shape, side) for side in sheet.sides if side)


def is_plane(shape: Shape, side: list[int]) -> bool:
    """Tell whether the normals of a side are one and its faces in one plane."""
    chosen = shape.of(side)
    mean = shape.normal[chosen[shape.area[chosen].argmax()]]
    level = shape.place[chosen] @ mean
    return bool(((shape.normal[chosen] @ mean) > np.cos(np.radians(FLAT))).all()
                and np.ptp(level) < np.sin(np.radians(FLAT)) * shape.size)
