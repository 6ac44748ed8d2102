# SPDX-License-Identifier: GPL-3.0-or-later
"""`dd3 watch` and `dd3 view`: a made-up run that goes on, its end, and the page that is made where it is old."""

import fcntl
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest
from helpers import ROOT, UTILS, call
from viewer_run import HISTORY, STATUS, viewed_run

from dd3.run import read_frame, read_job
from dd3.view import is_old
from dd3.watch import Watch, clock, line_of


def halted(folder, state, rows=3):
    """Set the state of a run, and leave the first rows of its history."""
    job = json.loads((folder / "run.json").read_text())
    job["outcome"]["state"] = state
    (folder / "run.json").write_text(json.dumps(job))
    (folder / "history.csv").write_text("".join(line + "\n" for line in HISTORY.splitlines()[:1 + rows]))


def test_line(tmp_path):
    """Check what is told: phase, travel, force, increments, cut-backs, and the time left."""
    run = viewed_run(tmp_path / "strip.out")
    (run / "history.csv").write_text(HISTORY.replace("1,draw,2,1,", "1,draw,0.5,0.25,").rpartition("2,free")[0])
    (run / "status.csv").write_text(STATUS.rpartition("free")[0])
    said = line_of(read_job(run), read_frame(run), read_frame(run, "status.csv"))
    assert said == ("phase 1 of 2: draw, 25.0 % | travel 0.5 mm | punch 2.5 kN | 1 increments, 1 cut back | "
                    "9 s left in this phase")  # 3 s for a quarter
    assert [clock(seconds) for seconds in (5.4, 65, 7260)] == ["5 s", "1 min 05 s", "2 h 01 min"]


def test_watch(tmp_path):
    """Watch a run that goes on and then ends, which is held by this process like a run by the program."""
    run = viewed_run(tmp_path / "strip.out")
    halted(run, "running", 2)
    with (run / "job.log").open("w") as log:
        fcntl.flock(log, fcntl.LOCK_EX)
        watcher = subprocess.Popen([sys.executable, "-m", "dd3", "watch", str(run), "--every", "0.2", "--picture",
                                    str(tmp_path / "now.png")], stdout=subprocess.PIPE, text=True,
                                   env={**os.environ, "PYTHONPATH": str(UTILS)})
        first = watcher.stdout.readline()
        while not (tmp_path / "now.png").is_file() and watcher.poll() is None:
            time.sleep(0.2)
        assert watcher.poll() is None, "the run still goes on"
        halted(run, "reached")
    rest = watcher.communicate(timeout=300)[0]
    assert first.startswith("phase 2 of 2: free, 0.0 %"), first
    assert rest.splitlines()[-1] == f"{run}: reached its end after 2 s" and watcher.returncode == 0
    assert (tmp_path / "now.png").read_bytes()[:4] == b"\x89PNG"


def test_ends(tmp_path):
    """Check the exit code of a run that did not reach its end, and messages on wrong input."""
    run = viewed_run(tmp_path / "strip.out")
    halted(run, "running")
    assert f"{run}: ended: killed" in call("watch", run, expect=1)  # no program holds its log
    assert "no run is going on" in call("watch", tmp_path, expect=2)
    assert "No such folder" in call("watch", tmp_path / "none.out", expect=2)
    assert "go with --page" in call("watch", run, "--mirror", "x", expect=2)
    assert "No such folder" in call("view", tmp_path / "none.out", expect=2)


def test_page_of_a_stop(tmp_path, monkeypatch):
    """Check the page of a run that stops in the first increment of its second phase, and that it is made again at the
    end of a run, though no step is new."""
    run = viewed_run(tmp_path / "strip.out")
    halted(run, "stopped", 2)
    call("watch", run, "--page", expect=1)
    assert "stopped in its first increment" in (run / "report" / "report.html").read_text()
    watch, made = Watch(run, page={"run": run}), []
    monkeypatch.setattr("dd3.report.make", lambda run: made.append(run))
    for ended in (False, False, True, True):
        watch.draw(ended)
    assert len(made) == 2


def test_view(tmp_path, monkeypatch):
    """Check that the page is made where it is missing or old, and kept where it is not, and how it is opened."""
    run = viewed_run(tmp_path / "strip.out")
    page, opened = run / "report" / "report.html", []
    monkeypatch.setattr("webbrowser.open", lambda address: opened.append(address) or True)
    assert call("view", run, "--mirror", "x").strip() == str(page) and opened == [page.resolve().as_uri()]
    assert not is_old(page, run)
    written = page.stat().st_mtime_ns
    call("view", run, "--no-browser")
    assert page.stat().st_mtime_ns == written and len(opened) == 1
    os.utime(run / "history.csv", (time.time() + 10, time.time() + 10))
    assert is_old(page, run)
    monkeypatch.setattr("webbrowser.open", lambda address: False)
    assert "no browser is found; open this file in one" in call("view", run, expect=2)
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert "there is no display" in call("view", run, "--window", expect=2)
    assert "--field and --at go with --window" in call("view", run, "--field", "thinning", expect=2)


def test_while_it_runs(program, tmp_path):
    """Watch a run of the program from its start to its end."""
    shutil.copytree(ROOT / "input_files/bending", tmp_path / "bending")
    running = subprocess.Popen([program, "--quiet", "--output", tmp_path / "b.out", tmp_path / "bending/bending.dat"])
    while not Path(tmp_path / "b.out" / "job.log").is_file() and running.poll() is None:
        time.sleep(0.05)
    said = call("watch", tmp_path / "b.out", "--every", "0.2")
    assert running.wait() == 0
    lines = said.splitlines()
    assert "reached its end after" in lines[-1] and any(line.startswith("phase 1 of ") for line in lines)


@pytest.mark.parametrize("words", [("view",), ("watch",)])
def test_needs_a_run(words):
    """Check the message without a run."""
    assert "RUN" in call(*words, expect=2)
