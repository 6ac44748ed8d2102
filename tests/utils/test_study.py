# SPDX-License-Identifier: GPL-3.0-or-later
"""Studies: parameters of an input file varied, their table and pictures, indices, and wrong input."""

import os
import csv
import importlib.util
import itertools
import math
import time
from pathlib import Path

import numpy as np
import pytest
from helpers import call

from dd3.study.response import Parameter, fit
from dd3.study.vary import indices

DECK = """*PARAMETER
  strain = 0.01
  hardening = linear Y0=200 H=1000
  stop = 1
*BLANK bar
  size = 4 2 1
  divisions = 2 1 1
  element = solid_shell
  material = m
*MATERIAL m
  young = 2e5
  poisson = 0.3
  yield = von_mises
  hardening = ${hardening}
*BOUNDARY left
  set = x_min
  fix = x
*SET corner
  near = 0 0 0
*BOUNDARY corner
  set = corner
  fix = y
*BOUNDARY bottom
  set = z_min
  fix = z
*HISTORY right
  set = x_max
  quantities = reaction
*PHASE pull
  control = load
  trial = 0.1
  displace = x_max x ${strain}
"""


def rows_of(folder):
    """Return the rows of the table of a study."""
    return list(csv.DictReader((folder / "results.csv").open()))


def test_study(program):
    """Check all combinations, their results, that finished runs are kept, and those older than the input file not."""
    deck = Path("bar.dat")
    deck.write_text(DECK)
    words = ("study", deck, "--program", program, "--cores", 2, "--vary", "strain=0.02:0.06:3",
             "hardening=linear Y0=200 H=1000,perfect Y0=300", "--result", "right_rx", "right_rx:max", "thinning:mean",
             "stress:11:max", "--indices")
    said = call(*words)
    rows = rows_of(Path("bar.study"))
    assert [row["strain"] for row in rows] == ["0.02", "0.02", "0.04", "0.04", "0.06", "0.06"]
    for row in rows:
        assert row["state"] == "reached" and int(row["increments"]) >= 10
        true = math.log(1 + float(row["strain"]) / 4)
        stress = 300.0 if "perfect" in row["hardening"] else 200 + 1000 * (true - 200 / 2e5) / (1 + 1000 / 2e5)
        assert abs(float(row["stress:11:max"]) / stress - 1) < 1e-3, row
        largest, last = float(row["right_rx:max"]), float(row["right_rx"])
        assert abs(largest / (2 * stress) - 1) < 0.02 and 0.98 < last / largest <= 1, row
    assert "right_rx: part of the variance, alone and with interactions" in said
    for name in ("right_rx", "right_rx_max", "thinning_mean", "stress_11_max"):
        assert Path("bar.study", f"{name}.png").read_bytes()[:4] == b"\x89PNG", name
    times = {path: path.stat().st_mtime_ns for path in Path("bar.study").glob("*/run.json")}
    assert len(times) == 6
    lost = next(iter(times)).parent
    for path in sorted(lost.iterdir()):
        path.unlink()
    call(*words)
    again = {path: path.stat().st_mtime_ns for path in Path("bar.study").glob("*/run.json")}
    assert again.keys() == times.keys()
    assert [path.parent for path in times if again[path] != times[path]] == [lost]
    time.sleep(0.01)
    deck.write_text(DECK.replace("size = 4 2 1", "size = 4 4 1"))
    call(*words)
    assert abs(float(rows_of(Path("bar.study"))[0]["right_rx"]) / float(rows[0]["right_rx"]) - 2) < 0.01


def test_files_of_runs(program):
    """Check that a run is made again where a file that its input names has changed, an included one or one of a law
    whose name has a blank."""
    Path("law").mkdir()
    law, rest = Path("law", "my curve.txt"), DECK[DECK.index("*MATERIAL"):DECK.index("*BOUNDARY")]
    law.write_text("0 200\n0.5 400\n")
    Path("law", "m.inc").write_text(rest.replace("${hardening}", 'table file="my curve.txt"'))
    Path("bar.dat").write_text(DECK.replace(rest, "*INCLUDE law/m.inc\n"))
    words = ("study", "bar.dat", "--program", program, "--vary", "strain=0.02", "--result", "right_rx")
    found = []
    for change in (lambda: None, lambda: law.write_text("0 400\n0.5 800\n"), lambda: None,
                   lambda: Path("law", "m.inc").write_text(rest.replace("${hardening}", "perfect Y0=100"))):
        change()
        time.sleep(0.01)
        call(*words)
        row = rows_of(Path("bar.study"))[0]
        found.append((float(row["right_rx"]), row["seconds"]))
    # In the same folder, another input file that is older than the run.
    Path("other.dat").write_text(DECK.replace("size = 4 2 1", "size = 4 4 1"))
    old = Path("bar.study").stat().st_mtime - 3600
    for file in (Path("other.dat"), Path("bar.dat"), Path("law", "m.inc"), law):
        os.utime(file, (old, old))
    for deck in ("bar.dat", "other.dat"):
        call("study", deck, *words[2:], "--work", "both")
        found.append((float(rows_of(Path("both"))[0]["right_rx"]), ""))
    forces = [force for force, _ in found]
    assert forces[5] != pytest.approx(forces[4], rel=0.1)
    assert forces[1] / forces[0] == pytest.approx(2, rel=0.01) and forces[3] < forces[0]
    assert found[2] == found[1]


