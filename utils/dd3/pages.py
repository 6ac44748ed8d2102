# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of documents, in Markdown, each with a stamp: by what it was made."""

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from dd3.errors import Problem

LOAD = os.getloadavg()[0]  # of the machine, when the script begins
# A stamp: commits, date, and what else is known.
STAMP = re.compile(r"^\*Commit (\w{7}\+?(?:, \w{7}\+?)*), (\d{4}-\d\d-\d\d), (.+)\.\*$", re.MULTILINE)


def table(heading: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table."""
    head, *lines = ("| " + " | ".join(row) + " |" for row in (heading, *rows))
    return "\n".join([head, "|" + "---|" * len(heading), *lines])


def stamp(jobs: Iterable[Mapping[str, Any]]) -> str:
    """Return the stamp of runs, given the content of their run.json: commits of the program, date of the last run,
    compilers, largest number of threads, and whether other work ran on the machine."""
    jobs = sorted(jobs, key=lambda job: str(job["started"]))
    commits = dict.fromkeys(re.sub(r"^(\w{7})\w*", r"\1", job["program"]["commit"] or "unknown") for job in jobs)
    compilers = dict.fromkeys(job["build"]["compiler"].replace(" version", "") for job in jobs)
    threads = max(job["machine"]["threads"] for job in jobs)
    shared = max(LOAD, os.getloadavg()[0]) > threads + 0.5
    return (f"*Commit {', '.join(commits)}, {jobs[-1]['started'][:10]}, {', '.join(compilers)}, "
            f"{threads} thread{'s' if threads > 1 else ''}, {'shared' if shared else 'free'} machine.*")


def places(document: Path) -> set[str]:
    """Return the names of the tables for which a document has a place."""
    return set(re.findall(r"<!-- table: (.*?) -->", document.read_text(encoding="utf-8")))


def put_table(document: Path, name: str, content: str, jobs: Iterable[Mapping[str, Any]]) -> None:
    """Put a table with the stamp of its runs into a document, between the lines `<!-- table: name -->` and
    `<!-- end of table -->`."""
    text = document.read_text(encoding="utf-8")
    content = f"{content}\n\n{stamp(jobs)}"
    text, count = re.subn(rf"(<!-- table: {re.escape(name)} -->\n).*?(<!-- end of table -->)",
                          lambda found: f"{found[1]}\n{content}\n\n{found[2]}", text, flags=re.DOTALL)
    if count != 1:
        raise Problem(f"{document}: there is no place for the table {name}")
    document.write_text(text, encoding="utf-8")
