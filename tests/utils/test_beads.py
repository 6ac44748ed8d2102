# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw-beads that are proposed for a part: where, their restraint, by a finished run, in the input file."""
import subprocess

import numpy as np
import pytest
from helpers import call, write_run
from part_set import write

from dd3.bead_path import Bead, flow
from dd3.laws import Material
from dd3.tools import beads
from dd3.tools.set_blank import Blank
from dd3.tools.set_deck import FRICTION
from dd3.tools.set_material import STEEL
from dd3.tools.tool_set import ToolSet

HALF, CORNER, THICKNESS = np.array([60.0, 40.0]), 12.0, 0.8
HISTORY = "phase,increment,travel,progress\nclose,0,0,0\nclose,1,10,1\n"
STATUS = "increment,minimum_ratio,iterations\n1,1,3\n"


def box_blank(draw_in):
    """Return the blank of a box with rounded corners; `draw_in` by the points of its rim and the normals there."""
    angle = np.linspace(0, np.pi / 2, 9)
    out = np.concatenate([np.stack([np.cos(angle + turn), np.sin(angle + turn)], axis=1) for turn in
                          (0, np.pi / 2, np.pi, 3 * np.pi / 2)])
    rim = np.sign(np.repeat([[1, 1], [-1, 1], [-1, -1], [1, -1]], 9, axis=0)) * (HALF - CORNER) + CORNER * out
    # Points along the sides too.
    rim = np.concatenate([p + np.linspace(0, 1, 5 if np.linalg.norm(q - p) > 10 else 2)[:-1, None] * (q - p)
                          for p, q in zip(rim, np.roll(rim, -1, axis=0))])
    flat = rim + draw_in(rim)[:, None] * beads.shape_of(rim)[0]
    return Blank(flat, True, rim, flat)


def test_lines():
    """Check that beads lie beside the middles of straight sides, at their distance, and none in corners or where the
    draw-in is even."""
    found = beads.proposed(box_blank(lambda rim: 10.0 + 6.0 * (np.abs(rim) < (HALF - CORNER) / 2 + 1).any(axis=1)),
                           THICKNESS)
    assert len(found.lines) == 4
    for bead in found.lines:
        across = int(np.ptp(bead.points, axis=0).argmin())
        assert np.abs(bead.points[:, across]) == pytest.approx(HALF[across] + beads.DISTANCE * THICKNESS, abs=0.01)
        assert bead.length == pytest.approx(1.5 * (HALF - CORNER)[1 - across], rel=0.1)
        assert bead.draw_in == pytest.approx(16.0) and len(bead.points) == 2
    # More is drawn in at the corners, which are none for beads.
    found = beads.proposed(box_blank(lambda rim: 10.0 + 8.0 * (np.abs(rim) > HALF - CORNER - 1).all(axis=1)), THICKNESS)
    assert not found.lines and "straight and long" in found.reason
    even = beads.proposed(box_blank(lambda rim: 10.0 + 0.02 * rim[:, 0]), THICKNESS)
    assert not even.lines and "even, 8.8 to 11.2 mm" in even.reason
    assert "not estimated" in beads.proposed(Blank(HALF[None], False), THICKNESS).reason


def test_curved_rim():
    """Check a bead beside a hollow rim: its points follow the line at the distance."""
    angle = np.radians(np.linspace(150, 30, 61))
    arc = 100.0 * np.stack([np.cos(angle), np.sin(angle) - 1], axis=1)
    rim = np.concatenate([arc[::-1], np.array([[-86.6, 80.0], [86.6, 80.0]])])[::-1]
    drawn = (np.abs(rim[:, :1]) < 60) & (rim[:, 1:] < 20)
    found = beads.proposed(Blank(rim, True, rim, rim + [0.0, -15.0] * drawn), THICKNESS)
    assert len(found.lines) == 1
    away = np.linalg.norm(found.lines[0].points + [0, 100.0], axis=1)
    assert away == pytest.approx(np.full(len(away), 100 - beads.DISTANCE * THICKNESS), abs=0.5)


def test_largest():
    """Check the largest force of a sheet in plane strain: a power law necks at the strain n."""
    assert beads.largest(lambda strain: 500 * strain**0.2, 2.0) == pytest.approx(1000 * 0.2**0.2 * np.exp(-0.2), rel=1e-4)


def test_finished_run(tmp_path):
    """Check that the draw-in of a run takes the place of the estimate."""
    from dd3.tools.set_files import draw_in_of
    plan = np.array([[-60.0, -40], [60, -40], [60, 40], [-60, 40]])
    start = np.concatenate([np.column_stack([plan, np.full(4, z)]) for z in (0.0, 1.0)])
    value = np.tile([5.0, 5.0, 20.0, 20.0], 2)
    run = write_run(tmp_path / "draw.out", start, 0.9 * start, [range(8)], HISTORY, STATUS,
                    {"draw_in": [0 * value, value]})
    points, draw_in = draw_in_of(run)
    assert draw_in[points[:, 1] > 0] == pytest.approx([20.0, 20.0])
    found = beads.proposed(box_blank(lambda rim: 10.0 + 0 * rim[:, 0]), THICKNESS, (points, draw_in))
    assert found.lines and all((bead.points[:, 1] > -1).all() for bead in found.lines)


@pytest.mark.slow
def test_input_file(tmp_path, program):
    """Check the beads of a tray in its input file, which the program takes, and that a round pan has none."""
    write(tmp_path, ["own_flange", "pan"])
    said = call("tool", tmp_path / "own_flange.step", tmp_path / "beads", "--beads", "--program", program)
    text = (tmp_path / "beads" / "draw.dat").read_text()
    assert text.count("*DRAWBEAD bead_") == 4 == said.count("draw-in up to") and "W012" not in said
    force, lift = (float(text.split(f"  {name} = ")[1].split()[0]) for name in ("bead", "lift"))
    result = flow(Material(STEEL), Bead(1, 5, 3, 1.2, 5, 0.1, FRICTION))
    assert force + FRICTION * lift == pytest.approx(result.restraint, rel=0.01)
    assert lift == pytest.approx(result.uplift, rel=0.01)
    deck = tmp_path / "beads" / "draw.dat"
    done = subprocess.run([program, "--check", deck], capture_output=True, text=True, check=True)
    assert "bead_4" in done.stdout
    half = np.loadtxt(tmp_path / "beads" / "blank.txt")[:, 0].max()
    assert 54 + 10 + beads.MARGIN < half < 54 + 16 + beads.MARGIN
    assert "none, as the draw-in is even" in call("tool", tmp_path / "pan.step", tmp_path / "round", "--beads",
                                                  "--program", program)
    assert "*DRAWBEAD" not in (tmp_path / "round" / "draw.dat").read_text()
    assert "goes with a folder" in call("tool", tmp_path / "pan.step", "--beads", expect=2)


def test_pad():
    """Check that a part without a holder all around gets no beads."""
    from dd3.tools.set_files import beads_of
    assert "no holder" in beads_of(ToolSet(), None).reason
