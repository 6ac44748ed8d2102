#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: []
"""The cylindrical cup of AA6016-T4 of the ESAFORM benchmark 2021: height by angle, beside measured and published ones.

    round_cup_aa6016.py --program build/release/dd3imp --work build/aa6016            make the runs that are missing
    round_cup_aa6016.py --program build/release/dd3imp --work build/aa6016 --write    and put them into docs/reports
"""
import sys

import numpy as np
import studies
from round_cup import ANGLES, Cup, row

from dd3.errors import run
from dd3.pages import put_table, table
from dd3.run import read_job
from dd3.tables import read_table

DECK, REPORT, PICTURE = studies.paths("round_cup_aa6016")
BLANK = 53.75  # radius of the blank, mm
RUNS = {"8 x 16": {"divisions": "8 16 1"}, "12 x 24": {"divisions": "12 24 1"}, "16 x 32": {"divisions": "16 32 1"},
        "12 x 24, holder 10 kN": {"divisions": "12 24 1", "force": "2500"},
        "8 x 16, friction 0.07": {"divisions": "8 16 1", "friction": "0.07"},
        "12 x 24, die opening 63.6 mm": {"divisions": "12 24 1", "die": "die_wide.bez"}}
RING, PUNCH, STEEL, POISSON = 31.2, 30.0, 2.1e5, 0.3  # radii of the die opening and of the punch, mm; MPa


def ring(ratio):
    """Return the compliance of a ring under inner pressure, mm/MPa; `ratio` is its outer over its inner radius."""
    return RING / STEEL * ((ratio**2 + 1) / (ratio**2 - 1) + POISSON)


# Compliances of the die, mm/MPa; the solid punch has PUNCH (1 - POISSON) / STEEL.
COMPLIANCE = {"rigid": 0.0, "die of 2 radii": ring(2), "die of 1.25 radii": ring(1.25), "5e-3 mm/MPa": 5e-3}
ELASTIC_RUNS = [*(("8 x 16", die) for die in COMPLIANCE), ("12 x 24", "die of 2 radii")]
# Sets of the teams: material, friction. DIES: a rigid die and one with a compliance.
TEAMS = {"Yld2004-18p, POSTECH": ("aa6016_t4_yld2004", 0.1), "Yld2004-18p, NTNU": ("aa6016_t4_yld2004_ntnu", 0.09),
         "Yld2004-18p, NTNU, crystals": ("aa6016_t4_yld2004_ntnu_cp", 0.09),
         "Yld2000-2d, Siegen": ("aa6016_t4_yld2000", 0.075),
         "Yld2000-2d, Ghent, crystals": ("aa6016_t4_yld2000_ugent", 0.07)}
DIES = list(COMPLIANCE)[:2]
# Heights, mm, at ANGLES, of the repository stefanSCS/PolyN, CM_Data/AA6016_CupProfiles; means of four quadrants.
PUBLISHED = {"measured": (34.88, 34.37, 33.89, 33.47, 33.78, 34.43, 34.82),
             "POSTECH, same criterion": (34.01, 34.18, 33.96, 33.77, 33.91, 34.18, 34.08),
             "Soare, same criterion": (34.45, 33.99, 32.76, 32.04, 32.66, 34.10, 34.79)}
# Those that the teams computed with their sets; that of Siegen by LS-DYNA.
COMPUTED = {"Yld2004-18p, POSTECH": PUBLISHED["POSTECH, same criterion"],
            "Yld2004-18p, NTNU": (34.61, 34.32, 34.46, 34.47, 34.51, 34.31, 34.70),
            "Yld2004-18p, NTNU, crystals": (34.51, 34.09, 33.87, 33.77, 34.00, 34.26, 34.44),
            "Yld2000-2d, Siegen": (33.10, 32.47, 32.31, 32.43, 32.26, 32.55, 33.19),
            "Yld2000-2d, Ghent, crystals": (32.77, 31.23, 29.52, 29.66, 29.95, 30.82, 31.82)}


def draw(cups):
    """Draw height over angle."""
    figure, axes = studies.new_figure(9, 4)
    for name, heights in PUBLISHED.items():
        axes.plot(ANGLES, heights, "ko-" if name == "measured" else "o--", label=name, linewidth=1, markersize=4)
    for name, cup in cups.items():
        if not name.startswith("8 x 16"):
            axes.plot(cup.angles, cup.heights, label=name, linewidth=1.4)
    axes.set(xlabel="angle from rolling, degrees", ylabel="height, mm", xticks=ANGLES)
    axes.legend(frameon=False, fontsize=8, loc="center left", bbox_to_anchor=(1, 0.5))
    figure.savefig(PICTURE, dpi=110, bbox_inches="tight")


