# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of one element: tension, shear and cyclic loads of a cube, for dd3imp and for the library of the laws.

A case moves faces of the cube x_max, y_max in steps of equal displacement; the other faces are symmetry planes or free.
"""

from dataclasses import dataclass

SIZE = 10.0

SWIFT = "hardening = swift K=565 e0=0.007117 n=0.259"
VOCE = "hardening = voce Y0=200 Rsat=100 CR=10"
HILL = "yield = hill48 F=0.284 G=0.358 H=0.642 L=1.289 M=1.2 N=1.5"
BACK = "backstress = lemaitre_chaboche CX=50 Xsat=60\n  backstress = prager k=300"


@dataclass
class Case:
    """A case: its name, the lines of its laws, angle of the rolling direction from x in degrees, motions with an axis
    for each face ("xx": x_max along x; "yx": y_max along x, simple shear), and the segments: displacements, steps."""

    name: str
    laws: tuple
    motions: tuple
    segments: tuple
    angle: float = 0.0

    @property
    def sheared(self):
        """Return whether all nodes are led: simple shear."""
        return "yx" in self.motions

    def material(self):
        """Return the block *MATERIAL."""
        rolling = {0.0: "1 0 0", 45.0: "1 1 0"}[self.angle]
        lines = ["young = 2.1e5", "poisson = 0.3", *self.laws, f"rolling_direction = {rolling}"]
        return "*MATERIAL sheet\n" + "".join(f"  {line}\n" for line in lines)


CASES = (
    Case("tension", (HILL, SWIFT), ("xx",), (((2.0,), 40),)),
    Case("pure shear", (HILL, SWIFT), ("xx", "yy"), (((1.5, -1.3), 40),), 45.0),
    Case("simple shear", (HILL, SWIFT), ("yx",), (((2.0,), 40),)),
    Case("cyclic tension", (HILL, VOCE, BACK), ("xx",), (((0.3,), 30), ((-0.5,), 50), ((0.4,), 40))),
    Case("cyclic shear", (HILL, VOCE, BACK), ("xx", "yy"), (((0.3, -0.3), 30), ((-0.5, 0.5), 50)), 45.0),
)

# Yoshida and Uemori's law with a falling modulus; not in the table of calculix.py.
TWO_SURFACES = Case("two surfaces", (HILL, "hardening = yoshida_uemori Y=124 B=168 C=200 m=12 b_sat=60 Rsat=190 h=0.5",
                                     "modulus = chord Ea=1.63e5 xi=30.8"), ("xx",),
                    (((0.3,), 30), ((-0.5,), 50), ((0.4,), 40)))

DECK = """*BLANK cube
  size = {size} {size} {size}
  divisions = 1 1 1
  element = hex8
  material = sheet

{material}
*BOUNDARY left
  set = x_min
  fix = {left}

*BOUNDARY front
  set = y_min
  fix = {front}

*BOUNDARY bottom
  set = {bottom}
  fix = z

*NEWTON
  tolerance = 1e-10

*LIMITS
  strain = off
  rotation = off
  unloading = off
  r_max = 1

*HISTORY x
  set = x_max
  quantities = displacement reaction

*HISTORY y
  set = y_max
  quantities = displacement reaction

*HISTORY z
  set = z_max
  quantities = displacement reaction
"""

PHASE = """
*PHASE part_{number}
  control = load
  trial = {trial!r}
{displaced}"""


def deck(case):
    """Return the input of dd3imp."""
    held = {"left": "x", "front": "y", "bottom": "z_min"}
    if case.sheared:
        held = {"left": "y", "front": "x y", "bottom": "all"}
    text = DECK.format(size=SIZE, material=case.material(), **held)
    for number, (displacements, steps) in enumerate(case.segments, start=1):
        displaced = "".join(f"  displace = {face}_max {axis} {value!r}\n"
                            for (face, axis), value in zip(case.motions, displacements))
        if case.sheared and number == 1:
            displaced += "  displace = y_max y 0\n"
        text += PHASE.format(number=number, trial=1 / steps, displaced=displaced)
    return text


def displacements(case):
    """Yield the displacements of the faces after each step, from the start."""
    now = [0.0] * len(case.motions)
    yield tuple(now)
    for change, steps in case.segments:
        for step in range(1, steps + 1):
            yield tuple(a + b * step / steps for a, b in zip(now, change))
        now = [a + b for a, b in zip(now, change)]
