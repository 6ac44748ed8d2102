"""Runs of dd3imp, its input files and its tables of results. Every script that needs one of them takes it from here.

Needs Python alone. Whatever cannot be used raises a Problem.
"""

import argparse
import csv
import os
import re
import shutil
import signal
import subprocess
import tempfile
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path

from scripts import Problem

ROOT = Path(__file__).resolve().parent.parent
POINTS = "points.dat"  # input file of run_points, as its messages name it


# ---- tables ----------------------------------------------------------------------------------------------------------

def read_text(path):
    """Return the text of a file; bytes that are not UTF-8 are replaced."""
    try:
        text = Path(path).read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        raise Problem(f"{path}: {error.strerror}") from None
    if "\0" in text:
        raise Problem(f"{path}: not a text")
    return text


def read_table(path, *needed):
    """Return the rows of a csv file as dictionaries of stripped texts; lines that begin with # are left out.

    A row that was cut has None in the columns it lacks. The columns `needed` must be there.
    """
    lines = [line for line in read_text(path).splitlines() if line.strip() and not line.lstrip().startswith("#")]
    reader = csv.DictReader(lines, skipinitialspace=True)
    reader.fieldnames = [name.strip() for name in reader.fieldnames or []]
    for name in needed:
        if name not in reader.fieldnames:
            raise Problem(f"{path}: no column '{name}'")
    return [{name: value.strip() if isinstance(value, str) else value for name, value in row.items()} for row in reader]


def is_whole(row):
    """Check that a row has a value for each column and no further ones; the last row of a killed run may not."""
    return None not in row and None not in row.values()


def number(row, column, path):
    """Return a value of a row as a number; `path` names the table in messages."""
    if column not in row:
        raise Problem(f"{path}: there is no column {column}; there are {', '.join(row)}")
    try:
        return float(row[column])
    except (TypeError, ValueError):
        raise Problem(f"{path}: {column} = {row[column]!r} is not a number") from None


def history_file(run):
    """Return the path of history.csv, given it or its folder."""
    path = Path(run)
    return path / "history.csv" if path.is_dir() else path


def read_points(run):
    """Return the rows of a run of single points by point, as numbers; `run` is the folder or its history.csv."""
    path = history_file(run)
    rows = read_table(path)
    if not rows or "point" not in rows[0]:
        raise Problem(f"{path}: not the history of single points")
    points = {}
    for i, row in enumerate(rows, 1):
        try:
            points.setdefault(row.pop("point"), []).append({key: float(value) for key, value in row.items()})
        except (TypeError, ValueError):
            raise Problem(f"{path}: row {i} does not hold a number in each column") from None
    return points


def tools_in(columns):
    """Return the tools of a history, given its columns."""
    return [name.removesuffix("_contacts") for name in columns if name.endswith("_contacts")]


def interpolate(places, values, place):
    """Return a value at a place, linear between two neighbours; None beyond the end."""
    for i in range(1, len(places)):
        if places[i] >= place - 1e-9 and places[i] > places[i - 1]:
            fraction = (place - places[i - 1]) / (places[i] - places[i - 1])
            return values[i - 1] + fraction * (values[i] - values[i - 1])
    return None


@dataclass
class Totals:
    """Sums over status.csv. Iterations of attempts that failed count."""

    increments: int
    cutbacks: int
    iterations: int
    solver_iterations: int


def totals(status):
    """Sum the rows of status.csv."""
    return Totals(sum(row["outcome"] == "accepted" for row in status), sum(row["outcome"] == "retry" for row in status),
                  sum(int(row["iterations"]) for row in status), sum(int(row["solver_iterations"]) for row in status))


def limiters(status, phase):
    """Return the limiter of each accepted increment of a phase."""
    return [row["limiter"] for row in status if row["outcome"] == "accepted" and row["phase"] == phase]


def force_limits(status, phase):
    """Yield travel, node, tool and B (N) of the limit on the contact forces in the increments of a phase."""
    for row in status:
        if row["force_node"] and row["phase"] == phase:
            yield float(row["travel"]), int(row["force_node"]), row["force_tool"], float(row["force_size"])


def time_by_section(folder, sections):
    """Return the seconds of each section from the end of job.log; 0 for one that is not there."""
    _, _, tail = read_text(Path(folder) / "job.log").partition("time by section")
    words = dict(line.split()[:2] for line in tail.splitlines()[1:] if len(line.split()) == 2)
    return {name: float(words.get(name, 0)) for name in sections}


# ---- input files -----------------------------------------------------------------------------------------------------

@dataclass
class Block:
    """A keyword block: keyword and keys in small letters, its name as written, the folder its paths are relative to."""

    keyword: str
    name: str
    folder: Path
    values: list = field(default_factory=list)  # pairs of key and value, in their order

    def value(self, key):
        """Return the last value of a key, None if it is not given."""
        return next((value for name, value in reversed(self.values) if name == key), None)


def without_comment(line):
    """Return a line of an input file without its comment."""
    return re.sub(r"[#!].*", "", line).strip()


