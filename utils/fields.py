"""Reading of fields.vtkhdf. Needs h5py and numpy."""

import os
from pathlib import Path

os.environ.setdefault("HDF5_USE_FILE_LOCKING", "FALSE")  # a run may still be writing
import h5py  # noqa: E402
import numpy as np  # noqa: E402

from scripts import Problem  # noqa: E402


class Fields:
    """The field file of a run: its steps, and values at nodes and cells."""

    def __init__(self, run):
        path = Path(run)
        path = path / "fields.vtkhdf" if path.is_dir() else path
        try:
            self.file = h5py.File(path, "r")
            self.grid = self.file["VTKHDF"]
            self.steps = self.grid["Steps"]
            self.count = int(self.steps.attrs["NSteps"])
        except FileNotFoundError:
            raise Problem(f"{path}: No such file") from None
        except (OSError, KeyError):
            raise Problem(f"{path}: not the field file of a run") from None
        if self.count == 0:
            raise Problem(f"{path}: no steps")
        self.path, self.folder = path, path.parent
        self.travel = self.steps["Values"][: self.count]

    def nearest_step(self, travel):
        """Return the last of the steps whose travel is nearest."""
        distance = np.abs(self.travel - travel)
        return int(np.flatnonzero(distance <= distance.min() + 2e-6)[-1])

    def points(self, step):
        """Return the positions of the nodes at a step."""
        first = int(self.steps["PointOffsets"][step])
        return self.grid["Points"][first:first + int(self.grid["NumberOfPoints"][0])]

    def values(self, step, name, at_cells=False):
        """Return a field at a step, and its unit."""
        where, rows = ("CellData", "NumberOfCells") if at_cells else ("PointData", "NumberOfPoints")
        if name not in self.grid[where]:
            raise Problem(f"{self.path}: no field '{name}'; there are: {', '.join(self.grid[where])}")
        data = self.grid[where][name]
        first = int(self.steps[where + "Offsets"][name][step])
        return data[first:first + int(self.grid[rows][0])], text_of(data.attrs.get("unit", "")).strip()


def text_of(attribute):
    """Return a text attribute as str."""
    return attribute.decode() if isinstance(attribute, bytes) else str(attribute)
