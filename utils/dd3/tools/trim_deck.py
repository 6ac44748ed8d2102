# SPDX-License-Identifier: GPL-3.0-or-later
"""Input file that cuts a drawn part along its rims and holes and releases it, the file of these curves, and that of the
process that draws the part and cuts it."""
from dataclasses import dataclass, field

import numpy as np

from dd3.curve import write_curves
from dd3.tools import set_material
from dd3.tools.moved import rotation
from dd3.tools.patch_distance import Distance
from dd3.tools.settings import ToolSettings
from dd3.tools.surface import Surface

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
# Distance over the thickness of points at which a curve is led over rounded edges.
SPACING = 0.25


@dataclass
class Curves:
    """Closed curves of a part (n, 3 each) on its side in the closed press, and by how much points of them were moved
    onto rounded edges at most, mm."""

    points: list[np.ndarray] = field(default_factory=list)
    moved: float = 0.0

    @property
    def said(self) -> str:
        """Return the number of curves and the largest move in words."""
        over = f", led over rounded edges, by up to {self.moved:.3g} mm off the part's" if self.moved else ""
        return f"{len(self.points)}{over}"


def on_tool(surface: Surface, options: ToolSettings) -> Curves:
    """Return the curves of a part on the surface of the tool that touches it: where edges of the part are rounded they
    go on over the rounded ones, by the nearest points."""
    if not options.curves:
        return Curves()
    matrix, move = rotation(options.rotate), np.array(options.move)
    distance = Distance(surface.net, options.thickness)
    found = [led_over(points @ matrix.T + move, distance, options) for points in options.curves]
    return Curves([points for points, _ in found], max(off for _, off in found))


def led_over(points: np.ndarray, distance: Distance, options: ToolSettings) -> tuple[np.ndarray, float]:
    """Return a closed curve whose points off a surface are moved onto it, with further ones between these, and by how
    much at most, mm."""
    fine, own = divided(points, SPACING * options.thickness)
    foot = distance.nearest(fine)[0]
    off = np.linalg.norm(foot - fine, axis=1)
    moved = off > options.tolerance
    kept = own | moved | np.roll(moved, 1) | np.roll(moved, -1)
    return np.where(moved[:, None], foot, fine)[kept], float(off[moved].max(initial=0.0))


def divided(points: np.ndarray, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the points of a closed line (n, 3) with others between them, at a distance at most, and which are its
    own."""
    ways = np.roll(points, -1, axis=0) - points
    counts = np.maximum(np.ceil(np.linalg.norm(ways, axis=1) / spacing), 1).astype(int)
    parts = [np.arange(count)[:, None] / count for count in counts]
    fine = np.concatenate([point + part * way for point, part, way in zip(points, parts, ways)])
    return fine, np.concatenate([part[:, 0] == 0 for part in parts])


def write(options: ToolSettings, curves: Curves, height: float) -> None:
    """Write the curves of a part, where the die has it, the input file and the process; `height` is that of the part in
    the coordinates of the tools, mm."""
    write_curves(options.target / CURVES, [points + np.array([0.0, 0.0, height]) for points in curves.points],
                 options.source.name)
    material = set_material.text_of(options.material)
    (options.target / DECK).write_text(TEXT.format(part=options.source.stem, material=material, curves=CURVES),
                                       encoding="utf-8")
    (options.target / PROCESS).write_text(OPERATIONS.format(part=options.source.stem, file=PROCESS), encoding="utf-8")
