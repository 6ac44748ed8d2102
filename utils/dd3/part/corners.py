# SPDX-License-Identifier: GPL-3.0-or-later
"""Open corners of a folded part: the blank is cut there, with or without a relief in the floor and the bends, before
its walls are bent up from the floor.

In the tools walls and bends go on round the corner. The bends and the faces through the thickness at the corner are
taken out of the solid, so that floor and walls meet in sharp edges, and these are rounded in one step: that between two
walls by the largest radius that leaves both as they are, those at the floor by the radii of the bends. The rim of the
part lies on the closed corner as it is.
"""
from dataclasses import dataclass
from typing import Any

import numpy as np

from dd3.part.bends import FLAT
from dd3.part.loops import MOUTH, Loop, edges_of_rim, find_loops, turns
from dd3.part.reading import Reading
from dd3.part.shape import Shape, angle_between, unit
from dd3.tools import fillets, mitres
from dd3.tools.limits import limited

# Processor time after which OpenCASCADE is given up, s.
TIME = 60.0


@dataclass
class Corner:
    """A corner of one side between two walls: floor, walls and the faces of the bends between them; faces through the
    thickness there; points of the ends of the walls (n, 3); angle by which the walls turn, degrees; where it is."""

    floor: int
    walls: tuple[int, int]
    bends: set[int]
    through: set[int]
    ends: np.ndarray
    turn: float
    centre: np.ndarray

    @property
    def said(self) -> str:
        """Return the place of the corner in words."""
        return " ".join(f"{value:.4g}" for value in np.round(self.centre, 3) + 0.0)


@dataclass
class Wall:
    """A flat face to which a rim leads over bends: the faces of these, the edges on all of them up to the first corner
    of the rim that turns outwards, and points of the wall's end (n, 3)."""

    face: int
    bends: set[int]
    edges: set[int]
    ends: np.ndarray


@dataclass
class Rim:
    """The rim of a side: its nodes; of each piece from there on the edge and the face of the side; the turn at the
    node, degrees, positive outwards."""

    nodes: np.ndarray
    edge: np.ndarray
    face: np.ndarray
    turn: np.ndarray

    def stretches(self) -> list[np.ndarray]:
        """Return the places of the pieces that lie one after the other on one face."""
        first = np.flatnonzero(self.face != np.roll(self.face, 1))
        order = np.roll(np.arange(len(self.face)), -first[0]) if len(first) else np.arange(len(self.face))
        return np.split(order, np.flatnonzero(np.diff(self.face[order])) + 1)


def find_corners(shape: Shape, faces: list[int]) -> list[Corner]:
    """Return the open corners of a side: where its outer rim turns inwards on a flat face, between two flat walls on
    one side of it, from which bends or sharp edges lead to these."""
    loops = find_loops(shape, faces)
    rim = rim_of(shape, faces, loops[0]) if loops else None
    if rim is None:
        return []
    found, stretches = [], rim.stretches()
    for floor, before, after, own in between_walls(shape, rim, stretches):
        one, other = wall_beside(shape, rim, stretches, before, -1), wall_beside(shape, rim, stretches, after, 1)
        if one is None or other is None or not is_corner(shape, floor, one.face, other.face):
            continue
        edges = set(rim.edge[own].tolist()) | one.edges | other.edges
        found.append(Corner(floor, (one.face, other.face), one.bends | other.bends,
                            {tag for edge in edges for tag in shape.edges[edge].faces} - set(faces),
                            np.concatenate([one.ends, other.ends]),
                            float(angle_between(normal_of(shape, one.face), normal_of(shape, other.face))),
                            shape.nodes[rim.nodes[own if len(own) else stretches[before][:1]]].mean(axis=0)))
    return found


