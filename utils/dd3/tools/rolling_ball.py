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

from dd3.tools.nagata import groups
from dd3.tools.rims import bands_of
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
FARTHEST = 3.0
# Cosine of the angle between a valley and the way to a corner at its end; reach of the displacement from there over its
# largest value.
ALIGNED, DECAY = 0.95, 3.0
# Cosine of the angle between the normals at a sharp edge.
SHARP = np.cos(np.radians(5.0))
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
        upright = (np.abs(cosine) > UPRIGHT) | (length < NEAR * distance)
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
class Patches:
    """Patches of a surface: nodes (patch, 3, 3, 3), unit normals there, on the side of the patches' own ones, plain
    displacements of the nodes, and node numbers (patch, 3, 3)."""

    nodes: np.ndarray
    normals: np.ndarray
    shift: np.ndarray
    labels: np.ndarray

    def sides(self, values: np.ndarray) -> np.ndarray:
        """Return the values (patch, 3, 3, ...) along the four edges, anticlockwise: (patch, 4, 3, ...)."""
        return np.stack([values[:, 0], values[:, :, 2], values[:, 2, ::-1], values[:, ::-1, 0]], axis=1)

    def pairs(self) -> np.ndarray:
        """Return the pairs of edges, patch * 4 + edge, that two patches share (n, 2)."""
        ends = np.sort(self.sides(self.labels)[:, :, ::2], axis=2).reshape(-1, 2)
        order = np.lexsort(ends.T)
        same = (ends[order[1:]] == ends[order[:-1]]).all(axis=1) & (ends[order[1:], 0] != ends[order[1:], 1])
        return np.stack([order[:-1][same], order[1:][same]], axis=1)

    def valleys(self) -> np.ndarray:
        """Return the pairs of edges at which the surface has a concave sharp edge (n, 2)."""
        pairs = self.pairs()
        first, second = pairs.T
        normal = self.sides(self.normals)[:, :, 1].reshape(-1, 3)
        middle = self.sides(self.nodes)[:, :, 1].reshape(-1, 3)
        cosine = (normal[first] * normal[second]).sum(axis=1)
        into = self.nodes[second // 4, 1, 1] - middle[first]
        return pairs[(cosine < SHARP) & ((into * normal[first]).sum(axis=1) > 0)]

    def split(self, valleys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return node numbers that are shared only across edges that are no valleys (patch, 3, 3), and those of the
        valleys on both sides, in the direction of the first patch (n, 2, 3)."""
        entry = np.arange(self.labels.size).reshape(self.labels.shape)
        along = self.sides(entry).reshape(-1, 3)
        pairs = self.pairs()
        smooth = pairs[~np.isin(pairs[:, 0] * 4 * len(self.nodes) + pairs[:, 1],
                                valleys[:, 0] * 4 * len(self.nodes) + valleys[:, 1])]
        # The edges of neighbours run against each other.
        number = groups(entry.size, along[smooth[:, 0]].ravel(), along[smooth[:, 1], ::-1].ravel())
        number = number.reshape(self.labels.shape)
        sides = number.ravel()[along]
        return number, np.stack([sides[valleys[:, 0]], sides[valleys[:, 1], ::-1]], axis=1)


@dataclass
class Rolled:
    """Nodes of the offset (patch, 3, 3, 3), which patches are fillets of the ball, and which ones have changed; nodes
    of the patches that round sharp edges (n, 3, 3, 3); whether the ball finds a place to rest at all fillets, which it
    does not at the end of a groove. If not, the nodes are those of the plain offset."""

    nodes: np.ndarray
    fillet: np.ndarray
    changed: np.ndarray
    rounding: np.ndarray
    rests: bool = True


def rolled(patches: Patches, face: np.ndarray, distance: float, radius: float, tolerance: float) -> Rolled | None:
    """Return the offset of patches of faces; None if no fillet is too small for it and no sharp edge concave. The
    rounding of sharp edges is within the tolerance, mm.

    The faces beside the fillets make room alone if they are wide enough.
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
    given = extreme(surface, foot[held], normal[held], reach) - radius * normal[held] - moved[held]
    if np.linalg.norm(given, axis=1).max() > FARTHEST * reach:
        return Rolled(nodes + patches.shift, fillet, np.zeros(len(nodes), bool), np.zeros((0, 3, 3, 3)), rests=False)
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


def rounding(valley: np.ndarray, result: np.ndarray, normal: np.ndarray, point: np.ndarray, radius: float,
             tolerance: float) -> np.ndarray:
    """Return the nodes (n, 3, 3, 3) of patches between both sides of valleys (n, 2, 3), numbers of nodes: arcs of the
    ball, and parts of spheres where three or more valleys meet."""
    if not len(valley):
        return np.zeros((0, 3, 3, 3))
    angle = np.arccos(np.clip((normal[valley[:, 0]] * normal[valley[:, 1]]).sum(axis=2), -1, 1)).max()
    halves = (bands_of(float(angle), radius, tolerance) + 1) // 2
    centre = result + radius * normal
    parts = np.linspace(0, 1, 4 * halves + 1)
    strips = np.stack([mixed(centre, normal, valley[:, 0], valley[:, 1], part, radius) for part in parts], axis=1)
    found = [strips[:, 2 * i:2 * i + 3] for i in range(2 * halves)]
    facing = [np.broadcast_to(normal[valley[:, 0, 1]] + normal[valley[:, 1, 1]], (len(valley), 3))] * len(found)
    for ring in corners(valley, point):
        whole = [normal[ring], np.roll(normal[ring], -1, axis=0), np.roll(normal[ring], 1, axis=0)]
        top = normal[ring].sum(axis=0) / np.linalg.norm(normal[ring].sum(axis=0))
        middle = centre[ring].mean(axis=0)
        for own, following, before in zip(*whole):
            ways = sphere(own, following, before, top, 2 * halves)
            places = middle - radius * ways
            blocks = [places[2 * i:2 * i + 3, 2 * k:2 * k + 3] for i in range(halves) for k in range(halves)]
            found.append(np.array(blocks))
            facing.append(np.broadcast_to(top, (len(blocks), 3)))
    nodes = np.concatenate(found)
    across = np.cross(nodes[:, 1, 2] - nodes[:, 1, 0], nodes[:, 2, 1] - nodes[:, 0, 1])
    flip = (across * np.concatenate(facing)).sum(axis=1) < 0
    nodes[flip] = nodes[flip][:, :, ::-1]
    return nodes


def along_valleys(surface: Distance, valley: np.ndarray, point: np.ndarray, normal: np.ndarray, reach: float
                  ) -> np.ndarray:
    """Return displacements of the nodes of valleys (n, 2, 3) along them, away from corners, where the ball comes to
    rest at a distance from the corner; they fall linearly from there. No others are displaced."""
    result = np.zeros_like(point)
    rings = corners(valley, point)
    if not rings:
        return result
    place = np.array([point[ring[0]] for ring in rings])
    rest = np.array([extreme(surface, point[ring], normal[ring], reach).mean(axis=0) for ring in rings])
    apart = cKDTree(place).query(place, k=2)[0][:, 1]
    for nodes in (valley[:, side, k] for side in (0, 1) for k in range(3)):
        along = point[valley[:, 0, 2]] - point[valley[:, 0, 0]]
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        for corner, centre, free in zip(place, rest, apart):
            way = point[nodes] - corner
            length = np.linalg.norm(way, axis=1)
            chosen = (length > 0) & (np.abs((way * along).sum(axis=1)) > ALIGNED * length)
            way = way[chosen] / length[chosen, None]
            shift = (centre - corner) @ way.T
            part = 1 - length[chosen] / np.minimum(DECAY * np.maximum(shift, 1e-300), free / 2)
            # A node is in the reach of one corner at most.
            near = (part > 0) & (shift > 0)
            result[nodes[chosen][near]] = (shift * part)[near, None] * way[near]
    return result


def mixed(centre: np.ndarray, normal: np.ndarray, first: np.ndarray, second: np.ndarray, part: float, radius: float
          ) -> np.ndarray:
    """Return the points of arcs from the nodes `first` to the nodes `second` at a part of their angle."""
    return (1 - part) * centre[first] + part * centre[second] - radius * between(normal[first], normal[second], part)


def between(first: np.ndarray, second: np.ndarray, part: float | np.ndarray) -> np.ndarray:
    """Return the unit vectors at a part of the angle between unit vectors."""
    angle = np.arccos(np.clip((first * second).sum(axis=-1, keepdims=True), -1, 1))
    small = angle < 1e-9
    sine = np.where(small, 1.0, np.sin(angle))
    return np.where(small, (1 - part) * first + part * second,
                    (np.sin((1 - part) * angle) * first + np.sin(part * angle) * second) / sine)


def corners(valley: np.ndarray, point: np.ndarray) -> list[list[int]]:
    """Return the rings of nodes, at one point each, around which three or more valleys (n, 2, 3) meet."""
    following: dict[int, int] = {}
    for (a, _, b), (c, _, d) in valley.tolist():
        # Anticlockwise about its end, a valley leads from the right side of it to the left.
        following[c] = a
        following[b] = d
    rings, left = [], set(following)
    while left:
        ring = [left.pop()]
        while (after := following.get(ring[-1])) in left:
            left.remove(after)
            ring.append(after)
        if len(ring) > 2 and following.get(ring[-1]) == ring[0] and np.ptp(point[ring], axis=0).max() < 1e-9 + 1e-9 * \
                np.abs(point[ring]).max():
            rings.append(ring)
    return rings


def sphere(own: np.ndarray, following: np.ndarray, before: np.ndarray, top: np.ndarray, count: int) -> np.ndarray:
    """Return unit vectors (count + 1, count + 1, 3) between one at a corner, the middles of the arcs to its neighbours,
    and the top of the ring: arcs at the sides, blended between (Coons 1967)."""
    t = np.linspace(0, 1, count + 1)[:, None]
    right, up = between(own, following, t / 2), between(own, before, t / 2)
    far_right, far_up = between(right[-1], top, t), between(up[-1], top, t)
    u, v = t[None], t[:, None]
    ways = ((1 - v) * right[None] + v * far_up[None] + (1 - u) * up[:, None] + u * far_right[:, None]
            - (1 - u) * (1 - v) * own - u * (1 - v) * right[-1] - (1 - u) * v * up[-1] - u * v * top)
    result: np.ndarray = ways / np.linalg.norm(ways, axis=2, keepdims=True)
    return result


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
