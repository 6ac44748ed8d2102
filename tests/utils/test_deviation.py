# SPDX-License-Identifier: GPL-3.0-or-later
"""`dd3 deviation` on parts that were moved rigidly and bent by known functions; the input file of a fixture."""

import numpy as np
import pandas as pd
import pytest
import pyvista
from helpers import call, write_run

from dd3.deviation import face_of
from dd3.fixture_deck import partner
from dd3.nominal import line_distances
from dd3.sheet import Sheet

HISTORY = "increment,phase,travel,progress,punch_ux,punch_uy,punch_uz\n0,draw,0,1,0,0,0\n1,free,2,1,0,0,0\n"
TOOL = {"name": "punch", "active": True}
PHASES = [{"number": 1, "name": "draw", "control": "punch", "tools": [TOOL]},
          {"number": 2, "name": "free", "control": None, "tools": [{**TOOL, "active": False}]}]
SHAPE = 41, 11, 2
TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.60, 0.0], [0.48, 0.64, 0.6]])
LOCATORS = """
[alignment]
by = "locators"
[[locator]]
name = "a1"
at = [5, 2, 0]
direction = [0, 0, 1]
[[locator]]
name = "a2"
at = [35, 2, 0]
direction = [0, 0, 1]
[[locator]]
name = "a3"
at = [20, 8, 0]
direction = [0, 0, 1]
[[locator]]
name = "b1"
at = [10, 5, 0]
direction = [0, 1, 0]
pin = true
[[locator]]
name = "b2"
at = [30, 5, 0]
direction = [0, 1, 0]
pin = true
[[locator]]
name = "c1"
at = [10, 5, 0]
direction = [1, 0, 0]
pin = true
"""


