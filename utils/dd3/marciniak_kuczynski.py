# SPDX-License-Identifier: GPL-3.0-or-later
"""Limit strains of a sheet by the analysis of Marciniak and Kuczynski, with the constitutive laws of the program.

Z. Marciniak, K. Kuczynski, Int. J. Mech. Sci. 9 (1967) 609-620; J. W. Hutchinson, K. W. Neale, Sheet necking II and
III, in: Mechanics of Sheet Metal Forming, Plenum (1978) 127-153 and 269-285.

A groove b, thinner by the ratio f0 and with the initial normal N in the plane, crosses a sheet a that is stretched
along a strain path. Both are in plane stress. With the deformation gradients F in the plane and the thickness h

    compatibility  F_b = F_a + q x N                      (the groove turns with the material)
    equilibrium    h_b s_b n = h_a s_a n,  n = F_a^-T N   (normal and shear force)

The thickness strain of the groove is prescribed in steps, so that the limit is no singular point; q, the strain along
the path and the thickness strain of the sheet are found by Newton's method with the consistent tangents. Strain
increments and rotation of the material axes of a zone are those of the polar decomposition of its step, as in the
program. The limit strain is reached when the groove thins RATIO times as fast as the sheet; the limit of a path is the
least over the angles of the groove. The error is of first order in the step where the path of the groove bends.

A law of the strain rate has the time of a step: that of the sheet's strain along the path at a constant rate, by the
increment of the step before. Otherwise, with a rate sensitivity m, the stress of the groove is multiplied by
(dp_b/dp_a)^m, p the equivalent plastic strain, from the step after the yield point.
"""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from dd3.errors import Problem
from dd3.forming_limit_curve import Curve
from dd3.laws import Material

RATIO = 10.0  # of the thickness strain increments of groove and sheet at the limit
STEP, FIRST, GROWTH = 0.002, 2e-4, 1.5  # of the groove's thickness strain: largest, first, over the one before
SMALLEST = 1e-6  # step below which there is no solution
LARGEST = 2.5  # strain along the path up to which a limit is sought
NEWTON, SOLVED = 25, 1e-8  # iterations; residual over the stress
SCAN, HALVINGS = 15.0, 4  # angles of the groove, degrees: steps of the search, refinements
LEFT, RIGHT, POINTS = -0.5, 1.0, 13  # ratios of minor and major strain of a curve, and their number
STRAIN_RATE = 0.1  # 1/s, of the major strain in the sheet
COARSE = 5.0  # steps of the search over those of the result
PLANE = [0, 1, 3, 2]  # 11 22 12 33 of 11 22 33 12 13 23
IN_PLANE = np.ix_(PLANE, PLANE)
STILL = np.zeros((2, 2))


