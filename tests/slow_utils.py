#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "utils_slow", "labels": ["utils", "slow"], "timeout": 1800, "cost": 300}
"""Tests of the Python package with the mark `slow`; the others are run by themselves, one for each file of utils.

    slow_utils.py --program build/release/dd3imp --work build/slow_utils
"""
import sys
from pathlib import Path

import pytest

from dd3.programs import parser_of_runs


def main():
    """Run them."""
    options = parser_of_runs(__doc__).parse_args()
    sys.exit(pytest.main(["-q", "-rs", "-p", "no:cacheprovider", "-m", "slow", "--program", str(options.program),
                          "--basetemp", str(options.work / "pytest"), str(Path(__file__).parent / "utils")]))


if __name__ == "__main__":
    main()
