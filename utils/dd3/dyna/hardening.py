# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of a material of LS-DYNA as entries of *MATERIAL: the entries, and hardening laws by fields and curves."""

from dataclasses import dataclass, field

import numpy as np

from dd3.dyna.cards import Row
from dd3.dyna.curves import Curve
from dd3.dyna.deck import Deck
from dd3.errors import Problem

MOST_CURVES = 8  # of a law of the rate
SOFT_STRAINS = (0.0, 0.0005, 0.001, 0.002, 0.003, 0.005, 0.0075, 0.01, 0.015, 0.02, 0.03, 0.04, 0.06, 0.08, 0.1, 0.15,
                0.2, 0.3, 0.4, 0.6, 0.8, 1.0)  # of a table that replaces a law


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

    @property
    def time(self) -> float:
        """The factor on times to s: mm and GPa go with kg and ms, the others with s."""
        return 1e-3 if self.name == "mm GPa" else 1.0

    @property
    def density(self) -> float:
        """The factor on densities to t/mm3."""
        return self.stress * self.time**2 / self.length**2

    @property
    def acceleration(self) -> float:
        """The factor on accelerations to mm/s2."""
        return self.length / self.time**2


@dataclass
class Law:
    """The entries of a *MATERIAL, and notes on what differs."""

    young: float
    poisson: float
    criterion: str
    hardening: str
    rolling: tuple[float, ...] | None = None
    backstresses: list[str] = field(default_factory=list)
    modulus: str = ""
    rate: str = ""
    heating: list[str] = field(default_factory=list)
    fracture: str = ""
    forming_limit: str = ""
    density: float = 0.0
    notes: list[str] = field(default_factory=list)


def positive(value: float, name: str, place: str) -> float:
    """Return a value; a Problem unless it is positive."""
    if not value > 0:
        raise Problem(f"{place}: error: {name} = {value:g}; expected a number > 0")
    return value


def linear(units: Units, law: Law, stress: float, tangent: float, place: str, part: float = 1.0) -> str:
    """Return linear hardening, a part of it, by yield stress and tangent modulus, in units of the deck."""
    stress = positive(stress, "yield stress", place) * units.stress
    if not 0 <= tangent * units.stress < law.young:
        raise Problem(f"{place}: error: a tangent modulus of {tangent * units.stress:g} MPa; expected 0 to E")
    return f"linear Y0={stress:.8g} H={part * slope(units, law, tangent):.8g}"


def slope(units: Units, law: Law, tangent: float) -> float:
    """Return the slope of the flow stress over the plastic strain by a tangent modulus."""
    return law.young * tangent * units.stress / (law.young - tangent * units.stress)


def swift(units: Units, law: Law, values: tuple[float, float, float], place: str) -> str:
    """Return Swift's law by K, n and e0."""
    factor, exponent, start = (positive(value, name, place) for value, name in zip(values, ("K", "n", "e0")))
    if exponent > 1:
        raise Problem(f"{place}: error: a hardening exponent of {exponent:g}; expected at most 1")
    return f"swift K={factor * units.stress:.8g} e0={start:.8g} n={exponent:.8g}"


def by_curve(deck: Deck, number: int, units: Units, law: Law, place: str) -> str:
    """Return hardening by points of plastic strain and flow stress."""
    if number in deck.curves.tables:
        law.notes.append("hardening: the curve of the lowest strain rate; others are taken of *MAT_024 with VP = 1, "
                         f"two to {MOST_CURVES} curves that do not cross, rates above 0")
    return "table " + points_of(deck.curves.get(number, place), units, law)


def by_table(deck: Deck, number: int, units: Units, law: Law, place: str) -> str:
    """Return hardening by the first curve of a table of rates, and take the others as law of the rate. A table that is
    not one here, of more than eight curves, of curves that cross or of a rate of zero, is that of its lowest rate."""
    table = deck.curves.table(number, place)
    curves = [(rate / units.time, points_of(curve, units, law)) for rate, curve in table]
    values = [np.array([point.split(":") for point in points.split()], float) for _, points in curves]
    strains = np.unique(np.concatenate([value[:, 0] for value in values]))
    stresses = np.array([np.interp(strains, *value.T) for value in values])
    if not 2 <= len(curves) <= MOST_CURVES or curves[0][0] <= 0 or (np.diff(stresses, axis=0) < 0).any():
        return by_curve(deck, number, units, law, place)
    law.rate = "curves " + " ".join(f"r{k}={rate:.9g}" for k, (rate, _) in enumerate(curves, 1)) + "".join(
        f" &\n    {points}" for _, points in curves)
    law.notes.append("hardening: the flow stress is straight over the logarithm of the rate between the curves")
    return f"table {curves[0][1]}"


