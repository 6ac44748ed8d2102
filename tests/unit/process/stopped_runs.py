#!/usr/bin/env python3
"""Runs that stop before the end: exit code 3, a message that says where and why, and results that are whole.

    stopped_runs.py --program build/release/dd3imp --work build/stopped
"""
import argparse
import csv
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[3]
BENDING = ROOT / "input_files" / "bending" / "bending.dat"
BEGINNING = ROOT / "tests" / "cases" / "bending_start" / "case.dat"
SLIDING = ROOT / "tests" / "cases" / "friction_above" / "case.dat"
POINT = ROOT / "tests" / "cases" / "point_tension" / "case.dat"
TENSION = ROOT / "tests" / "cases" / "tension_00" / "case.dat"
SIZE_LIMIT = 750_000


def check(condition, text):
    """Stops the test where something is not as it should be."""
    if not condition:
        sys.exit(f"FAILED: {text}")


def table(path):
    """The rows of a csv file, each complete."""
    text = path.read_text(encoding="utf-8")
    check(text.endswith("\n"), f"{path} ends in the middle of a line")
    rows = list(csv.reader(line for line in text.splitlines() if not line.startswith("#")))
    check(all(len(row) == len(rows[0]) for row in rows), f"{path} has incomplete rows")
    return [dict(zip(rows[0], row)) for row in rows[1:]]


def run(program, directory, deck, **options):
    """Runs the program to its end; returns what it said."""
    done = subprocess.run([program, "--output", directory, deck], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, timeout=300, check=False, **options)
    check(done.returncode == 3, f"exit code {done.returncode} in place of 3:\n{done.stdout}")
    check("dd3imp: stopped: " in done.stdout, f"no word that it stopped:\n{done.stdout}")
    check("Backtrace" not in done.stdout, f"a backtrace:\n{done.stdout}")
    return done.stdout


def no_convergence(program, directory):
    """A block that slides away: the message names increment, phase and cause; the tables hold what was accepted."""
    said = run(program, directory, SLIDING)
    accepted = len(table(directory / "history.csv")) - 1
    check(accepted > 0, "nothing was accepted before the run stopped")
    check(f"increment {accepted + 1} of phase 'shear'" in said, f"the increment is not named:\n{said}")
    check("did not converge" in said, f"the cause is not named:\n{said}")
    last = table(directory / "status.csv")[-1]
    check(last["outcome"] == "failed" and last["reason"], f"status.csv ends with {last}")
    check("stopped: " in (directory / "job.log").read_text(encoding="utf-8"), "job.log does not say that it stopped")


def inside_out(program, directory):
    """An element pushed through itself in one increment: status.csv says where; there is no criterion to tell of."""
    text = TENSION.read_text(encoding="utf-8")
    for old, new in (("strain = 0.001", "strain = off"), ("trial = 0.01", "trial = 1"), ("x_max x 2.3", "x_max x -15")):
        text = text.replace(old, new)
    deck = directory.with_suffix(".dat")
    deck.write_text(text, encoding="utf-8")
    said = run(program, directory, deck)
    check("inside out" in said, f"the cause is not named:\n{said}")
    last = table(directory / "status.csv")[-1]
    check(last["outcome"] == "failed" and last["worst_element"] == "1", f"status.csv ends with {last}")
    check(last["criterion"] == "", f"the criterion is {last['criterion']}")


def small_disk(program, directory):
    """No more room in the middle of the run."""
    said = run(program, directory, BEGINNING,
               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (SIZE_LIMIT, SIZE_LIMIT)))
    check("cannot write" in said, f"the file is not named:\n{said}")
    check(len(table(directory / "history.csv")) > 20, "the history is lost")
    table(directory / "status.csv")
    fields = (directory / "fields.vtkhdf").read_bytes()
    check(fields[:4] == b"\x89HDF" and 100_000 < len(fields) <= SIZE_LIMIT, "fields.vtkhdf is not whole")


