#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "laws_points", "labels": ["case", "debug"],
#:  "arguments": ["--library", "$<$<TARGET_EXISTS:dd3laws>:$<TARGET_FILE:dd3laws>>"]}
"""Stress and all internal variables on a path: of *POINT, by the library of the laws for C, and by UMAT.

    tests/laws/points.py --program build/release/dd3imp --library build/release/libdd3laws.so --work /tmp/points

Plane stress with strains in three parts: near to uniaxial tension, then with stretching across and shear, and back.
"""

import sys

import numpy as np
from calls import Material, Umat, called
from one_element import free_strain

from dd3.programs import launch
from dd3.tables import read_table

# Largest difference of a column relative to the largest value of its tensor, or to its own. The program writes ten
# digits.
TOLERANCE = 1e-8
STEPS = 20
# Strains 11, 22, 12 (of the tensor) at the ends of the parts; time of each, s.
PARTS = (((0.06, -0.025, 0.0), 10.0), ((0.1, 0.05, 0.02), 1e-3), ((0.07, 0.06, -0.02), 0.1))
STRESSES = ("s11", "s22", "s33", "s12", "s13", "s23")  # columns in the order of the library
SHEARS = ("12", "13", "23")  # components that have the factor sqrt(2) in a tensor of the state
START = 40.0  # initial temperature, the rise above which is the library's

SWIFT = "hardening = swift K=565.32 e0=0.007117 n=0.2589"
HILL = "yield = hill48 F=0.284 G=0.358 H=0.642 L=1.289 M=1.2 N=1.5"
BACK = "backstress = lemaitre_chaboche CX=50 Xsat=60"
# AA2090-T3, as in input_files/materials
YLD2000 = ("yield = yld2000 alpha1=0.4865 alpha2=1.3783 alpha3=0.7536 alpha4=1.0246 alpha5=1.0363 alpha6=0.9036 "
           "alpha7=1.2321 alpha8=1.4858 m=8")
BBC2008 = ("yield = bbc2008 l1_1=0.130866 l2_1=0.621742 m1_1=0.783422 m2_1=0.660402 m3_1=0.000079 n1_1=0.110991 "
           "n2_1=0.048245 n3_1=0.307522 l1_2=1.033922 l2_2=-0.071963 m1_2=0.000113 m2_2=0.000077 m3_2=0.538047 "
           "n1_2=0.055764 n2_2=1.018603 n3_2=0.778150 k=4")
HEAT = ("density = 7.85e-9", "heat_capacity = 4.6e8", f"initial_temperature = {START}")
CURVES = ("hardening = table 0:160 0.02:225 0.05:275 0.1:320 0.2:378",
          "rate = curves r1=0.001 r2=1 r3=1000 0:160 0.02:225 0.05:275 0.1:320 0.2:378 0:190 0.05:295 0.2:390 "
          "0:260 0.05:345 0.2:420")
TWO_SURFACES = "hardening = yoshida_uemori Y=124 B=168 C=200 m=12 b_sat=60 Rsat=190 h=0.5"
MODULUS = "modulus = table 0:2.06e5 0.02:1.86e5 0.06:1.7e5 0.15:1.61e5"
JOHNSON_COOK = ("rate = johnson_cook C=0.02 reference=1e-3", "temperature = johnson_cook Tr=20 Tm=500 m=0.8", *HEAT)
TABLES = ("rate = table 1e-5:1 0.1:1.03 10:1.1 1000:1.3", "temperature = table 20:1 45:0.97 60:0.9 100:0.8", *HEAT)
LIMITS = ("fracture = table lode1=-1 lode2=0.2 lode3=1 exponent=2 0:0.52 0.5:0.36 0:0.28 0.4:0.24 0.7:0.16 "
          "0:0.48 0.2:0.4 0.6:0.28", "forming_limit = -0.2 0.26 0 0.16")
HOSFORD_COULOMB = "fracture = hosford_coulomb a=1.4 b=0.25 c=0.05"

