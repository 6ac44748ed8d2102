#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Print the expected values of the case: an adiabatic bar, by its equations, independently of the program.

The true stress is E (strain - p), and Swift's flow stress times factors of the rate of p and of the temperature T;
dT = 0.9 stress dp/(density heat capacity). scipy's Radau method integrates p and T.
"""
import numpy as np
from scipy.integrate import solve_ivp

YOUNG, POISSON, AREA, LENGTH = 2.06e5, 0.3, 100.0, 10.0
HEATING = 0.9 / (7.85e-9 * 4.6e8)


FACTORS = {
    "table": lambda temperature: np.interp(temperature, [20, 60, 100], [1, 0.95, 0.8]),
    "johnson_cook": lambda temperature: 1 - ((temperature - 20) / 480) ** 0.8,
}


def swift(p):
    """Flow stress at the reference rate and temperature."""
    return 565.32 * (0.007117 + p) ** 0.2589


def stress(time, p):
    """True stress at 3 mm/s."""
    return YOUNG * (np.log1p(3 * time / LENGTH) - p)


def main():
    """Integrate to 13 mm."""
    for name, factor_of in FACTORS.items():
        def rates(time, state, factor_of=factor_of):
            p, temperature = state
            factor = stress(time, p) / (swift(p) * factor_of(temperature))
            rate = 1e-3 * np.exp(min((factor - 1) / 0.02, 100)) if factor > 1 else 0.0
            return [rate, HEATING * stress(time, p) * rate]

        start = LENGTH / 3 * np.expm1(swift(0) * factor_of(40) / YOUNG)
        p, temperature = solve_ivp(rates, (start, 1), [0, 40], "Radau", rtol=1e-9, atol=1e-13).y[:, -1]
        now = stress(1, p)
        force = now * AREA * np.exp(-p - 2 * POISSON * now / YOUNG)
        print(f"{name}: p {p:.6f}, temperature {temperature:.4f}, stress {now:.3f} MPa, force {force:.2f} N; "
              f"factor {factor_of(temperature):.4f}, {factor_of(40):.4f} at the start")


if __name__ == "__main__":
    main()
