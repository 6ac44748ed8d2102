# SPDX-License-Identifier: GPL-3.0-or-later
"""Scatter: samples, statistics and surrogates against known values."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from helpers import call
from scipy import stats
from test_study import DECK

from dd3.errors import Problem
from dd3.scatter.sample import correlate, distribution, latin_hypercube
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
