# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables, status.csv, blocks of shape files and runs of a stand-in program."""

import fcntl
import json
import stat
import subprocess
import sys
from pathlib import Path

import pytest
from test_study import DECK as BAR

import dd3
from dd3 import programs, tables
from dd3.errors import Problem
from dd3.run import file_of, read_frame
from bending_study import cases
from dd3.tools.blocks import read_blocks

STATUS = """increment,attempt,phase,travel,r,limiter,iterations,criterion,solver_iterations,gap,stick,slip,outcome,\
reason,seconds,limiter_element,limiter_point,limiter_node,limiter_tool,worst_node,worst_residual,\
worst_element,worst_point,solver,r_force,force_node,force_tool,force_size
1,1,clamp,0,1,r_max,2,0.0047,0,18,68,2,accepted,,0.01,,,,,3,2.67E-02,,,cgs,0.5,7,die,3.5
2,1,draw,,,,0,,7,18,68,2,retry,"det F <= 0, twice",0.02,,,,,,,12,3,cgs,,,,
2,2,draw,0.5,0.3,rotation,3,0.0021,5,18,68,2,accepted,,0.02,9,8,,,63,5.34E-03,,,cgs,0.9,125,blank_holder,120.25
3,1,draw,0.9,0.2,force,4,0.0011,6,18,68,2,accepted,,0.02,,,10,punch,61,9.98E-02,,,cgs,0.2,10,punch,80.5
4,1,draw,1.0,0.1,phase,4,0.0011,6,18,68,2,accepted,,0.02,,,,,61,9.98E-02,,,cgs,,,,
"""
HISTORY = """# units: -,-,mm,-,mm,N,-
increment, phase ,travel,progress,punch_uz,punch_fz,punch_contacts
0,clamp,0,0,0,0,0
1,draw,1,0.5,-1,1500,4
2,draw,2,1,-2,2500,4
3,draw,3,1,-2,25
"""
DECK = """*PARAMETER
  shape = punch          # a comment
  Depth = 40
*Include "parts/tools.inc"
*PHASE draw
  move = punch 0 0 &
    -${depth}
  move = die 0 0 0
"""
TOOLS = '*TOOL Punch\n  patches = "${shape}.bez" ! a surface\n*INCLUDE "tools.inc"\n'
PROGRAM = """#!{python}
import sys, time
print("said", *sys.argv[1:])
sys.stderr.write("complained")
time.sleep(20 if "--sleep" in sys.argv else 0)
sys.exit(3)
"""


def refused(text, function, *arguments):
    """Check that a call raises a Problem with a text."""
    with pytest.raises(Problem) as problem:
        function(*arguments)
    assert text in str(problem.value)


def test_tables(tmp_path):
    """Check tables, numbers and interpolation."""
    (tmp_path / "history.csv").write_text(HISTORY)
    rows = tables.read_table(tables.table_file(tmp_path), "phase", "travel")
    assert [row["phase"] for row in rows] == ["clamp", "draw", "draw", "draw"]
    assert [tables.is_whole(row) for row in rows] == [True, True, True, False]
    assert tables.tools_in(rows[0]) == ["punch"] and tables.number(rows[1], "punch_fz", "x") == 1500
    refused("no column 'point'", tables.read_table, tmp_path / "history.csv", "point")
    refused("there is no column die_fz", tables.number, rows[0], "die_fz", "x")
    refused("phase = 'clamp' is not a number", tables.number, rows[0], "phase", "x")
    refused("not the history of single points", tables.read_points, tmp_path)
    refused("none.csv: No such file", tables.read_table, tmp_path / "none.csv")
    assert tables.interpolate([0, 1, 1, 3], [0, 4, 5, 9], 2) == 7 and tables.interpolate([0, 1], [0, 4], 2) is None


