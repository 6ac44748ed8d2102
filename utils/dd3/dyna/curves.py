# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves and tables of curves of an LS-DYNA deck."""
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dd3.dyna.cards import LONG, Card, Row, unread
from dd3.errors import Problem

HEAD = "LCID SIDR SFA SFO OFFA OFFO DATTYP LCINT"
SMOOTH = "LCID SIDR DIST TSTART TEND TRISE VMAX"
POINT = (LONG,) * 2
RISE = 17  # points of the rise of a smooth curve


@dataclass
class Curve:
    """Abscissae and ordinates of a curve with their scales, and the place of each point."""

    x: np.ndarray
    y: np.ndarray
    places: list[str]


class Curves:
    """The curves by number, read when they are asked for; of a table the curve of its lowest rate."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.cards: dict[int, Card] = {}
        self.tables: dict[int, tuple[Card, list[Card]]] = {}  # those of *DEFINE_TABLE with the curves behind it
        self.others: list[Card] = []  # of kinds that are not read
        self.waiting: list[Card] | None = None
        self.left = 0
        self.found: dict[int, Curve] = {}

    def holds(self, card: Card) -> bool:
        """Check whether a card is a curve or a table."""
        return any(card is one for one in self.cards.values()) or any(card is one for one, _ in self.tables.values())

    def take(self, card: Card) -> bool:
        """Take a curve or a table; check whether a card is one."""
        if card.keyword in ("*DEFINE_TABLE", "*DEFINE_TABLE_2D") and card.lines:
            number = card.first(0)
            self.once(number, card)
            self.tables[number] = card, []
            self.waiting, self.left = None, 0
            if card.keyword == "*DEFINE_TABLE":
                self.waiting, self.left = self.tables[number][1], len(card.filled()) - 1
        elif card.keyword in ("*DEFINE_CURVE", "*DEFINE_CURVE_SMOOTH") and card.lines:
            number = card.first(0)
            self.once(number, card)
            self.cards[number] = card
            if self.waiting is not None and self.left > 0:
                self.waiting.append(card)
                self.left -= 1
        else:
            if card.keyword.startswith(("*DEFINE_CURVE", "*DEFINE_TABLE", "*DEFINE_FUNCTION")):
                self.others.append(card)
            return False
        card.leave("nothing here uses it")
        return True

    def once(self, number: int, card: Card) -> None:
        """Raise a Problem at a second curve or table of a number."""
        first = self.cards.get(number) or (self.tables[number][0] if number in self.tables else None)
        if first:
            raise Problem(f"{card.place}: error: a second {first.keyword} {number}; the first is at {first.place}")

    def get(self, number: int, place: str) -> Curve:
        """Return a curve, of a table that of its lowest rate."""
        if number in self.tables:
            number = self.lowest(number)
        if number not in self.cards:
            raise Problem(f"{place}: error: there is no *DEFINE_CURVE {number}" + unread(self.others))
        if number not in self.found:
            card = self.cards[number]
            self.found[number] = smooth(card) if card.keyword.endswith("SMOOTH") else polygon(card)
        return self.found[number]

    def table(self, number: int, place: str) -> list[tuple[float, Curve]]:
        """Return the rates of a table, which are logarithms if one is negative, and their curves, by rate."""
        rows = self.rows(number)
        logarithms = min(rate for rate, _, _ in rows) < 0
        return [(float(np.exp(rate)) if logarithms else rate, self.get(label, place))
                for rate, label, _ in sorted(rows, key=lambda row: row[0])]

    def lowest(self, number: int) -> int:
        """Return the curve of the lowest rate of a table."""
        rates = self.rows(number)
        least = min(rates, key=lambda rate: rate[0])
        for _, label, row in rates:
            if row is not least[2]:
                row.drop("the curve of the lowest strain rate is taken")
                if label in self.cards and label != least[1]:
                    self.cards[label].leave("the curve of the lowest strain rate of its table is taken")
        return least[1]

    def rows(self, number: int) -> list[tuple[float, int, Row]]:
        """Return the rates of a table with their scale and offset, the numbers of their curves and their rows."""
        card, behind = self.tables[number]
        head = card.row(0, "TBID SFA OFFA")
        head.label("TBID")
        scale, shift = head.number("SFA", 1.0) or 1.0, head.number("OFFA")
        if len(card.filled()) < 2:
            raise Problem(f"{card.place}: error: a table without rows")
        rates = []
        for i in card.filled()[1:]:
            row = card.row(i, "VALUE LCID", POINT)
            rates.append((scale * (row.number("VALUE") + shift), row.label("LCID"), row))
        if card.keyword == "*DEFINE_TABLE" and not any(label for _, label, _ in rates):
            if len(behind) < len(rates):
                raise Problem(f"{card.place}: error: a table of {len(rates)} values and {len(behind)} curves behind it")
            rates = [(value, curve.first(0), row) for (value, _, row), curve in zip(rates, behind)]
        return rates


def polygon(card: Card) -> Curve:
    """Return the curve of points."""
    first = card.row(0, HEAD)
    first.label("LCID")
    first.leave("the relaxation before the start", "SIDR")
    first.number("LCINT")  # all points are taken here
    rows = [card.row(i, "A O", POINT) for i in card.filled()[1:]]
    if len(rows) < 2:
        raise Problem(f"{card.place}: error: a curve of {len(rows)} points; expected 2 or more")
    scale = [first.number(name, 1.0) or 1.0 for name in ("SFA", "SFO")]
    shift = first.numbers("OFFA OFFO")
    points = np.array([[scale[i] * (value + shift[i]) for i, value in enumerate(row.numbers("A O"))] for row in rows])
    wrong = np.flatnonzero(np.diff(points[:, 0]) <= 0)
    if wrong.size:
        raise Problem(f"{rows[wrong[0] + 1].place}: error: the abscissae of a curve must increase; "
                      f"{points[wrong[0] + 1, 0]:g} follows {points[wrong[0], 0]:g}")
    if not np.all(np.abs(points) < 1e30):
        raise Problem(f"{card.place}: error: a point of a curve beyond 1e30")
    return Curve(points[:, 0], points[:, 1], [row.place for row in rows])


def smooth(card: Card) -> Curve:
    """Return the velocity that rises over TRISE to VMAX, stays, and falls over TRISE to 0, with the area DIST: of half
    a cosine, of which only the area tells in a process without dynamics."""
    row: Row = card.row(0, SMOOTH)
    row.label("LCID")
    row.leave("the relaxation before the start", "SIDR")
    distance, start, end, rise, fastest = row.numbers("DIST TSTART TEND TRISE VMAX")
    fastest = abs(fastest)
    if not distance or not rise > 0 or not (end or fastest):
        raise Problem(f"{row.place}: error: a smooth curve of DIST = {distance:g}, TRISE = {rise:g}, TEND = {end:g}, "
                      f"VMAX = {fastest:g}; expected a distance, a rise > 0 and an end or a velocity")
    if not end:
        end = start + rise + abs(distance) / fastest
    if not end - start > rise:
        raise Problem(f"{row.place}: error: a smooth curve that ends at {end:g}, within its rise")
    rise = min(rise, (end - start) / 2)
    top = distance / (end - start - rise)
    part = (1 - np.cos(np.linspace(0, np.pi, RISE))) / 2
    times = np.concatenate([start + rise * np.linspace(0, 1, RISE), end - rise * np.linspace(1, 0, RISE)])
    values = top * np.concatenate([part, part[::-1]])
    times, keep = np.unique(times, return_index=True)
    return Curve(times, values[keep], [row.place] * len(times))
