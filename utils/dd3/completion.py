# SPDX-License-Identifier: GPL-3.0-or-later
"""Print a script that completes commands, options and files of dd3 in a shell.

    dd3 completion bash >~/.local/share/bash-completion/completions/dd3
    dd3 completion zsh >~/.zfunc/_dd3              with fpath+=~/.zfunc before compinit in ~/.zshrc

The commands and options are those of this version, from their help: print the script again after an update.
"""

import contextlib
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from importlib import import_module
from typing import Any

from dd3.command import ANY, COMMANDS, new_parser

SCRIPT = """_dd3() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} words= files=yes
  case "${{COMP_WORDS[*]:1:$((COMP_CWORD - 1))}} " in
{cases}
  esac
  COMPREPLY=($(compgen -W "$words" -- "$word"))
  if [ -n "$files" ]; then COMPREPLY+=($(compgen -f -- "$word")); fi
}}
complete -o filenames -F _dd3 dd3
"""
# zsh reads the script at the first completion, which the last line makes.
ZSH = "#compdef dd3\nautoload -U +X bashcompinit && bashcompinit\n", "_bash_complete -o filenames -F _dd3\n"


def options_of(target: str) -> list[str]:
    """Return the options of a command, MODULE or MODULE:FUNCTION, from its help; none where a module that it needs is
    not installed."""
    module, _, function = target.partition(":")
    said = io.StringIO()
    with contextlib.suppress(SystemExit, ModuleNotFoundError), contextlib.redirect_stdout(said):
        call = import_module(module)
        getattr(call, "convert" if hasattr(call, "convert") else function or "main")(["--help"])
    usage = said.getvalue().partition("\noptions:\n")[2]
    return sorted(set(re.findall(r"(?<![\w-])--[a-z][\w-]*", re.sub(r"\n {10,}.*", "", usage))))


def cases(table: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, list[str], bool]]:
    """Yield the words that stand before the cursor, what may follow, and whether files may: the longest first."""
    for name, row in table.items():
        if isinstance(row[-1], dict):
            yield from cases(row[-1], f"{before}{name} ")
        elif name != ANY:
            yield f"{before}{name} ", options_of(row[0]), True
    if ANY in table:
        yield before, [*sorted(set(table) - {ANY}), *options_of(table[ANY][0])], True
    else:
        yield before, sorted(table), False


def script(shell: str) -> str:
    """Return the script of a shell, bash or zsh."""
    rows = [f'    "{before}"*) words="{" ".join(words)}"{"" if files else " files="} ;;'
            for before, words, files in cases(COMMANDS)]
    first, last = ZSH if shell == "zsh" else ("", "")
    return first + SCRIPT.format(cases="\n".join(rows)) + last


def main(words: Sequence[str] | None = None) -> None:
    """Print the script of the command line."""
    parser = new_parser("completion", __doc__)
    parser.add_argument("shell", choices=["bash", "zsh"])
    print(script(parser.parse_args(words).shell), end="")
