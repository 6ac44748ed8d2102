# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the deformed sheet between its tools, coloured by a field, and its draw-beads. No display is needed.

    dd3 plot sheet bending.out
    dd3 plot sheet bending.out --at 10 --at 40 --field stress:11 --view front --mirror x --mesh
    dd3 plot sheet cup.out --field level --hide all             # elements by how often they have been divided
    dd3 plot sheet bending.dat                                 # before a run

The sheet and the tools' displacements are read from fields.vtkhdf, their surfaces from the .bez files that
the run used; for files that were moved since give --tool. Several --at give several pictures below each other. Strains
and thinning are in per cent, and so are their --limits; zero is white where a field has both signs; fracture_damage and
forming_limit_ratio are red from their limit, 1, on. Of an input file the initial state is drawn, which the program
writes after its checks, also if a tool lies in the sheet: do the tools lie where they should?
"""

import argparse
import contextlib
import math
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from dataclasses import field as dataclass_field
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
import pyvista as pv
from matplotlib.figure import Figure

from dd3 import places, rendering
from dd3.command import new_parser
from dd3.errors import LOG, Problem
from dd3.fields import AT, Fields, odd_axes, text_of
from dd3.plot import levels, scale
from dd3.plot.beads import draw_beads
from dd3.plot.scale import Scale
from dd3.plot.skins import SHARP, Box, Placement, diagonal, reflected, sharp_edges, sheet_skin, tool_skin
from dd3.programs import add_program, command, find_program, launch, setting
from dd3.progress import each
from dd3.run import file_of, read_job
from dd3.sheet import AXES
from dd3.tools.surface import Patches, read_patches

VIEWS = {  # direction from the sheet to the camera, and the upward direction
    "iso": ((-0.9, -1.6, 0.9), (0, 0, 1)),
    "front": ((0, -1, 0), (0, 0, 1)),
    "back": ((0, 1, 0), (0, 0, 1)),
    "side": ((-1, 0, 0), (0, 0, 1)),
    "top": ((0, 0, 1), (0, 1, 0)),
    "bottom": ((0, 0, -1), (0, 1, 0)),
    "below": ((-0.9, -1.6, -0.9), (0, 0, 1)),
}
BAR_HEIGHT = 100  # pixels of the strip below the pictures that holds the colour bar
BAR_CHARACTERS = 45  # of the numbers at a colour bar, at most
FIELD, DOTS = "equivalent_plastic_strain", 150  # field of a run; pixels of an inch of a figure
TOOL_COLOURS = ["#8d99a6", "#a69b8d", "#93a68d", "#a08da6"]

@dataclass
class Style:
    """How a sheet is drawn.

    field: field, or field:component, such as stress:11; level: how often the elements were divided. cells: values at
    the elements in place of the nodes. limits: range of the colours, in the unit shown: strains and thinning in per
    cent. colours: colour map, by default that of dd3.plot.scale. view: one of VIEWS, or a direction "x y z". zoom: 1
    for the whole sheet. focus: point in the middle, mm. mirror: planes of symmetry to complete the model at, such as
    "xy". tools: files of surfaces in place of those that the run names, by the names of the tools. hide: tools and
    draw-beads to leave out, or "all". mesh: draw the edges of the elements. size: of one picture, pixels.
    """

    field: str = FIELD
    cells: bool = False
    limits: Sequence[float] | None = None
    colours: str | list[str] | None = None
    view: str = "iso"
    zoom: float = 1.0
    focus: Sequence[float] | None = None
    mirror: Sequence[str] = ()
    tools: Mapping[str, str | Path] = dataclass_field(default_factory=dict)
    hide: Sequence[str] = ()
    tool_opacity: float = 0.35
    mesh: bool = False
    size: Sequence[int] = (1500, 800)

    def __post_init__(self) -> None:
        self.mirror = sorted(set("".join(self.mirror)))
        if self.field == levels.LEVEL:
            self.cells = self.mesh = True
        if self.view not in VIEWS and not direction(self.view):
            raise Problem("--view takes one of " + ", ".join(VIEWS) + ' or a direction "x y z"')
        if self.limits and not self.limits[0] < self.limits[1]:
            raise Problem("--limits takes the lower one first")
        if isinstance(self.colours, str) and self.colours not in matplotlib.colormaps:
            raise Problem(f"no colour map '{self.colours}'; some are viridis, plasma, cividis, turbo, coolwarm")
        if min(self.size) < 1 or not self.zoom > 0:
            raise Problem("--size and --zoom take positive numbers")


class Run(Fields):
    """A run: the sheet at its steps, the tools' displacements, and the lines of the draw-beads to draw. `before`: of an
    input file, before a run."""

    def __init__(self, run: str | Path, job: dict[str, Any] | None = None, before: bool = False) -> None:
        super().__init__(run)
        self.before = before
        self.job = read_job(self.folder) if job is None else job
        self.beads = {bead["name"]: np.array(bead["points"]) for bead in self.job["drawbeads"]}

    def mesh(self, step: int, field: str, at_cells: bool = False) -> tuple[pv.UnstructuredGrid, str]:
        """Return the sheet at a step with its field as `shown`, in the unit of its label, and the label."""
        mesh = self.shape(step)
        data = mesh.cell_data if at_cells else mesh.point_data
        data["shown"], label = scale.shown(field, *self.component(step, field, at_cells))
        return mesh, label

    def tool_placements(self, step: int) -> dict[str, Placement]:
        """Return the placement of each tool at a step."""
        job = self.file["job"]
        if "tool_displacement" not in job:
            return {}
        names = text_of(job.attrs["tools"]).split()
        displacements = job["tool_displacement"][step].reshape(-1, 3)
        if "tool_rotation" in job:
            axes = job["tool_rotation"][step].reshape(-1, 3, 3)
        else:
            axes = np.broadcast_to(np.eye(3), (len(names), 3, 3))
        return {name: Placement(*of_tool) for name, *of_tool in zip(names, axes, displacements, strict=True)}


def add_surface(plotter: Any, skin: pv.PolyData, **options: Any) -> None:
    """Add a surface, smooth between its sharp edges, and these; options are those of pyvista."""
    plotter.add_mesh(skin, smooth_shading=True, split_sharp_edges=True, feature_angle=SHARP, show_scalar_bar=False,
                     **rendering.SURFACE, **options)
    plotter.add_mesh(sharp_edges(skin), color=rendering.EDGE, line_width=1.5)


def add_sheet(plotter: Any, mesh: pv.UnstructuredGrid, style: Style, limits: Scale) -> None:
    """Add a sheet with the field `shown`, completed at the planes of symmetry."""
    add_surface(plotter, sheet_skin(mesh, style.mirror, odd_axes(style.field)), scalars="shown", clim=limits[:2],
                cmap=scale.colours_of(limits, style.colours), show_edges=style.mesh, edge_color=rendering.MESH,
                line_width=1)


def draw(plotter: Any, run: Run, step: int, style: Style, tools: dict[str, Patches],
         limits: Scale, box: Box) -> None:
    """Draw one picture."""
    add_sheet(plotter, run.mesh(step, style.field, style.cells)[0], style, limits)
    # Tools are shifted away from the eye, so that the colours of the sheet show where a tool touches it.
    behind = -0.006 * diagonal(box) * eye(style.view)[0]
    placements, inside = run.tool_placements(step), run.points(step).mean(axis=0)
    for number, (name, patches) in enumerate(tools.items()):
        if name in placements:
            skin = tool_skin(patches, placements[name], style.mirror, inside)
            add_surface(plotter, skin.translate(behind), color=TOOL_COLOURS[number % len(TOOL_COLOURS)],
                        opacity=style.tool_opacity)
    towards = 0.006 * diagonal(box) * eye(style.view)[0]
    draw_beads(plotter, run.beads.values(), run.points(step), towards, lambda line: reflected(line, style.mirror))
    aim(plotter, box, style)
    text = plotter.add_text(run.state(step), font_size=9, color="black", position="upper_left")
    rendering.use_font(text.prop)
    text.prop.SetBackgroundColor(1, 1, 1)
    text.prop.SetBackgroundOpacity(1)


def labelled(limits: Scale) -> list[float]:
    """Return the ticks of a colour bar that have room for their numbers, zero among them."""
    ticks = limits.ticks
    longest = max((len(f"{tick:.{limits.digits}f}") for tick in ticks), default=0)
    every = math.ceil(longest * len(ticks) / BAR_CHARACTERS) or 1
    return ticks[int(np.abs(ticks).argmin()) % every::every] if ticks else []


def add_bar(plotter: Any, label: str, limits: Scale, colours: str | list[str] | None, **place: Any) -> None:
    """Add the colour bar of a scale, with its ticks; `place` and the like are options of pyvista."""
    mapper = pv.DataSetMapper(pv.PointSet(np.zeros((1, 3))))
    mapper.lookup_table = pv.LookupTable(scale.colours_of(limits, colours), scalar_range=limits[:2])
    bar = plotter.add_scalar_bar(title=label + "\n", mapper=mapper, fmt=f"%.{limits.digits}f", color="black", **place)
    bar.SetCustomLabels(pv.convert_array(np.array(labelled(limits))))
    bar.SetUseCustomLabels(True)
    for text in (bar.GetTitleTextProperty(), bar.GetLabelTextProperty()):
        rendering.use_font(text)


def box_of(run: Run, steps: Sequence[int], mirror: Sequence[str], tools: dict[str, Patches]) -> Box:
    """Return the corners of the box that holds the sheet at all steps drawn; before a run, the tools as well."""
    points = np.concatenate([run.points(step) for step in steps])
    if run.before:
        placements = run.tool_placements(0)
        points = np.concatenate([points] + [placements[name].of(patch.reshape(-1, 3))
                                            for name in tools if name in placements for patch, _ in tools[name]])
    low, high = points.min(axis=0), points.max(axis=0)
    for axis in mirror:
        i = AXES.index(axis)
        low[i], high[i] = min(low[i], -high[i]), max(high[i], -low[i])
    return low, high


def eye(view: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the unit vector towards the camera and the upward direction of a view."""
    place, up = VIEWS[view] if view in VIEWS else (tuple(map(float, view.split())), (0, 0, 1))
    return np.array(place) / np.linalg.norm(place), np.array(up)