def deck_lines(path, parents=()):
    """Yield the lines of an input file and of those it includes, each with its folder; no comments, no empty lines."""
    path = Path(path)
    for line in re.sub(r"&[ \t]*\n", " ", read_text(path)).splitlines():
        line = without_comment(line)
        include = re.match(r"\*include\s+(.*)", line, re.IGNORECASE)
        if include:
            file = path.parent / include[1].strip("\"'")
            if file not in (*parents, path):  # the program refuses a ring
                yield from deck_lines(file, (*parents, path))
        elif line:
            yield line, path.parent


def read_deck(path, settings=None):
    """Return the blocks of an input file, with its includes and parameters put in; `settings` are those of --set."""
    return blocks_of(deck_lines(path), settings)


def echo_in(log):
    """Return the lines of job.log before the input that it repeats, with all values that the run used, and those lines.

    `log` is the text.
    """
    lines = log.splitlines()
    first = next((i for i, line in enumerate(lines) if line.startswith("*")), len(lines))
    last = next((i for i, line in enumerate(lines[first:], first) if not line.startswith(("*", " "))), len(lines))
    return lines[:first], lines[first:last]


def read_echo(log, folder):
    """Return the blocks of the input that a log repeats; their paths are taken as relative to a folder."""
    return blocks_of((without_comment(line), folder) for line in echo_in(log)[1])


def run_blocks(deck, log, settings, chosen):
    """Return the blocks that `chosen` accepts with the values that a run used.

    They are those of its log, the folders of relative paths from the input file. Without a log they are those of the
    input file with the settings of --set.
    """
    written = list(filter(chosen, read_deck(deck, settings)))
    used = list(filter(chosen, read_echo(read_text(log), deck.parent))) if log.is_file() else []
    if len(used) != len(written):
        return written
    for block, original in zip(used, written):
        block.folder = original.folder
    return used


def blocks_of(lines, settings=None):
    """Return the blocks of lines with their folders, the parameters put in."""
    settings = {name.lower(): value for name, value in (settings or {}).items()}
    blocks, parameters = [], dict(settings)
    for line, folder in lines:
        if line.startswith("*"):
            keyword, *name = line[1:].split(None, 1)
            blocks.append(Block(keyword.lower(), "".join(name), folder))
        elif blocks:
            key, _, value = (part.strip() for part in line.partition("="))
            value = re.sub(r"\$\{(\w+)\}", lambda found: parameters.get(found[1].lower(), found[0]), value)
            blocks[-1].values.append((key.lower(), value))
            if blocks[-1].keyword == "parameter":
                parameters.setdefault(key.lower(), value)
    return blocks


# ---- runs ------------------------------------------------------------------------------------------------------------

@dataclass
class Finished:
    """A run that has ended: exit code, what it printed, seconds and largest memory (MB)."""

    code: int
    output: str
    errors: str
    wall: float
    cpu: float
    memory: float


def find_program(path):
    """Return the program's absolute path; it is looked up as the shell does."""
    found = shutil.which(path)
    if not found:
        raise Problem(f"{path}: no such program; give --program FILE")
    return Path(found).resolve()


def made_folder(path):
    """Return the path of a folder, which is made if it is not there."""
    path = Path(path)
    path.mkdir(parents=True, exist_ok=True)
    return path


def parser_of_runs(description):
    """Return the parser of a script that makes runs: `program`, looked up, and `work`, the folder of the runs."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, type=find_program, help="the program dd3imp")
    parser.add_argument("--work", required=True, type=made_folder, help="folder of the runs")
    return parser


def command(program, deck, folder=None, options=(), settings=None):
    """Return the words of a run: results go to `folder`, `settings` are the parameters of --set."""
    words = [str(program), *map(str, options)] + (["--output", str(folder)] if folder else [])
    for name, value in (settings or {}).items():
        words += ["--set", f"{name}={value}"]
    return [*words, str(deck)]


def launch(words, timeout=None, folder=None, one_core=True):
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
    return Finished(child.returncode, *said, wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)


def wait(child, timeout):
    """Wait for a process and return its use of resources; kill it after `timeout` seconds or on an interrupt."""
    late = threading.Event()
    timer = threading.Timer(timeout or 0, lambda: (late.set(), os.kill(child.pid, signal.SIGKILL)))
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
        raise Problem(f"{' '.join(map(str, child.args))}: not finished after {timeout} s")
    return usage


def run_points(program, text, *options, timeout=None):
    """Run an input file of single points, given as a text; return the finished run and its rows by point."""
    program = find_program(program)
    with tempfile.TemporaryDirectory() as name:
        deck, folder = Path(name) / POINTS, Path(name) / "out"
        deck.write_text(text, encoding="utf-8")
        done = launch(command(program, deck, folder, ["--quiet", *options]), timeout)
        done.errors = done.errors.replace(str(deck), POINTS)
        written = (folder / "history.csv").is_file()
        if done.code not in (0, 2, 3) or done.code == 0 and not written and "--check" not in options:
            raise Problem(f"{program}: error: exit code {done.code}, and no results\n"
                          "  expected: --program with the path of dd3imp")
        return done, read_points(folder) if done.code == 0 and written else {}
