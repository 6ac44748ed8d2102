#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Work of bending and unbending of a strip under tension in plane strain, by fibres through its thickness.

Fibres without stress through the thickness, von Mises, Swift, backward Euler. The curvature k rises from 0 to 1/R of
the middle and returns to 0; the stretch s of the middle follows from the force, the thickness is that of constant
volume: a fibre at the initial height z is stretched by s + k z. A section that runs over a tool without friction
increases the force by the work of the moment. Per unit of initial length, whose angle is s k, the balance of energy is
d(s T) = T ds + M d(s k), so s dT = M d(s k). With friction, T grows by exp(mu angle) between bending and unbending.
"""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "strip_bending"))
from ring import THICKNESS, update

FIBRES, STEPS = 40, 60


def fibre(stress, plastic, along):
    """Return stress, plastic strain and slope of a fibre after a strain increment, without stress across it."""
    across = -0.5 * along
    for _ in range(50):
        new, strain, tangent = update(stress, plastic, along, across)
        if abs(new[1]) < 1e-8:
            break
        across -= new[1] / tangent[1][1]
    return new, strain, tangent[0][0] - tangent[0][1] * tangent[1][0] / tangent[1][1]


def bend_and_unbend(tension, radius, growth=1.0):
    """Return the forces, N/mm, after bending to a radius of the middle and, with friction by a factor `growth`, after
    unbending; and the stretch."""
    states = [([0.0, 0.0, 0.0], 0.0)] * FIBRES
    heights = [THICKNESS * ((i + 0.5) / FIBRES - 0.5) for i in range(FIBRES)]
    stretch, curvature, moment, results = 1.0, 0.0, 0.0, []
    for target in (0.0, 1 / radius, 0.0):
        if results:
            tension *= growth if len(results) == 2 else 1.0
        start = curvature
        for step in range(1, STEPS + 1):
            before, old = stretch, curvature
            curvature = start + (target - start) * step / STEPS
            for _ in range(50):
                found = [fibre(*state, math.log((stretch + z * curvature) / (before + z * old)))
                         for state, z in zip(states, heights)]
                error = sum(stress[0] for stress, _, _ in found) * THICKNESS / FIBRES - tension * stretch
                if abs(error) < 1e-7:
                    break
                stretch -= error / (sum(slope for _, _, slope in found) * THICKNESS / FIBRES)
            states = [(stress, plastic) for stress, plastic, _ in found]
            last = moment
            moment = sum(stress[0] * z for (stress, _), z in zip(states, heights)) * THICKNESS / FIBRES / stretch**2
            tension += 0.5 * (moment + last) * (stretch * curvature - before * old) / stretch
        results.append(tension)
    return results[1:], stretch


if __name__ == "__main__":
    for factor in (1.0, math.exp(0.144 * math.pi / 2)):
        print(bend_and_unbend(60.0, 5.39, factor))
