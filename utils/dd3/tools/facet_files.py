# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of facets: STL, Gmsh, Abaqus, LS-DYNA and VTK files as nodes and triangles or quadrilaterals."""
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from dd3.account import Account
from dd3.dyna.cards import Reader
from dd3.dyna.positions import placed_mesh
from dd3.errors import Problem
from dd3.gmsh_session import session
from dd3.inp.model import Model
from dd3.inp.scope import Element

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
    account = Account()
    if is_text(data):
        points, part, names = stl_text(path, data, account)
    else:
        points = stl_binary(path, data, account)
        part, names = np.zeros(len(points), int), ["stl"]
    if not len(points):
        raise Problem(f"{path}: an STL file without facets")
    # Without -0, which differs from 0 bit by bit.
    nodes, inverse = np.unique(points.reshape(-1, 3) + 0.0, axis=0, return_inverse=True)
    facets = np.column_stack([inverse.reshape(-1, 3), np.full(len(points), -1)])
    return Facets(nodes, facets, part, names, [f"left out: {item}" for item in account.left_out()])


def is_text(data: bytes) -> bool:
    """Tell whether an STL file is a text: a binary one may begin with "solid" as well, but has other bytes after its
    header, or the length that its header gives."""
    if data.removeprefix(b"\xef\xbb\xbf").lstrip()[:5].lower() != b"solid":
        return False
    count = int.from_bytes(data[80:84], "little") if len(data) >= 84 else -1
    if len(data) == 84 + 50 * count:
        return False
    start = data[80:4096].lower()
    return not re.search(rb"[\x00-\x08\x0e-\x1f]", start) or (b"facet" in data[:4096].lower() and b"vertex" in start)


