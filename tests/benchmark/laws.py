#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Print the table of the times of the laws that benchmark_material measures; --write: into docs/reports/speed.md.

    cmake --build --preset release --target benchmark_material
    tests/benchmark/laws.py --build build/release --write
"""
import argparse
from pathlib import Path

from dd3.errors import Problem, run
from dd3.pages import put_table, table
from dd3.programs import description, launch

REPORT = Path(__file__).resolve().parents[2] / "docs" / "reports" / "speed.md"
SHOWN = 3  # column of the time of strain increments of 1e-3; the first is elastic


def results(build):
    """Return the names of the laws with their times by kind, ns."""
    done = launch([build / "tests" / "benchmark" / "benchmark_material"])
    if done.code:
        raise Problem(f"benchmark_material: exit code {done.code}\n{done.errors}")
    found = {}
    for kind, law, *numbers in (line.split() for line in done.output.splitlines()[1:]):
        found.setdefault(kind, []).append((law, [float(number) for number in numbers]))
    return found


def main():
    """Print the table and write it if that is asked."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, required=True, help="folder of the build")
    parser.add_argument("--write", action="store_true", help=f"write {REPORT.name}")
    options = parser.parse_args()
    rows = [[kind, ", ".join(f"`{law}` {times[SHOWN] / 1000:.2g}" for law, times in laws)]
            for kind, laws in results(options.build).items()]
    text = table(["kind", "s per million"], rows)
    print(text)
    if options.write:
        put_table(REPORT, "laws", text, [description(options.build / "dd3imp")])


if __name__ == "__main__":
    run(main)
