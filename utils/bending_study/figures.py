# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw the figures of the bending study from its results, numbered like the paper's.

    python3 -m bending_study figures --work bending_study.out --output docs/images

study_fig3, 6, 8, 9: travel reached, by penalty and mesh (3_8: with at most 8 iterations); study_fig4: the sheet at
2.0 mm with the status of its contact candidates; study_fig7: B of the node that controls the limit on the contact
forces. Figures whose cases were not run are left out.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from bending_study.tables import END, MESHES, PENALTIES, PERTURBED
from dd3.command import new_parser
from dd3.plot.figures import new_figure, save, tidy
from dd3.programs import made_folder
from dd3.sheet import Sheet
from dd3.tables import Row, force_limits, read_table

# Figure: endings of its cases' names and their meaning.
BARS = {
    "3": [("", "no force control")],
    "3_8": [("-max8", "no force control"), ("-c1-max8", "c = 1")],
    "6": [("-c0.1", "c = 0.1"), ("-c1", "c = 1"), ("-c1000", "c = 1000")],
    "8": [("-normal", "normal force: 1, 1000, 1000"), ("-tangential", "tangential force: 1000, 1, 1")],
    "9": [("-c1-alone", "c = 1"), ("-c1000-alone", "c = 1000")],
}
COLOURS = {"a": ["#c2571a", "#e08a4f", "#f2bd94"], "b": ["#1f5f99", "#5a95c9", "#a9cbe8"]}
# Contact status by its number in fields.vtkhdf: name, colour, marker.
STATUS = [("gap", "0.75", "o"), ("stick", "#1f5f99", "s"), ("slip", "#c2571a", "D")]


def travel_range(results: Mapping[str, Row], case: str) -> tuple[float, float]:
    """Return the smallest and largest travel of a case and of those that differ from it by round-off only."""
    travel = [float(results[case + way]["travel"]) for way in PERTURBED if case + way in results]
    return min(travel), max(travel)


def bars(results: Mapping[str, Row], number: str, path: Path) -> bool:
    """Draw the travel reached by each case of a set: the paper's Figs 3, 6, 8 and 9."""
    groups = [(mesh, *ending) for mesh in MESHES for ending in BARS[number]]
    if any(f"{mesh}-{p}{ending}" not in results for mesh, ending, _ in groups for p in PENALTIES):
        return False
    figure, axes = new_figure((7.5, 3.6))
    width = 0.84 / len(groups)
    for i, (mesh, ending, label) in enumerate(groups):
        place = np.arange(len(PENALTIES)) + (i - 0.5 * (len(groups) - 1)) * width
        travel = [float(results[f"{mesh}-{p}{ending}"]["travel"]) for p in PENALTIES]
        shade = COLOURS[mesh][i % len(BARS[number])]
        axes.bar(place, travel, 0.94 * width, color=shade, label=f"mesh ({mesh}), {label}")
        spread = np.array([travel_range(results, f"{mesh}-{p}{ending}") for p in PENALTIES]).T
        axes.errorbar(place, travel, np.abs(spread - travel), fmt="none", ecolor="0.15", elinewidth=0.8, capsize=1.5)
        for x, reached, top in zip(place, travel, spread[1], strict=True):
            axes.annotate("40" if reached > END - 0.05 else f"{reached:.1f}", (x, top), (0, 2), fontsize=6, ha="center",
                          textcoords="offset points")
    axes.axhline(END, color="0.5", linewidth=0.8, linestyle="--", zorder=0)
    axes.set_xticks(range(len(PENALTIES)), [f"p = {float(p):.0f}" for p in PENALTIES])
    axes.set_ylabel("punch travel reached (mm)")
    axes.set_ylim(0.0, 1.08 * END)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, fontsize=8, ncols=2, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    save(figure, path, 150)
    return True


