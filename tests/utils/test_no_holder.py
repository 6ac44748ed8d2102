# SPDX-License-Identifier: GPL-3.0-or-later
"""Tools of a part that gets no binder: strips along the tangents at its rim against closed forms, the set of a panel on
a saddle, refusals."""

import subprocess

import numpy as np
import pytest
from helpers import call
from part_set import write
from test_tool_surfaces import points_of, read

from dd3.errors import Problem
from dd3.gmsh_session import session
from dd3.part.reading import Request, read_part
from dd3.tools import no_holder
from dd3.tools.joints import find_joints, folded, kinks
from dd3.tools.patch_distance import Distance
from dd3.tools.report import extent
from dd3.tools.surface import Surface, from_nodes

WIDTH, GAP = 5.0, 1.1


def trough(holes=()):
    """Return patches of 5 x 5 mm over 40 x 20 mm on z = x**2 / 200, without some of them."""
    x, y = np.linspace(-20, 20, 17), np.linspace(-10, 10, 9)
    plan = np.stack(np.meshgrid(x, y), axis=-1)
    nodes = np.concatenate([plan, plan[..., :1]**2 / 200], axis=-1)
    cells = [nodes[2 * k:2 * k + 3, 2 * i:2 * i + 3] for k in range(4) for i in range(8) if (i, k) not in holes]
    return Surface(from_nodes(np.array(cells)), np.zeros(len(cells), int), ["trough"])


def test_strips():
    """Check the strips of a trough: planes along its ends, its profile beside them, corners that both go to."""
    whole = no_holder.continued(trough(), WIDTH)
    assert not len(folded(whole.net)) and len(find_joints(whole.net).free) == 24
    # At the corners a strip that is plane meets one that is not.
    angle = np.sort(kinks(whole.net, find_joints(whole.net)))
    assert angle[-5] < 0.01 and angle[-1] < 2.0, angle[-5:]
    points, normals = points_of(whole.net[32:], 5)
    reach = 20 + WIDTH / np.hypot(1.0, 0.2)
    assert np.abs(extent(whole.net)[1][:2] - (reach, 10 + WIDTH)).max() < 1e-9
    end = (np.abs(points[..., 0]) > 20) & (np.abs(points[..., 1]) < 10 - 1e-9)
    assert np.abs(points[end][:, 2] - 2 - 0.2 * (np.abs(points[end][:, 0]) - 20)).max() < 1e-9
    side = (np.abs(points[..., 1]) > 10) & (np.abs(points[..., 0]) < 15)
    assert np.abs(points[side][:, 2] - points[side][:, 0]**2 / 200).max() < 1e-9
    assert normals[..., 2].min() > 0.9
    # Beyond a blank by 2 mm, in plan.
    border = np.array([[-23, -11], [23, -11], [23, 11], [-23, 11]], float)
    wide = np.hypot(3.0, 1.0) + 2.0
    assert abs(no_holder.width_for(trough(), border, 2.0) - wide * np.hypot(1.0, 0.2)) < 1e-9


def test_no_strips():
    """Check that a rim that is steep, or hollow in plan, is told."""
    assert no_holder.is_shallow(trough())
    steep = trough()
    steep.net[..., 2] *= 3.0
    assert not no_holder.is_shallow(steep)
    corner = trough([(7, 3), (6, 3), (7, 2), (6, 2)])
    with pytest.raises(Problem, match=r"near x y z = .* hollow there: take a smaller --margin"):
        no_holder.continued(corner, WIDTH + 1.0)


@pytest.mark.slow
def test_panel(tmp_path, program):
    """Check the tools of a panel on a saddle: both sides of it in the closed press, wider than the blank, smooth at the
    rim, and an input file without a holder that the program takes."""
    write(tmp_path, ["saddle_panel"])
    said = call("tool", tmp_path / "saddle_panel.step", tmp_path / "tools", "--thickness", 1)
    assert "holder     none, as no free edge of the part climbs by more than 10 degrees" in said, said
    assert sorted(path.stem for path in (tmp_path / "tools").glob("*.bez")) == ["die", "punch"]
    travel = float(said.split("travel")[1].split()[0])
    with session() as gmsh:
        shape = read_part(gmsh, Request(tmp_path / "saddle_panel.step", toward=(0, 0, 1))).shape
    punch, die = (read(tmp_path / "tools" / f"{tool}.bez") for tool in ("punch", "die"))
    assert abs(extent(die)[1][2]) < 1e-6
    # The punch stands on the sheet at the start.
    down = np.array([0.0, 0.0, shape.place[:, 2].min() - 1.0])
    for net, move, gap in ((punch, 0.0, 0.0), (die, travel, GAP)):
        assert not len(folded(net)) and kinks(net, find_joints(net)).max() < 1.0
        points = shape.place - down - (0.0, 0.0, move)
        off = np.linalg.norm(Distance(net, 1.0).nearest(points)[0] - points, axis=1)
        assert np.abs(off - gap).max() < 0.01, (gap, np.abs(off - gap).max())
    deck = (tmp_path / "tools" / "draw.dat").read_text()
    assert "clamp" not in deck and "holder" not in deck.split("*TITLE")[1] and "fix = x y" in deck
    low, size = (np.array(deck.split(f"  {word} = ")[1].split()[:2], float) for word in ("origin", "size"))
    for net in (punch, die):
        box = np.array(extent(net))[:, :2]
        assert (box[0] < low - 1.5).all() and (box[1] > low + size + 1.5).all()
    done = subprocess.run([program, "--check", tmp_path / "tools" / "draw.dat"], capture_output=True, text=True,
                          check=False)
    assert done.returncode == 0, done.stderr
