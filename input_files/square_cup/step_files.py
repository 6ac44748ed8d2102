#!/usr/bin/env python3
"""Write punch.step, die.step and holder.step, the tools of the square cup as CAD solids.

    step_files.py build/cup

Gmsh makes them of boxes with fillets, for the whole cup; utils/tool.py converts them, see docs/tools.md.
"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "utils"))
from scripts import need, run  # noqa: E402

need("gmsh", "numpy", "scipy")
import gmsh  # noqa: E402
from tools.cad import session, silence  # noqa: E402

THICKNESS = 0.78  # of the blank, whose lower face is at z = 0, mm
FACE = 220.0  # side of the die and the holder


def edges(chosen):
    """Return the edges whose box (x, y, z of its two corners) is chosen."""
    gmsh.model.occ.synchronize()
    return [tag for _, tag in gmsh.model.getEntities(1) if chosen(gmsh.model.getBoundingBox(1, tag))]


def block(size, bottom, height):
    """Return a box around the z axis."""
    return gmsh.model.occ.addBox(-size / 2, -size / 2, bottom, size, size, height)


def plate(bottom, height):
    """Return a plate with the opening of the die."""
    whole, opening = block(FACE, bottom, height), block(74, bottom - 1, height + 2)
    gmsh.model.occ.fillet([opening], edges(lambda ends: ends[5] - ends[2] > height + 1), [12])
    gmsh.model.occ.cut([(3, whole)], [(3, opening)])
    return whole


def save(path):
    """Write what has been made to a STEP file."""
    gmsh.model.occ.synchronize()
    gmsh.write(str(path))
    gmsh.clear()


def main():
    """Write the files."""
    if len(sys.argv) != 2:
        sys.exit("error: expected the folder of the files")
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    with session(), silence():
        punch = block(70, THICKNESS, 90)
        gmsh.model.occ.fillet([punch], edges(lambda ends: ends[5] - ends[2] > 80), [10])
        gmsh.model.occ.fillet([punch], edges(lambda ends: ends[5] < THICKNESS + 0.01), [8])
        save(folder / "punch.step")
        die = plate(-60, 60)
        gmsh.model.occ.fillet([die], edges(lambda ends: ends[2] > -0.01 and max(ends[3], ends[4]) < 38), [5])
        save(folder / "die.step")
        plate(THICKNESS, 20)
        save(folder / "holder.step")


if __name__ == "__main__":
    run(main)
