# SPDX-License-Identifier: GPL-3.0-or-later
"""Make a page about a forming run: one HTML file with its pictures inside, and the pictures as PNG files.

    dd3 report cup.out --mirror x y --low-carbon-steel
    dd3 report rail.out --mirror y --curve dc06.csv --section y=0 --section x=30 --output rail_report
    dd3 report cup.out --mirror x y --waves 0.2 --tolerance 0.5 --verdict
    dd3 report cup.out --mirror x y --measured force.csv --measured thickness.csv

The page is one file, which a browser shows without a network: the part in 3D with all fields at all steps, its tools,
sections and forming limit diagram, and curves that tell their values under the mouse. It begins with the verdict:
whether the sheet is formed to the tools, its waves under the holder, splits, thinning, springback; --verdict prints it
and ends with exit code 1 if something is not good. Then come the thinning, the deformed sheet between its tools, the
forming limit diagram, thickness along sections, the outline before and after, the springback of a sheet that was
released (its distance from the drawn shape, sections, angles, twist), measured curves, the refinements and the final
mesh where elements were divided in the run, for each phase the tools' motions and forces, what limited its increments
and what warned, the statistics of the run, and the set-up. --mirror completes a model at
its planes of symmetry; forces are multiplied accordingly. Forming limit curve and thinning limit are those of `dd3
fld`; without a curve for the material it is not judged. The strains are those at the middle of the sheet.
"""

import argparse
import base64
import html
import sys
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from dd3 import computed, forming_limit, measured, rendering, springback, verdict
from dd3.account import Account
from dd3.bound import closed_skin
from dd3.command import new_parser
from dd3.plot import force as forces
from dd3.plot import sheet as pictures
from dd3.plot.figures import new_figure, save
from dd3.programs import made_folder
from dd3.progress import each
from dd3.run import read_frame
from dd3.section import Section, in_plane
from dd3.sheet import AXES, Sheet, plane
from dd3.tables import tools_in
from dd3.viewer import page as interactive
from dd3.viewer.scene import Scene

STYLE = """body{font:16px/1.5 system-ui,sans-serif;color:#222;background:#f4f5f7;margin:0}
main{max-width:1100px;margin:0 auto;padding:1em 1.5em}h1{margin:.4em 0 0}h2{margin:0 0 .5em;font-size:1.2em}
section{background:#fff;border:1px solid #dde;border-radius:6px;padding:1em 1.2em;margin:1em 0}
img{max-width:100%;height:auto;display:block;margin:auto}table{border-collapse:collapse}
td,th{padding:.15em .9em .15em 0;text-align:left;vertical-align:top}td.n{text-align:right}
.row{display:flex;flex-wrap:wrap;gap:1em 3em}.bar{display:inline-block;height:.8em;background:#5b8fd6}
.key{display:inline-block;width:.8em;height:.8em;margin-right:.4em}.warn{color:#8a4b00}
pre{overflow-x:auto;font-size:13px}p,li{overflow-wrap:break-word}
"""


