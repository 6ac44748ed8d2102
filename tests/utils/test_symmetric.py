# SPDX-License-Identifier: GPL-3.0-or-later
"""The half or the quarter of a part with planes of symmetry: its input files beside those of the whole part."""

import re
import shutil
import subprocess

import numpy as np
import pytest
from helpers import call
from part_set import write
from scipy.spatial import cKDTree

from dd3.errors import Problem
from dd3.run import read_frame
from dd3.sheet import Sheet
from dd3.tools.beads import Beads, Line
from dd3.tools.set_files import draw_in_of
from dd3.tools.symmetry import mirrored

HOLDER = 19300  # its force on the whole, N


@pytest.fixture(scope="module")
def parts(tmp_path_factory):
    """Write the set of parts."""
    folder = tmp_path_factory.mktemp("parts")
    write(folder)
    return folder


def ellipse(x, y, z=None):
    """Return a closed curve about a place, 60 by 40 mm."""
    angle = np.linspace(0, 2 * np.pi, 90, endpoint=False) + 0.3
    columns = [x + 30 * np.cos(angle), y + 20 * np.sin(angle)]
    return np.column_stack([*columns, np.full_like(angle, z)] if z is not None else columns)


def area(curve):
    """Return the area within a curve in plan."""
    x, y = curve[:, 0], curve[:, 1]
    return abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def test_mirrored_curves():
    """Check curves about the planes, across one of them off its middle, beside them, and one that a plane meets at four
    places."""
    for axes in ((), (0,), (1,), (0, 1)):
        curve = mirrored(ellipse(0, 0, 5.0), axes, 0.0)
        assert area(curve) == pytest.approx(600 * np.pi, rel=2e-3) and (curve[:, 2] == 5).all()
        for axis in axes:
            image = curve * np.where(np.arange(3) == axis, -1, 1)
            assert np.abs(curve[:, None] - image).max(axis=2).min(axis=1).max() < 1e-12
    across = mirrored(ellipse(10, 0), (0,), 0.0)  # the larger part and its mirror image
    part = 600 * (np.pi - np.arccos(1 / 3) + np.sqrt(8) / 9)
    assert area(across) == pytest.approx(2 * part, rel=2e-3) and across[:, 0].min() == pytest.approx(-40, abs=0.1)
    assert (mirrored(ellipse(50, 0), (0,), 0.0) == ellipse(50, 0)).all()
    assert mirrored(ellipse(-50, 0), (0,), 0.0) is None and mirrored(ellipse(50, -30), (0, 1), 0.0) is None
    with pytest.raises(Problem, match="meets x = 0 at more than two"):
        mirrored(np.array([[-2, 0], [2, 0], [2, 1], [-1, 1], [-1, 2], [2, 2], [2, 3], [-2, 3.0]]), (0,), 0.0)


def drawn(program, folder, divisions, part):
    """Run both input files of a set on a coarse mesh; return the history and the largest thinning of the draw, and the
    trimmed and free sheet."""
    for name in ("draw", "trim"):
        words = [program, "--quiet", "--threads", "1", folder / f"{name}.dat"]
        settings = {"levels": 0, "divisions": divisions, "holder": HOLDER * part} if name == "draw" else {}
        for key, value in settings.items():
            words[1:1] = ["--set", f"{key}={value}"]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        assert done.returncode == 0 and "W125" not in done.stdout + done.stderr, done.stdout + done.stderr
    history = read_frame(folder / "draw.out", "history.csv")
    sheet, cut = (Sheet(folder / f"{name}.out") for name in ("draw", "trim"))
    return history[history["phase"] == "draw"], sheet.values(sheet.last, "thinning")[0].max(), cut.points(cut.last)


@pytest.mark.slow
def test_quarter_of_tray(parts, tmp_path, program):
    """Check a quarter of a tray beside the whole: four times its forces, the same thinning, the cut of its rim."""
    whole = call("tool", parts / "tray.step", tmp_path / "whole")
    assert "--symmetric computes the quarter x, y > 0" in whole, whole
    said = call("tool", parts / "tray.step", tmp_path / "quarter", "--symmetric")
    assert "x = 0 and y = 0: the quarter x, y > 0 is computed" in said, said
    # The whole in the same mesh: the outline of its blank is symmetric but for its own accuracy.
    shutil.copy(tmp_path / "quarter" / "blank.txt", tmp_path / "whole")
    size = re.search(r"\n  size = (\S+) (\S+) ", (tmp_path / "quarter" / "draw.dat").read_text())
    x, y = float(size[1]), float(size[2])
    deck = (tmp_path / "whole" / "draw.dat").read_text()
    deck = re.sub(r"\n  origin = .*\n  size = \S+ \S+ ", f"\n  origin = {-x} {-y} 0\n  size = {2 * x} {2 * y} ", deck)
    (tmp_path / "whole" / "draw.dat").write_text(deck)
    full, thinned, sheet = drawn(program, tmp_path / "whole", "20 18 1", 1)
    part, own, cut = drawn(program, tmp_path / "quarter", "10 9 1", 0.25)
    at = np.linspace(4, 24, 11)
    force = [np.interp(at, history["travel"], history["punch_fz"]) for history in (full, part)]
    assert np.abs(4 * force[1] / force[0] - 1).max() < 0.02, force
    assert own == pytest.approx(thinned, abs=0.002)
    assert np.abs(cut[:, :2].min(axis=0)).max() < 1e-9
    place, draw_in = draw_in_of(tmp_path / "whole" / "draw.out")
    of_part = draw_in_of(tmp_path / "quarter" / "draw.out")
    nearest = cKDTree(of_part[0]).query(place)
    assert max(nearest[0].max(), np.abs(of_part[1][nearest[1]] - draw_in).max()) < 0.02 * draw_in.max()
    assert np.ptp(cut, axis=0) * [2, 2, 1] == pytest.approx(np.ptp(sheet, axis=0), abs=0.2)


def test_beads():
    """Check that a half has the beads on its side and those across the plane, with the numbers of the whole."""
    lines = [Line(np.array(points, float), 5.0) for points in (
        [[-50, 15], [-50, -15]], [[-20, -40], [20, -40]], [[50, -15], [50, 15]])]
    for axes, kept in (((), "123"), ((0,), "23"), ((1,), "13"), ((0, 1), "3")):
        assert re.findall(r"bead_(\d)", Beads(lines).blocks(axes)) == list(kept)


def test_refused(parts, tmp_path):
    """Check what is said of parts without a plane at x = 0 or y = 0."""
    said = call("tool", parts / "tray.step", "--symmetric", "--thickness", 1, "--move", 3, -2, 0, expect=2)
    assert "no planes of symmetry of the part; they are with --move 0 0 0" in said, said
    said = call("tool", parts / "s_rail.step", tmp_path / "rail", "--thickness", 1, "--symmetric", expect=2)
    assert "--symmetric: x = 0 and y = 0 are no planes of symmetry of the part" in said and "--move" not in said, said