def full_disk(program, directory):
    """A small disk that fills up: every increment that was done can be read, in both tables."""
    inner = 'mount -t tmpfs -o size="$1" none "$2" && shift 2 && "$@"'
    for size in ("1300k", "1500k"):
        disk, copy = directory / size, directory / f"{size}.copy"
        disk.mkdir(parents=True)
        mounted = ["unshare", "--mount", "--map-root-user", "sh", "-c", inner, "sh", size, disk]
        if subprocess.run(mounted + ["true"], stderr=subprocess.DEVNULL, check=False).returncode != 0:
            print("no file system of a given size can be made here: full_disk is left out")
            return
        both = '"$1" --output "$2/out" "$3"; code=$?; cp -r "$2/out" "$4"; exit $code'
        done = subprocess.run(mounted + ["sh", "-c", both, "sh", program, disk, BENDING, copy], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=300, check=False)
        check(done.returncode == 3 and "No space left" in done.stdout, f"{done.returncode}:\n{done.stdout}")
        history, status = table(copy / "history.csv"), table(copy / "status.csv")
        increments = [row["increment"] for row in history]
        accepted = [row["increment"] for row in status if row["outcome"] == "accepted"]
        check(increments == ["0"] + accepted, f"history.csv ends at {increments[-1]}, status.csv at {accepted[-1:]}")
        check(len(accepted) > 20, f"no room for more than {len(accepted)} increments")
        check("No space left" in (copy / "job.log").read_text(encoding="utf-8"), "job.log does not say why it stopped")


def full_device(program, directory):
    """A table that cannot be written at all."""
    directory.mkdir(parents=True)
    (directory / "history.csv").symlink_to("/dev/full")
    said = run(program, directory, BENDING)
    check("history.csv" in said and "No space left" in said, f"file and cause are not named:\n{said}")


def no_directory(program, directory):
    """A directory that cannot be made."""
    directory.parent.mkdir(parents=True, exist_ok=True)
    directory.write_text("a file", encoding="utf-8")
    said = run(program, directory / "results", BENDING)
    check("cannot create the directory" in said and str(directory) in said, f"the directory is not named:\n{said}")


def next_to_old(program, directory):
    """A run into the folder of another: nothing of the other is left, and job.log tells of it."""
    run(program, directory, SLIDING)
    check((directory / "status.csv").exists(), "there is no status.csv")
    (directory / "own.txt").write_text("the user's", encoding="utf-8")
    done = subprocess.run([program, "--quiet", "--output", directory, POINT], timeout=300, check=False)
    check(done.returncode == 0, f"exit code {done.returncode} in place of 0")
    left = sorted(path.name for path in directory.iterdir())
    check(left == ["history.csv", "job.log", "own.txt"], f"there are {left}")
    said = (directory / "job.log").read_text(encoding="utf-8")
    check("removed from an earlier run: history.csv status.csv fields.vtkhdf" in said, f"job.log says:\n{said}")


def interrupted(program, directory):
    """Control-C ends the run after the increment in hand."""
    with subprocess.Popen([program, "--output", directory, BENDING], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True) as process:
        until = time.monotonic() + 60
        while not (directory / "status.csv").exists() and time.monotonic() < until:
            time.sleep(0.05)
        time.sleep(0.5)
        process.send_signal(signal.SIGINT)
        said, _ = process.communicate(timeout=60)
    check(process.returncode == 3, f"exit code {process.returncode} in place of 3:\n{said}")
    last = table(directory / "history.csv")[-1]["increment"]
    check(f"interrupted by the user after increment {last}" in said, f"the last increment is not {last}:\n{said}")
    check(table(directory / "status.csv")[-1]["increment"] == last, "status.csv ends elsewhere")
    check((directory / "fields.vtkhdf").read_bytes()[:4] == b"\x89HDF", "fields.vtkhdf is not whole")


def main():
    """Runs all of them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=pathlib.Path, required=True, help="the program dd3imp")
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for the results; it is emptied")
    options = parser.parse_args()
    shutil.rmtree(options.work, ignore_errors=True)
    options.work.mkdir(parents=True)
    for test in (no_convergence, inside_out, small_disk, full_disk, full_device, no_directory, next_to_old, interrupted):
        test(options.program.resolve(), options.work.resolve() / test.__name__)
        print(f"passed: {test.__name__}")


if __name__ == "__main__":
    main()
