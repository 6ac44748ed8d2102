#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Print the expected values of the case: a bar stretched at two speeds, by its equations, independently of the program.

    bar.py power >power.csv

The ends of a bar of 10 mm part at a constant speed v: the rate of the logarithmic strain is v/l. Its true stress is
E (strain - p), and Swift's flow stress times the factor of the law of the rate, whose inverse is the rate of p. scipy's
Radau method integrates it.
"""
import sys

import numpy as np
from scipy.integrate import solve_ivp

YOUNG, POISSON, AREA, LENGTH = 2.06e5, 0.3, 100.0, 10.0
TABLE = (np.log([1e-5, 0.1, 10, 1e3]), [1, 1.03, 1.1, 1.3])
# Rates of the curves; plastic strains and flow stresses of each
CURVE_RATES = np.log([1e-5, 1, 1e3])
CURVES = (([0, 0.02, 0.05, 0.1, 0.2], [160, 225, 275, 320, 378]), ([0, 0.05, 0.2], [190, 295, 390]),
          ([0, 0.05, 0.2], [260, 345, 420]))


def swift(p):
    """Flow stress at rest."""
    return 565.32 * (0.007117 + p) ** 0.2589


def by_curves(factor, p):
    """Rate at which the curves have a factor over the first one."""
    factors = [np.interp(p, *curve) / np.interp(p, *CURVES[0]) for curve in CURVES]
    return np.exp(np.interp(factor, factors, CURVE_RATES)) if factor > 1 else 0.0


RATES = {  # of the factor and of the plastic strain
    "cowper_symonds": lambda factor, _: 40 * max(factor - 1, 0) ** 5,
    "curves": by_curves,
    "power": lambda factor, _: 1e-4 * (max(factor, 1) ** (1 / 0.015) - 1),
    "table": lambda factor, _: np.exp(np.interp(factor, TABLE[1], TABLE[0])) if factor > 1 else 0.0,
}


def main():
    """Integrate to 11 mm, slowly, then to 12 mm fast."""
    law = sys.argv[1]
    print(f"# Written by bar.py {law}\ntime,pulled_rx")
    p, start, passed = 0.0, LENGTH, 0.0
    for speed in (0.01, 1000.0):
        def stress(time, p, speed=speed, start=start):
            return YOUNG * (np.log((start + speed * time) / LENGTH) - p)

        def rate(time, state):
            return [RATES[law](stress(time, state[0]) / swift(state[0]), state[0])]

        elastic = start / speed * np.expm1(swift(0) / YOUNG) if p == 0 else 0.0
        solved = solve_ivp(rate, (elastic, 1 / speed), [p], "Radau", rtol=1e-10, atol=1e-14)
        p, start, passed = solved.y[0, -1], start + 1, passed + 1 / speed
        now = stress(1 / speed, p)
        area = AREA * np.exp(-p - 2 * POISSON * now / YOUNG)
        print(f"{passed:g},{now * area:.2f}", flush=True)
        print(f"{law}, {speed:g} mm/s: p {p:.6f}, rate {rate(1 / speed, [p])[0]:.5g}, stress {now:.3f} MPa, at rest "
              f"{swift(p):.3f} MPa", file=sys.stderr)


if __name__ == "__main__":
    main()
