# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials at a point: curves, r-values, yield loci and forming limit curves by the library of the laws, libdd3laws.

    import dd3

    steel = dd3.material("dc06")
    steel.curve(0.3).plot(x="strain", y="stress")
    steel.r_values([0, 45, 90])
"""

import ctypes
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.optimize import brentq

from dd3 import places
from dd3.deck import text_of
from dd3.errors import LOG, Problem
from dd3.forming_limit_curve import LOW_CARBON, Curve, exponent_in, keeler_brazier
from dd3.tools.blocks import Block, blocks_of, lines_of, lines_of_text
from dd3.tools.set_material import found

if TYPE_CHECKING:
    import pandas as pd

LONGEST = 4000  # bytes of a message
CONVERGED, RETRY = 0, 1  # results of an update
ANGLES = tuple(range(0, 91, 15))  # to the rolling direction, degrees
STEP = 1e-6  # of the differences of the equivalent stress, over the stress
NEWTON, SOLVED, SMALLEST = 30, 1e-9, 2.0**-10  # iterations; residual over the stress; fraction of a step


def load(path: str | Path | None = None) -> ctypes.CDLL:
    """Return the library of the laws, by default the one that belongs to this package."""
    path = path or places.nearest(places.LIBRARY)
    if path is None:
        raise Problem("the library of the laws, libdd3laws.so, is not installed with this package; the build of the "
                      "program makes it (docs/laws_library.md)")
    library = ctypes.CDLL(str(path))
    for name in ("new", "read"):
        getattr(library, f"dd3laws_{name}").restype = ctypes.c_void_p
    for name in ("equivalent_stress", "flow_stress"):
        getattr(library, f"dd3laws_{name}").restype = ctypes.c_double
    return library


def pointer(values: np.ndarray) -> Any:
    """Return the address of an array of doubles."""
    return values.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def uniaxial(angle: float) -> np.ndarray:
    """Return the stress 11 22 33 12 13 23 of unit tension at an angle to the rolling direction, degrees."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    return np.array([c * c, s * s, 0.0, c * s, 0.0, 0.0])


