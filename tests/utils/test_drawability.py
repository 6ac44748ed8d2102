# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether parts are likely to split, told before their draw."""
from types import SimpleNamespace

import numpy as np
import part_set
import pytest
from helpers import call

from dd3.tools.drawability import THINNING, InnerPan, inner_pan, judged, thinnest
from dd3.tools.set_blank import Blank
from dd3.tools.surface import Surface, from_nodes
from dd3.triangles import Triangles

MATERIAL = "*MATERIAL own\n  young = 7e4\n  poisson = 0.3\n  yield = von_mises\n  hardening = voce Y0=100 Q=100 b=9\n"


@pytest.fixture(scope="module")
def parts(tmp_path_factory):
    """Write parts that neck in their draw, and one that does not."""
    return part_set.write(tmp_path_factory.mktemp("parts"), ["tray", "sharp_tray", "stepped_pan"])


def flat(width, y, z, slope=0.0):
    """Return a patch over x from 0 to a width and between two places y, at a height that rises with y."""
    return [[[x, q, z + slope * (q - y[0])] for x in np.linspace(0, width, 3)] for q in np.linspace(*y, 3)]


def test_thinnest():
    """Check the thinning of a square of four triangles that was stretched: 1 - 1/(1.2 1.1), and the place."""
    nodes = np.array([[0, 0, 5], [2, 0, 5], [2, 2, 5], [0, 2, 5], [1, 1, 5], [4, 0, 5]], float)
    mesh = Triangles(nodes, np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 5, 2]]))
    blank = nodes[:, :2] / [1.2, 1.1]
    blank[5, 0] = nodes[5, 0]  # the triangle at the right is compressed
    thinning, place = thinnest(mesh, blank)
    assert thinning == pytest.approx(1 - 1 / (1.2 * 1.1)) and place[0] < 2


def test_inner_pan():
    """Check section and stretch of a floor below a wall of 45 degrees and a step; none without the step."""
    nodes = np.array([flat(10, (0, 6), -4), flat(10, (6, 10), -4, 1.0), flat(10, (10, 20), 0)], float)
    part = Surface(from_nodes(nodes), np.arange(3), ["floor", "wall", "step"])
    found = inner_pan(part, ["floor", "wall", "step"])
    # Of 5 rows of points across the wall two are below half its height and four below the step.
    assert found.area == pytest.approx(10 * (6 + 4 * 2 / 5))
    plan = 6 + 4 * 4 / 5
    assert found.stretch == pytest.approx(1 - plan / (6 + 2**0.5 * 4 * 4 / 5))
    assert inner_pan(part, ["floor", "wall", "island"]) is None


def test_limits(tmp_path):
    """Check the limit of a material, and when the drawing ratio of an inner pan is a warning."""
    blank = Blank(np.array([[0, 0], [100, 0], [100, 100], [0, 100]], float), True, thinning=0.22)
    tools = SimpleNamespace(blank=blank, ratio=1.8, height=0.0, inner_pan=None, lost=0.0)
    assert not judged(tools, None)[1] and THINNING == 0.25
    (tmp_path / "own.dat").write_text(MATERIAL + "  thinning_limit = 0.2\n")
    assert "likely to split" in judged(tools, tmp_path / "own.dat")[1][0]
    tools.inner_pan = InnerPan(1000.0, 0.3)
    assert "drawing ratio 3.16" in judged(tools, None)[1][0]
    for pan in (InnerPan(1000.0, 0.2), InnerPan(2600.0, 0.3)):  # stretched; drawn
        tools.inner_pan = pan
        assert not judged(tools, None)[1]
    blank.thinning = None
    assert "not estimated" in judged(tools, None)[0][0][1]


@pytest.mark.parametrize(("name", "told"), [
    ("tray", ""), ("sharp_tray", "thinning of"), pytest.param("stepped_pan", "inner pan", marks=pytest.mark.slow)])
def test_parts(name, told, parts, tmp_path):
    """Check which parts of the set are told to be likely to split."""
    said = call("tool", parts[name], tmp_path / name)
    assert "\n  thinning " in said, said
    assert told in said and ("likely to split" in said) == bool(told), said
