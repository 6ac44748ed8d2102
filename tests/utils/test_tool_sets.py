# SPDX-License-Identifier: GPL-3.0-or-later
"""Punch, die and holder of a part: against closed forms, choice of faces, offsets with a least radius, refusals."""

import subprocess

import gmsh
import numpy as np
import pytest
from helpers import ROOT, call
from test_tool_surfaces import box_distance, points_of, read

from dd3.tools import cad_file, faces, plane
from dd3.tools.joints import find_joints, folded, kinks
from dd3.tools.solids import edges, wire

THICKNESS, CLEARANCE, SHOULDER, FLANGE = 1.0, 0.2, 4.0, 15.0


@pytest.fixture(scope="module")
def parts(tmp_path_factory):
    """Write the parts: a cup as a sheet, hat profiles, one with a groove, one with a slanted edge, one led along an S
    by sections, a box, a thin plate."""
    folder = tmp_path_factory.mktemp("parts")
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    occ = gmsh.model.occ

    def save(name):
        occ.synchronize()
        gmsh.write(str(folder / f"{name}.step"))
        gmsh.clear()

    def pot(radius, bottom, fillet):
        body = occ.addCylinder(0, 0, bottom, 0, 0, 20, radius)
        occ.fillet([body], edges(lambda ends: ends[5] < bottom + 1e-3), [fillet])
        return (3, body)

    def extruded(name, corners, radius):
        profile = wire(corners, radius)
        occ.extrude(profile, 60, 0, 0)
        occ.remove(profile, recursive=True)
        occ.removeAllDuplicates()
        save(name)

    with cad_file.silence():
        occ.cut([pot(21, 0, 6)], [pot(20, 1, 5)])
        save("cup")
        extruded("groove", [(-25, 20), (-25, 0), (-8, 0), (0, 8), (8, 0), (25, 0), (25, 20)], 1.5)
        extruded("flat", [(-20, 0), (20, 0)], 1.0)
        extruded("hat", [(-30, 16), (-20, 0), (20, 0), (30, 16)], 5)
        occ.importShapes(str(folder / "hat.step"), highestDimOnly=False)
        shell = occ.getEntities(2)
        cutter = [(3, occ.addBox(-20, -50, 12, 100, 100, 60))]
        occ.rotate(cutter, 30, 0, 12, 0, 1, 0, np.arctan(0.05))
        occ.cut(shell, cutter)
        save("slanted")
        sections = []
        for x in np.linspace(-90, 90, 7):
            profile = wire([(-15 - 2 * np.sin(x / 40), 30), (-15, 0), (15, 0), (15, 30)], 5)
            occ.translate(profile, x, 12 * np.tanh(x / 30), 2 * np.sin(x / 50))
            sections.append(occ.addWire([curve for _, curve in profile]))
        occ.addThruSections(sections, makeSolid=False)
        save("led")
        occ.addBox(-30, -20, 0, 60, 40, 20)
        save("box")
        occ.addBox(0, 0, 0, 20, 20, 0.5)
        save("plate")
    gmsh.finalize()
    return folder


def made(parts, name, target, *words, **more):
    """Make the tools of a part; return what is said."""
    return call("tool", parts / f"{name}.step", target, "--thickness", THICKNESS, "--clearance", CLEARANCE,
                "--shoulder", SHOULDER, "--flange", FLANGE, *words, **more)