class Report:
    """A run with the options of the command line, and the parts of its page."""

    def __init__(self, options: argparse.Namespace) -> None:
        self.options = options
        self.sheet = Sheet(options.run)
        self.folder = self.sheet.folder
        self.run = pictures.Run(self.folder)
        self.job = self.run.job
        self.history = read_frame(self.folder, "history.csv", "phase", "travel", "progress")
        self.tools = tools_in(self.history)
        self.last = self.sheet.last
        self.pictures = made_folder(options.output or self.folder / "report")
        self.path: Path = self.pictures / "report.html"
        self.whole = 2 ** len(options.mirror)  # number of images of the model
        self.parts: list[str] = []
        self.undrawn: dict[str, str] = {}  # why a picture is not in the page
        self.limits: list[str] = []  # results of the forming limit diagram: by the curve, by the thinning
        self.splits: list[verdict.Item] = []
        self.sprung: float | None = None  # largest distance of the free shape from the drawn one, mm
        self.verdict: list[verdict.Item] = []

    def field(self, name: str) -> np.ndarray:
        """Return a field at the last step."""
        return self.sheet.values(self.last, name)[0]

    def column(self, name: str) -> np.ndarray:
        """Return a column of the history."""
        return self.history[name].to_numpy(float)

    def add(self, title: str, content: str) -> None:
        """Add a section to the page."""
        self.parts.append(f"<section><h2>{html.escape(title)}</h2>\n{content}\n</section>")

    def image(self, name: str, alt: str) -> str:
        """Return the element of a picture that has been written."""
        data = base64.b64encode((self.pictures / f"{name}.png").read_bytes()).decode()
        return f'<img alt="{html.escape(alt)}" src="data:image/png;base64,{data}">'

    def drawn(self, draw: Callable[[], None], name: str, alt: str) -> str:
        """Draw a picture of the sheet and return its element, or a text where the system cannot draw it."""
        try:
            draw()
        except rendering.NoOpenGL as problem:
            self.undrawn[name] = str(problem)
            return f"<p>No picture: {html.escape(str(problem))}.</p>"
        return self.image(name, alt)

    def saved(self, name: str, figure: Figure, alt: str) -> str:
        """Write a figure and return its element."""
        save(figure, self.pictures / f"{name}.png", 130)
        return self.image(name, alt)

    def figure(self, name: str, figure: Figure, alt: str) -> str:
        """Write a figure of curves and return its element, whose curves answer to the mouse."""
        return interactive.chart(name, figure, self.saved(name, figure, alt))

    def sheet_options(self, name: str, *more: str) -> argparse.Namespace:
        """Return the options of a picture of the sheet."""
        options = pictures.arguments([str(self.folder), "--output", str(self.pictures / f"{name}.png"),
                                      "--size", "1300", "650", *more])
        options.mirror = self.options.mirror
        return options


def table(rows: Iterable[tuple[str, Any]]) -> str:
    """Return a table of names and values."""
    return "<table>" + "".join(f"<tr><th>{html.escape(name)}</th><td>{html.escape(str(value))}</td></tr>"
                               for name, value in rows) + "</table>"


def columns(*tables: str) -> str:
    """Return tables beside each other."""
    return '<div class="row">' + "".join(f"<div>{part}</div>" for part in tables) + "</div>"


def add_summary(report: Report) -> None:
    """Add the numbers that a reader looks for first."""
    nodes, thickness, thinning = report.sheet.points(report.last), report.field("thickness"), report.field("thinning")
    thin = thinning.argmax()
    rows = [("thickness", f"{thickness.min():.4g} to {thickness.max():.4g} mm"),
            ("largest thinning", f"{100 * thinning.max():.3g} % at ({', '.join(f'{x:.1f}' for x in nodes[thin])}) mm"),
            ("largest thickening", f"{max(0.0, -100 * thinning.min()):.3g} %"),
            ("equivalent plastic strain", f"{report.field('equivalent_plastic_strain').max():.4g}")]
    rows += zip(("forming limit", "thinning limit"), report.limits)
    tools = [(f"{tool}: largest force along z, largest pressure",
              f"{report.whole * np.abs(report.column(f'{tool}_fz')).max() / 1000:.4g} kN, "
              f"{report.column(f'{tool}_pressure').max():.3g} MPa") for tool in report.tools]
    work = report.column("tool_work")[-1] + report.column("external_work")[-1]
    if abs(work) > 0:
        tools.append(("error of the energy balance", f"{100 * report.column('energy_error')[-1] / work:.2g} %"))
    report.add("Result", columns(table(rows), table(tools)))