class Material:
    """A material in its own axes: rolling, transverse and normal direction. Stresses are in MPa, in the order
    11 22 33 12 13 23, shear strains engineering strains. dd3.material makes one."""

    def __init__(self, text: str = "", *, file: str | Path | None = None, name: str | None = None,
                 library: ctypes.CDLL | None = None) -> None:
        self.library = library or load()
        said, of = ctypes.create_string_buffer(LONGEST), (name or "").encode() or None
        make, source = ((self.library.dd3laws_read, str(file)) if file else (self.library.dd3laws_new, text))
        handle = make(source.encode(), of, said, ctypes.c_size_t(LONGEST))
        if not handle:
            raise Problem(said.value.decode(errors="replace"))
        self.handle = ctypes.c_void_p(handle)
        self.state_size = int(self.library.dd3laws_state_size(self.handle))
        materials = [block for block in blocks_of(lines_of(file) if file else lines_of_text(text))
                     if block.keyword == "material" and (name or block.name).lower() == block.name.lower()]
        self.block: Block = materials[0]
        self.name = self.block.name

    @property
    def has_rate(self) -> bool:
        """Whether the flow stress depends on the strain rate."""
        return (self.block.value("rate") or "none").lower() != "none"

    def __del__(self) -> None:
        if getattr(self, "handle", None):
            self.library.dd3laws_free(self.handle)

    def __repr__(self) -> str:
        return f"<material {self.name}: {self.block.value('yield')}, {self.block.value('hardening')}>"

    @cached_property
    def state_names(self) -> list[str]:
        """The names of the internal variables."""
        said, names = ctypes.create_string_buffer(200), []
        for i in range(self.state_size):
            self.library.dd3laws_state_name(self.handle, i, said, ctypes.c_size_t(200))
            names.append(said.value.decode())
        return names

    def point(self) -> "Point":
        """Return a point of the material without stress and strain."""
        return Point(self)

    def equivalent_stress(self, stress: np.ndarray, state: np.ndarray | None = None) -> float:
        """Return the equivalent stress of a stress, MPa; state: the internal variables (zero)."""
        state = np.zeros(self.state_size) if state is None else state
        stress = np.ascontiguousarray(stress, float)
        return float(self.library.dd3laws_equivalent_stress(self.handle, pointer(stress), pointer(state)))

    def flow_stress(self, state: np.ndarray | None = None) -> float:
        """Return the flow stress, MPa; state: the internal variables (zero)."""
        state = np.zeros(self.state_size) if state is None else state
        return float(self.library.dd3laws_flow_stress(self.handle, pointer(state)))

    def curve(self, strain: float = 0.2, angle: float = 0.0, steps: int = 100, rate: float = 0.0) -> "pd.DataFrame":
        """Return the curve of tension at an angle to the rolling direction, degrees, to a logarithmic strain; below
        zero, of compression; rate: strain rate, 1/s, of a law of the rate (0: at rest). Columns: strain, stress (MPa),
        plastic_strain (equivalent). The axes of the material do not turn."""
        import pandas as pd
        if rate and not self.has_rate:
            LOG.warning(f"the material {self.name} has no law of the strain rate: rate = {rate:g} does not act")
        point, rows, along = self.point(), [(0.0, 0.0, 0.0)], uniaxial(angle)
        for _ in range(steps):
            point.pull(strain / steps, angle, abs(strain) / steps / rate if rate else 0.0)
            stress = along @ point.stress / (along @ along)
            rows.append((rows[-1][0] + strain / steps, float(stress), float(point.state[0])))
        frame = pd.DataFrame(rows, columns=["strain", "stress", "plastic_strain"])
        frame.attrs["units"] = {"strain": "-", "stress": "MPa", "plastic_strain": "-"}
        return frame

    def flow(self, stress: np.ndarray) -> np.ndarray:
        """Return the direction of the plastic strain rate at a stress, the gradient of the equivalent stress without
        internal variables, by central differences."""
        size = STEP * float(np.abs(stress).max())
        return np.array([(self.equivalent_stress(stress + step) - self.equivalent_stress(stress - step)) / (2 * size)
                         for step in size * np.eye(6)])

    def r_values(self, angles: Iterable[float] = ANGLES) -> "pd.Series[float]":
        """Return the r-values in tension at angles to the rolling direction, degrees, at the first yield."""
        import pandas as pd
        angles = list(angles)
        rates = [(self.flow(uniaxial(angle)), uniaxial(angle + 90)) for angle in angles]
        return pd.Series([float(across @ rate / rate[2]) for rate, across in rates], pd.Index(angles, name="angle"),
                         name="r")

    def yield_stresses(self, angles: Iterable[float] = ANGLES) -> "pd.Series[float]":
        """Return the yield stresses in tension at angles to the rolling direction, degrees, over the flow stress."""
        import pandas as pd
        angles = list(angles)
        return pd.Series([1 / self.equivalent_stress(uniaxial(angle)) for angle in angles],
                         pd.Index(angles, name="angle"), name="stress")

    def yield_locus(self, points: int = 180, shear: float = 0.0) -> "pd.DataFrame":
        """Return the yield locus in plane stress, a closed line: columns s11 and s22, over the flow stress. shear: s12
        over the flow stress."""
        import pandas as pd
        turn = np.linspace(0, 2 * np.pi, points + 1)
        rest = np.array([0.0, 0.0, 0.0, shear, 0.0, 0.0])
        if shear and self.equivalent_stress(rest) >= 1:
            largest = 1 / self.equivalent_stress(rest / shear)
            raise Problem(f"shear = {shear:g} is beyond the yield stress in shear, {largest:.4g} of the flow stress")
        rows = []
        for direction in np.stack([np.cos(turn), np.sin(turn)], axis=1):
            along = np.array([*direction, 0.0, 0.0, 0.0, 0.0])
            size = 1 / self.equivalent_stress(along)
            if shear:
                size = brentq(lambda length, along=along: self.equivalent_stress(length * along + rest) - 1, 0,
                              2 * size)
            rows.append(size * direction)
        return pd.DataFrame(rows, columns=["s11", "s22"])

    def flc(self, thickness: float = 1.0, n: float | None = None) -> Curve:
        """Return the forming limit curve: that of forming_limit in *MATERIAL; of low-carbon steel (its grade, or with
        `n`) that of Keeler and Brazier for a thickness, mm, and the exponent n of the hardening law. Its `limit` gives
        the major strain of a minor one."""
        points = self.block.value("forming_limit")
        if points and n is None:
            table = np.array(points.split(), float).reshape(-1, 2)
            return Curve(table[:, 0], table[:, 1], self.name)
        if (self.block.value("grade") or "").lower() == LOW_CARBON:
            n = n or exponent_in(self.block.value("hardening") or "")
        if n is None:
            raise Problem(f"no forming limit curve for the material {self.name}: give forming_limit in *MATERIAL, or, "
                          "of low-carbon steel, grade = low_carbon_steel and a hardening law with an exponent n, or n")
        return keeler_brazier(thickness, n)


