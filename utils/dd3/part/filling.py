# SPDX-License-Identifier: GPL-3.0-or-later
"""Openings of one side of a part filled by its own surfaces: a change of its topology alone.

A wire of free edges is taken out of its face. Where an opening interrupts edges between faces, or the rim, the pieces
of each lie on one curve: the first piece is continued to the end of the second, and both replace the free edges in the
wires. All faces keep their surfaces and the edges that they share.
"""
from collections import defaultdict
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from dd3.part.openings import Opening
from dd3.tools.brep import Part, Topology

# Distance of equal points over the size of the side; of a continued edge from the other piece and from its faces.
SAME, ON_CURVE = 1e-6, 1e-5
# Points of a curve at which the other piece is sought, and places at which it is compared.
SOUGHT, COMPARED = 400, np.linspace(0, 1, 9)
# Steps to the point at which two curves meet.
MEETING = 20


@dataclass
class Side:
    """Faces of a part in a topology: one side, or all of a solid; the numbers that they have in the part, and those of
    faces that belong to no form within an opening; the tags in the session of Gmsh of all edges, of those that were
    continued that of one of their pieces; distance of equal points, mm."""

    gmsh: Any
    topology: Topology
    faces: list[Part]
    numbers: list[int]
    fixed: set[int]
    tags: dict[int, int]
    near: float
    middles: dict[int, np.ndarray] = field(init=False)
    ending: bool = field(init=False)  # curves end with their edges
    became: dict[int, int] = field(default_factory=dict)  # edges, by their pieces
    owner_of: dict[int, list[int]] | None = None
    continued: list[int] = field(default_factory=list)  # tags of edges in the file of the result

    def __post_init__(self) -> None:
        """Set the middles of the edges as they are."""
        self.ending = self.topology.has_cut_curves()
        self.middles = {edge: self.points(edge, *self.topology.bounds(edge), np.array([0.5]))[0]
                        for edge in self.owners()}

    def result(self, middles: dict[tuple[float, ...], int]) -> tuple[str, dict[int, int], dict[int, int]]:
        """Return the text of a BREP file of the faces, a solid if they are closed, the numbers of its faces by the tags
        that they have there, and those tags of the edges that have numbers by their middles."""
        self.topology.keep(self.faces, not self.loops(set(self.numbers)))
        number = {face.record: one for face, one in zip(self.faces, self.numbers)}
        faces = {tag: number[part.record] for tag, part in enumerate(self.topology.found("Fa"), 1)}
        tag_of = {part.record: tag for tag, part in enumerate(self.topology.found("Ed"), 1)}
        self.continued = sorted({tag_of[new] for new in self.became.values() if new in tag_of})
        places, edges = np.array(list(self.middles.values())), {}
        for point, one in middles.items():
            away = np.linalg.norm(places - point, axis=1)
            record = list(self.middles)[int(away.argmin())]
            while record in self.became:
                record = self.became[record]
            if away.min() <= self.near and record in tag_of:
                edges[one] = tag_of[record]
        return self.topology.text(), faces, edges

    def remove(self, numbers: set[int]) -> None:
        """Leave out faces."""
        self.owner_of = None
        kept = [i for i, number in enumerate(self.numbers) if number not in numbers]
        self.faces, self.numbers = [self.faces[i] for i in kept], [self.numbers[i] for i in kept]

    def filled(self, openings: list[Opening]) -> list[Opening]:
        """Fill openings; return those that are left."""
        edges, tree = list(self.middles), cKDTree(np.array(list(self.middles.values())))
        left = []
        for opening in openings:
            near = {edges[k] for found in tree.query_ball_point(opening.middles, self.near) for k in found}
            free = sorted(edge for edge in near if len(self.owners().get(edge, [])) == 1)
            if free and not self.fill(free, opening.formed):
                left.append(opening)
        return left

    def edges_of(self, face: Part) -> list[int]:
        """Return the edges of a face that have a length, those of a seam twice."""
        records = self.topology.records
        return [edge.record for wire in records[face.record].parts for edge in records[wire.record].parts
                if not self.topology.degenerate(edge.record)]

    def owners(self) -> dict[int, list[int]]:
        """Return the faces by place in the list, on both sides of each edge."""
        if self.owner_of is None:
            self.owner_of = defaultdict(list)
            for i, face in enumerate(self.faces):
                for edge in self.edges_of(face):
                    self.owner_of[edge].append(i)
        return self.owner_of

    def points(self, edge: int, low: float, high: float, places: np.ndarray) -> np.ndarray:
        """Return points of the curve of an edge between two parameters, also beyond its ends (n, 3)."""
        return np.reshape(self.gmsh.model.getValue(1, self.tags[edge], low + places * (high - low)), (-1, 3))

    def end(self, edge: int, vertex: int) -> np.ndarray:
        """Return the point at an end of an edge."""
        low, high = self.topology.bounds(edge)
        return self.points(edge, low, high, np.array([float(vertex == self.topology.ends(edge)[1])]))[0]

    def loops(self, numbers: set[int]) -> list[list[int]]:
        """Return the free edges of some of the faces by the rims that they form."""
        within = {edge: [i for i in owner if self.numbers[i] in numbers] for edge, owner in self.owners().items()}
        free = [edge for edge, owner in within.items() if len(owner) == 1]
        rims: list[tuple[set[int], list[int]]] = []
        for edge in free:
            ends, edges = set(self.topology.ends(edge)), [edge]
            for rim in [rim for rim in rims if rim[0] & ends]:
                ends, edges = ends | rim[0], edges + rim[1]
                rims.remove(rim)
            rims.append((ends, edges))
        return [edges for _, edges in rims]

    def fill(self, free: list[int], formed: bool) -> bool:
        """Fill the opening that free edges bound; faces that are formed at it are left out on request. Tell whether
        that can be done; nothing is changed if not."""
        records, owners = self.topology.records, self.owners()
        open_edges, island = set(free), set[int]()
        drop: set[tuple[int, int]] = set()
        beside = {owners[edge][0] for edge in free}
        if formed and (form := self.form(owners, beside, open_edges)):
            base, wire, island = form
            drop.add((base, wire))
            open_edges |= {edge.record for edge in records[wire].parts}
        for i in beside - island:
            drop |= {(i, wire.record) for wire in records[self.faces[i].record].parts
                     if {edge.record for edge in records[wire.record].parts} <= open_edges}
        left = {edge for edge in free if owners[edge][0] not in island
                and not any(edge in {one.record for one in records[wire].parts} for i, wire in drop)}
        bare = any(len(records[self.faces[i].record].parts) == sum(one == i for one, _ in drop) for i, _ in drop)
        pairs, alone = self.pairs(owners, left)
        if bare or (left and not pairs and not alone):
            return False
        first = self.closed(owners, pairs, alone) if alone else {
            pair[0]: new for pair in pairs if (new := self.merged(*pair)) is not None}
        pairs = [] if alone else pairs
        if not first if alone else len(first) < len(pairs):
            return False
        for i, wire in drop:
            face = records[self.faces[i].record]
            face.parts = [part for part in face.parts if part.record != wire]
        if not island and not left:  # wires of free edges only
            for edge in open_edges:
                owners.pop(edge)
            return True
        self.owner_of = None
        self.became |= first | {pair[2]: first[pair[0]] for pair in pairs}
        gone = left | {pair[2] for pair in pairs}
        for i in {i for edge in {*first, *gone} for i in owners[edge]}:
            for one in records[self.faces[i].record].parts:
                records[one.record].parts = [replace(part, record=first.get(part.record, part.record))
                                             for part in records[one.record].parts if part.record not in gone]
        kept = [i for i in range(len(self.faces)) if i not in island]
        self.faces, self.numbers = [self.faces[i] for i in kept], [self.numbers[i] for i in kept]
        return True

    def form(self, owners: dict[int, list[int]], beside: set[int], free: set[int]
            ) -> tuple[int, int, set[int]] | None:
        """Return what was formed at free edges with faces beside these: the face around it, the wire of this that joins
        it to the rest, and its faces, the fewest there are; None without one."""
        found = []
        for i, face in enumerate(self.faces):
            for wire in self.topology.records[face.record].parts:
                own = {edge.record for edge in self.topology.records[wire.record].parts} & set(owners)
                faces = self.beyond(owners, i, own - free)
                if faces and beside - {i} <= faces:
                    found.append((i, wire.record, faces))
        return min(found, key=lambda one: len(one[2]), default=None)

    def beyond(self, owners: dict[int, list[int]], base: int, edges: set[int]) -> set[int]:
        """Return the faces that only edges of a face join to the rest; none if they are a part of that rest."""
        found: set[int] = set()
        waiting = [i for edge in edges for i in owners[edge]]
        while waiting:
            i = waiting.pop()
            if i != base and i not in found:
                if self.numbers[i] in self.fixed:
                    return set()
                found.add(i)
                waiting += [j for edge in self.edges_of(self.faces[i]) for j in owners[edge]]
        return found

    def pairs(self, owners: dict[int, list[int]], free: set[int]
             ) -> tuple[list[tuple[int, int, int, int]], list[tuple[int, int]]]:
        """Return the edges that free ones interrupt, in pairs that lie between the same faces: edge, its vertex at the
        opening, the same of the other; and edges without another one, with their vertices at the opening."""
        ends: defaultdict[tuple[int, ...], list[tuple[int, int]]] = defaultdict(list)
        at_opening = {vertex for edge in free for vertex in self.topology.ends(edge)}
        beside = {i for edge in free for i in owners[edge]}
        for edge in sorted({edge for i in beside for edge in self.edges_of(self.faces[i])} - free):
            for vertex in set(self.topology.ends(edge)) & at_opening:
                ends[tuple(sorted(owners[edge]))].append((edge, vertex))
        found: list[tuple[int, int, int, int]] = []
        alone: list[tuple[int, int]] = []
        for same in ends.values():
            while same:
                here = same.pop()
                fits = [pair for one in same if one[0] != here[0] for pair in ((*here, *one), (*one, *here))
                        if self.merged(*pair)]
                if not fits:
                    alone.append(here)
                    continue
                found.append(min(fits, key=lambda pair: np.linalg.norm(self.end(*pair[:2]) - self.end(*pair[2:]))))
                same = [one for one in same if one not in (found[-1][:2], found[-1][2:])]
        used = [edge for pair in found for edge in pair[::2]]
        return (found, alone) if len(used) == len(set(used)) else ([], [])

    def closed(self, owners: dict[int, list[int]], pairs: list[tuple[int, int, int, int]],
               alone: list[tuple[int, int]]) -> dict[int, int]:
        """Return new edges by the old ones where an opening interrupts a rim at the seam of a face, or takes the vertex
        of a round one: the seam goes on to the curve of the rim, whose ends meet there, or its own ends meet; none if
        that is not how the edges lie."""
        seams = [one for one in alone if len(owners[one[0]]) == 2 and len(set(owners[one[0]])) == 1]
        rims = [one for one in alone if one not in seams] + [one for pair in pairs for one in (pair[:2], pair[2:])]
        places = {(wire, own) for edge, _ in (*seams, *rims) for _, wire, own in self.places(edge)}
        if len(seams) > 1 or len(rims) != 2 or (pairs and len(alone) > 1) or self.ending or places != {(0, 0)}:
            return {}
        one, other = rims
        round_one = one[0] == other[0]
        if self.gmsh.model.getType(1, self.tags[one[0]]) not in ("Circle", "Ellipse") if round_one else not seams:
            return {}
        if not seams:
            low, _ = self.topology.bounds(one[0])
            return {one[0]: self.between(one[0], low, low + 2 * np.pi, [self.topology.ends(one[0])[0]] * 2)}
        apart = np.linalg.norm(self.end(*one) - self.end(*other))
        length = 2 * max(apart, np.linalg.norm(self.end(*one) - self.end(*seams[0])))
        reach = {edge: self.beyond_end(edge, vertex, float(length)) for edge, vertex in (*seams, one)}
        place = self.crossing(seams[0][0], one[0], reach)
        if place is None:
            return {}
        vertex = self.topology.moved(seams[0][1], self.faces[owners[seams[0][0]][0]].place, place)
        ends = {edge: list(self.topology.ends(edge)) for edge, _ in (*seams, *rims)}
        bounds = {edge: list[float](self.topology.bounds(edge)) for edge in ends}
        for edge, old in (*seams, *rims):
            last = int(ends[edge][1] == old)
            reached = 2 * max(float(apart), float(np.linalg.norm(self.end(edge, old) - place)))
            start, stop = self.beyond_end(edge, old, reached)
            bounds[edge][last] = float(self.nearest(edge, place[None], start, stop)[0][0])
            ends[edge][last] = vertex
        return {edge: self.between(edge, bounds[edge][0], bounds[edge][1], ends[edge]) for edge in ends}

    def beyond_end(self, edge: int, vertex: int, length: float) -> tuple[float, float]:
        """Return the parameters of an end of an edge, and of its curve about a length beyond."""
        low, high = self.topology.bounds(edge)
        own = np.linalg.norm(np.diff(self.points(edge, low, high, COMPARED), axis=0), axis=1).sum()
        step = length / own * (high - low)
        return (high, high + step) if vertex == self.topology.ends(edge)[1] else (low, low - step)

    def crossing(self, edge: int, other: int, reach: dict[int, tuple[float, float]]) -> np.ndarray | None:
        """Return the point at which the curves of two edges meet between parameters (3,), None without one."""
        points = self.points(other, *reach[other], np.linspace(0, 1, SOUGHT + 1))
        place = points[[int(self.nearest(edge, points, *reach[edge])[1].argmin())]]
        for _ in range(MEETING):
            for curve in (edge, other):
                found, away = self.nearest(curve, place, *reach[curve])
                place = np.reshape(self.gmsh.model.getValue(1, self.tags[curve], found), (-1, 3))
        return place[0] if away[0] <= self.near else None

    def between(self, edge: int, low: float, high: float, vertices: list[int]) -> int:
        """Return a new edge on the curve of another one, between parameters and vertices."""
        new = edge
        for sign, vertex in zip("+-", vertices):
            place = next(part.place for part in self.topology.records[edge].parts if part.forward == sign)
            new = self.topology.stretched(new, low, high, Part(vertex, sign, place))
        self.tags[new] = self.tags[edge]
        return new

    def merged(self, edge: int, vertex: int, other: int, vertex_of_other: int) -> int | None:
        """Return the edge that continues one over the opening at its vertex up to the far end of another piece of the
        same curve; None if they are on different ones."""
        topology = self.topology
        low, high = topology.bounds(edge)
        first, last = topology.ends(edge)
        forward = vertex == last
        start = high if forward else low
        far = next((part for part in topology.records[other].parts if part.record != vertex_of_other), None)
        if far is None or first == last or self.ending or self.places(edge) != self.places(other) or \
                self.gmsh.model.getType(1, self.tags[edge]) == "TrimmedCurve":
            return None
        piece = self.points(other, *topology.bounds(other), COMPARED)
        length = np.linalg.norm(np.diff(piece, axis=0), axis=1).sum()
        gap = np.linalg.norm(self.end(edge, vertex) - self.end(other, vertex_of_other))
        own = np.linalg.norm(np.diff(self.points(edge, low, high, COMPARED), axis=0), axis=1).sum()
        reach = 2.0 * (gap + length) / own * (high - low) * (1 if forward else -1)
        _, away = self.nearest(edge, piece, start, start + reach)
        if away.max() > ON_CURVE / SAME * self.near:
            return None
        end = float(self.nearest(edge, self.end(other, far.record)[None], start, start + reach)[0][0])
        far = replace(far, forward="-" if forward else "+")
        new = topology.stretched(edge, *((low, end) if forward else (end, high)), far)
        self.tags[new] = self.tags[edge]
        return new

    def places(self, edge: int) -> set[tuple[int, int, int]]:
        """Return the locations of an edge in its wires and faces."""
        records = self.topology.records
        return {(face.place, wire.place, one.place) for face in self.faces for wire in records[face.record].parts
                for one in records[wire.record].parts if one.record == edge}

    def nearest(self, edge: int, points: np.ndarray, low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
        """Return the parameters of the points of an edge's curve between two parameters that are nearest to points, and
        the distances, mm."""
        t = np.linspace(low, high, SOUGHT + 1)
        tree = cKDTree(np.reshape(self.gmsh.model.getValue(1, self.tags[edge], t), (-1, 3)))
        found = t[tree.query(points)[1]]
        for _ in range(6):
            away = np.reshape(self.gmsh.model.getValue(1, self.tags[edge], found), (-1, 3)) - points
            along = np.reshape(self.gmsh.model.getDerivative(1, self.tags[edge], found), (-1, 3))
            found = found - (away * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-300)
        away = np.reshape(self.gmsh.model.getValue(1, self.tags[edge], found), (-1, 3)) - points
        return found, np.linalg.norm(away, axis=1)
