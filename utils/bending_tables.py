#!/usr/bin/env python3
"""Run the bending test in all its variants and print the tables of docs/reports/bending_test.md.

    utils/bending_tables.py --program build/release/dd3imp
    utils/bending_tables.py --program build/release/dd3imp --write docs/reports/bending_test.md

The runs go to --work, a folder each; --reuse takes those that are there already. Each run has one core; --jobs of
them go at a time. Times are processor times, so that a busy machine does not change them much. --write puts each
table into a document, between the lines `<!-- table: name -->` and `<!-- end of table -->`.
"""

import argparse
import csv
import json
import os
import re
import statistics
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import scripts

FOLDER = Path(__file__).resolve().parent.parent / "input_files" / "bending"
PENALTIES = ["1e2", "1e3", "1e4", "1e5"]
MESHES = {"a": "0", "b": "1"}
EDGES = {"free": "corner", "u_y = 0": "all"}
HALVED = {"strain": "0.0025", "rotation": "0.025", "tangential": "1.5", "normal": "0.5"}
# Travel from which forces are compared, and the distance of the points, mm.
FIRST, STEP = 0.1, 0.1


def jobs():
    """All runs: name, input file, parameters."""
    for mesh, skew in MESHES.items():
        for edges, held in EDGES.items():
            for p in PENALTIES:
                yield f"{mesh}-{held}-{p}", "bending.dat", {"skew": skew, "held": held, "p": p}
    for p in PENALTIES:
        yield f"halved-{p}", "bending.dat", {"p": p, **HALVED}
    for p in PENALTIES:
        yield f"cutback-{p}", "bending.dat", {"p": p, "skew": "0", "cutback": "on"}
    yield "holder-11300", "bending.dat", {"holder": "-11300"}
    yield "fine", "fine.dat", {}
    yield "fine-1e4", "fine.dat", {"p": "1e4"}


def run(program, work, name, deck, parameters, reuse):
    """Runs one job and notes what it took."""
    folder = work / name
    note = folder / "run.json"
    if reuse and note.exists():
        return
    folder.mkdir(parents=True, exist_ok=True)
    command = [str(program), "--quiet", "--output", str(folder)]
    for key, value in parameters.items():
        command += ["--set", f"{key}={value}"]
    with open(folder / "errors.txt", "w", encoding="utf-8") as errors:
        child = subprocess.Popen(command + [str(FOLDER / deck)], stderr=errors, env={**os.environ, "OMP_NUM_THREADS": "1"})
        _, status, usage = os.wait4(child.pid, 0)
    code = os.waitstatus_to_exitcode(status)
    if code not in (0, 3):
        sys.exit(f"{' '.join(command)}: exit code {code}\n" + (folder / "errors.txt").read_text(encoding="utf-8"))
    note.write_text(json.dumps({"code": code, "seconds": usage.ru_utime + usage.ru_stime, "memory": usage.ru_maxrss / 1024}))
    print(f"{name}: exit code {code}, {usage.ru_utime + usage.ru_stime:.1f} s", file=sys.stderr)


class Run:
    """What a finished run left behind."""

    def __init__(self, folder):
        self.__dict__.update(json.loads((folder / "run.json").read_text(encoding="utf-8")))
        self.history = [row for row in read_table(folder / "history.csv") if row["phase"] == "draw"]
        self.status = read_table(folder / "status.csv")
        self.travel = [float(row["travel"]) for row in self.history]
        self.force = [float(row["punch_fz"]) for row in self.history]
        self.increments = sum(row["outcome"] == "accepted" for row in self.status)
        self.retries = sum(row["outcome"] == "retry" for row in self.status)
        self.iterations = sum(int(row["iterations"]) for row in self.status) / max(1, self.increments)
        # The list of nodes behind the number of status changes is left out.
        self.reason = re.sub(r"( nodes): .*", r"\1", self.status[-1]["reason"])

    def force_at(self, travel):
        """Punch force at a travel, by linear interpolation."""
        for i in range(1, len(self.travel)):
            if self.travel[i] >= travel - 1e-9:
                share = (travel - self.travel[i - 1]) / (self.travel[i] - self.travel[i - 1])
                return self.force[i - 1] + share * (self.force[i] - self.force[i - 1])
        raise ValueError(f"the run ends before {travel} mm")

    def limiters(self):
        """Share of the increments that each limiter set, in per cent."""
        rows = [row["limiter"] for row in self.status if row["phase"] == "draw" and row["outcome"] == "accepted"]
        return {name: 100 * rows.count(name) / len(rows) for name in sorted(set(rows), key=rows.count, reverse=True)}


