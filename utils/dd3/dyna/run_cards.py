# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts, sections and materials of the sheet of a run as cards of LS-DYNA."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from dd3.dyna.fields import TITLE, row
from dd3.dyna.material_cards import MaterialCards, cards_of, report
from dd3.dyna.material_laws import SOLIDS, CardOptions
from dd3.errors import LOG, Problem
from dd3.forming_limit import text_of
from dd3.laws import Material

SHEAR = 0.833  # factor of the shear of shells


@dataclass
class RunCards:
    """Cards of a run: lines; whether a material needs axes; by part the plastic strain in LS-DYNA over that here."""

    lines: list[str]
    anisotropic: bool = False
    scales: dict[int, float] = field(default_factory=dict)

    def scale(self, part: np.ndarray) -> np.ndarray:
        """Return the factors on the plastic strains of elements by their parts."""
        return np.array([self.scales.get(int(number), 1.0) for number in part])


def run_cards(job: dict[str, Any], numbers: Sequence[int], options: CardOptions, layers: tuple[int, float] | None,
              folder: Path) -> RunCards:
    """Return parts, section and materials of a run; a material that no card has is left out with a warning.

    numbers: those of the materials. layers: of shells, points through the thickness, and the mean thickness. folder:
    of the results, beside which the input file is.
    """
    found = RunCards(section(layers))
    for number in map(int, numbers):
        name = job["materials"][number - 1]["name"]
        found.lines += ["*PART", name[:TITLE], *row("PID SECID MID", {"PID": number, "SECID": 1, "MID": number})]
        try:
            cards = material_of(job, name, replace(options, mid=number), folder)
        except Problem as problem:
            LOG.warning(f"left out: the card of the material {problem}")
            continue
        report(cards, name, number)
        found.lines += cards.lines
        found.anisotropic |= cards.anisotropic
        found.scales[number] = cards.scale
        if layers is None and cards.number not in SOLIDS:
            LOG.warning(f"{name}: {cards.keyword} is a card for shells; --shells writes the mid-surface")
    return found


def material_of(job: dict[str, Any], name: str, options: CardOptions, folder: Path) -> MaterialCards:
    """Return the cards of a material of a run; files that it names are relative to its input file."""
    def placed(word: re.Match[str]) -> str:
        beside = folder.absolute().parent / word[2]
        return f'{word[1]}"{beside if beside.is_file() else word[2]}"'
    text = re.sub(r"""(file\s*=\s*)["']?([^"'\s]+)["']?""", placed, text_of(job, name))
    return cards_of(Material(f"*MATERIAL {name}\n{text}"), options)


def section(layers: tuple[int, float] | None) -> list[str]:
    """Return the section of the sheet."""
    if layers is None:
        return ["*SECTION_SOLID", *row("SECID ELFORM", {"SECID": 1, "ELFORM": 1})]
    points, thickness = layers
    return ["*SECTION_SHELL", *row("SECID ELFORM SHRF NIP", {"SECID": 1, "ELFORM": 16, "SHRF": SHEAR, "NIP": points}),
            *row("T1 T2 T3 T4", dict.fromkeys(("T1", "T2", "T3", "T4"), thickness))]


def rolling_angles(rolling: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Return the angles from the first edges of shells to the rolling direction about their normals, degrees.

    rolling: directions (m, 3). corners: (m, 4, 3).
    """
    edge = corners[:, 1] - corners[:, 0]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    edge -= (edge * normal).sum(axis=1)[:, None] * normal
    across = np.cross(normal, edge)
    return np.asarray(np.degrees(np.arctan2((across * rolling).sum(axis=1), (edge * rolling).sum(axis=1))))
