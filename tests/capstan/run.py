#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "capstan", "timeout": 600}
"""A thin strip that slides over a quarter of a cylinder, with several thicknesses and settings of the contact.

    run.py --program build/release/dd3imp --work build/capstan

The ratio of the tensions is exp(mu pi/2) = 1.25382 (Euler, Eytelwein). Each run must reach its end within 2 % of it,
with no node more than 1e-3 mm inside the cylinder in any increment, or stop with a message. The deck is that of
tests/cases/capstan; its loads are proportional to the thickness.
"""
import math
import pathlib
import re
import sys

from dd3.pages import table
from dd3.programs import parser_of_runs
from dd3.tables import read_table, totals

ROOT = pathlib.Path(__file__).resolve().parents[2]
CASE = ROOT / "tests" / "cases" / "capstan"
sys.path.insert(0, str(ROOT / "tests"))
from bench import Bench  # noqa: E402

EXACT = math.exp(0.144 * math.pi / 2)
RADIUS, ELEMENTS, LENGTH, START = 10.0, 59, 23.708, -4.0
THICKNESS, LOAD = 0.02, 1.0  # of the deck: mm, N
SETTINGS = [(thickness, contact) for thickness in (0.02, 0.05)
            for contact in ("", "layer = 0.02", "formulation = mixed", "penalty = 100", "penalty = 1e4")]
ALLOWED_RATIO, ALLOWED_DEPTH = 0.02, 1e-3
HEAD = ["thickness, mm", "`*CONTACT`", "end", "increments", "cut back", "iterations", "T1/T2", "error, %",
        "deepest node, mm"]


def deck(thickness, contact):
    """Return the deck with another thickness and setting of the contact, and the positions of the lower nodes."""
    text = (CASE / "case.dat").read_text(encoding="utf-8")
    text = text.replace(f"1 {THICKNESS}", f"1 {thickness}").replace("cylinder.bez", str(CASE / "cylinder.bez"))
    text = re.sub(r"^(  load = x_max )(.*)$", lambda line: line[1] + " ".join(
        f"{float(word) * thickness / THICKNESS:g}" for word in line[2].split()), text, flags=re.MULTILINE)
    text = text.replace("*CONTACT\n", f"*CONTACT\n  {contact}\n")
    for i in range(ELEMENTS + 1):
        x = START + LENGTH * i / ELEMENTS
        text += f"*SET node{i}\n  near = {x:.9f} 0 0\n*HISTORY node{i}\n  set = node{i}\n  quantities = position\n"
    return text


def measure(bench, thickness, contact):
    """Run one setting; return its row of the table, and what is wrong."""
    name = re.sub("[ =]+", "_", f"{thickness:g} {contact}".strip())
    found = bench.run(name, deck(thickness, contact), codes=(0, 3))
    total = totals(read_table(found.folder / "status.csv"))
    depth = max(RADIUS - math.hypot(x, z + RADIUS) for i in range(ELEMENTS + 1)
                for x, z in zip(found.column(f"node{i}_x"), found.column(f"node{i}_z")))
    depth = max(depth, 0.0)
    ratio = -LOAD * thickness / THICKNESS / found.last("left_rx")
    error, wrong = ratio / EXACT - 1, []
    if found.code == 3 and "dd3imp: stopped E2" in found.errors:
        end, results = "stopped", ["", ""]
    else:
        end, results = "reached", [f"{ratio:.5f}", f"{100 * error:+.2f}"]
        if found.code != 0:
            wrong.append(f"exit code {found.code}: {found.errors}")
        if abs(error) > ALLOWED_RATIO:
            wrong.append(f"T1/T2 = {ratio:.5f}, expected {EXACT:.5f}")
    if depth > ALLOWED_DEPTH:
        wrong.append(f"a node is {depth:.3g} mm inside the cylinder")
    row = [f"{thickness:g}", f"`{contact}`" if contact else "", end,
           str(total.increments), str(total.cutbacks),
           str(total.iterations), *results, f"{depth:.1e}"]
    return row, [f"thickness {row[0]}, {contact}: {text}" for text in wrong]


def main():
    """Run all settings; exit code 1 if one of them ends wrong."""
    options = parser_of_runs(__doc__).parse_args()
    bench = Bench(options.program, options.work)
    rows, wrong = zip(*(measure(bench, *setting) for setting in SETTINGS), strict=True)
    wrong = [fault for faults in wrong for fault in faults]
    print(table(HEAD, rows), *wrong, sep="\n")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
