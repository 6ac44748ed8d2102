# SPDX-License-Identifier: GPL-3.0-or-later
"""Reader of the curves of DXF files: lines, arcs, polylines and splines, of inserted blocks too."""
import logging
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import BSpline, CubicSpline

from dd3.account import Account, Entry
from dd3.errors import Problem
from dd3.pieces import SAME, Value, points_only, repeated, sampled

CURVES = ("LINE", "ARC", "CIRCLE", "ELLIPSE", "LWPOLYLINE", "POLYLINE", "SPLINE", "HELIX")
SEGMENTS = 16  # cubic pieces of a quarter of a circle at least: 1e-7 of its radius from it
DEEPEST, MOST = 32, 100_000  # blocks inside blocks; pieces of a file
LARGEST, FINEST = 1e9, 1e-8  # coordinate; chord over the size of a curve
CLOSED = 1  # flag of a spline
FITTED, FRAME = 4, 16  # flags of a polyline with a spline, and of a vertex of its control frame
NO_LENGTH, EQUAL = "of length 0", "equal to another one, which is used"
NOT_A_CURVE = "not a curve that is read: " + ", ".join(CURVES)


@dataclass
class Drawing:
    """An open file: the account of its entities, their lines by handle, its curves as points in its unit, and the
    layers that were met."""

    path: Path
    chord: float
    layer: str | None
    account: Account
    lines: dict[str, int]
    entries: dict[Any, Entry] = field(default_factory=dict)
    pieces: list[np.ndarray] = field(default_factory=list)
    owners: list[Entry] = field(default_factory=list)
    layers: set[str] = field(default_factory=set)

    def entry(self, entity: Any, where: str = "") -> Entry:
        """Return the entry of an entity, the same for each insertion of its block."""
        handle = str(entity.dxf.get("handle", ""))
        key = handle or id(entity)
        if key not in self.entries:
            line = self.lines.get(handle)
            place = f"{self.path}:{line}" if line else f"{self.path}: entity {handle}" if handle else str(self.path)
            self.entries[key] = self.account.enter(place, f"{entity.dxftype()} on layer {entity.dxf.layer}{where}")
            self.entries[key].leave(NOT_A_CURVE)
        return self.entries[key]

    def leave(self, indices: list[int], why: str) -> None:
        """Leave out pieces."""
        for index in indices:
            self.account.enter(self.owners[index].place, self.owners[index].name).leave(why)
        left = set(indices)
        self.pieces, self.owners = ([item for index, item in enumerate(items) if index not in left]  # type: ignore
                                    for items in (self.pieces, self.owners))


def pieces_of_dxf(path: Path, chord: float, layer: str | None, account: Account) -> list[np.ndarray]:
    """Return the curves of a DXF file, in mm, as points."""
    from ezdxf import units
    document = opened(path, account)
    try:
        unit = units.InsertUnits(document.units)
        scale = units.conversion_factor(unit, units.InsertUnits.Millimeters) if document.units else 1.0
    except (ValueError, KeyError, TypeError):
        raise Problem(f"{path}: $INSUNITS = {document.units} is not a unit of DXF") from None
    if not document.units:
        account.enter(str(path), "unit").leave("$INSUNITS names none: lengths are taken as mm")
    drawing = Drawing(path, chord / scale, layer, account, lines_of(path))
    inserted: set[str] = set()
    try:
        walk(drawing, document.modelspace(), None, None, inserted, ())
        others(drawing, document, inserted)
    except (Problem, ImportError):
        raise
    except Exception as error:  # ezdxf raises many kinds on damaged files
        raise Problem(f"{path}: a damaged DXF file: {type(error).__name__}: {error}") from None
    if layer is not None and layer not in drawing.layers:
        raise Problem(f"{path}: no layer '{layer}'; there are: {' '.join(sorted(drawing.layers))}")
    drawing.leave(points_only(drawing.pieces), NO_LENGTH)
    drawing.leave(repeated(drawing.pieces, drawing.chord), EQUAL)
    return [scale * piece for piece in drawing.pieces]


