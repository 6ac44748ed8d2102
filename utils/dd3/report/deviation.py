# SPDX-License-Identifier: GPL-3.0-or-later
"""Part of the page: the sheet in its checking fixture, green within its tolerances and red outside."""

from dd3 import deviation, deviation_pictures
from dd3.fixture import read_fixture
from dd3.report.page import Report


def add_deviation(report: Report) -> None:
    """Add the deviations of a run from the nominal shape of its fixture, and their verdict."""
    if report.fixture is None:
        return
    fixture = read_fixture(report.fixture)
    found = deviation.compare(report.folder, fixture)
    report.deviations = [item._replace(name=f"deviation of {item.name}") for item in found.items]
    alt = "deviation from the nominal shape"
    content = report.drawn(lambda: deviation_pictures.draw_map(found, fixture, report.picture("deviation")),
                           "deviation", alt)
    if len(found.sections):
        deviation_pictures.draw_sections(found, fixture, report.picture("deviation_sections"))
        content += report.image("deviation_sections", f"{alt} along sections")
    for table in (found.points, found.supports):
        if len(table):
            content += table.to_html(index=False, border=0, float_format=lambda value: f"{value:.4g}")
    report.add(f"Deviation: {fixture.title}", content)
