#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {}
"""Test runs whose surroundings fail: signals, a closed output, a folder removed or shared, inputs where results go.

    surroundings.py --program build/release/dd3imp --work build/surroundings [name of a test ...]
"""
import csv
import json
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

from dd3.programs import parser_of_runs

ROOT = pathlib.Path(__file__).resolve().parents[3]
FOLDER = ROOT / "input_files" / "bending"
BENDING = FOLDER / "bending.dat"
TENSION = ROOT / "tests" / "cases" / "tension_00" / "case.dat"
# Increments of a thousandth of those tried: a test stops the run long before its end.
ENDLESS = ("--set", "strain=1e-9")
# Uniaxial tension of a point in many steps: rows come faster than they are written.
POINT = """*MATERIAL steel
  young = 2.1e5
  poisson = 0.3
  yield = von_mises
  hardening = swift K=565 e0=0.007117 n=0.259
*POINT tension
  material = steel
  control = e11 s22 s33 s12 s23 s13
  target = 0.3 0 0 0 0 0 steps=3000000
"""
# A block whose factors need much more memory than its matrix.
BLOCK = """*BLANK block
  size = 18 18 18
  divisions = 18 18 18
  material = steel
*MATERIAL steel
  young = 2.1e5
  poisson = 0.3
  yield = von_mises
  hardening = perfect Y0=1e4
*BOUNDARY bottom
  set = z_min
  fix = x y z
*PHASE pull
  control = load
  trial = 1
  displace = z_max z 0.001
*SOLVER
  method = umfpack
"""


def check(condition, text):
    """Exit with a message if a condition is false."""
    if not condition:
        sys.exit(f"FAILED: {text}")


def rows(path, killed=False):
    """Return the rows of a csv file; all must be complete, but for the last one of a run that was killed: the system
    may cut a write at the end of a page."""
    text = path.read_text(encoding="utf-8")
    if killed:
        text = text[:text.rfind("\n") + 1]
    check(text.endswith("\n"), f"{path} ends in the middle of a line: {text[-60:]!r}")
    found = list(csv.reader(line for line in text.splitlines() if not line.startswith("#")))
    check(all(len(row) == len(found[0]) for row in found), f"{path} has incomplete rows")
    return found[1:]


def start(program, directory, deck=BENDING, settings=ENDLESS, **options):
    """Start a run that does not end by itself; return it once rows of increments have been written."""
    directory.parent.mkdir(parents=True, exist_ok=True)
    options = {"stdout": subprocess.DEVNULL, "stderr": subprocess.PIPE, **options}
    process = subprocess.Popen([program, "--output", directory, *settings, deck], text=True, **options)
    wait_for_rows(process, directory)
    return process


def wait_for_rows(process, directory, times=4):
    """Wait until the history of a run has grown so many times; the run must not end before."""
    path, size = directory / "history.csv", 0
    while times > 0:
        check(process.poll() is None, f"the run ended early: {process.returncode}")
        now = path.stat().st_size if path.exists() else 0
        times -= now > size
        size = max(size, now)
        time.sleep(0.005)


def finish(process, code):
    """Wait for the end of a run; return what it wrote on the error stream."""
    _, errors = process.communicate(timeout=60)
    check(process.returncode == code, f"expected exit code {code}, got {process.returncode}:\n{errors}")
    return errors


def said(directory, text):
    """Check that job.log contains a text."""
    log = (directory / "job.log").read_text(encoding="utf-8")
    check(text in log, f"job.log does not contain {text!r}:\n{log}")


