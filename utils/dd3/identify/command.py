# SPDX-License-Identifier: GPL-3.0-or-later
"""Find the parameters of a yield criterion, of a hardening law, and of a law of fracture, from measured values.

Weighted least squares from several starts. Every trial set is evaluated by dd3imp itself, at single points (*POINT), so
that the laws are implemented once. Sets that the program refuses, because they are out of bounds or their surface is
not convex, have an infinite cost. The result is a file with one *MATERIAL block.

  Hill's parameters from three r-values, with a known hardening:
    dd3 identify steel --criterion hill48 --r 0:1.79 45:1.51 90:2.27 --hardening "swift K=565.32 e0=0.007117 n=0.2589"
  Yld'91 with exponent 6, also from yield stresses (over the one along rolling), the equibiaxial one with double weight:
    dd3 identify steel --criterion yld91 --fix m=6 --r 0:1.79 45:1.51 90:2.27 --stress 45:1.08 90:1.03 \\
        --biaxial-stress 1.18:2
  Also a Voce law from a tension curve; with a back-stress, from a curve that continues in compression:
    dd3 identify steel --criterion hill48 --r 0:1.79 45:1.51 90:2.27 --hardening voce --curve tension.csv
    dd3 identify steel --hardening voce --backstress lemaitre_chaboche --curve reversal.csv
  The law of fracture of Hosford and Coulomb from three tests or more:
    dd3 identify steel --fracture tests.csv --hardening "swift K=565.32 e0=0.007117 n=0.2589"

The table of --fracture has the triaxiality, the normalised Lode angle (1 in tension, 0 in plane strain, -1 in
equibiaxial tension) and the plastic strain to fracture of each test, in columns like those of a curve. The curve is a
table: logarithmic strain and true stress (MPa) in two columns, or in those that its heading names, separated by commas,
semicolons, tabs or blanks, with quotes or without, with a decimal point, or a comma where commas do not separate. The
heading may give units (%, GPa). Other columns, and rows above the numbers, are listed as left out.
Each line of the file of --data gives one of the values of the options --r, --stress and so on, such as `r 45 1.51` or
`biaxial_stress 1.18 2`; # begins a comment.
"""

import argparse
import re
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from dd3.columns import every
from dd3.command import new_parser
from dd3.errors import LOG, Problem
from dd3.identify import fracture
from dd3.identify.criterion import CRITERIA, criterion
from dd3.identify.hardening import BACKSTRESSES, LAWS, Curve, hardening, measured_curve, reverses
from dd3.identify.least_squares import UNIT, NoStart, Points
from dd3.identify.measurements import KEYS, TENSION, Datum, from_argument, read_data
from dd3.plot.figures import save
from dd3.programs import add_program


@dataclass
class Task:
    """What is identified, and from what: the criterion, if it is given, from the data, the hardening from the curve,
    the law of fracture from its tests."""

    name: str
    program: str
    hardening: str | None = None  # name of a law to identify, or a law with its values
    criterion: str | None = None
    given: Mapping[str, float] = field(default_factory=dict)  # parameters of the criterion
    yields: str = "von_mises"  # criterion of the curve where none is identified
    data: list[Datum] = field(default_factory=list)
    curve: str | None = None  # path of the table
    fracture: str | None = None  # likewise
    fracture_exponent: float = 0.1  # n of Hosford and Coulomb
    plastic_strain: bool = False
    backstresses: Sequence[str] = ()
    young: float = 2.1e5  # MPa
    poisson: float = 0.3
    starts: int = 4
    seed: int = 1


def folded(key: str, text: str) -> list[str]:
    """Return a line of the block, continued if it is long."""
    lines, line = [], f"  {key} ="
    for word in text.split():
        if len(line) + len(word) > 92:
            lines.append(line + " &")
            line = "   "
        line += " " + word
    return [*lines, line]


def block(name: str, elastic: str, yields: str, hardens: Sequence[str], table: Sequence[str], notes: Sequence[str]
          ) -> str:
    """Return the file: measured and identified values as comments, then the *MATERIAL."""
    lines = ["# Identified by dd3",
             f"# {'':<32}{'measured':>10}{'identified':>12}{'difference':>12}{'weight':>8}"]
    lines += [f"# {line}" for line in table]
    lines += [f"# Note: {note}" for note in notes]
    lines += [f"*MATERIAL {name}", elastic]
    lines += folded("yield", yields)
    for line in hardens:
        lines += folded(*line.split(" = "))
    return "\n".join(lines) + "\n"


def fixed_value(text: str) -> tuple[str, float]:
    """Return name and value of an argument of --fix."""
    name, _, value = text.partition("=")
    try:
        return name, float(value)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text}: expected name=value") from None


