# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles of a part's surface: from CAD or facets, in one piece that turns one way, and their rims."""
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from dd3.account import Account
from dd3.errors import LOG, Problem
from dd3.gmsh_session import session
from dd3.tools import faces as cad_faces
from dd3.tools.cad_account import enter_cad
from dd3.tools.cad_file import load, sew
from dd3.tools.facet_files import read_facets

NEAR = 1e-5  # distance of nodes that are one, and of those on a plane of symmetry, over the size of the part


@dataclass
class Triangles:
    """A surface: nodes (n, 3), mm, and the node numbers of its triangles (m, 3), all turning the same way."""

    nodes: np.ndarray
    triangles: np.ndarray


def of_cad(path: Path, size: float | None, side: str | None, words: Sequence[str] | None) -> Triangles:
    """Return the faces of a CAD file as triangles with sides of `size` mm, or a fiftieth of its largest extent."""
    with session() as gmsh:
        load(gmsh, path)
        account = Account()
        enter_cad(path, account, len(gmsh.model.getEntities(2)))
        for line in (*(f"left out: {item}" for item in account.left_out()),
                     *(f"note: {note}" for note in sew(gmsh, path, 0.01, wanted=False))):
            LOG.info(line)
        tags = [tag for _, tag in gmsh.model.getEntities(2)]
        if words:
            tags = cad_faces.chosen(gmsh, path, tags, words, smooth=True)
        elif gmsh.model.getEntities(3):
            tags = cad_faces.side_of_sheet(gmsh, path, tags, np.array([0, 0, 1 if side == "upper" else -1]))
        gmsh.model.removeEntities(gmsh.model.getEntities(3))
        gmsh.model.removeEntities([(2, tag) for _, tag in gmsh.model.getEntities(2) if tag not in tags])
        box = np.reshape(gmsh.model.getBoundingBox(-1, -1), (2, 3))
        length = size or 0.02 * float(np.ptp(box, axis=0).max())
        gmsh.option.setNumber("Mesh.MeshSizeMax", length)
        gmsh.option.setNumber("Mesh.MeshSizeMin", 0.3 * length)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 16)
        gmsh.model.mesh.generate(2)
        labels, places, _ = gmsh.model.mesh.getNodes()
        row = np.zeros(int(labels.max()) + 1, int)
        row[labels.astype(int)] = np.arange(len(labels))
        found = [gmsh.model.mesh.getElementsByType(2, tag)[1] for tag in tags]
    return Triangles(places.reshape(-1, 3), row[np.concatenate(found).astype(int)].reshape(-1, 3))


def of_facets(path: Path) -> Triangles:
    """Return the facets of a file as triangles."""
    mesh = read_facets(path)
    for note in mesh.notes:
        if note.startswith("left out: "):
            LOG.info(note)
    quads = mesh.facets[:, 3] >= 0
    return Triangles(mesh.nodes, np.vstack((mesh.facets[:, :3], mesh.facets[quads][:, [0, 2, 3]])))


def prepared(path: Path, mesh: Triangles, mirror: Sequence[int], least: float = 0.0) -> Triangles:
    """Return a surface in one piece whose triangles turn the same way, seen from above, with its mirror images. Nodes
    that are nearer to each other than `least`, mm, become one."""
    nodes, triangles = mesh.nodes, mesh.triangles
    near = max(NEAR * float(np.ptp(nodes, axis=0).max()), least)
    for axis in mirror:
        if not (abs(nodes[:, axis]) < near).any():
            raise Problem(f"{path}: no node on the plane of symmetry {'xyz'[axis]} = 0")
        image = nodes * np.where(np.arange(3) == axis, -1.0, 1.0)
        triangles = np.vstack((triangles, triangles[:, ::-1] + len(nodes)))
        nodes = np.vstack((nodes, image))
    used, corner = np.unique(triangles, return_inverse=True)
    nodes, triangles = nodes[used], corner.reshape(-1, 3)
    _, same = connected_components(pairs_matrix(cKDTree(nodes).query_pairs(near, output_type="ndarray"), len(nodes)),
                                   directed=False)
    _, first = np.unique(same, return_index=True)
    nodes, triangles = nodes[first], same[triangles]
    triangles = triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]
    # Two slivers on one side whose far corners became one node lie upon each other.
    _, same, count = np.unique(np.sort(triangles, axis=1), axis=0, return_inverse=True, return_counts=True)
    used, corner = np.unique(triangles[count[same.ravel()] == 1], return_inverse=True)
    nodes, triangles = nodes[used], turned_alike(corner.reshape(-1, 3))
    pieces, _ = connected_components(pairs_matrix(np.vstack((triangles[:, :2], triangles[:, 1:])), len(nodes)),
                                     directed=False)
    if pieces > 1:
        raise Problem(f"{path}: {pieces} surfaces that are not joined; expected one")
    if area_vectors(nodes, triangles).sum(axis=0)[2] < 0:
        triangles = triangles[:, ::-1]
    return Triangles(nodes, triangles)


def turned_alike(triangles: np.ndarray) -> np.ndarray:
    """Return triangles (m, 3) that turn the same way as their neighbours; where they cannot, some do not."""
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    low, high = np.minimum(start, end), np.maximum(start, end)
    order = np.lexsort((high, low))
    first, second = order[:-1], order[1:]
    joined = (low[first] == low[second]) & (high[first] == high[second])
    first, second = first[joined], second[joined]
    # Each triangle is there as it is, and turned over: neighbours run along their side in opposite directions.
    count, alike = len(triangles), start[first] != start[second]
    first, second = first // 3, second // 3
    links = np.vstack([np.stack([first + side * count, second + np.where(alike, side, 1 - side) * count], axis=1)
                       for side in (0, 1)])
    _, group = connected_components(pairs_matrix(links, 2 * count), directed=False)
    return np.where((group[:count] > group[count:])[:, None], triangles[:, ::-1], triangles)


def pairs_matrix(pairs: np.ndarray, count: int) -> coo_array:
    """Return the links between pairs as a sparse matrix."""
    return coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))


def area_vectors(nodes: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Return the normals of triangles with their areas as lengths."""
    a, b, c = (nodes[triangles[:, k]] for k in range(3))
    return np.asarray(0.5 * np.cross(b - a, c - a))


def rims(path: Path, triangles: np.ndarray) -> list[np.ndarray]:
    """Return the closed rims of a surface as node numbers in their order, in the direction of the triangles."""
    sides = np.vstack([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    known = {(int(a), int(b)) for a, b in sides}
    if len(known) < len(sides):
        raise Problem(f"{path}: sides with more than two triangles, or a surface of one side only")
    free = [(a, b) for a, b in known if (b, a) not in known]
    after = dict(free)
    if len(after) < len(free):
        raise Problem(f"{path}: two rims meet in a node")
    left, found = dict(after), []
    while left:
        start = next(iter(left))
        line, node = [], start
        while node in left:
            line.append(node)
            node = left.pop(node)
        found.append(np.array(line))
    if not found:
        raise Problem(f"{path}: a closed surface; there is no rim")
    return found
