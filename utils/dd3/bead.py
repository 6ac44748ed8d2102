# SPDX-License-Identifier: GPL-3.0-or-later
"""Compute what a round draw-bead does to a sheet: restraining force, uplift, strain of the thickness.

    dd3 bead dc06 --thickness 0.8 --radius 5 --height 3 6 --friction 0.1
    dd3 bead sheet.dat --thickness 1 --radius 5 --shoulder 4 --clearance 1.5 --height 6 --strip strip
    dd3 bead deck.dat --radius 5 --height 6

MATERIAL is a file with *MATERIAL or the name of a material of the library. Of an input file material and thickness are
those of its *BLANK, the friction that of its tools. Yield criterion, hardening and back-stresses are those of the
program, by its library libdd3laws. --height is the depth by which the bead presses the sheet into the groove. The lines
of *DRAWBEAD are printed. Its `normal` presses the sheet on the die, whose friction restrains it too: `force` is the
restraint less that.

--strip writes an input file of a strip that is drawn through the bead of the last height, to compare with.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from dd3.bead_path import CLEARANCE, GAP, LAYERS, STEPS, Bead, Result, flow
from dd3.bead_strip import write_strip
from dd3.command import new_parser
from dd3.errors import Problem
from dd3.laws import Material
from dd3.tools.blocks import Block, read_blocks
from dd3.tools.set_material import found

COLUMNS = ("height", "restraint", "uplift", "of it bead", "entry", "exit", "thickness strain", "plastic strain",
           "largest")
UNITS = ("mm", *5 * ("N/mm",), "-", "mean", "-")


def row(height: float, result: Result) -> list[str]:
    """Return the cells of a height, mm."""
    forces = result.restraint, result.uplift, result.bead, result.entry, result.exit
    strains = result.thinning, float(result.plastic.mean()), float(result.plastic.max())
    return [f"{height:g}", *(f"{force:.1f}" for force in forces), *(f"{strain:.3f}" for strain in strains)]


def block(bead: Bead, result: Result) -> str:
    """Return the lines of *DRAWBEAD."""
    return f"  force = {result.force(bead.friction):.4g}\n  rise = {bead.radius:g}\n  normal = {-result.uplift:.4g}"


def common(path: Path, option: str, values: Sequence[str | None]) -> str | None:
    """Return the value that blanks or tools of a file share, None without one; a Problem where they differ."""
    given = sorted({value for value in values if value is not None})
    if len(given) > 1:
        raise Problem(f"{path}: several values of {option[2:]}, {', '.join(given)}; expected {option}")
    return given[0] if given else None


def number(path: Path, option: str, values: Sequence[str | None]) -> float | None:
    """Return the number that blanks or tools of a file share, None without one."""
    text = common(path, option, values)
    try:
        return None if text is None else float(text)
    except ValueError:
        raise Problem(f"{path}: '{text}' is no number; expected {option}") from None


def thickness_of(blank: Block) -> str | None:
    """Return the thickness of a *BLANK."""
    size = (blank.value("size") or "").split()
    return size[2] if len(size) == 3 else blank.value("thickness")


def main(words: Sequence[str] | None = None) -> None:
    """Compute the bead of the command line."""
    parser = new_parser("bead", __doc__)
    parser.add_argument("material", type=Path, metavar="MATERIAL", help="file, or name of a material of the library")
    parser.add_argument("--name", help="of the material, if the file has several")
    parser.add_argument("--thickness", type=float, metavar="mm", help="of the sheet (that of *BLANK)")
    parser.add_argument("--radius", type=float, required=True, metavar="mm", help="of the bead")
    parser.add_argument("--height", type=float, nargs="+", required=True, metavar="mm",
                        help="by which the bead presses the sheet into the groove; several make a table")
    parser.add_argument("--shoulder", type=float, metavar="mm", help="radius of the edges of the groove (--radius)")
    parser.add_argument("--clearance", type=float, metavar="mm",
                        help=f"between the side of the bead and the wall of the groove ({CLEARANCE:g} thicknesses)")
    parser.add_argument("--gap", type=float, metavar="mm",
                        help=f"between the plates beside the groove, beyond the thickness ({GAP:g} thicknesses)")
    parser.add_argument("--friction", type=float, metavar="MU", help="coefficient (that of the tools, or 0)")
    parser.add_argument("--clamping", type=float, default=0.0, metavar="N/mm",
                        help="force of the plates on the sheet before the bead (0)")
    parser.add_argument("--direction", type=float, default=0.0, metavar="DEGREES",
                        help="of the motion to the rolling direction (0)")
    parser.add_argument("--layers", type=int, default=LAYERS, help=f"through the thickness ({LAYERS})")
    parser.add_argument("--steps", type=int, default=STEPS, help=f"of each bending and unbending ({STEPS})")
    parser.add_argument("--strip", type=Path, metavar="FOLDER", help="write the input file of a strip and its tools")
    options = parser.parse_args(words)
    if min(options.layers, options.steps) < 4:
        parser.error("--layers and --steps take at least 4")
    if options.strip and (options.clamping or options.direction):
        parser.error("--strip goes without --clamping and --direction: its strip lies along the rolling direction, "
                     "between free plates")
    path = found(options.material) or options.material
    blanks, tools = ([block for block in read_blocks(path) if block.keyword == word] for word in ("blank", "tool"))
    t, friction, name = options.thickness, options.friction, options.name
    if t is None and (t := number(path, "--thickness", [thickness_of(block) for block in blanks])) is None:
        parser.error(f"{path} has no *BLANK; expected --thickness")
    if friction is None:
        friction = number(path, "--friction", [block.value("friction") or "0" for block in tools]) or 0.0
    material = Material(file=path, name=name or common(path, "--name", [block.value("material") for block in blanks]))
    bead = Bead(t, options.radius, options.radius if options.shoulder is None else options.shoulder,
                CLEARANCE * t if options.clearance is None else options.clearance, options.height[0],
                GAP * t if options.gap is None else options.gap, friction, options.clamping)
    beads = [replace(bead, height=height) for height in options.height]
    results = [flow(material, one, options.direction, options.layers, options.steps) for one in beads]
    rows = [COLUMNS, UNITS, *(row(one.height, result) for one, result in zip(beads, results))]
    widths = [max(len(cells[i]) for cells in rows) for i in range(len(COLUMNS))]
    print(f"{material.name}, {t:g} mm; bead of {bead.radius:g} mm, shoulders of {bead.shoulder:g} mm, "
          f"{2 * bead.half:g} mm apart; friction {bead.friction:g}")
    if material.has_rate:
        print("the strain rate is not followed: the flow stress is that of a slow test")
    if min(bead.radius, bead.shoulder) < t:
        print("a radius is smaller than the thickness: sheets crack there, and the layers' strains are too large for "
              "the model")
    if options.friction is None and any(block.value("friction_law") for block in tools):
        print("friction_law is not followed: the coefficient is `friction`")
    print(*("  ".join(cell.rjust(width) for cell, width in zip(cells, widths)) for cells in rows), sep="\n")
    for one, result in zip(beads, results):
        print(f"height {one.height:g} mm, *DRAWBEAD:\n{block(one, result)}")
    if options.strip:
        print(write_strip(material, beads[-1], options.strip))
