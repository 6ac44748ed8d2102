# SPDX-License-Identifier: GPL-3.0-or-later
"""The bending study of docs/reports/bending_study.md: `python3 -m bending_study`."""

import sys
from collections.abc import Sequence

from dd3.command import dispatch
from dd3.errors import run

NAME = "python3 -m bending_study"
COMMANDS = {
    "run": ("bending_study.run", "run all cases, gather the table and draw the figures"),
    "command": ("bending_study.cases:print_command", "print the command of a case"),
    "case": ("bending_study.cases:run_case", "run a case unless it is done"),
    "table": ("bending_study.cases:gather", "gather the finished cases in results.csv"),
    "figures": ("bending_study.figures", "draw the figures from results.csv"),
    "report": ("bending_study.tables", "rewrite the tables of the document from results.csv"),
}


def main(words: Sequence[str] | None = None) -> None:
    """Run the command of the words, by default those of the command line."""
    run(lambda: dispatch(sys.argv[1:] if words is None else words, NAME, "the bending study", f"{NAME} run --quick",
                         COMMANDS))


if __name__ == "__main__":
    main()
