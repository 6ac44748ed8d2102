"""Check utils/results.py on small files: tables, status.csv, input files, and runs of a stand-in program."""

import stat
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "utils"))
import results  # noqa: E402
import study  # noqa: E402
from scripts import Problem  # noqa: E402

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
LOG = """1 increments, 0 cut back
time by section, s:
  material      2.658
  solve         0.2082
reached the end; results in x
"""
ECHO = """dd3imp 0.1.0: job.dat
*TOOL Punch
  patches = "die.bez"                               # a surface
*PHASE draw
linear solver: umfpack
*** no part of the input
"""
PROGRAM = """#!{python}
import sys, time
print("said", *sys.argv[1:])
sys.stderr.write("complained")
time.sleep(20 if "--sleep" in sys.argv else 0)
sys.exit(3)
"""


def refused(text, function, *arguments):
    """Check that a call raises a Problem with a text."""
    try:
        function(*arguments)
    except Problem as problem:
        assert text in str(problem), problem
    else:
        raise AssertionError(f"not refused: {text}")


def check_tables(folder):
    """Check tables, numbers and interpolation."""
    (folder / "history.csv").write_text(HISTORY)
    rows = results.read_table(results.history_file(folder), "phase", "travel")
    assert [row["phase"] for row in rows] == ["clamp", "draw", "draw", "draw"]
    assert [results.is_whole(row) for row in rows] == [True, True, True, False]
    assert results.tools_in(rows[0]) == ["punch"] and results.number(rows[1], "punch_fz", "x") == 1500
    refused("no column 'point'", results.read_table, folder / "history.csv", "point")
    refused("there is no column die_fz", results.number, rows[0], "die_fz", "x")
    refused("phase = 'clamp' is not a number", results.number, rows[0], "phase", "x")
    refused("not the history of single points", results.read_points, folder)
    refused("none.csv: No such file", results.read_table, folder / "none.csv")
    assert results.interpolate([0, 1, 1, 3], [0, 4, 5, 9], 2) == 7 and results.interpolate([0, 1], [0, 4], 2) is None
    (folder / "job.log").write_text(LOG)
    assert results.time_by_section(folder, ["material", "output"]) == {"material": 2.658, "output": 0}


def check_status(folder):
    """Check what is read from status.csv."""
    (folder / "status.csv").write_text(STATUS)
    status = results.read_table(folder / "status.csv", "force_node", "worst_element")
    assert results.totals(status) == results.Totals(increments=4, cutbacks=1, iterations=13, solver_iterations=24)
    assert results.limiters(status, "draw") == ["rotation", "force", "phase"]
    limits = list(results.force_limits(status, "draw"))
    assert limits == [(0.5, 125, "blank_holder", 120.25), (0.9, 10, "punch", 80.5)], limits
    assert status[1]["reason"] == "det F <= 0, twice" and status[1]["worst_element"] == "12"
    assert study.force_columns(status, 0.0) == {"B_median": "120.2", "flange": "50.00"}


def check_deck(folder):
    """Check includes, parameters and continued lines."""
    (folder / "parts").mkdir()
    (folder / "job.dat").write_text(DECK)
    (folder / "parts" / "tools.inc").write_text(TOOLS)
    _, tool, _ = results.read_deck(folder / "job.dat", {"Shape": "die"})
    assert tool.value("patches") == '"die.bez"', tool
    heading, values = results.echo_in(ECHO)
    assert heading == ["dd3imp 0.1.0: job.dat"] and len(values) == 3, (heading, values)
    tool, phase = results.read_echo(ECHO, folder)
    assert tool.value("patches") == '"die.bez"' and phase.name == "draw" and not phase.values, (tool, phase)
    _, tool, phase = results.read_deck(folder / "job.dat")
    assert (tool.keyword, tool.name, tool.folder) == ("tool", "Punch", folder / "parts"), tool
    assert tool.value("patches") == '"punch.bez"' and tool.value("friction") is None
    assert [" ".join(value.split()) for _, value in phase.values] == ["punch 0 0 -40", "die 0 0 0"], phase.values


def check_runs(folder):
    """Check how a program is found and run."""
    program = folder / "program"
    program.write_text(PROGRAM.format(python=sys.executable))
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    assert results.find_program(program) == program.resolve()
    refused("no such program; give --program FILE", results.find_program, folder / "none")
    words = results.command(program, "job.dat", "out", ["--quiet"], {"p": "1e3"})
    done = results.launch(words)
    assert (done.code, done.errors) == (3, "complained"), done
    assert done.output == "said --quiet --output out --set p=1e3 job.dat\n", done
    assert done.wall > 0 and done.cpu > 0 and done.memory > 1
    refused("not finished after 1 s", results.launch, [*words, "--sleep"], 1)
    refused("exit code 0, and no results", results.run_points, "true", "*POINT p\n")


def main():
    for check in (check_tables, check_status, check_deck, check_runs):
        with tempfile.TemporaryDirectory() as folder:
            check(Path(folder))
    print("results are read")


main()
