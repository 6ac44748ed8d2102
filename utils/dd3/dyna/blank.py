# SPDX-License-Identifier: GPL-3.0-or-later
"""The blank of an LS-DYNA deck as a mesh of hexahedra."""

from dataclasses import dataclass

import numpy as np

from dd3.bound import Bound
from dd3.dyna.cards import Row
from dd3.dyna.deck import SHELL, Deck
from dd3.dyna.laws import Units
from dd3.dyna.mesh import Cell, Part
from dd3.dyna.shells import across, ordered
from dd3.errors import Problem
from dd3.hanging import edges_of_hung, hanging_nodes
from dd3.mesh import Mesh, renumber, turn_mirrored

POINTS = 7  # through the thickness, where the deck has fewer than 5
MOST_POINTS = 15


@dataclass
class Blank:
    """The mesh with the labels of the deck, its mean normal, thickness, points, and the element.

    upper: the label of the node above each node of a shell; empty for solids. axes: the first edge and the normal of
    the first element; bent: the largest angle from it to the first edge of another, degrees. asked: points through the
    thickness in the deck, 0 for none.
    """

    mesh: Mesh
    normal: np.ndarray
    thickness: float
    points: int
    element: str
    upper: dict[int, int]
    axes: np.ndarray
    bent: float
    asked: int = 0

    @property
    def size(self) -> float:
        """The length of an edge of the first element, mm."""
        return float(np.linalg.norm(self.axes[0]))


def blank_of(deck: Deck, part: Part, units: Units) -> Blank:
    """Return the blank of a part: shells extruded about their mid-surface, hexahedra as they are."""
    kinds = {cell.dimension for cell in part.cells}
    if len(kinds) != 1:
        raise Problem(f"{part.place}: error: the blank, part {part.number}, has shells and solids")
    corners = 4 if kinds == {2} else 8
    other = [cell for cell in part.cells if len(cell.nodes) != corners]
    if other:
        raise Problem(f"{other[0].place}: error: {len(other)} of the {len(part.cells)} elements of the blank "
                      f"(part {part.number}) are no {'quadrilaterals' if corners == 4 else 'hexahedra'}; mesh it with "
                      "these alone")
    nodes = {label: np.array(deck.nodes[label]) * units.length for cell in part.cells for label in cell.nodes}
    bound = bound_nodes(deck, part, nodes)
    blank = of_shells(deck, part, nodes, bound, units) if corners == 4 else of_solids(deck, part, nodes)
    labels = list(nodes)
    below = [(labels[node], labels[a], labels[b]) for (a, b), node in bound.items()]
    blank.mesh.bound = below + [tuple(blank.upper[label] for label in three) for three in below]
    edges = np.array([nodes[cell.nodes[1]] - nodes[cell.nodes[0]] for cell in part.cells])
    edges /= np.maximum(np.linalg.norm(edges, axis=1), 1e-300)[:, None]
    first = blank.axes[0] / max(float(np.linalg.norm(blank.axes[0])), 1e-300)
    blank.bent = float(np.degrees(np.arccos(np.clip(np.abs(edges @ first).min(), 0.0, 1.0))))
    return blank


def bound_nodes(deck: Deck, part: Part, nodes: dict[int, np.ndarray]) -> Bound:
    """Return the nodes of shells that *CONSTRAINED_ADAPTIVITY binds, by their order in `nodes`; raise a Problem at
    another node of one element on the edge or the face of another: nothing would bind them."""
    labels = list(nodes)
    index = {label: i for i, label in enumerate(labels)}
    points = np.array(list(nodes.values()))
    cells = [[index[label] for label in cell.nodes] for cell in part.cells]
    shells = [cell for cell in cells if len(cell) == 4]
    bound = edges_of_hung([item for item in deck.hung if item[1][0] in nodes], index, points, shells)
    found = [pair for pair in hanging_nodes(points, cells) if pair[0] not in bound.values()]
    if found:
        node, cell = labels[found[0][0]], part.cells[found[0][1]]
        raise Problem(f"{cell.place}: error: node {node} lies on an edge or a face of element {cell.label} that does "
                      f"not have it ({len(found)} such nodes): the sheet would tear there; mesh the blank with "
                      "elements that share all their nodes, or bind it by *CONSTRAINED_ADAPTIVITY")
    return bound


