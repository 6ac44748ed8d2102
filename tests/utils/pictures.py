"""Draw the pictures of a small made-up run, and inputs before a run. Skipped (77) without the packages.

    pictures.py --program build/release/dd3imp
"""

import argparse
import importlib.util
import shutil
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

UTILS = Path(__file__).resolve().parents[2] / "utils"
if any(importlib.util.find_spec(name) is None for name in ("h5py", "matplotlib", "numpy", "pyvista")):
    print("skipped: the packages of utils/requirements.txt are not installed")
    sys.exit(77)

import h5py  # noqa: E402
import matplotlib.image  # noqa: E402
import numpy as np  # noqa: E402

sys.path.insert(0, str(UTILS))
from beads import draped  # noqa: E402
from plot_increments import Increments  # noqa: E402

HISTORY = """# units: -,-,mm,-,mm,mm,mm,N,N,N,-
increment,phase,travel,progress,punch_ux,punch_uy,punch_uz,punch_fx,punch_fy,punch_fz,punch_contacts
0,draw,0,0,0,0,0,0,0,0,0
1,draw,1,0.5,0,0,-1,0,0,1500,4
2,draw,2,1,0,0,-2,0,0,2500,4
"""
DECK = """*PARAMETER
  shape = elsewhere
*TOOL punch
  patches = "${shape}.bez"   # beside this file
*PHASE draw
  control = punch
"""
LOG = """dd3imp 0.1.0: job.dat
started 2026-01-01 00:00
*TOOL punch
  patches = "punch.bez"
  position = 0 0 0                                  # mm, default
*PHASE draw
  control = punch
linear solver: umfpack
"""  # of a run with --set shape=punch
STATUS = """# units: -,-,-,mm,-,-,-,-
increment,attempt,phase,travel,r,limiter,outcome,reason
1,1,close,0,0.1,phase,accepted,
2,1,draw,1,0.02,rotation,accepted,
3,1,draw,,,,retry,"status, changes"
3,2,draw,1.5,0.001,r_min,accepted,
4,1,draw,2,0.01,force,accepted,
"""
PATCHES = "patch 2 1 rational\n0 0 2 1\n1 0 2 0.7\n1 0 3 1\n0 1 2 1\n1 1 2 0.7\n1 1 3 1\n"


def make_run(folder):
    (folder / "job.dat").write_text(DECK)
    (folder / "punch.bez").write_text(PATCHES)
    run = folder / "job.out"
    run.mkdir()
    (run / "history.csv").write_text(HISTORY)
    (run / "status.csv").write_text(STATUS)
    (run / "job.log").write_text(LOG)
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
    with h5py.File(run / "fields.vtkhdf", "w") as file:
        grid = file.create_group("VTKHDF")
        grid["NumberOfPoints"], grid["NumberOfCells"], grid["NumberOfConnectivityIds"] = [8], [1], [8]
        grid["Types"] = np.array([12], np.uint8)
        grid["Connectivity"], grid["Offsets"] = np.arange(8), np.array([0, 8])
        grid["Points"] = np.vstack([corners, corners - [0, 0, 2]])
        grid["PointData/stress"] = np.arange(96.0).reshape(16, 6)
        grid["CellData/thickness"] = np.array([1.0, 0.9])
        steps = grid.create_group("Steps")
        steps.attrs["NSteps"] = 2
        steps["Values"], steps["PointOffsets"] = [0.0, 2.0], [0, 8]
        steps["PointDataOffsets/stress"], steps["CellDataOffsets/thickness"] = [0, 8], [0, 1]
    return run


def size_of(picture):
    data = picture.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", f"{picture.name} is no PNG"
    return struct.unpack(">II", data[16:24])


