#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command dd3 of an installed tree: <bindir>/dd3 is a link to this file, beside which the package dd3 is."""
import sys

if sys.version_info < (3, 11):  # noqa: UP036
    sys.exit(f"error: dd3 needs Python 3.11 or later; {sys.executable} is {sys.version.split()[0]}")

from dd3.command import main

main()
