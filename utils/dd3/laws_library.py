# SPDX-License-Identifier: GPL-3.0-or-later
"""The constitutive laws of the program at a point, by its library libdd3laws (docs/laws_library.md)."""

import ctypes
from pathlib import Path

import numpy as np

from dd3 import places
from dd3.errors import Problem

LONGEST = 4000  # bytes of a message
CONVERGED, RETRY = 0, 1  # results of an update


def load() -> ctypes.CDLL:
    """Return the library that belongs to this package."""
    path = places.nearest(places.LIBRARY)
    if path is None:
        raise Problem("the library of the laws, libdd3laws.so, is not installed with this package; the build of the "
                      "program makes it (docs/laws_library.md)")
    library = ctypes.CDLL(str(path))
    library.dd3laws_read.restype = library.dd3laws_new.restype = ctypes.c_void_p
    library.dd3laws_free.argtypes = library.dd3laws_state_size.argtypes = [ctypes.c_void_p]
    library.dd3laws_update.argtypes = [ctypes.c_void_p] * 6 + [ctypes.c_size_t]
    return library


class Material:
    """A material of a file, which may be a whole input file, or of a text; `name`: that of its block, if it has
    several."""

    def __init__(self, file: str | Path | None = None, name: str | None = None, text: str | None = None) -> None:
        self.library, said = load(), ctypes.create_string_buffer(LONGEST)
        make = self.library.dd3laws_new if file is None else self.library.dd3laws_read
        handle = make(str(text if file is None else file).encode(), (name or "").encode(), said,
                      ctypes.c_size_t(LONGEST))
        if not handle:
            raise Problem(said.value.decode(errors="replace"))
        self.handle = ctypes.c_void_p(handle)
        self.state_size = int(self.library.dd3laws_state_size(self.handle))

    def __del__(self) -> None:
        if getattr(self, "handle", None):
            self.library.dd3laws_free(self.handle)

    def point(self) -> "Point":
        """Return a point without stress and plastic strain."""
        return Point(self)


class Point:
    """A point of a material in its axes, 11 22 33 12 13 23: stress, internal variables (equivalent plastic strain
    first) and consistent tangent, d stress_i/d strain_j with engineering shear strains, which an update changes."""

    def __init__(self, material: Material) -> None:
        self.material = material
        self.strain, self.stress, self.state = np.zeros(6), np.zeros(6), np.zeros(material.state_size)
        self.tangent = np.zeros((6, 6), order="F")
        self.said = ctypes.create_string_buffer(LONGEST)
        arrays = (self.strain, self.stress, self.state, self.tangent)
        self.arguments = (material.handle, *(array.ctypes.data for array in arrays), ctypes.addressof(self.said), LONGEST)

    def update(self, strain: np.ndarray | list[float]) -> bool:
        """Integrate over a strain increment; return False, with stress and state unchanged, where a smaller one may
        succeed."""
        self.strain[:] = strain
        code = self.material.library.dd3laws_update(*self.arguments)
        if code not in (CONVERGED, RETRY):
            raise Problem(self.said.value.decode(errors="replace"))
        return bool(code == CONVERGED)