class Remarks(logging.Handler):
    """What ezdxf remarks on a file, such as content that it ignores, as entries that are left out."""

    def __init__(self, path: Path, account: Account) -> None:
        super().__init__(logging.WARNING)
        self.path, self.account = path, account

    def emit(self, record: logging.LogRecord) -> None:
        """Enter a remark."""
        self.account.enter(str(self.path), "structure").leave(record.getMessage().strip())


def opened(path: Path, account: Account) -> Any:
    """Return the document of a file."""
    import ezdxf
    remarks, log = Remarks(path, account), logging.getLogger("ezdxf")
    log.addHandler(remarks)
    log.propagate = False
    try:
        return ezdxf.readfile(path)
    except OSError as error:
        raise Problem(f"{path}: {error.strerror or error}") from None
    except Exception as error:  # many kinds
        raise Problem(f"{path}: not a DXF file, or a damaged one: {error}") from None
    finally:
        log.removeHandler(remarks)


def lines_of(path: Path) -> dict[str, int]:
    """Return the line where each entity of a text file begins, by its handle."""
    data = path.read_bytes()
    if data.startswith(b"AutoCAD Binary DXF"):
        return {}
    lines = [line.strip() for line in data.decode("utf-8", errors="replace").splitlines()]
    found: dict[str, int] = {}
    start = 0
    for i in range(0, len(lines) - 1, 2):
        if lines[i] == "0":
            start = i + 2
        elif lines[i] == "5":
            found.setdefault(lines[i + 1], start)
    return found


def walk(drawing: Drawing, layout: Any, matrix: Any, layer: str | None, inserted: set[str], above: tuple[str, ...]
         ) -> None:
    """Take the curves of the model space or of a block, moved by a matrix; what is on layer 0 of a block is on the
    layer that it was inserted on."""
    where = f" of block {above[-1]}" if above else ""
    for entity in layout:
        own = layer if layer is not None and entity.dxf.layer == "0" else entity.dxf.layer
        if entity.dxftype() == "INSERT":
            insert(drawing, entity, matrix, own, inserted, above)
            continue
        drawing.layers.add(own)
        entry = drawing.entry(entity, where)
        if entity.dxftype() not in CURVES:
            continue
        if drawing.layer is not None and own != drawing.layer:
            entry.leave(f"not on layer {drawing.layer}")
            continue
        if entity.dxf.get("invisible", 0):
            entry.leave("invisible")
            continue
        if drawing.layer is None and hidden(layout.doc, own):
            entry.leave(f"layer {own} is not visible in the drawing; --layer takes it")
            continue
        found = [piece for piece in points_of(drawing, entity, matrix, entry) if len(piece) > 1]
        if len(drawing.pieces) > MOST:
            raise Problem(f"{drawing.path}: more than {MOST} curves")
        if found:
            entry.use()
            drawing.pieces += found
            drawing.owners += [entry] * len(found)


def hidden(document: Any, layer: str) -> bool:
    """Whether a layer is off or frozen; one that the drawing does not define is not."""
    if not document.layers.has_entry(layer):
        return False
    entry = document.layers.get(layer)
    return bool(entry.is_off() or entry.is_frozen())


def unseen(drawing: Drawing, entity: Any, layer: str) -> str:
    """Return why a reference of a block is not visible, if so: an off layer hides none of its entities on others."""
    if entity.dxf.get("invisible", 0):
        return "invisible"
    layers = entity.doc.layers
    if drawing.layer is None and layers.has_entry(layer) and layers.get(layer).is_frozen():
        return f"layer {layer} is frozen; --layer takes what is in the block"
    return ""


def insert(drawing: Drawing, entity: Any, matrix: Any, layer: str, inserted: set[str], above: tuple[str, ...]) -> None:
    """Take the curves of a reference of a block, or of its array of columns and rows."""
    from ezdxf.xclip import XClip
    entry, name = drawing.entry(entity), entity.dxf.name
    block = entity.block()
    if block is None:
        entry.leave(f"there is no block {name}")
        return
    if block.block is not None and (block.block.is_xref or block.block.is_xref_overlay):
        entry.leave(f"block {name} is another file")
        return
    if name in above or len(above) > DEEPEST:
        raise Problem(f"{entry.place}: error: block {name} contains itself")
    if why := unseen(drawing, entity, layer):
        entry.leave(why)
        drawing.layers |= {layer if one.dxf.layer == "0" else one.dxf.layer for one in block}
        return
    entry.use()
    inserted.add(name)
    if XClip(entity).has_clipping_path:
        drawing.account.enter(entry.place, f"clipping of block {name}").leave("the whole block is taken")
    for attribute in entity.attribs:
        drawing.entry(attribute)
    if entity.mcount > MOST:
        raise Problem(f"{entry.place}: error: an array of {entity.mcount} blocks")
    for one in entity.multi_insert() if entity.mcount > 1 else [entity]:
        own = one.matrix44()
        walk(drawing, block, own if matrix is None else own * matrix, layer, inserted, (*above, name))


