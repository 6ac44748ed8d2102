# SPDX-License-Identifier: GPL-3.0-or-later
"""Sheets of LS-DYNA: their nodes, thicknesses, stresses and strains in the file that *START reads."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers import call
from mutations import mutants

from dd3.sheet_state import read_state

# Two shells of 10 mm, the second one turned about y by 30 degrees, 1.0 and 1.2 mm thick.
TURN = np.radians(30)
POINTS = [(0, 0, 0), (10, 0, 0), (10, 10, 0), (0, 10, 0),
          (10 + 10 * np.cos(TURN), 0, -10 * np.sin(TURN)), (10 + 10 * np.cos(TURN), 10, -10 * np.sin(TURN))]
SHELLS = {5: ((1, 2, 3, 4), 1.0), 9: ((2, 5, 6, 3), 1.2)}


def wide(values, width=10):
    """Return numbers in columns."""
    return "".join(f"{value:{width}.{width - 7}e}" for value in values) + "\n"


def dynain(stress):
    """Return the file with the rows of stresses of both shells."""
    text = "*KEYWORD\n$ a comment\n*NODE\n" + "".join(
        f"{i:8d}" + wide(point, 16) for i, point in enumerate(POINTS, 1)) + "*ELEMENT_SHELL_THICKNESS\n"
    for label, (nodes, thickness) in SHELLS.items():
        text += "".join(f"{value:8d}" for value in (label, 1, *nodes)) + "\n" + wide([thickness] * 4, 16)
    return text + "*INITIAL_STRESS_SHELL\n" + stress + "*END\n"


def short(label):
    """Return stresses in a column of three points."""
    return f"{label:10d}{1:10d}{3:10d}\n" + "".join(
        wide((height, 100 + 50 * height, 20, 0, 5, 0, 0, 0.1 + 0.02 * height)) for height in (-0.7745967, 0, 0.7745967))


def large(label):
    """Return the same in two columns with more digits, with two variables more and one tensor, and other deviations."""
    text = f"{label:10d}{2:10d}{3:10d}{2:10d}{6:10d}{1:10d}\n"
    for height in (-0.7745967, 0, 0.7745967):
        for more in (-4, 4):
            values = (height, 100 + 50 * height + more, 20, 0, 5, 0, 0, 0.1 + 0.02 * height)
            text += wide(values[:5], 16) + wide(values[5:], 16) + wide((1, 2), 16) + wide([0] * 5, 16) + wide([0], 16)
    return text


def large_in_20(label, place=5):
    """Return them in one column of points in fields of 20 columns, LARGE in its own place or in that of NTENSR."""
    head = [label, 1, 3, 0, 0, 0, 0, 0]
    head[place] = 1
    text = "".join(f"{value:10d}" for value in head[:max(6, place + 1) if place == 5 else 5]) + "\n"
    for height in (-0.7745967, 0, 0.7745967):
        values = (height, 100 + 50 * height, 20, 0, 5, 0, 0, 0.1 + 0.02 * height)
        text += wide(values[:5], 20) + wide(values[5:], 20)
    return text


def large_in_the_place_of_tensors(label):
    """Return the rows of LARGE = 1 below a head that ends with it."""
    return large_in_20(label, 4)


@pytest.mark.parametrize("rows", [short, large, large_in_20, large_in_the_place_of_tensors])
def test_dynain(rows):
    """Place, stresses in global axes, strains, axes and sets; heights between those of the file are interpolated."""
    Path("dynain").write_text(dynain("".join(rows(label) for label in SHELLS)))
    said = call("dynain", "dynain", "op10.out", "--points", "5", "--rolling", "0", "2", "0")
    assert "2 elements, 5 points" in said
    state = read_state(Path("op10.out"))
    assert state.materials == ["steel"] and state.column == 5 and state.stress.shape == (2, 20, 3, 3)
    heights = np.tile(np.polynomial.legendre.leggauss(5)[0], 4)
    assert np.allclose(state.stress[:, :, 0, 0], 100 + 50 * heights, atol=0.05)
    assert np.allclose(state.stress[..., 0, 1], 5, atol=0.01) and np.allclose(state.stress[..., 1, 1], 20, atol=0.01)
    assert np.allclose(state.strain, 0.1 + 0.02 * heights, atol=1e-5)
    # Rolling along y; the normal of the second shell is turned.
    assert np.allclose(state.axes[:, :, :, 0], (0, 1, 0)) and np.allclose(state.axes[0, 0, :, 2], (0, 0, 1))
    assert np.allclose(state.axes[1, 0, :, 2], (np.sin(TURN), 0, np.cos(TURN)), atol=1e-6)
    lower, upper = state.points[::2], state.points[1::2]
    assert np.allclose(0.5 * (lower + upper), POINTS, atol=1e-6)
    # The thickness at a node lies across its elements, of which the common nodes have two.
    assert np.allclose(np.linalg.norm(upper - lower, axis=1)[[0, 4]], (1.0, 1.2))
    assert np.isclose(np.linalg.norm(upper - lower, axis=1)[1], 1.1 / np.cos(TURN / 2), rtol=1e-4)
    assert len(state.elements) == 2 and state.thickness == pytest.approx(1.1)


def test_refused():
    """Files that hold no sheet of quadrilaterals with stresses, and folders of runs."""
    whole = dynain("".join(short(label) for label in SHELLS))
    for name, text, expected in (
            ("triangle", whole.replace("       2       5       6       3", "       2       5       6       6"), "three nodes"),
            ("stress", whole.replace(short(9), ""), "for 1 shells, the first 9"),
            ("cut", whole.rsplit("\n", 3)[0], "rows, expected"),
            ("none", "*KEYWORD\n*END\n", "no shells"),
            ("number", whole.replace("1.000e-01", "1.000x-01"), "expected a number"),
            ("node", whole.replace("\n       6 ", "\n       7 "), "does not give")):
        Path(name).write_text(text)
        assert expected in call("dynain", name, "x.out", expect=2), name
    Path("dynain").write_text(whole)
    assert "normal to the sheet" in call("dynain", "dynain", "x.out", "--rolling", "0", "0", "1", expect=2)
    Path("run.out").mkdir()
    Path("run.out/job.log").write_text("")
    assert "results of a run" in call("dynain", "dynain", "run.out", expect=2)
    assert "No such file" in call("dynain", "nothing", "x.out", expect=2)


def whole_file():
    """Return a file of two shells."""
    return dynain("".join(short(label) for label in SHELLS))


def test_turned_shells():
    """Check that shells numbered the other way round are turned over with their heights: the sheet is the same."""
    Path("dynain").write_text(whole_file())
    call("dynain", "dynain", "plain.out")
    nodes = "".join(f"{value:8d}" for value in SHELLS[9][0])
    back = "".join(f"{value:8d}" for value in SHELLS[9][0][::-1])
    rows = "".join(wide((height, 100 - 50 * height, 20, 0, 5, 0, 0, 0.1 - 0.02 * height))
                   for height in (-0.7745967, 0, 0.7745967))
    text = whole_file().replace(nodes, back).replace(short(9), f"{9:10d}{1:10d}{3:10d}\n" + rows)
    Path("turned").write_text(text)
    said = call("dynain", "turned", "turned.out")
    assert "note: 1 shells are numbered the other way round than the others, the first" in said
    plain, turned = read_state(Path("plain.out")), read_state(Path("turned.out"))
    if np.allclose(plain.points, turned.points):
        assert np.allclose(plain.stress, turned.stress) and np.allclose(plain.strain, turned.strain)
    else:  # all turned over: upper and lower face exchanged
        assert np.allclose(plain.points[::2], turned.points[1::2])
        assert np.allclose(plain.stress[:, :3], turned.stress[:, 2::-1], atol=1e-9)


def test_units():
    """Check that stresses in GPa or Pa are asked for, taken with --units, and that zero stresses need none."""
    def file(factor, length=1.0):
        text = "*KEYWORD\n*NODE\n" + "".join(
            f"{i:8d}" + wide((length * value for value in point), 16) for i, point in enumerate(POINTS, 1))
        text += "*ELEMENT_SHELL_THICKNESS\n"
        for label, (nodes, thickness) in SHELLS.items():
            text += "".join(f"{value:8d}" for value in (label, 1, *nodes)) + "\n" + wide([length * thickness] * 4, 16)
        text += "*INITIAL_STRESS_SHELL\n"
        for label in SHELLS:
            text += f"{label:10d}{1:10d}{2:10d}\n" + "".join(
                wide((height, *(factor * value for value in (100, 20, 0, 5, 0, 0)), 0.1)) for height in (-0.577, 0.577))
        return text + "*END\n"

    Path("mpa").write_text(file(1.0))
    call("dynain", "mpa", "mpa.out")
    for name, factor, length in (("mm GPa", 1e-3, 1.0), ("m Pa", 1e6, 1e-3)):
        Path("other").write_text(file(factor, length))
        assert "say by --units what they are in" in call("dynain", "other", "other.out", expect=2)
        call("dynain", "other", "other.out", "--units", name)
        expected, found = read_state(Path("mpa.out")), read_state(Path("other.out"))
        assert np.allclose(found.stress, expected.stress, rtol=1e-3, atol=1e-6)
        assert np.allclose(found.points, expected.points, atol=1e-5)
    Path("free").write_text(file(0.0))
    call("dynain", "free", "free.out")


def test_hanging_nodes():
    """Check that a hanging node is refused but for one that *CONSTRAINED_ADAPTIVITY binds in the middle of an edge."""
    points = [(0, 0), (10, 0), (10, 10), (0, 10), (15, 0), (15, 5), (10, 5), (15, 10)]
    cells = {1: (1, 2, 3, 4), 2: (2, 5, 6, 7), 3: (7, 6, 8, 3)}
    text = "*KEYWORD\n*NODE\n" + "".join(f"{i:8d}" + wide((*point, 0), 16) for i, point in enumerate(points, 1))
    text += "*ELEMENT_SHELL_THICKNESS\n"
    for label, nodes in cells.items():
        text += "".join(f"{value:8d}" for value in (label, 1, *nodes)) + "\n" + wide([1.0] * 4, 16)
    text += "*INITIAL_STRESS_SHELL\n" + "".join(short(label) for label in cells)
    Path("adaptive").write_text(text)
    assert "node 7 lies on an edge of shell 1 that does not have it" in call("dynain", "adaptive", "x.out", expect=2)
    Path("adaptive").write_text(text + f"*CONSTRAINED_ADAPTIVITY\n{7:10d}{2:10d}{3:10d}\n")
    call("dynain", "adaptive", "x.out")
    with h5py.File("x.out/restart.h5") as file:
        mesh = file["mesh"]
        assert sorted(mesh["bound"][...].reshape(-1, 3).tolist()) == [[13, 3, 5], [14, 4, 6]]
        sizes, names = mesh["set_size"][...], bytes(mesh["sets"][...].astype(np.uint8)).decode().split()
        assert sizes[names.index("rim")] == 14  # all columns but the bound one
    for ends, message in (((2, 4), "which are not the ends of an edge"), ((2, 7), "node 7 is 2.5 from the middle of the edge"),
                          ((7, 6), "node 7 is 2.5 from the middle of the edge")):
        wrong = text + f"*CONSTRAINED_ADAPTIVITY\n{7:10d}{ends[0]:10d}{ends[1]:10d}\n"
        Path("wrong").write_text(wrong)
        assert message in call("dynain", "wrong", "y.out", expect=2)
    Path("wrong").write_text(text.replace(f"{7:8d}" + wide((10, 5, 0), 16), f"{7:8d}" + wide((10, 8, 0), 16))
                             + f"*CONSTRAINED_ADAPTIVITY\n{7:10d}{2:10d}{3:10d}\n")
    assert "node 7 is 3 from the middle of the edge" in call("dynain", "wrong", "y.out", expect=2)


def test_named():
    """Check that each thing that is not used is named with its place."""
    text = whole_file().replace("*KEYWORD\n", "*KEYWORD\n*ELEMENT_BEAM\n1\n*INITIAL_STRAIN_SHELL\n1\n*MADE_UP\n1\n"
                                "*PART\nsheet\n" + "".join(f"{value:10d}" for value in (1, 4, 5)) + "\n*MAT_024\n1\n")
    text = text.replace(f"{5:10d}{1:10d}{3:10d}\n", f"{5:10d}{1:10d}{3:10d}{0:10d}{0:10d}{0:10d}{0:10d}{3:10d}\n")
    text = text.replace(wide([1.2] * 4, 16), wide([1.2] * 4, 16)[:-1] + f"{30.0:16.3f}\n")
    Path("dynain").write_text(text.replace("THICKNESS", "THICKNESS_BETA") + "behind\n")
    said = call("dynain", "dynain", "x.out")
    left = [line for line in said.splitlines() if line.startswith("left out: dynain:")]
    for name in ("*ELEMENT_BEAM", "*INITIAL_STRAIN_SHELL", "*MADE_UP", "*PART: the thick", "*MAT_024", "BETA = 30",
                 "lines behind *END"):
        assert any(name in line for line in left), (name, left)
    assert len(left) == 7, left
    Path("dynain").write_text(whole_file())
    assert "left out" not in call("dynain", "dynain", "y.out")


def test_parts():
    """Materials of two parts: one for both, which is told; one for each; refusals."""
    text = whole_file()
    nodes = "".join(f"{value:8d}" for value in SHELLS[9][0])
    Path("dynain").write_text(text.replace(f"{9:8d}{1:8d}{nodes}", f"{9:8d}{4:8d}{nodes}"))
    said = call("dynain", "dynain", "x.out", "--material", "dp600")
    assert "parts and their materials: 1 dp600, 4 dp600; --material PART=NAME" in said
    said = call("dynain", "dynain", "y.out", "--material", "dp600", "--material", "4=dc06")
    assert "1 dp600, 4 dc06" in said and "PART" not in said
    state = read_state(Path("y.out"))
    assert state.materials == ["dp600", "dc06"] and state.material_of.tolist() == [0, 1]
    assert "no shell is of part 3; parts of the file: 1, 4" in call("dynain", "dynain", "z.out", "--material", "3=a",
                                                                    expect=2)
    assert "expected NAME, or PART=NAME" in call("dynain", "dynain", "z.out", "--material", "a=b", expect=2)
    Path("dynain").write_text(text)
    assert "parts" not in call("dynain", "dynain", "w.out")


def test_mutated_files():
    """Check that damaged files are taken or refused by a message."""
    from dd3.dynain import sheet_of
    from dd3.errors import Problem
    taken = 0
    for data in mutants(whole_file().encode(), 1000, 3):
        Path("damaged").write_bytes(data)
        try:
            state, _ = sheet_of(Path("damaged"), ["steel"], 0, (1, 0, 0))
            assert all(np.isfinite(values).all() for values in (state.points, state.stress, state.strain, state.axes))
            taken += 1
        except Problem as problem:
            assert "damaged" in str(problem) or "--rolling" in str(problem), problem
    assert 20 < taken < 950, taken
