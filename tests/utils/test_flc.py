# SPDX-License-Identifier: GPL-3.0-or-later
"""Forming limit curves by Marciniak and Kuczynski: closed forms, independent integrations, the command."""

import argparse
import math

import numpy as np
import pytest
from helpers import call
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from dd3 import forming_limit, marciniak_kuczynski, places
from dd3.errors import Problem
from dd3.flc import calibrated
from dd3.forming_limit_curve import keeler_brazier, read_curve
from dd3.laws import Material
from dd3.marciniak_kuczynski import RATIO, Groove, Path, Sheet, ratios_of

pytestmark = pytest.mark.skipif(places.nearest(places.LIBRARY) is None, reason="libdd3laws.so is not built")
N = 0.22


def material(law="von_mises", hardening=f"swift K=500 e0=1e-6 n={N}", young=2e7):
    """Return a material, nearly rigid-plastic with a power law."""
    return Material(f"*MATERIAL sheet\n  young = {young}\n  poisson = 0.3\n  yield = {law}\n  hardening = {hardening}\n")


def plane_strain(ratio):
    """Return the limit of a power law in plane strain: e^n exp(-e) of the sheet is f0 times that of the groove."""
    def work(strain):
        return N * math.log(strain) - strain

    def excess(strain):
        groove = brentq(lambda other: work(strain) - math.log(ratio) - work(other), strain, N)
        return (N / strain - 1) / (N / groove - 1) - RATIO

    top = brentq(lambda strain: work(strain) - math.log(ratio) - work(N), 1e-6, N)
    return brentq(excess, 1e-3, top - 1e-9)


def stretching(ratio, path):
    """Return the limit of a power law, von Mises, with the groove across the major strain: Levy-Mises flow, with the
    groove's major strain as the independent variable."""
    def stress(strain, slope):
        return strain**N * (2 + slope) / math.sqrt(3 * (1 + slope + slope**2))

    def slowness(groove, values):
        sheet, effective = values
        thinning = math.log(ratio) + (sheet - groove)  # the minor strains are equal: ln of the thickness ratio
        own = math.sqrt(4 / 3 * (1 + path + path**2)) * sheet

        def excess(rate):
            return math.exp(thinning) * stress(effective, path * rate) - stress(own, path)

        return brentq(excess, 0.0, 1.0) if excess(0.0) > 0 > excess(1.0) else 0.0

    def rates(groove, values):
        rate = slowness(groove, values)
        alpha = path * rate
        return rate, math.sqrt(4 / 3 * (1 + alpha + alpha**2))

    def end(groove, values):
        rate = slowness(groove, values)
        return (1 + path) * rate / (1 + path * rate) - 1 / RATIO

    end.terminal = True
    start, ahead = 1e-5, ratio ** (-1 / N)  # the stresses have the ratio f0 at the start
    done = solve_ivp(rates, (start * ahead, 2.0), (start, math.sqrt(4 / 3 * (1 + path + path**2)) * start * ahead),
                     events=end, rtol=1e-7, atol=1e-10)
    return float(done.y_events[0][0][0])


@pytest.mark.parametrize("ratio", (0.98, 0.99, 0.999))
def test_plane_strain(ratio):
    """Check plane strain against its closed form, and that the error is of second order in the step."""
    exact = plane_strain(ratio)
    off = [abs(Sheet(material(), ratio, step=step).length_at(Path(0.0), 0.0) - exact) for step in (0.01, 0.005, 0.0025)]
    assert off[2] < 1e-4 and off[1] < 2e-4 and off[2] < off[1] < off[0], off


@pytest.mark.parametrize("path", (0.25, 0.5, 1.0))
def test_stretching(path):
    """Check biaxial stretching against an independent integration; the groove's path bends, the error is of first
    order in the step."""
    exact = stretching(0.98, path)
    off = [abs(Sheet(material(), 0.98, step=step).length_at(Path(path), 0.0) / exact - 1) for step in (0.005, 0.002)]
    assert off[1] < 5e-3 and off[1] < 0.55 * off[0], off


@pytest.mark.parametrize("path", (-0.5, -0.25, 0.0))
def test_localised_necking(path):
    """Check that with a small imperfection limit and angle are those of Hill (1952), and of Considere in plane strain."""
    limit = Sheet(material(), 1 - 1e-5).limit(Path(path), 20.0)
    assert abs(limit.major - N / (1 + path)) < 0.02 * N
    assert abs(limit.turned - math.degrees(math.atan(math.sqrt(-path)))) < 3


