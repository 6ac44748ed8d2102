# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the sheet of a run at one of its steps for other programs, or as a mesh; or a material for LS-DYNA.

    dd3 export cup.out drawn.inp --at draw       the drawn mesh, which *MESH reads
    dd3 export cup.out part.vtu                  the last step with all fields: ParaView
    dd3 export cup.out dynain.k                  LS-DYNA: solids with stresses and plastic strains
    dd3 export cup.out dynain.k --shells         its mid-surface: shells with thicknesses, stresses and plastic strains
    dd3 export cup.out dynain.k --shells --cards with *PART, *SECTION and the cards of the materials
    dd3 export dp600.dat dp600.k                 a material alone: *MAT_..., curves, tables

Lengths are in mm, stresses in MPa. At the end of a run of elements solid_shell the shells have the stresses and strains
of all points through the thickness, each the mean over its height; otherwise those in the middle of the elements, and
bending moments are lost. Of a sheet of several materials each is a part, in .inp an element set. Back-stresses and
limits that the run follows are left out, and named.

The card of a material is the first that has all its laws, and is named; what no card has is an error, or with the sheet
of a run a warning, and --nearest writes the nearest card with what it loses.
"""
import argparse
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial.legendre import leggauss

from dd3.bound import bound_nodes
from dd3.command import new_parser
from dd3.errors import LOG, Problem
from dd3.fields import AT, LIMITED, Fields
from dd3.mesh import material_numbers, read_run, write_inp
from dd3.run import read_job
from dd3.sheet_state import COLUMNS, SheetState, read_state

if TYPE_CHECKING:
    from dd3.dyna.material_laws import CardOptions

MOST = 99_999_999  # a label in 8 columns
HEXAHEDRON = 12  # type of VTK
OWN_BACK_STRESS = ("teodosiu_hu", "yoshida_uemori")  # hardening laws


@dataclass(frozen=True)
class Form:
    """The form of a file for LS-DYNA: shells in place of solids; how the cards of the materials are written, None for
    none."""

    shells: bool = False
    cards: "CardOptions | None" = None


def to_inp(fields: Fields, step: int, target: Path, _: Form) -> None:
    """Write the mesh in its shape at a step."""
    write_inp(target, read_run(fields.path, step), fields.path)


def to_vtu(fields: Fields, step: int, target: Path, _: Form) -> None:
    """Write the grid of a step with all fields."""
    fields[step].save(target)


def to_dyna(fields: Fields, step: int, target: Path, form: Form) -> None:
    """Write the sheet as a keyword file of LS-DYNA."""
    if set(fields.cells(step).types) != {HEXAHEDRON}:
        raise Problem(f"{fields.path}: expected hexahedra of 8 nodes; write .inp or .vtu")
    cells = fields.cells(step).nodes.reshape(-1, 8)
    points = fields.points(step)
    part = material_numbers(fields, step)
    known = (fields.path.parent / "run.json").is_file()
    job = read_job(fields.path.parent) if known else {"materials": []}
    if form.cards and not known:
        raise Problem(f"{fields.path.parent}: no run.json, which has the materials; --cards needs it")
    stress = fields.values(step, "stress", at_cells=True)[0]
    plastic = fields.values(step, "equivalent_plastic_strain", at_cells=True)[0]
    lines: list[str] = []
    if form.shells:
        thickness = fields.values(step, "thickness")[0]
        rows = np.concatenate((np.zeros((len(cells), 1)), stress, plastic.reshape(-1, 1)), axis=1)[:, None]
        state = state_at_end(fields, points) if step == fields.last else None
        if state:
            rows = layer_rows(state)
        angles = None
        if form.cards:
            lines, angles, scale = shell_cards(fields.path.parent, job, form.cards, part,
                                        (rows.shape[1], float(thickness[thickness > 0].mean())),
                                        rolling_of(fields.path, state, points, cells) if state else None)
            rows = np.concatenate((rows[..., :-1], scale[:, None, None] * rows[..., -1:]), axis=-1)
        lines += shell_lines(fields.path, points, cells, part, thickness, rows, angles)
        lines += shell_bounds(fields.path, points, cells)
    else:
        if form.cards:
            from dd3.dyna.run_cards import run_cards
            cards = run_cards(job, np.unique(part).tolist(), form.cards, None, fields.path.parent)
            lines, plastic = cards.lines, cards.scale(part) * plastic.ravel()
        lines += [*node_lines(points), "*ELEMENT_SOLID",
                 *("".join(f"{value:8d}" for value in (i, number, *(cell + 1)))
                   for i, (number, cell) in enumerate(zip(part, cells), 1)),
                 "*INITIAL_STRESS_SOLID"]
        for i, (tensor, strain) in enumerate(zip(stress, plastic), 1):
            lines += [f"{i:10d}{1:10d}", row((*tensor, strain))]
        lines += solid_bounds(points, cells)
    if max(len(cells), len(points)) > MOST:
        raise Problem(f"{fields.path}: more than {MOST} nodes or elements")
    materials = job["materials"]
    if (part > 1).any():
        LOG.info("parts: " + ", ".join(f"{k} {materials[k - 1]['name']}" if known else str(k) for k in np.unique(part)))
    left_out = [name for name in LIMITED if name in fields.grid["CellData"]]
    if any(has_back_stress(material) for material in materials):
        left_out.append("back-stresses")
    if left_out:
        LOG.info(f"left out: {', '.join(left_out)}: LS-DYNA has them in history variables, whose places depend on its "
                 "material" + "; .vtu holds them" * ("back-stresses" not in left_out))
    title = f"{fields.state(step)} of {fields.path.parent.name}"
    target.write_text("\n".join(["*KEYWORD", "*TITLE", title[:80], *lines, "*END", ""]), encoding="utf-8")


def rolling_of(path: Path, state: SheetState, points: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Return the angles of the rolling direction to the first edges of the shells, degrees."""
    # Here, as the library of the laws is loaded only where it is wanted.
    from dd3.dyna.run_cards import rolling_angles
    lower, upper = sides(path, cells)
    return rolling_angles(state.axes[..., 0].mean(axis=1), (points[lower] + points[upper]) / 2)


