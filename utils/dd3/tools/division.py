# SPDX-License-Identifier: GPL-3.0-or-later
"""Division of CAD faces into quadrilaterals: how often each edge is divided, and which faces have a regular mesh."""
from collections import Counter, defaultdict
from typing import Any

import numpy as np

from dd3.tools.parameters import length_of

# Turn of the normal or of the tangent over an edge's division before it is halved, degrees.
TURN = 45.0
# Further factor on the divisions of a face that is divided for at least the third time, as its distance falls slowly:
# surfaces whose curvature is not smooth.
SLOW = 1.3
# Corner angles of a face with a regular mesh, degrees.
CORNERS = 25.0, 155.0
# Fraction of its last value that the distance of a divided face must fall below; divisions without that before it is
# given up: rounded up, the division of one edge of a face may stay the same.
STAGNANT, MOST_STAGNANT = 0.8, 2
# Edges of a face with a regular mesh at most.
MOST_EDGES = 8
# Difference between the places where opposite sides are divided, over their lengths, at most.
UNLIKE = 0.2
# Rounds with folded patches after which a face has no regular mesh.
MOST_BENT = 4
# Points at which an edge is examined.
SAMPLES = 17
OPTIONS = {"Mesh.RecombineAll": 1, "Mesh.RecombinationAlgorithm": 1, "Mesh.SubdivisionAlgorithm": 1,
           "Mesh.MeshSizeFromCurvature": 360 / TURN, "Mesh.MeshSizeExtendFromBoundary": 1, "Mesh.Algorithm": 6,
           "Mesh.ElementOrder": 1, "Mesh.HighOrderOptimize": 0, "Mesh.MeshSizeFromPoints": 0}


def turning(vectors: np.ndarray) -> float:
    """Return the sum of the angles between consecutive vectors, degrees."""
    a, b = vectors[:-1], vectors[1:]
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1)).sum())


