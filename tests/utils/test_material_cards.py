# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials as cards of LS-DYNA: their fields, and that what dd3 import reads from them is the same material."""

import subprocess
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from dyna_decks import curve, flat_deck, row
from helpers import call
from scipy.optimize import brentq
from test_study import DECK

import dd3
from dd3.dyna import fields
from dd3.dyna.command import Import
from dd3.dyna.fracture_cards import blocks_of, hosford_coulomb
from dd3.dyna.law_words import words_of
from dd3.dyna.material_cards import cards_of
from dd3.dyna.material_laws import CardOptions
from dd3.dyna.planar import barlat89_at
from dd3.dyna.run_cards import rolling_angles

HILL = "hill48 r0=1.79 r45=1.51 r90=2.27"
SCALED = "hill48 F=0.5 G=0.55 H=0.75 N=1.7"  # tension along rolling is not the flow stress
YLD2000 = ("yld2000 alpha1=0.4865 alpha2=1.3783 alpha3=0.7536 alpha4=1.0246 alpha5=1.0363 alpha6=0.9036 alpha7=1.2321 "
           "alpha8=1.4858 m=8")
SWIFT = "swift K=565.32 e0=0.007117 n=0.2589"
TWO_SURFACES = {"hardening": "yoshida_uemori Y=124 B=168 C=200 m=12 b_sat=60 Rsat=190 h=0.5",
                "modulus": "chord Ea=1.6e5 xi=30"}
CHABOCHE = {"hardening": "voce Y0=200 Rsat=100 CR=10",
            "backstress": ["lemaitre_chaboche CX=50 Xsat=60", "lemaitre_chaboche CX=500 Xsat=30"]}
HEATED = {"hardening": "ludwik Y0=200 K=400 n=0.5", "rate": "johnson_cook C=0.02 reference=0.001",
          "temperature": "johnson_cook Tr=20 Tm=1500 m=1", "heat_capacity": 4.6e8}
ANGLES = (0, 22.5, 45, 67.5, 90)


def material(criterion="von_mises", **keys):
    """Return a material."""
    return dd3.material(young=2.06e5, poisson=0.3, **{"density": 7.85e-9, "hardening": SWIFT} | keys, yield_=criterion)


def imported(lines, units=None):
    """Return the material that dd3 import reads from cards, the lines of its block, and all that was left out."""
    Path("deck.k").write_text(flat_deck(material=lines))
    found = Import(Path("deck.k"), units=units)
    block = "\n".join(found.body()).split("*MATERIAL")[1].split("\n#")[0]
    return dd3.material(f"*MATERIAL{block}"), block, [str(item) for item in found.left_out]


def fields_in(lines):
    """Return the fields of rows by the names in the comments above, of ten columns each."""
    found = {}
    for head, below in pairwise(lines):
        if head.startswith("$#") and not head.rstrip().endswith(("o1", "curveid")):
            names = [head[i:i + 10].replace("$#", "").strip() for i in range(0, len(head), 10)]
            words = [below[i:i + 10].strip() for i in range(0, len(head), 10)]
            found |= {name: word for name, word in zip(names, words) if word}
    return found


def difference(one, other, angles=ANGLES):
    """Return the largest differences of yield stresses (relative) and r-values."""
    stress = one.yield_stresses(angles) * one.flow_stress() / (other.yield_stresses(angles) * other.flow_stress())
    return float((stress - 1).abs().max()), float((one.r_values(angles) - other.r_values(angles)).abs().max())


def response(one, rate=0.0):
    """Return stresses of tension to 0.1 and back to 0.02, at a rate."""
    point, found = one.point(), []
    for step in [0.004] * 25 + [-0.004] * 20:
        point.pull(step, time=abs(step) / rate if rate else 0.0)
        found.append(point.stress[0])
    return np.array(found)


def apart(one, other, rate=0.0):
    """Return the largest difference of the stresses of two materials over the largest stress."""
    stress = response(one, rate)
    return np.abs(stress - response(other, rate)).max() / np.abs(stress).max()


