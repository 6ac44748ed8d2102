# SPDX-License-Identifier: GPL-3.0-or-later
"""Blank of a part: the estimate in one step of `dd3 unfold` of what the sheet has covered at the end of the draw, with
a margin."""
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from dd3.errors import Problem
from dd3.progress import doing
from dd3.tools.drawability import thinnest
from dd3.tools.plane import crosses, inside
from dd3.tools.surface import Surface, areas_at, points_at
from dd3.triangles import Triangles, area_vectors, prepared, rims
from dd3.unfold import Balance, Sheet, unfolded

# Triangles of a patch, and the number of patches up to which it gets as many.
TRIANGLES = {8: 1000.0, 4: 2000.0, 2: np.inf}
# Exponent of the hardening law of the estimate. With that of a mild steel, 0.2, the areas of two trays are within 0.4 %
# of these, and it takes four times as long.
EXPONENT = 0.5
# Distance over the thickness below which nodes become one: triangles that are much smaller than others hinder the
# estimate.
NEAR = 0.1
# Largest distance of the simplified outline from the outline, over the margin.
SIMPLE = 0.1
# Cells along each side of a patch, of two Gauss points each, at which its area is taken: of one patch, divided by the
# root of their number, and the least and the largest one.
CELLS = 128, 2, 64
# Step of the grid on which the distance from the outline is taken, over the margin.
STEP = 0.2
# Part of the area of its box above which an outline is not cut: the box is the blank.
FULL = 0.9


@dataclass
class Blank:
    """Blank in plan: closed outline (n, 2), mm, anticlockwise, and whether it is cut along it or is its box; the border
    of what is covered at the end of the draw, anticlockwise, and its points in the flat blank (m, 2), the largest
    thinning by the estimate, a fraction, and its place (3); none where these are not estimated; slope (2,) of the plane
    on which it lies at the start, and its height at x = y = 0, mm."""

    outline: np.ndarray
    cut: bool
    rim: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    flat: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    thinning: float | None = None
    thinnest: np.ndarray = field(default_factory=lambda: np.zeros(3))
    slope: np.ndarray = field(default_factory=lambda: np.zeros(2))
    height: float = 0.0

    @property
    def box(self) -> np.ndarray:
        """Return the box (2, 2)."""
        return np.array([self.outline.min(axis=0), self.outline.max(axis=0)])

    @property
    def area(self) -> float:
        """Return the area, mm2."""
        return area_of(self.outline) if self.cut else float(np.prod(np.ptp(self.box, axis=0)))

    @property
    def border(self) -> np.ndarray:
        """Return the closed line around it (n, 2)."""
        (x0, y0), (x1, y1) = self.box
        return self.outline if self.cut else np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])

    @property
    def inclined(self) -> bool:
        """Tell whether it does not lie level at the start."""
        return bool(np.any(self.slope))

    @property
    def normal(self) -> np.ndarray:
        """Return the unit normal of the plane on which it lies, upwards."""
        vector = np.array([*-self.slope, 1.0])
        return np.asarray(vector / np.linalg.norm(vector))

    def placed(self, points: np.ndarray) -> np.ndarray:
        """Return points of the flat blank (n, 2) in space (n, 3): turned into its plane about its middle."""
        middle, steep = self.box.mean(axis=0), np.linalg.norm(self.slope)
        across = self.slope / steep if steep else self.slope
        plan = points - np.outer((points - middle) @ across * (1.0 - self.normal[2]), across)
        return np.column_stack([plan, plan @ self.slope + self.height])

    def within(self, box: np.ndarray) -> "Blank":
        """Return the part of the blank in a box (2, 2)."""
        return replace(self, outline=np.clip(self.outline, *box))

    def pressed(self, surface: Surface) -> float:
        """Return the area in plan of the part of a surface that is over the blank, mm2."""
        count = int(np.clip(CELLS[0] / len(surface.net)**0.5, *CELLS[1:]))
        t = ((np.arange(count)[:, None] + 0.5 * (1 + np.array([-1, 1]) / 3**0.5)) / count).ravel()
        u, v = (axis.ravel() for axis in np.meshgrid(t, t))
        area, points = np.abs(areas_at(surface.net, u, v)[..., 2]), points_at(surface.net, u, v)
        over = inside(points[..., :2].reshape(-1, 2), self.border).reshape(area.shape)
        return float((area * over).sum() / len(t)**2)


def blank_of(path: Path, covered: Surface, thickness: float, margin: float) -> Blank:
    """Return the blank that lies on a surface, of one piece and seen from above, and is wider by a margin, mm."""
    mesh, places = laid_flat(path, covered, thickness)
    border = max(rims(path, mesh.triangles), key=lambda rim: abs(area_of(places[rim])))
    border = border if area_of(places[border]) > 0 else border[::-1]
    outline = widened(places[border], margin)
    box = np.prod(np.ptp(outline, axis=0))
    return Blank(outline, area_of(outline) < FULL * box, mesh.nodes[border, :2], places[border],
                 *thinnest(mesh, places))


