# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes of CAD faces in Gmsh, as patches within a tolerance.

The faces are meshed together with quadrilaterals of second order. Their nodes lie on the CAD and are shared, and each
is one patch of degree 2 x 2, so the surface has no gaps however the faces are trimmed. Faces with four edges get a
regular mesh. The divisions of a face grow until its distance from the CAD, measured at points between the nodes, is
below the tolerance.
"""
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from dd3.errors import Problem
from dd3.progress import Progress, doing
from dd3.tools.closest import closest
from dd3.tools.division import Division
from dd3.tools.joints import find_joints, folded, kinks
from dd3.tools.limits import limited, started
from dd3.tools.nagata import groups
from dd3.tools.parameters import filled, parameters_of
from dd3.tools.surface import areas_at, from_nodes, grid, points_at

# Gmsh's order of the nodes of a quadrilateral of 9 nodes, as (v, u) rows.
NINE = np.array([[0, 4, 1], [7, 8, 5], [3, 6, 2]])
MOST_ROUNDS = 8
# Failures in a row that Gmsh blames on no face, after which it is given up.
MOST_FAILURES = 3
# Patches of a face beyond which it is not divided further.
MOST_PATCHES = 2000
# Kink inside a face above which it is divided further, degrees, in this many rounds.
KINK, KINK_ROUNDS = 0.5, 2
# Distance of nodes from a face over the tolerance above which its kinks are those of a gap that was sewn, which are the
# larger the shorter the patches.
OF_GAP = 0.25
# Processor time after which Gmsh is given up, s: a mesh of all faces.
MESH_TIME = 300.0
# Part of a patch's largest area of a parameter square below which it has no normal.
FLAT_CORNER = 1e-3
# Part of the largest distance below which that between nodes of a line says nothing of the direction.
LEAST_FRACTION = 0.1
# Points of the distance: between the nodes.
PLACES = grid(5)


@dataclass
class Model:
    """What was meshed: patches' nodes (patch, v, u, 3), their parameters on the CAD's face (patch, v, u, 2; NaN where
    unknown), node numbers and faces, and the edge of its face that u runs along (see `directions`); per face its tag,
    its name and its largest distance from the CAD, mm."""

    nodes: np.ndarray = field(default_factory=lambda: np.empty(0))
    uv: np.ndarray = field(default_factory=lambda: np.empty(0))
    labels: np.ndarray = field(default_factory=lambda: np.empty(0))
    face: np.ndarray = field(default_factory=lambda: np.empty(0))
    along: np.ndarray = field(default_factory=lambda: np.empty(0))
    tags: list = field(default_factory=list)
    names: list = field(default_factory=list)
    origin: list = field(default_factory=list)  # the faces of the file that they are of, 0 for a fillet of a sharp edge
    distance: np.ndarray = field(default_factory=lambda: np.empty(0))
    solid: bool = False  # all faces belong to solids, whose normals are known to point outwards
    parts: list = field(default_factory=list)
    notes: list = field(default_factory=list)


def collect(gmsh: Any, model: Model) -> None:
    """Take the quadrilaterals of the mesh."""
    label, xyz, _ = gmsh.model.mesh.getNodes()
    place = np.zeros(int(label.max()) + 1, int)
    place[label.astype(int)] = np.arange(len(label))
    xyz = np.reshape(xyz, (-1, 3))
    labels, parameters, face = [], [], []
    for index, tag in enumerate(model.tags):
        types, _, members = gmsh.model.mesh.getElements(2, tag)
        table = parameters_of(gmsh, tag, len(place))
        for kind, member in zip(types, members):
            if kind != 10:
                raise Problem(f"{model.names[index]}: Gmsh left elements that are no quadrilaterals")
            member = np.reshape(member, (-1, 9)).astype(int)[:, NINE]
            labels.append(member)
            parameters.append(filled(table[member]))
            face.append(np.full(len(member), index))
    if not labels:
        raise Problem("Gmsh made no mesh of the faces")
    model.labels, model.uv, model.face = (np.concatenate(part) for part in (labels, parameters, face))
    model.nodes = xyz[place[model.labels]]


def distances(gmsh: Any, model: Model, net: np.ndarray, shift: np.ndarray | None = None,
              known: dict[int, tuple[np.ndarray, np.ndarray]] | None = None) -> np.ndarray:
    """Return the distances of the patches from the CAD at PLACES (patch, 25), mm.

    With a shift of each patch, the distances from the surface at that distance along the patches' normals. `known` has
    patches of the faces, which are not measured again as long as they are the same, with their distances; it is set.
    """
    distance = np.zeros((len(net), len(PLACES[0])))
    waiting = []
    for index, tag in enumerate(model.tags):
        chosen = np.flatnonzero(model.face == index)
        if known and tag in known and np.array_equal(known[tag][0], net[chosen]):
            distance[chosen] = known[tag][1]
        elif len(chosen):
            waiting.append((tag, chosen))

    def measured(faces: list[tuple[int, np.ndarray]]) -> list[np.ndarray]:
        return [distances_of(gmsh, tag, net[chosen], model.uv[chosen], None if shift is None else shift[chosen, None])
                for tag, chosen in faces]

    # Half of the patches in another process.
    count = np.cumsum([len(chosen) for _, chosen in waiting])
    half = int(np.searchsorted(count, count[-1] / 2)) + 1 if waiting else 0
    others = started(lambda: measured(waiting[half:]))
    for (tag, chosen), found in zip(waiting, measured(waiting[:half]) + others()):
        distance[chosen] = found
        if known is not None:
            known[tag] = net[chosen], found
    return distance


def distances_of(gmsh: Any, tag: int, net: np.ndarray, uv: np.ndarray, shift: np.ndarray | None) -> np.ndarray:
    """Return the distances of patches of one face at PLACES (patch, 25), mm, see `distances`; `shift` (patch, 1)."""
    point = points_at(net, *PLACES)
    if shift is None:
        return np.asarray(np.linalg.norm(closest(gmsh, tag, point, uv)[0] - point, axis=2))
    area = areas_at(net, *PLACES)
    length = np.linalg.norm(area, axis=2)
    # At a corner of 180 degrees a patch has no normal.
    regular = length > FLAT_CORNER * length.max(axis=1, keepdims=True)
    normal = area / np.where(regular, length, 1.0)[..., None]
    # The search begins on the CAD: from afar its steps do not contract where the radius is smaller.
    moved = np.where(regular[..., None], point - shift[..., None] * normal, point)
    foot = closest(gmsh, tag, moved, uv)[0]
    height = ((point - foot) * normal).sum(axis=2)
    away = np.linalg.norm(point - foot, axis=2)
    return np.asarray(np.abs(np.where(regular, height - shift, away - np.abs(shift))))


def by_face(model: Model, values: np.ndarray) -> np.ndarray:
    """Return the largest value of the patches (patch,) of each face, 0 for a face without patches."""
    result = np.zeros(len(model.tags))
    np.maximum.at(result, model.face, values)
    return result


def by_direction(model: Model, in_u: np.ndarray, in_v: np.ndarray) -> np.ndarray:
    """Return the largest of the values along u and v of the patches, along the first and the second edge of each face
    (face, 2); without a regular mesh the larger one for both."""
    first = np.choose(model.along + 1, [np.maximum(in_u, in_v), in_u, in_v])
    second = np.choose(model.along + 1, [np.maximum(in_u, in_v), in_v, in_u])
    return np.stack([by_face(model, first), by_face(model, second)], axis=1)


def directional(model: Model, distance: np.ndarray) -> np.ndarray:
    """Return the largest distance of each face, by the direction of its first and its second edge (face, 2), mm: the
    larger one is the largest of all.

    The distance between nodes of a line along u is due to the divisions along u.
    """
    square = distance.reshape(-1, 5, 5)
    found = by_direction(model, square[:, ::2, 1::2].max(axis=(1, 2)), square[:, 1::2, ::2].max(axis=(1, 2)))
    larger = found.max(axis=1)
    found[larger < LEAST_FRACTION * model.distance] = 1.0
    return found * (model.distance / np.maximum(found.max(axis=1), 1e-300))[:, None]


def normals(gmsh: Any, model: Model) -> np.ndarray:
    """Return the unit normals of the CAD at the nodes (patch, v, u, 3)."""
    result = np.zeros_like(model.nodes)
    for index, tag in enumerate(model.tags):
        chosen = np.flatnonzero(model.face == index)
        if len(chosen):
            points = model.nodes[chosen].reshape(-1, 9, 3)
            uv = closest(gmsh, tag, points, model.uv[chosen], at_nodes=True)[1]
            result[chosen] = np.reshape(gmsh.model.getNormal(tag, uv.ravel()), (-1, 3, 3, 3))
    # At a pole Gmsh may give the other side.
    flipped = (result * result[:, 1:2, 1:2]).sum(axis=3) < 0
    result[flipped] *= -1
    return result


def middle_normals(model: Model) -> np.ndarray:
    """Return normals in the middle of the patches, not of unit length."""
    nodes = model.nodes
    return np.cross(nodes[:, 1, 2] - nodes[:, 1, 0], nodes[:, 2, 1] - nodes[:, 0, 1])


def worst_kinks(model: Model, net: np.ndarray) -> np.ndarray:
    """Return the largest kink inside each face that divisions along its first and its second edge leave (face, 2),
    degrees."""
    joints = find_joints(net)
    angle = kinks(net, joints)
    inside = model.face[joints.first // 4] == model.face[joints.second // 4]
    in_u, in_v = np.zeros(len(net)), np.zeros(len(net))
    for edge in (joints.first, joints.second):
        # Edges 1 and 3 are where u ends.
        for values, chosen in ((in_u, inside & (edge % 2 == 1)), (in_v, inside & (edge % 2 == 0))):
            np.maximum.at(values, edge[chosen] // 4, angle[chosen])
    return by_direction(model, in_u, in_v)


def directions(gmsh: Any, model: Model, regular: set[int], sides: dict[int, list[list[int]]]) -> np.ndarray:
    """Return for each patch 0 if its u runs along the first and third side of its face, 1 if along the others, -1 if
    the face has no regular mesh.

    Opposite edges of patches form strips, which end at the edges of the face that they are parallel to.
    """
    corner = model.labels[:, [0, 0, 2, 2], [0, 2, 2, 0]]
    ends = np.sort(np.stack([corner, np.roll(corner, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    strip = 2 * np.repeat(np.arange(len(corner)), 4) + np.tile([0, 1], 2 * len(corner))
    _, edge = np.unique(ends, axis=0, return_inverse=True)
    face = np.repeat(model.face, 4)
    order = np.lexsort((face, edge.ravel()))
    pair = order[:-1][(np.diff(edge.ravel()[order]) == 0) & (np.diff(face[order]) == 0)]
    other = order[1:][(np.diff(edge.ravel()[order]) == 0) & (np.diff(face[order]) == 0)]
    group = groups(2 * len(corner), strip[pair], strip[other])
    along = np.full(len(corner), -1)
    for index, tag in enumerate(model.tags):
        if tag not in regular:
            continue
        chosen = np.flatnonzero(face == index)
        for position in (0, 1):
            nodes = np.concatenate([gmsh.model.mesh.getNodes(1, edge, includeBoundary=True)[0]
                                    for k in (position, position + 2) for edge in sides[tag][k]])
            on_edge = chosen[np.isin(ends[chosen], nodes).all(axis=1)]
            found = np.isin(group[strip[chosen]], group[strip[on_edge]])
            along[strip[chosen[found]] // 2] = np.where(strip[chosen[found]] % 2 == 0, position, 1 - position)
    return along


@doing("meshing the faces by patches")
def mesh_within(gmsh: Any, path: Path, model: Model, tolerance: float, longest: float, progress: Progress) -> None:
    """Mesh the faces, with patches along free edges of a length at most; divide further those that miss the tolerance,
    have kinks, or folded patches."""
    division = Division(gmsh, model.tags, longest)
    best, start, failures = None, time.process_time(), 0
    for rounds in range(MOST_ROUNDS):
        failed = mesh_once(gmsh, path, model, division)
        progress((rounds + 1) / MOST_ROUNDS)
        if not failed:
            kink, bent = faults(gmsh, model, rounds)
            kink[division.gap > OF_GAP * tolerance] = 0.0
            score = (len(bent), (model.distance > tolerance).sum(), (kink > KINK).any(axis=1).sum())
            if best is None or score < best[0]:
                best = score, model.nodes, model.uv, model.labels, model.face, model.distance
            if not any(score):
                break
            full = np.bincount(model.face, minlength=len(model.tags)) > MOST_PATCHES
            if not division.refine(np.where(full[:, None], 0.0, division.distance / tolerance),
                                   np.where(full[:, None], 0.0, kink / KINK),
                                   bent - set(np.flatnonzero(full).tolist())):
                break
        failures = failures + 1 if len(failed) == len(model.tags) else 0
        if time.process_time() - start > MESH_TIME or failures == MOST_FAILURES:
            break
    if best is None:
        raise Problem(f"{path}: Gmsh cannot mesh {', '.join(model.names[model.tags.index(tag)] for tag in failed)}; "
                      "divide or mend it in the CAD program, leave its part out by --part, or convert an STL export")
    _, model.nodes, model.uv, model.labels, model.face, model.distance = best


def mesh_once(gmsh: Any, path: Path, model: Model, division: Division) -> list[Any]:
    """Mesh the faces and measure their distance; return the faces where that failed."""
    with limited(MESH_TIME, f"{path}: the faces are not meshed in {MESH_TIME:.0f} s of processor time: leave out "
                            "what the sheet does not touch, in the CAD program or by --part"):
        failed = division.mesh(gmsh)
        if not failed:
            collect(gmsh, model)
            model.along = directions(gmsh, model, division.regular, division.sides)
            distance = distances(gmsh, model, from_nodes(model.nodes), known=division.measured)
            model.distance = by_face(model, distance.max(axis=1))
            division.distance = directional(model, distance)
            division.gap = by_face(model, distance.reshape(-1, 5, 5)[:, ::2, ::2].max(axis=(1, 2)))
    return failed


def faults(gmsh: Any, model: Model, rounds: int) -> tuple[np.ndarray, set[int]]:
    """Return the largest kinks inside each face (face, 2), degrees, 0 after the first rounds; and the faces with
    folds, within a patch or between patches."""
    net = from_nodes(model.nodes)
    kink = worst_kinks(model, net) if rounds < KINK_ROUNDS else np.zeros((len(model.tags), 2))
    return kink, set(model.face[folded(net)].tolist()) | overlapping(gmsh, model)


def overlapping(gmsh: Any, model: Model) -> set[int]:
    """Return the faces whose patches lie upon each other: some look to the other side of the CAD than most."""
    found = set()
    side = middle_normals(model)
    for index, tag in enumerate(model.tags):
        chosen = np.flatnonzero(model.face == index)
        uv = model.uv[chosen, 1, 1]
        chosen, uv = chosen[~np.isnan(uv).any(axis=1)], uv[~np.isnan(uv).any(axis=1)]
        cosine = (np.reshape(gmsh.model.getNormal(tag, uv.ravel()), (-1, 3)) * side[chosen]).sum(axis=1)
        if (cosine > 0).any() and (cosine < 0).any():
            found.add(index)
    return found
