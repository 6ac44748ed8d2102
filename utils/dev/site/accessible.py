# SPDX-License-Identifier: GPL-3.0-or-later
"""What a screen reader needs of a page: its language, one title, headings without gaps, a text for each picture and
link, a name for each control. The switches of the theme, md-*, are left out."""
import re
from html.parser import HTMLParser


class Page(HTMLParser):
    """A page; `faults` tells what it lacks."""

    def __init__(self, text):
        super().__init__()
        self.language, self.levels, self.lacking, self.controls, self.labels = "", [], [], [], set()
        self.link = None
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        """Take a tag."""
        values = dict(attrs)
        named = values.get("aria-label") or values.get("title") or values.get("alt")
        if tag == "html":
            self.language = values.get("lang") or ""
        elif re.fullmatch("h[1-6]", tag):
            self.levels.append(int(tag[1]))
        elif tag == "img" and not named:
            self.lacking.append(f"text of the picture {values.get('src')}")
        elif tag == "label":
            self.labels.add(values.get("for"))
        elif tag in ("input", "select") and not named and "md-" not in values.get("class", ""):
            self.controls.append(values.get("id"))
        elif tag == "a" and "href" in values:
            self.link = (values["href"], named or "")
        if self.link and tag == "img":
            self.handle_data(named or "")

    def handle_data(self, data):
        """Take text."""
        if self.link:
            self.link = self.link[0], self.link[1] + data

    def handle_endtag(self, tag):
        """Take the end of a tag."""
        if tag == "a" and self.link:
            if not self.link[1].strip():
                self.lacking.append(f"text of the link {self.link[0]}")
            self.link = None

    def faults(self):
        """Return what the page lacks."""
        gaps = any(after > before + 1 for before, after in zip(self.levels, self.levels[1:]))
        return [*(["language"] if not self.language else []), *(["one title"] if self.levels.count(1) != 1 else []),
                *(["headings without gaps"] if gaps else []), *self.lacking,
                *(f"name of the control {name}" for name in self.controls if name not in self.labels)]
