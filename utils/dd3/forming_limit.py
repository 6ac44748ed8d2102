# SPDX-License-Identifier: GPL-3.0-or-later
"""Judge the strains of a run by the forming limit curve and the thinning limit of its material."""

import argparse
from dataclasses import dataclass, field
from dataclasses import fields as fields_of
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dd3.account import Account
from dd3.errors import Problem
from dd3.fields import Fields
from dd3.forming_limit_curve import LOW_CARBON, ZONES, Curve, exponent_of, keeler_brazier, read_curve
from dd3.sheet import Sheet
from dd3.surface_strain import cell_strains
from dd3.verdict import THINNING

# Part of the nodes of a thinner part of a tailored sheet at least, and ratio of the median to its thickness.
THIN, VARIES = 0.1, 1.05


@dataclass
class Limits:
    """What a sheet is judged by: the curve, or why there is none; the largest thinning, and who gives it; the curves by
    the number of the material where materials differ, `curve` is None then."""

    curve: Curve | None
    why: str
    thinning: float
    given_by: str
    by_material: dict[int, Curve] = field(default_factory=dict)

    def curves(self) -> list[Curve]:
        """Return all curves."""
        return [self.curve] if self.curve else list(self.by_material.values())


@dataclass(frozen=True)
class Criteria:
    """What a sheet is to be judged by, where the material of the run does not say it: a file with the measured forming
    limit curve, in engineering strains or not; the imperfection of a groove, for the curve of the run's own material by
    Marciniak and Kuczynski; that the material is low-carbon steel, with the exponent n of its hardening, for an
    estimate of the curve; the width of the marginal zone; the largest thinning, a fraction."""

    curve: str | Path | None = None
    engineering: bool = False
    flc_from_material: float | None = None
    low_carbon_steel: bool = False
    n: float | None = None
    margin: float = 0.1
    thinning: float | None = None

    def __post_init__(self) -> None:
        if (self.n is not None and not self.n > 0) or not self.margin >= 0:
            raise Problem("--n takes a positive number, --margin one that is not negative")
        if self.thinning is not None and not 0 < self.thinning < 1:
            raise Problem("--thinning takes a fraction between 0 and 1, 0.2 for 20 %")
        if self.engineering and not self.curve:
            raise Problem("--engineering goes with --curve")
        if self.curve and (self.low_carbon_steel or self.n):
            raise Problem("--curve goes without --low-carbon-steel and --n")
        if self.flc_from_material is not None:
            if not 0 < self.flc_from_material < 1:
                raise Problem("--flc-from-material takes a number between 0 and 1, such as 0.996")
            if self.curve or self.low_carbon_steel or self.n:
                raise Problem("--flc-from-material goes without --curve, --low-carbon-steel and --n")


def find_limits(fields: Fields, job: dict[str, Any], criteria: Criteria, account: Account | None = None) -> Limits:
    """Return the limits by criteria and by the materials of a run."""
    materials = [material for material in job["materials"] if material.get("elements", 1)]
    said = [entries_of(job, material["name"]) for material in materials]
    thinning, given_by = criteria.thinning, "--thinning"
    if thinning is None:
        given = [float(entries["thinning_limit"]) for entries in said if "thinning_limit" in entries]
        thinning, given_by = (min(given), "*MATERIAL") if given else (THINNING, "default; --thinning")
    if criteria.curve:
        return Limits(read_curve(criteria.curve, criteria.engineering, account), "", thinning, given_by)
    if criteria.flc_from_material:
        texts = {text_of(job, material["name"]) for material in materials}
        if len(texts) != 1:
            raise Problem("--flc-from-material: the sheet has several materials")
        # Here, so that the library of the laws is loaded only where it is wanted.
        from dd3.marciniak_kuczynski import curve_of_text
        return Limits(curve_of_text(texts.pop(), materials[0]["name"], criteria.flc_from_material), "", thinning,
                      given_by)
    if criteria.n or criteria.low_carbon_steel:
        exponent = criteria.n or next(filter(None, map(exponent_of, materials)), None)
        if exponent is None:
            raise Problem("--low-carbon-steel: the hardening law has no exponent n; give --n")
        return Limits(keeler_brazier(thickness_of(fields), exponent), "", thinning, given_by)
    numbers = [job["materials"].index(material) + 1 for material in materials]
    found = [curve_of(fields, material, entries, number if len(materials) > 1 else None)
             for number, material, entries in zip(numbers, materials, said)]
    names = " and ".join(material["name"] for material in materials)
    if len(found) < 2 or (found[0] and all(one and one.same_as(found[0]) for one in found[1:])):
        curve = found[0] if found else None
        why = f"no forming limit curve for the material {names}"
        if said and said[0].get("grade"):
            why += ", whose hardening law has no exponent n for the estimate"
    else:
        curve, why = None, f"no forming limit curve for each of the materials {names}"
        if all(found) and "material" in fields.grid["CellData"]:
            return Limits(None, "", thinning, given_by, {number: one for number, one in zip(numbers, found) if one})
    return Limits(curve, "" if curve else why, thinning, given_by)


