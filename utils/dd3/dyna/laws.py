# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of LS-DYNA as laws of *MATERIAL."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from dd3.dyna.cards import Card
from dd3.dyna.deck import Deck
from dd3.errors import Problem

NAMES = {"RIGID": 20, "PIECEWISE_LINEAR_PLASTICITY": 24, "3-PARAMETER_BARLAT": 36, "HILL_3R": 122,
         "TRANSVERSELY_ANISOTROPIC_ELASTIC_PLASTIC": 37, "BARLAT_YLD2000": 133, "PLASTIC_KINEMATIC": 3,
         "POWER_LAW_PLASTICITY": 18}
READ = "003, 018, 024, 036, 037, 122, 133"
# Units by Young's modulus of a metal: its range, the factors on lengths and on stresses, mm and MPa here.
UNITS = {"mm MPa": (3e4, 4.5e5, 1.0, 1.0), "mm GPa": (30.0, 450.0, 1.0, 1e3), "m Pa": (3e10, 4.5e11, 1e3, 1e-6)}


@dataclass(frozen=True)
class Units:
    """Factors from a deck to mm and MPa."""

    name: str
    length: float
    stress: float

    @property
    def force(self) -> float:
        """The factor on forces."""
        return self.stress * self.length**2


@dataclass
class Law:
    """The entries of a *MATERIAL, and notes on what differs."""

    young: float
    poisson: float
    criterion: str
    hardening: str
    rolling: tuple[float, ...] | None = None
    notes: list[str] = field(default_factory=list)


def number_of(card: Card) -> int:
    """Return the number of a material's model, 0 for an unknown one."""
    word = card.keyword.removeprefix("*MAT_")
    if found := re.match(r"(\d{1,3})(?:_|$)", word):
        return int(found[1])
    return next((number for name, number in NAMES.items() if word == name or word.startswith(f"{name}_")), 0)


def units_of(card: Card, wanted: str | None) -> Units:
    """Return the units of a deck, by Young's modulus of the blank if they are not given."""
    young = card.row(0).number(2)
    if wanted:
        return Units(wanted, *UNITS[wanted][2:])
    for name, (low, high, length, stress) in UNITS.items():
        if low <= young <= high:
            return Units(name, length, stress)
    raise Problem(f"{card.row(0).place}: error: Young's modulus {young:g} tells no units; expected a metal in "
                  f"{', '.join(UNITS)}; --units gives them")


def law_of(deck: Deck, card: Card, units: Units, axes: np.ndarray) -> Law:
    """Return the laws of a material; `axes` are the first edge and the normal of the blank's first element."""
    number, first = number_of(card), card.row(0)
    readers = {3: bilinear, 18: power_law, 24: piecewise, 36: barlat_lian, 37: transverse, 122: hill, 133: yld2000}
    if number not in readers:
        raise Problem(f"{card.place}: error: the material {card.keyword} of the blank is not read; expected *MAT_ "
                      + READ)
    young, poisson = first.number(2) * units.stress, first.number(3)
    if not young > 0 or not -1 < poisson < 0.5:
        raise Problem(f"{first.place}: error: E = {young:g} MPa, PR = {poisson:g}; expected E > 0, -1 < PR < 0.5")
    law = Law(young, poisson, "von_mises", "")
    readers[number](deck, card, units, law)
    if number in (36, 122, 133):
        at = 2 if number != 133 else 4 if first.number(4) else 3  # the row of AOPT
        law.rolling = rolling(card, at, axes, law)
    return law


def positive(value: float, name: str, place: str) -> float:
    """Return a value; a Problem unless it is positive."""
    if not value > 0:
        raise Problem(f"{place}: error: {name} = {value:g}; expected a number > 0")
    return value


def hill48(r: Sequence[float]) -> str:
    """Return Hill's criterion by the r-values at 0, 45 and 90 degrees."""
    return "hill48 " + " ".join(f"r{angle}={value:.6g}" for angle, value in zip((0, 45, 90), r))


