# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of the page about the sheet: pictures, forming limit, sections, outline, springback, refinements."""

import html
from typing import Any

import numpy as np
from matplotlib.patches import Patch

from dd3 import computed, forming_limit, forming_limit_diagram, material_limits, measured, springback, verdict
from dd3.account import Account
from dd3.forming_limit_curve import COLOURS, ZONES
from dd3.plot import sheet as pictures
from dd3.plot import skins
from dd3.plot.figures import new_figure
from dd3.report.page import Report, section_planes, table, upwards
from dd3.section import pieces_of
from dd3.sheet import in_plane, of_pieces, plane
from dd3.viewer import page as interactive
from dd3.viewer.scene import Scene


def add_view(report: Report) -> None:
    """Add the part in 3D."""
    limits = forming_limit.find_limits(report.sheet, report.job, report.criteria)
    scene = Scene(report.sheet, report.run, report.mirror, limits, report.criteria.margin)
    report.add("Part in 3D", interactive.view(scene))


def add_pictures(report: Report) -> None:
    """Add the thinning, the limits that the run follows, and the sheet between its tools."""
    limits = [(title, name, name, f"{title.lower()} on the deformed sheet", ("all",), not of_nodes)
              for name, (title, *_, of_nodes) in material_limits.FIELDS.items()
              if name in report.sheet.grid["PointData"]]
    for title, name, field, alt, hide, cells in (
            ("Thinning", "thinning", "thinning", "thinning on the deformed sheet", ("all",), False), *limits,
            ("Sheet and tools", "sheet", "equivalent_plastic_strain", "deformed sheet and tools", (), False)):
        report.add(title, report.sheet_drawn(name, alt, field=field, hide=hide, cells=cells))


def add_limit_diagram(report: Report) -> None:
    """Add the forming limit diagram and the map of its zones."""
    figure, axes = new_figure((8, 5.2))
    account = Account()
    limits = forming_limit.find_limits(report.sheet, report.job, report.criteria, account)
    strains = forming_limit.strains_of(report.sheet, report.last, "middle")
    found = forming_limit.judge(strains, limits, report.criteria.margin)
    zone, report.limits = found
    forming_limit_diagram.draw(axes, strains, limits, report.criteria.margin, zone)
    for limit in material_limits.reached(report.sheet, report.last):
        material_limits.mark(axes, strains, limit)
        report.limits.append(limit.said())
    report.splits = verdict.splits(found.critical, report.limits, strains.largest_thinning() > limits.thinning)
    content = report.saved("limit", figure, "forming limit diagram")  # that of the 3D view answers to the mouse
    content += "" if zone is None else zone_map(report, zone)
    said = [*report.limits, *(f"left out: {item}" for item in account.left_out())]
    content += "".join(f"<p>{html.escape(line[:1].upper() + line[1:])}.</p>" for line in said)
    if zone is not None:
        content += f"<p>Dots: nodes; crosses: elements. Marginal: less than {report.criteria.margin:g} below the " \
            "curve; thickening: thicker than before, the major strain is smaller than minus the minor one.</p>"
    report.add("Forming limit", content)


def zone_map(report: Report, zone: np.ndarray) -> str:
    """Draw the zones on the sheet and return the element."""
    keys = " ".join(f'<span class="key" style="background:{colour}"></span>{name}&emsp;'
                    for name, colour in zip(ZONES, COLOURS, strict=True))
    return report.drawn(lambda: draw_zones(report, zone), "zones",
                        "zones of the forming limit diagram on the sheet") + f"<p>{keys}</p>"