def aim(plotter: Any, box: Box, style: Style) -> None:
    """Point the camera at the sheet."""
    (place, up), (low, high) = eye(style.view), box
    centre = np.array(style.focus) if style.focus else (low + high) / 2
    plotter.camera_position = [centre + 2 * diagonal(box) * place, centre, up]
    plotter.enable_parallel_projection()
    right = np.cross(up, place)
    right /= np.linalg.norm(right)
    over = np.cross(place, right)
    width, height = np.subtract(plotter.renderer.viewport[2:], plotter.renderer.viewport[:2]) * plotter.window_size
    half_width = np.abs(right) @ (high - low) / 2
    half_height = np.abs(over) @ (high - low) / 2
    plotter.camera.parallel_scale = max(1.15 * half_height, 1.1 * half_width * height / width, 1e-3) / style.zoom
    plotter.reset_camera_clipping_range()


def direction(text: str) -> bool:
    """Check for three numbers that are not a direction parallel to z, the upward direction."""
    try:
        place = [float(word) for word in text.split()]
    except ValueError:
        return False
    return len(place) == 3 and any(place[:2])


def command_line() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = new_parser("plot sheet", __doc__)
    parser.add_argument("run", metavar="RUN", help="folder of results, its fields.vtkhdf, or an input file")
    add_program(parser)
    parser.add_argument("--set", action="append", type=setting, default=[], metavar="NAME=VALUE",
                        help="parameter of an input file")
    parser.add_argument("--at", action="append", metavar="PLACE", help=AT + "; may be repeated")
    parser.add_argument("--field", help="field, or field:component, such as stress:11 or displacement:z; level: how "
                        "often the elements have been divided "
                        "(equivalent_plastic_strain; of an input file thickness)")
    parser.add_argument("--cells", action="store_true", help="values at the elements instead of the nodes")
    parser.add_argument("--limits", type=float, nargs=2, metavar=("LOW", "HIGH"),
                        help="range of the colours, in the unit of the colour bar: strains and thinning in per cent")
    parser.add_argument("--colours", metavar="MAP", help=f"colour map of matplotlib ({scale.SEQUENTIAL}; where a field "
                        f"has both signs {scale.DIVERGING} with white at zero)")
    parser.add_argument("--view", default="iso", help="one of " + ", ".join(VIEWS) + ', or a direction "x y z"')
    parser.add_argument("--zoom", type=float, default=1.0, help="1: the whole sheet")
    parser.add_argument("--focus", type=float, nargs=3, metavar=("X", "Y", "Z"), help="point in the middle, mm")
    parser.add_argument("--mirror", nargs="+", action="extend", default=[], choices=["x", "y", "z", "xy"],
                        metavar="AXIS", help="planes of symmetry to complete the model at, such as x y")
    parser.add_argument("--tool", action="append", default=[], metavar="NAME=FILE", help="surface of a tool")
    parser.add_argument("--hide", action="append", default=[], metavar="NAME",
                        help="tool or draw-bead to leave out, or 'all'")
    parser.add_argument("--tool-opacity", type=float, default=0.35)
    parser.add_argument("--mesh", action="store_true", help="draw the edges of the elements")
    parser.add_argument("--output", default="sheet.png", help="picture to write (sheet.png)")
    parser.add_argument("--size", type=int, nargs=2, default=[1500, 800], metavar=("W", "H"),
                        help="size of one picture in pixels")
    parser.add_argument("--list", action="store_true", help="list the steps and fields, draw nothing")
    return parser


