#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: []
"""A ring cut from a drawn cup of AA5754-O and split: how far it opens, by place, mesh, law and criterion.

    split_ring.py --program build/release/dd3imp --work build/split_ring            make the runs that are missing
    split_ring.py --program build/release/dd3imp --work build/split_ring --write    and put them into docs/reports
"""
import sys

import numpy as np
import studies

from dd3.errors import run
from dd3.fields import Fields
from dd3.pages import put_table, table
from dd3.run import read_job

DECK, REPORT, PICTURE = studies.paths("split_ring")
RING = DECK.with_name("ring.dat")
HEIGHT = 5.0  # of the rings, mm
PLACES = (7.0, 9.0, 11.0, 13.0)  # of their lower edges above the lower face of the bottom, mm
MEASURED, SCATTER = 6.00, 0.07  # opening, mm
RUNS = {"Voce, von Mises, 8 x 16": {"divisions": "8 16 1", "material": "voce_von_mises"},
        "Voce, von Mises, 12 x 24": {"divisions": "12 24 1", "material": "voce_von_mises"},
        "Voce, von Mises, 16 x 32": {"divisions": "16 32 1", "material": "voce_von_mises"},
        "Voce, Hill 1948, 12 x 24": {"divisions": "12 24 1", "material": "voce_hill48"},
        "Hockett and Sherby, von Mises, 12 x 24": {"divisions": "12 24 1", "material": "hockett_sherby_von_mises"}}


def bottom(folder):
    """Return the height of the lower face of the cup's bottom, mm."""
    fields = Fields(folder)
    last = fields.count - 1
    start, now = fields.start(last), fields.points(last)
    return now[np.hypot(start[:, 0], start[:, 1]) < 1e-6, 2].min()


def columns(start, now, across, along):
    """Return places and directions, outwards, of the columns of nodes on a plane of symmetry, from below."""
    chosen = np.flatnonzero(np.abs(start[:, across]) < 1e-4)
    middle = np.median(start[chosen, along])
    inner, outer = (sorted(chosen[side], key=lambda node: start[node, 2])
                    for side in (start[chosen, along] < middle, start[chosen, along] > middle))
    return [(0.5*(now[i, :2] + now[o, :2]), now[o, :2] - now[i, :2]) for i, o in zip(inner, outer)]


def end_of_half(place, direction, fixed):
    """Return the end of half of the split ring: the image of the fixed end of the free quarter in its free section."""
    normal, away = direction/np.linalg.norm(direction), fixed - place
    return place + 2*(away @ normal)*normal - away


def opening(folder):
    """Return the distance of the ends of the split ring, mm, the mean over its height.

    The run has a quarter of the ring, free at the plane x = 0. No section of the split ring carries a force or a
    moment, so that the free quarter is the shape of all four: half of the ring is the quarter and its mirror image in
    its free section, and its end is at half of the opening from the plane y = 0.
    """
    fields = Fields(folder)
    start, now = fields.points(0), fields.points(fields.count - 1)
    return 2*float(np.mean([end_of_half(place, direction, fixed)[1] for (place, direction), (fixed, _)
                            in zip(columns(start, now, 0, 1), columns(start, now, 1, 0))]))


def rings(options, name, folder):
    """Return the openings of the rings of a cup by their places, mm."""
    found, base = {}, bottom(folder)
    for place in PLACES:
        low = base + place
        ring = studies.make(options, f"{name}_ring_{place:g}", RING,
                            {"from": folder.resolve(), "low": f"{low:.6f}", "high": f"{low + HEIGHT:.6f}"})
        if ring:
            found[place] = opening(ring)
    return found


def draw(results):
    """Draw the openings over the place of the ring."""
    figure, axes = studies.new_figure(7, 4)
    axes.axhspan(MEASURED - SCATTER, MEASURED + SCATTER, color="0.8", label="measured")
    for name, found in results.items():
        axes.plot([place + HEIGHT/2 for place in found], list(found.values()), "o-", label=name, linewidth=1.2,
                  markersize=4)
    axes.set(xlabel="middle of the ring above the bottom, mm", ylabel="opening, mm")
    axes.legend(frameon=False, fontsize=8)
    figure.savefig(PICTURE, dpi=110)


def main():
    """Make the runs and the table."""
    options = studies.arguments(__doc__)
    results, jobs, rows = {}, [], []
    for name, values in RUNS.items():
        label = name.replace(", ", "_").replace(" ", "_")
        folder = studies.make(options, label, DECK, values)
        if not folder:
            continue
        found = results[name] = rings(options, label, folder)
        jobs.append(read_job(folder))
        rows.append([name, *(f"{found[place]:.2f}" if place in found else "" for place in PLACES),
                     studies.increments(folder)])
    text = table(["law, criterion, mesh", *(f"{place:g} to {place + HEIGHT:g} mm" for place in PLACES),
                          "increments"], rows)
    print(text)
    if options.write:
        put_table(REPORT, "opening", text, jobs)
        draw(results)
    sys.exit(0 if len(results) == len(RUNS) else 1)


if __name__ == "__main__":
    run(main)
