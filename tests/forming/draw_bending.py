#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: []
"""Draw bending of NUMISHEET'93: angles and curl of the wall after springback, by mesh, holder force and hardening.

    draw_bending.py --program build/release/dd3imp --work build/draw_bending            make the runs that are missing
    draw_bending.py --program build/release/dd3imp --work build/draw_bending --write    and put them into docs/reports
"""
import math
import re
import sys

import numpy as np
import studies

from dd3.errors import run
from dd3.fields import Fields
from dd3.pages import put_table, table
from dd3.run import read_job

DECK, REPORT, PICTURE = studies.paths("draw_bending")
DEPTH, MARGIN, BOTTOM = 70.0, 10.0, 15.0  # stroke, ends of the wall that do not count, half length of the bottom, mm
FLANGE = 36.0  # x beyond which the strip is flat at the end of the draw, mm
HOLDERS = {"2.45 kN": -35, "19.6 kN": -280}  # N for 1 mm of the half strip
# Elements along the half strip. With the smaller force the wall of 88 elements snaps, and the run stops.
MESHES = {"2.45 kN": {"isotropic": (175, 350, 700), "kinematic": (350,)},
          "19.6 kN": {"isotropic": (88, 175, 350, 700), "kinematic": (350,)}}
SHEETS = {"SPCC": "spcc_kinematic", "SPFC": "spfc_kinematic"}  # of the library
SHEET_MESHES = {"2.45 kN": (175,), "19.6 kN": (350,)}  # elements of their runs
SWIFT = (565.32, 0.007117, 0.2589)  # MPa, -, -
BACK_STRESS = (30.0, 50.0)  # CX, Xsat (MPa) of Lemaitre and Chaboche, assumed
STRAINS = (0, .002, .005, .01, .02, .03, .05, .075, .1, .15, .2, .3, .5, .8, 1.2)
FINE = (0, .0005, .001, .0015, .002, .003, .004, .006, .008, .012, .018, *STRAINS[5:])


def table_law(strains, law):
    """Return the line of a hardening table of a law."""
    return f"  hardening = table {' '.join(f'{p:g}:{law(p):.3f}' for p in strains)}\n"


def saturating(limit, rate):
    """Return the law that saturates with a rate."""
    return lambda p: limit*(1 - math.exp(-rate*p))


def kinematic():
    """Return the mild steel with a back-stress whose tension curve is that of the law without."""
    k, e0, n = SWIFT
    rate, limit = BACK_STRESS
    part = saturating(limit, rate)
    head = DECK.read_text(encoding="utf-8").split("*MATERIAL mild_steel")[1].split("  hardening")[0].split("\n", 1)[1]
    return (head + table_law(STRAINS, lambda p: k*(e0 + p)**n - part(p))
            + f"  backstress = lemaitre_chaboche CX={rate:g} Xsat={limit:g}\n")


def library(name):
    """Return the lines of a material of the library, and those of the same tension curve without a back-stress."""
    text = (DECK.parents[1] / "materials" / f"{name}.dat").read_text(encoding="utf-8").split("*MATERIAL")[1]
    lines = text.split("\n", 1)[1]
    start, limit, rate, back_rate, back_limit = map(float, re.findall(r"=([\d.]+)", lines.split("voce")[1]))
    voce, back = saturating(limit, rate), saturating(back_limit, back_rate)
    return lines, lines.split("  hardening")[0] + table_law(FINE, lambda p: start + voce(p) + back(p))


def laws():
    """Return the lines of the material by its name in the tables; None: those of the deck."""
    found = {"isotropic": None, "kinematic": kinematic()}
    for sheet, name in SHEETS.items():
        with_it, without = library(name)
        found |= {f"{sheet}, isotropic": without, f"{sheet}, kinematic": with_it}
    return found


def with_law(folder, name, lines):
    """Return the deck with another material."""
    if not lines:
        return DECK
    text = DECK.read_text(encoding="utf-8").replace('patches = "', f'patches = "{DECK.parent}/')
    head, rest = text.split("*MATERIAL mild_steel")
    deck = folder / f"{name.replace(', ', '_')}.dat"
    deck.write_text(f"{head}*MATERIAL mild_steel\n{lines}\n*BLANK{rest.split('*BLANK')[1]}", encoding="utf-8")
    return deck


