# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles of the faces in a session of Gmsh, with the normals and curvatures of the CAD."""
import re
from collections import defaultdict
from pathlib import Path
from typing import Any

import numpy as np

from dd3.errors import Problem
from dd3.part.shape import SHARP, Edge, Shape, angle_between, unit
from dd3.progress import doing
from dd3.tools.division import Division
from dd3.tools.joints import signs
from dd3.tools.limits import limited
from dd3.tools.parameters import parameters_of

# Largest and least side of a triangle over the diagonal of the part's box, and triangles of a turn of 360 degrees.
LONGEST, SHORTEST, TURN = 1 / 25, 1 / 250, 18
# Processor time for the triangles, and for each face, s.
TIME, TIME_PER_FACE = 6.0, 0.006
OPTIONS = {"Mesh.RecombineAll": 0, "Mesh.SubdivisionAlgorithm": 0, "Mesh.Algorithm": 5, "Mesh.ElementOrder": 1,
           "Mesh.MeshSizeFromCurvature": TURN, "Mesh.MeshSizeExtendFromBoundary": 0, "Mesh.MeshSizeFromPoints": 0}
# Deviation of an edge from its chord, over its length, up to which it is straight.
STRAIGHT = 1e-4
TRIANGLE = 2  # kind of element in Gmsh


@doing("sampling the faces")
def sampled(gmsh: Any, path: Path, tags: list[int]) -> Shape:
    """Return the shape of the faces `tags`."""
    failed = triangulate(gmsh, path, tags)
    nodes, triangles, face = elements(gmsh, tags)
    if not len(triangles):
        raise Problem(f"{path}: Gmsh makes no triangles of the faces: they are damaged; mend them in the CAD program")
    corner_normal, place, normal, curvature = on_cad(gmsh, nodes, triangles, face)
    kinds = {tag: str(gmsh.model.getType(2, tag)) for tag in tags}
    areas = {tag: float(gmsh.model.occ.getMass(2, tag)) for tag in tags}
    centres = {tag: np.array(gmsh.model.occ.getCenterOfMass(2, tag)) for tag in tags}
    edges, pieces, piece_edge = edges_of(gmsh, tags)
    piece_of = find_pieces(triangles, pieces)
    corners = nodes[triangles]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    shape = Shape(nodes, triangles, face, np.linalg.norm(flat, axis=1), corner_normal, place, normal, curvature, kinds,
                  areas, centres, edges, pieces, piece_edge, piece_of, np.zeros(len(face), int), False, failed)
    orient(shape, flat)
    set_angles(shape)
    return shape


def triangulate(gmsh: Any, path: Path, tags: list[int]) -> list[int]:
    """Make the triangles; return the faces of which Gmsh makes none."""
    set_sizes(gmsh, tags)
    seconds = max(TIME, TIME_PER_FACE * len(tags))
    gmsh.logger.start()
    try:
        with limited(seconds, lambda: f"{path}: {len(tags)} faces are not read in {seconds:.0f} s of processor time, "
                     f"{at_face(gmsh)}: take the part that is to be formed by --part, or its faces by --faces"):
            gmsh.model.mesh.generate(2)
    except Exception:  # Gmsh raises nothing more specific
        pass
    gmsh.logger.stop()
    return [tag for tag in tags if not len(gmsh.model.mesh.getElements(2, tag)[0])]


def at_face(gmsh: Any) -> str:
    """Return in words at which face Gmsh is, by its log."""
    found = [match[1] for line in gmsh.logger.get() if (match := re.search(r"Meshing surface (\d+)", line))]
    return f"the last one that was begun is face {found[-1]}" if found else "not even their edges"


def set_sizes(gmsh: Any, tags: list[int]) -> None:
    """Set the options and the divisions of the edges."""
    division = Division(gmsh, tags)
    gmsh.model.mesh.clear()
    gmsh.model.mesh.removeConstraints()
    sizes = {"Mesh.MeshSizeMax": LONGEST * division.size, "Mesh.MeshSizeMin": SHORTEST * division.size}
    for name, value in {**OPTIONS, **sizes}.items():
        gmsh.option.setNumber(name, value)
    division.constrain(gmsh, division.equal(divisions(division)))


def divisions(division: Division) -> dict[int, int]:
    """Return the divisions of each edge: by its turn, the longest side, and on faces without a regular mesh by the
    largest curvature of their edges, as the triangles there are about equilateral."""
    need: defaultdict[int, int] = defaultdict(int)
    for tag, loop in division.loops.items():
        edges = [edge for edge in set(map(abs, loop)) if division.length[edge] > 1e-9 * division.size]
        irregular = division.curved[tag] and tag not in division.regular
        sharpest = max((division.turn[edge, tag] / division.length[edge] for edge in edges), default=0.0)
        for edge in edges:
            length = division.length[edge]
            turn = max(division.turn[edge, tag], sharpest * length if irregular else 0.0)
            count = min(max(turn * TURN / 360, length / (LONGEST * division.size), 1.0),
                        max(length / (SHORTEST * division.size), division.turn[edge, tag] * TURN / 360))
            need[edge] = max(need[edge], int(np.ceil(count - 1e-6)))
    return need


