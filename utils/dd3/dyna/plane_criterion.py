# SPDX-License-Identifier: GPL-3.0-or-later
"""Yield criteria in plane stress as those of LS-DYNA: Hill (1948) by r-values, and Yld2000-2d by coefficients.

A criterion of the laws' library is Hill's in plane stress if it agrees with that of its r-values everywhere, whatever
its name. For others the eight coefficients of Yld2000-2d follow from eight values of the criterion, yield stress and
r-value of tension at 0, 45 and 90 degrees and in equibiaxial tension, as of measured ones (Barlat et al., Int. J.
Plasticity 19 (2003) 1297-1319), and the rest is compared.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from dd3.dyna.planar import Plane, tension, yld2000
from dd3.laws import Material

SAME = 1e-7  # relative difference of equivalent stresses up to which two criteria are one
DIGITS = 9  # of r-values that follow from differences
ANGLES = np.arange(0, 91, 5)  # of tension, degrees


@dataclass(frozen=True)
class Quadratic:
    """Hill's criterion in plane stress: r-values, and the equivalent stress of unit tension along rolling."""

    r: tuple[float, float, float]
    scale: float


@dataclass(frozen=True)
class Eight:
    """Yld2000-2d: its coefficients and exponent; largest differences to the criterion that it stands for: yield stress
    of tension at angles (relative), over the plane of stresses (relative), r-value."""

    alpha: tuple[float, ...]
    exponent: float
    tension: float = 0.0
    locus: float = 0.0
    r: float = 0.0


def stresses() -> np.ndarray:
    """Return directions in the plane of stresses (n, 3), of both signs."""
    turn = np.radians(np.arange(0, 360, 10))
    return np.array([(np.cos(a), np.sin(a), shear) for a in turn for shear in (0.0, 0.3, 0.7, 1.5)] + [(0, 0, 1.0)])


def of_library(material: Material) -> Plane:
    """Return the equivalent stress of a material in plane stress."""
    def equivalent(s: np.ndarray) -> np.ndarray:
        s = np.asarray(s, float)
        found = [material.equivalent_stress(np.array([a, b, 0.0, c, 0.0, 0.0])) for a, b, c in s.reshape(-1, 3)]
        return np.array(found).reshape(s.shape[:-1])
    return equivalent


def hill(values: Quadratic) -> Plane:
    """Return Hill's equivalent stress in plane stress."""
    r0, r45, r90 = values.r
    g = 1 / (1 + r0)
    h, f = r0 * g, r0 * g / r90
    n = (f + g) * (r45 + 0.5)
    return lambda s: values.scale * np.sqrt(f * s[..., 1]**2 + g * s[..., 0]**2 + h * (s[..., 0] - s[..., 1])**2
                                            + 2 * n * s[..., 2]**2)


def r_and_stress(equivalent: Plane, degrees: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return yield stresses over the flow stress and r-values of tension at angles."""
    def one(s: np.ndarray) -> float:
        return float(equivalent(s))
    found = np.array([tension(one, float(np.radians(angle))) for angle in degrees])
    return found[:, 0], found[:, 1]


def eight_values(equivalent: Plane) -> np.ndarray:
    """Return yield stresses and r-values of tension at 0, 45 and 90 degrees, and in equibiaxial tension."""
    stress, r = r_and_stress(equivalent, np.array([0, 45, 90]))
    both, step = np.array([1.0, 1.0, 0.0]), 1e-6
    flow = [float(equivalent(both + step * e) - equivalent(both - step * e)) for e in np.eye(3)[:2]]
    return np.array([*stress, *r, 1 / float(equivalent(both)), flow[1] / flow[0]])


def quadratic(material: Material) -> Quadratic | None:
    """Return Hill's criterion if that of the material is this one in plane stress."""
    r = material.r_values([0, 45, 90])
    if not np.all(np.isfinite(r)) or r.min() <= 0:
        return None
    found = Quadratic((rounded(r[0]), rounded(r[45]), rounded(r[90])), 1 / float(material.yield_stresses([0])[0]))
    found = Quadratic(found.r, rounded(found.scale))
    there, here = of_library(material)(stresses()), hill(found)(stresses())
    return found if np.abs(here / there - 1).max() < SAME else None


def rounded(value: float) -> float:
    """Return a value that follows from differences without digits beyond their accuracy."""
    return float(f"{value:.{DIGITS}g}")


def nearest_yld2000(material: Material, exponents: tuple[float, ...]) -> Eight:
    """Return Yld2000-2d with the eight values of a material, of the exponent with which the plane of stresses differs
    least."""
    equivalent = of_library(material)
    wanted = eight_values(equivalent)
    found = []
    for exponent in exponents:
        fit = least_squares(lambda alpha, m=exponent: eight_values(yld2000(alpha, m)) / wanted - 1, np.ones(8),
                            xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=400)
        found.append(compared(equivalent, Eight(tuple(fit.x.tolist()), exponent)))
    return min(found, key=lambda one: one.locus)


def compared(equivalent: Plane, values: Eight) -> Eight:
    """Return Yld2000-2d with its differences to a criterion."""
    own = yld2000(np.array(values.alpha), values.exponent)
    (stress, r), (own_stress, own_r) = r_and_stress(equivalent, ANGLES), r_and_stress(own, ANGLES)
    locus = np.abs(equivalent(stresses()) / own(stresses()) - 1).max()
    return Eight(values.alpha, values.exponent, float(np.abs(own_stress / stress - 1).max()), float(locus),
                 float(np.abs(own_r - r).max()))
