# SPDX-License-Identifier: GPL-3.0-or-later
"""Operations: curves of CAD files, processes, outlines of blanks, tools that are corrected for springback."""

import json
import re
import shutil
from pathlib import Path

import ezdxf
import numpy as np
import pytest
import pyvista as pv
from helpers import call

import dd3
from dd3.curve import read_curves
from dd3.errors import Problem
from dd3.fixture_target import aligned
from dd3.gmsh_session import session
from dd3.moved_tools import (
    along_sheet,
    divisions,
    moved_surface,
    nodes_of,
    smooth_field,
    write_step,
)
from dd3.nominal import continued
from dd3.outline import Outline, Rim, excess, moved
from dd3.tools.surface import read_patches, write

STRIP = """*PARAMETER
  strain = 0.02
*BLANK strip
  size = 40 20 1
  divisions = 12 6 1
  element = solid_shell
  material = steel
*MATERIAL steel
  young = 2e5
  poisson = 0.3
  yield = von_mises
  hardening = linear Y0=200 H=1000
*BOUNDARY left
  set = x_min
  fix = x y z
*PHASE pull
  control = load
  trial = 0.5
  displace = x_max x 1
"""
CUT = """*START
  from = op10.out
*MATERIAL steel
  young = 2e5
  poisson = 0.3
  yield = von_mises
  hardening = linear Y0=200 H=1000
*TRIM rim
  file = "rim.txt"
*PHASE free
  unload = on
"""
PROCESS = """title = "Strip"
[report]
mirror = ["x", "y"]
section = ["x=20", "y=10"]
[[operation]]
deck = "op10.dat"
[[operation]]
deck = "op20.dat"
"""


def test_curves_of_cad(tmp_path):
    """A face with a hole has two curves, on their geometry within the chord; a solid has none."""
    with session() as gmsh:
        occ = gmsh.model.occ
        plate = occ.addRectangle(0, 0, 2, 30, 20)
        hole = occ.addDisk(12, 9, 2, 4, 4)
        occ.cut([(2, plate)], [(2, hole)])
        occ.synchronize()
        gmsh.write(str(tmp_path / "plate.step"))
        gmsh.clear()
        occ.addBox(0, 0, 0, 1, 2, 3)
        occ.synchronize()
        gmsh.write(str(tmp_path / "box.step"))
    said = call("curve", tmp_path / "plate.step", tmp_path / "rims.txt", "--chord", "0.005")
    assert "curve 2" in said
    outer, inner = read_curves(tmp_path / "rims.txt")
    assert len(outer) == 4 and np.allclose(np.ptp(outer, axis=0), (30, 20, 0))
    radius = np.linalg.norm(inner[:, :2] - (12, 9), axis=1)
    chords = 4 - np.linalg.norm(0.5 * (inner + np.roll(inner, 1, axis=0))[:, :2] - (12, 9), axis=1)
    assert np.allclose(radius, 4) and 0 < chords.max() <= 0.005 and np.allclose(inner[:, 2], 2)
    assert "free edges" in call("curve", tmp_path / "box.step", tmp_path / "none.txt", expect=2)


def test_curves_of_dxf(tmp_path):
    """Lines of a layer are joined, in mm; open ones are refused with their ends."""
    document = ezdxf.new(units=ezdxf.units.IN)
    space = document.modelspace()
    space.add_lwpolyline([(1, 0), (0, 0), (0, 1)], dxfattribs={"layer": "TRIM"})
    space.add_arc((0, 0), 1, 0, 90, dxfattribs={"layer": "TRIM"})
    space.add_text("note", dxfattribs={"layer": "TRIM"})
    space.add_line((5, 5), (6, 6), dxfattribs={"layer": "OTHER"})
    document.saveas(tmp_path / "trim.dxf")
    call("curve", tmp_path / "trim.dxf", tmp_path / "trim.txt", "--layer", "TRIM")
    (curve,) = read_curves(tmp_path / "trim.txt")
    x, y = curve[:, :2].T
    area = 0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    assert area == pytest.approx(np.pi / 4 * 25.4**2, rel=1e-3) and np.allclose(curve.max(0), (25.4, 25.4, 0))
    said = call("curve", tmp_path / "trim.dxf", tmp_path / "x.txt", expect=2)
    assert "not closed end at (127 127 0), (152.4 152.4 0)" in said
    assert "there are: OTHER TRIM" in call("curve", tmp_path / "trim.dxf", tmp_path / "x.txt", "--layer", "no", expect=2)


