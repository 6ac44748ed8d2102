# SPDX-License-Identifier: GPL-3.0-or-later
"""Input file that puts the sheet of a run on the locators of a fixture, under its weight, and closes the clamps.

Each locator and clamp holds the node of the measured face that is nearest to its place, along its direction, at the
nominal coordinate of this node: locators in the first phase, clamps of each order in a phase of their own.
"""

import re
from pathlib import Path
from typing import Any

import numpy as np

from dd3.deviation import Comparison
from dd3.errors import Problem
from dd3.fixture import LOCATORS, Fixture, Support
from dd3.nominal import line_distances, of_material
from dd3.run import read_job
from dd3.sheet import AXES, Sheet

ALONG = 1 - 1e-6  # cosine between a direction and an axis
TRIAL = 0.25  # of a phase
FILE = re.compile(r'\bfile\s*=\s*(?:"([^"]+)"|([^"\s]+))')


def write_deck(run: Path, fixture: Fixture, path: Path) -> None:
    """Write the input file."""
    if fixture.alignment != LOCATORS:
        raise Problem(f"{fixture.path}: error: the alignment is \"{fixture.alignment}\"; expected by = \"locators\", "
                      "on which the part lies in the fixture")
    sheet = Sheet(run)
    found = Comparison(fixture, sheet, sheet.last)
    found.align()
    axis, angle = found.motion.axis_angle()
    lines = [f"# {fixture.title}: made by dd3 deviation --deck from {fixture.path.name}.",
             "*START", f"  from = {run.resolve()}",
             f"  turn = 0 0 0  {numbers(axis)}  {angle:.12g}", f"  move = {numbers(found.motion.shift)}"]
    lines += materials(read_job(run), fixture)
    for name in fixture.mirror:
        lines += [f"*SET symmetry_{name}", f"  plane = {name} 0", f"*BOUNDARY symmetry_{name}",
                  f"  set = symmetry_{name}", f"  fix = {name}"]
    places = [place_of(found, i) for i in range(len(found.supports))]
    for support, (node, _, _) in zip(found.supports, places):
        lines += [f"*SET {support.name}", f"  near = {numbers(found.part.initial[node])}",
                  f"*HISTORY {support.name}", f"  set = {support.name}", "  quantities = position reaction"]
    for order in sorted({support.order for support in found.supports}):
        lines += [f"*PHASE {f'clamp_{order}' if order else 'locate'}", "  control = load", f"  trial = {TRIAL:g}"]
        if fixture.gravity is not None and not order:
            lines.append(f"  gravity = {numbers(fixture.gravity)}")
        lines += [f"  place = {support.name} {name} {coordinate:.10g}"
                  for support, (_, name, coordinate) in zip(found.supports, places) if support.order == order]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def numbers(values: np.ndarray) -> str:
    """Return numbers as text."""
    return " ".join(f"{value + 0.0:.12g}" for value in values)


def with_absolute_files(text: str, folder: Path) -> str:
    """Return the text of an entry with the files in it named from the root."""
    return FILE.sub(lambda name: f'file = "{folder / (name[1] or name[2])}"', text)


def materials(job: dict[str, Any], fixture: Fixture) -> list[str]:
    """Return the blocks of the materials of a run, with the density of the fixture where they have none."""
    lines = []
    for block in job["input"]["blocks"]:
        if block["keyword"] != "material":
            continue
        lines.append(f"*MATERIAL {block['name']}")
        given = [entry for entry in block["entries"] if not entry["default"]]
        for entry in given:
            folder = Path(entry["at"]["file"]).resolve().parent
            text = with_absolute_files(entry["text"], folder)
            lines.append(f"  {entry['key']} = {text}")
        if fixture.gravity is not None and "density" not in [entry["key"] for entry in given]:
            if fixture.density is None:
                raise Problem(f"{fixture.path}: error: material '{block['name']}' of the run has no density, which "
                              "[gravity] needs; expected density in [gravity], t/mm3")
            lines.append(f"  density = {fixture.density:g}")
    return lines


def place_of(found: Comparison, number: int) -> tuple[int, str, float]:
    """Return the node of the face that a locator or clamp holds, the axis, and the coordinate to which it moves."""
    support: Support = found.supports[number]
    axis = int(np.abs(support.direction).argmax())
    if abs(support.direction[axis]) < ALONG:
        raise Problem(f"{found.fixture.path}: error: the direction of '{support.name}' is "
                      f"{numbers(support.direction)}; nodes are held along x, y or z only: expected such a "
                      "direction, or a nominal shape turned so that it is one")
    part = found.part
    points = found.motion.of(part.points)
    node = int(np.linalg.norm(points - found.at[number], axis=1).argmin())
    if not support.pin:
        away, _ = line_distances(points[node][None], support.direction[None], found.nominal)
        coordinate = points[node, axis] + (away[0] - support.stop) * support.direction[axis]
    elif found.wanted:
        coordinate = of_material(found.wanted.initial, found.wanted.points, part.initial[node][None])[0, axis]
    else:
        coordinate = points[node, axis]
    if not np.isfinite(coordinate):
        raise Problem(f"{found.fixture.path}: error: the nominal shape does not reach the node nearest to "
                      f"'{support.name}'; expected a place farther from its border")
    return node, AXES[axis], float(coordinate)
