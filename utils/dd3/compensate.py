# SPDX-License-Identifier: GPL-3.0-or-later
"""Correct the tools of a process for springback, until the free part has the shape that was drawn at first.

    dd3 compensate rail.toml --tools tools
    dd3 compensate rail.toml --tools tools --loops 4 --tolerance 0.1 --mirror y
    dd3 compensate rail.toml --tools tools --fixture fixture.toml
    dd3 compensate line.toml --tools tools@draw flange_tools@flange

The displacement adjustment: where the free part, aligned as a whole, lies beside the wanted shape, the surface of the
tools is moved by as much to the other side, and the process runs again. The wanted shape is the sheet under the closed
tools in the first loop; the free part is that at the end of the last operation. What reaches beyond
the rim of the wanted shape, where less was drawn in, is corrected by the continuation of that, but not compared. The
displacement is a smooth function along the drawn sheet and moves all tools with the sheet beside them: patches stay
joined, gaps between tools stay. Where a run stops with the corrected tools, half of the correction is tried, then a
quarter. The input files place blank and tools; at the start they need room for what the surfaces are moved by.
--mirror names the planes of symmetry x = 0, y = 0; --half-turn tells that the whole part is its own image after half a
turn about z. With --fixture the part is compared as `dd3 deviation` does, in the coordinates of the last operation:
clamped, if the fixture has clamps or gravity, else free after its alignment; its nominal shape, by default the sheet
under the closed tools of the first loop, is the wanted one.

--tools names parameters (*PARAMETER) of the input files that hold a folder of tool surfaces: NAME of all operations
that have it, NAME@OPERATION of one. Each place of the sheet belongs to the last operation that bends it, or moves it by
a bend, the rest to the first one. The tools of an operation are corrected for the deviation of its region, turned back
by *START; those of a later operation relative to the sheet beside the region. With --hold the largest part that no
operation bends belongs to none, and the tools beside it stay.

The results are in <process>.compensate: the surfaces of each loop, deviations.csv, and the best tools as .bez and STEP
files. The operations are left as they are with these; --report writes their report.

Sources: Gan and Wagoner, Int. J. Mech. Sci. 46 (2004) 1097-1113 (displacement adjustment); Lingbeek, Huetink, Ohnimus,
Petzoldt and Weiher, J. Mater. Process. Technol. 169 (2005) 115-125 (smooth displacement of the tools' surfaces).
"""
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from dd3.errors import LOG, Problem, Stopped
from dd3.fixture import Fixture, read_fixture
from dd3.fixture_target import BEYOND, Free, Measured, Target, lower_face
from dd3.line import NONE, Stage, Wanted, carried, stages_of, wanted_shape
from dd3.moved_tools import along_sheet, moved_surface, smooth_field, write_step
from dd3.nominal import InitialFace, initial_face, sheet_surface
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
from dd3.springback import steps_with_tools, tell_symmetry
from dd3.tools.surface import write

BAND = 1.0  # sheet beside a region by which this is placed, over the length of the means: standard deviation
PARTS = (1.0, 0.5, 0.25)  # of a correction, one after the other until the process runs to its end
UNKNOWN = "E115"  # code of the error of a parameter that an input file does not have


@dataclass
class Shapes:
    """The sheet under the tools: its lower face in its initial shape, the present places of the nodes of this, mm, and
    the displacements of the tools by the names of their files; sheet and step."""

    blank: InitialFace
    drawn: np.ndarray
    tools: dict[str, np.ndarray]
    sheet: Sheet
    step: int


def shapes_of(stage: Stage) -> Shapes:
    """Return the sheet under the tools of an operation."""
    folder = stage.operation.folder
    sheet, job = Sheet(folder), read_job(folder)
    step = int(steps_with_tools(sheet, job["phases"])[-1])
    return Shapes(initial_face(sheet, step, upper=False), lower_face(sheet, step)[1],
                  tool_places(folder, job, sheet, step), sheet, step)


def tool_places(folder: Path, job: dict[str, Any], sheet: Sheet, step: int) -> dict[str, np.ndarray]:
    """Return the displacement of each tool's file at a step."""
    files = [Path(tool["patches"]).name for tool in job["tools"]]
    if len(set(files)) < len(files):
        raise Problem(f"{folder}: two tools have the same file; expected one for each")
    history = read_frame(folder, "history.csv")
    if any(abs(history[name]).max() > 0 for name in map(str, history.columns) if name.endswith("_angle")):
        raise Problem(f"{folder}: a tool turns; expected tools that are moved or pressed")
    phase = job["phases"][int(sheet.file["job"]["phase"][step]) - 1]["name"]
    row = history[history["phase"] == phase].iloc[-1]
    return {Path(tool["patches"]).name: np.array([float(row[f"{tool['name']}_u{axis}"]) for axis in AXES])
            for tool in job["tools"]}


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


