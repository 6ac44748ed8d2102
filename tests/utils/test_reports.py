# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections, forming limits and reports of a made-up run of a U profile, and wrong input."""

import csv
import json
import logging
import math
import re
from pathlib import Path
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from helpers import call, write_run

from dd3.errors import Problem
from dd3.forming_limit_curve import ZONES, Curve, keeler_brazier, read_curve
from dd3.report.course import action
from dd3.report.page import Report, section_planes
from dd3.run import Run, effort_of, read_job
from dd3.scatter.results import field_map, profiles
from dd3.sheet import Sheet, plane_name
from dd3.springback import best_fit, find, opening, rotation, steps_with_tools, symmetry, twist, unfinished
from dd3.surface_strain import cell_strains

# Parts of the profile: length along it and turn. The wall is an arc of radius 100 mm.
PARTS = [(20.0, 0.0), (5 * math.radians(80), math.radians(80)), (40.0, 0.4), (5 * math.radians(75), -math.radians(75)),
         (20.0, 0.0)]
ENDS = np.concatenate(([0.0], np.cumsum([part[0] for part in PARTS])))
HISTORY = """# units: -,-,mm,-,mm,mm,mm,N,N,N,-,mm2,MPa,mJ,mJ,mJ,mJ,N,mm
increment,phase,travel,progress,punch_ux,punch_uy,punch_uz,punch_fx,punch_fy,punch_fz,punch_contacts,punch_area,\
punch_pressure,tool_work,external_work,friction_work,energy_error,rib_restraint,rib_length
0,draw,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0
1,draw,2,1,0,0,-2,0,0,2500,4,10,250,5000,0,100,5,300,10
"""
STATUS = "phase,travel,outcome,iterations,solver_iterations,limiter\ndraw,2,accepted,5,0,rotation\n"
MATERIALS = [{"name": "steel", "hardening": {"name": "swift", "parameters": [{"name": "n", "value": 0.2}]}}]
BLOCKS = [{"keyword": "material", "name": "steel", "entries": [
    {"key": "young", "text": "2.1e5", "unit": "MPa", "default": False},
    {"key": "grade", "text": "low_carbon_steel", "unit": "", "default": False}]}]
PUNCH = {"name": "punch", "motion": "moved", "active": True, "displacement": [0, 0, -2], "turn": None, "gap": None,
         "force": None}
DRAW = {"number": 1, "name": "draw", "control": "punch", "tools": [PUNCH]}
RELEASED = {"number": 2, "name": "free", "control": None, "tools": [{**PUNCH, "active": False}]}
ROLL = {**PUNCH, "motion": "pressed", "displacement": None, "force": [0, 0, -100], "gap": None,
        "turn": {"point": [0, 0, 0], "axis": [0, 1, 0], "angle": 90}}


def profile(count=10):
    """Return the lengths along the profile, and position and direction there."""
    length, points, angles = [0.0], [np.zeros(2)], [0.0]
    for part, turn in PARTS:
        for _ in range(count):
            step, half = part / count, turn / count / 2
            chord = step * (math.sin(half) / half if half else 1.0)
            angle = angles[-1] + half
            points.append(points[-1] + chord * np.array([math.cos(angle), math.sin(angle)]))
            angles.append(angle + half)
            length.append(length[-1] + step)
    return np.array(length), np.array(points), np.array(angles)


@pytest.fixture
def run(tmp_path):
    """Write the results of a flat strip that became the profile at its upper face."""
    return profile_run(tmp_path / "job.out")


def profile_run(folder, turn=np.eye(3)):
    """Write the results of the strip, turned."""
    length, points, angles = profile()
    n, widths = len(length), (0.0, 5.0, 10.0)
    normal = np.column_stack([-np.sin(angles), np.cos(angles)])
    start, now = [], []
    for y in widths:
        for z in (0.0, 1.0):
            start.append(np.column_stack([length, np.full(n, y), np.full(n, z)]))
            place = points - (1 - z) * normal
            now.append(np.column_stack([place[:, 0], np.full(n, y), place[:, 1]]))
    start, now = np.concatenate(start), np.concatenate(now)
    cells = [[2 * j * n + i + a for a in (0, 1, 2 * n + 1, 2 * n, n, n + 1, 3 * n + 1, 3 * n)]
             for j in range(2) for i in range(n - 1)]
    one, x = np.ones(len(start)), start[:, 0]
    fields = {name: (first * one, last * one) for name, (first, last) in {
        "thickness": (1, 1 - x / 1000), "thinning": (0, x / 1000), "draw_in": (0, 0.5),
        "equivalent_plastic_strain": (0, 0.1), "major_strain_middle": (0, x / 200), "minor_strain_middle": (0, -0.02),
    }.items()}
    warnings = [{"code": "W109", "text": "the mesh is coarse", "at": {"file": "job.dat", "line": 3}, "phase": "draw"}]
    return write_run(folder, start @ turn.T, now @ turn.T, cells, HISTORY, STATUS, fields,
                     title="A profile & its <report>", materials=MATERIALS, input={"blocks": BLOCKS}, phases=[DRAW], warnings=warnings)


