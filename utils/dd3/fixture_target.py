# SPDX-License-Identifier: GPL-3.0-or-later
"""The state of a part that is to have its nominal shape: free after its best fit, or as it is measured in its fixture,
clamped or free."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dd3.deviation import BORDER, Comparison, Face, nominal_face
from dd3.errors import Problem, Stopped
from dd3.fixture import LOCATORS, NONE, Fixture
from dd3.fixture_deck import write_deck
from dd3.line import surface_of_face
from dd3.nominal import normal_feet
from dd3.programs import command, launch
from dd3.sheet import Sheet
from dd3.springback import best_fit

BEYOND = 50.0  # continuation of the sheet for the tools, over its thickness
MOST_FITS, SETTLED = 100, 1e-5  # iterations of the alignment, and the relative gain of one that ends it
NAME = "clamped"  # of the input file of the part in its fixture


@dataclass
class Measured:
    """A part beside its nominal shape: initial and present places of the nodes of the measured face, mm, where they are
    to be, and which of them are compared."""

    initial: np.ndarray
    place: np.ndarray
    goal: np.ndarray
    compared: np.ndarray

    def distances(self) -> np.ndarray:
        """Return the distances of the compared nodes from where they are to be, mm."""
        return np.asarray(np.linalg.norm(self.goal - self.place, axis=1)[self.compared])


def lower_face(sheet: Sheet, step: int) -> tuple[np.ndarray, np.ndarray]:
    """Return initial and present positions of the nodes of the lower face at a step."""
    points = sheet.points(step)
    initial = sheet.initial(step)
    nodes = np.unique(sheet.faces(False, step))
    return initial[nodes], points[nodes]


def aligned(free: np.ndarray, drawn: np.ndarray, wanted: Any, mirror: Sequence[str], border: float
            ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return a free part in the place that fits a surface best, the closest points of the surface, and which nodes
    reach beyond its border by no more than a length: only these are compared.

    The iteration over closest points starts from the place that fits the drawn part best, node by node.
    Source: Besl and McKay, IEEE Trans. Pattern Anal. Mach. Intell. 14 (1992) 239-256.
    """
    place, last = best_fit(free, drawn, mirror), np.inf
    goal, beyond = normal_feet(place, wanted)
    for _ in range(MOST_FITS):
        goal[beyond > border] = place[beyond > border]
        mean = float(np.linalg.norm(goal - place, axis=1).mean())
        if mean > (1 - SETTLED) * last:
            break
        last = mean
        place = best_fit(place, goal, mirror)
        goal, beyond = normal_feet(place, wanted)
    return place, goal, beyond <= border


class Free:
    """The free part against the sheet under the tools of a first loop, after its best alignment."""

    def __init__(self, wanted: Face, mirror: Sequence[str], thickness: float) -> None:
        self.face, self.mirror, self.border = wanted, mirror, BORDER * thickness
        self.wanted, self.around = wanted.surface, surface_of_face(wanted, beyond=BEYOND * thickness)

    def measure(self, run: Path) -> Measured:
        """Return the part after a run."""
        last = Sheet(run)
        initial, free = lower_face(last, last.last)
        drawn = self.face.blank.at(self.face.points, initial)
        return self.beside(Measured(initial, free, drawn, np.ones(len(free), bool)))

    def beside(self, part: Measured) -> Measured:
        """Return a part after its best alignment with the wanted shape, beginning at that of its nodes with their
        goals. Nodes beyond the border of the wanted shape are to be on the continuation of this."""
        place, goal, compared = aligned(part.place, part.goal, self.wanted, self.mirror, self.border)
        if not compared.all():
            goal[~compared] = normal_feet(place[~compared], self.around)[0]
        return Measured(part.initial, place, goal, compared)

    def feet(self, place: np.ndarray, _: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
        """Return where places of the part are to be, and which of them are compared."""
        goal, beside = normal_feet(place, self.wanted)
        compared = beside <= self.border
        if not compared.all():
            goal[~compared] = normal_feet(place[~compared], self.around)[0]
        return goal, compared


class Target:
    """The part in a fixture, against the nominal shape of a first run, which later runs do not change."""

    def __init__(self, fixture: Fixture, drawn: Face, beyond: float) -> None:
        """drawn: the nominal shape if the fixture names none; beyond: continuation of it beyond its border, by which
        nodes there are corrected, mm."""
        self.fixture = fixture
        self.wanted: Face | None = None
        if not fixture.surface:
            given = fixture.run or fixture.at is not None
            self.wanted = nominal_face(fixture, drawn.sheet) if given else drawn
        self.around = None if self.wanted is None else surface_of_face(self.wanted, fixture.upper, beyond)
        self.nominal: Any = None  # of the last measurement

    @property
    def clamped(self) -> bool:
        """Whether the part is computed in its fixture, by clamps and gravity."""
        return self.fixture.alignment == LOCATORS and (bool(self.fixture.clamps) or self.fixture.gravity is not None)

    def measure(self, program: Path, run: Path, work: Path, options: Sequence[object]) -> Measured:
        """Return the part after a run; where it is clamped, the input file and its results are in the folder `work`."""
        sheet = Sheet(run)
        found = Comparison(self.fixture, sheet, sheet.last, self.wanted)
        if self.clamped:
            sheet = Sheet(self.run_clamped(program, found, work, options))
            found = Comparison(self.fixture, sheet, sheet.last, self.wanted)
        elif self.fixture.alignment != NONE:
            found.align()
        self.nominal = found.nominal
        place = found.motion.of(found.part.points)
        return Measured(found.part.initial, place, *self.feet(place, found.part.thickness))

    def feet(self, place: np.ndarray, thickness: float) -> tuple[np.ndarray, np.ndarray]:
        """Return where places of the part are to be, and which of them are compared."""
        goal, beside = normal_feet(place, self.nominal)
        compared = beside <= BORDER * thickness
        if self.around is not None and not compared.all():
            goal[~compared] = normal_feet(place[~compared], self.around)[0]
        return goal, compared

    def run_clamped(self, program: Path, found: Comparison, work: Path, options: Sequence[object]) -> Path:
        """Compute the part in its fixture; return the folder of the results."""
        deck = work / f"{NAME}.dat"
        write_deck(found, deck)
        folder = deck.with_suffix(".out")
        done = launch(command(program, deck, folder, ["--quiet", *options], {}), one_core=False)
        if done.code:
            raise (Stopped if done.code == 3 else Problem)(f"{deck}: {done.errors.strip()}")
        return folder
