# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of the cards of LS-DYNA by the laws of a material."""

from collections.abc import Callable, Mapping

import numpy as np

from dd3.dyna import fields
from dd3.dyna.law_words import value_of, vector_of
from dd3.dyna.laws import AXES, CHABOCHE, ROWS
from dd3.dyna.material_laws import Hardening, Laws
from dd3.dyna.plane_criterion import Eight, Quadratic
from dd3.errors import Problem

DENSITIES = ((1.4e5, 2.6e5, 7.85e-9, "steel"), (5e4, 9e4, 2.7e-9, "aluminium"), (3.5e4, 5e4, 1.77e-9, "magnesium"),
             (9e4, 1.4e5, 4.5e-9, "titanium"))  # by Young's modulus, MPa; t/mm3


def common(laws: Laws) -> dict[str, float | int]:
    """Return the fields that all cards begin with."""
    return {"MID": laws.options.mid, "RO": density(laws) / laws.units.density,
            "E": laws.young / laws.units.stress, "PR": laws.poisson}


def density(laws: Laws) -> float:
    """Return the density, t/mm3; one by Young's modulus is noted."""
    given = value_of(laws.block, "density") or laws.options.density
    if given:
        return given
    for low, high, value, metal in DENSITIES:
        if low <= laws.young < high:
            laws.notes.append(f"RO: no density in *MATERIAL; {value:g} t/mm3 of {metal} by Young's modulus")
            return value
    raise Problem(f"{laws.material.name}: no density in *MATERIAL, and none follows from E = {laws.young:g} MPa; "
                  "--density gives it")


def axes(laws: Laws, number: int) -> list[str]:
    """Return the rows of the material's axes behind AOPT."""
    if laws.options.by_element:
        vectors: dict[str, float | int] = {}
    else:
        rolling = np.array(vector_of(laws.block, "rolling_direction", (1.0, 0.0, 0.0)))
        normal = np.array(vector_of(laws.block, "normal_direction", (0.0, 0.0, 1.0)))
        across = np.cross(normal, rolling)
        vectors = dict(zip(("A1", "A2", "A3", "D1", "D2", "D3"), map(float, (*rolling, *across))))
    return [*fields.row(AXES[number][1], vectors), *fields.row(AXES[number][2], vectors)]


def aopt(laws: Laws) -> dict[str, float | int]:
    """Return the field AOPT."""
    return {"AOPT": 0.0 if laws.options.by_element else 2.0}


def isotropic(laws: Laws, number: int) -> list[str]:
    """Return *MAT_003, 018, 024: one of isotropic criteria."""
    names, unit = ROWS[number], laws.units.stress
    flow = laws.hardening(number) if number != 3 else Hardening("linear", laws.straight())
    if number == 18:
        start, factor, _, n = flow.values
        return [*fields.row(names[0], common(laws) | {"K": factor / unit, "N": n}),
                *fields.row(names[1], {"SIGY": start / unit})]
    if number == 3:
        slope, moved = flow.values[1], sum(law["k"] for law in laws.backstresses) / laws.scale**2
        values = common(laws) | {"SIGY": flow.values[0] / unit, "ETAN": laws.tangent(slope + moved) / unit,
                                 "BETA": slope / (slope + moved) if slope + moved else 1.0}
        return [*fields.row(names[0], values), *fields.row(names[1], {})]
    values, second = common(laws), dict[str, float | int]()
    if flow.form == "linear":
        values |= {"SIGY": flow.values[0] / unit, "ETAN": laws.tangent(flow.values[1]) / unit}
    else:
        second = {"LCSS": flow.label} | laws.speed(number)
        second |= {"VP": 1} if laws.rate.name != "none" and not laws.monotonic else {}
    return [*fields.row(names[0], values), *(line for name, given in zip(names[1:], (second, {}, {}))
                                             for line in fields.row(name, given))]


def johnson_cook(laws: Laws, number: int) -> list[str]:
    """Return *MAT_015 and 098."""
    law, names, unit = laws.law, ROWS[number], laws.units.stress
    second: dict[str, float | int] = {"A": law["y0"] / laws.scale / unit,
                                      "B": law["k"] / laws.scale**(1 + law["n"]) / unit, "N": law["n"]}
    first = common(laws)
    if laws.rate.name == "johnson_cook":
        first["VP"] = 1
        second |= {"C": laws.rate["c"], "EPSO": laws.rate["reference"] * laws.scale * laws.units.time}
    if number == 98:
        return [*fields.row(names[0], first), *fields.row(names[1], second)]
    first["G"] = laws.young / (2 * (1 + laws.poisson)) / unit
    second |= {"M": laws.temperature["m"], "TM": laws.temperature["tm"], "TR": laws.temperature["tr"]}
    heat = (value_of(laws.block, "heat_capacity") or 0.0) / (value_of(laws.block, "heat_fraction", 0.9) or 0.9)
    laws.notes.append("heat_fraction: CP is heat_capacity/heat_fraction; solids need an *EOS")
    return [*fields.row(names[0], first), *fields.row(names[1], second),
            *fields.row(names[2], {"CP": heat / (laws.units.length * laws.units.acceleration)}),
            *fields.row(names[3], {})]


