# SPDX-License-Identifier: GPL-3.0-or-later
"""What a forming deck of LS-DYNA says: parts, materials, contacts, motions, forces, supports, beads, gravity.

The order of the fields is that of the LS-DYNA Keyword User's Manual, Vol. I and II.
"""
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dd3.account import LeftOut
from dd3.dyna.cards import Card, Reader, Row, unread
from dd3.dyna.curves import Curves
from dd3.dyna.mesh import Part
from dd3.dyna.positions import AUTO, placed_mesh
from dd3.dyna.sets import Sets
from dd3.errors import Problem

# Why keywords are left out, by their beginning; the first that fits. Others are named without a reason.
REASONS = (
    ("*CONTROL_ADAPTIVE", "the mesh is not adapted: give the blank elements of half the smallest radius"),
    ("*CONTROL_TIMESTEP", "time step and mass scaling belong to explicit dynamics; this is an implicit computation"),
    ("*CONTROL_IMPLICIT", "increments follow from *LIMITS"),
    ("*CONTROL_FORMING", "not read; tools start where *NODE has them"),
    ("*CONTROL", "settings of LS-DYNA's solver"),
    ("*DATABASE", "output follows from *OUTPUT and *HISTORY"),
    ("*HOURGLASS", "elements here need no hourglass control"),
    ("*DAMPING", "there is no dynamics"),
    ("*INITIAL_VELOCITY", "there is no dynamics"),
    ("*INITIAL", "the blank starts without stress"),
    ("*LOAD_BODY", "body force that is not read; gravity by *LOAD_BODY_X, _Y, _Z and _VECTOR is"),
    ("*CONTACT_AUTO_MOVE", "not read; tools move by *BOUNDARY_PRESCRIBED_MOTION_RIGID"),
    ("*CONTACT", "contact of another kind: the sheet does not touch itself here"),
    ("*CONSTRAINED", "constraint that is not read"),
    ("*INTERFACE", "results are in fields.vtkhdf"),
    ("*SENSOR", "sensors are not available; `until` ends a phase by force or travel"),
    ("*MAT_ADD", "added behaviour of a material is not available"),
    ("*DEFINE_FRICTION", "friction is constant for each tool"),
    ("*DEFINE", "definition that nothing here uses"),
    ("*SET", "a set of a kind that is not read"),
    ("*BOUNDARY_PRESCRIBED_MOTION", "motion of nodes, or in axes of its own; that of a rigid part is read"),
    ("*EOS", "equations of state are not available"),
    ("*ELEMENT", "elements other than shells and solids"),
)
DAMAGES = "*MAT_ADD_EROSION", "*MAT_ADD_DAMAGE_GISSMO"
SHELL = ("SECID ELFORM SHRF=1 NIP PROPT=1 QR ICOMP SETYP=1", "T1 T2 T3 T4 NLOC MAREA IDOF EDGSET")
CONTACT = ("SURFA SURFB SURFATYP SURFBTYP SABOXID SBBOXID SAPR SBPR", "FS FD DC VC VDC PENCHK BT DT=1E20",
           "SFSA=1 SFSB=1 SAST SBST SFSAT=1 SFSBT=1 FSF=1 VSF=1")
CONTACT_MORE = ("SOFT SOFSCL=0.1 LCIDAB MAXPAR=1.025 SBOPT=2 DEPTH=2 BSORT FRCFRQ=1",
                "PENMAX THKOPT SHLTHK SNLOG ISYM I2D3D SLDTHK SLDSTF",
                "IGAP=1 IGNORE DPRFAC DTSTIF EDGEK unused FLANGL CID_RCF",
                "Q2TRI DTPCHK SFNBR FNLSCL DNLSCL TCSO TIEDID SHLEDG")
# Options of a contact with rows of their own behind the third one: the number of these, and why they are left out.
OPTION_ROWS = (("THERMAL", 1, "no heat flows between sheet and tools"),
               ("THERMAL_FRICTION", 1, "friction does not depend on the temperature"),
               ("ORTHO_FRICTION", 2, "friction is the same in all directions"))