@doing("laying the part flat for its blank")
def laid_flat(path: Path, covered: Surface, thickness: float) -> tuple[Triangles, np.ndarray]:
    """Return the middle of the sheet on a surface as triangles, and the places of its nodes in the flat blank (n, 2).
    Fewer triangles have an estimate where slivers beside curved edges of patches hinder it."""
    def laid(count: int) -> tuple[Triangles, np.ndarray]:
        mesh = raised(prepared(path, triangles_of(covered, count), [], NEAR * thickness), thickness / 2)
        return mesh, unfolded(path, Balance(mesh, Sheet(EXPONENT)))

    *finer, last = [count for count, most in TRIANGLES.items() if len(covered.net) <= most]
    for count in finer:
        with suppress(Problem):
            return laid(count)
    return laid(last)


def triangles_of(surface: Surface, count: int) -> Triangles:
    """Return the patches as `count` triangles each, 8 or 4 around their middles, 2 between their corners."""
    around = np.array([[0, 0], [.5, 0], [1, 0], [1, .5], [1, 1], [.5, 1], [0, 1], [0, .5]])
    around = around if count == 8 else around[::2]
    u, v = np.array([*([[.5, .5]] if count > 2 else []), *around]).T
    nodes = points_at(surface.net, u, v)
    rim = np.arange(1, len(u))
    of_patch = (np.stack([np.zeros_like(rim), rim, np.roll(rim, -1)], axis=1) if count > 2
                else np.array([[0, 1, 2], [0, 2, 3]]))
    first = len(u) * np.arange(len(nodes))[:, None, None]
    return Triangles(nodes.reshape(-1, 3), (first + of_patch).reshape(-1, 3))


def raised(mesh: Triangles, height: float) -> Triangles:
    """Return triangles at a height above others, along the mean normals at their nodes."""
    normal = np.zeros_like(mesh.nodes)
    for corner in mesh.triangles.T:
        np.add.at(normal, corner, area_vectors(mesh.nodes, mesh.triangles))
    return Triangles(mesh.nodes + height * normal / np.linalg.norm(normal, axis=1, keepdims=True), mesh.triangles)


def area_of(points: np.ndarray) -> float:
    """Return the area of a closed line (n, 2), positive if it runs anticlockwise."""
    after = np.roll(points, -1, axis=0)
    return float(points[:, 0] @ after[:, 1] - points[:, 1] @ after[:, 0]) / 2


def widened(outline: np.ndarray, margin: float) -> np.ndarray:
    """Return the line around a closed one at a distance from it, mm, with as few points as its shape needs."""
    from contourpy import contour_generator
    size = np.linalg.norm(np.roll(outline, -1, axis=0) - outline, axis=1)
    fine = np.concatenate([p + np.linspace(0, 1, max(int(length / (STEP * margin)), 1), endpoint=False)[:, None]
                           * (q - p) for p, q, length in zip(outline, np.roll(outline, -1, axis=0), size)])
    low, high = fine.min(axis=0) - 2 * margin, fine.max(axis=0) + 2 * margin
    x, y = (np.arange(a, b, STEP * margin) for a, b in zip(low, high))
    grid = np.stack(np.meshgrid(x, y), axis=-1)
    away = cKDTree(fine).query(grid.reshape(-1, 2), distance_upper_bound=2 * margin)[0].reshape(grid.shape[:2])
    away = np.minimum(away, 2 * margin)
    lines = contour_generator(x, y, away).lines(margin)
    around = max((np.array(line)[:-1] for line in lines), key=lambda line: abs(area_of(line)))
    around = around if area_of(around) > 0 else around[::-1]
    result = simplified(around, SIMPLE * margin)
    if crosses(result):
        raise Problem("the outline of the blank crosses itself")
    return result


def simplified(points: np.ndarray, tolerance: float) -> np.ndarray:
    """Return the points of a closed line that are needed for it to stay within a distance."""
    far = int(np.linalg.norm(points - points[0], axis=1).argmax())
    ring = np.vstack([points, points[:1]])
    return np.vstack([needed(ring[:far + 1], tolerance)[:-1], needed(ring[far:], tolerance)[:-1]])


def needed(line: np.ndarray, tolerance: float) -> np.ndarray:
    """Return the points of an open line that are needed for it to stay within a distance (Douglas and Peucker 1973)."""
    kept = [0, len(line) - 1]
    open_parts = [(0, len(line) - 1)]
    while open_parts:
        first, last = open_parts.pop()
        if last - first < 2:
            continue
        chord = line[last] - line[first]
        inner = line[first + 1:last] - line[first]
        length = np.linalg.norm(chord)
        distance = abs(inner[:, 0] * chord[1] - inner[:, 1] * chord[0]) / length
        if distance.max() > tolerance:
            middle = first + 1 + int(distance.argmax())
            kept.append(middle)
            open_parts += [(first, middle), (middle, last)]
    return line[sorted(kept)]
