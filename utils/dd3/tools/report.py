# SPDX-License-Identifier: GPL-3.0-or-later
"""Report on a tool's surface: what it is made of, warnings, and errors that name the faces."""
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from dd3.progress import doing
from dd3.tools.joints import OPPOSITE, Joints, find_joints, folded, kinks, near_misses, normals_along, signs
from dd3.tools.settings import ToolSettings
from dd3.tools.surface import Surface, grid, points_at

SMALLEST, LARGEST = 5.0, 1e4  # boxes beyond these have other units, mm
REACH = 1.0  # largest distance of free edges that count as a near miss, mm
SHARP = 5.0  # kinks above this are edges of the tool, degrees
CREASE = 0.3  # kinks above this are no smooth joints for the program, degrees
MOST_NAMES = 6
MADE = {"wall", "shoulder", "flange", "strip", "holder"}  # names of faces that are made around a part


class Named(Protocol):
    """What has names of faces."""

    names: list


@dataclass
class Report:
    """Lines of the report, warnings, errors."""

    lines: list = field(default_factory=list)
    warnings: list = field(default_factory=list)
    errors: list = field(default_factory=list)

    def add(self, title: str, text: str) -> None:
        """Add a line."""
        self.lines.append(f"  {title:<10} {text}")


def plural(count: int, word: str) -> str:
    """Return a number with its noun."""
    many = word[:-1] + "ies" if word.endswith("dy") else word + ("es" if word.endswith("ch") else "s")
    return f"{count} {word if count == 1 else many}"


def named(surface: Named, faces: Iterable[int]) -> str:
    """Return the names of faces of a surface or a model, the first few of many."""
    names = list(dict.fromkeys(surface.names[face] for face in faces))
    return ", ".join(names[:MOST_NAMES]) + (f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else "")


def where(point: np.ndarray) -> str:
    """Return a point as a text."""
    return " ".join(f"{value:.4g}" for value in point + 0.0)


def place_of(joints: Joints, edge: int) -> str:
    """Return the middle of an edge as a text."""
    return "x y z = " + where(joints.points[edge, 2])


@doing("judging a tool")
def judge(surface: Surface, options: ToolSettings, parts: int) -> tuple[Report, Joints]:
    """Return the report on a surface, and its joints. `options` has kind, thickness, tolerance and sew."""
    report, joints = Report(), find_joints(surface.net)
    bodies = bodies_of(surface, joints)
    say_box(report, surface)
    report.add("made of", f"{plural(len(surface.net), 'patch')}, {plural(len(np.unique(surface.face)), 'face')}, "
               + plural(bodies, "body") + (f", {plural(parts, 'part')}" if parts else ""))
    say_edges(report, surface, joints, options)
    say_folds(report, surface)
    say_kinks(report, surface, joints)
    return report, joints


def say_box(report: Report, surface: Surface) -> None:
    """Add the box and warn of wrong units."""
    low, high = extent(surface.net)
    low, high = (np.where(np.abs(end) < 1e-9 * (high - low).max(), 0.0, end) for end in (low, high))
    spans = [f"{axis} {a:.6g} to {b:.6g}" for axis, a, b in zip("xyz", low, high)]
    report.add("box", ", ".join(spans) + " mm")
    size = (high - low).max()
    if size < SMALLEST:
        report.warnings.append(f"the tool is {size:.3g} mm large; in metres --scale 1000, in inches --scale 25.4")
    elif size > LARGEST:
        report.warnings.append(f"the tool is {size:.3g} mm large; in micrometres --scale 0.001")


