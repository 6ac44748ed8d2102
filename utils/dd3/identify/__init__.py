# SPDX-License-Identifier: GPL-3.0-or-later
"""Identification of parameters of materials from measured values."""
