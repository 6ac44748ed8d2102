#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "restart_continued", "arguments": ["--every", "20"], "timeout": 600}
#: {"name": "restart_continued_often", "arguments": ["--every", "2"], "labels": ["case", "slow"],
#:  "timeout": 3600, "cost": 300}
"""Runs continued from a restart file: after an interruption or a stop, from every increment, with changed input.

    continued.py --program build/release/dd3imp --work build/continued --every 4
"""
import os
import random
import resource
import shutil
import signal
import subprocess

import h5py
from killed import CASES
from runs import (
    RECORDS,
    Deck,
    Failure,
    Runner,
    after,
    call_tests,
    check,
    check_description,
    compare,
    fresh,
    identity,
    seconds_of_runs,
    table,
)

from dd3.programs import parser_of_runs

# Number of interrupted runs.
INTERRUPTIONS = 3
# Increment in the middle of a phase from which changed decks continue.
MIDDLE = 15
# Interval of the rows of history.csv in the deck.
HISTORY = 3
# Changes of the deck that a restart accepts: name, replaced text, settings, records of the restart that are lost.
ACCEPTED = (
    ("limits", (("strain = 0.02", "strain = 0.03"),), (), ""),
    ("newton", (("cutback = on", "cutback = on\n  tolerance = 1e-3\n  line_search = off"),), ("iterations=20",), ""),
    ("solver", (("method = auto", "method = umfpack"),), (), ""),
    ("penalty", (), ("p=3000",), ""),
    ("output", (("every 0.4 mm", "increments 3"),), ("history=1", "restart=7"), ""),
    ("no restart file", (("every ${restart}", "off"),), (), ""),
    ("history", (("quantities = position", "quantities = position reaction"),), (), "history.csv"),
    ("later phase", (("load = x_max 0 0 -8", "load = x_max 0 0 -4"),), (), ""),
    ("other load set", (("load = x_max 0 0 -8", "load = corner 0 0 -4"), ("load = x_max 0 0 0", "load = corner 0 0 0")),
     (), ""),
    ("added load set", (("*PHASE back", "*PHASE more\n  control = load\n  trial = 0.5\n  load = other_corner 0 1 0\n\n"
                         "*PHASE back"),), (), ""),
    ("added phase", (("iterations = 30", "iterations = 30\n\n*PHASE last\n  control = load\n  trial = 0.5\n"
                      "  load = x_max 0 0 1"),), (), ""),
    ("dropped phases", (), (), ""),
)


def snapshots(runner, deck, output, settings):
    """Run with a restart file after each increment; return them by increment.

    Some may be missed: the run is repeated until more than ten are seen, one of them up to MIDDLE.
    """
    settings = [setting for setting in settings if not setting.startswith("restart")] + ["restart=1"]
    found = {}
    while len(found) <= 10 or min(found) > MIDDLE:
        found = seen_in_run(runner, deck, fresh(output), settings)
    return found, settings


def seen_in_run(runner, deck, output, settings):
    """Return the restart files that are seen in a run, by increment."""
    found, seen, source = {}, None, output / "restart.h5"
    with subprocess.Popen(runner.command(deck, output, settings=settings), stdout=subprocess.DEVNULL) as process:
        while process.poll() is None:
            now = identity(source)
            if now is None or now == seen:
                continue
            copy = output / f"{len(found)}.h5"
            try:
                os.link(source, copy)
            except FileNotFoundError:  # replaced by the next one in between
                continue
            seen = now
            found[len(found)] = copy
    check(process.returncode == 0, f"exit code {process.returncode} instead of 0")
    by_increment = {}
    for path in found.values():
        with h5py.File(path, "r") as file:
            by_increment[int(file["state/increment"][0])] = path
    return by_increment