def make_process(folder, first=STRIP, second=CUT, text=PROCESS):
    """Write a process of two operations; return its file."""
    angle = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    (folder / "rim.txt").write_text("".join(f"{20 + 9 * np.cos(a):.6f} {10 + 7 * np.sin(a):.6f} 0\n" for a in angle))
    (folder / "op10.dat").write_text(first)
    (folder / "op20.dat").write_text(second)
    (folder / "part.toml").write_text(text)
    return folder / "part.toml"


def test_process(tmp_path, program):
    """The operations run once, and again from the one on whose input has changed."""
    path = make_process(tmp_path)
    words = ("process", path, "--program", program, "--threads", "1")
    said = call(*words, "--report")
    assert said.count("reached its end") == 2 and "report.html" in said
    page = (tmp_path / "part.report" / "report.html").read_text()
    assert "op10/report.html" in page and "op20/report.html" in page
    assert "the planes x, y = 0" in (tmp_path / "part.report" / "op10" / "report.html").read_text()
    job = json.loads((tmp_path / "op20.out" / "run.json").read_text())
    assert job["sheet"]["kind"] == "start" and job["sheet"]["elements"] < 72
    assert call(*words).count("has ended before") == 2
    make_process(tmp_path, second=CUT.replace("unload = on", "unload = on\n  trial = 0.2"))
    said = call(*words)
    assert "op10: has ended before" in said and "op20: reached its end" in said
    table = STRIP.replace("linear Y0=200 H=1000", "table file=flow.txt")
    for stress in (220, 230):  # a file that a law reads
        (tmp_path / "flow.txt").write_text(f"0 200\n0.1 {stress}\n")
        make_process(tmp_path, first=table, second=CUT.replace("linear Y0=200 H=1000", "table file=flow.txt"))
        assert call(*words).count("reached its end") == 2


def test_process_refused(tmp_path, program):
    """Wrong files of processes and all errors of their input files are told before a run."""
    words = ("process", tmp_path / "part.toml", "--program", program)
    for text, said in (("title = 3\n", "title is a int"), ("operation = [1]\n", "1 of operation 1; expected a table"),
                       ("tilte = ''\n", "unknown key 'tilte'"),
                       ("", "no [[operation]]"), ("[[operation]]\nname = 'a'\n", "operation 1 has no deck"),
                       ("[[operation]]\ndeck = 'no.dat'\n", "'no.dat' of operation 1 does not exist"),
                       ("[[operation\n", "error: ")):
        make_process(tmp_path, text=text)
        assert said in call(*words, expect=2)
    make_process(tmp_path, text=PROCESS.replace('deck = "op20.dat"', 'deck = "op20.dat"\nname = "op10"'))
    assert "two operations are named 'op10'" in call(*words, expect=2)
    make_process(tmp_path, first=STRIP.replace("displace", "displaec"), second=CUT.replace("rim.txt", "none.txt"))
    said = call(*words, expect=2)
    assert "op10.dat:19: error E112" in said and "none.txt" in said and not (tmp_path / "op10.out").exists()


BOX = """*PROFILE plate
  start = 0 0
  line = 60 0
  extrude = -5 45
"""