def test_fields():
    """Check that numbers go into ten columns with seven digits or more, apart from the field before where they can."""
    values = (0.3, 7.85e-9, 210000.0, 2.1e11, 1.01005025, 0.00438894219, -8.0, 0.0, 123456789.0, -0.123456789, 1e-30)
    for value in values:
        text = fields.field(value)
        assert len(text) == 10 and abs(float(text) - value) <= 1e-7 * abs(value), (value, text)
        assert text[0] == " " or value in (123456789.0, 0.00438894219, -0.123456789), text
        assert "." in text or "e" in text
    assert fields.field(12) == "        12" and fields.field("") == " " * 10
    with pytest.raises(dd3.Problem, match="columns"):
        fields.field(12345678901)
    with pytest.raises(dd3.Problem, match="does not go"):
        fields.field(float("nan"))
    assert fields.row("MID RO E", {"MID": 1, "E": 2.1e5}) == ["$#     mid        ro         e",
                                                              f"{1:>10}{'':10}{'2.1e5':>10}"]


def test_rows():
    """Check the places of fields in a card that was written by hand, and that lines have 80 columns at most."""
    lines = cards_of(material(HILL)).lines
    assert all(len(line) <= 80 for line in lines)
    start = lines.index("*MAT_3-PARAMETER_BARLAT_TITLE")
    assert lines[start + 2] == "$#     mid        ro         e        pr        hr        p1        p2      iter"
    assert lines[start + 3].split() == ["1", "7.85e-9", "2.06e5", "0.3", "2", "565.32", "0.2589"]
    found = fields_in(lines[start:])
    assert {name: float(found[name]) for name in ("mid", "hr", "m", "r00", "r45", "r90", "e0", "aopt", "a1", "d2")} == {
        "mid": 1, "hr": 2, "m": 2, "r00": 1.79, "r45": 1.51, "r90": 2.27, "e0": 0.007117, "aopt": 2, "a1": 1, "d2": 1}


def test_card_by_itself():
    """Check the card of a scaled criterion of Hill by the formula of Barlat and Lian, without the reader."""
    one = material(SCALED)
    found = {name: float(value) for name, value in fields_in(cards_of(one).lines).items() if name in
             ("r00", "r45", "r90", "p1", "p2", "e0", "m")}
    r0, r45, r90 = (found[name] for name in ("r00", "r45", "r90"))
    assert np.allclose((r0, r90, r45), (0.75 / 0.55, 0.75 / 0.5, 1.7 / 1.05 - 0.5), rtol=1e-7)  # Hill (1948)
    c = 2 * np.sqrt(r0 / (1 + r0) * r90 / (1 + r90))
    h = np.sqrt(r0 / (1 + r0) * (1 + r90) / r90)
    p = brentq(lambda p: barlat89_at((2 - c, c, h, p), 2, np.pi / 4)[1] - r45, 0.1, 5)
    first = found["p1"] * found["e0"]**found["p2"]
    assert first == pytest.approx(565.32 * 0.007117**0.2589 / np.sqrt(0.55 + 0.75), rel=1e-6)
    for angle in ANGLES:
        stress, r = barlat89_at((2 - c, c, h, p), 2, np.radians(angle))
        assert first * stress == pytest.approx(one.yield_stresses([angle])[angle] * one.flow_stress(), rel=1e-6)
        assert r == pytest.approx(one.r_values([angle])[angle], rel=1e-6)
    # The strain of the card is that of tension along rolling: work is the same.
    along = one.curve(0.2)
    elastic = along["stress"] / 2.06e5
    theirs = found["p1"] * (found["e0"] + along["strain"] - elastic)**found["p2"]
    assert np.allclose(along["stress"][5:], theirs[5:], rtol=1e-6)


@pytest.mark.parametrize("number, criterion, keys", [
    (24, "von_mises", {"hardening": "linear Y0=200 H=500"}), (24, "hosford m=4", {"hardening": "perfect Y0=200"}),
    (3, "von_mises", {"hardening": "linear Y0=200 H=500", "backstress": "prager k=300"}), (36, HILL, {}),
    (36, SCALED, {}),
    (36, "yld91 m=2 a=1.1 b=0.9 c=1 f=1 g=1 h=1.05", {"hardening": "linear Y0=200 H=500"}), (133, YLD2000, {}),
    (133, "yld91 m=8 a=1.1 b=0.9 c=1 f=1 g=1 h=1.05", {}), (133, "hosford m=6", {}), (125, "von_mises", TWO_SURFACES),
    (226, HILL, TWO_SURFACES), (226, SCALED, TWO_SURFACES), (242, YLD2000, TWO_SURFACES),
    (37, "hill48 r0=1.4 r45=1.4 r90=1.4", {"hardening": "linear Y0=200 H=500", "modulus": "chord Ea=1.6e5 xi=30"}),
    (98, "von_mises", {"hardening": HEATED["hardening"], "rate": HEATED["rate"]}), (15, "von_mises", HEATED)])
