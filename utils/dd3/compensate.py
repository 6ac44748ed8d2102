# SPDX-License-Identifier: GPL-3.0-or-later
"""Correct the tools of a process for springback, until the free part has the shape that was drawn at first.

    dd3 compensate rail.toml --tools tools
    dd3 compensate rail.toml --tools tools --loops 4 --tolerance 0.1 --mirror y
    dd3 compensate rail.toml --tools tools --fixture fixture.toml

The displacement adjustment: where the free part, aligned as a whole, lies beside the wanted shape, the surface of the
tools is moved by as much to the other side, and the process runs again. The wanted shape is the sheet under the tools
at the end of the draw in the first loop; the free part is that at the end of the last operation. What reaches beyond
the rim of the wanted shape, where less was drawn in, is corrected by the continuation of that, but not compared. The
displacement is a smooth function along the drawn sheet and moves all tools with the sheet beside them: patches stay
joined, gaps between tools stay. Where a run stops with the corrected tools, half of the correction is tried, then a
quarter. The input files place blank and tools; at the start they need room for what the surfaces are moved by.
--mirror names the planes of symmetry x = 0, y = 0; --half-turn tells that the whole part is its own image after half a
turn about z. With --fixture the part is compared as `dd3 deviation` does, in the place of the tools: clamped, if the
fixture has clamps or gravity, else free after its alignment; its nominal shape, by default the drawn sheet of the first
loop, is the wanted one.

--tools names the parameter (*PARAMETER) of the input files that holds the folder of the tool surfaces. The results are
in <process>.compensate: the surfaces of each loop, deviations.csv, and the best tools as .bez and STEP files. The
operations are left as they are with these; --report writes their report.

Sources: Gan and Wagoner, Int. J. Mech. Sci. 46 (2004) 1097-1113 (displacement adjustment); Lingbeek, Huetink, Ohnimus,
Petzoldt and Weiher, J. Mater. Process. Technol. 169 (2005) 115-125 (smooth displacement of the tools' surfaces).
"""
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import RBFInterpolator
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from dd3.errors import LOG, Problem, Stopped
from dd3.fixture import Fixture, read_fixture
from dd3.fixture_target import Measured, Target
from dd3.gmsh_session import session
from dd3.nominal import at_places, normal_feet, sheet_surface
from dd3.process import (
    Operation,
    Process,
    check_deck,
    process_parser,
    read_process,
    run_process,
    run_with,
    write_deviations,
    write_report,
)
from dd3.programs import find_program, made_folder
from dd3.run import read_frame, read_job
from dd3.sheet import AXES, Sheet
from dd3.springback import best_fit, images, steps_with_tools
from dd3.tools.cad_file import silence
from dd3.tools.surface import Patches, Surface, from_nodes, points_on, read_patches, write

MOST_POINTS = 2000  # of the smooth function
ROUND = 4.0  # radius at the tips of the multiquadrics, over the distance of the places
FARTHEST = 3.0  # points in a mean, over its standard deviation
BEYOND = 50.0  # continuation of the sheet for the tools, over its thickness
BORDER = 0.25  # largest distance beside the border of the wanted shape at which a node is compared, over the thickness
MOST_FITS, SETTLED = 100, 1e-5  # iterations of the alignment, and the relative gain of one that ends it
PARTS = (1.0, 0.5, 0.25)  # of a correction, one after the other until the process runs to its end
UNKNOWN = "E115"  # code of the error of a parameter that an input file does not have


@dataclass
class Shapes:
    """The sheet under the tools: initial and present places of the nodes of its lower face, mm, and the displacements
    of the tools by the names of their files."""

    initial: np.ndarray
    drawn: np.ndarray
    tools: dict[str, np.ndarray]


def lower_face(sheet: Sheet, step: int) -> tuple[np.ndarray, np.ndarray]:
    """Return initial and present positions of the nodes of the lower face at a step."""
    points = sheet.points(step)
    initial = sheet.initial(step)
    nodes = np.unique(sheet.faces(False, step))
    return initial[nodes], points[nodes]


