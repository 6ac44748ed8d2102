# SPDX-License-Identifier: GPL-3.0-or-later
"""Faults of CAD as docs/mending.md tells them, and what mends them by options."""
import pytest
from broken_parts import BROKEN, write
from helpers import call

# File, its options, whether it is refused, and what is said.
SAID = [("gap", (), 2, "0.05 mm apart, the widest between faces 35 and 14; --sew 0.055 joins them"),
        ("gap", ("--sew", 0.055), 0, "sheet of 1 mm (95 % of its sides)"),
        ("wide_gap", ("--sew", 0.45), 0, "sheet of 1 mm"),
        ("missing", (), 2, "the faces are 1 mm apart, as both sides of a sheet, but the shell is open beside faces 14 21"),
        ("doubled", (), 0, "doubled faces left out: 36 (on 22)"),
        ("doubled", (), 0, "sheet of 1 mm (100 % of its sides)"),
        ("inner", (), 2, "2 parts"), ("merged", (), 2, "2 parts"), ("merged", ("--part", 1), 0, "sheet of 1 mm"),
        ("metres", (), 0, "--scale 1000"), ("metres", ("--scale", 1000), 0, "sheet of 1 mm")]


@pytest.fixture(scope="module")
def paths(tmp_path_factory):
    """Write the files."""
    folder = tmp_path_factory.mktemp("broken")
    return write(folder, BROKEN)


@pytest.mark.parametrize("name, options, code, text", SAID)
def test_said(paths, tmp_path, name, options, code, text):
    """Check what is said of a file."""
    said = call("part", paths[name], tmp_path / "reading", *options, expect=code)
    assert text in said, said


def test_one_side(paths, tmp_path):
    """Check that tools are made of the whole side of a sheet one of whose faces is missing."""
    said = call("tool", paths["missing"], tmp_path / "tools", "--faces", 25, "--smooth", "--thickness", 1)
    assert "travel     26 mm" in said and "not estimated" not in said, said