def from_increments(runner, work, name, every):
    """Continue from every n-th increment, in another folder."""
    changes, settings = CASES[name]
    deck = Deck(work / "deck.dat", *changes)
    found, settings = snapshots(runner, deck, work / "whole", settings)
    problems = []
    for increment in sorted(found)[::every]:
        output = fresh(work / "continued")
        try:
            runner.run(deck, output, found[increment], settings=settings)
            compare(output, work / "whole")
        except Failure as failure:
            problems.append(f"from increment {increment}: {failure}")
    check(not problems, "\n".join(problems))


def interrupted(runner, work):
    """Control-C at random instants, several times, then to the end."""
    deck, instants = Deck(work / "deck.dat"), random.Random(2)
    before = seconds_of_runs()
    runner.run(deck, work / "whole", settings=("restart=1000",))
    whole = seconds_of_runs() - before
    output, done = work / "interrupted", 0
    for _ in range(40):
        restart = output / "restart.h5" if (output / "restart.h5").exists() else None
        instant = whole*instants.uniform(0.02, 0.3)
        code = runner.stop(signal.SIGINT, after(instant), deck, output, restart, ("restart=1000",))
        check(code in (0, 3, -signal.SIGINT), f"exit code {code}")
        accepted = [row for row in table(output / "status.csv") if row["outcome"] == "accepted"] if code == 3 else []
        if accepted:
            done += 1
            check((output / "restart.h5").exists(), "no restart file after an interruption")
            last = table(output / "history.csv")[-1]["increment"]
            check(accepted[-1]["increment"] == last, f"status.csv does not end at {last}")
        elif code == 0:
            compare(output, work / "whole")
            fresh(output)
        if done == INTERRUPTIONS:
            break
    check(done == INTERRUPTIONS, f"only {done} interruptions hit a run")
    runner.run(deck, output, output / "restart.h5", settings=("restart=1000",))
    compare(output, work / "whole")
    found = check_description(output, 0)
    while found["continued"]:
        last, found = found["continued"], found["continued"]["earlier"]
        check(found, "run.json lacks an earlier run")
        check(last["increment"] <= max(phase["result"]["last_increment"] or 0 for phase in found["phases"]),
              "run.json was continued beyond the end of the earlier run")


def stopped(runner, work):
    """A run that stops: continued unchanged it stops again in the same way; with more iterations it reaches the end."""
    for name, change, settings in (("iterations", "cutback = off", ("iterations=4",)),
                                   ("cut-backs", "cutback = on\n  line_search = off", ("iterations=2",))):
        first, again, output = work / name / "first", work / name / "again", work / name / "changed"
        deck = Deck(work / name / "deck.dat", ("cutback = on", change))
        runner.run(deck, first, expect=3, settings=settings)
        check(int(table(first / "history.csv")[-1]["increment"]) > 0, f"{name}: no increment before the stop")
        runner.run(deck, again, first / "restart.h5", expect=3, settings=settings)
        compare(again, first)
        runner.run(Deck(work / "changed.dat"), output, first / "restart.h5", settings=("iterations=30",))
        increments = [int(row["increment"]) for row in table(output / "status.csv") if row["outcome"] == "accepted"]
        check(increments == list(range(1, len(increments) + 1)), f"{name}: accepted increments {increments}")


