#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Print the expected values of the case: a bar on a path that bends, by its equations, independently of the program.

    bar.py >reference.csv

Hooke's law of the rates of logarithmic strain, von Mises's criterion, Swift's hardening; the bar is free across in the
first phase, and of constant width in the second. The root of the damage of exponent 2 grows by dp over the strain to
fracture, bilinear in the normalised Lode angle and the triaxiality. scipy's DOP853 integrates stress, plastic strain,
strains across and that root. The damage is printed beside the table.
"""
import sys

import numpy as np
from scipy.integrate import solve_ivp

YOUNG, POISSON, AREA, LENGTH = 2.06e5, 0.3, 100.0, 10.0
SHEAR, LAME = YOUNG / 2 / (1 + POISSON), YOUNG * POISSON / (1 + POISSON) / (1 - 2 * POISSON)
STIFFNESS = 2 * SHEAR * np.eye(3) + LAME
LODE = [-1, 0.2, 1]
BLOCKS = (([0, 0.5], [0.52, 0.36]), ([0, 0.4, 0.7], [0.28, 0.24, 0.16]), ([0, 0.2, 0.6], [0.48, 0.4, 0.28]))


def flow_stress(p):
    """Swift's law."""
    return 565.32 * (0.007117 + p) ** 0.2589


def strain_to_fracture(stress):
    """Strain to fracture of principal stresses."""
    mean, deviator = stress.mean(), stress - stress.mean()
    equivalent = np.sqrt(1.5 * deviator @ deviator)
    lode = 1 - 2 / np.pi * np.arccos(np.clip(13.5 * (deviator / equivalent).prod(), -1, 1))
    return np.interp(lode, LODE, [np.interp(mean / equivalent, *block) for block in BLOCKS])


def rates(state, prescribed, free):
    """Rates of three stresses, plastic strain, root of the damage and three strains; x at rate 1, `free` unstressed."""
    stress, p = state[:3], state[3]
    deviator = stress - stress.mean()
    equivalent = np.sqrt(1.5 * deviator @ deviator)
    tangent, growth = STIFFNESS, np.zeros(3)
    if equivalent > flow_stress(p) * (1 - 1e-6):
        normal = 1.5 * deviator / equivalent
        growth = STIFFNESS @ normal
        growth /= normal @ growth + 0.2589 * flow_stress(p) / (0.007117 + p)
        tangent = STIFFNESS - np.outer(STIFFNESS @ normal, growth)
    strain = np.array(prescribed, dtype=float)
    strain[free] = np.linalg.solve(tangent[np.ix_(free, free)], -(tangent @ strain)[free])
    speed = max(0.0, growth @ strain)
    damage = speed / strain_to_fracture(stress) if speed else 0.0
    return np.concatenate([tangent @ strain, [speed, damage], strain])


def main():
    """Stretch to 11 mm freely, then to 12.5 mm at constant width."""
    elastic = flow_stress(0) / YOUNG
    state = np.array([flow_stress(0), 0, 0, 0, 0, elastic, -POISSON * elastic, -POISSON * elastic])
    print("# Written by bar.py\nphase,progress,pulled_rx")
    for phase, end, free in (("free", 11.0, [1, 2]), ("held", 12.5, [2])):
        span = (state[5], np.log(end / LENGTH))
        state = solve_ivp(lambda _, now, free=free: rates(now, [1, 0, 0], free), span, state, "DOP853", rtol=1e-10,
                          atol=1e-12, max_step=1e-3).y[:, -1]
        print(f"{phase},1,{state[0] * AREA * np.exp(state[6] + state[7]):.3f}")
        print(f"{phase}: p {state[3]:.6f}, stresses {state[:3].round(3)}, flow stress {flow_stress(state[3]):.3f} MPa, "
              f"damage {state[4] ** 2:.6f}", file=sys.stderr)


if __name__ == "__main__":
    main()
