#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Install into a temporary prefix; run the program, an example and the utilities from there."""
import argparse
import csv
import os
import pathlib
import re
import subprocess
import sys
import tempfile

LINK = re.compile(r"\]\((?!https?:|#)([^)#]+)")


def call(words, folder):
    """Run a command in a folder; return what it prints."""
    done = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True, timeout=100,
                          check=False)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def missing(folder):
    """Return the links of the installed documents that lead nowhere."""
    pages = [*folder.glob("*.md"), *(folder / "docs").rglob("*.md")]
    return [f"{page}: {link}" for page in pages for link in LINK.findall(page.read_text(encoding="utf-8"))
            if not (page.parent / link).exists()]


def check_program(prefix, folder):
    """Run an example whose tools are beside it, for a millimetre."""
    program = prefix / "bin" / "dd3imp"
    assert "dd3imp" in call([program, "--version"], folder)
    deck = prefix / "share" / "dd3imp" / "input_files" / "square_cup" / "square_cup.dat"
    call([program, "--quiet", "--set", "divisions=4 4 1", "--set", "levels=0", "--set", "depth=1", "--output", folder / "cup.out", deck],
         folder)
    assert "reached the end" in (folder / "cup.out" / "job.log").read_text(encoding="utf-8")


def check_utilities(prefix, folder):
    """Call the utilities by their name, with the Python of this test, and as the package of another Python."""
    os.environ["PATH"] = os.pathsep.join([str(pathlib.Path(sys.executable).parent), os.environ["PATH"]])
    os.environ.pop("PYTHONPATH", None)
    command, data = prefix / "bin" / "dd3", prefix / "share" / "dd3imp"
    said = call([command, "info"], folder)
    assert str(prefix / "bin" / "dd3imp") in said and str(data / "input_files") in said, said
    call([command, "section", "cup.out", "--plane", "y=0", "--field", "thickness", "--table", "section.csv"], folder)
    with (folder / "section.csv").open(encoding="utf-8") as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    # The blank, 75 mm long and 0.78 mm thick, drawn by a millimetre.
    assert (rows[0]["x0"], rows[-1]["x0"]) == (0, 75) and all(0.77 < row["thickness"] < 0.79 for row in rows), rows
    call([command, "example", "square_cup", "--into", "copied"], folder)
    call([prefix / "bin" / "dd3imp", "--check", "--quiet", folder / "copied" / "square_cup" / "square_cup.dat"], folder)


def main():
    """Install, check, remove."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cmake", required=True)
    parser.add_argument("--build", required=True, type=pathlib.Path)
    options = parser.parse_args()
    os.environ.pop("DESTDIR", None)
    with tempfile.TemporaryDirectory() as name:
        prefix, folder = pathlib.Path(name) / "a prefix", pathlib.Path(name) / "work"
        folder.mkdir()
        call([options.cmake, "--install", options.build, "--prefix", prefix], folder)
        lost = missing(prefix / "share" / "doc" / "dd3imp")
        assert not lost, "\n".join(lost)
        check_program(prefix, folder)
        check_utilities(prefix, folder)
    print("the installed program, example and utilities run")


if __name__ == "__main__":
    main()
