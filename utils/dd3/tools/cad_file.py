# SPDX-License-Identifier: GPL-3.0-or-later
"""CAD files (STEP, IGES, BREP) in Gmsh: reading, free edges, sewing, parts, and faces that lie on others."""
import os
import re
import sys
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from dd3.errors import Problem
from dd3.progress import doing
from dd3.tools.joints import to_chords
from dd3.tools.limits import limited
from dd3.tools.parameters import length_of
from dd3.tools.report import REACH, up

# Processor time after which OpenCASCADE is given up, s: reading, sewing, and on top of each for a MB of the file. It
# does not end on some files.
READ_TIME, SEW_TIME, TIME_PER_MB = 60.0, 60.0, 20.0


@contextmanager
def silence() -> Iterator[None]:
    """Discard what OpenCASCADE prints on the standard output."""
    sys.stdout.flush()
    kept = os.dup(1)
    with Path(os.devnull).open("wb") as null:
        os.dup2(null.fileno(), 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)


@doing("reading the CAD file")
def load(gmsh: Any, path: Path) -> None:
    """Read the shapes of a file."""
    gmsh.clear()
    refuse_cut(path)
    # Shapes are kept as they are; the lengths become mm by the unit that the file states.
    try:
        with silence(), limited(allowed(READ_TIME, path), f"{path}: OpenCASCADE does not end reading the file: it is "
                                "damaged, or too large"):
            gmsh.model.occ.importShapes(str(path), highestDimOnly=False)
            gmsh.model.occ.synchronize()
    except Exception as error:  # Gmsh raises nothing more specific
        raise Problem(f"{path}: not a CAD file that OpenCASCADE reads: {error}") from None
    if not gmsh.model.getEntities(2):
        kind = "curves or points only" if gmsh.model.getEntities(0) else "no shapes"
        raise Problem(f"{path}: no faces; the file holds {kind}")


def allowed(seconds: float, path: Path) -> float:
    """Return the processor time for the file, s."""
    return seconds + TIME_PER_MB * path.stat().st_size / 1e6


def refuse_cut(path: Path) -> None:
    """Refuse BREP and IGES texts without their end: OpenCASCADE does not end reading the one, and takes the part of the
    other that is there."""
    data = path.read_bytes()
    lines = data[-400:].split(b"\n")
    if path.suffix.lower() in (".brep", ".brp"):
        text = b"CASCADE Topology" in data[:200] and data.lstrip()[:4] != b"Open"
        cut = text and not re.search(rb"\*\s+[-+]\d+ \d+\s*$", data[-200:])
    else:  # the section of a line of IGES is in column 73: S is the first, T the last
        text = path.suffix.lower() in (".iges", ".igs") and data[72:73] == b"S"
        cut = text and not any(line[72:73] == b"T" for line in lines)
    if cut:
        raise Problem(f"{path}: the file is cut off")


def free_edges(gmsh: Any) -> list[int]:
    """Return the edges with one face, those without length and seams left out."""
    single = [tag for _, tag in gmsh.model.getEntities(1) if len(gmsh.model.getAdjacencies(1, tag)[0]) == 1]
    return [tag for tag in single if length_of(gmsh, tag) and not is_seam(gmsh, tag)]


def find_gaps(gmsh: Any) -> list[tuple[float, int, int]]:
    """Return each free edge beside which another one runs, with the nearest one and its largest distance from that, mm,
    the widest gap last."""
    single = free_edges(gmsh)
    fine = []
    for tag in single:
        low, high = gmsh.model.getParametrizationBounds(1, tag)
        fine.append(np.reshape(gmsh.model.getValue(1, tag, np.linspace(low[0], high[0], 65)), (-1, 3)))
    found = []
    for i, (tag, points) in enumerate(zip(single, fine)):
        limit = min(REACH, gmsh.model.occ.getMass(1, tag) / 4)
        gaps = [max(to_chords(point, other) for point in points[16:49:16]) if j != i else np.inf
                for j, other in enumerate(fine)]
        if gaps and min(gaps) <= limit:
            found.append((float(min(gaps)), tag, single[int(np.argmin(gaps))]))
    return sorted(found, key=lambda pair: pair[0])


def said_of_gaps(gmsh: Any, gaps: list[tuple[float, int, int]], sewn: float | None) -> str:
    """Return what is to be said of gaps that are left after the faces were sewn within `sewn` mm."""
    worst, *edges = gaps[-1]
    faces = [int(gmsh.model.getAdjacencies(1, tag)[0][0]) for tag in edges]
    return (f"free edges of the CAD up to {worst:.3g} mm apart, the widest between faces {faces[0]} and {faces[1]}; "
            + (f"--sew {up(worst):g} joins them" if worst > (sewn or 0.0)
               else "their courses differ, so --sew does not join them; mend the CAD"))


def refuse_gaps(gmsh: Any, path: Path, sewn: float | None) -> None:
    """Refuse free edges that run beside each other: the faces were not joined, or not sewn within `sewn` mm."""
    gaps = find_gaps(gmsh)
    if gaps:
        raise Problem(f"{path}: error: {said_of_gaps(gmsh, gaps, sewn)}")


def is_seam(gmsh: Any, edge: int) -> bool:
    """Tell whether the only face of an edge has it on both sides."""
    up = gmsh.model.getAdjacencies(1, edge)[0]
    both = [abs(tag) for _, tag in gmsh.model.getBoundary([(2, up[0])], combined=False, oriented=True)]
    return both.count(edge) > 1


