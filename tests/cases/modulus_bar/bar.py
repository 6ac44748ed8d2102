#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Print the expected values of the case: a bar of falling modulus, by its equations, independently of the program.

The true stress is Swift's flow stress, the strain rate is that of the plastic strain and dsigma/E(p), the lateral one
-dp/2 - nu dsigma/E(p), both logarithmic. The elastic energy is sigma^2/(2 E), to which the fall of E adds the integral
of sigma^2/2 d(1/E). Needs numpy only.
"""
import numpy as np

YOUNG, POISSON = 2.06e5, 0.3
AREA, LENGTH = 100.0, 10.0
# Young's modulus of a plastic strain, MPa
MODULI = {
    "chord": lambda p: 1.63e5 + (YOUNG - 1.63e5) * np.exp(-30.8 * p),
    "table": lambda p: np.interp(p, [0, 0.02, 0.06, 0.15], [YOUNG, 1.86e5, 1.7e5, 1.61e5]),
}


def main():
    """Print the values of each law."""
    for name, modulus in MODULI.items():
        print(name)
        stretch_and_unload(modulus)


def stretch_and_unload(modulus):
    """Integrate to a stretch of 1.1, then unload to 1.099."""
    p = np.linspace(0, 0.1, 2000001)
    stress = 565.32 * (0.007117 + p) ** 0.2589
    middle = modulus((p[1:] + p[:-1]) / 2)
    elastic = np.concatenate([[stress[0] / YOUNG], stress[0] / YOUNG + np.cumsum(np.diff(stress) / middle)])
    strain = elastic + p
    volume = AREA * LENGTH * np.exp((1 - 2 * POISSON) * elastic)
    mean = (stress[1:] + stress[:-1]) / 2
    added = np.cumsum(np.diff(1 / modulus(p)) * mean**2 / 2 * (volume[1:] + volume[:-1]) / 2)
    end = np.searchsorted(strain, np.log(1.1))
    young = modulus(p[end])
    print(f"p {p[end]:.6f}, E {young:.1f} MPa, modulus_energy {added[end]:.4f} mJ")
    for stretch in (1.1, 1.099):
        fall = np.log(stretch / 1.1)
        now = stress[end] + young * fall
        area = AREA * np.exp(-p[end] - 2 * POISSON * (elastic[end] + fall))
        energy = now**2 / (2 * young) * area * LENGTH * stretch
        print(f"stretch {stretch}: force {now * area:.3f} N, elastic energy {energy:.4f} mJ")


if __name__ == "__main__":
    main()
