# SPDX-License-Identifier: GPL-3.0-or-later
"""Fillets in place of the sharp edges of one side of a sheet or a block, made in the CAD by OpenCASCADE before it is
meshed."""
from collections import Counter
from collections.abc import Iterable
from itertools import product
from typing import Any

import numpy as np

from dd3.errors import Problem
from dd3.tools.faces import spans
from dd3.tools.plane import crosses

# Distance over the size of the model within which a point is on a face; cosine between normals there.
ON, PARALLEL = 1e-6, 0.999
# Divisions of the range of the parameters at which points inside a face are sought, up to this number of points.
DIVISIONS, POINTS = (4, 12, 40, 130), 8
# Points of an edge at which the outline of a fillet is taken; relative size of a gap of it that is none; pieces
# between points up to which the outline may cross where edges are tangent.
OUTLINE, CLOSED, NEAR = 33, 1e-6, 3


def rounded(gmsh: Any, side: list[int], edges: dict[int, float]) -> dict[int, int]:
    """Round edges of one side of a solid by a radius each, mm; return the faces of that side with the faces of the file
    that they are of, 0 for a fillet.

    Faces that were there before are known by points and normals.
    """
    occ = gmsh.model.occ
    tolerance, volume = tolerance_of(gmsh), volume_of(gmsh, side)
    before = faces_of_volume(gmsh, volume)
    try:
        new = occ.fillet([volume], list(edges), list(edges.values()), removeVolume=False)
        occ.synchronize()
    except Exception:  # Gmsh raises nothing more specific
        raise Problem(f"the sharp edges {spans(list(edges))} cannot be rounded by up to {max(edges.values()):.3g} mm"
                      + cause(gmsh, edges)) from None
    origin = {}
    for tag in faces_of_volume(gmsh, new[0][1]):
        old = tag if tag in before else face_of(gmsh, tag, before, tolerance)
        if old is None or old in side:
            origin[tag] = old or 0
    crossed = [tag for tag, old in origin.items() if not old and crosses_itself(gmsh, tag)]
    if crossed:
        at = " ".join(f"{round(value, 2) + 0.0:g}" for value in gmsh.model.occ.getCenterOfMass(2, crossed[0]))
        raise Problem(f"the sharp edges {spans(list(edges))} cannot be rounded by {in_words(edges.values())}, as the "
                      f"fillets of neighbouring ones overlap, at {len(crossed)} faces, the first at x y z = {at}: take "
                      "a smaller --radius, or round them in the CAD program")
    return origin


def crosses_itself(gmsh: Any, tag: int) -> bool:
    """Tell whether the outline of a fillet, between the points of its edges, crosses itself in the plane of its
    parameters, as where fillets overlap; False if the outline is not closed there, as at a seam."""
    parts = []
    try:
        for _, edge in gmsh.model.getBoundary([(2, tag)], combined=False, oriented=True):
            low, high = np.ravel(gmsh.model.getParametrizationBounds(1, abs(edge)))
            t = np.linspace(low, high, OUTLINE)[::1 if edge > 0 else -1]
            parts.append(np.reshape(gmsh.model.reparametrizeOnSurface(1, abs(edge), t, tag), (-1, 2)))
    except Exception:  # an edge whose curve on the surface is missing
        return False
    outline = np.concatenate([part[:-1] for part in parts])
    gaps = [after[0] - part[-1] for part, after in zip(parts, parts[1:] + parts[:1])]
    closed = (np.abs(gaps) <= CLOSED * np.ptp(outline, axis=0)).all()
    return bool(closed) and crosses(outline, NEAR)


def faces_of_volume(gmsh: Any, volume: int) -> list[int]:
    """Return the faces of a solid."""
    return sorted({abs(face) for _, face in gmsh.model.getBoundary([(3, volume)], combined=False)})


def volume_of(gmsh: Any, side: list[int]) -> int:
    """Return the solid of faces."""
    return next(tag for _, tag in gmsh.model.getEntities(3) if set(side) <= set(faces_of_volume(gmsh, tag)))


def tolerance_of(gmsh: Any) -> float:
    """Return the distance up to which points are on faces and edges, mm."""
    low, high = np.reshape(gmsh.model.getBoundingBox(-1, -1), (2, 3))
    return ON * float(np.linalg.norm(high - low))


def cause(gmsh: Any, edges: dict[int, float]) -> str:
    """Return why OpenCASCADE makes no fillets, as far as it can be told, and what to do."""
    length = {edge: gmsh.model.occ.getMass(1, edge) for edge in edges}
    short = [edge for edge, radius in edges.items() if length[edge] < radius]
    if not short:
        return ": take a smaller --radius, or round them in the CAD program"
    return (f", as some are shorter than the radius, {spans(short)}, the shortest of {min(length.values()):.3g} mm, "
            "where fillets of other edges end: round them in the CAD program, before those")


def face_of(gmsh: Any, tag: int, tags: list[int], tolerance: float) -> int | None:
    """Return which face lies on another one, in most of some points inside of this, None without one."""
    low, high = (np.array(bound) for bound in gmsh.model.getParametrizationBounds(2, tag))
    inside: list[np.ndarray] = []
    for count in DIVISIONS:
        uv = low + np.array(list(product(range(1, count), repeat=2))) / count * (high - low)
        inside = [pair for pair in uv if gmsh.model.isInside(2, tag, pair, True)]
        if len(inside) >= POINTS:
            break
    found = [face_at(gmsh, np.array(gmsh.model.getValue(2, tag, pair)), np.array(gmsh.model.getNormal(tag, pair)), tags,
                     tolerance) for pair in inside[::max(1, len(inside) // POINTS)]]
    return Counter(found).most_common(1)[0][0] if found else None


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
    return f"sharp edges rounded by {in_words(edges.values())}: {len(edges)}"


def in_words(radii: Iterable[float]) -> str:
    """Return different radii in words."""
    return " and ".join(sorted({f"{radius:.4g}" for radius in radii}, key=float)) + " mm"
