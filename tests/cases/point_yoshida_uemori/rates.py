#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Print reference.csv: the rate equations of Yoshida and Uemori's law, integrated independently of the program.

    rates.py 2000 mises_cycles mises_sheared >reference.csv
    rates.py 2000 hill_cycles hill_crossed >../point_yoshida_uemori_hill/reference.csv

The number is that of the program's increments in each part of a path and determines the row numbers only; the values do
not depend on it.

The equations are those of docs/laws/yoshida_uemori.md as rates, with the elastic stiffness of the current plastic
strain. The stress rate of the continuum tangent is integrated by the Runge-Kutta method of eighth order (DOP853 of
scipy) with a relative tolerance of 1e-11. It is stopped and started anew where the point begins to flow and where the
centre of the bounding surface meets or leaves the stagnation surface. Nothing of the program is used.
"""
import math
import sys

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

POISSON = 0.3
SPCC = {"E": 2.06e5, "Y": 124, "B": 168, "C": 500, "m": 12, "b": 9, "Rsat": 190, "h": 0.5, "Ea": 2.06e5, "xi": 0}
SLOW = {"E": 2.0e5, "Y": 337, "B": 620, "C": 100, "m": 34, "b": 202, "Rsat": 190, "h": 0.772, "Ea": 2.0e5, "xi": 0}
CHORD = SLOW | {"Ea": 1.5e5, "xi": 60}
MISES, HILL = (0.5, 0.5, 0.5, 1.5), (0.284, 0.358, 0.642, 1.289)
# Paths: which of 11 22 33 23 31 12 are strains, and those of 11 and 12 at the end of each part.
CYCLES = ((1, 0, 0, 0, 0, 0), [(0.05, 0), (-0.03, 0), (0.08, 0)])
SHEARED = ((0, 0, 0, 0, 0, 1), [(0, 0.08), (0, -0.08), (0, 0.1)])
CROSSED = ((1, 0, 0, 0, 0, 1), [(0.05, 0), (0.05, 0.08)])
POINTS = {
    "mises_cycles": (SPCC, MISES, CYCLES),
    "mises_sheared": (SLOW, MISES, SHEARED),
    "hill_cycles": (CHORD, HILL, CYCLES),
    "hill_crossed": (SPCC, HILL, CROSSED),
}
ROWS = 10
SHEAR = math.sqrt(2)
DEVIATOR = np.eye(6)
DEVIATOR[:3, :3] -= 1 / 3


def hill(f, g, h, n):
    """Hill's quadratic form, all shears alike."""
    matrix = np.diag([g + h, f + h, f + g, n, n, n])
    matrix[0, 1] = matrix[1, 0] = -h
    matrix[0, 2] = matrix[2, 0] = -g
    matrix[1, 2] = matrix[2, 1] = -f
    return matrix


def mises(deviator):
    """Von Mises' norm."""
    return math.sqrt(1.5) * np.linalg.norm(deviator)


