#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare the difference of predictor and corrector with the error of the increment, and with the error of the run.

    cmake --build --preset release --target dd3imp benchmark_increment_error
    tests/benchmark/increment_error.py --build build/release --work build/increments

The runs, their limits and the errors of a run are those of increments.py, with the same folder of the runs. The error
of an increment is its difference from the same one in equal parts. A correlation is given as that of the logarithms
(Pearson) and that of the ranks (Spearman).
"""
import argparse
import csv
from pathlib import Path

import increments
import numpy as np
from envelope import Job, Results, make, studies
from increments import BASE, TRIALS, curve_error, folder_of, largest, outcome, reference_of
from problems import BENDING, merged, of_file, without

from dd3.errors import Problem, run
from dd3.programs import launch, made_folder

PARTS = 8  # of an increment
LEAST = 6  # values of a correlation
NAMES = [name for name in TRIALS if name not in increments.SLOW]
LEVELS = [f"accuracy = {level}" for level in increments.LEVELS]
VARIED = [*LEVELS, "rotation = 8", "rotation = 2", "depth = 0.02", "r_max = 2", "r_max = 0.5"]  # for the error of a run
HELD = (0.1, 0.05, 0.025)  # estimates that a controller holds
FREE = ("strain = 0.4", "rotation = 12", "depth = 0.1", "r_max = 4")  # limits beside it
STRIDES = {"accuracy = fine": 4}  # of the increments of which the error is measured; 1 with other limits
PENALTIES = ("1e2", "1e3", "1e4", "1e5")  # N/mm
SETTINGS = {"standard": {"limits": BASE}, "fine": {"limits": "accuracy = fine"},
            "reference": {"limits": increments.REFERENCE},
            "standard, tolerance 1e-5": {"limits": BASE, "newton": "tolerance = 1e-5"},
            "reference, tolerance 1e-5": {"limits": increments.REFERENCE, "newton": "tolerance = 1e-5"}}
FALL = (16.0, 19.0)  # travels between which the force of mesh (a) falls, mm
SETS = {"rms_sheet": "stress, sheet", "rms_quiet": "no change of contact", "rms_steady": "nor of yielding",
        "p95_sheet": "95 %, sheet", "displacement": "displacement", "contact": "contact forces", "force": "force"}
SUMS = {"estimate, sheet": lambda rows: np.maximum(column(rows, "linear_rms_sheet"), 0),
        "estimate, no change of contact": lambda rows: np.maximum(column(rows, "linear_rms_quiet"), 0),
        "size squared": lambda rows: column(rows, "size")**2}
GLOBAL = {"force curve": 0, "force": 1, "thickness": 2, "draw-in": 3}  # places among the errors of a run


# ---- runs ------------------------------------------------------------------------------------------------------------

def rows_of(options, name, folder, parts=0, stride=1, held=0.0):
    """Run the benchmark on the deck in a folder, unless that has been done; return the rows in which a tool controls.

    See increment_error.f90 for the arguments.
    """
    path = folder / (f"increments_held_{held:g}.csv" if held else f"increments_{parts}.csv")
    if not path.is_file():
        settings = [f"{key}={value}" for key, value in TRIALS[name].settings.items()]
        done = launch([options.build / "tests" / "benchmark" / "benchmark_increment_error",
                       *map(str, (parts, stride, held)), folder / "deck.dat", *settings])
        if done.code:
            raise Problem(f"benchmark_increment_error, {folder}: exit code {done.code}\n{done.errors}")
        path.write_text(done.output, encoding="utf-8")
    with path.open(encoding="utf-8") as file:
        return [row for row in csv.DictReader(file) if float(row["tool_force"]) > 0]


def measured(options, lines, name):
    """Return the rows of a run, which is made before. The error of an increment is measured with the levels alone."""
    outcome(options, lines, name)
    return rows_of(options, name, folder_of(options, lines, name), PARTS if lines in LEVELS else 0,
                   STRIDES.get(lines, 1))


def held_rows(options, name, held):
    """Return the rows of a run whose increments hold the estimate."""
    folder = made_folder(folder_of(options, "held", name))
    text = merged(TRIALS[name].job().deck(folder), "LIMITS", FREE)
    (folder / "deck.dat").write_text(text, encoding="utf-8")
    return rows_of(options, name, folder, held=held)


def force_error(options, name, rows):
    """Return the error of the force of rows, as outcome() has it: that of the curve, or without one the largest, %."""
    trial = TRIALS[name]
    exact, reference = reference_of(options, name)
    tool = trial.curve[0] if trial.curve else "punch"
    found = Results(reference.folder)
    last = rows[-1]["phase"]
    after = [row for row in found.history if float(row["travel"]) >= float(rows[-1]["travel"]) and row["phase"] != last]
    found.history = [{"travel": row["travel"], f"{tool}_fz": row["tool_force"]} for row in rows] + after
    if trial.curve:
        return curve_error(found, reference, trial.curve)
    values = {label: quantity(found) for label, quantity in trial.quantities["force"].items()}
    return largest("force", values, values, exact)


def column(rows, name):
    """Return a column of rows."""
    return np.array([float(row[name]) for row in rows])


# ---- correlations ----------------------------------------------------------------------------------------------------

def ranks(values):
    """Return the ranks of values, the mean one of equal values."""
    _, place, count = np.unique(values, return_inverse=True, return_counts=True)
    return (np.cumsum(count) - 0.5*(count - 1))[place]


def correlation(estimate, error):
    """Return the correlation of logarithms and that of ranks, None with too few positive values."""
    kept = (estimate > 0) & (error > 0)
    estimate, error = estimate[kept], error[kept]
    if np.count_nonzero(kept) < LEAST or np.ptp(estimate) == 0 or np.ptp(error) == 0:
        return None
    return tuple(float(np.corrcoef(*pair)[0, 1]) for pair in ((np.log(estimate), np.log(error)),
                                                              (ranks(estimate), ranks(error))))


def shown(pair):
    """Return a correlation as text."""
    return "" if pair is None else f"{pair[0]:.2f}, {pair[1]:.2f}"


# ---- tables ----------------------------------------------------------------------------------------------------------

def local_table(found):
    """Return the table of correlations of estimate and error of increments, and of rotation and error of the stress."""
    lines = []
    for name, rows in found.items():
        rows = with_error(rows)
        pairs = [(f"linear_{key}", f"error_{key}") for key in SETS] + [("rotation", "error_rms_sheet")]
        lines.append([name, str(len(rows)),
                      *(shown(correlation(*(column(rows, key) for key in pair))) for pair in pairs)])
    return studies.table(["problem", "increments", *SETS.values(), "rotation"], lines)


def with_error(rows):
    """Return the rows of the increments of which the error has been measured."""
    return [row for row in rows if float(row["error_rms_sheet"]) > 0]


def missed_table(options, found):
    """Return the table of what the estimate misses."""
    lines = []
    for name, rows in found.items():
        rows = with_error(rows)
        sheet, error = column(rows, "linear_rms_sheet"), column(rows, "error_rms_sheet")
        low, middle, high = np.percentile(sheet/error, (10, 50, 90))
        parts = [1 - np.sum(column(rows, f"{key}_share")*np.maximum(column(rows, f"error_rms_{key}"), 0)**2)
                 / np.sum(error**2) for key in ("quiet", "steady")]
        updated, force = column(rows, "updated_rms_sheet"), column(rows, "tool_force")
        errors = outcome(options, BASE, name).errors
        lines.append([name, f"{100*np.median(error):.2g}", f"{middle:.1f} ({low:.1f} to {high:.1f})",
                      f"{np.median(updated[updated > 0]/error[updated > 0]):.0f}",
                      f"{np.median(column(rows, 'places')):.2f}", *(f"{100*part:.0f}" for part in parts),
                      shown(correlation(sheet, column(rows, "error_force"))),
                      f"{100*np.sum(column(rows, 'error_force')*force)/np.mean(force):.2g}",
                      f"{errors[0] or errors[1]:.2f}"])
    return studies.table(["problem", "error, %", "estimate/error", "integrated/error", "over points", "status, %",
                          "or yielding, %", "force", "sum, %", "run, %"], lines)


def penalty_table(options):
    """Return the table of forces of mesh (a) at 17 mm with the mixed formulation, by limits and penalty."""
    lines = []
    for title, blocks in SETTINGS.items():
        curves = []
        for penalty in PENALTIES:
            job = Job(lambda _: without(of_file(BENDING / "bending.dat")(None), "LIMITS", "NEWTON", "SOLVER"), 0.78, {},
                      {"skew": 0, "p": penalty})
            folder = folder_of(options, f"penalty {penalty} {title}", "bending_test_a")
            make(options, job, folder, blocks)
            travels, curve = Results(folder / "results").resampled("punch_fz", *FALL)
            curves.append(curve)
        spread = 100*np.ptp(curves, axis=0)/np.mean(curves, axis=0)
        worst, place = np.argmax(spread), np.argmin(np.abs(travels - 17.0))
        lines.append([title, *(f"{curve[place]:.0f}" for curve in curves), f"{spread[place]:.2f}",
                      f"{spread[worst]:.2f} at {travels[worst]:.1f} mm"])
    return studies.table(["limits", *(f"p = {penalty}, N" for penalty in PENALTIES), "spread at 17 mm, %",
                          "largest, %"], lines)


def global_table(options, names):
    """Return the table of correlations of sums over the increments and errors of the run, over sets of limits.

    The sums are those of the estimate and of the square of the increment, as an error of second order has it.
    """
    lines = []
    for name in names:
        runs = [(measured(options, text, name), outcome(options, text, name).errors) for text in VARIED]
        for title, values in SUMS.items():
            sums = np.array([np.sum(values(rows)) for rows, _ in runs])
            errors = [np.array([error[place] or 0.0 for _, error in runs]) for place in GLOBAL.values()]
            lines.append([name, title, f"{min(sums):.2g} to {max(sums):.2g}",
                          *(shown(correlation(sums, error)) for error in errors)])
    return studies.table(["problem", "sum of", "from, to", *GLOBAL], lines)


def iterations(rows):
    """Return the number of iterations of all attempts in rows."""
    return sum(int(row["iterations"]) for row in rows)


def control_table(options, names):
    """Return the table of runs whose increments hold the estimate, beside those of limits with the same error."""
    lines = []
    for name in names:
        place = 0 if TRIALS[name].curve else 1
        front = []
        for effort, error in sorted((iterations(measured(options, text, name)),
                                     outcome(options, text, name).errors[place]) for text in VARIED):
            if not front or error < front[-1][1]:
                front.append((effort, error))
        effort, error = np.log(np.array(front[::-1])).T
        line = [name]
        for held in HELD:
            rows = held_rows(options, name, held)
            here = force_error(options, name, rows)
            line += [f"{here:.2f}", str(iterations(rows)),
                     ("at most " if np.log(here) > error[-1] else "")
                     + f"{np.exp(np.interp(np.log(here), error, effort)):.0f}"]
        lines.append(line)
    return studies.table(["problem", *(f"{held:g}: {title}" for held in HELD
                                       for title in ("error, %", "iterations", "limits"))], lines)


def parser():
    """Return the parser of the command line."""
    found = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    found.add_argument("--build", required=True, type=Path, help="folder of the build")
    found.add_argument("--work", required=True, type=made_folder, help="folder of the runs")
    found.add_argument("--problems", nargs="+", choices=NAMES, default=NAMES, metavar="NAME",
                       help=f"problems (all): {', '.join(NAMES)}")
    found.add_argument("--seconds", type=float, default=1800.0, help="processor time of a run, s (1800)")
    found.set_defaults(again=False)
    return found


def main():
    """Make the runs and print their tables."""
    options = parser().parse_args()
    options.work, options.build = options.work.resolve(), options.build.resolve()
    options.program = options.build / "dd3imp"
    usual = {name: measured(options, BASE, name) for name in options.problems}
    pooled = {name: [row for lines in LEVELS for row in measured(options, lines, name)] for name in options.problems}
    tables = {"estimate": local_table(usual), "estimate of all levels": local_table(pooled),
              "missed": missed_table(options, usual), "sum of the estimate": global_table(options, options.problems),
              "control": control_table(options, options.problems)}
    tables["penalties"] = penalty_table(options)
    for name, text in tables.items():
        print(f"{name}\n\n{text}", end="\n\n")


if __name__ == "__main__":
    run(main)