def add_verdict(report: Report) -> None:
    """Add what is good and what is not."""
    options = report.options
    report.verdict = verdict.judge(report.job, options.waves, report.splits,
                                   verdict.sprung(report.sprung, options.tolerance))
    rows = "".join(f'<tr><th>{html.escape(item.name)}</th><td><span class="key" style="background:'
                   f'{verdict.COLOURS[item.answer]}"></span>{item.answer}</td><td>{html.escape(item.text)}</td></tr>'
                   for item in report.verdict)
    said = verdict.summary(report.verdict)
    report.add("Verdict", f"<p><b>{html.escape(said[:1].upper() + said[1:])}.</b></p><table>{rows}</table>")


def add_setup(report: Report) -> None:
    """Add the set-up: program, input file, and the values of the input with all defaults."""
    job, lines = report.job, []
    for block in job["input"]["blocks"]:
        lines.append(f"*{block['keyword'].upper()} {block['name']}".rstrip())
        for entry in block["entries"]:
            remark = ", ".join(filter(None, (entry["unit"], "default" if entry["default"] else "")))
            lines.append(f"  {entry['key']} = {entry['text']}".ljust(52) + (f"# {remark}" if remark else ""))
    heading = [f"{job['program']['name']} {job['program']['version']}: {job['command']['file']}",
               f"started {job['started']}"]
    if sheet := job.get("sheet"):
        heading.append(f"{sheet['elements']} elements {sheet['element']}, {sheet['nodes']} nodes, "
                       f"{sheet['contact_points']} candidates for contact with {len(report.tools)} tools")
    report.add("Set-up", "<p>" + "<br>".join(map(html.escape, heading)) + "</p><details><summary>All input values"
               "</summary><pre>" + html.escape("\n".join(map(str.rstrip, lines))) + "</pre></details>")


def add_statistics(report: Report) -> None:
    """Add what the run cost: increments, iterations, time by section."""
    status = read_frame(report.folder, "status.csv", "outcome", "limiter", "phase")
    accepted, seconds = status[status["outcome"] == "accepted"], report.job["sections"]
    rows: list[tuple[str, Any]] = [
        ("end of the run", end_of(report)), ("increments", len(accepted)),
        ("cut-backs", int((status["outcome"] == "retry").sum())), ("iterations", int(status["iterations"].sum()))]
    if report.job["seconds"]:
        rows.append(("wall-clock time", f"{report.job['seconds']:.4g} s"))
    most = max(sum(seconds.values()), 1e-9)
    bars = "<table>" + "".join(
        f'<tr><th>{name}</th><td class="n">{value:.3g} s</td>'
        f'<td><span class="bar" style="width:{220 * value / most:.0f}px"></span> {100 * value / most:.0f} %</td></tr>'
        for name, value in seconds.items()) + "</table>"
    report.add("Run", columns(table(rows), bars))


def end_of(report: Report) -> str:
    """Return how the run ended."""
    outcome = report.job["outcome"]
    return str(outcome["message"] or outcome["state"])


def add_phases(report: Report) -> None:
    """Add the phases: what the tools do, their forces, what limited the increments and what warned."""
    status = read_frame(report.folder, "status.csv", "outcome", "limiter", "phase")
    for phase in report.job["phases"]:
        name = phase["name"]
        attempts = status[status["phase"] == name]
        if attempts.empty:
            continue
        content = table(phase_rows(report, phase, attempts))
        if report.tools and any(tool["active"] for tool in phase["tools"]):
            content = force_figure(report, name) + content
        report.add(f"Phase {phase['number']}: {name}", content)


def phase_rows(report: Report, phase: dict[str, Any], attempts: pd.DataFrame) -> list[tuple[str, Any]]:
    """Return the rows of the table of a phase."""
    name, accepted = phase["name"], attempts[attempts["outcome"] == "accepted"]
    limiters = accepted["limiter"].value_counts()
    warnings = [f"{warning['code']}: {warning['text']}" for warning in report.job["warnings"]
                if warning["phase"] == name]
    rows: list[tuple[str, Any]] = [(tool["name"], action(tool)) for tool in phase["tools"]]
    rows += [("driven by", phase["control"] or "the fraction of the phase"), ("ends", end_of_phase(report, name)),
             ("increments", f"{len(accepted)}, {int((attempts['outcome'] == 'retry').sum())} cut back; "
                            f"{int(attempts['iterations'].sum())} iterations"),
             ("limited by", ", ".join(f"{limiter} {count}" for limiter, count in limiters.items()))]
    return [*rows, *(("warning", warning) for warning in warnings)]


