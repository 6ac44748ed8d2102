# SPDX-License-Identifier: GPL-3.0-or-later
"""Input file that cuts a drawn part along its rims and holes and releases it, the file of these curves, and that of the
process that draws the part and cuts it."""
from dataclasses import dataclass, field

import numpy as np

from dd3.curve import write_curves
from dd3.tools import set_material, symmetry
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

{symmetry}*PHASE springback
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
    lines = [divided(points @ matrix.T + move, SPACING * options.thickness) for points in options.curves]
    fine = np.concatenate([points for points, _ in lines])
    foot, off = led_over(fine, Distance(surface.net, options.thickness), options.tolerance)
    ends, found = np.cumsum([len(points) for points, _ in lines])[:-1], []
    for (points, own), feet, moved in zip(lines, np.split(foot, ends), np.split(off > 0.0, ends)):
        kept = own | moved | np.roll(moved, 1) | np.roll(moved, -1)
        found.append(np.where(moved[:, None], feet, points)[kept])
    return Curves(found, float(off.max(initial=0.0)))


def led_over(points: np.ndarray, distance: Distance, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Return points (n, 3), those farther from a surface than a tolerance moved onto it, and by how much, mm."""
    foot, off = points.copy(), np.zeros(len(points))
    far = np.flatnonzero(distance.upper_bound(points) > tolerance)
    foot[far] = distance.nearest(points[far])[0]
    off[far] = np.linalg.norm(foot[far] - points[far], axis=1)
    off[off <= tolerance] = 0.0
    return foot, off


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
    axes = symmetry.ends_at(options)
    kept = [symmetry.mirrored(points, axes, options.tolerance) for points in curves.points]
    write_curves(options.target / CURVES, [points + np.array([0.0, 0.0, height]) for points in kept
                                           if points is not None], options.source.name)
    material = set_material.text_of(options.material)
    (options.target / DECK).write_text(TEXT.format(part=options.source.stem, material=material, curves=CURVES,
                                                   symmetry=symmetry.supports(axes)),
                                       encoding="utf-8")
    (options.target / PROCESS).write_text(OPERATIONS.format(part=options.source.stem, file=PROCESS), encoding="utf-8")
