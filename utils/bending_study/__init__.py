# SPDX-License-Identifier: GPL-3.0-or-later
"""The study of the paper on the bending test: docs/reports/bending_study.md. Not part of the installed package."""
