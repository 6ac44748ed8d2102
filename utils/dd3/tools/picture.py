# SPDX-License-Identifier: GPL-3.0-or-later
"""Picture of a tool's patches with their normals. No display is needed."""
import re
from pathlib import Path
from typing import Any

import numpy as np

from dd3 import rendering
from dd3.errors import Problem
from dd3.progress import doing
from dd3.tools.joints import EDGES, Joints, box_of
from dd3.tools.surface import Surface, areas_at, grid, points_at

MOST_ARROWS = 1500
MOST_LABELS = 300
POINTS = 5  # on a side of a patch
COLOURS = ["#8d99a6", "#a69b8d", "#93a68d", "#a08da6", "#a68d93", "#8da6a1"]
MULTIPLE, FREE, JOINED = "#d62728", "#1f3fb4", "#555555"


def quads(net: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the points and the cells of a flat-faced copy of the patches."""
    points = points_at(net, *grid(POINTS)).reshape(-1, 3)
    corner = np.add.outer(np.arange(POINTS - 1) * POINTS, np.arange(POINTS - 1)).ravel()
    cell = np.stack([corner, corner + 1, corner + POINTS + 1, corner + POINTS], axis=1)
    cells = (cell[None] + (np.arange(len(net)) * POINTS**2)[:, None, None]).reshape(-1, 4)
    return points, np.insert(cells, 0, 4, axis=1).ravel()


def lines(pv: Any, net: np.ndarray, edge: np.ndarray) -> Any:
    """Return edges, given by number, as lines."""
    t = np.linspace(0, 1, POINTS)
    points = np.zeros((len(edge), POINTS, 3))
    for k, place in enumerate(EDGES):
        chosen = edge % 4 == k
        points[chosen] = points_at(net[edge[chosen] // 4], *place(t))
    cells = np.insert(np.arange(len(edge) * POINTS).reshape(-1, POINTS), 0, POINTS, axis=1)
    return pv.PolyData(points.reshape(-1, 3), lines=cells.ravel())


def arrows(pv: Any, net: np.ndarray, size: float) -> Any:
    """Return the normals in the middle of the patches, of every n-th of many."""
    net = net[::len(net) // MOST_ARROWS + 1]
    half = np.array([0.5])
    normal = areas_at(net, half, half)[:, 0]
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    cloud = pv.PolyData(points_at(net, half, half)[:, 0])
    cloud["normal"] = normal
    arrow = pv.Arrow(tip_radius=0.18, shaft_radius=0.05)
    return cloud.glyph(orient="normal", scale=False, factor=0.03 * size, geom=arrow)


def labels(surface: Surface) -> tuple[np.ndarray, list[str]]:
    """Return the numbers of the CAD's faces and places on them, in the patches nearest to their middles."""
    half = np.array([0.5])
    middle = points_at(surface.net, half, half)[:, 0]
    places, numbers = [], []
    for face in np.unique(surface.face):
        number = re.match(r"face (\d+)", surface.names[face])
        chosen = middle[surface.face == face]
        if number:
            away = np.linalg.norm(chosen - chosen.mean(axis=0), axis=1)
            places.append(chosen[away.argmin()])
            numbers.append(number[1])
    return np.array(places), numbers


@doing("drawing a tool")
def draw(surface: Surface, joints: Joints, path: Path) -> None:
    """Write the picture: faces in colours, free edges blue, those of more than two patches red, normals as arrows."""
    import pyvista as pv
    plotter = rendering.new_plotter(window_size=[1500, 1100])
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    faces = np.unique(surface.face)
    for colour in range(min(len(COLOURS), len(faces))):
        points, cells = quads(surface.net[np.isin(surface.face, faces[colour::len(COLOURS)])])
        plotter.add_mesh(pv.PolyData(points, cells), color=COLOURS[colour], ambient=0.25)
    for edges, paint, width in ((joints.first, JOINED, 1.5), (joints.free, FREE, 3),
                                 (joints.multiple, MULTIPLE, 6)):
        if len(edges):
            plotter.add_mesh(lines(pv, surface.net, edges), color=paint, line_width=width)
    low, high = box_of(surface.net)
    plotter.add_mesh(arrows(pv, surface.net, float(np.linalg.norm(high - low))), color="#e07b00")
    places, numbers = labels(surface)
    if 1 < len(numbers) <= MOST_LABELS:
        plotter.add_point_labels(places, numbers, font_size=15, bold=False, shape_color="white", shape_opacity=0.7,
                                 show_points=False, always_visible=True, margin=1)
    # The camera looks at the side of the normals.
    half = np.array([0.5])
    above = areas_at(surface.net, half, half)[:, 0, 2].sum() >= 0
    plotter.camera_position = [(low + high) / 2 + np.array([-0.9, -1.6, 1.1 if above else -1.1]), (low + high) / 2,
                               (0, 0, 1)]
    plotter.enable_parallel_projection()
    plotter.reset_camera()
    try:
        plotter.screenshot(str(path))
    except (OSError, ValueError) as error:
        raise Problem(f"{path}: {error}") from None
