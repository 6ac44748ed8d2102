#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "forming_fender_line", "labels": ["slow"], "timeout": 2400, "cost": 300}
"""The line of the fender: drawn, trimmed and pierced, flanged by a steel and a cam, struck again.

    fender_line.py --program build/release/dd3imp --work build/fender_line

The CAD is written, the process makes the tools of it, runs to its end and writes its report. Checked: the trimmed sheet has in plan
the area within the trim curves; the volume of the sheet is kept; the forces of the tools balance; under the tools both
flanges have the angles of the posts; the restrike brings the flange of the wheel arch nearer to them and leaves that at
the hood. Warnings beside those of WARNINGS are errors: W111 of tools whose sides are in line, W124 of a part that was
turned.
"""
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

import dd3
from dd3.errors import check
from dd3.process import read_process, run_process, write_report
from dd3.programs import parser_of_runs

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "input_files" / "fender_line"
sys.path[:0] = [str(ROOT / "tests"), str(FOLDER)]
import make_cad  # noqa: E402
from bench import Value, check_values  # noqa: E402

WARNINGS = {"W106", "W109", "W118"}  # of the coarse mesh (W109, W118), of plastic strain in the release (W106)
# Degrees by which a flange under the tools may differ from its post: 1.8 and 1.9 on this mesh, not compared with others.
SHORT = 2.5
BINS = {"arch": np.arange(5, 56, 10), "hood": np.arange(10, 131, 20)}  # turn, degrees; x, mm
SIDE = {"arch": -1, "hood": 1}  # of the wall from the axis outwards
AXIS = {"arch": 0.0, "hood": make_cad.CAM}  # of the cylinders from z, degrees
TOOLS = {"flange": ("post", "pad", "steel", "cam"), "strike": ("post", "pad", "steel"),
         "draw": ("punch", "die", "holder")}


def in_cylinder(points, flange):
    """Return the distances of points from the axis of a flange, their places along it (turn in degrees, or x) and the
    directions from the axis."""
    angle = np.radians(AXIS[flange])
    turn = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
    middle = [0, make_cad.MIDDLE, 0] if flange == "arch" else [0, *make_cad.hood_edge()]
    local = (points - middle) @ turn.T
    if flange == "hood":
        local[:, 1] += make_cad.HOOD
    radius = np.hypot(local[:, 0], local[:, 1])
    away = np.pad(local[:, :2] / radius[:, None], ((0, 0), (0, 1))) @ turn
    return radius, np.degrees(np.arctan2(local[:, 0], local[:, 1])) if flange == "arch" else local[:, 0], away


def faces_of(grid):
    """Return centres and unit normals, outwards from the panel, of the elements in the middle of their thickness."""
    cells = np.asarray(grid.cells_dict[12])
    corner = np.asarray(grid.points)[cells].reshape(len(cells), 2, 4, 3).mean(axis=1)
    normal = np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])
    return corner.mean(axis=1), -normal / np.linalg.norm(normal, axis=1)[:, None]


def post_normals(points):
    """Return the normals of the face of the post at the places of points in plan of the part."""
    x, y, _ = make_cad.untipped(points).T
    step = 1e-4
    slope = [(make_cad.face(x - step, y) - make_cad.face(x + step, y)) / (2 * step),
             (make_cad.face(x, y - step) - make_cad.face(x, y + step)) / (2 * step), np.ones(len(x))]
    return make_cad.tipped(np.stack(slope, axis=-1) / np.linalg.norm(slope, axis=0)[:, None])


def angle_between(first, second):
    """Return the angle between two directions, degrees."""
    return np.degrees(np.arccos(np.clip(first @ second / np.linalg.norm(first) / np.linalg.norm(second), -1, 1)))


def bends(closed, free, flange, radius):
    """Return the angles, in the bins of a flange, by which it is bent from the face beside it: of the post, in the
    closed tools and free. The elements are chosen in the closed tools, on a post with a radius of its corner."""
    centre, normal = faces_of(closed)
    after = faces_of(free)[1]
    distance, place, away = in_cylinder(centre, flange)
    corner = {"arch": make_cad.ARCH, "hood": make_cad.HOOD}[flange]
    beyond = SIDE[flange] * (distance - corner)
    wall = (np.abs(beyond - 0.4) < 1) & (np.einsum("ni,ni->n", normal, SIDE[flange] * away) > 0.98)
    face = (beyond < -radius - 1) & (beyond > -radius - 11)
    sides = ((post_normals(centre), SIDE[flange] * away), (normal, normal), (after, after))
    rows = []
    half = (BINS[flange][1] - BINS[flange][0]) / 2
    for middle in BINS[flange]:
        here = np.abs(place - middle) <= half
        check((here & wall).sum() >= 2 and (here & face).sum() >= 3, f"no elements of the {flange} at {middle}")
        rows.append([angle_between(on_face[here & face].mean(axis=0), on_wall[here & wall].mean(axis=0))
                     for on_face, on_wall in sides])
    return np.array(rows)


