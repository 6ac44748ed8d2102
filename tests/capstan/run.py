#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A thin strip that slides over a quarter of a cylinder, with several thicknesses and settings of the contact.

    run.py --program build/release/dd3imp --work build/capstan           check
    run.py --program build/release/dd3imp --work build/capstan --write   and put the table into docs/reports/capstan.md

The ratio of the tensions is exp(mu pi/2) = 1.25382 (Euler, Eytelwein). Each run must reach its end within 2 % of it,
with no node more than 1e-3 mm inside the cylinder in any increment, or stop with a message. The deck is that of
tests/cases/capstan; its loads are proportional to the thickness.
"""
import argparse
import math
import pathlib
import re
import sys

from dd3.programs import command, find_program, launch
from dd3.tables import number, read_table, totals

ROOT = pathlib.Path(__file__).resolve().parents[2]
CASE = ROOT / "tests" / "cases" / "capstan"
REPORT = ROOT / "docs" / "reports" / "capstan.md"
sys.path.insert(0, str(ROOT / "tests"))
from run_description import check_description  # noqa: E402

EXACT = math.exp(0.144 * math.pi / 2)
RADIUS, ELEMENTS, LENGTH, START = 10.0, 59, 23.708, -4.0
THICKNESS, LOAD = 0.02, 1.0  # of the deck: mm, N
SETTINGS = [(thickness, contact) for thickness in (0.02, 0.05)
            for contact in ("", "layer = 0.02", "formulation = mixed", "penalty = 100")]
ALLOWED_RATIO, ALLOWED_DEPTH = 0.02, 1e-3
HEAD = ["thickness, mm", "`*CONTACT`", "end", "increments", "cut back", "iterations", "T1/T2", "error, %",
        "deepest node, mm"]


def deck(thickness, contact):
    """Return the deck with another thickness and setting of the contact, and with the positions of all nodes of the lower face."""
    text = (CASE / "case.dat").read_text(encoding="utf-8")
    text = text.replace(f"1 {THICKNESS}", f"1 {thickness}").replace("cylinder.bez", str(CASE / "cylinder.bez"))
    text = re.sub(r"^(  load = x_max )(.*)$", lambda line: line[1] + " ".join(
        f"{float(word) * thickness / THICKNESS:g}" for word in line[2].split()), text, flags=re.MULTILINE)
    text = text.replace("*CONTACT\n", f"*CONTACT\n  {contact}\n")
    for i in range(ELEMENTS + 1):
        x = START + LENGTH * i / ELEMENTS
        text += f"*SET node{i}\n  near = {x:.9f} 0 0\n*HISTORY node{i}\n  set = node{i}\n  quantities = position\n"
    return text


def measure(program, work, thickness, contact):
    """Run one setting; return its row of the table and what is wrong."""
    name = re.sub("[ =]+", "_", f"{thickness:g} {contact}".strip())
    file, out = work / f"{name}.dat", work / name
    file.write_text(deck(thickness, contact), encoding="utf-8")
    done = launch(command(program, file, out, ["--quiet"]), timeout=600)
    check_description(out, done.code)
    history = read_table(out / "history.csv")
    total = totals(read_table(out / "status.csv"))
    depth = max(RADIUS - math.hypot(number(row, f"node{i}_x", out), number(row, f"node{i}_z", out) + RADIUS)
                for row in history for i in range(ELEMENTS + 1))
    depth = max(depth, 0.0)
    ratio = -LOAD * thickness / THICKNESS / number(history[-1], "left_rx", out)
    error, wrong = ratio / EXACT - 1, []
    if done.code == 3 and "dd3imp: stopped E2" in done.errors:
        end, results = "stopped", ["", ""]
    else:
        end, results = "reached", [f"{ratio:.5f}", f"{100 * error:+.2f}"]
        if done.code != 0:
            wrong.append(f"exit code {done.code}: {done.errors}")
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
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", required=True, type=pathlib.Path)
    parser.add_argument("--write", action="store_true", help="put the table into the report")
    options = parser.parse_args()
    program = find_program(options.program)
    options.work.mkdir(parents=True, exist_ok=True)
    lines, wrong = ["| " + " | ".join(HEAD) + " |", "|" + "---|" * len(HEAD)], []
    for setting in SETTINGS:
        row, faults = measure(program, options.work, *setting)
        lines.append("| " + " | ".join(row) + " |")
        wrong += faults
    print("\n".join(lines + wrong))
    if options.write:
        text = REPORT.read_text(encoding="utf-8")
        REPORT.write_text(re.sub(r"^\| thickness.*?\n(?!\|)", lambda _: "\n".join(lines) + "\n", text,
                                 flags=re.DOTALL | re.MULTILINE), encoding="utf-8")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
