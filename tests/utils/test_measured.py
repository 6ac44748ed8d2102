# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured curves: their tables, their differences from the computed ones, and their place on the page of a run."""

import re
from pathlib import Path

import numpy as np
import pytest
from helpers import call, write_run
from viewer_run import HISTORY, STATUS, viewed_run

from dd3.computed import curve
from dd3.errors import Problem
from dd3.measured import Measured, along_curve, from_line, read
from dd3.sheet import Sheet


def test_tables(tmp_path):
    """Check units, sections, blank cells, decimal commas, and several columns of values."""
    file = tmp_path / "a.csv"
    file.write_text("# press 3\ntravel [mm], punch_force [kN]\n2, 3.5\n0, 0\n1, 2\n")
    force, = read(file, ["punch"])
    assert (force.name, force.over, force.section, force.file) == ("punch_force", "travel", "", "a.csv")
    assert force.at.tolist() == [0, 1, 2] and force.values.tolist() == [0, 2000, 3500]
    file.write_text("section;length0 [cm];thickness [mm];thinning [%]\ny=0;1,5;0,9;10\nx = 3;2;0,8;\ny=0;1;1,0;0\n")
    thick, other, thin = read(file, [])
    assert (thick.section, other.section) == ("y=0", "x=3") and thick.at.tolist() == [10, 15]
    assert thick.values.tolist() == [1.0, 0.9] and thin.values.tolist() == [0, 0.1] and thin.section == "y=0"


def test_units(tmp_path):
    """Check that MN and mN are told apart, and other units read in small or large letters."""
    file = tmp_path / "a.csv"
    for unit, size in (("MN", 1e6), ("mN", 1e-3), ("KN", 1e3), ("n", 1.0), ("LBF", 4.448222)):
        file.write_text(f"travel [MM], punch_force [{unit}]\n1, 2\n")
        found, = read(file, ["punch"])
        assert found.values[0] == 2 * size, unit


@pytest.mark.parametrize("text, said", (
    ("travel [mm], punch_force [mn]\n1, 2\n", "'punch_force' has the unit 'mn'"),
    ("travel [mm], force [kN]\n1, 2\n", "no column 'force'"), ("travel [mm], force [kN]\n1, 2\n", "punch_force"),
    ("travel [mm], punch_force\n1, 2\n", "'punch_force' has no unit"),
    ("travel [s], punch_force [N]\n1, 2\n", "the unit 's'"),
    ("angle [deg], punch_force [N]\n1, 2\n", "without the column travel"),
    ("length0 [mm], thickness [mm]\n1, 1\n", "without the column section"),
    ("travel [mm]\n1\n", "no column of measured"),
    ("travel [mm], travel [mm], punch_force [N]\n", "expected a heading and rows"),
    ("travel [mm], travel [mm], punch_force [N]\n1, 1, 2\n", "a second column 'travel'"),
    ("travel [mm], punch_force [N]\n1, two\n", ":2: error: 'two' is not a number"),
    ("travel [mm], punch_force [N]\n1, 2, 3\n", "more cells than the heading"),
    ("travel [mm], punch_force [N]\n, 3\n", "no rows with travel and punch_force")))
def test_refused(tmp_path, text, said):
    """Check what is refused: the message has the place, and the columns that are known."""
    file = tmp_path / "a.csv"
    file.write_text(text)
    with pytest.raises(Problem) as problem:
        read(file, ["punch"])
    assert said in str(problem.value) and str(problem.value).startswith(str(file))


def test_differences():
    """Check largest and root mean square differences, points beyond, angles in another turn, distances from a line."""
    at, values = np.array([0.0, 10, 20]), np.array([0.0, 10, 0])
    found = along_curve(Measured("a", "thickness", "length0", "y=0", np.array([5.0, 12, 25]), np.array([6.0, 6, 1])),
                        at, values)
    assert found.points == 2 and found.beyond == 1 and found.largest == -2 and found.where == 12
    assert abs(found.rms - np.sqrt((1 + 4) / 2)) < 1e-12
    turned = along_curve(Measured("a", "draw_in", "angle", "", np.array([-355.0]), np.array([5.5])), at, values)
    assert abs(turned.largest - 0.5) < 1e-9 and turned.beyond == 0
    line = np.column_stack([at, values])
    found = from_line(Measured("a", "z", "along", "y=0", np.array([5.0, 20]), np.array([7.0, -3])), line)
    assert abs(found.largest - 3) < 1e-12 and found.where == 20 and abs(found.rms**2 - (2 + 9) / 2) < 1e-12
    with pytest.raises(Problem):
        along_curve(Measured("a", "draw_in", "angle", "", np.array([90.0]), np.array([1.0])), at, values)


def test_nearest_piece():
    """Check distances from the nearest of several lines, and differences over the piece in which a point lies."""
    lines = [np.array([[0.0, 0], [4, 0]]), np.array([[6.0, 0], [9, 0]])]
    found = from_line(Measured("a", "z", "along", "y=0", np.array([1.0, 5, 8]), np.array([0, 0, 0.5])), *lines)
    assert found.largest == 1 and found.where == 5 and found.points == 3
    one, other = (np.array([0.0, 90]), np.array([1.0, 2])), (np.array([270.0, 360]), np.array([2.0, 1]))
    found = along_curve(Measured("a", "draw_in", "angle", "", np.array([-45.0, 180]), np.array([2.5, 9])), *one, other)
    assert abs(found.largest - 1) < 1e-9 and found.beyond == 1


