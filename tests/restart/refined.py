#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "restart_refined", "timeout": 600}
"""Runs that divide elements, continued from before and after, killed, and with changed input.

    refined.py --program build/release/dd3imp --work build/refined
"""
import json
import random
import shutil
import signal

import h5py
from continued import seen_in_run
from runs import Deck, Failure, Runner, after, call_tests, check, compare, fresh, restart_of, seconds_of_runs, table

from dd3.programs import parser_of_runs

SOURCE = "refined.dat"
# Numbers of kills and of interruptions, and of runs started for them.
KILLS = 2
MOST_TRIALS = 20
# Changes of the deck, and what the message names as different.
DIFFERENT = {
    "mesh": ((("divisions = 20 1 1", "divisions = 21 1 1"),), "the mesh or the place of the sheet"),
    "size": ((("175 9 0.78", "176 9 0.78"),), "the mesh or the place of the sheet"),
    "element": ((("element = solid_shell", "element = hex8"), ("  thickness_points = 3\n", "")), "the mesh"),
    "hardening": ((("K=565", "K=566"),), "material 'mild_steel'"),
    "name of the material": ((("*MATERIAL mild_steel", "*MATERIAL steel"),
                              ("material = mild_steel", "material = steel")), "the materials"),
    "set": ((("near = 80 0 0", "near = 90 0 0"),), "set 'middle'"),
    "new set": ((("*BOUNDARY symmetry", "*SET tip\n  near = 175 0 0\n\n*BOUNDARY symmetry"),), "set 'tip' (new)"),
    "supports": ((("fix = y", "fix = y z"),), "the supports (*BOUNDARY)"),
    "friction": ((('die.bez"\n  friction = 0.144', 'die.bez"\n  friction = 0.1'),), "tool 'die'"),
    "move": ((("punch 0 0 -20", "punch 0 0 -21"),), "phase 'draw'"),
}
# Settings of later refinement that a restart accepts.
ACCEPTED = ("adaptive=0", "adaptive=2", "angle=12")


class Runs:
    """The deck, its uninterrupted run, and the restart files of that by increment."""

    def __init__(self, runner, work):
        self.runner, self.work = runner, work
        self.deck = Deck(work / "deck.dat", source=SOURCE)
        before = seconds_of_runs()
        self.found = seen_in_run(runner, self.deck, work / "whole", ())
        self.seconds = seconds_of_runs() - before
        self.number = {increment: refinements(path) for increment, path in self.found.items()}

    def from_increments(self):
        """Continue before and after a refinement within the run, and at its end."""
        increments = sorted(self.found)
        later = [i for i in increments if self.number[i] > self.number[increments[0]]]
        check(self.number[increments[0]] > 0, "no element was divided at the start")
        check(later, "no element was divided in the middle")
        at = increments.index(later[0])
        check(at > 1, "no restart file before elements were divided")
        # The fourth from the end lies in the springback, while stresses fade.
        for increment in (*increments[at - 2:at + 1], increments[-4], increments[-1]):
            output = fresh(self.work / "continued")
            try:
                self.runner.run(self.deck, output, self.found[increment])
                compare(output, self.work / "whole")
                check(reported(output) == reported(self.work / "whole"), "run.json has other refinements")
            except Failure as failure:
                raise Failure(f"from increment {increment}: {failure}") from failure

    def stopped(self, number, setting):
        """Stop runs by a signal at random instants, and continue to the end."""
        runner, output, settings = self.runner, self.work / "stopped", (setting,)
        fresh(output)
        instants, done = random.Random(number), 0
        runner.run(self.deck, fresh(self.work / "expected"), settings=settings)
        for _ in range(MOST_TRIALS):
            if done == KILLS:
                break
            instant = instants.uniform(0.1, 0.4)*self.seconds
            code = runner.stop(number, after(instant), self.deck, output, restart_of(output), settings)
            check(code in (0, 3, -number), f"exit code {code}")
            if code == 0:
                fresh(output)
            done += code != 0
        check(done == KILLS, f"only {done} of {KILLS} hit a run")
        runner.run(self.deck, output, restart_of(output), settings=settings)
        compare(output, self.work / "expected")
        check(reported(output) == reported(self.work / "expected"), "run.json has other refinements")

    def refused(self):
        """Another model is named, and nothing is touched."""
        increment = max(self.found)
        output = fresh(self.work / "refused")
        shutil.copy(self.found[increment], output / "restart.h5")
        for name, (changes, parts) in DIFFERENT.items():
            deck = Deck(self.work / "changed.dat", *changes, source=SOURCE)
            said = self.runner.run(deck, output, output / "restart.h5", 2)
            check(f"restart.h5' belongs to another model; different: {parts}\n" in said, f"{name}: {said}")
            check(len(said.splitlines()) == 1, f"{name}: more than one line: {said}")
            check([path.name for path in output.iterdir()] == ["restart.h5"], f"{name}: files were written")

    def accepted(self):
        """Settings of later refinement may change."""
        first = min(self.found)
        for setting in ACCEPTED:
            output = fresh(self.work / "accepted")
            said = self.runner.run(self.deck, output, self.found[first], settings=(setting,), arguments=("--check",))
            check("checked" in said, f"{setting}: {said}")
        self.runner.run(self.deck, output, self.found[first], settings=("adaptive=0",))
        check(refinements(output / "restart.h5") == self.number[first], "elements were divided with adaptive = 0")
        check(len(table(output / "history.csv")) > first, "history.csv is not continued")


def refinements(path):
    """Number of refinements that have made the mesh of a restart file."""
    with h5py.File(path, "r") as file:
        return int(file["mesh/number"][0]) if "mesh/number" in file else 0


def reported(folder):
    """Refinements that run.json reports: as many as have made the last mesh, up to its number of elements."""
    changes = json.loads((folder / "run.json").read_text())["refinements"]
    check(len(changes) == refinements(folder / "restart.h5"), f"run.json has {len(changes)} refinements")
    elements = [int(row["elements"]) for row in table(folder / "history.csv")]
    check(elements[-1] == changes[-1]["elements"] == sum(changes[-1]["elements_of_level"]), "other last elements")
    check(elements == sorted(elements), "the number of elements decreases")
    for one, other in zip(changes, changes[1:]):
        check(one["elements"] == other["elements_before"], "a refinement is missing")
    return changes


def main():
    """Run all of them."""
    options = parser_of_runs(__doc__).parse_args()
    runs = Runs(Runner(options.program), fresh(options.work.resolve()))
    raise SystemExit(call_tests([
        ("from increments", runs.from_increments),
        ("killed", lambda: runs.stopped(signal.SIGKILL, "restart=4")),
        ("interrupted", lambda: runs.stopped(signal.SIGINT, "restart=1000")),
        ("refused", runs.refused), ("accepted", runs.accepted)]))


if __name__ == "__main__":
    main()
