# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of facets: STL, Gmsh, Abaqus, LS-DYNA and VTK files as nodes and triangles or quadrilaterals."""
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from dd3.dyna.cards import Reader
from dd3.dyna.positions import placed_mesh
from dd3.errors import Problem
from dd3.gmsh_session import session
from dd3.mesh import inp_blocks, inp_elements

SUFFIXES = (".stl", ".msh", ".inp", ".k", ".key", ".dyn", ".vtk", ".vtu", ".vtp", ".ply", ".obj")
# Faces of solids by their number of corners: of a tetrahedron, a pyramid, a wedge, a hexahedron.
SOLIDS: dict[int, list[tuple[int, ...]]] = {
    4: [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)],
    5: [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
    6: [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
    8: [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]}
INP_FACETS = re.compile(r"(?:R3D|S|M3D|SFM3D|STRI|DS)(3|4|6|8|9)", re.IGNORECASE)
INP_SOLIDS = re.compile(r"(?:C3D|SC|CSS)(4|5|6|8|10|15|20|27)", re.IGNORECASE)
CORNERS = {10: 4, 15: 6, 20: 8, 27: 8}


@dataclass
class Facets:
    """Nodes (n, 3), facets (m, 4) of node numbers, the fourth -1 for a triangle, the part of each, the parts' names."""

    nodes: np.ndarray
    facets: np.ndarray
    part: np.ndarray
    names: list
    notes: list = field(default_factory=list)


def read_facets(path: Path) -> Facets:
    """Return the facets of a file."""
    ending = path.suffix.lower()
    if ending == ".stl":
        return read_stl(path)
    if ending == ".inp":
        return read_inp(path)
    if ending in (".k", ".key", ".dyn"):
        return read_dyna(path)
    if ending == ".msh":
        return read_msh(path)
    return read_vtk(path)


def read_stl(path: Path) -> Facets:
    """Read an STL file, binary or text; equal points become one node."""
    data = path.read_bytes()
    count = int(np.frombuffer(data[80:84], "<u4")[0]) if len(data) >= 84 else -1
    if len(data) == 84 + 50 * count:
        record = np.dtype([("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("attribute", "<u2")])
        points = np.frombuffer(data, record, count, 84)["points"].astype(float)
        part, names = np.zeros(count, int), ["stl"]
    else:
        points, part, names = stl_text(path, data)
    if not len(points):
        raise Problem(f"{path}: an STL file without facets")
    # Without -0, which differs from 0 bit by bit.
    nodes, inverse = np.unique(points.reshape(-1, 3) + 0.0, axis=0, return_inverse=True)
    facets = np.column_stack([inverse.reshape(-1, 3), np.full(len(points), -1)])
    return Facets(nodes, facets, part, names)


def stl_text(path: Path, data: bytes) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Return the points, the part of each facet and the parts' names of a text."""
    text = data.decode("utf-8-sig", errors="replace")
    if not text.lstrip().lower().startswith("solid") or "facet" not in text.lower():
        raise Problem(f"{path}: neither a text nor a complete binary STL file")
    points: list[Any] = []
    part: list[int] = []
    names: list[str] = []
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split()
        key = words[0].lower() if words else ""
        if key == "solid":
            names.append(" ".join(words[1:]) or f"solid {len(names) + 1}")
        elif key == "vertex":
            try:
                point = [float(word) for word in words[1:4]]
            except ValueError:
                point = []
            if len(point) != 3:
                raise Problem(f"{path}:{number}: expected vertex x y z, got '{line.strip()}'")
            points.append(point)
        elif key == "endfacet":
            if len(points) != 3 * (len(part) + 1):
                raise Problem(f"{path}:{number}: a facet with {len(points) - 3 * len(part)} vertices, expected 3")
            part.append(len(names) - 1)
    if len(points) != 3 * len(part):
        raise Problem(f"{path}: the last facet is not complete: the file is cut off")
    return np.array(points, float).reshape(-1, 3, 3), np.array(part, int), names


def from_cells(path: Path, nodes: Mapping[int, Sequence[float]],
               cells: list[tuple[Any, int, tuple[int, ...]]]) -> Facets:
    """Return facets from cells, tuples of part, dimension and node labels; solids give the faces that they do not
    share. `nodes` are the coordinates by label."""
    facets: list[list[int]] = []
    part: list[int] = []
    names: dict[Any, Any] = {}
    outer: dict[frozenset, Any] = {}
    for name, dimension, members in cells:
        number = names.setdefault(name, len(names))
        if len(members) < 3:  # a shell whose nodes are one point or one line
            continue
        if dimension == 2:
            facets.append([*members, -1][:4])
            part.append(number)
            continue
        for face in SOLIDS[len(members)]:
            corners = [members[i] for i in face]
            key = frozenset(corners)
            outer[key] = None if key in outer else ([*corners, -1][:4], number)
    skin = [value for value in outer.values() if value]
    facets += [value[0] for value in skin]
    part += [value[1] for value in skin]
    if not facets:
        raise Problem(f"{path}: no shell facets and no solids")
    labels = np.array(sorted(nodes))
    rows = np.array(facets)
    missing = set(np.unique(rows[rows >= 0]).tolist()) - nodes.keys()
    if missing:
        raise Problem(f"{path}: node {min(missing)} of an element has no coordinates")
    place = np.where(rows < 0, -1, np.searchsorted(labels, rows))
    notes = [f"{len(skin)} facets are the outer faces of solids"] if skin else []
    points = np.array([nodes[label] for label in labels.tolist()], float)
    return Facets(points, place, np.array(part), list(names), notes)


def read_inp(path: Path) -> Facets:
    """Read the shells and solids of a model of Abaqus or CalculiX; parts are its *PARTs or element sets."""
    nodes, cells = {}, []
    base: dict[str, int] = {}
    for keyword, options, place, rows in inp_blocks(path):
        # Labels are unique within a *PART only.
        first = base.setdefault(options["part"], len(base) * 10**9)
        try:
            if keyword == "NODE":
                for *words, _ in rows:
                    nodes[first + int(words[0])] = tuple(float(word) for word in (words[1:] + ["0"] * 3)[:3])
            elif keyword == "ELEMENT":
                kind = options.get("TYPE", "")
                shell = INP_FACETS.match(kind)
                kind_of = shell or INP_SOLIDS.match(kind)
                if not kind_of:
                    continue
                count = int(kind_of[1])
                corners = (3 if count in (3, 6) else 4) if shell else CORNERS.get(count, count)
                name = options["part"] or options.get("ELSET", "part").lower()
                cells += [(name, 2 if shell else 3, tuple(first + label for label in members[:corners]))
                          for _, members in inp_elements(rows, count, place)]
        except (ValueError, KeyError, IndexError) as error:
            raise Problem(f"{place}: error: *{keyword} cannot be read: {error}") from None
    return from_cells(path, nodes, cells)


def read_dyna(path: Path) -> Facets:
    """Read the shells and solids of an LS-DYNA keyword file; parts are those of *PART."""
    reader = Reader(path)
    mesh, notes = placed_mesh(reader)
    notes += [f"left out: {card.place}: {card.keyword}: not read" for card in reader.cards
              if card.keyword.startswith(("*ELEMENT", "*NODE")) and not card.entry.used]
    result = from_cells(path, mesh.nodes, [(cell.part, cell.dimension, cell.nodes) for cell in mesh.cells])
    titles = {number: part.title for number, part in mesh.parts.items()}
    result.names = [f"{number} {titles[number]}" if titles.get(number) else str(number) for number in result.names]
    result.notes += notes
    return result


def read_msh(path: Path) -> Facets:
    """Read the facets and solids of a Gmsh mesh; parts are its physical groups."""
    with session(path) as gmsh:
        labels, xyz, _ = gmsh.model.mesh.getNodes()
        nodes = dict(zip(labels.tolist(), np.reshape(xyz, (-1, 3)).tolist()))
        dimension = 2 if gmsh.model.mesh.getElements(2)[0].size else 3
        cells = []
        for _, entity in gmsh.model.getEntities(dimension):
            groups = gmsh.model.getPhysicalGroupsForEntity(dimension, entity)
            name = f"face {entity}"
            if len(groups):
                name = gmsh.model.getPhysicalName(dimension, groups[0]) or str(groups[0])
            for kind, _, members in zip(*gmsh.model.mesh.getElements(dimension, entity)):
                _, _, _, count, _, corners = gmsh.model.mesh.getElementProperties(kind)
                cells += [(name, dimension, tuple(row[:corners])) for row in np.reshape(members, (-1, count)).tolist()]
        return from_cells(path, nodes, cells)


def read_vtk(path: Path) -> Facets:
    """Read what pyvista reads; parts are numbered by connection."""
    import pyvista as pv
    from vtkmodules.vtkCommonCore import vtkLogger, vtkObject
    vtkObject.GlobalWarningDisplayOff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        data = pv.read(Path(path))
    except Exception as error:  # readers raise many kinds
        raise Problem(f"{path}: cannot be read: {error}") from None
    if isinstance(data, pv.MultiBlock):
        data = data.combine()
    data = data if isinstance(data, pv.PolyData) else data.extract_surface(nonlinear_subdivision=0,
                                                                          algorithm="dataset_surface")
    if not data.n_cells or not data.n_faces:
        raise Problem(f"{path}: no facets; a damaged file or one of another kind")
    cells, faces, i = [], np.asarray(data.faces), 0
    while i < len(faces):
        count = int(faces[i])
        ring = faces[i + 1:i + 1 + count].tolist()
        if count in (3, 4):
            cells.append(("vtk", 2, tuple(ring)))
        else:  # a polygon becomes a fan of triangles
            cells += [("vtk", 2, (ring[0], ring[k], ring[k + 1])) for k in range(1, count - 1)]
        i += count + 1
    nodes = dict(enumerate(np.asarray(data.points, float).tolist()))
    return from_cells(path, nodes, cells)