def test_process_makes_tools(tmp_path, program):
    """Tools are made of their sources, again when source or options have changed, and no other file is replaced."""
    (tmp_path / "plate.shape").write_text(BOX)
    tool = (STRIP + '*TOOL plate\n  patches = "plate.bez"\n  friction = 0\n  contact = z_min\n'
            '  position = 0 0 -50\n*CONTACT\n')
    rows = '[[tool]]\nsource = "plate.shape"\ntoward = [0, 0, 1]\n'
    words = ("process", tmp_path / "part.toml", "--program", program, "--threads", "1")
    make_process(tmp_path, first=tool, text=PROCESS + rows)
    assert "plate.bez: made of plate.shape" in call(*words)
    said = call(*words)
    assert "made of" not in said and said.count("has ended before") == 2
    (tmp_path / "plate.shape").write_text(BOX.replace("60", "64"))
    said = call(*words)
    assert "made of" in said and said.count("reached its end") == 2
    make_process(tmp_path, first=tool, text=PROCESS + rows + "offset = 1\n")
    assert "made of" in call(*words)
    path = tmp_path / "plate.bez"
    path.write_text("# my own\n" + path.read_text())
    assert "does not replace it" in call(*words, expect=2) and path.read_text().startswith("# my own")


def test_process_refuses_tools(tmp_path, program):
    """All wrong rows of tools are told at once."""
    (tmp_path / "plate.shape").write_text(BOX)
    words = ("process", tmp_path / "part.toml", "--program", program)
    made = '[[tool]]\nsource = "plate.shape"\n'
    make_process(tmp_path, text=PROCESS + '[[tool]]\nsource = "none.step"\n' + made + "toward = [1, 2]\n" + made + made
                 + "offset = 2\nfaces = [3]\n[[tool]]\nturn = true\n" + made + "rotate = [0, 0, 1, 90]\n")
    said = call(*words, expect=2)
    for text in ("tool 1: ", "none.step: no such file", "tool 2: toward takes three numbers", "tool 4: --faces takes CAD",
                 "tool 5: no source", "tool 6: rotate takes"):
        assert text in said
    for rows, text in ((made + made, "plate.bez is the target of two tools"),
                       (made + "thickness = 1\n", "unknown key 'thickness' of tool 1"),
                       (made + "offset = true\n", "offset of tool 1 is a bool"),
                       (made + 'target = "plate.dat"\n', "ends in .bez")):
        make_process(tmp_path, text=PROCESS + rows)
        assert text in call(*words, expect=2)


def rim_of(points, radius):
    """Return the rim of a sheet that has been stretched from the unit circle to a radius, at some of its points."""
    outward = points / np.linalg.norm(points, axis=1, keepdims=True)
    three = np.column_stack((outward, np.zeros(len(points))))
    return Rim(points, radius * three, three, np.full(len(points), radius))


def test_outline():
    """An outline moves by the excess over the stretch, all around and between planes of symmetry."""
    angle = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    circle = np.column_stack((np.cos(angle), np.sin(angle), 0 * angle))
    wanted = Outline(1.8 * circle)
    beyond = excess(rim_of(circle[:, :2], 2.0), None, wanted)
    assert np.allclose(beyond, 0.2, atol=1e-3)
    new = moved(circle, rim_of(circle[:, :2], 2.0), beyond)
    assert np.allclose(np.linalg.norm(new[:, :2], axis=1), 0.9, atol=1e-3) and len(new) == 64
    quarter = np.vstack(([[1, -0.5, 0]], circle[:17], [[-0.5, 1, 0], [-0.5, -0.5, 0]]))
    rim = rim_of(circle[:17, :2], 2.0)
    new = moved(quarter, rim, excess(rim, None, wanted))
    assert np.allclose(np.linalg.norm(new[:17, :2], axis=1), 0.9, atol=3e-3) and len(new) == 20
    # The ends go on across the planes of symmetry, parallel to the axes.
    assert abs(new[0, 0] - new[-1, 0]) < 1e-2 and abs(new[16, 1] - new[17, 1]) < 1e-2
    assert wanted.distance(np.array([0.0, 2.8])) == pytest.approx(1.0, abs=2e-3)
    assert wanted.distance(np.array([0.3, 0.0])) < -1.4
    # A collar that is too long, within a curve or above a height, needs a larger hole.
    rim = rim_of(circle[:, :2], 2.0)
    collar = Rim(rim.initial, rim.position, -rim.onward, rim.stretch)
    beyond = excess(collar, None, Outline(2.2 * circle), -1)
    assert np.allclose(beyond, 0.2, atol=1e-2)
    assert np.allclose(np.linalg.norm(moved(circle, collar, beyond, -1)[:, :2], axis=1), 1.1, atol=1e-2)


