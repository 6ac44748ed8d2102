# SPDX-License-Identifier: GPL-3.0-or-later
"""A part without holes, notches and lanced forms, as CAD that tools are made of; and its true rims as curves.

The faces keep their surfaces: wires are taken out of them and edges go on over an opening (see `filling`). That is done
on both sides of a solid, and the faces through its thickness are left out. Notches of a solid, and holes for which that
does not do, such as one over a whole radius, are taken out of the solid by OpenCASCADE, which extends the faces around
them until they meet. If both fail, or of a surface, only the side that the tools touch is kept. A solid that is bent
along parallel lines is replaced by its profile, extruded beyond its ends (see `profile`).
"""
import tempfile
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from dd3.part import corners as open_corners
from dd3.part.bends import ALONG, find_bends
from dd3.part.corners import Corner
from dd3.part.filling import SAME, Side
from dd3.part.openings import Opening, curves_of, middle, openings_of
from dd3.part.profile import Profile, edges_of, extrude, faces_of, profile_of
from dd3.part.reading import Fault, Reading
from dd3.part.shape import Shape
from dd3.progress import doing
from dd3.tools.brep import Topology
from dd3.tools.cad_file import silence
from dd3.tools.fillets import in_words
from dd3.tools.limits import limited

# Relative difference of areas that are equal.
EQUAL = 1e-6
# Size of a hole over that of the part from which on it is not taken out of the solid, as faces extended that far meet
# nowhere or far away, and may stay open.
LARGE = 0.5
# Distance over the size of the part by which edges of faces that were extended may be outside of its box.
BEYOND = 0.01
# Length over the thickness by which an extruded profile goes on beyond the ends of the part.
BEYOND_ENDS = 5.0
# Distance over that of equal points within which an edge is on its faces; points of an edge where that is measured.
ON_FACE, PLACES = 10.0, 33
# Processor time after which OpenCASCADE is given up, s.
TIME = 60.0


@dataclass
class Closed:
    """A part whose side is closed, a solid if it was one: text of its BREP file; the numbers in the part of the faces
    of the file, and the tags of those of the side; the edges of the side by their numbers in the part; the openings
    that were filled; the true rims of the side, the outer one first, those of lanced forms left out, in the coordinates
    of the part, mm; notes on the file that the part was read from."""

    text: str
    numbers: dict[int, int]
    taken: list[int]
    edges: dict[int, int]
    openings: list[Opening]
    curves: list[np.ndarray]
    notes: list[str]

    def load(self, gmsh: Any) -> None:
        """Read the part."""
        read_text(gmsh, self.text)


