# SPDX-License-Identifier: GPL-3.0-or-later
"""Import of LS-DYNA forming decks: cards, what they say, laws, process, and the input file."""