def chosen_operations(program: Path, process: Process, names: Sequence[str]) -> dict[str, str]:
    """Return the parameter of the tools by the names of the operations that have one: NAME is of all input files with
    this parameter, NAME@OPERATION of one."""
    parameters: dict[str, str] = {}
    for text in names:
        name, at, chosen = text.partition("@")
        known = [operation.name for operation in process.operations]
        if at and chosen not in known:
            raise Problem(f"{process.path}: error: no operation '{chosen}'; there are: {', '.join(known)}")
        found = [operation.name for operation in with_parameter(program, process, name)]
        if at and chosen not in found:
            raise Problem(f"{process.path}: error: the input file of '{chosen}' does not have the parameter '{name}'")
        for operation in [chosen] if at else found:
            if operation in parameters:
                raise Problem(f"{process.path}: error: --tools names the tools of '{operation}' twice")
            parameters[operation] = name
    return parameters


@dataclass
class Correction:
    """The tools of an operation that are corrected: index of its stage, the parameters of the operations that use them
    by their names, whether it begins the line, and the planes of symmetry in its coordinates."""

    number: int
    stage: Stage
    parameters: dict[str, str]
    mirror: list[str]

    @property
    def name(self) -> str:
        """The name of the operation."""
        return self.stage.name

    def vectors(self, part: Measured, owner: np.ndarray, target: Target | Free, reach: float, thickness: float
                ) -> Measured:
        """Return the nodes that the operation forms beside where they are to be: as they lie beside the sheet that
        earlier operations form, else after the alignment of the part; with a free part, of these nodes."""
        own, base = owner == self.number, owner < self.number
        rows = Measured(part.initial[own], part.place[own], part.goal[own], part.compared[own])
        if base.any():
            carry = carried(part.initial[base], part.goal[base], part.place[base], rows.initial, reach)
            place = carry.back(rows.place)
            return Measured(rows.initial, place, *target.feet(place, thickness))
        return target.beside(rows) if isinstance(target, Free) and not own.all() else rows


class Region(NamedTuple):
    """What an operation forms of the part: the nodes beside where they are to be, and the initial places of those that
    earlier operations form."""

    correction: Correction
    nodes: Measured
    still: np.ndarray


def corrections_of(program: Path, process: Process, stages: Sequence[Stage], wanted: Wanted, names: Sequence[str],
                   mirror: Sequence[str], half_turn: bool, hold: bool) -> list[Correction]:
    """Return the operations whose tools are corrected."""
    parameters = chosen_operations(program, process, names)
    found = []
    for number, stage in enumerate(stages):
        mine = {operation.name: parameters.pop(operation.name) for operation in stage.members
                if operation.name in parameters}
        if not mine:
            continue
        missing = [operation.name for operation in stage.members if operation.name not in mine]
        if missing:
            raise Problem(f"{process.path}: error: '{missing[0]}' has the same tools as '{next(iter(mine))}'; expected "
                          "--tools for both")
        folders = {str(Path(tool["patches"]).parent.resolve()) for tool in stage.job["tools"]}
        if len(folders) > 1:
            raise Problem(f"{stage.operation.deck}: error: tools in {len(folders)} folders; expected all in the folder "
                          f"of the parameter '{mine[stage.name]}'")
        if not (wanted.owner == number).any():
            raise Problem(f"{process.path}: error: no place of the part is formed by '{stage.name}' as the last one; "
                          "expected --tools of other operations" + " or no --hold" * hold)
        found.append(Correction(number, stage, mine, stage.axes(mirror, half_turn)))
    explicit = [text.partition("@")[2] for text in names if "@" in text]
    without = [name for name in parameters if name in explicit]
    if without or not found:
        raise Problem(f"{process.path}: error: " + (f"'{without[0]}' has" if without else "the operations have")
                      + " no phase with tools that act on the sheet of the last operation")
    return found


@dataclass
class Loop:
    """The files of the tools by the names of the operation and of the file; the largest deviation of the part and its
    root mean square, mm, the same of what each operation forms, and the largest of what is corrected."""

    tools: dict[str, dict[str, Path]]
    largest: float
    rms: float
    parts: dict[str, tuple[float, float]]
    judged: float

    def folder(self, name: str) -> str:
        """The folder of the tools of an operation."""
        return str(next(iter(self.tools[name].values())).parent.resolve())


def write_moved(folder: Path, tools: dict[str, Path], places: dict[str, np.ndarray], move: Any, size: float,
                note: str) -> dict[str, Path]:
    """Write tools with their points moved; return the files by the names of the tools."""
    made_folder(folder)
    for name, path in tools.items():
        write(folder / name, moved_surface(path, move, size, places[name]), [f"{name} of {note}"])
    return {name: folder / name for name in tools}


