#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
#: {"name": "docs_navigation", "labels": ["docs"], "timeout": 60}
"""Compare the navigation of the site, utils/dev/site/mkdocs.yml, and docs/README.md with the pages of docs.

Each page and notebook is in the navigation once, and docs/README.md links to each but those of the laws, which the pages
of their kinds list. Each picture of docs is shown by a page. Formulas are on the pages as GitHub reads them: a block
`math` is closed, and `$` comes in pairs.
"""
import collections
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
OTHER = {"CONTRIBUTING.md", "CHANGELOG.md", "CODE_OF_CONDUCT.md", "SECURITY.md"}  # of the root of the repository
ENTRY = re.compile(r"^ +- (?:[^:\n]+: )?([\w/]+\.(?:md|ipynb)|\w+/\*)$", re.MULTILINE)
CODE = re.compile(r"^```.*?^```|`[^`\n]*`|^ {4}[^\n]*$", re.DOTALL | re.MULTILINE)


def listed():
    """Return the pages of the navigation, one for each entry."""
    text = (ROOT / "utils" / "dev" / "site" / "mkdocs.yml").read_text(encoding="utf-8").split("\nnav:")[1]
    for entry in ENTRY.findall(text):
        if entry.endswith("/*"):
            yield from (str(path.relative_to(DOCS)) for path in DOCS.glob(entry + ".md"))
        elif entry not in OTHER:
            yield entry


def wrong_entries(pages):
    """Yield the pages that the navigation has not, or not once, and its entries without a page."""
    count = collections.Counter(listed())
    for page in sorted(pages | count.keys()):
        if page not in pages:
            yield f"utils/dev/site/mkdocs.yml: there is no page docs/{page}"
        elif count[page] != 1:
            yield f"utils/dev/site/mkdocs.yml: docs/{page} is {count[page]} times in the navigation, not once"
    home = (DOCS / "README.md").read_text(encoding="utf-8")
    for page in sorted(pages - {"README.md"}):
        if not page.startswith("laws/") and f"]({page})" not in home:
            yield f"docs/README.md has no link to {page}"


def unused_pictures(texts):
    """Yield the pictures of docs that no page shows."""
    shown = "".join([*texts.values(), (ROOT / "README.md").read_text(encoding="utf-8")])
    for picture in sorted((DOCS / "images").rglob("*.*")):
        if f"images/{picture.relative_to(DOCS / 'images')})" not in shown:
            yield f"{picture.relative_to(ROOT)} is on no page"


def open_formulas(page, text):
    """Yield the paragraphs of a page with an odd number of `$` outside of code."""
    if text.count("```") % 2:
        yield f"docs/{page}: a block is not closed"
    for paragraph in re.split(r"\n\s*\n", CODE.sub("", text)):
        if len(re.findall(r"\$(?!\{)", paragraph)) % 2:  # ${name} is a parameter of the input
            yield f"docs/{page}: a formula is not closed: {paragraph.strip()[:60]}"


def main():
    """Print the errors; exit code 1 if there are any."""
    texts = {str(path.relative_to(DOCS)): path.read_text(encoding="utf-8") for path in DOCS.rglob("*.md")}
    notebooks = {str(path.relative_to(DOCS)) for path in DOCS.rglob("*.ipynb")}
    wrong = [*wrong_entries(texts.keys() | notebooks), *unused_pictures(texts)]
    for page, text in sorted(texts.items()):
        wrong += open_formulas(page, text)
    if wrong:
        sys.exit("\n".join(wrong))


if __name__ == "__main__":
    main()
