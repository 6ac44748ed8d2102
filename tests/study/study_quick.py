"""The quick cases of the bending study: runs them, gathers the table, and looks at what must hold.

Where snakemake is installed, the workflow does the same, goes on after a case is lost, and does nothing when all is done.
"""

import argparse
import csv
import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CASES = ROOT / "input_files" / "bending_study" / "quick.csv"
NAMES = ["a-1e3", "b-1e3", "b-1e5-c1", "a-1e2-c1-alone"]


def call(*words, expect=0, **settings):
    """Output of a command."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, **settings)
    assert done.returncode == expect, f"{words}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def check_table(path):
    """The table of results."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = {row["case"]: row for row in csv.DictReader(file)}
    assert sorted(rows) == sorted(NAMES), sorted(rows)
    for name in NAMES[:3]:
        assert rows[name]["code"] == "0" and float(rows[name]["travel"]) == 5.0, rows[name]
        assert float(rows[name]["share_rotation"]) > 50.0, rows[name]
        assert rows[name]["cutbacks"] == "0" and rows[name]["reason"] == "", rows[name]
    forces = [float(rows[name]["force_5"]) for name in ("b-1e3", "b-1e5-c1")]
    assert abs(forces[0] / forces[1] - 1.0) < 0.005, forces
    assert float(rows["b-1e5-c1"]["flange"]) > 50.0, rows["b-1e5-c1"]
    alone = rows["a-1e2-c1-alone"]
    assert alone["code"] == "3" and float(alone["travel"]) < 5.0 and alone["reason"], alone
    assert float(alone["share_force"]) > 50.0, alone
    assert "--set p=1e2" in alone["command"] and "'force=1 1 1'" in alone["command"], alone


def by_steps(program, work):
    """Each case and the table by study.py."""
    tail = ["--cases", CASES, "--program", program, "--work", work]
    for name in NAMES:
        call(sys.executable, ROOT / "utils" / "study.py", "case", name, *tail)
    stamp = (work / "b-1e3" / "run.json").stat().st_mtime_ns
    assert "done before" in call(sys.executable, ROOT / "utils" / "study.py", "case", "b-1e3", *tail)
    assert (work / "b-1e3" / "run.json").stat().st_mtime_ns == stamp
    call(sys.executable, ROOT / "utils" / "study.py", "case", "none", *tail, expect=2)
    call(sys.executable, ROOT / "utils" / "study.py", "table", *tail)
    check_table(work / "results.csv")


def by_workflow(program, work):
    """All by study.sh, then again with nothing to do, then with one case lost."""
    def run():
        call("bash", ROOT / "utils" / "study.sh", "--quick", "--cores", 2, "--program", program, "--work", work,
             env={**os.environ, "PYTHON": sys.executable})
        return {name: (work / name / "run.json").stat().st_mtime_ns for name in NAMES}

    first = run()
    check_table(work / "results.csv")
    assert run() == first
    (work / "a-1e3" / "run.json").unlink()
    again = run()
    assert [name for name in NAMES if again[name] != first[name]] == ["a-1e3"]
    check_table(work / "results.csv")


def main():
    """Both ways."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--work", type=Path, required=True)
    options = parser.parse_args()
    shutil.rmtree(options.work, ignore_errors=True)
    by_steps(options.program.resolve(), options.work.resolve() / "steps")
    print("the steps do what they should")
    if all(importlib.util.find_spec(name) for name in ("snakemake", "matplotlib")):
        by_workflow(options.program.resolve(), options.work.resolve() / "workflow")
        print("so does the workflow")
    else:
        print("the workflow was left out: snakemake is not installed")


main()
