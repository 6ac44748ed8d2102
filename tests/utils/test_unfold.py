# SPDX-License-Identifier: GPL-3.0-or-later
"""The flat blank of a part by an inverse calculation in one step."""

from pathlib import Path

import numpy as np
import pytest
import pyvista as pv
from helpers import call
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from dd3.curve import read_curves
from dd3.triangles import Triangles, prepared, rims, turned_alike
from dd3.unfold import Balance, Sheet, in_plan, solved, unfolded

HERE = Path("part")


def grid(place, across, along):
    """Return a surface x, y, z = place(u, v) of triangles, u and v from 0 to 1."""
    u, v = (part.ravel() for part in np.meshgrid(np.linspace(0, 1, across), np.linspace(0, 1, along), indexing="ij"))
    number = np.arange(across * along).reshape(across, along)
    a, b, c, d = (number[i, j].ravel() for i, j in ((np.s_[:-1], np.s_[:-1]), (np.s_[1:], np.s_[:-1]),
                                                    (np.s_[1:], np.s_[1:]), (np.s_[:-1], np.s_[1:])))
    return Triangles(np.stack(place(u, v), axis=1), np.vstack((np.stack((a, b, c), 1), np.stack((a, c, d), 1))))


def blank_of(mesh, sheet, mirror=()):
    """Return the surface, its balance and the places of its nodes in the blank."""
    mesh = prepared(HERE, mesh, mirror)
    balance = Balance(mesh, sheet)
    return mesh, balance, unfolded(HERE, balance)


def test_developable():
    """Half a cylinder becomes a rectangle without strains, as long as its facets."""
    mesh, balance, places = blank_of(grid(lambda u, v: (30 * np.cos(np.pi * u), 80 * v, 30 * np.sin(np.pi * u)), 21, 9),
                                     Sheet())
    width = 20 * 2 * 30 * np.sin(np.pi / 40)
    assert np.allclose(np.ptp(places, axis=0), (width, 80), rtol=1e-9)
    assert abs(balance.strain(places[mesh.triangles])).max() < 1e-9


def cap(rings, around, angle=1.0, radius=50.0):
    """Return a spherical cap, half of it (x > 0), and the angle of its rim from the axis."""
    def place(u, v):
        turn = np.pi * (v - 0.5)
        return (radius * np.sin(angle * u) * np.cos(turn), radius * np.sin(angle * u) * np.sin(turn),
                -radius * np.cos(angle * u))
    return grid(place, rings, around)


def flat_radius(sheet, angle=1.0, radius=50.0):
    """Return the radius in the blank of the rim of a spherical cap and the thinning of its middle: the balance of the
    membrane along a meridian, d(s1 t r)/ds = s2 t dr/ds, integrated from the middle to the rim, where s1 = 0."""
    def stresses(along, hoop):
        tensor = sheet.stress(np.array([[[along, 0.0], [0.0, hoop]]]))[0]
        return tensor[0, 0], tensor[1, 1]

    def slope(phi, state):
        """State: radius in the blank, and the meridional force per length and initial thickness."""
        flat, force = state
        r = radius * np.sin(phi)
        hoop = np.log(r / flat)

        def miss(along):
            return stresses(along, hoop)[0] * np.exp(-along - hoop) - force
        along = brentq(miss, -0.9, 0.6, xtol=1e-13)
        around = stresses(along, hoop)[1] * np.exp(-along - hoop)
        return [radius * np.exp(-along), radius * (around - force) * np.cos(phi) / r]

    def rim(strain):
        small = 1e-4
        start = [radius * np.sin(small) / np.exp(strain), stresses(strain, strain)[0] * np.exp(-2 * strain)]
        return solve_ivp(slope, (small, angle), start, rtol=1e-9, atol=1e-10).y[:, -1]
    strain = brentq(lambda guess: rim(guess)[1], 0.01, 0.12, xtol=1e-10)
    return rim(strain)[0], 1 - np.exp(-2 * strain)


@pytest.mark.parametrize(("exponent", "r"), [(0.3, 1.0), (0.5, 2.0)])
def test_cap(exponent, r):
    """A spherical cap has the blank of the balance along its meridian, the closer the finer the triangles."""
    expected, middle = flat_radius(Sheet(exponent, r))
    found = []
    for rings in (9, 17):
        mesh, balance, places = blank_of(cap(rings, 4 * rings), Sheet(exponent, r), [0])
        rim = places[rims(HERE, mesh.triangles)[0]]
        radius = np.linalg.norm(rim - rim.mean(axis=0), axis=1)
        thinning = 1 - np.exp(-np.trace(balance.strain(places[mesh.triangles]), axis1=1, axis2=2))
        found.append((abs(radius - expected).max(), abs(thinning.max() - middle)))
        assert balance.sheet.exponent == exponent
    assert found[1][0] < 0.4 * found[0][0] and found[1][0] < 1.5e-3 * expected
    assert found[1][1] < 3e-3


