#!/usr/bin/env python3
"""Measure what each remedy of the corrector is worth: forming problems with all remedies and without one of them.

    tests/benchmark/ablation.py --program build/release/dd3imp --work build/ablation
    tests/benchmark/ablation.py ... --problems capstan,air --settings all,damping --jobs 2
    tests/benchmark/ablation.py ... --problems draw --limit 900 --write

--problems and --settings take parts of names. Every run writes its row to `rows` in the work folder; --write puts the
last row of each run there into the table of docs/reports/ablation.md, whose other rows stay; --no-run only does that.
A run that takes longer than --limit seconds is ended; its row says how far it came. The times are processor times.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import time

from problems import PROBLEMS, ROOT, with_paths, with_settings

sys.path.insert(0, str(ROOT / "utils"))
from results import command, find_program, is_whole, read_table  # noqa: E402
from scripts import Problem, run  # noqa: E402

OFF = {"damping": "damping = off", "steering": "target_iterations = 0"}
SETTINGS = {"all": ((), None), **{f"no {name}": ((key,), None) for name, key in OFF.items()},
            "none of these": (tuple(OFF.values()), None), **{f"p = {p:g}": ((), p) for p in (1e2, 1e3, 1e4, 1e5)},
            "none of these; p = 10000": (tuple(OFF.values()), 1e4)}
REPORT = ROOT / "docs" / "reports" / "ablation.md"
HEAD = ("problem", "remedies", "end", "increments", "iterations", "wasted, %", "damped", "time, s", "result")
# Column of history.csv and unit of the result; for the capstan, the quotient of the forces at the ends.
RESULT = {"capstan": ("left_rx", "T1/T2"), "stretching by a force": ("punch_uz", "mm")}
DEAD_LOAD = 1.0  # of the capstan, N


def execute(words, limit):
    """Run a command; return its exit code (None after the limit, s), processor time, s, and errors."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=environment) as child:
        late, began, used = False, time.monotonic(), 0.0
        while child.poll() is None:
            time.sleep(0.05)
            used = processor_time(child.pid) or used
            if used > limit and not late:
                late, began = True, time.monotonic()
                child.send_signal(signal.SIGTERM)
            if late and time.monotonic() - began > 60:
                child.kill()
        errors = child.stderr.read().decode("utf-8", errors="replace")
    return None if late else child.returncode, used, errors


def processor_time(pid):
    """Return the processor time of a process, s; 0 if it has ended."""
    try:
        words = pathlib.Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def measure(options, problem, setting):
    """Run a problem with a setting; return its row."""
    newton, penalty = SETTINGS[setting]
    folder = options.work / re.sub(r"\W+", "_", f"{problem} {setting}")
    folder.mkdir(parents=True, exist_ok=True)
    deck = folder / "deck.dat"
    deck.write_text(with_settings(with_paths(PROBLEMS[problem](folder), folder), newton, penalty), encoding="utf-8")
    code, seconds, errors = execute(command(options.program, deck, folder / "results", ["--quiet"]), options.limit)
    if code not in (0, 3, None):
        raise Problem(f"{deck}: exit code {code}: {errors}")
    status = [row for row in read_table(folder / "results" / "status.csv") if is_whole(row)]
    history = [row for row in read_table(folder / "results" / "history.csv") if is_whole(row)]
    row = [problem, setting, end_text(code, history[-1], deck), *counts(status), f"{seconds:.3g}"]
    row.append(result_text(problem, history[-1]))
    if code == 3:
        print(f"{problem}, {setting}: {errors.strip()}", file=sys.stderr)
    return row


def counts(status):
    """Return increments, iterations, the part of the iterations in failed attempts, and the number of those damped."""
    iterations = sum(int(row["iterations"]) for row in status)
    accepted = [row for row in status if row["outcome"] == "accepted"]
    wasted = iterations - sum(int(row["iterations"]) for row in accepted)
    damped = sum(int(row["damped"]) for row in status)
    return [str(len(accepted)), str(iterations), f"{100 * wasted / max(iterations, 1):.1f}", str(damped)]


def end_text(code, last, deck):
    """Return how a run ended."""
    phases = re.findall(r"^\*PHASE (\w+)", deck.read_text(encoding="utf-8"), re.MULTILINE)
    if code == 0:
        return "reached"
    place = f"{phases[int(last['phase']) - 1] if last['phase'].isdigit() else last['phase']} " \
            f"{100 * float(last['progress']):.0f} %"
    return ("limit of time in " if code is None else "stopped in ") + place


def result_text(problem, last):
    """Return the result of a run with its unit."""
    column, unit = RESULT.get(problem, ("punch_fz", "N"))
    value = float(last[column])
    if unit == "T1/T2":
        if last["phase"] not in ("3", "pull"):
            return ""
        value = -DEAD_LOAD * float(last["progress"]) / value
    return f"{value:.5g} {unit}"


def write_report(rows):
    """Put rows into the table of the report."""
    lines = REPORT.read_text(encoding="utf-8").split("\n")
    start = lines.index("| " + " | ".join(HEAD) + " |") + 2
    end = next(i for i in range(start, len(lines)) if not lines[i].startswith("|"))
    table = {tuple(cells[:2]): cells for cells in ([cell.strip() for cell in text.split("|")[1:-1]]
                                                   for text in lines[start:end])}
    table.update({tuple(row[:2]): row for row in rows})
    order = [(problem, setting) for problem in PROBLEMS for setting in SETTINGS]
    lines[start:end] = ["| " + " | ".join(table[key]) + " |" for key in order if key in table]
    REPORT.write_text("\n".join(lines), encoding="utf-8")


def chosen(names, parts):
    """Return the names that contain one of the parts, separated by commas; all without parts."""
    found = [name for name in names if not parts or any(part == name or (part in name and part != "all")
                                                        for part in parts.split(","))]
    if not found:
        raise Problem(f"none of {', '.join(names)} contains one of {parts}")
    return found


def main():
    """Run the chosen problems with the chosen settings."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", required=True, type=pathlib.Path)
    parser.add_argument("--problems", help="parts of the names of problems, separated by commas")
    parser.add_argument("--settings", help="parts of the names of settings, separated by commas")
    parser.add_argument("--limit", type=float, default=600.0, help="processor time of a run, s (600)")
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time (1)")
    parser.add_argument("--write", action="store_true", help="put the rows into docs/reports/ablation.md")
    parser.add_argument("--no-run", action="store_true", help="run nothing, with --write")
    options = parser.parse_args()
    options.program, options.work = find_program(options.program), options.work.resolve()
    keys = [(problem, setting) for problem in chosen(PROBLEMS, options.problems)
            for setting in chosen(SETTINGS, options.settings)]
    options.work.mkdir(parents=True, exist_ok=True)
    if options.no_run:
        keys = []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for row in pool.map(lambda key: measure(options, *key), keys):
            print("| " + " | ".join(row) + " |", flush=True)
            with (options.work / "rows").open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
    if options.write:
        write_report([json.loads(row) for row in (options.work / "rows").read_text(encoding="utf-8").splitlines()])


if __name__ == "__main__":
    run(main)
