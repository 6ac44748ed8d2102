# SPDX-License-Identifier: GPL-3.0-or-later
"""Take over a formed sheet of LS-DYNA with its thicknesses, stresses and strains, from its dynain file.

    dd3 dynain dynain op10.out
    dd3 dynain dynain op10.out --material dp600 --points 9 --rolling 0 1 0
    dd3 dynain dynain op10.out --units "mm GPa"
    dd3 dynain dynain op10.out --material 1=dp600 --material 2=dc06     each part its own

Shells of four nodes become elements solid_shell around their mid-surface; those that are numbered the other way round
than the others are turned over. A node of one shell on the edge of another must be bound in its middle by
*CONSTRAINED_ADAPTIVITY, as in an adaptive mesh; others would hang there, and the sheet tear. The folder that is written
stands for that of a run: *START takes the sheet from it (from = op10.out), so that it is released, or formed further.
Stresses and plastic strains at heights between those of the file are interpolated; --points gives the points through
the thickness (those of the file). Stresses are in MPa, or as --units says, which is asked for where they are hardly
those of a metal in MPa. Back-stresses start at zero. The initial blank is not known: strains and thinning count from
the formed sheet, and *TRIM does not cut it. Node sets are z_min and z_max, the faces against and along the normals of
the shells, for tools that touch them from below and from above, rim, all, and hold_x, hold_xy, ... by TC of *NODE. What
of the file is not used is listed with its line.

The rolling direction is the one given (--rolling, x), turned into the sheet.
"""
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.polynomial.legendre import leggauss

from dd3.bound import Bound, rings
from dd3.command import new_parser
from dd3.dyna.cards import LINE, TEN, Card, Reader, split
from dd3.dyna.laws import UNITS
from dd3.dyna.mesh import Cell, DynaMesh
from dd3.dyna.parameters import as_number
from dd3.dyna.shells import across, element_normals, ordered
from dd3.errors import Problem
from dd3.hanging import edges_of_hung, hanging_nodes
from dd3.programs import made_folder
from dd3.sheet_state import COLUMNS, NAME, SheetState, write_state

STRESS = "*INITIAL_STRESS_SHELL"
HEAD = "EID NPLANE NTHICK NHISV NTENSR LARGE NTHINT NTHHSV"
LARGEST = 1e30  # of a number that is read
MOST_VALUES = 10_000  # points, or variables at a point
MOST_POINTS = 15  # through the thickness
SAME = 1e-6  # difference of heights that are one
NARROW, WIDE = (16,) * 5, (20,) * 5  # columns of a row with LARGE = 1; some writers use 16
HISTORY = "history variables of LS-DYNA's material are not taken over"
DEFAULT_MATERIAL = "steel"
ODD_STRESS = 5.0, 1e4  # largest stress, MPa, outside of which another unit is likely


