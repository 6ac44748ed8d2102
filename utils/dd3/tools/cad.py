# SPDX-License-Identifier: GPL-3.0-or-later
"""CAD files (STEP, IGES, BREP) as Bézier patches, through Gmsh's Python package.

The faces are meshed together with quadrilaterals of second order. Their nodes lie on the CAD and are shared, and each
is one patch of degree 2 x 2, so the surface has no gaps however the faces are trimmed. Faces with four edges get a
regular mesh. The divisions of a face grow until its distance from the CAD, measured at points between the nodes, is
below the tolerance.
"""
import os
import re
import sys
import time
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from dd3.account import Account
from dd3.errors import Problem
from dd3.progress import Progress, doing
from dd3.tools import faces, mitres, moved
from dd3.tools.cad_account import enter_cad
from dd3.tools.closest import closest
from dd3.tools.cut import cut, is_closed, planes_through, planes_through_pole
from dd3.tools.division import Division
from dd3.tools.joints import find_joints, folded, kinks, to_chords
from dd3.tools.limits import limited
from dd3.tools.nagata import groups
from dd3.tools.parameters import filled, length_of, parameters_of
from dd3.tools.report import REACH, named, up
from dd3.tools.settings import CAD, ToolSettings
from dd3.tools.surface import Surface, areas_at, from_nodes, grid, points_at

SUFFIXES = CAD
# Gmsh's order of the nodes of a quadrilateral of 9 nodes, as (v, u) rows.
NINE = np.array([[0, 4, 1], [7, 8, 5], [3, 6, 2]])
MOST_ROUNDS = 8
# Failures in a row that Gmsh blames on no face, after which it is given up.
MOST_FAILURES = 3
# Patches of a face beyond which it is not divided further.
MOST_PATCHES = 2000
# Kink inside a face above which it is divided further, degrees, in this many rounds.
KINK, KINK_ROUNDS = 0.5, 2
# Processor time after which OpenCASCADE and Gmsh are given up, s: reading, sewing, and on top of each for a MB of the
# file; a mesh of all faces. They do not end on some files.
READ_TIME, SEW_TIME, TIME_PER_MB, MESH_TIME = 60.0, 60.0, 20.0, 300.0
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


@contextmanager
def silence() -> Iterator[None]:
    """Discard what OpenCASCADE prints on the standard output."""
    sys.stdout.flush()
    kept = os.dup(1)
    with Path(os.devnull).open("wb") as null:
        os.dup2(null.fileno(), 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)


@doing("reading the CAD file")
def load(gmsh: Any, path: Path) -> None:
    """Read the shapes of a file."""
    gmsh.clear()
    refuse_cut(path)
    # Shapes are kept as they are; the lengths become mm by the unit that the file states.
    try:
        with silence(), limited(allowed(READ_TIME, path), f"{path}: OpenCASCADE does not end reading the file: it is "
                                "damaged, or too large"):
            gmsh.model.occ.importShapes(str(path), highestDimOnly=False)
            gmsh.model.occ.synchronize()
    except Exception as error:  # Gmsh raises nothing more specific
        raise Problem(f"{path}: not a CAD file that OpenCASCADE reads: {error}") from None
    if not gmsh.model.getEntities(2):
        kind = "curves or points only" if gmsh.model.getEntities(0) else "no shapes"
        raise Problem(f"{path}: no faces; the file holds {kind}")


def allowed(seconds: float, path: Path) -> float:
    """Return the processor time for the file, s."""
    return seconds + TIME_PER_MB * path.stat().st_size / 1e6


def refuse_cut(path: Path) -> None:
    """Refuse BREP and IGES texts without their end: OpenCASCADE does not end reading the one, and takes the part of the
    other that is there."""
    data = path.read_bytes()
    lines = data[-400:].split(b"\n")
    if path.suffix.lower() in (".brep", ".brp"):
        text = b"CASCADE Topology" in data[:200] and data.lstrip()[:4] != b"Open"
        cut = text and not re.search(rb"\*\s+[-+]\d+ \d+\s*$", data[-200:])
    else:  # the section of a line of IGES is in column 73: S is the first, T the last
        text = path.suffix.lower() in (".iges", ".igs") and data[72:73] == b"S"
        cut = text and not any(line[72:73] == b"T" for line in lines)
    if cut:
        raise Problem(f"{path}: the file is cut off")


