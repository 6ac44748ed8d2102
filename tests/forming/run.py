#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "forming", "timeout": 400}
"""Compare the results of forming in fields.vtkhdf and history.csv with closed forms.

    run.py --program build/release/dd3imp --work build/forming
"""
import math
import sys
from pathlib import Path

import numpy as np

from dd3.fields import Fields
from dd3.programs import parser_of_runs

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
from bench import Bench  # noqa: E402

K, E0, N, YOUNG, POISSON = 565.0, 0.007117, 0.259, 2.1e5, 0.3
MATERIAL = f"*MATERIAL steel\n  young = {YOUNG}\n  poisson = {POISSON}\n  yield = von_mises\n" \
           f"  hardening = swift K={K} e0={E0} n={N}\n"
FINE = "*NEWTON\n  tolerance = 1e-9\n*LIMITS\n  strain = 0.002\n  rotation = off\n"


def fixed(**sets):
    """Return the supports of node sets, each with its directions."""
    return "".join(f"*BOUNDARY {name}\n  set = {name}\n  fix = {directions}\n" for name, directions in sets.items())


PLANE_STRAIN = fixed(x_min="x", all="y", z_min="z")
STRETCH = """*BLANK sheet
  size = 10 4 1
  divisions = 5 2 1
  element = {element}
  material = steel
*PHASE stretch
  control = load
  trial = 0.02
  displace = x_max x 2
*HISTORY end
  set = x_max
  quantities = displacement draw_in
*OUTPUT
  fields = increments 1000
""" + PLANE_STRAIN + MATERIAL + FINE
SHEAR = """*BLANK sheet
  size = 10 10 1
  divisions = 1 1 1
  element = {element}
  material = steel
*PHASE shear
  control = load
  trial = 0.02
  displace = y_max x 3
  displace = y_max y 0
*OUTPUT
  fields = increments 1000
""" + fixed(y_min="x y z", all="z") + MATERIAL + FINE
PRESS = """*BLANK sheet
  size = 10 6 1
  divisions = 4 3 2
  element = {element}
  material = rubber
*MATERIAL rubber
  young = 100
  poisson = 0
  yield = von_mises
  hardening = perfect Y0=1e3
*TOOL table
  patches = "{folder}/table.bez"
  contact = z_min
*CONTACT
  search_distance = 0.5
*NEWTON
  tolerance = 1e-9
*PHASE press
  control = load
  trial = 0.5
  hold = table
  pressure = z_max 1.2
""" + fixed(x_min="x", y_min="y")
# A rigid cylinder of radius 100 mm on an elastic block in plane strain, one half: elements of 0.1 mm at the contact.
HERTZ_RADIUS, HERTZ_YOUNG = 100.0, 1000.0
HERTZ = """*BLANK block
  size = 10 0.2 10
  divisions = {nx} 1 {nz}
  grading_x = {x}
  grading_z = {z}
  material = soft
*MATERIAL soft
  young = {young}
  poisson = {poisson}
  yield = von_mises
  hardening = perfect Y0=1e4
*TOOL cylinder
  patches = "{patches}"
  contact = z_max
  position = 0 0 10
*CONTACT
  formulation = mixed
*NEWTON
  tolerance = 1e-6
*PHASE press
  control = load
  trial = 0.5
  press = cylinder 0 0 {force}
""" + PLANE_STRAIN
SLIDE = ROOT / "tests" / "cases" / "friction_slide"


class Results:
    """Fields of the last step, and the last row of the history."""

    def __init__(self, run):
        self.fields = Fields(run.folder)
        self.last = run.last

    def field(self, name, at_cells=False, phase=None):
        """Return a field at the end of a phase, the last one by default."""
        phases = self.fields.file["job/phase"][: self.fields.count]
        return self.fields.values(np.flatnonzero(phases == (phase or phases[-1]))[-1], name, at_cells)[0]

    def __getitem__(self, column):
        return self.last(column)


def run(options, name, text):
    """Run a deck and return its results."""
    return Results(Bench(options.program, options.work).run(name, text))


