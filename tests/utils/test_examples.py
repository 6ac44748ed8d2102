# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies of the examples by `dd3 example`."""

import subprocess

import pytest
from helpers import ROOT, call

EXAMPLES = sorted(path.name for path in (ROOT / "input_files").iterdir() if path.is_dir() and path.name != "materials")


@pytest.mark.parametrize("name", EXAMPLES)
def test_materials_are_copied(program, tmp_path, name):
    """The input files of a copy find the materials that they include."""
    call("example", name, "--into", tmp_path)
    for deck in (tmp_path / name).glob("*.dat"):
        done = subprocess.run([program, "--check", "--quiet", deck], capture_output=True, text=True, check=False)
        missing = [line for line in done.stderr.splitlines() if "cannot read the input file" in line]
        assert not [line for line in missing if "/materials/" in line]
