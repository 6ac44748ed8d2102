# SPDX-License-Identifier: GPL-3.0-or-later
"""Results of a run by place: fields at named points of the blank and along its sections, and by the forming limit."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from dd3 import forming_limit, springback
from dd3.errors import LOG, Problem
from dd3.forming_limit_curve import ZONES
from dd3.nominal import InitialFace, initial_face
from dd3.run import read_job
from dd3.scatter.statistics import Bands
from dd3.sheet import Sheet, length, of_pieces, plane
from dd3.study.vary import result, value_of

SPRINGBACK, FORMING_LIMIT = "springback", "forming_limit"
AT, ALONG = "@", " along "
BESIDE = 1e-3  # distance of a point from the blank that is round-off, over its size
COUNT = 101  # points along a section


class Map(NamedTuple):
    """A field on the upper face of a sheet: the sheet, the step of its mesh, the values at all nodes, and its name with
    the unit."""

    sheet: Sheet
    step: int
    values: np.ndarray
    label: str


def field_map(run: Path, field: str, mirror: Sequence[str]) -> Map:
    """Return a field at the end of a run; springback: distance from the drawn shape after the best fit, mm."""
    sheet = Sheet(run)
    if field != SPRINGBACK:
        return Map(sheet, sheet.last, *sheet.component(sheet.last, field))
    phases = read_job(run)["phases"]
    found = springback.find(sheet, phases, mirror)
    if found is None:
        raise Problem(f"{run}: no springback, as "
                      + (springback.unfinished(phases) or "its last phase does not release the sheet from tools"))
    return Map(sheet, found.step, found.distance(), f"{SPRINGBACK} (mm)")


def fit_of(run: Path, mirror: Sequence[str]) -> str:
    """Return words on the best fit of the springback of a run."""
    found = springback.find(Sheet(run), read_job(run)["phases"], mirror)
    return f"{SPRINGBACK}: distance after the best fit{springback.kept(found.mirror) if found else ''}"


def at_point(field: Map, place: Sequence[float]) -> float:
    """Return a field at a point (x, y) of the blank before the run."""
    nodes = np.unique(field.sheet.faces(True, field.step))
    start = field.sheet.start(field.step)[nodes]
    beside = np.maximum(start[:, :2].min(axis=0) - place, place - start[:, :2].max(axis=0)).max()
    if beside > BESIDE * field.sheet.size():
        raise Problem(f"the place ({place[0]:g}, {place[1]:g}) lies beside the blank")
    blank = InitialFace(start * (1.0, 1.0, 0.0), initial_face(field.sheet, field.step, upper=True).triangles)
    return float(blank.at(field.values[nodes], np.array([[*place, 0.0]]))[0])


def along(field: Map, text: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the lengths along the section of the blank by a plane such as y=0 before the run, and the field there."""
    line = field.sheet.cut(*plane(text), step=field.step)[0]
    lengths = length(line.at(field.sheet.start(field.step)))
    return lengths, line.at(field.values[:, None])[:, 0]


def over_limit(run: Path) -> float:
    """Return the largest major strain over the limit at its minor strain, of nodes and elements at the middle of the
    sheet; above 1 the sheet splits by the forming limit curve of its material."""
    sheet, criteria = Sheet(run), forming_limit.Criteria()
    limits = forming_limit.find_limits(sheet, read_job(run), criteria)
    if not limits.curves():
        raise Problem(f"{run}: {limits.why}; expected grade or forming_limit in *MATERIAL")
    strains = forming_limit.strains_of(sheet, sheet.last, "middle")
    major, minor, _ = strains.joined()
    largest = 0.0
    for number, curve in limits.by_material.items() or {0: limits.curves()[0]}.items():
        judged = curve.zones(major, minor, criteria.margin) > ZONES.index("thickening")
        if number:
            judged &= strains.of_material(number)
        largest = float((major[judged] / curve.limit(minor[judged])).max(initial=largest))
    return largest


def scalar(run: Path, name: str, places: Mapping[str, Sequence[float]], mirror: Sequence[str]) -> float:
    """Return a result of a run: FIELD@PLACE, forming_limit, or what `dd3 study` takes."""
    if name == FORMING_LIMIT:
        return over_limit(run)
    field, sign, place = name.partition(AT)
    if not sign:
        return value_of(run, *result(name))[0]
    if place not in places:
        raise Problem(f"no place '{place}' for the result '{name}'; there are: {', '.join(places) or 'none'}")
    return at_point(field_map(run, field, mirror), places[place])


def profiles(runs: Sequence[Path], name: str, mirror: Sequence[str]) -> tuple[np.ndarray, np.ndarray, str]:
    """Return the lengths along a section, mm, the results of the runs there (runs, places), FIELD along PLANE, and the
    name of the field with its unit."""
    field, sign, text = name.partition(ALONG)
    if not sign:
        raise Problem(f"'{name}' is no band; expected FIELD along PLANE, such as thinning along y=0")
    fields = [field_map(run, field, mirror) for run in runs]
    for one in fields:
        if said := of_pieces(one.sheet.cut(*plane(text), step=one.step), one.sheet.start(one.step)):
            LOG.warning(f"{one.sheet.path}: section {text}: {said}")
            break
    lines = [along(one, text) for one in fields]
    lengths = np.linspace(0, min(line[0][-1] for line in lines), COUNT)
    return lengths, np.array([np.interp(lengths, *line) for line in lines]), fields[0].label


def draw(axes: Axes, lengths: np.ndarray, found: Bands, label: str) -> None:
    """Draw the band of a result along a section: mean, and from the lowest to the highest quantile."""
    axes.fill_between(lengths, found.quantiles[0], found.quantiles[-1], color="#0072b2", alpha=0.25,
                      label="5 to 95 % of the runs")
    axes.plot(lengths, found.mean, color="#0072b2", linewidth=1.3, label="mean")
    axes.set(xlabel="along the section of the blank (mm)", ylabel=label)
    axes.grid(True, color="0.9")
    axes.legend(frameon=False, fontsize="small")
