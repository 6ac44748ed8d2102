#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Plane-strain bending of a strip of 0.78 mm and its springback, against an integration through its thickness.

    run.py --program build/release/dd3imp --work build/strip_bending [--all]

One end of a short strip is held by symmetry, a couple of dead forces acts on the other, so that no other force acts on
its sections. Its radius is that between the plane of symmetry and a section one element of `solid_shell` from the
loaded end. Moment and radius after release of `solid_shell`, one layer, elements of two thicknesses, 9 points, must
agree within 2 % with ring.py at the same radius. --all prints the same for other elements.
"""
import math
import pathlib
import sys

from ring import POISSON, STEPS, SWIFT_E0, SWIFT_K, SWIFT_N, THICKNESS, YOUNG, bend_to

from dd3.errors import check
from dd3.programs import command, launch, parser_of_runs
from dd3.tables import number, read_table

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from run_description import check_description  # noqa: E402

TOLERANCE = 0.02
RADII = (10.0, 50.0, 100.0)
# Difference from a radius at which the force is not corrected any more: the ring is bent to the radius of the strip.
NEAR = 0.05
# Elements of the strip, and those up to the section where its radius is measured; their length.
ELEMENTS, INNER, SIZE = 3, 2, 2 * THICKNESS
LENGTH, SECTION = ELEMENTS * SIZE, INNER * SIZE
MODEL = f"""
*MATERIAL steel
  young = {YOUNG}
  poisson = {POISSON}
  yield = von_mises
  hardening = swift K={SWIFT_K} e0={SWIFT_E0} n={SWIFT_N}
*SET middle
  plane = x 0
  of = z_min
*BOUNDARY symmetry
  set = x_min
  fix = x
*BOUNDARY plane_strain
  set = all
  fix = y
*BOUNDARY height
  set = middle
  fix = z
*NEWTON
  tolerance = 1e-6
"""


def deck(element, divisions, force):
    """Return the input file of a strip bent by a couple, then released."""
    text = (f"*BLANK strip\n  origin = 0 0 {-THICKNESS / 2}\n  size = {LENGTH} 1 {THICKNESS}\n"
            f"  divisions = {' '.join(map(str, divisions))}\n  element = {element}\n  material = steel\n" + MODEL)
    for name, place in (("section", SECTION), ("end", LENGTH)):
        for side in ("min", "max"):
            text += (f"*SET {name}_{side}\n  plane = x {place}\n  of = z_{side}\n"
                     f"*HISTORY {name}_{side}\n  set = {name}_{side}\n  quantities = position\n")
    for phase, load, trial in (("bend", force, 1 / STEPS), ("release", 0.0, 0.1)):
        text += (f"*PHASE {phase}\n  control = load\n  trial = {trial:g}\n"
                 f"  load = end_max {load:.12g} 0 0\n  load = end_min {-load:.12g} 0 0\n")
    return text


def run(program, folder, text, force):
    """Run a strip; return radius and moment at the end of the bending, and the radius after release."""
    folder.mkdir(parents=True, exist_ok=True)
    file, history = folder / "strip.dat", folder / "out" / "history.csv"
    file.write_text(text, encoding="utf-8")
    done = launch(command(program, file, folder / "out"), timeout=300)
    check(done.code == 0, f"{folder.name}: exit code {done.code}\n{done.output}{done.errors}")
    check_description(folder / "out", done.code)
    rows = read_table(history)
    bent = [row for row in rows if row["phase"] == "bend"][-1]

    def across(row, name, axis):
        return number(row, f"{name}_max_{axis}", history) - number(row, f"{name}_min_{axis}", history)

    def radius(row):
        angle = math.atan2(across(row, "section", "x"), across(row, "section", "z"))
        return SECTION / angle if angle else math.inf

    return radius(bent), force * across(bent, "end", "z"), radius(rows[-1])


def variants(everything):
    """Yield label, lines of the element, its length and the layers; the first is checked."""
    yield "solid_shell, 9 points", "solid_shell\n  thickness_points = 9", SIZE, 1
    if everything:
        for points in (3, 5, 7, 15):
            yield f"solid_shell, {points} points", f"solid_shell\n  thickness_points = {points}", SIZE, 1
        for length in (SIZE, SIZE / 2, SIZE / 4, SIZE / 8):
            for layers in (2, 4):
                yield f"hex8, {length / THICKNESS:g} t long, {layers} layers", "hex8", length, layers


def main():
    """Compare the strips with the ring."""
    parser = parser_of_runs(__doc__)
    parser.add_argument("--all", action="store_true", help="further elements, without a check")
    arguments = parser.parse_args()
    for goal in RADII:
        for i, (label, element, part, layers) in enumerate(variants(arguments.all)):
            folder = arguments.work / f"{label} {goal:g}".replace(" ", "_")
            factor = 1.0
            for _ in range(10):
                force = factor * bend_to(goal)[1][-1][1] / (THICKNESS * math.cos(LENGTH / goal))
                text = deck(element, (round(LENGTH / part), 1, layers), force)
                radius, moment, released = run(arguments.program, folder, text, force)
                ring, path = bend_to(radius)
                quotient = moment / path[-1][1]
                if abs(radius / goal - 1) < NEAR:
                    break
                near = 0.5 < radius / goal < 2
                factor = quotient if near else factor * (1.2 if radius > goal else 0.9)
            error = (quotient - 1, released / ring.release() - 1)
            print(f"{label}: radius {radius:.4g} mm, moment {moment:.4g} N {error[0]:+.2%}, "
                  f"radius after release {released:.5g} mm {error[1]:+.2%}", flush=True)
            check(i > 0 or max(map(abs, error)) < TOLERANCE, f"{label}: errors {error} beyond {TOLERANCE}")


if __name__ == "__main__":
    main()
