#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Release of a drawn strip whose bends yield, between a die, a punch and a light holder.

    drawn_strip.py --program build/release/dd3imp --work build/drawn_strip

The input file is input_files/draw_bending/draw_bending.dat with a coarse mesh and a short stroke. Under loads that only
fade, the strip collapses over the die in the first increment of the release, the further the smaller the increment.

An elastic release has one free shape. What the strip dissipates in the release, plastic and friction work D, changes
it: a plastic strain dp in a section that returns the elastic strain e under the stress s dissipates s dp of the
elastic energy s e/2, and changes its curvature by the fraction dp/e = D/(2 U). The springbacks of two ways of release
may differ by the sum of their fractions. Released by `unload` alone the strip hardly dissipates, whatever the
increments; if the holder is eased before, it slides and bends a little while it is still in contact.
"""
import pathlib

from dd3.errors import check
from dd3.programs import command, launch, parser_of_runs
from dd3.tables import number, read_table

ROOT = pathlib.Path(__file__).resolve().parents[2]

DECK = ROOT / "input_files" / "draw_bending" / "draw_bending.dat"
SETTINGS = ["--set", "divisions=90 1 1", "--set", "points=7", "--set", "depth=12"]
UNLOAD = "*PHASE springback\n  unload = on\n"
CASES = {"whole": UNLOAD, "in small increments": UNLOAD + "  trial = 0.02\n",
         "eased": "*PHASE ease\n  control = load\n  trial = 0.1\n  press = holder 0 0 -1\n" + UNLOAD}
TIPS = "".join(f"*SET {name}\n  near = {x} 0 0\n*HISTORY {name}\n  set = {name}\n  quantities = position\n"
               for name, x in (("middle", 0), ("tip", 175)))
ELASTIC = 0.005  # largest fraction of a release by `unload` alone


def springback(program, work, name, release):
    """Run a case; return the motion of the tip relative to the middle after the draw, mm, and the fraction D/(2 U)."""
    file, out = work / f"{name.replace(' ', '_')}.dat", work / name.replace(" ", "_")
    text = DECK.read_text(encoding="utf-8")
    check(UNLOAD in text, f"{DECK}: no phase springback")
    text = text.replace(UNLOAD, release + TIPS).replace('patches = "', f'patches = "{DECK.parent}/')
    file.write_text(text, encoding="utf-8")
    done = launch(command(program, file, out, SETTINGS), timeout=300)
    check(done.code == 0, f"{name}: exit code {done.code}\n{done.output}{done.errors}")
    rows = read_table(out / "history.csv")
    drawn = [row for row in rows if row["phase"] == "draw"][-1]
    change = {column: number(rows[-1], column, out) - number(drawn, column, out)
              for column in ("tip_z", "middle_z", "plastic_work", "friction_work", "elastic_energy")}
    dissipated = change["plastic_work"] + change["friction_work"]
    return change["tip_z"] - change["middle_z"], -dissipated/(2*change["elastic_energy"])


def main():
    """Compare the cases."""
    arguments = parser_of_runs(__doc__).parse_args()
    found = {name: springback(arguments.program, arguments.work, name, release) for name, release in CASES.items()}
    whole, least = found["whole"]
    for name, (value, fraction) in found.items():
        difference = abs(value/whole - 1)
        print(f"{name}: springback {value:.4f} mm at the tip, {difference:.2%} off, D/(2 U) = {fraction:.2%}")
        check(difference <= fraction + least, f"{name}: the springback differs by more than is dissipated")
        check(name == "eased" or fraction < ELASTIC, f"{name}: the strip yields in the release")


if __name__ == "__main__":
    main()