def find_tools(run: Run, hide: Sequence[str] = (), tools: Mapping[str, str | Path] | None = None
               ) -> dict[str, Patches]:
    """Return the patches of the tools to draw, and leave out the draw-beads that are hidden."""
    if "all" in hide:
        run.beads = {}
        return {}
    files = {tool["name"]: file_of(run.job, run.folder, tool["patches"]) for tool in run.job["tools"]}
    files |= {name.lower(): Path(file) for name, file in (tools or {}).items()}
    hide = [name.lower() for name in hide]
    unknown = [name for name in hide if name not in files and name not in run.beads]
    if unknown:
        raise Problem(f"no tool '{unknown[0]}' to hide; there are: {', '.join([*files, *run.beads]) or 'none'}")
    run.beads = {name: line for name, line in run.beads.items() if name not in hide}
    shown = {name: file for name, file in files.items() if name not in hide}
    for name, file in shown.items():
        if not file.is_file():
            LOG.warning(f"{file}: no such file; without it the tool '{name}' is not drawn, see --tool")
    return {name: read_patches(file) for name, file in shown.items() if file.is_file()}


def is_deck(run: str | Path) -> bool:
    """Check for an input file in place of results."""
    return Path(run).is_file() and Path(run).suffix != ".vtkhdf"


