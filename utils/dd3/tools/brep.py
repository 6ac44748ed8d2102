# SPDX-License-Identifier: GPL-3.0-or-later
"""Topology of a shape in OpenCASCADE's text format (BREP): read, changed and written, without a change of its geometry.

Gmsh's Python package has no function that takes a wire out of a face, or makes one edge of two, so that the other faces
keep their edges. Its BREP file (version 1 of the format) has faces, wires, edges and vertices as records, each with the
numbers of its parts, which are counted from the last record.
"""
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from dd3.errors import Problem

# A location: elementary ones with their powers, multiplied from left to right.
Chain = tuple[tuple[int, int], ...]
TITLE = r"^Locations (\d+)\s*\n"
FLAGS = re.compile(r"[01]{7}$")
# Records of an edge: its curve, its curve on a surface, both its curves on a surface where this is closed.
CURVE, ON_SURFACE, ON_SEAM = "1", "2", "3"
ORDER = ("So", "Sh", "Fa", "Wi", "Ed", "Ve")  # a shape holds only those of later kinds


@dataclass
class Part:
    """A part of a record: its record, whether it has the orientation of this, and the number of its location."""

    record: int
    forward: str  # sign of the format: + - i e
    place: int = 0


@dataclass
class Record:
    """A shape: kind (Ve, Ed, Wi, Fa, Sh, So, CS, Co), lines of its geometry, flags, parts."""

    kind: str
    geometry: list[str]
    flags: str
    parts: list[Part] = field(default_factory=list)


@dataclass
class Topology:
    """The records of a file in its order, parts before wholes, the text before them, and the root; the locations by
    their numbers; lines of those that were added."""

    head: str
    records: list[Record]
    root: Part
    chains: dict[int, Chain]
    added: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Set the numbers of the locations."""
        self.numbers = {chain: number for number, chain in self.chains.items()}

    @classmethod
    def of(cls, text: str) -> "Topology":
        """Return the topology of a file's text."""
        found = re.search(r"^TShapes (\d+)\s*\n", text, re.MULTILINE)
        if not found or "CASCADE Topology V1" not in text[:200]:
            raise Problem("the faces cannot be closed: Gmsh writes another version of BREP")
        count = int(found[1])
        lines = iter(text[found.end():].splitlines())
        records = [record_of(lines, count) for _ in range(count)]
        last = next(line for line in lines if line.strip())
        return cls(text[:found.start()], records, parts_of(last.split(), count)[0], chains_of(text[:found.start()]))

    def text(self) -> str:
        """Return the text of the file; records that nothing refers to are left out."""
        order = list(dict.fromkeys(self.below(self.root.record)))
        number = {record: len(order) - i for i, record in enumerate(order)}

        def words(parts: list[Part]) -> str:
            return "".join(f"{part.forward}{number[part.record]} {part.place} " for part in parts)

        blocks = ["\n".join([record.kind, *record.geometry, record.flags, words(record.parts) + "*\n"])
                  for record in (self.records[k] for k in order)]
        head = self.head
        if self.added:
            title = re.search(TITLE, head, re.MULTILINE)
            end = re.search(r"^Curve2ds ", head, re.MULTILINE)
            assert title and end
            count = int(title[1]) + len(self.added)
            head = "".join([head[:title.start()], f"Locations {count}\n", head[title.end():end.start()], *self.added,
                            head[end.start():]])
        return f"{head}TShapes {len(order)}\n" + "".join(blocks) + "\n" + words([self.root]) + "\n"

    def below(self, record: int) -> Iterator[int]:
        """Return the records of a shape, parts first."""
        for part in self.records[record].parts:
            yield from self.below(part.record)
        yield record

    def found(self, kind: str) -> list[Part]:
        """Return the shapes of a kind with their locations in the order in which Gmsh numbers them."""
        result: dict[tuple[int, Chain], Part] = {}
        for top in ORDER[:ORDER.index(kind) + 1]:
            for part, place in self.tops(self.root, (), top):
                for one, inner in self.tops(part, place, kind):
                    result.setdefault((one.record, inner), Part(one.record, one.forward, self.number(inner)))
        return list(result.values())

    def tops(self, part: Part, outer: Chain, kind: str) -> Iterator[tuple[Part, Chain]]:
        """Return the shapes of a kind in a shape within a location, from outside inwards, with their locations."""
        place = product(outer, self.chains[part.place]) if part.place else outer
        own = self.records[part.record].kind
        if own == kind:
            yield Part(part.record, part.forward), place
            return
        if own in ORDER and ORDER.index(own) > ORDER.index(kind):
            return
        for one in self.records[part.record].parts:
            yield from self.tops(one, place, kind)

    def number(self, chain: Chain) -> int:
        """Return the number of a location, which is added if there is none."""
        if chain not in self.numbers:
            self.numbers[chain] = len(self.chains)
            self.chains[len(self.chains)] = chain
            self.added.append("2  " + " ".join(f"{one} {power}" for one, power in reversed(chain)) + " 0\n")
        return self.numbers[chain]

    def matrix(self, location: int) -> np.ndarray:
        """Return the matrix of an elementary location (4, 4)."""
        title = re.search(TITLE, self.head, re.MULTILINE)
        assert title
        lines = iter(self.head[title.end():].splitlines())
        for number in range(1, location + 1):
            rows = [next(lines).split() for _ in range(3)] if next(lines).split()[0] == "1" else []
            if number == location:
                return np.array([*rows, [0, 0, 0, 1]], float)
        raise AssertionError(location)

    def ends(self, edge: int) -> list[int]:
        """Return the vertices of an edge, that of the least parameter first."""
        parts = self.records[edge].parts
        return [part.record for sign in "+-" for part in parts if part.forward == sign]

    def degenerate(self, edge: int) -> bool:
        """Tell whether an edge has no length, as at a pole."""
        return self.records[edge].geometry[0].split()[-1] == "1"

    def keep(self, faces: list[Part], closed: bool) -> None:
        """Keep faces only, as a solid if they are closed."""
        for kind, flags in (("Sh", "0101100"), ("So", "0100000")) if closed else ():
            self.records.append(Record(kind, [""], flags, faces))
            faces = [Part(len(self.records) - 1, "+")]
        self.records.append(Record("Co", [""], "1100000", faces))
        self.root = Part(len(self.records) - 1, "+")

    def has_cut_curves(self) -> bool:
        """Tell whether curves on surfaces are cut to a range, beyond which they do not go on."""
        section = self.head[self.head.find("\nCurve2ds "):self.head.find("\nCurves ")]
        return bool(re.search(r"^8 \S+ \S+ *$", section, re.MULTILINE))

    def bounds(self, edge: int) -> tuple[float, float]:
        """Return the parameters of the ends of an edge."""
        for line in self.records[edge].geometry:
            words = line.split()
            if words and words[0] == CURVE and len(words) == 5:
                return float(words[3]), float(words[4])
        raise Problem("the faces cannot be closed: an edge without a curve")

    def moved(self, vertex: int, location: int, point: np.ndarray) -> int:
        """Return a new vertex: another one, of a face with a location, at a point in the coordinates of the file."""
        old = self.records[vertex]
        matrix = np.eye(4)
        for one, power in self.chains[location]:
            matrix = matrix @ np.linalg.matrix_power(self.matrix(one), power)
        words = " ".join(repr(float(value)) for value in np.linalg.solve(matrix, [*point, 1.0])[:3])
        self.records.append(Record("Ve", [old.geometry[0], words, *old.geometry[2:]], old.flags, old.parts))
        return len(self.records) - 1

    def stretched(self, edge: int, low: float, high: float, far: Part) -> int:
        """Return a new edge: another one with other ends of its curves, and a vertex in place of that of its
        orientation."""
        old = self.records[edge]
        ends = [far if part.forward == far.forward else part for part in old.parts if part.forward in "+-"]
        geometry = []
        for line in old.geometry:
            words = line.split()
            curve = words and ((words[0] == CURVE and len(words) == 5) or words[0] in (ON_SURFACE, ON_SEAM))
            geometry.append(" ".join([*words[:-2], repr(low), repr(high)]) if curve else line)
        self.records.append(Record("Ed", geometry, old.flags, ends))
        return len(self.records) - 1


