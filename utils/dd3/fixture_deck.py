# SPDX-License-Identifier: GPL-3.0-or-later
"""Input file that puts the sheet of a run on the locators of a fixture, under its weight, and closes the clamps.

Each locator and clamp acts on the node of the measured face that is nearest to its place: locators in the first phase,
clamps of each order in a phase of their own. One that is not one-sided holds the node along its direction, at the
nominal coordinate. A one-sided one is a pad, a plane tool across its direction in contact with this node, or, where it
pushes from the other face of the sheet, with the node there.
"""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dd3.deviation import Comparison, Face
from dd3.errors import Problem
from dd3.fixture import LOCATORS, Fixture, Support
from dd3.nominal import line_distances
from dd3.run import FILE, read_job
from dd3.sheet import AXES
from dd3.surface_strain import columns

ALONG = 1 - 1e-6  # cosine between a direction and an axis
TRIAL = 0.25  # of a phase
PAD = 20.0  # half a side of a pad, over the thickness; it has contact with one node, which it must not lose
AWAY = 2.0  # distance of a pad from the sheet at the start, over the thickness
LAYER = 0.002  # of the contact with pads, over the thickness


def write_deck(found: Comparison, path: Path) -> None:
    """Write the input file of a part that is compared, at the last step of its run."""
    fixture, run = found.fixture, found.part.sheet.folder
    if fixture.alignment != LOCATORS:
        raise Problem(f"{fixture.path}: error: the alignment is \"{fixture.alignment}\"; expected by = \"locators\", "
                      "on which the part lies in the fixture")
    found.align()
    axis, angle = found.motion.axis_angle()
    lines = [f"# {fixture.title}: made by dd3 deviation --deck from {fixture.path.name}.",
             "*START", f'  from = "{run.resolve()}"',
             f"  turn = 0 0 0  {numbers(axis)}  {angle:.12g}", f"  move = {numbers(found.motion.shift)}"]
    lines += materials(read_job(run), fixture)
    for name in fixture.mirror:
        lines += [f"*SET symmetry_{name}", f"  plane = {name} 0", f"*BOUNDARY symmetry_{name}",
                  f"  set = symmetry_{name}", f"  fix = {name}"]
    acting = [acting_of(found, i) for i in range(len(found.supports))]
    if any(support.one_sided for support in found.supports):
        if fixture.gravity is None:
            raise Problem(f"{fixture.path}: error: one-sided supports without [gravity], which lays the part on them")
        lines += ["*CONTACT", f"  layer = {LAYER:g}"]
    for support, one in zip(found.supports, acting):
        lines += [f"*SET {support.name}", f"  near = {numbers(one.initial)}"]
        lines += one.pad(support, path) if support.one_sided else [
            f"*HISTORY {support.name}", f"  set = {support.name}", "  quantities = position reaction"]
    for order in sorted({support.order for support in found.supports}):
        lines += [f"*PHASE {f'clamp_{order}' if order else 'locate'}", "  control = load", f"  trial = {TRIAL:g}"]
        if fixture.gravity is not None and not order:
            lines.append(f"  gravity = {numbers(fixture.gravity)}")
        lines += [one.motion(support) for support, one in zip(found.supports, acting) if support.order == order]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


class Acting(NamedTuple):
    """The node on which a locator or clamp acts: its initial and present place, mm; the distance along the direction to
    where it is to be, mm; the thickness of the sheet, mm."""

    initial: np.ndarray
    place: np.ndarray
    path: float
    thickness: float

    def motion(self, support: Support) -> str:
        """Return the entry of the phase in which it closes."""
        if not support.one_sided:
            axis = int(np.abs(support.direction).argmax())
            goal = self.place[axis] + self.path * support.direction[axis]
            return f"  place = {support.name} {AXES[axis]} {goal:.10g}"
        if support.force is not None:
            return f"  press = {support.name} {numbers(support.force * support.direction)}"
        return f"  move = {support.name} {numbers((self.path + self.before) * support.direction)}"

    @property
    def before(self) -> float:
        """Distance of a pad from the node at the start, mm."""
        return AWAY * self.thickness + max(-self.path, 0.0)

    def pad(self, support: Support, path: Path) -> list[str]:
        """Write the surface of a pad beside the input file, and return its block."""
        first = np.cross(support.direction, np.eye(3)[np.abs(support.direction).argmin()])
        second = np.cross(support.direction, first)
        half = PAD * self.thickness / np.linalg.norm(first)
        corners = [self.place + half * (u * first + v * second) for v in (-1, 1) for u in (-1, 1)]
        surface = path.with_name(f"{path.stem}_{support.name}.bez")
        surface.write_text("\n".join(["patch 1 1", *map(numbers, corners)]) + "\n", encoding="utf-8")
        return [f"*TOOL {support.name}", f'  patches = "{surface.name}"', f"  contact = {support.name}",
                f"  position = {numbers(-self.before * support.direction)}"]


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
            folder = Path(job["command"]["working_directory"], entry["at"]["file"]).parent
            text = with_absolute_files(entry["text"], folder)
            lines.append(f"  {entry['key']} = {text}")
        if fixture.gravity is not None and "density" not in [entry["key"] for entry in given]:
            if fixture.density is None:
                raise Problem(f"{fixture.path}: error: material '{block['name']}' of the run has no density, which "
                              "[gravity] needs; expected density in [gravity], t/mm3")
            lines.append(f"  density = {fixture.density:g}")
    return lines


def acting_of(found: Comparison, number: int) -> Acting:
    """Return the node on which a locator or clamp acts."""
    support: Support = found.supports[number]
    axis = int(np.abs(support.direction).argmax())
    if not support.one_sided and abs(support.direction[axis]) < ALONG:
        raise Problem(f"{found.fixture.path}: error: the direction of '{support.name}' is "
                      f"{numbers(support.direction)}; nodes are held along x, y or z only: expected such a "
                      "direction, or one_sided = true, or a nominal shape turned so that it is one")
    part = found.part
    points = found.motion.of(part.points)
    node = int(np.linalg.norm(points - found.at[number], axis=1).argmin())
    if not support.pin:
        away, normal = line_distances(points[node][None], support.direction[None], found.nominal)
        path = away[0] - support.stop
        if support.one_sided and normal[0] @ support.direction > 0:
            other = partner(part, int(part.nodes[node]))
            place = found.motion.of(part.sheet.points(part.step)[[other]])[0]
            return Acting(part.sheet.initial(part.step)[other], place, path, part.thickness)
    elif found.wanted:
        goal = found.wanted.blank.at(found.wanted.points, part.initial[node][None])[0]
        path = (goal - points[node])[axis] * support.direction[axis]
    else:
        path = 0.0
    if not np.isfinite(path):
        raise Problem(f"{found.fixture.path}: error: the nominal shape does not reach the node nearest to "
                      f"'{support.name}'; expected a place farther from its border")
    return Acting(part.initial[node], points[node], float(path), part.thickness)


def partner(part: Face, node: int) -> int:
    """Return the node of the other face of the sheet that faces a node."""
    ends = columns(part.sheet.corners(part.step), len(part.sheet.points(part.step)))
    pairs = np.stack(ends, axis=2).reshape(-1, 2)
    return int(next(other for pair in (pairs, pairs[:, ::-1]) for other in pair[pair[:, 0] == node][:1, 1]))
