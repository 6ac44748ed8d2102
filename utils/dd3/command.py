# SPDX-License-Identifier: GPL-3.0-or-later
"""The command dd3: its subcommands, and the parsers of their options."""

import argparse
import difflib
import os
import sys
from collections.abc import Sequence
from importlib import import_module

from dd3.errors import Problem, run

ANY = "<file>"  # stands for the words that are no command of a group
# Name: module and summary. A group has the summary, an example and the table of its own.
COMMANDS = {
    "part": ("dd3.part.command", "read a sheet part: thickness, press direction, undercuts, features"),
    "tool": ("dd3.tool", "make tool surfaces from CAD, STL, a mesh or a profile"),
    "import": ("dd3.dyna.command", "import a forming deck of LS-DYNA"),
    "dynain": ("dd3.dynain", "take over a formed sheet of LS-DYNA for *START"),
    "mesh": ("dd3.mesh", "bring a mesh of hexahedra into the form that *MESH reads"),
    "curve": ("dd3.curve", "write closed curves of a CAD file for *TRIM"),
    "unfold": ("dd3.unfold", "estimate the flat blank of a part in one step"),
    "process": ("dd3.process", "run the operations of a part one after another"),
    "compensate": ("dd3.compensate", "correct the tools of a process for springback"),
    "deviation": ("dd3.deviation", "compare a part with its nominal shape, free or in its checking fixture"),
    "outline": ("dd3.outline", "find the outline of the blank that gives a wanted rim"),
    "report": ("dd3.report", "make a page about a forming run"),
    "view": ("dd3.view", "open the page of a run in the browser, or the sheet in a window"),
    "watch": ("dd3.watch", "watch a run in progress in the terminal"),
    "plot": ("draw results, materials, or the sheet before a run", "dd3 plot force bending.out", {
        "force": ("dd3.plot.force", "tool force against tool displacement"),
        "increments": ("dd3.plot.increments", "size of the increments and what limits it"),
        "sheet": ("dd3.plot.sheet", "deformed sheet between its tools, coloured by a field"),
        "point": ("dd3.plot.point", "response of materials at a point: curves, r-values, yield surfaces"),
    }),
    "section": ("dd3.section", "write and draw fields along a section; measure springback"),
    "flc": ("dd3.flc", "compute the forming limit curve of a material"),
    "bead": ("dd3.bead", "compute restraint and uplift of a draw-bead from its geometry"),
    "fld": ("dd3.forming_limit_diagram", "draw the forming limit diagram of a run"),
    "export": ("dd3.export", "write the drawn sheet as a mesh, for ParaView, or for LS-DYNA; materials for LS-DYNA"),
    "identify": ("dd3.identify.command", "identify a yield criterion, with a hardening law, from measured values"),
    "fit": ("dd3.identify.fit", "fit a hardening law to a tension curve"),
    "study": ("vary parameters of an input file", "dd3 study job.dat --vary friction=0.1,0.14", {
        ANY: ("dd3.study.vary", "vary parameters of this input file, with a table and pictures of results"),
        "combination": ("dd3.study.vary:run_combination", "run one of these combinations in the folder of the study"),
    }),
    "scatter": ("dd3.scatter.command", "run a sample of scattered inputs: bands, probability of failure, indices"),
    "window": ("dd3.window", "draw where splits and wrinkles begin over two parameters"),
    "press": ("dd3.press", "compare force and work of the tools with a press; its stroke as a table"),
    "example": ("dd3.example", "copy an example, or list the examples"),
    "completion": ("dd3.completion", "print a script that completes commands and options in a shell"),
    "info": ("dd3.info", "print what is installed: versions, program, examples, Python packages"),
}
USAGE = "dd3 plot force bending.out"


def new_parser(name: str, text: str | None, command: str = "dd3") -> argparse.ArgumentParser:
    """Return the parser of a subcommand; `text` describes it, with examples."""
    return argparse.ArgumentParser(f"{command} {name}", description=text,
                                   formatter_class=argparse.RawDescriptionHelpFormatter)


def overview(name: str, summary: str, example: str, table: dict) -> str:
    """Return the help of a group of commands."""
    rows = "\n".join(f"  {key:<12} {row[1] if isinstance(row[-1], str) else row[0]}" for key, row in table.items())
    return (f"usage: {name} COMMAND ...\n\n{summary[:1].upper() + summary[1:]}.\n\n{rows}\n\n"
            f"`{name} COMMAND --help` explains each. Example:\n\n    {example}")


def dispatch(words: Sequence[str], name: str = "dd3", summary: str = "Tools for dd3imp", example: str = USAGE,
             table: dict = COMMANDS) -> None:
    """Call the command that the words name."""
    first, *others = words or [""]
    if first in ("-h", "--help"):
        print(overview(name, summary, example, table))
    elif first == "--version" and table is COMMANDS:
        from dd3 import __version__
        print(f"dd3 {__version__}")
    elif first not in table and ANY in table and (first.startswith("-") or "." in first):
        dispatch([ANY, *words], name, summary, example, table)
    elif first not in table:
        near = difflib.get_close_matches(first, table, 1)
        said = f"no command '{first}'" if first else "a command is missing"
        raise Problem(f"{name}: {said}; " + (f"did you mean '{near[0]}'?" if near else f"expected {', '.join(table)}"))
    elif isinstance(table[first][-1], dict):
        dispatch(others, f"{name} {first}", *table[first])
    else:
        module, _, function = table[first][0].partition(":")
        getattr(import_module(module), function or "main")(others)


def main(words: Sequence[str] | None = None) -> None:
    """Run the command of the words, by default those of the command line, with one thread of OpenBLAS: beside other
    runs its threads wait for each other in small systems of equations."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read when scipy loads its own
    run(lambda: dispatch(sys.argv[1:] if words is None else words))