@contextlib.contextmanager
def opened(run: str | Path, program: str | Path | None = None, settings: Mapping[str, object] | None = None
           ) -> Iterator[Run]:
    """Yield the run; of an input file, the initial state with values of parameters, which the program writes into a
    folder that is removed afterwards."""
    if not is_deck(run):
        yield Run(run)
        return
    with tempfile.TemporaryDirectory(prefix="dd3imp_") as folder:
        done = launch(command(find_program(program or places.program()), run, None,
                              ["--check", "--quiet", "--initial", folder], settings))
        if done.code != 0:
            if not (Path(folder) / "fields.vtkhdf").exists():
                raise Problem(done.errors.strip())
            LOG.warning(done.errors.strip())
        yield Run(folder, before=True)


def limits_of(run: Run, steps: Sequence[int], style: Style) -> Scale:
    """Return the scale of the colours: between the limits of --limits, or round for all values drawn."""
    if style.limits and style.field != levels.LEVEL:
        return scale.own_scale(style.field, style.limits)
    drawn = [run.mesh(step, style.field, style.cells)[0]["shown"] for step in steps]
    low, high = (float(end) for end in (min(map(np.min, drawn)), max(map(np.max, drawn))))
    if set(odd_axes(style.field)) & set(style.mirror):
        low, high = min(low, -high), max(high, -low)
    if style.field == levels.LEVEL:
        low, high = levels.limits_of(int(high))
        return Scale(low, high, 1.0)
    return scale.scale_of(style.field, low, high)


def new_plotter(size: Sequence[int], count: int = 1) -> Any:
    """Return the plotter of `count` pictures of a size and the strip of the colour bar."""
    window = [size[0], size[1] * count]
    bar = min(BAR_HEIGHT, window[1] / 2)
    plotter = rendering.new_plotter(shape=(count + 1, 1), row_weights=[(window[1] - bar) / count] * count + [bar],
                                    border=False, window_size=window)
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    return plotter