class Stresses:
    """The stresses of the shells by label: rows of height (-1 to 1), xx yy zz xy yz zx and the plastic strain, one for
    each height, the means of the points at it; in units of the file."""

    def __init__(self, mesh: DynaMesh, cards: list[Card]) -> None:
        self.mesh = mesh
        self.labels = {cell.label for cell in mesh.cells if cell.dimension == 2}
        self.rows: dict[int, np.ndarray] = {}
        for card in cards:
            if card.keyword == STRESS:
                at = 0
                while at < len(card):
                    at = self.take(card, at)

    def take(self, card: Card, at: int) -> int:
        """Take the shell whose entry begins in a row of a card; return the row after it."""
        head = card.row(at, HEAD)
        label, plane, through, history, tensors, large, thermal, more = (
            head.label(name) for name in HEAD.split())
        counts = [min(max(value, 0), MOST_VALUES) for value in (plane, through, history, tensors, thermal, more)]
        if label not in self.labels:
            raise Problem(f"{head.place}: error: stresses of shell {label}, which the file does not have: a row of "
                          f"{STRESS} before does not have the form that its numbers tell")
        if label in self.rows:
            raise Problem(f"{head.place}: error: a second {STRESS} of shell {label}")
        plane, through, history, tensors, thermal, more = counts
        at += 1
        # Some files have LARGE in the place of NTENSR: only rows of LARGE = 1 are wider than 80 columns.
        if not large and tensors == 1 and at < len(card) and len(card.lines[at][1].rstrip()) > LINE:
            large, tensors = 1, 0
        for name, value in (("NHISV", history), ("NTENSR", tensors), ("NTHINT", thermal)):
            if value:
                head.entry.read.discard(name)
                head.leave(HISTORY, name)
        points = []
        for _ in range(max(1, plane) * max(1, through)):
            values, at = self.point(card, at, large, history, tensors)
            points.append(values)
        at += thermal * -(-more // (5 if large else 8)) if thermal else 0
        rows = np.array(points)
        if np.abs(rows[:, 0]).max() > 1 + 1e-3:
            raise Problem(f"{head.place}: error: a height of {rows[np.abs(rows[:, 0]).argmax(), 0]:g} of shell "
                          f"{label}; expected -1 to 1")
        heights = np.unique(np.round(rows[:, 0] / SAME)) * SAME
        self.rows[label] = np.array([rows[abs(rows[:, 0] - height) < 2 * SAME].mean(axis=0) for height in heights])
        return at

    def point(self, card: Card, at: int, large: int, history: int, tensors: int) -> tuple[list[float], int]:
        """Return height, stresses and strain of a point, and the row after it."""
        width = 5 if large else 8
        last = at + (2 if large else 1) - 1
        if last >= len(card):
            raise Problem(f"{card.place}: error: {card.keyword} has {len(card)} rows, expected {last + 1}")
        columns = TEN if not large else WIDE if len(card.lines[at][1].rstrip()) > LINE else NARROW
        words = split(card.lines[at][1], columns, card.least)[:width]
        if large:
            words += split(card.lines[last][1], columns, card.least)[:3]
        values = []
        for word in words:
            value = as_number(word or "0")
            if value is None or abs(value) > LARGEST:
                raise Problem(f"{card.place_of(at)}: error: expected a number, got '{word}'")
            values.append(value)
        after = last + 1 + -(-history // width) + -(-tensors // width)
        for i in range(at, min(after, len(card))):
            card.rows.setdefault(i)
        return values, after


def thicknesses(cells: list[Cell]) -> np.ndarray:
    """Return the thicknesses at the corners of shells (m, 4)."""
    missing = [cell for cell in cells if not cell.thickness]
    if missing:
        raise Problem(f"{missing[0].place}: error: {len(cells) - len(missing)} thicknesses for {len(cells)} shells, "
                      f"none of shell {missing[0].label}; expected *ELEMENT_SHELL_THICKNESS")
    found = np.array([(*cell.thickness, 0.0, 0.0, 0.0, 0.0)[:4] for cell in cells])
    found = np.where(found == 0, found[:, :1], found)  # left out: that of the first corner
    if not (found > 0).all():
        cell = cells[int(np.flatnonzero((found <= 0).any(axis=1))[0])]
        raise Problem(f"{cell.place}: error: a thickness of {min(cell.thickness):g} of shell {cell.label}; expected a "
                      "number > 0")
    return found


def bound_of(reader: Reader, cells: list[Cell], middle: np.ndarray, quads: np.ndarray, used: np.ndarray) -> Bound:
    """Return the nodes that *CONSTRAINED_ADAPTIVITY binds by the ends of their edges; raise a Problem at others that
    hang."""
    number = {int(label): i for i, label in enumerate(used)}
    hung = [(card.place_of(i), [card.whole(i, word) for word in words[:3]])
            for card in reader.cards if card.keyword == "*CONSTRAINED_ADAPTIVITY" for i, words in card.words(0)]
    bound = edges_of_hung([(place, labels) for place, labels in hung if labels[0] in number], number, middle,
                          quads.tolist())
    found = [pair for pair in hanging_nodes(middle, quads.tolist()) if pair[0] not in bound.values()]
    if found:
        cell = cells[found[0][1]]
        raise Problem(f"{cell.place}: error: node {used[found[0][0]]} lies on an edge of shell {cell.label} that does "
                      f"not have it ({len(found)} such nodes): the sheet would tear there; expected "
                      "*CONSTRAINED_ADAPTIVITY, which binds it in the middle of the edge")
    return bound


def check_units(path: Path, units: str | None, largest: float) -> None:
    """Raise a Problem if the stresses are hardly those of a metal in MPa, and no units are given."""
    if units is None and largest > 0 and not ODD_STRESS[0] <= largest <= ODD_STRESS[1]:
        raise Problem(f"{path}: error: stresses up to {largest:.4g} MPa, if they are in MPa; say by --units what they "
                      'are in: "mm MPa", "mm GPa" or "m Pa"')


def materials_of(cells: list[Cell], words: Sequence[str]) -> tuple[list[str], np.ndarray, list[str]]:
    """Return names of materials, the number of that of each shell, from 0 on, and what is to be said.

    words: a name for all parts, or PART=NAME for some of them.
    """
    others, by_part = DEFAULT_MATERIAL, {}
    for word in words:
        number, equals, name = word.rpartition("=")
        if equals and not number.isdigit():
            raise Problem(f"--material {word}: expected NAME, or PART=NAME with the number of a part")
        if equals:
            by_part[int(number)] = name
        else:
            others = name
    parts = sorted({cell.part for cell in cells})
    if unknown := sorted(set(by_part) - set(parts)):
        raise Problem(f"--material: no shell is of part {unknown[0]}; parts of the file: {', '.join(map(str, parts))}")
    chosen = [by_part.get(part, others) for part in parts]
    names = list(dict.fromkeys(chosen))
    number_of = {part: names.index(name) for part, name in zip(parts, chosen)}
    said = []
    if len(parts) > 1:
        listed = ", ".join(f"{part} {name}" for part, name in zip(parts, chosen))
        said.append(f"parts and their materials: {listed}"
                    + "; --material PART=NAME gives a part its own" * (len(by_part) == 0))
    return names, np.array([number_of[cell.part] for cell in cells]), said


def sheet_of(path: Path, material: Sequence[str], column: int, rolling: Sequence[float], units: str | None = None
             ) -> tuple[SheetState, list[str]]:
    """Return the sheet of a dynain file, and what is to be said of it: materials of several parts, turned shells, what
    is left out."""
    reader = Reader(path)
    mesh = DynaMesh(reader)
    said = []
    cells = [cell for cell in mesh.cells if cell.dimension == 2]
    if not cells:
        raise Problem(f"{path}: no shells (*ELEMENT_SHELL_THICKNESS)")
    if other := [cell for cell in cells if len(cell.nodes) != 4]:
        raise Problem(f"{other[0].place}: error: {len(other)} shells with three nodes; expected four")
    names, material_of, more = materials_of(cells, material)
    said += more
    if len(cells) < len(mesh.cells):
        said.append(f"left out: {len(mesh.cells) - len(cells)} solids")
    stress = Stresses(mesh, reader.cards).rows
    at_corner = thicknesses(cells)
    missing = [cell for cell in cells if cell.label not in stress]
    if missing:
        raise Problem(f"{missing[0].place}: error: no {STRESS} for {len(missing)} shells, the first {missing[0].label}")
    used, corner = np.unique(np.array([cell.nodes for cell in cells]), return_inverse=True)
    quads = corner.reshape(-1, 4)
    if lost := [int(node) for node in used if int(node) not in mesh.nodes]:
        raise Problem(f"{path}: shells name node {lost[0]}, which *NODE does not give")
    _, _, length, factor = UNITS[units or "mm MPa"]
    middle = length * np.array([mesh.nodes[int(node)] for node in used])
    at_corner = length * at_corner
    bound = bound_of(reader, cells, middle, quads, used)
    check_units(path, units, max(float(np.abs(rows[:, 1:7]).max()) for rows in stress.values()))
    turned = ordered(quads, bound)
    if turned.any():
        said.append(f"note: {turned.sum()} shells are numbered the other way round than the others, the first "
                    f"{cells[int(turned.argmax())].label}; they are turned over, with their heights")
        quads[turned], at_corner[turned] = quads[turned][:, ::-1], at_corner[turned][:, ::-1]
    half = across(cells, middle, quads, at_corner) / 2
    upper, lower = middle + half, middle - half
    levels = column or min(MOST_POINTS, max(2, max(len(rows) for rows in stress.values())))
    heights = leggauss(levels)[0]
    values = np.array([between(reversed_rows(stress[cell.label]) if back else stress[cell.label], heights)
                       for cell, back in zip(cells, turned)])
    values = np.tile(values, (1, COLUMNS, 1))  # (m, heights, 7)
    tensor = np.zeros((*values.shape[:2], 3, 3))
    for k, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))):
        tensor[..., i, j] = tensor[..., j, i] = factor * values[..., k]
    axes = np.repeat(sheet_axes(middle, quads, rolling)[:, None], values.shape[1], axis=1)
    points = np.stack((lower, upper), axis=1).reshape(-1, 3)
    held = held_sets(mesh.held, used)
    said += [f"note: *NODE holds {len(nodes) // 2} nodes along {' and '.join(name[5:])} (TC): node set {name}, for "
             "*BOUNDARY" for name, nodes in held.items()]
    if mesh.turns:
        said.append(f"left out: the rotations of {len(mesh.turns)} nodes that *NODE holds (RC)")
    said += account_of(reader)
    nodes = np.array([(node, a, b) for (a, b), node in bound.items()], int).reshape(-1, 3)
    return SheetState(points, points, np.hstack((2 * quads, 2 * quads + 1)), float(at_corner.mean()), tensor,
                      np.maximum(values[..., 6], 0.0), axes, names, material_of, levels,
                      node_sets(quads, len(points), bound) | held, np.concatenate((2 * nodes, 2 * nodes + 1))), said


