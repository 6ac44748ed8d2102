# SPDX-License-Identifier: GPL-3.0-or-later
"""The tools of a part with their input files: made, judged, written, checked by the program."""
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext
from copy import copy
from pathlib import Path
from typing import Any

import numpy as np

from dd3 import places, springback
from dd3.errors import Problem
from dd3.gmsh_session import session
from dd3.part import setup, table
from dd3.part.command import write_reading
from dd3.progress import Progress, doing
from dd3.sheet import Sheet
from dd3.tools import (
    beads,
    drawability,
    pad_force,
    picture,
    report,
    set_deck,
    set_material,
    symmetry,
    tool_set,
    trim_deck,
)
from dd3.tools.limits import beside
from dd3.tools.one_tool import judge_distance
from dd3.tools.settings import DRAW, ToolSettings
from dd3.tools.surface import write
from dd3.tools.symmetry import AXES

ESTIMATE = Path()  # what `beads` is without a run


@contextmanager
def about(path: Path) -> Iterator[None]:
    """Let each error name a file."""
    try:
        yield
    except Problem as problem:
        text = str(problem)
        raise Problem(text if text.startswith(str(path)) else f"{path}: {text}") from problem


def tools_of(gmsh: Any, options: ToolSettings, progress: Progress) -> tuple[tool_set.ToolSet, ToolSettings]:
    """Return the tools of a part and the options with all sizes; where the drawing ratio is too large, those with a
    smaller shoulder and margin, as far as these were not given."""
    settled = settle_set(options, tool_set.SIZES)
    tools = tool_set.made(gmsh, settled, progress)
    smaller = settle_set(options, tool_set.SIZES | tool_set.SMALLER)
    if tools.ratio <= drawability.RATIO or vars(smaller) == vars(settled):
        return tools, settled
    again = tool_set.made(gmsh, smaller, progress)
    if again.ratio >= tools.ratio:
        return tools, settled
    again.lines.append(("ratio", f"shoulder of {smaller.shoulder:.3g} mm and margin of {smaller.margin:.3g} mm, as the "
                        f"drawing ratio is {tools.ratio:.3g} with {settled.shoulder:.3g} and {settled.margin:.3g} mm"))
    return again, smaller


def settle_set(options: ToolSettings, sizes: Mapping[str, float]) -> ToolSettings:
    """Return the options with the sizes of a set of tools that were not given, from those over the thickness."""
    options = copy(options)
    options.radius = options.radius or options.thickness
    sizes = {**sizes, "margin": beads.MARGIN} if options.beads else sizes
    for name, factor in sizes.items():
        if getattr(options, name) is None:
            setattr(options, name, factor * options.thickness)
    # The convex ones of a side are the larger by the gap, so that the tool on the other side has the radius there.
    gap = options.thickness + options.clearance
    options.sharp = {edge: options.radius + (gap if angle > 0 else 0.0) for edge, angle in options.angles.items()}
    return options


def make_set(options: ToolSettings, command: str) -> dict[str, report.Report]:
    """Read a part, write punch, die, holder and the input file; return the reports by the names of the files. No tools
    are made of a part that cannot be drawn, and none is written if one has errors."""
    options.material = set_material.found(options.material)
    set_material.name_of(options.material)
    reading = setup.read_for_tools(options)
    say(str(options.source), options.source, report.Report(table.short(reading), reading.warnings,
                                                           [fault.text for fault in reading.faults]))
    if options.target and reading.faults:
        write_reading(reading, options.target)
    if reading.faults:
        sys.exit(2)
    # The picture takes two seconds.
    with beside(lambda: write_reading(reading, options.target)) if options.target else nullcontext():
        return made_set(options, command)


def made_set(options: ToolSettings, command: str) -> dict[str, report.Report]:
    """Make and write the tools of a part that was read, and the input file; return the reports."""
    progress = Progress(options.source.name)
    with session() as gmsh, about(options.source):
        tools, options = tools_of(gmsh, options, progress)
    progress.end()
    refuse_symmetric(tools, options)
    reports = judge_set(tools, options)
    if options.target and not any(result.errors for result in reports.values()):
        if "pad" in tools.surfaces:
            set_pad_force(tools, options)
        found = beads_of(tools, options) if options.beads else beads.Beads()
        write_set(tools, options, found, command)
        result = report.Report([f"  {'travel':<10} {tools.travel:.6g} mm",
                                f"  {'blank':<10} {set_deck.said(options, tools.blank)}"])
        if options.mirrors and not only_whole(tools):
            result.add("symmetry", symmetry.said(options))
        lines, warnings = drawability.judged(tools, options.material)
        for line in [*lines, set_material.said(options.material), *set_deck.notes(options, tools),
                     *(found.said() if options.beads else [])]:
            result.add(*line)
        result.warnings += set_material.warnings(options.material) + warnings
        check_deck(result, options)
        reports[str(options.target / DRAW)] = result
        if options.curves:
            reports[str(options.target / trim_deck.DECK)] = report.Report([f"  {'curves':<10} {tools.curves.said}"])
    return reports


def only_whole(tools: tool_set.ToolSet) -> str:
    """Return why the input file is that of the whole part in spite of planes of symmetry; empty if it need not be."""
    if tools.pins:
        return "locating pins hold the floor"
    return "the blank lies on an inclined binder" if tools.blank.inclined else ""


