#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Look at the reports of the input files in a browser: Chromium or Chrome, headless.

    utils/dev/report_pages.py --program build/release/dd3imp --work build/report_pages
    utils/dev/report_pages.py rail build/tray/second.out --program dd3imp --work build/report_pages --write

Runs each input file of input_files that has a blank (finished runs are kept), makes its report, and loads it in windows
of 1280 and 520 pixels: every picture must be shown, nothing be wider than the window, and no number be nan or inf.
Writes <input file>.png beside the runs; --write puts smaller copies of those on docs/reports/pages.md into
docs/images/reports, and the table of the runs into the page.
"""

import argparse
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

from PIL import Image

from dd3.errors import Problem, run
from dd3.pages import put_table, table
from dd3.progress import each
from dd3.run import read_job

ROOT = Path(__file__).resolve().parents[2]
DECKS = ROOT / "input_files"
PICTURES = ROOT / "docs" / "images" / "reports"
PAGE = ROOT / "docs" / "reports" / "pages.md"
SHOWN = ("solid_shell", "draw_bead", "hat")  # on the page
MADE_TOOLS = ("tutorial", "hood", "panel", "fender_line")  # folders of input files
BROWSERS = ("chromium", "chromium-browser", "google-chrome")
WIDTHS = (1280, 520)
TALLEST = 12000  # pixels of a screenshot
SMALL = (480, 4000)  # size of the copies, at most
MIRROR = {"bending": "x", "fine": "x", "solid_shell": "x", "square_cup": "x y", "aluminium": "x y", "round_cup": "x y",
          "round_cup_aa6016": "x y", "split_ring": "x y", "draw_bending": "x", "draw_bead": "x", "tray": "x y",
          "roll_forming": "y"}
PROBE = """<script>addEventListener("load", () => {
  const found = {broken: [...document.images].filter(i => !i.naturalWidth).map(i => i.alt),
    images: document.images.length, window: innerWidth,
    height: document.documentElement.scrollHeight,
    wide: [...document.querySelectorAll("section *")].filter(e => e.getBoundingClientRect().right > innerWidth + 1 &&
      !e.closest("pre")).map(e => e.tagName + " " + (e.alt || e.textContent.slice(0, 40))),
    numbers: [...document.body.innerText.matchAll(/.{0,40}\\b(nan|inf|None(?!\\.)|undefined)\\b.{0,20}/g)]
      .map(m => m[0])};
  document.body.innerHTML = "<pre id=found>" + JSON.stringify(found).replace(/</g, "") + "</pre>";
});</script>"""


def decks():
    """Return the input files with a blank by their names, without those whose tools are made by commands."""
    return {path.stem: path for path in sorted(DECKS.glob("*/*.dat")) if path.parent.name not in MADE_TOOLS
            and re.search(r"^\*BLANK", path.read_text(encoding="utf-8"), re.MULTILINE | re.IGNORECASE)}


def browser():
    """Return the path of a browser."""
    for name in BROWSERS:
        if path := shutil.which(name):
            return path
    raise Problem(f"no browser; expected one of {', '.join(BROWSERS)}")


def load(page, width, height, *words):
    """Load a page in a window and return what the browser writes."""
    command = [browser(), "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars",
               f"--window-size={width},{height}", "--virtual-time-budget=20000", *words, page.resolve().as_uri()]
    return subprocess.run(command, capture_output=True, text=True, check=True, timeout=300).stdout


def faults(page, width):
    """Return what is wrong with a page in a window of a width, and its height."""
    probe = page.with_name("probe.html")
    probe.write_text(page.read_text(encoding="utf-8").replace("</body>", PROBE + "</body>"), encoding="utf-8")
    text = load(probe, width, 2000, "--dump-dom")
    probe.unlink()
    found = json.loads(re.search(r'<pre id="found">(.*)</pre>', text)[1].replace("&amp;", "&").replace("&gt;", ">"))
    wrong = [f"picture not shown: {alt}" for alt in found["broken"]]
    wrong += [f"wider than {found['window']} pixels: {what}" for what in found["wide"]]
    wrong += [f"not a number: {text.strip()}" for text in found["numbers"]]
    if not found["images"]:
        wrong.append("no pictures")
    return wrong, found["height"]


def made(options, name, deck):
    """Return the folder of results of an input file, after its run unless it is there."""
    folder = options.work / f"{name}.out"
    if not (folder / "run.json").exists() or read_job(folder)["outcome"]["state"] != "reached":
        subprocess.run([options.program, "--output", folder, deck], check=True, stdout=subprocess.DEVNULL)
    return folder


def report(options, name, folder):
    """Make the report of a run and return what is wrong with the page."""
    mirror = ["--mirror", *MIRROR[name].split()] if name in MIRROR else []
    subprocess.run([sys.executable, "-m", "dd3", "report", folder, *mirror], check=True, stdout=subprocess.DEVNULL)
    page = folder / "report" / "report.html"
    wrong = []
    for width in WIDTHS:
        found, height = faults(page, width)
        wrong += found
        if width == WIDTHS[0]:
            picture = options.work / f"{name}.png"
            load(page, width, min(height, TALLEST), f"--screenshot={picture.resolve()}")
    return [f"{name}: {text}" for text in wrong]


def write(options, names):
    """Put small pictures, and the table of the runs of the page, into the documents."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    for name in names:
        with Image.open(options.work / f"{name}.png") as image:
            image.thumbnail(SMALL)
            image.convert("P", palette=Image.Palette.ADAPTIVE).save(PICTURES / f"{name}.png", optimize=True)
    jobs = {name: read_job(options.work / f"{name}.out") for name in SHOWN if (options.work / f"{name}.out").exists()}
    rows = [[name, str(job["counts"]["increments"]), " ".join(sorted({w["code"] for w in job["warnings"]}))]
            for name, job in jobs.items()]
    put_table(PAGE, "reports", table(["input file", "increments", "warnings"], rows), jobs.values())


def main():
    """Look at the pages of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("deck", nargs="*", help="input file, by its name, or a folder of results (default: all input "
                        "files with a blank but the tutorial's)")
    parser.add_argument("--program", default="dd3imp", help="the program dd3imp (default: the one on the path)")
    parser.add_argument("--work", type=Path, required=True, help="folder of the runs")
    parser.add_argument("--write", action="store_true", help="put the pictures into docs")
    options = parser.parse_args()
    there = decks()
    for name in options.deck:
        if name not in there and not Path(name, "run.json").exists():
            raise Problem(f"no input file or folder of results {name}; there are: {', '.join(there)}")
    options.work.mkdir(parents=True, exist_ok=True)
    names, wrong = [], []
    for name in each(options.deck or there, "reports"):
        folder = made(options, name, there[name]) if name in there else Path(name)
        name = Path(read_job(folder)["command"]["file"]).stem
        names.append(name)
        wrong += report(options, name, folder)
    if options.write:
        write(options, [name for name in names if name in SHOWN])
    if wrong:
        raise Problem("\n".join(wrong))


if __name__ == "__main__":
    run(main)
