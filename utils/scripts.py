"""Start and end of a script: missing packages, errors as one line on stderr."""

import importlib.util
import os
import sys


class Problem(Exception):
    """Input or results that cannot be used; its text is the message."""


def need(*packages):
    """End the script if a package is missing. Call it before the imports."""
    missing = [name for name in packages if importlib.util.find_spec(name) is None]
    if missing:
        end(f"no package {', '.join(missing)}: utils/install_needed.sh installs utils/requirements.txt into .venv, "
            "then call .venv/bin/python")


def end(message):
    """Print one line and exit with code 2; messages in the program's format, file:line: error: ..., are not changed."""
    print(message if "error: " in message else f"error: {message}", file=sys.stderr)
    sys.exit(2)


def run(main):
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
