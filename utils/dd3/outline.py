# SPDX-License-Identifier: GPL-3.0-or-later
"""Find the outline of the blank that gives a wanted rim.

    dd3 outline cup.toml --curve outline --height -13.5
    dd3 outline cup.toml --curve outline --rim flange.txt --tolerance 0.3 --draws 5

The first input file of the process cuts its blank by *TRIM along a file of curves; --curve names its parameter with the
name of that file, whose first curve is the outline to start from. After each draw the sheet reaches beyond the wanted
rim by some length along it, or ends before: a plane z = --height, for the rim of a cup, or a closed curve in plan,
--rim, for that of a flange. The outline is moved by as much in the initial sheet, by the stretch of the outermost
elements, and the process runs again.

The results are in <process>.outline: the outline of each draw, deviations.csv, and the best one, outline.txt. The
operations are left as they are with this; --report writes their report.

Source: push and pull of the border by the displacements of its nodes: Padmanabhan, Oliveira, Baptista, Alves and
Menezes, J. Mater. Process. Technol. 209 (2009) 1460-1468.
"""
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dd3.curve import read_curves, write_curves
from dd3.errors import LOG, Problem
from dd3.process import (
    Operation,
    Process,
    check_deck,
    process_parser,
    read_process,
    run_with,
    write_deviations,
    write_report,
)
from dd3.programs import find_program, made_folder
from dd3.sheet import Sheet

SHARPEST = 0.4  # cosine of half the turn at a vertex, at least
NEAR = 1e-3  # distance of the rim's nodes from the outline, over its size


@dataclass
class Rim:
    """Nodes of a rim: initial place in plan and position, mm; the direction in which the sheet ends there, a unit
    vector, and the stretch along it."""

    initial: np.ndarray
    position: np.ndarray
    onward: np.ndarray
    stretch: np.ndarray


def rim_on(folder: Path, outline: np.ndarray) -> Rim:
    """Return the rim of a sheet that lay on an outline in the blank."""
    sheet = Sheet(folder)
    position = sheet.points(sheet.last)
    initial = sheet.initial(sheet.last)
    border = np.unique(sheet.rim(upper=False))
    size = np.ptp(outline, axis=0).max()
    place = Outline(outline)
    nodes = border[[abs(place.distance(point)) < NEAR * size for point in initial[border, :2]]]
    on_rim = np.zeros(len(initial), bool)
    on_rim[nodes] = True
    inner: dict[int, list[int]] = {int(node): [] for node in nodes}
    for ring in sheet.rings(upper=False):
        for a, b in zip(ring, ring[1:] + ring[:1]):
            for node, other in ((a, b), (b, a)):
                if on_rim[node] and not on_rim[other]:
                    inner[node].append(other)
    kept = np.array([node for node in nodes if inner[int(node)]])
    if not len(kept):
        raise Problem(f"{folder}: no node of the sheet lay on the outline")
    across = [np.mean([initial[node] - initial[other] for other in inner[int(node)]], axis=0) for node in kept]
    along = [np.mean([position[node] - position[other] for other in inner[int(node)]], axis=0) for node in kept]
    before, after = np.linalg.norm(across, axis=1), np.linalg.norm(along, axis=1)
    return Rim(initial[kept, :2], position[kept], np.array(along) / after[:, None], after / before)


