# SPDX-License-Identifier: GPL-3.0-or-later
"""Fracture by GISSMO of LS-DYNA, *MAT_ADD_EROSION with IDAM = 1 and *MAT_ADD_DAMAGE_GISSMO, as `fracture = table`.

The strain to failure LCSDG over the triaxiality, or a table of such curves over the Lode parameter L = 27 J3/(2 q^3),
and the exponent DMGEXP are the law here, dD = n/p_f D^(1 - 1/n) dp, the normalised Lode angle being
1 - 2 acos(L)/pi. What couples the damage to the stress, and the factors on the strain, are left out.
"""

import math

import numpy as np

from dd3.dyna.cards import TEN, Card, plain, split
from dd3.dyna.curves import Curve
from dd3.dyna.deck import Deck
from dd3.dyna.hardening import Law
from dd3.errors import Problem

EROSION_KEYWORD = "*MAT_ADD_EROSION"
DAMAGE = "LCSDG ECRIT DMGEXP DCRIT FADEXP LCREGD"
EROSION = ("MID EXCL MXPRES MNEPS EFFEPS VOLEPS NUMFIP NCS", "MNPRES SIGP1 SIGVM MXEPS EPSSH SIGTH IMPULSE FAILTM",
           f"IDAM DMGTYP {DAMAGE}", "SIZFLG REFSZ NAHSV LCSRS SHRF BIAXF LCDLIM MIDFAIL")
LIMITS = "LCFLD NSFF EPSTHIN ENGCRT RADCRT LCEPS12 LCEPS13 LCEPSMX"  # row of *MAT_ADD_EROSION from R11 on
GISSMO = ("MID unused DTYP REFSZ NUMFIP", f"{DAMAGE} INSTF", "LCSRS SHRF BIAXF LCDLIM MIDFAIL HISVN SOFT LP2BI",
          "RGTR1 RGTR2")
MOST_ANGLES = 9  # of a table
LARGEST_EXPONENT = 10.0
UNCOUPLED = "the damage has no influence on the stress here, and no element is deleted"


def take_fracture(deck: Deck, number: int, law: Law) -> None:
    """Take the fracture that a deck adds to a material, or give the reason why not."""
    for card in deck.damages:
        if card.first(0) == number:
            if forming_limit(deck, card, law):
                continue
            if why := unavailable(deck, card):
                card.leave(why)
            else:
                take(deck, card, law)


def value(card: Card, i: int, names: str, name: str) -> float:
    """Return a number of a card without counting it as read, 0 where there is none."""
    words = split(card.lines[i][1], TEN, card.least) if i < len(card) else []
    k = names.split().index(name)
    return plain(words[k], card.values, card.place_of(i)) if k < len(words) and words[k] else 0.0


def forming_limit(deck: Deck, card: Card, law: Law) -> bool:
    """Take the forming limit curve of *MAT_ADD_EROSION without damage, engineering strains in per cent; check whether
    there is one."""
    number = value(card, 3, LIMITS, "LCFLD") if card.keyword == EROSION_KEYWORD else 0.0
    if number not in deck.curves.cards or value(card, 2, EROSION[2], "IDAM"):
        return False
    rows = [card.row(i, names) for i, names in enumerate((*EROSION[:2], "IDAM", LIMITS))]
    rows[0].number("MID")
    rows[3].number("LCFLD")
    for row in rows[:2]:
        row.leave("of this keyword only GISSMO and the forming limit curve are available")
    rows[0].leave(UNCOUPLED, "NUMFIP")
    rows[3].leave(UNCOUPLED)
    curve = deck.curves.get(int(number), rows[3].place)
    if min(curve.x.min(), curve.y.min()) <= -100:
        raise Problem(f"{rows[3].place}: error: a forming limit curve with strains of -100 % or less")
    law.forming_limit = " ".join(f"{np.log1p(x / 100):.9g} {np.log1p(y / 100):.9g}" for x, y in zip(curve.x, curve.y))
    law.notes.append("forming limit curve: LCFLD, from engineering strains in per cent; no element is deleted here")
    return True


