#!/usr/bin/env python3
"""Draw bending of NUMISHEET'93: angles and curl of the wall after springback, by mesh, holder force and hardening.

    draw_bending.py --program build/release/dd3imp --work build/draw_bending            make the runs that are missing
    draw_bending.py --program build/release/dd3imp --work build/draw_bending --write    and put them into docs/reports
"""
import math
import sys

import numpy as np
import studies
from fields import Fields
from scripts import put_table, run

DECK, REPORT, PICTURE = studies.paths("draw_bending")
DEPTH, MARGIN, BOTTOM = 70.0, 10.0, 15.0  # stroke, ends of the wall that do not count, half length of the bottom, mm
FLANGE = 36.0  # x beyond which the strip is flat at the end of the draw, mm
HOLDERS = {"2.45 kN": -35, "19.6 kN": -280}  # N for 1 mm of the half strip
MESHES = {"isotropic": (88, 175, 350, 700), "kinematic": (350,)}  # elements along the half strip
SWIFT = (565.32, 0.007117, 0.2589)  # MPa, -, -
BACK_STRESS = (30.0, 50.0)  # CX, Xsat (MPa) of Lemaitre and Chaboche
STRAINS = (0, .002, .005, .01, .02, .03, .05, .075, .1, .15, .2, .3, .5, .8, 1.2)


def kinematic():
    """Return the hardening with a back-stress whose tension curve is that of the law without."""
    k, e0, n = SWIFT
    rate, limit = BACK_STRESS
    pairs = [f"{p:g}:{k*(e0 + p)**n - limit*(1 - math.exp(-rate*p)):.3f}" for p in STRAINS]
    return f"table {' '.join(pairs)}\n  backstress = lemaitre_chaboche CX={rate:g} Xsat={limit:g}"


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


def main():
    """Make the runs and the table."""
    options = studies.arguments(__doc__)
    rows, lines, wanted = [], {}, 0
    for holder, force in HOLDERS.items():
        for law, hardening in (("isotropic", None), ("kinematic", kinematic())):
            for mesh in MESHES[law]:
                wanted += 1
                deck = DECK
                if hardening:
                    deck = options.work / "kinematic.dat"
                    deck.write_text(DECK.read_text(encoding="utf-8").replace("${hardening}", hardening)
                                    .replace('patches = "', f'patches = "{DECK.parent}/'), encoding="utf-8")
                folder = studies.make(options, f"{holder}_{law}_{mesh}".replace(" ", "_"), deck,
                                      {"divisions": f"{mesh} 1 1", "holder": force})
                if not folder:
                    continue
                theta1, theta2, rho, line = shape(folder)
                rows.append([holder, law, f"{175/mesh:.2f}", f"{theta1:.1f}", f"{theta2:.1f}", f"{rho:.0f}",
                             *studies.effort(folder)])
                lines[f"{holder}, {law}, {175/mesh:.2f} mm"] = line
    text = studies.table(["holder", "hardening", "element, mm", "theta1, degrees", "theta2, degrees", "rho, mm",
                          "increments", "iterations", "seconds"], rows)
    print(text)
    if options.write:
        put_table(REPORT, "shape", text)
        draw(lines)
    sys.exit(0 if len(rows) == wanted else 1)


if __name__ == "__main__":
    run(main)
