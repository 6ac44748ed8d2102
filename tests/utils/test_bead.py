# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw-beads from their geometry: closed forms of bending under tension, geometry, the strip as a run, the command."""

import csv
import math
import subprocess

import numpy as np
import pytest
from helpers import call
from scipy.optimize import brentq

from dd3 import places
from dd3.bead_path import Bead, Strip, flow
from dd3.bead_span import Branch, Start, free_span
from dd3.bead_strip import write_strip
from dd3.bent_section import Section
from dd3.errors import Problem
from dd3.laws import Material

pytestmark = pytest.mark.skipif(places.nearest(places.LIBRARY) is None, reason="libdd3laws.so is not built")
STEEL = """*MATERIAL steel
  young = 2.1e5
  poisson = 0.3
  yield = von_mises
  hardening = swift K=565 e0=0.007117 n=0.259
"""
DP780 = STEEL.replace("swift K=565 e0=0.007117 n=0.259",
                      "voce Y0=376.6 Rsat=113.3 CR=18.95\n  backstress = lemaitre_chaboche CX=91.56 Xsat=460.4")


def perfect(law="von_mises", young=2e7):
    """Return a material, nearly rigid-perfectly plastic of 300 MPa."""
    return Material(STEEL.replace("2.1e5", f"{young}").replace("von_mises", law).replace(
        "swift K=565 e0=0.007117 n=0.259", "perfect Y0=300"))


@pytest.mark.parametrize("law, direction", (("von_mises", 0.0), ("von_mises", 30.0), ("hill48 r0=2 r45=1 r90=1.5", 0.0),
                                            ("hill48 r0=2 r45=1 r90=1.5", 90.0)))
def test_work(law, direction):
    """Check that a bend and an unbending without tension cost Y' t^2/(4 r) each, in any direction."""
    material, t, r = perfect(law), 1.0, 25.0
    section = Section(material, t, layers=32, direction=direction)
    section.bend(1 / r, 40)
    section.bend(0.0, 40)
    strength = 300 * material.yield_locus(720)["s22" if direction == 90 else "s11"].max()
    assert section.force == pytest.approx(2 * strength * t**2 / (4 * r), rel=0.01)


def test_tension():
    """Check force and thinning over many bends of a thin sheet against their closed form: with v = T/(Y' t), d v =
    (t0/4)(1 - v^2)^2 dk, t = t0 (1 - v^2)."""
    section, bends, curvature = Section(perfect(young=2e6), 1.0), 30, 0.02
    for i in range(bends):
        section.bend((-1)**i * curvature, 6)
        section.bend(0.0, 6)
    part = brentq(lambda v: v / (2 * (1 - v * v)) + math.atanh(v) / 2 - 2 * bends * curvature / 4, 0.0, 0.99)
    assert part > 0.25
    assert section.force == pytest.approx(300 * 2 / math.sqrt(3) * part * (1 - part**2), rel=0.02)
    assert math.log(section.stretch) == pytest.approx(-math.log(1 - part**2), rel=0.03)


def test_pressure():
    """Check that the stress across reaches the pressure of the tool, T over its radius, at the concave face."""
    section = Section(Material(STEEL), 1.0, layers=32)
    section.pull(100.0, 10)
    section.bend(-0.15, 20)
    pressure = -1.5 * section.radial[-1] + 0.5 * section.radial[-2]
    tension = section.force - abs(section.moment * section.curvature)
    assert pressure == pytest.approx(tension / (1 / 0.15 - 0.5), rel=0.02)
    assert abs(section.radial[0]) < 0.05 * pressure
    pressed = Section(Material(STEEL), 1.0, layers=32)
    pressed.pull(100.0, 10)
    pressed.bend(-0.15, 20, pressure=50.0, beyond=0.1)
    tension = pressed.force - abs(pressed.moment * pressed.curvature) + 50 / 2  # less the mean stress across
    pressure = tension / (1 / 0.15 - 0.5) + 50
    assert -1.5 * pressed.radial[-1] + 0.5 * pressed.radial[-2] == pytest.approx(pressure, rel=0.01)
    assert abs(pressed.radial[0]) < 0.05 * pressure and pressed.stretch > section.stretch


