# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages on wrong names, missing files and incomplete results: one line, exit code 2; help with examples."""

import subprocess
import sys

import pytest
from helpers import ROOT, UTILS, call

from dd3.command import ANY, COMMANDS

NAMES = [(name, *other) for name, row in COMMANDS.items()
         for other in ([()] if isinstance(row[-1], str) else [(), *((key,) for key in row[-1])])]


@pytest.mark.parametrize("words, said", (
    ((), "a command is missing; expected part, tool, import"),
    (("tol",), "no command 'tol'; did you mean 'tool'?"), (("plot", "increment"), "did you mean 'increments'?"),
    (("plot", "sheet", "job.dat", "--set", "x"), "--set: takes NAME=VALUE")))
def test_messages(words, said):
    """Check the last line."""
    line = call(*words, expect=2).strip().splitlines()[-1]
    assert said in line and "error: " in line


@pytest.mark.parametrize("script", ("first_run.sh", "run_tests.sh", "install_needed.sh", "dev/benchmark.py",
                                    "dev/bending_tables.py", "dev/viewer_library.sh"))
def test_scripts(script):
    """Check the help and the messages of the scripts."""
    first = [sys.executable] if script.endswith(".py") else ["bash"]
    for words, code, said in (("--help",), 0, f"utils/{script}"), (("--program", "nosuch"), 2, ""):
        done = subprocess.run([*first, UTILS / script, *words], capture_output=True, text=True, timeout=60, check=False)
        lines = (done.stdout + done.stderr).strip().splitlines()
        assert done.returncode == code and said in "\n".join(lines) and "Traceback" not in "\n".join(lines)
        assert code == 0 or lines[-1].startswith(("error: unknown argument --program", "error: nosuch: no such"))


@pytest.mark.parametrize("words", [(), *NAMES])
def test_help(words):
    """Check that each command has a help with an example of its own name."""
    said = call(*words, "--help")
    words = [word for word in words if word != ANY]
    assert f"\n    {' '.join(('dd3', *words))} " in said
    assert call("--version").startswith("dd3 ")


def test_completion():
    """Check that the script of the shell has the commands, and the options of each."""
    said = call("completion", "bash")
    assert '"plot force "*) words="--component --factor' in said and '"report "*)' in said
    assert '"plot "*) words="force increments point sheet"' in said and "complete -o filenames -F _dd3 dd3" in said
    assert call("completion", "zsh").startswith("#compdef dd3\n")
