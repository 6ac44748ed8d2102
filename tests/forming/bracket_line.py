#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "forming_bracket_line", "labels": ["slow"], "timeout": 1200, "cost": 300}
"""The line of the bracket: drawn, trimmed and pierced, tipped and flanged by a steel on the ram and by a cam.

    bracket_line.py --program build/release/dd3imp --work build/bracket_line

The process runs to its end and writes its report; under the tools the tabs are bent by the angles of the post, 110 and
100 degrees, and both spring back by a few degrees. The flange's tools, corrected once for that, leave less than a
quarter of the deviation of the tabs.
"""
import csv
import shutil
import sys
from pathlib import Path

import numpy as np

import dd3
from dd3.compensate import compensate
from dd3.errors import check
from dd3.process import read_process, run_process, write_report
from dd3.programs import parser_of_runs

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from bench import Value, check_values  # noqa: E402

ANGLES = {"steel": 110.0, "cam": 100.0}  # of the post, degrees


def slope(points):
    """Return the angle of the line of least squares through points in x and z, from x to -z, degrees."""
    _, _, axes = np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    along = axes[0] * np.sign(axes[0] @ (points[-1] - points[0]))
    return np.degrees(np.arctan2(-along[1], along[0]))


def bends(grid):
    """Return the angles by which the tabs are bent from the floor, by the lower nodes near the plane of symmetry."""
    points = np.asarray(grid.points)
    initial = points - np.asarray(grid["displacement"])
    lower = initial[:, 2] < initial[:, 2].min() + 1e-6
    order = np.argsort(initial[:, 0])

    def line(chosen):
        return points[order][(lower & chosen)[order]][:, [0, 2]]
    x, y = initial[:, 0], initial[:, 1]
    floor = slope(line((np.abs(x) < 18) & (y > 7) & (y < 10)))
    tab = {"steel": slope(line((x < -52.5) & (y < 5))) - floor, "cam": slope(line((x > 52.5) & (y < 5))) - floor}
    return {"steel": -tab["steel"] % 360, "cam": tab["cam"] % 360}


def main():
    """Run the line and measure its bends."""
    options = parser_of_runs(__doc__).parse_args()
    shutil.rmtree(options.work, ignore_errors=True)
    for folder in ("bracket_line", "materials"):
        shutil.copytree(ROOT / "input_files" / folder, options.work / folder, ignore=shutil.ignore_patterns("*.out"))
    process = read_process(options.work / "bracket_line" / "line.toml")
    run_process(options.program, process, 1)
    page = write_report(process)
    check(all(operation.name in page.read_text(encoding="utf-8") for operation in process.operations), "the report")
    fields = dd3.open(process.operations[-1].folder).fields
    formed, free = bends(fields[int(fields.step_at("flange"))]), bends(fields[-1])
    check_values(*(Value(f"bend by the {name}, degrees", angle, formed[name], 2.0, absolute=True)
                   for name, angle in ANGLES.items()))
    for name in ANGLES:
        back = formed[name] - free[name]
        print(f"springback of the bend by the {name}: {back:.2f} degrees")
        check(0 < back < 6, f"springback of the bend by the {name}: {back} degrees")
    compensate(options.program, process, "tools@flange", 1, 0.02, 1.0, ["y"], None, 1, hold=True)
    with (process.path.with_suffix(".compensate") / "deviations.csv").open(encoding="utf-8") as file:
        before, after = (float(row["flange_largest"]) for row in csv.DictReader(file))
    print(f"largest deviation of the tabs: {before:.3f} mm, {after:.3f} mm with corrected tools")
    check(after < before / 4, f"deviation of the tabs: {before} and {after} mm")


if __name__ == "__main__":
    main()
