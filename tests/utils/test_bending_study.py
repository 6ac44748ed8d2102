# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands of the bending study: help, and messages on wrong names, missing files and incomplete results."""

import pytest
from bending_study.__main__ import COMMANDS, NAME, main
from helpers import ROOT, call


@pytest.mark.parametrize("words, said", (
    (("command", "nosuch"), "no case 'nosuch'"), (("case", "nosuch"), "no case 'nosuch'"),
    (("case", "b-1e3", "--program", "nosuch"), "nosuch: no such program"), (("table",), "no case is done"),
    (("table", "--cases", "none.csv"), "none.csv: No such file"), (("report", "page.md"), "results.csv: No such file"),
    (("report", "page.md", "--work", "incomplete"), f"is missing; `{NAME} run`"),
    (("run", "--program", "nosuch"), "nosuch: no such program"), (("run", "--sets"), "--sets: expected one argument"),
    (("run", "--cores", "x"), "--cores: takes a number"), (("tabel",), "did you mean 'table'?")))
def test_messages(tmp_path, words, said):
    """Check the last line."""
    (tmp_path / "incomplete").mkdir()
    (tmp_path / "incomplete" / "results.csv").write_text("case,set,travel,code,seconds,program\na-1e2,fig3,1,3,1,abc\n")
    (tmp_path / "page.md").write_text("no tables\n")
    cases = ["--cases", ROOT / "input_files/bending_study/cases.csv"]
    more = cases if words[0] in ("command", "case", "table") and "--cases" not in words else []
    line = call(*words, *more, expect=2, main=main).strip().splitlines()[-1]
    assert said in line and "error: " in line
    assert not list(tmp_path.glob("*/done.json"))


@pytest.mark.parametrize("words", [(), *((name,) for name in COMMANDS)])
def test_help(words):
    """Check that each command has a help with an example of its own name."""
    assert f"\n    {' '.join((NAME, *words))} " in call(*words, "--help", main=main)
