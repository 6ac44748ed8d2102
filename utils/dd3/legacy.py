"""The description of a run as run.json gives it, from job.log and the input file, for programs that do not write it."""

import re
from pathlib import Path
from typing import Any

from dd3.errors import Problem
from dd3.tables import read_text
from dd3.tools.blocks import Block, blocks_of, lines_of, read_blocks, without_comment


def job_of(folder: Path, deck: Path | None = None, settings: dict[str, str] | None = None) -> dict[str, Any]:
    """Return the description."""
    log = read_text(folder / "job.log") if (folder / "job.log").is_file() else ""
    heading, echo = echo_in(log)
    deck = deck or deck_of(folder.resolve(), log)
    blocks = used_blocks(deck, echo, settings)
    seconds = re.search(r"iterations; ([\d.eE+-]+) s", log)
    title = heading[1:2] if heading[1:] and not heading[1].startswith("started") else []
    return {
        "program": {"name": "dd3imp", "version": "".join(heading[:1]).partition(":")[0].removeprefix("dd3imp ")},
        "command": {"file": str(deck or ""), "working_directory": None},
        "started": next((line.removeprefix("started ") for line in heading if line.startswith("started ")), ""),
        "title": "".join(title),
        "outcome": {"state": "reached" if "\nreached the end" in log else "stopped",
                    "message": (log.strip().splitlines() or [""])[-1]},
        "warnings": [{"text": found[2], "at": None}
                     for found in re.finditer(r"^(\S+:\d+: )?warning: (.*)$", log, re.M)],
        "seconds": float(seconds[1]) if seconds else None,
        "sections": sections_of(log),
        "input": {"blocks": [{"keyword": block.keyword, "name": block.name.lower(),
                              "entries": [{"key": key, "text": value, "unit": "", "default": False}
                                          for key, value in block.values]} for block in blocks_of(
                             (without_comment(line), folder) for line in echo)]},
        "materials": [{"name": block.name.lower(), "hardening": law_of(block)} for block in chosen(blocks, "material")],
        "tools": [{"name": block.name.lower(), "patches": str(block.folder / str(block.value("patches")).strip("\"'"))}
                  for block in chosen(blocks, "tool") if block.value("patches")],
        "drawbeads": [{"name": block.name.lower(), "points": points_of(block)} for block in chosen(blocks, "drawbead")],
    }


def chosen(blocks: list[Block], keyword: str) -> list[Block]:
    """Return the blocks of a keyword."""
    return [block for block in blocks if block.keyword == keyword]


def deck_of(folder: Path, log: str) -> Path | None:
    """Return the input file beside a folder of results, else the one that its log names; None without one."""
    files = [folder.with_suffix(ending) for ending in (".dat", ".inp", ".txt")]
    if log:
        files.append(Path(log.partition("\n")[0].partition(": ")[2]))
    return next((file for file in files if file.is_file()), None)


def echo_in(log: str) -> tuple[list[str], list[str]]:
    """Return the lines of a log before the input that it repeats with all values, and those lines."""
    lines = log.splitlines()
    first = next((i for i, line in enumerate(lines) if line.startswith("*")), len(lines))
    last = next((i for i, line in enumerate(lines[first:], first) if not line.startswith(("*", " "))), len(lines))
    return lines[:first], lines[first:last]


def used_blocks(deck: Path | None, echo: list[str], settings: dict[str, str] | None) -> list[Block]:
    """Return the blocks of tools, draw-beads and materials with the values that a run used: those of its log, the
    folders of relative paths from the input file. Without a log they are those of the input file with the settings."""
    found = []
    written = read_blocks(deck, settings) if deck else []
    said = blocks_of((without_comment(line), deck.parent if deck else Path()) for line in echo)
    for keyword in ("tool", "drawbead", "material"):
        one, other = chosen(written, keyword), chosen(said, keyword)
        if len(one) == len(other):
            for block, original in zip(other, one, strict=True):
                block.folder = original.folder
        found += other if len(one) == len(other) or (keyword == "material" and other) else one
    return found


def points_of(block: Block) -> list[list[float]]:
    """Return the vertices of a bead's line, from its block or the file that it names."""
    words = (block.value("points") or "").split()
    file = block.value("file")
    if not words and file:
        words = " ".join(line for line, _ in lines_of(block.folder / file.strip("\"'"))).split()
    try:
        numbers = [float(word.lower().replace("d", "e")) for word in words]
        return [list(pair) for pair in zip(numbers[::2], numbers[1::2], strict=True)]
    except ValueError:
        raise Problem(f"draw-bead '{block.name}': no pairs x y") from None


def law_of(block: Block) -> dict[str, Any]:
    """Return the hardening law of a material."""
    name, *words = (block.value("hardening") or "none").split()
    pairs = [word.partition("=") for word in words if "=" in word]
    return {"name": name, "parameters": [{"name": key, "value": number} for key, _, value in pairs
                                         if (number := value_of(value)) is not None]}


def value_of(text: str) -> float | None:
    """Return a number, None of another text."""
    try:
        return float(text)
    except ValueError:
        return None


def sections_of(log: str) -> dict[str, float]:
    """Return the seconds of each section."""
    _, _, tail = log.partition("time by section")
    words = (line.split() for line in tail.splitlines()[1:])
    return {pair[0]: float(pair[1]) for pair in words if len(pair) == 2 and value_of(pair[1]) is not None}