def test_exact(number, criterion, keys):
    """Check that a card without curves is the same material: yield stresses, r-values, tension and reversal."""
    one = material(criterion, **keys)
    cards = cards_of(one)
    assert cards.number == number and not cards.left_out and "*DEFINE_CURVE" not in "\n".join(cards.lines)
    other, _, left_out = imported(cards.lines)
    assert max(difference(one, other)) < 1e-6
    rate = 5.0 if "rate" in keys else 0.0
    assert apart(one, other, rate) < 1e-6
    assert all("the rolling direction" in item or "the modulus is E" in item for item in left_out if "*MAT" in item)


@pytest.mark.parametrize("number", [18, 122, 36, 37])
def test_chosen_card(number):
    """Check cards that are asked for."""
    one = material("von_mises" if number != 122 else HILL)
    cards = cards_of(one, CardOptions(card=number))
    assert cards.number == number
    other, _, _ = imported(cards.lines)
    assert max(difference(one, other)) < 1e-6 and apart(one, other) < 1e-4


@pytest.mark.parametrize("units", ["mm GPa", "m Pa"])
@pytest.mark.parametrize("keys", [{"rate": "cowper_symonds C=40 p=5"}, CHABOCHE, HEATED])
def test_units(units, keys):
    """Check other units, of times and densities too."""
    one = material(**keys)
    cards = cards_of(one, CardOptions(units=units))
    assert float(fields_in(cards.lines)["ro"]) == pytest.approx({"mm GPa": 7.85e-6, "m Pa": 7850}[units])
    other, block, _ = imported(cards.lines, units)
    assert apart(one, other, 5.0) < 1e-4 and "density = 7.85e-09" in block


@pytest.mark.parametrize("law", [SWIFT, "voce Y0=200 Rsat=150 CR=12", "ludwik Y0=200 K=400 n=0.5", "hockett_sherby "
                                 "Y0=200 Ysat=500 N=5 q=0.8", "table 0:160 0.02:230 0.1:310 0.25:400 0.5:480 slope=100",
                                 "swift_voce alpha=0.5 K=600 e0=0.01 n=0.2 Y0=200 Rsat=150 CR=12"])
def test_curve(law):
    """Check a curve: its straight lines within the error that is named, and what is read from it."""
    one = material(hardening=law)
    cards = cards_of(one)
    assert cards.number == 24
    rows = cards.lines[cards.lines.index(next(line for line in cards.lines if line.rstrip().endswith("o1"))) + 1:]
    points = np.array([[float(line[:20]), float(line[20:])] for line in rows])
    state, at = np.zeros(one.state_size), np.geomspace(1e-4, 1, 500)
    exact = []
    for state[0] in at:
        exact.append(one.flow_stress(state))
    off = np.abs(np.interp(at, *points.T) / exact - 1).max()
    assert off < 1.2e-4 and points[0, 0] == 0 and points[-1, 0] == 1
    intervals = int(fields_in(cards.lines)["lcint"])
    even = np.interp(np.linspace(0, 1, intervals + 1), *points.T)
    late = at > 2e-3
    assert np.abs(np.interp(at, np.linspace(0, 1, intervals + 1), even) / exact - 1)[late].max() < 2e-3
    assert f"LCINT = {intervals}" in cards.notes[0]
    other, _, _ = imported(cards.lines)
    assert apart(one, other) < 1e-4


