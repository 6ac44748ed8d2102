#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "laws_one_element", "labels": ["case", "debug"],
#:  "arguments": ["--library", "$<$<TARGET_EXISTS:dd3laws>:$<TARGET_FILE:dd3laws>>"]}
"""One element in tension, shear and cyclic loads: forces of the program, and by the library of the laws.

    tests/laws/one_element.py --program build/release/dd3imp --library build/release/libdd3laws.so --work /tmp/laws
"""

import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from calls import Material, Umat, called
from cases import CASES, SIZE, TWO_SURFACES, Case, deck, displacements

from dd3.programs import launch
from dd3.tables import read_table

# Largest difference of a force, relative to the largest of its direction.
TOLERANCE = 1e-6


def run_program(program, case, folder):
    """Return the forces on x_max and y_max along x and y after each step."""
    file = folder / f"{case.name.replace(' ', '_')}.dat"
    file.write_text(deck(case), encoding="utf-8")
    result = file.with_suffix(".out")
    done = launch([program, "--quiet", "--output", result, file])
    assert done.code == 0, done.output + done.errors
    rows = read_table(result / "history.csv")
    names = ("x_rx", "x_ry", "y_rx", "y_ry")
    return np.array([[float(row[name]) for name in names] for row in rows])


def free_strain(update, strain, free):
    """Find the strains of free directions by Newton's method; leave the point at the end of the step."""
    stress, state = update.stress.copy(), update.state.copy()
    for _ in range(60):
        update.stress[:], update.state[:] = stress, state
        update.update(strain)
        residual = update.stress[free]
        if np.linalg.norm(residual) < 1e-9:
            return strain
        strain[free] -= np.linalg.solve(update.tangent[np.ix_(free, free)], residual)
    raise AssertionError("no equilibrium")


def turned(vector, angle, shear):
    """Return components 11 22 33 12 13 23 in axes turned about 3; `shear` is the factor of the shear components."""
    a, b, c, d, e, f = vector
    tensor = np.array([[a, d / shear, e / shear], [d / shear, b, f / shear], [e / shear, f / shear, c]])
    cosine, sine = np.cos(angle), np.sin(angle)
    axes = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    t = axes.T @ tensor @ axes
    return np.array([t[0, 0], t[1, 1], t[2, 2], shear * t[0, 1], shear * t[0, 2], shear * t[1, 2]])


class Rotated:
    """A point whose strain and stress are in axes at an angle to those of the material."""

    def __init__(self, point, angle):
        """Keep the point and the angle in degrees."""
        self.point, self.angle, self.stress = point, np.radians(angle), np.zeros(6)
        self.state, self.tangent = point.state, np.zeros((6, 6))

    def update(self, strain):
        """Integrate over a strain increment."""
        self.point.stress[:] = turned(self.stress, self.angle, 1.0)
        self.point.update(turned(strain, self.angle, 2.0))
        self.stress[:] = turned(self.point.stress, -self.angle, 1.0)
        strains = np.array([turned(unit, self.angle, 2.0) for unit in np.eye(6)]).T
        stresses = np.array([turned(unit, -self.angle, 1.0) for unit in np.eye(6)]).T
        self.tangent = stresses @ self.point.tangent @ strains


def stretched(case, point):
    """Return the forces of a case without shear."""
    forces, before = [], None
    if isinstance(point, Material):  # UMAT turns the components itself
        point = Rotated(point, case.angle)
    prescribed = [{"x": 0, "y": 1}[face] for face, _ in case.motions]
    free = [i for i in range(3) if i not in prescribed]
    total, guess = np.zeros(3), np.zeros(6)
    for now in displacements(case):
        if before is not None:
            strain = guess.copy()
            strain[prescribed] = [np.log((SIZE + b) / (SIZE + a)) for a, b in zip(before, now)]
            strain = free_strain(point, strain, free)
            total += strain[:3]
        before = now
        area = SIZE**2 * np.exp(total.sum() - total)
        forces.append([point.stress[0] * area[0], 0, 0, point.stress[1] * area[1]])
    return np.array(forces)