def entries_of(job: dict[str, Any], name: str) -> dict[str, str]:
    """Return what *MATERIAL says of the limits of a material, by key."""
    return {entry["key"]: entry["text"] for block in job["input"]["blocks"] for entry in block["entries"]
            if block["keyword"].lower() == "material" and block["name"].lower() == name.lower()
            and entry["key"] in ("grade", "forming_limit", "thinning_limit")}


def text_of(job: dict[str, Any], name: str) -> str:
    """Return the block *MATERIAL of a run without its name and the keys that its input leaves out."""
    entries = [entry for block in job["input"]["blocks"] for entry in block["entries"]
               if block["keyword"].lower() == "material" and block["name"].lower() == name.lower()
               and not entry.get("default")]
    return "".join(f"  {entry['key']} = {entry['text']}\n" for entry in entries)


def curve_of(fields: Fields, material: dict[str, Any], entries: dict[str, str], number: int | None = None
             ) -> Curve | None:
    """Return the curve of a material, None if it says nothing of one. number: of the material, if there are others."""
    if "forming_limit" in entries:
        points = np.array(entries["forming_limit"].split(), float).reshape(-1, 2)
        return Curve(points[:, 0], points[:, 1], material["name"])
    exponent = exponent_of(material)
    if entries.get("grade", "").lower() != LOW_CARBON or exponent is None:
        return None
    return keeler_brazier(thickness_of(fields, number), exponent)


def thickness_of(fields: Fields, number: int | None = None) -> float:
    """Return the thickness of the blank, mm, of a material by its number or of the sheet: the median or, of a tailored
    sheet, that of the thinner part, whose limit is lower."""
    thickness = fields.values(0, "thickness")[0] / (1 - fields.values(0, "thinning")[0])  # of a sheet taken over too
    if number is not None and "material" in fields.grid["PointData"]:
        thickness = thickness[fields.values(0, "material")[0] == number]
    thin, middle = np.quantile(thickness[thickness > 0], [THIN, 0.5])
    return float(thin if middle > VARIES * thin else middle)


@dataclass
class Strains:
    """Major and minor strain of the nodes and of the elements, and their thinning; number of the material, 0 between
    materials, None where the sheet has one."""

    major: np.ndarray
    minor: np.ndarray
    thinning: np.ndarray
    at_cells: "Strains | None" = None
    material: np.ndarray | None = None

    def joined(self) -> "tuple[np.ndarray, np.ndarray, Strains]":
        """Return major and minor strains of nodes and elements, and those of the elements alone."""
        cells = self.at_cells or Strains(*np.zeros((3, 0)))
        return np.concatenate([self.major, cells.major]), np.concatenate([self.minor, cells.minor]), cells

    def of_material(self, number: int) -> np.ndarray:
        """Return whether each of the joined nodes and elements is of a material or lies at one of its elements."""
        both = [part.material for part in (self, self.at_cells) if part is not None and part.material is not None]
        joined: np.ndarray = np.isin(np.concatenate(both), (0, number))
        return joined

    def largest_thinning(self) -> float:
        """Return the largest thinning of nodes and elements."""
        cells = self.at_cells.thinning if self.at_cells else np.zeros(0)
        return float(max(self.thinning.max(), cells.max(initial=0.0)))


