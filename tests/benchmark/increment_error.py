#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare the difference of predictor and corrector with the error of the increment, and with the error of the run.

    cmake --build --preset release --target dd3imp benchmark_increment_error
    tests/benchmark/increment_error.py --build build/release --work build/increments
    tests/benchmark/increment_error.py ... --write       and put the tables into docs/reports/increments.md

The runs, their limits and the errors of a run are those of increments.py, with the same folder of the runs; the error of
an increment is the difference of the same increment in equal parts. An estimate follows an error where the correlation
of their logarithms (Pearson) and that of their ranks (Spearman) are near 1; a table gives both as "Pearson, Spearman".
"""
import argparse
import csv
from pathlib import Path

import increments
import numpy as np
from envelope import studies
from increments import BASE, REPORT, TRIALS, folder_of, outcome

from dd3.errors import Problem, run
from dd3.pages import put_table
from dd3.programs import launch, made_folder
from dd3.run import read_job

PARTS = 8  # of an increment
LEAST = 6  # values of a correlation
NAMES = [name for name in TRIALS if name not in increments.SLOW]
LEVELS = [f"accuracy = {level}" for level in increments.LEVELS]
VARIED = [*LEVELS, "rotation = 8", "rotation = 2", "depth = 0.02", "r_max = 2", "r_max = 0.5"]  # for the error of a run
STRIDES = {"accuracy = fine": 4}  # of the increments of which the error is measured; 1 with other limits
SETS = {"rms_sheet": "stress, sheet", "rms_quiet": "no change of contact", "rms_steady": "nor of yielding",
        "p95_sheet": "95 %, sheet", "p95_quiet": "95 %, no change of contact", "displacement": "displacement",
        "contact": "contact forces", "force": "force"}
SUMS = {"estimate, sheet": lambda rows: np.maximum(column(rows, "linear_rms_sheet"), 0),
        "estimate, no change of contact": lambda rows: np.maximum(column(rows, "linear_rms_quiet"), 0),
        "size squared": lambda rows: column(rows, "size")**2}
GLOBAL = {"force curve": 0, "force": 1, "thickness": 2, "draw-in": 3}  # places among the errors of a run


# ---- runs ------------------------------------------------------------------------------------------------------------

def measured(options, lines, name):
    """Measure the increments of a run in which a tool controls, unless that has been done; return their rows.

    The run is made before, and gives its deck. The error of an increment is measured with the levels alone.
    """
    outcome(options, lines, name)
    parts = PARTS if lines in LEVELS else 0
    folder = folder_of(options, lines, name)
    path = folder / f"increment_error_{parts}.csv"
    if not path.is_file():
        settings = [f"{key}={value}" for key, value in TRIALS[name].settings.items()]
        done = launch([options.build / "tests" / "benchmark" / "benchmark_increment_error", str(parts),
                       str(STRIDES.get(lines, 1)), folder / "deck.dat", *settings])
        if done.code:
            raise Problem(f"benchmark_increment_error, {folder}: exit code {done.code}\n{done.errors}")
        path.write_text(done.output, encoding="utf-8")
    with path.open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if float(row["tool_force"]) > 0]
    return rows


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
    """Return the table of correlations of estimate and error of increments."""
    return studies.table(["problem", "increments", *SETS.values()], [
        [name, str(np.count_nonzero(column(rows, "error_rms_sheet") > 0)),
         *(shown(correlation(column(rows, f"linear_{key}"), column(rows, f"error_{key}"))) for key in SETS)]
        for name, rows in found.items()])


def missed_table(found):
    """Return the table of what the estimate misses."""
    lines = []
    for name, rows in found.items():
        rows = [row for row in rows if float(row["error_rms_sheet"]) > 0]
        sheet, error = column(rows, "linear_rms_sheet"), column(rows, "error_rms_sheet")
        low, middle, high = np.percentile(sheet/error, (10, 50, 90))
        parts = [1 - np.sum(column(rows, f"{key}_share")*np.maximum(column(rows, f"error_rms_{key}"), 0)**2)
                 / np.sum(error**2) for key in ("quiet", "steady")]
        updated = column(rows, "updated_rms_sheet")
        lines.append([name, f"{100*np.median(error):.2g}", f"{100*np.median(column(rows, 'error_force')):.2g}",
                      f"{middle:.1f} ({low:.1f} to {high:.1f})", f"{np.median(column(rows, 'places')):.2f}",
                      *(f"{100*part:.0f}" for part in parts),
                      *(shown(correlation(column(rows, key), error)) for key in ("rotation", "size")),
                      shown(correlation(sheet, column(rows, "error_force"))),
                      f"{np.median(updated[updated > 0]/error[updated > 0]):.0f}"])
    return studies.table(["problem", "error of stress, %", "of force, %", "estimate/error", "rank over points",
                          "status changes, %", "or yielding, %", "rotation", "size", "force", "integrated/error"], lines)


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


def parser():
    """Return the parser of the command line."""
    found = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    found.add_argument("--build", required=True, type=Path, help="folder of the build")
    found.add_argument("--work", required=True, type=made_folder, help="folder of the runs")
    found.add_argument("--problems", nargs="+", choices=NAMES, default=NAMES, metavar="NAME",
                       help=f"problems (all): {', '.join(NAMES)}")
    found.add_argument("--write", action="store_true", help="put the tables into docs/reports/increments.md")
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
              "missed": missed_table(usual), "sum of the estimate": global_table(options, options.problems)}
    jobs = [read_job(folder_of(options, lines, name) / "results") for lines in VARIED for name in options.problems]
    for name, text in tables.items():
        print(f"{name}\n\n{text}", end="\n\n")
        if options.write:
            put_table(REPORT, name, text, jobs)


if __name__ == "__main__":
    run(main)