def changed(runner, work):
    """Decks with other numerical parameters, output and later phases continue."""
    found, _ = snapshots(runner, Deck(work / "deck.dat"), work / "whole", ())
    first = max(increment for increment in found if increment <= MIDDLE)
    earlier = [row for row in table(work / "whole" / "status.csv") if int(row["increment"]) <= first]
    for name, changes, settings, lost in ACCEPTED:
        end = "*PHASE pull" if name == "dropped phases" else None
        deck = Deck(work / "changed.dat", *changes, end=end)
        output = fresh(work / name.replace(" ", "_"))
        said = runner.run(deck, output, found[first], settings=settings)
        check(f"restart after increment {first} of phase 'deeper'" in said, f"{name}: {said}")
        warning = [line for line in said.splitlines() if "warning W101: these records begin at the restart" in line]
        if lost:
            check(len(warning) == 1 and f": {lost};" in warning[0], f"{name}: {said}")
        else:
            check(not warning, f"{name}: {warning}")
        rows = table(output / "status.csv")
        check(rows[:len(earlier)] == earlier, f"{name}: the earlier rows of status.csv differ")
        check(not list(output.glob("*.part")), f"{name}: a part of a file is left")
        increments = [int(row["increment"]) for row in table(output / "history.csv")]
        check(increments == sorted(set(increments)), f"{name}: increments of history.csv: {increments}")
        # Lost rows begin with the first that is due: MIDDLE may be missed by `snapshots`.
        due = -(-first // HISTORY) * HISTORY if lost else 0
        check(increments[0] == due, f"{name}: history.csv begins at {increments[0]} instead of {due}")


def other_ways(runner, work):
    """Other numbers of threads, a relative path, a restart at the very end, lost records."""
    deck = Deck(work / "deck.dat")
    found, settings = snapshots(runner, deck, work / "whole", ())
    first = found[max(increment for increment in found if increment <= MIDDLE)]
    for threads in ("2", "4"):
        output = fresh(work / f"threads_{threads}")
        runner.run(deck, output, first, settings=settings, arguments=("--threads", threads))
        compare(output, work / "whole")
    output = work / "relative"
    shutil.copytree(work / "whole", output)
    runner.run(deck, ".", first.name, settings=settings, cwd=output)
    compare(output, work / "whole")
    output = work / "end"
    shutil.copytree(work / "whole", output)
    runner.run(deck, output, output / "restart.h5", settings=settings)
    compare(output, work / "whole")
    check((output / "status.csv").read_bytes() == (work / "whole" / "status.csv").read_bytes(),
          "status.csv has changed")
    source = fresh(work / "lost")
    shutil.copy(first, source / "restart.h5")
    (source / "fields.vtkhdf").write_bytes((work / "whole" / "fields.vtkhdf").read_bytes()[:20000])
    said = runner.run(deck, source, source / "restart.h5", settings=settings)
    check("warning W101: these records begin at the restart" in said
          and "history.csv status.csv fields.vtkhdf" in said, f"no warning:\n{said}")
    compare(source, work / "whole", ("restart.h5",))
    check(not list(source.glob("*.part")), "a part of a file is left")


def small_disk(runner, work):
    """No room to continue the records: those of the earlier run and the restart file stay as they are."""
    deck = Deck(work / "deck.dat")
    found, settings = snapshots(runner, deck, work / "whole", ())
    sizes = {name: (work / "whole" / name).stat().st_size for name in RECORDS}
    for limit in (1000, sizes["history.csv"] + 40000, sizes["fields.vtkhdf"]//2):
        output = work / str(limit)
        shutil.copytree(work / "whole", output)
        said = runner.run(deck, output, output / found[max(found)].name, 3, settings,
                          preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
        check("stopped E203: cannot write" in said, f"limit {limit}: {said}")
        compare(output, work / "whole")


def main():
    """Run all of them."""
    parser = parser_of_runs(__doc__)
    parser.add_argument("--every", type=int, default=6, help="interval of the increments from which runs continue")
    options = parser.parse_args()
    runner, work = Runner(options.program), fresh(options.work.resolve())

    def call(test, *arguments):
        return lambda: test(runner, fresh(work / "_".join([test.__name__, *arguments[:1]])), *arguments)

    tests = [(f"from increments, {name}", call(from_increments, name, options.every))
             for name in ("each", "motions", "bead", "tilt", "umfpack", "increments")]
    tests += [(f"from increments, {name}", call(from_increments, name, 3 * options.every))
              for name in ("solid_shell", "laws")]
    tests += [(test.__doc__.split(":")[0].rstrip("."), call(test))
              for test in (interrupted, stopped, changed, other_ways, small_disk)]
    raise SystemExit(call_tests(tests))


if __name__ == "__main__":
    main()