def elements(gmsh: Any, tags: list[int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return nodes by label, triangles and their faces."""
    label, xyz, _ = gmsh.model.mesh.getNodes()
    nodes = np.zeros((int(label.max(initial=0)) + 1, 3))
    nodes[label.astype(int)] = np.reshape(xyz, (-1, 3))
    triangles, face = [np.zeros((0, 3), int)], [np.zeros(0, int)]
    for tag in tags:
        for kind, members in zip(*gmsh.model.mesh.getElements(2, tag)[::2]):
            if kind == TRIANGLE:
                triangles.append(np.reshape(members, (-1, 3)).astype(int))
                face.append(np.full(len(triangles[-1]), tag))
    return nodes, np.concatenate(triangles), np.concatenate(face)


def on_cad(gmsh: Any, nodes: np.ndarray, triangles: np.ndarray, face: np.ndarray
          ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return the normals at the corners of the triangles and, at a point of each on the CAD, place, normal and
    principal curvatures."""
    corner = np.zeros((len(triangles), 3, 3))
    place, normal = np.zeros((len(triangles), 3)), np.zeros((len(triangles), 3))
    curvature = np.zeros((len(triangles), 2))
    for tag in np.unique(face).tolist():
        chosen = np.flatnonzero(face == tag)
        if gmsh.model.getType(2, tag) == "Plane":
            place[chosen] = nodes[triangles[chosen]].mean(axis=1)
            normal[chosen] = gmsh.model.getNormal(tag, [0.0, 0.0])
            corner[chosen] = normal[chosen][:, None]
            continue
        table = parameters_of(gmsh, tag, len(nodes))[triangles[chosen]]
        uv = middle_parameters(gmsh, tag, table, nodes[triangles[chosen]])
        flat = uv.ravel()
        place[chosen] = np.reshape(gmsh.model.getValue(2, tag, flat), (-1, 3))
        normal[chosen] = np.reshape(gmsh.model.getNormal(tag, flat), (-1, 3))
        # Gmsh turns the normals of reversed faces, not the signs of the curvatures.
        along = np.reshape(gmsh.model.getDerivative(2, tag, flat), (-1, 2, 3))
        natural = np.sign((np.cross(along[:, 0], along[:, 1]) * normal[chosen]).sum(axis=1))
        largest, least = gmsh.model.getPrincipalCurvatures(tag, flat)[:2]
        curvature[chosen] = np.nan_to_num(np.stack([largest, least], axis=1)) * natural[:, None]
        known = np.where(np.isnan(table), uv[:, None], table)
        corner[chosen] = np.reshape(gmsh.model.getNormal(tag, known.ravel()), (-1, 3, 3))
    return corner, place, unit(normal), curvature


def middle_parameters(gmsh: Any, tag: int, table: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Return the parameters of a point of each triangle (m, 2): the mean of those of its corners (m, 3, 2), or where
    these are unknown, or on both sides of a seam, those of the point of the CAD that is nearest to its middle."""
    uv, middle = table.mean(axis=1), corners.mean(axis=1)
    known = ~np.isnan(uv).any(axis=1)
    place = np.full_like(middle, np.inf)
    if known.any():
        place[known] = np.reshape(gmsh.model.getValue(2, tag, uv[known].ravel()), (-1, 3))
    longest = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    astray = np.linalg.norm(place - middle, axis=1) > longest / 2
    if astray.any():
        uv[astray] = np.reshape(gmsh.model.getParametrization(2, tag, middle[astray].ravel()), (-1, 2))
    return uv


def edges_of(gmsh: Any, tags: list[int]) -> tuple[dict[int, Edge], np.ndarray, np.ndarray]:
    """Return the edges of the faces, the nodes of their pieces and the edges of these."""
    edges: dict[int, Edge] = {}
    for tag in tags:
        for _, edge in gmsh.model.getBoundary([(2, tag)], combined=False, oriented=False):
            if edge not in edges:
                length = float(gmsh.model.occ.getMass(1, edge))
                edges[edge] = Edge(length, is_straight(gmsh, edge, length))
            if tag not in edges[edge].faces:
                edges[edge].faces.append(tag)
    pieces, owner = [np.zeros((0, 2), int)], [np.zeros(0, int)]
    for edge in edges:
        for members in gmsh.model.mesh.getElements(1, edge)[2]:
            pieces.append(np.reshape(members, (-1, 2)).astype(int))
            owner.append(np.full(len(pieces[-1]), edge))
    return edges, np.concatenate(pieces), np.concatenate(owner)


def is_straight(gmsh: Any, edge: int, length: float) -> bool:
    """Tell whether an edge is straight."""
    if gmsh.model.getType(1, edge) == "Line":
        return True
    low, high = (bound[0] for bound in gmsh.model.getParametrizationBounds(1, edge))
    points = np.reshape(gmsh.model.getValue(1, edge, np.linspace(low, high, 5)), (-1, 3))
    chord = unit(points[-1] - points[0])
    away = points - points[0]
    return bool(np.linalg.norm(away - (away @ chord)[:, None] * chord, axis=1).max() <= STRAIGHT * length)


def find_pieces(triangles: np.ndarray, pieces: np.ndarray) -> np.ndarray:
    """Return for each side of the triangles the piece of an edge on it, -1 without one."""
    count = int(triangles.max()) + 1
    key = np.sort(pieces, axis=1) @ np.array([count, 1])
    order = np.argsort(key)
    sides = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2), axis=2) @ np.array([count, 1])
    at = np.minimum(np.searchsorted(key[order], sides), max(len(key) - 1, 0))
    return np.where(key[order[at]] == sides, order[at], -1) if len(key) else np.full(sides.shape, -1)


def orient(shape: Shape, flat: np.ndarray) -> None:
    """Give the triangles of each body one orientation, outwards if it is closed, and their normals the same side."""
    count = len(shape.triangles)
    side = np.stack([shape.triangles, np.roll(shape.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    key = np.sort(side, axis=1) @ np.array([len(shape.nodes), 1])
    order = np.argsort(key, kind="stable")
    _, first, number = np.unique(key[order], return_index=True, return_counts=True)
    pair = first[number == 2]
    a, b = order[pair], order[pair + 1]
    sign, body, _ = signs(count, a // 3, b // 3, side[a, 0] != side[b, 0])
    open_bodies = np.unique(body[order[first[number == 1]] // 3])
    shape.closed = not len(open_bodies) and not len(shape.failed)
    middle = shape.middle
    for one in range(int(body.max()) + 1):
        chosen = body == one
        vectors = sign[chosen, None] * flat[chosen]
        if one in open_bodies:  # the side of the greater part of its area in the file
            outwards = ((vectors * shape.normal[chosen]).sum(axis=1)).sum()
        else:
            outwards = ((middle[chosen] - middle[chosen].mean(axis=0)) * vectors).sum()
        if outwards < 0:
            sign[chosen] *= -1
    shape.body = body
    turned = sign < 0
    shape.triangles[turned] = shape.triangles[turned][:, ::-1]
    shape.piece_of[turned] = shape.piece_of[turned][:, [1, 0, 2]]
    shape.corner_normal[turned] = shape.corner_normal[turned][:, ::-1]
    outward = unit(sign[:, None] * flat)
    wrong = (shape.normal * outward).sum(axis=1) < 0
    shape.normal[wrong] *= -1
    shape.curvature[wrong] *= -1
    lost = np.linalg.norm(shape.normal, axis=1) < 0.5
    shape.normal[lost] = outward[lost]
    backwards = (shape.corner_normal * outward[:, None]).sum(axis=2) < 0
    shape.corner_normal[backwards] *= -1
    shape.curvature.sort(axis=1)


def set_angles(shape: Shape) -> None:
    """Set the angles of the edges of two faces: the largest along each, by the normals of both faces there."""
    piece = shape.piece_of.ravel()
    order = np.argsort(piece, kind="stable")
    order = order[piece[order] >= 0]
    _, first, number = np.unique(piece[order], return_index=True, return_counts=True)
    a, b = order[first[number == 2]], order[first[number == 2] + 1]
    two = shape.face[a // 3] != shape.face[b // 3]  # a seam has one face on both sides
    a, b = a[two], b[two]
    normal = [shape.corner_normal[t // 3, t % 3] + shape.corner_normal[t // 3, (t + 1) % 3] for t in (a, b)]
    angle = angle_between(*normal)
    middle = shape.nodes[shape.pieces[piece[a]]].mean(axis=1)
    convex = ((shape.middle[b // 3] - middle) * normal[0]).sum(axis=1) < 0
    angle = np.where(angle > SHARP, np.where(convex, angle, -angle), 0.0)
    for edge, value in zip(shape.piece_edge[piece[a]].tolist(), angle.tolist()):
        if abs(value) > abs(shape.edges[edge].angle):
            shape.edges[edge].angle = value
