# SPDX-License-Identifier: GPL-3.0-or-later
"""Several parts in one file: their boxes and edges, for the picture from which one of them is chosen."""
from itertools import product
from typing import Any

import numpy as np

from dd3.part.sampling import edges_of, set_sizes
from dd3.part.shape import Shape, unit

# Corners of a box, numbered by product([0, 1], repeat=3), of the triangles of its faces, outwards.
SIDES = np.array([[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6],
                  [0, 6, 4], [1, 5, 7], [1, 7, 3]])


def outlined(gmsh: Any, parts: list[tuple[str, set[int]]]) -> Shape:
    """Return the boxes of parts, each as a face with the part's number, with the edges of all faces."""
    set_sizes(gmsh, [tag for _, tags in parts for tag in tags])
    gmsh.model.mesh.generate(1)
    label, xyz, _ = gmsh.model.mesh.getNodes()
    nodes = np.zeros((int(label.max(initial=0)) + 1, 3))
    nodes[label.astype(int)] = np.reshape(xyz, (-1, 3))
    edges, pieces, piece_edge = edges_of(gmsh, sorted(set().union(*(tags for _, tags in parts))))
    ends = np.array([box_of(gmsh, tags) for _, tags in parts])
    corners = np.array([[end[list(place), [0, 1, 2]] for place in product([0, 1], repeat=3)] for end in ends])
    triangles = (np.arange(len(parts))[:, None, None] * 8 + SIDES).reshape(-1, 3)
    points = corners.reshape(-1, 3)[triangles]
    area = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]) / 2
    number = np.repeat(np.arange(1, len(parts) + 1), len(SIDES))
    size = np.linalg.norm(area, axis=1)
    normal = unit(area)
    numbers = range(1, len(parts) + 1)
    return Shape(np.vstack([nodes, corners.reshape(-1, 3)]), triangles + len(nodes), number, size,
                 np.tile(normal[:, None], (1, 3, 1)), points.mean(axis=1), normal, np.zeros((len(number), 2)),
                 dict.fromkeys(numbers, "box"), {k: float(size[number == k].sum()) for k in numbers},
                 {k: ends[k - 1].mean(axis=0) for k in numbers}, edges, pieces, piece_edge,
                 np.full((len(number), 3), -1), number, False)


def box_of(gmsh: Any, tags: set[int]) -> np.ndarray:
    """Return the least and the largest coordinates (2, 3) of faces, mm."""
    ends = np.array([gmsh.model.getBoundingBox(2, tag) for tag in tags]).reshape(-1, 2, 3)
    return np.array([ends[:, 0].min(axis=0), ends[:, 1].max(axis=0)])
