# SPDX-License-Identifier: GPL-3.0-or-later
"""A part in its checking fixture, by the input file that `dd3 deviation --deck` writes: beam theory."""

import subprocess
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from helpers import ROOT, call

from dd3.deviation import compare
from dd3.errors import Problem
from dd3.fixture import read_fixture
from dd3.fixture_deck import materials
from dd3.run import read_frame

YOUNG, DENSITY, WIDTH = 2e5, 7.85e-9, 10.0
INERTIA = WIDTH / 12
STRIP = """*BLANK strip
  size = {length} 10 1
  divisions = 20 2 1
  element = solid_shell
  material = m
*MATERIAL m
  young = 2e5
  poisson = 0
  yield = von_mises
  hardening = linear Y0=200 H=100
*BOUNDARY x
  set = x_min
  fix = x
*SET corner
  near = 0 0 0
*BOUNDARY yz
  set = corner
  fix = y z
*SET other
  near = 0 10 0
*BOUNDARY z
  set = other
  fix = z
"""
BENT = STRIP.format(length=50) + """*PHASE bend
  control = load
  trial = 0.1
  bend = x_max  0 0 0.5  0 -1 0  8.594
*PHASE free
  unload = on
  free = x_max x z
"""
FLAT = STRIP.format(length=200) + """*PHASE wait
  control = load
  trial = 1
  load = x_max 1e-6 0 0
"""
FIXTURE = """{first}face = "lower"
[nominal]
surface = "plane.bez"
[alignment]
by = "locators"
"""


def support(kind, name, at, direction, more=""):
    """Return a locator or clamp of the file."""
    return f'[[{kind}]]\nname = "{name}"\nat = {at}\ndirection = {direction}\n{more}\n'


def computed(program, folder, deck, text, first=""):
    """Run a deck, its part in the fixture, and compare; return the tables by name and what is said."""
    (folder / "part.dat").write_text(deck)
    (folder / "plane.bez").write_text("patch 1 1\n-1 -1 0\n201 -1 0\n-1 11 0\n201 11 0\n")
    (folder / "fixture.toml").write_text(FIXTURE.format(first=first) + text)
    run(program, folder / "part.dat")
    call("deviation", folder / "part.out", "--fixture", folder / "fixture.toml", "--deck", folder / "clamped.dat")
    assert f'  from = "{(folder / "part.out").resolve()}"' in (folder / "clamped.dat").read_text()  # it may have blanks
    run(program, folder / "clamped.dat")
    said = call("deviation", folder / "clamped.out", "--fixture", folder / "fixture.toml")
    tables = {path.stem: pd.read_csv(path) for path in (folder / "clamped.out" / "deviation").glob("*.csv")}
    return tables, said


