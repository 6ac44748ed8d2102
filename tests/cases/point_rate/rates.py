#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Print reference.csv: the rate equations of viscoplastic flow, integrated independently of the program.

    rates.py 2000 >reference.csv

The number is that of the program's increments in each part of a path and determines the row numbers only; the values do
not depend on it. The second half of each part in which the strain grows is compared: in the first, as in relaxation,
the error of the increments is larger, as the rate changes fast.

Tension and shear have one stress s, one strain e and one plastic strain p: s = M (e - f p), with the elastic modulus M
and f the strain per plastic strain. The equivalent stress is f s for tension (f = 1) and 2 f s for shear; over the
flow stress of the hardening law it is the factor, whose inverse function is the rate of p. scipy's Radau method
integrates it with a relative tolerance of 1e-11. Nothing of the program is used.
"""
import math
import sys

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline

YOUNG, POISSON, ROWS = 2.06e5, 0.3, 10
TABLE = (np.log([1e-3, 0.1, 10, 1e3]), np.array([1, 1.03, 1.1, 1.3]))
# Plastic strains and flow stresses of the curves at three rates
CURVE_RATES = np.log([1e-3, 1, 1e3])
CURVES = (([0, 0.02, 0.05, 0.1, 0.2], [160, 225, 275, 320, 378]), ([0, 0.05, 0.2], [190, 295, 390]),
          ([0, 0.05, 0.2], [260, 345, 420]))
SHEAR = math.sqrt(2 * 1.289) / 2  # of Hill's criterion with N = 1.289


def swift(p):
    """Flow stress of Swift's law."""
    return 565.32 * (0.007117 + p) ** 0.2589


def monotone(strain, stress):
    """Hermite's cubic through points by Fritsch and Carlson, region 3: the hardening law `table`."""
    secant = np.diff(stress) / np.diff(strain)
    slope = np.concatenate([secant[:1], (secant[1:] + secant[:-1]) / 2, secant[-1:]])
    for i, rise in enumerate(secant):
        slope[i:i + 2] *= min(1, 3 * rise / np.hypot(*slope[i:i + 2]))
    return CubicHermiteSpline(strain, stress, slope)


first_curve = monotone(*CURVES[0])


def rate_by_curves(factor, p):
    """Rate at which the curves, straight between their points, have a factor over the first one."""
    factors = [np.interp(p, *curve) / np.interp(p, *CURVES[0]) for curve in CURVES]
    return math.exp(np.interp(factor, factors, CURVE_RATES)) if factor > 1 else 0.0


RATES = {  # of the factor and of the plastic strain
    "cowper_symonds": lambda factor, _: 40 * max(factor - 1, 0) ** 5,
    "curves": rate_by_curves,
    "curves_of_swift": rate_by_curves,
    "johnson_cook": lambda factor, _: 1e-3 * math.exp(min((factor - 1) / 0.02, 100)) if factor > 1 else 0.0,
    "power": lambda factor, _: 1e-4 * (max(factor, 1) ** (1 / 0.015) - 1),
    "table": lambda factor, _: math.exp(np.interp(factor, TABLE[1], TABLE[0])) if factor > 1 else 0.0,
}
# Law, tension or shear, and strain and duration of each part
POINTS = {
    "cs_slow": ("cowper_symonds", "tension", [(0.1, 100)]),
    "cs_middle": ("cowper_symonds", "tension", [(0.1, 0.1)]),
    "cs_fast": ("cowper_symonds", "tension", [(0.1, 1e-4)]),
    "cs_jumps": ("cowper_symonds", "tension", [(0.05, 50), (0.1, 5e-5), (0.1, 1e-2), (0.2, 0.1)]),
    "cs_sheared": ("cowper_symonds", "shear", [(0.1, 1), (0.2, 1e-3)]),
    "power_jumps": ("power", "tension", [(0.05, 50), (0.1, 0.05), (0.1, 1), (0.2, 1e-4)]),
    "jc_jump": ("johnson_cook", "tension", [(0.05, 0.5), (0.1, 5e-5)]),
    "table_jump": ("table", "tension", [(0.05, 0.5), (0.1, 5e-3)]),
    "curves_jumps": ("curves", "tension", [(0.06, 6), (0.09, 3e-4), (0.09, 0.5), (0.18, 0.018)]),
    "curves_sheared": ("curves_of_swift", "shear", [(0.06, 0.03), (0.16, 1)]),
}


def follow(law, kind, parts):
    """Yield the number of the row, stress, plastic strain and its rate."""
    modulus, per_plastic, weight = (YOUNG, 1.0, 1.0)
    if kind == "shear":
        modulus, per_plastic, weight = YOUNG / (1 + POISSON), SHEAR, 2 * SHEAR
    strain, p = 0.0, 0.0
    at_rest = first_curve if law == "curves" else swift

    def rate(time, state):
        stress = modulus * (strain + (end - strain) * time / duration - per_plastic * state[0])
        return [RATES[law](weight * stress / at_rest(state[0]), state[0])]

    for part, (end, duration) in enumerate(parts):
        times = np.linspace(0, duration, ROWS + 1)
        start = 0.0
        if p == 0:  # elastic until the flow stress is reached
            start = at_rest(0) / weight / modulus / end * duration
        solved = solve_ivp(rate, (start, duration), [p], "Radau", rtol=1e-11, atol=1e-15, dense_output=True)
        for i, time in enumerate(times[1:], start=1):
            now = solved.sol(time)[0]
            if 2 * i >= ROWS and end > strain:
                stress = modulus * (strain + (end - strain) * time / duration - per_plastic * now)
                yield part * ROWS + i, stress, now, rate(time, [now])[0]
        strain, p = end, solved.y[0, -1]


def main():
    """Print the table."""
    step = int(sys.argv[1]) // ROWS
    print("# Written by rates.py: the rate equations, integrated independently.")
    print("point,increment,s11,s12,eqps,plastic_strain_rate")
    for name, (law, kind, parts) in POINTS.items():
        for row, stress, p, speed in follow(law, kind, parts):
            normal, shear = (stress, 0.0) if kind == "tension" else (0.0, stress)
            print(f"{name},{row * step},{normal:.6f},{shear:.6f},{p:.11f},{speed:.8g}")


if __name__ == "__main__":
    main()
