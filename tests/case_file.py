#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the files of tests/ say about themselves, and the CTest tests that follow from it.

    case_file.py tests.cmake

writes the tests as commands of CMake; tests/CMakeLists.txt calls it. Comment lines of a file, in any place, are

    #: {"last": {"punch_fz": [10, 0.1]}}    JSON, over several lines if need be
    #| travel,punch_fz                      a row of the table of reference values, of a deck
    #> error E133                           text that the program must print, in the order of the lines, of a deck

- A deck in cases/ with such lines is a case, `case_<name>`, with the keys of run_case.py; so is a file of JSON, for a
  deck elsewhere. The name is that of the folder if the file is case.dat or case.json.
- The decks in bad_input/ are together the test `bad_input`; those that cannot have comments are in its file of JSON.
- A script is a test for each of its objects, with the keys `name` (default: the file's), `arguments`, `labels`,
  `timeout`, `cost` and `processors`. It is called with --program and --work, a folder; with the label `petsc` only in
  a build with PETSc. `#: []` is a script that is called by hand.

Every deck of cases/ and bad_input/ is a case or is named in a file beside it, and every script with an option
`--program`, but for those of benchmark/, build/ and utils/, says what it is; a file that does not is an error.

Tests with the label `slow`, but for those of several processes, are divided into parts by labels `part_0`, `part_1`,
...; utils/run_tests.sh runs one of them, chosen by the commit. `cost` is their time in seconds beside another test, by
default `timeout`.
"""
import json
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
BAD = HERE / "bad_input"
SECONDS = 300  # default of `timeout`
BUDGET = 300  # seconds of a part of the slow tests
OF_CMAKE = 250  # seconds of the slow tests that CMake files of tests/ declare, in the first part
OTHERS = ("benchmark", "build", "utils", HERE.name)  # folders of scripts that say nothing


class Unlisted(Exception):
    """A file does not say what it is."""


def lines(path, mark):
    """Return the comment lines of a file with a mark, without it."""
    text = path.read_bytes().decode("utf-8", "replace")
    return [line[2:].removeprefix(" ") for line in text.splitlines() if line.startswith(mark)]


def objects(path):
    """Return the JSON values of a file: of its comment lines, or of the whole file."""
    text = path.read_text(encoding="utf-8") if path.suffix == ".json" else "\n".join(lines(path, "#:"))
    found, text = [], text.strip()
    while text:
        value, end = json.JSONDecoder().raw_decode(text)
        found.append(value)
        text = text[end:].lstrip()
    return found


def is_case(path):
    """Whether a deck has lines that say what is expected; a file of JSON has."""
    return path.suffix == ".json" or bool(lines(path, "#:") + lines(path, "#>"))


def read_case(path):
    """Return the case of a deck or of a file of JSON; the texts and the table of comment lines are keys of it."""
    case = dict(objects(path)[0]) if objects(path) else {}
    if path.suffix != ".json":
        case = {"deck": path.name, **case, "printed": lines(path, "#>"), "rows": lines(path, "#|")}
    if path.parent.name == BAD.name:
        case = {"exit_code": 2, "timeout": 60, **case}
    return case


def cases(folder):
    """Return the files of a folder that are cases, in order."""
    files = sorted(path for path in folder.rglob("*") if path.suffix in (".dat", ".json") and path.is_file())
    found = [path for path in files if is_case(path)]
    for path in set(files) - set(found):
        beside = [other for other in files if other.parent == path.parent and other != path]
        if not any(other.name == "case.json" or path.name.encode() in other.read_bytes() for other in beside):
            raise Unlisted(f"{path}: neither a case nor named in a file beside it")
    return found


def name_of(path):
    """Return the name of a case."""
    return path.parent.name if path.stem == "case" else path.stem


def scripts():
    """Yield the scripts that are tests, each with an object."""
    for path in sorted(HERE.rglob("*.py")):
        found = objects(path)
        runs = "--program" in path.read_text(encoding="utf-8") and path.parent.name not in OTHERS
        if runs and not found:
            raise Unlisted(f"{path}: a script without a line `#: {{...}}`; `#: []` if it is no test")
        for value in found:
            if value != []:
                yield path, value


def parts(found):
    """Return the part of each slow test: the tests in turn, as many in a part as the budget allows."""
    own, part, used = {}, 0, OF_CMAKE
    for name, _, labels, keys in found:
        if "slow" not in labels or "petsc" in labels:
            continue
        cost = keys.get("cost", min(BUDGET, keys.get("timeout", SECONDS)))
        if cost > BUDGET:
            raise Unlisted(f"{name}: the cost of a slow test is at most {BUDGET} s, got {cost}: divide it")
        part, used = (part + 1, cost) if used + cost > BUDGET else (part, used + cost)
        own[name] = f"part_{part}"
    return own


def declare(name, words, labels, keys):
    """Return the commands of CMake that add a test."""
    properties = {"LABELS": ";".join(labels), "TIMEOUT": keys.get("timeout", SECONDS), "SKIP_RETURN_CODE": 77,
                  "COST": keys.get("cost", 0), "PROCESSORS": keys.get("processors", 1)}
    text = " ".join(f'{key} "{value}"' for key, value in properties.items())
    added = (f'add_test(NAME {name} COMMAND "${{python}}" {" ".join(json.dumps(str(word)) for word in words)})\n'
             f"set_tests_properties({name} PROPERTIES {text})\n")
    return f"if(DD3_PETSC)\n{added}endif()\n" if "petsc" in labels else added


def tests():
    """Yield name, command, labels and further keys of each test."""
    runner, program, work = HERE / "run_case.py", ["--program", "$<TARGET_FILE:dd3imp>"], "${CMAKE_CURRENT_BINARY_DIR}"
    for path in cases(HERE / "cases"):
        case = read_case(path)
        keys = {**case, "timeout": case.get("timeout", SECONDS) * max(1, len(case.get("variants", [])))}
        yield (f"case_{name_of(path)}", [runner, *program, "--work", f"{work}/cases", path],
               ["case", *case.get("labels", [])], keys)
    cases(BAD)  # an error if one of them says nothing
    yield BAD.name, [runner, *program, "--work", work, BAD], ["case", "debug"], {}
    for path, keys in scripts():
        name = keys.get("name", path.stem)
        words = [path, *program, "--work", f"{work}/{name}", *keys.get("arguments", [])]
        yield name, words, keys.get("labels", ["case"]), keys


def declarations():
    """Return the commands of CMake of all tests."""
    found = list(tests())
    own = parts(found)
    return [declare(name, words, [*labels, own[name]] if name in own else labels, keys)
            for name, words, labels, keys in found]


def main():
    """Write the commands of CMake."""
    try:
        pathlib.Path(sys.argv[1]).write_text("".join(declarations()), encoding="utf-8")
    except (Unlisted, ValueError) as error:
        sys.exit(f"error: {error}")


if __name__ == "__main__":
    main()
