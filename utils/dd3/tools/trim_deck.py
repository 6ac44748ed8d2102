# SPDX-License-Identifier: GPL-3.0-or-later
"""Input file that cuts a drawn part along its rims and holes and releases it, the file of these curves, and that of the
process that draws the part and cuts it."""

import numpy as np

from dd3.curve import write_curves
from dd3.tools import set_material
from dd3.tools.moved import rotation
from dd3.tools.settings import ToolSettings

DECK, CURVES, PROCESS = "trim.dat", "trim.txt", "part.toml"
TEXT = """# Cuts the sheet of draw.dat along the rims and holes of {part}, held in its drawn shape, and releases it.
*TITLE
  {part}, trimmed

*PARAMETER
  from = draw.out/draw  # end of the draw, before the springback

{material}

*START
  from = ${{from}}

*TRIM rim
  file = "{curves}"
  along = 0 0 0         # curves on the sheet
  keep = inside         # of the outer rim, outside of the holes

*PHASE springback
  unload = on
"""
OPERATIONS = """# {part}, drawn and released, and trimmed in its drawn shape and released:
#   dd3 process {file} --report
title = "{part}"

[[operation]]
deck = "draw.dat"

[[operation]]
deck = "trim.dat"
"""


def write(options: ToolSettings, height: float) -> None:
    """Write the curves of a part, where the die has it, the input file and the process; `height` is that of the part in
    the coordinates of the tools, mm."""
    matrix, move = rotation(options.rotate), np.array(options.move) + np.array([0.0, 0.0, height])
    write_curves(options.target / CURVES, [points @ matrix.T + move for points in options.curves],
                 options.source.name)
    material = set_material.text_of(options.material)
    (options.target / DECK).write_text(TEXT.format(part=options.source.stem, material=material, curves=CURVES),
                                       encoding="utf-8")
    (options.target / PROCESS).write_text(OPERATIONS.format(part=options.source.stem, file=PROCESS), encoding="utf-8")
