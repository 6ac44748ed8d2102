# SPDX-License-Identifier: GPL-3.0-or-later
"""Limits that a run follows: identified from tests, in the verdict, pictures and forming limit diagram, exported."""

import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from helpers import ROOT, call
from scipy.optimize import least_squares

import dd3
from dd3 import forming_limit, forming_limit_diagram
from dd3.fields import LIMITED
from dd3.identify.fracture import stress_of
from dd3.plot import scale
from dd3.plot import sheet as pictures
from dd3.sheet import Sheet
from dd3.verdict import BAD, GOOD, REACHED, ended_phases, limits_of_material
from dd3.viewer.scene import Scene

STATES = np.array([(0, 0), (1 / 3, 1), (1 / np.sqrt(3), 0), (2 / 3, -1), (0.45, 0.5)])
BAR = ROOT / "tests" / "cases" / "limits_bar" / "case.dat"


def strain_of(states, a, b, c, n=0.1):
    """Return the strain to fracture of Hosford and Coulomb, from the principal stresses."""
    first, second, third = np.array([stress_of(*state) for state in states]).T
    hosford = (((first - second) ** a + (second - third) ** a + (first - third) ** a) / 2) ** (1 / a)
    return b * (1 + c) ** (1 / n) * (hosford + c * (first + third)) ** (-1 / n)


def identified(program, strains, *words):
    """Return a, b and c that are identified from strains of the states, and what is said."""
    rows = [f"{100 * strain:.9g};{lode:.9g};{place:.12g}" for (place, lode), strain in zip(STATES, strains)]
    Path("tests.csv").write_text("strain to fracture (%);Lode angle;triaxiality\n" + "\n".join(rows) + "\n")
    said = call("identify", "steel", "--fracture", "tests.csv", "--program", program, *words)
    law = Path("steel.dat").read_text().split("fracture = hosford_coulomb ")[1].split()
    return np.array([float(word.split("=")[1]) for word in law[:3]]), said


def test_states():
    """Check principal stresses: their mean, von Mises's stress, the normalised Lode angle, and their order."""
    for place, lode in STATES:
        stress = stress_of(place, lode)
        deviator = stress - stress.mean()
        assert stress.mean() == pytest.approx(place) and 1.5 * deviator @ deviator == pytest.approx(1)
        assert 1 - 2 / np.pi * np.arccos(np.clip(13.5 * deviator.prod(), -1, 1)) == pytest.approx(lode, abs=1e-7)
        assert (np.diff(stress) < 1e-12).all()


def test_identified(program):
    """Check that a, b and c are found again from exact strains, also with another exponent, and from strains with
    noise those of an independent fit."""
    for exponent, given in ((0.1, (1.4, 0.9, 0.05)), (0.2, (1.9, 0.4, 0.12))):
        exact = strain_of(STATES, *given, exponent)
        found, said = identified(program, exact, "--fracture-exponent", exponent, "--plot", "strains.png")
        assert found == pytest.approx(given, rel=2e-5), said
        assert "Note: the strain" not in said and Path("strains.png").is_file()
    random = np.random.default_rng(3)
    for _ in range(3):
        noisy = strain_of(STATES, 1.4, 0.9, 0.05) * (1 + 0.05 * random.standard_normal(len(STATES)))
        expected = least_squares(lambda x, noisy=noisy: strain_of(STATES, *x) / noisy - 1, [1.5, 0.8, 0.1],
                                 bounds=([1, 0, 0], [5, 10, 1]), x_scale=[0.1, 0.1, 0.01], xtol=1e-12, ftol=1e-12)
        found, said = identified(program, noisy)
        off = np.linalg.norm(strain_of(STATES, *found) / noisy - 1)
        assert found == pytest.approx(expected.x, rel=3e-3, abs=2e-4), said
        assert off == pytest.approx(np.linalg.norm(expected.fun), rel=1e-5)
        assert np.abs(found - [1.4, 0.9, 0.05]).max() < 0.25


@pytest.mark.parametrize(("rows", "said"), [
    ("0.33 1 0.9\n0.57 0 0.5\n", "2 tests"), ("0.33 1 0.9\n0.57 0 0.5\n0.66 -1.2 0.9\n", "Lode angle = -1.2"),
    ("0.33 1 90\n0.57 0 50\n0.66 -1 90\n", "strain to fracture = 90"),
    ("0.33 0.9\n0.57 0.5\n0.66 0.9\n", "a number is missing")])
def test_wrong_tests(program, rows, said):
    """Check what tables are refused."""
    Path("tests.csv").write_text(rows)
    assert said in call("identify", "steel", "--fracture", "tests.csv", "--program", program, expect=2)


