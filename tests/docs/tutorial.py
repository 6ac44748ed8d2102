#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "docs_tutorial", "labels": ["docs", "slow"], "timeout": 1800, "cost": 80}
"""Run the commands of docs/tutorial.md and compare what they print with the page.

  tutorial.py --program build/release/dd3imp --work build/tutorial [--write]

Words are the same; a number differs by two of its last digit at most, which other processors and libraries may change,
and a number of nodes or elements by 5 %, as the mesh is divided a little elsewhere then.
--write copies the pictures into docs/images.
"""
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

from dd3.programs import parser_of_runs

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "tutorial.md"
IMAGES = ROOT / "docs" / "images"
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")
LAST_DIGITS, PART = 2.1, 0.05  # with the round-off of the comparison; of whole numbers


def commands():
    """Return the commands of the page, each with the texts that it prints."""
    found = []
    for line in re.findall(r"^    (.+)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE):
        if line.startswith("# "):
            found[-1][1].append(line[2:])
        elif not line.startswith("source "):
            found.append((line, []))
    return found


def shows(printed, text):
    """Whether an output contains the words of a text and, within the last digits, its numbers."""
    numbers = NUMBER.findall(text)
    pattern = "(" + NUMBER.pattern + ")"
    for found in re.findall(pattern.join(map(re.escape, NUMBER.split(text))), printed):
        values = [found] if isinstance(found, str) else found
        if all(abs(float(value) - float(number))
               < max(LAST_DIGITS * 10.0**-len(number.partition(".")[2]), PART * abs(float(number)) * number.isdigit())
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
    for command, texts in commands():
        words = shlex.split(command)
        words[0] = str(folder / "dd3") if words[0] == "dd3" else words[0]
        if words[0].endswith(".py"):
            words.insert(0, sys.executable)
        done = subprocess.run(words, cwd=work, capture_output=True, text=True, check=False)
        missing = [text for text in texts if not shows(done.stdout, text)]
        if done.returncode or missing:
            failed += 1
            print(f"{command}\nexit code {done.returncode}; not printed: {missing}\n{done.stdout[-2000:]}{done.stderr}")
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