def test_outline_by_height():
    """The excess of a rim over a plane is a length along the wall."""
    angle = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    circle = np.column_stack((np.cos(angle), np.sin(angle)))
    slope = np.array([0.6, 0.0, 0.8])
    rim = Rim(circle, np.column_stack((circle, np.full(40, 3.2))), np.tile(slope, (40, 1)), np.ones(40))
    assert np.allclose(excess(rim, 3.0, None), 0.25)


def test_curves_of_users(tmp_path):
    """Curves are read as *TRIM reads them; what is no curve is told with its line."""
    path = tmp_path / "rim.txt"
    path.write_text("# a triangle\n0 0 0\n1.4d1 0 0  # corner\n0 1E1 0\n0 0 0\n\n1 1 0\n2 1 0\n2 2 0\n")
    first, second = read_curves(path)
    assert np.allclose(first, [[0, 0, 0], [14, 0, 0], [0, 10, 0]]) and len(second) == 3
    for text, said in ("x y z\n0 0 0\n", "rim.txt:1: error: expected x y z"), ("0 0\n", "not '0 0'"), ("#\n", "no curve"):
        path.write_text(text)
        with pytest.raises(Problem, match=re.escape(said)):
            read_curves(path)


def test_moved_surface(tmp_path):
    """Patches that are moved stay joined, symmetric, and where nothing moves them."""
    arc = np.sqrt(0.5)
    path = tmp_path / "tool.bez"
    path.write_text("patch 2 1 rational\n"
                    f"0 -10 -5 1\n0 -10 0 {arc}\n5 -10 0 1\n0 10 -5 1\n0 10 0 {arc}\n5 10 0 1\n"
                    "patch 1 1\n5 -10 0\n25 -10 0\n5 10 0\n25 10 0\n")
    patches = read_patches(path)
    radius = np.linalg.norm(nodes_of(patches[0], 3, 3)[..., [0, 2]] - (5, -5), axis=2)
    assert np.allclose(radius, 5) and divisions(patches, 5.0).tolist() == [[4, 2], [4, 4]]
    rng = np.random.default_rng(3)
    points = rng.uniform((0, 0, -5), (25, 10, 0), (200, 3))
    values = np.column_stack((0.01 * points[:, 0], 0.02 * points[:, 1], 0.1 * np.cos(points[:, 0] / 8)))
    move = smooth_field(points, values, ["y"], 4.0)
    surface = moved_surface(path, move, 5.0, np.zeros(3))
    nodes = np.stack([nodes_of((net[..., :3], net[..., 3]), 1, 1) for net in surface.net]).reshape(-1, 3)
    assert len(surface.net) == 24
    # The faces have the same nodes at their joint.
    first, second = (nodes_of((net[..., :3], net[..., 3]), 1, 1)[:, side] for net, side in
                     ((surface.net[1], -1), (surface.net[8], 0)))
    assert np.allclose(first, second, atol=1e-12)
    mirrored = nodes * (1, -1, 1)
    assert max(np.abs(nodes - place).sum(axis=1).min() for place in mirrored) < 1e-6
    write(path, moved_surface(path, np.zeros_like, np.inf, np.zeros(3)), ["unchanged"])
    again = np.linalg.norm(nodes_of(read_patches(path)[0], 4, 4)[..., [0, 2]] - (5, -5), axis=2)
    assert np.allclose(again, 5, atol=0.2)
    write_step(tmp_path / "tool.step", surface)
    with session(tmp_path / "tool.step") as gmsh:
        assert len(gmsh.model.getEntities(2)) == 24


