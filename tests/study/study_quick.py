# SPDX-License-Identifier: GPL-3.0-or-later
#: {"labels": ["utils"]}
"""Run the quick cases of the bending study, gather the table and check it.

If snakemake is installed, the workflow must give the same, run a case again that was lost, and do nothing when all
cases are done.
"""

import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path

from dd3.programs import parser_of_runs
from dd3.tables import read_table

ROOT = Path(__file__).resolve().parents[2]

CASES = ROOT / "input_files" / "bending_study" / "quick.csv"
STUDY = [sys.executable, "-m", "bending_study"]
NAMES = ["a-1e3", "b-1e3", "b-1e5-c1", "a-1e2-c1-alone"]


def call(*words, expect=0, **settings):
    """Return the output of a command."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, **settings)
    assert done.returncode == expect, f"{words}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def check_table(path):
    """Check the table of results."""
    rows = {row["case"]: row for row in read_table(path)}
    assert sorted(rows) == sorted(NAMES), sorted(rows)
    for name in NAMES[:3]:
        assert rows[name]["code"] == "0" and float(rows[name]["travel"]) == 5.0, rows[name]
        assert float(rows[name]["percent_rotation"]) > 50.0, rows[name]
        assert rows[name]["cutbacks"] == "0" and rows[name]["reason"] == "", rows[name]
    forces = [float(rows[name]["force_5"]) for name in ("b-1e3", "b-1e5-c1")]
    assert abs(forces[0] / forces[1] - 1.0) < 0.005, forces
    assert float(rows["b-1e5-c1"]["flange"]) > 50.0, rows["b-1e5-c1"]
    alone = rows["a-1e2-c1-alone"]
    assert alone["code"] == "3" and float(alone["travel"]) < 5.0 and alone["reason"], alone
    assert float(alone["percent_force"]) > 50.0, alone
    assert "--set p=1e2" in alone["command"] and "'force=1 1 1'" in alone["command"], alone


def by_steps(program, work):
    """Run each case and gather the table by its steps."""
    tail = ["--cases", CASES, "--program", program, "--work", work]
    for name in NAMES:
        call(*STUDY, "case", name, *tail)
    stamp = (work / "b-1e3" / "done.json").stat().st_mtime_ns
    assert "done before" in call(*STUDY, "case", "b-1e3", *tail)
    assert (work / "b-1e3" / "done.json").stat().st_mtime_ns == stamp
    call(*STUDY, "case", "none", *tail, expect=2)
    call(*STUDY, "table", *tail)
    check_table(work / "results.csv")


def by_workflow(program, work):
    """Run all by the workflow, then again with nothing to do, then with one case lost."""
    def run():
        call(*STUDY, "run", "--quick", "--cores", 2, "--program", program, "--work", work, cwd=ROOT)
        return {name: (work / name / "done.json").stat().st_mtime_ns for name in NAMES}

    first = run()
    check_table(work / "results.csv")
    assert run() == first
    (work / "a-1e3" / "done.json").unlink()
    again = run()
    assert [name for name in NAMES if again[name] != first[name]] == ["a-1e3"]
    check_table(work / "results.csv")


def main():
    """Run the steps, and the workflow."""
    options = parser_of_runs(__doc__).parse_args()
    shutil.rmtree(options.work, ignore_errors=True)
    by_steps(options.program, options.work.resolve() / "steps")
    print("steps: passed")
    if importlib.util.find_spec("snakemake"):
        by_workflow(options.program, options.work.resolve() / "workflow")
        print("workflow: passed")
    else:
        print("workflow: skipped, snakemake is not installed")


main()