def shell_cards(folder: Path, job: dict[str, Any], options: "CardOptions", part: np.ndarray, layers: tuple[int, float],
                angles: np.ndarray | None) -> tuple[list[str], np.ndarray | None, np.ndarray]:
    """Return the cards of the materials of shells of a run, the angles of their axes, where a card needs them, and
    factors on their plastic strains.

    angles: those of the rolling direction, None where they are not known.
    """
    from dd3.dyna.run_cards import run_cards
    cards = run_cards(job, np.unique(part).tolist(), replace(options, by_element=angles is not None), layers, folder)
    if cards.anisotropic and angles is None:
        LOG.warning("the rolling direction in the cards is that of the initial sheet; at the end of a run of elements "
                    "solid_shell it is that of each shell, BETA")
    if angles is not None and cards.anisotropic:
        LOG.info("note: the rolling direction of each shell is its BETA, from the first edge on (AOPT = 0)")
    return cards.lines, angles if cards.anisotropic else None, cards.scale(part)


def has_back_stress(material: dict[str, Any]) -> bool:
    """Whether a material of run.json hardens kinematically."""
    return bool(material["backstress"]) or material["hardening"]["name"] in OWN_BACK_STRESS


def solid_bounds(points: np.ndarray, cells: np.ndarray) -> list[str]:
    """Return the equations that hold bound nodes in the middle of their edges."""
    lines: list[str] = []
    for i, ((a, b), node) in enumerate(bound_nodes(cells, points).items()):
        for direction in (1, 2, 3):
            lines += ["*CONSTRAINED_LINEAR_GLOBAL", f"{3 * i + direction:10d}",
                      *(f"{label + 1:10d}{direction:10d}{factor:10.1f}"
                        for label, factor in ((node, 1.0), (a, -0.5), (b, -0.5)))]
    return lines


