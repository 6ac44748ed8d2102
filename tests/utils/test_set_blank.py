# SPDX-License-Identifier: GPL-3.0-or-later
"""Blank of a part: lines around an outline, and the blank of a surface that is bent along straight lines."""
from pathlib import Path

import numpy as np
import part_set
import pytest
from helpers import call
from scipy.spatial.distance import pdist
from test_tool_surfaces import read

from dd3.mesh import read_inp
from dd3.tools.patch_distance import Distance
from dd3.tools.set_blank import Blank, area_of, blank_of, simplified, widened
from dd3.tools.surface import Surface, from_nodes


def test_widened():
    """Check the line at a distance from a rectangle: straight sides and rounded corners."""
    a, b, margin = 80.0, 50.0, 6.0
    line = widened(np.array([[0, 0], [a, 0], [a, b], [0, b]]), margin)
    assert area_of(line) == pytest.approx(a * b + 2 * margin * (a + b) + np.pi * margin**2, rel=5e-3)
    assert np.abs(line.min(axis=0) + margin).max() < 0.1 * margin
    assert np.abs(line.max(axis=0) - np.array([a, b]) - margin).max() < 0.1 * margin
    assert len(line) < 40


def test_simplified():
    """Check that the points that are left are those of the corners, and that a circle stays within the tolerance."""
    side = np.linspace(0, 1, 11)[:-1, None]
    corner = np.array([[0.0, 0], [4, 0], [4, 3], [0, 3]])
    ring = np.concatenate([p + side * (q - p) for p, q in zip(corner, np.roll(corner, -1, axis=0))])
    assert area_of(simplified(ring, 1e-6)) == pytest.approx(12)
    assert len(simplified(ring, 1e-6)) == 4
    angle = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    kept = simplified(10 * np.stack([np.cos(angle), np.sin(angle)], axis=1), 0.05)
    middle = 0.5 * (kept + np.roll(kept, -1, axis=0))
    assert np.linalg.norm(middle, axis=1).min() > 10 - 0.06 and len(kept) < 60


def test_inclined(tmp_path, program):
    """Check that a blank on an inclined binder is as large as the flat one and lies on the die, below the holder."""
    flat = np.array([[0.0, 0], [80, 0], [80, 50], [0, 50]])
    blank = Blank(flat, False, slope=np.array([0.1, -0.2]), height=3.0)
    points = blank.placed(flat)
    assert np.abs(pdist(points) - pdist(flat)).max() < 1e-9
    assert np.abs((points - points[0]) @ blank.normal).max() < 1e-9
    assert points.mean(axis=0)[:2] == pytest.approx(flat.mean(axis=0))
    assert (Blank(flat, False).placed(flat)[:, :2] == flat).all()
    part = part_set.write(tmp_path, ["leaning_tray"])["leaning_tray"]
    said = call("tool", part, tmp_path / "tools", "--program", program)
    deck = (tmp_path / "tools" / "draw.dat").read_text()
    assert 'file = "blank.inp"' in deck
    assert not any(text in deck for text in ("*PHASE gravity", "*PHASE close", "*BLANK"))
    touch, clamp = deck.split("*PHASE touch")[1].split("*PHASE clamp")
    assert "displace = middle x 0" in touch and "free = middle x y" in clamp
    assert "time       about" in said and "error" not in said, said
    nodes = np.array(list(read_inp(tmp_path / "tools" / "blank.inp", None).nodes.values()))
    for tool, own in zip(("die", "holder"), np.split(nodes, 2)):
        surface = Distance(read(tmp_path / "tools" / f"{tool}.bez"), 4.0)
        away = np.linalg.norm(surface.nearest(own)[0] - own, axis=1)
        beside = own[:, 1] < own[:, 1].min() + 10
        assert away[beside].max() < 1e-6, (tool, away[beside].max())


def test_bent_strip():
    """Check the blank of a strip around a quarter of a cylinder with two legs: the developed length of its middle."""
    radius, leg, width, thickness = 10.0, 30.0, 40.0, 2.0
    length = np.linspace(0, leg, 7)
    angle = np.linspace(0, np.pi / 2, 9)
    x = np.concatenate([-leg + length, radius * np.sin(angle[1:]), np.full(6, radius)])
    z = np.concatenate([0 * length, radius * np.cos(angle[1:]) - radius, -radius - length[1:]])
    y = np.linspace(0, width, 9)
    u, v = np.arange(0, len(x) - 2, 2), np.arange(0, len(y) - 2, 2)
    nodes = np.array([[[[x[j + b], y[i + a], z[j + b]] for b in range(3)] for a in range(3)] for i in v for j in u])
    surface = Surface(from_nodes(nodes), np.zeros(len(nodes), int), ["strip"])
    blank = blank_of(Path("strip"), surface, thickness, 2.0)
    developed = 2 * leg + (radius + thickness / 2) * np.pi / 2
    assert np.sort(np.ptp(blank.box, axis=0)) == pytest.approx([width + 4, developed + 4], abs=0.5)
    assert not blank.cut
    assert blank.pressed(surface) == pytest.approx(width * (leg + radius), rel=1e-6)
