# SPDX-License-Identifier: GPL-3.0-or-later
"""Scatter: samples, statistics and surrogates against known values."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from helpers import ROOT, UTILS, call, write_run
from scipy import stats
from test_deviation import HISTORY, PHASES, plate
from test_study import DECK

from dd3.errors import Problem
from dd3.scatter.results import along, at_point, field_map
from dd3.scatter.sample import coil_rows, correlate, distribution, latin_hypercube
from dd3.scatter.statistics import bands, failure
from dd3.scatter.surrogate import fit

INPUTS = [distribution("normal", mean=300, deviation=15), distribution("lognormal", mean=0.2, deviation=0.02), distribution("uniform", low=0, high=1),
          distribution("truncated", mean=0.8, deviation=0.02, low=0.77, high=0.83)]


def test_sample_has_means_deviations_and_strata() -> None:
    sample = latin_hypercube(INPUTS, 100, seed=1)
    for column, one in zip(sample.T, INPUTS):
        assert column.mean() == pytest.approx(one.mean(), abs=0.02 * one.std())
        assert column.std(ddof=1) == pytest.approx(one.std(), rel=0.03)
        assert sorted((one.cdf(column) * 100).astype(int)) == list(range(100))
    assert INPUTS[1].mean() == pytest.approx(0.2) and INPUTS[1].std() == pytest.approx(0.02)


def test_sample_has_rank_correlations() -> None:
    wanted = np.array([[1, -0.7, 0, 0], [-0.7, 1, 0, 0], [0, 0, 1, 0.4], [0, 0, 0.4, 1]])
    sample = latin_hypercube(INPUTS, 100, wanted, seed=2)
    assert np.abs(stats.spearmanr(sample).statistic - wanted).max() < 0.06
    assert np.allclose(latin_hypercube(INPUTS, 100, wanted, seed=2), sample)


def test_deviation_of_a_sum_of_independent_inputs() -> None:
    """Six inputs of 30 values: the deviation of their sum scatters by 0.04 of its value, and by 0.15 if the chance
    correlations of the inputs, of about 1/sqrt(30), are left."""
    inputs = [distribution("normal", mean=0, deviation=1)] * 6
    found = np.array([latin_hypercube(inputs, 30, seed=seed).sum(axis=1).std(ddof=1) for seed in range(20)]) / np.sqrt(6)
    assert found.mean() == pytest.approx(1, abs=0.03)
    assert found.std() < 0.06


def test_contradicting_correlations_and_wrong_distributions_are_refused() -> None:
    with pytest.raises(Problem, match="contradict"):
        correlate(np.random.default_rng(0).random((20, 3)), np.array([[1, .9, -.9], [.9, 1, .9], [-.9, .9, 1]]))
    with pytest.raises(Problem, match="low < high"):
        distribution("uniform", low=1, high=0)
    with pytest.raises(Problem, match="no distribution"):
        distribution("gauss")
    for values in ({"mean": 1}, {"mean": 1, "deviation": 2, "high": 3}, {"mean": 1, "deviation": float("inf")}):
        with pytest.raises(Problem, match="normal: expected finite mean, deviation, not "):
            distribution("normal", **values)


def test_bands_of_a_linear_response() -> None:
    place = np.linspace(1, 2, 5)
    found = bands(latin_hypercube([distribution("normal", mean=0, deviation=1)], 100) * place)
    assert found.mean == pytest.approx(0, abs=0.02)
    assert found.deviation == pytest.approx(place, rel=0.03)
    assert found.quantiles[2] == pytest.approx(stats.norm.ppf(0.95) * place, rel=0.03)


def test_failure_with_its_interval() -> None:
    none = failure(np.zeros(30, bool))
    assert (none.part, none.low) == (0, 0) and none.high == pytest.approx(1 - 0.025**(1 / 30))  # closed form
    some = failure(latin_hypercube([distribution("normal", mean=0, deviation=1)], 100)[:, 0] > stats.norm.ppf(0.9))
    assert some.failed == 10 and some.low < 0.1 < some.high


def test_indices_of_ishigami() -> None:
    inputs = [distribution("uniform", low=-np.pi, high=np.pi)] * 3
    x, y, z = (sample := latin_hypercube(inputs, 600)).T
    found = fit(sample, inputs, np.sin(x) + 7 * np.sin(y)**2 + 0.1 * z**4 * np.sin(x), largest=9)
    first, total = found.indices()
    assert found.q2 > 0.99
    assert first == pytest.approx([0.3139, 0.4424, 0], abs=0.01)
    assert total == pytest.approx([0.5576, 0.4424, 0.2437], abs=0.01)


def test_indices_of_a_quadratic_of_normal_inputs() -> None:
    inputs = [distribution("normal", mean=5, deviation=2), distribution("normal", mean=0, deviation=1)]
    a, b = (sample := latin_hypercube(inputs, 30)).T
    first, total = fit(sample, inputs, (a - 5) / 2 + 2 * b + (a - 5) / 2 * b).indices()  # variances 1, 4 and 1
    assert first == pytest.approx([1 / 6, 4 / 6]) and total == pytest.approx([2 / 6, 5 / 6])


def test_indices_of_noise_are_refused() -> None:
    inputs = [distribution("normal", mean=0, deviation=1)] * 3
    found = fit(latin_hypercube(inputs, 40), inputs, np.random.default_rng(3).normal(size=40))
    assert found.q2 < 0.5
    with pytest.raises(Problem, match="no indices"):
        found.indices()


def test_command_continues_with_the_same_table(program) -> None:
    """Runs of a bar: mean of a stress in closed form, a lost run made again."""
    Path("bar.dat").write_text(DECK)
    Path("bar.toml").write_text('deck = "bar.dat"\nruns = 6\nresults = ["stress:11:max"]\n[inputs.strain]\n'
                                'kind = "uniform"\nlow = 0.005\nhigh = 0.015\n')
    said = call("scatter", "bar.toml", "--program", program, "--cores", 2)
    assert "mean 201.4" in said or "mean 201.5" in said  # 201.49 at the strain of 0.01
    table = [row.split(",")[:3] for row in Path("bar.scatter/results.csv").read_text().splitlines()]
    shutil.rmtree(next(Path("bar.scatter").glob("strain=*")))
    assert call("scatter", "bar.toml", "--program", program, "--cores", 2) == said
    assert [row.split(",")[:3] for row in Path("bar.scatter/results.csv").read_text().splitlines()] == table


def bar(deck: str = DECK, **more: str) -> None:
    """Write the bar of 4 mm and its scatter: uniform extensions, mm, further keys before the tables."""
    Path("bar.dat").write_text(deck)
    lines = [f"{key} = {value}" for key, value in {"deck": '"bar.dat"', "runs": "6", **more}.items()]
    Path("bar.toml").write_text("\n".join(lines) + '\n[inputs.strain]\nkind = "uniform"\nlow = 0.1\nhigh = 0.2\n')


def test_results_by_place_and_forming_limit(program) -> None:
    """The displacement of a bar is proportional to x; it splits above the strain of a level forming limit curve."""
    bar(DECK.replace("  young", "  forming_limit = -0.1 0.035 0.02 0.035\n  young"),
        results='["displacement:x@end", "forming_limit"]', bands='["displacement:x along y=1"]',
        places="{ end = [4, 1] }")
    said = call("scatter", "bar.toml", "--program", program, "--cores", 2)
    table = pd.read_csv("bar.scatter/results.csv")
    assert np.allclose(table["displacement:x@end"], table["strain"], rtol=1e-6)
    ratio = np.log1p(table["strain"] / 4) / 0.035
    assert np.allclose(table["forming_limit"], ratio, rtol=1e-3)
    assert f"above 1: {(ratio > 1).sum()} of 6 runs" in said and 0 < (ratio > 1).sum() < 6
    band = pd.read_csv("bar.scatter/bands.csv")
    assert np.allclose(band["mean"], band["length"] / 4 * table["strain"].mean(), atol=1e-7)
    assert np.allclose(band["deviation"], band["length"] / 4 * table["strain"].std(), atol=1e-7)
    assert Path("bar.scatter/bands.png").is_file()


def test_springback_by_place(tmp_path) -> None:
    """The best fit of a parabola c X^2 leaves c (X^2 - mean of X^2) of a plate of 40 mm, X from its middle; the mean of
    its nodes is larger by a sixth of their squared distance of 1 mm."""
    c = 1e-4
    flat, cells = plate()
    free, _ = plate(lambda x, y: c * (x - 20)**2)
    run = write_run(tmp_path / "run", flat, free, cells, HISTORY, "phase\n", {"displacement": (0 * flat, free - flat)},
                    phases=PHASES)
    found = field_map(run, "springback", [])
    expected = [c * abs((x - 20)**2 - 400 / 3) for x in (0, 10, 20)]
    assert np.allclose([at_point(found, [x, 5]) for x in (0, 10, 20)], expected, atol=0.2 * c)
    lengths, values = along(found, "y=4.5")
    assert np.allclose(values, c * np.abs((lengths - 20)**2 - 400 / 3), atol=0.5 * c)


def test_coils_are_drawn_as_they_are(program) -> None:
    """Each row of a table is run once without other inputs, and as often as the others with them; a coil that the
    program refuses is told and left out."""
    coils = "hardening,strain\nlinear Y0=200 H=1000,0.01\nlinear Y0=220 H=1000,0.01\nlinear Y0=-1 H=1000,0.01\n"
    Path("coils.csv").write_text(coils)
    bar(coils='"coils.csv"', results='["stress:11:max"]')
    assert "'strain' is an input and a column" in call("scatter", "bar.toml", "--program", program, expect=2)
    Path("bar.toml").write_text('deck = "bar.dat"\ncoils = "coils.csv"\nresults = ["stress:11:max"]\n')
    said = call("scatter", "bar.toml", "--program", program, expect=2)
    assert "1 of 3 runs did not reach their end" in said and "refused: " in said and "Y0" in said
    table = pd.read_csv("bar.scatter/results.csv")
    assert sorted(table["state"]) == ["reached", "reached", "refused"]
    assert np.ptp(table["stress:11:max"].dropna()) == pytest.approx(20, rel=0.01)
    assert sorted(coil_rows(3, 6, 0, alone=False)) == [0, 0, 1, 1, 2, 2]
    assert sorted(coil_rows(3, 3, 0, alone=True)) == [0, 1, 2]


def test_stopped_scatter_is_resumed(program) -> None:
    """A scatter that is killed at its fourth run keeps the runs that have ended and makes the table of one that was
    not."""
    bar(results='["stress:11:max"]')
    whole = call("scatter", "bar.toml", "--program", program, "--cores", 1, "--work", "whole")
    Path("killer").write_text(f"""#!/bin/sh
