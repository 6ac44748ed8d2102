# SPDX-License-Identifier: GPL-3.0-or-later
"""The interactive part of the page of a run: the sheet between its tools in 3D, its curves, their data."""