class Point:
    """A material point: stress, plastic strain, alpha, beta, q, r and R."""

    def __init__(self, law, form):
        self.law, self.form = law, form
        self.state = np.zeros(27)

    def stiffness(self, plastic_strain):
        """Hooke's law as a matrix of Kelvin's vectors."""
        law = self.law
        young = law["E"] - (law["E"] - law["Ea"]) * (1 - math.exp(-law["xi"] * plastic_strain))
        matrix = young / (1 + POISSON) * np.eye(6)
        matrix[:3, :3] += young * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
        return matrix

    def excess(self, state):
        """Equivalent stress less flow stress."""
        effective = state[:6] - state[7:13] - state[13:19]
        return math.sqrt(effective @ self.form @ effective) - self.law["Y"]

    def hardening(self, state, pushed):
        """Flow direction V, and the rates of the state per plastic strain, with or without isotropic hardening."""
        law = self.law
        stress, alpha, beta, centre, radius, growth = (state[:6], state[7:13], state[13:19], state[19:25], state[25],
                                                       state[26])
        effective = stress - alpha - beta
        equivalent = math.sqrt(effective @ self.form @ effective)
        normal = DEVIATOR @ effective / equivalent
        distance = law["B"] + growth - law["Y"]
        length = np.linalg.norm(alpha) / np.linalg.norm(normal)
        rates = np.zeros_like(state)
        rates[6] = 1
        rates[7:13] = law["C"] * distance * normal
        if length > 0:
            rates[7:13] -= law["C"] * math.sqrt(distance / length) * alpha
        rates[13:19] = law["m"] * (law["b"] * normal - beta)
        if pushed:
            outward = rates[13:19] if radius < 1e-9 else beta - centre
            outward = outward / mises(outward)
            speed = 1.5 * outward @ rates[13:19]
            rates[19:25] = (1 - law["h"]) * speed * outward
            rates[25] = law["h"] * speed
            rates[26] = law["m"] * (law["Rsat"] - growth)
        return self.form @ effective / equivalent, rates

    def rate(self, state, given, speed, plastic, pushed=False):
        """Rate of the state where the components `given` of the strain change with `speed`, other stresses stay."""
        tangent = elastic = self.stiffness(state[6])
        if plastic:
            v, rates = self.hardening(state, pushed)
            flow = elastic @ v
            modulus = v @ flow + v @ (rates[7:13] + rates[13:19])
            tangent = elastic - np.outer(flow, flow) / modulus
        matrix = tangent.copy()
        matrix[given] = np.eye(6)[given]
        strain = np.linalg.solve(matrix, np.where(given, speed, 0))
        rate = rates * (flow @ strain / modulus) if plastic else np.zeros_like(state)
        rate[:6] = tangent @ strain
        return rate

    def gap(self, state):
        """Distance of the centre of the bounding surface from the stagnation surface, negative inside."""
        return mises(state[13:19] - state[19:25]) - state[25]

    def outward(self, state, given, speed):
        """Rate of the distance of beta from the centre of the stagnation surface, not normed."""
        rate = self.rate(state, given, speed, True, True)
        return (state[13:19] - state[19:25]) @ rate[13:19]

    def go(self, given, change):
        """Follow a straight part of the path; yield the state for each row."""
        elastic = self.rate(self.state, given, change, False)
        time, ends = 0.0, [(i + 1) / ROWS for i in range(ROWS)]
        plastic = self.excess(self.state + 1e-7 * elastic) > 0
        if not plastic:
            time = brentq(lambda t: self.excess(self.state + t * elastic), 1e-9, 1)
            while ends and ends[0] <= time:
                yield self.state + ends.pop(0) * elastic
            self.state = self.state + time * elastic
        pushed = self.state[25] < 1e-9 or self.gap(self.state) > -1e-9 and self.outward(self.state, given, change) > 0
        while ends:
            def switch(_, state, pushed=pushed):
                return self.outward(state, given, change) if pushed else self.gap(state)
            switch.terminal, switch.direction = True, -1 if pushed else 1
            if pushed and self.state[25] < 1e-9:
                switch = None
            solved = solve_ivp(lambda t, y, pushed=pushed: self.rate(y, given, change, True, pushed),
                               (time, ends[0]), self.state, "DOP853", rtol=1e-11, atol=1e-10, events=switch)
            time, self.state = solved.t[-1], solved.y[:, -1]
            if solved.status == 1:
                pushed = not pushed
                continue
            ends.pop(0)
            yield self.state


def main():
    """Print the table."""
    increments = int(sys.argv[1])
    print("# Written by rates.py: the rate equations of the law, integrated independently.")
    print("point,increment,s11,s12,eqps,bounding_hardening")
    for name in sys.argv[2:]:
        law, form, (given, ends) = POINTS[name]
        point = Point(law, hill(*form))
        start, increment = (0.0, 0.0), 0
        for end in ends:
            change = np.zeros(6)
            change[0], change[5] = end[0] - start[0], SHEAR * (end[1] - start[1])
            for state in point.go(np.array(given, bool), change):
                increment += increments // ROWS
                print(f"{name},{increment},{state[0]:.5f},{state[5] / SHEAR:.5f},{state[6]:.10f},{state[26]:.5f}")
            start = end


if __name__ == "__main__":
    main()
