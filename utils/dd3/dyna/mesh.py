# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes, elements and parts of an LS-DYNA keyword file."""
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from dd3.dyna.cards import Card, Reader, Row, split, unread
from dd3.dyna.parameters import plain
from dd3.errors import Problem

FARTHEST = 1e7  # coordinate of a node
NODE, LABELS, THICK = (8, 16, 16, 16, 8, 8), (8,) * 10, (16,) * 5  # columns
SOLID_SHAPES = (4, 5, 6, 8)  # corners of solids that are read
# Keywords by their beginning that move or copy nodes.
MOVES = ("*INCLUDE_TRANSFORM", "*INCLUDE_STAMPED", "*NODE_TRANSFORM", "*NODE_MERGE", "*DEFINE_TRANSFORMATION",
         "*DEFORMABLE_TO_RIGID", "*CONTROL_FORMING_POSITION", "*CONTROL_FORMING_USER", "*CONTROL_FORMING_TRAVEL")
HELD = ("", "x", "y", "z", "xy", "yz", "xz", "xyz")  # by TC of *NODE
# Rows of a *PART behind its second one, by option in their order.
PART_ROWS = (("INERTIA", ("XC YC ZC TM IRCS NODEID", "IXX IXY IXZ IYY IYZ IZZ", "VTX VTY VTZ VRX VRY VRZ")),
             ("REPOSITION", ("CMSN MDEP MOVOPT",)),
             ("CONTACT", ("FS FD DC VC OPTT SFT SSF CPARM8",)),
             ("PRINT", ("PRBF",)), ("ATTACHMENT", ("ANSID",)))
NO_INERTIA = "a rigid tool has no inertia here"


@dataclass
class Cell:
    """An element: label, part, dimension, corners, place; of shells the thicknesses at the corners and the angle of the
    material, where they are given."""

    label: int
    part: int
    dimension: int
    nodes: tuple[int, ...]
    place: str
    thickness: tuple[float, ...] = ()


@dataclass
class Part:
    """A *PART with its cells."""

    number: int
    title: str
    section: int
    material: int
    place: str
    cells: list[Cell] = field(default_factory=list)
    inertia: Row | None = None  # with the centre of a rigid part