@pytest.mark.slow
def test_cup(parts, tmp_path, program):
    """Check the tools of a round cup against closed forms, and that the program takes them."""
    for side in ("punch", "die"):
        target = tmp_path / side
        said = made(parts, "cup", target, "--side", side)
        # The sheet of the part is 1 mm thick, the gap 1.2 mm.
        inner, bottom = (20, 5) if side == "punch" else (19.8, 4.8)
        outer, round_off = inner + 1.2, bottom + 1.2
        point, normal = points_of(read(target / "die.bez"), 5)
        r, z = np.hypot(point[..., 0], point[..., 1]), point[..., 2]
        bottom_z = z.min()
        wall = np.where(z > bottom_z + round_off, r - outer,
                        np.where(r < outer - round_off, bottom_z - z,
                                 np.hypot(r - outer + round_off, z - bottom_z - round_off) - round_off))
        over = np.hypot(r - outer - SHOULDER, z + SHOULDER) - SHOULDER
        off = np.where(z < -SHOULDER, wall, np.where(r < outer + SHOULDER, over, z))
        assert np.abs(off).max() < 0.002, (side, np.abs(off).max())
        assert abs(point[..., :2].max() - outer - SHOULDER - FLANGE) < 0.3 and normal[z > -1e-9][:, 2].min() > 0.999
        point, normal = points_of(read(target / "punch.bez"), 5)
        r, z = np.hypot(point[..., 0], point[..., 1]), point[..., 2] - THICKNESS
        off = np.where(z > bottom, r - inner, np.where(r < inner - bottom, -z, np.hypot(r - inner + bottom, z - bottom)
                                                       - bottom))
        assert np.abs(off).max() < 0.002 and normal[z < 1e-6][:, 2].max() < -0.999, (side, np.abs(off).max())
        point, normal = points_of(read(target / "holder.bez"), 5)
        assert np.abs(point[..., 2] - THICKNESS).max() < 1e-9 and normal[..., 2].max() < -0.999
        assert np.hypot(point[..., 0], point[..., 1]).min() > outer - 0.002
        # At the end of the travel the gap is left between punch and die.
        travel = float(said.split("travel")[1].split()[0])
        assert abs(THICKNESS - travel - 1.2 - bottom_z) < 1e-3, (side, travel, bottom_z)
        (tmp_path / "my material.dat").write_text("*MATERIAL own\n  young = 2e5\n  poisson = 0.3\n  yield = von_mises\n"
                                                  "  hardening = perfect Y0=200\n")
        made(parts, "cup", target, "--side", side, "--material", tmp_path / "my material.dat")
        done = subprocess.run([program, "--check", target / "draw.dat"], capture_output=True, text=True, check=False)
        assert done.returncode == 0 and done.stdout.count(" 0 near misses, 0 T-junctions") == 3, done.stdout


def test_walls(parts, tmp_path):
    """Check that walls with a slanted edge are continued in their planes to a level shoulder."""
    said = made(parts, "slanted", tmp_path / "tools")
    assert "continued up to" in said, said
    for name, gap in (("punch", 0.0), ("die", THICKNESS + CLEARANCE)):
        point, _ = points_of(read(tmp_path / "tools" / f"{name}.bez"), 5)
        y, z = np.abs(point[..., 1]), point[..., 2] - point[..., 2].min()
        # From the profile's corner at (20, 0), moved by the gap.
        slope = np.array([10, 16]) / np.hypot(10, 16)
        across = (y - 20) * slope[1] - (z - gap) * slope[0]
        wall = (z > 5) & (z < z.max() - SHOULDER - 2.0)
        assert wall.any() and np.abs(across[wall] - gap).max() < 0.002, (name, np.abs(across[wall] - gap).max())
    top = points_of(read(tmp_path / "tools" / "die.bez"), 5)[0]
    assert np.abs(top[np.abs(top[..., 1]) > 45][:, 2]).max() < 1e-9


def test_least_radius(parts, tmp_path):
    """Check an offset across a groove that is too narrow for it: the ball's arc between the planes."""
    said = call("tool", parts / "groove.step", tmp_path / "die.bez", "--toward", 0, 0, -1, "--offset", 1.8, "--radius",
                0.8, "--turn")
    assert "least radius 0.8 mm in place of smaller ones: face" in said, said
    net = read(tmp_path / "die.bez")
    assert not len(folded(net)) and kinks(net, find_joints(net)).max() < 0.5
    y, z = (points_of(net, 7)[0][..., axis] for axis in (1, 2))
    # The planes through (0, 8) at 45 degrees, 1.8 mm below; the ball's centre is 2.6 mm below both.
    top = 8 - np.sqrt(2) * 2.6
    arc = (np.abs(y) < 0.8 / np.sqrt(2)) & (z > 2)
    planes = (np.abs(y) > 0.8 / np.sqrt(2)) & (np.abs(y) < 4) & (z > 0)
    assert arc.any() and np.abs(np.hypot(y, z - top) - 0.8)[arc].max() < 0.002
    assert planes.any() and np.abs((8 - np.abs(y) - z) / np.sqrt(2) - 1.8)[planes].max() < 0.002


