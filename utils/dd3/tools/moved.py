# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces at another place: rotated and moved, or at a distance along their normals."""
from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

# Cosine between normals of one node below which the node is on an edge.
ONE_NORMAL = np.cos(np.radians(3.0))


def shift_of(labels: np.ndarray, normals: np.ndarray, distance: float) -> np.ndarray:
    """Return the displacement of each entry: `labels` (n,) of nodes, `normals` (n, 3) there, n of all the entries that
    share a node may differ.

    The displacement d of a node with the normals n_i fulfils n_i . d = distance: offsets of the faces of an edge meet
    again. Returns the displacements (n, 3).
    """
    node, inverse = np.unique(labels, return_inverse=True)
    mean = np.zeros((len(node), 3))
    np.add.at(mean, inverse, normals)
    mean /= np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-300)
    shift = distance * mean
    edge = np.zeros(len(node), bool)
    edge[inverse[(normals * mean[inverse]).sum(axis=1) < ONE_NORMAL]] = True
    order = np.argsort(inverse, kind="stable")
    start = np.searchsorted(inverse[order], np.arange(len(node) + 1))
    for i in np.flatnonzero(edge):
        rows = normals[order[start[i]:start[i + 1]]]
        shift[i] = np.linalg.lstsq(rows, np.full(len(rows), distance), rcond=0.05)[0]
    return shift[inverse]


def rotation(turns: Sequence[Sequence[float]]) -> np.ndarray:
    """Return the matrix of rotations (x, y, z of the axis, angle in degrees), one after the other."""
    matrix = np.eye(3)
    for *axis, angle in turns:
        matrix = Rotation.from_rotvec(np.radians(angle) * np.array(axis) / np.linalg.norm(axis)).as_matrix() @ matrix
    return matrix


def placed(net: np.ndarray, matrix: np.ndarray, move: Sequence[float]) -> np.ndarray:
    """Return patches in homogeneous coordinates after a rotation and a translation."""
    return np.concatenate([net[..., :3] @ matrix.T + net[..., 3:] * np.array(move), net[..., 3:]], axis=-1)
