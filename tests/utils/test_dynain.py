# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets of LS-DYNA: their nodes, thicknesses, stresses and strains in the file that *START reads."""

from pathlib import Path

import numpy as np
import pytest
from helpers import call

from dd3.sheet_state import read_state

# Two shells of 10 mm, the second one turned about y by 30 degrees, 1.0 and 1.2 mm thick.
TURN = np.radians(30)
POINTS = [(0, 0, 0), (10, 0, 0), (10, 10, 0), (0, 10, 0),
          (10 + 10 * np.cos(TURN), 0, -10 * np.sin(TURN)), (10 + 10 * np.cos(TURN), 10, -10 * np.sin(TURN))]
SHELLS = {5: ((1, 2, 3, 4), 1.0), 9: ((2, 5, 6, 3), 1.2)}


def wide(values, width=10):
    """Return numbers in columns."""
    return "".join(f"{value:{width}.{width - 7}e}" for value in values) + "\n"


def dynain(stress):
    """Return the file with the rows of stresses of both shells."""
    text = "*KEYWORD\n$ a comment\n*NODE\n" + "".join(
        f"{i:8d}" + wide(point, 16) for i, point in enumerate(POINTS, 1)) + "*ELEMENT_SHELL_THICKNESS\n"
    for label, (nodes, thickness) in SHELLS.items():
        text += "".join(f"{value:8d}" for value in (label, 1, *nodes)) + "\n" + wide([thickness] * 4, 16)
    return text + "*INITIAL_STRESS_SHELL\n" + stress + "*END\n"


def short(label):
    """Return stresses in a column of three points."""
    return f"{label:10d}{1:10d}{3:10d}\n" + "".join(
        wide((height, 100 + 50 * height, 20, 0, 5, 0, 0, 0.1 + 0.02 * height)) for height in (-0.7745967, 0, 0.7745967))


def large(label):
    """Return the same in two columns with more digits, with two variables more and one tensor, and other deviations."""
    text = f"{label:10d}{2:10d}{3:10d}{2:10d}{6:10d}{1:10d}\n"
    for height in (-0.7745967, 0, 0.7745967):
        for more in (-4, 4):
            values = (height, 100 + 50 * height + more, 20, 0, 5, 0, 0, 0.1 + 0.02 * height)
            text += wide(values[:5], 16) + wide(values[5:], 16) + wide((1, 2), 16) + wide([0] * 5, 16) + wide([0], 16)
    return text


@pytest.mark.parametrize("rows", [short, large])
def test_dynain(rows):
    """Place, stresses in global axes, strains, axes and sets; heights between those of the file are interpolated."""
    Path("dynain").write_text(dynain("".join(rows(label) for label in SHELLS)))
    said = call("dynain", "dynain", "op10.out", "--points", "5", "--rolling", "0", "2", "0")
    assert "2 elements, 5 points" in said
    state = read_state(Path("op10.out"))
    assert state.materials == ["steel"] and state.column == 5 and state.stress.shape == (2, 20, 3, 3)
    heights = np.tile(np.polynomial.legendre.leggauss(5)[0], 4)
    assert np.allclose(state.stress[:, :, 0, 0], 100 + 50 * heights, atol=0.05)
    assert np.allclose(state.stress[..., 0, 1], 5, atol=0.01) and np.allclose(state.stress[..., 1, 1], 20, atol=0.01)
    assert np.allclose(state.strain, 0.1 + 0.02 * heights, atol=1e-5)
    # Rolling along y; the normal of the second shell is turned.
    assert np.allclose(state.axes[:, :, :, 0], (0, 1, 0)) and np.allclose(state.axes[0, 0, :, 2], (0, 0, 1))
    assert np.allclose(state.axes[1, 0, :, 2], (np.sin(TURN), 0, np.cos(TURN)), atol=1e-6)
    lower, upper = state.points[::2], state.points[1::2]
    assert np.allclose(0.5 * (lower + upper), POINTS, atol=1e-6)
    # The thickness at a node lies across its elements, of which the common nodes have two.
    assert np.allclose(np.linalg.norm(upper - lower, axis=1)[[0, 4]], (1.0, 1.2))
    assert np.isclose(np.linalg.norm(upper - lower, axis=1)[1], 1.1 / np.cos(TURN / 2), rtol=1e-4)
    assert len(state.elements) == 2 and state.thickness == pytest.approx(1.1)


def test_refused():
    """Files that hold no sheet of quadrilaterals with stresses, and folders of runs."""
    whole = dynain("".join(short(label) for label in SHELLS))
    for name, text, expected in (
            ("triangle", whole.replace("       2       5       6       3", "       2       5       6       6"), "three nodes"),
            ("stress", whole.replace(short(9), ""), "for 1 shells, the first 9"),
            ("cut", whole.rsplit("\n", 3)[0], "rows, expected"),
            ("none", "*KEYWORD\n*END\n", "no shells"),
            ("number", whole.replace("1.000e-01", "1.000x-01"), "expected a number"),
            ("node", whole.replace("\n       6 ", "\n       7 "), "does not give")):
        Path(name).write_text(text)
        assert expected in call("dynain", name, "x.out", expect=2), name
    Path("dynain").write_text(whole)
    assert "normal to the sheet" in call("dynain", "dynain", "x.out", "--rolling", "0", "0", "1", expect=2)
    Path("run.out").mkdir()
    Path("run.out/job.log").write_text("")
    assert "results of a run" in call("dynain", "dynain", "run.out", expect=2)
    assert "No such file" in call("dynain", "nothing", "x.out", expect=2)
