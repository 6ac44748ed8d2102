# SPDX-License-Identifier: GPL-3.0-or-later
"""Bring a mesh of hexahedra into the form that *MESH reads, an .inp file of nodes, elements and sets.

    dd3 mesh part.msh sheet.inp                Gmsh, VTK, UNV, MED, Nastran: what Gmsh reads; a .geo file is meshed
    dd3 mesh job.inp sheet.inp                 a model of Abaqus or CalculiX: its mesh and sets, nothing else
    dd3 mesh job.out/fields.vtkhdf sheet.inp   the initial mesh of a run; dd3 export has others

Elements other than hexahedra, such as the faces and edges of a Gmsh mesh, and nodes without elements are left out;
nodes and elements are numbered from 1. Physical groups of volumes become element sets, those of surfaces, curves and
points node sets. Mirrored elements are turned. Of a model of Abaqus or CalculiX the mesh is read in the place of its
instance, with local axes, generated and copied nodes and elements; what is left out is listed with its line. A node on
an edge or a face of an element that does not have it is refused, and so is one between corners far from the middle.
"""
import itertools
import math
import re
from collections.abc import Container, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from dd3.bound import EDGES, bound_nodes
from dd3.command import new_parser
from dd3.errors import LOG, Problem
from dd3.fields import Fields
from dd3.gmsh_session import session
from dd3.hanging import TOLERANCE, hanging, outer_faces
from dd3.inp.blocks import refuse
from dd3.inp.model import Model, set_members
from dd3.inp.scope import Element, Scope
from dd3.run import read_job

# Natural coordinates of the nodes in the order of Abaqus: corners, edges, centre, faces.
NATURAL = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1),
           (0, -1, -1), (1, 0, -1), (0, 1, -1), (-1, 0, -1), (0, -1, 1), (1, 0, 1), (0, 1, 1), (-1, 0, 1),
           (-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0),
           (0, 0, 0), (0, 0, -1), (0, 0, 1), (0, -1, 0), (1, 0, 0), (0, 1, 0), (-1, 0, 0)]
GMSH_HEXAHEDRA = {5: 8, 17: 20, 12: 27}
KINDS = ("point", "curve", "surface", "volume")
MIDDLE = 0.02  # distance of a node from the middle of an edge to which it is bound by its place, over its length
VTK_HEXAHEDRA = {12: 8, 25: 20, 29: 27}
# Places of a cell of VTK in the order of Abaqus: VTK has the faces in the order -x +x -y +y -z +z, then the centre.
VTK_ORDER = [*range(20), 26, 24, 25, 22, 21, 23, 20]
ALONG, AWAY = 0.25, 0.5  # distance of a node from the middle of an edge, along it and in all, over its length, at most
INP_HEXAHEDRA = re.compile(r"(?:C3D(?:8|20|27)|SC8|CSS8)[A-Z]*$")


@dataclass
class Mesh:
    """Nodes and hexahedra by label; sets of labels; bound nodes, each with the ends of its edge, by labels."""

    nodes: dict[int, tuple[float, ...]] = field(default_factory=dict)
    elements: dict[int, list[int]] = field(default_factory=dict)
    node_sets: dict[str, Any] = field(default_factory=dict)
    element_sets: dict[str, Any] = field(default_factory=dict)
    bound: list[tuple[int, ...]] = field(default_factory=list)
    left_out: dict[str, int] = field(default_factory=dict)  # kind: number
    model: Model | None = None  # of an .inp file


# ---- readers ---------------------------------------------------------------------------------------------------------

def gmsh_groups(gmsh: Any, mesh: Mesh) -> None:
    """Take the physical groups as sets."""
    for dimension, tag in gmsh.model.getPhysicalGroups():
        name = gmsh.model.getPhysicalName(dimension, tag) or f"{KINDS[dimension]}{tag}"
        if dimension < 3:
            members = gmsh.model.mesh.getNodesForPhysicalGroup(dimension, tag)[0]
            mesh.node_sets.setdefault(name, set()).update(int(node) for node in members)
            continue
        for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag):
            for tags in gmsh.model.mesh.getElements(3, entity)[1]:
                mesh.element_sets.setdefault(name, set()).update(int(element) for element in tags)


