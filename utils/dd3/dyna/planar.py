# SPDX-License-Identifier: GPL-3.0-or-later
"""Tension at an angle to the rolling direction by yield criteria of plane stress."""
from collections.abc import Callable

import numpy as np

STEP = 1e-6  # of a difference
Plane = Callable[[np.ndarray], np.ndarray]  # equivalent stress by s11, s22, s12 (..., 3)


def tension(equivalent: Callable[[np.ndarray], float], angle: float) -> tuple[float, float]:
    """Return yield stress over flow stress and r-value in tension at an angle to rolling; `equivalent` is the stress of
    a criterion of degree 1 by s11, s22, s12."""
    c, s = np.cos(angle), np.sin(angle)
    stress = np.array([c * c, s * s, c * s])
    with np.errstate(all="ignore"):
        flow = np.array([(equivalent(stress + STEP * e) - equivalent(stress - STEP * e)) / (2 * STEP)
                         for e in np.eye(3)])
        across = flow[0] * s * s + flow[1] * c * c - flow[2] * s * c
        return float(1 / np.float64(equivalent(stress))), float(across / -(flow[0] + flow[1]))


def barlat89_at(values: tuple[float, float, float, float], exponent: float, angle: float) -> tuple[float, float]:
    """Return yield stress over flow stress and r-value of the criterion with a, c, h, p in tension at an angle.

    a |K1 + K2|^m + a |K1 - K2|^m + c |2 K2|^m = 2 Y^m, K1 = (s11 + h s22)/2, K2^2 = (s11 - h s22)^2/4 + p^2 s12^2.
    Source: Barlat, Lian, Int. J. Plasticity 5 (1989) 51-66.
    """
    a, c, h, p = values

    def equivalent(s: np.ndarray) -> float:
        k1, k2 = (s[0] + h * s[1]) / 2, np.hypot((s[0] - h * s[1]) / 2, p * s[2])
        return float(np.float64((a * (abs(k1 + k2)**exponent + abs(k1 - k2)**exponent) + c * abs(2 * k2)**exponent) / 2)
                     ** (1 / exponent))

    return tension(equivalent, angle)


def yld2000(alpha: np.ndarray, exponent: float) -> Plane:
    """Return the equivalent stress of Yld2000-2d with eight coefficients.

    Source: Barlat et al., Int. J. Plasticity 19 (2003) 1297-1319.
    """
    a = np.asarray(alpha, float)
    first = np.array([[2 * a[0], -a[0], 0], [-a[1], 2 * a[1], 0], [0, 0, 3 * a[6]]]) / 3
    second = np.array([[-2 * a[2] + 2 * a[3] + 8 * a[4] - 2 * a[5], a[2] - 4 * a[3] - 4 * a[4] + 4 * a[5], 0],
                       [4 * a[2] - 4 * a[3] - 4 * a[4] + a[5], -2 * a[2] + 8 * a[3] + 2 * a[4] - 2 * a[5], 0],
                       [0, 0, 9 * a[7]]]) / 9

    def principal(s: np.ndarray, rule: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x = s @ rule.T
        middle, radius = (x[..., 0] + x[..., 1]) / 2, np.hypot((x[..., 0] - x[..., 1]) / 2, x[..., 2])
        return middle + radius, middle - radius

    def equivalent(s: np.ndarray) -> np.ndarray:
        (p1, p2), (q1, q2) = principal(s, first), principal(s, second)
        parts = np.abs(np.stack([p1 - p2, 2 * q2 + q1, 2 * q1 + q2]))
        size = parts.max(axis=0)
        return np.asarray(size * (((parts / np.where(size > 0, size, 1))**exponent).sum(axis=0) / 2)**(1 / exponent))
    return equivalent