TIED = "TIED", "TIEBREAK", "SPOTWELD"
SELF = "*CONTACT_AUTOMATIC_SINGLE_SURFACE", "*CONTACT_AUTOMATIC_GENERAL"  # of all its parts with one another
BEAD = "LCIDRF LCIDNF DBDTH DFSCL NUMINT DBPID ELOFF NBEAD"
MOTION = "PID DOF VAD LCID SF VID DEATH BIRTH"
FORCE = "PID DOF LCID SF CID M1 M2 M3"
PENALTY = "a setting of LS-DYNA's contact; that of dd3imp is in *CONTACT"
THICK = "the thickness of tools counts in an AUTOMATIC contact alone; others act at their nodes"
ALWAYS = "a contact acts from the start to the end; `release` withdraws a tool"


@dataclass
class Pair:
    """Two sides of a contact, parts by number, its friction and place.

    covers: where the contact acts at the faces of shells, the thickness that the contact gives to each side, 0 for that
    of the shells, and the factor on the latter; None where it acts at their nodes.
    """

    sides: tuple[set[int], set[int]]
    friction: float
    place: str
    covers: tuple[tuple[float, float], tuple[float, float]] | None = None


@dataclass
class Drive:
    """A motion or a force of a part or a set along a direction, by a curve with a scale; `turns` about the direction.

    kind: velocity, displacement or force; of a set it is the force on each node.
    """

    target: int
    direction: np.ndarray
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
    """Directions that are held of nodes, and of their rotations."""

    nodes: set[int]
    axes: str
    turns: str
    place: str


@dataclass
class Bead:
    """A *CONTACT_DRAWBEAD: the nodes along its line, the load curve of its force and the scale of that, the load curve
    of its normal force or 0."""

    nodes: list[int]
    curve: int
    scale: float
    normal: int
    place: str


@dataclass
class Gravity:
    """The acceleration of a *LOAD_BODY along a direction, by a curve with a scale."""

    direction: np.ndarray
    curve: int
    scale: float
    place: str


