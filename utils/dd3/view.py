# SPDX-License-Identifier: GPL-3.0-or-later
"""Open the page of a run in the browser; it is made if it is missing or older than the results.

    dd3 view cup.out --mirror x y --low-carbon-steel
    dd3 view cup.out --window --field thinning

All options but --window, --field, --at and --no-browser are those of `dd3 report`; with any of them the page is made
again. --window shows the sheet between its tools in a window of its own, which needs a display.
"""

import argparse
import os
import webbrowser
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from dd3 import report
from dd3.command import new_parser
from dd3.errors import Problem
from dd3.fields import AT
from dd3.plot import sheet as pictures

RESULTS = ("fields.vtkhdf", "history.csv", "status.csv", "run.json")
FIELD = "equivalent_plastic_strain"  # of the window


def page_of(run: Path, **settings: Any) -> Path:
    """Return the page of a run, made where it is missing or old, or with settings of `report.make`."""
    page = run / "report" / "report.html"
    if settings or is_old(page, run):
        page = report.make(run, **settings).path
    return page


def show_page(page: Path) -> None:
    """Open a page in the browser."""
    if not webbrowser.open(page.resolve().as_uri()):
        raise Problem(f"no browser is found; open this file in one: {page.resolve()}")


def is_old(page: Path, run: Path) -> bool:
    """Tell whether a page is missing or older than the results of its run."""
    times = [(run / name).stat().st_mtime for name in RESULTS if (run / name).is_file()]
    return not page.is_file() or page.stat().st_mtime < max(times, default=0.0)


def show_window(run: Path, field: str | None = None, at: str | None = None, mirror: Sequence[str] = ()) -> None:
    """Show a field of the sheet of a run in a window, from a step on, with a slider for its steps, until it is
    closed."""
    if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise Problem("--window: there is no display; without --window the page opens in a browser")
    import pyvista as pv
    one, chosen = pictures.Run(run), pictures.Style(field or FIELD, mirror=mirror)
    steps, tools = list(range(one.count)), pictures.find_tools(one)
    limits, box = pictures.limits_of(one, steps, chosen), pictures.box_of(one, steps, chosen.mirror, tools)
    pv.OFF_SCREEN = False
    plotter: Any = pv.Plotter(title=f"{run}: {chosen.field}")
    plotter.set_background("white")
    label = one.mesh(one.last, chosen.field, chosen.cells)[1]
    shown: list[str] = []

    def show(value: float) -> None:
        place, scale, others = plotter.camera_position, plotter.camera.parallel_scale, set(plotter.actors)
        pictures.draw(plotter, one, round(value), chosen, tools, limits, box)
        added = [name for name in plotter.actors if name not in others]
        for name in shown:
            plotter.remove_actor(name)
        shown[:] = added
        plotter.camera_position, plotter.camera.parallel_scale = place, scale  # where it was moved to

    pictures.add_bar(plotter, label, limits, chosen.colours, vertical=True, title_font_size=16)
    pictures.aim(plotter, box, chosen)
    plotter.add_slider_widget(show, [0, one.last], value=one.step_at(at) if at else one.last,
                              title="step", fmt="%.0f", pointa=(0.3, 0.08), pointb=(0.7, 0.08))
    plotter.show()


def main(words: Sequence[str] | None = None) -> None:
    """Show the run of the command line."""
    parser = new_parser("view", __doc__)
    parser.add_argument("run", metavar="RUN", type=Path, help="folder of results")
    parser.add_argument("--window", action="store_true", help="show the sheet in a window in place of the page")
    parser.add_argument("--field", help=f"field of the window, as of `dd3 plot sheet` ({FIELD})")
    parser.add_argument("--at", metavar="PLACE", help=f"step of the window: {AT}")
    parser.add_argument("--no-browser", action="store_true", help="make the page if need be and print its path only")
    options, others = parser.parse_known_args(words)
    if not options.run.is_dir():
        raise Problem(f"{options.run}: No such folder")
    if options.window:
        window = argparse.ArgumentParser("dd3 view --window")
        window.add_argument("--mirror", nargs="+", default=[])
        show_window(options.run, options.field, options.at, window.parse_args(others).mirror)
        return
    if options.field or options.at:
        parser.error("--field and --at go with --window; the page has all fields and steps")
    settings = report.parsed([str(options.run), *others]) if others else {}
    page = page_of(options.run, **{name: value for name, value in settings.items() if name not in ("run", "verdict")})
    print(page)
    if not options.no_browser:
        show_page(page)
