# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading of the set of parts: what is found of each, against what a die engineer says of it."""

import colorsys
import subprocess
import sys

import matplotlib.image
import numpy as np
import pytest
from helpers import ROOT, call
from part_set import PARTS, block, edges, outline, pocket, polygon, strip, write
from scipy.spatial.transform import Rotation

from dd3.gmsh_session import session
from dd3.part.picture import BACK, LEVEL, WALLS
from dd3.part.reading import Request, read_part
from dd3.part.shape import angle_between
from dd3.part.units import unit_of_iges

# Angle up to which a direction is the expected one, degrees: that of a bracket is not unique.
NEAR = 50.0


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Write the parts."""
    folder = tmp_path_factory.mktemp("parts")
    write(folder)
    return folder


def reading_of(folder, name, **more):
    """Return the reading of a part."""
    with session() as gmsh:
        return read_part(gmsh, Request(folder / f"{name}.{PARTS[name].ending}", **more))


@pytest.mark.parametrize("name", PARTS)
def test_set(folder, name):
    """Check the reading of a part."""
    part, reading = PARTS[name], reading_of(folder, name)
    faults = " ".join(fault.text for fault in reading.faults)
    assert reading.unit == part.unit
    if part.kind == "several":
        assert f"{len(reading.parts)} parts" in faults and reading.direction is None
        return
    flat = part.kind == "flat"
    assert reading.sheet.kind == ("sheet" if flat else part.kind) and reading.flat == flat
    if part.thickness is None:
        assert reading.sheet.thickness is None
    else:
        assert abs(reading.sheet.thickness / part.thickness - 1) < 1e-4
        # The lower side of the island tray has a ring beside the sharp edge of the island.
        assert abs(len(reading.sheet.sides[0]) - len(reading.sheet.sides[1])) == (name == "island_tray")
    if part.kind == "flat":
        assert "flat: nothing is to be formed" in faults
    elif part.toward is None:
        assert "undercut at faces" in faults and "not in one stroke from any direction" in faults
        assert reading.faults[0].faces and not reading.best.free
    else:
        assert not reading.faults
        assert angle_between(reading.direction.vector, np.array(part.toward, float)) < NEAR
        assert not reading_of(folder, name, toward=part.toward).faults
    assert bool(reading.bends) == part.bent
    assert len(reading.holes) == part.holes and len(reading.notches) == part.notches
    assert len(reading.symmetry) == part.symmetry
    if part.radius is not None:
        assert abs(reading.inner_radius[0] - part.radius) < 1e-3 * max(part.radius, 1)


def test_turned(tmp_path):
    """Check that parts that lie obliquely in the file are read alike, and their directions turn with them."""
    names = ("hat", "tray", "wall_hole_tray", "arched_rail", "milled", "lipped_channel")
    axis, angle = (0.6, 0.0, 0.8), 2.1
    write(tmp_path, names, (*axis, angle))
    turn = Rotation.from_rotvec(angle * np.array(axis))
    for name in names:
        part, reading = PARTS[name], reading_of(tmp_path, name)
        assert (reading.sheet.kind, bool(reading.bends), len(reading.holes)) == (part.kind, part.bent, part.holes), name
        assert reading.sheet.thickness is part.thickness or abs(reading.sheet.thickness / part.thickness - 1) < 1e-4
        assert bool(reading.faults) == (part.toward is None), (name, reading.faults)
        if part.toward:
            assert angle_between(reading.direction.vector, turn.apply(part.toward)) < 0.1, name


def test_examples(tmp_path):
    """Check the parts of input_files."""
    subprocess.run([sys.executable, ROOT / "input_files" / "parts" / "step_files.py", tmp_path], check=True)
    for name, kind, thickness in (("rail", "surface", None), ("cup", "sheet", 1.0), ("panel", "block", None)):
        with session() as gmsh:
            reading = read_part(gmsh, Request(tmp_path / f"{name}.step"))
        assert reading.sheet.kind == kind and reading.direction.words == "+z" and not reading.faults, name
        assert reading.sheet.thickness is thickness or abs(reading.sheet.thickness - thickness) < 1e-4, name


def shown(path, colour):
    """Return the fractions of both views of a part's picture that have the hue of a colour, in any light."""
    pixels = matplotlib.image.imread(path)[..., :3]
    hue = colorsys.rgb_to_hsv(*colour)[0]
    saturated = np.ptp(pixels, axis=2) > 0.15 * pixels.max(axis=2)
    red, green, blue = np.moveaxis(pixels, 2, 0)
    angle = np.arctan2(np.sqrt(3) * (green - blue), 2 * red - green - blue) / (2 * np.pi)
    near = saturated & (np.abs((angle - hue + 0.5) % 1 - 0.5) < 0.03)
    return [view.mean() for view in np.array_split(near, 2, axis=1)]


