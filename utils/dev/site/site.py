#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the site of the documents with MkDocs, and the interface of the sources with FORD.

  site.py --work build/site      the pages are in build/site/site

Warnings are errors. Needs `pip install "./utils[test]"`.
"""
import argparse
import pathlib
import re
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
TOP = {"README.md": "index.md", "CONTRIBUTING.md": "CONTRIBUTING.md", "CHANGELOG.md": "CHANGELOG.md"}
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


def copy_pages(pages):
    """Copy the documents; links lead to the copies, and files that they link to are copied too."""
    shutil.rmtree(pages, ignore_errors=True)
    shutil.copytree(ROOT / "docs", pages)
    for name, copy in TOP.items():
        text = (ROOT / name).read_text(encoding="utf-8").replace("](docs/", "](")
        (pages / copy).write_text(text.replace("](LICENSE)", "](LICENSE.txt)"), encoding="utf-8")
    shutil.copy(ROOT / "LICENSE", pages / "LICENSE.txt")
    shutil.copy(ROOT / "CITATION.cff", pages)
    for page in pages.rglob("*.md"):
        text = page.read_text(encoding="utf-8")
        up = "../" * (len(page.relative_to(pages).parts) - 1)
        text = re.sub(r"\]\(\s*(?:\.\./)+CONTRIBUTING\.md", f"]({up}CONTRIBUTING.md", text)
        for link in re.findall(r"\]\(\s*((?:\.\./)*input_files/[^)#]+)\)", text):
            target = link[link.index("input_files/"):]
            (pages / target).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / target, pages / target)
            text = text.replace(f"({link})", f"({up}{target})")
        page.write_text(text, encoding="utf-8")


def navigation(pages):
    """Return the settings of MkDocs with the pages of the folders that they name."""
    def listed(line):
        return "\n".join(f"{line[1]}- {path.relative_to(pages)}" for path in sorted((pages / line[2]).glob("*.md")))
    return re.sub(r"^( *)- (\w+)/\*$", listed, (HERE / "mkdocs.yml").read_text(encoding="utf-8"), flags=re.MULTILINE)


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
    (work / "mkdocs.yml").write_text(navigation(pages), encoding="utf-8")
    run([tools / "mkdocs", "build", "--strict"], work)
    print(work / "site" / "index.html")


if __name__ == "__main__":
    main()
