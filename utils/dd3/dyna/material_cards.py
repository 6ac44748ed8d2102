# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials as cards of LS-DYNA: the inverse of what `dd3 import` reads (LS-DYNA Keyword User's Manual, Vol. II).

Of a criterion that is Hill's or Yld2000-2d in plane stress the card has the same yield stresses and r-values; hardening
laws without a form of LS-DYNA become curves. What no card has is an error, which names the law and the nearest card;
`nearest` takes that card.
"""

import textwrap
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dd3.dyna import fields, fracture_cards
from dd3.dyna.material_laws import KEYWORDS, LABELS, SOLIDS, CardOptions, Laws
from dd3.dyna.material_rows import ROWS_OF
from dd3.errors import LOG, Problem
from dd3.laws import Material
from dd3.tools.set_material import found


@dataclass
class MaterialCards:
    """Cards of a material: lines, number and keyword of the card, notes on how it was written, and what was left out.
    `anisotropic`: whether it needs axes; `scale`: plastic strain in LS-DYNA over that here."""

    lines: list[str]
    number: int
    keyword: str
    notes: list[str]
    left_out: list[str]
    anisotropic: bool
    scale: float


def cards_of(material: Material, options: CardOptions | None = None) -> MaterialCards:
    """Return a material as cards of LS-DYNA. Raises Problem where no card has all of it, unless options take the
    nearest."""
    options = options or CardOptions()
    laws = Laws(material, options)
    possible = laws.candidates()
    number = options.card or possible[0]
    if number not in possible:
        raise Problem(f"{material.name}: *MAT_{number:03d} does not have yield = {laws.criterion.name}, hardening = "
                      f"{laws.law.name} with the other laws of *MATERIAL; expected "
                      + " or ".join(f"*MAT_{one:03d}" for one in possible))
    keyword = f"*MAT_{KEYWORDS[number]}" + "_ECHANGE" * (number == 37 and laws.has_echange())
    rows = ROWS_OF[number](laws, number)
    if laws.losses and not options.nearest:
        raise Problem(f"{material.name}: no card of LS-DYNA has all of this material; nearest: *MAT_{number:03d} "
                      f"({keyword}) with\n" + "\n".join(f"  {loss}" for loss in laws.losses)
                      + "\n  --nearest writes it")
    if not laws.is_isotropic:
        laws.notes.append("for shells: of plane stress; parameters of the shears 23 and 31 have no field")
    laws.notes += laws.said_of_curves()
    more = limits(laws)
    said = [line for entry in (f"*MATERIAL {material.name}", *(" = ".join(pair) for pair in laws.block.values))
            for line in textwrap.wrap(entry, fields.TITLE, initial_indent="$ ", subsequent_indent="$   ")]
    return MaterialCards([*said, f"{keyword}_TITLE", material.name[:fields.TITLE], *rows, *laws.tail, *more], number,
                         keyword, laws.notes, laws.losses, number not in (*SOLIDS, 37, 125), laws.scale)


def limits(laws: Laws) -> list[str]:
    """Return the cards of fracture and of the forming limit curve."""
    lines: list[str] = []
    name, mid, label = laws.material.name, laws.options.mid, LABELS * laws.options.mid + LABELS // 2
    if laws.fracture.name != "none":
        lines, said = fracture_cards.gissmo(laws.fracture, mid, label, name, laws.scale)
        laws.notes += said
    if points := laws.block.value("forming_limit"):
        pairs = np.array([float(word) for word in points.split()]).reshape(-1, 2)
        more, said = fracture_cards.forming_limit(pairs, mid, label + LABELS // 2 - 1, name, laws.options.erosion)
        lines += more
        laws.notes += said
    for key in ("thinning_limit", "grade"):
        if laws.block.value(key):
            laws.notes.append(f"{key}: left out; dd3 fld and dd3 report judge by it")
    return lines


def report(cards: MaterialCards, name: str, mid: int) -> None:
    """Log the card of a material, how it was written, and what was left out."""
    LOG.info(f"{name}: *MAT_{cards.number:03d} ({cards.keyword}), MID = {mid}")
    for note in cards.notes:
        LOG.info(f"note: {note}")
    for one in cards.left_out:
        LOG.warning(f"left out: {one}")


def export_material(source: str | Path | Material, target: str | Path, name: str | None = None,
                    options: CardOptions | None = None) -> MaterialCards:
    """Write a material as cards of LS-DYNA; return them.

    source: a material, a file with *MATERIAL, or the name of one of the library. name: that of the block, where a file
    has several. Raises Problem where no card has all of it, unless options take the nearest.
    """
    options = options or CardOptions()
    material = source if isinstance(source, Material) else Material(file=found(Path(source)), name=name)
    cards = cards_of(material, options)
    target = Path(target)
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text("\n".join(["*KEYWORD", f"$ Units: {options.units}", *cards.lines, "*END", ""]), encoding="utf-8")
    report(cards, material.name, options.mid)
    LOG.info(f"{target}: units {options.units}")
    return cards