def read_gmsh(path: Path) -> Mesh:
    """Read what Gmsh reads; a geometry is meshed."""
    with session(path) as gmsh:
        if not gmsh.model.mesh.getElements(3)[0].size and gmsh.model.getEntities(3) and path.suffix == ".geo":
            gmsh.model.mesh.generate(3)
        mesh = Mesh()
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        mesh.nodes = {int(tag): tuple(coordinates[3 * i:3 * i + 3].tolist()) for i, tag in enumerate(tags)}
        for kind, labels, nodes in zip(*gmsh.model.mesh.getElements()):
            name, dimension, _, count, natural, _ = gmsh.model.mesh.getElementProperties(kind)
            if kind not in GMSH_HEXAHEDRA:
                if dimension == 3:
                    mesh.left_out[name] = len(labels)
                continue
            places = {tuple(round(value) for value in natural[3 * i:3 * i + 3]): i for i in range(count)}
            order = [places[place] for place in NATURAL[:count]]
            nodes = nodes.reshape(-1, count)
            if path.suffix.lower() == ".vtk" and count > 8:
                order = order_of_vtk(order, np.array([[mesh.nodes[node] for node in these] for these in nodes]))
            for label, these in zip(labels.tolist(), nodes[:, order].tolist()):
                mesh.elements[label] = these
        gmsh_groups(gmsh, mesh)
        return mesh


def order_of_vtk(order: list[int], points: np.ndarray) -> list[int]:
    """Return the order of the nodes of cells of VTK of second order, points (m, n, 3), by that of Gmsh: Gmsh 4.14 and
    4.15 exchange the nodes by the inverse of the order that they need. The order with the nodes nearer to the middle
    between others holds, also for a Gmsh in which this is mended."""
    to_vtk = VTK_ORDER[:len(order)]
    of_vtk = np.empty(len(order), int)
    of_vtk[to_vtk] = order
    mended = np.argsort(of_vtk)[to_vtk].tolist()

    def away(one: list[int]) -> float:
        these = points[:, one]
        return sum(float(np.linalg.norm(2 * these[:, node] - these[:, a] - these[:, b], axis=1).sum())
                   for node, a, b in middles(len(one)))
    return min(order, mended, key=away)


def read_run(path: Path, step: int = 0) -> Mesh:
    """Read the mesh of a run in its shape at a step, by default the initial one."""
    fields = Fields(path)
    points, (cells, offsets, types) = fields.points(step), fields.cells(step)
    kind = int(types[0])
    if kind not in VTK_HEXAHEDRA:
        raise Problem(f"{path}: cells of type {kind}, expected hexahedra")
    mesh = Mesh(nodes={i + 1: tuple(map(float, point)) for i, point in enumerate(points)})
    for i in range(len(offsets) - 1):
        nodes = cells[offsets[i]:offsets[i + 1]]
        mesh.elements[i + 1] = [int(nodes[k]) + 1 for k in VTK_ORDER[:len(nodes)]]
    if kind == 12:
        mesh.bound = [(node + 1, a + 1, b + 1) for (a, b), node in bound_nodes(cells.reshape(-1, 8), points).items()]
    number = material_numbers(fields, step)
    if (number > 1).any():
        materials = read_job(fields.path.parent)["materials"]
        mesh.element_sets = {materials[k - 1]["name"]: (np.flatnonzero(number == k) + 1).tolist()
                             for k in np.unique(number)}
    return mesh


def material_numbers(fields: Fields, step: int) -> np.ndarray:
    """Return the number of the material of each element (m,), from 1 on in the order of run.json."""
    if "material" not in fields.grid["CellData"]:
        return np.ones(len(fields.cells(step).types), int)
    return np.rint(fields.values(step, "material", at_cells=True)[0]).astype(int)


