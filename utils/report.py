#!/usr/bin/env python3
"""Make a page about a forming run: one HTML file with its pictures inside, and the pictures as PNG files.

    report.py cup.out --mirror x y
    report.py rail.out --mirror y --curve dc06.csv --section y=0 --section x=30 --output rail_report

The page has the set-up, statistics of the run, the tool's force, the thinning, the forming limit diagram, thickness
along sections, the outline before and after, the deformed sheet between its tools, and the warnings. --mirror completes
a model at its planes of symmetry; forces are multiplied accordingly. The forming limit is the curve of Keeler and
Brazier (for low-carbon steel) from the thickness and the exponent n of the hardening law or --n, or a measured one:
--curve with minor and major logarithmic strain in each line. The strains are those at the middle of the sheet.
"""

import argparse
import base64
import html
import re
from pathlib import Path

import scripts

scripts.need("h5py", "matplotlib", "numpy", "pyvista")
import forming_limit  # noqa: E402
import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
import plot_force  # noqa: E402
import plot_sheet  # noqa: E402
import results  # noqa: E402
from matplotlib.patches import Patch  # noqa: E402
from scripts import Problem  # noqa: E402
from section import Section, in_plane  # noqa: E402
from sheet import AXES, Sheet, plane  # noqa: E402

SECTIONS = ("material", "assembly", "contact", "factorisation", "solve", "output")
STYLE = """body{font:16px/1.5 system-ui,sans-serif;color:#222;background:#f4f5f7;margin:0}
main{max-width:1100px;margin:0 auto;padding:1em 1.5em}h1{margin:.4em 0 0}h2{margin:0 0 .5em;font-size:1.2em}
section{background:#fff;border:1px solid #dde;border-radius:6px;padding:1em 1.2em;margin:1em 0}
img{max-width:100%;height:auto;display:block;margin:auto}table{border-collapse:collapse}
td,th{padding:.15em .9em .15em 0;text-align:left;vertical-align:top}td.n{text-align:right}
.row{display:flex;flex-wrap:wrap;gap:1em 3em}.bar{display:inline-block;height:.8em;background:#5b8fd6}
.key{display:inline-block;width:.8em;height:.8em;margin-right:.4em}.warn{color:#8a4b00}
pre{overflow-x:auto;font-size:13px}
"""


class Report:
    """A run with the options of the command line, and the parts of its page."""

    def __init__(self, options):
        self.options = options
        self.sheet = Sheet(options.run)
        self.folder = self.sheet.folder
        self.history = plot_force.History(self.folder)
        self.log = results.read_text(self.folder / "job.log")
        self.last = self.sheet.last
        self.pictures = options.output or self.folder / "report"
        self.pictures.mkdir(parents=True, exist_ok=True)
        self.whole = 2 ** len(options.mirror)  # number of images of the model
        self.parts = []
        self.limit = ""  # result of the forming limit diagram

    def field(self, name, at_cells=False):
        return self.sheet.values(self.last, name, at_cells)[0]

    def add(self, title, content):
        self.parts.append(f"<section><h2>{html.escape(title)}</h2>\n{content}\n</section>")

    def image(self, name, alt):
        """Return the element of a picture that has been written."""
        data = base64.b64encode((self.pictures / f"{name}.png").read_bytes()).decode()
        return f'<img alt="{html.escape(alt)}" src="data:image/png;base64,{data}">'

    def figure(self, name, figure, alt):
        """Write a figure and return its element."""
        figure.savefig(self.pictures / f"{name}.png", dpi=130)
        plt.close(figure)
        return self.image(name, alt)

    def sheet_picture(self, name, field, alt, *more):
        """Draw the sheet with plot_sheet.py and return the element."""
        words = [str(self.sheet.path), "--field", field, "--output", str(self.pictures / f"{name}.png"), *more]
        words += ["--mirror", "".join(self.options.mirror)] if self.options.mirror in (["x"], ["y"], ["x", "y"]) else \
            [word for axis in self.options.mirror for word in ("--mirror", axis)]
        if self.options.deck and "all" not in more:
            words += ["--deck", str(self.options.deck)]
        plot_sheet.make_picture(plot_sheet.Run(self.sheet.path), plot_sheet.arguments(words))
        return self.image(name, alt)


