# SPDX-License-Identifier: GPL-3.0-or-later
"""The verdict of a report: of made-up runs, and of a pan that is formed, not formed, and waved under its holder."""

import re
from pathlib import Path

from helpers import call

from dd3.programs import command, launch
from dd3.run import read_job
from dd3.verdict import BAD, DOUBTFUL, GOOD, OPEN, failed, judge, splits, sprung, summary

PAN = Path(__file__).resolve().parents[1] / "cases" / "pan"


def place(distance, tool="die"):
    """Return a place as in run.json."""
    return {"distance": distance, "tool": tool, "node": 7, "position": [1.0, 2.0, 3.0]}


def job_of(punch=None, holder=None, support=None, codes=()):
    """Return the description of a run of one phase."""
    closing = {"punches": [punch] if punch else [], "holders": [holder] if holder else [], "support": support}
    return {"outcome": {"state": "reached", "message": None},
            "phases": [{"name": "draw", "result": {"closing": closing}}],
            "warnings": [{"code": code, "phase": "draw"} for code in codes]}


def answers(job, waves=None):
    """Return the answers by the names of the items."""
    return {item.name: item.answer for item in judge(job, waves, [], [])}


def test_answers():
    """Check each question of the verdict with and without its limit."""
    punch = {"tool": "punch", "path_left": place(0.1), "off_tools": place(0.02), "off_walls": place(0.2),
             "wall_space": 0.5}
    holder = {"tool": "holder", "wave": place(0.3), "lift": place(0.4), "beyond": place(12.0)}
    assert answers(job_of(punch)) == {"run": GOOD, "formed to the tools": GOOD, "waves in walls": OPEN}
    assert answers(job_of(punch, codes=["W119"]))["formed to the tools"] == BAD
    assert answers(job_of({**punch, "path_left": None, "off_tools": None}))["formed to the tools"] == OPEN
    assert answers(job_of())["formed to the tools"] == OPEN
    assert [answers(job_of(punch), waves)["waves in walls"] for waves in (0.4, 0.39)] == [GOOD, DOUBTFUL]
    assert [answers(job_of(punch, holder), waves)["waves under 'holder'"] for waves in (None, 0.3, 0.29)] \
        == [OPEN, GOOD, BAD]
    assert "sheet beyond the holder" not in answers(job_of(punch, holder))
    assert answers(job_of(punch, holder, codes=["W120"]))["sheet beyond the holder"] == DOUBTFUL
    slid = {**punch, "slide": place(0.6)}
    assert [answers(job_of(slid, codes=codes))["slide"] for codes in ([], ["W124"])] == [GOOD, DOUBTFUL]
    support = {"name": "middle", "axis": "x", "reaction": 300.0, "tool": "punch", "tool_force": 2e4}
    assert "supports" not in answers(job_of(punch, support=support))
    assert answers(job_of(punch, support=support, codes=["W121"]))["supports"] == DOUBTFUL
    pin = {"name": "pin_1", "diameter": 6.0, "force": 900.0, "thickness": 1.0, "bearing_pressure": 150.0}
    for stress, answer in ((160.0, GOOD), (140.0, DOUBTFUL)):
        job = job_of(punch)
        job["phases"][0]["result"]["closing"]["pins"] = [{**pin, "yield_stress": stress}]
        assert answers(job)["pins"] == answer
    assert [splits(critical, ["", ""], False)[0].answer for critical in (None, 0, 3)] == [OPEN, GOOD, BAD]
    assert [splits(0, ["", ""], thinned)[1].answer for thinned in (False, True)] == [GOOD, BAD]
    assert [sprung(0.5, tolerance)[0].answer for tolerance in (None, 0.5, 0.4)] == [OPEN, GOOD, BAD]
    assert sprung(None, None) == [] and sprung(None, 0.4)[0].answer == OPEN


def test_summary():
    """Check the line that says what is not good, and what is not known."""
    stopped = {**job_of(), "outcome": {"state": "stopped", "message": "no convergence"}}
    items = judge(stopped, None, splits(2, ["2 nodes", "none"], False), [])
    assert failed(items) and summary(items) == "not good: run, forming limit; not judged: formed to the tools"
    items = judge(job_of(), None, [], [])
    assert not failed(items) and summary(items) == "nothing found against the part; not judged: formed to the tools"