def drawn_step(sheet: Sheet, job: dict[str, Any]) -> int:
    """Return the last step at which tools act."""
    steps = steps_with_tools(sheet, job["phases"])
    if not steps.size:
        raise Problem(f"{sheet.path}: no phase with tools")
    return int(steps[-1])


def shapes_of(process: Process) -> Shapes:
    """Return the sheet under the tools of the first operation, the draw."""
    first = Sheet(process.operations[0].folder)
    job = read_job(process.operations[0].folder)
    step = drawn_step(first, job)
    return Shapes(*lower_face(first, step), tool_places(process.operations[0].folder, job, first, step))


def free_part(process: Process, shapes: Shapes, wanted: Any, around: Any, mirror: Sequence[str], border: float
              ) -> Measured:
    """Return the free part of the last operation after its best alignment with a surface; nodes beyond the border of
    this are to be on its continuation `around`."""
    last = Sheet(process.operations[-1].folder)
    initial, free = lower_face(last, last.last)
    place, goal, compared = aligned(free, at_places(shapes.initial, shapes.drawn, initial), wanted, mirror, border)
    if not compared.all():
        goal[~compared] = normal_feet(place[~compared], around)[0]
    return Measured(initial, place, goal, compared)


def tool_places(folder: Path, job: dict[str, Any], sheet: Sheet, step: int) -> dict[str, np.ndarray]:
    """Return the displacement of each tool's file at a step."""
    files = [Path(tool["patches"]).name for tool in job["tools"]]
    if len(set(files)) < len(files):
        raise Problem(f"{folder}: two tools have the same file; expected one for each")
    history = read_frame(folder, "history.csv")
    if any(abs(history[name]).max() > 0 for name in history if name.endswith("_angle")):
        raise Problem(f"{folder}: a tool turns; expected tools that are moved or pressed")
    phase = job["phases"][int(sheet.file["job"]["phase"][step]) - 1]["name"]
    row = history[history["phase"] == phase].iloc[-1]
    return {Path(tool["patches"]).name: np.array([float(row[f"{tool['name']}_u{axis}"]) for axis in AXES])
            for tool in job["tools"]}


def drawn_surface(process: Process, beyond: float = 0.0) -> Any:
    """Return the lower face of the whole sheet under the tools as a surface, see `sheet_surface`."""
    sheet = Sheet(process.operations[0].folder)
    return sheet_surface(sheet, drawn_step(sheet, read_job(sheet.path.parent)), beyond)


