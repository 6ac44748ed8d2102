# SPDX-License-Identifier: GPL-3.0-or-later
"""A rigid cylinder on an elastic half-space, without and with a contact layer: half-width and largest pressure."""
import math
import pathlib

from frame import Mesh, Outcome, Section, Value, geometric, load

HERE = pathlib.Path(__file__).resolve().parent

RADIUS, LOAD, YOUNG, POISSON = 10.0, 500.0, 2.1e5, 0.3
WIDTH = math.sqrt(4 * LOAD * RADIUS * (1 - POISSON**2) / (math.pi * YOUNG))
PRESSURE = 2 * LOAD / (math.pi * WIDTH)
THICKNESS = 8.0  # of the blank, mm
FINE = 0.3  # the elements are equal up to here, mm


def run(bench, element, n, layer=None):
    """Run with n elements up to FINE along x and z; return the run, and place and force of the nodes, per mm of y.

    Without a layer the formulation is the mixed one, and nodes beyond FINE have no contact.
    """
    step = FINE / n
    outer = [FINE + place for place in geometric(n, 1.15 * step, 8.0 - FINE)]
    places = [step * i for i in range(n)] + outer
    words = [" ".join(f"{x / 8:.9g}" for x in places), " ".join(f"{1 - x / 8:.9g}" for x in reversed(places))]
    settings = {"element": element, "nx": len(places) - 1, "nz": len(places) - 1, "x_lines": words[0],
                "z_lines": words[1]}
    name, deck = f"hertz_{element}_{n}", HERE / "case.dat"
    if layer:
        name, settings["reach"] = f"{name}_{layer:g}", 2.5
        deck = deck.read_text(encoding="utf-8").replace("formulation = mixed", f"layer = {layer:g}")
        deck = deck.replace("cylinder.bez", str(HERE / "cylinder.bez"))
    found = bench.run(name, deck, settings)
    from dd3.fields import Fields
    fields = Fields(found.folder)
    step = fields.count - 1
    forces = {}
    for (x, _, z), force in zip(fields.points(0), fields.values(step, "contact_force")[0]):
        if abs(z) < 1e-6 and force[2]:
            forces[round(float(x), 6)] = forces.get(round(float(x), 6), 0.0) - float(force[2])
    return found, forces


def measure(element, n, forces):
    """Return half-width, from load and second moment of the nodal forces, and pressure in the middle."""
    total = sum(forces.values())
    width = 2 * math.sqrt(sum(force * x * x for x, force in forces.items()) / total)
    return width, forces[0.0] / (FINE / n) * (6 if element == "hex27" else 2)


def values(bench):
    """Compare half-width and pressure."""
    result = []
    for element, n in (("hex8", 18), ("solid_shell", 9), ("hex27", 5)):
        width, pressure = measure(element, n, run(bench, element, n)[1])
        result += [Value(f"`{element}`, {n} elements to 0.3 mm: half-width of the contact, mm", WIDTH, width, 0.03),
                   Value(f"`{element}`: pressure in the middle, MPa", PRESSURE, pressure, 0.03)]
    return Outcome(result)


def layered(bench):
    """Compare half-width and pressure under a contact layer with those of the integral equation."""
    solve = load(HERE / "layer.py").measure  # needs numpy
    result = []
    for layer in (1e-4, 1e-3, 0.02):
        expected = solve(RADIUS, LOAD, YOUNG / (1 - POISSON**2), layer * THICKNESS, 1e-5 * YOUNG)
        for element, n in (("hex8", 18), ("hex27", 9)):
            found = measure(element, n, run(bench, element, n, layer)[1])
            result += [Value(f"layer of {layer:g}, `{element}`: {text}", *pair, 0.03) for text, pair in zip(
                ("half-width, mm", "pressure in the middle, MPa"), zip(expected, found))]
    return Outcome(result)


def exact_pressure(x):
    """Return the pressure at a place."""
    return PRESSURE * math.sqrt(max(0.0, 1 - (x / WIDTH) ** 2))


def study(bench):
    """Refine: half-width of the contact."""
    rows, points = [], []
    for element, numbers in (("hex8", (5, 9, 18, 27)), ("solid_shell", (5, 9, 18)), ("hex27", (3, 5, 9))):
        for n in numbers:
            found, forces = run(bench, element, n)
            rows.append(Mesh(element, f"{n} elements to 0.3 mm", 1 / n, found.unknowns(), found.seconds, WIDTH,
                             measure(element, n, forces)[0]))
            if element == "hex8" and n in (9, 27):
                pairs = [(x, force * n / FINE * (2 if x == 0 else 1)) for x, force in sorted(forces.items())]
                points.append((n, pairs))
    return Outcome(study=rows, pictures=[("hertz.png", lambda axes: draw(axes, points))])


def draw(axes, points):
    """Draw the pressure over the place."""
    places = [WIDTH * i / 200 for i in range(201)]
    axes.plot(places, [exact_pressure(x) for x in places], color="0.3", linewidth=1.0, label="Hertz")
    for n, pairs in points:
        axes.plot(*zip(*pairs), "o", markersize=4, label=f"hex8, {n} elements to 0.3 mm")
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("pressure (MPa)")
    axes.legend(frameon=False)


SECTIONS = [
    Section("V16 Cylinder on a half-space (Hertz)", """
A rigid cylinder of radius R = 10 mm is pressed by P = 500 N/mm on an elastic half-space in plane strain, without
friction. Hertz: half-width a = √(4 P R/(π E*)), E* = E/(1 - ν²), largest pressure 2 P/(π a), distribution an ellipse.
The half-width is that of the ellipse with the
second moment of the nodal forces; the pressure is the force of the middle node over its part of the face. Deck
`tests/verification/hertz/case.dat`; `hex20` cannot be in contact. Contact formulation: mixed.
""", values, slow=True),
    Section("V16 Cylinder on a half-space: contact layer", """
The same in the compliant formulation: a layer of height h on the cylinder, in which the pressure is
p_0 (h/g - 2 + g/h) of the gap g, p_0 = 1e-5 E. `layer` is h over the thickness of the sheet, here the 8 mm of the
block: at the default 0.02, h is 0.16 mm, and the contact spreads. Expected: the integral equation of the half-space
with the law of the layer, constant pressures on 300 strips (`tests/verification/hertz/layer.py`); without a layer it
gives Hertz's values to 1e-4.
""", layered, slow=True),
    Section("V16 Cylinder on a half-space: refinement and elements", """
Half-width of the contact.
""", study, slow=True, picture="hertz_elements.png"),
]
