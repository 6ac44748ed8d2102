# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures that need no display, and the options that their commands share."""

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dd3.command import new_parser
from dd3.errors import Problem
from dd3.tables import label_of


def new_figure(size: tuple[float, float], rows: int = 1, columns: int = 1, **options: Any) -> tuple[Figure, Any]:
    """Return a figure of a size in inches and its axes: one, or an array of them."""
    figure = Figure(figsize=size, layout="constrained")
    return figure, figure.subplots(rows, columns, **options)


def save(figure: Figure, path: str | Path, dpi: int = 200) -> None:
    """Write a figure."""
    try:
        figure.savefig(path, dpi=dpi)
    except (OSError, ValueError) as error:
        raise Problem(f"{path}: {error}") from None


def tidy(axes: Axes, colour: str = "0.9") -> None:
    """Add a grid and remove the frame above and on the right."""
    axes.grid(True, color=colour, linewidth=0.7)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def parser_of_pictures(name: str, text: str | None, table: str, output: str, size: str) -> argparse.ArgumentParser:
    """Return the parser of pictures of several runs, which are given by their folder or a table."""
    parser = new_parser(name, text)
    parser.add_argument("runs", nargs="+", metavar="RUN", help=f"folder of results, or its {table}")
    parser.add_argument("--phase", action="append", default=[],
                        help="phase to draw; may be repeated (default: the last)")
    parser.add_argument("--label", action="append", default=[], help="name of a run in the picture, in their order")
    parser.add_argument("--title", default="", help="title above the picture")
    parser.add_argument("--output", default=output, help=f"picture to write: .png, .svg or .pdf ({output})")
    parser.add_argument("--size", type=float, nargs=2, metavar=("W", "H"), help=f"size in inches ({size})")
    return parser


def labels_of(runs: Sequence[str | Path], labels: Sequence[str]) -> list[str]:
    """Return the names of runs: those given, then those of their folders."""
    if len(labels) > len(runs):
        raise Problem("more labels than runs")
    return [*labels, *(label_of(run) for run in runs[len(labels):])]


def save_pictures(figure: Callable[..., Figure], parser: argparse.ArgumentParser, words: Sequence[str] | None) -> None:
    """Draw the runs of a command line by a function that takes them, their labels, and the other options by name."""
    options = vars(parser.parse_args(words))
    output, runs, labels = (options.pop(name) for name in ("output", "runs", "label"))
    if options["size"] is None:  # that of the function
        del options["size"]
    save(figure(runs, labels, **options), output)
    print(output)
