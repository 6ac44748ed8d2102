# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields of a run, fields.vtkhdf."""

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import h5py
import numpy as np

from dd3.errors import Problem
from dd3.run import read_job

if TYPE_CHECKING:
    import pyvista as pv


AT = "travel in mm, PHASE for its end, or PHASE:PERCENT; the nearest step (default: the last)"  # help of --at
SAME = 1e-6  # distance of places that are the same, over the size of the sheet
LIMITED = ("fracture_damage", "forming_limit_ratio")  # fields of the limits that a run follows, 1 at the limit
VECTOR, TENSOR = ("x", "y", "z"), ("11", "22", "33", "12", "23", "13")  # names of components


def components_of(count: int) -> tuple[str, ...]:
    """Return the names of the components of a field by their count: a vector, a symmetric tensor, numbers of others."""
    return {3: VECTOR, 6: TENSOR}.get(count, tuple(map(str, range(1, count + 1))))


def missing(path: Path) -> str:
    """Return the message for results without fields."""
    if (path.parent / "run.json").is_file() and read_job(path.parent).get("points"):
        return f"{path.parent}: a run of material points, without a sheet; see dd3 plot point"
    return f"{path}: No such file"


class Cells(NamedTuple):
    """The elements of a mesh: node numbers from 0 in VTK's order, one element after the other; where each begins, and
    the end of the last one; types of VTK."""

    nodes: np.ndarray
    offsets: np.ndarray
    types: np.ndarray


