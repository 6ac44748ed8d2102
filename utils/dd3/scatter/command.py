# SPDX-License-Identifier: GPL-3.0-or-later
"""Scatter: run an input file with a sample of its parameters, and say how its results scatter and why.

    dd3 scatter hat.toml --cores 2

The file names the input file, its scattered parameters (*PARAMETER), the results, and limits of results beyond which a
part fails; docs/scatter.md explains its keys:

    deck = "hat.dat"
    runs = 30
    results = ["punch_fz:max", "thinning:max", "springback@rim", "forming_limit"]
    bands = ["thinning along y=0"]
    coils = "coils.csv"
    [places]
    rim = [95, 0]
    [inputs.friction]
    kind = "truncated"          # or normal, lognormal, uniform
    mean = 0.14
    deviation = 0.01
    low = 0.11
    high = 0.17
    [limits]
    "thinning:max" = 0.2

results.csv, bands.csv and pictures of the bands are written into --work. After an interruption the same command
continues; runs that were refused or stopped are told and left out.
"""

import argparse
import os
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from dd3.command import new_parser
from dd3.errors import Problem
from dd3.plot.figures import new_figure, save
from dd3.process import refuse
from dd3.programs import add_program, find_program, made_folder
from dd3.scatter.results import FORMING_LIMIT, SPRINGBACK, draw, fit_of, profiles, scalar
from dd3.scatter.sample import coil_rows, distribution, latin_hypercube, read_coils
from dd3.scatter.statistics import bands, failure
from dd3.scatter.surrogate import fit
from dd3.study.vary import REFUSED, Case, attempt, folder_name, run_all, write_table


@dataclass
class Scatter:
    """The description of a scatter: its file has a key for each member but `path`, of the same name."""

    path: Path
    deck: str
    results: list[str]
    runs: int = 0  # by default as many as there are coils
    seed: int = 0
    set: dict[str, Any] = field(default_factory=dict)
    inputs: dict[str, dict[str, Any]] = field(default_factory=dict)
    correlations: list[list[float]] | None = None
    coils: str | None = None
    limits: dict[str, float] = field(default_factory=dict)
    places: dict[str, list[float]] = field(default_factory=dict)
    bands: list[str] = field(default_factory=list)
    mirror: list[str] = field(default_factory=list)


TYPES: dict[str, type[Any]] = {
    "deck": str, "coils": str, "runs": int, "seed": int, "results": list, "bands": list, "mirror": list,
    "correlations": list, "set": dict, "inputs": dict, "limits": dict, "places": dict}


def read(path: Path) -> Scatter:
    """Return the description of a scatter. Errors: not TOML; unknown or missing keys; limits of no result."""
    try:
        found = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise Problem(f"{path}: {error}") from None
    refuse(path, found, TYPES, "")
    missing = sorted({"deck", "results"} - set(found))
    if missing:
        raise Problem(f"{path}: {missing[0]} is missing; there are {', '.join(TYPES)}")
    scatter = Scatter(path, **found)
    if not scatter.inputs and not scatter.coils:
        raise Problem(f"{path}: inputs is missing; expected [inputs.NAME], coils, or both")
    if "runs" in found and not (isinstance(scatter.runs, int) and scatter.runs >= 2):
        raise Problem(f"{path}: runs is a number of runs from 2 on, not {scatter.runs}")
    for name, limit in scatter.limits.items():
        if name not in scatter.results:
            raise Problem(f"{path}: the limit of '{name}' belongs to no result")
        if not isinstance(limit, int | float):
            raise Problem(f"{path}: the limit of '{name}' is {limit!r}; expected a number")
    for name, row in scatter.inputs.items():
        if not isinstance(row, dict):
            raise Problem(f"{path}: inputs.{name} is {row!r}; expected a table: kind, mean, deviation, low, high")
        if name in scatter.set:
            raise Problem(f"{path}: '{name}' is an input and in set; expected one")
    for name, place in scatter.places.items():
        if not isinstance(place, list) or len(place) != 2 or not all(isinstance(x, (int, float)) for x in place):
            raise Problem(f"{path}: the place '{name}' is {place!r}; expected x and y on the blank, mm")
    return scatter


class Sample:
    """The values of all runs: those drawn from distributions, (runs, inputs), and the coil of each run."""

    def __init__(self, scatter: Scatter) -> None:
        try:
            self.distributions = [distribution(**row) for row in scatter.inputs.values()]
        except TypeError:
            raise Problem(f"{scatter.path}: an input has kind, mean, deviation, low and high") from None
        coils = read_coils(scatter.path.parent / scatter.coils) if scatter.coils else []
        both = sorted(set(scatter.inputs) & set(coils[0] if coils else {}))
        if both:
            raise Problem(f"{scatter.path}: '{both[0]}' is an input and a column of {scatter.coils}; expected one")
        both = sorted(set(scatter.set) & set(coils[0] if coils else {}))
        if both:
            raise Problem(f"{scatter.path}: '{both[0]}' is in set and a column of {scatter.coils}; expected one")
        runs = scatter.runs or len(coils)
        if runs < 2:
            raise Problem(f"{scatter.path}: runs is missing; expected a number of runs from 2 on")
        try:
            ranks = None if scatter.correlations is None else np.array(scatter.correlations, float)
        except ValueError:
            raise Problem(f"{scatter.path}: correlations: expected rows of numbers") from None
        self.values = (latin_hypercube(self.distributions, runs, ranks, scatter.seed)
                       if self.distributions else np.zeros((runs, 0)))
        self.coils = [coils[i] for i in coil_rows(len(coils), runs, scatter.seed, alone=not self.distributions)]
        self.independent = not coils and scatter.correlations is None

    def cases(self, scatter: Scatter, work: Path) -> list[Case]:
        """Return a case for each run; its folder names its values, so that changed inputs are run anew."""
        settings = {name: str(value) for name, value in scatter.set.items()}
        found: list[Case] = []
        for i, row in enumerate(self.values):
            values = {name: f"{value:.8g}" for name, value in zip(scatter.inputs, row)}
            values |= self.coils[i] if self.coils else {}
            folder = work / folder_name({**values, **settings})
            if folder in [case.folder for case in found]:  # of coils with the same values
                folder = folder.with_name(f"{folder.name}_{i}")
            found.append(Case(values, folder, settings=settings))
        return found


