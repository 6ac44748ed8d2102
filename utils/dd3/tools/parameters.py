# SPDX-License-Identifier: GPL-3.0-or-later
"""Parameters of the nodes on their CAD faces, from where the search of the closest point starts."""
from typing import Any

import numpy as np

# Surfaces whose first parameter is an angle.
ROUND = "Cylinder", "Cone", "Sphere", "Torus", "Surface of Revolution"
# Nodes of a patch with known parameters below which the others are not estimated.
FEWEST = 4


def length_of(gmsh: Any, edge: int) -> float:
    """Return the length of an edge, mm, 0 of a pole: it has no curve in space, though OpenCASCADE gives those at the
    corners of fillets a length of its tolerance."""
    length = gmsh.model.occ.getMass(1, edge)
    if gmsh.model.getType(1, edge) == "Unknown" and len(set(gmsh.model.getBoundary([(1, edge)], combined=False))) < 2:
        return 0.0
    return float(length) if length > 1e-9 else 0.0


def parameters_of(gmsh: Any, tag: int, count: int) -> np.ndarray:
    """Return the parameters of the nodes on a face, by label; NaN for other nodes, for those on a seam, and for the
    parameter along a pole."""
    table = np.full((count, 2), np.nan)
    bounds = [abs(edge) for _, edge in gmsh.model.getBoundary([(2, tag)], combined=False, oriented=True)]
    for edge in sorted((edge for edge in bounds if bounds.count(edge) == 1),
                       key=lambda edge: length_of(gmsh, edge), reverse=True):
        known, _, t = gmsh.model.mesh.getNodes(1, edge, includeBoundary=True, returnParametricCoord=True)
        if len(known) == len(t):
            table[known.astype(int)] = np.reshape(gmsh.model.reparametrizeOnSurface(1, edge, t, tag), (-1, 2))
        if not length_of(gmsh, edge):
            table[known.astype(int)] = pole_parameters(gmsh, edge, tag)
    known, _, uv = gmsh.model.mesh.getNodes(2, tag, includeBoundary=False, returnParametricCoord=True)
    if 2 * len(known) == len(uv):
        table[known.astype(int)] = np.reshape(uv, (-1, 2))
    else:  # some have none
        found = [gmsh.model.mesh.getNode(node)[1] for node in known]
        table[known.astype(int)] = [uv if len(uv) == 2 else (np.nan, np.nan) for uv in found]
    return within_turn(gmsh, tag, table)


def pole_parameters(gmsh: Any, edge: int, tag: int) -> np.ndarray:
    """Return the parameters of an edge without length on a face, NaN for the one that varies along it."""
    bounds = np.ravel(gmsh.model.getParametrizationBounds(1, edge))
    first, last = np.reshape(gmsh.model.reparametrizeOnSurface(1, edge, bounds, tag), (2, 2))
    return np.where(np.abs(last - first) > 1e-9, np.nan, first)


def within_turn(gmsh: Any, tag: int, table: np.ndarray) -> np.ndarray:
    """Return the parameters of a face with angles within the face's bounds; NaN for those that are not."""
    low, high = (np.array(bound) for bound in gmsh.model.getParametrizationBounds(2, tag))
    if gmsh.model.getType(2, tag) in ROUND:
        table[:, 0] -= 2 * np.pi * np.round((table[:, 0] - (low + high)[0] / 2) / (2 * np.pi))
    margin = 1e-3 * (high - low)
    table[((table < low - margin) | (table > high + margin)).any(axis=1)] = np.nan
    return table


def filled(uv: np.ndarray) -> np.ndarray:
    """Return the parameters (patch, 3, 3, 2) with those unknown as the mean of their patch; NaN for a patch with few
    known ones."""
    known = ~np.isnan(uv)
    count = known.sum(axis=(1, 2), keepdims=True)
    mean = np.where(known, uv, 0.0).sum(axis=(1, 2), keepdims=True) / np.maximum(count, 1)
    uv = np.where(known, uv, mean)
    uv[(count < FEWEST).any(axis=(1, 2, 3))] = np.nan
    return uv
