# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the forming limit diagram of a run.

    dd3 fld cup.out
    dd3 fld cup.out --curve dc06.csv --margin 0.08 --surface upper --output fld.png

The forming limit is the curve of Keeler and Brazier (1977), an estimate for low-carbon steel from the thickness and the
exponent n of the hardening law or --n, or a measured one: --curve with minor and major logarithmic strain in each line.
Strains are logarithmic. At plane strain the curve is the engineering strain (23.3 + 14.13 t) n/0.21 %, t in mm, n at
most 0.21. Its left branch is the line of constant thickness, major + minor = const; the slope of its right branch, 0.6,
is a convention.
"""

import argparse
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from dd3.command import new_parser
from dd3.errors import Problem
from dd3.fields import AT, Fields
from dd3.plot.figures import new_figure, save
from dd3.run import read_job
from dd3.tables import read_text

ZONES = ("no strain", "wrinkling", "safe", "marginal", "critical")
COLOURS = ("#d0d4d8", "#5b8fd6", "#55a868", "#f0c040", "#d64541")
LEAST_STRAIN = 0.01  # major strain below which a point is not judged
RIGHT_SLOPE = 0.6
LARGEST_N = 0.21  # of the correlation


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
        that of pure shear, -minor, thicken: wrinkling.
        """
        limit = self.limit(minor)
        zone = np.full(np.shape(major), ZONES.index("safe"))
        zone[major < -minor] = ZONES.index("wrinkling")
        zone[np.maximum(np.abs(major), np.abs(minor)) < LEAST_STRAIN] = ZONES.index("no strain")
        zone[major > limit - margin] = ZONES.index("marginal")
        zone[major > limit] = ZONES.index("critical")
        return zone


def keeler_brazier(thickness: float, exponent: float) -> Curve:
    """Return the curve of Keeler and Brazier for a thickness (mm) and a hardening exponent."""
    plane = math.log(1 + (23.3 + 14.13 * thickness) / 100 * min(exponent, LARGEST_N) / LARGEST_N)
    return Curve([-0.5 * plane, 0.0, 0.4], [1.5 * plane, plane, plane + RIGHT_SLOPE * 0.4],
                 f"Keeler-Brazier, t = {thickness:.3g} mm, n = {exponent:.3g}")


def read_curve(path: str | Path, engineering: bool = False) -> Curve:
    """Read a measured curve: minor and major strain in each line, with blanks or a comma; # begins a comment."""
    points = []
    for number, line in enumerate(read_text(path).splitlines(), 1):
        words = line.partition("#")[0].replace(",", " ").split()
        if not words:
            continue
        try:
            minor, major = map(float, words)
        except ValueError:
            raise Problem(f"{path}:{number}: error: expected minor and major strain, got '{line.strip()}'") from None
        points.append((minor, major))
    if len(points) < 2:
        raise Problem(f"{path}: expected at least 2 points of the forming limit curve, got {len(points)}")
    minor, major = np.array(sorted(points)).T
    if (np.diff(minor) <= 0).any():
        raise Problem(f"{path}: a minor strain occurs twice")
    if max(np.abs(minor).max(), major.max()) > 2:
        raise Problem(f"{path}: strains above 2: give fractions, not per cent")
    if engineering:
        minor, major = np.log1p(minor), np.log1p(major)
    return Curve(minor, major, Path(path).stem)


def exponent_of(job: dict[str, Any]) -> float | None:
    """Return the exponent n of the first hardening law swift, swift_voce or ludwik of a job; None if there is none."""
    laws = (material["hardening"] for material in job["materials"])
    found = (parameter["value"] for law in laws if law["name"] in ("swift", "swift_voce", "ludwik")
             for parameter in law["parameters"] if parameter["name"] == "n")
    return next(found, None)


def find_curve(fields: Fields, job: dict[str, Any], options: argparse.Namespace) -> Curve | None:
    """Return the curve of the options of a command, or None without an exponent."""
    if options.curve:
        return read_curve(options.curve, options.engineering)
    exponent = options.n or exponent_of(job)
    if exponent is None:
        return None
    thickness = fields.values(0, "thickness")[0]
    return keeler_brazier(float(np.median(thickness[thickness > 0])), exponent)


def draw(axes: Axes, major: np.ndarray, minor: np.ndarray, curve: Curve | None, margin: float
         ) -> tuple[np.ndarray | None, str]:
    """Draw the diagram; return the zone of each node and what the diagram says, None and why not without a curve."""
    zone, said = None, "No forming limit curve: the hardening law has no exponent n. Give --n or --curve."
    if curve is None:
        axes.plot(minor, major, ".", color="0.4")
    else:
        zone = curve.zones(major, minor, margin)
        for number, name in enumerate(ZONES):
            here = zone == number
            if here.any():
                axes.plot(minor[here], major[here], ".", color=COLOURS[number], label=name)
        at = np.linspace(min(-0.3, minor.min()), max(0.3, minor.max()), 200)
        axes.plot(at, curve.limit(at), "k-", linewidth=1.5, label=curve.label)
        axes.plot(at, curve.limit(at) - margin, "k--", linewidth=0.8, label="marginal")
        room = (curve.limit(minor) - major)[zone > 0]
        critical = int((zone == ZONES.index("critical")).sum())
        nearest = f"; smallest distance below the curve {room.min():.3g}" if room.size and not critical else ""
        said = f"{critical} of {len(zone)} nodes critical{nearest}"
        axes.legend(frameon=False, fontsize=9)
    low, high = axes.get_xlim()
    axes.plot([low, 0, high], [-low, 0, high], color="0.6", linewidth=0.8)
    axes.set(xlim=(low, high), ylim=(min(0, major.min()), None), xlabel="minor strain (logarithmic)",
             ylabel="major strain (logarithmic)")
    axes.grid(True, color="0.9")
    return zone, said


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of the curve."""
    parser.add_argument("--curve", metavar="FILE", help="measured forming limit curve")
    parser.add_argument("--engineering", action="store_true", help="the strains of --curve are engineering strains")
    parser.add_argument("--n", type=float, help="hardening exponent of the curve of Keeler and Brazier")
    parser.add_argument("--margin", type=float, default=0.1, help="width of the marginal zone in major strain (0.1)")


def check_options(parser: argparse.ArgumentParser, options: argparse.Namespace) -> None:
    """Check the options of the curve."""
    if (options.n is not None and not options.n > 0) or options.margin < 0:
        parser.error("--n takes a positive number, --margin one that is not negative")


def main(words: Sequence[str] | None = None) -> None:
    """Draw the diagram of the command line."""
    parser = new_parser("fld", __doc__)
    parser.add_argument("run", metavar="RUN", help="folder of results")
    parser.add_argument("--at", metavar="PLACE", help=AT)
    parser.add_argument("--surface", choices=["middle", "upper", "lower"], default="middle",
                        help="where the strains are taken (middle)")
    add_options(parser)
    parser.add_argument("--output", default="fld.png", help="picture to write: .png, .svg or .pdf (fld.png)")
    options = parser.parse_args(words)
    check_options(parser, options)
    fields = Fields(options.run)
    step = fields.last if options.at is None else fields.step_at(options.at)
    major, minor = (fields.values(step, f"{name}_strain_{options.surface}")[0] for name in ("major", "minor"))
    figure, axes = new_figure((8, 5.2))
    said = draw(axes, major, minor, find_curve(fields, read_job(fields.folder), options), options.margin)[1]
    axes.set_title(fields.state(step), fontsize=10)
    save(figure, options.output, 130)
    print(options.output, said, sep="\n")
