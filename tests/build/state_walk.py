#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that the walks over the state and its terms name every component that their types declare."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
FIXED = {"drawbeads_t": ["point", "force_before", "path_before", "load_before", "total_before"],
         "floating_t": ["support"], "viscous_t": ["coefficient", "before"]}  # set at the start of each increment or attempt


def components(path, type_name):
    """Return the names of the components that a derived type declares."""
    text = path.read_text()
    body = re.search(rf"^  type(?:, extends\(\w+\))? :: {type_name}\n(.*?)^  (?:contains|end type {type_name})", text,
                     re.M | re.S).group(1)
    names = []
    for line in body.splitlines():
        if "::" in line and not line.lstrip().startswith("!"):
            declared = re.sub(r"\([^()]*\)", "", line.split("::", 1)[1].split("!")[0])
            names += [item.split("=")[0].strip() for item in re.split(r",(?![^(]*\))", declared)]
    return names


def visited(path):
    """Return the components that a walk hands to a visitor, as `variable%component`."""
    text = re.sub(r"&\s*\n\s*", "", path.read_text())
    handed = set(re.findall(r"call visitor%\w+\(.*, (\w+%\w+)\)\n", text))
    handed |= set(re.findall(r"call visit_\w+\((?:.*, )?(\w+%\w+), visitor\)\n", text))
    handed |= set(re.findall(r"call (\w+%\w+)%walk\(visitor\)\n", text))
    # The closest points are an array of a type: their components are handed over as arrays.
    arrays = set(re.findall(r'call visitor%\w+\(of_points, name//"_(\w+)", (?:3\*)?n_tool, n, \1\)\n', text))
    return handed | {f"hint%{name}" for name in arrays}


def main():
    walk = ROOT / "src/model/state_walk.f90"
    types = [(walk, "src/model/configuration.f90", "configuration_t", "state"),
             (walk, "src/model/configuration.f90", "phase_start_t", "start"),
             (ROOT / "src/model/contact_state.f90", "src/tools/closest.f90", "hint_t", "hint")]
    parts = [ROOT / f"src/model/{name}.f90" for name in
             ("sheet_state", "contact_state", "tools_state", "observations", "work_state")]
    for paths, declared in ((parts, "type ::"), ((ROOT / "src/model/terms").glob("*.f90"), "type, extends(term_t) ::")):
        for path in sorted(paths):
            for name in re.findall(rf"^  {re.escape(declared)} (\w+_t)$", path.read_text(), re.M):
                types.append((path, path.relative_to(ROOT), name, "self"))
    missing, count = [], 0
    for walk, source, type_name, variable in types:
        names = [name for name in components(ROOT / source, type_name) if name not in FIXED.get(type_name, ())]
        if not names and variable != "self":
            sys.exit(f"error: no components of {type_name} found in {source}")
        handed = visited(walk)
        count += len(names)
        missing += [f"{type_name}%{name}" for name in names if f"{variable}%{name}" not in handed]
    if missing:
        sys.exit("error: the walk over the state does not visit " + ", ".join(missing))
    print(f"all {count} components of the state are visited")


if __name__ == "__main__":
    main()
