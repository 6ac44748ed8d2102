#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure the error per increment: forming problems with each accuracy of *LIMITS and with each limit alone.

    tests/benchmark/increments.py --program build/release/dd3imp --work build/increments
    tests/benchmark/increments.py ... --write            and put the sums into docs/reports/increments.md
    tests/benchmark/increments.py ... --problems square_cup_15 --limits "rotation = 3" "rotation = 3; depth = 0.2"

--limits gives lines of *LIMITS in place of the levels. Each run is kept in the folder of its limits and problem, and
not repeated. The reference has a quarter of the limits of `fine`. The deviation of the curve of the
punch force is the root mean square of the difference over that of the reference; of the other quantities the largest
deviation is given.
"""
import argparse
import importlib
import re
from dataclasses import dataclass, field

import numpy as np
from envelope import DRAW_BENDING, ENVELOPE, Job, Results, deviation, draw_in, forces, make, mean_forces, measure, \
    shown, studies, thinnest
from problems import BENDING, ROOT, of_file, without

from dd3.errors import run
from dd3.pages import put_table
from dd3.programs import find_program, made_folder
from dd3.run import read_job

draw_bending = importlib.import_module("draw_bending")  # the path is set by envelope
REPORT = ROOT / "docs" / "reports" / "increments.md"
LEVELS = ("draft", "standard", "fine")
BASE = "accuracy = standard"  # limits whose time is the unit
REFERENCE = "strain = 0.00625; rotation = 0.25; depth = 0.0125; r_max = 0.125"
SINGLE = ("strain = 0.2", "strain = 0.025", "rotation = 8", "rotation = 2", "depth = 0.4", "depth = 0.02", "r_max = 2",
          "r_max = 0.5")
SLOW = ("square_cup_30",)  # not with single limits
KINDS = {"force": "force, %", "thickness": "thickness, %", "draw-in": "draw-in, %", "angle": "angle, degrees"}
ERRORS = ["force curve, %", *KINDS.values()]
EFFORT = ["increments", "cut-backs", "iterations", "time"]


# ---- problems --------------------------------------------------------------------------------------------------------

@dataclass
class Trial:
    """A problem: deck, thickness, tool and travels of the curve of the force, quantities by kind, parameters of --set.

    Without a curve the force is compared by its quantities alone.
    """

    deck: object
    thickness: float
    curve: tuple
    quantities: dict
    settings: dict = field(default_factory=dict)

    def job(self):
        """Return the problem as one of the envelope."""
        return Job(lambda folder: without(self.deck(folder), "LIMITS", "NEWTON", "SOLVER"), self.thickness,
                   {label: value for kind in self.quantities.values() for label, value in kind.items()}, self.settings)


def flange_angle(found):
    """Return the angle between the flange and the bottom of the strip after springback, degrees."""
    if found.end("punch_fz", "springback") is None:
        return None
    start, line = (draw_bending.middle_line(found.fields, step) for step in (0, found.fields.count - 1))
    flange, bottom = (draw_bending.slope(draw_bending.straight(line[part]))
                      for part in (start[:, 0] > 75, start[:, 0] < draw_bending.BOTTOM))
    return flange - bottom


def strip(force):
    """Return draw bending with springback and a force of the holder, N/mm."""
    def deck(_):
        return of_file(DRAW_BENDING)(None) + "*SET end\n  near = 175 0 0\n*HISTORY end\n  set = end\n" \
            "  quantities = draw_in\n"
    return Trial(deck, 0.78, ("punch", 5, 30), {
        "force": mean_forces("punch", 2.5, 7.5, 12.5, 17.5, 22.5, 27.5), "thickness": thinnest(30),
        "draw-in": {"draw-in at 30 mm, mm": lambda found: found.at("end_draw_in", 30)},
        "angle": {"angle of the flange, degrees": flange_angle}}, {"holder": -force, "depth": 30})


def cup(name):
    """Return a square cup of the envelope."""
    job = ENVELOPE[name]
    across = int(job.settings["divisions"].split()[0])
    return Trial(job.deck, job.thickness, ("punch", 3, 40), {
        "force": forces("punch", 3, 5, 10, 20, 30, 40), "thickness": {**thinnest(20), **thinnest(40)},
        "draw-in": {**draw_in(across, 20), **draw_in(across, 40)}}, job.settings)


def mesh_a(_):
    """Return the bending test on mesh (a) with compliant contact."""
    return without(of_file(BENDING / "bending.dat")(None), "CONTACT").replace("*PHASE", "*CONTACT\n*PHASE", 1)


TRIALS = {
    "squeeze": Trial(ENVELOPE["squeeze_friction"].deck, 1.0, ("ram", 0.05, 0.4),
                     {"force": forces("ram", 0.1, 0.2, 0.3, 0.4)}, {"friction": 0.05}),
    "u_bend": Trial(ENVELOPE["u_bend"].deck, 1.0, ("punch", 1, 9), {"force": mean_forces("punch", 1, 2, 4, 6, 8)}),
    "air_bending": Trial(ENVELOPE["air_bending"].deck, 1.0, None, {"force": mean_forces("punch", 2.5, 5, 10, 15, 20)}),
    "bending_test_a": Trial(mesh_a, 0.78, ("punch", 1, 40), {"force": forces("punch", 5, 10, 17, 25, 40)},
                            {"skew": 0}),
    "bending_test_shell": Trial(of_file(BENDING / "solid_shell.dat"), 0.78, ("punch", 1, 40),
                                {"force": forces("punch", 5, 10, 17, 25, 40)}),
    "strip_19.6kN": strip(280),
    "strip_2.45kN": strip(35),
    "square_cup_15": cup("steel_15"),
    "square_cup_30": cup("steel_30"),
}


# ---- runs ------------------------------------------------------------------------------------------------------------

@dataclass
class Outcome:
    """Effort of a run, processor time (s) last, and its deviations from the reference in the order of ERRORS."""

    effort: list
    errors: list


def folder_of(options, lines, name):
    """Return the folder of a run."""
    return options.work / re.sub(r"[^\w.]+", "_", lines) / name


def curve_error(found, reference, curve):
    """Return the root mean square difference of two curves of the force over that of the reference, %."""
    if not curve:
        return None
    tool, first, last = curve
    curves = [each.resampled(f"{tool}_fz", first, last) for each in (found, reference)]
    if not all(curves):
        return None
    (_, force), (_, exact) = curves
    return float(100*np.sqrt(np.mean((force - exact)**2)/np.mean(exact**2)))


def largest(kind, labels, values, exact):
    """Return the largest deviation of a kind of quantities; None without any."""
    apart = [values[label] - exact[label] if kind == "angle" else deviation(values[label], exact[label])
             for label in labels if None not in (values[label], exact[label])]
    return max(map(abs, apart), default=None)


def reference_of(options, name):
    """Make the reference of a problem unless it is there; return its values and results."""
    folder = folder_of(options, "reference", name)
    make(options, TRIALS[name].job(), folder, {"limits": REFERENCE})
    return measure(folder, TRIALS[name].job()).values, Results(folder / "results")


def outcome(options, lines, name):
    """Make a run unless it is there; return its outcome."""
    trial, folder = TRIALS[name], folder_of(options, lines, name)
    make(options, trial.job(), folder, {"limits": lines})
    found = measure(folder, trial.job())
    if not found.reached:
        print(f"{name}, {lines}: {found.effort[0]}", flush=True)
    exact, exact_results = reference_of(options, name)
    _, increments, cutbacks, iterations, _, seconds, _ = found.effort
    errors = [largest(kind, trial.quantities.get(kind, {}), found.values, exact) for kind in KINDS]
    return Outcome([int(increments), int(cutbacks), int(iterations), float(seconds)],
                   [curve_error(Results(folder / "results"), exact_results, trial.curve), *errors])


# ---- tables ----------------------------------------------------------------------------------------------------------

def cells(found, base):
    """Return the cells of a run, its time over that of a base."""
    return [*map(str, found.effort[:-1]), f"{found.effort[-1]/base.effort[-1]:.2f}",
            *(shown(value, "{:.2f}") for value in found.errors)]


def summed(found):
    """Return the sum of the effort and the largest deviations of runs."""
    errors = [[value for value in column if value is not None] for column in zip(*(each.errors for each in found),
                                                                              strict=True)]
    return Outcome([sum(column) for column in zip(*(each.effort for each in found), strict=True)],
                   [max(column, default=None) for column in errors])


def table(options, sets, names):
    """Return the tables of sets of limits over problems, all problems together and each, and the runs."""
    found = {lines: {name: outcome(options, lines, name) for name in names} for lines in dict.fromkeys((*sets, BASE))}
    together = {lines: summed(runs.values()) for lines, runs in found.items()}
    each = [[name, lines, *cells(found[lines][name], found[BASE][name])] for name in names for lines in sets]
    return (studies.table(["limits", *EFFORT, *ERRORS], [[lines, *cells(together[lines], together[BASE])]
                                                         for lines in sets]),
            studies.table(["problem", "limits", *EFFORT, *ERRORS], each),
            [read_job(folder_of(options, lines, name) / "results") for lines in found for name in names])


def parser():
    """Return the parser of the command line."""
    found = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    found.add_argument("--program", type=find_program, required=True, help="the program dd3imp")
    found.add_argument("--work", required=True, type=made_folder, help="folder of the runs")
    found.add_argument("--problems", nargs="+", choices=TRIALS, default=list(TRIALS), metavar="NAME",
                       help=f"problems (all): {', '.join(TRIALS)}")
    found.add_argument("--limits", nargs="+", metavar="LINES", help="lines of *LIMITS, separated by semicolons")
    found.add_argument("--write", action="store_true", help="put the sums into docs/reports/increments.md")
    found.add_argument("--seconds", type=float, default=1800.0, help="processor time of a run, s (1800)")
    found.set_defaults(again=False)
    return found


def main():
    """Make the runs and print their tables."""
    options = parser().parse_args()
    options.work = options.work.resolve()
    if options.limits:
        print(*table(options, options.limits, options.problems)[:2], sep="\n\n")
        return
    quick = [name for name in options.problems if name not in SLOW]
    for name, sets, problems in (("levels", [f"accuracy = {level}" for level in LEVELS], options.problems),
                                 ("limits", [BASE, *SINGLE], quick)):
        together, each, jobs = table(options, sets, problems)
        print(together, each, sep="\n\n", end="\n\n")
        if options.write:
            put_table(REPORT, name, together, jobs)


if __name__ == "__main__":
    run(main)
