# SPDX-License-Identifier: GPL-3.0-or-later
"""What a forming deck of LS-DYNA says: parts, materials, curves, contacts, motions, forces, supports, beads."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from dd3.dyna.cards import LONG, Card, Row, read_cards
from dd3.errors import Problem
from dd3.tools.facet_files import dyna_mesh

FARTHEST = 1e7  # coordinate of a node
SILENT = ("*KEYWORD", "*TITLE", "*END", "*PARAMETER", "*COMMENT", "*INCLUDE", "*CONTROL_TERMINATION")
# Keywords by their beginning, and why they are left out; the first that fits.
REASONS = (
    ("*CONTROL_ADAPTIVE", "the mesh is not adapted: give the blank elements of half the smallest radius"),
    ("*CONTROL_TIMESTEP", "time step and mass scaling belong to explicit dynamics; this is an implicit computation"),
    ("*CONTROL_IMPLICIT", "increments follow from *LIMITS"),
    ("*CONTROL", "settings of LS-DYNA's solver"),
    ("*DATABASE", "output follows from *OUTPUT and *HISTORY"),
    ("*HOURGLASS", "elements here need no hourglass control"),
    ("*DAMPING", "there is no dynamics"),
    ("*INITIAL_VELOCITY", "there is no dynamics"),
    ("*INITIAL", "the blank starts without stress"),
    ("*LOAD_BODY", "gravity is not available"),
    ("*CONSTRAINED", "constraint that is not read"),
    ("*INTERFACE", "results are in fields.vtkhdf"),
    ("*SENSOR", "sensors are not available; `until` ends a phase by force or travel"),
    ("*DEFINE_FRICTION", "friction is constant for each tool"),
    ("*DEFINE", "definition that nothing here uses"),
    ("*ELEMENT_SHELL_THICKNESS", "the blank has the thickness of its section everywhere"),
    ("*ELEMENT_SHELL_BETA", "the rolling direction is that of the material"),
    ("*EOS", "equations of state are not available"),
)
MESH = ("*NODE", "*ELEMENT_SHELL", "*ELEMENT_SOLID", "*ELEMENT_TSHELL")
IGNORED = ("*DEFINE_BOX", "*DEFINE_COORDINATE", "*DEFINE_VECTOR", "*SET_SEGMENT", "*SET_SHELL", "*SET_SOLID")
GEOMETRY = ("*INCLUDE_TRANSFORM", "*INCLUDE_STAMPED", "*NODE_TRANSFORM", "*PART_MOVE", "*DEFINE_TRANSFORMATION")


@dataclass
class Curve:
    """A *DEFINE_CURVE: abscissae and ordinates with their scales, and the place of each point."""

    x: np.ndarray
    y: np.ndarray
    places: list[str]


@dataclass
class Part:
    """A *PART with its cells, tuples of dimension and nodes."""

    number: int
    title: str
    section: int
    material: int
    place: str
    cells: list[tuple[int, tuple[int, ...]]] = field(default_factory=list)


@dataclass
class Pair:
    """Two sides of a contact, parts by number, its friction and place."""

    sides: tuple[set[int], set[int]]
    friction: float
    place: str


@dataclass
class Drive:
    """A motion or a force of a part or a set along an axis, 0 to 2, by a curve with a scale; `turns` about the axis.

    kind: velocity, displacement or force; of a set it is the force on each node.
    """

    target: int
    axis: int
    kind: str
    curve: int
    scale: float
    place: str
    begins: float = 0.0
    ends: float = np.inf
    of_set: bool = False
    turns: bool = False


@dataclass
class Fix:
    """Directions that are held of nodes."""

    nodes: set[int]
    axes: str
    place: str


@dataclass
class Bead:
    """A *CONTACT_DRAWBEAD: the nodes along its line, the load curve of its force and the scale of that."""

    nodes: list[int]
    curve: int
    scale: float
    place: str


class Deck:
    """A deck. `left_out` has place, keyword and reason of what is not carried over."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.parts: dict[int, Part] = {}
        self.sections: dict[int, Card] = {}
        self.materials: dict[int, Card] = {}
        self.curves: dict[int, Curve] = {}
        self.tables: dict[int, int] = {}  # the curve of the lowest rate
        self.node_sets: dict[int, list[int]] = {}
        self.part_sets: dict[int, list[int]] = {}
        self.master: dict[int, int] = {}
        self.contacts: list[Card] = []
        self.beads: list[Card] = []
        self.drives: list[Drive] = []
        self.supports: list[Card] = []
        self.left_out: list[tuple[str, str, str]] = []
        self.title, self.end_time, self.springback = "", 0.0, False
        waiting = None
        for card in read_cards(path):
            waiting = self.table_curve(card, waiting)
            self.take(card)
        self.nodes, cells, _ = dyna_mesh(path)
        if not cells:
            raise Problem(f"{path}: no shells and no solids")
        if lost := [label for label, point in self.nodes.items() if not max(map(abs, point)) < FARTHEST]:
            raise Problem(f"{path}: node {lost[0]} at {' '.join(map(str, self.nodes[lost[0]]))}; expected coordinates "
                          f"below {FARTHEST:g}")
        for number, dimension, members in cells:
            if number not in self.parts:
                raise Problem(f"{path}: elements of part {number}, but no *PART of this number")
            self.parts[number].cells.append((dimension, members))

    def leave(self, card: Card, why: str) -> None:
        """Note a card that is not carried over, once for each keyword and reason."""
        if not any(keyword == card.keyword and reason == why for _, keyword, reason in self.left_out):
            self.left_out.append((card.place, card.keyword, why))

    def table_curve(self, card: Card, waiting: int | None) -> int | None:
        """Remember the first curve behind a *DEFINE_TABLE as that of its lowest rate."""
        if card.keyword == "*DEFINE_TABLE" and card.rows:
            return card.row(0).label(0)
        if waiting is not None and card.keyword == "*DEFINE_CURVE" and card.rows:
            self.tables[waiting] = card.row(0).label(0)
            return None
        return waiting

    def take(self, card: Card) -> None:
        """Take what a card says."""
        word = card.keyword
        if word.startswith(GEOMETRY):
            raise Problem(f"{card.place}: error: {word} moves or copies nodes and is not read; write the deck with the "
                          "nodes in their places")
        for beginning, reader in self.readers():
            if word == beginning or (beginning.endswith("_") and word.startswith(beginning)):
                reader(card)
                return
        if word.startswith((*SILENT, *IGNORED)) or word in MESH:
            if word == "*CONTROL_TERMINATION":
                self.end_time = card.row(0).number(0)
            elif word == "*TITLE" and card.rows:
                self.title = card.rows[0].text.replace("#", " ").strip()
            return
        if word.startswith("*INTERFACE_SPRINGBACK"):
            self.springback = True
            return
        self.leave(card, next((why for beginning, why in REASONS if word.startswith(beginning)), "not read"))

    def readers(self) -> tuple[tuple[str, Callable[[Card], None]], ...]:
        """Return the readers by keyword, or by its beginning if that ends in _."""
        return (("*PART", self.take_part), ("*PART_CONTACT", self.take_part), ("*SECTION_SHELL", self.take_sections),
                ("*SECTION_SOLID", self.take_sections), ("*SECTION_TSHELL", self.take_sections),
                ("*MAT_", self.take_material), ("*DEFINE_CURVE", self.take_curve), ("*DEFINE_TABLE", lambda card: None),
                ("*SET_NODE_LIST", self.take_node_set), ("*SET_NODE", self.take_node_set),
                ("*SET_PART_LIST", self.take_part_set), ("*SET_PART", self.take_part_set),
                ("*CONSTRAINED_RIGID_BODIES", self.take_master), ("*CONTACT_", self.take_contact),
                ("*BOUNDARY_PRESCRIBED_MOTION_", self.take_motion), ("*LOAD_RIGID_BODY", self.take_force),
                ("*LOAD_NODE_SET", self.take_force), ("*BOUNDARY_SPC_", self.supports.append))

    def take_part(self, card: Card) -> None:
        """Take parts, two rows each; *PART_CONTACT has a third."""
        step = 3 if card.keyword == "*PART_CONTACT" else 2
        for i in range(0, len(card.rows) - 1, step):
            row = card.rows[i + 1]
            number = row.label(0)
            if number in self.parts:
                raise Problem(f"{row.place}: error: a second *PART {number}")
            self.parts[number] = Part(number, card.rows[i].text.strip(), row.label(1), row.label(2), row.place)

    def take_sections(self, card: Card) -> None:
        """Take sections: of shells two rows each."""
        step = 1 if card.keyword == "*SECTION_SOLID" else 2
        for i in range(0, len(card.rows), step):
            self.sections[card.rows[i].label(0)] = Card(card.keyword, card.rows[i].place, card.rows[i:i + step])

    def take_material(self, card: Card) -> None:
        """Take a material."""
        if card.keyword.startswith("*MAT_ADD"):
            self.leave(card, "added behaviour of a material is not available")
            return
        self.materials[card.row(0).label(0)] = card

    def take_curve(self, card: Card) -> None:
        """Take a curve."""
        first, rows = card.row(0), card.rows[1:]
        if len(rows) < 2:
            raise Problem(f"{card.place}: error: a curve of {len(rows)} points; expected 2 or more")
        scale = [first.number(i, 1.0) or 1.0 for i in (2, 3)]
        shift = [first.number(i) for i in (4, 5)]
        points = np.array([[scale[i] * (row.number(i, width=LONG) + shift[i]) for i in (0, 1)] for row in rows])
        wrong = np.flatnonzero(np.diff(points[:, 0]) <= 0)
        if wrong.size:
            raise Problem(f"{rows[wrong[0] + 1].place}: error: the abscissae of a curve must increase; "
                          f"{points[wrong[0] + 1, 0]:g} follows {points[wrong[0], 0]:g}")
        self.curves[first.label(0)] = Curve(points[:, 0], points[:, 1], [row.place for row in rows])

    def curve(self, number: int, place: str) -> Curve:
        """Return a curve, of a table that of its lowest rate."""
        number = self.tables.get(number, number)
        if number not in self.curves:
            raise Problem(f"{place}: error: there is no *DEFINE_CURVE {number}")
        return self.curves[number]

    def take_node_set(self, card: Card) -> None:
        """Take a node set."""
        self.node_sets[card.row(0).label(0)] = members(card.rows[1:])

    def take_part_set(self, card: Card) -> None:
        """Take a part set."""
        self.part_sets[card.row(0).label(0)] = members(card.rows[1:])

    def take_master(self, card: Card) -> None:
        """Take rigid bodies that follow another."""
        for row in filled(card):
            self.master[row.label(1)] = row.label(0)

    def take_contact(self, card: Card) -> None:
        """Take a contact between surfaces, or a draw-bead."""
        if card.keyword.startswith("*CONTACT_DRAWBEAD"):
            self.beads.append(card)
        elif "SURFACE_TO_SURFACE" in card.keyword or "NODES_TO_SURFACE" in card.keyword:
            self.contacts.append(card)
        else:
            self.leave(card, "contact of another kind: the sheet does not touch itself here")

    def take_motion(self, card: Card) -> None:
        """Take prescribed motions of rigid bodies and node sets."""
        of_set = card.keyword.endswith("_SET")
        if not of_set and not card.keyword.endswith("_RIGID"):
            self.leave(card, "motion of nodes, or in axes of its own; that of a rigid part is read")
            return
        for row in filled(card):
            dof, vad = row.label(1), row.label(2)
            if dof not in (1, 2, 3, 5, 6, 7) or vad not in (0, 2):
                self.leave(card, f"motion of kind dof = {dof}, vad = {vad}")
                continue
            begins, ends, turns = row.number(7), row.number(6) or np.inf, dof > 3
            axis, scale = dof - (5 if turns else 1), row.number(4, 1.0) or 1.0
            kind = "displacement" if vad == 2 else "velocity"
            self.drives.append(Drive(row.label(0), axis, kind, row.label(3), scale,
                                     row.place, begins, ends, of_set, turns))

    def take_force(self, card: Card) -> None:
        """Take forces on rigid bodies and on the nodes of sets."""
        of_set = card.keyword == "*LOAD_NODE_SET"
        for row in filled(card):
            dof, axes = row.label(1), row.label(4)
            if dof not in (1, 2, 3) or axes:
                self.leave(card, f"force of kind dof = {dof}" + (f" in the axes {axes}" if axes else ""))
                continue
            scale = row.number(3, 1.0) or 1.0
            self.drives.append(Drive(row.label(0), dof - 1, "force", row.label(2), scale, row.place, of_set=of_set))

    def of_parts(self, number: int, kind: int, place: str) -> set[int]:
        """Return the parts of a side of a contact: of kind 2 a set, 3 a part, 5 all."""
        if kind == 2:
            if number not in self.part_sets:
                raise Problem(f"{place}: error: there is no *SET_PART {number}")
            return set(self.part_sets[number])
        return {number} if kind == 3 else set(self.parts) if kind == 5 or not number else set()

    def pairs(self) -> list[Pair]:
        """Return the contacts."""
        found = []
        for card in self.contacts:
            row = card.row(0)
            sides = (self.of_parts(row.label(0), row.label(2), row.place),
                     self.of_parts(row.label(1), row.label(3), row.place))
            friction = card.rows[1].number(0) if len(card.rows) > 1 else 0.0
            if not all(sides):
                self.leave(card, "sides by segments or nodes: give them by parts")
            elif not 0 <= friction < 2:
                raise Problem(f"{card.rows[1].place}: error: a friction of {friction:g}; expected 0 to 2")
            else:
                found.append(Pair(sides, friction, card.place))
        return found

    def fixes(self) -> list[Fix]:
        """Return the supports of nodes in the axes of space."""
        found = []
        for card in self.supports:
            of_set = card.keyword.startswith("*BOUNDARY_SPC_SET")
            for row in filled(card):
                number = row.label(0)
                nodes = self.node_sets.get(number) if of_set else [number]
                if nodes is None:
                    raise Problem(f"{row.place}: error: there is no *SET_NODE {number}")
                if row.label(1):
                    self.leave(card, "a support in axes of its own")
                    continue
                axes = "".join(axis for i, axis in enumerate("xyz", 2) if row.number(i))
                if axes:
                    found.append(Fix(set(nodes), axes, row.place))
        return found

    def lines_of_beads(self) -> list[Bead]:
        """Return the draw-beads whose lines are node sets."""
        found = []
        for card in self.beads:
            row = card.row(0)
            nodes = self.node_sets.get(row.label(0)) if row.label(2) == 4 else None
            if not nodes or len(card.rows) < 4:
                self.leave(card, "a draw-bead that is not a set of nodes with a load curve: *DRAWBEAD")
                continue
            last = card.rows[3]
            found.append(Bead(nodes, last.label(0), last.number(3, 1.0) or 1.0, card.place))
        return found


def filled(card: Card) -> list[Row]:
    """Return the rows of a card that are not empty."""
    return [row for row in card.rows if row.text.strip()]


def members(rows: list[Row]) -> list[int]:
    """Return the labels in rows of a set."""
    return [row.label(i) for row in rows for i, word in enumerate(row.words()) if word and row.label(i)]
