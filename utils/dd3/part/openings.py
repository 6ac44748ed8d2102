# SPDX-License-Identifier: GPL-3.0-or-later
"""Openings of one side of a part, holes, lanced forms and notches, and the curves of its rims."""
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from dd3.curve import edge_points, joined
from dd3.part.loops import find_loops, find_notches, hole_of
from dd3.part.shape import Shape
from dd3.tools.faces import spans

# Distance of the curves from the chords between their points, mm.
CHORD = 0.01
# Kinds of holes at which faces were formed, which are no part of the drawn shape.
FORMED = ("lanced", "collar")


@dataclass
class Opening:
    """A hole, a lanced form or a notch: what it is in words; its free edges and the faces beside these; its centre and
    its size, mm; whether it is a notch, or has faces that are formed at it and left out with it; the points in the
    middle of its edges."""

    words: str
    edges: list[int]
    faces: list[int]
    centre: np.ndarray
    size: float
    notch: bool = False
    formed: bool = False
    middles: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))

    @property
    def said(self) -> str:
        """Return the opening with its place in words."""
        place = " ".join(f"{value:.4g}" for value in np.round(self.centre, 3) + 0.0)
        return f"{self.words} at x y z = {place} in face{'s' if len(self.faces) > 1 else ''} {spans(self.faces)}"


def openings_of(gmsh: Any, shape: Shape, faces: list[int]) -> tuple[list[Opening], set[int]]:
    """Return the openings of a side, and the faces at its outer rim."""
    loops = find_loops(shape, faces)
    if not loops:
        return [], set()
    found = []
    for hole in (hole_of(shape, loop) for loop in loops[1:]):
        found.append(Opening(hole.words, hole.loop.edges, hole.loop.faces, hole.centre, max(hole.size),
                             formed=hole.name in FORMED))
    for notch in find_notches(shape, faces, loops[0]):
        beside = {tag for edge in notch.edges for tag in shape.edges[edge].faces} & set(faces)
        found.append(Opening(f"notch {notch.width:.4g} x {notch.depth:.4g}", notch.edges, sorted(beside), notch.centre,
                             max(notch.width, notch.depth), notch=True))
    for opening in found:
        opening.middles = np.array([middle(gmsh, edge) for edge in opening.edges])
    return found, set(loops[0].faces)


def middle(gmsh: Any, edge: int) -> np.ndarray:
    """Return the point in the middle of the parameters of an edge."""
    low, high = (bound[0] for bound in gmsh.model.getParametrizationBounds(1, edge))
    return np.array(gmsh.model.getValue(1, edge, [(low + high) / 2]))


def curves_of(gmsh: Any, path: Path, shape: Shape, faces: list[int]) -> list[np.ndarray]:
    """Return the closed curves of the rims of a side, the outer one first; those of lanced forms, which are cut as they
    are formed, are left out."""
    found: list[np.ndarray] = []
    for i, loop in enumerate(find_loops(shape, faces)):
        if i and hole_of(shape, loop).name in FORMED:
            continue
        found += joined(path, [edge_points(gmsh, edge, CHORD) for edge in loop.edges])
    return found
