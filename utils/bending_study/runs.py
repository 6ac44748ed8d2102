# SPDX-License-Identifier: GPL-3.0-or-later
"""Finished runs of the bending test, and the differences of their punch forces."""

import json
from collections.abc import Sequence
from pathlib import Path

from dd3.errors import Problem
from dd3.programs import Finished, command, launch
from dd3.tables import Row, interpolate, limiters, read_table, totals

NOTE = "done.json"  # exit code, seconds and memory of a finished run, in its folder
# First travel at which forces are compared, and the distance of the points, mm.
FIRST, STEP = 0.1, 0.1


def run_once(folder: Path, program: Path, deck: Path, settings: dict[str, str], *options: str) -> Finished:
    """Run the bending test; exit codes other than 0 and 3 are a Problem."""
    folder.mkdir(parents=True, exist_ok=True)
    words = command(program, deck, folder, ["--quiet", *options], settings)
    done = launch(words)
    if done.code not in (0, 3):
        raise Problem(f"{' '.join(words)}: exit code {done.code}\n{done.errors}")
    return done


def punch_curve(history: Sequence[Row]) -> tuple[list[float], list[float]]:
    """Return travel and punch force in the phase `draw`."""
    rows = [row for row in history if row["phase"] == "draw"]
    return [float(row["travel"]) for row in rows], [float(row["punch_fz"]) for row in rows]


class Run:
    """Results of a finished run; code, seconds and memory come from its note."""

    code: int
    seconds: float
    memory: float

    def __init__(self, folder: Path) -> None:
        self.__dict__.update(json.loads((folder / NOTE).read_text(encoding="utf-8")))
        self.status = read_table(folder / "status.csv")
        self.travel, self.force = punch_curve(read_table(folder / "history.csv"))
        total = totals(self.status)
        self.increments, self.retries = total.increments, total.cutbacks
        self.iterations = total.iterations / max(1, total.increments)
        # The list of nodes after the number of status changes is left out.
        reason, nodes, _ = self.status[-1]["reason"].partition(" nodes: ")
        self.reason = reason + nodes[:-2]

    def force_at(self, travel: float) -> float:
        """Return the punch force at a travel, interpolated between increments."""
        force = interpolate(self.travel, self.force, travel)
        if force is None:
            raise ValueError(f"the run ends before {travel} mm")
        return force

    def limiters(self) -> dict[str, float]:
        """Return the percentage of the increments that each limiter set."""
        rows = limiters(self.status, "draw")
        return {name: 100 * rows.count(name) / len(rows)
                for name in sorted(sorted(set(rows)), key=rows.count, reverse=True)}


def differences(one: Run, other: Run) -> list[tuple[float, float]]:
    """Return the relative differences of two runs' punch forces in per cent, up to the end of the shorter one."""
    end = min(one.travel[-1], other.travel[-1])
    points = [FIRST + i * STEP for i in range(int((end - FIRST) / STEP + 1e-6) + 1)]
    return [(100 * abs(one.force_at(t) / other.force_at(t) - 1), t) for t in points]
