"""Check the messages on wrong names, missing files and incomplete results: one line, exit code 2."""

import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def call(script, *arguments, expect=2):
    """Return the output of a script."""
    words = [sys.executable] if script.endswith(".py") else ["bash"]
    words += [ROOT / "utils" / script, *arguments]
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=60, check=False)
    said = done.stdout + done.stderr
    assert done.returncode == expect and "Traceback" not in said, f"{script} {arguments}: {done.returncode}\n{said}"
    return said


def main():
    with tempfile.TemporaryDirectory() as name:
        work = Path(name)
        (work / "incomplete").mkdir()
        (work / "incomplete" / "results.csv").write_text("case,set,travel,code,seconds,program\na-1e2,fig3,1,3,1,abc\n")
        (work / "page.md").write_text("no tables\n")
        for script, arguments, said in (
                ("study.py", ("command", "nosuch"), "no case 'nosuch'"),
                ("study.py", ("case", "nosuch"), "no case 'nosuch'"),
                ("study.py", ("case", "b-1e3", "--program", "nosuch", "--work", work), "nosuch: no such program"),
                ("study.py", ("table", "--work", work), "no case is done"),
                ("study.py", ("table", "--cases", work / "none.csv"), "none.csv: No such file"),
                ("study.py", ("report", work / "page.md", "--work", work), "results.csv: No such file"),
                ("study.py", ("report", work / "page.md", "--work", work / "incomplete"), "is missing; utils/study.sh"),
                ("benchmark.py", ("--program", "nosuch"), "nosuch: no such program"),
                ("bending_tables.py", ("--program", "nosuch"), "nosuch: no such program"),
                ("study.sh", ("--program", "nosuch"), "nosuch: no such program"),
                ("study.sh", ("--sets",), "--sets needs a value"), ("study.sh", ("--cores",), "--cores needs a value"),
                ("study.sh", ("--cores", "x"), "--cores takes a number"), ("study.sh", ("x",), "unknown argument x"),
                ("first_run.sh", ("x",), "unknown argument x"), ("run_tests.sh", ("x",), "unknown argument x"),
                ("install_needed.sh", ("x",), "unknown argument x")):
            lines = call(script, *arguments).strip().splitlines()
            assert said in lines[-1] and lines[-1].startswith("error: "), lines
        for script in ("study.sh", "first_run.sh", "run_tests.sh", "install_needed.sh"):
            assert f"utils/{script}" in call(script, "--help", expect=0)
        assert not (work / "b-1e3").exists()
    print("messages are plain")


main()
