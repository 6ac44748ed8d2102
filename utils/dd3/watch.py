# SPDX-License-Identifier: GPL-3.0-or-later
"""Watch a run in progress: phase, travel, force, increments, cut-backs and time left, until it ends.

    dd3 watch cup.out
    dd3 watch cup.out --picture cup.png --every 10
    dd3 watch cup.out --page --mirror x y

--picture draws the sheet at each new step of the results, --page writes the page of `dd3 report` again, with its
options. The time left is that of the phase, if its rest goes on as the phase has gone so far. The exit code is 1 if the
run does not reach its end.
"""

import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from dd3 import report
from dd3.command import new_parser
from dd3.errors import Problem
from dd3.fields import Fields
from dd3.plot import force as forces
from dd3.plot import sheet as pictures
from dd3.run import is_held, read_frame, read_job


def clock(seconds: float) -> str:
    """Return a time as text."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02} min" if hours else f"{minutes} min {rest:02} s" if minutes else f"{rest} s"


def line_of(job: dict[str, Any], history: pd.DataFrame, status: pd.DataFrame) -> str:
    """Return what a run does, given its tables so far."""
    last = history.iloc[-1]
    name = str(status["phase"].iloc[-1])
    names = [phase["name"] for phase in job["phases"]]
    own = status[status["phase"] == name]
    rows = np.flatnonzero(history["phase"] == name)
    begun = bool(len(rows)) and str(last["phase"]) == name
    progress = float(last["progress"]) if begun else 0.0
    place = f"phase {names.index(name) + 1} of {len(names)}: {name}" if name in names else f"phase {name}"
    said = [f"{place}, {100 * progress:.1f} %", f"travel {float(last['travel']):.4g} mm"]
    if begun and (tool := leader_of(history, name)):
        force = float(np.linalg.norm(forces.vector(history, tool, "f")[-1]))
        said.append(f"{tool} {force / 1000:.4g} kN" if force >= 1000 else f"{tool} {force:.4g} N")
    said.append(f"{int((status['outcome'] == 'accepted').sum())} increments, "
                f"{int((status['outcome'] == 'retry').sum())} cut back")
    if 0 < progress < 1:
        said.append(f"{clock(float(own['seconds'].sum()) * (1 - progress) / progress)} left in this phase")
    return " | ".join(said)


def leader_of(history: pd.DataFrame, phase: str) -> str | None:
    """Return the tool that controls a phase; None without tools."""
    try:
        return forces.controlling_tool(history, [phase])
    except Problem:
        return None


class Watch:
    """A run that is watched: its folder, seconds between two looks, what is written of its steps (a picture in a style,
    the page with settings of `report.make`), and what of it: how many steps, of a run that has ended or not."""

    def __init__(self, folder: Path, every: float = 2.0, picture: Path | None = None,
                 style: pictures.Style | None = None, page: dict[str, Any] | None = None) -> None:
        self.folder, self.every, self.picture, self.style, self.page = folder, every, picture, style, page
        self.drawn, self.said = (0, False), ""
        self.live = sys.stdout.isatty()

    def tell(self, text: str) -> None:
        """Print a line in place of the one before on a terminal, below it elsewhere; the same one once only."""
        if text == self.said:
            return
        print(f"\r\x1b[K{text}" if self.live else text, end="" if self.live else "\n", flush=True)
        self.said = text

    def look(self) -> dict[str, Any] | None:
        """Tell the state of the run; return its description, None while there is none."""
        folder = self.folder
        if not (folder / "run.json").is_file():
            if not is_held(folder / "job.log"):
                raise Problem(f"{folder}: no run is going on, and there are no results")
            return None
        job = read_job(folder)
        try:
            self.tell(line_of(job, read_frame(folder, "history.csv", "phase", "travel", "progress"),
                              read_frame(folder, "status.csv", "phase", "outcome", "seconds")))
        except Problem:  # no rows yet
            self.tell(f"{folder}: has begun")
        return job

    def draw(self, ended: bool) -> None:
        """Draw the sheet, or write the page, where there is a new step or the run has ended."""
        if not (self.picture or self.page) or (now := (Fields(self.folder).count, ended)) == self.drawn:
            return
        if self.page:
            report.make(**self.page)
        if self.picture:
            pictures.make_picture(pictures.Run(self.folder), self.style or pictures.Style(), self.picture)
        self.drawn = now

    def follow(self) -> dict[str, Any]:
        """Watch the run to its end and return its description."""
        while True:
            job = self.look()
            ended = job is not None and job["outcome"]["state"] != "running"
            try:
                self.draw(ended)
            except (Problem, OSError, KeyError, ValueError):
                if ended:
                    raise
                # The fields, or a step of them, are being written: they are drawn at the next look.
            if job is not None and ended:
                return job
            time.sleep(self.every)


def main(words: Sequence[str] | None = None) -> None:
    """Watch the run of the command line."""
    parser = new_parser("watch", __doc__)
    parser.add_argument("run", metavar="RUN", type=Path, help="folder of results")
    parser.add_argument("--every", type=float, default=2.0, metavar="SECONDS", help="time between two looks (2)")
    parser.add_argument("--picture", type=Path, metavar="FILE", help="picture of the last step to write")
    parser.add_argument("--field", default="equivalent_plastic_strain", help="field of the picture")
    parser.add_argument("--page", action="store_true", help="write the page of `dd3 report` at each new step")
    options, others = parser.parse_known_args(words)
    if others and not options.page:
        parser.error(f"unknown argument {others[0]}; the options of `dd3 report` go with --page")
    if not options.every > 0:
        parser.error("--every takes a positive number")
    if not options.run.is_dir():
        raise Problem(f"{options.run}: No such folder")
    page = report.parsed([str(options.run), *others]) if options.page else {}
    page.pop("verdict", None)
    watch = Watch(options.run, options.every, options.picture, pictures.Style(options.field), page)
    job = watch.follow()
    outcome, seconds = job["outcome"], job.get("seconds")
    end = "reached its end" if outcome["state"] == "reached" else f"ended: {outcome['message'] or outcome['state']}"
    watch.tell(f"{watch.said}\n{options.run}: {end}" + (f" after {clock(seconds)}" if seconds else ""))
    if watch.live:
        print()
    if outcome["state"] != "reached":
        sys.exit(1)