def call(script, *arguments, expect=0, python=(sys.executable,)):
    done = subprocess.run([*python, UTILS / script, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == expect, f"{script} {arguments}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def check_refusals(run, folder):
    """Check that requests that cannot be met give one line each."""
    top = ("--field", "stress", "--view", "top", "--size", 300, 200)
    call("plot_sheet.py", run, "--mirror", "x", "--mirror", "y", *top, "--output", folder / "mirrored.png")
    call("plot_sheet.py", run, "--mirror", "xy", *top, "--output", folder / "both.png")
    assert (folder / "mirrored.png").read_bytes() == (folder / "both.png").read_bytes()
    (folder / "text.vtkhdf").write_text("no fields")
    for arguments, said in (
            ((run, "--hide", "nosuch"), "no tool 'nosuch' to hide; there are: punch"),
            ((run, "--at", 100), "no travel 100 mm; there is 0 to 2"), ((run, "--limits", 3, 1), "the lower one first"),
            ((run, "--colours", "nosuch"), "no colour map 'nosuch'"), ((run, "--view", "1 a 2"), "--view takes one of"),
            ((folder / "none.out",), "none.out: No such file"),
            ((folder / "text.vtkhdf",), "text.vtkhdf: not the field file of a run")):
        message = call("plot_sheet.py", *arguments, "--output", folder / "none.png", expect=2)
        assert said in message and "Traceback" not in message, message
    listed = subprocess.run(f"'{sys.executable}' '{UTILS / 'plot_sheet.py'}' '{run}' --list | :", shell=True,
                            capture_output=True, text=True, check=False)
    assert not listed.stderr, listed.stderr
    check_packages(run, folder)


def check_packages(run, folder):
    """Check that a script without its packages continues in the project's .venv, or says that they are missing."""
    call("plot_force.py", run, "--output", folder / "force.png", python=(sys.executable, "-S", "-s"))
    elsewhere = folder / "elsewhere"
    elsewhere.mkdir()
    for script in UTILS.glob("*.py"):
        shutil.copy(script, elsewhere)
    pathless = subprocess.run([sys.executable, "-S", "-s", elsewhere / "plot_force.py", run], capture_output=True,
                              text=True, check=False)
    assert pathless.returncode == 2 and pathless.stderr.startswith("error: no package"), pathless.stderr


def check_beads(run, folder):
    """Check that the line of a draw-bead is drawn on the sheet, and that it can be left out."""
    (folder / "bead.txt").write_text("-0.5 0.5   # x y\n1.5 0.5\n")
    log = run / "job.log"
    log.write_text(LOG.replace("linear solver", '*DRAWBEAD rib\n  file = "bead.txt"\nlinear solver'))
    (folder / "job.dat").write_text(DECK + "*DRAWBEAD rib\n  file = bead.txt\n")
    options = ("--field", "thickness", "--cells", "--view", "top", "--hide", "punch", "--size", 300, 200, "--output")
    for hidden in ((), ("--hide", "rib")):
        call("plot_sheet.py", run, *hidden, *options, folder / "bead.png")
        red, green, blue = np.moveaxis(matplotlib.image.imread(folder / "bead.png")[..., :3], 2, 0)
        count = np.count_nonzero((red > 0.6) & (green < 0.4) & (blue < 0.4))
        assert (count > 300) != bool(hidden), count
    curve = draped(np.array([[-0.5, 0.5], [0.5, 0.5], [0.5, 0.9]]), np.array([[0, 0, 0], [1, 1, 2.0]]))
    assert np.ptp(curve.points, axis=0)[:2].tolist() == [1.0, 0.4] and set(curve.points[:, 2]) == {2.0}
    log.write_text(LOG)
    (folder / "job.dat").write_text(DECK)


def check_increments(run, folder):
    """Check the picture of the increments: of one run and two, of one that stopped; refusals give one line each."""
    picture = ("--output", folder / "increments.png")
    call("plot_increments.py", run, *picture)
    assert size_of(folder / "increments.png") == (1500, 580)
    both = ("--phase", "draw", "--phase", "close")
    call("plot_increments.py", run, run / "status.csv", "--label", "one", *both, *picture)
    assert size_of(folder / "increments.png") == (1500, 1100)
    stopped = folder / "stopped.csv"
    stopped.write_text(STATUS + "5,1,draw,2.1,0.01,force,failed,\n5,1,dr")
    call("plot_increments.py", stopped, "--output", folder / "increments.svg")
    assert "<svg" in (folder / "increments.svg").read_text()
    increments = Increments(stopped, [])
    assert increments.stopped and increments.travel.tolist() == [1.0, 1.5, 2.0], increments.travel
    assert dict(increments.limiters()) == {"rotation": 1, "r_min": 1, "force": 1}, increments.limiters()
    assert "no phase 'none'" in call("plot_increments.py", run, "--phase", "none", *picture, expect=2)
    assert "No such file" in call("plot_increments.py", folder / "none.out", *picture, expect=2)
    assert "more labels" in call("plot_increments.py", run, "--label", "a", "--label", "b", *picture, expect=2)
    stopped.write_text(STATUS[:STATUS.index("1,1,close")])
    assert "no accepted increments" in call("plot_increments.py", stopped, *picture, expect=2)


def check_inputs(program, folder):
    """Check pictures of the initial state: of a job, and of one with a tool in its sheet."""
    options = ("--program", program, "--size", 300, 200, "--output", folder / "initial.png")
    for job, said in (("input_files/bending/bending.dat", ""),
                      ("tests/bad_input/tool_inside_sheet.dat", "starts inside")):
        message = call("plot_sheet.py", UTILS.parent / job, *options)
        assert said in message, message
        assert size_of(folder / "initial.png") == (300, 200)
        (folder / "initial.png").unlink()
    done = subprocess.run([program, "--check", "--quiet", "--initial", folder / "job.out",
                           UTILS.parent / "tests" / "bad_input" / "tool_inside_sheet.dat"],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "job.out' holds results of a run" in done.stderr, done.stderr
    assert "'no'" in call("plot_sheet.py", folder / "job.dat", "--set", "no=1", *options, expect=2)
    assert "no such program" in call("plot_sheet.py", folder / "job.dat", "--program", folder / "none", expect=2)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=Path, required=True, help="the program dd3imp")
    program = parser.parse_args().program
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        run = make_run(folder)
        call("plot_force.py", run, "--output", folder / "force.png")
        assert size_of(folder / "force.png") == (1400, 900)
        call("plot_force.py", run, run, "--label", "one", "--component", "z", "--output", folder / "force.svg")
        assert "<svg" in (folder / "force.svg").read_text()
        call("plot_sheet.py", run, "--field", "stress:13", "--size", 300, 200, "--output", folder / "one.png")
        assert size_of(folder / "one.png") == (300, 200)
        elsewhere = shutil.copytree(run, folder / "results" / "of.job")
        (elsewhere / "job.log").write_text(LOG.replace(": job.dat", f": {folder / 'job.dat'}"))
        call("plot_sheet.py", elsewhere, "--field", "stress:13", "--size", 300, 200, "--output", folder / "same.png")
        assert (folder / "same.png").read_bytes() == (folder / "one.png").read_bytes()
        call("plot_sheet.py", run, "--field", "thickness", "--cells", "--at", 0, "--at", 2, "--mirror", "x", "--view",
             "front", "--size", 300, 200, "--output", folder / "two.png")
        assert size_of(folder / "two.png") == (300, 400)
        assert "no field 'strain'" in call("plot_sheet.py", run, "--field", "strain", expect=2)
        assert "no tool 'die'" in call("plot_force.py", run, "--tool", "die", expect=2)
        assert "No such file" in call("plot_force.py", folder / "none.out", expect=2)
        check_increments(run, folder)
        check_beads(run, folder)
        check_refusals(run, folder)
        check_inputs(program, folder)
    print("pictures drawn")


main()