def test_swift_in_closed_form():
    """Check points of a curve by Swift's formula."""
    lines = cards_of(material(), CardOptions(strain=0.5)).lines
    rows = lines[lines.index(next(line for line in lines if line.endswith("o1"))) + 1:]
    points = np.array([[float(line[:20]), float(line[20:])] for line in rows])
    assert np.allclose(points[:, 1], 565.32 * (0.007117 + points[:, 0])**0.2589, rtol=1e-10) and points[-1, 0] == 0.5


@pytest.mark.parametrize("criterion", ["von_mises", SCALED, YLD2000])
def test_back_stresses(criterion):
    """Check back-stresses of Chaboche: the curve is that of tension, reversals are the same."""
    one = material(criterion, **CHABOCHE)
    cards = cards_of(one)
    assert cards.number == (133 if criterion == YLD2000 else 36)
    other, _, _ = imported(cards.lines)
    assert max(difference(one, other)) < 1e-6 and apart(one, other) < 1e-4


@pytest.mark.parametrize("law, error", [
    ("cowper_symonds C=40 p=5", 1e-4), ("johnson_cook C=0.02 reference=0.001", 1e-4),
    ("power m=0.02 reference=0.01", 3e-3),
    ("table 0.001:1 0.1:1.03 10:1.1 1000:1.3", 1e-4)])
def test_rates(law, error):
    """Check laws of the rate: C and P with VP = 1, or a table over the logarithm of the rate."""
    one = material(rate=law)
    cards = cards_of(one)
    found = fields_in(cards.lines)
    assert float(found["vp"]) == 1 and ("c" in found) == law.startswith("cowper") and not cards.left_out
    other, _, _ = imported(cards.lines)
    for rate in (0.01, 0.7, 300.0):
        assert apart(one, other, rate) < error, rate
    flow = material(YLD2000, rate="johnson_cook C=0.02 reference=0.001")
    other, _, _ = imported(cards_of(flow).lines)
    assert apart(flow, other, 2.0) < 1e-4


def test_rates_of_others():
    """Check C and P of *MAT_036, and a table of rates above 1 /s, whose logarithms would all be positive."""
    found = fields_in(cards_of(material(SCALED, rate="cowper_symonds C=40 p=5")).lines)
    assert float(found["c"]) == pytest.approx(40 * 1.3**0.5, rel=1e-7) and float(found["p"]) == 5
    one = material(rate="johnson_cook C=0.02 reference=5", hardening=SWIFT)
    other, _, _ = imported(cards_of(one).lines)
    for rate in (0.1, 100.0):
        assert apart(one, other, rate) < 1e-4


def test_library():
    """Check that materials of the library have cards, and that those without one are refused with a name."""
    for name in ("dc06", "dp600", "dp780_yoshida_uemori", "eddq_kinematic", "aa6016_t4_yld2000", "aa2090_t3_yld91"):
        one = dd3.material(name)
        other, _, _ = imported(cards_of(one).lines)
        assert max(difference(one, other)) < 1e-6 and apart(one, other) < 1e-4, name


@pytest.mark.parametrize("keys, said", [
    ({"criterion": "drucker c=1.5"}, "yield = drucker: Yld2000-2d by eight values"),
    ({"hardening": "teodosiu_hu Y0=120 CR=28 Rsat=80 CX=200 X0=10 Ssat=240 CSD=4 CSL=4 nL=1 CP=2.2 nP=25 f=0.7 r=4"},
     "hardening = teodosiu_hu"),
    ({**CHABOCHE, "backstress": "prager k=300"}, "backstress = prager"),
    ({"criterion": HILL, "modulus": "chord Ea=1.6e5 xi=30"}, "constant E"),
    ({**TWO_SURFACES, "rate": "power m=0.02 reference=0.01"}, "rate = power"),
    ({**HEATED, "hardening": SWIFT}, "temperature = johnson_cook")])
def test_refused(keys, said):
    """Check that a law without a card is an error with its name and the nearest card, which is written on request."""
    one = material(**keys)
    with pytest.raises(dd3.Problem, match=r"no card of LS-DYNA has all.*nearest: \*MAT_") as error:
        cards_of(one)
    assert said in str(error.value)
    cards = cards_of(one, CardOptions(nearest=True))
    assert said in "\n".join(cards.left_out)
    other, _, _ = imported(cards.lines)
    assert np.allclose(one.curve(0.2)["stress"][5:], other.curve(0.2)["stress"][5:],
                       rtol=0.02 if "heat_capacity" in keys else 2e-3)  # 20 K by heating


