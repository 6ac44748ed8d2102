#!/usr/bin/env python3
"""Check utils/tool.py: exact shapes and CAD against closed forms, options, reports, refusals; a run of the program
with --check on what was written. The parts that need gmsh are skipped if the package is missing.
"""
import argparse
import contextlib
import importlib.util
import io
import subprocess
import sys
import tempfile
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "utils"))
if any(importlib.util.find_spec(name) is None for name in ("numpy", "scipy")):
    print("skipped: numpy or scipy is not installed")
    sys.exit(77)

import numpy as np  # noqa: E402
import scripts  # noqa: E402
import tool  # noqa: E402
from tools import surface as surfaces  # noqa: E402
from tools.joints import find_joints, folded, kinks  # noqa: E402

BOXES = """*PARAMETER
  radius = 5
*ROUNDED_BOX {kind}
  kind = {kind}
  half = 35 25
  corner = 10
  radius = ${{radius}}
  depth = 40
  flange = 30
  {more}
"""
PROFILE = """*PROFILE shoulder
  axes = {axes}
  start = 25 -40
  corner = 25 0 5
  line = 80 0
  {led}
"""
DECK = """*BLANK strip
  size = 10 10 1
  divisions = 8 8 1
  material = steel
*MATERIAL steel
  young = 2.1e5
  poisson = 0.3
  yield = von_mises
  hardening = perfect Y0=200
*BOUNDARY held
  set = x_min
  fix = x y z
*TOOL tool
  patches = "{file}"
  friction = 0.1
  contact = {side}
  position = 0 0 {height}
*CONTACT
  search_distance = 1
*PHASE move
  control = tool
  trial = 1
  move = tool 0 0 0.1
"""


def convert(*words, expect=0):
    """Call tool.py; return what it says."""
    said = io.StringIO()
    code = 0
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said), \
            mock.patch.object(sys, "argv", ["tool.py", *map(str, words)]):
        try:
            scripts.run(tool.main)
        except SystemExit as stop:
            code = stop.code or 0
    assert code == expect, f"{words}: {code}\n{said.getvalue()}"
    assert "Traceback" not in said.getvalue()
    return said.getvalue()


def read(path):
    """Return the patches of a .bez file, raised to degree 2."""
    lines = [line.split() for line in path.read_text().splitlines() if not line.startswith("#")]
    raise_by = {2: np.array([[1, 0], [.5, .5], [0, 1]]), 3: np.eye(3)}
    nets = []
    for points, weights in surfaces.read_lines(lines):
        net = surfaces.homogeneous(points, weights)
        nets.append(np.einsum("ai,bj,ijc->abc", raise_by[net.shape[0]], raise_by[net.shape[1]], net))
    return np.array(nets)


def points_of(net, count=9):
    """Return points and unit normals between the borders of the patches."""
    u, v = np.meshgrid(*[np.linspace(0.01, 0.99, count)] * 2)
    area = surfaces.areas_at(net, u.ravel(), v.ravel())
    return surfaces.points_at(net, u.ravel(), v.ravel()), area / np.linalg.norm(area, axis=2, keepdims=True)


def box_distance(point, half, corner, radius, kind):
    """Return the distance of points from the punch or the die of a box, its face at z = 0, positive on the sheet's
    side."""
    plan = np.abs(point[..., :2]) - (np.array(half) - corner)
    outwards = np.linalg.norm(np.maximum(plan, 0), axis=-1) + np.minimum(plan.max(axis=-1), 0) - corner
    # In the plane of the profile: a quarter of a circle between the face and the wall.
    if kind == "die":
        across, height = radius - outwards, point[..., 2] + radius
    else:
        across, height = outwards + radius, radius - point[..., 2]
    return np.where((across > 0) & (height > 0), np.hypot(across, height), np.maximum(across, height)) - radius


