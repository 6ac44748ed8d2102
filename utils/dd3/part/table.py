# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables of the reading of a part: a short one for the screen, and one of all faces."""
from collections import Counter
from collections.abc import Sequence

import numpy as np

from dd3.part.corners import find_corners
from dd3.part.directions import Direction
from dd3.part.features import draft_range, least_radius
from dd3.part.reading import Reading
from dd3.tools.faces import spans

MOST = 6  # items in a line
SHORT = "kind", "direction", "bends", "holes", "notches", "radii", "read in"  # titles of the short summary


def summary(reading: Reading) -> list[str]:
    """Return the lines of the reading."""
    shape, sheet = reading.shape, reading.sheet
    rows = [("unit", "none stated, taken as mm" if reading.unit == "none" else
             "mm" if reading.unit == "mm" else f"{reading.unit}, converted to mm"),
            ("box", ", ".join(f"{name} {a:.4g} to {b:.4g}" for name, a, b
                              in zip("xyz", *rounded(shape.box, shape.size))) + " mm"),
            ("kind", kind_of(reading)),
            ("faces", faces_of(reading))]
    if not reading.direction:
        rows += [(f"part {number}", f"'{name}', {len(faces)} faces") for number, (name, faces)
                 in enumerate(reading.parts, 1)]
    if reading.direction:
        rows.append(("direction", direction_line(reading.direction)))
        rows += [("", direction_line(one)) for one in reading.directions if one is not reading.direction
                 and sheet.kind != "block" and one.projected > 0.03]
    rows += role_rows(reading)
    if reading.bends:
        rows.append(("bends", f"{len(reading.bends)}, along straight lines between flat faces: bent or flanged, "
                     "not drawn; "
                     + some([f"{bend.angle:.3g} degrees" for bend in reading.bends])))
    if reading.direction and sheet.kind != "block":
        kinds = Counter(hole.words for hole in reading.holes)
        rows += [("holes", counted(reading.holes, [f"{count} {words} mm" for words, count in kinds.items()])),
                 ("notches", counted(reading.notches, [f"{notch.width:.3g} mm wide, {notch.depth:.3g} mm deep"
                                                       for notch in reading.notches]))]
        corners = find_corners(shape, reading.direction.upper)
        rows += [("open", f"{len(corners)} corners between walls, at x y z = "
                  + some([one.said for one in corners], "; "))] if corners else []
    if reading.direction:
        rows.append(("radii", f"least inside {radius_words(reading.inner_radius)}, outside "
                     f"{radius_words(reading.outer_radius)}" if sheet.kind == "sheet" else
                     f"least {radius_words(reading.inner_radius)}"))
        rows.append(("symmetry", ", ".join(plane_words(*plane, shape.size) for plane in reading.symmetry) or "none"))
    rows += [("", note) for note in reading.notes]
    rows.append(("read in", f"{reading.seconds:.2g} s"))
    return [f"  {title:<10} {text}" for title, text in rows]


def short(reading: Reading) -> list[str]:
    """Return the lines that `dd3 tool` prints: one of each title of SHORT, and the notes."""
    notes = {f"  {'':<10} {note}" for note in reading.notes}
    return [line for line in summary(reading) if line[2:12].strip() in SHORT or line in notes]


def kind_of(reading: Reading) -> str:
    """Return what the part is in words."""
    sheet = reading.sheet
    if not reading.direction:
        return f"{len(reading.parts)} parts"
    shell = "closed shell without volume, " if reading.shape.closed and not reading.solid else ""
    if sheet.kind == "sheet":
        flat = "flat " if reading.flat else ""
        return f"{shell}{flat}sheet of {sheet.thickness:.4g} mm ({100 * sheet.fraction:.0f} % of its sides)"
    if sheet.kind == "surface":
        return "surface, without a thickness"
    walls = f"walls of {sheet.walls:.4g} mm that branch" if sheet.walls else "no two sides at one distance"
    return f"{shell}block: {walls}"


def faces_of(reading: Reading) -> str:
    """Return the numbers of faces in words."""
    sheet = reading.sheet
    if not reading.direction:
        return str(sum(len(faces) for _, faces in reading.parts))
    return f"{len(reading.shape.tags)}" + (f": {len(sheet.sides[0])} and {len(sheet.sides[1])} of the sides, "
                                           f"{len(sheet.rims)} of rims" if sheet.kind == "sheet" else "")


