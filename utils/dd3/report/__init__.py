# SPDX-License-Identifier: GPL-3.0-or-later
"""Make a page about a forming run: one HTML file with its pictures inside, and the pictures as PNG files.

    dd3 report cup.out --mirror x y --low-carbon-steel
    dd3 report rail.out --mirror y --curve dc06.csv --section y=0 --section x=30 --output rail_report
    dd3 report cup.out --mirror x y --waves 0.2 --tolerance 0.5 --verdict
    dd3 report rail.out --fixture fixture.toml --verdict
    dd3 report cup.out --mirror x y --measured force.csv --measured thickness.csv

The page is one file, which a browser shows without a network: the part in 3D with all fields at all steps, its tools,
sections and forming limit diagram, and curves that tell their values under the mouse. It begins with the verdict:
whether the sheet is formed to the tools, its waves under the holder, splits, thinning, springback, and with --fixture
its deviations as `dd3 deviation` finds them; --verdict prints it and ends with exit code 1 if something is not good.
Then come the thinning, the deformed sheet between its tools, the forming limit diagram, thickness along sections, the
outline before and after, the springback of a sheet that was released (its distance from the drawn shape, sections,
angles, twist), deviations in the fixture, measured curves, the refinements and the final mesh where elements were
divided in the run, for each phase the tools' motions and forces, what limited its increments and what warned, the
statistics of the run, and the set-up. --mirror completes a model at its planes of symmetry; forces are multiplied
accordingly. Forming limit curve and thinning limit are those of `dd3 fld`; without a curve for the material it is not
judged. The strains are those at the middle of the sheet.
"""

import html
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from dd3 import forming_limit, verdict
from dd3.command import new_parser
from dd3.errors import LOG
from dd3.progress import each
from dd3.report.course import (
    add_beads,
    add_phases,
    add_setup,
    add_statistics,
    add_summary,
    add_verdict,
    add_warnings,
)
from dd3.report.deviation import add_deviation
from dd3.report.page import STYLE, Report
from dd3.report.sheet import (
    add_limit_diagram,
    add_measured,
    add_outline,
    add_pictures,
    add_refinements,
    add_sections,
    add_springback,
    add_view,
)
from dd3.sheet import AXES
from dd3.springback import unnamed
from dd3.viewer import page as interactive


def page(report: Report) -> str:
    """Return the text of the page."""
    title = html.escape(report.job["title"] or report.folder.resolve().name)
    images_of = f"; completed at the planes {', '.join(report.mirror)} = 0" if report.mirror else ""
    planes = unnamed(report.sheet, report.last, report.mirror)
    if planes:
        images_of += f"; forces are those of a part of the whole, which --mirror {' '.join(planes)} completes"
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title><style>{STYLE}{interactive.own_file("viewer.css")}</style></head><body><main>
<h1>{title}</h1><p>State: {report.run.state(report.last)}{images_of}.</p>
{chr(10).join(report.parts)}
</main>
{interactive.scripts()}
</body></html>
"""


STEPS = (add_view, add_pictures, add_limit_diagram, add_sections, add_outline, add_springback, add_deviation,
         add_measured, add_refinements, add_phases, add_beads, add_warnings, add_statistics, add_setup)


def make(run: str | Path, **settings: Any) -> Report:
    """Write the page about a run; return it, with its `path` and its `verdict`.

    settings: mirror, planes of symmetry to complete the model at, such as "xy"; section, planes such as "y=0" or an
    angle in degrees (through the middle); measured, tables of measured curves; fixture, file of the checking fixture;
    waves and tolerance, largest height of waves and largest distance from the drawn shape, mm; output, folder of page
    and pictures (report in that of the run); criteria, those of the forming limit.
    """
    report = Report(run, **settings)
    for step in each(STEPS, "report"):
        step(report)
    for step in (add_summary, add_verdict):
        step(report)
        report.parts.insert(0, report.parts.pop())
    report.path.write_text(page(report), encoding="utf-8")
    if report.undrawn:
        LOG.warning(f"{report.path}: without the pictures {', '.join(report.undrawn)}: "
                    f"{next(iter(report.undrawn.values()))}")
    return report


def main(words: Sequence[str] | None = None) -> None:
    """Write the page of the command line."""
    options = parsed(words)
    verdict_too = options.pop("verdict")
    report = make(**options)
    print(report.path)
    if verdict_too:
        print(*(f"{item.name}: {item.answer}: {item.text}" for item in report.verdict),
              f"verdict: {verdict.summary(report.verdict)}", sep="\n")
        if verdict.failed(report.verdict):
            sys.exit(1)


def parsed(words: Sequence[str] | None) -> dict[str, Any]:
    """Return the arguments of `make` on a command line, and whether the verdict is to be printed."""
    parser = new_parser("report", __doc__)
    parser.add_argument("run", metavar="RUN", help="folder of results")
    parser.add_argument("--mirror", nargs="+", default=[], choices=list(AXES), metavar="AXIS",
                        help="planes of symmetry x = 0, y = 0 or z = 0 to complete the model at")
    forming_limit.add_options(parser)
    parser.add_argument("--section", action="append", default=[], metavar="PLANE",
                        help="x=0, y=12.5 or an angle in degrees; may be repeated (default: through the middle)")
    parser.add_argument("--measured", action="append", default=[], metavar="FILE",
                        help="table of measured forces, draw-in, thickness or sections, with a heading that names its "
                             "columns and their units; may be repeated")
    parser.add_argument("--waves", type=float, metavar="MM", help="largest height of waves under a holder and in walls")
    parser.add_argument("--tolerance", type=float, metavar="MM",
                        help="largest distance of the free shape from the drawn one")
    parser.add_argument("--fixture", type=Path, metavar="FILE",
                        help="file of the checking fixture, .toml, with which the sheet is compared")
    parser.add_argument("--verdict", action="store_true",
                        help="print the verdict, and end with exit code 1 if something is not good")
    parser.add_argument("--output", type=Path, metavar="DIR", help="folder of page and pictures (default: RUN/report)")
    options = vars(parser.parse_args(words))
    return {"criteria": forming_limit.take_criteria(options), **options}
