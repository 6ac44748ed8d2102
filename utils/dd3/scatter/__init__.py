# SPDX-License-Identifier: GPL-3.0-or-later
"""Scatter of forming runs: samples of inputs, statistics of results, and the inputs that matter."""
