# SPDX-License-Identifier: GPL-3.0-or-later
"""What holds a blank in the input file of a part: force of the pad, locating pins, weight; materials by name."""

import argparse
import re
from types import SimpleNamespace

import numpy as np
import part_set
import pytest
from helpers import call

from dd3.errors import Problem
from dd3.tools import pad_force, set_deck, set_material, tool_set
from dd3.tools.pad_force import Pin, Pull
from dd3.tools.set_blank import Blank


@pytest.fixture(scope="module")
def parts(tmp_path_factory):
    """Write an angle, with holes in its floor."""
    return part_set.write(tmp_path_factory.mktemp("parts"), ["angle"])


def test_force():
    """Check the force of the pad by the closed forms, with a constant stress."""
    tools = SimpleNamespace(shoulder=4.0, bend=3.0, travel=50.0, pulls=[Pull(np.array([0.0, -70.0, 0.0]), True)])
    options = argparse.Namespace(thickness=2.0, clearance=0.2)
    # 70 mm of a flange: that of the holder, and bending and straightening about 5 mm, held on both sides.
    expected = 5000 + 70 * 300 * 4 / (2 * 5) / 0.2
    assert pad_force.needed(tools, lambda strain: 300.0, 5000.0, options, 0.1) == pytest.approx(expected)
    tools.pulls[0].held = False
    arm = (9.2**2 - 9.0**2)**0.5
    expected = 1.5 * 70 * 300 * 4 / 4 / arm
    assert pad_force.needed(tools, lambda strain: 300.0, 0.0, options, 0.1) == pytest.approx(expected)
    tools.travel = 4.0  # the leg is not bent to 90 degrees
    arm = (9.2**2 + 5.0**2 - 9.0**2)**0.5
    assert pad_force.needed(tools, lambda strain: 300.0, 0.0, options, 0.1) == pytest.approx(
        1.5 * 70 * 300 * 4 / 4 / arm)
    tools.pulls.append(Pull(np.array([0.0, 70.0, 0.0]), False))
    assert pad_force.needed(tools, lambda strain: 300.0, 0.0, options, 0.1) == pytest.approx(0.0)


def test_force_for_pins():
    """Check that the pad takes what the holes of the pins do not bear, by the closed form."""
    pins = [Pin("round 6", np.array([-15.0, 25.0]), 6.0), Pin("round 5", np.array([15.0, 25.0]), 5.0)]
    tools = SimpleNamespace(shoulder=4.0, bend=3.0, travel=50.0, pulls=[Pull(np.array([0.0, -70.0, 0.0]), False)],
                            pins=pins)
    given = tools, lambda strain: 300.0, 0.0, argparse.Namespace(thickness=2.0, clearance=0.2), 0.1
    # A moment of 300 MPa about the middle of the sheet at 4 mm; both pins hold along y.
    pull = 70 * 300 * 4 / 4 / 4
    assert np.linalg.norm(pad_force.pull_of_floor(*given)) == pytest.approx(pull)
    bears = 11 * 2 * 300 * 3**0.5 / 2
    assert pull < bears and pad_force.with_pins(*given) == 0.0
    tools.pulls[0].along *= 3
    assert pad_force.with_pins(*given) == pytest.approx((3 * pull - bears) / 0.2)
    # Across, the second pin moves with the blank.
    tools.pulls[0].along = np.array([-210.0, 0.0, 0.0])
    assert pad_force.with_pins(*given) == pytest.approx((3 * pull - bears * 6 / 11) / 0.2)
    tools.pins = []
    assert pad_force.with_pins(*given) == 0.0


