# SPDX-License-Identifier: GPL-3.0-or-later
"""Fillets that end in mitres, because the edge between their walls at a corner is sharp.

The angle of a mitre fades to nothing where both fillets touch the floor, so that no fillet of it can be made. The
fillets are taken out of the CAD, the faces beside them meet in sharp edges, and these are rounded again, together with
the sharp edge at the corner by the largest radius of its fillets: a ball of that radius goes round the corner.
"""
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from dd3.errors import Problem
from dd3.progress import doing
from dd3.tools import fillets
from dd3.tools.faces import spans

# Angles between the faces of an edge, degrees, above which it is sharp, and below which that of a mitre has faded.
SHARP, FADED = 3.0, 1.0
# Parts of an edge at which angles are taken: its middle, and near to its ends.
MIDDLE, NEAR_ENDS = 0.5, (1e-3, 1.0 - 1e-3)
# Parts of the range of the parameters of a face at which its radius is taken.
PARTS = np.linspace(0.05, 0.95, 7)
# Relative difference of radii up to which they are one; curvature times the size of a face up to which it is flat.
SAME, FLAT = 0.01, 0.05


@dataclass
class Unfilleted:
    """A solid without fillets: its faces of one side by those of the file, and the radii of the edges to be rounded,
    mm, of which some are at corners."""

    faces: dict[int, int]
    edges: dict[int, float]
    corners: list[int]


@doing("rounding the sharp edges")
def rounded(gmsh: Any, side: list[int], edges: dict[int, float]) -> tuple[dict[int, int], list[str]]:
    """Round the sharp edges of one side of a solid as `fillets.rounded`, and lead fillets that end in mitres around the
    corners; return the faces of that side with those of the file, and notes."""
    mitres = [edge for edge in edges if is_mitre(gmsh, edge)]
    if not mitres:
        return fillets.rounded(gmsh, side, edges), [fillets.said_of(edges)]
    removed = mitred(gmsh, fillets.volume_of(gmsh, side))
    own = [tag for tag in removed if tag in side]
    try:
        sharp = unfilleted(gmsh, side, edges, removed)
        origin = fillets.rounded(gmsh, list(sharp.faces), sharp.edges)
    except Exception:  # Gmsh raises nothing more specific
        largest = max(*removed.values(), *edges.values())
        raise Problem(f"the fillets of faces {spans(own)} end in mitres, edges {spans(mitres)}, and cannot be led "
                      f"around these corners by {largest:.3g} mm: round the corners in the CAD program, before the "
                      "fillets") from None
    near = fillets.tolerance_of(gmsh)
    found = {tag: sharp.faces[old] if old else fillets.face_of(gmsh, tag, own, near) or 0
             for tag, old in origin.items()}
    new = [tag for tag, old in found.items() if not old]
    return found, [fillets.said_of(sharp.edges), said_of(gmsh, own, sharp, new)]


def said_of(gmsh: Any, own: list[int], sharp: Unfilleted, new: list[int]) -> str:
    """Return what is said of fillets that were led around corners, where they have new faces."""
    points = [middle_of(gmsh, edge) for edge in sharp.corners]
    off = max(min(float(np.linalg.norm(gmsh.model.getClosestPoint(2, tag, point)[0] - point)) for tag in new)
              for point in points)
    return (f"fillets of faces {spans(own)}, which end in mitres, led around {len(points)} corners, by "
            f"{fillets.in_words(sharp.edges[edge] for edge in sharp.corners)}: there the tools are up to {off:.3g} mm "
            "off the part's sharp corners")


def faces_of(gmsh: Any, edge: int) -> list[int]:
    """Return the faces beside an edge."""
    return [int(tag) for tag in gmsh.model.getAdjacencies(1, edge)[0]]


def edges_of(gmsh: Any, faces: list[int]) -> list[int]:
    """Return the edges of faces."""
    return sorted({int(edge) for face in faces for edge in gmsh.model.getAdjacencies(2, face)[1]})


def parameter(gmsh: Any, edge: int, part: float) -> list[float]:
    """Return the parameter of an edge at a part of it."""
    low, high = (bound[0] for bound in gmsh.model.getParametrizationBounds(1, edge))
    return [low + part * (high - low)]


def middle_of(gmsh: Any, edge: int) -> np.ndarray:
    """Return the middle of an edge."""
    return np.array(gmsh.model.getValue(1, edge, parameter(gmsh, edge, MIDDLE)))


def angle_at(gmsh: Any, edge: int, part: float) -> float:
    """Return the angle between the tangent planes of the two faces of an edge at a part of it, degrees, up to 90; that
    if an edge has no curve on a face."""
    at = parameter(gmsh, edge, part)
    try:
        first, second = (gmsh.model.getNormal(face, gmsh.model.reparametrizeOnSurface(1, edge, at, face))
                         for face in faces_of(gmsh, edge))
    except Exception:  # Gmsh raises nothing more specific
        return 90.0
    return float(np.degrees(np.arccos(min(abs(np.dot(first, second)), 1.0))))


