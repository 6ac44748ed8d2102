#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "utils_slow_0", "arguments": ["--first", "0"], "labels": ["utils", "slow"], "timeout": 1800, "cost": 130}
#: {"name": "utils_slow_1", "arguments": ["--first", "1"], "labels": ["utils", "slow"], "timeout": 1800, "cost": 260}
#: {"name": "utils_slow_2", "arguments": ["--first", "2"], "labels": ["utils", "slow"], "timeout": 1800, "cost": 50}
#: {"name": "utils_slow_3", "arguments": ["--first", "3"], "labels": ["utils", "slow"], "timeout": 1800, "cost": 170}
#: {"name": "utils_slow_4", "arguments": ["--first", "4"], "labels": ["utils", "slow"], "timeout": 1800, "cost": 130}
"""Tests of the Python package with the mark `slow`; the others are run by themselves, one for each file of utils.

    slow_utils.py --program build/release/dd3imp --work build/slow_utils --first 0       every fifth file
"""
import sys
from pathlib import Path

import pytest

from dd3.programs import parser_of_runs

STEP = 5  # of the files


def main():
    """Run them."""
    parser = parser_of_runs(__doc__)
    parser.add_argument("--first", required=True, type=int, choices=range(STEP), help="the first file of them")
    options = parser.parse_args()
    files = sorted(Path(__file__).parent.glob("utils/test_*.py"))[options.first::STEP]
    sys.exit(pytest.main(["-q", "-rs", "-p", "no:cacheprovider", "-m", "slow", "--program", str(options.program),
                          "--basetemp", str(options.work / "pytest"), *map(str, files)]))


if __name__ == "__main__":
    main()
