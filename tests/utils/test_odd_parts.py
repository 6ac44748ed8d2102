# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts with a pole, with low steps, with an inclined open rim; a flange of the die that is too narrow for the blank."""
import math

import gmsh
import numpy as np
import pytest
from helpers import call
from part_set import pocket, turned_solid

from dd3.gmsh_session import session
from dd3.part.reading import Request, read_part
from dd3.tools.cad_file import silence
from dd3.tools.set_blank import Blank
from dd3.tools.surface import Surface
from dd3.tools.solids import edges

occ = gmsh.model.occ
BOX = (-100, -100)


def made(path, make):
    """Write a part as STEP."""
    with session(), silence():
        make()
        occ.synchronize()
        gmsh.write(str(path))
    return path


def dome():
    """Make a spherical cap of radius 60 and 25 mm deep, with a flange: its faces meet at the pole of the sphere."""
    body = occ.intersect([(3, occ.addSphere(0, 0, 0, 60))], [(3, occ.addBox(*BOX, 35, 200, 200, 100))])[0]
    body = occ.fuse(body, [(3, occ.addCylinder(0, 0, 35, 0, 0, 1, 65))])[0]
    for radius, height in ((4, 36), (5, 35)):
        rim = edges(lambda box, z=height: abs(box[2] - z) < 1e-2 and abs(box[5] - z) < 1e-2 and box[3] < 60)
        body = [occ.fillet([body[0][1]], rim, [radius])[0]]
        if height == 36:
            inner = occ.intersect([(3, occ.addSphere(0, 0, 0, 59))], [(3, occ.addBox(*BOX, 30, 200, 200, 100))])[0]
            body = occ.cut(body, inner)[0]


def low_step(height, letters=False):
    """Make a lid of 0.8 mm with a rectangle, or two letters, raised by less than two thicknesses, walls upright."""
    body = pocket((60, 35), 12, 0.8, 10, 4)
    shapes = ([[(-34, -15, -28, 15), (-30, 9, -14, 15), (-30, -3, -16, 3), (-30, -15, -14, -9)],
               [(5, 9, 33, 15), (16, -15, 22, 12)]] if letters else [[(-20, -10, 20, 10)]])

    def boxes(shape, grown, low, high):
        found = [(3, occ.addBox(x0 - grown, y0 - grown, low, x1 - x0 + 2 * grown, y1 - y0 + 2 * grown, high - low))
                 for x0, y0, x1, y1 in shape]
        return occ.fuse(found[:1], found[1:])[0] if found[1:] else found

    for shape in shapes:
        body = occ.fuse(body, boxes(shape, 0.0, 0, 0.8 + height))[0]
        body = occ.cut(body, boxes(shape, -0.8, -1, height))[0]


def embossing():
    """Make a lid of 0.8 mm with a rectangle raised by 1.2 mm, whose sharp walls lean by 30 degrees."""
    body = pocket((60, 35), 12, 0.8, 10, 4)

    def frustum(a, b, height):
        inset = height * math.tan(math.radians(30))
        rings = []
        for z, by in ((0, 0), (height, inset)):
            face = occ.addRectangle(by - a, by - b, z, 2 * (a - by), 2 * (b - by))
            rings.append(occ.addWire(occ.getCurveLoops(face)[1][0]))
            occ.remove([(2, face)])
        return occ.addThruSections(rings, makeSolid=True, makeRuled=True)

    body = occ.fuse(body, frustum(20, 10, 2))[0]
    by = 0.8 / math.cos(math.radians(30))
    occ.cut(body, frustum(20 - by, 10 - by, 1.2))


def scoop():
    """Make half a tray, open at one end, whose rim is inclined by 8 degrees."""
    body = occ.cut(pocket((50, 30), 24, 1, 10, 5), [(3, occ.addBox(10, -50, -5, 100, 100, 60))])[0]
    above = occ.addBox(-200, -200, 0, 400, 400, 100)
    occ.rotate([(3, above)], 0, 0, 0, 0, 1, 0, math.radians(8))
    occ.translate([(3, above)], 0, 0, 18)
    occ.cut(body, [(3, above)])