def control_force(work: Path, results: Mapping[str, Row], path: Path) -> bool:
    """Draw B of the controlling node over travel: the paper's Fig. 7."""
    cases = [f"{mesh}-1e3-c1" for mesh in MESHES]
    if any(case not in results for case in cases):
        return False
    figure, axes = new_figure((7.5, 3.6))
    for mesh, case in zip(MESHES, cases, strict=True):
        points = list(force_limits(read_table(work / case / "status.csv", "force_node"), "draw"))
        colour = COLOURS[mesh][0]
        axes.plot([t for t, *_ in points], [b for *_, b in points], ".", markersize=2.5, color=colour)
        median = sorted(b for *_, b in points)[len(points) // 2]
        axes.plot([], [], "o", color=colour, label=f"mesh ({mesh}), median {median:.0f} N")
    axes.set_yscale("log")
    axes.set_xlim(0.0, END)
    axes.set_xlabel("punch travel (mm)")
    axes.set_ylabel("B of the controlling node (N)")
    tidy(axes)
    axes.legend(frameon=False, fontsize=8)
    save(figure, path, 150)
    return True


def nodes_at(folder: Path, travel: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Return positions and contact status of the nodes at a travel, the elements' corners, and the step's travel."""
    sheet = Sheet(folder)
    step = sheet.nearest_step(travel)
    status, _ = sheet.values(step, "contact_status")
    return sheet.points(step), status.astype(int).ravel(), sheet.corners(step), float(sheet.travel[step])


def sheets(work: Path, results: Mapping[str, Row], path: Path) -> bool:
    """Draw both sides of both sheets at 2.0 mm from above: the paper's Fig. 4."""
    cases = [f"{mesh}-1e3" for mesh in MESHES]
    if any(case not in results for case in cases):
        return False
    figure, axes = new_figure((10.0, 4.6), 3, 2, sharex=True, gridspec_kw={"height_ratios": [1.0, 1.0, 0.55]})
    for column, case in enumerate(cases):
        points, status, elements, travel = nodes_at(work / case, 2.0)
        for row, (side, faces) in enumerate((("upper side: punch, blank-holder", elements[1::2, 4:]),
                                             ("lower side: die", elements[0::2, :4]))):
            plot = axes[row][column]
            for face in faces:
                plot.plot(*points[np.append(face, face[0]), :2].T, color="0.85", linewidth=0.7, zorder=1)
            nodes = np.unique(faces)
            for value, (name, colour, marker) in enumerate(STATUS):
                chosen = nodes[status[nodes] == value]
                plot.plot(*points[chosen, :2].T, marker, color=colour, markersize=4.5 if value else 3.0, label=name)
            plot.set_title(f"mesh ({MESHES[column]}), {travel:.1f} mm, {side}", fontsize=8)
            plot.set_ylabel("y (mm)", fontsize=8)
        plot = axes[2][column]
        edge = points[:, 1] < 0.2
        plot.plot(points[edge, 0], points[edge, 2], ".", markersize=3, color="0.3")
        plot.set_title("the edge y = 0 from the front", fontsize=8)
        plot.set_xlabel("x (mm)", fontsize=8)
        plot.set_ylabel("z (mm)", fontsize=8)
    for plot in axes.ravel():
        plot.tick_params(labelsize=7)
        plot.spines[["top", "right"]].set_visible(False)
    handles, labels = axes[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, frameon=False, fontsize=8, ncols=3, loc="outside lower center")
    save(figure, path, 150)
    return True


def main(words: Sequence[str] | None = None) -> None:
    """Draw the figures whose cases were run."""
    parser = new_parser("figures", __doc__, "python3 -m bending_study")
    parser.add_argument("--work", type=Path, default=Path("bending_study.out"), help="folder of the study's results")
    parser.add_argument("--output", type=Path, help="folder of the pictures (default: the same)")
    options = parser.parse_args(words)
    results = {row["case"]: row for row in read_table(options.work / "results.csv")}
    folder = made_folder(options.output or options.work)
    for number in BARS:
        if bars(results, number, folder / f"study_fig{number}.png"):
            print(folder / f"study_fig{number}.png")
    for number, draw in (("4", sheets), ("7", control_force)):
        if draw(options.work, results, folder / f"study_fig{number}.png"):
            print(folder / f"study_fig{number}.png")