def record_of(lines: Iterator[str], count: int) -> Record:
    """Return the next record of a file with `count` of them."""
    kind = next(line for line in lines if line.strip()).strip()
    geometry: list[str] = []
    for line in lines:
        if FLAGS.match(line.strip()):
            break
        geometry.append(line)
    words: list[str] = []
    while not words or words[-1] != "*":
        words += next(lines).split()
    return Record(kind, geometry, line.strip(), parts_of(words[:-1], count))


def parts_of(words: list[str], count: int) -> list[Part]:
    """Return the parts that the words of a record name."""
    return [Part(count - int(name[1:]), name[0], int(place)) for name, place in zip(words[::2], words[1::2])]


def chains_of(head: str) -> dict[int, Chain]:
    """Return the locations of a file; 0 is none."""
    title = re.search(TITLE, head, re.MULTILINE)
    found: dict[int, Chain] = {0: ()}
    lines = iter(head[title.end():].splitlines() if title else [])
    for number in range(1, int(title[1]) + 1 if title else 1):
        words = next(lines).split()
        if words[0] == "1":  # a matrix in the next three lines
            found[number] = ((number, 1),)
            for _ in range(3):
                next(lines)
            continue
        chain: Chain = ()
        for one, power in zip(words[1:-1:2], words[2:-1:2]):
            part = found[int(one)] if int(power) > 0 else inverse(found[int(one)])
            for _ in range(abs(int(power))):
                chain = product(part, chain)
        found[number] = chain
    return found


def product(first: Chain, second: Chain) -> Chain:
    """Return a location within another one."""
    result = list(first)
    for one, power in second:
        if result and result[-1][0] == one:
            power += result.pop()[1]
        if power:
            result.append((one, power))
    return tuple(result)


def inverse(chain: Chain) -> Chain:
    """Return the inverse of a location."""
    return tuple((one, -power) for one, power in reversed(chain))