def free_edges(gmsh: Any) -> list[int]:
    """Return the edges with one face, those without length and seams left out."""
    single = [tag for _, tag in gmsh.model.getEntities(1) if len(gmsh.model.getAdjacencies(1, tag)[0]) == 1]
    return [tag for tag in single if length_of(gmsh, tag) and not is_seam(gmsh, tag)]


def find_gaps(gmsh: Any) -> list[tuple[float, int, int]]:
    """Return the pairs of free edges that run beside each other, with the largest distance of the first one from the
    second, mm, the widest gap last."""
    single = free_edges(gmsh)
    fine = []
    for tag in single:
        low, high = gmsh.model.getParametrizationBounds(1, tag)
        fine.append(np.reshape(gmsh.model.getValue(1, tag, np.linspace(low[0], high[0], 65)), (-1, 3)))
    found = []
    for i, (tag, points) in enumerate(zip(single, fine)):
        limit = min(REACH, gmsh.model.occ.getMass(1, tag) / 4)
        for j, other in enumerate(fine):
            gap = max(to_chords(point, other) for point in points[16:49:16]) if j != i else np.inf
            if gap <= limit:
                found.append((float(gap), tag, single[j]))
    return sorted(found, key=lambda pair: pair[0])


def said_of_gaps(gmsh: Any, gaps: list[tuple[float, int, int]], sewn: float | None) -> str:
    """Return what is to be said of gaps that are left after the faces were sewn within `sewn` mm."""
    worst, *edges = gaps[-1]
    faces = [int(gmsh.model.getAdjacencies(1, tag)[0][0]) for tag in edges]
    return (f"free edges of the CAD up to {worst:.3g} mm apart, the widest between faces {faces[0]} and {faces[1]}; "
            + (f"--sew {up(worst):g} joins them" if worst > (sewn or 0.0)
               else "their courses differ, so --sew does not join them; mend the CAD"))


def refuse_gaps(gmsh: Any, path: Path, sewn: float | None) -> None:
    """Refuse free edges that run beside each other: the faces were not joined, or not sewn within `sewn` mm."""
    gaps = find_gaps(gmsh)
    if gaps:
        raise Problem(f"{path}: error: {said_of_gaps(gmsh, gaps, sewn)}")


def is_seam(gmsh: Any, edge: int) -> bool:
    """Tell whether the only face of an edge has it on both sides."""
    up = gmsh.model.getAdjacencies(1, edge)[0]
    both = [abs(tag) for _, tag in gmsh.model.getBoundary([(2, up[0])], combined=False, oriented=True)]
    return both.count(edge) > 1


@doing("sewing the faces")
def sew(gmsh: Any, path: Path, tolerance: float, wanted: bool) -> list[str]:
    """Sew faces whose edges are not shared, if that joins any; return a note. Solids are sewn if `wanted` only."""
    before = len(free_edges(gmsh)) if wanted or not gmsh.model.getEntities(3) else 0
    if not before:
        return []
    faces = len(gmsh.model.getEntities(2))
    try:
        with silence(), limited(allowed(SEW_TIME, path), f"{path}: the faces are not sewn within {tolerance:g} mm in "
                                f"{allowed(SEW_TIME, path):.0f} s of processor time: take a smaller --sew, or sew them "
                                "in the CAD program"):
            gmsh.model.occ.healShapes([], tolerance, False, False, False, True, True)
            gmsh.model.occ.synchronize()
        after = len(free_edges(gmsh))
        lost = faces - len(gmsh.model.getEntities(2))
    except Exception as error:
        if wanted:
            raise Problem(f"{path}: the faces cannot be sewn within {tolerance:g} mm: {error}") from None
        after, lost = before, 0
    if after >= before or (lost > 0 and not wanted):
        load(gmsh, path)
        return []
    return [f"sewn: {before - after} of {before} free edges of the CAD, within {tolerance:g} mm"]


