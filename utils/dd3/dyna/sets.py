# SPDX-License-Identifier: GPL-3.0-or-later
"""Sets of an LS-DYNA deck: of nodes, parts, shells, solids and segments."""
import re
from collections.abc import Callable

from dd3.dyna.cards import Card, unread
from dd3.dyna.mesh import DynaMesh
from dd3.errors import Problem

KEYWORD = re.compile(r"\*SET_(NODE|PART|SHELL|SOLID|SEGMENT)(?:_(LIST|LIST_GENERATE|LIST_GENERATE_INCREMENT|GENERATE|"
                     r"COLUMN|ADD|GENERAL))?(_COLLECT)?$")
HEAD = "SID DA1 DA2 DA3 DA4 SOLVER ITS"
ATTRIBUTES = "values of a set that nothing here uses"
MOST = 10_000_000  # labels of a set
DEEPEST = 20  # of sets of sets


class Sets:
    """The sets by kind and number; their cards count as used when they are asked for."""

    def __init__(self, mesh: DynaMesh) -> None:
        self.mesh = mesh
        self.cards: dict[tuple[str, int], list[Card]] = {}
        self.others: list[Card] = []  # of kinds that are not read

    def take(self, card: Card) -> bool:
        """Take a card of a set that is read; check whether it is one."""
        found = KEYWORD.match(card.keyword)
        if not found or not card.lines:
            if card.keyword.startswith("*SET"):
                self.others.append(card)
            return False
        key = found[1], card.first(0)
        if key in self.cards and not found[3]:
            raise Problem(f"{card.place}: error: a second *SET_{key[0]} {key[1]}; the first is at "
                          f"{self.cards[key][0].place}")
        self.cards.setdefault(key, []).append(card)
        card.leave("nothing here uses it")
        return True

    def missing(self, kind: str, number: int, place: str) -> Problem:
        """Return the message on a set that is not there, with those that are not read."""
        other = [card for card in self.others if card.keyword.startswith(f"*SET_{kind}")]
        return Problem(f"{place}: error: there is no *SET_{kind} {number}" + unread(other))

    def has(self, kind: str, number: int) -> bool:
        """Check whether there is a set."""
        return (kind, number) in self.cards

    def get(self, kind: str, number: int, depth: int = 0) -> list[int]:
        """Return the labels of a set in their order; of segments those of their nodes."""
        if depth > DEEPEST:
            raise Problem(f"{self.mesh.path}: error: *SET_{kind} {number} is a set of itself")
        labels: list[int] = []
        for card in self.cards[kind, number]:
            head = card.row(0, HEAD)
            head.label("SID")
            head.leave(ATTRIBUTES)
            head.entry.read |= {"SOLVER", "ITS"}
            found = KEYWORD.match(card.keyword)
            option = (found[2] or "LIST") if found else ""
            labels += self.members(card, kind, option, depth)
            if len(labels) > MOST:
                raise Problem(f"{card.place}: error: a set of more than {MOST} labels")
        return list(dict.fromkeys(labels))

    def members(self, card: Card, kind: str, option: str, depth: int) -> list[int]:
        """Return the labels in the rows of a set."""
        if option.endswith("INCREMENT"):
            return [label for i, words in card.words(1) for label in ranged(card, i, *(
                card.whole(i, word) for word in [*words, "", ""][:3]))]
        if option.endswith("GENERATE"):
            return [label for i, words in card.words(1) for a, b in zip(words[::2], words[1::2]) if a or b
                    for label in ranged(card, i, card.whole(i, a), card.whole(i, b), 1)]
        if option == "COLUMN":
            return [card.whole(i, words[0]) for i, words in card.words(1)]
        if option == "ADD":
            return [label for number in card.labels(1) for label in self.one_of(card, kind, number, depth)]
        if option == "GENERAL":
            return self.general(card, kind, depth)
        if kind == "SEGMENT":
            return [label for i, words in card.words(1) for word in words[:4] if (label := card.whole(i, word))]
        return card.labels(1)

    def one_of(self, card: Card, kind: str, number: int, depth: int) -> list[int]:
        """Return the labels of a set that another names."""
        if not self.has(kind, number):
            raise self.missing(kind, number, card.place)
        return self.get(kind, number, depth + 1)

    def general(self, card: Card, kind: str, depth: int) -> list[int]:
        """Return the labels by the options of a set: ALL, the kind itself, PART, SET_.., each with D to take away."""
        labels: dict[int, None] = {}
        for i, words in card.words(1):
            option, numbers = words[0].upper(), [n for word in words[1:8] if (n := card.whole(i, word))]
            drop = option.startswith("D") and option != "DOF"
            name = option.removeprefix("D")
            found = self.by_option(card, kind, name, numbers, depth)
            if found is None:
                raise Problem(f"{card.place_of(i)}: error: {option} of {card.keyword} is not read; expected ALL, "
                              f"{kind}, PART or SET_{kind}")
            for label in found:
                if drop:
                    labels.pop(label, None)
                else:
                    labels[label] = None
        return list(labels)

    def by_option(self, card: Card, kind: str, name: str, numbers: list[int], depth: int) -> list[int] | None:
        """Return the labels of an option of a general set, None for one that is not read."""
        if name in (kind, "ELEM") and kind != "SEGMENT":
            return numbers
        if name == f"SET_{kind}" or (name == "SET" and kind in ("SHELL", "SOLID")):
            return [label for number in numbers for label in self.one_of(card, kind, number, depth)]
        taken: dict[str, Callable] = {"NODE": lambda cell: cell.nodes, "SEGMENT": lambda cell: cell.nodes,
                                      "PART": lambda cell: (cell.part,), "SHELL": lambda cell: (cell.label,),
                                      "SOLID": lambda cell: (cell.label,)}
        if name not in ("ALL", "PART"):
            return None
        return [label for cell in self.mesh.cells if (name == "ALL" or cell.part in numbers) and not (
            kind in ("SHELL", "SOLID") and cell.dimension != {"SHELL": 2, "SOLID": 3}[kind])
                for label in taken[kind](cell)]


def ranged(card: Card, i: int, first: int, last: int, step: int) -> range:
    """Return the labels from one to another."""
    if last < first or (step or 1) < 0 or last - first > MOST:
        raise Problem(f"{card.place_of(i)}: error: labels from {first} to {last}; expected them to increase")
    return range(first, last + 1, step or 1)