def is_sharp(gmsh: Any, edge: int) -> bool:
    """Tell whether two faces meet at an edge with an angle."""
    return len(faces_of(gmsh, edge)) == 2 and angle_at(gmsh, edge, MIDDLE) > SHARP


def is_mitre(gmsh: Any, edge: int) -> bool:
    """Tell whether an edge is a mitre: sharp between two fillets, with an angle that fades at one end."""
    return (is_sharp(gmsh, edge) and min(angle_at(gmsh, edge, part) for part in NEAR_ENDS) < FADED
            and all(radius_of(gmsh, face) for face in faces_of(gmsh, edge)))


def radius_of(gmsh: Any, face: int) -> float:
    """Return the radius of a fillet, mm: the least one of curvature, if it is the same over the face, else 0."""
    low, high = (np.array(bound) for bound in gmsh.model.getParametrizationBounds(2, face))
    uv = low + np.array(list(product(PARTS, PARTS))) * (high - low)
    uv = np.array([pair for pair in uv if gmsh.model.isInside(2, face, pair, True)])
    if not len(uv):
        return 0.0
    largest, least = gmsh.model.getPrincipalCurvatures(face, uv.ravel())[:2]
    found = np.maximum(np.abs(largest), np.abs(least))
    flat = found.max() * np.ptp(np.reshape(gmsh.model.getBoundingBox(2, face), (2, 3)), axis=0).max() <= FLAT
    return 0.0 if flat or np.ptp(found) > SAME * found.max() else float(1 / np.median(found))


def mitred(gmsh: Any, volume: int) -> dict[int, float]:
    """Return the radii of the fillets of a solid, mm, that end in mitres, with those that they go on to smoothly."""
    edges = edges_of(gmsh, fillets.faces_of_volume(gmsh, volume))
    found: dict[int, float] = {}
    waiting = [face for edge in edges if is_mitre(gmsh, edge) for face in faces_of(gmsh, edge)]
    while waiting:
        face = waiting.pop()
        if face in found:
            continue
        found[face] = radius_of(gmsh, face)
        beside = {other for edge in edges_of(gmsh, [face]) if not is_sharp(gmsh, edge)
                  for other in faces_of(gmsh, edge)}
        waiting += [other for other in beside if abs(radius_of(gmsh, other) - found[face]) < SAME * found[face]]
    return found


def unfilleted(gmsh: Any, side: list[int], edges: dict[int, float], removed: dict[int, float]) -> Unfilleted:
    """Make the solid without fillets, whose neighbours grow; at corners, where two of the edges that come in their
    place meet other sharp ones, these get their largest radius."""
    beside = {face: {tag for edge in edges_of(gmsh, [face]) for tag in faces_of(gmsh, edge)} for face in removed}
    near = fillets.tolerance_of(gmsh)
    new = taken_out(gmsh, fillets.volume_of(gmsh, side), set(removed))
    faces = {tag: old for old in side if old not in removed
             if (tag := fillets.face_of(gmsh, old, new, near)) is not None}
    again, others = {}, {}
    for edge in edges_of(gmsh, list(faces)):
        pair = {faces.get(tag) for tag in faces_of(gmsh, edge)}
        if None in pair or not is_sharp(gmsh, edge):
            continue
        kept = [radius for old, radius in edges.items() if pair == set(faces_of(gmsh, old)) and on_edge(
            gmsh, edge, middle_of(gmsh, old), near)]
        if kept:
            others[edge] = max(kept)
        else:
            again[edge] = max(radius for face, radius in removed.items() if pair <= beside[face])
    corners: dict[int, float] = {}
    for edge in others:
        for end in gmsh.model.getAdjacencies(1, edge)[1]:
            meeting = [radius for one, radius in again.items() if end in gmsh.model.getAdjacencies(1, one)[1]]
            if len(meeting) > 1:
                corners[edge] = max(others[edge], *meeting, corners.get(edge, 0.0))
    return Unfilleted(faces, {**again, **others, **corners}, list(corners))


def taken_out(gmsh: Any, volume: int, faces: set[int]) -> list[int]:
    """Make the solid without faces; return its faces. OpenCASCADE leaves those whose neighbours do not meet without
    others that go as well, as on both sides of a sheet: they are tried again."""
    left = faces
    while left:
        volume = gmsh.model.occ.defeature([volume], sorted(left), removeVolume=False)[0][1]
        gmsh.model.occ.synchronize()
        before, left = left, faces & set(fillets.faces_of_volume(gmsh, volume))
        if left == before:
            raise Problem(f"faces {spans(sorted(left))} cannot be taken out")
    return fillets.faces_of_volume(gmsh, volume)


def on_edge(gmsh: Any, edge: int, point: np.ndarray, tolerance: float) -> bool:
    """Tell whether a point lies on an edge."""
    return bool(np.linalg.norm(gmsh.model.getClosestPoint(1, edge, point)[0] - point) <= tolerance)
