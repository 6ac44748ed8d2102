# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces at a distance from CAD, with a least radius."""
from dataclasses import replace
from typing import Any

import numpy as np

from dd3.progress import doing
from dd3.tools import cad_mesh, rolling_ball
from dd3.tools.joints import folded, turn
from dd3.tools.moved import shift_of
from dd3.tools.report import named
from dd3.tools.sharp_edges import Patches
from dd3.tools.surface import Surface, from_nodes, normals_at_nodes, turned


@doing("moving the patches to the sides of the sheet")
def at_distance(gmsh: Any, model: cad_mesh.Model, sign: np.ndarray, kept: np.ndarray, distance: float, radius: float,
                ahead: int, tolerance: float) -> tuple[Surface, np.ndarray]:
    """Return the patches that are kept, turned by their signs and moved along their normals, and the largest distance
    of each face from the surface at that distance of the CAD, mm.

    Concave radii and sharp edges on one side are at least `radius` then, see `rolling_ball`: on that of the normals
    with `ahead` = 1, behind them with -1. Sharp edges become a face of their own; notes tell what was changed.
    """
    part = replace(model, nodes=model.nodes[kept], uv=model.uv[kept], labels=model.labels[kept], face=model.face[kept])
    normal = cad_mesh.normals(gmsh, part)
    # The normals of the CAD get the sides of the patches.
    side = np.sign((cad_mesh.middle_normals(part) * normal[:, 1, 1]).sum(axis=1)) * sign[kept]
    normal *= side[:, None, None, None]
    shift = shift_of(part.labels.ravel(), normal.reshape(-1, 3), distance).reshape(part.nodes.shape)
    net = from_nodes(part.nodes + shift)
    off = cad_mesh.distances(gmsh, part, net, distance * sign[kept] if distance else None).max(axis=1)
    ordered = np.where((sign[kept] < 0)[:, None, None, None], normal[:, :, ::-1], normal)
    result = Surface(turn(net, sign[kept]), part.face, list(model.names), normals=ordered)
    # From here on the patches face the side of the ball.
    flip = sign[kept] * ahead < 0
    patches = Patches(part.nodes.copy(), normal * ahead, shift, part.labels.copy())
    for array in (patches.nodes, patches.normals, patches.shift, patches.labels):
        array[flip] = array[flip][:, :, ::-1]
    ball = rolling_ball.rolled(patches, part.face, abs(distance), radius, tolerance / 2)
    if ball is None:
        return result, cad_mesh.by_face(part, off)
    small = np.unique(part.face[ball.fillet])
    if not ball.touches:
        result.notes.append(f"no least radius of {radius:g} mm, as a ball does not touch two sides somewhere: "
                            + (named(model, small) if len(small) else "sharp edges"))
    elif len(small):
        result.notes.append(f"least radius {radius:g} mm in place of smaller ones: {named(model, small)}")
    if not ball.changed.any():
        return result, cad_mesh.by_face(part, off)
    new = from_nodes(np.concatenate([ball.nodes[ball.changed], ball.rounding]))
    if len(folded(new)):  # an error later on
        away = np.zeros(len(new))
        result.notes.append("distance not measured where radii were changed, as patches are folded there")
    else:
        away = rolling_ball.deviation(new, patches.nodes, cad_mesh.PLACES, abs(distance), radius).max(axis=1)
    new = new if ahead > 0 else turned(new)
    changed = int(ball.changed.sum())
    off[ball.changed] = away[:changed]
    result.net[ball.changed] = new[:changed]
    ordered[ball.changed] = normals_at_nodes(new[:changed])
    largest = cad_mesh.by_face(part, off)
    if len(ball.rounding):
        result.notes.append(f"sharp edges rounded by {radius:g} mm: {len(ball.rounding)} patches")
        result.net = np.concatenate([result.net, new[changed:]])
        result.normals = np.concatenate([ordered, normals_at_nodes(new[changed:])])
        result.face = np.concatenate([result.face, np.full(len(ball.rounding), len(result.names))])
        result.names.append("rounded edges")
        largest = np.append(largest, away[changed:].max())
    return result, largest
