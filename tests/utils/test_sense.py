# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of sense in the program: the normal of a sheet in any plane, restart files of other versions, long titles,
sets of a mesh file by others."""

import json
import math
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers import call

from dd3.fields import Fields
from dd3.mesh import NATURAL

DECK = """*TITLE
  Tension along x of a strip of 10 x 4 x 1 mm
*MESH strip
  file = strip.inp
  element = solid_shell
  material = steel
*MATERIAL steel
  young = 2.1e5
  poisson = 0.3
  yield = hill48 r0=1.79 r45=1.51 r90=2.27
  hardening = swift K=550 e0=0.005 n=0.22
  {axes}
*BOUNDARY end
  set = end
  fix = {along}
*BOUNDARY corner
  set = corner
  fix = {across}
*BOUNDARY beside
  set = beside
  fix = {normal}
*PHASE pull
  control = load
  trial = 0.1
  displace = pulled {along} 2
"""


def write_strip(axes, text=DECK, material_axes=""):
    """Write the deck of a strip whose length, width and thickness are along the given axes, and its mesh."""
    names = "xyz"
    with Path("strip.inp").open("w") as file:
        file.write("*HEADING\nstrip\n*NODE\n")
        for label, (i, j, k) in enumerate(np.ndindex(5, 3, 2), 1):
            point = np.zeros(3)
            point[list(axes)] = 2.5 * i, 2.0 * j, 1.0 * k
            file.write(", ".join([str(label), *(f"{value:.6E}".replace("E", "D") for value in point)]) + "\n")
        file.write("*ELEMENT, TYPE=C3D8, ELSET=metal\n")
        # The axes may be left-handed: the other face first then.
        lower, upper = (0, 1) if np.linalg.det(np.eye(3)[list(axes)]) > 0 else (1, 0)
        for label, (i, j) in enumerate(np.ndindex(4, 2), 1):
            ring = [6 * (i + a) + 2 * (j + b) + 1 for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
            file.write(", ".join(map(str, [label, *(n + lower for n in ring), *(n + upper for n in ring)])) + "\n")
        file.write("*NSET, NSET=end, GENERATE\n1, 6\n*NSET, NSET=pulled, GENERATE\n25, 30\n*NSET, NSET=corner\n1\n"
                   "*NSET, NSET=beside\n1, 5, 25\n*NSET, NSET=of, ELSET=metal\n*NSET, NSET=two\nend, pulled, 7\n")
    along, width, normal = (names[axis] for axis in axes)
    deck = text.format(along=along, across=f"{width} {normal}", normal=normal, axes=material_axes)
    Path("strip.dat").write_text(deck)


def run(program, *options, expect=0):
    """Run the program; return what it says."""
    done = subprocess.run([program, "--threads", "1", *options, "strip.dat"], capture_output=True, text=True,
                          check=False)
    assert done.returncode == expect, done.stdout + done.stderr
    return done.stdout + done.stderr


def r_value(axes, out="strip.out"):
    """Return the ratio of the logarithmic strains along the width and the thickness in the middle."""
    fields = Fields(out)
    start, end = fields.points(0), fields.points(-1)
    middle = np.isclose(start[:, axes[0]], 5.0)
    strain = [math.log(np.ptp(end[middle, axis]) / np.ptp(start[middle, axis])) for axis in axes[1:]]
    return strain[0] / strain[1]


@pytest.mark.parametrize("axes, material_axes", (
    ((0, 1, 2), ""), ((0, 2, 1), ""), ((0, 1, 2), "normal_direction = 0 0 -1"),
    ((2, 0, 1), "rolling_direction = 0 0 1"), ((1, 2, 0), "rolling_direction = 0 1 0"),
    ((0, 2, 1), "normal_direction = 0 1 0")))
def test_normal(program, axes, material_axes):
    """The r-value is that of a flat strip, in whatever plane the mesh stands; the log tells the normal."""
    write_strip(axes, material_axes=material_axes)
    said = run(program)
    # The elastic part of the strains makes it smaller than 1.79.
    assert r_value(axes) == pytest.approx(1.783, abs=1e-3)
    told = "normal_direction is left out; the normal of the sheet is "
    told += " ".join(str(int(axes[2] == i)) for i in range(3))
    assert (told in said) == (axes[2] != 2 and "normal" not in material_axes), said
    assert "W020" not in said
    normal = json.loads(Path("strip.out/run.json").read_text())["materials"][0]["normal_direction"]
    assert np.abs(normal).tolist() == [float(axes[2] == i) for i in range(3)]


def test_normal_against(program):
    """A normal in the plane of the sheet is warned of."""
    write_strip((0, 2, 1), material_axes="normal_direction = 0 0 1")
    said = run(program, "--check")
    assert "strip.dat:12: warning W020: normal_direction = 0 0 1 of material 'steel' is up to 90 degrees away" in said


def test_sets(program):
    """Sets of a mesh file by other sets and by the nodes of elements."""
    for name, node, there in (("of", 8, True), ("two", 8, False), ("two", 7, True), ("two", 30, True)):
        write_strip((0, 1, 2), DECK + f"*SET probe\n  nodes = {node}\n  of = {name}\n")
        said = run(program, "--check", expect=0 if there else 2)
        assert ("error E146" in said) == (not there), said


def test_restart_of_other_version(program):
    """A restart file of another version is refused, with both versions."""
    write_strip((0, 1, 2))
    run(program)
    with h5py.File("strip.out/restart.h5", "r+") as file:
        here = file.attrs["version"].decode()
        file.attrs.modify("version", np.bytes_("1.8.0"))
    said = run(program, "--restart", "strip.out/restart.h5", "--output", "again", expect=2)
    assert "error E204: 'strip.out/restart.h5' was written by dd3imp 1.8.0; this is " + here in said


def test_long_title(program):
    """A title of 70 kB is written whole."""
    line = "  note of the meeting, one line of eighty characters or so, pasted here\n"
    write_strip((0, 1, 2), DECK.replace("*TITLE\n", "*TITLE\n" + 1000 * line))
    run(program, "--quiet")
    with h5py.File("strip.out/fields.vtkhdf") as file:
        title = file["job"].attrs["title"]
    assert len(title) > 65536 and title == json.loads(Path("strip.out/run.json").read_text())["title"]
    assert Fields("strip.out").points(-1).shape == (30, 3)


def test_middle_nodes(program):
    """A node between the corners of one element and at a corner of another is refused, here and in `dd3 mesh`."""
    labels, elements = {}, []
    for x, y, size in ((0, 0, 2), (2, 0, 1), (2, 1, 1)):
        corners = [(x + 1.0 + a, y + size * (1 + b) / 2, (1 + c) / 2) for a, b, c in NATURAL[:20]]
        elements.append([labels.setdefault(corner, len(labels) + 1) for corner in corners])
    lines = ["*NODE", *(f"{label}, {x}, {y}, {z}" for (x, y, z), label in labels.items()), "*ELEMENT, TYPE=C3D20"]
    for number, nodes in enumerate(elements, 1):
        lines += [", ".join(map(str, [number, *nodes[:10]])) + ",", ", ".join(map(str, nodes[10:]))]
    lines += ["*NSET, NSET=end, GENERATE", "1, 2", "*NSET, NSET=pulled, GENERATE", "1, 2", "*NSET, NSET=corner", "1",
              "*NSET, NSET=beside", "1"]
    write_strip((0, 1, 2), DECK.replace("solid_shell", "hex20"))
    Path("strip.inp").write_text("\n".join(lines) + "\n")
    there = labels[2.0, 1.0, 0.0]
    said = run(program, "--check", expect=2)
    assert f"error E147: element 1 has node {there} between its corners, and element 3 at a corner" in said
    said = call("mesh", "strip.inp", "other.inp", expect=2)
    assert f"node {there} is between the corners of element 1 and at a corner of another" in said
