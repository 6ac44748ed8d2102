#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Install into a temporary prefix; build and run a program of C and one of Fortran by find_package(dd3imp)."""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent


def call(words, expected=0):
    """Run a command; return what it prints."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=100, check=False)
    if done.returncode != expected:
        sys.exit(f"{' '.join(map(str, words))}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def main():
    """Install, build, run, remove."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cmake", required=True)
    parser.add_argument("--build", required=True, type=pathlib.Path)
    parser.add_argument("--compiler", required=True, help="Fortran compiler of the build")
    parser.add_argument("--generator", required=True, help="that of the build")
    parser.add_argument("--version", required=True)
    options = parser.parse_args()
    os.environ.pop("DESTDIR", None)
    with tempfile.TemporaryDirectory() as name:
        prefix, work = pathlib.Path(name) / "a prefix", pathlib.Path(name) / "work"
        call([options.cmake, "--install", options.build, "--prefix", prefix])
        configure = [options.cmake, "-S", HERE / "package", "-B", work, f"-DCMAKE_PREFIX_PATH={prefix}",
                     "-G", options.generator, f"-DCMAKE_Fortran_COMPILER={options.compiler}"]
        next_major = int(options.version.split(".")[0]) + 1
        assert "compatible" in call([*configure, f"-DWANTED={next_major}.0"], expected=1)
        call([*configure, f"-DWANTED={options.version}"])
        call([options.cmake, "--build", work])
        stresses = [float(call([work / program])) for program in ("tension_c", "tension_fortran")]
    # Uniaxial plastic flow of an incompressible strain: J2 flow at constant volume, trace of the stress zero.
    plastic = 0.01
    for _ in range(50):
        plastic = 0.01 - 565 * (0.007117 + plastic) ** 0.259 / (3 * 2.1e5 / 2.6)
    expected = 565 * (0.007117 + plastic) ** 0.259 * 2 / 3
    assert all(abs(stress - expected) < 1e-6 for stress in stresses), (stresses, expected)
    print(f"stress of both programs: {expected:.6f} MPa")


if __name__ == "__main__":
    main()