def linear(units: Units, law: Law, stress: float, tangent: float, place: str) -> str:
    """Return linear hardening by yield stress and tangent modulus, in units of the deck."""
    stress = positive(stress, "yield stress", place) * units.stress
    tangent *= units.stress
    if not 0 <= tangent < law.young:
        raise Problem(f"{place}: error: a tangent modulus of {tangent:g} MPa; expected 0 to Young's modulus")
    return f"linear Y0={stress:.8g} H={law.young * tangent / (law.young - tangent):.8g}"


def swift(units: Units, law: Law, values: tuple[float, float, float], place: str) -> str:
    """Return Swift's law by K, n and e0."""
    factor, exponent, start = (positive(value, name, place) for value, name in zip(values, ("K", "n", "e0")))
    if exponent > 1:
        raise Problem(f"{place}: error: a hardening exponent of {exponent:g}; expected at most 1")
    return f"swift K={factor * units.stress:.8g} e0={start:.8g} n={exponent:.8g}"


def by_curve(deck: Deck, number: int, units: Units, law: Law, place: str) -> str:
    """Return hardening by points of plastic strain and flow stress."""
    if number in deck.tables:
        law.notes.append("hardening: the curve of the lowest strain rate; rates are not available")
    curve = deck.curve(number, place)
    strain, stress = curve.x.copy(), curve.y * units.stress
    for i in range(len(strain)):
        if strain[i] < 0:
            raise Problem(f"{curve.places[i]}: error: a plastic strain of {strain[i]:g} in a hardening curve")
        if not 1e-5 * law.young < stress[i] < 0.1 * law.young:
            raise Problem(f"{curve.places[i]}: error: a flow stress of {stress[i]:g} MPa at the plastic strain "
                          f"{strain[i]:g}; expected {1e-5 * law.young:g} to {0.1 * law.young:g} MPa, by Young's "
                          "modulus")
    if (falls := np.flatnonzero(np.diff(stress) < 0)).size:
        law.notes.append(f"hardening: the flow stress falls behind the plastic strain {strain[falls[0]]:g}")
    if strain[0] > 0:
        strain, stress = np.append(0.0, strain), np.append(stress[0], stress)
    return "table " + " ".join(f"{p:.6g}:{y:.6g}" for p, y in zip(strain, stress))


def bilinear(deck: Deck, card: Card, units: Units, law: Law) -> None:
    """*MAT_003: linear hardening, isotropic by its part beta."""
    row = card.row(0)
    law.hardening = linear(units, law, row.number(4), row.number(5), row.place)
    beta = row.number(6)
    if beta < 1 and row.number(5) > 0:
        law.notes.append(f"hardening: isotropic for BETA = {beta:g}; kinematic hardening: `backstress`")


def power_law(deck: Deck, card: Card, units: Units, law: Law) -> None:
    """*MAT_018: K (e0 + p)^n."""
    row = card.row(0)
    factor, exponent = positive(row.number(4), "K", row.place), positive(row.number(5), "N", row.place)
    start = card.rows[1].number(0) if len(card.rows) > 1 else 0.0
    start = first_strain(start, factor, exponent, law.young / units.stress)
    law.hardening = swift(units, law, (factor, exponent, start), row.place)


def first_strain(start: float, factor: float, exponent: float, young: float) -> float:
    """Return the strain of first yield: a strain up to 0.02, a stress above, by default where the line of elasticity
    meets the curve."""
    if start > 0.02:
        return float((start / factor) ** (1 / exponent))
    return start or float((young / factor) ** (1 / (exponent - 1)) if exponent < 1 else 1e-3)


def piecewise(deck: Deck, card: Card, units: Units, law: Law) -> None:
    """*MAT_024: a curve, eight points, or yield stress and tangent modulus."""
    row = card.row(0)
    second = card.rows[1] if len(card.rows) > 1 else None
    if second and second.number(0):
        law.notes.append("rates of strain (C, P) are not available")
    if second and second.number(2):
        law.hardening = by_curve(deck, second.label(2), units, law, second.place)
    elif len(card.rows) > 3 and any(card.rows[3].number(i) for i in range(8)):
        points = [(card.rows[2].number(i), card.rows[3].number(i) * units.stress) for i in range(8)
                  if card.rows[3].number(i)]
        law.hardening = "table " + " ".join(f"{p:.6g}:{y:.6g}" for p, y in sorted(points))
    else:
        law.hardening = linear(units, law, row.number(4), row.number(5), row.place)


