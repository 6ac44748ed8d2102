# SPDX-License-Identifier: GPL-3.0-or-later
"""Elastic unloading of the bent strip, computed independently of the program: the source of the numbers in case.dat.

    dd3imp --set tolerance=1e-5 --output tight.out case.dat
    unloading.py tight.out

Reads the state at the end of the draw from fields.vtkhdf: positions x0, contact forces f0, stresses T0. Without tools
the strip is free, and it unloads elastically: its plastic strain does not change. So the displacement u solves

    f0 + f(x0 + u, T) - f(x0, T0) = 0,    T = R (T0 + C : ln U) R^T,

at all degrees of freedom without a support. f: internal forces of the 8-node brick with mean dilatation
(docs/theory.md, section 3); R U: polar decomposition of the mean-dilatation gradient; C: isotropic elasticity. Here U
comes from eigenvalues, the tangent from differences, and all contact forces go in one step; the program unloads in
increments, with its own kinematics and tangents. T0 at the integration points is interpolated from the nodes, then
changed by the least amount (norm over all components) that puts x0 in equilibrium with f0.

Result: arm_uz = -0.3896 mm, far_uz = -6.0882 mm (the height at the end of the draw). The program gives -0.3863 mm: the
stresses at the nodes are means over the elements that share them, and the correction is as large as they are. With the
tolerance of the case, 1e-2, the program gives -0.3852 mm.
"""

import sys

import numpy as np

from dd3.fields import Fields

YOUNG, POISSON = 2.1e5, 0.3
CORNERS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1],
                    [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]])
POINTS = CORNERS / np.sqrt(3)
COMPONENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))  # order of fields.vtkhdf
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
    """Assemble forces (24 per element) to a vector, or stiffnesses (24 x 24) to a matrix, of `count` nodes."""
    place = (3 * elements[..., None] + np.arange(3)).reshape(len(elements), 24)
    total = np.zeros((3 * count,) * (parts.ndim - 1))
    np.add.at(total, place if parts.ndim == 2 else (place[:, :, None], place[:, None, :]), parts)
    return total


def balanced(x, elements, stress, forces, free):
    """Return the stress changed by the least amount that balances the forces at the free degrees of freedom."""
    columns, count = [], len(x)
    for point in range(8):
        for i, j in COMPONENTS:
            unit = np.zeros_like(stress)
            unit[:, point, i, j] = unit[:, point, j, i] = 1
            parts = internal_forces(x[elements], unit).reshape(len(elements), 24)
            columns += [assemble(elements[[e]], parts[[e]], count)[free] for e in range(len(elements))]
    missing = (forces.ravel() - assemble(elements, internal_forces(x[elements], stress).reshape(-1, 24), count))[free]
    change = np.linalg.lstsq(np.array(columns).T, missing, rcond=None)[0].reshape(8, 6, len(elements))
    result = stress.copy()
    for k, (i, j) in enumerate(COMPONENTS):
        result[..., i, j] += change[:, k].T
        result[..., j, i] = result[..., i, j]
    return result


def unload(nodes, elements, stress0, contact, held):
    """Return the displacements of the nodes after all contact forces are gone."""
    x0, free = nodes[elements], np.flatnonzero(~held.ravel())

    def forces(x):
        return internal_forces(x, stress_after(x0, x, stress0)).reshape(len(elements), 24)

    def tangent(x, step=1e-6):
        moves = step * np.eye(24).reshape(24, 8, 3)
        return np.stack([(forces(x + move) - forces(x - move)) / (2 * step) for move in moves], axis=-1)

    stress0 = balanced(nodes, elements, stress0, contact, free)
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
    """Print the displacements that case.dat expects."""
    fields = Fields(sys.argv[1])
    first, drawn, last = 0, int(np.flatnonzero(fields.travel <= 5.0)[-1]), fields.count - 1
    initial, nodes = fields.points(first).astype(float), fields.points(drawn).astype(float)
    elements = fields.grid["Connectivity"][: 8 * int(fields.grid["NumberOfCells"][0])].reshape(-1, 8)
    at_nodes, stress = fields.values(drawn, "stress")[0].astype(float), np.zeros((len(elements), 8, 3, 3))
    for k, (i, j) in enumerate(COMPONENTS):
        stress[..., i, j] = stress[..., j, i] = at_nodes[elements, k] @ SHAPE.T
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