def close(what, value, expected, relative=1e-9, absolute=1e-9):
    """Check values, all of them."""
    error = np.max(np.abs(np.asarray(value, float) - expected) - absolute - relative * np.abs(expected))
    assert error <= 0.0, f"{what}: {value}, expected {expected}, tolerances {relative} and {absolute}"


def check_energy(name, found, relative):
    """Check that the work on the sheet is the internal and the friction work, and the latter elastic and plastic."""
    work = found["tool_work"] + found["external_work"]
    close(f"{name}: energy_error", found["energy_error"], work - found["internal_work"] - found["friction_work"],
          absolute=1e-6 * abs(work))
    close(f"{name}: energy balance", found["energy_error"], 0.0, absolute=relative * abs(work))
    close(f"{name}: internal work", found["internal_work"], found["elastic_energy"] + found["plastic_work"], relative)


def plastic_work(strain):
    """Return the work per volume up to an equivalent plastic strain, MPa."""
    return K / (N + 1) * ((E0 + strain) ** (N + 1) - E0 ** (N + 1))


def check_stretch(options, element):
    """Plane strain: von Mises, p = 2/sqrt(3) e1; the volume changes by (1 - 2 nu)/E times the trace of the stress."""
    name = f"stretch_{element}"
    found = run(options, name, STRETCH.format(element=element))
    strain = math.log(1.2)
    for face in ("lower", "middle", "upper"):
        close(f"{name}: major strain", found.field(f"major_strain_{face}"), strain)
        close(f"{name}: minor strain", found.field(f"minor_strain_{face}"), 0.0)
    yield_stress = K * (E0 + 2 / math.sqrt(3) * strain) ** N
    dilatation = (1 - 2 * POISSON) / YOUNG * math.sqrt(3) * yield_stress
    for cells in (False, True):
        close(f"{name}: thinning", found.field("thinning", cells), 1 - math.exp(dilatation - strain), 0.0, 1e-4)
        close(f"{name}: thickness", found.field("thickness", cells), 1 - found.field("thinning", cells))
    plastic = strain - 2 / math.sqrt(3) * yield_stress * (1 - POISSON / 2) / YOUNG
    close(f"{name}: plastic work", found["plastic_work"], 40 * plastic_work(2 / math.sqrt(3) * plastic), 2e-3)
    check_energy(name, found, 2e-3)
    moved = found.field("displacement")[:, 0]
    sides = np.isclose(moved, 2.0)
    close(f"{name}: draw-in of the end", found.field("draw_in")[sides], -2.0)
    close(f"{name}: draw-in of the planes of symmetry", found.field("draw_in")[~sides], 0.0)
    close(f"{name}: column of the draw-in", found["end_draw_in"], -2.0)


def check_shear(options, element):
    """Simple shear of 0.3 in the plane of the sheet: strains asinh(0.15) and -asinh(0.15), no thinning."""
    name = f"shear_{element}"
    found = run(options, name, SHEAR.format(element=element))
    for face in ("lower", "middle", "upper"):
        close(f"{name}: major strain", found.field(f"major_strain_{face}"), math.asinh(0.15))
        close(f"{name}: minor strain", found.field(f"minor_strain_{face}"), -math.asinh(0.15))
    close(f"{name}: thinning", found.field("thinning"), 0.0)
    check_energy(name, found, 5e-3)


def check_press(options, element):
    """A block under a uniform pressure of 1.2 MPa on a table without friction: the same contact pressure everywhere."""
    name = f"press_{element}"
    found = run(options, name, PRESS.format(element=element, folder=SLIDE))
    bottom = found.field("contact_status") > 0
    assert bottom.any() and (found.field("contact_tool")[bottom] == 1).all(), f"{name}: no contact"
    close(f"{name}: pressure", found.field("contact_pressure")[bottom], 1.2, 1e-6)
    close(f"{name}: area", found["table_area"], 60.0, 1e-9)
    close(f"{name}: largest pressure", found["table_pressure"], 1.2, 1e-6)
    ratio = 1.2 / (1e-5 * 100)  # pressure over p_0 of the contact layer
    gap = 0.02 * 2 / (2 + ratio + math.sqrt(ratio * (ratio + 4)))
    close(f"{name}: gap", found.field("contact_gap")[bottom], gap, 1e-6)
    for field, value in (("contact_pressure", 0.0), ("contact_tool", 0), ("slip_path", 0.0), ("contact_gap", 0.5)):
        close(f"{name}: {field} elsewhere", found.field(field)[~bottom], value)