def read_inp(path: Path, wanted: str | None) -> Mesh:
    """Read the mesh of a model of Abaqus or CalculiX in its place; of several parts or instances the one wanted."""
    model = Model(path)
    solids = {}
    for solid in model.solids():
        if any(INP_HEXAHEDRA.match(element.kind) for element in solid.scope.elements.values()):
            solids[solid.name] = solid
    found = [solid for solid in solids.values() if wanted is None or wanted.lower() in (solid.name, solid.part)]
    if len(found) != 1:
        names = ", ".join(solid.name or "(outside parts)" for solid in solids.values())
        others = sorted({element.kind for solid in model.solids() for element in solid.scope.elements.values()})
        raise Problem(f"{path}: expected one part with hexahedra, see --part; there are: {names or 'none'}"
                      + (f", but elements of {', '.join(others)}" if others and not names else ""))
    for solid in model.solids():
        if solid.name != found[0].name:
            model.account.enter(solid.scope.place, solid.name or "elements outside parts").leave("not the part wanted")
    return mesh_of(model, found[0].scope)


def mesh_of(model: Model, scope: Scope) -> Mesh:
    """Return the hexahedra of a mesh with their nodes and sets; what is left out is entered in the account."""
    mesh = Mesh(model=model)
    others: dict[str, list[Element]] = {}
    for label, element in sorted(scope.elements.items()):
        if INP_HEXAHEDRA.match(element.kind):
            mesh.elements[label] = hexahedron(label, element)
        else:
            others.setdefault(element.kind, []).append(element)
    for kind, elements in others.items():
        entry = model.account.enter(elements[0].place, f"*ELEMENT, TYPE={kind}: {len(elements)}")
        entry.leave("no hexahedra" if kind[:3] != "C3D" else "other solids than hexahedra")
    used = set(itertools.chain.from_iterable(mesh.elements.values()))
    for label in sorted(used - scope.nodes.keys())[:1]:
        owner = next(element for element in scope.elements.values() if label in element.nodes)
        refuse(owner.place, f"node {label} of an element has no coordinates")
    mesh.nodes = {label: scope.nodes[label] for label in sorted(used)}
    unused = [label for label in scope.nodes if label not in used]
    if unused:
        model.account.enter(scope.node_places[unused[0]], f"nodes without hexahedra: {len(unused)}").leave(
            f"the first is node {unused[0]}")
    mesh.bound = [labels for labels in scope.bound if all(label in mesh.nodes for label in labels)]
    mesh.node_sets = sets_of(model, scope, True, mesh.nodes)
    mesh.element_sets = sets_of(model, scope, False, mesh.elements)
    return mesh


def hexahedron(label: int, element: Element) -> list[int]:
    """Return the nodes of a hexahedron."""
    nodes = element.counted(label, next(size for size in (20, 27, 8) if str(size) in element.kind))
    if len(set(nodes)) < len(nodes):
        refuse(element.place, f"element {label} names a node twice; wedges and pyramids are not read")
    return nodes


def sets_of(model: Model, scope: Scope, of_nodes: bool, there: Container[int]) -> dict[str, set[int]]:
    """Return sets of what belongs to the mesh."""
    result, what = {}, "nodes without hexahedra" if of_nodes else "elements that are no hexahedra"
    for name, members in set_members(model, scope, of_nodes).items():
        result[name] = {label for label in members if label in there}
        lost = len(members) - len(result[name])
        place = (scope.node_sets if of_nodes else scope.element_sets)[name].place
        if lost:
            model.account.enter(place, f"{'*NSET' if of_nodes else '*ELSET'} {name}").leave(f"{lost} {what}")
        if not result[name] and not lost:
            model.account.enter(place, f"{'*NSET' if of_nodes else '*ELSET'} {name}").leave("empty")
    return result


# ---- repair and output -----------------------------------------------------------------------------------------------

def volume_sign(points: Sequence[Sequence[float]]) -> float:
    """Return the triple product of the mean edges of a hexahedron."""
    return float(np.linalg.det(np.transpose(NATURAL[:8]) @ np.asarray(points, float)))


def turn_mirrored(mesh: Mesh) -> int:
    """Exchange the bottom and top of mirrored elements; return their number."""
    count, turned = 0, {}
    for label, nodes in mesh.elements.items():
        if volume_sign([mesh.nodes[node] for node in nodes[:8]]) >= 0.0:
            continue
        if len(nodes) not in turned:
            places = {place: i for i, place in enumerate(NATURAL[:len(nodes)])}
            turned[len(nodes)] = [places[x, y, -z] for x, y, z in NATURAL[:len(nodes)]]
        mesh.elements[label] = [nodes[i] for i in turned[len(nodes)]]
        count += 1
    return count