def part_names(gmsh: Any) -> list[tuple[str, set[int]]]:
    """Return the parts of the model: the name and the faces of each solid, or of each set of connected faces."""
    parts = []
    for number, (_, tag) in enumerate(gmsh.model.getEntities(3), 1):
        name = gmsh.model.getEntityName(3, tag).split("/")[-1] or f"solid {number}"
        faces = {abs(face) for _, face in gmsh.model.getBoundary([(3, tag)], combined=False, oriented=False)}
        parts.append((name, faces))
    inside = set().union(*(faces for _, faces in parts))
    loose = [tag for _, tag in gmsh.model.getEntities(2) if tag not in inside]
    edges = defaultdict(list)
    for tag in loose:
        for _, edge in gmsh.model.getBoundary([(2, tag)], combined=False, oriented=False):
            edges[abs(edge)].append(tag)
    while loose:
        group, waiting = set(), [loose[0]]
        while waiting:
            tag = waiting.pop()
            if tag in group:
                continue
            group.add(tag)
            for _, edge in gmsh.model.getBoundary([(2, tag)], combined=False, oriented=False):
                waiting += edges[abs(edge)]
        name = next((gmsh.model.getEntityName(2, tag).split("/")[-1] for tag in sorted(group)
                     if gmsh.model.getEntityName(2, tag)), "")
        parts.append((name or f"shell {len(parts) + 1}", group))
        loose = [tag for tag in loose if tag not in group]
    return parts


def choose(path: Path, parts: list[tuple[str, set[int]]], wanted: list[str] | None) -> list[int]:
    """Return the tags of the faces of the parts wanted, by name or number; all by default."""
    if not wanted:
        return sorted(set().union(*(faces for _, faces in parts)))
    chosen: set[Any] = set()
    for word in wanted:
        found = [faces for number, (name, faces) in enumerate(parts, 1)
                 if word.lower() == name.lower() or word == str(number)]
        if not found:
            there = ", ".join(f"{number} '{name}'" for number, (name, _) in enumerate(parts, 1))
            raise Problem(f"{path}: no part '{word}'; there are {there}")
        chosen.update(*found)
    return sorted(chosen)


def doubled(gmsh: Any, tags: list[int]) -> list[tuple[int, int]]:
    """Return the faces that lie on an earlier one: same area, centre and box."""
    box = np.array([gmsh.model.getBoundingBox(2, tag) for tag in tags]).reshape(-1, 6)
    centre = np.array([gmsh.model.occ.getCenterOfMass(2, tag) for tag in tags]).reshape(-1, 3)
    area = np.array([gmsh.model.occ.getMass(2, tag) for tag in tags])
    size = np.linalg.norm(box[:, 3:] - box[:, :3], axis=1)
    result = {}
    for i, near in enumerate(cKDTree(centre).query_ball_point(centre, 2e-5 * size)):
        for j in sorted(near):
            if j < i and tags[j] not in result and abs(area[i] - area[j]) <= 1e-5 * area[i] and \
                    max(np.abs(box[i] - box[j]).max(), np.abs(centre[i] - centre[j]).max()) <= 1e-5 * size[i]:
                result[tags[i]] = tags[j]
                break
    return list(result.items())


def single(gmsh: Any) -> list[str]:
    """Remove the faces that lie on others, of which none belongs to a solid, as they cannot be sewn; return a note."""
    if gmsh.model.getEntities(3):
        return []
    twins = doubled(gmsh, [tag for _, tag in gmsh.model.getEntities(2)])
    gmsh.model.occ.remove([(2, tag) for tag, _ in twins], recursive=True)
    gmsh.model.occ.synchronize()
    return [said_of_doubled(twins)] if twins else []


