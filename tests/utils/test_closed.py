# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts with holes, notches and lanced forms: their closed sides and their tools against those of the same part made
without any."""

import gmsh
import numpy as np
import pytest
from closed_set import PAIRS, largest_distance, occ, surface_of, upper, whole_bend, write
from helpers import call
from test_tool_surfaces import read

from dd3.curve import read_curves
from dd3.gmsh_session import session
from dd3.tools.cad import silence
from dd3.tools.patch_distance import Distance


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Write the parts."""
    folder = tmp_path_factory.mktemp("closed")
    write(folder)
    return folder


@pytest.mark.parametrize("name", PAIRS)
def test_side(folder, name):
    """Check that the upper side is that of the part without openings."""
    reading, closed, area, rims = upper(folder, name)
    _, none, plain, plain_rims = upper(folder, f"{name}_plain")
    assert none is None and not reading.faults
    assert len(closed.openings) == PAIRS[name][1]
    assert abs(area / plain - 1) < 1e-6 and rims == plain_rims, (area, plain, rims, plain_rims)


@pytest.mark.parametrize("name", ["u_section", "cup", "tray", "slotted"])
def test_tools(folder, tmp_path, name):
    """Check the tools against those of the part without openings."""
    said = call("tool", folder / f"{name}.step", tmp_path / "own", "--flange", 20)
    assert "filled: " in said, said
    call("tool", folder / f"{name}_plain.step", tmp_path / "plain", "--flange", 20)
    for tool in ("punch", "die"):
        assert largest_distance(tmp_path / "own", tmp_path / "plain", tool) < 0.01
        assert largest_distance(tmp_path / "plain", tmp_path / "own", tool) < 0.01
    assert len(read_curves(tmp_path / "plain" / "trim.txt")) == 1


def test_curves(folder, tmp_path):
    """Check the true rims of a tray with a hole in its wall, where the punch ends, also of a part that is turned."""
    said = call("tool", folder / "tray.step", tmp_path, "--rotate", 0, 0, 1, 30, "--move", 5, 0, 3, "--flange", 20)
    curves = read_curves(tmp_path / "trim.txt")
    assert len(curves) == 2 and 'file = "trim.txt"' in (tmp_path / "trim.dat").read_text()
    punch = read(tmp_path / "punch.bez")
    punch[..., 2] -= punch[..., 3] * float(said.split("travel")[1].split()[0])
    for curve in curves:
        assert np.linalg.norm(Distance(punch, 1.0).nearest(curve)[0] - curve, axis=1).max() < 0.01
    centre = (curves[1].min(axis=0) + curves[1].max(axis=0)) / 2
    assert np.abs(np.linalg.norm(curves[1] - centre, axis=1) - 3).max() < 1e-3
    assert np.abs(centre[:2] - (39 * np.array([np.cos(np.pi / 6), 0.5]) + [5, 0])).max() < 1e-3


def test_refusal(tmp_path):
    """Check that a hole of a surface that cuts a radius into two is named, with its edges in the picture."""
    with session(), silence():
        surface_of(whole_bend)()
        occ.synchronize()
        gmsh.write(str(tmp_path / "part.step"))
    said = call("tool", tmp_path / "part.step", tmp_path / "tools", "--thickness", 1, expect=2)
    assert "is not filled, as faces end there" in said and "at x y z = 36.32 0 4.634 in faces 4 12-13 18" in said, said
    assert (tmp_path / "tools" / "part.png").exists() and not (tmp_path / "tools" / "punch.bez").exists()
