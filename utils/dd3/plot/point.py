# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the response of materials at a point: tension curves, r-values and yield stresses by angle, yield surfaces.

    dd3 plot point steel.dat aluminium.dat --output materials.png
    dd3 plot point sheets.dat:dc06 sheets.dat:dp600
    dd3 plot point --run point.out --run other.out

The files contain *MATERIAL blocks and no sheet; FILE:NAME draws one of them. Each material has one colour. All values
are computed by the program at single points (*POINT): tension at angles to the rolling direction, and plane stress at
fixed ratios of strain, which gives the yield surface (stresses over the flow stress) and its normals (the strains).
Stresses include the back-stress. Laws of the strain rate are evaluated at --rate. --run draws s11 over e11 of the
points of a finished run, given its folder of results or its history.csv.
"""

import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dd3.command import new_parser
from dd3.errors import Problem
from dd3.plot.figures import new_figure, save
from dd3.programs import POINTS, add_program, run_points
from dd3.progress import each
from dd3.tables import label_of, read_points, read_text

TENSION = "e11 s22 s33 s12 s23 s13"
PLANE = "e11 e22 s33 s12 s23 s13"
# A point beside a file of materials, whose names the program then gives.
PROBE = f"""*MATERIAL dd3_probe
  young = 1
  poisson = 0
  yield = von_mises
  hardening = perfect Y0=1
*POINT dd3_probe
  material = dd3_probe
  control = {TENSION}
  target = 1e-6 0 0 0 0 0 steps=1