def test_nearest_criterion():
    """Check the differences that are named: r-values and yield stresses of Yld2004 by eight values."""
    one = dd3.material("aa6022_t4_yld2004")
    cards = cards_of(one, CardOptions(nearest=True))
    other, _, _ = imported(cards.lines)
    stress, r = difference(one, other, range(0, 91, 5))
    text = cards.left_out[0]
    assert f"tension within {100 * stress:.2g} %" in text and f"r-values within {r:.2g}" in text, (text, stress, r)
    assert max(difference(one, other, (0, 45, 90))) < 1e-6  # three of the eight
    with pytest.raises(dd3.Problem, match=r"\*MAT_024 does not have .* expected \*MAT_133"):
        cards_of(one, CardOptions(card=24))


def test_options():
    """Check options that cannot be met, and the density."""
    for options in ({"units": "inch"}, {"card": 1}, {"strain": 0.0}, {"mid": 0}, {"density": -1.0}):
        with pytest.raises(dd3.Problem):
            CardOptions(**options)
    light = dd3.material(young=7e4, poisson=0.3, yield_="von_mises", hardening=SWIFT)
    cards = cards_of(light)
    assert fields_in(cards.lines)["ro"] == "2.7e-9" and "no density in *MATERIAL" in "\n".join(cards.notes)
    assert fields_in(cards_of(light, CardOptions(density=2.6e-9, mid=7)).lines)["ro"] == "2.6e-9"
    odd = dd3.material(young=1e3, poisson=0.3, yield_="von_mises", hardening="perfect Y0=5")
    with pytest.raises(dd3.Problem, match="--density"):
        cards_of(odd)


def strain_at(blocks, triaxiality, lode):
    """Return the strain to fracture of blocks over the Lode angle, straight between them."""
    return np.interp(lode, [angle for angle, _ in blocks], [np.interp(triaxiality, *points.T) for _, points in blocks])


@pytest.mark.parametrize("law, error", [
    ("table 0:0.7 0.333:0.9 0.577:0.5 0.667:0.9 exponent=2", 1e-6),
    ("table lode1=-1 lode2=0 lode3=1  0:1.4 0.667:0.9  0:0.7 0.577:0.5  0:1.1 0.333:0.9", 1e-6),
    ("hosford_coulomb a=1.4 b=0.9 c=0.05", 0.05)])
def test_fracture(law, error):
    """Check strains to fracture that are read back, and the forming limit curve."""
    limit = "-0.2 0.5 0 0.3 0.2 0.4"
    cards = cards_of(material(fracture=law, forming_limit=limit), CardOptions(erosion=True))
    _, block, _ = imported(cards.lines)
    text = block.split("fracture =")[1].split("forming_limit")[0].replace("&", " ")
    read, own = blocks_of(words_of(text)), words_of(law)
    assert read[0][1][0, 0] <= -0.4 and words_of(text).values.get("exponent", 1) == own.values.get("exponent", 1)
    for lode in (-1, -0.6, 0.0, 0.3, 0.9) if len(read) > 1 else (0.0,):
        for triaxiality in (0.05, 0.333, 0.5, 0.6):
            exact = hosford_coulomb(own, np.array([triaxiality]), lode)[0] if own.name != "table" else \
                strain_at(blocks_of(own), triaxiality, lode)
            assert strain_at(read, triaxiality, lode) == pytest.approx(exact, rel=error), (triaxiality, lode)
    assert np.allclose([float(word) for word in block.split("forming_limit =")[1].split("\n")[0].split()],
                       [float(word) for word in limit.split()], atol=1e-9)
    assert "dtyp" in fields_in(cards.lines) and float(fields_in(cards.lines)["dtyp"]) == 0


def test_fracture_of_a_scaled_criterion():
    """Check that strains to fracture are those of the card, of tension along rolling."""
    _, block, _ = imported(cards_of(material(SCALED, fracture="table 0:0.7 0.5:0.5")).lines)
    read = blocks_of(words_of(block.split("fracture =")[1].split("density")[0].replace("&", " ")))
    assert strain_at(read, 0.1, 0.0) == pytest.approx(0.66 * 1.3**0.5, rel=1e-6)


