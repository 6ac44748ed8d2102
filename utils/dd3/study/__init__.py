# SPDX-License-Identifier: GPL-3.0-or-later
"""The bending study of docs/reports/bending_study.md."""
