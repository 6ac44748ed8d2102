# SPDX-License-Identifier: GPL-3.0-or-later
"""Find the parameters of a yield criterion, and of a hardening law, from measured values.

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

The curve is a table: logarithmic strain and true stress (MPa) in two columns, or in those that its heading names,
separated by commas, semicolons, tabs or blanks, with quotes or without, with a decimal point, or a comma where commas
do not separate. The heading may give units (%, GPa). Other columns, and rows above the numbers, are listed as left out.
Each line of the file of --data gives one of the values of the options --r, --stress and so on, such as `r 45 1.51` or
`biaxial_stress 1.18 2`; # begins a comment.
"""

import argparse
import re
import tempfile
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from dd3.columns import every
from dd3.command import new_parser
from dd3.errors import LOG, Problem
from dd3.identify.criterion import CRITERIA, criterion
from dd3.identify.hardening import BACKSTRESSES, LAWS, REVERSING, hardening
from dd3.identify.least_squares import UNIT, NoStart, Points
from dd3.identify.measurements import KEYS, TENSION, Datum, from_argument, read_data
from dd3.plot.figures import save
from dd3.programs import add_program


def folded(key: str, text: str) -> list[str]:
    """Return a line of the block, continued if it is long."""
    lines, line = [], f"  {key} ="
    for word in text.split():
        if len(line) + len(word) > 92:
            lines.append(line + " &")
            line = "   "
        line += " " + word
    return [*lines, line]


def block(options: argparse.Namespace, yields: str, hardens: Sequence[str], table: Sequence[str], notes: Sequence[str]
          ) -> str:
    """Return the file: measured and identified values as comments, then the *MATERIAL."""
    lines = ["# Identified by dd3",
             f"# {'':<32}{'measured':>10}{'identified':>12}{'difference':>12}{'weight':>8}"]
    lines += [f"# {line}" for line in table]
    if not options.hardening:
        notes = [*notes, "no hardening was given: the flow stress of 100 is only a unit"]
    lines += [f"# Note: {note}" for note in notes]
    lines += [f"*MATERIAL {options.name}", f"  young = {options.young:g}", f"  poisson = {options.poisson:g}"]
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
    add("--plot", metavar="FILE", help="picture to draw: measured values and identified curves")


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
    add_curve(parser)
    return parser


def check_options(parser: argparse.ArgumentParser, options: argparse.Namespace) -> None:
    """Check the options that `fit` has too."""
    if not re.fullmatch(r"[A-Za-z][\w.-]*", options.name):
        parser.error(f"{options.name}: a name begins with a letter and has letters, digits, _ . - only")
    if options.young <= 0 or options.starts < 1:
        parser.error("--young and --starts are positive")


def arguments(words: Sequence[str] | None) -> argparse.Namespace:
    """Return the options."""
    parser = command_line()
    options = parser.parse_args(words)
    options.fix = dict(options.fix)
    fits = bool(options.hardening) and "=" not in options.hardening and ":" not in options.hardening
    if fits and options.hardening not in LAWS:
        parser.error(f"--hardening: one of {', '.join(LAWS)}, or a law with all its values")
    if fits != bool(options.curve):
        parser.error("--curve and the name of a law in --hardening go together")
    if options.backstress and not fits:
        parser.error("--backstress goes with --curve")
    if not options.criterion and not fits:
        parser.error("nothing to identify: --criterion, or --hardening with --curve")
    check_options(parser, options)
    return options


def measured(options: argparse.Namespace) -> list[Datum]:
    """Return the measured values of a criterion."""
    parts = [partial(read_data, options.data)] if options.data else []
    parts += [partial(from_argument, key, text) for key in KEYS for text in getattr(options, key)]
    data = [datum for part in every(parts) for datum in part]
    if not data:
        raise Problem("error: no measured values\n  expected: --data or --" + " --".join(KEYS).replace("_", "-"))
    if not any(d.weight for d in data):
        raise Problem("error: all weights are 0\n  expected: a positive weight")
    return data


def draw(options: argparse.Namespace, text: str, data: Sequence[Datum], curve: Any) -> None:
    """Draw the material without its back-stresses as `dd3 plot point` does, and the measured values."""
    from dd3.plot.point import picture
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "material.dat"
        path.write_text(re.sub(r"  backstress = .*\n", "", text), encoding="utf-8")
        figure = picture([path], options.program, 0.2 if curve is None else max(curve[0].max(), 0.02))
    if legend := figure.axes[-1].get_legend():
        legend.remove()  # each panel has its own
    axes = figure.axes
    reverses = bool(options.backstress) or options.hardening in REVERSING
    if reverses:
        for line in list(axes[0].lines):
            line.remove()
        axes[0].set_title("Curve")
    style: dict[str, Any] = {"linestyle": "none", "marker": "s", "color": "k", "markerfacecolor": "none",
                             "label": "measured"}
    if curve is not None:
        axes[0].plot(curve[0], curve[1], **{**style, "marker": ".", "zorder": 1})
        if reverses:
            axes[0].plot(curve[0], curve[2], color="C1", label="identified")
    for part, quantity in ((axes[1], "r"), (axes[2], "stress")):
        chosen = [d for d in data if d.kind == "tension" and d.quantity == quantity]
        if chosen:
            part.plot([d.angle for d in chosen], [d.value for d in chosen], **style)
    places = [place for place in map(on_surface, data) if place]
    if places:
        axes[3].plot(*zip(*places, strict=True), **style)
    for part in axes:
        part.legend(fontsize="small")
    save(figure, options.plot, 100)


def on_surface(d: Datum) -> tuple[float, float] | None:
    """Return the point of a measured stress in the plane of rolling and transverse stresses; None if it has none."""
    if d.quantity != "stress" or d.angle not in (0, 90) or d.kind == "plane strain":
        return None
    value = d.value if d.kind in ("tension", "equibiaxial") else -d.value
    if d.kind.startswith("equibiaxial"):
        return value, value
    return (value, 0) if d.angle == 0 else (0, value)


def identify(options: argparse.Namespace, yields: str = "von_mises") -> None:
    """Identify the parameters of a criterion, without one of the hardening beside a given criterion; write the file."""
    points = Points(options.program, options.young, options.poisson)
    table: list[str] = []
    notes: list[str] = []
    data, curve = list[Datum](), None
    hardens = [f"hardening = {options.hardening or UNIT}"]
    try:
        if options.criterion:
            data = measured(options)
            yields, table, notes = criterion(options, points, data)
        if options.curve:
            hardens, more, other, curve = hardening(options, points, yields)
            table, notes = table + more, notes + other
    except NoStart:
        raise Problem("error: the program refused the parameters of every start; it said: "
                      f"{points.refusal or 'the points did not converge'}\n"
                      "  expected: more --starts, or other values of --fix") from None
    text = block(options, yields, hardens, table, notes)
    code, said, _ = points.run(text + f"*POINT p\n  material = {options.name}\n  control = {TENSION}\n"
                               "  target = 1e-6 0 0 0 0 0 steps=1\n")
    points.bar.close()
    if code != 0:
        raise Problem(said.strip())
    path = Path(options.output or f"{options.name}.dat")
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise Problem(f"{path}: error: {error.strerror}") from None
    LOG.info(f"{text}\n{points.runs} runs of the program; written to {path}")
    if options.plot:
        draw(options, text, data, curve)


def main(words: Sequence[str] | None = None) -> None:
    """Identify the material of the command line."""
    identify(arguments(words))
