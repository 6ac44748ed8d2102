# SPDX-License-Identifier: GPL-3.0-or-later
"""Compute the forming limit curve of a material by the analysis of Marciniak and Kuczynski.

    dd3 flc dc06 --f0 0.996
    dd3 flc sheet.dat --calibrate-plane-strain 0.22 --measured points.csv --output sheet_flc.csv
    dd3 flc dp600 --calibrate -0.1 0.3 --rate-sensitivity 0.01

MATERIAL is a file with *MATERIAL, which may be a whole input file, or the name of a material of the library. Yield
criterion, hardening and back-stresses are those of the program, by its library libdd3laws. The table that is written is
one for `dd3 fld --curve` and `dd3 report --curve`; the picture has the same name.

f0 is the thickness of the groove over that of the sheet. It is no property of the sheet that is measured: it is
calibrated by one measured limit, mostly that of plane strain, or assumed. Without a law of the strain rate in *MATERIAL
the limit of plane strain is at most that of Considere, the exponent n of a power law. With one, the sheet is stretched
at --strain-rate. Without, --rate-sensitivity adds the factor rate^m to the flow stress in the equilibrium of the groove
(m is about 0.01 of steel, 0 of aluminium).
"""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from scipy.optimize import brentq

from dd3.account import Account
from dd3.command import new_parser
from dd3.errors import Problem
from dd3.forming_limit_curve import Curve, read_points
from dd3.laws import Material
from dd3.marciniak_kuczynski import LARGEST, LEFT, POINTS, RATIO, RIGHT, STRAIN_RATE, Limit, Sheet, curve_of, ratios_of
from dd3.marciniak_kuczynski import Path as StrainPath
from dd3.plot.figures import new_figure, save, tidy
from dd3.tools.set_material import found

IMPERFECTIONS = 1e-5, 0.2  # 1 - f0: range of the calibration
PRECISION = 1e-3  # of log10(1 - f0) in it
PLANE = 0.02  # minor strain up to which a measured point counts as plane strain


def calibrated(sheet: Sheet, minor: float, major: float) -> float:
    """Return the f0 with which the limit of a proportional path is a measured one."""
    path = StrainPath(minor / major)

    def excess(power: float) -> float:
        sheet.ratio = 1 - 10**power
        limit = sheet.limit(path)
        return (limit.major if limit else LARGEST) - major

    ends = [math.log10(size) for size in IMPERFECTIONS]
    highest, lowest = (excess(end) for end in ends)
    if not highest > 0 > lowest:
        bound, f0 = (highest, 1 - IMPERFECTIONS[0]) if highest <= 0 else (lowest, 1 - IMPERFECTIONS[1])
        hint = ("; laws without rate sensitivity give low limits near plane strain: see --rate-sensitivity, or the "
                "hardening at large strains" if highest <= 0 else "")
        raise Problem(f"the measured limit {major:g} at the minor strain {minor:g} is not reached: with f0 = {f0:.6g} "
                      f"it is {bound + major:.4g}{hint}")
    return 1 - 10 ** float(brentq(excess, *ends, xtol=PRECISION))


def compared(sheet: Sheet, minor: np.ndarray, major: np.ndarray) -> list[str]:
    """Return what the deviations of the computed from measured limits are, along the path of each, by branch."""
    limits = [sheet.limit(StrainPath(float(ratio))) for ratio in minor / major]
    off = np.array([limit.major if limit else math.nan for limit in limits]) / major - 1
    branches = {"left of plane strain": minor < -PLANE, "near plane strain": np.abs(minor) <= PLANE,
                "right of it": minor > PLANE}
    return [f"{name}: {of.sum()} measured points, computed over measured major strain "
            f"{100 * np.mean(off[of]):+.1f} % in the mean, {100 * off[of][np.argmax(np.abs(off[of]))]:+.1f} % at most"
            for name, of in branches.items() if of.any()]


def write(path: Path, label: str, kept: Sequence[Limit]) -> None:
    """Write the table."""
    rows = [f"# curve: {label}", "minor strain,major strain,groove angle at the start (degrees),at the limit"]
    rows += [f"{limit.minor:.5f},{limit.major:.5f},{limit.angle:.3g},{limit.turned:.3g}" for limit in kept]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")


