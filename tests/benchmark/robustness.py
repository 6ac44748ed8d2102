#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Print tables of the output of benchmark_robustness, and put their sums into docs/reports/robustness.md.

    cmake --build --preset release --target benchmark_robustness
    tests/benchmark/robustness.py --build build/release --write
"""
import argparse
from pathlib import Path

from dd3.errors import Problem, run
from dd3.pages import put_table, table
from dd3.programs import description, launch

REPORT = Path(__file__).resolve().parents[2] / "docs" / "reports" / "robustness.md"
# Laws with which each criterion is tried, as the output names them, and their columns.
LAWS = {"swift": "`swift`", "voce, prager, lemaitre_chaboche, lemaitre_chaboche": "back-stresses",
        "teodosiu_hu": "`teodosiu_hu`"}


def results(build):
    """Return the rows of the output: material and numbers of increments, failed and cut ones, parts and iterations,
    and the distance."""
    done = launch([build / "tests" / "benchmark" / "benchmark_robustness"])
    if done.code:
        raise Problem(f"benchmark_robustness: exit code {done.code}\n{done.errors}")
    rows = [line.strip("| ").split(" | ") for line in done.output.splitlines()[2:] if line.startswith("|")]
    return [(name, *map(int, counts), float(distance)) for name, *counts, distance in rows]


def tables(rows):
    """Return the tables by name: sums, by criterion, by hardening law."""
    first = {}
    for name, *numbers in rows:
        first.setdefault(name, numbers)
    criteria = [name.removesuffix(", swift") for name in first if name.endswith(", swift")]
    failed = sum(row[2] for row in rows)
    total = (f"{sum(row[1] for row in rows) / 1e6:.1f} million increments with {len(rows)} materials, of which "
             f"{failed or 'none'} failed. The resulting stress was on the yield surface within "
             f"{max(row[-1] for row in rows):.1e} of the flow stress, or inside it.")
    head = ["criterion", *(f"{title}: {column}" for title in LAWS.values() for column in ("substeps", "iterations"))]
    lines = []
    for criterion in criteria:
        law, _, title = criterion.partition(" ")
        line = [f"`{law}` {title}".strip()]
        for laws in LAWS:
            _, _, cut, parts, iterations, _ = first[f"{criterion}, {laws}"]
            line += [f"{cut} ({parts})" if cut else "0", str(iterations)]
        lines.append(line)
    largest = {}
    for name, _, _, cut, _, iterations, _ in rows[2 * len(criteria):]:
        criterion = max((each for each in criteria if name.startswith(f"{each}, ")), key=len)
        if f"{criterion}, perfect" in first:
            hardening = name.removeprefix(f"{criterion}, ").split(", ")[0]
            before = largest.get(hardening, (0, 0))
            largest[hardening] = max(before[0], iterations), before[1] + cut
    hardenings = table(["hardening", "largest number of iterations", "substeps"],
                       [[f"`{name}`", *map(str, values)] for name, values in largest.items()])
    return {"total": total, "criteria": table(head, lines), "hardening": hardenings}


def main():
    """Run the benchmark and print its tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True, type=Path, help="folder of the build")
    parser.add_argument("--write", action="store_true", help="put the sums into docs/reports/robustness.md")
    options = parser.parse_args()
    found = tables(results(options.build.resolve()))
    print(*found.values(), sep="\n\n")
    if options.write:
        put_table(REPORT, "total", found["total"], [description(options.build / "dd3imp")])


if __name__ == "__main__":
    run(main)
