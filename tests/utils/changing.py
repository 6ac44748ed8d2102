# SPDX-License-Identifier: GPL-3.0-or-later
"""A made-up run whose mesh changes twice, in the layout of the program (src/output/field_meshes.f90)."""

import h5py
import numpy as np

THICKNESS = 1.0
SQUARES = (  # corner of smallest x and y, and side, of the elements of each mesh
    [(x, y, 8) for y in (0, 8) for x in (0, 8)],
    [(x, y, 4) for y in (0, 4) for x in (0, 4)] + [(8, 0, 8), (0, 8, 8), (8, 8, 8)],
    [(x, y, 2) for y in (0, 2) for x in (0, 2)] + [(4, 0, 4), (0, 4, 4), (4, 4, 4)]
    + [(x, y, 4) for y in (0, 4) for x in (8, 12)] + [(0, 8, 8), (8, 8, 8)])
LEVELS = tuple(np.array([{8: 0, 4: 1, 2: 2}[side] for _, _, side in squares]) for squares in SQUARES)
MESH_OF = (0, 1, 1, 2)  # mesh of each step
TRAVEL = (0.0, 1.0, 2.0, 3.0)


def meshes():
    """Return the places of the nodes of all meshes, those of the first one first, and the elements of each."""
    known, places, elements = {}, [], []
    for squares in SQUARES:
        cells = []
        for x, y, side in squares:
            plan = [(x, y), (x + side, y), (x + side, y + side), (x, y + side)]
            cells.append([known.setdefault((*corner, z), len(known)) for z in (0.0, THICKNESS) for corner in plan])
        elements.append(np.array(cells))
        places.append(np.array(list(known), float))
    return places, elements


def moved(initial, step):
    """Return the positions of nodes at a step: a parabola along x that becomes steeper, and a stretch along y."""
    return initial + np.column_stack([0 * initial[:, 0], 0.01 * step * initial[:, 1], 0.02 * step * initial[:, 0]**2])


def write_changing(folder, start=None):
    """Write the fields; `start` gives positions at the first step in place of the initial ones."""
    places, elements = meshes()
    folder.mkdir()
    with h5py.File(folder / "fields.vtkhdf", "w") as file:
        grid = file.create_group("VTKHDF")
        grid.attrs["Version"], grid.attrs["Type"] = np.array([2, 0]), np.bytes_(b"UnstructuredGrid")
        count, cells = [len(p) for p in places], [len(e) for e in elements]
        grid["NumberOfPoints"], grid["NumberOfCells"] = count, cells
        grid["NumberOfConnectivityIds"] = [8 * n for n in cells]
        grid["Types"] = np.full(sum(cells), 12, np.uint8)
        grid["Connectivity"] = np.concatenate([e.ravel() for e in elements])
        grid["Offsets"] = np.concatenate([8 * np.arange(n + 1) for n in cells])
        initial = [places[mesh] for mesh in MESH_OF]
        now = [moved(x, step) for step, x in enumerate(initial)]
        if start is not None:
            now[0] = start(initial[0])
        steps, first = grid.create_group("Steps"), np.cumsum([0, *cells])[list(MESH_OF)]
        steps.attrs["NSteps"] = len(MESH_OF)
        steps["Values"], steps["PartOffsets"] = TRAVEL, MESH_OF
        steps["NumberOfParts"] = np.ones(len(MESH_OF), int)
        steps["CellOffsets"], steps["ConnectivityIdOffsets"] = first[:, None], 8 * first[:, None]
        nodes = np.cumsum([0, *(len(x) for x in now)])[:-1]
        steps["PointOffsets"], grid["Points"] = nodes, np.concatenate(now)
        for name, values in (("displacement", [x - x0 for x, x0 in zip(now, initial)]),
                             ("thickness", [1 + 0.01 * x0[:, 0] + step for step, x0 in enumerate(initial)]),
                             ("thinning", [0.001 * x0[:, 0] for x0 in initial]),
                             *((f"{strain}_strain_middle", [0 * x0[:, 0] for x0 in initial])
                               for strain in ("major", "minor"))):
            grid[f"PointData/{name}"], steps[f"PointDataOffsets/{name}"] = np.concatenate(values), nodes
        own = [elements[mesh] for mesh in MESH_OF]
        at_cell = np.cumsum([0, *(len(e) for e in own)])[:-1]
        for name, size in (("stress", 6), ("equivalent_plastic_strain", 1)):
            values = [np.arange(len(e) * size).reshape(-1, size).squeeze() + 1000.0 * step
                      for step, e in enumerate(own)]
            grid[f"CellData/{name}"], steps[f"CellDataOffsets/{name}"] = np.concatenate(values), at_cell
        grid["CellData/level"], steps["CellDataOffsets/level"] = np.concatenate(LEVELS), first
        file.create_group("job").attrs["tools"] = ""
    return folder
