# SPDX-License-Identifier: GPL-3.0-or-later
"""Take over a formed sheet of LS-DYNA with its thicknesses, stresses and strains, from its dynain file.

    dd3 dynain dynain op10.out
    dd3 dynain dynain op10.out --material dp600 --points 9 --rolling 0 1 0

Shells of four nodes become elements solid_shell around their mid-surface. The folder that is written stands for that
of a run: *START takes the sheet from it (from = op10.out), so that it is released, or formed further. Stresses and
plastic strains at heights between those of the file are interpolated; --points gives the points through the thickness
(those of the file). Back-stresses start at zero. The initial blank is not known: strains and thinning count from the
formed sheet, and *TRIM does not cut it. Node sets are z_min and z_max, the faces against and along the normals of the
shells, for tools that touch them from below and from above, rim, and all.

The rolling direction is the one given (--rolling, x), turned into the sheet.
"""
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.polynomial.legendre import leggauss

from dd3.command import new_parser
from dd3.dyna.cards import Card, Row, read_cards
from dd3.errors import Problem
from dd3.programs import made_folder
from dd3.sheet_state import COLUMNS, NAME, SheetState, write_state
from dd3.tools.facet_files import dyna_lines, dyna_mesh, fields

STRESS = "*INITIAL_STRESS_SHELL"
SAME = 1e-6  # difference of heights that are one


def read_thickness(path: Path) -> dict[int, np.ndarray]:
    """Return the thicknesses at the corners of the shells by their labels, mm."""
    found: dict[int, np.ndarray] = {}
    label, inside = 0, False
    for place, line in dyna_lines(path):
        if line.startswith("*"):
            inside, label = line.strip().upper().startswith("*ELEMENT_SHELL_THICKNESS"), 0
        elif inside:
            try:
                if label:
                    words = fields(line, [16] * 4, 4)
                    found[label] = np.array([float(word or 0) for word in [*words, "", "", ""][:4]])
                    label = 0
                else:
                    label = int(fields(line, [8], 1)[0])
            except (ValueError, IndexError):
                raise Problem(f"{place}: error: a line of *ELEMENT_SHELL_THICKNESS cannot be read") from None
    return found


def read_stress(path: Path) -> dict[int, np.ndarray]:
    """Return, by the labels of the shells, rows of height (-1 to 1), the stresses xx yy zz xy yz zx, MPa, and the
    plastic strain, one for each height, the means of the points at it."""
    found: dict[int, np.ndarray] = {}
    for card in read_cards(path):
        if card.keyword.startswith(STRESS):
            at = 0
            while at < len(card.rows):
                label, rows, at = shell_stress(card, at)
                heights = np.unique(np.round(rows[:, 0] / SAME)) * SAME
                found[label] = np.array([rows[abs(rows[:, 0] - height) < 2 * SAME].mean(axis=0) for height in heights])
    return found


def shell_stress(card: Card, at: int) -> tuple[int, np.ndarray, int]:
    """Return label and rows of the shell whose entry begins in a row of a card, and the row after it."""
    head = card.row(at)
    label, plane, through, history, tensors, large = (head.label(i) for i in range(6))
    at += 1
    rows = []
    for _ in range(max(1, plane) * max(1, through)):
        if large:
            values = numbers(card.row(at), 5, 16) + numbers(card.row(at + 1), 3, 16)
            at += 2 + -(-history // 5) + -(-tensors // 5)
        else:
            values = numbers(card.row(at), 8, 10)
            at += 1 + -(-history // 8) + -(-tensors // 8)
        rows.append(values)
    return label, np.array(rows), at


def numbers(row: Row, count: int, width: int) -> list[float]:
    """Return the first numbers of a row."""
    return [row.number(i, width=width) for i in range(count)]


def sheet_of(path: Path, material: str, column: int, rolling: Sequence[float]) -> SheetState:
    """Return the sheet of a dynain file."""
    nodes, cells, _ = dyna_mesh(path)
    shells = [members for _, dim, members in cells if dim == 2]
    if not shells:
        raise Problem(f"{path}: no shells (*ELEMENT_SHELL_THICKNESS)")
    if any(len(members) != 4 for members in shells):
        raise Problem(f"{path}: {sum(len(members) != 4 for members in shells)} shells with three nodes; expected four")
    thickness, stress = read_thickness(path), read_stress(path)
    labels = list(thickness)
    if len(labels) != len(shells):
        raise Problem(f"{path}: {len(labels)} thicknesses for {len(shells)} shells")
    missing = [label for label in labels if label not in stress]
    if missing:
        raise Problem(f"{path}: no {STRESS} for {len(missing)} shells, the first {missing[0]}")
    used, corner = np.unique(np.array(shells), return_inverse=True)
    quads = corner.reshape(-1, 4)
    if any(int(node) not in nodes for node in used):
        raise Problem(f"{path}: shells name nodes that *NODE does not give")
    middle = np.array([nodes[int(node)] for node in used])
    at_corner = np.array([thickness[label] for label in labels])
    upper, lower = offset(middle, quads, at_corner)
    levels = column or max(2, max(len(rows) for rows in stress.values()))
    heights = leggauss(levels)[0]
    values = np.array([between(stress[label], heights) for label in labels])  # (m, heights, 7)
    values = np.tile(values, (1, COLUMNS, 1))
    tensor = np.zeros((*values.shape[:2], 3, 3))
    for k, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))):
        tensor[..., i, j] = tensor[..., j, i] = values[..., k]
    axes = np.repeat(sheet_axes(middle, quads, rolling)[:, None], values.shape[1], axis=1)
    points = np.stack((lower, upper), axis=1).reshape(-1, 3)
    return SheetState(points, points, np.hstack((2 * quads, 2 * quads + 1)), float(at_corner.mean()), tensor,
                      np.maximum(values[..., 6], 0.0), axes, [material], np.zeros(len(quads), int), levels,
                      node_sets(quads, len(points)))