def test_free_part():
    """Check the slopes of an elastic free part under tension against their closed form: D e'' = M + m x + T e."""
    stiffness, first, second, length, tension = 2e4, 20.0, -12.0, 12.0, 80.0
    moments = np.linspace(60.0, -60.0, 13)
    branch = Branch.of(moments / stiffness, moments, stiffness)
    start = Start((0.0, 0.0), 0.0, first, first / stiffness, tension, 1)
    span = free_span(start, (length, 0.0), -second / stiffness, branch, np.zeros(201), 2.0)
    root, rise = math.sqrt(tension / stiffness), (second - first) / length
    even = first / tension
    odd = (second / tension - even * math.cosh(root * length)) / math.sinh(root * length)
    slope = [even * root * math.sinh(root * x) + odd * root * math.cosh(root * x) - rise / tension for x in (0, length)]
    assert span.slopes == pytest.approx(slope, rel=2e-4)
    offset = even * math.cosh(root * (length - 2)) + odd * math.sinh(root * (length - 2)) - (
        first + rise * (length - 2)) / tension
    assert span.near == pytest.approx((first + rise * (length - 2) + tension * offset) / stiffness, rel=1e-3)


@pytest.mark.parametrize("height", (1.0, 5.0, pytest.param(10.0, marks=pytest.mark.slow)))
def test_path(height):
    """Check that the free parts are tangential to the tools and nowhere in them, and that a low bead does not bend the
    sheet as much as its tools."""
    bead = Bead(1.0, 5.0, 4.0, 1.5, height, 0.1, 0.1)
    strip = Strip(Material(STEEL), bead, 0.0, 16, 20)
    strip.flow()
    path = strip.path(strip.unknowns)
    assert np.abs(path.residual).max() < 1e-4
    for i, span in enumerate(path.spans):
        start = np.array(strip.place(i, path.leaving[i]))
        end = np.array(strip.place(i + 1, path.coming[i + 1]) if i < 2 else (strip.unknowns[5], bead.gap))
        chord = end - start
        across = np.array([chord[1], -chord[0]]) / np.hypot(*chord)
        places = start + np.linspace(0, 1, len(span.offsets))[:, None] * chord + span.offsets[:, None] * across
        for k in range(3):
            assert np.hypot(*(places - strip.centre(k)).T).min() > strip.radii[k] - 2e-3, (i, k)
        assert places[:, 1].max() < bead.gap + 1e-3
    assert all(0 < curvature * radius <= 1 for curvature, radius in zip(path.curvatures, strip.radii))
    assert (path.curvatures[0] * strip.radii[0] < 0.1) == (height == 1.0)


@pytest.mark.slow
def test_elastic():
    """Check that an elastic sheet passes free."""
    bead = Bead(1.0, 5.0, 4.0, 1.5, 5.0, 0.1)
    hard = Material(STEEL.replace("swift K=565 e0=0.007117 n=0.259", "perfect Y0=1e6"))
    assert abs(flow(hard, bead).restraint) < 0.01 * flow(Material(STEEL), bead).restraint


@pytest.mark.slow
def test_convergence():
    """Check that layers and steps of the default are fine enough."""
    bead = Bead(1.0, 5.0, 5.0, 1.5, 6.0, 0.1, 0.1)
    default, fine = flow(Material(STEEL), bead), flow(Material(STEEL), bead, layers=32, steps=40)
    assert default.restraint == pytest.approx(fine.restraint, rel=0.01)
    assert default.uplift == pytest.approx(fine.uplift, rel=0.03)
    assert default.thinning == pytest.approx(fine.thinning, rel=0.03)


def test_refused():
    """Check what is refused."""
    for changed, said in (({"clearance": 0.9}, "below the thickness"), ({"height": 11.5}, "touch the walls"),
                          ({"gap": 0.0}, "gap > 0")):
        with pytest.raises(Problem, match=said):
            Bead(**{"thickness": 1.0, "radius": 5.0, "shoulder": 5.0, "clearance": 1.5, "height": 6.0, "gap": 0.1,
                    **changed})
    with pytest.raises(Problem, match="it necks"):
        flow(Material(STEEL), Bead(1.0, 2.0, 2.0, 1.1, 4.5, 0.1, 0.4))


@pytest.mark.parametrize("word", ["--clamping", "--direction"])
def test_strip_without(word):
    """Check that a strip is refused that would not be what the bead was computed with."""
    assert "--strip goes without" in call("bead", "dc06", "--thickness", 1, "--radius", 5, "--height", 3, "--strip", "s", word,
                                          45, expect=2)