def table(rows):
    """Return a table of names and values."""
    return "<table>" + "".join(f"<tr><th>{html.escape(name)}</th><td>{html.escape(str(value))}</td></tr>"
                               for name, value in rows) + "</table>"


def columns(*tables):
    return '<div class="row">' + "".join(f"<div>{part}</div>" for part in tables) + "</div>"


def warnings_in(log):
    """Return the warnings of a log."""
    return [line for line in log.splitlines() if re.match(r"(\S+:\d+: )?warning\b.*?: ", line)]


def add_summary(report):
    """Add the numbers that a reader looks for first."""
    nodes, thickness, thinning = report.sheet.points(report.last), report.field("thickness"), report.field("thinning")
    thin = thinning.argmax()
    force = np.abs(np.column_stack([report.history.column(f"{tool}_fz") for tool in report.history.tools()])
                   if report.history.tools() else np.zeros((1, 1)))
    rows = [("thickness", f"{thickness.min():.4g} to {thickness.max():.4g} mm"),
            ("largest thinning", f"{100 * thinning.max():.3g} % at ({', '.join(f'{x:.1f}' for x in nodes[thin])}) mm"),
            ("largest thickening", f"{max(0.0, -100 * thinning.min()):.3g} %"),
            ("equivalent plastic strain", f"{report.field('equivalent_plastic_strain').max():.4g}")]
    if report.limit:
        rows.append(("forming limit", report.limit))
    tools = [(f"{tool}: largest force along z, largest pressure", f"{report.whole * force[:, i].max() / 1000:.4g} kN, "
              f"{report.history.column(tool + '_pressure').max():.3g} MPa")
             for i, tool in enumerate(report.history.tools())]
    work = report.history.column("tool_work")[-1] + report.history.column("external_work")[-1]
    if abs(work) > 0:
        tools.append(("error of the energy balance", f"{100 * report.history.column('energy_error')[-1] / work:.2g} %"))
    report.add("Result", columns(table(rows), table(tools)))


def add_setup(report):
    """Add the set-up: heading of the log and the blocks of its input."""
    heading, values = results.echo_in(report.log)
    heading = [line for line in heading if "warning" not in line]
    report.add("Set-up", "<p>" + "<br>".join(map(html.escape, heading)) + "</p><details><summary>All input values"
               "</summary><pre>" + html.escape("\n".join(values)) + "</pre></details>")


def add_statistics(report):
    """Add what the run cost: increments, iterations, time by section."""
    status = results.read_table(report.folder / "status.csv", "outcome", "limiter", "phase")
    status = [row for row in status if results.is_whole(row)]
    total = results.totals(status)
    seconds = results.time_by_section(report.folder, SECTIONS)
    found = re.search(r"iterations; ([\d.eE+-]+) s", report.log)
    rows = [("end of the run", report.log.strip().splitlines()[-1]), ("increments", total.increments),
            ("cut-backs", total.cutbacks), ("iterations", total.iterations)]
    if found:
        rows.append(("wall-clock time", f"{float(found[1]):.4g} s"))
    limiters = {}
    for row in status:
        if row["outcome"] == "accepted":
            limiters[row["limiter"]] = limiters.get(row["limiter"], 0) + 1
    rows.append(("limited by", ", ".join(f"{name} {count}" for name, count in
                                         sorted(limiters.items(), key=lambda item: -item[1]))))
    most = max(sum(seconds.values()), 1e-9)
    bars = "<table>" + "".join(
        f'<tr><th>{name}</th><td class="n">{value:.3g} s</td>'
        f'<td><span class="bar" style="width:{220 * value / most:.0f}px"></span> {100 * value / most:.0f} %</td></tr>'
        for name, value in seconds.items()) + "</table>"
    report.add("Run", columns(table(rows), bars))