def test_fracture_of_the_law():
    """Check Hosford and Coulomb's strains by the special cases of the page: tension, plane strain and shear."""
    law, b, c, a, n = words_of("hosford_coulomb a=1.4 b=0.9 c=0.05"), 0.9, 0.05, 1.4, 0.1
    shear = (1 + 2**(a - 1))**(1 / a)
    for triaxiality, lode, exact in ((1 / 3, 1, b), (2 / 3, -1, b), (1 / np.sqrt(3), 0, b * (
            np.sqrt(3) * (1 + c) / (shear + 2 * c))**(1 / n)), (0.0, 0, b * (np.sqrt(3) * (1 + c) / shear)**(1 / n))):
        assert hosford_coulomb(law, np.array([triaxiality]), lode)[0] == pytest.approx(exact, rel=1e-9)


def test_iscale():
    """Check that the coefficients of *MAT_133 are scaled to the rolling direction with ISCALE = 0, not with 1."""
    alpha = row(*[1.1] * 8)
    axes = [row(2.0), row("", "", "", 1.0, 0.0, 0.0), row("")]
    for scaled, expected in (("", 1.0), (1.0, 1.1)):
        other, _, _ = imported(["*MAT_BARLAT_YLD2000", row(1, "7.85E-9", "2.1E5", 0.3, 0.0, "", "", scaled),
                                row(500.0, 0.01, 0.2, "", "", 1, 8.0), alpha, *axes])
        assert 1 / other.yield_stresses([0])[0] == pytest.approx(expected, rel=1e-6)


def test_forming_limit_of_erosion():
    """Check LCFLD of *MAT_ADD_EROSION, and that other criteria of the keyword are named as before."""
    plain = ["*MAT_024", row(1, "7.85E-9", "2.1E5", 0.3, 200.0, 500.0), "", "", ""]
    limit = curve(9, (-20.0, 60.0), (0.0, 30.0), (30.0, 40.0))
    added = ["*MAT_ADD_EROSION", row(1), row("", "", "", 0.3), row(0), row(9, "", 0.25)]
    _, block, left_out = imported([*plain, *added, *limit])
    assert "forming_limit = -0.223143551 0.470003629 0 0.262364264 0.262364264 0.336472237" in block
    assert any("MXEPS" in item for item in left_out) and any("EPSTHIN" in item for item in left_out)
    _, block, left_out = imported([*plain, *added[:3]])
    assert "forming_limit" not in block and any("criteria are not available" in item for item in left_out)


def test_command():
    """Check a material alone by the command: a name of the library, a file, refusals."""
    said = call("export", "dc06", "dc06.k", "--mid", "4")
    assert "dc06: *MAT_036 (*MAT_3-PARAMETER_BARLAT), MID = 4" in said and "grade: left out" in said
    text = Path("dc06.k").read_text()
    assert text.startswith("*KEYWORD\n$ Units: mm MPa\n") and text.endswith("*END\n")
    Path("two.dat").write_text("*MATERIAL a\n young = 2e5\n poisson = 0.3\n yield = von_mises\n hardening = perfect "
                               "Y0=200\n*MATERIAL b\n young = 2e5\n poisson = 0.3\n yield = von_mises\n hardening = "
                               "perfect Y0=300\n")
    assert "b: *MAT_024" in call("export", "two.dat", "b.k", "--name", "b")
    assert "nearest: *MAT_133" in call("export", "aa2090_t3_bbc2008", "x.k", expect=2) and not Path("x.k").exists()
    assert "left out: yield = bbc2008" in call("export", "aa2090_t3_bbc2008", "x.k", "--nearest")
    assert "written for LS-DYNA" in call("export", "dc06", "x.vtu", expect=2)
    assert "goes with --cards or a material" in call("export", "none.out", "x.k", "--nearest", expect=2)


