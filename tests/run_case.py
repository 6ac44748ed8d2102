#!/usr/bin/env python3
"""Runs one case of tests/cases/ and compares its history with the reference.

    run_case.py --program build/release/dd3imp --work build/cases tests/cases/tension

A case is a folder with a case.json:

    deck        the input file, default case.dat; a path relative to the folder
    arguments   further arguments of the program, a list
    exit_code   what the program must return, default 0
    reference   csv file with the columns of history.csv that are compared; default reference.csv where it exists
    along       the column along which values are interpolated, default travel; where the reference has a column `phase`
                or `point`, only the rows of that phase or point are looked at
    tolerance   per column {"relative": r, "absolute": a}; "*" holds for those not named. A value is accepted where
                |value - reference| <= a + r |reference|
    last        per column [value, tolerance]: the last row of history.csv
    status      per column of status.csv [lowest, highest]: every row lies between
    contains    texts that the program's output must hold, a list
    files       files that must lie in the results, default ["history.csv", "status.csv", "job.log"]
    variants    lists of further arguments: the case is run once for each, and each must pass; or objects with
                `arguments` and keys that take the place of the case's, such as a reference of its own
    labels      CTest labels, a list; `slow` keeps it out of the daily run, `debug` lets it run in the debug build too
    timeout     seconds, default 300
"""
import argparse
import csv
import json
import pathlib
import shutil
import subprocess
import sys

SELECTS = ("phase", "point")
KNOWN = {"deck", "arguments", "exit_code", "reference", "along", "tolerance", "last", "status", "contains", "files",
         "variants", "labels", "timeout", "description"}


class Mismatch(Exception):
    """The case does not do what it should."""


def read_table(path):
    """The rows of a csv file as dictionaries; lines that begin with # are left out."""
    if not path.exists():
        raise Mismatch(f"{path} was not written")
    with open(path, newline="", encoding="utf-8") as stream:
        lines = [line for line in stream if line.strip() and not line.lstrip().startswith("#")]
    rows = csv.DictReader(lines, skipinitialspace=True)
    return [{name.strip(): (value or "").strip() for name, value in row.items() if name} for row in rows]


def number(row, column, path):
    """A value of a row as a number."""
    if column not in row:
        raise Mismatch(f"{path}: there is no column {column}; there are {', '.join(row)}")
    try:
        return float(row[column])
    except ValueError:
        raise Mismatch(f"{path}: {column} = {row[column]!r} is not a number") from None


def interpolate(rows, along, at, column, path):
    """The value of a column where `along` is `at`; the last row of several with the same `along` counts."""
    slack = 1e-9 * max(1.0, abs(at))
    below = above = None
    for row in rows:
        place = number(row, along, path)
        if place <= at + slack:
            below = row
        elif above is None:
            above = row
    if below is None:
        raise Mismatch(f"{path}: begins after {along} = {at}")
    start, value = number(below, along, path), number(below, column, path)
    if abs(start - at) <= slack:
        return value
    if above is None:
        raise Mismatch(f"{path}: ends at {along} = {start}, before {at}")
    end = number(above, along, path)
    return value + (at - start) / (end - start) * (number(above, column, path) - value)


def compare_reference(case, folder, history, path):
    """Holds the history against the reference, row by row."""
    name = case.get("reference", "reference.csv")
    if "reference" not in case and not (folder / name).exists():
        return 0
    reference = read_table(folder / name)
    if not reference:
        raise Mismatch(f"{name} is empty")
    along = case.get("along", "travel")
    tolerances = case.get("tolerance", {})
    compared = 0
    wrong = []
    for row in reference:
        rows = [r for r in history if all(r[key] == row[key] for key in SELECTS if key in row)]
        at = number(row, along, name)
        for column in row:
            if column == along or column in SELECTS:
                continue
            tolerance = tolerances.get(column, tolerances.get("*"))
            if tolerance is None:
                raise Mismatch(f"{name}: no tolerance is given for {column}")
            expected = number(row, column, name)
            value = interpolate(rows, along, at, column, path)
            allowed = tolerance.get("absolute", 0.0) + tolerance.get("relative", 0.0) * abs(expected)
            compared += 1
            if not abs(value - expected) <= allowed:
                wrong.append(f"{along} = {at:g}: {column} = {value:.9g}, expected {expected:.9g} +- {allowed:.3g}")
    if wrong:
        raise Mismatch("\n".join(wrong))
    return compared


