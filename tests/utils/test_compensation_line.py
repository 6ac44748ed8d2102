# SPDX-License-Identifier: GPL-3.0-or-later
"""Compensation through a line: a strip is bent at one end, then, turned, at the other one; each tool gets the deviation
of what it forms, turned back to its coordinates."""

import json
from pathlib import Path

import numpy as np
import pytest
from helpers import call
from strip_line import write_line

from dd3.alignment import STILL, Rigid
from dd3.compensate import Compensation, compensate
from dd3.errors import Problem
from dd3.line import carried, start_motion
from dd3.process import read_process
from dd3.tools.surface import read_patches


def tools_of(folder, motion=STILL):
    """Return the points of the corrected tools by their names, moved back."""
    return {path.name: np.vstack([motion.back(points.reshape(-1, 3)) for points, _ in read_patches(path)])
            for path in sorted((folder / "line.compensate" / "loop_1").glob("*.bez"))}


def test_carried():
    """Rigid motions of a plate that is turned beside a hinge are those of its nodes there; all are the same for one that
    is turned as a whole."""
    x, y = (part.ravel() for part in np.meshgrid(np.arange(-20, 1.0), np.arange(5.0), indexing="ij"))
    flat = np.column_stack((x, y, 0 * x))
    turn = np.radians(25)
    motion = Rigid(np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]),
                   np.array([1.0, -2, 3]))
    places = np.array([[4.0, 1, 0], [12, 3, 0]])
    found = carried(flat, flat, motion.of(flat), places, 3.0)
    assert np.allclose(found.of(places), motion.of(places)) and np.allclose(found.back(motion.of(places)), places)
    bent = np.where(flat[:, :1] < -12, motion.of(flat), flat)
    assert np.allclose(carried(flat, flat, bent, places, 3.0).of(places), places, atol=1e-9)


def test_start():
    """The motion of *START: rotations in their order, then the displacement."""
    entries = [{"key": "from", "value": "a.out", "at": {}}, {"key": "move", "value": [0, 0, 5], "at": {1: 1}},
               {"key": "turn", "value": [1, 0, 0, 0, 0, 1, 90], "at": {1: 1}},
               {"key": "turn", "value": [0, 0, 0, 0, 2, 0, 180], "at": {1: 1}}]
    motion = start_motion({"input": {"blocks": [{"keyword": "start", "entries": entries}]}})
    # (2, 0, 1) goes to (1, 1, 1), then to (-1, 1, -1).
    assert np.allclose(motion.of(np.array([[2.0, 0, 1]])), [[-1, 1, 4]])


def test_turned(tmp_path, program):
    """The tools of the first operation get the same correction, and the part has the same deviations, whether or not the
    second operation turns it."""
    found, tools = [], []
    for name, angle, move in (("level", 0.0, (0.0, 0, 0)), ("turned", 17.0, (3.0, 0, 2))):
        path = write_line(tmp_path / name, angle, move, 40, second=False)
        found.append(compensate(program, read_process(path), "tools", 1, 0.01, 1.0, [], None, 1, hold=True))
        tools.append(tools_of(tmp_path / name))
    assert np.allclose(found[0], found[1], rtol=1e-5) and found[0][1][0] < found[0][0][0] / 3
    assert list(tools[0]) == ["pad_1.bez", "post_1.bez", "steel_1.bez"]
    for name, points in tools[0].items():
        assert np.allclose(points, tools[1][name], atol=2e-6), name


def test_turned_tools(tmp_path, program):
    """The tools of the second operation, which turns the part over, are those of a line that does not, turned over."""
    over = Rigid(np.diag([-1.0, 1, -1]), np.array([3.0, 0, 2]))
    found, tools = [], []
    for name, angle, motion in (("level", 0.0, STILL), ("over", 180.0, over)):
        path = write_line(tmp_path / name, angle, motion.shift, 30)
        said = call("compensate", path, "--tools", "tools@op2", "--loops", "1", "--program", program, "--threads", "1")
        assert "op1: has ended before" in said  # its tools stay
        found.append(np.loadtxt(tmp_path / name / "line.compensate" / "deviations.csv", delimiter=",", skiprows=1))
        tools.append(tools_of(tmp_path / name, motion))
    assert np.allclose(found[0][0], found[1][0], rtol=1e-6) and np.allclose(found[0][1], found[1][1], rtol=0.01)
    assert found[0][1, 3] < found[0][0, 3] / 3  # of what it forms; that of the first operation remains
    # But for the triangles of the sheet, by which the closest points are found: 1 % of the correction, of 2 mm; the
    # shank of the steel is moved by the continuation of the smooth function.
    for name, points in tools[0].items():
        assert np.allclose(points, tools[1][name], atol=0.02), name
        assert np.sqrt(((points - tools[1][name])**2).mean()) < (5e-3 if name.startswith("steel") else 1e-3), name


