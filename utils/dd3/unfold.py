# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimate the flat blank of a part by an inverse calculation in one step, from the part's shape alone.

    dd3 unfold part.step outline.txt
    dd3 unfold part.step outline.txt --exponent 0.26 --r 1.8 --mirror x y --fields part.vtp

The part is a surface with the wanted rim: the faces of a STEP, IGES or BREP file (of a solid, the side that --side
names, or --faces), or facets. It is divided into triangles of three nodes; the place of each node in the blank is
found such that the membrane stresses of the whole deformation, from the blank to the part in one step, are in
equilibrium along the part: deformation theory of plasticity with normal anisotropy, without friction. The result is
the outline of the blank and of its holes, as *TRIM and `dd3 outline` read them; --fields writes the part with its
thinning and its equivalent plastic strain.

--mirror names planes of symmetry x = 0, y = 0 of which the part is one side; the outline is that of the whole blank.

Sources: Guo, Batoz, Detraux and Duroux, Int. J. Numer. Methods Eng. 30 (1990) 1385-1401 (inverse approach); the start
is the map of Tutte, Proc. London Math. Soc. 13 (1963) 743-767, made as rigid as possible: Liu, Zhang, Xu, Gotsman and
Gortler, Comput. Graph. Forum 27 (2008) 1495-1504.
"""
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.sparse import bmat, coo_array, csc_array, csr_array
from scipy.sparse.linalg import splu

from dd3.command import new_parser
from dd3.curve import write_curves
from dd3.errors import Problem
from dd3.tools.facet_files import SUFFIXES
from dd3.triangles import Triangles, area_vectors, of_cad, of_facets, pairs_matrix, prepared, rims

RIGID_STEPS, RIGID = 400, 1e-6  # iterations of the rigid map, and the change over the size that ends them
# Iterations, and the residuals over the largest force that end them: with the exponent that is wanted, and before.
NEWTON_STEPS, SOLVED, ROUGH = 15, 1e-8, 1e-2
LEAST = 1e-3  # stress over the strength coefficient that counts as none
SHORTEST = 2.0**-4  # step of Newton's method, at least
# The exponent of the hardening law falls from 1 to that of the sheet by a step that grows; the least one.
FIRST_STEP, LAST_STEP = 0.3, 0.03
START_STRAIN = 0.01  # of the hardening law (e0 + strain)^n, below which it is nearly linear


@dataclass
class Sheet:
    """Exponent of the hardening law and normal anisotropy of a sheet."""

    exponent: float = 0.2
    r: float = 1.0

    def equivalent(self, strain: np.ndarray) -> np.ndarray:
        """Return the equivalent strains for logarithmic strains (m, 2, 2) in the plane of the sheet: Hill's criterion
        of 1948 with one r-value in all directions, and proportional straining."""
        q = self.r / (1 + self.r)
        square = (strain**2).sum(axis=(1, 2))
        # The sum of the squares of the principal strains and 2 q times their product.
        return np.asarray((1 + self.r) / np.sqrt(1 + 2 * self.r)
                          * np.sqrt(square + q * (np.trace(strain, axis1=1, axis2=2)**2 - square)))

    def direction(self, strain: np.ndarray) -> np.ndarray:
        """Return half the derivatives of the squares of the equivalent strains with the strains (..., 2, 2), linear in
        these."""
        other = np.trace(strain, axis1=-2, axis2=-1)[..., None, None] * np.eye(2) - strain
        return np.asarray((1 + self.r)**2 / (1 + 2 * self.r) * (strain + self.r / (1 + self.r) * other))

    def stress(self, strain: np.ndarray) -> np.ndarray:
        """Return the stresses (m, 2, 2), over the strength coefficient, for logarithmic strains."""
        secant = (START_STRAIN**2 + self.equivalent(strain)**2)**(0.5 * (self.exponent - 1))
        return np.asarray(secant[:, None, None] * self.direction(strain))

    def stress_change(self, strain: np.ndarray, change: np.ndarray) -> np.ndarray:
        """Return the derivatives (m, 3, 2, 2, 2) of the stresses in directions in which the strains have the
        derivatives `change`."""
        square = START_STRAIN**2 + self.equivalent(strain)**2
        along = self.direction(strain)
        slope = (self.exponent - 1) / square[:, None, None] * np.einsum("mij,mkaij->mka", along, change)
        secant = square**(0.5 * (self.exponent - 1))
        return np.asarray(secant[:, None, None, None, None]
                          * (self.direction(change) + slope[..., None, None] * along[:, None, None]))


def frames(mesh: Triangles) -> tuple[np.ndarray, np.ndarray]:
    """Return two unit vectors in each triangle (m, 2, 3), and its two sides from the first node in them, as the columns
    of matrices (m, 2, 2)."""
    a, b, c = (mesh.nodes[mesh.triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    first = (b - a) / np.linalg.norm(b - a, axis=1)[:, None]
    second = np.cross(normal, first)
    axes = np.stack((first, second / np.linalg.norm(second, axis=1)[:, None]), axis=1)
    return axes, np.einsum("mik,mkj->mij", axes, np.stack((b - a, c - a), axis=2))


def tutte_map(mesh: Triangles, border: Sequence[np.ndarray]) -> np.ndarray:
    """Return places in the plane without folds: the longest rim on a circle, all others in the mean of those beside
    them, holes filled by a node each."""
    size = [np.linalg.norm(np.diff(mesh.nodes[np.append(rim, rim[:1])], axis=0), axis=1) for rim in border]
    longest = int(np.argmax([side.sum() for side in size]))
    outer, count = border[longest], len(mesh.nodes)
    pairs = [mesh.triangles[:, [k, (k + 1) % 3]] for k in range(3)]
    holes = [rim for number, rim in enumerate(border) if number != longest]
    for number, rim in enumerate(holes):
        pairs.append(np.stack((rim, np.full(len(rim), count + number)), axis=1))
    links = np.vstack(pairs)
    links = np.unique(np.sort(links, axis=1), axis=0)
    total = count + len(holes)
    weights = csr_array(pairs_matrix(np.vstack((links, links[:, ::-1])), total))
    places = np.zeros((total, 2))
    angle = 2 * np.pi * np.concatenate(([0.0], np.cumsum(size[longest])[:-1])) / size[longest].sum()
    places[outer] = size[longest].sum() / (2 * np.pi) * np.stack((np.cos(angle), np.sin(angle)), axis=1)
    inner = np.setdiff1d(np.arange(total), outer)
    if not len(inner):
        return places[:count]
    matrix = coo_array((weights.sum(axis=1), (np.arange(total), np.arange(total))), shape=(total, total)) - weights
    rows = csr_array(matrix)[inner]
    places[inner] = splu(csc_array(rows[:, inner])).solve(-(rows[:, outer] @ places[outer]))
    return places[:count]


def rigid_map(mesh: Triangles, places: np.ndarray) -> np.ndarray:
    """Return places in the plane whose triangles are as rigid as possible: the closest rotation of each, then the
    places that fit all of them, in turn."""
    _, side = frames(mesh)
    count, triangles = len(mesh.nodes), mesh.triangles
    corner = np.zeros((len(triangles), 3, 2))
    corner[:, 1], corner[:, 2] = side[:, :, 0], side[:, :, 1]
    # The cotangents of the angles opposite to the sides 1-2, 2-0 and 0-1.
    cotangents, edges = [], ((1, 2), (2, 0), (0, 1))
    for i, j in edges:
        k = 3 - i - j
        a, b = corner[:, i] - corner[:, k], corner[:, j] - corner[:, k]
        cotangents.append((a * b).sum(axis=1) / abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]))
    row = np.concatenate([triangles[:, edge[s]] for edge in edges for s in (0, 1)])
    column = np.concatenate([triangles[:, edge[1 - s]] for edge in edges for s in (0, 1)])
    value = np.concatenate([cotangent for cotangent in cotangents for _ in (0, 1)])
    matrix = coo_array((np.concatenate((value, -value)), (np.concatenate((row, row)), np.concatenate((row, column)))),
                       shape=(count, count)).tocsc()
    factors = splu(csc_array(matrix[1:, 1:]))
    size = float(np.ptp(mesh.nodes, axis=0).max())
    for _ in range(RIGID_STEPS):
        moment = sum(cotangent[:, None, None] * np.einsum(
            "mi,mj->mij", places[triangles[:, i]] - places[triangles[:, j]], corner[:, i] - corner[:, j])
            for (i, j), cotangent in zip(edges, cotangents))
        # The closest rotation of the plane, (c, -s; s, c).
        cosine, sine = moment[:, 0, 0] + moment[:, 1, 1], moment[:, 1, 0] - moment[:, 0, 1]
        turn = np.stack([np.stack([cosine, -sine], axis=1), np.stack([sine, cosine], axis=1)], axis=1)
        turn /= np.hypot(cosine, sine)[:, None, None]
        load = np.zeros((count, 2))
        for (i, j), cotangent in zip(edges, cotangents):
            pull = cotangent[:, None] * np.einsum("mij,mj->mi", turn, corner[:, i] - corner[:, j])
            np.add.at(load, triangles[:, i], pull)
            np.add.at(load, triangles[:, j], -pull)
        new = np.zeros_like(places)
        new[1:] = factors.solve(load[1:])
        change = abs(new - new.mean(axis=0) - (places - places.mean(axis=0))).max()
        places = new
        if change < RIGID * size:
            break
    return places


@dataclass
class Balance:
    """The forces of a part in its shape by the places of its nodes in the flat blank."""

    mesh: Triangles
    sheet: Sheet

    def __post_init__(self) -> None:
        self.axes, self.side = frames(self.mesh)
        self.length = float(np.sqrt(abs(np.linalg.det(self.side)).max()))
        self.inverse = np.linalg.inv(self.side)
        gradient = np.concatenate((-self.inverse.sum(axis=1)[:, None], self.inverse), axis=1)  # of the nodes' functions
        self.gradient = gradient
        normal = np.zeros_like(self.mesh.nodes)
        vectors = area_vectors(self.mesh.nodes, self.mesh.triangles)
        for k in range(3):
            np.add.at(normal, self.mesh.triangles[:, k], vectors)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        first = np.cross(normal, np.eye(3)[abs(normal).argmin(axis=1)])
        first /= np.linalg.norm(first, axis=1)[:, None]
        self.tangents = np.stack((first, np.cross(normal, first)), axis=1)  # of the surface at the nodes
        # From forces in a triangle's axes to those along the surface at its nodes (m, 3, 2, 2).
        self.along = np.einsum("mkij,mlj->mkil", self.tangents[self.mesh.triangles], self.axes)
        motions = np.zeros((len(self.mesh.nodes), 3, 3))
        motions[:, :2] = rigid_motions(self.mesh.nodes[:, :2])
        self.carried = np.linalg.qr(np.einsum("nij,njk->nik", self.tangents, motions).reshape(-1, 3))[0]

    def back(self, corners: np.ndarray) -> np.ndarray:
        """Return the derivatives (m, 2, 2) of the places in the blank with those in the triangles."""
        return np.stack((corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=2) @ self.inverse

    def strain(self, corners: np.ndarray) -> np.ndarray:
        """Return the logarithmic strains (m, 2, 2), in the axes of the triangles, of corners (m, 3, 2) in the blank."""
        back = self.back(corners)
        square = np.swapaxes(back, 1, 2) @ back
        mean = 0.5 * (square[:, 0, 0] + square[:, 1, 1])
        half = 0.5 * (square[:, 0, 0] - square[:, 1, 1])
        root = np.sqrt(half**2 + square[:, 0, 1]**2)
        high = mean + root
        low = (square[:, 0, 0] * square[:, 1, 1] - square[:, 0, 1]**2) / high
        log_high, log_low = np.log(high), np.log(low)
        gap = high - low
        slope = np.where(gap > 1e-6 * high, (log_high - log_low) / np.where(gap > 0, gap, 1), 2 / (high + low))
        deviator = square - mean[:, None, None] * np.eye(2)
        return np.asarray(-0.5 * (0.5 * (log_high + log_low)[:, None, None] * np.eye(2)
                                  + slope[:, None, None] * deviator))

    def forces(self, corners: np.ndarray) -> np.ndarray:
        """Return the forces (m, 3, 2) along the surface at the nodes of each triangle, over thickness and strength."""
        flat = 0.5 * doubled(corners)
        pull = np.einsum("mij,mkj->mki", self.sheet.stress(self.strain(corners)), self.gradient)
        return np.asarray(flat[:, None, None] * np.einsum("mkil,mkl->mki", self.along, pull))

    def assembled(self, forces: np.ndarray) -> np.ndarray:
        """Return the sums at the nodes (n, 2)."""
        total = np.zeros((len(self.mesh.nodes), 2))
        for k in range(3):
            np.add.at(total, self.mesh.triangles[:, k], forces[:, k])
        return total

    def strain_change(self, back: np.ndarray) -> np.ndarray:
        """Return the derivatives (m, 3, 2, 2, 2) of the strains with the places of the corners."""
        value, axes = np.linalg.eigh(np.swapaxes(back, 1, 2) @ back)
        gap, total = np.diff(value, axis=1)[:, 0], value.sum(axis=1)
        clear = gap > 1e-6 * total
        factor = 1 / np.stack((value, value), axis=1)
        factor[:, 0, 1] = factor[:, 1, 0] = np.where(
            clear, np.diff(np.log(value), axis=1)[:, 0] / np.where(clear, gap, 1), 2 / total)
        # In the principal axes.
        first = np.einsum("mai,mij->maj", back, axes)[:, None, :, :, None]
        second = np.einsum("mki,mij->mkj", self.gradient, axes)[:, :, None, None, :]
        change = first * second
        change = factor[:, None, None] * (change + np.swapaxes(change, 3, 4))
        turn = axes[:, None, None]
        return np.asarray(-0.5 * turn @ change @ np.swapaxes(turn, 3, 4))

    def tangent(self, corners: np.ndarray) -> csc_array:
        """Return the derivatives of the forces with the places."""
        count = len(self.mesh.triangles)
        back, strain, area = self.back(corners), self.strain(corners), 0.5 * doubled(corners)
        cofactor = np.stack((back[:, ::-1, 1], -back[:, ::-1, 0]), axis=2) * np.array([1, -1])[:, None]
        widening = np.einsum("mai,mki->mka", cofactor, self.gradient) / np.linalg.det(back)[:, None, None]
        stress = self.sheet.stress(strain)
        change = self.sheet.stress_change(strain, self.strain_change(back))
        change += widening[..., None, None] * stress[:, None, None]
        pull = np.einsum("mkaij,mlj->mlika", change, self.gradient).reshape(count, 3, 2, 6)
        blocks = area[:, None, None, None] * (self.along @ pull)
        dof = (2 * self.mesh.triangles[:, :, None] + np.arange(2)).reshape(count, 6)
        row, column = np.repeat(dof, 6, axis=1), np.tile(dof, (1, 6))
        size = 2 * len(self.mesh.nodes)
        return coo_array((blocks.reshape(-1), (row.ravel(), column.ravel())), shape=(size, size)).tocsc()


def unfolded(path: Path, balance: Balance) -> np.ndarray:
    """Return the places (n, 2) of the nodes in the flat blank, as close to their plan as a rigid motion brings them.

    A deep part has no equilibrium without friction if its sheet hardens little: the exponent of the sheet is then left
    at the least one that has.
    """
    mesh = balance.mesh
    start = rigid_map(mesh, tutte_map(mesh, rims(path, mesh.triangles)))

    if not upright(mesh, start):
        raise Problem(f"{path}: the surface cannot be laid flat without folds")
    wanted, tolerance = balance.sheet.exponent, ROUGH
    places, reached, step = start, np.inf, FIRST_STEP
    while reached > wanted:
        balance.sheet.exponent = trial = 1.0 if reached > 1 else max(wanted, reached - step)
        found = solved(balance, places, SOLVED if trial == wanted else tolerance)
        if found is not None:
            places, reached, step = found, trial, 1.5 * step
        elif tolerance == ROUGH:
            # Rough equilibria are found at lower exponents than exact ones: once more, with exact ones on the way.
            tolerance, places, reached, step = SOLVED, start, np.inf, FIRST_STEP
        elif reached > 1:
            raise Problem(f"{path}: the equilibrium of the membrane is not found; try another --size")
        elif step < LAST_STEP:
            balance.sheet.exponent = reached
            break
        else:
            step /= 2
    return in_plan(places, mesh.nodes[:, :2])


def upright(mesh: Triangles, places: np.ndarray) -> bool:
    """Tell whether no triangle is turned over in the plane."""
    return bool((doubled(places[mesh.triangles]) > 0).all())


def doubled(corners: np.ndarray) -> np.ndarray:
    """Return twice the areas of triangles in the plane (n, 3, 2), negative of those that are turned over."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.asarray(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0])