def of_shells(deck: Deck, part: Part, nodes: dict[int, np.ndarray], bound: Bound, units: Units) -> Blank:
    """Return the blank of shells."""
    labels, points = list(nodes), np.array(list(nodes.values()))
    index = {label: i for i, label in enumerate(labels)}
    quads = np.array([[index[label] for label in cell.nodes] for cell in part.cells])
    first_row, row = deck.section(part, "*SECTION_SHELL", SHELL)
    use_section(first_row)
    thickness = uniform_thickness(row, part.cells) * units.length
    if not thickness > 0:
        raise Problem(f"{row.place}: error: a shell thickness of {thickness:g} mm; expected a number > 0")
    areas = np.cross(points[quads[:, 2]] - points[quads[:, 0]], points[quads[:, 3]] - points[quads[:, 1]]) / 2
    sizes = np.linalg.norm(areas, axis=1)
    if not np.all(sizes > 0):
        raise Problem(f"{part.place}: error: a shell of the blank, part {part.number}, has no area")
    mean = np.where(ordered(quads, bound)[:, None], -areas, areas).sum(axis=0)
    if not np.linalg.norm(mean) > 1e-9 * sizes.sum():
        raise Problem(f"{part.place}: error: the normals of the shells of part {part.number} cancel each other")
    upward = upright(mean)
    axes = np.array([points[quads[0, 1]] - points[quads[0, 0]], areas[0] / sizes[0]])
    turned = ordered(quads, bound, areas @ upward)
    middle = surface_place(row, turned)
    quads[turned] = quads[turned][:, ::-1]
    over = across(part.cells, points, quads, np.full(quads.shape, thickness))
    first, mesh = max(nodes), Mesh()
    for i, label in enumerate(labels):
        for side, name in ((-0.5, label), (0.5, label + first)):
            mesh.nodes[name] = tuple((points[i] + (middle + side) * over[i]).tolist())
    for i, quad in enumerate(quads, 1):
        ring = [labels[node] for node in quad]
        mesh.elements[i] = ring + [label + first for label in ring]
    asked = first_row.label("NIP")
    return Blank(mesh, upward, thickness, min(asked, MOST_POINTS) if asked >= 5 else POINTS, "solid_shell",
                 {label: label + first for label in labels}, axes, 0.0, asked)


def surface_place(row: Row, turned: np.ndarray) -> float:
    """Return the distance of the middle of the sheet from the nodes of the shells, upwards, over the thickness: NLOC
    counts along the normal that each shell has in the deck."""
    place = row.number("NLOC")
    if not -1 <= place <= 1:
        raise Problem(f"{row.place}: error: NLOC = {place:g}; expected -1 to 1")
    if place and turned.any() and not turned.all():
        raise Problem(f"{row.place}: error: NLOC = {place:g}, but {turned.sum()} of the {len(turned)} shells of the "
                      "blank are numbered the other way round than the others; number all of them in one way")
    return place / 2 if turned.any() else -place / 2


def use_section(row: Row) -> None:
    """Take the first row of a section of shells: what is not read belongs to LS-DYNA's elements."""
    row.label("SECID")
    row.leave("the element is solid_shell", "ELFORM SHRF QR ICOMP")
    row.leave("output follows from *OUTPUT", "PROPT")


def uniform_thickness(row: Row, cells: list[Cell]) -> float:
    """Return the one thickness of shells: by *ELEMENT_SHELL_THICKNESS, where it is 0 or not given by their section."""
    first, *others = row.numbers("T1 T2 T3 T4")
    section = first, *(value or first for value in others)
    given = {value or own for cell in cells for value, own in zip(cell.thickness or (0.0,) * 4, section)}
    if len(given) > 1 and max(given) - min(given) > 1e-6 * max(given):
        raise Problem(f"{row.place}: error: shells {min(given):g} to {max(given):g} thick; the blank has one "
                      "thickness")
    return next(iter(given), 0.0)


def upright(vector: np.ndarray) -> np.ndarray:
    """Return the unit vector that points to +z, as the program turns the thickness; an upright sheet keeps its side."""
    unit: np.ndarray = vector / np.linalg.norm(vector)
    return -unit if unit[2] < -1e-6 else unit


def of_solids(deck: Deck, part: Part, nodes: dict[int, np.ndarray]) -> Blank:
    """Return the blank of hexahedra, a flat sheet: its normal is the direction in which the nodes vary least."""
    if part.section in deck.sections:
        row = deck.section(part, deck.sections[part.section][0].keyword, ("SECID ELFORM AET",))[0]
        row.label("SECID")
        row.leave("the element is solid_shell, or hex8 for several layers", "ELFORM")
    mesh = Mesh({label: tuple(point.tolist()) for label, point in nodes.items()},
                {i: list(cell.nodes) for i, cell in enumerate(part.cells, 1)})
    turn_mirrored(mesh)
    points = np.array(list(mesh.nodes.values()))
    normal = upright(np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][-1])
    heights = points @ normal
    thickness = float(np.ptp(heights))
    one_layer = len(np.unique(np.round(heights / max(thickness, 1e-300), 3))) == 2
    first = part.cells[0].nodes
    return Blank(mesh, normal, thickness, POINTS, "solid_shell" if one_layer else "hex8", {},
                 np.array([nodes[first[1]] - nodes[first[0]], normal]), 0.0)


def with_sets(blank: Blank, sets: dict[str, set[int]]) -> Mesh:
    """Return the mesh, numbered from 1, with node sets of labels of the deck."""
    blank.mesh.node_sets = {name: members | {blank.upper[label] for label in members if label in blank.upper}
                            for name, members in sets.items()}
    renumber(blank.mesh)
    return blank.mesh
