#!/usr/bin/env python3
"""One case of the bending study, and the table of all: the steps of utils/study.smk. Needs Python alone.

    utils/study.py command b-1e3              prints the plain command of a case
    utils/study.py case b-1e3                 runs a case, unless it is done, into bending_study.out/b-1e3/
    utils/study.py table                      gathers the cases that are done into bending_study.out/results.csv
    utils/study.py report docs/reports/bending_study.md      writes the document's tables anew from results.csv

A case is a row of input_files/bending_study/cases.csv; its columns beyond `case` and `set` are parameters of
study.dat beside it, an empty cell leaves the value that stands there. The file run.json in a case's folder says that
the case is done: with exit code 0 it reached its end, with 3 it stopped before; both are results.
"""

import argparse
import csv
import hashlib
import json
import os
import re
import resource
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path

from scripts import program_at, run

ROOT = Path(__file__).resolve().parent.parent
LIMITERS = ["rotation", "strain", "stress", "force", "first contact", "r_max", "r_min"]
# Travel at which the punch force is noted, mm.
PLACES = [1, 2, 5, 10, 15, 20, 30, 40]
# Sheet that lies beyond the die's radius at the start, mm.
FLANGE = 35.0
# The blank of study.dat: nodes in a section and through the thickness, its length and width, and elements along it.
NODES_IN_SECTION, NODES_THROUGH = 12, 3
LENGTH, WIDTH, ELEMENTS = 175.0, 35.0, 10


def read_table(path):
    """The rows of a csv file; lines that begin with # are left out."""
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def read_cases(path):
    """The rows of the table of cases by their names."""
    rows = read_table(path)
    cases = {row["case"]: row for row in rows}
    if len(cases) != len(rows):
        sys.exit(f"{path}: a case stands there twice")
    return cases


def row_of(cases, options):
    """The row of the case that is asked for."""
    if options.case not in cases:
        sys.exit(f"{options.cases}: no case '{options.case}'")
    return cases[options.case]


def parameters(row):
    """What a case sets."""
    return {name: value for name, value in row.items() if name not in ("case", "set") and value}


def command(row, options, folder):
    """The command of a case, as a list of words."""
    words = [str(options.program), "--threads", "1", "--output", str(folder)]
    for name, value in parameters(row).items():
        words += ["--set", f"{name}={value}"]
    return words + [str(options.cases.parent / "study.dat")]


def digest(*paths):
    """What tells one program, or one set of files, from another."""
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()[:12]


def deck_files(options):
    """The input file and the tools' surfaces."""
    folder = options.cases.parent
    return [folder / "study.dat", *sorted((folder.parent / "bending").glob("*.bez"))]


def run_case(options):
    """Runs a case; the note that it is done comes last, in one piece."""
    cases = read_cases(options.cases)
    row = row_of(cases, options)
    program_at(options.program)
    folder = options.work / options.case
    note = folder / "run.json"
    words, deck = command(row, options, folder), digest(*deck_files(options))
    if note.exists():
        done = json.loads(note.read_text(encoding="utf-8"))
        if done["command"] == shlex.join(words) and done["deck"] == deck:
            print(f"{options.case}: done before")
            return
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    words.insert(1, "--quiet")
    began, before = time.time(), resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run(words, stderr=subprocess.PIPE, text=True, env=environment, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 3):
        sys.exit(f"{shlex.join(words)}: exit code {done.returncode}\n{done.stderr}")
    words.pop(1)
    result = {"code": done.returncode, "seconds": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
              "wall": time.time() - began, "program": digest(options.program), "deck": deck, "command": shlex.join(words)}
    aside = folder / "run.json.new"
    aside.write_text(json.dumps(result), encoding="utf-8")
    aside.rename(note)
    last = read_table(folder / "history.csv")[-1]
    shown = [name for name, row in cases.items() if not options.sets or row["set"] in options.sets]
    finished = sum((options.work / name / "run.json").exists() for name in shown)
    print(f"[{finished}/{len(shown)}] {options.case}: {float(last['travel']):.2f} mm, "
          f"{last['increment']} increments, {result['seconds']:.1f} s{'' if result['code'] == 0 else ', stopped'}",
          file=sys.stderr)