def merge_nodes(mesh: Mesh, tolerance: float) -> int:
    """Replace nodes within a tolerance of an earlier one; return their number. Two of an element are refused."""
    labels = list(mesh.nodes)
    same: dict[int, int] = {}
    for a, b in sorted(cKDTree(list(mesh.nodes.values())).query_pairs(tolerance)):
        if labels[a] not in same:
            same.setdefault(labels[b], labels[a])
    for label, nodes in mesh.elements.items():
        check_merged(mesh, label, same, tolerance)
        mesh.elements[label] = [same.get(node, node) for node in nodes]
    mesh.bound = [tuple(same.get(node, node) for node in labels) for labels in mesh.bound]
    mesh.node_sets = {name: {same.get(node, node) for node in members} for name, members in mesh.node_sets.items()}
    return len(same)


def check_merged(mesh: Mesh, label: int, same: dict[int, int], tolerance: float) -> None:
    """Refuse an element of which two nodes become the same one."""
    nodes = mesh.elements[label]
    if len({same.get(node, node) for node in nodes}) == len(set(nodes)):
        return
    a, b = next(pair for pair in itertools.combinations(dict.fromkeys(nodes), 2)
                if len({same.get(node, node) for node in pair}) == 1)
    edges = [math.dist(mesh.nodes[nodes[i]], mesh.nodes[nodes[j]]) for i, j in EDGES]
    raise Problem(f"--merge {tolerance:.9g} makes one node of the nodes {a} and {b} of element {label}, whose "
                  f"shortest edge is {min(edges):.6g} mm long; expected less than the distance of any two nodes of an "
                  "element")


def check_nodes(mesh: Mesh) -> set[int]:
    """Return the nodes of the elements, which must be there."""
    used = set(itertools.chain.from_iterable(mesh.elements.values()))
    unknown = used - mesh.nodes.keys()
    if unknown:
        raise Problem(f"node {min(unknown)} of an element has no coordinates")
    return used


def bind_middles(mesh: Mesh, labels: list[int], corners: np.ndarray, points: np.ndarray) -> None:
    """Bind the nodes in the middle of edges of larger elements with eight nodes that are not bound yet."""
    if not mesh.elements or any(len(nodes) != 8 for nodes in mesh.elements.values()):
        return
    known = {node for node, *_ in mesh.bound}
    for (a, b), node in bound_nodes(corners, points).items():
        away = np.linalg.norm(points[node] - (points[a] + points[b]) / 2)
        if labels[node] not in known and away <= MIDDLE * np.linalg.norm(points[b] - points[a]):
            mesh.bound.append((labels[node], labels[a], labels[b]))


def check_joints(mesh: Mesh, path: Path) -> int:
    """Refuse nodes on an edge or a face of an element to which they do not belong; return the number of nodes at the
    place of another one."""
    labels, elements = list(mesh.nodes), list(mesh.elements)
    number_of = {label: i for i, label in enumerate(labels)}
    points = np.array(list(mesh.nodes.values()), float).reshape(-1, 3)
    members = [[number_of[node] for node in nodes] for nodes in mesh.elements.values()]
    corners = np.array([nodes[:8] for nodes in members], int).reshape(-1, 8)
    at_corner = set(corners.ravel().tolist())
    for element, nodes in zip(elements, members):
        for node in at_corner.intersection(nodes[8:]):
            raise Problem(f"{path}: error: node {labels[node]} is between the corners of element {element} and at a "
                          "corner of another: the sheet would tear there; expected elements with whole faces in common")
    faces, owners = outer_faces(corners)
    bind_middles(mesh, labels, corners, points)
    bound = {number_of[node] for node, *_ in mesh.bound}
    found = [pair for pair in hanging(points, faces, owners, members) if pair[0] not in bound]
    if found:
        node, element = found[0]
        place = " ".join(f"{value:.9g}" for value in points[node])
        raise Problem(f"{path}: error: node {labels[node]} at {place} lies on an edge or a face of element "
                      f"{elements[element]}, which does not have it: the sheet would tear there"
                      + (f"; {len(found) - 1} more are so" if found[1:] else "")
                      + "; expected elements with whole faces in common")
    outer = np.unique(faces)
    edges = np.linalg.norm(points[faces] - points[np.roll(faces, 1, axis=1)], axis=2)
    edges = edges[edges > 0.0]
    return len(cKDTree(points[outer]).query_pairs(TOLERANCE * float(edges.min()))) if len(edges) else 0


