# SPDX-License-Identifier: GPL-3.0-or-later
"""Input files as objects: read, changed, written; what is not changed stays as it is."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
from helpers import ROOT

import dd3
from dd3 import deck
from dd3.tools.blocks import read_blocks

TEXT = """# A strip
*TITLE
  strip, 2 mm    # a comment
*PARAMETER
  depth = 40     # mm
  tools = .

! the sheet
*BLANK strip
  divisions = 4 2 1
  grading_x = 0 0.2 &   # from the left
     0.5 0.7 1
  material=Steel
*PHASE draw
  move = punch 0 0 -${depth}
  move = holder 0 0 -1
*PHASE Free
  unload = on
*TOOL punch
  patches = "${tools}/punch.bez"
"""
HEADS = ("*TITLE # a\n  it's \"drawn # trimmed\" &\n  5 & 6 = 11\t! sum\n  last &\n\t*PARAMETER\n  y = 300\n"
         "*BLANK\ts\n  size = 10 4 1\n  divisions = 2 &  # x\n    2 1\n  material = \"steel\"\n"
         "*MATERIAL\t\"steel\"   # ours\n  young = 2.1d5\n  poisson = 0.3\n  yield = von_mises\n"
         "  hardening = perfect Y0=${y}\n*Boundary &\n 'x'\n  set = x_min\n  fix = x y z\n"
         "*PHASE\tdraw\n  control\t=\tload\n  trial = 1\n  displace = x_max x 0.01\n")


def test_unchanged():
    """Check that a file that is read and written is the same, each byte of it."""
    for path in sorted((ROOT / "input_files").glob("*/*.dat")):
        job = deck.read(path)
        assert str(job).encode("utf-8", "surrogateescape") == path.read_bytes() and not job.changed, path
    data = TEXT.replace("\n", "\r\n").encode() + b"# \xfcber"
    (path := Path("a.dat")).write_bytes(data)
    deck.read(path).write("b.dat")
    assert Path("b.dat").read_bytes() == data + b"\n"


def test_values(tmp_path):
    """Check that values are read and changed in place."""
    (tmp_path / "a.dat").write_text(TEXT)
    job = deck.read("a.dat")
    assert [block.keyword for block in job] == ["TITLE", "PARAMETER", "BLANK", "PHASE", "PHASE", "TOOL"]
    assert job["title"].text == "strip, 2 mm" and job["blank"]["Material"] == "Steel" and "LIMITS" not in job
    assert job["BLANK"].numbers("grading_x") == [0, 0.2, 0.5, 0.7, 1] and list(job["PHASE", "free"]) == ["unload"]
    assert job["PHASE", "draw"].all("move") == ["punch 0 0 -${depth}", "holder 0 0 -1"] and not job.changed
    job.parameters["depth"] = 37.5
    job["BLANK"]["grading_x"] = np.linspace(0, 1, 5)
    job["BLANK"]["skew"] = 0.1
    job["PHASE", "draw"].set_all("move", ["punch 0 0 -1"])
    job["PHASE", "free"]["unload"] = False
    job["TITLE"].text = "shorter"
    assert job.blocks.index(job["TOOL"]) == 5
    job.add("MATERIAL", "steel", young=2.1e5, poisson=0.3)
    job.remove(job["TOOL"])
    job.add("TOOL", "die", patches="die.bez")
    job.write("b.dat")
    assert (tmp_path / "b.dat").read_text() == """# A strip
*TITLE
  shorter
*PARAMETER
  depth = 37.5   # mm
  tools = .

! the sheet
*BLANK strip
  divisions = 4 2 1
  grading_x = 0 0.25 0.5 0.75 1 # from the left
  material=Steel
  skew = 0.1
*PHASE draw
  move = punch 0 0 -1
*PHASE Free
  unload = off
*MATERIAL steel
  young = 210000
  poisson = 0.3

*TOOL die
  patches = die.bez