def test_command(folder, tmp_path):
    """Check the table and the picture of the command, also of a part that cannot be drawn, and its messages."""
    said = call("part", folder / "hat.step", tmp_path / "hat")
    assert "sheet of 1.2 mm" in said and "from +z: no undercut, least draft 10 degrees" in said, said
    walls, level, back = (shown(tmp_path / "hat" / "part.png", colour) for colour in (WALLS, LEVEL, BACK))
    assert min(walls) > 0.02 and min(level) > 0.1 and max(back) == 0, (walls, level, back)
    rows = (tmp_path / "hat" / "part.txt").read_text().splitlines()
    assert sum(" upper " in row for row in rows) == 9 and any("flange" in row for row in rows)
    said = call("part", folder / "lipped_channel.step", tmp_path / "lipped", expect=2)
    assert "not in one stroke from any direction; from +z they are" in said, said
    assert "bent along 4 straight lines" in said, said
    assert max(shown(tmp_path / "lipped" / "part.png", BACK)) > 0.02
    said = call("part", folder / "leaning_tray.step", tmp_path / "leaning", "--toward", 0, 0, 1, expect=2)
    assert "undercut at faces" in said and "from 0 0.1822 0.9833 there is none" in said, said
    said = call("part", folder / "tray.step", tmp_path / "tray", "--thickness", 0.8)
    assert "the sheet of the file is 1 mm thick, --thickness 0.8 was given" in said, said
    said = call("part", folder / "unitless_inch_tray.brep", tmp_path / "inch")
    assert "--scale 25.4" in said and "0.914 mm thick" in said, said
    said = call("part", folder / "two_angles.step", tmp_path / "two", "--part", 2)
    assert "sheet of 1 mm" in said, said


def test_gaps(tmp_path):
    """Check that faces that are not joined are refused, with their edges in the picture."""
    import gmsh
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.occ.addRectangle(0, 0, 0, 40, 30)
    gmsh.model.occ.addRectangle(40.1, 0, 0, 40, 30)
    gmsh.model.occ.synchronize()
    gmsh.write(str(tmp_path / "gap.step"))
    gmsh.finalize()
    said = call("part", tmp_path / "gap.step", tmp_path / "gap", expect=2)
    assert "free edges of the CAD up to 0.1 mm apart" in said and "--sew" in said, said
    assert min(shown(tmp_path / "gap" / "part.png", (0.84, 0.15, 0.16))) > 0.0005  # lines along the gap
    assert "no such file" in call("part", "none.step", expect=2)
    (tmp_path / "damaged.step").write_text("ISO-10303-21;\n")
    assert "error" in call("part", "damaged.step", expect=2)


def test_gaps_at_both_sides(tmp_path):
    """Check that gaps at all edges of a sheet are told by the nearest edges, not by those at the distance of the
    thickness, that no undercut is told before they are joined, and that the distance that is told joins them."""
    def loose(occ):
        pocket((40, 30), 16, 1, 9, 5)
        occ.synchronize()
        occ.remove(occ.getEntities(3))
        faces = occ.getEntities(2)
        for number, face in enumerate(faces):
            copied = occ.copy([face])
            if number % 2:
                occ.translate(copied, 0.004, 0.003, 0.004)
        occ.remove(faces, recursive=True)

    reading = read_made(tmp_path, loose)
    assert len(reading.faults) == 1 and "--sew 0.0075 joins them" in reading.faults[0].text, reading.faults
    with session() as gmsh:
        reading = read_part(gmsh, Request(tmp_path / "part.step", sew=0.0075))
    assert not reading.faults and abs(reading.sheet.thickness - 1) < 0.01


