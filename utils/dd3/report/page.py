# SPDX-License-Identifier: GPL-3.0-or-later
"""A page about a run, to which its parts are added."""

import base64
import html
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from dd3 import rendering, verdict
from dd3.errors import Problem
from dd3.forming_limit import Criteria
from dd3.plot import sheet as pictures
from dd3.plot.figures import save
from dd3.programs import made_folder
from dd3.run import check_limits, planes_of, read_frame
from dd3.sheet import AXES, Sheet, plane
from dd3.springback import ROUND_OFF
from dd3.tables import tools_in
from dd3.viewer import page as interactive

STYLE = """body{font:16px/1.5 system-ui,sans-serif;color:#222;background:#f4f5f7;margin:0}
main{max-width:1100px;margin:0 auto;padding:1em 1.5em}h1{margin:.4em 0 0}h2{margin:0 0 .5em;font-size:1.2em}
section{background:#fff;border:1px solid #dde;border-radius:6px;padding:1em 1.2em;margin:1em 0}
img{max-width:100%;height:auto;display:block;margin:auto}table{border-collapse:collapse}
td,th{padding:.15em .9em .15em 0;text-align:left;vertical-align:top}td.n{text-align:right}td.answer{white-space:nowrap}
.row{display:flex;flex-wrap:wrap;gap:1em 3em}.bar{display:inline-block;height:.8em;background:#5b8fd6}
.key{display:inline-block;width:.8em;height:.8em;margin-right:.4em}.warn{color:#8a4b00}
pre{overflow-x:auto;font-size:13px}p,li{overflow-wrap:break-word}
"""


class Report:
    """A run, the settings of its page, those of `make`, and the parts of the page."""

    def __init__(self, run: str | Path, mirror: Sequence[str] = (), section: Sequence[str] = (),
                 measured: Sequence[str | Path] = (), waves: float | None = None, tolerance: float | None = None,
                 output: str | Path | None = None, criteria: Criteria | None = None,
                 fixture: Path | None = None) -> None:
        check_limits(waves, tolerance)
        self.mirror, self.sections, self.measured = planes_of(mirror), list(section), measured
        self.waves, self.tolerance, self.criteria = waves, tolerance, criteria or Criteria()
        self.fixture = fixture
        self.sheet = Sheet(run)
        self.folder = self.sheet.folder
        self.run = pictures.Run(self.folder)
        self.job = self.run.job
        self.history = read_frame(self.folder, "history.csv", "phase", "travel", "progress")
        self.tools = tools_in(self.history)
        self.last = self.sheet.last
        self.pictures = made_folder(output or self.folder / "report")
        self.path: Path = self.pictures / "report.html"
        self.whole = 2 ** len(self.mirror)  # number of images of the model
        self.parts: list[str] = []
        self.undrawn: dict[str, str] = {}  # why a picture is not in the page
        self.limits: list[str] = []  # results of the forming limit diagram: by the curve, by the thinning
        self.splits: list[verdict.Item] = []
        self.sprung: float | None = None  # largest distance of the free shape from the drawn one, mm
        self.deviations: list[verdict.Item] = []
        self.verdict: list[verdict.Item] = []

    def field(self, name: str) -> np.ndarray:
        """Return a field at the last step."""
        return self.sheet.values(self.last, name)[0]

    def column(self, name: str) -> np.ndarray:
        """Return a column of the history."""
        return self.history[name].to_numpy(float)

    def add(self, title: str, content: str) -> None:
        """Add a section to the page."""
        self.parts.append(f"<section><h2>{html.escape(title)}</h2>\n{content}\n</section>")

    def image(self, name: str, alt: str) -> str:
        """Return the element of a picture that has been written."""
        data = base64.b64encode(self.picture(name).read_bytes()).decode()
        return f'<img alt="{html.escape(alt)}" src="data:image/png;base64,{data}">'

    def drawn(self, draw: Callable[[], object], name: str, alt: str) -> str:
        """Draw a picture of the sheet and return its element, or a text where the system cannot draw it."""
        try:
            draw()
        except rendering.NoOpenGL as problem:
            self.undrawn[name] = str(problem)
            return f"<p>No picture: {html.escape(str(problem))}.</p>"
        return self.image(name, alt)

    def saved(self, name: str, figure: Figure, alt: str) -> str:
        """Write a figure and return its element."""
        save(figure, self.picture(name), 130)
        return self.image(name, alt)

    def figure(self, name: str, figure: Figure, alt: str) -> str:
        """Write a figure of curves and return its element, whose curves answer to the mouse."""
        return interactive.chart(name, figure, self.saved(name, figure, alt))

    def style(self, **members: Any) -> pictures.Style:
        """Return the style of a picture of the sheet."""
        return pictures.Style(size=(1300, 650), mirror=self.mirror, **members)

    def picture(self, name: str) -> Path:
        """Return the file of a picture."""
        return self.pictures / f"{name}.png"

    def sheet_drawn(self, name: str, alt: str, **members: Any) -> str:
        """Draw the sheet at the last step and return its element."""
        run = pictures.Run(self.folder, self.job)
        return self.drawn(lambda: pictures.make_picture(run, self.style(**members), self.picture(name)), name, alt)


def table(rows: Iterable[tuple[str, Any]]) -> str:
    """Return a table of names and values."""
    return "<table>" + "".join(f"<tr><th>{html.escape(name)}</th><td>{html.escape(str(value))}</td></tr>"
                               for name, value in rows) + "</table>"


def columns(*tables: str) -> str:
    """Return tables beside each other."""
    return '<div class="row">' + "".join(f"<div>{part}</div>" for part in tables) + "</div>"


def section_planes(report: Report) -> list[str]:
    """Return the planes of --section, by default those through the middle of the whole sheet that cut it, along the
    axis that it faces."""
    if report.sections:
        return report.sections
    points, facing = report.sheet.points(0), faced(report)
    planes = [f"{axis}={0.0 if axis in report.mirror else float(points[:, i].min() + points[:, i].max()) / 2:.6g}"
              for i, axis in reversed(list(enumerate(AXES))) if axis != facing]
    if facing == "z" and {"x", "y"} <= set(report.mirror):
        planes.append("45")
    return [text for text in planes if cuts(report.sheet, text)]


def upwards(planes: Sequence[str]) -> str:
    """Return the name of the upper coordinate in the planes of sections, those of `in_plane`."""
    across = [text for text in planes if text.strip().startswith("z")]
    return "z (mm)" if not across else "y (mm)" if len(across) == len(planes) else "z, in planes across z y (mm)"


def faced(report: Report) -> str:
    """Return the axis that the whole sheet faces at the start: z, unless its projection along another one is more than
    twice as large as both others."""
    points, faces = report.sheet.points(0), report.sheet.faces(True, 0)
    across = points[faces[:, 2:]] - points[faces[:, :2]]
    areas = np.cross(across[:, 0], across[:, 1])
    area = np.abs(areas.sum(axis=0))
    area[[axis in report.mirror for axis in "xy"] + [False]] = 0.0  # those of the images are opposite
    least = max(2 * np.sort(area)[1], ROUND_OFF * np.linalg.norm(areas, axis=1).sum())
    return AXES[area.argmax()] if area.max() > least else "z"


def cuts(sheet: Sheet, text: str) -> bool:
    """Whether a plane cuts the sheet."""
    try:
        sheet.cut(*plane(text), step=0)
    except Problem:
        return False
    return True
