#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"labels": ["case", "debug"]}
"""Test runs that stop early: exit code 3, a message with location and reason, complete results.

    stopped_runs.py --program build/release/dd3imp --work build/stopped
"""
import csv
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import sys

from surroundings import start

from dd3.programs import parser_of_runs

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests"))
from run_description import check_description, read_description  # noqa: E402

BENDING = ROOT / "input_files" / "bending" / "bending.dat"
BEGINNING = ROOT / "tests" / "cases" / "bending_start" / "case.dat"
SLIDING = ROOT / "tests" / "cases" / "friction_above" / "case.dat"
POINT = ROOT / "tests" / "cases" / "point_tension" / "case.dat"
TENSION = ROOT / "tests" / "cases" / "tension_00" / "case.dat"
BETWEEN = ROOT / "tests" / "cases" / "come_and_go" / "case.dat"
SIZE_LIMIT = 1_000_000


def check(condition, text):
    """Exit with a message if a condition is false."""
    if not condition:
        sys.exit(f"FAILED: {text}")


def table(path):
    """Return the rows of a csv file; all must be complete."""
    text = path.read_text(encoding="utf-8")
    check(text.endswith("\n"), f"{path} ends in the middle of a line")
    rows = list(csv.reader(line for line in text.splitlines() if not line.startswith("#")))
    check(all(len(row) == len(rows[0]) for row in rows), f"{path} has incomplete rows")
    return [dict(zip(rows[0], row)) for row in rows[1:]]


def run(program, directory, deck, **options):
    """Run the program, which must stop with exit code 3; return its output."""
    done = subprocess.run([program, "--output", directory, deck], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          text=True, timeout=300, check=False, **options)
    check(done.returncode == 3, f"expected exit code 3, got {done.returncode}:\n{done.stdout}")
    check("dd3imp: stopped E" in done.stdout, f"no message that it stopped:\n{done.stdout}")
    check("Backtrace" not in done.stdout, f"backtrace in the output:\n{done.stdout}")
    return done.stdout


def no_convergence(program, directory):
    """Test a block that slides away: the message names increment, phase and reason; accepted increments are kept."""
    output = run(program, directory, SLIDING)
    accepted = len(table(directory / "history.csv")) - 1
    check(accepted > 0, "no increment was accepted before the run stopped")
    check(f"increment {accepted + 1} of phase 'shear'" in output, f"the increment is not named:\n{output}")
    check("did not converge" in output, f"the reason is not named:\n{output}")
    last = table(directory / "status.csv")[-1]
    check(last["outcome"] == "failed" and last["reason"], f"status.csv ends with {last}")
    check("stopped E" in (directory / "job.log").read_text(encoding="utf-8"), "job.log does not say that it stopped")
    result = check_description(directory, 3)["phases"][-1]["result"]
    check((result["state"], result["last_increment"]) == ("stopped", accepted), f"run.json: the phase is {result}")


def inside_out(program, directory):
    """Test an element inverted in one increment: status.csv names it, without a criterion of convergence."""
    text = TENSION.read_text(encoding="utf-8")
    for old, new in (("strain = 0.001", "strain = off"), ("trial = 0.01", "trial = 1"), ("x_max x 2.3", "x_max x -15"),
                     ("*NEWTON", "*NEWTON\n  cutback = off\n  line_search = off")):
        text = text.replace(old, new)
    deck = directory.with_suffix(".dat")
    deck.write_text(text, encoding="utf-8")
    output = run(program, directory, deck)
    check("stopped E211: " in output and "inside out" in output, f"the reason is not named:\n{output}")
    last = table(directory / "status.csv")[-1]
    check(last["outcome"] == "failed" and last["worst_element"] == "1", f"status.csv ends with {last}")
    check(last["criterion"] == "", f"the criterion is {last['criterion']}")
    check_description(directory, 3)


def free_sheet(program, directory):
    """Test a sheet without support between tools without friction: the message asks for supports."""
    text = BETWEEN.read_text(encoding="utf-8").replace("friction = 0.5", "friction = 0")
    for name in ("table.bez", "ram.bez"):
        text = text.replace(name, str(BETWEEN.with_name(name)))
    supports = text[text.index("*BOUNDARY straight"):text.index("*NEWTON")]
    deck = directory.with_suffix(".dat")
    deck.write_text(text.replace(supports, ""), encoding="utf-8")
    output = run(program, directory, deck)
    check("linear solver: " in output, f"the reason is not named:\n{output}")
    check("supports that stop rigid motion" in output, f"the remedy is another one:\n{output}")


