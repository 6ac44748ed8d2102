# SPDX-License-Identifier: GPL-3.0-or-later
"""End of a command: errors as one line on stderr."""

import os
import sys
from collections.abc import Callable
from typing import NoReturn


class Problem(Exception):
    """Input or results that cannot be used; its text is the message."""


def end(message: str) -> NoReturn:
    """Print one line and exit with code 2; messages in the program's format, file:line: error: ..., are not changed."""
    print(message if "error: " in message else f"error: {message}", file=sys.stderr)
    sys.exit(2)


def check(condition: object, message: str) -> None:
    """End the script with exit code 1 and a message unless a condition holds."""
    if not condition:
        sys.exit(message)


def run(main: Callable[[], object]) -> None:
    """Call main; a Problem, a text given to sys.exit and a file error end the script by one line."""
    try:
        main()
        sys.stdout.flush()
    except BrokenPipeError:  # the reader, such as head, has closed the pipe
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except Problem as problem:
        end(str(problem))
    except OSError as error:
        end(f"{error.filename}: {error.strerror}" if error.filename else str(error))
    except KeyboardInterrupt:
        sys.exit(130)
    except SystemExit as stop:
        if not isinstance(stop.code, str):
            raise
        end(stop.code)
