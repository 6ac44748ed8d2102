# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials of LS-DYNA as laws of *MATERIAL (fields: LS-DYNA Keyword User's Manual, Vol. II)."""

import re
from collections.abc import Callable, Sequence

import numpy as np

from dd3.dyna.cards import Card, Row
from dd3.dyna.deck import Deck
from dd3.dyna.hardening import (
    Law,
    Units,
    by_curve,
    by_table,
    chaboche,
    chord,
    cowper_symonds,
    first_strain,
    linear,
    positive,
    slope,
    swift,
    yoshida_uemori,
)
from dd3.dyna.planar import barlat89_at
from dd3.dyna.planar import yld2000 as yld2000_of
from dd3.errors import Problem

NAMES = {"RIGID": 20, "PIECEWISE_LINEAR_PLASTICITY": 24, "3-PARAMETER_BARLAT": 36, "HILL_3R": 122,
         "TRANSVERSELY_ANISOTROPIC_ELASTIC_PLASTIC": 37, "BARLAT_YLD2000": 133, "PLASTIC_KINEMATIC": 3,
         "POWER_LAW_PLASTICITY": 18, "KINEMATIC_HARDENING_TRANSVERSELY_ANISOTROPIC": 125,
         "KINEMATIC_HARDENING_BARLAT89": 226, "KINEMATIC_HARDENING_BARLAT2000": 242,
         "SIMPLIFIED_JOHNSON_COOK": 98, "JOHNSON_COOK": 15}
READ = "003, 015, 018, 024, 036, 037, 098, 122, 125, 133, 226, 242"
# Units by Young's modulus of a metal: its range, the factors on lengths and on stresses, mm and MPa here.
UNITS = {"mm MPa": (3e4, 4.5e5, 1.0, 1.0), "mm GPa": (30.0, 450.0, 1.0, 1e3), "m Pa": (3e10, 4.5e11, 1e3, 1e-6)}
ROWS = {3: ("MID RO E PR SIGY ETAN BETA", "SRC SRP FS VP"),
        15: ("MID RO G E PR DTF VP RATEOP", "A B N C M TM TR EPSO", "CP PC SPALL IT D1 D2 D3 D4",
             "D5 C2P EROD EFMIN NUMINT"),
        18: ("MID RO E PR K N SRC SRP", "SIGY EPSF VP"),
        20: ("MID RO E PR N COUPLE M ALIAS", "CMO CON1 CON2 SPCNID XSPC YSPC ZSPC", "LCO A2 A3 V1 V2 V3 BNDLCO"),
        24: ("MID RO E PR SIGY ETAN FAIL TDEL", "C P LCSS LCSR VP unused RFILTF",
             "EPS1 EPS2 EPS3 EPS4 EPS5 EPS6 EPS7 EPS8", "ES1 ES2 ES3 ES4 ES5 ES6 ES7 ES8"),
        36: ("MID RO E PR HR P1 P2 ITER", "M R00 R45 R90 LCID E0 SPI P3"),
        37: ("MID RO E PR SIGY ETAN R HLCID", "IDSCALE EA COE ICFLD unused5 STRAINLT"),
        98: ("MID RO E PR VP", "A B N C PSFAIL SIGMAX SIGSAT EPSO"),
        122: ("MID RO E PR HR P1 P2", "R00 R45 R90 LCID E0"),
        125: ("MID RO E PR R HLCID OPT", "CB Y SC K RSAT SB H SC2", "EA COE IOPT C1 C2"),
        133: ("MID RO E PR FIT BETA ITER ISCALE", "K E0 N C P HARD A"),
        226: ("MID RO E PR M R00 R45 R90", "CB Y SC K RSAT SB H HLCID", "AOPT IOPT C1 C2 unused EA COE"),
        242: ("MID RO E PR EA COE M", "ALPHA1 ALPHA2 ALPHA3 ALPHA4 ALPHA5 ALPHA6 ALPHA7 ALPHA8",
              "CB Y SC K RSAT SB H", "AOPT unused IOPT C1 C2")}
