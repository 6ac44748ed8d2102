#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs on several ranks give the history of the serial run, and end as it does.

    ranks.py --program build/petsc/dd3imp --mpirun mpirun --work build/ranks --ranks 2 4
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys

from dd3.tables import read_table

ROOT = pathlib.Path(__file__).resolve().parents[2]

CASES = ROOT / "tests" / "cases"
# Largest difference of a column of history.csv, as a fraction of its scale: see `scale_of`.
TOLERANCE = 1e-5
# Columns without meaning where all forces are round-off.
LEFT_OUT = ("_contacts", "_area", "_pressure", "energy_error")
FORCES = ("_fx", "_fy", "_fz", "_rx", "_ry", "_rz")
# mpirun refuses root, and more ranks than processors, unless it is asked not to.
ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1"}
# Case, linear solver, exit code: draw-beads; enhanced strains; a pressed tool; an iterative solver; a run that stops.
JOBS = (("drawbead_strip", "auto", 0),
        ("squeeze_solid_shell", "auto", 0),
        ("holder_gap", "auto", 0),
        ("squeeze_solid_shell", "petsc_bicgstab", 0),
        ("pressed_beside", "auto", 3))


class Difference(Exception):
    """A run on several ranks differs from the serial one."""


def run(words, expected):
    """Run a command; return what it printed."""
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=600, check=False,
                          env={**os.environ, **ENVIRONMENT})
    if done.returncode != expected:
        raise Difference(f"exit code {done.returncode} instead of {expected}:\n{done.stdout}")
    return done.stdout


def values_of(rows, column):
    """Return a column as numbers; empty if it has texts."""
    try:
        return [float(row[column]) for row in rows]
    except ValueError:
        return []


def scale_of(rows, column):
    """Return the largest value of a column; of a force, that of all forces."""
    columns = [column]
    if column.endswith(FORCES):
        columns = [name for name in rows[0] if name.endswith(FORCES)]
    return max((abs(value) for name in columns for value in values_of(rows, name)), default=0.0)


def compare(path, serial):
    """Compare two tables of history."""
    rows, expected = read_table(path), read_table(serial)
    if len(rows) != len(expected):
        raise Difference(f"{len(rows)} rows instead of {len(expected)}")
    for column in expected[0]:
        if column.endswith(LEFT_OUT):
            continue
        pairs = zip(values_of(rows, column), values_of(expected, column))
        difference = max((abs(a - b) for a, b in pairs), default=0.0)
        if difference > TOLERANCE * scale_of(expected, column):
            raise Difference(f"column {column} differs by {difference:.3g}")


def check(options, name, method, code):
    """Run a case serially and on each number of ranks, and compare."""
    work = options.work / f"{name}_{method}"
    work.mkdir(parents=True)
    deck = work / "deck.dat"
    deck.write_text(f"*INCLUDE {CASES / name / 'case.dat'}\n*SOLVER\n  method = {method}\n", encoding="utf-8")

    def command(output):
        return [str(options.program), "--quiet", "--threads", "1", "--output", str(work / output), str(deck)]

    run(command("serial"), code)
    for ranks in options.ranks:
        printed = run([options.mpirun, "-n", str(ranks), *command(str(ranks))], code)
        if printed.count("dd3imp: stopped") != (code == 3):
            raise Difference(f"{ranks} ranks printed:\n{printed}")
        compare(work / str(ranks) / "history.csv", work / "serial" / "history.csv")


def main():
    """Run the test."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=pathlib.Path, required=True, help="the program dd3imp, built with PETSc")
    parser.add_argument("--mpirun", default="mpirun", help="the command that starts several ranks")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for the results; it is emptied")
    parser.add_argument("--ranks", type=int, nargs="+", default=[2], help="numbers of ranks")
    options = parser.parse_args()
    options.work = options.work.resolve()
    shutil.rmtree(options.work, ignore_errors=True)
    failed = 0
    for name, method, code in JOBS:
        try:
            check(options, name, method, code)
            print(f"{name}, {method}: agrees", flush=True)
        except Difference as difference:
            failed += 1
            print(f"{name}, {method}: {difference}", flush=True)
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
