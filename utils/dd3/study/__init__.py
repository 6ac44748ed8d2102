# SPDX-License-Identifier: GPL-3.0-or-later
"""Studies: parameters of an input file varied."""