def abscissa(node, skew):
    """Initial distance of a node from the plane of symmetry, mm."""
    section, across = (node - 1) // NODES_IN_SECTION, (node - 1) % NODES_IN_SECTION // NODES_THROUGH
    y = across / (NODES_IN_SECTION // NODES_THROUGH - 1) * WIDTH
    inner = 0 < section < ELEMENTS
    return LENGTH / ELEMENTS * (section + (skew * (y / WIDTH - 0.5) if inner else 0.0))


def controlling(status):
    """Travel, node, tool and B of the force limit in each increment of the stroke."""
    for row in status:
        found = re.match(r"node (\d+) tool (\S+) B=(\S+)", row["force_at"])
        if found and row["phase"] == "draw":
            yield float(row["travel"]), int(found[1]), found[2], float(found[3])


def force_at(history, place):
    """Punch force at a travel by linear interpolation between increments; empty beyond the end."""
    rows = [(float(row["travel"]), float(row["punch_fz"])) for row in history if row["phase"] == "draw"]
    for (t0, f0), (t1, f1) in zip(rows, rows[1:]):
        if t1 >= place - 1e-9 and t1 > t0:
            return f"{f0 + (place - t0) / (t1 - t0) * (f1 - f0):.3f}"
    return ""


def summary(folder, skew):
    """What a finished case came to."""
    result = json.loads((folder / "run.json").read_text(encoding="utf-8"))
    history, status = read_table(folder / "history.csv"), read_table(folder / "status.csv")
    accepted = [row for row in status if row["outcome"] == "accepted"]
    drawn = [row["limiter"] for row in accepted if row["phase"] == "draw"]
    row = {"code": result["code"], "travel": f"{float(history[-1]['travel']):.3f}", "increments": len(accepted),
           "newton_iterations": sum(int(r["iterations"]) for r in status),
           "linear_iterations": sum(int(r["solver_iterations"]) for r in status),
           "cutbacks": sum(r["outcome"] == "retry" for r in status),
           "seconds": f"{result['seconds']:.2f}", "wall": f"{result['wall']:.2f}"}
    for name in LIMITERS:
        row["share_" + name.replace(" ", "_")] = f"{100 * drawn.count(name) / max(1, len(drawn)):.2f}"
    nodes = list(controlling(status))
    values = sorted(b for _, _, _, b in nodes)
    row["B_median"] = f"{values[len(values) // 2]:.4g}" if values else ""
    beyond = sum(tool != "punch" and abscissa(node, skew) >= FLANGE - 1e-6 for _, node, tool, _ in nodes)
    row["flange"] = f"{100 * beyond / len(nodes):.2f}" if nodes else ""
    for place in PLACES:
        row[f"force_{place}"] = force_at(history, place)
    row["reason"] = "" if result["code"] == 0 else status[-1]["reason"]
    row["program"], row["command"] = result["program"], result["command"]
    return row


def gather(options):
    """Writes results.csv: a row for each case that is done."""
    cases = read_cases(options.cases)
    names = [name for name in (options.only or cases) if (options.work / name / "run.json").exists()]
    unknown = [name for name in names if name not in cases]
    if unknown:
        sys.exit(f"{options.cases}: no case '{unknown[0]}'")
    if not names:
        sys.exit(f"{options.work}: no case is done")
    rows = []
    for name in names:
        skew = float(parameters(cases[name]).get("skew", "1"))
        rows.append({**cases[name], **summary(options.work / name, skew)})
    if len({row["program"] for row in rows}) > 1:
        print("results.csv: not all cases were run by the same program, see its column", file=sys.stderr)
    aside = options.work / "results.csv.new"
    with open(aside, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    aside.rename(options.work / "results.csv")
    stopped = sum(row["code"] == 3 for row in rows)
    print(f"results.csv: {len(rows)} cases, of them {stopped} stopped before their end", file=sys.stderr)


def main():
    """Does one step."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    steps = parser.add_subparsers(dest="step", required=True)
    for name in ("command", "case", "table", "report"):
        step = steps.add_parser(name)
        if name in ("command", "case"):
            step.add_argument("case")
            step.add_argument("--sets", nargs="*", help="sets that the display counts (default: all)")
        elif name == "report":
            step.add_argument("document", type=Path)
        else:
            step.add_argument("--only", nargs="+", metavar="CASE", help="leave out the others")
        step.add_argument("--program", type=Path, default=ROOT / "build" / "release" / "dd3imp")
        step.add_argument("--cases", type=Path, default=ROOT / "input_files" / "bending_study" / "cases.csv")
        step.add_argument("--work", type=Path, default=Path("bending_study.out"), help="folder of all results")
    options = parser.parse_args()
    options.program, options.cases, options.work = (
        path.resolve() for path in (options.program, options.cases, options.work))
    if options.step == "command":
        print(shlex.join(command(row_of(read_cases(options.cases), options), options, options.work / options.case)))
    elif options.step == "case":
        run_case(options)
    elif options.step == "table":
        gather(options)
    else:
        import study_report
        study_report.write(options.work, options.document)


if __name__ == "__main__":
    run(main)