def test_frames(tmp_path):
    """Check tables as columns of numbers and texts, with their units; the row that was cut is left out."""
    (tmp_path / "history.csv").write_text(HISTORY)
    (tmp_path / "status.csv").write_text(STATUS)
    history, status = dd3.open(tmp_path).history, read_frame(tmp_path / "status.csv")
    assert list(history["phase"]) == ["clamp", "draw", "draw"] and history["punch_fz"].sum() == 4000
    assert history.attrs["units"]["punch_fz"] == "N"
    assert list(status["force_size"].dropna()) == [3.5, 120.25, 80.5] and status["travel"].isna().sum() == 1
    assert status["reason"][1] == "det F <= 0, twice"


def test_status(tmp_path):
    """Check what is read from status.csv."""
    (tmp_path / "status.csv").write_text(STATUS)
    status = tables.read_table(tmp_path / "status.csv", "force_node", "worst_element")
    assert tables.totals(status) == tables.Totals(increments=4, cutbacks=1, iterations=13, solver_iterations=24)
    assert tables.limiters(status, "draw") == ["rotation", "force", "phase"]
    limits = list(tables.force_limits(status, "draw"))
    assert limits == [(0.5, 125, "blank_holder", 120.25), (0.9, 10, "punch", 80.5)]
    assert status[1]["reason"] == "det F <= 0, twice" and status[1]["worst_element"] == "12"
    assert cases.force_columns(status, 0.0) == {"B_median": "120.2", "flange": "50.00"}


def test_blocks(tmp_path):
    """Check includes, parameters and continued lines."""
    (tmp_path / "parts").mkdir()
    (tmp_path / "job.dat").write_text(DECK)
    (tmp_path / "parts" / "tools.inc").write_text(TOOLS)
    _, tool, phase = read_blocks(tmp_path / "job.dat")
    assert (tool.keyword, tool.name) == ("tool", "Punch")
    assert tool.value("patches") == '"punch.bez"' and tool.value("friction") is None
    assert [" ".join(value.split()) for _, value in phase.values] == ["punch 0 0 -40", "die 0 0 0"]


def test_description(tmp_path):
    """Check run.json: its format, and files that were moved with the results."""
    refused("none: No such folder", dd3.open, "none")
    run = tmp_path / "job.out"
    run.mkdir()
    for text, said in (("no json", "not a description"), ('{"format": "dd3imp run", "format_version": 9}', "version")):
        (run / "run.json").write_text(text)
        refused(said, lambda: dd3.open(run).job)
    job = {"format": "dd3imp run", "format_version": 2, "command": {"working_directory": "/nowhere"}}
    (run / "run.json").write_text(json.dumps(job))
    assert dd3.open(run).job == job
    assert str(file_of(job, run, "tools/die.bez")) == "/nowhere/tools/die.bez"
    (tmp_path / "die.bez").touch()
    assert file_of(job, run, "tools/die.bez") == tmp_path / "die.bez"


def test_runs(tmp_path):
    """Check how a program is found and run."""
    program = tmp_path / "program"
    program.write_text(PROGRAM.format(python=sys.executable))
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    assert programs.find_program(program) == program.resolve()
    refused("no such program; give --program FILE", programs.find_program, tmp_path / "none")
    words = programs.command(program, "job.dat", "out", ["--quiet"], {"p": "1e3"})
    done = programs.launch(words)
    assert (done.code, done.errors) == (3, "complained")
    assert done.output == "said --quiet --output out --set p=1e3 job.dat\n"
    assert done.wall > 0 and done.cpu > 0 and done.memory > 1
    refused("not finished after 1 s", programs.launch, [*words, "--sleep"], 1)
    refused("exit code 0, and no results", programs.run_points, "true", "*POINT p\n")


def test_killed(program):
    """A run that was killed says so; one whose log a program holds goes on."""
    Path("bar.dat").write_text(BAR)
    subprocess.run([program, "--quiet", "bar.dat"], check=True, capture_output=True)
    path = Path("bar.out/run.json")
    job = json.loads(path.read_text())
    assert dd3.open("bar.out").job["outcome"]["state"] == "reached"
    job["outcome"]["state"] = "running"
    path.write_text(json.dumps(job))
    with Path("bar.out/job.log").open("rb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        assert dd3.open("bar.out").job["outcome"]["state"] == "running"
    assert dd3.open("bar.out").job["outcome"]["state"] == "killed"
