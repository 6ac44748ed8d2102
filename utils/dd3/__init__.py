# SPDX-License-Identifier: GPL-3.0-or-later
"""Results of dd3imp in Python, and its tools; the command is `dd3`.

    import dd3

    run = dd3.open("bending.out")
    run.history.plot(x="travel", y="punch_fz")
    run.fields[-1].plot(scalars="equivalent_plastic_strain")
    run.job["outcome"]["state"]
"""

from pathlib import Path

from dd3.errors import Problem
from dd3.run import Run

__all__ = ["Problem", "Run", "open"]
__version__ = "2.8.0"


def open(folder: str | Path) -> Run:
    """Return the run whose results are in a folder."""
    return Run(folder)
