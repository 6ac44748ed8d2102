#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run the bending test with each yield criterion and make the table of docs/reports/bending_criteria.md.

    tests/benchmark/bending_criteria.py --program build/release/dd3imp --work build/bending_criteria --write

The deck is that of tests/cases/bending_criteria. The stress in plane strain along rolling is that of a nearly rigid,
perfectly plastic material, over its flow stress.
"""
import re
from pathlib import Path

from dd3.errors import Problem, run
from dd3.pages import put_table, table
from dd3.programs import command, launch, parser_of_runs, run_points
from dd3.run import read_job
from dd3.tables import interpolate, read_table, totals

ROOT = Path(__file__).resolve().parents[2]
CASE = ROOT / "tests" / "cases" / "bending_criteria" / "case.dat"
REPORT = ROOT / "docs" / "reports" / "bending_criteria.md"
TRAVELS = (2, 40)  # at which the force is given, mm
# Materials of the deck and what the table says of their parameters.
MATERIALS = {
    "hill48": "r 1.79 1.51 2.27", "yld91": "m = 6, fitted", "karafillis_boyce": "k = 3, fitted",
    "drucker": "C1 to C6 fitted", "cazacu_barlat2001": "c = 1.2, fitted", "yld2004": "m = 6, the surface of yld91",
    "yld2004_two": "m = 8, AA2090-T3", "cpb06": "m = 4, k = 0, fitted", "cpb06_uneven": "m = 4, isotropic, k = -0.0617",
    "von_mises": "", "hosford": "m = 6", "back_stress": "Hill, Voce, Lemaitre-Chaboche"}


def plane_strain(program):
    """Return the stress in plane strain along rolling over the flow stress, by material."""
    names = [name for name in MATERIALS if name != "back_stress"]
    text = CASE.read_text(encoding="utf-8")
    blocks = [re.search(rf"^\*MATERIAL {name}\n(?:  .*\n|    .*\n)+", text, re.MULTILINE)[0] for name in names]
    deck = re.sub(r"young = .*", "young = 1e9", "".join(blocks))
    deck = re.sub(r"hardening = .*", "hardening = perfect Y0=100", deck)
    deck += "".join(f"*POINT of_{name}\n  material = {name}\n  control = e11 e22 s33 s12 s23 s13\n"
                    "  target = 0.05 0 0 0 0 0 steps=50\n" for name in names)
    _, points = run_points(program, deck)
    return {name: rows[-1]["s11"] / 100 for name, rows in zip(names, points.values(), strict=True)}


def main():
    """Make the runs and the table."""
    parser = parser_of_runs(__doc__)
    parser.add_argument("--write", action="store_true", help="put the table into the report")
    options = parser.parse_args()
    stress, rows, jobs = plane_strain(options.program), [], []
    for name, parameters in MATERIALS.items():
        folder = options.work / name
        done = launch(command(options.program, CASE, folder, ["--quiet"], {"criterion": name, "travel": TRAVELS[-1]}))
        if done.code:
            raise Problem(f"{name}: exit code {done.code}\n{done.errors}")
        total = totals(read_table(folder / "status.csv"))
        draw = [row for row in read_table(folder / "history.csv") if row["phase"] == "draw"]
        travel, force = ([float(row[column]) for row in draw] for column in ("travel", "punch_fz"))
        rows.append([f"`{name}`", parameters, f"{stress[name]:.3f}" if name in stress else "-", str(total.increments),
                     str(total.cutbacks), f"{total.iterations / total.increments:.2f}",
                     *(f"{interpolate(travel, force, place):.0f}" for place in TRAVELS), f"{done.cpu:.1f}"])
        jobs.append(read_job(folder))
        print(*rows[-1], sep=" | ", flush=True)
    text = table(["material", "parameters", "plane strain", "increments", "cut-backs", "iterations per increment",
                  *(f"force at {place} mm, N" for place in TRAVELS), "processor time, s"], rows)
    if options.write:
        put_table(REPORT, "criteria", text, jobs)


if __name__ == "__main__":
    run(main)
