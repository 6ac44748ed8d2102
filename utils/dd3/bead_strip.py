# SPDX-License-Identifier: GPL-3.0-or-later
"""Input file and tools of a strip that is drawn through a draw-bead in plane strain, of 1 mm width."""

from pathlib import Path

from dd3.bead_path import Bead
from dd3.laws import Material
from dd3.tools.shapes import read_shapes
from dd3.tools.surface import write

PULL, BEFORE, BEHIND = 4.0, 1.0, 1.0  # travel, sheet beyond the shoulders at its end and start, over Bead.half
BEYOND = 1.0  # length of the plates beyond the sheet, over Bead.half
SIDE = 4.0  # height of the sides of the bead, and depth of the groove below it, over its radius
WIDTH, OVER = 1.0, 5.0  # of the strip, mm; of the tools on each side
SIZE = 0.5  # length of an element over the thickness
DECK = """# A strip of 1 mm width, drawn through a draw-bead in plane strain. Restraint, N: grip_rx.
*TITLE
  Strip through a draw-bead

*PARAMETER
  height = {height:g}
  friction = {friction:g}
  pull = {pull:g}
  divisions = {divisions}

*MATERIAL {name}
{lines}

*BLANK strip
  origin = {start:g} 0 0
  size = {length:g} {width:g} {thickness:g}
  divisions = ${{divisions}} 1 1
  element = solid_shell
  thickness_points = 9
  material = {name}

{tools}*CONTACT

*BOUNDARY plane_strain
  set = all
  fix = y

*BOUNDARY grip
  set = x_max
  fix = z

*PHASE close
  control = bead
  trial = 0.05
  move = bead 0 0 -${{height}}
  hold = die
  hold = entry
  hold = exit
  displace = x_max x 0

*PHASE pull
  control = load
  trial = 0.005
  hold = bead
  displace = x_max x ${{pull}}

*HISTORY grip
  set = x_max
  quantities = displacement reaction

*HISTORY tail
  set = x_min
  quantities = displacement
"""
TOOL = """*TOOL {name}
  patches = "{name}.bez"
  friction = ${{friction}}
  contact = {side}

"""


def profile(name: str, axes: list[str]) -> str:
    """Return a shape file of a profile."""
    return "\n".join([f"*PROFILE {name}", "  axes = x z", *(f"  {line}" for line in axes),
                      f"  extrude = {-OVER:g} {WIDTH + OVER:g}", ""])


def profiles(bead: Bead) -> dict[str, list[str]]:
    """Return the profiles of die, bead and the two upper plates."""
    half, wall, top = bead.half, bead.radius + bead.clearance, bead.thickness + bead.radius
    start, end = -(PULL + BEFORE + BEYOND + 1) * half, (PULL + BEHIND + BEYOND + 1) * half
    side = bead.radius + bead.clearance / 4  # of the plates
    bottom, level = -SIDE * bead.radius - bead.height, bead.thickness + bead.gap
    high = top + SIDE * bead.radius
    return {"die": [f"start = {start:g} 0", f"corner = {-wall:g} 0 {bead.shoulder:g}", f"line = {-wall:g} {bottom:g}",
                    f"line = {wall:g} {bottom:g}", f"corner = {wall:g} 0 {bead.shoulder:g}", f"line = {end:g} 0"],
            "bead": [f"start = {bead.radius:g} {high:g}", f"line = {bead.radius:g} {top:g}",
                     f"arc = 0 {bead.thickness:g}  0 {top:g}", f"arc = {-bead.radius:g} {top:g}  0 {top:g}",
                     f"line = {-bead.radius:g} {high:g}"],
            "entry": [f"start = {-side:g} {level:g}", f"line = {start:g} {level:g}"],
            "exit": [f"start = {end:g} {level:g}", f"line = {side:g} {level:g}"]}


def write_strip(material: Material, bead: Bead, folder: Path) -> Path:
    """Write the input file strip.dat and its tools into a folder; return its path."""
    folder.mkdir(parents=True, exist_ok=True)
    shapes = profiles(bead)
    for name, lines in shapes.items():
        shape = folder / f"{name}.shape"
        shape.write_text(profile(name, lines), encoding="utf-8")
        write(folder / f"{name}.bez", read_shapes(shape), [f"{name} of a draw-bead, made by dd3 bead"])
    start, end = -(PULL + BEFORE + 1) * bead.half, (BEHIND + 1) * bead.half
    deck = folder / "strip.dat"
    deck.write_text(DECK.format(
        height=bead.height, friction=bead.friction, pull=PULL * bead.half, start=start, length=end - start, width=WIDTH,
        thickness=bead.thickness, divisions=round((end - start) / (SIZE * bead.thickness)), name=material.name,
        lines="\n".join(f"  {key} = {value}" for key, value in material.block.values),
        tools="".join(TOOL.format(name=name, side="z_min" if name == "die" else "z_max") for name in shapes)),
        encoding="utf-8")
    return deck
