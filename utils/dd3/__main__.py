# SPDX-License-Identifier: GPL-3.0-or-later
"""The command as `python -m dd3`."""

from dd3.command import main

main()
