# SPDX-License-Identifier: GPL-3.0-or-later
"""Fracture and forming limits of a material as cards of LS-DYNA.

`fracture` is *MAT_ADD_DAMAGE_GISSMO with DTYP = 0: damage is accumulated, without influence on the stress and without
failure of elements, as here. A table over the Lode angle gets further angles: LS-DYNA interpolates over the Lode
parameter L = sin(pi/2 theta). The forming limit curve is one of engineering strains in per cent, as LCFLD takes it.
"""

from itertools import pairwise

import numpy as np

from dd3.dyna.damage import EROSION, GISSMO, LIMITS, MOST_ANGLES
from dd3.dyna.fields import curve, row, table
from dd3.dyna.law_words import Words
from dd3.identify.fracture import stress_of

INTERVALS = 1000  # LCINT
FLAT = 1.0  # triaxiality by which the ends go on, as curves of LS-DYNA go on by their last slope
TRIAXIALITIES = np.linspace(-0.4, 1.2, 81)  # of a law
ANGLES = np.linspace(-1, 1, MOST_ANGLES)
LARGEST = 10.0  # strain to fracture
BRACKET = 1e-3  # of the law of Hosford and Coulomb, below which there is no fracture
Blocks = list[tuple[float, np.ndarray]]  # normalised Lode angle, points of triaxiality and strain


def hosford_coulomb(law: Words, triaxiality: np.ndarray, lode: float) -> np.ndarray:
    """Return the strains to fracture of Mohr and Marcadet (2015)."""
    a, b, c, n = law["a"], law["b"], law["c"], law.values.get("n", 0.1)
    f1, f2, f3 = stress_of(0.0, lode)
    g = (((f1 - f2)**a + (f2 - f3)**a + (f1 - f3)**a) / 2)**(1 / a)
    inner = np.maximum(g + c * (2 * triaxiality + f1 + f3), BRACKET * (1 + c))
    return np.asarray(np.minimum(b * ((1 + c) / inner)**(1 / n), LARGEST))


def blocks_of(law: Words) -> Blocks:
    """Return the strains to fracture of a law in blocks over the Lode angle."""
    if law.name == "hosford_coulomb":
        return [(float(lode), np.column_stack([TRIAXIALITIES, hosford_coulomb(law, TRIAXIALITIES, float(lode))]))
                for lode in ANGLES]
    angles = [law[f"lode{k}"] for k in range(1, MOST_ANGLES + 1) if f"lode{k}" in law.values] or [0.0]
    points, first = np.array(law.pairs), law.pairs[0][0]
    starts = [i for i, x in enumerate(points[:, 0]) if x == first]
    parts = np.split(points, starts[1:])
    return sorted(zip(angles, parts), key=lambda one: one[0])


def refined(blocks: Blocks) -> Blocks:
    """Return the blocks with further ones between them, straight over the Lode angle, where their distance in the Lode
    parameter is largest."""
    blocks = list(blocks)
    while 1 < len(blocks) < MOST_ANGLES:
        angles = np.array([lode for lode, _ in blocks])
        i = int(np.argmax(np.diff(angles)))
        (low, before), (high, after) = blocks[i:i + 2]
        x = np.unique(np.concatenate([before[:, 0], after[:, 0]]))
        y = (np.interp(x, *before.T) + np.interp(x, *after.T)) / 2
        blocks.insert(i + 1, ((low + high) / 2, np.column_stack([x, y])))
    return blocks


def flat_ends(points: np.ndarray) -> np.ndarray:
    """Return points with constant strains before the first and beyond the last."""
    (x0, y0), (x1, y1) = points[0], points[-1]
    return np.vstack([[x0 - FLAT, y0], points, [x1 + FLAT, y1]])


def gissmo(law: Words, material: int, number: int, title: str, scale: float) -> tuple[list[str], list[str]]:
    """Return the cards of a law of fracture, with curves from a number on, and what is to be said.

    scale: of the plastic strain in LS-DYNA over that here.
    """
    blocks = refined(blocks_of(law))
    exponent = law.values.get("exponent", 1.0)
    several = len(blocks) > 1
    lines = ["*MAT_ADD_DAMAGE_GISSMO_TITLE", f"{title}: fracture", *row(GISSMO[0], {"MID": material, "DTYP": 0}),
             *row(GISSMO[1], {"LCSDG": number, "DMGEXP": exponent}), *row(GISSMO[2], {})]
    if several:
        rows = [(float(np.sin(np.pi / 2 * lode)), number + k) for k, (lode, _) in enumerate(blocks, 1)]
        lines += table(number, f"{title}: strains to fracture over the Lode parameter", rows)
    for k, (lode, points) in enumerate(blocks, int(several)):
        lines += curve(number + k, f"{title}: strain to fracture over the triaxiality"
                       + (f", Lode angle {lode:g}" if several else ""), flat_ends(points) * (1, scale), INTERVALS)
    said = ["fracture: *MAT_ADD_DAMAGE_GISSMO, DTYP = 0: no influence on the stress, no element is deleted"]
    if law.name == "hosford_coulomb":
        said.append(f"fracture: hosford_coulomb as a table at every {TRIAXIALITIES[1] - TRIAXIALITIES[0]:.2g} of the "
                    f"triaxiality and {ANGLES[1] - ANGLES[0]:g} of the Lode angle, between them off by up to "
                    f"{100 * table_error(law, blocks):.2g} %")
    return lines, said


def table_error(law: Words, blocks: Blocks) -> float:
    """Return the largest relative error of a table for tension, triaxialities of 0 to 0.8, below strains of 3."""
    found = 0.0
    at = np.linspace(0, 0.8, 161)
    for (low, before), (high, after) in pairwise(blocks):
        low_l, high_l = np.sin(np.pi / 2 * np.array([low, high]))
        for part in (0.25, 0.5, 0.75):
            lode = low + part * (high - low)
            weight = (np.sin(np.pi / 2 * lode) - low_l) / (high_l - low_l)
            there = hosford_coulomb(law, at, lode)
            here = (1 - weight) * np.interp(at, *before.T) + weight * np.interp(at, *after.T)
            found = max(found, float(np.abs(here / there - 1)[there < 3].max(initial=0.0)))
    return found


def forming_limit(points: np.ndarray, material: int, number: int, title: str, erosion: bool
                  ) -> tuple[list[str], list[str]]:
    """Return the forming limit curve, logarithmic minor and major strains (n, 2), and what is to be said; erosion:
    elements beyond it are deleted."""
    lines = curve(number, f"{title}: forming limit, engineering strains in per cent", 100 * np.expm1(points))
    if not erosion:
        return lines, [f"forming limit curve: *DEFINE_CURVE {number}, engineering strains in per cent, which no card "
                       "uses; erosion writes it as LCFLD of *MAT_ADD_EROSION, which deletes elements"]
    lines = ["*MAT_ADD_EROSION_TITLE", f"{title}: forming limit", *row(EROSION[0], {"MID": material}),
             *row(EROSION[1], {}), *row("IDAM" + 6 * " unused" + " LCREGD", {"IDAM": 0}),
             *row(LIMITS, {"LCFLD": number}), *lines]
    return lines, [f"forming limit curve: LCFLD = {number} of *MAT_ADD_EROSION: shells beyond it are deleted"]