CHABOCHE = "CRC1 CRA1 CRC2 CRA2 CRC3 CRA3 CRC4 CRA4"
AXES = {36: ("AOPT C P VLCID unused PB NLP HTB", "unused1 unused2 unused3 A1 A2 A3 HTC HTD",
             "V1 V2 V3 D1 D2 D3 BETA HTFLAG"),
        122: ("AOPT", "unused1 unused2 unused3 A1 A2 A3", "V1 V2 V3 D1 D2 D3 BETA"),
        133: ("AOPT OFFANG P4 HTFLAG HTA HTB HTC HTD", "unused1 unused2 unused3 A1 A2 A3", "V1 V2 V3 D1 D2 D3 USRFAIL"),
        226: (ROWS[226][2], "XP YP ZP A1 A2 A3", "V1 V2 V3 D1 D2 D3 BETA"),
        242: (ROWS[242][3], "unused1 unused2 unused3 A1 A2 A3", "V1 V2 V3 D1 D2 D3 BETA")}
RATES = "this dependence on the strain rate is not available"
TOTAL = "VP = 0 takes the rate of the total strain, the laws here that of the plastic strain: VP = 1 is taken over"
ADDED = ("with VP = 1 and SIGY the rate adds SIGY (rate/C)^(1/P) to the curve, the law here multiplies it: SIGY = 0 "
         "with one curve is taken over")
FAILURE = "failure is not available"
HEAT = "temperatures and heat treatment are not available"
METAL = 5e-10, 2.5e-8  # densities, t/mm3
LARGEST_R = 10.0
ROUNDED = 2e-4  # of the yield stress along rolling by coefficients of Yld2000 with four digits


def number_of(card: Card) -> int:
    """Return the number of a material's model, 0 for an unknown one."""
    word = card.keyword.removeprefix("*MAT_")
    if found := re.match(r"(\d{1,3})(?:_|$)", word):
        return int(found[1])
    return next((number for name, number in NAMES.items() if word == name or word.startswith(f"{name}_")), 0)


def row_of(card: Card, i: int) -> Row:
    """Return a row of the material's own fields, one of defaults at the end of the card."""
    names = ROWS.get(number_of(card), ("MID RO E PR",))[i]
    return card.row(i, names) if not i else card.optional(i, names)


def units_of(card: Card, wanted: str | None) -> Units:
    """Return the units of a deck, by Young's modulus of the blank if they are not given."""
    row = row_of(card, 0)
    young = row.number("E")
    if wanted:
        return Units(wanted, *UNITS[wanted][2:])
    for name, (low, high, length, stress) in UNITS.items():
        if low <= young <= high:
            return Units(name, length, stress)
    raise Problem(f"{row.place}: error: Young's modulus {young:g} tells no units; expected a metal in "
                  f"{', '.join(UNITS)}; --units gives them")


def law_of(deck: Deck, card: Card, units: Units, axes: np.ndarray) -> Law:
    """Return the laws of a material; `axes` are the first edge and the normal of the blank's first element."""
    number = number_of(card)
    readers: dict[int, Callable[[Deck, Card, Units, Law], int]] = {
        3: bilinear, 15: heated_johnson_cook, 18: power_law, 24: piecewise, 36: barlat_lian, 37: transverse,
        98: johnson_cook, 122: hill, 125: two_surfaces, 133: yld2000, 226: two_surfaces_barlat,
        242: two_surfaces_yld2000}
    if number not in readers:
        raise Problem(f"{card.place}: error: the material {card.keyword} of the blank is not read; expected *MAT_ "
                      + READ)
    first = row_of(card, 0)
    first.number("MID")
    young, poisson = first.number("E") * units.stress, first.number("PR")
    if not young > 0 or not -1 < poisson < 0.5:
        raise Problem(f"{first.place}: error: E = {young:g} MPa, PR = {poisson:g}; expected E > 0, -1 < PR < 0.5")
    law = Law(young, poisson, "von_mises", "")
    law.density = density(first.number("RO"), units, law, first.place)
    at = readers[number](deck, card, units, law)
    if at:
        law.rolling = rolling(card, at, axes, law)
    return law


def density(value: float, units: Units, law: Law, place: str) -> float:
    """Return a density in t/mm3."""
    value *= units.density
    if value and not METAL[0] <= value <= METAL[1]:
        law.notes.append(f"{place}: RO is {value:.3g} t/mm3 in the units {units.name}, that of a metal is {METAL[0]:g} "
                         f"to {METAL[1]:g}: mass scaling, or another unit of time or mass; gravity takes it as it is")
    return max(value, 0.0)


def use_rigid(card: Card) -> None:
    """Take the material of a tool: only that it is rigid tells."""
    for i, names in enumerate(ROWS[20][:len(card)]):
        row = card.row(i, names)
        if i == 0:
            row.numbers("MID RO E PR")
        elif i == 1 and row.number("CMO") >= 0:
            row.numbers("CMO CON1 CON2")  # a tool moves only as it is told
        row.leave("a tool moves as its motions and forces say" if i else "a tool is rigid")


