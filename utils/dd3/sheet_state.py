# SPDX-License-Identifier: GPL-3.0-or-later
"""The sheet in a restart file: its mesh and its state at the points of its elements."""
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

from dd3 import __version__
from dd3.errors import Problem

NAME = "restart.h5"
MARK, FORMAT = b"dd3imp restart", 9
COLUMNS = 4  # of points in an element of type solid_shell; the points of a column follow one another, upwards
FACTOR = np.array([1.0, 1.0, 1.0, *[np.sqrt(2)] * 3])  # of Kelvin's notation: 11, 22, 33, 23, 31, 12
PLACE = ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))


@dataclass
class SheetState:
    """Initial and present positions of the nodes (n, 3), mm; elements (m, 8) of node numbers; the thickness, mm; stress
    tensors in global axes (m, points, 3, 3), MPa; plastic strains (m, points); axes of orthotropy as the columns of
    (m, points, 3, 3); names of materials, and that of each element; the points of a column; sets of nodes by name;
    bound nodes and the ends of their edges (n, 3)."""

    initial: np.ndarray
    points: np.ndarray
    elements: np.ndarray
    thickness: float
    stress: np.ndarray
    strain: np.ndarray
    axes: np.ndarray
    materials: list[str]
    material_of: np.ndarray
    column: int
    sets: dict[str, np.ndarray] = field(default_factory=dict)
    bound: np.ndarray = field(default_factory=lambda: np.zeros((0, 3), int))


def read_state(folder: Path, element: str = "solid_shell") -> SheetState:
    """Return the last state of a run of 8-node elements of a type."""
    path = folder / NAME
    try:
        with h5py.File(path) as file:
            mesh, state = file["mesh"], file["state"]
            kind = mesh.attrs["element"].decode().strip()
            nodes, count, corners, points, internal, column, _ = mesh["sizes"][...]
            if kind != element:
                raise Problem(f"{path}: elements of type {kind}; expected {element}")
            kelvin = state["stress"][...].reshape(count, points, 6) / FACTOR
            axes = np.swapaxes(state["orientation"][...].reshape(count, points, 3, 3), 2, 3)
            tensor = np.zeros((count, points, 3, 3))
            for k, (i, j) in enumerate(PLACE):
                tensor[..., i, j] = tensor[..., j, i] = kelvin[..., k]
            names = bytes(mesh["materials"][...].astype(np.uint8)).decode().splitlines()
            return SheetState(
                mesh["x0"][...].reshape(nodes, 3), state["x"][...].reshape(nodes, 3),
                mesh["connectivity"][...].reshape(count, corners) - 1, float(mesh["thickness"][0]),
                axes @ tensor @ np.swapaxes(axes, 2, 3),
                state["internal_variables"][...].reshape(count, points, internal)[..., 0], axes,
                [name.strip() for name in names], mesh["material_of"][...] - 1, int(column))
    except (OSError, KeyError) as error:
        raise Problem(f"{path}: no restart file with a sheet: {error}") from None


def codes(names: Iterable[str]) -> np.ndarray:
    """Return the character codes of names, a line each."""
    return np.frombuffer("".join(f"{name}\n" for name in names).encode(), np.uint8).astype(np.int32)


def write_state(folder: Path, sheet: SheetState) -> None:
    """Write a sheet that *START takes over. Its material has no check sum: that of the input file is not compared."""
    count, points = sheet.strain.shape
    own = np.swapaxes(sheet.axes, 2, 3) @ sheet.stress @ sheet.axes
    kelvin = np.stack([own[..., i, j] for i, j in PLACE], axis=-1) * FACTOR
    with h5py.File(folder / NAME, "w") as file:
        file.attrs["program"], file.attrs["version"] = np.bytes_(MARK), np.bytes_(__version__.encode())
        file.attrs["format"] = np.array([FORMAT], np.int32)
        mesh, state = file.create_group("mesh"), file.create_group("state")
        mesh.attrs["element"] = np.bytes_(b"solid_shell")
        mesh["sizes"] = np.array([len(sheet.points), count, 8, points, 1, sheet.column, 1], np.int32)
        mesh["x0"], state["x"] = sheet.initial.ravel(), sheet.points.ravel()
        mesh["thickness"] = np.array([sheet.thickness])
        mesh["connectivity"] = (sheet.elements + 1).ravel().astype(np.int32)
        if len(sheet.bound):
            mesh["bound"] = (sheet.bound + 1).ravel().astype(np.int32)
        mesh["material_of"] = (sheet.material_of + 1).astype(np.int32)
        mesh["material_digest"] = np.zeros(len(sheet.materials), np.int32)
        mesh["materials"], mesh["sets"] = codes(sheet.materials), codes(sheet.sets)
        mesh["set_size"] = np.array([len(nodes) for nodes in sheet.sets.values()], np.int32)
        mesh["set_node"] = np.concatenate([np.zeros(0, int), *sheet.sets.values()]).astype(np.int32) + 1
        state["stress"], state["internal_variables"] = kelvin.ravel(), sheet.strain.ravel()
        state["orientation"] = np.swapaxes(sheet.axes, 2, 3).ravel()
