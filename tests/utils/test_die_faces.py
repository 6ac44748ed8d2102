# SPDX-License-Identifier: GPL-3.0-or-later
"""Die faces of parts: punch and die against both sides of the part, the binder, joints and folds, choices and refusals."""

import gmsh
import numpy as np
import pytest
from helpers import call
from part_set import PARTS, block, edges, occ, pocket, write
from scipy.spatial import cKDTree
from test_tool_surfaces import points_of, read

from dd3.curve import read_curves
from dd3.errors import Problem
from dd3.gmsh_session import session
from dd3.part.reading import Request, read_part
from dd3.tools import binder, mitres
from dd3.tools.binder import developable, inclined, level, of_points
from dd3.tools.cad_file import silence
from dd3.tools.die_face import Reach, goes_around, strip, width_of
from dd3.tools.joints import find_joints, folded, kinks
from dd3.tools.patch_distance import Distance
from dd3.tools.plane import area_of, chords, crosses
from dd3.tools.rims import Rim, along_edges, find_rims
from dd3.tools.settings import ToolSettings
from dd3.tools.surface import Surface, from_nodes
from dd3.tools.tool_set import refuse_apart

NAMES = ["hat", "pan", "sharp_hat", "stepped_hat", "z_section"]
SLOW = ["saddle_tray", "own_flange", "flanged_cover", "island_tray", "sharp_tray", "arched_rail", "s_rim_tray"]
CLEARANCE = 0.1


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Write the parts."""
    folder = tmp_path_factory.mktemp("die_faces")
    write(folder, [*NAMES, *SLOW, "crowned_block", "milled"])
    with session(), silence():
        for name, make in (("mitred_tray", lambda: pocket((40, 30), 20, 1, 0, 5)), ("mitred_flange", mitred_flange)):
            make()
            occ.synchronize()
            gmsh.write(str(folder / f"{name}.step"))
            gmsh.clear()
    return folder


def mitred_flange():
    """Make a tray with a flange whose fillets at floor and shoulder end in mitres."""
    cavity, outer = block((-40, -30, -20), (80, 60, 20), 0, 5), block((-41, -31, -21), (82, 62, 21), 0, 6)
    plate = block((-54, -44, -1), (108, 88, 1), 12, 0)
    body = occ.cut([occ.fuse([(3, plate)], [(3, outer)])[0][0]], [(3, cavity)])[0][0][1]
    for height, half, radius in ((0, 41, 4), (-1, 42, 3)):
        ring = edges(lambda b, height=height, half=half: max(abs(b[2] - height), abs(b[5] - height)) < 1e-3
                     and max(abs(b[0]), abs(b[3])) < half and max(abs(b[1]), abs(b[4])) < half - 10)
        body = occ.fillet([body], ring, [radius])[0][1]


def sampled(path, toward):
    """Return the reading of a part, the least height of its upper side, points of the faces of this, away from sharp
    edges, with the role of each, and points of its lower side, in the frame of the press."""
    with session() as gmsh:
        reading = read_part(gmsh, Request(path, toward=toward))
    shape, direction = reading.shape, reading.direction
    turn = np.diag([1, -1, -1]) if toward[2] < 0 else np.eye(3)
    sharp = [number for number, edge in shape.edges.items() if edge.angle
             and set(edge.faces) <= set(reading.sheet.sides[0] + reading.sheet.sides[1])]
    on_edge = np.unique(shape.pieces[np.isin(shape.piece_edge, sharp)])
    points = shape.place @ turn.T
    far = np.ones(len(points), bool)
    if len(on_edge):
        start, end = (shape.nodes[shape.pieces[np.isin(shape.piece_edge, sharp)][:, k]] for k in (0, 1))
        line = np.concatenate([start + t * (end - start) for t in np.linspace(0, 1, 40)])
        far = cKDTree(line).query(shape.place)[0] > 4.0 * reading.sheet.thickness
    upper = np.isin(shape.face, direction.upper)
    rims = np.isin(shape.face, reading.sheet.rims)
    role = np.array([reading.roles[tag].name if tag in reading.roles else "" for tag in shape.face])
    low = (shape.nodes[shape.triangles[upper]] @ turn.T)[..., 2].min()
    return reading, low, points[upper & far], role[upper & far], points[~upper & ~rims & far]


@pytest.mark.parametrize("name", [*NAMES, *(pytest.param(name, marks=pytest.mark.slow) for name in SLOW)])
def test_faces(folder, tmp_path, name):
    """Check punch and die in the closed press against both sides of the part, and the surfaces themselves."""
    toward = (0, 0, -1) if PARTS[name].toward == (0, 0, -1) else (0, 0, 1)
    target = tmp_path / "tools"
    said = call("tool", folder / f"{name}.step", target, "--toward", *toward)
    assert "not estimated" not in said
    # While the holder closes, or first touches, the middle of the blank is held, and no longer.
    deck = (target / "draw.dat").read_text(encoding="utf-8")
    closes = "*PHASE close" in deck or "*PHASE touch" in deck
    assert closes == ("displace = middle x 0" in deck) == ("free = middle x y" in deck)
    travel = float(said.split("travel")[1].split()[0])
    reading, low, upper, role, lower = sampled(folder / f"{name}.step", toward)
    thickness = reading.sheet.thickness
    net = {tool: read(target / f"{tool}.bez") for tool in ("punch", "die", "holder")}
    pad = target / "pad.bez"
    assert pad.exists() == (name == "z_section")
    for own in net.values():
        assert not len(folded(own))
    # A shoulder beside a rim that is not level has a kink where the rim's curvature in plan jumps.
    angle = np.sort(kinks(net["die"], find_joints(net["die"])))
    assert angle[-2] < (2.5 if name in ("s_rim_tray", "saddle_tray") else 1.0), angle[-5:]
    punch = Distance(net["punch"], 1.0)
    # The punch stands on the sheet at the start, at the height of the thickness.
    shift = low - thickness
    touched = ~np.isin(role, ["flange", "shoulder"]) if "flange" in role else np.ones(len(role), bool)
    off = distance(punch, upper[touched] - (0, 0, shift))
    assert off.max() < 0.003, off.max()
    # In the closed press the die is at the gap from the upper side, at the clearance from the lower one.
    down = (0, 0, low - thickness + travel)
    die = Distance(np.concatenate([net["die"], lowered(pad, travel, thickness)]), 1.0)
    gap = thickness * (1 + CLEARANCE)
    assert np.abs(distance(die, upper - down) - gap).max() < 0.003
    assert np.abs(distance(die, lower - down) - CLEARANCE * thickness).max() < 0.003


def distance(surface, points):
    """Return the distances of points from a surface."""
    return np.linalg.norm(surface.nearest(points)[0] - points, axis=1)


def lowered(path, travel, thickness):
    """Return the patches of a pad where the die's floor is, none without one."""
    if not path.exists():
        return np.zeros((0, 3, 3, 4))
    net = read(path)
    net[..., 2] -= (travel + CLEARANCE * thickness) * net[..., 3]
    return net