def make_picture(run: Run, style: Style, output: str | Path | None, at: Sequence[str] = ()) -> np.ndarray:
    """Draw the sheet at some places (AT), by default the last step, one picture below the other; write it, and return
    its colours (height, width, 3)."""
    tools = find_tools(run, style.hide, style.tools)
    steps = [run.step_at(place) for place in at] or [run.last]
    limits, box = limits_of(run, steps, style), box_of(run, steps, style.mirror, tools)
    names = []
    if style.field == levels.LEVEL:
        names = levels.names_of([run.mesh(step, style.field, True)[0]["shown"] for step in steps])
        style = replace(style, colours=levels.colours_of(len(names) - 1))
    plotter = new_plotter(style.size, len(steps))
    for row, step in enumerate(each(steps, "pictures")):
        plotter.subplot(row, 0)
        draw(plotter, run, step, style, tools, limits, box)
    return finish(plotter, run.mesh(steps[0], style.field, style.cells)[1], style.colours, limits, output, names)


def make_map(mesh: pv.UnstructuredGrid, label: str, style: Style, output: str | Path) -> None:
    """Draw a sheet alone with its field `shown` and write the picture."""
    points = np.concatenate([part.points for part in reflected(mesh, style.mirror)])
    values = mesh.point_data["shown"]
    limits = (scale.own_scale("", style.limits) if style.limits
              else scale.round_scale(float(min(0.0, values.min())), float(values.max())))
    plotter = new_plotter(style.size)
    plotter.subplot(0, 0)
    add_sheet(plotter, mesh, style, limits)
    aim(plotter, (points.min(axis=0), points.max(axis=0)), style)
    finish(plotter, label, style.colours, limits, output)


def figure(run: str | Path, at: Sequence[str | float] = (), program: str | Path | None = None,
           set: Mapping[str, object] | None = None, **style: Any) -> Figure:
    """Return a figure of the sheet between its tools; of an input file, of the state before the run.

    at: travels in mm, or phases (the last step). program, set: of an input file, the program and values of parameters.
    style: members of Style.
    """
    at = [at] if isinstance(at, str | float | int) else at
    with opened(run, program, set) as opened_run:
        style.setdefault("field", "thickness" if opened_run.before else FIELD)
        drawn = Style(**style)
        image = make_picture(opened_run, drawn, None, [str(place) for place in at])
    found = Figure(figsize=(image.shape[1] / DOTS, image.shape[0] / DOTS), dpi=DOTS)
    axes = found.add_axes((0, 0, 1, 1))
    axes.imshow(image)
    axes.axis("off")
    return found


def finish(plotter: Any, label: str, colours: str | list[str] | None, limits: Scale, output: str | Path | None,
           names: Sequence[str] = ()) -> np.ndarray:
    """Draw the colour bar below the pictures, of levels the legend with their names; write and return them."""
    plotter.subplot(plotter.shape[0] - 1, 0)
    if names:
        levels.draw_legend(plotter, names)
    else:
        add_bar(plotter, label, limits, colours, vertical=False, position_x=0.25, width=0.5, position_y=0.2,
                height=0.7, title_font_size=17, label_font_size=15)
    try:
        return np.asarray(plotter.screenshot(output, return_img=True))
    except (OSError, ValueError) as error:
        raise Problem(f"{output}: {error}") from None
    finally:
        plotter.close()


def main(words: Sequence[str] | None = None) -> None:
    """Draw the picture of the command line."""
    parser = command_line()
    options = vars(parser.parse_args(words))
    deck, output, at, shown, listed = (options.pop(name) for name in ("run", "output", "at", "tool", "list"))
    if any("=" not in item for item in shown):
        parser.error("--tool takes NAME=FILE")
    with opened(deck, options.pop("program"), dict(options.pop("set"))) as run:
        options["field"] = options["field"] or ("thickness" if run.before else FIELD)
        style = Style(**options, tools=dict(item.split("=", 1) for item in shown))
        if listed:
            print("travel (mm): " + " ".join(f"{t:.4g}" for t in run.travel))
            print("at nodes: " + ", ".join(run.grid["PointData"]))
            print("at cells: " + ", ".join(run.grid["CellData"]))
            return
        make_picture(run, style, output, at or ())
        print(output)
