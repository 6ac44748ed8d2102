#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the site of the documents with MkDocs, and the interface of the sources with FORD.

  site.py --work build/site      the pages are in build/site/html

Warnings are errors. `utils/dev/site.sh` calls it with what it needs installed.
"""
import argparse
import base64
import json
import pathlib
import re
import shutil
import subprocess
import sys

from accessible import Page

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
TOP = ["CONTRIBUTING.md", "CHANGELOG.md", "CODE_OF_CONDUCT.md", "SECURITY.md"]
FORD = """project: dd3imp
src_dir: {sources}
output_dir: {output}
predocmark: >
docmark: <
predocmark_alt:
docmark_alt:
display: public
exclude_dir: {sources}/external
graph: false
search: false
externalize: false
preprocess: false
print_creation_date: false
"""


def write_notebook(notebook):
    """Write a notebook as a page beside it: its texts, commands and outputs, the pictures as files."""
    parts, drawn = [], 0
    for cell in json.loads(notebook.read_text(encoding="utf-8"))["cells"]:
        source = "".join(cell["source"])
        parts.append(source if cell["cell_type"] == "markdown" else f"```python\n{source}\n```")
        for output in cell.get("outputs", []):
            data = output.get("data", {})
            if "image/png" in data:
                drawn += 1
                picture = notebook.with_name(f"{notebook.stem}_{drawn}.png")
                picture.write_bytes(base64.b64decode(data["image/png"]))
                parts.append(f"![Picture {drawn}]({picture.name})")
            else:
                text = "".join(output.get("text", data.get("text/plain", ""))).rstrip()
                parts.append(f"```text\n{text}\n```")
    notebook.with_suffix(".md").write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def copy_pages(pages):
    """Copy the documents, notebooks as pages; links lead to the copies, and files that they link to are copied too."""
    shutil.rmtree(pages, ignore_errors=True)
    shutil.copytree(ROOT / "docs", pages)
    for name in TOP:
        text = (ROOT / name).read_text(encoding="utf-8").replace("](docs/", "](")
        (pages / name).write_text(text, encoding="utf-8")
    shutil.copy(ROOT / "LICENSE", pages / "LICENSE.txt")
    shutil.copy(ROOT / "CITATION.cff", pages)
    for name in ("site.css", "frame_worker.js"):
        shutil.copy(HERE / name, pages)
    for notebook in pages.rglob("*.ipynb"):
        write_notebook(notebook)
    for page in pages.rglob("*.md"):
        text = page.read_text(encoding="utf-8").replace(".ipynb)", ".md)")
        up = "../" * (len(page.relative_to(pages).parts) - 1)
        text = re.sub(r"\]\(\s*(?:\.\./)+(CONTRIBUTING\.md|CHANGELOG\.md|CITATION\.cff)", rf"]({up}\1", text)
        text = re.sub(r"\]\(\s*(?:\.\./)+LICENSE\)", f"]({up}LICENSE.txt)", text)
        for link in re.findall(r"\]\(\s*((?:\.\./)*input_files/[^)#]+)\)", text):
            target = link[link.index("input_files/"):]
            (pages / target).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / target, pages / target)
            text = text.replace(f"({link})", f"({up}{target})")
        page.write_text(text, encoding="utf-8")


def remove_foreign_scripts(sources):
    """Remove what FORD's pages load from other hosts: a second jQuery, MathJax, shims for old browsers."""
    for page in sources.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        page.write_text(re.sub(r'<script src="https?://[^>]*></script>', "", text), encoding="utf-8")


def navigation(pages):
    """Return the settings of MkDocs with the pages of the folders that they name."""
    def listed(line):
        return "\n".join(f"{line[1]}- {path.relative_to(pages)}" for path in sorted((pages / line[2]).glob("*.md")))
    settings = (HERE / "mkdocs.yml").read_text(encoding="utf-8").replace(".ipynb", ".md")
    return re.sub(r"^( *)- (\w+)/\*$", listed, settings, flags=re.MULTILINE)


def check_hosts(site):
    """End where a page loads a script, a style or a picture from another host."""
    for page in site.rglob("*.html"):
        found = re.search(r'<(?:script|img|link rel="stylesheet")[^>]*(?:src|href)="https?://[^"]*"',
                          page.read_text(encoding="utf-8"))
        if found:
            sys.exit(f"{page}: {found[0]}")


def check_access(site):
    """End where a page of the documents lacks what a screen reader needs."""
    found = [f"{page}: no {fault}" for page in sorted(site.rglob("*.html")) if "sources" not in page.parts
             for fault in Page(page.read_text(encoding="utf-8")).faults()]
    if found:
        sys.exit("\n".join(found))


def run(words, folder):
    """Run a command; its warnings are errors."""
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    output = done.stdout + done.stderr
    if done.returncode or re.search(r"^(WARNING|Warning)", output, re.MULTILINE):
        sys.exit(f"{' '.join(map(str, words))}\n{output}")


def main():
    """Build the site."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--work", type=pathlib.Path, required=True, help="folder for copies and results")
    work = parser.parse_args().work.resolve()
    pages = work / "pages"
    copy_pages(pages)
    project = work / "ford.md"
    project.write_text(FORD.format(sources=ROOT / "src", output=pages / "sources"), encoding="utf-8")
    tools = pathlib.Path(sys.executable).parent
    run([tools / "ford", project], work)
    remove_foreign_scripts(pages / "sources")
    (work / "mkdocs.yml").write_text(navigation(pages), encoding="utf-8")
    shutil.copy(HERE / "mathematics.py", work)
    run([tools / "mkdocs", "build", "--strict"], work)
    check_hosts(work / "html")
    check_access(work / "html")
    print(work / "html" / "index.html")


if __name__ == "__main__":
    main()