def add_curve(parser: argparse.ArgumentParser) -> None:
    """Add the options of a tension curve, of its fit and of the result."""
    add = parser.add_argument
    add("--backstress", nargs="+", choices=BACKSTRESSES, default=[], metavar="LAW",
        help=f"back-stresses to identify with it ({', '.join(BACKSTRESSES)}), from a curve with a reversal")
    add("--plastic-strain", action="store_true", help="the strains of the curve are plastic strains")
    add("--young", type=float, default=2.1e5, help="Young's modulus, MPa (2.1e5)")
    add("--poisson", type=float, default=0.3, help="Poisson's ratio (0.3)")
    add("--starts", type=int, default=4, help="number of starts: the first from isotropy, the others at random (4)")
    add("--seed", type=int, default=1, help="seed of the random starts (1)")
    add_program(parser)
    add("--output", metavar="FILE", help="file to write (default: NAME.dat)")
    add("--plot", metavar="FILE", help="picture to draw: measured values and identified curves, or of --fracture alone "
        "the strains")


def command_line() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = new_parser("identify", __doc__)
    add = parser.add_argument
    add("name", help="name of the material")
    add("--criterion", choices=CRITERIA, help="yield criterion to identify (without it: von_mises)")
    add("--fix", type=fixed_value, action="extend", nargs="+", default=[], metavar="NAME=VALUE",
        help="parameters of the criterion that are given, such as its exponent (default: m=8, k=4; cpb06 C11=1 m=2)")
    add("--data", metavar="FILE", help="measured values, one in a line: " + ", ".join(KEYS))
    add("--r", nargs="+", default=[], metavar="ANGLE:R[:WEIGHT]", help="r-values in tension (weight 0.5)")
    add("--stress", nargs="+", default=[], metavar="ANGLE:S[:WEIGHT]",
        help="yield stresses in tension over the one along rolling (weight 1); 0:1 is added")
    add("--compression", nargs="+", default=[], metavar="ANGLE:S[:WEIGHT]", help="the same in compression")
    add("--plane-strain", nargs="+", default=[], metavar="ANGLE:S[:WEIGHT]", help="the same in plane strain tension")
    add("--biaxial-stress", nargs="+", default=[], metavar="S[:WEIGHT]", help="the same in equibiaxial tension")
    add("--biaxial-compression", nargs="+", default=[], metavar="S[:WEIGHT]",
        help="the same in equibiaxial compression, or tension through the thickness")
    add("--biaxial-r", nargs="+", default=[], metavar="R[:WEIGHT]",
        help="its strain ratio, transverse over along rolling (0.5)")
    add("--hardening", metavar="LAW",
        help=f"law to identify from --curve ({', '.join(LAWS)}), or a law with all its values")
    add("--curve", metavar="FILE",
        help="tension curve along rolling; with --backstress or yoshida_uemori it goes on in compression")
    add("--fracture", metavar="FILE", help="triaxiality, Lode angle and strain to fracture of tests")
    add("--fracture-exponent", type=float, default=0.1, metavar="N", help="exponent n of Hosford and Coulomb (0.1)")
    add_curve(parser)
    return parser


def check_options(parser: argparse.ArgumentParser, name: str, young: float, starts: int) -> None:
    """Check the options that `fit` has too."""
    if not re.fullmatch(r"[A-Za-z][\w.-]*", name):
        parser.error(f"{name}: a name begins with a letter and has letters, digits, _ . - only")
    if young <= 0 or starts < 1:
        parser.error("--young and --starts are positive")


def arguments(words: Sequence[str] | None) -> tuple[Task, str | None, str | None]:
    """Return what the command line asks for, and the paths of --output and --plot."""
    parser = command_line()
    options = vars(parser.parse_args(words))
    texts = {key: options.pop(key) for key in KEYS}
    output, plot, file = (options.pop(key) for key in ("output", "plot", "data"))
    task = Task(given=dict(options.pop("fix")), backstresses=options.pop("backstress"), **options)
    check_task(parser, task)
    if task.criterion:
        task.data = measured(file, texts)
    return task, output, plot


def check_task(parser: argparse.ArgumentParser, task: Task) -> None:
    """Check that the options go together."""
    fits = bool(task.hardening) and "=" not in str(task.hardening) and ":" not in str(task.hardening)
    if fits and task.hardening not in LAWS:
        parser.error(f"--hardening: one of {', '.join(LAWS)}, or a law with all its values")
    if fits != bool(task.curve):
        parser.error("--curve and the name of a law in --hardening go together")
    if task.backstresses and not fits:
        parser.error("--backstress goes with --curve")
    if not task.criterion and not fits and not task.fracture:
        parser.error("nothing to identify: --criterion, --hardening with --curve, or --fracture")
    if not 0 < task.fracture_exponent <= 1:
        parser.error("--fracture-exponent is above 0 and at most 1")
    check_options(parser, task.name, task.young, task.starts)