def quarter(folder):
    """Write the results of a quarter of a ring from 20 to 50 mm: the rim is drawn in by 2 to 3 mm over the angle, the
    hole by 0."""
    radius, angle, z = np.meshgrid([20.0, 30, 40, 50], np.radians(np.linspace(0, 90, 10)), [0.0, 1.0], indexing="ij")
    start = np.column_stack([(radius * np.cos(angle)).ravel(), (radius * np.sin(angle)).ravel(), z.ravel()])
    number = np.arange(len(start)).reshape(radius.shape)
    cells = [[number[i + a, j + b, k] for k in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
             for i in range(3) for j in range(9)]
    draw_in = np.where(radius.ravel() == 50, 2 + np.degrees(angle.ravel()) / 90, 0)
    return write_run(folder, start, start, cells, HISTORY, STATUS, {"draw_in": (0 * draw_in, draw_in)})


def test_whole_part(tmp_path):
    """Check draw-in and shape at points on mirror images, beside a hole."""
    sheet = Sheet(quarter(tmp_path / "ring.out"))
    at, values = np.array([0.0, 45, 135, 180, 270, -45, 300]), np.array([2, 2.5, 2.5, 2, 3, 2.5, 2 + 2 / 3])
    found = along_curve(measured := Measured("a", "draw_in", "angle", "", at, values), *flat(sheet, measured, ["x", "y"]))
    assert found.points == 7 and found.beyond == 0 and abs(found.largest) < 1e-6, found
    strip = Sheet(viewed_run(tmp_path / "strip.out"))
    along = np.array([-35.0, -10, 0, 20, 35])
    for plane, mirror in (("y=2", "xy"), ("y=-2", "xy"), ("y=2", "x"), ("0", "xy")):
        measured = Measured("a", "z", "along", plane, along, 1 - 6 * (along / 40)**2)
        found = from_line(measured, *map(np.column_stack, curve(measured, strip, None, mirror).pieces))
        assert found.largest < 0.01, (plane, mirror, found)
    half = Measured("a", "z", "along", "y=2", along, along)
    assert len(curve(half, strip, None, "y").pieces) == 1 and len(curve(half, strip, None, "xy").pieces) == 2
    with pytest.raises(Problem, match="does not cut"):
        curve(half._replace(section="y=50"), strip, None, "xy")
    # A plane through the axis: the image beyond it.
    r = np.array([-9.0, -5, 5, 9])
    away = from_line(found := Measured("a", "z", "along", "45", r, 1 - 3 * (r / 40)**2),
                     *map(np.column_stack, curve(found, strip, None, "xy").pieces))
    assert away.largest < 0.01, away


def flat(sheet, measured, mirror):
    """Return the pieces of a computed curve, as arguments."""
    pieces = curve(measured, sheet, None, mirror).pieces
    return *pieces[0], *pieces[1:]


def test_on_the_page(tmp_path):
    """Check the table of differences of the made-up run, whose force, thickness and shape are known."""
    run = viewed_run(tmp_path / "strip.out")
    (tmp_path / "force.csv").write_text("travel [mm], punch_force [kN]\n0, 0\n1, 5.5\n")
    x = np.linspace(5, 35, 7)
    rows = [f"y=2,{length},{1 - length / 200 + 0.01},," for length in x] + [
        f"y=2,,,{along},{1 - 6 * (along / 40) ** 2}" for along in x]
    (tmp_path / "shape.csv").write_text("\n".join(["section,length0 [mm],thickness [mm],along [mm],z [mm]", *rows]))
    page = call("report", run, "--mirror", "x", "y", "--measured", tmp_path / "force.csv", "--measured",
                tmp_path / "shape.csv", "--output", tmp_path / "report").strip()
    text = Path(page).read_text(encoding="utf-8")
    section = re.search("<h2>Measured curves</h2>(.*?)</section>", text, re.DOTALL)[1]
    force = re.search(r"punch force \(force.csv\)</th><td>(.*?)</td>", section)[1]
    assert force == "2 points; largest difference +0.5 kN at travel 1 mm, rms 0.354 kN"  # of 10 kN at 2 mm
    thickness = re.search(r"thickness, section y=2 \(shape.csv\)</th><td>(.*?)</td>", section)[1]
    largest, rms = map(float, re.search(r"difference \+([0-9.]+) mm .*rms ([0-9.]+) mm", thickness).groups())
    # Lengths are those of the first step, which is bent.
    assert 0.0095 < largest < 0.0101 and 0.008 < rms < 0.0101, thickness
    away = float(re.search(r"z, section y=2 .*?largest difference \+([0-9.e-]+) mm", section)[1])
    assert away < 0.01, away
    (tmp_path / "bad.csv").write_text("travel [mm], die_force [kN]\n0, 0\n")
    said = call("report", run, "--measured", tmp_path / "bad.csv", "--output", tmp_path / "report", expect=2)
    assert "no column 'die_force'" in said and "punch_force" in said and "draw_in" in said
