#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the program on inputs that must be refused.

Each <name>.expected belongs to <name>.dat (which may be missing or a folder). Its lines must appear in this order in
what the program says on the error stream. A first line `exit code N` asks for another exit code than 2.
<name>.arguments holds further arguments. Neither a backtrace nor a new file may be left.
"""
import argparse
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
TRACES = ("Backtrace", "SIGSEGV", "SIGABRT", "SIGFPE", "runtime error", "At line", "ERROR STOP", "Sanitizer")


def tree(folder):
    """All paths below a folder."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


def missing_line(expected, said):
    """The first expected line that does not appear after those before it; None if all do."""
    start = 0
    for line in expected:
        found = said.find(line, start)
        if found < 0:
            return line
        start = found + len(line)
    return None


def check(program, folder, expected_file):
    """Runs one input; returns what is wrong and what the program said."""
    name = expected_file.stem
    expected = expected_file.read_text(encoding="utf-8").splitlines()
    code = 2
    if expected and expected[0].startswith("exit code "):
        code = int(expected.pop(0).split()[-1])
    arguments = folder / f"{name}.arguments"
    options = arguments.read_text(encoding="utf-8").split() if arguments.exists() else []
    before = tree(folder)
    try:
        run = subprocess.run([program, *options, f"{name}.dat"], cwd=folder, capture_output=True, timeout=60,
                             check=False)
    except subprocess.TimeoutExpired:
        return ["it did not end within 60 s"], ""
    said = run.stderr.decode("utf-8", "replace")
    wrong = []
    if run.returncode != code:
        wrong.append(f"exit code {run.returncode}, expected {code}")
    line = missing_line(expected, said)
    if line is not None:
        wrong.append(f"not said, or not in this order: {line}")
    wrong += [f"it says {trace!r}" for trace in TRACES if trace in said]
    if tree(folder) != before:
        wrong.append(f"files are left: {sorted(set(tree(folder)) - set(before))}")
    return wrong, said


def main():
    """Runs all inputs, or those named."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True, help="the dd3imp executable")
    parser.add_argument("name", nargs="*", help="inputs to run; all when left out")
    arguments = parser.parse_args()
    program = str(pathlib.Path(arguments.program).resolve())
    failed = 0
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch) / "bad_input"
        shutil.copytree(HERE, folder)
        files = sorted(folder.glob("*.expected"))
        if arguments.name:
            files = [path for path in files if path.stem in arguments.name]
        for path in files:
            wrong, said = check(program, folder, path)
            print(f"{'FAILED' if wrong else 'passed'}  {path.stem}")
            for text in wrong:
                print(f"        {text}")
            if wrong and said:
                print("        " + said.replace("\n", "\n        "))
            failed += bool(wrong)
    print(f"bad input: {len(files) - failed} refused as expected, {failed} not")
    return 1 if failed or not files else 0


if __name__ == "__main__":
    sys.exit(main())
