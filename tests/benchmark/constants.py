#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure what the constants of the corrector, the step control and the adaptive refinement are worth: each at half and
at twice its value.

    tests/benchmark/constants.py --work build/constants
    tests/benchmark/constants.py --work build/constants --only largest_ratio tool_weight
    tests/benchmark/constants.py --work build/constants --tables refinement

The tables have the changes of iterations and cut-backs (of a refined mesh first of elements and refinements), and the
largest change of a result. docs/reports/constants.md has the conclusions. A copy of the sources, in which the constants
are variables, is built once; each variant is a copy of that program with another number in its data. A run is kept in
the folder of its variant, and not repeated.
"""
import argparse
import re
import struct
import subprocess
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

from dd3.errors import Problem, check
from dd3.errors import run as run_main
from dd3.pages import table
from dd3.run import read_job
from dd3.tables import number, read_table

ROOT = Path(__file__).resolve().parents[2]
# Sources of the constants, by the name of the table.
GROUPS = {"corrector": ("process/newton", "process/norm", "process/equilibrium", "process/tool_balance",
                        "process/limiters", "process/step_control", "process/predictor", "process/phase_end",
                        "process/elimination", "process/open_edges", "process/phase_start"),
          "contact": ("model/contact_layer", "model/rigid_supports", "model/tolerances", "model/terms/drawbead",
                      "model/terms/floating", "model/terms/viscous", "settings/accuracy", "setup/phases",
                      "contact/operator", "system/compliant_contact", "system/mixed_contact"),
          "refinement": ("run/adaptivity", "model/sheet_turn", "model/sheet_compression")}
VALUES = re.compile(r"(\w+) = ([-\d.e]+)(?:_wp)?(?:, |$)")
DECLARATION = re.compile(r"^  (real\(wp\)|integer), parameter :: ([^&\n]*)\n", re.MULTILINE)
FIXED = {"unknown", "n_kept", "chunk", "status_gap", "status_stick", "status_slip"}  # codes, sizes of arrays
DRAW_BENDING = ROOT / "input_files" / "draw_bending" / "draw_bending.dat"
UNLOAD = "*PHASE springback\n  unload = on\n"
BENT = ROOT / "tests" / "parallel" / "bent.dat"
TIP = "*SET tip\n  near = 175 0 0\n*HISTORY tip\n  set = tip\n  quantities = displacement\n"
FACTORS = {"half": 0.5, "twice": 2.0}


@dataclass
class Constant:
    """A constant of the sources: module, name, kind, value and the sentence that says what it is."""

    module: str
    name: str
    whole: bool
    value: float
    meaning: str

    def varied(self, factor):
        """Return the value times a factor; a whole number changes by one at least, and is not below 1."""
        if not self.whole:
            return self.value * factor
        return max(1, round(self.value * factor)) if self.value > 1 else int(self.value + (factor > 1))


def meaning_before(text, position):
    """Return the first sentence of the comment that ends at a position; empty if none does."""
    lines = []
    for line in reversed(text[:position].splitlines()):
        if not line.startswith("  !> "):
            break
        lines.insert(0, line[5:])
    return re.split(r"(?<=[.;:]) ", " ".join(lines))[0].rstrip(".:;")


def make_variable(path, module):
    """Turn the constants of a source into public variables; return them with the text."""
    text, found, meaning = path.read_text(encoding="utf-8"), [], ""

    def replace(match):
        nonlocal meaning
        kind, body = match.groups()
        values = VALUES.findall(body)
        meaning = meaning_before(text, match.start()) or meaning
        if VALUES.sub("", body) or {name for name, _ in values} & FIXED:
            return match.group()
        found.extend(Constant(module, name, kind == "integer", float(value), meaning) for name, value in values)
        return f"  {kind}, public :: {body}\n"

    def strip(match):
        names = [name.strip() for name in re.sub(r"&\s*\n\s*", "", match.group(1)).split(",")]
        left = [name for name in names if name not in {one.name for one in found}]
        return "  public :: " + ", &\n      ".join(left) + "\n" if left else ""

    changed = DECLARATION.sub(replace, text)
    changed = re.sub(r"^  public :: ((?:[^\n]*&\n)*[^\n]*)\n", lambda m: strip(m) if "=" not in m[1] else m[0], changed,
                     flags=re.MULTILINE)
    return changed, found


def build(work):
    """Copy the sources, make the constants variables and build the program; return it with the constants."""
    source, constants = work / "source", []
    listed = subprocess.run(["git", "-C", str(ROOT), "ls-files", "src", "cmake", "CMakeLists.txt", "docs", "utils",
                             "tests", "LICENSE", "README.md"], capture_output=True, text=True, check=True).stdout
    for name in listed.splitlines():
        content = (ROOT / name).read_bytes()
        part = name.removeprefix("src/").removesuffix(".f90")
        if part in chain(*GROUPS.values()):
            text, found = make_variable(ROOT / name, "dd3_" + part.replace("/", "_"))
            content, constants = text.encode(), constants + found
        target = source / name
        if not target.exists() or target.read_bytes() != content:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
    folder = source / "build" / "release"
    for command in (["cmake", "-S", str(source), "-B", str(folder), "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release"],
                    ["cmake", "--build", str(folder), "--target", "dd3imp", "-j2"]):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        check(done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:])
    return folder / "dd3imp", constants


def variant(program, constant, value, target):
    """Write the program with another value of a constant."""
    content = bytearray(program.read_bytes())
    symbol = f"__{constant.module}_MOD_{constant.name}"
    lines = subprocess.run(["nm", str(program)], capture_output=True, text=True, check=True).stdout.splitlines()
    address = next((int(line.split()[0], 16) for line in lines if line.endswith(" " + symbol)), None)
    check(address is not None, f"{program}: no symbol {symbol}")
    sections = subprocess.run(["readelf", "-SW", str(program)], capture_output=True, text=True, check=True).stdout
    start, offset = (int(part, 16) for part in re.search(r" \.data +PROGBITS +(\w+) (\w+)", sections).groups())
    code, old = ("<i", int(constant.value)) if constant.whole else ("<d", constant.value)
    place = address - start + offset
    check(struct.unpack_from(code, content, place)[0] == old, f"{program}: {symbol} is not {old}")
    struct.pack_into(code, content, place, value)
    target.write_bytes(content)
    target.chmod(0o755)


def cases():
    """Return deck, parameters and observed columns of each case on a uniform mesh."""
    bending = DRAW_BENDING.read_text(encoding="utf-8").replace('patches = "', f'patches = "{DRAW_BENDING.parent}/')
    released = bending.replace(UNLOAD, UNLOAD + TIP)
    mixed = bending.replace(UNLOAD, TIP).replace("*CONTACT\n", "*CONTACT\n  formulation = mixed\n")
    exact = bending.replace(UNLOAD, TIP) + "*NEWTON\n  tolerance = 1e-4\n"
    cup = ROOT / "input_files" / "square_cup" / "square_cup.dat"
    square = cup.read_text(encoding="utf-8").replace("*INCLUDE ..", f"*INCLUDE {cup.parent.parent}") \
        .replace("tools = .", f"tools = {cup.parent}")
    strip = {"divisions": "60 1 1", "points": "5", "depth": "6"}
    return {"released": (released, strip, ("tip_uz",)), "mixed": (mixed, {**strip, "depth": "4"}, ("punch_fz",)),
            "exact": (exact, strip, ("punch_fz",)), "cup": (square, CUP, ("punch_fz",))}


def refined_cases():
    """Return deck, parameters and observed columns of each case on a refined mesh."""
    square, _, columns = cases()["cup"]
    bent = BENT.read_text(encoding="utf-8")
    return {"cup": (square, REFINED_CUP, columns), "bent": (bent, {}, ("root_rx", "root_my"))}


CUP = {"divisions": "10 10 1", "levels": "0", "depth": "5"}
REFINED_CUP = {"divisions": "8 8 1", "levels": "2", "depth": "20"}


@dataclass
class Found:
    """Effort, mesh and result of a run."""

    increments: int
    cut_backs: int
    iterations: int
    values: list
    elements: int
    refinements: int


def measure(program, folder, text, parameters, columns):
    """Run a case unless that is done; return what is found, None if it stops."""
    folder.mkdir(parents=True, exist_ok=True)
    log = folder / "stdout"
    if not log.exists():
        (folder / "case.dat").write_text(text, encoding="utf-8")
        settings = [part for name, value in parameters.items() for part in ("--set", f"{name}={value}")]
        try:
            done = subprocess.run([str(program), "--threads", "1", "--output", str(folder / "out"), *settings,
                                   str(folder / "case.dat")], capture_output=True, text=True, timeout=300, check=False)
            log.write_text(done.stdout + done.stderr, encoding="utf-8")
        except subprocess.TimeoutExpired:
            log.write_text("time is up", encoding="utf-8")
    effort = re.search(r"(\d+) increments, (\d+) cut back; (\d+) iterations", log.read_text(encoding="utf-8"))
    if effort is None or "reached the end" not in log.read_text(encoding="utf-8"):
        return None
    history = read_table(folder / "out" / "history.csv")
    return Found(*(int(part) for part in effort.groups()), [number(history[-1], name, folder) for name in columns],
                 int(number(history[-1], "elements", folder)), len(read_job(folder / "out")["refinements"]))


def summary(base, found, counts=("iterations", "cut_backs")):
    """Return counts over all runs against those of the constant as it is, and the largest change of a result."""
    stopped = [name for name, one in found.items() if one is None]
    if stopped:
        return "stops: " + ", ".join(stopped)
    more = [sum(getattr(one, count) - getattr(base[name], count) for name, one in found.items()) for count in counts]
    change = max(abs(new/old - 1) for name, one in found.items() for new, old in zip(one.values, base[name].values))
    return ", ".join([*(f"{one:+d}" for one in more), f"{100*change:.2g} %"]) if any(more) or change else "none"


def refined_summary(base, found):
    """Return such changes with those of the mesh."""
    return summary(base, found, ("elements", "refinements", "iterations", "cut_backs"))


def measured_constants(work, program, constants, runs, summarise):
    """Return a row of the table for each constant, given the runs of a group and what tells their changes."""

    def all_of(folder, executable):
        return {name: measure(executable, folder / name, *case) for name, case in runs.items()}

    base, rows = all_of(work / "base", program), []
    print(base, flush=True)
    if None in base.values():
        raise Problem("a case stops with the constants as they are")
    for constant in constants:
        cells = []
        for label, factor in FACTORS.items():
            folder = work / f"{constant.module}.{constant.name}.{label}"
            folder.mkdir(parents=True, exist_ok=True)
            executable = folder / "dd3imp"
            variant(program, constant, constant.varied(factor), executable)
            cells.append(summarise(base, all_of(folder, executable)))
            executable.unlink()
        place = constant.module.removeprefix("dd3_").replace("model_terms_", "")
        meaning = constant.meaning.replace("|", "\\|")
        rows.append([f"`{place}` `{constant.name}`", f"{constant.value:g}", meaning, *cells])
        print(*rows[-1], sep=" | ", flush=True)
    return rows


def main():
    """Measure the constants."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--work", type=Path, required=True)
    parser.add_argument("--only", nargs="*", help="names of constants")
    parser.add_argument("--tables", nargs="*", choices=GROUPS, default=list(GROUPS), help="these tables")
    arguments = parser.parse_args()
    work = arguments.work.resolve()
    program, constants = build(work)
    if arguments.only:
        constants = [constant for constant in constants if constant.name in arguments.only]
    for name in arguments.tables:
        modules = ["dd3_" + part.replace("/", "_") for part in GROUPS[name]]
        group = [constant for constant in constants if constant.module in modules]
        folder, runs, summarise = (work / "refinement", refined_cases(), refined_summary) if name == "refinement" else (
            work, cases(), summary)
        rows = measured_constants(folder, program, group, runs, summarise)
        print(name, table(["constant", "value", "meaning", *FACTORS], rows), sep="\n\n", end="\n\n")


if __name__ == "__main__":
    run_main(main)
