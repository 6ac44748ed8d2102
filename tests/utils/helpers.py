# SPDX-License-Identifier: GPL-3.0-or-later
"""What these tests share: calls of the command, made-up runs."""

import contextlib
import io
import json
from pathlib import Path

import h5py
import numpy as np

from dd3 import tool
from dd3.command import main
from dd3.errors import run
from dd3.part import command as part
from dd3.tables import read_table, tools_in

ROOT = Path(__file__).resolve().parents[2]
UTILS = ROOT / "utils"


def call(*words, expect=0, main=main):
    """Call dd3, or another command, in this process; return what it says."""
    said, code = io.StringIO(), 0
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        try:
            first, *others = map(str, words or ("",))
            if first in ("tool", "part"):  # in this process
                run(lambda: {"tool": tool, "part": part}[first].convert(others))
            else:
                main([first, *others] if first else [])
        except SystemExit as stop:
            code = stop.code or 0
    assert code == expect and "Traceback" not in said.getvalue(), f"{words}: {code}\n{said.getvalue()}"
    return said.getvalue()


def write_run(run, start, now, cells, history, status, fields=(), at_cells=(), **job):
    """Write the results of a run of two steps: the nodes at both, fields with their values at both, members of
    run.json."""
    run.mkdir()
    (run / "history.csv").write_text(history)
    (run / "status.csv").write_text(status)
    (run / "run.json").write_text(json.dumps({
        "format": "dd3imp run", "format_version": 2, "program": {"name": "dd3imp", "version": "0.1.0"},
        "command": {"file": "job.dat", "working_directory": str(run.parent)}, "started": "2026-01-01T00:00:00+00:00",
        "title": "", "outcome": {"state": "reached", "message": None}, "input": {"blocks": []}, "materials": [],
        "tools": [], "drawbeads": [], "phases": [], "warnings": [], "seconds": 1.5, "sections": {"material": 1.0}, **job}))
    with h5py.File(run / "fields.vtkhdf", "w") as file:
        grid = file.create_group("VTKHDF")
        counts = {"NumberOfPoints": len(start), "NumberOfCells": len(cells), "NumberOfConnectivityIds": 8 * len(cells)}
        for name, count in counts.items():
            grid[name] = [count]
        grid["Types"], grid["Connectivity"] = np.full(len(cells), 12, np.uint8), np.ravel(cells)
        grid["Offsets"], grid["Points"] = 8 * np.arange(len(cells) + 1), np.vstack([start, now])
        steps = grid.create_group("Steps")
        steps.attrs["NSteps"] = 2
        steps["Values"], steps["PointOffsets"] = [0.0, 2.0], [0, len(start)]
        for place, values, count in (("PointData", fields, len(start)), ("CellData", at_cells, len(cells))):
            for name, both in dict(values).items():
                grid[f"{place}/{name}"], steps[f"{place}Offsets/{name}"] = np.concatenate(both), [0, count]
        rows = read_table(run / "history.csv")
        tools, of_steps = tools_in(rows[0]), file.create_group("job")
        of_steps.attrs["tools"] = " ".join(tools)
        names = [phase["name"] for phase in job.get("phases", [])]
        if names:
            of_steps["phase"] = [names.index(rows[i]["phase"]) + 1 for i in (0, -1)]
            for name in ("travel", "progress"):
                of_steps[name] = [float(rows[i][name]) for i in (0, -1)]
        if tools:
            of_steps["tool_displacement"] = [[float(rows[i][f"{tool}_u{axis}"]) for tool in tools for axis in "xyz"]
                                             for i in (0, -1)]
    return run
