# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections of the verification manual: their values and studies of refinement."""
import importlib.util
import math
import pathlib
import sys
from collections.abc import Callable
from dataclasses import dataclass, field

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(ROOT / "tests"))
from bench import Bench, Problem, Run, Value, interpolate, per_cent  # noqa: E402, F401

VALUE_HEAD = ["quantity", "expected", "computed", "error", "tolerance"]
STUDY_HEAD = ["element", "mesh", "unknowns", "seconds", "computed", "error", "order"]


@dataclass
class Mesh:
    """A run of a study: element, mesh in words, its element length, and what the run gave."""

    element: str
    mesh: str
    length: float
    unknowns: int
    seconds: float
    expected: float
    found: float

    def error(self):
        """Return the relative error."""
        return self.found / self.expected - 1


@dataclass
class Outcome:
    """What a section gives: values, study, and pictures as pairs of a file name and a function that draws on axes.

    The errors of a study are drawn from its table in values.md.
    """

    values: list = field(default_factory=list)
    study: list = field(default_factory=list)
    pictures: list = field(default_factory=list)


@dataclass
class Section:
    """A section of the page: `text` comes before the table, `after` behind it; file name of the study's picture."""

    heading: str
    text: str
    produce: Callable
    slow: bool = False
    after: str = ""
    picture: str = ""


def study_rows(study):
    """Return the cells of a study: the order is that between a mesh and the one before it, of the same element."""
    rows, before = [], None
    for mesh in study:
        order = ""
        if before and before.element == mesh.element and before.length > mesh.length:
            ratio = before.error() / mesh.error() if mesh.error() else 0.0
            if ratio > 1:  # neither a change of sign nor a larger error
                order = f"{math.log(ratio) / math.log(before.length / mesh.length):.1f}"
        rows.append([f"`{mesh.element}`", mesh.mesh, str(mesh.unknowns), f"{mesh.seconds:.2g}", f"{mesh.found:.6g}",
                     per_cent(mesh.error()), order])
        before = mesh
    return rows


def geometric(number, first, length):
    """Return the places of lines whose distances grow by a factor from the first one."""
    low, high = 1.0, 10.0
    for _ in range(100):
        factor = 0.5 * (low + high)
        low, high = (low, factor) if first * sum(factor**i for i in range(number)) > length else (factor, high)
    places = [first * sum(factor**i for i in range(k)) for k in range(number)]
    return [*places, length]


def load(path):
    """Return the module of a file."""
    spec = importlib.util.spec_from_file_location(f"{path.parent.name}_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module
