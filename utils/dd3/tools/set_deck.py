# SPDX-License-Identifier: GPL-3.0-or-later
"""Input file that draws a part with the tools that were made of it, and releases it."""
import argparse
from pathlib import Path

import numpy as np

from dd3.curve import write_curves
from dd3.errors import Problem
from dd3.tools.beads import Beads
from dd3.tools.blocks import read_blocks
from dd3.tools.set_blank import Blank
from dd3.tools.tool_set import ToolSet

# Elements of the undivided blank, about; length of the smallest ones over the least radius of the tools, on which one
# turns by 19 degrees, and over the thickness at least; height of an arc of that radius over its chord in an element,
# over the thickness, at most (the program warns of more by W109); most levels.
ELEMENTS, OF_RADIUS, OF_THICKNESS, SAG, LEVELS = 1000, 1 / 3, 1.0, 0.1, 4
# Elements around a blank that is cut.
AROUND = 2.0
# Pressure of the holder, MPa.
PRESSURE = 2.0
# Density of steel, of which the weight is told without a material, t/mm3.
STEEL_DENSITY = 7.85e-9
# Distance from the sheet at which the holder is pressed, over the thickness.
SHORT = 0.1
# Coefficient of friction.
FRICTION = 0.1
# Least force of a pad over that of the holder: the sheet slides on the side that is held less.
OF_HOLDER = 2.0
STEEL = """# Replace this by your material; dd3 identify makes one from measurements.
*MATERIAL steel
  young = 2.1e5
  poisson = 0.3
  yield = von_mises
  hardening = swift K=530 Y0=150 n=0.22"""
DECK = """# Draws {part} and releases it; tools by {command}
# The highest point of the die's binder, without a holder that of the die, is at z = 0; the punch starts at the blank and
# moves down.
*TITLE
  {part}

*PARAMETER
  tools = .             # folder of the tools
  thickness = {thickness}
  divisions = {divisions}     # elements of {length:.2g} mm
  levels = {levels}            # which are divided where the tools are curved, down to {smallest:.2g} mm
  points = 5            # through the thickness
  depth = {travel}
{forces}  friction = {friction:g}

{material}

*BLANK sheet
  origin = {origin} 0
  size = {size} ${{thickness}}
  divisions = ${{divisions}}
  adaptive = ${{levels}}
  element = solid_shell
  thickness_points = ${{points}}
  material = {name}
{cut}
{tools}{beads}*CONTACT

{support}{closing}{clamp}*PHASE draw
  control = punch
  trial = 1.0
  move = punch 0 0 -${{depth}}

*PHASE springback
  unload = on

*OUTPUT
  fields = every 5 mm
"""
TOOL = """*TOOL {name}
  patches = "${{tools}}/{name}.bez"
  friction = ${{friction}}
  contact = {contact}

"""
CONTACT = {"punch": "z_max", "die": "z_min", "holder": "z_max", "pad": "z_min"}
# Friction holds the sheet sideways, once the holder or a pad is on it.
SUPPORT = """# The middle of the blank does not move sideways, as it lies freely on the die at first.
*SET middle
  near = {middle} 0

"""
FREE = "  free = middle x y\n"
# Without holder and pad.
HELD = """*BOUNDARY middle
  set = middle
  fix = x y

"""
BLANK = "blank.txt"  # outline of the blank
CUT = """
*TRIM blank
  file = "{file}"
"""
CLOSING = """# The holder bends the blank onto the die.
*PHASE close
  control = holder
  trial = 1.0
  hold = die
  hold = punch
  move = holder 0 0 -{closing:.6g}
  displace = middle x 0
  displace = middle y 0

"""
CLAMP = """*PHASE clamp
  control = load
  trial = 1.0
  hold = die
  hold = punch
{presses}{free}
"""


