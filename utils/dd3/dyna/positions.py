# SPDX-License-Identifier: GPL-3.0-or-later
"""Places of parts that a deck of LS-DYNA moves before the start: *PART_MOVE, *CONTROL_FORMING_AUTOPOSITION_PARAMETER.

The latter puts a part above or below another one, along an axis, at the distance THICK where they come nearest, and
gives the displacement to a parameter, by which *PART_MOVE displaces parts. Where none does it is displaced itself.
"""
from collections.abc import Callable, Iterable

import numpy as np
from scipy.spatial import cKDTree

from dd3.dyna.cards import Card, Reader
from dd3.dyna.mesh import NODE, DynaMesh
from dd3.dyna.sets import Sets
from dd3.errors import Problem

AUTO = "*CONTROL_FORMING_AUTOPOSITION"
FIELDS = "PID CID DIR MPID POSITION PREMOVE THICK PORDER"
AXES = "in axes of its own is not read; write the deck with the nodes in their places"


def placed_mesh(reader: Reader) -> tuple[DynaMesh, list[str]]:
    """Return the mesh of a file with its parts in their places at the start, and notes on those that are displaced."""
    mesh = DynaMesh(reader)
    auto = [card for card in reader.cards if card.keyword.startswith(AUTO)]
    if not auto and not mesh.moved:
        return mesh, []
    mesh.fill_parts()
    sets = Sets(mesh)
    for card in reader.cards:
        sets.take(card)

    def of_parts(number: int, kind: int, place: str) -> set[int]:
        if kind == 2 and not sets.has("PART", number):
            raise sets.missing("PART", number, place)
        return set(sets.get("PART", number)) if kind == 2 else {number}

    positions = Positions(mesh, of_parts)
    positions.apply(auto, mesh.moved)
    return mesh, positions.notes


