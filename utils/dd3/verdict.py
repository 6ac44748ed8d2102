# SPDX-License-Identifier: GPL-3.0-or-later
"""Verdict on a formed part: whether the sheet is formed to the tools, splits, waves, springs back too far."""

from collections.abc import Sequence
from typing import Any, NamedTuple

from dd3.fields import LIMITED
from dd3.run import parts_of, warnings_of

THINNING = 0.25  # largest thinning where no limit is given
GOOD, BAD, DOUBTFUL, OPEN = "good", "not good", "doubtful", "not judged"
# Of the members of `closing` for the limits that a run follows: question, code of the warning, what the value is.
REACHED = dict(zip(LIMITED, (("fracture", "W126", "damage"),
                             ("forming limit of bent paths", "W127", "ratio through the thickness"))))
COLOURS = {GOOD: "#009e73", BAD: "#d55e00", DOUBTFUL: "#f0e442", OPEN: "#9aa0a6"}


class Item(NamedTuple):
    """A question of the verdict, its answer, and the figures."""

    name: str
    answer: str
    text: str


class Ended(NamedTuple):
    """A phase that has ended: its name, what run.json tells of the tools at its end, and the codes of its warnings."""

    phase: str
    closing: dict[str, Any]
    codes: set[str]


def ended_phases(job: dict[str, Any]) -> list[Ended]:
    """Return the phases of a run with what they tell of the sheet between the tools, also those before a restart, but
    for those that it makes again."""
    found, warnings = {}, warnings_of(job)
    for part, end in parts_of(job):
        for phase in part["phases"]:
            name, result = phase["name"], phase.get("result", {})
            if result.get("closing") and (result.get("last_increment") or 0) <= end:
                found[name] = Ended(name, result["closing"], {warning["code"] for warning in warnings
                                                              if warning["phase"] == name})
    return list(found.values())


def at(place: dict[str, Any]) -> str:
    """Return where a distance, or a value of an element, is."""
    kind = "node" if "node" in place else "element"
    return f"at ({', '.join(f'{x:.1f}' for x in place['position'])}) mm, {kind} {place[kind]}"


def end_of_run(job: dict[str, Any]) -> Item:
    """Judge how the run ended."""
    outcome = job["outcome"]
    reached = outcome["state"] == "reached"
    return Item("run", GOOD if reached else BAD,
                "reached its end" if reached else str(outcome["message"] or outcome["state"]))


def limits_of_material(job: dict[str, Any], phases: Sequence[Ended]) -> list[Item]:
    """Judge by the limits of the materials that the run follows: the damage of a law of fracture, and the forming limit
    of paths that bend, at the end of the last phase that has ended, or by the warning in one that has not."""
    items = []
    for name, (question, code, value) in REACHED.items():
        found = [reached for phase in phases if (reached := phase.closing.get(name))]
        first = [str(warning["text"]) for warning in warnings_of(job) if warning["code"] == code]
        if found:
            items.append(Item(question, BAD if first or found[-1]["value"] >= 1 else GOOD,
                              f"largest {value} {found[-1]['value']:.3g}, {at(found[-1])}; 1 is the limit"))
        elif first:
            items.append(Item(question, BAD, first[0]))
    return items


def formed(phases: Sequence[Ended], waves: float | None) -> list[Item]:
    """Judge whether the sheet is formed to the tools where punches have ended their paths, and the waves in walls.

    A wave between two tools crosses the middle between its crest and its trough, where it is at least half its height
    off both.
    """
    if not phases:
        return [Item("formed to the tools", OPEN, "the run does not tell; dd3imp does from version 2.7.0 on")]
    ends = [(phase, punch) for phase in phases for punch in phase.closing["punches"]]
    if not ends:
        return [Item("formed to the tools", OPEN, "no punch has ended its path on the sheet")]
    items = []
    for phase, punch in ends:
        left, off, wall = punch["path_left"], punch["off_tools"], punch["off_walls"]
        if off is None:
            items.append(Item("formed to the tools", OPEN,
                              f"no tool is across from '{punch['tool']}' at the end of phase '{phase.phase}'"))
        else:
            path = (f"; path left of '{punch['tool']}' before '{left['tool']}': {left['distance']:.2g} mm, {at(left)}"
                    if left else "")
            items.append(Item("formed to the tools", BAD if "W119" in phase.codes else GOOD,
                              f"within {off['distance']:.2g} mm, largest {at(off)}{path}"))
        if wall:
            answer = OPEN if waves is None else GOOD if 2 * wall["distance"] <= waves else DOUBTFUL
            items.append(Item("waves in walls", answer,
                              f"at most {2 * wall['distance']:.2g} mm high, as the sheet is up to "
                              f"{wall['distance']:.2g} mm off the nearer tool, {at(wall)}; there the tools leave "
                              f"{punch['wall_space']:.2g} mm beyond the thickness" + limit_text("--waves", waves)))
    return items


