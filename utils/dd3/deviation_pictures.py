# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the deviations of a part from its nominal shape: on the part and along sections."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dd3.fixture import Fixture
from dd3.plot import sheet as pictures
from dd3.plot.figures import new_figure, save
from dd3.sheet import LOWER, UPPER

if TYPE_CHECKING:
    from dd3.deviation import Deviations

IN, ABOVE, BELOW = "#009e73", "#d55e00", "#8b1a1a"  # within the tolerance, above and below it
SHADES = 256  # of the map


def colours(low: float, high: float, limits: tuple[float, float]) -> list[str]:
    """Return the colours of a map from its lower to its upper end: green within the tolerance, red outside."""
    values = np.linspace(low, high, SHADES)
    return [BELOW if value < limits[0] else ABOVE if value > limits[1] else IN for value in values]


def draw_map(found: "Deviations", fixture: Fixture, path: Path) -> None:
    """Draw the deviations on the part at its nominal place."""
    part = found.part
    mesh = part.sheet.grid_of(part.step, found.motion.of(part.sheet.points(part.step)))
    corners = part.sheet.corners(part.step)
    deviation = np.full(mesh.n_points, np.nan)
    deviation[part.nodes] = found.distance
    mine, other = (UPPER, LOWER) if fixture.upper else (LOWER, UPPER)
    deviation[corners[:, other]] = deviation[corners[:, mine]]  # the other face has the values of this one
    mesh.point_data["shown"] = deviation
    high = float(np.nanmax(np.abs(found.distance)))
    style: dict[str, Any] = {"limits": (-max(high, 1e-6), max(high, 1e-6))}
    if fixture.limits:
        high = max(high, 1.5 * max(map(abs, fixture.limits)))
        style = {"limits": (-high, high), "colours": colours(-high, high, fixture.limits)}
    pictures.make_map(mesh, "deviation from the nominal shape (mm)",
                      pictures.Style(mirror=fixture.mirror, view="iso" if fixture.upper else "below", **style), path)


def draw_sections(found: "Deviations", fixture: Fixture, path: Path) -> None:
    """Draw the deviations along the sections, the tolerance as a band."""
    groups = list(found.sections.groupby("section", sort=False))
    figure, axes = new_figure((7, 2.6 * len(groups)), len(groups), squeeze=False)
    for (name, table), place in zip(groups, axes[:, 0]):
        place.plot(table["length"], table["deviation"], color="#0072b2", linewidth=1.3)
        if fixture.limits:
            place.axhspan(*fixture.limits, color=IN, alpha=0.2)
        place.set(xlabel=f"along the section {name} of the nominal shape (mm)", ylabel="deviation (mm)")
        place.grid(True, color="0.9")
    save(figure, path, 150)