def test_binders():
    """Check the kinds of binders against points of known surfaces, and what goes on beyond them."""
    x, y = (part.ravel() for part in np.meshgrid(np.linspace(-60, 60, 41), np.linspace(-20, 20, 9)))
    assert of_points(np.stack([x, y, 0 * x + 3], axis=1), 1e-6)[0].kind == "level"
    tilted, _ = of_points(np.stack([x, y, 0.1 * x - 0.05 * y + 2], axis=1), 1e-6)
    assert tilted.kind == "an inclined plane" and np.allclose(tilted.gradient(np.array([[500.0, -300.0]])), [0.1, -0.05])
    # A cylinder about an axis at 30 degrees in plan that rises along it.
    across, along = np.cos(0.5) * x + np.sin(0.5) * y, np.cos(0.5) * y - np.sin(0.5) * x
    arc = np.stack([x, y, np.sqrt(300.0**2 - across**2) - 300 + 0.05 * along], axis=1)
    found, off = of_points(arc, 0.002)
    assert off < 0.002
    assert found.kind == "developable" and abs(found.across @ (np.cos(0.5), np.sin(0.5))) > 1 - 1e-6
    assert abs(found.slope * np.sign(found.across[0]) - 0.05) < 1e-4
    beyond = np.array([np.cos(0.5), np.sin(0.5)]) * np.linspace(50, 200, 601)[:, None]
    step = np.diff(found.z(beyond)) / 0.25
    assert np.abs(np.diff(step)).max() < 1.5 * 0.25 / 300 and np.abs(np.diff(step)[300:]).max() < 1e-12
    slope = (found.gradient(beyond) @ (np.cos(0.5), np.sin(0.5)))
    assert np.abs((slope[1:] + slope[:-1]) / 2 - step).max() < 1e-5
    assert of_points(np.stack([x, y, x * y / 200], axis=1), 0.002)[1] > 1.0
    assert inclined(arc).distance(arc) > found.distance(arc) and level(0.0).z(np.zeros(2)) == 0.0
    assert developable(arc).distance(arc) < 0.1


