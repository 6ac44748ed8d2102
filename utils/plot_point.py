#!/usr/bin/env -S uv run --script
# /// script
# requires-python = ">=3.11"
# dependencies = ["matplotlib==3.11.2", "numpy==2.4.6"]
# ///
"""Draw what materials do at a point: tension curves, r-values and yield stresses against the angle, yield surfaces.

    plot_point.py steel.dat aluminium.dat --program build/release/dd3imp --output materials.png
    plot_point.py sheets.dat:dc06 sheets.dat:dp600
    plot_point.py --run point.out --run other.out

The files hold *MATERIAL blocks, and no sheet; FILE:NAME draws one of them. Each material is drawn in one colour. All
values come from runs of the program with single points (*POINT): tension at angles to the rolling direction; plane
stress by ratios of strain, whose stresses over the flow stress are the yield surface and whose strains are its
normals. Back-stresses count as stress. --run draws the points of a run that was made already, a folder of results or
its history.csv: s11 over e11.
"""

import argparse
import csv
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import scripts

scripts.need("matplotlib", "numpy")
import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

TENSION = "e11 s22 s33 s12 s23 s13"
PLANE = "e11 e22 s33 s12 s23 s13"
INCLUDE = re.compile(r'^\s*\*include\s+"?([^"#!\n]*[^"#!\s])', re.IGNORECASE | re.MULTILINE)


def text_of(path, parents=()):
    """The text of a file, and of those it includes."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        sys.exit(f"{path}: {getattr(error, 'strerror', None) or 'not a text'}")
    included = [path.parent / name for name in INCLUDE.findall(text)]
    return "".join([text, *(text_of(file, (*parents, path)) for file in included if file not in parents)])


def names_in(file):
    """The path of FILE or FILE:NAME, and the names of its materials."""
    path, _, chosen = file.rpartition(":")
    if not path or Path(file).exists():
        path, chosen = file, ""
    text = text_of(Path(path))
    found = re.findall(r"^\s*\*material\s+([\w.-]+)", text, re.IGNORECASE | re.MULTILINE)
    if not found:
        sys.exit(f"{path}: no *MATERIAL")
    names = [name.lower() for name in found]
    if chosen and chosen.lower() not in names:
        sys.exit(f"{path}: no *MATERIAL {chosen}; there are: {', '.join(names)}")
    return path, [chosen.lower()] if chosen else names


def point(name, material, control, targets, angle=None):
    """A *POINT block."""
    lines = [f"*POINT {name}", f"  material = {material}", f"  control = {control}"]
    if angle is not None:
        lines.append(f"  angle = {angle:g}")
    lines += [f"  target = {' '.join(f'{value:.9g}' for value in values)} steps={steps}" for values, steps in targets]
    return "\n".join(lines)


def deck(path, materials, angles, ratios, strain):
    """Input that takes each material along all paths."""
    blocks = [f'*INCLUDE "{Path(path).resolve()}"']
    for m, material in enumerate(materials):
        for angle in angles:
            elastic, end = [1e-6, 0, 0, 0, 0, 0], [strain, 0, 0, 0, 0, 0]
            blocks.append(point(f"t{m}_{angle:g}", material, TENSION, [(elastic, 1), (end, 100)], angle))
        for i, ratio in enumerate(ratios):
            end = [0.05 * np.cos(ratio), 0.05 * np.sin(ratio), 0, 0, 0, 0]
            blocks.append(point(f"p{m}_{i}", material, PLANE, [(end, 10)], 0))
    return "\n".join(blocks) + "\n"


def run(program, text):
    """Rows of the history of a run, by point."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "points.dat"
        file.write_text(text, encoding="utf-8")
        command = [program, "--quiet", "--output", str(Path(folder) / "out"), str(file)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False)
        except OSError as error:
            sys.exit(f"{program}: {error.strerror}; give --program FILE")
        if done.returncode != 0:
            # The paths at a point stand in a file of ours; what the user has is the files it includes.
            said = re.sub(re.escape(str(file)) + r"(:\d+)?", ", ".join(INCLUDE.findall(text)), done.stderr.strip())
            sys.exit(said or f"{program} failed")
        return read_points(Path(folder) / "out")


def read_points(path):
    """Rows of a history by point; path is a folder of results or its history.csv."""
    path = Path(path)
    if path.is_dir():
        path = path / "history.csv"
    try:
        with open(path, newline="", encoding="utf-8") as stream:
            rows = list(csv.DictReader(line for line in stream if not line.startswith("#")))
    except OSError as error:
        sys.exit(f"{path}: {error.strerror}")
    if not rows or "point" not in rows[0]:
        sys.exit(f"{path}: not the history of single points")
    points = {}
    for number, row in enumerate(rows, 1):
        try:
            points.setdefault(row.pop("point"), []).append({key: float(value) for key, value in row.items()})
        except (TypeError, ValueError):
            sys.exit(f"{path}: row {number} does not hold a number in each column")
    return points