def transverse(deck: Deck, card: Card, units: Units, law: Law) -> None:
    """*MAT_037: Hill's criterion with one r-value."""
    row = card.row(0)
    r = abs(row.number(6, 1.0)) or 1.0
    law.criterion = hill48((r, r, r))
    number = int(abs(row.number(7)))
    law.hardening = by_curve(deck, number, units, law, row.place) if number else linear(
        units, law, row.number(4), row.number(5), row.place)


def r_values(card: Card, at: int, first: int) -> tuple[float, float, float]:
    """Return the r-values in a row from a field on."""
    row = card.row(at)
    r00, r45, r90 = (positive(row.number(first + i), f"r-value {name}", row.place)
                     for i, name in enumerate(("00", "45", "90")))
    return r00, r45, r90


def by_rule(deck: Deck, card: Card, units: Units, law: Law, curve_at: int) -> str:
    """Return the hardening of *MAT_036 and 122: by HR = 1 linear, 2 Swift, 3 a curve."""
    row, second = card.row(0), card.row(1)
    rule = row.label(4)
    if rule == 3:
        return by_curve(deck, abs(second.label(curve_at)), units, law, second.place)
    if rule == 2:
        factor, exponent = (positive(row.number(i), name, row.place) for i, name in ((5, "K"), (6, "n")))
        start = second.number(curve_at + 1)
        if not start:
            given = second.number(curve_at + 2) if curve_at == 4 else 0.0
            start = first_strain(given, factor, exponent, law.young / units.stress)
        return swift(units, law, (factor, exponent, start), row.place)
    if rule in (0, 1):
        return linear(units, law, row.number(6), row.number(5), row.place)
    raise Problem(f"{row.place}: error: the hardening rule HR = {rule} is not read; expected 1, 2 or 3")


def barlat_lian(deck: Deck, card: Card, units: Units, law: Law) -> None:
    """*MAT_036: Barlat and Lian (1989) of exponent m; of m = 2 it is Hill's criterion in plane stress."""
    r = r_values(card, 1, 1)
    law.criterion = hill48(r)
    exponent = card.row(1).number(0)
    if abs(exponent - 2) > 1e-6:
        law.notes.append("yield: hill48 with the r-values, in place of Barlat and Lian (1989) of exponent "
                         f"{exponent:g}; nearer: dd3 identify blank --criterion yld91 --fix m={exponent:g} --r "
                         f"0:{r[0]:g} 45:{r[1]:g} 90:{r[2]:g}")
    law.hardening = by_rule(deck, card, units, law, 4)


def hill(deck: Deck, card: Card, units: Units, law: Law) -> None:
    """*MAT_122: Hill (1948) by r-values."""
    r = r_values(card, 1, 0)
    law.criterion = hill48(r)
    law.hardening = by_rule(deck, card, units, law, 3)


def yld2000(deck: Deck, card: Card, units: Units, law: Law) -> None:
    """*MAT_133: Barlat et al. (2003), Yld2000-2d; hill48 with its r-values."""
    first, second, third = card.row(0), card.row(1), card.row(2)
    exponent = second.number(6) or 8.0
    if first.number(4):
        r = [positive(third.number(i), "r-value", third.place) for i in (3, 4, 5)]
        stress = [third.number(i) for i in (0, 1, 2)]
        stress = [value / stress[0] for value in stress] if all(value > 0 for value in stress) else []
    else:
        alpha = np.array([third.number(i) for i in range(8)])
        if not np.any(alpha):
            raise Problem(f"{third.place}: error: all coefficients of Yld2000 are 0")
        found = [yld2000_at(alpha, exponent, np.radians(angle)) for angle in (0, 45, 90)]
        if not np.all(np.isfinite(found)) or min(value for _, value in found) <= 0:
            raise Problem(f"{third.place}: error: the coefficients of Yld2000 give no positive r-values")
        stress, r = [value / found[0][0] for value, _ in found], [value for _, value in found]
    law.criterion = hill48(r)
    law.notes.append("yield: hill48 with the r-values, in place of Yld2000-2d; nearer: dd3 identify blank --criterion "
                     f"yld2004 --fix m={exponent:g} --r "
                     + " ".join(f"{angle}:{value:.4g}" for angle, value in zip((0, 45, 90), r))
                     + (" --stress " + " ".join(f"{angle}:{value:.4g}" for angle, value in zip((0, 45, 90), stress))
                        if stress else ""))
    rule = second.label(5)
    if rule < 0:
        law.hardening = by_curve(deck, -rule, units, law, second.place)
    elif rule in (0, 1):
        law.hardening = swift(units, law, (second.number(0), second.number(2), second.number(1)), second.place)
    else:
        raise Problem(f"{second.place}: error: the hardening rule HARD = {rule} is not read; expected 1, or the "
                      "negative number of a curve")


