# SPDX-License-Identifier: GPL-3.0-or-later
"""Write and draw fields along a section of the sheet or a line of nodes; measure springback of a profile.

    dd3 section cup.out --plane y=0 --field thickness
    dd3 section cup.out --plane 45 --field major_strain_upper --field minor_strain_upper --table section.csv
    dd3 section rail.out --plane y=0 --bottom 0 20 --wall 30 80 --flange 95 120

A plane is x=..., y=... or z=..., or the angle from x of a plane through the z axis; it cuts the initial sheet, so that
the section is a line of material. Its table has the length along the line at the start and now, the positions at the
start and now, and the fields; where the plane cuts the sheet in several pieces, each has its own lengths, and a number
in the column piece, 1 of the longest. --bottom, --wall and --flange are ranges of the initial length of the longest:
straight lines are fitted to bottom and flange and a circle to the wall; the results are the angles between bottom and
wall and between wall and flange, where the wall begins and ends, and the radius of the wall.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dd3.command import new_parser
from dd3.errors import LOG, Problem
from dd3.fields import AT
from dd3.plot.figures import new_figure, save
from dd3.sheet import AXES, SHIFT, Line, Sheet, in_plane, length, of_pieces, plane

PLANE = 0.1  # extent of a line across its plane, over that in it at right angles to the line
STRAIGHT = 1e-7  # curvature times length below which a wall is straight


class Section:
    """A line of the sheet, of the mesh of a step, at that step: lengths, positions and fields; piece: its number where
    it is one of several, else 0."""

    def __init__(self, sheet: Sheet, line: Line, step: int, piece: int = 0) -> None:
        self.sheet, self.line, self.step, self.piece = sheet, line, step, piece
        self.start, self.now = line.at(sheet.start(step)), line.at(sheet.points(step))
        self.length0, self.length = length(self.start), length(self.now)

    def named(self) -> str:
        """Return the number of the piece, to follow other words; nothing where there is one."""
        return f", piece {self.piece}" if self.piece else ""

    def field(self, name: str) -> tuple[np.ndarray, str]:
        """Return a field, or its component as in stress:11, and its label."""
        values, label = self.sheet.component(self.step, name)
        return self.line.at(values), label

    def table(self, fields: Sequence[str]) -> pd.DataFrame:
        """Return lengths, positions and fields at the points."""
        head = ["length0", "length", *(axis + "0" for axis in AXES), *AXES, *fields]
        columns = [self.length0, self.length, *self.start.T, *self.now.T, *(self.field(name)[0] for name in fields)]
        return pd.DataFrame(np.column_stack(columns), columns=head)

    def part(self, limits: Sequence[float]) -> np.ndarray:
        """Return the points between two initial lengths."""
        inside = (self.length0 >= limits[0] - 1e-9) & (self.length0 <= limits[1] + 1e-9)
        if inside.sum() < 3:
            raise Problem(f"{inside.sum()} points between {limits[0]:g} and {limits[1]:g} mm of "
                          f"{self.length0[-1]:g} mm: expected 3 or more")
        return self.now[inside]


def pieces_of(sheet: Sheet, lines: Sequence[Line], step: int) -> list[Section]:
    """Return the pieces of a section, the longest first."""
    return [Section(sheet, line, step, number if lines[1:] else 0) for number, line in enumerate(lines, 1)]


def table_of(pieces: Sequence[Section], fields: Sequence[str]) -> pd.DataFrame:
    """Return the table of the pieces of a section, with their numbers where there are several."""
    tables = [piece.table(fields) for piece in pieces]
    if len(tables) > 1:
        for piece, table in zip(pieces, tables, strict=True):
            table.insert(0, "piece", piece.piece)
    return pd.concat(tables, ignore_index=True)


def normal_of(sections: Sequence[Section]) -> np.ndarray:
    """Return the normal of the plane through lines; that of the upright plane where they are one straight line."""
    points = np.concatenate([section.now for section in sections])
    points = points - points.mean(axis=0)
    axes = np.linalg.svd(points, full_matrices=False)[2] if len(points) > 2 else np.eye(3)
    extents = np.ptp(points @ axes.T, axis=0)
    if extents[1] <= SHIFT * sections[0].sheet.size():
        normal = np.cross(axes[0], np.eye(3)[2])
        size = np.linalg.norm(normal)
        return normal / size if size > SHIFT else np.eye(3)[1]
    if extents[2] > PLANE * extents[1]:
        raise Problem(f"{sections[0].sheet.path}: the line through the nodes lies in no plane: {extents[2]:.3g} mm "
                      f"across that of the best fit, {extents[1]:.3g} mm in it; expected --plane, in which it is seen")
    return np.asarray(axes[2])


def direction(points: np.ndarray) -> np.ndarray:
    """Return the direction of the straight line through points, forwards (total least squares)."""
    axis = np.linalg.svd(points - points.mean(axis=0))[2][0]
    return axis * np.sign(axis @ (points[-1] - points[0]))


def circle(points: np.ndarray) -> tuple[np.ndarray, float]:
    """Return centre and radius of the circle through points (Kasa's linear least squares); infinite if straight."""
    middle = points.mean(axis=0)
    local = points - middle
    scale = np.abs(local).max()
    system = np.column_stack([2 * local / scale, np.ones(len(local))])
    (a, b, c), _, rank, values = np.linalg.lstsq(system, (local**2).sum(axis=1) / scale**2, rcond=None)
    if rank < 3 or values[-1] < STRAIGHT:
        return middle, np.inf
    return middle + scale * np.array([a, b]), scale * np.sqrt(c + a**2 + b**2)


def tangents(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Return the directions at the start and the end of a wall, and its radius."""
    centre, radius = circle(points)
    if not radius < 1e6 * length(points)[-1]:
        return direction(points), direction(points), np.inf
    along = points[-1] - points[0]
    ends = []
    for point in (points[0], points[-1]):
        x, z = point - centre
        tangent = np.array([-z, x]) / np.hypot(x, z)
        ends.append(tangent * np.sign(tangent @ along))
    return ends[0], ends[1], radius


def angle_between(one: np.ndarray, other: np.ndarray) -> float:
    """Return the angle enclosed by two sides that follow one another, in degrees: 180 if they are straight on."""
    return float(180 - np.degrees(np.arccos(np.clip(one @ other, -1, 1))))


def springback(section: Section, normal: np.ndarray, ranges: Mapping[str, Sequence[float]]
               ) -> list[tuple[str, float, str]]:
    """Return names, values and units of angles and radius from the ranges of bottom, wall and flange."""
    parts = {name: in_plane(section.part(limits), normal) for name, limits in ranges.items()}
    first, last, radius = tangents(parts["wall"])
    rows = []
    if "bottom" in parts:
        rows.append(("angle between bottom and wall", angle_between(direction(parts["bottom"]), first), "degrees"))
    if "flange" in parts:
        rows.append(("angle between wall and flange", angle_between(last, direction(parts["flange"])), "degrees"))
    return [*rows, ("radius of the wall", radius, "mm")]


def draw(sections: Sequence[Section], normal: np.ndarray, fields: Sequence[str], axes: Sequence[Axes]) -> None:
    """Draw the fields over the initial length and the profile below."""
    for name, place in zip(fields, axes, strict=False):
        for section in sections:
            values, label = section.field(name)
            place.plot(section.length0, values, ".-", linewidth=1.2, markersize=3,
                       label=section.sheet.state(section.step) + section.named())
        place.set_ylabel(label)
        place.set_xlabel("initial length along the section (mm)")
        place.grid(True, color="0.9")
    for section in sections:
        axes[-1].plot(*in_plane(section.now, normal).T, ".-", linewidth=1.2, markersize=3)
    axes[-1].set_aspect("equal", adjustable="datalim")
    axes[-1].set_xlabel("in the plane of the section (mm)")
    axes[-1].set_ylabel("z (mm)")
    axes[-1].grid(True, color="0.9")
    if len(sections) > 1 and fields:
        axes[0].legend(frameon=False)


def sections_of(run: str | Path, plane_at: str | None = None, *, nodes: Sequence[int] | None = None,
                lower: bool = False, at: Sequence[str] = ()) -> tuple[list[list[Section]], np.ndarray]:
    """Return the pieces of the section of the sheet of a run at each of some places (AT), by default at the last step,
    and the normal of its plane: x=0, y=12.5, an angle from x (y=0); or the line through nodes, by default in the plane
    through them. lower: on the lower face."""
    sheet = Sheet(run)
    normal, distance = plane(plane_at or "y=0")
    steps = [sheet.step_at(place) for place in at] or [sheet.last]
    found = [pieces_of(sheet, [sheet.line_of_nodes(nodes, step)] if nodes
                       else sheet.cut(normal, distance, not lower, step=step), step) for step in steps]
    return found, normal_of([pieces[0] for pieces in found]) if nodes and not plane_at else normal


def figure_of(places: Sequence[Sequence[Section]], normal: np.ndarray, fields: Sequence[str]) -> Figure:
    """Return a figure of fields along the pieces of sections in a plane, at some places (AT)."""
    sections = [section for pieces in places for section in pieces]
    drawn, axes = new_figure((7, 3 * len(fields) + 3), len(fields) + 1, squeeze=False)
    draw(sections, normal, fields, axes[:, 0])
    return drawn


def figure(run: str | Path, plane: str = "y=0", fields: Sequence[str] = ("thickness",), at: Sequence[str | float] = (),
           lower: bool = False) -> Figure:
    """Return a figure of fields along a section of the sheet of a run, at the last step or at several places."""
    at = [at] if isinstance(at, str | float | int) else at
    return figure_of(*sections_of(run, plane, lower=lower, at=[str(place) for place in at]), fields)


def main(words: Sequence[str] | None = None) -> None:
    """Draw, write and measure the section of the command line."""
    parser = new_parser("section", __doc__)
    parser.add_argument("run", metavar="RUN", help="folder of results, or its fields.vtkhdf")
    parser.add_argument("--plane", help="plane of the section: x=0, y=12.5, or an angle (y=0); that in which a line of "
                                        "nodes is seen (the one through them)")
    parser.add_argument("--nodes", type=int, nargs="+", metavar="N", help="numbers of nodes along a line instead")
    parser.add_argument("--lower", action="store_true", help="lower face of the sheet instead of the upper one")
    parser.add_argument("--field", action="append", default=[], help="field at the nodes; may be repeated (thickness)")
    parser.add_argument("--at", action="append", metavar="PLACE", help=AT + "; may be repeated")
    parser.add_argument("--bottom", type=float, nargs=2, metavar=("FROM", "TO"), help="straight bottom, mm")
    parser.add_argument("--wall", type=float, nargs=2, metavar=("FROM", "TO"), help="sidewall, mm")
    parser.add_argument("--flange", type=float, nargs=2, metavar=("FROM", "TO"), help="straight flange, mm")
    parser.add_argument("--table", metavar="FILE", help="csv file to write; of the last step if there are several")
    parser.add_argument("--output", default="section.png", help="picture to write: .png, .svg or .pdf (section.png)")
    options = parser.parse_args(words)
    if (options.bottom or options.flange) and not options.wall:
        parser.error("--bottom and --flange need --wall")
    fields = options.field or ["thickness"]
    places, normal = sections_of(options.run, options.plane, nodes=options.nodes, lower=options.lower,
                                 at=options.at or ())
    save(figure_of(places, normal, fields), options.output, 150)
    print(options.output)
    if options.table:
        table_of(places[-1], fields).to_csv(options.table, index=False, float_format="%.9g")
        print(options.table)
    if options.wall:
        ranges = {name: limits for name in ("bottom", "wall", "flange") if (limits := getattr(options, name))}
        first = places[-1][0]
        if said := of_pieces([piece.line for piece in places[-1]], first.sheet.start(first.step)):
            LOG.warning(f"{options.run}: the section is in {said}")
        for name, value, unit in springback(first, normal, ranges):
            print(f"{name}: {value:.4g} {unit}")