class Fields:
    """The sheet at its steps; `fields[i]` is a grid of pyvista with all fields of a step.

    count: number of steps. last: number of the last step. travel: the travel of each, mm. The mesh may change from step
    to step, where elements are divided; a negative step counts from the end.
    """

    def __init__(self, run: str | Path) -> None:
        path = Path(run)
        path = path / "fields.vtkhdf" if path.is_dir() else path
        try:
            self.file = h5py.File(path, "r", locking=False)  # a run may still be writing
            self.grid: Any = self.file["VTKHDF"]
            self.steps: Any = self.grid["Steps"]
            self.count = int(self.steps.attrs["NSteps"])
        except FileNotFoundError:
            raise Problem(missing(path)) from None
        except (OSError, KeyError):
            raise Problem(f"{path}: not the field file of a run") from None
        if self.count == 0:
            raise Problem(f"{path}: no steps")
        self.path, self.folder, self.last = path, path.parent, self.count - 1
        self.travel: np.ndarray = self.steps["Values"][: self.count]
        self.read: dict[int, Cells] = {}  # by the number of the mesh

    @cached_property
    def phases(self) -> list[dict[str, Any]]:
        """The phases as run.json describes them; none where it is missing."""
        there = "job" in self.file and "phase" in self.file["job"] and (self.folder / "run.json").is_file()
        found: list[dict[str, Any]] = read_job(self.folder)["phases"] if there else []
        return found

    def __len__(self) -> int:
        return self.count

    def __getitem__(self, step: int) -> "pv.UnstructuredGrid":
        if not -self.count <= step < self.count:
            raise IndexError(f"step {step} of {self.count}")
        step %= self.count
        mesh = self.shape(step)
        for place, data in (("PointData", mesh.point_data), ("CellData", mesh.cell_data)):
            for name in self.grid.get(place, ()):
                data[name] = self.values(step, name, place == "CellData")[0]
        return mesh

    def shape(self, step: int) -> "pv.UnstructuredGrid":
        """Return the deformed sheet at a step without fields."""
        return self.grid_of(step, self.points(step))

    def grid_of(self, step: int, points: np.ndarray) -> "pv.UnstructuredGrid":
        """Return the mesh of a step with its nodes at other places."""
        import pyvista as pv
        nodes, offsets, types = self.cells(step)
        return pv.UnstructuredGrid(np.insert(nodes, offsets[:-1], np.diff(offsets)), types, points)

    def first(self, name: str, step: int) -> int:
        """Return where a step begins in a dataset, by the name of the offsets."""
        return int(np.ravel(self.steps[name])[step % self.count]) if name in self.steps else 0

    def mesh_number(self, step: int) -> int:
        """Return the number of the mesh of a step, from 0."""
        return self.first("PartOffsets", step)

    def size_of(self, what: str, step: int) -> int:
        """Return the number of Points, Cells or ConnectivityIds of the mesh of a step."""
        return int(self.grid["NumberOf" + what][self.mesh_number(step)])

    def cells(self, step: int) -> Cells:
        """Return the elements of the mesh of a step."""
        number = self.mesh_number(step)
        if number not in self.read:
            count, cell = self.size_of("Cells", step), self.first("CellOffsets", step)
            node = self.first("ConnectivityIdOffsets", step)
            self.read[number] = Cells(
                self.grid["Connectivity"][node:node + self.size_of("ConnectivityIds", step)],
                self.grid["Offsets"][cell + number:cell + number + count + 1],  # each mesh has the end of its last cell
                self.grid["Types"][cell:cell + count])
        return self.read[number]

    def initial(self, step: int) -> np.ndarray:
        """Return the initial positions of the nodes of the mesh of a step, those of the flat sheet."""
        if "displacement" in self.grid.get("PointData", ()):
            return np.asarray(self.points(step) - self.values(step, "displacement")[0])
        if self.mesh_number(step):
            raise Problem(f"{self.path}: the mesh changes and there is no field 'displacement'")
        return self.points(0)

    def start(self, step: int) -> np.ndarray:
        """Return the positions at the first step of the nodes of the mesh of a step. Nodes that were not there yet are
        between those that were, also where the sheet had its shape from another run."""
        if self.mesh_number(step) == self.mesh_number(0):
            return self.points(0)
        initial, before = self.initial(step), self.initial(0)
        moved = self.points(0) - before
        size = np.ptp(before, axis=0).max()
        if np.abs(moved).max() <= SAME * size:
            return initial
        import pyvista as pv
        grid = self.grid_of(0, before)
        grid.point_data["moved"] = moved
        found = pv.PolyData(initial).sample(grid, tolerance=SAME * size, snap_to_closest_point=True)
        return np.asarray(initial + found.point_data["moved"])

    def nodes_in(self, step: int, other: int) -> np.ndarray:
        """Return the nodes of the mesh of another step that are those of the mesh of a step, by initial positions. The
        other mesh is the same or a finer one."""
        if self.mesh_number(step) == self.mesh_number(other):
            return np.arange(self.size_of("Points", step))
        from scipy.spatial import cKDTree
        own, all_of_other = self.initial(step), self.initial(other)
        distance, node = cKDTree(all_of_other).query(own)
        if distance.max() > SAME * np.ptp(own, axis=0).max():
            raise Problem(f"{self.path}: the mesh of step {other % self.count} lacks nodes of that of step "
                          f"{step % self.count}")
        return np.asarray(node)

    def nearest_step(self, travel: float) -> int:
        """Return the last of the steps whose travel is nearest."""
        distance = np.abs(self.travel - travel)
        return int(np.flatnonzero(distance <= distance.min() + 2e-6)[-1])

    def step_at(self, place: str | float) -> int:
        """Return the last of the steps nearest to a travel in mm, to the end of a phase, given by its name, or to a
        part of it in per cent, such as draw:40. A Problem where the run has no such place."""
        name, _, percent = str(place).partition(":")
        numbers = [phase["number"] for phase in self.phases if phase["name"] == name]
        if numbers:
            return self.step_of_phase(numbers[0], name, number_in(percent or "100", str(place)))
        travel = number_in(str(place), f"{place}{self.named()}")
        if not self.travel.min() - 0.01 <= travel <= self.travel.max() + 0.01:
            raise Problem(f"{self.path}: no travel {travel:g} mm; "
                          f"there is {self.travel.min():g} to {self.travel.max():g}{self.named()}")
        return self.nearest_step(travel)

    def named(self) -> str:
        """Return the names of the phases as the end of a message."""
        names = ", ".join(phase["name"] for phase in self.phases)
        return f"; the phases are {names}" if names else ""

    def step_of_phase(self, number: int, name: str, percent: float) -> int:
        """Return the step of a phase that is nearest to a part of it."""
        job = self.file["job"]
        steps = np.flatnonzero(job["phase"][: self.count] == number)
        if not steps.size:
            raise Problem(f"{self.path}: no step of phase '{name}'")
        distance = np.abs(100 * job["progress"][: self.count][steps] - percent)
        return int(steps[np.flatnonzero(distance <= distance.min() + 2e-6)[-1]])

    def state(self, step: int) -> str:
        """Return what a step is: its phase, and travel or, where no tool controls the phase, progress."""
        job = self.file["job"]
        number = int(job["phase"][step]) if "phase" in job else 0
        if not 0 < number <= len(self.phases):
            return f"travel {self.travel[step]:.2f} mm"
        phase = self.phases[number - 1]
        if phase["control"]:
            return f"{phase['name']}, travel {job['travel'][step]:.2f} mm"
        return f"{phase['name']}, {100 * job['progress'][step]:.3g} %"

    def points(self, step: int) -> np.ndarray:
        """Return the positions of the nodes at a step."""
        first = self.first("PointOffsets", step)
        points: np.ndarray = self.grid["Points"][first:first + self.size_of("Points", step)]
        return points

    def values(self, step: int, name: str, at_cells: bool = False) -> tuple[np.ndarray, str]:
        """Return a field at a step, and its unit."""
        where, rows = ("CellData", "Cells") if at_cells else ("PointData", "Points")
        if name not in self.grid[where]:
            raise Problem(f"{self.path}: no field '{name}'; there are: {', '.join(self.grid[where])}")
        data = self.grid[where][name]
        first = self.first(f"{where}Offsets/{name}", step)
        return data[first:first + self.size_of(rows, step)], text_of(data.attrs.get("unit", "")).strip()

    def component(self, step: int, field: str, at_cells: bool = False) -> tuple[np.ndarray, str]:
        """Return a field, or a component such as stress:11 or displacement:z, and its label; without a component the
        magnitude of a vector or tensor."""
        name, _, chosen = field.partition(":")
        values, unit = self.values(step, name, at_cells)
        values, label, unit = values.astype(float), name.replace("_", " "), f" ({unit})" if unit else ""
        if values.ndim == 1:
            return values, label + unit
        names = components_of(values.shape[1])
        if chosen in names:
            return values[:, names.index(chosen)], f"{label} {chosen}{unit}"
        if chosen in ("", "magnitude"):
            weights = [1.0 + (names == TENSOR and one[0] != one[1]) for one in names]  # a shear component counts twice
            return np.sqrt(values**2 @ weights), f"{label}, magnitude{unit}"
        raise Problem(f"{self.path}: no component '{chosen}' of '{name}'; there are: {', '.join(names)}, magnitude")


def odd_axes(field: str) -> list[str]:
    """Return the axes in whose mirror images a component such as displacement:x or stress:12 changes its sign."""
    chosen = field.partition(":")[2]
    return [axis for axis, digit in zip("xyz", "123") if (chosen.count(axis) + chosen.count(digit)) % 2]


def number_in(text: str, said: str) -> float:
    """Return the number in a text."""
    try:
        return float(text)
    except ValueError:
        raise Problem(f"no place {said}; expected a travel in mm, PHASE or PHASE:PERCENT") from None


def text_of(attribute: str | bytes) -> str:
    """Return a text attribute as str."""
    return attribute.decode() if isinstance(attribute, bytes) else str(attribute)
