# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of a small made-up run, and of inputs before a run."""

import json
import struct
import subprocess
import sys

import matplotlib.image
import numpy as np
import pytest
from helpers import ROOT, call, write_run

from dd3.plot import force
from dd3.plot.beads import draped
from dd3.plot.figures import new_figure
from dd3.plot.increments import Increments
from dd3.run import read_frame

HISTORY = """# units: -,-,mm,-,mm,mm,mm,N,N,N,-
increment,phase,travel,progress,punch_ux,punch_uy,punch_uz,punch_fx,punch_fy,punch_fz,punch_contacts
0,draw,0,0,0,0,0,0,0,0,0
1,draw,1,0.5,0,0,-1,0,0,1500,4
2,draw,2,1,0,0,-2,0,0,2500,4
"""
STATUS = """# units: -,-,-,mm,-,-,-,-
increment,attempt,phase,travel,r,limiter,outcome,reason
1,1,close,0,0.1,phase,accepted,
2,1,draw,1,0.02,rotation,accepted,
3,1,draw,,,,retry,"status, changes"
3,2,draw,1.5,0.001,r_min,accepted,
4,1,draw,2,0.01,force,accepted,
"""
PATCHES = "patch 2 1 rational\n0 0 2 1\n1 0 2 0.7\n1 0 3 1\n0 1 2 1\n1 1 2 0.7\n1 1 3 1\n"
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
PUNCH = [{"name": "punch", "patches": "punch.bez"}]


def made_run(folder, **job):
    """Return a run of one element and a tool."""
    (folder / "punch.bez").write_text(PATCHES)
    stress = np.arange(96.0).reshape(2, 8, 6)
    return write_run(folder / "job.out", CORNERS, CORNERS - [0, 0, 2], [range(8)], HISTORY, STATUS, {"stress": stress},
                     {"thickness": ([1.0], [0.9])}, tools=PUNCH, **job)


@pytest.fixture
def run(tmp_path):
    """Return a run."""
    return made_run(tmp_path)


def size_of(picture):
    """Return the size of a picture in pixels."""
    data = picture.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", f"{picture.name} is no PNG"
    return struct.unpack(">II", data[16:24])


def test_force(run, tmp_path):
    """Check pictures of the force, and requests that cannot be met."""
    call("plot", "force", run)
    assert size_of(tmp_path / "force.png") == (1400, 900)
    call("plot", "force", run, run, "--label", "one", "--component", "z", "--output", tmp_path / "force.svg")
    assert "<svg" in (tmp_path / "force.svg").read_text()
    assert "no tool 'die'" in call("plot", "force", run, "--tool", "die", expect=2)
    assert "no phase 'none'" in call("plot", "force", run, "--phase", "none", expect=2)
    assert "No such file" in call("plot", "force", tmp_path / "none.out", expect=2)


HEAD = "increment,phase,travel,progress," + ",".join(f"{tool}_{name}{axis}" for tool in ("punch", "roll")
                                                     for name in "uf" for axis in "xyz") + ",roll_angle,punch_contacts,roll_contacts\n"


