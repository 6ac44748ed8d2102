#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run one case of tests/cases/, compare its history with the reference and validate its run.json.

    run_case.py --program build/release/dd3imp --work build/cases tests/cases/tension

A case is a folder with a case.json:

    description what the case checks, and where the expected numbers come from
    deck        the input file, default case.dat; a path relative to the folder
    arguments   further arguments of the program, a list
    exit_code   expected exit code, default 0
    reference   csv file with the columns of history.csv to compare; default reference.csv if it exists
    along       the column along which values are interpolated, default travel; if the reference has a column `phase`
                or `point`, only the rows of that phase or point are used
    tolerance   per column {"relative": r, "absolute": a}; "*" holds for the columns not named. A value passes if
                |value - reference| <= a + r |reference|
    last        per column [value, tolerance]: the last row of history.csv
    equal       lists [column, column, tolerance] of columns that agree in every row of history.csv
    status      per column of status.csv [lowest, highest]: bounds of every row
    codes       codes of messages that the run must give, a list; those of docs/messages.md
    contains    texts that the program's output must contain, a list: names and numbers, not sentences
    files       files that the results must contain beside run.json, default ["history.csv", "status.csv", "job.log"]
    variants    lists of further arguments: the case is run once for each, and each must pass; or objects with
                `arguments` and keys that replace those of the case, such as a reference of their own
    labels      CTest labels, a list; `slow` excludes the case from the daily run, `debug` adds it to the debug build
    timeout     seconds, default 300
"""
import argparse
import json
import pathlib
import shutil
import sys

from run_description import check_description

from dd3.errors import Problem
from dd3.programs import command, find_program, launch
from dd3.tables import number, read_table

SELECTS = ("phase", "point")
KNOWN = {"deck", "arguments", "exit_code", "reference", "along", "tolerance", "last", "equal", "status", "contains",
         "codes", "files", "variants", "labels", "timeout", "description"}


class Mismatch(Exception):
    """The results of a case are not the expected ones."""


def interpolate(rows, along, at, column, path):
    """Return the value of a column where `along` is `at`; of several rows with the same `along` the last is used."""
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


def selected(history, row):
    """Return the rows of the history with the phase and point of a row of the reference."""
    return [other for other in history if all(other[key] == row[key] for key in SELECTS if key in row)]


def compare_row(case, name, row, history, path):
    """Return the number of values compared for a row of the reference, and the list of those that differ."""
    along, tolerances = case.get("along", "travel"), case.get("tolerance", {})
    rows, at = selected(history, row), number(row, along, name)
    columns = [column for column in row if column != along and column not in SELECTS]
    wrong = []
    for column in columns:
        tolerance = tolerances.get(column, tolerances.get("*"))
        if tolerance is None:
            raise Mismatch(f"{name}: no tolerance is given for {column}")
        expected = number(row, column, name)
        value = interpolate(rows, along, at, column, path)
        allowed = tolerance.get("absolute", 0.0) + tolerance.get("relative", 0.0) * abs(expected)
        if not abs(value - expected) <= allowed:
            wrong.append(f"{along} = {at:g}: {column} = {value:.9g}, expected {expected:.9g} +- {allowed:.3g}")
    return len(columns), wrong


def compare_reference(case, folder, history, path):
    """Compare the history with the reference row by row; return the number of values compared."""
    name = case.get("reference", "reference.csv")
    if "reference" not in case and not (folder / name).exists():
        return 0
    reference = read_table(folder / name)
    if not reference:
        raise Mismatch(f"{name} is empty")
    found = [compare_row(case, name, row, history, path) for row in reference]
    wrong = [text for _, texts in found for text in texts]
    if wrong:
        raise Mismatch("\n".join(wrong))
    return sum(count for count, _ in found)


def compare_ends(case, history, path, results):
    """Compare the last row of the history and the ranges of the status table; return the number of values compared."""
    compared = 0
    for column, (expected, tolerance) in case.get("last", {}).items():
        value = number(history[-1], column, path)
        compared += 1
        if not abs(value - expected) <= tolerance:
            raise Mismatch(f"last row: {column} = {value:.9g}, expected {expected:.9g} +- {tolerance:.3g}")
    for left, right, tolerance in case.get("equal", []):
        for row in history:
            values = number(row, left, path), number(row, right, path)
            compared += 1
            if not abs(values[0] - values[1]) <= tolerance:
                raise Mismatch(f"increment {row['increment']}: {left} = {values[0]:.9g}, {right} = {values[1]:.9g}, "
                               f"expected equal +- {tolerance:.3g}")
    for column, (lowest, highest) in case.get("status", {}).items():
        for row in read_table(results / "status.csv"):
            value = number(row, column, "status.csv")
            compared += 1
            if not lowest <= value <= highest:
                raise Mismatch(f"status.csv, increment {row.get('increment')}: {column} = {value:.9g}, "
                               f"not between {lowest:g} and {highest:g}")
    return compared


def variants(case):
    """Yield the case of each variant, with its further arguments."""
    for variant in case.get("variants", [[]]):
        own = dict(variant) if isinstance(variant, dict) else {"arguments": variant}
        further = own.pop("arguments", [])
        yield {**case, **own}, further


def check_output(case, done, results):
    """Check exit code, output and files of a run."""
    expected = case.get("exit_code", 0)
    if done.code != expected:
        raise Mismatch(f"exit code {done.code}, expected {expected}")
    for text in case.get("contains", []):
        if text not in done.output + done.errors:
            raise Mismatch(f"the output does not contain: {text}")
    for name in case.get("files", ["history.csv", "status.csv", "job.log"]):
        if not (results / name).exists():
            raise Mismatch(f"{name} was not written")
    if expected in (0, 3):
        check_codes(case, check_description(results, expected))


def check_codes(case, found):
    """Check the codes of the messages of a run, given its run.json."""
    given = {message["code"] for name in ("warnings", "notes", "errors") for message in found[name]}
    missing = set(case.get("codes", [])) - given
    if missing:
        raise Mismatch(f"expected the messages {', '.join(sorted(missing))}, got {', '.join(sorted(map(str, given)))}")


def run(case, folder, program, results, arguments):
    """Run the case once; return the number of values compared."""
    shutil.rmtree(results, ignore_errors=True)
    results.parent.mkdir(parents=True, exist_ok=True)
    words = command(program, folder / case.get("deck", "case.dat"), results, [*case.get("arguments", []), *arguments])
    print(" ".join(words), flush=True)
    done = launch(words, timeout=case.get("timeout", 300), folder=results.parent, one_core=False)
    print("\n".join((done.output + done.errors).splitlines()[-40:]))
    check_output(case, done, results)
    compared, path = len(case.get("contains", [])) + len(case.get("codes", [])), results / "history.csv"
    if path.exists():
        history = read_table(path)
        compared += compare_reference(case, folder, history, path) + compare_ends(case, history, path, results)
    return compared


def main():
    """Run the case in all its variants."""
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
    program, compared = find_program(options.program), 0
    for i, (one, arguments) in enumerate(variants(case)):
        results = options.work.resolve() / (folder.name + (f"-{i + 1}" if i else "") + ".out")
        try:
            compared += run(one, folder, program, results, arguments)
        except (Mismatch, Problem, OSError) as error:
            sys.exit(f"FAILED {folder.name} {' '.join(arguments)}\n{error}")
    if compared == 0 and case.get("exit_code", 0) == 0:
        sys.exit(f"FAILED {folder.name}: nothing was compared")
    print(f"passed, {compared} values compared")


if __name__ == "__main__":
    main()
