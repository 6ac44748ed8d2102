# SPDX-License-Identifier: GPL-3.0-or-later
"""Press: the crank against its geometry, force and energy of made-up runs in closed form."""

import json

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


def with_cam(folder, theta, force=300.0, across=0.0, aside=0.0, start=70.0):
    """Write a run in which a ram moves down by 50 mm from a position, after an increment in which it stands, and drives
    a cam along x by a face at an angle theta, rad, to its path; the sheet resists the ram with 1000 N, and the cam with
    a force that grows with its path, N for 1 mm; across presses it on its slide, aside along y."""
    travel = np.concatenate(([0.0], np.linspace(0, 50, 101)))
    path = np.tan(theta) * travel
    columns = {"phase": ["lay", *["bend"] * 101], "travel": travel}
    for name, u, f in (("ram", (0, 0, start - travel), (0, 0, 1000)), ("cam", (path, 0, 0), (-force * path, aside, -across)),
                       ("post", (0, 0, 0), (0, 0, 0))):
        columns |= {f"{name}_{kind}{axis}": value for kind, values in (("u", u), ("f", f))
                    for axis, value in zip("xyz", values)}
        columns[f"{name}_contacts"] = 1
    folder.mkdir()
    pd.DataFrame(columns).to_csv(folder / "history.csv", index=False)
    tools = [{"name": name, "motion": motion, "displacement": move} for name, motion, move in
             (("ram", "moved", [0, 0, -50]), ("cam", "moved", [path[-1], 0, 0]), ("post", "held", [0, 0, 0]))]
    (folder / "run.json").write_text(json.dumps({
        "format": "dd3imp run", "format_version": 2, "program": {"name": "dd3imp", "version": "1"}, "title": "",
        "phases": [{"name": "bend", "tools": tools}]}))
    return folder


def course_of(run, *words):
    """Return the course of a run with the options given."""
    call("press", run, *words)
    return pd.read_csv(run / "press" / "press.csv")


def test_cam(tmp_path) -> None:
    """The ram bears the force of its own tool and that of the cam by their paths, its energy is the work of both; the
    position of the ram in the input file, here above its place at the end, does not matter."""
    theta = np.radians(35)
    course = course_of(with_cam(tmp_path / "run", theta))
    cam = 300 * np.tan(theta) * (50 - course["height"])  # N
    assert np.allclose(course["force_ram"][1:], 1.0)
    assert np.allclose(course["force_cam"][2:], cam[2:] * np.tan(theta) / 1000) and course["force_cam"][0] == 0
    assert np.allclose(course["force"], course["force_ram"] + course["force_cam"])
    work = 1000 * 50 + 300 * (50 * np.tan(theta))**2 / 2
    assert course["energy"].iloc[-1] == pytest.approx(work / 1e6)
    alone = course_of(tmp_path / "run", "--cams")
    assert list(alone) == ["height", "force", "energy"] and alone["energy"].iloc[-1] == pytest.approx(0.05)
    assert "no tool 'die'" in call("press", tmp_path / "run", "--cams", "die", expect=2)


def test_friction_of_a_cam(tmp_path) -> None:
    """A wedge with the friction angle phi on its slide and on the face that drives it: P = F cos(phi) sin(theta + phi) /
    cos(theta + 2 phi); what presses the cam on its slide, from either side, adds its friction; it locks at 90 degrees."""
    theta, phi = np.radians(35), np.arctan(0.1)
    course = course_of(with_cam(tmp_path / "run", theta), "--cam-friction", "0.1")
    cam = 300 * np.tan(theta) * (50 - course["height"]) / 1000
    factor = np.cos(phi) * np.sin(theta + phi) / np.cos(theta + 2 * phi)
    assert factor > 1.3 * np.tan(theta) and np.allclose(course["force_cam"][2:], cam[2:] * factor)
    for name, across, aside in (("down", 400, 300), ("up", -20000, 0)):
        run = with_cam(tmp_path / name, theta, across=across, aside=aside)
        found = course_of(run, "--cam-friction", "0.1")["force_cam"]
        if across > 0:  # on the slide, which bears the face too
            expected = (cam + 0.1 * 0.7) * factor
        else:  # the slide holds it down: its normal force has the other sign
            expected = (cam + 0.1 * 20) * np.sin(theta + phi) / np.cos(theta) * np.cos(phi)
        assert np.allclose(found[2:], expected[2:]), name
    steep = with_cam(tmp_path / "steep", np.radians(80))
    assert "the slide of 'cam' locks" in call("press", steep, "--cam-friction", "0.1", expect=2)
    assert "--cam-friction is 0 or more" in call("press", steep, "--cam-friction", "-1", expect=2)


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


def test_withdrawn_ram(tmp_path) -> None:
    """A punch that is withdrawn by more than its stroke in another phase has its bottom dead centre before that."""
    run = history(tmp_path / "run", lambda travel: 400 * travel)
    table = pd.read_csv(run / "history.csv")
    way = np.linspace(0, 200, 21)[1:]
    back = pd.DataFrame({**table.iloc[-1], "increment": np.arange(501, 521), "phase": "springback", "punch_uz": way - 50,
                         "punch_fz": 0.0})
    pd.concat([table, back]).to_csv(run / "history.csv", index=False)
    (run / "run.json").write_text(json.dumps({
        "format": "dd3imp run", "format_version": 2, "program": {"name": "dd3imp", "version": "1"}, "title": "",
        "phases": [{"name": name, "tools": [{"name": "punch", "motion": motion, "displacement": [0, 0, -50]}]}
                   for name, motion in (("draw", "moved"), ("springback", "withdrawn"))]}))
    course = course_of(run)
    assert course["height"].iloc[0] == 50.0 and course["height"].iloc[-1] == 0.0
    assert course["force"].max() == pytest.approx(20.0) and course["energy"].iloc[-1] == pytest.approx(0.5)


def test_table() -> None:
    """The table has the path of the crank at equal parts of the time; the duration is that of its angle."""
    said = call("press", "--stroke", 400, "--rod", 1500, "--table", 60, "--points", 5, "--rate", 30).splitlines()
    time, path = np.array(said[2].partition("=")[2].split(), float).reshape(-1, 2).T
    start = CRANK.angle(np.array([60.0]))[0]
    assert np.allclose(time, [0, 0.25, 0.5, 0.75, 1]) and (path[0], path[-1]) == pytest.approx((0, 1), abs=1e-9)
    assert np.allclose(60 * (1 - path), CRANK.height(start * (1 - time)), atol=1e-3)
    assert float(said[1].partition("=")[2]) == pytest.approx(np.degrees(start) / 360 * 2, rel=1e-5)
