# SPDX-License-Identifier: GPL-3.0-or-later
"""The model of an .inp file: its parts, their instances in their places, and what lies outside parts.

Source: Abaqus Keywords Reference Guide. Each keyword that is read has a procedure here or in `generate`; all others are
left out by the account, with their line.
"""
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from dd3.account import Account, LeftOut
from dd3.inp.blocks import Block, Row, blocks, label, name_of, refuse, whole
from dd3.inp.generate import elcopy, elgen, from_cylinder, ncopy, nfill, ngen
from dd3.inp.scope import Element, Members, Placement, Scope, members, placement, unit

MOST_NODES = 100  # of an element


@dataclass
class Instance:
    """A part in its place, or a mesh of its own; with sets of the assembly."""

    name: str
    part: str
    placement: Placement
    own: Scope
    sets: Scope


@dataclass
class Solid:
    """Nodes, elements and sets of one mesh of the model in its place."""

    name: str
    part: str
    scope: Scope


@dataclass
class Model:
    """What a file holds."""

    path: Path
    account: Account = field(default_factory=Account)
    outside: Scope = field(init=False)
    parts: dict[str, Scope] = field(default_factory=dict)
    instances: dict[str, Instance] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Read the file."""
        self.scope = self.outside = Scope("", str(self.path))
        self.end = ""  # keyword that ends the part or instance
        readers: dict[str, Callable[[Block], None]] = {
            "PART": self.part, "ENDPART": self.leave, "ASSEMBLY": self.assembly, "ENDASSEMBLY": self.assembly,
            "INSTANCE": self.instance, "ENDINSTANCE": self.leave, "HEADING": self.heading, "SYSTEM": self.system,
            "NODE": self.node, "ELEMENT": self.element, "NSET": self.set, "ELSET": self.set, "MPC": self.constrain,
            "NMAP": self.refuse}
        makers = {"NGEN": ngen, "NFILL": nfill, "NCOPY": ncopy, "ELGEN": elgen, "ELCOPY": elcopy}
        for block in blocks(self.path, self.account):
            if block.keyword in makers:
                makers[block.keyword](self.scope, block)
            elif block.keyword in readers:
                readers[block.keyword](block)
            elif block.keyword.startswith("END"):  # of something that is not read
                block.entry.use()

    def left_out(self) -> list[LeftOut]:
        """Return what was not used, in the order of the lines."""
        return sorted(self.account.left_out(), key=lambda item: line_of(item.place))

    def refuse(self, block: Block) -> None:
        """Refuse a keyword that moves nodes."""
        refuse(block.place, f"{block.shown} is not read, and it moves nodes")

    def heading(self, block: Block) -> None:
        """Pass over the title."""
        block.entry.use()
        block.data()

    # ---- parts and instances -----------------------------------------------------------------------------------------

    def enter(self, block: Block, scope: Scope) -> None:
        """Begin a part or an instance."""
        if self.end:
            refuse(block.place, f"{block.shown} before *{self.end}")
        self.scope, self.end = scope, f"END{block.keyword}"
        scope.system = None

    def part(self, block: Block) -> None:
        """Begin a part."""
        name = block.need("NAME")
        if name in self.parts:
            refuse(block.place, f"a second part '{name}'")
        self.parts[name] = Scope(name, block.place)
        self.enter(block, self.parts[name])

    def leave(self, block: Block) -> None:
        """End a part or an instance."""
        block.entry.use()
        if self.end != block.keyword:
            refuse(block.place, f"{block.shown} without a beginning")
        self.scope, self.end = self.outside, ""

    def assembly(self, block: Block) -> None:
        """Pass over the beginning and the end of the assembly."""
        block.option("NAME")
        block.data()

    def instance(self, block: Block) -> None:
        """Begin an instance, and place it."""
        name, part = block.need("NAME"), block.option("PART")
        if name in self.instances:
            refuse(block.place, f"a second instance '{name}'")
        if part and part not in self.parts:
            refuse(block.place, f"there is no part '{part}' above")
        block.all_read()
        place = placement(block, block.data(blank=True))
        self.instances[name] = Instance(name, part, place, Scope(name, block.place), Scope(name, block.place))
        self.enter(block, self.instances[name].own)

    def solids(self) -> Iterator[Solid]:
        """Yield the meshes of the model: what lies outside parts, the instances, and without instances the parts."""
        if self.outside.elements:
            yield Solid("", "", self.outside)
        for instance in self.instances.values():
            yield Solid(instance.name, instance.part, self.placed(instance))
        for part in self.parts.values():
            if self.instances and all(instance.part != part.name for instance in self.instances.values()):
                self.account.enter(part.place, f"*PART {part.name}").leave("it has no instance")
            elif not self.instances:
                yield Solid(part.name, part.name, part)

    def placed(self, instance: Instance) -> Scope:
        """Return the mesh of an instance in its place. A set of the assembly may have the name of one of the part."""
        own, part = instance.own, self.parts.get(instance.part)
        source = own
        if part is not None and not own.nodes and not own.elements:
            source = part
        elif part is not None and (part.nodes or part.elements):
            refuse(own.place, f"instance '{instance.name}' has a mesh beside that of its part")
        scope = Scope(instance.name, own.place, elements=source.elements)
        scope.nodes = {number: instance.placement.of(point) for number, point in source.nodes.items()}
        scope.node_places, scope.bound = source.node_places, source.bound
        for kind in "node_sets", "element_sets":
            sets = dict(getattr(part, kind)) if part is not None else {}
            for others in getattr(own, kind), getattr(instance.sets, kind):
                for name, found in others.items():
                    if name in sets:
                        sets[f"{instance.name}.{name}"] = sets[name]
                    sets[name] = found
            setattr(scope, kind, sets)
        return scope

    # ---- nodes and elements ------------------------------------------------------------------------------------------

    def system(self, block: Block) -> None:
        """Set the local axes of nodes by an origin, a point of the x-axis and one of the plane x-y; without data they
        end."""
        block.entry.use()
        rows = block.data()
        if not rows:
            self.scope.system = None
            return
        if len(rows) > 2:
            refuse(rows[2].place, "*SYSTEM: expected two lines, got a further one")
        values = block.numbers(rows[0], 6)
        origin, x_point = np.array(values[:3]), np.array(values[3:])
        axes = np.eye(3)
        if any(rows[0].words[3:6]):
            x = x_point - origin
            if len(rows) > 1:
                z = np.cross(x, np.array(block.numbers(rows[1], 3)) - origin)
            else:
                x, z = x * (1.0, 1.0, 0.0), np.array([0.0, 0.0, 1.0])
            x, z = unit(x, block.place, "*SYSTEM"), unit(z, block.place, "*SYSTEM")
            axes = np.column_stack([x, np.cross(z, x), z])
        elif len(rows) > 1:
            refuse(rows[1].place, "*SYSTEM: a point of the plane x-y without a point of the x-axis")
        self.scope.system = origin, axes

    def node(self, block: Block) -> None:
        """Add nodes."""
        name, system = block.option("NSET"), block.option("SYSTEM", "r")
        if system not in ("r", "c"):
            refuse(block.place, f"*NODE, SYSTEM={system.upper()}: expected R or C; other coordinates are not read")
        block.all_read()
        target = self.scope.set_of(self.scope.node_sets, name, block.place).items if name else []
        for row in block.data():
            words = block.words(row, 4)
            number = label(words[0], row.place, "*NODE")
            point = block.numbers(Row(row.place, words[1:], False), 3)
            place = self.scope.place_of(from_cylinder(point) if system == "c" else point)
            self.scope.add_node(number, place, row.place, "*NODE")
            target.append(range(number, number + 1))

    def element(self, block: Block) -> None:
        """Add elements. A line that ends with a comma goes on in the next one."""
        kind, name = block.need("TYPE").upper(), block.option("ELSET")
        block.all_read()
        target = self.scope.set_of(self.scope.element_sets, name, block.place).items if name else []
        for place, words in joined(block.data()):
            number, *nodes = (label(word, place, "*ELEMENT") for word in words)
            self.scope.add_element(number, Element(kind, nodes, place, name))
            target.append(range(number, number + 1))

    def constrain(self, block: Block) -> None:
        """Add nodes that are bound to the mean of two others; other constraints are left out."""
        block.entry.use()
        for row in block.data():
            kind, *nodes = [word for word in row.words if word] or [""]
            if kind.upper() == "LINEAR" and len(nodes) == 3 and all(word.isdecimal() for word in nodes):
                self.scope.bound.append(tuple(label(word, row.place, block.shown) for word in nodes))
            else:
                self.account.enter(row.place, f"{block.shown}, {kind}").leave(
                    "LINEAR with the labels of three nodes is read")

    # ---- sets --------------------------------------------------------------------------------------------------------

    def set(self, block: Block) -> None:
        """Add members to a set of nodes or elements."""
        name, generate, instance = block.need(block.keyword), block.flag("GENERATE"), block.option("INSTANCE")
        block.flag("INTERNAL")
        of_nodes = block.keyword == "NSET"
        found = self.target(block, instance, of_nodes, name)
        if block.flag("UNSORTED"):
            found.ordered = True
        if of_nodes and block.has("ELSET"):
            found.items.append(("nodes of", block.option("ELSET")))
        for row in block.data():
            if generate:
                found.items.append(generated(block, row))
                continue
            for word in filter(None, row.words):
                if word.isdecimal():
                    number = label(word, row.place, block.shown)
                    found.items.append(range(number, number + 1))
                else:
                    self.add_named(block, row, found, of_nodes, name, name_of(word))

    def target(self, block: Block, instance: str, of_nodes: bool, name: str) -> Members:
        """Return the set that a block adds to."""
        scope = self.scope
        if instance and instance not in self.instances:
            refuse(block.place, f"{block.shown}: there is no instance '{instance}' above")
        if instance:
            scope = self.instances[instance].sets
        return scope.set_of(scope.node_sets if of_nodes else scope.element_sets, name, block.place)

    def add_named(self, block: Block, row: Row, found: Members, of_nodes: bool, name: str, word: str) -> None:
        """Add the members of another set, or those of an instance by its name, a point, and their label or set."""
        instance, point, rest = word.partition(".")
        if point and rest and instance in self.instances:
            number = label(rest, row.place, block.shown) if rest.isdecimal() else 0
            self.target(block, instance, of_nodes, name).items.append(range(number, number + 1) if number else word)
            return
        # In the assembly a set may have members in several instances.
        holders = [other.name for other in self.instances.values()
                   if word in (other.sets.node_sets if of_nodes else other.sets.element_sets)]
        if self.scope is not self.outside or not holders:
            found.items.append(word)
        else:
            for holder in holders:
                self.target(block, holder, of_nodes, name).items.append(word)


def line_of(place: str) -> tuple[str, int]:
    """Return file and line of a place."""
    path, _, number = place.rpartition(":")
    return (path, int(number)) if path and number.isdecimal() else (place, 0)


def joined(rows: list[Row]) -> Iterator[tuple[str, list[str]]]:
    """Yield place and words of each element."""
    place, waiting = "", list[str]()
    for row in rows:
        place = place if waiting else row.place
        waiting += [word for word in row.words if word]
        if row.goes_on and len(waiting) <= MOST_NODES:
            continue
        yield place, waiting
        waiting = []
    if waiting:
        yield place, waiting


def generated(block: Block, row: Row) -> range:
    """Return the labels of a line with GENERATE: first, last, increment."""
    first, last, step = block.words(row, 3)
    one, two = (label(word, row.place, block.shown) for word in (first, last or first))
    by = whole(step, row.place, block.shown) if step else 1
    if two < one or by < 1:
        refuse(row.place, f"{block.shown}, GENERATE: expected first, last, increment, got {one}, {two}, {by}")
    return range(one, two + 1, by)


def set_members(model: Model, scope: Scope, of_nodes: bool) -> dict[str, list[int]]:
    """Return the sets of a mesh with their members that are there; what is not there is entered in the account."""
    result = {}
    sets, kind = (scope.node_sets, "*NSET") if of_nodes else (scope.element_sets, "*ELSET")
    for name, found in sets.items():
        def missing(why: str, place: str = found.place, name: str = name) -> None:
            model.account.enter(place, f"{kind} {name}").leave(why)

        result[name] = members(scope, of_nodes, name, missing)
    return result