def middle_line(fields, step):
    """Return x and z of the middle line of the strip."""
    return fields.points(step).reshape(-1, 2, 2, 3).mean(axis=(1, 2))[:, [0, 2]]


def circle(points):
    """Return the centre and the radius of the circle of least squares."""
    system = np.column_stack([2*points, np.ones(len(points))])
    a, b, c = np.linalg.lstsq(system, (points**2).sum(axis=1), rcond=None)[0]
    return np.array([a, b]), math.sqrt(c + a*a + b*b)


def slope(direction):
    """Return the angle of a direction to x, degrees."""
    return math.degrees(math.atan2(direction[1], direction[0]))


def straight(points):
    """Return the direction of the line of least squares, towards larger x."""
    direction = np.linalg.svd(points - points.mean(axis=0))[2][0]
    return direction*np.sign(direction[0])


def shape(folder):
    """Return theta1, theta2 (degrees), rho (mm) and the line after springback.

    Tangents of the circle through the wall at the ends of the wall: theta1 is the angle of the lower one to the bottom,
    theta2 that of the upper one to the flange. rho is negative if the wall curls inwards.
    """
    fields = Fields(folder)
    drawn = int(np.flatnonzero(np.abs(fields.travel - DEPTH) < 1e-7)[0])
    before, after = middle_line(fields, drawn), middle_line(fields, fields.count - 1)
    wall = after[(before[:, 1] > MARGIN - DEPTH) & (before[:, 1] < -MARGIN)]
    bottom, flange = after[middle_line(fields, 0)[:, 0] < BOTTOM], after[before[:, 0] > FLANGE]
    centre, radius = circle(wall)
    tangents = []
    for end in (wall[0], wall[-1]):
        x, z = end - centre
        tangents.append(np.array([-z, x])*np.sign(x))
    theta1 = 180 - slope(tangents[0]) + slope(straight(bottom))
    theta2 = 180 - slope(tangents[1]) + slope(straight(flange))
    return theta1, theta2, radius*np.sign(centre[0] - wall[:, 0].mean()), after - after[0]


def draw(lines):
    """Draw the strips after springback."""
    figure, axes = studies.new_figure(6, 5)
    for name, line in lines.items():
        axes.plot(line[:, 0], line[:, 1], label=name, linewidth=1.2)
    axes.set(xlabel="x, mm", ylabel="z, mm", aspect="equal")
    axes.legend(frameon=False, fontsize=8)
    figure.savefig(PICTURE, dpi=110)


def runs(options):
    """Make the runs; yield holder, law, elements along the strip and folder of each, None if it is not there."""
    for holder, force in HOLDERS.items():
        for law, lines in laws().items():
            for mesh in MESHES[holder].get(law, SHEET_MESHES[holder]):
                name = f"{holder}_{law}_{mesh}".replace(", ", "_").replace(" ", "_")
                yield holder, law, mesh, studies.make(options, name, with_law(options.work, law, lines),
                                                      {"divisions": f"{mesh} 1 1", "holder": force})


def main():
    """Make the runs and the tables, that of the sheet of the benchmark and that of the sheets of SHEETS."""
    options = studies.arguments(__doc__)
    rows, jobs, lines, complete = {"shape": [], "sheets": []}, {"shape": [], "sheets": []}, {}, True
    for holder, law, mesh, folder in runs(options):
        complete = complete and bool(folder)
        if not folder:
            continue
        theta1, theta2, rho, line = shape(folder)
        name = "sheets" if "," in law else "shape"
        jobs[name].append(read_job(folder))
        rows[name].append(
            [holder, law, f"{175/mesh:.2f}", f"{theta1:.1f}", f"{theta2:.1f}", f"{rho:.0f}",
             studies.increments(folder)])
        if "," not in law:
            lines[f"{holder}, {law}, {175/mesh:.2f} mm"] = line
    head = ["holder", "hardening", "element, mm", "theta1, degrees", "theta2, degrees", "rho, mm", "increments"]
    for name, found in rows.items():
        print(table(head, found))
        if options.write and found:
            put_table(REPORT, name, table(head, found), jobs[name])
    if options.write and lines:
        draw(lines)
    sys.exit(0 if complete else 1)


if __name__ == "__main__":
    run(main)