class Positions:
    """The displacements; `of_parts` gives the parts of a number, of kind 2 a set, of kind 3 a part, with a place.

    `moves` are the displacements of the parts by number, `waiting` those that *PART_MOVE has still to make.
    """

    def __init__(self, mesh: DynaMesh, of_parts: Callable[[int, int, str], set[int]]) -> None:
        self.mesh, self.of_parts = mesh, of_parts
        self.found: dict[str, float] = {}  # by name of the parameter
        self.moves: dict[int, np.ndarray] = {}
        self.waiting: dict[int, np.ndarray] = {}
        self.notes: list[str] = []

    def apply(self, auto: list[Card], moves: list[Card]) -> None:
        """Displace the parts."""
        named = {word.strip("-& ").upper() for card in moves for i in card.filled() for word in self.words(card, i)}
        for card in auto:
            for i in card.filled():
                self.position(card, i, named)
        for card in moves:
            for i in card.filled():
                self.move(card, i)
        self.mesh.displace(self.moves)

    @staticmethod
    def words(card: Card, i: int) -> list[str]:
        """Return the fields of a *PART_MOVE with the displacements."""
        row = card.row(i, "PID XMOV YMOV ZMOV CID IFSET", NODE)
        return row.words[1:4]

    def position(self, card: Card, i: int, named: set[str]) -> None:
        """Take a row of *CONTROL_FORMING_AUTOPOSITION_PARAMETER."""
        row = card.row(i, FIELDS)
        kind = 2 if "SET" in card.keyword.split("_") else 3
        axis, side = row.label("DIR", 1), row.label("POSITION", 1)
        if row.label("CID") or axis not in (1, 2, 3) or side not in (0, 1, -1):
            raise Problem(f"{row.place}: error: {card.keyword} with CID, DIR = {axis} or POSITION = {side}: " + AXES)
        parts = self.parts(row.label("PID"), kind, row.place)
        other, gap, by = row.label("MPID"), row.number("THICK"), row.number("PREMOVE")
        name = row.word("PORDER").strip("& ").upper()
        if other:
            beside = self.parts(other, kind, row.place)
            by = self.displacement(parts, beside, axis - 1, side or 1, gap)
        move = by * np.eye(3)[axis - 1]
        if name and name in named:
            self.found[name] = abs(by) if card.keyword.endswith("POSITIVE") else by
            for part in parts:
                self.waiting[part] = self.waiting.get(part, np.zeros(3)) + move
            what = f"&{name.lower()} = {by:.6g}"
        else:
            self.add(parts, move)
            what = f"moved by {by:.6g} along {'xyz'[axis - 1]}"
        self.notes.append(f"{row.place}: {card.keyword}: part {', '.join(map(str, sorted(parts)))}: {what}"
                          + (f", {gap:g} from part {other} where they are nearest" if other else ""))

    def parts(self, number: int, kind: int, place: str) -> set[int]:
        """Return the parts of a number; a Problem for one that is not there."""
        found = self.of_parts(number, kind, place)
        if not found or found - self.mesh.parts.keys() or not any(self.mesh.parts[part].cells for part in found):
            raise Problem(f"{place}: error: there is no *PART {number} with elements")
        return found

    def move(self, card: Card, i: int) -> None:
        """Take a row of *PART_MOVE."""
        row = card.row(i, "PID XMOV YMOV ZMOV CID IFSET", NODE)
        if row.label("CID"):
            raise Problem(f"{row.place}: error: *PART_MOVE " + AXES)
        parts = self.parts(row.label("PID"), 2 if row.label("IFSET") else 3, row.place)
        by = []
        for name in ("XMOV", "YMOV", "ZMOV"):
            word = row.word(name)
            value = self.found.get(word.lstrip("-").strip("& ").upper()) if "&" in word else None
            by.append(row.number(name) if value is None else -value if word.startswith("-") else value)
        self.add(parts, np.array(by))
        for part in parts:
            self.waiting.pop(part, None)

    def add(self, parts: Iterable[int], by: np.ndarray) -> None:
        """Displace parts further."""
        for part in parts:
            self.moves[part] = self.moves.get(part, np.zeros(3)) + by

    def displacement(self, parts: set[int], beside: set[int], axis: int, side: int, gap: float) -> float:
        """Return how far parts are to be displaced along an axis to be above (1) or below (-1) others."""
        one, other = self.triangles(parts), self.triangles(beside)
        turn = [(axis + 1) % 3, (axis + 2) % 3, axis]
        one, other = one[..., turn] * (1, 1, side), other[..., turn] * (1, 1, side)
        distances = [*heights(one.reshape(-1, 3), other), *(-value for value in heights(other.reshape(-1, 3), one))]
        least = min(distances, default=float(one[..., 2].min() - other[..., 2].max()))
        return side * (gap - least)

    def triangles(self, parts: Iterable[int]) -> np.ndarray:
        """Return the corners of the facets of parts as triangles (n, 3, 3)."""
        found = []
        for part in parts:
            shift = self.moves.get(part, np.zeros(3)) + self.waiting.get(part, np.zeros(3))
            for cell in self.mesh.parts[part].cells:
                corners = [np.array(self.mesh.nodes[label]) + shift for label in cell.nodes]
                found += [(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
        return np.array(found)


def heights(points: np.ndarray, triangles: np.ndarray) -> list[float]:
    """Return the heights of points over the triangles that they are above or below."""
    points = np.unique(points, axis=0)
    tree, found = cKDTree(points[:, :2]), list[float]()
    middle = triangles[..., :2].mean(axis=1)
    radius = np.linalg.norm(triangles[..., :2] - middle[:, None], axis=2).max(axis=1)
    for triangle, near in zip(triangles, tree.query_ball_point(middle, radius * (1 + 1e-9))):
        (a, b, c), there = triangle, points[near]
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if not len(there) or abs(area) < 1e-12:
            continue
        v = ((there[:, 0] - a[0]) * (c[1] - a[1]) - (there[:, 1] - a[1]) * (c[0] - a[0])) / area
        w = ((b[0] - a[0]) * (there[:, 1] - a[1]) - (b[1] - a[1]) * (there[:, 0] - a[0])) / area
        inside = (v > -1e-9) & (w > -1e-9) & (v + w < 1 + 1e-9)
        found += (there[:, 2] - a[2] - v * (b[2] - a[2]) - w * (c[2] - a[2]))[inside].tolist()
    return found