def add_force(report):
    """Add the force of the controlling tool, and of the others in the same phases."""
    if not report.history.tools():
        return
    history = report.history
    leader = plot_force.controlling_tool(history)
    rows = history.rows_of([history.phase[-1]])
    place = np.linalg.norm(history.vector(leader, "u")[rows] - history.vector(leader, "u")[rows][0], axis=1)
    figure, axes = plt.subplots(figsize=(8, 4), layout="constrained")
    left = [axis not in report.options.mirror for axis in AXES]  # the others are zero on the whole part
    forces = {tool: report.whole * np.linalg.norm(history.vector(tool, "f")[rows][:, left], axis=1)
              for tool in history.tools()}
    unit, scale = ("kN", 1000) if max(force.max() for force in forces.values()) >= 1000 else ("N", 1)
    for tool, force in forces.items():
        axes.plot(place, force / scale, linewidth=2 if tool == leader else 1, label=tool.replace("_", " "))
    axes.set_xlabel(f"displacement of {leader.replace('_', ' ')} (mm)")
    axes.set_ylabel(f"force ({unit})" + (f", whole part, {report.whole} times the model" if report.whole > 1 else ""))
    axes.grid(True, color="0.9")
    axes.legend(frameon=False)
    report.add(f"Forces in phase {history.phase[-1]}", report.figure("force", figure, "tool forces over displacement"))


def add_beads(report):
    """Add the restraining forces of the draw-beads over the travel, and their lengths on the sheet."""
    history = report.history
    beads = [name.removesuffix("_restraint") for name in history.names if name.endswith("_restraint")]
    if not beads:
        return
    along = "travel" if np.ptp(history.column("travel")) > 0 else "increment"
    figure, axes = plt.subplots(figsize=(8, 3.5), layout="constrained")
    rows = []
    for bead in beads:
        force, length = (report.whole * history.column(f"{bead}_{name}") for name in ("restraint", "length"))
        axes.plot(history.column(along), force / 1000, label=bead.replace("_", " "))
        rows.append((bead, f"at most {force.max() / 1000:.4g} kN, at the end {force[-1] / 1000:.4g} kN; on the sheet "
                     f"{length.max():.4g} mm at most, {length[-1]:.4g} mm at the end"))
    axes.set(xlabel="travel (mm)" if along == "travel" else along,
             ylabel="restraining force (kN)" + (", whole part" if report.whole > 1 else ""))
    axes.grid(True, color="0.9")
    axes.legend(frameon=False)
    report.add("Draw-beads", report.figure("beads", figure, "restraining forces of the draw-beads") + table(rows))


def find_curve(report):
    """Return the forming limit curve, or None without an exponent."""
    options = report.options
    if options.curve:
        return forming_limit.read_curve(options.curve, options.engineering)
    exponent = options.n or exponent_in(report.log)
    if exponent is None:
        return None
    thickness = report.sheet.values(0, "thickness")[0]
    return forming_limit.keeler_brazier(float(np.median(thickness[thickness > 0])), exponent)


def exponent_in(log):
    """Return the exponent n of the first hardening law swift, swift_voce or ludwik in a log; None if there is none."""
    law = re.search(r"^\s*hardening = (?:swift|swift_voce|ludwik)\b(.*)$", log, re.MULTILINE | re.IGNORECASE)
    found = law and re.search(r"\bn=([\d.eE+-]+)", law[1])
    return float(found[1]) if found else None


