# SPDX-License-Identifier: GPL-3.0-or-later
"""Offset of a surface that does not cross itself where a concave radius is smaller than the distance.

The offset is the boundary of all balls of a given radius whose centres are at least distance + radius from the surface:
a ball rolled along it (closing by a ball, Serra 1982). Where the centres of a fillet's nodes come too near to another
part of the surface, they lie instead on the ridge that is equally far from both sides: the point of the permitted
region that is extreme against the node's normal. The fillet becomes one of the ball's radius, and keeps its patches;
the nodes beside it slide along the surface by a harmonic displacement. So do those beside concave sharp edges.
"""
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, dia_array
from scipy.sparse.linalg import spsolve
from scipy.spatial import cKDTree

from dd3.tools.patch_distance import Distance
from dd3.tools.sharp_edges import Patches, along_valleys, rounding
from dd3.tools.surface import from_nodes, points_at

# Part of the distance of the centres below which a node does not slide.
NEAR = 1e-4
# Ratio of the eigenvalues of `border` above which a node is at a corner.
CORNER = 0.05
# Displacement over the distance of the centres, of a node of a fillet, above which the ball does not touch two
# sides.
FARTHEST = 3.0
# Reach of the harmonic displacement over its largest value.
REACH = 8.0


@dataclass
class Rolled:
    """Nodes of the offset (patch, 3, 3, 3), which patches are fillets of the ball, and which ones have changed; nodes
    of the patches that round sharp edges (n, 3, 3, 3); whether the ball finds a place to rest at all fillets, which it
    does not at the end of a groove. If not, the nodes are those of the plain offset."""

    nodes: np.ndarray
    fillet: np.ndarray
    changed: np.ndarray
    rounding: np.ndarray
    touches: bool = True


def rolled(patches: Patches, face: np.ndarray, distance: float, radius: float, tolerance: float) -> Rolled | None:
    """Return the offset of patches of faces; None if no fillet is too small for it and no sharp edge concave. The
    rounding of sharp edges is within the tolerance, mm.

    Only the faces beside the fillets are changed if they are wide enough.
    """
    reach = distance + radius
    nodes = patches.nodes
    fillet = reversed_by(nodes, nodes + reach * patches.normals)
    valleys = patches.valleys()
    if not fillet.any() and not len(valleys):
        return None
    number, valley = patches.split(valleys)
    count = int(number.max()) + 1
    times = np.bincount(number.ravel())[:, None]
    point, normal, moved = (np.stack([np.bincount(number.ravel(), part.reshape(-1, 3)[:, k], count) for k in range(3)],
                                     axis=1) / times for part in (nodes, patches.normals, nodes + patches.shift))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    surface = Distance(from_nodes(nodes), reach / 2)
    held = np.zeros(count, bool)
    held[number[fillet].ravel()] = True
    held[valley.ravel()] = True
    moved[held] = point[held] + distance * normal[held]
    foot = point + along_valleys(surface, valley, point, normal, reach)
    given = surface.extreme(foot[held], normal[held], reach) - radius * normal[held] - moved[held]
    if np.linalg.norm(given, axis=1).max() > FARTHEST * reach:
        return Rolled(nodes + patches.shift, fillet, np.zeros(len(nodes), bool), np.zeros((0, 3, 3, 3)), touches=False)
    beside = np.isin(face, face[held[number].any(axis=(1, 2)) & ~fillet])
    elsewhere = np.zeros(count, bool)
    elsewhere[number[~beside & ~fillet].ravel()] = True
    for still in (elsewhere & ~held, np.zeros(count, bool)):
        slide = harmonic(point, number, held, still, given)
        result = moved.copy()
        result[held] += given
        sliding = ~held & (np.linalg.norm(slide, axis=1) > NEAR * reach)
        foot, own = surface.nearest(point[sliding] + slide[sliding])
        result[sliding] = surface.permitted(foot + reach * own, reach) - radius * own
        changed = (held | sliding)[number].any(axis=(1, 2))
        if not reversed_by(nodes[changed & ~fillet], result[number][changed & ~fillet]).any():
            break
    return Rolled(result[number], fillet, changed, rounding(valley, result, normal, point, radius, tolerance))