def refuse_symmetric(tools: tool_set.ToolSet, options: ToolSettings) -> None:
    """Refuse to compute a half or a quarter of a part where the input file is that of the whole part."""
    if options.symmetric and (reason := only_whole(tools)):
        raise Problem(f"--symmetric: {reason}, and the whole part is computed: leave the option out")


def program_of(options: ToolSettings) -> Path | None:
    """Return the program, None if there is none."""
    found = shutil.which(options.program or places.program())
    return Path(found) if found else None


@doing("proposing draw-beads")
def beads_of(tools: tool_set.ToolSet, options: ToolSettings) -> beads.Beads:
    """Return the draw-beads that are proposed, with their forces by the material."""
    if "holder" not in tools.surfaces or "pad" in tools.surfaces:
        return beads.Beads(reason="there is no holder around the part that carries them")
    drawn = None if options.beads == ESTIMATE else draw_in_of(options.beads)
    found = beads.proposed(tools.blank, options.thickness, drawn)
    if found.lines:
        program = program_of(options)
        if not program:
            raise Problem("--beads needs the program for the restraint; --program names it")
        result = beads.through(options.material, options.thickness, set_deck.FRICTION)
        found.force, found.lift = result.force(set_deck.FRICTION), result.uplift
        stress = set_material.stress_of(program, options.material)
        found.part = result.restraint / beads.largest(stress, options.thickness)
    return found


@doing("computing the force of the pad by the program")
def set_pad_force(tools: tool_set.ToolSet, options: ToolSettings) -> None:
    """Set the force of the pad if there is the program: by what holds the floor, by what the pins bear, and not less
    than by its pressure."""
    program = program_of(options)
    if program:
        stress, holder = set_material.stress_of(program, options.material), tools.area.get("holder", 0.0)
        given = tools, stress, set_deck.PRESSURE * holder, options, set_deck.FRICTION
        of_pins = pad_force.with_pins(*given)
        tools.pad_force = max(set_deck.PRESSURE * tools.area["pad"], pad_force.needed(*given), of_pins)
        tools.pad_for_pins = tools.pad_force == of_pins


def draw_in_of(run: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return the points in plan of the rim of the sheet at the end of a run (n, 2), and their draw-in, mm; of a part
    between planes of symmetry those of the whole."""
    sheet = Sheet(run)
    rim = np.concatenate(sheet.outline())
    start, points = sheet.start(-1), sheet.points(-1)
    place, drawn = points[rim, :2], sheet.values(-1, "draw_in")[0][rim]
    for axis in (AXES.index(name) for name in springback.symmetry(start, points) if name in AXES):
        # The border on the plane is no rim.
        kept = (np.abs(place[:, axis]) > springback.ROUND_OFF * np.ptp(points[:, axis])) | (drawn != 0)
        image = place[kept] * np.where(np.arange(2) == axis, -1.0, 1.0)
        place, drawn = np.concatenate([place[kept], image]), np.tile(drawn[kept], 2)
    return place, drawn


@doing("checking draw.dat by the program")
def check_deck(result: report.Report, options: ToolSettings) -> None:
    """Add what the program says of the input file of a set to its report: memory, elements, time, warnings, errors."""
    program = program_of(options)
    if not program and options.program:
        result.errors.append(f"{options.program}: no such program")
    elif not program:
        result.add("check", "not made, as there is no program dd3imp; --program names it")
    else:
        done = subprocess.run([program, "--check", options.target / DRAW], capture_output=True, text=True, check=False)
        for line in done.stdout.splitlines():
            kind, _, text = line.partition(": ")
            if kind in ("memory", "refinement", "time"):
                result.add(kind, text)
            elif kind.startswith("warning "):
                result.warnings.append(f"{DRAW}: {kind.split()[-1]}: {text}")
        if done.returncode:
            result.errors.append(f"{DRAW} is refused by the program: {done.stderr.strip()}")


def judge_set(tools: tool_set.ToolSet, options: ToolSettings) -> dict[str, report.Report]:
    """Return the reports on the tools of a part by the names of their files, and draw them."""
    reports = {}
    for name, surface in tools.surfaces.items():
        result, joints = report.judge(surface, options, 0)
        reports[str((options.target or Path()) / f"{name}.bez")] = result
        if options.picture:
            picture.draw(surface, joints, options.picture.with_stem(f"{options.picture.stem}_{name}"))
        if name in tools.distance:
            lines, errors = judge_distance(surface, tools.distance[name], options, "measured")
            result.errors += errors
            for line in lines + (tools.lines if name == "die" else []):
                result.add(*line)
    return reports


@doing("writing the tools")
def write_set(tools: tool_set.ToolSet, options: ToolSettings, found: beads.Beads, command: str) -> None:
    """Write the tools of a part and the input file with draw-beads."""
    options.target.mkdir(parents=True, exist_ok=True)
    for name, surface in tools.surfaces.items():
        write(options.target / f"{name}.bez", surface, [f"{name} of {options.source.name}: {command}"])
    set_deck.write_blank(options, tools)
    text = set_deck.deck(options, tools, found, command)
    (options.target / DRAW).write_text(text, encoding="utf-8")
    if options.curves:
        trim_deck.write(options, tools.curves, tools.height)


def say(title: str, source: Path, result: report.Report) -> None:
    """Print a report."""
    try:
        print(title, *result.lines, sep="\n", flush=True)
    finally:  # also where the reader of the report, such as head, has closed the pipe
        for kind, texts in (("warning", result.warnings), ("error", result.errors)):
            for text in texts:
                print(f"{kind}: {source}: {text}", file=sys.stderr)