@doing("filling the openings")
def closed_part(gmsh: Any, reading: Reading, faces: list[int]) -> Closed | None:
    """Return a part whose side with the faces given is closed, None if it is so already. What cannot be filled is a
    fault of the reading. The session has the part as it was read."""
    shape = reading.shape
    openings, outer = openings_of(gmsh, shape, faces)
    curves = curves_of(gmsh, reading.path, shape, faces)
    profile = profile_of(shape, reading.sheet, reading.bends) if reading.solid else None
    if profile:
        return extruded(gmsh, reading, profile, faces, openings, curves)
    pairs = open_corners.pairs_of(reading)
    if not reading.solid and (found := open_corners.find_corners(shape, faces)):
        reading.warnings.append(left_open(found, "the part is a surface: give its solid"))
    if not openings and not pairs:
        return None
    both = [openings_of(gmsh, shape, side) for side in reading.sheet.sides]
    # A relief at an open corner goes with it.
    openings, *inner = ([one for one in some if not is_at_corner(shape, one, pairs)]
                        for some in (openings, *(found for found, _ in both)))
    both = [(found, rim) for found, (_, rim) in zip(inner, both)]
    inside = {tuple(middle(gmsh, edge)): edge for edge in shape.edges_inside(faces)}
    left: list[Opening] = []
    with silence():
        whole = side_of(gmsh, shape, written_by(gmsh), set(shape.tags), outer)
        text, _, _ = whole.result({})  # without other parts of the file
        solid, left_of_solid = closed_solid(gmsh, reading, text, whole, both)
        left = [one for one in openings if any(set(one.edges) == set(other.edges) for other in left_of_solid)]
        side = solid or whole
        if solid is None or left:
            alone = side_of(gmsh, shape, text, set(faces), outer)
            left_alone = alone.filled(openings)
            if solid is None or len(left_alone) < len(left):
                side, left = alone, left_alone
    large = [opening for opening in left if opening.size > LARGE * shape.size]
    for opening in left:
        if any(opening is one for one in large):
            continue
        reading.faults.append(Fault(f"{opening.said} is not filled, {why(shape, faces, opening)}", opening.faces,
                                    opening.edges))
    rims = len(side.loops(set(faces)))
    if len(left) == len(large) and rims != 1 + sum(not opening.notch for opening in large):
        reading.faults.append(Fault(f"{rims} rims are left after {len(openings)} openings were filled: close them in "
                                    "the CAD program, or choose faces by --faces"))
    filled = [one.words for one in openings if not any(one is other for other in left)]
    notes = [*reading.left_out, *reading.notes, *([f"filled: {summary(filled)}"] if filled else []),
             *(f"left open, as it is larger than half of the part: {opening.said}" for opening in large)]
    text, numbers, edges = side.result(inside)
    if side.continued and (off := off_faces(gmsh, text, side.continued)) > ON_FACE * side.near:
        reading.faults.append(Fault(f"edges that go on over openings are up to {off:.3g} mm off the faces beside them: "
                                    "close the openings in the CAD program, or choose faces by --faces"))
    if pairs and not reading.faults:
        text, numbers, edges, said = with_corners(gmsh, reading, (text, numbers, edges), inside, pairs)
        notes += said
    return Closed(text, numbers, [tag for tag, number in numbers.items() if number in set(faces)], edges, openings,
                  curves, notes)


def is_at_corner(shape: Shape, opening: Opening, pairs: list[tuple[Corner, Corner]]) -> bool:
    """Tell whether an opening is a part of an open corner: all its faces through the thickness are of that."""
    beside = {tag for edge in opening.edges for tag in shape.edges[edge].faces} - set(opening.faces)
    return any(beside <= one.through | other.through for one, other in pairs)


def left_open(corners: list[Corner], reason: str) -> str:
    """Return what is said of corners that stay open."""
    places = "; ".join(one.said for one in corners)
    return (f"the tools have the open corners of the part, at x y z = {places}, as {reason}. A sheet that is "
            "drawn over them leaves the tools there: close them in the CAD program")


def with_corners(gmsh: Any, reading: Reading, part: tuple[str, dict[int, int], dict[int, int]],
                 inside: dict[tuple[float, ...], int], pairs: list[tuple[Corner, Corner]]
                 ) -> tuple[str, dict[int, int], dict[int, int], list[str]]:
    """Return the text of a solid whose open corners are closed, the numbers of its faces, and the edges of the side by
    their numbers in the part, `inside` by their middles; and notes. It is as it was, with a warning of the reading, if
    OpenCASCADE does not close them."""
    text, numbers, edges = part
    near = SAME * reading.shape.size
    read_text(gmsh, text)
    try:
        with silence():
            number, radii = open_corners.closed_solid(gmsh, numbers, pairs, reading.sheet.thickness or 0.0)
    except Exception:  # Gmsh raises nothing more specific
        reading.warnings.append(left_open([one for one, _ in pairs], "OpenCASCADE does not close them"))
        return *part, []
    known = {tag: Known(gmsh.model.occ.getMass(2, tag), np.array(gmsh.model.occ.getCenterOfMass(2, tag)),
                        np.zeros((0, 3))) for tag in number}
    text = written_by(gmsh)
    read_text(gmsh, text)
    old = numbers_of(gmsh, [tag for _, tag in gmsh.model.getEntities(2)], known, near)
    middles = {edge: middle(gmsh, edge) for _, edge in gmsh.model.getEntities(1)}
    wanted = {one: point for point, one in inside.items() if one in edges}
    edges = {one: edge for one, point in wanted.items() for edge, at in middles.items()
             if np.linalg.norm(at - point) <= near}
    return (text, {tag: number[one] for tag, one in old.items()}, edges,
            [f"closed: {len(pairs)} open corners between walls, rounded by {in_words(radii)} between these"])


