#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Check that the walks over the state and its terms hand every component of their types to the visitor.

Types and calls are those of gfortran's parse tree (-fdump-parse-tree): layout, comments and continuation lines of the
source do not matter. That the values come back is checked by tests/unit/model/test_state.pf.
"""
import argparse
import pathlib
import re
import subprocess
import sys
import tempfile

MODEL = pathlib.Path(__file__).resolve().parents[2] / "src" / "model"
PARTS = ("sheet_state", "contact_state", "tools_state", "observations", "work_state")
FIXED = {"drawbeads_t": {"point", "force_before", "path_before", "load_before", "total_before"},
         "floating_t": {"support"}, "viscous_t": {"coefficient", "before"}}  # set at the start of each increment or attempt
COMPONENT = re.compile(r"\w+:\w+(?:\(.*\))? % (\w+)(?:\(FULL\)| % of)?")  # an array, or the object of a term
VARIABLE = re.compile(r"\w+:(\w+)(?:\(.*\))?")


def tree_of(path, compiler, modules):
    """Return the lines of the parse tree of a source file."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([compiler, "-fsyntax-only", "-fdump-parse-tree", "-J", folder,
                               *(f"-I{one}" for one in modules.iterdir() if one.is_dir()), path],
                              capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{path}:\n{done.stderr}")
    return [line.strip() for line in done.stdout.splitlines()]


def types_of(tree):
    """Return the components of the derived types of a parse tree, and the names of those that its module defines."""
    components, own, name = {}, set(), ""
    for line in tree:
        if found := re.match(r"symtree: .* symbol: '(\w+)'", line):
            name = found[1]
        elif line.startswith("attributes: (DERIVED"):
            components[name] = []
            if "USE-ASSOC" not in line and not name.startswith("__"):  # gfortran's types of classes
                own.add(name)
        elif (found := re.match(r"\((\w+) \(\w+ .*\)", line)) and name in components:
            components[name].append(found[1])
        elif line.startswith("hash:"):
            name = ""
    return components, own


def arguments_of(call):
    """Return the arguments of a CALL, without their brackets."""
    found, depth, start = [], 0, 0
    for i, letter in enumerate(call):
        depth += (letter == "(") - (letter == ")")
        if letter == "(" and depth == 2:
            start = i + 1
        elif letter == ")" and depth == 1:
            found.append(call[start:i])
    return found


def handed_over(tree):
    """Return the components that are arguments of calls with the visitor, or are copied to arrays that are."""
    whole, arrays, copies = set(), set(), []
    for line in tree:
        if line.startswith("CALL "):
            arguments = arguments_of(line)
            if any(argument.endswith(":visitor") for argument in arguments):
                whole |= {found[1] for argument in arguments if (found := COMPONENT.fullmatch(argument))}
                arrays |= {found[1] for argument in arguments if (found := VARIABLE.fullmatch(argument))}
        elif found := re.match(r"ASSIGN \w+:(\w+)\(.*% (\w+)(?:\(FULL\))?$", line):
            copies.append(found.groups())
    return whole | {component for array, component in copies if array in arrays}


def main():
    """Compare the types with the walks."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--compiler", required=True)
    parser.add_argument("--modules", required=True, type=pathlib.Path, help="folder of the folders of .mod files")
    options = parser.parse_args()
    terms = sorted((MODEL / "terms").glob("*.f90"))
    missing, count = [], 0
    for path in (MODEL / "state_walk.f90", *(MODEL / f"{name}.f90" for name in PARTS), *terms):
        tree = tree_of(path, options.compiler, options.modules)
        components, own = types_of(tree)
        if path in terms:
            own = {name for name in own if components[name][:1] == ["term_t"]}
        elif path.stem == "state_walk":
            own = {"configuration_t", "phase_start_t"}
        elif path.stem == "contact_state":
            own |= {"hint_t"}
        handed = handed_over(tree)
        for name in sorted(own):
            sought = [one for one in components[name] if one != "term_t" and one not in FIXED.get(name, ())]
            count += len(sought)
            missing += [f"{name}%{one}" for one in sought if one not in handed]
    if missing:
        sys.exit("error: the walk over the state does not visit " + ", ".join(missing))
    if count < 80:
        sys.exit(f"error: only {count} components were found in the compiler's parse tree")
    print(f"all {count} components of the state are visited")


if __name__ == "__main__":
    main()
