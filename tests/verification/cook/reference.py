#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tip displacement of Cook's membrane in plane stress: 9-node quadrilaterals, extrapolated. Needs numpy."""
import numpy as np

YOUNG, POISSON = 1.0, 1 / 3
MATRIX = YOUNG / (1 - POISSON**2) * np.array([[1, POISSON, 0], [POISSON, 1, 0], [0, 0, (1 - POISSON) / 2]])
POINTS = [(-np.sqrt(0.6), 5 / 9), (0.0, 8 / 9), (np.sqrt(0.6), 5 / 9)]


def lagrange(s):
    """Return the three quadratic functions and their derivatives."""
    return np.array([s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2]), np.array([s - 0.5, -2 * s, s + 0.5])


def place(u, v):
    """Return the point of the panel."""
    return 48 * u, 44 * u + (44 - 28 * u) * v


def stiffness(x):
    """Return the matrix of an element with its nodes x, numbered 3 i + j."""
    result = np.zeros((18, 18))
    for s, first in POINTS:
        for t, second in POINTS:
            (a, da), (b, db) = lagrange(s), lagrange(t)
            slope = np.array([np.outer(da, b).ravel(), np.outer(a, db).ravel()])
            jacobian = slope @ x
            slope = np.linalg.solve(jacobian, slope)
            strain = np.zeros((3, 18))
            strain[0, ::2], strain[1, 1::2], strain[2, ::2], strain[2, 1::2] = slope[0], slope[1], slope[1], slope[0]
            result += first * second * np.linalg.det(jacobian) * strain.T @ MATRIX @ strain
    return result


def tip(n):
    """Return the displacement in the middle of the right edge with n x n elements, eliminated column by column."""
    rows = 2 * n + 1
    size = 2 * rows
    carried, load = None, None
    for column in range(n):
        block = np.zeros((3 * size, 3 * size))
        for row in range(n):
            nodes = [(i, 2 * row + j) for i in range(3) for j in range(3)]
            x = np.array([place((2 * column + i) / (2 * n), j / (2 * n)) for i, j in nodes])
            index = [i * size + 2 * j + d for i, j in nodes for d in range(2)]
            block[np.ix_(index, index)] += stiffness(x)
        if column == 0:
            block = block[size:, size:]
        else:
            block[:size, :size] += carried
        keep = len(block) - size
        a, b = block[:keep, :keep], block[:keep, keep:]
        carried = block[keep:, keep:] - b.T @ np.linalg.solve(a, b)
    load = np.zeros(size)
    for row in range(n):
        for j, weight in enumerate((1, 4, 1)):
            load[2 * (2 * row + j) + 1] += weight / 6 / n
    return np.linalg.solve(carried, load)[2 * n + 1]


if __name__ == "__main__":
    results = [tip(n) for n in (8, 16, 32)]
    print(results)
    first, second = results[-2] - results[-3], results[-1] - results[-2]
    print(results[-1] + second**2 / (first - second))
