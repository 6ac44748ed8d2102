#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "forming_step_rail", "arguments": ["rail"], "labels": ["slow"], "timeout": 1800, "cost": 150}
#: {"name": "forming_step_cup", "arguments": ["cup"], "labels": ["slow"], "timeout": 1800, "cost": 150}
#: {"name": "forming_step_panel", "arguments": ["panel"], "labels": ["slow"], "timeout": 1800, "cost": 200}
"""Draw parts that are given by STEP files alone: tools and input file by dd3 tool, then the run to its end.

  step_parts.py cup panel rail --program build/release/dd3imp --work build/step_parts [--defaults]

With --defaults the elements are those of the input files that dd3 tool writes, without it fewer. It prints patches,
seconds, increments, iterations and the largest thinning of each.
"""
import re
import subprocess
import sys
import time
from pathlib import Path

import dd3
from dd3.programs import parser_of_runs
from dd3.run import read_job

ROOT = Path(__file__).resolve().parents[2]
DIVISIONS = {"rail": "56 40 1", "cup": "38 38 1", "panel": "54 40 1"}
# Thickness, shoulder, flange, mm; most patches of punch and die; travel of the punch, mm: height of the part,
# shoulder, and half a millimetre of wall where the edge of the part is not level.
PARTS = {"rail": (0.8, 5, 35, 500, 700, 20 + 5 + 0.8), "cup": (1.0, 6, 20, 500, 800, 24 + 6 + 1.0),
         "panel": (0.8, 6, 50, 2500, 3000, None)}


def made(folder, name):
    """Make the tools of a part; return the report and the seconds."""
    thickness, shoulder, flange, *_ = PARTS[name]
    start = time.perf_counter()
    done = subprocess.run([Path(sys.executable).parent / "dd3", "tool", folder / f"{name}.step", folder / name,
                           "--thickness", f"{thickness}", "--shoulder", f"{shoulder}", "--flange", f"{flange}"],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "error" not in done.stderr, done.stdout + done.stderr
    return done.stdout, time.perf_counter() - start


def main():
    """Make, run, and check the parts."""
    parser = parser_of_runs(__doc__)
    parser.add_argument("parts", nargs="+", choices=PARTS)
    parser.add_argument("--defaults", action="store_true", help="the elements of the written input files")
    options = parser.parse_args()
    folder = options.work
    subprocess.run([sys.executable, ROOT / "input_files" / "parts" / "step_files.py", folder], check=True)
    failed = 0
    print("part | patches | s | elements | increments | iterations | thinning | s")
    for name in options.parts:
        *_, most_punch, most_die, travel = PARTS[name]
        report, seconds = made(folder, name)
        punch, die, _ = (int(number) for number in re.findall(r"made of +(\d+) patch", report))
        found = float(re.search(r"travel +([\d.]+)", report)[1])
        if punch > most_punch or die > most_die or (travel and abs(found - travel) > 0.002):
            failed += 1
            print(f"{name}: {punch} and {die} patches, travel {found}; expected {most_punch}, {most_die}, {travel}")
        start = time.perf_counter()
        settings = [] if options.defaults else ["--set", f"divisions={DIVISIONS[name]}", "--set", "levels=0"]
        done = subprocess.run([options.program, *settings, folder / name / "draw.dat"], capture_output=True, text=True, check=False)
        job = read_job(folder / name / "draw.out")
        if done.returncode or job["outcome"]["state"] != "reached":
            failed += 1
            print(f"{name}: {done.stdout[-2000:]}{done.stderr}")
        thinning = dd3.open(folder / name / "draw.out").fields[-1].cell_data["thinning"].max()
        print(name, punch + die, f"{seconds:.1f}", job["sheet"]["elements"], job["counts"]["increments"],
              job["counts"]["iterations"], f"{100 * thinning:.1f} %", f"{time.perf_counter() - start:.0f}", sep=" | ")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
