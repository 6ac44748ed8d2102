# SPDX-License-Identifier: GPL-3.0-or-later
"""The law of fracture of a table, from strains to fracture over the triaxiality, and the Lode angle if it is
measured."""

import re

import numpy as np

from dd3.columns import lines_of
from dd3.errors import Problem
from dd3.identify.fracture import COLUMNS, Tests, strains_to_fracture
from dd3.identify.least_squares import Points
from dd3.identify.measured_table import compared, knots_of, misfit, read_measured, straight_lines, values_of

SAME_LODE = 0.05  # largest difference of the Lode angles of a block
BLOCKS = 9  # of the law, at most
MISSED = 0.1  # difference over the measured value that is noted


def has_lode(path: str) -> bool:
    """Whether a table has a column of the Lode angle: by its heading, or without one a third number in its first
    row."""
    texts = [line.text.partition("#")[0] for line in lines_of(path)]
    for text in texts:
        if COLUMNS[1].heading.search(text):
            return True
        if COLUMNS[2].heading.search(text):
            return False
    first = next((text for text in texts if text.strip()), "")
    return len(re.findall(r"[^\s;,]+", first)) > 2


def read_points(path: str) -> tuple[Tests, bool]:
    """Return the tests of a table, and whether it has Lode angles."""
    lode = has_lode(path)
    columns = COLUMNS if lode else (COLUMNS[0], COLUMNS[2])
    values = values_of(read_measured(path, columns, 2))
    tests = Tests(*values) if lode else Tests(values[0], np.zeros(len(values[0])), values[1])
    for label, inside in blocks_of(tests, lode):
        count = len(knots_of(tests.triaxiality[inside]))
        if count < 2:
            raise Problem(f"{path}: error: tests at one triaxiality only{label}\n  expected: two triaxialities or more "
                          "at each Lode angle, or a table without the column of the Lode angle")
    return tests, lode


def blocks_of(tests: Tests, lode: bool) -> list[tuple[str, np.ndarray]]:
    """Return a text with the Lode angle, and the tests, of each block: those with nearly the same Lode angle."""
    if not lode:
        return [("", np.ones(len(tests.lode), bool))]
    ordered = np.sort(tests.lode)
    groups = np.split(ordered, np.flatnonzero(np.diff(ordered) > SAME_LODE) + 1)
    return [(f" at the Lode angle {group.mean():.4g}", (tests.lode >= group[0]) & (tests.lode <= group[-1]))
            for group in groups]


def table(tests: Tests, lode: bool, exponent: float, points: Points) -> tuple[str, list[str], list[str]]:
    """Return the text of the law, the table of values and notes: straight lines through at most eight triaxialities of
    each block, by least squares of the differences. `exponent`: that of the growth of the damage."""
    blocks = blocks_of(tests, lode)
    if len(blocks) > BLOCKS:
        raise Problem(f"fracture: error: {len(blocks)} Lode angles\n  expected: at most {BLOCKS}, those nearer than "
                      f"{SAME_LODE:g} counted once")
    start, words = float(knots_of(tests.triaxiality)[0]), []
    if len(blocks) > 1:
        words = [f"lode{k}={tests.lode[inside].mean():.6g}" for k, (_, inside) in enumerate(blocks, 1)]
    for _, inside in blocks:
        knots = knots_of(tests.triaxiality[inside])
        values = straight_lines(knots, tests.triaxiality[inside], tests.strain[inside])
        if knots[0] > start and len(blocks) > 1:  # blocks begin at one triaxiality; before its first test, constant
            knots, values = np.append(start, knots), np.append(values[0], values)
        words += [f"{knot:.6g}:{value:.6g}" for knot, value in zip(knots, values)]
    text = " ".join(["table", *words])
    found = strains_to_fracture(points, [text], tests.triaxiality, tests.lode)[0]
    if found is None:
        raise Problem(f"fracture: error: the program refuses {text}: {points.refusal}")
    lines = [compared(f"triaxiality {place:.3f}" + f", Lode {angle:.3f}" * lode, strain, value)
             for place, angle, strain, value in zip(*tests, found)]
    notes = [f"the strain to fracture at the triaxiality {place:.3f} is {value:.3g} in place of {strain:.3g}"
             for place, strain, value in zip(tests.triaxiality, tests.strain, found)
             if abs(value - strain) > MISSED * strain]
    if exponent > 1:
        text += f" exponent={exponent:g}"
    return text, [*lines, misfit(tests.strain, found, "strains")], notes
