#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "utils_slow_0", "arguments": ["--third", "0"], "labels": ["utils", "slow"], "timeout": 1800, "cost": 180}
#: {"name": "utils_slow_1", "arguments": ["--third", "1"], "labels": ["utils", "slow"], "timeout": 1800, "cost": 280}
#: {"name": "utils_slow_2", "arguments": ["--third", "2"], "labels": ["utils", "slow"], "timeout": 1800, "cost": 100}
"""Tests of the Python package with the mark `slow`; the others are run by themselves, one for each file of utils.

    slow_utils.py --program build/release/dd3imp --work build/slow_utils --third 0       every third file
"""
import sys
from pathlib import Path

import pytest

from dd3.programs import parser_of_runs


def main():
    """Run them."""
    parser = parser_of_runs(__doc__)
    parser.add_argument("--third", required=True, type=int, choices=(0, 1, 2), help="the first file of them")
    options = parser.parse_args()
    files = sorted(Path(__file__).parent.glob("utils/test_*.py"))[options.third::3]
    sys.exit(pytest.main(["-q", "-rs", "-p", "no:cacheprovider", "-m", "slow", "--program", str(options.program),
                          "--basetemp", str(options.work / "pytest"), *map(str, files)]))


if __name__ == "__main__":
    main()
