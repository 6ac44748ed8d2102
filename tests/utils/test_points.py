# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials at a point: values and pictures of `dd3 plot point`, pictures of the laws, messages on bad input."""

import math
import sys

import numpy as np
import pytest
from helpers import UTILS, call
from matplotlib.colors import to_rgb
from PIL import Image

from dd3.plot import point
from dd3.programs import launch

# Hill's criterion and Swift's law, for which all values are known.
F, G, H, N = 0.284, 0.358, 0.642, 1.289
STEEL = f"""*MATERIAL Steel
  young = 2.1e5
  poisson = 0.3
  yield = hill48 F={F} G={G} H={H} L={N} M={N} N={N}
  hardening = swift K=565 e0=0.007117 n=0.259
"""
MISES = STEEL.replace("Steel", "round").replace("hill48", "von_mises #")


@pytest.fixture
def files(tmp_path):
    """Return the folder with files of materials."""
    (tmp_path / "parts.inc").write_text(STEEL)
    (tmp_path / "steel.dat").write_text("# the sheet\n*INCLUDE parts.inc\n")
    (tmp_path / "round.dat").write_text(STEEL + MISES)
    return tmp_path


def close(value, wanted, tolerance=1e-3):
    assert abs(value - wanted) <= tolerance * max(1, abs(wanted)), f"{value}, expected {wanted}"


def test_values(program, files):
    """Check tension, r-values, surface and normals against Hill's and Swift's formulas."""
    path, names = point.names_in(f"{files / 'steel.dat'}:STEEL", program)
    assert (path, names) == (str(files / "steel.dat"), ["steel"]), (path, names)
    ratios = np.radians([0, 30, 80, 200])
    points = point.run(program, point.deck(path, names, [0, 45, 90], ratios, 0.2))[1]
    stress = points["t0_0"][-1]["s11"]
    close(stress, 565 * (0.007117 + 0.2 - stress / 2.1e5) ** 0.259, 1e-6)
    for angle, r, stress in ((0, H / G, 1), (45, N / (F + G) - 0.5, 2 / math.sqrt(F + G + 2 * N)),
                             (90, H / F, 1 / math.sqrt(F + H))):
        close(point.r_value(points[f"t0_{angle}"]), r)
        close(point.yield_stress(points[f"t0_{angle}"]), stress)
    for i, ratio in enumerate(ratios):
        end = points[f"p0_{i}"][-1]
        x, y = (end[key] / end["flow_stress"] for key in ("s11", "s22"))
        close((G + H) * x * x + (F + H) * y * y - 2 * H * x * y, 1, 1e-6)
        normal = math.atan2((F + H) * y - H * x, (G + H) * x - H * y)
        close(math.cos(normal - ratio), 1, 1e-4)


def test_rate(program, files):
    """Check tension at two strain rates against Swift's law with Johnson and Cook's factor of the rate."""
    sheet = files / "fast.dat"
    sheet.write_text(STEEL + "  rate = johnson_cook C=0.02 reference=0.001\n")
    for rate in (1e-3, 10):
        rows = point.run(program, point.deck(sheet, ["steel"], [0], [0], 0.2, rate))[1]
        stress, plastic = (rows["t0_0"][-1][key] for key in ("s11", "eqps"))
        factor = 1 + 0.02 * math.log(max(rows["t0_0"][-1]["plastic_strain_rate"] / 1e-3, 1))
        close(stress, factor * 565 * (0.007117 + plastic) ** 0.259, 1e-6)
        close(rows["t0_0"][-1]["plastic_strain_rate"], rate, 0.01)
        close(point.yield_stress(rows["t0_0"]), 1, 1e-6)
    call("plot", "point", sheet, "--rate", 10, "--program", program, "--output", files / "fast.png")
    assert (files / "fast.png").read_bytes()[:4] == b"\x89PNG"
    titles = [point.picture([path], program, rate=10).axes[0].get_title() for path in (sheet, files / "steel.dat")]
    assert titles == ["Tension at 10 /s (-- at 45°, : at 90°)", "Tension (-- at 45°, : at 90°)"], titles


