# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of documents, in Markdown."""

import re
from collections.abc import Iterable, Sequence
from pathlib import Path

from dd3.errors import Problem


def table(heading: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table."""
    return "\n".join("| " + " | ".join(row) + " |" for row in (heading, ["---"] * len(heading), *rows))


def put_table(document: Path, name: str, content: str) -> None:
    """Put a table into a document, between the lines `<!-- table: name -->` and `<!-- end of table -->`."""
    text = document.read_text(encoding="utf-8")
    text, count = re.subn(rf"(<!-- table: {name} -->\n).*?(<!-- end of table -->)",
                          lambda found: f"{found[1]}\n{content}\n\n{found[2]}", text, flags=re.DOTALL)
    if count != 1:
        raise Problem(f"{document}: there is no place for the table {name}")
    document.write_text(text, encoding="utf-8")
