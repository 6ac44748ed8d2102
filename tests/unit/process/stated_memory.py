#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"timeout": 400}
"""The memory stated in job.log before a run agrees with the peak of the run within 20 %.

    stated_memory.py --program build/release/dd3imp --work build/stated_memory
"""
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

from dd3.programs import parser_of_runs

INPUT = pathlib.Path(__file__).resolve().parents[3] / "input_files"
CUP = INPUT / "square_cup" / "square_cup.dat"
JOBS = ((INPUT / "bending" / "bending.dat", ()),
        (INPUT / "bending" / "fine.dat", ()),
        (CUP, ("divisions=32 32 1", "levels=0")))
ALLOWED = 0.2


def peak(program, deck, folder, settings):
    """Run a few increments and stop; return the peak of the resident memory, bytes."""
    words = [program, "--quiet", "--threads", "1", "--output", folder, deck]
    for setting in settings:
        words += ["--set", setting]
    with subprocess.Popen(words, stderr=subprocess.DEVNULL) as process:
        status = folder / "status.csv"
        while not (status.exists() and status.read_text(encoding="utf-8").count("\n") > 4):
            if os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT):
                break
            time.sleep(0.05)
        process.send_signal(signal.SIGTERM)
        _, code, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(code)
    return 1024 * used.ru_maxrss


def main():
    """Run the test."""
    options = parser_of_runs(__doc__).parse_args()
    work = options.work.resolve()
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    failed = False
    for number, (deck, settings) in enumerate(JOBS):
        folder = work / str(number)
        used = peak(options.program, deck, folder, settings)
        found = re.search(r"memory: about (\d+) MB", (folder / "job.log").read_text(encoding="utf-8"))
        stated = 1e6 * int(found[1]) if found else 0.0
        print(f"{deck.name} {' '.join(settings)}: stated {stated / 1e6:.0f} MB, used {used / 1e6:.0f} MB")
        failed = failed or abs(stated / used - 1.0) > ALLOWED
    sys.exit("FAILED: the memory stated differs by more than 20 %" if failed else 0)


if __name__ == "__main__":
    main()
