# SPDX-License-Identifier: GPL-3.0-or-later
"""The sheet of a run as surfaces: its faces, outline, sections, and lines of nodes."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dd3.bound import bound_nodes, rings
from dd3.errors import Problem
from dd3.fields import Fields

AXES = "xyz"
LOWER, UPPER = np.arange(4), np.arange(4, 8)  # corners of a hexahedron in VTK's order
SHIFT = 1e-6  # of the sheet's size: planes through nodes are cut beside them


@dataclass
class Line:
    """Points of a sheet along a line, each between two nodes a and b at a fraction from a to b."""

    a: np.ndarray
    b: np.ndarray
    fraction: np.ndarray

    def at(self, values: np.ndarray) -> np.ndarray:
        """Interpolate values of nodes."""
        fraction = self.fraction.reshape(-1, *(1,) * (values.ndim - 1))
        return (1 - fraction) * values[self.a] + fraction * values[self.b]


class Sheet(Fields):
    """A run with the surfaces of its sheet, at each step those of its mesh; by default of the last step. Faces are
    given by their four corners, rings by all nodes around a face, also the bound ones on the edges of a larger
    element."""

    def __init__(self, run: str | Path) -> None:
        super().__init__(run)
        offsets = self.cells(0).offsets
        if np.unique(np.diff(offsets)).size != 1 or offsets[1] < 8:
            raise Problem(f"{self.path}: the cells are no hexahedra")
        self.bound_of: dict[int, dict[tuple[int, int], int]] = {}  # by the number of the mesh

    def elements(self, step: int = -1) -> np.ndarray:
        """Return the nodes of the elements, a row each."""
        nodes, offsets, _ = self.cells(step)
        return nodes.reshape(-1, offsets[1])

    def corners(self, step: int = -1) -> np.ndarray:
        """Return the corners of the elements (m, 8)."""
        return self.elements(step)[:, :8]

    def bound(self, step: int = -1) -> dict[tuple[int, int], int]:
        """Return the bound nodes by the ends of their edges."""
        number = self.mesh_number(step)
        if number not in self.bound_of:
            self.bound_of[number] = bound_nodes(self.corners(step), self.points(step))
        return self.bound_of[number]

    def faces(self, upper: bool = True, step: int = -1) -> np.ndarray:
        """Return the corners of the upper or the lower face of the sheet, counter-clockwise seen from outside."""
        mine, other = (UPPER, LOWER) if upper else (LOWER, UPPER)
        corners = self.corners(step)
        inner = {tuple(sorted(face)) for face in corners[:, other]}
        quads = np.array([face for face in corners[:, mine] if tuple(sorted(face)) not in inner])
        return quads if upper else quads[:, ::-1]

    def areas(self, step: int = -1) -> np.ndarray:
        """Return the initial areas of the nodes of a step, quarters of their faces on both sides of the sheet, mm2."""
        start, areas = self.start(step), np.zeros(self.size_of("Points", step))
        for upper in (True, False):
            faces = self.faces(upper, step)
            across = start[faces[:, 2:]] - start[faces[:, :2]]
            size = np.linalg.norm(np.cross(across[:, 0], across[:, 1]), axis=1) / 8
            np.add.at(areas, faces, size[:, None])
        return areas

    def rings(self, upper: bool = True, step: int = -1) -> list[list[int]]:
        """Return the nodes around the faces of the upper or the lower face of the sheet."""
        return rings(self.faces(upper, step), self.bound(step))

    def rim(self, upper: bool = True, step: int = -1) -> np.ndarray:
        """Return the nodes of the edges that belong to one face only, as rows of two."""
        edges = np.array([edge for ring in self.rings(upper, step) for edge in zip(ring, ring[1:] + ring[:1])])
        _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
        return edges[first[count == 1]]

    def outline(self, upper: bool = True, mirror: Sequence[str] = (), step: int = -1) -> list[np.ndarray]:
        """Return the lines of nodes around the sheet, without the edges on planes of symmetry."""
        start = self.start(step)
        edges = self.rim(upper, step)
        for axis in mirror:
            on = np.abs(start[:, AXES.index(axis)]) <= SHIFT * self.size()
            edges = edges[~on[edges].all(axis=1)]
        return [np.array(line) for line in chains([tuple(edge) for edge in edges])]

    def size(self) -> float:
        """Return the largest extent of the sheet at the start, mm."""
        return float(np.ptp(self.points(0), axis=0).max())

    def cut(self, normal: np.ndarray, distance: float, upper: bool = True, points: np.ndarray | None = None,
            step: int = -1) -> list[Line]:
        """Return the lines in which a plane cuts a face of the sheet, the longest first, in the mesh of a step.

        The plane is normal.x = distance; it cuts the initial shape unless other `points` are given.
        """
        points = self.start(step) if points is None else points
        around = self.rings(upper, step)
        for shift in (SHIFT, -SHIFT, 0.0):
            height = points @ np.asarray(normal, float) - distance - shift * self.size()
            lines = [self.edge_line(line, height) for line in chains(crossed(around, height))]
            if lines:
                return sorted(lines, key=lambda line: -length(line.at(points))[-1])
        raise Problem(f"{self.path}: the plane {plane_name(normal, distance)} does not cut the sheet")

    @staticmethod
    def edge_line(edges: Sequence[tuple[int, int]], height: np.ndarray) -> Line:
        """Return the line through points of edges."""
        a, b = np.array(edges).T
        return Line(a, b, height[a] / (height[a] - height[b]))

    def line_of_nodes(self, nodes: Sequence[int], step: int = -1) -> Line:
        """Return a line through nodes of the mesh of a step, given by their numbers from 1."""
        number, count = np.array(nodes, int) - 1, self.size_of("Points", step)
        if number.min() < 0 or number.max() >= count:
            raise Problem(f"{self.path}: the nodes are 1 to {count}")
        return Line(number, number, np.zeros(len(number)))


def crossed(around: Sequence[Sequence[int]], height: np.ndarray) -> list[tuple[Any, Any]]:
    """Return pairs of edges of rings that a plane crosses; an edge is the sorted pair of its nodes."""
    above = (height > 0).tolist()
    pairs: list[tuple[Any, Any]] = []
    for ring in around:
        edges = [tuple(sorted((ring[i], ring[i - 1]))) for i in range(len(ring))
                 if above[ring[i]] != above[ring[i - 1]]]
        pairs += zip(edges[::2], edges[1::2], strict=True)
    return pairs


def chains(pairs: Sequence[tuple[Any, Any]]) -> list[list[Any]]:
    """Join pairs of equal ends to chains; open chains begin at an end."""
    neighbours: dict[Any, list[Any]] = {}
    for a, b in pairs:
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    lines = []
    for start in sorted(neighbours, key=lambda end: (len(neighbours[end]), end)):
        line = [start]
        while neighbours[line[-1]]:
            following = neighbours[line[-1]].pop(0)
            neighbours[following].remove(line[-1])
            line.append(following)
        if len(line) > 1:
            lines.append(line)
    return lines


def length(points: np.ndarray) -> np.ndarray:
    """Return the length along a line of points, from 0."""
    return np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))


def of_pieces(lines: Sequence[Line], points: np.ndarray) -> str:
    """Return words on the longest of the pieces of a section, the first, which is used; none where it is alone."""
    return f"{len(lines)} pieces; the longest, {length(lines[0].at(points))[-1]:.4g} mm, is used" if lines[1:] else ""


def plane(text: str) -> tuple[np.ndarray, float]:
    """Return normal and distance of a plane: "y=0", or the angle from x of a plane through the z axis, in degrees."""
    axis, equals, value = text.replace(" ", "").partition("=")
    try:
        if equals and axis in AXES and axis:
            return np.eye(3)[AXES.index(axis)], float(value)
        angle = np.radians(float(text))
        return np.array([-np.sin(angle), np.cos(angle), 0.0]), 0.0
    except ValueError:
        raise Problem(f"plane '{text}': expected such as y=0, or an angle in degrees") from None


def plane_name(normal: np.ndarray, distance: float) -> str:
    """Return a plane as `plane` takes it, or its normal and distance."""
    axis = int(np.abs(normal).argmax())
    if np.allclose(normal, np.eye(3)[axis]):
        return f"{AXES[axis]}={distance:.6g}"
    if distance == 0.0 and normal[2] == 0.0:
        return f"at {np.degrees(np.arctan2(-normal[0], normal[1])):.6g} degrees"
    return f"with the normal {' '.join(f'{x:.4g}' for x in normal)} at {distance:.6g} mm"


def in_plane(points: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Return coordinates of points in the plane of a section: the horizontal direction and, if it lies in it, z."""
    up = np.eye(3)[2] if abs(normal[2]) < 0.9 else np.eye(3)[1]
    up = up - (up @ normal) * normal
    up /= np.linalg.norm(up)
    across = np.cross(normal, up)
    across *= np.sign(across[np.abs(across).argmax()])
    return np.column_stack([points @ across, points @ up])
