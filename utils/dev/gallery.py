#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make the runs of the gallery, its pictures, and the tables of docs/gallery.md.

    utils/dev/gallery.py --program build/release/dd3imp --work build/gallery            make the runs that are missing
    utils/dev/gallery.py --program build/release/dd3imp --work build/gallery --write    and pictures and tables

Each example is an input file beside measured or published values, which are those of the script of its report. Finished
runs are kept; `--only` selects those to make. All take about eight minutes of processor time together. A run that warns
of its mesh (W009, W109) is refused.
"""

import json
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dd3 import springback
from dd3.errors import Problem, run
from dd3.pages import put_table, table
from dd3.plot import sheet as pictures
from dd3.plot.figures import tidy
from dd3.programs import command, launch
from dd3.run import read_frame, read_job
from dd3.sheet import Sheet, in_plane, plane
from dd3.tables import read_table, totals

ROOT = Path(__file__).resolve().parents[2]
HEMISPHERE = ROOT / "tests" / "verification" / "hemispherical_punch"
sys.path += map(str, (ROOT / "tests" / "forming", HEMISPHERE.parent, HEMISPHERE))
# The scripts of the reports, with the measured values.
studies, square_cup, round_cup, round_cup_aa6016, split_ring, hemisphere = map(
    import_module, ("studies", "square_cup", "round_cup", "round_cup_aa6016", "split_ring", "case"))

PAGE = ROOT / "docs" / "gallery.md"
PICTURES = ROOT / "docs" / "images" / "gallery"
SHEET, CURVE = (1040, 700), (660, 700)  # pixels of the sheet and of the curves beside it
MESH_WARNINGS = {"W009", "W109"}
HEAD = ["example", "quantity", "measured or published", "computed", "difference"]
EFFORT = ["example", "elements", "increments", "cut-backs", "iterations", "CPU seconds"]
MEASURED: dict[str, Any] = {"color": "black", "marker": "o", "linestyle": "none", "label": "measured"}
MEMBRANE = 30, 0.4  # elements, and steps of the height, mm, of the membrane over the hemispherical punch
COLOURS = ("#0072b2", "#d55e00", "#009e73")


@dataclass
class Example:
    """An input file with parameters, options of `dd3 plot sheet`, and what compares the run."""

    name: str
    deck: Path
    view: str
    compare: Callable[["Result", Axes], list[list[str]]]
    settings: Mapping[str, object] = field(default_factory=dict)


@dataclass
class Result:
    """A finished run with the options of the script."""

    options: Any
    folder: Path
    cpu: float
    job: dict[str, Any]


def row(quantity: str, known: float, found: float, form: str = ".1f") -> list[str]:
    """Return quantity, known and computed value, and the difference in per cent."""
    return [quantity, f"{known:{form}}", f"{found:{form}}", f"{100 * (found / known - 1):+.1f} %"]


def draw_in(result: Result, axes: Axes) -> list[list[str]]:
    """Compare the draw-in of the cup of aluminium at the axes, whose measured values are one, and at the corner."""
    history = read_frame(result.folder, "history.csv")
    history = history[history["phase"] == "draw"]
    size, travel = square_cup.SIZE, history["travel"].to_numpy(float)
    along = size - (history["edge_x_x"] + history["edge_y_y"]).to_numpy(float) / 2
    diagonal = np.sqrt(2) * size - np.hypot(history["corner_x"], history["corner_y"]).to_numpy(float)
    measured = square_cup.PUBLISHED["measured, averages"]
    rows = []
    for number, (name, values) in enumerate((("axes", along), ("corner", diagonal))):
        axes.plot(travel, values, color=COLOURS[number], label=f"computed, {name}")
        known = measured[number::2]
        axes.plot(square_cup.TRAVELS, known, **{**MEASURED, "color": COLOURS[number], "label": f"measured, {name}"})
        rows += [row(f"draw-in at the {name}, {at:g} mm deep, mm", value, float(np.interp(at, travel, values)))
                 for at, value in zip(square_cup.TRAVELS, known, strict=True)]
    axes.set(xlabel="travel of the punch (mm)", ylabel="draw-in (mm)")
    return rows


def heights(result: Result, axes: Axes) -> list[list[str]]:
    """Compare the heights of the cup of AA6016."""
    cup = round_cup_aa6016.Cup(result.folder, round_cup_aa6016.BLANK)
    angles = round_cup_aa6016.ANGLES
    for name, style in (("measured", MEASURED), ("POSTECH, same criterion", {"linestyle": "--", "color": "0.5"})):
        axes.plot(angles, round_cup_aa6016.PUBLISHED[name], **{**style, "label": name})
    axes.plot(cup.angles, cup.heights, color=COLOURS[0], label="computed")
    axes.set(xlabel="angle from rolling (degrees)", ylabel="height of the rim (mm)", xticks=angles, ylim=(32.9, 35.5))
    known = np.array(round_cup_aa6016.PUBLISHED["measured"])
    found = np.interp(angles, cup.angles, cup.heights)
    return [row("mean height, mm", around(known), around(found), ".2f"),
            *(row(f"height at {angles[i]} degrees, mm", known[i], found[i], ".2f") for i in (0, 3, 6)),
            row("highest less lowest rim, mm", np.ptp(known), np.ptp(found), ".2f")]


def around(values: np.ndarray) -> float:
    """Return the mean around the cup of values at equal angles of a quarter."""
    weights = np.ones(len(values))
    weights[[0, -1]] = 0.5
    return float(weights @ values / weights.sum())


def opening(result: Result, axes: Axes) -> list[list[str]]:
    """Compare the opening of rings cut from the cup of AA5754-O."""
    found = split_ring.rings(result.options, "split_ring", result.folder)
    known, scatter, half = split_ring.MEASURED, split_ring.SCATTER, split_ring.HEIGHT / 2
    axes.axhspan(known - scatter, known + scatter, color="0.75", label="measured, place not published")
    axes.plot([place + half for place in found], list(found.values()), "o-", color=COLOURS[0], label="computed")
    axes.set(xlabel="middle of the ring above the bottom (mm)", ylabel="opening (mm)", ylim=(0, None))
    return [row(f"opening of the ring {place:g} to {place + 2 * half:g} mm above the bottom, mm", known, value, ".2f")
            for place, value in found.items()]


def force(result: Result, axes: Axes) -> list[list[str]]:
    """Compare force and height over the hemispherical punch."""
    history = read_table(result.folder / "history.csv")
    height, found = (np.array([float(line[name]) for line in history]) for name in ("travel", "punch_fz"))
    found = 4e-3 * found  # kN of the whole sheet
    places, expected, _ = hemisphere.membrane.stretch(44.0, *MEMBRANE)
    loads, published = zip(*hemisphere.PUBLISHED)
    axes.plot(published, loads, **{**MEASURED, "label": "published, read from a curve"})
    axes.plot(places, expected, "--", color="0.5", label="membrane")
    axes.plot(height, found, color=COLOURS[0], label="computed")
    axes.set(xlabel="displacement of the punch (mm)", ylabel="force (kN)")
    return [*(row(f"displacement at {load} kN, mm", at, float(np.interp(load, found, height)))
              for load, at in hemisphere.PUBLISHED[1:-2:2]),
            *(row(f"force at {at:g} mm, kN", load, float(np.interp(at, height, found)))
              for load, at in hemisphere.PUBLISHED[-2:])]


def ears(result: Result, axes: Axes) -> list[list[str]]:
    """Compare the number of ears of the cup of AA2090-T3 with that which the authors of the criterion expect."""
    cup = round_cup.Cup(result.folder)
    found = round_cup.ears(cup.angles, cup.heights)
    angles, rise = round_cup.estimate(result.options.program, "aa2090_t3_yld2004")
    axes.plot(cup.angles, cup.heights - around(cup.heights), color=COLOURS[0], label="computed")
    axes.plot(angles, rise - around(rise), "--", color="0.5", label="estimate by r-values")
    axes.set(xlabel="angle from rolling (degrees)", ylabel="height of the rim less its mean (mm)",
             xticks=round_cup.ANGLES)
    places = ", ".join(f"{angle:g}" for angle in found)
    rises = ", ".join(f"{cup.heights[np.isin(cup.angles, angle)][0] - cup.heights.min():.1f}" for angle in found)
    return [["ears", "6 or more", str(round_cup.number(found)), ""],
            ["ears of the quarter, degrees from rolling", "", places, ""],
            ["their heights above the lowest rim, mm", "", rises, ""]]


def free_shape(result: Result, axes: Axes) -> list[list[str]]:
    """Draw the sections of the rail, drawn and free, and compare its springback with that of a uniform fine mesh."""
    sheet = Sheet(result.folder)
    found = springback.find(sheet, result.job["phases"])
    if found is None:
        raise Problem(f"{result.folder}: no springback")
    for number, at in enumerate(("x=-60", "x=0", "x=60")):
        normal, place = plane(at)
        line = sheet.cut(normal, place, step=found.step)[0]
        for points, style, state in ((found.drawn, "--", "drawn"), (found.free, "-", "free")):
            axes.plot(*in_plane(line.at(points), normal).T, style, color=COLOURS[number], linewidth=1.2,
                      label=f"{at.replace('=', ' = ')} mm, {state}")
    axes.set(xlabel="y (mm)", ylabel="z (mm)", aspect="equal")
    turned = springback.twist(sheet, found)
    return [row("largest distance from the drawn shape, mm (not measured: a uniform mesh of 88 x 56)", RAIL[0],
                float(found.distance().max()), ".2f"),
            row("twist from 10 to 90 % of the length, degrees (as before)", RAIL[1], turned[1] if turned else np.nan,
                ".2f")]


RAIL = 3.572, 6.65  # springback, mm, and twist, degrees, of the uniform mesh 88 x 56 in docs/reports/examples.md
INPUT = ROOT / "input_files"
EXAMPLES = {example.name: example for example in (
    Example("square_cup", INPUT / "square_cup" / "aluminium.dat", "--mirror x y --hide holder --hide die", draw_in),
    Example("round_cup_aa6016", INPUT / "round_cup_aa6016" / "round_cup_aa6016.dat",
            "--mirror x y --hide holder --hide die --zoom 0.7", heights),
    Example("round_cup", INPUT / "round_cup" / "round_cup.dat", "--mirror x y --hide holder --hide die", ears),
    Example("split_ring", INPUT / "split_ring" / "split_ring.dat", "--mirror x y --hide holder --hide die", opening,
            {"divisions": "6 12 1", "levels": 2}),
    Example("hemispherical_punch", HEMISPHERE / "case.dat", "--mirror x y --hide die", force,
            {"core": 5, "ring": 10, "levels": 2}),
    Example("rail", INPUT / "rail" / "rail.dat", "--at draw --hide holder --hide die --zoom 0.75", free_shape),
)}


def make(options: Any, example: Example) -> Result | None:
    """Make the run of an example unless it is there; None if it is not wanted."""
    folder = options.work / f"{example.name}.out"
    note = folder.with_suffix(".json")
    if not (note.is_file() and studies.is_finished(folder)):
        if options.only and example.name not in options.only:
            return None
        print(example.name, flush=True)
        done = launch(command(options.program, example.deck, folder, ["--quiet", "--threads", "1"], example.settings))
        if done.code != 0:
            raise Problem(f"{example.name}: exit code {done.code}: {done.errors}")
        note.write_text(json.dumps({"cpu": done.cpu}), encoding="utf-8")
    job = read_job(folder)
    warned = sorted(MESH_WARNINGS & {warning["code"] for warning in job["warnings"]})
    if warned:
        raise Problem(f"{example.name}: {', '.join(warned)}: the mesh is too coarse for the tools")
    return Result(options, folder, json.loads(note.read_text(encoding="utf-8"))["cpu"], job)


def effort(result: Result) -> list[str]:
    """Return elements, increments, cut-backs, iterations and processor time of a run."""
    total = totals(read_table(result.folder / "status.csv"))
    sheet = Sheet(result.folder)
    return [str(len(sheet.corners(sheet.last))), str(total.increments), str(total.cutbacks), str(total.iterations),
            f"{result.cpu:.0f}"]


def picture_of(example: Example, result: Result, curves: Figure) -> None:
    """Write the picture of an example: the sheet coloured by its thinning, and the curves beside it."""
    path = PICTURES / f"{example.name}.png"
    pictures.main([str(result.folder), "--field", "thinning", "--size", *map(str, SHEET), "--output", str(path),
                   *example.view.split()])
    beside = path.with_name(f"{example.name}_curves.png")
    curves.savefig(beside, dpi=100)
    parts = [matplotlib.image.imread(part)[..., :3] for part in (path, beside)]
    matplotlib.image.imsave(path, np.concatenate(parts, axis=1))
    beside.unlink()


def compared(example: Example, result: Result) -> tuple[list[list[str]], Figure]:
    """Return the rows of an example and the figure of its curves."""
    figure = Figure(figsize=(CURVE[0] / 100, CURVE[1] / 100), layout="constrained")
    axes = figure.subplots()
    rows = example.compare(result, axes)
    tidy(axes)
    # Axes of equal scales leave room above them.
    above = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.02), "ncols": 2} if axes.get_aspect() == 1 else {}
    axes.legend(frameon=False, fontsize=11, **above)
    return rows, figure


def main() -> None:
    """Make runs, pictures and tables."""
    options = studies.arguments(__doc__)
    results = {name: made for name, example in EXAMPLES.items() if (made := make(options, example))}
    rows: list[Sequence[str]] = []
    PICTURES.mkdir(exist_ok=True)
    for name, result in results.items():
        found, figure = compared(EXAMPLES[name], result)
        label = f"[{name.replace('_', ' ')}](#{name.replace('_', '-')})"
        rows += [[label, *line] for line in found]
        if options.write:
            picture_of(EXAMPLES[name], result, figure)
    print(table(HEAD, rows))
    if options.write:
        jobs = [result.job for result in results.values()]
        put_table(PAGE, "values", table(HEAD, rows), jobs)
        put_table(PAGE, "effort", table(EFFORT, [[name.replace("_", " "), *effort(result)]
                                                 for name, result in results.items()]), jobs)
    sys.exit(0 if len(results) == len(EXAMPLES) else 1)


if __name__ == "__main__":
    run(main)