@pytest.mark.slow
def test_two_bends(tmp_path, program):
    """Both operations are corrected, each for its own bend: the largest deviations fall to less than a twelfth in three
    loops, of the part and of what each operation forms."""
    path = write_line(tmp_path / "line", 17.0, (3.0, 0, 2), 60)
    found = compensate(program, read_process(path), ["tools@op1", "tools@op2"], 3, 0.01, 1.0, [], None, 1, hold=True)
    table = np.loadtxt(tmp_path / "line" / "line.compensate" / "deviations.csv", delimiter=",", skiprows=1)
    assert table[0, 3] > 1 and table[0, 5] > 1 and found[0][0] > 1
    assert (table[3, [1, 3, 5]] < table[0, [1, 3, 5]] / 12).all(), table
    for name in ("op1", "op2"):
        assert len(list((tmp_path / "line" / "line.compensate" / name).glob("*.step"))) == 3


def test_refused(tmp_path, program):
    """What cannot be corrected is refused with its cause."""
    path = write_line(tmp_path / "line", 17.0, (3.0, 0, 2), 30, second=False)
    words = ("compensate", path, "--program", program, "--threads", "1", "--tools")
    assert "no operation 'op3'; there are: op1, op2" in call(*words, "tools@op3", expect=2)
    assert "the input file of 'op2' does not have the parameter 'tools'" in call(*words, "tools@op2", expect=2)
    assert "--tools names the tools of 'op1' twice" in call(*words, "tools@op1", "tools", expect=2)
    said = call(*words, "tools", "--mirror", "x", "--hold", expect=2)
    assert "op1.dat: error: *START between 'op1' and the last operation moves the plane of symmetry x = 0" in said
    assert "axis of --half-turn" in call(*words, "tools", "--half-turn", "--hold", expect=2)
    deck = tmp_path / "line" / "op2.dat"
    deck.write_text("*PARAMETER\n  tools = none\n" + deck.read_text())
    assert "'op2' has no phase with tools" in call(*words, "tools@op2", expect=2)
    job = json.loads((tmp_path / "line" / "op2.out" / "run.json").read_text())
    assert job["sheet"]["kind"] == "start"


def test_same_tools(tmp_path, program):
    """Operations one after the other with the same tools are corrected together; both need the parameter."""
    path = write_line(tmp_path / "line", 0.0, (0.0, 0, 0), 30)
    deck = tmp_path / "line" / "op2.dat"
    text = deck.read_text()
    for name in ("post", "pad", "steel"):
        text = text.replace(f"{name}_2.bez", f"{name}_1.bez")
    text = text[:text.index("*PHASE clamp")] + text[text.index("*PHASE springback"):]
    deck.write_text(text)
    process = read_process(path)
    work = Compensation(program, process, ["tools"], 1.0, [], None, 1, False, None, True)
    (correction,) = work.corrections
    assert correction.name == "op2" and list(correction.parameters) == ["op1", "op2"]
    with pytest.raises(Problem, match="'op1' has the same tools as 'op2'"):
        Compensation(program, process, ["tools@op2"], 1.0, [], None, 1, False, None, True)
    assert Path(process.operations[0].folder).is_dir()


def test_not_formed(tmp_path, program):
    """Tools that form nothing, here those of an operation that only lays the sheet down, are refused."""
    path = write_line(tmp_path / "line", 0.0, (0.0, 0, 0), 30)
    deck = tmp_path / "line" / "op2.dat"
    text = deck.read_text()
    deck.write_text(text[:text.index("*PHASE clamp")] + text[text.index("*PHASE springback"):])
    said = call("compensate", path, "--program", program, "--threads", "1", "--tools", "tools@op2", expect=2)
    assert "no place of the part is formed by 'op2' as the last one" in said