def test_smooth_field():
    """A linear displacement is kept inside and some millimetres beyond the border, and fades to a constant far away; a
    symmetric one stays so; noise is smoothed."""
    rng = np.random.default_rng(5)
    x, y = rng.uniform((0, 0), (60, 40), (6000, 2)).T
    points = np.column_stack((x, y, 0 * x))
    given = np.outer(0.3 + 0.1 * x - 0.02 * y, (0, 0, 1))
    field = smooth_field(points, given, [], 4.0)
    assert np.allclose(field(points), given, atol=0.05)
    assert np.allclose(field(np.array([[64.0, 20, 0], [-4, 20, 0]]))[:, 2], (6.3, -0.5), atol=0.08)
    far = field(np.array([[500.0, 20, 0], [600.0, 20, 0]]))[:, 2]
    assert abs(far).max() < 12 and abs(np.ptp(far)) < 0.2
    field = smooth_field(points, np.abs(points) * (0, 0, 1) + np.sin(points), ["x"], 4.0)
    places, mirrored = np.array([[10, 5, 2], [60, 5, 2], [20, 40, 2.0]]), np.array([-1, 1, 1])
    assert np.allclose(field(places * mirrored), field(places) * mirrored, atol=1e-6)
    field = smooth_field(points, np.abs(points) + np.sin(points), [], 4.0, half_turn=True)
    assert np.allclose(field(points * (-1, -1, 1)), field(points) * (-1, -1, 1), atol=1e-9)
    noise = smooth_field(points, rng.standard_normal(points.shape), [], 4.0)(points)
    assert np.sqrt((noise**2).mean()) < 0.2


def test_gap():
    """Tools beside a sheet keep their gap where it is bent and turned, along the sheet and beyond its border."""
    x, y = (part.ravel() for part in np.meshgrid(np.linspace(0, 20, 11), np.linspace(0, 8, 5), indexing="ij"))
    number = np.arange(55).reshape(11, 5)
    quads = np.stack([number[i, j].ravel() for i, j in ((np.s_[:-1], np.s_[:-1]), (np.s_[1:], np.s_[:-1]),
                                                        (np.s_[1:], np.s_[1:]), (np.s_[:-1], np.s_[1:]))], axis=1)
    points, quads = continued(np.column_stack((x, y, 0 * x)), quads, 10.0, {})
    assert np.allclose((points.min(axis=0), points.max(axis=0)), ((-10, -10, 0), (30, 18, 0)))
    sheet = pv.PolyData.from_regular_faces(points, quads).triangulate()
    radius = 30.0

    def bend(place):
        angle, height = place[:, 0] / radius, radius - place[:, 2]
        return np.column_stack((height * np.sin(angle), place[:, 1], radius - height * np.cos(angle))) - place
    move = along_sheet(bend, sheet, 1.0)
    below = np.random.default_rng(1).uniform((-8, -8, 0), (28, 16, 0), (40, 3))
    above = below + (0, 0, 1.3)
    gap = np.linalg.norm(above + move(above) - below - move(below), axis=1)
    assert np.allclose(gap, 1.3, atol=1e-3)


def short_hat(folder, gap="12"):
    """Copy the hat, with few elements and a shallow draw; return the file of the process."""
    for name in ("hat", "materials"):
        shutil.copytree(Path(__file__).parents[2] / "input_files" / name, folder / name)
    deck = folder / "hat/hat.dat"
    text = deck.read_text()
    for old, new in (("200 1 1", "40 1 1"), ("points = 9", "points = 3"), ("0 0 12", f"0 0 {gap}")):
        assert old in text
        text = text.replace(old, new)
    deck.write_text(text)
    return folder / "hat/hat.toml"