def points_of(curve: Curve, units: Units, law: Law) -> str:
    """Return the points of a hardening curve, from a plastic strain of zero on."""
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
    return " ".join(f"{p:.9g}:{y:.9g}" for p, y in zip(strain, stress))


def cowper_symonds(row: Row, units: Units) -> str:
    """Return the law of the rate by C and P; empty without them."""
    rate, exponent = row.peek("C"), row.peek("P")
    if rate <= 0 or exponent < 1:
        return ""
    row.numbers("C P VP")
    return f"cowper_symonds C={rate / units.time:.8g} p={exponent:.8g}"


def first_strain(start: float, factor: float, exponent: float, young: float) -> float:
    """Return the strain of first yield: a strain up to 0.02, a stress above, by default where the line of elasticity
    meets the curve."""
    if start > 0.02:
        return float((start / factor) ** (1 / exponent))
    return start or float((young / factor) ** (1 / (exponent - 1)) if exponent < 1 else 1e-3)


def yoshida_uemori(row: Row, options: Row, units: Units, law: Law, moduli: Row | None = None) -> None:
    """Take the law of Yoshida and Uemori and the chord modulus from the rows that have their parameters; `moduli` is
    that of EA and COE, by default `options`."""
    if options.number("IOPT"):
        raise Problem(f"{options.place}: error: IOPT = {options.number('IOPT'):g}, the modified hardening of the "
                      "bounding surface by C1 and C2, is not available; expected IOPT = 0, R by Rsat")
    options.leave("IOPT = 0 takes Rsat", "C1 C2")
    outer, inner, rate, surface, growth, centre, extent = row.numbers("CB Y SC K RSAT SB H")
    if not outer > positive(inner, "Y", row.place):
        raise Problem(f"{row.place}: error: CB = {outer:g} is not larger than Y = {inner:g}; expected a bounding "
                      "surface outside the yield surface")
    if not 0 <= extent <= 1 or min(rate, surface, growth, centre) < 0:
        raise Problem(f"{row.place}: error: expected H from 0 to 1, and SC, K, RSAT and SB not negative")
    law.hardening = (f"yoshida_uemori Y={inner * units.stress:.8g} B={outer * units.stress:.8g} C={rate:.8g} "
                     f"m={surface:.8g} b_sat={centre * units.stress:.8g} Rsat={growth * units.stress:.8g} "
                     f"h={extent:.8g}")
    chord(moduli or options, units, law)


def chord(row: Row, units: Units, law: Law) -> None:
    """Take the chord modulus by EA and COE, where there is one."""
    final, saturation = row.numbers("EA COE")
    if final > 0 and saturation > 0:
        if final * units.stress > law.young:
            raise Problem(f"{row.place}: error: EA = {final:g} is larger than E; expected a modulus that falls")
        law.modulus = f"chord Ea={final * units.stress:.8g} xi={saturation:.8g}"


def chaboche(row: Row, units: Units, law: Law) -> None:
    """Take the back-stresses of *MAT_036 with M < 0, dX = C (a s/Y - X) dp. The curve of the card is that of tension:
    the isotropic part is the curve less the sum of a (1 - exp(-C p))."""
    terms = [(rate, limit * units.stress) for k in "1234"
             if (limit := row.number(f"CRA{k}")) and (rate := row.number(f"CRC{k}"))]
    if any(rate <= 0 or limit <= 0 for rate, limit in terms):
        raise Problem(f"{row.place}: error: a back-stress with a rate or a limit <= 0")
    law.backstresses = [f"lemaitre_chaboche CX={rate:.8g} Xsat={limit:.8g}" for rate, limit in terms]
    if not terms:
        return
    points = table_of(law.hardening)
    points = [(p, y - sum(limit * (1 - np.exp(-rate * p)) for rate, limit in terms)) for p, y in points]
    if min(y for _, y in points) <= 0:
        raise Problem(f"{row.place}: error: the back-stresses are larger than the flow stress")
    law.hardening = "table " + " ".join(f"{p:.9g}:{y:.9g}" for p, y in points)
    law.notes.append("hardening: the curve less the back-stresses in tension, as the sum of both is that of the deck")


def table_of(law: str) -> list[tuple[float, float]]:
    """Return points of a hardening law, dense at small strains."""
    name, *words = law.split()
    if name == "table":
        p, y = np.array([[float(value) for value in word.split(":")] for word in words]).T
        strains = np.unique([*p, *(strain for strain in SOFT_STRAINS if strain <= p[-1])])
        return list(zip(strains.tolist(), np.interp(strains, p, y).tolist()))
    value = {key: float(number) for key, number in (word.split("=") for word in words)}
    if name == "swift":
        return [(p, value["K"] * (value["e0"] + p)**value["n"]) for p in SOFT_STRAINS]
    return [(p, value["Y0"] + value["H"] * p) for p in SOFT_STRAINS]
