"""Elastic unloading of the bent strip, computed independently of the program: where the numbers of case.json come from.

    unloading.py springback.out

Takes from fields.vtkhdf the state at the end of the draw: positions x0, contact forces f0, stresses T0. Without tools the
strip is free, and it unloads elastically (the run gives no warning that the sheet yields). So the displacement u solves

    f0 + f(x0 + u, T0 + C : ln U) - f(x0, T0) = 0        at all degrees of freedom without a support,

f: internal forces of the 8-node brick with mean dilatation (docs/theory.md, section 3), C: isotropic elasticity, turned
with the rotation of the polar decomposition. Here U comes from eigenvalues, the tangent from differences of f, and all
forces go in one step; the program unloads in increments by its predictor and corrector. T0 at the integration points is
interpolated from the nodes, which matters in the geometric stiffness only.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "utils"))
import numpy as np  # noqa: E402
from fields import Fields  # noqa: E402

YOUNG, POISSON = 2.1e5, 0.3
CORNERS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1],
                    [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]])
POINTS = CORNERS / np.sqrt(3)
FACTORS = 1 + POINTS[:, None, :] * CORNERS[None]  # points, nodes, directions
SHAPE = FACTORS.prod(axis=2) / 8
SLOPE = np.stack([CORNERS[:, i] * FACTORS[..., (i + 1) % 3] * FACTORS[..., (i + 2) % 3] / 8 for i in range(3)], axis=-1)


def jacobians(x):
    """Return the gradients of the shape functions and the determinants at the points of elements at x."""
    jacobian = np.einsum("eai,paj->epij", x, SLOPE)
    return np.einsum("paj,epji->epai", SLOPE, np.linalg.inv(jacobian)), np.linalg.det(jacobian)


def stress_after(x0, x, stress0):
    """Return the stress after the step from x0 to x: T0 turned, plus the stress of the strain ln U of F."""
    slope0, volume0 = jacobians(x0)
    gradient = np.einsum("eai,epaj->epij", x, slope0)
    ratio = np.linalg.det(gradient)
    mean = jacobians(x)[1].sum(axis=1) / volume0.sum(axis=1)
    gradient = gradient * np.cbrt(mean[:, None] / ratio)[..., None, None]
    values, vectors = np.linalg.eigh(np.swapaxes(gradient, -1, -2) @ gradient)
    rotation = gradient @ (vectors / np.sqrt(values)[..., None, :]) @ np.swapaxes(vectors, -1, -2)
    strain = (vectors * (0.5 * np.log(values))[..., None, :]) @ np.swapaxes(vectors, -1, -2)
    shear = YOUNG / (2 * (1 + POISSON))
    trace = np.trace(strain, axis1=-2, axis2=-1)[..., None, None] * np.eye(3)
    stress = stress0 + 2 * shear * (strain + POISSON / (1 - 2 * POISSON) * trace)
    return rotation @ stress @ np.swapaxes(rotation, -1, -2)


def internal_forces(x, stress):
    """Return the forces at the nodes of each element."""
    slope, volume = jacobians(x)
    mean = (slope * volume[..., None, None]).sum(axis=1) / volume.sum(axis=1)[:, None, None]
    pressure = np.trace(stress, axis1=-2, axis2=-1) / 3
    deviator = stress - pressure[..., None, None] * np.eye(3)
    return np.einsum("ep,epij,epaj->eai", volume, deviator, slope) + np.einsum("ep,ep,eaj->eaj", volume, pressure, mean)


def assemble(elements, parts, count):
    """Return forces or stiffness (24 x 24 per element) of the elements as a vector or a matrix of the degrees of freedom."""
    place = (3 * elements[..., None] + np.arange(3)).reshape(len(elements), 24)
    total = np.zeros((3 * count,) * (parts.ndim - 1))
    np.add.at(total, place if parts.ndim == 2 else (place[:, :, None], place[:, None, :]), parts)
    return total


def unload(nodes, elements, stress0, contact, held):
    """Return the displacements of the nodes after all contact forces are gone."""
    x0, free = nodes[elements], np.flatnonzero(~held.ravel())

    def forces(x):
        return internal_forces(x, stress_after(x0, x, stress0)).reshape(len(elements), 24)

    def tangent(x, step=1e-6):
        moves = step * np.eye(24).reshape(24, 8, 3)
        return np.stack([(forces(x + move) - forces(x - move)) / (2 * step) for move in moves], axis=-1)

    start = contact.ravel() - assemble(elements, forces(x0), len(nodes))
    u = np.zeros(nodes.size)
    for _ in range(12):
        x = (nodes + u.reshape(-1, 3))[elements]
        residual = (start + assemble(elements, forces(x), len(nodes)))[free]
        print(f"largest residual {np.abs(residual).max():.1e} N")
        if np.abs(residual).max() < 1e-5:
            break
        u[free] -= np.linalg.solve(assemble(elements, tangent(x), len(nodes))[np.ix_(free, free)], residual)
    return u.reshape(-1, 3)


def main():
    """Print the displacements that case.json expects."""
    fields = Fields(sys.argv[1])
    first, drawn, last = 0, int(np.flatnonzero(fields.travel <= 5.0)[-1]), fields.count - 1
    initial, nodes = fields.points(first).astype(float), fields.points(drawn).astype(float)
    elements = fields.grid["Connectivity"][: 8 * int(fields.grid["NumberOfCells"][0])].reshape(-1, 8)
    xx, yy, zz, xy, yz, xz = fields.values(drawn, "stress")[0].astype(float).T
    stress = np.stack([np.stack(row, -1) for row in ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))], -2)[elements]
    stress = np.einsum("pa,eaij->epij", SHAPE, stress)
    corner, other = (int(np.argmin(np.linalg.norm(initial - place, axis=1))) for place in ([0, 0, 0], [0, 35, 0]))
    held = np.zeros(nodes.shape, bool)
    held[initial[:, 0] < 1e-6, 0] = held[corner, 1] = held[corner, 2] = held[other, 2] = True
    u = unload(nodes, elements, stress, fields.values(drawn, "contact_force")[0].astype(float), held)
    total, program = nodes + u - initial, fields.points(last) - initial
    arm = initial[:, 0] > 175 - 1e-6
    for name, chosen, axis in (("arm_ux", arm, 0), ("arm_uy", arm, 1), ("arm_uz", arm, 2), ("far_uy", [other], 1),
                               ("far_uz", [other], 2)):
        print(f"{name}: unloading {total[chosen, axis].mean():.6f}, program {program[chosen, axis].mean():.6f}, "
              f"before {(nodes - initial)[chosen, axis].mean():.6f}")


if __name__ == "__main__":
    main()
