#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "springback_drawn_strip", "timeout": 600}
"""Release of a drawn strip whose bends yield, between a die, a punch and a light holder.

    drawn_strip.py --program build/release/dd3imp --work build/drawn_strip

The input file is input_files/draw_bending/draw_bending.dat with a coarse mesh and a short stroke.

An elastic release has one free shape. What the strip dissipates in the release, plastic and friction work D, changes
it: a plastic strain dp in a section that returns the elastic strain e under the stress s dissipates s dp of the
elastic energy s e/2, and changes its curvature by the fraction dp/e = D/(2 U). The springbacks of two ways of release
may differ by the sum of their fractions. `unload`, which withdraws all tools at the same time, lies between the orders
of presses, tools withdrawn one after another by `move`, or within 2 % of the nearer one.
"""
import pathlib
import sys

from dd3.errors import check
from dd3.programs import parser_of_runs

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from bench import Bench  # noqa: E402

DECK = ROOT / "input_files" / "draw_bending" / "draw_bending.dat"
SETTINGS = {"divisions": "90 1 1", "points": 7, "depth": 12}
UNLOAD = "*PHASE springback\n  unload = on\n"
CASES = {"whole": UNLOAD, "in small increments": UNLOAD + "  trial = 0.02\n",
         "eased": "*PHASE ease\n  control = load\n  trial = 0.1\n  press = holder 0 0 -1\n" + UNLOAD}
UP = "*PHASE {0}\n  control = {0}\n  trial = 2\n  move = {0} 0 0 40\n"
ORDERS = {"punch first": UP.format("punch") + UP.format("holder") + UNLOAD,
          "holder first": UP.format("holder") + UP.format("punch") + UNLOAD}
TIPS = "".join(f"*SET {name}\n  near = {x} 0 0\n*HISTORY {name}\n  set = {name}\n  quantities = position\n"
               for name, x in (("middle", 0), ("tip", 175)))
MARGIN = 0.02  # of the springback


def springback(bench, name, release):
    """Run a case; return the motion of the tip relative to the middle after the draw, mm, and the fraction D/(2 U)."""
    text = DECK.read_text(encoding="utf-8")
    check(UNLOAD in text, f"{DECK}: no phase springback")
    text = text.replace(UNLOAD, release + TIPS).replace('patches = "', f'patches = "{DECK.parent}/')
    found = bench.run(name.replace(" ", "_"), text, SETTINGS)
    change = {column: found.last(column) - found.last(column, "draw")
              for column in ("tip_z", "middle_z", "plastic_work", "friction_work", "elastic_energy")}
    dissipated = change["plastic_work"] + change["friction_work"]
    return change["tip_z"] - change["middle_z"], -dissipated/(2*change["elastic_energy"])


def main():
    """Compare the cases."""
    arguments = parser_of_runs(__doc__).parse_args()
    bench = Bench(arguments.program, arguments.work)
    found = {name: springback(bench, name, release) for name, release in {**CASES, **ORDERS}.items()}
    whole, least = found["whole"]
    for name, (value, fraction) in found.items():
        difference = abs(value/whole - 1)
        print(f"{name}: springback {value:.4f} mm at the tip, {difference:.2%} off, D/(2 U) = {fraction:.2%}")
        check(difference <= fraction + least, f"{name}: the springback differs by more than is dissipated")
    band = sorted(found[name][0] for name in ORDERS)
    check(band[0] - MARGIN*abs(whole) <= whole <= band[1] + MARGIN*abs(whole), f"whole: outside of {band}")


if __name__ == "__main__":
    main()
