#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "answers"}
"""Input files that earlier versions handled wrongly, and the present answers: the table of answers.md.

    run.py --program build/release/dd3imp --work build/answers           compare with the table
    run.py --program build/release/dd3imp --work build/answers --write   write the table
    run.py --program other/dd3imp --work build/answers --print           print what another version answers

Each deck is strip.dat, or an input file of tests/, with some changes. The answer is the exit code and the line that
says what is wrong, or, of a run that is right, values of the last row of history.csv.
"""
import dataclasses
import math
import pathlib
import re
import shutil
import sys

from dd3.errors import Problem
from dd3.pages import table
from dd3.programs import command, launch, parser_of_runs
from dd3.tables import read_table

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
EXPECTED = HERE / "answers.md"

HEAD = ["deck", "earlier answer", "exit code", "answer"]
LIMIT = 300.0
# Relative difference of a value of history.csv from the one in the table.
TOLERANCE = 1e-3
BEND = "*PHASE bend"
MOVE = "  move = punch 0 0 -2"
OUTPUT = "*OUTPUT"
NEXT = "*PHASE next\n  control = load\n  trial = 0.25\n"


@dataclasses.dataclass
class Deck:
    """A deck: what it does, the earlier answer, its changes (pairs of texts), and what its answer is."""

    what: str
    before: str
    changes: tuple = ()
    file: str = "tests/answers/strip.dat"
    line: str = ""  # part of the line of the output that is the answer
    values: tuple = ()  # or columns of the last row of history.csv
    options: tuple = ()


def replaced(old, new):
    """Return a change of a deck."""
    return ((old, new),)


def added(text, place=OUTPUT):
    """Return the change that puts a text before a place."""
    return ((place, f"{text}\n{place}"),)


def block(name, *lines):
    """Return the change that adds a block before the first phase."""
    return added(f"*{name}\n" + "".join(f"  {line}\n" for line in lines), BEND)