def why(shape: Shape, faces: list[int], opening: Opening) -> str:
    """Return why an opening of a side is not filled, and what to do."""
    beside = [bend for bend in find_bends(shape, faces) if set(bend.faces) & set(opening.faces)]
    if any(abs(one.axis @ beside[0].axis) < ALONG for one in beside):
        return ("as walls that are bent along lines in different directions end there, with an open corner: the part "
                "is folded from a blank that is cut there before, not drawn. Close the corner in the CAD program to "
                "draw and trim it, or bend the walls one after the other on a press brake")
    if beside and opening.notch:
        return ("as the sheet goes on beside a bend there: it has to be cut before it is bent, a cut after the stroke "
                "cannot make it. End the sheet at the bend in the CAD program, or bend the cut blank on a press brake")
    if opening.notch and len(opening.faces) == 1:
        return ("as the rims on its two sides, such as those of tabs, do not go on behind it: end that face at one "
                "line or curve in the CAD program, and cut it after the draw")
    return "as faces end there that do not go on behind it: close it in the CAD program, or choose faces by --faces"


def extruded(gmsh: Any, reading: Reading, profile: Profile, faces: list[int], openings: list[Opening],
             curves: list[np.ndarray]) -> Closed:
    """Return the extruded profile of a part, longer than the part: the blank covers it and is cut at its ends."""
    beyond = BEYOND_ENDS * (reading.sheet.thickness or 0.0)
    floor = {tag for tag, role in reading.roles.items() if role.name == "floor"}
    own, profile = profile, profile.continued(beyond, floor)
    across = any((one.points != other.points).any() for one, other in zip(own.chains, profile.chains))
    with silence():
        extrude(gmsh, profile)
        text = written_by(gmsh)
        read_text(gmsh, text)
    numbers, edges = faces_of(gmsh, profile), edges_of(gmsh, profile, reading.shape)
    notes = [*reading.left_out, *reading.notes,
             f"profile of the bent part, continued by {beyond:.3g} mm beyond its ends"
             + (", and beyond the open end of its floor" if across else ""),
             *(["filled: " + summary([one.words for one in openings])] if openings else [])]
    return Closed(text, numbers, [tag for tag, number in numbers.items() if number in set(faces)], edges, openings,
                  curves, notes)


def summary(words: list[str]) -> str:
    """Return words, those that are there several times with their number."""
    return ", ".join(f"{count} x {word}" if count > 1 else word for word, count in Counter(words).items())


def off_faces(gmsh: Any, text: str, edges: list[int]) -> float:
    """Return the largest distance of points of edges of a BREP file from where their faces have them, mm."""
    read_text(gmsh, text)
    largest = 0.0
    for edge in edges:
        low, high = (bound[0] for bound in gmsh.model.getParametrizationBounds(1, edge))
        places = np.linspace(low, high, PLACES)
        points = np.array(gmsh.model.getValue(1, edge, places))
        for face in gmsh.model.getAdjacencies(1, edge)[0]:
            uv = gmsh.model.reparametrizeOnSurface(1, edge, places, face)
            largest = max(largest, np.abs(gmsh.model.getValue(2, face, uv) - points).max())
    return float(largest)


