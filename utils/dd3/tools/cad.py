# SPDX-License-Identifier: GPL-3.0-or-later
"""CAD files (STEP, IGES, BREP) as Bézier patches, through Gmsh's Python package."""
from pathlib import Path
from typing import Any

import numpy as np

from dd3.account import Account
from dd3.progress import Progress
from dd3.tools import faces, mitres, moved
from dd3.tools.cad_account import enter_cad
from dd3.tools.cad_file import (
    SEW_TIME,
    allowed,
    choose,
    doubled,
    load,
    part_names,
    refuse_gaps,
    said_of_doubled,
    sew,
    silence,
    single,
)
from dd3.tools.cad_mesh import Model, mesh_within, middle_normals, normals
from dd3.tools.cut import cut, is_closed, of_axes, planes_through, planes_through_pole
from dd3.tools.limits import limited
from dd3.tools.report import named
from dd3.tools.settings import CAD, ToolSettings
from dd3.tools.surface import Surface, from_nodes

SUFFIXES = CAD


def read_file(gmsh: Any, path: Path, model: Model, options: ToolSettings) -> list[int]:
    """Read a CAD file: set the parts and notes of the model, and return the faces that are chosen."""
    account = Account()
    load(gmsh, path)
    enter_cad(path, account, len(gmsh.model.getEntities(2)))
    model.notes += [f"left out: {item}" for item in account.left_out()]
    model.notes += single(gmsh)
    model.notes += sew(gmsh, path, options.sew or options.tolerance, options.sew is not None)
    if options.scale != 1.0:
        gmsh.model.occ.dilate(gmsh.model.getEntities(), 0, 0, 0, *[options.scale] * 3)
        gmsh.model.occ.synchronize()
    refuse_gaps(gmsh, path, options.sew)
    model.parts = part_names(gmsh)
    return faces.chosen(gmsh, path, choose(path, model.parts, options.part), options.faces, options.smooth)


def read_closed(gmsh: Any, model: Model, options: ToolSettings) -> list[int]:
    """Read a part whose openings were filled as it was read: set the parts and notes of the model, and return its
    faces."""
    options.closed.load(gmsh)
    model.notes += options.closed.notes
    model.parts = part_names(gmsh)
    return [tag for _, tag in gmsh.model.getEntities(2)]


def read_cad(gmsh: Any, path: Path, options: ToolSettings, progress: Progress) -> Model:
    """Return the model of a CAD file, meshed within the tolerance."""
    model = Model()
    tags = read_closed(gmsh, model, options) if options.closed else read_file(gmsh, path, model, options)
    in_solids = {abs(tag) for _, tag in gmsh.model.getBoundary(gmsh.model.getEntities(3), combined=False,
                                                               oriented=False)}
    number = options.closed.numbers if options.closed else {}
    file_tag = {tag: number.get(tag, tag) for tag in tags}
    if options.taken:
        tags = sorted(options.taken)
    elif not options.closed and options.thickness and not options.faces and set(tags) <= in_solids:
        # The punch touches a sheet from above.
        up = (0, 0, -1 if options.side == "die" else 1)
        tags = faces.side_of_sheet(gmsh, path, tags, moved.rotation(options.rotate).T @ up)
    if options.sharp and in_solids.issuperset(tags):
        origin, said = mitres.rounded(gmsh, tags, options.sharp)
        file_tag = {tag: file_tag.get(old, 0) for tag, old in origin.items()}
        tags = list(file_tag)
        in_solids = set(tags)
        model.notes += said
    twins = doubled(gmsh, tags)
    if twins:
        model.notes.append(said_of_doubled(twins))
    model.tags = [tag for tag in tags if tag not in {twin for twin, _ in twins}]
    model.solid = set(model.tags) <= in_solids
    others = [(2, tag) for _, tag in gmsh.model.getEntities(2) if tag not in model.tags]
    owner = {tag: name for name, faces in model.parts for tag in faces}
    model.origin = [file_tag[tag] for tag in model.tags]
    model.names = [f"face {old} ({gmsh.model.getType(2, tag)}"
                   + (f", {owner.get(tag, owner.get(old))})" if len(model.parts) > 1 else ")")
                   if old else "fillet of a sharp edge"
                   for tag, old in zip(model.tags, model.origin)]
    gmsh.model.removeEntities(gmsh.model.getEntities(3))
    gmsh.model.removeEntities(others)
    tolerance = max(options.tolerance, options.sew or 0.0)
    around = {tag: planes for tag in model.tags if (planes := planes_through_pole(gmsh, tag))}
    closed = [tag for tag in model.tags if tag not in around and is_closed(gmsh, tag)]
    if around or closed:
        low, high = np.reshape(gmsh.model.getBoundingBox(-1, -1), (2, 3))
        through = [*around.values(), *(planes_through(gmsh, tag) for tag in closed)]
        cut_closed(gmsh, path, model, [*around, *closed], of_axes(through, float(np.linalg.norm(high - low))))
    mesh_within(gmsh, path, model, tolerance, getattr(options, "longest", np.inf), progress)
    return model


def cut_closed(gmsh: Any, path: Path, model: Model, closed: list[int], planes: list[tuple[np.ndarray, np.ndarray]]
              ) -> None:
    """Cut faces, all by planes, as some close in themselves; the parts keep the names."""
    gmsh.model.mesh.clear()
    with silence(), limited(allowed(SEW_TIME, path), f"{path}: faces that close in themselves are not cut in "
                            f"{allowed(SEW_TIME, path):.0f} s of processor time; cut them in the CAD program"):
        parts = cut(gmsh, model.tags, planes)
    model.solid = False  # the parts have sides of their own
    model.notes.append("faces that close in themselves were cut: "
                       + named(model, [model.tags.index(tag) for tag in closed]))
    model.names = [name for name, part in zip(model.names, parts) for _ in part]
    model.origin = [tag for tag, part in zip(model.origin, parts) for _ in part]
    model.tags = [tag for part in parts for tag in part]


def surface_of(model: Model, nodes: np.ndarray | None = None) -> Surface:
    """Return the surface of a model, or with its nodes moved."""
    return Surface(from_nodes(model.nodes if nodes is None else nodes), model.face, model.names, list(model.notes))


def outward(gmsh: Any, model: Model) -> np.ndarray | None:
    """Return the signs that turn the patches of solids outwards; None if faces belong to no solid."""
    if not model.solid:
        return None
    return np.where((middle_normals(model) * normals(gmsh, model)[:, 1, 1]).sum(axis=1) < 0, -1, 1)
