#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make the pages of docs/reports and the gallery anew, and check their stamps.

    utils/dev/pages.py                    all that together take less than an hour, the quick ones first
    utils/dev/pages.py rail square_cup    these
    utils/dev/pages.py --all              all
    utils/dev/pages.py --list             print minutes, commits and age of each
    utils/dev/pages.py --check            check that each table of figures has a stamp, and list the old pages

The program has to be built from a commit without changes. Its runs are kept in build/pages/<commit>: after an
interruption the same command continues. A page is old if a later commit changes the sources that it depends on.
"""

import argparse
import os
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path

from dd3.errors import Problem, run
from dd3.pages import STAMP
from dd3.programs import description, find_program, made_folder

ROOT = Path(__file__).resolve().parents[2]
REPORTS = ROOT / "docs" / "reports"
GALLERY = ROOT / "docs" / "gallery.md"
BLOCK = re.compile(r"<!-- table: (.*?) -->\n(.*?)<!-- end of table -->\n", re.DOTALL)
TABLE = re.compile(r"(<!-- no measurement -->\n)?((?:^\|.*\n)+)(?=\n*(.*))", re.MULTILINE)
ONCE = "measured once"  # stamp of a table that no script makes
HOUR = 60
RUN = " --program {program} --work {work} --write"
MECHANICS = "src/contact src/element src/material src/model src/process src/setup src/system src/tools"


@dataclass
class Page:
    """Commands that make a page, minutes on one core, and the sources that its figures depend on."""

    minutes: int
    sources: str
    commands: tuple[str, ...]


def forming(name: str, minutes: int) -> Page:
    """Return the page of a script of tests/forming."""
    return Page(minutes, f"{MECHANICS} input_files/{name}", (f"tests/forming/{name}.py{RUN}",))


def envelope(options: str) -> str:
    """Return the command of envelope.py, whose runs all pages share."""
    return "tests/benchmark/envelope.py --program {program} --work {envelope} " + options


def labelled(label: str, **blocks: str) -> str:
    """Return the command of the runs of a label."""
    return envelope(f"--label {label}" + "".join(f" --{name} '{lines}'" for name, lines in blocks.items()))


BENDING = f"{MECHANICS} input_files/bending"
OFF, MIXED, COMPLIANT = "line_search = off", "formulation = mixed", "formulation = compliant"
# The mixed formulation takes too long on the others.
MIXED_PROBLEMS = ("holder_gap first_contact flat_punch air_bending capstan u_bend strip_19.6kN_2mm strip_2.45kN_2mm "
                  "aluminium_15 steel_15")
PAGES = {
    "ablation": Page(12, MECHANICS, (
        labelled("compliant", contact=COMPLIANT),
        labelled("no_elimination", contact=COMPLIANT, newton="elimination = off"),
        labelled("no_line_search", contact=COMPLIANT, newton=OFF),
        labelled("mixed", contact=MIXED) + f" --problems {MIXED_PROBLEMS}",
        labelled("mixed_no_line_search", contact=MIXED, newton=OFF) + f" --problems {MIXED_PROBLEMS}",
        envelope("--compare compliant no_elimination no_line_search mixed mixed_no_line_search --ablation"))),
    "adaptive": Page(20, f"{MECHANICS} src/run/adaptivity.f90 src/sheet input_files/square_cup",
                     (f"tests/forming/adaptive.py{RUN}", f"tests/forming/conical_cup.py{RUN}")),
    "examples": Page(60, f"{MECHANICS} src/run/adaptivity.f90 src/sheet input_files",
                     (f"tests/forming/examples.py{RUN}",)),
    "bending_criteria": Page(2, f"{BENDING} tests/cases/bending_criteria",
                             (f"tests/benchmark/bending_criteria.py{RUN}",)),
    "bending_study": Page(25, f"{BENDING} input_files/bending_study", (
        "-m bending_study run --program {program} --work {work} --cores 1",
        "-m bending_study figures --work {work} --output docs/images",
        "-m bending_study report docs/reports/bending_study.md --work {work}")),
    "bending_test": Page(6, BENDING, (
        "utils/dev/bending_tables.py --program {program} --work {work} --reuse --write docs/reports/bending_test.md",)),
    "constants": Page(40, f"{MECHANICS} src/run/adaptivity.f90 input_files/draw_bending input_files/square_cup "
                          "tests/parallel/bent.dat tests/benchmark/constants.py",
                      ("tests/benchmark/constants.py --work {work}",)),
    "contact": Page(8, MECHANICS, (labelled("compliant", contact=COMPLIANT) + " --write",
                                   envelope("--layers --write"))),
    "draw_bending": forming("draw_bending", 25),
    "gallery": Page(10, f"{MECHANICS} src/run/adaptivity.f90 src/sheet input_files utils/dd3/plot", (
        "utils/dev/gallery.py --program {program} --work {work} --write",)),
    "increments": Page(15, MECHANICS, (f"tests/benchmark/increments.py{RUN}",)),
    "pages": Page(20, f"{MECHANICS} input_files utils/dd3/report.py", (f"utils/dev/report_pages.py{RUN}",)),
    "processes": Page(8, f"src/linalg src/parallel {MECHANICS}", (
        "cmake --preset petsc", "cmake --build --preset petsc",
        f"tests/benchmark/processes.py --parallel build/petsc/dd3imp{RUN}")),
    "rail": forming("rail", 75),
    "robustness": Page(10, "src/material tests/benchmark/robustness.f90 tests/benchmark/parameter_sets.f90", (
        "cmake --build {build} --target benchmark_robustness",
        "tests/benchmark/robustness.py --build {build} --write")),
    "round_cup": forming("round_cup", 5),
    "round_cup_aa6016": forming("round_cup_aa6016", 15),
    "solvers": Page(20, "src/linalg src/system", (
        "cmake --build {build} --target benchmark_write_matrices benchmark_solvers benchmark_run_matrices",
        "tests/benchmark/solvers.py --build {build} --keep {work}")),
    "speed": Page(5, f"src/linalg {MECHANICS}", (
        "utils/dev/benchmark.py --program {program} --write docs/reports/speed.md input_files/bending/bending.dat "
        "input_files/bending/fine.dat",
        "tests/benchmark/speed.py --program {program} --increments 2 --write",
        "cmake --build {build} --target benchmark_material benchmark_friction",
        "tests/benchmark/laws.py --build {build} --write",
        f"tests/benchmark/peer.py{RUN}")),
    "split_ring": forming("split_ring", 8),
    "release": Page(10, f"{MECHANICS} input_files", (f"tests/forming/release.py{RUN}",)),
    "square_cup": forming("square_cup", 15),
}


def made(text: str) -> list[tuple[str, str]]:
    """Return commit and date of the stamps of a page's tables that scripts make."""
    return [(commit.rstrip("+"), date) for commits, date, rest in STAMP.findall(text) if rest != ONCE
            for commit in commits.split(", ")]


