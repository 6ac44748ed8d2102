# SPDX-License-Identifier: GPL-3.0-or-later
"""The sheet on its way through the operations of a line: which operation formed a place of it, and the shape that their
closed tools give to the whole, in the coordinates of the last operation.

A place belongs to the last operation that bends it plastically, or that turns or moves it by a bend: an operation forms
the elements whose plastic strain it raises, and of the rest what moves against the largest coherent part, beside which
it lies. All that no later operation forms belongs to the first one with tools.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from dd3.alignment import STILL, Rigid
from dd3.deviation import Face, face_of
from dd3.errors import Problem
from dd3.nominal import initial_face, sheet_surface
from dd3.process import Operation, Process
from dd3.run import read_job
from dd3.sheet import AXES, Sheet
from dd3.springback import steps_with_tools

FIELD = "equivalent_plastic_strain"
BENT = 0.005  # rise of the plastic strain of an element that an operation forms
MOVED = 0.25  # motion of a part of the sheet that it forms, over the thickness
FARTHEST = 3.0  # points in a fit, over the standard deviation of their weights
NEAREST = 2.0  # least standard deviation, over the distance of the nodes
NONE = -1  # stage of what no operation forms, if that is held
ALONG = 1e-9  # largest difference of a turned axis from an axis, and of a plane of symmetry from its place, mm


class Motions(NamedTuple):
    """Rigid motions x -> rotation x + shift of points, each its own: (n, 3, 3), (n, 3)."""

    rotation: np.ndarray
    shift: np.ndarray

    def of(self, points: np.ndarray) -> np.ndarray:
        """Return points (n, 3) after their motions."""
        return np.asarray(np.einsum("nij,nj->ni", self.rotation, points) + self.shift)

    def back(self, points: np.ndarray) -> np.ndarray:
        """Return points (n, 3) before their motions."""
        return np.asarray(np.einsum("nji,nj->ni", self.rotation, points - self.shift))


@dataclass
class Stage:
    """An operation with tools: the step at which they are closed, and the motion from its coordinates to those of the
    last operation. before: the sheet that it takes over, at the first step. members: the operation, and those before it
    that use the same tools."""

    operation: Operation
    job: dict[str, Any]
    sheet: Sheet
    step: int
    motion: Rigid
    before: Sheet
    members: list[Operation]

    @property
    def name(self) -> str:
        """The name of the operation."""
        return self.operation.name

    @property
    def files(self) -> set[Path]:
        """The files of its tools."""
        return {Path(tool["patches"]).resolve() for tool in self.job["tools"]}

    def axes(self, mirror: Sequence[str], half_turn: bool) -> list[str]:
        """Return the planes of symmetry in the coordinates of the operation, of those in the last one's."""
        said = f"error: *START between '{self.name}' and the last operation moves"
        found = []
        for axis in mirror:
            normal = self.motion.rotation[AXES.index(axis)]
            chosen = int(np.abs(normal).argmax())
            if abs(abs(normal[chosen]) - 1) > ALONG or abs(self.motion.shift[AXES.index(axis)]) > ALONG:
                raise Problem(f"{self.operation.deck}: {said} the plane of symmetry {axis} = 0; expected x, "
                              "y or z = 0 in both")
            found.append(AXES[chosen])
        stays = abs(abs(self.motion.rotation[2, 2]) - 1) <= ALONG and np.abs(self.motion.shift[:2]).max() <= ALONG
        if half_turn and not stays:
            raise Problem(f"{self.operation.deck}: {said} the axis of --half-turn; expected one that stays on z")
        return found


@dataclass
class Wanted:
    """The shape that the closed tools give to the sheet. face: of the sheet of the last operation that forms it, in the
    coordinates of the last operation. owner: index of the stage that formed each of its nodes, NONE: no one."""

    face: Face
    owner: np.ndarray

    def owners(self, initial: np.ndarray) -> np.ndarray:
        """Return the stages that formed places, by their initial positions."""
        return np.asarray(self.owner[cKDTree(self.face.initial).query(initial)[1]])


