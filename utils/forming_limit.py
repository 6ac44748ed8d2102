"""Forming limit curves and the zones of the forming limit diagram. Needs numpy.

Strains are logarithmic. The curve of Keeler and Brazier (1977) is an estimate for low-carbon steel from thickness and
hardening exponent: at plane strain the engineering strain (23.3 + 14.13 t) n/0.21 %, t in mm, n at most 0.21. Its left
branch is the line of constant thickness, major + minor = const; the slope of its right branch, 0.6, is a convention.
"""

import math
from pathlib import Path

import numpy as np

import results
from scripts import Problem

ZONES = ("no strain", "wrinkling", "safe", "marginal", "critical")
COLOURS = ("#d0d4d8", "#5b8fd6", "#55a868", "#f0c040", "#d64541")
LEAST_STRAIN = 0.01  # major strain below which a point is not judged
RIGHT_SLOPE = 0.6
LARGEST_N = 0.21  # of the correlation


class Curve:
    """Limit of the major strain over the minor strain, linear between points; beyond them the end lines go on."""

    def __init__(self, minor, major, label):
        self.minor, self.major, self.label = np.asarray(minor, float), np.asarray(major, float), label

    def limit(self, minor):
        """Return the largest major strain."""
        value = np.interp(minor, self.minor, self.major)
        for end, inner, beyond in ((0, 1, np.minimum), (-1, -2, np.maximum)):
            slope = (self.major[end] - self.major[inner]) / (self.minor[end] - self.minor[inner])
            value = value + slope * beyond(minor - self.minor[end], 0.0)
        return value

    def zones(self, major, minor, margin):
        """Return the zone of each point, an index of ZONES.

        Critical points are above the curve, marginal ones less than `margin` below it. Points with a major strain below
        that of pure shear, -minor, thicken: wrinkling.
        """
        limit = self.limit(minor)
        zone = np.full(np.shape(major), ZONES.index("safe"))
        zone[major < -minor] = ZONES.index("wrinkling")
        zone[np.maximum(np.abs(major), np.abs(minor)) < LEAST_STRAIN] = ZONES.index("no strain")
        zone[major > limit - margin] = ZONES.index("marginal")
        zone[major > limit] = ZONES.index("critical")
        return zone


def keeler_brazier(thickness, exponent):
    """Return the curve of Keeler and Brazier for a thickness (mm) and a hardening exponent."""
    plane = math.log(1 + (23.3 + 14.13 * thickness) / 100 * min(exponent, LARGEST_N) / LARGEST_N)
    return Curve([-0.5 * plane, 0.0, 0.4], [1.5 * plane, plane, plane + RIGHT_SLOPE * 0.4],
                 f"Keeler-Brazier, t = {thickness:.3g} mm, n = {exponent:.3g}")


def read_curve(path, engineering=False):
    """Read a measured curve: minor and major strain in each line, with blanks or a comma; # begins a comment."""
    points = []
    for number, line in enumerate(results.read_text(path).splitlines(), 1):
        words = line.partition("#")[0].replace(",", " ").split()
        if not words:
            continue
        try:
            minor, major = map(float, words)
        except ValueError:
            raise Problem(f"{path}:{number}: error: expected minor and major strain, got '{line.strip()}'") from None
        points.append((minor, major))
    if len(points) < 2:
        raise Problem(f"{path}: expected at least 2 points of the forming limit curve, got {len(points)}")
    minor, major = np.array(sorted(points)).T
    if (np.diff(minor) <= 0).any():
        raise Problem(f"{path}: a minor strain occurs twice")
    if max(np.abs(minor).max(), major.max()) > 2:
        raise Problem(f"{path}: strains above 2: give fractions, not per cent")
    if engineering:
        minor, major = np.log1p(minor), np.log1p(major)
    return Curve(minor, major, Path(path).stem)
