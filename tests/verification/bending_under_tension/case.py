# SPDX-License-Identifier: GPL-3.0-or-later
"""A strip drawn over a cylinder under back tension: the force of bending and unbending, and that of friction."""
import math
import pathlib

from frame import Outcome, Section, Value, load

HERE = pathlib.Path(__file__).resolve().parent

fibres = load(HERE / "fibres.py")
TENSION, RADIUS = 60.0, 5.0
MIDDLE = RADIUS + fibres.THICKNESS / 2
WRAP = math.pi / 2
STEADY = 0.6  # fraction of the draw from which the force is steady


def run(bench, friction, elements):
    """Run the strip; return displacements of both ends, mm, force, N/mm, in the draw, and contact force at its end."""
    found = bench.run(f"under_tension_{friction:g}_{elements}", HERE / "case.dat",
                      {"friction": friction, "tension": TENSION, "elements": elements})
    ends, starts = found.column("end_uz", "draw"), found.column("start_ux", "draw")
    forces = [-force for force in found.column("end_rz", "draw")]
    return [ends[0] - z for z in ends], starts, forces, normal_force(found.folder)


def normal_force(folder):
    """Return the sum of the contact pressure over the lower face at the end, N/mm."""
    from dd3.fields import Fields
    fields = Fields(folder)
    last = fields.count - 1
    points, pressure = fields.points(last), fields.values(last, "contact_pressure")[0]
    angle = [(math.atan2(x, z + RADIUS), float(p)) for (x, y, z), p in zip(points, pressure) if p > 0 and abs(y) < 1e-6]
    angle.sort()
    return sum(RADIUS * (b - a) * 0.5 * (p + q) for (a, p), (b, q) in zip(angle, angle[1:]))


def steady(places, forces):
    """Return the mean force in the steady part of the draw."""
    whole = part = 0.0
    for i in range(1, len(places)):
        if places[i] > STEADY * places[-1]:
            step = places[i] - places[i - 1]
            part, whole = part + 0.5 * step * (forces[i] + forces[i - 1]), whole + step
    return part / whole


def elongation(places, starts):
    """Return the elongation in the steady part of the draw, from what comes out and what goes in."""
    first = next(i for i, place in enumerate(places) if place > STEADY * places[-1])
    return (places[-1] - places[first]) / (starts[-1] - starts[first]) - 1


def values(bench):
    """Compare the steady force and the elongation with those of the fibres, and the contact force with the tension."""
    result, curves = [], []
    for friction, elements, length in ((0.0, 80, "t/2"), (0.144, 80, "t/2"), (0.0, 20, "2 t")):
        growth = math.exp(friction * WRAP * RADIUS / MIDDLE)
        expected, stretch = fibres.bend_and_unbend(TENSION, MIDDLE, growth)
        places, starts, forces, contact = run(bench, friction, elements)
        found, name = steady(places, forces), f"µ = {friction:g}, elements of {length}"
        result += [Value(f"{name}: steady force, N/mm", expected, found, 0.02),
                   Value(f"{name}: part of bending and unbending, N/mm", expected - TENSION * growth,
                         found - TENSION * growth, 0.06),
                   Value(f"{name}: elongation of the strip", stretch - 1, elongation(places, starts), 0.1)]
        if elements > 20:  # the contact points of the long elements are too few for a sum over the arc
            result.append(Value(f"{name}: contact force over the mean tension, degrees", math.degrees(WRAP),
                                math.degrees(2 * contact / (TENSION + forces[-1])), 0.04))
        curves.append((name, places, forces, expected))
    return Outcome(result, pictures=[("bending_under_tension.png", lambda axes: draw(axes, curves))])


def draw(axes, curves):
    """Draw the force over the displacement."""
    for name, places, forces, expected in curves:
        line, = axes.plot(places, forces, linewidth=1.4, label=name)
        axes.axhline(expected, color=line.get_color(), linewidth=0.8, linestyle="--")
    axes.set_xlabel("displacement of the end (mm)")
    axes.set_ylabel("force (N/mm)")
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False)


SECTIONS = [
    Section("V21 Bending under tension", f"""
A strip of 0.78 mm under a back tension of {TENSION:g} N/mm is drawn over a quarter of a cylinder of radius {RADIUS:g}
mm (von Mises, Swift, plane strain; one layer of `solid_shell`, 9 points). Every section is bent and unbent; without
friction the force grows by the work in it, about 2M/R, by an integration through the thickness with the radial stress
of the contact (`fibres.py`). With friction it grows between the two by exp(µ θ R/(R + t/2)), θ = π/2: the contact force
of a turn by dθ is T dθ, and friction acts on it at the inner face, at R, the tension at the middle, at R + t/2. The
tension shifts the neutral line, so that the strip is stretched each time. Mean force, and length at the exit over that
at the entry, over the last {100 * (1 - STEADY):.0f} % of the draw; sum of the contact pressure at its end over the mean
of the two tensions, which is θ. Deck `tests/verification/bending_under_tension/case.dat`.
""", values, slow=True, after="""
Dashed: the integration, which has no shear. With friction the strip stretches less than by the integration, in
which all friction acts before the unbending; here it begins at two thirds of the arc.
"""),
]