echo run >>runs
[ "$(wc -l <runs)" -lt 4 ] || {{ kill -9 $PPID; exit 1; }}
exec {program} "$@"
""")
    Path("killer").chmod(0o755)
    words = [sys.executable, "-m", "dd3", "scatter", "bar.toml", "--cores", "1", "--work", "cut", "--program",
             "./killer"]
    assert subprocess.run(words, capture_output=True, env={**os.environ, "PYTHONPATH": str(UTILS)}).returncode == -9
    ended = {path: path.stat().st_mtime_ns for path in Path("cut").glob("*/run.json")}
    assert len(ended) >= 3
    assert call("scatter", "bar.toml", "--program", program, "--cores", 1, "--work", "cut") == whole
    kept = [path for path, time in ended.items() if path.stat().st_mtime_ns == time]
    assert len(kept) >= 3
    tables = [pd.read_csv(f"{work}/results.csv").drop(columns="seconds") for work in ("whole", "cut")]
    assert tables[0].equals(tables[1])


def test_wrong_descriptions_are_refused(program) -> None:
    """Places beside the blank, unknown ones, bands that name no section."""
    for more, message in (({"results": '["thinning@a"]'}, "no place 'a'"),
                          ({"results": '["thinning@a"]', "places": "{ a = [9, 0] }"}, "lies beside the blank"),
                          ({"results": '["thinning@a"]', "places": "{ a = 9 }"}, "expected x and y"),
                          ({"results": "[]", "bands": '["thinning"]'}, "'thinning' is no band"),
                          ({"results": '["springback@a"]', "places": "{ a = [1, 1] }"}, "no springback"),
                          ({"results": '["forming_limit"]'}, "no forming limit curve"),
                          ({"seed": '"x"'}, "seed is a str; expected a int"),
                          ({"set": "[1]"}, "expected a dict"), ({"results": '"right_rx"'}, "expected a list"),
                          ({"correlations": '[["a"]]'}, "expected rows of numbers"),
                          ({"limits": "{ right_rx = '5' }"}, "the limit of 'right_rx' is '5'; expected a number"),
                          ({"set": "{ strain = 9 }"}, "'strain' is an input and in set")):
        more = {"results": '["right_rx"]', **more}
        bar(**more)
        assert message in call("scatter", "bar.toml", "--program", program, "--cores", 2, expect=2)


def released(stress: np.ndarray, thickness: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Return the rise of the end of the upper face of a strip of 50 mm, bent in plane strain to an arc and
    released: perfect plasticity, elementary theory of bending."""
    young, stress, curvature = 2.1e5 / (1 - 0.3**2), 2 / np.sqrt(3) * stress, np.radians(angle) / 50
    moment = stress * (thickness**2 / 4 - (stress / (young * curvature))**2 / 3)
    free = curvature - 12 * moment / (young * thickness**3)
    return (1 - np.cos(50 * free)) * (1 / free - thickness / 2)


def test_example_against_the_theory_of_bending(program, tmp_path) -> None:
    """Each coil of the example has the springback of elementary theory, and the band ends at their mean."""
    folder = shutil.copytree(ROOT / "input_files/strip", tmp_path / "strip")
    path = folder / "scatter.toml"
    path.write_text(path.read_text().replace("runs = 20", "runs = 10"))
    said = call("scatter", path, "--program", program, "--cores", 2)
    table = pd.read_csv(folder / "scatter.scatter/results.csv")
    expected = released(*(table[name] for name in ("yield", "thickness", "angle")))
    assert len(set(table["yield"])) == 10 and np.allclose(table["displacement:z@end"], expected, rtol=1e-3)
    assert table["displacement:z@end"].std() == pytest.approx(expected.std(), rel=0.03)
    band = pd.read_csv(folder / "scatter.scatter/bands.csv")
    assert band["mean"].iloc[-1] == pytest.approx(expected.mean(), rel=5e-4)
    assert "no indices: those of Sobol take independent inputs" in said