def test_section(run, tmp_path):
    """Check table, lines of nodes, and angles and radius of the profile."""
    words = [word for name, part in (("bottom", 0), ("wall", 2), ("flange", 4))
             for word in (f"--{name}", ENDS[part], ENDS[part + 1])]
    for plane in ("y=0", "y=2.5"):
        said = call("section", run, "--plane", plane, *words, "--table", tmp_path / "s.csv",
                    "--output", tmp_path / "s.png")
        for name, value in (("angle between bottom and wall", 100), ("angle between wall and flange", 105),
                            ("radius of the wall", 100)):
            found = float(re.search(f"{name}: ([0-9.]+)", said)[1])
            assert abs(found - value) < 0.05, f"{plane}: {name} {found}, expected {value}"
        rows = list(csv.DictReader((tmp_path / "s.csv").open()))
        assert abs(float(rows[-1]["length0"]) - ENDS[-1]) < 1e-3 and len(rows) == 51
        for row in rows:
            assert abs(float(row["thickness"]) - 1 + float(row["x0"]) / 1000) < 1e-6, row
    call("section", run, "--nodes", 1, 2, 3, "--table", tmp_path / "s.csv", "--output", tmp_path / "s.svg")
    assert len((tmp_path / "s.csv").read_text().splitlines()) == 4
    for words, said in ((("--plane", "y=50"), "the plane y=50 does not cut the sheet"), (("--plane", "q=1"), "plane 'q=1'"),
                        (("--nodes", 1, 9999), "the nodes are 1 to"), (("--field", "nosuch"), "no field 'nosuch'"),
                        (("--wall", 0, 1), "expected 3 or more"), (("--flange", 0, 1), "need --wall")):
        assert said in call("section", run, *words, "--output", tmp_path / "s.png", expect=2), words


def test_plane_of_nodes(tmp_path):
    """Check that a line of nodes is seen in its own plane, whatever its direction, and what lies in none."""
    turn = np.array([[0.6, -0.8, 0], [0.8, 0.6, 0], [0, 0, 1]])
    folder = profile_run(tmp_path / "turned.out", turn @ np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]))
    nodes = range(52, 103)  # of the upper face at one border
    words = [word for name, part in (("bottom", 0), ("wall", 2), ("flange", 4))
             for word in (f"--{name}", ENDS[part], ENDS[part + 1])]
    said = call("section", folder, "--nodes", *nodes, *words, "--output", tmp_path / "s.png")
    for name, value in (("angle between bottom and wall", 100), ("angle between wall and flange", 105),
                        ("radius of the wall", 100)):
        assert float(re.search(f"{name}: ([0-9.]+)", said)[1]) == pytest.approx(value, abs=0.05), said
    across = [node + 102 * (place % 2) for place, node in enumerate(nodes)]
    said = call("section", folder, "--nodes", *across, "--output", tmp_path / "s.png", expect=2)
    assert "lies in no plane" in said and "expected --plane" in said
    call("section", folder, "--nodes", *across, "--plane", "x=0", "--output", tmp_path / "s.png")