def r_value(rows):
    """Ratio of the plastic strains across, over the second half of a tension test."""
    share = rows[1]["e22"] / rows[1]["s11"], rows[1]["e33"] / rows[1]["s11"]
    across, through = ([row[key] - part * row["s11"] for row in (rows[len(rows) // 2], rows[-1])]
                       for key, part in zip(("e22", "e33"), share))
    return (across[1] - across[0]) / (through[1] - through[0])


def yield_stress(rows):
    """Stress over the flow stress in tension."""
    return rows[-1]["s11"] / rows[-1]["flow_stress"]


def draw_runs(axes, runs):
    """Draws s11 over e11 of the points of the runs."""
    for path in runs:
        points = read_points(path)
        name = Path(path).resolve()
        name = (name if name.is_dir() else name.parent).name.removesuffix(".out")
        for point_name, rows in points.items():
            label = f"{name}, {point_name}" if len(runs) > 1 else point_name
            axes.plot([row["e11"] for row in rows], [row["s11"] for row in rows], label=label)


def draw_over_angle(axes, angles, values, **style):
    """Draws values over the angle to the rolling direction."""
    axes.plot(angles, values, **style)
    axes.set(xlabel="angle to the rolling direction (°)", xticks=range(0, 91, 15))


def draw_surface(axes, ends, normals, keys=("s11", "s22"), **style):
    """Draws a yield surface: stresses over the flow stress at the ends of paths; given normals, those of each sixth."""
    x, y = (np.array([row[key] / row["flow_stress"] for row in ends]) for key in keys)
    line, = axes.plot(np.append(x, x[0]), np.append(y, y[0]), **style)
    if normals is not None:
        along, across = (part[::6] / np.hypot(*normals)[::6] for part in normals)
        axes.quiver(x[::6], y[::6], along, across, color=line.get_color(), angles="xy", units="inches", width=0.016,
                    scale_units="inches", scale=3.5, zorder=2)
    axes.set(xlabel=f"{keys[0]} / flow stress", ylabel=f"{keys[1]} / flow stress", aspect="equal")
    axes.margins(0.15)


def draw(axes, points, m, label, angles, ratios, colour):
    """Draws one material."""
    for angle, style in ((0, "-"), (45, "--"), (90, ":")):
        rows = points[f"t{m}_{angle}"]
        text = None if angle else label
        axes[0].plot([row["e11"] for row in rows], [row["s11"] for row in rows], style, color=colour, label=text)
    for part, value in ((axes[1], r_value), (axes[2], yield_stress)):
        values = [value(points[f"t{m}_{angle:g}"]) for angle in angles]
        draw_over_angle(part, angles, values, marker="o", color=colour, label=label)
    ends = [points[f"p{m}_{i}"][-1] for i in range(len(ratios))]
    draw_surface(axes[3], ends, (np.cos(ratios), np.sin(ratios)), color=colour, label=label)


def picture(files, program, strain=0.2, runs=()):
    """The figure: the materials of the files, and the points of finished runs."""
    angles = list(range(0, 91, 15))
    ratios = np.radians(np.arange(0, 360, 5))
    panels = (2, 2) if files else (1, 1)
    size = (10, 9) if files else (7, 4.5)
    figure, axes = plt.subplots(*panels, figsize=size, layout="constrained", squeeze=False)
    axes = axes.ravel()
    number = 0
    for file in files:
        path, materials = names_in(str(file))
        points = run(program, deck(path, materials, angles, ratios, strain))
        for m, material in enumerate(materials):
            draw(axes, points, m, material, angles, ratios, colour_of(number))
            number += 1
    draw_runs(axes[0], runs)
    title = "Tension (-- at 45°, : at 90°)" if files else ""
    axes[0].set(xlabel="logarithmic strain", ylabel="stress (MPa)", title=title)
    if files:
        axes[1].set(ylabel="r-value", title="r-values")
        axes[2].set(ylabel="stress / flow stress", title=f"Yield stress at strain {strain:g}")
        axes[3].set(title="Yield surface at strain 0.05")
    for part in axes:
        part.grid(alpha=0.3)
    handles, names = axes[0].get_legend_handles_labels()
    figure.legend(handles, names, fontsize="small", loc="outside right upper", frameon=False)
    return figure


def colour_of(number):
    """One of twenty colours, the dark ones first."""
    return plt.get_cmap("tab20")((2 * number + number // 10 % 2) % 20)


def save(figure, path, dpi=100):
    """Writes the figure."""
    try:
        figure.savefig(path, dpi=dpi)
    except (OSError, ValueError) as error:
        sys.exit(f"{path}: {error}")


def main():
    """Draws the picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", nargs="*", help="file with *MATERIAL blocks, or FILE:NAME")
    parser.add_argument("--run", action="append", default=[], help="finished run to draw; may be repeated")
    parser.add_argument("--program", default="dd3imp", help="the program dd3imp (default: the one on the path)")
    parser.add_argument("--strain", type=float, default=0.2, help="strain of the tension curves (0.2)")
    parser.add_argument("--output", default="materials.png", help="picture (materials.png)")
    parser.add_argument("--dpi", type=int, default=100, help="dots per inch (100)")
    options = parser.parse_args()
    if options.strain <= 0 or options.dpi < 1:
        parser.error("--strain and --dpi take positive numbers")
    if not options.file and not options.run:
        parser.error("a file or a --run is needed")
    save(picture(options.file, options.program, options.strain, options.run), options.output, options.dpi)


if __name__ == "__main__":
    scripts.run(main)