def closed_solid(gmsh: Any, reading: Reading, text: str, whole: Side, both: list[tuple[list[Opening], set[int]]]
                ) -> tuple[Side | None, list[Opening]]:
    """Return the faces of the solid of a sheet whose openings were filled on both sides, None if that cannot be, and
    those that are left: `whole` are its faces, which are changed, `text` is the BREP file of them as they were, and
    `both` has the openings of each side and the faces at its outer rim."""
    shape, sheet = reading.shape, reading.sheet
    if not reading.solid or not all(sheet.sides):
        return None, []
    openings = [opening for one, _ in both for opening in one]
    rims = set(sheet.rims)
    walls = [{tag for edge in opening.edges for tag in shape.edges[edge].faces} & rims for opening in openings]
    fixed = set().union(*(outer for _, outer in both), rims - set().union(*walls))
    hard = {i for i, opening in enumerate(openings) if opening.notch}
    side = whole
    for _ in range(2):
        side.fixed = fixed
        easy = [i for i in range(len(openings)) if i not in hard]
        side.remove(set().union(*(walls[i] for i in easy)))
        left = side.filled([openings[i] for i in easy])
        if not left:
            break
        hard |= {i for i in easy if any(openings[i] is one for one in left)}
        side = side_of(gmsh, shape, text, set(shape.tags), fixed)
    if left:
        return None, []
    # OpenCASCADE is the faster the fewer openings the solid has. What it does not take out is left.
    tried = [i for i in hard if not openings[i].formed and openings[i].size <= LARGE * shape.size]
    taken = set[int]()
    at_once = [set().union(*(walls[i] for i in tried))] if tried else []
    bent = {tag for faces in sheet.sides for bend in find_bends(shape, faces) for tag in bend.faces}
    tried.sort(key=lambda i: not bent & set(openings[i].faces))
    each = [set(one) for one in dict.fromkeys(tuple(sorted(walls[i])) for i in tried)]
    untried = list[set[int]]()
    for some in (at_once, each if len(each) > 1 else []):
        for k, inside in enumerate(some):
            if inside <= taken:
                continue
            new, known = without(gmsh, side, inside)
            if new:
                other = side_of(gmsh, shape, new, set(shape.tags), fixed, (sheet.sides, known))
                if not inside & set(other.numbers) and not other.loops(set(shape.tags)):
                    side, taken = other, taken | inside
            # The part is refused for an opening beside a bend, whatever becomes of the others.
            if some is each and not inside <= taken and any(walls[i] == inside and bent & set(openings[i].faces)
                                                            for i in tried):
                untried = each[k + 1:]
                break
    left = [openings[i] for i in hard if not walls[i] <= taken and walls[i] not in untried]
    return (None, []) if side.loops(set(shape.tags)) else (side, left)


def read_text(gmsh: Any, text: str) -> None:
    """Read the text of a BREP file into the session, in place of what is there."""
    gmsh.clear()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "part.brep"
        path.write_text(text, encoding="utf-8")
        gmsh.model.occ.importShapes(str(path), highestDimOnly=False)
    gmsh.model.occ.synchronize()