class Outline:
    """A closed polygon in plan."""

    def __init__(self, points: np.ndarray) -> None:
        self.points = points[:, :2]
        self.side = np.roll(self.points, -1, axis=0) - self.points
        self.length = np.linalg.norm(self.side, axis=1)
        self.start = np.concatenate(([0.0], np.cumsum(self.length)))
        x, y = self.points.T
        self.turn = np.sign((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())  # 1 if counter-clockwise

    def closest(self, point: np.ndarray) -> tuple[float, np.ndarray]:
        """Return arc length and place of the closest point."""
        part = ((point - self.points) * self.side).sum(axis=1) / np.maximum(self.length**2, 1e-300)
        part = np.clip(part, 0, 1)
        places = self.points + part[:, None] * self.side
        k = int(np.linalg.norm(places - point, axis=1).argmin())
        return float(self.start[k] + part[k] * self.length[k]), places[k]

    def inside(self, point: np.ndarray) -> bool:
        """Whether a point lies inside."""
        x, y = (self.points - point).T
        a, b = np.roll(x, -1), np.roll(y, -1)
        crosses = (y > 0) != (b > 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            at = x - y * (a - x) / (b - y)
        return bool((crosses & (at > 0)).sum() % 2)

    def distance(self, point: np.ndarray) -> float:
        """Return the distance of a point, positive outside."""
        away = float(np.linalg.norm(self.closest(point)[1] - point))
        return -away if self.inside(point) else away

    def normals(self) -> np.ndarray:
        """Return the vectors at the vertices by which both sides at each move outwards by 1."""
        side = self.side / np.maximum(self.length, 1e-300)[:, None]
        mean = side + np.roll(side, 1, axis=0)
        mean /= np.maximum(np.linalg.norm(mean, axis=1), 1e-300)[:, None]
        mean /= np.maximum((mean * side).sum(axis=1), SHARPEST)[:, None]
        return self.turn * np.stack((mean[:, 1], -mean[:, 0]), axis=1)


def excess(rim: Rim, height: float | None, wanted: Outline | None, side: int = 1) -> np.ndarray:
    """Return the length by which the sheet reaches beyond the wanted rim at its nodes, mm. side: -1 for a hole."""
    if wanted is not None:
        away = np.array([wanted.distance(point) for point in rim.position[:, :2]])
        flat = np.linalg.norm(rim.onward[:, :2], axis=1)
        if flat.min() < 0.3:
            raise Problem("the rim is steep: a curve in plan does not define its length; give --height")
        return side * away / flat
    assert height is not None
    slope = rim.onward[:, 2]
    if abs(slope).min() < 0.3:
        raise Problem("the rim is flat: a height does not define its length; give --rim")
    return (rim.position[:, 2] - height) / slope


def moved(points: np.ndarray, rim: Rim, beyond: np.ndarray, side: int = 1) -> np.ndarray:
    """Return an outline moved inwards, that of a hole outwards (side: -1), by the excess of the rim, in lengths of the
    initial sheet. Between the ends of the rim its vertices are the nodes of the rim; beyond planes of symmetry they
    move with the nearest end."""
    outline = Outline(points)
    total = outline.start[-1]
    arc = np.array([outline.closest(point)[0] for point in rim.initial])
    order = np.argsort(arc)
    arc, shift = arc[order], -side * (beyond / rim.stretch)[order]
    gaps = np.diff(np.concatenate((arc, arc[:1] + total)))
    first = (int(gaps.argmax()) + 1) % len(arc)
    arc = np.concatenate((arc[first:], arc[:first] + total))
    shift = np.concatenate((shift[first:], shift[:first]))
    closed = gaps.max() < 4 * np.median(gaps)
    # The vertices beyond the ends, counted from the first node of the rim.
    own = (outline.start[:-1] - arc[0]) % total + arc[0]
    beyond_ends = np.flatnonzero(own > arc[-1] + NEAR * total) if not closed else np.array([], int)
    beyond_ends = beyond_ends[np.argsort(own[beyond_ends])]
    places = np.concatenate((arc, own[beyond_ends]))
    values = np.concatenate((shift, np.where(own[beyond_ends] > 0.5 * (arc[-1] + arc[0] + total), shift[0], shift[-1])))
    vertices = np.stack([np.interp(places % total, outline.start, np.append(column, column[0]))
                         for column in points.T], axis=1)
    vertices[:, :2] += values[:, None] * Outline(vertices).normals()
    return vertices


def outline_file(program: Path, operation: Operation) -> tuple[Path, int]:
    """Return the file of curves of the first cut of an input file, and the side that stays: 1 inside, -1 outside."""
    job, errors = check_deck(program, operation)
    if errors:
        raise Problem(errors)
    for block in job["input"]["blocks"]:
        entries = {entry["key"]: entry for entry in block["entries"]}
        if block["keyword"] == "trim" and "file" in entries and entries["file"]["at"]:
            return (Path(entries["file"]["at"]["file"]).parent / entries["file"]["value"],
                    -1 if "keep" in entries and entries["keep"]["value"] == "outside" else 1)
    raise Problem(f"{operation.deck}: error: no *TRIM with a file of curves")


def find_outline(program: Path, process: Process, name: str, height: float | None, rim_file: Path | None, draws: int,
                 tolerance: float, threads: int | None = None) -> list[tuple[float, float]]:
    """Run the draws; return the largest and the mean deviation of each, mm."""
    work = made_folder(process.path.parent / f"{process.path.stem}.outline")
    first = process.operations[0]
    source, side = outline_file(program, first)
    curves = read_curves(source)
    wanted = Outline(read_curves(rim_file)[0]) if rim_file else None
    found: list[tuple[float, float]] = []
    outlines: list[list[np.ndarray]] = []
    stopped: Problem | None = None
    for draw in range(1, draws + 1):
        path = work / f"outline_{draw}.txt"
        write_curves(path, curves, f"draw {draw} of dd3 outline {process.path.name}")
        outlines.append(curves)
        first.settings[name] = str(path.resolve())
        if not outline_file(program, first)[0].samefile(path):
            raise Problem(f"{first.deck}: error: the parameter '{name}' is not the file of curves of its *TRIM")
        stopped = run_with(program, process, [], {}, threads)
        if stopped and not found:
            raise stopped
        if stopped:
            break
        rim = rim_on(process.operations[-1].folder, curves[0])
        beyond = excess(rim, height, wanted, side)
        found.append((float(abs(beyond).max()), float(abs(beyond).mean())))
        LOG.info(f"draw {draw}: {len(beyond)} nodes of the rim, {beyond.min():+.3f} to {beyond.max():+.3f} mm beyond "
                 "it")
        if found[-1][0] <= tolerance or draw == draws:
            break
        curves = [moved(curves[0], rim, beyond, side), *curves[1:]]
    best = int(np.argmin([largest for largest, _ in found]))
    if best < len(outlines) - 1:
        again = run_with(program, process, [first], {name: str((work / f"outline_{best + 1}.txt").resolve())}, threads)
        stopped = stopped or again
    write_curves(work / "outline.txt", outlines[best], f"dd3 outline {process.path.name}")
    write_deviations(work / "deviations.csv", "draw,largest,mean", found, 1)
    LOG.info(f"outline of draw {best + 1}: {work / 'outline.txt'}")
    if stopped:
        raise Problem(f"draw {len(outlines)} stopped: {stopped}")
    return found


def main(words: Sequence[str] | None = None) -> None:
    """Find the outline of the command line."""
    parser = process_parser("outline", __doc__)
    parser.add_argument("--curve", required=True, metavar="NAME",
                        help="parameter of the first input file with the file of its outline")
    wanted = parser.add_mutually_exclusive_group(required=True)
    wanted.add_argument("--height", type=float, metavar="Z", help="wanted z of the rim, mm")
    wanted.add_argument("--rim", type=Path, metavar="FILE", help="wanted rim in plan, a file of a closed curve")
    parser.add_argument("--draws", type=int, default=5, help="draws at most (5)")
    parser.add_argument("--tolerance", type=float, default=0.3, metavar="LENGTH",
                        help="largest deviation of the rim that ends the draws, mm (0.3)")
    options = parser.parse_args(words)
    if options.draws < 1:
        parser.error("--draws: takes 1 or more")
    process = read_process(options.file)
    find_outline(find_program(options.program), process, options.curve, options.height, options.rim, options.draws,
                 options.tolerance, options.threads)
    if options.report:
        print(write_report(process))


