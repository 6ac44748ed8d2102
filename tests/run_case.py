#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run cases, compare their histories with the reference and validate their run.json.

    run_case.py --program build/release/dd3imp --work build/cases tests/cases/roll_up/case.dat
    run_case.py --program build/release/dd3imp --work build tests/bad_input          all cases of a folder

A case is a deck that says in comment lines what is expected (case_file.py), or a file of JSON for a deck elsewhere:

    description what the case checks, and where the expected numbers come from
    deck        the input file, default that with the comment lines, or case.dat; a path relative to the folder
    arguments   further arguments of the program, a list
    exit_code   expected exit code, default 0, in bad_input/ 2. After 1 or 2 no new file may be left
    reference   csv file with the columns of history.csv to compare; default the rows of comment lines, or reference.csv
    along       the column along which values are interpolated, default travel; if the reference has a column `phase`
                or `point`, only the rows of that phase or point are used
    tolerance   per column {"relative": r, "absolute": a}; "*" holds for the columns not named. A value passes if
                |value - reference| <= a + r |reference|
    last        per column [value, tolerance]: the last row of history.csv
    equal       lists [left, right, tolerance] of what agrees in every row of history.csv: columns, or lists of columns
                that are summed, such as forces in equilibrium
    same        per column [factor, tolerance]: the last row is that of the first variant times the factor, within a
                relative tolerance
    status      per column of status.csv [lowest, highest]: bounds of every row
    elements    [lowest, highest]: number of elements at the last step of fields.vtkhdf
    codes       codes of messages that the run must give, a list; those of docs/messages.md
    contains    texts that the program's output must contain, a list: names and numbers, not sentences; after an exit
                code of 1 or 2 the error stream alone
    absent      texts that it must not contain, a list
    printed     texts that it must contain in this order; default those of comment lines
    files       files that the results must contain beside run.json, default ["history.csv", "status.csv", "job.log"],
                none after an exit code of 1 or 2
    variants    lists of further arguments: the case is run once for each, and each must pass; or objects with
                `arguments` and keys that replace those of the case, such as a reference of their own
    labels      CTest labels, a list; with `slow` the case runs for some commits only, `debug` adds it to the debug build
    timeout     seconds of one run, default 300
    cost        seconds of all runs on one processor, of a slow case