def reversed_by(nodes: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Tell which patches have a direction in which their moved nodes run backwards."""
    along_u = ((nodes[:, :, 2] - nodes[:, :, 0]) * (moved[:, :, 2] - moved[:, :, 0])).sum(axis=2)
    along_v = ((nodes[:, 2] - nodes[:, 0]) * (moved[:, 2] - moved[:, 0])).sum(axis=2)
    return np.asarray((along_u[:, 1] < 0) | (along_v[:, 1] < 0))


def harmonic(point: np.ndarray, number: np.ndarray, held: np.ndarray, still: np.ndarray, given: np.ndarray
             ) -> np.ndarray:
    """Return displacements of all nodes: those given at the nodes that are held, none at those that are still, far from
    them and at corners of the border, harmonic between along the lines of nodes of the patches; on the border along
    it."""
    pairs = np.concatenate([np.stack([number[:, :, :-1].ravel(), number[:, :, 1:].ravel()], axis=1),
                            np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], axis=1)])
    length = np.linalg.norm(point[pairs[:, 0]] - point[pairs[:, 1]], axis=1)
    weight = 1 / np.maximum(length, 1e-6 * length.max())**2
    graph = coo_array((weight, pairs.T), shape=(len(point), len(point))).tocsr()
    graph = graph + graph.T
    matrix = (dia_array((np.reshape(graph.sum(axis=1), (1, -1)), [0]), shape=graph.shape) - graph).tocsr()
    result = np.zeros_like(point)
    result[held] = given
    far = cKDTree(point[held]).query(point)[0] > REACH * np.linalg.norm(given, axis=1).max()
    size, along = border(point, number)
    free = np.flatnonzero(~held & ~still & ~far & (size[:, 1] <= CORNER * size[:, 2]))
    if len(free):
        right = -(matrix[free][:, np.flatnonzero(held)] @ given)
        result[free] = spsolve(matrix[free][:, free].tocsc(), right).reshape(-1, 3)
    on_border = np.flatnonzero((size[:, 2] > 0) & ~held)
    result[on_border] = (result[on_border] * along[on_border]).sum(axis=1, keepdims=True) * along[on_border]
    return result


def border(point: np.ndarray, number: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the eigenvalues (node, 3), ascending, of the sum of the products of the directions of the free edges at
    each node, and the eigenvectors of the largest (node, 3): one direction on a border, two at its corners."""
    sides = np.concatenate([number[:, 0], number[:, 2], number[:, :, 0], number[:, :, 2]])
    _, inverse, count = np.unique(np.sort(sides[:, ::2], axis=1), axis=0, return_inverse=True, return_counts=True)
    free = sides[count[inverse.ravel()] == 1]
    along = point[free[:, 2]] - point[free[:, 0]]
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    total = np.zeros((len(point), 3, 3))
    for k in range(3):
        np.add.at(total, free[:, k], along[:, :, None] * along[:, None, :])
    size, vectors = np.linalg.eigh(total)
    return size, vectors[:, :, 2]


def deviation(net: np.ndarray, nodes: np.ndarray, places: tuple[np.ndarray, np.ndarray], distance: float, radius: float
              ) -> np.ndarray:
    """Return the distances (patch, k) of the patches at parameters from the boundary of the balls over the surface
    through nodes, mm."""
    reach = distance + radius
    point = points_at(net, *places)
    centre = Distance(from_nodes(nodes), reach / 2).permitted(point.reshape(-1, 3), reach)
    return np.abs(np.linalg.norm(centre.reshape(point.shape) - point, axis=2) - radius)
