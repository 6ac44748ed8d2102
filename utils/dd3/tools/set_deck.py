# SPDX-License-Identifier: GPL-3.0-or-later
"""Input file that draws a part with the tools that were made of it, and releases it."""
from collections.abc import Sequence

import numpy as np

from dd3.curve import write_curves
from dd3.mesh import Mesh, write_inp
from dd3.tools import set_material, symmetry
from dd3.tools.beads import Beads
from dd3.tools.pad_force import Pin, axes_of
from dd3.tools.set_blank import Blank
from dd3.tools.settings import ToolSettings
from dd3.tools.tool_set import ToolSet

# Elements of the undivided blank, about; length of the smallest ones over the least radius of the tools, on which one
# turns by 19 degrees, and over the thickness at least; height of an arc of that radius over its chord in an element,
# over the thickness, at most (the program warns of more by W109); most levels.
ELEMENTS, OF_RADIUS, OF_THICKNESS, SAG, LEVELS = 1000, 1 / 3, 1.0, 0.1, 4
# Elements around a blank that is cut.
AROUND = 2.0
# Pressure of the holder, MPa.
PRESSURE = 2.0
# Distance from the sheet at which the holder is pressed, over the thickness.
SHORT = 0.1
# Coefficient of friction.
FRICTION = 0.1
# Acceleration on the earth, mm/s2.
EARTH = 9810.0
DECK = """# Draws {part} and releases it; tools by {command}
# The highest point of the die's binder, without a holder that of the die, is at z = 0; the punch starts at the blank
# and moves down.{part_of}
*TITLE
  {part}

*PARAMETER
  tools = .             # folder of the tools
{sizes}  levels = {levels}            # which are divided where the tools are curved, down to {smallest:.2g} mm
  points = 5            # through the thickness
  depth = {travel}
{forces}  friction = {friction:g}

{material}

{sheet}  adaptive = ${{levels}}
  element = solid_shell
  thickness_points = ${{points}}
  material = {name}
{cut}
{tools}{beads}*CONTACT

{symmetry}{support}{pins}{gravity}{closing}{clamp}*PHASE draw
  control = punch
  trial = 1.0
  move = punch 0 0 -${{depth}}
  keep = on

*PHASE springback
  unload = on
{light}
*OUTPUT
  fields = every 5 mm
"""
SIZES = """  thickness = {thickness:g}
  divisions = {divisions} 1     # elements of {length:.2g} mm
"""
LEVEL_SHEET = """*BLANK sheet
  origin = {origin} 0
  size = {size} ${{thickness}}
  divisions = ${{divisions}}
"""
# A box in the plane of the binder, in elements of that length.
INCLINED_SHEET = """# It lies on the inclined binder; elements of {length:.2g} mm.
*MESH sheet
  file = "{file}"
"""
TOOL = """*TOOL {name}
  patches = "${{tools}}/{name}.bez"
  friction = ${{friction}}
  contact = {contact}

"""
CONTACT = {"punch": "z_max", "die": "z_min", "holder": "z_max", "pad": "z_min"}
# Friction holds the sheet sideways, once the holder or a pad is on it.
SUPPORT = """# The middle of the blank does not move sideways, as it lies freely on the die at first.
*SET middle
  near = {middle}

"""
ASIDE = "  displace = middle {axis} 0\n"
FREE = "  free = middle {axes}\n"
# Without holder and pad.
HELD = """*BOUNDARY middle
  set = middle
  fix = {axes}

"""
# The nodes of the lower face nearest to the middles of the holes.
PIN = """# Locating pin in the hole {words}, with which the blank has to be pierced.
*SET pin_{number}
  near = {place} 0

*BOUNDARY pin_{number}
  set = pin_{number}
  fix = {fixed}
  pin = {diameter:.4g}

"""
GRAVITY = """# The blank is laid on the die by its weight.
*PHASE gravity
  control = load
  trial = 0.1
  hold = die
  hold = punch
  hold = holder
  gravity = 0 0 -{earth:g}
{aside}
"""
BLANK, MESH = "blank.txt", "blank.inp"  # outline of the blank; its mesh, if it does not lie level
CUT = """
*TRIM blank
  file = "{file}"
"""
NORMAL = "  along = 0 0 0         # normal to the sheet\n"
CLOSING = """# The holder bends the blank onto the die.
*PHASE close
  control = holder
  trial = 1.0
  hold = die
  hold = punch
  move = holder 0 0 -{closing:.6g}
{aside}
"""
CLAMP = """*PHASE clamp
  control = load
  trial = 1.0
  hold = die
  hold = punch
{presses}{free}
"""
# A holder that moves down onto an incline slides on the blank, and the blank on the die.
TOUCH = """# The holder touches the blank.
*PHASE touch
  control = load
  trial = 1.0
  hold = die
  hold = punch
  press = holder 0 0 -{force:.3g}
{aside}
"""
TOUCHING = 0.1  # its force over that of the holder


