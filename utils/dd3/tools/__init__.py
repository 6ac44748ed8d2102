# SPDX-License-Identifier: GPL-3.0-or-later
"""Tool surfaces for dd3imp from CAD, meshes and profiles; the command is dd3 tool."""
