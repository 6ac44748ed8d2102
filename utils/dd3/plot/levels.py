# SPDX-License-Identifier: GPL-3.0-or-later
"""Colours and legend of a field of whole numbers: how often the elements have been divided."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import pyvista as pv

LEVEL = "level"  # field of the cells
COLOURS = ("#e3e7eb", "#9ecae1", "#4292c6", "#fdae61", "#d7301f")


def colours_of(highest: int) -> list[str]:
    """Return the colours of the levels from 0."""
    return list(COLOURS[: highest + 1])


def limits_of(highest: int) -> list[float]:
    """Return the range of the colours, each around its level."""
    return [-0.5, highest + 0.5]


def names_of(levels: Sequence[np.ndarray]) -> list[str]:
    """Return the names of the levels, given those of the elements in each picture: of a single picture with numbers."""
    highest = int(max(values.max() for values in levels))
    if len(levels) > 1:
        return [f"level {level}" for level in range(highest + 1)]
    return [f"level {level}: {int((levels[0] == level).sum())} elements" for level in range(highest + 1)]


def draw_legend(plotter: Any, names: Sequence[str]) -> None:
    """Draw the legend in the strip below the pictures."""
    low, high = limits_of(len(names) - 1)
    table = pv.LookupTable(colours_of(len(names) - 1), n_values=len(names), scalar_range=(low, high))
    table.annotations = dict(enumerate(names))
    mapper = pv.DataSetMapper(pv.PointSet(np.zeros((1, 3))))
    mapper.lookup_table = table
    plotter.add_scalar_bar(title=" ", mapper=mapper, vertical=False, position_x=0.1, width=0.8, position_y=0.4,
                           height=0.45, n_labels=0, title_font_size=4, label_font_size=17, color="black")
