# SPDX-License-Identifier: GPL-3.0-or-later
"""Springback of the bent strip, computed independently of the program: the source of the numbers in case.dat.

    dd3imp --set tolerance=1e-5 --output drawn.out draw.inc
    dd3imp --set tolerance=1e-5 --output free.out case.dat
    unloading.py drawn.out free.out

Reads positions x0 and stresses T0 of the integration points at the end of the draw from restart.h5. The contact forces
f0 = f(x0, T0) fall linearly; at the fraction s that is left the displacement u solves

    f(x, T) = s f0,    x = x0 + u,    T = R S(T_c + C : ln U) R^T,

at all degrees of freedom without a support; T_c: stress at the fraction before. f: internal forces of the 8-node brick
with mean dilatation (docs/theory.md, section 3); R U: polar decomposition of the mean-dilatation gradient since then;
C: isotropic elasticity; S: return to the yield surface of Hill 1948, backward Euler. Here U comes from eigenvalues, the
tangent from differences, and the stress of the return in closed form from the plastic strain; the program has its own
kinematics, return mapping, tangents and increments, and withdraws the tools.

Result: arm_uz = -0.3896 mm, far_uz = -6.0882 mm (the height at the end of the draw); no point yields.
"""

import sys
from pathlib import Path

import numpy as np

from dd3.sheet_state import read_state

YOUNG, POISSON = 2.1e5, 0.3
SHEAR = YOUNG / (2 * (1 + POISSON))
F, G, H, L, M, N = 0.284, 0.358, 0.642, 1.289, 1.289, 1.289
K, E0, EXPONENT = 565, 0.007117, 0.259  # Swift
HILL = np.zeros((6, 6))  # sigma : HILL : sigma is the square of the equivalent stress, in Kelvin vectors
HILL[:3, :3] = [[G + H, -H, -G], [-H, F + H, -F], [-G, -F, F + G]]
HILL[3:, 3:] = np.diag([L, M, N])
ELASTIC = 2 * SHEAR * np.eye(6)
ELASTIC[:3, :3] += YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
ROOT = np.sqrt(2)
ROUND_OFF = 1e-10  # of a plastic strain
STEPS = 11  # of the contact forces
CORNERS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1],
                    [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]])
POINTS = CORNERS / np.sqrt(3)
FACTORS = 1 + POINTS[:, None, :] * CORNERS[None]  # points, nodes, directions
SLOPE = np.stack([CORNERS[:, i] * FACTORS[..., (i + 1) % 3] * FACTORS[..., (i + 2) % 3] / 8 for i in range(3)], axis=-1)


def jacobians(x):
    """Return the gradients of the shape functions and the determinants at the points of elements at x."""
    jacobian = np.einsum("eai,paj->epij", x, SLOPE)
    return np.einsum("paj,epji->epai", SLOPE, np.linalg.inv(jacobian)), np.linalg.det(jacobian)


def returned(tensor, strain):
    """Return stresses in the axes of the material, (..., 3, 3), after the return from trial stresses at plastic strains."""
    trial = np.stack([tensor[..., 0, 0], tensor[..., 1, 1], tensor[..., 2, 2], ROOT * tensor[..., 1, 2],
                      ROOT * tensor[..., 2, 0], ROOT * tensor[..., 0, 1]], axis=-1)

    def overstress(increment):
        flow = K * (E0 + strain + increment) ** EXPONENT
        stress = np.linalg.solve(np.eye(6) + (increment / flow)[..., None, None] * (ELASTIC @ HILL), trial[..., None])[..., 0]
        return stress, np.sqrt(np.einsum("...i,ij,...j->...", stress, HILL, stress)) - flow

    increment, stress, excess = np.zeros_like(strain), trial, overstress(np.zeros_like(strain))[1]
    yields = excess > 0
    for _ in range(20):
        increment = np.where(yields, increment + excess / (3 * SHEAR), 0)
        stress, excess = overstress(increment)
    result = np.empty_like(tensor)
    for k, (i, j) in enumerate(((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))):
        result[..., i, j] = result[..., j, i] = stress[..., k] / (1 if k < 3 else ROOT)
    return result, increment


