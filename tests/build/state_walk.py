#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that the walk over the state names every component that the types of the state declare."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def components(path, type_name):
    """Return the names of the components that a derived type declares."""
    text = path.read_text()
    body = re.search(rf"^  type :: {type_name}\n(.*?)^  (?:contains|end type {type_name})", text, re.M | re.S).group(1)
    names = []
    for line in body.splitlines():
        if "::" in line and not line.lstrip().startswith("!"):
            declared = re.sub(r"\([^()]*\)", "", line.split("::", 1)[1].split("!")[0])
            names += [item.split("=")[0].strip() for item in re.split(r",(?![^(]*\))", declared)]
    return names


def visited():
    """Return the components that the walk hands to a visitor, as `variable%component`."""
    text = re.sub(r"&\s*\n\s*", "", (ROOT / "src/model/state_walk.f90").read_text())
    handed = set(re.findall(r"call visitor%\w+\(.*, (\w+%\w+)\)\n", text))
    handed |= set(re.findall(r"call visit_\w+\((?:.*, )?(\w+%\w+), visitor\)\n", text))
    # The closest points are an array of a type: their components are handed over as arrays.
    arrays = set(re.findall(r'call visitor%\w+\(of_points, name//"_(\w+)", (?:3\*)?n_tool, n, \1\)\n', text))
    return handed | {f"hint%{name}" for name in arrays}


def main():
    handed = visited()
    missing = []
    for source, type_name, variable in [("src/model/state.f90", "state_t", "state"),
                                        ("src/model/state.f90", "phase_start_t", "start"),
                                        ("src/tools/closest.f90", "hint_t", "hint")]:
        names = components(ROOT / source, type_name)
        if not names:
            sys.exit(f"error: no components of {type_name} found in {source}")
        missing += [f"{type_name}%{name}" for name in names if f"{variable}%{name}" not in handed]
    if missing:
        sys.exit("error: src/model/state_walk.f90 does not visit " + ", ".join(missing))
    print(f"all {len(handed)} components of the state are visited")


if __name__ == "__main__":
    main()