def draw_zones(report: Report, zone: np.ndarray) -> None:
    """Draw the zones on the sheet and write the picture."""
    style = report.style()
    plotter = pictures.new_plotter(style.size)
    plotter.subplot(0, 0)
    mesh = report.run.shape(report.last)
    # A cell has the worst zone of its nodes and its own.
    mesh.cell_data["zone"] = np.array([max(zone[mesh.get_cell(i).point_ids].max(), zone[mesh.n_points + i])
                                       for i in range(mesh.n_cells)])
    pictures.add_surface(plotter, skins.sheet_skin(mesh, style.mirror), scalars="zone",
                         cmap=list(COLOURS), clim=[-0.5, len(ZONES) - 0.5])
    pictures.aim(plotter, pictures.box_of(report.run, [report.last], style.mirror, {}), style)
    plotter.screenshot(report.picture("zones"))
    plotter.close()


def add_sections(report: Report) -> None:
    """Add thickness and shape along sections."""
    planes = section_planes(report)
    figure, axes = new_figure((8, 7), 2)
    for text in planes:
        normal, distance = plane(text)
        name = text if "=" in text else f"{text} degrees"
        for section in pieces_of(report.sheet, report.sheet.cut(normal, distance), report.last):
            label = name + section.named()
            axes[0].plot(section.length0, section.field("thickness")[0], ".-", markersize=3, label=label)
            axes[1].plot(*in_plane(section.now, normal).T, ".-", markersize=3, label=label)
    axes[0].set(xlabel="initial length along the section (mm)", ylabel="thickness (mm)")
    axes[1].set(xlabel="in the plane of the section (mm)", ylabel=upwards(planes))
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
    for line in report.sheet.outline(True, report.mirror):
        for points, colour, width in ((start, "0.5", 1), (now, "#d55e00", 1.6)):
            for part in springback.images(points[line], report.mirror):
                axes.plot(part[:, 0], part[:, 1], color=colour, linewidth=width)
    for angle, value in computed.draw_in(report.sheet, report.mirror):
        along.plot(angle, value, ".-", markersize=3)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set(xlabel="x (mm)", ylabel="y (mm)")
    axes.legend(handles=[Patch(color="0.5", label="before"), Patch(color="#d55e00", label="after")], frameon=False)
    along.set(xlabel="angle from x at the start (degrees)", ylabel="draw-in (mm)")
    for place in (axes, along):
        place.grid(True, color="0.9")
    report.add("Outline and draw-in", report.figure("outline", figure, "outline before and after, draw-in"))


def add_springback(report: Report) -> None:
    """Add the free shape against the drawn one: map of the distances, sections over one another, angles and twist."""
    found = springback.find(report.sheet, report.job["phases"], report.mirror)
    if found is None:
        if said := springback.unfinished(report.job["phases"]):
            report.add("Springback", f"<p>Not judged: {said}.</p>")
        return
    figure, axes = new_figure((8, 4))
    rows: list[tuple[str, Any]] = []
    planes = section_planes(report)
    for text in planes:
        normal, place = plane(text)
        lines = report.sheet.cut(normal, place, step=found.step)
        name = text if "=" in text else f"{text} degrees"
        for points, style in ((found.drawn, "--"), (found.free, "-")):
            for line in lines:
                axes.plot(*in_plane(line.at(points), normal).T, style, color=f"C{len(rows)}", linewidth=1.3,
                          label=None if line is not lines[0] else f"{name}, {'drawn' if style == '--' else 'free'}")
        ends = springback.opening(lines[0], found, normal)
        said = of_pieces(lines, report.sheet.start(found.step))
        rows.append((f"section {name}", f"turned by {springback.rotation(lines[0], found, normal):+.3g} degrees; its "
                     f"ends against that by {ends[0]:+.3g} and {ends[1]:+.3g} degrees{said and '; ' + said}"))
    axes.set(xlabel="in the plane of the section (mm)", ylabel=upwards(planes))
    axes.set_aspect("equal", adjustable="datalim")
    axes.grid(True, color="0.9")
    axes.legend(frameon=False)
    pieces: list[str] = []
    twisted = springback.twist(report.sheet, found, pieces)
    if twisted:
        rows.append((f"twist about {twisted[0]} from 10 to 90 % of the length",
                     "; ".join((f"{twisted[1]:+.3g} degrees", *pieces))))
    distance = found.distance()
    report.sprung = float(distance.max())
    rows.insert(0, ("largest distance from the drawn shape", f"{distance.max():.4g} mm"))
    mean = np.average(distance, weights=report.sheet.areas(found.step))
    rows.insert(1, ("mean distance over the area", f"{mean:.4g} mm"))
    report.add("Springback", "<p>The free shape, moved to the best fit with the drawn one"
               f"{springback.kept(found.mirror)}.</p>" + distance_map(report, found)
               + report.figure("springback", figure, "sections, drawn and free")
               + table(rows))


