#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The set of parts, from each part to its drawn sheet: the tools by `dd3 tool`, and the run of its input file as it is.

    part_runs.py --program build/release/dd3imp --work build/part_runs                print the table
    part_runs.py --program build/release/dd3imp --work build/part_runs tray hat       of some parts
    part_runs.py ... --write                                                          put them into docs/parts.md

A part that has been run is not run again, and one that is not named keeps its row in docs/parts.md. Surfaces are drawn
with a sheet of 1 mm.
"""
import argparse
import os
import re
import subprocess
import sys
from pathlib import Path

from part_set import PARTS, write

import dd3
from dd3 import springback
from dd3.errors import run
from dd3.pages import put_table, table
from dd3.run import read_job
from dd3.sheet import Sheet

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "parts.md"
TITLES = ["part", "tools", "patches", "processor time, s", "thinning estimated, %", "increments", "cut-backs",
          "processor time, min", "path left, t", "off the tools, t", "thinning, %", "springback, mm", "warnings"]
ON_THE_PAGE = [title for title in TITLES
               if title not in ("tools", "patches", "processor time, s", "increments", "cut-backs")]


def timed(words):
    """Run a command; return its processor time, s, and what it has printed."""
    before = os.times()
    made = subprocess.run(words, capture_output=True, text=True, check=False)
    after = os.times()
    return after.children_user + after.children_system - before.children_user - before.children_system, made


def made_tools(name, work, program):
    """Make the tools of a part with the forces that the program gives; return what it says or the error, the number of
    patches, the processor time, s, and the estimated thinning, per cent."""
    part = PARTS[name]
    folder, said = work / name, work / f"{name}.txt"
    if not said.exists():
        words = [sys.executable, "-m", "dd3", "tool", work / "parts" / f"{name}.{part.ending}", folder]
        words += ["--program", program]
        words += ["--thickness", "1"] if part.kind in ("surface", "block") else []
        words += ["--part", "1"] if part.kind == "several" else []
        spent, made = timed(words)
        said.write_text(f"{spent:.1f} s\n{made.stdout}\n{made.stderr}", encoding="utf-8")
    text = said.read_text(encoding="utf-8")
    patches = sum(int(count) for count in re.findall(r"made of +(\d+) patches", text))
    estimate = re.findall(r"\n  thinning +((?:below )?[\d.]+) %", text) or [""]
    errors = re.findall(r"error: +(.*)", text)
    result = errors[0] if errors else "made" if (folder / "draw.dat").exists() else "none"
    return result, patches, text.split(" ", 1)[0], estimate[0]


def drawn(name, work, program):
    """Run the input file of a part; return the cells of its row."""
    folder, spent = work / name / "draw.out", work / f"{name}.seconds"
    if not spent.exists():
        seconds, _ = timed([program, "--threads", "1", "--quiet", "--output", folder, work / name / "draw.dat"])
        spent.write_text(str(seconds), encoding="utf-8")
    job = read_job(folder)
    results = [phase["result"] for phase in job["phases"] if phase["result"].get("increments")]
    punches = [punch for result in results for punch in (result.get("closing") or {"punches": []})["punches"]]
    thickness = PARTS[name].thickness or 1.0
    left, off = (max((punch[key]["distance"] for punch in punches if punch[key]), default=None)
                 for key in ("path_left", "off_tools"))
    cells = [str(sum(result[key] for result in results)) for key in ("increments", "cutbacks")]
    cells.append(f"{float(spent.read_text(encoding='utf-8')) / 60:.1f}")
    cells += ["" if value is None else f"{value / thickness:.2f}" for value in (left, off)]
    return [*cells, *results_of(folder, job), " ".join(sorted({warning["code"] for warning in job["warnings"]}))]


def results_of(folder, job):
    """Return the largest thinning, per cent, and the springback, the largest distance from the drawn shape, mm."""
    thinning = 100 * dd3.open(folder).fields[-1].cell_data["thinning"].max()
    found = springback.find(Sheet(folder), job["phases"])
    return [f"{thinning:.1f}", "" if found is None else f"{found.distance().max():.2f}"]


def rows_on_page():
    """Return the rows of the table in docs/parts.md by the name of their part."""
    content = PAGE.read_text(encoding="utf-8").split("<!-- table: runs -->")[1].split("<!-- end of table -->")[0]
    rows = [[cell.strip() for cell in line.strip("|").split(" | ")] for line in content.splitlines() if "| `" in line]
    return {row[0].strip("`"): row for row in rows}


def main():
    """Make the tools, the runs and the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="parts; all by default")
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--tools", action="store_true", help="make the tools, no runs")
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    (options.work / "parts").mkdir(parents=True, exist_ok=True)
    write(options.work / "parts")
    rows, on_page = [], rows_on_page()
    for name in options.names or PARTS:
        said, patches, seconds, estimate = made_tools(name, options.work, options.program)
        row = [f"`{name}`", said, str(patches or ""), seconds, estimate]
        ready = said == "made" and not options.tools
        rows.append([*row, *(drawn(name, options.work, options.program) if ready else [""] * (len(TITLES) - 4))])
        print("| " + " | ".join(rows[-1]) + " |", flush=True)
    if options.write:
        for row in rows:
            on_page[row[0].strip("`")] = [cell for title, cell in zip(TITLES, row) if title in ON_THE_PAGE]
        put_table(PAGE, "runs", table(ON_THE_PAGE, [on_page[name] for name in PARTS if name in on_page]),
                  [read_job(folder) for folder in options.work.glob("*/draw.out")])


if __name__ == "__main__":
    run(main)