def start_motion(job: dict[str, Any]) -> Rigid:
    """Return the motion of the sheet by the rotations and the displacement of *START."""
    motion = STILL
    for entry in start_entries(job):
        if entry["key"] == "turn":
            point, axis, angle = np.array(entry["value"][:3]), np.array(entry["value"][3:6]), entry["value"][6]
            turn = Rotation.from_rotvec(np.radians(angle) * axis / np.linalg.norm(axis)).as_matrix()
            motion = Rigid(turn @ motion.rotation, turn @ (motion.shift - point) + point)
    for entry in start_entries(job):
        if entry["key"] == "move":
            motion = Rigid(motion.rotation, motion.shift + np.array(entry["value"]))
    return motion


def start_entries(job: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the entries of *START that the input file gives."""
    return [entry for block in job["input"]["blocks"] if block["keyword"] == "start"
            for entry in block["entries"] if entry["at"]]


def source_of(job: dict[str, Any]) -> Path | None:
    """Return the folder of the run whose sheet a run starts from, that of a phase inside it included."""
    for entry in start_entries(job):
        if entry["key"] == "from":
            return (Path(entry["at"]["file"]).parent / entry["value"]).resolve()
    return None


def stages_of(process: Process) -> list[Stage]:
    """Return the operations with tools that the sheet of the last operation has gone through, in their order; those one
    after the other that use the same tools are one."""
    found: list[Stage] = []
    motion, later = STILL, None
    for operation in reversed(process.operations):
        if later is not None and operation.folder.resolve() not in (later, *later.parents):
            continue
        job = read_job(operation.folder)
        sheet = Sheet(operation.folder)
        steps = steps_with_tools(sheet, job["phases"])
        if steps.size:
            found.insert(0, Stage(operation, job, sheet, int(steps[-1]), motion, sheet, [operation]))
        begin, later = start_motion(job), source_of(job)
        motion = Rigid(motion.rotation @ begin.rotation, motion.rotation @ begin.shift + motion.shift)
        if later is None:
            break
    if not found:
        raise Problem(f"{process.operations[-1].folder}: no phase with tools")
    return merged(found)


def merged(stages: Sequence[Stage]) -> list[Stage]:
    """Return stages with those that use files of the next one's tools joined to it."""
    found: list[Stage] = []
    for stage in stages:
        shared = [other for other in found if other.files & stage.files]
        if not shared:
            found.append(stage)
            continue
        if shared != [found[-1]] or not found[-1].files <= stage.files:
            name = min(file.name for file in shared[0].files & stage.files)
            raise Problem(f"{stage.operation.deck}: error: {name} is also a tool of '{shared[0].name}'; expected "
                          "operations one after the other with the same tools, or other files for each")
        stage.before, stage.members = found[-1].before, [*found[-1].members, *stage.members]
        found[-1] = stage
    return found


def carried(initial: np.ndarray, source: np.ndarray, target: np.ndarray, places: np.ndarray, reach: float) -> Motions:
    """Return the rigid motions of nodes from `source` to `target` beside places: each the least squares over the nodes
    around the nearest one, with the weights of a normal distribution. initial, places: in the blank; reach: standard
    deviation, mm.

    Source: Kabsch, Acta Cryst. A 32 (1976) 922-923.
    """
    tree = cKDTree(initial)
    centre, which = np.unique(tree.query(places)[1], return_inverse=True)
    reach = max(reach, NEAREST * float(np.median(tree.query(initial, 2)[0][:, 1])))
    weight = cKDTree(initial[centre]).sparse_distance_matrix(tree, FARTHEST * reach, output_type="coo_matrix").tocsr()
    weight.data = np.exp(-0.5 * (weight.data / reach)**2) - np.exp(-0.5 * FARTHEST**2)  # no jump where they end
    total = weight @ np.ones(len(initial))
    middle, goal = ((weight @ points) / total[:, None] for points in (source, target))
    products = (source[:, :, None] * target[:, None, :]).reshape(-1, 9)
    moment = ((weight @ products) / total[:, None]).reshape(-1, 3, 3) - middle[:, :, None] * goal[:, None, :]
    left, _, right = np.linalg.svd(moment)
    left[:, :, 2] *= np.linalg.det(left @ right)[:, None]
    rotation = np.swapaxes(left @ right, 1, 2)
    shift = goal - np.einsum("nij,nj->ni", rotation, middle)
    return Motions(rotation[which.ravel()], shift[which.ravel()])


def formed(stage: Stage, face: Face, upper: bool, reach: float) -> np.ndarray:
    """Return which nodes of a face of the sheet an operation has formed since its start."""
    nodes = np.unique(stage.before.faces(upper, 0))
    taken = np.column_stack((stage.before.points(0)[nodes], stage.before.values(0, FIELD)[0][nodes]))
    blank = initial_face(stage.before, 0, upper)
    begin, strain = np.split(blank.at(taken.astype(float), face.initial), [3], axis=1)
    rise = stage.sheet.values(stage.step, FIELD)[0][face.nodes] - strain[:, 0]
    quads = np.searchsorted(face.nodes, stage.sheet.faces(upper, stage.step))
    bent = rise[quads].mean(axis=1) > BENT
    result = np.zeros(len(face.nodes), bool)
    result[quads[bent]] = True
    rest = quads[~bent]
    if not bent.any() or not len(rest):
        return result
    edges = np.stack((rest, np.roll(rest, -1, axis=1)), axis=2).reshape(-1, 2)
    links = coo_array((np.ones(len(edges)), edges.T), shape=(len(result), len(result)))
    part = connected_components(links, directed=False)[1]
    base = part == np.bincount(part[rest[:, 0]], areas(face.initial[rest])).argmax()
    away = np.zeros(len(result))
    motions = carried(face.initial[base], begin[base], face.points[base], face.initial[~base], reach)
    away[~base] = np.linalg.norm(motions.of(begin[~base]) - face.points[~base], axis=1)
    for number in np.unique(part[rest[:, 0]]):
        if away[part == number].mean() > MOVED * face.thickness:
            result[part == number] = True
    return result


def areas(corners: np.ndarray) -> np.ndarray:
    """Return the areas of quadrilaterals (n, 4, 3)."""
    across = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    return np.asarray(np.linalg.norm(across, axis=1) / 2)


def wanted_shape(stages: Sequence[Stage], reach: float, upper: bool = False, hold: bool = False) -> Wanted:
    """Return the shape of a face of the sheet under closed tools: what a later operation forms lies beside the rest as
    under its tools. reach: length over which the two are fitted, mm. hold: what no operation forms belongs to none."""
    shape: Wanted | None = None
    for number, stage in enumerate(stages):
        face = face_of(stage.sheet, stage.step, upper)
        own = formed(stage, face, upper, reach) if shape or hold else np.ones(len(face.nodes), bool)
        if shape and not own.any():
            continue
        points = stage.motion.of(face.points)
        owner = np.where(own, number, NONE)
        if shape and not own.all():
            rest = shape.face.blank.at(shape.face.points, face.initial[~own])
            points[own] = carried(face.initial[~own], points[~own], rest, face.initial[own], reach).of(points[own])
            points[~own], owner[~own] = rest, shape.owners(face.initial[~own])
        shape = Wanted(face._replace(points=points), owner)
    assert shape is not None
    return Wanted(shape.face._replace(surface=surface_of_face(shape.face, upper)), shape.owner)


def surface_of_face(face: Face, upper: bool = False, beyond: float = 0.0) -> Any:
    """Return a face of a sheet, in its own places, as a surface, continued beyond its border by a length."""
    points = np.array(face.sheet.points(face.step))
    points[face.nodes] = face.points
    return sheet_surface(face.sheet, face.step, beyond, upper, points)