def others(drawing: Drawing, document: Any, inserted: set[str]) -> None:
    """Enter what is not in the model space: blocks that nothing inserts, and entities of the paper space."""
    for block in document.blocks:
        if not block.name.startswith(("*", "_")) and len(block) and block.name not in inserted:
            line = drawing.lines.get(str(block.block.dxf.get("handle", "")) if block.block is not None else "")
            drawing.account.enter(f"{drawing.path}:{line}" if line else str(drawing.path), f"BLOCK {block.name}"
                                  ).leave("no entity that is read inserts it")
    for layout in document.layouts:
        for entity in layout if layout.name != "Model" else ():
            if entity.dxftype() != "VIEWPORT":
                drawing.entry(entity, f" of layout {layout.name}").leave("in the paper space")


def points_of(drawing: Drawing, entity: Any, matrix: Any, entry: Entry) -> Iterator[np.ndarray]:
    """Yield the points of the parts of a curve."""
    from ezdxf import path as paths
    if entity.dxftype() == "SPLINE":
        yield spline_points(drawing, entity, matrix, entry)
        return
    try:
        line = paths.make_path(without_frame(entity), segments=SEGMENTS)
    except TypeError:  # a POLYLINE that is a mesh
        return
    entry.leave(NO_LENGTH)
    for part in (line if matrix is None else line.transform(matrix)).sub_paths() if len(line) else ():
        control = finite(entry, np.array([tuple(point) for point in part.control_vertices()]))
        fine = FINEST * float(np.ptp(control, axis=0).max())
        yield np.array([tuple(point) for point in part.flattening(max(drawing.chord, fine))])


def without_frame(entity: Any) -> Any:
    """Return a curve without the control frame that CAD keeps with a polyline that a spline was fitted to, unseen."""
    if entity.dxftype() == "POLYLINE" and entity.dxf.flags & FITTED:
        entity.vertices[:] = [vertex for vertex in entity.vertices if not vertex.dxf.flags & FRAME]
    return entity


def finite(entry: Entry, points: np.ndarray) -> np.ndarray:
    """Return points if their coordinates are numbers in a usable range."""
    if not (abs(points) <= LARGEST).all():
        raise Problem(f"{entry.place}: error: {entry.name} has coordinates that are no numbers, or above {LARGEST:g}")
    return points


def spline_points(drawing: Drawing, entity: Any, matrix: Any, entry: Entry) -> np.ndarray:
    """Return the points of a spline."""
    closed = bool(entity.dxf.flags & CLOSED)
    fitted = not len(entity.control_points)
    if fitted and len(entity.fit_points) < 2:
        raise Problem(f"{entry.place}: error: a SPLINE without control points")
    if fitted and closed:
        value, places = through(finite(entry, moved(matrix, entity.fit_points)))
        return finite(entry, sampled(value, places, drawing.chord))
    spline = entity.construction_tool() if fitted else None
    control = finite(entry, moved(matrix, entity.control_points if spline is None else spline.control_points))
    knots, given, degree = (entity.knots, entity.weights, entity.dxf.degree) if spline is None else (
        spline.knots(), spline.weights(), spline.degree)
    weights = np.array(given, float) if len(given) else np.ones(len(control))
    if len(weights) != len(control) or not (weights > 0).all():
        raise Problem(f"{entry.place}: error: a SPLINE whose weights are not positive, one for each control point")
    value, places = b_spline(entry, control, weights, np.array(knots, float), int(degree), closed)
    return finite(entry, sampled(value, places, drawing.chord))