def deck(options: ToolSettings, tools: ToolSet, beads: Beads, command: str) -> str:
    """Return the input file: tools, draw-beads, the command that made these."""
    (low, high), divisions, levels, length = divided(options, tools)
    pressed = {name: PRESSURE * tools.area[name] for name in ("holder", "pad") if name in tools.surfaces}
    pressed |= {"pad": tools.pad_force} if "pad" in pressed and tools.pad_force else {}
    axes = symmetry.ends_at(options)
    part = 0.5**len(axes)
    forces = [f"  {name} = {part * force:.3g}     # N, {force / tools.area[name]:.2g} MPa\n"
              for name, force in pressed.items()]
    forces += [f"  bead = {beads.force:.3g}            # N/mm, restraint of the draw-beads\n",
               f"  lift = {beads.lift:.3g}            # N/mm, by which they press the sheet on the die\n"
               ] if beads.lines else []
    presses = [f"  press = {name} 0 0 {'-' if name == 'holder' else ''}${{{name}}}\n" for name in pressed]
    inclined = tools.blank.inclined
    middle = np.where([axis in axes for axis in (0, 1)], 0.0, (low + high) / 2)
    free = [name for axis, name in enumerate(symmetry.AXES) if axis not in axes]
    support = (SUPPORT.format(middle=pair(tools.blank.placed(middle[None])[0]))
               if free and (tools.closing or inclined or not pressed) else "")
    support += HELD.format(axes=" ".join(free)) if free and not pressed else ""
    aside = "".join(ASIDE.format(axis=axis) for axis in free)
    closing = (TOUCH.format(force=TOUCHING * pressed["holder"], aside=aside) if inclined else
               CLOSING.format(closing=tools.closing - SHORT * options.thickness, aside=aside) if tools.closing else "")
    weighs = tools.closing > 0 and set_material.density_of(options.material) is not None
    sheet = (INCLINED_SHEET.format(file=MESH, length=length) if inclined
             else LEVEL_SHEET.format(origin=pair(low), size=pair(high - low)))
    return DECK.format(part=options.source.stem, command=command, symmetry=symmetry.supports(axes),
                       part_of=f"\n# Planes of symmetry {symmetry.said(options)}." if axes else "",
                       sizes="" if inclined else SIZES.format(thickness=options.thickness, length=length,
                                                              divisions=pair(np.array(divisions))),
                       levels=levels, smallest=length / 2**levels, travel=f"{tools.travel:.6g}", forces="".join(forces),
                       cut=CUT.format(file=BLANK) + (NORMAL if inclined else "") if tools.blank.cut else "",
                       material=set_material.text_of(options.material), name=set_material.name_of(options.material),
                       friction=FRICTION, beads=beads.blocks(axes), pins=pinned(tools.pins),
                       gravity=GRAVITY.format(earth=EARTH, aside=aside) if weighs else "",
                       light="  gravity = 0 0 0\n" if weighs else "", sheet=sheet,
                       tools="".join(TOOL.format(name=name, contact=CONTACT[name]) for name in tools.surfaces),
                       support=support, closing=closing,
                       clamp=CLAMP.format(presses="".join(presses), free=FREE.format(axes=" ".join(free))
                                          if closing and free else "")
                       if pressed else "")


def divided(options: ToolSettings, tools: ToolSet) -> tuple[np.ndarray, list[int], int, float]:
    """Return the box of the mesh of the blank (2, 2), mm, its divisions along x and y, the levels to which these may be
    divided, and the length of the undivided elements, mm."""
    smallest = max(min(OF_RADIUS * tools.radius, (8 * SAG * options.thickness * tools.radius)**0.5),
                   OF_THICKNESS * options.thickness)
    levels = int(np.clip(np.ceil(np.log2((tools.blank.area / ELEMENTS)**0.5 / smallest)), 0, LEVELS))
    length = 2**levels * smallest
    box = tools.blank.box
    if tools.blank.cut:  # that does not meet the border of the mesh
        box = box + AROUND * length * np.array([[-1.0], [1.0]])
    axes = list(symmetry.ends_at(options))
    box[0, axes] = 0.0
    divisions = [int(np.ceil(side / length)) if axis in axes else 2 * int(np.ceil(side / length / 2))
                 for axis, side in enumerate(box[1] - box[0])]
    return box, divisions, levels, length


