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

from collections.abc import Sequence
from itertools import cycle
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dd3.account import Account
from dd3.command import new_parser
from dd3.fields import AT
from dd3.forming_limit import (
    Criteria,
    Judged,
    Limits,
    Strains,
    add_options,
    find_limits,
    judge,
    strains_of,
    take_criteria,
)
from dd3.forming_limit_curve import COLOURS, ZONES, Curve
from dd3.material_limits import mark, reached
from dd3.plot.figures import new_figure, save
from dd3.run import read_job
from dd3.sheet import Sheet


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
