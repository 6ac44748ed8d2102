# SPDX-License-Identifier: GPL-3.0-or-later
"""An elastic strip on the contact layer of a table or a cylinder: a linear foundation, and a nonlinear one."""
import math
import pathlib

import closed_forms as exact
from frame import Outcome, Section, Value
from frame import load as module_of

HERE = pathlib.Path(__file__).resolve().parent

beam = module_of(HERE / "beam.py")
RADIUS = 40.0  # of the cylinder, mm
HEIGHT = 0.02  # of the layer: h over the thickness of 1 mm
SOFT, PRESSURE, LINE = 0.2, 0.05, 0.006  # h, mm; pressure on the strip, MPa, and line load on its half, N/mm


def run(bench, name, elements, **settings):
    """Run the strip with the positions of the nodes of its lower face in the history; return the run and their x."""
    deck = (HERE / "case.dat").read_text(encoding="utf-8").replace("${tool}.bez", str(HERE / "${tool}.bez"))
    places = [settings["length"] * i / elements for i in range(elements + 1)]
    for i, x in enumerate(places):
        deck += f"\n*SET low{i}\n  near = {x:.9g} 0 0\n\n*HISTORY low{i}\n  set = low{i}\n  quantities = position\n"
    return bench.run(f"strip_on_layer_{name}", deck, {"elements": elements, **settings}), places


def linear(bench):
    """Compare the change of the gap by a small line load under a uniform pressure with the linear foundation."""
    left = exact.layer_gap(PRESSURE / beam.REFERENCE)
    stiffness = beam.REFERENCE / SOFT * (1 / left**2 - 1)
    decay = (stiffness / 4 / beam.BENDING) ** 0.25
    found, places = run(bench, "linear", 160, length=80, layer=SOFT, pressure=PRESSURE, middle=LINE)
    values = [Value("gap under the pressure, mm", SOFT * left, found.last("low0_z", "press"), 1e-4)]
    largest = 2 * LINE * decay / 2 / stiffness
    for i in (0, 24, 48, 80):
        x = decay * places[i]
        values.append(Value(f"change of the gap at x = {places[i]:g} mm, µm",
                            -1e3 * largest * math.exp(-x) * (math.cos(x) + math.sin(x)),
                            1e3 * (found.last(f"low{i}_z", "bend") - found.last(f"low{i}_z", "press")),
                            1e3 * 0.005 * largest, absolute=True))
    return Outcome(values)


def solved(length, tool, loads, wanted):
    """Yield strip and states for the wanted loads; `loads` are (middle, end) in steps that lead there."""
    path = []
    for load in loads:
        strip = beam.Strip(length, tool, HEIGHT, middle=load[0], end=load[1], steps=200)
        guess = strip.first_guess(0.5 + 0.9 * HEIGHT) if not path else path[-1]
        if len(path) > 1:
            guess = [2 * b - a for a, b in zip(*path[-2:])]
        path.append(strip.solve(guess))
        if load in wanted:
            yield strip, strip.shoot(path[-1])


def of_beam(strip, states):
    """Return gaps at the steps, height of the end, and energy of the layer."""
    gaps = [strip.gap(state)[0] for state in states]
    energies = [beam.REFERENCE * HEIGHT * exact.layer_energy(min(1.0, gap / HEIGHT)) for gap in gaps]
    step = strip.length / strip.steps
    return gaps, states[-1][1], step * (sum(energies) - 0.5 * (energies[0] + energies[-1]))


def crossing(places, gaps):
    """Return the place where the gap becomes that of the layer."""
    i = next(i for i, gap in enumerate(gaps) if gap >= HEIGHT)
    return places[i - 1] + (places[i] - places[i - 1]) * (HEIGHT - gaps[i - 1]) / (gaps[i] - gaps[i - 1])


def lifted(bench):
    """Compare a strip under a line load, whose ends lift off the table, with the beam."""
    wanted, result = [(2.0, 0.0), (8.0, 0.0)], []
    loads = [(0.5 * n, 0.0) for n in range(1, 17)]
    for load, (strip, states) in zip(wanted, solved(20.0, beam.flat, loads, wanted)):
        gaps, end, energy = of_beam(strip, states)
        found, places = run(bench, f"line_{load[0]:g}", 80, length=20, middle=load[0])
        low = [found.last(f"low{i}_z") for i in range(len(places))]
        name = f"{2 * load[0]:g} N/mm"
        result += [Value(f"{name}: gap under the load, mm", gaps[0], low[0], 0.005),
                   Value(f"{name}: place where the strip leaves the layer, mm",
                         crossing([20 * n / strip.steps for n in range(strip.steps + 1)], gaps), crossing(places, low),
                         0.005),
                   Value(f"{name}: height of the end, mm", end - 0.5, found.last("end_z") - 0.5, 0.005),
                   Value(f"{name}: energy in the layer, mJ", energy, found.last("contact_energy"), 0.005)]
    return Outcome(result)


