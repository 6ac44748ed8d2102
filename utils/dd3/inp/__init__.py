# SPDX-License-Identifier: GPL-3.0-or-later
"""Reader of .inp files, the models of Abaqus and CalculiX: nodes, elements, sets, parts and their instances."""
