# SPDX-License-Identifier: GPL-3.0-or-later
"""A line of two operations: a strip is bent at one end, then, turned by some angle, at the other one."""

import numpy as np
from helpers import call

ANGLE = 40.0  # of the bends, degrees
ABOVE = 1.5  # height above its place in which the sheet enters the second operation, mm
DECK = """*TITLE
  {title}
*PARAMETER
  tools = tools
{sheet}
*MATERIAL metal
  young = 7e4
  poisson = 0.33
  density = 2.7e-9
  yield = von_mises
  hardening = linear Y0=250 H=800
*TOOL post
  patches = "${{tools}}/post_{name}.bez"
  contact = z_min
*TOOL pad
  patches = "${{tools}}/pad_{name}.bez"
  contact = z_max
  position = {apart}
*TOOL steel
  patches = "${{tools}}/steel_{name}.bez"
  contact = z_max
  position = {above}
*CONTACT
*SET left
  near = -3 0.5 0
*SET every
  box = -99 99 -9 9 -9 9
*BOUNDARY left
  set = left
  fix = x
*BOUNDARY plane_strain
  set = every
  fix = y
*PHASE lay
  control = load
  trial = 0.1
  hold = post
  hold = pad
  hold = steel
  gravity = {weight}
*PHASE clamp
  control = load
  trial = 0.5
  hold = post
  hold = steel
  press = pad {force}
*PHASE bend
  control = steel
  trial = 1
  move = steel {down}
*PHASE springback
  unload = at_once
  gravity = 0 0 0
"""
BLANK = """*BLANK strip
  origin = -30 0 0.1
  size = 60 1 1
  divisions = {count} 1 1
  element = solid_shell
  thickness_points = 5
  material = metal"""
START = """*START
  from = op1.out
  turn = 0 0 0  0 1 0  {angle}
  move = {move}"""


def numbers(vector):
    """Return a vector as text."""
    return " ".join(f"{value:.12g}" for value in vector)


def write_line(folder, angle=0.0, move=(0.0, 0.0, 0.0), count=40, second=True):
    """Write tools, input files and process of the line; the second operation is turned about y, degrees, and moved, mm,
    or only releases the sheet; its weight is along z, down in its coordinates. Return the file of the process."""
    (folder / "tools").mkdir(parents=True)
    cosine, sine = np.cos(np.radians(ANGLE)), np.sin(np.radians(ANGLE))
    end = np.array([-10 - 25 * cosine, -25 * sine])
    nose = np.array([-10, 0]) + 1.05 * np.array([-sine, cosine]) - 3 * np.array([cosine, sine])
    last = nose - 25 * np.array([cosine, sine])
    profiles = {"post_1": (end, (-10, 0, 8), (15, 0)), "pad_1": ((6, 1), None, (-6, 1)),
                "steel_1": ((nose[0], 20), (*nose, 3), last),
                "post_2": ((-7, 0), (10, 0, 8), (-end[0], end[1])), "pad_2": ((6, 1), None, (-6, 1)),
                "steel_2": ((-last[0], last[1]), (-nose[0], nose[1], 3), (-nose[0], 20))}
    turn = np.radians(angle)
    rotation = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
    up = np.array([0, 0, np.sign(np.cos(turn))])
    for name, (start, corner, line) in profiles.items():
        lines = [f"*PROFILE {name}", f"  start = {numbers(start)}", f"  line = {numbers(line)}", "  extrude = -2 3"]
        if corner is not None:
            lines.insert(2, f"  corner = {numbers(corner)}")
        shape = folder / "tools" / f"{name}.shape"
        shape.write_text("\n".join(lines) + "\n")
        place = ["--rotate", 0, 1, 0, angle, "--move", *move] if name.endswith("2") and (angle or any(move)) else []
        call("tool", shape, shape.with_suffix(".bez"), *place)
    decks = [("1", BLANK.format(count=count), np.eye(3)),
             ("2", START.format(angle=angle, move=numbers(np.add(move, ABOVE * up))), rotation)]
    for name, sheet, turned in decks:
        text = DECK.format(title=f"Bend {name}", name=name, sheet=sheet, above=numbers(turned @ (0, 0, 25)),
                           weight=numbers(-9810 * (up if name == "2" else np.array([0, 0, 1]))),
                           apart=numbers(turned @ (0, 0, 4)),
                           force=numbers(turned @ (0, 0, -200)), down=numbers(turned @ (0, 0, -25)))
        if name == "2" and not second:
            text = text[:text.index("*TOOL post")] + text[text.index("*SET left"):text.index("*PHASE lay")] \
                + "*PHASE springback\n  unload = at_once\n"
            text = text.replace("*PARAMETER\n  tools = tools\n", "")
        (folder / f"op{name}.dat").write_text(text)
    (folder / "line.toml").write_text('[[operation]]\ndeck = "op1.dat"\n[[operation]]\ndeck = "op2.dat"\n')
    return folder / "line.toml"