def run(program, deck):
    """Run an input file, its results beside it."""
    done = subprocess.run([program, "--quiet", "--threads", "1", "--output", deck.with_suffix(".out"), deck],
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_files_of_the_run():
    """Check that files of laws are named from the folder in which the run was made, not from the present one."""
    entries = [{"key": "hardening", "text": 'table file = "a b.csv"', "default": False, "at": {"file": "decks/part.dat"}},
               {"key": "density", "text": "1e-9", "default": False, "at": {"file": "decks/part.dat"}}]
    job = {"command": {"working_directory": "/runs"},
           "input": {"blocks": [{"keyword": "material", "name": "m", "entries": entries}]}}
    lines = materials(job, SimpleNamespace(gravity=None))
    assert '  hardening = table file = "/runs/decks/a b.csv"' in lines


def test_gravity_on_three_locators(program, tmp_path):
    """A strip on locators at its ends sags by 5 q L4/(384 E I); each end carries half of the weight."""
    names = [("a1", [0.5, 0.5, 0]), ("a2", [0.5, 9.5, 0]), ("a3", [199.5, 5, 0])]
    text = "".join(support("locator", name, at, [0, 0, 1]) for name, at in names)
    text += support("locator", "b1", [0, 5, 0], [0, 1, 0], "pin = true")
    text += support("locator", "b2", [200, 5, 0], [0, 1, 0], "pin = true")
    text += support("locator", "c1", [0, 5, 0], [1, 0, 0], "pin = true")
    text += '[[point]]\nname = "m"\nat = [100, 5, 0]\ntolerance = 0.05\n'
    text += f'[gravity]\nacceleration = [0, 0, -9810]\ndensity = {DENSITY}\n'
    tables, _ = computed(program, tmp_path, FLAT, text)
    load = DENSITY * 9810 * WIDTH  # N/mm
    sag = 5 * load * 200**4 / (384 * YOUNG * INERTIA)
    # The normal of the lower face points downwards.
    assert tables["points"]["deviation"][0] == pytest.approx(sag, rel=5e-3)
    force = tables["supports"].set_index("name")["force"]
    assert np.allclose([force["a1"] + force["a2"], force["a3"]], 100 * load, rtol=1e-3)
    said = call("report", tmp_path / "clamped.out", "--fixture", tmp_path / "fixture.toml", "--verdict", expect=1)
    assert "deviation of point m: not good: +0.0" in said and "not good: deviation of point m;" in said
    # The nodes that are held lie 0.5 mm beside the places.
    assert np.allclose(tables["supports"]["gap"][:3], 0, atol=0.02 * sag)


@pytest.mark.parametrize("orders", [(1, 2), (2, 1)])
def test_arc_clamped_flat(program, tmp_path, orders):
    """A strip with the curvature k, half of it beside its plane of symmetry, is clamped flat at its end by
    P = 3 E I k/(2 L), in either order of the two clamps; between it is off by k x2/2 - k (3 L x2 - x3)/(4 L)."""
    text = support("locator", "a1", [0.5, 0.5, 0], [0, 0, 1]) + support("locator", "a2", [0.5, 9.5, 0], [0, 0, 1])
    text += support("locator", "b1", [0, 5, 0], [0, 1, 0], "pin = true")
    for name, y, order in zip(("c1", "c2"), (0.5, 9.5), orders):
        text += support("clamp", name, [49.5, y, 0], [0, 0, -1], f"order = {order}")
    text += '[[point]]\nname = "m"\nat = [25, 5, 0]\n'
    tables, _ = computed(program, tmp_path, BENT, text, 'mirror = ["x"]\n')
    call("deviation", tmp_path / "part.out", "--fixture", tmp_path / "fixture.toml")
    free = pd.read_csv(tmp_path / "part.out" / "deviation" / "map.csv").dropna()
    end = free[free["x"] > 49]
    curvature = 2 * end["z"].mean() / end["x"].mean()**2
    force = 1.5 * YOUNG * INERTIA * curvature / 50
    assert 4e-4 < curvature < 8e-4
    clamps = tables["supports"].set_index("name").loc[["c1", "c2"]]
    assert np.allclose(clamps["force"], force / 2, rtol=0.01)
    held = tables["map"][tables["map"]["x"] > 49.5]["z"]
    assert np.allclose([held.iloc[0], held.iloc[-1]], 0, atol=1e-9)
    x = 25.0
    off = curvature * x**2 / 2 - curvature * (3 * 50 * x**2 - x**3) / (4 * 50)
    assert tables["points"]["deviation"][0] == pytest.approx(-off, rel=0.02)


@pytest.mark.slow
def test_rail_in_two_orders(program, tmp_path):
    """The clamps of a rail that twists close in either order: the same shape and forces at the end. In between, the
    displacement at one by the force of the other is reciprocal (Maxwell 1864), and both forces follow by superposition:
    within 1.6 % at the displacements of 0.44 and 0.15 mm, 0.17 % at a tenth of them."""
    deck = ROOT / "input_files/rail/rail.dat"
    subprocess.run([program, "--quiet", "--threads", "1", "--output", tmp_path / "laid.out", "--set", "material=dc06",
                    "--set", "divisions=20 12 1", "--set", "levels=0", "--set", "points=5", deck], check=True)
    text = (deck.parent / "fixture.toml").read_text()
    clamps = text[text.index("[[clamp]]"):].split("[[clamp]]\n")[1:]
    paths, forces, shapes = [], [], []
    for orders in ((1, 2), (2, 1)):
        rows = [f"[[clamp]]\n{clamp.replace('order = 2', '')}order = {order}\n" for clamp, order in zip(clamps, orders)]
        (tmp_path / "fixture.toml").write_text(text[:text.index("[[clamp]]")] + "".join(rows))
        call("deviation", tmp_path / "laid.out", "--fixture", tmp_path / "fixture.toml", "--deck", tmp_path / "held.dat")
        run(program, tmp_path / "held.dat")
        found = compare(tmp_path / "held.out", read_fixture(tmp_path / "fixture.toml"))
        ends = read_frame(tmp_path / "held.out", "history.csv").groupby("phase", sort=False).last()
        paths.append(ends[["end_z", "middle_z"]].diff().cumsum().iloc[1:].to_numpy())  # after one clamp, after both
        forces.append(ends[["end_rz", "middle_rz"]].iloc[1:].to_numpy())
        shapes.append(found.distance)
        upwards = ends[["a1_rz", "a2_rz", "a3_rz", "end_rz", "middle_rz"]].iloc[-1]
        assert abs(upwards.sum()) < 1e-4 * upwards.abs().sum()
    assert np.nanmax(np.abs(shapes[0] - shapes[1])) < 1e-3
    assert np.allclose(forces[0][1], forces[1][1], rtol=1e-3)
    first, second = (path[0] / force[0][clamp] for clamp, path, force in zip((0, 1), paths, forces))
    assert first[1] == pytest.approx(second[0], rel=0.02)
    assert np.allclose(forces[0][1], np.linalg.solve(np.column_stack([first, second]), paths[0][1]), rtol=0.02)


ONE = "one_sided = true"
PINS = (("b1", [0, 5, 0], [0, 1, 0]), ("b2", [200, 5, 0], [0, 1, 0]), ("c1", [0, 5, 0], [1, 0, 0]))
WEIGHT = DENSITY * 9810 * WIDTH  # N/mm


@pytest.mark.parametrize("direction", [(0, 0, -1), (0.6, 0, -0.8)])
def test_rests_and_a_clamp_with_force(program, tmp_path, direction):
    """Rests at x = 0.5 and 150 carry the weight of a strip and the force at its end, on its upper face; a pin takes the
    force along x: equilibrium of forces and moments."""
    text = "".join(support("locator", name, at, [0, 0, 1], ONE)
                   for name, at in (("a1", [0.5, 0.5, 0]), ("a2", [0.5, 9.5, 0]), ("a3", [150, 5, 0])))
    text += "".join(support("locator", *pin, "pin = true") for pin in PINS)
    text += support("clamp", "d1", [199.5, 5, 0], list(direction), "force = 0.02")
    text += f'[gravity]\nacceleration = [0, 0, -9810]\ndensity = {DENSITY}\n'
    tables, _ = computed(program, tmp_path, FLAT, text)
    force = tables["supports"].set_index("name")["force"]
    along, down = 0.02 * direction[0], -0.02 * direction[2]
    middle = (200 * WEIGHT * 100 + down * 200 + along * 1) / 150  # the nodes at x = 0, 150 and 200
    assert np.allclose([force["a1"] + force["a2"], force["a3"]], [200 * WEIGHT + down - middle, middle], rtol=2e-3)
    assert force["d1"] == pytest.approx(0.02, rel=1e-3)
    assert force["c1"] == pytest.approx(-along, abs=1e-6)


@pytest.mark.parametrize("force", [1, 4])
def test_rest_that_is_reached_or_not(program, tmp_path, force):
    """An arc of the curvature k, pressed by a force at its end towards a rest: it reaches the rest at
    P = 3 E I k/(2 L), above which the rest carries the difference."""
    text = "".join(support("locator", name, [0.5, y, 0], [0, 0, 1], ONE) for name, y in (("a1", 0.5), ("a2", 9.5)))
    text += support("locator", "b1", [0, 5, 0], [0, 1, 0], "pin = true")
    text += support("clamp", "r1", [49.5, 5, 0], [0, 0, 1], ONE)
    text += support("clamp", "d1", [49.5, 5, 0], [0, 0, -1], f"order = 2\nforce = {force}")
    text += f'[gravity]\nacceleration = [0, 0, -9810]\ndensity = {DENSITY}\n'
    tables, _ = computed(program, tmp_path, BENT, text, 'mirror = ["x"]\n')
    call("deviation", tmp_path / "part.out", "--fixture", tmp_path / "fixture.toml")
    free = pd.read_csv(tmp_path / "part.out" / "deviation" / "map.csv").dropna()
    stiffness = 3 * YOUNG * INERTIA / 50**3
    needed = free[free["x"] > 49]["z"].mean() * stiffness - 0.375 * WEIGHT * 50
    assert 2 < needed < 3
    carried = tables["supports"].set_index("name")["force"]
    assert carried["d1"] == pytest.approx(force, rel=1e-3)
    assert carried["r1"] == pytest.approx(max(force - needed, 0), rel=0.01)
    assert carried["a1"] + carried["a2"] + carried["r1"] == pytest.approx(force + 50 * WEIGHT, rel=1e-3)


def test_wrong_supports_are_refused(tmp_path):
    """A clamp with force and stop, a pin that is one-sided."""
    for kind, more, message in (("clamp", "force = 1\nstop = 0.1", "force beside stop"),
                                ("clamp", "force = -1", "expected a force > 0"),
                                ("locator", "pin = true\n" + ONE, "pin beside one_sided")):
        (tmp_path / "fixture.toml").write_text(support(kind, "a1", [0, 0, 0], [0, 0, 1], more))
        with pytest.raises(Problem, match=message):
            read_fixture(tmp_path / "fixture.toml")


def test_direction_that_is_no_axis(program, tmp_path):
    """A clamp in another direction than x, y, z cannot hold a node, and is refused with the reason."""
    (tmp_path / "part.dat").write_text(FLAT)
    (tmp_path / "plane.bez").write_text("patch 1 1\n-1 -1 0\n201 -1 0\n-1 11 0\n201 11 0\n")
    text = "".join(support("locator", name, at, [0, 0, 1])
                   for name, at in (("a1", [0.5, 0.5, 0]), ("a2", [0.5, 9.5, 0]), ("a3", [199.5, 5, 0])))
    text += "".join(support("locator", name, at, direction, "pin = true") for name, at, direction in (
        ("b1", [0, 5, 0], [0, 1, 0]), ("b2", [200, 5, 0], [0, 1, 0]), ("c1", [0, 5, 0], [1, 0, 0])))
    text += support("clamp", "d1", [100, 5, 0], [0, 1, -1])
    (tmp_path / "fixture.toml").write_text(FIXTURE.format(first="") + text)
    run(program, tmp_path / "part.dat")
    said = call("deviation", tmp_path / "part.out", "--fixture", tmp_path / "fixture.toml", "--deck",
                tmp_path / "clamped.dat", expect=2)
    assert "nodes are held along x, y or z only" in said