def test_surface(program):
    """Check the response surface of a polynomial, exact where it has its terms, and of a study."""
    values = {"a": ["1", "2", "3"], "b": ["0", "4"], "c": ["x", "y"]}
    parameters = [Parameter(name, words, None if name == "c" else np.array(words, float))
                  for name, words in values.items()]
    cases = [dict(zip(values, row)) for row in itertools.product(*values.values())]

    def polynomial(case):
        a, b, y = float(case["a"]), float(case["b"]), case["c"] == "y"
        return 2 + 3 * a - a * a + 0.5 * a * b + y * (7 - b)

    surface = fit(parameters, cases, [polynomial(case) for case in cases])
    assert abs(surface.predicted - 1) < 1e-12 and abs(surface.explained - 1) < 1e-12
    assert abs(surface.at({"a": 1.5, "b": 1.0, "c": "y"}) - polynomial({"a": "1.5", "b": "1", "c": "y"})) < 1e-10
    cubic = fit(parameters[:1] + parameters[2:], cases, [float(case["b"])**3 for case in cases])
    assert cubic.explained < 1e-12 and cubic.predicted < 0
    Path("bar.dat").write_text(DECK)
    words = ("study", "bar.dat", "--program", program, "--vary", "strain=0.02:0.06:3", "stop=1:2:2", "--result",
             "right_rx", "--surface")
    said = call(*words)
    assert "right_rx: quadratic surface, explains 1.0000" in said and "strain from -1 at 0.02 to 1 at 0.06" in said
    assert Path("bar.study", "right_rx_surface.png").read_bytes()[:4] == b"\x89PNG"
    assert "takes more results than that" in call(*words[:5], "strain=0.02,0.04", *words[-3:], expect=2)


def test_snakemake(program):
    """Check a study by snakemake, where it is installed, and the step of its workflow."""
    Path("bar.dat").write_text(DECK)
    words = ("study", "bar.dat", "--program", program, "--vary", "strain=0.02,0.04", "--result", "right_rx", "--",
             "--nolock")
    if importlib.util.find_spec("snakemake") is None:
        assert "snakemake is missing" in call(*words, expect=2)
    else:
        assert "strain" in call(*words) and len(list(Path("bar.study").glob("*/ended"))) == 2
    assert "no such file; call the command in the folder of a study" in call("study", "combination", "x", expect=2)


def test_indices():
    """Check the indices of a sum and of a product: parts of the variance in closed form."""
    x, y = np.meshgrid([-1.0, 0.0, 1.0], [-2.0, 2.0], indexing="ij")
    total = 2 / 3 + 9 * 4
    assert np.allclose(indices(x + 3 * y), [(2 / 3 / total,) * 2, (36 / total,) * 2])
    assert np.allclose(indices(x * y), [(0, 1), (0, 1)])
    assert indices(np.ones((2, 2))) == [(0.0, 0.0), (0.0, 0.0)]


def test_wrong_studies(program):
    """Check the messages on requests that cannot be met."""
    Path("bar.dat").write_text(DECK)
    for words, said in ((("--vary", "strain"), "takes NAME=VALUE"), (("--vary", "strain=1:2:x"), "FIRST:LAST:NUMBER"),
                        (("--vary", "strain=1,1"), "takes NAME=VALUE"), (("--vary", "none=1,2"), "no parameter 'none'"),
                        (("--vary", "strain=0.01,0.02", "--result", "nothing"), "no result 'nothing'; there are"),
                        (("--vary", "strain=0.01,0.02", "strain=3"), "given twice")):
        assert said in call("study", "bar.dat", "--program", program, *words, expect=2), words
    assert "no such file" in call("study", "none.dat", "--program", program, "--vary", "a=1", expect=2)
    assert "no command 'rum'" in call("study", "rum", expect=2)
