#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make the tables of docs/reports/speed.md on sheets of several sizes anew.

    tests/benchmark/speed.py --program build/release/dd3imp
    tests/benchmark/speed.py --program build/release/dd3imp --elements 800 1800 3200 7200 20000 --threads 1 2 --write

Quarters of the square cup of input_files/square_cup, n x n x 2 hex8, limits 0.1 and 5 degrees. Each job makes
--increments increments and is stopped. Processor time per iteration is that of the job less that of a check of the
input, which has the same set-up; predictions are not counted as iterations. The exponent of growth is that of the line
through the logarithms. --write puts the table into docs/reports/speed.md.
"""

import argparse
import math
import os
import re
import signal
import subprocess
import tempfile
import time
from pathlib import Path

from dd3 import programs, tables
from dd3.errors import Problem, run
from dd3.pages import put_table

ROOT = Path(__file__).resolve().parents[2]

CUP = ROOT / "input_files" / "square_cup" / "square_cup.dat"
PAGE = ROOT / "docs" / "reports" / "speed.md"
CHANGES = (("  thickness_points = ${points}\n", ""), ("element = solid_shell", "element = hex8"),
           ("*PHASE clamp", "*LIMITS\n  strain = 0.1\n  rotation = 5\n\n*PHASE clamp"),
           ("../materials/", f"{ROOT}/input_files/materials/"), ("tools = .", f"tools = {CUP.parent}"))


def make_deck(folder):
    """Write the input file of the cup with hex8; return its path."""
    text = CUP.read_text(encoding="utf-8")
    for old, new in CHANGES:
        if text.count(old) != 1:
            raise Problem(f"{CUP}: '{old}' occurs {text.count(old)} times")
        text = text.replace(old, new)
    deck = folder / "cup.dat"
    deck.write_text(text, encoding="utf-8")
    return deck


def accepted(folder):
    """Return the number of accepted increments and of all iterations in status.csv; zeros before there is one."""
    if not (folder / "status.csv").exists():
        return 0, 0
    rows = [row for row in tables.read_table(folder / "status.csv") if row.get("outcome")]
    return sum(row["outcome"] == "accepted" for row in rows), sum(int(row["iterations"]) for row in rows)


def part_of_run(program, deck, folder, settings, arguments):
    """Make a number of increments and stop; return iterations, processor time (s) and peak memory (MB)."""
    words = programs.command(program, deck, folder, ["--quiet", "--threads", arguments.now], settings)
    with subprocess.Popen(words, stderr=subprocess.DEVNULL) as child:
        while child.poll() is None and accepted(folder)[0] < arguments.increments:
            time.sleep(0.2)
        if child.returncode is not None:
            raise Problem(f"{' '.join(words)}: ended after {accepted(folder)[0]} increments")
        child.send_signal(signal.SIGTERM)
        _, code, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(code)
    return accepted(folder)[1], usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024 / 1e6


def measure(program, deck, elements, arguments):
    """Return the row of a mesh: elements, unknowns, iterations, time of one (s), memory stated and used (MB)."""
    n = round(math.sqrt(elements / 2))
    settings = {"divisions": f"{n} {n} 2", "levels": 0}
    checked = programs.launch(programs.command(program, deck, None, ["--check"], settings))
    size = re.search(r"(\d+) unknowns.*\nmemory: about (\d+) MB", checked.output)
    if not size:
        raise Problem(f"--check of {2 * n * n} elements:\n{checked.errors}")
    with tempfile.TemporaryDirectory(prefix="dd3imp_") as folder:
        iterations, cpu, memory = part_of_run(program, deck, Path(folder) / "out", settings, arguments)
    return 2 * n * n, int(size[1]), iterations, (cpu - checked.cpu) / iterations, int(size[2]), memory


def exponent(rows):
    """Return the exponent of the growth of the time per iteration with the number of elements."""
    x, y = ([math.log(row[i]) for row in rows] for i in (0, 3))
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return (sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x))


def table(rows, threads):
    """Return the table of a number of threads as Markdown."""
    lines = [f"Processor time per iteration with {threads} thread{'s' if threads > 1 else ''}:", "",
             "| elements | unknowns | iterations | s per iteration | memory stated, MB | used |",
             "|---|---|---|---|---|---|"]
    lines += [f"| {row[0]} | {row[1]} | {row[2]} | {row[3]:.3g} | {row[4]} | {row[5]:.0f} |" for row in rows]
    if len(rows) > 1:
        lines += ["", f"Exponent of growth: {exponent(rows):.2f}."]
    return "\n".join(lines)


def main():
    """Measure and print, and write if asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, type=programs.find_program, help="the program dd3imp")
    parser.add_argument("--elements", nargs="+", type=int, default=[800, 1800, 3200, 7200, 20000],
                        help="numbers of elements (800 1800 3200 7200 20000)")
    parser.add_argument("--threads", nargs="+", type=int, default=[1], help="numbers of threads (1)")
    parser.add_argument("--increments", type=int, default=4, help="increments of each job (4)")
    parser.add_argument("--write", action="store_true", help="write docs/reports/speed.md")
    arguments = parser.parse_args()
    texts, jobs = [], []
    with tempfile.TemporaryDirectory(prefix="dd3imp_") as folder:
        deck = make_deck(Path(folder))
        for threads in arguments.threads:
            arguments.now = threads
            rows = [measure(arguments.program, deck, elements, arguments) for elements in arguments.elements]
            texts.append(table(rows, threads))
            print(texts[-1], flush=True)
            jobs.append(programs.description(arguments.program, threads))
    if arguments.write:
        put_table(PAGE, "sizes", "\n\n".join(texts), jobs)


if __name__ == "__main__":
    run(main)