def led_into_tool(program, directory):
    """Test nodes that `displace` leads into a tool: the message names the cause, a node and the tool."""
    text = BETWEEN.read_text(encoding="utf-8")
    for name in ("table.bez", "ram.bez"):
        text = text.replace(name, str(BETWEEN.with_name(name)))
    deck = directory.with_suffix(".dat")
    deck.write_text(text[:text.index("*PHASE")] + "*PHASE lift\n  control = load\n  trial = 0.5\n"
                    "  displace = z_max z 3\n", encoding="utf-8")
    output = run(program, directory, deck)
    check("stopped E242: " in output and "a prescribed motion leads a node" in output,
          f"the reason is another one:\n{output}")
    check(", tool ram; try first" in output, f"the tool is not named:\n{output}")
    check(check_description(directory, 3)["outcome"]["message"] in output, "run.json has another message")


def follow_advice(program, directory):
    """Test that the settings that the messages propose, one after the other, bring a run to its end, none twice."""
    text = BEGINNING.read_text(encoding="utf-8").replace("../../../", f"{ROOT}/").replace("  penalty = 1000\n", "")
    start_of, end_of = text.index("*LIMITS"), text.index("*PHASE clamp")
    text = text[:start_of] + ("*LIMITS\n  strain = off\n  rotation = 40\n  depth = off\n*NEWTON\n  cutback = off\n"
                              "  line_search = off\n  iterations = 3\n") + text[end_of:]
    deck, followed = directory.with_suffix(".dat"), []
    while True:
        deck.write_text(text, encoding="utf-8")
        done = subprocess.run([program, "--quiet", "--output", directory, deck], capture_output=True, text=True, timeout=300,
                              check=False)
        if done.returncode == 0:
            break
        advice = re.search(r"try first: ((\w+) = [^ ,]+) in \*NEWTON", done.stderr)
        check(advice and advice[1] not in followed, f"after {followed}:\n{done.stderr}")
        followed.append(advice[1])
        text = re.sub(rf"(?m)^  {advice[2]} = .*$", f"  {advice[1]}", text)
    check(followed == ["cutback = on", "line_search = on", "iterations = 30"], f"the advice was {followed}")


def small_disk(program, directory):
    """Test a limit of the file size reached in the middle of a phase; what is known of the tools is said."""
    output = run(program, directory, BEGINNING,
                 preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (SIZE_LIMIT, SIZE_LIMIT)))
    check("cannot write" in output, f"the file is not named:\n{output}")
    check("tool 'punch' entered the sheet between its nodes" in output, f"the depth is not named:\n{output}")
    check(len(table(directory / "history.csv")) > 20, "the history is lost")
    table(directory / "status.csv")
    fields = (directory / "fields.vtkhdf").read_bytes()
    check(fields[:4] == b"\x89HDF" and 100_000 < len(fields) <= SIZE_LIMIT, "fields.vtkhdf is incomplete")


def full_disk(program, directory):
    """Test a disk that fills up: both tables contain every accepted increment."""
    inner = 'mount -t tmpfs -o size="$1" none "$2" && shift 2 && "$@"'
    for size in ("1400k", "1450k"):
        disk, copy = directory / size, directory / f"{size}.copy"
        disk.mkdir(parents=True)
        mounted = ["unshare", "--mount", "--map-root-user", "sh", "-c", inner, "sh", size, disk]
        if subprocess.run(mounted + ["true"], stderr=subprocess.DEVNULL, check=False).returncode != 0:
            print("cannot mount a file system of limited size: full_disk is skipped")
            return
        both = '"$1" --output "$2/out" "$3"; code=$?; cp -r "$2/out" "$4"; exit $code'
        done = subprocess.run(mounted + ["sh", "-c", both, "sh", program, disk, BEGINNING, copy],
                              stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=300, check=False)
        check(done.returncode == 3 and "No space left" in done.stdout, f"{done.returncode}:\n{done.stdout}")
        history, status = table(copy / "history.csv"), table(copy / "status.csv")
        increments = [row["increment"] for row in history]
        accepted = [row["increment"] for row in status if row["outcome"] == "accepted"]
        check(increments == ["0"] + accepted, f"history.csv ends at {increments[-1]}, status.csv at {accepted[-1:]}")
        check(len(accepted) > 20, f"only {len(accepted)} increments were accepted")
        check("No space left" in (copy / "job.log").read_text(encoding="utf-8"), "job.log does not contain the reason")


