# SPDX-License-Identifier: GPL-3.0-or-later
"""Offset of a surface that does not cross itself where a concave radius is smaller than the distance.

The offset is the boundary of all balls of a given radius whose centres are at least distance + radius from the surface:
a ball rolled along it (closing by a ball, Serra 1982). Where the centres of a fillet's nodes come too near to another
part of the surface, they lie instead on the ridge that is equally far from both sides: the point of the permitted
region that is extreme against the node's normal. The fillet becomes one of the ball's radius, and keeps its patches;
the nodes beside it slide along the surface by a harmonic displacement.
"""
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, diags_array
from scipy.sparse.linalg import spsolve
from scipy.spatial import cKDTree

from dd3.tools.surface import bernstein, bernstein_slope, from_nodes, points_at

# Patches that are tried around a point; samples that name them, and those along a patch; steps of the closest point.
TRIED, NAMING, MOST_SAMPLES, STEPS = 12, 200, 100, 12
# Rounds of linearised distances, and sweeps over them (Hildreth 1957).
ROUNDS, SWEEPS = 12, 80
# Last step over the distance.
SETTLED = 1e-7
# Steps towards the extreme point; height of the first point above the surface, and their length, over the distance of
# the centres.
PROXIMAL, START, STEP = 4, 0.05, 0.5
# Cosine of the angle between the normal and the way to a closest point above which it is one of the whole surface.
UPRIGHT = 0.98
# Part of the distance by which a centre may be too near.
NEAR = 1e-4
# Ratio of the eigenvalues of `border` above which a node is at a corner.
CORNER = 0.05
# Displacement over the distance of the centres, of a node of a fillet, above which the ball has found no rest.
FARTHEST = 2.0
# Reach of the harmonic displacement over its largest value.
REACH = 8.0


