# SPDX-License-Identifier: GPL-3.0-or-later
"""What the studies of this folder share: runs that are kept, and tables in reports."""
from pathlib import Path

from dd3.programs import command, launch, parser_of_runs
from dd3.tables import read_table, read_text, totals

ROOT = Path(__file__).resolve().parents[2]


def arguments(description):
    """Return the options of a study. Its runs take hours; finished ones are kept, interrupted ones are continued."""
    parser = parser_of_runs(description)
    parser.add_argument("--only", nargs="+", help="names of the runs to make; the others only if they are there")
    parser.add_argument("--write", action="store_true", help="put tables and pictures into the report")
    return parser.parse_args()


def paths(name):
    """Return input file, report and picture of a study."""
    return (ROOT / "input_files" / name / f"{name}.dat", ROOT / "docs" / "reports" / f"{name}.md",
            ROOT / "docs" / "images" / f"{name}.png")


def new_figure(*size):
    """Return a figure of a size in inches and its axes."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    return pyplot.subplots(figsize=size, layout="constrained")


def is_finished(folder):
    """Check whether a run has reached its end."""
    log = folder / "job.log"
    return log.is_file() and "reached the end" in read_text(log)


def make(options, name, deck, settings):
    """Make a run unless it is there; return its folder, None if it is not wanted or has stopped.

    A run that was interrupted is continued.
    """
    folder = options.work / name
    if is_finished(folder):
        return folder
    if options.only and name not in options.only:
        return None
    restart = ["--restart", folder / "restart.h5"] if (folder / "restart.h5").is_file() else []
    print(name, flush=True)
    done = launch(command(options.program, deck, folder, ["--quiet", *restart], settings))
    if done.code != 0:
        print(f"{name}: exit code {done.code}: {done.errors}", flush=True)
    return folder if done.code == 0 else None


def increments(folder):
    """Return the number of increments of a run as text."""
    return str(totals(read_table(folder / "status.csv")).increments)
