#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"labels": ["petsc"], "processors": 2, "timeout": 1800,
#:  "arguments": ["--mpirun", "${MPIEXEC_EXECUTABLE}", "--ranks", "2", "3"]}
#: {"name": "ranks_many", "labels": ["petsc", "slow"], "processors": 2, "timeout": 1800,
#:  "arguments": ["--mpirun", "${MPIEXEC_EXECUTABLE}", "--ranks", "8"]}
"""Runs on several ranks give the results of the serial run, end as it does, and continue on another number of ranks.

    ranks.py --program build/petsc/dd3imp --mpirun mpirun --work build/ranks --ranks 2 3 4 8
"""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

import h5py
import numpy as np

from dd3.programs import MPI_ENVIRONMENT, parser_of_runs
from dd3.tables import read_table

ROOT = pathlib.Path(__file__).resolve().parents[2]
CASES, RAIL = ROOT / "tests" / "cases", ROOT / "input_files" / "rail" / "laid.dat"
CUP, BENT = ROOT / "input_files" / "square_cup" / "square_cup.dat", pathlib.Path(__file__).with_name("bent.dat")
DRAWN, BOUND = ROOT / "tests" / "restart" / "refined.dat", CASES / "bound_nodes" / "bending.dat"
# Largest difference of a column of history.csv, and of a component of the last state, as a fraction of its scale.
TOLERANCE = 1e-5
# Tolerance of the equilibrium in runs that are compared: states accepted at the default differ by more than TOLERANCE.
NEWTON_TOLERANCE = 1e-4
# Values of a column or a component, mm, N, MPa or mJ, below which they are round-off.
ROUND_OFF = 1e-9
# Columns without meaning where all forces are round-off.
LEFT_OUT = ("_contacts", "_area", "_pressure", "energy_error")
FORCES = ("_fx", "_fy", "_fz", "_rx", "_ry", "_rz")
# Components of the state that are compared: at the nodes, at the elements and at the contact points.
COMPONENTS = ("x", "stress", "internal_variables", "orientation", "lambda", "tool_displacement")
# MUMPS begins with too little workspace, so that it has to be given more.
ENVIRONMENT = {**os.environ, **MPI_ENVIRONMENT, "PETSC_OPTIONS": "-dd3_petsc_mumps_mat_mumps_icntl_14 -60"}
# Case, linear solver, exit code: a sheet that sags and is badly conditioned, with cut-backs; draw-beads; tailored
# blanks; enhanced strains; a pressed tool; cut-backs at an open edge; an early end of a phase; friction by the plastic
# strain; an iterative solver; factors on the disk; elements of different sizes; elements divided in the run, once or
# twice, with a pressed tool, and with increments made again, also with an iterative solver; a run that stops.
JOBS = ((RAIL, "auto", 0),
        ("drawbead_strip", "auto", 0),
        ("drawbead_tailored", "auto", 0),
        ("tailored_parallel", "auto", 0),
        ("squeeze_solid_shell", "auto", 0),
        ("holder_gap", "auto", 0),
        ("strip_over_open_edge", "auto", 0),
        ("until_met_within", "auto", 0),
        ("strip_drawing_strained", "auto", 0),
        ("squeeze_solid_shell", "petsc_gamg", 0),
        ("round_cup", "petsc_gamg", 0),
        ("round_cup", "petsc_mumps", 0),
        (BOUND, "auto", 0),
        (CUP, "auto", 0),
        (DRAWN, "auto", 0),
        (BENT, "auto", 0),
        (BENT, "petsc_gamg", 0),
        ("pressed_beside", "auto", 3))
# Parameters of a job.
SETTINGS = {RAIL: ("divisions=20 12 1", "levels=0", "points=3", "travel=3"),
            CUP: ("divisions=5 5 1", "points=3", "levels=2", "depth=15"), BOUND: ("angle=40",)}
# Its increments at first contact follow the round-off: only its last positions are compared.
LOOSE = (RAIL,)
# Jobs in which elements are divided after the first increment.
REFINED = (CUP, DRAWN, BENT)
# Cases that are killed and continued, with the increments before; seconds until all ranks have ended.
KILLED, GRACE = (("strip_over_open_edge", 5), (BENT, 9)), 30


