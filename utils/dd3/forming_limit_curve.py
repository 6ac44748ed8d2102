# SPDX-License-Identifier: GPL-3.0-or-later
"""Forming limit curves: those of tables with minor and major strains, and the estimate of Keeler and Brazier (1977)."""

import math
import re
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from dd3.account import Account
from dd3.columns import STRAIN, Column, read_columns
from dd3.errors import Problem
from dd3.tables import read_text

ZONES = ("no strain", "thickening", "safe", "marginal", "critical")
COLOURS = ("#d0d4d8", "#56b4e9", "#009e73", "#f0e442", "#d55e00")  # safe for the colour-blind
LEAST_STRAIN = 0.01  # major strain below which a point is not judged
RIGHT_SLOPE = 0.6
LARGEST_N = 0.21  # of the correlation
LARGEST = 2.0  # logarithmic strain; larger ones are in per cent
LOW_CARBON = "low_carbon_steel"  # grade in *MATERIAL
WITH_EXPONENT = ("swift", "swift_voce", "ludwik")  # hardening laws with an exponent n
EXPECTED = "strains as fractions, not per cent, or with the unit % in the heading"


class Curve:
    """Limit of the major strain over the minor strain, linear between points; beyond them the end lines go on."""

    def __init__(self, minor: Sequence[float] | np.ndarray, major: Sequence[float] | np.ndarray, label: str) -> None:
        self.minor, self.major, self.label = np.asarray(minor, float), np.asarray(major, float), label

    def same_as(self, other: "Curve") -> bool:
        """Whether another curve has the same points."""
        return np.array_equal(self.minor, other.minor) and np.array_equal(self.major, other.major)

    def limit(self, minor: Any) -> Any:
        """Return the largest major strain."""
        value = np.interp(minor, self.minor, self.major)
        for end, inner, beyond in ((0, 1, np.minimum), (-1, -2, np.maximum)):
            slope = (self.major[end] - self.major[inner]) / (self.minor[end] - self.minor[inner])
            value = value + slope * beyond(minor - self.minor[end], 0.0)
        return value

    def zones(self, major: np.ndarray, minor: np.ndarray, margin: float) -> np.ndarray:
        """Return the zone of each point, an index of ZONES.

        Critical points are above the curve, marginal ones less than `margin` below it. Points with a major strain below
        that of pure shear, -minor, thicken.
        """
        limit = self.limit(minor)
        zone = np.full(np.shape(major), ZONES.index("safe"))
        zone[major < -minor] = ZONES.index("thickening")
        zone[np.maximum(np.abs(major), np.abs(minor)) < LEAST_STRAIN] = ZONES.index("no strain")
        zone[major > limit - margin] = ZONES.index("marginal")
        zone[major > limit] = ZONES.index("critical")
        return zone


def keeler_brazier(thickness: float, exponent: float) -> Curve:
    """Return the curve of Keeler and Brazier for a thickness (mm) and a hardening exponent."""
    plane = math.log(1 + (23.3 + 14.13 * thickness) / 100 * min(exponent, LARGEST_N) / LARGEST_N)
    return Curve([-0.5 * plane, 0.0, 0.4], [1.5 * plane, plane, plane + RIGHT_SLOPE * 0.4],
                 f"Keeler-Brazier, t = {thickness:.3g} mm, n = {exponent:.3g}")


def read_rows(path: str | Path, engineering: bool = False, account: Account | None = None) -> list[Any]:
    """Return the rows of a table with minor and major strain, checked, the minor strain increasing."""
    highest = math.expm1(LARGEST) if engineering else LARGEST
    columns = [Column(f"{name} strain", re.compile(pattern, re.IGNORECASE), STRAIN, low, highest, EXPECTED, engineering)
               for name, pattern, low in (
                   ("minor", r"minor|\bmin\b|nebenform|(?:eps|ε|phi|φ|e)_?2", -0.99 if engineering else -LARGEST),
                   ("major", r"major|\bmax\b|hauptform|(?:eps|ε|phi|φ|e)_?1", -LARGEST))]
    rows = read_columns(path, columns, Account() if account is None else account)
    for line, words, (minor, major) in rows:
        if minor > major:
            raise line.problem(words[0], f"the minor strain, {words[0][0]}, is above the major strain, {words[1][0]}",
                               "the minor strain first, then the major strain, or a heading that names the columns")
        if major <= 0:
            raise line.problem(words[1], f"the major strain, {words[1][0]}, is not positive", "a limit of tension")
    return sorted(rows, key=lambda row: row.values[0])


def read_points(path: str | Path, engineering: bool = False, account: Account | None = None
                ) -> tuple[np.ndarray, np.ndarray]:
    """Return the logarithmic minor and major strains of a table with measured limits."""
    minor, major = np.array([row.values for row in read_rows(path, engineering, account)]).reshape(-1, 2).T
    return (np.log1p(minor), np.log1p(major)) if engineering else (minor, major)


def read_curve(path: str | Path, engineering: bool = False, account: Account | None = None) -> Curve:
    """Read a curve, a table with minor and major strain. Its label is that of a first line `# curve: ...`, by default
    the name of the file."""
    rows = read_rows(path, engineering, account)
    if len(rows) < 2:
        raise Problem(f"{path}: expected at least 2 points of the forming limit curve, got {len(rows)}")
    for before, row in pairwise(rows):
        if row.values[0] == before.values[0]:
            raise row.line.problem(row.words[0],
                                   f"the minor strain {row.words[0][0]} is that of {before.line.where} too",
                                   "one major strain for each minor strain")
    minor, major = np.array([row.values for row in rows]).T
    if engineering:
        minor, major = np.log1p(minor), np.log1p(major)
    label = re.match(r"#\s*curve:\s*(.*\S)", read_text(path))
    return Curve(minor, major, label[1] if label else Path(path).stem)


def exponent_of(material: dict[str, Any]) -> float | None:
    """Return the exponent n of the hardening law swift, swift_voce or ludwik of a material; None with another law."""
    law = material["hardening"]
    found = (parameter["value"] for parameter in law["parameters"] if parameter["name"] == "n")
    return next(found, None) if law["name"] in WITH_EXPONENT else None


def exponent_in(law: str) -> float | None:
    """Return the exponent n of a hardening law as the input writes it, None with a law without."""
    found = re.search(r"\sn\s*=\s*([^\s]+)", law)
    return float(found[1].lower().replace("d", "e")) if found and law.split()[0].lower() in WITH_EXPONENT else None