def direction_line(one: Direction) -> str:
    """Return a direction in words."""
    text = f"from {one.words}: "
    if one.free:
        text += f"no undercut, least draft {rounded(np.array(one.least), 1.0):.3g} degrees"
    elif one.undercut:
        numbers = spans(list(one.undercut))
        text += f"undercut {100 * one.fraction:.2g} %, faces {numbers if len(numbers) < 40 else numbers[:36] + ' ...'}"
    else:
        text += "as a tool of its own"
    return f"{text}, depth {one.depth:.4g} mm ({one.name})"


def role_rows(reading: Reading) -> list[tuple[str, str]]:
    """Return the faces of the upper side by their roles."""
    rows = []
    for name in ("floor", "step", "island", "wall", "corner", "bottom radius", "shoulder", "flange"):
        tags = [tag for tag, role in reading.roles.items() if role.name == name]
        if tags:
            radii = sorted({round(abs(reading.roles[tag].radius), 3) for tag in tags
                            if np.isfinite(reading.roles[tag].radius)})
            least = rounded(np.array(min(reading.roles[tag].draft[0] for tag in tags)), 1.0)
            extra = f", draft from {least:.3g} degrees" if name == "wall" else \
                f", radius {some([f'{radius:.4g}' for radius in radii])} mm" if "radius" in name or name in (
                    "shoulder", "corner") else ""
            rows.append((name.replace("bottom radius", "radius"), f"{named(tags)}{extra}"))
    return rows


def named(tags: list[int]) -> str:
    """Return numbers of faces in words."""
    return f"{'face' if len(tags) == 1 else 'faces'} {spans(tags)}"


def some(words: list[str], between: str = ", ") -> str:
    """Return the first of some words."""
    return between.join(words[:MOST]) + (f" and {len(words) - MOST} more" if len(words) > MOST else "")


def counted(items: Sequence[object], words: list[str]) -> str:
    """Return the number of some items, with words on them."""
    return f"{len(items)}" + (f": {some(words)}" if words else "")


def radius_words(radius: tuple[float, int]) -> str:
    """Return a least radius in words."""
    value, where = radius
    if not np.isfinite(value):
        return "none"
    return f"{value:.4g} mm (face {where})" if value else f"sharp (edge {where})"


def rounded(values: np.ndarray, size: float) -> np.ndarray:
    """Return lengths without the rounding errors of the CAD."""
    return np.round(values, int(np.ceil(6 - np.log10(size)))) + 0.0


def plane_words(normal: np.ndarray, distance: float, size: float) -> str:
    """Return a plane in words."""
    for axis, name in enumerate("xyz"):
        if abs(normal[axis]) > 1 - 1e-9:
            return f"{name} = {rounded(np.array(distance * np.sign(normal[axis])), size):.4g}"
    return "across " + " ".join(f"{value:.3g}" for value in rounded(normal, 1.0))


def face_rows(reading: Reading) -> list[str]:
    """Return a line for each face: kind of surface, side, role, area, least radius, least and largest draft."""
    shape, sheet, direction = reading.shape, reading.sheet, reading.direction
    lines = ["face  surface            side   role           area, mm2  radius, mm  draft, degrees"]
    hidden = direction.undercut if direction else {}
    for tag in shape.tags:
        side = "rim" if tag in sheet.rims else "" if not direction else "upper" if tag in direction.upper else "lower"
        role = reading.roles[tag].name if tag in reading.roles else ""
        radius = least_radius(shape, tag)
        angles = ""
        if direction and tag not in sheet.rims:
            least, largest = rounded(np.array(draft_range(shape, direction, tag)), 1.0)
            angles = f"{least:.3g} to {largest:.3g}"
        lines.append(f"{tag:<5d} {shape.kinds[tag][:18]:<18s} {side:<6s} {role:<14s} {shape.areas[tag]:<10.5g} "
                     f"{'flat' if np.isinf(radius) else f'{radius:.4g}':<11s} {angles}"
                     + (" undercut" if tag in hidden else ""))
    return lines


def edge_rows(reading: Reading) -> list[str]:
    """Return a line for each sharp edge of the sides: faces, length, angle."""
    sides = set(reading.sheet.sides[0] + reading.sheet.sides[1])
    lines = [f"{number:<5d} {spans(edge.faces):<12s} {edge.length:<10.5g} {edge.angle:.3g}"
             for number, edge in reading.shape.edges.items() if edge.angle and set(edge.faces) <= sides]
    return ["edge  faces        length, mm angle, degrees (convex positive)", *lines] if lines else []
