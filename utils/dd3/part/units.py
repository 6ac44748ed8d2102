# SPDX-License-Identifier: GPL-3.0-or-later
"""Unit of length that a CAD file states."""
import re
from pathlib import Path

INCH = 25.4
# Names of lengths in STEP and IGES; others are given as they are.
SI = {"MILLI": "mm", "CENTI": "cm", "MICRO": "µm", "": "m"}
OTHERS = {"INCH": "inch", "INCHES": "inch", "IN": "inch", "FOOT": "foot", "FT": "foot", "MM": "mm", "CM": "cm",
          "M": "m"}
IGES = {1: "inch", 2: "mm", 4: "foot", 6: "m", 10: "cm"}


def unit_of(path: Path) -> str:
    """Return the unit of a file, `none` where it states none."""
    ending = path.suffix.lower()
    if ending in (".step", ".stp"):
        return unit_of_step(path.read_text(encoding="latin-1"))
    if ending in (".iges", ".igs"):
        return unit_of_iges(path.read_text(encoding="latin-1").splitlines())
    return "none"


def unit_of_step(text: str) -> str:
    """Return the unit of a STEP file: a conversion of another unit counts before that."""
    statements = [part for part in text.split(";") if "LENGTH_UNIT" in part]
    for part in statements:
        name = re.search(r"CONVERSION_BASED_UNIT\s*\(\s*'([^']*)'", part)
        if name:
            return OTHERS.get(name[1].strip().upper(), name[1].strip().lower())
    for part in statements:
        prefix = re.search(r"SI_UNIT\s*\(\s*(?:\.(\w+)\.|\$)\s*,\s*\.METRE\.", part)
        if prefix:
            return SI.get(prefix[1] or "", f"{prefix[1]}metre".lower())
    return "none"


def unit_of_iges(lines: list[str]) -> str:
    """Return the unit of an IGES file: the flag of its global section, the 14th value."""
    text = "".join(line[:72] for line in lines if line[72:73] == "G")
    values: list[str] = []
    place = 0
    separator = ","
    while place < len(text) and len(values) < 14:
        word = re.match(r"\s*(\d+)H", text[place:])
        if word:  # a text of Hollerith, which may contain the separator
            end = place + word.end() + int(word[1])
            values.append(text[place + word.end():end])
            if len(values) == 1 and values[0]:
                separator = values[0]
            place = text.find(separator, end) + 1 or len(text)
        else:
            end = text.find(separator, place)
            end = len(text) if end < 0 else end
            values.append(text[place:end].strip())
            place = end + 1
    try:
        return IGES.get(int(values[13]), "none")
    except (IndexError, ValueError):
        return "none"