def deck(options: argparse.Namespace, material: str, tools: ToolSet, beads: Beads, command: str) -> str:
    """Return the input file: name of the material, tools, draw-beads, the command that made these."""
    low, high = tools.blank.box
    smallest = max(min(OF_RADIUS * tools.radius, (8 * SAG * options.thickness * tools.radius)**0.5),
                   OF_THICKNESS * options.thickness)
    levels = int(np.clip(np.ceil(np.log2((tools.blank.area / ELEMENTS)**0.5 / smallest)), 0, LEVELS))
    length = 2**levels * smallest
    if tools.blank.cut:  # that does not meet the border of the mesh
        low, high = low - AROUND * length, high + AROUND * length
    divisions = [2 * int(np.ceil(side / length / 2)) for side in high - low]
    pressed = {name: PRESSURE * tools.area[name] for name in ("holder", "pad") if name in tools.surfaces}
    if "pad" in pressed:
        pressed["pad"] = max(pressed["pad"], OF_HOLDER * pressed.get("holder", 0.0))
    forces = [f"  {name} = {force:.3g}     # N, {force / tools.area[name]:.2g} MPa\n"
              for name, force in pressed.items()]
    forces += [f"  bead = {beads.force:.3g}            # N/mm, restraint of the draw-beads\n"] if beads.lines else []
    presses = [f"  press = {name} 0 0 {'-' if name == 'holder' else ''}${{{name}}}\n" for name in pressed]
    support = SUPPORT.format(middle=pair((low + high) / 2)) if tools.closing or not pressed else ""
    support += "" if pressed else HELD
    closing = CLOSING.format(closing=tools.closing - SHORT * options.thickness) if tools.closing else ""
    return DECK.format(part=options.source.stem, command=command, thickness=f"{options.thickness:g}",
                       divisions=f"{divisions[0]} {divisions[1]} 1", length=length,
                       levels=levels, smallest=smallest, travel=f"{tools.travel:.6g}", forces="".join(forces),
                       cut=CUT.format(file=BLANK) if tools.blank.cut else "",
                       material=material_text(options), name=material, friction=FRICTION, beads=beads.blocks(),
                       origin=pair(low), size=pair(high - low),
                       tools="".join(TOOL.format(name=name, contact=CONTACT[name]) for name in tools.surfaces),
                       support=support, closing=closing,
                       clamp=CLAMP.format(presses="".join(presses), free=FREE if tools.closing else "") if pressed else "")


def write_blank(folder: Path, blank: Blank, part: str) -> None:
    """Write the outline of a blank that is cut along it."""
    if blank.cut:
        write_curves(folder / BLANK, [np.column_stack([blank.outline, np.zeros(len(blank.outline))])],
                     f"outline of the blank of {part}")


def said(options: argparse.Namespace, blank: Blank) -> str:
    """Return size, area and weight of a blank in words."""
    density, of = density_in(options.material) if options.material else None, ""
    if density is None:
        density, of = STEEL_DENSITY, " of steel"
    weight = 1e6 * blank.area * options.thickness * density
    x, y = np.ptp(blank.box, axis=0)
    return f"{x:.4g} x {y:.4g} mm, {blank.area:.4g} mm2, {weight:.3g} g{of}" + (f", cut along {BLANK}" if blank.cut else "")


def density_in(path: Path) -> float | None:
    """Return the density of the material of a file, t/mm3, None if it has none."""
    text = next(block.value("density") for block in read_blocks(path) if block.keyword == "material")
    return float(text) if text else None


def pair(values: np.ndarray) -> str:
    """Return two numbers as words."""
    return " ".join(f"{value + 0.0:.6g}" for value in np.round(values, 9))


def material_text(options: argparse.Namespace) -> str:
    """Return the block of the material, or the line that includes it."""
    return f'*INCLUDE "{options.material.resolve()}"' if options.material else STEEL


def material_in(path: Path | None) -> str:
    """Return the name of the material of a file, or of the one that stands in for it."""
    if path is None:
        return "steel"
    if not path.is_file():
        raise Problem(f"{path}: no such file")
    names = [block.name for block in read_blocks(path) if block.keyword == "material"]
    if len(names) != 1:
        raise Problem(f"{path}: expected one *MATERIAL, found {len(names)}")
    return names[0]
