#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure runs on several processes: time and memory, the same results, what is exchanged, the iterative solver.

    tests/benchmark/processes.py --program build/release/dd3imp --parallel build/petsc/dd3imp --work build/processes
    tests/benchmark/processes.py ... --write                  and put that of the cost into docs/reports/processes.md

The serial program has to be built with its benchmarks, in the same folder.
"""
import os
import pathlib
import subprocess
import sys

import h5py
import numpy as np

from dd3.errors import run
from dd3.pages import put_table, table
from dd3.programs import MPI_ENVIRONMENT, command, find_program, parser_of_runs
from dd3.run import read_job

ROOT = pathlib.Path(__file__).resolve().parents[2]
REPORT = ROOT / "docs" / "reports" / "processes.md"
DECK = ROOT / "input_files" / "square_cup" / "square_cup.dat"
# Elements along an edge of the cup, and its depth, mm, in the comparison of time and memory.
SIZES, DEPTH = (100, 142), 0.5
# Processes of the comparison of results, and the size and depth of its cup.
PROCESSES, SMALL, FAR = range(1, 9), 30, 5
# Processes (0: the serial program), threads and place of the factors there.
WAYS = ((0, 2, "memory"), (0, 1, "memory"), (2, 1, "memory"), (2, 1, "disk"), (4, 1, "memory"), (8, 1, "memory"),
        (8, 1, "disk"))
# Sizes and depth of the comparison of solvers.
SOLVED, SHORT = (30, 60, 100, 142), 0.1
# Components of the last state that are compared, and their names.
STATE = {"x": "positions", "stress": "stresses", "internal_variables": "plastic strains", "lambda": "contact forces"}
# Runs its arguments after the first, and writes its largest memory, MB, into a file of the folder in the first.
MEASURE = ("import os,resource,subprocess,sys; code = subprocess.run(sys.argv[2:]).returncode; "
           "used = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss/1024; "
           "print(used, file=open(f'{sys.argv[1]}/memory.{os.getpid()}', 'w')); sys.exit(code)")


class Measured:
    """A run: its folder, memory of its processes, MB, and its description."""

    def __init__(self, options, name, processes, size, depth, threads=1, deck=DECK):
        self.folder = options.work / name
        self.folder.mkdir(parents=True, exist_ok=True)
        for old in self.folder.glob("memory.*"):
            old.unlink()
        program = options.parallel if processes else options.program
        words = [sys.executable, "-c", MEASURE, str(self.folder)]
        words += command(program, deck, self.folder / "results", ["--quiet", "--threads", threads],
                         {"divisions": f"{size} {size} 1", "levels": 0, "points": 3, "depth": depth})
        if processes:
            words = [options.mpirun, "-n", str(processes), "--bind-to", "none", *words]
        done = subprocess.run(words, env={**os.environ, **MPI_ENVIRONMENT}, stdout=subprocess.DEVNULL, check=False)
        self.memory = sorted((float(path.read_text(encoding="utf-8")) for path in self.folder.glob("memory.*")),
                             reverse=True)
        self.job = read_job(self.folder / "results")
        self.counts, self.ended = self.job["counts"], done.returncode == 0
        print(name, *(f"{value:.0f} MB" for value in self.memory), flush=True)

    def seconds(self, *sections):
        """Return the time of some sections, s."""
        return sum(self.job["sections"][name] for name in sections)


def deck_of(options, method, factors="memory"):
    """Return the deck of the cup with a linear solver."""
    deck = options.work / f"{method}_{factors}.dat"
    deck.parent.mkdir(parents=True, exist_ok=True)
    deck.write_text(f"*INCLUDE {DECK}\n*SOLVER\n  method = {method}\n  factors = {factors}\n", encoding="utf-8")
    return deck


def cost(options):
    """Return the table of time and memory, and its runs."""
    rows, jobs = [], []
    for size in SIZES:
        for processes, threads, factors in WAYS:
            method = "petsc_mumps" if processes else "auto"
            deck = deck_of(options, method, factors)
            run_of = Measured(options, f"cost_{size}_{processes}_{threads}_{factors}", processes, size, DEPTH, threads,
                              deck)
            jobs.append(run_of.job)
            memory = f"{run_of.memory[0]:.0f}" + (f" to {run_of.memory[-1]:.0f}" if processes else "")
            rows.append([f"{size*size:,}", str(max(1, processes)), str(threads), factors, memory,
                         f"{run_of.job['seconds']:.1f}", f"{run_of.seconds('material', 'assembly'):.1f}",
                         f"{run_of.seconds('contact'):.2f}", f"{run_of.seconds('factorisation', 'solve'):.1f}"])
    return table(["elements", "processes", "threads of each", "factors", "memory of a process, MB", "wall, s",
                  "material and assembly, s", "contact, s", "factorisation and solution, s"], rows), jobs


def results(options):
    """Return the table of results on different numbers of processes, and its runs."""
    rows, jobs, first = [], [], None
    for processes in PROCESSES:
        run_of = Measured(options, f"results_{processes}", processes, SMALL, FAR)
        jobs.append(run_of.job)
        with h5py.File(run_of.folder / "results" / "restart.h5") as file:
            state = {name: file["state"][name][...] for name in (*STATE, "status")}
        first = first or state
        apart = [np.abs(state[name] - first[name]).max() / np.abs(first[name]).max() for name in STATE]
        rows.append([str(processes), f"{run_of.counts['increments']}, {run_of.counts['iterations']}",
                     *(f"{value:.0e}" for value in apart), str(np.count_nonzero(state["status"] != first["status"]))])
    return table(["processes", "increments, iterations", *STATE.values(), "contact status, number"], rows), jobs


def exchange(options):
    """Return the table of what is exchanged."""
    done = subprocess.run([options.program.parent / "tests" / "benchmark" / "benchmark_parts"], capture_output=True,
                          text=True, check=True)
    lines = [line.split() for line in done.stdout.splitlines()]
    print(done.stdout, flush=True)
    return table(["parts", "elements of the largest over the mean", "edges cut, %", "ghost nodes of a part, mean",
                  "at most", "neighbours at most", "rows sent at most, MB", "sums at the nodes, MB"],
                 [[cell.rstrip(".") for cell in line] for line in lines if line[0].isdigit()])


def solvers(options):
    """Return the table of the iterative solver, and its runs."""
    rows, jobs = [], []
    for size in SOLVED:
        row = [f"{size*size:,}"]
        for method in ("petsc_gamg", "petsc_mumps"):
            run_of = Measured(options, f"{method}_{size}", 2, size, SHORT, deck=deck_of(options, method))
            jobs.append(run_of.job)
            if method == "petsc_gamg":
                solutions = run_of.counts["iterations"] + run_of.counts["increments"]
                row.append(f"{run_of.counts['solver_iterations']/solutions:.0f}")
            row += [f"{run_of.seconds('factorisation', 'solve'):.2f}" if run_of.ended else "stops",
                    f"{run_of.memory[0]:.0f}"]
        rows.append(row)
    return table(["elements", "iterations in a solution", "`petsc_gamg`, s", "memory, MB", "`petsc_mumps`, s",
                  "memory, MB"], rows), jobs


def main():
    parser = parser_of_runs(__doc__)
    parser.add_argument("--parallel", required=True, type=find_program, help="the program for several processes")
    parser.add_argument("--mpirun", default="mpirun", help="the command that starts several processes")
    parser.add_argument("--write", action="store_true", help="put the table of the cost into the report")
    options = parser.parse_args()
    found = {"results": results(options), "cost": cost(options), "solvers": solvers(options)}
    found["exchange"] = exchange(options), found["cost"][1]
    for content, _ in found.values():
        print(f"\n{content}")
    if options.write:
        put_table(REPORT, "cost", *found["cost"])


if __name__ == "__main__":
    run(main)
