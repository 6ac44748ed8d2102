# SPDX-License-Identifier: GPL-3.0-or-later
"""Account of what OpenCASCADE takes of a STEP or an IGES file, which it does not tell itself.

It takes the geometry that the products and their assembly refer to. Entities of the file that none of these reaches,
such as colours, layers and dimensions, are left out, and so are items of a representation of a kind that has no
geometry. The faces of the file are counted against those that were read.
"""
import re
from collections import defaultdict
from functools import lru_cache
from pathlib import Path

from dd3.account import Account
from dd3.errors import Problem
from dd3.progress import doing

ENTITY = re.compile(rb"#(\d+)\s*=\s*(\(?)\s*([A-Z_0-9]*)", re.IGNORECASE)
# What OpenCASCADE begins at: products, their shapes and assemblies.
ROOTS = re.compile(r"SHAPE_DEFINITION_REPRESENTATION|CONTEXT_DEPENDENT_SHAPE_REPRESENTATION|PRODUCT\w*|"
                   r"NEXT_ASSEMBLY_USAGE_OCCURRENCE|SHAPE_REPRESENTATION_RELATIONSHIP|APPLICATION_\w+|"
                   r"(?:ADVANCED_BREP|FACETED_BREP|MANIFOLD_SURFACE|GEOMETRICALLY_BOUNDED_\w+|EDGE_BASED_WIREFRAME|"
                   r"SHELL_BASED_WIREFRAME)?_?SHAPE_REPRESENTATION")
SHAPES = re.compile(r".*SHAPE_REPRESENTATION")
# Items of a shape that it makes geometry of, and the axes that place them.
ITEMS = re.compile(r"MANIFOLD_SOLID_BREP|BREP_WITH_VOIDS|FACETED_BREP(?:_AND_BREP_WITH_VOIDS)?|"
                   r"SHELL_BASED_SURFACE_MODEL|FACE_BASED_SURFACE_MODEL|GEOMETRIC(?:_CURVE)?_SET|MAPPED_ITEM|"
                   r"EDGE_BASED_WIREFRAME_MODEL|SHELL_BASED_WIREFRAME_MODEL|OPEN_SHELL|CLOSED_SHELL|ADVANCED_FACE|"
                   r"AXIS2_PLACEMENT_3D|\w*CURVE\w*|\w*SURFACE|CARTESIAN_POINT|SURFACED_OPEN_SHELL|"
                   r"SURFACED_OPEN_SHELL|SHELL_BASED_SURFACE_MODEL|LINE|CIRCLE|ELLIPSE|POLYLINE|VERTEX_POINT")
FACES = ("ADVANCED_FACE", "FACE_SURFACE")
# Types of IGES that it makes shapes of, and those that only belong to these: 124 places them, 308 and 408 repeat them,
# 402 groups them.
IGES = {100, 102, 104, 106, 108, 110, 112, 114, 116, 118, 120, 122, 124, 126, 128, 130, 140, 141, 142, 143, 144, 186,
        190, 192, 194, 196, 198, 308, 402, 408, 502, 504, 508, 510, 514}


@doing("looking for what the file holds beside the part")
def enter_cad(path: Path, account: Account, faces: int) -> None:
    """Enter the entities of a file of which `faces` faces were read; nothing for a BREP file, which holds shapes
    only."""
    ending = path.suffix.lower()
    if ending in (".step", ".stp"):
        enter_step(path, account, faces)
    elif ending in (".iges", ".igs"):
        enter_iges(path, account)


def enter_step(path: Path, account: Account, faces: int) -> None:
    """Enter the entities of a STEP file."""
    kinds, lines, reached = entities_of(path.read_bytes())
    for number, kind in kinds.items():
        entry = account.enter(f"{path}:{lines[number]}", kind or "entity")
        if number in reached:
            entry.use()
        else:
            entry.leave("no geometry of a part")
    count = sum(kinds[number] in FACES for number in reached)
    if faces < count:
        raise Problem(f"{path}: {count - faces} of the {count} faces of the file are not read: of a kind that "
                      "OpenCASCADE does not know, or damaged; mend them in the CAD program")


@lru_cache(maxsize=1)  # a part is read before its tools are made
def entities_of(data: bytes) -> tuple[dict[int, str], dict[int, int], set[int]]:
    """Return the kinds and the lines of the entities of a STEP file by their numbers, and those that make geometry."""
    first = max(data.find(b"DATA"), 0)
    # Without texts and comments, in which marks have no meaning; the lines stay.
    bare = re.sub(rb"'(?:[^']|'')*'|/\*.*?\*/", lambda text: b"\n" * text[0].count(b"\n") or b" ", data[first:],
                  flags=re.DOTALL)
    line, place = data[:first].count(b"\n") + 1, 0
    kinds: dict[int, str] = {}
    refers: dict[int, list[int]] = {}
    lines: dict[int, int] = {}
    for statement in bare.split(b";"):
        found = ENTITY.search(statement)
        if found:
            number = int(found[1])
            kinds[number] = found[3].decode().upper()
            if found[2]:
                names = re.findall(rb"([A-Z_0-9]+)\s*\(", statement[found.end(1):], re.IGNORECASE)
                kinds[number] = "+".join(sorted({name.decode().upper() for name in names}))
            lines[number] = line + statement[:found.start()].count(b"\n")
            refers[number] = [int(word) for word in re.findall(rb"#(\d+)", statement[found.end():])]
        line += statement.count(b"\n")
        place += len(statement) + 1
    return kinds, lines, reach(kinds, refers)


def reach(kinds: dict[int, str], refers: dict[int, list[int]]) -> set[int]:
    """Return the entities that products and shapes refer to; a shape's items only where they are geometry."""
    roots, shapes = ({kind for kind in set(kinds.values()) if any(map(names.fullmatch, kind.split("+")))}
                     for names in (ROOTS, SHAPES))
    waiting = [number for number, kind in kinds.items() if kind in roots]
    reached: set[int] = set()
    while waiting:
        number = waiting.pop()
        if number in reached or number not in kinds:
            continue
        reached.add(number)
        further = refers[number]
        if kinds[number] in shapes:
            further = [k for k in further if "CONTEXT" in kinds.get(k, "") or ITEMS.fullmatch(kinds.get(k, ""))]
        waiting += further
    return reached


def enter_iges(path: Path, account: Account) -> None:
    """Enter the entities of an IGES file: two lines each of the section D, which begin with the type."""
    types = defaultdict(list)
    second = False
    for number, text in enumerate(path.read_text(encoding="latin-1").splitlines(), 1):
        if text[72:73] != "D":
            continue
        word = text[:8].strip()
        if not second and word.removeprefix("-").isdecimal():
            types[int(word)].append(number)
        second = not second
    for kind, places in types.items():
        for place in places:
            entry = account.enter(f"{path}:{place}", f"entity of type {kind}")
            if kind in IGES:
                entry.use()
            else:
                entry.leave("no geometry of a part")
