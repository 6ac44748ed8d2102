#!/usr/bin/env python3
"""Plane-strain bending of a strip of 0.78 mm and its springback, against an integration through its thickness.

    run.py --program build/release/dd3imp --work build/strip_bending [--all]

The end section of a short strip turns while its other end is held by symmetry: its nodes are led along x as in the ring
and are free along z. The moment and the radius after release of `solid_shell`, one layer, elements of two thicknesses,
9 points, must agree with ring.py within 2 %. At a radius of 10 mm the elements are one thickness long: two would turn by
0.16 each, and their polygon has a moment too low by 2 %. --all prints the same for other elements.
"""
import argparse
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "utils"))
from results import command, find_program, launch, number, read_table  # noqa: E402
from ring import POISSON, STEPS, SWIFT_E0, SWIFT_K, SWIFT_N, THICKNESS, YOUNG, bend_to  # noqa: E402

PHASES = 8
TOLERANCE = 0.02
# Length of the strip, radius of the middle, length of the elements.
STRIPS = ((1.56, 10.0, 0.78), (3.12, 50.0, 1.56), (3.12, 100.0, 1.56))
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


def check(condition, message):
    """End the test with a message unless the condition holds."""
    if not condition:
        sys.exit(message)


def deck(element, divisions, length, path):
    """Return the input file of a strip bent along the path of the ring, then released."""
    text = (f"*BLANK strip\n  origin = 0 0 {-THICKNESS / 2}\n  size = {length} 1 {THICKNESS}\n"
            f"  divisions = {' '.join(map(str, divisions))}\n  element = {element}\n  material = steel\n" + MODEL)
    layers = divisions[2]
    place = [length] * (layers + 1)
    for k in range(layers + 1):
        text += (f"*SET end_{k}\n  plane = z {THICKNESS * (k / layers - 0.5)}\n  of = x_max\n"
                 f"*HISTORY end_{k}\n  set = end_{k}\n  quantities = position reaction\n")
    for phase in range(PHASES):
        angle, _, inner, outer = path[(phase + 1) * len(path) // PHASES - 1]
        text += f"*PHASE bend_{phase + 1}\n  control = load\n  trial = {PHASES / len(path)}\n"
        for k in range(layers + 1):
            goal = (inner + (outer - inner) * k / layers) * math.sin(angle * length)
            text += f"  displace = end_{k} x {goal - place[k]:.12g}\n"
            place[k] = goal
    return text + "*PHASE release\n  control = load\n  trial = 0.1\n" + "".join(
        f"  free = end_{k} x\n" for k in range(layers + 1))


def run(program, folder, text, length, layers):
    """Run a strip; return radius and moment at the end of the bending, and the radius after release."""
    folder.mkdir(parents=True, exist_ok=True)
    file, history = folder / "strip.dat", folder / "out" / "history.csv"
    file.write_text(text, encoding="utf-8")
    done = launch(command(program, file, folder / "out"), timeout=300)
    check(done.code == 0, f"{folder.name}: exit code {done.code}\n{done.output}{done.errors}")
    rows = read_table(history)
    bent = [row for row in rows if row["phase"] != "release"][-1]

    def value(row, k, what):
        return number(row, f"end_{k}_{what}", history)

    def radius(row):
        across = [value(row, layers, axis) - value(row, 0, axis) for axis in "xz"]
        return length / math.atan2(*across)

    middle = 0.5 * (value(bent, 0, "z") + value(bent, layers, "z"))
    moment = sum(value(bent, k, "rx") * (value(bent, k, "z") - middle) for k in range(layers + 1))
    return radius(bent), moment, radius(rows[-1])


def variants(size, everything):
    """Yield label, lines of the element, its length and the layers; the first is checked."""
    yield "solid_shell, 9 points", "solid_shell\n  thickness_points = 9", size, 1
    if everything:
        for points in (3, 5, 7, 15):
            yield f"solid_shell, {points} points", f"solid_shell\n  thickness_points = {points}", size, 1
        for length in (size, size / 2, size / 4, size / 8):
            for layers in (2, 4):
                yield f"hex8, {length / THICKNESS:g} t long, {layers} layers", "hex8", length, layers


def main():
    """Compare the strips with the ring."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, type=find_program)
    parser.add_argument("--work", required=True, type=pathlib.Path)
    parser.add_argument("--all", action="store_true", help="further elements, without a check")
    arguments = parser.parse_args()
    for length, radius, size in STRIPS:
        ring, path = bend_to(radius, STEPS)
        expected = (radius, path[-1][1], ring.release())
        print(f"R = {radius:g} mm: moment {expected[1]:.4g} N, radius after release {expected[2]:.5g} mm")
        for i, (label, element, part, layers) in enumerate(variants(size, arguments.all)):
            text = deck(element, (round(length / part), 1, layers), length, path)
            folder = arguments.work / f"{label} {radius:g}".replace(" ", "_")
            found = run(arguments.program, folder, text, length, layers)
            error = [a / b - 1 for a, b in zip(found, expected)]
            print(f"  {label}: radius {error[0]:+.2%}, moment {found[1]:.4g} N {error[1]:+.2%}, "
                  f"radius after release {found[2]:.5g} mm {error[2]:+.2%}")
            check(i > 0 or max(map(abs, error)) < TOLERANCE, f"{label}: expected {expected}, got {found}")


if __name__ == "__main__":
    main()