def written_by(gmsh: Any) -> str:
    """Return the text of a BREP file of the shapes of the session."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "part.brep"
        gmsh.write(str(path))
        return path.read_text(encoding="utf-8")


@dataclass
class Known:
    """What is known of a face: its area, mm2, its centroid, and its vertices (n, 3)."""

    area: float
    centre: np.ndarray
    vertices: np.ndarray


def side_of(gmsh: Any, shape: Shape, text: str, faces: set[int], fixed: set[int],
            changed: tuple[tuple[list[int], list[int]], dict[int, Known]] | None = None) -> Side:
    """Return faces of a part in a BREP file, which the session reads. With both sides of the part and its faces before
    a change, those that were changed get numbers by their vertices."""
    read_text(gmsh, text)
    topology = Topology.of(text)
    tags = [tag for _, tag in gmsh.model.getEntities(2)]
    known = changed[1] if changed else {tag: Known(shape.areas[tag], shape.centres[tag], np.zeros((0, 3)))
                                        for tag in shape.tags}
    number = numbers_of(gmsh, tags, known, SAME * shape.size)
    if changed:
        vertices = {tag: face.vertices for tag, face in known.items()}
        for tag in [tag for tag in tags if tag not in number]:
            number[tag] = number_by_vertices(corners(gmsh, tag), changed[0], vertices, set(number.values()),
                                             SAME * shape.size)
    edges = dict(zip((part.record for part in topology.found("Ed")), (tag for _, tag in gmsh.model.getEntities(1))))
    chosen = [(part, number[tag]) for part, tag in zip(topology.found("Fa"), tags) if number.get(tag) in faces]
    return Side(gmsh, topology, [part for part, _ in chosen], [one for _, one in chosen], fixed, edges,
                SAME * shape.size)


def numbers_of(gmsh: Any, tags: list[int], known: dict[int, Known], near: float) -> dict[int, int]:
    """Return the numbers of the faces that are as they were, by area and centre."""
    old = list(known)
    away, at = cKDTree([known[tag].centre for tag in old]).query(
        [gmsh.model.occ.getCenterOfMass(2, tag) for tag in tags], k=min(4, len(old)))
    found = {}
    for tag, distances, places in zip(tags, np.reshape(away, (len(tags), -1)), np.reshape(at, (len(tags), -1))):
        area = gmsh.model.occ.getMass(2, tag)
        same = [old[k] for k, distance in zip(places, distances)
                if distance <= near and abs(known[old[k]].area - area) <= EQUAL * area]
        if same:
            found[tag] = same[0]
    return found


def corners(gmsh: Any, tag: int) -> np.ndarray:
    """Return the vertices of a face (n, 3)."""
    points = gmsh.model.getBoundary([(2, tag)], combined=False, oriented=False, recursive=True)
    return np.reshape([gmsh.model.getValue(0, point, []) for _, point in points], (-1, 3))


def number_by_vertices(points: np.ndarray, sides: tuple[list[int], list[int]], vertices: dict[int, np.ndarray],
                       used: set[int], near: float) -> int:
    """Return the number of a face that was changed: of the faces of that side all of whose known vertices it has, or of
    those through the thickness, the one with which it has the most vertices in common; 0 without one."""
    def common(of: list[int]) -> np.ndarray:
        known = [vertices[tag] for tag in of if len(vertices.get(tag, ()))]
        return cKDTree(np.concatenate(known)).query(points)[0] <= near if known else np.zeros(len(points), bool)

    known = common(list(vertices))
    side = next((one for one in sides if (common(one) == known).all()),
                [tag for tag in vertices if tag not in {*sides[0], *sides[1]}])
    return max((tag for tag in side if tag not in used), key=lambda tag: common([tag]).sum(), default=0)


def without(gmsh: Any, side: Side, walls: set[int]) -> tuple[str, dict[int, Known]]:
    """Return the text of a solid without the openings that have walls, an empty one if OpenCASCADE does not take them
    out; and what is known of its faces before."""
    text, number, _ = side.result({})
    read_text(gmsh, text)
    known = {one: Known(gmsh.model.occ.getMass(2, tag), np.array(gmsh.model.occ.getCenterOfMass(2, tag)),
                        corners(gmsh, tag)) for tag, one in number.items()}
    chosen = [tag for tag, one in number.items() if one in walls]
    low, high = box_of_edges(gmsh)
    solids = {int(solid) for tag in chosen for solid in gmsh.model.getAdjacencies(2, tag)[0]}
    try:
        with limited(TIME, "the openings are not taken out of the solid"):
            gmsh.model.occ.defeature(sorted(solids), chosen)
            gmsh.model.occ.synchronize()
    except Exception:  # Gmsh raises nothing more specific
        return "", known
    lower, higher = box_of_edges(gmsh)
    beyond = max((low - lower).max(), (higher - high).max())
    return written_by(gmsh) if beyond <= BEYOND * side.near / SAME else "", known


def box_of_edges(gmsh: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return the least and the largest coordinates of points of the edges, mm."""
    points = []
    for _, edge in gmsh.model.getEntities(1):
        low, high = (bound[0] for bound in gmsh.model.getParametrizationBounds(1, edge))
        points.append(np.reshape(gmsh.model.getValue(1, edge, np.linspace(low, high, PLACES)), (-1, 3)))
    return np.concatenate(points).min(axis=0), np.concatenate(points).max(axis=0)