def wrapped(bench):
    """Compare a strip that end loads bend over a cylinder with the beam."""
    wanted, result, curves = [(0.0, 7.5), (0.0, 20.0)], [], []
    loads = [(0.0, 1.25 * n) for n in range(1, 17)]
    for load, (strip, states) in zip(wanted, solved(40.0, beam.cylinder(RADIUS), loads, wanted)):
        gaps, end, energy = of_beam(strip, states)
        found, places = run(bench, f"end_{load[1]:g}", 160, tool="cylinder", length=40, end=load[1], step=0.05)
        low = [math.hypot(found.last(f"low{i}_x"), found.last(f"low{i}_z") + RADIUS) - RADIUS
               for i in range(len(places))]
        name = f"{load[1]:g} N/mm"
        result += [Value(f"{name}: height of the end, mm", end - 0.5, found.last("end_z") - 0.5, 5e-4),
                   Value(f"{name}: gap in the middle, mm", gaps[0], low[0], 5e-3),
                   Value(f"{name}: smallest gap, mm", min(gaps), min(low), 5e-3),
                   Value(f"{name}: its place, mm", 40 * gaps.index(min(gaps)) / strip.steps,
                         places[low.index(min(low))], 0.3, absolute=True),
                   Value(f"{name}: energy in the layer, mJ", energy, found.last("contact_energy"), 2e-3)]
        curves.append((name, [40 * n / strip.steps for n in range(strip.steps + 1)],
                       [beam.layer_pressure(gap, HEIGHT) for gap in gaps], places,
                       [beam.layer_pressure(gap, HEIGHT) for gap in low]))
    return Outcome(result, pictures=[("strip_on_layer.png", lambda axes: draw(axes, curves))])


def draw(axes, curves):
    """Draw the pressure along the strip."""
    for name, x, pressure, places, found in curves:
        axes.plot(x, pressure, color="0.3", linewidth=1.0)
        axes.plot(places, found, "o", markersize=3, label=name)
    axes.set_xlim(0, 20)
    axes.set_xlabel("place along the strip (mm)")
    axes.set_ylabel("pressure (MPa)")
    axes.legend(frameon=False)


SECTIONS = [
    Section("V32 Strip on a contact layer: line load", f"""
An elastic strip of thickness t = 1 mm, E = 2.1e5, ν = 0.3, lies on the contact layer of a table, plane strain, one
half of it, elements of 0.5 mm. Under a pressure p the layer is a foundation of stiffness k = p_0/h (1/x² - 1),
x = g/h, and a small line load P changes the gap by P b/(2 k) e^(-b x) (cos b x + sin b x), b = (k/(4 E' I))^(1/4),
E' I = E t³/(12 (1 - ν²)) (Hetényi, Beams on Elastic Foundation, 1946). Here h = {SOFT:g} mm, p = {PRESSURE:g} MPa,
P = {2 * LINE:g} N/mm. The tolerances are 0.5 % of the largest change. Deck
`tests/verification/strip_on_layer/case.dat`.
""", linear),
    Section("V32 Strip on a contact layer: lifted ends", """
The same strip under a line load alone, with the default layer of h = 0.02 mm, elements of 0.25 mm: it bends, its ends
leave the layer and rise, and the law of the layer is followed over a wide range. Expected: a rod that bends, shears and
stretches (Reissner 1972) on the same layer, by multiple shooting (`tests/verification/strip_on_layer/beam.py`).
""", lifted),
    Section("V32 Strip on a contact layer: strip over a cylinder", f"""
A strip of 80 x 1 mm, elements of 0.25 mm, is bent over a cylinder of radius {RADIUS:g} mm with the default layer by
vertical dead loads at its ends. At 7.5 N/mm it touches in the middle; at 20 N/mm it lies on the cylinder, the moment
there is nearly E' I/R, and leaves it with the pressure of a line force that the layer spreads. Expected: the same rod,
with large rotations: outside the contact the elastica.
""", wrapped, after="""
Lines: the rod.
"""),
]
