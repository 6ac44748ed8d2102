# SPDX-License-Identifier: GPL-3.0-or-later
"""Which side of a surface faces the sheet: turning of bodies, and faces that face away from the sheet."""

import numpy as np

from dd3.tools.joints import Joints, orient, turn
from dd3.tools.surface import Surface, area_vectors, points_at

# Cosine of the angle between a normal and --toward below which a patch faces away; walls are kept.
AWAY = -0.05
# Part of its area times distance from its centre by which the normals of a ring point outwards, or inwards.
RING = 0.1


def settle(area: np.ndarray, centre: np.ndarray, face: np.ndarray, sign: np.ndarray, body: np.ndarray,
           is_open: np.ndarray, toward: np.ndarray | None) -> tuple[np.ndarray, np.ndarray, list[int], list[str]]:
    """Return the signs of the items, which are kept, and lines for the report.

    The items (patches or facets) have area vectors, centres, faces, signs that make their bodies consistent, and
    bodies. A closed body is turned outwards, and so is a ring, an open one with as much area towards as away from
    `toward`. Another open one is turned to `toward`, or keeps the side of the greater part of its area. With `toward`,
    faces of which no item faces that way are left out.
    """
    sign = sign.copy()
    turned_faces, notes = set(), []
    for number in range(body.max() + 1):
        chosen = body == number
        vectors = sign[chosen, None] * area[chosen]
        weight = np.linalg.norm(vectors, axis=1)
        majority = 1 if weight @ sign[chosen] >= 0 else -1
        for item in np.unique(face[chosen]):
            of_face = face[chosen] == item
            if weight[of_face] @ sign[chosen][of_face] * majority < 0:
                turned_faces.add(item)
        # The centre of the item's own body, so that rounding of a far one does not matter.
        place = centre[chosen] - centre[chosen].mean(axis=0)
        outward = np.einsum("nc,nc", place, vectors)
        if not is_open[number]:
            side = outward
        elif toward is not None:
            side = vectors.sum(axis=0) @ toward
            if abs(side) < 1e-6 * weight.sum():
                ring = abs(outward) > RING * (weight @ np.linalg.norm(place, axis=1))
                notes.append("a body has as much area towards as away from --toward: "
                             + ("a ring; its normals point outwards, with --turn inwards" if ring else
                                "its side is that of the file"))
                side = outward if ring else majority
        else:
            side = majority
        if side < 0:
            sign[chosen] *= -1
    kept = np.ones(len(face), bool)
    if toward is not None:
        cosine = sign * (area @ toward) / np.maximum(np.linalg.norm(area, axis=1), 1e-300)
        largest = np.full(face.max() + 1, -1.0)
        np.maximum.at(largest, face, cosine)
        kept = largest[face] > AWAY
    return sign, kept, sorted(turned_faces), notes


def faced(surface: Surface, joints: Joints, toward: np.ndarray | None, outward: np.ndarray | None = None
          ) -> tuple[np.ndarray, np.ndarray, list[int], list[str], np.ndarray, np.ndarray]:
    """Return signs, kept patches, turned faces, notes, bodies and twisted joints of a surface.

    The signs `outward` of the patches of a solid, where they are known, count for more than the joints.
    """
    sign, body, twisted = orient(surface.net, joints)
    if outward is not None:
        sign, twisted = outward, twisted[:0]
    is_open = np.zeros(body.max() + 1, bool)
    is_open[body[joints.free // 4]] = True
    is_open[body[joints.multiple // 4]] = True
    centre = points_at(surface.net, np.array([0.5]), np.array([0.5]))[:, 0]
    sign, kept, turned_faces, notes = settle(area_vectors(surface.net), centre, surface.face, sign, body, is_open,
                                             toward)
    return sign, kept, turned_faces if outward is None else [], notes, body, twisted


def apply(surface: Surface, sign: np.ndarray, kept: np.ndarray) -> Surface:
    """Return the surface turned by the signs, without the patches that are not kept."""
    surface.net = turn(surface.net, sign)
    return surface.select(kept)