def test_climbing_ends():
    """Check that an end that climbs by 17 degrees is a rim at which a wall goes on, but the open end of a part with a
    flange beside it is none."""
    x, y = np.meshgrid(np.linspace(0, 10, 3), np.linspace(0, 10, 3))
    surface = Surface(from_nodes(np.stack([x, y, 0.3 * x], axis=-1)[None]), np.zeros(1, int), ["floor"])
    joints = find_joints(surface.net)
    points, _ = along_edges(surface, joints.free)
    beside = joints.free[np.abs(points[..., 1] - 10).max(axis=1) < 1e-9]
    rims, others = find_rims(surface, joints)
    assert others == 3 and len(rims) == 1 and np.allclose(rims[0].points[:, 0], 10)
    assert find_rims(surface, joints, beside) == ([], 3)


def test_apart(tmp_path):
    """Check that a side in two parts is refused, unless the user has chosen its faces."""
    x, y = np.meshgrid(np.linspace(0, 10, 3), np.linspace(0, 10, 3))
    nodes = np.array([np.stack([x + shift, y, 0 * x], axis=-1) for shift in (0, 20)])
    surface = Surface(from_nodes(nodes), np.arange(2), ["face 1 (Plane)", "face 2 (Plane)"])
    (tmp_path / "part.step").write_text("made here")
    options = ToolSettings(tmp_path / "part.step")
    with pytest.raises(Problem, match=r"in 2 parts, which are not joined: face 1 \(Plane\); face 2 \(Plane\)"):
        refuse_apart(surface, options)
    options.faces = ["1-2"]
    refuse_apart(surface, options)


def test_rim_around():
    """Check the strip beside a rim that goes around the half of a rounded rectangle: what is left of the rectangle that
    encloses both, as wide as the blank needs on three sides."""
    turn = np.linspace(0, np.pi / 2, 9)
    lower = np.stack([32 + 8 * np.sin(turn), -22 - 8 * np.cos(turn)], axis=1)
    upper = lower[::-1] * [1, -1]
    lines = [np.linspace(a, b, 9) for a, b in (((0, -30), lower[0]), (lower[-1], upper[0]), (upper[-1], (0, 30)))]
    plan = np.concatenate([lines[0], lower[1:], lines[1][1:], upper[1:], lines[2][1:]])
    points = np.column_stack([plan, np.zeros(len(plan))])
    out = np.zeros_like(points)
    out[0, 1], out[-1, 1] = -1, 1
    reach = Reach(Rim(points, out, out, False, np.zeros(len(points), bool)), level(0.0), points, 0.0)
    assert goes_around(reach)
    blank = np.array([[0, -38], [47, -38], [47, 38], [0, 38]])
    reach.width = width_of(reach, blank, 2.0)
    assert abs(reach.width - 10) < 1e-9
    corner = chords(strip(reach, points))
    inner = area_of(plan[::4])
    assert not crosses(corner) and abs(area_of(corner) - (50 * 80 - inner)) < 1e-6


def test_large_flange(monkeypatch):
    """Check that the search for the rulings of a flange of many points, curved in two directions, takes few of them."""
    sizes, fitted = [], binder.fitted
    monkeypatch.setattr(binder, "fitted", lambda points, *others: sizes.append(len(points)) or fitted(points, *others))
    x, y = (part.ravel() for part in np.meshgrid(np.linspace(-60, 60, 301), np.linspace(-40, 40, 101)))
    _, off = of_points(np.stack([x, y, (x**2 + y**2) / 600], axis=1), 0.002)
    assert off > 0.5 and sum(sizes) < 10 * len(x)


@pytest.mark.slow
def test_choices(folder, tmp_path):
    """Check a least radius for sharp edges, the lower side, the width of the holder, and refusals."""
    said = call("tool", folder / "sharp_tray.step", tmp_path / "round", "--radius", 3)
    assert "sharp edges rounded by 3 mm" in said, said
    call("tool", folder / "own_flange.step", tmp_path / "lower", "--side", "die", "--flange", 5)
    die, holder = read(tmp_path / "lower" / "die.bez"), read(tmp_path / "lower" / "holder.bez")
    # The part's own flange ends 54 mm from the middle; a blank as wide has a margin of the die and the holder.
    assert die[..., 0].max() > 56 and abs(die[..., 0].max() - holder[..., 0].max()) < 1e-6
    said = call("tool", folder / "milled.step", tmp_path / "milled", "--thickness", 1, expect=2)
    assert "of what is seen of the block are left out, faces 3, as" in said, said
    # Both ways out that the message names.
    assert "tool.bez --toward 0 0 1 makes it of all faces" in said and "--faces 3 7-23 takes them too" in said, said
    call("tool", folder / "milled.step", tmp_path / "tool.bez", "--toward", 0, 0, 1)
    said = call("tool", folder / "milled.step", tmp_path / "milled", "--thickness", 1, "--faces", 3, "7-23")
    assert "binder     level, on which the part's own flange lies" in said, said
    assert "sharp edges rounded by 2.1 mm: 8" in said and "shoulder   of the part, radius 1.01 mm" in said, said