def distance_map(report: Report, found: springback.Springback) -> str:
    """Draw the distances from the drawn shape on the free one and return the element."""
    mesh = report.run.grid_of(found.step, found.free)
    mesh.point_data["shown"] = found.distance()
    label, name = "distance from the drawn shape (mm)", "distance"
    return report.drawn(lambda: pictures.make_map(mesh, label, report.style(), report.picture(name)), name,
                        "distance from the drawn shape")


def add_measured(report: Report) -> None:
    """Add the measured curves over the computed ones, with a table of their differences."""
    curves = [curve for file in report.measured for curve in measured.read(file, report.tools)]
    if not curves:
        return
    figure, axes = new_figure((8, 3.5 * len(curves)), len(curves), squeeze=False)
    rows = []
    for measure, place in zip(curves, axes[:, 0]):
        pieces, said = computed.curve(measure, report.sheet, report.history, report.mirror)
        found = (measured.from_line(measure, *map(np.column_stack, pieces)) if measure.over == "along"
                 else measured.along_curve(measure, *pieces[0], *pieces[1:]))
        unit, scale = measured.shown_unit(measure)
        over = "degrees" if measure.over == "angle" else "mm"
        for number, (at, values) in enumerate(pieces):
            place.plot(at, values / scale, "-", color="#0072b2", label=None if number else "computed")
        place.plot(measure.at, measure.values / scale, "o", markersize=3, color="#d55e00",
                   label=f"measured, {measure.file}")
        place.set(xlabel=f"{measure.over} ({over})", ylabel=f"{measure.title()} ({unit})")
        place.grid(True, color="0.9")
        place.legend(frameon=False)
        beyond = f"; {found.beyond} points beyond the computed curve are left out" if found.beyond else ""
        rows.append((f"{measure.title()} ({measure.file})", f"{found.points} points; largest difference "
                     f"{found.largest / scale:+.3g} {unit} at {measure.over} {found.where:.4g} {over}, rms "
                     f"{found.rms / scale:.3g} {unit}{beyond}{said and '; section of ' + said}"))
    report.add("Measured curves", report.figure("measured", figure, "measured and computed curves")
               + "<p>Differences: measured less computed values; of the shape of a section distances from it, along "
                 "its upper face.</p>" + table(rows))


def add_refinements(report: Report) -> None:
    """Add the refinements of the mesh, where there are any, and the levels of the elements at the end."""
    changes = report.job.get("refinements")
    if not changes:
        return
    picture = report.sheet_drawn("levels", "levels of the elements at the end", field="level", hide=("all",))
    heading = ("phase", "after increment", "travel, mm", "elements before", "after", "of levels 0, 1, ...",
               "forces out of balance, %", "next increment made again")
    rows = [(change["phase"], change["increment"], f"{change['travel']:.4g}", change["elements_before"],
             change["elements"], " + ".join(map(str, change["elements_of_level"])), f"{100 * change['imbalance']:.2g}",
             "yes" if change["repeated"] else "no") for change in changes]
    content = "".join("<tr>" + "".join(f"<td>{html.escape(str(cell))}</td>" for cell in row) + "</tr>\n"
                      for row in rows)
    names = "".join(f"<th>{name}</th>" for name in heading)
    report.add("Refinement", f"{picture}<table><tr>{names}</tr>\n{content}</table>")
