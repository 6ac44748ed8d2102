#!/usr/bin/env python3
"""Time jobs with one or several builds of dd3imp.

    utils/benchmark.py --program build/release/dd3imp
    utils/benchmark.py --program before/dd3imp --program after/dd3imp --repeat 5 input_files/bending/fine.dat
    utils/benchmark.py --program build/release/dd3imp --threads 1 --threads 2 input_files/bending/fine.dat

Every job is run --repeat times with every program and number of threads, in turn, so that what else the machine
does hits all alike; the fastest run counts, and the least processor time of all. Without a job it is the bending
test. The tables are Markdown: wall and processor time with their ratios to the first program's, increments,
iterations, peak memory, and the time by section as job.log tells it. An exit code other than 0 ends the script.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from scripts import program_at, run

BENDING = Path(__file__).resolve().parent.parent / "input_files" / "bending" / "bending.dat"
SECTIONS = ["assembly", "material", "contact", "factorisation", "solve", "output"]


class Run:
    """One run and what it took."""

    def __init__(self, program, job, threads, settings):
        with tempfile.TemporaryDirectory(prefix="dd3imp_") as folder:
            command = [str(program), "--quiet", "--output", folder, "--threads", str(threads)]
            for setting in settings:
                command += ["--set", setting]
            began = time.perf_counter()
            child = subprocess.Popen(command + [str(job)], env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
            _, status, usage = os.wait4(child.pid, 0)
            self.wall = time.perf_counter() - began
            code = os.waitstatus_to_exitcode(status)
            child.returncode = code
            if code != 0:
                sys.exit(f"{' '.join(command)} {job}: exit code {code}")
            log = (Path(folder) / "job.log").read_text(encoding="utf-8")
        self.cpu = usage.ru_utime + usage.ru_stime
        self.memory = usage.ru_maxrss / 1024.0
        sums = re.search(r"(\d+) increments, .*?(\d+) iterations; (\d+) of the linear solver", log)
        self.increments, self.iterations, self.solver = (int(number) for number in sums.groups())
        log = log[log.index("time by section"):]
        self.sections = {}
        for name in SECTIONS:
            found = re.search(rf"^ +{name} +(\S+)", log, re.MULTILINE)
            self.sections[name] = float(found.group(1)) if found else 0.0


def best_runs(arguments, job):
    """The fastest run of every program and number of threads."""
    best = {}
    for _ in range(arguments.repeat):
        for program in arguments.program:
            for threads in arguments.threads:
                run = Run(program, job, threads, arguments.set)
                key = (str(program), threads)
                other = best.setdefault(key, run)
                cpu = min(run.cpu, other.cpu)
                if run.wall < other.wall:
                    best[key] = run
                best[key].cpu = cpu
    return best


def print_tables(best):
    """Totals and sections of the runs."""
    first = next(iter(best.values()))
    print("| program | threads | wall, s | ratio | processor, s | ratio | increments | iterations | of the solver | memory, MB |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for (program, threads), run in best.items():
        print(f"| {program} | {threads} | {run.wall:.2f} | {run.wall / first.wall:.2f} | {run.cpu:.2f} "
              f"| {run.cpu / first.cpu:.2f} | {run.increments} | {run.iterations} | {run.solver} | {run.memory:.0f} |")
    print()
    print("| time by section, s | threads | " + " | ".join(SECTIONS) + " | rest |")
    print("|---" * (len(SECTIONS) + 3) + "|")
    for (program, threads), run in best.items():
        rest = run.wall - sum(run.sections.values())
        print(f"| {program} | {threads} | " + " | ".join(f"{run.sections[name]:.2f}" for name in SECTIONS)
              + f" | {rest:.2f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("job", nargs="*", type=Path, default=[BENDING], help="input files")
    parser.add_argument("--program", action="append", type=Path, required=True, help="a dd3imp; the first is compared with")
    parser.add_argument("--threads", action="append", type=int, help="number of threads (1)")
    parser.add_argument("--repeat", type=int, default=3, help="runs of each, the fastest counts (3)")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="parameter of the jobs")
    arguments = parser.parse_args()
    if arguments.repeat < 1:
        parser.error("--repeat takes 1 or more")
    arguments.threads = arguments.threads or [1]
    for path in arguments.program:
        program_at(path)
    for job in arguments.job:
        print(f"\n{job}, fastest of {arguments.repeat}\n")
        print_tables(best_runs(arguments, job))


if __name__ == "__main__":
    run(main)