def end_of_phase(report: Report, name: str) -> str:
    """Return where a phase ends: its travel and progress."""
    rows = forces.rows_of(report.history, [name])
    travel = report.column("travel")[rows]
    part = f"{100 * report.column('progress')[rows[-1]]:.4g} %"
    return f"at a travel of {travel[-1] - travel[0]:.4g} mm, {part}" if np.ptp(travel) > 0 else f"at {part}"


def action(tool: dict[str, Any]) -> str:
    """Return what a phase does with a tool."""
    if not tool["active"]:
        return "released"
    said = tool["motion"]
    if tool["gap"]:
        said += f" to a gap of {tool['gap']['value']:g} {tool['gap']['unit']} from {tool['gap']['from']}"
    elif tool["motion"] == "moved":
        said += f" by {numbers(tool['displacement'])} mm"
    elif tool["force"]:
        said += f" by {numbers(tool['force'])} N"
    if tool["turn"]:
        said += f", turned by {tool['turn']['angle']:g} degrees about {numbers(tool['turn']['axis'])}"
    return said


def numbers(values: Sequence[float]) -> str:
    """Return numbers as text."""
    return " ".join(f"{value:g}" for value in values)


def force_figure(report: Report, phase: str) -> str:
    """Draw the forces of the tools in a phase and return the element."""
    history = report.history
    leader, rows = forces.controlling_tool(history, [phase]), forces.rows_of(history, [phase])
    along, quantity = forces.abscissa(history, leader, rows)
    left = [axis not in report.options.mirror for axis in AXES]  # the others are zero on the whole part
    found = {tool: report.whole * np.linalg.norm(forces.vector(history, tool, "f")[rows][:, left], axis=1)
             for tool in report.tools}
    unit, scale = ("kN", 1000) if max(force.max() for force in found.values()) >= 1000 else ("N", 1)
    figure, axes = new_figure((8, 4))
    for tool, force in found.items():
        axes.plot(along, force / scale, linewidth=2 if tool == leader else 1, label=tool.replace("_", " "))
    axes.set_xlabel(quantity)
    axes.set_ylabel(f"force ({unit})" + (f", whole part, {report.whole} times the model" if report.whole > 1 else ""))
    axes.grid(True, color="0.9")
    axes.legend(frameon=False)
    return report.figure(f"force_{phase}", figure, f"tool forces over {quantity}")


def add_springback(report: Report) -> None:
    """Add the free shape against the drawn one: map of the distances, sections over one another, angles and twist."""
    found = springback.find(report.sheet, report.job["phases"], report.options.mirror)
    if found is None:
        return
    figure, axes = new_figure((8, 4))
    rows: list[tuple[str, Any]] = []
    for text in section_planes(report):
        normal, place = plane(text)
        line = report.sheet.cut(normal, place, step=found.step)[0]
        name = text if "=" in text else f"{text} degrees"
        for points, style in ((found.drawn, "--"), (found.free, "-")):
            axes.plot(*in_plane(line.at(points), normal).T, style, color=f"C{len(rows)}", linewidth=1.3,
                      label=f"{name}, {'drawn' if style == '--' else 'free'}")
        ends = springback.opening(line, found, normal)
        rows.append((f"section {name}", f"turned by {springback.rotation(line, found, normal):+.3g} degrees; its ends "
                                        f"against that by {ends[0]:+.3g} and {ends[1]:+.3g} degrees"))
    axes.set(xlabel="in the plane of the section (mm)", ylabel="z (mm)")
    axes.set_aspect("equal", adjustable="datalim")
    axes.grid(True, color="0.9")
    axes.legend(frameon=False)
    twisted = springback.twist(report.sheet, found, report.options.mirror)
    if twisted:
        rows.append((f"twist about {twisted[0]} from 10 to 90 % of the length", f"{twisted[1]:+.3g} degrees"))
    distance = found.distance()
    report.sprung = float(distance.max())
    rows.insert(0, ("largest distance from the drawn shape", f"{distance.max():.4g} mm"))
    rows.insert(1, ("mean distance", f"{distance.mean():.4g} mm"))
    report.add("Springback", "<p>The free shape, moved to the best fit with the drawn one.</p>"
               + distance_map(report, found) + report.figure("springback", figure, "sections, drawn and free")
               + table(rows))