RIB = "tests/cases/tool_between_nodes/case.dat"
DECKS = [
    # Tools
    Deck("a strip 0.05 mm thick led round a cylinder, limits of 0.05 and 1 degree",
         "end, 2 to 3 mm inside the cylinder, with cut-back",
         file="tests/cases/thin_strip_round_cylinder/case.dat", values=("cylinder_depth",)),
    Deck("a thin strip that slides over a cylinder: reaction 0.7976 N", "end, 0.71 N",
         file="tests/cases/capstan/case.dat", values=("left_rx",)),
    Deck("a punch beside the sheet", "end, 0 N", file=RIB, options=("--set", "place=60 0 0"), line="without touching"),
    Deck("a rib that passes the sheet between two node lines", "end, 0 N", file=RIB, line="without touching"),
    Deck("the same, its depth", "end, silent", file=RIB, line="entered the sheet"),
    Deck("candidates on the far face of the sheet", "end, the far face is pushed", file=RIB,
         options=("--set", "set=z_min", "--set", "down=0.25"), line="turned away"),
    Deck("a gap of 0.3 mm between two patches", "`--check` silent; the run may die within the gap",
         file="tests/unit/model/tools/strip.dat", options=("--check",), line="not joined"),
    Deck("tools that cross each other beside the sheet", "end, silent",
         changes=replaced("contact = z_max", "contact = z_max\n  position = 20 16 0"), line="crossed"),
    Deck("elements of two thicknesses in bending", "silent", line="thicknesses long"),
    # Phases
    Deck("`load` in a direction that an earlier phase displaces", "end, load ignored",
         changes=added("  displace = x_max x 0.01") + added(NEXT + "  load = x_max 100 0 0"), line="has no effect"),
    Deck("the same, on a set held in part", "end, part of the load in the supports",
         changes=added(NEXT + "  load = z_max 100 0 0"), line="nodes are held"),
    Deck("a later phase does not name displaced nodes", "silent, they stay held",
         changes=added("  displace = x_max x 0.01") +
         added("*PHASE next\n  control = punch\n  trial = 0.5\n  move = punch 0 0 -0.5"), line="keeps directions"),
    Deck("`until = force` never met", "end, silent", line="without meeting",
         changes=added("  until = force punch 500")),
    Deck("a released tool that a later phase moves back", "end, 0 N, through the sheet",
         changes=block("BOUNDARY z", "set = x_max", "fix = z") +
         added("*PHASE off\n  control = punch\n  trial = 0.5\n  release = punch\n  move = punch 0 0 5\n"
               "*PHASE back\n  control = punch\n  trial = 0.5\n  move = punch 0 0 -5.5"), values=("punch_fz",)),
    Deck("the same, with the tool inside the sheet", "end, 0 N",
         changes=added("*PHASE off\n  control = load\n  trial = 0.5\n  release = punch\n"
                       "*PHASE back\n  control = punch\n  trial = 0.5\n  move = punch 0 0 -0.5"), line="inside it"),
    Deck("`press` of a released tool", "exit code 2",
         changes=added("*PHASE off\n  control = punch\n  trial = 0.5\n  release = punch\n  move = punch 0 0 5\n"
                       "*PHASE back\n  control = load\n  trial = 0.5\n  press = punch 0 0 -10"), values=("punch_fz",)),
    Deck("springback by one key", "exit code 2", changes=added("*PHASE springback\n  unload = on"),
         line="the sheet is free to move"),
    Deck("springback with a load that only tools could carry", "exit code 2",
         changes=added("  load = x_max 0 0 1\n*PHASE springback\n  unload = on"), line="not in equilibrium"),
    Deck("`free` of a direction that was not displaced", "exit code 2, unknown key",
         changes=added(NEXT + "  free = x_max y"), line=" error E"),
    # Numerical parameters
    Deck("`tolerance = 1e9`", "end, 3 times the force", changes=block("NEWTON", "tolerance = 1e9"), line=" error E"),
    Deck("`tolerance = 0.09`", "end, silent", changes=block("NEWTON", "tolerance = 0.09"), line="tolerance"),
    Deck("`iterations = 1000000`", "accepted", changes=block("NEWTON", "iterations = 1000000"), line=" error E"),
    Deck("`penalty = 1e-6`", "exit code 3", changes=replaced("penalty = 1000", "penalty = 1e-6"), line=" error E"),
    Deck("`penalty = 1e12`", "exit code 3", changes=replaced("penalty = 1000", "penalty = 1e12"), line=" error E"),
    Deck("`*SOLVER tolerance = 0.99`", "end", changes=block("SOLVER", "method = cgs", "tolerance = 0.99"),
         line=" error E"),
    Deck("`search_distance = 1e-9`", "end, 1 % off", changes=added("  search_distance = 1e-9", "*BOUNDARY x"),
         options=("--check",), line="warning W007"),
    Deck("`friction = 144`", "exit code 3", changes=(("friction = 0.1", "friction = 144"),), options=("--check",),
         line="warning W005"),
    Deck("`r_min = 1e-300` and `strain = 1e-12`", "no end", changes=block("LIMITS", "r_min = 1e-300", "strain = 1e-12"),
         line=" error E"),
    Deck("`strain = 1e-300`, `r_min = off`", "no end", changes=block("LIMITS", "r_min = off", "strain = 1e-300"),
         line="stopped"),
    Deck("`trial = 1e-300`", "no end", changes=replaced("trial = 0.5", "trial = 1e-300"), line=" error E"),
    Deck("`trial = 1e300`", "exit code 3, right-hand side not finite", changes=replaced("trial = 0.5", "trial = 1e300"),
         line=" error E"),
    Deck("`move` by 1e9 mm", "exit code 3 at 28 mm, an element inside out", line=" error E",
         changes=replaced(MOVE, "  move = punch 0 0 -1e9")),
    # Input
    Deck("two `*OUTPUT` blocks", "SIGSEGV", line="only once",
         changes=replaced("every 1", "every 1\n*OUTPUT\n  fields = at 1 3 2")),
    Deck("a line that is no assignment in `*MATERIAL`", "division by zero",
         changes=replaced("young = 2e5", "young {= 2e5"), line=" error E"),
    Deck("20 000 directions in `fix`", "10 s", changes=replaced("fix = x", "fix = " + "x " * 20000), line=" error E"),
    Deck("20 000 outputs in descending order", "no end", line=" error E",
         changes=replaced("every 1", "at " + " ".join(f"{2 - i * 1e-5:.5f}" for i in range(20000)))),
    Deck("a key of 100 000 letters", "100 000 letters in the message", line="unknown key",
         changes=replaced("trial = 0.5", "t" * 100000 + " = 0.5")),
    Deck("a deck named history.csv in the folder of its results", "overwritten", options=("--output", "."),
         changes=(("name", "history.csv"),), line=" error E"),
    # Early stops
    Deck("the bending test on mesh (a), automatic settings", "exit code 3 at 18 mm, without cut-back",
         file="input_files/bending/bending.dat", values=("punch_fz",),
         changes=(("skew = 1.0 ", "skew = 0.0 "), ("*LIMITS", "*LIMITS_"), ("*NEWTON", "*NEWTON_"),
                  ("*SOLVER", "*SOLVER_"), ("  formulation = mixed\n", ""), ("${p}", "")),
         options=("--quiet",)),
]


