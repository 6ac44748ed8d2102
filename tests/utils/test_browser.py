# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of a made-up run in a browser: 3D view, hover, section, tools, forming limit diagram. Without a browser, or
without playwright, it is skipped, which ctest tells; `utils/install_needed.sh --browser` installs both.
"""

import shutil

import numpy as np
import pytest
from helpers import call
from viewer_run import viewed_run

from dd3.plot.scale import step_of
from dd3.sheet import Sheet

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
SOFTWARE = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--no-sandbox"]
MINUTES = 4  # for a machine that does other work


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """Open the page of the run; yield it with its run, its folder and what the browser complains of."""
    if BROWSER is None:
        pytest.skip("no browser is found: chromium")
    playwright = pytest.importorskip("playwright.sync_api", reason="no browser can be led: the package playwright")
    folder = tmp_path_factory.mktemp("page")
    run = viewed_run(folder / "strip.out")
    call("report", run, "--mirror", "x", "y", "--output", folder / "report")
    complaints = []
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=BROWSER, args=SOFTWARE, timeout=60000 * MINUTES)
        opened = browser.new_page(viewport={"width": 1150, "height": 900})
        opened.set_default_timeout(60000 * MINUTES)
        opened.on("console", lambda said: complaints.append(said.text) if said.type == "error" else None)
        opened.on("pageerror", lambda error: complaints.append(str(error)))
        opened.goto((folder / "report" / "report.html").as_uri(), wait_until="commit")
        opened.wait_for_function("window.viewer")
        opened.folder, opened.sheet = folder, Sheet(run)
        yield opened
        browser.close()
    assert not complaints


def shown(page, script):
    """Call a script of the viewer and wait until the picture shows it; return the picture."""
    page.evaluate(f"async () => {{ const v = window.viewer; {script}; await v.show(); }}")
    return page.locator("#view").screenshot(path=page.folder / "view.png")


def test_names(page):
    """Check that a screen reader has a name for each control and each picture."""
    named = """e => e.labels?.length || e.ariaLabel || e.alt || (e.tagName == "BUTTON" && e.textContent.trim())"""
    nameless = page.evaluate(f"""() => [...document.querySelectorAll("select, input, button, canvas, img")]
        .filter(e => !({named})(e)).map(e => e.outerHTML.slice(0, 80))""")
    assert not nameless


def test_step_and_tool(page):
    """Check that slider, field, tool and mesh lines change the picture, and come back."""
    assert not page.locator("#tool_punch").is_checked()  # it would cover the part
    page.locator("#tool_punch").check()
    first = shown(page, 'v.select("thinning"); v.state.step = 1')
    page.locator("#step").evaluate("slider => { slider.value = 0; return slider.oninput(); }")
    assert page.locator("#step_name").text_content().startswith("draw, travel")
    with_tool = shown(page, "")
    page.locator("#tool_punch").uncheck()
    without = shown(page, "")
    assert len({first, with_tool, without}) == 3
    page.locator("#lines").check()
    assert shown(page, "") != without
    page.locator("#lines").uncheck()
    assert shown(page, "") == without
    page.locator("#tool_punch").check()
    page.locator("#pressure").check()  # of the faces of the sheet that touch a tool, which selects that field
    pressed = shown(page, "")
    page.locator("#pressure").uncheck()
    assert shown(page, "") != pressed
    page.locator("#field").select_option(label="thinning")
    assert shown(page, "") == with_tool


@pytest.mark.parametrize("field, elements", [
    ("thinning", False), ("stress:22", False), ("stress:12", False), ("thinning", True)])
def test_hover(page, field, elements):
    """Check the value under the mouse, at a node and in its mirror image, against that of the run."""
    shown(page, f'v.state.step = 1; v.select("{field}", {str(elements).lower()}); v.look("iso")')
    values, points = page.sheet.component(1, field, elements)[0], page.sheet.points(1)
    for sign in (1, -1):
        target = np.array([sign * 20.1, 6.1, 1 - 6 * (20.1 / 40) ** 2])
        x, y = page.evaluate("point => window.viewer.project(point)", target.tolist())
        found = page.evaluate("([x, y]) => window.viewer.pick(x, y)", [x, y])
        node, element = found["node"], found["element"]
        assert np.abs(np.array(found["position"]) - points[node - 1] * [sign, 1, 1]).max() < 2e-3
        assert np.linalg.norm(found["position"] - target) < 1.5
        expected = values[element - 1] if elements else values[node - 1] * (sign if field == "stress:12" else 1)
        assert abs(found["value"] - expected) <= np.ptp(values) / 65535, (found, expected)
        page.mouse.move(x, y)
        page.wait_for_function(f"document.getElementById('told').textContent.includes('node {node} at')")
        told = page.locator("#told").text_content()
        assert f"element {element}" in told
        if field == "thinning":
            assert f"{float(f'{100 * expected:.4g}'):g} %" in told.replace("−", "-")[:60] or elements


def test_signs_of_images(page):
    """Check the colours of the images across x, across y and across both: those of the other sign, of a scale from -h to
    h, for a stress that is odd across each, the same as of the part for others; and the field along a section."""
    for field, signs in (("stress:12", (-1, -1, 1)), ("stress:22", (1, 1, 1))):
        shown(page, f'v.state.step = 1; v.select("{field}", false)')
        part, *images = (np.array(array)[::2] for array in page.evaluate(
            "window.viewer.sheets.map(({geometry}) => Array.from(geometry.getAttribute('uv').array))"))
        assert np.ptp(part) > 0.1 and len(images) == 3
        for image, sign in zip(images, signs):
            assert np.abs(image - (part if sign > 0 else 1 - part)).max() < 1e-6
    page.locator("#cut").check()
    page.locator("#normal").select_option("y")
    page.locator("#offset").evaluate("slider => { slider.value = 800; slider.oninput(); }")
    shown(page, 'v.select("stress:12", false)')
    along = page.evaluate("window.viewer.section.along.data.datasets.map(({data}) => data.map(({y, at}) => [at[0], y]))")
    x, value = np.array(along[0]).T
    assert np.abs(value).max() > 1 and x.min() < -39 and x.max() > 39
    assert ((value * x)[np.abs(x) > 1] > 0).all()  # the stress of the part is positive
    page.locator("#cut").uncheck()


def test_section(page):
    """Check the profile that a plane cuts: the section of the strip with its mirror image, and the field along it."""
    shown(page, 'v.state.step = 1; v.select("thinning")')
    page.locator("#cut").check()
    page.locator("#normal").select_option("y")
    page.locator("#offset").evaluate("slider => { slider.value = 800; slider.oninput(); }")
    cut = page.evaluate("window.viewer.section.own.flatMap(({ends}) => ends.map(({point}) => point))")
    cut = np.array(cut)
    assert np.abs(cut[:, 1] - 6).max() < 2e-3  # 0.8 of -10 to 10 mm
    assert abs(cut[:, 0].max() - 40) < 1e-2 and abs(cut[:, 0].min() + 40) < 1e-2
    height = cut[:, 2] + 6 * (cut[:, 0] / 40) ** 2  # of a chord at most 0.004 mm above the curve
    assert height.min() > -0.01 and height.max() < 1.01
    assert page.locator("#profile_box").is_visible() and page.locator("#along_box").is_visible()
    assert "y = 6.00 mm" in page.locator("#offset_value").text_content()
    page.locator("#offset").evaluate("slider => { slider.value = 500; slider.oninput(); }")  # the plane of symmetry
    along = page.evaluate("window.viewer.section.along.data.datasets.map(({data}) => data.map(({x}) => x))")
    assert len(along) == 1 and (np.diff(along[0]) >= 0).all() and abs(along[0][-1] - 81.18) < 0.1  # of the parabola
    page.locator("#cut").uncheck()
    assert not page.locator("#profile_box").is_visible()


def test_limit_link(page):
    """Check that a point of the diagram under the mouse is marked on the sheet, and a node under the mouse in it."""
    shown(page, 'v.state.step = 1; v.select("thinning"); v.look("iso")')
    points, major = page.sheet.points(1), page.sheet.values(1, "major_strain_middle")[0]
    page.locator("#limit_chart").scroll_into_view_if_needed()
    place = page.evaluate("""() => {
      const chart = library.Chart.getChart("limit_chart"), frame = chart.canvas.getBoundingClientRect();
      const wanted = (point) => point.elements === false && point.y > 0.29 && point.y < 0.31;
      const set = chart.data.datasets.findIndex(({ data }) => data.some(wanted));
      const at = chart.data.datasets[set].data.findIndex(wanted);
      const { x, y } = chart.getDatasetMeta(set).data[at];
      return [frame.left + x, frame.top + y];
    }""")
    page.mouse.move(*place)
    page.wait_for_function("window.viewer.marked()")
    marked = np.array(page.evaluate("window.viewer.marked()"))
    nearest = np.linalg.norm(points - marked, axis=1).argmin()
    assert np.linalg.norm(points[nearest] - marked) < 2e-3 and abs(major[nearest] - 0.3) < 0.01
    page.locator("#view").scroll_into_view_if_needed()
    x, y = page.evaluate("window.viewer.project([20.1, 6.1, -0.5])")
    node = page.evaluate("([x, y]) => window.viewer.pick(x, y).node", [x, y])
    page.mouse.move(x, y)
    page.wait_for_function(f"document.getElementById('told').textContent.includes('node {node} at')")
    found = page.evaluate('library.Chart.getChart("limit_chart").data.datasets[0].data')
    assert len(found) == 1 and abs(found[0]["y"] - major[node - 1]) < 1e-4


def test_all_fields(page):
    """Check that all fields are drawn without complaint, that scales are round, and that the page is printed."""
    names = page.evaluate("window.viewer.scene.fields.map((field) => field.label)")
    assert len(names) > 20
    for i in range(len(names)):
        page.evaluate(f"window.viewer.state.field = {i}, window.viewer.show()")
    shown(page, 'v.state.step = 2; v.select("distance_normal"); document.getElementById("drawn").checked = true')
    ticks = page.evaluate("window.viewer.state.shown.ticks")
    assert ticks[0] < 0 < ticks[-1] and any(abs(tick) < 1e-9 for tick in ticks)
    step = (ticks[1] - ticks[0]) / 10 ** np.floor(np.log10(ticks[1] - ticks[0]) + 1e-9)
    assert round(step, 6) in (1, 2, 5), ticks
    said = page.evaluate("[[12, 2], [-0.02, 0.02], [0.3, 0.1], [1500, 500]].map(([a, b]) => tickText(a, b))")
    assert said == ["12", "-0.02", "0.3", "1500"]
    ends = [[0, 1], [-3, 17], [0.1234, 0.1239], [-250, 400], [0, 8], [1e-5, 3e-5], [0, 7.99]]
    assert page.evaluate("(ends) => ends.map(([a, b]) => stepOf(a, b))", ends) == pytest.approx(
        [step_of(*pair) for pair in ends])  # own limits have the ticks of the pictures
    found = page.evaluate("""[0.2, 0.49, 0.5, 1].map((part) => colourOf(window.viewer.scene.maps, {},
        { low: 0, high: 2, step: 0.5, limit: 1 }, part))""")
    assert found[2:] == [[213, 94, 0]] * 2  # from the limit on; the end of the map just before
    assert sum(found[0]) < sum(found[1]) and abs(found[1][0] - 253) < 30, found
    middle = page.evaluate("""() => {  // the colour at zero in the legend, white in the middle of the map
      const { low, high } = window.viewer.state.shown, canvas = document.getElementById("legend");
      const y = Math.round(62 + (canvas.height - 72) * high / (high - low));
      return [...canvas.getContext("2d").getImageData(10, y, 1, 1).data];
    }""")
    assert min(middle[:3]) > 225, middle
    page.emulate_media(media="print")
    assert not page.locator(".controls").is_visible() and page.locator("#view canvas").first.is_visible()
    assert page.pdf()[:5] == b"%PDF-"
    page.emulate_media(media="screen")
    page.locator(".viewer").screenshot(path=page.folder / "viewer.png")
