# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces of a sheet and of its tools for pictures: completed at planes of symmetry, with their sharp edges."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pyvista as pv

from dd3.bound import closed_skin
from dd3.sheet import AXES
from dd3.tools.surface import Patches, points_on

POINTS = 200000  # of a tool, about; at most 25 x 25 of a patch
SHARP = 40  # angle between faces of the sheet or of a tool above which their edge is sharp, degrees
ON_PLANE = 1e-6  # distance from a plane of symmetry of what lies on it, over the size of a surface

Box = tuple[np.ndarray, np.ndarray]


class Placement(NamedTuple):
    """Place of a tool: the directions of the axes of its file, one after the other, and the displacement."""

    axes: np.ndarray
    displacement: np.ndarray

    def of(self, points: np.ndarray) -> np.ndarray:
        """Return points of the tool's file at their place."""
        return points @ self.axes + self.displacement


def tool_surface(patches: Patches, placement: Placement, count: int = POINTS) -> pv.PolyData:
    """Return the surface of a tool at its place, of about `count` points."""
    finest = max(2, min(24, round(math.sqrt(count / len(patches)))))
    points, faces, first = [], [], 0
    for shape in {weights.shape for _, weights in patches}:
        alike = [patch for patch in patches if patch[1].shape == shape]
        places = [np.linspace(0, 1, 2 if size == 2 else finest + 1) for size in shape]
        xyz = points_on(np.array([p for p, _ in alike]), np.array([weights for _, weights in alike]), *places)
        points.append(placement.of(xyz.reshape(-1, 3)))
        number = first + np.arange(xyz[..., 0].size).reshape(xyz.shape[:3])
        corners = number[:, :-1, :-1], number[:, :-1, 1:], number[:, 1:, 1:], number[:, 1:, :-1]
        faces.append(np.stack(corners, axis=-1).reshape(-1, 4))
        first += number.size
    return pv.PolyData(np.concatenate(points), np.insert(np.concatenate(faces), 0, 4, axis=1))


def reflected(mesh: Any, axes: Sequence[str], odd: Sequence[str] = ()) -> list[Any]:
    """Return the mesh and its mirror images in the planes normal to the axes. odd: axes in whose images the field
    `shown` changes its sign."""
    parts = [mesh]
    for axis in axes:
        images = [part.reflect(normal_of(axis), point=(0.0, 0.0, 0.0)) for part in parts]
        for data in (data for image in images for data in (image.point_data, image.cell_data)):
            if axis in odd and "shown" in data:
                data["shown"] = -data["shown"]
        parts += images
    return parts


def normal_of(axis: str) -> tuple[float, ...]:
    """Return the unit vector along an axis."""
    return tuple(float(axis == other) for other in AXES)


def completed(skin: pv.PolyData, axes: Sequence[str], odd: Sequence[str] = ()) -> pv.PolyData:
    """Return a surface and its mirror images as one, without seams; odd as in `reflected`."""
    return pv.merge(reflected(skin, axes, odd), merge_points=False).clean(tolerance=ON_PLANE, absolute=False)


def sheet_skin(mesh: pv.UnstructuredGrid, axes: Sequence[str], odd: Sequence[str] = ()) -> pv.PolyData:
    """Return the surface of a sheet, completed at its planes of symmetry; the faces on these are left out; odd as in
    `reflected`."""
    skin = closed_skin(mesh).extract_surface(algorithm="dataset_surface", nonlinear_subdivision=2)
    near = ON_PLANE * diagonal((skin.points.min(axis=0), skin.points.max(axis=0)))
    for axis in axes:
        off = np.abs(skin.points[:, AXES.index(axis)]) > near
        cut = [cell for cell, nodes in enumerate(skin.irregular_faces) if not off[nodes].any()]
        skin = skin.remove_cells(cut) if cut else skin
    return completed(skin, axes, odd)


def tool_skin(patches: Patches, placement: Placement, axes: Sequence[str], inside: np.ndarray) -> pv.PolyData:
    """Return the surface of a tool at its place, completed at the planes of symmetry; what lies beyond them, seen from
    a point inside, is left out."""
    skin = tool_surface(patches, placement)
    for axis in axes:
        skin = skin.clip(normal_of(axis), origin=(0.0, 0.0, 0.0), invert=bool(inside[AXES.index(axis)] < 0))
    return completed(skin, axes)


def sharp_edges(skin: pv.PolyData) -> pv.PolyData:
    """Return the outer edges of a surface, and those between faces at an angle."""
    # Mirror images and neighbouring patches may be turned the other way.
    turned = skin.clean(tolerance=ON_PLANE, absolute=False).compute_normals(point_normals=False)
    return turned.extract_feature_edges(boundary_edges=True, feature_edges=True, manifold_edges=False,
                                        non_manifold_edges=False, feature_angle=SHARP)


def diagonal(box: Box) -> float:
    """Return the length of the diagonal of a box."""
    return float(np.linalg.norm(box[1] - box[0]))
