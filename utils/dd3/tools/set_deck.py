# SPDX-License-Identifier: GPL-3.0-or-later
"""Input file that draws a part with the tools that were made of it, and releases it."""
import argparse
from pathlib import Path

import numpy as np

from dd3.errors import Problem
from dd3.tools.blocks import read_blocks

# Elements of the undivided blank at most, about; least length of these over the thickness, and over the radius of the
# shoulder; length of the smallest elements over the larger of both, with which one turns by 19 degrees on the shoulder;
# most levels.
ELEMENTS, OF_THICKNESS, OF_SHOULDER, SMALLEST, LEVELS = 1000, 4.0, 4 / 3, 0.25, 4
# Pressure of the holder, MPa.
PRESSURE = 2.0
# Share of a level that is round-off.
ROUND_OFF = 1e-9
# Distance of the blank from the border of the flange, over the thickness.
INSET = 2.0
STEEL = """# Replace this by your material; dd3 identify makes one from measurements.
*MATERIAL steel
  young = 2.1e5
  poisson = 0.3
  yield = von_mises
  hardening = swift K=530 Y0=150 n=0.22"""
DECK = """# Draws {part} and releases it; tools by {command}
# The flange of the die is at z = 0; the punch starts at the blank and moves down.
*TITLE
  {part}

*PARAMETER
  tools = .             # folder of the tools
  thickness = {thickness}
  divisions = {divisions}     # elements of {length:.2g} mm
  levels = {levels}            # which are divided where the tools are curved, down to {smallest:.2g} mm
  points = 5            # through the thickness
  depth = {travel}
  holder = {holder}     # N, {pressure:g} MPa on the flange
  friction = 0.1

{material}

*BLANK sheet
  origin = {origin} 0
  size = {size} ${{thickness}}
  divisions = ${{divisions}}
  adaptive = ${{levels}}
  element = solid_shell
  thickness_points = ${{points}}
  material = {name}

*TOOL punch
  patches = "${{tools}}/punch.bez"
  friction = ${{friction}}
  contact = z_max

*TOOL die
  patches = "${{tools}}/die.bez"
  friction = ${{friction}}
  contact = z_min

*TOOL holder
  patches = "${{tools}}/holder.bez"
  friction = ${{friction}}
  contact = z_max

*CONTACT

# The middle of the blank does not move sideways.
*SET middle
  near = {middle} 0

*BOUNDARY middle
  set = middle
  fix = x y

*PHASE clamp
  control = load
  trial = 1.0
  hold = die
  hold = punch
  press = holder 0 0 ${{holder}}

*PHASE draw
  control = punch
  trial = 1.0
  move = punch 0 0 -${{depth}}

*PHASE springback
  unload = on

*OUTPUT
  fields = every 5 mm
"""


def deck(options: argparse.Namespace, material: str, plan: np.ndarray, travel: float, area: float, command: str) -> str:
    """Return the input file: name of the material, box of the flange in plan (2, 2), travel of the punch (mm), area of
    the flange (mm2), the command that made the tools."""
    low, high = plan[0] + INSET * options.thickness, plan[1] - INSET * options.thickness
    least = max(OF_THICKNESS * options.thickness, OF_SHOULDER * options.shoulder)
    length = max(least, float(np.prod(high - low) / ELEMENTS)**0.5)
    divisions = [2 * int(np.ceil(side / length / 2)) for side in high - low]
    levels = min(LEVELS, int(np.ceil(np.log2(length / (SMALLEST * least)) - ROUND_OFF)))
    include = f'*INCLUDE "{options.material.resolve()}"' if options.material else STEEL
    return DECK.format(part=options.source.stem, command=command, thickness=f"{options.thickness:g}",
                       divisions=f"{divisions[0]} {divisions[1]} 1", length=length,
                       levels=levels, smallest=length / 2**levels, travel=f"{travel:.6g}",
                       holder=f"{-PRESSURE * area:.3g}", pressure=PRESSURE, material=include, name=material,
                       origin=pair(low), size=pair(high - low), middle=pair((low + high) / 2))


def pair(values: np.ndarray) -> str:
    """Return two numbers as words."""
    return " ".join(f"{value + 0.0:.6g}" for value in np.round(values, 9))


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
