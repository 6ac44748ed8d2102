#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Time jobs with one or several builds of dd3imp.

    utils/dev/benchmark.py --program build/release/dd3imp
    utils/dev/benchmark.py --program before/dd3imp --program after/dd3imp --repeat 5 input_files/bending/fine.dat
    utils/dev/benchmark.py --program build/release/dd3imp --threads 1 --threads 2 input_files/bending/fine.dat

Every job is run --repeat times with every program and number of threads. The runs alternate, so that other load on the
machine affects all of them. The fastest run counts, and the smallest processor time of all. The default job is the
bending test. The tables are Markdown: wall and processor time with their ratios to the first program's, increments,
iterations, peak memory, and the time by section. An exit code other than 0 ends the script.
"""

import argparse
import tempfile
from pathlib import Path

from dd3.errors import Problem, run
from dd3.pages import table
from dd3.programs import command, find_program, launch, setting
from dd3.progress import each
from dd3.run import read_job
from dd3.tables import read_table, totals

BENDING = Path(__file__).resolve().parents[2] / "input_files" / "bending" / "bending.dat"
SECTIONS = ["assembly", "material", "contact", "factorisation", "solve", "output"]


class Run:
    """Times and counts of one run."""

    def __init__(self, program, job, threads, settings):
        with tempfile.TemporaryDirectory(prefix="dd3imp_") as folder:
            words = command(program, job, folder, ["--quiet", "--threads", threads], settings)
            done = launch(words)
            if done.code != 0:
                raise Problem(f"{' '.join(words)}: exit code {done.code}\n{done.errors}")
            self.total = totals(read_table(Path(folder) / "status.csv"))
            self.sections = read_job(Path(folder))["sections"]
        self.wall, self.cpu, self.memory = done.wall, done.cpu, done.memory


def best_runs(arguments, job):
    """Return the fastest run of every program and number of threads."""
    best = {}
    for _ in each(range(arguments.repeat), job.name):
        for program in arguments.program:
            for threads in arguments.threads:
                run = Run(program, job, threads, arguments.set)
                key = (str(program), str(threads))
                other = best.setdefault(key, run)
                cpu = min(run.cpu, other.cpu)
                if run.wall < other.wall:
                    best[key] = run
                best[key].cpu = cpu
    return best


def print_tables(best):
    """Print totals and sections of the runs."""
    first = next(iter(best.values()))
    print(table(["program", "threads", "wall, s", "ratio", "processor, s", "ratio", "increments", "iterations",
                 "of the solver", "memory, MB"],
                [[*key, f"{run.wall:.2f}", f"{run.wall / first.wall:.2f}", f"{run.cpu:.2f}",
                  f"{run.cpu / first.cpu:.2f}", f"{run.total.increments}", f"{run.total.iterations}",
                  f"{run.total.solver_iterations}", f"{run.memory:.0f}"] for key, run in best.items()]))
    print()
    print(table(["time by section, s", "threads", *SECTIONS, "rest"],
                [[*key, *(f"{run.sections.get(name, 0):.2f}" for name in SECTIONS),
                  f"{run.wall - sum(run.sections.values()):.2f}"] for key, run in best.items()]))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("job", nargs="*", type=Path, default=[BENDING], help="input files")
    parser.add_argument("--program", action="append", type=Path, required=True,
                        help="a dd3imp; ratios are to the first")
    parser.add_argument("--threads", action="append", type=int, help="number of threads (1)")
    parser.add_argument("--repeat", type=int, default=3, help="runs of each, the fastest counts (3)")
    parser.add_argument("--set", action="append", type=setting, default=[], metavar="NAME=VALUE",
                        help="parameter of the jobs")
    arguments = parser.parse_args()
    if arguments.repeat < 1:
        parser.error("--repeat takes 1 or more")
    arguments.threads = arguments.threads or [1]
    arguments.set = dict(arguments.set)
    for path in arguments.program:
        find_program(path)
    for job in arguments.job:
        print(f"\n{job}, fastest of {arguments.repeat}\n")
        print_tables(best_runs(arguments, job))


if __name__ == "__main__":
    run(main)