def test_pictures(program, files):
    """Check a picture of two files, and of finished runs."""
    picture = files / "both.png"
    sheets = files / "steel.dat", files / "round.dat:round"
    call("plot", "point", *sheets, "--program", program, "--output", picture)
    assert picture.read_bytes()[:4] == b"\x89PNG"
    figure = point.picture(sheets, program)
    tension, r_values, stresses, surface = figure.axes
    labels = [text.get_text() for text in figure.axes[-1].get_legend().get_texts()]
    assert labels == ["steel", "round"], labels
    assert (len(tension.lines), len(r_values.lines), len(stresses.lines)) == (6, 2, 2)
    assert len(surface.lines) == len(surface.collections) == 2
    close(max(r_values.lines[0].get_ydata()), H / F)
    assert all(abs(value - 1) < 1e-3 for value in r_values.lines[1].get_ydata())
    close(max(surface.lines[1].get_xdata()), 2 / math.sqrt(3))

    deck = files / "run.dat"
    deck.write_text(STEEL + point.point("pull", "steel", point.TENSION, [([0.1, 0, 0, 0, 0, 0], 10)]) + "\n")
    assert launch([program, "--quiet", deck]).code == 0
    run = files / "run.out"
    call("plot", "point", "--run", run, "--run", run / "history.csv", "--output", files / "run.svg")
    figure = point.picture([], program, runs=[run, run / "history.csv"])
    assert "<svg" in (files / "run.svg").read_text()
    assert [line.get_label() for line in figure.axes[0].lines] == ["run, pull"] * 2


def test_laws(program, tmp_path):
    """Check pictures of laws."""
    words = [sys.executable, UTILS / "dev" / "law_pictures.py"]
    done = launch([*words, "hill48", "swift", "prager", "--program", program, "--output", tmp_path / "made"])
    assert done.code == 0, done.errors
    for law in ("hill48", "swift", "prager"):
        with Image.open(tmp_path / "made" / f"{law}.png") as picture:
            counts = {colour: count for count, colour in picture.convert("RGB").getcolors()}
        assert len(counts) <= 64, law  # a small file
        first = max(counts, key=lambda colour: counts[colour] * (np.ptp(np.array(colour, int)) > 100))
        assert np.allclose(first, 255 * np.array(to_rgb("C0")), atol=8), (law, first)  # the law's curves
    done = launch([*words, "hill84"])
    assert done.code == 2 and "no law hill84; there are: von_mises" in done.errors


def test_messages(program, files):
    """Check the messages on bad input."""
    (files / "empty.dat").write_text("*TITLE\n  nothing\n")
    (files / "wrong.dat").write_text(STEEL.replace("hill48", "hil48"))
    (files / "binary.dat").write_bytes(b"\xff\xfe\x00*MATERIAL x")
    (files / "history.csv").write_text("increment,phase\n0,draw\n")
    (files / "cut.csv").write_text("increment,point,e11,s11\n0,p,0,0\n1,p,0.1\n")
    end = ("--program", program, "--output", files / "none.png")
    steel = files / "steel.dat"
    for arguments, said in (
            (("nowhere.dat", *end), "nowhere.dat: No such file"), ((files, *end), "Is a directory"),
            ((files / "empty.dat", *end), "empty.dat: no *MATERIAL"), ((files / "binary.dat", *end), "not a text"),
            ((f"{steel}:iron", *end), "no *MATERIAL iron; there are: steel"),
            ((files / "wrong.dat", *end), "did you mean 'hill48'"),
            ((steel, "--program", files / "no_program"), "no_program: no such program"),
            ((steel, "--program", program, "--output", files / "no" / "none.png"), "No such file"),
            ((steel, "--program", program, "--output", files / "none.xyz"), "none.xyz: Format 'xyz' is not supported"),
            (("--run", files / "no.out"), "no.out: No such file"),
            (("--run", files / "cut.csv"), "cut.csv: row 2 does not hold a number in each column"),
            (("--run", files), "history.csv: not the history of single points"), ((), "a file or a --run is needed")):
        assert said in call("plot", "point", *arguments, expect=2), said
    assert not (files / "none.png").exists()
    for option in ("--strain", "--rate"):
        assert "positive numbers" in call("plot", "point", steel, option, -1, expect=2)
