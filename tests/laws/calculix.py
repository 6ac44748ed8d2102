#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""One element in CalculiX with the UMAT of the library of the laws, and in dd3imp.

    tests/laws/calculix.py --program build/release/dd3imp --library build/release/libdd3laws.so \\
        --ccx CalculiX --work /tmp/calculix

CalculiX has to be linked with libdd3laws.so, or with --external to have been compiled for external behaviours;
docs/laws_library.md says how. Large strains: ABAQUSNL and one element of dd3imp. Small strains: ABAQUS and a single
point of dd3imp. Both get the same steps. --write puts the table in docs/laws_library.md.
"""

import argparse
import ctypes
import dataclasses
import os
from pathlib import Path

import numpy as np
from calls import Material
from cases import CASES, SIZE, displacements
from one_element import difference, run_program

from dd3.errors import Problem, run
from dd3.programs import find_program, launch, made_folder
from dd3.tables import read_table

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "laws_library.md"
BEGIN, END = "<!-- calculix.py -->\n", "<!-- end -->\n"

NODES = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]

INPUT = """*NODE, NSET=ALL
{nodes}
*ELEMENT, TYPE=C3D8, ELSET=CUBE
1, 1, 2, 3, 4, 5, 6, 7, 8
{sets}
*MATERIAL, NAME={material}
*USER MATERIAL, CONSTANTS=1
0.
*DEPVAR
13
*SOLID SECTION, ELSET=CUBE, MATERIAL={material}
*BOUNDARY
{held}
"""

STEP = """*STEP{nlgeom}, INC=10000
*STATIC, DIRECT
{step!r}, 1.
*CONTROLS, PARAMETERS=FIELD
1e-9, 1e-9
*CONTROLS, PARAMETERS=TIME INCREMENTATION
60, 80, 90, 160, 100
*BOUNDARY
{displaced}
*NODE PRINT, NSET=X_MAX, TOTALS=ONLY
RF
*NODE PRINT, NSET=Y_MAX, TOTALS=ONLY
RF
*END STEP
"""


def write_input(case, large, external, path):
    """Write the input of CalculiX."""
    faces = {f"{'XYZ'[axis]}_{end}": [i for i, node in enumerate(NODES, 1) if node[axis] == (end == "MAX")]
             for axis in range(3) for end in ("MIN", "MAX")}
    sets = "\n".join(f"*NSET, NSET={name}\n" + ", ".join(map(str, nodes)) for name, nodes in faces.items())
    held = "X_MIN, 1\nY_MIN, 2\nZ_MIN, 3"
    if case.sheared:
        held = "Y_MIN, 1, 2\nY_MAX, 2\nALL, 3"
    name = case.name.replace(" ", "").upper()
    prefix = "ABAQUSNL" if large else "ABAQUS"
    material = f"@{prefix}_DD3LAWS@{name}" if external else f"{prefix}_{name}"
    text = INPUT.format(
        nodes="\n".join(f"{i}, " + ", ".join(str(SIZE * x) for x in node) for i, node in enumerate(NODES, 1)),
        sets=sets, material=material, held=held)
    now = [0.0] * len(case.motions)
    for change, steps in case.segments:
        now = [a + b for a, b in zip(now, change)]
        displaced = []
        for (face, axis), value in zip(case.motions, now):
            freedom = "xyz".index(axis) + 1
            displaced.append(f"{face.upper()}_MAX, {freedom}, {freedom}, {value!r}")
            if case.sheared:  # the nodes of y_max are led, those of y_min held
                displaced.append("Y_MAX, 2, 2, 0.")
        text += STEP.format(nlgeom=", NLGEOM" if large else "", step=1 / steps, displaced="\n".join(displaced))
    path.write_text(text, encoding="utf-8")
    materials = case.material().replace("*MATERIAL sheet", f"*MATERIAL {name.lower()}")
    path.with_name("dd3_materials.dat").write_text(materials, encoding="utf-8")


def run_calculix(options, case, large):
    """Return the forces on x_max and y_max along x and y after each step."""
    folder = made_folder(options.work / f"{case.name.replace(' ', '_')}_{'large' if large else 'small'}")
    path = folder / "cube.inp"
    write_input(case, large, options.external, path)
    done = launch([options.ccx, "-i", "cube"], 300, folder=folder)
    (folder / "cube.log").write_text(done.output + done.errors, encoding="utf-8")
    if done.code:
        raise Problem(f"{folder}/cube.log: CalculiX ends with the code {done.code}")
    lines = (folder / "cube.dat").read_text(encoding="utf-8").splitlines()
    totals = [[float(word) for word in lines[i + 2].split()[:2]]
              for i, line in enumerate(lines) if "total force" in line]
    return np.vstack([np.zeros((1, 4)), np.reshape(totals, (-1, 4))])


def run_point(options, case):
    """Return the forces of a single point of dd3imp at small strains."""
    control = ["s11", "s22", "s33", "s12", "s23", "s13"]
    place = [{"xx": 0, "yy": 1, "yx": 3}[motion] for motion in case.motions]
    for i in range(6) if case.sheared else [*place, 3]:  # the faces stay parallel to the axes
        control[i] = control[i].replace("s", "e")
    text = case.material() + f"\n*POINT point\n  material = sheet\n  angle = {-case.angle}\n"
    text += "  control = " + " ".join(control) + "\n"
    now = np.zeros(len(place))
    for change, steps in case.segments:
        now = now + change
        target = np.zeros(6)
        target[place] = now / SIZE * (0.5 if case.sheared else 1.0)
        text += "  target = " + " ".join(repr(float(value)) for value in target) + f" steps={steps}\n"
    path = options.work / f"{case.name.replace(' ', '_')}_point.dat"
    path.write_text(text, encoding="utf-8")
    done = launch([options.program, "--quiet", "--output", path.with_suffix(".out"), path])
    if done.code:
        raise Problem(done.errors)
    rows = read_table(path.with_suffix(".out") / "history.csv")
    names = ("s11", "s12", "s12", "s22")
    return SIZE**2 * np.array([[float(row[name]) for name in names] for row in rows])


def by_total_strain(options, case):
    """Return the forces of simple shear by the library with CalculiX's strain increments.

    They are the change of ln U in axes that turn with R, where F = R U.
    """
    forces, before = [], np.zeros(6)
    point = Material(ctypes.CDLL(str(options.library.resolve())), case.material())
    for (now,) in displacements(case):
        gradient = np.array([[1.0, now / SIZE], [0.0, 1.0]])
        values, vectors = np.linalg.eigh(gradient.T @ gradient)
        logarithm = vectors @ np.diag(0.5 * np.log(values)) @ vectors.T
        rotation = gradient @ vectors @ np.diag(values**-0.5) @ vectors.T
        strain = np.array([logarithm[0, 0], logarithm[1, 1], 0, 2 * logarithm[0, 1], 0, 0])
        point.update(strain - before)
        before = strain
        s11, s22, _, s12 = point.stress[:4]
        stress = rotation @ np.array([[s11, s12], [s12, s22]]) @ rotation.T
        forces.append([0, 0, SIZE**2 * stress[0, 1], SIZE**2 * stress[1, 1]])
    return np.array(forces)


def compare(options):
    """Return the rows of the table: case, strains, what CalculiX is compared with, difference of the forces."""
    rows = []
    back_and_forth = dataclasses.replace(CASES[2], name="cyclic simple shear", laws=CASES[3].laws,
                                         segments=(((0.3,), 30), ((-0.5,), 50), ((0.4,), 40)))
    for case in CASES:
        found = run_calculix(options, case, large=True)
        expected = run_program(options.program, case, options.work)
        rows.append((case, "large", "one element", difference(case, found, expected, normal=False)))
        if case.sheared:
            value = difference(case, found, by_total_strain(options, case))
            rows.append((case, "large", "the library with CalculiX's strain increments", value))
    for case in (*CASES, back_and_forth):
        found = run_calculix(options, case, large=False)
        rows.append((case, "small", "a single point", difference(case, found, run_point(options, case), normal=False)))
    return rows


def table(rows):
    """Return the table of the page."""
    text = "| case | strains | steps | beside | largest difference of a force |\n|---|---|---|---|---|\n"
    for case, strains, what, value in rows:
        steps = sum(steps for _, steps in case.segments)
        text += f"| {case.name} | {strains} | {steps} | {what} | {value:.1e} |\n"
    return text


def main():
    """Run, compare, print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, type=find_program)
    parser.add_argument("--ccx", required=True, type=find_program)
    parser.add_argument("--library", required=True, type=Path, help="libdd3laws.so")
    parser.add_argument("--work", required=True, type=made_folder)
    parser.add_argument("--external", action="store_true", help="call the library as an external behaviour")
    parser.add_argument("--write", action="store_true", help="put the table in docs/laws_library.md")
    options = parser.parse_args()
    os.environ.pop("DD3_MATERIALS", None)
    text = table(compare(options))
    print(text, end="")
    if options.write:
        before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
        PAGE.write_text(before + BEGIN + text + END + rest.split(END, 1)[1], encoding="utf-8")


if __name__ == "__main__":
    run(main)
