# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the closed curves of a CAD file as points for *TRIM.

    dd3 curve part.step trim.txt             the rims and holes of the faces of a part, or the wires of the file
    dd3 curve outline.dxf trim.txt --layer TRIM

STEP, IGES and BREP files are read by Gmsh, DXF files by ezdxf: lines, arcs, polylines and splines, of inserted blocks
too. What of the file is not used is listed. Curves that are joined at their ends are one; each must be closed. The
distance between the curve and the straight lines between its points is at most --chord.
"""
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from dd3.account import Account
from dd3.command import new_parser
from dd3.dxf import EQUAL, NO_LENGTH, pieces_of_dxf
from dd3.errors import LOG, Problem
from dd3.gmsh_session import session
from dd3.pieces import JOIN, length_of, points_only, repeated, sampled, size_of
from dd3.tables import read_text
from dd3.tools.cad_account import enter_cad
from dd3.tools.cad_file import refuse_cut

PLANE = 1e-6  # distance of points from a plane over the size of their curve
NO_AREA = 1e-8  # of a curve, over the square of its length
PLACES = {"Line": 3, "Circle": 33, "Ellipse": 33}  # of an edge that are looked at
PLACES_OF_OTHERS = 2049  # Gmsh does not give the knots


def pieces_of_cad(path: Path, chord: float, account: Account) -> list[np.ndarray]:
    """Return the free edges of the faces of a CAD file as points, or all its edges if it has no faces."""
    refuse_cut(path)
    with session(path) as gmsh:
        gmsh.model.occ.synchronize()
        faces = [tag for _, tag in gmsh.model.getEntities(2)]
        enter_cad(path, account, len(faces))
        edges = [tag for _, tag in gmsh.model.getEntities(1)]
        names = {tag: f"{gmsh.model.getType(1, tag)} {tag}" for tag in edges}
        if faces:
            twice = equal_faces(gmsh, faces)
            for tag in twice:
                account.enter(str(path), f"face {tag} ({gmsh.model.getType(2, tag)})").leave(EQUAL)
            beside = {tag: list(gmsh.model.getAdjacencies(1, tag)[0]) for tag in edges}
            for tag in (tag for tag in edges if not beside[tag]):
                account.enter(str(path), names[tag]).leave("no border of a face")
            # A face has the seam at which it closes twice.
            sides = Counter(abs(tag) for face in faces if face not in twice for _, tag in
                            gmsh.model.getBoundary([(2, face)], combined=False))
            edges = [tag for tag in edges if sides[tag] == 1]
        found = {tag: edge_points(gmsh, tag, chord) for tag in edges}
        box = np.reshape(gmsh.model.getBoundingBox(-1, -1), (2, 3))
    points = [edges[index] for index in points_only(list(found.values()), float(np.ptp(box, axis=0).max()))]
    if faces:  # those are poles
        return unpaired([piece for tag, piece in found.items() if tag not in points])
    found = left_out(path, found, points, NO_LENGTH, names, account)
    tags = list(found)
    same = [tags[index] for index in repeated(list(found.values()), chord)]
    return list(left_out(path, found, same, EQUAL, names, account).values())


def left_out(path: Path, found: dict[int, np.ndarray], tags: list[int], why: str, names: dict[int, str],
             account: Account) -> dict[int, np.ndarray]:
    """Return the edges without some, which are entered with the reason."""
    for tag in tags:
        account.enter(str(path), names[tag]).leave(why)
    return {tag: points for tag, points in found.items() if tag not in tags}


def edge_points(gmsh: Any, tag: int, chord: float) -> np.ndarray:
    """Return points of an edge of a CAD model."""
    (low,), (high,) = gmsh.model.getParametrizationBounds(1, tag)
    count = PLACES.get(gmsh.model.getType(1, tag), PLACES_OF_OTHERS)
    return sampled(lambda t: np.reshape(gmsh.model.getValue(1, tag, t), (-1, 3)), np.linspace(low, high, count), chord)


def equal_faces(gmsh: Any, tags: list[int]) -> set[int]:
    """Return the faces that are equal to an earlier one: with its box, area and centre."""
    boxes = np.array([gmsh.model.getBoundingBox(2, tag) for tag in tags])
    near = JOIN * float((boxes[:, 3:].max(0) - boxes[:, :3].min(0)).max())
    found: set[int] = set()
    for i, j in sorted(cKDTree(boxes).query_pairs(near)):
        first, other = (np.array([gmsh.model.occ.getMass(2, tags[index]) ** 0.5,
                                  *gmsh.model.occ.getCenterOfMass(2, tags[index])]) for index in (i, j))
        if tags[i] not in found and (abs(first - other) <= near).all():
            found.add(tags[j])
    return found


def unpaired(pieces: list[np.ndarray]) -> list[np.ndarray]:
    """Return the edges that no other one lies on: faces that are not sewn have each its own edge at a joint."""
    if len(pieces) < 2:
        return pieces
    size = size_of(pieces)
    keys = np.array([np.hstack((piece[[0, -1]].mean(0), arc_middle(piece), abs(piece[0] - piece[-1])))
                     for piece in pieces])
    pairs = cKDTree(keys).query_pairs(JOIN * size)
    twice = {index for pair in pairs for index in pair}
    return [piece for index, piece in enumerate(pieces) if index not in twice]


def arc_middle(points: np.ndarray) -> np.ndarray:
    """Return the point in the middle of the length of a line."""
    length = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))))
    return np.array([np.interp(0.5 * length[-1], length, points[:, axis]) for axis in range(3)])


def joined(path: Path, pieces: list[np.ndarray]) -> list[np.ndarray]:
    """Return closed curves of pieces that are joined at their ends; the first point is not repeated."""
    if not pieces:
        raise Problem(f"{path}: no curve" + ("" if path.suffix.lower() == ".dxf" else
                                             ": a solid has no free edges; give its faces, or a wire"))
    near = JOIN * size_of(pieces)
    ends = np.array([piece[[0, -1]] for piece in pieces]).reshape(-1, 3)
    partner = np.full(len(ends), -1)
    for i, j in sorted(cKDTree(ends).query_pairs(near), key=lambda pair: np.linalg.norm(ends[pair[0]] - ends[pair[1]])):
        if partner[i] < 0 and partner[j] < 0:
            partner[i], partner[j] = j, i
    if (partner < 0).any():
        at = ", ".join(f"({x:.6g} {y:.6g} {z:.6g})" for x, y, z in ends[partner < 0][:6])
        raise Problem(f"{path}: curves that are not closed end at {at}")
    left, found = set(range(len(pieces))), []
    while left:
        piece = min(left)
        end, parts = 2 * piece, []
        while piece in left:
            left.remove(piece)
            points = pieces[piece] if end % 2 == 0 else pieces[piece][::-1]
            parts.append(points[:-1])
            end = int(partner[end ^ 1])
            piece = end // 2
        found.append(np.vstack(parts))
        if without_area(found[-1]):
            x, y, z = found[-1][0]
            raise Problem(f"{path}: a closed curve without area begins at ({x:.6g} {y:.6g} {z:.6g})")
    return sorted(found, key=lambda points: -float(np.ptp(points, axis=0).max()))


def without_area(points: np.ndarray) -> bool:
    """Tell whether a closed curve has fewer than three points, or lies in a plane and has no area."""
    if len(points) < 3:
        return True
    to = points - points.mean(axis=0)
    scatter = np.linalg.svd(to, compute_uv=False)
    area = 0.5 * np.linalg.norm(np.cross(to, np.roll(to, -1, axis=0)).sum(axis=0))
    closed = np.vstack([points, points[:1]])
    return bool(scatter[2] <= PLANE * scatter[0] and area <= NO_AREA * length_of(closed)**2)


def write_curves(target: Path, curves: Sequence[np.ndarray], source: object) -> None:
    """Write curves as *TRIM reads them."""
    blocks = ["".join(f"{x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in points) for points in curves]
    target.write_text(f"# {len(curves)} closed curves of {source}, mm\n" + "\n".join(blocks), encoding="utf-8")


def read_curves(path: Path) -> list[np.ndarray]:
    """Read curves as *TRIM does; the first vertex is not repeated at their end."""
    blocks: list[list[list[float]]] = [[]]
    for number, line in enumerate(read_text(path).splitlines(), 1):
        words = line.partition("#")[0].lower().replace("d", "e").split()
        if words:
            try:
                x, y, z = map(float, words)
            except ValueError:
                raise Problem(f"{path}:{number}: error: expected x y z, mm, not '{line.strip()}'") from None
            blocks[-1].append([x, y, z])
        elif blocks[-1] and not line.strip():
            blocks.append([])
    found = [np.array(block[:-1] if len(block) > 1 and block[0] == block[-1] else block) for block in blocks if block]
    if not found:
        raise Problem(f"{path}: error: no curve; expected lines x y z, mm")
    return found


def main(words: Sequence[str] | None = None) -> None:
    """Write the curves of the command line."""
    parser = new_parser("curve", __doc__)
    parser.add_argument("file", type=Path, metavar="FILE", help="STEP, IGES, BREP or DXF file")
    parser.add_argument("output", type=Path, metavar="OUTPUT", help="file of points")
    parser.add_argument("--chord", type=float, default=0.01, metavar="LENGTH",
                        help="largest distance from the curve, mm (0.01)")
    parser.add_argument("--layer", help="layer of a DXF file (default: all)")
    options = parser.parse_args(words)
    if not options.file.is_file():
        raise Problem(f"{options.file}: No such file")
    if not 0 < options.chord < np.inf:
        parser.error("--chord: takes a length above 0")
    dxf = options.file.suffix.lower() == ".dxf"
    if options.layer and not dxf:
        parser.error("--layer: only of a DXF file")
    account = Account()
    pieces = pieces_of_dxf(options.file, options.chord, options.layer, account) if dxf else pieces_of_cad(
        options.file, options.chord, account)
    if not pieces:
        say_left_out(account)
    curves = joined(options.file, pieces)
    write_curves(options.output, curves, options.file.name)
    for number, points in enumerate(curves, 1):
        low, high = points.min(0), points.max(0)
        box = ", ".join(f"{axis} {a:.4g} to {b:.4g}" for axis, a, b in zip("xyz", low, high))
        LOG.info(f"curve {number}: {len(points)} points, {box} mm")
    say_left_out(account)


def say_left_out(account: Account) -> None:
    """Print what was not used."""
    for item in account.left_out():
        LOG.info(f"left out: {item}")