def volume(grid):
    """Return the volume of the sheet, mm3."""
    return float(grid.compute_cell_sizes(length=False, area=False)["Volume"].sum())


def area_in_plan(points):
    """Return the area within a closed curve."""
    x, y = np.asarray(points)[:, :2].T
    return abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2


def plan_of(grid):
    """Return the area of the sheet in plan."""
    cells = np.asarray(grid.cells_dict[12])
    corner = np.asarray(grid.points)[cells].reshape(len(cells), 2, 4, 3).mean(axis=1)[..., :2]
    first, second = corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1]
    return float(np.abs(first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]).sum() / 2)


def unbalanced(run, phase):
    """Return the sum of the tool forces along y and z at the end of a phase, over the largest of them."""
    rows = [row for row in run.history.to_dict("records") if row["phase"] == phase]
    forces = np.array([[rows[-1][f"{tool}_f{axis}"] for axis in "yz"] for tool in TOOLS[phase]])
    return np.abs(forces.sum(axis=0)).max() / np.abs(forces).max()


def check_runs(runs):
    """Check warnings, volumes, the trimmed area and the balance of forces."""
    for name, run in runs.items():
        codes = {row["code"] for row in run.job["warnings"]}
        check(codes <= WARNINGS, f"warnings of {name}: {codes - WARNINGS}")
    half = make_cad.rim()
    outline = area_in_plan(np.concatenate([half, [[0, half[-1, 1], 0], [0, half[0, 1], 0]]]))
    opening = area_in_plan(make_cad.opening())
    check_values(
        Value("area of the trimmed sheet in plan, mm2", outline - opening, plan_of(runs["trim"].fields[0]), 1e-3),
        *(Value(f"volume of the sheet in {name}, end over start", 1.0,
                volume(run.fields[-1]) / volume(run.fields[0]), 2e-3) for name, run in runs.items()),
        *(Value(f"balance of the forces at the end of {phase}", 0.0, unbalanced(runs[name], phase), 1e-2, absolute=True)
          for name, phase in (("draw", "draw"), ("flange", "flange"), ("restrike", "strike"))))


def check_angles(runs):
    """Check the flanges under the tools and after their springback, before and after the restrike."""
    flanged, struck = runs["flange"].fields, runs["restrike"].fields
    closed = flanged[int(flanged.step_at("flange"))]
    first = {name: bends(closed, flanged[-1], name, make_cad.BEND) for name in BINS}
    again = bends(struck[int(struck.step_at("strike"))], struck[-1], "arch", make_cad.STRUCK)
    for name, rows in (("arch", first["arch"]), ("hood", first["hood"]), ("arch, struck", again)):
        print(name, "post, closed, free:", *(" ".join(f"{angle:.2f}" for angle in row) for row in rows), sep="\n  ")
    check_values(*(Value(f"{name}: angle under the tools less that of the post, degrees", 0.0,
                         float((rows[:, 1] - rows[:, 0]).mean()), SHORT, absolute=True)
                   for name, rows in (("arch", first["arch"]), ("hood", first["hood"]), ("arch, struck", again))))
    before, after = (float((rows[:, 0] - rows[:, 2]).mean()) for rows in (first["arch"], again))
    print(f"free flange of the wheel arch short of the post by {before:.2f} degrees, struck again {after:.2f} degrees")
    check(abs(after) < 0.6 * before, f"restrike: {before} and {after} degrees")


def main():
    """Write the CAD, run the line and measure the flanges."""
    options = parser_of_runs(__doc__).parse_args()
    shutil.rmtree(options.work, ignore_errors=True)
    for folder in ("fender_line", "materials"):
        shutil.copytree(ROOT / "input_files" / folder, options.work / folder,
                        ignore=shutil.ignore_patterns("*.out", "*.bez", "__pycache__"))
    folder = options.work / "fender_line"
    subprocess.run([sys.executable, FOLDER / "make_cad.py", folder / "cad"], check=True, capture_output=True)
    process = read_process(folder / "line.toml")
    run_process(options.program, process, 1)
    page = write_report(process)
    check(all(operation.name in page.read_text(encoding="utf-8") for operation in process.operations), "the report")
    runs = {operation.name: dd3.open(operation.folder) for operation in process.operations}
    check_runs(runs)
    check_angles(runs)


if __name__ == "__main__":
    main()
