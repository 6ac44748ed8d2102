# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of dd3imp: the program, its command line, single points."""

import argparse
import os
import shutil
import signal
import subprocess
import tempfile
import threading
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dd3 import places
from dd3.errors import Problem
from dd3.run import read_job
from dd3.tables import read_points

if TYPE_CHECKING:
    import resource

# Environment of mpirun, which refuses root, and more processes than processors, unless it is asked not to.
MPI_ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                   "OMPI_MCA_rmaps_base_oversubscribe": "1"}
POINTS = "points.dat"  # input file of run_points, as its messages name it
SMALL = """*MATERIAL steel
  young = 2e5
  poisson = 0.3
  yield = von_mises
  hardening = perfect Y0=200
*POINT pulled
  material = steel
  control = e11 s22 s33 s12 s23 s13
  target = 1e-3 0 0 0 0 0 steps=1
"""


@dataclass
class Finished:
    """A run that has ended: exit code, what it printed, seconds and largest memory (MB); of single points, run.json."""

    code: int
    output: str
    errors: str
    wall: float
    cpu: float
    memory: float
    job: dict[str, Any] = field(default_factory=dict)


def find_program(path: str | Path) -> Path:
    """Return the program's absolute path; it is looked up as the shell does."""
    found = shutil.which(path)
    if not found:
        raise Problem(f"{path}: no such program; give --program FILE")
    return Path(found).resolve()


def add_program(parser: argparse.ArgumentParser) -> None:
    """Add the option --program: by default the program that belongs to this package, else the one on the path."""
    parser.add_argument("--program", default=places.program(), metavar="FILE",
                        help="the program (default: dd3imp as `dd3 info` shows it)")


def made_folder(path: str | Path) -> Path:
    """Return the path of a folder, which is made if it is not there."""
    path = Path(path)
    path.mkdir(parents=True, exist_ok=True)
    return path


def parser_of_runs(description: str | None) -> argparse.ArgumentParser:
    """Return the parser of a script that makes runs: `program`, looked up, and `work`, the folder of the runs."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, type=find_program, help="the program dd3imp")
    parser.add_argument("--work", required=True, type=made_folder, help="folder of the runs")
    return parser


def setting(text: str) -> tuple[str, str]:
    """Return name and value of an argument of --set."""
    name, equals, value = text.partition("=")
    if not equals:
        raise argparse.ArgumentTypeError("takes NAME=VALUE")
    return name, value


def command(program: str | Path, deck: str | Path, folder: str | Path | None = None, options: Iterable[object] = (),
            settings: Mapping[str, object] | None = None) -> list[str]:
    """Return the words of a run: results go to `folder`, `settings` are the parameters of --set."""
    words = [str(program), *map(str, options)] + (["--output", str(folder)] if folder else [])
    for name, value in (settings or {}).items():
        words += ["--set", f"{name}={value}"]
    return [*words, str(deck)]


def launch(words: Sequence[str | Path], timeout: float | None = None, folder: str | Path | None = None,
           one_core: bool = True) -> Finished:
    """Run a command to its end, in a folder; a Problem after `timeout` seconds.

    With `one_core` it takes one thread unless its own options ask for more.
    """
    environment = {**os.environ, **({"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"} if one_core else {})}
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        began = time.perf_counter()
        child = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=output, stderr=errors, env=environment,
                                 cwd=folder)
        usage = wait(child, timeout)
        wall = time.perf_counter() - began
        said = []
        for stream in (output, errors):
            stream.seek(0)
            said.append(stream.read().decode("utf-8", errors="replace"))
    return Finished(child.returncode, said[0], said[1], wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)


def wait(child: "subprocess.Popen[bytes]", timeout: float | None) -> "resource.struct_rusage":
    """Wait for a process and return its use of resources; kill it after `timeout` seconds or on an interrupt."""
    late, shown = threading.Event(), " ".join(map(str, child.args)) if isinstance(child.args, list) else str(child.args)

    def kill() -> None:
        late.set()
        os.kill(child.pid, signal.SIGKILL)

    timer = threading.Timer(timeout or 0, kill)
    if timeout:
        timer.start()
    try:
        _, status, usage = os.wait4(child.pid, 0)
    except BaseException:
        child.kill()
        child.wait()
        raise
    finally:
        timer.cancel()
    child.returncode = os.waitstatus_to_exitcode(status)
    if late.is_set():
        raise Problem(f"{shown}: not finished after {timeout} s")
    return usage


def run_points(program: str | Path, text: str, *options: str, timeout: float | None = None
               ) -> tuple[Finished, dict[str, list[dict[str, float]]]]:
    """Run an input file of single points, given as a text; return the finished run and its rows by point."""
    program = find_program(program)
    with tempfile.TemporaryDirectory() as name:
        deck, folder = Path(name) / POINTS, Path(name) / "out"
        deck.write_text(text, encoding="utf-8")
        done = launch(command(program, deck, folder, ["--quiet", *options]), timeout)
        done.errors = done.errors.replace(str(deck), POINTS)
        written = (folder / "history.csv").is_file()
        if done.code not in (0, 2, 3) or (done.code == 0 and not written and "--check" not in options):
            raise Problem(f"{program}: error: exit code {done.code}, and no results\n"
                          "  expected: --program with the path of dd3imp")
        done.job = read_job(folder) if written else {}
        return done, read_points(folder) if done.code == 0 and written else {}


def description(program: str | Path, threads: int = 1) -> dict[str, Any]:
    """Return the run.json of a small job: what a program says of itself and of the machine."""
    return run_points(program, SMALL, "--threads", str(threads))[0].job