def hill48(r: Sequence[float]) -> str:
    """Return Hill's criterion by the r-values at 0, 45 and 90 degrees."""
    return "hill48 " + " ".join(f"r{angle}={value:.9g}" for angle, value in zip((0, 45, 90), r))


def bilinear(deck: Deck, card: Card, units: Units, law: Law) -> int:
    """*MAT_003: linear hardening, its part BETA isotropic, the rest kinematic."""
    row, second = row_of(card, 0), row_of(card, 1)
    beta = row.number("BETA")
    if not 0 <= beta <= 1:
        raise Problem(f"{row.place}: error: BETA = {beta:g}; expected 0 to 1")
    law.hardening = linear(units, law, row.number("SIGY"), row.number("ETAN"), row.place, beta)
    if beta < 1 and row.number("ETAN") > 0:
        law.backstresses = [f"prager k={(1 - beta) * slope(units, law, row.number('ETAN')):.8g}"]
    second.leave(RATES, "SRC SRP VP")
    second.leave(FAILURE, "FS")
    return 0


def power_law(deck: Deck, card: Card, units: Units, law: Law) -> int:
    """*MAT_018: K (e0 + p)^n."""
    row, second = row_of(card, 0), row_of(card, 1)
    factor, exponent = positive(row.number("K"), "K", row.place), positive(row.number("N"), "N", row.place)
    start = first_strain(second.number("SIGY"), factor, exponent, law.young / units.stress)
    law.hardening = swift(units, law, (factor, exponent, start), row.place)
    row.leave(RATES, "SRC SRP")
    second.leave(FAILURE, "EPSF")
    second.leave(RATES, "VP")
    return 0


def piecewise(deck: Deck, card: Card, units: Units, law: Law) -> int:
    """*MAT_024: a curve, eight points, or yield stress and tangent modulus; with VP = 1 and a curve alone the factor of
    Cowper and Symonds."""
    row, second, strains, stresses = (row_of(card, i) for i in range(4))
    row.leave(FAILURE, "FAIL TDEL")
    curve = second.label("LCSS")
    viscoplastic = second.peek("VP") == 1
    if viscoplastic and curve and curve not in deck.curves.tables and row.peek("SIGY") <= 0:
        law.rate = cowper_symonds(second, units)
    second.leave(ADDED if viscoplastic else TOTAL, "C P")
    second.leave(RATES, "LCSR VP RFILTF")
    at = [(p, y) for k in range(1, 9) if (y := stresses.number(f"ES{k}"))
          for p in (strains.number(f"EPS{k}"),)] if not curve else []
    if curve:
        tabled = viscoplastic and curve in deck.curves.tables
        law.hardening = (by_table if tabled else by_curve)(deck, curve, units, law, second.place)
        if law.rate and tabled:
            second.number("VP")
        strains.leave("LCSS goes before")
        stresses.leave("LCSS goes before")
        row.leave("LCSS goes before", "SIGY ETAN")
    elif at:
        row.leave("the points go before", "SIGY ETAN")
        law.hardening = "table " + " ".join(f"{p:.6g}:{y * units.stress:.6g}" for p, y in sorted(at))
    else:
        law.hardening = linear(units, law, row.number("SIGY"), row.number("ETAN"), row.place)
    return 0


def johnson_cook(deck: Deck, card: Card, units: Units, law: Law) -> int:
    """*MAT_098: A + B p^n, with VP = 1 times 1 + C ln(rate/EPSO)."""
    row, second = row_of(card, 0), row_of(card, 1)
    take_johnson_cook(row, second, units, law)
    second.leave(FAILURE, "PSFAIL")
    second.leave("the flow stress has no upper limit here", "SIGMAX SIGSAT")
    return 0


def take_johnson_cook(row: Row, second: Row, units: Units, law: Law) -> None:
    """Take the hardening and the factor of the rate of *MAT_015 and 098."""
    start, factor = positive(second.number("A"), "A", second.place), positive(second.number("B"), "B", second.place)
    exponent = positive(second.number("N"), "N", second.place)
    law.hardening = f"ludwik Y0={start * units.stress:.8g} K={factor * units.stress:.8g} n={exponent:.8g}"
    if row.number("VP") == 1 and second.peek("C") > 0 and second.peek("EPSO") > 0:
        law.rate = f"johnson_cook C={second.number('C'):.8g} reference={second.number('EPSO') / units.time:.8g}"
    second.leave(TOTAL, "C EPSO")


