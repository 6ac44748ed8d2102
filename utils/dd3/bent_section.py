# SPDX-License-Identifier: GPL-3.0-or-later
"""A section of a sheet that is bent, unbent and pulled in plane strain, with the constitutive laws of the program.

The section is divided into layers. By constant volume, a layer at the initial height z has the stretch l, l^2 = s^2 +
2 s k z, with the stretch s and the curvature k of the middle. The stress across the layers follows from radial
equilibrium, from nothing at the convex face; the pressure of a tool is added, linear to the convex face.

In a steady flow the power that passes through a section is P v, v the speed of the middle, with P = T + k M of the
tension T and the moment M per width; P s is the sum of stress times initial thickness of the layers. Without friction P
changes by the work in the section, d(P s) = dW; in straight parts P is the tension.
"""

import math

import numpy as np

from dd3.errors import Problem
from dd3.laws import Material

ACROSS = np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
NEWTON, SOLVED = 30, 1e-9  # iterations of a layer; residual over the stress
ITERATIONS, BALANCED = 80, 1e-7  # of a section; residual over the stress
RENEWED = 20  # iterations after which the bounds of the stretch are renewed
LARGEST = 5e-3  # change of the stretch in an iteration
SMALLEST = 2.0**-8  # fraction of a step


def parts(steps: int) -> np.ndarray:
    """Return the parts of a bend before and after each step; the first steps are small, where the sheet yields."""
    return np.asarray(np.linspace(0.0, 1.0, steps + 1)**2)


class Layer:
    """A layer: committed stress and internal variables, and those of a trial step."""

    def __init__(self, material: Material, along: np.ndarray) -> None:
        self.point, self.direction = material.point(), along
        self.committed = self.point.stress.copy(), self.point.state.copy()
        self.before = 0.0, 0.0  # stresses along and across
        self.stress = self.radial = self.across = self.slope = self.strain = 0.0

    def attempt(self, strain: float, radial: float) -> bool:
        """Integrate over a strain increment along the strip to a stress across, MPa; return False if it fails."""
        point = self.point
        across = self.across if strain == self.strain else -strain
        for _ in range(NEWTON):
            point.stress[:], point.state[:] = self.committed
            if not point.update(strain * self.direction + across * ACROSS):
                return False
            excess = float(point.stress[2]) - radial
            if abs(excess) <= SOLVED * max(1.0, float(np.abs(point.stress).max())):
                break
            across -= excess / float(point.tangent[2, 2])
        else:
            return False
        self.strain, self.across = strain, across
        self.stress, self.radial = float(self.direction @ point.stress), float(point.stress[2])
        stiffness = point.tangent @ self.direction
        self.slope = float(self.direction @ stiffness - (self.direction @ point.tangent[:, 2]) * stiffness[2]
                           / point.tangent[2, 2])
        return True

    def work(self) -> float:
        """Return the work of the trial step per volume, MPa."""
        return ((self.stress + self.before[0]) * self.strain + (self.radial + self.before[1]) * self.across) / 2

    def accept(self) -> None:
        """Make the trial step permanent."""
        self.committed = self.point.stress.copy(), self.point.state.copy()
        self.before = self.stress, self.radial


