# SPDX-License-Identifier: GPL-3.0-or-later
"""Profile of a sheet that is bent along parallel lines: its section across them.

Such a part without its holes, notches, reliefs beside bends and the different widths of its legs is its profile,
extruded along the lines over the length of the part.
"""
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from dd3.part.bends import ALONG, FLAT, Bend
from dd3.part.shape import Shape, unit
from dd3.part.sheet import Sheet

# Distance over the thickness up to which points are one, or are on a piece of the profile.
NEAR = 0.02


@dataclass
class Piece:
    """A line or an arc of a profile: the faces of the part that lie on it; radius, mm, 0 of a line; a point of the line
    or the centre of the arc (2,); unit vectors along the line and across, of an arc those from which its angles are
    counted (2,); where it begins and ends, mm or radian."""

    faces: list[int]
    radius: float
    origin: np.ndarray
    along: np.ndarray
    across: np.ndarray
    ends: tuple[float, float] = (0.0, 0.0)

    def parameter(self, points: np.ndarray) -> np.ndarray:
        """Return the parameters of points (..., 2)."""
        first, second = (points - self.origin) @ self.along, (points - self.origin) @ self.across
        return np.asarray(np.arctan2(second, first) if self.radius else first)

    def point(self, parameter: float) -> np.ndarray:
        """Return the point at a parameter."""
        if not self.radius:
            return self.origin + parameter * self.along
        return self.origin + self.radius * (np.cos(parameter) * self.along + np.sin(parameter) * self.across)

    def distance(self, points: np.ndarray) -> float:
        """Return the largest distance of points (n, 2), mm."""
        away = (np.linalg.norm(points - self.origin, axis=1) - self.radius if self.radius
                else (points - self.origin) @ self.across)
        return float(np.abs(away).max())

    def centroid(self, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        """Return the centroid of what is between two of its points."""
        low, high = self.parameter(np.array([first, last]))
        if not self.radius:
            return (first + last) / 2
        return self.origin + (self.point((low + high) / 2) - self.origin) * np.sinc((high - low) / 2 / np.pi)


@dataclass
class Chain:
    """The profile of one side: its pieces in order, and the points between which they are (n + 1, 2)."""

    pieces: list[Piece]
    points: np.ndarray


@dataclass
class Profile:
    """Profiles of both sides of a sheet; unit vectors across the lines of its bends, and the one along (3, 3); where
    the part begins and ends along them, mm."""

    chains: list[Chain]
    axes: np.ndarray
    low: float
    high: float

    def continued(self, beyond: float, faces: set[int]) -> "Profile":
        """Return the profile longer by a length, mm: along the lines at both ends, and across them at ends that are
        lines with one of the faces given."""
        ends = [self.chains[0].points[[0, -1]], self.chains[1].points[[0, -1]]]
        turned = np.linalg.norm(ends[0] - ends[1]) > np.linalg.norm(ends[0] - ends[1][::-1])
        points = [chain.points.copy() for chain in self.chains]
        for end in (0, -1):
            both = [(0, end), (1, -1 - end if turned else end)]
            pieces = [self.chains[side].pieces[at] for side, at in both]
            if any(piece.radius for piece in pieces) or not faces & {tag for piece in pieces for tag in piece.faces}:
                continue
            for side, at in both:
                inner = points[side][1 if at == 0 else -2]
                points[side][at] += beyond * unit(points[side][at] - inner)
        chains = [Chain(chain.pieces, own) for chain, own in zip(self.chains, points)]
        return Profile(chains, self.axes, self.low - beyond, self.high + beyond)

    def place(self, point: np.ndarray, along: float) -> np.ndarray:
        """Return a point of the profile in the coordinates of the part (3,)."""
        return np.asarray(np.array([*point, along]) @ self.axes)


def profile_of(shape: Shape, sheet: Sheet, bends: list[Bend]) -> Profile | None:
    """Return the profile of a sheet, None if it is not bent along parallel lines only, one after the other."""
    if sheet.kind != "sheet" or not bends or any(abs(one.axis @ bends[0].axis) < ALONG for one in bends):
        return None
    own = shape.of(sheet.sides[0])
    vectors = np.linalg.eigh((shape.area[own, None] * shape.normal[own]).T @ shape.normal[own])[1].T
    axes = np.array([vectors[1], np.cross(vectors[0], vectors[1]), vectors[0]])
    near = NEAR * (sheet.thickness or 0.0)
    chains = [chain for side in sheet.sides if (chain := chain_of(shape, side, axes, near))]
    along = shape.nodes[shape.triangles[shape.of([*sheet.sides[0], *sheet.sides[1]])]] @ axes[2]
    return Profile(chains, axes, float(along.min()), float(along.max())) if len(chains) == 2 else None


def chain_of(shape: Shape, faces: list[int], axes: np.ndarray, near: float) -> Chain | None:
    """Return the profile of a side, None if its faces are not one after the other."""
    pieces = [piece_of(shape, tag, axes) for tag in faces]
    if any(piece.distance(flat_nodes(shape, piece.faces[0], axes)) > near for piece in pieces):
        return None
    pieces = united(pieces, near)
    owner = {tag: i for i, piece in enumerate(pieces) for tag in piece.faces}
    joints: dict[tuple[int, int], np.ndarray] = {}
    for number, edge in shape.edges_inside(faces).items():
        pair = tuple(sorted(owner[tag] for tag in edge.faces))
        if pair[0] == pair[1]:
            continue
        points = shape.nodes[shape.pieces[shape.piece_edge == number]].reshape(-1, 3) @ axes[:2].T
        place = joints.setdefault((pair[0], pair[1]), points.mean(axis=0))
        if np.linalg.norm(points - place, axis=1).max() > near:
            return None
    order = in_order(len(pieces), list(joints))
    if not order:
        return None
    between = [joints[min(pair), max(pair)] for pair in pairwise(order)]
    chosen = [pieces[i] for i in order]
    points = np.array([far_end(chosen[0], between[0]), *between, far_end(chosen[-1], between[-1])])
    # Each piece is between its points: no leg begins in the middle of another one.
    spans = [np.sort(piece.parameter(pair)) for piece, pair in zip(chosen, np.stack([points[:-1], points[1:]], axis=1))]
    off = [np.abs(span - piece.ends).max() * (piece.radius or 1.0) for span, piece in zip(spans, chosen)]
    return Chain(chosen, points) if max(off) <= near else None


def flat_nodes(shape: Shape, tag: int, axes: np.ndarray) -> np.ndarray:
    """Return the nodes of a face in the plane across the lines (n, 2)."""
    return np.asarray(shape.nodes[np.unique(shape.triangles[shape.cells[tag]])] @ axes[:2].T)


def piece_of(shape: Shape, tag: int, axes: np.ndarray) -> Piece:
    """Return the piece on which a face lies."""
    own = shape.cells[tag]
    points = flat_nodes(shape, tag, axes)
    curvature = shape.curvature[own]
    largest = curvature[np.arange(len(own)), np.abs(curvature).argmax(axis=1)]
    if np.abs(largest).max() * shape.size <= FLAT:
        across = unit(shape.normal[own].mean(axis=0) @ axes[:2].T)
        piece = Piece([tag], 0.0, points.mean(axis=0), np.array([-across[1], across[0]]), across)
    else:
        radius = float(1 / np.median(largest))
        centre = (shape.place[own] + radius * shape.normal[own]).mean(axis=0) @ axes[:2].T
        along = unit((points - centre).mean(axis=0))
        piece = Piece([tag], abs(radius), centre, along, np.array([-along[1], along[0]]))
    places = piece.parameter(points)
    piece.ends = float(places.min()), float(places.max())
    return piece


def united(pieces: list[Piece], near: float) -> list[Piece]:
    """Return pieces of which those on one curve that overlap are one."""
    found: list[Piece] = []
    for piece in pieces:
        while same := next((one for one in found if overlap(one, piece, near)), None):
            found.remove(same)
            ends = same.parameter(np.array([piece.point(end) for end in piece.ends]))
            same.ends = min(same.ends[0], float(ends.min())), max(same.ends[1], float(ends.max()))
            same.faces = [*same.faces, *piece.faces]
            piece = same
        found.append(piece)
    return found


def overlap(one: Piece, other: Piece, near: float) -> bool:
    """Tell whether pieces are on one curve, and meet there."""
    points = np.array([other.point(end) for end in (*other.ends, sum(other.ends) / 2)])
    if bool(one.radius) != bool(other.radius) or one.distance(points) > near:
        return False
    places, gap = one.parameter(points), near / (one.radius or 1.0)
    return bool(places.min() <= one.ends[1] + gap and places.max() >= one.ends[0] - gap)


def in_order(count: int, pairs: list[tuple[int, int]]) -> list[int]:
    """Return items in the order in which pairs join them, from one end to the other; none if they make no line."""
    beside: list[set[int]] = [set() for _ in range(count)]
    for a, b in pairs:
        beside[a].add(b)
        beside[b].add(a)
    order = [i for i in range(count) if len(beside[i]) == 1][:1]
    while order and (following := beside[order[-1]] - set(order)):
        order.append(following.pop())
    return order if len(order) == count == len(pairs) + 1 else []


def far_end(piece: Piece, joint: np.ndarray) -> np.ndarray:
    """Return the end of a piece that is away from a joint."""
    return max((piece.point(end) for end in piece.ends), key=lambda point: float(np.linalg.norm(point - joint)))


def extrude(gmsh: Any, profile: Profile) -> None:
    """Make the solid of a profile in the session, in place of what is there."""
    gmsh.clear()
    first, second = (drawn(gmsh, profile, chain) for chain in profile.chains)
    ends = [chain.points[[0, -1]] for chain in profile.chains]
    if np.linalg.norm(ends[0] - ends[1]) < np.linalg.norm(ends[0] - ends[1][::-1]):
        second = second[0][::-1], second[1][::-1]
    occ = gmsh.model.occ
    loop = [*first[0], occ.addLine(first[1][-1], second[1][0]), *second[0], occ.addLine(second[1][-1], first[1][0])]
    face = occ.addPlaneSurface([occ.addCurveLoop(loop)])
    occ.extrude([(2, face)], *((profile.high - profile.low) * profile.axes[2]))
    occ.synchronize()


def drawn(gmsh: Any, profile: Profile, chain: Chain) -> tuple[list[int], list[int]]:
    """Make the curves of a side's profile at the low end of the part; return them and the points between them."""
    occ = gmsh.model.occ
    points = [occ.addPoint(*profile.place(point, profile.low)) for point in chain.points]
    curves = []
    for k, piece in enumerate(chain.pieces):
        if piece.radius:
            at = piece.point(float(piece.parameter(chain.points[k:k + 2]).mean()))
            middle = occ.addPoint(*profile.place(at, profile.low))
            curves.append(occ.addCircleArc(points[k], middle, points[k + 1], center=False))
            occ.remove([(0, middle)])
        else:
            curves.append(occ.addLine(points[k], points[k + 1]))
    return curves, points


def faces_of(gmsh: Any, profile: Profile) -> dict[int, int]:
    """Return, for each face of the sides of an extruded profile in the session, the number of one of the part's faces
    that lie on it."""
    middle = (profile.low + profile.high) / 2
    tags = [tag for _, tag in gmsh.model.getEntities(2)]
    centres = np.array([gmsh.model.occ.getCenterOfMass(2, tag) for tag in tags])
    found = {}
    for chain in profile.chains:
        for piece, start, end in zip(chain.pieces, chain.points, chain.points[1:]):
            away = np.linalg.norm(centres - profile.place(piece.centroid(start, end), middle), axis=1)
            found[tags[int(away.argmin())]] = piece.faces[0]
    return found


def edges_of(gmsh: Any, profile: Profile, shape: Shape) -> dict[int, int]:
    """Return the edges of an extruded profile in the session by the numbers in the part of those between its faces."""
    tags = [tag for _, tag in gmsh.model.getEntities(1)]
    centres = np.array([gmsh.model.occ.getCenterOfMass(1, tag) for tag in tags])
    found: dict[int, int] = {}
    for chain in profile.chains:
        for k, joint in enumerate(chain.points[1:-1]):
            place = profile.place(joint, (profile.low + profile.high) / 2)
            tag = tags[int(np.linalg.norm(centres - place, axis=1).argmin())]
            sides = set(chain.pieces[k].faces), set(chain.pieces[k + 1].faces)
            found |= {number: tag for number, edge in shape.edges.items()
                      if all(side & set(edge.faces) for side in sides)}
    return found
