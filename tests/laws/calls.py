# SPDX-License-Identifier: GPL-3.0-or-later
#: []
"""The shared library of the laws in Python: materials by the interface of C, and UMAT."""

import argparse
import contextlib
import ctypes
import os
import sys
import tempfile
from pathlib import Path

import numpy as np

from dd3.programs import find_program

DOUBLES = ctypes.POINTER(ctypes.c_double)


@contextlib.contextmanager
def called(description):
    """Read the command line of a test; yield program, library and folder of the runs. Without the library, as in some
    builds, the test is skipped."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True, type=find_program)
    parser.add_argument("--library", required=True, type=Path)
    parser.add_argument("--work", type=Path, help="folder of the runs, kept")
    options = parser.parse_args()
    if not options.library.is_file():
        sys.exit(77)
    with tempfile.TemporaryDirectory() as name:
        folder = options.work or Path(name)
        folder.mkdir(parents=True, exist_ok=True)
        yield options.program, ctypes.CDLL(str(options.library.resolve())), folder


def pointer(array):
    """Return the address of an array."""
    return array.ctypes.data_as(DOUBLES)


class Material:
    """A material by the interface of C; its state is changed by update."""

    def __init__(self, library, text):
        """Make a material from a block *MATERIAL."""
        self.library, message = library, ctypes.create_string_buffer(2000)
        library.dd3laws_new.restype = ctypes.c_void_p
        made = library.dd3laws_new(text.encode(), None, message, ctypes.c_size_t(2000))
        assert made, message.value.decode()
        self.handle = ctypes.c_void_p(made)
        self.stress, self.tangent = np.zeros(6), np.zeros((6, 6), order="F")
        self.state = np.zeros(library.dd3laws_state_size(self.handle))

    def names(self):
        """Return the names of the internal variables, one for each component."""
        name, found = ctypes.create_string_buffer(200), []
        for i in range(len(self.state)):
            self.library.dd3laws_state_name(self.handle, i, name, ctypes.c_size_t(200))
            found.append(name.value.decode())
        return found

    def update(self, strain, time=0.0):
        """Integrate stress and state over a strain increment, in a time for laws of the strain rate."""
        strain, message = np.array(strain), ctypes.create_string_buffer(2000)
        code = self.library.dd3laws_update_timed(
            self.handle, pointer(strain), ctypes.c_double(time), pointer(self.stress), pointer(self.state),
            pointer(self.tangent), message, ctypes.c_size_t(2000))
        assert code == 0, message.value.decode()


class Umat:
    """The same by UMAT, called as Abaqus and CalculiX do; the material is in a file."""

    def __init__(self, library, text, folder, name="@ABAQUSNL_DD3LAWS@SHEET"):
        """Write the file of the materials."""
        (folder / "materials.dat").write_text(text, encoding="utf-8")
        os.environ["DD3_MATERIALS"] = str(folder / "materials.dat")
        self.library, self.name = library, name.ljust(80).encode()
        self.stress, self.tangent, self.state = np.zeros(6), np.zeros((6, 6), order="F"), np.zeros(64)
        self.smaller = 1.0

    def update(self, strain, shears=3, time=0.0):
        """Integrate stress and state over a strain increment."""
        strain, n, new, time = np.array(strain), 3 + shears, ctypes.c_double(1.0), ctypes.c_double(time)
        tangent = np.zeros((n, n), order="F")
        none, unused = None, ctypes.c_double(0.0)
        sizes = [ctypes.byref(ctypes.c_int(value)) for value in (3, shears, n, len(self.state))]
        energies, total = [ctypes.byref(unused)] * 4, pointer(np.zeros(6))
        self.library.umat_(
            pointer(self.stress), pointer(self.state), pointer(tangent), *energies, none, none, none, total,
            pointer(strain), none, ctypes.byref(time), none, none, none, none, self.name, *sizes, none,
            ctypes.byref(ctypes.c_int(0)), none, none, ctypes.byref(new), none, none, none, none, none, none, none,
            none, none, ctypes.c_int(80))
        self.tangent[:n, :n], self.smaller = tangent, new.value
