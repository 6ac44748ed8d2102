#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Run the cells of a notebook and write it with their results: text, tables and pictures.

    utils/dev/notebook.py docs/notebooks/first_run.ipynb

The cells run in a folder that is removed afterwards, with pictures in the notebook as `%matplotlib inline` has them.
Jupyter is not needed; magics are left out.
"""
import argparse
import ast
import base64
import contextlib
import io
import json
import os
import re
import tempfile
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

from dd3.errors import run

DOTS = 70  # of an inch of a picture


def run_cell(source: str, names: dict[str, Any]) -> list[dict[str, Any]]:
    """Run a cell with the names of those before it; return its outputs."""
    tree = ast.parse(re.sub(r"^%.*$", "", source, flags=re.MULTILINE))
    last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    said, value = io.StringIO(), None
    with contextlib.redirect_stdout(said):
        exec(compile(tree, "cell", "exec"), names)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
    outputs: list[dict[str, Any]] = []
    if said.getvalue():
        outputs.append({"name": "stdout", "output_type": "stream", "text": lines(said.getvalue())})
    if value is not None:
        outputs.append({"data": shown(value), "execution_count": None, "metadata": {}, "output_type": "execute_result"})
    return outputs


def shown(value: Any) -> dict[str, Any]:
    """Return the forms of a value: a picture of a figure, a table of a frame, a text."""
    figure = getattr(value, "figure", value)
    if isinstance(figure, Figure):
        data = io.BytesIO()
        figure.savefig(data, format="png", dpi=DOTS, bbox_inches="tight")
        return {"image/png": base64.b64encode(data.getvalue()).decode(), "text/plain": ["<Figure>"]}
    html = value._repr_html_() if hasattr(value, "_repr_html_") else None
    return {**({"text/html": lines(html)} if html else {}), "text/plain": lines(repr(value))}


def lines(text: str) -> list[str]:
    """Return a text as a notebook stores it."""
    return text.splitlines(keepends=True)


def run_notebook(path: Path) -> dict[str, Any]:
    """Run the cells of a notebook; return it with their outputs."""
    book: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    names: dict[str, Any] = {"__name__": "__main__"}
    for number, cell in enumerate((cell for cell in book["cells"] if cell["cell_type"] == "code"), 1):
        cell["outputs"] = run_cell("".join(cell["source"]), names)
        cell["execution_count"] = number
        for output in cell["outputs"]:
            if "execution_count" in output:
                output["execution_count"] = number
    return book


def main() -> None:
    """Run the notebook of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("notebook", type=Path)
    path = parser.parse_args().notebook.resolve()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        text = json.dumps(run_notebook(path), indent=1, ensure_ascii=False, sort_keys=True) + "\n"
    path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    run(main)
