# SPDX-License-Identifier: GPL-3.0-or-later
"""Picture of a part with the numbers of its faces, from above and from below its press direction."""
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dd3 import rendering
from dd3.errors import Problem
from dd3.part.rays import Rays
from dd3.part.reading import Reading
from dd3.part.shape import unit
from dd3.progress import doing

MOST_LABELS = 250
OBLIQUE = 0.4  # tangent of the angle by which the view turns from across the part
# Triangles of a face that are tried for its number, and its distance from the face over the size of the part.
TRIED, AHEAD = 12, 0.005
FAULT, EDGE, OPENING = "#d62728", "#444444", "#1a8f4a"
# Colours of rims, of undercut faces, and of draft angles from 0 to 90 degrees.
RIM, BACK, WALLS, LEVEL = np.array([[0.60, 0.63, 0.65], [0.84, 0.15, 0.16], [0.98, 0.80, 0.36], [0.45, 0.66, 0.85]])


@doing("drawing part.png")
def draw(reading: Reading, path: Path) -> None:
    """Write the picture: faces by their draft, walls yellow and level ones blue, undercut ones red, rims grey; edges of
    faults thick and red, with their numbers, and those of holes and notches green. No display is needed."""
    import pyvista as pv
    shape, rays = reading.shape, Rays(reading.shape)
    up = reading.direction.vector if reading.direction else np.array([0.0, 0.0, 1.0])
    plotter = rendering.new_plotter(shape=(1, 2), window_size=[1800, 900], border=False)
    cells = np.insert(shape.triangles, 0, 3, axis=1).ravel()
    mesh = pv.PolyData(shape.nodes, cells)
    mesh.cell_data["colour"] = colours(reading)
    side = side_of_view(reading, up)
    points = shape.nodes[np.unique(shape.triangles)]
    for column, above in enumerate((1.0, -1.0)):
        plotter.subplot(0, column)
        plotter.set_background("white")
        plotter.add_mesh(mesh, scalars="colour", rgb=True, ambient=0.35, opacity=1.0 if reading.direction else 0.08)
        plotter.add_mesh(lines(pv, reading, None), color=EDGE, line_width=1.2)
        openings = [edge for hole in reading.holes for edge in hole.loop.edges]
        openings += [edge for notch in reading.notches for edge in notch.edges]
        if openings:
            plotter.add_mesh(lines(pv, reading, openings), color=OPENING, line_width=3)
        view = unit(above * up + 0.75 * side)
        label(plotter, reading, rays, view)
        focus = middle_of(points, [*across(view, up), view])
        plotter.camera_position = [focus + 3 * shape.size * view, focus, up]
        plotter.enable_parallel_projection()
        plotter.reset_camera()
        plotter.camera.parallel_scale = 0.53 * max(np.ptp(points @ axis) for axis in across(view, up))
        plotter.add_text("from above" if above > 0 else "from below", font_size=9, color="black")
    try:
        plotter.screenshot(str(path))
    except (OSError, ValueError) as error:
        raise Problem(f"{path}: {error}") from None
    finally:
        plotter.close()


def across(view: np.ndarray, up: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the unit vectors to the right and to the top of a picture."""
    right = unit(np.cross(up, view))
    return right, np.cross(view, right)


def middle_of(points: np.ndarray, axes: Sequence[np.ndarray]) -> np.ndarray:
    """Return the middle of the box of points along axes."""
    return np.sum([((points @ axis).max() + (points @ axis).min()) / 2 * axis for axis in axes], axis=0)


def side_of_view(reading: Reading, up: np.ndarray) -> np.ndarray:
    """Return the horizontal direction from which the part is seen: obliquely across its longest extent."""
    points = reading.shape.nodes[np.unique(reading.shape.triangles)]
    level = points - points.mean(axis=0)
    level -= np.outer(level @ up, up)
    along = np.linalg.eigh(level.T @ level)[1][:, 2]
    along = along * np.sign(along[np.abs(along).argmax()])
    return unit(np.cross(along, up) + OBLIQUE * along)


def colours(reading: Reading) -> np.ndarray:
    """Return the colours of the triangles (m, 3), 0 to 255."""
    shape, direction = reading.shape, reading.direction
    if not direction:
        return np.tile((255 * LEVEL).astype(np.uint8), (len(shape.face), 1))
    draft = np.clip(np.nan_to_num(direction.draft) / 90, 0, 1)[:, None]
    found = WALLS + draft * (LEVEL - WALLS)
    found[np.isnan(direction.draft)] = RIM
    found[np.isin(shape.face, list(direction.undercut))] = BACK
    return (255 * found).astype(np.uint8)


def lines(pv: Any, reading: Reading, edges: list[int] | None) -> Any:
    """Return edges, all by default, as lines."""
    shape = reading.shape
    pieces = shape.pieces if edges is None else shape.pieces[np.isin(shape.piece_edge, edges)]
    return pv.PolyData(shape.nodes, lines=np.insert(pieces, 0, 2, axis=1).ravel())


def label(plotter: Any, reading: Reading, rays: Rays, view: np.ndarray) -> None:
    """Add the numbers of the faces that are seen, larger ones first, and faulty edges with their numbers."""
    import pyvista as pv
    shape = reading.shape
    marked = {tag for fault in reading.faults for tag in fault.faces}
    tags = sorted(shape.tags, key=lambda tag: (tag not in marked, tag in reading.sheet.rims, -shape.areas[tag]))
    places = {tag: seen_place(reading, rays, tag, view) for tag in tags[:2 * MOST_LABELS]}
    shown = [tag for tag, place in places.items() if place is not None][:MOST_LABELS]
    style: dict[str, Any] = {"font_size": 13, "bold": False, "show_points": False, "always_visible": True, "margin": 1}
    if shown:
        plotter.add_point_labels(np.array([places[tag] for tag in shown]), [str(tag) for tag in shown],
                                 shape_color="white", shape_opacity=0.6, **style)
    edges = sorted({edge for fault in reading.faults for edge in fault.edges})
    if edges:
        plotter.add_mesh(lines(pv, reading, edges), color=FAULT, line_width=6)
        middles = [shape.nodes[shape.pieces[shape.piece_edge == edge].ravel()].mean(axis=0) for edge in edges]
        plotter.add_point_labels(np.array(middles), [f"edge {edge}" for edge in edges], shape_color="#ffd9d9", **style)


def seen_place(reading: Reading, rays: Rays, tag: int, view: np.ndarray) -> np.ndarray | None:
    """Return a place for the number of a face, near the middle of what is seen of it, None if nothing is."""
    shape = reading.shape
    own = shape.cells[tag]
    if shape.closed:
        own = own[shape.normal[own] @ view > 0.05]
    if not len(own):
        return None
    if not reading.direction:  # boxes of parts
        return shape.centres[tag]
    own = own[np.argsort(np.linalg.norm(shape.place[own] - shape.place[own].mean(axis=0), axis=1))]
    own = own[:: len(own) // TRIED + 1]
    ahead = AHEAD * shape.size
    seen = rays.hits(own, np.tile(view, (len(own), 1)), ahead).triangle < 0
    return shape.place[own[seen][0]] + ahead * view if seen.any() else None
