# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of the page about the course of the run: results, verdict, phases, draw-beads, warnings, set-up."""

import html
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from dd3 import verdict
from dd3.plot import force as forces
from dd3.plot.figures import new_figure
from dd3.report.page import Report, columns, table
from dd3.run import parts_of, read_frame, warnings_of
from dd3.sheet import AXES
from dd3.springback import unfinished


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
    report.verdict = verdict.judge(report.job, report.waves, report.splits,
                                   [*verdict.sprung(report.sprung, report.tolerance, unfinished(report.job["phases"])),
                                    *report.deviations])
    rows = "".join(f'<tr><th>{html.escape(item.name)}</th><td class="answer"><span class="key" style="background:'
                   f'{verdict.COLOURS[item.answer]}"></span>{item.answer}</td><td>{html.escape(item.text)}</td></tr>'
                   for item in report.verdict)
    said = verdict.summary(report.verdict)
    report.add("Verdict", f"<p><b>{html.escape(said[:1].upper() + said[1:])}.</b></p><table>{rows}</table>")


def add_phases(report: Report) -> None:
    """Add the phases: what the tools do, their forces, what limited the increments and what warned."""
    status = read_frame(report.folder, "status.csv", "outcome", "limiter", "phase")
    for phase in report.job["phases"]:
        name = phase["name"]
        attempts = status[status["phase"] == name]
        if attempts.empty:
            continue
        content = table(phase_rows(report, phase, attempts))
        if name in set(report.history["phase"]) and any(tool["active"] for tool in phase["tools"]):
            content = force_figure(report, name) + content
        report.add(f"Phase {phase['number']}: {name}", content)


def phase_rows(report: Report, phase: dict[str, Any], attempts: pd.DataFrame) -> list[tuple[str, Any]]:
    """Return the rows of the table of a phase."""
    name, accepted = phase["name"], attempts[attempts["outcome"] == "accepted"]
    limiters = accepted["limiter"].value_counts()
    warnings = [f"{warning['code']}: {warning['text']}" for warning in warnings_of(report.job)
                if warning["phase"] == name]
    rows: list[tuple[str, Any]] = [(tool["name"], action(tool)) for tool in phase["tools"]]
    rows += [("driven by", phase["control"] or "the fraction of the phase"), ("ends", end_of_phase(report, phase)),
             ("increments", f"{len(accepted)}, {int((attempts['outcome'] == 'retry').sum())} cut back; "
                            f"{int(attempts['iterations'].sum())} iterations"),
             ("limited by", ", ".join(f"{limiter} {count}" for limiter, count in limiters.items()))]
    return [*rows, *(("warning", warning) for warning in warnings)]


def end_of_phase(report: Report, phase: dict[str, Any]) -> str:
    """Return where a phase ends: its travel and progress."""
    if phase["name"] not in set(report.history["phase"]):  # no increment of it is accepted, or recorded
        result = phase.get("result", {})
        if result.get("progress"):
            return f"at {100 * result['progress']:.4g} %"
        return "in its first increment" if result.get("state") == "running" else "stopped in its first increment"
    rows = forces.rows_of(report.history, [phase["name"]])
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
    left = [axis not in report.mirror for axis in AXES]  # the others are zero on the whole part
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


def add_warnings(report: Report) -> None:
    """Add the warnings of the run."""
    found = [f"{warning['at']['file']}:{warning['at']['line']}: {warning['text']}" if warning["at"] else warning["text"]
             for warning in warnings_of(report.job)]
    content = "<ul class=warn>" + "".join(f"<li>{html.escape(line)}</li>" for line in found) + "</ul>"
    report.add("Warnings", content if found else "<p>None.</p>")


def add_statistics(report: Report) -> None:
    """Add what the run cost: increments, iterations, time by section."""
    status = read_frame(report.folder, "status.csv", "outcome", "limiter", "phase")
    accepted, parts = status[status["outcome"] == "accepted"], [part for part, _ in parts_of(report.job)]
    names = dict.fromkeys(name for part in parts for name in part["sections"])
    seconds = {name: sum(part["sections"].get(name, 0.0) for part in parts) for name in names}
    whole = sum(part["seconds"] or 0.0 for part in parts)
    rows: list[tuple[str, Any]] = [
        ("end of the run", end_of(report)), ("increments", len(accepted)),
        ("cut-backs", int((status["outcome"] == "retry").sum())), ("iterations", int(status["iterations"].sum()))]
    if whole:
        rows.append(("wall-clock time", f"{whole:.4g} s"))
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