def test_rate_sensitivity():
    """Check plane strain with a rate sensitivity against an independent integration."""
    ratio, m = 0.99, 0.02

    def slowness(groove, values):
        return [(ratio * math.exp(values[0] - groove) * (groove / values[0]) ** N) ** (1 / m)]

    def end(groove, values):
        return slowness(groove, values)[0] - 1 / RATIO

    end.terminal = True
    exact = solve_ivp(slowness, (1e-4, 3.0), [1e-4 * ratio ** (1 / (N + m))], events=end, rtol=1e-9, atol=1e-12)
    found = [Sheet(material(), ratio, rate_sensitivity=m, step=step).length_at(Path(0.0), 0.0) for step in (0.005, 0.0025)]
    off = [abs(length - exact.y_events[0][0][0]) for length in found]
    assert off[1] < 0.6 * off[0] < 2e-3 and found[1] > plane_strain(ratio) + 0.01, (off, found)


def test_law_of_the_rate():
    """Check that a law of the strain rate gives the limit of the same sensitivity in the equilibrium, at any rate, and
    that both together are refused."""
    m, ratio = 0.02, 0.99
    wanted = Sheet(material(young=2e5), ratio, rate_sensitivity=m).length_at(Path(0.0), 0.0)
    rated = material(young=2e5, hardening=f"swift K=500 e0=1e-6 n={N}\n  rate = power m={m} reference=1e-6")
    for strain_rate in (0.1, 10.0):
        assert Sheet(rated, ratio, strain_rate=strain_rate).length_at(Path(0.0), 0.0) == pytest.approx(wanted, rel=5e-3)
    assert wanted > 1.1 * Sheet(material(young=2e5), ratio).length_at(Path(0.0), 0.0)
    with pytest.raises(Problem, match="one of them"):
        Sheet(rated, ratio, rate_sensitivity=m)


def test_curve_at_a_rate(caplog):
    """Check the stress of tension at a strain rate, at rest by default; without a law of the rate it is told."""
    rated = material(young=2e5, hardening="perfect Y0=200\n  rate = cowper_symonds C=40 p=5")
    assert rated.curve(0.1)["stress"].iloc[-1] == pytest.approx(200)
    assert rated.curve(0.1, rate=10.0)["stress"].iloc[-1] == pytest.approx(200 * (1 + 0.25**0.2), rel=1e-6)
    assert not caplog.text
    assert material(young=2e5, hardening="perfect Y0=200").curve(0.1, rate=10.0)["stress"].iloc[-1] == pytest.approx(200)
    assert "no law of the strain rate: rate = 10 does not act" in caplog.text


def test_directions():
    """Check that the limit turns with the material: Hill 1948 at 90 degrees, an isotropic criterion at 30."""
    swift = "swift K=500 e0=0.01 n=0.2"
    laws = "hill48 F=0.3 G=0.5 H=0.6 N=1.4", "hill48 F=0.5 G=0.3 H=0.6 N=1.4"
    across, swapped = (Sheet(material(law, swift, 2e5), 0.99, direction).length_at(Path(-0.3), 20.0)
                       for law, direction in zip(laws, (90.0, 0.0)))
    assert abs(across - swapped) < 1e-6
    turned, along = (Sheet(material("hosford m=8", swift, 2e5), 0.99, direction).length_at(Path(-0.3), 20.0)
                     for direction in (30.0, 0.0))
    assert abs(turned - along) < 1e-6


@pytest.mark.parametrize("m", (0.0, 0.02))
def test_derivatives(m):
    """Check the matrix of Newton's method by differences, in a step in which the groove turns."""
    sheet = Sheet(material("hill48 r0=2 r45=1.2 r90=1", "swift K=500 e0=0.01 n=0.2", 2e5), 0.99, 20.0, m)
    groove = Groove(sheet, Path(-0.3), 0.5)
    for thickness in (0.01, 0.02, 0.021):
        assert groove.solve(np.array([0.0, 0.0, thickness / 0.7, -thickness]), -thickness)
        if thickness < 0.021:
            groove.a.accept()
            groove.b.accept()
    at, size = groove.trial, 1e-7

    def balance(x):
        gradient = np.diag([math.exp(x[2]), math.exp(groove.path.ratio * x[2])])
        assert groove.a.attempt(gradient, x[3]) and groove.b.attempt(gradient + x[:2, None] * groove.normal, -0.021)
        return groove.balance(gradient, np.diag([1.0, groove.path.ratio]) @ gradient)

    matrix = balance(at)[1]
    for column, step in enumerate(size * np.eye(4)):
        change = (balance(at + step)[0] - balance(at - step)[0]) / (2 * size)
        assert np.abs(change - matrix[:, column]).max() < 0.01 * np.abs(matrix).max()


@pytest.mark.slow
def test_calibration():
    """Check that the calibration finds f0 of a limit, and refuses one above that of a perfect sheet."""
    sheet = Sheet(material(), 0.99)
    limit = sheet.limit(Path(0.0)).major
    assert abs(calibrated(sheet, 0.0, limit) - 0.99) < 1e-4
    assert list(ratios_of(13)) == list(np.linspace(-0.5, 1, 13)) and 0.0 in ratios_of(7)


