# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the closed curves of a CAD file as points for *TRIM.

    dd3 curve part.step trim.txt             the rims and holes of the faces of a part, or the wires of the file
    dd3 curve outline.dxf trim.txt --layer TRIM

STEP, IGES and BREP files are read by Gmsh, DXF files by ezdxf: lines, arcs, polylines and splines, of inserted blocks
too. What of the file is not used is listed. Curves that are joined at their ends are one; each must be closed. The
distance between the curve and the straight lines between its points is at most --chord.
"""
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from dd3.account import Account
from dd3.command import new_parser
from dd3.dxf import pieces_of_dxf
from dd3.errors import LOG, Problem
from dd3.gmsh_session import session
from dd3.tools.cad_account import enter_cad
from dd3.tools.cad_file import refuse_cut

MOST = 4096  # pieces of an edge
JOIN = 1e-4  # largest gap between ends that are joined, over the size of all curves


def pieces_of_cad(path: Path, chord: float, account: Account) -> list[np.ndarray]:
    """Return the free edges of the faces of a CAD file as points, or all its edges if it has no faces."""
    refuse_cut(path)
    with session(path) as gmsh:
        gmsh.model.occ.synchronize()
        enter_cad(path, account, len(gmsh.model.getEntities(2)))
        edges = [tag for _, tag in gmsh.model.getEntities(1)]
        if gmsh.model.getEntities(2):
            faces = {tag: len(gmsh.model.getAdjacencies(1, tag)[0]) for tag in edges}
            for tag in (tag for tag in edges if not faces[tag]):
                account.enter(str(path), f"{gmsh.model.getType(1, tag)} {tag}").leave("no border of a face")
            edges = [tag for tag in edges if faces[tag] == 1]
        found = []
        for tag in edges:
            (low,), (high,) = gmsh.model.getParametrizationBounds(1, tag)
            found.append(sampled(lambda t, tag=tag: np.reshape(  # type: ignore[misc]
                gmsh.model.getValue(1, tag, t), (-1, 3)), low, high, chord))
    return unpaired(found)


def sampled(value: Callable[[np.ndarray], np.ndarray], low: float, high: float, chord: float) -> np.ndarray:
    """Return points of a curve in equal steps of its parameter, close enough for the chord."""
    count = 1
    while True:
        points = value(np.linspace(low, high, 2 * count + 1))
        sag = np.linalg.norm(points[1::2] - 0.5 * (points[:-1:2] + points[2::2]), axis=1).max()
        if (sag <= chord and count >= 4) or count > MOST:
            straight = sag <= 1e-9 * np.linalg.norm(points[-1] - points[0])
            return points[[0, -1]] if straight else points
        count *= 2


def unpaired(pieces: list[np.ndarray]) -> list[np.ndarray]:
    """Return the edges that no other one lies on: faces that are not sewn have each its own edge at a joint."""
    if len(pieces) < 2:
        return pieces
    size = np.ptp(np.vstack(pieces), axis=0).max()
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
    size = np.ptp(np.vstack(pieces), axis=0).max()
    near = JOIN * size
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
    return sorted(found, key=lambda points: -float(np.ptp(points, axis=0).max()))


def write_curves(target: Path, curves: Sequence[np.ndarray], source: object) -> None:
    """Write curves as *TRIM reads them."""
    blocks = ["".join(f"{x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in points) for points in curves]
    target.write_text(f"# {len(curves)} closed curves of {source}, mm\n" + "\n".join(blocks), encoding="utf-8")


def read_curves(path: Path) -> list[np.ndarray]:
    """Read curves that `write_curves` has written."""
    blocks: list[list[list[float]]] = [[]]
    for line in path.read_text(encoding="utf-8").splitlines():
        words = line.partition("#")[0].split()
        if words:
            blocks[-1].append([float(word) for word in words])
        elif blocks[-1] and not line.strip():
            blocks.append([])
    return [np.array(block) for block in blocks if block]


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
    pieces = pieces_of_dxf(options.file, options.chord, options.layer, sampled, account) if dxf else pieces_of_cad(
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
