"""What the scripts of this folder share: how they end where something is wrong."""

import importlib.util
import os
import shutil
import sys
from pathlib import Path


def need(*packages):
    """Ends the script where a package is missing; called before the imports."""
    missing = [name for name in packages if importlib.util.find_spec(name) is None]
    if missing:
        end(f"no package {', '.join(missing)}: utils/install_needed.sh installs utils/requirements.txt into .venv, "
            "then call .venv/bin/python")


def program_at(path):
    """The program, found as the shell finds it."""
    found = shutil.which(path)
    if not found:
        sys.exit(f"{path}: no such program; give --program FILE")
    return Path(found).resolve()


def end(message):
    """One plain line, exit code 2. Messages of the program that name a file and a line are left as they are."""
    print(message if "error: " in message else f"error: {message}", file=sys.stderr)
    sys.exit(2)


def run(main):
    """Calls main; what it says by sys.exit, and files that cannot be read or written, end by one plain line."""
    try:
        main()
        sys.stdout.flush()
    except BrokenPipeError:  # the reader, such as head, has had enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        end(f"{error.filename}: {error.strerror}" if error.filename else str(error))
    except KeyboardInterrupt:
        sys.exit(130)
    except SystemExit as stop:
        if not isinstance(stop.code, str):
            raise
        end(stop.code)
