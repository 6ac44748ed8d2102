#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "docs_tutorial_part_to_die", "arguments": ["part_to_die"], "labels": ["docs", "slow"], "timeout": 1800,
#:  "cost": 110}
#: {"name": "docs_tutorial_import", "arguments": ["import"], "labels": ["docs"], "timeout": 600}
#: {"name": "docs_tutorial_identification", "arguments": ["identification"], "labels": ["docs"], "timeout": 600}
#: {"name": "docs_tutorial_compensation", "arguments": ["compensation"], "labels": ["docs", "slow"], "timeout": 1200,
#:  "cost": 40}
#: {"name": "docs_tutorial_study", "arguments": ["study"], "labels": ["docs"], "timeout": 600}
#: {"name": "docs_tutorial_own_law", "arguments": ["own_law"], "labels": ["docs", "slow"], "timeout": 5400, "cost": 170}
"""Run the commands of a page of docs/tutorials; compare what they print, and the decimals of the text, with the page.

  tutorials.py import --program build/release/dd3imp --work build/tutorial_import [--write]

The commands run in a copy of the repository with the program; the page own_law builds it there. Words that are printed
are the same; a number differs by two of its last digit or 2 %, a whole number by 5 %. A number with a decimal point in
the text is one that a command prints, or one of COMPUTED, rounded. --write copies the pictures into
docs/images/tutorials.
"""
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys

from tutorial import NUMBER, ROUNDED, commands, shows

from dd3.programs import parser_of_runs

ROOT = pathlib.Path(__file__).resolve().parents[2]
IMAGES = ROOT / "docs" / "images" / "tutorials"
OTHER_MACHINE = 0.02  # part of a printed number by which it may differ
NOT_COPIED = ("build", "dist", ".git", ".venv")  # of the root


def flow_stress(strain):
    """Return the flow stress of the steel that dd3 tool assumes, MPa."""
    factor, start, exponent = 530, 150, 0.22
    return factor * ((start / factor)**(1 / exponent) + strain)**exponent


def bend():
    """Return the stress and the springback of the bend of the bracket, MPa and degrees."""
    young, poisson, thickness, radius, plane = 2.1e5, 0.3, 2, 4, 2 / math.sqrt(3)
    stress = plane * flow_stress(plane * thickness / (4 * radius))
    return [stress, 90 * 3 * stress * (1 - poisson**2) * radius / (young * thickness)]


def strip():
    """Return the heights of three runs of the strip, mm."""
    young, poisson, thickness, length = 2.1e5, 0.3, 1, 50
    modulus, heights = young / (1 - poisson**2), []
    for strength, angle in ((280, 56), (300, 57), (320, 58)):
        plane, start = 2 * strength / math.sqrt(3), math.radians(angle) / length
        free = start - 3 * plane / (modulus * thickness) * (1 - 4 / 3 * (plane / (modulus * start * thickness))**2)
        heights.append((1 - math.cos(length * free)) * (1 / free + thickness / 2))
    return heights


# Numbers of the text that no command prints: computed, from the printed ones, or of the input.
COMPUTED = {
    "part_to_die": lambda: [*bend(), 90.97 - 89.85],
    "import": lambda: [80 / 44, 1.8, 1.4, 2.1],  # length of the elements; r-values of the deck
    "identification": lambda: [-0.05133605 + 0.33 * 945.11884 / 2e5, -0.04705725 + 0.33 * 945.11884 / 2e5, 0.33, 0.1],
    "compensation": lambda: [101.2 - 100.1, 103.9 - 101.9, 100.1 - 99.8],
    "study": lambda: [*strip(), 2 * 0.323081 / 2, 0.323081 / 0.380373],
    "own_law": lambda: [0.21, 0.21 + 280 / 2.1e5],  # plastic and total strain at 280 MPa
}


def wrong_numbers(text, printed, name):
    """Yield the decimals in the text of a page that are neither printed nor computed."""
    text = re.sub(r"^( {4}|#|!|\|).*$|^```math.*?^```|`[^`]*`|\$[^$]*\$|\]\([^)]*\)", "", text,
                  flags=re.MULTILINE | re.DOTALL)
    known = [abs(float(number)) for number in NUMBER.findall(printed)]
    known += [abs(value) for value in COMPUTED[name]()]
    for number in re.findall(r"\d+\.\d+", text):
        if all(abs(float(number) - value) > ROUNDED * 10.0**-len(number.partition(".")[2]) for value in known):
            yield f"{number} is neither printed nor computed"


def prepared(options):
    """Make the copy of the repository; return its folder and the environment of the commands."""
    work = options.work.resolve()
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    own = options.page == "own_law"
    for part in ROOT.iterdir() if own else [ROOT / "input_files", ROOT / "utils", ROOT / "tests"]:
        if part.name in NOT_COPIED or part == work:
            continue
        if part.is_dir():
            shutil.copytree(part, work / part.name, symlinks=True,
                            ignore=shutil.ignore_patterns("*.out", "__pycache__"))
        else:
            shutil.copy(part, work / part.name)
    if own:
        with open(work / "cmake" / "Dd3BuildTypes.cmake", "a", encoding="utf-8") as types:
            types.write('set(CMAKE_Fortran_FLAGS_RELEASE_INIT "-O0")\n')  # it takes half the time
    else:
        (work / "build" / "release").mkdir(parents=True)
        for name in ("dd3imp", "libdd3laws.so"):
            (work / "build" / "release" / name).symlink_to(pathlib.Path(options.program).resolve().parent / name)
    folder = pathlib.Path(sys.executable).parent
    return work, os.environ | {"PATH": f"{folder}:{os.environ['PATH']}", "PYTHONPATH": str(work / "utils"),
                               "CMAKE_BUILD_PARALLEL_LEVEL": "1"}  # the test counts as one process


def main():
    """Run the commands of a page."""
    parser = parser_of_runs(__doc__)
    parser.add_argument("page", choices=sorted(COMPUTED))
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    page = (ROOT / "docs" / "tutorials" / f"{options.page}.md").read_text(encoding="utf-8")
    work, environment = prepared(options)
    failed, everything = 0, ""
    for command, texts in commands(page):
        done = subprocess.run(["bash", "-c", command], cwd=work, env=environment, capture_output=True, text=True,
                              check=False)
        printed = done.stdout + done.stderr
        everything += printed
        missing = [text for text in texts if not shows(printed, text, OTHER_MACHINE)]
        if done.returncode or missing:
            failed += 1
            print(f"{command}\nexit code {done.returncode}; not printed: {missing}\n{printed[-3000:]}")
    for problem in wrong_numbers(page, everything, options.page):
        failed += 1
        print(problem)
    picture = next(iter(re.findall(r"\(\.\./images/tutorials/(\w+\.png)\)", page)), None)
    made = re.findall(r"build/\S+?\.png", page.split("\n![")[0])  # the last one before the picture
    if options.write and picture:
        IMAGES.mkdir(exist_ok=True)
        shutil.copy(work / made[-1], IMAGES / picture)
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