def unavailable(deck: Deck, card: Card) -> str:
    """Return why a fracture cannot be taken, nothing if it can."""
    erosion = card.keyword == EROSION_KEYWORD
    kind = value(card, 2, EROSION[2], "IDAM") if erosion else 1
    if kind != 1:
        return "its criteria are not available, GISSMO with IDAM = 1 is" if not kind else \
            f"the damage IDAM = {kind:g} is not available, GISSMO with IDAM = 1 is"
    drive = value(card, 2, EROSION[2], "DMGTYP") if erosion else value(card, 0, GISSMO[0], "DTYP")
    row, names = (2, EROSION[2]) if erosion else (1, GISSMO[1])
    number, exponent = value(card, row, names, "LCSDG"), value(card, row, names, "DMGEXP") or 1.0
    if drive >= 10:
        return f"damage by a history variable, {drive:g}, is not available"
    if not 1 <= exponent <= LARGEST_EXPONENT:
        return f"DMGEXP = {exponent:g} is not available; 1 to {LARGEST_EXPONENT:g} is"
    if number not in deck.curves.cards and number not in deck.curves.tables:
        return f"LCSDG = {number:g} is no curve and no table of curves"
    if number in deck.curves.tables and len(deck.curves.tables[int(number)][0].filled()) - 1 > MOST_ANGLES:
        return f"a table of more than {MOST_ANGLES} Lode parameters is not available"
    return ""


def take(deck: Deck, card: Card, law: Law) -> None:
    """Take a fracture that can be taken."""
    erosion = card.keyword == EROSION_KEYWORD
    rows = [card.optional(i, names) for i, names in enumerate(EROSION if erosion else GISSMO)]
    rows[0].number("MID")
    if erosion:
        rows[2].numbers("IDAM DMGTYP")
        for row, names in ((rows[0], "EXCL MXPRES MNEPS EFFEPS VOLEPS NCS"), (rows[1], "")):
            row.leave("of this keyword only GISSMO is available", names)
    else:
        rows[0].number("DTYP")
        rows[0].leave("a size for output", "REFSZ")
        rows[1].leave(UNCOUPLED, "INSTF")
    damage = rows[2 if erosion else 1]
    number, exponent = damage.label("LCSDG"), damage.number("DMGEXP") or 1.0
    rows[0].leave(UNCOUPLED, "NUMFIP")
    damage.leave(UNCOUPLED, "ECRIT DCRIT FADEXP")
    damage.leave("the strain is that of LCSDG: scale it to the size of the elements", "LCREGD")
    for row in rows[2 + erosion:]:
        row.leave("factors on the strain to failure, and exceptions, are not available")
    blocks = blocks_of(deck, number, damage.place)
    several = len(blocks) > 1
    law.fracture = "table" + "".join(f" lode{k}={lode:.9g}" for k, (lode, _) in enumerate(blocks, 1) if several)
    law.fracture += f" exponent={exponent:.6g}" if exponent != 1 else ""
    law.fracture += "".join(" &\n    " + " ".join(f"{x:.9g}:{y:.9g}" for x, y in points) for _, points in blocks)
    law.notes.append("fracture: by GISSMO; beyond the points of LCSDG the strain is constant here"
                     + ("; the Lode parameter of its table is taken as 27 J3/(2 q^3)" if several else ""))


def blocks_of(deck: Deck, number: int, place: str) -> list[tuple[float, np.ndarray]]:
    """Return normalised Lode angles and points of triaxiality and strain; the blocks begin at the same triaxiality."""
    if number in deck.curves.tables:
        curves = [(lode, deck.curves.get(label, place)) for lode, label, _ in
                  sorted(deck.curves.rows(number), key=lambda row: row[0])]
    else:
        curves = [(0.0, deck.curves.get(number, place))]
    first = min(float(curve.x[0]) for _, curve in curves)
    return [(angle_of(lode, place), points_of(curve, first)) for lode, curve in curves]


def angle_of(lode: float, place: str) -> float:
    """Return the normalised Lode angle of a Lode parameter."""
    if not -1 <= lode <= 1:
        raise Problem(f"{place}: error: a Lode parameter {lode:g}; expected -1 to 1")
    return 1 - 2 * math.acos(lode) / math.pi


def points_of(curve: Curve, first: float) -> np.ndarray:
    """Return triaxialities and strains of a curve, from a triaxiality on."""
    wrong = np.flatnonzero(~(curve.y > 0))
    if wrong.size:
        raise Problem(f"{curve.places[wrong[0]]}: error: a strain to failure {curve.y[wrong[0]]:g}; expected > 0")
    points = np.column_stack([curve.x, curve.y])
    return points if points[0, 0] <= first else np.vstack([[first, points[0, 1]], points])
