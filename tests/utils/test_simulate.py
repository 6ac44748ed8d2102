# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs from Python: results, errors of the input, stops, interrupts; and what a run offers."""

import logging
import os
import signal
import subprocess
import threading
import time

import matplotlib.figure
import pandas as pd
import pytest
from helpers import ROOT
from test_study import DECK

import dd3

BENDING = ROOT / "input_files/bending/bending.dat"


@pytest.fixture
def deck(tmp_path):
    """Return the input file of a bar."""
    (tmp_path / "bar.dat").write_text(DECK)
    return tmp_path / "bar.dat"


def test_run(program, deck, tmp_path):
    """Check a run with a parameter and its progress, and its pictures, sections, verdict and page."""
    done = []
    run = dd3.simulate(deck, set={"strain": 0.02}, threads=1, progress=done.append, program=program)
    assert isinstance(run, dd3.Run) and run.folder == tmp_path / "bar.out" and run.job["outcome"]["state"] == "reached"
    assert done[-1] == 1.0 and done == sorted(done)
    assert run.fields[-1].point_data["displacement"][:, 0].max() == pytest.approx(0.02)  # mm, at the end
    table = run.sections("y=1", ["thickness", "equivalent_plastic_strain"], at="pull")
    assert isinstance(table, pd.DataFrame) and table["thickness"].max() < 1 and table["x0"].iloc[-1] == 4
    for kind in ("increments", "section"):
        assert isinstance(run.plot(kind), matplotlib.figure.Figure), kind
    figure = run.plot("sheet", field="thickness", size=(300, 200))
    assert figure.axes[0].images[0].get_array().shape[1] == 300
    assert run.plot("limit", low_carbon_steel=True, n=0.2).axes[0].get_xlabel().startswith("minor")
    answers = {item.name: item.answer for item in run.verdict(n=0.2)}
    assert answers["run"] == answers["thinning"] == answers["forming limit"] == "good", answers
    assert run.springback() is None
    page = run.report(tmp_path / "page", section=["y=1"])
    assert page == tmp_path / "page" / "report.html" and "Thickness along sections" in page.read_text()
    for act, said in ((lambda: run.plot("heat"), "no picture 'heat'; there are: force increments"),
                      (lambda: run.plot("sheet", view="nowhere"), "--view takes one of"),
                      (lambda: run.verdict(thinning=20), "a fraction between 0 and 1"),
                      (lambda: run.verdict(waves="x"), "take a positive number"),
                      (lambda: run.verdict(mirror="q"), "mirror takes planes of symmetry"),
                      (lambda: dd3.simulate("job.dat", threads="two"), "threads takes a number"),
                      (run.plot, "there is no tool")):
        with pytest.raises(dd3.Problem, match=said):
            act()


def test_input(program, deck, tmp_path):
    """Check that errors of the input come with their places, and that a changed input file has to be written."""
    job = dd3.deck.read(deck)
    job["BLANK"]["sice"] = "4 2 1"
    del job["BLANK"]["size"]
    with pytest.raises(dd3.Problem, match="write it first"):
        dd3.simulate(job, program=program)
    job.write("wrong.dat")
    with pytest.raises(dd3.InputError, match="unknown key 'sice'") as problem:
        dd3.simulate(job, program=program)
    codes = {(message.code, message.line) for message in problem.value.messages}
    assert codes == {("E112", DECK.splitlines().index("*MATERIAL m"))}, problem.value.messages
    assert problem.value.messages[0].file.endswith("wrong.dat") and not (tmp_path / "wrong.out").exists()
    with pytest.raises(dd3.Problem, match="no such program"):
        dd3.simulate(deck, program="none")
    with pytest.raises(dd3.InputError, match="no parameter 'depth'"):
        dd3.simulate(deck, set={"depth": 1}, program=program)


def child_of(here):
    """Return the process of the program, once it has begun."""
    while not (found := subprocess.run(["pgrep", "-P", str(here), "dd3imp"], capture_output=True, text=True,
                                       check=False).stdout.split()):
        time.sleep(0.05)
    return int(found[0])


def signalled(number, target, folder):
    """Send a signal once a run has increments: to the program, or to this process as a terminal and a notebook do."""
    def act():
        child = child_of(os.getpid())
        while not (folder / "status.csv").is_file() or (folder / "status.csv").read_text().count("\n") < 4:
            time.sleep(0.05)
        os.kill(child if target == "program" else os.getpid(), number)
    threading.Thread(target=act, daemon=True).start()


def test_stopped(program, tmp_path, caplog):
    """Check that a run that stops is an exception with its results, and that an interrupt ends the program cleanly."""
    folder = tmp_path / "b.out"
    signalled(signal.SIGTERM, "program", folder)
    with pytest.raises(dd3.Stopped, match="E201") as problem:
        dd3.simulate(BENDING, output=folder, threads=1, program=program)
    run = problem.value.run
    assert run.job["outcome"]["exit_code"] == 3 and len(run.history) > 2 and (folder / "restart.h5").is_file()
    folder = tmp_path / "c.out"
    signalled(signal.SIGINT, "python", folder)
    with caplog.at_level(logging.INFO, "dd3"), pytest.raises(KeyboardInterrupt):
        dd3.simulate(BENDING, output=folder, threads=1, program=program)
    assert "stopping the run" in caplog.text
    assert dd3.open(folder).job["outcome"]["state"] == "interrupted" and (folder / "restart.h5").is_file()