def test_units():
    """Check the unit of IGES files."""
    text = "1H,,1H;,4HPART,6Hp.igs ,3HCAD,1H1,32,38,6,308,15,4HPART,1.0,1,4HINCH,1,0.01;"
    lines = [text[k:k + 72].ljust(72) + f"G{k // 72 + 1:7d}" for k in range(0, len(text), 72)]
    assert unit_of_iges(lines) == "inch"
    assert unit_of_iges([line.replace(",1,4HINCH", ",2,2HMM  ") for line in lines]) == "mm"
    assert unit_of_iges([]) == "none"


@pytest.mark.slow
def test_tools(folder, tmp_path):
    """Check what `dd3 tool` takes from the reading of a part: thickness, direction, refusals before any tool is made."""
    said = call("tool", folder / "tilted_tray.step", tmp_path / "tilted", "--shoulder", 4, "--flange", 15)
    assert "sheet of 1 mm" in said and "turned: 0.2396 -0.5115 0.8252 becomes +z" in said, said
    assert "thickness = 1" in (tmp_path / "tilted" / "draw.dat").read_text()
    assert (tmp_path / "tilted" / "part.png").exists()
    # A flange whose border has chords of 30 degrees.
    said = call("tool", folder / "inch_tray.step", tmp_path / "inch")
    assert said.count("folds      0") == 3 and "thickness = 0.9144" in (tmp_path / "inch" / "draw.dat").read_text()
    said = call("tool", folder / "tray.step", tmp_path / "tray", "--toward", 0, 0, 1, "--shoulder", 4, "--flange", 15)
    assert "turned" not in said and "drawing ratio" not in said, said
    said = call("tool", folder / "cup_with_holes.step", tmp_path / "cup")
    assert "shoulder of 4 mm and margin of 2 mm, as the drawing ratio is 2.1" in said and "warning" in said, said
    said = call("tool", folder / "cup_with_holes.step", tmp_path / "cup", "--margin", 5)
    assert "shoulder of 4 mm and margin of 5 mm" in said, said
    for name, reason in (("lipped_channel", "not in one stroke from any direction"),
                         ("plate", "nothing is to be formed"), ("s_rail", "give the thickness"),
                         ("two_angles", "2 parts"),
                         ("milled", "no two sides at one distance: give the thickness")):
        assert reason in call("tool", folder / f"{name}.step", tmp_path / name, expect=2)
        assert not (tmp_path / name / "punch.bez").exists()