class DynaMesh:
    """Nodes by label, directions in which TC holds them, cells, parts by number; `moved` are cards that move parts."""

    def __init__(self, reader: Reader) -> None:
        self.path: Path = reader.path
        self.nodes: dict[int, tuple[float, ...]] = {}
        self.held: dict[int, str] = {}
        self.turns: dict[int, int] = {}  # RC of *NODE
        self.cells: list[Cell] = []
        self.parts: dict[int, Part] = {}
        self.moved: list[Card] = []
        self.others: list[Card] = []  # parts of kinds that are not read
        self.seen: dict[tuple[str, int], str] = {}
        for card in reader.cards:
            self.take(card)

    def take(self, card: Card) -> None:
        """Take a card of nodes, elements or parts."""
        word = card.keyword
        if word.startswith(MOVES):
            raise Problem(f"{card.place}: error: {word} moves or copies nodes and is not read; write the deck with the "
                          "nodes in their places")
        try:
            if word == "*NODE":
                self.take_nodes(card)
            elif word.startswith("*ELEMENT_SHELL") and "SOURCE" not in word:
                self.take_shells(card)
            elif word.startswith("*ELEMENT_SOLID") or word in ("*ELEMENT_TSHELL", "*ELEMENT_TSHELL_BETA"):
                self.take_solids(card)
            elif word == "*PART" or (word.startswith("*PART_") and all(
                    any(name.startswith(option) for option, _ in PART_ROWS) or name == "NODES"
                    for name in word.split("_")[1:])):
                self.take_parts(card)
            elif word == "*PART_MOVE":
                self.moved.append(card)
            elif word.startswith("*PART"):
                self.others.append(card)
        except (IndexError, ValueError, OverflowError):
            raise Problem(f"{card.place}: error: {word} cannot be read") from None

    def once(self, kind: str, label: int, place: str) -> None:
        """Note a label; a Problem if it was there before."""
        if (kind, label) in self.seen:
            raise Problem(f"{place}: error: a second {kind} {label}; the first is at {self.seen[kind, label]}")
        self.seen[kind, label] = place

    def take_nodes(self, card: Card) -> None:
        """Take nodes. Two of one label at one place are one, as LS-DYNA has it."""
        for i, words in card.words(0, NODE):
            place = card.place_of(i)
            label = card.whole(i, words[0])
            point = tuple(self.coordinate(word, card, i) for word in words[1:4])
            if label in self.nodes and point != self.nodes[label]:
                raise Problem(f"{place}: error: a second node {label}, at another place")
            self.nodes[label] = point
            for word, name in zip(words[4:6], ("TC", "RC")):
                code = card.whole(i, word)
                if not 0 <= code < len(HELD):
                    raise Problem(f"{place}: error: {name} = {code} of node {label}; expected 0 to 7")
                if code and name == "TC":
                    self.held[label] = HELD[code]
                elif code:
                    self.turns[label] = code
            beyond(card, i, words, 6)

    def coordinate(self, word: str, card: Card, i: int) -> float:
        """Return a coordinate."""
        value = plain(word, card.values, card.place_of(i)) if word else 0.0
        if not abs(value) < FARTHEST:
            raise Problem(f"{card.place_of(i)}: error: a node at {word}; expected coordinates below {FARTHEST:g}")
        return float(value)

    def take_shells(self, card: Card) -> None:
        """Take shells, each with the further rows of the options."""
        options = card.keyword.split("_")[2:]
        thick = "THICKNESS" in options or "BETA" in options or "MCID" in options
        rows = card.words(0, LABELS)
        for i, words in rows:
            labels = [card.whole(i, word) for word in words]
            if len([label for label in labels if label]) < 5:
                raise Problem(f"{card.place_of(i)}: error: a shell of {max(0, len(labels) - 2 - labels[2:].count(0))} "
                              f"nodes: '{card.lines[i][1].strip()[:80]}'")
            cell = Cell(labels[0], labels[1], 2, corners_of(labels[2:6]), card.place_of(i))
            more = sum(label > 0 for label in labels[6:10])
            if more:
                card.account.enter(cell.place, card.keyword, {"N5": words[6]}).used = True
                card.account.entries[-1].leave("nodes on the edges of a shell are left out")
            if thick:
                self.thickness(card, rows, cell, options, len(labels[2:6]) + more)
            for option in ("OFFSET", "DOF"):
                if option in options:
                    j, offset = next_row(rows, card, i)
                    if any(plain(word, card.values, card.place_of(j)) for word in offset if word):
                        card.account.enter(card.place_of(j), card.keyword, {option: offset[0]}).used = True
            self.add(cell, "shell")

    def thickness(self, card: Card, rows: Iterator[tuple[int, list[str]]], cell: Cell, options: list[str],
                  corners: int) -> None:
        """Take the row behind a shell with its thicknesses and the angle of its material, or their system of axes."""
        i, _ = next_row(rows, card, 0)
        words = split(card.lines[i][1], THICK, card.least)
        values = [float(plain(word, card.values, card.place_of(i))) if word else 0.0 for word in words]
        if "THICKNESS" in options:
            cell.thickness = tuple(values[:4])
        elif any(values[:4]):
            card.account.enter(card.place_of(i), card.keyword, {"THIC": words[0]}).used = True
        if values[4]:
            name = "MCID" if "MCID" in options else "BETA"
            card.account.enter(card.place_of(i), card.keyword, {name: words[4]}).used = True
            card.account.entries[-1].leave("the rolling direction is that of the material", name)
        if corners > 4:
            next_row(rows, card, i)

    def take_solids(self, card: Card) -> None:
        """Take solids, of one row, or of two: label and part, then the nodes."""
        rows = card.words(0, LABELS)
        axes = 2 * ("ORTHO" in card.keyword or "BETA" in card.keyword)
        for i, words in rows:
            labels = [card.whole(i, word) for word in words]
            place, head = card.place_of(i), labels[:2]
            if not any(labels[2:]):
                j, words = next_row(rows, card, i)
                labels = [*head, *(card.whole(j, word) for word in words)]
            for _ in range(axes):
                j, words = next_row(rows, card, i)
                card.account.enter(card.place_of(j), card.keyword, {"axes": words[0] or "0"}).used = True
            cell = Cell(head[0], head[1], 3, solid_of(labels[2:10]), place)
            if len(cell.nodes) in SOLID_SHAPES:
                self.add(cell, "solid")
            else:
                raise Problem(f"{place}: error: a solid of {len(cell.nodes)} corners; expected 4, 5, 6 or 8")

    def add(self, cell: Cell, kind: str) -> None:
        """Add a cell."""
        self.once(kind, cell.label, cell.place)
        self.cells.append(cell)

    def take_parts(self, card: Card) -> None:
        """Take parts: title, numbers, and the rows of the options."""
        rows = [(option, names) for option, names in PART_ROWS if option in card.keyword]
        i = 0
        while i < len(card) - 1:
            row = card.row(i + 1, "PID SECID MID EOSID HGID GRAV ADPOPT TMID")
            row.leave("elements here need no hourglass control", "HGID")
            row.leave("the mesh is not adapted", "ADPOPT")
            title, number = card.lines[i][1].strip()[:80], row.label("PID")
            self.once("*PART", number, row.place)
            self.parts[number] = Part(number, title, row.label("SECID"), row.label("MID"), row.place)
            card.rows.setdefault(i)
            i += 2
            for option, names in rows:
                i = self.take_options(card, i, option, names, self.parts[number])

    def take_options(self, card: Card, i: int, option: str, names: tuple[str, ...], part: Part) -> int:
        """Take the rows of an option of a part; return the row behind them."""
        local = False
        for name in names:
            row = card.row(i, name)
            if "XC" in name:
                part.inertia = row
            row.leave(NO_INERTIA if option == "INERTIA" else "not used")
            local = local or ("IRCS" in name and row.label("IRCS") == 1)
            i += 1
        if local:
            card.row(i, "XL YL ZL XLIP YLIP ZLIP CID").leave(NO_INERTIA)
            i += 1
        return i

    def fill_parts(self) -> None:
        """Give the parts their cells."""
        for part in self.parts.values():
            part.cells.clear()
        for cell in self.cells:
            if cell.part not in self.parts:
                raise Problem(f"{cell.place}: error: an element of part {cell.part}, but no *PART of this number"
                              + unread(self.others))
            if missing := [label for label in cell.nodes if label not in self.nodes]:
                raise Problem(f"{cell.place}: error: node {missing[0]} of element {cell.label} has no coordinates")
            self.parts[cell.part].cells.append(cell)

    def displace(self, moves: Mapping[int, np.ndarray]) -> None:
        """Displace the nodes of parts by number; a node of several parts once."""
        of_node: dict[int, tuple[int, np.ndarray]] = {}
        for number, by in moves.items():
            for label in {label for cell in self.parts[number].cells for label in cell.nodes}:
                first, known = of_node.setdefault(label, (number, by))
                if not np.allclose(known, by, atol=1e-9 * (1.0 + np.abs(by).max())):
                    raise Problem(f"{self.parts[number].place}: error: node {label} belongs to the parts {first} and "
                                  f"{number}, which are displaced before the start by {known} and {by}")
        for label, (_, by) in of_node.items():
            self.nodes[label] = tuple((np.array(self.nodes[label]) + by).tolist())


