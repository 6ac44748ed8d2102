# SPDX-License-Identifier: GPL-3.0-or-later
"""Material of the input files of a part: a file of the user, one of the library by its name, or a mild steel that is
assumed."""
from collections.abc import Callable
from pathlib import Path

import numpy as np

from dd3 import places
from dd3.errors import Problem
from dd3.programs import run_points
from dd3.tools.blocks import Block, read_blocks

# Density of the assumed steel, t/mm3.
STEEL_DENSITY = 7.85e-9
STEEL = f"""# Replace this by your material; dd3 identify makes one from measurements.
*MATERIAL steel
  density = {STEEL_DENSITY:g}
  young = 2.1e5
  poisson = 0.3
  yield = von_mises
  hardening = swift K=530 Y0=150 n=0.22"""
ELASTIC = 2.1e5, 0.3  # of that steel
# Strain up to which the stress in plane strain is taken, and its steps; before, fine ones up to where the sheet yields.
STRAIN, STEPS = 1.0, 200
FIRST, FIRST_STEPS = 0.01, 20
POINT = """
*POINT tension
  material = {material}
  control = e11 e22 s33 s12 s23 s13
  target = {first} 0 0 0 0 0 steps={first_steps}
  target = {strain} 0 0 0 0 0 steps={steps}
"""


def library() -> Path:
    """Return the folder of the materials that come with the program."""
    return places.examples() / "materials"


def found(path: Path | None) -> Path | None:
    """Return the file of a material: a path, or the name of a file of the library."""
    if path is None or path.is_file():
        return path
    if path.name != str(path):
        raise Problem(f"{path}: no such file")
    file = library() / f"{path.name.removesuffix('.dat')}.dat"
    if not file.is_file():
        raise Problem(f"{path}: no such file, and no material of the library {library()}\n"
                      f"  expected: {' '.join(names())}")
    return file


def names() -> list[str]:
    """Return the names of the library's files."""
    return sorted(file.stem for file in library().glob("*.dat"))


def block_of(path: Path) -> Block:
    """Return the one material of a file."""
    blocks = [block for block in read_blocks(path) if block.keyword == "material"]
    if len(blocks) != 1:
        raise Problem(f"{path}: expected one *MATERIAL, found {len(blocks)}")
    return blocks[0]


def name_of(path: Path | None) -> str:
    """Return the name of the material of a file, or of the one that is assumed."""
    return "steel" if path is None else block_of(path).name


def text_of(path: Path | None) -> str:
    """Return the block of the material, or the line that includes its file."""
    return f'*INCLUDE "{path.resolve()}"' if path else STEEL


def density_of(path: Path | None) -> float | None:
    """Return the density of a material, t/mm3, None if its file has none."""
    if path is None:
        return STEEL_DENSITY
    text = block_of(path).value("density")
    return float(text) if text else None


def stiffness_of(path: Path | None) -> float:
    """Return the stiffness of a sheet in plane strain, E/(1 - nu^2), MPa."""
    young, poisson = ELASTIC
    if path is not None:
        young, poisson = (float(block_of(path).value(key) or 0.0) for key in ("young", "poisson"))
    return young / (1 - poisson**2)


def said(path: Path | None) -> tuple[str, str]:
    """Return the line of the report on the material."""
    if path is not None:
        return "material", f"{name_of(path)}, of {path}"
    return "material", ("a mild steel is assumed, von Mises, Swift K=530 Y0=150 n=0.22: give yours by --material FILE, "
                        f"or by its name in {library()}, such as dc06 (a mild steel), dp600 or aa6016_t4_yld2004")


def warnings(path: Path | None) -> list[str]:
    """Return what is to be said against a material: one without hardening, as files of yield criteria have it."""
    if path is None or (block_of(path).value("hardening") or "").split()[:1] != ["perfect"]:
        return []
    return [f"material {name_of(path)}: no hardening (perfect); its file is for the yield criterion: a sheet of it "
            "necks where it is first stretched. Give it the hardening of your sheet"]


def stress_of(program: Path, path: Path | None) -> Callable[[float], float]:
    """Return the stress by the strain in plane strain along x, MPa, of a material, by the program."""
    done, points = run_points(program, text_of(path) + POINT.format(
        material=name_of(path), first=FIRST, first_steps=FIRST_STEPS, strain=STRAIN, steps=STEPS))
    if "tension" not in points:
        raise Problem(f"the stress of the material is not found: {done.errors.strip()}")
    strain, stress = ([row[column] for row in points["tension"]] for column in ("e11", "s11"))
    return lambda value: float(np.interp(value, strain, stress))
