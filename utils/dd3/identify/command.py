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
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from dd3.columns import every
from dd3.command import new_parser
from dd3.errors import LOG, Problem
from dd3.identify import friction
from dd3.identify.criterion import CRITERIA, criterion
from dd3.identify.hardening import LAWS, Curve, reverses
from dd3.identify.least_squares import NoStart, Points
from dd3.identify.material_laws import Laws, Measured, find_laws, find_modulus, picture, read_measured
from dd3.identify.measurements import KEYS, TENSION, Datum, from_argument, read_data
from dd3.identify.task import FRACTURE, YOUNG, Task, add_curve, check_task, split_fixed
from dd3.plot.figures import save


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
    lines.append(f"*MATERIAL {name}")
    for line in elastic.split("\n"):
        lines += folded(*line.strip().split(" = ", 1))
    lines += folded("yield", yields)
    for line in hardens:
        lines += folded(*line.split(" = ", 1))
    return "\n".join(lines) + "\n"


def command_line() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = new_parser("identify", __doc__)
    add = parser.add_argument
    add("name", help="name of the material")
    add("--criterion", choices=CRITERIA, help="yield criterion to identify (without it: von_mises)")
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
    add("--fracture-law", choices=FRACTURE, default=FRACTURE[0], help="law of fracture (hosford_coulomb); table: "
        "straight lines through the tests, at each Lode angle if the table has any")
    add("--fracture-exponent", type=float, metavar="N",
        help="exponent n of Hosford and Coulomb (0.1), or of the growth of the damage of a table (1)")
    add("--friction", nargs="+", choices=friction.LAWS, default=[], metavar="LAW",
        help=f"laws of friction to identify ({', '.join(friction.LAWS)}), whose factors are multiplied")
    add("--friction-data", metavar="FILE",
        help="coefficients of friction by pressure (MPa), speed (mm/s) and plastic strain, as the laws need them")
    add_curve(parser)
    return parser


def arguments(words: Sequence[str] | None) -> tuple[Task, str | None, str | None]:
    """Return what the command line asks for, and the paths of --output and --plot."""
    parser = command_line()
    options = vars(parser.parse_args(words))
    texts = {key: options.pop(key) for key in KEYS}
    output, plot, file = (options.pop(key) for key in ("output", "plot", "data"))
    task = Task(**split_fixed(options.pop("fix")), backstresses=options.pop("backstress"), **options)
    check_task(parser, task)
    if task.criterion:
        task.data = measured(file, texts)
    return task, output, plot


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
    from dd3.plot.point import picture as picture_of_points
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "material.dat"
        # Tension is drawn without back-stresses, at rest and at the reference temperature.
        path.write_text(re.sub(r"  (?:backstress|rate|temperature) =(?:.*&\n)*.*\n", "", text), encoding="utf-8")
        figure: Figure = picture_of_points([path], program, 0.2 if curve is None else max(curve.strain.max(), 0.02))
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
    """Identify the parameters of a criterion, without one of the laws beside a given criterion, and write the file."""
    found = read_measured(task)
    points = Points(task.program, task.young or YOUNG, task.poisson)
    yields, table, notes = task.yields, list[str](), list[str]()
    try:
        elastic = find_modulus(task, found, points)
        if elastic:
            table, notes = elastic.table, elastic.notes
        if task.criterion:
            yields, more, other = criterion(task.criterion, task.given, points, task.data, task.starts, task.seed)
            table, notes = table + more, notes + other
        laws = find_laws(task, found, yields, points)
        laws.elastic = elastic
    except NoStart:
        raise Problem("error: the program refused the parameters of every start; it said: "
                      f"{points.refusal or 'the points did not converge'}\n"
                      "  expected: more --starts, or other values of --fix") from None
    table, notes = table + laws.table, notes + laws.notes
    if not task.hardening:
        notes = [*notes, "no hardening was given: the flow stress of 100 is only a unit"]
    text = block(task.name, points.elastic, yields, laws.lines, table, notes)
    timed = "  duration = 1\n" if laws.text_of("rate") else ""
    code, said, _ = points.run(text + f"*POINT p\n  material = {task.name}\n  control = {TENSION}\n"
                               f"  target = 1e-6 0 0 0 0 0 steps=1\n{timed}")
    if code != 0:
        raise Problem(said.strip())
    pictures = draw_all(task, found, laws, points, text) if plot else []
    points.bar.close()
    write(output or f"{task.name}.dat", text, f"{points.runs} runs of the program; ")
    for number, figure in enumerate(pictures):
        path = Path(str(plot))
        save(figure, path.with_stem(path.stem + "_laws") if number else path, 100)


def draw_all(task: Task, found: Measured, laws: Laws, points: Points, text: str) -> list[Figure]:
    """Return the picture of criterion and curve, if there is one of them, and that of the other laws."""
    figures = []
    curve = found.tests[0].curve if task.curve else None
    if task.criterion or curve:
        turns = curve and reverses(task.hardening or "-", task.backstresses)
        figures.append(picture_of(text, task.program, task.data, curve, laws.stresses[0] if turns else None))
    other = picture(task, found, laws, points)
    return [*figures, other] if other else figures


def write(path: str, text: str, said: str = "") -> None:
    """Write a result, and show it."""
    try:
        Path(path).write_text(text, encoding="utf-8")
    except OSError as error:
        raise Problem(f"{path}: error: {error.strerror}") from None
    LOG.info(f"{text}\n{said}written to {path}")


def identify_friction(task: Task, output: str | None = None, plot: str | None = None) -> None:
    """Identify laws of friction, and write their lines of *TOOL."""
    path = str(task.friction_data)
    tests = friction.read_tests(path, task.friction, task.given_of)
    lines, table, notes, values = friction.friction(task.friction, tests, task.given_of, path, task.starts, task.seed)
    head = [f"# Friction of {task.name}, identified by dd3: lines of *TOOL",
            f"# {'':<32}{'measured':>10}{'identified':>12}{'difference':>12}"]
    head += [f"# {line}" for line in table] + [f"# Note: {note}" for note in notes]
    for line in lines:
        head += folded(*line.split(" = ", 1))
    write(output or f"{task.name}.dat", "\n".join(head) + "\n")
    if plot:
        save(friction.picture(task.friction, tests, values), plot, 100)


def main(words: Sequence[str] | None = None) -> None:
    """Identify the material of the command line."""
    task, output, plot = arguments(words)
    (identify_friction if task.friction else identify)(task, output, plot)
