# SPDX-License-Identifier: GPL-3.0-or-later
"""Bring a mesh of hexahedra into the form that *MESH reads, an .inp file of nodes, elements and sets.

    dd3 mesh part.msh sheet.inp                Gmsh, VTK, UNV, MED, Nastran: what Gmsh reads; a .geo file is meshed
    dd3 mesh job.inp sheet.inp                 a model of Abaqus or CalculiX: its mesh and sets, nothing else
    dd3 mesh job.out/fields.vtkhdf sheet.inp   the initial mesh of a run; dd3 export has others

Elements other than hexahedra, such as the faces and edges of a Gmsh mesh, and nodes without elements are left out;
nodes and elements are numbered from 1. Physical groups of volumes become element sets, those of surfaces, curves and
points node sets. Mirrored elements are turned.
"""
import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from dd3.command import new_parser
from dd3.errors import Problem
from dd3.fields import Fields
from dd3.gmsh_session import session

# Natural coordinates of the nodes in the order of Abaqus: corners, edges, centre, faces.
NATURAL = [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1),
           (0, -1, -1), (1, 0, -1), (0, 1, -1), (-1, 0, -1), (0, -1, 1), (1, 0, 1), (0, 1, 1), (-1, 0, 1),
           (-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0),
           (0, 0, 0), (0, 0, -1), (0, 0, 1), (0, -1, 0), (1, 0, 0), (0, 1, 0), (-1, 0, 0)]
GMSH_HEXAHEDRA = {5: 8, 17: 20, 12: 27}
KINDS = ("point", "curve", "surface", "volume")
VTK_HEXAHEDRA = {12: 8, 25: 20, 29: 27}
INP_HEXAHEDRA = re.compile(r"(?:C3D(?:8|20|27)|SC8|CSS8)[A-Z]*$")


@dataclass
class Mesh:
    """Nodes and hexahedra by label; sets of labels."""

    nodes: dict[int, tuple[float, ...]] = field(default_factory=dict)
    elements: dict[int, list[int]] = field(default_factory=dict)
    node_sets: dict[str, Any] = field(default_factory=dict)
    element_sets: dict[str, Any] = field(default_factory=dict)
    left_out: dict[str, int] = field(default_factory=dict)  # kind: number


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
            for label, these in zip(labels.tolist(), nodes.reshape(-1, count)[:, order].tolist()):
                mesh.elements[label] = these
        gmsh_groups(gmsh, mesh)
        return mesh


def read_run(path: Path, step: int = 0) -> Mesh:
    """Read the mesh of a run in its shape at a step, by default the initial one."""
    fields = Fields(path)
    points, cells, offsets = fields.points(step), fields.grid["Connectivity"][:], fields.grid["Offsets"][:]
    kind = int(fields.grid["Types"][0])
    if kind not in VTK_HEXAHEDRA:
        raise Problem(f"{path}: cells of type {kind}, expected hexahedra")
    mesh = Mesh(nodes={i + 1: tuple(map(float, point)) for i, point in enumerate(points)})
    for i in range(len(offsets) - 1):
        mesh.elements[i + 1] = [int(node) + 1 for node in cells[offsets[i]:offsets[i + 1]]]
        # VTK has the face nodes in the order -x +x -y +y -z +z, then the centre.
        if kind == 29:
            face = mesh.elements[i + 1][20:]
            mesh.elements[i + 1][20:] = [face[k] for k in (6, 4, 5, 2, 1, 3, 0)]
    return mesh


def inp_lines(path: Path, depth: int = 0) -> Iterator[tuple[Path, int, str]]:
    """Yield the lines of an .inp file as (file, number, text), with those of included files."""
    if depth > 10:
        raise Problem(f"{path}: includes nest too deeply")
    for number, line in enumerate(path.read_text(encoding="utf-8", errors="replace").splitlines(), 1):
        text = line.strip()
        if not text or text.startswith("**"):
            continue
        include = re.match(r"\*INCLUDE\s*,\s*INPUT\s*=\s*(.+)", text, re.IGNORECASE)
        if include:
            yield from inp_lines(path.parent / include[1].strip().strip('"'), depth + 1)
        else:
            yield path, number, text


