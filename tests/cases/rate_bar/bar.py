#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Print the expected values of the case: a bar stretched at two speeds, by its equations, independently of the program.

The ends of a bar of 10 mm part at a constant speed v: the rate of the logarithmic strain is v/l. Its true stress is
E (strain - p), and Swift's flow stress times the factor of Cowper and Symonds, whose inverse is the rate of p. scipy's
Radau method integrates it.
"""
import numpy as np
from scipy.integrate import solve_ivp

YOUNG, POISSON, AREA, LENGTH = 2.06e5, 0.3, 100.0, 10.0


def swift(p):
    """Flow stress at rest."""
    return 565.32 * (0.007117 + p) ** 0.2589


def main():
    """Integrate to 11 mm, slowly, then to 12 mm fast."""
    p, start = 0.0, LENGTH
    for speed in (0.01, 1000.0):
        def stress(time, p, speed=speed, start=start):
            return YOUNG * (np.log((start + speed * time) / LENGTH) - p)

        def rate(time, p):
            return 40 * np.maximum(stress(time, p) / swift(p) - 1, 0) ** 5

        solved = solve_ivp(rate, (0, 1 / speed), [p], "Radau", rtol=1e-10, atol=1e-14)
        p, start = solved.y[0, -1], start + 1
        now = stress(solved.t[-1], p)
        area = AREA * np.exp(-p - 2 * POISSON * now / YOUNG)
        print(f"{speed:g} mm/s: p {p:.6f}, rate {rate(solved.t[-1], p):.5g}, stress {now:.3f} MPa, "
              f"force {now * area:.2f} N")


if __name__ == "__main__":
    main()
