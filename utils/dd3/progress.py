# SPDX-License-Identifier: GPL-3.0-or-later
"""Progress bars on stderr: on a terminal only, for work of more than a second, removed at the end."""

from collections.abc import Iterable, Iterator
from typing import Any, TypeVar

from tqdm import tqdm

Item = TypeVar("Item")
STYLE: dict[str, Any] = {"leave": False, "delay": 1.0, "disable": None, "dynamic_ncols": True}


def each(items: Iterable[Item], title: str) -> Iterator[Item]:
    """Yield items, with a bar."""
    yield from tqdm(items, title, **STYLE)


class Progress:
    """A bar that is called with the fraction that is done; `shown` elsewhere than on a terminal too."""

    def __init__(self, title: str, shown: bool = False) -> None:
        style = {**STYLE, "disable": False, "leave": True} if shown else STYLE
        self.bar = tqdm(desc=title, total=1.0, bar_format="{desc}: {percentage:3.0f}% |{bar}| {elapsed}", **style)

    def __call__(self, fraction: float) -> None:
        self.bar.update(fraction - self.bar.n)

    def end(self) -> None:
        """Remove the bar."""
        self.bar.close()


def counter(title: str, unit: str) -> "tqdm[Any]":
    """Return a counter of work of unknown size; call its `update`, and `close` at the end."""
    return tqdm(desc=title, unit=f" {unit}", **STYLE)