def full_device(program, directory):
    """Test a table on a full device."""
    directory.mkdir(parents=True)
    (directory / "history.csv").symlink_to("/dev/full")
    output = run(program, directory, BENDING)
    check("history.csv" in output and "No space left" in output, f"file and reason are not named:\n{output}")


def no_directory(program, directory):
    """Test a directory that cannot be created."""
    directory.parent.mkdir(parents=True, exist_ok=True)
    directory.write_text("a file", encoding="utf-8")
    output = run(program, directory / "results", BENDING)
    check("cannot create the directory" in output and str(directory) in output,
          f"the directory is not named:\n{output}")


def next_to_old(program, directory):
    """Test a run into the folder of another: the results of the other are removed, with a line in job.log."""
    run(program, directory, SLIDING)
    check((directory / "status.csv").exists(), "status.csv is missing")
    (directory / "own.txt").write_text("the user's", encoding="utf-8")
    done = subprocess.run([program, "--quiet", "--output", directory, POINT], timeout=300, check=False)
    check(done.returncode == 0, f"expected exit code 0, got {done.returncode}")
    left = sorted(path.name for path in directory.iterdir())
    check(left == ["history.csv", "job.log", "own.txt", "run.json"], f"unexpected files: {left}")
    output = (directory / "job.log").read_text(encoding="utf-8")
    check("removed from an earlier run: history.csv status.csv fields.vtkhdf" in output, f"job.log says:\n{output}")


def interrupted(program, directory):
    """Test that Ctrl-C ends the run after the current increment."""
    with start(program, directory, stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as process:
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=60)
    check(process.returncode == 3, f"expected exit code 3, got {process.returncode}:\n{output}")
    last = table(directory / "history.csv")[-1]["increment"]
    check(f"interrupted by the user after increment {last}" in output, f"the last increment is not {last}:\n{output}")
    check(table(directory / "status.csv")[-1]["increment"] == last, "status.csv ends at another increment")
    check((directory / "fields.vtkhdf").read_bytes()[:4] == b"\x89HDF", "fields.vtkhdf is incomplete")
    found = check_description(directory, 3)
    check(found["outcome"]["state"] == "interrupted" and found["outcome"]["code"] == "E201", str(found["outcome"]))
    stopped = [phase["result"] for phase in found["phases"] if phase["result"]["state"] == "interrupted"]
    check([result["last_increment"] for result in stopped] == [int(last)], "run.json ends at another increment")


def initial(program, directory):
    """Test the run.json of --check --initial, also of a tool inside the sheet."""
    directory.mkdir(parents=True)
    deck = directory / "inside.dat"
    deck.write_text(BENDING.read_text(encoding="utf-8").replace('patches = "', f'patches = "{BENDING.parent}/')
                    .replace("*TOOL punch", "*TOOL punch\n  position = 0 0 -0.5"), encoding="utf-8")
    for path, code, state in ((BENDING, 0, "checked"), (deck, 2, "input_error")):
        folder = directory / state
        words = [program, "--check", "--quiet", "--initial", folder, path]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        check(done.returncode == code, f"expected exit code {code}, got {done.returncode}:\n{done.stderr}")
        found = read_description(folder)
        check(found["outcome"]["state"] == state and len(found["errors"]) == (code > 0), f"{state}: {found['outcome']}")
        check(all(error["text"].split(";")[0] in done.stderr for error in found["errors"]), str(found["errors"]))
        check(all(pathlib.Path(tool["patches"]).exists() for tool in found["tools"]), f"{state}: {found['tools']}")


def main():
    """Run all tests."""
    options = parser_of_runs(__doc__).parse_args()
    shutil.rmtree(options.work, ignore_errors=True)
    options.work.mkdir(parents=True)
    for test in (no_convergence, inside_out, free_sheet, led_into_tool, follow_advice, small_disk, full_disk,
                 full_device, no_directory, next_to_old, interrupted, initial):
        test(options.program, options.work.resolve() / test.__name__)
        print(f"passed: {test.__name__}")


if __name__ == "__main__":
    main()
