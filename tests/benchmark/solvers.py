#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare the linear solvers on systems of square cups and of the bending test: docs/reports/solvers.md.

    cmake --build --preset release --target benchmark_write_matrices benchmark_solvers benchmark_run_matrices
    tests/benchmark/solvers.py --build build/release
    tests/benchmark/solvers.py --build build/release --systems 800:1 800:20 20000:0 --keep systems

Quarters of the square cup of speed.py. A system is that of the corrector at the first increment beyond a travel of the
punch, mm; 0 is the clamping. Each is solved by every method. Systems found in the folder --keep are not made again.
--jobs are run to their ends, and many of their systems are solved.
"""

import argparse
import math
import re
import tempfile
from pathlib import Path

import speed

from dd3 import programs
from dd3.errors import Problem, run

SYSTEMS = ["800:0", "800:1", "800:20", "1800:1", "3200:1", "7200:1", "20000:0"]
JOBS = [speed.ROOT / "input_files" / "bending" / name for name in ("bending.dat", "fine.dat")]
HEAD = ("| elements, unknowns | travel, mm | method | iterations | set-up, ms | factorisation, ms | solution, ms "
        "| memory, MB | residual |\n|---|---|---|---|---|---|---|---|---|\n")
ROW = re.compile(r"^  (\w+) +(\S+) +(\w+) +(\S+) +(\d+) +(\d+)((?: +[\d.]+){4}) +(\S+) +\S+ ?(.*)$")


def make_systems(build, deck, wanted, folder):
    """Return the files of the systems, given as `elements:travel`; those that are missing are made."""
    files = {name: folder / f"cup{name.replace(':', '_')}_corrector.mtx" for name in wanted}
    missing = [name.split(":") for name in wanted if not files[name].exists()]
    for elements in dict.fromkeys(size for size, _ in missing):
        n = round(math.sqrt(int(elements) / 2))
        travel = sorted((name[1] for name in missing if name[0] == elements), key=float)
        words = [str(build / "tests" / "benchmark" / "benchmark_write_matrices"), str(folder / f"cup{elements}"),
                 ",".join(travel), str(deck), f"divisions={n} {n} 2"]
        done = programs.launch(words)
        if done.code != 0:
            raise Problem(f"{' '.join(words)}: {done.output}{done.errors}")
    return files


def methods(build, file):
    """Return the number of unknowns of a system and the rows of benchmark_solvers: name and columns."""
    done = programs.launch([str(build / "tests" / "benchmark" / "benchmark_solvers"), "--default", str(file)])
    if done.code != 0:
        raise Problem(f"{file}: {done.output}{done.errors}")
    rows = []
    for line in done.output.splitlines():
        found = ROW.match(line)
        if found:
            rows.append([found[1] if found[1] != "cgs" else f"cgs, ILU({found[2]})", found])
        elif rows and line.startswith(" " * 10) and rows[-1][0] not in ("umfpack", "cgs"):
            rows[-1][0] += f": {described(line)}"
    return int(re.search(r"(\d+) unknowns", done.output)[1]), rows


def described(line):
    """Return the part of a solver's description that its name does not tell."""
    text = line.strip().split(", cheaper")[0].split("; ")[0].replace("complete LU ", "")
    return re.sub(r"MUMPS \((\w+)\)", r"\1", text)


def short(milliseconds):
    """Return a time with two or three digits."""
    return f"{milliseconds:.0f}" if milliseconds >= 100 else f"{milliseconds:.3g}"


def table(build, files):
    """Return the table as Markdown."""
    text = HEAD
    for name, file in files.items():
        elements, travel = name.split(":")
        unknowns, rows = methods(build, file)
        for method, found in rows:
            setup, factor, solve, memory = map(float, found[7].split())
            failed = " (failed)" if found[9] and found[1] != "auto" else ""
            text += (f"| {elements}, {unknowns} | {travel} | {method} | {found[5]}{failed} | {short(setup)} "
                     f"| {short(factor)} | {short(solve)} | {f'{memory:.0f}' if memory else ''} | {found[8]} |\n")
    return text.rstrip()


def table_of_job(build, job):
    """Return the table that benchmark_run_matrices prints of a job's solvers."""
    done = programs.launch([str(build / "tests" / "benchmark" / "benchmark_run_matrices"), str(job)])
    if done.code != 0:
        raise Problem(f"{job}: {done.output}{done.errors}")
    return done.output[done.output.index("| solver |"):].strip()


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True, type=Path, help="folder of the build")
    parser.add_argument("--systems", nargs="+", default=SYSTEMS, metavar="ELEMENTS:TRAVEL",
                        help=f"what to solve ({' '.join(SYSTEMS)})")
    parser.add_argument("--jobs", nargs="*", type=Path, default=JOBS,
                        help="input files (the bending test on both meshes)")
    parser.add_argument("--keep", type=Path, help="folder of the systems (a temporary one)")
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    with tempfile.TemporaryDirectory(prefix="dd3imp_") as folder:
        keep = arguments.keep or Path(folder)
        keep.mkdir(parents=True, exist_ok=True)
        texts = {"cups": table(build, make_systems(build, speed.make_deck(Path(folder)), arguments.systems, keep))}
    texts |= {job.name: table_of_job(build, job) for job in arguments.jobs}
    for name, text in texts.items():
        print(f"{name}:\n\n{text}\n")


if __name__ == "__main__":
    run(main)
