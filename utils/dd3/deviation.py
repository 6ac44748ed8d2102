# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare the sheet of a run with its nominal shape as a checking fixture does: alignment, deviations, tolerances.

    dd3 deviation rail.out --fixture fixture.toml
    dd3 deviation rail.out --fixture fixture.toml --deck clamped.dat     # an input file that clamps the part
    dd3 deviation clamped.out --fixture fixture.toml --verdict

The file names the nominal shape, the alignment, the places to measure at and the tolerances; docs/measuring.md
explains its keys. The deviation is the distance of the sheet from the nominal shape along the normals of this shape,
positive on the side to which the measured face looks. The results are in RUN/deviation: map.png and map.csv,
points.csv, supports.csv, sections.png and sections.csv. A run in the fixture, of the input file that --deck writes, is
compared where it lies, and supports.csv has the forces of locators and clamps. --verdict ends with exit code 1 if a
deviation is outside its tolerance.
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from dd3 import deviation_pictures, verdict
from dd3.alignment import STILL, Equations, Rigid, aligned, free_motions, kabsch
from dd3.command import new_parser
from dd3.errors import LOG, Problem
from dd3.fields import AT
from dd3.fixture import FIT, LOCATORS, NONE, Fixture, Support, read_fixture
from dd3.nominal import (
    InitialFace,
    initial_face,
    line_distances,
    normal_distances,
    read_surface,
    sheet_surface,
    side_of_body,
    turned_to,
)
from dd3.programs import made_folder
from dd3.run import read_frame, read_job
from dd3.sheet import AXES, Sheet, length, plane
from dd3.springback import best_fit, steps_with_tools, tell_symmetry
from dd3.surface_strain import columns

BORDER = 0.25  # largest distance beside the border of the nominal shape at which a node is compared, over the thickness
FAR = 5.0  # largest distance of a place of the file from the nominal shape, mm
TANGENT = 0.2  # cosine between the direction of a locator and the normal of the part below which it is refused


class Face(NamedTuple):
    """A face of a sheet at a step: its sheet and step, its nodes, its initial shape, the present places of the nodes,
    mm, the thickness, and the face as a surface of pyvista."""

    sheet: Sheet
    step: int
    nodes: np.ndarray
    blank: InitialFace
    points: np.ndarray
    thickness: float
    surface: Any

    @property
    def initial(self) -> np.ndarray:
        """Initial places of the nodes, mm."""
        return self.blank.places


@dataclass
class Deviations:
    """What is measured. motion: from the place in the run to that of the nominal shape. determined: number of rigid
    motions that the alignment determines. distance: of the nodes of the face, nan beyond the border of the nominal
    shape. supports, points, sections: tables. at: places of the locators, clamps and points on the nominal shape."""

    part: Face
    motion: Rigid
    determined: int
    distance: np.ndarray
    supports: pd.DataFrame
    points: pd.DataFrame
    sections: pd.DataFrame
    items: list[verdict.Item] = field(default_factory=list)

    @property
    def places(self) -> np.ndarray:
        """The places of the nodes of the face after the alignment."""
        return self.motion.of(self.part.points)


def face_of(sheet: Sheet, step: int, upper: bool) -> Face:
    """Return a face of a sheet."""
    nodes, points = np.unique(sheet.faces(upper, step)), sheet.points(step)
    bottom, top = columns(sheet.corners(step), len(points))
    thickness = np.linalg.norm(points[top] - points[bottom], axis=2).mean()
    return Face(sheet, step, nodes, initial_face(sheet, step, upper), points[nodes], float(thickness),
                sheet_surface(sheet, step, upper=upper))


def nominal_face(fixture: Fixture, sheet: Sheet) -> Face:
    """Return the sheet that is the nominal shape: at the end of the last phase with tools, or at the place given."""
    other = Sheet(fixture.run) if fixture.run else sheet
    if fixture.at is not None:
        return face_of(other, other.step_at(fixture.at), fixture.upper)
    steps = steps_with_tools(other, read_job(other.folder)["phases"])
    if not steps.size:
        raise Problem(f"{other.folder}: no phase with tools, whose end would be the nominal shape; expected run, at or "
                      f"surface in [nominal] of {fixture.path}")
    return face_of(other, int(steps[-1]), fixture.upper)