def read_table(path):
    """The rows of a csv file."""
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def differences(one, other):
    """Relative differences of two runs' punch forces in per cent, as far as both go."""
    end = min(one.travel[-1], other.travel[-1])
    points = [FIRST + i * STEP for i in range(int((end - FIRST) / STEP + 1e-6) + 1)]
    return [(100 * abs(one.force_at(t) / other.force_at(t) - 1), t) for t in points]


def difference_cells(one, other):
    """Largest difference, where it is, and the median, as cells of a table."""
    values = differences(one, other)
    largest, where = max(values)
    return f"{largest:.3f} % at {where:.1f} mm | {statistics.median(v for v, _ in values):.4f} %"


def table(heading, rows):
    """A markdown table."""
    lines = ["| " + " | ".join(heading) + " |", "|" + "---|" * len(heading)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def stops(work):
    """Where each run stops."""
    rows = []
    for mesh in MESHES:
        for edges, held in EDGES.items():
            for p in PENALTIES:
                r = Run(work / f"{mesh}-{held}-{p}")
                rows.append([f"({mesh})", edges, p, f"{r.travel[-1]:.1f}", f"{r.increments}", f"{r.iterations:.2f}",
                             f"{r.force[-1]:.0f}", f"{r.seconds:.1f}"])
    return table(["mesh", "edges", "p, N/mm", "reached, mm", "increments", "iterations per increment",
                  "punch force there, N", "processor time, s"], rows)


def reasons(work):
    """What stopped the runs that did not reach the end."""
    rows = []
    for mesh in MESHES:
        for edges, held in EDGES.items():
            for p in PENALTIES:
                r = Run(work / f"{mesh}-{held}-{p}")
                if r.code:
                    rows.append([f"({mesh})", edges, p, f"{r.travel[-1]:.2f}", r.reason])
    return table(["mesh", "edges", "p, N/mm", "last accepted, mm", "`reason` in status.csv"], rows)


def cutback(work):
    """Mesh (a) with free edges and cut-back."""
    rows = []
    for p in PENALTIES:
        r = Run(work / f"cutback-{p}")
        rows.append([p, f"{r.travel[-1]:.1f}", f"{r.increments}", f"{r.retries}", f"{r.force[-1]:.0f}", f"{r.seconds:.1f}"])
    return table(["p, N/mm", "reached, mm", "increments", "cut-backs", "punch force there, N", "processor time, s"], rows)


def penalties(work):
    """Punch forces of mesh (b) at equal travel, for each p."""
    runs = {p: Run(work / f"b-corner-{p}") for p in PENALTIES}
    rows = [[f"{t}"] + [f"{r.force_at(t):.1f}" if t <= r.travel[-1] else "-" for r in runs.values()] for t in range(5, 41, 5)]
    return table(["travel, mm"] + [f"p = {p}, N" for p in PENALTIES], rows)


def agreement(work):
    """How far the punch force depends on p."""
    rows = []
    for mesh in MESHES:
        for edges, held in EDGES.items():
            base = Run(work / f"{mesh}-{held}-1e4")
            for p in PENALTIES:
                if p != "1e4":
                    other = Run(work / f"{mesh}-{held}-{p}")
                    rows.append([f"({mesh})", edges, f"{p} and 1e4", difference_cells(other, base)])
    return table(["mesh", "edges", "p, N/mm", "largest difference", "median"], rows)


def halved(work):
    """What halving the limits of the predictor changes, mesh (b)."""
    rows = []
    for p in PENALTIES:
        whole, half = Run(work / f"b-corner-{p}"), Run(work / f"halved-{p}")
        rows.append([p, f"{half.travel[-1]:.1f}", f"{whole.increments}", f"{half.increments}", difference_cells(half, whole)])
    return table(["p, N/mm", "reached, mm", "increments", "with halved limits", "largest difference of the force", "median"], rows)


def holder(work):
    """The whole blank-holder force on the half model, and half of it; mesh (b)."""
    rows = []
    for force, name in (("22.6", "b-corner-1e3"), ("11.3", "holder-11300")):
        r = Run(work / name)
        rows.append([force, f"{r.travel[-1]:.1f}", f"{r.increments}"] + [f"{r.force_at(t):.0f}" for t in (10, 20, 30, 40)])
    return table(["blank-holder, kN", "reached, mm", "increments"] + [f"force at {t} mm, N" for t in (10, 20, 30, 40)], rows)


def limiters(work):
    """Which limiter set the increments."""
    rows = []
    for name, run_name in (("(a), u_y = 0", "a-all-1e3"), ("(b), free", "b-corner-1e3"), ("(b), u_y = 0", "b-all-1e3"), ("fine", "fine")):
        shares = Run(work / run_name).limiters()
        rows.append([name, ", ".join(f"{key} {value:.1f} %" for key, value in shares.items())])
    return table(["mesh (p = 1e3)", "increments of `draw` limited by"], rows)


def fine(work):
    """The mesh that resolves the radii."""
    rows = []
    for p, name in (("1e3", "fine"), ("1e4", "fine-1e4")):
        r = Run(work / name)
        rows.append([p, f"{r.travel[-1]:.1f}", f"{r.increments}", f"{r.retries}", f"{r.iterations:.2f}",
                     f"{r.force_at(r.travel[-1]):.1f}", f"{r.seconds:.1f}", f"{r.memory:.0f}"])
    return table(["p, N/mm", "reached, mm", "increments", "cut-backs", "iterations per increment", "punch force there, N",
                  "processor time, s", "memory, MB"], rows)


TABLES = {f.__name__: f for f in (stops, reasons, cutback, penalties, agreement, halved, holder, limiters, fine)}


def write(document, tables):
    """Puts the tables into a document."""
    text = document.read_text(encoding="utf-8")
    for name, content in tables.items():
        pattern = re.compile(rf"(<!-- table: {name} -->\n).*?(<!-- end of table -->)", re.DOTALL)
        if not pattern.search(text):
            sys.exit(f"{document}: there is no place for the table {name}")
        text = pattern.sub(lambda found, content=content: f"{found[1]}\n{content}\n\n{found[2]}", text)
    document.write_text(text, encoding="utf-8")


def main():
    """Runs, then prints."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, default=Path("build/release/dd3imp"))
    parser.add_argument("--work", type=Path, default=Path("bending_tables.out"))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--reuse", action="store_true")
    parser.add_argument("--write", type=Path, metavar="DOCUMENT")
    options = parser.parse_args()
    if options.jobs < 1:
        parser.error("--jobs takes 1 or more")
    program = scripts.program_at(options.program)
    if options.write and not options.write.is_file():
        sys.exit(f"{options.write}: no such file")
    with ThreadPoolExecutor(options.jobs) as pool:
        for result in [pool.submit(run, program, options.work, *job, options.reuse) for job in jobs()]:
            result.result()
    tables = {name: make(options.work) for name, make in TABLES.items()}
    if options.write:
        write(options.write, tables)
    for name, content in tables.items():
        print(f"{TABLES[name].__doc__}\n\n{content}\n")


if __name__ == "__main__":
    scripts.run(main)