MATERIALS = {
    "yld2000": (YLD2000, SWIFT, BACK),
    "bbc2008": (BBC2008, SWIFT),
    "modulus": (HILL, SWIFT, BACK, MODULUS),
    "johnson_cook": (HILL, SWIFT, *JOHNSON_COOK),
    "tables": (HILL, SWIFT, BACK, *TABLES),
    "curves": (HILL, *CURVES),
    "constant_temperature": (HILL, SWIFT, "temperature = table 20:1 200:0.7", "initial_temperature = 150"),
    "hosford_coulomb": (HILL, SWIFT, HOSFORD_COULOMB),
    "limits": (HILL, SWIFT, *LIMITS),
    "all": (YLD2000, TWO_SURFACES, MODULUS, "rate = power m=0.015 reference=1e-4", *JOHNSON_COOK[1:], *LIMITS),
}


def material(name):
    """Return the block *MATERIAL of a case, which has its name, as UMAT keeps the materials of a file by name."""
    lines = ["young = 2.06e5", "poisson = 0.3", *MATERIALS[name]]
    return f"*MATERIAL {name}\n" + "".join(f"  {line}\n" for line in lines)


def run_program(program, folder):
    """Return the rows of all points but that of the start, by the name of the material."""
    text = "".join(map(material, MATERIALS))
    for name in MATERIALS:
        text += f"*POINT {name}\n  material = {name}\n  control = e11 e22 s33 e12 s23 s13\n"
        text += "".join(f"  target = {a} {b} 0 {c} 0 0 steps={STEPS}\n" for (a, b, c), _ in PARTS)
        text += "  duration = " + " ".join(str(time) for _, time in PARTS) + "\n"
    file = folder / "points.dat"
    file.write_text(text, encoding="utf-8")
    done = launch([program, "--quiet", "--output", file.with_suffix(".out"), file])
    assert done.code == 0, done.output + done.errors
    rows = read_table(file.with_suffix(".out") / "history.csv")
    return {name: [row for row in rows if row["point"] == name and int(row["increment"]) > 0] for name in MATERIALS}


class Timed:
    """A point with the time of its steps."""

    def __init__(self, point):
        """Keep the point."""
        self.point, self.time = point, 0.0
        self.stress, self.state = point.stress, point.state

    def update(self, strain):
        """Integrate over a strain increment."""
        self.point.update(strain, time=self.time)
        self.tangent = self.point.tangent


def follow(point):
    """Return stresses and internal variables after each step."""
    timed, before, found = Timed(point), np.zeros(3), []
    for ends, time in PARTS:
        timed.time = time / STEPS
        step = (np.array(ends) - before) / STEPS
        strain = np.array([step[0], step[1], 0, 2 * step[2], 0, 0])
        for _ in range(STEPS):
            strain = free_strain(timed, strain, [2, 4, 5])
            found.append(np.concatenate([point.stress, point.state]))
        before = np.array(ends)
    return np.array(found)


def expected_of(rows, names):
    """Return what the library is expected to give, and the name of the tensor or scalar of each component."""
    columns, labels, factors = list(STRESSES), ["stress"] * 6, [1.0] * 6
    for name in names:
        tensor, _, component = name.rpartition("_")
        columns.append(name.replace("equivalent_plastic_strain", "eqps"))
        labels.append(tensor if component.isdigit() else name)
        factors.append(np.sqrt(2) if component in SHEARS else 1.0)
    values = np.array([[float(row[column]) for column in columns] for row in rows]) * factors
    values[:, [label == "temperature" for label in labels]] -= START
    return values, np.array(labels)


def largest(found, expected, labels):
    """Return the largest difference of a component relative to the largest of its tensor or its own, and its name."""
    errors = {}
    for label in dict.fromkeys(labels):
        chosen = labels == label
        size = np.abs(expected[:, chosen]).max()
        assert size > 0, f"{label} stays zero"
        errors[label] = np.abs(found - expected)[:, chosen].max() / size
    label = max(errors, key=errors.get)
    return errors[label], label


def main():
    """Run and compare all materials."""
    failed = False
    with called(__doc__) as (program, library, folder):
        points, text = run_program(program, folder), "".join(map(material, MATERIALS))
        for name in MATERIALS:
            by_c = Material(library, material(name))
            expected, labels = expected_of(points[name], by_c.names())
            umat = follow(Umat(library, text, folder, name.upper()))[:, :expected.shape[1]]
            for what, found in (("library", follow(by_c)), ("umat", umat)):
                value, where = largest(found, expected, labels)
                failed |= not value < TOLERANCE
                print(f"{name:22}{what:10}{len(labels) - 6:4} internal variables{value:10.1e}  {where}")
    sys.exit(failed)


if __name__ == "__main__":
    main()
