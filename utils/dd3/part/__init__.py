# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading of a sheet part as a die engineer reads it: thickness, sides, press direction, floor, walls, flange,
holes."""