def signals(program, directory):
    """Test that each signal ends the run after the current increment, with a restart file, and is named in job.log."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGPIPE):
        output = directory / number.name
        process = start(program, output)
        process.send_signal(number)
        errors = finish(process, 3)
        check("interrupted" in errors, f"{number.name}: it says {errors}")
        last = rows(output / "history.csv")[-1][0]
        said(output, f" after increment {last}")
        said(output, "the user" if number == signal.SIGINT else number.name)
        check((output / "restart.h5").exists(), f"{number.name}: no restart file")


def kept_signals(program, directory):
    """Test that SIGHUP stays ignored under nohup."""
    process = start(program, directory, preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    process.send_signal(signal.SIGHUP)
    wait_for_rows(process, directory)
    process.send_signal(signal.SIGTERM)
    finish(process, 3)


def closed_output(program, directory):
    """Test a reader of the output that goes away: the records are complete."""
    for stream in ("stdout", "both"):
        output = directory / stream
        reading, writing = os.pipe()
        errors = writing if stream == "both" else subprocess.PIPE
        process = start(program, output, settings=(), stdout=writing, stderr=errors)
        os.close(writing)
        os.close(reading)
        finish(process, 3)
        said(output, f" after increment {rows(output / 'history.csv')[-1][0]}")
        check((output / "restart.h5").exists(), "no restart file")


def killed(program, directory):
    """Test SIGKILL: rows are written while the run goes on, all whole but the last, and job.log is not empty."""
    directory.mkdir(parents=True)
    deck = directory / "point.dat"
    deck.write_text(POINT, encoding="utf-8")
    for i in range(5):
        output = directory / f"point-{i}"
        process = start(program, output, deck, ())
        wait_for_rows(process, output, 10 * i)
        process.kill()
        finish(process, -signal.SIGKILL)
        check(len(rows(output / "history.csv", killed=True)) > 100, "the rows are lost")
        said(output, "point.dat")
    for i in range(3):
        output = directory / f"bending-{i}"
        process = start(program, output)
        process.kill()
        finish(process, -signal.SIGKILL)
        check(len(rows(output / "history.csv", killed=True)) > 1, "the rows are lost")
        rows(output / "status.csv", killed=True)
        said(output, "phase 1 of")


def vanished_folder(program, directory):
    """Test a folder of results that is removed, or moved and replaced, during the run: exit code 3."""
    for way in ("removed", "replaced"):
        output = directory / way
        process = start(program, output)
        if way == "removed":
            shutil.rmtree(output)
        else:
            output.rename(directory / "moved")
            output.mkdir()
        errors = finish(process, 3)
        check("was removed or replaced" in errors and str(output) in errors, f"it says {errors}")


def shared_folder(program, directory):
    """Test a second run into the folder of a run: refused, and the first one is not disturbed."""
    process = start(program, directory)
    done = subprocess.run([program, "--output", directory, TENSION], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                          text=True, timeout=60, check=False)
    check(done.returncode == 3, f"the second run: exit code {done.returncode}")
    check("is being written by another run" in done.stderr, f"the second run says {done.stderr}")
    process.terminate()
    finish(process, 3)
    said(directory, "bending.dat")
    check(len(rows(directory / "history.csv")) > 1, "the rows of the first run are lost")
    done = subprocess.run([program, "--quiet", "--output", directory, TENSION], timeout=60, check=False)
    check(done.returncode == 0, f"the lock is kept: exit code {done.returncode}")


def inputs_in_the_way(program, directory):
    """Test inputs that lie where a result would be written: refused with exit code 2, and not changed."""
    text = BENDING.read_text(encoding="utf-8")
    for name in ("job.log", "history.csv", "status.csv.part", "fields.vtkhdf", "restart.h5"):
        for kind in ("deck", "include", "surface", "link"):
            output = directory / f"{name}-{kind}"
            shutil.copytree(FOLDER, output)
            deck, victim = output / "bending.dat", output / name
            if kind in ("deck", "link"):
                deck.rename(victim)
                deck = victim
            elif kind == "include":
                deck.rename(victim)
                deck.write_text(f'*INCLUDE "{name}"\n', encoding="utf-8")
            else:
                (output / "blank_holder.bez").rename(victim)
                deck.write_text(text.replace("blank_holder.bez", name), encoding="utf-8")
            if kind == "link":
                deck = directory / f"{name}.dat"
                deck.symlink_to(victim)
                for surface in FOLDER.glob("*.bez"):
                    shutil.copy(surface, directory)
            before = victim.read_bytes()
            done = subprocess.run([program, "--output", output, deck], stdout=subprocess.DEVNULL,
                                  stderr=subprocess.PIPE, text=True, timeout=60, check=False)
            check(done.returncode == 2, f"{name}, {kind}: exit code {done.returncode}:\n{done.stderr}")
            check("would overwrite the input file" in done.stderr, f"{name}, {kind}: it says {done.stderr}")
            check(victim.read_bytes() == before, f"{name}, {kind}: the input was changed")


def little_memory(program, directory):
    """Test a limited address space: a sentence and exit code 3. The threads of OpenBLAS are left out, see status.md."""
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    directory.mkdir(parents=True)
    shutil.copytree(FOLDER, directory, dirs_exist_ok=True)
    deck = directory / "bending.dat"
    text = deck.read_text(encoding="utf-8")
    deck.write_text(text.replace("divisions = 10 3 2", "divisions = 120 60 2"), encoding="utf-8")
    stopped = 0
    for megabytes in (90, 120, 160, 220, 300):
        limit = megabytes << 20
        done = subprocess.run([program, "--output", directory / str(megabytes), deck], stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, text=True, timeout=100, check=False, env=environment,
                              preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
        if done.returncode == 127:
            continue  # the libraries cannot be loaded
        check(done.returncode == 3, f"{megabytes} MB: exit code {done.returncode}:\n{done.stderr}")
        check("stopped E202: not enough memory" in done.stderr, f"{megabytes} MB: it says {done.stderr}")
        check("Backtrace" not in done.stderr, f"{megabytes} MB: it says {done.stderr}")
        if (directory / str(megabytes)).exists():
            said(directory / str(megabytes), "not enough memory")
            description = directory / str(megabytes) / "run.json"
            check(not description.exists() or
                  json.loads(description.read_text(encoding="utf-8"))["outcome"]["exit_code"] == 3,
                  f"{megabytes} MB: run.json does not say that it stopped")
        stopped += 1
    check(stopped > 1, "no limit was low enough")
    done = subprocess.run([program, "--quiet", "--check", BENDING], timeout=60, check=False, env=environment,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (200 << 20, 200 << 20)))
    check(done.returncode == 0, f"--check: exit code {done.returncode}")


def little_memory_for_the_solver(program, directory):
    """Test a limited address space in which the factors of UMFPACK find no place: E232, for one of the limits."""
    directory.mkdir(parents=True)
    deck = directory / "block.dat"
    deck.write_text(BLOCK, encoding="utf-8")
    environment, said = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}, ""
    for megabytes in range(140, 300, 20):
        limit = megabytes << 20
        done = subprocess.run([program, "--threads", "1", "--output", directory / "out", deck], capture_output=True,
                              text=True, timeout=100, check=False, env=environment,
                              preexec_fn=lambda limit=limit: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
        check("Backtrace" not in done.stderr, f"{megabytes} MB: it says {done.stderr}")
        said += done.stderr
        if "stopped E232" in done.stderr:
            break
    check("stopped E232" in said and "not enough memory for the direct solver" in said, f"no limit gave E232:\n{said}")


def full_disk_of_the_solver(program, directory):
    """Test factors that MUMPS cannot write, of more than 8 MB: E235."""
    listed = subprocess.check_output([program, "--help", "method"], text=True, timeout=60)
    if re.search(r"^  mumps .*; not in this build", listed, re.MULTILINE):
        print("MUMPS is not in this build: full_disk_of_the_solver is skipped")
        return
    directory.mkdir(parents=True)
    deck = directory / "block.dat"
    deck.write_text(BLOCK.replace("method = umfpack", "method = mumps\n  factors = disk"), encoding="utf-8")

    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 23, 1 << 23))

    done = subprocess.run([program, "--threads", "1", "--output", directory / "out", deck], capture_output=True,
                          text=True, timeout=100, check=False, preexec_fn=limit)
    check(done.returncode == 3 and "stopped E235" in done.stderr, f"exit code {done.returncode}:\n{done.stderr}")


def machine_without_memory(program, directory):
    """Test the warning of a job that needs more memory than /proc/meminfo says is left, in place of which a file is
    mounted."""
    directory.mkdir(parents=True)
    table = directory / "meminfo"
    table.write_text("MemAvailable:       1 kB\n", encoding="utf-8")
    mounted = ["unshare", "--mount", "--map-root-user", "sh", "-c", 'mount --bind "$1" /proc/meminfo && shift && "$@"',
               "sh", table]
    if subprocess.run([*mounted, "true"], stderr=subprocess.DEVNULL, check=False).returncode != 0:
        print("cannot mount a file over /proc/meminfo: machine_without_memory is skipped")
        return
    done = subprocess.run([*mounted, program, "--check", BENDING], capture_output=True, text=True, timeout=60,
                          check=False)
    check(done.returncode == 0 and "warning W014: the job needs about" in done.stdout + done.stderr,
          f"exit code {done.returncode}:\n{done.stdout}{done.stderr}")


def missing_solver(program, directory):
    """Test that linear solvers which are not in this build are refused."""
    directory.mkdir(parents=True)
    listed = subprocess.check_output([program, "--help", "method"], text=True, timeout=60)
    missing = re.findall(r"^  (\w+) .*; not in this build", listed, re.MULTILINE)
    check("petsc_gamg" in missing or "mumps" in missing, f"all solvers are in this build:\n{listed}")
    for method in missing:
        deck = directory / f"{method}.dat"
        deck.write_text(f"{TENSION.read_text(encoding='utf-8')}\n*SOLVER\n  method = {method}\n", encoding="utf-8")
        done = subprocess.run([program, "--check", deck], capture_output=True, text=True, timeout=60, check=False)
        check(done.returncode == 2 and "error E116: " in done.stderr and f"'{method}'" in done.stderr,
              f"{method}: exit code {done.returncode}:\n{done.stderr}")


def long_inputs(program, directory):
    """Test very long lines and very many keys, blocks and parameters: an answer within 20 s of processor time."""
    directory.mkdir(parents=True)
    good, n = TENSION.read_text(encoding="utf-8"), 20000
    numbers = " ".join(str(i) for i in range(n))
    for name, text, code in (
            ("numbers", f"{good}\n*OUTPUT\n  fields = at {numbers}\n", 2),
            ("nodes", f"{good}\n*SET many\n  nodes = {' 1' * n}\n", 0),
            ("words", f"{good}\n*BOUNDARY many\n  set = x_min\n  fix = {' x' * n}\n", 2),
            ("word", f"{good}\n*OUTPUT\n  fields = {'x' * 50 * n}\n", 2),
            ("keys", f"{good}\n*OUTPUT\n" + "".join(f"  key{i} = 1\n" for i in range(n)), 2),
            ("blocks", good + "".join(f"\n*SET s{i}\n  plane = x 0" for i in range(n // 4)) + "\n", 0),
            ("parameters", "*PARAMETER\n" + "".join(f"  p{i} = {i}\n" for i in range(n)) + good, 0),
            ("continued", f"{good}\n*OUTPUT\n  fields = at" + "".join(f" &\n {i}" for i in range(n)) + "\n", 2)):
        deck = directory / f"{name}.dat"
        deck.write_text(text, encoding="utf-8")
        done = subprocess.run([program, "--check", deck], capture_output=True, text=True, check=False,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (20, 20)))
        check(done.returncode == code, f"{name}: exit code {done.returncode}:\n{done.stderr[:2000]}")
        check(len(done.stderr) < 1_000_000, f"{name}: it says {len(done.stderr)} characters")


TESTS = (signals, kept_signals, closed_output, killed, vanished_folder, shared_folder, inputs_in_the_way,
         little_memory, little_memory_for_the_solver, full_disk_of_the_solver, machine_without_memory, missing_solver,
         long_inputs)


def main():
    """Run all tests, or those named."""
    parser = parser_of_runs(__doc__)
    parser.add_argument("name", nargs="*", help="tests to run; all when left out")
    options = parser.parse_args()
    shutil.rmtree(options.work, ignore_errors=True)
    options.work.mkdir(parents=True)
    for test in TESTS:
        if options.name and test.__name__ not in options.name:
            continue
        test(options.program, options.work.resolve() / test.__name__)
        print(f"passed: {test.__name__}", flush=True)


if __name__ == "__main__":
    main()
