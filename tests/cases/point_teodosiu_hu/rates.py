#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Print reference.csv: the rate equations of Teodosiu and Hu's law, integrated independently of the program.

    rates.py >reference.csv
    rates.py 40 >../point_teodosiu_hu_coarse/reference.csv

The number is that of the program's increments in each part of a path and determines the row numbers only; the values do
not depend on it.

The equations are those of docs/laws/teodosiu_hu.md as rates, with the whole fourth-order tensor S and with h as
(1 - X:N/(Xsat n:N))/2, n = dev(T - X)/sb, limited to 0 to 1 (it is outside only if Xsat decreases; without the limit
the shear stress of latent_crossed is 0.02 MPa higher, the others do not change). The strain is additive, its elastic
part is Hooke's. The stress rate of the continuum tangent is integrated by the Runge-Kutta method of fourth order; the
elastic parts of a path are one step up to the yield surface; four times as many steps change no printed digit. Needs
numpy only; nothing of the program is used.
"""
import math
import sys

import numpy as np

YOUNG, POISSON = 2.1e5, 0.3
ORDINARY = {"Y0": 120, "CR": 28, "Rsat": 80, "CX": 200, "X0": 10, "Ssat": 240, "CSD": 4, "CSL": 1.5, "nL": 0.5,
            "CP": 2.2, "nP": 25, "f": 0.8, "r": 1}
LATENT = ORDINARY | {"CSL": 20, "nL": 1, "f": 0.5, "r": 5}
MISES, HILL = (0.5, 0.5, 0.5, 1.5), (0.284, 0.358, 0.642, 1.289)
# Paths: which of 11 22 33 23 31 12 are strains, and those of 11 and 12 at the end of each part.
TENSION = ((1, 0, 0, 0, 0, 0), [(0.2, 0)])
SHEARED = ((0, 0, 0, 0, 0, 1), [(0, 0.15)])
REVERSED = ((0, 0, 0, 0, 0, 1), [(0, 0.15), (0, -0.15)])
CROSSED = ((1, 0, 0, 0, 0, 1), [(0.1, 0), (0.1, 0.15)])
POINTS = {
    "mises_tension": (ORDINARY, MISES, TENSION),
    "mises_reversed": (ORDINARY, MISES, REVERSED),
    "mises_crossed": (ORDINARY, MISES, CROSSED),
    "hill_tension": (ORDINARY, HILL, TENSION),
    "hill_reversed": (ORDINARY, HILL, REVERSED),
    "hill_crossed": (ORDINARY, HILL, CROSSED),
    "latent_sheared": (LATENT, HILL, SHEARED),
    "latent_crossed": (LATENT, HILL, CROSSED),
}
# Rows for each part of a path, and steps from one to the next.
ROWS, STEPS = 10, 400
SHEAR = math.sqrt(2)
DEVIATOR = np.eye(6)
DEVIATOR[:3, :3] -= 1 / 3


def stiffness():
    """Hooke's law as a matrix of Kelvin's vectors."""
    matrix = YOUNG / (1 + POISSON) * np.eye(6)
    matrix[:3, :3] += YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    return matrix


def hill(f, g, h, n):
    """Hill's quadratic form, all shears alike."""
    matrix = np.diag([g + h, f + h, f + g, n, n, n])
    matrix[0, 1] = matrix[1, 0] = -h
    matrix[0, 2] = matrix[2, 0] = -g
    matrix[1, 2] = matrix[2, 1] = -f
    return matrix