class Deck:
    """A deck; `left_out` at the end gives what nothing has used."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.reader = reader = Reader(path)
        if not reader.cards:
            raise Problem(f"{path}: no keyword: expected a keyword file of LS-DYNA")
        self.mesh, moves = placed_mesh(reader)
        self.nodes, self.parts = self.mesh.nodes, self.mesh.parts
        self.sets, self.curves = Sets(self.mesh), Curves(path)
        self.sections: dict[int, tuple[Card, int]] = {}
        self.materials: dict[int, Card] = {}
        self.vectors: dict[int, tuple[Card, int]] = {}
        self.master: dict[int, int] = {}
        self.contacts: list[Card] = []
        self.beads: list[Card] = []
        self.drives: list[Drive] = []
        self.no_drives: list[str] = []  # motions and forces that are left out
        self.supports: list[Card] = []
        self.gravity: list[Gravity] = []
        self.damages: list[Card] = []  # fracture that is added to a material
        self.heavy: list[Row] = []  # of *LOAD_BODY_PARTS
        self.hung: list[tuple[str, list[int]]] = []
        self.notes = [*moves, *(f"{place}: a second *PARAMETER {name}; the first holds, as in LS-DYNA"
                      for place, name in reader.parameters.twice)]
        self.title, self.end_time, self.springback = "", 0.0, False
        # Motions name vectors, which may stand behind them.
        for card in sorted(reader.cards, key=lambda card: card.keyword != "*DEFINE_VECTOR"):
            self.take(card)
        if not self.mesh.cells:
            raise Problem(f"{path}: no shells and no solids" + self.unread("*ELEMENT"))
        self.mesh.fill_parts()

    def left_out(self) -> list[LeftOut]:
        """Return what nothing has used."""
        return self.reader.left_out()

    def unread(self, beginning: str) -> str:
        """Return a text on the keywords with a beginning that are not read, for a message on what is missing."""
        found = [card for card in self.reader.cards if card.keyword.startswith(beginning) and not card.entry.used
                 and not KNOWN.get(card.keyword) and not self.known(card)]
        return unread(found)

    def known(self, card: Card) -> bool:
        """Check whether a card is read where something uses it."""
        return (any(card in cards for cards in self.sets.cards.values()) or self.curves.holds(card)
                or card in self.materials.values() or any(card is one for one, _ in self.sections.values()))

    def take(self, card: Card) -> None:
        """Take what a card says."""
        word = card.keyword
        reader = KNOWN.get(word) or next((one for beginning, one in BEGINNINGS if word.startswith(beginning)), None)
        if reader:
            reader(self, card)
        elif word in DAMAGES and card.lines:
            self.damages.append(card)
            card.leave("nothing here uses its material")
        elif word.startswith("*MAT_") and not word.startswith("*MAT_ADD"):
            self.take_material(card)
        elif word.startswith("*CONTACT_") and set(word.split("_")) & set(TIED):
            card.leave("a bond between surfaces is not available")
        elif word.startswith("*CONTACT_") and ("SURFACE_TO_SURFACE" in word or "NODES_TO_SURFACE" in word):
            self.contacts.append(card)
        elif word in SELF:
            self.contacts.append(card)
            self.notes.append(f"{card.place}: {word}: the contact of the blank with tools; the sheet does not touch "
                              "itself here")
        elif not self.sets.take(card) and not self.curves.take(card):
            card.leave(next((why for beginning, why in REASONS if word.startswith(beginning)), "not read"))

    # ---- what cards say ---------------------------------------------------------------------------------------------

    def take_title(self, card: Card) -> None:
        """Take the title."""
        if card.lines:
            self.title = " ".join(card.lines[0][1].replace("#", " ").split())[:80]
        card.ignore()

    def take_end(self, card: Card) -> None:
        """Take the time at which the process ends."""
        row = card.optional(0, "ENDTIM ENDCYC DTMIN ENDENG ENDMAS=1E8 NOSOL")
        self.end_time = row.number("ENDTIM")
        row.leave("the process ends with its last phase")

    def take_springback(self, card: Card) -> None:
        """Take that the blank springs back; the nodes and settings of its output are of no use here."""
        self.springback = True
        card.ignore()

    def take_sections(self, card: Card) -> None:
        """Take sections: of shells two rows each, and of layers with angles these; with TITLE each has its own."""
        shells, i = card.keyword == "*SECTION_SHELL", 0
        while i < len(card):
            if not card.lines[i][1].strip() and not shells:
                i += 1
                continue
            number, (points, angles) = card.first(i), (card.whole(i, card.field(i, k)) for k in (3, 6))
            self.once("*SECTION", self.sections, number, card.place_of(i))
            self.sections[number] = card, i
            i += 1 + shells
            if angles == 1 and card.keyword != "*SECTION_SOLID":
                i += -(-points // 8)
            if "TITLE" in card.options and i < len(card):
                card.rows.setdefault(i)
                i += 1

    def once(self, kind: str, there: dict, number: int, place: str) -> None:
        """Raise a Problem at a second definition of a number."""
        if number in there:
            first = there[number][0] if isinstance(there[number], tuple) else there[number]
            raise Problem(f"{place}: error: a second {kind} {number}; the first is at {first.place}")

    def take_material(self, card: Card) -> None:
        """Take a material."""
        number = card.first(0)
        self.once("*MAT", self.materials, number, card.place)
        card.leave("no part of this material is the blank or a tool")
        self.materials[number] = card

    def take_vector(self, card: Card) -> None:
        """Take vectors."""
        for i in card.filled():
            number = card.first(i)
            self.once("*DEFINE_VECTOR", self.vectors, number, card.place_of(i))
            self.vectors[number] = card, i
        card.leave("nothing here uses it")

    def vector(self, number: int, place: str) -> np.ndarray:
        """Return the unit vector of a *DEFINE_VECTOR."""
        if number not in self.vectors:
            raise Problem(f"{place}: error: there is no *DEFINE_VECTOR {number}" + self.unread("*DEFINE_VECTOR"))
        card, i = self.vectors[number]
        row = card.row(i, "VID XT YT ZT XH YH ZH CID")
        row.label("VID")
        value = np.array(row.numbers("XH YH ZH")) - np.array(row.numbers("XT YT ZT"))
        if row.label("CID") or not np.linalg.norm(value) > 0:
            raise Problem(f"{row.place}: error: a *DEFINE_VECTOR in axes of its own, or of no length")
        return np.asarray(value / np.linalg.norm(value))

    def take_master(self, card: Card) -> None:
        """Take rigid bodies that follow another."""
        for i in card.filled():
            row = card.row(i, "PIDL PIDC IFLAG")
            self.master[row.label("PIDC")] = row.label("PIDL")

    def take_motion(self, card: Card) -> None:
        """Take prescribed motions of rigid bodies and node sets; with ID each has a row of its own before it, of some
        kinds a row behind it."""
        of_set = card.keyword.endswith("_SET")
        rows = iter(card.filled())
        for i in rows:
            row = card.row(i, MOTION)
            dof, vad = row.label("DOF"), row.label("VAD")
            more = [next(rows, None)] if abs(dof) in (9, 10, 11) or vad == 4 else []
            card.rows |= {k: None for k in (*more, next(rows, None) if "ID" in card.options else None) if k is not None}
            if dof not in (1, 2, 3, 4, 5, 6, 7, 8) or vad not in (0, 2):
                self.drop_drive(row, f"motion of kind DOF = {dof}, VAD = {vad}")
                continue
            direction = (self.vector(row.label("VID"), row.place) if dof in (4, 8)
                         else np.eye(3)[dof - (5 if dof > 4 else 1)])
            kind = "displacement" if vad == 2 else "velocity"
            self.drives.append(Drive(row.label("PID"), direction, kind, row.label("LCID"), row.number("SF", 1.0) or 1.0,
                                     row.place, row.number("BIRTH"), row.number("DEATH") or np.inf, of_set, dof > 4))

    def take_force(self, card: Card) -> None:
        """Take forces on rigid bodies and on the nodes of sets."""
        for i in card.filled():
            row = card.row(i, FORCE)
            dof, axes = row.label("DOF"), row.label("CID")
            if dof not in (1, 2, 3) or axes:
                self.drop_drive(row, f"force of kind DOF = {dof}" + (f" in the axes {axes}" if axes else ""))
                continue
            self.drives.append(Drive(row.label("PID"), np.eye(3)[dof - 1], "force", row.label("LCID"),
                                     row.number("SF", 1.0) or 1.0, row.place, of_set=card.keyword == "*LOAD_NODE_SET"))

    def drop_drive(self, row: Row, why: str) -> None:
        """Leave out a motion or a force."""
        row.drop(why)
        self.no_drives.append(f"{row.place}: {why}: left out")

    def take_gravity(self, card: Card) -> None:
        """Take an acceleration of the base: the body force acts against it."""
        row = card.row(0, "LCID SF LCIDDR XC YC ZC CID")
        row.leave("the relaxation before the start", "LCIDDR")
        name = card.keyword.rpartition("_")[2]
        direction = np.eye(3)["XYZ".index(name)] if name in "XYZ" else np.array(
            card.row(1, "V1 V2 V3").numbers("V1 V2 V3"))
        if not np.linalg.norm(direction) > 0 or row.label("CID"):
            raise Problem(f"{row.place}: error: {card.keyword} in axes of its own, or without a direction")
        self.gravity.append(Gravity(-direction / np.linalg.norm(direction), row.label("LCID"),
                                    row.number("SF", 1.0) or 1.0, row.place))

    def take_heavy(self, card: Card) -> None:
        """Take the set of parts on which *LOAD_BODY acts."""
        self.heavy.append(card.row(0, "PSID"))

    def take_hung(self, card: Card) -> None:
        """Take nodes that hang on the edge between two others."""
        self.hung += [(card.place_of(i), [card.whole(i, word) for word in words[:3]]) for i, words in card.words(0)]

    def take_mesh(self, card: Card) -> None:
        """Leave to the mesh what it reads."""

    # ---- what is asked for ------------------------------------------------------------------------------------------

    def section(self, part: Part, keyword: str, names: tuple[str, ...]) -> list[Row]:
        """Return the rows of the section of a part."""
        if part.section not in self.sections or self.sections[part.section][0].keyword != keyword:
            raise Problem(f"{part.place}: error: part {part.number} has no {keyword} {part.section}"
                          + self.unread("*SECTION"))
        card, i = self.sections[part.section]
        return [card.optional(i + k, name) for k, name in enumerate(names)]

    def material(self, part: Part) -> Card:
        """Return the material of a part."""
        if part.material not in self.materials:
            raise Problem(f"{part.place}: error: part {part.number} has no *MAT {part.material}" + self.unread("*MAT"))
        return self.materials[part.material]

    def node_set(self, number: int, place: str) -> list[int]:
        """Return the nodes of a set."""
        return self.of_set("NODE", number, place)

    def of_set(self, kind: str, number: int, place: str) -> list[int]:
        """Return the labels of a set of a kind."""
        if not self.sets.has(kind, number):
            raise self.sets.missing(kind, number, place)
        return self.sets.get(kind, number)

    def of_parts(self, number: int, kind: int, place: str) -> set[int]:
        """Return the parts of a side of a contact: 0 of segments, 1 of shells, 2 a set of parts, 3 a part, 4 of nodes,
        5 all, 6 all but a set. Of nodes those parts that have an element with all of its nodes in the set."""
        if kind == 2:
            return set(self.of_set("PART", number, place))
        if kind == 3:
            return {number}
        if kind == 5 or not number:
            return set(self.parts)
        if kind == 6:
            return set(self.parts) - set(self.of_set("PART", number, place))
        if kind == 1:
            shells = set(self.of_set("SHELL", number, place))
            return {cell.part for cell in self.mesh.cells if cell.dimension == 2 and cell.label in shells}
        if kind in (0, 4):
            nodes = set(self.of_set("NODE" if kind else "SEGMENT", number, place))
            return {cell.part for cell in self.mesh.cells
                    if sum(label in nodes for label in cell.nodes) >= min(len(cell.nodes), 4 if not kind else 8)}
        raise Problem(f"{place}: error: a side of a contact of type {kind}; expected 0 to 6")

    def pairs(self) -> list[Pair]:
        """Return the contacts."""
        found = []
        for card in self.contacts:
            row, second = card.row(0, CONTACT[0]), card.optional(1, CONTACT[1])
            row.leave("forces are in history.csv", "SAPR SBPR")
            one = self.of_parts(row.label("SURFA"), row.label("SURFATYP"), row.place)
            other = one if card.keyword in SELF else self.of_parts(row.label("SURFB"), row.label("SURFBTYP"), row.place)
            friction = second.number("FS")
            if not 0 <= friction < 2:
                raise Problem(f"{second.place}: error: a friction of {friction:g}; expected 0 to 2")
            if second.number("FD") != friction:
                second.entry.read -= {"FD"}
            second.leave("friction is that at rest, FS: it does not depend on the velocity", "FD DC")
            second.leave("a limit of friction is not available", "VC")
            second.leave("there is no dynamics", "VDC")
            second.leave(PENALTY, "PENCHK")
            second.leave(ALWAYS, "BT DT")
            if not second.number("DT", 1e20) < (self.end_time or 1e19):
                second.entry.read.add("DT")
            else:
                second.entry.read.discard("DT")
            covers = None
            if "AUTOMATIC" in card.keyword:
                third = card.optional(2, CONTACT[2])
                covers = ((third.number("SAST"), third.number("SFSAT", 1.0) or 1.0),
                          (third.number("SBST"), third.number("SFSBT", 1.0) or 1.0))
            for i, (names, why) in enumerate(contact_rows(card.keyword), 2):
                if i < len(card):
                    card.row(i, names).leave(why)
            if not covers and len(card) > 2:
                card.row(2, CONTACT[2]).leave(THICK, "SAST SBST SFSAT SFSBT")
            found.append(Pair((one, other), friction, card.place, covers))
        return found

    def fixes(self) -> list[Fix]:
        """Return the supports of nodes in the axes of space, those by *NODE too."""
        by_axes: dict[tuple[str, str], set[int]] = {}
        for label in self.mesh.held.keys() | self.mesh.turns.keys():
            turns = ("", "x", "y", "z", "xy", "yz", "xz", "xyz")[self.mesh.turns.get(label, 0)]
            by_axes.setdefault((self.mesh.held.get(label, ""), turns), set()).add(label)
        found = [Fix(nodes, *axes, f"{self.path}: *NODE") for axes, nodes in sorted(by_axes.items())]
        for card in self.supports:
            of_set = card.keyword == "*BOUNDARY_SPC_SET"
            rows = card.filled()
            for i in rows[::2] if "ID" in card.options else rows:
                row = card.row(i, "NSID CID DOFX DOFY DOFZ DOFRX DOFRY DOFRZ")
                number = row.label("NSID")
                if row.label("CID"):
                    row.drop("a support in axes of its own")
                    continue
                nodes = self.node_set(number, row.place) if of_set else [number]
                axes, turns = ("".join(axis for axis in "xyz" if row.number(f"{name}{axis.upper()}"))
                               for name in ("DOF", "DOFR"))
                found.append(Fix(set(nodes), axes, turns, row.place))
        return found

    def lines_of_beads(self) -> list[Bead]:
        """Return the draw-beads whose lines are node sets."""
        found = []
        for card in self.beads:
            row = card.row(0, CONTACT[0])
            if row.label("SURFATYP") != 4 or len(card) < 4:
                row.drop("a draw-bead that is not a set of nodes with a load curve: *DRAWBEAD")
                continue
            row.number("SURFB"), row.number("SURFBTYP")
            nodes = self.node_set(row.label("SURFA"), row.place)
            for i, names in ((1, CONTACT[1]), (2, CONTACT[2])):
                card.row(i, names).leave("only the restraining and the normal force of a bead are taken")
            last = card.row(3, BEAD)
            last.leave("the bead has its full force from the start", "DBDTH")
            last.leave("the bead is divided by the elements", "NUMINT")
            curve = last.label("LCIDRF")
            if curve < 0:
                raise Problem(f"{last.place}: error: LCIDRF = {curve}: a force that varies along the bead is not "
                              "available; divide the bead")
            found.append(Bead(nodes, curve, last.number("DFSCL", 1.0) or 1.0, abs(last.label("LCIDNF")), card.place))
        return found


def contact_rows(keyword: str) -> list[tuple[str, str]]:
    """Return the names of the fields of a contact in its rows from the third on, and why they are left out."""
    own = [("", why) for option, count, why in OPTION_ROWS if option in keyword for _ in range(count)]
    return [(CONTACT[2], PENALTY), *own, *((names, PENALTY) for names in CONTACT_MORE)]


KNOWN: dict[str, Callable[[Deck, Card], None]] = {
    "*TITLE": Deck.take_title, "*CONTROL_TERMINATION": Deck.take_end, "*KEYWORD": lambda deck, card: card.ignore(),
    "*COMMENT": lambda deck, card: card.ignore(), "*NODE": Deck.take_mesh, "*PART_MOVE": Deck.take_mesh,
    "*SECTION_SHELL": Deck.take_sections, "*SECTION_SOLID": Deck.take_sections, "*SECTION_TSHELL": Deck.take_sections,
    "*DEFINE_VECTOR": Deck.take_vector, "*CONSTRAINED_RIGID_BODIES": Deck.take_master,
    "*CONSTRAINED_ADAPTIVITY": Deck.take_hung,
    "*BOUNDARY_PRESCRIBED_MOTION_RIGID": Deck.take_motion, "*BOUNDARY_PRESCRIBED_MOTION_SET": Deck.take_motion,
    "*LOAD_RIGID_BODY": Deck.take_force, "*LOAD_NODE_SET": Deck.take_force,
    "*LOAD_BODY_X": Deck.take_gravity, "*LOAD_BODY_Y": Deck.take_gravity, "*LOAD_BODY_Z": Deck.take_gravity,
    "*LOAD_BODY_VECTOR": Deck.take_gravity, "*LOAD_BODY_PARTS": Deck.take_heavy,
    "*BOUNDARY_SPC_NODE": lambda deck, card: deck.supports.append(card),
    "*BOUNDARY_SPC_SET": lambda deck, card: deck.supports.append(card),
    "*CONTACT_DRAWBEAD": lambda deck, card: deck.beads.append(card)}
BEGINNINGS: tuple[tuple[str, Callable[[Deck, Card], None]], ...] = (
    ("*INTERFACE_SPRINGBACK", Deck.take_springback),
    (AUTO, Deck.take_mesh))