def inp_blocks(path: Path) -> Iterator[list[Any]]:
    """Yield keyword, parameters, place and lists of words of the data lines; `part` is a parameter."""
    block: list[Any] = []
    part, instances = "", dict[str, str]()
    for file, number, text in inp_lines(path):
        if not text.startswith("*"):
            if block:
                block[3].append([word.strip() for word in text.rstrip(",").split(",")] + [text.endswith(",")])
            continue
        if block:
            yield block
        words = [word.strip() for word in text[1:].split(",")]
        options = {}
        for word in words[1:]:
            name, _, value = word.partition("=")
            options[name.strip().upper()] = value.strip().strip('"')
        keyword = " ".join(words[0].upper().split())
        if keyword == "PART":
            part = options.get("NAME", "")
        elif keyword == "END PART":
            part = ""
        elif keyword == "INSTANCE":
            instances[options.get("NAME", "").lower()] = part = options.get("PART", "")
        elif keyword == "END INSTANCE":
            part = ""
        options["part"] = (instances.get(options["INSTANCE"].lower(), "") if "INSTANCE" in options else part).lower()
        block = [keyword, options, f"{file}:{number}", []]
    if block:
        yield block


def inp_members(rows: list[Any], generate: bool, known: dict[str, set[int]]) -> set[int]:
    """Return the members of a set; names stand for sets above."""
    members: set[int] = set()
    for *words, _ in rows:
        if generate:
            first, last, *step = (int(word) for word in words)
            members.update(range(first, last + 1, *step))
            continue
        for word in words:
            members.update([int(word)] if word.isdigit() else known.get(word.strip('"').lower(), ()))
    return members


def inp_elements(rows: list[Any], count: int, place: str) -> Iterator[tuple[int, list[int]]]:
    """Yield label and nodes of the elements of a block; a line that ends with a comma goes on in the next one."""
    waiting = []
    for *words, goes_on in rows:
        waiting += [int(word) for word in words if word]
        if len(waiting) <= count and goes_on:
            continue
        if len(waiting) != count + 1:
            raise Problem(f"{place}: error: an element with {len(waiting) - 1} nodes, expected {count}")
        yield waiting[0], waiting[1:]
        waiting = []


def read_inp(path: Path, wanted: str | None) -> Mesh:
    """Read the mesh of a model of Abaqus or CalculiX; of several parts the one wanted."""
    parts: dict[str, Mesh] = {}
    for keyword, options, place, rows in inp_blocks(path):
        mesh = parts.setdefault(options["part"], Mesh())
        try:
            if keyword == "NODE":
                labels = [int(row[0]) for row in rows]
                for *words, _ in rows:
                    mesh.nodes[int(words[0])] = tuple(float(word) for word in (words[1:] + ["0"] * 3)[:3])
                if "NSET" in options:
                    mesh.node_sets.setdefault(options["NSET"].lower(), set()).update(labels)
            elif keyword == "ELEMENT":
                kind = options.get("TYPE", "").upper()
                if not INP_HEXAHEDRA.match(kind):
                    mesh.left_out[kind] = mesh.left_out.get(kind, 0) + len(rows)
                    continue
                count = next(size for size in (20, 27, 8) if str(size) in kind)
                elements = dict(inp_elements(rows, count, place))
                mesh.elements.update(elements)
                if "ELSET" in options:
                    mesh.element_sets.setdefault(options["ELSET"].lower(), set()).update(elements)
            elif keyword in ("NSET", "ELSET"):
                sets = mesh.node_sets if keyword == "NSET" else mesh.element_sets
                sets.setdefault(options[keyword].lower(), set()).update(inp_members(rows, "GENERATE" in options, sets))
        except (ValueError, KeyError) as error:
            raise Problem(f"{place}: error: *{keyword} cannot be read: {error}") from None
    found = {name: mesh for name, mesh in parts.items() if mesh.elements}
    if wanted is not None:
        found = {name: mesh for name, mesh in found.items() if name == wanted.lower()}
    if len(found) != 1:
        names = ", ".join(name or "(outside parts)" for name, mesh in parts.items() if mesh.elements)
        raise Problem(f"{path}: expected one part with hexahedra, see --part; there are: {names or 'none'}")
    return next(iter(found.values()))


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
    """Replace nodes within a tolerance of an earlier one; return their number."""
    labels = list(mesh.nodes)
    same: dict[int, int] = {}
    for a, b in sorted(cKDTree(list(mesh.nodes.values())).query_pairs(tolerance)):
        if labels[a] not in same:
            same.setdefault(labels[b], labels[a])
    mesh.elements = {label: [same.get(node, node) for node in nodes] for label, nodes in mesh.elements.items()}
    mesh.node_sets = {name: {same.get(node, node) for node in members} for name, members in mesh.node_sets.items()}
    return len(same)


