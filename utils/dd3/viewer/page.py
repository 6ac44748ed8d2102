# SPDX-License-Identifier: GPL-3.0-or-later
"""The texts that make a page interactive: markup, styles, scripts, and the data of figures and of the 3D view."""

import html
import json
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from dd3.viewer.scene import Scene

FOLDER = Path(__file__).parent
SCRIPTS = ("library.min.js", "charts.js", "data.js", "colours.js", "stage.js", "bodies.js", "section.js",
           "limit_diagram.js", "viewer.js")
DIGITS = 5  # of the numbers of curves


def own_file(name: str) -> str:
    """Return the text of a file of this package."""
    return (FOLDER / name).read_text(encoding="utf-8")


def data(name: str, content: Any) -> str:
    """Return the element that holds data of a page."""
    text = json.dumps(content).replace("</", "<\\/")
    return f'<script type="application/json" id="{name}">{text}</script>'


def view(scene: Scene) -> str:
    """Return the element of the 3D view with its data."""
    description = scene.description()
    left_out, said = description["left_out"], ""
    if left_out:
        said = f"<p>{left_out} of {scene.sheet.count} steps of the run are left out, for the size of the page.</p>"
    return own_file("viewer.html") + said + data("scene", description) + "\n".join(scene.arrays.elements)


def scripts() -> str:
    """Return the scripts, which stand at the end of the page, and the licences of those that are not our own."""
    texts = [own_file(name) for name in SCRIPTS]
    return "\n".join([f"<!--\n{own_file('library.LICENSES.txt')}-->", *(f"<script>{text}</script>" for text in texts)])


def chart(name: str, figure: Figure, picture: str) -> str:
    """Return the element of a figure of curves: a picture, which a browser with scripts replaces by charts."""
    return f'<div data-curves="curves_{html.escape(name)}">{picture}</div>' + data(
        f"curves_{name}", [axes_of(axes) for axes in figure.axes])


def axes_of(axes: Axes) -> dict[str, Any]:
    """Return the labels and the curves of axes."""
    return {"x": axes.get_xlabel(), "y": axes.get_ylabel(), "equal": axes.get_aspect() == 1.0,
            "lines": [curve for line in axes.get_lines() if (curve := curve_of(line))]}


def curve_of(line: Any) -> dict[str, Any] | None:
    """Return the points and the look of a curve; None without a point."""
    points = np.asarray(line.get_xydata(), float)
    points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        return None
    x, y = ([float(f"{value:.{DIGITS}g}") for value in column] for column in points.T)
    return {"label": str(line.get_label()), "x": x, "y": y, "colour": to_hex(line.get_color()),
            "width": float(line.get_linewidth()), "line": line.get_linestyle() not in ("None", "none", ""),
            "dashed": line.get_linestyle() == "--", "points": line.get_marker() not in ("None", "none", "", None)}