def add_limit_diagram(report):
    """Add the forming limit diagram and the map of its zones."""
    major, minor = report.field("major_strain_middle"), report.field("minor_strain_middle")
    curve = find_curve(report)
    figure, axes = plt.subplots(figsize=(8, 5.2), layout="constrained")
    if curve is None:
        axes.plot(minor, major, ".", color="0.4")
        zone = None
    else:
        zone = curve.zones(major, minor, report.options.margin)
        for number, name in enumerate(forming_limit.ZONES):
            here = zone == number
            if here.any():
                axes.plot(minor[here], major[here], ".", color=forming_limit.COLOURS[number], label=name)
        at = np.linspace(min(-0.3, minor.min()), max(0.3, minor.max()), 200)
        axes.plot(at, curve.limit(at), "k-", linewidth=1.5, label=curve.label)
        axes.plot(at, curve.limit(at) - report.options.margin, "k--", linewidth=0.8, label="marginal")
        room = (curve.limit(minor) - major)[zone > 0]
        critical = int((zone == forming_limit.ZONES.index("critical")).sum())
        nearest = f"; smallest distance below the curve {room.min():.3g}" if room.size and not critical else ""
        report.limit = f"{critical} of {len(zone)} nodes critical{nearest}"
    low, high = axes.get_xlim()
    axes.plot([low, 0, high], [-low, 0, high], color="0.6", linewidth=0.8)
    axes.set(xlim=(low, high), ylim=(min(0, major.min()), None), xlabel="minor strain (logarithmic)",
             ylabel="major strain (logarithmic)")
    axes.grid(True, color="0.9")
    if curve is not None:
        axes.legend(frameon=False, fontsize=9)
    content = report.figure("limit", figure, "forming limit diagram")
    if zone is None:
        content += "<p>No forming limit curve: the hardening law has no exponent n. Give --n or --curve.</p>"
    else:
        content += zone_map(report, zone) + f"<p>{html.escape(report.limit)}. Marginal: less than " \
            f"{report.options.margin:g} below the curve; wrinkling: thicker than before, the major strain is smaller " \
            "than minus the minor one.</p>"
    report.add("Forming limit", content)


def zone_map(report, zone):
    """Draw the zones on the sheet and return the element."""
    run = plot_sheet.Run(report.sheet.path)
    options = plot_sheet.arguments([str(report.sheet.path), "--hide", "all", "--size", "1300", "650"])
    options.mirror = report.options.mirror
    plotter = plot_sheet.new_plotter(options, 1)
    plotter.subplot(0, 0)
    mesh = run.mesh(report.last, "thickness", False)[0]
    # A cell has the worst zone of its nodes.
    mesh.cell_data["zone"] = np.array([zone[mesh.get_cell(i).point_ids].max() for i in range(mesh.n_cells)])
    for part in plot_sheet.reflected(mesh, options.mirror):
        skin = part.extract_surface(algorithm="dataset_surface")
        plotter.add_mesh(skin, scalars="zone", cmap=list(forming_limit.COLOURS), show_edges=True, edge_color="#444444",
                         clim=[-0.5, len(forming_limit.ZONES) - 0.5], show_scalar_bar=False, ambient=0.3)
    plot_sheet.aim(plotter, plot_sheet.box_of(run, [report.last], options, {}), options)
    plotter.screenshot(str(report.pictures / "zones.png"))
    plotter.close()
    keys = " ".join(f'<span class="key" style="background:{colour}"></span>{name}&emsp;'
                    for name, colour in zip(forming_limit.ZONES, forming_limit.COLOURS))
    return report.image("zones", "zones of the forming limit diagram on the sheet") + f"<p>{keys}</p>"


def section_planes(report):
    """Return the planes of --section, by default those through the middle of the whole sheet."""
    if report.options.section:
        return report.options.section
    points = report.sheet.points(0)
    middle = {axis: 0.0 if axis in report.options.mirror else float(points[:, i].min() + points[:, i].max()) / 2
              for i, axis in enumerate(AXES)}
    planes = [f"y={middle['y']:.6g}", f"x={middle['x']:.6g}"]
    return planes + ["45"] if {"x", "y"} <= set(report.options.mirror) else planes


def add_sections(report):
    """Add thickness and shape along sections."""
    planes = section_planes(report)
    figure, axes = plt.subplots(2, 1, figsize=(8, 7), layout="constrained")
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


def images(points, mirror):
    """Return points and their mirror images."""
    parts = [points]
    for axis in mirror:
        factor = np.where(np.arange(3) == AXES.index(axis), -1.0, 1.0)
        parts += [part * factor for part in parts]
    return parts


