# SPDX-License-Identifier: GPL-3.0-or-later
"""Fields of a run, fields.vtkhdf."""

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from dd3.errors import Problem
from dd3.run import read_job

if TYPE_CHECKING:
    import pyvista as pv


AT = "travel in mm, PHASE for its end, or PHASE:PERCENT; the nearest step (default: the last)"  # help of --at
COMPONENTS = {"stress": ("11", "22", "33", "12", "23", "13")}


def missing(path: Path) -> str:
    """Return the message for results without fields."""
    if (path.parent / "run.json").is_file() and read_job(path.parent).get("points"):
        return f"{path.parent}: a run of material points, without a sheet; see dd3 plot point"
    return f"{path}: No such file"


class Fields:
    """The sheet at its steps; `fields[i]` is a grid of pyvista with all fields of a step.

    count: number of steps. last: number of the last step. travel: the travel of each, mm.
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
        import pyvista as pv
        offsets = self.grid["Offsets"][...]
        cells = np.insert(self.grid["Connectivity"][...], offsets[:-1], np.diff(offsets))
        return pv.UnstructuredGrid(cells, self.grid["Types"][...], self.points(step))

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
        first = int(self.steps["PointOffsets"][step])
        points: np.ndarray = self.grid["Points"][first:first + int(self.grid["NumberOfPoints"][0])]
        return points

    def values(self, step: int, name: str, at_cells: bool = False) -> tuple[np.ndarray, str]:
        """Return a field at a step, and its unit."""
        where, rows = ("CellData", "NumberOfCells") if at_cells else ("PointData", "NumberOfPoints")
        if name not in self.grid[where]:
            raise Problem(f"{self.path}: no field '{name}'; there are: {', '.join(self.grid[where])}")
        data = self.grid[where][name]
        first = int(self.steps[where + "Offsets"][name][step])
        return data[first:first + int(self.grid[rows][0])], text_of(data.attrs.get("unit", "")).strip()

    def component(self, step: int, field: str, at_cells: bool = False) -> tuple[np.ndarray, str]:
        """Return a field, or a component such as stress:11 or displacement:z, and its label; without a component the
        magnitude of a vector."""
        name, _, chosen = field.partition(":")
        values, unit = self.values(step, name, at_cells)
        values, label, unit = values.astype(float), name.replace("_", " "), f" ({unit})" if unit else ""
        if values.ndim == 1:
            return values, label + unit
        names = COMPONENTS.get(name, tuple("xyz"[: values.shape[1]]))
        if chosen in names:
            return values[:, names.index(chosen)], f"{label} {chosen}{unit}"
        if chosen in ("", "magnitude"):
            return np.linalg.norm(values, axis=1), f"{label}, magnitude{unit}"
        raise Problem(f"{self.path}: no component '{chosen}' of '{name}'; there are: {', '.join(names)}, magnitude")


def number_in(text: str, said: str) -> float:
    """Return the number in a text."""
    try:
        return float(text)
    except ValueError:
        raise Problem(f"no place {said}; expected a travel in mm, PHASE or PHASE:PERCENT") from None


def text_of(attribute: str | bytes) -> str:
    """Return a text attribute as str."""
    return attribute.decode() if isinstance(attribute, bytes) else str(attribute)
