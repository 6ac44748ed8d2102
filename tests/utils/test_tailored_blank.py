# SPDX-License-Identifier: GPL-3.0-or-later
"""Regions of a blank on a mesh that is refined: each element keeps material and thickness of its parent."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

from dd3.forming_limit import Criteria
from dd3.forming_limit_diagram import figure
from dd3.sheet import Sheet

DECK = """*BLANK strip
  size = 40 10 1
  divisions = 8 2 1
  material = steel
  adaptive = 1
*REGION strong
  points = 17 -1  23 11
  side = right
  thickness = 1.2
  material = dp
*MATERIAL steel
  young = 2.1e5
  poisson = 0.3
  yield = von_mises
  hardening = swift K=565 e0=0.007 n=0.26
  forming_limit = -0.2 0.5  0 0.3  0.2 0.4
*MATERIAL dp
  young = 2.1e5
  poisson = 0.3
  yield = von_mises
  hardening = swift K=600 e0=0.005 n=0.2
  forming_limit = -0.2 0.25  0 0.02  0.1 0.12
*BOUNDARY left
  set = x_min
  fix = x y z
*PHASE bend
  control = load
  trial = 0.05
  bend = x_max  0 5 0.5  0 -1 0  150
"""


@pytest.fixture
def run(program):
    """Return the results of a strip bent across its inclined weld line."""
    Path("job.dat").write_text(DECK)
    subprocess.run([program, "--threads", "1", "--quiet", "job.dat"], check=True)
    return Sheet("job.out")


def beyond(points):
    """Return the distance of points along x from the weld line."""
    return points[:, 0] - 17 - 0.5 * (points[:, 1] + 1)


def test_materials_of_the_parts(run):
    """Elements on both sides of the line, also the divided ones, have their materials; nodes on it have none."""
    for step in (0, run.last):
        material, at_nodes = run.values(step, "material", True)[0], run.values(step, "material")[0]
        start = run.points(step) - run.values(step, "displacement")[0]
        centres = start[run.cells(step)[0].reshape(-1, 8)].mean(axis=1)
        assert np.array_equal(material, np.where(beyond(centres) > 0, 2, 1))
        on_line = np.abs(beyond(start)) < 1e-4
        assert (at_nodes == 0).sum() >= 6 and on_line[at_nodes == 0].all()
    assert len(run.values(run.last, "material", True)[0]) > len(run.values(0, "material", True)[0])


def test_thickness_of_the_parts(run):
    """The thickness of the initial sheet is that of each part, with a ramp beside the line; thinning refers to it."""
    thickness, thinning = (run.values(0, name, True)[0] for name in ("thickness", "thinning"))
    assert np.array_equal(np.unique(thickness.round(2)), [1, 1.1, 1.2]) and np.abs(thinning).max() == 0


def test_limit_of_each_material(run):
    """The forming limit diagram judges each part by its own curve."""
    _, found = figure("job.out", surface="lower", criteria=Criteria(margin=0.01))
    material = np.concatenate([run.values(run.last, "material", cells)[0] for cells in (False, True)])
    critical = np.flatnonzero(found.zone == 4)
    assert len(critical) and set(material[critical]) <= {0, 2}
    assert "steel" in found.said[0] and "dp" in found.said[0]
