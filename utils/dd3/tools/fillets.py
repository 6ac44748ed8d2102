# SPDX-License-Identifier: GPL-3.0-or-later
"""Fillets in place of the sharp edges of one side of a sheet or a block, made in the CAD by OpenCASCADE before it is
meshed."""
from itertools import product
from typing import Any

import numpy as np

from dd3.errors import Problem
from dd3.tools.faces import spans

# Distance over the size of the model within which a point is on a face; cosine between normals there.
ON, PARALLEL = 1e-6, 0.999
# Parts of the range of the parameters at which a point inside a face is sought, the middle first.
PARTS = 0.5, 0.37, 0.63, 0.21, 0.79, 0.08, 0.92, 0.02, 0.98


def rounded(gmsh: Any, side: list[int], edges: dict[int, float]) -> dict[int, int]:
    """Round edges of one side of a solid by a radius each, mm; return the faces of that side with the faces of the file
    that they are of, 0 for a fillet.

    Faces that were there before are known by a point of theirs and its normal: the fillets shorten them only.
    """
    occ = gmsh.model.occ
    low, high = np.reshape(gmsh.model.getBoundingBox(-1, -1), (2, 3))
    size = float(np.linalg.norm(high - low))
    before = [tag for _, tag in gmsh.model.getEntities(2)]
    volumes = [tag for _, tag in gmsh.model.getEntities(3)
               if set(side) <= {abs(face) for _, face in gmsh.model.getBoundary([(3, tag)], combined=False)}]
    try:
        new = occ.fillet(volumes[:1], list(edges), list(edges.values()), removeVolume=False)
        occ.synchronize()
    except Exception:  # Gmsh raises nothing more specific
        raise Problem(f"the sharp edges {spans(list(edges))} cannot be rounded by up to {max(edges.values()):.3g} mm"
                      + cause(gmsh, edges)) from None
    after = {abs(tag) for _, tag in gmsh.model.getBoundary(new, combined=False)}
    origin = {}
    for tag in sorted(after):
        old = face_at(gmsh, *interior(gmsh, tag), before, ON * size)
        if old is None or old in side:
            origin[tag] = old or 0
    return origin


def cause(gmsh: Any, edges: dict[int, float]) -> str:
    """Return why OpenCASCADE makes no fillets, as far as it can be told, and what to do."""
    length = {edge: gmsh.model.occ.getMass(1, edge) for edge in edges}
    short = [edge for edge, radius in edges.items() if length[edge] < radius]
    if not short:
        return ": take a smaller --radius, or round them in the CAD program"
    return (f", as some are shorter than the radius, {spans(short)}, the shortest of {min(length.values()):.3g} mm, "
            "where fillets of other edges end: round them in the CAD program, before those")


def interior(gmsh: Any, tag: int) -> tuple[np.ndarray, np.ndarray]:
    """Return a point inside a face and the unit normal there."""
    low, high = (np.array(bound) for bound in gmsh.model.getParametrizationBounds(2, tag))
    uv = np.array([low + np.array(pair) * (high - low) for pair in product(PARTS, PARTS)])
    inside = next((pair for pair in uv if gmsh.model.isInside(2, tag, pair, True)), uv[0])
    return np.array(gmsh.model.getValue(2, tag, inside)), np.array(gmsh.model.getNormal(tag, inside))


def face_at(gmsh: Any, point: np.ndarray, normal: np.ndarray, tags: list[int], tolerance: float) -> int | None:
    """Return the face on which a point with a normal lies, None without one."""
    for tag in tags:
        low, high = np.reshape(gmsh.model.getBoundingBox(2, tag), (2, 3))
        if (point < low - tolerance - 1e-6).any() or (point > high + tolerance + 1e-6).any():
            continue
        foot, uv = gmsh.model.getClosestPoint(2, tag, point)
        if np.linalg.norm(np.array(foot) - point) <= tolerance and \
                abs(np.array(gmsh.model.getNormal(tag, uv)) @ normal) > PARALLEL and \
                gmsh.model.isInside(2, tag, uv, True):
            return tag
    return None


def said_of(edges: dict[int, float]) -> str:
    """Return what is said of rounded edges."""
    radii = sorted(set(edges.values()))
    return f"sharp edges rounded by {' and '.join(f'{radius:.4g}' for radius in radii)} mm: {len(edges)}"
