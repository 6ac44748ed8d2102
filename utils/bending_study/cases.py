# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of the bending study: run one, or gather the table of all; the steps of workflow.smk.

    python3 -m bending_study command b-1e3       print the command of a case
    python3 -m bending_study case b-1e3          run a case, unless it is done, in bending_study.out/b-1e3/
    python3 -m bending_study table               gather the finished cases in bending_study.out/results.csv

A case is a row of bending_study/cases.csv of the examples, or of --cases. Its columns other than `case` and `set` are
parameters of study.dat in the same folder; an empty cell keeps the default of study.dat. A case is done when its folder
has a done.json: exit code 0 means that the run reached its end, 3 that it stopped before. Both are results.
"""

import argparse
import csv
import hashlib
import json
import shlex
import shutil
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from bending_study.runs import NOTE, punch_curve, run_once
from dd3 import places, programs
from dd3.command import new_parser
from dd3.errors import Problem
from dd3.tables import Row, force_limits, interpolate, limiters, read_table, totals

DECK, OPTIONS = "study.dat", ("--threads", "1")
LIMITERS = ["rotation", "strain", "stress", "force", "first contact", "r_max", "r_min"]
# Travels at which the punch force is tabulated, mm.
PLACES = [1, 2, 5, 10, 15, 20, 30, 40]
# Distance from the plane of symmetry beyond which a node is in the flange, mm: the end of the die's radius.
FLANGE = 35.0
# The blank of study.dat: nodes per section and through the thickness; length and width, mm; elements along x.
NODES_IN_SECTION, NODES_THROUGH = 12, 3
LENGTH, WIDTH, ELEMENTS = 175.0, 35.0, 10


def arguments(step: str, words: Sequence[str]) -> argparse.Namespace:
    """Return the options of a step."""
    parser = new_parser(step, __doc__, "python3 -m bending_study")
    if step == "table":
        parser.add_argument("--only", nargs="+", metavar="CASE", help="leave out the others")
    else:
        parser.add_argument("case", help="name of a case")
        parser.add_argument("--sets", nargs="*", help="sets that the display counts (default: all)")
    programs.add_program(parser)
    parser.add_argument("--cases", type=Path, help="table of the cases (bending_study/cases.csv of the examples)")
    parser.add_argument("--work", type=Path, default=Path("bending_study.out"), help="folder of all results")
    options = parser.parse_args(words)
    options.cases = (options.cases or places.examples() / "bending_study" / "cases.csv").resolve()
    options.work = options.work.resolve()
    return options


def print_command(words: Sequence[str]) -> None:
    """Print the command of a case."""
    options = arguments("command", words)
    row = row_of(read_cases(options.cases), options)
    options.program = programs.find_program(options.program)
    print(shlex.join(command(row, options, options.work / options.case)))


def read_cases(path: Path) -> dict[str, Row]:
    """Return the rows of the table of cases by their names."""
    rows = read_table(path, "case", "set")
    cases = {row["case"]: row for row in rows}
    if len(cases) != len(rows):
        raise Problem(f"{path}: two rows have the same case")
    return cases


def row_of(cases: Mapping[str, Row], options: argparse.Namespace) -> Row:
    """Return the row of the case of the command line."""
    if options.case not in cases:
        raise Problem(f"{options.cases}: no case '{options.case}'")
    return cases[options.case]


def parameters(row: Row) -> dict[str, str]:
    """Return the parameters that a case sets."""
    return {name: value for name, value in row.items() if name not in ("case", "set") and value}


def command(row: Row, options: argparse.Namespace, folder: Path) -> list[str]:
    """Return the command of a case as a list of words."""
    return programs.command(options.program, options.cases.parent / DECK, folder, OPTIONS, parameters(row))


def digest(*paths: Path) -> str:
    """Return the first digits of the SHA-256 of files."""
    return hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()[:12]


def deck_files(options: argparse.Namespace) -> list[Path]:
    """Return the input file and the tools' surfaces."""
    folder = options.cases.parent
    return [folder / DECK, *sorted((folder.parent / "bending").glob("*.bez"))]


def is_done(note: Path, words: Sequence[str], deck: str) -> bool:
    """Check for a finished run of the same command and input."""
    if not note.exists():
        return False
    done = json.loads(note.read_text(encoding="utf-8"))
    return bool(done["command"] == shlex.join(words) and done["deck"] == deck)


