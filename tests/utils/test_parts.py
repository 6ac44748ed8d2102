# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading of the set of parts: what is found of each, against what a die engineer says of it."""

import numpy as np
import pytest
from helpers import call
from part_set import PARTS, write

from dd3.errors import Problem
from dd3.gmsh_session import session
from dd3.part.reading import Request, read_part
from dd3.part.shape import angle_between
from dd3.part.units import unit_of_iges

# Angle up to which a direction is the expected one, degrees: that of a bracket is not unique.
NEAR = 50.0


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Write the parts."""
    folder = tmp_path_factory.mktemp("parts")
    write(folder)
    return folder


def reading_of(folder, name, **more):
    """Return the reading of a part."""
    with session() as gmsh:
        return read_part(gmsh, Request(folder / f"{name}.{PARTS[name].ending}", **more))


@pytest.mark.parametrize("name", PARTS)
def test_set(folder, name):
    """Check the reading of a part."""
    part, reading = PARTS[name], reading_of(folder, name)
    faults = " ".join(fault.text for fault in reading.faults)
    assert reading.unit == part.unit
    if part.kind == "several":
        assert f"{len(reading.parts)} parts" in faults and reading.direction is None
        return
    assert reading.sheet.kind == ("sheet" if part.kind == "flat" else part.kind) and reading.flat == (part.kind == "flat")
    if part.thickness is None:
        assert reading.sheet.thickness is None
    else:
        assert abs(reading.sheet.thickness / part.thickness - 1) < 1e-4
        assert len(reading.sheet.sides[0]) == len(reading.sheet.sides[1])
    if part.kind == "flat":
        assert "flat: nothing is to be formed" in faults
    elif part.toward is None:
        assert "undercut at faces" in faults and "not in one stroke from any direction" in faults
        assert reading.faults[0].faces and not reading.best.free
    else:
        assert not reading.faults
        assert angle_between(reading.direction.vector, np.array(part.toward, float)) < NEAR
        assert not reading_of(folder, name, toward=part.toward).faults
    assert bool(reading.bends) == part.bent
    assert len(reading.holes) == part.holes and len(reading.notches) == part.notches
    assert len(reading.symmetry) == part.symmetry
    if part.radius is not None:
        assert abs(reading.inner_radius[0] - part.radius) < 1e-3 * max(part.radius, 1)
