# SPDX-License-Identifier: GPL-3.0-or-later
"""Keywords of .inp files that make nodes and elements of others: *NGEN, *NFILL, *NCOPY, *ELGEN, *ELCOPY.

Source: Abaqus Keywords Reference Guide. What is not read of them is refused, as the mesh depends on it.
"""
import math
from collections.abc import Callable, Iterator
from itertools import product

import numpy as np

from dd3.inp.blocks import Block, Row, label, name_of, real, refuse, whole
from dd3.inp.scope import MOST_GENERATED, Element, Point, Scope, members, placement, turn, unit


def add_to_set(scope: Scope, of_nodes: bool, name: str, numbers: list[int], place: str) -> None:
    """Add labels to a set, if a name is given."""
    if name:
        sets = scope.node_sets if of_nodes else scope.element_sets
        scope.set_of(sets, name, place).items += [range(number, number + 1) for number in numbers]


def set_members(scope: Scope, of_nodes: bool, name: str, place: str, what: str, complete: bool = False) -> list[int]:
    """Return the members of a set that must be there, with `complete` all of them."""
    def missing(why: str) -> None:
        refuse(place, f"{what}: {why}")

    found = members(scope, of_nodes, name, missing, complete)
    return found if found else refuse(place, f"{what}: the set '{name}' is empty")


def check_count(count: int, place: str, what: str) -> None:
    """End the reading if a keyword makes more than can be meant."""
    if count > MOST_GENERATED:
        refuse(place, f"{what}: would make {count}, more than {MOST_GENERATED}")


def ngen(scope: Scope, block: Block) -> None:
    """Make nodes on lines between two nodes: straight, parabolic (LINE=P) or circular (LINE=C)."""
    name, line, system = block.option("NSET"), block.option("LINE"), block.option("SYSTEM", "rc")
    if line not in ("", "p", "c") or system not in ("rc", "r", "c"):
        refuse(block.place, f"*NGEN: expected LINE=P or C and SYSTEM=RC or C, got '{line}' and '{system}'")
    block.all_read()
    for row in block.data():
        words = block.words(row, 10 if line else 3)
        first, last = (scope.node(word, row.place, "*NGEN") for word in words[:2])
        step = abs(whole(words[2], row.place, "*NGEN")) if words[2] else 1
        if first == last or not step or (last - first) % step:
            refuse(row.place, f"*NGEN: no number of steps of {step} leads from {first} to {last}")
        count = abs(last - first) // step
        check_count(count, row.place, "*NGEN")
        ends = np.array([scope.nodes[first], scope.nodes[last]])
        numbers = list(range(first, last + (1 if last > first else -1), step if last > first else -step))
        at = np.linspace(0.0, 1.0, count + 1)[:, None]
        if not line:
            points = ends[0] + at * (ends[1] - ends[0])
        else:
            extra = extra_point(scope, words, system == "c", row)
            points = parabola(ends, extra, at) if line == "p" else arc(ends, extra, words[7:], at, row)
        for number, point in zip(numbers[1:-1], points[1:-1].tolist()):
            scope.add_node(number, tuple(point), row.place, "*NGEN")
        add_to_set(scope, True, name, numbers, block.place)


def extra_point(scope: Scope, words: list[str], cylindrical: bool, row: Row) -> np.ndarray:
    """Return the third point of a line, a node or coordinates."""
    if words[3]:
        return np.array(scope.nodes[scope.node(words[3], row.place, "*NGEN")])
    if not any(words[4:7]):
        refuse(row.place, "*NGEN: expected a third point, the number of a node or coordinates")
    point = [real(word, row.place, "*NGEN") for word in words[4:7]]
    return np.array(scope.place_of(from_cylinder(point) if cylindrical else point))


def from_cylinder(point: list[float]) -> Point:
    """Return a point from radius, angle in degrees and height."""
    angle = math.radians(point[1])
    return point[0] * math.cos(angle), point[0] * math.sin(angle), point[2]