def sheared(case, point):
    """Return the forces of simple shear: polar decomposition of each step, axes that turn with its rotation."""
    forces, before, angle = [], None, 0.0
    for (now,) in displacements(case):
        if before is not None:
            step = np.array([[1.0, (now - before) / SIZE], [0.0, 1.0]])
            values, vectors = np.linalg.eigh(step.T @ step)
            stretch = vectors @ np.diag(np.sqrt(values)) @ vectors.T
            logarithm = vectors @ np.diag(0.5 * np.log(values)) @ vectors.T
            rotation = step @ np.linalg.inv(stretch)
            strain = [logarithm[0, 0], logarithm[1, 1], 0, 2 * logarithm[0, 1], 0, 0]
            point.update(turned(strain, angle, 2.0))
            angle += np.arctan2(rotation[1, 0], rotation[0, 0])
        before = now
        stress = turned(point.stress, -angle, 1.0)
        forces.append([0, 0, SIZE**2 * stress[3], SIZE**2 * stress[1]])
    return np.array(forces)


def by_library(case, point):
    """Return the forces by the library."""
    return sheared(case, point) if case.sheared else stretched(case, point)


def difference(case, found, expected, normal=True):
    """Return the largest difference of a force that is led, over the largest of its direction.

    With `normal` also that of the normal force in simple shear.
    """
    columns = [["xx", "xy", "yx", "yy"].index(motion) for motion in case.motions]
    if case.sheared and normal:
        columns.append(3)
    assert found.shape == expected.shape, (found.shape, expected.shape)
    return max(np.abs(found - expected)[:, k].max() / np.abs(expected[:, k]).max() for k in columns)


def check_umat(library, folder):
    """Check plane strain, a failed step, the names of CalculiX and Abaqus, and the time of a law of the strain rate."""
    case = CASES[0]
    solid, plane = (Umat(library, case.material(), folder, name) for name in ("_SHEET", "SHEET"))
    solid.update([0.01, -0.004, 0, 0.002, 0, 0])
    plane.update([0.01, -0.004, 0, 0.002, 0, 0], shears=1)
    assert np.array_equal(solid.stress, plane.stress) and np.array_equal(solid.state, plane.state)
    assert np.array_equal(solid.tangent[:4, :4], plane.tangent[:4, :4]) and solid.smaller == 1.0
    stress = solid.stress.copy()
    solid.update([99.0, 0, 0, 0, 0, 0])
    assert np.array_equal(solid.stress, stress) and solid.smaller == 0.5
    rate = ("yield = von_mises", "hardening = perfect Y0=100", "rate = power m=0.1 reference=1")
    text = Case("rate", rate, (), ()).material().replace("*MATERIAL sheet", "*MATERIAL rate")
    viscous = Umat(library, text, folder, "RATE")
    for time in (1e-3, 1e-4):
        before = viscous.state[0]
        viscous.update([0, 0, 0, 0.02, 0, 0], time=time)
        expected = 100 * (1 + (viscous.state[0] - before) / time)**0.1
        assert abs(np.sqrt(3) * viscous.stress[3] / expected - 1) < 1e-8, (time, viscous.stress[3], expected)


def check_threads(library):
    """Let threads make materials and follow a path at the same time, each with its own and all with one material."""
    case, common = CASES[3], Material(library, CASES[3].material())

    def follow(_):
        point = Material(library, case.material())
        found = [by_library(case, point)]
        point.handle, point.stress, point.state = common.handle, np.zeros(6), np.zeros_like(point.state)
        return [*found, by_library(case, point)]

    with ThreadPoolExecutor(4) as pool:
        results = [forces for both in pool.map(follow, range(8)) for forces in both]
    assert all(np.array_equal(forces, results[0]) for forces in results)


def main():
    """Run and compare all cases."""
    failed = False
    with called(__doc__) as (program, library, folder):
        check_umat(library, folder)
        check_threads(library)
        for case in (*CASES, TWO_SURFACES):
            expected = run_program(program, case, folder)
            found = {"library": by_library(case, Material(library, case.material()))}
            # A material keeps its name, hence one more name for each case.
            umat_name = case.name.replace(" ", "_").upper()
            text = case.material().replace("*MATERIAL sheet", f"*MATERIAL {umat_name.lower()}")
            found["umat"] = by_library(case, Umat(library, text, folder, umat_name))
            for what, forces in found.items():
                value = difference(case, forces, expected)
                failed |= not value < TOLERANCE
                print(f"{case.name:16}{what:10}{value:10.1e}")
    sys.exit(failed)


if __name__ == "__main__":
    main()