def measured(path: str | None, texts: Mapping[str, Sequence[str]]) -> list[Datum]:
    """Return the measured values of a criterion: those of a file, and of the texts of each option."""
    parts = [partial(read_data, path)] if path else []
    parts += [partial(from_argument, key, text) for key in KEYS for text in texts[key]]
    data = [datum for part in every(parts) for datum in part]
    if not data:
        raise Problem("error: no measured values\n  expected: --data or --" + " --".join(KEYS).replace("_", "-"))
    if not any(d.weight for d in data):
        raise Problem("error: all weights are 0\n  expected: a positive weight")
    return data


def picture_of(text: str, program: str, data: Sequence[Datum], curve: Curve | None, found: np.ndarray | None
               ) -> Figure:
    """Return the picture of `dd3 plot point` of the material without its back-stresses, with the measured values.

    found: the identified stresses of a curve that turns, drawn in place of tension.
    """
    from dd3.plot.point import picture
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "material.dat"
        path.write_text(re.sub(r"  backstress = .*\n", "", text), encoding="utf-8")
        figure: Figure = picture([path], program, 0.2 if curve is None else max(curve.strain.max(), 0.02))
    if legend := figure.axes[-1].get_legend():
        legend.remove()  # each panel has its own
    axes = figure.axes
    if found is not None:
        for line in list(axes[0].lines):
            line.remove()
        axes[0].set_title("Curve")
    style: dict[str, Any] = {"linestyle": "none", "marker": "s", "color": "k", "markerfacecolor": "none",
                             "label": "measured"}
    if curve is not None:
        axes[0].plot(curve.strain, curve.stress, **{**style, "marker": ".", "zorder": 1})
        if found is not None:
            axes[0].plot(curve.strain, found, color="C1", label="identified")
    for part, quantity in ((axes[1], "r"), (axes[2], "stress")):
        chosen = [d for d in data if d.kind == "tension" and d.quantity == quantity]
        if chosen:
            part.plot([d.angle for d in chosen], [d.value for d in chosen], **style)
    places = [place for place in map(on_surface, data) if place]
    if places:
        axes[3].plot(*zip(*places, strict=True), **style)
    for part in axes:
        part.legend(fontsize="small")
    return figure


def on_surface(d: Datum) -> tuple[float, float] | None:
    """Return the point of a measured stress in the plane of rolling and transverse stresses; None if it has none."""
    if d.quantity != "stress" or d.angle not in (0, 90) or d.kind == "plane strain":
        return None
    value = d.value if d.kind in ("tension", "equibiaxial") else -d.value
    if d.kind.startswith("equibiaxial"):
        return value, value
    return (value, 0) if d.angle == 0 else (0, value)


def identify(task: Task, output: str | None = None, plot: str | None = None) -> None:
    """Identify the parameters of a criterion, without one of the hardening beside a given criterion, and of the law of
    fracture; write the file."""
    points = Points(task.program, task.young, task.poisson)
    yields, hardens = task.yields, [f"hardening = {task.hardening or UNIT}"]
    table: list[str] = []
    notes: list[str] = []
    curve, values, tests = None, None, None
    try:
        if task.criterion:
            yields, table, notes = criterion(task.criterion, task.given, points, task.data, task.starts, task.seed)
        if task.curve:
            law = str(task.hardening)
            curve = measured_curve(task.curve, task.young, reverses(law, task.backstresses), task.plastic_strain)
            hardens, more, other, values = hardening(law, task.backstresses, curve, points, yields, task.starts,
                                                     task.seed)
            table, notes = table + more, notes + other
        if task.fracture:
            tests = fracture.read_tests(task.fracture)
            broken, more, other = fracture.fracture(tests, task.fracture_exponent, points, task.starts, task.seed)
            hardens, table, notes = [*hardens, f"fracture = {broken}"], table + more, notes + other
    except NoStart:
        raise Problem("error: the program refused the parameters of every start; it said: "
                      f"{points.refusal or 'the points did not converge'}\n"
                      "  expected: more --starts, or other values of --fix") from None
    if not task.hardening:
        notes = [*notes, "no hardening was given: the flow stress of 100 is only a unit"]
    text = block(task.name, points.elastic, yields, hardens, table, notes)
    code, said, _ = points.run(text + f"*POINT p\n  material = {task.name}\n  control = {TENSION}\n"
                               "  target = 1e-6 0 0 0 0 0 steps=1\n")
    if code != 0:
        raise Problem(said.strip())
    figure = None
    if plot and tests and not task.criterion and not task.curve:
        figure = fracture.picture(broken, tests, points)
    points.bar.close()
    path = Path(output or f"{task.name}.dat")
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise Problem(f"{path}: error: {error.strerror}") from None
    LOG.info(f"{text}\n{points.runs} runs of the program; written to {path}")
    if plot:
        found = values if reverses(task.hardening or "", task.backstresses) else None
        save(figure or picture_of(text, task.program, task.data, curve, found), plot, 100)


def main(words: Sequence[str] | None = None) -> None:
    """Identify the material of the command line."""
    identify(*arguments(words))