def said_of_doubled(twins: list[tuple[int, int]]) -> str:
    """Return what is to be said of faces and those on which they lie."""
    return "doubled faces left out: " + ", ".join(f"{tag} (on {other})" for tag, other in twins)


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


def distances(gmsh: Any, model: Model, net: np.ndarray, shift: np.ndarray | None = None) -> np.ndarray:
    """Return the distances of the patches from the CAD at PLACES (patch, 25), mm.

    With a shift of each patch, the distances from the surface at that distance along the patches' normals.
    """
    distance = np.zeros((len(net), len(PLACES[0])))
    for index, tag in enumerate(model.tags):
        chosen = np.flatnonzero(model.face == index)
        if not len(chosen):
            continue
        point = points_at(net[chosen], *PLACES)
        if shift is not None:
            area = areas_at(net[chosen], *PLACES)
            length = np.linalg.norm(area, axis=2)
            # At a corner of 180 degrees a patch has no normal.
            regular = length > FLAT_CORNER * length.max(axis=1, keepdims=True)
            normal = area / np.where(regular, length, 1.0)[..., None]
            wanted = shift[chosen, None]
            # The search begins on the CAD: from afar its steps do not contract where the radius is smaller.
            moved = np.where(regular[..., None], point - wanted[..., None] * normal, point)
            foot = closest(gmsh, tag, moved, model.uv[chosen])[0]
            height = ((point - foot) * normal).sum(axis=2)
            away = np.linalg.norm(point - foot, axis=2)
            distance[chosen] = np.abs(np.where(regular, height - wanted, away - np.abs(wanted)))
        else:
            foot = closest(gmsh, tag, point, model.uv[chosen])[0]
            distance[chosen] = np.linalg.norm(foot - point, axis=2)
    return distance


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


