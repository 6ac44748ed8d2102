# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of documents and their stamps."""

import runpy
from pathlib import Path

import pytest

from dd3.errors import Problem
from dd3.pages import STAMP, places, put_table, stamp, table

MADE = "*Commit 0123456, 2026-11-25, GCC 12.2.0, 1 thread, free machine.*\n"
TABLE = "| x |\n|---|\n| 1 |\n"


def job(commit, day, threads=1):
    """Return the part of a run.json that a stamp shows."""
    return {"program": {"commit": commit}, "build": {"compiler": "GCC version 12.2.0"}, "machine": {"threads": threads},
            "started": f"2026-11-{day}T04:05:06+00:00"}


def test_stamp(monkeypatch):
    """The stamp has all commits, the date of the last run, and tells other work from the own threads."""
    monkeypatch.setattr("os.getloadavg", lambda: (2.1, 0, 0))
    monkeypatch.setattr("dd3.pages.LOAD", 0.1)
    jobs = [job("0123456789ab+", 25, 2), job("abcdef012345", 24)]
    assert stamp(jobs) == "*Commit abcdef0, 0123456+, 2026-11-25, GCC 12.2.0, 2 threads, free machine.*"
    assert STAMP.fullmatch(stamp(jobs))[1] == "abcdef0, 0123456+"
    assert stamp(jobs[1:]).endswith("GCC 12.2.0, 1 thread, shared machine.*")
    assert STAMP.fullmatch(stamp([job(None, 25)]))


def test_put_table(tmp_path):
    """A table replaces the one of its name, with a stamp."""
    page = tmp_path / "page.md"
    page.write_text("before\n<!-- table: a (b) -->\nold\n<!-- end of table -->\nafter\n", encoding="utf-8")
    for _ in range(2):
        put_table(page, "a (b)", table(["x", "y"], [["1", "2"]]), [job("0123456789ab", 25)])
    put = "<!-- table: a (b) -->\n\n| x | y |\n|---|---|\n| 1 | 2 |\n\n"
    before, _, rest = page.read_text(encoding="utf-8").partition(put)
    found, _, after = rest.partition("\n\n<!-- end of table -->\n")
    assert places(page) == {"a (b)"}
    assert (before, after) == ("before\n", "after\n") and STAMP.fullmatch(found)
    with pytest.raises(Problem, match="no place for the table c"):
        put_table(page, "c", "", [job("0123456789ab", 25)])


def test_missing_stamps():
    """Tables need a stamp, in their block or below them, unless they are said to have no measurement."""
    wrong = runpy.run_path(str(Path(__file__).parents[2] / "utils" / "dev" / "pages.py"))["without_stamp"]
    block = f"<!-- table: a -->\n\n{TABLE}\n%s<!-- end of table -->\n"
    good = f"{block % MADE}\n{TABLE}\n{MADE}\n<!-- no measurement -->\n{TABLE}\n"
    assert wrong(good) == []
    assert wrong(good + TABLE) == ["no stamp below the table | x |"]
    assert wrong(good + block % "") == ["the table a has no stamp"]
    assert wrong("text\n") == ["the page has no stamp"]
