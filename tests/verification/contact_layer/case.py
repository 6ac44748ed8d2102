# SPDX-License-Identifier: GPL-3.0-or-later
"""A block on a table with a contact layer, rigid or elastic: gap, elastic slip, Coulomb's cone and energy."""
import math
import pathlib

from frame import Outcome, Section, Value

HERE = pathlib.Path(__file__).resolve().parent

HEIGHT, FORCE = 0.01, 1e-5 * 2.1e5 * 100.0  # of the layer: h, mm, and p_0 A, N
FRICTION, STICK = 0.144, 0.16  # progress of the drag at which the block still sticks


COMPLIANCE, AREA, LENGTH, YOUNG = 2e-3, 100.0, 1.0, 2.1e5  # of the elastic table, mm/MPa; of the block
ONSET, TRAVEL = 0.0005, 0.03  # travel of the table at first contact, and its whole travel, mm


def elastic(bench):
    """Compare force, deflection, slip and energies on an elastic table with those of springs in series."""
    found = bench.run("contact_layer_elastic", HERE / "case.dat", {"compliance": COMPLIANCE, "travel": TRAVEL})
    result = []
    travels, forces = found.column("travel", "press"), found.column("table_fz", "press")
    for i in (len(travels) // 4, len(travels) // 2, -1):
        result.append(Value(f"travel under {-forces[i]:.4g} N, mm", ONSET + closure(-forces[i]), travels[i], 1e-7))
    pressed = -found.last("table_fz", "press")
    left = part_left(pressed)
    pull, slip = (found.at(column, STICK, "drag") for column in ("table_fx", "bottom_ux"))
    ratios = [pulled / -force for pulled, force in zip(found.column("table_fx"), found.column("table_fz")) if force]
    stored = FORCE * HEIGHT * ((1 - left) * (left - 3) / 2 - math.log(left)) + COMPLIANCE / AREA * pressed**2 / 2
    result += [
        Value("gap at the end of the press, mm", left * HEIGHT - COMPLIANCE * pressed / AREA,
              found.last("bottom_z", "press") - found.last("table_uz", "press"), 1e-7),
        Value("deflection, mm", COMPLIANCE * pressed / AREA, found.last("table_deflection", "press"), 1e-8),
        Value("elastic slip, mm", pull * HEIGHT / (pressed + FORCE), slip, 1e-5),
        Value("largest quotient of the forces", FRICTION, max(ratios), 1e-6),
        Value("energy in layer and table, mJ", stored,
              found.last("tool_work", "press") - found.last("internal_work", "press"), 5e-4),
        Value("error of the energy balance over the work on the block", 0.0,
              found.last("energy_error") / (found.last("tool_work") + found.last("external_work")), 5e-4, absolute=True)]
    return Outcome(result)


def part_left(force):
    """Return the part of the layer that a force leaves."""
    pressure = force / FORCE
    return 2 / (2 + pressure + math.sqrt(pressure * (pressure + 4)))


def closure(force):
    """Return the travel of the table from the first contact to a force, mm: of layer, table and block in series."""
    return HEIGHT * (1 - part_left(force)) + force * (COMPLIANCE + LENGTH / YOUNG) / AREA


def values(bench):
    """Compare the forces with those of the gap and of the slip that the run found, and the energies."""
    result = []
    for element in ("hex8", "solid_shell", "hex27"):
        found = bench.run(f"contact_layer_{element}", HERE / "case.dat", {"element": element})
        gap = found.last("bottom_z", "press") - found.last("table_uz", "press")
        pressed = -found.last("table_fz", "press")
        left = gap / HEIGHT
        pull, slip = (found.at(column, STICK, "drag") for column in ("table_fx", "bottom_ux"))
        ratios = [pulled / -force for pulled, force in zip(found.column("table_fx"), found.column("table_fz")) if force]
        result += [
            Value(f"`{element}`: force of the gap, N", FORCE * (1 / left - 2 + left), pressed, 1e-8),
            Value(f"`{element}`: elastic slip, mm", pull * HEIGHT / (pressed + FORCE), slip, 1e-5),
            Value(f"`{element}`: largest quotient of the forces", FRICTION, max(ratios), 1e-6),
            Value(f"`{element}`: its value at the end", FRICTION, ratios[-1], 1e-6),
            Value(f"`{element}`: energy in the layer, mJ", FORCE * HEIGHT * ((1 - left) * (left - 3) / 2 - math.log(left)),
                  found.last("tool_work", "press") - found.last("internal_work", "press"), 5e-4),
            Value(f"`{element}`: error of the energy balance over the work on the block", 0.0,
                  found.last("energy_error") / (found.last("tool_work") + found.last("external_work")), 5e-4,
                  absolute=True)]
    return Outcome(result)


SECTIONS = [Section("V18 Block on a table: contact layer", """
A table is lifted to a block of 10 x 10 x 1 mm, E = 2.1e5, ν = 0, and presses it through its contact layer of
h = 0.01 mm; then the block is dragged, µ = 0.144. With F_0 = 1e-5 E A and x = g/h, g the gap that the run finds, the
normal force is F_0 (1/x - 2 + x). While the block sticks, its foot slips elastically by T h/(N + F_0), which is below
µ h; then T = µ N. The layer stores F_0 h [(1 - x)(x - 3)/2 - ln x]: work of the table less internal work. Works are
sums over increments of 1 % of h, whose error is of second order. Deck `tests/verification/contact_layer/case.dat`.
""", values),
            Section("V18 Block on a table: elastic tool", """
The same block on a table with a `compliance` of 0.002 mm/MPa, which is lifted by 0.03 mm: it deflects by more than the
height of its layer. Layer, table and block are springs in series: the travel from the first contact is
h (1 - x) + c F/A + F t/(E A), x the part of the layer that F leaves. The tangential forces are those of a rigid table
under the same normal force; the energy c F²/(2 A) of the table is added to that of the layer.
""", elastic)]