def main():
    """Make the runs and the table."""
    options = studies.arguments(__doc__)
    cups, jobs, rows = {}, [], [row(name, ANGLES, np.array(heights), [""]*3) for name, heights in PUBLISHED.items()]
    for name, values in RUNS.items():
        folder = studies.make(options, name.replace(", ", "_").replace(" ", "_"), DECK,
                              {**values, "levels": 0})
        if folder:
            cup = cups[name] = Cup(folder, BLANK)
            jobs.append(read_job(folder))
            rows.append(row(name, cup.angles, cup.heights,
                            [*(f"{value:.3f}" for value in cup.thickness), studies.increments(folder)]))
    heading = ["", *(f"{angle}°" for angle in ANGLES), "mean", "range", "ears", "at, degrees", "thinnest", "thickest",
               "increments"]
    text = table(heading, rows)
    print(text)
    if options.write and len(cups) == len(RUNS):
        put_table(REPORT, "heights", text, jobs)
        draw(cups)
    complete = all([elastic_tools(options, heading), teams(options, heading)]) and len(cups) == len(RUNS)
    sys.exit(0 if complete else 1)


def elastic_tools(options, heading):
    """Make the runs with elastic tools and their table; return whether all are there."""
    jobs, rows = [], []
    for mesh, die in ELASTIC_RUNS:
        name, compliance = f"{mesh}, {die}", COMPLIANCE[die]
        punch = PUNCH * (1 - POISSON) / STEEL if compliance else 0.0
        folder = studies.make(options, "elastic_" + name.replace(", ", "_").replace(" ", "_").replace("/", "_"), DECK,
                              {"divisions": f"{mesh.replace('x ', '')} 1", "levels": 0,
                               "die_compliance": f"{compliance:.3g}", "punch_compliance": f"{punch:.3g}"})
        if not folder:
            continue
        cup = Cup(folder, BLANK)
        jobs.append(read_job(folder))
        rows.append([*row(name, cup.angles, cup.heights, [f"{value:.3f}" for value in cup.thickness]),
                     *(largest(folder, tool) for tool in ("die", "punch")), studies.increments(folder)])
    complete = len(rows) == len(ELASTIC_RUNS)
    text = table([*heading[:-1], "die deflects by", "punch deflects by", *heading[-1:]], rows)
    print(text)
    if options.write and complete:
        put_table(REPORT, "elastic", text, jobs)
    return complete


def teams(options, heading):
    """Make the runs with the sets of the teams and their table; return whether all are there."""
    jobs, rows = [], [row("measured", ANGLES, np.array(PUBLISHED["measured"]), ["", ""])]
    for team, (material, friction) in TEAMS.items():
        rows.append(row(f"{team}: the team", ANGLES, np.array(COMPUTED[team]), ["", ""]))
        cups = []
        for die in DIES:
            punch = PUNCH * (1 - POISSON) / STEEL if COMPLIANCE[die] else 0.0
            folder = studies.make(options, f"{material}_{die.replace(' ', '_')}", DECK, {
                "divisions": "8 16 1", "levels": 0, "material": material, "friction": f"{friction:g}",
                "die_compliance": f"{COMPLIANCE[die]:.3g}", "punch_compliance": f"{punch:.3g}"})
            if folder:
                cups.append(Cup(folder, BLANK))
                jobs.append(read_job(folder))
        if len(cups) == len(DIES):
            rigid, elastic = cups
            rows.append(row(f"{team}: here", elastic.angles, elastic.heights,
                            [f"{np.ptp(rigid.heights):.2f}", f"{punch_force(folder):.1f}"]))
    complete = len(jobs) == len(TEAMS) * len(DIES)
    text = table([*heading[:-3], "range, rigid tools", "punch, kN"], rows)
    print(text)
    if options.write and complete:
        put_table(REPORT, "teams", text, jobs)
    return complete


def punch_force(folder):
    """Return the largest force of the punch of a run, of the whole cup, kN."""
    return 4e-3 * max(abs(float(row["punch_fz"])) for row in read_table(folder / "history.csv"))


def largest(folder, tool):
    """Return the largest deflection of a tool in a run as text, mm; empty if it is rigid."""
    history = read_table(folder / "history.csv")
    column = f"{tool}_deflection"
    return f"{max(float(row[column]) for row in history):.3f}" if column in history[0] else ""


if __name__ == "__main__":
    run(main)