def test_curves(tmp_path):
    """Check force, and what it is drawn over, in phases that a tool controls, and that none does."""
    rows = (
        "0,press,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n1,press,0,0.5,0,0,0,0,0,0,0,0,-0.1,0,0,50,0\n"
        "2,press,0,1,0,0,0,0,0,0,0,0,-0.3,0,0,100,0\n3,draw,2,0.5,0,0,-2,0,0,70,0,0,-0.4,0,0,100,0\n"
        "4,draw,4,1,0,0,-4,0,0,90,0,0,-0.4,0,0,100,0\n5,lift,4,0.4,0,0,0,0,0,9,0,0,-0.4,0,0,1,0\n"
        "6,lift,4,1,0,0,6,0,0,0,0,0,-0.4,0,0,1,0\n7,turn,4,0.5,0,0,6,0,0,0,0,0,-0.4,0,0,30,-20\n"
        "8,turn,4,1,0,0,6,0,0,0,0,0,-0.4,0,0,40,-40\n")
    (tmp_path / "history.csv").write_text(HEAD + rows.replace("\n", ",1,1\n"))
    history = read_frame(tmp_path, "history.csv")
    assert force.main_phase(history) == "draw"
    found = force.curve(history)
    assert found.tool == "punch" and found.quantity == "punch displacement (mm)" and not found.stopped
    assert list(found.along) == [0, 2, 4] and list(found.force) == [0, 70, 90]
    found = force.curve(history, tool="roll")
    assert list(found.along) == [0, 2, 4] and list(found.force) == [100, 100, 100]
    found = force.curve(history, phases=["press"])
    assert found.quantity == "progress of the phase (%)" and list(found.along) == [0, 50, 100]
    assert list(found.force) == [0, 50, 100]
    found = force.curve(history, phases=["lift"])
    assert found.quantity == "punch displacement (mm)" and np.allclose(found.along, [0, 4, 10])
    found = force.curve(history, phases=["turn"])
    assert found.quantity == "roll angle (degrees)" and list(found.along) == [0, 20, 40]


@pytest.mark.parametrize("places, forces, along, shown", (
    # Down against the sheet, and up beyond the start, where it is farther away.
    ((-0.3, -0.6, 0.2, 0.7), (3, 7, 0, -5), (0.3, 0.6, -0.2, -0.7), (3, 7, 0, -5)),
    ((-1, -2, -1, 1e-15), (30, 70, 9, 0), (1, 2, 1, 0), (30, 70, 9, 0)),  # there and back: round-off is left
    ((0.5, 0, -4, -8), (0, 0, 50, 90), (-0.5, 0, 4, 8), (0, 0, 50, 90)),  # lifted before, against nothing
    ((2, 4, 6, 8), (9, 4, 1, 0), (2, 4, 6, 8), (-9, -4, -1, 0)),  # a release: the sheet follows
))
def test_sign_of_the_force(tmp_path, places, forces, along, shown):
    """Check that displacement and force of motions there and back are positive where the sheet resists first."""
    row = "{},{},{},{},0,0,{},0,0,{}" + ",0" * 7 + ",1,1\n"
    travel = np.cumsum(np.abs(np.diff((0, *places))))
    rows = [(0, "a", 0, 0, 0, 0), *((i + 1, "aabb"[i], travel[i], (0.5, 1)[i % 2], place, force)
                                    for i, (place, force) in enumerate(zip(places, forces)))]
    (tmp_path / "history.csv").write_text(HEAD + "".join(row.format(*one) for one in rows))
    found = force.curve(read_frame(tmp_path, "history.csv"), phases=["a", "b"])
    assert found.tool == "punch" and found.quantity == "punch displacement (mm)"
    assert np.allclose(found.along, (0, *along)) and np.allclose(found.force, (0, *shown)), (found.along, found.force)
    _, axes = new_figure((4, 3))
    force.draw(axes, [found], [""])
    assert axes.get_xlim()[0] <= min(0.0, *along)


def test_controlling_tool_there_and_back(tmp_path):
    """Check that the tool whose whole path is the travel is found beside one that ends as far from its start."""
    row = "{},{},{},{},0,0,{},0,0,{},0,0,{},0,0,0,0,1,1\n"
    rows = [(0, "a", 0, 0, 0, 0, 0), (1, "a", 2, 1, -2, 50, 1.5), (2, "b", 4, 1, 0, 0, 3)]
    (tmp_path / "history.csv").write_text(HEAD + "".join(row.format(*one) for one in rows))
    assert force.controlling_tool(read_frame(tmp_path, "history.csv"), ["a", "b"]) == "punch"