def directions(gmsh: Any, model: Model, regular: set[int], loops: dict[int, list[int]]) -> np.ndarray:
    """Return for each patch 0 if its u runs along the first and third edge of its face, 1 if along the others, -1 if
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
            nodes = np.concatenate([gmsh.model.mesh.getNodes(1, abs(loops[tag][k]), includeBoundary=True)[0]
                                    for k in (position, position + 2)])
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
            model.along = directions(gmsh, model, division.regular, division.loops)
            distance = distances(gmsh, model, from_nodes(model.nodes))
            model.distance = by_face(model, distance.max(axis=1))
            division.distance = directional(model, distance)
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


def read_file(gmsh: Any, path: Path, model: Model, options: ToolSettings) -> list[int]:
    """Read a CAD file: set the parts and notes of the model, and return the faces that are chosen."""
    account = Account()
    load(gmsh, path)
    enter_cad(path, account, len(gmsh.model.getEntities(2)))
    model.notes += [f"left out: {item}" for item in account.left_out()]
    model.notes += single(gmsh)
    model.notes += sew(gmsh, path, options.sew or options.tolerance, options.sew is not None)
    if options.scale != 1.0:
        gmsh.model.occ.dilate(gmsh.model.getEntities(), 0, 0, 0, *[options.scale] * 3)
        gmsh.model.occ.synchronize()
    refuse_gaps(gmsh, path, options.sew)
    model.parts = part_names(gmsh)
    return faces.chosen(gmsh, path, choose(path, model.parts, options.part), options.faces, options.smooth)


def read_closed(gmsh: Any, model: Model, options: ToolSettings) -> list[int]:
    """Read a part whose openings were filled as it was read: set the parts and notes of the model, and return its
    faces."""
    options.closed.load(gmsh)
    model.notes += options.closed.notes
    model.parts = part_names(gmsh)
    return [tag for _, tag in gmsh.model.getEntities(2)]


def read_cad(gmsh: Any, path: Path, options: ToolSettings, progress: Progress) -> Model:
    """Return the model of a CAD file, meshed within the tolerance."""
    model = Model()
    tags = read_closed(gmsh, model, options) if options.closed else read_file(gmsh, path, model, options)
    in_solids = {abs(tag) for _, tag in gmsh.model.getBoundary(gmsh.model.getEntities(3), combined=False,
                                                               oriented=False)}
    number = options.closed.numbers if options.closed else {}
    file_tag = {tag: number.get(tag, tag) for tag in tags}
    if options.taken:
        tags = sorted(options.taken)
    elif not options.closed and options.thickness and not options.faces and set(tags) <= in_solids:
        # The punch touches a sheet from above.
        up = (0, 0, -1 if options.side == "die" else 1)
        tags = faces.side_of_sheet(gmsh, path, tags, moved.rotation(options.rotate).T @ up)
    if options.sharp and in_solids.issuperset(tags):
        origin, said = mitres.rounded(gmsh, tags, options.sharp)
        file_tag = {tag: file_tag.get(old, 0) for tag, old in origin.items()}
        tags = list(file_tag)
        in_solids = set(tags)
        model.notes += said
    twins = doubled(gmsh, tags)
    if twins:
        model.notes.append(said_of_doubled(twins))
    model.tags = [tag for tag in tags if tag not in {twin for twin, _ in twins}]
    model.solid = set(model.tags) <= in_solids
    others = [(2, tag) for _, tag in gmsh.model.getEntities(2) if tag not in model.tags]
    owner = {tag: name for name, faces in model.parts for tag in faces}
    model.origin = [file_tag[tag] for tag in model.tags]
    model.names = [f"face {old} ({gmsh.model.getType(2, tag)}"
                   + (f", {owner.get(tag, owner.get(old))})" if len(model.parts) > 1 else ")")
                   if old else "fillet of a sharp edge"
                   for tag, old in zip(model.tags, model.origin)]
    gmsh.model.removeEntities(gmsh.model.getEntities(3))
    gmsh.model.removeEntities(others)
    tolerance = max(options.tolerance, options.sew or 0.0)
    around = {tag: planes for tag in model.tags if (planes := planes_through_pole(gmsh, tag))}
    closed = [tag for tag in model.tags if tag not in around and is_closed(gmsh, tag)]
    if around or closed:
        through = [*around.values(), *(planes_through(gmsh, tag) for tag in closed)]
        cut_closed(gmsh, path, model, [*around, *closed], list(chain.from_iterable(through)))
    mesh_within(gmsh, path, model, tolerance, getattr(options, "longest", np.inf), progress)
    return model


def cut_closed(gmsh: Any, path: Path, model: Model, closed: list[int], planes: list[tuple[np.ndarray, np.ndarray]]
              ) -> None:
    """Cut faces, all by planes, as some close in themselves; the parts keep the names."""
    gmsh.model.mesh.clear()
    with silence(), limited(allowed(SEW_TIME, path), f"{path}: faces that close in themselves are not cut in "
                            f"{allowed(SEW_TIME, path):.0f} s of processor time; cut them in the CAD program"):
        parts = cut(gmsh, model.tags, planes)
    model.solid = False  # the parts have sides of their own
    model.notes.append("faces that close in themselves were cut: "
                       + named(model, [model.tags.index(tag) for tag in closed]))
    model.names = [name for name, part in zip(model.names, parts) for _ in part]
    model.origin = [tag for tag, part in zip(model.origin, parts) for _ in part]
    model.tags = [tag for part in parts for tag in part]


def surface_of(model: Model, nodes: np.ndarray | None = None) -> Surface:
    """Return the surface of a model, or with its nodes moved."""
    return Surface(from_nodes(model.nodes if nodes is None else nodes), model.face, model.names, list(model.notes))


def outward(gmsh: Any, model: Model) -> np.ndarray | None:
    """Return the signs that turn the patches of solids outwards; None if faces belong to no solid."""
    if not model.solid:
        return None
    return np.where((middle_normals(model) * normals(gmsh, model)[:, 1, 1]).sum(axis=1) < 0, -1, 1)