def parabola(ends: np.ndarray, middle: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Return points of the parabola through two ends and the point midway."""
    return (1 - at) * (1 - 2 * at) * ends[0] + 4 * at * (1 - at) * middle + at * (2 * at - 1) * ends[1]


def arc(ends: np.ndarray, centre: np.ndarray, normal: list[str], at: np.ndarray, row: Row) -> np.ndarray:
    """Return points of an arc about a centre at equal angles: the shorter one, or counter-clockwise about a normal."""
    one, two = ends - centre
    radii = np.linalg.norm(one), np.linalg.norm(two)
    if min(radii) <= 0.0 or abs(radii[0] - radii[1]) > 1e-3 * max(radii):
        refuse(row.place, f"*NGEN, LINE=C: the ends are {radii[0]:.6g} and {radii[1]:.6g} from the centre")
    cross = np.cross(one, two)
    if any(normal):
        axis = unit(np.array([real(word, row.place, "*NGEN") for word in normal]), row.place, "*NGEN")
        if max(abs(axis @ one), abs(axis @ two)) > 1e-3 * max(radii):
            refuse(row.place, "*NGEN, LINE=C: the normal is not normal to the plane of the ends and the centre")
        angle = math.degrees(math.atan2(float(axis @ cross), float(one @ two))) % 360.0
    elif np.linalg.norm(cross) > 1e-6 * radii[0] * radii[1]:
        axis, angle = cross, math.degrees(math.atan2(float(np.linalg.norm(cross)), float(one @ two)))
    else:
        refuse(row.place, "*NGEN, LINE=C: ends on a line with the centre need a normal to the arc")
    if angle == 0.0:
        refuse(row.place, "*NGEN, LINE=C: the ends are at the same place")
    scale = 1.0 + at[:, 0] * (radii[1] / radii[0] - 1.0)
    return np.array([centre + size * turn(axis, angle * part, row.place, "*NGEN") @ one
                     for size, part in zip(scale.tolist(), at[:, 0].tolist())])


def nfill(scope: Scope, block: Block) -> None:
    """Make nodes on straight lines between the nodes of two sets."""
    name = block.option("NSET")
    if block.has("BIAS") and real(block.option("BIAS"), block.place, "*NFILL") == 1.0:
        block.flag("BIAS")
    elif block.has("BIAS"):
        refuse(block.place, "*NFILL, BIAS: lines with unequal intervals are not read")
    block.all_read()
    for row in block.data():
        words = block.words(row, 4)
        one, two = (set_members(scope, True, name_of(word), row.place, "*NFILL", complete=True) for word in words[:2])
        count = whole(words[2], row.place, "*NFILL")
        step = whole(words[3], row.place, "*NFILL") if words[3] else 1
        if len(one) != len(two):
            refuse(row.place, f"*NFILL: the sets have {len(one)} and {len(two)} nodes, expected as many")
        if count < 1:
            refuse(row.place, f"*NFILL: expected a number of intervals, got {count}")
        check_count(len(one) * count, row.place, "*NFILL")
        made = []
        for a, b in zip(one, two):
            start, end = np.array(scope.nodes[a]), np.array(scope.nodes[b])
            for k in range(1, count):
                x, y, z = (start + k / count * (end - start)).tolist()
                scope.add_node(label(str(a + k * step), row.place, "*NFILL"), (x, y, z), row.place, "*NFILL")
                made.append(a + k * step)
        add_to_set(scope, True, name, [*one, *made, *two], block.place)


def ncopy(scope: Scope, block: Block) -> None:
    """Copy the nodes of a set: displaced and turned (SHIFT), or mirrored in a point, a line or a plane (REFLECT)."""
    if scope.system is not None:
        refuse(block.place, "*NCOPY is not read while a *SYSTEM is in effect; end it by a *SYSTEM without data lines")
    change = whole(block.need("CHANGENUMBER"), block.place, "*NCOPY, CHANGE NUMBER")
    old, new = block.need("OLDSET"), block.option("NEWSET")
    kind = "shift" if block.flag("SHIFT") else block.option("REFLECT")
    if block.has("MULTIPLE") and whole(block.option("MULTIPLE"), block.place, "*NCOPY, MULTIPLE") != 1:
        refuse(block.place, "*NCOPY, MULTIPLE: only one copy is read")
    block.all_read()
    move = copier(block, kind)
    labels = set_members(scope, True, old, block.place, "*NCOPY")
    for number in labels:
        copy = label(str(number + change), block.place, "*NCOPY")
        scope.add_node(copy, move(scope.nodes[number]), block.place, "*NCOPY")
    add_to_set(scope, True, new, [number + change for number in labels], block.place)


def copier(block: Block, kind: str) -> Callable[[Point], Point]:
    """Return the function that places a copied node."""
    rows = block.data(blank=kind == "shift")
    if kind == "shift":
        return placement(block, rows).of
    need = {"point": 3, "line": 6, "mirror": 9}.get(kind)
    if need is None:
        refuse(block.place, f"*NCOPY: expected SHIFT or REFLECT=POINT, LINE or MIRROR, got '{kind}'")
    values = np.array([value for row in rows for value in block.numbers(row, 6 if need > 3 else 3)])
    if len(values) < need:
        refuse(block.place, f"*NCOPY, REFLECT={kind.upper()}: expected {need} coordinates")
    a, b, c = (values[:3], values[3:6], values[6:9])

    def reflect(point: Point) -> Point:
        d = np.asarray(point) - a
        if kind == "point":
            result = a - d
        elif kind == "line":
            axis = unit(b - a, block.place, "*NCOPY")
            result = a + 2.0 * (d @ axis) * axis - d
        else:
            normal = unit(np.cross(b - a, c - a), block.place, "*NCOPY")
            result = a + d - 2.0 * (d @ normal) * normal
        x, y, z = result.tolist()
        return x, y, z

    return reflect


def elgen(scope: Scope, block: Block) -> None:
    """Make elements in rows, columns and layers of a master element."""
    name = block.option("ELSET")
    block.all_read()
    for row in block.data():
        words = block.words(row, 10)
        master = label(words[0], row.place, "*ELGEN")
        if master not in scope.elements:
            refuse(row.place, f"*ELGEN: there is no element {master} above")
        kind, nodes, _, group = scope.elements[master]
        counts, steps = [], []
        for i in 1, 4, 7:
            count = whole(words[i], row.place, "*ELGEN") if words[i] else 1
            if count < 1:
                refuse(row.place, f"*ELGEN: expected a number of elements, got '{words[i]}'")
            if i > 1 and count > 1 and not (words[i + 1] and words[i + 2]):
                refuse(row.place, "*ELGEN: expected the increments of nodes and elements beside each number of rows")
            counts.append(count)
            steps.append([whole(word, row.place, "*ELGEN") if word else 1 for word in words[i + 1:i + 3]])
        check_count(math.prod(counts), row.place, "*ELGEN")
        made = []
        for number, shift in generated(master, counts, steps):
            label(str(number), row.place, "*ELGEN")
            scope.add_element(number, Element(kind, [node + shift for node in nodes], row.place, name or group))
            made.append(number)
        add_to_set(scope, False, name, made, block.place)


def generated(master: int, counts: list[int], steps: list[list[int]]) -> Iterator[tuple[int, int]]:
    """Yield the numbers of generated elements, and by how much those of their nodes are larger than the master's."""
    for places in product(*map(range, counts)):
        yield (master + sum(place * step[1] for place, step in zip(places, steps)),
               sum(place * step[0] for place, step in zip(places, steps)))


def elcopy(scope: Scope, block: Block) -> None:
    """Copy the elements of a set with other numbers of their nodes."""
    change = whole(block.need("ELEMENTSHIFT"), block.place, "*ELCOPY, ELEMENT SHIFT")
    shift = whole(block.need("SHIFTNODES"), block.place, "*ELCOPY, SHIFT NODES")
    old, new = block.need("OLDSET"), block.option("NEWSET")
    block.all_read()
    numbers = set_members(scope, False, old, block.place, "*ELCOPY")
    for number in numbers:
        kind, nodes, _, group = scope.elements[number]
        copy = Element(kind, [node + shift for node in nodes], block.place, new or group)
        scope.add_element(label(str(number + change), block.place, "*ELCOPY"), copy)
    add_to_set(scope, False, new, [number + change for number in numbers], block.place)
