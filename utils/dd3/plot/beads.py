# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of draw-beads on the sheet, for pictures."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import pyvista as pv

from dd3.sheet import length

COLOUR = "#c0392b"
POINTS = 300  # of a drawn line, about
NEAREST = 8  # nodes around a point of the line that give its height


def draped(line: np.ndarray, nodes: np.ndarray) -> pv.PolyData:
    """Return a line in plan as a curve on the sheet with these nodes, as high as the highest of the nearest nodes."""
    ends = length(line)
    places = np.union1d(np.linspace(0.0, ends[-1], POINTS), ends)
    plan = np.column_stack([np.interp(places, ends, line[:, i]) for i in (0, 1)])
    distance = ((plan[:, None, :] - nodes[None, :, :2]) ** 2).sum(axis=2)
    nearest = np.argpartition(distance, min(NEAREST, len(nodes)) - 1, axis=1)[:, :NEAREST]
    return pv.lines_from_points(np.column_stack([plan, nodes[nearest, 2].max(axis=1)]))


def draw_beads(plotter: Any, lines: Iterable[np.ndarray], nodes: np.ndarray, shift: np.ndarray,
               images: Callable[[pv.PolyData], list[pv.PolyData]]) -> None:
    """Draw lines on the sheet, moved by `shift` towards the eye; `images` adds the mirror images of a mesh."""
    for line in lines:
        for part in images(draped(line, nodes)):
            plotter.add_mesh(part.translate(shift), color=COLOUR, line_width=5)