def axes_at(angle: float) -> np.ndarray:
    """Return the matrix of the strains 11 22 12 33 in axes at an angle to the given ones; shear strains doubled. Its
    transpose gives the stresses in the given axes."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c * c, s * s, c * s, 0], [s * s, c * c, -c * s, 0], [-2 * c * s, 2 * c * s, c * c - s * s, 0],
                     [0, 0, 0, 1.0]])


class Zone:
    """A homogeneous part of the sheet: deformation gradient in the plane, thickness strain, the angle of its material
    axes, stress 11 22 12 33; a trial step is made permanent by `accept`."""

    def __init__(self, material: Material, angle: float) -> None:
        self.point = material.point()
        self.gradient, self.inverse, self.thickness, self.angle = np.eye(2), np.eye(2), 0.0, angle
        self.committed = (self.point.stress.copy(), self.point.state.copy())

    def attempt(self, gradient: np.ndarray, thickness: float, time: float = 0.0) -> bool:
        """Integrate the step to a deformation gradient and a thickness strain in a time; return False if it fails."""
        (a, b), (c, d) = (gradient @ self.inverse).tolist()
        turn = math.atan2(c - b, a + d)
        # The stretch U = R^T F, and its logarithm by eigenvalues.
        cosine, sine = math.cos(turn), math.sin(turn)
        u, v, w = cosine * a + sine * c, cosine * b + sine * d, cosine * d - sine * b
        mean, radius = (u + w) / 2, math.hypot((u - w) / 2, v)
        if mean <= radius:
            return False
        high, low = math.log(mean + radius), math.log(mean - radius)
        slope = (high - low) / (2 * radius) if radius > 1e-12 else 1 / mean
        middle = (high + low) / 2
        strain = axes_at(self.angle) @ (middle + slope * (u - mean), middle + slope * (w - mean), 2 * slope * v,
                                        thickness - self.thickness)
        point = self.point
        point.stress[:], point.state[:] = self.committed
        if not point.update((strain[0], strain[1], strain[3], strain[2], 0.0, 0.0), time):
            return False
        self.trial = gradient, thickness, self.angle + turn
        axes = axes_at(self.angle + turn)
        self.stress = axes.T @ point.stress[PLANE]
        self.tangent = axes.T @ point.tangent[IN_PLANE] @ axes
        self.plastic = float(point.state[0] - self.committed[1][0])
        self.work = float(point.stress[PLANE] @ strain)
        self.flows = self.plastic > 0 and self.committed[1][0] > 0  # not in the step of the yield point
        return True

    def accept(self) -> None:
        """Make the trial step permanent."""
        self.gradient, self.thickness, self.angle = self.trial
        self.inverse = inverse_of(self.gradient)
        self.committed = (self.point.stress.copy(), self.point.state.copy())

    def changes(self, gradients: np.ndarray, thicknesses: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the derivatives of the stress, a column for each, and of the equivalent plastic strain for derivatives
        of the deformation gradient and of the thickness strain. Those of the plastic strain neglect elastic strains."""
        rates = (gradients @ inverse_of(self.trial[0])).reshape(-1, 4).T
        strains = np.array([rates[0], rates[3], rates[1] + rates[2], thicknesses])
        s11, s22, s12, _ = self.stress.tolist()
        turning = np.array([-2 * s12, 2 * s12, s11 - s22, 0.0])
        stresses = self.tangent @ strains + np.outer(turning, (rates[2] - rates[1]) / 2)
        return stresses, self.stress @ strains * (self.plastic / self.work if self.work else 0.0)


def inverse_of(matrix: np.ndarray) -> np.ndarray:
    """Return the inverse of a matrix of two rows."""
    (a, b), (c, d) = matrix.tolist()
    size = a * d - b * c
    return np.array([[d / size, -b / size], [-c / size, a / size]])


class Path(NamedTuple):
    """A proportional strain path: minor over major strain. Its length is the major strain."""

    ratio: float


class Limit(NamedTuple):
    """Limit strains of a path, and the angles between the groove's normal and the major strain, degrees: at the start
    and at the limit."""

    major: float
    minor: float
    angle: float
    turned: float