def plate_with_hole(folder, hole=(7, 8)):
    """Write the results of a plate of 12 x 3 x 1 mm with a hole from x = 7 to 9 mm, or other elements, raised by x^2 / 20
    and released."""
    x, y, z = np.meshgrid(np.arange(13.0), np.arange(4.0), [0.0, 1.0], indexing="ij")
    start = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    number = np.arange(len(start)).reshape(13, 4, 2)
    cells = [[number[i + a, j + b, k] for k in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
             for i in range(12) for j in range(3) if j != 1 or i not in hole]
    history = HISTORY.replace("1,draw,2,1", "1,free,0,1")
    one = np.ones(len(start))
    fields = {"thickness": (one, 1 - start[:, 0] / 100), **{name: (0 * one, 0 * one) for name in (
        "thinning", "draw_in", "equivalent_plastic_strain", "major_strain_middle", "minor_strain_middle")}}
    return write_run(folder, start, start + np.outer(start[:, 0]**2 / 20, [0, 0, 1]), cells, history, STATUS, fields,
                     phases=[DRAW, RELEASED])


def test_pieces(tmp_path, caplog):
    """Check tables and page where a plane cuts a sheet with a hole in two pieces, of which one is used or all are."""
    folder = plate_with_hole(tmp_path / "plate.out")
    said = call("section", folder, "--plane", "y=1.5", "--wall", 1, 6, "--table", tmp_path / "s.csv",
                "--output", tmp_path / "s.png")
    assert said.count("the section is in 2 pieces; the longest, 7 mm, is used") == 1, said
    rows = list(csv.DictReader((tmp_path / "s.csv").open()))
    assert [row["piece"] for row in rows] == 8 * ["1"] + 4 * ["2"]
    assert sorted(float(row["x0"]) for row in rows) == [x for x in range(13) if x != 8]
    assert {row["length0"] for row in rows if row["x0"] in ("0", "9", "7", "12")} == {"0", "3", "7"}
    found = Run(folder).sections("y=1.5")
    assert list(found["piece"]) == 8 * [1] + 4 * [2] and np.allclose(found["thickness"], 1 - found["x0"] / 100)
    assert "piece" not in Run(folder).sections("y=0.5")
    call("section", folder, "--plane", "y=0.5", "--wall", 1, 6, "--output", tmp_path / "s.png")
    assert "longest" not in call("section", folder, "--plane", "y=1.5", "--output", tmp_path / "s.png")
    table = tmp_path / "shape.csv"
    x = np.array([0, 3, 7, 9, 10, 12])
    table.write_text("section,along [mm],z [mm]\n" + "".join(f"y=1.5,{at},{1 + at**2 / 20}\n" for at in x))
    lengths = tmp_path / "lengths.csv"
    lengths.write_text("section,length0 [mm],thickness [mm]\ny=1.5,2,0.98\n")
    page = call("report", folder, "--section", "y=1.5", "--measured", table, "--measured", lengths,
                "--output", tmp_path / "report").strip().splitlines()[-1]
    text = Path(page).read_text(encoding="utf-8")
    rows = dict(re.findall("<tr><th>(.*?)</th><td>(.*?)</td></tr>", text))
    assert float(re.search(r"difference \+([0-9.e-]+)", rows["z, section y=1.5 (shape.csv)"])[1]) < 1e-6, rows
    used = "2 pieces; the longest, 7 mm, is used"
    assert rows["thickness, section y=1.5 (lengths.csv)"].endswith("; section of " + used)
    assert rows["section y=1.5"].endswith("degrees; " + used)
    for path, expected in ((folder, []), (plate_with_hole(tmp_path / "end.out", (10,)),
                                          ["section x=10.8: 2 pieces; the longest, 1 mm, is used"])):
        found, said = find(Sheet(path), [DRAW, RELEASED]), []
        assert twist(Sheet(path), found._replace(mirror=[]), said) and said == expected
    with caplog.at_level(logging.WARNING, "dd3"):
        profiles([folder, folder], "thickness along y=1.5", "")
    assert [message for message in caplog.messages if "longest" in message] == [
        f"{Sheet(folder).path}: section y=1.5: {used}"]
    curves = json.loads(re.search("curves_sections[^{\\[]*(.*?)</script>", text, re.DOTALL)[1])
    assert "y=1.5, piece 2" in json.dumps(curves)


def test_limit(tmp_path):
    """Check the curve of Keeler and Brazier, the zones, and measured curves."""
    curve = keeler_brazier(1.0, 0.21)
    plane = math.log(1.3743)
    assert abs(curve.limit(0.0) - plane) < 1e-12 and abs(curve.limit(-0.9) - plane - 0.9) < 1e-12
    assert abs(curve.limit(0.6) - plane - 0.36) < 1e-12 and keeler_brazier(1.0, 0.5).limit(0.0) == curve.limit(0.0)
    assert abs(keeler_brazier(0.8, 0.105).limit(0.0) - math.log1p(0.5 * 0.34604)) < 1e-12
    major, minor = np.array([0.4, 0.25, 0.15, 0.2, 0.001]), np.array([0.0, 0.0, 0.0, -0.3, 0.0])
    names = [ZONES[zone] for zone in curve.zones(major, minor, 0.1)]
    assert names == ["critical", "marginal", "safe", "thickening", "no strain"], names
    file = tmp_path / "curve.csv"
    file.write_text("# minor, major\n0.3, 0.45\n-0.2 0.5\n0, 0.3\n")
    assert abs(read_curve(file).limit(-0.1) - 0.4) < 1e-12
    assert abs(read_curve(file, engineering=True).limit(0.0) - math.log(1.3)) < 1e-12


def test_curve_files(tmp_path):
    """Check tables of measured curves: headings, order, per cent, and rows that cannot be ones of a curve."""
    file = tmp_path / "curve.csv"
    for text in ('"minor","major"\n"-0.2","0.5"\n"0","0.3"\n"0.3","0.45"\n', "major;minor\n0,5;-0,2\n0,3;0\n0,45;0,3\n",
                 "phi2\tphi1\n-20\t50\n0\t30\n30\t45\n".replace("phi2\tphi1", "phi2 [%]\tphi1 [%]"),
                 "point,e2,e1\nA,-0.2,0.5\nB,0,0.3\nC,0.3,0.45\n"):
        file.write_text(text)
        curve = read_curve(file)
        assert abs(curve.minor - [-0.2, 0, 0.3]).max() < 1e-12 and abs(curve.major - [0.5, 0.3, 0.45]).max() < 1e-12, text
    for text, said in (("-0.2 0.5\n0.45 0.3\n", ":2: error: the minor strain, 0.45, is above the major strain, 0.3"),
                       ("0.5,-0.2\n0.3,0\n", ":1: error: the minor strain, 0.5, is above"),
                       ("-20 50\n0 30\n", "fractions, not per cent"), ("-0.2 0.5\n0 0.3\n-0.2 0.4\n", ":3: error: the minor"),
                       ("-0.4 -0.1\n0 0.3\n", "is not positive"), ("0 0.3\n", "at least 2 points"), ("", "got 0"),
                       ("0 0.3\n0.1 nan\n", ":2: error: 'nan' is not a number"), ("0 0.3 1\n", "more than two"),
                       ("engineering minor,engineering major\n0,0.3\n", "engineering")):
        file.write_text(text)
        with pytest.raises(Problem) as problem:
            read_curve(file)
        assert said in str(problem.value), text


def materials_of(folder, grade=None, **entries):
    """Write the material of a run anew: what *MATERIAL says of its limits."""
    job = json.loads((folder / "run.json").read_text())
    said = {**entries, **({"grade": grade} if grade else {})}
    job["input"]["blocks"] = [{"keyword": "material", "name": "Steel", "entries": [
        {"key": key, "text": text, "unit": "", "default": False} for key, text in said.items()]}]
    (folder / "run.json").write_text(json.dumps(job))


def test_diagram(run, tmp_path):
    """Check the forming limit diagram of a run: the verdict of its curve or none, and that of its thinning."""
    count, cells = 6 * len(profile()[0]), 2 * (len(profile()[0]) - 1)
    said = call("fld", run)
    assert "fld.png" in said and f" of {count} nodes critical, " in said and f" of {cells} elements critical" in said
    assert "Keeler-Brazier, t = 1 mm, n = 0.2" in said and "0.25" not in said
    assert f"thinning above 25 % (default; --thinning): 0 of {count} nodes, 0 of {cells} elements" in said
    materials_of(run)
    said = call("fld", run)
    assert "no verdict: no forming limit curve for the material steel" in said and "critical" not in said
    assert "Keeler-Brazier, t = 1 mm, n = 0.2" in call("fld", run, "--low-carbon-steel")
    assert "n = 0.15" in call("fld", run, "--n", 0.15)
    materials_of(run, forming_limit="-0.2 0.5 0 0.3 0.2 0.4", thinning_limit="0.05")
    limit = Curve([-0.2, 0, 0.2], [0.5, 0.3, 0.4], "").limit(-0.02)
    assert f"{6 * int((profile()[0] / 200 > limit).sum())} of {count} nodes critical" in call("fld", run)
    thin = 6 * int((profile()[0] / 1000 > 0.05).sum())
    assert f"thinning above 5 % (*MATERIAL): {thin} of {count} nodes" in call("fld", run)
    assert f"thinning above 2 % (--thinning): " in call("fld", run, "--thinning", 0.02)
    (tmp_path / "swapped.csv").write_text("0.5,-0.2\n0.3,0\n0.4,0.2\n")
    assert "swapped.csv:1: error: the minor strain" in call("fld", run, "--curve", tmp_path / "swapped.csv", expect=2)
    (tmp_path / "curve.csv").write_text("test 7\nminor,major,width\n-0.2,0.5,20\n0,0.3,60\n0.2,0.4,200\n")
    said = call("fld", run, "--curve", tmp_path / "curve.csv")
    assert "by the curve curve" in said and "curve.csv:1: row 'test 7'" in said and "column 3 'width'" in said
    assert "no field 'major_strain_upper'" in call("fld", run, "--surface", "upper", expect=2)
    for words, text in ((("--n", -1), "--n takes a positive number"), (("--n", "nan"), "--n takes"),
                        (("--thinning", 20), "--thinning takes a fraction"), (("--engineering",), "goes with --curve"),
                        (("--curve", "x", "--n", 0.2), "--curve goes without")):
        assert text in call("fld", run, *words, expect=2), words


def test_cells(tmp_path):
    """Check strains of elements: pure stretching and shear of two layers, and bending of one layer by 90 degrees."""
    x, y, z = (values.ravel() for values in np.meshgrid([0.0, 1, 2], [0.0, 1], [0.0, 0.5, 1], indexing="ij"))
    start = np.column_stack([x, y, z])
    number = np.arange(18).reshape(3, 2, 3)
    cells = [[number[i + a, b, k + c] for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
             for i in (0, 1) for k in (0, 1)]
    matrix = np.array([[1.3, 0.2, 0.0], [0.0, 0.9, 0.0], [0.0, 0.3, 0.8]])
    zero = (np.zeros(18), np.zeros(18))
    fields = {name: zero for name in ("thickness", "thinning", "major_strain_middle", "minor_strain_middle")}
    fields["displacement"] = (0 * start, start @ matrix.T - start)
    sheet = Sheet(write_run(tmp_path / "a.out", start, start @ matrix.T, cells, HISTORY, STATUS, fields))
    stretch = np.log(np.linalg.svd(matrix[:, :2])[1])
    for surface in ("lower", "middle", "upper"):
        major, minor = cell_strains(sheet, 1, surface)
        assert abs(major - stretch[0]).max() < 1e-12 and abs(minor - stretch[1]).max() < 1e-12
    turn, radius, height = 0.5, 4.0, 1.0  # an arc of 0.5 at the middle, of a length of 2
    flat = np.array([(a, b, c) for c in (0.0, height) for a, b in ((0, 0), (2, 0), (2, 1), (0, 1))], float)
    bent = np.array([((radius - c + height / 2) * math.sin(a / 2 * turn), b, radius - (radius - c + height / 2)
                      * math.cos(a / 2 * turn)) for a, b, c in flat])
    zero = (np.zeros(8), np.zeros(8))
    fields = {"displacement": (0 * flat, bent - flat), "thickness": zero}
    sheet = Sheet(write_run(tmp_path / "b.out", flat, bent, [list(range(8))], HISTORY, STATUS, fields))
    for surface, middle in (("lower", radius + height / 2), ("middle", radius), ("upper", radius - height / 2)):
        found = cell_strains(sheet, 1, surface)
        assert abs(np.array(found).ravel() - sorted((math.log(middle * turn / 2), 0.0), reverse=True)).max() < 1e-12


def rows_of(page):
    """Return the rows of the tables of each section of a page, by their first cells."""
    sections = {}
    for section in re.findall(r"<section>(.*?)</section>", page.read_text(), re.DOTALL):
        rows = {row[0]: row[1:] for row in (re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", text) for text in
                                            re.findall(r"<tr>(.*?)</tr>", section, re.DOTALL))}
        sections[re.search("<h2>(.*?)</h2>", section)[1]] = {
            name: " ".join(re.sub("<[^>]*>", "", cell).strip() for cell in cells) for name, cells in rows.items()}
    return sections


def test_report(run, tmp_path):
    """Check that the page is complete and needs no other file."""
    call("report", run, "--mirror", "x", "y", "--output", tmp_path / "report")
    text = (tmp_path / "report" / "report.html").read_text()
    for title in ("Verdict", "Result", "Part in 3D", "Thinning", "Sheet and tools", "Forming limit", "Thickness along sections",
                  "Outline and draw-in", "Phase 1: draw", "Draw-beads", "Warnings", "Run", "Set-up"):
        assert f"<h2>{title}</h2>" in text, title
    assert "A profile &amp; its &lt;report&gt;" in text and "job.dat:3: the mesh is coarse" in text
    assert "State: draw, travel 2.00 mm; completed at the planes x, y = 0." in text
    assert "dd3imp 0.1.0: job.dat<br>started 2026-01-01T00:00:00+00:00" in text
    assert all(source.startswith("data:image/png") for source in re.findall(r'src="([^"]{20})', text))
    markup = re.sub(r"<script\b.*?</script>|<!--.*?-->", "", text, flags=re.DOTALL)
    assert not re.search(r"(href|url)\b", markup) and "<script src" not in text
    assert "Springback" not in text
    for name in ("thinning", "sheet", "limit", "zones", "sections", "outline", "force_draw", "beads"):
        assert (tmp_path / "report" / f"{name}.png").read_bytes()[:4] == b"\x89PNG", name
    (tmp_path / "bad.csv").write_text("0 0.3\n0.1 a\n")
    assert "bad.csv:2: error: " in call("report", run, "--curve", tmp_path / "bad.csv", "--output",
                                                      tmp_path / "report", expect=2)
    assert "No such file" in call("report", tmp_path / "none.out", "--output", tmp_path / "other", expect=2)
    (tmp_path / "points.out").mkdir()
    (tmp_path / "points.out" / "run.json").write_text('{"format": "dd3imp run", "format_version": 2, "points": ["a"]}')
    assert "a run of material points, without a sheet; see dd3 plot point" in call("report", tmp_path / "points.out",
                                                                                    expect=2)
    assert not (tmp_path / "other").exists()


def test_refinements(run, tmp_path):
    """Check the table of refinements and the picture of the levels, which are there where elements were divided."""
    assert "Refinement" not in rows_of(Path(call("report", run, "--output", tmp_path / "report").strip()))
    with h5py.File(run / "fields.vtkhdf", "r+") as file:
        count = len(file["VTKHDF/Types"])
        file["VTKHDF/CellData/level"] = np.concatenate([np.zeros(count, int), np.arange(count) % 3])
        file["VTKHDF/Steps/CellDataOffsets/level"] = [0, count]
    job = json.loads((run / "run.json").read_text())
    job["refinements"] = [{"phase": "draw", "increment": 0, "progress": 0.25, "travel": 0.5, "elements_before": 40,
                           "elements": 80, "elements_of_level": [27, 27, 26], "imbalance": 0.084, "repeated": True}]
    (run / "run.json").write_text(json.dumps(job))
    page = Path(call("report", run, "--output", tmp_path / "report").strip())
    assert rows_of(page)["Refinement"]["draw"] == "0 0.5 40 80 27 + 27 + 26 8.4 yes"
    assert (tmp_path / "report" / "levels.png").read_bytes()[:4] == b"\x89PNG"


def test_numbers_of_the_report(run, tmp_path):
    """Check every number of the page's tables against the fields, the history and the statuses of the run."""
    call("report", run, "--mirror", "x", "y", "--output", tmp_path / "report")
    sections = rows_of(tmp_path / "report" / "report.html")
    _, points, angles = profile()
    end = points[-1] + [math.sin(angles[-1]), -math.cos(angles[-1])]  # at the lower face, the first in the order of nodes
    limit = keeler_brazier(1.0, 0.2).limit(-0.02)
    critical = 6 * int((profile()[0] / 200 > limit).sum())
    sheet = Sheet(run)
    major, minor = cell_strains(sheet, 1, "middle")
    critical_cells = int((major > keeler_brazier(1.0, 0.2).limit(minor)).sum())
    assert sections["Result"] == {
        "thickness": f"{1 - ENDS[-1] / 1000:.4g} to 1 mm",
        "largest thinning": f"{ENDS[-1] / 10:.3g} % at ({end[0]:.1f}, 0.0, {end[1]:.1f}) mm",
        "largest thickening": "0 %", "equivalent plastic strain": "0.1",
        "forming limit": f"{critical} of {6 * len(points)} nodes critical, {critical_cells} of {2 * (len(points) - 1)} "
                         "elements critical by the curve Keeler-Brazier, t = 1 mm, n = 0.2",
        "thinning limit": f"thinning above 25 % (default; --thinning): 0 of {6 * len(points)} nodes, 0 of "
                          f"{2 * (len(points) - 1)} elements; largest {ENDS[-1] / 10:.3g} %",
        "punch: largest force along z, largest pressure": "10 kN, 250 MPa",  # four times the model's force
        "error of the energy balance": "0.1 %"}  # 5 of 5000 mJ
    assert sections["Phase 1: draw"] == {
        "punch": "moved by 0 0 -2 mm", "driven by": "punch", "ends": "at a travel of 2 mm, 100 %",
        "increments": "1, 0 cut back; 5 iterations", "limited by": "rotation 1", "warning": "W109: the mesh is coarse"}
    assert {name: answer.split(" ", 2)[:2] for name, answer in sections["Verdict"].items()} == {
        "run": ["good", "reached"], "formed to the tools": ["not", "judged"], "forming limit": ["not", "good"],
        "thinning": ["good", "thinning"]}
    assert sections["Draw-beads"] == {"rib": "at most 1.2 kN, at the end 1.2 kN; on the sheet 40 mm at most, "
                                             "40 mm at the end"}
    assert sections["Run"] == {"end of the run": "reached", "increments": "1", "cut-backs": "0", "iterations": "5",
                               "wall-clock time": "1.5 s", "material": "1 s 100 %"}


def changed(run, **members):
    """Change members of the description of a run; return it as it was."""
    job = json.loads((run / "run.json").read_text())
    (run / "run.json").write_text(json.dumps({**job, **members}))
    return job


@pytest.mark.parametrize("tools", [True, False])
def test_first_increment(run, tmp_path, tools):
    """Check the page of a run that stops in the first increment of a later phase, or makes it."""
    draw, second = DRAW, {**DRAW, "number": 2, "name": "second", "result": {"state": "stopped", "progress": 0}}
    if not tools:
        draw, second = ({**phase, "tools": [], "unload": False} for phase in (draw, second))
        names = HISTORY.splitlines()[1].split(",")
        kept = [i for i, name in enumerate(names) if not name.startswith(("punch", "rib"))]
        (run / "history.csv").write_text("".join(",".join(line.removeprefix("# units: ").split(",")[i] for i in kept)
                                                 + "\n" for line in HISTORY.splitlines()[1:]))
    (run / "status.csv").write_text(STATUS + "second,2,failed,10,0,r_max\n")
    changed(run, phases=[draw, second], outcome={"state": "stopped", "message": "no convergence"})
    said = call("report", run, "--verdict", "--output", tmp_path / "report", expect=1)
    assert "run: not good: no convergence" in said
    rows = rows_of(tmp_path / "report" / "report.html")["Phase 2: second"]
    assert rows["ends"] == "stopped in its first increment" and rows["increments"].startswith("0, ")
    assert not (tmp_path / "report" / "force_second.png").exists()
    assert (tmp_path / "report" / "force_draw.png").exists() == tools
    changed(run, phases=[draw, {**second, "result": {"state": "running", "progress": 0}}])
    call("report", run, "--output", tmp_path / "report")
    assert rows_of(tmp_path / "report" / "report.html")["Phase 2: second"]["ends"] == "in its first increment"


def test_continued(run, tmp_path):
    """Check that the page of a continued run has warnings and times of its earlier parts, without what a restart gives
    up or repeats."""
    near = {"code": "W009", "text": "long elements", "at": None, "phase": None, "increment": None}
    deep = {"code": "W109", "text": "in phase 'draw' a tool entered", "at": None, "phase": "draw", "increment": 3}
    lost = {"code": "W120", "text": "given up", "at": None, "phase": "draw", "increment": 4}
    last = {"code": "W121", "text": "a support", "at": None, "phase": "draw", "increment": 5}
    job = changed(run)
    first = {**job, "warnings": [near, deep], "seconds": 100, "sections": {"material": 60, "output": 20}}
    second = {**job, "warnings": [near, deep, lost], "seconds": 10, "sections": {"material": 5, "output": 1},
              "continued": {"increment": 3, "earlier": first}}
    changed(run, warnings=[near, last], seconds=1, sections={"material": 0.5},
            continued={"increment": 3, "earlier": second})
    phases = [{"result": {"last_increment": number}} for number in (3, 5, None)]
    assert effort_of({**read_job(run), "phases": phases}) == (5, 111)
    call("report", run, "--output", tmp_path / "report")
    page = tmp_path / "report" / "report.html"
    found = re.search("<ul class=warn>(.*?)</ul>", page.read_text())[1]
    assert re.findall("<li>(.*?)</li>", found) == ["long elements", "in phase &#x27;draw&#x27; a tool entered", "a support"]
    sections = rows_of(page)
    assert len(re.findall("W109: ", page.read_text())) == 1 and "W121: a support" in page.read_text()
    assert sections["Run"]["wall-clock time"] == "111 s"
    assert sections["Run"]["material"] == "65.5 s 76 %" and sections["Run"]["output"] == "21 s 24 %"


def test_places(run):
    """Check the steps that travels and phases name, and those that are not there."""
    sheet = Sheet(run)
    assert [sheet.step_at(place) for place in (0.0, 2, "2", "draw", "draw:90", "draw:0")] == [0, 1, 1, 1, 1, 0]
    assert sheet.state(1) == "draw, travel 2.00 mm"
    for place, said in (("3", "no travel 3 mm; there is 0 to 2; the phases are draw"), ("free", "no place free"),
                        ("draw:x", "expected a travel in mm, PHASE or PHASE:PERCENT")):
        assert said in call("fld", run, "--at", place, expect=2), place


def test_actions():
    """Check what a page says of the tools."""
    assert action(RELEASED["tools"][0]) == "released"
    assert action(ROLL) == "pressed by 0 0 -100 N, turned by 90 degrees about 0 1 0"
    gap = {**PUNCH, "gap": {"from": "die", "value": 1.1, "unit": "thicknesses"}}
    assert action(gap) == "moved to a gap of 1.1 thicknesses from die"


def bar(shape):
    """Return the nodes of a sheet of 40 x 4 x 1 mm, and of the sheet in another shape."""
    x, y, z = np.meshgrid(np.linspace(-20, 20, 41), np.linspace(-2, 2, 5), [-0.5, 0.5], indexing="ij")
    start = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    return start, np.array([shape(*point) for point in start])


def twisted(x, y, z, rate=math.radians(0.05)):
    """Return the place of a point of a bar that is twisted about x, and then moved."""
    turn, place = rate * x, np.array([x, 0.0, 0.0])
    place += [0, y * math.cos(turn) - z * math.sin(turn), y * math.sin(turn) + z * math.cos(turn)]
    return place @ np.array([[0.8, 0.6, 0], [-0.6, 0.8, 0], [0, 0, 1]]) + [3, -1, 7]


def test_symmetry():
    """Check that planes which hold the border of a sheet are found, and not those in its middle or where it moves off;
    and that the best fit keeps a bent half on its plane."""
    start = np.stack(np.meshgrid(np.linspace(0, 40, 41), np.linspace(-3, 3, 7), [0.0, 1.0], indexing="ij"),
                     axis=-1).reshape(-1, 3)
    bent = start + np.outer(2e-3 * start[:, 0]**2, [-0.1, 0, 1])
    assert symmetry(start, bent) == ["x"]
    assert symmetry(start, bent, bent + [0.1, 0, 0]) == [] and symmetry(start - [20, 0, 0], bent - [20, 0, 0]) == []
    assert symmetry(-start, -bent) == ["x"] and symmetry(start, start) == []
    assert symmetry(start + [0, 3, 0], bent + [0, 3, 0]) == ["x"]  # no node moves along y
    free = best_fit(bent, start, ["x"])
    assert np.abs(free[start[:, 0] == 0, 0]).max() < 1e-9
    # Of a parabola: its height less the mean height.
    rise = 2e-3 * start[:, 0]**2
    assert np.abs(free[:, 2] - start[:, 2] - rise + rise.mean()).max() < 1e-9
    assert np.linalg.norm(best_fit(bent, start) - start, axis=1).max() < 0.4 * np.linalg.norm(free - start, axis=1).max()


def test_springback(tmp_path):
    """Check the distance, the rotations and the twist of a bar that is twisted in its release."""
    start, free = bar(twisted)
    nodes = np.arange(len(start)).reshape(41, 5, 2)
    cells = [[nodes[i + a, j + b, k] for k in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
             for i in range(40) for j in range(4)]
    history = HISTORY.splitlines()[:3] + [HISTORY.splitlines()[3].replace("1,draw,2,1", "1,free,0,1")]
    one = np.ones(len(start))
    fields = {"thickness": (one, one), **{name: (0 * one, 0 * one) for name in (
        "thinning", "draw_in", "equivalent_plastic_strain", "major_strain_middle", "minor_strain_middle")}}
    folder = write_run(tmp_path / "bar.out", start, free, cells, "\n".join(history) + "\n", STATUS, fields,
                       phases=[DRAW, RELEASED])
    sheet = Sheet(folder)
    found = find(sheet, [DRAW, RELEASED])
    assert found and found.step == 0 and found.mirror == []
    radius, angle = np.hypot(start[:, 1], start[:, 2]), np.radians(0.05) * np.abs(start[:, 0])
    assert np.abs(found.distance() - 2 * radius * np.sin(angle / 2)).max() < 2e-3
    axis, degrees = twist(sheet, found)
    assert axis == "x" and abs(degrees - 32 * 0.05) < 2e-3, degrees
    along_y = write_run(tmp_path / "along_y.out", np.roll(start, 1, axis=1), np.roll(free, 1, axis=1), cells,
                        "\n".join(history) + "\n", STATUS, fields, phases=[DRAW, RELEASED])
    turned = Sheet(along_y)
    assert twist(turned, find(turned, [DRAW, RELEASED])) == ("y", pytest.approx(degrees))
    line = sheet.cut(np.eye(3)[0], 10.0)[0]
    assert abs(rotation(line, found, np.eye(3)[0]) - 0.5) < 2e-3
    assert max(map(abs, opening(line, found, np.eye(3)[0]))) < 1e-6
    call("report", folder, "--section", "x=10", "--output", tmp_path / "report")
    rows, distance = rows_of(tmp_path / "report" / "report.html")["Springback"], found.distance()
    assert rows["largest distance from the drawn shape"] == f"{distance.max():.4g} mm"
    mean = np.average(distance, weights=sheet.areas(0))
    assert rows["mean distance over the area"] == f"{mean:.4g} mm"
    assert rows["twist about x from 10 to 90 % of the length"] == "+1.6 degrees"
    assert rows["section x=10"].startswith("turned by +0.5 degrees; its ends against that by "), rows
    # A release that has not ended is none, one that ends by `until` is.
    for state, progress, words in (("interrupted", 0.1, "the release ended at 10 %"), ("ended", 0.4, ""),
                                   ("running", 0.5, "the release is at 50 %"),
                                   ("pending", None, "the release has not begun")):
        phases = [DRAW, {**RELEASED, "result": {"state": state, "progress": progress}}]
        assert unfinished(phases) == words and (find(sheet, phases) is None) == bool(words)
    assert find(sheet, [DRAW, RELEASED, {**DRAW, "result": {"state": "pending"}}]) is None
    assert unfinished([DRAW]) == "" and unfinished([{**RELEASED, "result": {"state": "stopped"}}]) == ""
    changed(folder, phases=[DRAW, {**RELEASED, "result": {"state": "interrupted", "progress": 0.1}}],
            outcome={"state": "interrupted", "message": "interrupted"})
    with pytest.raises(Problem, match="no springback, as the release ended at 10 %"):
        field_map(folder, "springback", [])
    said = "springback: not judged: the release ended at 10 %"
    assert said in call("report", folder, "--verdict", "--output", tmp_path / "report", expect=1)
    text = (tmp_path / "report" / "report.html").read_text()
    assert "<h2>Springback</h2>\n<p>Not judged: the release ended at 10 %.</p>" in text
    assert said in [": ".join(item) for item in Run(folder).verdict()]
    # A phase that opens the tools is not that of the drawn shape.
    opened = SimpleNamespace(file={"job": {"phase": [1, 1, 2, 2, 3]}}, count=5, grid={"PointData": {"contact_status": 0}},
                             values=lambda step, _: (np.array([0, step < 2]), ""))
    phases = [{"number": number, "tools": [{"active": number < 3}]} for number in (1, 2, 3)]
    assert list(steps_with_tools(opened, phases)) == [0, 1]
    # A run that only releases a sheet of another one takes it over in its drawn shape.
    taken_over = [{"number": number, "name": name, "unload": True, "tools": []} for number, name in enumerate("ab", 1)]
    assert np.allclose(find(sheet, taken_over).distance(), distance)
    assert find(sheet, [{**taken_over[0], "unload": False}]) is None
    assert find(sheet, [DRAW, {**RELEASED, "tools": [PUNCH]}]) is None and twist(sheet, found._replace(mirror=["x"])) is None


def test_standing(tmp_path):
    """Check the sections of the page of a sheet that stands across y, by default and by name."""
    start, stretched = (shape[:, [0, 2, 1]] * [1, -1, 1] for shape in bar(lambda x, y, z: (1.1 * x, y, z)))
    nodes = np.arange(len(start)).reshape(41, 5, 2)
    cells = [[nodes[i + a, j + b, k] for k in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
             for i in range(40) for j in range(4)]
    one = np.ones(len(start))
    fields = {"thickness": (one, one), **{name: (0 * one, 0 * one) for name in (
        "thinning", "draw_in", "equivalent_plastic_strain", "major_strain_middle", "minor_strain_middle")}}
    folder = write_run(tmp_path / "bar.out", start, stretched, cells, HISTORY, STATUS, fields, phases=[DRAW])
    page = Path(call("report", folder).strip())
    assert "Thickness along sections" in page.read_text()
    assert section_planes(Report(folder)) == ["z=0", "x=0"]
    assert section_planes(Report(folder, mirror=["y"])) == ["x=0"]  # y=0 lies between the faces
    assert "the plane z=30 does not cut the sheet" in call("report", folder, "--section", "z=30", expect=2)
    assert plane_name(np.array([-0.5, math.sqrt(0.75), 0]), 0.0) == "at 30 degrees"
    assert plane_name(np.array([0, 0.6, 0.8]), 1.5) == "with the normal 0 0.6 0.8 at 1.5 mm"