class Difference(Exception):
    """A run on several ranks differs from the serial one."""


class Runs:
    """Runs of one input file."""

    def __init__(self, options, name, method, restart="off"):
        path = name if isinstance(name, pathlib.Path) else CASES / name / "case.dat"
        self.options, self.settings, self.loose = options, SETTINGS.get(name, ()), name in LOOSE
        title = path.parent.name if path.stem == "case" else f"{path.parent.name}_{path.stem}"
        self.work = options.work / f"{title}_{method}_{restart.replace(' ', '_')}"
        self.work.mkdir(parents=True)
        self.deck = self.work / "deck.dat"
        deck = path.read_text(encoding="utf-8")
        text = f"*INCLUDE {path}\n*SOLVER\n  method = {method}\n"
        if method == "petsc_mumps":
            text += "  factors = disk\n"
        if "*NEWTON" not in deck:
            text += f"*NEWTON\n  tolerance = {NEWTON_TOLERANCE}\n"
        if "*OUTPUT" not in deck:
            text += f"*OUTPUT\n  restart = {restart}\n"
        self.deck.write_text(text, encoding="utf-8")

    def words(self, ranks, output, restart=None):
        """Return the command; `ranks` is 0 for a serial run."""
        words = [str(self.options.program), "--quiet", "--threads", "1", "--output", str(self.work / output)]
        words += ["--restart", str(restart)] if restart else []
        words += [word for setting in self.settings for word in ("--set", setting)]
        return ([self.options.mpirun, "-n", str(ranks)] if ranks else []) + [*words, str(self.deck)]

    def run(self, ranks, output, code=0, restart=None):
        """Run; return the folder of the results and what was printed."""
        done = subprocess.run(self.words(ranks, output, restart), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True, timeout=600, check=False, env=ENVIRONMENT)
        if done.returncode != code:
            raise Difference(f"exit code {done.returncode} instead of {code}:\n{done.stdout}")
        return self.work / output, done.stdout


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


def compare_tables(path, serial):
    """Compare two tables of history."""
    rows, expected = read_table(path), read_table(serial)
    if len(rows) != len(expected):
        raise Difference(f"{len(rows)} rows instead of {len(expected)}")
    for column in expected[0]:
        if column.endswith(LEFT_OUT):
            continue
        pairs = zip(values_of(rows, column), values_of(expected, column))
        difference = max((abs(a - b) for a, b in pairs), default=0.0)
        if difference > max(ROUND_OFF, TOLERANCE * scale_of(expected, column)):
            raise Difference(f"column {column} differs by {difference:.3g}")


def compare_states(path, serial, components=COMPONENTS):
    """Compare components of the last states of two runs; there may be none."""
    if not serial.exists() and not path.exists():
        return
    with h5py.File(path) as found, h5py.File(serial) as expected:
        # A loose sheet without stresses may lie anywhere.
        if max(np.abs(file["state/stress"][...]).max() for file in (found, expected)) < ROUND_OFF:
            return
        for name in components:
            a, b = found["state"][name][...], expected["state"][name][...]
            if a.shape != b.shape:
                raise Difference(f"{name} has {a.size} values instead of {b.size}")
            difference = np.abs(a - b).max(initial=0.0)
            if difference > max(ROUND_OFF, TOLERANCE * np.abs(b).max(initial=0.0)):
                raise Difference(f"{name} of the last state differs by {difference:.3g}")


def compare(folder, serial):
    """Compare the results of two runs."""
    compare_tables(folder / "history.csv", serial / "history.csv")
    compare_states(folder / "restart.h5", serial / "restart.h5")


def check(options, name, method, code):
    """Run a case serially and on each number of ranks, and compare."""
    runs = Runs(options, name, method, "every 1000")
    serial, _ = runs.run(0, "serial", code)
    if name in REFINED and not refined_within(serial):
        raise Difference("no element was divided after the first increment")
    for ranks in options.ranks:
        folder, printed = runs.run(ranks, str(ranks), code)
        if printed.count("dd3imp: stopped") != (code == 3):
            raise Difference(f"{ranks} ranks printed:\n{printed}")
        if runs.loose:
            compare_states(folder / "restart.h5", serial / "restart.h5", ("x",))
        else:
            compare(folder, serial)