def next_row(rows: Iterator[tuple[int, list[str]]], card: Card, i: int) -> tuple[int, list[str]]:
    """Return the next row of an element."""
    found = next(rows, None)
    if found is None:
        raise Problem(f"{card.place_of(i)}: error: {card.keyword} ends within an element")
    return found


def beyond(card: Card, i: int, words: list[str], count: int) -> None:
    """Enter what stands behind the fields of a row."""
    for k, word in enumerate(words[count:], count + 1):
        if word:
            card.account.enter(card.place_of(i), card.keyword, {f"field {k}": word}).used = True


def solid_of(labels: list[int]) -> tuple[int, ...]:
    """Return the corners of a solid of LS-DYNA, a hexahedron whose other shapes repeat nodes."""
    corners = tuple(dict.fromkeys(label for label in labels[:8] if label > 0))
    if len(corners) == 6 and labels[4] == labels[5]:  # a wedge whose triangles are the faces 1 2 5 and 4 3 6
        corners = tuple(corners[k] for k in (0, 1, 4, 3, 2, 5))
    return corners


def corners_of(labels: list[int]) -> tuple[int, ...]:
    """Return the corners of a shell: a triangle repeats its last node, or has 0."""
    return tuple(label for label in dict.fromkeys(labels) if label > 0)