def add_outline(report):
    """Add the outline before and after, and the draw-in along it."""
    figure, (axes, along) = plt.subplots(1, 2, figsize=(11, 5), layout="constrained")
    start, now, value = report.sheet.points(0), report.sheet.points(report.last), report.field("draw_in")
    for line in report.sheet.outline(True, report.options.mirror):
        for points, style in ((start, {"color": "0.5", "linewidth": 1}), (now, {"color": "#d64541", "linewidth": 1.6})):
            for part in images(points[line], report.options.mirror):
                axes.plot(part[:, 0], part[:, 1], **style)
        middle = (start.min(axis=0) + start.max(axis=0)) / 2
        middle = [0.0 if axis in report.options.mirror else middle[i] for i, axis in enumerate(AXES)]
        angle = np.degrees(np.unwrap(np.arctan2(start[line, 1] - middle[1], start[line, 0] - middle[0])))
        along.plot(angle - 360 * np.floor(angle.min() / 360 + 1e-9), value[line], ".-", markersize=3)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="x (mm)", ylabel="y (mm)")
    axes.legend(handles=[Patch(color="0.5", label="before"), Patch(color="#d64541", label="after")], frameon=False)
    along.set(xlabel="angle from x at the start (degrees)", ylabel="draw-in (mm)")
    for place in (axes, along):
        place.grid(True, color="0.9")
    report.add("Outline and draw-in", report.figure("outline", figure, "outline before and after, draw-in"))


def add_pictures(report):
    """Add the thinning and the sheet between its tools."""
    size = ("--size", "1300", "650")
    thinning = report.sheet_picture("thinning", "thinning", "thinning on the deformed sheet", "--hide", "all", *size)
    report.add("Thinning", thinning)
    sheet = report.sheet_picture("sheet", "equivalent_plastic_strain", "deformed sheet and tools", *size)
    report.add("Sheet and tools", sheet)


def add_warnings(report):
    """Add the warnings of the log."""
    found = warnings_in(report.log)
    content = "<ul class=warn>" + "".join(f"<li>{html.escape(line)}</li>" for line in found) + "</ul>"
    report.add("Warnings", content if found else "<p>None.</p>")


def page(report):
    """Return the text of the page."""
    lines = report.log.splitlines()
    title = lines[1] if len(lines) > 1 and not lines[1].startswith("started") else report.folder.resolve().name
    images_of = f"; completed at the planes {', '.join(report.options.mirror)} = 0" if report.options.mirror else ""
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{html.escape(title)}</title><style>{STYLE}</style></head><body><main>
<h1>{html.escape(title)}</h1><p>State at a travel of {report.sheet.travel[report.last]:.4g} mm{images_of}.</p>
{chr(10).join(report.parts)}
</main></body></html>
"""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", metavar="RUN", help="folder of results")
    parser.add_argument("--mirror", nargs="+", default=[], choices=list(AXES), metavar="AXIS",
                        help="planes of symmetry x = 0, y = 0 or z = 0 to complete the model at")
    parser.add_argument("--curve", metavar="FILE", help="measured forming limit curve")
    parser.add_argument("--engineering", action="store_true", help="the strains of --curve are engineering strains")
    parser.add_argument("--n", type=float, help="hardening exponent of the curve of Keeler and Brazier")
    parser.add_argument("--margin", type=float, default=0.1, help="width of the marginal zone in major strain (0.1)")
    parser.add_argument("--section", action="append", default=[], metavar="PLANE",
                        help="x=0, y=12.5 or an angle in degrees; may be repeated (default: through the middle)")
    parser.add_argument("--deck", type=Path, help="input file of the job, for its tools (default: beside RUN)")
    parser.add_argument("--output", type=Path, metavar="DIR", help="folder of page and pictures (default: RUN/report)")
    options = parser.parse_args()
    options.mirror = sorted(set(options.mirror))
    if options.n is not None and not options.n > 0 or options.margin < 0:
        parser.error("--n takes a positive number, --margin one that is not negative")
    return options


def main():
    options = arguments()
    report = Report(options)
    steps = (add_pictures, add_limit_diagram, add_sections, add_outline, add_force, add_beads, add_warnings, add_statistics,
             add_setup)
    progress = scripts.Progress("report")
    for number, step in enumerate(steps):
        progress(number / len(steps))
        step(report)
    progress.end()
    add_summary(report)
    report.parts.insert(0, report.parts.pop())
    path = report.pictures / "report.html"
    path.write_text(page(report), encoding="utf-8")
    print(path)


if __name__ == "__main__":
    scripts.run(main)
