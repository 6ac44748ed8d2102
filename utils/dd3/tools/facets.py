# SPDX-License-Identifier: GPL-3.0-or-later
"""Facets to patches: reading, mending, parts, sides, offset."""
from pathlib import Path
from typing import Any

import numpy as np

from dd3.errors import Problem
from dd3.tools import mend, moved
from dd3.tools.facet_files import Facets, read_facets
from dd3.tools.joints import find_joints, kinks
from dd3.tools.nagata import CREASE, estimate_normals, facet_areas, groups, unfolded_patches, unit
from dd3.tools.report import REACH, plural, up, where
from dd3.tools.settings import ToolSettings
from dd3.tools.surface import Surface

# Largest coordinate, mm; beyond it a damaged number is likelier than a tool.
FARTHEST = 1e9


def load(options: ToolSettings) -> Facets:
    """Return the mended facets of a file, of the parts wanted."""
    path = options.source
    mesh = read_facets(path)
    mesh.nodes = mesh.nodes * options.scale
    choose(path, mesh, options.part)
    size = diagonal(path, mesh)
    merge = mend.merged(mesh, max(options.sew or 0.0, mend.SAME_NODE * size))
    empty = mend.without_repeats(mesh)
    doubled = mend.without_doubles(mesh)
    empty += mend.without_slivers(mesh)
    doubled += mend.without_doubles(mesh)
    if not len(mesh.facets):
        raise Problem(f"{path}: no facet has an area")
    inserted, left = mend.with_whole_edges(mesh, max(options.sew or 0.0, mend.SAME_NODE * size))
    refuse_gaps(path, mesh, left)
    for count, what in ((merge, "nodes merged"), (empty, "facets without area removed"),
                        (doubled, "doubled facets left out"), (inserted, "nodes inserted into edges of other facets")):
        if count:
            mesh.notes.append(f"{what}: {count}")
    return mesh


def diagonal(path: Path, mesh: Facets) -> float:
    """Return the diagonal of the box of the facets, mm; refuse damaged coordinates, and nodes that span no surface."""
    if not np.isfinite(mesh.nodes).all():
        raise Problem(f"{path}: a coordinate is not a number")
    used = mesh.nodes[np.unique(mesh.facets[mesh.facets >= 0])]
    if np.abs(used).max(initial=0.0) > FARTHEST:
        raise Problem(f"{path}: a coordinate of {np.abs(used).max():.3g} mm; expected at most {FARTHEST:g} mm")
    size = np.linalg.norm(np.ptp(used, axis=0))
    if size == 0.0 or np.linalg.svd(used - used.mean(axis=0), compute_uv=False)[1] <= mend.SAME_NODE * size:
        raise Problem(f"{path}: all nodes are on one line or at one point")
    return float(size)


def refuse_gaps(path: Path, mesh: Facets, inside: list[Any]) -> None:
    """Refuse facets with cracks, or with nodes inside the edges of others."""
    pairs, distance = mend.gaps(mesh, REACH)
    if len(pairs):
        worst = distance.argmax()
        raise Problem(f"{path}: error: {plural(len(pairs), 'pair')} of nodes on free edges up to "
                      f"{distance[worst]:.3g} mm apart, the widest at x y z = {where(mesh.nodes[pairs[worst, 0]])}; "
                      f"--sew {up(distance[worst]):g} joins them")
    if inside:
        raise Problem(f"{path}: error: {plural(len(inside), 'node')} inside the edges of other facets, the first at "
                      f"x y z = {where(mesh.nodes[inside[0]])}; mend the mesh so that facets meet in whole edges")


def choose(path: Path, mesh: Facets, wanted: list[str] | None) -> None:
    """Keep the facets of the parts wanted, by name or number; all by default."""
    if not wanted:
        return
    chosen = np.zeros(len(mesh.facets), bool)
    for word in wanted:
        found = [number for number, name in enumerate(mesh.names)
                 if word.lower() == str(name).lower() or word == str(name).split()[0]]
        if not found and word.isdecimal() and 0 < int(word) <= len(mesh.names):
            found = [int(word) - 1]
        if not found:
            there = ", ".join(f"{number} '{name}'" for number, name in enumerate(mesh.names, 1))
            raise Problem(f"{path}: no part '{word}'; there are {there}")
        chosen |= np.isin(mesh.part, found)
    mend.keep(mesh, chosen)


def sides_of(mesh: Facets) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray,
                                    np.ndarray]:
    """Return area vectors, centres, regions between sharp edges, signs, bodies, which are open, and facets that
    cannot have a side."""
    sign, body, is_open, twisted = mend.consistent(mesh)
    area = facet_areas(mesh.nodes, mesh.facets)
    corner = np.where(mesh.facets < 0, mesh.facets[:, :1], mesh.facets)
    centre = mesh.nodes[corner].mean(axis=1)
    _, _, facet, _ = mend.edge_table(mesh.facets)
    pairs, _ = mend.pairs_of(mesh.facets)
    first, second = facet[pairs].T
    normal = unit(area) * sign[:, None]
    smooth = (normal[first] * normal[second]).sum(axis=1) >= np.cos(np.radians(CREASE))
    region = groups(len(mesh.facets), first[smooth], second[smooth])
    return area, centre, region, sign, body, is_open, twisted


def turned_number(sign: np.ndarray, body: np.ndarray) -> int:
    """Return how many facets have not the sign of the greater part of their body."""
    total = np.bincount(body)
    negative = np.bincount(body, weights=sign < 0)
    return int(np.minimum(negative, total - negative).sum())


def patches(mesh: Facets, distance: float) -> tuple[Surface, np.ndarray, float]:
    """Return the surface of facets, moved by a distance along the normals; the estimated distance from the true
    surface for each of its faces, and the largest angle at a smooth edge, degrees."""
    net = estimate_normals(mesh)
    nodes = mesh.nodes
    if distance:
        real = mesh.facets.ravel() >= 0
        label = mesh.facets.ravel()[real]
        nodes = nodes.copy()
        nodes[label] += moved.shift_of(label, net.normals.reshape(-1, 3)[real], distance)
    control, facet = unfolded_patches(nodes, net)
    face = net.region[facet]
    largest = np.zeros(net.region.max() + 1)
    np.maximum.at(largest, net.region, net.estimate)
    raise_by_kinks(largest, control, face)
    many = len(np.unique(mesh.part)) > 1
    part = np.zeros(net.region.max() + 1, int)
    part[net.region] = mesh.part
    names = [f"region {number + 1}" + (f" (part {mesh.names[part[number]]})" if many else "")
             for number in range(len(largest))]
    notes = list(mesh.notes)
    if net.straight:
        notes.append(f"edges kept straight, as the normals at their ends do not fit: {net.straight}")
    return Surface(control, face, names, notes), largest, net.angle.max() if len(net.angle) else 0.0


def raise_by_kinks(estimate: np.ndarray, net: np.ndarray, face: np.ndarray) -> None:
    """Raise the estimated distance of faces to an eighth of the kink times the length of the edge at a smooth joint:
    the error of the normals shows there."""
    joints = find_joints(net)
    angle = kinks(net, joints)
    points = joints.points[joints.first]
    # Edges of facets are halved in patches.
    length = 2 * np.linalg.norm(points[:, -1] - points[:, 0], axis=1)
    smooth = angle < CREASE
    np.maximum.at(estimate, face[joints.first[smooth] // 4], (np.radians(angle) * length / 8)[smooth])