def check_middles(mesh: Mesh, path: Path) -> None:
    """Refuse elements of second order with a node far from the middle between two others, which are in a wrong order:
    a quarter along the edge the shape functions have no inverse at its end, half of it away the edge is a half circle.
    """
    for count in {len(nodes) for nodes in mesh.elements.values()} - {8}:
        elements = [label for label, nodes in mesh.elements.items() if len(nodes) == count]
        points = np.array([[mesh.nodes[node] for node in mesh.elements[label]] for label in elements])
        for node, a, b in middles(count):
            edge, away = points[:, b] - points[:, a], points[:, node] - (points[:, a] + points[:, b]) / 2
            length = np.linalg.norm(edge, axis=1)
            far = ((np.abs((edge * away).sum(1)) > ALONG * length**2)
                   | (np.linalg.norm(away, axis=1) > AWAY * (1 + TOLERANCE) * length))
            for i in np.flatnonzero(far)[:1].tolist():
                nodes = mesh.elements[elements[i]]
                raise Problem(f"{path}: error: node {nodes[node]} of element {elements[i]} is "
                              f"{np.linalg.norm(away[i]):.6g} mm from the middle between its nodes {nodes[a]} and "
                              f"{nodes[b]}, which are {length[i]:.6g} mm apart; expected a node near the middle: are "
                              "the nodes of the elements in the order of the format?")


def middles(count: int) -> list[tuple[int, int, int]]:
    """Return the places between two others of a hexahedron of second order, each with these two."""
    places: dict[tuple[int, ...], int] = {place: i for i, place in enumerate(NATURAL[:count])}
    found = []
    for place, node in places.items():
        for axis in (axis for axis in range(3) if place[axis] == 0):
            ends = [places.get((*place[:axis], sign, *place[axis + 1:])) for sign in (-1, 1)]
            found += [(node, a, b) for a, b in [ends] if a is not None and b is not None]
    return found


def renumber(mesh: Mesh) -> None:
    """Number nodes and elements from 1; nodes without elements are left out, and empty sets."""
    used = check_nodes(mesh)
    node_of = {label: i for i, label in enumerate((label for label in mesh.nodes if label in used), 1)}
    element_of = {label: i for i, label in enumerate(mesh.elements, 1)}
    if len(node_of) < len(mesh.nodes):
        mesh.left_out["nodes without hexahedra"] = len(mesh.nodes) - len(node_of)
    mesh.nodes = {node_of[label]: point for label, point in mesh.nodes.items() if label in node_of}
    mesh.bound = [tuple(node_of[label] for label in labels) for labels in mesh.bound]
    mesh.elements = {element_of[label]: [node_of[node] for node in nodes] for label, nodes in mesh.elements.items()}
    for sets, number_of in (mesh.node_sets, node_of), (mesh.element_sets, element_of):
        for name in list(sets):
            members = sorted(number_of[label] for label in sets.pop(name) if label in number_of)
            if members:
                sets[name] = members


def set_name(name: str) -> str:
    """Return the name of a set as a word of an input file."""
    word = re.sub(r"[^a-z0-9_.-]+", "_", name.lower()).strip("_")
    return word if word[:1].isalpha() else f"set_{word}"


def set_names(sets: Iterable[str]) -> dict[str, str]:
    """Return the names of sets as words of an input file; of those that would become the same, the one that is this
    word already keeps it, else the first, and the others are numbered."""
    sets = list(sets)
    words = {name: name for name in sets if set_name(name) == name}
    free = {set_name(name) for name in sets}
    for name in sets:
        if name in words:
            continue
        word = set_name(name)
        if word in words.values():
            word = next(numbered for k in itertools.count(2) if (numbered := f"{word}_{k}") not in free)
            free.add(word)
        words[name] = word
    return {name: words[name] for name in sets}