def stl_binary(path: Path, data: bytes, account: Account) -> np.ndarray:
    """Return the points of a binary file; bytes behind its facets, and the attributes of the facets, are left out."""
    if len(data) < 84:
        raise Problem(f"{path}: neither a text nor a binary STL file: {len(data)} bytes")
    count, there = int.from_bytes(data[80:84], "little"), (len(data) - 84) // 50
    if count > there:
        if not any(data[:80]) or not re.search(rb"[^\x09-\x0d\x20-\x7e]", data[:80].rstrip(b"\0")):
            raise Problem(f"{path}: the binary STL file is cut off: {there} of {count} facets")
        raise Problem(f"{path}: neither a text nor a complete binary STL file; as one it would be cut off: {there} of "
                      f"{count} facets")
    record = np.dtype([("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("attribute", "<u2")])
    facets = np.frombuffer(data, record, count, 84)
    for number in np.flatnonzero(facets["attribute"])[:1]:
        marked = int(np.count_nonzero(facets["attribute"]))
        account.enter(f"{path}: facet {number + 1}", "attribute").leave(f"colours and marks; of {marked} facets")
    if len(data) > 84 + 50 * count:
        account.enter(f"{path}: byte {85 + 50 * count}", f"{len(data) - 84 - 50 * count} bytes").leave(
            f"behind the {count} facets of the header")
    return np.asarray(facets["points"], float)


# What may follow a keyword of STL: the keyword that opens it, and the one expected next.
STL_OPENS = {"facet": "solid", "outer": "facet", "vertex": "outer"}
STL_CLOSES = {"endloop": "outer", "endfacet": "facet", "endsolid": "solid"}


def stl_text(path: Path, data: bytes, account: Account) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Return the points, the part of each facet and the parts' names of a text."""
    points: list[list[float]] = []
    part: list[int] = []
    names: list[str] = []
    is_open: list[str] = []
    text = data.decode("utf-8-sig", errors="replace")
    for number, line in enumerate(text.splitlines(), 1):
        words = line.split()
        if not words:
            continue
        key = "".join(words[:2]).lower() if words[0].lower() == "end" else words[0].lower()
        if key in ("facet", "outer", "vertex", *STL_CLOSES) and not names:
            raise Problem(f"{path}:{number}: error: {key} before the first solid")
        if key == "solid":
            if is_open:
                raise cut_off(path, number, is_open, "solid")
            names.append(" ".join(words[1:]) or f"solid {len(names) + 1}")
            is_open = ["solid"]
        elif key in STL_OPENS and key != "vertex":
            if is_open[-1:] != [STL_OPENS[key]]:
                raise cut_off(path, number, is_open, key)
            is_open.append(key)
        elif key == "vertex":
            if is_open[-1:] != ["outer"]:
                raise cut_off(path, number, is_open, key)
            points.append(vertex(path, number, line, words))
        elif key in STL_CLOSES:
            if is_open[-1:] != [STL_CLOSES[key]]:
                raise cut_off(path, number, is_open, key)
            is_open.pop()
            if key == "endfacet":
                if len(points) != 3 * (len(part) + 1):
                    raise Problem(f"{path}:{number}: error: a facet with {len(points) - 3 * len(part)} vertices, "
                                  "expected 3")
                part.append(len(names) - 1)
        elif is_open or names:
            account.enter(f"{path}:{number}", words[0]).leave("not a keyword of STL")
    if is_open:
        raise Problem(f"{path}: the file is cut off: it ends inside {' of '.join(reversed(is_open))}")
    return np.array(points, float).reshape(-1, 3, 3), np.array(part, int), names


def vertex(path: Path, number: int, line: str, words: list[str]) -> list[float]:
    """Return the coordinates of a line of a vertex."""
    try:
        point = [float(word) for word in words[1:]]
    except ValueError:
        point = []
    if len(point) != 3:
        raise Problem(f"{path}:{number}: error: expected vertex x y z, got '{line.strip()}'")
    return point


def cut_off(path: Path, number: int, is_open: list[str], key: str) -> Problem:
    """Return the Problem of a keyword that is not where it may be."""
    inside = f"inside {is_open[-1]}" if is_open else "outside of a solid"
    return Problem(f"{path}:{number}: error: {key} {inside}: a line before it is missing, or the file was cut off and "
                   "joined")


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
    """Read the shells and solids of a model of Abaqus or CalculiX in their places; parts are its *PARTs, or their
    instances where there are several of one, or element sets."""
    model = Model(path)
    nodes: dict[int, tuple[float, float, float]] = {}
    cells = []
    others: dict[str, list[Element]] = {}
    solids = list(model.solids())
    for number, solid in enumerate(solids):
        # Labels are unique within a part only.
        base = number * 10**9
        nodes |= {base + label: point for label, point in solid.scope.nodes.items()}
        several = sum(other.part == solid.part for other in solids) > 1
        name = solid.name if several else solid.part or solid.name
        for label, element in solid.scope.elements.items():
            corners, dimension = corners_and_dimension(label, element)
            if not dimension:
                others.setdefault(element.kind, []).append(element)
                continue
            cells.append((name or element.group or "part", dimension, tuple(base + node for node in corners)))
    for kind, elements in others.items():
        entry = model.account.enter(elements[0].place, f"*ELEMENT, TYPE={kind}: {len(elements)}")
        entry.leave("neither shells nor solids")
    result = from_cells(path, nodes, cells)
    return replace(result, notes=[*result.notes, *(f"left out: {item}" for item in model.left_out())])


def corners_and_dimension(label: int, element: Element) -> tuple[list[int], int]:
    """Return the corners of an element and 2 for a shell, 3 for a solid, 0 for others."""
    shell = INP_FACETS.match(element.kind)
    kind_of = shell or INP_SOLIDS.match(element.kind)
    if not kind_of:
        return [], 0
    count = int(kind_of[1])
    corners = (3 if count in (3, 6) else 4) if shell else CORNERS.get(count, count)
    return element.counted(label, count)[:corners], 2 if shell else 3


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
    account = Account()
    enter_sections(path, account)
    with session(path) as gmsh:
        labels, xyz, _ = gmsh.model.mesh.getNodes()
        nodes = dict(zip(labels.tolist(), np.reshape(xyz, (-1, 3)).tolist()))
        dimension = 2 if gmsh.model.mesh.getElements(2)[0].size else 3
        cells = []
        for other in range(4):
            count = sum(len(tags) for tags in gmsh.model.mesh.getElements(other)[1])
            if count and other != dimension:
                account.enter(str(path), f"{count} elements of dimension {other}").leave(
                    f"the facets are the elements of dimension {dimension}")
        for _, entity in gmsh.model.getEntities(dimension):
            groups = gmsh.model.getPhysicalGroupsForEntity(dimension, entity)
            name = f"face {entity}"
            if len(groups):
                name = gmsh.model.getPhysicalName(dimension, groups[0]) or str(groups[0])
            for group in groups[1:]:
                title = gmsh.model.getPhysicalName(dimension, group) or group
                account.enter(str(path), f"group {title} of face {entity}").leave(
                    f"the part of the face is its first group, {name}")
            for kind, _, members in zip(*gmsh.model.mesh.getElements(dimension, entity)):
                title, _, _, count, _, corners = gmsh.model.mesh.getElementProperties(kind)
                if corners not in ((3, 4) if dimension == 2 else SOLIDS):
                    account.enter(str(path), f"elements {title}").leave("not triangles, quadrilaterals or solids")
                    continue
                if count > corners:
                    account.enter(str(path), f"nodes between corners of {title}").leave("facets have corners only")
                cells += [(name, dimension, tuple(row[:corners])) for row in np.reshape(members, (-1, count)).tolist()]
        result = from_cells(path, nodes, cells)
    result.notes += [f"left out: {item}" for item in account.left_out()]
    return result


# Sections of a Gmsh mesh that are read.
MSH_SECTIONS = {b"MeshFormat", b"PhysicalNames", b"Entities", b"PartitionedEntities", b"Nodes", b"Elements", b"NOD",
                b"ELM", b"Comments"}


def enter_sections(path: Path, account: Account) -> None:
    """Enter the sections of a Gmsh mesh; one without its end is refused."""
    data = path.read_bytes()
    for found in re.finditer(rb"^\$(?!End)([A-Za-z]\w*)\s*$", data, re.MULTILINE):
        name, place = found[1], f"{path}:{data[:found.start()].count(10) + 1}"
        ended = re.search(rb"^\$(?:End" + name + rb"|ENDNOD|ENDELM)\s*$", data[found.end():], re.MULTILINE)
        if name in MSH_SECTIONS and not ended:
            raise Problem(f"{place}: error: ${name.decode()} without its end: the file is cut off")
        entry = account.enter(place, f"${name.decode()}")
        if name in MSH_SECTIONS:
            entry.use()


def read_vtk(path: Path) -> Facets:
    """Read what pyvista reads; parts are numbered by connection."""
    import pyvista as pv
    from vtkmodules.vtkCommonCore import vtkLogger, vtkObject
    vtkObject.GlobalWarningDisplayOff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    account = Account()
    wanted = {".ply": enter_ply, ".obj": enter_obj}.get(path.suffix.lower(), lambda *_: None)(path, account)
    try:
        data = pv.read(Path(path))
        if isinstance(data, pv.MultiBlock):
            data = data.combine()
        enter_data(path, data, account, wanted is None)
        data = data if isinstance(data, pv.PolyData) else data.extract_surface(nonlinear_subdivision=0,
                                                                              algorithm="dataset_surface")
        faces, points = np.asarray(data.faces), np.asarray(data.points, float)
    except Exception as error:  # readers raise many kinds
        raise Problem(f"{path}: cannot be read: {error}") from None
    if not data.n_cells or not data.GetNumberOfPolys():
        known = "".join(f"; {item}" for item in account.left_out()[:5])
        raise Problem(f"{path}: no facets; a damaged file or one of another kind{known}")
    if wanted is not None and data.GetNumberOfPolys() != wanted:
        raise Problem(f"{path}: {data.GetNumberOfPolys()} of {wanted} faces are read: the file is cut off or damaged")
    cells, i = [], 0
    while i < len(faces):
        count = int(faces[i])
        if not 0 < count < len(faces) - i:
            raise Problem(f"{path}: a polygon of {count} nodes: the file is damaged")
        ring = faces[i + 1:i + 1 + count].tolist()
        if count in (3, 4):
            cells.append(("vtk", 2, tuple(ring)))
        else:  # a polygon becomes a fan of triangles
            cells += [("vtk", 2, (ring[0], ring[k], ring[k + 1])) for k in range(1, count - 1)]
        i += count + 1
    result = from_cells(path, dict(enumerate(points.tolist())), cells)
    result.notes += [f"left out: {item}" for item in account.left_out()]
    return result


def enter_data(path: Path, data: Any, account: Account, fields: bool) -> None:
    """Enter the fields of a data set, if wanted, and its lines and points, which no facet is made of."""
    if fields:
        for place, names in (("nodes", data.point_data.keys()), ("cells", data.cell_data.keys()),
                             ("the whole", data.field_data.keys())):
            for name in names:
                account.enter(str(path), f"field {name} of {place}").leave("facets have no fields")
    kinds = getattr(data, "celltypes", None)
    counts = {"lines": getattr(data, "n_lines", 0), "points": getattr(data, "n_verts", 0)} if kinds is None else {
        "lines": int(np.isin(kinds, (3, 4, 21)).sum()), "points": int(np.isin(kinds, (1, 2)).sum())}
    for name, count in counts.items():
        if count:
            account.enter(str(path), f"{count} {name}").leave("no facets")


MOST_DIGITS = 18
PLY_SIZES = {"char": 1, "uchar": 1, "int8": 1, "uint8": 1, "short": 2, "ushort": 2, "int16": 2, "uint16": 2,
             "double": 8, "float64": 8}


def enter_ply(path: Path, account: Account) -> int | None:
    """Enter the elements and properties that the head of a PLY file lists; return the number of its faces. A file whose
    body is too short for its head is refused."""
    head, _, body = path.read_bytes().partition(b"end_header")
    element, faces, count, rows, least, text = "", None, 0, 0, 0, True
    for number, line in enumerate(head.decode("latin-1").splitlines(), 1):
        words = line.split()
        if words[:1] == ["format"]:
            text = words[1:2] == ["ascii"]
        elif words[:1] == ["element"]:
            if len(words) != 3 or not words[2].isdecimal() or len(words[2]) > MOST_DIGITS:
                raise Problem(f"{path}:{number}: error: '{line.strip()}'; expected element, its name and its number")
            element, count = words[1], int(words[2])
            rows += count
            entry = account.enter(f"{path}:{number}", f"element {element}, {count}")
            faces = count if element == "face" else faces
            if element in ("vertex", "face"):
                entry.use()
        elif words[:1] == ["property"] and len(words) > 2:
            least += count * PLY_SIZES.get(words[1], 1 if words[1] == "list" else 4)
            if element in ("vertex", "face"):
                entry = account.enter(f"{path}:{number}", f"property {words[-1]} of element {element}")
                if words[-1] in (("x", "y", "z") if element == "vertex" else ("vertex_indices", "vertex_index")):
                    entry.use()
    there = sum(bool(line.strip()) for line in body.splitlines()) if text else len(body)
    if there < (rows if text else least):
        raise Problem(f"{path}: the file is cut off: {there} of {rows} lines behind its head" if text else
                      f"{path}: the file is cut off: {there} bytes behind its head, which needs {least} or more")
    return faces


def enter_obj(path: Path, account: Account) -> int:
    """Enter the lines of an OBJ file by their keywords; return the number of its faces."""
    faces = 0
    text = path.read_text(encoding="utf-8", errors="replace").replace("\\\n", " ")
    for number, line in enumerate(text.splitlines(), 1):
        word = line.partition("#")[0].split()[:1]
        if not word:
            continue
        faces += word[0] == "f"
        if word[0] not in ("v", "f"):
            account.enter(f"{path}:{number}", word[0])
    return faces
