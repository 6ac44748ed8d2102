# SPDX-License-Identifier: GPL-3.0-or-later
"""dd3imp in Python: runs, their results, input files, materials; the command is `dd3`.

    import dd3

    run = dd3.simulate("bending.dat", set={"depth": 20}, threads=2)
    run.history.plot(x="travel", y="punch_fz")
    run.fields[-1].plot(scalars="equivalent_plastic_strain")
    run.report(mirror="x")
    dd3.material("dc06").curve(0.3)
"""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dd3 import deck
from dd3.deck import Deck
from dd3.errors import InputError, Message, Problem, Stopped
from dd3.run import Run
from dd3.simulation import simulate

if TYPE_CHECKING:
    from dd3.laws import Material

__all__ = ["Deck", "InputError", "Message", "Problem", "Run", "Stopped", "deck", "material", "open", "simulate"]
__version__ = "2.20.1"


def open(folder: str | Path) -> Run:
    """Return the run whose results are in a folder."""
    return Run(folder)


def material(source: str | Path | Mapping[str, Any] | None = None, *, name: str | None = None, **keys: Any
             ) -> "Material":
    """Return a material for its curves, r-values, yield loci and forming limit curve.

    source: a file with *MATERIAL, which may be a whole input file; the name of a material of the library, such as
    "dc06"; a text with *MATERIAL; or the keys of *MATERIAL. These may also be given as arguments, `yield_` for yield:

        dd3.material("dp600")
        dd3.material(young=2.1e5, poisson=0.3, yield_="hill48 r0=1.8 r45=1.5 r90=2.2",
                     hardening="swift K=530 e0=0.004 n=0.2")

    name: that of the block, where a file has several. Raises Problem with the messages of the program on wrong values,
    and where the library of the laws, libdd3laws.so, is not installed.
    """
    from dd3 import laws  # scipy, which runs do not need
    return laws.material(source, name=name, **keys)