""", (tmp_path / "b.dat").read_text()
    assert job.path.name == "b.dat" and not job.changed


def test_marks_of_comments_in_quotes(tmp_path):
    """Check that # and ! inside quotes begin no comment, as in the program, and that other quotes hide none."""
    (tmp_path / "a.dat").write_text("*MESH m\n  file = \"a#b.inp\" # c 'd'\n  material = punch's ! it's\n")
    job = deck.read("a.dat")
    assert job["MESH"]["file"] == '"a#b.inp"' and job["MESH"]["material"] == "punch's"
    job["MESH"]["file"] = '"n!.inp"'
    assert str(job).splitlines()[1] == "  file = \"n!.inp\"  # c 'd'"


def test_errors(tmp_path):
    """Check that errors name file and line, and say what there is."""
    (tmp_path / "a.dat").write_text(TEXT)
    (tmp_path / "punch.bez").write_text("")
    job = deck.read("a.dat")
    for act, said in ((lambda: job["MATERIAL"], "a.dat: error: no block *MATERIAL; there are: *TITLE, *PARAMETER"),
                      (lambda: job["PHASE"], "a.dat:17: error: 2 blocks *PHASE; give a name: draw, Free"),
                      (lambda: job["PHASE", "x"], "no block *PHASE x"),
                      (lambda: job["BLANK"]["size"], "a.dat:9: error: no key 'size' in *BLANK strip; there are: div"),
                      (lambda: job["PHASE", "draw"]["move"], "2 values of 'move' in *PHASE; take all('move')"),
                      (lambda: job["PHASE", "draw"].update(move="x"), "a.dat:16: error: 'move' is given 2 times"),
                      (lambda: job["BLANK"].numbers("material"), "a.dat:13: error: 'Steel' of 'material'"),
                      (lambda: deck.Deck("x = 1\n"), "input:1: error: 'x = 1' belongs to no block"),
                      (lambda: deck.read("no.dat"), "no.dat: No such file")):
        with pytest.raises(dd3.Problem) as problem:
            act()
        assert said in str(problem.value), problem.value
    assert job["BLANK"].get("size") is None
    (tmp_path / "other").mkdir()
    with pytest.raises(dd3.Problem, match=r"a.dat:20: error: './punch.bez' is relative to this file"):
        job.write("other/a.dat")
    (tmp_path / "other" / "punch.bez").write_text("")
    job.write("other/a.dat")


def test_heads_and_titles(tmp_path):
    """Check that heads of blocks and lines of a title are read as by the program, and written as they are."""
    (tmp_path / "a.dat").write_text(HEADS)
    job = deck.read("a.dat")
    assert [(block.keyword, block.name) for block in job] == [
        ("TITLE", ""), ("PARAMETER", ""), ("BLANK", "s"), ("MATERIAL", "steel"), ("Boundary", "x"),
        ("PHASE", "draw")]
    assert job["TITLE"].text == "it's \"drawn\n5 & 6 = 11\nlast &" and job.parameters["y"] == "300"
    assert job["PHASE", "Draw"]["control"] == "load" and job["MATERIAL", "steel"].numbers("young") == [2.1e5]
    assert job["BLANK"].numbers("divisions") == [2, 2, 1] and str(job) == HEADS and not job.changed
    job["PHASE", "draw"]["trial"] = 0.5
    job["TITLE"].text = "all &\nnew &"
    changed = str(job)
    kept = HEADS[HEADS.index("\t*PARAM"):].replace("trial = 1", "trial = 0.5")
    assert changed == "*TITLE # a\n  all &\n  new &\n" + kept
    assert deck.Deck(changed)["TITLE"].text == job["TITLE"].text
    assert [(block.keyword, block.name) for block in read_blocks("a.dat")] == [
        (block.keyword.lower(), block.name) for block in job]


def test_heads_by_program(program, tmp_path):
    """Check that the program takes the names and the title of the same file."""
    (tmp_path / "a.dat").write_text(HEADS)
    done = subprocess.run([program, "--check", "a.dat"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    for line in deck.read("a.dat")["TITLE"].text.splitlines():
        assert line in done.stdout, done.stdout