def draw(axes: Axes, curve: Curve, measured: tuple[np.ndarray, np.ndarray] | None) -> None:
    """Draw the curve and measured points."""
    axes.plot(curve.minor, curve.major, "k.-", label=curve.label)
    if measured is not None:
        axes.plot(*measured, "o", color="#d55e00", label="measured")
    axes.set(xlabel="minor strain (logarithmic)", ylabel="major strain (logarithmic)", ylim=(0, None))
    axes.legend(frameon=False, fontsize=9)
    tidy(axes)


def main(words: Sequence[str] | None = None) -> None:
    """Compute the curve of the command line."""
    parser = new_parser("flc", __doc__)
    parser.add_argument("material", type=Path, metavar="MATERIAL", help="file, or name of a material of the library")
    parser.add_argument("--name", help="of the material, if the file has several")
    group = parser.add_mutually_exclusive_group(required=True)
    group.add_argument("--f0", type=float, metavar="RATIO", help="thickness of the groove over that of the sheet")
    group.add_argument("--calibrate", type=float, nargs=2, metavar=("MINOR", "MAJOR"),
                       help="measured limit that gives f0")
    group.add_argument("--calibrate-plane-strain", type=float, metavar="MAJOR", help="the same, of plane strain")
    parser.add_argument("--points", type=int, default=POINTS,
                        help=f"strain paths from minor/major = -0.5 to 1 ({POINTS})")
    parser.add_argument("--direction", type=float, default=0.0, metavar="DEGREES",
                        help="of the major strain to the rolling direction (0)")
    parser.add_argument("--rate-sensitivity", type=float, default=0.0, metavar="M", help="exponent m (0)")
    parser.add_argument("--strain-rate", type=float, default=STRAIN_RATE, metavar="RATE",
                        help=f"of the major strain in the sheet, 1/s, for a law of the rate ({STRAIN_RATE:g})")
    parser.add_argument("--measured", type=Path, metavar="FILE", help="table with measured limits to compare with")
    parser.add_argument("--engineering", action="store_true", help="the strains of --measured are engineering strains")
    parser.add_argument("--output", type=Path, default=Path("flc.csv"), help="table to write (flc.csv)")
    options = parser.parse_args(words)
    if options.f0 is not None and not 0 < options.f0 < 1:
        parser.error("--f0 takes a number between 0 and 1, such as 0.996")
    point = options.calibrate or (options.calibrate_plane_strain and (0.0, options.calibrate_plane_strain))
    if point and not (point[1] > 0 and LEFT <= point[0] / point[1] <= RIGHT):
        parser.error(f"a measured limit has a positive major strain, minor/major from {LEFT:g} to {RIGHT:g}")
    if not options.strain_rate > 0:
        parser.error("--strain-rate takes a number > 0")
    if options.points < 3 or not 0 <= options.rate_sensitivity < 1:
        parser.error("--points takes at least 3, --rate-sensitivity 0 to below 1")
    file = found(options.material)
    sheet = Sheet(Material(file=file, name=options.name), options.f0 or 1.0, options.direction,
                  options.rate_sensitivity, strain_rate=options.strain_rate)
    account = Account()
    measured = read_points(options.measured, options.engineering, account) if options.measured else None
    source = "given"
    if point:
        sheet.ratio = calibrated(sheet, *point)
        source = f"calibrated by the limit {point[1]:g} at the minor strain {point[0]:g}"
    rate = f", m = {options.rate_sensitivity:g}" if options.rate_sensitivity else ""
    if sheet.material.has_rate:
        rate = f", {options.strain_rate:g} /s"
    turned = f", major strain at {options.direction:g} degrees" if options.direction else ""
    label = (f"{options.name or options.material.stem}: Marciniak-Kuczynski, f0 = {sheet.ratio:.5g} ({source})"
             f"{rate}{turned}")
    limits = sheet.curve(ratios_of(options.points))
    curve, kept = curve_of(limits, label)
    write(options.output, label, kept)
    figure, axes = new_figure((7, 5))
    draw(axes, curve, measured)
    picture = options.output.with_suffix(".png")
    save(figure, picture, 130)
    left_out = [f"left out: {len(limits) - len(kept)} of {len(limits)} paths, without localisation up to the strain "
                f"{LARGEST:g} or with a minor strain below that of the path before"] if len(kept) < len(limits) else []
    said = compared(sheet, *measured) if measured is not None else []
    print(options.output, picture, label, f"limit: the groove thins {RATIO:g} times as fast as the sheet; plane strain "
          f"{float(curve.limit(0.0)):.4g}", *said, *left_out, *(f"left out: {item}" for item in account.left_out()),
          sep="\n")