class Point:
    """A point of a material: stress, internal variables and consistent tangent, which updates change."""

    def __init__(self, material: Material) -> None:
        self.material = material
        self.strain, self.stress, self.state = np.zeros(6), np.zeros(6), np.zeros(material.state_size)
        self.tangent = np.zeros((6, 6), order="F")
        self.said = ctypes.create_string_buffer(LONGEST)
        # The addresses once: an update takes a few microseconds.
        arrays = (self.strain, self.stress, self.state, self.tangent)
        self.arguments = (material.handle, *map(pointer, arrays), self.said, ctypes.c_size_t(LONGEST))

    def update(self, strain: np.ndarray | Sequence[float], time: float = 0.0) -> bool:
        """Integrate over a strain increment, 11 22 33 12 13 23, in a time, s, which a law of the strain rate needs (0:
        none, the rate is that of the state); return False, with stress and state unchanged, where a smaller one may
        succeed."""
        self.strain[:] = strain
        handle, along, *rest = self.arguments
        code = (self.material.library.dd3laws_update_timed(handle, along, ctypes.c_double(time), *rest) if time else
                self.material.library.dd3laws_update(*self.arguments))
        if code not in (CONVERGED, RETRY):
            raise Problem(f"{self.material.name}: {self.said.value.decode(errors='replace')}")
        return bool(code == CONVERGED)

    def pull(self, strain: float, angle: float = 0.0, time: float = 0.0) -> None:
        """Pull by a strain increment in a time at an angle to the rolling direction, with no other stress; in smaller
        steps where the integration asks for them."""
        done, part = 0.0, 1.0
        while done < 1 - 1e-12:
            part = min(part, 1 - done)
            if self.try_pull(part * strain, angle, part * time):
                done += part
            elif part < SMALLEST:
                raise Problem(f"{self.material.name}: no equilibrium in tension at {angle:g} degrees")
            else:
                part /= 2

    def try_pull(self, strain: float, angle: float, time: float = 0.0) -> bool:
        """Find the strain increment of a step of tension by Newton's method; return False, at the start of the step,
        where it does not converge."""
        start = self.stress.copy(), self.state.copy()
        along = uniaxial(angle)
        system = np.zeros((7, 7))
        system[:6, 6], system[6, :6] = -along, along
        found, force = strain * (along * (1 + 0.5) - 0.5 * np.array([1, 1, 1, 0, 0, 0])), 0.0
        for _ in range(NEWTON):
            self.stress[:], self.state[:] = start
            if not self.update(found, time):
                break
            residual = np.append(self.stress - force * along, along @ found - strain)
            size = max(np.abs(self.stress).max(), 1e-300)
            if np.abs(residual[:6]).max() <= SOLVED * size and abs(residual[6]) <= 1e-12:
                return True
            system[:6, :6] = self.tangent
            change = np.linalg.solve(system, residual)
            found, force = found - change[:6], force - change[6]
        self.stress[:], self.state[:] = start
        return False


def material(source: str | Path | Mapping[str, Any] | None = None, *, name: str | None = None, **keys: Any) -> Material:
    """Return a material: the function of the package, dd3.material."""
    if keys and not (source is None or isinstance(source, Mapping)):
        raise Problem(f"dd3.material takes '{str(source).partition(chr(10))[0]}' or keys of *MATERIAL, not both")
    if isinstance(source, Mapping) or keys:
        lines = {**(source if isinstance(source, Mapping) else {}), **keys}
        text = [f"*MATERIAL {name or 'material'}"]
        for key, value in lines.items():
            several = value if key == "backstress" and isinstance(value, list | tuple) else [value]
            text += [f"  {key.removesuffix('_')} = {text_of(one)}" for one in several]
        return Material("\n".join(text) + "\n")
    if source is None:
        raise Problem("dd3.material takes a file, the name of a material of the library, or keys of *MATERIAL")
    if "\n" in str(source):
        return Material(str(source), name=name)
    return Material(file=found(Path(source)), name=name)