def write_blank(options: ToolSettings, tools: ToolSet) -> None:
    """Write the outline of a blank that is cut along it, and the mesh of one that does not lie level."""
    blank, of = tools.blank, options.source
    if blank.cut:
        outline = symmetry.mirrored(blank.outline, symmetry.ends_at(options), 0.0)
        assert outline is not None  # it goes around the origin
        write_curves(options.target / BLANK, [blank.placed(outline)], f"outline of the blank of {of.name}")
    if blank.inclined:
        (low, high), (across, along), _, _ = divided(options, tools)
        plan = np.array([[x, y] for y in np.linspace(low[1], high[1], along + 1)
                         for x in np.linspace(low[0], high[0], across + 1)])
        lower = blank.placed(plan)
        nodes = np.concatenate([lower, lower + options.thickness * blank.normal])
        first = np.array([j * (across + 1) + i + 1 for j in range(along) for i in range(across)])
        face = first[:, None] + [0, 1, across + 2, across + 1]
        cells = np.hstack([face, face + len(lower)])
        write_inp(options.target / MESH, Mesh(dict(enumerate(map(tuple, nodes.tolist()), 1)),
                                              dict(enumerate(cells.tolist(), 1))), of)


def said(options: ToolSettings, blank: Blank) -> str:
    """Return size, area and weight of a blank in words."""
    density, of = set_material.density_of(options.material), "" if options.material else " of steel"
    if density is None:
        density, of = set_material.STEEL_DENSITY, " of steel"
    weight = 1e6 * blank.area * options.thickness * density
    x, y = np.ptp(blank.box, axis=0)
    return f"{x:.4g} x {y:.4g} mm, {blank.area:.4g} mm2, {weight:.3g} g{of}" + (
        f", cut along {BLANK}" if blank.cut else "")


def pair(values: np.ndarray) -> str:
    """Return two numbers as words."""
    return " ".join(f"{value + 0.0:.6g}" for value in np.round(values, 9))


def pinned(pins: Sequence[Pin]) -> str:
    """Return the supports of locating pins: the first one holds the blank, the second one against a turn about that."""
    fixed = [" ".join("xy"[axis] for axis in axes) for axes in axes_of(pins)]
    return "".join(PIN.format(words=pin.words, number=number, place=pair(pin.place), fixed=axes,
                              diameter=pin.diameter)
                   for number, (pin, axes) in enumerate(zip(pins, fixed), 1))


def sag(options: ToolSettings, blank: Blank) -> float | None:
    """Return the deflection of a blank under its weight on two supports at the ends of its longer side, mm, None
    without a density."""
    density = set_material.density_of(options.material)
    if density is None:
        return None
    span, stiffness = float(np.ptp(blank.box, axis=0).max()), set_material.stiffness_of(options.material)
    return 5 * 12 * density * EARTH * span**4 / (384 * stiffness * options.thickness**2)


def notes(options: ToolSettings, tools: ToolSet) -> list[tuple[str, str]]:
    """Return lines of the report on what holds the blank, and its weight."""
    lines = []
    if "pad" in tools.surfaces:
        area = tools.area["pad"]
        force, by = ((tools.pad_force, "leaves to the pins what their holes bear" if tools.pad_for_pins
                      else "holds the floor by friction") if tools.pad_force else
                     (PRESSURE * area, "by that pressure; what holds the floor is not estimated without the program"))
        lines.append(("pad", f"{force:.3g} N, {force / area:.2g} MPa, {by}"))
        lines += [("pin", f"in the hole {pin.words} at x y {pair(np.round(pin.place, 3))}: pierce the blank there")
                  for pin in tools.pins]
        if not tools.pins:
            lines.append(("pin", "none, as the floor is not level or has no hole: pilot holes would locate the blank"))
    if tools.closing:
        deep = sag(options, tools.blank)
        lines.append(("weight", "left out, as the material has no density: nothing lays the blank on the die"
                      if deep is None else
                      "the blank is laid on the die by a phase with gravity; on two supports at its ends it would sag "
                      f"by up to {deep:.2g} mm"))
    return lines