def compare_ends(case, history, path, results):
    """Looks at the last row of the history and at the range of the status table."""
    compared = 0
    for column, (expected, tolerance) in case.get("last", {}).items():
        value = number(history[-1], column, path)
        compared += 1
        if not abs(value - expected) <= tolerance:
            raise Mismatch(f"last row: {column} = {value:.9g}, expected {expected:.9g} +- {tolerance:.3g}")
    for column, (lowest, highest) in case.get("status", {}).items():
        for row in read_table(results / "status.csv"):
            value = number(row, column, "status.csv")
            compared += 1
            if not lowest <= value <= highest:
                raise Mismatch(f"status.csv, increment {row.get('increment')}: {column} = {value:.9g}, "
                               f"not in {lowest:g} ... {highest:g}")
    return compared


def variants(case):
    """The case once for each of its variants, with the further arguments."""
    for variant in case.get("variants", [[]]):
        own = dict(variant) if isinstance(variant, dict) else {"arguments": variant}
        further = own.pop("arguments", [])
        yield {**case, **own}, further


def run(case, folder, program, results, arguments):
    """Runs the case once; returns how many values were compared."""
    shutil.rmtree(results, ignore_errors=True)
    results.parent.mkdir(parents=True, exist_ok=True)
    deck = folder / case.get("deck", "case.dat")
    command = [str(program), *case.get("arguments", []), *arguments, "--output", str(results), str(deck)]
    print(" ".join(command), flush=True)
    done = subprocess.run(command, cwd=results.parent, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace", stdin=subprocess.DEVNULL, timeout=case.get("timeout", 300), check=False)
    print("\n".join(done.stdout.splitlines()[-40:]))
    expected = case.get("exit_code", 0)
    if done.returncode != expected:
        raise Mismatch(f"exit code {done.returncode} in place of {expected}")
    for text in case.get("contains", []):
        if text not in done.stdout:
            raise Mismatch(f"the output does not hold: {text}")
    for name in case.get("files", ["history.csv", "status.csv", "job.log"]):
        if not (results / name).exists():
            raise Mismatch(f"{name} was not written")
    path = results / "history.csv"
    if not path.exists():
        return len(case.get("contains", []))
    history = read_table(path)
    return (compare_reference(case, folder, history, path) + compare_ends(case, history, path, results)
            + len(case.get("contains", [])))


def main():
    """Runs the case in all its variants."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, required=True, help="the program dd3imp")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for the results")
    parser.add_argument("case", type=pathlib.Path, help="folder of the case")
    options = parser.parse_args()
    folder = options.case.resolve()
    case = json.loads((folder / "case.json").read_text(encoding="utf-8"))
    unknown = {key for own in (case, *case.get("variants", [])) if isinstance(own, dict) for key in own} - KNOWN
    if unknown:
        sys.exit(f"case.json: unknown: {', '.join(sorted(unknown))}")
    compared = 0
    for i, (one, arguments) in enumerate(variants(case)):
        results = options.work.resolve() / (folder.name + (f"-{i + 1}" if i else "") + ".out")
        try:
            compared += run(one, folder, options.program.resolve(), results, arguments)
        except (Mismatch, OSError, subprocess.TimeoutExpired) as error:
            sys.exit(f"FAILED {folder.name} {' '.join(arguments)}\n{error}")
    if compared == 0 and case.get("exit_code", 0) == 0:
        sys.exit(f"FAILED {folder.name}: nothing was compared")
    print(f"passed, {compared} values compared")


if __name__ == "__main__":
    main()
