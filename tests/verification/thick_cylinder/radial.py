#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Thick cylinder of a perfectly plastic material in plane strain, integrated over its radius.

A chain of layers between radii that move: hoop stretch of the mean radius, radial stretch of the thickness, none along
the axis. Von Mises with the axial stress that follows from it, incremental logarithmic strains, backward Euler, and
equilibrium in the moved state. The closed form takes the axial stress as the mean of the others and the radii as fixed.
"""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "strip_bending"))
from ring import solve_tridiagonal, update

LAYERS, STEPS = 100, 20


class Cylinder:
    """Radii between the layers, and stress and plastic strain of the layers."""

    def __init__(self, inner, outer, flow):
        self.radii = [inner * (outer / inner) ** (i / LAYERS) for i in range(LAYERS + 1)]
        self.layers = [([0.0, 0.0, 0.0], 0.0)] * LAYERS
        self.flow = flow

    def evaluate(self, radii, pressure):
        """Return layers, residual and tangent (below, diagonal, above)."""
        force, diagonal = [0.0] * len(radii), [0.0] * len(radii)
        below, above, layers = [], [], []
        for k, (stress, plastic) in enumerate(self.layers):
            mean, thick = 0.5 * (radii[k] + radii[k + 1]), radii[k + 1] - radii[k]
            before = 0.5 * (self.radii[k] + self.radii[k + 1]), self.radii[k + 1] - self.radii[k]
            strain = math.log(mean / before[0]), math.log(thick / before[1])
            stress, plastic, c = update(stress, plastic, *strain, law=lambda _: (self.flow, 0.0))
            layers.append((stress, plastic))
            for a, side in enumerate((-1, 1)):
                force[k + a] += 0.5 * stress[0] * thick + side * stress[1] * mean
            # Derivatives: change of the stresses (hoop, radial), and of thickness and mean radius.
            slope = [[(c[i][0] / 2 / mean + side * c[i][1] / thick) for side in (-1, 1)] for i in range(2)]
            part = [[0.5 * slope[0][b] * thick + 0.5 * stress[0] * (-1, 1)[b]
                     + (-1, 1)[a] * (slope[1][b] * mean + 0.5 * stress[1]) for b in range(2)] for a in range(2)]
            diagonal[k] += part[0][0]
            diagonal[k + 1] += part[1][1]
            above.append(part[0][1])
            below.append(part[1][0])
        force[0] -= pressure * radii[0]
        diagonal[0] -= pressure
        return layers, force, (below, diagonal, above)

    def load(self, pressure):
        """Find the equilibrium under a pressure."""
        radii = self.radii
        for _ in range(40):
            layers, force, matrix = self.evaluate(radii, pressure)
            step = solve_tridiagonal(*matrix, [-f for f in force])
            radii = [r + s for r, s in zip(radii, step)]
            if max(map(abs, step)) < 1e-13 * radii[0]:
                break
        self.radii, self.layers = radii, layers


def displacements(inner, outer, flow, pressures):
    """Return the displacement of the rim at increasing pressures."""
    cylinder, result, last = Cylinder(inner, outer, flow), [], 0.0
    for pressure in pressures:
        for step in range(1, STEPS + 1):
            cylinder.load(last + (pressure - last) * step / STEPS)
        last = pressure
        result.append(cylinder.radii[-1] - outer)
    return result


if __name__ == "__main__":
    for factor in (0.01, 1.0):
        print(factor, displacements(100.0, 200.0, 240.0 * factor, [factor * p for p in (139.207433, 172.987565,
                                                                                        189.219391)]))
