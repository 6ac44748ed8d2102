#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Install the source distribution by pip without a network, in an environment of its own; run an example from there."""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def call(words, folder):
    """Run a command in a folder; return what it prints."""
    done = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}: exit code {done.returncode}\n{done.stdout[-4000:]}{done.stderr[-4000:]}")
    return done.stdout


def main():
    """Pack, install, run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cmake", required=True, type=pathlib.Path)
    options = parser.parse_args()
    os.environ.update(PIP_NO_INDEX="1", CMAKE_EXECUTABLE=str(options.cmake))
    os.environ.pop("PYTHONPATH", None)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        code = f"from scikit_build_core.build import build_sdist; build_sdist({str(folder)!r})"
        call([sys.executable, "-c", code], ROOT)
        (source,) = folder.glob("dd3imp-*.tar.gz")
        call([sys.executable, "-m", "venv", folder / "env"], folder)
        # The packages of this Python are seen by the new one: those that dd3 needs, and the tools of the build.
        found = next(path for path in sys.path if path.endswith("site-packages"))
        (site,) = (folder / "env" / "lib").glob("python*/site-packages")
        (site / "found.pth").write_text(found + "\n", encoding="utf-8")
        call([folder / "env" / "bin" / "pip", "install", "--no-build-isolation", "--no-deps", "--ignore-installed", source,
              "--config-settings=cmake.define.CMAKE_Fortran_FLAGS_RELEASE=-O0"], folder)  # it takes half the time
        dd3, program = folder / "env" / "bin" / "dd3", folder / "env" / "bin" / "dd3imp"
        said = call([dd3, "info"], folder)
        assert str(site / "dd3" / "bin" / "dd3imp") in said and str(site / "dd3" / "lib") in said, said
        call([dd3, "example", "square_cup"], folder)
        call([program, "--quiet", "--set", "divisions=4 4 1", "--set", "levels=0", "--set", "depth=1",
              "square_cup/square_cup.dat"], folder)
        call([dd3, "plot", "force", "square_cup/square_cup.out", "--output", "force.png"], folder)
        drawn = ("from dd3.plot.force import figure; (line,) = figure(['square_cup/square_cup.out'], []).axes[0].lines; "
                 "print(*line.get_xydata()[-1])")
        depth, force = map(float, call([folder / "env" / "bin" / "python", "-c", drawn], folder).split())
        assert depth == 1 and 140 < force < 160, (depth, force)  # N, of a quarter of the cup: 149.5
    print("the source distribution builds and runs")


if __name__ == "__main__":
    main()