def slides(phases: Sequence[Ended]) -> list[Item]:
    """Tell how far the sheet has slid under each punch, at the end of the last phase in which it ends its path."""
    slid = [(phase, punch) for phase in phases for punch in phase.closing["punches"] if punch.get("slide")]
    warned = {punch["tool"] for phase, punch in slid if "W124" in phase.codes}
    last = {punch["tool"]: punch["slide"] for _, punch in slid}
    return [Item("slide", DOUBTFUL if tool in warned else GOOD,
                 f"the sheet under the level faces of '{tool}' has slid by {place['distance']:.2g} mm or more, least "
                 f"{at(place)}")
            for tool, place in last.items()]


def holders(phases: Sequence[Ended], limit: float | None) -> list[Item]:
    """Judge the waves under the holders at the end of the forming, and tell of the sheet beyond them."""
    last = {holder["tool"]: holder for phase in phases for holder in phase.closing["holders"]}
    items = []
    for tool, holder in last.items():
        wave, lift = holder["wave"], holder["lift"]
        if wave is None:
            continue
        answer = OPEN if limit is None else BAD if wave["distance"] > limit else GOOD
        text = f"{wave['distance']:.2g} mm high, {at(wave)}"
        if lift:
            text += f"; up to {lift['distance']:.2g} mm off '{lift['tool']}'"
        items.append(Item(f"waves under '{tool}'", answer, text + limit_text("--waves", limit)))
    beyond = {}
    for phase in phases:
        for holder in phase.closing["holders"]:
            if "W120" in phase.codes and holder["beyond"]:
                beyond[holder["tool"]] = (phase, holder["beyond"])
    items += [Item("sheet beyond the holder", DOUBTFUL, f"up to {place['distance']:.3g} mm beyond '{tool}' in phase "
                                                        f"'{phase.phase}', {at(place)}")
              for tool, (phase, place) in beyond.items()]
    return items


def supports(phases: Sequence[Ended]) -> list[Item]:
    """Tell of supports that carry a part of the tool force."""
    return [Item("supports", DOUBTFUL,
                 f"'{support['name']}' carries {support['reaction']:.3g} N along {support['axis']}, "
                 f"'{support['tool']}' {support['tool_force']:.4g} N, at the end of phase '{phase.phase}'")
            for phase in phases if "W121" in phase.codes and (support := phase.closing["support"])]


def pins(phases: Sequence[Ended]) -> list[Item]:
    """Judge the bearing pressure of locating pins on their holes by the yield stress, at the largest force of each."""
    carried = [(pin, phase) for phase in phases for pin in phase.closing.get("pins", [])]
    largest = {pin["name"]: (pin, phase) for pin, phase in sorted(carried, key=lambda both: both[0]["force"])}
    return [Item("pins", DOUBTFUL if pin["bearing_pressure"] > pin["yield_stress"] else GOOD,
                 f"'{pin['name']}' of {pin['diameter']:g} mm carries up to {pin['force']:.3g} N in phase "
                 f"'{phase.phase}', a bearing pressure of {pin['bearing_pressure']:.3g} MPa; yield stress of the sheet "
                 f"there {pin['yield_stress']:.3g} MPa")
            for pin, phase in largest.values() if pin["force"] > 0.0]


def limit_text(option: str, limit: float | None) -> str:
    """Return the limit of an option."""
    return f" ({option} {limit:g} mm)" if limit is not None else f" (no limit: {option})"


def splits(critical: int | None, said: Sequence[str], thinned: bool) -> list[Item]:
    """Judge by the forming limit curve and by the thinning.

    critical: number of critical nodes and elements, None without a curve. said: what the diagram says of both.
    """
    answer = OPEN if critical is None else BAD if critical else GOOD
    return [Item("forming limit", answer, said[0]), Item("thinning", BAD if thinned else GOOD, said[1])]


def sprung(distance: float | None, tolerance: float | None, unfinished: str = "") -> list[Item]:
    """Judge the springback by its tolerance; distance: the largest one from the drawn shape, None without a release
    that has ended; unfinished: words on one that has not."""
    if distance is None:
        said = unfinished or (tolerance is not None and "the run does not release the sheet")
        return [Item("springback", OPEN, said)] if said else []
    answer = OPEN if tolerance is None else BAD if distance > tolerance else GOOD
    text = f"up to {distance:.3g} mm from the drawn shape"
    return [Item("springback", answer, text + limit_text("--tolerance", tolerance))]


def judge(job: dict[str, Any], waves: float | None, limits: Sequence[Item], springback: Sequence[Item]) -> list[Item]:
    """Return all items.

    waves: largest height under a holder and in walls, mm. limits, springback: items of `splits`, of `sprung` and the
    fixture.
    """
    phases = ended_phases(job)
    return [end_of_run(job), *limits_of_material(job, phases), *formed(phases, waves), *slides(phases),
            *holders(phases, waves), *limits, *springback, *supports(phases), *pins(phases)]


def summary(items: Sequence[Item]) -> str:
    """Return the verdict in one line."""
    named = {answer: list(dict.fromkeys(item.name for item in items if item.answer == answer)) for answer in COLOURS}
    said = f"{BAD}: {', '.join(named[BAD])}" if named[BAD] else "nothing found against the part"
    for answer in (DOUBTFUL, OPEN):
        if named[answer]:
            said += f"; {answer}: {', '.join(named[answer])}"
    return said


def failed(items: Sequence[Item]) -> bool:
    """Whether something is not good."""
    return any(item.answer == BAD for item in items)
