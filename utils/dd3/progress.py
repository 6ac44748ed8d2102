# SPDX-License-Identifier: GPL-3.0-or-later
"""Progress on stderr: bars, on a terminal only, for work of more than a second, removed at the end; and lines on the
steps of longer work, elsewhere too."""

import sys
import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

from tqdm import tqdm

Item = TypeVar("Item")
QUIET = 3.0  # time after which it is told what is done, s
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


class Steps:
    """Steps of a command that are under way, each within the one before. None takes longer than a few seconds untold:
    after each of them the innermost step is told, the same one again when its time has doubled."""

    def __init__(self) -> None:
        self.open: list[tuple[str, float]] = []

    @contextmanager
    def doing(self, step: str) -> Iterator[None]:
        """Take the body, or a function, as a step."""
        self.open.append((step, time.monotonic()))
        done = threading.Event()
        teller = threading.Thread(target=self.tell, args=(done,), daemon=True) if len(self.open) == 1 else None
        if teller:
            teller.start()
        try:
            yield
        finally:
            done.set()
            if teller:
                teller.join()
            self.open.pop()

    def tell(self, done: threading.Event) -> None:
        """Tell the steps until they are done."""
        told, again = None, 0.0
        while not done.wait(QUIET):
            step, start = current = self.open[-1]
            spent = time.monotonic() - start
            if current != told or spent > again:
                tqdm.write(f"{step}: {spent:.0f} s", file=sys.stderr)
                told, again = current, 2 * spent


doing = Steps().doing


def counter(title: str, unit: str) -> "tqdm[Any]":
    """Return a counter of work of unknown size; call its `update`, and `close` at the end."""
    return tqdm(desc=title, unit=f" {unit}", **STYLE)
