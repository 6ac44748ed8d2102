#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts with holes, notches and lanced forms, and the same parts made without any.

    closed_set.py FOLDER          compare their closed sides and their tools; print their table
"""
import contextlib
import io
import sys
import time
from pathlib import Path

import gmsh
import numpy as np
import part_set
from test_tool_surfaces import points_of, read

from dd3 import pages, tool
from dd3.gmsh_session import session
from dd3.part.closed import closed_part
from dd3.part.reading import Request, read_part
from dd3.programs import made_folder
from dd3.tools.cad_file import silence
from dd3.tools.patch_distance import Distance

occ = gmsh.model.occ


def bend():
    """Make a tray with a hole over the edge between a wall and the lower radius."""
    part_set.holes(part_set.pocket((40, 30), 20, 1, 8, 5), [(39.5, 0, 6)], (1, 0, 0), length=8)


def whole_bend():
    """Make a tray with a hole that cuts a lower radius into two."""
    part_set.holes(part_set.pocket((40, 30), 20, 1, 8, 5), [(38, 0, 3)], (1, 0, -1), radius=4.5, length=14)


def rows_of_holes():
    """Make a tray with holes over the edge between floor and radius, side by side."""
    part_set.holes(part_set.pocket((40, 30), 20, 1, 8, 5), [(x, -25, 0) for x in (-20, -10, 0, 10, 20)], radius=3)


def collar():
    """Make a round pan with a collar around a hole in its floor, downwards."""
    part_set.turned_solid([(10, -8), (10, 0), (40, 0), (43, 25), (60, 25)], 1, 3)


def round_lid(*path):
    """Return a maker of a round lid of 0.6 mm without notches."""
    return lambda: part_set.turned_solid(path, 0.6, 1.5)


def surface_of(make):
    """Return a maker of the upper side alone of a solid, which has 1 mm and is open upwards."""
    def made():
        make()
        occ.synchronize()
        inside = [tag for _, tag in occ.getEntities(2) if is_inside(tag)]
        occ.remove(occ.getEntities(3))
        occ.remove([(2, tag) for _, tag in occ.getEntities(2) if tag not in inside], recursive=True)
    made.__doc__ = f"{make.__doc__.rstrip('.')}, its upper side alone."
    return made


def is_inside(tag):
    """Tell whether a face of the tray of 80 x 60 x 20 is of its inside."""
    low, high = np.reshape(gmsh.model.getBoundingBox(2, tag), (2, 3))
    return 0.9 < low[2] < 19.5 and (np.abs([low[:2], high[:2]]).max(axis=0) < [39.1, 29.1]).all()


# Parts of which tools are compared.
DRAWN = ("angle", "u_section", "cup", "tray", "slotted", "louvred", "stepped", "bend", "whole_bend", "rows",
         "notched_lid", "notched_flange", "folded_cover")
# Parts with openings, their number on the upper side, and the same parts without any.
PAIRS = {
    "angle": (part_set.angle, 4, lambda: part_set.strip([(0, 30), (0, 0), (40, 0)], 2, 3, 60)),
    "u_section": (part_set.u_section, 2, lambda: part_set.strip([(-20, 25), (-20, 0), (20, 0), (20, 25)], 1, 2, 100)),
    "cup": (part_set.cup_with_holes, 5, lambda: part_set.turned_solid([(0, 0), (30, 0), (30, 30)], 1, 5)),
    "tray": (part_set.wall_hole_tray, 1, part_set.tray),
    "slotted": (part_set.slotted_cover, 165, lambda: part_set.pocket((110, 80), 12, 0.8, 10, 4)),
    "louvred": (part_set.louvred_cover, 3, lambda: part_set.pocket((60, 45), 15, 1, 8, 4)),
    "saddle": (part_set.saddle_panel, 1, lambda: part_set.saddle_panel(notch=False)),
    "stepped": (part_set.stepped_pan, 1,
                lambda: part_set.turned_solid([(0, 0), (20, 0), (22, 12), (40, 12), (43, 30)], 0.5, 3)),
    "collar": (collar, 1, lambda: part_set.turned_solid([(0, 0), (40, 0), (43, 25), (60, 25)], 1, 3)),
    "bend": (bend, 1, part_set.tray),
    "whole_bend": (whole_bend, 1, part_set.tray),
    "rows": (rows_of_holes, 5, part_set.tray),
    "notched_lid": (part_set.notched_lid, 2, round_lid((0, 0), (30, 0), (30, 8))),
    "notched_flange": (part_set.notched_flange, 1, round_lid((0, 0), (30, 0), (32, 8), (45, 8))),
    "folded_cover": (part_set.folded_cover, 1, lambda: part_set.folded_cover(notch=False)),
    "surface": (surface_of(part_set.wall_hole_tray), 1, surface_of(part_set.tray)),
    "bend_of_surface": (surface_of(bend), 1, surface_of(part_set.tray)),
}


def write(folder):
    """Write the parts into a folder."""
    with session(), silence():
        for name, (make, _, plain) in PAIRS.items():
            for ending, maker in (("", make), ("_plain", plain)):
                maker()
                occ.synchronize()
                gmsh.write(str(folder / f"{name}{ending}.step"))
                gmsh.clear()


def upper(folder, name):
    """Return the reading of a part, its closed part, and area and number of rims of its upper side."""
    with session() as model:
        reading = read_part(model, Request(folder / f"{name}.step", toward=(0, 0, 1)))
        faces = reading.direction.upper
        closed = closed_part(model, reading, faces)
        if closed:
            closed.load(model)
            faces = closed.taken
        owners = [{tag for tag in model.model.getAdjacencies(1, edge)[0]} & set(faces)
                  for _, edge in model.model.getEntities(1)]
        rims = sum(len(owner) == 1 for owner in owners)
        return reading, closed, sum(model.model.occ.getMass(2, tag) for tag in faces), rims


def largest_distance(folder, other, name):
    """Return the largest distance of points of one tool from the same tool of another folder, mm."""
    points = points_of(read(folder / f"{name}.bez"), 3)[0].reshape(-1, 3)
    return np.linalg.norm(Distance(read(other / f"{name}.bez"), 4.0).nearest(points)[0] - points, axis=1).max()


def seconds_of(folder, name):
    """Make tools of a part; return the processor time."""
    start = time.process_time()
    with contextlib.redirect_stdout(io.StringIO()):
        tool.convert([str(folder / f"{name}.step"), str(folder / name)])
    return time.process_time() - start


def table(folder):
    """Print a row for each part: openings, relative difference of the areas, largest distance of the tools, mm, and
    processor times, with and without openings, s."""
    heading = ["part", "what it is", "openings", "difference of the area", "of the tools, µm", "s", "without, s"]
    rows = []
    write(folder)
    seconds_of(folder, "tray_plain")  # with the start of the libraries
    for name, (make, _, _) in PAIRS.items():
        _, closed, area, _ = upper(folder, name)
        plain = upper(folder, f"{name}_plain")[2]
        words = make.__doc__.removeprefix("Make ").split("\n")[0].rstrip(".")
        row = [f"`{name}`", words, str(len(closed.openings)), f"{abs(area / plain - 1):.0e}"]
        if name in DRAWN:
            times = [seconds_of(folder, one) for one in (name, f"{name}_plain")]
            away = max(largest_distance(folder / a, folder / b, tool) for tool in ("punch", "die")
                       for a, b in ((name, f"{name}_plain"), (f"{name}_plain", name)))
            row += [f"{1e3 * away:.0e}", *(f"{value:.1f}" for value in times)]
        rows.append(row + [""] * (len(heading) - len(row)))
    print(pages.table(heading, rows))


if __name__ == "__main__":
    table(made_folder(Path(sys.argv[1])))