def write_inp(path: Path, mesh: Mesh, source: Path) -> None:
    """Write the file."""
    counts = {len(nodes) for nodes in mesh.elements.values()}
    if len(counts) != 1:
        raise Problem(f"hexahedra with {' and '.join(map(str, sorted(counts)))} nodes; expected one kind")
    with path.open("w", encoding="utf-8") as file:
        file.write(f"*HEADING\nmesh of {source.name}, by dd3\n*NODE\n")
        file.writelines(f"{label}, {x!r}, {y!r}, {z!r}\n" for label, (x, y, z) in mesh.nodes.items())
        file.write(f"*ELEMENT, TYPE=C3D{counts.pop()}\n")
        for label, nodes in mesh.elements.items():
            words = [str(label), *map(str, nodes)]
            lines = [", ".join(words[i:i + 14]) for i in range(0, len(words), 14)]
            file.write(",\n".join(lines) + "\n")
        if mesh.bound:
            file.write("*MPC\n")
            file.writelines(f"LINEAR, {node}, {a}, {b}\n" for node, a, b in mesh.bound)
        for keyword, sets in ("NSET", mesh.node_sets), ("ELSET", mesh.element_sets):
            words_of = set_names(sets)
            for name, members in sets.items():
                file.write(f"*{keyword}, {keyword}={words_of[name]}\n")
                file.writelines(", ".join(map(str, members[i:i + 14])) + "\n" for i in range(0, len(members), 14))


def report(path: Path, mesh: Mesh, merged: int, mirrored: int) -> None:
    """Say what was written and what was changed."""
    LOG.info(f"{path}: {len(mesh.nodes)} nodes, {len(mesh.elements)} elements")
    for what, sets in ("node set", mesh.node_sets), ("element set", mesh.element_sets):
        if sets:
            LOG.info(f"{what}s: {' '.join(set_names(sets).values())}")
        for name, word in set_names(sets).items():
            if word != set_name(name):
                LOG.info(f"{what} '{name}' is written as {word}: another one is {set_name(name)}")
    if merged:
        LOG.info(f"nodes merged: {merged}")
    if mirrored:
        LOG.info(f"mirrored elements turned: {mirrored}")
    for kind, count in mesh.left_out.items():
        LOG.info(f"left out: {kind}: {count}")
    for item in mesh.model.left_out() if mesh.model else ():
        LOG.info(f"left out: {item}")


def main(words: Sequence[str] | None = None) -> None:
    """Read, repair, write."""
    parser = new_parser("mesh", __doc__)
    parser.add_argument("source", type=Path, help="mesh, model or field file")
    parser.add_argument("target", type=Path, help=".inp file to write")
    parser.add_argument("--scale", type=float, default=1.0, help="factor on the coordinates, 1000 for metres")
    parser.add_argument("--merge", type=float, metavar="mm", help="merge nodes nearer than this, after --scale")
    parser.add_argument("--part", help="part or instance of a model with several")
    options = parser.parse_args(words)
    if not options.source.is_file():
        raise Problem(f"{options.source}: no such file")
    if options.target.exists() and options.target.samefile(options.source):
        raise Problem(f"{options.target}: the source would be overwritten")
    if options.source.suffix.lower() == ".inp":
        mesh = read_inp(options.source, options.part)
    elif options.source.suffix.lower() in (".vtkhdf", ".hdf"):
        mesh = read_run(options.source)
    else:
        mesh = read_gmsh(options.source)
    if not mesh.elements:
        found = ", ".join(f"{count} x {kind}" for kind, count in mesh.left_out.items())
        raise Problem(f"{options.source}: no hexahedra" + (f"; there are {found}" if found else ""))
    if options.scale != 1.0:
        mesh.nodes = {label: tuple(options.scale * value for value in point) for label, point in mesh.nodes.items()}
    check_nodes(mesh)
    merged = merge_nodes(mesh, options.merge) if options.merge else 0
    check_middles(mesh, options.source)
    doubled = check_joints(mesh, options.source)
    renumber(mesh)
    mirrored = turn_mirrored(mesh)
    write_inp(options.target, mesh, options.source)
    report(options.target, mesh, merged, mirrored)
    if doubled:
        LOG.warning(f"{doubled} nodes at the place of another one do not join the elements there; see --merge")