"""
RATE = 1e-3  # 1/s, of a slow tension test
PATH = [float(angle) for angle in range(0, 91, 15)]  # angles of the picture

Rows = list[dict[str, float]]
Targets = Iterable[tuple[Sequence[float], int]]


def names_in(file: str, program: str | Path) -> tuple[str, list[str]]:
    """Return the path of FILE or FILE:NAME, and the names of its materials in small letters."""
    path, _, chosen = file.rpartition(":")
    if not path or Path(file).exists():
        path, chosen = file, ""
    read_text(path)  # a Problem if that is not possible
    job = run(program, f'*INCLUDE "{Path(path).resolve()}"\n{PROBE}')[0]
    names = [material["name"] for material in job["materials"][:-1]]
    if not names:
        raise Problem(f"{path}: no *MATERIAL")
    if chosen and chosen.lower() not in names:
        raise Problem(f"{path}: no *MATERIAL {chosen}; there are: {', '.join(names)}")
    return path, [chosen.lower()] if chosen else names


def point(name: str, material: str, control: str, targets: Targets, angle: float | None = None,
          durations: Sequence[float] = ()) -> str:
    """Return a *POINT block, with the durations of its targets if given."""
    lines = [f"*POINT {name}", f"  material = {material}", f"  control = {control}"]
    if angle is not None:
        lines.append(f"  angle = {angle:g}")
    lines += [f"  target = {' '.join(f'{value:.9g}' for value in values)} steps={steps}" for values, steps in targets]
    if durations:
        lines.append(f"  duration = {' '.join(f'{duration:.9g}' for duration in durations)}")
    return "\n".join(lines)


def deck(path: str | Path, materials: Sequence[str], angles: Iterable[float], ratios: Iterable[float], strain: float,
         rate: float = RATE) -> str:
    """Return the input that takes each material along all paths at a strain rate; names: t0_45 for tension, p0_3 for
    strain ratios.
    """
    blocks = [f'*INCLUDE "{Path(path).resolve()}"']
    for m, material in enumerate(materials):
        for angle in angles:
            elastic, end = [1e-6, 0, 0, 0, 0, 0], [strain, 0, 0, 0, 0, 0]
            durations = [1e-6 / rate, abs(strain) / rate]
            blocks.append(point(f"t{m}_{angle:g}", material, TENSION, [(elastic, 1), (end, 100)], angle, durations))
        for i, ratio in enumerate(ratios):
            end = [0.05 * np.cos(ratio), 0.05 * np.sin(ratio), 0, 0, 0, 0]
            blocks.append(point(f"p{m}_{i}", material, PLANE, [(end, 10)], 0, [0.05 / rate]))
    return "\n".join(blocks) + "\n"


def run(program: str | Path, text: str) -> tuple[dict[str, Any], dict[str, Rows]]:
    """Return the description of a run of single points and its rows by point; its input includes files of the user."""
    done, points = run_points(program, text)
    if done.code != 0:
        # Messages on the generated input name the files that it includes.
        included = ", ".join(re.findall(r'^\*INCLUDE "(.*)"', text, re.MULTILINE))
        said = re.sub(re.escape(POINTS) + r"(:\d+)?", included, done.errors.strip())
        raise Problem(said or f"{program} failed")
    return done.job, points


def r_value(rows: Rows) -> float:
    """Return the ratio of the plastic strains in width and thickness over the second half of a tension test."""
    elastic = rows[1]["e22"] / rows[1]["s11"], rows[1]["e33"] / rows[1]["s11"]
    width, thickness = ([row[key] - part * row["s11"] for row in (rows[len(rows) // 2], rows[-1])]
                        for key, part in zip(("e22", "e33"), elastic))
    return (width[1] - width[0]) / (thickness[1] - thickness[0])


def yield_stress(rows: Rows) -> float:
    """Return the stress over the flow stress at the end of a tension test."""
    return rows[-1]["s11"] / rows[-1]["flow_stress"]


def draw_runs(axes: Axes, runs: Sequence[str | Path]) -> None:
    """Draw s11 over e11 of the points of the runs."""
    for path in runs:
        points = read_points(path)
        for point_name, rows in points.items():
            label = f"{label_of(path)}, {point_name}" if len(runs) > 1 else point_name
            axes.plot([row["e11"] for row in rows], [row["s11"] for row in rows], label=label)


def draw_over_angle(axes: Axes, angles: Sequence[float], values: Sequence[float], **style: Any) -> None:
    """Draw values over the angle to the rolling direction."""
    axes.plot(angles, values, **style)
    axes.set(xlabel="angle to the rolling direction (°)", xticks=range(0, 91, 15))


def draw_surface(axes: Axes, ends: Rows, normals: tuple[np.ndarray, np.ndarray] | None,
                 keys: tuple[str, str] = ("s11", "s22"), **style: Any) -> None:
    """Draw a yield surface: stresses over the flow stress at the ends of paths, and every sixth normal if given."""
    x, y = (np.array([row[key] / row["flow_stress"] for row in ends]) for key in keys)
    line, = axes.plot(np.append(x, x[0]), np.append(y, y[0]), **style)
    if normals is not None:
        u, v = (part[::6] / np.hypot(*normals)[::6] for part in normals)
        axes.quiver(x[::6], y[::6], u, v, color=line.get_color(), angles="xy", units="inches", width=0.016,
                    scale_units="inches", scale=3.5, zorder=2)
    axes.set(xlabel=f"{keys[0]} / flow stress", ylabel=f"{keys[1]} / flow stress", aspect="equal")
    axes.margins(0.15)


def draw(axes: Sequence[Axes], points: dict[str, Rows], m: int, label: str, ratios: np.ndarray, colour: Any) -> None:
    """Draw one material."""
    for angle, style in ((0, "-"), (45, "--"), (90, ":")):
        rows = points[f"t{m}_{angle}"]
        text = None if angle else label
        axes[0].plot([row["e11"] for row in rows], [row["s11"] for row in rows], style, color=colour, label=text)
    for part, value in ((axes[1], r_value), (axes[2], yield_stress)):
        values = [value(points[f"t{m}_{angle:g}"]) for angle in PATH]
        draw_over_angle(part, PATH, values, marker="o", color=colour, label=label)
    ends = [points[f"p{m}_{i}"][-1] for i in range(len(ratios))]
    draw_surface(axes[3], ends, (np.cos(ratios), np.sin(ratios)), color=colour, label=label)


def picture(files: Sequence[str | Path], program: str | Path, strain: float = 0.2, runs: Sequence[str | Path] = (),
            rate: float = RATE) -> Figure:
    """Return the figure of the materials of the files and the points of finished runs."""
    ratios = np.radians(np.arange(0, 360, 5))
    figure, axes = new_figure((10, 9) if files else (7, 4.5), *((2, 2) if files else (1, 1)), squeeze=False)
    axes = axes.ravel()
    number, speed = 0, ""
    for file in each(files, "materials"):
        path, materials = names_in(str(file), program)
        points = run(program, deck(path, materials, PATH, ratios, strain, rate))[1]
        if any(rows[-1].get("plastic_strain_rate", 0) > 0 for rows in points.values()):
            speed = f" at {rate:g} /s"
        for m, material in enumerate(materials):
            draw(axes, points, m, material, ratios, colour_of(number))
            number += 1
    draw_runs(axes[0], runs)
    title = f"Tension{speed} (-- at 45°, : at 90°)" if files else ""
    axes[0].set(xlabel="logarithmic strain", ylabel="stress (MPa)", title=title)
    if files:
        axes[1].set(ylabel="r-value", title="r-values")
        axes[2].set(ylabel="stress / flow stress", title=f"Yield stress at strain {strain:g}")
        axes[3].set(title="Yield surface at strain 0.05")
    for part in axes:
        part.grid(alpha=0.3)
    handles, names = axes[0].get_legend_handles_labels()
    # Beside the last axes; matplotlib 3.6 has no legends outside.
    axes[-1].legend(handles, names, fontsize="small", loc="upper left", bbox_to_anchor=(1.02, 1.0), frameon=False)
    return figure


def colour_of(number: int) -> Any:
    """Return one of twenty colours, the dark ones first."""
    return matplotlib.colormaps["tab20"]((2 * number + number // 10 % 2) % 20)


def main(words: Sequence[str] | None = None) -> None:
    """Draw the picture of the command line."""
    parser = new_parser("plot point", __doc__)
    parser.add_argument("file", nargs="*", help="file with *MATERIAL blocks, or FILE:NAME")
    parser.add_argument("--run", action="append", default=[], help="finished run to draw; may be repeated")
    add_program(parser)
    parser.add_argument("--strain", type=float, default=0.2, help="strain of the tension curves (0.2)")
    parser.add_argument("--rate", type=float, default=RATE, help=f"strain rate, 1/s ({RATE:g})")
    parser.add_argument("--output", default="materials.png", help="picture (materials.png)")
    parser.add_argument("--dpi", type=int, default=100, help="dots per inch (100)")
    options = parser.parse_args(words)
    if not (options.strain > 0 and options.rate > 0 and options.dpi >= 1):
        parser.error("--strain, --rate and --dpi take positive numbers")
    if not options.file and not options.run:
        parser.error("a file or a --run is needed")
    save(picture(options.file, options.program, options.strain, options.run, options.rate), options.output, options.dpi)
