"""Start and end of a script: missing packages, errors as one line on stderr, a progress bar."""

import importlib.util
import os
import re
import sys
import time
from pathlib import Path

ENVIRONMENT = Path(__file__).resolve().parent.parent / ".venv"


class Problem(Exception):
    """Input or results that cannot be used; its text is the message."""


def need(*packages):
    """Continue in the project's .venv if a package is missing; end the script if it is missing there too.

    Call it before the imports.
    """
    missing = [name for name in packages if importlib.util.find_spec(name) is None]
    if missing:
        python = ENVIRONMENT / "bin" / "python3"
        main = getattr(sys.modules["__main__"], "__file__", None)
        if main and python.exists() and Path(sys.prefix).resolve() != ENVIRONMENT.resolve():
            sys.stdout.flush()
            os.execv(python, [str(python), main, *sys.argv[1:]])
        end(f"no package {', '.join(missing)}: {Path(__file__).resolve().parent / 'install_needed.sh'} makes the "
            f"Python environment {ENVIRONMENT}, which the script then takes")


def end(message):
    """Print one line and exit with code 2; messages in the program's format, file:line: error: ..., are not changed."""
    print(message if "error: " in message else f"error: {message}", file=sys.stderr)
    sys.exit(2)


def check(condition, message):
    """End the script with exit code 1 and a message unless a condition holds."""
    if not condition:
        sys.exit(message)


class Progress:
    """A bar on stderr for work of more than a second; on a terminal only. Call it with the fraction that is done."""

    WIDTH = 40

    def __init__(self, title):
        self.title, self.began, self.shown = title, time.monotonic(), False

    def __call__(self, fraction):
        if sys.stderr.isatty() and time.monotonic() - self.began > 1.0:
            full = round(self.WIDTH * min(max(fraction, 0.0), 1.0))
            print(f"\r{self.title} [{'#' * full}{'.' * (self.WIDTH - full)}]", end="", file=sys.stderr, flush=True)
            self.shown = True

    def end(self):
        """Remove the bar."""
        if self.shown:
            print("\r" + " " * (len(self.title) + self.WIDTH + 3) + "\r", end="", file=sys.stderr, flush=True)
            self.shown = False


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


def put_table(document, name, table):
    """Put a table into a document, between the lines `<!-- table: name -->` and `<!-- end of table -->`."""
    text = document.read_text(encoding="utf-8")
    text, count = re.subn(rf"(<!-- table: {name} -->\n).*?(<!-- end of table -->)",
                          lambda found: f"{found[1]}\n{table}\n\n{found[2]}", text, flags=re.DOTALL)
    if count != 1:
        raise Problem(f"{document}: there is no place for the table {name}")
    document.write_text(text, encoding="utf-8")