def solved(balance: Balance, places: np.ndarray, tolerance: float) -> np.ndarray | None:
    """Return the places of equilibrium, within a residual over the largest force, or None if they are not found, by
    Newton's method, with steps that are halved until the forces out of balance fall and no triangle turns over. The
    steps are orthogonal to rigid motions in the plane."""
    mesh, count = balance.mesh, len(places)
    residual = out_of_balance(balance, places)
    for _ in range(NEWTON_STEPS):
        corners = places[mesh.triangles]
        if abs(residual).max() <= tolerance * max(abs(balance.forces(corners)).max(), LEAST * balance.length):
            return places
        matrix = bmat([[balance.tangent(corners), csc_array(balance.carried)],
                       [csc_array(rigid_motions(places).reshape(-1, 3).T), None]], format="csc")
        factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
        step = factors.solve(np.concatenate((-residual, np.zeros(3))))[:2 * count].reshape(-1, 2)
        share, before = 1.0, np.linalg.norm(residual)
        while share >= SHORTEST:
            trial = places + share * step
            if upright(mesh, trial):
                residual = out_of_balance(balance, trial)
                if np.linalg.norm(residual) < (1 - 1e-4 * share) * before:
                    break
            share /= 2
        else:
            break
        places = trial
    return None


def out_of_balance(balance: Balance, places: np.ndarray) -> np.ndarray:
    """Return the forces along the surface (2 n), without their parts along the part's rigid motions in plan. A sheet
    without friction has no equilibrium with them unless the part is symmetric; they are carried as by friction."""
    forces = balance.assembled(balance.forces(places[balance.mesh.triangles])).ravel()
    return np.asarray(forces - balance.carried @ (balance.carried.T @ forces))