@doing("sewing the faces")
def sew(gmsh: Any, path: Path, tolerance: float, wanted: bool) -> list[str]:
    """Sew faces whose edges are not shared, if that joins any; return a note. Solids are sewn if `wanted` only."""
    before = len(free_edges(gmsh)) if wanted or not gmsh.model.getEntities(3) else 0
    if not before:
        return []
    faces = len(gmsh.model.getEntities(2))
    try:
        with silence(), limited(allowed(SEW_TIME, path), f"{path}: the faces are not sewn within {tolerance:g} mm in "
                                f"{allowed(SEW_TIME, path):.0f} s of processor time: take a smaller --sew, or sew them "
                                "in the CAD program"):
            gmsh.model.occ.healShapes([], tolerance, False, False, False, True, True)
            gmsh.model.occ.synchronize()
        after = len(free_edges(gmsh))
        lost = faces - len(gmsh.model.getEntities(2))
    except Exception as error:
        if wanted:
            raise Problem(f"{path}: the faces cannot be sewn within {tolerance:g} mm: {error}") from None
        after, lost = before, 0
    if after >= before or (lost > 0 and not wanted):
        load(gmsh, path)
        return []
    return [f"sewn: {before - after} of {before} free edges of the CAD, within {tolerance:g} mm"]


def part_names(gmsh: Any) -> list[tuple[str, set[int]]]:
    """Return the parts of the model: the name and the faces of each solid, or of each set of connected faces."""
    parts = []
    for number, (_, tag) in enumerate(gmsh.model.getEntities(3), 1):
        name = gmsh.model.getEntityName(3, tag).split("/")[-1] or f"solid {number}"
        faces = {abs(face) for _, face in gmsh.model.getBoundary([(3, tag)], combined=False, oriented=False)}
        parts.append((name, faces))
    inside = set().union(*(faces for _, faces in parts))
    loose = [tag for _, tag in gmsh.model.getEntities(2) if tag not in inside]
    edges = defaultdict(list)
    for tag in loose:
        for _, edge in gmsh.model.getBoundary([(2, tag)], combined=False, oriented=False):
            edges[abs(edge)].append(tag)
    while loose:
        group, waiting = set(), [loose[0]]
        while waiting:
            tag = waiting.pop()
            if tag in group:
                continue
            group.add(tag)
            for _, edge in gmsh.model.getBoundary([(2, tag)], combined=False, oriented=False):
                waiting += edges[abs(edge)]
        name = next((gmsh.model.getEntityName(2, tag).split("/")[-1] for tag in sorted(group)
                     if gmsh.model.getEntityName(2, tag)), "")
        parts.append((name or f"shell {len(parts) + 1}", group))
        loose = [tag for tag in loose if tag not in group]
    return parts


def choose(path: Path, parts: list[tuple[str, set[int]]], wanted: list[str] | None) -> list[int]:
    """Return the tags of the faces of the parts wanted, by name or number; all by default."""
    if not wanted:
        return sorted(set().union(*(faces for _, faces in parts)))
    chosen: set[Any] = set()
    for word in wanted:
        found = [faces for number, (name, faces) in enumerate(parts, 1)
                 if word.lower() == name.lower() or word == str(number)]
        if not found:
            there = ", ".join(f"{number} '{name}'" for number, (name, _) in enumerate(parts, 1))
            raise Problem(f"{path}: no part '{word}'; there are {there}")
        chosen.update(*found)
    return sorted(chosen)


def doubled(gmsh: Any, tags: list[int]) -> list[tuple[int, int]]:
    """Return the faces that lie on an earlier one: same area, centre and box."""
    box = np.array([gmsh.model.getBoundingBox(2, tag) for tag in tags]).reshape(-1, 6)
    centre = np.array([gmsh.model.occ.getCenterOfMass(2, tag) for tag in tags]).reshape(-1, 3)
    area = np.array([gmsh.model.occ.getMass(2, tag) for tag in tags])
    size = np.linalg.norm(box[:, 3:] - box[:, :3], axis=1)
    result = {}
    for i, near in enumerate(cKDTree(centre).query_ball_point(centre, 2e-5 * size)):
        for j in sorted(near):
            if j < i and tags[j] not in result and abs(area[i] - area[j]) <= 1e-5 * area[i] and \
                    max(np.abs(box[i] - box[j]).max(), np.abs(centre[i] - centre[j]).max()) <= 1e-5 * size[i]:
                result[tags[i]] = tags[j]
                break
    return list(result.items())


def single(gmsh: Any) -> list[str]:
    """Remove the faces that lie on others, of which none belongs to a solid, as they cannot be sewn; return a note."""
    if gmsh.model.getEntities(3):
        return []
    twins = doubled(gmsh, [tag for _, tag in gmsh.model.getEntities(2)])
    gmsh.model.occ.remove([(2, tag) for tag, _ in twins], recursive=True)
    gmsh.model.occ.synchronize()
    return [said_of_doubled(twins)] if twins else []


def said_of_doubled(twins: list[tuple[int, int]]) -> str:
    """Return what is to be said of faces and those on which they lie."""
    return "doubled faces left out: " + ", ".join(f"{tag} (on {other})" for tag, other in twins)
