# SPDX-License-Identifier: GPL-3.0-or-later
"""Stretching over a hemispherical punch: height at given forces against published readings; place of the thinning."""
import math
import pathlib

from frame import Outcome, Section, Value, interpolate

HERE = pathlib.Path(__file__).resolve().parent

# Force, kN, and displacement of the punch, mm, without friction.
PUBLISHED = ((10, 10.6), (20, 15.4), (30, 20.0), (40, 24.7), (50, 28.2), (60, 33.0), (70, 37.4))


def run(bench, friction):
    """Run the quarter; return displacement of the punch, mm, force of the whole sheet, kN, and thickness by radius."""
    found = bench.run(f"punch_{friction:g}", HERE / "case.dat", {"friction": friction})
    heights, forces = found.column("travel"), [4e-3 * force for force in found.column("punch_fz")]
    from dd3.fields import Fields
    fields = Fields(found.folder)
    step = fields.nearest_step(30.0)
    start, thickness = fields.points(0), fields.values(step, "thickness")[0]
    profile = sorted((float(x), math.log(float(t))) for (x, y, z), t in zip(start, thickness)
                     if abs(y) < 1e-6 and abs(z) < 1e-6)
    return heights, forces, profile


def values(bench):
    """Compare heights, and where the sheet thins most at 30 mm."""
    heights, forces, smooth = run(bench, 0.0)
    _, rough_forces, rough = run(bench, 0.15)
    result = [Value(f"height at {force} kN, mm", height, interpolate(forces, heights, force), 0.1)
              for force, height in PUBLISHED[:-1]]
    force, height = PUBLISHED[-1]
    result.append(Value(f"force at {height} mm, near its maximum, kN", force, interpolate(heights, forces, height), 0.1))
    profiles = [("µ = 0", smooth), ("µ = 0.15", rough)]
    return Outcome(result, pictures=[("punch_force.png", lambda axes: draw_force(axes, heights, forces)),
                                     ("punch_thinning.png", lambda axes: draw_thinning(axes, profiles))])


def draw_force(axes, heights, forces):
    """Draw the force over the height."""
    axes.plot(heights, forces, linewidth=1.4, label="computed")
    axes.plot([height for _, height in PUBLISHED], [force for force, _ in PUBLISHED], "o", markersize=4,
              label="published readings")
    axes.set_xlabel("displacement of the punch (mm)")
    axes.set_ylabel("force (kN)")
    axes.legend(frameon=False)


def draw_thinning(axes, profiles):
    """Draw the thickness strain over the initial radius."""
    for label, profile in profiles:
        axes.plot(*zip(*profile), "o-", linewidth=1.4, markersize=4, label=label)
    axes.set_xlabel("initial radius (mm)")
    axes.set_ylabel("thickness strain at 30 mm")
    axes.legend(frameon=False)


SECTIONS = [
    Section("V24 Stretching over a hemispherical punch", """
Sheet of 1 mm, clamped at a radius of 59.18 mm, where the die's shoulder of 6.35 mm begins; punch of radius 50.8 mm.
E = 69004 MPa, ν = 0.3, σ = 589 (1e-4 + p)^0.216 MPa, von Mises; a quarter, one layer of `solid_shell`, 180 elements.
The test of Wagoner, Nakamachi and Lee (1988) as in the validation manual of Code_Aster, SSNV501 (V6.04.501), model A:
the displacement of the punch at given forces, without friction, read from a curve within 5 % and compared there within
10 %; at the last reading the force, which hardly rises any more. With 10 x 20 elements in place of 6 x 12 the largest
force is 0.3 % higher. Deck `tests/verification/hemispherical_punch/case.dat`.
""", values, slow=True, after="""
Code to code: no number is known for the strains. Friction keeps the sheet on the pole from stretching, and the place of
the largest thinning moves outwards.
"""),
]