def distance_map(report: Report, found: springback.Springback) -> str:
    """Draw the distances from the drawn shape on the free one and return the element."""
    options = report.sheet_options("distance", "--hide", "all")
    mesh = report.run.grid_of(found.step, found.free)
    mesh.point_data["shown"] = found.distance()
    return report.drawn(lambda: pictures.make_map(mesh, "distance from the drawn shape (mm)", options), "distance",
                        "distance from the drawn shape")


def add_beads(report: Report) -> None:
    """Add the restraining forces of the draw-beads over the travel, and their lengths on the sheet."""
    beads = [name.removesuffix("_restraint") for name in map(str, report.history) if name.endswith("_restraint")]
    if not beads:
        return
    along = "travel" if np.ptp(report.column("travel")) > 0 else "increment"
    figure, axes = new_figure((8, 3.5))
    rows = []
    for bead in beads:
        force, length = (report.whole * report.column(f"{bead}_{name}") for name in ("restraint", "length"))
        axes.plot(report.column(along), force / 1000, label=bead.replace("_", " "))
        rows.append((bead, f"at most {force.max() / 1000:.4g} kN, at the end {force[-1] / 1000:.4g} kN; on the sheet "
                     f"{length.max():.4g} mm at most, {length[-1]:.4g} mm at the end"))
    axes.set(xlabel="travel (mm)" if along == "travel" else along,
             ylabel="restraining force (kN)" + (", whole part" if report.whole > 1 else ""))
    axes.grid(True, color="0.9")
    axes.legend(frameon=False)
    report.add("Draw-beads", report.figure("beads", figure, "restraining forces of the draw-beads") + table(rows))


def add_limit_diagram(report: Report) -> None:
    """Add the forming limit diagram and the map of its zones."""
    figure, axes = new_figure((8, 5.2))
    account = Account()
    limits = forming_limit.find_limits(report.sheet, report.job, report.options, account)
    strains = forming_limit.strains_of(report.sheet, report.last, "middle")
    zone, report.limits = forming_limit.draw(axes, strains, limits, report.options.margin)
    critical = None if zone is None else int((zone == forming_limit.ZONES.index("critical")).sum())
    report.splits = verdict.splits(critical, report.limits, strains.largest_thinning() > limits.thinning)
    content = report.saved("limit", figure, "forming limit diagram")  # that of the 3D view answers to the mouse
    content += "" if zone is None else zone_map(report, zone)
    said = [*report.limits, *(f"left out: {item}" for item in account.left_out())]
    content += "".join(f"<p>{html.escape(line[:1].upper() + line[1:])}.</p>" for line in said)
    if zone is not None:
        content += f"<p>Dots: nodes; crosses: elements. Marginal: less than {report.options.margin:g} below the " \
            "curve; thickening: thicker than before, the major strain is smaller than minus the minor one.</p>"
    report.add("Forming limit", content)