def rigid_motions(places: np.ndarray) -> np.ndarray:
    """Return the two translations and the rotation of places (n, 2) in the plane: orthogonal unit vectors (n, 2, 3)."""
    motions = np.zeros((len(places), 2, 3))
    motions[:, 0, 0] = motions[:, 1, 1] = 1.0
    centred = places - places.mean(axis=0)
    motions[:, 0, 2], motions[:, 1, 2] = -centred[:, 1], centred[:, 0]
    return np.asarray(motions / np.linalg.norm(motions, axis=(0, 1)))


def in_plan(places: np.ndarray, plan: np.ndarray) -> np.ndarray:
    """Return places moved as a rigid body, as close to those in plan as possible."""
    centre, middle = places.mean(axis=0), plan.mean(axis=0)
    moment = (places - centre).T @ (plan - middle)
    angle = np.arctan2(moment[0, 1] - moment[1, 0], moment[0, 0] + moment[1, 1])
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return np.asarray((places - centre) @ turn + middle)


def main(words: Sequence[str] | None = None) -> None:
    """Estimate the blank of the command line."""
    parser = new_parser("unfold", __doc__)
    parser.add_argument("part", type=Path, metavar="PART",
                        help=f"STEP, IGES or BREP file, or facets: {' '.join(SUFFIXES)}")
    parser.add_argument("output", type=Path, metavar="OUTPUT", help="file of the outline")
    parser.add_argument("--exponent", type=float, default=0.2, metavar="N", help="of the hardening law (0.2)")
    parser.add_argument("--r", type=float, default=1.0, help="mean r-value of the sheet (1)")
    parser.add_argument("--mirror", nargs="+", default=[], choices=["x", "y"], metavar="AXIS",
                        help="planes of symmetry of which the part is one side")
    parser.add_argument("--size", type=float, metavar="LENGTH",
                        help="sides of the triangles of a CAD file, mm (a fiftieth of the part)")
    parser.add_argument("--side", choices=["upper", "lower"], help="of a solid (lower)")
    parser.add_argument("--faces", nargs="+", metavar="N", help="faces of a CAD file, with all that join them smoothly")
    parser.add_argument("--fields", type=Path, metavar="VTP", help="file of the part with thinning and strains")
    options = parser.parse_args(words)
    if not 0 <= options.exponent < 1 or options.r <= 0 or (options.size or 1) <= 0:
        parser.error("--exponent takes 0 to below 1, --r and --size numbers above 0")
    if not options.part.is_file():
        raise Problem(f"{options.part}: No such file")
    facets = options.part.suffix.lower() in SUFFIXES
    if facets and (options.size or options.faces or options.side):
        parser.error("--size, --faces, --side: only of a CAD file")
    mesh = of_facets(options.part) if facets else of_cad(options.part, options.size, options.side, options.faces)
    mesh = prepared(options.part, mesh, ["xyz".index(axis) for axis in options.mirror])
    balance = Balance(mesh, Sheet(options.exponent, options.r))
    places = unfolded(options.part, balance)
    strain = balance.strain(places[mesh.triangles])
    thinning = 1 - np.exp(-np.trace(strain, axis1=1, axis2=2))
    border = sorted((places[rim] for rim in rims(options.part, mesh.triangles)),
                    key=lambda points: -float(np.ptp(points, axis=0).max()))
    write_curves(options.output, [np.column_stack((points, np.zeros(len(points)))) for points in border],
                 f"the blank of {options.part.name}, by dd3 unfold")
    if options.fields:
        write_fields(options.fields, mesh, places, thinning, balance.sheet.equivalent(strain))
    if balance.sheet.exponent > options.exponent:
        print(f"note: the part tears without friction with an exponent of {options.exponent:g}; the blank is that of "
              f"{balance.sheet.exponent:.2g}")
    print(f"{options.output}: {len(border)} curve{'s' * (len(border) > 1)}, {len(mesh.triangles)} triangles; "
          f"thinning {100 * thinning.min():.1f} to {100 * thinning.max():.1f} %")


def write_fields(path: Path, mesh: Triangles, places: np.ndarray, thinning: np.ndarray, strain: np.ndarray) -> None:
    """Write the part with its fields."""
    import pyvista as pv
    surface = pv.PolyData.from_regular_faces(mesh.nodes, mesh.triangles)
    surface.cell_data["thinning"], surface.cell_data["equivalent_plastic_strain"] = thinning, strain
    surface.point_data["blank"] = np.column_stack((places, np.zeros(len(places))))
    surface.save(path)