def aligned(free: np.ndarray, drawn: np.ndarray, wanted: Any, mirror: Sequence[str], border: float
            ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a free part in the place that fits a surface best, the closest points of the surface, and which nodes
    reach beyond its border by no more than a length: only these are compared.

    The iteration over closest points starts from the place that fits the drawn part best, node by node.
    Source: Besl and McKay, IEEE Trans. Pattern Anal. Mach. Intell. 14 (1992) 239-256.
    """
    place, last = best_fit(free, drawn, mirror), np.inf
    goal, beyond = normal_feet(place, wanted)
    for _ in range(MOST_FITS):
        goal[beyond > border] = place[beyond > border]
        mean = float(np.linalg.norm(goal - place, axis=1).mean())
        if mean > (1 - SETTLED) * last:
            break
        last = mean
        place = best_fit(place, goal, mirror)
        goal, beyond = normal_feet(place, wanted)
    return place, goal, beyond <= border


def nodes_of(patch: tuple[np.ndarray, np.ndarray], in_v: int, in_u: int) -> np.ndarray:
    """Return the points (v, u, 3) of a patch on a regular grid of its parameters, 2 n + 1 points along each."""
    return points_on(*patch, np.linspace(0, 1, 2 * in_v + 1), np.linspace(0, 1, 2 * in_u + 1))


def divisions(patches: Patches, size: float) -> np.ndarray:
    """Return the numbers of parts (n, 2) of the patches along v and u that make them no longer than `size`: the same
    for opposite sides and for patches that share a side."""
    grids = [nodes_of(patch, 4, 4) for patch in patches]
    sides = np.array([[grid[0], grid[-1], grid[:, 0], grid[:, -1]] for grid in grids]).reshape(-1, 9, 3)
    length = np.linalg.norm(np.diff(sides, axis=1), axis=2).sum(axis=1)
    ends, middle = sides[:, [0, -1]].sum(axis=1), sides[:, 4]
    near = 1e-6 * max(float(np.ptp(sides.reshape(-1, 3), axis=0).max()), 1e-300)
    shared = cKDTree(np.hstack([ends, 2 * middle])).query_pairs(4 * near, output_type="ndarray")
    opposite = np.arange(len(sides)).reshape(-1, 2)
    pairs = np.vstack([shared, opposite])
    links = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(sides), len(sides)))
    _, group = connected_components(links, directed=False)
    longest = np.zeros(group.max() + 1)
    np.maximum.at(longest, group, length)
    count = np.maximum(1, np.ceil(longest / size)).astype(int)[group].reshape(-1, 4)
    return np.asarray(count[:, [2, 0]])


def moved_surface(path: Path, displacement: Any, size: float, place: np.ndarray) -> Surface:
    """Return a tool's surface, divided, with its points moved. `place` is its displacement where the displacement of
    its points is given."""
    patches = read_patches(path)
    blocks, face = [], []
    for number, (patch, (in_v, in_u)) in enumerate(zip(patches, divisions(patches, size))):
        nodes = nodes_of(patch, in_v, in_u)
        blocks += [nodes[2 * i:2 * i + 3, 2 * j:2 * j + 3] for i in range(in_v) for j in range(in_u)]
        face += [number] * (in_v * in_u)
    nodes = np.stack(blocks)
    nodes = nodes + displacement(nodes.reshape(-1, 3) + place).reshape(nodes.shape)
    return Surface(from_nodes(nodes), np.array(face), [f"patch {number}" for number in range(1, len(patches) + 1)])


def turned(vectors: np.ndarray) -> np.ndarray:
    """Return vectors and their images after half a turn about z."""
    return np.concatenate((vectors, vectors * (-1.0, -1.0, 1.0)))


def smooth_field(points: np.ndarray, displacement: np.ndarray, mirror: Sequence[str], reach: float,
                 half_turn: bool = False) -> Any:
    """Return a smooth function of the place for a displacement at some points, with the symmetries given:
    multiquadrics through means of place and displacement, with the weights of a normal distribution of the standard
    deviation `reach`, at places as far apart. Its slopes go on beyond the points and fade over some `reach`.

    Source: Hardy, J. Geophys. Res. 76 (1971) 1905-1915.
    """
    whole, given = np.concatenate(images(points, mirror)), np.concatenate(images(displacement, mirror))
    if half_turn:
        whole, given = turned(whole), turned(given)
    size = reach
    while True:
        _, cell, count = np.unique(np.floor(whole / size).astype(int), axis=0, return_inverse=True, return_counts=True)
        if len(count) <= MOST_POINTS:
            break
        size *= 1.25
    places = np.stack([np.bincount(cell.ravel(), whole[:, axis]) / count for axis in range(3)], axis=1)
    near = cKDTree(places).sparse_distance_matrix(cKDTree(whole), FARTHEST * size, output_type="coo_matrix").tocsr()
    near.data = np.exp(-0.5 * (near.data / size)**2)
    weight = (near @ np.ones(len(given)))[:, None]
    places, values = near @ whole / weight, near @ given / weight  # a linear function is kept
    return RBFInterpolator(places, values, kernel="multiquadric", epsilon=1 / (ROUND * size), degree=0)


def along_sheet(field: Any, sheet: Any, thickness: float) -> Any:
    """Return the displacement of the points of tools: that of the sheet's lower face beside them, with their distance
    along its normal kept up to two thicknesses, so that the gaps between the tools stay."""
    def displacement(points: np.ndarray) -> np.ndarray:
        _, closest = sheet.find_closest_cell(points, return_closest_point=True)
        offset = points - closest
        distance = np.linalg.norm(offset, axis=1)
        normal = offset / np.maximum(distance, 1e-12)[:, None]
        kept = np.minimum(distance, 2 * thickness)
        place = points - kept[:, None] * normal
        first = np.cross(normal, np.eye(3)[abs(normal).argmin(axis=1)])
        first /= np.maximum(np.linalg.norm(first, axis=1), 1e-12)[:, None]
        second, step = np.cross(normal, first), 0.1 * thickness
        in_first, in_second = ((field(place + step * axis) - field(place - step * axis)) / (2 * step)
                               for axis in (first, second))
        turned = np.cross(first + in_first, second + in_second)
        turned /= np.maximum(np.linalg.norm(turned, axis=1), 1e-12)[:, None]
        return np.asarray(field(place) + np.where(distance > 1e-9, kept, 0.0)[:, None] * (turned - normal))
    return displacement


def write_step(path: Path, surface: Surface) -> None:
    """Write a surface as a STEP file of Bézier faces."""
    with session() as gmsh, silence():
        for net in surface.net:
            tags = [gmsh.model.occ.addPoint(*point[:3] / point[3]) for point in net.reshape(-1, 4)]
            gmsh.model.occ.addBezierSurface(tags, 3)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))


def with_parameter(program: Path, process: Process, name: str) -> list[Operation]:
    """Return the operations whose input file has a parameter."""
    found = []
    for operation in process.operations:
        trial = Operation(operation.name, operation.deck, {**operation.settings, name: "."})
        _, errors = check_deck(program, trial)
        if f"error {UNKNOWN}" not in errors:
            found.append(operation)
    if not found:
        raise Problem(f"{process.path}: error: no input file has the parameter '{name}' (*PARAMETER)")
    return found


@dataclass
class Loop:
    """The files of the tools by their names, and the largest deviation of the part and its root mean square, mm."""
    tools: dict[str, Path]
    largest: float
    rms: float

    @property
    def folder(self) -> str:
        """The folder of the tools."""
        return str(next(iter(self.tools.values())).parent.resolve())


def write_moved(folder: Path, loop: Loop, places: dict[str, np.ndarray], move: Any, size: float,
                note: str) -> dict[str, Path]:
    """Write the tools of a loop with their points moved; return the files by the names of the tools."""
    for name, path in loop.tools.items():
        write(folder / name, moved_surface(path, move, size, places[name]), [f"{name} of {note}"])
    return {name: folder / name for name in loop.tools}


def compensate(program: Path, process: Process, parameter: str, loops: int, tolerance: float, factor: float,
               mirror: Sequence[str], size: float | None, threads: int | None = None, half_turn: bool = False,
               fixture: Fixture | None = None) -> list[tuple[float, float]]:
    """Run the loops; return the largest deviation of each and its root mean square, mm. Where the process stops with
    the corrected tools, the correction is halved. fixture: in which the part is measured."""
    work = made_folder(process.path.parent / f"{process.path.stem}.compensate")
    operations = with_parameter(program, process, parameter)
    run_process(program, process, threads)
    job = read_job(operations[0].folder)
    tools = {Path(tool["patches"]).name: Path(tool["patches"]) for tool in job["tools"]}
    thickness = max(job["sheet"]["thickness"])
    length = size or 5 * thickness
    wanted, around = drawn_surface(process), drawn_surface(process, BEYOND * thickness)
    target = Target(fixture, Sheet(process.operations[0].folder), BEYOND * thickness) if fixture else None
    found: list[Loop] = []
    stopped: Problem | None = None
    while True:
        shapes = shapes_of(process)
        part = (target.measure(program, process.operations[-1].folder, work, ["--threads", threads] if threads else [])
                if target else free_part(process, shapes, wanted, around, mirror, BORDER * thickness))
        deviation = part.distances()
        found.append(Loop(tools, float(deviation.max()), float(np.sqrt((deviation**2).mean()))))
        LOG.info(f"loop {len(found) - 1}: largest deviation {found[-1].largest:.4g} mm, root mean square "
              f"{found[-1].rms:.4g} mm" + f", without {sum(~part.compared)} nodes beyond the border of the wanted shape"
              * (not part.compared.all()))
        if found[-1].largest <= tolerance or len(found) > loops:
            break
        folder = made_folder(work / f"loop_{len(found)}")
        surface = drawn_surface(process, BEYOND * thickness)
        drawn = at_places(shapes.initial, shapes.drawn, part.initial)
        for fraction in PARTS:
            field = smooth_field(drawn, fraction * factor * (part.goal - part.place), mirror, length, half_turn)
            tools = write_moved(folder, found[-1], shapes.tools, along_sheet(field, surface, thickness),
                                length if len(found) == 1 else np.inf,
                                f"loop {len(found)} of dd3 compensate {process.path.name}")
            stopped = run_with(program, process, operations, {parameter: str(folder.resolve())}, threads)
            if not isinstance(stopped, Stopped):
                break
            LOG.info(f"loop {len(found)} with {fraction:g} of the correction stopped: {stopped}")
        if stopped:
            break
    best = min(found, key=lambda loop: loop.largest)
    if best is not found[-1] or stopped:
        again = run_with(program, process, operations, {parameter: best.folder}, threads)
        stopped = stopped or again
    for name, path in best.tools.items():
        shutil.copy(path, work / name)
        write_step(work / f"{Path(name).stem}.step", moved_surface(path, np.zeros_like, np.inf, np.zeros(3)))
    deviations = [(loop.largest, loop.rms) for loop in found]
    write_deviations(work / "deviations.csv", "loop,largest,rms", deviations, 0)
    LOG.info(f"tools of loop {found.index(best)} in {work}")
    if stopped:
        raise Problem(f"loop {len(found)} stopped: {stopped}")
    return deviations


def main(words: Sequence[str] | None = None) -> None:
    """Run the loops of the command line."""
    parser = process_parser("compensate", __doc__)
    parser.add_argument("--tools", required=True, metavar="NAME",
                        help="parameter of the input files with the folder of the tool surfaces")
    parser.add_argument("--loops", type=int, default=4, help="corrections at most (4)")
    parser.add_argument("--tolerance", type=float, default=0.1, metavar="LENGTH",
                        help="largest deviation that ends the loops, mm (0.1)")
    parser.add_argument("--factor", type=float, default=1.0, help="part of the deviation that is corrected (1)")
    parser.add_argument("--mirror", nargs="+", default=[], choices=list(AXES), metavar="AXIS",
                        help="planes of symmetry")
    parser.add_argument("--half-turn", action="store_true",
                        help="the whole part is its own image after half a turn about z")
    parser.add_argument("--size", type=float, metavar="LENGTH",
                        help="largest side of the patches that are moved, mm (5 thicknesses)")
    parser.add_argument("--fixture", type=Path, metavar="FILE",
                        help="file of the fixture, .toml, in which the part is measured (default: free, best fit)")
    options = parser.parse_args(words)
    if options.loops < 0:
        parser.error("--loops: takes 0 or more")
    process = read_process(options.file)
    fixture = read_fixture(options.fixture) if options.fixture else None
    mirror = sorted({*options.mirror, *(fixture.mirror if fixture else [])})
    compensate(find_program(options.program), process, options.tools, options.loops, options.tolerance, options.factor,
               mirror, options.size, options.threads, options.half_turn, fixture)
    if options.report:
        print(write_report(process))