def zone_map(report: Report, zone: np.ndarray) -> str:
    """Draw the zones on the sheet and return the element."""
    keys = " ".join(f'<span class="key" style="background:{colour}"></span>{name}&emsp;'
                    for name, colour in zip(forming_limit.ZONES, forming_limit.COLOURS, strict=True))
    return report.drawn(lambda: draw_zones(report, zone), "zones",
                        "zones of the forming limit diagram on the sheet") + f"<p>{keys}</p>"


def draw_zones(report: Report, zone: np.ndarray) -> None:
    """Draw the zones on the sheet and write the picture."""
    options = report.sheet_options("zones", "--hide", "all")
    plotter = pictures.new_plotter(options, 1)
    plotter.subplot(0, 0)
    mesh = report.run.shape(report.last)
    # A cell has the worst zone of its nodes and its own.
    mesh.cell_data["zone"] = np.array([max(zone[mesh.get_cell(i).point_ids].max(), zone[mesh.n_points + i])
                                       for i in range(mesh.n_cells)])
    for part in pictures.reflected(closed_skin(mesh), options.mirror):
        skin = part.extract_surface(algorithm="dataset_surface")
        plotter.add_mesh(skin, scalars="zone", cmap=list(forming_limit.COLOURS), show_edges=True, edge_color="#444444",
                         clim=[-0.5, len(forming_limit.ZONES) - 0.5], show_scalar_bar=False, ambient=0.3)
    pictures.aim(plotter, pictures.box_of(report.run, [report.last], options, {}), options)
    plotter.screenshot(options.output)
    plotter.close()


def section_planes(report: Report) -> list[str]:
    """Return the planes of --section, by default those through the middle of the whole sheet."""
    if report.options.section:
        return list(report.options.section)
    points = report.sheet.points(0)
    middle = {axis: 0.0 if axis in report.options.mirror else float(points[:, i].min() + points[:, i].max()) / 2
              for i, axis in enumerate(AXES)}
    planes = [f"y={middle['y']:.6g}", f"x={middle['x']:.6g}"]
    return [*planes, "45"] if {"x", "y"} <= set(report.options.mirror) else planes


def add_sections(report: Report) -> None:
    """Add thickness and shape along sections."""
    planes = section_planes(report)
    figure, axes = new_figure((8, 7), 2)
    for text in planes:
        normal, distance = plane(text)
        line = report.sheet.cut(normal, distance)[0]
        section = Section(report.sheet, line, report.last)
        name = text if "=" in text else f"{text} degrees"
        axes[0].plot(section.length0, section.field("thickness")[0], ".-", markersize=3, label=name)
        axes[1].plot(*in_plane(section.now, normal).T, ".-", markersize=3, label=name)
    axes[0].set(xlabel="initial length along the section (mm)", ylabel="thickness (mm)")
    axes[1].set(xlabel="in the plane of the section (mm)", ylabel="z (mm)")
    axes[0].ticklabel_format(useOffset=False)
    axes[1].set_aspect("equal", adjustable="datalim")
    axes[0].legend(frameon=False)
    for place in axes:
        place.grid(True, color="0.9")
    report.add("Thickness along sections", report.figure("sections", figure, "thickness and shape along sections"))


def add_outline(report: Report) -> None:
    """Add the outline before and after, and the draw-in along it."""
    figure, (axes, along) = new_figure((11, 5), 1, 2)
    start, now = report.sheet.start(report.last), report.sheet.points(report.last)
    for line in report.sheet.outline(True, report.options.mirror):
        for points, colour, width in ((start, "0.5", 1), (now, "#d55e00", 1.6)):
            for part in springback.images(points[line], report.options.mirror):
                axes.plot(part[:, 0], part[:, 1], color=colour, linewidth=width)
    for angle, value in computed.draw_in(report.sheet, report.options.mirror):
        along.plot(angle, value, ".-", markersize=3)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="x (mm)", ylabel="y (mm)")
    axes.legend(handles=[Patch(color="0.5", label="before"), Patch(color="#d55e00", label="after")], frameon=False)
    along.set(xlabel="angle from x at the start (degrees)", ylabel="draw-in (mm)")
    for place in (axes, along):
        place.grid(True, color="0.9")
    report.add("Outline and draw-in", report.figure("outline", figure, "outline before and after, draw-in"))


