# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes, elements and sets of a part, of an instance or of a model without parts."""
import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from dd3.inp.blocks import Block, Row, label, refuse

Point = tuple[float, float, float]
MOST_GENERATED = 10_000_000  # nodes or elements by one keyword


@dataclass(frozen=True)
class Placement:
    """A displacement and then a rotation about an axis."""

    shift: np.ndarray
    point: np.ndarray = field(default_factory=lambda: np.zeros(3))
    rotation: np.ndarray = field(default_factory=lambda: np.eye(3))

    def of(self, point: Iterable[float]) -> Point:
        """Return a point in its place."""
        x, y, z = self.point + self.rotation @ (np.asarray(tuple(point)) + self.shift - self.point)
        return float(x), float(y), float(z)


def placement(block: Block, rows: list[Row]) -> Placement:
    """Return the placement of up to two lines: displacement; two points of the axis and the angle in degrees."""
    for row in rows[2:]:
        if row.filled():
            refuse(row.place, f"{block.shown}: expected a displacement and a rotation, got a further line")
    shift = np.array(block.numbers(rows[0], 3)) if rows else np.zeros(3)
    if len(rows) < 2 or not rows[1].filled():
        return Placement(shift)
    if not all(rows[1].words[:7]) or len(rows[1].words) < 7:
        refuse(rows[1].place, f"{block.shown}: expected a rotation: two points of the axis, angle in degrees")
    values = np.array(block.numbers(rows[1], 7))
    return Placement(shift, values[:3], turn(values[3:6] - values[:3], values[6], rows[1].place, block.shown))


def turn(axis: np.ndarray, angle: float, place: str, what: str) -> np.ndarray:
    """Return the matrix of a rotation by an angle in degrees (O. Rodrigues)."""
    n = unit(axis, place, what)
    skew = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]])
    # Exact for right angles.
    sine, cosine = {0.0: (0.0, 1.0), 90.0: (1.0, 0.0), 180.0: (0.0, -1.0), 270.0: (-1.0, 0.0)}.get(
        angle % 360.0, (math.sin(math.radians(angle)), math.cos(math.radians(angle))))
    return np.eye(3) + sine * skew + (1.0 - cosine) * skew @ skew


def shown(point: Point) -> str:
    """Return a point as text."""
    return " ".join(f"{value:.9g}" for value in point)


def unit(vector: np.ndarray, place: str, what: str) -> np.ndarray:
    """Return a vector of length 1."""
    length = float(np.linalg.norm(vector))
    return vector / length if length > 0.0 else refuse(place, f"{what}: points that coincide give no direction")


@dataclass
class Members:
    """Members of a set as written: labels, the names of other sets, or of element sets whose nodes they are."""

    place: str
    items: list[range | str | tuple[str, str]] = field(default_factory=list)
    ordered: bool = False  # as written; else ascending


class Element(NamedTuple):
    """An element: its type, its nodes, its place in the file, the set of its block."""

    kind: str
    nodes: list[int]
    place: str
    group: str = ""

    def counted(self, label: int, count: int) -> list[int]:
        """Return the nodes, whose number must be that of the type."""
        if len(self.nodes) == count:
            return self.nodes
        return refuse(self.place, f"element {label}: an element with {len(self.nodes)} nodes, expected {count} for "
                      f"type {self.kind}; a line that ends with a comma goes on in the next one")


@dataclass
class Scope:
    """Nodes and elements by label, sets by name; `system`: the local axes and their origin in effect."""

    name: str
    place: str
    nodes: dict[int, Point] = field(default_factory=dict)
    node_places: dict[int, str] = field(default_factory=dict)  # in the file
    elements: dict[int, Element] = field(default_factory=dict)
    node_sets: dict[str, Members] = field(default_factory=dict)
    element_sets: dict[str, Members] = field(default_factory=dict)
    bound: list[tuple[int, ...]] = field(default_factory=list)  # node, and the ends of its edge
    system: tuple[np.ndarray, np.ndarray] | None = None

    def place_of(self, point: Iterable[float]) -> Point:
        """Return a point of the local axes in those of the scope."""
        if self.system is None:
            x, y, z = point
            return x, y, z
        origin, axes = self.system
        x, y, z = (origin + axes @ np.asarray(tuple(point))).tolist()
        return x, y, z

    def add_node(self, number: int, point: Point, place: str, what: str) -> None:
        """Add a node; one that is there must be at the same place."""
        there = self.nodes.setdefault(number, point)
        first = self.node_places.setdefault(number, place)
        if there is point or there == point:
            return
        if max(abs(a - b) for a, b in zip(there, point)) > 1e-9 * max(map(abs, (*there, *point))):
            refuse(place, f"{what}: node {number} is given twice: at {shown(point)}, and at {shown(there)} in {first}")

    def add_element(self, number: int, element: Element) -> None:
        """Add an element; one that is there must be the same."""
        there = self.elements.setdefault(number, element)
        if there[:2] != element[:2]:
            refuse(element.place, f"element {number} is given twice, otherwise in {there.place}")

    def node(self, word: str, place: str, what: str) -> int:
        """Return the label of a node that is there."""
        number = label(word, place, what)
        return number if number in self.nodes else refuse(place, f"{what}: there is no node {number} above")

    def set_of(self, sets: dict[str, Members], name: str, place: str) -> Members:
        """Return a set to add members to; a new name adds one."""
        return sets.setdefault(name, Members(place))


def members(scope: Scope, of_nodes: bool, name: str, missing: Callable[[str], None],
            absent_too: bool = True) -> list[int]:
    """Return the members of a set that are there. What is not there is told to `missing`: sets that are named, and
    unless `absent_too` is false labels."""
    sets, there = (scope.node_sets, scope.nodes) if of_nodes else (scope.element_sets, scope.elements)
    found = list(dict.fromkeys(walk(scope, of_nodes, name, missing, ())))
    absent = [number for number in found if number not in there]
    if absent:
        what = "node" if of_nodes else "element"
        if absent_too:
            missing(f"there is no {what} {absent[0]}" + (f", and {len(absent) - 1} more" if absent[1:] else ""))
        found = [number for number in found if number in there]
    return found if sets[name].ordered else sorted(found)


def walk(scope: Scope, of_nodes: bool, name: str, missing: Callable[[str], None],
         above: tuple[str, ...]) -> Iterator[int]:
    """Yield the labels in a set and in the sets that it names."""
    sets, there = (scope.node_sets, scope.nodes) if of_nodes else (scope.element_sets, scope.elements)
    if name not in sets:  # that of a part by the name of its instance
        name = name.partition(".")[2] or name
    if name in above:
        missing(f"the set '{name}' names itself")
        return
    if name not in sets:
        missing(f"there is no set '{name}'")
        return
    for item in sets[name].items:
        if isinstance(item, range):
            # Of a long range those that are there, not each number.
            yield from item if len(item) <= 2 * len(there) + 1000 else sorted(n for n in there if n in item)
        elif isinstance(item, str):
            yield from walk(scope, of_nodes, item, missing, (*above, name))
        else:
            for number in walk(scope, False, item[1], missing, ()):
                yield from scope.elements[number].nodes if number in scope.elements else ()