def shell_bounds(path: Path, points: np.ndarray, cells: np.ndarray) -> list[str]:
    """Return the bound nodes of the mid-surface and the ends of their edges."""
    lower, upper = sides(path, cells)
    number = shell_numbers(lower, upper, len(points))
    bound = [(node, a, b) for (a, b), node in bound_nodes(cells, points).items() if number[[node, a, b]].all()]
    lines = ["".join(f"{number[node]:10d}" for node in nodes) for nodes in bound]
    return ["*CONSTRAINED_ADAPTIVITY", *lines] if lines else []


def shell_numbers(lower: np.ndarray, upper: np.ndarray, count: int) -> np.ndarray:
    """Return the labels of the nodes of the mid-surface at the nodes of the lower face; 0 elsewhere."""
    ends = np.unique(np.stack([lower.ravel(), upper.ravel()], axis=1), axis=0)
    number = np.zeros(count, int)
    number[ends[:, 0]] = np.arange(1, len(ends) + 1)
    return number


def node_lines(points: np.ndarray) -> list[str]:
    """Return the nodes."""
    return ["*NODE", *(f"{i:8d}" + "".join(f"{value:16.9e}" for value in point) for i, point in enumerate(points, 1))]


def row(values: Iterable[float]) -> str:
    """Return numbers in columns of 10."""
    return "".join(f"{value:10.3e}" for value in values)


def state_at_end(fields: Fields, points: np.ndarray) -> SheetState | None:
    """Return the state in the restart file of a run, if it is of elements solid_shell and of the last step."""
    try:
        state = read_state(fields.path.parent)
    except Problem:
        return None
    return state if state.points.shape == points.shape and np.allclose(state.points, points, atol=1e-4) else None


def layer_rows(state: SheetState) -> np.ndarray:
    """Return height (-1 to 1), stresses xx yy zz xy yz zx and plastic strain (m, heights, 8), means over the points at
    each height."""
    count = len(state.elements)
    stress = state.stress.reshape(count, COLUMNS, state.column, 3, 3).mean(axis=1)
    strain = state.strain.reshape(count, COLUMNS, state.column).mean(axis=1)
    heights = np.broadcast_to(leggauss(state.column)[0], strain.shape)
    parts = [stress[..., i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))]
    return np.stack((heights, *parts, strain), axis=-1)


def shell_lines(path: Path, points: np.ndarray, cells: np.ndarray, part: np.ndarray, thickness: np.ndarray,
                rows: np.ndarray, angles: np.ndarray | None = None) -> list[str]:
    """Return the mid-surface of a sheet of one layer, its thickness given at the nodes: nodes, shells with their parts
    and thicknesses, and angles of their axes, and rows (m, heights, 8) of height, stresses and plastic strain."""
    lower, upper = sides(path, cells)
    ends = np.unique(np.stack([lower.ravel(), upper.ravel()], axis=1), axis=0)
    number = shell_numbers(lower, upper, len(points))
    thickness = thickness[ends].mean(axis=1)
    lines = [*node_lines(points[ends].mean(axis=1)), "*ELEMENT_SHELL_THICKNESS"]
    for i, corners in enumerate(number[lower], 1):
        lines += ["".join(f"{value:8d}" for value in (i, part[i - 1], *corners)),
                  "".join(f"{thickness[corner - 1]:16.9e}" for corner in corners)
                  + (f"{angles[i - 1]:16.9e}" if angles is not None else "")]
    lines.append("*INITIAL_STRESS_SHELL")
    for i, layers in enumerate(rows, 1):
        lines += [f"{i:10d}{1:10d}{len(layers):10d}", *(row(values) for values in layers)]
    return lines


