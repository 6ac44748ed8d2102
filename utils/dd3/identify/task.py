# SPDX-License-Identifier: GPL-3.0-or-later
"""What is identified, and from what: the options of `dd3 identify` and `dd3 fit`."""

import argparse
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from dd3.identify import factors, friction, modulus
from dd3.identify.factors import RATE, TEMPERATURE
from dd3.identify.hardening import BACKSTRESSES, LAWS
from dd3.identify.measurements import Datum
from dd3.programs import add_program

YOUNG = 2.1e5  # MPa
FRACTURE = ("hosford_coulomb", "table")


@dataclass
class Task:
    """What is identified, and from what: the criterion, if it is given, from the data, the hardening from the curve,
    the law of fracture from its tests; laws of modulus, rate and temperature from tables or curves, those of friction
    from a table."""

    name: str
    program: str
    hardening: str | None = None  # name of a law to identify, or a law with its values
    criterion: str | None = None
    given: Mapping[str, float] = field(default_factory=dict)  # parameters of the criterion
    given_of: Mapping[str, Mapping[str, float]] = field(default_factory=dict)  # those of other laws, by their key
    yields: str = "von_mises"  # criterion of the curve where none is identified
    data: list[Datum] = field(default_factory=list)
    curve: str | None = None  # path of the table
    fracture: str | None = None  # likewise
    fracture_law: str = FRACTURE[0]
    fracture_exponent: float | None = None  # n of Hosford and Coulomb, or that of the growth of the damage
    modulus: str | None = None  # name of the law
    moduli: str | None = None  # path of the table
    rate: str | None = None
    rate_ratios: str | None = None
    rate_reference: float | None = None  # 1/s, of the ratios; 0: over the hardening law
    rate_curves: Sequence[str] = ()  # rate:path
    temperature: str | None = None
    temperature_ratios: str | None = None
    temperature_reference: float | None = None
    temperature_curves: Sequence[str] = ()
    friction: Sequence[str] = ()
    friction_data: str | None = None
    plastic_strain: bool = False
    backstresses: Sequence[str] = ()
    young: float | None = None  # MPa; None: that of the moduli, or 2.1e5
    poisson: float = 0.3
    starts: int = 4
    seed: int = 1

    def fits(self) -> bool:
        """Whether the hardening law is identified."""
        return bool(self.hardening) and "=" not in str(self.hardening) and ":" not in str(self.hardening)

    def has_curves(self) -> bool:
        """Whether there are curves at several rates or temperatures."""
        return bool(self.rate_curves or self.temperature_curves)

    def fixed(self, key: str) -> Mapping[str, float]:
        """Return the parameters of a law that are given, by the key of the law in the input or the name of a law of
        friction."""
        return self.given_of.get(key, {})


def fixed_value(text: str) -> tuple[str, float]:
    """Return name and value of an argument of --fix."""
    name, _, value = text.partition("=")
    try:
        return name, float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text}: expected name=value") from None


def split_fixed(values: Sequence[tuple[str, float]]) -> dict[str, Any]:
    """Return the parameters of --fix of the criterion, and those of other laws by the key before the point."""
    given: dict[str, float] = {}
    given_of: dict[str, dict[str, float]] = {}
    for name, value in values:
        key, point, parameter = name.rpartition(".")
        if point:
            given_of.setdefault(key, {})[parameter] = value
        else:
            given[name] = value
    return {"given": given, "given_of": given_of}


def add_curve(parser: argparse.ArgumentParser) -> None:
    """Add the options of tension curves and of laws beside the hardening, of the fit and of the result."""
    add = parser.add_argument
    add("--backstress", nargs="+", choices=BACKSTRESSES, default=[], metavar="LAW",
        help=f"back-stresses to identify with it ({', '.join(BACKSTRESSES)}), from a curve with a reversal")
    add("--plastic-strain", action="store_true", help="the strains of the curves are plastic strains")
    add("--fix", type=fixed_value, action="extend", nargs="+", default=[], metavar="NAME=VALUE",
        help="parameters that are given: of the criterion, such as its exponent (default: m=8, k=4; cpb06 C11=1 m=2); "
        "of other laws rate.reference=0.01, temperature.Tm=1500, hardening.r=0, stribeck.n=1")
    add("--modulus", choices=modulus.PARAMETERS, help="law of the modulus to identify from --moduli")
    add("--moduli", metavar="FILE", help="plastic strain and modulus of unloading; without --young also its start")
    for of, example in ((RATE, "RATE"), (TEMPERATURE, "TEMPERATURE")):
        add(f"--{of}", choices=factors.PARAMETERS[of], help=f"law of the {of} to identify from one of the following")
        add(f"--{of}-ratios", metavar="FILE", help=f"{of} and flow stress over that of the reference {of}")
        add(f"--{of}-reference", type=float, metavar=example, help=f"reference {of} of the ratios (the lowest one"
            + ("; 0: they are over the hardening law)" if of == RATE else ")"))
        add(f"--{of}-curves", nargs="+", default=[], metavar=f"{example}:FILE",
            help=f"tension curves at several {of}s, from which the hardening is identified too, if its name is given")
    add("--young", type=float, help="Young's modulus, MPa (that of --moduli, or 2.1e5)")
    add("--poisson", type=float, default=0.3, help="Poisson's ratio (0.3)")
    add("--starts", type=int, default=4, help="number of starts: the first from isotropy, the others at random (4)")
    add("--seed", type=int, default=1, help="seed of the random starts (1)")
    add_program(parser)
    add("--output", metavar="FILE", help="file to write (default: NAME.dat)")
    add("--plot", metavar="FILE", help="picture to draw: measured values and identified curves; of laws beside the "
        "hardening alone, these, otherwise these in a second picture, FILE with _laws")


