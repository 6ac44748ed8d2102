# SPDX-License-Identifier: GPL-3.0-or-later
"""Plotters of PyVista that need no display."""

import ctypes
import os
import sys
from typing import Any

import matplotlib

from dd3.errors import DEBIAN, Problem

# Any of these libraries lets VTK draw without a display; without one, creating its window is a segmentation fault.
LIBRARIES = ("libEGL.so.1", "libOSMesa.so.8", "libOSMesa.so.6")

# Light on sheets and tools; colours of their outer and sharp edges, and of the edges of elements.
SURFACE = {"ambient": 0.4, "diffuse": 0.7, "specular": 0.15, "specular_power": 20}
EDGE, MESH = "#3a3f45", "#808488"
FONT = matplotlib.get_data_path() + "/fonts/ttf/DejaVuSans.ttf"  # that of the figures


class NoOpenGL(Problem):
    """The system has no library that draws."""


def is_there(library: str) -> bool:
    """Tell whether a shared library can be loaded."""
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def new_plotter(**options: Any) -> Any:
    """Return a plotter that draws into a picture; `options` are those of pyvista.Plotter."""
    if sys.platform == "linux" and not os.environ.get("DISPLAY") and not any(map(is_there, LIBRARIES)):
        raise NoOpenGL(f"pictures need the library EGL of the system; on Debian or Ubuntu: apt-get install {DEBIAN}")
    import pyvista as pv
    from vtkmodules.vtkCommonCore import vtkLogger
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
    pv.OFF_SCREEN = True
    return pv.Plotter(off_screen=True, **options)


def use_font(text: Any) -> None:
    """Set the font of a property of VTK's texts to that of the figures."""
    text.SetFontFamilyAsString("File")
    text.SetFontFile(FONT)