def heated_johnson_cook(deck: Deck, card: Card, units: Units, law: Law) -> int:
    """*MAT_015: that of *MAT_098 and, with CP and RO, the factor 1 - ((T - TR)/(TM - TR))^M of adiabatic heating."""
    row, second, third, fourth = (row_of(card, i) for i in range(4))
    take_johnson_cook(row, second, units, law)
    if row.peek("RATEOP"):
        law.rate = ""
        law.notes.append(f"{row.place}: RATEOP = {row.number('RATEOP'):g}: {RATES}")
    heat, exponent = third.number("CP"), second.number("M")
    melting, room = second.numbers("TM TR")
    if heat > 0 and law.density and exponent > 0 and melting > room:
        law.heating = [f"temperature = johnson_cook Tr={room:.8g} Tm={melting:.8g} m={exponent:.8g}",
                       f"initial_temperature = {room:.8g}",
                       f"heat_capacity = {heat * units.length * units.acceleration:.8g}", "heat_fraction = 1"]
    row.leave("the modulus is E", "G")
    row.leave(FAILURE, "DTF")
    third.leave(FAILURE, "PC SPALL IT D1 D2 D3 D4")
    fourth.leave(FAILURE, "D5 C2P EROD EFMIN NUMINT")
    return 0


def transverse(deck: Deck, card: Card, units: Units, law: Law) -> int:
    """*MAT_037: Hill's criterion with one r-value; with _ECHANGE a modulus that falls."""
    row, second = row_of(card, 0), row_of(card, 1)
    r = abs(row.number("R", 1.0)) or 1.0
    law.criterion = hill48((r, r, r))
    number = int(abs(row.number("HLCID")))
    if number:
        row.leave("HLCID goes before", "SIGY ETAN")
    law.hardening = by_curve(deck, number, units, law, row.place) if number else linear(
        units, law, row.number("SIGY"), row.number("ETAN"), row.place)
    chord(second, units, law)
    second.leave("a modulus by a curve is not available", "IDSCALE")
    second.leave("a forming limit curve: dd3 fld --curve", "ICFLD STRAINLT")
    return 0


def r_values(row: Row) -> tuple[float, float, float]:
    """Return the r-values in a row."""
    found = []
    for name in ("R00", "R45", "R90"):
        value = row.number(name)
        if value < 0:
            raise Problem(f"{row.place}: error: {name} = {value:g} is a curve of r-values, which is not read; "
                          "expected a number > 0")
        if positive(value, name, row.place) > LARGEST_R:
            raise Problem(f"{row.place}: error: {name} = {value:g}; expected an r-value up to {LARGEST_R:g}, "
                          "not in per cent")
        found.append(value)
    return found[0], found[1], found[2]


def by_rule(deck: Deck, card: Card, units: Units, law: Law) -> str:
    """Return the hardening of *MAT_036 and 122: by HR = 1 linear, 2 Swift, 3 a curve."""
    row, second = row_of(card, 0), row_of(card, 1)
    rule = row.label("HR")
    if rule == 3:
        row.leave("HR = 3 takes the curve", "P1 P2")
        second.leave("HR = 3 takes the curve", "E0 SPI")
        return by_curve(deck, abs(second.label("LCID")), units, law, second.place)
    second.leave(f"HR = {rule} takes no curve", "LCID")
    if rule == 2:
        factor, exponent = positive(row.number("P1"), "K", row.place), positive(row.number("P2"), "n", row.place)
        start = second.number("E0")
        if not start:
            given = second.number("SPI") if "SPI" in second.names else 0.0
            start = first_strain(given, factor, exponent, law.young / units.stress)
        return swift(units, law, (factor, exponent, start), row.place)
    if rule in (0, 1):
        return linear(units, law, row.number("P2"), row.number("P1"), row.place)
    raise Problem(f"{row.place}: error: the hardening rule HR = {rule} is not read; expected 1, 2 or 3")


