# SPDX-License-Identifier: GPL-3.0-or-later
"""Closed forms of the cases that gathered.py takes from tests/cases. None of them uses the program."""
import math

YOUNG, POISSON = 2.1e5, 0.3
SWIFT = (565.0, 0.007117, 0.259)
HILL = {"F": 0.284, "G": 0.358, "H": 0.642, "N": 1.289}
FRICTION = 0.144


def bisect(function, low, high):
    """Return a zero of a function between two places."""
    sign = function(low) > 0
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if (function(middle) > 0) == sign else (low, middle)
    return 0.5 * (low + high)


def swift(plastic):
    """Return the flow stress."""
    factor, start, exponent = SWIFT
    return factor * (start + plastic) ** exponent


def tension_elastic(stretch, area):
    """Return force and lateral stretch of a bar with Hencky's elasticity."""
    strain = math.log(stretch)
    lateral = math.exp(-POISSON * strain)
    return YOUNG * strain * area * lateral**2, lateral


def tension_plastic(stretch, area):
    """Return force and lateral stretch of an isotropic bar with Swift's law."""
    strain = math.log(stretch)
    plastic = bisect(lambda p: swift(p) / YOUNG + p - strain, 0.0, strain)
    lateral = math.exp(-POISSON * swift(plastic) / YOUNG - plastic / 2)
    return swift(plastic) * area * lateral**2, lateral


def hill_tension(angle):
    """Return stress ratio and r-value of Hill's criterion of 1948 in tension at an angle to rolling, degrees."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    f, g, h, n = (HILL[name] for name in "FGHN")
    square = f * s**4 + g * c**4 + h * (c * c - s * s) ** 2 + 2 * n * s * s * c * c
    r = (h + (2 * n - f - g - 4 * h) * s * s * c * c) / (f * s * s + g * c * c)
    return 1 / math.sqrt(square), r


def hill_bar(angle, plastic, length=10.0, area=100.0):
    """Return elongation, force and r-value of a bar at an axial plastic strain."""
    ratio, r = hill_tension(angle)
    stress = ratio * swift(ratio * plastic)
    force = stress * area * math.exp(-plastic - 2 * POISSON * stress / YOUNG)
    return length * math.expm1(plastic + stress / YOUNG), force, r


def hill_ratios():
    """Return stress over flow stress by Hill's criterion: equal biaxial, along rolling in plane strain, shear."""
    f, g, h, n = (HILL[name] for name in "FGHN")
    second = h / (f + h)  # ratio of the stresses without transverse strain
    plane = 1 / math.sqrt(f * second**2 + g + h * (1 - second) ** 2)
    return 1 / math.sqrt(f + g), plane, plane * second, 1 / math.sqrt(2 * n)


def hill_plane_strain(strain, steps=4000):
    """Return s11 and s22 over the flow stress by Hill's criterion at a strain along rolling, without transverse strain.

    Plane stress, from the rates with the elastic strains; Runge and Kutta, in the logarithm of the strain.
    """
    f, g, h, _ = (HILL[name] for name in "FGHN")
    modulus = YOUNG / (1 - POISSON**2)

    def size(s1, s2):
        return math.sqrt(f * s2 * s2 + g * s1 * s1 + h * (s1 - s2) ** 2)

    def rates(state):
        """Return the derivatives of s11, s22 and plastic strain by the strain."""
        s1, s2, plastic = state
        n1, n2 = (g * s1 + h * (s1 - s2)) / size(s1, s2), (f * s2 - h * (s1 - s2)) / size(s1, s2)
        c1, c2 = modulus * (n1 + POISSON * n2), modulus * (n2 + POISSON * n1)
        flow = c1 / (n1 * c1 + n2 * c2 + SWIFT[2] * swift(plastic) / (SWIFT[1] + plastic))
        return modulus - flow * c1, POISSON * modulus - flow * c2, flow

    first = swift(0.0) / (modulus * size(1.0, POISSON))
    state, step = (modulus * first, POISSON * modulus * first, 0.0), math.log(strain / first) / steps
    for i in range(steps):
        stages = []
        for back in (0.0, 0.5, 0.5, 1.0):
            here = [value + back * step * stages[-1][j] for j, value in enumerate(state)] if stages else state
            scale = first * math.exp((i + back) * step)
            stages.append([scale * rate for rate in rates(here)])
        state = tuple(value + step / 6 * (a + 2 * b + 2 * c + d) for value, a, b, c, d in zip(state, *stages))
    return state[0] / swift(state[2]), state[1] / swift(state[2])


def stretched_block(stretch, area):
    """Return the axial force of a block of Swift's law that is stretched with its sides held."""
    strain, shear = math.log(stretch), YOUNG / 2 / (1 + POISSON)
    plastic = bisect(lambda p: 2 * shear * strain - 3 * shear * p - swift(p), 0.0, strain)
    return area * (YOUNG / 3 / (1 - 2 * POISSON) * strain + 2 / 3 * swift(plastic))


def dienes(shear):
    """Return s11 and s12 over G of a hypoelastic material in simple shear, Jaumann rate (Dienes 1979)."""
    return 1 - math.cos(shear), math.sin(shear)


def armstrong_frederick(plastic, reversed_by):
    """Return the stress after tension to a plastic strain, and after a reversed plastic strain, MPa."""
    rate, limit = 50.0, 60.0
    flow = [200 + 100 * (1 - math.exp(-10 * p)) for p in (plastic, plastic + reversed_by)]
    first = limit * (1 - math.exp(-rate * plastic))
    second = -limit + (limit + first) * math.exp(-rate * reversed_by)
    return flow[0] + first, second - flow[1]


def bending(ratio):
    """Return M/M_e and the residual curvature over that of first yield, of a perfectly plastic rectangle."""
    moment = 1.5 - 0.5 / ratio**2
    return moment, ratio - moment


def drag(place, load=2.0, friction=0.2, radius=10.0):
    """Return the horizontal force on an edge that is drawn over the top of a cylinder to a place along x."""
    return -load * math.tan(math.asin(place / radius) - math.atan(friction))


def drag_normal(place, load=2.0, friction=0.2, radius=10.0):
    """Return the normal force on the edge that is drawn over a cylinder."""
    angle = math.atan(friction)
    return load * math.cos(angle) / math.cos(math.asin(place / radius) - angle)


def drag_work(first, last, friction=0.2, radius=10.0, steps=1000):
    """Return the friction work on the edge between two places: the force times the arc, by Simpson's rule."""
    start, step = math.asin(first / radius), (math.asin(last / radius) - math.asin(first / radius)) / steps
    weights = [1 if n in (0, steps) else 4 if n % 2 else 2 for n in range(steps + 1)]
    return friction * radius * step / 3 * sum(weight * drag_normal(radius * math.sin(start + n * step), radius=radius)
                                              for n, weight in enumerate(weights))


def layer_gap(pressure):
    """Return the part of a contact layer that is left under a pressure over p_0."""
    return 2 / (2 + pressure + math.sqrt(pressure * (pressure + 4)))


def layer_energy(left):
    """Return the energy of a contact layer over F_0 h, by the part that is left of it."""
    return (1 - left) * (left - 3) / 2 - math.log(left)


def belt(angle=math.pi / 2):
    """Return the ratio of the tensions of a belt (Euler, Eytelwein)."""
    return math.exp(FRICTION * angle)
