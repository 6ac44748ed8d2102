# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages on wrong names, missing files and incomplete results: one line, exit code 2; help with examples."""

import os
import pty
import select
import shutil
import subprocess
import sys
import time

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
    for words, found in (("plot fo", "force"), ("identify x --har", "--hardening"), ("ide", "identify")):
        line = f"COMP_WORDS=(dd3 {words}); COMP_CWORD={len(words.split())}; _dd3; echo ${{COMPREPLY[@]}}"
        assert subprocess.check_output(["bash", "-c", said + line], text=True).split() == [found]


@pytest.mark.skipif(not shutil.which("zsh"), reason="zsh is not installed")
def test_completion_in_zsh(tmp_path):
    """Check the script in a zsh at a terminal: the first completion, commands, options and files."""
    (tmp_path / "_dd3").write_text(call("completion", "zsh"))
    (tmp_path / ".zshrc").write_text("fpath+=~\nautoload -U compinit; compinit -u\nPS1='ready>'\n")
    (tmp_path / "carrier.step").write_text("")
    environment = {**os.environ, "HOME": str(tmp_path), "ZDOTDIR": str(tmp_path), "TERM": "dumb"}
    terminal, own = pty.openpty()
    with subprocess.Popen(["zsh", "-i"], cwd=tmp_path, env=environment, stdin=own, stdout=own, stderr=own,
                          start_new_session=True) as shell:
        try:
            shows(terminal, "ready>")
            for typed, found in (("dd3 ident", "dd3 identify"), ("dd3 plot fo", "dd3 plot force"),
                                 ("dd3 identify x --har", "dd3 identify x --hardening"),
                                 ("dd3 part ca", "dd3 part carrier.step")):
                os.write(terminal, typed.encode() + b"\t")
                shows(terminal, found)
                os.write(terminal, b"\x15")  # removes the line
        finally:
            shell.kill()


def shows(terminal, text, seconds=20):
    """Read what a terminal shows until a text appears."""
    said, end = "", time.monotonic() + seconds
    while text not in said:
        ready, _, _ = select.select([terminal], [], [], max(0, end - time.monotonic()))
        assert ready, f"{text!r} is not shown, but {said!r}"
        said += os.read(terminal, 4096).decode(errors="replace")