def deviation(part: Measured) -> tuple[float, float]:
    """Return the largest deviation of the compared nodes of a part and its root mean square, mm."""
    distance = part.distances()
    return (float(distance.max()), float(np.sqrt((distance**2).mean()))) if distance.size else (0.0, 0.0)


class Compensation:
    """The loops of a process. names: parameters of the tools, as --tools; length: of the means and patches, mm."""

    def __init__(self, program: Path, process: Process, names: Sequence[str], factor: float, mirror: Sequence[str],
                 size: float | None, threads: int | None, half_turn: bool, fixture: Fixture | None, hold: bool
                 ) -> None:
        self.program, self.process, self.threads = program, process, threads
        self.factor, self.half_turn = factor, half_turn
        self.work = made_folder(process.path.parent / f"{process.path.stem}.compensate")
        chosen_operations(program, process, names)
        run_process(program, process, threads)
        stages = stages_of(process)
        last = Sheet(process.operations[-1].folder)
        tell_symmetry(last, last.last, mirror, "the best fit may turn the part", "--mirror")
        self.thickness = max(stages[0].job["sheet"]["thickness"])
        self.length = size or 5 * self.thickness
        self.wanted = wanted_shape(stages, BAND * self.length, hold=hold)
        self.corrections = corrections_of(program, process, stages, self.wanted, names, mirror, half_turn,
                                           hold)
        # Motion of the first of them to the coordinates of the last, and the planes of symmetry in its own.
        self.first, self.planes = stages[0].motion, stages[0].axes(mirror, half_turn)
        self.whole = {correction.number for correction in self.corrections} >= set(self.wanted.owner.tolist()) - {NONE}
        self.target: Target | Free = Free(self.wanted.face, mirror, self.thickness)
        if fixture:
            face = wanted_shape(stages, BAND * self.length, True, hold).face if fixture.upper else self.wanted.face
            self.target = Target(fixture, face, BEYOND * self.thickness)
        self.tools = {correction.name: {Path(tool["patches"]).name: Path(tool["patches"])
                                        for tool in correction.stage.job["tools"]} for correction in self.corrections}
        self.found: list[Loop] = []

    def measure(self) -> list[Region]:
        """Measure the part and add the loop; return what the operations form of it."""
        run = self.process.operations[-1].folder
        words: list[object] = ["--threads", self.threads] if self.threads else []
        part = (self.target.measure(run) if isinstance(self.target, Free)
                else self.target.measure(self.program, run, self.work, words))
        owner = self.wanted.owners(part.initial)
        regions = [Region(correction, correction.vectors(part, owner, self.target, BAND * self.length, self.thickness),
                          part.initial[owner < correction.number]) for correction in self.corrections]
        parts = {region.correction.name: deviation(region.nodes) for region in regions}
        largest, rms = deviation(part)
        judged = largest if self.whole else max(most for most, _ in parts.values())
        self.found.append(Loop(self.tools, largest, rms, parts, judged))
        said = f"loop {len(self.found) - 1}: largest deviation {largest:.4g} mm, root mean square {rms:.4g} mm"
        if not (self.whole and len(parts) == 1):
            said += "".join(f"; {name}: {a:.4g} mm, {b:.4g} mm" for name, (a, b) in parts.items())
        if not part.compared.all():
            said += f", without {sum(~part.compared)} nodes beyond the border of the wanted shape"
        LOG.info(said)
        return regions

    def correct(self, regions: Sequence[Region]) -> Problem | None:
        """Correct the tools and run the process; return what stopped it."""
        number, stopped = len(self.found), None
        shapes = [shapes_of(region.correction.stage) for region in regions]
        for fraction in PARTS:
            settings = {}
            for region, shape in zip(regions, shapes):
                name = region.correction.name
                folder = self.work / f"loop_{number}" / (name if len(regions) > 1 else "")
                moved = write_moved(folder, self.found[-1].tools[name], shape.tools,
                                    self.movement(region, shape, fraction), self.length if number == 1 else np.inf,
                                    f"loop {number} of dd3 compensate {self.process.path.name}")
                self.tools = {**self.tools, name: moved}
                settings.update(self.settings_of(region.correction, str(folder.resolve())))
            stopped = self.run_with(settings)
            if not isinstance(stopped, Stopped):
                break
            LOG.info(f"loop {number} with {fraction:g} of the correction stopped: {stopped}")
        return stopped

    def movement(self, region: Region, shapes: Shapes, fraction: float) -> Any:
        """Return the displacement of the points of an operation's tools: that of its nodes, turned back to its
        coordinates, and none beside the sheet that earlier operations form."""
        nodes, turn = region.nodes, region.correction.stage.motion.rotation
        given = np.vstack((fraction * self.factor * (nodes.goal - nodes.place) @ turn, np.zeros_like(region.still)))
        initial = np.vstack((nodes.initial, region.still))
        places = shapes.blank.at(shapes.drawn, initial)
        level = self.first.back(region.correction.stage.motion.of(places))
        field = smooth_field(places, given, region.correction.mirror, self.length, self.half_turn, (level, self.planes))
        surface = sheet_surface(shapes.sheet, shapes.step, BEYOND * self.thickness)
        return along_sheet(field, surface, self.thickness)

    @staticmethod
    def settings_of(correction: Correction, folder: str) -> dict[str, dict[str, object]]:
        """Return the parameters of the operations that use a folder of tools."""
        return {operation: {parameter: folder} for operation, parameter in correction.parameters.items()}

    def run_with(self, settings: Mapping[str, dict[str, object]]) -> Problem | None:
        """Run the process with other parameters of operations; return what stopped it."""
        for operation in self.process.operations:
            operation.settings.update(settings.get(operation.name, {}))
        return run_with(self.program, self.process, [], {}, self.threads)

    def finish(self, stopped: Problem | None) -> None:
        """Leave the operations with the best tools, and write these."""
        best = min(self.found, key=lambda loop: loop.judged)
        if best is not self.found[-1] or stopped:
            settings = {}
            for correction in self.corrections:
                settings.update(self.settings_of(correction, best.folder(correction.name)))
            again = self.run_with(settings)
            stopped = stopped or again
        for correction in self.corrections:
            folder = made_folder(self.work / (correction.name if len(self.corrections) > 1 else ""))
            for name, path in best.tools[correction.name].items():
                shutil.copy(path, folder / name)
                surface = moved_surface(path, np.zeros_like, np.inf, np.zeros(3))
                write_step(folder / f"{Path(name).stem}.step", surface)
        self.write_table()
        LOG.info(f"tools of loop {self.found.index(best)} in {self.work}")
        if stopped:
            raise Problem(f"loop {len(self.found)} stopped: {stopped}")

    def write_table(self) -> None:
        """Write the deviations of the loops, with those of what each operation forms if there are several."""
        several = len(self.corrections) > 1 or not self.whole
        names = "".join(f",{name}_largest,{name}_rms" for name in self.found[0].parts) if several else ""
        rows = [(loop.largest, loop.rms, *(sum(loop.parts.values(), ()) if several else ())) for loop in self.found]
        write_deviations(self.work / "deviations.csv", "loop,largest,rms" + names, rows, 0)


