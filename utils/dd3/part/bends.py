# SPDX-License-Identifier: GPL-3.0-or-later
"""Bends: whether a part is formed by bending along straight lines alone, without strain in its plane."""
from dataclasses import dataclass

import numpy as np

from dd3.part.shape import Shape, unit

# Smaller principal curvature times the size of the part up to which a face is developable.
DEVELOPABLE = 0.05
# Curvature times the size up to which a face is flat.
FLAT = 0.05
# Angle between the normals of a bend below which it is none, degrees.
LEAST = 2.0
# Cosine between two lines that are one, and their distance over the radius.
ALONG, ABOUT = 0.9999, 0.05


@dataclass
class Bend:
    """A bend of one side: faces, or the edge where it is sharp; angle, degrees; radius of that side, mm, negative where
    the side is the outer one; unit vector and a point of its line."""

    faces: list[int]
    edge: int | None
    angle: float
    radius: float
    axis: np.ndarray
    centre: np.ndarray


def find_bends(shape: Shape, faces: list[int]) -> list[Bend]:
    """Return the bends of a side whose faces are flat, or bent along straight lines between flat ones; none if it is
    formed in another way."""
    flat: list[int] = []
    bent: list[int] = []
    for tag in faces:
        curvature = np.abs(shape.curvature[shape.cells[tag]]) * shape.size
        if curvature.min(axis=1).max() > DEVELOPABLE:
            return []
        (flat if curvature.max() <= FLAT else bent).append(tag)
    inner = shape.edges_inside(faces)
    curved = [edge for edge in inner.values() if not edge.straight and (edge.angle or not set(edge.faces) <= set(flat))]
    if not flat or curved or at_vertex(shape, inner):
        return []
    found = [bend_of(shape, sorted(group)) for group in shape.components(bent)]
    found += [Bend([], number, abs(edge.angle), 0.0, *line_of(shape, number)) for number, edge in inner.items()
              if edge.angle]
    found = [bend for bend in found if bend.angle >= LEAST]
    # A bend goes from rim to rim, with a flat face on each side.
    return joined(found) if all(bend.edge or beside(shape, bend.faces, flat) == 2 for bend in found) else []


def joined(bends: list[Bend]) -> list[Bend]:
    """Return bends of which those about one line, as on both sides of a hole, are one."""
    found: list[Bend] = []
    for bend in bends:
        same = next((one for one in found if bend.faces and abs(one.axis @ bend.axis) > ALONG and np.linalg.norm(
            np.cross(one.centre - bend.centre, bend.axis)) < ABOUT * abs(bend.radius)), None)
        if same:
            same.faces += bend.faces
        else:
            found.append(bend)
    return found


def beside(shape: Shape, group: list[int], flat: list[int]) -> int:
    """Return the number of flat faces beside the faces of a bend, 2 for more."""
    return min(2, len(set().union(*(shape.neighbours[tag] for tag in group)) & set(flat)))


def at_vertex(shape: Shape, inner: dict) -> bool:
    """Tell whether sharp edges meet at a node inside the side, which is then no developable one."""
    sharp = [number for number, edge in inner.items() if edge.angle]
    ends = [ends_of(shape, number) for number in sharp]
    met = [node for pair in ends for node in pair]
    return any(met.count(node) > 2 for node in set(met))


def ends_of(shape: Shape, edge: int) -> list[int]:
    """Return the nodes at the ends of an edge."""
    nodes, count = np.unique(shape.pieces[shape.piece_edge == edge], return_counts=True)
    return [int(node) for node in nodes[count == 1]]


def line_of(shape: Shape, edge: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the unit vector along an edge and a point of it."""
    a, b = ends_of(shape, edge)
    return unit(shape.nodes[b] - shape.nodes[a]), shape.nodes[a]


def bend_of(shape: Shape, group: list[int]) -> Bend:
    """Return the bend of curved faces: its angle is that between the outermost normals."""
    own = shape.of(group)
    normal = shape.corner_normal[own].reshape(-1, 3)
    axis = np.linalg.eigh(normal.T @ normal)[1][:, 0]
    mean = unit(normal.sum(axis=0))
    turned = np.degrees(np.arctan2(normal @ np.cross(axis, mean), normal @ mean))
    curvature = shape.curvature[own]
    largest = curvature[np.arange(len(own)), np.abs(curvature).argmax(axis=1)]
    radius = float(1 / np.median(largest))
    return Bend(group, None, float(np.ptp(turned)), radius, axis, shape.place[own[0]] + radius * shape.normal[own[0]])