def barlat_lian(deck: Deck, card: Card, units: Units, law: Law) -> int:
    """*MAT_036: Barlat and Lian (1989) of exponent m, by r-values or, with PB, by a, c, h and p; of m = 2 it is Hill's
    criterion in plane stress. M < 0: back-stresses of Chaboche in a further row."""
    row_of(card, 0).leave("the stress is integrated in another way", "ITER")
    second = row_of(card, 1)
    exponent = second.number("M")
    at = 3 if exponent < 0 else 2
    third = card.optional(at, AXES[36][0])
    pb = third.number("PB")
    third.leave(RATES, "C P")
    third.leave("a forming limit curve: dd3 fld --curve", "NLP")
    for i, names in ((0, "HTB"), (1, "HTC HTD"), (2, "HTFLAG")):
        card.optional(at + i, AXES[36][i]).leave(HEAT, names)
    second.leave("used by hardening rules that are not read", "P3")
    if pb > 0:
        a, c, h = second.numbers("R00 R45 R90")
        found = [barlat89_at((a, c, h, pb), abs(exponent), np.radians(angle))[1] for angle in (0, 45, 90)]
        if not np.all(np.isfinite(found)) or min(found) <= 0:
            raise Problem(f"{second.place}: error: the coefficients a = {a:g}, c = {c:g}, h = {h:g}, p = {pb:g} of "
                          "Barlat and Lian give no positive r-values")
        r = (found[0], found[1], found[2])
    else:
        r = r_values(second)
    barlat89(law, abs(exponent), r)
    law.hardening = by_rule(deck, card, units, law)
    if exponent < 0:
        chaboche(card.row(2, CHABOCHE), units, law)
    return at


def barlat89(law: Law, exponent: float, r: tuple[float, float, float]) -> None:
    """Take Hill's criterion in place of that of Barlat and Lian (1989), with a note unless they are the same."""
    law.criterion = hill48(r)
    if abs(exponent - 2) > 1e-6:
        law.notes.append("yield: hill48 with the r-values, in place of Barlat and Lian (1989) of exponent "
                         f"{exponent:g}; nearer: dd3 identify blank --criterion yld91 --fix m={exponent:g} --r "
                         + " ".join(f"{angle}:{value:.4g}" for angle, value in zip((0, 45, 90), r)))


def two_surfaces(deck: Deck, card: Card, units: Units, law: Law) -> int:
    """*MAT_125: Yoshida and Uemori's law, Hill's criterion with one r-value."""
    row, second = row_of(card, 0), row_of(card, 1)
    r = abs(row.number("R", 1.0)) or 1.0
    law.criterion = hill48((r, r, r))
    row.leave("the curve serves a calculation of errors only", "HLCID OPT")
    yoshida_uemori(second, row_of(card, 2), units, law)
    if second.number("SC2") not in (0.0, second.number("SC")):
        raise Problem(f"{second.place}: error: SC2 = {second.number('SC2'):g}, another rate than SC; the rate C of "
                      "yoshida_uemori is constant here: expected SC2 = 0 or SC")
    return 0


def two_surfaces_barlat(deck: Deck, card: Card, units: Units, law: Law) -> int:
    """*MAT_226: Yoshida and Uemori's law with the criterion of Barlat and Lian (1989)."""
    row, second = row_of(card, 0), row_of(card, 1)
    barlat89(law, positive(abs(row.number("M")), "M", row.place), r_values(row))
    second.leave("the curve serves a calculation of errors only", "HLCID")
    yoshida_uemori(second, row_of(card, 2), units, law)
    return 2


def two_surfaces_yld2000(deck: Deck, card: Card, units: Units, law: Law) -> int:
    """*MAT_242: Yoshida and Uemori's law with the criterion Yld2000-2d."""
    first, third = row_of(card, 0), row_of(card, 1)
    law.criterion = eight(third, positive(first.number("M"), "M", first.place))
    yoshida_uemori(row_of(card, 2), row_of(card, 3), units, law, first)
    return 3


def eight(row: Row, exponent: float, factor: bool = False) -> str:
    """Return Yld2000-2d by its coefficients; factor: scaled to the rolling direction, unless they are rounded ones."""
    alpha = np.array([row.number(f"ALPHA{k}") for k in range(1, 9)])
    if not alpha.any():
        raise Problem(f"{row.place}: error: all coefficients of Yld2000 are 0")
    if factor and abs((along := float(yld2000_of(alpha, exponent)(np.array([1.0, 0.0, 0.0])))) - 1) > ROUNDED:
        alpha = alpha / along
    return "yld2000 " + " ".join(f"alpha{k}={value:.9g}" for k, value in enumerate(alpha, 1)) + f" m={exponent:g}"