def stress_after(x0, x, drawn):
    """Return stress, increment of the plastic strain and axes of the material after the step from x0 to x."""
    slope0, volume0 = jacobians(x0)
    gradient = np.einsum("eai,epaj->epij", x, slope0)
    ratio = np.linalg.det(gradient)
    mean = jacobians(x)[1].sum(axis=1) / volume0.sum(axis=1)
    gradient = gradient * np.cbrt(mean[:, None] / ratio)[..., None, None]
    values, vectors = np.linalg.eigh(np.swapaxes(gradient, -1, -2) @ gradient)
    rotation = gradient @ (vectors / np.sqrt(values)[..., None, :]) @ np.swapaxes(vectors, -1, -2)
    strain = (vectors * (0.5 * np.log(values))[..., None, :]) @ np.swapaxes(vectors, -1, -2)
    trace = np.trace(strain, axis1=-2, axis2=-1)[..., None, None] * np.eye(3)
    trial = drawn.stress + 2 * SHEAR * (strain + POISSON / (1 - 2 * POISSON) * trace)
    stress, increment = returned(np.swapaxes(drawn.axes, -1, -2) @ trial @ drawn.axes, drawn.strain)
    turned = rotation @ drawn.axes
    return turned @ stress @ np.swapaxes(turned, -1, -2), increment, turned


def internal_forces(x, stress):
    """Return the forces at the nodes of each element."""
    slope, volume = jacobians(x)
    mean = (slope * volume[..., None, None]).sum(axis=1) / volume.sum(axis=1)[:, None, None]
    pressure = np.trace(stress, axis1=-2, axis2=-1) / 3
    deviator = stress - pressure[..., None, None] * np.eye(3)
    return np.einsum("ep,epij,epaj->eai", volume, deviator, slope) + np.einsum("ep,ep,eaj->eaj", volume, pressure, mean)


def assemble(elements, parts, count):
    """Assemble forces (24 per element) to a vector, or stiffnesses (24 x 24) to a matrix, of `count` nodes."""
    place = (3 * elements[..., None] + np.arange(3)).reshape(len(elements), 24)
    total = np.zeros((3 * count,) * (parts.ndim - 1))
    np.add.at(total, place if parts.ndim == 2 else (place[:, :, None], place[:, None, :]), parts)
    return total


def unload(drawn, held):
    """Change a drawn sheet to the free one; return the number of points that yield and the largest increment of the plastic
    strain."""
    elements, free, count = drawn.elements, np.flatnonzero(~held.ravel()), len(drawn.points)
    start, u, strain = drawn.points.copy(), np.zeros(drawn.points.size), drawn.strain.copy()

    def forces(x):
        return internal_forces(x, stress_after(drawn.points[elements], x, drawn)[0]).reshape(len(elements), 24)

    def tangent(x, step=1e-6):
        moves = step * np.eye(24).reshape(24, 8, 3)
        return np.stack([(forces(x + move) - forces(x - move)) / (2 * step) for move in moves], axis=-1)

    contact = assemble(elements, forces(start[elements]), count)
    contact[held.ravel()] = 0
    for left in np.linspace(1, 0, STEPS):
        for _ in range(12):
            x = (start + u.reshape(-1, 3))[elements]
            residual = (assemble(elements, forces(x), count) - left * contact)[free]
            if np.abs(residual).max() < 1e-5:
                break
            slope = assemble(elements, tangent(x), count)
            u[free] -= np.linalg.solve(slope[np.ix_(free, free)], residual)
        print(f"{left:.1e} of the contact forces: largest residual {np.abs(residual).max():.1e} N")
        drawn.stress, increment, drawn.axes = stress_after(drawn.points[elements], x, drawn)
        drawn.strain, drawn.points = drawn.strain + increment, start + u.reshape(-1, 3)
    return np.count_nonzero(drawn.strain - strain > ROUND_OFF), (drawn.strain - strain).max()


def main():
    """Print the displacements that case.dat expects."""
    drawn, free = (read_state(Path(folder), "hex8") for folder in sys.argv[1:])
    initial = drawn.initial
    corner, other = (int(np.argmin(np.linalg.norm(initial - place, axis=1))) for place in ([0, 0, 0], [0, 35, 0]))
    held = np.zeros(initial.shape, bool)
    held[initial[:, 0] < 1e-6, 0] = held[corner, 1] = held[corner, 2] = held[other, 2] = True
    yields, largest = unload(drawn, held)
    print(f"{yields} points yield, by {largest:.2e} at most")
    here, program, arm = drawn.points - initial, free.points - initial, initial[:, 0] > 175 - 1e-6
    for name, chosen, axis in (("arm_ux", arm, 0), ("arm_uy", arm, 1), ("arm_uz", arm, 2), ("far_uy", [other], 1),
                               ("far_uz", [other], 2)):
        print(f"{name}: {here[chosen, axis].mean():.6f}, program {program[chosen, axis].mean():.6f}")


if __name__ == "__main__":
    main()