def moved(matrix: Any, points: Any) -> np.ndarray:
    """Return points moved by a matrix."""
    from ezdxf.math import Vec3
    vectors = [Vec3(point) for point in points]
    return np.array([tuple(point) for point in (matrix.transform_vertices(vectors) if matrix else vectors)], float)


def through(fit: np.ndarray) -> tuple[Value, np.ndarray]:
    """Return a closed cubic spline through fit points, and places of its parameter, the length of the chords."""
    size = float(np.ptp(fit, axis=0).max())
    fit = fit[np.append(True, np.linalg.norm(np.diff(fit, axis=0), axis=1) > SAME * size)]
    if np.linalg.norm(fit[0] - fit[-1]) > SAME * size:
        fit = np.vstack([fit, fit[:1]])
    fit[-1] = fit[0]
    length = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(fit, axis=0), axis=1))))
    if len(fit) < 4:
        return lambda t: np.column_stack([np.interp(t, length, column) for column in fit.T]), spans(length, 1)
    return CubicSpline(length, fit, bc_type="periodic"), spans(length, 3)


def spans(knots: np.ndarray, degree: int) -> np.ndarray:
    """Return places that divide each span between knots into one part more than the degree."""
    knots = np.unique(knots)
    parts = np.arange(degree + 1) / (degree + 1)
    return np.append((knots[:-1, None] + np.diff(knots)[:, None] * parts).ravel(), knots[-1])


def b_spline(entry: Entry, control: np.ndarray, weights: np.ndarray, knots: np.ndarray, degree: int, closed: bool
             ) -> tuple[Value, np.ndarray]:
    """Return a B-spline and places of its parameter. One that is closed repeats its first control points at the end,
    in the file or, where its ends do not meet, here."""
    count = len(control)
    if not 1 <= degree < max(count, 2) or (not closed and len(knots) not in (0, count + degree + 1)):
        raise Problem(f"{entry.place}: error: a SPLINE of degree {degree} with {count} control points and {len(knots)} "
                      f"knots; expected {count + degree + 1}")
    if not len(knots):
        inner = np.arange(1, count - degree)
        knots = np.arange(count + degree + 1.0) if closed else np.concatenate(
            [np.zeros(degree + 1), inner, np.full(degree + 1, count - degree)]).astype(float)
    if (np.diff(knots) < 0).any() or not np.isfinite(knots).all():
        raise Problem(f"{entry.place}: error: a SPLINE whose knots do not increase")
    homogeneous = np.column_stack([control * weights[:, None], weights])
    if closed and not meets(homogeneous, knots, degree):
        homogeneous, knots = wrapped(homogeneous, knots, degree)
    if len(knots) != len(homogeneous) + degree + 1 or knots[degree] >= knots[len(homogeneous)]:
        raise Problem(f"{entry.place}: error: a SPLINE of degree {degree} with {count} control points and {len(knots)} "
                      "knots")
    curve = BSpline(knots, homogeneous, degree)

    def value(t: np.ndarray) -> np.ndarray:
        points = curve(t)
        return np.asarray(points[:, :3] / points[:, 3:])
    return value, spans(knots[degree:len(homogeneous) + 1], degree)


def meets(homogeneous: np.ndarray, knots: np.ndarray, degree: int) -> bool:
    """Tell whether a B-spline ends where it begins."""
    count = len(homogeneous)
    if len(knots) != count + degree + 1 or knots[degree] >= knots[count]:
        return False
    ends = BSpline(knots, homogeneous, degree)([knots[degree], knots[count]])
    places = ends[:, :3] / ends[:, 3:]
    return bool(np.linalg.norm(places[1] - places[0]) <= 1e-6 * np.ptp(homogeneous[:, :3], axis=0).max())


def wrapped(homogeneous: np.ndarray, knots: np.ndarray, degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Return a periodic B-spline whose first control points are repeated, with the knots of the file if it has enough,
    or equal steps."""
    homogeneous = np.vstack([homogeneous, homogeneous[:degree]])
    if len(knots) == len(homogeneous) + degree + 1:
        return homogeneous, knots
    return homogeneous, np.arange(len(homogeneous) + degree + 1.0)