def compensate(program: Path, process: Process, tools: str | Sequence[str], loops: int, tolerance: float,
               factor: float, mirror: Sequence[str], size: float | None, threads: int | None = None,
               half_turn: bool = False, fixture: Fixture | None = None, hold: bool = False
               ) -> list[tuple[float, float]]:
    """Run the loops; return the largest deviation of the part of each and its root mean square, mm. Where the process
    stops with the corrected tools, the correction is halved.

    tools: parameters as --tools takes them. mirror, half_turn: symmetries in the coordinates of the last operation.
    fixture: in which the part is measured. hold: the tools stay where no operation forms the sheet.
    """
    names = [tools] if isinstance(tools, str) else tools
    work = Compensation(program, process, names, factor, mirror, size, threads, half_turn, fixture, hold)
    stopped: Problem | None = None
    while not stopped:
        regions = work.measure()
        if work.found[-1].judged <= tolerance or len(work.found) > loops:
            break
        stopped = work.correct(regions)
    work.finish(stopped)
    return [(loop.largest, loop.rms) for loop in work.found]


def main(words: Sequence[str] | None = None) -> None:
    """Run the loops of the command line."""
    parser = process_parser("compensate", __doc__)
    parser.add_argument("--tools", required=True, nargs="+", metavar="NAME[@OPERATION]",
                        help="parameters of the input files, or of one, with the folder of the tool surfaces")
    parser.add_argument("--loops", type=int, default=4, help="corrections at most (4)")
    parser.add_argument("--tolerance", type=float, default=0.1, metavar="LENGTH",
                        help="largest deviation that ends the loops, mm (0.1)")
    parser.add_argument("--factor", type=float, default=1.0, help="part of the deviation that is corrected (1)")
    parser.add_argument("--mirror", nargs="+", default=[], choices=list(AXES), metavar="AXIS",
                        help="planes of symmetry of the last operation")
    parser.add_argument("--half-turn", action="store_true",
                        help="the whole part is its own image after half a turn about z")
    parser.add_argument("--hold", action="store_true",
                        help="keep the tools beside the largest part of the sheet that no operation bends")
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
               mirror, options.size, options.threads, options.half_turn, fixture, options.hold)
    if options.report:
        print(write_report(process))