@dataclass
class Distance:
    """Distances from the patches of a surface (patch, v, u, 4), on the side of their normals."""

    net: np.ndarray
    spacing: float  # of the samples that name the nearest patches, mm

    def __post_init__(self) -> None:
        corner = self.net[:, ::2, ::2, :3] / self.net[:, ::2, ::2, 3:]
        length = np.stack([np.linalg.norm(np.diff(corner, axis=axis), axis=-1).max(axis=(1, 2)) for axis in (2, 1)])
        sides = np.clip(np.ceil(length / self.spacing), 2, MOST_SAMPLES).astype(int) + 1
        points, owner = [], []
        for in_u, in_v in np.unique(sides, axis=1).T:
            chosen = np.flatnonzero((sides[0] == in_u) & (sides[1] == in_v))
            u, v = (part.ravel() for part in np.meshgrid(np.linspace(0, 1, in_u), np.linspace(0, 1, in_v)))
            points.append(points_at(self.net[chosen], u, v).reshape(-1, 3))
            owner.append(np.repeat(chosen, in_u * in_v))
        self.owner = np.concatenate(owner)
        self.tree = cKDTree(np.concatenate(points))

    def feet(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the closest points of the patches nearest to points (n, 3), and the unit normals there (n, TRIED, 3);
        a patch may be there several times."""
        _, near = self.tree.query(points, k=min(NAMING, len(self.owner)))
        owner = self.owner[near]
        first = np.ones(owner.shape, bool)
        for k in range(1, owner.shape[1]):
            first[:, k] = (owner[:, :k] != owner[:, k:k + 1]).all(axis=1)
        order = np.argsort(~first, axis=1, kind="stable")[:, :TRIED]
        patch = np.take_along_axis(owner, order, axis=1)
        place, normal = closest(self.net[patch.ravel()], np.repeat(points, patch.shape[1], axis=0))
        return place.reshape(*patch.shape, 3), normal.reshape(*patch.shape, 3)

    def nearest(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the closest points of the surface and the unit normals there, (n, 3) each."""
        place, normal = self.feet(points)
        best = np.linalg.norm(place - points[:, None], axis=2).argmin(axis=1)
        row = np.arange(len(points))
        return place[row, best], normal[row, best]

    def permitted(self, points: np.ndarray, distance: float) -> np.ndarray:
        """Return the points nearest to points (n, 3) that are at least at a distance from the surface, on its side."""
        result = points.copy()
        left = np.arange(len(points))
        for _ in range(ROUNDS):
            normal, bound = self.half_spaces(result[left], distance)
            found = least_move(points[left], normal, bound)
            moving = np.abs(found - result[left]).max(axis=1) > SETTLED * distance
            result[left] = found
            left = left[moving]
            if not len(left):
                break
        return result

    def half_spaces(self, points: np.ndarray, distance: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the half-spaces normal . x >= bound (n, TRIED, 3), (n, TRIED) of the points that are at a distance
        from the patches, linear about points (n, 3)."""
        place, own = self.feet(points)
        normal = points[:, None] - place
        length = np.linalg.norm(normal, axis=2)
        normal /= np.maximum(length, 1e-300)[..., None]
        cosine = (normal * own).sum(axis=2)
        # Elsewhere a point of a neighbour is closer, but for the closest of all.
        upright = np.abs(cosine) > UPRIGHT
        turned = upright | (cosine < 0)
        normal[turned] = own[turned]
        upright[np.arange(len(points)), length.argmin(axis=1)] = True
        return normal, np.where(upright, (normal * place).sum(axis=2) + distance, -np.inf)


def least_move(points: np.ndarray, normal: np.ndarray, bound: np.ndarray) -> np.ndarray:
    """Return the points nearest to points (n, 3) in the half-spaces normal . x >= bound (n, k, 3), (n, k)."""
    result = points.copy()
    weight = np.zeros(bound.shape)
    for _ in range(SWEEPS):
        before = result.copy()
        for k in range(bound.shape[1]):
            lack = bound[:, k] - (normal[:, k] * result).sum(axis=1)
            change = np.maximum(lack, -weight[:, k])
            weight[:, k] += change
            result += change[:, None] * normal[:, k]
        if np.abs(result - before).max(initial=0.0) < 1e-10 * np.abs(bound[np.isfinite(bound)]).max(initial=1.0):
            break
    return result


def closest(net: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the closest point of each patch (n, v, u, 4) to its point (n, 3), and the unit normal there."""
    start = np.linspace(0, 1, 5)
    u, v = (part.ravel() for part in np.meshgrid(start, start))
    best = np.linalg.norm(points_at(net, u, v) - points[:, None], axis=2).argmin(axis=1)
    uv = np.stack([u[best], v[best]], axis=1)
    for _ in range(STEPS):
        place, along_u, along_v = tangents(net, uv)
        gap = points - place
        a, b, d = (along_u**2).sum(axis=1), (along_u * along_v).sum(axis=1), (along_v**2).sum(axis=1)
        right_u, right_v = (along_u * gap).sum(axis=1), (along_v * gap).sum(axis=1)
        # One parameter alone where the other is at its end.
        held_u = ((uv[:, 0] <= 0) & (right_u < 0)) | ((uv[:, 0] >= 1) & (right_u > 0))
        held_v = ((uv[:, 1] <= 0) & (right_v < 0)) | ((uv[:, 1] >= 1) & (right_v > 0))
        b = np.where(held_u | held_v, 0.0, b)
        regular = np.maximum(a * d - b * b, 1e-300)
        move = np.stack([np.where(held_u, 0.0, (d * right_u - b * right_v) / regular),
                         np.where(held_v, 0.0, (a * right_v - b * right_u) / regular)], axis=1)
        uv = np.clip(uv + np.clip(move, -0.5, 0.5), 0.0, 1.0)
    place, along_u, along_v = tangents(net, uv)
    normal = np.cross(along_u, along_v)
    return place, normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)


def tangents(net: np.ndarray, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the point and the tangents along u and v of each patch at its parameters (n, 2)."""
    values = []
    for in_v, in_u in ((bernstein(uv[:, 1]), bernstein(uv[:, 0])), (bernstein(uv[:, 1]), bernstein_slope(uv[:, 0])),
                       (bernstein_slope(uv[:, 1]), bernstein(uv[:, 0]))):
        values.append(np.einsum("na,nb,nabc->nc", in_v, in_u, net))
    weight = values[0][:, 3:]
    place = values[0][:, :3] / weight
    return place, *((slope[:, :3] - slope[:, 3:] * place) / weight for slope in values[1:])


@dataclass
class Rolled:
    """Nodes of the offset (patch, 3, 3, 3), which patches are fillets of the ball, and which ones have changed; whether
    the ball finds a place to rest at all fillets, which it does not at the end of a groove. If not, the nodes are those
    of the plain offset."""

    nodes: np.ndarray
    fillet: np.ndarray
    changed: np.ndarray
    rests: bool = True


def rolled(nodes: np.ndarray, normals: np.ndarray, labels: np.ndarray, face: np.ndarray, distance: float, radius: float
           ) -> Rolled | None:
    """Return the offset of patches with nodes (patch, 3, 3, 3), unit normals there, node numbers and faces; None if no
    fillet is too small for it. The patches have their own normals on the same side.

    The faces beside the fillets make room alone if they are wide enough.
    """
    reach = distance + radius
    fillet = reversed_by(nodes, nodes + reach * normals)
    if not fillet.any():
        return None
    label, first, number = np.unique(labels.ravel(), return_index=True, return_inverse=True)
    number = number.reshape(labels.shape)
    point, normal = nodes.reshape(-1, 3)[first], normals.reshape(-1, 3)[first]
    surface = Distance(from_nodes(nodes), reach / 2)
    held = np.zeros(len(label), bool)
    held[number[fillet].ravel()] = True
    moved = point + distance * normal
    given = extreme(surface, point[held], normal[held], reach) - radius * normal[held] - moved[held]
    if np.linalg.norm(given, axis=1).max() > FARTHEST * reach:
        return Rolled(moved[number], fillet, np.zeros(len(nodes), bool), rests=False)
    beside = np.isin(face, face[held[number].any(axis=(1, 2)) & ~fillet])
    elsewhere = np.zeros(len(label), bool)
    elsewhere[number[~beside & ~fillet].ravel()] = True
    for still in (elsewhere & ~held, np.zeros(len(label), bool)):
        slide = harmonic(point, number, held, still, given)
        result = moved.copy()
        result[held] += given
        sliding = ~held & (np.linalg.norm(slide, axis=1) > NEAR * reach)
        foot, own = surface.nearest(point[sliding] + slide[sliding])
        result[sliding] = surface.permitted(foot + reach * own, reach) - radius * own
        changed = (held | sliding)[number].any(axis=(1, 2))
        if not reversed_by(nodes[changed & ~fillet], result[number][changed & ~fillet]).any():
            break
    return Rolled(result[number], fillet, changed)


def reversed_by(nodes: np.ndarray, moved: np.ndarray) -> np.ndarray:
    """Tell which patches have a direction in which their moved nodes run backwards."""
    along_u = ((nodes[:, :, 2] - nodes[:, :, 0]) * (moved[:, :, 2] - moved[:, :, 0])).sum(axis=2)
    along_v = ((nodes[:, 2] - nodes[:, 0]) * (moved[:, 2] - moved[:, 0])).sum(axis=2)
    return np.asarray((along_u[:, 1] < 0) | (along_v[:, 1] < 0))


def extreme(surface: Distance, point: np.ndarray, normal: np.ndarray, reach: float) -> np.ndarray:
    """Return the points at a distance from the surface that are extreme against the normals, near points of it."""
    centre = surface.permitted(point + START * reach * normal, reach)
    for _ in range(PROXIMAL):
        centre = surface.permitted(centre - STEP * reach * normal, reach)
    return centre


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
    matrix = (diags_array(graph.sum(axis=1)) - graph).tocsr()
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