"""
import functools
import pathlib
import re
import shutil
import sys

from case_file import SECONDS, cases, name_of, read_case
from run_description import check_description

from dd3.errors import Problem
from dd3.programs import command, launch, parser_of_runs
from dd3.tables import number, read_table

SELECTS = ("phase", "point")
KNOWN = {"deck", "arguments", "exit_code", "reference", "along", "tolerance", "last", "equal", "same", "status",
         "elements", "contains", "absent", "printed", "rows", "codes", "files", "variants", "labels", "timeout",
         "cost", "description"}
REFUSED = (1, 2)  # exit codes of a run that was not begun
TRACES = ("Backtrace", "SIGSEGV", "SIGABRT", "SIGFPE", "runtime error", "At line", "ERROR STOP", "Sanitizer")
CODE = re.compile(r"\b(?:warning|note|error|stopped) ([A-Z]\d{3}): ")
LISTED = re.compile(r"^\| ([A-Z]\d{3}) \|", re.MULTILINE)


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
    if "reference" not in case and case.get("rows"):
        folder, name = path.parent, "reference.csv"
        (folder / name).write_text("\n".join(case["rows"]) + "\n", encoding="utf-8")
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


def total(row, columns, path):
    """Return the value of a column, or the sum of several."""
    return sum(number(row, column, path) for column in ([columns] if isinstance(columns, str) else columns))


def compare_variants(case, history, first, path):
    """Compare the last row of the history with that of the first variant; return the number of values compared."""
    for column, (factor, tolerance) in case.get("same", {}).items():
        value, expected = number(history[-1], column, path), factor * number(first[-1], column, path)
        if not abs(value - expected) <= tolerance * abs(expected):
            raise Mismatch(f"last row: {column} = {value:.9g}, in the first variant times {factor:g} {expected:.9g}, "
                           f"expected equal +- {tolerance:.3g} of it")
    return len(case.get("same", {}))


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
            values = [total(row, side, path) for side in (left, right)]
            compared += 1
            if not abs(values[0] - values[1]) <= tolerance:
                raise Mismatch(f"increment {row.get('increment')}: {left} = {values[0]:.9g}, {right} = {values[1]:.9g}, "
                               f"expected equal +- {tolerance:.3g}")
    for column, (lowest, highest) in case.get("status", {}).items():
        for row in read_table(results / "status.csv"):
            value = number(row, column, "status.csv")
            compared += 1
            if not lowest <= value <= highest:
                raise Mismatch(f"status.csv, increment {row.get('increment')}: {column} = {value:.9g}, "
                               f"not between {lowest:g} and {highest:g}")
    return compared


def compare_elements(case, results):
    """Compare the number of elements at the end; return the number of values compared."""
    if "elements" not in case:
        return 0
    from dd3.fields import Fields  # takes as long as a small case
    count, (lowest, highest) = Fields(results).size_of("Cells", -1), case["elements"]
    if not lowest <= count <= highest:
        raise Mismatch(f"{count} elements at the end, not between {lowest} and {highest}")
    return 1


def variants(case):
    """Yield the case of each variant, with its further arguments."""
    for variant in case.get("variants", [[]]):
        own = dict(variant) if isinstance(variant, dict) else {"arguments": variant}
        further = own.pop("arguments", [])
        yield {**case, **own}, further


def check_output(case, done, results, program):
    """Check exit code, output, codes of messages and files of a run."""
    expected = case.get("exit_code", 0)
    if done.code != expected:
        raise Mismatch(f"exit code {done.code}, expected {expected}")
    said, place = done.errors if expected in REFUSED else done.output + done.errors, 0
    for text in case.get("contains", []):
        if text not in said:
            raise Mismatch(f"the output does not contain: {text}")
    for text in case.get("absent", []):
        if text in said:
            raise Mismatch(f"the output contains: {text}")
    for text in case.get("printed", []):
        found = said.find(text, place)
        if found < 0:
            raise Mismatch(f"the output does not contain, in this order: {text}")
        place = found + len(text)
    for trace in TRACES:
        if trace in done.errors:
            raise Mismatch(f"the program says {trace!r}")
    for name in case.get("files", [] if expected in REFUSED else ["history.csv", "status.csv", "job.log"]):
        if not (results / name).exists():
            raise Mismatch(f"{name} was not written")
    unlisted = set(CODE.findall(done.output + done.errors)) - listed_codes(program)
    if unlisted:
        raise Mismatch(f"codes that dd3imp --help messages does not list: {', '.join(sorted(unlisted))}")
    if expected in (0, 3):
        check_codes(case, check_description(results, expected))


@functools.cache
def listed_codes(program):
    """Return the codes of the messages that the program lists."""
    return set(LISTED.findall(launch([program, "--help", "messages"]).output))


def check_codes(case, found):
    """Check the codes of the messages of a run, given its run.json."""
    given = {message["code"] for name in ("warnings", "notes", "errors") for message in found[name]}
    missing = set(case.get("codes", [])) - given
    if missing:
        raise Mismatch(f"expected the messages {', '.join(sorted(missing))}, got {', '.join(sorted(map(str, given)))}")


@functools.cache
def copied(folder, work):
    """Return a copy of a folder, for runs that would write into it, and the paths in it."""
    copy = work / f"{folder.name}.copy"
    shutil.rmtree(copy, ignore_errors=True)
    shutil.copytree(folder, copy)
    return copy, set(copy.rglob("*"))


def run(case, folder, program, results, arguments, first):
    """Run the case once; return the number of values compared. `first`: the history of the first variant."""
    shutil.rmtree(results, ignore_errors=True)
    results.parent.mkdir(parents=True, exist_ok=True)
    deck, arguments, place = case.get("deck", "case.dat"), [*case.get("arguments", []), *arguments], results.parent
    if case.get("exit_code", 0) in REFUSED:
        place, before = copied(folder, place)
        words = command(program, deck, None, arguments)
    else:
        words = command(program, folder / deck, results, arguments)
    print(" ".join(words), flush=True)
    done = launch(words, timeout=case.get("timeout", SECONDS), folder=place, one_core=False)
    print("\n".join((done.output + done.errors).splitlines()[-40:]))
    check_output(case, done, results, program)
    if place != results.parent and set(place.rglob("*")) != before:
        raise Mismatch(f"files are left: {sorted(set(place.rglob('*')) - before)}")
    compared, path = sum(len(case.get(key, [])) for key in ("contains", "printed", "codes")), results / "history.csv"
    if path.exists():
        history = read_table(path)
        compared += compare_reference(case, folder, history, path) + compare_ends(case, history, path, results)
        compared += compare_elements(case, results) + (compare_variants(case, history, first, path) if first else 0)
        first += history if not first else []
    return compared


def run_variants(path, options):
    """Run the case of a file in all its variants; return what is wrong, nothing if all pass."""
    case, folder, compared = read_case(path), path.parent, 0
    unknown = {key for own in (case, *case.get("variants", [])) if isinstance(own, dict) for key in own} - KNOWN
    if unknown:
        return f"{path.name}: unknown: {', '.join(sorted(unknown))}"
    first = []
    for i, (one, arguments) in enumerate(variants(case)):
        results = options.work.resolve() / (name_of(path) + (f"-{i + 1}" if i else "") + ".out")
        try:
            compared += run(one, folder, options.program, results, arguments, first)
        except (Mismatch, Problem, OSError) as error:
            return f"FAILED {name_of(path)} {' '.join([one.get('deck', ''), *arguments]).strip()}\n{error}"
    if compared == 0:
        return f"FAILED {name_of(path)}: nothing was compared"
    print(f"passed, {compared} values compared")
    return ""


def main():
    """Run the cases."""
    parser = parser_of_runs(__doc__)
    parser.add_argument("case", type=pathlib.Path, nargs="+", help="file of a case, or a folder of cases")
    options = parser.parse_args()
    files = [file for path in options.case for file in (cases(path.resolve()) if path.is_dir() else [path.resolve()])]
    failed = [text for text in (run_variants(path, options) for path in files) if text]
    print(f"{len(files)} cases, {len(failed)} failed")
    sys.exit("\n".join(failed) if failed or not files else 0)


if __name__ == "__main__":
    main()