def run_case(words: Sequence[str]) -> None:
    """Run a case unless it is done. done.json is written last, and renamed, so that it marks a finished run."""
    options = arguments("case", words)
    cases = read_cases(options.cases)
    row = row_of(cases, options)
    options.program = programs.find_program(options.program)
    folder = options.work / options.case
    note = folder / NOTE
    call, deck = command(row, options, folder), digest(*deck_files(options))
    if is_done(note, call, deck):
        print(f"{options.case}: done before")
        return
    shutil.rmtree(folder, ignore_errors=True)
    done = run_once(folder, options.program, options.cases.parent / DECK, parameters(row), *OPTIONS)
    aside = folder / f"{NOTE}.new"
    aside.write_text(json.dumps({"code": done.code, "seconds": done.cpu, "wall": done.wall,
                                 "program": digest(options.program), "deck": deck, "command": shlex.join(call)}),
                     encoding="utf-8")
    aside.rename(note)
    report_progress(options, cases, folder, done)


def report_progress(options: argparse.Namespace, cases: Mapping[str, Row], folder: Path, done: programs.Finished
                    ) -> None:
    """Print one line on the case that has ended and on how many are done."""
    last = read_table(folder / "history.csv")[-1]
    shown = [name for name, row in cases.items() if not options.sets or row["set"] in options.sets]
    finished = sum((options.work / name / NOTE).exists() for name in shown)
    print(f"[{finished}/{len(shown)}] {options.case}: {float(last['travel']):.2f} mm, "
          f"{last['increment']} increments, {done.cpu:.1f} s{'' if done.code == 0 else ', stopped'}",
          file=sys.stderr)


def abscissa(node: int, skew: float) -> float:
    """Return the initial distance of a node from the plane of symmetry, mm."""
    section, transverse = (node - 1) // NODES_IN_SECTION, (node - 1) % NODES_IN_SECTION // NODES_THROUGH
    y = transverse / (NODES_IN_SECTION // NODES_THROUGH - 1) * WIDTH
    inner = 0 < section < ELEMENTS
    return LENGTH / ELEMENTS * (section + (skew * (y / WIDTH - 0.5) if inner else 0.0))


def force_at(history: Sequence[Row], place: float) -> str:
    """Return the punch force at a travel as a text, interpolated between increments; empty beyond the end."""
    force = interpolate(*punch_curve(history), place)
    return "" if force is None else f"{force:.3f}"


def force_columns(status: Sequence[Row], skew: float) -> dict[str, str]:
    """Return the median of B and the percentage of its nodes that lie in the flange."""
    limits = list(force_limits(status, "draw"))
    if not limits:
        return {"B_median": "", "flange": ""}
    values = sorted(size for *_, size in limits)
    beyond = sum(tool != "punch" and abscissa(node, skew) >= FLANGE - 1e-6 for _, node, tool, _ in limits)
    return {"B_median": f"{values[len(values) // 2]:.4g}", "flange": f"{100 * beyond / len(limits):.2f}"}


def summary(folder: Path, skew: float) -> dict[str, object]:
    """Return the columns of results.csv for a finished case."""
    done = json.loads((folder / NOTE).read_text(encoding="utf-8"))
    history = read_table(folder / "history.csv")
    status = read_table(folder / "status.csv", "force_node", "force_tool", "force_size")
    total, drawn = totals(status), limiters(status, "draw")
    return {
        "code": done["code"], "travel": f"{float(history[-1]['travel']):.3f}", "increments": total.increments,
        "newton_iterations": total.iterations, "linear_iterations": total.solver_iterations,
        "cutbacks": total.cutbacks, "seconds": f"{done['seconds']:.2f}", "wall": f"{done['wall']:.2f}",
        **{"percent_" + name.replace(" ", "_"): f"{100 * drawn.count(name) / max(1, len(drawn)):.2f}"
           for name in LIMITERS},
        **force_columns(status, skew), **{f"force_{place}": force_at(history, place) for place in PLACES},
        "reason": "" if done["code"] == 0 else status[-1]["reason"],
        "program": done["program"], "command": done["command"]}


def gather(words: Sequence[str]) -> None:
    """Write results.csv: a row for each case that is done."""
    options = arguments("table", words)
    cases = read_cases(options.cases)
    names = [name for name in (options.only or cases) if (options.work / name / NOTE).exists()]
    unknown = [name for name in names if name not in cases]
    if unknown:
        raise Problem(f"{options.cases}: no case '{unknown[0]}'")
    if not names:
        raise Problem(f"{options.work}: no case is done")
    rows = []
    for name in names:
        skew = float(parameters(cases[name]).get("skew", "1"))
        rows.append({**cases[name], **summary(options.work / name, skew)})
    if len({row["program"] for row in rows}) > 1:
        print("results.csv: the cases were run by different programs, see the column `program`", file=sys.stderr)
    aside = options.work / "results.csv.new"
    with aside.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    aside.rename(options.work / "results.csv")
    stopped = sum(row["code"] == 3 for row in rows)
    print(f"results.csv: {len(rows)} cases, {stopped} of them stopped before their end", file=sys.stderr)
