# SPDX-License-Identifier: GPL-3.0-or-later
"""The blank of an LS-DYNA deck as a mesh of hexahedra."""

from dataclasses import dataclass

import numpy as np

from dd3.dyna.deck import Deck, Part
from dd3.dyna.laws import Units
from dd3.errors import Problem
from dd3.mesh import Mesh, renumber, turn_mirrored

POINTS = 7  # through the thickness, where the deck has fewer than 5
MOST_POINTS = 15


@dataclass
class Blank:
    """The mesh with the labels of the deck, its mean normal, thickness, points, and the element.

    upper: the label of the node above each node of a shell; empty for solids. edge: that of the first element.
    """

    mesh: Mesh
    normal: np.ndarray
    thickness: float
    points: int
    element: str
    upper: dict[int, int]
    edge: np.ndarray

    @property
    def size(self) -> float:
        """The length of an edge of the first element, mm."""
        return float(np.linalg.norm(self.edge))


def blank_of(deck: Deck, part: Part, units: Units) -> Blank:
    """Return the blank of a part: shells extruded about their mid-surface, hexahedra as they are."""
    kinds = {dimension for dimension, _ in part.cells}
    if len(kinds) != 1:
        raise Problem(f"{part.place}: error: the blank, part {part.number}, has shells and solids")
    corners = 4 if kinds == {2} else 8
    other = sum(len(members) != corners for _, members in part.cells)
    if other:
        raise Problem(f"{part.place}: error: {other} of the {len(part.cells)} elements of the blank "
                      f"(part {part.number}) are no {'quadrilaterals' if corners == 4 else 'hexahedra'}; mesh it with "
                      "these alone")
    nodes = {label: np.array(point) * units.length for label, point in deck.nodes.items()}
    cells = [members for _, members in part.cells]
    missing = {label for members in cells for label in members} - nodes.keys()
    if missing:
        raise Problem(f"{deck.path}: node {min(missing)} of an element has no coordinates")
    edge = nodes[cells[0][1]] - nodes[cells[0][0]]
    return of_shells(deck, part, cells, nodes, units, edge) if corners == 4 else of_solids(cells, nodes, edge)


def face_normals(cells: list[tuple[int, ...]], nodes: dict[int, np.ndarray]) -> np.ndarray:
    """Return the normals of quadrilaterals, their areas as lengths."""
    points = np.array([[nodes[label] for label in cell[:4]] for cell in cells])
    return np.cross(points[:, 2] - points[:, 0], points[:, 3] - points[:, 1]) / 2


def of_shells(deck: Deck, part: Part, cells: list[tuple[int, ...]], nodes: dict[int, np.ndarray], units: Units,
              edge: np.ndarray) -> Blank:
    """Return the blank of shells."""
    section = deck.sections.get(part.section)
    if section is None or section.keyword != "*SECTION_SHELL":
        raise Problem(f"{part.place}: error: the shells of part {part.number} have no *SECTION_SHELL {part.section}")
    row = section.row(1)
    thickness = row.number(0) * units.length
    if not thickness > 0:
        raise Problem(f"{row.place}: error: a shell thickness of {thickness:g} mm; expected a number > 0")
    normals = face_normals(cells, nodes)
    if not np.all(np.linalg.norm(normals, axis=1) > 0):
        raise Problem(f"{part.place}: error: a shell of the blank, part {part.number}, has no area")
    mean = normals.sum(axis=0)
    if not np.linalg.norm(mean) > 0:
        raise Problem(f"{part.place}: error: the normals of the shells of part {part.number} cancel each other")
    upward = upright(mean)
    turned = normals @ upward < 0
    normals[turned] *= -1
    sums: dict[int, np.ndarray] = {}
    for cell, normal in zip(cells, normals):
        for label in cell:
            sums[label] = sums.get(label, 0.0) + normal
    first, mesh = max(nodes), Mesh()
    middle = -float(np.clip(row.number(4), -1, 1)) * thickness / 2  # of the shell, from its reference surface
    for label, normal in sums.items():
        along = normal / np.linalg.norm(normal)
        for side, name in ((-0.5, label), (0.5, label + first)):
            mesh.nodes[name] = tuple((nodes[label] + (middle + side * thickness) * along).tolist())
    for i, (cell, back) in enumerate(zip(cells, turned), 1):
        ring = list(cell[::-1] if back else cell)
        mesh.elements[i] = ring + [label + first for label in ring]
    points = section.row(0).label(3)
    return Blank(mesh, upward, thickness, min(points, MOST_POINTS) if points >= 5 else POINTS,
                 "solid_shell", {label: label + first for label in sums}, edge)


def upright(vector: np.ndarray) -> np.ndarray:
    """Return the unit vector that points to +z, as the program turns the thickness; an upright sheet keeps its side."""
    unit: np.ndarray = vector / np.linalg.norm(vector)
    return -unit if unit[2] < -1e-6 else unit


def of_solids(cells: list[tuple[int, ...]], nodes: dict[int, np.ndarray], edge: np.ndarray) -> Blank:
    """Return the blank of hexahedra, a flat sheet: its normal is the direction in which the nodes vary least."""
    mesh = Mesh({label: tuple(nodes[label].tolist()) for cell in cells for label in cell},
                {i: list(cell) for i, cell in enumerate(cells, 1)})
    turn_mirrored(mesh)
    points = np.array(list(mesh.nodes.values()))
    normal = upright(np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][-1])
    heights = points @ normal
    thickness = float(np.ptp(heights))
    one_layer = len(np.unique(np.round(heights / max(thickness, 1e-300), 3))) == 2
    return Blank(mesh, normal, thickness, POINTS, "solid_shell" if one_layer else "hex8", {}, edge)


def with_sets(blank: Blank, sets: dict[str, set[int]]) -> Mesh:
    """Return the mesh, numbered from 1, with node sets of labels of the deck."""
    blank.mesh.node_sets = {name: members | {blank.upper[label] for label in members if label in blank.upper}
                            for name, members in sets.items()}
    renumber(blank.mesh)
    return blank.mesh