def test_sharp_edges(parts, tmp_path):
    """Check the rounding of a box: arcs at the edges, parts of spheres at the corners; faces of a solid know their
    sides, and the length of a direction does not matter."""
    said = call("tool", parts / "box.step", tmp_path / "punch.bez", "--toward", 0, 0, -0.01, "--radius", 4)
    assert "sharp edges rounded by 4 mm" in said and "turned" not in said and "left out: 1 face" in said, said
    net = read(tmp_path / "punch.bez")
    assert not len(folded(net)) and kinks(net, find_joints(net)).max() < 0.5
    point, normal = points_of(net, 5)
    distance = box_distance(point, (30, 20), 4, 4, "punch")
    inner = point[..., 2] < 18
    assert np.abs(distance[inner]).max() < 0.002, np.abs(distance[inner]).max()
    ahead = box_distance(point + 1e-3 * normal, (30, 20), 4, 4, "punch")
    assert (ahead - distance)[inner].min() > 0.99e-3
    target = tmp_path / "tools"
    assert "choose those that one tool touches by --faces" in made(parts, "box", target, expect=2)
    floor = next(number for number in range(1, 7)
                 if "z 0 to 0 mm" in call("tool", parts / "box.step", "--faces", number))
    lid = next(number for number in range(1, 7)
               if "z 20 to 20 mm" in call("tool", parts / "box.step", "--faces", number))
    chosen = [number for number in range(1, 7) if number not in (floor, lid)]
    made(parts, "box", target, "--radius", 3, "--faces", floor, *chosen)
    point, _ = points_of(read(target / "punch.bez"), 5)
    point[..., 2] -= THICKNESS
    inner = point[..., 2] < 18
    assert np.abs(box_distance(point, (30, 20), 3, 3, "punch")[inner]).max() < 0.002
    assert not len(folded(read(target / "die.bez")))


def test_patches(parts, tmp_path):
    """Check that a long face is divided along its curved edges only."""
    said = call("tool", parts / "led.step", tmp_path / "led.bez", "--toward", 0, 0, -1)
    count = int(said.split("made of")[1].split()[0])
    assert 300 < count < 1200, said


def test_faces(parts, tmp_path):
    """Check the choice of faces."""
    # The floor inside the cup is the last face that OpenCASCADE makes.
    floor = 7
    assert "z 1 to 1 mm" in call("tool", parts / "cup.step", "--faces", floor)
    side = call("tool", parts / "cup.step", "--faces", floor, "--smooth")
    assert "x -20 to 20" in side and "z 1 to 20 mm" in side, side
    # Edges that are near each other because the faces between them were left out are no gaps.
    assert "left out: 2 faces" in call("tool", parts / "plate.step", tmp_path / "plate.bez", "--toward", 1, 1, 0)
    assert (tmp_path / "plate.bez").exists()
    assert "there are 1-7" in call("tool", parts / "cup.step", "--faces", "8-9", expect=2)
    assert "numbers and ranges" in call("tool", parts / "cup.step", "--faces", "x", expect=2)
    assert faces.numbers_of(["3", "5-7,9"]) == [3, 5, 6, 7, 9] and faces.spans([1, 2, 3, 7]) == "1-3 7"


def test_refusals(parts, tmp_path):
    """Check what is said of parts and options that make no tools; no tools are written."""
    target = tmp_path / "tools"
    assert "flat: nothing is to be formed" in made(parts, "flat", target, expect=2)
    said = made(parts, "hat", target, "--rotate", 1, 0, 0, 180, expect=2)
    assert "no free edge of the part climbs" in said and "open towards +z: --toward 0 0 1" in said, said
    assert "with --thickness a folder" in made(parts, "hat", tmp_path / "die.bez", expect=2)
    assert "--toward and --rotate" in made(parts, "hat", target, "--toward", 0, 0, 1, "--rotate", 1, 0, 0, 9, expect=2)
    assert "--offset is for one tool" in made(parts, "hat", target, "--offset", 1, expect=2)
    assert "no such file" in made(parts, "hat", target, "--material", "none.dat", expect=2)
    assert "--thickness takes CAD" in call("tool", ROOT / "input_files" / "rail" / "die.shape", "--thickness", 1,
                                           expect=2)
    for words in (("--smooth",), ("--side", "die"), ("--clearance", 0.1)):
        assert "goes with" in call("tool", parts / "hat.step", *words, expect=2)
    assert sorted(path.name for path in target.iterdir()) == ["part.png", "part.txt"]
    square = np.array([[0, 0], [1, 1], [1, 0], [0, 1]], float)
    assert plane.crosses(square) and not plane.crosses(square[[0, 2, 1, 3]])
    assert plane.inside(np.array([[0.5, 0.5], [2, 0.5]]), square[[0, 2, 1, 3]]).tolist() == [True, False]
