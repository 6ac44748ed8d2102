# SPDX-License-Identifier: GPL-3.0-or-later
"""A rigid cylinder on an elastic half-space under a contact layer, plane strain: an integral equation.

The pressure p(x) is constant over strips. The gap is g = x^2/(2 R) - d + u(x) with the displacement u = A p of the
half-space (Johnson, Contact Mechanics, 1985, section 2.4); the rigid displacement d follows from the load. The layer of
height h gives p = p_0 (h/g - 2 + g/h) for g < h. Needs numpy.
"""
import math

import numpy as np

STRIPS, REACH = 300, 2.5  # on one half, and their length, mm


def strips():
    """Return edges of the strips, mm: they get longer outwards."""
    t = np.linspace(0, 1, STRIPS + 1)
    return REACH * (0.12 * t + 0.88 * t**3)


def influence(edges, modulus):
    """Return the matrix A, mm/MPa: strips and their mirror images."""
    def primitive(u):
        return u * np.log(np.abs(u)) - u

    x = 0.5 * (edges[1:] + edges[:-1])[:, None]
    inner, outer = edges[None, :-1], edges[None, 1:]
    sides = primitive(x - inner) - primitive(x - outer) + primitive(x + outer) - primitive(x + inner)
    return -2 / (math.pi * modulus) * sides


def pressure(radius, load, modulus, height, reference):
    """Return centres and lengths of the strips and their pressures.

    Newton's method on p = P(p - s g), the pressure of the law on the line of slope s through p and g.
    """
    edges = strips()
    x, length = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    matrix = influence(edges, modulus)
    scale = modulus / 8
    p = 0.5 * load / 0.25 * np.exp(-4 * x)
    d = (matrix @ p)[0]
    for _ in range(100):
        gap = x**2 / 2 / radius - d + matrix @ p
        # x = g/h on the line: (p_0 - s h) x^2 - (2 p_0 - s g + p) x + p_0 = 0
        a, b = reference - scale * height, 2 * reference + p - scale * gap
        touches = b - 2 * reference > -scale * height
        root = np.sqrt(np.where(touches, b * b - 4 * a * reference, 1.0))
        left = np.where(touches, 2 * reference / np.where(touches, b + root, 1.0), 1.0)
        law = reference * (1 / left - 2 + left)
        stiffness = reference / height * (1 / left**2 - 1)
        slope = stiffness / (stiffness + scale)
        residual = np.append(p - law, 2 * p @ length - load)
        tangent = np.block([[np.eye(STRIPS) - slope[:, None] * (np.eye(STRIPS) - scale * matrix),
                             -scale * slope[:, None]], [2 * length[None, :], np.zeros((1, 1))]])
        step = np.linalg.solve(tangent, -residual)
        p, d = p + step[:-1], d + step[-1]
        if np.abs(step[:-1]).max() < 1e-9 * np.abs(p).max():
            return x, length, p
    raise ArithmeticError("the integral equation did not converge")


def measure(radius, load, modulus, height, reference):
    """Return the half-width of the ellipse with the same second moment, mm, and the pressure in the middle, MPa."""
    x, length, p = pressure(radius, load, modulus, height, reference)
    force = p * length
    return 2 * math.sqrt(float(force @ (x * x + length**2 / 12)) / float(force.sum())), float(p[0])
