# SPDX-License-Identifier: GPL-3.0-or-later
"""Export of the sheet: a stretched bar in all forms, its shape, thickness, stress and strain, and refusals."""

import subprocess
from pathlib import Path

import numpy as np
import pyvista as pv
import pytest
from helpers import call
from test_study import DECK

import dd3
from dd3.dyna.cards import Reader
from dd3.dyna.mesh import DynaMesh
from dd3.errors import Problem
from dd3.fields import Fields
from dd3.mesh import read_inp


@pytest.fixture
def bar(program):
    """Run the stretched bar; return its last step."""
    Path("bar.dat").write_text(DECK)
    subprocess.run([program, "--quiet", "bar.dat"], check=True, capture_output=True)
    return dd3.open("bar.out").fields[-1]


def cards(path, keyword):
    """Return the lines of a keyword."""
    text = Path(path).read_text()
    return text.split(f"*{keyword}\n")[1].split("\n*")[0].splitlines()


def dyna_mesh(name):
    """Return nodes and cells of a keyword file."""
    mesh = DynaMesh(Reader(Path(name)))
    return mesh.nodes, mesh.cells


def test_export(bar):
    """Check the files against the last step of the run."""
    call("export", "bar.out", "last.inp")
    mesh = read_inp(Path("last.inp"), None)
    assert np.allclose(list(mesh.nodes.values()), bar.points) and len(mesh.elements) == 2
    call("export", "bar.out", "first.inp", "--at", "pull:0")
    first = np.array(list(read_inp(Path("first.inp"), None).nodes.values()))
    assert np.allclose(first.max(axis=0), [4, 2, 1])
    call("export", "bar.out", "last.vtu")
    grid = pv.read("last.vtu")
    assert np.allclose(grid.points, bar.points) and np.allclose(grid.cell_data["stress"], bar.cell_data["stress"])
    said = call("export", "bar.out", "solids.k")
    assert "pull" in said and "2 elements" in said
    nodes, cells = dyna_mesh("solids.k")
    assert np.allclose([nodes[i] for i in sorted(nodes)], bar.points) and len(cells) == 2
    rows = cards("solids.k", "INITIAL_STRESS_SOLID")
    values = np.array([[float(line[10 * k:10 * k + 10]) for k in range(7)] for line in rows[1::2]])
    assert np.allclose(values[:, :6], bar.cell_data["stress"], rtol=1e-3, atol=1e-3 * values[0, 0])
    assert np.allclose(values[:, 6], bar.cell_data["equivalent_plastic_strain"], rtol=1e-3)


def test_shells(bar):
    """Check the mid-surface: its place, and the thickness that the fields have."""
    call("export", "bar.out", "shells.k", "--shells")
    nodes, cells = dyna_mesh("shells.k")
    place = np.array([nodes[i] for i in sorted(nodes)])
    assert len(nodes) == 6 and len(cells) == 2
    assert np.allclose(place[:, 2], bar.points[:, 2].max() / 2) and np.isclose(place[:, 0].max(), bar.points[:, 0].max())
    rows = cards("shells.k", "ELEMENT_SHELL_THICKNESS")
    thickness = np.array([[float(line[16 * k:16 * k + 16]) for k in range(4)] for line in rows[1::2]])
    assert np.allclose(thickness, bar.cell_data["thickness"][:, None])
    rows = cards("shells.k", "INITIAL_STRESS_SHELL")
    count = int(rows[0][20:30])
    assert count > 1 and len(rows) == 2 * (1 + count)
    values = np.array([[float(line[10 * k:10 * k + 10]) for k in range(8)] for line in rows if "e" in line])
    values = values.reshape(2, count, 8)
    assert np.allclose(values[..., 7], bar.cell_data["equivalent_plastic_strain"][:, None], rtol=1e-3)
    assert np.allclose(values[..., 1], bar.cell_data["stress"][:, None, 0], rtol=1e-3)
    assert np.allclose(values[..., 0], np.polynomial.legendre.leggauss(count)[0], atol=1e-3)
    # A step before the end has the middle of the elements.
    call("export", "bar.out", "first.k", "--shells", "--at", "pull:0")
    assert len(cards("first.k", "INITIAL_STRESS_SHELL")) == 4


def test_narrow_shells(program):
    """Check that elements that are shorter than the sheet is thick give its mid-surface."""
    Path("narrow.dat").write_text(DECK.replace("divisions = 2 1 1", "divisions = 2 6 1"))
    subprocess.run([program, "--quiet", "narrow.dat"], check=True, capture_output=True)
    call("export", "narrow.out", "shells.k", "--shells")
    nodes, cells = dyna_mesh("shells.k")
    top = dd3.open("narrow.out").fields[-1].points[:, 2].max()
    assert len(nodes) == 21 and len(cells) == 12 and np.allclose([place[2] for place in nodes.values()], top / 2)


def test_materials(program):
    """Check that two materials are parts and element sets, and that a back-stress is named as left out."""
    region = "*REGION half\n  points = 2 0  2 2\n  side = right\n  material = other\n"
    other = ("*MATERIAL other\n  young = 2e5\n  poisson = 0.3\n  yield = von_mises\n  hardening = ${hardening}\n"
             "  backstress = prager k=9\n")
    Path("two.dat").write_text(DECK + region + other)
    subprocess.run([program, "--quiet", "two.dat"], check=True, capture_output=True)
    fields = Fields(Path("two.out"))
    back = fields.values(fields.last, "back_stress", at_cells=True)[0]
    assert (fields.component(fields.last, "back_stress:13", at_cells=True)[0] == back[:, 5]).all()
    # At the weld line, x = 2 before, the mean is that of the material that has it.
    at_nodes, place = fields.values(fields.last, "back_stress")[0][:, 0], fields.points(0)[:, 0]
    assert back[0, 0] == 0 and back[1, 0] > 1e-3 and np.allclose(at_nodes[place > 1.9], back[1, 0], rtol=1e-2)
    tensors = fields.values(fields.last, "stress")[0][:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    assert np.allclose(fields.component(fields.last, "stress")[0], np.linalg.norm(tensors, axis=(1, 2)))
    with pytest.raises(Problem, match="components? 'x' of 'back_stress'; there are: 11, 22"):
        fields.component(fields.last, "back_stress:x")
    said = call("export", "two.out", "two.k")
    assert "parts: 1 m, 2 other" in said and "left out: back-stresses" in said
    assert [int(line[8:16]) for line in cards("two.k", "ELEMENT_SOLID")] == [1, 2]
    call("export", "two.out", "shells.k", "--shells")
    assert [int(line[8:16]) for line in cards("shells.k", "ELEMENT_SHELL_THICKNESS")[::2]] == [1, 2]
    call("export", "two.out", "two.inp")
    assert read_inp(Path("two.inp"), None).element_sets == {"m": {1}, "other": {2}}


def test_refusals(program):
    """Check requests that cannot be met."""
    Path("two.dat").write_text(DECK.replace("divisions = 2 1 1", "divisions = 2 1 2").replace("solid_shell", "hex8"))
    subprocess.run([program, "--quiet", "two.dat"], check=True, capture_output=True)
    assert "one layer" in call("export", "two.out", "x.k", "--shells", expect=2)
    assert "unknown kind of file" in call("export", "two.out", "x.stl", expect=2)
    assert "--shells takes a file of LS-DYNA" in call("export", "two.out", "x.inp", "--shells", expect=2)
    assert "no travel 3 mm" in call("export", "two.out", "x.inp", "--at", "3", expect=2)
    assert "No such" in call("export", "none.out", "x.inp", expect=2)
