# SPDX-License-Identifier: GPL-3.0-or-later
"""Planes of symmetry of a part."""
import numpy as np
from scipy.spatial import cKDTree

from dd3.part.candidates import plane_normals
from dd3.part.rays import Rays
from dd3.part.shape import Shape, unit

# Distance of the centroids over the size, and difference of the areas, relative, of faces that are mirror images.
CENTRE, AREA = 1e-4, 1e-3
# Distance of mirrored points from the triangles, which are chords, over the size; number of points.
AWAY, POINTS = 5e-3, 200
# Number of normals of flat faces that are tried.
PLANES = 12
# Cosine between a plane's normal and the press direction up to which the plane is along it.
ALONG = 0.01


def symmetry_planes(shape: Shape, rays: Rays, up: np.ndarray) -> list[tuple[np.ndarray, float]]:
    """Return at most two planes of symmetry through the centroid of all faces, along the press direction: across the
    axes of the file, the principal axes, or what of the axes is across the direction; unit normal and distance from the
    origin, mm."""
    area = np.array([shape.areas[tag] for tag in shape.tags])
    centre = np.array([shape.centres[tag] for tag in shape.tags])
    middle = np.average(centre, axis=0, weights=area)
    away = centre - middle
    principal = np.linalg.eigh((area[:, None] * away).T @ away)[1].T
    flat = [normal for _, normal in plane_normals(shape, shape.tags)[:PLANES]]
    tree = cKDTree(centre)
    found: list[tuple[np.ndarray, float]] = []
    points = shape.nodes[np.unique(shape.triangles)]
    points = points[:: len(points) // POINTS + 1]
    tried = [*np.eye(3), *principal, *flat]
    across = [unit(np.cross(up, axis)) for axis in tried if np.linalg.norm(np.cross(up, axis)) > 0.1]
    for normal in [*tried, *across]:
        known = any(abs(normal @ other) > np.cos(np.radians(0.1)) for other, _ in found)
        if len(found) == 2 or known or abs(normal @ up) > ALONG:
            continue
        image = centre - 2 * np.outer((centre - middle) @ normal, normal)
        near = tree.query_ball_point(image, CENTRE * shape.size)
        if all(any(abs(area[j] - area[i]) <= AREA * area[i] for j in others) for i, others in enumerate(near)) and \
                rays.distances(points - 2 * np.outer((points - middle) @ normal, normal)).max() <= AWAY * shape.size:
            found.append((normal, float(middle @ normal)))
    return found
