# SPDX-License-Identifier: GPL-3.0-or-later
"""Press: the crank against its geometry, force and energy of made-up runs in closed form."""

import numpy as np
import pandas as pd
import pytest
from helpers import call

from dd3.press import Crank

CRANK = Crank(200.0, 1500.0)


def history(folder, force):
    """Write a run in which a punch moves down by 50 mm, against a force of its travel, N."""
    travel = np.linspace(0, 50, 501)
    columns = {"increment": range(501), "phase": "draw", "travel": travel, "punch_ux": 0, "punch_uy": 0,
               "punch_uz": -travel, "punch_fx": 0, "punch_fy": 0, "punch_fz": force(travel), "punch_contacts": 1}
    folder.mkdir()
    pd.DataFrame(columns).to_csv(folder / "history.csv", index=False)
    return folder


def test_crank() -> None:
    """The pin is on the circle, the rod has its length; the slope is that of differences; the angle is the inverse."""
    angle = np.linspace(0.01, 3.13, 40)
    height = CRANK.height(angle)
    # Bottom dead centre: pin at -radius, ram at -radius - rod; the ram is `height` above that.
    pin = np.stack([200 * np.sin(angle), -200 * np.cos(angle)])
    ram = np.stack([0 * angle, -1700 + height])
    assert np.allclose(np.linalg.norm(pin - ram, axis=0), 1500)
    assert CRANK.height(np.array([np.pi]))[0] == pytest.approx(400)
    assert np.allclose(CRANK.slope(angle), (CRANK.height(angle + 1e-6) - CRANK.height(angle - 1e-6)) / 2e-6, rtol=1e-6)
    assert np.allclose(CRANK.angle(height), angle, atol=1e-7)


def test_allowed_force() -> None:
    """The force is the given one up to the rated height, and that of a constant torque above it."""
    height = np.array([0.0, 3.0, 6.5, 50.0, 200.0])
    allowed = CRANK.allowed(height, 2500.0, 6.5)
    assert np.allclose(allowed[:3], 2500)
    torque = allowed[2:] * CRANK.slope(CRANK.angle(height[2:]))
    assert np.allclose(torque, torque[0]) and allowed[3] < 1000


def test_force_and_energy(tmp_path) -> None:
    """A force that grows linearly: the energy is the area below; images multiply both."""
    run = history(tmp_path / "run", lambda travel: 2000 * travel)
    words = ("press", run, "--mirror", "x", "--stroke", 400, "--rod", 1500, "--force", 300, "--rated", 6.5,
             "--energy", 6)
    said = call(*words, "--verdict")
    course = pd.read_csv(run / "press" / "press.csv")
    assert np.allclose(course["force"], 4 * (50 - course["height"]))
    assert course["energy"].iloc[-1] == pytest.approx(2 * 2.0 * 50**2 / 2 / 1000)
    assert np.allclose(CRANK.height(np.radians(course["angle"])), course["height"], atol=1e-6)
    assert "energy: 5 of 6 kJ" in said and (run / "press" / "press.png").is_file()
    call(*words[:-1], 4, "--verdict", expect=1)
    late = history(tmp_path / "late", lambda travel: 200000.0 * (travel > 20))
    said = call("press", late, *words[4:12], "--verdict", expect=1)
    allowed = CRANK.allowed(np.array([29.9]), 300, 6.5)[0]
    assert f"nearest to the force that the press allows: 200 of {allowed:.4g}" in said
    assert "no tool 'die'; there are: punch" in call("press", late, "--ram", "die", expect=2)
    assert "takes a RUN or --table" in call("press", expect=2)


def test_table() -> None:
    """The table has the path of the crank at equal parts of the time; the duration is that of its angle."""
    said = call("press", "--stroke", 400, "--rod", 1500, "--table", 60, "--points", 5, "--rate", 30).splitlines()
    time, path = np.array(said[2].partition("=")[2].split(), float).reshape(-1, 2).T
    start = CRANK.angle(np.array([60.0]))[0]
    assert np.allclose(time, [0, 0.25, 0.5, 0.75, 1]) and (path[0], path[-1]) == pytest.approx((0, 1), abs=1e-9)
    assert np.allclose(60 * (1 - path), CRANK.height(start * (1 - time)), atol=1e-3)
    assert float(said[1].partition("=")[2]) == pytest.approx(np.degrees(start) / 360 * 2, rel=1e-5)