def test_other_runs():
    """Check runs of earlier versions, which do not tell, and those that go on from a restart."""
    old = {**job_of(), "phases": [{"name": "draw", "result": {}}]}
    item = judge(old, None, [], [])[1]
    assert item.answer == OPEN and "version 2.7.0" in item.text
    punch = {"tool": "punch", "path_left": place(0.1), "off_tools": place(0.02), "off_walls": None, "wall_space": 0.0}
    continued = {**old, "continued": {"earlier": job_of(punch, codes=["W119"])}}
    assert answers(continued)["formed to the tools"] == BAD


def test_continued():
    """Check the limits of materials by warnings before a restart, and phases that a restart makes again."""
    for code, question in (("W126", "fracture"), ("W127", "forming limit of bent paths")):
        warning = {"code": code, "text": "reached", "phase": "draw", "increment": 5}
        for increment, answer in ((5, BAD), (4, None)):  # given up by a restart before it
            job = {**job_of(), "continued": {"increment": increment, "earlier": {**job_of(), "warnings": [warning]}}}
            assert answers(job).get(question) == answer
    punch = {"tool": "punch", "path_left": place(0.1), "off_tools": place(0.02), "off_walls": None, "wall_space": 0.0}
    earlier = job_of(punch, codes=["W119"])
    earlier["phases"][0]["result"]["last_increment"] = earlier["warnings"][0]["increment"] = 9
    for increment, later, expected in ((9, {**job_of(), "phases": []}, [BAD]), (9, job_of(punch), [BAD]),
                                       (8, job_of(punch), [GOOD])):
        items = judge({**later, "continued": {"increment": increment, "earlier": earlier}}, None, [], [])
        assert [item.answer for item in items if item.name == "formed to the tools"] == expected
    assert [sprung(None, None, "half")[0].text, sprung(None, 0.4, "half")[0].answer] == ["half", OPEN]


def report(program, folder, name, deck, *options):
    """Run a variant of the pan; return the closing of its draw and what its report prints."""
    path = folder / f"{name}.dat"
    path.write_text(re.sub(r"= (\w+\.bez)", rf'= "{PAN}/\1"', deck))
    done = launch(command(program, path, folder / f"{name}.out", ["--quiet"], {}))
    assert done.code == 0, done.errors
    *options, code = options
    said = call("report", folder / f"{name}.out", "--verdict", *options, expect=code)
    draw = read_job(folder / f"{name}.out")["phases"][1]["result"]["closing"]
    return draw["punches"][0], draw["holders"][0], said


def test_pan(program, tmp_path):
    """Check the verdicts of a pan by distances that are known from its tools."""
    deck = (PAN / "case.dat").read_text()
    punch, holder, said = report(program, tmp_path, "formed", deck, 0)
    assert abs(punch["path_left"]["distance"] - 0.1) < 1e-6 and punch["off_tools"]["distance"] < 0.05
    assert abs(punch["wall_space"] - 0.1) < 0.02 and punch["off_walls"]["distance"] <= punch["wall_space"] / 2
    assert holder["wave"]["distance"] < 0.02
    assert "formed to the tools: good: within 0.0" in said and "verdict: nothing found against the part" in said
    page = (tmp_path / "formed.out" / "report" / "report.html").read_text()
    assert page.index("<h2>Verdict</h2>") < page.index("<h2>Result</h2>")

    punch, _, said = report(program, tmp_path, "short", deck.replace("depth = 9.9", "depth = 7.9"), 1)
    assert abs(punch["path_left"]["distance"] - 2.1) < 1e-6 and punch["path_left"]["tool"] == "die"
    assert punch["path_left"]["position"][0] < 20  # on the floor
    assert "verdict: not good: formed to the tools" in said

    deck = deck.replace("press = holder 0 0 -100", "gap = holder die 1.3")
    _, holder, said = report(program, tmp_path, "waved", deck, "--waves", "0.05", 1)
    assert 0.27 < holder["lift"]["distance"] <= 0.3  # the rim lies on the holder
    assert 0.05 < holder["wave"]["distance"] < 0.3
    assert "waves under 'holder': not good" in said and "formed to the tools: good" in said
