# SPDX-License-Identifier: GPL-3.0-or-later
"""The account that a reader gives of its file: what it did not use, with the place of each.

A reader enters each card, entity or block of its file with its fields, and reads the fields from the entry. A field
that was never read is named by `Account.left_out`, and an entry of which none was read is named as a whole: a reader
needs no list of what it does not know.
"""
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple


class LeftOut(NamedTuple):
    """What was not carried over: its place in the file, the name of the entry, with the field if one alone, and why."""

    place: str
    name: str
    why: str

    def __str__(self) -> str:
        """Return it as a line."""
        return f"{self.place}: {self.name}: {self.why}"


@dataclass
class Entry:
    """A card, an entity or a block. `fields`: its values that say something, by name or position; `why`: the reason
    that is known for what is left out, by field, None for the whole entry."""

    place: str
    name: str
    fields: Mapping[Hashable, object]
    why: dict[Hashable | None, str] = field(default_factory=dict)
    read: set[Hashable] = field(default_factory=set)
    used: bool = False

    def take(self, key: Hashable, default: object = None) -> object:
        """Return a field, which counts as read."""
        self.used = True
        self.read.add(key)
        return self.fields.get(key, default)

    def use(self) -> None:
        """Count all fields as read."""
        self.used = True
        self.read |= set(self.fields)

    def leave(self, why: str, *keys: Hashable) -> None:
        """Give the reason why fields, or without names the whole entry, are left out."""
        self.why |= dict.fromkeys(keys or (None,), why)

    def left_out(self) -> Iterator[LeftOut]:
        """Yield what was not read."""
        if not self.used:
            yield LeftOut(self.place, self.name, self.why.get(None, "not read"))
            return
        for key in self.fields:
            if key not in self.read:
                yield LeftOut(self.place, f"{self.name}, {key} = {self.fields[key]}", self.why.get(key, "not used"))


class Account:
    """The entries of a file, in its order."""

    def __init__(self) -> None:
        self.entries: list[Entry] = []

    def enter(self, place: str, name: str, fields: Mapping[Hashable, object] | None = None) -> Entry:
        """Enter what a file holds."""
        self.entries.append(Entry(place, name, fields or {}))
        return self.entries[-1]

    def left_out(self) -> list[LeftOut]:
        """Return what was not used; of several entries with the same name, field and reason the first, with their
        number."""
        first: dict[tuple[str, Hashable, str], list[LeftOut]] = {}
        for entry in self.entries:
            for item in entry.left_out():
                first.setdefault((entry.name, item.name.partition(" = ")[0], item.why), []).append(item)
        return [same[0] if len(same) == 1 else same[0]._replace(why=f"{same[0].why} ({len(same)} of this kind)")
                for same in first.values()]