def plate(height=lambda x, y: 0 * x):
    """Return the nodes of a plate of 40 x 10 x 1 mm whose lower face has a height, and its elements."""
    x, y, z = (a.ravel() for a in np.meshgrid(np.linspace(0, 40, SHAPE[0]), np.linspace(0, 10, SHAPE[1]), [0.0, 1.0],
                                              indexing="ij"))
    number = np.arange(len(x)).reshape(SHAPE)
    cells = [[number[i + a, j + b, k] for k in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
             for i in range(SHAPE[0] - 1) for j in range(SHAPE[1] - 1)]
    return np.column_stack([x, y, z + height(x, y)]), cells


def measured(folder, drawn, free, text, *options, expect=0):
    """Compare a free shape with the drawn one; return what is said, and the tables by name."""
    flat, cells = plate()
    history = HISTORY
    write_run(folder / "run", drawn, free, cells, history, "phase\n", {"displacement": (drawn - flat, free - flat)},
              phases=PHASES)
    (folder / "f.toml").write_text(text if text.startswith("face") else 'face = "lower"\n' + text)
    said = call("deviation", folder / "run", "--fixture", folder / "f.toml", *options, expect=expect)
    found = {path.stem: pd.read_csv(path) for path in (folder / "run" / "deviation").glob("*.csv")}
    return said, found


def crown(x, y):
    """Return a height with curvature in both directions."""
    return 0.02 * (x - 20)**2 + 0.03 * (y - 5)**2


@pytest.mark.parametrize("alignment", ["", LOCATORS])
def test_rigid_motion(tmp_path, alignment):
    """A part that was moved and turned rigidly has no deviation."""
    drawn, _ = plate(crown if not alignment else lambda x, y: 0 * x)
    said, found = measured(tmp_path, drawn, drawn @ TURN.T + [30, -20, 70], "tolerance = 0.01\n" + alignment,
                           "--verdict")
    assert np.abs(found["map"]["deviation"]).max() < 1e-5
    assert "6 rigid motions determined" in said and "part: good" in said


def test_locators_on_a_bent_plate(tmp_path):
    """A flat plate that is bent to z = c x (x - 40) and lies on three locators differs by the parabola less the plane
    through its values at the locators, up to its slope squared."""
    c = 1e-4
    drawn, _ = plate()
    free, _ = plate(lambda x, y: c * x * (x - 40))
    said, found = measured(tmp_path, drawn, free @ TURN.T + [1, 2, 3], LOCATORS + """
[[point]]
name = "middle"
at = [20, 2, 0]
tolerance = 0.01
[[point]]
name = "corner"
at = [0, 0, 0]
tolerance = 0.01
""".replace("tolerance", "tolerance"), "--verdict", expect=1)
    z = np.array([c * x * (x - 40) for x in (5, 35, 20)])
    plane = np.linalg.solve(np.array([[1, 5, 2], [1, 35, 2], [1, 20, 8]]), z)
    # Positive on the side of the lower face: downwards.
    expected = [-(c * x * (x - 40) - plane @ [1, x, y]) for x, y in ((20, 2), (0, 0))]
    assert np.allclose(found["points"]["deviation"], expected, atol=2e-5)
    assert np.abs(found["supports"]["gap"]).max() < 1e-9
    assert "not good: point middle, point corner" in said


@pytest.mark.parametrize("inwards", [False, True])
@pytest.mark.parametrize("face", ["lower", "upper"])
def test_solid_as_nominal_shape(tmp_path, face, inwards):
    """Measure a plate that lies 0.7 of its thickness too low, from a solid: from the side of the measured face, not
    from the nearest one."""
    flat, _ = plate()
    box = pyvista.Box((0, 40, 0, 10, 0, 1), level=9).triangulate()
    (box.flip_faces() if inwards else box).save(tmp_path / "box.stl")
    said, _ = measured(tmp_path, flat, flat - [0, 0, 0.7],
                       f'face = "{face}"\ntolerance = 0.5\n[nominal]\nsurface = "box.stl"\n[alignment]\nby = "none"\n',
                       "--verdict", expect=1)
    assert ("-0.7000 to -0.7000" if face == "upper" else "+0.7000 to +0.7000") in said, said


def test_best_fit_and_section(tmp_path):
    """The best fit of a parabola leaves c (X^2 - mean of X^2) of a plate, X from its middle; a section shows it."""
    c = 1e-4
    drawn, _ = plate()
    free, _ = plate(lambda x, y: c * (x - 20)**2)
    _, found = measured(tmp_path, drawn, free + [0, 0, 5], 'section = ["y=4.5"]\ntolerance = [-1, 1]\n')
    table = found["sections"]
    expected = -c * ((table["x"] - 20)**2 - 20**2 / 3)
    assert np.allclose(table["deviation"], expected, atol=5e-5)
    assert (tmp_path / "run" / "deviation" / "map.png").is_file()


def test_planes_of_symmetry_are_told(tmp_path):
    """Check that a fixture warns of a plane on which the model keeps the border of the sheet, until it is named."""
    flat, _ = plate()
    bent = flat + np.outer(2e-3 * flat[:, 0]**2, [-0.1, 0, 1])
    said, _ = measured(tmp_path, flat, bent, "")
    assert "the alignment may turn the part" in said and "expected for mirror: x" in said, said
    (tmp_path / "f.toml").write_text('face = "lower"\nmirror = ["x"]\n')
    assert "warning" not in call("deviation", tmp_path / "run", "--fixture", tmp_path / "f.toml")


def test_layers(tmp_path):
    """Check thickness and the node of the other face of a sheet of two layers of elements."""
    x, y, z = (a.ravel() for a in np.meshgrid([0.0, 2.0, 4.0], [0.0, 2.0], [0.0, 0.5, 1.2], indexing="ij"))
    number, points = np.arange(18).reshape(3, 2, 3), np.column_stack([x, y, z])
    cells = [[number[i + a, b, j + k] for k in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
             for i in range(2) for j in range(2)]
    write_run(tmp_path / "run", points, points, cells, HISTORY, "phase\n", {"displacement": (0 * points, 0 * points)},
              phases=PHASES)
    for upper, here, there in ((True, 1.2, 0.0), (False, 0.0, 1.2)):
        face = face_of(Sheet(tmp_path / "run"), 0, upper)
        assert face.thickness == pytest.approx(1.2) and (face.points[:, 2] == here).all()
        for node in face.nodes:
            assert np.array_equal(points[partner(face, int(node))], [*points[node, :2], there])


def test_lines_on_the_border():
    """Check that lines on the border of a surface meet it, also by round-off beside it, and others do not."""
    surface = pyvista.Plane(center=(30, 0.5, 0), i_size=60, j_size=1, i_resolution=30, j_resolution=1).triangulate()
    surface = surface.compute_normals()
    for beside, meets in ((8e-16, True), (0.0, True), (1e-3, False)):
        points = np.array([[59.5, -beside, -2], [59.5, 1 + beside, -2], [-beside, 0.4, -2], [60 + 5 * beside, 0.4, -2],
                           [60 + 5 * beside, 1 + beside, -2]])
        away, _ = line_distances(points, np.tile([0.0, 0, 1], (len(points), 1)), surface)
        assert np.array_equal(away == 2, np.full(len(points), meets)), (beside, away)


def test_points_as_alignment(tmp_path):
    """Aligned at three points of a shifted and bent plate the deviation there is zero."""
    names = "".join(f'[[point]]\nname = "p{i}"\nat = [{x}, {y}, 0]\n'
                    for i, (x, y) in enumerate(((2, 2), (38, 2), (20, 9))))
    drawn, _ = plate()
    free, _ = plate(lambda x, y: 1e-3 * x * y)
    said, found = measured(tmp_path, drawn, free + [0, 0, 0.5], '[alignment]\nby = "points"\n' + names)
    assert np.abs(found["points"]["deviation"]).max() < 1e-8
    assert "3 rigid motions determined" in said


@pytest.mark.parametrize("text, message", [
    ("colour = 1\n", "unknown key 'colour'"),
    ('[alignment]\nby = "eye"\n', "expected one of: fit points locators none"),
    ("tolerance = [1, -1]\n", "expected a number > 0"),
    (LOCATORS.replace("[20, 8, 0]", "[20, 2, 0]"), "determine 5 of 6"),
    (LOCATORS.replace("[5, 2, 0]", "[5, 20, 0]"), "does not meet the line of 'a1'"),
])
def test_refused(tmp_path, text, message):
    """What a file cannot mean is refused with the reason."""
    drawn, _ = plate()
    said, _ = measured(tmp_path, drawn, drawn, text, expect=2)
    assert message in said
