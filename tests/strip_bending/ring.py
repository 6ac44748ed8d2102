#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Plane-strain bending of a strip to a radius, with springback, integrated through the thickness.

    ring.py [RADIUS ...]

The strip becomes a ring: its layer at the height Z before bending lies at the radius r(Z). With L0/R the angle of a
piece of the length L0, the stretches are r/R along the strip, dr/dZ across it and 1 in the width. r(Z) is found from
the equilibrium of a chain of layers, radial stress included; both faces are free, hence no axial force. Material:
Hencky elasticity, von Mises, Swift's law, backward Euler along the path.
"""
import math
import sys

YOUNG, POISSON, THICKNESS = 2.1e5, 0.3, 0.78
SWIFT_K, SWIFT_E0, SWIFT_N = 565.0, 0.007117, 0.259
SHEAR, BULK = YOUNG / 2 / (1 + POISSON), YOUNG / 3 / (1 - 2 * POISSON)
LAYERS, STEPS = 120, 40


def flow_stress(plastic):
    """Return flow stress and slope of Swift's law."""
    value = SWIFT_K * (SWIFT_E0 + plastic) ** SWIFT_N
    return value, SWIFT_N * value / (SWIFT_E0 + plastic)


def update(stress, plastic, along, across, law=flow_stress):
    """Return stress (along, across, width), plastic strain and tangent after strain increments along and across.

    `law` gives the flow stress and its slope.
    """
    volume, mean = along + across, sum(stress) / 3
    trial = [s - mean + 2 * SHEAR * (e - volume / 3) for s, e in zip(stress, (along, across, 0.0))]
    size = math.sqrt(1.5 * sum(s * s for s in trial))
    increment, slope = 0.0, 0.0
    active = size > law(plastic)[0]
    while active:
        flow, slope = law(plastic + increment)
        change = (size - 3 * SHEAR * increment - flow) / (3 * SHEAR + slope)
        increment += change
        if abs(change) < 1e-15:
            break
    factor = 1 - 3 * SHEAR * increment / size if active else 1.0
    extra = 9 * SHEAR ** 2 * (1 / (3 * SHEAR + slope) - increment / size) / size ** 2 if active else 0.0
    tangent = [[BULK + 2 * SHEAR * factor * ((i == j) - 1 / 3) - extra * trial[i] * trial[j] for j in range(2)]
               for i in range(2)]
    return [factor * s + mean + BULK * volume for s in trial], plastic + increment, tangent


def solve_tridiagonal(below, diagonal, above, right):
    """Return the solution of a system with three diagonals."""
    size = len(diagonal)
    diagonal, right = diagonal[:], right[:]
    for i in range(1, size):
        factor = below[i - 1] / diagonal[i - 1]
        diagonal[i] -= factor * above[i - 1]
        right[i] -= factor * right[i - 1]
    for i in reversed(range(size)):
        right[i] = (right[i] - (above[i] * right[i + 1] if i + 1 < size else 0.0)) / diagonal[i]
    return right


class Ring:
    """The strip: radii between the layers, and stress, plastic strain and stretches of the layers."""

    def __init__(self):
        self.size = THICKNESS / LAYERS
        self.angle = 1e-9
        self.radii = [1 / self.angle + self.size * i - THICKNESS / 2 for i in range(LAYERS + 1)]
        self.layers = [([0.0, 0.0, 0.0], 0.0, (1.0, 1.0))] * LAYERS

    def evaluate(self, radii, angle):
        """Return the layers, nominal forces on the radii with their derivatives, and the moment, per unit width."""
        force, diagonal, off = [0.0] * len(radii), [0.0] * len(radii), [0.0] * LAYERS
        layers, moment = [], 0.0
        for k, (stress, plastic, before) in enumerate(self.layers):
            now = (0.5 * (radii[k] + radii[k + 1]) * angle, (radii[k + 1] - radii[k]) / self.size)
            stress, plastic, tangent = update(stress, plastic, *(math.log(a / b) for a, b in zip(now, before)))
            layers.append((stress, plastic, now))
            nominal = (stress[0] * now[1], stress[1] * now[0])
            slope = [[tangent[i][j] * now[1 - i] / now[j] + (stress[i] if i != j else 0.0) for j in range(2)]
                     for i in range(2)]
            arms = [(0.5 * angle, side / self.size) for side in (-1, 1)]
            for a in range(2):
                force[k + a] += self.size * sum(nominal[i] * arms[a][i] for i in range(2))
            product = [[self.size * sum(arms[a][i] * slope[i][j] * arms[b][j] for i in range(2) for j in range(2))
                        for b in range(2)] for a in range(2)]
            diagonal[k] += product[0][0]
            diagonal[k + 1] += product[1][1]
            off[k] += product[0][1]
            moment += nominal[0] * 0.5 * (radii[k] + radii[k + 1]) * self.size
        return layers, force, (off, diagonal, off), moment

    def solve(self, angle):
        """Return radii, layers and moment at an angle per unit length."""
        radii = [r + 1 / angle - 1 / self.angle for r in self.radii]
        for _ in range(50):
            layers, force, matrix, moment = self.evaluate(radii, angle)
            step = solve_tridiagonal(*matrix, [-f for f in force])
            radii = [r + s for r, s in zip(radii, step)]
            if max(map(abs, step)) < 1e-9 * THICKNESS:
                break
        return radii, layers, moment

    def bend(self, angle):
        """Bend to an angle per unit length and return the moment per unit width."""
        self.radii, self.layers, moment = self.solve(angle)
        self.angle = angle
        return moment

    def release(self):
        """Return the radius at which the moment vanishes."""
        angles = [self.angle]
        moments = [self.solve(self.angle)[2]]
        angles.append(self.angle - moments[0] * 12 * (1 - POISSON ** 2) / YOUNG / THICKNESS ** 3)
        while abs(moments[-1]) > 1e-9 * moments[0] and len(angles) < 10:
            moments.append(self.solve(angles[-1])[2])
            angles.append(angles[-1] - moments[-1] * (angles[-1] - angles[-2]) / (moments[-1] - moments[-2]))
        return 1 / angles[-1]


def bend_to(radius, steps=STEPS):
    """Bend to a radius; return the ring and angle per unit length, moment, inner and outer radius after each step."""
    ring, path = Ring(), []
    for k in range(1, steps + 1):
        moment = ring.bend(k / steps / radius)
        path.append((ring.angle, moment, ring.radii[0], ring.radii[-1]))
    return ring, path


if __name__ == "__main__":
    for given in [float(word) for word in sys.argv[1:]] or [10.0, 50.0, 100.0]:
        bent, history = bend_to(given)
        print(f"R = {given:g} mm: moment {history[-1][1]:.4g} N, radius after release {bent.release():.5g} mm, "
              f"thickness {history[-1][3] - history[-1][2]:.5g} mm")
