# SPDX-License-Identifier: GPL-3.0-or-later
"""Check of the run.json of a run against its schema, its exit code and its status.csv.

Without the package jsonschema the schema is not used.
"""
import json
import math
import pathlib

from dd3.errors import Problem
from dd3.tables import is_whole, read_table

ROOT = pathlib.Path(__file__).resolve().parents[1]

try:
    import jsonschema
except ModuleNotFoundError:
    jsonschema = None

STATES = {0: ("reached",), 3: ("stopped", "interrupted")}


def read_description(folder):
    """Return the content of run.json; it must obey the schema."""
    path = pathlib.Path(folder) / "run.json"
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise Problem(f"{path}: {error}") from None
    if jsonschema is None:
        return found
    schema = json.loads((ROOT / "docs" / "run.schema.json").read_text(encoding="utf-8"))
    for error in jsonschema.Draft202012Validator(schema).iter_errors(found):
        raise Problem(f"{path}: {'/'.join(map(str, error.absolute_path))}: {error.message[:300]}")
    return found


def check_description(folder, code):
    """Check the run.json of a run that ended with an exit code; return its content."""
    folder = pathlib.Path(folder)
    found = read_description(folder)
    outcome, place = found["outcome"], folder / "run.json"
    if outcome["exit_code"] != code or outcome["state"] not in STATES[code]:
        raise Problem(f"{place}: expected the outcome of exit code {code}, got {outcome}")
    if (code == 3) != bool(found["errors"]):
        raise Problem(f"{place}: exit code {code} and {len(found['errors'])} errors")
    if found["phases"]:
        check_counts(found, folder)
        check_refinements(found, folder)
    return found


def check_refinements(found, folder):
    """Check that the refinements follow one another, and that the last one gives the last number of elements."""
    changes, place = found["refinements"], folder / "run.json"
    for number, change in enumerate(changes):
        if sum(change["elements_of_level"]) != change["elements"] or change["elements"] <= change["elements_before"]:
            raise Problem(f"{place}: refinement {number + 1} has the numbers of elements {change}")
        if number and change["elements_before"] != changes[number - 1]["elements"]:
            raise Problem(f"{place}: refinement {number + 1} does not follow the one before")
    rows = [row for row in read_table(folder / "status.csv") if is_whole(row)] \
        if (folder / "status.csv").exists() else []
    if not rows or found["outcome"]["exit_code"] != 0:
        return
    expected = changes[-1]["elements"] if changes else found["sheet"]["elements"]
    if int(rows[-1]["elements"]) != expected:
        raise Problem(f"{place}: {expected} elements at the end, {rows[-1]['elements']} in status.csv")


def check_counts(found, folder):
    """Compare the counts of the phases with status.csv; after a restart it also has the rows before."""
    place = folder / "run.json"
    ended = [phase["result"]["state"] for phase in found["phases"]]
    if found["outcome"]["state"] == "reached" and not set(ended) <= {"ended", "earlier"}:
        raise Problem(f"{place}: the run reached its end, its phases are {ended}")
    for name in ("increments", "attempts", "cutbacks", "iterations", "solver_iterations"):
        total = sum(phase["result"][name] for phase in found["phases"])
        if total != found["counts"][name]:
            raise Problem(f"{place}: {name} = {found['counts'][name]}, {total} in the phases")
    if not (folder / "status.csv").exists() or found["continued"]:
        return
    rows = [row for row in read_table(folder / "status.csv") if is_whole(row)]
    for phase in found["phases"]:
        own, result = [row for row in rows if row["phase"] == phase["name"]], phase["result"]
        for name, value in (("increments", sum(row["outcome"] == "accepted" for row in own)), ("attempts", len(own)),
                            ("iterations", sum(int(row["iterations"]) for row in own))):
            if result[name] != value:
                raise Problem(f"{place}: {name} of phase {phase['name']} = {result[name]}, {value} in status.csv")
        accepted = [row for row in own if row["outcome"] == "accepted"]
        if accepted and not math.isclose(float(accepted[-1]["travel"]), result["travel"], rel_tol=1e-9, abs_tol=1e-9):
            raise Problem(f"{place}: travel of phase {phase['name']} = {result['travel']}, {accepted[-1]['travel']} "
                          "in status.csv")
        if result["ended_by"] == "progress" and abs(result["progress"] - 1) > 1e-9:
            raise Problem(f"{place}: progress of phase {phase['name']} at its end = {result['progress']}")
        if sum(result["limiters"].values()) != result["increments"]:
            raise Problem(f"{place}: the limiters of phase {phase['name']} do not add up to its increments")
