# SPDX-License-Identifier: GPL-3.0-or-later
"""The interface of docs/python.md: its examples run one after the other on a short run of the bending test. The
reference is that of the docstrings, and the notebook runs."""

import json
import logging
import re
import shutil
import sys

import pytest
import pyvista as pv
from helpers import ROOT, UTILS

import dd3
from dd3 import places

sys.path.insert(0, str(UTILS / "dev"))
import notebook  # noqa: E402
import python_reference  # noqa: E402


@pytest.fixture
def bending(program, tmp_path, monkeypatch):
    """Put a short bending test into the folder, and use the program of the tests."""
    monkeypatch.setattr(places, "program", lambda: str(program))
    for tool in (ROOT / "input_files/bending").glob("*.bez"):
        shutil.copy(tool, tmp_path)
    job = dd3.deck.read(ROOT / "input_files/bending/bending.dat")
    job["PHASE", "draw"]["move"] = "punch 0 0 -4"
    job.write("bending.dat")


@pytest.mark.skipif(places.nearest(places.LIBRARY) is None, reason="without the library of the laws")
def test_examples(bending, tmp_path):
    """Run the examples, and check what they show."""
    names = {}
    for example in re.findall(r"```python\n(.*?)```", (ROOT / "docs/python.md").read_text(encoding="utf-8"), re.DOTALL):
        exec(example, names)
    logging.getLogger().handlers.clear()
    run = names["run"]
    assert (tmp_path / "force.png").is_file() and (tmp_path / "sheet.png").is_file() and names["page"].is_file()
    assert repr(run) == "dd3.open('bending.out')" and (tmp_path / "drawn.inp").is_file()
    assert len(run.fields) == len(run.fields.travel) == len(list(run.fields))
    last = run.fields[-1]
    assert isinstance(last, pv.UnstructuredGrid) and last.n_cells == run.fields[0].n_cells
    assert "thickness" in last.cell_data and "stress" in last.point_data
    assert {tool["name"] for tool in run.job["tools"]} == {"punch", "die", "blank_holder"}
    assert run.job["outcome"]["exit_code"] == 0 and run.job["phases"][-1]["result"]["travel"] == 4
    assert list(run.status["outcome"].unique()) == ["accepted"] and isinstance(run, dd3.Run)
    assert names["shorter"].history["travel"].iloc[-1] == 3 and "young = 200000" in (tmp_path / "softer.dat").read_text()


def test_reference():
    """Check that the reference is that of the docstrings."""
    assert (ROOT / "docs/python_reference.md").read_text(encoding="utf-8") == python_reference.page(), (
        "write it again: utils/dev/python_reference.py")


@pytest.mark.skipif(places.nearest(places.LIBRARY) is None, reason="without the library of the laws")
def test_notebook(program, monkeypatch):
    """Run the notebook; check its results against those that are written in it, and that none is missing."""
    monkeypatch.setattr(places, "program", lambda: str(program))
    path = ROOT / "docs/notebooks/first_run.ipynb"
    written, found = json.loads(path.read_text(encoding="utf-8")), notebook.run_notebook(path)
    for old, new in zip(written["cells"], found["cells"], strict=True):
        kinds = [[sorted(output.get("data", {"text": 0})) for output in cell.get("outputs", [])] for cell in (old, new)]
        assert kinds[0] == kinds[1], new
    text = json.dumps(found)
    assert "error E115: the input defines no parameter 'friction'" in text and "run: good: reached its end" in text
