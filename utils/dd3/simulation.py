# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of the program from Python."""

import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from dd3 import places
from dd3.deck import Deck, text_of
from dd3.errors import LOG, InputError, Problem, Stopped
from dd3.programs import command, find_program
from dd3.run import Run, read_frame, read_job

LOOKS = 0.05, 1.0  # seconds between two looks at a run, at its start and later


def simulate(deck: str | Path | Deck, set: Mapping[str, Any] | None = None, *, threads: int | None = None,
             output: str | Path | None = None, restart: str | Path | None = None,
             progress: bool | Callable[[float], object] = False, program: str | Path | None = None) -> Run:
    """Run an input file to its end; return the run.

    deck: the input file, or one read by `dd3.deck.read` and written. set: values of its parameters (*PARAMETER) by
    their names. threads: at most (all processors). output: folder of the results (that of the input file, with the
    ending .out). restart: the restart file of a run to continue. progress: True for a bar on stderr, or a function that
    is called with the fraction of the phases that is done. program: the program dd3imp (as `dd3 info` shows it).

    Raises InputError with all errors of the input; nothing is computed then. Raises Stopped where the run stops before
    its end; the results up to there are in its `run`. Ctrl-C, or the interruption of a notebook, stops the program
    after its current iteration, with complete results and a restart file, and then raises KeyboardInterrupt.
    """
    if isinstance(deck, Deck):
        if deck.path is None or deck.changed:
            raise Problem("the input file was changed since it was read: write it first, by deck.write(path)")
        deck = deck.path
    if threads is not None and (not isinstance(threads, int) or threads < 1):
        raise Problem(f"threads takes a number of at least 1, not {threads!r}")
    deck = Path(deck)
    folder = Path(output) if output else deck.with_suffix(".out")
    options: list[object] = ["--quiet", *(["--threads", threads] if threads else []),
                             *(["--restart", restart] if restart else [])]
    words = command(find_program(program or places.program()), deck, folder, options,
                    {name: text_of(value) for name, value in (set or {}).items()})
    from dd3.progress import Progress  # here, as results are read without tqdm
    bar = Progress(deck.name, shown=True) if progress is True else None
    try:
        code, said = follow(words, folder, bar or (progress if callable(progress) else None))
    finally:
        if bar:
            bar.end()
    if code == 2:
        raise InputError(said)
    if code == 3:
        raise Stopped(said, Run(folder))
    if code != 0:
        raise Problem(f"{words[0]}: exit code {code}\n{said}")
    return Run(folder)


def follow(words: list[str], folder: Path, tell: Callable[[float], object] | None) -> tuple[int, str]:
    """Run a command; return its exit code and its errors. On an interrupt it is asked to stop, and waited for."""
    with tempfile.TemporaryFile() as errors:
        began = time.time()
        child = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=errors)
        try:
            pause, limit = LOOKS
            while child.poll() is None:
                time.sleep(pause)
                pause = min(1.5 * pause, limit)
                if tell and (done := fraction(folder, began)) is not None:
                    tell(done)
        except BaseException:
            # The terminal sends SIGINT to the program too, and a second one would end it at once.
            child.send_signal(signal.SIGTERM)
            LOG.info("stopping the run after its current iteration; its results are in %s", folder)
            child.wait()
            raise
        if tell and child.returncode == 0:
            tell(1.0)
        errors.seek(0)
        return child.returncode, errors.read().decode("utf-8", errors="replace").strip()


def fraction(folder: Path, began: float) -> float | None:
    """Return the part of the phases of a run that is done; None while a run that began at a time has no rows."""
    table = folder / "history.csv"
    try:
        if table.stat().st_mtime < began - 1:  # of an earlier run
            return None
        last, phases = read_frame(folder, "history.csv", "phase", "progress").iloc[-1], read_job(folder)["phases"]
    except (OSError, Problem, IndexError):  # not there yet, or being written
        return None
    names = [phase["name"] for phase in phases]
    if last["phase"] not in names:
        return None
    return float((names.index(last["phase"]) + last["progress"]) / len(names))
