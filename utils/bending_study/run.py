# SPDX-License-Identifier: GPL-3.0-or-later
"""Run every case of the bending study of docs/reports/bending_study.md, gather the table and draw the figures.

    python3 -m bending_study run                      all cases of input_files/bending_study/cases.csv
    python3 -m bending_study run --quick              the four cases of quick.csv, to 5 mm, into bending_study_quick.out
    python3 -m bending_study run --sets "fig3 fig6"   selected sets of cases
    python3 -m bending_study run -- --profile utils/dd3/study/slurm   options of snakemake after --

All cores are used. After an interruption the same command continues;
finished cases are not repeated. `pip install "dd3imp[study]"` installs snakemake, the workflow engine.
"""

import argparse
import importlib.util
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from bending_study.runs import NOTE
from dd3 import places
from dd3.command import new_parser
from dd3.errors import Problem, missing
from dd3.programs import add_program, find_program, made_folder


def cores(text: str) -> str:
    """Return a number of cores, or `all`."""
    if not re.fullmatch("[1-9][0-9]*|all", text):
        raise argparse.ArgumentTypeError(f"takes a number, not {text}")
    return text


def main(words: Sequence[str] | None = None) -> None:
    """Run the workflow of the command line."""
    parser = new_parser("run", __doc__, "python3 -m bending_study")
    parser.add_argument("--quick", action="store_true", help="the cases of quick.csv, without figures")
    parser.add_argument("--sets", default="", help="sets of cases, separated by blanks (default: all)")
    parser.add_argument("--cores", type=cores, default="all", help="runs at a time (default: the number of cores)")
    parser.add_argument("--work", type=Path, help="folder of the results (bending_study.out, bending_study_quick.out)")
    add_program(parser)
    parser.add_argument("--cases", type=Path, help="table of the cases (bending_study/cases.csv of the examples)")
    parser.add_argument("options", nargs="*", metavar="-- OPTION", help="further options of snakemake")
    options = parser.parse_args(words)
    import fcntl
    program = find_program(options.program)
    if importlib.util.find_spec("snakemake") is None:
        raise Problem(missing("snakemake"))
    name = "quick" if options.quick else "cases"
    cases = options.cases or places.examples() / "bending_study" / f"{name}.csv"
    work = made_folder(options.work or ("bending_study_quick.out" if options.quick else "bending_study.out"))
    settings = [f"program={program}", f"cases={cases.resolve()}", f"sets={options.sets}"]
    with (work / ".lock").open("w") as lock:
        try:  # unlike the lock of snakemake it is released when the process is killed
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise Problem(f"{work}: another run of the study is under way there") from None
        print(f"== {len(list(work.glob(f'*/{NOTE}')))} cases are done in {work}; running the others", flush=True)
        done = subprocess.run([
            sys.executable, "-m", "snakemake", "--snakefile", str(Path(__file__).with_name("workflow.smk")),
            "--directory", str(work), "--cores", options.cores, "--keep-going", "--nolock", "--rerun-incomplete",
            "--rerun-triggers", "mtime", "params", "input", "--quiet", "all", *options.options, "--config", *settings,
            *(["figures=no"] if options.quick else [])], check=False, pass_fds=[lock.fileno()])
    sys.exit(done.returncode)