def test_run(program):
    """Check the cards of a run in the file of its sheet, with the rolling direction of each shell."""
    deck = DECK.replace("yield = von_mises", f"yield = {HILL}\n  rolling_direction = 1 1 0\n  density = 7.85e-9")
    Path("bar.dat").write_text(deck)
    subprocess.run([program, "--quiet", "bar.dat"], check=True, capture_output=True)
    said = call("export", "bar.out", "bar.k", "--shells", "--cards")
    assert "m: *MAT_036" in said and "BETA" in said
    lines = Path("bar.k").read_text().splitlines()
    start = lines.index("*ELEMENT_SHELL_THICKNESS")
    assert float(lines[start + 2][64:80]) == pytest.approx(45, abs=0.5)
    assert fields_in(lines)["aopt"] == "0." and fields_in(lines)["elform"] == "16"
    assert call("dynain", "bar.k", "next.out")
    said = call("export", "bar.out", "first.k", "--shells", "--cards", "--at", "pull:0")
    assert "that of the initial sheet" in said and fields_in(Path("first.k").read_text().splitlines())["a2"] == "1."
    said = call("export", "bar.out", "solids.k", "--cards")
    assert "a card for shells" in said and "*SECTION_SOLID" in Path("solids.k").read_text()
    assert "*MAT" not in (call("export", "bar.out", "plain.k", "--shells"), Path("plain.k").read_text())[1]
    assert "mm and MPa" in call("export", "bar.out", "x.k", "--cards", "--units", "m Pa", expect=2)
    Path("bar.dat").write_text(deck.replace(HILL, "drucker c=1.5"))
    subprocess.run([program, "--quiet", "bar.dat"], check=True, capture_output=True)
    said = call("export", "bar.out", "bar.k", "--shells", "--cards")
    assert "left out: the card of the material m: no card" in said and "*MAT" not in Path("bar.k").read_text()


def initial(text):
    """Return the numbers of the initial stresses in a keyword file."""
    rows = [line for line in text.split("*INITIAL")[1].split("\n*")[0].splitlines() if "e" in line[:12]]
    return [[float(line[i:i + 10]) for i in range(0, len(line), 10)] for line in rows]


def test_plastic_strain_of_a_scaled_criterion(program):
    """Check that plastic strains are those of the card, of tension along rolling, whose work is the same."""
    for name, criterion in (("plain", "hill48 F=0.5 G=0.5 H=0.5 N=1.5"), ("scaled", "hill48 F=2 G=2 H=2 N=6")):
        # The scaled criterion has twice the equivalent stress and half the plastic strain at the same tension.
        law = "linear Y0=200 H=1000" if name == "plain" else "linear Y0=400 H=4000"
        Path(f"{name}.dat").write_text(DECK.replace("linear Y0=200 H=1000", law).replace("von_mises", criterion))
        subprocess.run([program, "--quiet", f"{name}.dat"], check=True, capture_output=True)
        for form in ("shells", "solids"):
            call("export", f"{name}.out", f"{name}_{form}.k", "--cards", *["--shells"] * (form == "shells"))
    for form in ("shells", "solids"):
        one, other = (Path(f"{name}_{form}.k").read_text() for name in ("plain", "scaled"))
        assert "sigy" in one and np.allclose(initial(one), initial(other), rtol=2e-3, atol=1e-6)
        assert fields_in(one.splitlines())["etan"] == fields_in(other.splitlines())["etan"]


def test_run_with_a_file(program):
    """Check a material whose curve is in a file beside the input file, from another folder."""
    Path("jobs").mkdir()
    Path("jobs/curve.txt").write_text("0 200\n0.1 300\n0.5 400\n")
    Path("jobs/bar.dat").write_text(DECK.replace("hardening = ${hardening}", 'hardening = table file = "curve.txt"'))
    subprocess.run([program, "--quiet", "jobs/bar.dat"], check=True, capture_output=True)
    assert "m: *MAT_024" in call("export", "jobs/bar.out", "bar.k", "--cards")
    assert float(fields_in(Path("bar.k").read_text().splitlines())["lcss"]) == 101


def test_angles():
    """Check the angle of the rolling direction about the normal of a shell, also of one that is turned over."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    corners = np.stack([square, square[::-1], square[[1, 2, 3, 0]]])
    rolling = np.tile([np.cos(np.radians(30)), np.sin(np.radians(30)), 0.0], (3, 1))
    assert np.allclose(rolling_angles(rolling, corners), [30, -30, -60])
