#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "restart_killed", "arguments": ["--kills", "3"]}
#: {"name": "restart_killed_often", "arguments": ["--kills", "10", "--fields", "50"], "labels": ["case", "slow"],
#:  "timeout": 3600, "cost": 300}
"""Runs that are killed and continued: their results are those of a run that is not, bit for bit.

    killed.py --program build/release/dd3imp --work build/killed --kills 3

A run is killed at random instants, within a change of phase, and while its restart file is written.
"""
import random
import signal
import sys
from pathlib import Path

from runs import (
    Deck,
    Runner,
    after,
    being_written,
    call_tests,
    check,
    compare,
    fresh,
    growing,
    replaced,
    restart_of,
    seconds_of_runs,
    table,
)

from dd3.programs import parser_of_runs

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from many_laws import MANY_LAWS  # noqa: E402

# Phases before the last one, and the beginning of that.
MOTIONS = """*PHASE turn
  control = load
  trial = 0.2
  iterations = 30
  release = punch
  release = die
  release = blank_holder
  rotate = x_max 175 17.5 0 0 1 0 0.3
  pressure = z_max 0.002
  table = 0 0 0.5 1 1 0.4

*PHASE bow
  control = load
  trial = 0.2
  bend = x_max 0 17.5 0.39 0 1 0 1
  pressure = z_max 0
  table = 0 0 0.3 0.6 1 1

*PHASE springback
  free = x_max x z"""
# Block of a draw-bead that a pressed tool carries.
BEAD = """*DRAWBEAD bead
  points = 60 -1  60 36
  force = 40
  rise = 2
  normal = -5
  tool = blank_holder

*CONTACT"""
# Times of the phases with a friction by the speed, and a holder on springs.
CUSHION = (("  penalty = ${p}", "  layer = ${p}"), ('punch.bez"', 'punch.bez"\n  friction_law = "speed_table 0:1 5:0.6"'),
           ("-22600", "-22600\n  stroke_table = blank_holder 0 1  0.1 1.2\n  pin = blank_holder 60 16 0 1\n"
            "  pin = blank_holder 100 0 0 1\n  pin = blank_holder 100 35 0 1\n  duration = 1"),
           *((text, f"{text}\n  duration = 1") for text in ("force punch 400", "displacement punch 1.8", "x_max y 0.05",
                                                             "free = x_max y", "unload = on")))
LAWS = (("  hardening = swift K=565 e0=0.007117 n=0.259\n  backstress = lemaitre_chaboche CX=5 Xsat=40",
         MANY_LAWS.rstrip()),
        ("-22600", "-22600\n  duration = 1"), *((text, f"{text}\n  duration = 1") for text in (
            "force punch 400", "displacement punch 1.8", "x_max y 0.05", "free = x_max y", "unload = on")))
# Changes of the deck and settings, by name: restart file often, after each increment, at the ends of phases only;
# fields by increments; motions and pressures along curves of progress; a draw-bead; a tool that tilts; springs and
# times; a material of many laws; another linear solver.
CASES = {
    "often": ((), ()),
    "each": ((), ("restart=1", "history=5")),
    "phases": ((), ("restart=1000",)),
    "increments": ((("every 0.4 mm", "increments 2"),), ()),
    "fields": ((("every 0.4 mm", "increments 1"),), ("restart=1",)),
    "solid_shell": ((("element = hex8", "element = solid_shell"),), ("restart=1",)),
    "motions": ((("*PHASE springback", MOTIONS),), ("restart=1",)),
    "bead": ((("*CONTACT", BEAD),), ("restart=1",)),
    "tilt": ((("  penalty = ${p}", "  layer = ${p}"), ("-22600", "-22600\n  tilt = blank_holder 80 16 0 0")),
             ("restart=1", "p=0.01")),
    "laws": (LAWS, ("restart=1",)),
    "cushion": (CUSHION, ("restart=1", "p=0.01")),
    "umfpack": ((("method = auto", "method = umfpack"),), ("restart=3",)),
}
MOST_TRIALS = 100