def refined_within(folder):
    """Whether elements were divided after the first increment."""
    run = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    return any(refinement["increment"] > 0 for refinement in run["refinements"])


def increment_of(restart):
    """Return the increment of a restart file; 0 without one."""
    try:
        with h5py.File(restart, locking=False) as file:
            return int(file["state/increment"][0])
    except (OSError, KeyError):
        return 0


def ranks_of(parent, program):
    """Return the process numbers of the program below a process."""
    found = []
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            above = int((folder / "stat").read_text(encoding="utf-8").rsplit(")", 1)[1].split()[1])
            if above == parent and (folder / "exe").resolve() == program:
                found.append(int(folder.name))
        except OSError:
            continue
    return sorted(found)


def killed(options, name, increments, first, later):
    """Kill one rank of a run; then continue it on another number of ranks."""
    runs = Runs(options, name, "auto", "every 1")
    serial, _ = runs.run(0, "serial")
    folder = runs.work / "killed"
    with subprocess.Popen(runs.words(first, folder.name), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                          env=ENVIRONMENT) as child:
        while child.poll() is None and increment_of(folder / "restart.h5") < increments:
            time.sleep(0.01)
        if child.poll() is not None:
            raise Difference("the run ended before it was killed")
        os.kill(ranks_of(child.pid, options.program)[-1], signal.SIGKILL)
        try:
            code = child.wait(GRACE)
        except subprocess.TimeoutExpired:
            child.kill()
            raise Difference("the other ranks go on") from None
    if code == 0:
        raise Difference("exit code 0 of a run of which one rank was killed")
    for ranks in later:
        copy = runs.work / f"{first}_{ranks}"
        shutil.copytree(folder, copy)
        compare(runs.run(ranks, copy.name, restart=copy / "restart.h5")[0], serial)


def initial(options, name, ranks):
    """Write the state from which a run would start, without the run."""
    runs = Runs(options, name, "auto")
    for number in (0, ranks):
        folder = runs.work / f"initial_{number}"
        words = [*runs.words(number, "unused")[:-1], "--check", "--initial", str(folder), str(runs.deck)]
        done = subprocess.run(words, stdout=subprocess.DEVNULL, timeout=60, check=False, env=ENVIRONMENT)
        if done.returncode:
            raise Difference(f"exit code {done.returncode}")
    groups = []
    for number in (0, ranks):
        with h5py.File(runs.work / f"initial_{number}" / "fields.vtkhdf") as file:
            groups.append({name: data[...] for name, data in file["VTKHDF/PointData"].items()})
    for field, values in groups[0].items():
        if np.abs(groups[1][field] - values).max(initial=0.0) > ROUND_OFF:
            raise Difference(f"{field} differs")


def main():
    """Run the test."""
    parser = parser_of_runs(__doc__)
    parser.add_argument("--mpirun", default="mpirun", help="the command that starts several ranks")
    parser.add_argument("--ranks", type=int, nargs="+", default=[2, 3, 8], help="numbers of ranks")
    options = parser.parse_args()
    options.work, options.program = options.work.resolve(), pathlib.Path(options.program).resolve()
    shutil.rmtree(options.work, ignore_errors=True)
    tests = [(f"{getattr(name, 'stem', name)}, {method}", check, (name, method, code)) for name, method, code in JOBS]
    tests += [("initial state", initial, ("round_cup", 3))]
    tests += [(f"{getattr(name, 'stem', name)}, a killed rank, then 3 ranks and a serial run", killed,
               (name, increments, 2, (3, 0))) for name, increments in KILLED]
    failed = 0
    for title, test, arguments in tests:
        try:
            test(options, *arguments)
            print(f"{title}: agrees", flush=True)
        except Difference as difference:
            failed += 1
            print(f"{title}: {difference}", flush=True)
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
