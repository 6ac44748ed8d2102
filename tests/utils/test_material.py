# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials in Python, by the library of the laws: published values, closed forms, the program at single points."""

import math
import re

import numpy as np
import pytest
from helpers import ROOT

import dd3
from dd3 import places
from dd3.plot import point

pytestmark = pytest.mark.skipif(places.nearest(places.LIBRARY) is None, reason="without the library of the laws")
LIBRARY = ROOT / "input_files/materials"


def check_values(path):
    """Return the check values of a file of the library: direction, stress over flow stress, r-value; NaN where none."""
    rows = re.findall(r"#   (tension \d+|biaxial) +(\S+) +(\S+)", path.read_text())
    return {name: [math.nan if value == "-" else float(value) for value in values] for name, *values in rows}


@pytest.mark.parametrize("name", ["dc06", "aa2090_t3_yld2004", "mg_th_cpb06", "aa2090_t3_yld2000", "aa2090_t3_bbc2008"])
def test_published(name):
    """Check yield stresses and r-values against those that the file of the library gives."""
    material, compared = dd3.material(name), 0
    for words, (stress, r) in check_values(LIBRARY / f"{name}.dat").items():
        if words == "biaxial":
            values = (1 / material.equivalent_stress([1, 1, 0, 0, 0, 0]), math.nan)
        else:
            angle = float(words.split()[1])
            values = material.yield_stresses([angle])[angle], material.r_values([angle])[angle]
        for value, expected, digits in zip(values, (stress, r), (4, 2)):
            if not math.isnan(expected) and not math.isnan(value):
                assert abs(value - expected) <= 0.6 * 10**-digits, (words, value, expected)
                compared += 1
    assert compared >= 3


def test_closed_forms():
    """Check a curve, the yield locus and the forming limit curve of von Mises and Swift."""
    steel = dd3.material(young=2.1e5, poisson=0.3, yield_="von_mises", hardening="swift K=530 e0=0.004 n=0.2",
                         grade="low_carbon_steel")
    curve = steel.curve(0.2, angle=30)
    plastic = curve["strain"] - curve["stress"] / 2.1e5
    assert np.allclose(curve["stress"][1:], 530 * (0.004 + plastic[1:]) ** 0.2, rtol=1e-6)
    assert np.allclose(curve["plastic_strain"][1:], plastic[1:], rtol=1e-6)
    for shear in (0.0, 0.4):
        locus = steel.yield_locus(36, shear)
        assert np.allclose(locus["s11"]**2 - locus["s11"] * locus["s22"] + locus["s22"]**2 + 3 * shear**2, 1)
    assert np.allclose(steel.r_values(), 1, atol=1e-5) and steel.flow_stress() == pytest.approx(530 * 0.004**0.2)
    assert steel.flc(1.0).limit(0.0) == pytest.approx(math.log(1 + (23.3 + 14.13) / 100 * 0.2 / 0.21))
    assert dd3.material({"young": 1, "poisson": 0, "yield": "von_mises", "hardening": "perfect Y0=1",
                         "forming_limit": [-0.2, 0.5, 0, 0.3, 0.3, 0.4]}).flc().limit(0.15) == pytest.approx(0.35)


def test_program(program):
    """Check curves at angles, with back-stresses and a change of direction, against the program at single points."""
    for name in ("aa2090_t3_yld2004", "eddq_kinematic"):
        file = LIBRARY / f"{name}.dat"
        material, angles = dd3.material(file), (0.0, 45.0, 90.0)
        points = point.run(program, point.deck(file, [material.name], angles, [], 0.05))[1]
        for angle in angles:
            rows = points[f"t0_{angle:g}"]
            curve = material.curve(0.05, angle)
            computed = np.interp([row["e11"] for row in rows[3:]], curve["strain"], curve["stress"])
            assert np.allclose(computed, [row["s11"] for row in rows[3:]], rtol=2e-3), (name, angle)
            if name == "aa2090_t3_yld2004":
                assert material.r_values([angle])[angle] == pytest.approx(point.r_value(rows), rel=5e-3)


def test_errors():
    """Check what wrong values, names and states say."""
    for act, said in ((lambda: dd3.material(young=2e5), "error E121: 'poisson' is missing"),
                      (lambda: dd3.material("no_such"), "no material of the library"), (dd3.material, "takes a file"),
                      (lambda: dd3.material("dc06", young=2e5), "takes 'dc06' or keys of *MATERIAL, not both"),
                      (lambda: dd3.material("dc06").yield_locus(shear=1.0), "beyond the yield stress in shear, 0.6251"),
                      (lambda: dd3.material("aa2090_t3_yld2004").flc(), "no forming limit curve for the material")):
        with pytest.raises(dd3.Problem) as problem:
            act()
        assert said in str(problem.value), problem.value