@pytest.mark.parametrize(("name", "corner", "radius", "off", "faces"), [
    pytest.param("crowned_block", (60, 45), 6, 2.49, "3 5 7 10", marks=pytest.mark.slow),
    pytest.param("mitred_tray", (39, 29), 4, 1.66, "15-18", marks=pytest.mark.slow)])
def test_mitres(folder, tmp_path, name, corner, radius, off, faces):
    """Check that fillets which end in mitres go round the corners, of a block and inside of a sheet, and that the die
    is at one distance from the punch there."""
    said = call("tool", folder / f"{name}.step", tmp_path, "--thickness", 1, "--clearance", CLEARANCE)
    assert f"fillets of faces {faces}, which end in mitres, led around 4 corners, by {radius} mm: there" in said, said
    assert f"{off} mm off the part's sharp corners" in said and "not estimated" not in said, said
    punch, die = (read(tmp_path / f"{tool}.bez") for tool in ("punch", "die"))
    assert not folded(punch).any() and not folded(die).any()
    points = points_of(punch, 5)[0].reshape(-1, 3)
    over = points[(points[:, :2] > np.array(corner) - radius).all(axis=1)]
    away = np.linalg.norm(over[:, :2] - np.array(corner) + radius, axis=1)
    # Above the fillets the corner is a cylinder, at their lower end the ball is level.
    assert away.max() < radius + 0.01 and away[over[:, 2] > over[:, 2].max() - 1].min() > radius - 0.01
    travel = float(said.split("travel")[1].split()[0])
    closed = over - (0, 0, travel)
    gap = np.linalg.norm(Distance(die, 4.0).nearest(closed[closed[:, 2] < -7])[0] - closed[closed[:, 2] < -7], axis=1)
    assert np.abs(gap - 1 - CLEARANCE).max() < 0.01, (gap.min(), gap.max())
    # No curves are made of a block.
    if name == "mitred_tray":
        punch[..., 2] -= travel * punch[..., 3]
        curve, = read_curves(tmp_path / "trim.txt")
        assert "led over rounded edges, by up to 1.66 mm off the part's" in said, said
        assert np.linalg.norm(Distance(punch, 1.0).nearest(curve)[0] - curve, axis=1).max() < 0.01
        assert np.linalg.norm(np.diff(curve, axis=0), axis=1)[(curve[1:, :2] > (35, 25)).all(axis=1)].max() < 0.3


def test_mitres_at_shoulder(folder, tmp_path):
    """Check that the punch of a part whose shoulder is led around corners too ends at its walls, and the holder with
    one gap around it."""
    said = call("tool", folder / "mitred_flange.step", tmp_path, "--clearance", CLEARANCE)
    assert "fillets of faces 23-26 32-35, which end in mitres, led around 4 corners, by 5 mm" in said, said
    punch, holder = points_of(read(tmp_path / "punch.bez"), 3)[0].reshape(-1, 3), read(tmp_path / "holder.bez")
    assert np.abs(punch[:, :2]).max(axis=0) == pytest.approx([40, 30])
    rim = punch[punch[:, 2] > punch[:, 2].max() - 0.01] * (1, 1, 0) + (0, 0, holder[0, 0, 0, 2])
    gap = np.linalg.norm(Distance(holder, 1.0).nearest(rim)[0] - rim, axis=1)
    assert np.abs(gap - 1 - CLEARANCE).max() < 0.01, (gap.min(), gap.max())


def test_mitres_refused(folder):
    """Check what is said of mitres around which no fillet is made, here by a radius that is too large."""
    with session() as model, silence():
        occ.importShapes(str(folder / "mitred_tray.step"))
        occ.synchronize()
        side = [10, 11, 12, 13, 15, 16, 17, 18, 19]
        sharp = {edge: 60.0 for edge in mitres.edges_of(model, side) if set(mitres.faces_of(model, edge)) <= set(side)
                 and mitres.is_sharp(model, edge)}
        with pytest.raises(Problem, match="the fillets of faces 15-18 end in mitres, edges 33 35 37 39, and cannot be "
                                          "led around these corners by 60 mm: round the corners in the CAD program"):
            mitres.rounded(model, side, sharp)
