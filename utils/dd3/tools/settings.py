# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the tools that are made of a file, and their checks."""
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from dd3.errors import Problem
from dd3.tools.facet_files import SUFFIXES as FACETS

CAD = (".step", ".stp", ".iges", ".igs", ".brep", ".brp")
DRAW = "draw.dat"  # input file of a set of tools
# Largest distance of a surface from CAD, and estimated one of facets, mm.
TOLERANCE = {"cad": 0.002, "facets": 0.02, "shape": 0.002}
OPEN: Any = None  # a size that is not given, and found before it is used


@dataclass
class ToolSettings:
    """What tools are made of a file, and how; lengths in mm.

    source: CAD, mesh or shape file. target: .bez file to write, or of a part the folder of its tools; None: neither.
    toward: direction from the tool to the sheet, or from a part to the punch. scale: factor on the coordinates.
    rotate: axes with angles, x y z degrees, one rotation after the other. move: after them. sew: largest gap between
    free edges that are joined. tolerance: largest distance from the file's surface. offset: along the normals. radius:
    least convex radius. turn: the normals at the end. part: names or numbers of the parts to take. faces: numbers of
    the faces of CAD to take; smooth: with those that join them smoothly. picture: file of a picture.

    Of the set of tools of a part: thickness of the sheet, clearance, radius of the shoulder, widths of flange and
    margin, all of these by the part where they are not given; beads: propose draw-beads by the estimate of the blank,
    if it is the path ".", or by a finished run; program: the program that checks the input file; side: the tool that
    touches the faces, punch or die; material: file, or name of the library; symmetric: the input file computes the
    half or quarter x, y > 0 of a part with planes of symmetry there.
    """

    source: Path
    target: Path = OPEN
    toward: Sequence[float] = OPEN
    scale: float = 1.0
    rotate: Sequence[Sequence[float]] = ()
    move: Sequence[float] = (0.0, 0.0, 0.0)
    sew: float | None = None
    tolerance: float = OPEN
    offset: float = 0.0
    radius: float = OPEN
    turn: bool = False
    part: list[str] | None = None
    faces: list[str] = OPEN
    smooth: bool = False
    picture: Path | None = None
    thickness: float = OPEN
    clearance: float = OPEN
    shoulder: float = OPEN
    flange: float | None = None
    margin: float = OPEN
    beads: Path = OPEN
    program: str | Path | None = None
    side: str = OPEN
    material: Path | None = None
    symmetric: bool = False
    whole: bool = field(default=False, init=False)  # the set of tools of a part, not one tool
    # What the reading of a part finds: the part without its openings, the faces that one tool touches, its rims and
    # holes, the axes of the tools normal to planes of symmetry at 0, the roles of faces, angles and radii of sharp
    # edges, projected areas of what is seen from a direction, and why there can be no die around it.
    closed: Any = field(default=None, init=False)
    taken: Any = field(default=None, init=False)
    curves: list[np.ndarray] = field(default_factory=list, init=False)
    holes: Sequence[Any] = field(default=(), init=False)
    mirrors: tuple[int, ...] = field(default=(), init=False)
    roles: dict[int, str] = field(default_factory=dict, init=False)
    angles: dict[int, float] = field(default_factory=dict, init=False)
    sharp: dict[int, float] = field(default_factory=dict, init=False)
    visible: dict[int, float] = field(default_factory=dict, init=False)
    seen: str = field(default="", init=False)
    advice: str = field(default="", init=False)
    longest: float = field(default=np.inf, init=False)  # side of a patch along the rim

    @property
    def kind(self) -> str:
        """The kind of the source by its ending: cad, shape or facets."""
        ending = self.source.suffix.lower()
        if ending in CAD:
            return "cad"
        if ending == ".shape":
            return "shape"
        if ending in FACETS:
            return "facets"
        raise Problem(f"{self.source}: unknown kind of file; expected one of {' '.join((*CAD, *FACETS))} .shape")

    def __post_init__(self) -> None:
        self.check_file()
        of_part = self.kind == "cad" and self.target is not None and not self.target.suffix
        self.whole = bool(self.thickness) or of_part
        self.check()
        self.side = self.side or "punch"
        self.tolerance = self.tolerance or TOLERANCE[self.kind]

    def check_file(self) -> None:
        """Check that the source is a file."""
        if not self.source.exists():
            raise Problem(f"{self.source}: no such file")
        if not self.source.is_file():
            raise Problem(f"{self.source}: not a file")
        if not self.source.stat().st_size:
            raise Problem(f"{self.source}: the file is empty")

    def check(self) -> None:
        """Check the values; their names in messages are those of the options of the command."""
        if self.target and not self.whole and self.target.suffix != ".bez":
            raise Problem(f"{self.target}: the name of a tool surface ends in .bez")
        if self.toward and not np.any(self.toward):
            raise Problem("--toward takes a direction")
        for name in ("scale", "sew", "tolerance", "radius", "thickness", "shoulder", "flange", "margin"):
            if getattr(self, name) is not None and not 0 < getattr(self, name) < np.inf:
                raise Problem(f"--{name} takes a positive number")
        if any(not np.any(axis) for *axis, _ in self.rotate):
            raise Problem("--rotate takes an axis and an angle")
        for name in ("thickness", "faces", "radius"):
            if getattr(self, name) and self.kind != "cad":
                raise Problem(f"--{name} takes CAD: {' '.join(CAD)}")
        if self.smooth and not self.faces:
            raise Problem("--smooth goes with --faces")
        for name in ("clearance", "shoulder", "flange", "margin", "side", "material", "beads"):
            if getattr(self, name) is not None and not self.whole:
                raise Problem(f"--{name} goes with a folder, or --thickness")
        if self.symmetric and not self.whole:
            raise Problem("--symmetric goes with a folder, or --thickness")
        if self.whole:
            self.check_set()

    def check_set(self) -> None:
        """Check the values of a set of tools."""
        for name in ("offset", "turn"):
            if getattr(self, name):
                raise Problem(f"--{name} is for one tool")
        if self.toward and self.rotate:
            raise Problem("--toward and --rotate: of a part either of them gives the direction of the punch")
        if self.target and self.target.suffix:
            raise Problem(f"{self.target}: with --thickness a folder of punch, die, holder and {DRAW}")
        if self.clearance is not None and not 0 <= self.clearance < np.inf:
            raise Problem("--clearance takes a number that is not negative")
