# SPDX-License-Identifier: GPL-3.0-or-later
"""Faces of a drawn part by what they are for: floor, walls, shoulder, flange, radii between them."""
from dataclasses import dataclass

import numpy as np

from dd3.part.directions import Direction
from dd3.part.loops import Loop
from dd3.part.shape import Shape

# Draft above which a face is level, and the turn of its draft over a radius, degrees.
LEVEL, TURN = 45.0, 8.0
# Radius over the size of the part above which a curved face is no radius between others.
LARGE = 0.12
# Curvature times the size below which a face is flat.
FLAT = 0.05


@dataclass
class Role:
    """What a face of the upper side is for; least radius, mm, positive where its centre is above it, inf if it is flat;
    least and largest draft, degrees; mean height along the press direction, mm."""

    name: str
    radius: float
    draft: tuple[float, float]
    height: float


def least_radius(shape: Shape, tag: int) -> float:
    """Return the least radius of a face, of 95 % of its sample points, mm, positive where the centre is on the side of
    its normals, inf for a flat face."""
    curvature = shape.curvature[shape.cells[tag]]
    values = [float(np.quantile(curvature[:, 0], 0.05)), float(np.quantile(curvature[:, 1], 0.95))]
    largest = max(values, key=abs)
    return 1 / largest if abs(largest) * shape.size > FLAT else np.inf


def draft_range(shape: Shape, direction: Direction, tag: int) -> tuple[float, float]:
    """Return the least and the largest draft of a face, degrees, by the normals at the corners of its triangles too."""
    own = shape.cells[tag]
    sign = direction.facing if tag in direction.upper else -direction.facing
    level = np.concatenate([shape.corner_normal[own].reshape(-1, 3), shape.normal[own]]) @ direction.vector
    draft = np.degrees(np.arcsin(np.clip(sign * level, -1, 1)))
    return float(draft.min()), float(draft.max())


def read_roles(shape: Shape, direction: Direction, outer: Loop | None) -> dict[int, Role]:
    """Return what the faces of the upper side are for."""
    roles = {}
    for tag in direction.upper:
        own = shape.cells[tag]
        draft, area = direction.draft[own], shape.area[own]
        radius = direction.facing * least_radius(shape, tag)
        mean = float(np.degrees(np.arcsin(np.clip(np.average(np.sin(np.radians(draft)), weights=area), -1, 1))))
        turn = float(np.ptp(draft_range(shape, direction, tag)))
        if abs(radius) < LARGE * shape.size and turn > TURN:
            name = "bottom radius" if radius > 0 else "shoulder"
        elif abs(radius) < LARGE * shape.size and mean < LEVEL:
            name = "corner"
        else:
            name = "level" if mean >= LEVEL else "wall"
        roles[tag] = Role(name, radius, draft_range(shape, direction, tag),
                          float(shape.centres[tag] @ direction.vector))
    level = [tag for tag, role in roles.items() if role.name == "level"]
    for group in shape.components(level):
        name = level_name(shape, roles, group, outer, direction.vector)
        for tag in group:
            roles[tag].name = name
    return roles


def level_name(shape: Shape, roles: dict[int, Role], group: set[int], outer: Loop | None, up: np.ndarray) -> str:
    """Return the name of connected level faces: floor where the faces around it rise, flange where they fall and the
    rim of the part is beside it, island where they fall, step otherwise. A face beside the rim that only hollow radii
    join, as a leg of a V, is a wall, and one between two parts of the rim, as the crest of a corrugation, an island."""
    around = rises(shape, group, set(roles), up)
    at_rim = outer is not None and bool(group & set(outer.faces))
    area = sum(shape.areas[tag] for tag in group)
    if not around or min(around.values()) > 0:
        return "floor"
    if max(around.values()) < 0:
        hollow = all(roles[tag].name == "bottom radius" for tag in around)
        rest = shape.components(set(roles) - group) if outer is not None else []
        between = sum(bool(part & set(outer.faces)) for part in rest) > 1 if outer is not None else False
        return "island" if between or not at_rim else "wall" if hollow else "flange"
    return "floor" if area > 0.5 * sum(shape.areas[tag] for tag in roles) else "step"


def rises(shape: Shape, group: set[int], faces: set[int], up: np.ndarray) -> dict[int, float]:
    """Return by how much the centroids of the faces beside a group are above their edges with it, mm: the mean height
    of these, whose pieces are cubics with tangents across the normals at their ends."""
    own = shape.of(sorted(group))
    cell, side = np.nonzero(shape.piece_of[own] >= 0)
    piece, following = shape.piece_of[own[cell], side], (side + 1) % 3
    ends = shape.nodes[np.stack([shape.triangles[own[cell], side], shape.triangles[own[cell], following]])]
    chord = ends[1] - ends[0]
    bent = [-(chord * normal).sum(axis=1) * (normal @ up) for normal in
            (shape.corner_normal[own[cell], side], shape.corner_normal[own[cell], following])]
    height = ends.mean(axis=0) @ up + (bent[0] - bent[1]) / 12
    length = np.linalg.norm(chord, axis=1)
    found: dict[int, float] = {}
    for tag in sorted(set().union(*(shape.neighbours[tag] for tag in group)) & faces - group):
        beside = np.isin(piece, shape.piece_of[shape.cells[tag]])
        edge = float(length[beside] @ height[beside]) / max(float(length[beside].sum()), 1e-300)
        found[tag] = float(shape.centres[tag] @ up) - edge
    return found


def inner_and_outer_radius(shape: Shape, sides: tuple[list[int], list[int]]
                          ) -> tuple[tuple[float, int], tuple[float, int]]:
    """Return the least radius inside the bends of both sides and that outside, mm, 0 for a sharp edge, each with its
    face or edge, inf and 0 without; the same for both if one of the sides has no faces."""
    found = [(np.inf, 0), (np.inf, 0)]
    for side in sides:
        for tag in side:
            radius = least_radius(shape, tag)
            where = int(radius < 0)
            found[where] = min(found[where], (abs(radius), tag))
        for number, edge in shape.edges_inside(side).items():
            if edge.angle:
                where = int(edge.angle > 0)
                found[where] = min(found[where], (0.0, number))
    return (found[0], found[1]) if all(sides) else (min(found), min(found))
