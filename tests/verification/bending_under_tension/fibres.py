#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Work of bending and unbending of a strip under tension in plane strain, by fibres through its thickness.

Von Mises, Swift, backward Euler. The curvature k of the middle rises from 0 to 1/R and returns to 0; the stretch s of
the middle follows from the tension T. By constant volume a fibre at the initial height z is stretched by l = s + k z
and is dz/l thick. The stress across it follows from radial equilibrium: it rises from nothing at the outer face to the
pressure T/R of the tool at the inner one, which takes a part of the yield stress. A section that runs over a tool
without friction increases the force by the work E in it: the balance of energy per unit of initial length is
d(s T) = dE. With friction, T grows at constant curvature, by exp(mu angle R_inner/R), between bending and unbending.
"""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "strip_bending"))
from ring import THICKNESS, update

FIBRES, STEPS = 40, 60
SIZE = THICKNESS / FIBRES
HEIGHTS = [THICKNESS * ((i + 0.5) / FIBRES - 0.5) for i in range(FIBRES)]


def fibre(stress, plastic, along, radial):
    """Return stress, plastic strain, slope and strain across of a fibre after a strain increment along it, with a given
    stress across it."""
    across = -along
    for _ in range(50):
        new, strain, tangent = update(stress, plastic, along, across)
        if abs(new[1] - radial) < 1e-8:
            break
        across -= (new[1] - radial) / tangent[1][1]
    return new, strain, tangent[0][0] - tangent[0][1] * tangent[1][0] / tangent[1][1], across


def radial_stresses(fibres, old, stretch, curvature):
    """Return the stresses across the fibres, from equilibrium with those along them."""
    found, total = [0.0] * FIBRES, 0.0
    for i in reversed(range(FIBRES)):
        rise = (fibres[i][0][0] - old[i]) * stretch * curvature / (stretch + HEIGHTS[i] * curvature)**2 * SIZE
        found[i], total = -(total + 0.5 * rise), total + rise
    return found


class Section:
    """A section of the strip: states of its fibres, stretch, curvature, tension and stresses across."""

    def __init__(self, tension):
        self.states, self.radial = [([0.0, 0.0, 0.0], 0.0)] * FIBRES, [0.0] * FIBRES
        self.stretch, self.curvature, self.tension = 1.0, 0.0, tension

    def work(self, fibres, along):
        """Return the work in a step per unit of initial length."""
        return SIZE * sum(0.5 * ((new[0] + old[0]) * strain + (new[1] + old[1]) * across)
                          for (new, _, _, across), (old, _), strain in zip(fibres, self.states, along))

    def step(self, curvature, tension=None):
        """Go to a curvature, under a given tension or that of the balance of energy."""
        before, old, start = self.stretch, self.curvature, self.tension
        for _ in range(100):
            lengths = [self.stretch + z * curvature for z in HEIGHTS]
            along = [math.log(now / (before + z * old)) for now, z in zip(lengths, HEIGHTS)]
            fibres = [fibre(*state, strain, radial) for state, strain, radial in zip(self.states, along, self.radial)]
            error = SIZE * sum(f[0][0] / now for f, now in zip(fibres, lengths)) - self.tension
            force = (before * start + self.work(fibres, along)) / self.stretch if tension is None else tension
            radial = radial_stresses(fibres, self.radial, self.stretch, curvature)
            change = max(abs(a - b) for a, b in zip(radial, self.radial))
            if max(abs(error), abs(force - self.tension), change) < 1e-7:
                break
            self.stretch -= error / (SIZE * sum(f[2] / now**2 for f, now in zip(fibres, lengths)))
            self.tension, self.radial = force, radial
        self.states, self.curvature = [(stress, plastic) for stress, plastic, _, _ in fibres], curvature


def bend_and_unbend(tension, radius, growth=1.0):
    """Return the force, N/mm, and the stretch after bending to a radius of the middle, growth of the force by friction
    by a factor, and unbending."""
    section = Section(0.0)
    for i in range(1, STEPS + 1):
        section.step(0.0, tension * i / STEPS)
    for i in range(1, STEPS + 1):
        section.step(i / STEPS / radius)
    start = section.tension
    for i in range(1, STEPS + 1 if growth > 1 else 1):
        section.step(1 / radius, start * growth**(i / STEPS))
    for i in reversed(range(STEPS)):
        section.step(i / STEPS / radius)
    return section.tension, section.stretch


if __name__ == "__main__":
    for factor in (1.0, math.exp(0.144 * math.pi / 2 * 5 / 5.39)):
        print(bend_and_unbend(60.0, 5.39, factor))
