# SPDX-License-Identifier: GPL-3.0-or-later
"""The file of a checking fixture: what a part is compared with, how it lies, and where it is measured.

    title = "Rail in its fixture"
    face = "lower"                      # of the sheet, the one that lies on the fixture (upper)
    tolerance = 0.5                     # mm, or [-0.3, 0.5]
    mirror = ["x"]                      # planes of symmetry of the model
    section = ["x=0", "y=20"]
    [nominal]                           # left out: the drawn sheet of the run
    run = "rail.out"                    # the sheet of this run, at the end of the last phase with tools, or
    at = "draw"                         # at this place; or
    surface = "part.step"               # CAD, facets, or a tool surface (.bez)
    [alignment]
    by = "locators"                     # fit (default), points, locators, none
    region = [[0, 50, -20, 20, -5, 5]]  # of a fit: boxes x0 x1 y0 y1 z0 z1
    [[locator]]
    name = "a1"
    at = [40, 0, 0]                     # mm, in the coordinates of the nominal shape
    direction = [0, 0, 1]               # from the fixture to the part
    pin = false                         # true: a hole, the point of the sheet that lies there
    one_sided = false                   # true: it can push only, in any direction
    [[clamp]]
    name = "c1"
    at = [80, 0, 0]
    direction = [0, 0, -1]
    order = 1                           # clamps of the same order close together
    stop = 0.0                          # mm before the nominal place
    one_sided = false
    [[clamp]]
    name = "c2"
    at = [80, 10, 0]
    direction = [0, 0, -1]
    force = 50                          # N, in place of a stop; one-sided
    [[point]]
    name = "p1"
    at = [60, 10, 0]
    tolerance = 0.3
    [gravity]
    acceleration = [0, 0, -9810]        # mm/s2, in car position
    density = 7.85e-9                   # t/mm3, of materials without one
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from dd3.errors import Problem
from dd3.sheet import AXES, plane

FIT, POINTS, LOCATORS, NONE = "fit", "points", "locators", "none"
NUMBER = (int, float)
KEYS: dict[str, Any] = {"title": str, "face": str, "tolerance": (*NUMBER, list), "mirror": list, "section": list,
                        "nominal": dict, "alignment": dict, "locator": list, "clamp": list, "point": list,
                        "gravity": dict}
NOMINAL: dict[str, Any] = {"run": str, "at": (str, *NUMBER), "surface": str}
ALIGNMENT: dict[str, Any] = {"by": str, "region": list, "points": list}
PLACE: dict[str, Any] = {"name": str, "at": list}
LOCATOR = {**PLACE, "direction": list, "pin": bool, "one_sided": bool}
CLAMP = {**PLACE, "direction": list, "order": int, "stop": NUMBER, "one_sided": bool, "force": NUMBER}
POINT = {**PLACE, "tolerance": (*NUMBER, list)}
GRAVITY: dict[str, Any] = {"acceleration": list, "density": NUMBER}


@dataclass
class Support:
    """A locator or a clamp: its name, its place on the nominal shape, mm, and the unit vector from the fixture to the
    part. order: 0 of a locator, else that of the clamp; stop: mm before the nominal place. one_sided: it can push only;
    force: with which it pushes, N, None: it moves to its stop."""

    name: str
    at: np.ndarray
    direction: np.ndarray
    pin: bool = False
    order: int = 0
    stop: float = 0.0
    one_sided: bool = False
    force: float | None = None


@dataclass
class Point:
    """A place to measure at, mm, and its limits, mm."""

    name: str
    at: np.ndarray
    limits: tuple[float, float]


@dataclass
class Fixture:
    """What the file tells. limits: of the deviation, mm; None: not judged. regions: boxes (n, 3, 2). fitted: names of
    the points of the alignment. gravity: mm/s2."""

    path: Path
    title: str
    upper: bool = True
    limits: tuple[float, float] | None = None
    mirror: list[str] = field(default_factory=list)
    sections: list[str] = field(default_factory=list)
    run: Path | None = None
    at: str | None = None
    surface: Path | None = None
    alignment: str = FIT
    regions: np.ndarray = field(default_factory=lambda: np.zeros((0, 3, 2)))
    fitted: list[str] = field(default_factory=list)
    locators: list[Support] = field(default_factory=list)
    clamps: list[Support] = field(default_factory=list)
    points: list[Point] = field(default_factory=list)
    gravity: np.ndarray | None = None
    density: float | None = None


class Table:
    """A table of the file, with its place for messages."""

    def __init__(self, path: Path, values: Any, keys: Mapping[str, Any], where: str = "") -> None:
        self.path, self.where = path, where
        if not isinstance(values, dict):
            raise self.problem(f"{values!r} is not a table")
        self.values: dict[str, Any] = values
        for key, value in values.items():
            if key not in keys:
                raise self.problem(f"unknown key '{key}'; expected one of: {' '.join(keys)}")
            kinds = keys[key] if isinstance(keys[key], tuple) else (keys[key],)
            if not isinstance(value, kinds) or isinstance(value, bool) != (kinds == (bool,)):
                raise self.problem(f"{key} is {value!r}; expected a "
                                   + " or a ".join(dict.fromkeys(NAMES[kind] for kind in kinds)))

    def problem(self, text: str) -> Problem:
        """Return the Problem of this table."""
        return Problem(f"{self.path}: error: {text}{self.where}")

    def get(self, key: str, default: Any = None) -> Any:
        """Return a value."""
        return self.values.get(key, default)

    def vector(self, key: str, count: int = 3) -> np.ndarray:
        """Return numbers."""
        values = self.values.get(key)
        if not isinstance(values, list) or len(values) != count or not all(is_number(value) for value in values):
            raise self.problem(f"{key} is {values!r}; expected {count} numbers")
        return np.array(values, float)

    def direction(self) -> np.ndarray:
        """Return the unit vector of a direction."""
        vector = self.vector("direction")
        if not np.linalg.norm(vector) > 0:
            raise self.problem("the direction is zero; expected a vector from the fixture to the part")
        return vector / np.linalg.norm(vector)

    def limits(self) -> tuple[float, float] | None:
        """Return the limits of a tolerance."""
        value = self.values.get("tolerance")
        if value is None:
            return None
        pair = [-value, value] if is_number(value) else value
        if len(pair) != 2 or not all(is_number(end) for end in pair) or not pair[0] < pair[1]:
            raise self.problem(f"tolerance is {value!r}; expected a number > 0, or the lower and the upper limit")
        return float(pair[0]), float(pair[1])

    def named(self, key: str, keys: Mapping[str, Any]) -> "list[Table]":
        """Return the tables of an array, each with a name."""
        tables = [Table(self.path, row, keys, f" in {key} {number}")
                  for number, row in enumerate(self.values.get(key, []), 1)]
        for number, table in enumerate(tables, 1):
            table.values.setdefault("name", f"{key}_{number}")
        return tables


NAMES = {str: "text", int: "number", float: "number", list: "list", dict: "table", bool: "true or false"}


def is_number(value: Any) -> bool:
    """Tell whether a value is a number."""
    return isinstance(value, NUMBER) and not isinstance(value, bool)


def read_fixture(path: Path) -> Fixture:
    """Read and check the file of a fixture."""
    try:
        content = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise Problem(f"{path}: No such file") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise Problem(f"{path}: error: {error}") from None
    table = Table(path, content, KEYS)
    if table.get("face", "upper") not in ("upper", "lower"):
        raise table.problem(f"face is {table.get('face')!r}; expected upper or lower")
    unknown = [axis for axis in table.get("mirror", []) if axis not in tuple(AXES)]
    if unknown:
        raise table.problem(f"mirror has {unknown[0]!r}; expected x, y, z")
    for text in table.get("section", []):
        plane(str(text))
    fixture = Fixture(path, table.get("title", path.stem), table.get("face", "upper") == "upper", table.limits(),
                      sorted(set(table.get("mirror", []))), [str(text) for text in table.get("section", [])])
    add_nominal(fixture, Table(path, table.get("nominal", {}), NOMINAL, " in [nominal]"))
    fixture.locators = [locator_of(row) for row in table.named("locator", LOCATOR)]
    fixture.clamps = [clamp_of(row) for row in table.named("clamp", CLAMP)]
    for row in table.named("point", POINT):
        limits = row.limits() or fixture.limits
        fixture.points.append(Point(row.get("name"), row.vector("at"), limits or (-np.inf, np.inf)))
    gravity = Table(path, table.get("gravity", {}), GRAVITY, " in [gravity]")
    if gravity.values:
        fixture.gravity, fixture.density = gravity.vector("acceleration"), gravity.get("density")
    check_names(table, [*fixture.locators, *fixture.clamps], fixture.points)
    add_alignment(fixture, Table(path, table.get("alignment", {}), ALIGNMENT, " in [alignment]"))
    return fixture


def locator_of(row: Table) -> Support:
    """Return a locator."""
    if row.get("pin") and row.get("one_sided"):
        raise row.problem("pin beside one_sided; expected one of them, as a pin holds the part in both senses")
    return Support(row.get("name"), row.vector("at"), row.direction(), row.get("pin", False),
                   one_sided=row.get("one_sided", False))


def clamp_of(row: Table) -> Support:
    """Return a clamp."""
    if row.get("order", 1) < 1:
        raise row.problem(f"order is {row.get('order')}; expected 1 or more")
    force = row.get("force")
    if force is not None and not force > 0:
        raise row.problem(f"force is {force}; expected a force > 0, N")
    if force is not None and ("stop" in row.values or row.get("one_sided") is False):
        raise row.problem("force beside stop or one_sided = false; expected a clamp that moves to its stop, or one "
                          "that pushes with its force")
    return Support(row.get("name"), row.vector("at"), row.direction(), False, row.get("order", 1),
                   float(row.get("stop", 0.0)), force is not None or row.get("one_sided", False), force)


def add_nominal(fixture: Fixture, table: Table) -> None:
    """Add what the part is compared with."""
    if "surface" in table.values and ("run" in table.values or "at" in table.values):
        raise table.problem("surface beside run or at; expected one nominal shape")
    folder = fixture.path.parent
    fixture.run = folder / table.get("run") if "run" in table.values else None
    fixture.surface = folder / table.get("surface") if "surface" in table.values else None
    fixture.at = str(table.get("at")) if "at" in table.values else None


def add_alignment(fixture: Fixture, table: Table) -> None:
    """Add how the part is aligned."""
    fixture.alignment = table.get("by", FIT)
    known = (FIT, POINTS, LOCATORS, NONE)
    if fixture.alignment not in known:
        raise table.problem(f"by is '{fixture.alignment}'; expected one of: {' '.join(known)}")
    for key, needed in (("region", FIT), ("points", POINTS)):
        if key in table.values and fixture.alignment != needed:
            raise table.problem(f"{key} has no effect with by = \"{fixture.alignment}\"; it belongs to \"{needed}\"")
    boxes = table.get("region", [])
    if any(not isinstance(box, list) or len(box) != 6 or not all(map(is_number, box)) for box in boxes):
        raise table.problem("region takes boxes of six numbers: x0 x1 y0 y1 z0 z1")
    fixture.regions = np.array(boxes, float).reshape(-1, 3, 2)
    fixture.fitted = table.get("points", [point.name for point in fixture.points])
    unknown = [name for name in fixture.fitted if name not in [point.name for point in fixture.points]]
    if unknown:
        raise table.problem(f"no point '{unknown[0]}'; there are: "
                            + (", ".join(point.name for point in fixture.points) or "none"))
    if fixture.alignment == POINTS and len(fixture.fitted) < 3:
        raise table.problem(f"{len(fixture.fitted)} points; expected 3 or more [[point]] for the alignment")
    if fixture.alignment == LOCATORS and not fixture.locators:
        raise table.problem("no [[locator]]; expected six, or three on planes of symmetry")


def check_names(table: Table, supports: list[Support], points: list[Point]) -> None:
    """Refuse names that are given twice, and those that an input file cannot have."""
    for kind, names in (("locators and clamps", [support.name for support in supports]),
                        ("points", [point.name for point in points])):
        for name in names:
            if names.count(name) > 1:
                raise table.problem(f"two {kind} have the name '{name}'")
    for support in supports:
        if not support.name.isidentifier() or support.name != support.name.lower():
            raise table.problem(f"the name '{support.name}' of a locator or clamp; expected lower-case letters, digits "
                                "and _, with which it is a set of an input file")