class Killed:
    """Kills of runs of one deck, and the uninterrupted run."""

    def __init__(self, runner, work, name, seed):
        changes, self.settings = CASES[name]
        self.runner, self.work, self.random = runner, fresh(work), random.Random(seed)
        self.deck = Deck(work / "deck.dat", *changes)
        before = seconds_of_runs()
        runner.run(self.deck, work / "whole", settings=self.settings)
        self.seconds = seconds_of_runs() - before
        self.output = work / "killed"

    def kill(self, make_condition):
        """Start or continue a run and kill it; return whether it was killed before its end."""
        code = self.runner.stop(signal.SIGKILL, make_condition(self.output), self.deck, self.output,
                                restart_of(self.output), self.settings)
        check(code in (0, -signal.SIGKILL), f"exit code {code}")
        return code != 0

    def finish(self):
        """Continue to the end and compare."""
        self.runner.run(self.deck, self.output, restart_of(self.output), settings=self.settings)
        compare(self.output, self.work / "whole")

    def at_random(self, kills):
        """Kill a run so many times at random instants, starting over if it ends before."""
        done = 0
        for _ in range(MOST_TRIALS):
            instant = self.random.uniform(0.05, 0.9)*self.seconds
            if self.kill(lambda output, at=instant: after(at)):
                done += 1
            else:
                compare(self.output, self.work / "whole")
                fresh(self.output)
            if done == kills:
                return self.finish()
        return check(False, f"only {done} of {kills} kills hit a run")

    def at_ends_of_phases(self, kills):
        """Kill a run so many times when the restart file at the end of a phase has been written."""
        done = 0
        for _ in range(MOST_TRIALS):
            # A continued run writes the file once more at its start.
            times = 2 if restart_of(self.output) else 1
            if self.kill(lambda output, times=times: replaced(output / "restart.h5", times)):
                done += 1
            else:
                fresh(self.output)
            if done == kills:
                return self.finish()
        return check(False, f"only {done} of {kills} kills hit a run")

    def while_continued(self):
        """Kill a run, then its continuations when they have replaced the first records, the second and so on."""
        self.kill(lambda output: after(0.5*self.seconds))
        for name in ("history.csv", "status.csv", "fields.vtkhdf", "restart.h5"):
            self.kill(lambda output, name=name: replaced(output / name))
        self.finish()

    def fields(self, kills):
        """Kill new runs while steps of fields are written: no step of the restart is lost."""
        for number in range(kills):
            fresh(self.output)
            instant = self.random.uniform(0.0, 0.8)*self.seconds
            path = self.output / "fields.vtkhdf"
            self.kill(lambda output, at=instant: growing(path, at) if number % 4 else after(at))
            restart = restart_of(self.output)
            said = self.runner.run(self.deck, self.output, restart, settings=self.settings)
            check("begin at the restart" not in said, f"kill {number}: {said}")
            compare(self.output, self.work / "whole")

    def while_written(self, kills):
        """Kill while the restart file is written: the part of it is left."""
        done = 0
        for _ in range(MOST_TRIALS):
            instant = self.random.uniform(0.0, 0.5)*self.seconds
            killed = self.kill(lambda output, at=instant: being_written(output, at))
            if killed and (self.output / "restart.h5.part").exists():
                done += 1
            elif not killed:
                fresh(self.output)
            if done == kills:
                return self.finish()
        return check(False, f"only {done} of {kills} kills hit the writing")


def main():
    """Run all of them."""
    parser = parser_of_runs(__doc__)
    parser.add_argument("--kills", type=int, default=3, help="number of kills, at least 3")
    parser.add_argument("--fields", type=int, default=0, help="number of kills while fields are written")
    parser.add_argument("--seed", type=int, default=1, help="of the random instants")
    options = parser.parse_args()
    runner, work = Runner(options.program), fresh(options.work.resolve())

    def case(name):
        return Killed(runner, work / name, name, options.seed)

    others = max(0, options.kills - 3)
    rest = [1 + others//5 + (1 if k < others % 5 else 0) for k in range(5)]
    tests = [("at random instants", lambda: case("often").at_random(rest[0])),
             ("within a change of phase", lambda: case("phases").at_ends_of_phases(rest[1])),
             ("while the restart file is written", lambda: case("each").while_written(rest[2])),
             ("while the records are continued", lambda: case("often").while_continued())]
    if options.kills > 3:
        tests += [("with fields by increments", lambda: case("increments").at_random(rest[3] - 1)),
                  ("with another linear solver", lambda: case("umfpack").at_random(rest[4]))]
    if options.fields > 0:
        tests += [("while fields are written", lambda: case("fields").fields(options.fields))]
    raise SystemExit(call_tests(tests))


if __name__ == "__main__":
    main()