def yld2000_at(alpha: np.ndarray, exponent: float, angle: float) -> tuple[float, float]:
    """Return yield stress over flow stress and r-value of Yld2000-2d in tension at an angle to rolling.

    Source: Barlat et al., Int. J. Plasticity 19 (2003) 1297-1319.
    """
    a = alpha
    first = np.array([[2 * a[0], -a[0], 0], [-a[1], 2 * a[1], 0], [0, 0, 3 * a[6]]]) / 3
    second = np.array([[8 * a[4] - 2 * a[2] - 2 * a[5] + 2 * a[3], 4 * a[5] - 4 * a[3] - 4 * a[4] + a[2], 0],
                       [4 * a[2] - 4 * a[4] - 4 * a[3] + a[5], 8 * a[3] - 2 * a[5] - 2 * a[2] + 2 * a[4], 0],
                       [0, 0, 9 * a[7]]]) / 9

    def principal(x: np.ndarray) -> tuple[float, float]:
        middle, radius = (x[0] + x[1]) / 2, np.hypot((x[0] - x[1]) / 2, x[2])
        return middle + radius, middle - radius

    def equivalent(s: np.ndarray) -> float:
        (x1, x2), (y1, y2) = principal(first @ s), principal(second @ s)
        return float(((abs(x1 - x2)**exponent + abs(2 * y2 + y1)**exponent + abs(2 * y1 + y2)**exponent) / 2)
                     ** (1 / exponent))

    c, s = np.cos(angle), np.sin(angle)
    stress = np.array([c * c, s * s, c * s])
    step = 1e-6
    flow = np.array([(equivalent(stress + step * e) - equivalent(stress - step * e)) / (2 * step) for e in np.eye(3)])
    across = flow[0] * s * s + flow[1] * c * c - flow[2] * s * c
    return 1 / equivalent(stress), float(across / -(flow[0] + flow[1]))


def rolling(card: Card, at: int, axes: np.ndarray, law: Law) -> tuple[float, ...] | None:
    """Return the rolling direction by AOPT, in a row of a material; None where it cannot be read."""
    def numbers(row: int, first: int, count: int) -> np.ndarray:  # rows of defaults at the end of a card may be missing
        there = row < len(card.rows)
        return np.array([card.rows[row].number(i) if there else 0.0 for i in range(first, first + count)])

    kind = numbers(at, 0, 1)[0]
    edge, normal = axes
    if kind == 2:
        vector = numbers(at + 1, 3, 3)
    elif kind == 3:
        vector, turn = np.cross(numbers(at + 2, 0, 3), normal), np.radians(numbers(at + 2, 6, 1)[0])
        vector = np.cos(turn) * vector + np.sin(turn) * np.cross(normal, vector)
    elif kind == 0:
        vector = edge
        law.notes.append("rolling direction: AOPT = 0, along the first edge of the blank's first element")
    else:
        vector = np.zeros(3)
    if np.linalg.norm(vector) < 1e-12:
        law.notes.append(f"rolling direction: AOPT = {kind:g} is not read, or its vector is 0; it is along x")
        return None
    return tuple(float(value) for value in vector / np.linalg.norm(vector))
