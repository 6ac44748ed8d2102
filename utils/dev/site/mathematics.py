# SPDX-License-Identifier: GPL-3.0-or-later
"""Hook of MkDocs: pandoc converts the formulas of a page, `$...$` and blocks ```math, to MathML.

The site then needs no script for them, and a formula that cannot be converted ends the build.
"""
import html
import re
import subprocess

import pypandoc
from mkdocs.exceptions import PluginError

FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL)
RESULT = re.compile(r"<math.*?</math>", re.DOTALL)
SOURCE = re.compile(r"<annotation.*?</annotation>", re.DOTALL)


def converted(formulas):
    """Return the MathML of formulas, each a pair of its element, div for a block, and its TeX."""
    marks = {"div": "$$", "span": "$"}
    text = "\n\n".join(marks[kind] + html.unescape(formula).strip() + marks[kind] for kind, formula in formulas)
    words = [pypandoc.get_pandoc_path(), "--from=markdown", "--to=html", "--mathml", "--fail-if-warnings"]
    done = subprocess.run(words, input=text, capture_output=True, text=True, check=False)
    found = RESULT.findall(SOURCE.sub("", done.stdout))
    if done.returncode or len(found) != len(formulas):
        raise PluginError(f"{len(found)} of {len(formulas)} formulas are converted: {done.stderr}")
    return found


def on_page_content(content, page, **_):
    """Return the HTML of a page with its formulas in MathML."""
    formulas = FORMULA.findall(content)
    if not formulas:
        return content
    try:
        results = iter(converted(formulas))
    except PluginError as error:
        raise PluginError(f"{page.file.src_path}: {error}") from error
    return FORMULA.sub(lambda _: next(results), content)
