# SPDX-License-Identifier: GPL-3.0-or-later
"""Fit a hardening law, with back-stresses, to a tension curve.

    dd3 fit steel voce tension.csv --plot steel.png
    dd3 fit steel swift tension.csv --yield "hill48 r0=1.79 r45=1.51 r90=2.27"
    dd3 fit steel voce reversal.csv --backstress lemaitre_chaboche

The curve is a table of logarithmic strain and true stress (MPa) along rolling, see `dd3 identify --help`, which also
identifies the yield criterion; here it is given. A back-stress requires a curve that continues in compression.
"""

from collections.abc import Sequence

from dd3.command import new_parser
from dd3.identify.command import identify
from dd3.identify.hardening import LAWS
from dd3.identify.measurements import check_law
from dd3.identify.task import Task, add_curve, check_options, split_fixed


def main(words: Sequence[str] | None = None) -> None:
    """Fit the law of the command line."""
    parser = new_parser("fit", __doc__)
    parser.add_argument("name", help="name of the material")
    parser.add_argument("hardening", metavar="LAW", choices=LAWS, help="law: " + ", ".join(LAWS))
    parser.add_argument("curve", metavar="FILE", nargs="?",
                        help="tension curve along rolling; without it --rate-curves or --temperature-curves")
    parser.add_argument("--yield", dest="yields", metavar="LAW", default="von_mises",
                        help="yield criterion with its parameters (von_mises)")
    add_curve(parser)
    options = vars(parser.parse_args(words))
    output, plot = options.pop("output"), options.pop("plot")
    task = Task(**split_fixed(options.pop("fix")), backstresses=options.pop("backstress"), **options)
    if not task.curve and not task.has_curves():
        parser.error("the following arguments are required: FILE")
    if task.given:
        parser.error(f"--fix {next(iter(task.given))}: fit has no criterion to identify; hardening.NAME=VALUE")
    check_options(parser, task)
    check_law("--yield", task.yields)
    identify(task, output, plot)
