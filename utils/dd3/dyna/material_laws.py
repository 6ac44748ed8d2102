# SPDX-License-Identifier: GPL-3.0-or-later
"""What cards of LS-DYNA can have of a material: its criterion in plane stress, its flow stress along rolling."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dd3.dyna import fields, flow_curves, plane_criterion
from dd3.dyna.flow_curves import Flow
from dd3.dyna.hardening import Units
from dd3.dyna.law_words import value_of, words_of
from dd3.dyna.laws import UNITS
from dd3.dyna.plane_criterion import Eight, Quadratic
from dd3.errors import Problem
from dd3.laws import Material

KEYWORDS = {3: "PLASTIC_KINEMATIC", 15: "JOHNSON_COOK", 18: "POWER_LAW_PLASTICITY", 24: "PIECEWISE_LINEAR_PLASTICITY",
            36: "3-PARAMETER_BARLAT", 37: "TRANSVERSELY_ANISOTROPIC_ELASTIC_PLASTIC", 98: "SIMPLIFIED_JOHNSON_COOK",
            122: "HILL_3R", 125: "KINEMATIC_HARDENING_TRANSVERSELY_ANISOTROPIC", 133: "BARLAT_YLD2000",
            226: "KINEMATIC_HARDENING_BARLAT89", 242: "KINEMATIC_HARDENING_BARLAT2000"}
SOLIDS = (3, 15, 18, 24, 98)  # cards for solids too
ELSEWHERE = {"yld2004": "; *MAT_199, for solids, is not written",
             "cpb06": ", without the difference of tension and compression; *MAT_233 is not written"}
MOST_BACKSTRESSES = 4
SMALL_STRESS = 0.02  # of *MAT_018: a SIGY below is a strain
LABELS = 100  # numbers of curves and tables of a material


@dataclass(frozen=True)
class CardOptions:
    """How a material is written.

    card: number of the card, such as 36; left out: the first that has all. nearest: take the nearest card where none
    has all. units: of the cards. mid: their number, that of curves begins with it. strain: largest plastic strain of
    curves. density: t/mm3, where *MATERIAL has none. erosion: elements beyond the forming limit curve are deleted.
    by_element: axes by the elements' nodes and their BETA, in place of the vector of the rolling direction.
    """

    card: int | None = None
    nearest: bool = False
    units: str = "mm MPa"
    mid: int = 1
    strain: float = 1.0
    density: float | None = None
    erosion: bool = False
    by_element: bool = False

    def __post_init__(self) -> None:
        if self.units not in UNITS:
            raise Problem(f"units '{self.units}': expected {', '.join(UNITS)}")
        if self.card is not None and self.card not in KEYWORDS:
            raise Problem(f"card {self.card}: expected {' '.join(f'{number:03d}' for number in KEYWORDS)}")
        if not 0.01 <= self.strain <= 10 or self.mid < 1 or not (self.density is None or self.density > 0):
            raise Problem("expected a largest strain of 0.01 to 10, a number of the material from 1 on, a density > 0")


def percent(value: float) -> str:
    """Return a fraction in per cent."""
    return f"{100 * value:.2g} %" if abs(value) > 1e-12 else "0 %"


@dataclass
class Hardening:
    """What the card has of the flow stress: by its own form, or the number of a curve or table."""

    form: str = "curve"  # or linear, swift
    values: tuple[float, ...] = ()
    label: int = 0


class Laws:
    """The laws of a material, with notes on how a card has them, and what no card has."""

    def __init__(self, material: Material, options: CardOptions) -> None:
        self.material, self.options = material, options
        _, _, length, stress = UNITS[options.units]
        self.units = Units(options.units, length, stress)
        block = self.block = material.block
        self.young, self.poisson = value_of(block, "young") or 0.0, value_of(block, "poisson") or 0.0
        self.criterion, self.law, self.rate, self.modulus, self.temperature, self.fracture = (
            words_of(block.value(key)) for key in ("yield", "hardening", "rate", "modulus", "temperature", "fracture"))
        self.backstresses = [law for key, value in block.values if key == "backstress"
                             and (law := words_of(value)).name != "none"]
        self.notes: list[str] = []
        self.losses: list[str] = []
        self.tail: list[str] = []  # curves and tables
        self.curves: list[flow_curves.Sampled] = []
        self.label = LABELS * options.mid
        self.monotonic = False  # back-stresses or a history are replaced by the curve of tension

    @cached_property
    def plane(self) -> Quadratic | Eight:
        """The criterion in plane stress."""
        if hill := plane_criterion.quadratic(self.material):
            return hill
        own = self.criterion
        if own.name == "yld2000":
            alpha = tuple(own.values.get(f"alpha{k}", 1.0) for k in range(1, 9))
            return plane_criterion.compared(plane_criterion.of_library(self.material), Eight(alpha, own["m"]))
        exponents = (own["m"],) if own.name in ("yld91", "yld2004", "hosford") else \
            (6.0, 8.0, *([2 * own["k"]] if own.name in ("karafillis_boyce", "bbc2008") else []))
        near = plane_criterion.nearest_yld2000(self.material, exponents)
        if near.locus > plane_criterion.SAME:
            self.lose(f"yield = {own.name}", f"Yld2000-2d by eight values of it, m = {near.exponent:g}: yield stress "
                      f"in tension within {100 * near.tension:.2g} %, in plane stress {100 * near.locus:.2g} %, "
                      f"r-values within {near.r:.2g}" + ELSEWHERE.get(own.name, ""))
        else:
            self.notes.append(f"yield: {own.name} is Yld2000-2d in plane stress")
        return near

    @property
    def scale(self) -> float:
        """The equivalent stress of unit tension along rolling, where the card takes it as 1."""
        return self.plane.scale if isinstance(self.plane, Quadratic) else 1.0

    @cached_property
    def is_isotropic(self) -> bool:
        """Whether the criterion is that of von Mises, the shears across the thickness included."""
        if not isinstance(self.plane, Quadratic) or max(abs(r - 1) for r in self.plane.r) > plane_criterion.SAME:
            return False
        shears = [self.material.equivalent_stress(np.eye(6)[i]) / self.plane.scale for i in (3, 4, 5)]
        return bool(np.abs(np.array(shears) / np.sqrt(3) - 1).max() < plane_criterion.SAME)

    def lose(self, law: str, nearest: str) -> None:
        """Note a law that no card has, and what stands for it."""
        self.losses.append(f"{law}: {nearest}")

    def candidates(self) -> list[int]:
        """Return the numbers of the cards that are possible, the best first; note what they leave out."""
        plane, hardening = self.plane, self.law.name
        if hardening == "yoshida_uemori":
            return self.of_two_surfaces()
        if self.modulus.name != "none":
            if self.has_echange():
                return [37]
            self.lose(f"modulus = {self.modulus.text}", "constant E; EA and COE belong to yoshida_uemori, and to "
                      "isotropic hardening with one r-value")
        if hardening == "teodosiu_hu":
            self.lose("hardening = teodosiu_hu", "isotropic hardening by its curve of tension, without its change at "
                      "reversals and turns of the path")
            self.monotonic = True
        names = {law.name for law in self.backstresses}
        rate, heated = self.rate.name != "none", self.temperature.name != "none"
        if names == {"prager"} and hardening in ("linear", "perfect") and self.is_isotropic and not rate | heated:
            return [3]
        if names == {"lemaitre_chaboche"} and len(self.backstresses) <= MOST_BACKSTRESSES and not self.monotonic:
            return [36] if isinstance(plane, Quadratic) else [133]
        if names:
            self.lose(" and ".join(f"backstress = {law.text}" for law in self.backstresses),
                      "isotropic hardening by the curve of tension, without early flow after reversals"
                      + (f"; up to {MOST_BACKSTRESSES} of lemaitre_chaboche alone have a card"))
            self.monotonic = True
        heats = self.heats()
        if not isinstance(plane, Quadratic):
            return [133]
        if not self.is_isotropic:
            even = [37] if len(set(plane.r)) == 1 else []
            return [36] if rate else [36, 122, *even]
        if hardening == "ludwik" and not self.monotonic and self.rate.name in ("none", "johnson_cook"):
            if heats:
                return [15]
            if not heated:
                return [98, 24] if rate else [24, 98]
        power = hardening == "swift" and not rate and not heated and not self.monotonic
        power = power and self.swift()[0] > SMALL_STRESS * self.units.stress
        return [24, *[18] * power, 36, *([] if rate else [122, 37])]

    def has_echange(self) -> bool:
        """Return whether the material is that of *MAT_037_ECHANGE: one r-value, isotropic hardening, chord modulus."""
        others = (self.rate.name, self.temperature.name, *(law.name for law in self.backstresses))
        return (self.modulus.name == "chord" and isinstance(self.plane, Quadratic) and len(set(self.plane.r)) == 1
                and self.law.name != "teodosiu_hu" and set(others) == {"none"})

    def of_two_surfaces(self) -> list[int]:
        """Return the cards with Yoshida and Uemori's law."""
        if self.modulus.name == "table":
            self.lose(f"modulus = {self.modulus.text}", "constant E")
        for key, law in (("rate", self.rate), ("temperature", self.temperature)):
            if law.name != "none":
                self.lose(f"{key} = {law.text}", "without influence")
        if self.backstresses:
            self.lose(" and ".join(f"backstress = {law.text}" for law in self.backstresses),
                      "yoshida_uemori alone, with its own back-stress")
        if not isinstance(self.plane, Quadratic):
            return [242]
        return [125, 226] if len(set(self.plane.r)) == 1 else [226]

    def heats(self) -> bool:
        """Return whether the card is one of adiabatic heating; note where it cannot be."""
        if self.temperature.name == "none":
            return False
        capacity = value_of(self.block, "heat_capacity")
        start = value_of(self.block, "initial_temperature", 20.0)
        if capacity is None:
            self.notes.append(f"temperature: constant, the flow stress at {start:g}")
            return False
        possible = (self.is_isotropic and self.law.name == "ludwik" and self.rate.name in ("none", "johnson_cook")
                    and self.temperature.name == "johnson_cook" and not self.monotonic)
        if possible and self.temperature["tr"] == start:
            return True
        self.lose(f"temperature = {self.temperature.text} with heat_capacity", f"the flow stress at {start:g}; "
                  "*MAT_015 has von_mises with ludwik, johnson_cook and initial_temperature = Tr")
        return False

    def swift(self) -> tuple[float, float, float, float]:
        """Return the first flow stress, K, e0 and n of Swift's law along rolling."""
        law, s = self.law, self.scale
        factor, n = law["k"], law["n"]
        start = law.values.get("e0", (law.values.get("y0", 0.0) / factor)**(1 / n) if "y0" in law.values else 0.0)
        return factor * start**n / s, factor / s**(1 + n), s * start, n

    def tangent(self, slope: float) -> float:
        """Return the tangent modulus of a slope of the flow stress over the plastic strain."""
        return self.young * slope / (self.young + slope)

    def straight(self) -> tuple[float, float]:
        """Return yield stress and slope of linear hardening along rolling."""
        return self.law["y0"] / self.scale, self.law.values.get("h", 0.0) / self.scale**2

    @cached_property
    def flow(self) -> Flow:
        """The flow stress along rolling by plastic strain and rate."""
        if self.monotonic:
            return flow_curves.in_tension(self.material, self.scale, self.options.strain)
        terms = [(law["cx"], law["xsat"]) for law in self.backstresses if law.name == "lemaitre_chaboche"]
        return flow_curves.flow_of(self.material, self.scale, terms)

    def hardening(self, number: int) -> Hardening:
        """Return the flow stress of a card, by its own form where it has one."""
        apart = self.rate.name == "none" or bool(self.speed(number))  # the rate from the curve
        if self.monotonic and self.rate.name != "none":
            self.lose(f"rate = {self.rate.text}", "the curve of tension at rest")
        own = not self.backstresses and self.temperature.name == "none" and not self.monotonic and apart
        if own and self.law.name in ("linear", "perfect") and number != 133 and (number, self.rate.name) != (
                24, "cowper_symonds"):
            return Hardening("linear", self.straight())
        if own and self.law.name == "swift" and number in (18, 36, 122, 133):
            return Hardening("swift", self.swift())
        if apart or self.monotonic:
            return Hardening(label=self.new_curve(0.0, ""))
        return Hardening(label=self.new_table())

    def new_curve(self, rate: float, at: str) -> int:
        """Add a curve of the flow stress at a rate; return its number."""
        self.label += 1
        one = flow_curves.sampled(lambda p: self.flow(p, rate), self.options.strain)
        title = f"{self.material.name}: flow stress{at} over the plastic strain"
        points = one.points * (1, 1 / self.units.stress)
        self.tail += fields.curve(self.label, title, points, one.intervals)
        self.curves.append(one)
        return self.label

    def said_of_curves(self) -> list[str]:
        """Return what is to be said of the curves of the flow stress."""
        if not self.curves:
            return []
        points, intervals = max(len(one.points) for one in self.curves), max(one.intervals for one in self.curves)
        return [f"flow stress: {len(self.curves)} curve{'s' * (len(self.curves) > 1)} of up to {points} points to a "
                f"plastic strain of {self.options.strain:g}, beyond it straight; between them off by up to "
                f"{percent(max(one.error for one in self.curves))}, by LCINT = {intervals} equal intervals, from "
                f"{flow_curves.FIRST:g} on, by {percent(max(one.even_error for one in self.curves))}"]

    def rates(self) -> tuple[list[float], bool]:
        """Return the rates of a table, 1/s, and whether the flow stress is straight over their logarithm."""
        law = self.rate
        found = list(np.geomspace(*flow_curves.RATES, flow_curves.MOST_RATES))
        if law.name == "johnson_cook":
            found = [law["reference"], max(flow_curves.RATES[1], 1e3 * law["reference"])]
        elif law.name == "curves":
            found = [law[f"r{k}"] for k in range(1, flow_curves.MOST_RATES + 1) if f"r{k}" in law.values]
        elif law.name == "table" and 2 <= len(law.pairs) <= flow_curves.MOST_RATES:
            found = [rate for rate, _ in law.pairs]
        return [float(rate) * self.scale for rate in found], law.values.get("logarithm", 1.0) != 0

    def new_table(self) -> int:
        """Add a table of curves by rates; return its number."""
        self.label += 1
        number, (rates, logarithmic) = self.label, self.rates()
        labels = [self.new_curve(rate, f" at {rate:.4g} /s") for rate in rates]
        values = [rate * self.units.time for rate in rates]
        if logarithmic:
            if min(values) >= 1:  # a negative value says that all are logarithms
                values, labels = [np.exp(-1.0), *values], [labels[0], *labels]
            values = [float(np.log(value)) for value in values]
        self.tail += fields.table(number, f"{self.material.name}: curves by the "
                                  + "logarithm of the strain rate" * logarithmic + "strain rate" * (not logarithmic),
                                  list(zip(values, labels)))
        error = flow_curves.rate_error(self.flow, rates, logarithmic, self.options.strain)
        below = self.flow(0.0, rates[0]) / self.flow(0.0, 0.0) - 1
        said = f", at rest too large by {percent(below)}" if below > 1e-9 else ""
        self.notes.append(f"rate: {self.rate.name} as table {number} of {len(rates)} curves, {rates[0]:.3g} to "
                          f"{rates[-1]:.3g} /s, straight over the {'logarithm of the ' * logarithmic}rate: off by up "
                          f"to {percent(error)}; constant beyond{said}")
        return number

    def speed(self, number: int) -> dict[str, float | int]:
        """Return C and P of Cowper and Symonds, where a card has them and the rate is not that of a table: with
        back-stresses, which do not depend on the rate."""
        if self.rate.name != "cowper_symonds" or self.backstresses or self.monotonic or number not in (24, 36):
            return {}
        return {"C": self.rate["c"] * self.scale * self.units.time, "P": self.rate["p"]}
