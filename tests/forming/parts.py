#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "forming_parts", "timeout": 400}
"""Run the parts of input_files with coarse meshes for a short travel; compare their tools with their shape files.

Checked besides the end of each run: the holder force of the clamp, the centre of symmetry of the rail, the ears and the
height of the round cup's script on a profile that is known, and the opening of the split ring's on an arc.
"""
import math
import pathlib
import subprocess
import sys

import numpy as np

from dd3.errors import run
from dd3.fields import Fields
from dd3.programs import parser_of_runs
from dd3.tools.surface import points_on, read_patches

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from bench import Bench, Value, check_values  # noqa: E402

# Deck, parameters, force of the holder (N).
RUNS = {"square_cup/square_cup.dat": ({"divisions": "6 6 1", "levels": 0, "depth": 1}, 4900),
        "square_cup/aluminium.dat": ({"divisions": "6 6 1", "levels": 0, "depth": 1}, 4900),
        "round_cup/round_cup.dat": ({"divisions": "3 5 1", "levels": 0, "pressed": 1, "held": 0.5}, 5550),
        "round_cup_aa6016/round_cup_aa6016.dat": ({"divisions": "3 5 1", "levels": 0, "pressed": 1, "held": 0.5}, 10000),
        "split_ring/split_ring.dat": ({"divisions": "3 5 1", "points": 3, "pressed": 1, "held": 0.5}, 1500),
        "rail/rail.dat": ({"divisions": "10 6 1", "levels": 0, "points": 3, "depth": 1}, 20000)}
# Largest distance between a tool and that of its file, mm: far below the contact layer of 0.02 mm, whose pressure it
# changes by a thousandth, and far above the last of the twelve digits of a file, which depend on the machine.
SAME_TOOL = 1e-6


def check_runs(bench):
    """Run the decks."""
    for name, (settings, force) in RUNS.items():
        found = bench.run(pathlib.Path(name).stem, ROOT / "input_files" / name, settings)
        check_values(Value(f"{name}: force of the holder, N", force, found.last("holder_fz", "clamp"), 0.02))
        assert found.last("travel") >= 1.0, name


def check_rail(options):
    """Check that the rail is the same turned by 180 degrees, before it springs back."""
    fields = Fields(options.work / "rail.out")
    step = int(np.flatnonzero(np.abs(fields.travel - 1) < 1e-7)[0])
    points = fields.points(step).reshape(11, 7, 2, 3)
    turned = points[::-1, ::-1] * (-1, -1, 1)
    assert np.abs(points - turned).max() < 0.02, np.abs(points - turned).max()


def places(path):
    """Return places on the patches of a file at equal parameters, (patches, v, u, 3), whatever their degrees."""
    t = np.linspace(0, 1, 5)
    return np.array([points_on(points, weights, t, t) for points, weights in read_patches(path)])


def faces(path):
    """Return the names of the faces of a file, without its header."""
    lines = path.read_text(encoding="utf-8").splitlines()[1:]
    return [line for line in lines if line.startswith("#")]


def check_tools(work):
    """Check that the tools are those of the shape files."""
    shapes = sorted((ROOT / "input_files").glob("*/*.shape"))
    assert len(shapes) == 29, shapes
    for shape in shapes:
        target = work / f"{shape.stem}.bez"
        kept = shape.with_suffix(".bez")
        _, _, options = kept.read_text(encoding="utf-8").splitlines()[0].partition(f" {kept.name}")  # of its command
        subprocess.run([sys.executable, "-m", "dd3", "tool", shape, target, *options.split()], check=True,
                       capture_output=True)
        new, old = places(target), places(kept)
        assert new.shape == old.shape and faces(target) == faces(kept), shape
        assert np.abs(new - old).max() < SAME_TOOL, (shape, np.abs(new - old).max())


def check_ears():
    """Check the number of ears on cosines."""
    import round_cup
    angles = np.linspace(0, 90, 13)
    for count, found in ((4, [0, 90]), (6, [0, 60]), (8, [0, 45, 90])):
        heights = 40 + np.cos(np.radians(count * angles))
        assert round_cup.ears(angles, heights) == found and round_cup.number(found) == count, count
    assert math.isclose(round_cup.WALL, (97.46 / 2 + 101.48 / 2) / 2)


def check_opening():
    """Check the end of half a split ring: a quarter whose arc has the radius 20 mm and turns by 85 degrees."""
    import split_ring
    radius, angle = 20.0, math.radians(85)
    direction = np.array([math.cos(angle), math.sin(angle)])
    fixed, centre = np.array([17.0, 0.0]), np.array([17.0 - radius, 0.0])
    end = split_ring.end_of_half(centre + radius*direction, direction, fixed)
    assert np.allclose(end, centre + radius*np.array([math.cos(2*angle), math.sin(2*angle)])), end


def main():
    options = parser_of_runs(__doc__).parse_args()
    check_tools(options.work)
    check_ears()
    check_opening()
    check_runs(Bench(options.program, options.work))
    check_rail(options)
    print("the parts run")


if __name__ == "__main__":
    run(main)