def test_angle(parts, tmp_path, program):
    """Check the pad and the pins of an angle, and that the program takes its input file."""
    said = call("tool", parts["angle"], tmp_path / "tools", "--program", program)
    text = (tmp_path / "tools" / "draw.dat").read_text()
    assert "a mild steel is assumed" in said and "error" not in said, said
    force = float(re.search(r"\n  pad = (\S+)", text)[1])
    # A leg of 80 mm between radii of 12 and 3 mm, with the stress of the steel that is assumed: what holds its floor,
    # and what leaves to two holes of 6 mm what they bear at 150 MPa and a little more.
    stress = 2 / 3**0.5 * 530 * (0.125 * 2 / 3**0.5 + (150 / 530)**(1 / 0.22))**0.22
    holds = 1.5 * 80 * stress * 4 / 4 / (17.2**2 - 17.0**2)**0.5
    assert holds < force < (80 * stress * 4 / 4 / 4 - 2 * 6 * 2 * 150) / 0.2
    assert "leaves to the pins what their holes bear" in said, said
    # Two of the four holes are in the floor.
    places = re.findall(r"in the hole round 6 at x y (\S+) (\S+):", said)
    assert sorted((float(x), float(y)) for x, y in places) == [(-15, 25), (15, 25)], said
    assert text.count("*BOUNDARY pin_") == 2 and "fix = x y\n" in text and "fix = y\n" in text, text
    assert text.count("\n  pin = 6\n") == 2 and "  keep = on\n" in text, text
    assert "gravity" not in text and "\n  density = " in text, text
    # The blank goes on beyond the open end of the floor, at y = 40, and beyond the bend on the other side.
    low, wide = (float(re.search(rf"\n  {key} = \S+ (\S+) ", text)[1]) for key in ("origin", "size"))
    assert low + wide > 40 + 2 * 2 and low < -30, text


def test_pins():
    """Check that the second pin leaves the distance from the first one free."""
    text = set_deck.pinned([Pin("round 6", np.array([0.0, 0.0]), 6.0), Pin("round 5", np.array([1.0, 9.0]), 5.0)])
    assert re.findall(r"pin = (.*)", text) == ["6", "5"], text
    assert re.findall(r"fix = (.*)", text) == ["x y", "x"] and "near = 1 9 0" in text, text


def test_free_stroke():
    """Check the stroke over which one of two walls is formed alone, and that closed rims have none."""
    high, low = (SimpleNamespace(rim=SimpleNamespace(points=np.array([[0.0, y, z], [9.0, y, z]]), closed=False))
                 for y, z in ((-30.0, 25.0), (28.0, 15.0)))
    assert tool_set.free_stroke(SimpleNamespace(reaches=[high, low])) == pytest.approx(10.0)
    low.rim.closed = True
    assert tool_set.free_stroke(SimpleNamespace(reaches=[high, low])) == 0.0


def test_weight(tmp_path):
    """Check the sag of a blank by the deflection of a beam, and when it is told."""
    options = argparse.Namespace(material=None, thickness=0.8)
    outline = np.array([[0, 0], [600, 0], [600, 300], [0, 300]], float)
    blank = Blank(outline, False)
    load, inertia = 7.85e-9 * 9810 * 0.8, 0.8**3 / 12
    expected = 5 / 384 * load * 600**4 / (2.1e5 / (1 - 0.3**2) * inertia)
    assert set_deck.sag(options, blank) == pytest.approx(expected)
    tools = SimpleNamespace(blank=blank, closing=10.0, surfaces={})
    assert "laid on the die" in set_deck.notes(options, tools)[0][1]
    tools.closing = 0.0
    assert not set_deck.notes(options, tools)
    (tmp_path / "light.dat").write_text("*MATERIAL light\n  young = 7e4\n  poisson = 0.3\n  yield = von_mises\n"
                                        "  hardening = perfect Y0=100\n")
    options.material = tmp_path / "light.dat"
    assert set_deck.sag(options, blank) is None
    assert "no hardening" in set_material.warnings(options.material)[0]


def test_materials(parts, tmp_path, program):
    """Check materials of the library by their names, and what is said of a name that it has not."""
    path = set_material.found(set_material.Path("dp600"))
    assert path.is_file() and set_material.name_of(path) == "dp600" and set_material.found(None) is None
    stress = set_material.stress_of(program, None)
    assert stress(0.1) == pytest.approx(2 / 3**0.5 * 530 * (0.1 * 2 / 3**0.5)**0.22, rel=0.02)
    with pytest.raises(Problem, match="no such file"):
        set_material.found(tmp_path / "none.dat")
    said = call("tool", parts["angle"], tmp_path / "tools", "--material", "dp60", expect=2)
    assert "no material of the library" in said and " dp600 " in said, said
