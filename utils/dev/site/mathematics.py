# SPDX-License-Identifier: GPL-3.0-or-later
"""Hook of MkDocs: the formulas of a page, `$...$` and blocks ```math, become MathML when the site is built.

The site then needs no script for them, and a formula that cannot be converted ends the build.
"""
import html
import re

from latex2mathml.converter import convert
from mkdocs.exceptions import PluginError

INLINE = re.compile(r'<span class="arithmatex">\\\((.*?)\\\)</span>', re.DOTALL)
BLOCK = re.compile(r'<div class="arithmatex">\\\[(.*?)\\\]</div>', re.DOTALL)


def on_page_content(content, page, **_):
    """Return the HTML of a page with its formulas in MathML."""
    def converted(display):
        def one(found):
            formula = html.unescape(found[1]).strip()
            try:
                return convert(formula, display=display)
            except Exception as error:  # the converter has many kinds
                raise PluginError(f"{page.file.src_path}: {formula}: {error!r}") from error
        return one
    return BLOCK.sub(converted("block"), INLINE.sub(converted("inline"), content))
