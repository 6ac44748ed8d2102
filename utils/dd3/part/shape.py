# SPDX-License-Identifier: GPL-3.0-or-later
"""A part as triangles with the exact normals and curvatures of its CAD faces.

The triangles are coarse and share their nodes along the edges of the CAD: they serve as sample points, for rays, for
the picture and for the courses of edges. Tools are not made of them.
"""
from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

# Angle between the normals of two faces along their edge above which the edge is sharp, degrees.
SHARP = 3.0


@dataclass
class Edge:
    """An edge of the CAD: length, mm, faces beside it, whether it is straight, and the angle between its faces,
    degrees: positive where it is convex seen from the side of the normals, 0 where they join smoothly."""

    length: float
    straight: bool
    faces: list[int] = field(default_factory=list)
    angle: float = 0.0


@dataclass
class Shape:
    """Nodes (n, 3), mm; triangles (m, 3), their faces (m,), areas (m,) and unit normals at their corners (m, 3, 3). At
    a point of each on the CAD: place (m, 3), unit normal (m, 3), principal curvatures (m, 2), 1/mm, positive where the
    centre is on the side of the normal.

    The triangles of a body have one orientation, those of a closed body look outwards. Faces and edges go by the tags
    of Gmsh: `kinds` are the kinds of the faces' surfaces, `areas` their areas, mm2, and `centres` their centroids.
    Edges are divided into pieces: their nodes (k, 2), their edges (k,), and for each side of a triangle, node k to k +
    1, the piece on it (m, 3), -1 inside a face.
    """

    nodes: np.ndarray
    triangles: np.ndarray
    face: np.ndarray
    area: np.ndarray
    corner_normal: np.ndarray
    place: np.ndarray
    normal: np.ndarray
    curvature: np.ndarray
    kinds: dict[int, str]
    areas: dict[int, float]
    centres: dict[int, np.ndarray]
    edges: dict[int, Edge]
    pieces: np.ndarray
    piece_edge: np.ndarray
    piece_of: np.ndarray
    body: np.ndarray  # of the triangles (m,)
    closed: bool
    failed: list[int] = field(default_factory=list)
    rims: dict[tuple[int, ...], Any] = field(default_factory=dict)  # of sets of faces, once they were asked for

    @cached_property
    def tags(self) -> list[int]:
        """Return the tags of the faces."""
        return [int(tag) for tag in np.unique(self.face)]

    @cached_property
    def middle(self) -> np.ndarray:
        """Return the middles of the flat triangles (m, 3), mm."""
        return self.nodes[self.triangles].mean(axis=1)

    @cached_property
    def foot(self) -> np.ndarray:
        """Return where the normals at the points on the CAD meet the flat triangles (m, 3), mm."""
        corner = self.nodes[self.triangles]
        flat = unit(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]))
        away = ((self.middle - self.place) * flat).sum(axis=1) / np.maximum((self.normal * flat).sum(axis=1), 0.5)
        return self.place + away[:, None] * self.normal

    @cached_property
    def box(self) -> np.ndarray:
        """Return the least and largest coordinates (2, 3), mm."""
        used = self.nodes[np.unique(self.triangles)]
        return np.array([used.min(axis=0), used.max(axis=0)])

    @cached_property
    def size(self) -> float:
        """Return the diagonal of the box, mm."""
        return float(np.linalg.norm(self.box[1] - self.box[0]))

    @cached_property
    def cells(self) -> dict[int, np.ndarray]:
        """Return the triangles of each face."""
        order = np.argsort(self.face, kind="stable")
        tags, first = np.unique(self.face[order], return_index=True)
        return {int(tag): part for tag, part in zip(tags, np.split(order, first[1:]))}

    @cached_property
    def neighbours(self) -> dict[int, set[int]]:
        """Return the faces that share an edge with each face."""
        found: dict[int, set[int]] = {tag: set() for tag in self.tags}
        for edge in self.edges.values():
            for tag in edge.faces:
                found[tag].update(edge.faces)
        return {tag: others - {tag} for tag, others in found.items()}

    def edges_inside(self, faces: Iterable[int]) -> dict[int, Edge]:
        """Return the edges between two of the faces."""
        own = set(faces)
        return {number: edge for number, edge in self.edges.items()
                if len(edge.faces) == 2 and own.issuperset(edge.faces)}

    def of(self, faces: Iterable[int]) -> np.ndarray:
        """Return the triangles of faces."""
        return np.concatenate([np.zeros(0, int), *(self.cells[tag] for tag in faces)])

    def marked(self, nodes: np.ndarray) -> np.ndarray:
        """Return which of all nodes are the ones given (n,)."""
        found = np.zeros(len(self.nodes), bool)
        found[nodes] = True
        return found

    def components(self, faces: Iterable[int]) -> list[set[int]]:
        """Return the sets of faces that are connected by edges, the largest area first."""
        left, found = set(faces), []
        while left:
            group, waiting = set(), [next(iter(left))]
            while waiting:
                tag = waiting.pop()
                if tag in left:
                    left.remove(tag)
                    group.add(tag)
                    waiting += self.neighbours[tag] & left
            found.append(group)
        return sorted(found, key=lambda group: -sum(self.areas[tag] for tag in group))


def unit(vectors: np.ndarray) -> np.ndarray:
    """Return vectors of length 1, zero where they vanish."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)


def angle_between(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Return the angles between vectors, degrees."""
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(first, second), axis=-1), (first * second).sum(axis=-1)))