def test_command(tmp_path):
    """Check table, picture, comparison and messages of the command."""
    sheet, points, table = tmp_path / "sheet.dat", tmp_path / "points.csv", tmp_path / "limits.csv"
    sheet.write_text("*MATERIAL sheet\n  young = 2e5\n  poisson = 0.3\n  yield = von_mises\n"
                     "  hardening = swift K=500 e0=0.005 n=0.2\n")
    points.write_text("minor,major\n0,0.17\n0,0.16\n")
    said = call("flc", sheet, "--f0", 0.99, "--points", 3, "--measured", points, "--output", table)
    assert "f0 = 0.99 (given)" in said and "near plane strain: 2 measured points" in said
    curve = read_curve(table)
    assert curve.label.startswith("sheet: Marciniak-Kuczynski, f0 = 0.99") and len(curve.minor) == 3
    assert curve.limit(0.0) < 0.195 < curve.limit(-0.1) and table.with_suffix(".png").is_file()
    said = call("flc", sheet, "--calibrate-plane-strain", 0.3, expect=2)
    assert "is not reached: with f0 = 0.99999 it is 0.19" in said and "--rate-sensitivity" in said
    assert "one of the arguments --f0" in call("flc", sheet, expect=2)
    assert "no such file, and no material of the library" in call("flc", "nosuch", "--f0", 0.99, expect=2)


def test_of_run(monkeypatch):
    """Check the curve of the material of a run, from its description, and of several materials."""
    monkeypatch.setattr(marciniak_kuczynski, "POINTS", 3)
    entries = {"young": "2e5", "poisson": "0.3", "yield": "von_mises", "hardening": "swift K=500 e0=0.005 n=0.2"}
    block = {"keyword": "material", "name": "Steel", "entries": [{"key": key, "text": text} for key, text in entries.items()]}
    other = {**block, "name": "other", "entries": block["entries"][:2]}
    job = {"materials": [{"name": "steel"}], "input": {"blocks": [block, other]}}
    parser = argparse.ArgumentParser()
    forming_limit.add_options(parser)
    options = parser.parse_args(["--flc-from-material", "0.99"])
    curve = forming_limit.find_limits(None, job, options).curve
    assert "f0 = 0.99 (assumed)" in curve.label and 0.12 < curve.limit(0.0) < 0.195
    job["materials"].append({"name": "other"})
    with pytest.raises(Problem, match="several materials"):
        forming_limit.find_limits(None, job, options)
    for words, text in (((), "takes a number"), (("--curve", "x.csv"), "goes without")):
        given = ["1.5"] if not words else ["0.99"]
        assert text in call("fld", "nosuch", "--flc-from-material", *given, *words, expect=2)


class Tailored:
    """Fields of a sheet of two materials, the first of 0.8 mm, the second of 2 mm, and nodes between."""

    def __init__(self, thickness):
        self.grid = {"PointData": {"material": 0}, "CellData": {"material": 0}}
        thinning = np.linspace(0, 0.2, 42)
        self.table = {"thickness": np.array(thickness) * (1 - thinning), "thinning": thinning, "material": np.array([1] * 20 + [0] * 2 + [2] * 20)}

    def values(self, step, name, at_cells=False):
        """Return a field."""
        return self.table[name], name


def test_of_tailored_sheet():
    """Check that each material has the curve of its own thickness and exponent, and that a sheet of one material and two
    thicknesses has that of the thinner part."""
    exponents = (0.2, 0.18)
    job = {"materials": [{"name": name, "hardening": {"name": "swift", "parameters": [{"name": "n", "value": n}]}}
                         for name, n in zip("ab", exponents)],
           "input": {"blocks": [{"keyword": "material", "name": name, "entries": [
               {"key": "grade", "text": "low_carbon_steel"}]} for name in "ab"]}}
    fields = Tailored([0.8] * 20 + [1.1] * 2 + [1.7] + [2.0] * 19)
    curves = forming_limit.find_limits(fields, job, forming_limit.Criteria()).by_material
    for number, thickness, n in zip((1, 2), (0.8, 2.0), exponents):
        assert curves[number].limit(0.0) == pytest.approx(keeler_brazier(thickness, n).limit(0.0))
    job["materials"][1]["hardening"]["parameters"][0]["value"] = exponents[0]
    even = Tailored([0.8] * 42)
    assert forming_limit.find_limits(even, job, forming_limit.Criteria()).curve is not None
    del job["materials"][1]
    curve = forming_limit.find_limits(fields, job, forming_limit.Criteria()).curve
    assert curve.limit(0.0) == pytest.approx(keeler_brazier(0.8, exponents[0]).limit(0.0))