class Division:
    """Numbers of divisions of the edges; for each face factors on them, along its first and its second edge, which
    `refine` raises. They are equal for a face without a regular mesh."""

    def __init__(self, gmsh: Any, tags: list[int], longest: float = np.inf) -> None:
        self.tags = tags
        self.longest = longest  # patches along edges of one face only, mm
        self.factor = {tag: np.ones(2) for tag in tags}
        self.last: dict[Any, float] = {}  # the distance of a face when it was divided further
        self.divided: defaultdict[Any, int] = defaultdict(int)
        self.stagnant: defaultdict[Any, int] = defaultdict(int)
        self.distance = np.zeros((len(tags), 2))  # the distances of the faces along their first and second edges, mm
        self.gap = np.zeros(len(tags))  # the largest distances of nodes from the faces, mm
        # Patches of the faces as they were measured last, and their distances.
        self.measured: dict[int, tuple[np.ndarray, np.ndarray]] = {}
        self.bent: defaultdict[Any, int] = defaultdict(int)
        self.loops = {tag: self.loop(gmsh, tag) for tag in tags}
        self.turn = {}
        for tag, loop in self.loops.items():
            for edge in set(map(abs, loop)):
                self.turn[edge, tag] = self.edge_turn(gmsh, edge, tag)
        low, high = np.reshape(gmsh.model.getBoundingBox(-1, -1), (2, 3))
        self.size = float(np.linalg.norm(high - low))
        self.length = {edge: length_of(gmsh, edge) for edge, _ in self.turn}
        self.sides: dict[int, list[list[int]]] = {}
        self.corners: dict[int, list[int]] = {}
        for tag, loop in self.loops.items():
            flat = gmsh.model.getType(2, tag) == "Plane" and len(loop) > 4
            self.sides[tag], self.corners[tag] = ([], []) if flat else self.sides_of(gmsh, loop)
        self.regular = {tag for tag, sides in self.sides.items() if sides}
        self.curved = {tag: gmsh.model.getType(2, tag) != "Plane" for tag in tags}

    @staticmethod
    def loop(gmsh: Any, tag: int) -> list[int]:
        """Return the edges of a face, signed."""
        return [edge for _, edge in gmsh.model.getBoundary([(2, tag)], combined=False, oriented=True)]

    @staticmethod
    def edge_turn(gmsh: Any, edge: int, tag: int) -> float:
        """Return the turn of the tangent or of the face's normal along an edge, the larger one, degrees."""
        if gmsh.model.getType(1, edge) == "Line" and gmsh.model.getType(2, tag) == "Plane":
            return 0.0
        low, high = gmsh.model.getParametrizationBounds(1, edge)
        t = np.linspace(low[0], high[0], SAMPLES)
        tangent = np.reshape(gmsh.model.getDerivative(1, edge, t), (-1, 3))
        try:
            uv = gmsh.model.reparametrizeOnSurface(1, edge, t, tag)
            normal = np.reshape(gmsh.model.getNormal(tag, uv), (-1, 3))
        except Exception:  # an edge whose curve on the surface is missing
            normal = np.zeros((1, 3))
        return max(turning(tangent), turning(normal))

    def sides_of(self, gmsh: Any, loop: list[int]) -> tuple[list[list[int]], list[int]]:
        """Return the four sides of a face with a regular mesh, each of one edge or of several that go on smoothly, and
        its corners: they meet at clear angles, and opposite sides have the same number of edges. A face of three edges
        that end at a pole, an edge without length, has this as a side and three corners, the first one at the pole.
        Other faces have no sides and corners."""
        lengths = [self.length[abs(edge)] > 1e-9 * self.size for edge in loop]
        if len(set(map(abs, loop))) != len(loop) or not 4 <= len(loop) <= MOST_EDGES or sum(lengths) < 3 or \
                not (all(lengths) or len(loop) == 4):
            return [], []
        first = 0 if all(lengths) else lengths.index(False) + 1
        edges = [edge for edge in loop[first:] + loop[:first] if lengths[loop.index(edge)]]
        ends = [self.ends_of(gmsh, edge) for edge in edges]
        size = max(np.linalg.norm(point[1] - point[0]) for point, _ in ends)
        clear = []  # at the start of each edge
        for (point, along), (point_next, along_next) in zip(ends[-1:] + ends[:-1], ends):
            a, b = -along[1], along_next[0]
            scale = np.linalg.norm(a) * np.linalg.norm(b)
            if np.linalg.norm(point[1] - point_next[0]) > 1e-4 * size or scale == 0.0:
                return [], []
            angle = np.degrees(np.arccos(np.clip(a @ b / scale, -1, 1)))
            if angle <= CORNERS[0] or (angle >= CORNERS[1] and len(loop) == 4):
                return [], []
            clear.append(angle < CORNERS[1])
        starts = [gmsh.model.getBoundary([(1, edge)], combined=False)[0][1] for edge in edges]
        if len(loop) == 4:
            return [[abs(edge)] for edge in loop], starts
        if sum(clear) != 4:
            return [], []
        turn = clear.index(True)
        sides: list[list[int]] = []
        for edge, corner in zip(edges[turn:] + edges[:turn], clear[turn:] + clear[:turn]):
            sides = [*sides, []] if corner else sides
            sides[-1].append(abs(edge))
        for one, other in zip(sides[:2], sides[2:]):
            parts = [np.cumsum([self.length[edge] for edge in side]) for side in (one, other[::-1])]
            if len(one) != len(other) or np.abs(np.subtract(*(part / part[-1] for part in parts))).max() > UNLIKE:
                return [], []
        return sides, [start for start, corner in zip(starts, clear) if corner]

    @staticmethod
    def ends_of(gmsh: Any, edge: int) -> tuple[np.ndarray, np.ndarray]:
        """Return the points and tangents at the start and the end of a signed edge."""
        low, high = gmsh.model.getParametrizationBounds(1, abs(edge))
        place = np.array([low[0], high[0]])
        tangent = np.reshape(gmsh.model.getDerivative(1, abs(edge), place), (2, 3))
        point = np.reshape(gmsh.model.getValue(1, abs(edge), place), (2, 3))
        return (point, tangent) if edge > 0 else (point[::-1], -tangent[::-1])

    def counts(self) -> dict[int, int]:
        """Return the divisions of each edge; opposite edges of regular faces have the same."""
        need: defaultdict[Any, int] = defaultdict(lambda: 1)
        faces = Counter(edge for edge, _ in self.turn)
        for (edge, tag), turn in self.turn.items():
            if self.length[edge] <= 1e-9 * self.size:
                continue
            count = max(1.0, turn / TURN - 1e-6)
            if faces[edge] == 1:  # a division has two patches
                count = max(count, self.length[edge] / self.longest / 2)
            if self.curved[tag] and tag not in self.regular:
                # Divisions of a trimmed face are at most four times as long as the curvature allows.
                widest = max((self.turn[other, tag] / self.length[other] for other in set(map(abs, self.loops[tag]))
                              if self.length[other] > 1e-3 * self.size), default=0.0)
                count = max(count, widest * self.length[edge] / TURN / 4)
            factor = self.factor[tag][self.direction(edge, tag)] if tag in self.regular else self.factor[tag].max()
            if not self.curved[tag] and factor > 1.0:
                count = max(count, self.length[edge] / self.size * 4)
            need[edge] = max(need[edge], int(np.ceil(count * factor)))
        return self.equal(need)

    def equal(self, need: dict[int, int]) -> dict[int, int]:
        """Return the divisions of each edge that are needed, with the same ones on opposite edges of regular faces."""
        group = {edge: edge for edge, _ in self.turn}

        def leader(edge: int) -> int:
            while group[edge] != edge:
                edge = group[edge]
            return edge

        for tag in self.regular:
            # At a pole the edge without length and the one opposite are not alike.
            for one, other in zip(self.sides[tag][:2], self.sides[tag][2:]):
                for a, b in zip(one, reversed(other)):
                    group[leader(a)] = leader(b)
        largest: defaultdict[Any, int] = defaultdict(int)
        for edge in group:
            largest[leader(edge)] = max(largest[leader(edge)], need.get(edge, 1))
        return {edge: largest[leader(edge)] for edge in group}

    def direction(self, edge: int, tag: int) -> int:
        """Return 0 for the first and third side of a face with a regular mesh, 1 for the second and fourth."""
        return next(number for number, side in enumerate(self.sides[tag]) if edge in side) % 2

    def mesh(self, gmsh: Any) -> list[Any]:
        """Make the mesh of second order; return the faces where that failed, divided further for another try."""
        gmsh.model.mesh.clear()
        gmsh.model.mesh.removeConstraints()
        for name, value in OPTIONS.items():
            gmsh.option.setNumber(name, value)
        gmsh.option.setNumber("Mesh.MeshSizeMax", self.size / 3)
        gmsh.option.setNumber("Mesh.MeshSizeMin", self.size * 1e-5)
        self.constrain(gmsh, self.counts())
        gmsh.model.mesh.setSizeCallback(lambda dim, tag, x, y, z, size: size / self.factor[tag].max()
                                        if dim == 2 and tag in self.factor else size)
        try:
            gmsh.model.mesh.generate(2)
        except Exception:  # Gmsh raises nothing more specific
            failed = [tag for dim, tag in gmsh.model.mesh.getLastEntityError() if dim == 2] or self.tags
            for tag in failed:
                self.factor[tag] *= 1.6
                self.regular.discard(tag)
            return failed
        gmsh.model.mesh.setOrder(2)
        return []

    def constrain(self, gmsh: Any, counts: dict[int, int]) -> None:
        """Give the edges their divisions, and the regular faces a regular mesh."""
        for edge, count in counts.items():
            if self.length[edge] > 1e-9 * self.size:
                gmsh.model.mesh.setTransfiniteCurve(edge, count + 1)
        for tag in self.regular:
            corners = self.corners[tag]
            whole = all(len(side) == 1 for side in self.sides[tag]) and len(corners) == 4
            gmsh.model.mesh.setTransfiniteSurface(tag, cornerTags=[] if whole else corners)

    def refine(self, distance: np.ndarray, kink: np.ndarray, folded: set[int]) -> bool:
        """Raise the factors of faces whose relative distance or kink (face, direction) exceeds 1, or that have folded
        patches; return whether any changed."""
        changed = False
        for index, tag in enumerate(self.tags):
            wanted = np.ones(2)
            largest = distance[index].max()
            if largest >= STAGNANT * self.last.get(tag, np.inf):
                self.stagnant[tag] += 1
            # A distance that does not fall is a gap of the CAD between edge and face.
            if largest > 1.0 and self.stagnant[tag] < MOST_STAGNANT:
                self.last[tag] = largest
                self.divided[tag] += 1
                margin = 1.1 if self.divided[tag] < 3 else 1.1 * SLOW
                wanted = raised(margin * distance[index]**0.3, distance[index], 1.25, 2.5)
            elif kink[index].max() > 1.0:
                wanted = raised(1.1 * kink[index]**0.5, kink[index], 1.2, 2.0)
            if index in folded:
                self.bent[tag] += 1
                if self.bent[tag] == MOST_BENT:
                    self.regular.discard(tag)
                bent = distance[index] >= largest / 2 if largest > 1.0 else True
                wanted = np.where(bent, np.maximum(wanted, 1.6), wanted)
            if wanted.max() > 1.0 and self.factor[tag].max() < 60.0:
                self.factor[tag] *= wanted
                changed = True
        return changed


def raised(factor: np.ndarray, value: np.ndarray, lowest: float, highest: float) -> np.ndarray:
    """Return the factors within bounds where the value exceeds 1, and 1 elsewhere."""
    return np.where(value > 1.0, np.clip(factor, lowest, highest), 1.0)