def node_sets(quads: np.ndarray, count: int) -> dict[str, np.ndarray]:
    """Return the sets of nodes: all, those of the lower and of the upper face, by the names that they have on a blank,
    and those of the rim."""
    edges = np.sort(np.concatenate([quads[:, [k, (k + 1) % 4]] for k in range(4)]), axis=1)
    edges, times = np.unique(edges, axis=0, return_counts=True)
    rim = np.unique(edges[times == 1])
    number = np.arange(count)
    return {"all": number, "z_min": number[::2], "z_max": number[1::2], "rim": np.sort(np.append(2 * rim, 2 * rim + 1))}


def offset(middle: np.ndarray, quads: np.ndarray, thickness: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the nodes of the upper and the lower face of a sheet whose thicknesses (m, 4) lie across its elements."""
    normal = element_normals(middle, quads)
    director, share, weight = np.zeros_like(middle), np.zeros(len(middle)), np.zeros(len(middle))
    for k in range(4):
        np.add.at(director, quads[:, k], normal)
    director /= np.linalg.norm(director, axis=1)[:, None]
    for k in range(4):
        across = (director[quads[:, k]] * normal).sum(axis=1)
        np.add.at(share, quads[:, k], thickness[:, k] / np.maximum(across, 0.5))
        np.add.at(weight, quads[:, k], 1.0)
    half = 0.5 * (share / weight)[:, None] * director
    return middle + half, middle - half


def element_normals(middle: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Return the unit normals of quadrilaterals."""
    a, b, c, d = (middle[quads[:, k]] for k in range(4))
    normal = np.cross(c - a, d - b)
    return np.asarray(normal / np.linalg.norm(normal, axis=1)[:, None])


def sheet_axes(middle: np.ndarray, quads: np.ndarray, rolling: Sequence[float]) -> np.ndarray:
    """Return rolling, transverse and normal direction of each element as the columns of (m, 3, 3)."""
    normal = element_normals(middle, quads)
    first = np.array(rolling, float) - (normal @ np.array(rolling, float))[:, None] * normal
    length = np.linalg.norm(first, axis=1)
    if (length < 1e-6 * np.linalg.norm(rolling)).any():
        raise Problem("--rolling is normal to the sheet somewhere; expected a direction along it")
    first /= length[:, None]
    return np.stack((first, np.cross(normal, first), normal), axis=2)


def between(rows: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """Return rows interpolated at other heights, and continued beyond the outermost ones."""
    if len(rows) == 1:
        return np.repeat(rows[:, 1:], len(heights), axis=0)
    k = np.clip(np.searchsorted(rows[:, 0], heights) - 1, 0, len(rows) - 2)
    part = ((heights - rows[k, 0]) / (rows[k + 1, 0] - rows[k, 0]))[:, None]
    return np.asarray((1 - part) * rows[k, 1:] + part * rows[k + 1, 1:])


def main(words: Sequence[str] | None = None) -> None:
    """Take over the sheet of the command line."""
    parser = new_parser("dynain", __doc__)
    parser.add_argument("file", type=Path, metavar="FILE", help="dynain file")
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="folder to write, for *START")
    parser.add_argument("--material", default="steel", metavar="NAME", help="its material in the input file (steel)")
    parser.add_argument("--points", type=int, default=0, metavar="N",
                        help="points through the thickness (as many as in the file)")
    parser.add_argument("--rolling", type=float, nargs=3, default=[1.0, 0.0, 0.0], metavar=("X", "Y", "Z"),
                        help="rolling direction (1 0 0)")
    options = parser.parse_args(words)
    if options.points and not 2 <= options.points <= 15:
        parser.error("--points: takes 2 to 15")
    if not any(options.rolling):
        parser.error("--rolling: takes a direction")
    if not options.file.is_file():
        raise Problem(f"{options.file}: No such file")
    sheet = sheet_of(options.file, options.material, options.points, options.rolling)
    if (options.folder / "job.log").exists():
        raise Problem(f"{options.folder}: holds the results of a run; name another folder")
    write_state(made_folder(options.folder), sheet)
    print(f"{options.folder / NAME}: {len(sheet.elements)} elements, {sheet.column} points through the thickness")
