#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compare the default settings with the published ones: the bending test on both meshes, with four penalties.

    tests/benchmark/default_settings.py --program build/release/dd3imp --work build/default_settings
    tests/benchmark/default_settings.py ... --write          and put the spread into docs/reports/default_settings.md

Each mesh is drawn to 40 mm with free edges and in plane strain. The default settings are the input file without its
blocks *LIMITS, *NEWTON and *SOLVER; the published ones, without the limit on the contact forces, stop at the first
increment that fails.
"""
import argparse
import pathlib

import numpy as np
from problems import BENDING, ROOT, with_paths, without

from dd3.errors import Problem, run
from dd3.pages import put_table
from dd3.programs import command, find_program, launch
from dd3.run import read_job
from dd3.tables import is_whole, read_table

REPORT = ROOT / "docs" / "reports" / "default_settings.md"
MESHES = {"(a)": "0", "(b)": "1"}
EDGES = {"free": "corner", "plane strain": "all"}
PENALTIES = (1e2, 1e3, 1e4, 1e5)
# Travels at which the punch forces are compared, mm.
TRAVELS = np.arange(10.0, 41.0, 5.0)


def measure(options, deck, name, settings):
    """Run a deck; return its end, increments, iterations, wasted share of them, %, and forces at the travels, N."""
    folder = options.work / name
    if launch(command(options.program, deck, folder, ["--quiet"], settings)).code not in (0, 3):
        raise Problem(f"{deck}: no result")
    status = [row for row in read_table(folder / "status.csv") if is_whole(row)]
    history = [row for row in read_table(folder / "history.csv") if is_whole(row) and row["phase"] == "draw"]
    travel, force = (np.array([abs(float(row[key])) for row in history]) for key in ("travel", "punch_fz"))
    iterations = sum(int(row["iterations"]) for row in status)
    accepted = [row for row in status if row["outcome"] == "accepted"]
    wasted = 100 * (1 - sum(int(row["iterations"]) for row in accepted) / iterations)
    forces = np.interp(TRAVELS, travel, force)
    forces[TRAVELS > travel[-1] + 1e-6] = np.nan
    return travel[-1], len(accepted), iterations, wasted, forces


def spread(forces):
    """Return the largest difference of forces at equal travel over their mean, %."""
    return 100 * np.nanmax(np.ptp(forces, axis=0) / np.mean(forces, axis=0))


def tables(options):
    """Return the two tables of the report."""
    default = options.work / "default.dat"
    text = without((BENDING / "bending.dat").read_text(encoding="utf-8"), "LIMITS", "NEWTON", "SOLVER")
    default.write_text(with_paths(text, BENDING), encoding="utf-8")
    runs = ["| mesh | edges | penalty, N/mm | settings | reached, mm | increments | iterations | wasted, % | force at "
            "the end, N | difference from the default, % |", "|---|---|---|---|---|---|---|---|---|---|"]
    groups = ["| mesh | edges | spread over the penalties, % |", "|---|---|---|"]
    for mesh, skew in MESHES.items():
        for edges, held in EDGES.items():
            forces = []
            for penalty in PENALTIES:
                settings = {"skew": skew, "held": held, "p": f"{penalty:g}"}
                name = f"{mesh[1]}_{held}_{penalty:g}"
                row = measure(options, default, name, settings)
                paper = measure(options, BENDING / "bending.dat", f"{name}_published",
                                {**settings, "force": "off"})
                forces.append(row[-1])
                apart = 100 * np.abs(paper[-1] / row[-1] - 1)
                runs.append(line(mesh, edges, penalty, "default", row, ""))
                runs.append(line(mesh, edges, penalty, "published", paper,
                                 f"{np.nanmax(apart):.2f}" if np.any(np.isfinite(apart)) else ""))
                print(*runs[-2:], sep="\n", flush=True)
            groups.append(f"| {mesh} | {edges} | {spread(np.array(forces)):.2f} |")
    return "\n".join(groups), "\n".join(runs)


def line(mesh, edges, penalty, settings, row, apart):
    """Return a row of the table of runs."""
    reached, increments, iterations, wasted, forces = row
    force = "" if np.isnan(forces[-1]) else f"{forces[-1]:.1f}"
    cells = [mesh, edges, f"{penalty:g}", settings, f"{reached:.2f}", str(increments), str(iterations), f"{wasted:.1f}",
             force, apart]
    return f"| {' | '.join(cells)} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", required=True, type=pathlib.Path)
    parser.add_argument("--write", action="store_true", help="put the spread into docs/reports/default_settings.md")
    options = parser.parse_args()
    options.program, options.work = find_program(options.program), options.work.resolve()
    options.work.mkdir(parents=True, exist_ok=True)
    spreads, runs = tables(options)
    print(spreads, runs, sep="\n\n")
    if options.write:
        put_table(REPORT, "spread", spreads, [read_job(path.parent) for path in options.work.glob("*/run.json")])


if __name__ == "__main__":
    run(main)