def test_progress_of_phases_that_end_early(tmp_path):
    """Check the progress where a phase ends at 0.1, the next has one increment, and where the rows begin in between; a
    run that has reached its end is not marked as stopped."""
    row = "{},{},0,{}" + ",0" * 12 + ",0,1,1\n"
    rows = (("a", 0), ("a", 0.05), ("a", 0.1), ("b", 1), ("c", 0.5), ("c", 0.8))
    (tmp_path / "history.csv").write_text(HEAD + "".join(row.format(i, *one) for i, one in enumerate(rows)))
    history = read_frame(tmp_path, "history.csv")
    assert np.allclose(force.progress_of(history, np.arange(6)), [0, 0.05, 0.1, 1.1, 1.6, 1.9])
    assert np.allclose(force.progress_of(history, np.array([2, 3])), [0, 1])
    assert np.allclose(force.progress_of(history, np.array([3, 4, 5])), [0, 0.5, 0.8])
    assert force.curve(history, phases=["c"]).stopped
    job = {"format": "dd3imp run", "format_version": 2, "program": {"name": "dd3imp", "version": "1"}, "title": "",
           "outcome": {"state": "reached"}}
    (tmp_path / "run.json").write_text(json.dumps(job))
    assert not force.curve(history, phases=["c"]).stopped


def test_sheet(run, tmp_path):
    """Check pictures of the sheet and its tools, which are found again beside results that were moved."""
    options = ("--field", "stress:13", "--size", 300, 200, "--output")
    call("plot", "sheet", run, *options, "one.png")
    assert size_of(tmp_path / "one.png") == (300, 200)
    moved = tmp_path / "elsewhere"
    moved.mkdir()
    for path in (run, tmp_path / "punch.bez"):
        path.rename(moved / path.name)
    call("plot", "sheet", moved / run.name, *options, "same.png")
    assert (tmp_path / "same.png").read_bytes() == (tmp_path / "one.png").read_bytes()
    (moved / "punch.bez").rename(tmp_path / "other.bez")
    assert "without it the tool 'punch' is not drawn" in call("plot", "sheet", moved / run.name, *options, "none.png")
    call("plot", "sheet", moved / run.name, "--tool", "Punch=other.bez", *options, "same.png")
    assert (tmp_path / "same.png").read_bytes() == (tmp_path / "one.png").read_bytes()
    call("plot", "sheet", moved / run.name, "--field", "thickness", "--cells", "--at", 0, "--at", 2, "--mirror", "x",
         "--view", "front", "--size", 300, 200, "--output", "two.png")
    assert size_of(tmp_path / "two.png") == (300, 400)


def test_levels(tmp_path):
    """Check the picture of the levels of elements: their colours, and the legend with their number."""
    run = write_run(tmp_path / "job.out", CORNERS, CORNERS - [0, 0, 2], [range(8)], HISTORY, STATUS,
                    at_cells={"level": ([0.0], [1.0])})
    call("plot", "sheet", run, "--field", "level", "--view", "top", "--size", 300, 200, "--output",
         tmp_path / "one.png")
    red, green, blue = np.moveaxis(matplotlib.image.imread(tmp_path / "one.png")[..., :3], 2, 0)
    assert np.count_nonzero((blue > red + 0.1) & (green > red)) > 1000  # level 1 is blue


def test_refusals(run, tmp_path):
    """Check that requests that cannot be met give one line each."""
    top = ("--field", "stress", "--view", "top", "--size", 300, 200)
    call("plot", "sheet", run, "--mirror", "x", "--mirror", "y", *top, "--output", tmp_path / "mirrored.png")
    call("plot", "sheet", run, "--mirror", "x", "y", *top, "--output", tmp_path / "both.png")
    assert (tmp_path / "mirrored.png").read_bytes() == (tmp_path / "both.png").read_bytes()
    (tmp_path / "text.vtkhdf").write_text("no fields")
    for arguments, said in (
            ((run, "--hide", "nosuch"), "no tool 'nosuch' to hide; there are: punch"),
            ((run, "--field", "strain"), "no field 'strain'"),
            ((run, "--at", 100), "no travel 100 mm; there is 0 to 2"),
            ((run, "--limits", 3, 1), "the lower one first"), ((run, "--colours", "nosuch"), "no colour map 'nosuch'"),
            ((run, "--view", "1 a 2"), "--view takes one of"), ((tmp_path / "none.out",), "none.out: No such file"),
            ((tmp_path / "text.vtkhdf",), "text.vtkhdf: not the field file of a run")):
        assert said in call("plot", "sheet", *arguments, "--output", tmp_path / "none.png", expect=2)
    listed = subprocess.run(f"'{sys.executable}' -m dd3 plot sheet '{run}' --list | :", shell=True,
                            capture_output=True, text=True, check=False)
    assert not listed.stderr, listed.stderr