def test_command(tmp_path, program):
    """Check the table and the lines of *DRAWBEAD, and that the program takes the strip."""
    sheet = tmp_path / "sheet.dat"
    sheet.write_text(STEEL)
    words = "bead", sheet, "--thickness", 1, "--radius", 5, "--clearance", 1.5, "--height"
    said = call(*words, 3, 6, "--friction", 0.1, "--strip", tmp_path / "strip")
    rows = [line.split() for line in said.splitlines()]
    assert rows[0][:3] == ["steel,", "1", "mm;"] and [row[0] for row in rows[3:5]] == ["3", "6"]
    force, normal = [float(line.split("= ")[1]) for line in said.splitlines() if "force =" in line or "normal =" in line
                     ][2:]
    assert force == pytest.approx(float(rows[4][1]) + 0.1 * normal, abs=0.1) and normal == pytest.approx(
        -float(rows[4][2]), abs=0.1)
    assert "shoulder, height and gap > 0" in call(*words, 3, "--shoulder", 0, expect=2)
    sheet.write_text(STEEL.rstrip() + "\n  rate = cowper_symonds C=100 p=4\n")
    assert "strain rate is not followed" in call(*words, 3) and "strain rate" not in said
    done = subprocess.run([program, "--check", tmp_path / "strip" / "strip.dat"], capture_output=True, text=True,
                          check=True)
    assert "tool 'bead': 4 patches" in done.stdout
    assert "at least 4" in call(*words, 6, "--layers", 2, expect=2)


def test_deck(tmp_path):
    """Check that material, thickness and friction are those of an input file, and that they may differ in it no more
    than a bead allows."""
    (tmp_path / "steel.dat").write_text(STEEL)
    sheet = tmp_path / "deck.dat"
    tools = "*TOOL die\n  friction = ${mu}\n*TOOL holder\n  friction = 0.1\n"
    sheet.write_text("*PARAMETER\n  mu = 0.1\n  sheet = steel\n*INCLUDE ${sheet}.dat\n"
                     + STEEL.replace("steel", "other")
                     + "*BLANK blank\n  size = 100 100 0.8\n  material = ${sheet}\n" + tools)
    words = "bead", sheet, "--radius", 4, "--height", 3, "--layers", 4, "--steps", 4
    given = call("bead", tmp_path / "steel.dat", *words[2:], "--thickness", 0.8, "--friction", 0.1)
    assert call(*words) == given and given.startswith("steel, 0.8 mm;")
    assert "steel, 1 mm;" in call(*words, "--thickness", 1)
    assert "other, 0.8 mm;" in call(*words, "--name", "other")
    sheet.write_text(sheet.read_text() + "  friction_law = stribeck v0=1 r=0.5\n")
    assert "friction_law is not followed" in call(*words)
    sheet.write_text(sheet.read_text() + "*TOOL pad\n  friction = 0.05\n")
    assert "0.05, 0.1; expected --friction" in call(*words, expect=2)
    assert "friction 0.05" in call(*words, "--friction", 0.05)
    assert "expected --thickness" in call("bead", tmp_path / "steel.dat", *words[2:], expect=2)


@pytest.mark.slow
@pytest.mark.parametrize("text, height, friction", ((STEEL, 6.0, 0.0), (STEEL, 6.0, 0.1), (DP780, 4.0, 0.1)))
def test_strip(tmp_path, program, text, height, friction):
    """Check forces and thinning against a strip that is drawn through the bead."""
    material, bead = Material(text), Bead(1.0, 5.0, 5.0, 1.5, height, 0.1, friction)
    deck = write_strip(material, bead, tmp_path)
    subprocess.run([program, deck, "--threads", "1", "--quiet"], check=True)
    with (tmp_path / "strip.out" / "history.csv").open() as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    columns = ("grip_ux", "tail_ux", "grip_rx", "bead_fz", "entry_fz", "exit_fz")
    rows = [row for row in rows if row["phase"] == "pull"]
    pulled, tail, *forces = np.array([[float(row[name]) for name in columns] for row in rows]).T
    late = pulled > 0.7 * pulled[-1]
    grip, press, before, behind = (np.average(force[late], weights=np.gradient(pulled)[late]) for force in forces)
    thinning = -math.log(np.ptp(pulled[late]) / np.ptp(tail[late]))
    found = flow(material, bead)
    assert found.restraint == pytest.approx(grip, rel=0.04)
    assert found.bead == pytest.approx(press, rel=0.05)
    assert found.uplift == pytest.approx(press + before + behind, rel=0.07)
    assert found.thinning == pytest.approx(thinning, rel=0.15)
