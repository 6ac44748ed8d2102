# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs of dd3imp for the tests of restart: decks with changes, runs that are killed, comparison of results."""
import csv
import os
import pathlib
import resource
import shutil
import subprocess
import sys
import time

try:
    import h5py
    import numpy
except ModuleNotFoundError as missing:
    print(f"skipped: {missing.name} is not installed")
    sys.exit(77)

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE.parent))
from run_description import check_description  # noqa: E402

RECORDS = ("history.csv", "status.csv", "fields.vtkhdf", "restart.h5")
LONGEST = 300


class Failure(Exception):
    """A check that failed."""


def check(condition, text):
    """Fail with a text unless a condition holds."""
    if not condition:
        raise Failure(text)


class Deck:
    """An input file of this folder with some of its text replaced and what follows `end` left out."""

    def __init__(self, path, *changes, source="forming.dat", end=None):
        text = (HERE / source).read_text(encoding="utf-8")
        text = text.replace('patches = "', f'patches = "{HERE}/')
        for old, new in changes:
            check(text.count(old) == 1, f"{source}: '{old}' occurs {text.count(old)} times")
            text = text.replace(old, new)
        if end:
            text = text[:text.index(end)]
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        self.path = path


class Runner:
    """Starts the program."""

    def __init__(self, program):
        self.program = str(pathlib.Path(program).resolve())

    def command(self, deck, output, restart=None, settings=(), arguments=()):
        """Words of a command line."""
        words = [self.program, "--output", str(output), *arguments]
        for setting in settings:
            words += ["--set", setting]
        if restart:
            words += ["--restart", str(restart)]
        return words + [str(deck.path)]

    def run(self, deck, output, restart=None, expect=0, settings=(), arguments=(), **options):
        """Run to the end; return what was printed."""
        done = subprocess.run(self.command(deck, output, restart, settings, arguments), stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=LONGEST, check=False, **options)
        check(done.returncode == expect, f"exit code {done.returncode} instead of {expect}:\n{done.stdout}")
        check("Backtrace" not in done.stdout, f"backtrace:\n{done.stdout}")
        if expect == 0 and "--check" not in arguments:
            check_description(pathlib.Path(options.get("cwd", "."), output), expect)
        return done.stdout

    def stop(self, number, when, deck, output, restart=None, settings=(), arguments=()):
        """Start and send a signal as soon as `when(seconds)` holds, of processor time; return the exit code."""
        command = self.command(deck, output, restart, settings, arguments)
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
            clock = ~process.pid << 3 | 2  # of its processor time, as by clock_getcpuclockid of Linux
            while process.poll() is None:
                if when(time.clock_gettime(clock)):
                    process.send_signal(number)
                    break
            process.wait(timeout=LONGEST)
        return process.returncode


def restart_of(output):
    """The restart file of a folder; None if none was written yet."""
    path = output / "restart.h5"
    return path if path.exists() else None


def identity(path):
    """What changes when a file is replaced; None without a file."""
    try:
        status = os.stat(path)
    except FileNotFoundError:
        return None
    return status.st_ino, status.st_mtime_ns


def seconds_of_runs():
    """Return the processor time of all runs that have ended, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def after(instant):
    """Condition: a processor time of the run, s. Polled in steps of a millisecond."""
    def when(seconds):
        if seconds >= instant:
            return True
        time.sleep(0.001)
        return False
    return when


def replaced(path, times=1):
    """Condition: a file has just been replaced for the n-th time."""
    seen = [identity(path)]

    def when(_):
        now = identity(path)
        if now != seen[-1]:
            seen.append(now)
        return len(seen) > times
    return when


def being_written(output, instant):
    """Condition: the restart file is being written, after an instant."""
    part = str(output / "restart.h5.part")
    if os.path.exists(part):
        os.remove(part)
    return lambda seconds: seconds >= instant and os.path.exists(part)


def growing(path, instant):
    """Condition: a file is written to after an instant."""
    last = []

    def when(seconds):
        now = identity(path)
        if seconds < instant or now is None:
            return False
        last.append(now)
        return now != last[0]
    return when


def table(path):
    """Rows of a csv file as dictionaries; each is complete."""
    text = path.read_text(encoding="utf-8")
    check(text.endswith("\n"), f"{path} ends in the middle of a line")
    rows = list(csv.reader(line for line in text.splitlines() if not line.startswith("#")))
    check(all(len(row) == len(rows[0]) for row in rows), f"{path} has incomplete rows")
    return [dict(zip(rows[0], row)) for row in rows[1:]]


def hdf5(path):
    """All datasets and attributes of a file by name, as types, shapes and bytes.

    The chunks of fields of several meshes are those of the mesh with which the file was begun.
    """
    found = {}
    with h5py.File(path, "r") as file:
        meshes = file["VTKHDF/NumberOfCells"].size if "VTKHDF" in file else 1

    def add(name, item):
        if isinstance(item, h5py.Dataset):
            chunks = item.chunks if meshes == 1 else None
            found[name] = (str(item.dtype), item.shape, chunks, item[()].tobytes())
        for key, value in item.attrs.items():
            value = numpy.asarray(value)
            found[f"{name}@{key}"] = (str(value.dtype), value.shape, value.tobytes())
    with h5py.File(path, "r") as file:
        add("", file)
        file.visititems(add)
    return found


def compare_hdf5(got, expected, skip=()):
    """Fail unless two files hold the same."""
    left, right = hdf5(got), hdf5(expected)
    names = [name for name in sorted(set(left) | set(right)) if left.get(name) != right.get(name) and name not in skip]
    check(not names, f"{got} differs from {expected} in {', '.join(names)}")


def compare_status(got, expected):
    """Fail unless two status tables are equal but for the times."""
    left, right = table(got), table(expected)
    for row in left + right:
        row.pop("seconds")
    check(len(left) == len(right), f"{got} has {len(left)} rows, {expected} {len(right)}")
    for number, (one, other) in enumerate(zip(left, right), 1):
        names = [name for name in one if one[name] != other[name]]
        check(not names, f"{got}: row {number} differs from {expected} in {', '.join(names)}")


def compare(got, expected, records=RECORDS, skip=()):
    """Fail unless the records of two folders are the same."""
    if "history.csv" in records:
        check((got / "history.csv").read_bytes() == (expected / "history.csv").read_bytes(),
              f"history.csv of {got} differs from that of {expected}")
    if "status.csv" in records:
        compare_status(got / "status.csv", expected / "status.csv")
    for name in ("fields.vtkhdf", "restart.h5"):
        if name in records:
            compare_hdf5(got / name, expected / name, skip)


def fresh(path):
    """An empty folder."""
    shutil.rmtree(path, ignore_errors=True)
    path.mkdir(parents=True)
    return path


def call_tests(tests):
    """Call tests by name; print the time of each, and all failures."""
    failed = 0
    for name, test in tests:
        began = time.monotonic()
        try:
            test()
            print(f"passed: {name} ({time.monotonic() - began:.1f} s)", flush=True)
        except (Failure, subprocess.TimeoutExpired) as failure:
            failed += 1
            print(f"FAILED: {name}: {failure}", flush=True)
    return 1 if failed else 0