def add_measured(report: Report) -> None:
    """Add the measured curves over the computed ones, with a table of their differences."""
    curves = [curve for file in report.options.measured for curve in measured.read(file, report.tools)]
    if not curves:
        return
    figure, axes = new_figure((8, 3.5 * len(curves)), len(curves), squeeze=False)
    rows = []
    for measure, place in zip(curves, axes[:, 0]):
        at, values = computed.curve(measure, report.sheet, report.history, report.options.mirror)
        found = (measured.from_line(measure, np.column_stack([at, values])) if measure.over == "along"
                 else measured.along_curve(measure, at, values))
        unit, scale = measured.shown_unit(measure)
        over = "degrees" if measure.over == "angle" else "mm"
        place.plot(at, values / scale, "-", color="#0072b2", label="computed")
        place.plot(measure.at, measure.values / scale, "o", markersize=3, color="#d55e00",
                   label=f"measured, {measure.file}")
        place.set(xlabel=f"{measure.over} ({over})", ylabel=f"{measure.title()} ({unit})")
        place.grid(True, color="0.9")
        place.legend(frameon=False)
        beyond = f"; {found.beyond} points beyond the computed curve are left out" if found.beyond else ""
        rows.append((f"{measure.title()} ({measure.file})", f"{found.points} points; largest difference "
                     f"{found.largest / scale:+.3g} {unit} at {measure.over} {found.where:.4g} {over}, rms "
                     f"{found.rms / scale:.3g} {unit}{beyond}"))
    report.add("Measured curves", report.figure("measured", figure, "measured and computed curves")
               + "<p>Differences: measured less computed values; of the shape of a section distances from it, along "
                 "its upper face.</p>" + table(rows))


def add_view(report: Report) -> None:
    """Add the part in 3D."""
    limits = forming_limit.find_limits(report.sheet, report.job, report.options)
    scene = Scene(report.sheet, report.run, report.options.mirror, limits, report.options.margin)
    report.add("Part in 3D", interactive.view(scene))


def add_pictures(report: Report) -> None:
    """Add the thinning and the sheet between its tools."""
    for title, name, field, alt, more in (
            ("Thinning", "thinning", "thinning", "thinning on the deformed sheet", ("--hide", "all")),
            ("Sheet and tools", "sheet", "equivalent_plastic_strain", "deformed sheet and tools", ())):
        options = report.sheet_options(name, "--field", field, *more)
        report.add(title, report.drawn(partial(draw_sheet, report, options), name, alt))


def draw_sheet(report: Report, options: argparse.Namespace) -> None:
    """Draw the sheet with the options of `dd3 plot sheet` and write the picture."""
    pictures.make_picture(pictures.Run(report.folder, report.job), options)


def add_refinements(report: Report) -> None:
    """Add the refinements of the mesh, where there are any, and the levels of the elements at the end."""
    changes = report.job.get("refinements")
    if not changes:
        return
    options = report.sheet_options("levels", "--field", "level", "--hide", "all")
    picture = report.drawn(partial(draw_sheet, report, options), "levels", "levels of the elements at the end")
    heading = ("phase", "after increment", "travel, mm", "elements before", "after", "of levels 0, 1, ...",
               "forces out of balance, %", "next increment made again")
    rows = [(change["phase"], change["increment"], f"{change['travel']:.4g}", change["elements_before"],
             change["elements"], " + ".join(map(str, change["elements_of_level"])), f"{100 * change['imbalance']:.2g}",
             "yes" if change["repeated"] else "no") for change in changes]
    content = "".join("<tr>" + "".join(f"<td>{html.escape(str(cell))}</td>" for cell in row) + "</tr>\n"
                      for row in rows)
    names = "".join(f"<th>{name}</th>" for name in heading)
    report.add("Refinement", f"{picture}<table><tr>{names}</tr>\n{content}</table>")