def sides(path: Path, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the nodes of the elements on the two faces of a sheet of one layer (n, 4)."""
    lower, upper = cells[:, :4], cells[:, 4:8]
    if np.intersect1d(lower, upper).size:
        raise Problem(f"{path}: --shells takes a sheet of one layer of elements")
    return lower, upper


WRITERS: dict[str, Callable[[Fields, int, Path, Form], None]] = {
    ".inp": to_inp, ".vtu": to_vtu, ".k": to_dyna, ".key": to_dyna, ".dyn": to_dyna}


def export(run: str | Path, target: str | Path, at: str | float | None = None, shells: bool = False,
           cards: "CardOptions | None" = None) -> Path:
    """Write the sheet of a run at a step for another program; return the path of the file.

    target: file whose ending is the format: .inp (mesh), .vtu (grid with all fields), .k .key .dyn (LS-DYNA). at:
    travel in mm, or a phase (the last step). shells: of LS-DYNA, the mid-surface of a sheet of one layer. cards: how
    the materials are written for LS-DYNA (none).
    """
    target = Path(target)
    writer = WRITERS.get(target.suffix.lower())
    if writer is None:
        raise Problem(f"{target}: unknown kind of file; expected {' '.join(WRITERS)}")
    if (shells or cards) and writer is not to_dyna:
        raise Problem(f"{'--shells' if shells else '--cards'} takes a file of LS-DYNA: .k .key .dyn")
    if cards and cards.units != "mm MPa":
        raise Problem("--units: the sheet of a run is in mm and MPa")
    fields = Fields(run)
    step = fields.last if at is None else fields.step_at(str(at))
    target.parent.mkdir(parents=True, exist_ok=True)
    writer(fields, step, target, Form(shells, cards))
    LOG.info(f"{target}: {fields.state(step)}, {len(fields.cells(step).types)} elements")
    return target


def is_material(path: Path) -> bool:
    """Tell whether a path is that of a file with a material, or the name of one of the library."""
    from dd3.tools.set_material import names
    return path.suffix != ".vtkhdf" and (path.is_file() or (not path.exists() and str(path) in names()))


def add_card_options(parser: argparse.ArgumentParser) -> None:
    """Add the options of the cards of materials."""
    parser.add_argument("--card", type=int, metavar="NUMBER", help="of the material (the first that has all of it)")
    parser.add_argument("--nearest", action="store_true", help="take the nearest card where none has all of a material")
    parser.add_argument("--units", default="mm MPa", help='of a material alone: "mm MPa" (default), "mm GPa", "m Pa"')
    parser.add_argument("--mid", type=int, default=1, help="number of a material alone (1)")
    parser.add_argument("--strain", type=float, default=1.0, help="largest plastic strain of curves (1)")
    parser.add_argument("--density", type=float, help="t/mm3, where *MATERIAL has none")
    parser.add_argument("--erosion", action="store_true",
                        help="the forming limit curve as *MAT_ADD_EROSION, which deletes shells beyond it")


def main(words: Sequence[str] | None = None) -> None:
    """Export the run or the material of the command line."""
    parser = new_parser("export", __doc__)
    parser.add_argument("run", type=Path, metavar="RUN|MATERIAL",
                        help="folder of results, or its fields.vtkhdf; file with *MATERIAL, or name of the library")
    parser.add_argument("target", type=Path, help=f"file to write: {' '.join(WRITERS)}")
    parser.add_argument("--at", metavar="PLACE", help=AT)
    parser.add_argument("--shells", action="store_true", help="LS-DYNA: the mid-surface of a sheet of one layer")
    parser.add_argument("--cards", action="store_true", help="LS-DYNA: with *PART, *SECTION and cards of the materials")
    parser.add_argument("--name", help="of the material, if the file has several")
    add_card_options(parser)
    given = vars(parser.parse_args(words))
    run, target, cards, name = (given.pop(key) for key in ("run", "target", "cards", "name"))
    at, shells = given.pop("at"), given.pop("shells")
    alone = is_material(run)
    options = None
    if alone or cards:
        from dd3.dyna.material_cards import export_material
        from dd3.dyna.material_laws import CardOptions
        options = CardOptions(**given)
    elif used := [key for key, value in given.items() if value != parser.get_default(key)]:
        parser.error(f"--{used[0]} goes with --cards or a material")
    if not alone:
        export(run, target, at, shells, options)
    elif WRITERS.get(target.suffix.lower()) is not to_dyna:
        raise Problem(f"{target}: a material alone is written for LS-DYNA: .k .key .dyn")
    else:
        export_material(run, target, name, options)
