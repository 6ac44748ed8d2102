#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Print the tables of the times of the laws that benchmark_material and benchmark_friction measure; --write: into
docs/reports/speed.md.

    cmake --build --preset release --target benchmark_material benchmark_friction
    tests/benchmark/laws.py --build build/release --write

The table `laws` has the laws of the stress. The table `additions` has limits, which do not change the stress, and laws of
friction, each beside the time without one, of the same runs.
"""
import argparse
from pathlib import Path

from dd3.errors import Problem, run
from dd3.pages import put_table, table
from dd3.programs import description, launch

REPORT = Path(__file__).resolve().parents[2] / "docs" / "reports" / "speed.md"
SHOWN = 3  # column of the time of strain increments of 1e-3; the first is elastic
LIMITS = "limits"  # kind of benchmark_material that the table of the additions has
TITLES = {LIMITS: "limits, an update", "compliant": "friction, a compliant point", "mixed": "friction, a mixed point"}


def measured(build, name, column, *words):
    """Return the time of each law by kind, ns, in a column of a benchmark."""
    done = launch([build / "tests" / "benchmark" / name, *words])
    if done.code:
        raise Problem(f"{name}: exit code {done.code}\n{done.errors}")
    found = {}
    for kind, law, *numbers in (line.split() for line in done.output.splitlines()[1:]):
        found.setdefault(kind, {})[law] = float(numbers[column])
    return found


def laws(build):
    """Return the rows of the laws of the stress."""
    for kind, times in measured(build, "benchmark_material", SHOWN).items():
        if kind != LIMITS:
            yield [kind, ", ".join(f"`{law}` {time / 1000:.2g}" for law, time in times.items())]


def additions(build, repeats=3):
    """Return the rows of limits and friction, the smallest times of several runs: each with its ratio to the first."""
    runs = [measured(build, "benchmark_material", SHOWN, LIMITS) | measured(build, "benchmark_friction", 0)
            for _ in range(repeats)]
    for kind in runs[0]:
        times = {law: min(found[kind][law] for found in runs) for law in runs[0][kind]}
        (first, least), *others = times.items()
        yield [TITLES[kind], ", ".join([f"{first} {least / 1000:.2g}", *(
            f"`{law}` {time / 1000:.2g} ({time / least:.2f})" for law, time in others)])]


TABLES = {"laws": laws, "additions": additions}


def main():
    """Print the tables and write them if that is asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, required=True, help="folder of the build")
    parser.add_argument("--table", choices=TABLES, help="only one of the tables")
    parser.add_argument("--write", action="store_true", help=f"write {REPORT.name}")
    options = parser.parse_args()
    for name in [options.table] if options.table else TABLES:
        text = table(["kind", "s per million"], TABLES[name](options.build))
        print(text)
        if options.write:
            put_table(REPORT, name, text, [description(options.build / "dd3imp")])


if __name__ == "__main__":
    run(main)