def by_r(laws: Laws, number: int) -> list[str]:
    """Return *MAT_036, 037 and 122: Hill's criterion by r-values."""
    assert isinstance(laws.plane, Quadratic)
    names, unit, flow, first = ROWS[number], laws.units.stress, laws.hardening(number), common(laws)
    if number == 37:
        first |= {"R": laws.plane.r[0]} | ({"HLCID": flow.label} if flow.label else {
            "SIGY": flow.values[0] / unit, "ETAN": laws.tangent(flow.values[1]) / unit})
        return [*fields.row(names[0], first), *fields.row(names[1], chord(laws))]
    second: dict[str, float | int] = dict(zip(("R00", "R45", "R90"), laws.plane.r))
    if flow.form == "linear":
        first |= {"HR": 1, "P1": laws.tangent(flow.values[1]) / unit, "P2": flow.values[0] / unit}
    elif flow.form == "swift":
        first |= {"HR": 2, "P1": flow.values[1] / unit, "P2": flow.values[3]}
        second["E0"] = flow.values[2]
    else:
        first["HR"], second["LCID"] = 3, flow.label
    back = back_rows(laws) if number == 36 else []
    if number == 36:
        second["M"] = -2.0 if back else 2.0
    if laws.speed(number):
        laws.notes.append("rate: C and P of *MAT_036, which has no VP")
    return [*fields.row(names[0], first), *fields.row(names[1], second), *back,
            *fields.row(AXES[number][0], aopt(laws) | laws.speed(number)), *axes(laws, number)]


def back_rows(laws: Laws) -> list[str]:
    """Return the row of back-stresses of Chaboche."""
    if laws.monotonic or not laws.backstresses:
        return []
    values: dict[str, float | int] = {}
    for k, law in enumerate(laws.backstresses, 1):
        values |= {f"CRC{k}": law["cx"] / laws.scale, f"CRA{k}": law["xsat"] / laws.scale / laws.units.stress}
    return fields.row(CHABOCHE, values)


def yld2000(laws: Laws, number: int) -> list[str]:
    """Return *MAT_133."""
    assert isinstance(laws.plane, Eight)
    names, flow, back = ROWS[number], laws.hardening(number), back_rows(laws)
    second: dict[str, float | int] = {"A": -laws.plane.exponent if back else laws.plane.exponent}
    if flow.form == "swift":
        second |= {"K": flow.values[1] / laws.units.stress, "E0": flow.values[2], "N": flow.values[3], "HARD": 1}
    else:
        second["HARD"] = -flow.label
    return [*fields.row(names[0], common(laws) | {"FIT": 0, "ISCALE": 1}), *fields.row(names[1], second), *back,
            *alpha(laws), *fields.row(AXES[number][0], aopt(laws)), *axes(laws, number)]


def alpha(laws: Laws) -> list[str]:
    """Return the row of the coefficients of Yld2000-2d."""
    assert isinstance(laws.plane, Eight)
    values = {f"ALPHA{k}": value for k, value in enumerate(laws.plane.alpha, 1)}
    return fields.row(" ".join(values), values)


def chord(laws: Laws) -> dict[str, float | int]:
    """Return EA and COE of the chord modulus."""
    if laws.modulus.name != "chord":
        return {}
    return {"EA": laws.modulus["ea"] / laws.units.stress, "COE": laws.modulus["xi"] / laws.scale}


def two_surfaces(laws: Laws, number: int) -> list[str]:
    """Return *MAT_125, 226 and 242."""
    law, names, s, first = laws.law, ROWS[number], laws.scale, common(laws)
    stress = 1 / s / laws.units.stress
    own: dict[str, float | int] = {"CB": law["b"] * stress, "Y": law["y"] * stress, "SC": law["c"] / s,
                                   "K": law["m"] / s, "RSAT": law["rsat"] * stress, "SB": law["b_sat"] * stress,
                                   "H": law["h"]}
    if number == 242:
        assert isinstance(laws.plane, Eight)
        return [*fields.row(names[0], first | chord(laws) | {"M": laws.plane.exponent}), *alpha(laws),
                *fields.row(names[2], own), *fields.row(names[3], aopt(laws) | {"IOPT": 0}), *axes(laws, number)]
    assert isinstance(laws.plane, Quadratic)
    if number == 125:
        return [*fields.row(names[0], first | {"R": laws.plane.r[0]}), *fields.row(names[1], own),
                *fields.row(names[2], chord(laws) | {"IOPT": 0})]
    r = dict(zip(("R00", "R45", "R90"), laws.plane.r))
    return [*fields.row(names[0], first | {"M": 2.0} | r), *fields.row(names[1], own),
            *fields.row(names[2], aopt(laws) | chord(laws) | {"IOPT": 0}), *axes(laws, number)]


ROWS_OF: Mapping[int, Callable[[Laws, int], list[str]]] = {
    3: isotropic, 15: johnson_cook, 18: isotropic, 24: isotropic, 36: by_r,
    37: by_r, 98: johnson_cook, 122: by_r, 125: two_surfaces, 133: yld2000,
    226: two_surfaces, 242: two_surfaces}
