#!/usr/bin/env python3
"""Release of a drawn strip whose bends yield, between a die, a punch and a light holder.

    drawn_strip.py --program build/release/dd3imp --work build/drawn_strip

The input file is input_files/draw_bending/draw_bending.dat with a coarse mesh and a short stroke. Under loads that only
fade, the strip collapses over the die in the first increment of the release, the further the smaller the increment. The
free shape may not depend on the size of the increments, and the strip may not yield. If the holder is eased before, the
strip slides and bends a little while it is still in contact, with friction: the shapes agree within 5 %.
"""
import argparse
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "utils"))
from results import command, find_program, launch, number, read_table  # noqa: E402

DECK = ROOT / "input_files" / "draw_bending" / "draw_bending.dat"
SETTINGS = ["--set", "divisions=90 1 1", "--set", "points=7", "--set", "depth=12"]
UNLOAD = "*PHASE springback\n  unload = on\n"
CASES = {"whole": UNLOAD, "in small increments": UNLOAD + "  trial = 0.02\n",
         "eased": "*PHASE ease\n  control = load\n  trial = 0.1\n  press = holder 0 0 -1\n" + UNLOAD}
TIPS = "".join(f"*SET {name}\n  near = {x} 0 0\n*HISTORY {name}\n  set = {name}\n  quantities = position\n"
               for name, x in (("middle", 0), ("tip", 175)))
ALLOWED = {"in small increments": 0.01, "eased": 0.05}


def check(condition, message):
    """End the test with a message unless the condition holds."""
    if not condition:
        sys.exit(message)


def springback(program, work, name, release):
    """Run a case; return the motion of the tip relative to the middle after the draw, mm."""
    file, out = work / f"{name.replace(' ', '_')}.dat", work / name.replace(" ", "_")
    text = DECK.read_text(encoding="utf-8")
    check(UNLOAD in text, f"{DECK}: no phase springback")
    text = text.replace(UNLOAD, release + TIPS).replace('patches = "', f'patches = "{DECK.parent}/')
    file.write_text(text, encoding="utf-8")
    done = launch(command(program, file, out, SETTINGS), timeout=300)
    check(done.code == 0, f"{name}: exit code {done.code}\n{done.output}{done.errors}")
    check("the plastic strain of element" not in done.output + done.errors, f"{name}: the strip yields\n{done.output}")
    rows = read_table(out / "history.csv")
    drawn = [row for row in rows if row["phase"] == "draw"][-1]
    heights = [number(row, "tip_z", out) - number(row, "middle_z", out) for row in (drawn, rows[-1])]
    return heights[1] - heights[0]


def main():
    """Compare the cases."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, type=find_program)
    parser.add_argument("--work", required=True, type=pathlib.Path)
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    found = {name: springback(arguments.program, arguments.work, name, release) for name, release in CASES.items()}
    for name, value in found.items():
        print(f"{name}: springback {value:.4f} mm at the tip")
    for name, allowed in ALLOWED.items():
        difference = abs(found[name]/found["whole"] - 1)
        check(difference < allowed, f"{name}: the springback differs by {100*difference:.1f} %")


if __name__ == "__main__":
    main()