def test_beads(tmp_path):
    """Check that the line of a draw-bead is drawn on the sheet, and that it can be left out."""
    run = made_run(tmp_path, drawbeads=[{"name": "rib", "points": [[-0.5, 0.5], [1.5, 0.5]]}])
    options = ("--field", "thickness", "--cells", "--view", "top", "--hide", "punch", "--size", 300, 200, "--output")
    for hidden in ((), ("--hide", "rib")):
        call("plot", "sheet", run, *hidden, *options, tmp_path / "bead.png")
        red, green, blue = np.moveaxis(matplotlib.image.imread(tmp_path / "bead.png")[..., :3], 2, 0)
        count = np.count_nonzero((red > 0.6) & (green < 0.4) & (blue < 0.4))
        assert (count > 300) != bool(hidden), count
    curve = draped(np.array([[-0.5, 0.5], [0.5, 0.5], [0.5, 0.9]]), np.array([[0, 0, 0], [1, 1, 2.0]]))
    assert np.ptp(curve.points, axis=0)[:2].tolist() == [1.0, 0.4] and set(curve.points[:, 2]) == {2.0}


def test_increments(run, tmp_path):
    """Check the picture of the increments: of one run and two, of one that stopped; refusals give one line each."""
    picture = ("--output", tmp_path / "increments.png")
    call("plot", "increments", run, *picture)
    assert size_of(tmp_path / "increments.png") == (1500, 580)
    both = ("--phase", "draw", "--phase", "close")
    call("plot", "increments", run, run / "status.csv", "--label", "one", *both, *picture)
    assert size_of(tmp_path / "increments.png") == (1500, 1100)
    stopped = tmp_path / "stopped.csv"
    stopped.write_text(STATUS + "5,1,draw,2.1,0.01,force,failed,\n5,1,dr")
    call("plot", "increments", stopped, "--output", tmp_path / "increments.svg")
    assert "<svg" in (tmp_path / "increments.svg").read_text()
    increments = Increments(stopped, [])
    assert increments.stopped and increments.travel.tolist() == [1.0, 1.5, 2.0], increments.travel
    assert dict(increments.limiters()) == {"rotation": 1, "r_min": 1, "force": 1}, increments.limiters()
    assert "no phase 'none'" in call("plot", "increments", run, "--phase", "none", *picture, expect=2)
    assert "No such file" in call("plot", "increments", tmp_path / "none.out", *picture, expect=2)
    assert "more labels" in call("plot", "increments", run, "--label", "a", "--label", "b", *picture, expect=2)
    stopped.write_text(STATUS[:STATUS.index("1,1,close")])
    assert "no rows" in call("plot", "increments", stopped, *picture, expect=2)


def test_inputs(run, program, tmp_path):
    """Check pictures of the initial state: of a job, and of one with a tool in its sheet."""
    options = ("--program", program, "--size", 300, 200, "--output", tmp_path / "initial.png")
    for job, said in (("input_files/bending/bending.dat", ""),
                      ("tests/bad_input/tool_inside_sheet.dat", "starts inside")):
        message = call("plot", "sheet", ROOT / job, *options)
        assert said in message, message
        assert size_of(tmp_path / "initial.png") == (300, 200)
        (tmp_path / "initial.png").unlink()
    done = subprocess.run([program, "--check", "--quiet", "--initial", run,
                           ROOT / "tests" / "bad_input" / "tool_inside_sheet.dat"],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "job.out' holds results of a run" in done.stderr, done.stderr
    (tmp_path / "job.dat").write_text("*PHASE draw\n")
    assert "'no'" in call("plot", "sheet", tmp_path / "job.dat", "--set", "no=1", *options, expect=2)
    assert "no such program" in call("plot", "sheet", tmp_path / "job.dat", "--program", tmp_path / "none", expect=2)
