# SPDX-License-Identifier: GPL-3.0-or-later
"""Import of LS-DYNA decks: two that run to their ends, materials, wrong and damaged decks."""

import math
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from dyna_decks import cup_deck, curve, roll_deck, row, shell_deck, solid_deck
from helpers import ROOT, call
from mutations import mutants

from dd3.dyna.cards import LONG, Reader
from dd3.dyna.command import Import
from dd3.errors import Problem
from dd3.mesh import read_inp
from dd3.run import read_frame

MUTATED = 1000


def imported(text, **options):
    """Return the import of a deck in the folder of the test, without its tools' surfaces."""
    Path("deck.k").write_bytes(text if isinstance(text, bytes) else text.encode())
    found = Import(Path("deck.k"), **options)
    return found, "\n".join(found.entries())


def refused(text):
    """Return the message on a deck that is refused."""
    with pytest.raises(Problem) as error:
        imported(text)
    return str(error.value)


def test_shells(program):
    """Check a deck of shells: mesh, material, phases, what is left out; it runs to its end."""
    Path("u.k").write_text(shell_deck())
    said = call("import", "u.k")
    assert "blank of 44 solid_shell, 0.8 mm; tools: punch, die, holder" in said
    for keyword in ("u.k:6: *CONTROL_TIMESTEP: ", "u.k:8: *CONTROL_ADAPTIVE: "):
        assert f"left out: {keyword}" in said
    text = Path("u/u.dat").read_text()
    for line in ("yield = hill48 r0=1.8 r45=1.4 r90=2.1", "rolling_direction = 1 0 0", "friction = 0.1",
                 "press = holder 0 0 -1500", "move = punch 0 0 -8", "unload = on", "thickness_points = 7"):
        assert f"  {line}\n" in text, line
    assert text.index("press = holder") < text.index("move = punch") < text.index("unload")
    assert re.findall(r"\*TOOL (\w+)\n.*\n.*\n  contact = (\w+)", text) == [
        ("punch", "z_max"), ("die", "z_min"), ("holder", "z_max")]
    mesh = read_inp(Path("u/blank.inp"), None)
    assert sorted({round(z, 9) for _, _, z in mesh.nodes.values()}) == [-0.4, 0.4] and len(mesh.nodes) == 180
    assert {name: len(members) for name, members in mesh.node_sets.items()} == {"hold_xy": 4, "hold_y": 176}
    done = subprocess.run([program, "u/u.dat"], capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_solids(program):
    """Check a deck of solids in metres and pascals: it runs to its end."""
    Path("u.k").write_text(solid_deck())
    said = call("import", "u.k", "--output", "solid")
    assert "blank of 40 solid_shell, 1 mm; tools: punch, die" in said
    assert re.findall("left out: (.*)", said) == ["u.k:12: *SECTION_SOLID, ELFORM = 1: the element is solid_shell, or hex8 "
                                                  "for several layers"]
    text = Path("solid/u.dat").read_text()
    hardening = 2.1e5 * 1000 / (2.1e5 - 1000)
    for line in ("young = 210000", f"hardening = linear Y0=200 H={hardening:.8g}", "move = punch 0 0 -6",
                 "imported from LS-DYNA (m Pa)", "friction = 0.05"):
        assert line in text, line
    mesh = read_inp(Path("solid/blank.inp"), None)
    assert np.allclose(np.ptp(np.array(list(mesh.nodes.values())), axis=0), (60, 10, 1))
    done = subprocess.run([program, "solid/u.dat"], capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_square_cup(program):
    """Check that the square cup by way of an LS-DYNA deck takes the force of that of input_files, within 0.5 %."""
    folder = ROOT / "input_files" / "square_cup"
    Path("cup.k").write_text(cup_deck(folder, 16, 8.0))
    call("import", "cup.k")
    force = []
    for name, words in (("imported", ["cup/cup.dat"]), ("own", [folder / "square_cup.dat", "--set", "divisions=16 16 1",
                                                       "--set", "levels=0", "--set", "depth=8"])):
        done = subprocess.run([program, "--quiet", "--output", name, *words], capture_output=True, text=True, timeout=300,
                              check=False)
        assert done.returncode == 0, done.stderr
        force.append(float(read_frame(Path(name), "history.csv")["punch_fz"].iloc[-1]))
    assert abs(force[0] / force[1] - 1) < 0.005, force


def with_material(*lines):
    """Return the deck of shells with another material of the blank."""
    text = shell_deck(elements=8)
    start, end = text.index("*MAT_3-PARAMETER"), text.index("*MAT_RIGID")
    return text[:start] + "\n".join(lines) + "\n" + text[end:]


def test_materials():
    """Check the laws of each material."""
    elastic = (1, "7.8E-9", "2.1E5", 0.3)
    swift = math.log(400 / 2.1e5) / (1 - 0.2)
    for card, criterion, hardening in (
            (["*MAT_PLASTIC_KINEMATIC", row(*elastic, 200.0, 1000.0, 1.0)], "von_mises", "linear Y0=200 H=1004.7847"),
            (["*MAT_018", row(*elastic, 400.0, 0.2), row("")], "von_mises",
             f"swift K=400 e0={math.exp(swift):.8g} n=0.2"),
            (["*MAT_24_TITLE", "name", row(*elastic), row("", "", 10)], "von_mises", "table 0:159.243 0.01:182.922"),
            (["*MAT_024", row(*elastic), row(""), row(0.0, 0.1), row(200.0, 250.0)], "von_mises", "table 0:200 0.1:250"),
            (["*MAT_037", row(*elastic, 200.0, 0.0, 1.5)], "hill48 r0=1.5 r45=1.5 r90=1.5", "linear Y0=200 H=0"),
            (["*MAT_HILL_3R", row(*elastic, 2.0, 500.0, 0.2), row(1.6, 1.2, 2.0, "", 0.01)],
             "hill48 r0=1.6 r45=1.2 r90=2", "swift K=500 e0=0.01 n=0.2"),
            (["*MAT_036", row(*elastic, 1.0, 1000.0, 200.0), row(6.0, 1.6, 1.2, 2.0)], "hill48 r0=1.6 r45=1.2 r90=2",
             "linear Y0=200 H=1004.7847"),
            (["*MAT_133", row(*elastic, 0.0), row(500.0, 0.01, 0.2, "", "", 1.0, 8.0), row(*[1.0] * 8)],
             "yld2000 " + " ".join(f"alpha{k}=1" for k in range(1, 9)) + " m=8", "swift K=500 e0=0.01 n=0.2")):
        found, text = imported(with_material(*card))
        assert f"  yield = {criterion}\n" in text and f"  hardening = {hardening}" in text, (card, found.law)
    two_surfaces = "yoshida_uemori Y=124 B=168 C=500 m=12 b_sat=9 Rsat=190 h=0.5\n"
    rates = (168.0, 124.0, 500.0, 12.0, 190.0, 9.0, 0.5)
    for card, criterion, modulus in (
            (["*MAT_125", row(*elastic, 1.5), row(*rates), row(1.63e5, 30.8)], "hill48 r0=1.5 r45=1.5 r90=1.5",
             "chord Ea=163000 xi=30.8"),
            (["*MAT_KINEMATIC_HARDENING_TRANSVERSELY_ANISOTROPIC", row(*elastic), row(*rates, 500.0), row("")],
             "hill48 r0=1 r45=1 r90=1", ""),
            (["*MAT_KINEMATIC_HARDENING_BARLAT89", row(*elastic, 2.0, 1.6, 1.2, 2.0), row(*rates),
              row(2.0, "", "", "", "", 1.63e5, 30.8), row("", "", "", 0.0, 1.0), row("")], "hill48 r0=1.6 r45=1.2 r90=2",
             "chord Ea=163000 xi=30.8")):
        found, text = imported(with_material(*card))
        assert f"  yield = {criterion}\n" in text and f"  hardening = {two_surfaces}" in text, (card, text)
        assert found.law.modulus == modulus and (f"  modulus = {modulus}\n" in text) == bool(modulus)
    assert np.allclose(found.law.rolling, (0, 1, 0))
    for rates, options, message in (((168.0, 168.0), (), "CB = 168 is not larger than Y = 168"),
                                    ((*rates, 200.0), (), "SC2 = 200, another rate than SC"),
                                    (rates, (0.0, 0.0, 1), "IOPT = 1, the modified hardening"),
                                    (rates, (2.2e5, 30.0), "EA = 220000 is larger than E")):
        assert message in refused(with_material("*MAT_125", row(*elastic, 1.5), row(*rates), row(*options)))
    found, text = imported(with_material("*MAT_036", row(*elastic, 1.0, 1000.0, 200.0), row(6.0, 1.6, 1.2, 2.0), row(3.0),
                                         row(""), row(0.0, 1.0, 0.0, "", "", "", 30.0)))
    assert np.allclose(found.law.rolling, (math.cos(math.radians(30)), math.sin(math.radians(30)), 0), atol=1e-6)
    assert "# - yield: hill48 with the r-values, in place of Barlat and Lian (1989) of exponent 6; nearer: dd3 iden" in text


def test_yld2000():
    """Check the coefficients of *MAT_133, also with A < 0, and the command for measured values."""
    elastic, swift = (1, 2.7e-9, 7e4, 0.33), (500.0, 0.01, 0.2, "", "", 1.0)
    alpha = (0.4865, 1.3783, 0.7536, 1.0246, 1.0363, 0.9036, 1.2321, 1.4858)
    for exponent, between in ((8.0, []), (-8.0, [row("")])):
        _, text = imported(with_material("*MAT_133", row(*elastic), row(*swift, exponent), *between, row(*alpha)))
        assert "  yield = yld2000 alpha1=0.4865 alpha2=1.3783 alpha3=0.7536 alpha4=1.0246 alpha5=1.0363 " \
               "alpha6=0.9036 alpha7=1.2321 alpha8=1.4858 m=8\n" in text, text
        assert "hill48" not in text
    measured = (row(200.0, 190.0, 180.0, 0.8, 0.4, 0.6), row(210.0, 210.0, 0.0, -1.0, -1.1))
    _, text = imported(with_material("*MAT_133", row(*elastic, 1.0), row(*swift, 8.0), *measured))
    assert "  yield = hill48 r0=0.8 r45=0.4 r90=0.6\n" in text
    assert "dd3 identify blank --criterion yld2000 --fix m=8 --r 0:0.8 45:0.4 90:0.6 --stress 0:1 45:0.95 90:0.9 " \
           "--biaxial-stress 1.05 --biaxial-r 1.1\n" in text, text
    zeros = with_material("*MAT_133", row(*elastic), row(*swift, 8.0), row(0.0))
    assert "all coefficients of Yld2000 are 0" in refused(zeros)


def test_formats(tmp_path):
    """Check long fields, fields apart by commas, parameters, Fortran's exponents, titles, ids and empty rows."""
    deck = tmp_path / "cards.k"
    deck.write_text("*KEYWORD LONG=Y\n*MAT_024_TITLE\na steel\n" + "".join(f"{v:>20}" for v in (1, "7.8-9", "2.1E5", 0.3))
                    + "\n\n*PARAMETER\n" + f"{'R mu':>20}{0.12:>20}" + "\n*CONTACT_FORMING_SURFACE_TO_SURFACE_MPP_ID\n"
                    "7, die\n0\n1, 2, 3, 3\n-&mu, , 5\n*END\n")
    _, material, contact = Reader(deck).cards
    assert material.title == "a steel" and material.keyword == "*MAT_024" and len(material) == 1 and material.least == LONG
    assert material.row(0, "MID RO E PR SIGY").numbers("MID RO E PR SIGY") == [1.0, 7.8e-9, 2.1e5, 0.3, 0.0]
    assert contact.keyword == "*CONTACT_FORMING_SURFACE_TO_SURFACE"
    assert contact.row(0, "A B AT BT").numbers("A B AT BT") == [1, 2, 3, 3]
    assert [contact.row(1, "FS FD DC").number(name, 9.0) for name in ("FS", "FD", "DC")] == [-0.12, 9.0, 5.0]


def test_blanks():
    """Check the reference surface of shells, units of GPa, shells that are turned over, solids upside down."""
    text = shell_deck(elements=8)
    for nloc, heights in ((1, [-0.8, 0.0]), (-1, [0.0, 0.8])):
        found, _ = imported(text.replace(row(0.8, 0.8, 0.8, 0.8), row(0.8, 0.8, 0.8, 0.8, nloc)))
        assert sorted({round(z, 9) for _, _, z in found.blank.mesh.nodes.values()}) == heights
    shells = re.search(r"\*ELEMENT_SHELL\n(.*?)\n\*", text, re.DOTALL)[1]
    over = "\n".join(line[:16] + "".join(line[i:i + 8] for i in (40, 32, 24, 16)) if int(line[8:16]) == 1 else line
                     for line in shells.splitlines())
    found, deck = imported(text.replace(shells, over))
    assert found.blank.normal.tolist() == [0.0, 0.0, 1.0] and "contact = z_max" in deck
    found, deck = imported(with_material("*MAT_024", row(1, "7.8E-6", 210.0, 0.3, 0.2, 1.0)))
    assert found.units.name == "mm GPa" and "hardening = linear Y0=200 H=1004.78" in deck
    assert "press = holder 0 0 -1.5e+06\n" in deck  # kN
    solids = solid_deck(elements=4)
    cells = re.search(r"\*ELEMENT_SOLID\n(.*?)\n\*", solids, re.DOTALL)[1]
    down = "\n".join(line[:16] + "".join(line[i:i + 8] for i in (40, 32, 24, 16, 72, 64, 56, 48)) for line in
                     ("".join((line[:16], line[48:80], line[16:48])) for line in cells.splitlines()))
    found, deck = imported(solids.replace(cells, down))
    assert np.allclose(found.blank.normal, (0, 0, 1)) and abs(found.blank.thickness - 1) < 1e-9
    assert re.findall(r"contact = (\w+)", deck) == ["z_max", "z_min"] and "element = solid_shell" in deck


def test_rates():
    """Check the laws of the strain rate that are the same here, in the units of the deck, with the times of phases, and
    that others are left out with their reason."""
    elastic, other = (1, "7.8E-9", "2.1E5", 0.3), (1, "7.8E-6", 210.0, 0.3)
    for card, hardening, rate in (
            (["*MAT_024", row(*elastic), row(40.0, 5.0, 10, "", 1.0)], "table 0:", "cowper_symonds C=40 p=5"),
            (["*MAT_098", row(*other, 1.0), row(0.3, 0.5, 0.4, 0.02, "", "", "", 1e-6)], "ludwik Y0=300 K=500 n=0.4",
             "johnson_cook C=0.02 reference=0.001"),
            (["*MAT_024", row(*elastic), row(40.0, 5.0, 10)], "table 0:", ""),
            (["*MAT_024", row(*elastic, 200.0), row(40.0, 5.0, 10, "", 1.0)], "table 0:", ""),
            (["*MAT_SIMPLIFIED_JOHNSON_COOK", row(*other), row(0.3, 0.5, 0.4, 0.02)], "ludwik Y0=300", "")):
        found, deck = imported(with_material(*card))
        assert f"  hardening = {hardening}" in deck and found.law.rate == rate, (card, found.law)
        assert (f"  rate = {rate}\n" in deck) == bool(rate)
        assert deck.count("*PHASE") == deck.count("  duration = ") or not rate
        assert any("C = " in str(item) and "VP = " in str(item) for item in found.left_out) != bool(rate)


def test_heating():
    """Check *MAT_015 in two systems of units: the flow stress by the rate and by the heat of plastic work, without
    CP or with another form of the rate without these."""
    flow = 0.3, 0.5, 0.4, 0.02, 1.1, 1500.0, 20.0, 1e-6
    found, deck = imported(with_material("*MAT_015", row(1, "7.8E-6", "", 210.0, 0.3, "", 1.0), row(*flow),
                                         row(460.0, "", "", "", 0.05)))
    assert "  hardening = ludwik Y0=300 K=500 n=0.4\n  rate = johnson_cook C=0.02 reference=0.001\n" \
        "  temperature = johnson_cook Tr=20 Tm=1500 m=1.1\n  initial_temperature = 20\n" in deck
    assert "  heat_capacity = 4.6e+08\n" in deck and "  heat_fraction = 1\n" in deck and "  duration = " in deck
    assert any("D1 = 0.05" in str(item) for item in found.left_out)
    found, deck = imported(with_material("*MAT_JOHNSON_COOK", row(1, "7.8E-9", "", "2.1E5", 0.3, "", 1.0, 2.0),
                                         row(300.0, 500.0, *flow[2:7], 1e-3), row("")))
    assert not found.law.heating and not found.law.rate and any("RATEOP = 2" in note for note in found.notes)


def test_table_of_rates():
    """Check *MAT_024 with a table: with VP = 1 the curves by their rates, in the units of the deck, otherwise or where
    they cross that of the lowest rate."""
    def card(*more, slow=210.0, fast=230.0):
        return with_material("*MAT_024", row(1, "7.8E-9", "2.1E5", 0.3), row("", "", 50, "", *more), "*DEFINE_TABLE",
                             row(50), row(0.1), row(10.0), *curve(51, (0.0, slow), (1.0, 300.0)),
                             *curve(52, (0.0, fast), (0.5, 300.0), (1.0, 310.0)))
    found, deck = imported(card(1.0))
    assert "  hardening = table 0:210 1:300\n" in deck
    assert "  rate = curves r1=0.1 r2=10 &\n    0:210 1:300 &\n    0:230 0.5:300 1:310\n" in deck
    assert not any("VP" in str(item) for item in found.left_out), found.left_out
    assert any("logarithm" in note for note in found.notes)
    for text in (card(), card(1.0, slow=240.0)):
        found, deck = imported(text)
        assert not found.law.rate and "  rate = " not in deck
        assert any("lowest strain rate" in note for note in found.notes)


def test_fracture(program):
    """Check GISSMO of both keywords: a curve, a table over the Lode parameter, what is left out, what cannot be
    taken; the program takes it."""
    elastic = "*MAT_024", row(1, "7.8E-9", "2.1E5", 0.3, 200.0, 1000.0)
    line = curve(71, (0.0, 0.7), (0.577, 0.5), (0.667, 0.9))
    erosion = ["*MAT_ADD_EROSION", row(1, "", "", "", "", "", 3), row(""),
               row(1, 1, 71, -72, 2.0, 0.3, 1.5, 73), row("", "", 2, 0, 1.0, 1.0)]
    found, deck = imported(with_material(*elastic, *erosion, *line))
    assert "  fracture = table exponent=2 &\n    0:0.7 0.577:0.5 0.667:0.9\n" in deck
    left = "\n".join(map(str, found.left_out))
    for name in ("NUMFIP = 3", "ECRIT = -72", "DCRIT = 0.3", "FADEXP = 1.5", "LCREGD = 73", "SHRF = 1"):
        assert name in left, left
    table = ["*DEFINE_TABLE_2D", row(70), row(-1.0, "", 74), row(1.0, "", 71), *line,
             *curve(74, (-0.333, 1.4), (0.667, 0.9))]
    gissmo = ["*MAT_ADD_DAMAGE_GISSMO", row(1, "", 1, 2.5, 1), row(70, -72, 1.0, "", 2.0), row("", 1.0)]
    found, deck = imported(with_material(*elastic, *gissmo, *table))
    assert "fracture = table lode1=-1 lode2=1 &\n    -0.333:1.4 0.667:0.9 &\n    -0.333:0.7 0:0.7 0.577:0.5" in deck
    assert any("27 J3" in note for note in found.notes)
    call("import", "deck.k")
    done = subprocess.run([program, "--check", "deck/deck.dat"], capture_output=True, text=True, timeout=60,
                          check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    for card, said in ((["*MAT_ADD_EROSION", row(1, "", "", "", 0.5)], "its criteria are not available"),
                       ([*erosion[:3], row(-1, 1, 71)], "IDAM = -1"),
                       ([*erosion[:3], row(1, 61, 71)], "history variable"),
                       ([*erosion[:3], row(1, 1, 75)], "LCSDG = 75 is no curve"),
                       ([*erosion[:3], row(1, 1, 71, "", 0.5)], "DMGEXP = 0.5"),
                       (["*MAT_ADD_EROSION", row(2), *erosion[2:]], "nothing here uses its material")):
        found, deck = imported(with_material(*elastic, *card, *line))
        assert "fracture =" not in deck and any(said in str(item) for item in found.left_out), found.left_out
    assert "expected > 0" in refused(with_material(*elastic, *erosion, *curve(71, (0.0, 0.7), (0.5, 0.0))))


def test_further_cards():
    """Check tables, parts that follow another, draw-beads, and what is left out or refused for its axes or places."""
    text = with_material("*MAT_024", row(1, "7.8E-9", "2.1E5", 0.3), row("", "", 50), "*DEFINE_TABLE", row(50), row(0.1),
                         *curve(51, (0.0, 210.0), (1.0, 300.0)), "*CONSTRAINED_RIGID_BODIES", row(2, 4),
                         "*CONTACT_DRAWBEAD", row(1, 3, 4, 3), row(""), row(""), row(11, 0, "", 25.0),
                         "*ELEMENT_BEAM", row(1, 1, 2, 3), "*BOUNDARY_PRESCRIBED_MOTION_RIGID_LOCAL", row(2, 3, 0, 12, 1.0),
                         "*BOUNDARY_PRESCRIBED_MOTION_NODE", row(2, 3, 0, 12, 1.0))
    found, deck = imported(text)
    assert [tool.parts for tool in found.tools] == [[2, 4], [3]]
    assert "hardening = table 0:210 1:300\n" in deck and "*DRAWBEAD bead_1\n  force = 25\n  points = 0 0  0 10\n" in deck
    assert deck.count("\n  move = ") == 1 and any("lowest strain rate" in note for note in found.notes)
    left = {item.name for item in found.left_out}
    assert {"*ELEMENT_BEAM", "*BOUNDARY_PRESCRIBED_MOTION_RIGID_LOCAL",
            "*BOUNDARY_PRESCRIBED_MOTION_NODE"} <= left, left
    assert "moves or copies nodes" in refused(text.replace("*ELEMENT_BEAM", "*NODE_TRANSFORM"))


def test_stages():
    """Check phases of two tools: a holder that closes, then holds while the punch moves and another force acts."""
    text = shell_deck(elements=8)
    start, end = text.index("*BOUNDARY_PRESCRIBED"), text.index("*BOUNDARY_SPC_SET")
    motion = [*curve(21, (0.0, 0.0), (0.004, 2.0), (1.0, 2.0)), *curve(22, (0.0, 0.0), (0.008, 0.0), (0.016, 3.0)),
              *curve(23, (0.0, 0.0), (0.01, 0.0), (0.011, 7.0)),
              "*BOUNDARY_PRESCRIBED_MOTION_RIGID", row(4, 3, 2, 21, -1.0), row(2, 3, 2, 22, -2.0), row(2, 9, 2, 22),
              "*LOAD_RIGID_BODY", row(3, 3, 23, 10.0), row(9, 3, 23)]
    found, deck = imported(text[:start] + "\n".join(motion) + "\n" + text[end:])
    assert re.findall(r"\*PHASE (\w+)", deck) == ["move_1", "move_2", "move_3", "springback"]
    assert "move = holder 0 0 -2\n" in deck and "press = die 0 0 70\n  press_table = 0.166667 1  1 1\n" in deck
    assert re.findall("move = punch 0 0 (.*)", deck) == ["-1.5", "-4.5"]
    assert any("part 9, no tool" in note for note in found.notes)
    assert any("DOF = 9" in item.why for item in found.left_out)


def test_rolls(program):
    """Check tools that turn, about the centre of their area, and forces on nodes that end; rings face outwards."""
    found, deck = imported(roll_deck())
    assert call("import", "deck.k").startswith("deck/deck.dat: ")
    done = subprocess.run([program, "--check", "deck/deck.dat"], capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    turns = re.findall("turn = (\\w+) (.*)  (.*)  (.*)", deck)
    assert [(name, axis) for name, _, axis, _ in turns] == [("upper", "0 -1 0"), ("lower", "0 1 0")] * 3
    for name, point, _, _ in turns:
        assert np.allclose(np.array(point.split(), float), (0, 5, 20.5 if name == "upper" else -20.5), atol=1e-3), point
    angles = [float(angle) for *_, angle in turns]
    assert abs(sum(angles[::2]) - math.degrees(0.5 * 1.005)) < 1e-3
    assert re.findall("load = load_2 (.*)", deck) == ["20 0 0", "0 0 0"] and "control = load\n" in deck
    assert found.units.name == "mm MPa"


def test_wrong_decks():
    """Check the messages on decks that cannot be carried over, with the line of the card."""
    text = shell_deck(elements=8)
    wrong = with_material("*MAT_024", row(1, "7.8E-9", "2.1E5", 0.3), row("", "", 20))
    wrong = wrong.replace("*END", "\n".join(curve(20, (0.0, 0.0), (1.0, 13.0))) + "\n*END")
    place = wrong.splitlines().index("*DEFINE_CURVE", wrong.splitlines().index("*SET_NODE_LIST")) + 3
    for deck, said in (
            (wrong, f"deck.k:{place}: error: a flow stress of 0 MPa at the plastic strain 0; expected"),
            (text.replace("*MAT_3-PARAMETER_BARLAT", "*MAT_ELASTIC"), "*MAT_ELASTIC of the blank is not read"),
            (text.replace("2.1E5       0.3       3.0", " 7777       0.3       3.0"), "tells no units"),
            (text.replace(row(2, 3, 0, 12, -1.0), row(2, 3, 0, 99, -1.0)), "there is no *DEFINE_CURVE 99"),
            (text.replace("*LOAD_RIGID_BODY", "*SENSOR").replace(row(2, 3, 0, 12, -1.0), row(2, 9, 0, 12, -1.0)),
             "no tool moves and none is pressed"),
            (text.replace("*TITLE", "*INCLUDE_TRANSFORM"), "moves or copies nodes"),
            (text.replace("*MAT_RIGID", "*MAT_024"), "--blank chooses one"),
            (text.replace("*PART\npunch", "*PART\npunch\n" + row(3, 2, 2) + "\nx"), "a second *PART 3")):
        assert said in refused(deck), (said, refused(deck))
    assert "No such" in call("import", "none.k", expect=2) or "no such file" in call("import", "none.k", expect=2)


def test_mutated_decks():
    """Check that damaged decks are imported or refused by a message."""
    imports = 0
    for seed, text in enumerate((shell_deck(elements=8), solid_deck(elements=8))):
        for data in mutants(text.encode(), MUTATED // 2, seed):
            try:
                imported(data)
                imports += 1
            except Problem as problem:
                assert "deck.k" in str(problem) or "blank" in str(problem), problem
    assert 0.02 * MUTATED < imports < 0.95 * MUTATED, imports


def test_mutated_calls():
    """Check the same of whole calls."""
    for data in mutants(solid_deck(elements=8).encode(), 10, 7):
        Path("one.k").write_bytes(data)
        for code in (0, 2):
            try:
                call("import", "one.k", expect=code)
                break
            except AssertionError as error:
                assert "Traceback" not in str(error), error
        else:
            raise AssertionError(f"neither imported nor refused: {Path('one.k').resolve()}")
