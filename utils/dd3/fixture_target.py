# SPDX-License-Identifier: GPL-3.0-or-later
"""The state of a part that is to have its nominal shape: as it is measured in its fixture, clamped or free."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from dd3.deviation import BORDER, Comparison, Face, nominal_face
from dd3.errors import Problem, Stopped
from dd3.fixture import LOCATORS, NONE, Fixture
from dd3.fixture_deck import write_deck
from dd3.nominal import normal_distances, normal_feet, sheet_surface
from dd3.programs import command, launch
from dd3.sheet import Sheet

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


class Target:
    """The part in a fixture, against the nominal shape of a first run, which later runs do not change."""

    def __init__(self, fixture: Fixture, drawn: Sheet, beyond: float) -> None:
        """drawn: the sheet whose step with tools is the nominal shape if the fixture names none; beyond: continuation
        of it beyond its border, by which nodes there are corrected, mm."""
        self.fixture = fixture
        self.wanted: Face | None = None if fixture.surface else nominal_face(fixture, drawn)
        self.around = None if self.wanted is None else sheet_surface(self.wanted.sheet, self.wanted.step, beyond,
                                                                     fixture.upper)

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
        place = found.motion.of(found.part.points)
        distance, normals, beside = normal_distances(place, found.nominal)
        goal, compared = place - distance[:, None] * normals, beside <= BORDER * found.part.thickness
        if self.around is not None and not compared.all():
            goal[~compared] = normal_feet(place[~compared], self.around)[0]
        return Measured(found.part.initial, place, goal, compared)

    def run_clamped(self, program: Path, found: Comparison, work: Path, options: Sequence[object]) -> Path:
        """Compute the part in its fixture; return the folder of the results."""
        deck = work / f"{NAME}.dat"
        write_deck(found, deck)
        folder = deck.with_suffix(".out")
        done = launch(command(program, deck, folder, ["--quiet", *options], {}), one_core=False)
        if done.code:
            raise (Stopped if done.code == 3 else Problem)(f"{deck}: {done.errors.strip()}")
        return folder