class Section:
    """A section of a strip of a thickness, mm, at an angle to the rolling direction, degrees.

    stretch: of the middle; curvature: 1/mm; force: P, N/mm; moment: N.
    """

    def __init__(self, material: Material, thickness: float, layers: int = 16, direction: float = 0.0) -> None:
        c, s = math.cos(math.radians(direction)), math.sin(math.radians(direction))
        self.name, self.thickness, self.size = material.name, thickness, thickness / layers
        self.heights = self.size * (np.arange(layers) + 0.5) - thickness / 2
        self.layers = [Layer(material, np.array([c * c, s * s, 0, 2 * c * s, 0, 0])) for _ in range(layers)]
        self.lengths, self.radial = np.ones(layers), np.zeros(layers)
        self.stretch, self.curvature, self.force, self.moment = 1.0, 0.0, 0.0, 0.0
        self.pressure = 0.0  # of a tool on the concave face, MPa
        self.layers[0].attempt(0.0, 0.0)
        self.stiffness = self.layers[0].slope * thickness**3 / 12  # elastic, of bending, N mm

    @property
    def plastic(self) -> np.ndarray:
        """Return the equivalent plastic strains of the layers, from the lower face."""
        return np.array([layer.committed[1][0] for layer in self.layers])

    def bend(self, curvature: float, steps: int, pressure: float = 0.0, beyond: float = 0.0) -> np.ndarray:
        """Go to a curvature of the middle, 1/mm; the force follows from the work. pressure: of a tool on the concave
        face, MPa, from a curvature on, until the next bend. Return the moments before and after each step, N."""
        start, moments = self.curvature, [self.moment]
        for part in parts(steps)[1:]:
            at = start + (curvature - start) * float(part)
            self.pressure = pressure if abs(at) > beyond else 0.0
            self.go(at, None)
            moments.append(self.moment)
        return np.array(moments)

    def pull(self, force: float, steps: int) -> None:
        """Go to a force, N/mm, at constant curvature."""
        start = self.force
        for i in range(1, steps + 1):
            self.go(self.curvature, start + (force - start) * i / steps)

    def go(self, curvature: float, force: float | None) -> None:
        """Make a step, in parts where it does not converge."""
        from_curvature, from_force, done, part = self.curvature, self.force, 0.0, 1.0
        while done < 1 - 1e-12:
            part = min(part, 1 - done)
            at = done + part
            if self.attempt(from_curvature + at * (curvature - from_curvature),
                            None if force is None else from_force + at * (force - from_force)):
                done = at
            elif part < SMALLEST:
                raise Problem(f"{self.name}: no equilibrium of the strip at the force {self.force:.4g} N/mm, the "
                              f"curvature {self.curvature:.3g} /mm and the thickness strain "
                              f"{-math.log(self.stretch):.3g}: it necks")
            else:
                part /= 2

    def attempt(self, curvature: float, force: float | None) -> bool:
        """Make a step; return False, without a change, if it fails."""
        stretch, radial, low, high = self.stretch, self.radial, -math.inf, math.inf
        for iteration in range(ITERATIONS):
            lengths = np.sqrt(np.maximum(stretch**2 + 2 * curvature * stretch * self.heights, 1e-6))
            strains = np.log(lengths / self.lengths)
            if not all(layer.attempt(*step) for layer, *step in zip(self.layers, strains.tolist(), radial.tolist())):
                return False
            stress = np.array([layer.stress for layer in self.layers])
            total = self.size * stress.sum()
            work = self.size * sum(layer.work() for layer in self.layers)
            wanted = self.stretch * self.force + work if force is None else stretch * force
            rates = (stretch + curvature * self.heights) / lengths**2  # of the strains by the stretch
            slope = self.size * float(rates @ [layer.slope for layer in self.layers])
            slope -= self.size * float(rates @ stress) if force is None else force
            balanced = self.equilibrium(stress - radial, lengths, stretch, curvature)
            scale = max(1.0, float(np.abs(stress).max()))
            if abs(total - wanted) <= BALANCED * scale * self.thickness and \
                    np.abs(balanced - radial).max() <= BALANCED * 100 * scale:
                break
            radial = balanced
            if iteration % RENEWED == 0:  # the bounds move with the stresses across
                low, high = -math.inf, math.inf
            low, high = (stretch, high) if wanted > total else (low, stretch)
            stretch += max(-LARGEST, min(LARGEST, (wanted - total) / slope))
            if math.isfinite(high - low) and not low < stretch < high:
                stretch = (low + high) / 2
        else:
            return False
        for layer in self.layers:
            layer.accept()
        self.stretch, self.curvature, self.lengths, self.radial = stretch, curvature, lengths, radial
        self.force = float(wanted / stretch)
        self.moment = self.size * float((stress / lengths) @ (2 * self.heights / (lengths + stretch)))
        return True

    def equilibrium(self, difference: np.ndarray, lengths: np.ndarray, stretch: float, curvature: float) -> np.ndarray:
        """Return the stresses across the layers, MPa; `difference`: of the stresses along and across."""
        rises = difference * abs(curvature) * stretch / lengths**2 * self.size
        outside = rises[::-1] if curvature > 0 else rises
        stresses = -(np.cumsum(outside) - outside / 2)
        concave = 0.5 - math.copysign(1.0, curvature) * self.heights / self.thickness
        return np.asarray(stresses[::-1] if curvature > 0 else stresses) - self.pressure * concave
