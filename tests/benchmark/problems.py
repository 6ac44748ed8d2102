# SPDX-License-Identifier: GPL-3.0-or-later
"""Forming problems for measurements: decks, the surfaces of their tools, and changes of their blocks.

A problem is a function that writes what its deck needs into a folder and returns the deck's text.
"""
import math
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]
BENDING = ROOT / "input_files" / "bending"
CASES = ROOT / "tests" / "cases"

STEEL = """*MATERIAL steel
  young = 2.1e5
  poisson = 0.30
  yield = hill48 F=0.284 G=0.358 H=0.642 L=1.289 M=1.289 N=1.289
  hardening = swift K=565 e0=0.007117 n=0.259
"""


# ---- settings of a deck ----------------------------------------------------------------------------------------------

def without(text, *keywords):
    """Return a deck without the blocks of these keywords."""
    for keyword in keywords:
        text = re.sub(rf"^\*{keyword}\b.*?(?=^\*|\Z)", "", text, flags=re.DOTALL | re.MULTILINE)
    return text


def merged(text, keyword, lines):
    """Return a deck with lines `key = value` in its block of a keyword; they replace those of the same keys there."""
    if not lines:
        return text
    head = re.compile(rf"^\*{keyword}\n", re.MULTILINE)
    if not head.search(text):
        place = text.index("*PHASE")
        text = text[:place] + f"*{keyword}\n\n" + text[place:]
    start = head.search(text).end()
    end = re.compile(r"^\*|\Z", re.MULTILINE).search(text, start).start()
    block = text[start:end]
    for key in (line.split("=")[0].strip() for line in lines):
        block = re.sub(rf"^[ \t]*{key}[ \t]*=.*\n", "", block, flags=re.MULTILINE)
    return text[:start] + "".join(f"  {line}\n" for line in lines) + block + text[end:]


def with_paths(text, folder):
    """Return a deck whose tools are files of a folder."""
    return re.sub(r'(patches = )"([^"/]*)"', rf'\1"{folder}/\2"', text)


# ---- surfaces --------------------------------------------------------------------------------------------------------

def write_patches(path, patches):
    """Write patches, each a list of rows in v of points (x, y, z, weight) in u."""
    lines = []
    for patch in patches:
        lines.append(f"patch {len(patch[0]) - 1} {len(patch) - 1} rational")
        lines += [f"  {x:.12g} {y:.12g} {z:.12g} {w:.17g}" for row in patch for x, y, z, w in row]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def line(start, end):
    """Return a straight piece of a profile (x, z, weight)."""
    return [(*start, 1.0), (*end, 1.0)]


def arcs(centre, radius, first, last, pieces):
    """Return an arc around a centre, angles in degrees from x."""
    found = []
    for i in range(pieces):
        a, b = (math.radians(first + (last - first) * k / pieces) for k in (i, i + 1))
        weight = math.cos(0.5 * (b - a))
        found.append([(centre[0] + r * math.cos(t), centre[1] + r * math.sin(t), w)
                      for t, r, w in ((a, radius, 1.0), (0.5 * (a + b), radius / weight, weight), (b, radius, 1.0))])
    return found


def extruded(path, profile, y0, y1):
    """Write a profile in x and z, extruded along y from y0 to y1."""
    write_patches(path, [[[(x, y, z, w) for x, z, w in piece] for y in (y0, y1)] for piece in profile])


# ---- problems --------------------------------------------------------------------------------------------------------

def of_file(path):
    """Return the problem of an input file."""
    def deck(_):
        text = re.sub(r'(patches = )"([^"]*)"', lambda found: f'{found[1]}"{(path.parent / found[2]).resolve()}"',
                      path.read_text(encoding="utf-8"))
        return re.sub(r"^(\*INCLUDE )(.*)$", lambda found: found[1] + str((path.parent / found[2]).resolve()), text,
                      flags=re.MULTILINE)
    return deck


def air_bending(folder):
    """Return a strip bent by a cylindrical punch over a rounded die, one half."""
    cylinder_punch(folder)
    extruded(folder / "die.bez", [*arcs((34, -4), 4, 180, 90, 2), line((34, 0), (80, 0))], -10, 30)
    return blank("80 20 1", "40 4 2") + tools(punch=("z_max", 0.1), die=("z_min", 0.1)) + HALF + \
        "*PHASE bend\n  control = punch\n  trial = 1\n  hold = die\n  move = punch 0 0 -25\n"


def coining(folder):
    """Return the sheet of squeeze_solid_shell, pressed by 1 % of its thickness, its edges held in its plane."""
    text = without(of_file(CASES / "squeeze_solid_shell" / "case.dat")(folder), "BOUNDARY", "PHASE")
    edges = "".join(f"*BOUNDARY {edge}\n  set = {edge}\n  fix = x y\n" for edge in ("x_min", "x_max", "y_min", "y_max"))
    return text + edges + "*PHASE squeeze\n  control = ram\n  trial = 0.001\n  hold = table\n  move = ram 0 0 -0.01\n"


def cylinder_punch(folder):
    """Write a punch of radius 10 mm that touches a sheet of 1 mm at x = 0."""
    extruded(folder / "punch.bez", arcs((0, 11), 10, -100, 0, 3), 30, -10)


def blank(size, divisions):
    """Return the blank and its material."""
    return f"*BLANK sheet\n  size = {size}\n  divisions = {divisions}\n  material = steel\n" + STEEL


def tools(**candidates):
    """Return tools, each with the set of its candidates and its friction."""
    return "".join(f'*TOOL {name}\n  patches = "{name}.bez"\n  friction = {friction}\n  contact = {nodes}\n'
                   for name, (nodes, friction) in candidates.items())


HALF = """*SET corner
  near = 0 0 0
*BOUNDARY symmetry
  set = x_min
  fix = x
*BOUNDARY no_drift
  set = corner
  fix = y
"""
