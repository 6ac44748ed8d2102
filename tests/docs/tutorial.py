#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "docs_tutorial", "labels": ["docs", "slow"], "timeout": 1800, "cost": 300}
"""Run the commands of docs/tutorial.md and compare what they print, and the numbers of the text, with the page.

  tutorial.py --program build/release/dd3imp --work build/tutorial [--write]

Words are the same; a number differs by two of its last digit at most, which other processors and libraries may change,
and a number of nodes or elements by 5 %, as the mesh is divided a little elsewhere then.
Every number of the text is one of TEXT, computed from the tools and the results, and rounded as it is printed there.
--write copies the pictures into docs/images.
"""
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

import numpy as np

from dd3.fields import Fields
from dd3.programs import parser_of_runs
from dd3.run import read_frame, read_job
from dd3.tools.surface import points_on, read_patches

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "tutorial.md"
IMAGES = ROOT / "docs" / "images"
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
LAST_DIGITS, PART = 2.1, 0.05  # with the round-off of the comparison; of whole numbers
ROUNDED = 0.7  # of the last digit in the text: rounding, and a little for other processors
WHOLE = 2  # the runs are of a quarter


def surface_of(tool):
    """Return points of a tool's surface."""
    t = np.linspace(0, 1, 7)
    return np.vstack([points_on(*patch, t, t).reshape(-1, 3) for patch in read_patches(tool)])


def radius_of(tool, x, z):
    """Return the radius of the edge in the middle section of a tool, between bounds of x and z."""
    points = surface_of(tool)
    inside = [np.abs(points[:, 1]) < 5, points[:, 0] > x[0], points[:, 0] < x[1], points[:, 2] > z[0], points[:, 2] < z[1]]
    arc = points[np.all(inside, axis=0)][:, [0, 2]]
    (a, b, c), *_ = np.linalg.lstsq(np.column_stack([arc, np.ones(len(arc))]), (arc**2).sum(axis=1), rcond=None)
    return np.sqrt(c + (a**2 + b**2) / 4)


def blank_and_holder(run):
    """Return length and width of the blank, mm, and the force of the holder on the whole and on the quarter, kN."""
    history = read_frame(run, "history.csv")
    force = abs(history["holder_fz"][history["phase"] == "clamp"].iloc[-1]) / 1000
    return [*(WHOLE * np.ptp(Fields(run).initial(0), axis=0)[:2]), WHOLE**2 * force, force]


def thinning(run):
    """Return the thinning of the elements at the end, per cent."""
    fields = Fields(run)
    return 100 * fields.component(fields.last, "thinning", True)[0]


def lengths(run):
    """Return the largest length of the elements along x at the start, and the smallest at the end, mm."""
    fields = Fields(run)
    first, last = (np.diff(np.unique(fields.initial(step)[:, 0].round(3))) for step in (0, fields.last))
    return [first.max(), last.min()]


def thickness_points(run):
    """Return the points through the thickness that the input gives."""
    entries = [entry for block in read_job(run)["input"]["blocks"] for entry in block["entries"]]
    return next(int(entry["value"]) for entry in entries if entry["key"] == "thickness_points")


# Parts of the text, {} for each number, with the numbers by the folder of the tools and results.
TEXT = (
    ("A tray of mild steel, {} x {} mm and {} mm deep",
     lambda tray: [*np.ptp(surface_of(tray / "punch.bez"), axis=0)[:2], Fields(tray / "second.out").travel[-1]]),
    ("A blank of {} x {} mm, and a holder force of {} kN ({} kN on the quarter)",
     lambda tray: blank_and_holder(tray / "first.out")),
    ("at the corners of the punch the thinning is up to {} %", lambda tray: [thinning(tray / "first.out").max()]),
    ("A smaller blank, {} x {} mm, and a holder force of {} kN ({} kN on the quarter)",
     lambda tray: blank_and_holder(tray / "second.out")),
    ("The largest thinning is {} %", lambda tray: [thinning(tray / "second.out").max()]),
    ("The flange thickens by up to {} %", lambda tray: [-thinning(tray / "second.out").min()]),
    ("The elements of {} mm have been divided twice where the sheet bends, to {} mm",
     lambda tray: lengths(tray / "second.out")),
    ("the radii of {} mm (die) and {} mm (punch)",
     lambda tray: [radius_of(tray / "die.bez", (51.2, 55.8), (-4.8, -0.2)),
                   radius_of(tray / "punch.bez", (44.2, 49.8), (1, 6.6))]),
    ("use 9 points through the thickness instead of {}", lambda tray: [thickness_points(tray / "second.out")]),
)


