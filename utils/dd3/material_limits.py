# SPDX-License-Identifier: GPL-3.0-or-later
"""Limits that a run follows along the path of each point, as fields that are 1 at the limit: the damage of the law of
fracture, and the ratio to the forming limit, which is independent of the path."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dd3.fields import LIMITED, Fields

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from dd3.forming_limit import Strains

# Of each field its title, what elements above 1 are, their mark in the forming limit diagram, and whether the nodes
# count, with values extrapolated to the faces: a crack begins there, and a neck crosses the sheet.
FIELDS = dict(zip(LIMITED, (
    ("Fracture damage", "fractured", "s", True),
    ("Ratio to the forming limit of bent paths", "beyond the limit of bent paths", "o", False))))
LISTED = 12  # elements


class Reached(NamedTuple):
    """A limit of a run: its field, the means of the elements, their middles, mm, and the values at the nodes."""

    name: str
    values: np.ndarray
    middles: np.ndarray
    nodes: np.ndarray

    @property
    def beyond(self) -> np.ndarray:
        """The elements that are at the limit or beyond, the largest value first, from 0."""
        order = np.argsort(-self.values, kind="stable")
        return order[self.values[order] >= 1]

    def said(self) -> str:
        """Return how many nodes and elements are beyond, which elements, and the largest mean of an element."""
        most, beyond = int(self.values.argmax()), self.beyond
        _, what, _, of_nodes = FIELDS[self.name]
        place = ", ".join(f"{x:.1f}" for x in self.middles[most])
        nodes = f"{(self.nodes >= 1).sum()} of {len(self.nodes)} nodes, " if of_nodes else ""
        text = (f"{nodes}{len(beyond)} of {len(self.values)} elements {what} ({self.name}); largest mean of an element "
                f"{self.values[most]:.3g} in {most + 1} at ({place}) mm")
        if not len(beyond):
            return text
        more = f" and {len(beyond) - LISTED} more" if len(beyond) > LISTED else ""
        return f"{text}; elements {' '.join(str(element + 1) for element in beyond[:LISTED])}{more}"


def reached(fields: Fields, step: int) -> Iterator[Reached]:
    """Return the limits that a run follows, at a step."""
    for name in FIELDS:
        if name in fields.grid.get("CellData", {}):
            cells, points = fields.cells(step), fields.points(step)
            count = np.diff(cells.offsets)
            middles = np.add.reduceat(points[cells.nodes], cells.offsets[:-1]) / count[:, None]
            values = [fields.values(step, name, at_cells)[0].astype(float) for at_cells in (True, False)]
            yield Reached(name, values[0], middles, values[1])


def mark(axes: "Axes", strains: "Strains", limit: Reached) -> None:
    """Mark the elements that are beyond a limit in a forming limit diagram."""
    beyond, cells = limit.beyond, strains.at_cells
    if len(beyond) and cells:
        _, label, marker, _ = FIELDS[limit.name]
        axes.plot(cells.minor[beyond], cells.major[beyond], marker, color="k", markerfacecolor="none", markersize=8,
                  label=label)
        axes.legend(frameon=False, fontsize=9)
