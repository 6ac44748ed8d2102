# SPDX-License-Identifier: GPL-3.0-or-later
"""Rays and closest points on the triangles of a part, by VTK's search trees."""
from dataclasses import dataclass
from typing import Any

import numpy as np

from dd3.part.shape import Shape, unit


@dataclass
class Hits:
    """Where rays meet a part: distances, inf without a hit, numbers of the triangles, -1 without, and unit normals."""

    distance: np.ndarray
    triangle: np.ndarray
    normal: np.ndarray


class Rays:
    """Search on the triangles of a shape."""

    def __init__(self, shape: Shape) -> None:
        from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
        from vtkmodules.vtkCommonCore import reference, vtkIdList, vtkPoints
        from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkGenericCell, vtkPolyData, vtkStaticCellLocator
        points, cells, data = vtkPoints(), vtkCellArray(), vtkPolyData()
        points.SetData(numpy_to_vtk(np.ascontiguousarray(shape.nodes), deep=True))
        offsets = numpy_to_vtkIdTypeArray(np.arange(0, 3 * len(shape.triangles) + 1, 3), deep=True)
        cells.SetData(offsets, numpy_to_vtkIdTypeArray(np.ascontiguousarray(shape.triangles.ravel()), deep=True))
        data.SetPoints(points)
        data.SetPolys(cells)
        self.tree: Any = vtkStaticCellLocator()
        self.tree.SetDataSet(data)
        self.tree.BuildLocator()
        self.data, self.ids, self.cell = data, vtkIdList(), vtkGenericCell()
        self.reference: Any = reference
        self.shape = shape

    def hits(self, origin: np.ndarray, direction: np.ndarray, ahead: np.ndarray | float) -> "Hits":
        """Return where rays from triangles `origin` (n,) along unit vectors (n, 3) first meet the others. They begin
        `ahead` of the triangles, mm, a length along the ray or vectors (n, 3); distances are from the
        points on the CAD."""
        from vtkmodules.vtkCommonCore import vtkPoints
        found = vtkPoints()
        point, triangle = np.zeros((len(origin), 3)), np.full(len(origin), -1)
        start = self.shape.foot[origin] + (ahead * direction if np.ndim(ahead) == 0 else ahead)
        end = start + 1.5 * self.shape.size * direction
        for i in range(len(origin)):
            self.ids.Reset()
            if self.tree.IntersectWithLine(start[i], end[i], 1e-9, found, self.ids) and self.ids.GetNumberOfIds():
                point[i] = found.GetPoint(0)
                triangle[i] = self.ids.GetId(0)
        return self.on_surface(self.shape.place[origin], direction, point, triangle)

    def on_surface(self, start: np.ndarray, direction: np.ndarray, point: np.ndarray, triangle: np.ndarray) -> "Hits":
        """Return hits whose distance and normal are those of the curved surface, to second order: between the corners
        it is half as far from the triangle as the tangent planes at the corners."""
        met = triangle >= 0
        corner = self.shape.nodes[self.shape.triangles[triangle[met]]]
        normals = self.shape.corner_normal[triangle[met]]
        weight = barycentric(corner, point[met])
        to_planes = ((corner - point[met, None]) * normals).sum(axis=2)
        away = 0.5 * ((weight * to_planes)[..., None] * normals).sum(axis=1)
        distance, normal = np.full(len(start), np.inf), np.zeros((len(start), 3))
        distance[met] = ((point[met] + away - start[met]) * direction[met]).sum(axis=1)
        normal[met] = unit((weight[..., None] * normals).sum(axis=1))
        return Hits(distance, triangle, normal)

    def distances(self, points: np.ndarray) -> np.ndarray:
        """Return the distances of points from the triangles, mm."""
        closest, number, sub, square = [0.0] * 3, self.reference(0), self.reference(0), self.reference(0.0)
        result = np.zeros(len(points))
        for i, point in enumerate(points):
            self.tree.FindClosestPoint(point, closest, self.cell, number, sub, square)
            result[i] = float(square.get())
        return np.sqrt(result)


def barycentric(corner: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Return the barycentric coordinates (n, 3) of points in triangles (n, 3, 3)."""
    area = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    square = np.maximum((area * area).sum(axis=1), 1e-300)
    first, second = np.roll(corner, -1, axis=1), np.roll(corner, -2, axis=1)
    parts = np.cross(second - first, point[:, None] - first)
    return (parts * area[:, None]).sum(axis=2) / square[:, None]
