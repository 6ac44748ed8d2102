# SPDX-License-Identifier: GPL-3.0-or-later
"""Process windows: borders of known functions, waves of run.json, a window whose border is known."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from helpers import call
from test_study import DECK

from dd3.window import BOTH, GOOD, SPLITS, WRINKLES, Window, borders, wave_heights


def test_borders_of_linear_functions() -> None:
    """The borders of a bilinear function are exact along the lines of the grid."""
    x, y = np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0])
    values = 0.25 + 0.5 * x[:, None] + 0.25 * y
    assert np.allclose(borders(x, y, values), [(0, 1, 3, 1.5), (2, 0, 1, 0.5)])
    values[1, 0] = np.nan
    assert np.allclose(borders(x, y, values), [(2, 0, 1, 0.5)])


def test_border_of_waves() -> None:
    """Waves that fall exponentially have their border where they do, however far apart the runs are."""
    x, y = np.array([0.0, 3.0, 7.0]), np.array([0.0, 1.0])
    waves = np.exp(3.5 - 2 * x[:, None] + y)
    found = Window(("a", "b"), x, y, np.full_like(waves, 0.5), waves)
    (_, splits, _), (_, values, smooth) = found.limits()
    assert (splits < 1).all() and (values == waves).all()
    assert np.allclose(borders(x, y, smooth), [(0, 0, 3, 1.75), (1, 0, 3, 2.25)])
    none = Window(("a", "b"), x, y, waves, np.array([[2.0, 2.0], [0.0, 0.01], [0.0, 0.0]])).limits()[1][2]
    assert np.allclose([row.place for row in borders(x, y, none)], 3 * np.log(2) / np.log(200))


def test_answers() -> None:
    """Each run is good, splits, wrinkles, or both; one without an end is nothing."""
    found = Window(("a", "b"), np.arange(2.0), np.arange(3.0), np.array([[0.5, 1.5, 0.5], [1.5, np.nan, 0.5]]),
                   np.array([[0.5, 0.5, 1.5], [1.5, np.nan, 0.5]]))
    assert found.answers().tolist() == [[GOOD, SPLITS, WRINKLES], [BOTH, "", GOOD]]


def test_waves() -> None:
    """Waves of a holder count at the end of the forming only, waves in walls in all phases."""
    def phase(name, wave, wall):
        closing = {"holders": [{"tool": "holder", "wave": wave and {"distance": wave}}],
                   "punches": [{"off_walls": wall and {"distance": wall}}]}
        return {"name": name, "result": {"closing": closing}}
    job = {"phases": [phase("clamp", 3.0, None), phase("draw", 0.2, 0.15)], "warnings": []}
    assert wave_heights(job) == (0.2, 0.3) and wave_heights({"phases": [], "warnings": []}) == (0, 0)


def test_window_of_a_bar(program) -> None:
    """A bar of 4 mm splits where its extension exceeds a level forming limit curve, whatever its yield stress."""
    Path("bar.dat").write_text(DECK.replace("  young", "  forming_limit = -0.1 0.035 0.02 0.035\n  young").replace(
        "strain = 0.01", "strain = 0.01\n  yield = 200").replace("${hardening}", "linear Y0=${yield} H=1000"))
    said = call("window", "bar.dat", "--vary", "strain=0.1:0.2:3", "yield=200,250", "--program", program, "--cores", 2)
    table = pd.read_csv("bar.window/window.csv")
    assert np.allclose(table["split"], np.log1p(table["strain"] / 4) / 0.035, rtol=1e-3)
    expected = 4 * np.expm1(0.035)
    found = [float(line.rpartition(" ")[2]) for line in said.splitlines() if ": strain from " in line]
    assert found == pytest.approx([expected, expected], abs=1e-3)
    assert set(table["answer"]) == {GOOD, SPLITS} and "wrinkles begin at\n  none" in said
    assert Path("bar.window/window.png").is_file()
    said = call("window", "bar.dat", "--vary", "strain=0.1,0.2", "yield=-1,250", "--program", program, expect=2)
    assert "2 of 4 runs did not reach their end" in said and "Y0" in said
    assert "two or more numbers" in call("window", "bar.dat", "--vary", "strain=0.1", "yield=200,250", "--program",
                                         program, expect=2)