class Comparison:
    """A part beside its nominal shape. nominal: its surface, normals on the side of the measured face; wanted: the face
    of the sheet that it is, by default that of the fixture, None of a surface from a file."""

    def __init__(self, fixture: Fixture, sheet: Sheet, step: int, wanted: Face | None = None) -> None:
        self.fixture, self.part = fixture, face_of(sheet, step, fixture.upper)
        self.wanted = wanted or (None if fixture.surface else nominal_face(fixture, sheet))
        surface = (side_of_body(read_surface(fixture.surface), self.part.surface) if fixture.surface
                   else self.wanted.surface)  # type: ignore[union-attr]
        self.nominal = turned_to(surface, self.part.surface)
        self.weights = sheet.areas(step)[self.part.nodes]
        if fixture.alignment != NONE:
            tell_symmetry(sheet, step, fixture.mirror, f"{fixture.path}: the alignment may turn the part", "mirror")
        self.motion, self.determined = STILL, 0
        self.supports = [*fixture.locators, *fixture.clamps]
        self.at = self.on_nominal(self.supports)
        self.pins = np.array([support.pin for support in self.supports], bool)
        self.holes = np.full((len(self.supports), 3), np.nan)  # places of the part before its motion, of pins

    def on_nominal(self, supports: Sequence[Support]) -> np.ndarray:
        """Return the places of locators and clamps on the nominal shape: along their directions, of pins the nearest
        ones."""
        places = np.array([support.at for support in supports]).reshape(-1, 3)
        directions = np.array([support.direction for support in supports]).reshape(-1, 3)
        away = line_distances(places, directions, self.nominal)[0]
        for i, support in enumerate(supports):
            if support.pin:
                found = self.nearest(support.name, support.at)
            elif not abs(away[i]) <= FAR:
                raise Problem(f"{self.fixture.path}: error: the nominal shape does not meet the line of "
                              f"'{support.name}' within {FAR:g} mm of its place; expected a place on it, and pin = "
                              "true for a direction in the sheet")
            else:
                found = support.at + away[i] * support.direction
            places[i] = found
        return places

    def nearest(self, name: str, place: np.ndarray) -> np.ndarray:
        """Return the place of the nominal shape that is nearest to one of the file."""
        _, found = self.nominal.find_closest_cell(place[None], return_closest_point=True)
        if np.linalg.norm(found[0] - place) > FAR:
            raise Problem(f"{self.fixture.path}: error: '{name}' lies {np.linalg.norm(found[0] - place):.3g} mm off "
                          f"the nominal shape, nearest {' '.join(f'{x:.4g}' for x in found[0])}; expected at most "
                          f"{FAR:g} mm")
        return np.asarray(found[0], float)

    def align(self) -> None:
        """Find the motion of the part to its nominal place."""
        fixture = self.fixture
        if self.wanted:
            target = self.wanted.blank.at(self.wanted.points, self.part.initial)
            self.motion = kabsch(self.part.points, best_fit(self.part.points, target, fixture.mirror, self.weights),
                                 self.weights)
        equations = self.fit_equations
        if fixture.alignment == LOCATORS:
            self.find_holes()
            equations = self.locator_equations
        elif fixture.alignment != FIT:
            equations = self.point_equations
        self.motion, self.determined = aligned(self.motion, equations, fixture.mirror)
        needed = int(free_motions(fixture.mirror).sum())
        if fixture.alignment == LOCATORS and self.determined < needed:
            raise Problem(f"{fixture.path}: error: the locators determine {self.determined} of {needed} rigid motions "
                          "of the part; expected places and directions that determine all, such as three on the face "
                          "and three pins in two holes")

    def fit_equations(self, motion: Rigid) -> Equations:
        """Return the distances of the nodes from the nominal shape along its normals."""
        places = motion.of(self.part.points)
        distance, normals, beside = normal_distances(places, self.nominal)
        chosen = beside <= BORDER * self.part.thickness
        if len(self.fixture.regions):
            low, high = self.fixture.regions[..., 0], self.fixture.regions[..., 1]
            inside = np.all((places[:, None] >= low) & (places[:, None] <= high), axis=2)
            chosen &= np.any(inside, axis=1)
        return Equations(distance[chosen], normals[chosen], places[chosen], self.weights[chosen])

    def along(self, motion: Rigid, places: np.ndarray, directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the distances of the part along lines, and its normals there."""
        found, normals = line_distances(motion.back(places), directions @ motion.rotation, self.part.surface)
        return found, normals @ motion.rotation.T

    def line_equations(self, motion: Rigid, names: Sequence[str], places: np.ndarray, directions: np.ndarray
                       ) -> Equations:
        """Return the distances of the part from places along lines, each of which it has to meet."""
        found, normals = self.along(motion, places, directions)
        cosine = (normals * directions).sum(axis=1)
        for name, distance, steep in zip(names, found, cosine):
            if not np.isfinite(distance):
                raise Problem(f"the part does not meet the line of '{name}'; expected a place within its border")
            if abs(steep) < TANGENT:
                raise Problem(f"{self.fixture.path}: error: the direction of '{name}' lies in the part; expected one "
                              "nearer to its normal, or pin = true")
        return Equations(found, normals / cosine[:, None], places + found[:, None] * directions, np.ones(len(found)))

    def point_equations(self, motion: Rigid) -> Equations:
        """Return the distances at the points of the alignment."""
        chosen = [point for point in self.fixture.points if point.name in self.fixture.fitted]
        places = np.array([self.nearest(point.name, point.at) for point in chosen])
        return self.line_equations(motion, [point.name for point in chosen], places,
                                   normal_distances(places, self.nominal)[1])

    def locator_equations(self, motion: Rigid) -> Equations:
        """Return the distances of the part from the locators along their directions."""
        count = len(self.fixture.locators)
        pins, at = self.pins[:count], self.at[:count]
        directions = np.array([locator.direction for locator in self.fixture.locators])
        face = self.line_equations(motion, [locator.name for locator in self.fixture.locators if not locator.pin],
                                   at[~pins], directions[~pins])
        holes = motion.of(self.holes[:count][pins])
        held = Equations(((holes - at[pins]) * directions[pins]).sum(axis=1), directions[pins], holes,
                         np.ones(int(pins.sum())))
        return Equations(*(np.concatenate(both) for both in zip(face, held)))

    def find_holes(self) -> None:
        """Find the places of the part, before its motion, that the pins hold: those of the same material as on a
        nominal sheet; on another surface the nearest ones after a best fit."""
        if not self.pins.any():
            return
        if self.wanted is None:
            start, _ = aligned(self.motion, self.fit_equations, self.fixture.mirror)
            _, near = self.part.surface.find_closest_cell(start.back(self.at), return_closest_point=True)
            self.holes = np.asarray(near, float)
            return
        initial = of_places(self.wanted.points, self.wanted.initial, self.at)
        shape = [face.blank.at(face.points, initial) for face in (self.wanted, self.part)]
        self.holes = shape[1] + (self.at - shape[0]) @ self.motion.rotation

    def deviations(self, at_fixture: bool) -> Deviations:
        """Return all deviations; at_fixture: the part lies in its fixture."""
        if not at_fixture and self.fixture.alignment != NONE:
            self.align()
        distance, _, beside = normal_distances(self.motion.of(self.part.points), self.nominal)
        distance[beside > BORDER * self.part.thickness] = np.nan
        if np.isnan(distance).all():
            raise Problem("no node of the part lies beside the nominal shape; is it in the same place?")
        found = Deviations(self.part, self.motion, self.determined, distance, self.support_table(at_fixture),
                           self.point_table(), self.section_table())
        found.items = judged(self.fixture, found)
        return found

    def support_table(self, at_fixture: bool) -> pd.DataFrame:
        """Return the locators and clamps with the gap of the part along their directions, and their forces."""
        directions = np.array([support.direction for support in self.supports]).reshape(-1, 3)
        gap, _ = self.along(self.motion, self.at, directions)
        gap[self.pins] = np.nan
        if not at_fixture and self.fixture.alignment == LOCATORS and self.pins.any():
            held = (self.motion.of(self.holes) - self.at) * directions
            gap[self.pins] = held.sum(axis=1)[self.pins]
        table = pd.DataFrame({"name": [support.name for support in self.supports],
                              "order": [support.order for support in self.supports],
                              **dict(zip(AXES, self.at.T)), "gap": gap})
        if at_fixture:
            table["force"] = forces_of(self.part, self.supports)
        return table

    def point_table(self) -> pd.DataFrame:
        """Return the points with their deviations and limits."""
        points = self.fixture.points
        places = np.array([self.nearest(point.name, point.at) for point in points]).reshape(-1, 3)
        normals = normal_distances(places, self.nominal)[1] if points else places
        distance, _ = self.along(self.motion, places, normals)
        return pd.DataFrame({"name": [point.name for point in points], **dict(zip(AXES, places.T)),
                             "deviation": distance, "lower": [point.limits[0] for point in points],
                             "upper": [point.limits[1] for point in points]})

    def section_table(self) -> pd.DataFrame:
        """Return the sections of the nominal shape with the deviations along them."""
        tables = []
        for name in self.fixture.sections:
            places = self.cut(name)
            normals = normal_distances(places, self.nominal)[1]
            tables.append(pd.DataFrame({"section": name, "length": length(places), **dict(zip(AXES, places.T)),
                                        "deviation": self.along(self.motion, places, normals)[0]}))
        return pd.concat(tables) if tables else pd.DataFrame(columns=["section", "length", *AXES, "deviation"])

    def cut(self, name: str) -> np.ndarray:
        """Return the longest line in which a plane cuts the nominal shape."""
        normal, distance = plane(name)
        origin = (distance + 1e-6 * self.nominal.length) * normal  # beside nodes in the plane
        cut = self.nominal.slice(normal=normal, origin=origin).strip(join=True)
        lines, start = [], 0
        while start < len(cut.lines):
            count = cut.lines[start]
            lines.append(np.asarray(cut.points, float)[cut.lines[start + 1:start + 1 + count]])
            start += 1 + count
        if not lines:
            raise Problem(f"{self.fixture.path}: error: the section {name} does not cut the nominal shape")
        return max(lines, key=lambda line: length(line)[-1])


def of_places(places: np.ndarray, values: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Return values at places in space, by a linear function through the nearest nodes, in their tangent plane."""
    from scipy.spatial import cKDTree
    found = np.zeros((len(wanted), values.shape[1]))
    for i, place in enumerate(wanted):
        _, near = cKDTree(places).query(place, k=min(6, len(places)))
        local = places[near] - place
        axes = np.linalg.svd(local - local.mean(axis=0))[2][:2]  # a linear function in the tangent plane
        system = np.column_stack([np.ones(len(near)), local @ axes.T])
        found[i] = np.linalg.lstsq(system, values[near], rcond=None)[0][0]
    return found


def forces_of(part: Face, supports: Sequence[Support]) -> list[float]:
    """Return the forces of locators and clamps on the part along their directions at its step, N."""
    job = part.sheet.file["job"]
    history = read_frame(part.sheet.folder, "history.csv")
    phase = part.sheet.phases[int(job["phase"][part.step]) - 1]["name"]
    rows = history[history["phase"] == phase]
    row = rows.iloc[(rows["progress"] - float(job["progress"][part.step])).abs().argmin()]
    signs = [("f", -1) if support.one_sided else ("r", 1) for support in supports]  # on the pad; on the part
    return [float(sum(sign * row[f"{support.name}_{letter}{axis}"] * x for axis, x in zip(AXES, support.direction)))
            for support, (letter, sign) in zip(supports, signs)]


def is_in_fixture(fixture: Fixture, sheet: Sheet) -> bool:
    """Tell whether a run has the locators of the fixture."""
    path = sheet.folder / "history.csv"
    if not fixture.locators or not path.is_file():
        return False
    columns = read_frame(sheet.folder, "history.csv").columns
    return all(f"{support.name}_{'fx' if support.one_sided else 'rx'}" in columns
               for support in (*fixture.locators, *fixture.clamps))


def judged(fixture: Fixture, found: Deviations) -> list[verdict.Item]:
    """Return the verdict: the part as a whole, each point, each section."""
    items = [item_of("part", found.distance, fixture.limits)]
    for name, deviation, *limits in found.points[["name", "deviation", "lower", "upper"]].itertuples(index=False):
        items.append(item_of(f"point {name}", np.array([deviation]), None if np.isinf(limits[0]) else tuple(limits)))
    for section, table in found.sections.groupby("section", sort=False):
        items.append(item_of(f"section {section!s}", table["deviation"].to_numpy(), fixture.limits))
    return items


def item_of(name: str, deviation: np.ndarray, limits: tuple[float, float] | None) -> verdict.Item:
    """Judge deviations by their limits; those beyond the border of either shape, nan, are counted."""
    known = deviation[np.isfinite(deviation)]
    if not known.size:
        return verdict.Item(name, verdict.OPEN, "beyond the border of the part")
    text = f"{known[0]:+.4f} mm" if deviation.size == 1 else (
        f"{known.min():+.4f} to {known.max():+.4f} mm, root mean square {np.sqrt((known**2).mean()):.4f} mm")
    if known.size < deviation.size:
        text += f", without {deviation.size - known.size} of {deviation.size} places beyond the border"
    if limits is None:
        return verdict.Item(name, verdict.OPEN, text + " (no tolerance)")
    outside = (known < limits[0]) | (known > limits[1])
    if deviation.size > 1 and outside.any():
        text += f", {100 * outside.mean():.3g} % outside"
    return verdict.Item(name, verdict.BAD if outside.any() else verdict.GOOD,
                        f"{text} (tolerance {limits[0]:+g} to {limits[1]:+g} mm)")


def compare(run: str | Path, fixture: Fixture, at: str | None = None) -> Deviations:
    """Return the deviations of the sheet of a run at a step, by default the last one."""
    sheet = Sheet(run)
    step = sheet.step_at(at) if at else sheet.last
    clamped = is_in_fixture(fixture, sheet)
    if clamped and not (fixture.run or fixture.surface):
        raise Problem(f"{run}: is in the fixture, and not the run whose drawn sheet is the nominal shape; expected run "
                      f"or surface in [nominal] of {fixture.path}")
    return Comparison(fixture, sheet, step).deviations(clamped)


def write(found: Deviations, fixture: Fixture, folder: Path) -> None:
    """Write tables and pictures."""
    made_folder(folder)
    places = dict(zip(AXES, found.places.T))
    pd.DataFrame({"node": found.part.nodes + 1, **places, "deviation": found.distance}).to_csv(
        folder / "map.csv", index=False, float_format="%.9g")
    for name in ("supports", "points", "sections"):
        if len(table := getattr(found, name)):
            table.to_csv(folder / f"{name}.csv", index=False, float_format="%.9g")
    if len(found.sections):
        deviation_pictures.draw_sections(found, fixture, folder / "sections.png")
    deviation_pictures.draw_map(found, fixture, folder / "map.png")


def said(fixture: Fixture, found: Deviations, in_fixture: bool) -> list[str]:
    """Return the lines of the report."""
    axis, angle = found.motion.axis_angle()
    how = "as it lies in its fixture" if in_fixture else f"alignment: {fixture.alignment}"
    if not in_fixture and fixture.alignment != NONE:
        how += (f", {found.determined} rigid motions determined; moved by "
                f"{' '.join(f'{x:.4g}' for x in found.motion.shift)} mm after a turn by {angle:.4g} degrees about "
                f"{' '.join(f'{x:.3g}' for x in axis)}")
    lines = [how]
    if len(found.supports):
        lines.append(found.supports.to_string(index=False, float_format=lambda x: f"{x:.4g}"))
    return lines + [f"{item.name}: {item.answer}: {item.text}" for item in found.items]


def main(words: Sequence[str] | None = None) -> None:
    """Compare the run of the command line."""
    parser = new_parser("deviation", __doc__)
    parser.add_argument("run", type=Path, metavar="RUN", help="folder of results")
    parser.add_argument("--fixture", type=Path, required=True, metavar="FILE", help="file of the fixture, .toml")
    parser.add_argument("--at", metavar="PLACE", help=AT)
    parser.add_argument("--deck", type=Path, metavar="FILE",
                        help="write an input file that puts the part on the locators and closes the clamps")
    parser.add_argument("--verdict", action="store_true",
                        help="print the verdict, and end with exit code 1 if a deviation is outside its tolerance")
    parser.add_argument("--output", type=Path, metavar="DIR", help="folder of the results (default: RUN/deviation)")
    options = parser.parse_args(words)
    fixture = read_fixture(options.fixture)
    if options.deck:
        from dd3.fixture_deck import write_deck
        sheet = Sheet(options.run)
        write_deck(Comparison(fixture, sheet, sheet.last), options.deck)
        LOG.info(options.deck)
        return
    found = compare(options.run, fixture, options.at)
    folder = options.output or options.run / "deviation"
    write(found, fixture, folder)
    print(*said(fixture, found, is_in_fixture(fixture, found.part.sheet)), folder, sep="\n")
    if options.verdict:
        print(f"verdict: {verdict.summary(found.items)}")
        if verdict.failed(found.items):
            sys.exit(1)