def make(deck, folder):
    """Write a deck with its files into a folder; return its path."""
    source = ROOT / deck.file
    text, name = source.read_text(encoding="utf-8"), "job.dat"
    for old, new in deck.changes:
        if old == "name":
            name = new
            continue
        if old not in text:
            raise Problem(f"{deck.what}: {deck.file} does not contain {old!r}")
        text = text.replace(old, new, 1)
    text = re.sub(r"^\*\w+_\n(?:  .*\n)*|^  penalty = +\n", "", text, flags=re.MULTILINE)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for surface in [*source.parent.glob("*.bez"), *(ROOT / "tests" / "springback").glob("*.bez")]:
        if not (folder / surface.name).exists():
            shutil.copy(surface, folder)
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def answer(program, deck, folder):
    """Run a deck; return its exit code and its answer."""
    path = make(deck, folder)
    options = list(deck.options) if "--output" in deck.options else ["--output", "results", *deck.options]
    try:
        done = launch(command(program, path.name, None, options), timeout=LIMIT, folder=folder)
    except Problem:
        return "none", f"no end in {LIMIT:g} s"
    if deck.values and done.code == 0:
        last = read_table(folder / "results" / "history.csv")[-1]
        return "0", "reached the end; " + ", ".join(f"{name} = {float(last[name]):.5g}" for name in deck.values)
    lines = [text for text in (done.output + done.errors).splitlines() if deck.line in text]
    text = lines[0] if deck.line and lines else (done.errors or done.output).splitlines()[-1]
    return str(done.code), shortened(text)


def shortened(text, most=300):
    """Return a line for a table."""
    text = text.strip().replace("|", "\\|")
    return text if len(text) <= most else text[:most - 4] + " ..."


def same(a, b):
    """Whether two rows are the same but for round-off in their values."""
    number = re.compile(r"-?\d+\.?\d*(?:[eE][-+]?\d+)?")
    if number.sub("#", a) != number.sub("#", b):
        return False
    return all(math.isclose(float(x), float(y), rel_tol=TOLERANCE)
               for x, y in zip(number.findall(a), number.findall(b)))


def main():
    """Compare, print or write the table; exit code 1 if a row differs."""
    parser = parser_of_runs(__doc__)
    parser.add_argument("--write", action="store_true", help="write the table")
    parser.add_argument("--print", action="store_true", help="print the table")
    options = parser.parse_args()
    text = table(HEAD, [(deck.what, deck.before, *answer(options.program, deck, options.work / str(i)))
                        for i, deck in enumerate(DECKS, 1)])
    if options.print:
        print(text)
    elif options.write:
        EXPECTED.write_text(text + "\n", encoding="utf-8")
    else:
        lines = text.split("\n")
        old = EXPECTED.read_text(encoding="utf-8").splitlines()
        wrong = [f"expected {a}\nfound    {b}" for a, b in zip(old, lines) if not same(a, b)]
        if len(old) != len(lines):
            wrong.append(f"{len(old) - 2} rows in {EXPECTED.name}, {len(lines) - 2} decks")
        sys.exit("\n".join(wrong) if wrong else 0)


if __name__ == "__main__":
    main()