def later(commit: str, sources: str) -> int:
    """Return how many commits after one change sources; 0 where git does not know."""
    if not shutil.which("git"):
        return 0
    done = subprocess.run(["git", "rev-list", "--count", "--no-merges", f"{commit}..HEAD", "--", *sources.split()],
                          cwd=ROOT, capture_output=True, text=True, check=False)
    return int(done.stdout) if done.returncode == 0 else 0


def files() -> dict[str, Path]:
    """Return the pages by their names."""
    return {path.stem: path for path in [*sorted(REPORTS.glob("*.md")), GALLERY]}


def age(name: str) -> tuple[str, int]:
    """Return the oldest stamp of a page, and the number of later commits to its sources."""
    stamps = dict.fromkeys(made(files()[name].read_text(encoding="utf-8")))
    changes, commit, date = max(((later(commit, PAGES[name].sources), commit, date) for commit, date in stamps),
                                default=(0, "no table", "is made"))
    return f"{commit} {date}", changes


def without_stamp(text: str) -> list[str]:
    """Return what is wrong with the stamps of a page."""
    wrong = [f"the table {name} has no stamp" for name, content in BLOCK.findall(text) if not STAMP.search(content)]
    wrong += [f"no stamp below the table {table.partition(chr(10))[0]}"
              for words, table, below in TABLE.findall(BLOCK.sub("", text)) if not words and not STAMP.match(below)]
    return wrong if STAMP.search(text) else [*wrong, "the page has no stamp"]


def check() -> None:
    """Print the old pages, and the errors; exit code 1 if there are any."""
    pages = files()
    wrong = [f"{path.relative_to(ROOT)}: {problem}" for path in pages.values()
             for problem in without_stamp(path.read_text(encoding="utf-8"))]
    wrong += [f"utils/dev/pages.py: {name} is " + ("not in PAGES" if name in pages else "no page")
              for name in sorted(pages.keys() ^ PAGES.keys())]
    for name in sorted(pages.keys() & PAGES.keys()):
        stamp, changes = age(name)
        if changes:
            print(f"old: {pages[name].relative_to(ROOT)}, {stamp}: {changes} later commits change what it depends on")
    if wrong:
        sys.exit("\n".join(wrong))


def make(name: str, program: Path, work: Path) -> bool:
    """Make a page; return whether all of its commands succeeded."""
    program = Path(os.path.relpath(program, ROOT))
    places = {"program": program, "build": program.parent, "work": made_folder(work / name),
              "envelope": made_folder(work / "envelope")}
    for command in PAGES[name].commands:
        words = [word.format(**places) for word in shlex.split(command)]
        if words[0] != "cmake":
            words.insert(0, sys.executable)
        print(f"== {name}: {shlex.join(words)}", flush=True)
        if subprocess.run(words, cwd=ROOT, check=False).returncode:
            return False
    return True


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="*", metavar="PAGE", help=f"pages: {', '.join(PAGES)}")
    parser.add_argument("--program", default=ROOT / "build" / "release" / "dd3imp",
                        help="the program (build/release/dd3imp)")
    parser.add_argument("--all", action="store_true", help="make all pages")
    parser.add_argument("--list", action="store_true", help="print minutes, commits and age of the pages")
    parser.add_argument("--check", action="store_true", help="check the stamps")
    options = parser.parse_args()
    unknown = [name for name in options.pages if name not in PAGES]
    if unknown:
        parser.error(f"no such page: {' '.join(unknown)}")
    if options.check:
        check()
        return
    quick = sorted(PAGES, key=lambda name: PAGES[name].minutes)
    if options.list:
        for name in quick:
            stamp, changes = age(name)
            print(f"{name:18} {PAGES[name].minutes:3} min  {stamp}" + (f"  {changes} later commits" if changes else ""))
        return
    within = sum(minutes < HOUR for minutes in accumulate(PAGES[name].minutes for name in quick))
    program = find_program(options.program)
    commit = description(program)["program"]["commit"]
    if not commit or commit.endswith("+"):
        raise Problem(f"{program}: expected a program that was built from a commit without changes, got {commit}")
    work = ROOT / "build" / "pages" / commit
    failed = [name for name in options.pages or quick[:None if options.all else within]
              if not make(name, program, work)]
    if failed:
        sys.exit(f"not made: {' '.join(failed)}")


if __name__ == "__main__":
    run(main)