def describe(scatter: Scatter, sample: Sample, cases: list[Case]) -> list[str]:
    """Return the lines on each result: its scatter, the probability of failure, the indices of the inputs."""
    ended = np.array([case.results is not None for case in cases])
    table = np.array([case.results for case in cases if case.results is not None])
    limits = {**{name: 1.0 for name in scatter.results if name == FORMING_LIMIT}, **scatter.limits}
    lines = []
    for name, values in zip(scatter.results, table.T):
        found = bands(values[:, None])
        lines.append(f"{name}: mean {found.mean[0]:.5g}, standard deviation {found.deviation[0]:.3g}, quantiles "
                     "5 % 50 % 95 %: " + " ".join(f"{value:.5g}" for value in found.quantiles[:, 0]))
        if name in limits:
            beyond = failure(values > limits[name])
            lines.append(f"  above {limits[name]:g}: {beyond.failed} of {beyond.runs} runs that ended, "
                         f"probability {beyond.part:.3f} ({beyond.low:.3f} to {beyond.high:.3f}, 95 %)")
        try:
            if not sample.independent:
                raise Problem("no indices: those of Sobol take independent inputs")
            surrogate = fit(sample.values[ended], sample.distributions, values)
            first, total = surrogate.indices()
        except Problem as problem:
            lines.append(f"  {problem}")
            continue
        lines.append(f"  indices of Sobol, alone and with interactions (Q2 {surrogate.q2:.3f})")
        lines += [f"  {key:<20} {a:6.3f} {b:6.3f}" for key, a, b in zip(scatter.inputs, first, total)]
    return lines


def write_bands(scatter: Scatter, runs: list[Path], work: Path) -> None:
    """Write the table and the picture of the bands."""
    figure, axes = new_figure((7, 2.6 * len(scatter.bands)), len(scatter.bands), squeeze=False)
    tables = []
    for name, place in zip(scatter.bands, axes[:, 0]):
        lengths, values, label = profiles(runs, name, scatter.mirror)
        found = bands(values)
        draw(place, lengths, found, label)
        tables.append(pd.DataFrame({"band": name, "length": lengths, "mean": found.mean, "deviation": found.deviation,
                                    **dict(zip(("q05", "q50", "q95"), found.quantiles))}))
    pd.concat(tables).to_csv(work / "bands.csv", index=False, float_format="%.7g")
    save(figure, work / "bands.png", 130)


def options_of(words: Sequence[str] | None) -> argparse.Namespace:
    """Return the options of a command line."""
    parser = new_parser("scatter", __doc__)
    parser.add_argument("study", type=Path, help="description of the scatter (TOML)")
    parser.add_argument("--work", type=Path, help="folder of the runs (default: the description's name with .scatter)")
    add_program(parser)
    parser.add_argument("--cores", type=int, default=os.cpu_count() or 1, metavar="N",
                        help="runs at a time, each with one thread (default: the number of cores)")
    options = parser.parse_args(words)
    if options.cores < 1:
        parser.error("--cores takes a positive number")
    return options


def main(words: Sequence[str] | None = None) -> None:
    """Make the scatter of the command line."""
    options = options_of(words)
    scatter, program = read(options.study), find_program(options.program)
    deck = options.study.parent / scatter.deck
    if not deck.is_file():
        raise Problem(f"{deck}: no such file")
    sample = Sample(scatter)
    work = made_folder(options.work or options.study.with_suffix(".scatter"))
    cases = sample.cases(scatter, work)
    run_all(cases, program, deck, options.cores, attempt)
    for case in cases:
        if case.state == "reached":
            case.results = [scalar(case.folder, name, scatter.places, scatter.mirror) for name in scatter.results]
    write_table(work / "results.csv", cases, scatter.results)
    ended = [case for case in cases if case.state == "reached"]
    if len(ended) > 1:
        print("\n".join(describe(scatter, sample, cases)))
        if any(name.startswith(SPRINGBACK) for name in (*scatter.results, *scatter.bands)):
            print(fit_of(ended[0].folder, scatter.mirror))
        if scatter.bands:
            write_bands(scatter, [case.folder for case in ended], work)
    lost = [case for case in cases if case.state != "reached"]
    if lost:
        refused = next((case for case in lost if case.state == REFUSED), None)
        raise Problem(f"{len(lost)} of {len(cases)} runs did not reach their end and are not in the figures above; "
                      f"the first: {lost[0].folder}" + (f"; refused: {refused.message}" if refused else ""))