def wrong_text(page, tray):
    """Yield the numbers in the text of the page that differ from the results, and those that are not checked."""
    text = re.sub(r"^( {4}|#|!).*$|`[^`]*`|\]\([^)]*\)", "", page, flags=re.MULTILINE)
    text = " ".join(text.split())
    for part, values in TEXT:
        pattern = f"({NUMBER.pattern})".join(map(re.escape, part.split("{}")))
        found = re.search(pattern, text)
        if not found:
            yield f"not in the text: {part}"
            continue
        for printed, value in zip(found.groups(), values(tray), strict=True):
            if abs(float(printed) - value) > ROUNDED * 10.0**-len(printed.partition(".")[2]):
                yield f"{found[0]}: {printed} is {value:.4g} in the run"
        text = text.replace(found[0], "")
    for left in re.finditer(r"[^.]*\d[^.]*", text):
        yield f"a number that is not checked: {left[0].strip()}"


def commands(page):
    """Return the commands of a page, each with the texts that it prints."""
    found = []
    for line in re.findall(r"^    (.+)$", page, re.MULTILINE):
        if line.startswith("# "):
            found[-1][1].append(line[2:])
        elif not line.startswith("source "):
            found.append((line, []))
    return found


def shows(printed, text, part=0.0):
    """Whether an output contains the words of a text and, within the last digits or a part of them, its numbers."""
    numbers = NUMBER.findall(text)
    pattern = "(" + NUMBER.pattern + ")"
    for found in re.findall(pattern.join(map(re.escape, NUMBER.split(text))), printed):
        values = [found] if isinstance(found, str) else found
        if all(abs(float(value) - float(number)) < max(LAST_DIGITS * 10.0**-len(number.partition(".")[2]),
                                                       (PART if number.isdigit() else part) * abs(float(number)))
               for value, number in zip(values, numbers)):
            return True
    return False


def main():
    """Run the commands in a folder that looks like the repository."""
    parser = parser_of_runs(__doc__)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    work = options.work.resolve()
    shutil.rmtree(work, ignore_errors=True)
    (work / "build" / "release").mkdir(parents=True)
    (work / "build" / "release" / "dd3imp").symlink_to(pathlib.Path(options.program).resolve())
    shutil.copytree(ROOT / "input_files" / "tutorial", work / "input_files" / "tutorial")
    folder = pathlib.Path(sys.executable).parent
    failed = 0
    for command, texts in commands(PAGE.read_text(encoding="utf-8")):
        words = shlex.split(command)
        words[0] = str(folder / "dd3") if words[0] == "dd3" else words[0]
        if words[0].endswith(".py"):
            words.insert(0, sys.executable)
        done = subprocess.run(words, cwd=work, capture_output=True, text=True, check=False)
        missing = [text for text in texts if not shows(done.stdout, text)]
        if done.returncode or missing:
            failed += 1
            print(f"{command}\nexit code {done.returncode}; not printed: {missing}\n{done.stdout[-2000:]}{done.stderr}")
    for problem in wrong_text(PAGE.read_text(encoding="utf-8"), work / "build" / "tray"):
        failed += 1
        print(problem)
    pictures = re.findall(r"\(images/tutorial_(\w+\.png)\)", PAGE.read_text(encoding="utf-8"))
    for picture in pictures:
        if not (work / "build" / "tray" / picture).exists():
            failed += 1
            print(f"{picture} is not made")
        elif options.write:
            shutil.copy(work / "build" / "tray" / picture, IMAGES / f"tutorial_{picture}")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