def test_beyond_the_border():
    """Nodes beyond the border of the wanted shape, here a quarter of a cylinder, are not compared."""
    angle = np.radians(np.linspace(0, 90, 91))
    arc = [np.stack((20 * np.sin(angle), np.full(91, y), 20 * np.cos(angle)), axis=1) for y in (0.0, 20.0, 40.0)]
    number = np.arange(273).reshape(3, 91)
    quads = np.stack((number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]), axis=-1).reshape(-1, 4)
    wanted = pv.PolyData.from_regular_faces(np.concatenate(arc), quads).triangulate()
    angle = np.radians(np.linspace(10, 96, 44))
    part = np.concatenate([np.stack((20 * np.sin(angle), np.full(44, y), 20 * np.cos(angle)), axis=1)
                           for y in (1.0, 10.0, 20.0, 30.0, 39.0)])
    place, goal, compared = aligned(part, part, wanted, [], 0.25)
    assert (compared == (np.tile(angle, 5) <= np.radians(90.5))).all()
    assert np.linalg.norm(goal - place, axis=1)[compared].max() < 0.005
    assert np.linalg.norm(goal - place, axis=1)[~compared].max() == 0


def test_no_room(tmp_path, program):
    """Where a corrected tool starts inside the blank, the loops end, and the best tools and the operations with them are
    there."""
    path = short_hat(tmp_path, "0.05")
    said = call("compensate", path, "--tools", "tools", "--mirror", "x", "--program", program, expect=2)
    assert "loop 1 stopped" in said and "starts inside the sheet" in said and "tools of loop 0" in said
    folder = tmp_path / "hat/hat.compensate"
    assert len((folder / "deviations.csv").read_text().splitlines()) == 2 and (folder / "die.step").is_file()
    assert dd3.open(tmp_path / "hat/hat.out").job["outcome"]["state"] == "reached"


def test_stopped_loop(tmp_path, program):
    """Where the run with corrected tools stops, half of the correction is tried."""
    runs, script = tmp_path / "runs", tmp_path / "dd3imp"
    script.write_text(f"""#!/bin/sh
case "$*" in *--check*) exec {program} "$@";; esac
echo run >>{runs}
[ "$(wc -l <{runs})" -ne 2 ] || {{ echo "dd3imp: stopped E244: no equilibrium" >&2; exit 3; }}
exec {program} "$@"
""")
    script.chmod(0o755)
    said = call("compensate", short_hat(tmp_path), "--tools", "tools", "--mirror", "x", "--loops", "1", "--program", script)
    assert "loop 1 with 1 of the correction stopped: hat: dd3imp: stopped E244" in said and "loop 1: largest" in said
    assert len(runs.read_text().splitlines()) == 3


def test_refused(tmp_path, program):
    """Commands that need a parameter of the input files say so."""
    path = make_process(tmp_path)
    said = call("compensate", path, "--tools", "nothing", "--program", program, expect=2)
    assert "no input file has the parameter 'nothing'" in said
    assert "no *TRIM" in call("outline", path, "--curve", "strain", "--height", "1", "--program", program, expect=2)
    (tmp_path / "right.txt").write_text("10 -5 0\n45 -5 0\n45 25 0\n10 25 0\n")
    cut = STRIP.replace("set = x_min", "set = rim") + '*TRIM rim\n  file = "right.txt"\n'
    path = make_process(tmp_path, first=cut)
    assert "'strain' is not the file" in call("outline", path, "--curve", "strain", "--height", "1", "--program", program,
                                              expect=2)
    assert "takes 1 or more" in call("outline", path, "--curve", "c", "--height", "1", "--draws", "0", expect=2)
    assert "one of the arguments --height --rim" in call("outline", path, "--curve", "c", expect=2)