class Point:
    """A material point: state vector of stress, plastic strain, R, P, X and S."""

    def __init__(self, law, form):
        self.law, self.form, self.elastic = law, form, stiffness()
        self.state = np.zeros(20 + 36)

    @staticmethod
    def split(state):
        """Stress, plastic strain, R, P, X, S."""
        return state[:6], state[6], state[7], state[8:14], state[14:20], state[20:].reshape(6, 6)

    def excess(self, state):
        """Equivalent stress less flow stress."""
        stress, _, r, _, back, structure = self.split(state)
        effective = stress - back
        flow = self.law["Y0"] + r + self.law["f"] * np.linalg.norm(structure)
        return math.sqrt(effective @ self.form @ effective) - flow

    def hardening(self, state):
        """Flow direction V, and the rates of R, P, X, S per plastic strain."""
        law = self.law
        stress, _, r, polarity, back, structure = self.split(state)
        effective = stress - back
        equivalent = math.sqrt(effective @ self.form @ effective)
        v = self.form @ effective / equivalent
        n = v / np.linalg.norm(v)
        normal = DEVIATOR @ effective / equivalent
        directed = n @ structure @ n
        latent = structure - directed * np.outer(n, n)
        whole = np.linalg.norm(structure)
        saturation = law["X0"] + (1 - law["f"]) * math.sqrt(law["r"] * whole**2 + (1 - law["r"]) * directed**2)
        release = min(1, max(0, 0.5 * (1 - back @ n / (saturation * (normal @ n)))))
        along = polarity @ n
        share = law["CP"] / (law["CSD"] + law["CP"])
        if along >= 0:
            growth = 1 - share * abs(directed / law["Ssat"] - along)
        else:
            growth = (1 + along) ** law["nP"] * (1 - share * directed / law["Ssat"])
        rates = np.zeros_like(state)
        rates[6] = 1
        rates[7] = law["CR"] * (law["Rsat"] - r)
        rates[8:14] = law["CP"] * (n - polarity)
        rates[14:20] = law["CX"] * (saturation * normal - back)
        formed = law["CSD"] * (growth * (law["Ssat"] - directed) - release * directed)
        decay = law["CSL"] * (np.linalg.norm(latent) / law["Ssat"]) ** law["nL"]
        rates[20:] = (formed * np.outer(n, n) - decay * latent).ravel()
        return v, rates

    def rate(self, state, given, speed, plastic):
        """Rate of the state where the components `given` of the strain change with `speed`, other stresses stay."""
        tangent = self.elastic
        if plastic:
            v, rates = self.hardening(state)
            structure = state[20:]
            slope = rates[7] + v @ rates[14:20]
            size = np.linalg.norm(structure)
            slope += self.law["f"] * (structure @ rates[20:] / size if size > 0 else np.linalg.norm(rates[20:]))
            flow = self.elastic @ v
            tangent = self.elastic - np.outer(flow, flow) / (v @ flow + slope)
        matrix = tangent.copy()
        matrix[given] = np.eye(6)[given]
        strain = np.linalg.solve(matrix, np.where(given, speed, 0))
        rates_of_state = np.zeros_like(state)
        if plastic:
            multiplier = flow @ strain / (v @ flow + slope)
            rates_of_state = multiplier * rates
        rates_of_state[:6] = tangent @ strain
        return rates_of_state

    def yield_at(self, rate, end):
        """How far along `rate` the yield surface is reached, at most to `end`."""
        low, high = 0.0, end
        if self.excess(self.state + high * rate) < 0:
            return end
        for _ in range(80):
            middle = (low + high) / 2
            low, high = (middle, high) if self.excess(self.state + middle * rate) < 0 else (low, middle)
        return low

    def go(self, given, change):
        """Follows a straight part of the path; yields the state for each row."""
        elastic = self.rate(self.state, given, change, False)
        plastic = self.excess(self.state + 1e-7 * elastic) > 0
        for _ in range(ROWS):
            left = 1 / ROWS
            if not plastic:
                part = self.yield_at(elastic, left)
                self.state = self.state + part * elastic
                left -= part
                plastic = left > 0
            for _ in range(STEPS if plastic else 0):
                step = left / STEPS
                one = self.rate(self.state, given, change, True)
                two = self.rate(self.state + step / 2 * one, given, change, True)
                three = self.rate(self.state + step / 2 * two, given, change, True)
                four = self.rate(self.state + step * three, given, change, True)
                self.state = self.state + step / 6 * (one + 2 * two + 2 * three + four)
            yield self.state


def main():
    """Print the table."""
    increments = int(sys.argv[1]) if len(sys.argv) > 1 else 400
    print("# Written by rates.py: the rate equations of the law, integrated independently.")
    print("point,increment,s11,s12,eqps")
    for name, (law, form, (given, ends)) in POINTS.items():
        point = Point(law, hill(*form))
        start, increment = (0.0, 0.0), 0
        for end in ends:
            change = np.zeros(6)
            change[0], change[5] = end[0] - start[0], SHEAR * (end[1] - start[1])
            for state in point.go(np.array(given, bool), change):
                increment += increments // ROWS
                print(f"{name},{increment},{state[0]:.4f},{state[5] / SHEAR:.4f},{state[6]:.7f}")
            start = end


if __name__ == "__main__":
    main()
