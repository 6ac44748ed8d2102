# SPDX-License-Identifier: GPL-3.0-or-later
"""Scales of fields: round limits and ticks, per cent, colours that diverge from zero."""

import numpy as np
import pytest
from test_pictures import made_run

from dd3.fields import odd_axes
from dd3.plot import scale, skins
from dd3.plot import sheet as pictures


@pytest.mark.parametrize(("ends", "limits", "step"), [
    ((0.0, 15.9), (0, 16), 2), ((-1.3, 15.7), (-5, 20), 5), ((0.6937, 0.9402), (0.65, 0.95), 0.05),
    ((-243.0, 377.0), (-300, 400), 100), ((0.0, 8.0), (0, 8), 1), ((1.0e-5, 2.9e-5), (1e-5, 3e-5), 5e-6),
    ((12345.0, 12345.0), (12344, 12358), 2), ((0.0, 0.0), (0, 0.001), 0.0002)])
def test_round_limits(ends, limits, step):
    """Check that limits are the next multiples of a step of 1, 2 or 5 times a power of ten, and ticks all of them."""
    found = scale.round_scale(*ends)
    assert found[:3] == pytest.approx((*limits, step), rel=1e-9, abs=1e-12)
    ticks = np.array(found.ticks)
    assert ticks[[0, -1]] == pytest.approx(limits) and np.diff(ticks) == pytest.approx(step)
    assert len(ticks) <= scale.INTERVALS + 3
    written = [f"{tick:.{found.digits}f}" for tick in ticks]
    assert np.array(written, float) == pytest.approx(ticks) and "-0" not in written


def test_any_range():
    """Check steps, and that limits hold the values, for ranges of many magnitudes."""
    random = np.random.default_rng(1)
    for _ in range(500):
        low, high = np.sort(random.normal(size=2)) * 10.0 ** random.integers(-6, 7)
        found = scale.round_scale(low, high)
        factor = found.step / 10.0 ** np.floor(np.log10(found.step) + 1e-9)
        assert min(abs(factor - np.array([1, 2, 5]))) < 1e-6
        slack = 1e-5 * found.step
        assert low - found.step - slack <= found.low <= low + slack
        assert high - slack <= found.high <= high + found.step + slack


def test_own_limits():
    """Check that limits that are given are kept, with round ticks between them."""
    found = scale.own_scale("thickness", (-0.7, 21.3))
    assert found[:2] == (-0.7, 21.3) and found.ticks == pytest.approx([0, 5, 10, 15, 20])


def test_colours():
    """Check that colours of a field with both signs diverge from white at zero, that others grow lighter, and that the
    larger end of a one-sided range alone has the full colour."""
    colours = scale.colours_of(scale.Scale(-10.0, 30.0, 5.0)).colors[:, :3]
    zero = colours[round(0.25 * (len(colours) - 1))]
    assert zero.min() > 0.95
    assert colours[0][2] > colours[0][0] and colours[-1][0] > colours[-1][2]  # blue below, red above
    assert colours[0].sum() > colours[-1].sum() + 0.5  # -10 is a third of the way to blue
    lightness = scale.colours_of(scale.Scale(0.0, 20.0, 5.0)).colors[:, :3] @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(lightness) > -1e-6).all()
    chosen = scale.colours_of(scale.Scale(-10.0, 30.0, 5.0), "viridis").colors
    assert np.allclose(chosen, scale.colours_of(scale.Scale(0.0, 1.0, 0.2)).colors)


def test_labels():
    """Check that the numbers at a colour bar have room, and that zero is among them."""
    assert pictures.labelled(scale.Scale(-30.0, 40.0, 10.0)) == [-30, -20, -10, 0, 10, 20, 30, 40]
    few = pictures.labelled(scale.Scale(0.779993, 0.780001, 1e-6))
    assert 3 <= len(few) <= 5
    assert any(abs(tick) < 1e-12 for tick in pictures.labelled(scale.Scale(-3e-6, 5e-6, 1e-6)))


def test_per_cent(tmp_path):
    """Check that strains and thinning are shown in per cent, and other fields in their unit."""
    for field, percent in (("thinning", True), ("equivalent_plastic_strain", True), ("strain:11", True),
                           ("thickness", False), ("stress:11", False), ("displacement:z", False)):
        assert scale.in_per_cent(field) == percent, field
    values, label = scale.shown("thinning", np.array([0.05]), "thinning")
    assert values == pytest.approx([5.0]) and label == "thinning (%)"
    run = pictures.Run(made_run(tmp_path))
    options = pictures.Style("stress:13")
    assert run.mesh(0, "stress:13")[1] == "stress 13"
    assert pictures.limits_of(run, [0, 1], options).low == 0
    options = pictures.Style("stress:13", limits=(3.0, 50.0))
    assert pictures.limits_of(run, [0, 1], options)[:2] == (3, 50)


def length_of(edges):
    """Return the length of all edges."""
    return edges.compute_cell_sizes()["Length"].sum()


def test_whole_sheet(tmp_path):
    """Check that a sheet completed at a plane of symmetry has no faces on it, and common nodes."""
    run = pictures.Run(made_run(tmp_path))
    one, two = (skins.sheet_skin(run.shape(0), axes) for axes in ((), ("x", "y")))
    assert one.n_cells == 6 and two.n_cells == 4 * (6 - 2)
    assert two.n_points == 2 * 9 and two.is_all_triangles is False
    assert two.n_open_edges == 0
    assert length_of(skins.sharp_edges(two)) == pytest.approx(2 * 8 + 4)  # none on the planes
    # A component along x has the other sign in the images across x, a shear stress of x and y across each of both.
    mesh = run.shape(0)
    mesh.point_data["shown"] = mesh.points[:, 0] + 1.0
    for field, odd in (("displacement:x", ["x"]), ("stress:12", ["x", "y"]), ("stress:11", []), ("thickness", [])):
        assert odd_axes(field) == odd, field
        skin = skins.sheet_skin(mesh, ("x", "y"), odd)
        x, y, shown = *skin.points[:, :2].T, skin.point_data["shown"]
        inside = (np.abs(x) > 1e-6) & (np.abs(y) > 1e-6)
        sign = (np.sign(x) if "x" in odd else 1) * (np.sign(y) if "y" in odd else 1) * np.ones(len(x))
        assert np.allclose(shown[inside], (sign * (np.abs(x) + 1.0))[inside])
    # A tool that goes beyond the plane, here from -1 to 1, is cut there.
    patches = [(np.array([[[-1, -1, 0], [1, -1, 0]], [[-1, 1, 0], [1, 1, 0]]], float), np.ones((2, 2)))]
    place = skins.Placement(np.eye(3), np.zeros(3))
    tool = skins.tool_skin(patches, place, ("x", "y"), np.array([0.5, 0.5, 0.0]))
    assert tool.area == pytest.approx(4.0) and length_of(skins.sharp_edges(tool)) == pytest.approx(8.0)