def reversed_rows(rows: np.ndarray) -> np.ndarray:
    """Return the rows of a shell that is turned over: the heights change sign, stresses are in global axes."""
    return np.column_stack((-rows[:, 0], rows[:, 1:]))[::-1]


def account_of(reader: Reader) -> list[str]:
    """Return what of a file is not used."""
    for card in reader.cards:
        if card.keyword in ("*KEYWORD", "*TITLE", "*COMMENT", "*CONSTRAINED_ADAPTIVITY"):
            card.ignore()
        elif card.keyword.startswith("*PART"):
            for row in filter(None, card.rows.values()):
                row.drop("the thicknesses are those of the shells, the material that of --material")
        elif card.keyword.startswith(("*MAT", "*SECTION", "*DEFINE")):
            card.leave("the material is that of --material, the thicknesses are those of the shells")
        elif card.keyword.startswith("*INITIAL_STRAIN"):
            card.leave("strains count from the formed sheet")
        elif card.keyword.startswith("*INITIAL_STRESS"):
            card.leave("not read; *INITIAL_STRESS_SHELL is")
        elif card.keyword.startswith("*NODE") or card.keyword.startswith("*PART_MOVE"):
            card.leave("not read")
    return [f"left out: {item}" for item in reader.left_out()]


def held_sets(held: dict[int, str], used: np.ndarray) -> dict[str, np.ndarray]:
    """Return the sets hold_x, hold_xy, ... of the nodes of both faces that *NODE holds along these axes."""
    sets: dict[str, list[int]] = {}
    for i, label in enumerate(used):
        if axes := held.get(int(label)):
            sets.setdefault(f"hold_{axes}", []).extend((2 * i, 2 * i + 1))
    return {name: np.array(nodes) for name, nodes in sorted(sets.items())}


