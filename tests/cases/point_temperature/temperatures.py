#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Print reference.csv: adiabatic paths by their rate equations, integrated independently of the program.

    temperatures.py 40000 >reference.csv

The number is that of the program's increments in each part of a path and determines the row numbers only. The second
half of each part is compared, as in point_rate.

Tension and shear have one stress s, one strain e and one plastic strain p: s = M (e - f p), with the elastic modulus M
and f the strain per plastic strain, whose sign is that of the flow. The equivalent stress is f s for tension and 2 f s
for shear. It is Swift's flow stress times the factor of the temperature T, and in tension by von Mises a back-stress X
more, dX = c (Xs - X) dp, or Prager's, k dp; dT = 0.9 (equivalent stress) dp/(density heat capacity). Without a law of
the rate dT/dp is integrated over p, and p found from the strain; with
Cowper and Symonds' law the rates of p and T are integrated over the time. scipy's Radau method, relative tolerance
1e-11. Nothing of the program is used.
"""
import math
import sys

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

YOUNG, POISSON, ROWS = 2.06e5, 0.3, 10
HEATING = 0.9 / (7.85e-9 * 4.6e8)
SHEAR = math.sqrt(2 * 1.289) / 2  # of Hill's criterion with N = 1.289
EXACT = {"method": "Radau", "rtol": 1e-11, "atol": 1e-13, "dense_output": True}
FACTORS = {
    "johnson_cook": lambda temperature: 1 - ((temperature - 20) / 480) ** 0.8,
    "table": lambda temperature: np.interp(temperature, [20, 60, 100], [1, 0.95, 0.8]),
}
# Back-stress in tension at the end of a plastic increment, from that at its start and the sign of the flow
BACK = {
    "table_prager": lambda start, sign, dp: start + sign * 800 * dp,
    "table_chaboche": lambda start, sign, dp: sign * 150 + (start - sign * 150) * math.exp(-8 * dp),
}
# Law, tension or shear, whether with Cowper and Symonds' law, and strain and duration of each part
POINTS = {
    "jc_reversed": ("johnson_cook", "tension", False, [(0.15, 1), (-0.05, 1)]),
    "jc_jumps": ("johnson_cook", "tension", True, [(0.1, 10), (0.2, 1e-3)]),
    "table_sheared": ("table", "shear", False, [(0.1, 1), (0.3, 1)]),
    "table_prager": ("table", "tension", False, [(0.15, 1), (0.3, 1)]),
    "table_chaboche": ("table", "tension", False, [(0.1, 1), (0.0, 1)]),
    "table_jumps": ("table", "tension", True, [(0.15, 10), (0.3, 1e-3)]),
}


def swift(p):
    """Flow stress at rest and at the reference temperature."""
    return 565.32 * (0.007117 + p) ** 0.2589


class Path:
    """A point: its moduli, and stress, strain, plastic strain and temperature so far."""

    def __init__(self, law, kind, back):
        """Start at 40 degrees."""
        self.factor, self.back, self.back_stress = FACTORS[law], back, 0.0
        self.modulus, self.per_plastic, self.weight = YOUNG, 1.0, 1.0
        if kind == "shear":
            self.modulus, self.per_plastic, self.weight = YOUNG / (1 + POISSON), SHEAR, 2 * SHEAR
        self.stress, self.strain, self.p, self.temperature = 0.0, 0.0, 0.0, 40.0

    def flow_stress(self, p, temperature):
        """Return the equivalent stress at rest, without the back-stress."""
        return swift(p) * self.factor(temperature)

    def at_rest(self, end):
        """Follow a part without a law of the rate; yield stress, plastic strain and temperature."""
        sign, stress, strain, start = math.copysign(1, end - self.strain), self.stress, self.strain, self.p
        first = self.back_stress

        def along(p, temperature):
            return self.flow_stress(p, temperature) + sign * self.back(first, sign, p - start)

        heated = solve_ivp(lambda p, t: [HEATING * along(p, t[0])], (start, start + 1), [self.temperature], **EXACT).sol

        def excess(p, now):
            elastic = sign * (stress + self.modulus * (now - strain - sign * self.per_plastic * (p - start)))
            return self.weight * elastic - along(p, heated(p)[0])

        for now in np.linspace(strain, end, ROWS + 1)[1:]:
            p = brentq(excess, start, start + abs(end - strain) / self.per_plastic, (now,), xtol=1e-14, rtol=1e-14)
            self.p, self.temperature = p, heated(p)[0]
            self.stress = sign * along(p, self.temperature) / self.weight
            yield self.stress, p, self.temperature
        self.strain, self.back_stress = end, self.back(first, sign, self.p - start)

    def by_rate(self, end, duration):
        """Follow a part with Cowper and Symonds' law; yield the same."""
        strain, start = self.strain, 0.0

        def stress(time, p):
            return self.modulus * (strain + (end - strain) * time / duration - self.per_plastic * p)

        def rates(time, state):
            over = self.weight * stress(time, state[0]) / self.flow_stress(*state) - 1
            rate = 40 * max(over, 0) ** 5
            return [rate, HEATING * self.weight * stress(time, state[0]) * rate]

        if self.p == 0:  # elastic until the flow stress is reached
            start = self.flow_stress(0, 40) / self.weight / self.modulus / end * duration
        solved = solve_ivp(rates, (start, duration), [self.p, self.temperature], **EXACT)
        for time in np.linspace(0, duration, ROWS + 1)[1:]:
            p, temperature = solved.sol(time)
            yield stress(time, p), p, temperature
        self.strain, (self.p, self.temperature) = end, solved.y[:, -1]


def main():
    """Print the table."""
    step = int(sys.argv[1]) // ROWS
    print("# Written by temperatures.py: the rate equations, integrated independently.")
    print("point,increment,s11,s12,eqps,temperature")
    for name, (law, kind, viscous, parts) in POINTS.items():
        path = Path(law, kind, BACK.get(name, lambda start, sign, dp: start))
        for part, (end, duration) in enumerate(parts):
            rows = path.by_rate(end, duration) if viscous else path.at_rest(end)
            for row, (stress, p, temperature) in enumerate(rows, start=1):
                normal, shear = (stress, 0.0) if kind == "tension" else (0.0, stress)
                if 2 * row >= ROWS:
                    print(f"{name},{(part * ROWS + row) * step},{normal:.6f},{shear:.6f},{p:.11f},{temperature:.8f}")


if __name__ == "__main__":
    main()