def check_program(program, file, side, height):
    """Check that the program takes the surface without a near miss."""
    deck = file.with_suffix(".dat")
    deck.write_text(DECK.format(file=file, side=side, height=height))
    done = subprocess.run([program, "--check", deck], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    line = next(line for line in done.stdout.splitlines() if line.startswith("tool 'tool'"))
    assert " 0 near misses, 0 T-junctions" in line, line
    return line


def check_boxes(folder, program):
    """Check punch, die and holder of a box, whole and a quarter, and their offsets."""
    for kind, more in (("punch", ""), ("punch", "quarter = 5"), ("die", ""), ("die", "quarter = 5"), ("holder", "")):
        shape, bez = folder / "box.shape", folder / "box.bez"
        shape.write_text(BOXES.format(kind=kind, more=more))
        for offset in (0.0, 1.5, -1.5):
            said = convert(shape, bez, "--offset", offset)
            net = read(bez)
            joints, (point, normal) = find_joints(net), points_of(net)
            assert not len(folded(net)) and not len(joints.multiple) and kinks(net, joints).max() < 1e-5, said
            assert (len(joints.free) == 8) == (kind == "punch" and not more), said
            if kind == "holder":
                assert np.abs(normal - [0, 0, -1]).max() < 1e-9 and np.abs(point[..., 2] + offset).max() < 1e-9
                continue
            distance = box_distance(point, (35, 25), 10, 5, kind)
            assert np.abs(distance - offset)[point[..., 2] > -35].max() < 1e-8, (kind, offset)
            ahead = box_distance(point + 1e-4 * normal, (35, 25), 10, 5, kind)
            assert np.abs(ahead - distance - 1e-4)[np.abs(point[..., 2]) < 39].max() < 1e-6, (kind, offset)
        convert(shape, bez)
        check_program(program, bez, "z_min" if kind == "die" else "z_max", -1 if kind == "die" else 2)
    shape.write_text(BOXES.format(kind="die", more=""))
    assert "leaves nothing of the radius 5" in convert(shape, bez, "--offset", -6, expect=2)


def check_profiles(folder, program):
    """Check extruded and revolved profiles in all axes, their sides and --turn."""
    shape, bez = folder / "profile.shape", folder / "profile.bez"
    for axes in ("x z", "z x", "y z", "z y", "x y", "y x"):
        first, second = ("xyz".index(axis) for axis in axes.split())
        for led in ("extrude = -10 45", "revolve = 0 360", "revolve = 30 -100"):
            shape.write_text(PROFILE.format(axes=axes, led=led))
            convert(shape, bez, "--offset", 1)
            point, normal = points_of(read(bez))
            across = np.delete(point, second, axis=2)
            across = point[..., first] if "extrude" in led else np.linalg.norm(across, axis=2)
            a, h = 30 - across, point[..., second] + 5
            distance = np.where((a > 0) & (h > 0), np.hypot(a, h), np.maximum(a, h)) - 5
            assert np.abs(distance - 1).max() < 1e-8, (axes, led)
            flat = point[..., second] > 1 - 1e-9
            assert (normal[flat][:, second] > 1 - 1e-9).all(), (axes, led)
    shape.write_text(PROFILE.format(axes="x z", led="revolve = 0 360"))
    convert(shape, bez, "--toward", 0, 0, -1)
    assert (points_of(read(bez))[1][..., 2] < 1e-9).all()
    convert(shape, bez, "--toward", 0, 0, 1, "--scale", 2, "--turn")
    point, normal = points_of(read(bez))
    assert (normal[..., 2] < 1e-9).all() and abs(point[..., 0].max() - 160) < 3
    convert(shape, bez)
    check_program(program, bez, "z_min", -1)
    for wrong, said in (("start = 1 1\n extrude = 0 1", "a profile has one start"), ("extrude = 0", "expected 2 numbers"),
                        ("extrude = 0 0", "two different values"), ("", "expected extrude or revolve"),
                        ("line = 70 0 1\n extrude = 0 1", "expected 2 numbers, got '70 0 1'"),
                        ("arc = 90 0 84 1\n extrude = 0 1", "from its centre"), ("bend = 1", "unknown key 'bend'"),
                        ("corner = 80 50 50\n line = 81 50\n extrude = 0 1", "needs")):
        shape.write_text(PROFILE.format(axes="x z", led=wrong))
        assert said in convert(shape, bez, expect=2), wrong


def check_messages(folder):
    """Check what is said of files that are no sources."""
    (folder / "empty.step").write_text("")
    (folder / "part.xyz").write_text("x")
    for words, said in (((folder / "none.step",), "no such file"), ((folder,), "not a file"),
                        ((folder / "empty.step",), "the file is empty"),
                        ((folder / "part.xyz",), "unknown kind of file")):
        assert said in convert(*words, expect=2)
    assert "utils/tool.py" not in subprocess.run([ROOT / "utils" / "tool.py", "--help"], capture_output=True,
                                                 text=True, check=True).stderr


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", required=True)
    program = parser.parse_args().program
    with tempfile.TemporaryDirectory() as name:
        for check in (check_boxes, check_profiles):
            check(Path(name), program)
        check_messages(Path(name))
    print("tool surfaces are right")


if __name__ == "__main__":
    main()