def check_options(parser: argparse.ArgumentParser, task: Task) -> None:
    """Check the options that `fit` has too."""
    if not re.fullmatch(r"[A-Za-z][\w.-]*", task.name):
        parser.error(f"{task.name}: a name begins with a letter and has letters, digits, _ . - only")
    if (task.young is not None and task.young <= 0) or task.starts < 1:
        parser.error("--young and --starts are positive")
    if bool(task.modulus) != bool(task.moduli):
        parser.error("--modulus and --moduli go together")
    for of in (RATE, TEMPERATURE):
        check_factor(parser, task, of)
    if task.has_curves() and not task.hardening:
        parser.error("curves at several rates or temperatures need --hardening: a law to identify, or with its values")
    if task.has_curves() and task.curve:
        parser.error("--curve is one of the curves of --rate-curves or --temperature-curves")
    if task.has_curves() and task.backstresses:
        parser.error("curves at several rates or temperatures determine no --backstress: identify it before, from one "
                     "curve")
    check_fixed(parser, task)


def check_factor(parser: argparse.ArgumentParser, task: Task, of: str) -> None:
    """Check the options of the law of the rate or of the temperature."""
    law, ratios, curves, reference = (getattr(task, of + end) for end in ("", "_ratios", "_curves", "_reference"))
    if bool(law) != bool(ratios or curves) or (ratios and curves):
        parser.error(f"--{of} goes with one of --{of}-ratios and --{of}-curves")
    if law == "curves" and not (curves and task.fits()):
        parser.error("--rate curves goes with --rate-curves, and with the name of a law in --hardening for the slowest")
    if law == "curves" and task.temperature_curves:
        parser.error("--rate curves and --temperature-curves: in two commands, the second with the values of the first")
    if curves and len(curves) < 2:
        parser.error(f"--{of}-curves: two curves or more")
    if reference is not None and not ratios:
        parser.error(f"--{of}-reference goes with --{of}-ratios")
    if of == RATE and reference is not None and reference < 0:
        parser.error("--rate-reference is 0 or above")


def check_fixed(parser: argparse.ArgumentParser, task: Task) -> None:
    """Check the names of the parameters that are given."""
    known: dict[str, Sequence[str]] = {
        **({"modulus": modulus.PARAMETERS[task.modulus]} if task.modulus else {}),
        **{of: factors.PARAMETERS[of][law] for of, law in ((RATE, task.rate), (TEMPERATURE, task.temperature)) if law},
        **{law: friction.LAWS[law][2] for law in task.friction}}
    for key, values in task.given_of.items():
        if key == "hardening" and task.fits():
            continue
        for name, value in values.items():
            if name not in known.get(key, ()):
                names = ", ".join(known[key]) if key in known else ""
                has = f"{key} has {names or 'no parameters'}" if key in known else "no such law is identified"
                parser.error(f"--fix {key}.{name}={value:g}: {has}")
            if value <= 0 and key != TEMPERATURE:
                parser.error(f"--fix {key}.{name}={value:g}: expected a value above 0")


def check_task(parser: argparse.ArgumentParser, task: Task) -> None:
    """Check that the options of `identify` go together."""
    fits = task.fits()
    if fits and task.hardening not in LAWS:
        parser.error(f"--hardening: one of {', '.join(LAWS)}, or a law with all its values")
    if fits != bool(task.curve) and not (fits and task.has_curves()):
        parser.error("--curve and the name of a law in --hardening go together")
    if task.backstresses and not fits:
        parser.error("--backstress goes with --curve")
    laws = (task.criterion, task.fracture, task.modulus, task.rate, task.temperature)
    if not any(laws) and not fits and not task.friction:
        parser.error("nothing to identify: --criterion, --hardening with --curve, --fracture, --modulus, --rate, "
                     "--temperature, or --friction")
    if bool(task.friction) != bool(task.friction_data):
        parser.error("--friction and --friction-data go together")
    if task.friction and (any(laws) or task.hardening):
        parser.error("--friction belongs to a tool: identify it in a command of its own")
    if len(set(task.friction)) < len(task.friction):
        parser.error("--friction: each law once")
    check_exponent(parser, task)
    check_options(parser, task)


def check_exponent(parser: argparse.ArgumentParser, task: Task) -> None:
    """Check the exponent of the law of fracture, and set its default."""
    of_table = task.fracture_law == "table"
    if task.fracture_exponent is None:
        task.fracture_exponent = 1.0 if of_table else 0.1
    if of_table and not 1 <= task.fracture_exponent <= 10:
        parser.error("--fracture-exponent of a table is 1 to 10")
    if not of_table and not 0 < task.fracture_exponent <= 1:
        parser.error("--fracture-exponent is above 0 and at most 1")
    if of_table and not task.fracture:
        parser.error("--fracture-law goes with --fracture")
