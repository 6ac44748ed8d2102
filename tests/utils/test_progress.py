# SPDX-License-Identifier: GPL-3.0-or-later
"""What is told of steps that take long, by `dd3 tool` and `dd3 part`."""
import os
import re
import subprocess
import sys
import time

import part_set
from helpers import call

from dd3 import progress
from dd3.tools.limits import beside


def test_steps(monkeypatch, capsys):
    """Check that the innermost step is told, the same one again when its time has doubled, and no quick one."""
    monkeypatch.setattr(progress, "QUIET", 0.1)
    with progress.doing("outer"):
        with progress.doing("inner"):
            time.sleep(0.75)
        with progress.doing("quick"):
            pass
        time.sleep(0.25)
    with progress.doing("alone"):
        pass
    said = re.findall(r"(\w+): \d+ s\n", capsys.readouterr().err)
    assert 2 <= said.count("inner") <= 4 and said[-1] == "outer" and not {"quick", "alone"} & set(said), said


def test_beside(tmp_path):
    """Check that a file is written beside a block, and after it if that failed in the child process."""
    here, done = os.getpid(), tmp_path / "done"

    def write():
        assert os.getpid() != here or not done.exists()
        done.write_text(str(os.getpid()))

    with beside(write):
        pass
    assert done.read_text() != str(here)
    done.unlink()

    def fail_there():
        assert os.getpid() == here
        write()

    with beside(fail_there):
        assert not done.exists()
    assert done.read_text() == str(here)


def test_light():
    """Check that the die maker is imported without the libraries of pictures, which takes seconds."""
    code = "import sys, dd3.tool; print(*{'matplotlib.axes', 'pyvista', 'gmsh'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not done.stdout.strip()


def test_tool(monkeypatch, tmp_path):
    """Check that the die maker tells its steps."""
    monkeypatch.setattr(progress, "QUIET", 0.02)
    part = part_set.write(tmp_path, ["tray"])["tray"]
    said = call("tool", part, tmp_path / "tray")
    told = set(re.findall(r"(?m)^(\D+): \d+ s$", said))
    assert {"meshing the faces by patches", "laying the part flat for its blank"} <= told, told