def strains_of(sheet: Sheet, step: int, surface: str) -> Strains:
    """Return the strains of a sheet at its lower or upper face or its middle."""
    nodes = [sheet.values(step, f"{name}_strain_{surface}")[0] for name in ("major", "minor")]
    major, minor = cell_strains(sheet, step, surface)
    at_cells = "thinning" in sheet.grid["CellData"] if "CellData" in sheet.grid else False
    thinning = sheet.values(step, "thinning", True)[0] if at_cells else 1 - np.exp(-major - minor)
    material = [sheet.values(step, "material", cells)[0] if "material" in sheet.grid["PointData"] else None
                for cells in (False, True)]
    return Strains(nodes[0], nodes[1], sheet.values(step, "thinning")[0],
                   Strains(major, minor, thinning, material=material[1]), material[0])


class Judged(NamedTuple):
    """The zone of each node and element, None without a curve; the verdict by the curve, and that by the thinning."""

    zone: np.ndarray | None
    said: list[str]

    @property
    def critical(self) -> int | None:
        """The number of critical nodes and elements, None without a curve."""
        return None if self.zone is None else int((self.zone == ZONES.index("critical")).sum())


def judge(strains: Strains, limits: Limits, margin: float) -> Judged:
    """Judge the strains of a sheet."""
    major, minor, cells = strains.joined()
    if limits.by_material:
        zone, said = np.zeros(len(major), int), []
        for number, curve in limits.by_material.items():
            here = strains.of_material(number)
            own = curve.zones(major[here], minor[here], margin)
            zone[here] = np.maximum(zone[here], own)
            said.append(by_curve(curve, own, major[here], minor[here], int(here[:len(strains.major)].sum())))
        verdict = "; ".join(said)
    elif limits.curve is None:
        zone = None
        verdict = f"no verdict: {limits.why}; give --curve, --low-carbon-steel, or forming_limit in *MATERIAL"
    else:
        zone = limits.curve.zones(major, minor, margin)
        verdict = by_curve(limits.curve, zone, major, minor, len(strains.major))
    return Judged(zone, [verdict, thinned(strains, cells, limits)])


def by_curve(curve: Curve, zone: np.ndarray, major: np.ndarray, minor: np.ndarray, count: int) -> str:
    """Return the verdict by the curve on nodes, the first `count`, and elements."""
    critical = zone == ZONES.index("critical")
    room = (curve.limit(minor) - major)[zone > 0]
    nearest = f"; smallest distance below the curve {room.min():.3g}" if room.size and not critical.any() else ""
    elements = f", {critical[count:].sum()} of {len(zone) - count} elements critical" if len(zone) > count else ""
    return f"{critical[:count].sum()} of {count} nodes critical{elements} by the curve {curve.label}{nearest}"


def thinned(strains: Strains, cells: Strains, limits: Limits) -> str:
    """Return the verdict by the thinning."""
    parts = [f"{(values > limits.thinning).sum()} of {len(values)} {name}"
             for name, values in (("nodes", strains.thinning), ("elements", cells.thinning)) if len(values)]
    return (f"thinning above {100 * limits.thinning:.3g} % ({limits.given_by}): {', '.join(parts)}; largest "
            f"{100 * strains.largest_thinning():.3g} %")


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of the limits."""
    parser.add_argument("--curve", metavar="FILE", help="measured forming limit curve of the material")
    parser.add_argument("--engineering", action="store_true", help="the strains of --curve are engineering strains")
    parser.add_argument("--low-carbon-steel", action="store_true",
                        help="the material is low-carbon steel: estimate its curve by Keeler and Brazier")
    parser.add_argument("--n", type=float, help="hardening exponent of this estimate")
    parser.add_argument("--flc-from-material", type=float, metavar="F0",
                        help="compute the curve of the run's material by Marciniak and Kuczynski with this ratio of "
                             "the thicknesses of groove and sheet, such as 0.996 (`dd3 flc`)")
    parser.add_argument("--margin", type=float, default=0.1, help="width of the marginal zone in major strain (0.1)")
    parser.add_argument("--thinning", type=float, metavar="LIMIT",
                        help=f"largest thinning allowed (that of *MATERIAL, or {THINNING:g})")


def take_criteria(options: dict[str, Any]) -> Criteria:
    """Remove the options of the limits from parsed ones; return them."""
    return Criteria(**{entry.name: options.pop(entry.name) for entry in fields_of(Criteria)})
