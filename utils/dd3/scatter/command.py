# SPDX-License-Identifier: GPL-3.0-or-later
"""Scatter: run an input file with a sample of its parameters, and say how its results scatter and why.

    dd3 scatter hat.toml --cores 2

The file names the input file, its scattered parameters (*PARAMETER), the results (as --result of `dd3 study`), and
limits of results beyond which a part fails:

    deck = "hat.dat"
    runs = 30
    results = ["punch_fz:max", "thinning:max"]
    [inputs.friction]
    kind = "truncated"          # or normal, lognormal, uniform
    mean = 0.14
    deviation = 0.01
    low = 0.11
    high = 0.17
    [limits]
    "thinning:max" = 0.2

results.csv is written into --work. After an interruption the same command continues; runs that stopped are told.
"""

import argparse
import os
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dd3.command import new_parser
from dd3.errors import Problem
from dd3.programs import add_program, find_program, made_folder
from dd3.scatter.sample import distribution, latin_hypercube
from dd3.scatter.statistics import bands, failure
from dd3.scatter.surrogate import fit
from dd3.study.vary import Case, result, run_all, value_of, write_table

KEYS = {"deck", "runs", "seed", "inputs", "results", "limits", "correlations"}


def read(path: Path) -> dict[str, Any]:
    """Return the description of a scatter. Errors: not TOML; unknown or missing keys; limits of no result."""
    try:
        found = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise Problem(f"{path}: {error}") from None
    wrong, missing = sorted(set(found) - KEYS), sorted({"deck", "runs", "inputs", "results"} - set(found))
    if wrong or missing:
        raise Problem(f"{path}: " + (f"no key '{wrong[0]}'" if wrong else f"{missing[0]} is missing")
                      + f"; there are {', '.join(sorted(KEYS))}")
    if not isinstance(found["runs"], int) or found["runs"] < 2:
        raise Problem(f"{path}: runs is a number of runs from 2 on, not {found['runs']}")
    for name in found.get("limits", {}):
        if name not in found["results"]:
            raise Problem(f"{path}: the limit of '{name}' belongs to no result")
    return found


def cases_of(study: dict[str, Any], sample: np.ndarray, work: Path) -> list[Case]:
    """Return a case for each row of a sample; its folder names its values, so that changed inputs are run anew."""
    rows = [{name: f"{value:.8g}" for name, value in zip(study["inputs"], row)} for row in sample]
    return [Case(row, work / "_".join(f"{name}={value}" for name, value in row.items())) for row in rows]


def describe(study: dict[str, Any], sample: np.ndarray, distributions: list[Any], cases: list[Case]) -> list[str]:
    """Return the lines on each result: its scatter, the probability of failure, the indices of the inputs."""
    ended = np.array([case.results is not None for case in cases])
    table = np.array([case.results for case in cases if case.results is not None])
    lines = []
    for name, values in zip(study["results"], table.T):
        found = bands(values[:, None])
        lines.append(f"{name}: mean {found.mean[0]:.5g}, standard deviation {found.deviation[0]:.3g}, quantiles "
                     "5 % 50 % 95 %: " + " ".join(f"{value:.5g}" for value in found.quantiles[:, 0]))
        if name in study.get("limits", {}):
            beyond = failure(values > study["limits"][name])
            lines.append(f"  above {study['limits'][name]:g}: {beyond.failed} of {beyond.runs} runs that ended, "
                         f"probability {beyond.part:.3f} ({beyond.low:.3f} to {beyond.high:.3f}, 95 %)")
        try:
            if "correlations" in study:
                raise Problem("no indices: those of Sobol take independent inputs")
            surrogate = fit(sample[ended], distributions, values)
            first, total = surrogate.indices()
        except Problem as problem:
            lines.append(f"  {problem}")
            continue
        lines.append(f"  indices of Sobol, alone and with interactions (Q2 {surrogate.q2:.3f})")
        lines += [f"  {key:<20} {a:6.3f} {b:6.3f}" for key, a, b in zip(study["inputs"], first, total)]
    return lines


def main(words: Sequence[str] | None = None) -> None:
    """Make the scatter of the command line."""
    parser = new_parser("scatter", __doc__)
    parser.add_argument("study", type=Path, help="description of the scatter (TOML)")
    parser.add_argument("--work", type=Path, help="folder of the runs (default: the description's name with .scatter)")
    add_program(parser)
    parser.add_argument("--cores", type=int, default=os.cpu_count() or 1, metavar="N",
                        help="runs at a time, each with one thread (default: the number of cores)")
    options: argparse.Namespace = parser.parse_args(words)
    if options.cores < 1:
        parser.error("--cores takes a positive number")
    study, program = read(options.study), find_program(options.program)
    deck = options.study.parent / study["deck"]
    if not deck.is_file():
        raise Problem(f"{deck}: no such file")
    try:
        distributions = [distribution(**row) for row in study["inputs"].values()]
    except TypeError:
        raise Problem(f"{options.study}: an input has kind, mean, deviation, low and high") from None
    sample = latin_hypercube(distributions, study["runs"], study.get("correlations"), study.get("seed", 0))
    work = made_folder(options.work or options.study.with_suffix(".scatter"))
    cases = cases_of(study, sample, work)
    run_all(cases, program, deck, options.cores)
    for case in cases:
        if case.state == "reached":
            case.results = [value_of(case.folder, *result(name))[0] for name in study["results"]]
    write_table(work / "results.csv", cases, study["results"])
    stopped = [case for case in cases if case.state != "reached"]
    if len(cases) - len(stopped) > 1:
        print("\n".join(describe(study, sample, distributions, cases)))
    if stopped:
        raise Problem(f"{len(stopped)} of {len(cases)} runs did not reach their end and are not in the figures above; "
                      f"the first: {stopped[0].folder}")