def add_warnings(report: Report) -> None:
    """Add the warnings of the run."""
    found = [f"{warning['at']['file']}:{warning['at']['line']}: {warning['text']}" if warning["at"] else warning["text"]
             for warning in report.job["warnings"]]
    content = "<ul class=warn>" + "".join(f"<li>{html.escape(line)}</li>" for line in found) + "</ul>"
    report.add("Warnings", content if found else "<p>None.</p>")


def page(report: Report) -> str:
    """Return the text of the page."""
    title = html.escape(report.job["title"] or report.folder.resolve().name)
    images_of = f"; completed at the planes {', '.join(report.options.mirror)} = 0" if report.options.mirror else ""
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title><style>{STYLE}{interactive.own_file("viewer.css")}</style></head><body><main>
<h1>{title}</h1><p>State: {report.run.state(report.last)}{images_of}.</p>
{chr(10).join(report.parts)}
</main>
{interactive.scripts()}
</body></html>
"""


STEPS = (add_view, add_pictures, add_limit_diagram, add_sections, add_outline, add_springback, add_measured,
         add_refinements, add_phases, add_beads, add_warnings, add_statistics, add_setup)


def write(options: argparse.Namespace) -> Report:
    """Write the page."""
    report = Report(options)
    for step in each(STEPS, "report"):
        step(report)
    for step in (add_summary, add_verdict):
        step(report)
        report.parts.insert(0, report.parts.pop())
    report.path.write_text(page(report), encoding="utf-8")
    if report.undrawn:
        print(f"warning: {report.path}: without the pictures {', '.join(report.undrawn)}: "
              f"{next(iter(report.undrawn.values()))}", file=sys.stderr)
    return report


def main(words: Sequence[str] | None = None) -> None:
    """Write the page of the command line."""
    report = report_of(words)
    print(report.path)
    if report.options.verdict:
        print(*(f"{item.name}: {item.answer}: {item.text}" for item in report.verdict),
              f"verdict: {verdict.summary(report.verdict)}", sep="\n")
        if verdict.failed(report.verdict):
            sys.exit(1)


def report_of(words: Sequence[str] | None) -> Report:
    """Write the page of a command line."""
    parser = new_parser("report", __doc__)
    parser.add_argument("run", metavar="RUN", help="folder of results")
    parser.add_argument("--mirror", nargs="+", default=[], choices=list(AXES), metavar="AXIS",
                        help="planes of symmetry x = 0, y = 0 or z = 0 to complete the model at")
    forming_limit.add_options(parser)
    parser.add_argument("--section", action="append", default=[], metavar="PLANE",
                        help="x=0, y=12.5 or an angle in degrees; may be repeated (default: through the middle)")
    parser.add_argument("--measured", action="append", default=[], metavar="FILE",
                        help="table of measured forces, draw-in, thickness or sections, with a heading that names its "
                             "columns and their units; may be repeated")
    parser.add_argument("--waves", type=float, metavar="MM", help="largest height of waves under a holder and in walls")
    parser.add_argument("--tolerance", type=float, metavar="MM",
                        help="largest distance of the free shape from the drawn one")
    parser.add_argument("--verdict", action="store_true",
                        help="print the verdict, and end with exit code 1 if something is not good")
    parser.add_argument("--output", type=Path, metavar="DIR", help="folder of page and pictures (default: RUN/report)")
    options = parser.parse_args(words)
    if any(limit is not None and not limit > 0 for limit in (options.waves, options.tolerance)):
        parser.error("--waves and --tolerance take a positive number")
    options.mirror = sorted(set(options.mirror))
    forming_limit.check_options(parser, options)
    return write(options)