def between_walls(shape: Shape, rim: Rim, stretches: list[np.ndarray]) -> list[tuple[int, int, int, np.ndarray]]:
    """Return where a rim turns inwards beside a flat face: that face, the stretches from which the walls are found
    before and after, and the places of the pieces on the face, none where the rim meets it at a point between two
    bends."""
    found = []
    count, total = len(stretches), len(rim.turn)
    for k, own in enumerate(stretches):
        face = int(rim.face[own[0]])
        following = (own[-1] + 1) % total
        # The turns at both ends are those from a bend, or a wall, to the face.
        if is_flat(shape, face):
            if rim.turn[own].sum() + rim.turn[following] < -MOUTH:
                found.append((face, k, k, own))
        elif rim.turn[following] < -MOUTH:
            common = shape.neighbours[face] & shape.neighbours[int(rim.face[following])]
            found += [(tag, (k + 1) % count, k, own[:0]) for tag in common if is_flat(shape, tag)]
    return found


def rim_of(shape: Shape, faces: list[int], loop: Loop) -> Rim | None:
    """Return the rim of a loop of a side, None if it does not lie on edges."""
    edge = edges_of_rim(shape, loop)
    if (edge < 0).any():
        return None
    own = set(faces)
    face = {number: next(iter(own & set(shape.edges[number].faces))) for number in set(edge.tolist())}
    return Rim(loop.nodes, edge, np.array([face[number] for number in edge.tolist()]), turns(shape, faces, loop))


def wall_beside(shape: Shape, rim: Rim, stretches: list[np.ndarray], k: int, step: int) -> Wall | None:
    """Return the wall to which a rim leads from a stretch, forwards or backwards, None without one."""
    bends, edges = set[int](), set[int]()
    for i in range(1, len(stretches)):
        own = stretches[(k + step * i) % len(stretches)][::step]
        face = int(rim.face[own[0]])
        # At the far node of each piece: a corner ends the wall.
        far = (own + max(step, 0)) % len(rim.turn)
        if not is_flat(shape, face):
            bends.add(face)
            edges |= set(rim.edge[own].tolist())
            continue
        # A relief beside the bend turns it inwards first.
        corner = np.flatnonzero(np.cumsum(rim.turn[far]) > MOUTH)
        count = corner[0] + 1 if len(corner) else len(own)
        near = (own[:1] + max(-step, 0)) % len(rim.turn)
        nodes = rim.nodes[np.concatenate([near, far[:count]])]
        return Wall(face, bends, edges | set(rim.edge[own[:count]].tolist()), shape.nodes[nodes])
    return None


def is_flat(shape: Shape, face: int) -> bool:
    """Tell whether a face is flat."""
    return bool(np.abs(shape.curvature[shape.cells[face]]).max() * shape.size <= FLAT)


def normal_of(shape: Shape, face: int) -> np.ndarray:
    """Return the unit normal of a flat face."""
    return np.asarray(shape.normal[shape.cells[face][0]])


def is_corner(shape: Shape, floor: int, first: int, second: int) -> bool:
    """Tell whether two flat faces rise from a third one on the same side, in different directions."""
    normals = [normal_of(shape, face) for face in (floor, first, second)]
    height = [(shape.centres[face] - shape.centres[floor]) @ normals[0] for face in (first, second)]
    return (len({floor, first, second}) == 3 and height[0] * height[1] > 0
            and all(MOUTH < angle_between(normals[a], normals[b]) < 180 - MOUTH for a, b in ((0, 1), (0, 2), (1, 2))))


def pairs_of(reading: Reading) -> list[tuple[Corner, Corner]]:
    """Return the open corners of a solid sheet, each on both sides."""
    if not reading.solid or not all(reading.sheet.sides):
        return []
    first, second = (find_corners(reading.shape, side) for side in reading.sheet.sides)
    return [(one, other) for one in first for other in second if one.through & other.through]