def hill(deck: Deck, card: Card, units: Units, law: Law) -> int:
    """*MAT_122: Hill (1948) by r-values."""
    law.criterion = hill48(r_values(row_of(card, 1)))
    law.hardening = by_rule(deck, card, units, law)
    return 2


def yld2000(deck: Deck, card: Card, units: Units, law: Law) -> int:
    """*MAT_133: Barlat et al. (2003), Yld2000-2d; by measured values, hill48 with the r-values."""
    first, second = row_of(card, 0), row_of(card, 1)
    exponent, at = second.number("A") or 8.0, 2
    first.leave("the stress is integrated in another way", "ITER")
    second.leave(RATES, "C P")
    if exponent < 0:
        at, exponent = 3, -exponent
    if first.number("FIT"):
        at = measured2000(card, at, exponent, law)
    else:
        law.criterion = eight(card.row(at, ROWS[242][1]), exponent, not first.number("ISCALE"))
    rule = second.label("HARD")
    if rule < 0:
        second.leave("HARD < 0 takes the curve", "K E0 N")
        law.hardening = (by_table if -rule in deck.curves.tables else by_curve)(deck, -rule, units, law, second.place)
    elif rule in (0, 1):
        law.hardening = swift(units, law, (second.number("K"), second.number("N"), second.number("E0")), second.place)
    else:
        raise Problem(f"{second.place}: error: the hardening rule HARD = {rule} is not read; expected 1, or the "
                      "negative number of a curve")
    if second.number("A") < 0:
        chaboche(card.row(2, CHABOCHE), units, law)
    return at + 1


def measured2000(card: Card, at: int, exponent: float, law: Law) -> int:
    """Take Hill's criterion in place of Yld2000-2d by measured values; return the number of the last row read."""
    third = card.row(at, "SIG00 SIG45 SIG90 R00 R45 R90")
    fourth = card.optional(at + 1, "SIGXX SIGYY SIGXY DXX DYY DXY")
    r, stress = r_values(third), third.numbers("SIG00 SIG45 SIG90")
    law.criterion = hill48(r)
    command = f"dd3 identify blank --criterion yld2000 --fix m={exponent:g} --r " \
        + " ".join(f"{angle}:{value:.4g}" for angle, value in zip((0, 45, 90), r))
    if all(value > 0 for value in stress):
        command += " --stress " + " ".join(f"{angle}:{value / stress[0]:.4g}"
                                           for angle, value in zip((0, 45, 90), stress))
        both, across = fourth.number("SIGXX"), fourth.number("SIGYY")
        if both > 0 and both == across and not fourth.number("SIGXY"):
            command += f" --biaxial-stress {both / stress[0]:.4g}"
            if fourth.number("DXX"):
                command += f" --biaxial-r {fourth.number('DYY') / fourth.number('DXX'):.4g}"
    fourth.leave("biaxial tension does not enter hill48")
    law.notes.append("yield: hill48 with the r-values, in place of Yld2000-2d by the measured values; nearer: "
                     + command)
    return at + 1


def rolling(card: Card, at: int, axes: np.ndarray, law: Law) -> tuple[float, ...] | None:
    """Return the rolling direction by AOPT, in a row of a material; None where it cannot be read."""
    names = AXES[number_of(card)]
    first, second, third = (card.optional(at + i, names[i]) for i in range(3))
    kind = first.number("AOPT")
    angle = np.radians(first.number("OFFANG") if "OFFANG" in first.names else
                       third.number("BETA") if kind in (0, 3) else 0.0)
    edge, normal = axes
    third.leave("only the rolling direction is taken", "D1 D2 D3")
    if kind == 2:
        vector = np.array(second.numbers("A1 A2 A3"))
    elif kind in (0, 3):
        vector = edge if kind == 0 else np.cross(third.numbers("V1 V2 V3"), normal)
        vector = np.cos(angle) * vector + np.sin(angle) * np.cross(normal, vector)
        if kind == 0:
            law.notes.append("rolling direction: AOPT = 0, along the first edge of the blank's first element"
                             + (f", turned by {np.degrees(angle):g} degrees" if angle else ""))
    else:
        vector = np.zeros(3)
    vector = vector - (vector @ normal) * normal
    if np.linalg.norm(vector) < 1e-12:
        law.notes.append(f"rolling direction: AOPT = {kind:g} is not read, or its vector is 0; it is along x")
        return None
    return tuple(float(value) for value in vector / np.linalg.norm(vector))
