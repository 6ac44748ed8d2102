# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the forming limit diagram of a run.

    dd3 fld cup.out --curve dc06.csv
    dd3 fld cup.out --low-carbon-steel --thinning 0.2 --margin 0.08 --surface upper --output fld.png

Nodes and elements are judged by the forming limit curve of the material: that of --curve, a table with minor and major
logarithmic strain (its form is that of `dd3 identify --help`), or that of forming_limit in *MATERIAL. For low-carbon
steel, by --low-carbon-steel, --n, or grade = low_carbon_steel in *MATERIAL, it is estimated from the thickness and the
exponent n of the hardening law or of --n (Keeler and Brazier 1977). --flc-from-material computes it with the laws of
the run's own material (`dd3 flc`). Without a curve for the material there is no verdict.

The thinning is judged beside the curve, by --thinning, thinning_limit in *MATERIAL, or 0.25, a convention. Elements
beyond the limits that the run follows, the fields forming_limit_ratio and fracture_damage, are marked and listed.

The estimate is the engineering strain (23.3 + 14.13 t) n/0.21 % at plane strain, t in mm, n at most 0.21. Its left
branch is the line of constant thickness, major + minor = const; the slope of its right branch, 0.6, is a convention.
"""

import argparse
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from dataclasses import fields as fields_of
from itertools import cycle, pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dd3.account import Account
from dd3.columns import STRAIN, Column, read_columns
from dd3.command import new_parser
from dd3.errors import Problem
from dd3.fields import AT, Fields
from dd3.material_limits import mark, reached
from dd3.plot.figures import new_figure, save
from dd3.run import read_job
from dd3.sheet import Sheet
from dd3.surface_strain import cell_strains
from dd3.tables import read_text
from dd3.verdict import THINNING

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
    found = [curve_of(fields, material, entries) for material, entries in zip(materials, said)]
    names = " and ".join(material["name"] for material in materials)
    if len(found) == 1 or all(entries == said[0] and found[0] for entries in said[1:]):
        curve = found[0] if found else None
        why = f"no forming limit curve for the material {names}"
        if said and said[0].get("grade"):
            why += ", whose hardening law has no exponent n for the estimate"
    else:
        curve, why = None, f"no forming limit curve for each of the materials {names}"
        if all(found) and "material" in fields.grid["CellData"]:
            numbers = [job["materials"].index(material) + 1 for material in materials]
            return Limits(None, "", thinning, given_by, {number: one for number, one in zip(numbers, found) if one})
    return Limits(curve, "" if curve else why, thinning, given_by)


def entries_of(job: dict[str, Any], name: str) -> dict[str, str]:
    """Return what *MATERIAL says of the limits of a material, by key."""
    return {entry["key"]: entry["text"] for block in job["input"]["blocks"] for entry in block["entries"]
            if block["keyword"].lower() == "material" and block["name"].lower() == name.lower()
            and entry["key"] in ("grade", "forming_limit", "thinning_limit")}


def text_of(job: dict[str, Any], name: str) -> str:
    """Return the block *MATERIAL of a run without its name."""
    entries = [entry for block in job["input"]["blocks"] for entry in block["entries"]
               if block["keyword"].lower() == "material" and block["name"].lower() == name.lower()]
    return "".join(f"  {entry['key']} = {entry['text']}\n" for entry in entries)


def curve_of(fields: Fields, material: dict[str, Any], entries: dict[str, str]) -> Curve | None:
    """Return the curve of a material, None if it says nothing of one."""
    if "forming_limit" in entries:
        points = np.array(entries["forming_limit"].split(), float).reshape(-1, 2)
        return Curve(points[:, 0], points[:, 1], material["name"])
    exponent = exponent_of(material)
    if entries.get("grade", "").lower() != LOW_CARBON or exponent is None:
        return None
    return keeler_brazier(thickness_of(fields), exponent)


def exponent_of(material: dict[str, Any]) -> float | None:
    """Return the exponent n of the hardening law swift, swift_voce or ludwik of a material; None with another law."""
    law = material["hardening"]
    found = (parameter["value"] for parameter in law["parameters"] if parameter["name"] == "n")
    return next(found, None) if law["name"] in WITH_EXPONENT else None


def exponent_in(law: str) -> float | None:
    """Return the exponent n of a hardening law as the input writes it, None with a law without."""
    found = re.search(r"\sn\s*=\s*([^\s]+)", law)
    return float(found[1].lower().replace("d", "e")) if found and law.split()[0].lower() in WITH_EXPONENT else None


def thickness_of(fields: Fields) -> float:
    """Return the median of the initial thickness, mm."""
    thickness = fields.values(0, "thickness")[0]
    return float(np.median(thickness[thickness > 0]))


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


def draw(axes: Axes, strains: Strains, limits: Limits, margin: float, zone: np.ndarray | None) -> None:
    """Draw the diagram, with the zone of each node and element."""
    major, minor, cells = strains.joined()
    if zone is None:
        axes.plot(strains.minor, strains.major, ".", color="0.4")
        axes.plot(cells.minor, cells.major, "x", color="0.6", markersize=3)
    else:
        draw_zones(axes, limits.curves(), zone, major, minor, len(strains.major), margin)
    low, high = axes.get_xlim()
    axes.plot([low, 0, high], [-low, 0, high], color="0.6", linewidth=0.8)
    axes.set(xlim=(low, high), ylim=(min(0, major.min()), None), xlabel="minor strain (logarithmic)",
             ylabel="major strain (logarithmic)")
    axes.grid(True, color="0.9")


def draw_zones(axes: Axes, curves: Sequence[Curve], zone: np.ndarray, major: np.ndarray, minor: np.ndarray, count: int,
               margin: float) -> None:
    """Draw the points in the colours of their zones, the first `count` as nodes, and the curves."""
    for number, name in enumerate(ZONES):
        here = np.flatnonzero(zone == number)
        nodes, elements = here[here < count], here[here >= count]
        if len(here):
            axes.plot(minor[nodes], major[nodes], ".", color=COLOURS[number], label=name)
            axes.plot(minor[elements], major[elements], "x", color=COLOURS[number], markersize=3)
    at = np.linspace(min(-0.3, minor.min()), max(0.3, minor.max()), 200)
    for curve, style in zip(curves, cycle(("-", "-.", ":"))):
        axes.plot(at, curve.limit(at), f"k{style}", linewidth=1.5, label=curve.label)
        axes.plot(at, curve.limit(at) - margin, "k--", linewidth=0.8, label="marginal" if curve is curves[0] else None)
    axes.legend(frameon=False, fontsize=9)


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


def figure(run: str | Path, at: str | float | None = None, surface: str = "middle", criteria: Criteria | None = None,
           account: Account | None = None) -> tuple[Figure, Judged]:
    """Return the forming limit diagram of a run at a step, and what it says.

    at: travel in mm, or a phase (the last step). surface: middle, upper or lower.
    """
    sheet, criteria = Sheet(run), criteria or Criteria()
    step = sheet.last if at is None else sheet.step_at(str(at))
    limits = find_limits(sheet, read_job(sheet.folder), criteria, account)
    strains = strains_of(sheet, step, surface)
    found = judge(strains, limits, criteria.margin)
    drawn, axes = new_figure((8, 5.2))
    draw(axes, strains, limits, criteria.margin, found.zone)
    for limit in reached(sheet, step):
        mark(axes, strains, limit)
        found.said.append(limit.said())
    axes.set_title(sheet.state(step), fontsize=10)
    return drawn, found


def main(words: Sequence[str] | None = None) -> None:
    """Draw the diagram of the command line."""
    parser = new_parser("fld", __doc__)
    parser.add_argument("run", metavar="RUN", help="folder of results")
    parser.add_argument("--at", metavar="PLACE", help=AT)
    parser.add_argument("--surface", choices=["middle", "upper", "lower"], default="middle",
                        help="where the strains are taken (middle)")
    add_options(parser)
    parser.add_argument("--output", default="fld.png", help="picture to write: .png, .svg or .pdf (fld.png)")
    options = vars(parser.parse_args(words))
    output, account = options.pop("output"), Account()
    drawn, found = figure(criteria=take_criteria(options), account=account, **options)
    save(drawn, output, 130)
    print(output, *found.said, *(f"left out: {item}" for item in account.left_out()), sep="\n")