def graded(fine, count, ratio):
    """Return node lines from 0 to 1 (10 mm): `count` elements of a length in mm, then longer ones."""
    lines = [i * fine for i in range(count + 1)]
    while lines[-1] < 10:
        lines.append(min(10.0, lines[-1] + ratio * (lines[-1] - lines[-2])))
    return np.array([*lines[:-2], 10.0]) / 10  # the last but one is too near to the end


def check_hertz(options):
    """Line contact (Hertz): half width a = 1 mm, pressure E a/(2 R (1 - nu^2)) sqrt(1 - x^2/a^2)."""
    modulus = HERTZ_YOUNG / (1 - POISSON**2)
    largest, force = modulus / (2 * HERTZ_RADIUS), math.pi * modulus / (4 * HERTZ_RADIUS)
    angle = math.radians(20)
    ends, middle = HERTZ_RADIUS * math.sin(angle), HERTZ_RADIUS * (1 - 1 / math.cos(angle))
    rows = [f"{x} {y} {z} {weight}" for y in (1, -1) for x, z, weight in (
        (-ends, HERTZ_RADIUS * (1 - math.cos(angle)), 1), (0, middle, math.cos(angle)),
        (ends, HERTZ_RADIUS * (1 - math.cos(angle)), 1))]
    patches = options.work / "cylinder.bez"
    patches.write_text("\n".join(["patch 2 1 rational", *rows]) + "\n", encoding="utf-8")
    x, z = graded(0.1, 20, 1.35), graded(0.1, 1, 1.25)
    found = run(options, "hertz", HERTZ.format(
        nx=len(x) - 1, nz=len(z) - 1, x=" ".join(f"{v:.8g}" for v in x), z=" ".join(f"{1 - v:.8g}" for v in z[::-1]),
        young=HERTZ_YOUNG, poisson=POISSON, patches=patches.resolve(), force=-force * 0.2 / 2))
    start = found.fields.points(0)
    top = np.isclose(start[:, 2], 10) & (start[:, 0] < 0.85)
    close("hertz: pressure", found.field("contact_pressure")[top], largest * np.sqrt(1 - start[top, 0]**2), 0.01)
    close("hertz: largest pressure", found["cylinder_pressure"], largest, 0.005)
    close("hertz: area", found["cylinder_area"], 0.2, 0.0, 0.02)


def check_slide(options, element):
    """A block on a table under 120 N, dragged: it slides with the force 17.28 N.

    That of solid_shell is of a stiffer material: a load on one face against friction on the other shears an element of
    ten thicknesses too much (docs/solid_shell.md, Limits).
    """
    name = f"slide_{element}"
    text = (SLIDE / "case.dat").read_text(encoding="utf-8").replace("table.bez", str(SLIDE / "table.bez"))
    if element == "solid_shell":
        text = text.replace("young = 100\n", "young = 1e4\n")
    found = run(options, name, text.replace("element = hex8", f"element = {element}"))
    bottom = found.field("contact_status") > 0
    moved = found.field("displacement")[bottom, 0]
    assert moved.min() > 0.03, f"{name}: does not slide"
    slip = found.field("slip_path")[bottom]
    close(f"{name}: slip path", slip, moved, 0.0, 1e-5)
    # In the increment in which it begins to slide, the force grows from 16 N.
    close(f"{name}: friction work", found["friction_work"], 17.28 * slip.mean(), 5e-3)
    close(f"{name}: energy balance", found["energy_error"], 0.0, absolute=1e-3 * found["external_work"])


def main():
    options = parser_of_runs(__doc__).parse_args()
    check_hertz(options)
    for element in ("hex8", "solid_shell", "hex20", "hex27"):
        check_stretch(options, element)
    for element in ("hex8", "solid_shell"):  # middle nodes would have to be led too, and pressures are bilinear
        check_shear(options, element)
        check_press(options, element)
    for element in ("hex8", "solid_shell", "hex27"):
        check_slide(options, element)
    print("the results agree with the closed forms")


main()
