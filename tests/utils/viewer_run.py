# SPDX-License-Identifier: GPL-3.0-or-later
"""A small made-up run for the tests of the 3D view: a quarter of a strip that is bent by a punch and released."""

import numpy as np
from helpers import write_run

HISTORY = """increment,phase,travel,progress,punch_ux,punch_uy,punch_uz,punch_fx,punch_fy,punch_fz,punch_contacts,\
punch_area,punch_pressure,tool_work,external_work,friction_work,energy_error
0,draw,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0
1,draw,2,1,0,0,-2,0,0,2500,4,10,250,5000,0,100,5
2,free,2,1,0,0,-2,0,0,0,0,0,0,5000,0,100,5
"""
STATUS = """phase,travel,outcome,iterations,solver_iterations,limiter,seconds
draw,2,retry,9,0,rotation,1.0
draw,2,accepted,5,0,rotation,2.0
free,2,accepted,5,0,phase,1.0
"""
TOOL = {"name": "punch", "motion": "moved", "displacement": [0, 0, -2], "turn": None, "gap": None, "force": None}
PHASES = [{"number": 1, "name": "draw", "control": "punch", "tools": [{**TOOL, "active": True}]},
          {"number": 2, "name": "free", "control": None, "tools": [{**TOOL, "active": False}]}]
MATERIALS = [{"name": "steel", "hardening": {"name": "swift", "parameters": [{"name": "n", "value": 0.2}]}}]
BLOCKS = [{"keyword": "material", "name": "steel", "entries": [
    {"key": "grade", "text": "low_carbon_steel", "unit": "", "default": False}]}]
PUNCH = "patch 1 1\n0 0 6\n8 0 6\n0 5 6\n8 5 6\n"
SHAPE = 21, 6, 2  # nodes along x, y, z


def place(start, bend):
    """Return the nodes of the strip, bent down along x."""
    return start - [0, 0, bend] * (start[:, :1] / 40) ** 2


def viewed_run(folder):
    """Write the run of a strip of 40 x 10 x 1 mm with elements of 2 mm, drawn at its first step, free at its second."""
    x, y, z = np.meshgrid(np.linspace(0, 40, SHAPE[0]), np.linspace(0, 10, SHAPE[1]), [0.0, 1.0], indexing="ij")
    start = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    number = np.arange(len(start)).reshape(SHAPE)
    cells = [[number[i + a, j + b, k] for k in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
             for i in range(SHAPE[0] - 1) for j in range(SHAPE[1] - 1)]
    drawn, free = place(start, 8.0), place(start, 6.0)
    one, x = np.ones(len(start)), start[:, 0]
    fields = {name: (values, values) for name, values in {
        "thickness": 1 - x / 200, "thinning": x / 200 - 0.05, "draw_in": 0 * x, "equivalent_plastic_strain": x / 100,
        "major_strain_middle": x / 100, "minor_strain_middle": -0.02 * one,
        "contact_pressure": np.where(x < 9, 50.0, 0),
    }.items()}
    touched = ((x < 9) & (start[:, 2] > 0.5)).astype(np.int32)
    fields["contact_tool"] = touched, 0 * touched
    fields["displacement"] = drawn - start, free - start
    fields["stress"] = tuple(factor * np.outer(x, np.arange(1.0, 7.0)) for factor in (1, 0.5))
    centres = np.arange(len(cells)) / len(cells)
    folder.parent.mkdir(exist_ok=True)
    (folder.parent / "punch.bez").write_text(PUNCH)
    return write_run(folder, drawn, free, cells, HISTORY, STATUS, fields, {"thinning": (centres, centres)},
                     title="strip", materials=MATERIALS, input={"blocks": BLOCKS}, phases=PHASES,
                     tools=[{"name": "punch", "patches": str(folder.parent / "punch.bez")}])
