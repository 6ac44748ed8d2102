# SPDX-License-Identifier: GPL-3.0-or-later
"""Arrays inside a page: quantised, their bytes sorted by significance, compressed by gzip, written in base64.

The browser reads an array when it is first shown. A number of 16 bits has an error of at most 1/131070 of the range of
its array.
"""

import base64
import gzip
from typing import Any

import numpy as np

LARGEST = 65535


class Arrays:
    """The arrays of a page, which refers to them by what `add` and `add_whole` return."""

    def __init__(self) -> None:
        self.elements: list[str] = []

    def add(self, values: np.ndarray) -> dict[str, Any]:
        """Add real numbers, of 16 bits over their range; of 32 bits where some are not finite."""
        values = np.asarray(values, float)
        if not np.isfinite(values).all():
            return self.write(values.astype(np.float32), "float32")
        low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 0.0)
        scaled = np.round((values - low) / ((high - low) or 1.0) * LARGEST).astype(np.uint16)
        return {**self.write(scaled, "uint16"), "low": low, "scale": (high - low) / LARGEST}

    def add_whole(self, values: np.ndarray) -> dict[str, Any]:
        """Add whole numbers that are not negative."""
        values = np.asarray(values)
        small = not values.size or values.max() < 256
        return self.write(values.astype(np.uint8 if small else np.uint32), "uint8" if small else "uint32")

    def write(self, values: np.ndarray, kind: str) -> dict[str, Any]:
        """Write an array of a kind and return its description."""
        whole = np.frombuffer(np.ascontiguousarray(values).astype(values.dtype.newbyteorder("<")).tobytes(), np.uint8)
        data = gzip.compress(whole.reshape(-1, values.itemsize).T.tobytes(), 6, mtime=0)
        number = len(self.elements)
        self.elements.append(f'<script type="text/plain" id="array{number}">{base64.b64encode(data).decode()}</script>')
        return {"number": number, "kind": kind}