def read_made(folder, maker, **more):
    """Return the reading of a part that a procedure makes."""
    with session() as gmsh:
        maker(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.write(str(folder / "part.step"))
        gmsh.clear()
        return read_part(gmsh, Request(folder / "part.step", **more))


def test_flat_plates(tmp_path):
    """Check that a plate with an arm as wide as it is thick, and one with countersinks on one side, are flat."""
    def comb(occ):
        plate = occ.addBox(0, 0, 0, 40, 12, 2)
        occ.cut([(3, plate)], [(3, occ.addBox(x, 6, -1, 5, 10, 4)) for x in (10, 17)])

    def countersunk(occ):
        plate = occ.addBox(0, 0, 0, 40, 30, 3)
        occ.cut([(3, plate)], [(3, occ.addCone(x, 15, 1.5, 0, 0, 2, 1, 4)) for x in (10, 30)])

    for maker in (comb, countersunk):
        reading = read_made(tmp_path, maker)
        assert reading.flat and [fault.text for fault in reading.faults] == ["the part is flat: nothing is to be formed"]


def test_bar(tmp_path):
    """Check that a round bar is a block without walls."""
    reading = read_made(tmp_path, lambda occ: occ.addCylinder(0, 0, 0, 0, 0, 80, 4))
    assert reading.sheet.kind == "block" and not reading.sheet.walls


def test_equal_fillets(tmp_path):
    """Check that fillets with the same radius on both sides, where the sheet is 1.42 mm thick, are of its sides."""
    def pan(occ):
        corners, _ = outline([(0, 0), (40, 0), (43, 25), (60, 25)], 1, 4)
        face = polygon(corners, [0, 4, 4, 0, 0, 4, 4, 0], lambda r, z: (r, 0, z))
        occ.revolve([(2, face)], 0, 0, 0, 0, 0, 1, 2 * np.pi)
        occ.remove([(2, face)], recursive=True)

    reading = read_made(tmp_path, pan)
    assert [len(side) for side in reading.sheet.sides] == [5, 5] and len(reading.sheet.rims) == 1
    assert "flange" in {role.name for role in reading.roles.values()} and not reading.holes


def test_rounded_rims(tmp_path):
    """Check that the roundings of the rims of a hat are rims, and that its sides are those of a sharp one."""
    def hat(occ):
        body = strip([(-45, 25), (-29, 25), (-25, 0), (25, 0), (29, 25), (45, 25)], 2, 4, 80)
        rim = edges(lambda b: b[3] - b[0] > 79 and min(abs(b[1]), abs(b[4])) > 44.9)
        occ.fillet([body[0][1]], rim, [0.95])

    reading = read_made(tmp_path, hat)
    assert [len(side) for side in reading.sheet.sides] == [9, 9] and len(reading.sheet.rims) == 8


def test_corrugated(tmp_path):
    """Check that the crests of a corrugated sheet between its flanges are islands."""
    path = [(-60, 0), *((y + dy, z) for y in (-60, -22, 16) for dy, z in ((10, 0), (14, 8), (24, 8), (28, 0))), (60, 0)]
    reading = read_made(tmp_path, lambda occ: strip(path, 0.7, 2, 80))
    names = [role.name for role in reading.roles.values()]
    assert reading.direction.words == "-z" and names.count("flange") == 2 and names.count("island") == 2, names


def test_curved_flange(tmp_path):
    """Check that a flange on a cylinder, whose middle is below that of the shoulders beside it, is a flange."""
    def panel(occ):
        bent = occ.cut([(3, occ.addCylinder(0, -55, -300, 0, 110, 0, 301))],
                       [(3, occ.addCylinder(0, -55, -300, 0, 110, 0, 300))])[0]
        sheet = occ.intersect(bent, [(3, occ.addBox(-75, -55, -60, 150, 110, 90))])[0]
        cup = occ.intersect([(3, block((-40, -28, -22), (80, 56, 60), 12, 5))],
                            [(3, occ.addCylinder(0, -80, -300, 0, 160, 0, 300.5))])[0]
        body = occ.cut(occ.fuse(sheet, cup)[0], [(3, block((-39, -27, -21), (78, 54, 60), 11, 4))])[0]
        for away, radius in ((39.5, 3.0), (40.5, 4.0)):
            rim = edges(lambda b, away=away: b[2] > -4 and b[5] - b[2] < 5 and max(-b[0], b[3]) < away
                        and max(-b[1], b[4]) < away - 12)
            body = occ.fillet([body[0][1]], rim, [radius])

    reading = read_made(tmp_path, panel)
    flange = [tag for tag, role in reading.roles.items() if role.name == "flange"]
    assert len(flange) == 1 and reading.shape.areas[flange[0]] > 1e4, reading.roles


def test_refused_direction(folder, tmp_path):
    """Check that a refusal names faces, fraction and direction of one reading, the best one without --toward."""
    said = call("part", folder / "lipped_channel.step", tmp_path, expect=2).split("error: ")[1]
    assert said == call("tool", folder / "lipped_channel.step", tmp_path, expect=2).split("error: ")[1]
    given = call("tool", folder / "lipped_channel.step", tmp_path, "--toward", 0, 1, 0, expect=2).split("error: ")[1]
    assert "from +y they are" in given, given
