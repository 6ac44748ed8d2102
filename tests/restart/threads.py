#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "same_bits_with_threads", "timeout": 600}
"""Results with 1, 2 and 4 threads are the same bits, on sheets with more elements and candidates than one thread takes.

    threads.py --program build/release/dd3imp --work build/threads
"""
import types

from runs import ROOT, Deck, Runner, call_tests, check, compare, fresh, table

from dd3.programs import parser_of_runs

# A thread takes at least 128 elements: four of them are in use.
CHANGES = (("divisions = 10 2 1", "divisions = 20 13 2"),
           ("until = displacement punch 1.8", "until = displacement punch 0.2"))


def same_bits(runner, work, deck, settings=()):
    """Run with each number of threads and compare."""
    for threads in ("1", "2", "4"):
        runner.run(deck, work / threads, settings=settings, arguments=("--threads", threads))
        compare(work / threads, work / "1")
    check(len(table(work / "1" / "status.csv")) > 8, "too few increments")


def same_bits_of_strip(runner, work, *changes):
    """Compare the results of the strip."""
    same_bits(runner, work, Deck(fresh(work) / "deck.dat", *CHANGES, *changes, end="*PHASE pull"))


def same_bits_of_cup(runner, work):
    """Compare the results of the square cup: tools curved in two directions, factorisation by fronts."""
    deck = types.SimpleNamespace(path=ROOT / "input_files" / "square_cup" / "square_cup.dat")
    same_bits(runner, fresh(work), deck, ("divisions=23 23 1", "levels=0", "points=3", "depth=5"))


def main():
    """Run the test."""
    options = parser_of_runs(__doc__).parse_args()
    runner, work = Runner(options.program), fresh(options.work.resolve())
    shell = (("element = hex8", "element = solid_shell\n  thickness_points = 3"),
             ("divisions = 20 13 2", "divisions = 20 13 1"))
    raise SystemExit(call_tests([
        ("same bits with 1, 2 and 4 threads", lambda: same_bits_of_strip(runner, work / "hex8")),
        ("the same with solid_shell", lambda: same_bits_of_strip(runner, work / "solid_shell", *shell)),
        ("the same with curved tools", lambda: same_bits_of_cup(runner, work / "cup"))]))


if __name__ == "__main__":
    main()