def extent(net: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the smallest and the largest coordinates of the patches."""
    places = np.stack(grid(5))
    points = points_at(net, *places).reshape(-1, 3)
    count = places.shape[1]
    low, high = points.argmin(axis=0), points.argmax(axis=0)
    lower, upper = (np.array([extreme(net[[k // count]], axis, sign, places[:, k % count])
                              for axis, k in enumerate(ends)]) for sign, ends in ((-1, low), (1, high)))
    return lower, upper


def extreme(net: np.ndarray, axis: int, sign: int, place: np.ndarray) -> float:
    """Return the smallest (sign -1) or largest (1) coordinate of a patch, searched from a place (u, v) of grid(5)."""
    around, step = np.stack(grid(3)) - 0.5, 0.25
    while step > 1e-9:
        places = np.clip(place[:, None] + 2 * step * around, 0, 1)
        values = points_at(net, *places)[0, :, axis]
        place, step = places[:, (sign * values).argmax()], step / 2
    return values[(sign * values).argmax()]


def say_edges(report: Report, surface: Surface, joints: Joints, options: ToolSettings) -> None:
    """Add the joined, free and multiple edges; errors for multiple ones and near misses."""
    report.add("edges", f"{len(joints.first)} joined, {len(joints.free)} free, {len(joints.multiple)} of more than two "
               f"patches, {plural(len(joints.pole), 'pole')}")
    if len(joints.multiple):
        edge = joints.multiple
        report.errors.append(f"edges of more than two patches, the first at {place_of(joints, edge[0])}: "
                             f"{named(surface, surface.face[edge // 4])}")
    if options.kind == "cad" and not options.thickness:
        return  # gaps of the CAD are refused before; the edges of faces that were left out may be near each other
    pairs, distance = near_misses(surface.net, joints, REACH)
    if len(pairs):
        worst = int(distance.argmax())
        wide = distance[worst]
        report.errors.append(
            f"{plural(len(pairs), 'pair')} of free edges up to {wide:.3g} mm apart, the widest at "
            f"{place_of(joints, pairs[worst, 0])}: {named(surface, surface.face[pairs.ravel() // 4])}; "
            + ("the offset of the part's faces does not close there: --picture shows the place" if options.kind == "cad"
               else f"--sew {up(wide):g} joins them" if wide > (options.sew or 0.0)
               else "they overlap or are divided differently; mend the file"))


def up(value: float) -> float:
    """Return a round number a little above a value."""
    step = 10.0**np.floor(np.log10(max(value, 1e-6)))
    return float(f"{np.ceil(1.1 * value / step * 2) / 2 * step:.3g}")


def say_folds(report: Report, surface: Surface) -> None:
    """Add an error for folded patches and for smooth faces that lie upon themselves."""
    bent = folded(surface.net)
    report.add("folds", str(len(bent)))
    if len(bent):
        middle = points_at(surface.net[bent[:1]], np.array([0.5]), np.array([0.5]))[0, 0]
        report.errors.append(f"{plural(len(bent), 'folded patch')}, the first at x y z = {where(middle)}: "
                             f"{named(surface, surface.face[bent])}{remedy(surface, surface.face[bent], '')}")


def say_kinks(report: Report, surface: Surface, joints: Joints) -> None:
    """Add the largest kink of smooth joints and the sharp edges; an error for opposite normals."""
    angle = kinks(surface.net, joints)
    smooth = angle[angle <= SHARP]
    report.add("kinks", f"largest {smooth.max() if len(smooth) else 0.0:.2g} degrees, "
               f"{int((smooth > CREASE).sum())} above {CREASE:g}")
    sharp = np.flatnonzero(angle > SHARP)
    if not len(sharp):
        return
    report.add("", f"{plural(len(sharp), 'joint')} with a sharp edge, up to {angle[sharp].max():.3g} degrees")
    back = np.flatnonzero(angle > OPPOSITE)
    if len(back):
        faces = surface.face[np.concatenate([joints.first[back], joints.second[back]]) // 4]
        report.errors.append(
            f"{plural(len(back), 'joint')} at which the surface turns back upon itself, the first at "
            f"{place_of(joints, joints.first[back[0]])}: {named(surface, faces)}"
            + remedy(surface, faces, "; leave out one of them, or export the part anew, in another format"))
    convex = sharp[is_convex(surface.net, joints, sharp)]
    if len(convex):
        report.warnings.append(
            f"{plural(len(convex), 'joint')} on sharp convex edges, the first at "
            f"{place_of(joints, joints.first[convex[0]])}: a sheet that meets them needs a radius there: "
            f"{named(surface, surface.face[joints.first[convex] // 4])}")


def remedy(surface: Surface, faces: np.ndarray, of_cad: str) -> str:
    """Return what to do with faulty faces: of the CAD, or those that were made around the part."""
    if {surface.names[face] for face in np.unique(faces).tolist()} & MADE:
        return ("; the die cannot go on there from the part: give the part a flange in the CAD program, or take a "
                "smaller --shoulder")
    return of_cad


def is_convex(net: np.ndarray, joints: Joints, chosen: np.ndarray) -> np.ndarray:
    """Tell at which joints the surface turns away from its normals."""
    t = np.array([0.5])
    normal = normals_along(net, joints.first[chosen], t)[:, 0]
    middle = points_at(net[joints.second[chosen] // 4], t, t)[:, 0]
    return ((middle - joints.points[joints.first[chosen], 2]) * normal).sum(axis=1) < 0


def bodies_of(surface: Surface, joints: Joints) -> int:
    """Return the number of connected bodies of a surface."""
    return int(signs(len(surface.net), joints.first // 4, joints.second // 4, joints.opposed)[1].max()) + 1