class Groove:
    """The analysis of a groove of one angle, radians, along a path."""

    def __init__(self, sheet: "Sheet", path: Path, angle: float) -> None:
        self.sheet, self.path = sheet, path
        self.normal = np.array([math.cos(angle), math.sin(angle)])
        self.jumps = np.array([[self.normal, (0, 0)], [(0, 0), self.normal]])  # of the deformation gradient
        self.a, self.b = (Zone(sheet.material, -sheet.direction) for _ in range(2))
        self.found = np.zeros(4)  # q, length of the path, thickness strain of the sheet

    def solve(self, guess: np.ndarray, thickness: float, time: float = 0.0) -> bool:
        """Find the unknowns for a thickness strain of the groove; return False where Newton's method fails."""
        x = guess.copy()
        for _ in range(NEWTON):
            gradient = np.array([[math.exp(x[2]), 0.0], [0.0, math.exp(self.path.ratio * x[2])]])
            if not (self.a.attempt(gradient, x[3], time)
                    and self.b.attempt(gradient + x[:2, None] * self.normal, thickness, time)):
                return False
            residual, matrix = self.balance(gradient, np.array([[1.0], [self.path.ratio]]) * gradient)
            if np.abs(residual).max() <= SOLVED * max(np.abs(self.b.stress).max(), 1e-300):
                self.trial = x
                return True
            x = x - np.linalg.solve(matrix, residual)
            if not (np.abs(x) < 2 * LARGEST).all():
                return False
        return False

    def balance(self, gradient: np.ndarray, along: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the residual, both forces and both stresses through the thickness, and its derivatives; `along`: the
        derivative of the sheet's deformation gradient along the path."""
        a, b, rate = self.a, self.b, self.sheet.rate_sensitivity
        n = self.normal / gradient.diagonal()
        turning = -n * along.diagonal() / gradient.diagonal()
        thick_a, thick_b = math.exp(a.trial[1]), self.sheet.ratio * math.exp(b.trial[1])
        faster = rate > 0 and a.flows and b.flows
        if faster:
            thick_b *= (b.plastic / a.plastic) ** rate
        difference = thick_b * b.stress - thick_a * a.stress
        residual = np.array([*force(difference, n), a.stress[3], b.stress[3]])
        stress_a, plastic_a = a.changes(np.array([along, STILL]), np.array([0.0, 1.0]))
        stress_b, plastic_b = b.changes(np.array([*self.jumps, along]), np.zeros(3))
        stress_a[:, 1] += a.stress  # of the thickness
        change = np.zeros((4, 4))
        change[:, :3] = thick_b * stress_b
        change[:, 2:] -= thick_a * stress_a
        if faster:
            change[:, :3] += np.outer(thick_b * rate * b.stress, plastic_b / b.plastic)
            change[:, 2:] -= np.outer(thick_b * rate * b.stress, plastic_a / a.plastic)
        matrix = np.zeros((4, 4))
        matrix[:2] = force(change, n)
        matrix[:2, 2] += force(difference, turning)
        matrix[2, 2:], matrix[3, :3] = stress_a[3], stress_b[3]
        matrix[2, 3] -= a.stress[3]
        return residual, matrix

    def limit(self, ceiling: float, largest: float) -> float:
        """Return the length of the path at the limit, infinity if it is above a ceiling; largest: step."""
        step, slowness, middle = FIRST, 1.0, 0.0
        rates = np.array([0.0, 0.0, 1 / (1 + self.path.ratio), -1.0])
        while self.found[2] < ceiling:
            before, thickness = self.found, self.b.thickness
            time = step * abs(float(rates[2])) / self.sheet.strain_rate if self.sheet.material.has_rate else 0.0
            solved = self.solve(before + step * rates, thickness - step, time)
            # A sheet that thins faster than the groove is the other branch beyond a bifurcation.
            if not solved or before[3] - self.trial[3] >= step:
                step /= 4
                if step > SMALLEST:
                    continue
                if solved:  # the groove does not thin faster, such as one across a compression
                    return math.inf
                raise Problem(f"no equilibrium of the groove at {math.degrees(math.atan2(*self.normal[::-1])):.3g} "
                              f"degrees on the path {self.path.ratio:.3g} at the strain {before[2]:.4g}")
            self.a.accept()
            self.b.accept()
            self.found = self.trial
            rates = (self.found - before) / step
            # The slowness, thickness strain increments of the sheet over those of the groove, is that in mid-step.
            last, slowness, last_middle, middle = slowness, -rates[3], middle, (before[2] + self.found[2]) / 2
            if slowness < 1 / RATIO:
                return float(last_middle + (last - 1 / RATIO) / (last - slowness) * (middle - last_middle))
            step = min(GROWTH * step, largest)
        return math.inf


def force(stress: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Return the in-plane components of stress times normal."""
    return np.array([stress[0] * normal[0] + stress[2] * normal[1], stress[2] * normal[0] + stress[1] * normal[1]])


class Sheet:
    """A sheet of a material with a groove.

    ratio: of the initial thicknesses, f0; direction: of the major strain to the rolling direction, degrees;
    rate_sensitivity: the exponent m, of a material without a law of the strain rate; strain_rate: of the major strain,
    1/s, of one with it; step: the largest one of the groove's thickness strain.
    """

    def __init__(self, material: Material, ratio: float, direction: float = 0.0, rate_sensitivity: float = 0.0,
                 step: float = STEP, strain_rate: float = STRAIN_RATE) -> None:
        self.material, self.ratio, self.direction = material, ratio, math.radians(direction)
        if rate_sensitivity and material.has_rate:
            raise Problem(f"the material {material.name} has a law of the strain rate, and a rate sensitivity is "
                          "given; expected one of them")
        self.rate_sensitivity, self.step, self.strain_rate = rate_sensitivity, step, strain_rate
        self.symmetric = direction % 90 == 0

    def length_at(self, path: Path, angle: float, ceiling: float = LARGEST, coarser: float = 1.0) -> float:
        """Return the length of a path at the limit with a groove at an angle, degrees, infinity if it is above a
        ceiling; `coarser`: a factor of the step."""
        return Groove(self, path, math.radians(angle)).limit(ceiling, coarser * self.step)

    def limit(self, path: Path, near: float = 0.0) -> Limit | None:
        """Return the limit of a path, None where there is none up to LARGEST; `near`: an angle to begin with."""
        angles = np.arange(0.0 if self.symmetric else SCAN - 90, 90 + SCAN / 2, SCAN)
        best, least = math.nan, LARGEST
        for angle in sorted(angles, key=lambda angle: abs(angle - near)):
            length = self.length_at(path, angle, least, COARSE)
            if length < least:
                best, least = float(angle), length
        if not least < LARGEST:
            return None
        size, least = SCAN, self.length_at(path, best)
        for _ in range(HALVINGS):
            size /= 2
            for angle in (best - size, best + size):
                length = self.length_at(path, angle, least)
                if length < least:
                    best, least = angle, length
                    break
        minor = path.ratio * least
        turned = math.degrees(math.atan2(math.sin(math.radians(best)) * math.exp(-minor),
                                         math.cos(math.radians(best)) * math.exp(-least)))
        return Limit(least, minor, abs(best) if self.symmetric else best, abs(turned) if self.symmetric else turned)

    def curve(self, ratios: Sequence[float] | np.ndarray) -> list[Limit | None]:
        """Return the limits of paths, by their ratio of minor and major strain."""
        found: list[Limit | None] = []
        for ratio in ratios:
            last = found[-1] if found else None
            found.append(self.limit(Path(float(ratio)), last.angle if last else 0.0))
        return found


def ratios_of(points: int) -> np.ndarray:
    """Return ratios of minor and major strain, with that of plane strain."""
    left = max(1, round((points - 1) / 3))
    return np.concatenate([np.linspace(LEFT, 0, left + 1), np.linspace(0, RIGHT, points - left)[1:]])


def curve_of(limits: Sequence[Limit | None], label: str) -> tuple[Curve, list[Limit]]:
    """Return the curve of limits, of those whose minor strain increases, and these limits."""
    kept: list[Limit] = []
    for limit in limits:
        if limit and (not kept or limit.minor > kept[-1].minor):
            kept.append(limit)
    if len(kept) < 2:
        raise Problem(f"no localisation up to the strain {LARGEST:g} on {len(limits) - len(kept)} of {len(limits)} "
                      "paths")
    return Curve([limit.minor for limit in kept], [limit.major for limit in kept], label), kept


@lru_cache(maxsize=4)
def curve_of_text(text: str, name: str, ratio: float) -> Curve:
    """Return the curve of the material of the lines of a block, for a ratio f0; the major strain is along rolling."""
    sheet = Sheet(Material(f"*MATERIAL {name}\n{text}"), ratio)
    return curve_of(sheet.curve(ratios_of(POINTS)), f"{name}: Marciniak-Kuczynski, f0 = {ratio:g} (assumed)")[0]