def renumber(mesh: Mesh) -> None:
    """Number nodes and elements from 1; nodes without elements are left out, and empty sets."""
    used = set(itertools.chain.from_iterable(mesh.elements.values()))
    unknown = used - mesh.nodes.keys()
    if unknown:
        raise Problem(f"node {min(unknown)} of an element has no coordinates")
    node_of = {label: i for i, label in enumerate((label for label in mesh.nodes if label in used), 1)}
    element_of = {label: i for i, label in enumerate(mesh.elements, 1)}
    if len(node_of) < len(mesh.nodes):
        mesh.left_out["nodes without hexahedra"] = len(mesh.nodes) - len(node_of)
    mesh.nodes = {node_of[label]: point for label, point in mesh.nodes.items() if label in node_of}
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


def write_inp(path: Path, mesh: Mesh, source: Path) -> None:
    """Write the file."""
    counts = {len(nodes) for nodes in mesh.elements.values()}
    if len(counts) != 1:
        raise Problem(f"hexahedra with {' and '.join(map(str, sorted(counts)))} nodes; expected one kind")
    with path.open("w", encoding="utf-8") as file:
        file.write(f"*HEADING\nmesh of {source.name}, by dd3 mesh\n*NODE\n")
        file.writelines(f"{label}, {x!r}, {y!r}, {z!r}\n" for label, (x, y, z) in mesh.nodes.items())
        file.write(f"*ELEMENT, TYPE=C3D{counts.pop()}\n")
        for label, nodes in mesh.elements.items():
            words = [str(label), *map(str, nodes)]
            lines = [", ".join(words[i:i + 14]) for i in range(0, len(words), 14)]
            file.write(",\n".join(lines) + "\n")
        for keyword, sets in ("NSET", mesh.node_sets), ("ELSET", mesh.element_sets):
            for name, members in sets.items():
                file.write(f"*{keyword}, {keyword}={set_name(name)}\n")
                file.writelines(", ".join(map(str, members[i:i + 14])) + "\n" for i in range(0, len(members), 14))


def report(path: Path, mesh: Mesh, merged: int, mirrored: int) -> None:
    """Say what was written and what was changed."""
    print(f"{path}: {len(mesh.nodes)} nodes, {len(mesh.elements)} elements")
    for what, sets in ("node sets", mesh.node_sets), ("element sets", mesh.element_sets):
        if sets:
            print(f"{what}: {' '.join(map(set_name, sets))}")
    if merged:
        print(f"nodes merged: {merged}")
    if mirrored:
        print(f"mirrored elements turned: {mirrored}")
    for kind, count in mesh.left_out.items():
        print(f"left out: {kind}: {count}")


def main(words: Sequence[str] | None = None) -> None:
    """Read, repair, write."""
    parser = new_parser("mesh", __doc__)
    parser.add_argument("source", type=Path, help="mesh, model or field file")
    parser.add_argument("target", type=Path, help=".inp file to write")
    parser.add_argument("--scale", type=float, default=1.0, help="factor on the coordinates, 1000 for metres")
    parser.add_argument("--merge", type=float, metavar="mm", help="merge nodes nearer than this, after --scale")
    parser.add_argument("--part", help="part of a model with several")
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
    merged = merge_nodes(mesh, options.merge) if options.merge else 0
    renumber(mesh)
    mirrored = turn_mirrored(mesh)
    write_inp(options.target, mesh, options.source)
    report(options.target, mesh, merged, mirrored)