@pytest.mark.parametrize(("depth", "flange", "exponent"), [(15, 20, 0.05), (20, 20, 0.25)])
def test_cup(depth, flange, exponent):
    """A cup that tears has the blank of the lowest exponent found with an exact equilibrium on the way to its own."""
    radius, height = np.array([0, 20, 24, 24 + flange]), np.array([0, 0, depth, depth])
    along = np.concatenate(([0], np.cumsum(np.hypot(np.diff(radius), np.diff(height)))))

    def place(u, v):
        distance, turn = np.interp(u * along[-1], along, radius), np.pi * (v - 0.5)
        return distance * np.cos(turn), distance * np.sin(turn), np.interp(u * along[-1], along, height)

    mesh, balance, places = blank_of(grid(place, 25, 24), Sheet(exponent), [0])
    assert exponent < balance.sheet.exponent < 0.5
    found = in_plan(solved(balance, places, 1e-8), mesh.nodes[:, :2])
    assert np.allclose(found, places, atol=1e-6)


def test_turned_in_plan():
    """An asymmetric part turned in plan has the turned blank."""
    mesh = grid(lambda u, v: (40 * u, 30 * v, 15 * u * v**2), 9, 7)
    cosine, sine = np.cos(0.5), np.sin(0.5)
    turn = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    _, _, places = blank_of(mesh, Sheet(0.2))
    _, _, turned = blank_of(Triangles(mesh.nodes @ turn.T, mesh.triangles), Sheet(0.2))
    assert np.allclose(turned, places @ turn[:2, :2].T, atol=1e-6)


def test_tangent():
    """The derivatives of the forces are those of the sum of the forces."""
    mesh = prepared(HERE, cap(5, 12), [0])
    balance = Balance(mesh, Sheet(0.2, 1.5))
    rng = np.random.default_rng(2)
    places = 1.05 * mesh.nodes[:, :2] + 0.1 * rng.standard_normal((len(mesh.nodes), 2))
    step = rng.standard_normal(places.shape)
    there, back = (balance.assembled(balance.forces((places + sign * 1e-6 * step)[mesh.triangles])) for sign in (1, -1))
    expected = (there - back).ravel() / 2e-6
    assert np.allclose(balance.tangent(places[mesh.triangles]) @ step.ravel(), expected, atol=1e-5 * abs(expected).max())


def test_slivers():
    """Check that slivers on both sides of an edge, whose far corners become one node, leave no side with more than two
    triangles."""
    nodes = np.array([[0, 0, 0], [4, 0, 0], [2, 0.02, 0], [2, -0.02, 0], [2, 3, 0], [2, -3, 0]], float)
    triangles = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 4], [2, 1, 4], [0, 5, 3], [3, 5, 1]])
    mesh = prepared(HERE, Triangles(nodes, triangles), [], 0.1)
    assert len(mesh.nodes) == 5 and len(mesh.triangles) == 4 and len(rims(HERE, mesh.triangles)[0]) == 4


def test_turned_alike():
    """Check that triangles turn as their neighbours, of two pieces too, and that nothing is said of a Möbius strip."""
    mesh = grid(lambda u, v: (u, v, u * v), 9, 7)
    both = np.vstack((mesh.triangles, mesh.triangles + len(mesh.nodes)))
    over = np.random.default_rng(1).random(len(both)) < 0.5
    found = turned_alike(np.where(over[:, None], both[:, ::-1], both))
    for piece, of in zip(np.split(found, 2), np.split(both, 2)):
        assert (piece == of).all() or (piece == of[:, ::-1]).all()
    strip = np.array([[i, i + 1, i + 2] for i in range(8)] + [[8, 9, 1], [9, 1, 0]])
    assert (np.sort(turned_alike(strip), axis=1) == np.sort(strip, axis=1)).all()


def test_command(tmp_path):
    """The outline of a part with a hole has two curves; fields are written; what is no part is refused."""
    angle = np.linspace(0, 2 * np.pi, 33)[:-1]
    mesh = grid(lambda u, v: ((20 + 20 * u) * np.cos(2 * np.pi * v), (20 + 20 * u) * np.sin(2 * np.pi * v), 5 * u**2),
                9, 33)
    pv.PolyData.from_regular_faces(mesh.nodes, mesh.triangles).save(tmp_path / "ring.ply")
    said = call("unfold", tmp_path / "ring.ply", tmp_path / "blank.txt", "--fields", tmp_path / "ring.vtp")
    assert "2 curves" in said and "thinning" in said
    outer, inner = (np.linalg.norm(curve, axis=1) for curve in read_curves(tmp_path / "blank.txt"))
    assert len(outer) == len(angle) and 40 < outer.mean() < 41.5 and 19 < inner.mean() < 20.5
    assert {"thinning", "equivalent_plastic_strain"} <= set(pv.read(tmp_path / "ring.vtp").cell_data)
    ball = pv.Sphere(radius=10)
    ball.save(tmp_path / "ball.ply")
    assert "no rim" in call("unfold", tmp_path / "ball.ply", tmp_path / "b.txt", expect=2)
    two = ball.translate((50, 0, 0)) + ball.clip("z")
    two.extract_surface(algorithm="dataset_surface").triangulate().save(tmp_path / "two.ply")
    assert "2 surfaces" in call("unfold", tmp_path / "two.ply", tmp_path / "b.txt", expect=2)
    assert "No such file" in call("unfold", tmp_path / "none.stl", tmp_path / "b.txt", expect=2)
