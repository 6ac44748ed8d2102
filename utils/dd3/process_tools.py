# SPDX-License-Identifier: GPL-3.0-or-later
"""Tools of a process that are made of CAD: the rows [[tool]] of its file, and their .bez files."""
import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import dd3
from dd3.errors import LOG, Problem
from dd3.tool import make
from dd3.tools.settings import ToolSettings

NUMBERS = ("scale", "sew", "tolerance", "offset", "radius")
#: Keys of a row and the types of their values: options of `dd3 tool` for one tool.
KEYS: dict[str, type[Any]] = {
    "source": str, "target": str, "toward": list, "rotate": list, "move": list, "part": list, "faces": list,
    "turn": bool, "smooth": bool, **dict.fromkeys(NUMBERS, float)}
MARK = "dd3 process"  # in the first line of a file that a process has made


def is_vector(value: Any, size: int) -> bool:
    """Return whether a value is a list of numbers of a size."""
    return isinstance(value, list) and len(value) == size and all(
        isinstance(number, (int, float)) and not isinstance(number, bool) for number in value)


def settings_of(row: Mapping[str, Any], folder: Path) -> ToolSettings:
    """Return the settings of a row; its paths belong to a folder."""
    if "source" not in row:
        raise Problem("no source; expected a CAD, mesh or shape file")
    for key in ("toward", "move"):
        if key in row and not is_vector(row[key], 3):
            raise Problem(f"{key} takes three numbers")
    if not all(is_vector(axis, 4) for axis in row.get("rotate", ())):
        raise Problem("rotate takes lists of an axis and an angle, [[x, y, z, degrees]]")
    source = folder / row["source"]
    target = folder / row["target"] if "target" in row else source.with_suffix(".bez")
    values = {key: value for key, value in row.items() if key not in ("source", "target")}
    for key in ("part", "faces"):
        if key in row:
            values[key] = [str(word) for word in row[key]]
    return ToolSettings(source=source, target=target, **values)


def read_tools(path: Path, rows: Sequence[Mapping[str, Any]]) -> list[ToolSettings]:
    """Return the settings of all rows of a file; report all errors at once."""
    found, errors = [], []
    for number, row in enumerate(rows, 1):
        try:
            found.append(settings_of(row, path.parent))
        except Problem as problem:
            errors.append(f"{path}: error: tool {number}: {problem}")
    targets = [settings.target for settings in found]
    errors += [f"{path}: error: {target} is the target of two tools"
               for target in sorted(set(targets)) if targets.count(target) > 1]
    if errors:
        raise Problem("\n".join(errors))
    return found


def note_of(settings: ToolSettings) -> str:
    """Return the note of a tool, which changes with its source, its settings and the version."""
    values = asdict(settings)
    given = {field.name: values[field.name] for field in fields(settings)
             if field.init and field.name not in ("source", "target")}
    text = json.dumps([dd3.__version__, given], sort_keys=True, default=str)
    return f"{MARK}, {hashlib.sha256(settings.source.read_bytes() + text.encode()).hexdigest()}"


def stale(settings: ToolSettings, note: str) -> bool:
    """Return whether a tool is to be made; refuse to replace a file that no process has made."""
    if not settings.target.is_file():
        return True
    with settings.target.open(encoding="utf-8", errors="replace") as file:
        first = file.readline()
    if not first.startswith(f"# {settings.source.name}: {MARK}"):
        raise Problem(f"{settings.target}: error: this file, the tool of {settings.source}, is not of `dd3 process`, "
                      "which does not replace it; remove it, give the tool another target, or leave out its [[tool]]")
    return first.strip() != f"# {settings.source.name}: {note}"


def make_tools(tools: Sequence[ToolSettings]) -> None:
    """Make the tools whose source or settings have changed; report the errors of all of them."""
    errors = []
    for settings in tools:
        try:
            note = note_of(settings)
            if not stale(settings, note):
                continue
            (report,) = make(settings, note).values()
        except Problem as problem:
            errors.append(str(problem))
            continue
        for text in report.warnings:
            LOG.warning(f"{settings.source}: {text}")
        errors += [f"{settings.source}: error: {text}" for text in report.errors]
        if not report.errors:
            LOG.info(f"{settings.target}: made of {settings.source.name}")
    if errors:
        raise Problem("\n".join(errors))
