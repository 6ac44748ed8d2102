#!/usr/bin/env python3
"""Results with 1, 2 and 4 threads are the same bits, on a sheet with more elements than one thread takes.

    threads.py --program build/release/dd3imp --work build/threads
"""
import argparse
import pathlib

from runs import Deck, Runner, call_tests, check, compare, fresh, table

# A thread takes at least 128 elements: four of them are in use.
CHANGES = (("divisions = 10 2 1", "divisions = 20 13 2"),
           ("until = displacement punch 1.8", "until = displacement punch 0.2"))


def same_bits(runner, work, *changes):
    """Run with each number of threads and compare."""
    deck = Deck(fresh(work) / "deck.dat", *CHANGES, *changes, end="*PHASE pull")
    for threads in ("1", "2", "4"):
        runner.run(deck, work / threads, arguments=("--threads", threads))
        compare(work / threads, work / "1")
    check(len(table(work / "1" / "status.csv")) > 8, "too few increments")


def main():
    """Run the test."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=pathlib.Path, required=True, help="the program dd3imp")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for the results; it is emptied")
    options = parser.parse_args()
    runner, work = Runner(options.program), fresh(options.work.resolve())
    shell = (("element = hex8", "element = solid_shell\n  thickness_points = 3"),
             ("divisions = 20 13 2", "divisions = 20 13 1"))
    raise SystemExit(call_tests([
        ("same bits with 1, 2 and 4 threads", lambda: same_bits(runner, work / "hex8")),
        ("the same with solid_shell", lambda: same_bits(runner, work / "solid_shell", *shell))]))


if __name__ == "__main__":
    main()