def node_sets(quads: np.ndarray, count: int, bound: Bound) -> dict[str, np.ndarray]:
    """Return the sets of nodes: all, those of the lower and of the upper face, by the names that they have on a blank,
    and those of the rim."""
    edges = np.sort([edge for ring in rings(quads, bound) for edge in zip(ring, ring[1:] + ring[:1])], axis=1)
    edges, times = np.unique(edges, axis=0, return_counts=True)
    rim = np.unique(edges[times == 1])
    number = np.arange(count)
    return {"all": number, "z_min": number[::2], "z_max": number[1::2], "rim": np.sort(np.append(2 * rim, 2 * rim + 1))}


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
    parser.add_argument("--material", action="append", default=[], metavar="NAME",
                        help=f"material in the input file ({DEFAULT_MATERIAL}), of all parts; PART=NAME that of one; "
                             "repeatable")
    parser.add_argument("--points", type=int, default=0, metavar="N",
                        help="points through the thickness (as many as in the file)")
    parser.add_argument("--rolling", type=float, nargs=3, default=[1.0, 0.0, 0.0], metavar=("X", "Y", "Z"),
                        help="rolling direction (1 0 0)")
    parser.add_argument("--units", choices=list(UNITS), help="units of lengths and stresses (mm MPa, if they fit)")
    options = parser.parse_args(words)
    if options.points and not 2 <= options.points <= 15:
        parser.error("--points: takes 2 to 15")
    if not any(options.rolling):
        parser.error("--rolling: takes a direction")
    if not options.file.is_file():
        raise Problem(f"{options.file}: No such file")
    sheet, said = sheet_of(options.file, options.material, options.points, options.rolling, options.units)
    if (options.folder / "job.log").exists():
        raise Problem(f"{options.folder}: holds the results of a run; name another folder")
    write_state(made_folder(options.folder), sheet)
    print(f"{options.folder / NAME}: {len(sheet.elements)} elements, {sheet.column} points through the thickness")
    for line in said:
        print(line)
