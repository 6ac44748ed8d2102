#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run the bending test in all its variants and print the tables of docs/reports/bending_test.md.

    utils/dev/bending_tables.py --program build/release/dd3imp
    utils/dev/bending_tables.py --program build/release/dd3imp --write docs/reports/bending_test.md

Each run has a folder in --work; --reuse takes the runs that are there already. Each run has one core, and --jobs of
them run at a time. Times are processor times, which depend little on the load of the machine. --write puts each table
into a document, between the lines `<!-- table: name -->` and `<!-- end of table -->`.
"""

import argparse
import itertools
import json
import statistics
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from bending_study.runs import NOTE, Run, differences, run_once
from dd3.errors import Problem
from dd3.errors import run as run_main
from dd3.pages import places, put_table, table
from dd3.programs import find_program
from dd3.progress import each
from dd3.run import read_job

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "input_files" / "bending"
PENALTIES = ["1e2", "1e3", "1e4", "1e5"]
MESHES = {"a": "0", "b": "1"}
EDGES = {"free": "corner", "u_y = 0": "all"}
# The limit on the contact forces is off except in the table `force`.
NO_FORCE = {"force": "off"}
HALVED = {"strain": "0.0025", "rotation": "0.025", "tangential": "1.5", "normal": "0.5"}
TENS = (10, 20, 30, 40)


def jobs():
    """Yield name, input file and parameters of each run."""
    for (mesh, skew), held, p in itertools.product(MESHES.items(), EDGES.values(), PENALTIES):
        yield f"{mesh}-{held}-{p}", "bending.dat", {"skew": skew, "held": held, "p": p, **NO_FORCE}
    for (mesh, skew), p in itertools.product(MESHES.items(), PENALTIES):
        yield f"force-{mesh}-{p}", "bending.dat", {"skew": skew, "p": p}
    for p in PENALTIES:
        yield f"halved-{p}", "bending.dat", {"p": p, **HALVED, **NO_FORCE}
        yield f"cutback-{p}", "bending.dat", {"p": p, "skew": "0", "cutback": "on", **NO_FORCE}
    yield "holder-11300", "bending.dat", {"holder": "-11300", **NO_FORCE}
    yield "fine", "fine.dat", {}
    yield "fine-1e4", "fine.dat", {"p": "1e4"}


def run(program, work, name, deck, parameters, reuse):
    """Run one job; its note holds exit code, seconds and memory."""
    note = work / name / NOTE
    if reuse and note.exists():
        return
    done = run_once(work / name, program, FOLDER / deck, parameters)
    note.write_text(json.dumps({"code": done.code, "seconds": done.cpu, "memory": done.memory}), encoding="utf-8")


def difference_cells(one, other):
    """Return the largest difference, its travel and the median, as cells of a table."""
    values = differences(one, other)
    largest, where = max(values)
    return f"{largest:.3f} % at {where:.1f} mm | {statistics.median(v for v, _ in values):.4f} %"


def grid(work):
    """Yield mesh, edges and p of the runs without the limit on the contact forces, and the run."""
    for mesh, (edges, held), p in itertools.product(MESHES, EDGES.items(), PENALTIES):
        yield [f"({mesh})", edges, p], Run(work / f"{mesh}-{held}-{p}")


def stops(work):
    """End of each run."""
    rows = [[*cells, f"{r.travel[-1]:.1f}", f"{r.increments}", f"{r.iterations:.2f}", f"{r.force[-1]:.0f}",
             f"{r.seconds:.1f}"] for cells, r in grid(work)]
    return table(["mesh", "edges", "p, N/mm", "reached, mm", "increments", "iterations per increment",
                  "punch force there, N", "processor time, s"], rows)


def reasons(work):
    """Reasons of the runs that did not reach the end."""
    rows = [[*cells, f"{r.travel[-1]:.2f}", r.reason] for cells, r in grid(work) if r.code]
    return table(["mesh", "edges", "p, N/mm", "last accepted, mm", "`reason` in status.csv"], rows)


def force(work):
    """Free edges with and without the limit on the contact forces."""
    rows = []
    for mesh in MESHES:
        for p in PENALTIES:
            for c, name in (("off", f"{mesh}-corner-{p}"), ("1, 1, 1", f"force-{mesh}-{p}")):
                r = Run(work / name)
                found = r.limiters()
                rows.append([f"({mesh})", p, c, f"{r.travel[-1]:.1f}", f"{r.increments}", f"{r.iterations:.2f}",
                             *(f"{found.get(limiter, 0):.1f} %" for limiter in ("rotation", "force", "r_min")),
                             f"{r.seconds:.1f}"])
    return table(["mesh", "p, N/mm", "c, d, e", "reached, mm", "increments", "iterations per increment", "`rotation`",
                  "`force`", "`r_min`", "processor time, s"], rows)


def cutback(work):
    """Mesh (a) with free edges and cut-back."""
    rows = []
    for p in PENALTIES:
        r = Run(work / f"cutback-{p}")
        rows.append([p, f"{r.travel[-1]:.1f}", f"{r.increments}", f"{r.retries}", f"{r.force[-1]:.0f}",
                     f"{r.seconds:.1f}"])
    return table(["p, N/mm", "reached, mm", "increments", "cut-backs", "punch force there, N", "processor time, s"],
                 rows)


def penalties(work):
    """Punch forces of mesh (b) at equal travel for each p."""
    runs = {p: Run(work / f"b-corner-{p}") for p in PENALTIES}
    rows = [[f"{t}"] + [f"{r.force_at(t):.1f}" if t <= r.travel[-1] else "-" for r in runs.values()]
            for t in range(5, 41, 5)]
    return table(["travel, mm"] + [f"p = {p}, N" for p in PENALTIES], rows)


def agreement(work):
    """Dependence of the punch force on p."""
    runs = {tuple(cells): r for cells, r in grid(work)}
    rows = [[mesh, edges, f"{p} and 1e4", difference_cells(r, runs[mesh, edges, "1e4"])]
            for (mesh, edges, p), r in runs.items() if p != "1e4"]
    return table(["mesh", "edges", "p, N/mm", "largest difference", "median"], rows)


def halved(work):
    """Effect of halved limits of the predictor, mesh (b)."""
    rows = []
    for p in PENALTIES:
        whole, half = Run(work / f"b-corner-{p}"), Run(work / f"halved-{p}")
        rows.append([p, f"{half.travel[-1]:.1f}", f"{whole.increments}", f"{half.increments}",
                     difference_cells(half, whole)])
    return table(["p, N/mm", "reached, mm", "increments", "with halved limits", "largest difference of the force",
                  "median"], rows)


def holder(work):
    """Whole and half blank-holder force on the half model; mesh (b)."""
    rows = []
    for force, name in (("22.6", "b-corner-1e3"), ("11.3", "holder-11300")):
        r = Run(work / name)
        rows.append([force, f"{r.travel[-1]:.1f}", f"{r.increments}", *(f"{r.force_at(t):.0f}" for t in TENS)])
    return table(["blank-holder, kN", "reached, mm", "increments"] + [f"force at {t} mm, N" for t in TENS], rows)


def limiters(work):
    """Limiters of the increments."""
    rows = []
    for name, run_name in (("(a), u_y = 0", "a-all-1e3"), ("(b), free", "b-corner-1e3"), ("(b), u_y = 0", "b-all-1e3"),
                           ("fine", "fine")):
        percentages = Run(work / run_name).limiters()
        rows.append([name, ", ".join(f"{key} {value:.1f} %" for key, value in percentages.items())])
    return table(["mesh (p = 1e3)", "increments of `draw` limited by"], rows)


def fine(work):
    """Fine mesh, which resolves the radii."""
    rows = []
    for p, name in (("1e3", "fine"), ("1e4", "fine-1e4")):
        r = Run(work / name)
        rows.append([p, f"{r.travel[-1]:.1f}", f"{r.increments}", f"{r.retries}", f"{r.iterations:.2f}",
                     f"{r.force_at(r.travel[-1]):.1f}", f"{r.seconds:.1f}", f"{r.memory:.0f}"])
    return table(["p, N/mm", "reached, mm", "increments", "cut-backs", "iterations per increment",
                  "punch force there, N", "processor time, s", "memory, MB"], rows)


TABLES = {f.__name__: f for f in (stops, reasons, force, cutback, penalties, agreement, halved, holder, limiters, fine)}


def main():
    """Run the jobs and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=Path("build/release/dd3imp"))
    parser.add_argument("--work", type=Path, default=Path("bending_tables.out"))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--reuse", action="store_true")
    parser.add_argument("--write", type=Path, metavar="DOCUMENT")
    options = parser.parse_args()
    if options.jobs < 1:
        parser.error("--jobs takes 1 or more")
    program = find_program(options.program)
    if options.write and not options.write.is_file():
        raise Problem(f"{options.write}: no such file")
    with ThreadPoolExecutor(options.jobs) as pool:
        for job in each([pool.submit(run, program, options.work, *job, options.reuse) for job in jobs()], "runs"):
            job.result()
    tables = {name: make(options.work) for name, make in TABLES.items()}
    if options.write:
        done = [read_job(options.work / name) for name, _, _ in jobs()]
        for name in tables.keys() & places(options.write):
            put_table(options.write, name, tables[name], done)
    for name, content in tables.items():
        print(f"{TABLES[name].__doc__}\n\n{content}\n")


if __name__ == "__main__":
    run_main(main)