def test_scales():
    """Check that the scales of limits hold 0 and 1, and that all values from 1 on have one colour."""
    for high, end in ((0.4, 1.0), (1.22, 1.4), (37.0, 40.0)):
        found = scale.scale_of("fracture_damage", 0.1, high)
        assert (found.low, found.limit) == (0, 1) and found.high == pytest.approx(end)
        assert any(abs(tick - 1) < 1e-9 for tick in found.ticks) or high > 10
        colours = np.array(scale.colours_of(found).colors)
        values = np.linspace(found.low, found.high, len(colours))
        red = (np.abs(colours[:, :3] - [0xd5 / 255, 0x5e / 255, 0]) < 1e-9).all(axis=1)
        assert (red == (values >= 1)).all()
        assert (np.diff(colours[~red, :3] @ [0.2126, 0.7152, 0.0722]) > -1e-6).all()
    assert scale.scale_of("thinning", 0.1, 0.4).limit is None
    assert scale.own_scale("forming_limit_ratio", (0.5, 2.0)).limit == 1


@pytest.fixture
def bar(program):
    """Run the bar that is stretched beyond its limits."""
    Path("bar.dat").write_text(BAR.read_text())
    subprocess.run([program, "--quiet", "--threads", "1", "bar.dat"], check=True, capture_output=True)
    return dd3.open("bar.out")


def test_closing(bar):
    """Check the largest values of run.json, their elements and places, against the fields, and the verdict by them."""
    closing = bar.job["phases"][-1]["result"]["closing"]
    grid = bar.fields[-1]
    for name in LIMITED:
        reached, values = closing[name], grid.cell_data[name]
        assert reached["value"] == pytest.approx(values.max(), rel=1e-3)
        assert reached["position"] == pytest.approx(grid.get_cell(reached["element"] - 1).points.mean(axis=0), rel=1e-6)
    items = {item.name: item for item in bar.verdict()}
    assert list(items)[1:3] == [question for question, *_ in REACHED.values()]
    for name, (question, _, _) in REACHED.items():
        assert items[question].answer == BAD
        assert f" {closing[name]['value']:.3g}, at (" in items[question].text, items[question].text
        assert f"element {closing[name]['element']};" in items[question].text
    job = json.loads(json.dumps(bar.job))
    job["phases"][-1]["result"]["closing"] = None  # it stopped in its phase
    assert [item.answer for item in limits_of_material(job, list(ended_phases(job)))] == [BAD, BAD]
    job["warnings"] = []
    assert limits_of_material(job, list(ended_phases(job))) == []
    job["phases"][-1]["result"]["closing"] = {**closing, "fracture_damage": None,
                                              "forming_limit_ratio": {**closing["forming_limit_ratio"], "value": 0.9}}
    assert [(item.name, item.answer) for item in limits_of_material(job, list(ended_phases(job)))] == [
        ("forming limit of bent paths", GOOD)]


def test_shown(bar):
    """Check pictures, forming limit diagram and 3D view of the bar, and what is exported."""
    said = call("fld", "bar.out")
    assert "12 of 12 nodes, 2 of 2 elements fractured (fracture_damage); largest mean of an element 1.04 in " in said
    assert "2 of 2 elements beyond the limit of bent paths" in said and "; elements " in said
    assert "0 of 2 elements fractured" in call("fld", "bar.out", "--at", "pull:0")
    drawn, _ = forming_limit_diagram.figure("bar.out")
    labels = [text.get_text() for text in drawn.axes[0].get_legend().get_texts()]
    assert {"fractured", "beyond the limit of bent paths"} <= set(labels)
    said = call("report", "bar.out", "--verdict", expect=1)
    assert "fracture: not good: largest damage 1.04, at (" in said
    page = Path("bar.out/report/report.html").read_text()
    for name, title in zip(LIMITED, ("Fracture damage", "Ratio to the forming limit of bent paths")):
        assert Path(f"bar.out/report/{name}.png").is_file() and f"<h2>{title}</h2>" in page
    sheet, run = Sheet("bar.out"), pictures.Run("bar.out")
    fields = Scene(sheet, run, [], forming_limit.find_limits(sheet, run.job, forming_limit.Criteria()), 0.1
                   ).description()["fields"]
    for field in fields:
        if field["name"] in LIMITED:
            assert (field["scale"].low, field["scale"].limit) == (0, 1) and field["scale"].high > 1
            assert not field["percent"] and field["scales"][0].high == 1
        else:
            assert field["scale"].limit is None
    assert "left out: fracture_damage, forming_limit_ratio" in call("export", "bar.out", "bar.k")
    assert "left out" not in call("export", "bar.out", "bar.vtu")
    grid = pv.read("bar.vtu")
    assert all(np.allclose(grid.cell_data[name], bar.fields[-1].cell_data[name]) for name in LIMITED)
