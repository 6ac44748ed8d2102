#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Check the material files of input_files/materials.

    library.py --program build/release/dd3imp

- Each has a header with reference, measurements and certainty, and one *MATERIAL named after the file.
- Each passes `dd3imp --check` when a file with a *POINT includes it.
- Tension, compression and equibiaxial tension at a point give the stresses (over the flow stress) and r-values that
  its header states, to the digits printed there (0.6 of a unit of the last).
- r-values in tension and compression are positive every 15 degrees, as those of any sheet.
"""
import argparse
import pathlib
import re
import sys

from dd3.programs import run_points

ROOT = pathlib.Path(__file__).resolve().parents[2]

FOLDER = ROOT / "input_files" / "materials"
UNIAXIAL, THICKNESS = "e11 s22 s33 s12 s23 s13", "s11 s22 e33 s12 s23 s13"
KINDS = {"tension": (UNIAXIAL, 1), "compression": (UNIAXIAL, -1), "biaxial": (THICKNESS, -1),
         "thickness": (THICKNESS, 1), "thickness_compression": (THICKNESS, -1)}
SHEET = [(kind, str(angle), "-", "-") for kind in ("tension", "compression") for angle in range(0, 91, 15)]
CHECK = re.compile(rf"^#\s+({'|'.join(KINDS)})\s+(?:(\d+)\s+)?([-\d.]+)\s+([-\d.]+)\s*$", re.MULTILINE)


def deck(path, checks):
    """Return input that drives the material of a file on the paths of its check values."""
    lines = [f'*INCLUDE "{path}"']
    for i, (kind, angle, _, _) in enumerate(checks):
        control, sign = KINDS[kind]
        lines += [f"*POINT p{i}", f"  material = {path.stem}", f"  angle = {angle or 0}", f"  control = {control}"]
        for strain in (1e-6, 0.05, 0.1):
            values = [0.0] * 6
            values[0 if control == UNIAXIAL else 2] = sign * strain
            lines.append(f"  target = {' '.join(f'{value:g}' for value in values)} steps=1")
    return "\n".join(lines) + "\n"


def measure(kind, rows):
    """Return stress over flow stress and r-value of a path."""
    _, elastic, first, last = rows
    leading = "s11" if KINDS[kind][0] == UNIAXIAL else "s33"
    pair = ("e22", "e33") if leading == "s11" else ("e22", "e11")
    width, thickness = (last[key] - first[key] - elastic[key] / elastic[leading] * (last[leading] - first[leading])
                       for key in pair)
    return abs(last[leading]) / last["flow_stress"], width / thickness


def off(wanted, value):
    """Return whether a value differs from the printed one by more than its digits allow."""
    if wanted == "-":
        return False
    return abs(float(wanted) - value) > 0.6 * 10.0 ** -len(wanted.partition(".")[2])


def check(program, path):
    """Return the errors of a file."""
    text = path.read_text(encoding="utf-8")
    wrong = [f"no line '# {word}: ...'" for word in ("Reference", "Measured", "Certainty")
             if f"\n# {word}: " not in text]
    if re.findall(r"^\*MATERIAL (\S+)", text, re.MULTILINE) != [path.stem] or text.count("\n*") != 1:
        return wrong + [f"its only block must be *MATERIAL {path.stem}"]
    checks = CHECK.findall(text)
    if len(checks) < 4:
        wrong.append("fewer than four check values")
    for options in (("--check",), ()):
        done, points = run_points(program, deck(path, checks + SHEET), *options, timeout=60)
        if done.code != 0:
            return wrong + [f"exit code {done.code}: {done.errors}"]
    for i, (kind, angle, *wanted) in enumerate(checks + SHEET):
        found = measure(kind, points[f"p{i}"])
        if angle and not found[1] > 0:
            wrong.append(f"{kind} {angle}: r = {found[1]:.4f}")
        if any(map(off, wanted, found)):
            wrong.append(f"{kind} {angle}: {found[0]:.4f} {found[1]:.4f}, stated {wanted[0]} {wanted[1]}")
    return wrong


def main():
    """Check all files."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, help="the program dd3imp")
    program = parser.parse_args().program
    files = sorted(FOLDER.glob("*.dat"))
    bad = [f"{path.name}: {problem}" for path in files for problem in check(program, path)]
    print("\n".join(bad) or f"{len(files)} files are right")
    sys.exit(1 if bad or not files else 0)


if __name__ == "__main__":
    main()