def test_pole(tmp_path):
    """Check that the blank of a cap is that of its area: 2 pi R h of the cap, and the flange."""
    said = call("tool", made(tmp_path / "dome.step", dome), tmp_path / "tools", "--margin", "5")
    assert "not estimated" not in said and "warning" not in said, said
    area = float(said.split("mm, ")[1].split(" mm2")[0])
    # The middle of the sheet, less what the fillet between cap and flange saves.
    angle, rim = math.acos(35.5 / 59.5), math.sqrt(59.5**2 - 35.5**2)
    fillet = 2 * math.pi * rim * 4.5 * (2 * math.tan(angle / 2) - angle)
    covered = 2 * math.pi * 59.5 * (59.5 - 35.5) + math.pi * (65**2 - rim**2) - fillet
    assert area == pytest.approx(math.pi * (math.sqrt(covered / math.pi) + 5)**2, rel=0.01)


@pytest.mark.parametrize("height, letters", [(0.5, False), (1.2, False), (1.2, True), (3.0, False)])
def test_low_steps(tmp_path, height, letters):
    """Check that the walls of a low step are of the sides of the sheet, which has one rim and no opening."""
    part = made(tmp_path / "lid.step", lambda: low_step(height, letters))
    with session():
        found = read_part(gmsh, Request(part))
    assert len(found.sheet.rims) == 1 and not found.holes, (found.sheet, found.holes)
    assert found.sheet.thickness == pytest.approx(0.8)


def test_low_step_is_refused(tmp_path):
    """Check that a low step whose edges cannot be rounded is refused for that reason."""
    part = made(tmp_path / "lid.step", lambda: low_step(1.2, True))
    said = call("tool", part, tmp_path / "tools", expect=2)
    assert "cannot be rounded by up to 1.68 mm" in said and "lanced" not in said


def test_pad_under_an_inclined_blank(tmp_path, program):
    """Check that a pad under an inclined blank starts below it."""
    part = made(tmp_path / "scoop.step", scoop)
    said = call("tool", part, tmp_path / "tools", "--program", program)
    assert "pad" in said and "error" not in said, said


def fender():
    """Make a curved sheet with a feature line, whose slopes at its rim are below 30 degrees and change along it."""
    x, y = np.linspace(-90, 90, 13), np.linspace(-60, 60, 11)
    occ.addBSplineSurface([occ.addPoint(a, b, 0.9 * (30 - 0.0022 * a * a - 0.004 * b * b + 3 * math.sin(a / 30)
                                                     + 8 / (1 + math.exp(-(b - 10 - a / 10) / 6))))
                           for b in y for a in x], 13)


def test_binder_that_folds(tmp_path):
    """Check that a shallow part around which a binder would fold is formed without one."""
    said = call("tool", made(tmp_path / "fender.step", fender), tmp_path / "tools", "--thickness", "0.8")
    assert "none, as the binder around the part would fold" in said and not (tmp_path / "tools" / "holder.bez").exists()


def test_flange(tmp_path):
    """Check that a flange of the die that cuts off the blank is warned of, with the one that leaves it whole."""
    part = made(tmp_path / "pan.step", lambda: turned_solid([(0, 0), (30, 0), (33, 20), (45, 20)], 1, 4))
    said = call("tool", part, tmp_path / "tools", "--flange", "2")
    assert "--flange: the blank is cut off at the border of the die, by up to " in said, said
    least = said.split("by up to ")[1].split()[2]
    assert "cut off" not in call("tool", part, tmp_path / "tools", "--flange", least)


def test_pressed():
    """Check the area in plan of a paraboloid over a blank that covers all of it."""
    t = np.linspace(-1, 1, 3)
    net = np.array([[[20 * u, 10 * v, 5 * u * v, 1.0] for u in t] for v in t])[None]
    blank = Blank(np.array([[-30.0, -30], [30, -30], [30, 30], [-30, 30]]), False)
    assert blank.pressed(Surface(net, np.zeros(1, int), ["face"])) == pytest.approx(800.0, rel=1e-12)


def test_fillets_that_overlap(tmp_path):
    """Check that fillets too large for the wall between them are refused: along a wall of 1.2 / cos(30) mm they take
    (0.8 + 1.68) tan(30) mm."""
    path = made(tmp_path / "lid.step", embossing)
    said = call("tool", path, tmp_path / "set", "--thickness", 0.8, expect=2)
    assert "cannot be rounded by 0.8 and 1.68 mm, as the fillets of neighbouring ones overlap" in said, said