def closed_solid(gmsh: Any, numbers: dict[int, int], pairs: list[tuple[Corner, Corner]], thickness: float
                 ) -> tuple[dict[int, int], list[float]]:
    """Close corners of the solid in the session, whose faces have numbers in the part by their tags; return the same of
    the new solid, the only one that is left, and the radii between walls, mm. Raise an error if OpenCASCADE
    does not make it."""
    corners = [corner for pair in pairs for corner in pair]
    bends = {tag for tag, number in numbers.items() if any(number in one.bends for one in corners)}
    through = {tag for tag, number in numbers.items() if any(number in one.through for one in corners)}
    flat = {number: tag for tag, number in numbers.items() if any(number in (one.floor, *one.walls) for one in corners)}
    radius = {tag: mitres.radius_of(gmsh, tag) for tag in bends}
    beside = {tag: {numbers.get(one, 0) for edge in mitres.edges_of(gmsh, [tag]) for one in mitres.faces_of(gmsh, edge)}
              for tag in bends}
    near = fillets.tolerance_of(gmsh)
    with limited(TIME, "the corners are not closed"):
        sharp = mitres.taken_out(gmsh, fillets.volume_of(gmsh, sorted(bends | through)), bends | through)
        grown = {new: number for number, tag in flat.items()
                 if (new := fillets.face_of(gmsh, tag, sharp, near)) is not None}
        between = {edge: {grown[tag] for tag in mitres.faces_of(gmsh, edge)}
                   for edge in mitres.edges_of(gmsh, list(grown)) if set(mitres.faces_of(gmsh, edge)) <= set(grown)}
        rounded = {edge: max(radius[tag] for tag in bends if pair <= beside[tag]) for edge, pair in between.items()
                   if any(pair <= beside[tag] for tag in bends)}
        upright: dict[int, float] = {}
        for pair in pairs:
            upright |= radii_of(gmsh, pair, between, thickness, min(rounded.values(), default=0.0))
        rounded |= upright
        volume = gmsh.model.occ.fillet([fillets.volume_of(gmsh, sharp)], list(rounded), list(rounded.values()),
                                       removeVolume=False)[0][1]
        gmsh.model.occ.synchronize()
    found = numbered(gmsh, fillets.faces_of_volume(gmsh, volume), {**numbers, **grown}, bends, corners)
    gmsh.model.occ.remove([(3, tag) for _, tag in gmsh.model.getEntities(3) if tag != volume], recursive=True)
    gmsh.model.occ.synchronize()
    return found, list(upright.values())


def radii_of(gmsh: Any, pair: tuple[Corner, Corner], between: dict[int, set[int]], thickness: float, least: float
             ) -> dict[int, float]:
    """Return the radii of the edges at which the walls of a corner meet on both sides, mm: the largest with which both
    walls stay as they are, the least one at least, and the thickness more outside."""
    found = {}
    for corner in pair:
        edge = next(one for one, faces in between.items() if faces == set(corner.walls))
        points = np.reshape(gmsh.model.getValue(1, edge, [p for b in gmsh.model.getParametrizationBounds(1, edge)
                                                          for p in b]), (2, 3))
        away = corner.ends - points[0]
        along = unit(points[1] - points[0])
        length = np.linalg.norm(away - (away @ along)[:, None] * along, axis=1).min()
        found[edge] = float(length / np.tan(np.radians(corner.turn) / 2))
    inside, outside = sorted(found, key=lambda edge: found[edge])
    own = max(min(found[inside], found[outside] - thickness), least)
    return {inside: own, outside: own + thickness}


def numbered(gmsh: Any, tags: list[int], numbers: dict[int, int], bends: set[int], corners: list[Corner]
             ) -> dict[int, int]:
    """Return the numbers in the part of the faces of a solid: those of the faces that they lie on; of what was made at
    a corner that of a bend or else a wall beside it."""
    near = fillets.tolerance_of(gmsh)
    found = {}
    for tag in tags:
        old = tag if tag in numbers else fillets.face_of(gmsh, tag, list(numbers), near)
        if old is not None:
            found[tag] = numbers[old]
    bent = {numbers[tag] for tag in bends}
    walls = {wall for corner in corners for wall in corner.walls}
    made = [tag for tag in tags if tag not in found]
    for tag in made:
        around = {found.get(one, 0) for edge in mitres.edges_of(gmsh, [tag]) for one in mitres.faces_of(gmsh, edge)}
        found[tag] = min(around & bent or around & walls)
    return found
