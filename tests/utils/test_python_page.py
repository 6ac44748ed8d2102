# SPDX-License-Identifier: GPL-3.0-or-later
"""The interface of docs/python.md: its examples run one after the other on a run of the bending test."""

import re

import pyvista as pv
from helpers import ROOT

import dd3
from dd3.programs import command, launch


def test_examples(program, tmp_path):
    """Run the examples, and check what they show."""
    done = launch(command(program, ROOT / "input_files/bending/bending.dat", "bending.out", ["--quiet"]))
    assert done.code == 0, done.errors
    names = {}
    for example in re.findall(r"```python\n(.*?)```", (ROOT / "docs/python.md").read_text(encoding="utf-8"), re.DOTALL):
        exec(example, names)
    run = names["run"]
    assert (tmp_path / "force.png").is_file() and repr(run) == "dd3.open('bending.out')"
    assert len(run.fields) == len(run.fields.travel) == len(list(run.fields))
    last = run.fields[-1]
    assert isinstance(last, pv.UnstructuredGrid) and last.n_cells == run.fields[0].n_cells
    assert "thickness" in last.cell_data and "stress" in last.point_data
    assert {tool["name"] for tool in run.job["tools"]} == {"punch", "die", "blank_holder"}
    assert run.job["outcome"]["exit_code"] == 0 and run.job["phases"][-1]["result"]["travel"] > 39
    assert list(run.status["outcome"].unique()) == ["accepted"] and isinstance(run, dd3.Run)
