#!/usr/bin/env python3
"""Checks utils/identify.py: known parameters are found again. Ends with 77 where scipy is missing.

    identification.py --program build/release/dd3imp
"""
import argparse
import importlib.util
import pathlib
import re
import subprocess
import sys
import tempfile

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "utils" / "identify.py"
R_VALUES = ["--r", "0:1.79", "45:1.51", "90:2.27"]
# r-values of NUMISHEET'93 mild steel; for hill48 by its closed formulas.
G = 1 / 2.79
F = 1.79 * G / 2.27
CASES = (
    (["--criterion", "hill48", *R_VALUES], {"F": F, "G": G, "H": 1 - G, "N": (F + G) * 2.01}),
    (["--criterion", "yld91", "--fix", "m=6", *R_VALUES], {"a": 0.81385, "b": 0.88006, "c": 1.11247, "h": 0.94446}),
    (["--hardening", "voce", "--curve", "curve.csv", "--plastic-strain"], {"Y0": 150, "Rsat": 200, "CR": 12}),
)


def curve():
    """A tension curve of Voce's law: the plastic strain and the stress."""
    return "strain,stress\n" + "".join(f"{p / 50:.4f},{350 - 200 * 2.718281828459045 ** (-12 * p / 50):.8f}\n"
                                       for p in range(12))


def wrong_in(program, folder, words, wanted):
    """What is wrong with one identification."""
    file = folder / "found.dat"
    done = subprocess.run([sys.executable, str(SCRIPT), "found", *words, "--starts", "1", "--program", program,
                           "--output", str(file)], cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    if done.returncode != 0:
        return [f"{words}: {done.stderr}"]
    found = {key: float(value) for key, value in re.findall(r"(\w+)=(\S+)", file.read_text(encoding="utf-8"))}
    return [f"{words}: {key} is {found.get(key)}, expected {value:.5f}" for key, value in wanted.items()
            if abs(found.get(key, 1e9) - value) > 3e-5 * max(abs(value), 1)]


def main():
    """Runs all cases, and a mistaken command."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, help="the program dd3imp")
    program = str(pathlib.Path(parser.parse_args().program).resolve())
    if not all(importlib.util.find_spec(name) for name in ("numpy", "scipy")):
        print("scipy is missing")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "curve.csv").write_text(curve(), encoding="utf-8")
        bad = [problem for words, wanted in CASES for problem in wrong_in(program, folder, words, wanted)]
        said = wrong_in(program, folder, ["--criterion", "hill48", "--fix", "Q=1", *R_VALUES], {})
        if len(said) != 1 or "hill48 has no Q" not in said[0]:
            bad.append(f"--fix Q=1 is not refused: {said}")
    print("\n".join(bad) or "all parameters are found again")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
